/* The void behind vessels, the guiding field, the parameterization and its ink are what METHODS.md
   6 and 7 say: their oracles hold for the shared functions and for whole images made in C. */
#include "screen_passes.h"
#include "vessel_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define assert_near(a, b, tolerance) near_((double)(a), (double)(b), (tolerance), #a, __LINE__)
static void near_(double a, double b, double tolerance, const char *what, int line) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("line %d: %s is %.9g, not %.9g +- %.3g", line, what, a, b, tolerance);
}
static const double PI = 3.14159265358979324;
static double turn_of(double angle) { /* to (-pi, pi] */
    return angle - 2 * PI * floor(angle / (2 * PI) + 0.5);
}

/* -------------------------------------------------------------------------------- a flat picture
 */

/* An orthographic camera that looks along -z at pixels of 1 mm, depth range 0 .. 100 mm. */
static void flat_frame(screen *s) {
    lao_frame_uniforms *f = &s->frame;
    memset(f, 0, sizeof *f);
    f->view.x.x = f->view.y.y = f->view.z.z = f->view.w.w = 1;
    f->world = f->view;
    f->projection = f->view;
    f->projection.x.x = 2 / (float)s->width;
    f->projection.y.y = 2 / (float)s->height;
    f->ray = lao_v4_make(1, 1, -0.5f * (float)s->width, -0.5f * (float)s->height);
    f->depth = lao_v4_make(0, 0.01f, 100, 1);
    f->scale = lao_v4_make(1, 1, 0, 0);
    f->previous_view = f->view;
    f->previous_projection = f->projection;
}

static lao_v3 place(const screen *s, uint32_t i) {
    return lao_v3_make((float)(i % s->width) + 0.5f - 0.5f * (float)s->width,
                       (float)(i / s->width) + 0.5f - 0.5f * (float)s->height, -50);
}

/* Directions of a flat picture: along x, at 30 degrees, away from the middle or from a place beside
   it; flips turns them at random. Means of places at all levels are exact. */
enum { ALONG_X, AT_30, AWAY, AWAY_OFF };
static void flat_field(screen *s, int kind, int flips) {
    uint32_t seed = 5;
    double off = kind == AWAY_OFF ? 0.25 : 0;
    for (uint32_t l = 0; l < s->levels; l++) {
        uint32_t w, h, size = 1u << l;
        screen_size(s, l, &w, &h);
        for (uint32_t i = 0; i < w * h; i++) {
            uint32_t x = i % w, y = i / w;
            /* of the pixels of level 0 that exist */
            uint32_t x1 = (x + 1) * size < s->width ? (x + 1) * size : s->width;
            uint32_t y1 = (y + 1) * size < s->height ? (y + 1) * size : s->height;
            double px = 0.5 * (x * size + x1) - 0.5 * s->width;
            double py = 0.5 * (y * size + y1) - 0.5 * s->height;
            double zx = kind == ALONG_X ? 1 : kind == AT_30 ? cos(PI / 6) : px - off;
            double zy = kind == ALONG_X ? 0 : kind == AT_30 ? sin(PI / 6) : py - off;
            double size2 = sqrt(zx * zx + zy * zy);
            double sign = flips && lent_between(&seed, 0, 1) < 0.5 ? -1 : 1;
            if (!(size2 > 0)) {
                zx = size2 = 1;
            }
            zx *= sign / size2;
            zy *= sign / size2;
            s->place[l][i] = lao_v4_make((float)px, (float)py, -50, 1);
            s->along[l][i] = lao_v4_make((float)zx, (float)zy, 0, 0);
            s->across[l][i] = lao_v4_make((float)-zy, (float)zx, 0, 0);
        }
    }
}

/* Coarse directions as a picture has them, from means of tensors; sizes are powers of two. */
static void mean_field(screen *s) {
    for (uint32_t l = 0; l < s->levels; l++) {
        uint32_t w, h;
        screen_size(s, l, &w, &h);
        for (uint32_t i = 0; i < w * h; i++) {
            lao_v4 *t = &s->tensor[l][i], *z = &s->along[l][i];
            if (l == 0) {
                *t = lao_v4_make(z->x * z->x, z->x * z->y, z->y * z->y, 1);
                continue;
            }
            *t = lao_v4_make(0, 0, 0, 1);
            for (uint32_t k = 0; k < 4; k++) {
                size_t x = 2 * (i % w) + k % 2, y = 2 * (i / w) + k / 2;
                lao_v4 c = s->tensor[l - 1][2 * y * w + x];
                *t = lao_v4_make(t->x + c.x / 4, t->y + c.y / 4, t->z + c.z / 4, 1);
            }
            lao_v3 axis = sdv_tensor_axis(*t);
            *z = lao_v4_make(axis.x, axis.y, 0, 0);
            s->across[l][i] = lao_v4_make(-axis.y, axis.x, 0, 0);
        }
    }
}

static double dot(lao_v4 a, lao_v4 b) {
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y + (double)a.z * (double)b.z;
}
/* What is left of the energy between neighbours: RMS of the prediction's error, radians; weighted
   as in the energy, directions at a right angle have no common sign, and count for nothing. */
