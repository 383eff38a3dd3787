/* Proves that distances to the lit parts of pathlines are those of brute force, to the bit, for
   every storage, clock and order of work; that what is lit follows L14's highlight; and that gamma
   is the 1 % quantile of all of them. */
#include "surface_host.h"

#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void near_to(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g within %g", a, b, tolerance);
}

/* A line along x from 0 to 10 mm in 10 ms; p 2 mm above its middle. */
static vsf_near_desc straight(const float *positions, uint32_t count) {
    static const float points[] = {0, 0, 0, 10, 0, 0}, times[] = {0, 10};
    vsf_near_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = count;
    desc.positions = positions;
    desc.point_count = 2;
    desc.points = points;
    desc.times = times;
    desc.beta = 1 / 1.3862943611198906; /* reach 1 ms */
    desc.step_count = 11;
    return desc;
}

static void oracles_of_a_straight_line(void **state) {
    static const float p[] = {5, 0, 2, 20, 0, 0};
    vsf_near_desc desc = straight(p, 2);
    vsf_near n;
    float d[2], part, texels[4];
    (void)state;
    assert_int_equal(vsf_near_make(NULL, &desc, &n), LAO_OK);
    near_to(n.reach, 1, 1e-12);
    assert_true(n.duration == 10);
    vsf_near_step(&n, 5, d); /* x in [4, 6] is lit */
    assert_true(d[0] == 2);
    near_to((double)d[1], 14, 1e-6);
    vsf_near_step(&n, 9, d); /* [8, 10] */
    near_to((double)d[0], 3.605551, 1e-6);
    near_to((double)d[1], 10, 1e-6);
    vsf_near_step(&n, 0, d); /* [0, 1] */
    near_to((double)d[0], sqrt(16 + 4), 1e-6);
    assert_int_equal(vsf_near_find(&n, 5.5, &part), 5);
    near_to((double)part, 0.5, 1e-6);
    vsf_near_sample(&n, 8.5, d);
    near_to((double)d[0], 0.5 * (sqrt(4 + 4) + sqrt(9 + 4)), 1e-6);
    assert_int_equal(vsf_near_find(&n, 99, &part), 9);
    assert_true(part == 1);
    vsf_near_sample(&n, 99, d);
    near_to((double)d[0], sqrt(16 + 4), 1e-6); /* [9, 10] */
    vsf_near_sample(&n, -5, d);
    near_to((double)d[0], sqrt(16 + 4), 1e-6);
    assert_int_equal(vsf_near_find(&n, NAN, &part), 0);
    vsf_near_pair(&n, 8, texels);
    near_to((double)texels[0], sqrt(4 + 4), 1e-6);
    near_to((double)texels[1], sqrt(9 + 4), 1e-6);
    vsf_near_pair(&n, 10, texels); /* the last with itself */
    assert_true(texels[0] == texels[1]);
    assert_int_equal(vsf_near_exact(NULL, &n, 8.5, d), LAO_OK); /* [7.5, 9.5] */
    near_to((double)d[0], sqrt(2.5 * 2.5 + 4), 1e-6);
    vsf_near_free(&n);
    desc.period = 10; /* times count modulo it: x in [9, 10] and [0, 1] are lit at 0 and 10 */
    assert_int_equal(vsf_near_make(NULL, &desc, &n), LAO_OK);
    vsf_near_step(&n, 0, d);
    near_to((double)d[0], sqrt(16 + 4), 1e-6);
    near_to((double)d[1], 10, 1e-6);
    for (int turn = -3; turn < 4; turn++) {
        assert_int_equal(vsf_near_find(&n, 8.5 + 10 * turn, &part), 8);
        near_to((double)part, 0.5, 1e-6);
        assert_int_equal(vsf_near_exact(NULL, &n, 8.5 + 10 * turn, d), LAO_OK);
        near_to((double)d[0], sqrt(2.5 * 2.5 + 4), 1e-6);
    }
    vsf_near_free(&n);
    desc.period = 0;
    desc.flags = VSF_NEAR_POINTS; /* the two points alone */
    assert_int_equal(vsf_near_make(NULL, &desc, &n), LAO_OK);
    vsf_near_step(&n, 0, d);
    near_to((double)d[0], sqrt(25 + 4), 1e-6);
    vsf_near_step(&n, 1, d); /* |T - t| = reach is not lit any more */
    assert_true(d[0] == VSF_FAR);
    vsf_near_step(&n, 10, d);
    near_to((double)d[1], 10, 1e-6);
    vsf_near_free(&n);
}

