/* A vessel tree on its way to a picture: tree, 2D layout, distances, shapes, field, colours. */
#ifndef LINEAO_CLI_VESSEL_H
#define LINEAO_CLI_VESSEL_H

#include "dump.h"
#include "io_vessel.h"
#include "threads.h"

/* Shapes that the tree is combined with. */
typedef struct cli_carving {
    sdv_shape list[CLI_SHAPES];
    float *fields; /* owned; samples of the shapes from files */
    sdv_shapes shapes;
} cli_carving;

typedef struct cli_tree {
    const cli_options *options;
    const cli_source *source;
    const char *name; /* path, or "liver" */
    cli_threads *threads;
    cli_progress progress;
    sdv_host host;
    io_contents contents; /* of the file; its tree's warnings are kept */
    io_vessel vessel;     /* positions in mm, minus vessel.origin */
    sdv_reduced reduced;
    sdv_layout layout;
    sdv_target *target; /* NULL: neither --path nor --target */
    float *distances;   /* owned; per reduced node, mm; NULL without a target */
    cli_carving carving;
    sdv_grid grid;
    double grid_seconds;
    uint8_t *colors; /* owned; 8 per cone; NULL: one colour */
    vsf_mesh mesh;   /* instead of a tree: a surface, positions as the tree's */
    sdv_object object;
    sdv_settings settings;
    cli_scene scene; /* one set that has the object */
} cli_tree;

/* Reads or makes the tree, and what the options ask for but the field. False: reported; free it in
 * any case. */
bool cli_tree_load(const cli_options *options, cli_tree *out);
/* Then: field, colours, object and scene, for rendering. False: reported. */
bool cli_tree_prepare(cli_tree *tree);
void cli_tree_free(cli_tree *tree);

/* A surface instead of a tree: that of the file, once it is read, or --surface. False: reported. */
bool cli_tree_mesh(cli_tree *tree);
/* Its object. False: reported. */
bool cli_tree_mesh_object(cli_tree *tree);
/* Reads --pattern into the object. False: reported. */
bool cli_tree_pattern(cli_tree *tree);

/* Reads --subtract and its like into tree->carving. False: reported. */
bool cli_carving_make(cli_tree *tree);
/* Reads --path and --target into tree->target. False: reported. */
bool cli_target_make(cli_tree *tree);
/* Colours of the cones' ends, as the source says. False: reported. */
bool cli_tree_colour(cli_tree *tree);

#endif
