/* VTK legacy files, DATASET POLYDATA: keywords and numbers as text, or numbers big-endian in
 * between. Both layouts of cells (counts before indices; since 5.1 OFFSETS and CONNECTIVITY) are
 * read. */
#include "io_internal.h"

#include <string.h>

typedef struct array {
    io_text name;
    io_view values;
    bool of_points;
} array;

typedef enum scope { OF_NOTHING, OF_POINTS, OF_CELLS } scope;

typedef struct vtk {
    io_reader *r;
    io_cursor c;
    bool binary;
    io_view points;
    io_cells lines;
    size_t vertex_cells, other_cells;
    scope scope; /* of the arrays that follow */
    size_t scope_rows;
    array *arrays;
    size_t array_count, array_capacity;
} vtk;

io_match io_sniff_vtk(const io_cursor *bytes) {
    io_text text = {(const char *)bytes->bytes, bytes->size};
    return io_text_starts(text, "# vtk DataFile") ? IO_YES : IO_NO;
}

static bool fail_at(vtk *v, const char *what) {
    return io_fail(v->r, "is damaged in line %zu (byte %zu): %s", io_line_number(&v->c, v->c.at),
                   v->c.at, what);
}

/* ---- Numbers --------------------------------------------------------------------------------- */

static bool take_size(vtk *v, size_t *value) {
    io_text word;
    return (io_take_word(&v->c, &word) && io_parse_size(word, value)) ||
           fail_at(v, "a count is missing here");
}

/* Binary numbers begin right behind the line that announces them. */
static bool end_announcement(vtk *v) {
    io_text rest;
    if (v->binary && !io_take_line(&v->c, &rest) && v->c.at < v->c.size)
        return fail_at(v, "the line does not end");
    return true;
}

static bool too_short(vtk *v, size_t count, uint32_t components) {
    return io_fail(
        v->r,
        "ends too early: %zu x %lu numbers are announced before byte %zu, and %zu bytes follow; "
        "copy the file again",
        count, (unsigned long)components, v->c.at, v->c.size - v->c.at);
}

static bool take_binary(vtk *v, io_type type, size_t count, uint32_t components, io_view *out) {
    size_t stride = components * io_type_size(type);
    if (!end_announcement(v))
        return false;
    const uint8_t *bytes =
        count <= (v->c.size - v->c.at) / stride ? io_take(&v->c, count * stride) : NULL;
    io_view view = {bytes, count, stride, components, type, true};
    *out = view;
    return bytes || too_short(v, count, components);
}

static bool take_ascii(vtk *v, size_t count, uint32_t components, io_view *out) {
    if (count > (v->c.size - v->c.at) / components) /* each number takes a digit at least */
        return too_short(v, count, components);
    double *values = io_alloc(v->r, count, components * sizeof *values);
    for (size_t i = 0; values && i < count * components; i++) {
        io_text word;
        if (!io_take_word(&v->c, &word))
            return too_short(v, count, components);
        if (!io_parse_real(word, &values[i]))
            return fail_at(v, "the word before this place is not a number");
        if (i % 65536 == 0 && !io_tick(v->r, v->c.at, 2 * v->c.size))
            return false;
    }
    if (values)
        *out = io_view_doubles(values, count, components);
    return values != NULL;
}

static bool take_values(vtk *v, io_type type, size_t count, size_t components, io_view *out) {
    if (!components || components > UINT16_MAX)
        return fail_at(v, "an array has 0 or more than 65535 values per row");
    return v->binary ? take_binary(v, type, count, (uint32_t)components, out)
                     : take_ascii(v, count, (uint32_t)components, out);
}

static bool take_type(vtk *v, io_type *type) {
    io_text word;
    if (!io_take_word(&v->c, &word))
        return fail_at(v, "a type is missing here");
    *type = io_type_named(word);
    return *type != IO_NONE || fail_at(v, "the word before this place is not a type of numbers");
}

/* ---- Cells ----------------------------------------------------------------------------------- */

static bool peek_word(const vtk *v, const char *expected) {
    io_cursor ahead = v->c;
    io_text word;
    return io_take_word(&ahead, &word) && io_text_is(word, expected);
}

