/* STL: binary when its size is that of its count of triangles, whatever its first bytes say. */
#include "io_surface.h"

#include <string.h>

enum { HEAD = 84, RECORD = 50 };

static bool has_binary_size(const io_cursor *bytes) {
    if (bytes->size < HEAD)
        return false;
    uint64_t count = io_u32(bytes->bytes + 80, false);
    return bytes->size == HEAD + RECORD * count;
}

static bool is_text(const io_cursor *bytes) {
    io_cursor c = {bytes->bytes, bytes->size < 4096 ? bytes->size : 4096, 0};
    io_text word;
    if (memchr(c.bytes, 0, c.size)) /* no text has a zero; heads of 80 bytes are filled with them */
        return false;
    if (!io_take_word(&c, &word) || !io_text_is(word, "solid"))
        return false;
    while (io_take_word(&c, &word))
        if (io_text_is(word, "facet") || io_text_is(word, "endsolid"))
            return true;
    return false;
}

io_match io_sniff_stl(const io_cursor *bytes) {
    return has_binary_size(bytes) || is_text(bytes) ? IO_YES : IO_NO;
}

static bool add_triangle(io_reader *r, const double corners[9], size_t row) {
    io_surface *s = r->surface;
    size_t first = s->vertex_count;
    for (size_t i = 0; i < 3; i++)
        if (!io_surface_add_vertex(r, corners + 3 * i, first + i))
            return false;
    const uint32_t vertices[3] = {(uint32_t)first, (uint32_t)first + 1, (uint32_t)first + 2};
    return io_surface_add_polygon(r, vertices, 3, row);
}

/* Writers get the count wrong; the size of the file does not lie. */
static bool count_records(io_reader *r, const io_cursor *bytes, size_t *count) {
    size_t told = io_u32(bytes->bytes + 80, false), left = bytes->size - HEAD;
    *count = told;
    if (left == told * (uint64_t)RECORD)
        return true;
    if (left % RECORD == 0 && (told == 0 || told > left / RECORD)) {
        *count = left / RECORD;
        return io_warn(r, "the head tells %zu triangles, and the file has %zu", told, *count);
    }
    if (told > left / RECORD)
        return io_fail(r,
                       "ends too early: %zu triangles are announced, and %zu are whole; copy the "
                       "file again",
                       told, left / RECORD);
    return io_warn(r, "%zu bytes behind the last triangle are left out", left - told * RECORD);
}

static bool read_binary(io_reader *r, const io_cursor *bytes) {
    size_t count;
    if (bytes->size < HEAD)
        return io_fail(r, "is cut in its head of %d bytes; copy the file again", HEAD);
    if (!count_records(r, bytes, &count))
        return false;
    for (size_t i = 0; i < count; i++) {
        const uint8_t *at = bytes->bytes + HEAD + RECORD * i + 12; /* behind the normal */
        double corners[9];
        for (size_t k = 0; k < 9; k++)
            corners[k] = (double)io_f32(at + 4 * k, false);
        if (!add_triangle(r, corners, i) || (i % 65536 == 0 && !io_tick(r, i, count)))
            return false;
    }
    return true;
}

/* Takes the three numbers of a vertex. */
static bool take_vertex(io_reader *r, io_cursor *c, double *to) {
    io_text word;
    for (int axis = 0; axis < 3; axis++)
        if (!io_take_word(c, &word) || !io_parse_real(word, &to[axis]))
            return io_fail(r, "has a vertex without three numbers in line %zu",
                           io_line_number(c, c->at));
    return true;
}

/* Words that matter are "solid" (the rest of its line is a name), "vertex" and "endloop"; several
 * solids follow each other. */
static bool read_text(io_reader *r, io_cursor *c) {
    double corners[9];
    size_t count = 0, rows = 0;
    io_text word, name;
    bool ended = false;
    while (io_take_word(c, &word)) {
        if (io_text_is(word, "solid") || io_text_is(word, "endsolid")) {
            (void)io_take_line(c, &name);
            ended = io_text_is(word, "endsolid");
        } else if (io_text_is(word, "vertex")) {
            if (count == 3)
                return io_fail(r, "has a facet with more than three corners in line %zu",
                               io_line_number(c, c->at));
            if (!take_vertex(r, c, corners + 3 * count++))
                return false;
        } else if (io_text_is(word, "endloop")) {
            if (count != 3)
                return io_fail(r, "has a facet with fewer than three corners in line %zu",
                               io_line_number(c, c->at));
            count = 0;
            if (!add_triangle(r, corners, rows++) ||
                (rows % 65536 == 0 && !io_tick(r, c->at, c->size)))
                return false;
        }
    }
    if (count)
        return io_fail(r, "ends too early, within a facet; copy the file again");
    return ended || io_warn(r, "the word endsolid is missing; the file may be cut");
}

bool io_read_stl(io_reader *r, io_cursor *bytes) {
    if (!io_surface_new(r))
        return false;
    return !has_binary_size(bytes) && is_text(bytes) ? read_text(r, bytes) : read_binary(r, bytes);
}
