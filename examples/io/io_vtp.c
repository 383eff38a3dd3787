/* VTP: VTK's XML PolyData. expat reads the tags; the numbers are text, base64 or raw bytes, perhaps
 * in zlib blocks. */
#include "io_internal.h"

#include <expat.h>
#include <stdlib.h>
#include <string.h>

typedef enum section {
    NOWHERE,
    POINT_DATA,
    CELL_DATA,
    POINTS,
    VERTS,
    LINES,
    STRIPS,
    POLYS
} section;
typedef enum encoding { ASCII, BINARY, APPENDED } encoding;

typedef struct array {
    const char *name;
    section section;
    io_type type;
    encoding encoding;
    size_t components;
    size_t offset; /* into the appended data */
    char *text;    /* of ascii and inline binary ones */
    size_t size, capacity;
} array;

typedef struct piece {
    size_t points, verts, lines, strips, polys;
    size_t first, last; /* its arrays: first .. last - 1 */
} piece;

typedef struct vtp {
    io_reader *r;
    XML_Parser parser;
    bool big, wide, zlib;       /* big-endian; headers of 64 bits; compressed */
    bool failed, base64, known; /* base64: the appended data is; known: VTKFile was seen */
    size_t depth, array_depth;  /* array_depth: of the open DataArray, 0 = none */
    size_t polydata;            /* depth of PolyData, 0 = none */
    section section;
    array *arrays;
    size_t array_count, array_capacity;
    piece *pieces;
    size_t piece_count, piece_capacity;
    io_cursor appended; /* bytes behind the _ */
    size_t stopped;     /* byte where AppendedData begins */
} vtp;

io_match io_sniff_vtp(const io_cursor *bytes) {
    const size_t head = bytes->size < 4096 ? bytes->size : 4096;
    io_cursor c = {bytes->bytes, head, 0};
    if (head > 3 && !memcmp(bytes->bytes, "\xEF\xBB\xBF", 3))
        c.at = 3;
    io_text text;
    if (!io_take_word(&c, &text) || text.at[0] != '<')
        return IO_NO;
    for (const char *at = text.at; at + 8 <= (const char *)bytes->bytes + head; at++)
        if (!memcmp(at, "<VTKFile", 8))
            return IO_YES;
    return IO_MAYBE;
}

/* ---- Tags ------------------------------------------------------------------------------------ */

static const char *attribute(const XML_Char **attributes, const char *name) {
    for (size_t i = 0; attributes[i]; i += 2)
        if (!strcmp(attributes[i], name))
            return attributes[i + 1];
    return NULL;
}

static size_t number(const XML_Char **attributes, const char *name, size_t otherwise) {
    size_t value;
    const char *text = attribute(attributes, name);
    return text && io_parse_size(io_text_trim(io_text_of(text)), &value) ? value : otherwise;
}

static void stop(vtp *v, bool good) {
    v->failed = v->failed || !good;
    XML_StopParser(v->parser, XML_FALSE);
}

static bool is(const char *text, const char *word) {
    return text && !strcmp(text, word);
}

static bool begin_file(vtp *v, const XML_Char **attributes) {
    const char *type = attribute(attributes, "type"), *packer = attribute(attributes, "compressor");
    v->known = true;
    v->big = is(attribute(attributes, "byte_order"), "BigEndian");
    v->wide = is(attribute(attributes, "header_type"), "UInt64");
    v->zlib = packer && *packer;
    if (!is(type, "PolyData"))
        return io_fail(v->r, "holds %.40s; lines are read from PolyData (.vtp)",
                       type ? type : "an unknown kind of data");
    if (v->zlib && !is(packer, "vtkZLibDataCompressor"))
        return io_fail(v->r, "is compressed by %.40s; write it with ZLib or without compression",
                       packer);
    return true;
}

