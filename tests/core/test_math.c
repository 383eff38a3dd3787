/* Every shared function of lineao.h computes the formula of METHODS.md: its oracles hold, dense
   sweeps stay within the error that the header states against double precision, and no input,
   however degenerate, gives anything but numbers. */
#include "core_host.h"
#include "near.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define PI 3.14159265358979323846
#define ROUNDS 20000

static uint32_t seed = 1;
static float any(double low, double high) {
    return (float)core_between(&seed, low, high);
}
static lao_v3 any_v3(double size) {
    return lao_v3_make(any(-size, size), any(-size, size), any(-size, size));
}
static lao_v3 any_unit(void) {
    lao_v3 v = any_v3(1);
    while (lao_v3_dot(v, v) < 0.01f) {
        v = any_v3(1);
    }
    return lao_v3_unit(v, v);
}
static double dot(lao_v3 a, lao_v3 b) {
    return (double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z;
}
static double length(lao_v3 v) {
    return sqrt(dot(v, v));
}
static double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}
static double hermite(double x) {
    double t = clamp(x, 0, 1);
    return t * t * (3 - 2 * t);
}
static lao_v3 v3(double x, double y, double z) {
    return lao_v3_make((float)x, (float)y, (float)z);
}
static void assert_v3(lao_v3 v, double x, double y, double z, double tolerance) {
    assert_near(v.x, x, tolerance);
    assert_near(v.y, y, tolerance);
    assert_near(v.z, z, tolerance);
}

static void vectors_and_matrices(void **state) {
    (void)state;
    for (int i = 0; i < ROUNDS; i++) {
        lao_v3 a = any_v3(10), b = any_v3(10), c;
        float s = any(-5, 5);
        float m[16];
        lao_m4 matrix;
        lao_v4 p;
        assert_near(lao_v3_dot(a, b), dot(a, b), 5e-5);
        assert_near(lao_v2_dot(lao_v2_make(a.x, a.y), lao_v2_make(b.x, b.y)),
                    (double)a.x * b.x + (double)a.y * b.y, 5e-5);
        c = lao_v3_cross(a, b);
        assert_v3(c, (double)a.y * b.z - (double)a.z * b.y, (double)a.z * b.x - (double)a.x * b.z,
                  (double)a.x * b.y - (double)a.y * b.x, 5e-5);
        assert_v3(lao_v3_along(a, b, s), a.x + (double)b.x * s, a.y + (double)b.y * s,
                  a.z + (double)b.z * s, 2e-5);
        assert_v3(lao_v3_add(a, b), (double)a.x + b.x, (double)a.y + b.y, (double)a.z + b.z, 2e-6);
        assert_v3(lao_v3_sub(a, b), (double)a.x - b.x, (double)a.y - b.y, (double)a.z - b.z, 2e-6);
        assert_v3(lao_v3_scale(a, s), (double)a.x * s, (double)a.y * s, (double)a.z * s, 5e-6);
        if (length(a) > 1e-3) {
            assert_v3(lao_v3_unit(a, b), a.x / length(a), a.y / length(a), a.z / length(a), 2e-7);
        }
        for (int k = 0; k < 16; k++) {
            m[k] = any(-3, 3);
        }
        memcpy(&matrix, m, sizeof m);
        p = lao_project(matrix, a);
        c = lao_transform(matrix, a);
        for (int r = 0; r < 4; r++) {
            double wanted =
                (double)m[r] * a.x + (double)m[4 + r] * a.y + (double)m[8 + r] * a.z + m[12 + r];
            assert_near((&p.x)[r], wanted, 3e-5);
            if (r < 3) {
                assert_near((&c.x)[r], wanted, 3e-5);
            }
        }
    }
    assert_v3(lao_v3_unit(v3(0, 0, 0), v3(0, 1, 0)), 0, 1, 0, 0);
    assert_v3(lao_v3_unit(v3(9e-13, 0, 0), v3(0, 1, 0)), 0, 1, 0, 0);
    assert_v3(lao_v3_unit(v3(3e-12, 0, 0), v3(0, 1, 0)), 1, 0, 0, 2e-7);
}

static void elementary_functions_keep_their_bounds(void **state) {
    (void)state;
    for (int i = -64000; i <= 64000; i++) {
        float t = (float)i / 4000.0f;
        if (fabsf(t) < 16) {
            assert_near(lao_cos_turns(t), cos(2 * PI * (double)t), 3e-7);
            /* t - 1/4 is rounded once more */
            assert_near(lao_sin_turns(t), sin(2 * PI * (double)t), 3e-7 + 4e-7 * fabs((double)t));
        }
    }
    for (int i = 0; i <= 253000; i++) {
        float x = -126.0f + (float)i / 1000.0f;
        double wanted = exp2((double)x);
        assert_near(lao_exp2(x) / wanted, 1, 3e-7);
    }
    assert_near(lao_exp2(-1000), exp2(-126), 1e-44);
    assert_near(lao_exp2(1000) / exp2(127), 1, 1e-7);
    assert_near(lao_exp2(0), 1, 0);
    for (int i = 0; i < 200000; i++) {
        float x = lao_bits_float(0x00800000u + core_random(&seed) % 0x7f000000u);
        double wanted = log2((double)x);
        assert_near(lao_log2(x), wanted, 3e-7 + 1e-7 * fabs(wanted));
        x = any(0.9, 1.1);
        assert_near(lao_log2(x), log2((double)x), 3e-7);
    }
    assert_near(lao_log2(1), 0, 0);
    assert_near(lao_log2(0), -127, 0);
    assert_near(lao_log2(-1), -127, 0);
    for (int i = 0; i < 200000; i++) {
        double angle = 2 * PI * i / 200000, size = exp2(any(-40, 40));
        float y = (float)(size * sin(angle)), x = (float)(size * cos(angle));
        assert_near(lao_atan2(y, x), atan2((double)y, (double)x), 5e-7);
    }
    assert_near(lao_atan2(0, 0), 0, 0);
    assert_near(lao_atan2(0, -1), PI, 2e-7);
    assert_near(lao_atan2(-1, 0), -PI / 2, 2e-7);
    for (int i = -100000; i <= 100000; i++) {
        float x = (float)i / 100000.0f;
        assert_near(lao_acos(x), acos((double)x), 1e-6);
    }
    assert_near(lao_acos(3), 0, 0);
    assert_near(lao_acos(-3), PI, 2e-7);
    for (int i = 0; i < ROUNDS; i++) {
        int32_t n = (int32_t)(core_random(&seed) % 1024);
        float x = any(0, 1);
        double wanted = pow((double)x, n);
        assert_near(lao_power(x, n), wanted, 8e-31 + 1.3e-4 * wanted); /* 0 below 2^-100 */
        assert_near(lao_power(x, 0), 1, 0);
        assert_near(lao_power(x, 1), x, 0);
        assert_near(lao_power(0, n), n == 0, 0);
        assert_near(lao_power(1, n), 1, 0);
        x = any(-1, 2);
        assert_near(lao_hermite(x), hermite((double)x), 2e-7);
        wanted = clamp((double)x, 0, 1);
        assert_near(lao_clamp01(x), wanted, 0);
        assert_near(lao_srgb_decode((float)wanted),
                    wanted <= 0.04045 ? wanted / 12.92 : pow((wanted + 0.055) / 1.055, 2.4), 2e-6);
        assert_near(lao_srgb_encode((float)wanted),
                    wanted <= 0.0031308 ? 12.92 * wanted : 1.055 * pow(wanted, 1 / 2.4) - 0.055,
                    2e-6);
    }
    assert_near(lao_hermite(0.25f), 0.15625, 0);
    assert_near(lao_hermite(0.5f), 0.5, 0);
    assert_near(lao_hermite(0.75f), 0.84375, 0);
}

