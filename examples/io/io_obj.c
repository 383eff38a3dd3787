/* Wavefront OBJ: v, vn, vt, f and l; a backslash at the end of a line continues it. Faces make a
 * mesh, polylines (l) make lines. */
#include "io_surface.h"

#include <math.h>
#include <string.h>

typedef struct reals { /* rows of numbers that grow */
    double *values;
    size_t count, capacity;
} reals;

typedef struct corner { /* of a face or a line: 0-based, SIZE_MAX = not told */
    size_t vertex, texture, normal;
} corner;

typedef struct obj {
    io_reader *r;
    size_t line;
    reals positions, colours, normals, textures; /* 3, 3, 3 and 1 a row */
    corner *corners;
    size_t corner_count, corner_capacity;
    size_t *ends; /* of faces, then their corners end here */
    size_t face_count, face_capacity;
    corner *joints; /* of lines */
    size_t joint_count, joint_capacity;
    size_t *tails;
    size_t line_count, line_capacity;
    char *joined; /* a continued line */
    size_t joined_capacity;
} obj;

/* ---- Lines of text --------------------------------------------------------------------------- */

static bool is_continued(io_text *line) {
    if (!line->size || line->at[line->size - 1] != '\\')
        return false;
    line->size--;
    return true;
}

/* Appends to the line that is put together from continued ones. */
static bool append(obj *o, io_text part, size_t *size) {
    char *joined =
        io_grow(o->r, o->joined, &o->joined_capacity, *size + part.size + 1, sizeof *joined);
    if (!joined)
        return false;
    o->joined = joined;
    memcpy(joined + *size, part.at, part.size);
    *size += part.size;
    joined[(*size)++] = ' ';
    return true;
}

/* The next line without its comment, continued ones in one; *failed when memory is short. */
static bool next_line(obj *o, io_cursor *c, io_text *line, bool *failed) {
    size_t size = 0;
    *failed = false;
    if (!io_take_line(c, line))
        return false;
    o->line++;
    for (bool more = is_continued(line); more || size;) {
        *failed = !append(o, *line, &size);
        if (*failed)
            return false;
        if (!more || !io_take_line(c, line))
            break;
        o->line++;
        more = is_continued(line);
    }
    if (size) {
        line->at = o->joined;
        line->size = size;
    }
    const char *comment = memchr(line->at, '#', line->size);
    if (comment)
        line->size = (size_t)(comment - line->at);
    return true;
}

/* Enough lines that begin as an OBJ's do, among them a vertex. */
io_match io_sniff_obj(const io_cursor *bytes) {
    static const char *const known[] = {"v", "vn", "vt",     "vp", "f",      "l",  "o",
                                        "g", "s",  "mtllib", "p",  "usemtl", "vx", "cstype"};
    io_cursor c = {bytes->bytes, bytes->size < 65536 ? bytes->size : 65536, 0};
    io_text line, word;
    while (io_take_line(&c, &line)) {
        io_cursor words = {(const uint8_t *)line.at, line.size, 0};
        double value;
        bool found = false;
        if (!io_take_word(&words, &word) || word.at[0] == '#')
            continue;
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
            found = found || io_text_is(word, known[i]);
        if (!found)
            return IO_NO;
        if (io_text_is(word, "v"))
            return io_take_word(&words, &word) && io_parse_real(word, &value) ? IO_YES : IO_NO;
    }
    return IO_NO;
}

/* ---- Numbers --------------------------------------------------------------------------------- */

static bool fail_at(obj *o, const char *what) {
    return io_fail(o->r, "is damaged in line %zu: %s", o->line, what);
}

static bool push(obj *o, reals *to, const double *values, size_t width) {
    double *grown = io_grow(o->r, to->values, &to->capacity, to->count + 1, width * sizeof *grown);
    if (!grown)
        return false;
    to->values = grown;
    memcpy(grown + width * to->count++, values, width * sizeof *grown);
    return true;
}

/* Up to most numbers of a line; SIZE_MAX: a word is none. */
static size_t take_numbers(io_cursor *words, double *values, size_t most) {
    io_text word;
    size_t count = 0;
    while (count < most && io_take_word(words, &word))
        if (!io_parse_real(word, &values[count++]))
            return SIZE_MAX;
    return count;
}

