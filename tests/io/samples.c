/* See samples.h. */
#include "samples.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zip.h>
#include <zlib.h>

/* ---- Bytes ----------------------------------------------------------------------------------- */

static void *must(void *memory) {
    if (!memory)
        abort();
    return memory;
}

void buffer_free(buffer *b) {
    free(b->data);
    memset(b, 0, sizeof *b);
}

void put(buffer *b, const void *data, size_t size) {
    if (!b->data || b->capacity < b->size + size + 1) {
        b->capacity = 2 * (b->size + size + 1);
        b->data = must(realloc(b->data, b->capacity));
    }
    if (size && data)
        memcpy(b->data + b->size, data, size);
    b->size += size;
}

void put_zeros(buffer *b, size_t size) {
    while (size--)
        put_u8(b, 0);
}

void put_text(buffer *b, const char *text) {
    put(b, text, strlen(text));
}

void put_format(buffer *b, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    put_text(b, text);
}

void put_u8(buffer *b, unsigned value) {
    uint8_t byte = (uint8_t)value;
    put(b, &byte, 1);
}

static void put_bytes(buffer *b, uint64_t value, unsigned size) {
    for (unsigned i = 0; i < size; i++)
        put_u8(b, (unsigned)(value >> 8 * (b->big ? size - 1 - i : i) & 255));
}

void put_u16(buffer *b, unsigned value) {
    put_bytes(b, value, 2);
}
void put_u32(buffer *b, uint32_t value) {
    put_bytes(b, value, 4);
}
void put_u64(buffer *b, uint64_t value) {
    put_bytes(b, value, 8);
}

void put_f32(buffer *b, double value) {
    float narrow = (float)value;
    uint32_t bits;
    memcpy(&bits, &narrow, 4);
    put_u32(b, bits);
}

void put_f64(buffer *b, double value) {
    uint64_t bits;
    memcpy(&bits, &value, 8);
    put_u64(b, bits);
}

void patch_u32(buffer *b, size_t at, uint32_t value) {
    buffer four = {NULL, 0, 0, b->big};
    put_u32(&four, value);
    memcpy(b->data + at, four.data, 4);
    buffer_free(&four);
}

void patch_f32(buffer *b, size_t at, double value) {
    float narrow = (float)value;
    uint32_t bits;
    memcpy(&bits, &narrow, 4);
    patch_u32(b, at, bits);
}

void put_base64(buffer *b, const void *data, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const uint8_t *from = data;
    for (size_t i = 0; from && i < size; i += 3) {
        size_t left = size - i;
        uint32_t bits = (uint32_t)from[i] << 16 | (left > 1 ? (uint32_t)from[i + 1] << 8 : 0) |
                        (left > 2 ? from[i + 2] : 0);
        for (unsigned k = 0; k < 4; k++)
            put_u8(b, k <= left ? (unsigned)digits[bits >> (18 - 6 * k) & 63] : '=');
    }
}

