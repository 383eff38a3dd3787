#include "arguments.h"

#include "colour.h"
#include "io_volume.h"
#include "report.h"
#include "scene.h"
#include "surface.h"
#include "video.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum flag_type {
    FLAG_SWITCH,  /* bool */
    FLAG_TEXT,    /* const char * */
    FLAG_CHOICE,  /* const char *, one of `choices` */
    FLAG_SCENE,   /* const char *, the name of an embedded scene */
    FLAG_COUNT,   /* uint32_t, at least 1 */
    FLAG_NUMBER,  /* double */
    FLAG_LENGTH,  /* double, at least 0 */
    FLAG_ABOVE,   /* double, above 0 */
    FLAG_AUTO,    /* double above 0, or "auto": 0 */
    FLAG_SPACING, /* double[3] above 0, or one for all */
    FLAG_SIZE,    /* uint32_t[2] */
    FLAG_RANGE,   /* colour_end[2] */
    FLAG_COLOR,   /* double[4] */
    FLAG_PAINT,   /* const char *, a colour or the name of something with colours */
    FLAG_ASSIGN,  /* name=value of a setting */
    FLAG_SETTING, /* the setting named in `choices` */
    FLAG_LAYOUT,  /* const char *[2]: the name of an .svg, of a .json */
    FLAG_SHAPE,   /* a further shape; `choices`: the operation */
    FLAG_TARGET,  /* a further path ("path" in `choices`) or target */
    FLAG_FOCUS,   /* cli_surface_options: two numbers or four */
    FLAG_LENS,    /* cli_lens_option */
} flag_type;

typedef struct flag_row {
    const char *name, *other, *value;
    flag_type type;
    unsigned commands; /* cli_command_bit */
    bool per_file;     /* offset counts in cli_source, else in cli_options */
    size_t offset;
    const char *choices, *help;
} flag_row;

#define BOTH (CLI_RENDER | CLI_COMPARE)
#define ANY (CLI_INFO | BOTH | CLI_FLOW)
#define SHOT (CLI_RENDER | CLI_VESSEL | CLI_SURFACE)
#define DRAWN (BOTH | CLI_VESSEL | CLI_SURFACE)
#define TRACE (BOTH | CLI_FLOW)
#define FLOWN (TRACE | CLI_SURFACE)
#define VOLUME (ANY | CLI_SURFACE)
#define ALL(field) false, offsetof(cli_options, field)
#define FILE_(field) true, offsetof(cli_source, field)

