/* Proves that velocities are interpolated as METHODS 11.2 says (linear fields exactly, periodic in
 * time, the mean half-way between frames), that masks, vorticity, the temporal maximum and its
 * projection are what they are said to be, and that what cannot be is refused with one message. */
#include "flow_host.h"
#include "flow_phantom.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* An oblique, mirrored lattice: nothing is aligned, edges differ. */
static const double oblique[12] = {1.7, 0.4, -0.2, -11.0, -0.3, -1.9, 0.5, 7.0, 0.2, 0.6, 2.8, 3.0};

static double uniform(uint32_t *state) {
    return (double)(*state = lao_hash(*state + 1)) / 4294967296.0;
}

/* v = m (x, 1), rows of a 3x4 matrix */
static void linear(const double m[12], const double p[3], double v[3]) {
    for (size_t i = 0; i < 3; i++)
        v[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
}

/* Dyadic slopes and an axis-aligned lattice: floats hold the field exactly. */
static const double slopes[12] = {0.5, -0.25, 0.125, 1, 0.25, 0.75, -0.5, -2, 1, 0.5, -0.125, 3};

enum { X = 7, Y = 5, Z = 6, FRAMES = 4, VOXELS = X * Y * Z };

static void fill(const flow4d_sampler *s, float *velocity, const double scale[FRAMES]) {
    for (int f = 0; f < FRAMES; f++) {
        for (int i = 0; i < VOXELS; i++) {
            int row = i / X, slice = i / (X * Y);
            double g[3] = {i % X, row % Y, slice}, p[3], v[3];
            flow4d_to_world(s, g, p);
            linear(slopes, p, v);
            for (int c = 0; c < 3; c++)
                velocity[3 * (f * VOXELS + i) + c] = (float)(scale[f] * v[c]);
        }
    }
}

static void linear_fields_are_exact(void **state) {
    (void)state;
    static float velocity[3 * VOXELS * FRAMES];
    static const double same[FRAMES] = {1, 1, 1, 1};
    uint32_t seed = 1;
    for (int mapped = 0; mapped < 2; mapped++) {
        flow4d_field field;
        flow4d_sampler s;
        flow_lattice(&field, X, Y, Z, 2.0, -3.0);
        if (mapped)
            memcpy(field.to_world, oblique, sizeof oblique);
        field.velocity = velocity;
        field.frame_count = FRAMES;
        field.period = 800;
        assert_int_equal(flow4d_sampler_make(NULL, &field, &s), LAO_OK);
        fill(&s, velocity, same);
        for (int k = 0; k < 2000; k++) {
            double g[3] = {uniform(&seed) * (X - 1), uniform(&seed) * (Y - 1),
                           uniform(&seed) * (Z - 1)};
            double p[3], v[3], expected[3], back[3], bound = mapped ? 3e-6 : 1e-13;
            flow4d_to_world(&s, g, p);
            flow4d_from_world(&s, p, back);
            flow4d_sample(&s, p, 4000 * uniform(&seed) - 2000, v);
            linear(slopes, p, expected);
            for (int c = 0; c < 3; c++) {
                assert_true(fabs(back[c] - g[c]) < 1e-12);
                assert_true(fabs(v[c] - expected[c]) < bound);
            }
        }
    }
}

static void time_is_periodic_and_linear(void **state) {
    (void)state;
    static float velocity[3 * VOXELS * FRAMES];
    static const double scale[FRAMES] = {1, 3, -2, 0.5};
    flow4d_field field;
    flow4d_sampler s;
    uint32_t seed = 2;
    flow_lattice(&field, X, Y, Z, 2.0, 0.0);
    field.velocity = velocity;
    field.frame_count = FRAMES;
    field.period = 800;
    flow4d_sampler_make(NULL, &field, &s);
    fill(&s, velocity, scale);
    for (int k = 0; k < 200; k++) {
        double p[3] = {12 * uniform(&seed), 8 * uniform(&seed), 10 * uniform(&seed)};
        double a[3], b[3], c[3], whole = 50.0 * floor(16 * uniform(&seed)), base[3];
        linear(slopes, p, base);
        flow4d_sample(&s, p, whole, a);
        flow4d_sample(&s, p, whole + 800, b);
        flow4d_sample(&s, p, whole - 8000, c);
        assert_memory_equal(a, b, sizeof a);
        assert_memory_equal(a, c, sizeof a);
        for (int f = 0; f < FRAMES; f++) { /* frames, and half-way to the next */
            double next = scale[(f + 1) % FRAMES];
            flow4d_sample(&s, p, 200.0 * f, a);
            flow4d_sample(&s, p, 200.0 * f + 100, b);
            for (int i = 0; i < 3; i++) {
                assert_true(fabs(a[i] - scale[f] * base[i]) < 1e-12);
                assert_true(fabs(b[i] - 0.5 * (scale[f] + next) * base[i]) < 1e-12);
            }
        }
    }
    double p[3] = {1, 2, 3}, a[3], b[3];
    flow4d_sample(&s, p, 0.0, a);
    flow4d_sample(&s, p, -1e-300, b); /* rounds to a whole cycle */
    assert_memory_equal(a, b, sizeof a);
}

static void outside_is_clamped_and_nan_stays_nan(void **state) {
    (void)state;
    float velocity[2 * 3] = {1, 2, 3, 5, 6, 7};
    flow4d_field field;
    flow4d_sampler s;
    flow_lattice(&field, 2, 1, 1, 1.0, 0.0);
    field.velocity = velocity;
    field.frame_count = 1;
    assert_int_equal(flow4d_sampler_make(NULL, &field, &s), LAO_OK);
    double p[3] = {-9, 4, 4}, v[3];
    flow4d_sample(&s, p, 12345.0, v); /* steady: any time */
    assert_true(v[0] == 1.0 && v[1] == 2.0 && v[2] == 3.0);
    p[0] = 1e30;
    flow4d_sample(&s, p, 0.0, v);
    assert_true(v[0] == 5.0 && v[1] == 6.0 && v[2] == 7.0);
    p[0] = 0.5;
    flow4d_sample(&s, p, 0.0, v);
    assert_true(v[0] == 3.0);
    flow4d_sample(&s, p, (double)NAN, v);
    assert_true(isnan(v[0]) && isnan(v[1]) && isnan(v[2]));
    p[1] = (double)INFINITY;
    flow4d_sample(&s, p, 0.0, v);
    assert_true(isnan(v[0]));
    flow4d_vorticity(&s, p, 0.0, v);
    assert_true(isnan(v[0]));
    velocity[3] = NAN; /* the other voxel is unknown: known at the first one's centre only */
    p[0] = 0.0;
    p[1] = 0.0;
    flow4d_sample(&s, p, 0.0, v);
    assert_true(v[0] == 1.0);
    p[0] = 0.01;
    flow4d_sample(&s, p, 0.0, v);
    assert_true(isnan(v[0]) && !isnan(v[1]));
}

static int right_half(void *user, const double p[3]) {
    return p[0] >= *(double *)user;
}

static void masks_hold(void **state) {
    (void)state;
    static const float velocity[3 * 8] = {0};
    uint8_t mask[8] = {0, 1, 0, 0, 0, 0, 0, 7}; /* voxels (1, 0, 0) and (1, 1, 1) */
    flow4d_field field;
    flow4d_sampler s;
    flow_lattice(&field, 2, 2, 2, 1.0, 0.0);
    field.velocity = velocity;
    field.frame_count = 1;
    field.mask = mask;
    flow4d_sampler_make(NULL, &field, &s);
    static const struct {
        double p[3];
        int nearest, trilinear, none;
    } rows[] = {
        {{1, 0, 0}, 1, 1, 1},         {{0, 0, 0}, 0, 0, 1},          {{0.49, 0, 0}, 0, 0, 1},
        {{0.51, 0, 0}, 1, 1, 1},      {{0.5, 0, 0}, 1, 1, 1},        {{0.51, 0.4, 0.4}, 1, 0, 1},
        {{1.5, -0.5, -0.5}, 1, 1, 1}, {{1.51, 0, 0}, 0, 0, 0},       {{1, 0, -0.51}, 0, 0, 0},
        {{1.5, 1.5, 1.5}, 1, 1, 1},   {{(double)NAN, 0, 0}, 0, 0, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(!!flow4d_inside(&s, rows[i].p, FLOW4D_MASK_NEAREST), rows[i].nearest);
        assert_int_equal(!!flow4d_inside(&s, rows[i].p, FLOW4D_MASK_TRILINEAR), rows[i].trilinear);
        assert_int_equal(!!flow4d_inside(&s, rows[i].p, FLOW4D_MASK_NONE), rows[i].none);
    }
    double limit = 1.2, a[3] = {1.1, 0, 0}, b[3] = {1.3, 0, 0};
    s.field.inside_at = right_half;
    s.field.user = &limit;
    assert_false(flow4d_inside(&s, a, FLOW4D_MASK_NEAREST));
    assert_true(flow4d_inside(&s, b, FLOW4D_MASK_NEAREST));
    assert_false(flow4d_inside(&s, a, FLOW4D_MASK_NONE));
}

static void linear_at(void *user, const double p[3], double time, double v[3]) {
    (void)user;
    (void)time;
    linear(slopes, p, v);
}

/* curl of slopes x, 1/s; arrays in the middle and at the border, functions */
static void vorticity_of_linear_fields_is_exact(void **state) {
    (void)state;
    static float velocity[3 * VOXELS * FRAMES];
    static const double same[FRAMES] = {1, 1, 1, 1};
    const double expected[3] = {1000 * (slopes[9] - slopes[6]), 1000 * (slopes[2] - slopes[8]),
                                1000 * (slopes[4] - slopes[1])};
    uint32_t seed = 3;
    for (int kind = 0; kind < 3; kind++) {
        flow4d_field field;
        flow4d_sampler s;
        flow_lattice(&field, X, Y, Z, 2.0, -3.0);
        if (kind > 0)
            memcpy(field.to_world, oblique, sizeof oblique);
        field.velocity = velocity;
        field.frame_count = FRAMES;
        field.period = 800;
        field.velocity_at = kind == 2 ? linear_at : NULL;
        flow4d_sampler_make(NULL, &field, &s);
        fill(&s, velocity, same);
        for (int k = 0; k < 500; k++) {
            double g[3] = {uniform(&seed) * (X - 1), uniform(&seed) * (Y - 1),
                           uniform(&seed) * (Z - 1)};
            double p[3], w[3];
            flow4d_to_world(&s, g, p);
            flow4d_vorticity(&s, p, 77.0, w);
            for (int c = 0; c < 3; c++)
                assert_true(fabs(w[c] - expected[c]) < (kind == 1 ? 5e-3 : 1e-8));
        }
    }
    flow4d_field flat; /* one voxel along two axes: constant along them, no curl from there */
    flow4d_sampler s;
    double p[3] = {0.5, 0, 0}, w[3];
    flow_lattice(&flat, 2, 1, 1, 1.0, 0.0);
    velocity[0] = velocity[1] = velocity[2] = 0;
    velocity[3] = 1, velocity[4] = 2, velocity[5] = 3;
    flat.velocity = velocity;
    flat.frame_count = 1;
    flow4d_sampler_make(NULL, &flat, &s);
    flow4d_vorticity(&s, p, 0, w);
    assert_true(w[0] == 0.0 && w[1] == -3000.0 && w[2] == 2000.0);
    p[0] = 40; /* beyond the border, where the field is constant */
    flow4d_vorticity(&s, p, 0, w);
    assert_true(w[0] == 0.0 && w[1] == 0.0 && w[2] == 0.0);
}

static void check_refused(const flow4d_field *field, flow4d_log_item item) {
    flow_host h;
    flow4d_sampler s, before;
    flow_host_make(&h, 0);
    memset(&s, 0x5a, sizeof s);
    before = s;
    assert_int_not_equal(flow4d_sampler_make(&h.host, field, &s), LAO_OK);
    assert_memory_equal(&s, &before, sizeof s);
    assert_int_equal(h.failures, 1);
    assert_int_equal(h.last_item, item);
    assert_true(strlen(h.last_text) > 20);
    assert_int_not_equal(flow4d_field_check(NULL, field), LAO_OK);
    assert_int_equal(h.failures, 1);
}

static void bad_fields_are_refused(void **state) {
    (void)state;
    static const float velocity[3 * 8 * 2] = {0};
    flow4d_field good, f;
    flow_lattice(&good, 2, 2, 2, 1.0, 0.0);
    good.velocity = velocity;
    good.frame_count = 2;
    good.period = 100;
    assert_int_equal(flow4d_field_check(NULL, &good), LAO_OK);
    check_refused(NULL, FLOW4D_LOG_NULL_ARGUMENT);
    for (int a = 0; a < 3; a++) {
        f = good;
        f.size[a] = 0;
        check_refused(&f, FLOW4D_LOG_SIZE);
        f.size[a] = 0xffffffffu; /* times the rest fits 64 bits, but not with a second one */
        f.size[(a + 1) % 3] = 0xffffffffu;
        check_refused(&f, FLOW4D_LOG_SIZE);
    }
    f = good;
    f.frame_count = 0;
    check_refused(&f, FLOW4D_LOG_SIZE);
    f = good;
    f.velocity = NULL;
    check_refused(&f, FLOW4D_LOG_VELOCITY);
    static const double periods[] = {0.0, -1.0, (double)NAN, (double)INFINITY};
    for (int i = 0; i < 4; i++) {
        f = good;
        f.period = periods[i];
        check_refused(&f, FLOW4D_LOG_PERIOD);
    }
    f.period = 0.0;
    f.frame_count = 1;
    assert_int_equal(flow4d_field_check(NULL, &f), LAO_OK);
    for (int i = 0; i < 12; i++) {
        f = good;
        f.to_world[i] = i % 2 ? (double)NAN : (double)INFINITY;
        check_refused(&f, FLOW4D_LOG_AFFINE);
    }
    f = good;
    f.to_world[0] = 0.0;
    check_refused(&f, FLOW4D_LOG_AFFINE);
    f = good; /* two axes that are parallel but for rounding */
    memcpy(f.to_world, (const double[]){1, 1, 0, 0, 1, 1 + 1e-15, 0, 0, 0, 0, 1, 0},
           sizeof f.to_world);
    check_refused(&f, FLOW4D_LOG_AFFINE);
    f.to_world[0] = 1e-9; /* small voxels are fine: the test is relative */
    f.to_world[1] = f.to_world[4] = 0;
    f.to_world[5] = f.to_world[10] = 1e-9;
    assert_int_equal(flow4d_field_check(NULL, &f), LAO_OK);
}

static void the_maximum_is_over_time(void **state) {
    (void)state;
    static float velocity[3 * VOXELS * FRAMES], values[VOXELS];
    uint32_t seed = 4;
    flow4d_field field;
    flow_host h;
    flow_host_make(&h, 3);
    flow_lattice(&field, X, Y, Z, 2.0, 0.0);
    field.velocity = velocity;
    field.frame_count = FRAMES;
    field.period = 800;
    for (int i = 0; i < 3 * VOXELS * FRAMES; i++)
        velocity[i] = (float)uniform(&seed) - 0.5f;
    velocity[0] = NAN;
    for (size_t f = 0; f < FRAMES; f++)
        velocity[3 * (f * VOXELS + 1)] = f % 2 ? NAN : INFINITY;
    assert_int_equal(flow4d_temporal_maximum(&h.host, &field, values), LAO_OK);
    assert_true(values[1] == 0.0f);
    double greatest = 0;
    for (size_t i = 0; i < VOXELS; i++) {
        float expected = 0;
        for (size_t f = 0; f < FRAMES; f++) {
            const float *v = velocity + 3 * (f * VOXELS + i);
            double speed = sqrt((double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] +
                                (double)v[2] * (double)v[2]);
            if (isfinite(speed) && (float)speed > expected)
                expected = (float)speed;
            if (isfinite(speed) && speed > greatest)
                greatest = speed;
        }
        assert_true(values[i] == expected);
    }
    flow4d_sampler s;
    flow4d_sampler_make(NULL, &field, &s);
    assert_true(flow4d_max_speed(&s) == greatest);
    h.cancel_at = h.progress_calls + 1;
    assert_int_equal(flow4d_temporal_maximum(&h.host, &field, values), LAO_ERROR_NOT_READY);
    assert_int_equal(h.last_item, FLOW4D_LOG_CANCELLED);
    assert_int_equal(flow4d_temporal_maximum(&h.host, &field, NULL), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(h.failures, 2);
    assert_int_equal(h.allocations, 0);
}

/* ---- projection --------------------------------------------------------------------------- */

static const float turned[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -50, 1};

static lao_camera orthographic(void) { /* 40 mm high and wide, from z = 50 along -z */
    lao_camera c;
    memset(&c, 0, sizeof c);
    memcpy(c.view, turned, sizeof turned);
    c.projection[0] = c.projection[5] = 1.0f / 20;
    c.projection[10] = -2.0f / 99;
    c.projection[14] = -101.0f / 99;
    c.projection[15] = 1;
    return c;
}

static lao_camera perspective(double near, double far) {
    lao_camera c;
    memset(&c, 0, sizeof c);
    memcpy(c.view, turned, sizeof turned);
    c.projection[0] = c.projection[5] = 2.0f;
    c.projection[10] = (float)((near + far) / (near - far));
    c.projection[14] = (float)(2 * near * far / (near - far));
    c.projection[11] = -1;
    return c;
}

static float *project(const flow4d_volume *volume, const lao_camera *camera, uint32_t w,
                      uint32_t h) {
    float *image = malloc(sizeof *image * w * h);
    assert_non_null(image);
    assert_int_equal(flow4d_project_maximum(NULL, volume, camera, w, h, image), LAO_OK);
    return image;
}

static void a_box_projects_to_its_outline(void **state) {
    (void)state;
    float values[4 * 4 * 4];
    flow4d_field lattice;
    flow4d_volume volume;
    memset(&volume, 0, sizeof volume);
    flow_lattice(&lattice, 4, 4, 4, 2.0, -3.0); /* the box from -4 to 4 */
    memcpy(volume.size, lattice.size, sizeof volume.size);
    memcpy(volume.to_world, lattice.to_world, sizeof volume.to_world);
    volume.values = values;
    for (int i = 0; i < 64; i++)
        values[i] = 0.75f;
    lao_camera c = orthographic();
    float *image = project(&volume, &c, 40, 40); /* a pixel is 1 mm */
    for (int y = 0; y < 40; y++) {
        for (int x = 0; x < 40; x++) {
            bool in = x >= 16 && x < 24 && y >= 16 && y < 24;
            assert_true(fabsf(image[40 * y + x] - (in ? 0.75f : 0.0f)) < 1e-6f);
        }
    }
    free(image);
    c = perspective(1, 100); /* at distance 46 the front face is 2 * 4 / 46 of the width: +-3.48 */
    image = project(&volume, &c, 40, 40);
    int covered = 0;
    for (int i = 0; i < 1600; i++)
        covered += image[i] > 0.0f;
    assert_int_equal(covered, 36);
    free(image);
    c = perspective(60, 100); /* the box is in front of the near plane */
    image = project(&volume, &c, 8, 8);
    for (int i = 0; i < 64; i++)
        assert_true(image[i] == 0.0f);
    free(image);
}

/* The same camera in another convention. */
static lao_camera reword(const lao_camera *camera, uint32_t flags) {
    lao_camera c = *camera;
    c.flags = flags;
    for (size_t col = 0; col < 4; col++) {
        float *p = &c.projection[4 * col];
        if (flags & LAO_CAMERA_ZERO_TO_ONE)
            p[2] = 0.5f * (p[2] + p[3]);
        if (flags & LAO_CAMERA_REVERSE_DEPTH)
            p[2] = flags & LAO_CAMERA_ZERO_TO_ONE ? p[3] - p[2] : -p[2];
        if (flags & LAO_CAMERA_FLIP_Y)
            p[1] = -p[1];
    }
    return c;
}

/* A bright voxel at (3, 2, -2) appears where the camera puts it, in every convention, and not at
 * all where it is in front of the near plane. */
static void conventions_agree(void **state) {
    (void)state;
    static float values[9 * 9 * 9];
    flow4d_field lattice;
    flow4d_volume volume;
    memset(&volume, 0, sizeof volume);
    flow_lattice(&lattice, 9, 9, 9, 1.0, -4.0);
    memcpy(volume.size, lattice.size, sizeof volume.size);
    memcpy(volume.to_world, lattice.to_world, sizeof volume.to_world);
    volume.values = values;
    values[7 + 9 * (6 + 9 * 2)] = 2.0f;
    for (int kind = 0; kind < 3; kind++) {
        lao_camera c = kind == 0 ? orthographic() : perspective(kind == 1 ? 20 : 54, 80);
        for (uint32_t flags = 0; flags < 8; flags++) {
            lao_camera d = reword(&c, flags);
            float *image = project(&volume, &d, 80, 60);
            int best = 0;
            for (int i = 0; i < 80 * 60; i++)
                best = image[i] > image[best] ? i : best;
            int column = best % 80, row = best / 80;
            double x = kind ? 2.0 * 3 / 52 : 3.0 / 20, y = kind ? 2.0 * 2 / 52 : 2.0 / 20;
            if (kind == 2) {
                assert_true(image[best] == 0.0f);
            } else {
                assert_true(fabs(column + 0.5 - 40 * (1 + x)) < 1.1);
                assert_true(fabs(row + 0.5 - 30 * (1 + y)) < 1.1);
                assert_true(image[best] > 0.5f && image[best] <= 2.0f); /* rays pass beside it */
            }
            free(image);
        }
    }
}

static void bad_projections_are_refused(void **state) {
    (void)state;
    static const uint8_t mask[1] = {1};
    float image[4];
    flow_host h;
    flow4d_field lattice;
    flow4d_volume volume;
    lao_camera c = orthographic(), singular = c, unknown = c;
    flow_host_make(&h, 2);
    memset(&volume, 0, sizeof volume);
    flow_lattice(&lattice, 1, 1, 1, 40.0, 0.0);
    memcpy(volume.size, lattice.size, sizeof volume.size);
    memcpy(volume.to_world, lattice.to_world, sizeof volume.to_world);
    assert_int_not_equal(flow4d_project_maximum(&h.host, &volume, &c, 2, 2, image), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_NULL_ARGUMENT);
    volume.mask = mask;
    assert_int_equal(flow4d_project_maximum(&h.host, &volume, &c, 2, 2, image), LAO_OK);
    assert_true(image[0] == 1.0f && image[3] == 1.0f);
    singular.projection[0] = 0;
    unknown.view[3] = NAN;
    assert_int_not_equal(flow4d_project_maximum(&h.host, &volume, &singular, 2, 2, image), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_CAMERA);
    assert_int_not_equal(flow4d_project_maximum(&h.host, &volume, &unknown, 2, 2, image), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_CAMERA);
    assert_int_not_equal(flow4d_project_maximum(&h.host, &volume, &c, 0, 2, image), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_IMAGE);
    assert_int_not_equal(flow4d_project_maximum(&h.host, &volume, NULL, 2, 2, image), LAO_OK);
    h.cancel_at = h.progress_calls + 1;
    assert_int_not_equal(flow4d_project_maximum(&h.host, &volume, &c, 2, 2, image), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_CANCELLED);
    assert_int_equal(h.failures, 6);
}

/* A function sampled to an array is the same field at voxel centres. */
static void resampling_keeps_values(void **state) {
    (void)state;
    flow4d_field source, target;
    flow4d_sampler a, b;
    flow_host h;
    flow_host_make(&h, 2);
    flow_phantom_field(&source);
    target = source;
    target.velocity_at = NULL;
    target.inside_at = NULL;
    target.frame_count = 3;
    size_t voxels = (size_t)target.size[0] * target.size[1] * target.size[2];
    float *velocity = malloc(voxels * 9 * sizeof(float));
    uint8_t *mask = malloc(voxels);
    assert_true(velocity && mask);
    assert_int_equal(flow4d_resample(&h.host, &source, &target, velocity, mask), LAO_OK);
    target.velocity = velocity;
    target.mask = mask;
    flow4d_sampler_make(NULL, &source, &a);
    flow4d_sampler_make(NULL, &target, &b);
    size_t inside = 0;
    for (size_t i = 0; i < voxels; i += 7) {
        size_t row = i / target.size[0], slice = row / target.size[1];
        double g[3] = {(double)(i % target.size[0]), (double)(row % target.size[1]), (double)slice};
        double p[3], v[3], w[3];
        flow4d_to_world(&b, g, p);
        assert_int_equal(mask[i], flow4d_inside(&a, p, FLOW4D_MASK_NEAREST));
        for (int f = 0; f < 3; f++) {
            flow4d_sample(&a, p, source.period * f / 3, v);
            flow4d_sample(&b, p, source.period * f / 3, w);
            for (int c = 0; c < 3; c++)
                assert_true(fabs(w[c] - (mask[i] ? v[c] : 0.0)) < 1e-6);
        }
        inside += mask[i];
    }
    assert_true(inside > 100);
    target.frame_count = 0;
    assert_int_not_equal(flow4d_resample(&h.host, &source, &target, velocity, mask), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_SIZE);
    assert_int_not_equal(flow4d_resample(&h.host, &source, NULL, velocity, mask), LAO_OK);
    free(velocity);
    free(mask);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_fields_are_exact),
        cmocka_unit_test(time_is_periodic_and_linear),
        cmocka_unit_test(outside_is_clamped_and_nan_stays_nan),
        cmocka_unit_test(masks_hold),
        cmocka_unit_test(vorticity_of_linear_fields_is_exact),
        cmocka_unit_test(bad_fields_are_refused),
        cmocka_unit_test(the_maximum_is_over_time),
        cmocka_unit_test(a_box_projects_to_its_outline),
        cmocka_unit_test(conventions_agree),
        cmocka_unit_test(bad_projections_are_refused),
        cmocka_unit_test(resampling_keeps_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