static void noise_is_uniform_and_has_no_tiles(void **state) {
    double sum[3] = {0, 0, 0}, square[3] = {0, 0, 0};
    (void)state;
    for (int i = 0; i < ROUNDS; i++) {
        uint32_t v = core_random(&seed);
        uint64_t s = ((uint64_t)v * 747796405u + 2891336453u) & 0xffffffffu;
        uint64_t w = (((s >> ((s >> 28) + 4)) ^ s) * 277803737u) & 0xffffffffu;
        float f = lao_unit_float(v);
        assert_int_equal(lao_hash(v), (w >> 22) ^ w);
        assert_near(f, (double)(v >> 8) / 16777216, 0);
        assert_true(f >= 0 && f < 1);
        assert_near(length(lao_sphere_point(f, any(0, 1))), 1, 1e-6);
    }
    assert_true(lao_unit_float(0xffffffffu) < 1);
    for (uint32_t y = 0; y < 256; y++) {
        for (uint32_t x = 0; x < 256; x++) {
            lao_v3 n = lao_pixel_noise(x, y);
            assert_near(length(n), 1, 1e-6);
            for (int k = 0; k < 3; k++) {
                sum[k] += (double)(&n.x)[k] / 65536;
                square[k] += (double)(&n.x)[k] * (double)(&n.x)[k] / 65536;
            }
        }
    }
    for (int k = 0; k < 3; k++) {
        assert_near(sum[k], 0, 0.012); /* 5 standard deviations */
        assert_near(square[k], 1.0 / 3, 0.006);
    }
    for (uint32_t period = 1; period <= 1024; period++) { /* neither along x nor along y */
        int same = 0;
        for (uint32_t x = 0; x < 8; x++) {
            lao_v3 a = lao_pixel_noise(x, 3), b = lao_pixel_noise(x + period, 3),
                   c = lao_pixel_noise(x, 3 + period);
            same += memcmp(&a, &b, sizeof a) == 0;
            same += memcmp(&a, &c, sizeof a) == 0;
        }
        assert_true(same < 2);
    }
}

static void sample_counts_and_directions(void **state) {
    (void)state;
    assert_int_equal(lao_sample_count(32, 0), 32);
    assert_int_equal(lao_sample_count(32, 1), 16);
    assert_int_equal(lao_sample_count(32, 2), 11);
    assert_int_equal(lao_sample_count(32, 0) + lao_sample_count(32, 1) + lao_sample_count(32, 2),
                     59);
    for (uint32_t samples = 1; samples <= 128; samples++) {
        for (uint32_t level = 0; level < 8; level++) {
            double wanted = floor(samples / (level + 1.0) + 0.5);
            uint32_t n = lao_sample_count(samples, level);
            double mean[3] = {0, 0, 0};
            assert_int_equal(n, (uint32_t)(wanted < 1 ? 1 : wanted));
            for (uint32_t i = 0; i < n; i++) {
                lao_v3 d = lao_sample_direction(level, i, n);
                uint32_t from_top = i % 2 ? n - 1 - i / 2 : i / 2; /* both ends in turn */
                assert_near(length(d), 1, 1e-6);
                assert_near(d.z, 1 - 2 * (from_top + 0.5) / n, 1e-6);
                for (int k = 0; k < 3; k++) {
                    mean[k] += (double)(&d.x)[k] / n;
                }
            }
            if (n >= 16) { /* the set is balanced over the sphere */
                assert_true(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2] < 0.02);
            }
        }
    }
    /* levels are turned against each other */
    assert_true(fabsf(lao_sample_direction(0, 3, 16).x - lao_sample_direction(1, 3, 16).x) > 1e-3f);
}

static void mirrors_are_isometries(void **state) {
    lao_v3 m;
    (void)state;
    assert_v3(lao_mirror(v3(1, 0, 0), v3(0, 1, 0)), 1, 0, 0, 0);
    assert_v3(lao_mirror(v3(0, 1, 0), v3(0, 1, 0)), 0, -1, 0, 0);
    for (int i = 0; i < ROUNDS; i++) {
        lao_v3 r = any_unit(), n = any_unit(), v = any_unit();
        m = lao_mirror(r, n);
        assert_near(length(m), 1, 1e-6);
        assert_v3(m, r.x - 2 * dot(r, n) * n.x, r.y - 2 * dot(r, n) * n.y,
                  r.z - 2 * dot(r, n) * n.z, 1e-6);
        assert_near(dot(r, lao_mirror(v, n)), dot(m, v), 1e-6); /* what the sampler rests on */
    }
}

/* What lao_tap_make computes, in METHODS' own order: mirror, turn to the hemisphere, offset in
 * pixels. */
static void taps_are_the_mirrored_samples(void **state) {
    double turned = 0;
    int counted = 0, own = 0, outside = 0;
    (void)state;
    for (int i = 0; i < ROUNDS; i++) {
        uint32_t level = (uint32_t)i % 4;
        double texel = 1.0 / (1 << level), offset_x, offset_y, x, y, c, r, scale;
        lao_v3 noise = any_unit(), normal = any_unit(), light = any_unit();
        lao_v3 direction = lao_sample_direction(level, (uint32_t)i % 16, 16),
               omega = lao_mirror(direction, noise);
        float radius = any(0, 40), px = floorf(any(0, 100)) + 0.5f, py = floorf(any(0, 60)) + 0.5f;
        lao_v2 size = lao_v2_make((float)(100 >> level), (float)(60 >> level));
        lao_sampler sampler = lao_sampler_make(noise, normal, light, radius, (float)texel, px, py);
        lao_tap tap = lao_tap_make(sampler, direction, lao_v2_make(1 / size.x, 1 / size.y));
        c = dot(omega, normal);
        if (fabs(c) < 1e-5) {
            continue;
        }
        scale = radius * texel > 1.5 ? radius * texel : 1.5; /* r_l = max(r_l, 1.5 2^l) */
        omega = lao_v3_scale(omega, c < 0 ? -1.0f : 1.0f);
        offset_x = px * texel + scale * omega.x;
        offset_y = py * texel + scale * omega.y;
        if (fabs(offset_x - floor(offset_x + 0.5)) < 1e-4 ||
            fabs(offset_y - floor(offset_y + 0.5)) < 1e-4) {
            continue; /* the texel's edge: either is right */
        }
        x = floor(offset_x);
        y = floor(offset_y);
        r = dot(omega, light);
        assert_near(tap.x, x, 0);
        assert_near(tap.y, y, 0);
        assert_near(tap.at.x * size.x, x + 0.5, 1e-4); /* the texel's centre */
        assert_near(tap.at.y * size.y, y + 0.5, 1e-4);
        assert_near(lao_turned(1, tap.side), c < 0 ? -1 : 1, 0);
        assert_near(tap.n_omega, fabs(c), 2e-6);
        assert_near(tap.r_omega, c < 0 ? -dot(lao_mirror(direction, noise), light) : r, 2e-6);
        turned += (double)tap.n_omega;
        if (x == floor(px * texel) && y == floor(py * texel)) {
            assert_false(tap.counts);
            own++;
        } else if (x < 0 || y < 0 || x >= (double)size.x || y >= (double)size.y) {
            assert_false(tap.counts);
            outside++;
        } else {
            assert_true(tap.counts);
            counted++;
        }
    }
    assert_true(turned > 0 && counted > 1000 && own > 100 && outside > 100);
    /* a cosine of zero counts as the front: sgn(0) = +1, or the sample would fall onto its own
     * pixel */
    {
        lao_sampler s = lao_sampler_make(v3(0, 0, 1), v3(0, 0, 1), v3(0, 0, 1), 4, 1, 10.5f, 10.5f);
        lao_tap tap = lao_tap_make(s, v3(1, 0, 0), lao_v2_make(0.05f, 0.05f));
        assert_near(lao_turned(1, tap.side), 1, 0);
        assert_near(tap.x, 14, 0);
    }
}

