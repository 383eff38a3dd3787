/* PLY: ascii, binary_little_endian, binary_big_endian; any elements, properties and lists. */
#include "io_surface.h"

#include <math.h>
#include <string.h>

typedef struct property {
    io_text name;
    io_type type;
    io_type count; /* of a list's length; IO_NONE = no list */
} property;

typedef struct element {
    io_text name;
    size_t count;
    size_t first, last; /* its properties: first .. last - 1 */
} element;

typedef struct ply {
    io_reader *r;
    io_cursor c;
    bool ascii, big;
    element *elements;
    size_t element_count, element_capacity;
    property *properties;
    size_t property_count, property_capacity;
    double **columns; /* one per property: the numbers of its rows; NULL for lists */
    double *list;     /* the list read last */
    size_t list_size, list_capacity;
    uint32_t *corners; /* the face read last */
    size_t corner_capacity;
} ply;

io_match io_sniff_ply(const io_cursor *bytes) {
    io_cursor c = *bytes;
    io_text line;
    return bytes->size > 4 && !memcmp(bytes->bytes, "ply", 3) && io_take_line(&c, &line) &&
                   io_text_is(io_text_trim(line), "ply")
               ? IO_YES
               : IO_NO;
}

/* ---- Head ------------------------------------------------------------------------------------ */

static bool fail_at(ply *p, const char *what) {
    return io_fail(p->r, "is damaged in line %zu: %s", io_line_number(&p->c, p->c.at) - 1, what);
}

/* "uchar" and "ushort" are PLY's own spelling. */
static io_type type_named(io_text word) {
    return io_text_is(word, "uchar")    ? IO_U8
           : io_text_is(word, "ushort") ? IO_U16
           : io_text_is(word, "uint")   ? IO_U32
                                        : io_type_named(word);
}

static bool add_element(ply *p, io_cursor *words) {
    element *elements =
        io_grow(p->r, p->elements, &p->element_capacity, p->element_count + 1, sizeof *elements);
    io_text count;
    if (!elements)
        return false;
    p->elements = elements;
    element *e = &elements[p->element_count];
    memset(e, 0, sizeof *e);
    if (!io_take_word(words, &e->name) || !io_take_word(words, &count) ||
        !io_parse_size(count, &e->count))
        return fail_at(p, "element needs a name and a count");
    e->first = e->last = p->property_count;
    p->element_count++;
    return true;
}

static bool add_property(ply *p, io_cursor *words) {
    property *properties = io_grow(p->r, p->properties, &p->property_capacity,
                                   p->property_count + 1, sizeof *properties);
    io_text word;
    if (!properties)
        return false;
    p->properties = properties;
    property *to = &properties[p->property_count];
    memset(to, 0, sizeof *to);
    if (!p->element_count || !io_take_word(words, &word))
        return fail_at(p, "property needs an element before it, a type and a name");
    if (io_text_is(word, "list")) {
        if (!io_take_word(words, &word) || !(to->count = type_named(word)) ||
            !io_take_word(words, &word))
            return fail_at(p, "a list needs a type of count, a type and a name");
    }
    to->type = type_named(word);
    if (to->type == IO_NONE || !io_take_word(words, &to->name))
        return fail_at(p, "property needs a type of numbers and a name");
    p->elements[p->element_count - 1].last = ++p->property_count;
    return true;
}

static bool take_format(ply *p, io_cursor *words) {
    io_text word;
    if (!io_take_word(words, &word))
        return fail_at(p, "format must be ascii, binary_little_endian or binary_big_endian");
    p->ascii = io_text_is(word, "ascii");
    p->big = io_text_is(word, "binary_big_endian");
    return p->ascii || p->big || io_text_is(word, "binary_little_endian") ||
           fail_at(p, "format must be ascii, binary_little_endian or binary_big_endian");
}

