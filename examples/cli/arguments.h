/* The command line: one table of flags, from which parsing and --help are made. The flags of
 * lineao's settings come from lineao's own table, so that a range and its help live once. */
#ifndef LINEAO_CLI_ARGUMENTS_H
#define LINEAO_CLI_ARGUMENTS_H

#include "colour.h"
#include "lineao.h"
#include "sdfvessel.h"
#include "vesselsurface.h"

#include <stdbool.h>
#include <stdint.h>

/* Commands as bits, for the tables. */
typedef enum cli_command_bit {
    CLI_INFO = 1,
    CLI_RENDER = 2,
    CLI_COMPARE = 4,
    CLI_FLOW = 8,
    CLI_SHEET = 16,
    CLI_VESSEL = 32,
    CLI_SURFACE = 64
} cli_command_bit;

/* Settings of a tree's 2D layout, as a module without passes; as lao_settings: zero is the default
 * unless its bit is set. X as in SDV_SETTINGS. */
#define CLI_LAYOUT_SETTINGS(X)                                                                     \
    X(layout_ph, FLOAT, 0, 1000, 0, 0, "", "",                                                     \
      "how much unbalanced sub-trees close up in the layout (4 / nodes of the reduced tree)")      \
    X(layout_radial, BOOL, 0, 1, 0, 0, "", "", "draw the layout around its root")                  \
    X(layout_all_nodes, BOOL, 0, 1, 0, 0, "", "",                                                  \
      "a sub-tree weighs as many as it has nodes, not only branches and leaves")
typedef struct cli_layout_settings {
    uint64_t set;
#define CLI__FIELD(name, type, minimum, maximum, standard, structural, unit, choices, help)        \
    float name;
    CLI_LAYOUT_SETTINGS(CLI__FIELD)
#undef CLI__FIELD
} cli_layout_settings;
enum {
#define CLI__BIT(name, type, minimum, maximum, standard, structural, unit, choices, help)          \
    CLI_SETTING_##name,
    CLI_LAYOUT_SETTINGS(CLI__BIT)
#undef CLI__BIT
};

/* One FILE and the flags that hold for it. */
typedef struct cli_source {
    const char *path; /* NULL: the embedded scene; of a sheet: "CAPTION=FILE.png" */
    lao_settings settings;
    sdv_settings vessel;
    vsf_settings surface;
    cli_layout_settings layout;
    const char *color; /* NULL: automatic */
    const char *colormap;
    colour_end range[2]; /* values at both ends of the colour map */
    uint32_t every;
    double min_length; /* mm; negative: none is given */
    const char *bundle;
    const char *unit; /* of trees, meshes, volumes; NULL: as the file tells, or guessed */
    const char *as;   /* what it is drawn as: "lines", "tree", "surface"; NULL: by its content */
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

#define CLI_STYLES "default|plain|ink|glow|stipple|hatch|crosshatch|layered|shadow|void"

/* What `vessel` does with a tree. */
enum { CLI_SHAPES = 16, CLI_TARGETS = 6 };
typedef struct cli_shape_option {
    uint32_t operation; /* SDV_UNION, ... */
    const char *text;
} cli_shape_option;
typedef struct cli_target_option {
    bool path;
    const char *text;
} cli_target_option;
/* A magic lens: where another style, or another tree, shows. */
typedef struct cli_lens_option {
    const char *text; /* NULL: none; else a ball, as the text of a shape, or a circle */
    double circle[3]; /* middle from the left and the top and radius, in widths and heights */
    bool is_circle;   /* of the picture */
    const char *style, *tree, *color; /* NULL: not given */
} cli_lens_option;

typedef struct cli_vessel_options {
    const char *style, *tree, *cameras, *weight, *surface, *pattern, *field;
    cli_target_option targets[CLI_TARGETS]; /* several only with `link` */
    uint32_t target_count;
    double risk; /* mm; negative: not given */
    bool link;
    const char *shape_color; /* "nearest" or a colour; NULL: ivory */
    const char *layout[3];   /* NAME.svg, NAME.json, NAME.png */
    uint32_t margin;         /* pixels */
    bool last;
    uint32_t grid, nodes; /* cells; nodes of the embedded tree; 0: not given */
    double section;       /* of all nodes; negative: not given */
    const char *uncertainty;
    double bump_size; /* mm; negative: not given */
    cli_shape_option shapes[CLI_SHAPES];
    uint32_t shape_count;
    cli_lens_option lens;
} cli_vessel_options;

/* Of a mesh, for any device: vertices are counted in floats. */
enum { CLI_MOST_TRIANGLES = 1 << 24 };

/* What `surface` does with a mesh. */
typedef struct cli_surface_options {
    const char *lines, *vertices, *baseline, *focus, *value, *flip, *colormap;
    double focus_at[4];                          /* two numbers (depths, mm) or four (a ball) */
    int focus_numbers;                           /* 0: none */
    uint32_t smooth, subdivide, triangles, grid; /* 0: not given */
    double brightness;                           /* mm; 0: from the mesh; negative: not given */
    double contours[2]; /* mm, width of contours and suggestive contours; 0: none */
    double threshold;   /* 1/mm^2, of the latter; negative: not given */
    bool normals;
} cli_surface_options;

typedef struct cli_options {
    cli_source all;    /* flags before the first FILE */
    cli_source *files; /* owned */
    uint32_t file_count;
    const char *scene, *out, *dump, *timings, *backend, *camera, *save_camera, *view;
    const char *legend, *legend_title; /* "off", a side or NULL: automatic; NULL: name and unit */
    const char *title, *note;          /* of a sheet */
    const char *outline;               /* a mesh behind and around the lines */
    uint32_t lines, frames, fps, columns, widest; /* 0: not given */
    uint32_t size[2];
    double time; /* ms; NaN: not given */
    double background[4];
    bool ortho, json, backdrop, shared_occlusion, help;
    cli_flow_options flow;
    cli_vessel_options vessel;
    cli_surface_options surface;
    const char *flow_flag; /* the last flag in `flow` that was given, or NULL */
} cli_options;

/* Parses what stands behind the command's name. False: wrong usage, reported. Free in any case. */
bool cli_parse(cli_command_bit command, int argc, char **argv, cli_options *out);
void cli_options_free(cli_options *options);

/* How many words a flag takes, itself among them; *of_file: does it hold for one FILE? 0: the word
 * is no flag. */
uint32_t cli_flag_words(cli_command_bit command, const char *word, bool *of_file);

/* "#rrggbb", "#rrggbbaa", "r,g,b" or "r,g,b,a" in 0..1; else false. */
bool cli_parse_color(const char *text, double color[4]);

/* A setting's value in words: "1.5", "on", "paper". */
void cli_setting_text(const lao_setting_row *row, float value, char *text, size_t size);

/* Prints the table of flags of a command to standard output. */
void cli_print_flags(cli_command_bit command);

#endif