/* x y z, perhaps w, or a colour behind them. */
static bool take_vertex(obj *o, io_cursor *words) {
    double v[7] = {0};
    size_t count = take_numbers(words, v, 7);
    if (count < 3 || count == SIZE_MAX)
        return fail_at(o, "v needs three numbers");
    const double none[3] = {(double)NAN, (double)NAN, (double)NAN};
    const double *colour = count == 6 ? v + 3 : count == 7 ? v + 4 : NULL;
    if (colour && !o->colours.count) /* the vertices before have none */
        for (size_t i = 0; i < o->positions.count; i++)
            if (!push(o, &o->colours, none, 3))
                return false;
    return push(o, &o->positions, v, 3) &&
           (!(colour || o->colours.count) || push(o, &o->colours, colour ? colour : none, 3));
}

static bool take_normal(obj *o, io_cursor *words) {
    double v[3];
    return take_numbers(words, v, 3) == 3 ? push(o, &o->normals, v, 3)
                                          : fail_at(o, "vn needs three numbers");
}

static bool take_texture(obj *o, io_cursor *words) {
    double v[1];
    return take_numbers(words, v, 1) == 1 ? push(o, &o->textures, v, 1)
                                          : fail_at(o, "vt needs a number");
}

/* One of v, v/vt, v//vn, v/vt/vn: the part up to the next slash, 1-based, or negative from the end.
 */
static bool take_index(io_text *word, size_t count, size_t *index) {
    io_text part = *word;
    const char *slash = memchr(word->at, '/', word->size);
    size_t value;
    if (slash)
        part.size = (size_t)(slash - word->at);
    word->at += part.size + (slash ? 1 : 0);
    word->size -= part.size + (slash ? 1 : 0);
    *index = SIZE_MAX;
    if (!part.size)
        return true;
    bool back = part.at[0] == '-';
    part.at += back;
    part.size -= back;
    if (!io_parse_size(part, &value) || !value || value > count)
        return false;
    *index = back ? count - value : value - 1;
    return true;
}

static bool take_corner(obj *o, io_text word, corner *to) {
    return take_index(&word, o->positions.count, &to->vertex) && to->vertex != SIZE_MAX &&
           take_index(&word, o->textures.count, &to->texture) &&
           take_index(&word, o->normals.count, &to->normal) && !word.size;
}

static bool take_corners(obj *o, io_cursor *words, corner **corners, size_t *count,
                         size_t *capacity) {
    io_text word;
    while (io_take_word(words, &word)) {
        corner *grown = io_grow(o->r, *corners, capacity, *count + 1, sizeof *grown);
        if (!grown)
            return false;
        *corners = grown;
        if (!take_corner(o, word, &grown[(*count)++]))
            return fail_at(o, "an index is broken, or names what does not stand before it");
    }
    return true;
}

static bool end_at(obj *o, size_t **ends, size_t *count, size_t *capacity, size_t end) {
    size_t *grown = io_grow(o->r, *ends, capacity, *count + 1, sizeof *grown);
    if (!grown)
        return false;
    *ends = grown;
    grown[(*count)++] = end;
    return true;
}

static bool take_line(obj *o, io_text line) {
    io_cursor words = {(const uint8_t *)line.at, line.size, 0};
    io_text word;
    if (!io_take_word(&words, &word))
        return true;
    if (io_text_is(word, "v"))
        return take_vertex(o, &words);
    if (io_text_is(word, "vn"))
        return take_normal(o, &words);
    if (io_text_is(word, "vt"))
        return take_texture(o, &words);
    if (io_text_is(word, "f"))
        return take_corners(o, &words, &o->corners, &o->corner_count, &o->corner_capacity) &&
               end_at(o, &o->ends, &o->face_count, &o->face_capacity, o->corner_count);
    if (io_text_is(word, "l"))
        return take_corners(o, &words, &o->joints, &o->joint_count, &o->joint_capacity) &&
               end_at(o, &o->tails, &o->line_count, &o->line_capacity, o->joint_count);
    return true;
}

