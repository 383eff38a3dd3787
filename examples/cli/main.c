/* The lineao program: a table of commands.
 *
 * Exit code 0 = done, 1 = the work failed, 2 = wrong usage. Standard output has results alone;
 * every failure is one line "lineao: FILE: what is wrong" on standard error. */
#include "commands.h"
#include "dump.h"
#include "report.h"

#include <stdio.h>
#include <string.h>

#ifdef LINEAO_HAVE_BENCH
int bench_command(int argc, char **argv);
#endif

typedef struct command_row {
    const char *name;
    cli_command_bit bit; /* 0: takes its arguments itself */
    int (*run)(const cli_options *options);
    const char *arguments, *help, *examples;
    const char *about; /* what --help adds; NULL = nothing */
} command_row;

static const char flow_about[] =
    "A VOLUME is a grid of velocities: NIfTI (.nii, .nii.gz; three components on its fifth axis, "
    "or\n"
    "in three files), VTK ImageData (.vti) or structured points (.vtk), HDF5 as 4DFlowNet has it\n"
    "(.h5: u, v, w [t,x,y,z], mask, dx). Several files with velocities are time steps in their "
    "order.\n"
    "Distances are mm, times ms, velocities m/s. What a file does not tell is asked for by the "
    "name\n"
    "of the flag that gives it; lineao info VOLUME shows what it tells.\n\n"
    "Lines follow the blood for one beat, each from a random place and time, forward and "
    "backward,\n"
    "until they leave the mask. Without a mask, inside is where the blood is fast: see "
    "--threshold.\n"
    "A volume with one frame is steady: its lines are streamlines, their time counts from the "
    "seed.\n"
    "Each point has the attributes time (ms) and speed (m/s). The same --seed gives the same lines "
    "on\n"
    "any number of threads (LINEAO_THREADS; as many as the machine has).\n";

static const char vessel_about[] =
    "A TREE is SWC, GXL (VascuSynth, OpenCCO), VTP or VTK centrelines with a radius, HDF5 or "
    ".vmv;\n"
    "without one the program grows a liver. Lengths are mm: see --unit for files that tell none.\n"
    "A vessel is a chain of round cones through the nodes' spheres; rays find its surface in a\n"
    "distance field (--grid). Thin branches are never missed; more cells are faster up to a point\n"
    "and take more memory: 20 bytes a cell.\n\n"
    "The layout draws the tree flat (Lichtenberg 2019): each branch has a place across (hue) and\n"
    "a depth (saturation), and the picture shows the same colours, so that a branch in one is "
    "found\n"
    "in the other. With a --path or --target, colours are distances to it.\n"
    "--link shows both beside each other. What comes nearer than --risk (15 mm) has a pattern in\n"
    "both, is counted above them, and is listed by --json: segments (as --tree counts them) and\n"
    "branches (as --layout numbers them); as far as there is room those have numbers, 1 the\n"
    "nearest, in brackets where something hides it. Isolines are where the ticks of the scale "
    "are.\n\n"
    "Without -o, --dump, --timings and --save-camera nothing is drawn and no GPU is opened.\n"
    "A dump holds, in mm: position.X .Y .Z, normal.X .Y .Z, segment.V (counts --tree; -1 nothing,\n"
    "-2 a shape), mask.V, dmin.V (the nearest miss of the pixel's ray; 1e30: none), distance.V,\n"
    "bgposition.X .Y .Z, bgnormal.X .Y .Z, guide.X .Y, uv.U .V.\n";

static const char render_about[] =
    "What a FILE holds says how it is drawn: lines as lines, a vessel tree as lineao vessel draws "
    "it,\n"
    "a mesh as lineao surface does, a velocity volume by its pathlines. Several stand in one "
    "picture:\n"
    "what is in front hides what is behind, whatever it is. Front faces of a surface let through "
    "what\n"
    "is inside; of several surfaces those of a later FILE are laid over those of an earlier one.\n"
    "--as says what a FILE of several meanings is: lines with a radius are lines unless told.\n\n"
    "A dump holds the images of the lines first (color.R .G .B, mask.V, depth.Z ..., out.R .G .B), "
    "then\n"
    "in parts of their own, \"vessel\" and \"surface\", what lineao vessel and surface dump; of "
    "several\n"
    "FILEs of a kind the last one's.\n";