static void radii(void **state) {
    (void)state;
    for (uint32_t l = 0; l < 3; l++) {
        assert_near(lao_sample_radius(50, 1.5f, 0.5f, 2, l), 37.5 + 100 * l, 0);
    }
    for (int i = 0; i < ROUNDS; i++) {
        float zoom = any(0, 100), factor = any(0.5, 10), width = any(0, 5), step = any(0, 5);
        uint32_t l = (uint32_t)i % 8;
        double wanted = (double)zoom * ((double)factor * width + l * (double)step);
        assert_near(lao_sample_radius(zoom, factor, width, step, l), wanted, 1e-6 * wanted + 1e-6);
    }
}

static lao_m4 matrix_of(const float m[16]) {
    lao_m4 r;
    memcpy(&r, m, sizeof r);
    return r;
}

/* Eq. 14 in pixels per mm: aspect-correct, xy only. */
static void zoom_is_pixels_per_millimetre(void **state) {
    lao_camera camera = core_camera();
    lao_m4 p = matrix_of(camera.projection);
    lao_v3 eye = v3(0, 0, -10); /* e x t is across: t = (0,1,0) gives o = (+-1,0,0) */
    (void)state;
    assert_near(lao_zoom(p, lao_v4_make(1000, 1000, 0, 0), eye, v3(1, 0, 0)), 50, 1e-4);
    assert_near(lao_zoom(p, lao_v4_make(1000, 1000, 0, 0), eye, v3(0, -1, 0)), 50, 1e-4);
    camera.projection[0] = 0.5f; /* 2000 x 1000, same fovy */
    p = matrix_of(camera.projection);
    assert_near(lao_zoom(p, lao_v4_make(2000, 1000, 0, 0), eye, v3(1, 0, 0)), 50, 1e-4);
    assert_near(lao_zoom(p, lao_v4_make(2000, 1000, 0, 0), eye, v3(0, 1, 0)), 50, 1e-4);
    memset(camera.projection, 0, sizeof camera.projection); /* orthographic, half height 10 */
    camera.projection[0] = camera.projection[5] = 0.1f;
    camera.projection[10] = -0.01f;
    camera.projection[15] = 1;
    p = matrix_of(camera.projection);
    for (int z = 1; z <= 100; z++) {
        assert_near(lao_zoom(p, lao_v4_make(1000, 1000, 0, 0), v3(3, -2, -z), v3(0, 1, 0)), 50,
                    1e-3);
    }
    for (int i = 0; i < ROUNDS;
         i++) { /* anywhere in a perspective view, against double precision */
        lao_camera c = core_camera();
        lao_v3 q = v3(any(-5, 5), any(-5, 5), any(-90, -3)), o = any_unit();
        double w = (double)any(100, 4000), h = (double)any(100, 4000), x, y, z2 = (double)q.z + o.z;
        c.projection[0] = any(0.3, 3);
        c.projection[5] = any(0.3, 3);
        x = 0.5 * w * c.projection[0] * (((double)q.x + o.x) / -z2 - (double)q.x / -(double)q.z);
        y = 0.5 * h * c.projection[5] * (((double)q.y + o.y) / -z2 - (double)q.y / -(double)q.z);
        assert_near(lao_zoom(matrix_of(c.projection), lao_v4_make((float)w, (float)h, 0, 0), q, o),
                    sqrt(x * x + y * y), 3e-3 + 1e-5 * sqrt(x * x + y * y));
    }
    /* from depth alone: exact on the axis */
    assert_near(lao_pixel_zoom(lao_v4_make(0, 500, 0, 0), lao_v4_make(5, 0.1f, 10, 0), 0.5f), 50,
                1e-4);
    assert_near(lao_pixel_zoom(lao_v4_make(0, -500, 0, 0), lao_v4_make(5, 0.1f, 10, 0), 0.5f), 50,
                1e-4);
    assert_near(lao_pixel_zoom(lao_v4_make(0, 50, 0, 0), lao_v4_make(5, 0.1f, 10, 1), 0.9f), 50,
                1e-4);
}

static void depths_and_rays(void **state) {
    (void)state;
    for (int i = 0; i < ROUNDS; i++) {
        float z0 = any(-20, 50), range = any(0.5, 200), z = any(-300, 300);
        lao_v4 depth = lao_v4_make(z0, 1 / range, range, 0);
        double wanted = clamp(((double)z - z0) / range, 0, 1);
        float d = lao_scene_depth(depth, z);
        lao_v2 slope = lao_v2_make(any(-2, 2), any(-2, 2));
        lao_v3 l = lao_towards_eye(slope, 0);
        double n = sqrt(1 + (double)slope.x * slope.x + (double)slope.y * slope.y);
        assert_near(d, wanted, 1e-4 / (double)range + 1e-6);
        assert_near(lao_view_depth(depth, d), z0 + (double)range * wanted,
                    1e-4 + 1e-6 * (double)range);
        assert_v3(l, -slope.x / n, -slope.y / n, 1 / n,
                  1e-6); /* from slope * t, -t back to the eye */
        assert_v3(lao_towards_eye(slope, 1), 0, 0, 1, 0);
        slope = lao_pixel_slope(lao_v4_make(0.002f, -0.003f, -1, 0.5f), 100.5f, (float)i);
        assert_near(slope.x, 0.201 - 1, 1e-6);
        assert_near(slope.y, 0.5 - 0.003 * i, 1e-5);
    }
}

static lao_v4 through_8_bits(lao_v4 v) {
    for (int k = 0; k < 4; k++) {
        (&v.x)[k] = (float)((int)((double)(&v.x)[k] * 255 + 0.5)) / 255.0f;
    }
    return v;
}

static lao_v2 axial_of(double degrees) {
    return lao_v2_make((float)cos(degrees * PI / 90), (float)sin(degrees * PI / 90));
}

/* Angle in degrees between two axial vectors, of the double angle. */
static double axial_angle(lao_v2 a, lao_v2 b) {
    double c = (double)a.x * (double)b.x + (double)a.y * (double)b.y;
    double s = (double)a.x * (double)b.y - (double)a.y * (double)b.x;
    return fabs(atan2(s, c)) * 180 / PI;
}

