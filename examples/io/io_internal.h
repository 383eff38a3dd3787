/* What the readers and writers of examples/io share: memory of one read, bounds-checked bytes,
 * typed views, and the builder that turns points and arrays into io_lines. Private to examples/io.
 *
 * One read = one io_reader. Everything a read allocates hangs on it and is freed together at its
 * end, so that a format's code returns false as soon as something is wrong, and never frees. */
#ifndef LINEAO_IO_INTERNAL_H
#define LINEAO_IO_INTERNAL_H

#include "io_read.h"

#include <stdio.h>

#if defined(__GNUC__)
#define IO_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define IO_PRINTF(text, first)
#endif

/* ---- Text and bytes -------------------------------------------------------------------------- */

typedef struct io_text { /* not terminated, not owned */
    const char *at;
    size_t size;
} io_text;

typedef struct io_cursor { /* at <= size always */
    const uint8_t *bytes;
    size_t size;
    size_t at;
} io_cursor;

io_text io_text_of(const char *string);
bool io_text_is(io_text text, const char *word); /* letter case does not matter, ASCII */
bool io_text_starts(io_text text, const char *word);
io_text io_text_trim(io_text text); /* without blanks, line ends and NULs at both ends */

/* The next count bytes; NULL, with the cursor unmoved, when fewer are left. */
const uint8_t *io_take(io_cursor *cursor, size_t count);
/* The rest of the line without its end ("\n" or "\r\n"), moving behind it; false at the end of the
 * bytes. */
bool io_take_line(io_cursor *cursor, io_text *line);
/* The next run of non-blank characters, leaving the cursor right behind it; false when there is
 * none. */
bool io_take_word(io_cursor *cursor, io_text *word);
/* 1-based line number of a position, for messages. */
size_t io_line_number(const io_cursor *cursor, size_t at);

/* Numbers as text, in any locale: decimal, "nan", "inf", "1.#QNAN", "1e-45". False unless the whole
 * text is one. */
bool io_parse_real(io_text text, double *value);
bool io_parse_size(io_text text, size_t *value);

/* ---- Typed views of arrays in a file --------------------------------------------------------- */

typedef enum io_type {
    IO_NONE,
    IO_I8,
    IO_U8,
    IO_I16,
    IO_U16,
    IO_I32,
    IO_U32,
    IO_I64,
    IO_U64,
    IO_F16,
    IO_F32,
    IO_F64
} io_type;

/* count rows of components values each; row i begins at bytes + i * stride. All rows lie inside the
 * bytes of the file. */
typedef struct io_view {
    const uint8_t *bytes;
    size_t count, stride;
    uint32_t components;
    io_type type;
    bool big; /* big-endian */
} io_view;

enum { IO_MAX_COMPONENTS = 64 };

/* Names of VTK, VTP, TRX and TCK ("unsigned_char", "Float32", "int64"); IO_NONE when unknown. */
io_type io_type_named(io_text name);
size_t io_type_size(io_type type);
uint16_t io_u16(const uint8_t *bytes, bool big);
uint32_t io_u32(const uint8_t *bytes, bool big);
uint64_t io_u64(const uint8_t *bytes, bool big);
float io_f32(const uint8_t *bytes, bool big);
double io_view_real(const io_view *view, size_t row, uint32_t component);
/* The value as an index; false when it is negative, broken or beyond size_t. */
bool io_view_index(const io_view *view, size_t row, size_t *value);
/* A view of doubles in memory. */
io_view io_view_doubles(const double *values, size_t count, uint32_t components);

/* ---- One read -------------------------------------------------------------------------------- */

typedef struct io_block io_block;

typedef struct io_column { /* an attribute that grows */
    char *name;
    uint32_t components;
    float *data;
    size_t rows, capacity; /* capacity in floats */
} io_column;

typedef struct io_columns {
    io_column *items;
    size_t count, capacity;
} io_columns;

typedef struct io_bundle {
    char *name;
    uint32_t *lines; /* numbers of lines in the file */
    size_t count, capacity;
} io_bundle;

typedef struct io_graph io_graph;     /* io_graph.h: a vessel tree being read */
typedef struct io_surface io_surface; /* io_surface.h: a mesh being read */