// clang-format off
static const flag_row flags[] = {
    {"--out", "-o", "FILE.png", FLAG_TEXT, BOTH | CLI_SHEET | CLI_SURFACE, ALL(out), NULL, "the picture; with --frames a pattern (out_%04d.png, first = 0), or a video: .mp4, .webm, .gif"},
    {"--out", "-o", "FILE", FLAG_TEXT, CLI_FLOW, ALL(out), NULL, "the lines: .vtp (with time and speed), .trk (the same) or .tck (positions alone)"},
    {"--out", "-o", "FILE.png", FLAG_TEXT, CLI_VESSEL, ALL(out), NULL, "the picture; of several cameras or frames a pattern (out_%04d.png, first = 0) or a video"},
    {"--style", NULL, "NAME", FLAG_CHOICE, CLI_VESSEL, ALL(vessel.style), CLI_STYLES, "a set of settings: default, plain (light alone), ink (flat colours and outlines), glow (soft, no outlines), stipple, hatch, crosshatch, layered (ink that follows the vessels), shadow (hatched depth shadows) or void (depth as colour behind them)"},
    {"--grid", NULL, "N", FLAG_COUNT, CLI_VESSEL, ALL(vessel.grid), NULL, "cells of the distance field along its longest axis, 16..512 (128)"},
    {"--field", NULL, "NAME", FLAG_CHOICE, CLI_VESSEL, ALL(vessel.field), "cpu|device", "who builds the distance field, to the same bits: cpu (default), once, or device (the backend, in every frame, as for a tree that moves)"},
    {"--layout", NULL, "FILE", FLAG_LAYOUT, CLI_VESSEL, ALL(vessel.layout), NULL, "the tree in 2D: drawn by the backend (.png), as lines (.svg) or numbers (.json); give it once for each"},
    {"--layout-weight", NULL, "NAME", FLAG_TEXT, CLI_VESSEL, ALL(vessel.weight), NULL, "lay out by this attribute of the nodes, by radius, or by how near they are to the --path or --target (near), instead of by their number"},
    {"--tree", NULL, "FILE.json", FLAG_TEXT, CLI_VESSEL, ALL(vessel.tree), NULL, "nodes and segments as they are drawn; segment.V of a dump counts these"},
    {"--path", NULL, "X,Y,Z:X,Y,Z...", FLAG_TARGET, CLI_VESSEL, ALL(vessel.targets), "path", "distances of the vessels to a path through these points (mm): a needle"},
    {"--target", NULL, "X,Y,Z,R|MESH", FLAG_TARGET, CLI_VESSEL, ALL(vessel.targets), NULL, "the same to a ball, or to the surface in a file: a tumour"},
    {"--risk", NULL, "MM", FLAG_LENGTH, CLI_VESSEL, ALL(vessel.risk), NULL, "mark vessels nearer than this with a pattern, and list them in --json (with --link 15)"},
    {"--link", NULL, NULL, FLAG_SWITCH, CLI_VESSEL, ALL(vessel.link), NULL, "the picture shows the 2D layout beside the tree, in the same colours and patterns; --path and --target may be given up to 6 times: a column for each"},
    {"--section", NULL, "Q", FLAG_LENGTH, CLI_VESSEL, ALL(vessel.section), NULL, "elliptic cross sections: the shorter over the longer axis, 0.1..1 (the nodes' attribute section_ratio, its axis section_axis)"},
    {"--uncertainty", NULL, "MM|NAME", FLAG_TEXT, CLI_VESSEL, ALL(vessel.uncertainty), NULL, "noise moves the surface by so much, in and out, up to 3/4 of the radius; of all nodes, or their attribute (uncertainty)"},
    {"--bump-size", NULL, "MM", FLAG_LENGTH, CLI_VESSEL, ALL(vessel.bump_size), NULL, "across a bump of that noise (the mean radius, at least twice the greatest amplitude)"},
    {"--subtract", NULL, "SHAPE", FLAG_SHAPE, CLI_VESSEL, ALL(vessel.shapes), "2", "cut away sphere:X,Y,Z,R, box:X,Y,Z,X,Y,Z (two corners), plane:NX,NY,NZ,D (where n.p < D), ellipsoid:X,Y,Z,A,B,C (half axes) or the inside of a FILE (mesh or tree)"},
    {"--intersect", NULL, "SHAPE", FLAG_SHAPE, CLI_VESSEL, ALL(vessel.shapes), "1", "keep what is inside; the shapes are applied in the order of the flags"},
    {"--union", NULL, "SHAPE", FLAG_SHAPE, CLI_VESSEL, ALL(vessel.shapes), "0", "add the shape; --union tree adds the vessels again, behind the cuts of an organ"},
    {"--shape-color", NULL, "#rrggbb|nearest", FLAG_PAINT, CLI_VESSEL, ALL(vessel.shape_color), NULL, "of what shapes add or cut open, or that of the nearest vessel"},
    {"--lens", NULL, "LENS", FLAG_LENS, CLI_VESSEL, ALL(vessel.lens), "sphere:X,Y,Z,R or circle:X,Y,R", "a magic lens, inside which the tree has another look: the ball sphere:X,Y,Z,R (mm), or circle:X,Y,R on the picture (from the left and the top, in widths and heights; radius in heights); ring: --set lens_rim=PX"},
    {"--lens-style", NULL, "NAME", FLAG_CHOICE, CLI_VESSEL, ALL(vessel.lens.style), CLI_STYLES, "as --style, inside the --lens (default)"},
    {"--lens-color", NULL, "NAME", FLAG_PAINT, CLI_VESSEL, ALL(vessel.lens.color), NULL, "as --color, inside the --lens (as outside)"},
    {"--lens-tree", NULL, "FILE", FLAG_TEXT, CLI_VESSEL, ALL(vessel.lens.tree), NULL, "another tree, in the same millimetres, that shows inside the --lens"},
    {"--surface", NULL, "NAME", FLAG_TEXT, CLI_VESSEL, ALL(vessel.surface), NULL, "without a FILE: an embedded surface instead of a tree: liver, aneurysm, aorta or bone"},
    {"--pattern", NULL, "FILE.png", FLAG_TEXT, CLI_VESSEL, ALL(vessel.pattern), NULL, "for --set style=pattern: the picture, dark parts first, that ink makes of (u, v); its middle square, up to 256 pixels"},
    {"--last", NULL, NULL, FLAG_SWITCH, CLI_VESSEL, ALL(vessel.last), NULL, "of several cameras or frames write only the last picture, to FILE.png as it is"},
    {"--margin", NULL, "N", FLAG_COUNT, CLI_VESSEL, ALL(vessel.margin), NULL, "pixels drawn around the picture and not shown, so that what comes into view has its texture coordinates (0); a dump has them"},
    {"--nodes", NULL, "N", FLAG_COUNT, CLI_VESSEL, ALL(vessel.nodes), NULL, "of the embedded tree, when no TREE is given (3000)"},
    {"--cameras", NULL, "FILE.json", FLAG_TEXT, CLI_VESSEL, ALL(vessel.cameras), NULL, "an array of cameras: one picture for each"},
    {"--frames", NULL, "N", FLAG_COUNT, CLI_VESSEL, ALL(frames), NULL, "pictures of one turn around the tree; of --cameras, the first N"},
    {"--lines", NULL, "FILE|none", FLAG_TEXT, CLI_SURFACE, ALL(surface.lines), NULL, "pathlines with the point array 'time' (ms), or steady lines with 'speed' or 'velocity' (m/s): drawn inside, and what the surface lights up for; none: not even the flow of an embedded surface"},
    {"--baseline", NULL, "NAME", FLAG_CHOICE, CLI_SURFACE, ALL(surface.baseline), "transparent|fresnel", "for comparison, the setting shading: transparent or fresnel"},
    {"--brightness", NULL, "MM|auto", FLAG_AUTO, CLI_SURFACE, ALL(surface.brightness), NULL, "how much the wall shows of its shape; auto: by its median curvature (of a MESH 1.5, else auto)"},
    {"--focus", NULL, "NEAR,FAR|X,Y,Z,R", FLAG_FOCUS, CLI_SURFACE, ALL(surface), NULL, "blur what is nearer or farther from the eye than this (mm), or than a ball"},
    {"--value", NULL, "NAME", FLAG_TEXT, CLI_SURFACE, ALL(surface.value), NULL, "hue by this array of the MESH (its length, if a vector) instead of by near flow; --range says from where to where"},
    {"--vertices", NULL, "FILE.json", FLAG_TEXT, CLI_SURFACE, ALL(surface.vertices), NULL, "numbers of every vertex: p, n, measure, near; triangles; with lines phi, beta, gamma"},
    {"--normals", NULL, NULL, FLAG_SWITCH, CLI_SURFACE, ALL(surface.normals), NULL, "take the normals of the file, where it has any"},
    {"--flip", NULL, "on|off", FLAG_CHOICE, CLI_SURFACE, ALL(surface.flip), "on|off", "turn the MESH inside out, or leave an open one that seems to be so (closed ones never are)"},
    {"--smooth", NULL, "N", FLAG_COUNT, CLI_SURFACE, ALL(surface.smooth), NULL, "smooth the MESH by N double steps that keep its volume (Taubin)"},
    {"--subdivide", NULL, "N", FLAG_COUNT, CLI_SURFACE, ALL(surface.subdivide), NULL, "each time four triangles for one (Loop), 1..4"},
    {"--triangles", NULL, "N", FLAG_COUNT, CLI_SURFACE, ALL(surface.triangles), NULL, "merge vertices until N triangles are left at most, 100..16777216 (of meshes that have more: 16777216)"},
    {"--scene", NULL, "NAME", FLAG_CHOICE, CLI_SURFACE, ALL(scene), "aorta|aneurysm|liver|bone", "embedded surface, when no MESH is given: aorta (an arch with a bulge) and aneurysm, each with its flow, liver (with a vein inside) or bone"},
    {"--frames", NULL, "N", FLAG_COUNT, CLI_SURFACE, ALL(frames), NULL, "a sequence of pictures or a video over one period of the lines, or from their first time to the last"},
    {"--time", NULL, "MS", FLAG_NUMBER, CLI_SURFACE, ALL(time), NULL, "what is lit: the lines around this time, and the surface near them (0; of the embedded flow 180, of a VOLUME half of the median line's)"},
    {"--unit", NULL, "NAME", FLAG_CHOICE, CLI_SURFACE, FILE_(unit), "mm|cm|um|m|m/s|cm/s|mm/s", "of the MESH or TREE: mm (default), cm, um or m; of a VOLUME's velocities: m/s (default), cm/s or mm/s"},
    {"--grid", NULL, "N", FLAG_COUNT, CLI_SURFACE, ALL(surface.grid), NULL, "of a TREE: voxels along its longest axis, of which the mesh is made, 32..512 (256)"},
    {"--wall-colormap", NULL, "NAME", FLAG_CHOICE, CLI_SURFACE, ALL(surface.colormap), COLOUR_MAPS, "show near flow or --value by a colour map, not by two hues (which is the default): " COLOUR_MAPS},
    {"--contours", NULL, "MM", FLAG_ABOVE, CLI_SURFACE, ALL(surface.contours[0]), NULL, "draw the wall's contours as lines this wide"},
    {"--suggestive-contours", NULL, "MM", FLAG_ABOVE, CLI_SURFACE, ALL(surface.contours[1]), NULL, "draw where contours would appear next if the view turned, as lines this wide"},
    {"--suggestive-threshold", NULL, "X", FLAG_LENGTH, CLI_SURFACE, ALL(surface.threshold), NULL, "all of these whose measure has this slope across them (1/mm^2); unless given the clear ones, by the median curvature"},
    {"--color", NULL, "#rrggbb", FLAG_PAINT, CLI_SURFACE, FILE_(color), NULL, "of the lines: or r,g,b in 0..1, direction, line or the NAME of an attribute"},
    {"--colormap", NULL, "NAME", FLAG_CHOICE, CLI_SURFACE, FILE_(colormap), COLOUR_MAPS, "of the lines' attribute: " COLOUR_MAPS " (viridis)"},
    {"--range", NULL, "A,B", FLAG_RANGE, CLI_SURFACE, FILE_(range), NULL, "values at both ends of --value or of the lines' colours, or percentiles (2%,98%)"},
    {"--every", NULL, "N", FLAG_COUNT, CLI_SURFACE, FILE_(every), NULL, "keep each N-th line"},
    {"--seeds", NULL, "N", FLAG_COUNT, FLOWN, ALL(flow.seeds), NULL, "lines, each from a random place inside and a random time (one per 4 mm^3, 1000 to 30000)"},
    {"--seed", NULL, "N", FLAG_COUNT, FLOWN, ALL(flow.seed), NULL, "of the random numbers; the same gives the same lines"},
    {"--mask", NULL, "FILE|NAME", FLAG_TEXT, VOLUME, ALL(flow.mask), NULL, "where the vessel is: a volume of the same size, or an array of the FILE (>= 0.5 is inside)"},
    {"--threshold", NULL, "M/S", FLAG_LENGTH, FLOWN, ALL(flow.threshold), NULL, "inside is where the speed reaches this at some time (without a mask: a tenth of the highest)"},
    {"--streamlines", NULL, NULL, FLAG_SWITCH, FLOWN, ALL(flow.streamlines), NULL, "lines of the field frozen --at a time, instead of pathlines"},
    {"--at", NULL, "MS", FLAG_NUMBER, FLOWN, ALL(flow.at), NULL, "the time of --streamlines (0)"},
    {"--step", NULL, "MS|auto", FLAG_AUTO, FLOWN, ALL(flow.step), NULL, "time between the points of a line (period / 200; steady: half a voxel at the highest speed)"},
    {"--max-points", NULL, "N", FLAG_COUNT, FLOWN, ALL(flow.max_points), NULL, "of a line (200)"},
    {"--span", NULL, "NAME", FLAG_CHOICE, FLOWN, ALL(flow.span), "cycle|loop|free", "cycle: one beat, the same for all (default); loop: half a beat each way (for --time, --frames); free: up to --max-points"},
    {"--method", NULL, "rk4|dopri", FLAG_CHOICE, FLOWN, ALL(flow.method), "rk4|dopri", "Runge-Kutta of fixed step (default) or Dormand-Prince, which keeps --tolerance"},
    {"--tolerance", NULL, "MM", FLAG_ABOVE, FLOWN, ALL(flow.tolerance), NULL, "error of a part of a step, for dopri (0.0001)"},
    {"--attributes", NULL, "NAME", FLAG_CHOICE, FLOWN, ALL(flow.attributes), "vorticity|curvature|all", "more per point: vorticity (1/s), curvature (1/mm) or all"},
    {"--names", NULL, "U,V,W[,MASK]", FLAG_TEXT, VOLUME, ALL(flow.names), NULL, "arrays of a volume: three components, or one vector: VELOCITY[,MASK]"},
    {"--unit", NULL, "NAME", FLAG_CHOICE, CLI_FLOW, ALL(flow.unit), "m/s|cm/s|mm/s", "of a volume's velocities: m/s (default), cm/s or mm/s"},
    {"--axes", NULL, "mm|grid", FLAG_CHOICE, VOLUME, ALL(flow.axes), "mm|grid", "of a volume's velocities: those of its mm (default) or of its voxels"},
    {"--spacing", NULL, "MM[,MM,MM]", FLAG_SPACING, VOLUME, ALL(flow.spacing), NULL, "size of a volume's voxels, where it tells none or a wrong one"},
    {"--time-step", NULL, "MS", FLAG_ABOVE, VOLUME, ALL(flow.time_step), NULL, "between a volume's frames"},
    {"--period", NULL, "MS", FLAG_ABOVE, CLI_INFO | CLI_FLOW, ALL(flow.period), NULL, "of all its frames, instead of --time-step"},
    {"--scene", NULL, "NAME", FLAG_SCENE, BOTH, ALL(scene), NULL, "embedded scene, when no FILE is given (aorta)"},
    {"--lines", NULL, "N", FLAG_COUNT, BOTH, ALL(lines), NULL, "lines of the embedded scene"},
    {"--size", NULL, "WxH", FLAG_SIZE, DRAWN, ALL(size), NULL, "pixels (render: 1280x960, compare: 640x480)"},
    {"--ssaa", NULL, "N", FLAG_SETTING, DRAWN, ALL(all), "supersampling", "samples per pixel and axis, 1..4 (2)"},
    {"--background", NULL, "#rrggbb", FLAG_COLOR, DRAWN, ALL(background), NULL, "or #rrggbbaa or r,g,b[,a] in 0..1 (#f4f4f2)"},
    {"--backend", NULL, "gl|vk", FLAG_CHOICE, SHOT, ALL(backend), "gl|vk", "OpenGL or Vulkan (gl); the picture is the same"},
    {"--camera", NULL, "FILE.json", FLAG_TEXT, DRAWN, ALL(camera), NULL, "{\"eye\":[3],\"center\":[3],\"up\":[3],\"fovy\":degrees | \"ortho_height\":mm}, or that text itself"},
    {"--save-camera", NULL, "FILE.json", FLAG_TEXT, SHOT, ALL(save_camera), NULL, "write the camera that was used"},
    {"--view", NULL, "NAME", FLAG_CHOICE, DRAWN, ALL(view), "axial|coronal|sagittal|iso", "direction of the automatic camera: axial, coronal, sagittal or iso"},
    {"--ortho", NULL, NULL, FLAG_SWITCH, DRAWN, ALL(ortho), NULL, "make the automatic camera orthographic"},
    {"--time", NULL, "MS", FLAG_NUMBER, BOTH, ALL(time), NULL, "show this time: of lines with times the trails (trail taper, unless set)"},
    {"--frames", NULL, "N", FLAG_COUNT, CLI_RENDER, ALL(frames), NULL, "a sequence of pictures or a video over one period, or from the first time to the last"},
    {"--fps", NULL, "N", FLAG_COUNT, SHOT, ALL(fps), NULL, "frames per second of a video (25)"},
    {"--backdrop", NULL, NULL, FLAG_SWITCH, CLI_RENDER, ALL(backdrop), NULL, "of velocity volumes and the scene flow: the highest speeds of the beat behind the lines, the vessel's outline around"},
    {"--shared-occlusion", NULL, NULL, FLAG_SWITCH, DRAWN, ALL(shared_occlusion), NULL, "FILEs of lines occlude each other, not only themselves; settings from occlusion to shading are then the first one's"},
    {"--outline", NULL, "MESH", FLAG_TEXT, CLI_RENDER, ALL(outline), NULL, "the silhouette of a vessel's wall (mm) behind the lines and its outline around: STL, PLY, OBJ, VTP or VTK"},
    {"--legend", NULL, "SIDE", FLAG_CHOICE, SHOT, ALL(legend), "off|left|right|bottom", "scale of each attribute's colours in the picture: off, left, right or bottom (off)"},
    {"--legend-title", NULL, "TEXT", FLAG_TEXT, SHOT, ALL(legend_title), NULL, "above the first scale (the attribute's name, and its unit if known)"},
    {"--dump", NULL, "FILE.exr", FLAG_TEXT, SHOT, ALL(dump), NULL, "every image of the frame graph as 32-bit floats (OpenEXR)"},
    {"--timings", NULL, "FILE.json", FLAG_TEXT, SHOT, ALL(timings), NULL, "milliseconds of the frame and of each pass"},
    {"--columns", NULL, "N", FLAG_COUNT, CLI_SHEET, ALL(columns), NULL, "pictures in a row (3)"},
    {"--title", NULL, "TEXT", FLAG_TEXT, CLI_SHEET, ALL(title), NULL, "above all pictures"},
    {"--note", NULL, "TEXT", FLAG_TEXT, CLI_SHEET, ALL(note), NULL, "below all pictures"},
    {"--widest", NULL, "N", FLAG_COUNT, CLI_SHEET, ALL(widest), NULL, "pixels; wider pictures shrink by a whole factor (no limit)"},
    {"--json", NULL, NULL, FLAG_SWITCH, CLI_INFO | CLI_COMPARE | CLI_FLOW | CLI_VESSEL | CLI_SURFACE, ALL(json), NULL, "one JSON object on standard output"},
    {"--help", "-h", NULL, FLAG_SWITCH, ANY | CLI_SHEET | CLI_VESSEL | CLI_SURFACE, ALL(help), NULL, "this text"},
    {"--as", NULL, "KIND", FLAG_CHOICE, BOTH, FILE_(as), "lines|tree|surface", "draw the FILE as lines, tree or surface: where it holds several the lines are drawn, unless told; of a tree the surface too can be made"},
    {"--color", NULL, "#rrggbb", FLAG_PAINT, BOTH, FILE_(color), NULL, "of lines: or r,g,b in 0..1, direction, line or the NAME of an attribute; of trees: or layout, radius, order or a NAME; of surfaces the NAME of an array of the vertices"},
    {"--colormap", NULL, "NAME", FLAG_CHOICE, BOTH, FILE_(colormap), COLOUR_MAPS, "of attributes: " COLOUR_MAPS " (viridis)"},
    {"--range", NULL, "A,B", FLAG_RANGE, BOTH, FILE_(range), NULL, "values at both ends of the colour map, or percentiles of all (2%,98%)"},
    {"--color", NULL, "NAME", FLAG_PAINT, CLI_VESSEL, FILE_(color), NULL, "layout (hue and saturation of the 2D layout), radius, order (of branching), distance, #rrggbb or the NAME of an attribute"},
    {"--colormap", NULL, "NAME", FLAG_CHOICE, CLI_VESSEL, FILE_(colormap), COLOUR_MAPS, "of numbers: " COLOUR_MAPS " (viridis; with --risk coolwarm, red near, blue far)"},
    {"--range", NULL, "A,B", FLAG_RANGE, CLI_VESSEL, FILE_(range), NULL, "values at both ends of the colour map (those of the data; with --risk twice that, 0)"},
    {"--every", NULL, "N", FLAG_COUNT, TRACE, FILE_(every), NULL, "keep each N-th line"},
    {"--min-length", NULL, "MM", FLAG_LENGTH, TRACE, FILE_(min_length), NULL, "drop shorter lines (files: none; of a volume: shorter than two voxels)"},
    {"--bundle", NULL, "NAME", FLAG_TEXT, BOTH, FILE_(bundle), NULL, "keep the lines of this group (TRX group, TT cluster)"},
    {"--unit", NULL, "NAME", FLAG_CHOICE, CLI_INFO | BOTH, FILE_(unit), "mm|cm|um|m|m/s|cm/s|mm/s", "of trees and meshes: mm, cm, um or m, whatever the file tells or seems to be in; of volumes: m/s, cm/s or mm/s"},
    {"--unit", NULL, "NAME", FLAG_CHOICE, CLI_VESSEL, FILE_(unit), "mm|cm|um|m", "of the tree, whatever the file tells or seems to be in"},
    {"--set", NULL, "NAME=VALUE", FLAG_ASSIGN, DRAWN, FILE_(settings), NULL, "a setting, as its own flag does"},
};
// clang-format on
enum { FLAG_ROWS = sizeof flags / sizeof *flags };