static double residual(const screen *s, const lao_v4 *phase, int v, bool weighted) {
    double sum = 0, n = 0, k = 2 * PI / (double)s->period;
    for (uint32_t y = 0; y < s->height; y++) {
        for (uint32_t x = 0; x < s->width; x++) {
            for (int axis = 0; axis < 2; axis++) {
                uint32_t i = y * s->width + x, j = axis ? i + s->width : i + 1;
                const lao_v4 *z = v ? s->across[0] : s->along[0];
                double sign, error, a, b;
                lao_v4 apart;
                if (axis ? y + 1 == s->height : x + 1 == s->width)
                    continue;
                sign = dot(z[i], z[j]) < 0 ? -1 : 1;
                apart = lao_v4_make(s->place[0][i].x - s->place[0][j].x,
                                    s->place[0][i].y - s->place[0][j].y, 0, 0);
                a = v ? (double)phase[i].y : (double)phase[i].x;
                b = v ? (double)phase[j].y : (double)phase[j].x;
                error =
                    turn_of(sign * b + k * 0.5 * (dot(z[i], apart) + sign * dot(z[j], apart)) - a);
                double weight = weighted ? fabs(dot(z[i], z[j])) : 1;
                sum += weight * error * error;
                n += weight;
            }
        }
    }
    return sqrt(sum / n);
}

/* ---------------------------------------------------------------------------------------- tests */

/* A plane and the sheet through it: what the camera's rays and the depth give back. */
static void sheets(void **state) {
    screen s;
    lao_v4 position[17 * 9], normal[17 * 9];
    uint32_t seed = 3;
    (void)state;
    assert_true(screen_make(&s, 17, 9));
    flat_frame(&s);
    for (uint32_t i = 0; i < 17 * 9; i++) { /* a slope of 1 in x, seen here and there */
        lao_v3 p = place(&s, i);
        bool seen = i % 17 == 3 || i % 17 == 16 || lent_between(&seed, 0, 1) < 0.1;
        position[i] = lao_v4_make(p.x, p.y, -50 + p.x, seen ? 2.0f : -1.0f);
        normal[i] = lao_v4_make(-0.70710678f, 0, 0.70710678f, 0);
    }
    screen_background(&s, position, normal);
    for (uint32_t i = 0; i < 17 * 9; i++) {
        lao_v3 p = place(&s, i);
        assert_near(s.surface[i].x, p.x, 1e-4);
        assert_near(s.surface[i].y, p.y, 1e-4);
        assert_true(s.filled[0][i].w == 1);
        assert_true(s.filled[0][i].x >= 50 - 8.01f && s.filled[0][i].x <= 50 + 8.01f);
        assert_near(sqrt(dot(s.bgnormal[i], s.bgnormal[i])), 1, 1e-6);
        assert_true(s.bgnormal[i].z > 0);
        if (position[i].w > 0) {
            assert_true(s.surface[i].z == position[i].z && s.surface[i].w == 4);
            assert_true(memcmp(&s.bgnormal[i], &normal[i], 12) == 0);
        } else {
            assert_true(s.surface[i].w == -4);
        }
    }
    /* void that is a plane has the plane's normal */
    for (uint32_t i = 0; i < 17 * 9; i++)
        s.filled[0][i].x = 50 - place(&s, i).x;
    assert_near(
        sdv_sheet_normal(lao_v3_make(1, 0, 1), lao_v3_make(0, 1, 0), lao_v3_make(0, 0, 1)).x,
        -sqrt(0.5), 1e-6);
    assert_near(
        sdv_sheet_normal(lao_v3_make(0, 1, 0), lao_v3_make(1, 0, 0), lao_v3_make(0, 0, 1)).z, 1, 0);
    /* the smaller step wins, and a missing neighbour never does */
    assert_near(
        sdv_sheet_step(lao_v3_make(-1, 0, 9), lao_v3_make(0, 0, 0), lao_v3_make(1, 0, 2), 9, 0, 2)
            .z,
        2, 0);
    assert_near(sdv_sheet_step(lao_v3_make(-1, 0, 9), lao_v3_make(0, 0, 0), lao_v3_make(0, 0, 0), 9,
                               0, SDV_FAR)
                    .z,
                -9, 0);
    /* METHODS 6, oracle 7: a hundredth of the last frame and k = 25 */
    assert_near(sdv_push_own(SDV_BACKGROUND_INERTIA, 25), 0.2222, 1e-4);
    screen_free(&s);
}

/* Nothing to fill from: far + diagonal; then the last frame's surface has no say. */
static void nothing(void **state) {
    screen s;
    lao_v4 position[5 * 3], normal[5 * 3];
    (void)state;
    memset(normal, 0, sizeof normal);
    assert_true(screen_make(&s, 5, 3));
    flat_frame(&s);
    for (int i = 0; i < 15; i++)
        position[i] = lao_v4_make(0, 0, 0, -1);
    for (int frame = 0; frame < 2; frame++) {
        screen_background(&s, position, normal);
        screen_guide(&s);
        screen_parameterize(&s);
        for (int i = 0; i < 15; i++) {
            assert_true(s.surface[i].z == -200 && s.surface[i].w == 0);
            assert_true(s.depth[0][i].w == 0);
            assert_true(s.uv[i].x == s.uv[i].x && s.uv[i].z == 1);
        }
        screen_next(&s);
    }
    screen_free(&s);
}

