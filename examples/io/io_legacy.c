/* VTK legacy files: keywords and numbers as text, or numbers big-endian in between. Both layouts of
 * cells (counts before indices; since 5.1 OFFSETS and CONNECTIVITY) are read. */
#include "io_vtk.h"

#include <string.h>

static const char magic[] = "# vtk DataFile";

io_match io_sniff_legacy(const io_cursor *bytes, const char *kind) {
    io_text text = {(const char *)bytes->bytes, bytes->size}, word;
    if (!io_text_starts(text, magic))
        return IO_NO;
    io_cursor c = *bytes;
    for (int i = 0; i < 2; i++) /* version and title */
        (void)io_take_line(&c, &word);
    for (int i = 0; kind && i < 64 && io_take_word(&c, &word); i++)
        if (io_text_is(word, "DATASET"))
            return io_take_word(&c, &word) && io_text_is(word, kind) ? IO_YES : IO_NO;
    return kind ? IO_NO : IO_YES;
}

static bool fail_at(io_legacy *v, const char *what) {
    return io_fail(v->r, "is damaged in line %zu (byte %zu): %s", io_line_number(&v->c, v->c.at),
                   v->c.at, what);
}

/* ---- Numbers --------------------------------------------------------------------------------- */

static bool take_size(io_legacy *v, size_t *value) {
    io_text word;
    return (io_take_word(&v->c, &word) && io_parse_size(word, value)) ||
           fail_at(v, "a count is missing here");
}

/* Binary numbers begin right behind the line that announces them. */
static bool end_announcement(io_legacy *v) {
    io_text rest;
    if (v->binary && !io_take_line(&v->c, &rest) && v->c.at < v->c.size)
        return fail_at(v, "the line does not end");
    return true;
}

static bool too_short(io_legacy *v, size_t count, uint32_t components) {
    return io_fail(
        v->r,
        "ends too early: %zu x %lu numbers are announced before byte %zu, and %zu bytes follow; "
        "copy the file again",
        count, (unsigned long)components, v->c.at, v->c.size - v->c.at);
}

static bool take_binary(io_legacy *v, io_type type, size_t count, uint32_t components,
                        io_view *out) {
    size_t stride = components * io_type_size(type);
    if (!end_announcement(v))
        return false;
    const uint8_t *bytes =
        count <= (v->c.size - v->c.at) / stride ? io_take(&v->c, count * stride) : NULL;
    io_view view = {bytes, count, stride, components, type, true};
    *out = view;
    return bytes || too_short(v, count, components);
}