typedef struct parser {
    cli_command_bit command;
    cli_options *options;
    cli_source *source; /* where per-file flags go now */
} parser;

/* ---- values ----------------------------------------------------------------------------- */

static const char *next_choice(const char *choices) {
    choices += strcspn(choices, "|");
    return *choices ? choices + 1 : choices;
}

static bool is_choice(const char *choices, const char *text) {
    size_t length = strlen(text);
    for (const char *at = choices; *at; at = next_choice(at)) {
        if (strcspn(at, "|") == length && strncmp(at, text, length) == 0)
            return true;
    }
    return false;
}

static bool parse_count(const char *text, uint32_t *count) {
    double number;
    if (strspn(text, "0123456789") != strlen(text) || !cli_number(text, &number) || number < 1 ||
        number > 1e8)
        return false;
    *count = (uint32_t)number;
    return true;
}

/* One number above 0 for all, or three. */
static bool parse_spacing(const char *text, double spacing[3]) {
    double v[3];
    if (cli_number(text, &v[0]))
        v[1] = v[2] = v[0];
    else if (!cli_numbers(text, v, 3))
        return false;
    if (!(v[0] > 0 && v[1] > 0 && v[2] > 0))
        return false;
    memcpy(spacing, v, sizeof v);
    return true;
}

