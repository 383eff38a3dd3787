/* See io_vessel.h. */
#include "io_vessel.h"

#include "io_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The arrays of sdv_tree_desc, as one block each. */
typedef struct arrays {
    float *positions, *radii;
    sdv_segment *segments;
    sdv_attribute *attributes; /* of nodes, then of segments */
} arrays;

static void free_arrays(arrays *a) {
    free(a->positions);
    free(a->radii);
    free(a->segments);
    free(a->attributes);
}

static void find_bounds(const io_tree *tree, const uint32_t *targets, double bounds[2][3]) {
    for (size_t axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < tree->node_count; i++) {
            if (targets && targets[i] == SDV_NONE)
                continue;
            low = fmin(low, tree->positions[3 * i + axis]);
            high = fmax(high, tree->positions[3 * i + axis]);
        }
        bounds[0][axis] = low <= high ? low : 0;
        bounds[1][axis] = low <= high ? high : 0;
    }
}

static void find_radius(const io_tree *tree, const uint32_t *targets, double radius[2]) {
    radius[0] = radius[1] = (double)NAN;
    for (size_t i = 0; i < tree->node_count; i++)
        if (targets[i] != SDV_NONE) {
            radius[0] = fmin(radius[0], tree->radii[i]); /* of a NaN and a number the number */
            radius[1] = fmax(radius[1], tree->radii[i]);
        }
}

static bool make_arrays(const io_tree *tree, const double origin[3], arrays *a) {
    size_t nodes = tree->node_count, segments = tree->segment_count;
    size_t columns = (size_t)tree->node_attribute_count + tree->segment_attribute_count;
    a->positions = malloc((nodes + 1) * 3 * sizeof *a->positions);
    a->radii = malloc((nodes + 1) * sizeof *a->radii);
    a->segments = malloc((segments + 1) * sizeof *a->segments);
    a->attributes = malloc((columns + 1) * sizeof *a->attributes);
    if (!a->positions || !a->radii || !a->segments || !a->attributes)
        return false;
    for (size_t i = 0; i < 3 * nodes; i++)
        a->positions[i] = (float)(tree->positions[i] - origin[i % 3]);
    for (size_t i = 0; i < nodes; i++)
        a->radii[i] = (float)tree->radii[i];
    for (size_t i = 0; i < segments; i++) {
        a->segments[i].parent = tree->segments[2 * i];
        a->segments[i].child = tree->segments[2 * i + 1];
    }
    for (size_t i = 0; i < columns; i++) {
        const io_attribute *from = i < tree->node_attribute_count
                                       ? &tree->node_attributes[i]
                                       : &tree->segment_attributes[i - tree->node_attribute_count];
        sdv_attribute to = {from->name, from->components, from->data};
        a->attributes[i] = to;
    }
    return true;
}

/* The last failure becomes the error's text. */
static void on_log(void *user, sdv_log_item item, lao_result result, const char *text) {
    (void)item;
    if (result != LAO_OK)
        io_error_set(user, "cannot become a tree: %s", text);
}

static bool build(const sdv_host *host, const io_tree *tree, const double origin[3], sdv_tree *out,
                  io_error *error) {
    static const uint32_t flags[] = {0, SDV_TREE_MERGE | SDV_TREE_DROP,
                                     SDV_TREE_MERGE | SDV_TREE_DROP | SDV_TREE_UNDIRECTED,
                                     SDV_TREE_LINES};
    arrays a = {NULL, NULL, NULL, NULL};
    sdv_tree_desc desc;
    sdv_host quiet;
    memset(&desc, 0, sizeof desc);
    memset(&quiet, 0, sizeof quiet);
    if (host)
        quiet = *host;
    quiet.log = on_log;
    quiet.user = error;
    bool done = make_arrays(tree, origin, &a);
    if (!done)
        io_error_set(error, "needs memory, which the system does not give");
    desc.node_count = tree->node_count;
    desc.positions = a.positions;
    desc.radii = a.radii;
    desc.segment_count = tree->segment_count;
    desc.segments = a.segments;
    desc.flags = flags[tree->kind];
    desc.node_attributes = a.attributes;
    desc.node_attribute_count = tree->node_attribute_count;
    desc.segment_attributes = a.attributes ? a.attributes + tree->node_attribute_count : NULL;
    desc.segment_attribute_count = tree->segment_attribute_count;
    done = done && sdv_tree_build(&quiet, &desc, out) == LAO_OK;
    free_arrays(&a);
    return done;
}

/* From the file's unit to mm. */
static void scale(sdv_tree *tree, double by) {
    float factor = (float)by;
    for (uint32_t i = 0; i < tree->node_attribute_count; i++) {
        const sdv_attribute *a = &tree->node_attributes[i];
        float *values = (float *)a->values; /* the tree's own */
        for (size_t k = 0; k < tree->node_count && !strcmp(a->name, SDV_UNCERTAINTY); k++)
            values[k] *= factor;
    }
    for (uint32_t i = 0; i < tree->node_count; i++) {
        lao_v4 *node = &tree->nodes[i];
        node->x = (float)(by * (double)node->x);
        node->y = (float)(by * (double)node->y);
        node->z = (float)(by * (double)node->z);
        node->w = (float)(by * (double)node->w);
    }
    for (int i = 0; i < 2; i++) {
        tree->info.radius[i] *= factor;
        for (int axis = 0; axis < 3; axis++)
            tree->info.bounds[i][axis] *= factor;
    }
}

bool io_vessel_build(const sdv_host *host, const io_tree *tree, io_vessel *out, io_error *error) {
    io_vessel vessel;
    memset(&vessel, 0, sizeof vessel);
    find_bounds(tree, NULL, vessel.bounds);
    io_find_origin((const double(*)[3])vessel.bounds, vessel.origin);
    if (!build(host, tree, vessel.origin, &vessel.tree, error))
        return false;
    find_bounds(tree, vessel.tree.node_targets, vessel.bounds);
    find_radius(tree, vessel.tree.node_targets, vessel.radius);
    if (tree->millimetres != 1)
        scale(&vessel.tree, tree->millimetres);
    for (int axis = 0; axis < 3; axis++)
        vessel.origin[axis] *= tree->millimetres;
    *out = vessel;
    return true;
}

void io_vessel_free(io_vessel *vessel) {
    if (!vessel)
        return;
    sdv_tree_free(&vessel->tree);
    memset(vessel, 0, sizeof *vessel);
}