static const char surface_about[] =
    "A MESH is STL, PLY, OBJ, VTP or VTK. A TREE (as lineao vessel takes it) or a velocity VOLUME\n"
    "(as lineao flow takes it) may stand in its place: the wall is the tree's surface (--grid), "
    "or\n"
    "the border of the volume's mask, with its flow inside. Without any the program makes an "
    "aorta\n"
    "with a bulge, and the blood in it.\n\n"
    "Back faces are opaque, then come the lines, then front faces by what they are: clear where\n"
    "they are flat towards the viewer, orange where they bulge, cyan where they are hollow; "
    "redder\n"
    "and greener near blood that is lit (Lawonn 2014). --brightness says how much: it is a "
    "length,\n"
    "so that small vessels want less and large ones more.\n\n"
    "Lines are lit around --time, and drawn there (--trail highlight: everywhere, dark where "
    "unlit).\n"
    "A vertex's distance to the nearest lit part is phi, and 1 % of all distances at K times\n"
    "(--set near_steps=K) are below gamma: near = 1 - phi / gamma. --highlight-beta is how long\n"
    "lit parts are (twice the median of the lines' last times).\n"
    "The flags of lines (--width, --strength ...) are those of lineao render.\n\n"
    "A dump holds of the nearest front face: position.X .Y .Z (mm), normal.X .Y .Z, measure.V\n"
    "(1/mm), near.V, mask.V, lut.R .G .B (as composed: premultiplied). Without -o, --dump and\n"
    "--timings nothing is drawn and no GPU is opened.\n";