static void texels_come_back(void **state) {
    (void)state;
    for (int i = 0; i < 200000; i++) {
        float d = i == 0 ? 0.0f : i == 1 ? 1.0f : any(0, 1), alpha = any(0, 1);
        lao_v2 axial = axial_of((double)any(-360, 360)), back;
        uint32_t word = lao_level_pack(d, axial, LAO_ALIGN_ROTATION);
        assert_near(lao_level_depth(word), d, 5.4e-7); /* half a step and rounding */
        assert_true(lao_level_known(word));
        back = lao_level_direction(word, LAO_ALIGN_ROTATION);
        assert_near(length(v3(back.x, back.y, 0)), 1, 1e-6);
        assert_true(axial_angle(axial, back) < 180.0 / 2048 + 1e-3);
        word = lao_level_pack(d, lao_v2_make(alpha, 1), LAO_ALIGN_PAPER);
        back = lao_level_direction(word, LAO_ALIGN_PAPER);
        assert_near(lao_level_depth(word), d, 5.4e-7);
        assert_near(back.x, alpha, 0.5 / 2047 + 1e-6);
        assert_near(back.y, 1, 0);
        word = lao_level_pack(d, axial, LAO_ALIGN_NONE);
        assert_true(!lao_level_known(word) && word != 0);
        lao_v3 v = v3(axial.x, axial.y, 2 * (double)d - 1), w = lao_signed_pack(v);
        w = lao_signed_unpack(through_8_bits(lao_v4_make(w.x, w.y, w.z, 1)));
        assert_v3(w, v.x, v.y, v.z, 1.0 / 255 + 1e-6);
    }
    for (uint32_t n = 0; n <= 1048574; n += 17) { /* every step is told from its neighbour */
        uint32_t word = lao_level_pack((float)n / LAO_LEVEL_STEPS, axial_of(50), 0);
        assert_int_equal(word & LAO_LEVEL_NEAREST, LAO_LEVEL_NEAREST - n);
        assert_near(lao_level_nearer(lao_level_pack(1, axial_of(5), 0), word), 1048574 - (double)n,
                    0);
    }
    assert_near(lao_level_depth(lao_level_pack(0, axial_of(0), 0)), 0, 0);
    assert_near(lao_level_depth(lao_level_pack(1, axial_of(0), 0)), 1, 0);
    assert_near(lao_level_depth(lao_level_pack(7, axial_of(0), 0)), 1, 0);
    assert_near(lao_level_depth(lao_level_pack(-7, axial_of(0), 0)), 0, 0);
    assert_near(lao_level_depth(lao_level_pack(NAN, axial_of(0), 0)), 0, 0);
    assert_near(lao_level_depth(0), 1, 0); /* nothing is covered: far, no direction */
    assert_false(lao_level_known(0));
    /* no direction, or too little of one */
    assert_false(lao_level_known(lao_level_pack(0, lao_v2_make(0.1f, 0.1f), LAO_ALIGN_ROTATION)));
    assert_false(lao_level_known(lao_level_pack(0, lao_v2_make(0.9f, 0.4f), LAO_ALIGN_PAPER)));
    assert_near(lao_level_direction(lao_level_pack(0, lao_v2_make(0, 0), 0), 0).x, 0, 0);
    /* what a texel of level 0 brings to level 1, and what a mean becomes */
    assert_near(lao_level_child(0, LAO_ALIGN_ROTATION).z, 0, 0);
    assert_near(lao_level_child(lao_level_pack(0.5f, axial_of(30), 0), 0).z, 1, 0);
    assert_near(lao_level_child(lao_level_pack(0.5f, axial_of(30), 0), 0).x, 0.5, 2e-3);
    assert_int_equal(lao_level_word(lao_v4_make(0.5f, 0, 0, 0.5f), 0), 0);
    assert_int_equal(lao_level_word(lao_v4_make(0, 0.02f, 3, 0.25f), 0),
                     lao_level_pack(0.25f, axial_of(45), 0)); /* short, but a direction */
    assert_int_equal(lao_level_word(lao_v4_make(0.2f, 0.8f, 3, 0.25f), 1),
                     lao_level_pack(0.25f, lao_v2_make(0.25f, 1), 1));
    assert_int_equal(lao_level_word(lao_v4_make(0.2f, 0.4f, 3, 0.25f), 1),
                     lao_level_pack(0.25f, lao_v2_make(0, 0), 1));
}

static void axial_directions(void **state) {
    (void)state;
    for (int degrees = -180; degrees <= 180; degrees++) {
        lao_v2 a = axial_of(degrees), alpha = lao_axial_alpha(a), unit;
        lao_v4 scale = lao_v4_make(300, 300, 0, 0);
        lao_v3 t = v3(cos(degrees * PI / 180), sin(degrees * PI / 180), 0);
        assert_near(alpha.x, fabs(cos(degrees * PI / 180)),
                    5e-4); /* Eq. 10: |t.x|, the square root loses half the digits at 0 */
        assert_near(alpha.y, 1, 0);
        unit = lao_axial_unit(lao_v2_make(a.x * 0.3f, a.y * 0.3f));
        assert_near(unit.x, a.x, 1e-6);
        assert_near(unit.y, a.y, 1e-6);
        a = lao_screen_axial(t, lao_v2_make(0, 0), scale, 1);
        assert_near(a.x, cos(degrees * PI / 90), 1e-6);
        assert_near(a.y, sin(degrees * PI / 90), 1e-6);
        a = lao_screen_axial(lao_v3_scale(t, -1), lao_v2_make(0, 0), scale,
                             1); /* no sign: an axis */
        assert_near(a.y, sin(degrees * PI / 90), 1e-6);
    }
    {
        lao_v2 none = lao_axial_alpha(lao_v2_make(0.1f, 0.1f));
        assert_true(none.x == 0 && none.y == 0);
        none = lao_axial_unit(lao_v2_make(0.001f, 0));
        assert_true(none.x == 0 && none.y == 0);
        none = lao_screen_axial(v3(0, 0, 1), lao_v2_make(0, 0), lao_v4_make(300, 300, 0, 0), 0);
        assert_true(none.x == 0 && none.y == 0); /* seen end-on */
        none = lao_alpha_mean(lao_v2_make(0.3f, 0.5f));
        assert_near(none.x, 0.6, 1e-6);
        assert_near(none.y, 0.5, 0);
        none = lao_alpha_mean(lao_v2_make(0, 0));
        assert_true(none.x == 0 && none.y == 0);
    }
    /* the direction of the projected tangent in pixels, by central difference in double precision
     */
    for (int i = 0; i < ROUNDS; i++) {
        double w = (double)any(200, 2000), h = (double)any(200, 2000), fx = (double)any(0.5, 2),
               fy = (double)any(0.5, 2);
        double x = (double)any(-3, 3), y = (double)any(-3, 3), z = (double)any(5, 50), e = 1e-4, dx,
               dy, l;
        lao_v3 t = any_unit();
        lao_v2 axial =
            lao_screen_axial(t, lao_v2_make((float)(x / z), (float)(y / z)),
                             lao_v4_make((float)(0.5 * w * fx), (float)(0.5 * h * fy), 0, 0), 0);
        dx = 0.5 * w * fx * ((x + e * t.x) / (z - e * t.z) - (x - e * t.x) / (z + e * t.z));
        dy = 0.5 * h * fy * ((y + e * t.y) / (z - e * t.z) - (y - e * t.y) / (z + e * t.z));
        l = dx * dx + dy * dy;
        if (sqrt(l) / (2 * e) * z > 20) { /* not end-on */
            assert_near(axial.x, (dx * dx - dy * dy) / l, 2e-4);
            assert_near(axial.y, 2 * dx * dy / l, 2e-4);
        }
    }
}

static lao_level_sum sum_of(const lao_v4 *texels, int count, float stencil) {
    lao_level_sum sum = lao_level_sum_start(v3(0, 0, 0));
    for (int i = 0; i < count; i++) {
        sum = lao_level_sum_add(sum, texels[i], v3(1, 0, 0), stencil);
    }
    return sum;
}