static bool begin_piece(vtp *v, const XML_Char **attributes) {
    piece *pieces =
        io_grow(v->r, v->pieces, &v->piece_capacity, v->piece_count + 1, sizeof *pieces);
    if (!pieces)
        return false;
    v->pieces = pieces;
    piece next = {number(attributes, "NumberOfPoints", 0),
                  number(attributes, "NumberOfVerts", 0),
                  number(attributes, "NumberOfLines", 0),
                  number(attributes, "NumberOfStrips", 0),
                  number(attributes, "NumberOfPolys", 0),
                  v->array_count,
                  v->array_count};
    pieces[v->piece_count++] = next;
    return true;
}

static bool begin_array(vtp *v, const XML_Char **attributes) {
    array *arrays =
        io_grow(v->r, v->arrays, &v->array_capacity, v->array_count + 1, sizeof *arrays);
    const char *name = attribute(attributes, "Name"), *format = attribute(attributes, "format");
    const char *type = attribute(attributes, "type");
    char *label = io_copy_text(v->r, io_text_of(name ? name : "unnamed"));
    if (arrays)
        v->arrays = arrays;
    if (!arrays || !label)
        return false;
    array *a = &arrays[v->array_count++];
    memset(a, 0, sizeof *a);
    a->name = label;
    v->pieces[v->piece_count - 1].last = v->array_count;
    a->section = v->section;
    a->type = type ? io_type_named(io_text_of(type)) : IO_NONE;
    a->encoding = is(format, "appended") ? APPENDED : is(format, "binary") ? BINARY : ASCII;
    a->components = number(attributes, "NumberOfComponents", 1);
    a->offset = number(attributes, "offset", SIZE_MAX);
    v->array_depth = v->depth;
    return true;
}

static section section_named(const char *name) {
    static const char *const names[] = {"",      "PointData", "CellData", "Points",
                                        "Verts", "Lines",     "Strips",   "Polys"};
    for (size_t i = 1; i < sizeof names / sizeof names[0]; i++)
        if (!strcmp(name, names[i]))
            return (section)i;
    return NOWHERE;
}

static void XMLCALL on_begin(void *user, const XML_Char *name, const XML_Char **attributes) {
    vtp *v = user;
    bool good = true;
    v->depth++;
    if (v->depth == 1)
        good = is(name, "VTKFile") ? begin_file(v, attributes)
                                   : io_fail(v->r, "is not a VTP file: its root is <%.40s>", name);
    else if (v->depth == 2 && is(name, "PolyData"))
        v->polydata = v->depth;
    else if (v->depth == 2 && is(name, "AppendedData")) {
        v->base64 = !is(attribute(attributes, "encoding"), "raw");
        v->stopped = (size_t)XML_GetCurrentByteIndex(v->parser);
        stop(v, true); /* what follows may be raw bytes, which are not XML */
    } else if (v->polydata && v->depth == 3 && is(name, "Piece"))
        good = begin_piece(v, attributes);
    else if (v->polydata && v->depth == 4 && v->piece_count)
        v->section = section_named(name);
    else if (v->depth == 5 && v->section != NOWHERE && is(name, "DataArray"))
        good = begin_array(v, attributes);
    if (!good)
        stop(v, false);
}

static void XMLCALL on_end(void *user, const XML_Char *name) {
    vtp *v = user;
    (void)name;
    if (v->array_depth == v->depth)
        v->array_depth = 0;
    if (v->depth == 4)
        v->section = NOWHERE;
    if (v->depth == v->polydata)
        v->polydata = 0;
    v->depth--;
}

/* Text of the array itself, not of an InformationKey inside it. */
static void XMLCALL on_text(void *user, const XML_Char *text, int size) {
    vtp *v = user;
    if (!v->array_depth || v->array_depth != v->depth)
        return;
    array *a = &v->arrays[v->array_count - 1];
    char *grown = io_grow(v->r, a->text, &a->capacity, a->size + (size_t)size, 1);
    if (!grown) {
        stop(v, false);
        return;
    }
    a->text = grown;
    memcpy(grown + a->size, text, (size_t)size);
    a->size += (size_t)size;
}