static buffer deflated(const buffer *b, int window) {
    z_stream stream;
    buffer out = {0};
    memset(&stream, 0, sizeof stream);
    if (deflateInit2(&stream, 9, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        abort();
    out.capacity = deflateBound(&stream, b->size) + 64;
    out.data = must(malloc(out.capacity));
    stream.next_in = b->data;
    stream.avail_in = (uInt)b->size;
    stream.next_out = out.data;
    stream.avail_out = (uInt)out.capacity;
    if (deflate(&stream, Z_FINISH) != Z_STREAM_END)
        abort();
    out.size = stream.total_out;
    deflateEnd(&stream);
    return out;
}

buffer gzip_of(const buffer *b) {
    return deflated(b, 15 + 16);
}
buffer zlib_of(const buffer *b) {
    return deflated(b, 15);
}

/* ---- Content --------------------------------------------------------------------------------- */

const uint32_t sample_offsets[SAMPLE_LINES + 1] = {0, 1, 3, 8};

double sample_position(size_t point, unsigned axis) {
    double i = (double)point;
    return axis == 0 ? i - 2 : axis == 1 ? 3 - 0.5 * i : 0.25 * i * (point % 2 ? 1 : 0.5);
}

double sample_scalar(size_t point) {
    return 0.5 * (double)point - 1;
}
double sample_vector(size_t point, unsigned axis) {
    return (double)point + 0.25 * axis;
}
double sample_weight(size_t line) {
    return 10 - 2.5 * (double)line;
}

/* ---- TRK, TCK, TT ---------------------------------------------------------------------------- */

static void put_name(buffer *b, const char *name, char components) {
    size_t begin = b->size;
    put_text(b, name);
    if (components) {
        put_u8(b, 0);
        put_u8(b, (unsigned)components);
    }
    put_zeros(b, 20 - (b->size - begin));
}

static void put_trk_head(buffer *b, uint32_t count) {
    put_text(b, "TRACK");
    put_u8(b, 0);
    for (int i = 0; i < 3; i++)
        put_u16(b, 10);
    for (int i = 0; i < 3; i++)
        put_f32(b, 1);
    put_zeros(b, 12);
    put_u16(b, 4);
    put_name(b, "s   ", 0); /* MATLAB pads with blanks */
    put_name(b, "v", '3');
    put_zeros(b, 160);
    put_u16(b, 1);
    put_name(b, "w", 0);
    put_zeros(b, 180);
    for (int i = 0; i < 16; i++)
        put_f32(b, i % 5 == 0);
    put_zeros(b, 444);
    put_text(b, "RAS");
    put_zeros(b, 988 - 951);
    put_u32(b, count);
    put_u32(b, 2);
    put_u32(b, 1000);
}

buffer make_trk(bool big, uint32_t count) {
    buffer b = {NULL, 0, 0, big};
    put_trk_head(&b, count);
    for (size_t i = 0; i < SAMPLE_LINES; i++) {
        put_u32(&b, sample_offsets[i + 1] - sample_offsets[i]);
        for (size_t k = sample_offsets[i]; k < sample_offsets[i + 1]; k++) {
            for (unsigned axis = 0; axis < 3; axis++)
                put_f32(&b, sample_position(k, axis) + 0.5);
            put_f32(&b, sample_scalar(k));
            for (unsigned axis = 0; axis < 3; axis++)
                put_f32(&b, sample_vector(k, axis));
        }
        put_f32(&b, sample_weight(i));
    }
    return b;
}

buffer make_tck(const char *datatype, bool big, bool wide) {
    buffer b = {NULL, 0, 0, big};
    void (*put_real)(buffer *, double) = wide ? put_f64 : put_f32;
    put_format(&b,
               "mrtrix tracks\ncount: 3\ndatatype: %s\ncount: 3\ncommand_history: a\n"
               "command_history: b\nfile: . 120\nEND\n",
               datatype);
    while (b.size < 120)
        put_u8(&b, '\n');
    for (size_t i = 0; i < SAMPLE_LINES; i++) {
        for (size_t k = sample_offsets[i]; k < sample_offsets[i + 1]; k++)
            for (unsigned axis = 0; axis < 3; axis++)
                put_real(&b, sample_position(k, axis));
        for (int k = 0; k < 3; k++)
            put_real(&b, NAN);
    }
    for (int k = 0; k < 3; k++)
        put_real(&b, INFINITY);
    return b;
}

static void put_matrix(buffer *b, unsigned type, uint32_t rows, uint32_t columns,
                       const char *name) {
    put_u32(b, type);
    put_u32(b, rows);
    put_u32(b, columns);
    put_u32(b, 0);
    put_u32(b, (uint32_t)strlen(name) + 1);
    put(b, name, strlen(name) + 1);
}

static buffer make_tt(void) {
    buffer b = {0}, track = {0};
    const double matrix[16] = {-1, 0, 0, 4, 0, -1, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1};
    put_matrix(&b, 10, 1, 16, "trans_to_mni");
    for (int i = 0; i < 16; i++)
        put_f32(&b, matrix[i]);
    put_matrix(&b, 40, 1, SAMPLE_LINES, "cluster");
    for (int i = 0; i < SAMPLE_LINES; i++)
        put_u16(&b, i == 1 ? 7 : 0);
    for (size_t i = 0; i < SAMPLE_LINES; i++) {
        double last[3] = {0, 0, 0};
        put_u32(&track, 3 * (sample_offsets[i + 1] - sample_offsets[i]));
        for (size_t k = sample_offsets[i]; k < sample_offsets[i + 1]; k++)
            for (size_t axis = 0; axis < 3; axis++) {
                double voxel = 32 * (matrix[5 * axis] *
                                     (sample_position(k, (unsigned)axis) - matrix[4 * axis + 3]));
                if (k == sample_offsets[i])
                    put_u32(&track, (uint32_t)(int32_t)voxel);
                else
                    put_u8(&track, (unsigned)(int)(voxel - last[axis]) & 255);
                last[axis] = voxel;
            }
    }
    put_matrix(&b, 50, 1, (uint32_t)track.size, "track");
    put(&b, track.data, track.size);
    buffer_free(&track);
    return b;
}

/* ---- TRX ------------------------------------------------------------------------------------- */

buffer make_zip(zip_item *items, size_t count, bool deflate) {
    zip_source_t *target = must(zip_source_buffer_create(NULL, 0, 0, NULL));
    zip_t *zip = must(zip_open_from_source(target, ZIP_TRUNCATE, NULL));
    zip_source_keep(target);
    for (size_t i = 0; i < count; i++) {
        zip_source_t *content =
            must(zip_source_buffer(zip, items[i].content.data, items[i].content.size, 0));
        zip_int64_t index = zip_file_add(zip, items[i].name, content, 0);
        if (index < 0) { /* a name twice, or one that is no text: the fuzzer's */
            zip_source_free(content);
            continue;
        }
        zip_uint64_t at = (zip_uint64_t)index;
        zip_set_file_compression(zip, at, deflate ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 9);
        zip_file_set_mtime(zip, at, 1000000000, 0); /* the same bytes at any time */
    }
    if (zip_close(zip))
        abort();
    buffer out = {0};
    uint8_t part[512];
    bool open = !zip_source_open(target); /* not when there are no entries */
    for (zip_int64_t got; open && (got = zip_source_read(target, part, sizeof part)) > 0;)
        put(&out, part, (size_t)got);
    if (open)
        zip_source_close(target);
    zip_source_free(target);
    for (size_t i = 0; i < count; i++)
        buffer_free(&items[i].content);
    return out;
}

static unsigned half(double value) { /* of small numbers that a half holds exactly */
    int exponent;
    double mantissa = frexp(fabs(value), &exponent);
    unsigned sign = value < 0 ? 0x8000 : 0;
    return value == 0
               ? 0
               : sign | (unsigned)(exponent + 14) << 10 | ((unsigned)(mantissa * 2048) & 1023);
}

enum { HEAD, POSITIONS, OFFSETS, SCALARS, VECTORS, WEIGHTS, GROUP_0, GROUP_7, ITEMS };

static buffer make_trx(bool old) {
    zip_item items[ITEMS] = {{"header.json", {0}},
                             {old ? "positions.3.float16" : "positions.3.float32", {0}},
                             {old ? "offsets.uint64" : "offsets.int64", {0}},
                             {"dpv/s.float32", {0}},
                             {"dpv/v.3.float64", {0}},
                             {"dps/w.float16", {0}},
                             {"groups/0.uint32", {0}},
                             {"groups/7.int8", {0}}};
    put_format(&items[HEAD].content,
               "{\"DIMENSIONS\":[1,1,1],\"NB_VERTICES\":%d,\"NB_STREAMLINES\":%d}", SAMPLE_POINTS,
               SAMPLE_LINES);
    for (size_t k = 0; k < SAMPLE_POINTS; k++) {
        for (unsigned axis = 0; axis < 3; axis++) {
            if (old)
                put_u16(&items[POSITIONS].content, half(sample_position(k, axis)));
            else
                put_f32(&items[POSITIONS].content, sample_position(k, axis));
            put_f64(&items[VECTORS].content, sample_vector(k, axis));
        }
        put_f32(&items[SCALARS].content, sample_scalar(k));
    }
    for (size_t i = 0; i < SAMPLE_LINES + (old ? 0 : 1); i++)
        put_u64(&items[OFFSETS].content, sample_offsets[i]);
    for (size_t i = 0; i < SAMPLE_LINES; i++)
        put_u16(&items[WEIGHTS].content, half(sample_weight(i)));
    put_u32(&items[GROUP_0].content, 0);
    put_u32(&items[GROUP_0].content, 2);
    put_u8(&items[GROUP_7].content, 1);
    return make_zip(items, ITEMS, old);
}

static buffer make_trx_new(void) {
    return make_trx(false);
}
static buffer make_trx_old(void) {
    return make_trx(true);
}

/* ---- VTK legacy ------------------------------------------------------------------------------ */

/* One value as text or big-endian. */
static void vtk_real(buffer *b, bool binary, bool wide, double value) {
    if (!binary)
        put_format(b, "%.9g ", value);
    else if (wide)
        put_f64(b, value);
    else
        put_f32(b, value);
}

static void vtk_int(buffer *b, bool binary, bool wide, uint64_t value) {
    if (!binary)
        put_format(b, "%llu\n", (unsigned long long)value);
    else if (wide)
        put_u64(b, value);
    else
        put_u32(b, (uint32_t)value);
}

static void vtk_lines(buffer *b, bool binary, bool modern) {
    if (modern)
        put_text(b, "\nLINES 4 8\nOFFSETS vtktypeint64\n");
    else
        put_text(b, "\nLINES 3 11\n");
    for (size_t i = 0; modern && i <= SAMPLE_LINES; i++)
        vtk_int(b, binary, true, sample_offsets[i]);
    if (modern)
        put_text(b, "\nCONNECTIVITY vtktypeint64\n");
    for (size_t i = 0; i < SAMPLE_LINES; i++) {
        if (!modern)
            vtk_int(b, binary, false, sample_offsets[i + 1] - sample_offsets[i]);
        for (uint64_t k = sample_offsets[i]; k < sample_offsets[i + 1]; k++)
            vtk_int(b, binary, modern, SAMPLE_POINTS - 1 - k); /* points are stored backwards */
    }
}

buffer make_vtk(bool binary, bool modern) {
    buffer b = {NULL, 0, 0, true};
    put_format(&b, "# vtk DataFile Version %s\ntitle\n%s\nDATASET POLYDATA\n",
               modern ? "5.1" : "3.0", binary ? "BINARY" : "ASCII");
    if (modern)
        put_text(&b, "FIELD FieldData 1\nnote 1 1 string\n"),
            put_text(&b, binary ? "\xC2hi\n" : "hi\n");
    put_format(&b, "POINTS 8 %s\n", modern ? "double" : "float");
    for (size_t k = SAMPLE_POINTS; k--;)
        for (unsigned axis = 0; axis < 3; axis++)
            vtk_real(&b, binary, modern, sample_position(k, axis));
    put_text(&b,
             "\nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 1 2\n\n");
    put_text(&b, "VERTICES 1 2\n");
    vtk_int(&b, binary, false, 1);
    vtk_int(&b, binary, false, 0);
    vtk_lines(&b, binary, modern);
    put_text(&b, "\nCELL_DATA 4\nSCALARS w float\nLOOKUP_TABLE default\n");
    vtk_real(&b, binary, false, 99); /* of the vertex */
    for (size_t i = 0; i < SAMPLE_LINES; i++)
        vtk_real(&b, binary, false, sample_weight(i));
    put_text(&b, "\nPOINT_DATA 8\nVECTORS v float\n");
    for (size_t k = SAMPLE_POINTS; k--;)
        for (unsigned axis = 0; axis < 3; axis++)
            vtk_real(&b, binary, false, sample_vector(k, axis));
    put_text(&b, "\nFIELD FieldData 1\ns 1 8 double\n");
    for (size_t k = SAMPLE_POINTS; k--;)
        vtk_real(&b, binary, true, sample_scalar(k));
    put_text(&b, "\n");
    return b;
}

static buffer make_vtk_ascii(void) {
    return make_vtk(false, false);
}
static buffer make_vtk_ascii_modern(void) {
    return make_vtk(false, true);
}
static buffer make_vtk_binary(void) {
    return make_vtk(true, false);
}
static buffer make_vtk_modern(void) {
    return make_vtk(true, true);
}

/* ---- VTP ---------------------------------------------------------------------------------------
 */

typedef struct vtp_style {
    const char *format; /* of the DataArray tags */
    bool zlib, base64, big, wide;
    int pieces;
} vtp_style;

/* Header and content in VTK's way; two blocks when compressed, the last one shorter. */
static void put_block(buffer *out, const buffer *content, const vtp_style *style) {
    buffer head = {NULL, 0, 0, style->big}, body = {0};
    void (*put_size)(buffer *, uint64_t) = put_u64;
    size_t full = content->size / 2 + 1;
    if (style->zlib) {
        buffer parts[2] = {{content->data, full, 0, false},
                           {content->data + full, content->size - full, 0, false}};
        buffer packed[2] = {zlib_of(&parts[0]), zlib_of(&parts[1])};
        uint64_t numbers[5] = {2, full, content->size - full, packed[0].size, packed[1].size};
        for (int i = 0; i < 5; i++)
            style->wide ? put_size(&head, numbers[i]) : put_u32(&head, (uint32_t)numbers[i]);
        for (int i = 0; i < 2; i++) {
            put(&body, packed[i].data, packed[i].size);
            buffer_free(&packed[i]);
        }
    } else {
        style->wide ? put_size(&head, content->size) : put_u32(&head, (uint32_t)content->size);
        put(&body, content->data, content->size);
    }
    void (*put_raw)(buffer *, const void *, size_t) = style->base64 ? put_base64 : put;
    put_raw(out, head.data, head.size);
    put_raw(out, body.data, body.size);
    buffer_free(&head);
    buffer_free(&body);
}

static void put_array(buffer *xml, buffer *appended, const vtp_style *style, const char *type,
                      const char *name, unsigned components, buffer *content, const char *text) {
    put_format(xml, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%u\" format=\"%s\" ",
               type, name, components, style->format);
    if (!strcmp(style->format, "appended")) {
        put_format(xml, "offset=\"%u\"/>\n", (unsigned)appended->size);
        put_block(appended, content, style);
    } else {
        put_text(xml, ">\n<InformationKey name=\"L2_NORM\" location=\"vtkDataArray\">12 "
                      "34</InformationKey>\n");
        if (!strcmp(style->format, "ascii"))
            put_text(xml, text);
        else
            put_block(xml, content, style);
        put_text(xml, "\n</DataArray>\n");
    }
    buffer_free(content);
}

static void put_reals(buffer *xml, buffer *appended, const vtp_style *style, const char *name,
                      unsigned components, size_t first, size_t last,
                      double (*value)(size_t row, unsigned component)) {
    buffer content = {NULL, 0, 0, style->big}, text = {0};
    for (size_t i = first; i < last; i++)
        for (unsigned k = 0; k < components; k++) {
            put_f32(&content, value(i, k));
            put_format(&text, "%.9g ", value(i, k));
        }
    put_u8(&text, 0);
    put_array(xml, appended, style, "Float32", name, components, &content, (char *)text.data);
    buffer_free(&text);
}

static double scalar_of(size_t row, unsigned k) {
    return k ? NAN : sample_scalar(row);
}
static double weight_of(size_t row, unsigned k) {
    return k ? NAN : sample_weight(row);
}

static void put_piece(buffer *xml, buffer *appended, const vtp_style *style, size_t first,
                      size_t last) {
    size_t begin = sample_offsets[first], end = sample_offsets[last];
    put_format(
        xml,
        "<Piece NumberOfPoints=\"%u\" NumberOfVerts=\"0\" NumberOfLines=\"%u\">\n<PointData>\n",
        (unsigned)(end - begin), (unsigned)(last - first));
    put_reals(xml, appended, style, "s", 1, begin, end, scalar_of);
    put_reals(xml, appended, style, "v", 3, begin, end, sample_vector);
    put_text(xml, "</PointData>\n<CellData>\n");
    put_reals(xml, appended, style, "w", 1, first, last, weight_of);
    put_text(xml, "</CellData>\n<Points>\n");
    put_reals(xml, appended, style, "Points", 3, begin, end, sample_position);
    buffer indices = {NULL, 0, 0, style->big}, ends = indices, text = {0}, more = {0};
    for (size_t k = begin; k < end; k++) {
        put_u64(&indices, k - begin);
        put_format(&text, "%u ", (unsigned)(k - begin));
    }
    for (size_t i = first; i < last; i++) {
        put_u32(&ends, sample_offsets[i + 1] - (uint32_t)begin);
        put_format(&more, "%u ", (unsigned)(sample_offsets[i + 1] - begin));
    }
    put_u8(&text, 0);
    put_u8(&more, 0);
    put_text(xml, "</Points>\n<Lines>\n");
    put_array(xml, appended, style, "UInt64", "connectivity", 1, &indices, (char *)text.data);
    put_array(xml, appended, style, "Int32", "offsets", 1, &ends, (char *)more.data);
    put_text(xml, "</Lines>\n</Piece>\n");
    buffer_free(&text);
    buffer_free(&more);
}

enum { ZLIB = 1, BASE64 = 2, BIG = 4, WIDE = 8 };

static buffer make_vtp(const char *format, unsigned flags, int pieces) {
    const vtp_style style = {
        format, (flags & ZLIB) != 0, (flags & BASE64) != 0, (flags & BIG) != 0, (flags & WIDE) != 0,
        pieces};
    buffer xml = {0}, appended = {0};
    put_format(&xml,
               "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
               "byte_order=\"%sEndian\"%s%s>\n"
               "<PolyData>\n",
               style.big ? "Big" : "Little", style.wide ? " header_type=\"UInt64\"" : "",
               style.zlib ? " compressor=\"vtkZLibDataCompressor\"" : "");
    put_piece(&xml, &appended, &style, 0, style.pieces > 1 ? 2 : 3);
    if (style.pieces > 1)
        put_piece(&xml, &appended, &style, 2, 3);
    put_text(&xml, "</PolyData>\n");
    if (appended.size) {
        put_format(&xml, "<AppendedData encoding=\"%s\">\n _", style.base64 ? "base64" : "raw");
        put(&xml, appended.data, appended.size);
        put_text(&xml, "\n</AppendedData>\n");
    }
    put_text(&xml, "</VTKFile>\n");
    buffer_free(&appended);
    return xml;
}

static buffer make_vtp_ascii(void) {
    return make_vtp("ascii", 0, 1);
}
static buffer make_vtp_inline(void) {
    return make_vtp("binary", BASE64, 1);
}
static buffer make_vtp_zlib(void) {
    return make_vtp("binary", ZLIB | BASE64 | WIDE, 1);
}
static buffer make_vtp_raw(void) {
    return make_vtp("appended", WIDE, 1);
}
static buffer make_vtp_raw_zlib(void) {
    return make_vtp("appended", ZLIB, 1);
}
static buffer make_vtp_base64(void) {
    return make_vtp("appended", ZLIB | BASE64, 1);
}
static buffer make_vtp_big(void) {
    return make_vtp("appended", BIG, 1);
}
static buffer make_vtp_pieces(void) {
    return make_vtp("binary", ZLIB | BASE64 | BIG, 2);
}

/* ---- All ------------------------------------------------------------------------------------- */

static buffer make_trk_little(void) {
    return make_trk(false, SAMPLE_LINES);
}
static buffer make_trk_big(void) {
    return make_trk(true, 0);
}
static buffer make_tck_little(void) {
    return make_tck("Float32LE", false, false);
}
static buffer make_tck_big(void) {
    return make_tck("Float32BE", true, false);
}
static buffer make_tck_wide(void) {
    return make_tck("Float64LE", false, true);
}
static buffer make_tck_wide_big(void) {
    return make_tck("Float64BE", true, true);
}

/* Two gzip members, as pigz and cat make them. */
static buffer make_gzip(void) {
    buffer whole = make_trk_little(), out = {0};
    buffer parts[2] = {{whole.data, 700, 0, false}, {whole.data + 700, whole.size - 700, 0, false}};
    for (int i = 0; i < 2; i++) {
        buffer packed = gzip_of(&parts[i]);
        put(&out, packed.data, packed.size);
        buffer_free(&packed);
    }
    buffer_free(&whole);
    return out;
}

const sample samples[] = {
    {"little.trk", make_trk_little, true, false},
    {"big.trk", make_trk_big, true, false},
    {"members.trk.gz", make_gzip, true, false},
    {"little.tck", make_tck_little, false, false},
    {"big.tck", make_tck_big, false, false},
    {"wide.tck", make_tck_wide, false, false},
    {"wide_big.tck", make_tck_wide_big, false, false},
    {"clusters.tt", make_tt, false, true},
    {"new.trx", make_trx_new, true, true},
    {"old.trx", make_trx_old, true, true},
    {"ascii.vtk", make_vtk_ascii, true, false},
    {"ascii_modern.vtk", make_vtk_ascii_modern, true, false},
    {"binary.vtk", make_vtk_binary, true, false},
    {"modern.vtk", make_vtk_modern, true, false},
    {"ascii.vtp", make_vtp_ascii, true, false},
    {"inline.vtp", make_vtp_inline, true, false},
    {"zlib.vtp", make_vtp_zlib, true, false},
    {"raw.vtp", make_vtp_raw, true, false},
    {"raw_zlib.vtp", make_vtp_raw_zlib, true, false},
    {"base64.vtp", make_vtp_base64, true, false},
    {"big.vtp", make_vtp_big, true, false},
    {"pieces.vtp", make_vtp_pieces, true, false},
};
const size_t sample_count = sizeof samples / sizeof samples[0];

buffer make_sample(const char *name) {
    for (size_t i = 0; i < sample_count; i++)
        if (!strcmp(samples[i].name, name))
            return samples[i].make();
    abort();
}