static bool parse(obj *o, io_cursor *c) {
    io_text line;
    bool failed;
    while (next_line(o, c, &line, &failed))
        if (!take_line(o, line) || (o->line % 65536 == 0 && !io_tick(o->r, c->at, 2 * c->size)))
            return false;
    return !failed;
}

/* ---- Building -------------------------------------------------------------------------------- */

/* A vertex takes the normal of its first corner; only meshes whose corners all have one do. */
static bool add_normals(obj *o) {
    size_t count = o->positions.count;
    double *normals = io_alloc(o->r, count, 3 * sizeof *normals);
    bool *told = io_alloc(o->r, count, sizeof *told);
    if (!normals || !told)
        return false;
    for (size_t i = 0; i < o->corner_count; i++) {
        const corner *k = &o->corners[i];
        if (k->normal == SIZE_MAX)
            return true;
        if (!told[k->vertex])
            memcpy(normals + 3 * k->vertex, o->normals.values + 3 * k->normal, 3 * sizeof *normals);
        told[k->vertex] = true;
    }
    io_view view = io_view_doubles(normals, count, 3);
    return io_surface_add_normals(o->r, 0, &view);
}

static bool build_mesh(obj *o) {
    uint32_t *face = NULL;
    size_t capacity = 0;
    if (!io_surface_new(o->r))
        return false;
    for (size_t i = 0; i < o->positions.count; i++)
        if (!io_surface_add_vertex(o->r, o->positions.values + 3 * i, i))
            return false;
    for (size_t i = 0, at = 0; i < o->face_count; i++) {
        size_t count = o->ends[i] - at;
        if (!(face = io_grow(o->r, face, &capacity, count, sizeof *face)))
            return false;
        for (size_t k = 0; k < count; k++)
            face[k] = (uint32_t)o->corners[at + k].vertex;
        if (!io_surface_add_polygon(o->r, face, count, i))
            return false;
        at = o->ends[i];
    }
    io_view colours = io_view_doubles(o->colours.values, o->colours.count, 3);
    if (o->colours.count &&
        !io_attach_rows(o->r, &o->r->surface->vertex_columns, io_text_of("color"), &colours, NULL,
                        0, o->positions.count, 0, "vertex"))
        return false;
    return !o->normals.count || add_normals(o);
}

/* The first texture coordinate of a point is its value (the habit of LineVis): that of its index,
 * or without one that of the same number when there are as many as vertices. */
static bool add_values(obj *o) {
    double *values = io_alloc(o->r, o->joint_count, sizeof *values);
    bool parallel = o->textures.count == o->positions.count;
    if (!values)
        return false;
    for (size_t i = 0; i < o->joint_count; i++) {
        const corner *k = &o->joints[i];
        size_t texture = k->texture != SIZE_MAX ? k->texture : parallel ? k->vertex : SIZE_MAX;
        values[i] = texture == SIZE_MAX ? (double)NAN : o->textures.values[texture];
    }
    io_view view = io_view_doubles(values, o->joint_count, 1);
    return io_attach_points(o->r, io_text_of("value"), &view);
}

static bool build_lines(obj *o) {
    for (size_t i = 0, at = 0; i < o->line_count; i++) {
        for (; at < o->tails[i]; at++)
            if (!io_add_point(o->r, o->positions.values + 3 * o->joints[at].vertex, at))
                return false;
        if (!io_end_line(o->r, i, i, o->line_count))
            return false;
    }
    return !o->textures.count || add_values(o);
}

bool io_read_obj(io_reader *r, io_cursor *bytes) {
    obj o;
    memset(&o, 0, sizeof o);
    o.r = r;
    if (!parse(&o, bytes))
        return false;
    r->found = 0;
    if ((r->wanted & IO_MESH) && (o.face_count || !o.line_count)) {
        r->found |= IO_MESH;
        if (!build_mesh(&o))
            return false;
    }
    if ((r->wanted & IO_LINES) && o.line_count) {
        r->found |= IO_LINES;
        if (!build_lines(&o))
            return false;
    }
    return r->found || io_fail(r, r->wanted & IO_LINES ? "holds no lines (l), only faces"
                                                       : "holds no faces (f), only lines");
}
