/* Blending is the over operator, to half a byte; a backdrop is a light grey that darkens with the
 * intensity; an outline is a band of the asked width around the border of what is covered, by an
 * exact distance; lines hide the backdrop and the outline hides lines. */
#include "backdrop.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint32_t next(uint32_t *random) {
    *random = *random * 1664525u + 1013904223u;
    return *random >> 8;
}

/* ---- blending --------------------------------------------------------------------------- */

/* Premultiplied, in double precision. */
static void over_is_the_over_operator(void **state) {
    (void)state;
    uint32_t random = 3;
    picture below, top;
    assert_true(picture_make(1, 1, &below) && picture_make(1, 1, &top));
    for (int i = 0; i < 20000; i++) {
        uint8_t b[4], t[4];
        for (int k = 0; k < 4; k++) {
            uint32_t kind = next(&random) % 5;
            b[k] = kind == 0 ? 0 : kind == 1 ? 255 : (uint8_t)next(&random);
            kind = next(&random) % 5;
            t[k] = kind == 0 ? 0 : kind == 1 ? 255 : (uint8_t)next(&random);
        }
        memcpy(below.pixels, b, 4);
        memcpy(top.pixels, t, 4);
        picture_over(&below, 0, 0, &top);
        double a = t[3] / 255.0, rest = b[3] / 255.0 * (1 - a), alpha = a + rest;
        assert_true(fabs(below.pixels[3] - 255 * alpha) <= 0.5001);
        for (int k = 0; k < 3 && alpha > 0; k++)
            assert_true(fabs(below.pixels[k] - (a * t[k] + rest * b[k]) / alpha) <= 0.5001);
    }
    picture_free(&below);
    picture_free(&top);
}

static void drawing_is_cut_at_the_rim(void **state) {
    (void)state;
    const double red[3] = {1, 0, 0};
    picture p, top;
    assert_true(picture_make(5, 4, &p) && picture_make(3, 3, &top));
    picture_fill(&top, 0, 0, 3, 3, red, 1);
    picture_over(&p, -2, -2, &top); /* one pixel */
    picture_over(&p, 4, 3, &top);
    picture_over(&p, 5, 0, &top);
    picture_over(&p, -3, INT32_MAX, &top);
    picture_fill(&p, 2, -7, 1, 8, red, 1);
    picture_fill(&p, -9, 2, 5, 1, red, 1);
    picture_blend(&p, 5, 0, red, 1);
    picture_blend(&p, 0, -1, red, 1);
    for (uint32_t i = 0; i < 20; i++) {
        bool drawn = i == 0 || i == 19 || i == 2;
        assert_int_equal(p.pixels[4 * i + 3], drawn ? 255 : 0);
    }
    assert_true(fabs(picture_luma(&p, 0, 0, 1, 1, 1) - 0.2126) < 1e-6);
    assert_true(fabs(picture_luma(&p, -3, -3, 100, 100, 1) - (3 * 0.2126 + 17) / 20) < 1e-6);
    assert_true(picture_luma(&p, 9, 9, 2, 2, 0.5) == 0.5);
    picture_free(&p);
    picture_free(&top);
    assert_false(picture_make(0, 4, &p));
    assert_false(picture_make(UINT32_MAX, UINT32_MAX, &p));
}

/* ---- layer ------------------------------------------------------------------------------ */

static void layer_is_light_and_falls_with_intensity(void **state) {
    (void)state;
    const float intensity[8] = {0, 0.25f, 0.5f, 1, NAN, -3, -INFINITY, 0.75f};
    picture p;
    assert_true(backdrop_layer(intensity, 4, 2, NULL, &p));
    for (uint32_t i = 0; i < 8; i++) {
        assert_int_equal(p.pixels[4 * i + 3], 255);
        assert_true(p.pixels[4 * i] >= 180); /* lines must stand out */
    }
    assert_true(p.pixels[0] > p.pixels[4] && p.pixels[4] > p.pixels[8] &&
                p.pixels[8] > p.pixels[28] && p.pixels[28] > p.pixels[12]);
    for (uint32_t i = 4; i < 7; i++)
        assert_memory_equal(p.pixels + 4 * i, p.pixels, 4);
    picture_free(&p);
    backdrop_look look;
    memset(&look, 0, sizeof look);
    look.high[0] = 1;
    look.range[0] = 0.5;
    look.range[1] = 1;
    assert_true(backdrop_layer(intensity, 4, 2, &look, &p));
    const uint8_t red[8] = {0, 0, 0, 255, 0, 0, 0, 128};
    for (uint32_t i = 0; i < 8; i++)
        assert_int_equal(p.pixels[4 * i], red[i]);
    picture_free(&p);
    const float nothing[2] = {0, NAN};
    assert_true(backdrop_layer(nothing, 2, 1, NULL, &p));
    assert_memory_equal(p.pixels, p.pixels + 4, 4);
    picture_free(&p);
}

