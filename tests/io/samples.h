/* The same small line set in every format and encoding, made in memory: for tests and as seeds of
 * the fuzzer. */
#ifndef LINEAO_IO_SAMPLES_H
#define LINEAO_IO_SAMPLES_H

#include "io.h"

typedef struct buffer { /* zero = empty; buffer_free when done */
    uint8_t *data;
    size_t size, capacity;
    bool big; /* numbers are put big-endian */
} buffer;

void buffer_free(buffer *b);
void put(buffer *b, const void *data, size_t size);
void put_zeros(buffer *b, size_t size);
void put_text(buffer *b, const char *text);
void put_format(buffer *b, const char *format, ...);
void put_u8(buffer *b, unsigned value);
void put_u16(buffer *b, unsigned value);
void put_u32(buffer *b, uint32_t value);
void put_u64(buffer *b, uint64_t value);
void put_f32(buffer *b, double value);
void put_f64(buffer *b, double value);
void patch_u32(buffer *b, size_t at, uint32_t value);
void patch_f32(buffer *b, size_t at, double value);
void put_base64(buffer *b, const void *data, size_t size);
buffer gzip_of(const buffer *b);
buffer zlib_of(const buffer *b);

/* Three lines of 1, 2 and 5 points. Steps are whole 1/32 and at most 2, so that every encoding is
 * exact. */
enum { SAMPLE_LINES = 3, SAMPLE_POINTS = 8 };
extern const uint32_t sample_offsets[SAMPLE_LINES + 1];
double sample_position(size_t point, unsigned axis);
double sample_scalar(size_t point);                /* point attribute "s" */
double sample_vector(size_t point, unsigned axis); /* point attribute "v" */
double sample_weight(size_t line);                 /* line attribute "w" */

typedef struct sample {
    const char *name; /* with the extension of its format */
    buffer (*make)(void);
    bool attributes; /* it has s, v and w */
    bool groups;     /* it has the groups 0 = lines 0 and 2, 7 = line 1 */
} sample;
extern const sample samples[];
extern const size_t sample_count;
buffer make_sample(const char *name);

/* TRK with the given byte order and n_count; identity affine, half a voxel added. */
buffer make_trk(bool big, uint32_t count);
buffer make_tck(const char *datatype, bool big, bool wide);
buffer make_vtk(bool binary, bool modern);
/* A zip of the files, names and contents alternating. */
typedef struct zip_item {
    const char *name;
    buffer content;
} zip_item;
buffer make_zip(zip_item *items, size_t count, bool deflate); /* frees the contents */

/* Asserts (cmocka) that lines holds the sample. */
void assert_sample(const io_lines *lines, bool attributes, bool groups);
/* Reads memory, asserting success; the text of a failure is printed. */
io_lines must_read(const buffer *b, const char *name, const io_options *options);
/* Reads memory, asserting failure with a text that contains each word (NULL = any); out must stay
 * untouched. */
void must_fail(const buffer *b, const char *name, const io_options *options, const char *word);
bool has_warning(const io_lines *lines, const char *word);
const io_attribute *point_attribute(const io_lines *lines, const char *name);
const io_attribute *line_attribute(const io_lines *lines, const char *name);

#endif