/* Inertia: the void moves towards where it belongs by parts. */
static void inertia(void **state) {
    screen s;
    lao_v4 position[64], normal[64];
    float first, second;
    (void)state;
    assert_true(screen_make(&s, 8, 8));
    flat_frame(&s);
    for (uint32_t i = 0; i < 64; i++) {
        lao_v3 p = place(&s, i);
        position[i] = lao_v4_make(p.x, p.y, -20, i % 8 < 2 ? 0.0f : -1.0f);
        normal[i] = lao_v4_make(0, 0, 1, 0);
    }
    screen_background(&s, position, normal);
    assert_near(s.surface[7].z, -20, 1e-5);
    screen_next(&s);
    for (uint32_t i = 0; i < 64; i++)
        position[i].z = -40;
    screen_background(&s, position, normal);
    first = s.surface[7].z;
    screen_next(&s);
    screen_background(&s, position, normal);
    second = s.surface[7].z;
    assert_true(first < -20.5f && first > -39.5f && second < first && second > -40);
    screen_free(&s);
}

/* METHODS 7.1: heights, thresholds, signs, and directions that cancel. */
static void contours(void **state) {
    lao_v2 g;
    lao_v4 a, b;
    lao_v3 z;
    (void)state;
    g = sdv_sobel(lao_v3_make(1, 1, 6), lao_v3_make(1, 1, 6), lao_v3_make(1, 1, 6), 0.1f);
    assert_near(g.x, 0.5, 1e-6); /* a step of 5 mm in a scene of 10 */
    assert_near(g.y, 0, 0);
    g = sdv_sobel(lao_v3_make(0, 0, 0), lao_v3_make(0, 0, 0), lao_v3_make(3, 3, 3), 0.1f);
    assert_near(g.y, 0.3, 1e-6);
    assert_true(sdv_contour_tensor(g, lao_v3_make(1, 0, 0), 0.3001f).w == 0);
    a = sdv_contour_tensor(g, lao_v3_make(0.6f, -0.8f, 0), 0.2f);
    b = sdv_contour_tensor(g, lao_v3_make(-0.3f, 0.4f, 0.86f), 0.2f);
    assert_near(a.w, 0.2, 1e-7);
    assert_near(a.x - b.x, 0, 1e-6); /* z and -z are one */
    assert_near(a.y - b.y, 0, 1e-6);
    z = sdv_tensor_axis(a);
    assert_near(z.x, 0.6, 1e-6);
    assert_near(z.y, -0.8, 1e-6);
    assert_near(sdv_tensor_axis(sdv_contour_tensor(g, lao_v3_make(0, 0, 1), 0.2f)).y, 1, 1e-6);
    /* 0 and 90 degrees: none; 80 and 100: 90, not 0 */
    assert_true(sdv_tensor_axis(lao_v4_make(0.5f, 0, 0.5f, 1)).z == 0);
    assert_true(sdv_tensor_axis(lao_v4_make(0, 0, 0, 0)).z == 0);
    for (int i = 0; i <= 360; i++) {
        double t = i * PI / 180, spread = 10 * PI / 180;
        lao_v4 m = sdv_tensor((float)cos(t - spread), (float)sin(t - spread), 1);
        lao_v4 n = sdv_tensor((float)cos(t + spread), (float)sin(t + spread), 1);
        z = sdv_tensor_axis(
            lao_v4_make(0.5f * (m.x + n.x), 0.5f * (m.y + n.y), 0.5f * (m.z + n.z), 1));
        assert_near(fabs((double)z.x * sin(t) - (double)z.y * cos(t)), 0, 1e-6);
        assert_true(z.x >= 0 && z.z == 1);
    }
    /* axes: certain from the side, nothing end-on */
    assert_near(sdv_axis_tensor(lao_v3_make(0, 3, 0)).w, 1, 1e-6);
    assert_near(sdv_axis_tensor(lao_v3_make(3, 0, 3)).w, 0.5, 1e-6);
    assert_true(sdv_axis_tensor(lao_v3_make(0, 0, 2)).w == 0);
    assert_true(sdv_axis_tensor(lao_v3_make(0, 0, 0)).w == 0);
}

/* METHODS 7.1: a ball's field is radial, and in its tangent planes. */
static void ball(void **state) {
    enum { SIDE = 64 };
    screen s;
    static lao_v4 position[SIDE * SIDE], normal[SIDE * SIDE];
    (void)state;
    assert_true(screen_make(&s, SIDE, SIDE));
    flat_frame(&s);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        lao_v3 p = place(&s, i);
        double left = 24 * 24 - (double)p.x * (double)p.x - (double)p.y * (double)p.y;
        double z = left > 0 ? sqrt(left) : 0;
        position[i] = lao_v4_make(p.x, p.y, (float)(z - 50), left > 0 ? 0.0f : -1.0f);
        normal[i] = lao_v4_make(p.x / 24, p.y / 24, (float)z / 24, 0);
    }
    screen_background(&s, position, normal);
    screen_guide(&s);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        lao_v3 p = place(&s, i);
        lao_v3 axis = sdv_tensor_axis(s.spread[0][i]);
        double r = sqrt((double)p.x * (double)p.x + (double)p.y * (double)p.y);
        double off = fabs((double)axis.x * (double)p.y - (double)axis.y * (double)p.x) / r;
        assert_near(dot(s.along[0][i], s.along[0][i]), 1, 1e-5);
        assert_near(dot(s.along[0][i], s.facing[0][i]), 0, 1e-5);
        assert_near(dot(s.along[0][i], s.across[0][i]), 0, 1e-5);
        if (s.tensor[0][i].w > 0)
            assert_true(r > 22 && off < 0.3);
        if (r > 4 && r < 24)
            assert_true(off < 0.3);
    }
    screen_free(&s);
}

