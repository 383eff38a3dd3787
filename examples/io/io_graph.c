/* Trees: the builder, units, and handing over. */
#include "io_graph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Units ----------------------------------------------------------------------------------- */

typedef struct unit {
    const char *name;
    double millimetres;
    const char *words[6];
} unit;

// clang-format off
static const unit units[] = {
    {"mm", 1,    {"mm", "millimetre", "millimetres", "millimeter", "millimeters"}},
    {"cm", 10,   {"cm", "centimetre", "centimetres", "centimeter", "centimeters"}},
    {"um", 1e-3, {"um", "\xC2\xB5m", "\xCE\xBCm", "micron", "microns", "micrometer"}},
    {"um", 1e-3, {"micrometre", "micrometres", "micrometers"}},
    {"nm", 1e-6, {"nm", "nanometre", "nanometres", "nanometer", "nanometers"}},
    {"m",  1e3,  {"m", "metre", "metres", "meter", "meters"}},
};
// clang-format on
enum { UNITS = sizeof units / sizeof units[0], WORDS = 6 };

const char *io_unit_named(io_text text) {
    for (size_t i = 0; i < UNITS; i++)
        for (size_t k = 0; k < WORDS && units[i].words[k]; k++)
            if (io_text_is(text, units[i].words[k]))
                return units[i].name;
    return NULL;
}

double io_unit_millimetres(const char *name) {
    for (size_t i = 0; i < UNITS; i++)
        if (!strcmp(units[i].name, name))
            return units[i].millimetres;
    return 1;
}

/* ---- Building -------------------------------------------------------------------------------- */

io_graph *io_graph_new(io_reader *r, io_tree_kind kind) {
    r->graph = io_alloc(r, 1, sizeof *r->graph);
    if (r->graph)
        r->graph->kind = kind;
    return r->graph;
}

/* One more item in arrays that grow together; the sizes are those of an item in each. */
static bool grow_together(io_reader *r, void **arrays[3], const size_t sizes[3], size_t count,
                          size_t *capacity) {
    if (count == UINT32_MAX)
        return io_fail(r, "has more than 4294967295 nodes or segments; that is the most supported");
    if (count < *capacity)
        return true;
    size_t grown = *capacity;
    for (int i = 0; i < 3; i++) {
        grown = *capacity;
        void *array = io_grow(r, *arrays[i], &grown, count + 1, sizes[i]);
        if (!array)
            return false;
        *arrays[i] = array;
    }
    *capacity = grown;
    return true;
}

static double radius_or_none(double radius) {
    return radius >= 0 && radius < 1e30 ? radius : (double)NAN;
}

bool io_graph_add_node(io_reader *r, const double p[3], double radius, size_t row) {
    io_graph *g = r->graph;
    void *positions = g->positions, *radii = g->radii, *rows = g->node_rows;
    void **arrays[3] = {&positions, &radii, &rows};
    const size_t sizes[3] = {3 * sizeof *g->positions, sizeof *g->radii, sizeof *g->node_rows};
    bool room = grow_together(r, arrays, sizes, g->node_count, &g->node_capacity);
    g->positions = positions;
    g->radii = radii;
    g->node_rows = rows;
    if (!room)
        return false;
    for (size_t axis = 0; axis < 3; axis++)
        g->positions[3 * g->node_count + axis] = p[axis] + 0.0; /* -0 becomes 0 */
    g->radii[g->node_count] = radius_or_none(radius);
    g->node_rows[g->node_count++] = (uint32_t)row;
    return true;
}

bool io_graph_add_segment(io_reader *r, size_t parent, size_t child, double radius, size_t row) {
    io_graph *g = r->graph;
    void *segments = g->segments, *widths = g->widths, *rows = g->segment_rows;
    void **arrays[3] = {&segments, &widths, &rows};
    const size_t sizes[3] = {2 * sizeof *g->segments, sizeof *g->widths, sizeof *g->segment_rows};
    bool room = grow_together(r, arrays, sizes, g->segment_count, &g->segment_capacity);
    g->segments = segments;
    g->widths = widths;
    g->segment_rows = rows;
    if (!room)
        return false;
    g->segments[2 * g->segment_count] = (uint32_t)parent;
    g->segments[2 * g->segment_count + 1] = (uint32_t)child;
    g->widths[g->segment_count] = radius_or_none(radius);
    g->segment_rows[g->segment_count++] = (uint32_t)row;
    return true;
}

static void widen(double *radius, double width) {
    if (!(*radius >= width) && width >= 0)
        *radius = width;
}