/* ---- outline ---------------------------------------------------------------------------- */

enum { W = 37, H = 29 };

/* Against the distance to every pixel of the other kind. */
static void outline_is_where_the_border_is_near(void **state) {
    (void)state;
    uint32_t random = 11;
    for (int trial = 0; trial < 40; trial++) {
        float coverage[W * H], opacity[W * H];
        double width = 1 + trial % 7;
        for (int i = 0; i < W * H; i++) {
            double x = i % W - 17.0, y = i / W - 12.0;
            coverage[i] = trial % 2 ? (next(&random) % 100 < 4 ? 1.0f : 0.0f)
                                    : (float)(8.3 - sqrt(x * x + y * y));
        }
        coverage[0] = NAN;
        assert_true(backdrop_outline(coverage, W, H, width, opacity));
        for (int i = 0; i < W * H; i++) {
            double nearest = INFINITY;
            for (int j = 0; j < W * H; j++) {
                double x = i % W - j % W, y = i / W - j / W;
                if ((coverage[i] >= 0.5f) != (coverage[j] >= 0.5f))
                    nearest = fmin(nearest, sqrt(x * x + y * y));
            }
            double want = fmin(fmax(0.5 * width + 0.5 - (nearest - 0.5), 0), 1);
            assert_true(fabs(opacity[i] - want) < 1e-5);
        }
    }
}

/* Area of the band = width times circumference. */
static void outline_has_the_asked_width(void **state) {
    (void)state;
    enum { N = 200 };
    float *coverage = malloc(N * N * sizeof *coverage), *opacity = malloc(N * N * sizeof *opacity);
    assert_true(coverage && opacity);
    for (int i = 0; i < N * N; i++)
        coverage[i] = hypot(i % N - 99.5, i / N - 99.5) < 70 ? 1.0f : 0.0f;
    for (int width = 2; width < 12; width += 3) {
        double sum = 0;
        assert_true(backdrop_outline(coverage, N, N, width, opacity));
        for (int i = 0; i < N * N; i++)
            sum += opacity[i];
        assert_true(fabs(sum / (2 * 3.14159265 * 70) - width) < 0.12 * width);
    }
    memset(coverage, 0, N * N * sizeof *coverage); /* nothing, and everything, have no border */
    for (int all = 0; all < 2; all++) {
        for (int i = 0; i < N * N; i++)
            coverage[i] = (float)all;
        assert_true(backdrop_outline(coverage, N, N, 4, opacity));
        for (int i = 0; i < N * N; i++)
            assert_true(opacity[i] == 0);
    }
    free(coverage);
    free(opacity);
}

/* ---- composition ------------------------------------------------------------------------ */

static void lines_lie_between_backdrop_and_outline(void **state) {
    (void)state;
    const double blue[3] = {0, 0, 1};
    float intensity[W * H], coverage[W * H], opacity[W * H];
    picture p, bare;
    for (int i = 0; i < W * H; i++) {
        coverage[i] = i % W >= 10 ? 1.0f : 0.0f;
        intensity[i] = (float)(i % W);
    }
    assert_true(picture_make(W, H, &p));
    picture_fill(&p, 5, 5, 20, 10, blue, 1);
    assert_true(backdrop_compose(&p, intensity, coverage, NULL));
    assert_true(backdrop_layer(intensity, W, H, NULL, &bare));
    assert_true(backdrop_outline(coverage, W, H, 1, opacity));
    for (int i = 0; i < W * H; i++) {
        const uint8_t *c = p.pixels + 4 * i;
        bool line = i % W >= 5 && i % W < 25 && i / W >= 5 && i / W < 15;
        assert_int_equal(c[3], 255);
        static const uint8_t drawn[4] = {0, 0, 255, 255};
        if (opacity[i] == 0)
            assert_memory_equal(c, line ? drawn : bare.pixels + 4 * i, 4);
        else if (opacity[i] == 1)
            assert_true(c[0] < 80 && c[1] < 80 && c[2] < 80);
    }
    picture_free(&p);
    picture_free(&bare);
}