#define LARGEST_SIDE 32768 /* px of a picture */
#define TEXT_OF_VALUE(value) #value
#define TEXT_OF(macro) TEXT_OF_VALUE(macro)

static bool parse_size(const char *text, uint32_t size[2]) {
    char part[16];
    size_t length = strcspn(text, "x");
    if (text[length] != 'x' || length >= sizeof part)
        return false;
    memcpy(part, text, length);
    part[length] = '\0';
    uint32_t width, height;
    if (!parse_count(part, &width) || !parse_count(text + length + 1, &height) ||
        width > LARGEST_SIDE || height > LARGEST_SIDE)
        return false;
    size[0] = width;
    size[1] = height;
    return true;
}

bool cli_parse_color(const char *text, double color[4]) {
    double c[4] = {0, 0, 0, 1};
    size_t length = strlen(text);
    if (*text == '#') {
        if ((length != 7 && length != 9) ||
            strspn(text + 1, "0123456789abcdefABCDEF") != length - 1)
            return false;
        for (size_t i = 0; 2 * i + 1 < length; i++) {
            const char digits[3] = {text[2 * i + 1], text[2 * i + 2], '\0'};
            c[i] = (double)strtoul(digits, NULL, 16) / 255.0;
        }
    } else if (!cli_numbers(text, c, 4) && (c[3] = 1, !cli_numbers(text, c, 3))) {
        return false;
    }
    for (int i = 0; i < 4; i++) {
        if (!(c[i] >= 0 && c[i] <= 1))
            return false;
    }
    memcpy(color, c, sizeof c);
    return true;
}