static bool expect_typed(vtk *v, const char *keyword, size_t count, io_view *out) {
    io_text word;
    io_type type = IO_NONE;
    if (!peek_word(v, keyword) || !io_take_word(&v->c, &word))
        return fail_at(v, "OFFSETS or CONNECTIVITY is missing here");
    return take_type(v, &type) && take_values(v, type, count, 1, out);
}

/* After the keyword: n and size; in the new layout n counts the offsets, one more than there are
 * cells. */
static bool take_cells(vtk *v, io_cells *cells) {
    size_t count = 0, size = 0;
    memset(cells, 0, sizeof *cells);
    if (!take_size(v, &count) || !take_size(v, &size))
        return false;
    if (!peek_word(v, "OFFSETS")) {
        cells->counted = true;
        cells->count = count;
        return take_values(v, IO_I32, size, 1, &cells->index);
    }
    if (!expect_typed(v, "OFFSETS", count, &cells->ends) ||
        !expect_typed(v, "CONNECTIVITY", size, &cells->index))
        return false;
    if (count) {
        cells->ends.bytes += cells->ends.stride; /* the first offset is 0 */
        cells->ends.count--;
    }
    cells->count = cells->ends.count;
    return true;
}

/* ---- Arrays ---------------------------------------------------------------------------------- */

static int hex_digit(char c) {
    const char *digits = "0123456789abcdef0123456789ABCDEF";
    const char *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) % 16 : -1;
}

/* Names with blanks are written "Fractional%20Anisotropy". */
static bool decode_name(vtk *v, io_text *name) {
    char *copy = io_alloc(v->r, name->size, 1);
    size_t size = 0;
    for (size_t i = 0; copy && i < name->size; i++) {
        bool coded = name->at[i] == '%' && i + 2 < name->size;
        int high = coded ? hex_digit(name->at[i + 1]) : -1,
            low = coded ? hex_digit(name->at[i + 2]) : -1;
        if (high >= 0 && low >= 0)
            i += 2;
        copy[size++] = high >= 0 && low >= 0 ? (char)(high * 16 + low) : name->at[i];
    }
    name->at = copy;
    name->size = size;
    return copy != NULL;
}

static bool keep_array(vtk *v, io_text name, const io_view *values) {
    if (v->scope == OF_NOTHING)
        return true;
    array *arrays =
        io_grow(v->r, v->arrays, &v->array_capacity, v->array_count + 1, sizeof *arrays);
    if (!arrays || !decode_name(v, &name))
        return false;
    v->arrays = arrays;
    array kept = {name, *values, v->scope == OF_POINTS};
    arrays[v->array_count++] = kept;
    return true;
}

/* Strings in binary files: each with its length in front, in 1, 2, 4 or 8 bytes as its top two bits
 * tell. */
static bool skip_strings(vtk *v, size_t count) {
    io_text line;
    for (size_t i = 0; i < count; i++) {
        if (!v->binary) {
            if (!io_take_line(&v->c, &line))
                return too_short(v, count, 1);
            continue;
        }
        const uint8_t *first = io_take(&v->c, 1);
        int extra = first ? (1 << (3 - (*first >> 6))) - 1 : 0;
        const uint8_t *more = first ? io_take(&v->c, (size_t)extra) : NULL;
        uint64_t size = first ? *first & 63 : 0;
        for (int k = 0; more && k < extra; k++)
            size = size << 8 | more[k];
        if (!more || size > v->c.size - v->c.at || !io_take(&v->c, (size_t)size))
            return too_short(v, count, 1);
    }
    return true;
}

static bool is_blank_line(io_text line) {
    return !io_text_trim(line).size;
}

/* Describes the array before it, from the next line on; ended by an empty line. */
static void skip_metadata(vtk *v) {
    io_text line;
    (void)io_take_line(&v->c, &line);
    while (io_take_line(&v->c, &line) && !is_blank_line(line)) {
    }
}

/* Types that are not numbers are stepped over. */
static bool take_other(vtk *v, io_text type, size_t count) {
    io_view ignored;
    if (io_text_is(type, "string") || io_text_is(type, "utf8_string")) {
        io_text rest;
        (void)io_take_line(&v->c, &rest);
        return skip_strings(v, count);
    }
    if (io_text_is(type, "bit"))
        return v->binary ? take_values(v, IO_U8, count / 8 + (count % 8 > 0), 1, &ignored)
                         : take_values(v, IO_U8, count, 1, &ignored);
    return fail_at(v, "the array here has a type that is not known");
}