static void beta_is_twice_the_median(void **state) {
    /* last times 100, 300, 800 and 900, one line without a time: median 550 */
    static const float points[27] = {0};
    static const float times[9] = {0, 100, 300, 200, 800, -900, 900, NAN, INFINITY};
    static const uint32_t offsets[] = {0, 2, 4, 5, 7, 9, 9};
    static const float one[3] = {1, 2, 3};
    vsf_near_desc desc;
    vsf_near n;
    (void)state;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = 1;
    desc.positions = one;
    desc.line_count = 6;
    desc.point_count = 9;
    desc.offsets = offsets;
    desc.points = points;
    desc.times = times;
    assert_int_equal(vsf_near_make(NULL, &desc, &n), LAO_OK);
    assert_true(n.beta == 1100 && n.duration == 900 && n.step_count == 100);
    near_to(n.sigma, sqrt(550.0), 1e-12);
    vsf_near_free(&n);
    desc.line_count = 3; /* odd: the middle one, here of 100, 300, 800 */
    desc.point_count = 5;
    assert_int_equal(vsf_near_make(NULL, &desc, &n), LAO_OK);
    assert_true(n.beta == 600 && n.duration == 800);
    near_to(n.reach, 1.17741 * sqrt(600.0), 1e-4);
    vsf_near_free(&n);
    desc.line_count = 0;
    desc.point_count = 0; /* nothing at all */
    assert_int_equal(vsf_near_make(NULL, &desc, &n), LAO_OK);
    assert_true(n.beta == 1600 && n.duration == 0 && n.gamma == 0 && n.lit == 0);
    vsf_near_free(&n);
}

/* Random bundles of short lines in a box, and points around them; some wild. */
typedef struct scene {
    uint32_t lines, points, vertices, *offsets;
    float *p, *t, *v;
} scene;
static scene scene_make(uint32_t lines, uint32_t per_line, uint32_t vertices, uint32_t seed) {
    scene s;
    s.lines = lines;
    s.points = lines * per_line;
    s.vertices = vertices;
    s.offsets = (uint32_t *)malloc(4 * (lines + 1));
    s.p = (float *)malloc(12 * s.points);
    s.t = (float *)malloc(4 * s.points);
    s.v = (float *)malloc(12 * vertices);
    for (uint32_t i = 0; i <= lines; i++)
        s.offsets[i] = i * per_line;
    for (uint32_t i = 0; i < lines; i++) {
        double at[3], time = lent_between(&seed, -100, 500);
        for (int k = 0; k < 3; k++)
            at[k] = lent_between(&seed, -50, 50);
        for (uint32_t j = 0; j < per_line; j++) {
            uint32_t n = i * per_line + j;
            for (uint32_t k = 0; k < 3; k++) {
                at[k] += lent_between(&seed, -2, 2);
                s.p[3 * n + k] = (float)at[k];
            }
            s.t[n] = (float)time;
            time += lent_between(&seed, -1, 12); /* a few run backward in time, or stand */
        }
    }
    for (uint32_t i = 0; i < 3 * vertices; i++)
        s.v[i] = (float)lent_between(&seed, -60, 60);
    s.p[3 * (per_line / 2)] = NAN; /* interrupts the first line */
    s.t[2 * per_line - 1] = INFINITY;
    s.v[3] = NAN;
    s.v[6] = 4e9f;
    return s;
}
static void scene_free(scene *s) {
    free(s->offsets);
    free(s->p);
    free(s->t);
    free(s->v);
}
static vsf_near_desc scene_describe(const scene *s) {
    vsf_near_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = s->vertices;
    desc.positions = s->v;
    desc.line_count = s->lines;
    desc.point_count = s->points;
    desc.offsets = s->offsets;
    desc.points = s->p;
    desc.times = s->t;
    desc.step_count = 13;
    return desc;
}

/* Written once more, plainly: the least distance over segments, their lit part sampled by the exact
   interval of times. */
