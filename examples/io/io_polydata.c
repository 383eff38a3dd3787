/* Pieces of VTK's PolyData as what they may be: lines, a tree (lines with a radius), a mesh
 * (polygons and strips). */
#include "io_graph.h"
#include "io_surface.h"

#include <math.h>
#include <string.h>

/* ---- Lines ----------------------------------------------------------------------------------- */

static bool build_lines(io_reader *r, const io_piece *pieces, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const io_piece *p = &pieces[i];
        io_next_batch(r);
        if (!io_add_cells(r, &p->points, &p->lines, p->vertex_cells))
            return false;
        for (size_t k = 0; k < p->array_count; k++) {
            const io_array *a = &p->arrays[k];
            if (!(a->of_points ? io_attach_points : io_attach_lines)(r, a->name, &a->values))
                return false;
        }
    }
    return true;
}

/* ---- Trees ----------------------------------------------------------------------------------- */

/* Names of radii, the best first. */
typedef struct radius_name {
    const char *name, *habit;    /* habit: the unit that files of this make have; NULL = none */
    double factor;               /* to a radius */
    bool of_points, centimetres; /* centimetres: SimVascular uses the name too, in cm */
} radius_name;

// clang-format off
static const radius_name radius_names[] = {
    {"MaximumInscribedSphereRadius", NULL, 1, true, true},
    {"radius",    NULL, 1,   true,  true},
    {"radii",     NULL, 1,   true,  true},
    {"diameter",  "um", 0.5, true,  false}, /* vascpy */
    {"diameters", "um", 0.5, true,  false},
    {"radius",    "um", 1,   false, false},
    {"radii",     "um", 1,   false, false},
    {"diameter",  "um", 0.5, false, false},
    {"diameters", "um", 0.5, false, false},
};
// clang-format on
enum { RADIUS_NAMES = sizeof radius_names / sizeof radius_names[0] };

static const io_array *find_array(const io_piece *p, const radius_name *name) {
    for (size_t i = 0; i < p->array_count; i++) {
        const io_array *a = &p->arrays[i];
        if (a->of_points == name->of_points && a->values.components == 1 &&
            io_text_is(io_text_trim(a->name), name->name))
            return a;
    }
    return NULL;
}

/* The radius that the first piece with lines has; NULL = this is no tree. */
static const radius_name *find_radius(const io_piece *pieces, size_t count) {
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; pieces[i].lines.count && k < RADIUS_NAMES; k++)
            if (find_array(&pieces[i], &radius_names[k]))
                return &radius_names[k];
    return NULL;
}

static double radius_at(const io_array *a, size_t row, const radius_name *name) {
    return a && row < a->values.count ? name->factor * io_view_real(&a->values, row, 0)
                                      : (double)NAN;
}

/* One node per finite point; node_of[point], UINT32_MAX: none. */
static uint32_t *add_nodes(io_reader *r, const io_piece *p, const radius_name *name) {
    const io_array *radii = name->of_points ? find_array(p, name) : NULL;
    uint32_t *node_of = io_alloc(r, p->points.count, sizeof *node_of);
    size_t dropped = 0;
    for (size_t i = 0; node_of && i < p->points.count; i++) {
        double position[3];
        for (uint32_t axis = 0; axis < 3; axis++)
            position[axis] = io_view_real(&p->points, i, axis);
        node_of[i] = UINT32_MAX;
        if (!io_is_position(position)) {
            dropped++;
            continue;
        }
        node_of[i] = (uint32_t)r->graph->node_count;
        if (!io_graph_add_node(r, position, radius_at(radii, i, name), i))
            return NULL;
    }
    if (dropped &&
        !io_warn(r, "%zu points were left out: their coordinates are not finite", dropped))
        return NULL;
    return node_of;
}

static bool add_segments(io_reader *r, const io_piece *p, const radius_name *name,
                         const uint32_t *node_of) {
    const io_array *widths = name->of_points ? NULL : find_array(p, name);
    for (size_t i = 0, at = 0, k, end; i < p->lines.count; i++) {
        uint32_t before = UINT32_MAX;
        size_t row = p->vertex_cells + i;
        if (!io_next_cell(r, &p->lines, i, "line", &at, &k, &end))
            return false;
        for (; k < end; k++) {
            size_t point;
            if (!io_view_index(&p->lines.index, k, &point) || point >= p->points.count)
                return io_fail(r, "line %zu uses a point that is not one of the %zu in the file",
                               i + 1, p->points.count);
            if (node_of[point] == UINT32_MAX)
                continue;
            if (before != UINT32_MAX &&
                !io_graph_add_segment(r, before, node_of[point], radius_at(widths, row, name), row))
                return false;
            before = node_of[point];
        }
        if (i % 4096 == 0 && !io_tick(r, i, p->lines.count))
            return false;
    }
    return true;
}