static bool take_ascii(io_legacy *v, size_t count, uint32_t components, io_view *out) {
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

static bool take_values(io_legacy *v, io_type type, size_t count, size_t components, io_view *out) {
    if (!components || components > UINT16_MAX)
        return fail_at(v, "an array has 0 or more than 65535 values per row");
    return v->binary ? take_binary(v, type, count, (uint32_t)components, out)
                     : take_ascii(v, count, (uint32_t)components, out);
}

static bool take_type(io_legacy *v, io_type *type) {
    io_text word;
    if (!io_take_word(&v->c, &word))
        return fail_at(v, "a type is missing here");
    *type = io_type_named(word);
    return *type != IO_NONE || fail_at(v, "the word before this place is not a type of numbers");
}

/* ---- Cells ----------------------------------------------------------------------------------- */

static bool peek_word(const io_legacy *v, const char *expected) {
    io_cursor ahead = v->c;
    io_text word;
    return io_take_word(&ahead, &word) && io_text_is(word, expected);
}

static bool expect_typed(io_legacy *v, const char *keyword, size_t count, io_view *out) {
    io_text word;
    io_type type = IO_NONE;
    if (!peek_word(v, keyword) || !io_take_word(&v->c, &word))
        return fail_at(v, "OFFSETS or CONNECTIVITY is missing here");
    return take_type(v, &type) && take_values(v, type, count, 1, out);
}

/* After the keyword: n and size; in the new layout n counts the offsets, one more than there are
 * cells. */
static bool take_cells(io_legacy *v, io_cells *cells) {
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
static bool decode_name(io_legacy *v, io_text *name) {
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

static bool keep_array(io_legacy *v, io_text name, const io_view *values) {
    if (v->scope == IO_OF_NOTHING)
        return true;
    io_array *arrays =
        io_grow(v->r, v->arrays, &v->array_capacity, v->array_count + 1, sizeof *arrays);
    if (!arrays || !decode_name(v, &name))
        return false;
    v->arrays = arrays;
    io_array kept = {name, *values, v->scope == IO_OF_POINTS};
    arrays[v->array_count++] = kept;
    return true;
}

/* Strings in binary files: each with its length in front, in 1, 2, 4 or 8 bytes as its top two bits
 * tell. */
static bool skip_strings(io_legacy *v, size_t count) {
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
static void skip_metadata(io_legacy *v) {
    io_text line;
    (void)io_take_line(&v->c, &line);
    while (io_take_line(&v->c, &line) && !is_blank_line(line)) {
    }
}

/* Types that are not numbers are stepped over. */
static bool take_other(io_legacy *v, io_text type, size_t count) {
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

static bool take_array(io_legacy *v, io_text name, io_text type, size_t components, size_t rows) {
    io_view values;
    io_type kind = io_type_named(type);
    if (kind != IO_NONE)
        return take_values(v, kind, rows, components, &values) && keep_array(v, name, &values);
    if (components && rows > SIZE_MAX / components)
        return too_short(v, rows, 1);
    return take_other(v, type, rows * components);
}

static bool take_field(io_legacy *v) {
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

static bool skip_words(io_legacy *v, int count) {
    io_text word;
    while (count && io_take_word(&v->c, &word))
        count--;
    return !count;
}

/* SCALARS name type [components], then usually LOOKUP_TABLE name. */
static bool take_scalars(io_legacy *v) {
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

static bool take_colors(io_legacy *v) {
    io_text name;
    size_t components;
    io_view values;
    return io_take_word(&v->c, &name) && take_size(v, &components) &&
           take_values(v, IO_U8, v->scope_rows, components, &values) &&
           keep_array(v, name, &values);
}

static bool skip_table(io_legacy *v) {
    io_text name;
    size_t rows;
    io_view ignored;
    return io_take_word(&v->c, &name) && take_size(v, &rows) &&
           take_values(v, IO_U8, rows, 4, &ignored);
}

/* Name, type, and a fixed number of components; 0 = told before the type. */
static bool take_named(io_legacy *v, size_t components) {
    io_text name, type;
    return io_take_word(&v->c, &name) && (components || take_size(v, &components)) &&
           io_take_word(&v->c, &type) && take_array(v, name, type, components, v->scope_rows);
}

/* ---- Sections -------------------------------------------------------------------------------- */

static bool take_points(io_legacy *v) {
    size_t count;
    io_type type;
    return take_size(v, &count) && take_type(v, &type) &&
           take_values(v, type, count, 3, &v->points);
}

static bool take_dimensions(io_legacy *v) {
    for (int axis = 0; axis < 3; axis++) {
        size_t count;
        if (!take_size(v, &count))
            return false;
        if (!count || count > INT32_MAX)
            return fail_at(v, "a dimension is not in 1 to 2147483647");
        v->image.extent[2 * axis + 1] = (int64_t)count - 1;
    }
    return (v->image.has_extent = true);
}

static bool take_reals(io_legacy *v, double values[3]) {
    for (int axis = 0; axis < 3; axis++) {
        io_text word;
        if (!io_take_word(&v->c, &word) || !io_parse_real(word, &values[axis]))
            return fail_at(v, "three numbers must stand here");
    }
    return true;
}

static bool enter_scope(io_legacy *v, io_legacy_scope to) {
    v->scope = to;
    return take_size(v, &v->scope_rows);
}

/* *known is false for a word that begins no section. */
static bool take_section(io_legacy *v, io_text word, bool *known) {
    // clang-format off
    static const struct { const char *word; size_t components; } named[] = {
        {"VECTORS", 3}, {"NORMALS", 3}, {"TENSORS", 9}, {"TENSORS6", 6}, {"TEXTURE_COORDINATES", 0},
        {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}, {"EDGE_FLAGS", 1},
    };
    // clang-format on
    *known = true;
    if (io_text_is(word, "POINTS"))
        return take_points(v);
    if (io_text_is(word, "DIMENSIONS"))
        return take_dimensions(v);
    if (io_text_is(word, "ORIGIN"))
        return take_reals(v, v->image.origin);
    if (io_text_is(word, "SPACING") || io_text_is(word, "ASPECT_RATIO")) /* its older name */
        return (v->image.has_spacing = take_reals(v, v->image.spacing));
    if (io_text_is(word, "LINES"))
        return take_cells(v, &v->lines);
    if (io_text_is(word, "VERTICES"))
        return take_cells(v, &v->vertices);
    if (io_text_is(word, "POLYGONS"))
        return take_cells(v, &v->polygons);
    if (io_text_is(word, "TRIANGLE_STRIPS"))
        return take_cells(v, &v->strips);
    if (io_text_is(word, "POINT_DATA"))
        return enter_scope(v, IO_OF_POINTS);
    if (io_text_is(word, "CELL_DATA"))
        return enter_scope(v, IO_OF_CELLS);
    if (io_text_is(word, "FIELD"))
        return take_field(v);
    if (io_text_is(word, "METADATA"))
        return skip_metadata(v), true;
    if (v->scope != IO_OF_NOTHING) {
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

/* Version, title, ASCII or BINARY, and DATASET and its kind, perhaps with a FIELD in between. */
static bool take_head(io_legacy *v, const char *kind, const char *reads) {
    io_text line, word;
    if (io_sniff_legacy(&v->c, NULL) != IO_YES)
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
    return io_text_is(word, kind) ||
           io_fail(v->r, "holds a %.*s; %s %s", (int)(word.size < 40 ? word.size : 40), word.at,
                   reads, kind);
}

bool io_legacy_parse(io_reader *r, const io_cursor *bytes, const char *kind, const char *reads,
                     io_legacy *out) {
    io_legacy v;
    io_text word;
    memset(&v, 0, sizeof v);
    v.r = r;
    v.c = *bytes;
    v.image.direction[0] = v.image.direction[4] = v.image.direction[8] = 1;
    if (!take_head(&v, kind, reads))
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
    *out = v;
    return true;
}