typedef struct io_reader {
    const io_options *options; /* never NULL */
    io_error *error;
    unsigned wanted; /* kinds of content (io_read.h) to look for; never 0 */
    unsigned found;  /* kinds that are there; readers of one kind leave it alone */
    io_graph *graph;
    io_surface *surface;
    io_block *blocks;
    size_t allocated, limit; /* bytes */
    uint64_t step;           /* of progress: 0 unpacking, 1 reading, 2 finishing */

    double *points;       /* x y z */
    uint32_t *point_rows; /* the row of each point in the file's arrays */
    size_t point_count, point_capacity;
    uint32_t *line_ends;
    uint32_t *line_rows;
    size_t line_count, line_capacity;
    size_t batch_points, batch_lines; /* where the current batch (VTP piece) begins */
    size_t line_row_base;             /* added to the line rows of the current batch */
    io_columns point_columns, line_columns;
    io_bundle *bundles;
    size_t bundle_count, bundle_capacity;
    char **warnings;
    size_t warning_count, warning_capacity;
    size_t dropped_points, empty_lines;
} io_reader;

/* options may be NULL. The memory of the read is limited as if its file were huge. */
void io_begin(io_reader *reader, const io_options *options, io_error *error);
/* Limits the memory of the read by the size of its files. */
void io_set_limit(io_reader *reader, size_t size);
void io_reader_free(io_reader *reader);

/* Both write the error text and are false, so that a reader may `return io_fail(...)`. */
bool io_error_set(io_error *error, const char *format, ...) IO_PRINTF(2, 3);
#define io_fail(reader, ...) (io_error_set((reader)->error, __VA_ARGS__) && false)
/* Adds a warning; false when memory is short. */
bool io_warn(io_reader *reader, const char *format, ...) IO_PRINTF(2, 3);
/* Reports progress; false when the user cancels. */
bool io_tick(io_reader *reader, size_t done, size_t total);

/* Zeroed memory for count items, freed with the reader; NULL (error written) when the read's limit
 * is passed. */
void *io_alloc(io_reader *reader, size_t count, size_t size);
/* Room for needed items in an array from io_alloc, at least doubling it; the old array stays valid
 * when NULL. */
void *io_grow(io_reader *reader, void *array, size_t *capacity, size_t needed, size_t size);
/* A terminated copy that is fit for messages: control characters and broken UTF-8 become '?'. NULL
 * = no memory. */
char *io_copy_text(io_reader *reader, io_text text);

bool io_read_file(io_reader *reader, const char *path, io_cursor *out);
bool io_is_gzip(const io_cursor *bytes);
bool io_gunzip(io_reader *reader, io_cursor *bytes);
/* Inflates one zlib stream into exactly size bytes at out. */
bool io_inflate(const uint8_t *bytes, size_t count, uint8_t *out, size_t size);

/* ---- Builder --------------------------------------------------------------------------------- */

/* Adds a point to the line being built; row is its place in the file's point arrays. Points that
 * are not finite are dropped and counted. False when memory is short. */
bool io_add_point(io_reader *reader, const double position[3], size_t row);
/* Ends the line; row is its number in the file. done of total is for progress. Lines without points
 * vanish. */
bool io_end_line(io_reader *reader, size_t row, size_t done, size_t total);
/* Gives every point or line of the batch its values from a view, by row. Views with too few rows or
 * too many components are left out with a warning. */
bool io_attach_points(io_reader *reader, io_text name, const io_view *view);
bool io_attach_lines(io_reader *reader, io_text name, const io_view *view);
/* The same for any columns: rows[i] - base is the row of item i in the view, for the items begin ..
 * end - 1; rows NULL: i itself. what: "point", for messages. */
bool io_attach_rows(io_reader *reader, io_columns *columns, io_text name, const io_view *view,
                    const uint32_t *rows, size_t begin, size_t end, size_t base, const char *what);
/* Begins the next batch (piece of a file): rows count from 0 again. */
void io_next_batch(io_reader *reader);
/* Puts a line (by its row) into a group; the group is made at first use. */
io_bundle *io_add_bundle(io_reader *reader, io_text name);
bool io_bundle_add(io_reader *reader, io_bundle *bundle, uint32_t row);
/* Memory of a result, which outlives the reader: zeroed, for free(), not NULL for a zero count.
 * NULL: error written. */
void *io_take_memory(io_reader *reader, size_t count, size_t size);
char *io_take_text(io_reader *reader, const char *text);
/* The warnings for a result; *count counts what is to be freed, also on failure. */
bool io_take_warnings(io_reader *reader, char ***warnings, uint32_t *count);
/* Filters, centres and hands the lines over. */
bool io_finish(io_reader *reader, const char *format, io_lines *out);

