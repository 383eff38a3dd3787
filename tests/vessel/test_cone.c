/* The round cone's signed distance and gradient are those of METHODS.md 4: its oracles hold, both
   equal brute force over the family of balls in double precision, inside and outside, the distance
   is 1-Lipschitz and does not care which end comes first, and no input gives anything but numbers.
 */
#include "vessel_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

#define assert_near(a, b, tolerance) near_((double)(a), (double)(b), (tolerance), #a, __LINE__)
static void near_(double a, double b, double tolerance, const char *what, int line) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("line %d: %s is %.9g, not %.9g +- %.3g", line, what, a, b, tolerance);
}
static lao_v3 v3(double x, double y, double z) {
    return lao_v3_make((float)x, (float)y, (float)z);
}
static lao_v4 ball(double x, double y, double z, double r) {
    return lao_v4_make((float)x, (float)y, (float)z, (float)r);
}
static double distance(lao_v3 a, lao_v3 b) {
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y,
           z = (double)a.z - (double)b.z;
    return sqrt(x * x + y * y + z * z);
}
/* Cone along x from the origin: radii ri, rj, length s; q in the plane. */
static double planar(double ri, double rj, double s, double qx, double qy) {
    return (double)sdv_round_cone(v3(qx, qy, 0), ball(0, 0, 0, ri), ball(s, 0, 0, rj));
}

static void oracles(void **state) {
    (void)state;
    assert_near(planar(4, 1, 5, 4.6, 2.8), 1, 1e-6);
    assert_near(planar(4, 1, 5, 0, 0), -4, 1e-6);
    assert_near(planar(4, 1, 5, 5, 0), -1, 1e-6);
    assert_near(planar(4, 1, 5, 2.5, 0), -2.5, 1e-6);
    assert_near(planar(4, 1, 5, 8, 0), 2, 1e-6);
    assert_near(planar(4, 1, 5, -6, 0), 2, 1e-6);
    assert_near(planar(4, 1, 5, 2.4, 3.2), 0, 1e-6);
    assert_near(planar(1, 1, 2, 1, 3), 2, 1e-6);
    assert_near(planar(2, 0.5, 1, 3, 0), 1, 1e-6);
    assert_near(planar(2, 0.5, 1, 2, 1), sqrt(5) - 2, 1e-6);
    assert_near(planar(2, 1, 0, 0, 5), 3, 1e-6);
    assert_near(planar(1, 2, 0, 0, 5), 3, 1e-6);
    assert_near(planar(2, 2, 0, 0, 5), 3, 1e-6);
    assert_near(planar(0, 0, 0, 0, 5), 5, 1e-6);
    assert_near(planar(0, 0, 4, 2, 5), 5, 1e-6);
    assert_near(planar(2, 1, 1, 5, 0), 3, 1e-6); /* touching from within */
    assert_near(planar(2, 0, 4, 4, 0), 0, 1e-6); /* the tip */
}

typedef struct cone {
    lao_v4 a, b;
} cone;
static cone random_cone(uint32_t *seed) {
    cone c;
    double size = lent_between(seed, 0.1, 30);
    int kind = (int)lent_between(seed, 0, 8);
    lao_v3 p = vessel_point(seed, size), q = vessel_point(seed, size);
    c.a = lao_v4_make(p.x, p.y, p.z, (float)lent_between(seed, 0, 0.6 * size));
    c.b = lao_v4_make(q.x, q.y, q.z, (float)lent_between(seed, 0, 0.6 * size));
    if (kind == 0)
        c.b.w = c.a.w;
    if (kind == 1)
        c.b.w = 0;
    if (kind == 2) { /* nearly on one another */
        c.b.x = c.a.x + 0.01f;
        c.b.y = c.a.y;
        c.b.z = c.a.z;
    }
    return c;
}
/* min over t of |p - c(t)| - r(t): coarse, then golden section around each local minimum (double)
 */
static double family(const cone *c, lao_v3 p, double t) {
    double x = (double)c->a.x + t * ((double)c->b.x - (double)c->a.x) - (double)p.x;
    double y = (double)c->a.y + t * ((double)c->b.y - (double)c->a.y) - (double)p.y;
    double z = (double)c->a.z + t * ((double)c->b.z - (double)c->a.z) - (double)p.z;
    return sqrt(x * x + y * y + z * z) - ((double)c->a.w + t * ((double)c->b.w - (double)c->a.w));
}
static double brute(const cone *c, lao_v3 p) {
    double low = 0, high = 1; /* the family is convex in t */
    for (int i = 0; i < 100; i++) {
        double u = low + (high - low) / 3, v = high - (high - low) / 3;
        if (family(c, p, u) < family(c, p, v))
            high = v;
        else
            low = u;
    }
    return fmin(family(c, p, 0.5 * (low + high)), fmin(family(c, p, 0), family(c, p, 1)));
}
static lao_v3 random_point(const cone *c, uint32_t *seed) {
    double t = lent_between(seed, -0.5, 1.5), reach = lent_between(seed, 0, 3);
    lao_v3 p = vessel_point(seed, reach * ((double)c->a.w + (double)c->b.w + 0.1));
    lao_v3 ab = lao_v3_make(c->b.x - c->a.x, c->b.y - c->a.y, c->b.z - c->a.z);
    return lao_v3_add(p, lao_v3_along(lao_v3_make(c->a.x, c->a.y, c->a.z), ab, (float)t));
}