/* METHODS 7.3, oracle 3 and the sign table: all orientations of a linear field predict the truth.
 */
static void signs(void **state) {
    lao_v3 x = {1, 0, 0}, minus = {-1, 0, 0}, quarter = {1, 0, 0};
    float k = LAO_TURN / 4;
    (void)state;
    assert_near(sdv_phase_from(x, x, 0, quarter, k).x, PI / 2, 1e-6);
    assert_near(sdv_phase_from(x, minus, 0, quarter, k).x, PI / 2, 1e-6);
    assert_near(sdv_phase_from(x, minus, 0.3f, quarter, k).x, PI / 2 - 0.3, 1e-6);
    assert_near(sdv_phase_from(minus, x, 0.3f, quarter, k).x, -PI / 2 - 0.3, 1e-6);
    assert_true(sdv_phase_from(x, lao_v3_make(0, 1, 0), 1, quarter, k).y == 0);
    for (int i = 0; i < 4; i++) {
        float a = i & 1 ? -1.0f : 1.0f, b = i & 2 ? -1.0f : 1.0f, at = 0.7f, from = -1.9f;
        lao_v2 p = sdv_phase_from(lao_v3_make(a, 0, 0), lao_v3_make(b, 0, 0), b * k * from,
                                  lao_v3_make(at - from, 0, 0), k);
        assert_near(p.x, a * k * at, 1e-5);
        assert_near(p.y, 1, 0);
    }
    { /* opposite predictions leave what was there, for u and for v alone */
        lao_v2 zero = {0, 1}, pi = {3.14159265f, 1}, one = {1, 1}, was = {0.25f, 0.5f}, r;
        sdv_phases sum = sdv_phases_start(lao_v4_make(0, 0, 0, 0));
        sum = sdv_phases_add(sum, zero, one, 2);
        sum = sdv_phases_add(sum, pi, one, 2);
        r = sdv_phases_mean(sum, was);
        assert_true(r.x == was.x);
        assert_near(r.y, 1, 1e-5);
    }
    for (int i = -400; i <= 400; i++) {
        float t = (float)i * 0.05f, w = sdv_phase_wrap(t);
        assert_near(turn_of((double)t - (double)w), 0, 1e-5);
        assert_true(fabsf(w) <= 3.14159265f && (fabsf(t) > 3.1415f || w == t));
    }
}

/* METHODS 7.3, oracles 1, 2, 4: a plane's phases are exact, whatever the signs of its directions.
 */
static void planes(void **state) {
    static const uint32_t sizes[][2] = {{64, 64}, {33, 17}, {1, 9}, {1, 1}};
    screen s, t;
    (void)state;
    for (uint32_t i = 0; i < 4; i++) {
        for (int kind = 0; kind < 2; kind++) {
            uint32_t n = sizes[i][0] * sizes[i][1];
            assert_true(screen_make(&s, sizes[i][0], sizes[i][1]));
            assert_true(screen_make(&t, sizes[i][0], sizes[i][1]));
            flat_frame(&s);
            flat_frame(&t);
            s.period = t.period = 8;
            flat_field(&s, kind, 0);
            flat_field(&t, kind, 1);
            screen_phases(&s);
            screen_phases(&t);
            if (n > 1) {
                assert_true(residual(&s, s.phase[0], 0, true) < 1e-3);
                assert_true(residual(&s, s.phase[0], 1, true) < 1e-3);
                assert_true(residual(&t, t.phase[0], 0, true) < 1e-3);
                assert_true(residual(&t, t.phase[0], 1, true) < 1e-3);
            }
            for (uint32_t k = 0; k < n; k++) /* patterns are even: one picture */
                assert_near(cos((double)s.phase[0][k].x), cos((double)t.phase[0][k].x), 1e-3);
            /* all directions turned: u becomes -u */
            for (uint32_t l = 0; l < s.levels; l++) {
                uint32_t w, h;
                screen_size(&s, l, &w, &h);
                for (uint32_t k = 0; k < w * h; k++) {
                    t.along[l][k] = lao_v4_make(-s.along[l][k].x, -s.along[l][k].y, 0, 0);
                    t.across[l][k] = lao_v4_make(-s.across[l][k].x, -s.across[l][k].y, 0, 0);
                }
            }
            screen_phases(&t);
            for (uint32_t k = 0; k < n; k++)
                assert_near(turn_of((double)s.phase[0][k].x + (double)t.phase[0][k].x), 0, 1e-3);
            screen_free(&s);
            screen_free(&t);
        }
    }
}

