/* The same small velocity volume in every format and encoding, made in memory: for tests and as
 * seeds of the fuzzer. */
#ifndef LINEAO_VOLUME_SAMPLES_H
#define LINEAO_VOLUME_SAMPLES_H

#include "io_volume.h"
#include "samples.h"

/* 4 x 3 x 2 voxels, one or two frames. All values are whole 1/64, so that every encoding is exact.
 */
enum { SIZE_X = 4, SIZE_Y = 3, SIZE_Z = 2, VOXELS = SIZE_X * SIZE_Y * SIZE_Z };
enum { MOST_FILES = 3 };
extern const double sample_spacing[3], sample_origin[3]; /* mm */
extern const double sample_step;                         /* ms */
/* m/s; voxel counts x fastest */
double sample_velocity(size_t voxel, unsigned component, unsigned frame);
bool sample_inside(size_t voxel);

typedef struct volume_sample {
    const char *name;
    void (*make)(buffer files[MOST_FILES]);
    uint32_t files, frames;
    bool mask;  /* it has one */
    bool timed; /* it tells the time step; else it must be given */
    bool hdf5;
} volume_sample;
extern const volume_sample volume_samples[];
extern const size_t volume_sample_count;

/* Reads files from memory with the options that the sample needs; options may be NULL. */
bool read_sample(const buffer *files, uint32_t count, const io_volume_options *options,
                 io_volume *out, uint32_t *failed, io_error *error);
void free_files(buffer files[MOST_FILES]);

/* ---- Parts that tests vary ------------------------------------------------------------------- */

typedef enum nifti_layout { FIFTH_AXIS, FOURTH_AXIS, ONE_COMPONENT } nifti_layout;

typedef struct nifti {
    int version; /* 1 or 2 */
    bool big;
    int type;     /* NIfTI's code: 4, 16 or 64 */
    double slope; /* 0 = none */
    unsigned frames;
    nifti_layout layout;
    unsigned component; /* of ONE_COMPONENT */
    bool qform;         /* orientation by the quaternion instead of the matrix */
} nifti;
buffer make_nifti(nifti what);
/* Writes a header field, by its offsets in version 1 and 2. */
void patch_bytes(buffer *b, size_t at, uint64_t bits, unsigned size);

typedef enum vti_encoding {
    VTI_ASCII,
    VTI_INLINE,
    VTI_INLINE_ZLIB,
    VTI_RAW,
    VTI_RAW_ZLIB,
    VTI_BASE64
} vti_encoding;
/* head: attributes of ImageData; NULL = the sample's. */
buffer make_vti(vti_encoding encoding, bool big, bool wide, unsigned frame, const char *head);
buffer make_points(bool binary);

typedef struct hdf5_spec {
    bool chunked, doubles, matlab, vector, mask, dx, cycle;
    unsigned frames;
} hdf5_spec;
buffer make_hdf5(hdf5_spec what);

#endif
