/* VTK's XML files: expat reads the tags; the numbers are text, base64 or raw bytes, perhaps in zlib
 * blocks. */
#include "io_vtk.h"

#include <expat.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Is the word within the bytes? */
static bool holds(const uint8_t *bytes, size_t size, const char *word) {
    size_t length = strlen(word);
    for (size_t i = 0; i + length <= size; i++)
        if (!memcmp(bytes + i, word, length))
            return true;
    return false;
}

io_match io_sniff_xml(const io_cursor *bytes, const char *kind) {
    const size_t head = bytes->size < 4096 ? bytes->size : 4096;
    io_cursor c = {bytes->bytes, head, 0};
    if (head > 3 && !memcmp(bytes->bytes, "\xEF\xBB\xBF", 3))
        c.at = 3;
    io_text text;
    if (!io_take_word(&c, &text) || text.at[0] != '<')
        return IO_NO;
    if (!holds(bytes->bytes, head, "<VTKFile"))
        return IO_MAYBE;
    return !kind || holds(bytes->bytes, head, kind) ? IO_YES : IO_NO;
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

static void stop(io_xml *v, bool good) {
    v->failed = v->failed || !good;
    XML_StopParser(v->parser, XML_FALSE);
}

static bool is(const char *text, const char *word) {
    return text && !strcmp(text, word);
}

static bool begin_file(io_xml *v, const XML_Char **attributes) {
    const char *type = attribute(attributes, "type"), *packer = attribute(attributes, "compressor");
    v->big = is(attribute(attributes, "byte_order"), "BigEndian");
    v->wide = is(attribute(attributes, "header_type"), "UInt64");
    v->zlib = packer && *packer;
    if (!is(type, v->kind))
        return io_fail(v->r, "holds %.40s; %s", type ? type : "an unknown kind of data", v->reads);
    if (v->zlib && !is(packer, "vtkZLibDataCompressor"))
        return io_fail(v->r, "is compressed by %.40s; write it with ZLib or without compression",
                       packer);
    return true;
}

bool io_parse_reals(io_text text, double *values, size_t count) {
    io_cursor words = {(const uint8_t *)text.at, text.size, 0};
    io_text word;
    for (size_t i = 0; i < count; i++)
        if (!io_take_word(&words, &word) || !io_parse_real(word, &values[i]))
            return false;
    return !io_take_word(&words, &word);
}

/* Leaves values alone and *told false when there is no such attribute. */
static bool numbers(io_xml *v, const XML_Char **attributes, const char *name, double *values,
                    size_t count, bool *told) {
    const char *text = attribute(attributes, name);
    *told = text != NULL;
    return !text || io_parse_reals(io_text_of(text), values, count) ||
           io_fail(v->r, "has a broken %s: '%.64s' is not %zu numbers", name, text, count);
}

/* Only ImageData has these attributes. */
static bool begin_data_set(io_xml *v, const XML_Char **attributes) {
    bool told;
    double extent[6] = {0, 0, 0, 0, 0, 0};
    io_image *image = &v->image;
    v->data_set = v->depth;
    if (!numbers(v, attributes, "WholeExtent", extent, 6, &image->has_extent) ||
        !numbers(v, attributes, "Origin", image->origin, 3, &told) ||
        !numbers(v, attributes, "Spacing", image->spacing, 3, &image->has_spacing) ||
        !numbers(v, attributes, "Direction", image->direction, 9, &told))
        return false;
    for (int i = 0; i < 6; i++) {
        if (!(fabs(extent[i]) <= INT32_MAX) || floor(extent[i]) != extent[i])
            return io_fail(v->r, "has a WholeExtent that is not six whole numbers");
        image->extent[i] = (int64_t)extent[i];
    }
    return true;
}

static bool begin_piece(io_xml *v, const XML_Char **attributes) {
    io_xml_piece *pieces =
        io_grow(v->r, v->pieces, &v->piece_capacity, v->piece_count + 1, sizeof *pieces);
    if (!pieces)
        return false;
    v->pieces = pieces;
    io_xml_piece next = {number(attributes, "NumberOfPoints", 0),
                         number(attributes, "NumberOfVerts", 0),
                         number(attributes, "NumberOfLines", 0),
                         number(attributes, "NumberOfStrips", 0),
                         number(attributes, "NumberOfPolys", 0),
                         v->array_count,
                         v->array_count,
                         {0, 0, 0, 0, 0, 0},
                         false};
    pieces[v->piece_count++] = next;
    return numbers(v, attributes, "Extent", pieces[v->piece_count - 1].extent, 6,
                   &pieces[v->piece_count - 1].has_extent);
}

static bool begin_array(io_xml *v, const XML_Char **attributes) {
    io_xml_array *arrays =
        io_grow(v->r, v->arrays, &v->array_capacity, v->array_count + 1, sizeof *arrays);
    const char *name = attribute(attributes, "Name"), *format = attribute(attributes, "format");
    const char *type = attribute(attributes, "type");
    char *label = io_copy_text(v->r, io_text_of(name ? name : "unnamed"));
    if (arrays)
        v->arrays = arrays;
    if (!arrays || !label)
        return false;
    io_xml_array *a = &arrays[v->array_count++];
    memset(a, 0, sizeof *a);
    a->name = label;
    v->pieces[v->piece_count - 1].last = v->array_count;
    a->section = v->section;
    a->type = type ? io_type_named(io_text_of(type)) : IO_NONE;
    a->encoding = is(format, "appended") ? IO_XML_APPENDED
                  : is(format, "binary") ? IO_XML_BINARY
                                         : IO_XML_ASCII;
    a->components = number(attributes, "NumberOfComponents", 1);
    a->offset = number(attributes, "offset", SIZE_MAX);
    v->array_depth = v->depth;
    return true;
}

static io_xml_section section_named(const char *name) {
    static const char *const names[] = {"",      "PointData", "CellData", "Points",
                                        "Verts", "Lines",     "Strips",   "Polys"};
    for (size_t i = 1; i < sizeof names / sizeof names[0]; i++)
        if (!strcmp(name, names[i]))
            return (io_xml_section)i;
    return IO_XML_NOWHERE;
}

static bool begin_section(io_xml *v, const char *name, const XML_Char **attributes) {
    v->section = section_named(name);
    const char *vectors = attribute(attributes, "Vectors");
    if (v->section == IO_XML_NOWHERE || !vectors || v->vectors)
        return true;
    return (v->vectors = io_copy_text(v->r, io_text_of(vectors))) != NULL;
}

static void XMLCALL on_begin(void *user, const XML_Char *name, const XML_Char **attributes) {
    io_xml *v = user;
    bool good = true;
    v->depth++;
    if (v->depth == 1)
        good = is(name, "VTKFile") ? begin_file(v, attributes)
                                   : io_fail(v->r, "is not a VTK file: its root is <%.40s>", name);
    else if (v->depth == 2 && is(name, v->kind))
        good = begin_data_set(v, attributes);
    else if (v->depth == 2 && is(name, "AppendedData")) {
        v->base64 = !is(attribute(attributes, "encoding"), "raw");
        v->stopped = (size_t)XML_GetCurrentByteIndex(v->parser);
        stop(v, true); /* what follows may be raw bytes, which are not XML */
    } else if (v->data_set && v->depth == 3 && is(name, "Piece"))
        good = begin_piece(v, attributes);
    else if (v->data_set && v->depth == 4 && v->piece_count)
        good = begin_section(v, name, attributes);
    else if (v->depth == 5 && v->section != IO_XML_NOWHERE && is(name, "DataArray"))
        good = begin_array(v, attributes);
    if (!good)
        stop(v, false);
}

static void XMLCALL on_end(void *user, const XML_Char *name) {
    io_xml *v = user;
    (void)name;
    if (v->array_depth == v->depth)
        v->array_depth = 0;
    if (v->depth == 4)
        v->section = IO_XML_NOWHERE;
    if (v->depth == v->data_set)
        v->data_set = 0;
    v->depth--;
}

/* Text of the array itself, not of an InformationKey inside it. */
static void XMLCALL on_text(void *user, const XML_Char *text, int size) {
    io_xml *v = user;
    if (!v->array_depth || v->array_depth != v->depth)
        return;
    io_xml_array *a = &v->arrays[v->array_count - 1];
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
static bool find_appended(io_xml *v, const io_cursor *c) {
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

static bool parse(io_xml *v, const io_cursor *c) {
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
static const uint8_t *fetch(io_xml *v, const source *s, size_t wanted) {
    if (wanted > s->size)
        return NULL;
    if (!s->base64)
        return s->bytes;
    uint8_t *out = io_alloc(v->r, wanted, 1);
    return out && decode_base64(s->bytes, s->size, out, wanted) == wanted ? out : NULL;
}

static uint64_t head_number(const io_xml *v, const uint8_t *head, size_t index) {
    return v->wide ? io_u64(head + 8 * index, v->big) : io_u32(head + 4 * index, v->big);
}

static bool fail_array(io_xml *v, const io_xml_array *a, const char *what) {
    return io_fail(v->r, "is damaged in its array '%.64s': %s; copy or write the file again",
                   a->name, what);
}

/* Compressed: number of blocks, size of a block, size of the last one (0 = full), then the
 * compressed sizes. */
static const uint8_t *unpack(io_xml *v, const io_xml_array *a, const source *s, size_t needed) {
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

static bool take_text(io_xml *v, const io_xml_array *a, size_t rows, io_view *out) {
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

bool io_xml_take(io_xml *v, const io_xml_array *a, size_t rows, io_view *out) {
    size_t stride = a->components * io_type_size(a->type), word = v->wide ? 8 : 4;
    memset(out, 0, sizeof *out);
    if (!rows)
        return true;
    if (a->encoding == IO_XML_ASCII)
        return take_text(v, a, rows, out);
    source s = {(const uint8_t *)a->text, a->size, true};
    if (a->encoding == IO_XML_APPENDED) {
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

const io_xml_array *io_xml_find(const io_xml *v, const io_xml_piece *p, io_xml_section in,
                                const char *name) {
    for (size_t i = p->first; i < p->last; i++)
        if (v->arrays[i].section == in && (!name || is(v->arrays[i].name, name)))
            return &v->arrays[i];
    return NULL;
}

bool io_xml_parse(io_reader *r, const io_cursor *bytes, const char *kind, const char *reads,
                  io_xml *out) {
    io_xml v;
    memset(&v, 0, sizeof v);
    v.r = r;
    v.kind = kind;
    v.reads = reads;
    v.image.spacing[0] = v.image.spacing[1] = v.image.spacing[2] = 1;
    v.image.direction[0] = v.image.direction[4] = v.image.direction[8] = 1;
    v.parser = XML_ParserCreate(NULL);
    if (!v.parser)
        return io_fail(r, "cannot be read: the XML parser got no memory");
    XML_SetUserData(v.parser, &v);
    XML_SetElementHandler(v.parser, on_begin, on_end);
    XML_SetCharacterDataHandler(v.parser, on_text);
    bool parsed = parse(&v, bytes);
    XML_ParserFree(v.parser);
    v.parser = NULL;
    *out = v;
    return parsed;
}
