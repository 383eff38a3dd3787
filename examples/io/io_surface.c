/* Meshes: the builder, handing over, welding, and what the edges tell. */
#include "io_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io_graph.h"

/* ---- Building -------------------------------------------------------------------------------- */

io_surface *io_surface_new(io_reader *r) {
    r->surface = io_alloc(r, 1, sizeof *r->surface);
    return r->surface;
}

bool io_surface_add_vertex(io_reader *r, const double p[3], size_t row) {
    io_surface *s = r->surface;
    if (s->vertex_count == UINT32_MAX)
        return io_fail(r, "has more than 4294967295 vertices, which is the most supported");
    if (s->vertex_count == s->vertex_capacity) {
        size_t capacity = s->vertex_capacity;
        double *positions =
            io_grow(r, s->positions, &capacity, s->vertex_count + 1, 3 * sizeof *positions);
        if (!positions)
            return false;
        s->positions = positions;
        capacity = s->vertex_capacity;
        uint32_t *rows = io_grow(r, s->vertex_rows, &capacity, s->vertex_count + 1, sizeof *rows);
        if (!rows)
            return false;
        s->vertex_rows = rows;
        s->vertex_capacity = capacity;
    }
    memcpy(s->positions + 3 * s->vertex_count, p, 3 * sizeof *p);
    s->vertex_rows[s->vertex_count++] = (uint32_t)row;
    return true;
}

static bool add_triangle(io_reader *r, uint32_t a, uint32_t b, uint32_t c, size_t row) {
    io_surface *s = r->surface;
    const double *p = s->positions;
    if (!io_is_position(p + 3 * (size_t)a) || !io_is_position(p + 3 * (size_t)b) ||
        !io_is_position(p + 3 * (size_t)c)) {
        s->broken++;
        return true;
    }
    if (s->triangle_count == UINT32_MAX || row > UINT32_MAX)
        return io_fail(r, "has more than 4294967295 triangles, which is the most supported");
    if (s->triangle_count == s->triangle_capacity) {
        size_t capacity = s->triangle_capacity;
        uint32_t *triangles =
            io_grow(r, s->triangles, &capacity, s->triangle_count + 1, 3 * sizeof *triangles);
        if (!triangles)
            return false;
        s->triangles = triangles;
        capacity = s->triangle_capacity;
        uint32_t *rows =
            io_grow(r, s->triangle_rows, &capacity, s->triangle_count + 1, sizeof *rows);
        if (!rows)
            return false;
        s->triangle_rows = rows;
        s->triangle_capacity = capacity;
    }
    uint32_t *to = s->triangles + 3 * s->triangle_count;
    to[0] = a;
    to[1] = b;
    to[2] = c;
    s->triangle_rows[s->triangle_count++] = (uint32_t)row;
    return true;
}

bool io_surface_add_polygon(io_reader *r, const uint32_t *v, size_t count, size_t row) {
    r->surface->not_faces += count < 3;
    for (size_t i = 2; i < count; i++)
        if (!add_triangle(r, v[0], v[i - 1], v[i], row))
            return false;
    return true;
}

bool io_surface_add_strip(io_reader *r, const uint32_t *v, size_t count, size_t row) {
    r->surface->not_faces += count < 3;
    for (size_t i = 2; i < count; i++)
        if (!add_triangle(r, v[i - 2 + i % 2], v[i - 1 - i % 2], v[i], row))
            return false;
    return true;
}

bool io_surface_add_normals(io_reader *r, size_t first, const io_view *view) {
    io_surface *s = r->surface;
    float *normals =
        io_grow(r, s->normals, &s->normal_capacity, first + view->count, 3 * sizeof *normals);
    if (!normals)
        return false;
    s->normals = normals;
    if (first > s->normal_count)
        memset(normals + 3 * s->normal_count, 0, (first - s->normal_count) * 3 * sizeof *normals);
    for (size_t i = 0; i < view->count; i++)
        for (uint32_t axis = 0; axis < 3; axis++)
            normals[3 * (first + i) + axis] = (float)io_view_real(view, i, axis);
    s->normal_count = first + view->count;
    return true;
}

/* ---- Handing over ---------------------------------------------------------------------------- */

static void find_bounds(const io_surface *s, io_mesh *mesh) {
    for (size_t axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < s->vertex_count; i++) {
            const double *p = s->positions + 3 * i;
            if (!io_is_position(p))
                continue;
            low = fmin(low, p[axis]);
            high = fmax(high, p[axis]);
        }
        mesh->bounds[0][axis] = low <= high ? low : 0;
        mesh->bounds[1][axis] = low <= high ? high : 0;
    }
}