static void equals_brute_force(void **state) {
    (void)state;
    uint32_t seed = 1;
    for (int i = 0; i < 20000; i++) {
        cone c = random_cone(&seed);
        lao_v3 p = random_point(&c, &seed);
        assert_near(sdv_round_cone(p, c.a, c.b), brute(&c, p), 3e-5);
        assert_near(sdv_round_cone(p, c.a, c.b), sdv_round_cone(p, c.b, c.a), 2e-5);
    }
}

static void is_lipschitz(void **state) {
    (void)state;
    uint32_t seed = 2;
    for (int i = 0; i < 20000; i++) {
        cone c = random_cone(&seed);
        lao_v3 p = random_point(&c, &seed), q = random_point(&c, &seed);
        double d = (double)sdv_round_cone(p, c.a, c.b) - (double)sdv_round_cone(q, c.a, c.b);
        assert_true(fabs(d) <= distance(p, q) + 2e-5);
    }
}

/* Against the slope of brute force in double, where the field is smooth. */
static void gradient_is_the_slope(void **state) {
    (void)state;
    uint32_t seed = 3;
    int compared = 0;
    for (int i = 0; i < 20000; i++) {
        cone c = random_cone(&seed);
        lao_v3 p = random_point(&c, &seed), g = sdv_round_cone_gradient(p, c.a, c.b);
        double step = 1e-3, slope[3];
        assert_near(lao_v3_dot(g, g), 1, 1e-5);
        if (fabs(brute(&c, p)) > 5)
            continue;
        for (int k = 0; k < 3; k++) {
            lao_v3 high = p, low = p;
            float *h = k == 0 ? &high.x : k == 1 ? &high.y : &high.z;
            float *l = k == 0 ? &low.x : k == 1 ? &low.y : &low.z;
            *h += (float)step;
            *l -= (float)step;
            slope[k] = (brute(&c, high) - brute(&c, low)) / ((double)*h - (double)*l);
        }
        double length = sqrt(slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2]);
        if (fabs(length - 1) > 1e-5)
            continue; /* across the axis or near a centre: the slope bends within the step */
        compared++;
        assert_near(g.x, slope[0], 3e-3);
        assert_near(g.y, slope[1], 3e-3);
        assert_near(g.z, slope[2], 3e-3);
    }
    assert_true(compared > 10000);
}

static void degenerate_inputs_give_numbers(void **state) {
    (void)state;
    static const float values[] = {0, 1, -1, 1e-30f, 1e-7f, 1e6f};
    enum { N = 6 };
    for (uint32_t i = 0; i < N * N * N * N * N; i++) {
        uint32_t k = i;
        float v[5];
        for (int j = 0; j < 5; j++, k /= N)
            v[j] = values[k % N];
        lao_v4 a = lao_v4_make(v[0], v[1], 0, v[2] < 0 ? 0 : v[2]);
        lao_v4 b = lao_v4_make(v[3], 1, 0, v[4] < 0 ? 0 : v[4]);
        lao_v3 points[] = {v3(0, 0, 0), v3((double)a.x, (double)a.y, 0), v3((double)b.x, 1, 0),
                           v3(0.5 * (double)(a.x + b.x), 0.5 * (double)(a.y + b.y), 0),
                           v3(1e6, 1, 1e-30)};
        for (int j = 0; j < 5; j++) {
            lao_v3 g = sdv_round_cone_gradient(points[j], a, b);
            assert_true(isfinite(sdv_round_cone(points[j], a, b)));
            assert_near(lao_v3_dot(g, g), 1, 1e-5);
        }
    }
}

static void known_gradients(void **state) {
    (void)state;
    lao_v4 a = ball(0, 0, 0, 4), b = ball(5, 0, 0, 1);
    lao_v3 g = sdv_round_cone_gradient(v3(4.6, 2.8, 0), a, b); /* (r_d, l) / s */
    assert_near(g.x, 0.6, 1e-6);
    assert_near(g.y, 0.8, 1e-6);
    g = sdv_round_cone_gradient(v3(-6, 0, 0), a, b);
    assert_near(g.x, -1, 1e-6);
    g = sdv_round_cone_gradient(v3(5, 0, -9), ball(5, 0, 0, 2), ball(5, 0, 0, 1));
    assert_near(g.z, -1, 1e-6);
    g = sdv_round_cone_gradient(v3(2.5, 0, 0), a, b); /* on the axis: any of the cone's */
    assert_near(g.x, 0.6, 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(oracles),
        cmocka_unit_test(equals_brute_force),
        cmocka_unit_test(is_lipschitz),
        cmocka_unit_test(gradient_is_the_slope),
        cmocka_unit_test(degenerate_inputs_give_numbers),
        cmocka_unit_test(known_gradients),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
