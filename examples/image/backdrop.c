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

/* ---- meshes ----------------------------------------------------------------------------- */

enum { CORNERS = 4 }; /* of a triangle that a plane has cut */

/* Clip coordinates of a vertex: x, y, depth, w. */
static void clip_of(const backdrop_mesh *mesh, uint32_t vertex, double clip[4]) {
    const float *p = mesh->positions + 3 * (size_t)vertex;
    for (int k = 0; k < 4; k++) {
        const double *m = mesh->to_clip + k;
        clip[k] = m[0] * (double)p[0] + m[4] * (double)p[1] + m[8] * (double)p[2] + m[12];
    }
}

/* The part of a triangle behind the near plane, in pixels. Returns how many corners it has. */
static int cut(double corners[3][4], uint32_t width, uint32_t height, double out[CORNERS][2]) {
    int count = 0;
    for (int i = 0; i < 3; i++) {
        const double *a = corners[i], *b = corners[(i + 1) % 3];
        double ends[2] = {0, a[2] / (a[2] - b[2])}; /* a itself, and where the edge is cut */
        for (int k = 0; k < 2; k++) {
            if (k == 0 ? !(a[2] > 0) : (a[2] > 0) == (b[2] > 0))
                continue;
            double c[4];
            for (int j = 0; j < 4; j++)
                c[j] = a[j] + ends[k] * (b[j] - a[j]);
            out[count][0] = (0.5 + 0.5 * c[0] / c[3]) * width;
            out[count++][1] = (0.5 - 0.5 * c[1] / c[3]) * height;
        }
    }
    return count;
}

/* Where the polygon's border crosses a row: least and greatest x. */
static void cross(double corners[CORNERS][2], int count, double y, double range[2]) {
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int i = 0; i < count; i++) {
        const double *a = corners[i], *b = corners[(i + 1) % count];
        if ((a[1] <= y) == (b[1] <= y))
            continue;
        double x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        range[0] = fmin(range[0], x);
        range[1] = fmax(range[1], x);
    }
}

/* The first pixel whose centre is at or behind x, from 0 to count. */
static uint32_t first_pixel(double x, uint32_t count) {
    double pixel = ceil(x - 0.5);
    return pixel > 0 ? pixel < count ? (uint32_t)pixel : count : 0; /* NaN: 0 */
}

void backdrop_cover(const backdrop_mesh *mesh, uint32_t width, uint32_t height, float value,
                    float *image) {
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double clip[3][4], corners[CORNERS][2], low = INFINITY, high = -INFINITY, range[2];
        for (int k = 0; k < 3; k++)
            clip_of(mesh, mesh->triangles[3 * (size_t)t + (size_t)k], clip[k]);
        int count = cut(clip, width, height, corners);
        for (int i = 0; i < count; i++) {
            low = fmin(low, corners[i][1]);
            high = fmax(high, corners[i][1]);
        }
        for (uint32_t y = first_pixel(low, height); y < first_pixel(high, height); y++) {
            cross(corners, count, y + 0.5, range);
            for (uint32_t x = first_pixel(range[0], width); x < first_pixel(range[1], width); x++)
                image[(size_t)y * width + x] = fmaxf(image[(size_t)y * width + x], value);
        }
    }
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