/* METHODS 7.3, oracle 6: what is left on a field with a centre, which u = k r solves; the same
   whatever the signs of its directions. The oracle's numbers are those of a centre a quarter of a
   pixel off the picture's middle in x and y, with every edge counting alike; in the middle of four
   pixels errors of the push cancel. */
static void sweeps(void **state) {
    static const int count[] = {0, 1, 4, 16};
    static const double oracle[] = {0.30, 0.15, 0.054, 0.004}, digits[] = {5e-3, 5e-3, 2e-3, 1e-3};
    static const double left[] = {0.0112, 0.0186, 0.0112, 0.0040};
    screen s;
    (void)state;
    for (int c = 0; c < 4; c++) {
        bool middle = c / 2 == 1;
        assert_true(screen_make(&s, 64, 64));
        flat_frame(&s);
        s.period = 8;
        flat_field(&s, middle ? AWAY : AWAY_OFF, c % 2);
        if (!middle)
            mean_field(&s);
        for (int i = 0; i < 4; i++) {
            s.sweeps = count[i];
            screen_phases(&s);
            assert_near(residual(&s, s.phase[0], 0, middle), middle ? left[i] : oracle[i],
                        middle ? 0.001 : digits[i]);
        }
        screen_free(&s);
    }
}

static void traced_plane(const screen *s, lao_v4 *position, lao_v4 *normal, float dx) {
    for (uint32_t i = 0; i < s->width * s->height; i++) {
        lao_v3 p = place(s, i);
        double r = hypot((double)(p.x + dx), (double)p.y);
        position[i] = lao_v4_make(p.x + dx, p.y, -50, r < 14 ? 0.0f : -1.0f);
        normal[i] = lao_v4_make(0, 0, 1, 0);
    }
}
static void moved(screen *s, float dx) { /* the camera, mm */
    s->frame.view.w.x = -dx;
    s->frame.world.w.x = dx;
}
static void run(screen *s, const lao_v4 *position, const lao_v4 *normal) {
    screen_background(s, position, normal);
    screen_guide(s);
    screen_parameterize(s);
}

/* METHODS 7.4: the same frame twice changes nothing; a camera that moves by whole pixels moves the
   picture by these; a changed period starts anew. */
static void coherence(void **state) {
    enum { SIDE = 40, STEP = 3 };
    static lao_v4 position[SIDE * SIDE], normal[SIDE * SIDE], uv[SIDE * SIDE];
    screen s;
    uint32_t same = 0, inside = 0;
    (void)state;
    for (int rule = 0; rule < 2; rule++) {
        assert_true(screen_make(&s, SIDE, SIDE));
        flat_frame(&s);
        traced_plane(&s, position, normal, 0);
        run(&s, position, normal);
        memcpy(uv, s.uv, sizeof uv);
        screen_next(&s);
        /* even where the solution goes on, without sweeps nothing is left to change */
        s.recycle = rule ? -1.0f : 0.0f;
        s.sweeps = rule ? 4 : 0;
        s.converge = rule ? 0.0f : 1.0f;
        run(&s, position, normal);
        for (uint32_t i = 0; i < SIDE * SIDE; i++)
            assert_true(rule ? memcmp(&uv[i], &s.uv[i], sizeof *uv) == 0
                             : uv[i].x == s.uv[i].x && uv[i].y == s.uv[i].y);
        screen_free(&s);
    }
    assert_true(screen_make(&s, SIDE, SIDE));
    flat_frame(&s);
    traced_plane(&s, position, normal, 0);
    run(&s, position, normal);
    memcpy(uv, s.uv, sizeof uv);
    screen_next(&s);
    s.recycle = 0;
    s.sweeps = 0;
    moved(&s, STEP);
    traced_plane(&s, position, normal, STEP);
    run(&s, position, normal);
    for (uint32_t y = 0; y < SIDE; y++) {
        for (uint32_t x = 0; x + STEP < SIDE; x++) {
            lao_v4 now = s.uv[y * SIDE + x], before = uv[y * SIDE + x + STEP];
            double sign = (double)now.z * (double)before.z + (double)now.w * (double)before.w;
            if (s.surface[y * SIDE + x].w < 0 || fabs(sign) < 0.5)
                continue;
            sign = sign < 0 ? -1 : 1;
            inside++;
            same += fabs(turn_of((double)now.x - sign * (double)before.x)) < 1e-4 &&
                    fabs(turn_of((double)now.y - sign * (double)before.y)) < 1e-4;
        }
    }
    assert_true(inside > 500);
    assert_int_equal(same, inside);
    screen_next(&s);
    s.period = 3; /* phases of another period are none */
    run(&s, position, normal);
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        assert_true(s.recalled[0][i].w == 0);
    screen_free(&s);
}

