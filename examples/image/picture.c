#include "picture.h"

#include <stdlib.h>
#include <string.h>

bool picture_make(uint32_t width, uint32_t height, picture *out) {
    if (width == 0 || height == 0 || width > SIZE_MAX / 4 / height)
        return false;
    out->width = width;
    out->height = height;
    out->pixels = calloc((size_t)width * height, 4);
    return out->pixels != NULL;
}

void picture_free(picture *p) {
    free(p->pixels);
    memset(p, 0, sizeof *p);
}

/* Over, for one pixel whose colour is in bytes: c = (a top + b (1 - a) below) / alpha. */
static void over(uint8_t *below, const double top[3], double a) {
    double b = below[3] / 255.0 * (1 - a), alpha = a + b;
    for (int k = 0; k < 3 && alpha > 0; k++)
        below[k] = (uint8_t)((a * top[k] + b * below[k]) / alpha + 0.5);
    below[3] = (uint8_t)(255 * alpha + 0.5);
}

void picture_blend(picture *p, int64_t x, int64_t y, const double rgb[3], double coverage) {
    picture_fill(p, x, y, 1, 1, rgb, coverage);
}

/* [*from, *from + *count) cut to [0, size). */
static void cut(int64_t *from, int64_t *count, uint32_t size) {
    int64_t end = *from + *count;
    *from = *from < 0 ? 0 : *from;
    end = end > size ? size : end;
    *count = end > *from ? end - *from : 0;
}

void picture_fill(picture *p, int64_t x, int64_t y, int64_t width, int64_t height,
                  const double rgb[3], double coverage) {
    double a = coverage > 0 ? coverage < 1 ? coverage : 1 : 0, top[3];
    for (int k = 0; k < 3; k++)
        top[k] = 255 * (rgb[k] > 0 ? rgb[k] < 1 ? rgb[k] : 1 : 0);
    cut(&x, &width, p->width);
    cut(&y, &height, p->height);
    for (int64_t j = y; j < y + height; j++) {
        for (int64_t i = x; i < x + width; i++)
            over(p->pixels + 4 * ((size_t)j * p->width + (size_t)i), top, a);
    }
}

void picture_over(picture *p, int64_t x, int64_t y, const picture *top) {
    int64_t left = x, upper = y, width = top->width, height = top->height;
    cut(&left, &width, p->width);
    cut(&upper, &height, p->height);
    for (int64_t j = upper; j < upper + height; j++) {
        const uint8_t *from = top->pixels + 4 * ((size_t)(j - y) * top->width + (size_t)(left - x));
        uint8_t *to = p->pixels + 4 * ((size_t)j * p->width + (size_t)left);
        for (int64_t i = 0; i < width; i++, from += 4, to += 4) {
            const double rgb[3] = {from[0], from[1], from[2]};
            over(to, rgb, from[3] / 255.0);
        }
    }
}

double picture_luma(const picture *p, int64_t x, int64_t y, int64_t width, int64_t height,
                    double paper) {
    double sum = 0;
    cut(&x, &width, p->width);
    cut(&y, &height, p->height);
    for (int64_t j = y; j < y + height; j++) {
        for (int64_t i = x; i < x + width; i++) {
            const uint8_t *c = p->pixels + 4 * ((size_t)j * p->width + (size_t)i);
            double luma = (0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]) / 255;
            sum += paper + (luma - paper) * c[3] / 255;
        }
    }
    return width > 0 && height > 0 ? sum / (double)(width * height) : paper;
}