static double oracle_distance(const scene *s, const float *p, double time, double reach,
                              double period) {
    double best = 1e30;
    for (uint32_t line = 0; line < s->lines; line++) {
        for (uint32_t i = s->offsets[line]; i + 1 < s->offsets[line + 1]; i++) {
            const float *a = s->p + 3 * i, *b = a + 3;
            double ta = (double)s->t[i], tb = (double)s->t[i + 1];
            if (!isfinite(a[0]) || !isfinite(b[0]) || !isfinite(s->t[i]) || !isfinite(s->t[i + 1]))
                continue;
            for (int turn = period > 0 ? -12 : 0; turn <= (period > 0 ? 12 : 0); turn++) {
                double low = time + turn * period - reach, high = time + turn * period + reach;
                double u0 = 0, u1 = 1, d[3], q[3], dd = 0, qd = 0, u, r2 = 0;
                if (ta < tb) {
                    u0 = fmax(0, (low - ta) / (tb - ta));
                    u1 = fmin(1, (high - ta) / (tb - ta));
                } else if (ta > tb) {
                    u0 = fmax(0, (high - ta) / (tb - ta));
                    u1 = fmin(1, (low - ta) / (tb - ta));
                } else if (!(ta > low && ta < high)) {
                    continue;
                }
                if (!(u0 < u1))
                    continue;
                for (int k = 0; k < 3; k++) {
                    d[k] = (double)b[k] - (double)a[k];
                    q[k] = (double)p[k] - (double)a[k];
                    dd += d[k] * d[k];
                    qd += q[k] * d[k];
                }
                u = fmin(u1, fmax(u0, qd / dd));
                for (int k = 0; k < 3; k++)
                    r2 += (q[k] - u * d[k]) * (q[k] - u * d[k]);
                best = fmin(best, r2);
            }
        }
    }
    return sqrt(best);
}

static void agrees_with_brute_force(void **state) {
    static const double periods[] = {0, 0, 400, 90};
    static const double betas[] = {0, 2000, 500, 3000}; /* the last lights all: 2 reach > period */
    scene s = scene_make(60, 40, 700, 11);
    uint64_t lit = 0;
    (void)state;
    for (int i = 0; i < 4; i++) {
        vsf_near_desc desc = scene_describe(&s);
        vsf_near fast, brute;
        float d[700];
        desc.period = periods[i];
        desc.beta = betas[i];
        for (uint32_t flags = 0; flags < 4; flags++) {
            desc.flags = flags;
            assert_int_equal(vsf_near_make(NULL, &desc, &fast), LAO_OK);
            desc.flags = flags | VSF_NEAR_BRUTE;
            assert_int_equal(vsf_near_make(NULL, &desc, &brute), LAO_OK);
            assert_memory_equal(fast.values, brute.values, 13 * 700 * fast.bytes);
            assert_true(fast.gamma == brute.gamma);
            assert_true(fast.lit == brute.lit);
            lit += fast.lit;
            for (uint32_t step = 0; flags == 0 && step < 13; step++) {
                double time = fast.duration * step / 12;
                vsf_near_step(&fast, step, d);
                assert_true(d[1] == VSF_FAR && d[2] == VSF_FAR); /* wild places */
                for (uint32_t v = 3; v < 700; v += 7) {
                    double want = oracle_distance(&s, s.v + 3 * v, time, fast.reach, periods[i]);
                    if (want > 1e10)
                        assert_true(d[v] == VSF_FAR);
                    else
                        near_to((double)d[v] / want, 1, 1e-7);
                }
            }
            vsf_near_free(&fast);
            vsf_near_free(&brute);
        }
    }
    assert_true(lit > 10000);
    scene_free(&s);
}

static void a_single_point_and_bad_neighbours(void **state) {
    /* a line of one point, one point between two wild ones: lit as points */
    static const float points[] = {1, 0, 0, NAN, 0, 0, 3, 0, 0, 0, INFINITY, 0};
    static const float times[] = {5, 5, 5, 5}, p[] = {0, 0, 0, 4, 0, 0};
    static const uint32_t offsets[] = {0, 1, 4};
    vsf_near_desc desc;
    vsf_near n;
    float d[2];
    (void)state;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = 2;
    desc.positions = p;
    desc.line_count = 2;
    desc.point_count = 4;
    desc.offsets = offsets;
    desc.points = points;
    desc.times = times;
    desc.step_count = 1;
    assert_int_equal(vsf_near_make(NULL, &desc, &n), LAO_OK);
    assert_int_equal(vsf_near_exact(NULL, &n, 5, d), LAO_OK);
    assert_true(d[0] == 1 && d[1] == 1);
    assert_int_equal(vsf_near_exact(NULL, &n, 500, d), LAO_OK);
    assert_true(d[0] == VSF_FAR);
    assert_int_equal(vsf_near_exact(NULL, &n, NAN, d), LAO_ERROR_INVALID_ARGUMENT);
    vsf_near_free(&n);
}

