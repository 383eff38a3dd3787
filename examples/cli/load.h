/* FILEs and embedded scenes as line sets with colours, around one origin. */
#ifndef LINEAO_CLI_LOAD_H
#define LINEAO_CLI_LOAD_H

#include "arguments.h"
#include "io_read.h"

typedef struct cli_set {
    const cli_source *source;
    const char *name;   /* path, or the scene's name */
    io_lines lines;     /* owned; an embedded scene has the point attributes "time" and "speed" */
    uint8_t *colors;    /* owned; RGBA per point; NULL: `color` */
    float color[4];     /* all zero: lineao's sand */
    const float *times; /* in `lines`, or NULL */
    lao_settings settings;
    /* Of a vessel tree; its `lines` are points alone, which tell how far it reaches. */
    const lao_object_desc *object;  /* NULL: a set of lines */
    const void *module_settings[1]; /* of cli_scene.module */
} cli_set;

/* Everything that is drawn. Points are relative to `origin`, which is the first set's. */
typedef struct cli_scene {
    const lao_module *module; /* NULL: lines alone */
    cli_set *sets;            /* owned */
    uint32_t count;
    double origin[3];
    float direction[3], up[3]; /* of the automatic camera */
    double beat[2];            /* first and last time (ms); equal: none */
    double period;             /* ms: of the first set that repeats, else from first to last time */
} cli_scene;

/* Loads what the options name. False: reported, nothing to free. */
bool cli_scene_load(const cli_options *options, cli_scene *out);
void cli_scene_free(cli_scene *scene);

/* Prints the warnings of all files. */
void cli_scene_warn(const cli_scene *scene);

/* Reads a file with a progress bar; Ctrl-C cancels. False: reported. */
bool cli_read_file(const cli_source *source, io_lines *out);
/* The same for any kinds of content (IO_LINES, ...). */
bool cli_read(const cli_source *source, unsigned wanted, io_contents *out);

/* Colours a set as its source says. False: reported. */
bool cli_colour(cli_set *set);

#endif
