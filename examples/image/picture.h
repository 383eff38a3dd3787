/* Pictures in memory, for what is drawn on top of or behind a rendered one.
 *
 * Pixels are RGBA bytes, not premultiplied, sRGB, tightly packed, top row first, as image_write_png
 * takes them. Blending is done in display values, as lineao does it. Colours are in [0, 1].
 * Thread: all functions are free of shared state. */
#ifndef LINEAO_PICTURE_H
#define LINEAO_PICTURE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct picture {
    uint32_t width, height;
    uint8_t *pixels; /* owned, from malloc */
} picture;

/* A transparent picture. False: out of memory (or the size overflows), *out is then untouched. */
bool picture_make(uint32_t width, uint32_t height, picture *out);
/* Releases and zeroes; fine on {0}. */
void picture_free(picture *p);

/* Lays a colour over a pixel; coverage in [0, 1]. Outside the picture nothing happens. */
void picture_blend(picture *p, int64_t x, int64_t y, const double rgb[3], double coverage);
/* The same for a rectangle. */
void picture_fill(picture *p, int64_t x, int64_t y, int64_t width, int64_t height,
                  const double rgb[3], double coverage);
/* Lays `top` over `p` with its left upper corner at (x, y). */
void picture_over(picture *p, int64_t x, int64_t y, const picture *top);

/* Mean luma in [0, 1] of what of a rectangle lies inside; transparent pixels count as `paper`. */
double picture_luma(const picture *p, int64_t x, int64_t y, int64_t width, int64_t height,
                    double paper);

#endif