static void pyramid_averages_what_is_covered(void **state) {
    lao_v4 children[4], mean;
    float stencil = 0;
    (void)state;
    /* direction x, y; covered texels of level 0; depth */
    for (int i = 0; i < 4; i++) {
        children[i] = lao_v4_make(0.5f, -0.25f, 1, 0.375f);
    }
    mean = lao_level_sum_mean(
        sum_of(children, 4, 0.25f)); /* constant stays constant, on every level */
    for (int level = 1; level < 8; level++) {
        assert_near(mean.x, 0.5, 0);
        assert_near(mean.y, -0.25, 0);
        assert_near(mean.w, 0.375, 0);
        assert_near(mean.z, pow(4, level), 0); /* texels of level 0 below it */
        for (int i = 0; i < 4; i++) {
            children[i] = mean;
        }
        mean = lao_level_sum_mean(sum_of(children, 4, 0.25f));
    }
    for (int i = 0; i < 4; i++) {
        children[i] = lao_v4_make(0, 0, 1, (float)(i + 1));
    }
    mean = lao_level_sum_mean(sum_of(children, 4, 0.25f)); /* {1, 2, 3, 4} */
    assert_near(mean.w, 2.5, 0);
    assert_near(mean.z, 4, 0);
    children[2].z = children[3].z = 0; /* half mask */
    mean = lao_level_sum_mean(sum_of(children, 4, 0.25f));
    assert_near(mean.w, 1.5, 0);
    assert_near(mean.z, 2, 0);
    children[0].z = children[1].z = 0; /* nothing covered: far, no direction */
    mean = lao_level_sum_mean(sum_of(children, 4, 0.25f));
    assert_near(mean.w, 1, 0);
    assert_near(mean.z, 0, 0);
    assert_near(mean.x, 0, 0);
    /* [1 3 3 1] / 8, in two dimensions */
    for (int j = -1; j <= 2; j++) {
        for (int i = -1; i <= 2; i++) {
            stencil += lao_gauss_weight(i) * lao_gauss_weight(j);
        }
    }
    assert_near(stencil, 1, 0);
    assert_near(lao_gauss_weight(-1), 0.125, 0);
    assert_near(lao_gauss_weight(0), 0.375, 0);
    assert_near(lao_gauss_weight(1), 0.375, 0);
    assert_near(lao_gauss_weight(2), 0.125, 0);
    { /* tangents have no sign: opposite ones do not cancel */
        lao_level_sum sum = lao_level_sum_start(v3(0, 0, 0));
        sum = lao_level_sum_add(sum, lao_v4_make(0, 0, 1, 0), v3(0, 1, 0), 0.25f);
        sum = lao_level_sum_add(sum, lao_v4_make(0, 0, 1, 0), v3(0, -1, 0), 0.25f);
        sum = lao_level_sum_add(sum, lao_v4_make(0, 0, 2, 0), v3(0, -1, 0), 0.25f);
        assert_v3(sum.tangent, 0, 1, 0, 0);
    }
    { /* perpendicular axes cancel, equal ones stay, however they are signed */
        lao_v2 a = lao_v2_make(1, 0), b = axial_of(90), c = axial_of(180);
        lao_v2 r = lao_axial_unit(lao_v2_make(0.5f * (a.x + b.x), 0.5f * (a.y + b.y)));
        assert_near(r.x, 0, 1e-6);
        r = lao_axial_unit(lao_v2_make(0.5f * (a.x + c.x), 0.5f * (a.y + c.y)));
        assert_near(r.x, 1, 1e-6);
    }
}

/* The weight of a difference, which the shader takes beyond delta 0. */
static float depth_weight_of(float difference, float threshold, float slope) {
    return lao_depth_weight(difference - threshold, slope);
}

static void depth_weight(void **state) {
    const double d0 = 1e-4;
    float slope = lao_depth_weight_slope(1, 1e-4f), last = 1;
    (void)state;
    assert_near(lao_depth_reach(1, 0, 3), 1, 0);
    assert_near(lao_depth_reach(1, 1, 3), 4.0 / 9, 1e-7);
    assert_near(lao_depth_reach(1, 2, 3), 1.0 / 9, 1e-7);
    assert_near(lao_depth_reach(1, 0, 1), 1, 0); /* one level: no division by zero */
    assert_near(depth_weight_of(1e-4f, 1e-4f, slope), 1, 0);
    assert_near(depth_weight_of((float)((1 + d0) / 2), 1e-4f, slope), 0.5, 1e-6);
    assert_near(depth_weight_of(1, 1e-4f, slope), 0, 1e-6);
    assert_near(depth_weight_of(2, 1e-4f, slope), 0, 0);
    assert_near(depth_weight_of(-3, 1e-4f, slope), 1, 0);
    for (int i = 0; i <= 10000; i++) {
        float d = (float)i / 10000.0f, w = depth_weight_of(d, 1e-4f, slope);
        assert_true(w <= last + 1e-7f && w >= 0 && w <= 1); /* monotone */
        assert_near(w, 1 - hermite(((double)d - d0) / (1 - d0)), 1e-6);
        last = w;
    }
    for (int i = 0; i < ROUNDS; i++) {
        float density = any(0.001, 2), threshold = any(1e-7, 0.01), d = any(-1, 1);
        uint32_t levels = 1 + core_random(&seed) % 8, level = core_random(&seed) % levels;
        double t = 1 - (double)level / levels, reach = density * t * t, wanted;
        float r = lao_depth_reach(density, level, levels);
        assert_near(r, reach, 1e-6);
        if (fabs(reach - (double)threshold) < 1e-5) {
            continue;
        }
        wanted = reach <= (double)threshold ? (d <= threshold)
                 : (double)d > reach
                     ? 0
                     : 1 - hermite(((double)d - (double)threshold) / (reach - (double)threshold));
        assert_near(depth_weight_of(d, threshold, lao_depth_weight_slope(r, threshold)), wanted,
                    reach - (double)threshold < 0.01 ? 1e-2 : 1e-4);
    }
    for (int i = 0; i < 10; i++) { /* delta(l) <= delta 0: a hard step */
        float hard = lao_depth_weight_slope(0.001f * (float)i, 0.01f);
        assert_near(depth_weight_of(0.01f, 0.01f, hard), 1, 0);
        assert_near(depth_weight_of(-1, 0.01f, hard), 1, 0);
        assert_near(depth_weight_of(0.010001f, 0.01f, hard), 0, 0);
    }
}

/* The weight of light as the shader takes it: both cosines times what their vectors are scaled by.
 */
static float light_weight_of(float intensity, float diffuse, float specular, float nl,
                             float n_omega, float r_omega, int32_t exponent) {
    return lao_light_weight(n_omega * lao_light_diffuse(intensity, diffuse, nl),
                            r_omega * lao_light_specular(intensity, specular, exponent), exponent);
}

static void light_weight(void **state) {
    (void)state;
    /* I = 0.5, k_d = k_s = 1, m = 100 */
    assert_near(light_weight_of(0.5f, 1, 1, 1, 0, 0, 100), 1, 0);             /* omega across n */
    assert_near(light_weight_of(0.5f, 1, 1, 1, 1, 1, 100), 0, 2e-5);          /* n = l = omega */
    assert_near(light_weight_of(0.5f, 1, 1, 1, 0.5f, 0.5f, 100), 0.75, 1e-6); /* 60 degrees */
    assert_near(light_weight_of(0.5f, 1, 0, 1, 0.5f, 1, 100), 0.75, 1e-6);    /* no specular part */
    assert_near(light_weight_of(0.5f, 0, 0, 1, 1, 1, 100), 1, 0);             /* no light */
    assert_near(light_weight_of(1, 1, 1, 1, 1, 1, 100), 0, 0);                /* more than all */
    assert_true(lao_light_diffuse(0.5f, 1, 0) > 0); /* its products keep their sign */
    for (int i = 0; i < ROUNDS; i++) {
        lao_v3 n = any_unit(), l = any_unit(), omega = any_unit();
        double nl = dot(n, l), no = dot(n, omega), r, wanted;
        float g, kd = any(0, 1), ks = any(0, 1), intensity = any(0, 1);
        int32_t m = 1 + (int32_t)(core_random(&seed) % 200);
        lao_v3 reflected = v3(2 * nl * n.x - l.x, 2 * nl * n.y - l.y, 2 * nl * n.z - l.z);
        r = dot(reflected, omega) > 0 ? dot(reflected, omega) : 0;
        wanted = intensity * (kd * (nl > 0 ? nl : 0) * (no > 0 ? no : 0) + ks * pow(r, m));
        wanted = 1 - (wanted < 1 ? wanted : 1);
        g = light_weight_of(intensity, kd, ks, (float)(nl > 0 ? nl : 0), (float)(no > 0 ? no : 0),
                            (float)r, m);
        assert_near(g, wanted, 3e-5);
        assert_true(g >= 0 && g <= 1);
    }
}