/* "0,2.5", "2%,98%", "0,99%": two ends that are not the same. */
static bool parse_range(const char *text, colour_end ends[2]) {
    const char *comma = strchr(text, ',');
    for (int i = 0; i < 2 && comma; i++) {
        char part[64];
        const char *from = i ? comma + 1 : text;
        size_t length = i ? strlen(from) : (size_t)(comma - text);
        bool percent = length > 0 && from[length - 1] == '%';
        if (length >= sizeof part)
            return false;
        snprintf(part, sizeof part, "%.*s", (int)(length - percent), from);
        if (!cli_number(part, &ends[i].value) ||
            (percent && !(ends[i].value >= 0 && ends[i].value <= 100)))
            return false;
        ends[i].percent = percent;
    }
    return comma && (ends[0].percent != ends[1].percent || ends[0].value != ends[1].value);
}

/* The modules whose settings a command takes, and where a source keeps them. */
static const lao_setting_row layout_rows[] = {
#define ROW(name, type, minimum, maximum, standard, structural, unit, choices, help)               \
    {#name, LAO_SETTING_##type, minimum, maximum, standard, structural, unit, choices, help},
    CLI_LAYOUT_SETTINGS(ROW)
#undef ROW
};
static const lao_module layout_module = {
    .name = "layout",
    .settings = layout_rows,
    .setting_count = sizeof layout_rows / sizeof *layout_rows,
};

enum { MODULES = 3 };
typedef struct module_row {
    const lao_module *module; /* NULL: none of this command */
    size_t offset;            /* of its settings in cli_source */
} module_row;
static module_row module_of(cli_command_bit command, int index) {
    const module_row lines = {lao_lines_module(), offsetof(cli_source, settings)};
    const module_row vessel = {sdv_module(), offsetof(cli_source, vessel)};
    const module_row layout = {&layout_module, offsetof(cli_source, layout)};
    const module_row none = {NULL, 0};
    const module_row surface = {vsf_module(), offsetof(cli_source, surface)};
    if (command & CLI_SURFACE)
        return index == 0 ? surface : index == 1 ? lines : none;
    if (command & CLI_VESSEL)
        return index == 0 ? vessel : index == 1 ? layout : lines;
    if (command & BOTH)
        return index == 0 ? lines : index == 1 ? vessel : surface;
    return none;
}

/* A setting of one of the modules; row NULL: there is none. */
typedef struct setting_place {
    const lao_setting_row *row;
    module_row at;
    int index;
} setting_place;

/* "align-intensity" and "align_intensity" are the same setting. */
static setting_place find_setting(cli_command_bit command, const char *name, size_t length) {
    setting_place place = {NULL, {NULL, 0}, -1};
    char text[64];
    if (length >= sizeof text)
        return place;
    for (size_t i = 0; i < length; i++)
        text[i] = name[i] == '-' ? '_' : name[i];
    text[length] = '\0';
    for (int m = 0; m < MODULES && !place.row; m++) {
        place.at = module_of(command, m);
        place.index = lao_setting_find(place.at.module, text);
        if (place.index >= 0)
            place.row = &place.at.module->settings[place.index];
    }
    return place;
}

static const char *setting_name(const void *user, uint32_t index) {
    const parser *p = user;
    for (int m = 0; m < MODULES; m++) {
        const lao_module *module = module_of(p->command, m).module;
        if (module && index < module->setting_count)
            return module->settings[index].name;
        index -= module ? module->setting_count : 0;
    }
    return NULL;
}

static const char *scene_name(const void *user, uint32_t index) {
    (void)user;
    uint32_t count;
    const char *const *names = scene_names(&count);
    return index < count ? names[index] : NULL;
}

void cli_setting_text(const lao_setting_row *row, float value, char *text, size_t size) {
    if (row->type == LAO_SETTING_BOOL) {
        snprintf(text, size, "%s", value > 0 ? "on" : "off");
    } else if (row->type == LAO_SETTING_ENUM) {
        const char *at = row->choices;
        for (int i = 0; i < (int)value; i++)
            at = next_choice(at);
        snprintf(text, size, "%.*s", (int)strcspn(at, "|"), at);
    } else {
        cli_shortest(value, text, size);
    }
}

/* "0.1..5 mm", "on|off", "box|gaussian" */
static void setting_values(const lao_setting_row *row, char *text, size_t size) {
    if (row->type == LAO_SETTING_ENUM) {
        snprintf(text, size, "%s", row->choices);
    } else if (row->type == LAO_SETTING_BOOL) {
        snprintf(text, size, "on|off");
    } else {
        char low[32], high[32];
        cli_shortest(row->minimum, low, sizeof low);
        cli_shortest(row->maximum, high, sizeof high);
        snprintf(text, size, "%s..%s%s%s", low, high, *row->unit ? " " : "", row->unit);
    }
}

/* Gives one setting to the source; supersampling belongs to the picture, thus to every source. */
static bool set_setting(parser *p, setting_place place, const char *value) {
    const lao_module *module = place.at.module;
    if (!place.row)
        return cli_fail("'%s': this command has no setting for it", value);
    if (lao_setting_parse(module, place.index, value, (char *)p->source + place.at.offset) != 0) {
        char values[256];
        setting_values(place.row, values, sizeof values);
        return cli_fail("%s: '%s' is not a value of it; write %s", place.row->name, value, values);
    }
    if (strcmp(place.row->name, "supersampling") == 0) {
        lao_setting_parse(module, place.index, value, &p->options->all.settings);
        for (uint32_t i = 0; i < p->options->file_count; i++)
            lao_setting_parse(module, place.index, value, &p->options->files[i].settings);
    }
    return true;
}

static bool set_assignment(parser *p, const char *text) {
    size_t length = strcspn(text, "=");
    if (text[length] != '=')
        return cli_fail("--set: '%s' has no value; write --set name=value", text);
    setting_place setting = find_setting(p->command, text, length);
    if (setting.row)
        return set_setting(p, setting, text + length + 1);
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)(length < 63 ? length : 63), text);
    const char *nearest = cli_nearest(name, setting_name, p);
    return cli_fail("--set: there is no setting '%s'%s%s; 'lineao %s --help' lists them", name,
                    nearest ? "; did you mean " : "", nearest ? nearest : "",
                    p->command & CLI_VESSEL    ? "vessel"
                    : p->command & CLI_SURFACE ? "surface"
                                               : "render");
}

