/* Image files of the example programs: 8-bit PNG for the eye, 32-bit float OpenEXR for numbers.
 *
 * Every function returns false on failure and then writes one line "FILE: what is wrong" to
 * `error` (which may be NULL); out-parameters stay untouched. A file appears under its name only
 * when it is complete: writers fill "NAME.PID-K.tmp" next to it and rename it at the end.
 * Thread: all functions are free of shared state. */
#ifndef LINEAO_IMAGE_H
#define LINEAO_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

enum { IMAGE_ERROR_SIZE = 256 };

/* Writes width x height pixels of `channels` bytes (3 = RGB, 4 = RGBA, not premultiplied, sRGB),
 * tightly packed, top row first. */
bool image_write_png(const char *path, uint32_t width, uint32_t height, const uint8_t *pixels,
                     int channels, char error[IMAGE_ERROR_SIZE]);

/* Reads any PNG as `channels` (3 or 4) bytes per pixel, top row first; *pixels is for free(). */
bool image_read_png(const char *path, int channels, uint32_t *width, uint32_t *height,
                    uint8_t **pixels, char error[IMAGE_ERROR_SIZE]);

/* One channel, "color.R": width * height floats of its part, top row first. */
typedef struct image_channel {
    const char *name;
    const float *data;
} image_channel;

/* One image of an OpenEXR file. A file of several parts needs a different name for each. */
typedef struct image_part {
    const char *name; /* may be NULL when there is one part */
    uint32_t width, height;
    uint32_t channel_count;
    const image_channel *channels; /* any order; the file holds them sorted by name */
} image_part;

/* Writes parts as ZIP-compressed scan lines of 32-bit floats: a plain single-part file for one
 * part, else a multi-part file. All parts share the display window of the first; the data window
 * of each is its own size. `attribute` (may be NULL) becomes the string attribute "lineao" of
 * every part. Values, NaN and infinity too, come back bit by bit. */
bool image_write_exr(const char *path, const image_part *parts, uint32_t part_count,
                     const char *attribute, char error[IMAGE_ERROR_SIZE]);

/* What image_read_exr gives back; image_exr_free releases it. */
typedef struct image_exr {
    uint32_t part_count;
    image_part *parts; /* names never NULL; channels sorted by name */
    char *attribute;   /* "lineao" of the first part, NULL when absent */
} image_exr;

/* Reads a scan-line file whose channels are all 32-bit float and not subsampled. */
bool image_read_exr(const char *path, image_exr *out, char error[IMAGE_ERROR_SIZE]);

/* Releases and zeroes; fine on {0}. */
void image_exr_free(image_exr *image);

/* The channel of that name in any part ("ao.V"), or NULL; *part (may be NULL) gets its part. */
const float *image_exr_channel(const image_exr *image, const char *name, const image_part **part);

#endif
