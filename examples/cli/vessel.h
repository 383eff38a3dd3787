/* A vessel tree on its way to a picture: tree, 2D layout, distances, shapes, field, colours. */
#ifndef LINEAO_CLI_VESSEL_H
#define LINEAO_CLI_VESSEL_H

#include "dump.h"
#include "io_vessel.h"
#include "legend.h"
#include "picture.h"
#include "threads.h"

/* Shapes that a tree is combined with. */
typedef struct cli_carving {
    sdv_shape list[CLI_SHAPES];
    float *fields; /* owned; samples of the shapes from files */
    sdv_shapes shapes;
} cli_carving;

/* A path or target as something to be drawn: a tree of its own, or one that is nothing but the
 * shape added to it. */
typedef struct cli_marker {
    sdv_tree tree;
    sdv_grid grid;
    cli_carving carving;
    uint8_t *colors; /* owned */
    sdv_object object;
    sdv_settings settings;
} cli_marker;

typedef struct cli_tree {
    const cli_options *options;
    const cli_source *source;
    const char *name; /* path, or "liver" */
    cli_threads *threads;
    cli_progress progress;
    sdv_host host;
    io_contents contents;  /* of the file; its tree's warnings are kept */
    io_vessel vessel;      /* positions in mm, minus vessel.origin */
    sdv_attribute *forms;  /* owned; in place of the tree's attributes where flags add some */
    float *form_values[2]; /* owned; theirs */
    sdv_reduced reduced;
    sdv_layout layout;
    const cli_target_option *aim; /* which of the options' targets; NULL: none */
    sdv_target *target;           /* NULL: neither --path nor --target */
    double risk;                  /* mm; 0: nothing is at risk */
    float *distances;             /* owned; per reduced node, mm; NULL without a target */
    float *cone_distances;        /* owned; of segments and balls, as --tree counts them */
    uint32_t cone_count;
    cli_carving carving;
    sdv_grid grid; /* by_device: the object's, box and cones alone */
    bool by_device;
    double grid_seconds;
    uint8_t *colors;   /* owned; 8 per cone */
    const char *value; /* what the colours show; NULL: no number */
    double range[2];   /* its values at both ends of the colour map */
    const char *colormap;
    vsf_mesh mesh; /* instead of a tree: a surface, positions as the tree's */
    sdv_object object;
    sdv_settings settings;
    cli_marker marker; /* of the target, where it is drawn */
    cli_scene scene;   /* a set that has the object; before it one of the marker */
} cli_tree;

/* Reads or makes the tree, and what the options ask for but the field. place: (Optional) among
 * others in a scene. index: of the path or target that is measured to. False: reported; free it in
 * any case. */
bool cli_tree_load(const cli_options *options, const cli_place *place, uint32_t index,
                   cli_tree *out);
/* Then: field, colours, object and scene, for rendering. False: reported. */
bool cli_tree_prepare(cli_tree *tree);
/* Makes the period of ink and marks a number of pixels of the shot, unless it is given. */
void cli_tree_fit_period(cli_tree *tree, const cli_shot *shot);
void cli_tree_free(cli_tree *tree);

/* The warning i of all about the tree; false: there are fewer. */
bool cli_tree_warning(const cli_tree *tree, uint32_t i, char *text, size_t size);
/* A cli_planes_edit of a cli_tree: positions become absolute; what the field does not know is
 * added, mask and distance. */
bool cli_tree_planes(void *user, cli_planes *planes);

/* A surface instead of a tree: that of the file, once it is read, or --surface. False: reported. */
bool cli_tree_mesh(cli_tree *tree);
/* Its object. False: reported. */
bool cli_tree_mesh_object(cli_tree *tree);
/* Reads --pattern into the object. False: reported. */
bool cli_tree_pattern(cli_tree *tree);

/* Reads --subtract and its like into tree->carving. False: reported. */
bool cli_carving_make(cli_tree *tree);
/* Reads tree->aim into tree->target. False: reported. */
bool cli_target_make(cli_tree *tree);
/* Makes tree->marker of tree->aim. False: reported. */
bool cli_marker_make(cli_tree *tree);
void cli_marker_free(cli_marker *marker);
/* Signed distance of a node's ball to the target, mm. */
float cli_node_distance(const cli_tree *tree, uint32_t node);
/* Colours of the cones' ends, as the source says; what is at risk is marked. False: reported. */
bool cli_tree_colour(cli_tree *tree);
/* The scale of the colours, if they show a number; its map and title are kept in the others. */
bool cli_tree_scale(const cli_tree *tree, colour_map *map, char title[160], legend *out);
/* The same beside a picture, at a side ("left", ...; "off" or NULL: none). False: reported. */
bool cli_tree_legend(const cli_tree *tree, const char *side, picture *p);
/* What a picture of this size has no room for, in words, or "". False: reported. */
bool cli_tree_legend_check(const cli_tree *tree, const char *side, const uint32_t size[2],
                           char note[CLI_NOTE]);

/* How wide a layout's edges are: by the roots of their vessels' radii, in the page's unit. */
typedef struct cli_edges {
    double thin, thick;   /* half of the thinnest and of the widest */
    double least, widest; /* roots of radii, mm */
} cli_edges;
/* pixel: the size of one on the page. */
cli_edges cli_edges_make(const cli_tree *tree, double width, double height, double pixel);
double cli_edge_half(const cli_edges *edges, const cli_tree *tree, uint32_t node);

/* The 2D layout drawn by the backend into a view of its own, for --layout NAME.png, in the colours
 * of the tree, which is prepared. False: reported, nothing to free. */
bool cli_layout_picture(const cli_tree *tree, picture *p);

/* The 2D layout as a picture, in the colours of the tree; with a target on the distances between
 * (L19 5, Fig. 10). False: reported. */
bool cli_flat_draw(const cli_tree *tree, picture *p);
/* Where a node on the edge above a branch (reduced node) lies in such a picture, px; not on the
 * edge's ends, which other branches share. Returns how wide the edge is there, px. */
double cli_flat_place(const cli_tree *tree, const uint32_t size[2], uint32_t branch, uint32_t node,
                      double out[2]);

#endif