bool io_graph_spread_radii(io_reader *r) {
    io_graph *g = r->graph;
    bool *told = io_alloc(r, g->node_count, sizeof *told);
    if (!told)
        return false;
    for (size_t i = 0; i < g->segment_count; i++)
        widen(&g->radii[g->segments[2 * i + 1]], g->widths[i]);
    for (size_t i = 0; i < g->node_count; i++)
        told[i] = !isnan(g->radii[i]);
    for (size_t i = 0; i < g->segment_count; i++)
        if (!told[g->segments[2 * i]])
            widen(&g->radii[g->segments[2 * i]], g->widths[i]);
    return true;
}

/* ---- Handing over ---------------------------------------------------------------------------- */

/* Largest side of the bounding box, and widest radius. */
static void measure(const io_graph *g, double *extent, double *widest) {
    *extent = *widest = 0;
    for (size_t axis = 0; axis < 3 && g->node_count; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < g->node_count; i++) {
            low = fmin(low, g->positions[3 * i + axis]);
            high = fmax(high, g->positions[3 * i + axis]);
        }
        *extent = fmax(*extent, high - low);
    }
    for (size_t i = 0; i < g->node_count; i++)
        *widest = g->radii[i] > *widest ? g->radii[i] : *widest;
}

/* No vessel of a human is longer than 2 m; in cm, radii hardly reach 1.5. */
static bool guess_unit(io_reader *r, const io_graph *g, io_tree *tree) {
    double extent, widest;
    measure(g, &extent, &widest);
    tree->unit = g->habit                                       ? g->habit
                 : extent > 2000                                ? "um"
                 : g->centimetres && widest > 0 && widest < 1.5 ? "cm"
                                                                : "mm";
    return io_warn(r,
                   "the file tells no unit; by its make and size (%.4g across, radius up to %.4g) "
                   "%s is taken; give --unit mm, cm, um or m if that is wrong",
                   extent, widest, tree->unit);
}

static bool find_unit(io_reader *r, const io_graph *g, io_tree *tree) {
    const char *asked = r->options->unit;
    if (asked && *asked) {
        tree->unit = io_unit_named(io_text_of(asked));
        if (!tree->unit)
            return io_fail(r, "cannot be read in the unit '%.32s'; units are mm, cm, um, nm, m",
                           asked);
    } else if (g->unit) {
        tree->unit = g->unit;
    } else if (!guess_unit(r, g, tree)) {
        return false;
    }
    tree->millimetres = io_unit_millimetres(tree->unit);
    return true;
}

static bool copy_graph(io_reader *r, const io_graph *g, io_tree *tree) {
    size_t nodes = g->node_count, segments = g->segment_count;
    tree->positions = io_take_memory(r, nodes, 3 * sizeof *tree->positions);
    tree->radii = io_take_memory(r, nodes, sizeof *tree->radii);
    tree->segments = io_take_memory(r, segments, 2 * sizeof *tree->segments);
    if (!tree->positions || !tree->radii || !tree->segments)
        return false;
    tree->node_count = (uint32_t)nodes;
    tree->segment_count = (uint32_t)segments;
    if (nodes) {
        memcpy(tree->positions, g->positions, nodes * 3 * sizeof *tree->positions);
        memcpy(tree->radii, g->radii, nodes * sizeof *tree->radii);
    }
    if (segments)
        memcpy(tree->segments, g->segments, segments * 2 * sizeof *tree->segments);
    return true;
}

bool io_finish_tree(io_reader *r, const char *format, io_tree *out) {
    io_graph *g = r->graph;
    io_tree tree;
    memset(&tree, 0, sizeof tree);
    tree.format = format;
    tree.kind = g->kind;
    if (!g->node_count)
        return io_fail(r, "holds no tree: it has no nodes");
    if (find_unit(r, g, &tree) && copy_graph(r, g, &tree) &&
        io_take_columns(r, &g->node_columns, g->node_count, &tree.node_attribute_count,
                        &tree.node_attributes) &&
        io_take_columns(r, &g->segment_columns, g->segment_count, &tree.segment_attribute_count,
                        &tree.segment_attributes) &&
        io_take_warnings(r, &tree.warnings, &tree.warning_count) && io_tick(r, 1, 1)) {
        *out = tree;
        return true;
    }
    io_tree_free(&tree);
    return false;
}

void io_tree_free(io_tree *tree) {
    if (!tree)
        return;
    free(tree->positions);
    free(tree->radii);
    free(tree->segments);
    io_free_attributes(tree->node_attributes, tree->node_attribute_count);
    io_free_attributes(tree->segment_attributes, tree->segment_attribute_count);
    io_free_warnings(tree->warnings, tree->warning_count);
    memset(tree, 0, sizeof *tree);
}
