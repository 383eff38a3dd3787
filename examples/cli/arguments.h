/* The command line: one table of flags, from which parsing and --help are made. The flags of
 * lineao's settings come from lineao's own table, so that a range and its help live once. */
#ifndef LINEAO_CLI_ARGUMENTS_H
#define LINEAO_CLI_ARGUMENTS_H

#include "colour.h"
#include "lineao.h"

#include <stdbool.h>
#include <stdint.h>

/* Commands as bits, for the tables. */
typedef enum cli_command_bit {
    CLI_INFO = 1,
    CLI_RENDER = 2,
    CLI_COMPARE = 4,
    CLI_FLOW = 8,
    CLI_SHEET = 16
} cli_command_bit;

/* One FILE and the flags that hold for it. */
typedef struct cli_source {
    const char *path; /* NULL: the embedded scene; of a sheet: "CAPTION=FILE.png" */
    lao_settings settings;
    const char *color; /* NULL: automatic */
    const char *colormap;
    colour_end range[2]; /* values at both ends of the colour map */
    uint32_t every;
    double min_length; /* mm; negative: none is given */
    const char *bundle;
    const char *unit; /* of trees and meshes; NULL: as the file tells, or guessed */
} cli_source;

/* How velocity volumes are read and traced. Numbers are 0, texts NULL where nothing is given. */
typedef struct cli_flow_options {
    const char *names, *mask, *unit, *axes; /* see io_volume_options */
    double spacing[3], time_step, period;
    uint32_t seeds, seed, max_points;
    double at, step, tolerance; /* ms, ms, mm */
    double threshold;           /* m/s; negative: none is given */
    const char *method, *span, *attributes;
    bool streamlines;
} cli_flow_options;

typedef struct cli_options {
    cli_source all;    /* flags before the first FILE */
    cli_source *files; /* owned */
    uint32_t file_count;
    const char *scene, *out, *dump, *timings, *backend, *camera, *save_camera, *view;
    const char *legend, *legend_title;            /* "off" or a side; NULL: name and unit */
    const char *title, *note;                     /* of a sheet */
    uint32_t lines, frames, fps, columns, widest; /* 0: not given */
    uint32_t size[2];
    double time; /* ms; NaN: not given */
    double background[4];
    bool ortho, json, backdrop, help;
    cli_flow_options flow;
    const char *flow_flag; /* the last flag in `flow` that was given, or NULL */
} cli_options;

/* Parses what stands behind the command's name. False: wrong usage, reported. Free in any case. */
bool cli_parse(cli_command_bit command, int argc, char **argv, cli_options *out);
void cli_options_free(cli_options *options);

/* "#rrggbb", "#rrggbbaa", "r,g,b" or "r,g,b,a" in 0..1; else false. */
bool cli_parse_color(const char *text, double color[4]);

/* A setting's value in words: "1.5", "on", "paper". */
void cli_setting_text(const lao_setting_row *row, float value, char *text, size_t size);

/* Prints the table of flags of a command to standard output. */
void cli_print_flags(cli_command_bit command);

#endif