static void clustered_and_coincident_places(void **state) {
    /* all points and vertices in one place, and two clusters 1e6 mm apart */
    scene s = scene_make(10, 30, 200, 12);
    vsf_near_desc desc = scene_describe(&s);
    (void)state;
    for (int round = 0; round < 2; round++) {
        vsf_near fast, brute;
        scene_free(&s);
        s = scene_make(10, 30, 200, 13);
        for (uint32_t i = 0; i < 3 * s.points; i++)
            s.p[i] = round == 0 ? 1.5f : s.p[i] * 0.01f + (float)(i / 90 % 2) * 1e6f;
        for (uint32_t i = 0; i < 3 * s.vertices; i++)
            s.v[i] = round == 0 ? 1.5f : s.v[i] * 0.01f + (float)(i / 3 % 2) * 1e6f;
        desc = scene_describe(&s);
        desc.flags = 0;
        assert_int_equal(vsf_near_make(NULL, &desc, &fast), LAO_OK);
        desc.flags = VSF_NEAR_BRUTE;
        assert_int_equal(vsf_near_make(NULL, &desc, &brute), LAO_OK);
        assert_memory_equal(fast.values, brute.values, 13 * 200 * 4);
        if (round == 0)
            assert_true(fast.gamma == 1e-6f);
        vsf_near_free(&fast);
        vsf_near_free(&brute);
    }
    scene_free(&s);
}

static void updates_are_like_new(void **state) {
    scene s = scene_make(60, 40, 500, 14);
    static const double betas[] = {50, 400, 401, 5000, 300};
    (void)state;
    for (uint32_t flags = 0; flags <= VSF_NEAR_HALF; flags += VSF_NEAR_HALF) {
        vsf_near_desc desc = scene_describe(&s);
        lent_host host;
        vsf_host h = surface_host_make(&host);
        vsf_near n, fresh;
        desc.flags = flags;
        desc.beta = 10;
        assert_int_equal(vsf_near_make(&h, &desc, &n), LAO_OK);
        for (int i = 0; i < 5; i++) {
            assert_int_equal(vsf_near_update(&h, &n, betas[i]), LAO_OK);
            desc.beta = betas[i];
            assert_int_equal(vsf_near_make(NULL, &desc, &fresh), LAO_OK);
            assert_memory_equal(n.values, fresh.values, 13 * 500 * n.bytes);
            assert_true(n.gamma == fresh.gamma && n.reach == fresh.reach);
            vsf_near_free(&fresh);
        }
        assert_int_equal(vsf_near_update(&h, &n, 0), LAO_ERROR_INVALID_ARGUMENT);
        host.cancel_at = host.progress_calls + 3;
        fresh = n;
        assert_int_equal(vsf_near_update(&h, &n, 77), LAO_ERROR_NOT_READY);
        assert_memory_equal(&n, &fresh, sizeof n); /* the old table stays */
        vsf_near_free(&n);
        assert_int_equal(host.memory.bytes, 0);
    }
    scene_free(&s);
}

static int by_size(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}
static void gamma_is_the_quantile(void **state) {
    scene s = scene_make(60, 40, 300, 15);
    (void)state;
    for (uint32_t flags = 0; flags <= VSF_NEAR_HALF; flags += VSF_NEAR_HALF) {
        vsf_near_desc desc = scene_describe(&s);
        vsf_near n;
        float all[13 * 300];
        uint32_t count = 0;
        double place, want;
        desc.flags = flags;
        assert_int_equal(vsf_near_make(NULL, &desc, &n), LAO_OK);
        for (uint32_t step = 0; step < 13; step++) {
            float d[300];
            vsf_near_step(&n, step, d);
            for (uint32_t v = 0; v < 300; v++)
                if (d[v] < VSF_FAR)
                    all[count++] = d[v];
        }
        qsort(all, count, sizeof *all, by_size);
        place = 0.01 * (count - 1);
        want = (double)all[(int)place] +
               (place - floor(place)) * ((double)all[(int)place + 1] - (double)all[(int)place]);
        assert_true(n.gamma == (float)want);
        vsf_near_free(&n);
    }
    scene_free(&s);
}