/* Columns for a result, of that many rows. */
bool io_take_columns(io_reader *reader, const io_columns *columns, size_t rows, uint32_t *count,
                     io_attribute **out);
void io_free_attributes(io_attribute *attributes, uint32_t count);
void io_free_warnings(char **warnings, uint32_t count);
/* What is taken off coordinates with these bounds before they become floats (io_lines.origin). */
void io_find_origin(const double bounds[2][3], double origin[3]);
/* Are these coordinates that can be worked with? */
bool io_is_position(const double position[3]);

/* Cells of a VTK data set: counted = the numbers n i0 .. in-1 follow each other in `index`;
 * otherwise cell i has the indices from ends[i - 1] (0 for the first) up to ends[i]. */
typedef struct io_cells {
    size_t count;
    io_view index, ends;
    bool counted;
} io_cells;
/* The range of indices of the next cell, begin = *at .. end - 1; *at moves behind it. number: of
 * the cell, what: "line", for messages. */
bool io_next_cell(io_reader *reader, const io_cells *cells, size_t number, const char *what,
                  size_t *at, size_t *begin, size_t *end);
/* Adds each cell as a line; first_row is the number of the first cell among all cells. */
bool io_add_cells(io_reader *reader, const io_view *points, const io_cells *cells,
                  size_t first_row);

/* One piece of VTK's PolyData. Its cells count in the order vertices, lines, polygons, strips. */
typedef struct io_array {
    io_text name;
    io_view values;
    bool of_points; /* else of cells */
} io_array;

typedef struct io_piece {
    io_view points;
    size_t vertex_cells;
    io_cells lines, polygons, strips;
    const io_array *arrays;
    size_t array_count;
} io_piece;
/* Builds what is wanted from the pieces and says what was found. */
bool io_build_pieces(io_reader *reader, const io_piece *pieces, size_t count);

/* ---- Formats --------------------------------------------------------------------------------- */

typedef enum io_match { IO_NO, IO_MAYBE, IO_YES } io_match;

io_match io_sniff_trk(const io_cursor *bytes);
io_match io_sniff_tck(const io_cursor *bytes);
io_match io_sniff_trx(const io_cursor *bytes);
io_match io_sniff_tt(const io_cursor *bytes);
io_match io_sniff_vtk(const io_cursor *bytes);
io_match io_sniff_vtp(const io_cursor *bytes);
io_match io_sniff_swc(const io_cursor *bytes);
io_match io_sniff_gxl(const io_cursor *bytes);
io_match io_sniff_vmv(const io_cursor *bytes);
io_match io_sniff_h5(const io_cursor *bytes);
io_match io_sniff_stl(const io_cursor *bytes);
io_match io_sniff_ply(const io_cursor *bytes);
io_match io_sniff_obj(const io_cursor *bytes);

bool io_read_trk(io_reader *reader, io_cursor *bytes);
bool io_read_tck(io_reader *reader, io_cursor *bytes);
bool io_read_trx(io_reader *reader, io_cursor *bytes);
bool io_read_trx_folder(io_reader *reader, const char *path);
bool io_read_tt(io_reader *reader, io_cursor *bytes);
bool io_read_vtk(io_reader *reader, io_cursor *bytes);
bool io_read_vtp(io_reader *reader, io_cursor *bytes);
bool io_read_swc(io_reader *reader, io_cursor *bytes);
bool io_read_gxl(io_reader *reader, io_cursor *bytes);
bool io_read_vmv(io_reader *reader, io_cursor *bytes);
bool io_read_h5(io_reader *reader, io_cursor *bytes);
bool io_read_stl(io_reader *reader, io_cursor *bytes);
bool io_read_ply(io_reader *reader, io_cursor *bytes);
bool io_read_obj(io_reader *reader, io_cursor *bytes);

/* Writers put the whole file into an open stream; the caller checks the stream for errors. */
bool io_write_trk(FILE *file, const io_lines *lines, io_error *error);
bool io_write_tck(FILE *file, const io_lines *lines, io_error *error);
bool io_write_vtp(FILE *file, const io_lines *lines, io_error *error);
void io_put_u32(FILE *file, uint32_t value); /* little-endian */
void io_put_u64(FILE *file, uint64_t value);
void io_put_f32(FILE *file, double value);
void io_put_f64(FILE *file, double value);
double io_position(const io_lines *lines, size_t point, unsigned axis); /* absolute */

#endif