/* What came into view is not what was there before. */
static void disocclusion(void **state) {
    lao_v3 p = {0, 0, 0}, n = {0, 0, 1};
    lao_v2 phase = {0.3f, 0.4f};
    lao_m4 turned;
    (void)state;
    assert_true(sdv_same_surface(p, n, lao_v3_make(0.5f, 0.5f, 0), 1));
    assert_true(sdv_same_surface(p, n, lao_v3_make(5, 0, 1.9f), 1)); /* seen at a flat angle */
    assert_false(sdv_same_surface(p, n, lao_v3_make(0, 0, 2.1f), 1));
    assert_false(sdv_same_surface(p, n, lao_v3_make(9, 0, 0), 1));
    assert_false(sdv_same_surface(p, n, lao_v3_make(NAN, 0, 0), 1));
    /* levels: the largest with 2^l <= period / 16, at least 1 */
    assert_true(sdv_recycle_level(-1, 16, 1) == 1 && sdv_recycle_level(-1, 63, 1) == 1);
    assert_true(sdv_recycle_level(-1, 64, 1) == 2 && sdv_recycle_level(-1, 1, 1) == 1);
    assert_true(sdv_recycle_level(-1, 128, 1) == 3 && sdv_recycle_level(3, 16, 1) == 3);
    assert_true(sdv_recycle_level(3, 16, 0) == 0);
    /* what is recalled turns with its guide and moves with its pixel */
    phase = sdv_phase_recall(lao_v3_make(1, 0, 0), lao_v3_make(0, 1, 0),
                             lao_v3_make(-0.5f, 0.5f, 0), phase, lao_v3_make(1, 2, 0), 0.5f);
    assert_near(phase.x, -0.3 + 0.5, 1e-6);
    assert_near(phase.y, -0.4 + 1, 1e-6);
    /* the void stays by its pixel, a vessel by its place, neither with another period */
    assert_true(sdv_phase_stays(lao_v4_make(1, 2, 3, -4), lao_v4_make(9, 9, 9, -4)));
    assert_true(sdv_phase_stays(lao_v4_make(1, 2, 3, 4), lao_v4_make(1, 2, 3, 4)));
    assert_false(sdv_phase_stays(lao_v4_make(1, 2, 3, 4), lao_v4_make(1, 2, 4, 4)));
    assert_false(sdv_phase_stays(lao_v4_make(1, 2, 3, 4), lao_v4_make(1, 2, 3, -4)));
    assert_false(sdv_phase_stays(lao_v4_make(1, 2, 3, 4), lao_v4_make(1, 2, 3, 5)));
    /* the last camera's axes are the rows of its view */
    memset(&turned, 0, sizeof turned);
    turned.x = lao_v4_make(0, 1, 0, 0); /* world x is its up */
    turned.y = lao_v4_make(-1, 0, 0, 0);
    turned.z.z = turned.w.w = 1;
    assert_near(sdv_guide_world(turned, 0, 1).x, 1, 0);
    assert_near(sdv_guide_world(turned, 1, 0).y, -1, 0);
}

/* METHODS 7.5: the mean ink is the darkness for every style, size of pixels and darkness, however
   much finer strokes and dots are; ink is even in u and v. */
static void ink(void **state) {
    enum { N = 200 };
    static const double wide[] = {0.01, 0.05, 0.11, 0.3, 0.9, 2.7};
    static const double finer[] = {1, 1.3, 1.9, 2, 5};
    (void)state;
    for (int c = 0; c < 4 * 6 * 5 * 21; c++) {
        int style = SDV_STYLE_STIPPLE + c % 4;
        float w = (float)wide[c / 4 % 6], f = (float)finer[c / 24 % 5];
        double sum = 0, dark = c / 120 / 20.0;
        /* shifted, as the first sample would be on an edge */
        for (int i = 0; i < N * N; i++) {
            float u = (float)(2 * PI * ((i % N + 0.37) / N - 0.5));
            float v = (float)(2 * PI * ((i / N + 0.41) / N - 0.5));
            float x = sdv_style_ink(style, u, v, (float)dark, w, w, f);
            assert_true(x >= 0 && x <= 1);
            if (i % 97 == 0)
                assert_true(x == sdv_style_ink(style, -u, -v, (float)dark, w, w, f));
            sum += (double)x;
        }
        /* 2 % over 0.1 .. 0.9 is the bound */
        assert_near(sum / (N * N), dark, dark >= 0.1 && dark <= 0.9 ? 0.02 * dark : 0.004);
    }
    assert_near(sdv_chromadepth(0).x, 1, 0);
    assert_near(sdv_chromadepth(0.5f).z, 0.5, 0);
    assert_near(sdv_chromadepth(2).z, 1, 0);
}

/* Vessels thinner than a period have finer ink; where it grows finer nothing jumps, and when it is
   twice as fine the lattice is that of half a period. */
static void fine_ink(void **state) {
    enum { N = 20, STEPS = 4000 };
    (void)state;
    assert_true(sdv_ink_finer(6, 9, 1) == 1 && sdv_ink_finer(40, 9, 1) == 1);
    assert_near(sdv_ink_finer(4, 9, 1), 1.5, 1e-6);
    assert_near(sdv_ink_finer(1, 9, 1), 9 / (double)SDV_INK_LEAST_PIXELS, 1e-6);
    assert_true(sdv_ink_finer(1, 3, 1) == 1 && sdv_ink_finer(0, 1e9f, 1e-9f) == 32);
    for (int style = SDV_STYLE_STIPPLE; style <= SDV_STYLE_CROSSHATCH; style++) {
        for (int i = 0; i < N * N; i++) {
            float u = (float)(2 * PI * ((i % N + 0.37) / N - 0.5));
            float v = (float)(2 * PI * ((i / N + 0.41) / N - 0.5));
            float last = sdv_style_ink(style, u, v, 0.4f, 0.05f, 0.05f, 1);
            float whole = sdv_style_ink(style, 2 * u, 2 * v, 0.4f, 0.1f, 0.1f, 1);
            assert_near(sdv_style_ink(style, u, v, 0.4f, 0.05f, 0.05f, 2), (double)whole, 1e-5);
            for (int k = 1; k <= STEPS; k++) {
                float at = 1 + 3 * (float)k / STEPS;
                float now = sdv_style_ink(style, u, v, 0.4f, 0.05f, 0.05f, at);
                assert_true(fabsf(now - last) < 0.1f);
                last = now;
            }
        }
    }
}