static bool set_scene(const char *value, const char **scene) {
    *scene = value;
    for (uint32_t i = 0; scene_name(NULL, i); i++) {
        if (strcmp(scene_name(NULL, i), value) == 0)
            return true;
    }
    const char *nearest = cli_nearest(value, scene_name, NULL);
    char names[256] = "";
    for (uint32_t i = 0; scene_name(NULL, i); i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", scene_name(NULL, i));
    }
    return cli_fail("--scene: there is no scene '%s'%s%s; scenes are %s", value,
                    nearest ? "; did you mean " : "", nearest ? nearest : "", names);
}

/* ---- flags ------------------------------------------------------------------------------ */

/* The extension says which of the three. */
static bool set_layout(const flag_row *row, const char *value, const char **names) {
    const char *dot = strrchr(value, '.');
    if (!dot || !is_choice("svg|json|png", dot + 1))
        return cli_fail("%s: '%s' is not a value of it; its name must end in .png, .svg or .json",
                        row->name, value);
    names[strcmp(dot, ".json") == 0 ? 1 : strcmp(dot, ".png") == 0 ? 2 : 0] = value;
    return true;
}

static bool add_shape(parser *p, const flag_row *row, const char *value) {
    cli_vessel_options *o = &p->options->vessel;
    if (o->shape_count == CLI_SHAPES)
        return cli_fail("%s: more than %d shapes", row->name, CLI_SHAPES);
    o->shapes[o->shape_count].operation = (uint32_t)(row->choices[0] - '0');
    o->shapes[o->shape_count++].text = value;
    return true;
}

static bool add_target(parser *p, const flag_row *row, const char *value) {
    cli_vessel_options *o = &p->options->vessel;
    if (o->target_count == CLI_TARGETS)
        return cli_fail("%s: more than %d paths and targets", row->name, CLI_TARGETS);
    o->targets[o->target_count].path = row->choices != NULL;
    o->targets[o->target_count++].text = value;
    return true;
}

/* Two depths, the nearer first, or a ball. */
static bool parse_focus(const char *text, cli_surface_options *out) {
    out->focus = text;
    out->focus_numbers = cli_numbers(text, out->focus_at, 4)   ? 4
                         : cli_numbers(text, out->focus_at, 2) ? 2
                                                               : 0;
    return out->focus_numbers == 4
               ? out->focus_at[3] >= 0
               : out->focus_numbers == 2 && out->focus_at[0] <= out->focus_at[1];
}

/* A ball is read as the shape that it is. */
static bool parse_lens(const char *text, cli_lens_option *out) {
    double ball[4];
    out->text = text;
    out->is_circle = strncmp(text, "circle:", 7) == 0;
    return out->is_circle
               ? cli_numbers(text + 7, out->circle, 3) && out->circle[2] > 0 &&
                     out->circle[2] <= 10 && fabs(out->circle[0]) <= 10 &&
                     fabs(out->circle[1]) <= 10
               : strncmp(text, "sphere:", 7) == 0 && cli_numbers(text + 7, ball, 4) && ball[3] > 0;
}

static bool is_flow_flag(const flag_row *row) {
    size_t begin = offsetof(cli_options, flow);
    return !row->per_file && row->offset >= begin && row->offset < begin + sizeof(cli_flow_options);
}

/* What the name of a flag's value does not say of it. */
static const char *value_range(flag_type type) {
    switch (type) {
    case FLAG_COUNT:
        return ", a whole number from 1";
    case FLAG_SIZE:
        return ", each from 1 to " TEXT_OF(LARGEST_SIDE);
    case FLAG_LENGTH:
        return ", a number from 0";
    case FLAG_ABOVE:
    case FLAG_AUTO:
        return ", a number above 0";
    case FLAG_NUMBER:
        return ", a number";
    default:
        return "";
    }
}

static bool set_flag(parser *p, const flag_row *row, const char *value) {
    if (is_flow_flag(row))
        p->options->flow_flag = row->name;
    void *field =
        row->per_file ? (char *)p->source + row->offset : (char *)p->options + row->offset;
    bool ok = true;
    switch (row->type) {
    case FLAG_SWITCH:
        *(bool *)field = true;
        break;
    case FLAG_CHOICE:
        ok = is_choice(row->choices, value);
        *(const char **)field = value;
        break;
    case FLAG_TEXT:
        ok = *value != '\0';
        *(const char **)field = value;
        break;
    case FLAG_SCENE:
        return set_scene(value, field);
    case FLAG_COUNT:
        ok = parse_count(value, field);
        break;
    case FLAG_NUMBER:
        ok = cli_number(value, field);
        break;
    case FLAG_LENGTH:
        ok = cli_number(value, field) && *(double *)field >= 0;
        break;
    case FLAG_ABOVE:
        ok = cli_number(value, field) && *(double *)field > 0;
        break;
    case FLAG_AUTO:
        *(double *)field = 0;
        ok = strcmp(value, "auto") == 0 || (cli_number(value, field) && *(double *)field > 0);
        break;
    case FLAG_SPACING:
        ok = parse_spacing(value, field);
        break;
    case FLAG_SIZE:
        ok = parse_size(value, field);
        break;
    case FLAG_RANGE:
        ok = parse_range(value, field);
        break;
    case FLAG_COLOR:
        ok = cli_parse_color(value, field);
        break;
    case FLAG_PAINT:
        ok = *value != '\0' && (*value != '#' || cli_parse_color(value, (double[4]){0}));
        *(const char **)field = value;
        break;
    case FLAG_ASSIGN:
        return set_assignment(p, value);
    case FLAG_SETTING:
        return set_setting(p, find_setting(p->command, row->choices, strlen(row->choices)), value);
    case FLAG_LAYOUT:
        return set_layout(row, value, field);
    case FLAG_SHAPE:
        return add_shape(p, row, value);
    case FLAG_TARGET:
        return add_target(p, row, value);
    case FLAG_FOCUS:
        ok = parse_focus(value, field);
        break;
    case FLAG_LENS:
        ok = parse_lens(value, field);
        break;
    }
    return ok || cli_fail("%s: '%s' is not a value of it; write %s%s", row->name, value,
                          row->choices ? row->choices : row->value, value_range(row->type));
}

static const flag_row *find_flag(cli_command_bit command, const char *name, size_t length) {
    for (size_t i = 0; i < FLAG_ROWS; i++) {
        const char *names[2] = {flags[i].name, flags[i].other};
        for (int k = 0; k < 2 && (flags[i].commands & command); k++) {
            if (names[k] && strlen(names[k]) == length && strncmp(names[k], name, length) == 0)
                return &flags[i];
        }
    }
    return NULL;
}

uint32_t cli_flag_words(cli_command_bit command, const char *word, bool *of_file) {
    const char *equals = strchr(word, '=');
    const flag_row *row = find_flag(command, word, equals ? (size_t)(equals - word) : strlen(word));
    *of_file = !row || row->per_file; /* the rest are settings */
    if (word[0] != '-' || strcmp(word, "--") == 0)
        return 0;
    return equals || (row && row->type == FLAG_SWITCH) ? 1 : 2;
}

/* Flags of the table, then settings in the spelling of flags. */
static const char *flag_name(const void *user, uint32_t index) {
    const parser *p = user;
    for (size_t i = 0; i < FLAG_ROWS; i++) {
        if ((flags[i].commands & p->command) && index-- == 0)
            return flags[i].name + 2;
    }
    return setting_name(p, index);
}