/* Leaves the appended bytes behind the first _ after the tag. */
static bool find_appended(vtp *v, const io_cursor *c) {
    const uint8_t *tag =
        v->stopped < c->size ? memchr(c->bytes + v->stopped, '>', c->size - v->stopped) : NULL;
    const uint8_t *end = c->bytes + c->size;
    const uint8_t *mark = tag ? memchr(tag, '_', (size_t)(end - tag)) : NULL;
    if (!mark)
        return io_fail(v->r,
                       "is cut in its appended data, which must begin with _; copy the file again");
    v->appended.bytes = mark + 1;
    v->appended.size = (size_t)(end - mark) - 1;
    return true;
}

static bool parse(vtp *v, const io_cursor *c) {
    enum { PART = 1 << 20 };
    for (size_t at = 0; at < c->size && !v->failed && !v->stopped; at += PART) {
        size_t size = c->size - at < PART ? c->size - at : PART;
        enum XML_Status status =
            XML_Parse(v->parser, (const char *)c->bytes + at, (int)size, at + size == c->size);
        if (v->failed || v->stopped)
            break;
        if (status != XML_STATUS_OK)
            return io_fail(v->r, "is damaged XML in line %lu (%s); copy the file again",
                           (unsigned long)XML_GetCurrentLineNumber(v->parser),
                           XML_ErrorString(XML_GetErrorCode(v->parser)));
        if (!io_tick(v->r, at, 2 * c->size))
            return false;
    }
    return !v->failed && (!v->stopped || find_appended(v, c));
}

/* ---- Encodings ------------------------------------------------------------------------------- */

