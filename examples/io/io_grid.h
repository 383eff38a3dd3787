/* One volume file as its format's reader hands it over: a grid and named arrays on it, which are
 * decoded when they are wanted. Private to examples/io. */
#ifndef LINEAO_IO_GRID_H
#define LINEAO_IO_GRID_H

#include "io_internal.h"
#include "io_volume.h"

/* An array with a value, or a vector, for every voxel and frame. Once loaded, the value at voxel
 * x y z, component c, frame f is intercept + slope * the number of `type` at
 * bytes + x * stride[0] + y * stride[1] + z * stride[2] + c * stride[3] + f * stride[4];
 * all of them lie inside the memory of the reader. */
typedef struct io_field {
    const char *name;
    uint32_t components, frames; /* at least 1 */
    io_type type;
    bool big;
    const uint8_t *bytes; /* NULL = not loaded */
    size_t stride[5];
    double slope, intercept;
    const void *place; /* of the format's reader: where it finds the array */
} io_field;

typedef struct io_grid io_grid;
struct io_grid {
    const char *format;
    uint32_t size[3];   /* at least 1 each; their product is at most io_grid_voxels */
    double to_mm[3][4]; /* invertible; voxels of 1 mm when has_spacing is false */
    bool has_spacing;
    double time_step;    /* ms; 0 = not told */
    const char *vectors; /* name of the array that the file calls its vectors, or NULL */
    io_field *fields;
    size_t field_count, field_capacity;
    /* loads one field; NULL: all are loaded */
    bool (*load)(io_reader *reader, io_grid *grid, io_field *field);
    void (*close)(io_grid *grid); /* NULL = nothing to close */
    void *file;                   /* of the format's reader */
};

/* A new field, zero but for its name and one component, frame and slope; NULL when memory is short.
 */
io_field *io_add_field(io_reader *reader, io_grid *grid, io_text name);
/* Checks and sets the size: each at least 1, and the product times 12 bytes within the memory of
 * this read. */
bool io_grid_size(io_reader *reader, io_grid *grid, const uint64_t size[3]);
size_t io_grid_voxels(const io_grid *grid);
/* Strides of values whose x is fastest, then y, z, and whose components are neighbours. */
void io_field_packed(io_field *field, const io_grid *grid);

io_match io_sniff_nifti(const io_cursor *bytes);
io_match io_sniff_vti(const io_cursor *bytes);
io_match io_sniff_points(const io_cursor *bytes);

/* Each begins with a zeroed grid whose to_mm is the identity. */
bool io_open_nifti(io_reader *reader, io_cursor *bytes, io_grid *grid);
bool io_open_vti(io_reader *reader, io_cursor *bytes, io_grid *grid);
bool io_open_points(io_reader *reader, io_cursor *bytes, io_grid *grid);
bool io_open_hdf5(io_reader *reader, io_cursor *bytes, io_grid *grid);

#endif
