/* Line files: reads .trk .tck .trx .tt .vtk .vtp .obj, each also gzip-compressed; writes .tck .trk
 * .vtp. Vessel trees: io_tree.h; meshes: io_mesh.h; whatever a file holds: io_read.h.
 *
 *     io_lines lines = {0};
 *     io_error error;
 *     if (!io_read_lines("bundle.trk", NULL, &lines, &error))
 *         fprintf(stderr, "lineao: bundle.trk: %s\n", error.text);
 *     ...
 *     io_lines_free(&lines);
 *
 * The content of a file decides its format; its name only where the content leaves a doubt. No file
 * is trusted: every count is checked against the bytes that are there, and the memory of a read is
 * bounded by the size of its file. Does not print, does not depend on the locale, keeps no state:
 * any thread may call any function on its own data. */
#ifndef LINEAO_IO_H
#define LINEAO_IO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One named array with a row for every point, or for every line. */
typedef struct io_attribute {
    char *name;          /* owned; UTF-8 without control characters; not always unique */
    uint32_t components; /* values per row, [1, 64] */
    float *data;         /* owned; rows * components values in the file's unit; NaN = not told */
} io_attribute;

/* A named set of lines (a bundle): a TRX group or a TT cluster. A line may be in several groups, or
 * in none. */
typedef struct io_group {
    char *name;          /* owned; a TT cluster is named by its index: "3" */
    uint32_t line_count; /* at least 1 */
    uint32_t *lines;     /* owned; line_count indices, each below io_lines.line_count */
} io_group;

/* Lines with at least one point each, in the order of the file. All zero = no lines; valid for
 * every function here. */
typedef struct io_lines {
    /* "trk", "tck", "trx", "tt", "vtk", "vtp" or "obj": static text; NULL when all is zero */
    const char *format;
    /* "mm": static text. VTK files define no unit and are taken as mm */
    const char *unit;
    uint32_t line_count;
    uint32_t point_count;
    /* owned; line_count + 1 values: line i has the points offsets[i] .. offsets[i + 1] - 1 */
    uint32_t *offsets;
    /* owned; 3 * point_count values: x y z in mm minus origin, RAS where the format knows it */
    float *points;
    /* mm, whole numbers, 0 on each axis where the data is not far from zero: subtracted before
     * rounding to float, so that lines at z = -1100 keep their detail */
    double origin[3];
    /* mm; lowest and highest x y z, absolute (origin included); zero when point_count is 0 */
    double bounds[2][3];
    uint32_t point_attribute_count;
    io_attribute *point_attributes; /* owned; point_count rows each */
    uint32_t line_attribute_count;
    io_attribute *line_attributes; /* owned; line_count rows each */
    uint32_t group_count;
    io_group *groups; /* owned; those without a line are left out */
    uint32_t warning_count;
    char **warnings; /* owned; plain sentences that do not name the file */
} io_lines;

/* What is wrong, where (byte or line) and how to mend it; does not name the file. Written on
 * failure only. */
typedef struct io_error {
    char text[512];
} io_error;

/* Called now and then with done of total (the same total during one read). Returns true to cancel
 * the read. */
typedef bool (*io_progress)(void *user, uint64_t done, uint64_t total);

/* All zero = read everything. The filters (of lines) work in this order: bundle, min_length,
 * every. */
typedef struct io_options {
    uint32_t every;         /* keep each n-th line, from the first on; 0 and 1 = all */
    float min_length;       /* mm; drop lines shorter than this; 0 = none */
    const char *bundle;     /* keep this group only; NULL or "" = all; an unknown name fails */
    bool trk_no_half_voxel; /* TRK with whole voxel centres, as DSI Studio writes them */
    const char *unit;       /* of trees and meshes: "mm", "cm", "um", "nm" or "m"; NULL = as told or
                               guessed (io_tree.h, io_mesh.h); an unknown one fails */
    io_progress progress;   /* NULL = none */
    void *user;             /* handed to progress */
} io_options;

/* Reads a file, or a folder holding an unpacked TRX. options may be NULL. On failure returns false,
 * writes error and leaves out untouched; on success out is overwritten (free what it held before)
 * and the caller owns it. */
bool io_read_lines(const char *path, const io_options *options, io_lines *out, io_error *error);

/* The same from size bytes in memory. name_hint is a file name whose extension may break a tie;
 * NULL = none. */
bool io_read_lines_memory(const void *bytes, size_t size, const char *name_hint,
                          const io_options *options, io_lines *out, io_error *error);

/* Frees what lines owns and zeroes it. Harmless on zeroed or NULL lines. */
void io_lines_free(io_lines *lines);

/* Writes .tck, .trk or .vtp, as the extension of path says. VTP holds all attributes; TRK the first
 * ten of points and of lines with up to 9 components, names cut to 18 bytes; TCK none; groups and
 * warnings are not written. The file appears whole under its name, or not at all. */
bool io_write_lines(const char *path, const io_lines *lines, io_error *error);

#endif