/* Any picture is a pattern whose mean ink is the darkness, even in u and v; where it is too small
   to be seen only its tone is left. */
static void patterns(void **state) {
    enum { N = 16, GRID = 160 };
    static const double wide[] = {0.001, 0.02, 0.6};
    lent_host counted;
    sdv_host host = vessel_host_make(&counted);
    float values[N * N];
    sdv_object object;
    (void)state;
    for (int i = 0; i < N * N; i++) /* stripes, and equal values too */
        values[i] = (float)(i % N < 9 ? 3 : i / N);
    values[5] = NAN;
    memset(&object, 0, sizeof object);
    assert_int_equal(sdv_object_pattern(&host, values, N, &object), LAO_ERROR_INVALID_ARGUMENT);
    object.allocator = host.allocator;
    object.desc.buffers = object.buffers;
    assert_int_equal(sdv_object_pattern(&host, values, 257, &object), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(sdv_object_pattern(&host, NULL, N, &object), LAO_ERROR_INVALID_ARGUMENT);
    counted.memory.fail_allocation = counted.memory.allocations + 2;
    assert_int_equal(sdv_object_pattern(&host, values, N, &object), LAO_ERROR_OUT_OF_MEMORY);
    assert_int_equal(counted.memory.bytes, 0);
    counted.memory.fail_allocation = 0;
    assert_int_equal(sdv_object_pattern(&host, values, N, &object), LAO_OK);
    assert_true(object.pattern[0] == N && object.desc.buffer_count == 1);
    for (int w = 0; w < 3; w++) {
        for (int d = 0; d <= 10; d++) {
            double sum = 0;
            float dark = (float)d / 10, a = (float)wide[w];
            for (int k = 0; k < GRID * GRID; k++) {
                lao_v2 at = {(float)(2 * PI * ((k % GRID + 0.37) / GRID - 0.5)),
                             (float)(2 * PI * ((k / GRID + 0.41) / GRID - 0.5))};
                lao_v2 minus = {-at.x, -at.y};
                float inked = 0, same = 0;
                for (int i = 0; i < SDV_PATTERN_SAMPLES * SDV_PATTERN_SAMPLES; i++) {
                    inked +=
                        dark > object.pattern[1 + sdv_pattern_at(at, a, a, i, N)] ? 1.0f : 0.0f;
                    same +=
                        dark > object.pattern[1 + sdv_pattern_at(minus, a, a, i, N)] ? 1.0f : 0.0f;
                }
                assert_true(inked == same || k % 7);
                sum += (double)sdv_pattern_ink(inked, dark, a, a);
                if (w == 2)
                    assert_near(sdv_pattern_ink(inked, dark, a, a), (double)dark, 1e-6);
            }
            assert_near(sum / (GRID * GRID), (double)dark, 0.02 * (double)dark + 0.002);
        }
    }
    sdv_object_free(&object);
    assert_int_equal(counted.memory.bytes, 0);
}

/* The void keeps all of its ink beside a vessel, half of it half way, none from the reach on. */
static void void_reach(void **state) {
    float last = 1;
    (void)state;
    assert_true(sdv_void_share(0, 10, 0) == 1 && sdv_void_share(-3, 10, 0) == 1);
    assert_true(sdv_void_share(10, 10, 0) == 0 && sdv_void_share(SDV_FAR, 10, 0) == 0);
    assert_near(sdv_void_share(5, 10, 0), 0.5, 1e-6);
    for (int i = 1; i <= 100; i++) {
        float share = sdv_void_share((float)i, 100, 0);
        assert_true(share < last && last - share < 0.0151f);
        last = share;
    }
    assert_true(sdv_void_share(0, 0, 0) == 1 && sdv_void_share(SDV_FAR, 0, 0) == 1); /* no end */
    assert_near(sdv_near_miss_reach(1, 2, 3, 4, 5, 200), 10, 1e-5);
    /* strokes of less than 7 pixels pale, those of less than 3 are not drawn */
    assert_true(sdv_void_share(0, 10, 0.15f) == 1 && sdv_void_share(0, 0, 0.3f) == 0);
    assert_near(sdv_void_share(0, 10, 0.225f), 0.5, 1e-6);
    assert_true(sdv_near_miss_reach(1, 20, 3, 4, 5, 200) == 20);
}

/* A depth buffer's value back to mm: perspective and orthographic, also with reversed depth. */
static void drawn_depths(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        const double n = 2, f = 300;
        const bool reverse = kind % 2 == 1;
        lao_m4 p;
        memset(&p, 0, sizeof p);
        if (kind < 2) { /* perspective */
            p.z.z = (float)(reverse ? n / (f - n) : -f / (f - n));
            p.w.z = (float)(reverse ? n * f / (f - n) : -n * f / (f - n));
            p.z.w = -1;
        } else {
            p.z.z = (float)(reverse ? 1 / (f - n) : -1 / (f - n));
            p.w.z = (float)(reverse ? f / (f - n) : -n / (f - n));
            p.w.w = 1;
        }
        for (int i = 1; i < 10; i++) {
            double z = n + (f - n) * i / 10, across = kind < 2 ? z : 1;
            double value = (-(double)p.z.z * z + (double)p.w.z) / across;
            assert_true(value > 0 && value < 1);
            assert_near(sdv_drawn_depth(p, (float)value), z, 2e-4 * f * f / n);
        }
        assert_true(sdv_drawn_depth(p, 0) == SDV_FAR && sdv_drawn_depth(p, 1) == SDV_FAR);
        assert_true(sdv_drawn_depth(p, NAN) == SDV_FAR);
    }
}

