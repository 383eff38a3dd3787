/* What stands behind and around lines in pictures of vessels (Koehler et al. 2017, 2.2; METHODS
 * 11.4, 16): a light projection of the volume first, then the lines, the vessel's outline last.
 *
 * Projections are plain floats of view size, tightly packed, top row first: what a maximum
 * intensity projection along the camera's rays gives.
 * Thread: all functions are free of shared state. */
#ifndef LINEAO_BACKDROP_H
#define LINEAO_BACKDROP_H

#include "picture.h"

/* All zero: recommended. */
typedef struct backdrop_look {
    double low[3], high[3]; /* colours of no and of full intensity; both zero: light greys */
    double range[2];        /* intensities of `low` and `high`; equal: 0 and the largest there is */
    double line_width; /* of the outline, pixels; 0: 1/400 of the picture's height, at least 1.5 */
    double line[3];    /* colour of the outline; zero: dark grey (black: 1/255) */
} backdrop_look;

/* Paints an intensity projection. NaN and what lies below the range is `low`. False: out of memory,
 * *out is then untouched. */
bool backdrop_layer(const float *intensity, uint32_t width, uint32_t height,
                    const backdrop_look *look, picture *out);

/* Opacity in [0, 1] of the outline of what is covered (>= 0.5; NaN is not covered): a band of
 * line_width around the border between covered and uncovered pixels, half of it on each side, with
 * a ramp of one pixel at its rims. The picture's rim is no border. `opacity` receives width *
 * height floats. False: out of memory. */
bool backdrop_outline(const float *coverage, uint32_t width, uint32_t height, double line_width,
                      float *opacity);

/* A triangle mesh to be projected: clip = to_clip * (position, 1), column-major, depth from 0 at
 * the near plane to w at the far one, y up. */
typedef struct backdrop_mesh {
    uint32_t triangle_count;
    const float *positions;    /* 3 per vertex */
    const uint32_t *triangles; /* 3 vertices each */
    double to_clip[16];
} backdrop_mesh;
/* Raises to `value` what is less in pixels whose centre a triangle covers; what lies before the
 * near plane is cut off. image: width * height floats. */
void backdrop_cover(const backdrop_mesh *mesh, uint32_t width, uint32_t height, float value,
                    float *image);

/* Lays the lines over the backdrop and draws the outline on top: `lines` is a picture with a
 * transparent background and becomes the whole. intensity or coverage may be NULL: no backdrop, no
 * outline. False: out of memory, *lines is then untouched. */
bool backdrop_compose(picture *lines, const float *intensity, const float *coverage,
                      const backdrop_look *look);

#endif
