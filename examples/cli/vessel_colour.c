/* Colours of a tree's segments: by the 2D layout, or by a number through a colour map. */
#include "vessel.h"

#include "legend.h"
#include "legends.h"
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

float cli_node_distance(const cli_tree *tree, uint32_t node) {
    const lao_v4 *n = &tree->vessel.tree.nodes[node];
    return sdv_target_point(tree->target, lao_v3_make(n->x, n->y, n->z)) - n->w;
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
        nodes[i] = radius     ? (double)t->nodes[i].w
                   : distance ? (double)cli_node_distance(tree, i)
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

/* Distances with a risk: its threshold is the middle of the map, the near side red. */
static void choose_scale(cli_tree *tree, double *values, uint32_t count) {
    const colour_end *ends = tree->source->range;
    bool whole = ends[0].percent && ends[0].value == 0 && ends[1].percent && ends[1].value == 100;
    bool risky = tree->risk > 0 && strcmp(tree->value, "distance") == 0;
    tree->colormap = tree->source->colormap ? tree->source->colormap
                     : risky                ? "coolwarm"
                                            : "viridis";
    tree->range[0] = 2 * tree->risk;
    tree->range[1] = 0;
    if (!risky || !whole)
        colour_range(values, count, ends, tree->range);
}

static bool colour_values(cli_tree *tree, const char *name) {
    uint32_t count = 2 * tree->grid.cone_count;
    double *values = cli_new(2 * (size_t)count, sizeof *values);
    colour_map *map = cli_new(1, sizeof *map);
    bool ok = values && map && find_values(tree, name, values);
    if (ok) {
        memcpy(values + count, values, count * sizeof *values); /* is reordered */
        tree->value = name;
        choose_scale(tree, values + count, count);
        colour_map_make(tree->colormap, map);
    }
    for (uint32_t i = 0; ok && i < count; i++) {
        double rgb[3];
        colour_map_at(map, (values[i] - tree->range[0]) / (tree->range[1] - tree->range[0]), rgb);
        put(tree->colors + 4 * (size_t)i, rgb);
    }
    free(map);
    free(values);
    return ok;
}

/* Alpha below 1/2 where the distance between a cone's ends is below the risk, and all along a cone
 * that comes nearer between its ends. `span`: the most that two ends differ by, so that no place
 * where the risk begins is lost to the 8 bits. */
static void mark(cli_tree *tree, const float *ends, float span) {
    float risk = (float)tree->risk;
    for (uint32_t i = 0; i < 2 * tree->grid.cone_count; i++) {
        const float *pair = ends + (i & ~1u);
        bool between = tree->cone_distances[i / 2] < risk && !(pair[0] < risk) && !(pair[1] < risk);
        float alpha = 127.5f + 127.5f * (ends[i] - risk) / span;
        tree->colors[4 * (size_t)i + 3] =
            between ? 0 : (uint8_t)(fminf(fmaxf(alpha, 0), 255) + (ends[i] < risk ? 0 : 0.5f));
    }
}

static bool mark_risk(cli_tree *tree) {
    uint32_t count = 2 * tree->grid.cone_count;
    float *ends = cli_new(count, sizeof *ends), span = 1e-6f;
    for (uint32_t i = 0; ends && i < count; i++) {
        ends[i] = cli_node_distance(tree, tree->grid.cone_nodes[i]);
        span = i % 2 ? fmaxf(span, fabsf(ends[i] - ends[i - 1])) : span;
    }
    if (ends)
        mark(tree, ends, span);
    free(ends);
    return ends != NULL;
}

/* What a number is measured in, as far as is known. */
static const char *unit_of(const char *value) {
    return strcmp(value, "distance") == 0 || strcmp(value, "radius") == 0 ? " (mm)" : "";
}

/* A map whose low end shows the greater value is turned round, so that numbers rise. */
static void rise(colour_map *map, double range[2]) {
    double low = range[1];
    if (!(range[0] > range[1]))
        return;
    range[1] = range[0];
    range[0] = low;
    for (int i = 0; i < COLOUR_STEPS / 2; i++) {
        for (int k = 0; k < 3; k++) {
            double *other = &map->rgb[COLOUR_STEPS - 1 - i][k], rgb = *other;
            *other = map->rgb[i][k];
            map->rgb[i][k] = rgb;
        }
        colour_lab lab = map->lab[i];
        map->lab[i] = map->lab[COLOUR_STEPS - 1 - i];
        map->lab[COLOUR_STEPS - 1 - i] = lab;
    }
}

bool cli_tree_scale(const cli_tree *tree, colour_map *map, char title[160], legend *out) {
    if (!tree->value)
        return false;
    *out = (legend){map, {tree->range[0], tree->range[1]}, title};
    colour_map_make(tree->colormap, map);
    rise(map, out->range);
    snprintf(title, 160, "%s%s", tree->value, unit_of(tree->value));
    return true;
}

/* Draws the legend into p, or only checks it against a size. */
static bool with_legend(const cli_tree *tree, const char *side, picture *p, const uint32_t *size,
                        char *note) {
    char title[160];
    legend one;
    if (!side || strcmp(side, "off") == 0)
        return true;
    colour_map *map = cli_new(1, sizeof *map);
    if (!map || !cli_tree_scale(tree, map, title, &one)) {
        free(map);
        return map != NULL;
    }
    if (tree->options->legend_title)
        one.title = tree->options->legend_title;
    legend_side where = strcmp(side, "left") == 0    ? LEGEND_LEFT
                        : strcmp(side, "right") == 0 ? LEGEND_RIGHT
                                                     : LEGEND_BOTTOM;
    bool ok = !p || legend_draw(p, where, &one, 1) || cli_fail("out of memory");
    if (!p)
        cli_legends_note(where, &one, 1, size, note);
    free(map);
    return ok;
}

bool cli_tree_legend(const cli_tree *tree, const char *side, picture *p) {
    return with_legend(tree, side, p, NULL, NULL);
}

bool cli_tree_legend_check(const cli_tree *tree, const char *side, const uint32_t size[2],
                           char note[CLI_NOTE]) {
    *note = 0;
    return with_legend(tree, side, NULL, size, note);
}

static bool colour_alike(cli_tree *tree, const double *one) {
    for (uint32_t i = 0; i < 2 * tree->grid.cone_count; i++) {
        double rgb[3];
        if (!one)
            layout_colour(tree, tree->grid.cone_nodes[i], rgb);
        put(tree->colors + 4 * (size_t)i, one ? one : rgb);
    }
    return true;
}

bool cli_tree_colour(cli_tree *tree) {
    const char *color = tree->source->color;
    double rgb[4];
    tree->colors = cli_new(2 * (size_t)tree->grid.cone_count, 4);
    if (!tree->colors)
        return false;
    if (!color)
        color = tree->target ? "distance" : "layout";
    bool one = cli_parse_color(color, rgb);
    bool ok = one || strcmp(color, "layout") == 0 ? colour_alike(tree, one ? rgb : NULL)
                                                  : colour_values(tree, color);
    return ok && (!(tree->risk > 0) || mark_risk(tree));
}