/* Periods per pixel: head on they are the pixel's part of the period; tilted, more. */
static void footprints(void **state) {
    lao_v3 x = {1, 0, 0}, y = {0, 1, 0}, down = {0, 0, -1}, n = {0, 0, 1};
    lao_v3 tilted = {-0.8660254f, 0, 0.5f}, z = {0.5f, 0, 0.8660254f};
    (void)state;
    assert_near(sdv_style_footprint(x, n, x, y, down, 0.5f, 4), 0.125, 1e-6);
    assert_near(sdv_style_footprint(z, tilted, x, y, down, 0.5f, 4), 0.25, 1e-6);
    assert_near(sdv_style_footprint(y, tilted, x, y, down, 0.5f, 4), 0.125, 1e-6);
    assert_true(sdv_style_footprint(down, x, x, y, down, 1, 1) <= 20.001f); /* edge-on: finite */
}

/* A mesh becomes an object, or is refused and leaves nothing behind. */
static void meshes(void **state) {
    static const float corners[] = {0, 0, 0, 4, 0, 0, 0, 2, 0, 0, 0, 1};
    static const float upward[] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    uint32_t faces[] = {0, 1, 2, 0, 1, 3};
    float broken[12];
    lent_host counted;
    sdv_host host = vessel_host_make(&counted);
    sdv_mesh_desc desc;
    sdv_object object, none;
    (void)state;
    memset(&desc, 0, sizeof desc);
    memset(&none, 0, sizeof none);
    sdv_object_free(&none);
    desc.vertex_count = 4;
    desc.triangle_count = 2;
    desc.positions = corners;
    desc.normals = upward;
    desc.triangles = faces;
    desc.directions = corners;
    assert_int_equal(sdv_object_mesh(&host, &desc, &object), LAO_OK);
    assert_int_equal(object.desc.triangle_count, 2);
    assert_true(object.desc.bounds[1][0] == 4 && object.desc.bounds[1][2] == 1);
    sdv_object_free(&object);
    assert_int_equal(counted.memory.bytes, 0);
    memset(&object, 7, sizeof object);
    memcpy(&none, &object, sizeof none);
    faces[5] = 4;
    assert_int_equal(sdv_object_mesh(&host, &desc, &object), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(counted.item, SDV_LOG_MESH);
    faces[5] = 3;
    memcpy(broken, corners, sizeof broken);
    broken[7] = NAN;
    desc.positions = broken;
    assert_int_equal(sdv_object_mesh(&host, &desc, &object), LAO_ERROR_INVALID_ARGUMENT);
    desc.positions = corners;
    desc.triangle_count = 0;
    assert_int_equal(sdv_object_mesh(&host, &desc, &object), LAO_ERROR_INVALID_ARGUMENT);
    desc.triangle_count = 2;
    desc.normals = NULL;
    assert_int_equal(sdv_object_mesh(&host, &desc, &object), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(sdv_object_drawn(&host, NULL, &object), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(counted.item, SDV_LOG_NULL_ARGUMENT);
    desc.normals = upward;
    counted.memory.fail_allocation = counted.memory.allocations + 1;
    assert_int_equal(sdv_object_mesh(&host, &desc, &object), LAO_ERROR_OUT_OF_MEMORY);
    assert_int_equal(counted.failures, 6);
    assert_int_equal(counted.memory.bytes, 0);
    assert_memory_equal(&object, &none, sizeof object);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sheets),       cmocka_unit_test(nothing),      cmocka_unit_test(inertia),
        cmocka_unit_test(contours),     cmocka_unit_test(ball),         cmocka_unit_test(signs),
        cmocka_unit_test(planes),       cmocka_unit_test(sweeps),       cmocka_unit_test(coherence),
        cmocka_unit_test(disocclusion), cmocka_unit_test(ink),          cmocka_unit_test(fine_ink),
        cmocka_unit_test(footprints),   cmocka_unit_test(patterns),     cmocka_unit_test(meshes),
        cmocka_unit_test(void_reach),   cmocka_unit_test(drawn_depths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