/* The author's form: 1.5 - max(omega.n, 0)(spec + diff) with the reflection at the occluder. */
static void light_weight_of_the_author(void **state) {
    (void)state;
    assert_near(lao_light_weight_author(v3(0, 0, 1), 1, v3(0, 0, 0), v3(0, 0, 1), 100), 1.5,
                0); /* nothing there */
    assert_near(lao_light_weight_author(v3(0, 0, 1), 0, v3(1, 0, 0), v3(0, 0, 1), 100), 1.5,
                0); /* cosine 0 */
    assert_near(lao_light_weight_author(v3(0, 0, 1), 1, v3(1, 0, 0), v3(0, 0, 1), 100), 0,
                0); /* 1.5 - 2, not below 0 */
    for (int i = 0; i < ROUNDS; i++) {
        lao_v3 omega = any_unit(), t = any_unit(), l = any_unit();
        double no = (double)any(0, 1), to = dot(t, omega), n[3], h[3], nn, hh, diffuse, specular,
               wanted;
        int32_t m = 1 + (int32_t)(core_random(&seed) % 100);
        for (int k = 0; k < 3; k++) {
            n[k] = (double)(&omega.x)[k] - to * (double)(&t.x)[k];
            h[k] = (double)(&l.x)[k] + (double)(&omega.x)[k];
        }
        nn = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        hh = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
        if (nn < 0.02 || hh < 0.02) {
            continue;
        }
        diffuse = (n[0] * l.x + n[1] * l.y + n[2] * l.z) / nn;
        specular = (n[0] * h[0] + n[1] * h[1] + n[2] * h[2]) / (nn * hh);
        wanted = 1.5 - no * ((diffuse > 0 ? diffuse : 0) + pow(specular > 0 ? specular : 0, m));
        assert_near(lao_light_weight_author(omega, (float)no, t, l, m), wanted > 0 ? wanted : 0,
                    1e-3);
    }
}

static uint32_t word_of(double degrees) {
    return lao_level_pack(any(0, 1), axial_of(degrees), LAO_ALIGN_ROTATION);
}

static uint32_t alpha_word_of(double degrees) {
    return lao_level_pack(any(0, 1), lao_axial_alpha(axial_of(degrees)), LAO_ALIGN_PAPER);
}

static void alignment(void **state) {
    const float intensity = 15, least = 0.1f;
    const uint32_t horizontal = word_of(0), vertical = word_of(90), up = word_of(45),
                   down = word_of(-45), sixty = word_of(60);
    (void)state;
    assert_near(lao_align_weight(0, intensity, least), 0.1, 1e-8);
    assert_near(lao_align_weight(0.1f, intensity, least), 0.42, 1e-6);
    assert_near(lao_align_weight(0.5f, intensity, least), 1, 0);
    assert_near(lao_align_weight(0.157578f, intensity, least), 1, 1e-4);
    assert_true(lao_align_weight(0.15757f, intensity, least) < 1);
    assert_near(lao_align_weight(0.047912f, intensity, least), 0.1, 1e-4);
    assert_true(lao_align_weight(0.0480f, intensity, least) > least);
    for (int i = 0; i <= 1000; i++) {
        float x = (float)i / 1000.0f;
        assert_near(lao_align_weight(x, 0, least), 0.1, 1e-8); /* I = 0: the floor, always */
        assert_near(lao_align_weight(x, intensity, 1), 1, 0);  /* A0 = 1: classic */
        assert_near(lao_align_weight(x, intensity, least),
                    clamp(15 * hermite((double)x), (double)least, 1), 3e-6);
    }
    /* the paper's measure and its documented defect: mirror images count as parallel */
    assert_near(lao_alpha_difference(alpha_word_of(0), alpha_word_of(90)), 1, 1e-3);
    assert_near(lao_alpha_difference(alpha_word_of(45), alpha_word_of(-45)), 0, 1e-6);
    assert_near(lao_alpha_difference(alpha_word_of(60), alpha_word_of(0)), 0.5, 3e-4);
    /* ours */
    assert_near(lao_axial_difference(horizontal, vertical), 1, 1e-5);
    assert_near(lao_axial_difference(up, down), 1, 1e-5);
    assert_near(lao_axial_difference(sixty, horizontal), 0.5, 7e-4);
    for (uint32_t turn = 0; turn < 2048; turn++) { /* of two words, whatever their depth */
        uint32_t a = core_random(&seed), b = a + (turn << 21);
        double wanted = 1 - fabs(cos(PI * turn / 2048));
        b = (b & LAO_LEVEL_TURN) | (core_random(&seed) & ~LAO_LEVEL_TURN);
        assert_near(lao_axial_difference(a, b), wanted, 1e-5);
        assert_near(lao_axial_difference(b, a), wanted, 1e-5);
    }
    /* of lines: the steps of a word are at most 0.044 degrees off */
    for (int i = 0; i < ROUNDS; i++) {
        double a = (double)any(-180, 180), b = (double)any(-180, 180),
               turn = (double)any(-180, 180);
        double c = fabs(cos((a - b) * PI / 180)),
               alpha = fabs(fabs(cos(a * PI / 180)) - fabs(cos(b * PI / 180)));
        assert_near(lao_axial_difference(word_of(a), word_of(b)), 1 - c, 1.6e-3);
        assert_near(lao_alpha_difference(alpha_word_of(a), alpha_word_of(b)), alpha, 1e-3);
        assert_near(lao_axial_difference(word_of(a + turn), word_of(b + turn)), 1 - c,
                    1.6e-3); /* rotation-invariant */
        assert_near(lao_alpha_difference(alpha_word_of(0), alpha_word_of(b)),
                    1 - fabs(cos(b * PI / 180)), 1e-3); /* equal where one is horizontal */
    }
}

/* Eq. 1 with the corrected mean, from the shared factors: what shaders/occlusion.glsl sums. */
static double occlusion_of(int levels, float difference, double share, float strict) {
    double total = 0;
    for (int l = 0; l < levels; l++) {
        uint32_t n = lao_sample_count(32, (uint32_t)l);
        float slope =
            lao_depth_weight_slope(lao_depth_reach(1, (uint32_t)l, (uint32_t)levels), 1e-4f);
        double sum = 0;
        for (uint32_t i = 0; i < n; i++) {
            float d = (double)i < share * n ? difference : -1;
            float visible = d >= (strict > 0 ? 0.0f : 1e-4f) ? 1.0f : 0.0f;
            sum += (double)(visible * depth_weight_of(d, 1e-4f, slope) *
                            lao_light_weight(0, 0, 100) * lao_align_weight(0, 15, 1));
        }
        total += sum / n;
    }
    return total / levels;
}

static void accumulation(void **state) {
    (void)state;
    assert_near(occlusion_of(3, -0.1f, 1, 0), 0, 0); /* nothing in front */
    assert_near(occlusion_of(3, 1.0001e-4f, 1, 0), 1,
                1e-6); /* everything just in front, no light, no alignment */
    assert_near(occlusion_of(3, 1.0001e-4f, 0.5, 0), 0.5, 0.02); /* 11 samples have no half */
    assert_near(occlusion_of(1, 1.0001e-4f, 0.5, 0), 0.5, 1e-6);
    assert_near(occlusion_of(3, 0, 1, 0), 0, 0); /* a flat ribbon does not occlude itself ... */
    assert_near(occlusion_of(3, 0, 1, 1), 1, 0); /* ... unless asked to (strict_zero) */
}

static void show_singles_out_factors(void **state) {
    static const char wanted[9][5] = {"vdla", "vdla", "v---", "-d--", "--l-",
                                      "---a", "vd--", "vdl-", "vdla"};
    (void)state;
    for (int show = 0; show < 9; show++) {
        char got[5] = "----";
        got[0] = lao_uses_visibility(show) ? 'v' : '-';
        got[1] = lao_uses_depth(show) ? 'd' : '-';
        got[2] = lao_uses_light(show) ? 'l' : '-';
        got[3] = lao_uses_alignment(show) ? 'a' : '-';
        assert_string_equal(got, wanted[show]);
    }
}