static bool build_tree(io_reader *r, const io_piece *pieces, size_t count) {
    const radius_name *name = find_radius(pieces, count);
    if (!name || !io_graph_new(r, IO_TREE_LINES))
        return !name;
    io_graph *g = r->graph;
    g->centimetres = name->centimetres;
    g->habit = name->habit;
    for (size_t i = 0; i < count; i++) {
        const io_piece *p = &pieces[i];
        size_t nodes = g->node_count, segments = g->segment_count;
        uint32_t *node_of = p->lines.count ? add_nodes(r, p, name) : NULL;
        if (!p->lines.count)
            continue;
        if (!node_of || !add_segments(r, p, name, node_of))
            return false;
        for (size_t k = 0; k < p->array_count; k++) {
            const io_array *a = &p->arrays[k];
            if (!(a->of_points
                      ? io_attach_rows(r, &g->node_columns, a->name, &a->values, g->node_rows,
                                       nodes, g->node_count, 0, "point")
                      : io_attach_rows(r, &g->segment_columns, a->name, &a->values, g->segment_rows,
                                       segments, g->segment_count, 0, "line")))
                return false;
        }
    }
    return name->of_points || io_graph_spread_radii(r);
}

/* ---- Meshes ---------------------------------------------------------------------------------- */

typedef bool (*add_face)(io_reader *r, const uint32_t *vertices, size_t count, size_t row);

static bool add_faces(io_reader *r, const io_piece *p, const io_cells *cells, size_t first_row,
                      size_t first_vertex, const char *what, add_face add) {
    uint32_t *vertices = NULL;
    size_t capacity = 0;
    for (size_t i = 0, at = 0, begin, end; i < cells->count; i++) {
        if (!io_next_cell(r, cells, i, what, &at, &begin, &end))
            return false;
        vertices = io_grow(r, vertices, &capacity, end - begin, sizeof *vertices);
        if (!vertices)
            return false;
        for (size_t k = begin; k < end; k++) {
            size_t point;
            if (!io_view_index(&cells->index, k, &point) || point >= p->points.count)
                return io_fail(r, "%s %zu uses a point that is not one of the %zu in the file",
                               what, i + 1, p->points.count);
            vertices[k - begin] = (uint32_t)(first_vertex + point);
        }
        if (!add(r, vertices, end - begin, first_row + i) ||
            (i % 4096 == 0 && !io_tick(r, i, cells->count)))
            return false;
    }
    return true;
}

static bool is_normals(const io_array *a) {
    return a->of_points && a->values.components == 3 &&
           io_text_starts(io_text_trim(a->name), "normals");
}

static bool add_normals(io_reader *r, const io_piece *p, size_t first_vertex) {
    for (size_t i = 0; i < p->array_count; i++) {
        io_view normals = p->arrays[i].values;
        if (!is_normals(&p->arrays[i]) || normals.count < p->points.count)
            continue;
        normals.count = p->points.count;
        return io_surface_add_normals(r, first_vertex, &normals);
    }
    return true;
}

static bool add_mesh_piece(io_reader *r, const io_piece *p) {
    io_surface *s = r->surface;
    size_t vertices = s->vertex_count, triangles = s->triangle_count;
    size_t row = p->vertex_cells + p->lines.count;
    for (size_t i = 0; i < p->points.count; i++) {
        double position[3];
        for (uint32_t axis = 0; axis < 3; axis++)
            position[axis] = io_view_real(&p->points, i, axis);
        if (!io_surface_add_vertex(r, position, i))
            return false;
    }
    if (!add_faces(r, p, &p->polygons, row, vertices, "polygon", io_surface_add_polygon) ||
        !add_faces(r, p, &p->strips, row + p->polygons.count, vertices, "strip",
                   io_surface_add_strip) ||
        !add_normals(r, p, vertices))
        return false;
    for (size_t k = 0; k < p->array_count; k++) {
        const io_array *a = &p->arrays[k];
        if (!(a->of_points
                  ? io_attach_rows(r, &s->vertex_columns, a->name, &a->values, s->vertex_rows,
                                   vertices, s->vertex_count, 0, "point")
                  : io_attach_rows(r, &s->triangle_columns, a->name, &a->values, s->triangle_rows,
                                   triangles, s->triangle_count, 0, "polygon")))
            return false;
    }
    return true;
}

static bool build_mesh(io_reader *r, const io_piece *pieces, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const io_piece *p = &pieces[i];
        if (!p->polygons.count && !p->strips.count)
            continue;
        if ((!r->surface && !io_surface_new(r)) || !add_mesh_piece(r, p))
            return false;
    }
    return true;
}

/* ---- All ------------------------------------------------------------------------------------- */

static size_t count_lines(const io_piece *pieces, size_t count) {
    size_t lines = 0;
    for (size_t i = 0; i < count; i++)
        lines += pieces[i].lines.count;
    return lines;
}

/* A file with neither lines nor polygons is one of no lines. */
bool io_build_pieces(io_reader *r, const io_piece *pieces, size_t count) {
    if ((r->wanted & IO_TREE) && !build_tree(r, pieces, count))
        return false;
    if ((r->wanted & IO_MESH) && !build_mesh(r, pieces, count))
        return false;
    r->found = (r->graph ? IO_TREE : 0u) | (r->surface ? IO_MESH : 0u);
    if ((r->wanted & IO_LINES) && (!r->found || count_lines(pieces, count))) {
        r->found |= IO_LINES;
        return build_lines(r, pieces, count);
    }
    if (r->found)
        return true;
    return io_fail(r, r->wanted & IO_TREE
                          ? "holds no tree: its lines need a radius, an array named "
                            "MaximumInscribedSphereRadius, radius or diameter"
                          : "holds no mesh: it has no polygons and no strips");
}