static void halves_are_near(void **state) {
    scene s = scene_make(60, 40, 700, 16);
    vsf_near_desc desc = scene_describe(&s);
    vsf_near whole, half;
    float a[700], b[700];
    (void)state;
    s.p[0] += 70000; /* beyond what a half holds */
    assert_int_equal(vsf_near_make(NULL, &desc, &whole), LAO_OK);
    desc.flags = VSF_NEAR_HALF;
    assert_int_equal(vsf_near_make(NULL, &desc, &half), LAO_OK);
    assert_int_equal(half.bytes, 2);
    for (uint32_t step = 0; step < 13; step++) {
        vsf_near_step(&whole, step, a);
        vsf_near_step(&half, step, b);
        for (uint32_t v = 0; v < 700; v++) {
            if (a[v] == VSF_FAR || b[v] == VSF_FAR)
                assert_true(a[v] == b[v]);
            else
                near_to((double)b[v], fmin((double)a[v], 65504), (double)a[v] / 2048 + 3e-8);
        }
    }
    vsf_near_free(&whole);
    vsf_near_free(&half);
    scene_free(&s);
}

static void order_of_work_does_not_matter(void **state) {
    scene s = scene_make(60, 40, 3000, 17);
    vsf_near_desc desc = scene_describe(&s);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_near a, b;
    (void)state;
    host.backwards = 1;
    assert_int_equal(vsf_near_make(NULL, &desc, &a), LAO_OK);
    assert_int_equal(vsf_near_make(&h, &desc, &b), LAO_OK);
    assert_memory_equal(a.values, b.values, 13 * 3000 * 4);
    assert_int_equal(host.done, host.total);
    vsf_near_free(&a);
    vsf_near_free(&b);
    assert_int_equal(host.memory.bytes, 0);
    scene_free(&s);
}

static void refuses_and_survives(void **state) {
    scene s = scene_make(20, 20, 100, 18);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_near_desc good = scene_describe(&s), desc = good;
    vsf_near n;
    (void)state;
    desc.beta = NAN;
    assert_int_equal(vsf_near_make(&h, &desc, &n), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_SETTING);
    desc = good;
    desc.period = -1;
    assert_int_equal(vsf_near_make(&h, &desc, &n), LAO_ERROR_INVALID_ARGUMENT);
    desc = good;
    desc.point_count--;
    assert_int_equal(vsf_near_make(&h, &desc, &n), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_LINES_OFFSETS);
    desc = good;
    s.offsets[3] = 1000000;
    assert_int_equal(vsf_near_make(&h, &desc, &n), LAO_ERROR_INVALID_ARGUMENT);
    s.offsets[3] = 60;
    desc.times = NULL;
    assert_int_equal(vsf_near_make(&h, &desc, &n), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_NULL_ARGUMENT);
    desc = good;
    desc.step_count = 0xffffffffu;
    desc.vertex_count = 1u << 30;
    assert_int_equal(vsf_near_make(&h, &desc, &n), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_NEAR_COUNT);
    assert_int_equal(host.failures, 6);
    for (uint32_t i = 1;; i++) {
        lao_result result;
        h = surface_host_make(&host);
        host.memory.fail_allocation = i;
        result = vsf_near_make(&h, &good, &n);
        if (result == LAO_OK) {
            assert_true(i > 15);
            vsf_near_free(&n);
        }
        assert_int_equal(host.memory.bytes, 0);
        if (result == LAO_OK)
            break;
        assert_int_equal(result, LAO_ERROR_OUT_OF_MEMORY);
        assert_int_equal(host.failures, 1);
    }
    h = surface_host_make(&host);
    host.cancel_at = 4;
    assert_int_equal(vsf_near_make(&h, &good, &n), LAO_ERROR_NOT_READY);
    assert_int_equal(host.memory.bytes, 0);
    scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(oracles_of_a_straight_line),
        cmocka_unit_test(beta_is_twice_the_median),
        cmocka_unit_test(agrees_with_brute_force),
        cmocka_unit_test(a_single_point_and_bad_neighbours),
        cmocka_unit_test(clustered_and_coincident_places),
        cmocka_unit_test(updates_are_like_new),
        cmocka_unit_test(gamma_is_the_quantile),
        cmocka_unit_test(halves_are_near),
        cmocka_unit_test(order_of_work_does_not_matter),
        cmocka_unit_test(refuses_and_survives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