static bool unknown_flag(const parser *p, const char *text, size_t length) {
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)(length < 63 ? length : 63), text);
    const char *nearest = cli_nearest(name + strspn(name, "-"), flag_name, p);
    return cli_fail("%s: unknown flag%s%s; --help lists them", name,
                    nearest ? "; did you mean --" : "", nearest ? nearest : "");
}

/* Takes argv[at] and its value; returns how many were taken, 0 on failure. */
static int take_flag(parser *p, int argc, char **argv, int at) {
    const char *text = argv[at], *equals = strchr(text, '=');
    size_t length = equals ? (size_t)(equals - text) : strlen(text);
    const flag_row *row = find_flag(p->command, text, length);
    setting_place setting = {NULL, {NULL, 0}, -1};
    if (!row && strncmp(text, "--", 2) == 0)
        setting = find_setting(p->command, text + 2, length - 2);
    if (!row && !setting.row)
        return unknown_flag(p, text, length);
    if (row && row->type == FLAG_SWITCH && !equals)
        return set_flag(p, row, NULL);
    if (row && row->type == FLAG_SWITCH)
        return cli_fail("%s: takes no value", row->name);
    const char *value = equals ? equals + 1 : at + 1 < argc ? argv[at + 1] : NULL;
    if (!value)
        return cli_fail("%s: its value is missing; --help explains it", text);
    if (!(row ? set_flag(p, row, value) : set_setting(p, setting, value)))
        return 0;
    return equals ? 1 : 2;
}

/* A name that promises what is not written. */
static bool is_other_picture(const char *path) {
    static const char *const names[] = {".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp", ".exr",
                                        ".svg", ".pdf",  ".ppm", ".avi",  ".mov", ".mkv"};
    const char *dot = path ? strrchr(path, '.') : NULL;
    bool other = false;
    for (size_t i = 0; dot && i < sizeof names / sizeof *names && !other; i++) {
        size_t k = 0;
        while (names[i][k] && tolower((unsigned char)dot[k]) == names[i][k])
            k++;
        other = !names[i][k] && !dot[k];
    }
    return other;
}

/* What io_write_lines writes. */
static bool is_line_name(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && is_choice("vtp|trk|tck", dot + 1);
}

static bool check_lens(const cli_options *o) {
    const cli_vessel_options *v = &o->vessel;
    const cli_lens_option *lens = &v->lens;
    const char *more = lens->style   ? "--lens-style"
                       : lens->color ? "--lens-color"
                       : lens->tree  ? "--lens-tree"
                                     : NULL;
    if (!lens->text)
        return !more || cli_fail("%s: inside what? write --lens", more);
    if (v->link || o->dump)
        return cli_fail("--lens: leave %s out, which shows one tree",
                        v->link ? "--link" : "--dump");
    if (lens->color && strcmp(lens->color, "distance") == 0 && !v->target_count)
        return cli_fail("--lens-color: distance needs a --path or a --target");
    if (lens->is_circle)
        return true;
    if (lens->style && strcmp(lens->style, "void") == 0)
        return cli_fail("--lens-style: there is no void in a ball; write --lens circle:X,Y,R");
    return v->shape_count < CLI_SHAPES ||
           cli_fail("--lens: a ball is a further shape, of %d at most", CLI_SHAPES);
}

static bool check_vessel(const cli_options *o) {
    const cli_vessel_options *v = &o->vessel;
    if (o->file_count > 1)
        return cli_fail("%s: is a second TREE, and one is drawn at a time; lineao "
                        "render draws several",
                        o->files[1].path);
    if (o->file_count == 1 && v->nodes)
        return cli_fail("--nodes: is for the embedded tree, and a TREE is given");
    if (!o->out && !o->dump && !o->timings && !o->save_camera && !v->layout[0] && !v->layout[1] &&
        !v->layout[2] && !v->tree && !o->json)
        return cli_fail("vessel: no output is asked for; write -o out.png");
    if (v->grid && (v->grid < 16 || v->grid > 512))
        return cli_fail("--grid: '%u' is not a value of it; write 16..512", v->grid);
    if (v->section >= 0 && !(v->section >= 0.1 && v->section <= 1))
        return cli_fail("--section: '%g' is not a value of it; write 0.1..1", v->section);
    if (v->target_count > 1 && !v->link)
        return cli_fail("--path: is given beside --target; leave one of them out or write --link");
    const cli_source *source = o->file_count ? &o->files[0] : &o->all;
    if (source->color && strcmp(source->color, "distance") == 0 && !v->target_count)
        return cli_fail("--color: distance needs a --path or a --target");
    if (v->risk >= 0 && !v->target_count)
        return cli_fail("--risk: is a distance to a --path or a --target, and none is given");
    if (v->shape_color && !v->shape_count)
        return cli_fail("--shape-color: there is no shape; write --union, --subtract or "
                        "--intersect");
    if (v->shape_color && strcmp(v->shape_color, "nearest") != 0 && *v->shape_color != '#')
        return cli_fail("--shape-color: '%s' is not a value of it; write #rrggbb or nearest",
                        v->shape_color);
    if (v->cameras && (o->camera || o->view || o->ortho))
        return cli_fail("--cameras: says where every picture is taken from; leave %s out",
                        o->camera ? "--camera"
                        : o->view ? "--view"
                                  : "--ortho");
    return check_lens(o);
}

static bool check_surface(const cli_options *o) {
    const cli_surface_options *s = &o->surface;
    bool volume = o->file_count > 0 && io_is_volume(o->files[0].path);
    bool flow = volume || cli_wall_has_lines(o);
    if (o->file_count > 1 && !volume)
        return cli_fail("%s: is a second MESH, and one is drawn at a time; lineao "
                        "render draws several",
                        o->files[1].path);
    if (o->flow_flag && !volume)
        return cli_fail("%s: is for velocity volumes, and none is given", o->flow_flag);
    if (s->lines && volume)
        return cli_fail("--lines: is given beside a volume, through which lines are traced; leave "
                        "one of them out");
    if (s->grid && (s->grid < 32 || s->grid > 512))
        return cli_fail("--grid: '%u' is not a value of it; write 32..512", s->grid);
    if (o->file_count == 1 && o->scene)
        return cli_fail("--scene: is for embedded surfaces, and a MESH is given");
    if (!o->out && !o->dump && !o->timings && !o->save_camera && !s->vertices && !o->json)
        return cli_fail("surface: no output is asked for; write -o out.png");
    if (s->subdivide > 4)
        return cli_fail("--subdivide: '%u' is not a value of it; write 1..4", s->subdivide);
    if (s->triangles && (s->triangles < 100 || s->triangles > CLI_MOST_TRIANGLES))
        return cli_fail("--triangles: '%u' is not a value of it; write 100..%u", s->triangles,
                        (unsigned)CLI_MOST_TRIANGLES);
    if (s->value && o->file_count == 0)
        return cli_fail("--value: names an array of a MESH, and none is given");
    if (!flow && (o->frames || !isnan(o->time)))
        return cli_fail("%s: shows lines at a time, and none are given; write --lines FILE",
                        o->frames ? "--frames" : "--time");
    return true;
}