static void shading(void **state) {
    lao_v3 c = v3(0.2, 0.4, 0.8), r;
    (void)state;
    assert_v3(lao_line_normal(v3(1, 0, 0), v3(0, 0, 1)), 0, 0, 1, 0);
    assert_v3(lao_line_normal(v3(0, 0, 1), v3(0.6, 0, 0.8)), 1, 0, 0, 1e-6);
    assert_near(lao_v3_dot(lao_line_normal(v3(0, 0, 1), v3(0.6, 0, 0.8)), v3(0.6, 0, 0.8)), 0.6,
                1e-6);
    r = lao_shade(c, v3(1, 0, 0), v3(0, 0, 1), 0.1f, 1, 1, 100,
                  0); /* n.l = 1: body 1.1, full highlight */
    assert_v3(r, 1, 1, 1, 0);
    r = lao_shade(c, v3(1, 0, 0), v3(0, 0, 1), 0.1f, 0.5f, 0, 100, 0.5f);
    assert_v3(r, 0.2 * 0.6 * 0.5, 0.4 * 0.6 * 0.5, 0.8 * 0.6 * 0.5, 1e-6);
    r = lao_shade(c, v3(0, 0, 1), v3(0, 0, 1), 0.1f, 1, 1, 100, 0); /* end-on: ambient alone */
    assert_v3(r, 0.02, 0.04, 0.08, 1e-6);
    assert_v3(lao_shade(c, v3(1, 0, 0), v3(0, 0, 1), 0.1f, 1, 1, 100, 7), 0, 0, 0, 0);
    for (int i = 0; i < ROUNDS; i++) {
        lao_v3 t = any_unit(), l = any_unit(), n = lao_line_normal(t, l);
        double tl = dot(t, l), s = sqrt(1 - tl * tl), ka = (double)any(0, 1),
               kd = (double)any(0, 2), ks = (double)any(0, 2), ao = (double)any(0, 1), rl;
        int32_t m = 1 + (int32_t)(core_random(&seed) % 100);
        if (s > 0.02) {
            assert_near(dot(n, l), s, 1e-4); /* n.l = sqrt(1 - (l.t)^2) >= 0 */
            assert_near(dot(n, t), 0, 1e-4);
            rl = 2 * s * s - 1;
            rl = ks * pow(rl > 0 ? rl : 0, m);
            r = lao_shade(c, t, l, (float)ka, (float)kd, (float)ks, m, (float)ao);
            for (int k = 0; k < 3; k++) {
                assert_near((&r.x)[k], clamp(((&c.x)[k] * (ka + kd * s) + rl) * (1 - ao), 0, 1),
                            1e-3);
            }
        }
        assert_near(length(n), 1, 1e-5);
    }
    { /* premultiplied samples over a premultiplied background */
        lao_v4 v = lao_over(lao_v4_make(2, 1, 0, 2), 4, lao_v4_make(0.25f, 0.5f, 0.75f, 1));
        assert_near(v.x, 0.5 + 0.125, 1e-7);
        assert_near(v.y, 0.25 + 0.25, 1e-7);
        assert_near(v.z, 0.375, 1e-7);
        assert_near(v.w, 1, 1e-7);
        v = lao_over(lao_v4_make(0, 0, 0, 0), 4, lao_v4_make(0.1f, 0.2f, 0.3f, 0.4f));
        assert_near(v.w, 0.4, 1e-7);
        assert_near(v.x, 0.1, 1e-7);
    }
}

/* Depth of the frame's uniforms: window depth to millimetres (Eq. 15 corrected) through lao_render
 * itself. */
static void depth_is_linearised(void **state) {
    core_host host;
    lao_desc desc;
    lao_backend backend = core_backend(0);
    lao_context *context;
    lao_view_desc size = {640, 480, 0};
    lao_frame frame;
    (void)state;
    memset(&host, 0, sizeof host);
    memset(&desc, 0, sizeof desc);
    memset(&frame, 0, sizeof frame);
    core_window_clear();
    desc.backend = &backend;
    desc.logger = core_logger(&host);
    assert_int_equal(lao_create(&desc, &context), LAO_OK);
    assert_int_equal(lao_view_create(context, &size, &frame.view), LAO_OK);
    for (int mode = 0; mode < 16; mode++) {
        const double n = 1, f = 100;
        int reverse = mode & 1, negative = mode & 2, flip = mode & 4, ortho = mode & 8;
        const lao_frame_uniforms *u = &core_seen.frame;
        double a, b; /* depth row: a z + b, z negative */
        frame.camera = core_camera();
        frame.camera.flags = (negative ? 0u : LAO_CAMERA_ZERO_TO_ONE) |
                             (reverse ? LAO_CAMERA_REVERSE_DEPTH : 0u) |
                             (flip ? LAO_CAMERA_FLIP_Y : 0u);
        if (ortho) {
            a = -1 / (f - n);
            b = -n / (f - n);
            frame.camera.projection[11] = 0;
            frame.camera.projection[15] = 1;
            frame.camera.projection[0] = frame.camera.projection[5] = 0.1f;
        } else {
            a = -f / (f - n);
            b = -n * f / (f - n);
        }
        if (reverse) { /* d -> 1 - d */
            a = ortho ? -a : -1 - a;
            b = ortho ? 1 - b : -b;
        }
        if (negative) { /* d -> 2 d - 1 */
            a = ortho ? 2 * a : 2 * a + 1;
            b = ortho ? 2 * b - 1 : 2 * b;
        }
        frame.camera.projection[10] = (float)a;
        frame.camera.projection[14] = (float)b;
        frame.camera.projection[5] *= flip ? -1.0f : 1.0f;
        frame.sphere[0] = 3;
        frame.sphere[2] = -40;
        frame.sphere[3] = 20;
        assert_int_equal(lao_render(context, &frame), LAO_OK);
        for (int i = 0; i <= 100; i++) {
            double d = i / 100.0, forward = reverse ? 1 - d : d;
            double wanted = ortho ? n + forward * (f - n) : n * f / (f - forward * (f - n));
            double z = ((double)u->unproject.x + (double)u->unproject.y * d) /
                       ((double)u->unproject.z + (double)u->unproject.w * d);
            assert_near(z, wanted, 2e-5 * wanted * wanted + 1e-4);
        }
        assert_near(u->depth.x, 20, 1e-4); /* z_c - R */
        assert_near(u->depth.y, 1.0 / 40, 1e-6);
        assert_near(u->depth.z, 40, 1e-4);
        assert_near(u->depth.w, ortho != 0, 0);
        assert_near(u->scale.z, reverse, 0);
        assert_near(u->viewport.x, 1280, 0); /* supersampling 2 */
        assert_near(u->viewport.y, 960, 0);
        for (int i = 0; i < 200; i++) { /* a pixel's ray meets the point that projects there */
            lao_v3 p = v3(any(-9, 9), any(-9, 9), any(-90, -10));
            lao_v4 clip = lao_project(u->projection, p);
            double px = (0.5 * clip.x / clip.w + 0.5) * 1280,
                   py = (0.5 * clip.y / clip.w + 0.5) * 960;
            lao_v2 slope = lao_pixel_slope(u->ray, (float)px, (float)py);
            double k = ortho ? 1 : -(double)p.z;
            assert_near(slope.x * k, p.x, 2e-4);
            assert_near(slope.y * k, p.y, 2e-4);
            assert_true(clip.w > 0 && clip.y * p.y >= 0); /* y up, whatever the host's clip space */
        }
        if (!ortho) { /* pixels per mm from depth alone agree with the zoom on the axis */
            float d = lao_scene_depth(u->depth, 35);
            assert_near(lao_pixel_zoom(u->scale, u->depth, d),
                        lao_zoom(u->projection, u->viewport, v3(0, 0, -35), v3(0, 1, 0)), 1e-3);
        }
    }
    assert_int_equal(host.logs, 0);
    lao_destroy(context);
}