static bool take_array(vtk *v, io_text name, io_text type, size_t components, size_t rows) {
    io_view values;
    io_type kind = io_type_named(type);
    if (kind != IO_NONE)
        return take_values(v, kind, rows, components, &values) && keep_array(v, name, &values);
    if (components && rows > SIZE_MAX / components)
        return too_short(v, rows, 1);
    return take_other(v, type, rows * components);
}

static bool take_field(vtk *v) {
    io_text name, type;
    size_t arrays, components, rows;
    if (!io_take_word(&v->c, &name) || !take_size(v, &arrays))
        return fail_at(v, "FIELD needs a name and a count");
    for (size_t i = 0; i < arrays; i++) {
        while (peek_word(v, "METADATA")) {
            (void)io_take_word(&v->c, &name);
            skip_metadata(v);
        }
        if (!io_take_word(&v->c, &name))
            return too_short(v, arrays, 1);
        if (io_text_is(name, "NULL_ARRAY"))
            continue;
        if (!take_size(v, &components) || !take_size(v, &rows) || !io_take_word(&v->c, &type))
            return false;
        if (rows && components && !take_array(v, name, type, components, rows))
            return false;
    }
    return true;
}

static bool skip_words(vtk *v, int count) {
    io_text word;
    while (count && io_take_word(&v->c, &word))
        count--;
    return !count;
}

/* SCALARS name type [components], then usually LOOKUP_TABLE name. */
static bool take_scalars(vtk *v) {
    io_text line, name, type, word;
    size_t components = 1;
    if (!io_take_line(&v->c, &line))
        return fail_at(v, "SCALARS needs a name and a type");
    io_cursor words = {(const uint8_t *)line.at, line.size, 0};
    if (!io_take_word(&words, &name) || !io_take_word(&words, &type))
        return fail_at(v, "SCALARS needs a name and a type");
    if (io_take_word(&words, &word) && !io_parse_size(word, &components))
        return fail_at(v, "SCALARS has a broken number of components");
    size_t before = v->c.at;
    if (!peek_word(v, "LOOKUP_TABLE"))
        v->c.at = before - 1; /* back to the line end, where binary numbers are announced */
    else
        (void)skip_words(v, 2);
    return take_array(v, name, type, components, v->scope_rows);
}

static bool take_colors(vtk *v) {
    io_text name;
    size_t components;
    io_view values;
    return io_take_word(&v->c, &name) && take_size(v, &components) &&
           take_values(v, IO_U8, v->scope_rows, components, &values) &&
           keep_array(v, name, &values);
}

static bool skip_table(vtk *v) {
    io_text name;
    size_t rows;
    io_view ignored;
    return io_take_word(&v->c, &name) && take_size(v, &rows) &&
           take_values(v, IO_U8, rows, 4, &ignored);
}

/* Name, type, and a fixed number of components; 0 = told before the type. */
static bool take_named(vtk *v, size_t components) {
    io_text name, type;
    return io_take_word(&v->c, &name) && (components || take_size(v, &components)) &&
           io_take_word(&v->c, &type) && take_array(v, name, type, components, v->scope_rows);
}

/* ---- Sections -------------------------------------------------------------------------------- */

static bool take_points(vtk *v) {
    size_t count;
    io_type type;
    return take_size(v, &count) && take_type(v, &type) &&
           take_values(v, type, count, 3, &v->points);
}

static bool enter_scope(vtk *v, scope to) {
    v->scope = to;
    return take_size(v, &v->scope_rows);
}

static bool take_other_cells(vtk *v, size_t *count) {
    io_cells cells;
    if (!take_cells(v, &cells))
        return false;
    *count += cells.count;
    return true;
}