static int base64_value(uint8_t c) {
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

static bool is_space(uint8_t c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

/* The first wanted bytes of base64 text, or fewer. VTK encodes header and data one after the other,
 * each with padding: going on behind the padding gives their bytes in a row. */
static size_t decode_base64(const uint8_t *text, size_t size, uint8_t *out, size_t wanted) {
    size_t got = 0;
    uint32_t bits = 0;
    int count = 0; /* characters in bits */
    for (size_t i = 0; i < size && got < wanted; i++) {
        int value = base64_value(text[i]);
        if (value < 0 && is_space(text[i]))
            continue;
        if (value < 0 && text[i] != '=')
            break;
        if (value >= 0) {
            bits = bits << 6 | (uint32_t)value;
            if (++count < 4)
                continue;
        }
        /* a full group of four, or one that padding ends */
        bits <<= 6 * (4 - count);
        for (int k = 0; k < count - 1 && got < wanted; k++)
            out[got++] = (uint8_t)(bits >> (16 - 8 * k) & 255);
        bits = 0;
        count = 0;
    }
    return got;
}

typedef struct source { /* bytes of one array, encoded or not */
    const uint8_t *bytes;
    size_t size;
    bool base64;
} source;

/* The first wanted bytes, NULL when there are fewer. */
static const uint8_t *fetch(vtp *v, const source *s, size_t wanted) {
    if (wanted > s->size)
        return NULL;
    if (!s->base64)
        return s->bytes;
    uint8_t *out = io_alloc(v->r, wanted, 1);
    return out && decode_base64(s->bytes, s->size, out, wanted) == wanted ? out : NULL;
}

static uint64_t head_number(const vtp *v, const uint8_t *head, size_t index) {
    return v->wide ? io_u64(head + 8 * index, v->big) : io_u32(head + 4 * index, v->big);
}

static bool fail_array(vtp *v, const array *a, const char *what) {
    return io_fail(v->r, "is damaged in its array '%.64s': %s; copy or write the file again",
                   a->name, what);
}

/* Compressed: number of blocks, size of a block, size of the last one (0 = full), then the
 * compressed sizes. */
static const uint8_t *unpack(vtp *v, const array *a, const source *s, size_t needed) {
    size_t word = v->wide ? 8 : 4;
    const uint8_t *head = fetch(v, s, 3 * word);
    uint64_t blocks = head ? head_number(v, head, 0) : 0;
    uint64_t full = head ? head_number(v, head, 1) : 0, last = head ? head_number(v, head, 2) : 0;
    if (!head || blocks > s->size / word || !(head = fetch(v, s, (3 + (size_t)blocks) * word))) {
        fail_array(v, a, "the list of its blocks is cut");
        return NULL;
    }
    uint64_t packed = (3 + blocks) * word;
    for (uint64_t i = 0; i < blocks && packed <= s->size; i++) {
        uint64_t size = head_number(v, head, 3 + (size_t)i);
        packed = size > s->size ? UINT64_MAX : packed + size;
    }
    last = last ? last : full;
    bool sane = packed <= s->size && full <= v->r->limit && last <= v->r->limit &&
                (blocks < 2 || full <= v->r->limit / (blocks - 1));
    uint64_t total = sane && blocks ? (blocks - 1) * full + last : 0;
    if (!sane || total < needed || !(head = fetch(v, s, (size_t)packed))) {
        fail_array(v, a, "its blocks hold fewer bytes than its size needs");
        return NULL;
    }
    uint8_t *out = io_alloc(v->r, (size_t)total, 1);
    const uint8_t *from = head + (3 + (size_t)blocks) * word;
    for (size_t i = 0, at = 0; out && i < blocks; i++) {
        size_t size = (size_t)head_number(v, head, 3 + i),
               length = (size_t)(i + 1 < blocks ? full : last);
        if (!io_inflate(from, size, out + at, length)) {
            fail_array(v, a, "a compressed block does not unpack to its size");
            return NULL;
        }
        from += size;
        at += length;
    }
    return out;
}

static bool take_text(vtp *v, const array *a, size_t rows, io_view *out) {
    if (rows > a->size / a->components) /* each number takes a digit at least */
        return fail_array(v, a, "it has fewer numbers than its size needs");
    double *values = io_alloc(v->r, rows, a->components * sizeof *values);
    io_cursor words = {(const uint8_t *)a->text, a->size, 0};
    for (size_t i = 0; values && i < rows * a->components; i++) {
        io_text word;
        if (!io_take_word(&words, &word) || !io_parse_real(word, &values[i]))
            return fail_array(v, a,
                              "it has fewer numbers than its size needs, or a word among them");
    }
    if (values)
        *out = io_view_doubles(values, rows, (uint32_t)a->components);
    return values != NULL;
}

static bool take_array(vtp *v, const array *a, size_t rows, io_view *out) {
    size_t stride = a->components * io_type_size(a->type), word = v->wide ? 8 : 4;
    memset(out, 0, sizeof *out);
    if (!rows)
        return true;
    if (a->encoding == ASCII)
        return take_text(v, a, rows, out);
    source s = {(const uint8_t *)a->text, a->size, true};
    if (a->encoding == APPENDED) {
        if (a->offset >= v->appended.size)
            return fail_array(v, a, "its offset lies behind the appended data");
        s.bytes = v->appended.bytes + a->offset;
        s.size = v->appended.size - a->offset;
        s.base64 = v->base64;
    }
    if (rows > SIZE_MAX / stride)
        return fail_array(v, a, "its size overflows");
    const uint8_t *bytes;
    if (v->zlib) {
        if (!(bytes = unpack(v, a, &s, rows * stride)))
            return false;
    } else {
        bytes = fetch(v, &s, word);
        uint64_t size = bytes ? head_number(v, bytes, 0) : 0;
        if (!bytes || size < rows * stride || size > s.size ||
            !(bytes = fetch(v, &s, word + rows * stride)))
            return fail_array(v, a, "it has fewer bytes than its size needs");
        bytes += word;
    }
    io_view view = {bytes, rows, stride, (uint32_t)a->components, a->type, v->big};
    *out = view;
    return true;
}

/* ---- Pieces ---------------------------------------------------------------------------------- */

static const array *find(const vtp *v, const piece *p, section in, const char *name) {
    for (size_t i = p->first; i < p->last; i++)
        if (v->arrays[i].section == in && (!name || is(v->arrays[i].name, name)))
            return &v->arrays[i];
    return NULL;
}

static bool is_numeric(const array *a, size_t components) {
    return a && a->type != IO_NONE && (!components || a->components == components);
}

static bool add_lines(vtp *v, const piece *p) {
    const array *points = find(v, p, POINTS, NULL), *ends = find(v, p, LINES, "offsets");
    const array *indices = find(v, p, LINES, "connectivity");
    io_view at;
    io_cells cells;
    memset(&cells, 0, sizeof cells);
    if (!is_numeric(ends, 1) || !is_numeric(indices, 1) || (p->points && !is_numeric(points, 3)))
        return io_fail(v->r, "lacks the arrays Points, offsets or connectivity of its %zu lines",
                       p->lines);
    if (p->points && !take_array(v, points, p->points, &at))
        return false;
    if (!p->points)
        memset(&at, 0, sizeof at);
    if (!take_array(v, ends, p->lines, &cells.ends))
        return false;
    size_t total;
    if (!io_view_index(&cells.ends, p->lines - 1, &total))
        return io_fail(v->r, "has a negative or broken last offset of its lines");
    cells.count = p->lines;
    return take_array(v, indices, total, &cells.index) && io_add_cells(v->r, &at, &cells, p->verts);
}

static bool add_attributes(vtp *v, const piece *p) {
    for (size_t i = p->first; i < p->last; i++) {
        const array *a = &v->arrays[i];
        bool of_points = a->section == POINT_DATA;
        io_view values;
        if ((!of_points && a->section != CELL_DATA) || a->type == IO_NONE)
            continue;
        if (!a->components || a->components > IO_MAX_COMPONENTS) {
            if (!io_warn(v->r, "the array '%.64s' has %zu values per row; only 1 to %d are read",
                         a->name, a->components, IO_MAX_COMPONENTS))
                return false;
            continue;
        }
        /* cells count in the order vertices, lines, others; only those up to the lines matter */
        size_t rows = of_points ? p->points : p->verts + p->lines;
        if (!of_points && rows < p->lines)
            return io_fail(v->r, "has broken cell counts in a Piece");
        if (!take_array(v, a, rows, &values))
            return false;
        if (!(of_points ? io_attach_points : io_attach_lines)(v->r, io_text_of(a->name), &values))
            return false;
    }
    return true;
}

static bool build(vtp *v) {
    size_t lines = 0, others = 0;
    for (size_t i = 0; i < v->piece_count; i++) {
        const piece *p = &v->pieces[i];
        others += p->polys > 0 || p->strips > 0 || p->points > 0;
        if (!p->lines)
            continue;
        lines++;
        io_next_batch(v->r);
        if (!add_lines(v, p) || !add_attributes(v, p))
            return false;
    }
    return lines || !others || io_warn(v->r, "the file holds points or polygons, but no lines");
}

bool io_read_vtp(io_reader *r, io_cursor *bytes) {
    vtp v;
    memset(&v, 0, sizeof v);
    v.r = r;
    v.parser = XML_ParserCreate(NULL);
    if (!v.parser)
        return io_fail(r, "cannot be read: the XML parser got no memory");
    XML_SetUserData(v.parser, &v);
    XML_SetElementHandler(v.parser, on_begin, on_end);
    XML_SetCharacterDataHandler(v.parser, on_text);
    bool parsed = parse(&v, bytes);
    XML_ParserFree(v.parser);
    return parsed && build(&v);
}

/* ---- Writing --------------------------------------------------------------------------------- */

static void put_name(FILE *file, const char *name) {
    for (; *name; name++) {
        if (*name == '&' || *name == '<' || *name == '>' || *name == '"')
            fprintf(file, "&#%d;", *name);
        else
            putc((unsigned char)*name < 0x20 ? '?' : *name, file);
    }
}

/* One tag for each array; the offsets are those at which put_data writes. */
static void put_tag(FILE *file, const char *type, const char *name, uint32_t components,
                    uint64_t bytes, uint64_t *offset) {
    fprintf(file, "<DataArray type=\"%s\" Name=\"", type);
    put_name(file, name);
    fprintf(file, "\" NumberOfComponents=\"%lu\" format=\"appended\" offset=\"%llu\"/>\n",
            (unsigned long)components, (unsigned long long)*offset);
    *offset += 8 + bytes;
}

static void put_attribute_tags(FILE *file, const char *tag, const io_attribute *attributes,
                               uint32_t count, uint64_t rows, uint64_t *offset) {
    fprintf(file, "<%s>\n", tag);
    for (uint32_t i = 0; i < count; i++)
        put_tag(file, "Float32", attributes[i].name, attributes[i].components,
                4 * rows * attributes[i].components, offset);
    fprintf(file, "</%s>\n", tag);
}

static void put_attributes(FILE *file, const io_attribute *attributes, uint32_t count,
                           uint64_t rows) {
    for (uint32_t i = 0; i < count; i++) {
        uint64_t values = rows * attributes[i].components;
        io_put_u64(file, 4 * values);
        for (uint64_t k = 0; k < values; k++)
            io_put_f32(file, (double)attributes[i].data[k]);
    }
}

static void put_data(FILE *file, const io_lines *lines, bool wide) {
    put_attributes(file, lines->point_attributes, lines->point_attribute_count, lines->point_count);
    put_attributes(file, lines->line_attributes, lines->line_attribute_count, lines->line_count);
    io_put_u64(file, (uint64_t)lines->point_count * (wide ? 24 : 12));
    for (size_t i = 0; i < lines->point_count && !ferror(file); i++)
        for (unsigned axis = 0; axis < 3; axis++)
            (wide ? io_put_f64 : io_put_f32)(file, io_position(lines, i, axis));
    io_put_u64(file, (uint64_t)lines->point_count * 8);
    for (uint64_t i = 0; i < lines->point_count; i++)
        io_put_u64(file, i);
    io_put_u64(file, (uint64_t)lines->line_count * 8);
    for (size_t i = 0; i < lines->line_count; i++)
        io_put_u64(file, lines->offsets[i + 1]);
}

/* Appended raw arrays; positions are doubles where an origin had been taken off, for that is where
 * floats are too coarse. */
bool io_write_vtp(FILE *file, const io_lines *lines, io_error *error) {
    (void)error;
    bool wide = lines->origin[0] != 0 || lines->origin[1] != 0 || lines->origin[2] != 0;
    uint64_t offset = 0, points = lines->point_count, count = lines->line_count;
    fprintf(
        file,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
        "byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"%llu\" NumberOfVerts=\"0\" "
        "NumberOfLines=\"%llu\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
        (unsigned long long)points, (unsigned long long)count);
    put_attribute_tags(file, "PointData", lines->point_attributes, lines->point_attribute_count,
                       points, &offset);
    put_attribute_tags(file, "CellData", lines->line_attributes, lines->line_attribute_count, count,
                       &offset);
    fputs("<Points>\n", file);
    put_tag(file, wide ? "Float64" : "Float32", "Points", 3, points * (wide ? 24 : 12), &offset);
    fputs("</Points>\n<Lines>\n", file);
    put_tag(file, "Int64", "connectivity", 1, points * 8, &offset);
    put_tag(file, "Int64", "offsets", 1, count * 8, &offset);
    fputs("</Lines>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_", file);
    put_data(file, lines, wide);
    fputs("\n</AppendedData>\n</VTKFile>\n", file);
    return true;
}