static void parts_may_be_absent(void **state) {
    (void)state;
    const double blue[3] = {0, 0, 1};
    float coverage[4] = {1, 1, 0, 0};
    picture p;
    assert_true(picture_make(2, 2, &p));
    picture_fill(&p, 0, 0, 1, 1, blue, 0.5);
    assert_true(backdrop_compose(&p, NULL, NULL, NULL));
    assert_int_equal(p.pixels[3], 128);
    assert_int_equal(p.pixels[7], 0);
    assert_true(backdrop_compose(&p, NULL, coverage, NULL));
    assert_true(p.pixels[7] > 0);
    picture_free(&p);
}

/* Barycentric coordinates and depth -z of where the ray (x, y, -1) meets a triangle. False: beside.
 */
static bool meets(const float *p, double x, double y, double *least, double *depth) {
    const double d[3] = {x, y, -1};
    double e[2][3], n[3], dot = 0, at = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        e[0][k] = (double)p[3 + k] - (double)p[k];
        e[1][k] = (double)p[6 + k] - (double)p[k];
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = e[0][i] * e[1][j] - e[0][j] * e[1][i];
        dot += n[k] * d[k];
        at += n[k] * (double)p[k];
    }
    *depth = at / dot;
    *least = INFINITY;
    for (int c = 0; c < 3; c++) { /* the areas that the point cuts off */
        double a[3], b[3], area = 0, all = 0;
        for (int k = 0; k < 3; k++) {
            a[k] = (double)p[3 * ((c + 1) % 3) + k] - *depth * d[k];
            b[k] = (double)p[3 * ((c + 2) % 3) + k] - *depth * d[k];
            all += n[k] * n[k];
        }
        for (int k = 0; k < 3; k++)
            area += n[k] * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
        sum += area / all;
        *least = fmin(*least, area / all);
    }
    return fabs(sum - 1) < 1e-9 && *least > 0;
}

/* A mesh covers the pixels whose ray meets it behind the near plane. */
static void cover_is_what_rays_meet(void **state) {
    static const uint32_t corners[3] = {0, 1, 2};
    uint32_t random = 77, covered = 0, cut = 0;
    (void)state;
    for (int round = 0; round < 400; round++) {
        float p[9], image[W * H];
        backdrop_mesh mesh = {1, p, corners, {0}};
        mesh.to_clip[0] = mesh.to_clip[5] = 1; /* near 1, far 10 */
        mesh.to_clip[10] = -10.0 / 9;
        mesh.to_clip[14] = -10.0 / 9;
        mesh.to_clip[11] = -1;
        for (int i = 0; i < 9; i++)
            p[i] = (float)(next(&random) % 2000) / 500 - (i % 3 == 2 ? 4 : 2);
        memset(image, 0, sizeof image);
        image[5] = 9;
        backdrop_cover(&mesh, W, H, 0.5f, image);
        assert_true(image[5] == 9);
        for (int i = 0; i < W * H; i++) {
            double x = 2 * (i % W + 0.5) / W - 1, y = 1 - 2 * (i / W + 0.5) / H, least, depth;
            bool met = meets(p, x, y, &least, &depth);
            if (fabs(least) < 1e-6 || fabs(depth - 1) < 1e-6 || i == 5)
                continue;
            cut += met && depth < 1;
            met = met && depth > 1;
            covered += met;
            assert_true((image[i] == 0.5f) == met);
        }
    }
    assert_true(covered > 5000 && cut > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(over_is_the_over_operator),
        cmocka_unit_test(drawing_is_cut_at_the_rim),
        cmocka_unit_test(layer_is_light_and_falls_with_intensity),
        cmocka_unit_test(outline_is_where_the_border_is_near),
        cmocka_unit_test(outline_has_the_asked_width),
        cmocka_unit_test(lines_lie_between_backdrop_and_outline),
        cmocka_unit_test(cover_is_what_rays_meet),
        cmocka_unit_test(parts_may_be_absent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