static bool take_head(ply *p) {
    io_text line, word;
    bool format = false;
    while (io_take_line(&p->c, &line)) {
        io_cursor words = {(const uint8_t *)line.at, line.size, 0};
        if (!io_take_word(&words, &word))
            continue;
        if (io_text_is(word, "end_header"))
            return format || io_fail(p->r, "lacks the line format in its head");
        if (io_text_is(word, "format")) {
            format = true;
            if (!take_format(p, &words))
                return false;
        } else if (io_text_is(word, "element")) {
            if (!add_element(p, &words))
                return false;
        } else if (io_text_is(word, "property") && !add_property(p, &words)) {
            return false;
        }
    }
    return io_fail(p->r, "is cut in its head: end_header is missing; copy the file again");
}

/* ---- Numbers --------------------------------------------------------------------------------- */

static bool too_short(ply *p, const element *e, size_t row) {
    return io_fail(p->r,
                   "ends too early: row %zu of the %zu of its element %.*s is missing or broken; "
                   "copy the file again",
                   row + 1, e->count, (int)(e->name.size < 40 ? e->name.size : 40), e->name.at);
}

static bool take_number(ply *p, io_type type, double *value) {
    if (p->ascii) {
        io_text word;
        return io_take_word(&p->c, &word) && io_parse_real(word, value);
    }
    const uint8_t *bytes = io_take(&p->c, io_type_size(type));
    io_view view = {bytes, 1, 0, 1, type, p->big};
    if (bytes)
        *value = io_view_real(&view, 0, 0);
    return bytes != NULL;
}

/* Each number takes a byte at least, in text even two, so that a length cannot lie about memory. */
static bool take_list(ply *p, const property *of, size_t *size) {
    double length;
    if (!take_number(p, of->count, &length) || !(length >= 0) || floor(length) != length ||
        length > (double)(p->c.size - p->c.at))
        return false;
    *size = (size_t)length;
    double *list = io_grow(p->r, p->list, &p->list_capacity, *size, sizeof *list);
    if (!list)
        return false;
    p->list = list;
    for (size_t i = 0; i < *size; i++)
        if (!take_number(p, of->type, &list[i]))
            return false;
    return true;
}

static bool is_corners(const property *of) {
    return of->count != IO_NONE &&
           (io_text_is(of->name, "vertex_indices") || io_text_is(of->name, "vertex_index"));
}

static bool add_face(ply *p, size_t count, size_t row, size_t vertices) {
    uint32_t *corners = io_grow(p->r, p->corners, &p->corner_capacity, count, sizeof *corners);
    if (!corners)
        return false;
    p->corners = corners;
    for (size_t i = 0; i < count; i++) {
        if (!(p->list[i] >= 0 && p->list[i] < (double)vertices))
            return io_fail(p->r, "face %zu uses a vertex that is not one of the %zu in the file",
                           row + 1, vertices);
        corners[i] = (uint32_t)p->list[i];
    }
    return io_surface_add_polygon(p->r, corners, count, row);
}

static const element *find_element(const ply *p, const char *name) {
    for (size_t i = 0; i < p->element_count; i++)
        if (io_text_is(p->elements[i].name, name))
            return &p->elements[i];
    return NULL;
}

static bool take_row(ply *p, const element *e, size_t row, bool faces, size_t vertices) {
    for (size_t k = e->first; k < e->last; k++) {
        const property *of = &p->properties[k];
        size_t size;
        if (of->count == IO_NONE) {
            double value;
            if (!take_number(p, of->type, &value))
                return too_short(p, e, row);
            if (p->columns[k])
                p->columns[k][row] = value;
        } else if (!take_list(p, of, &size)) {
            return too_short(p, e, row);
        } else if (faces && is_corners(of) && !add_face(p, size, row, vertices)) {
            return false;
        }
    }
    return true;
}

/* Rows are read one after the other; of vertices and faces the single numbers are kept. */
static bool take_element(ply *p, const element *e, bool keep, bool faces, size_t vertices) {
    size_t left = p->c.size - p->c.at;
    if (e->last == e->first)
        return true; /* rows of nothing */
    if (e->count > left)
        return too_short(p, e, left);
    for (size_t k = e->first; keep && k < e->last; k++)
        if (p->properties[k].count == IO_NONE &&
            !(p->columns[k] = io_alloc(p->r, e->count, sizeof **p->columns)))
            return false;
    for (size_t row = 0; row < e->count; row++)
        if (!take_row(p, e, row, faces, vertices) ||
            (row % 65536 == 0 && !io_tick(p->r, p->c.at, 2 * p->c.size)))
            return false;
    return true;
}

