/* The 2D layout through the backend: it is a tree in a plane (sdv_layout_tree), seen from above. */
#include "vessel.h"

#include "camera.h"
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAST_CELLS = 64, MOST_CELLS = 512 };

typedef struct drawing {
    const cli_tree *tree;
    const cli_options *options;
    sdv_tree flat;
    sdv_grid grid;
    uint8_t *tones, *colors; /* owned: 4 per node, 8 per cone */
    sdv_object object;
    sdv_settings settings;
    cli_scene scene;
    cli_shot shot;
    cli_session session;
    cli_edges edges; /* mm */
    double pixel;    /* mm */
} drawing;

/* As in the linked view; extra nodes are as wide as theirs. */
static void set_widths(drawing *d) {
    const cli_tree *tree = d->tree;
    const sdv_reduced *r = &tree->reduced;
    for (uint32_t i = 0; i < tree->vessel.tree.node_count; i++)
        d->flat.nodes[i].w = (float)cli_edge_half(&d->edges, tree, i);
    for (uint32_t i = 0; i < r->node_count; i++)
        d->flat.nodes[r->ids[i]].w = (float)cli_edge_half(&d->edges, tree, r->nodes[i]);
}

/* As large as the picture, in which the smaller side is 100 mm. */
static bool make_tree(drawing *d) {
    sdv_drawing_desc desc;
    double side = fmin(d->options->size[0], d->options->size[1]);
    memset(&desc, 0, sizeof desc);
    desc.width = (float)(100 * d->options->size[0] / side);
    desc.height = (float)(100 * d->options->size[1] / side);
    desc.radial = d->tree->source->layout.layout_radial > 0;
    if (sdv_layout_tree(&d->tree->host, &d->tree->vessel.tree, &d->tree->reduced, &d->tree->layout,
                        &desc, &d->flat) != LAO_OK)
        return false;
    d->pixel = 100 / side;
    d->edges = cli_edges_make(d->tree, (double)desc.width, (double)desc.height, d->pixel);
    set_widths(d);
    return true;
}

/* The finer the more nodes there are. */
static bool make_grid(drawing *d) {
    sdv_grid_desc desc;
    double cells = 16 * sqrt(d->flat.node_count);
    memset(&desc, 0, sizeof desc);
    desc.resolution = (uint32_t)fmin(fmax(cells, LEAST_CELLS), MOST_CELLS);
    return sdv_grid_build(&d->tree->host, &d->flat, &desc, &d->grid) == LAO_OK;
}

/* Those of the tree's cones, by node; extra nodes have those of their edge. */
static bool make_colors(drawing *d) {
    const cli_tree *tree = d->tree;
    const sdv_reduced *r = &tree->reduced;
    d->tones = cli_new(d->flat.node_count, 4);
    d->colors = cli_new(d->grid.cone_count, 8);
    if (!d->tones || !d->colors)
        return false;
    for (uint32_t i = 0; i < 2 * tree->grid.cone_count; i++)
        memcpy(d->tones + 4 * (size_t)tree->grid.cone_nodes[i], tree->colors + 4 * (size_t)i, 4);
    for (uint32_t i = 0; i < r->node_count; i++)
        memmove(d->tones + 4 * (size_t)r->ids[i], d->tones + 4 * (size_t)r->nodes[i], 4);
    for (uint32_t i = 0; i < 2 * d->grid.cone_count; i++)
        memcpy(d->colors + 4 * (size_t)i, d->tones + 4 * (size_t)d->grid.cone_nodes[i], 4);
    return true;
}

/* Flat colours and an outline, which is thinner where edges are. */
static void make_settings(const drawing *d, sdv_settings *s) {
    memset(s, 0, sizeof *s);
    s->surface_ambient = 1;
    s->silhouette = (float)fmin(0.8, 0.7 * d->edges.thin / d->pixel);
    s->set = SDV_SET(surface_ambient) | SDV_SET(surface_diffuse) | SDV_SET(surface_specular) |
             SDV_SET(field_occlusion) | SDV_SET(joint_smoothness) | SDV_SET(contour) |
             SDV_SET(shadow_strength) | SDV_SET(silhouette);
}

static bool make_scene(drawing *d) {
    cli_scene *scene = &d->scene;
    cli_set *set = scene->sets = cli_new(1, sizeof *set);
    if (!set)
        return false;
    memset(set, 0, sizeof *set);
    scene->count = 1;
    scene->modules[scene->module_count++] = sdv_module();
    camera_view("axial", scene->direction, scene->up);
    make_settings(d, &d->settings);
    set->source = d->tree->source;
    set->name = d->tree->name;
    set->settings = d->tree->source->settings;
    set->object = &d->object.desc;
    set->module_settings[0] = &d->settings;
    set->lines.point_count = d->flat.node_count;
    set->lines.points = cli_new(d->flat.node_count, 12);
    for (uint32_t i = 0; set->lines.points && i < d->flat.node_count; i++)
        memcpy(set->lines.points + 3 * (size_t)i, &d->flat.nodes[i], 12);
    return set->lines.points != NULL;
}

static bool draw(drawing *d, picture *p) {
    cli_options options = *d->options; /* whatever camera the tree is seen with */
    options.camera = NULL;
    options.view = NULL;
    options.ortho = true;
    options.vessel.margin = 0;
    return make_tree(d) && make_grid(d) && make_colors(d) &&
           sdv_object_make(&d->tree->host, &d->grid, d->colors, &d->object) == LAO_OK &&
           make_scene(d) && cli_shot_make(&options, &d->scene, &d->shot) &&
           cli_session_open(&d->session, options.backend, &d->scene, &d->shot, 0) &&
           cli_session_render(&d->session, &d->shot, 0) && cli_session_picture(&d->session, p);
}

bool cli_layout_picture(const cli_tree *tree, picture *p) {
    drawing *d = cli_new(1, sizeof *d);
    if (!d)
        return false;
    memset(d, 0, sizeof *d);
    d->tree = tree;
    d->options = tree->options;
    bool ok = draw(d, p);
    cli_session_close(&d->session);
    cli_scene_free(&d->scene);
    sdv_object_free(&d->object);
    free(d->tones);
    free(d->colors);
    sdv_grid_free(&d->grid);
    sdv_tree_free(&d->flat);
    free(d);
    return ok;
}