/* Vertices that are not finite stay, at the origin: numbers do not move, and nothing uses them. */
static bool copy_geometry(io_reader *r, const io_surface *s, io_mesh *mesh) {
    mesh->positions = io_take_memory(r, s->vertex_count, 3 * sizeof *mesh->positions);
    mesh->triangles = io_take_memory(r, s->triangle_count, 3 * sizeof *mesh->triangles);
    if (s->normals)
        mesh->normals = io_take_memory(r, s->vertex_count, 3 * sizeof *mesh->normals);
    if (!mesh->positions || !mesh->triangles || (s->normals && !mesh->normals))
        return false;
    mesh->vertex_count = (uint32_t)s->vertex_count;
    mesh->triangle_count = (uint32_t)s->triangle_count;
    for (size_t i = 0; i < s->vertex_count; i++)
        for (size_t axis = 0; axis < 3 && io_is_position(s->positions + 3 * i); axis++)
            mesh->positions[3 * i + axis] =
                (float)(s->positions[3 * i + axis] - mesh->origin[axis]);
    if (s->triangle_count)
        memcpy(mesh->triangles, s->triangles, s->triangle_count * 3 * sizeof *mesh->triangles);
    if (s->normals)
        memcpy(mesh->normals, s->normals, s->normal_count * 3 * sizeof *mesh->normals);
    return true;
}

static bool warn_of_content(io_reader *r, const io_surface *s) {
    return (!s->broken ||
            io_warn(r, "%zu triangles were left out: a corner of them is not finite", s->broken)) &&
           (!s->not_faces ||
            io_warn(r, "%zu polygons were left out: they have fewer than three corners",
                    s->not_faces));
}

bool io_finish_mesh(io_reader *r, const char *format, io_mesh *out) {
    io_surface *s = r->surface;
    io_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.format = format;
    mesh.unit = "mm";
    if (r->options->unit && *r->options->unit)
        mesh.unit = io_unit_named(io_text_of(r->options->unit));
    if (!mesh.unit)
        return io_fail(r, "cannot be read in the unit '%.32s'; units are mm, cm, um, nm, m",
                       r->options->unit);
    mesh.millimetres = io_unit_millimetres(mesh.unit);
    find_bounds(s, &mesh);
    io_find_origin((const double(*)[3])mesh.bounds, mesh.origin);
    if (copy_geometry(r, s, &mesh) &&
        io_take_columns(r, &s->vertex_columns, s->vertex_count, &mesh.vertex_attribute_count,
                        &mesh.vertex_attributes) &&
        io_take_columns(r, &s->triangle_columns, s->triangle_count, &mesh.triangle_attribute_count,
                        &mesh.triangle_attributes) &&
        warn_of_content(r, s) && io_take_warnings(r, &mesh.warnings, &mesh.warning_count) &&
        io_tick(r, 1, 1)) {
        *out = mesh;
        return true;
    }
    io_mesh_free(&mesh);
    return false;
}

void io_mesh_free(io_mesh *mesh) {
    if (!mesh)
        return;
    free(mesh->positions);
    free(mesh->triangles);
    free(mesh->normals);
    io_free_attributes(mesh->vertex_attributes, mesh->vertex_attribute_count);
    io_free_attributes(mesh->triangle_attributes, mesh->triangle_attribute_count);
    io_free_warnings(mesh->warnings, mesh->warning_count);
    memset(mesh, 0, sizeof *mesh);
}

/* ---- Welding --------------------------------------------------------------------------------- */

static bool no_memory(io_error *error) {
    return io_error_set(error, "needs memory, which the system does not give");
}

typedef struct place { /* the bits of a position, and where it was */
    uint32_t bits[3], vertex;
} place;

static int by_bits(const void *a, const void *b) {
    const place *x = a, *y = b;
    for (int i = 0; i < 3; i++)
        if (x->bits[i] != y->bits[i])
            return x->bits[i] < y->bits[i] ? -1 : 1;
    return x->vertex < y->vertex ? -1 : x->vertex > y->vertex;
}

/* first[v] = the lowest vertex at the position of v. */
static bool find_first(const io_mesh *mesh, uint32_t *first) {
    size_t count = mesh->vertex_count;
    place *places = malloc((count ? count : 1) * sizeof *places);
    if (!places)
        return false;
    for (size_t i = 0; i < count; i++) {
        for (size_t axis = 0; axis < 3; axis++) {
            float value = mesh->positions[3 * i + axis] + 0.0f; /* -0 becomes 0 */
            memcpy(&places[i].bits[axis], &value, sizeof value);
        }
        places[i].vertex = (uint32_t)i;
    }
    qsort(places, count, sizeof *places, by_bits);
    for (size_t i = 0; i < count; i++) {
        bool same = i && !memcmp(places[i].bits, places[i - 1].bits, sizeof places[i].bits);
        first[places[i].vertex] = same ? first[places[i - 1].vertex] : places[i].vertex;
    }
    free(places);
    return true;
}

