/* TCK (MRtrix): a text header, then triplets in RAS mm; a NaN triplet ends a line, an infinite one
 * the file. */
#include "io_internal.h"

#include <math.h>
#include <string.h>

static const char magic[] = "mrtrix tracks";

io_match io_sniff_tck(const io_cursor *bytes) {
    io_text text = {(const char *)bytes->bytes, bytes->size};
    return io_text_starts(text, magic) ? IO_YES : IO_NO;
}

typedef struct header {
    size_t offset; /* of the data; 0 = not told */
    size_t count;  /* of lines; 0 = not told */
    io_type type;
    bool big, typed, ended;
} header;

static bool parse_type(io_reader *r, io_text value, header *head) {
    io_text name = value;
    bool little = value.size > 2 && io_text_is((io_text){value.at + value.size - 2, 2}, "LE");
    head->big = value.size > 2 && io_text_is((io_text){value.at + value.size - 2, 2}, "BE");
    if (little || head->big)
        name.size -= 2;
    head->type = io_text_starts(name, "float") ? io_type_named(name) : IO_NONE;
    head->typed = true;
    if (head->type != IO_F32 && head->type != IO_F64)
        return io_fail(r,
                       "has the datatype '%.*s'; TCK data is Float32LE, Float32BE, Float64LE or "
                       "Float64BE",
                       (int)(value.size < 40 ? value.size : 40), value.at);
    return true;
}

/* "file: . OFFSET"; the offset rules, wherever the text of the header ends. */
static bool parse_file(io_reader *r, io_text value, header *head) {
    io_cursor words = {(const uint8_t *)value.at, value.size, 0};
    io_text name, offset;
    if (!io_take_word(&words, &name) || !io_text_is(name, "."))
        return io_fail(r,
                       "keeps its points in another file; put them into this one with tckconvert");
    if (!io_take_word(&words, &offset) || !io_parse_size(offset, &head->offset) || !head->offset)
        return io_fail(r, "has a header line 'file: .' without the byte offset of the data");
    return true;
}

/* Of keys that repeat the first counts: some writers append a second count, history comes in many
 * lines. */
static bool parse_line(io_reader *r, io_text line, header *head) {
    const char *colon = memchr(line.at, ':', line.size);
    if (!colon)
        return true;
    io_text key = io_text_trim((io_text){line.at, (size_t)(colon - line.at)});
    io_text value = io_text_trim((io_text){colon + 1, line.size - (size_t)(colon - line.at) - 1});
    if (io_text_is(key, "count") && !head->count)
        return io_parse_size(value, &head->count) || true;
    if (io_text_is(key, "datatype") && !head->typed)
        return parse_type(r, value, head);
    if (io_text_is(key, "file") && !head->offset)
        return parse_file(r, value, head);
    return true;
}

/* Leaves the cursor at the data. The header may lack its END: then the offset ends it. */
static bool read_header(io_reader *r, io_cursor *c, header *head) {
    io_text line;
    size_t end = 0;
    if (!io_sniff_tck(c))
        return io_fail(r, "is not a TCK file: it does not begin with 'mrtrix tracks'");
    while (!head->ended && (!head->offset || c->at < head->offset)) {
        end = c->at;
        if (!io_take_line(c, &line))
            break;
        io_text word = io_text_trim(line);
        head->ended = io_text_is(word, "END");
        /* without a line end behind END its line runs into the data */
        if (io_text_starts(word, "END") && head->offset > end && head->offset <= c->at)
            head->ended = true;
        end += head->ended ? 3 : 0;
        bool told = head->offset != 0;
        if (!head->ended && !parse_line(r, line, head))
            return false;
        if (!told && head->offset < c->at)
            head->offset = 0; /* inside the header: cannot be */
    }
    if (!head->typed)
        return io_fail(r,
                       "has no 'datatype:' in its header; add one, such as 'datatype: Float32LE'");
    if (!head->ended && !head->offset)
        return io_fail(
            r, "has a header without END and without 'file: . OFFSET': its data cannot be found");
    if (!head->ended && !io_warn(r, "the header has no END; its data is taken from the offset"))
        return false;
    if (head->offset > c->size)
        return io_fail(r, "has %zu bytes, but its data should begin at byte %zu; copy it again",
                       c->size, head->offset);
    if (head->offset && (!head->ended || head->offset >= end))
        c->at = head->offset;
    else
        return io_warn(r,
                       "the header tells no usable data offset; the data is taken from behind END");
    return true;
}

/* Reads up to the infinite triplet. */
static bool read_points(io_reader *r, io_cursor *c, const header *head, size_t *count) {
    size_t size = io_type_size(head->type), begin = c->at, row = 0, pending = 0;
    io_view view = {c->bytes + c->at, (c->size - c->at) / (3 * size), 3 * size, 3, head->type,
                    head->big};
    for (; row < view.count; row++) {
        double p[3];
        for (uint32_t i = 0; i < 3; i++)
            p[i] = io_view_real(&view, row, i);
        bool end = isinf(p[0]) && isinf(p[1]) && isinf(p[2]);
        if (end || (isnan(p[0]) && isnan(p[1]) && isnan(p[2]))) {
            if (pending && !io_end_line(r, (*count)++, c->at + row * 3 * size, c->size))
                return false;
            pending = 0;
            if (end)
                return true;
            continue;
        }
        if (!io_add_point(r, p, row))
            return false;
        pending++;
    }
    size_t left = c->size - begin - row * 3 * size;
    if (pending || left)
        return io_fail(
            r,
            "ends inside line %zu, at byte %zu; %zu lines are whole. Copy the file again, or "
            "write it anew",
            *count + 1, c->size, *count);
    return io_warn(r, "the end mark (inf inf inf) is missing behind the last line");
}

bool io_read_tck(io_reader *r, io_cursor *c) {
    header head = {0, 0, IO_NONE, false, false, false};
    size_t count = 0;
    if (!read_header(r, c, &head) || !read_points(r, c, &head, &count))
        return false;
    if (head.count && head.count != count)
        return io_warn(r, "the header says %zu lines, but the file holds %zu", head.count, count);
    return true;
}

/* ---- Writing --------------------------------------------------------------------------------- */

static void put_triplet(FILE *file, double x, double y, double z) {
    io_put_f32(file, x);
    io_put_f32(file, y);
    io_put_f32(file, z);
}

bool io_write_tck(FILE *file, const io_lines *lines, io_error *error) {
    (void)error;
    char head[128];
    int size = 0;
    for (int offset = 0; offset != size || !size;) { /* the offset is part of the text it counts */
        offset = size;
        size =
            snprintf(head, sizeof head, "%s\ndatatype: Float32LE\ncount: %010lu\nfile: . %d\nEND\n",
                     magic, (unsigned long)lines->line_count, offset);
    }
    fwrite(head, 1, (size_t)size, file);
    for (size_t i = 0; i < lines->line_count && !ferror(file); i++) {
        for (size_t k = lines->offsets[i]; k < lines->offsets[i + 1]; k++)
            put_triplet(file, io_position(lines, k, 0), io_position(lines, k, 1),
                        io_position(lines, k, 2));
        put_triplet(file, NAN, NAN, NAN);
    }
    put_triplet(file, INFINITY, INFINITY, INFINITY);
    return true;
}
