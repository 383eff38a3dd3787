/* Pull-push fills an image as METHODS.md 6 says: its seven oracles hold for any size, channel
   count, exponent and stencil; weights end at exactly 1; it commutes with affine maps of the
   values; the order of rows does not matter; nothing leaks. */
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

enum { SIDE = 80, CHANNELS = 6 };
static float values[SIDE * SIDE * CHANNELS], weights[SIDE * SIDE];
static const uint32_t sizes[][2] = {{1, 1},   {3, 5},  {17, 9}, {32, 32},
                                    {64, 64}, {1, 40}, {2, 2},  {79, 3}};
enum { SIZES = 8 };

static sdv_pull_push_desc image(uint32_t width, uint32_t height, uint32_t channels) {
    sdv_pull_push_desc d = {width, height, channels, values, weights, 0, 0, 0};
    memset(values, 0, sizeof values);
    memset(weights, 0, sizeof weights);
    return d;
}
static void run(const sdv_pull_push_desc *d) {
    uint32_t empty = 7;
    assert_int_equal(sdv_pull_push(NULL, d, &empty), LAO_OK);
    assert_int_equal(empty, 0);
    for (uint32_t i = 0; i < d->width * d->height; i++)
        assert_true(weights[i] == 1.0f);
}

/* 1, 2, 5: constants stay, one sample fills everything, nothing leaves the range of the input. */
static void constants_and_convexity(void **state) {
    (void)state;
    uint32_t seed = 1;
    for (uint32_t i = 0; i < SIZES * 2 * 2 * 3; i++) {
        const uint32_t *size = sizes[i % SIZES], exponents[] = {0, 25, 1000};
        uint32_t n = size[0] * size[1];
        for (int kind = 0; kind < 3; kind++) {
            sdv_pull_push_desc d = image(size[0], size[1], CHANNELS);
            d.pull = i / SIZES % 2;
            d.push = i / SIZES / 2 % 2;
            d.exponent = exponents[i / SIZES / 4 % 3];
            for (uint32_t k = 0; k < n; k++) {
                int here = kind == 1 ? k == n / 2 : lent_between(&seed, 0, 1) < 0.1 || k == 0;
                weights[k] = here ? (float)lent_between(&seed, 0.01, 2) : 0.0f;
                for (uint32_t c = 0; c < CHANNELS; c++)
                    values[CHANNELS * k + c] = !here      ? NAN
                                               : kind < 2 ? 3.7f - (float)c
                                                          : (float)lent_between(&seed, -1, 1);
            }
            run(&d);
            for (uint32_t k = 0; k < n * CHANNELS; k++) {
                if (kind < 2)
                    assert_near(values[k], 3.7 - k % CHANNELS, 2e-6);
                else
                    assert_true(fabsf(values[k]) <= 1.000001f);
            }
        }
    }
}

/* 3: a full image stays as it is, to the bit. */
static void full_images_stay(void **state) {
    (void)state;
    static float before[SIDE * SIDE * CHANNELS];
    uint32_t seed = 2;
    for (uint32_t i = 0; i < SIZES; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            sdv_pull_push_desc d = image(sizes[i][0], sizes[i][1], CHANNELS);
            d.exponent = k * 12;
            for (uint32_t j = 0; j < d.width * d.height * CHANNELS; j++)
                before[j] = values[j] = (float)lent_between(&seed, -9, 9);
            for (uint32_t j = 0; j < d.width * d.height; j++)
                weights[j] = 1.0f + (float)(j % 2);
            run(&d);
            assert_memory_equal(values, before, d.width * d.height * CHANNELS * sizeof *values);
        }
    }
}

/* 4: the smallest images by hand. */
static void small_images(void **state) {
    (void)state;
    for (uint32_t stencil = 0; stencil < 2; stencil++) {
        sdv_pull_push_desc d = image(2, 2, 1);
        d.push = stencil;
        values[0] = 4;
        weights[0] = 1;
        run(&d);
        for (int i = 0; i < 4; i++)
            assert_near(values[i], 4, 0);
        d = image(2, 2, 1);
        values[3] = 8;
        weights[0] = weights[3] = 1;
        run(&d);
        const double expected[] = {0, 4, 4, 8};
        for (int i = 0; i < 4; i++)
            assert_near(values[i], expected[i], 0);
    }
}

/* 6: parents on a ramp give the ramp. */
static void spline_reproduces_ramps(void **state) {
    (void)state;
    for (lao_int x = 2; x < 20; x++) {
        sdv_mix m = sdv_mix_start(lao_v4_make(0, 0, 0, 0));
        for (lao_int k = 0; k < 2; k++) {
            float at = 2.0f * (float)sdv_push_parent(x, k) + 0.5f; /* middle of its children */
            m = sdv_mix_add(m, lao_v4_make(at, 0, 0, 0), 1.0f, sdv_push_share(1, k));
        }
        assert_near(sdv_mix_value(m).x, x, 0);
        assert_near(m.share, 1, 0);
    }
    /* and so does the whole pyramid, in the middle of the image: level 1 full of a ramp */
    float total = 0;
    for (lao_int i = 0; i < 4; i++)
        total += sdv_push_share(1, i & 1) * sdv_push_share(1, i >> 1);
    assert_near(sdv_push_share(1, 0) * sdv_push_share(1, 0), 9.0 / 16, 0);
    assert_near(sdv_push_share(1, 0) * sdv_push_share(1, 1), 3.0 / 16, 0);
    assert_near(total, 1, 0);
}