/* *known is false for a word that begins no section. */
static bool take_section(vtk *v, io_text word, bool *known) {
    // clang-format off
    static const struct { const char *word; size_t components; } named[] = {
        {"VECTORS", 3}, {"NORMALS", 3}, {"TENSORS", 9}, {"TENSORS6", 6}, {"TEXTURE_COORDINATES", 0},
        {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}, {"EDGE_FLAGS", 1},
    };
    // clang-format on
    *known = true;
    if (io_text_is(word, "POINTS"))
        return take_points(v);
    if (io_text_is(word, "LINES"))
        return take_cells(v, &v->lines);
    if (io_text_is(word, "VERTICES"))
        return take_other_cells(v, &v->vertex_cells);
    if (io_text_is(word, "POLYGONS") || io_text_is(word, "TRIANGLE_STRIPS"))
        return take_other_cells(v, &v->other_cells);
    if (io_text_is(word, "POINT_DATA"))
        return enter_scope(v, OF_POINTS);
    if (io_text_is(word, "CELL_DATA"))
        return enter_scope(v, OF_CELLS);
    if (io_text_is(word, "FIELD"))
        return take_field(v);
    if (io_text_is(word, "METADATA"))
        return skip_metadata(v), true;
    if (v->scope != OF_NOTHING) {
        if (io_text_is(word, "SCALARS"))
            return take_scalars(v);
        if (io_text_is(word, "COLOR_SCALARS"))
            return take_colors(v);
        if (io_text_is(word, "LOOKUP_TABLE"))
            return skip_table(v);
        for (size_t i = 0; i < sizeof named / sizeof named[0]; i++)
            if (io_text_is(word, named[i].word))
                return take_named(v, named[i].components);
    }
    *known = false;
    return true;
}

/* Version, title, ASCII or BINARY, and DATASET POLYDATA, perhaps with a FIELD in between. */
static bool take_head(vtk *v) {
    io_text line, word;
    if (!io_sniff_vtk(&v->c))
        return io_fail(v->r, "is not a VTK file: it does not begin with '# vtk DataFile'");
    for (int i = 0; i < 2; i++)
        (void)io_take_line(&v->c, &line);
    if (!io_take_word(&v->c, &word))
        return io_fail(v->r, "is cut in its head; copy the file again");
    v->binary = io_text_is(word, "BINARY");
    if (!v->binary && !io_text_is(word, "ASCII"))
        return fail_at(v, "ASCII or BINARY must stand in the third line");
    while (peek_word(v, "FIELD"))
        if (!io_take_word(&v->c, &word) || !take_field(v))
            return false;
    if (!io_take_word(&v->c, &word) || !io_text_is(word, "DATASET") || !io_take_word(&v->c, &word))
        return fail_at(v, "DATASET and its kind must stand here");
    return io_text_is(word, "POLYDATA") ||
           io_fail(v->r, "holds a %.*s; lines are read from POLYDATA",
                   (int)(word.size < 40 ? word.size : 40), word.at);
}

static bool build(vtk *v) {
    io_reader *r = v->r;
    size_t cells = v->vertex_cells + v->lines.count + v->other_cells;
    if (!v->lines.count && v->other_cells &&
        !io_warn(r, "the file holds %zu polygons, but no lines", v->other_cells))
        return false;
    if (!cells && v->points.count &&
        !io_warn(r, "the file holds %zu points, but no lines", v->points.count))
        return false;
    if (!io_add_cells(r, &v->points, &v->lines, v->vertex_cells))
        return false;
    for (size_t i = 0; i < v->array_count; i++) {
        const array *a = &v->arrays[i];
        size_t expected = a->of_points ? v->points.count : cells;
        if (a->values.count != expected &&
            !io_warn(r, "the array '%.*s' has %zu rows for %zu %s",
                     (int)(a->name.size < 64 ? a->name.size : 64), a->name.at, a->values.count,
                     expected, a->of_points ? "points" : "cells"))
            return false;
        if (!(a->of_points ? io_attach_points : io_attach_lines)(r, a->name, &a->values))
            return false;
    }
    return true;
}

bool io_read_vtk(io_reader *r, io_cursor *bytes) {
    vtk v;
    io_text word;
    memset(&v, 0, sizeof v);
    v.r = r;
    v.c = *bytes;
    if (!take_head(&v))
        return false;
    while (io_take_word(&v.c, &word)) {
        bool known;
        io_error_set(r->error, "is cut behind byte %zu; copy the file again", v.c.at);
        if (!take_section(&v, word, &known))
            return false;
        if (known)
            continue;
        if (!io_warn(r, "reading stopped at the unknown word '%.*s' in line %zu",
                     (int)(word.size < 32 ? word.size : 32), word.at, io_line_number(&v.c, v.c.at)))
            return false;
        break;
    }
    return build(&v);
}