static const command_row commands[] = {
    {"info", CLI_INFO, cli_info, "FILE... [--json]",
     "what is in files of lines, vessel trees, meshes and velocity volumes",
     "  lineao info bundle.trk                 lines, points, box, attributes, groups\n"
     "  lineao info *.trx --json               the same for scripts\n"
     "  lineao info brain.swc aorta.stl        nodes, roots, radii; triangles, holes\n"
     "  lineao info pulmonary.vtp --unit cm    for files that tell no unit\n"
     "  lineao info flow.h5                    a volume: voxels, frames, period, speeds, mask\n",
     NULL},
    {"render", CLI_RENDER, cli_render, "[FILE [FLAG...]]... -o out.png",
     "draw lines, vessel trees and surfaces into one picture",
     "  lineao render -o aorta.png                                     the embedded scene\n"
     "  lineao render bundle.trk -o out.png --width 0.3 --view sagittal\n"
     "  lineao render a.trk --color '#d08040' b.tck --width 1 -o two.png   each FILE its own look\n"
     "  lineao render tree.swc tracks.trk wall.stl -o all.png          what is in front hides the "
     "rest\n"
     "  lineao render centreline.vtp --as tree -o vessels.png          lines with a radius\n"
     "  lineao render bundle.trk --color fa --colormap inferno -o fa.png\n"
     "  lineao render flow.vtp --time 120 -o systole.png               trails around 120 ms\n"
     "  lineao render flow.vtp --frames 200 --period 833 -o beat.mp4   one heart beat, in ffmpeg\n"
     "  lineao render --preset classic --strength 2 -o classic.png     settings are flags\n"
     "  lineao render flow.vtp --outline artery.stl -o inside.png      a wall's silhouette around "
     "them\n"
     "  lineao render --ssaa 1 --dump frame.exr --backend vk           every image as numbers\n"
     "  lineao render flow.h5 --color speed --seeds 5000 -o flow.png   traces the volume first\n",
     render_about},
    {"compare", CLI_COMPARE, cli_compare, "[FILE [FLAG...]]... [-o sheet.png] [--json]",
     "draw with OpenGL and Vulkan and count differing bits",
     "  lineao compare -o sheet.png            GL, VK and difference of every image\n"
     "  lineao compare bundle.trk --json       exit code 1 when a bit differs\n",
     NULL},
    {"flow", CLI_FLOW, cli_flow, "VOLUME... -o lines.vtp [--json]",
     "trace pathlines through a velocity volume",
     "  lineao flow aorta.h5 -o aorta.vtp                      lines inside its mask\n"
     "  lineao flow 4d.nii.gz --mask vessel.nii.gz -o 4d.trk   the mask from a file of its own\n"
     "  lineao flow u.nii v.nii w.nii --unit cm/s -o uvw.tck   one file for each component\n"
     "  lineao flow t_*.vti --period 800 -o beat.vtp           one file for each time step\n"
     "  lineao flow 4d.h5 --names vx,vy,vz,seg --spacing 2,2,3 --time-step 40 -o named.vtp\n"
     "  lineao flow 4d.h5 --streamlines --at 120 -o peak.vtp\n"
     "  lineao render aorta.vtp --color speed -o aorta.png     look at them\n",
     flow_about},
    {"sheet", CLI_SHEET, cli_sheet_command, "[CAPTION=]FILE.png... -o out.png",
     "put pictures with captions on one sheet",
     "  lineao sheet 'no AO=a.png' 'AO=b.png' --columns 2 -o ab.png\n", NULL},
    {"vessel", CLI_VESSEL, cli_vessel, "[TREE] -o out.png",
     "draw a vessel tree, lay it out in 2D, measure distances to it",
     "  lineao vessel -o liver.png                              a liver made by code\n"
     "  lineao vessel brain.swc -o out.png --layout out.svg     the tree, and its 2D layout\n"
     "  lineao vessel lung.vtp --unit cm --color radius -o radius.png\n"
     "  lineao vessel --target 20,10,0,12 --layout risk.json -o risk.png   distances to a tumour\n"
     "  lineao vessel --path -90,0,0:20,10,0 -o needle.png      distances to a needle's path\n"
     "  lineao vessel --link --target 32,8,12,16 -o link.png    what is near a tumour, in 3D and "
     "2D\n"
     "  lineao vessel --link --path -90,0,0:20,10,0 --path 0,-90,0:20,10,0 -o paths.png --json\n"
     "  lineao vessel --subtract box:-200,0,0,0,200,200 -o cut.png          cut a corner away\n"
     "  lineao vessel tree.gxl --style ink --ortho --view coronal -o ink.png\n"
     "  lineao vessel --frames 120 -o turn.mp4                  one turn around it\n"
     "  lineao vessel tree.swc --cameras path.json -o f_%04d.png --dump f_%04d.exr\n"
     "  lineao vessel tree.swc --tree tree.json --layout layout.json       numbers alone\n",
     vessel_about},
    {"surface", CLI_SURFACE, cli_surface, "[MESH|TREE|VOLUME...] [--lines FILE] -o out.png",
     "draw a vessel's wall around its blood flow",
     "  lineao surface -o aorta.png                               an aorta made by code, at "
     "systole\n"
     "  lineao surface artery.stl --lines flow.vtp --time 120 -o out.png\n"
     "  lineao surface artery.stl --lines flow.vtp --frames 100 -o beat.mp4\n"
     "  lineao surface wall.vtp --value wss --range 0,5 -o wss.png      hue by an array of the "
     "file\n"
     "  lineao surface artery.stl --set brightness=0.8 --smooth 10 -o clear.png\n"
     "  lineao surface --scene aneurysm --baseline fresnel -o fresnel.png\n"
     "  lineao surface tree.swc --contours 0.2 -o tree.png        the wall of a tree\n"
     "  lineao surface flow.h5 --color speed --legend right -o flow.png     wall and flow of a "
     "volume\n"
     "  lineao surface --wall-colormap inferno --near-gamma 8 --legend right -o distance.png\n"
     "  lineao surface --focus 5,0,20,15 --depth-shadow on -o focus.png   sharp around a point\n"
     "  lineao surface artery.stl --vertices v.json                     numbers alone\n",
     surface_about},
    {"bench", 0, NULL, "[--json]", "time every pass and frame of fixed scenes on both backends", "",
     NULL},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

static const char *command_name(const void *user, uint32_t index) {
    (void)user;
    return index < COMMANDS ? commands[index].name : NULL;
}

static void list_commands(char *text, size_t size) {
    size_t used = 0;
    for (int i = 0; i < COMMANDS && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i ? ", " : "", commands[i].name);
}

static void print_help(void) {
    printf("usage: lineao COMMAND ...\n\n"
           "Renders dense 3D line sets (tractograms, pathlines, streamlines) and vessel trees so\n"
           "that their depth and structure can be read at a glance.\n\n");
    for (int i = 0; i < COMMANDS; i++)
        printf("  %-9s %s\n", commands[i].name, commands[i].help);
    printf("\nExamples\n");
    for (int i = 0; i < COMMANDS; i++)
        printf("%s", commands[i].examples);
    printf("\nFiles, but for .h5 also gzip-compressed: lines .trk .tck .trx .tt .vtk .vtp .obj;\n"
           "vessel trees .swc .gxl .h5 .vmv .vtk .vtp; meshes .stl .ply .obj .vtk .vtp;\n"
           "velocity volumes .nii .vti .vtk .h5.\n"
           "Flags of a command: lineao COMMAND --help\n");
}

static void print_command(const command_row *row) {
    printf("usage: lineao %s %s\n\n%c%s.\n\nExamples\n%s", row->name, row->arguments,
           row->help[0] - 'a' + 'A', row->help + 1, row->examples);
    if (row->about)
        printf("\n%s", row->about);
    cli_print_flags(row->bit);
}

static const command_row *find_command(const char *name) {
    for (int i = 0; i < COMMANDS; i++) {
        if (strcmp(commands[i].name, name) == 0)
            return &commands[i];
    }
    const char *nearest = cli_nearest(name, command_name, NULL);
    char names[128];
    list_commands(names, sizeof names);
    cli_fail("%s: there is no such command%s%s; commands are %s, help", name,
             nearest ? "; did you mean " : "", nearest ? nearest : "", names);
    return NULL;
}

static int run_bench(int argc, char **argv) {
#ifdef LINEAO_HAVE_BENCH
    return bench_command(argc, argv);
#else
    (void)argc;
    (void)argv;
    cli_fail("bench: was not built into this program; build the target lineao_bench_library too");
    return CLI_FAILED;
#endif
}

static int run(const command_row *row, int argc, char **argv) {
    cli_options options;
    int code = CLI_USAGE;
    if (!row->run)
        return run_bench(argc, argv);
    if (cli_parse(row->bit, argc - 1, argv + 1, &options)) {
        if (options.help)
            print_command(row);
        code = options.help ? CLI_OK : row->run(&options);
    }
    cli_options_free(&options);
    return code;
}

static int print_version(void) {
    char version[32];
    cli_version(version);
    printf("lineao %s\n", version);
    return CLI_OK;
}

static bool is_one_of(const char *text, const char *a, const char *b) {
    return strcmp(text, a) == 0 || strcmp(text, b) == 0;
}

int main(int argc, char **argv) {
    cli_interrupt_hold();
    if (argc < 2) {
        char names[128];
        list_commands(names, sizeof names);
        cli_fail("no command is given; commands are %s; see lineao --help", names);
        return CLI_USAGE;
    }
    if (is_one_of(argv[1], "--version", "version"))
        return print_version();
    bool help = is_one_of(argv[1], "--help", "-h") || strcmp(argv[1], "help") == 0;
    if (help && argc == 2) {
        print_help();
        return CLI_OK;
    }
    const command_row *row = find_command(argv[help ? 2 : 1]);
    if (!row)
        return CLI_USAGE;
    if (help && row->run) {
        print_command(row);
        return CLI_OK;
    }
    return help ? run_bench(2, (char *[]){argv[0], (char[]){"--help"}})
                : run(row, argc - 1, argv + 1);
}