/* ---- Vertices -------------------------------------------------------------------------------- */

static const double *column_named(const ply *p, const element *e, const char *name) {
    for (size_t k = e->first; k < e->last; k++)
        if (p->columns[k] && io_text_is(p->properties[k].name, name))
            return p->columns[k];
    return NULL;
}

/* Three columns beside each other, as rows; NULL when one is missing, or with *failed. */
static double *triple(ply *p, const element *e, const char *const names[3], bool *failed) {
    const double *columns[3];
    for (int axis = 0; axis < 3; axis++)
        if (!(columns[axis] = column_named(p, e, names[axis])))
            return NULL;
    double *rows = io_alloc(p->r, e->count, 3 * sizeof *rows);
    *failed = !rows;
    for (size_t i = 0; rows && i < 3 * e->count; i++)
        rows[i] = columns[i % 3][i / 3];
    return rows;
}

static bool add_vertices(ply *p, const element *e) {
    static const char *const places[3] = {"x", "y", "z"}, *const normals[3] = {"nx", "ny", "nz"};
    bool failed = false;
    const double *positions = triple(p, e, places, &failed);
    if (!positions)
        return !failed && io_fail(p->r, "holds no mesh: its vertices lack x, y or z");
    for (size_t i = 0; i < e->count; i++)
        if (!io_surface_add_vertex(p->r, positions + 3 * i, i))
            return false;
    const double *told = triple(p, e, normals, &failed);
    io_view view = io_view_doubles(told, e->count, 3);
    return !failed && (!told || io_surface_add_normals(p->r, 0, &view));
}

static bool is_geometry(io_text name) {
    static const char *const names[] = {"x", "y", "z", "nx", "ny", "nz"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (io_text_is(name, names[i]))
            return true;
    return false;
}

static bool add_columns(ply *p, const element *e, bool of_faces) {
    io_surface *s = p->r->surface;
    for (size_t k = e ? e->first : 0; e && k < e->last; k++) {
        io_text name = p->properties[k].name;
        if (!p->columns[k] || (!of_faces && is_geometry(name)))
            continue;
        io_view view = io_view_doubles(p->columns[k], e->count, 1);
        if (!(of_faces ? io_attach_rows(p->r, &s->triangle_columns, name, &view, s->triangle_rows,
                                        0, s->triangle_count, 0, "face")
                       : io_attach_rows(p->r, &s->vertex_columns, name, &view, NULL, 0,
                                        s->vertex_count, 0, "vertex")))
            return false;
    }
    return true;
}

bool io_read_ply(io_reader *r, io_cursor *bytes) {
    ply p;
    memset(&p, 0, sizeof p);
    p.r = r;
    p.c = *bytes;
    if (!io_surface_new(r) || !take_head(&p))
        return false;
    const element *vertices = find_element(&p, "vertex"), *faces = find_element(&p, "face");
    if (!vertices)
        return io_fail(r, "holds no mesh: it has no element vertex");
    p.columns = io_alloc(r, p.property_count, sizeof *p.columns);
    bool placed = false; /* triangles look at positions, so that vertices must come first */
    for (size_t i = 0; p.columns && i < p.element_count; i++) {
        const element *e = &p.elements[i];
        if (e == faces && !placed)
            return io_fail(r, "has its faces before its vertices; write it in the usual order");
        if (!take_element(&p, e, e == vertices || e == faces, e == faces, vertices->count))
            return false;
        if (e == vertices && !add_vertices(&p, e))
            return false;
        placed = placed || e == vertices;
    }
    if (!faces && !io_warn(r, "the file holds %zu points, but no faces", vertices->count))
        return false;
    return p.columns && add_columns(&p, vertices, false) && add_columns(&p, faces, true);
}
