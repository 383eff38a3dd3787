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
} command_row;

static const command_row commands[] = {
    {"info", CLI_INFO, cli_info, "FILE... [--json]", "what is in line files",
     "  lineao info bundle.trk                 lines, points, box, attributes, groups\n"
     "  lineao info *.trx --json               the same for scripts\n"},
    {"render", CLI_RENDER, cli_render, "[FILE [FLAG...]]... -o out.png",
     "draw lines into a picture",
     "  lineao render -o aorta.png                                     the embedded scene\n"
     "  lineao render bundle.trk -o out.png --width 0.3 --view sagittal\n"
     "  lineao render a.trk --color '#d08040' b.tck --width 1 -o two.png   each FILE its own look\n"
     "  lineao render bundle.trk --color fa --colormap inferno -o fa.png\n"
     "  lineao render --preset classic --strength 2 -o classic.png     settings are flags\n"
     "  lineao render --ssaa 1 --dump frame.exr --backend vk           every image as numbers\n"},
    {"compare", CLI_COMPARE, cli_compare, "[FILE [FLAG...]]... [-o sheet.png] [--json]",
     "draw with OpenGL and Vulkan and count differing bits",
     "  lineao compare -o sheet.png            GL, VK and difference of every image\n"
     "  lineao compare bundle.trk --json       exit code 1 when a bit differs\n"},
    {"sheet", CLI_SHEET, cli_sheet_command, "[CAPTION=]FILE.png... -o out.png",
     "put pictures with captions on one sheet",
     "  lineao sheet 'no AO=a.png' 'AO=b.png' --columns 2 -o ab.png\n"},
    {"bench", 0, NULL, "[--json]", "time every pass and frame of fixed scenes on both backends",
     ""},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

static const char *command_name(const void *user, uint32_t index) {
    (void)user;
    return index < COMMANDS ? commands[index].name : NULL;
}

static void print_help(void) {
    printf("usage: lineao COMMAND ...\n\n"
           "Renders dense 3D line sets (tractograms, pathlines, streamlines) so that their depth\n"
           "and structure can be read at a glance.\n\n");
    for (int i = 0; i < COMMANDS; i++)
        printf("  %-9s %s\n", commands[i].name, commands[i].help);
    printf("\nExamples\n");
    for (int i = 0; i < COMMANDS; i++)
        printf("%s", commands[i].examples);
    printf("\nFiles: .trk .tck .trx .tt .vtk .vtp, also gzip-compressed.\n"
           "Flags of a command: lineao COMMAND --help\n");
}

static void print_command(const command_row *row) {
    printf("usage: lineao %s %s\n\n%c%s.\n\nExamples\n%s", row->name, row->arguments,
           row->help[0] - 'a' + 'A', row->help + 1, row->examples);
    cli_print_flags(row->bit);
}

static const command_row *find_command(const char *name) {
    for (int i = 0; i < COMMANDS; i++) {
        if (strcmp(commands[i].name, name) == 0)
            return &commands[i];
    }
    const char *nearest = cli_nearest(name, command_name, NULL);
    cli_fail(
        "%s: there is no such command%s%s; commands are info, render, compare, sheet, bench, help",
        name, nearest ? "; did you mean " : "", nearest ? nearest : "");
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
        cli_fail("no command is given; commands are info, render, compare, sheet, bench; see "
                 "lineao --help");
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
