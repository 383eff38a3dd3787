/* FILEs of any kinds, and embedded scenes, as sets around one origin. */
#ifndef LINEAO_CLI_LOAD_H
#define LINEAO_CLI_LOAD_H

#include "arguments.h"
#include "io_read.h"

enum { CLI_MODULES = 2 }; /* besides that of the lines */
enum { CLI_NOTE = 128 };  /* bytes of a line about a picture */

typedef struct cli_set {
    const cli_source *source;
    const char *name;   /* path, or the scene's name */
    io_lines lines;     /* owned; an embedded scene has the point attributes "time" and "speed" */
    uint8_t *colors;    /* owned; RGBA per point; NULL: `color` */
    float color[4];     /* all zero: lineao's sand */
    const float *times; /* in `lines`, or NULL */
    const char *value;  /* name of the attribute that `colors` show, or NULL */
    double range[2];    /* its values at both ends of the source's colour map */
    lao_settings settings;
    bool overlay; /* made of another set for a camera: does not say how far the scene reaches */
    /* Of a vessel tree or a wall; its `lines` are points alone, which tell how far it reaches. */
    const lao_object_desc *object;            /* NULL: a set of lines */
    const void *module_settings[CLI_MODULES]; /* of cli_scene.modules; NULL: none */
    struct cli_tree *tree;                    /* that the object is of, or NULL */
    struct cli_wall *wall;                    /* likewise */
} cli_set;

/* A FILE of a scene that is no set of lines: one of both. */
typedef struct cli_object {
    cli_options options; /* the program's, as though this FILE stood alone */
    struct cli_tree *tree;
    struct cli_wall *wall;
} cli_object;

/* For those who make an object of a FILE that was read already. */
typedef struct cli_place {
    io_contents *contents; /* is moved */
    const double *origin;  /* of the scene, mm; NULL: the object's own */
} cli_place;

/* What --backdrop shows of a velocity volume: size[0] * size[1] * size[2] voxels, x fastest. */
typedef struct cli_volume {
    uint32_t size[3];
    double to_mm[12]; /* rows of a 3x4 matrix: voxel index to mm, absolute */
    float *fastest;   /* owned; greatest speed of the beat, m/s */
    float *inside;    /* owned; at least 0.5: in the vessel; smooth, so that its outline is */
} cli_volume;

/* What --outline shows. */
typedef struct cli_outline {
    uint32_t vertex_count, triangle_count;
    float *positions;    /* owned; 3 per vertex, mm, relative to the scene's origin */
    uint32_t *triangles; /* owned */
} cli_outline;

/* Everything that is drawn. Points are relative to `origin`, which is the first set's. */
typedef struct cli_scene {
    const lao_module *modules[CLI_MODULES]; /* that its objects want */
    uint32_t module_count;
    cli_set *sets; /* owned; those of lines first, but for lineao surface */
    uint32_t count;
    cli_object **objects; /* owned; in order of the FILEs */
    uint32_t object_count;
    double origin[3];
    float direction[3], up[3]; /* of the automatic camera */
    cli_volume *volumes;       /* owned; none unless --backdrop asks for them */
    uint32_t volume_count;
    cli_outline outline; /* no triangles unless --outline asks for it */
    bool turns;          /* its frames are of one turn around it: all are framed at once */
    double beat[2];      /* first and last time (ms); equal: none */
    double period;       /* ms: of the first set that repeats, else from first to last time */
} cli_scene;

/* Loads what the options name. False: reported, nothing to free. */
bool cli_scene_load(const cli_options *options, cli_scene *out);
void cli_scene_free(cli_scene *scene);

/* One more set behind those of a scene, all zero; it may move them. NULL: reported. */
cli_set *cli_scene_add(cli_scene *scene);
/* Moves all sets of `part` behind those of a scene. False: reported. */
bool cli_scene_join(cli_scene *scene, cli_scene *part);

/* Prints the warnings of all files. */
void cli_scene_warn(const cli_scene *scene);

/* Reads a file with a progress bar; Ctrl-C cancels. False: reported. */
bool cli_read_file(const cli_source *source, io_lines *out);
/* The same for any kinds of content (IO_LINES, ...). */
bool cli_read(const cli_source *source, unsigned wanted, io_contents *out);

/* Colours the sets as their sources say. Sets that are coloured by the same attribute, map and
 * range share one range, so that a colour is one value in the whole picture. False: reported. */
bool cli_colour(cli_scene *scene);

/* Lawonn 2014, 5.2: beta is twice the median of the lines' last times, in ms^2; 0: no line has one.
 * The set has times. */
float cli_usual_beta(const cli_set *set);

/* Do both sets show the same values in the same colours? Then one legend tells of both. */
bool cli_same_scale(const cli_set *a, const cli_set *b);

#endif
