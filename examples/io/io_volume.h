/* Velocity volumes: reads NIfTI-1 and -2 (.nii), VTK ImageData (.vti), VTK STRUCTURED_POINTS
 * (.vtk), each also gzip-compressed, and HDF5 in the layout of 4DFlowNet (.h5).
 *
 *     const char *paths[] = {"flow.h5"};
 *     io_volume volume = {0};
 *     io_error error;
 *     if (!io_read_volume(paths, 1, NULL, &volume, NULL, &error))
 *         fprintf(stderr, "lineao: flow.h5: %s\n", error.text);
 *     ...
 *     io_volume_free(&volume);
 *
 * The content of a file decides its format. No file is trusted: every count is checked against the
 * bytes that are there, and the memory of a read is bounded by the size of its files. HDF5 files
 * are taken apart by libhdf5, whose own checks are the weaker ones. Does not print and does not
 * depend on the locale. Any thread may call any function on its own data, but only one may read
 * HDF5 or NIfTI at a time: their libraries keep state. */
#ifndef LINEAO_IO_VOLUME_H
#define LINEAO_IO_VOLUME_H

#include "io.h"

/* A grid of velocities over one heart cycle, or a steady one. All zero = nothing; valid for every
 * function here. */
typedef struct io_volume {
    /* "nifti", "vti", "vtk" or "hdf5": static text; NULL when all is zero */
    const char *format;
    uint32_t size[3];     /* voxels along x y z, each at least 1 */
    uint32_t frame_count; /* 1 = steady */
    double time_step;     /* ms between frames; 0 when steady */
    double period;        /* ms: frame_count * time_step; 0 when steady */
    /* mm: voxel centre (i, j, k) lies at to_mm * (i, j, k, 1); RAS where the format knows it;
     * invertible */
    double to_mm[3][4];
    /* owned; m/s along the axes of to_mm's mm; x y z of each voxel, x fastest, frames slowest:
     * 3 * size[0] * size[1] * size[2] * frame_count finite values */
    float *velocity;
    uint8_t *mask;        /* owned; 1 = inside, else 0, of each voxel; NULL = inside everywhere */
    uint64_t mask_voxels; /* those inside; without a mask all */
    double speed[2];      /* m/s; lowest and highest inside, over all frames; 0 0 when none is */
    uint32_t array_count;
    char **arrays; /* owned; names of the arrays in the first file */
    uint32_t warning_count;
    char **warnings; /* owned; plain sentences that do not name the file */
} io_volume;

/* All zero = as the files say. */
typedef struct io_volume_options {
    /* arrays, with commas between: "velocity", "velocity,mask", "u,v,w" or "u,v,w,mask"; NULL =
     * found by their shape and usual names */
    const char *names;
    const char *mask;      /* name of the array inside is told by (>= 0.5); NULL = the usual ones */
    const char *mask_file; /* a volume of the same size instead; NULL = none */
    /* of velocities: "m/s", "cm/s" or "mm/s"; NULL = m/s, for no format here tells it */
    const char *unit;
    double spacing[3];    /* mm, of voxels; 0 = the file's */
    double time_step;     /* ms between frames; 0 = the file's */
    double period;        /* ms, of all frames; 0 = from time_step */
    bool along_grid;      /* components run along the axes of the grid, not of the mm */
    bool guess;           /* voxels of 1 mm and frames of 1 ms, with a warning, where not told */
    io_progress progress; /* NULL = none */
    void *user;           /* handed to progress */
} io_volume_options;

/* Bytes in memory instead of a file. */
typedef struct io_source {
    const void *bytes;
    size_t size;
} io_source;

/* Reads a volume from one file; or from three files, one for each component, when each has a single
 * array of one component; or from several with velocities, whose frames then follow each other in
 * the order given. options may be NULL. On failure returns false, writes error, the index of the
 * file at fault to *failed (count: the mask file; NULL = not wanted), and leaves out untouched; on
 * success out is overwritten (free what it held before) and the caller owns it. */
bool io_read_volume(const char *const *paths, uint32_t count, const io_volume_options *options,
                    io_volume *out, uint32_t *failed, io_error *error);

/* The same from memory. */
bool io_read_volume_memory(const io_source *sources, uint32_t count,
                           const io_volume_options *options, io_volume *out, uint32_t *failed,
                           io_error *error);

/* Does the file begin like a volume? False also for what cannot be read, and for pipes. */
bool io_is_volume(const char *path);

/* Frees what volume owns and zeroes it. Harmless on zeroed or NULL volumes. */
void io_volume_free(io_volume *volume);

#endif
