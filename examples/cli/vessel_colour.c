/* Colours of a tree's segments: by the 2D layout, or by a number through a colour map. */
#include "vessel.h"

#include "colour.h"
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Hue and saturation of the reduced node whose edge a node lies on, as the drawing of the layout
 * shows (L19 3.1); but no branch is white, which a picture with light and shade would not tell from
 * grey. */
static void layout_colour(const cli_tree *tree, uint32_t node, double rgb[3]) {
    uint32_t owner = tree->reduced.owners[node];
    lao_v3 c = owner == SDV_NONE
                   ? lao_v3_make(0.7f, 0.7f, 0.7f)
                   : sdv_hsv(tree->layout.h[owner], 0.35f + 0.5f * tree->layout.s[owner], 0.96f);
    rgb[0] = (double)c.x;
    rgb[1] = (double)c.y;
    rgb[2] = (double)c.z;
}

/* ---- numbers: `values` has two for each cone, of its first and its second end ------------ */

static void put_nodes(const cli_tree *tree, const double *nodes, double *values) {
    for (uint32_t i = 0; i < 2 * tree->grid.cone_count; i++)
        values[i] = nodes[tree->grid.cone_nodes[i]];
}

/* How many branchings lie above a node. */
static void branch_orders(const sdv_tree *t, double *nodes) {
    for (uint32_t i = 0; i < t->node_count; i++) {
        uint32_t node = t->order[i], parent = t->parents[node];
        nodes[node] =
            parent == SDV_NONE ? 0 : nodes[parent] + (t->child_counts[parent] >= 2 ? 1 : 0);
    }
}

/* Components of a row as one number: the value, or the length of a vector. */
static double magnitude(const sdv_attribute *attribute, uint32_t row) {
    uint32_t components = attribute->components ? attribute->components : 1;
    const float *v = attribute->values + (size_t)row * components;
    double sum = 0;
    for (uint32_t k = 0; k < components; k++)
        sum += (double)v[k] * v[k];
    return components == 1 ? (double)v[0] : sqrt(sum);
}

static const sdv_attribute *find(const sdv_attribute *list, uint32_t count, const char *name) {
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(list[i].name, name) == 0)
            return &list[i];
    }
    return NULL;
}

static bool unknown(const cli_tree *tree, const char *name) {
    const sdv_tree *t = &tree->vessel.tree;
    char names[512] = "";
    for (uint32_t i = 0; i < t->node_attribute_count + t->segment_attribute_count; i++) {
        const sdv_attribute *a = i < t->node_attribute_count
                                     ? &t->node_attributes[i]
                                     : &t->segment_attributes[i - t->node_attribute_count];
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, ", %s", a->name);
    }
    return cli_fail("%s: there is no attribute '%s' to colour by; there are layout, radius, order, "
                    "distance%s",
                    tree->name, name, names);
}

/* False: reported. */
static bool find_values(const cli_tree *tree, const char *name, double *values) {
    const sdv_tree *t = &tree->vessel.tree;
    const sdv_attribute *at = find(t->node_attributes, t->node_attribute_count, name);
    const sdv_attribute *on = find(t->segment_attributes, t->segment_attribute_count, name);
    bool radius = strcmp(name, "radius") == 0, order = strcmp(name, "order") == 0;
    bool distance = strcmp(name, "distance") == 0;
    if (!radius && !order && !distance && !at && on) {
        for (uint32_t i = 0; i < 2 * tree->grid.cone_count; i++)
            values[i] = i / 2 < t->segment_count ? magnitude(on, i / 2) : (double)NAN;
        return true;
    }
    if (!radius && !order && !distance && !at)
        return unknown(tree, name);
    double *nodes = cli_new(t->node_count, sizeof *nodes);
    if (!nodes)
        return false;
    if (order)
        branch_orders(t, nodes);
    for (uint32_t i = 0; i < t->node_count && !order; i++) {
        const lao_v4 *n = &t->nodes[i];
        nodes[i] = radius ? (double)n->w
                   : distance
                       ? (double)sdv_target_point(tree->target, lao_v3_make(n->x, n->y, n->z)) -
                             (double)n->w
                       : magnitude(at, i);
    }
    put_nodes(tree, nodes, values);
    free(nodes);
    return true;
}

/* ---- colours ---------------------------------------------------------------------------- */

static void put(uint8_t *to, const double rgb[3]) {
    for (int k = 0; k < 3; k++)
        to[k] = colour_byte(rgb[k]);
    to[3] = 255;
}

static bool colour_values(cli_tree *tree, const char *name) {
    uint32_t count = 2 * tree->grid.cone_count;
    double *values = cli_new(2 * (size_t)count, sizeof *values), range[2];
    colour_map *map = cli_new(1, sizeof *map);
    bool ok = values && map && find_values(tree, name, values);
    if (ok) {
        memcpy(values + count, values, count * sizeof *values); /* is reordered */
        colour_range(values + count, count, tree->source->range, range);
        colour_map_make(tree->source->colormap, map);
    }
    for (uint32_t i = 0; ok && i < count; i++) {
        double rgb[3];
        colour_map_at(map, (values[i] - range[0]) / (range[1] - range[0]), rgb);
        put(tree->colors + 4 * (size_t)i, rgb);
    }
    free(map);
    free(values);
    return ok;
}

bool cli_tree_colour(cli_tree *tree) {
    const char *color = tree->source->color;
    uint32_t count = 2 * tree->grid.cone_count;
    double rgb[4];
    tree->colors = cli_new(count, 4);
    if (!tree->colors)
        return false;
    if (!color)
        color = tree->target ? "distance" : "layout";
    bool one = cli_parse_color(color, rgb);
    if (!one && strcmp(color, "layout") != 0)
        return colour_values(tree, color);
    for (uint32_t i = 0; i < count; i++) {
        if (!one)
            layout_colour(tree, tree->grid.cone_nodes[i], rgb);
        put(tree->colors + 4 * (size_t)i, rgb);
    }
    return true;
}