/* The printed numbers of METHODS 1.3. */
static void depth_oracles(void **state) {
    const double n = 1, f = 100;
    (void)state;
    assert_near(n * f / (f - 0.5 * (f - n)), 1.98019801980198, 1e-12);
    for (int i = 0; i <= 1000; i++) {
        double d = i / 1000.0, z = n * f / (f - d * (f - n)), zn = 2 * d - 1;
        assert_near(2 * n * f / (f + n - zn * (f - n)), z, 1e-12 * z * f);
        assert_near(f * (z - n) / (z * (f - n)), d, 1e-12);
    }
}

static int finite(const void *values, size_t count) {
    const float *f = (const float *)values;
    for (size_t i = 0; i < count; i++) {
        if (!(f[i] - f[i] == 0)) {
            return 0;
        }
    }
    return 1;
}
#define assert_finite(value) assert_true(finite(&(value), sizeof(value) / sizeof(float)))

/* Zeros, ends of ranges and tiny numbers among ordinary ones. */
static float odd(double low, double high) {
    static const float special[] = {0.0f, -0.0f, 1.0f, -1.0f, 1e-20f, -1e-20f, 1e-12f, 0.5f};
    uint32_t r = core_random(&seed);
    if (r % 3 == 0) {
        float s = special[(r >> 8) % 8];
        return (double)s < low ? (float)low : (double)s > high ? (float)high : s;
    }
    return r % 3 == 1 ? any(low, high) : (r & 256) != 0 ? (float)low : (float)high;
}
static lao_v3 odd_v3(double size) {
    return lao_v3_make(odd(-size, size), odd(-size, size), odd(-size, size));
}
static lao_v2 odd_v2(double size) {
    return lao_v2_make(odd(-size, size), odd(-size, size));
}

static void everything_is_total(void **state) {
    (void)state;
    for (int i = 0; i < 60000; i++) {
        lao_v3 a = odd_v3(1e4), b = odd_v3(1e4), c = odd_v3(1);
        lao_v2 p = odd_v2(1);
        float s = odd(-1000, 1000), u = odd(0, 1), r;
        uint32_t n = core_random(&seed) % 9;
        int32_t m = (int32_t)(core_random(&seed) % 1024);
        lao_v3 v;
        lao_v2 w;
        lao_v4 t;
        lao_level_sum sum;
        lao_line_end end;
        lao_sampler sampler;
        lao_tap tap;
        v = lao_v3_unit(a, c);
        assert_finite(v);
        v = lao_line_normal(c, a);
        assert_finite(v);
        v = lao_line_normal(lao_v3_unit(a, c), lao_v3_unit(b, c));
        assert_finite(v);
        end = lao_line_join(a, b, c, odd(0, 500), i % 2 ? 1.0f : -1.0f);
        assert_finite(end);
        end = lao_line_join(c, b, lao_v3_scale(b, odd(-1, 1)), u,
                            1); /* straight on, and straight back */
        assert_finite(end);
        end = lao_line_join(b, b, b, u, 1); /* end-on */
        assert_finite(end);
        w = lao_screen_axial(c, p, lao_v4_make(odd(-4000, 4000), s, 0, 0), (float)(i % 2));
        assert_finite(w);
        w = lao_axial_alpha(p);
        assert_finite(w);
        w = lao_axial_unit(p);
        assert_finite(w);
        w = lao_alpha_mean(lao_v2_make(u, odd(0, 1)));
        assert_finite(w);
        r = lao_axial_difference(core_random(&seed), core_random(&seed));
        assert_true(r >= 0 && r <= 1.00001f);
        r = lao_align_weight(r, odd(0, 100), u);
        assert_true(r >= 0 && r <= 1);
        r = lao_alpha_difference(core_random(&seed), core_random(&seed));
        assert_true(r >= 0 && r <= 1);
        r = lao_depth_reach(odd(0.001, 2), n % 8, n % 8 + 1);
        r = lao_depth_weight(odd(-1, 1), lao_depth_weight_slope(r, odd(1e-7, 0.01)));
        assert_finite(r);
        assert_true(r >= 0 && r <= 1);
        r = lao_light_weight(u, odd(-1, 1), m);
        assert_true(r >= 0 && r <= 1);
        r = lao_light_weight_author(c, u, b, a, m);
        assert_finite(r);
        sampler = lao_sampler_make(c, a, b, odd(0, 1e5), 1.0f / (float)(1 << (n % 8)), odd(0, 1e4),
                                   odd(0, 1e4));
        assert_finite(sampler);
        tap = lao_tap_make(sampler, c, lao_v2_make(0.01f, 0.01f));
        assert_true(isfinite(tap.x) && isfinite(tap.y) && isfinite(tap.at.x) &&
                    isfinite(tap.at.y) && isfinite(tap.n_omega) && isfinite(tap.r_omega));
        assert_true((lao_level_pack(s, p, i % 3) & LAO_LEVEL_NEAREST) != 0);
        w = lao_level_direction(core_random(&seed), i % 3);
        assert_true(w.x * w.x <= 1.00001f && w.y * w.y <= 1.00001f);
        t = lao_level_child(core_random(&seed), i % 3);
        assert_finite(t);
        assert_true(t.w >= 0 && t.w <= 1);
        sum = lao_level_sum_start(v3(0, 0, 0));
        for (uint32_t k = 0; k < n; k++) {
            sum = lao_level_sum_add(sum,
                                    lao_v4_make(odd(-1, 1), odd(-1, 1), k % 2 ? 0 : odd(0, 1e4), u),
                                    odd_v3(1), lao_gauss_weight((int32_t)k - 2));
        }
        t = lao_level_sum_mean(sum);
        assert_finite(t);
        v = lao_shade(c, lao_v3_unit(a, v3(1, 0, 0)), lao_v3_unit(b, v3(0, 0, 1)), u, u, u, m, s);
        assert_finite(v);
        r = lao_exp2(s * 1e6f);
        assert_finite(r);
        r = lao_log2(s);
        assert_finite(r);
        r = lao_atan2(a.x, a.y);
        assert_finite(r);
        r = lao_acos(a.x);
        assert_finite(r);
        r = lao_srgb_decode(u);
        assert_finite(r);
        r = lao_pixel_zoom(lao_v4_make(0, s, 0, 0), lao_v4_make(s, 1, a.x, (float)(i % 2)), u);
        assert_finite(r);
        r = lao_scene_depth(lao_v4_make(s, 1e3f, 0, 0), a.x);
        assert_true(r >= 0 && r <= 1);
        v = lao_towards_eye(odd_v2(1e4), (float)(i % 2));
        assert_near(length(v), 1, 1e-6);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vectors_and_matrices),
        cmocka_unit_test(elementary_functions_keep_their_bounds),
        cmocka_unit_test(noise_is_uniform_and_has_no_tiles),
        cmocka_unit_test(sample_counts_and_directions),
        cmocka_unit_test(mirrors_are_isometries),
        cmocka_unit_test(taps_are_the_mirrored_samples),
        cmocka_unit_test(radii),
        cmocka_unit_test(zoom_is_pixels_per_millimetre),
        cmocka_unit_test(depths_and_rays),
        cmocka_unit_test(texels_come_back),
        cmocka_unit_test(axial_directions),
        cmocka_unit_test(pyramid_averages_what_is_covered),
        cmocka_unit_test(depth_weight),
        cmocka_unit_test(light_weight),
        cmocka_unit_test(light_weight_of_the_author),
        cmocka_unit_test(alignment),
        cmocka_unit_test(accumulation),
        cmocka_unit_test(show_singles_out_factors),
        cmocka_unit_test(shading),
        cmocka_unit_test(depth_is_linearised),
        cmocka_unit_test(depth_oracles),
        cmocka_unit_test(everything_is_total),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