static void keep_rows(io_attribute *attributes, uint32_t count, const uint32_t *target,
                      size_t rows) {
    for (uint32_t a = 0; a < count; a++) {
        size_t width = attributes[a].components;
        for (size_t i = 0; i < rows; i++)
            if (target[i] != UINT32_MAX)
                memmove(attributes[a].data + target[i] * width, attributes[a].data + i * width,
                        width * sizeof(float));
    }
}

/* Marks what stays: its new number, else UINT32_MAX. */
static void choose(const io_mesh *mesh, const uint32_t *first, uint32_t *vertices,
                   uint32_t *triangles, uint32_t counts[2]) {
    counts[0] = counts[1] = 0;
    for (size_t i = 0; i < mesh->vertex_count; i++)
        vertices[i] = first[i] == i ? counts[0]++ : UINT32_MAX;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *t = mesh->triangles + 3 * i;
        uint32_t a = first[t[0]], b = first[t[1]], c = first[t[2]];
        triangles[i] = a == b || b == c || c == a ? UINT32_MAX : counts[1]++;
    }
}

static void apply(io_mesh *mesh, const uint32_t *first, const uint32_t *vertices,
                  const uint32_t *triangles) {
    for (size_t i = 0; i < mesh->triangle_count; i++)
        for (size_t k = 0; k < 3 && triangles[i] != UINT32_MAX; k++)
            mesh->triangles[3 * (size_t)triangles[i] + k] =
                vertices[first[mesh->triangles[3 * i + k]]];
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        if (vertices[i] == UINT32_MAX)
            continue;
        size_t to = 3 * (size_t)vertices[i];
        memmove(mesh->positions + to, mesh->positions + 3 * i, 3 * sizeof *mesh->positions);
        if (mesh->normals)
            memmove(mesh->normals + to, mesh->normals + 3 * i, 3 * sizeof *mesh->normals);
    }
    keep_rows(mesh->vertex_attributes, mesh->vertex_attribute_count, vertices, mesh->vertex_count);
    keep_rows(mesh->triangle_attributes, mesh->triangle_attribute_count, triangles,
              mesh->triangle_count);
}

bool io_mesh_weld(io_mesh *mesh, io_error *error) {
    size_t count = mesh->vertex_count ? mesh->vertex_count : 1;
    uint32_t *first = malloc(count * sizeof *first), *vertices = malloc(count * sizeof *vertices);
    uint32_t *triangles = malloc(((size_t)mesh->triangle_count + 1) * sizeof *triangles);
    uint32_t counts[2];
    bool done = first && vertices && triangles && find_first(mesh, first);
    if (done) {
        choose(mesh, first, vertices, triangles, counts);
        apply(mesh, first, vertices, triangles);
        mesh->vertex_count = counts[0];
        mesh->triangle_count = counts[1];
    }
    free(first);
    free(vertices);
    free(triangles);
    return done || no_memory(error);
}

/* ---- Edges ----------------------------------------------------------------------------------- */

static int by_edge(const void *a, const void *b) {
    const uint64_t *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

static uint32_t root_of(uint32_t *parents, uint32_t vertex) {
    while (parents[vertex] != vertex) {
        parents[vertex] = parents[parents[vertex]];
        vertex = parents[vertex];
    }
    return vertex;
}

/* Every used vertex begins as a part of its own; each edge between two parts makes one of them. */
static uint32_t count_components(const io_mesh *mesh, uint32_t *parents) {
    uint32_t components = 0;
    memset(parents, 0xFF, mesh->vertex_count * sizeof *parents);
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        components += parents[mesh->triangles[i]] == UINT32_MAX;
        parents[mesh->triangles[i]] = mesh->triangles[i];
    }
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        uint32_t a = root_of(parents, mesh->triangles[i]);
        uint32_t b = root_of(parents, mesh->triangles[i - i % 3]);
        components -= a != b;
        parents[a > b ? a : b] = a > b ? b : a;
    }
    return components;
}

bool io_mesh_count_edges(const io_mesh *mesh, io_mesh_edges *out, io_error *error) {
    size_t count = 3 * (size_t)mesh->triangle_count;
    uint64_t *edges = malloc((count + 1) * sizeof *edges);
    uint32_t *parents = malloc(((size_t)mesh->vertex_count + 1) * sizeof *parents);
    if (!edges || !parents) {
        free(edges);
        free(parents);
        return no_memory(error);
    }
    for (size_t i = 0; i < count; i++) {
        uint64_t a = mesh->triangles[i], b = mesh->triangles[i % 3 == 2 ? i - 2 : i + 1];
        edges[i] = a < b ? a << 32 | b : b << 32 | a;
    }
    qsort(edges, count, sizeof *edges, by_edge);
    memset(out, 0, sizeof *out);
    for (size_t i = 0, same; i < count; i += same) {
        for (same = 1; i + same < count && edges[i + same] == edges[i];)
            same++;
        out->edges++;
        out->boundary += same == 1;
        out->non_manifold += same > 2;
    }
    out->components = count_components(mesh, parents);
    free(edges);
    free(parents);
    return true;
}