static bool check(const parser *p) {
    const cli_options *o = p->options;
    if (o->help)
        return true;
    if (p->command == CLI_INFO && o->file_count == 0)
        return cli_fail("info: no FILE is given; write lineao info FILE...");
    if (p->command == CLI_SHEET && (o->file_count == 0 || !o->out))
        return cli_fail("sheet: %s; write lineao sheet CAPTION=FILE.png... -o out.png",
                        o->out ? "no picture is given" : "no output is asked for");
    if (p->command == CLI_FLOW && (o->file_count == 0 || !o->out))
        return cli_fail("flow: %s; write lineao flow VOLUME... -o lines.vtp",
                        o->file_count ? "no output is asked for" : "no VOLUME is given");
    if (p->command == CLI_FLOW && !is_line_name(o->out))
        return cli_fail("--out: '%s' is not a value of it; its name must end in .vtp, .trk or .tck",
                        o->out);
    if (o->flow_flag && o->file_count == 0)
        return cli_fail("%s: is for velocity volumes, and no FILE is given", o->flow_flag);
    if (p->command == CLI_VESSEL && !check_vessel(o))
        return false;
    if (p->command == CLI_SURFACE && !check_surface(o))
        return false;
    if (p->command == CLI_RENDER && !o->out && !o->dump && !o->timings && !o->save_camera)
        return cli_fail("render: no output is asked for; write -o out.png");
    if (is_other_picture(o->out))
        return cli_fail("--out: '%s' is not a value of it; its name must end in .png or, of a "
                        "video, .mp4, .webm or .gif",
                        o->out);
    if (cli_is_video(o->out) && !o->frames && !o->vessel.cameras)
        return cli_fail("%s: a video has frames; write --frames N", o->out);
    if (cli_is_video(o->out) && o->background[3] < 1)
        return cli_fail("--background: a video cannot be transparent; write pictures instead");
    if (o->fps && !cli_is_video(o->out))
        return cli_fail("--fps: is for videos; write -o out.mp4, out.webm or out.gif");
    if (o->file_count > 0 && (o->scene || o->lines))
        return cli_fail("%s: is for embedded scenes, and a FILE is given; %s",
                        o->scene ? "--scene" : "--lines",
                        o->scene ? "leave one of them out" : "thin a file with --every N");
    if (o->file_count == 0 && p->command != CLI_SURFACE &&
        (o->all.every || o->all.min_length > 0 || o->all.bundle))
        return cli_fail("%s: thins FILEs, and none is given; --lines N is for embedded scenes",
                        o->all.every    ? "--every"
                        : o->all.bundle ? "--bundle"
                                        : "--min-length");
    if (o->camera && (o->view || o->ortho))
        return cli_fail("%s: is for the automatic camera, and --camera is given; leave one out",
                        o->view ? "--view" : "--ortho");
    return true;
}

bool cli_parse(cli_command_bit command, int argc, char **argv, cli_options *out) {
    memset(out, 0, sizeof *out);
    out->backend = "gl";
    out->time = NAN;
    out->size[0] = command == CLI_COMPARE ? 640 : 1280;
    out->size[1] = command == CLI_COMPARE ? 480 : 960;
    out->legend = command == CLI_VESSEL ? NULL : "off";
    out->all.colormap = command == CLI_VESSEL ? NULL : "viridis";
    out->vessel.risk = out->vessel.section = out->vessel.bump_size = -1;
    out->all.range[0] = (colour_end){command == CLI_VESSEL ? 0 : 2, true};
    out->all.range[1] = (colour_end){command == CLI_VESSEL ? 100 : 98, true};
    out->flow.threshold = -1;
    out->surface.brightness = -1;
    out->surface.threshold = -1;
    out->all.min_length = -1;
    cli_parse_color("#f4f4f2", out->background);
    out->files = cli_new((size_t)argc + 1, sizeof *out->files);
    if (!out->files)
        return false;
    parser p = {command, out, &out->all};
    bool only_files = false;
    for (int i = 0, taken = 1; i < argc; i += taken) {
        taken = 1;
        if (!only_files && strcmp(argv[i], "--") == 0) {
            only_files = true;
        } else if (!only_files && argv[i][0] == '-') {
            taken = take_flag(&p, argc, argv, i);
            if (!taken)
                return false;
        } else if (argv[i][0] == '\0') {
            return cli_fail("a FILE has no name; check the quotes of the command");
        } else {
            p.source = &out->files[out->file_count++];
            *p.source = out->all;
            p.source->path = argv[i];
        }
    }
    return check(&p);
}

void cli_options_free(cli_options *options) {
    free(options->files);
    options->files = NULL;
}

/* ---- help ------------------------------------------------------------------------------- */

static void print_rows(cli_command_bit command, bool per_file, bool flow, const char *title) {
    bool any = false;
    for (size_t i = 0; i < FLAG_ROWS; i++) {
        const flag_row *row = &flags[i];
        if (!(row->commands & command) || row->per_file != per_file || is_flow_flag(row) != flow)
            continue;
        if (!any)
            printf("\n%s\n", title);
        any = true;
        char left[64];
        snprintf(left, sizeof left, "%s%s%s %s", row->other ? row->other : "",
                 row->other ? ", " : "", row->name, row->value ? row->value : "");
        printf("  %-26s %s\n", left, row->help);
    }
}

static void print_settings(const lao_module *module) {
    for (uint32_t i = 0; i < module->setting_count; i++) {
        const lao_setting_row *row = &module->settings[i];
        char values[256], left[64], standard[64];
        setting_values(row, values, sizeof values);
        cli_setting_text(row, row->standard, standard, sizeof standard);
        snprintf(left, sizeof left, "--%s", row->name);
        for (char *c = left; *c; c++)
            *c = *c == '_' ? '-' : *c;
        printf("  %-26s %s; %s (%s)\n", left, row->help, values, standard);
    }
}

void cli_print_flags(cli_command_bit command) {
    print_rows(command, false, false, "Flags");
    print_rows(command, false, true, "Velocity volumes");
    print_rows(command, true, false,
               command == CLI_SURFACE
                   ? "Of the MESH and of the lines"
                   : "Of a FILE: before the first FILE for all FILEs, after a FILE for it alone");
    if (command & DRAWN)
        printf("\nSettings%s (default in parentheses)\n",
               command & (CLI_VESSEL | CLI_SURFACE) ? "" : ", for all FILEs or for one");
    for (int m = 0; m < MODULES; m++) { /* of those for lines few do anything to vessels */
        const lao_module *module = module_of(command, m).module;
        if (module && (command & BOTH ? m == 0 : module != lao_lines_module()))
            print_settings(module);
    }
    if (command & BOTH)
        printf("  Behind a tree those of lineao vessel --help, behind a surface those of lineao "
               "surface\n  --help (both end in a list of settings).\n");
    if (command & (CLI_VESSEL | CLI_SURFACE))
        printf("  Those of lineao render --help are taken too; supersampling is --ssaa.\n");
}
