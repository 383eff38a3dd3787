#include "backdrop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- look ------------------------------------------------------------------------------- */

static bool is_zero(const double rgb[3]) {
    return rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0;
}

static backdrop_look filled(const backdrop_look *look, uint32_t height) {
    static const backdrop_look light = {
        {0.957, 0.957, 0.949}, {0.76, 0.775, 0.80}, {0, 0}, 0, {0.2, 0.2, 0.22}};
    backdrop_look f = light;
    if (look) {
        if (!is_zero(look->low) || !is_zero(look->high)) {
            memcpy(f.low, look->low, sizeof f.low);
            memcpy(f.high, look->high, sizeof f.high);
        }
        if (!is_zero(look->line))
            memcpy(f.line, look->line, sizeof f.line);
        memcpy(f.range, look->range, sizeof f.range);
        f.line_width = look->line_width;
    }
    if (!(f.line_width > 0))
        f.line_width = height > 600 ? height / 400.0 : 1.5;
    return f;
}

/* ---- layer ------------------------------------------------------------------------------ */

static void find_range(const float *intensity, size_t count, double range[2]) {
    if (range[0] != range[1])
        return;
    range[0] = range[1] = 0;
    for (size_t i = 0; i < count; i++) {
        if (isfinite(intensity[i]) && intensity[i] > range[1])
            range[1] = intensity[i];
    }
}

bool backdrop_layer(const float *intensity, uint32_t width, uint32_t height,
                    const backdrop_look *look, picture *out) {
    backdrop_look f = filled(look, height);
    picture layer;
    if (!picture_make(width, height, &layer))
        return false;
    size_t count = (size_t)width * height;
    find_range(intensity, count, f.range);
    for (size_t i = 0; i < count; i++) {
        double at = (intensity[i] - f.range[0]) / (f.range[1] - f.range[0]);
        at = at > 0 ? at < 1 ? at : 1 : 0; /* NaN too */
        for (int k = 0; k < 3; k++) {
            double v = f.low[k] + at * (f.high[k] - f.low[k]);
            layer.pixels[4 * i + (size_t)k] = (uint8_t)(255 * fmin(fmax(v, 0), 1) + 0.5);
        }
        layer.pixels[4 * i + 3] = 255;
    }
    *out = layer;
    return true;
}

/* ---- outline ---------------------------------------------------------------------------- */

/* Squared distance to the nearest zero along a row of n squared distances, with a stride: the lower
 * envelope of parabolas (Felzenszwalb and Huttenlocher 2012). room: n places, 2 n + 1 numbers. */
static void transform(float *row, size_t n, size_t stride, size_t *place, double *number) {
    double *value = number, *from = number + n;
    size_t top = 0;
    for (size_t i = 0; i < n; i++)
        value[i] = row[i * stride];
    place[0] = 0;
    from[0] = -INFINITY;
    from[1] = INFINITY;
    for (size_t i = 1; i < n; i++) {
        double x = (double)i, cross;
        for (;;) {
            double p = (double)place[top];
            cross = (value[i] + x * x - (value[place[top]] + p * p)) / (2 * (x - p));
            if (cross > from[top]) /* at the latest for the first, which begins at -infinity */
                break;
            top--;
        }
        place[++top] = i;
        from[top] = cross;
        from[top + 1] = INFINITY;
    }
    for (size_t i = 0, k = 0; i < n; i++) {
        while (from[k + 1] < (double)i)
            k++;
        double d = (double)i - (double)place[k];
        row[i * stride] = (float)(d * d + value[place[k]]);
    }
}

/* Distance of every pixel to the nearest one whose coverage is (not) at least a half. */
static bool distances(const float *coverage, uint32_t width, uint32_t height, bool covered,
                      float *out) {
    size_t longest = width > height ? width : height;
    size_t *place = calloc(longest, sizeof *place);
    double *number = calloc(2 * longest + 1, sizeof *number);
    for (size_t i = 0; place && number && i < (size_t)width * height; i++)
        out[i] = (coverage[i] >= 0.5f) == covered ? 0 : 1e12f;
    for (size_t x = 0; place && number && x < width; x++)
        transform(out + x, height, width, place, number);
    for (size_t y = 0; place && number && y < height; y++)
        transform(out + y * width, width, 1, place, number);
    bool ok = place && number;
    free(place);
    free(number);
    return ok;
}

bool backdrop_outline(const float *coverage, uint32_t width, uint32_t height, double line_width,
                      float *opacity) {
    size_t count = (size_t)width * height;
    float *inside = malloc(count * sizeof *inside); /* how far inside */
    bool ok = inside && distances(coverage, width, height, false, inside) &&
              distances(coverage, width, height, true, opacity);
    for (size_t i = 0; ok && i < count; i++) {
        /* the border lies half a pixel before the nearest pixel of the other kind */
        double d = sqrt((double)(coverage[i] >= 0.5f ? inside[i] : opacity[i])) - 0.5;
        opacity[i] = (float)fmin(fmax(0.5 * line_width + 0.5 - d, 0), 1);
    }
    free(inside);
    return ok;
}

/* ---- composition ------------------------------------------------------------------------ */

bool backdrop_compose(picture *lines, const float *intensity, const float *coverage,
                      const backdrop_look *look) {
    backdrop_look f = filled(look, lines->height);
    picture whole = {0, 0, NULL};
    size_t count = (size_t)lines->width * lines->height;
    float *opacity = coverage ? malloc(count * sizeof *opacity) : NULL;
    bool ok = (opacity || !coverage) &&
              (intensity ? backdrop_layer(intensity, lines->width, lines->height, &f, &whole)
                         : picture_make(lines->width, lines->height, &whole)) &&
              (!coverage ||
               backdrop_outline(coverage, lines->width, lines->height, f.line_width, opacity));
    if (ok) {
        picture_over(&whole, 0, 0, lines);
        for (size_t i = 0; coverage && i < count; i++) {
            if (opacity[i] > 0)
                picture_blend(&whole, (int64_t)(i % whole.width), (int64_t)(i / whole.width),
                              f.line, opacity[i]);
        }
        picture_free(lines);
        *lines = whole;
    } else {
        picture_free(&whole);
    }
    free(opacity);
    return ok;
}