/* 7: the blend is convex for k > 1. */
static void blends(void **state) {
    (void)state;
    sdv_mix parents =
        sdv_mix_add(sdv_mix_start(lao_v4_make(0, 0, 0, 0)), lao_v4_make(10, 10, 10, 10), 1, 1);
    float own = sdv_push_own(0.2f, 25);
    assert_near(own, 0.996222, 1e-6);
    assert_near(sdv_push_value(parents, lao_v4_make(0, 0, 0, 0), own).z, 0.03778, 1e-5);
    assert_near(sdv_push_own(0.2f, 1), 0.2, 1e-7);
    assert_near(sdv_push_own(0.01f, 25), 0.2222, 1e-4);
    assert_near(sdv_push_own(3, 7), 1, 0);
    assert_near(sdv_push_own(0, 7), 0, 0);
    for (int i = 0; i <= 1000; i++) {
        float w = (float)i / 1000;
        assert_true(sdv_push_weight(parents, sdv_push_own(w, 3)) == 1.0f);
    }
}

static void affine_maps_commute(void **state) {
    (void)state;
    static float first[SIDE * SIDE];
    uint32_t seed = 3;
    for (int round = 0; round < 2; round++) {
        sdv_pull_push_desc d = image(61, 47, 1);
        d.push = 1;
        d.exponent = 25;
        seed = 3;
        for (uint32_t i = 0; i < 61 * 47; i++) {
            double here = lent_between(&seed, 0, 1), v = lent_between(&seed, -1, 1);
            weights[i] = here < 0.05 ? (float)(20 * here) : 0.0f;
            values[i] = (float)(round ? 3 * v + 2 : v);
        }
        run(&d);
        if (!round)
            memcpy(first, values, sizeof first);
    }
    for (uint32_t i = 0; i < 61 * 47; i++)
        assert_near(values[i], 3 * (double)first[i] + 2, 1e-5);
}

static void channels_do_not_mix(void **state) {
    (void)state;
    static float alone[SIDE * SIDE];
    for (uint32_t channels = 1; channels <= CHANNELS; channels++) {
        for (uint32_t c = 0; c < channels; c++) {
            for (int both = 0; both < 2; both++) {
                uint32_t seed = 9, stride = both ? channels : 1;
                sdv_pull_push_desc d = image(33, 20, stride);
                for (uint32_t i = 0; i < 33 * 20; i++) {
                    weights[i] = lent_between(&seed, 0, 1) < 0.1 ? 0.7f : 0.0f;
                    for (uint32_t k = 0; k < channels; k++) {
                        float v = (float)lent_between(&seed, -1, 1);
                        if (both || k == c)
                            values[i * stride + (both ? k : 0)] = v;
                    }
                }
                run(&d);
                for (uint32_t i = 0; i < 33 * 20; i++) {
                    if (both)
                        assert_true(values[i * channels + c] == alone[i]);
                    else
                        alone[i] = values[i];
                }
            }
        }
    }
}

static void faults(void **state) {
    (void)state;
    lent_host host;
    sdv_host h = vessel_host_make(&host);
    sdv_pull_push_desc d = image(40, 70, 3);
    uint32_t empty = 0;
    assert_int_equal(sdv_pull_push(&h, &d, &empty), LAO_OK); /* nothing to fill from */
    assert_int_equal(empty, 1);
    assert_true(values[100] == 0.0f && weights[100] == 0.0f);
    weights[5] = -1;
    weights[6] = NAN;
    assert_int_equal(sdv_pull_push(&h, &d, &empty), LAO_OK);
    assert_int_equal(empty, 1);
    weights[7] = 1;
    values[21] = 5;
    assert_int_equal(sdv_pull_push(&h, &d, NULL), LAO_OK);
    assert_true(host.done == host.total && values[3 * 2000] == 5.0f);
    host.cancel_at = host.progress_calls + 2;
    assert_int_equal(sdv_pull_push(&h, &d, &empty), LAO_ERROR_NOT_READY);
    host.memory.fail_allocation = host.memory.allocations + 1;
    assert_int_equal(sdv_pull_push(&h, &d, &empty), LAO_ERROR_OUT_OF_MEMORY);
    d.channels = 0;
    assert_int_equal(sdv_pull_push(&h, &d, &empty), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, SDV_LOG_IMAGE_SIZE);
    d.values = NULL;
    assert_int_equal(sdv_pull_push(&h, &d, &empty), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.failures, 4);
    assert_int_equal(host.memory.bytes, 0);
}

static void order_does_not_matter(void **state) {
    (void)state;
    static float first[SIDE * SIDE * CHANNELS];
    for (int backwards = 0; backwards < 2; backwards++) {
        lent_host host;
        sdv_host h = vessel_host_make(&host);
        uint32_t seed = 4;
        sdv_pull_push_desc d = image(2, 1500, 2);
        host.backwards = backwards;
        for (uint32_t i = 0; i < 3000; i++) {
            weights[i] = i % 7 ? 0.0f : 0.5f;
            values[2 * i] = values[2 * i + 1] = (float)lent_between(&seed, -1, 1);
        }
        assert_int_equal(sdv_pull_push(&h, &d, NULL), LAO_OK);
        if (!backwards)
            memcpy(first, values, sizeof first);
    }
    assert_memory_equal(first, values, 6000 * sizeof *values);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constants_and_convexity),
        cmocka_unit_test(full_images_stay),
        cmocka_unit_test(small_images),
        cmocka_unit_test(spline_reproduces_ramps),
        cmocka_unit_test(blends),
        cmocka_unit_test(affine_maps_commute),
        cmocka_unit_test(channels_do_not_mix),
        cmocka_unit_test(faults),
        cmocka_unit_test(order_does_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
