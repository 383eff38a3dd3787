/* Tracing finds the first surface that brute force in double precision finds, with its segment,
   normal and place; no vessel is too thin, no start too odd; d_min is the least distance, or that
   of the last near miss. */
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

enum { MOST = 4096 };
static float positions[3 * MOST], radii[MOST];
static sdv_segment segments[MOST];

typedef struct scene {
    sdv_tree tree;
    sdv_grid grid;
} scene;
static scene make(uint32_t n, const float *p, const float *r, uint32_t m, const sdv_segment *s,
                  uint32_t resolution) {
    scene c;
    sdv_tree_desc desc = {n, p, r, m, s, 0, NULL, NULL, 0, 0};
    sdv_grid_desc grid = {resolution, NULL, 0, {0, 0, 0}};
    assert_int_equal(sdv_tree_build(NULL, &desc, &c.tree), LAO_OK);
    assert_int_equal(sdv_grid_build(NULL, &c.tree, &grid, &c.grid), LAO_OK);
    return c;
}
static scene make_random(uint32_t seed, uint32_t n, double size, double radius,
                         uint32_t resolution) {
    vessel_random_tree(seed, n, size, radius, positions, radii, segments);
    return make(n, positions, radii, n - 1, segments, resolution);
}
static void done(scene *c) {
    sdv_grid_free(&c->grid);
    sdv_tree_free(&c->tree);
}
static lao_v3 v3(double x, double y, double z) {
    return lao_v3_make((float)x, (float)y, (float)z);
}
static sdv_hit shoot(const scene *c, lao_v3 origin, lao_v3 direction) {
    sdv_ray ray = {origin, lao_v3_unit(direction, direction), SDV_TRACE_NEAREST, 0};
    sdv_hit hit, plain;
    sdv_trace(&c->grid, &ray, &hit);
    ray.flags = 0; /* what is seen does not depend on d_min being asked for */
    sdv_trace(&c->grid, &ray, &plain);
    assert_int_equal(hit.cone, plain.cone);
    assert_true(hit.t == plain.t && hit.steps == plain.steps && hit.inside == plain.inside);
    assert_memory_equal(&hit.normal, &plain.normal, sizeof hit.normal);
    return hit;
}

static void balls(void **state) {
    (void)state;
    const float p[] = {0, 0, 0}, r[] = {1};
    scene c = make(1, p, r, 0, NULL, 32);
    sdv_hit hit = shoot(&c, v3(0, 0, -5), v3(0, 0, 1));
    assert_int_equal(hit.cone, 0);
    assert_near(hit.t, 4, 1e-5);
    assert_near(hit.position.z, -1, 1e-5);
    assert_near(hit.normal.z, -1, 1e-6);
    assert_true(hit.d_min == SDV_FAR);
    hit = shoot(&c, v3(0, 1.001, -5), v3(0, 0, 1));
    assert_int_equal(hit.cone, SDV_NONE);
    assert_near(hit.d_min, 1e-3, 1e-6);
    assert_near(hit.t_min, 5, 1e-3);
    hit = shoot(&c, v3(0, 0.999, -5), v3(0, 0, 1));
    assert_int_equal(hit.cone, 0);
    assert_near(hit.t, 5 - sqrt(1 - 0.999 * 0.999), 1e-3);
    for (double b = 1.01; b < 40; b *= 1.3) { /* inside the box, past it, far from it */
        hit = shoot(&c, v3(3, b, -50), v3(-3, 0, 50));
        lao_v3 d = lao_v3_unit(v3(-3, 0, 50), v3(0, 0, 1));
        assert_int_equal(hit.cone, SDV_NONE);
        assert_near(hit.d_min, b - 1, 2e-5);
        assert_near(hit.t_min, -3 * (double)d.x + 50 * (double)d.z, 1e-2);
    }
    hit = shoot(&c, v3(0, 3, 5), v3(0, 0, 1)); /* looking away: nearest where it starts */
    assert_near(hit.d_min, sqrt(34) - 1, 1e-5);
    assert_true(hit.t_min == 0.0f);
    done(&c);
}

static void capsules(void **state) {
    (void)state;
    const float p[] = {0, 0, -4, 0, 0, 4}, r[] = {1, 1};
    const sdv_segment s[] = {{0, 1}};
    scene c = make(2, p, r, 1, s, 64);
    sdv_hit hit = shoot(&c, v3(0, 0, -9), v3(0, 0, 1)); /* end-on */
    assert_near(hit.t, 4, 1e-5);
    hit = shoot(&c, v3(0.6, 0, -9), v3(0, 0, 1));
    assert_near(hit.position.z, -4.8, 1e-4);
    hit = shoot(&c, v3(1.5, 0, -9), v3(0, 0, 1)); /* alongside */
    assert_int_equal(hit.cone, SDV_NONE);
    assert_near(hit.d_min, 0.5, 1e-6);
    hit = shoot(&c, v3(0, 9, 1), v3(0, -1, 0));
    assert_near(hit.t, 8, 1e-5);
    assert_near(hit.normal.y, 1, 1e-6);
    done(&c);
}

static void near_misses_before_a_hit(void **state) {
    (void)state;
    /* a twig of radius 0.1 at x = 0 crosses the way to a trunk at z = 10 */
    const float p[] = {0, -8, 0, 0, 8, 0, -8, 0, 10, 8, 0, 10}, r[] = {0.1f, 0.1f, 2, 2};
    const sdv_segment s[] = {{0, 1}, {2, 3}};
    scene c = make(4, p, r, 2, s, 64);
    for (double b = 0.15; b < 3; b += 0.1) {
        sdv_hit hit = shoot(&c, v3(b, 0, -20), v3(0, 0, 1));
        assert_int_equal(hit.cone, 1);
        assert_near(hit.t, 28, 1e-4);
        assert_near(hit.d_min, b - 0.1, 1e-5);
        assert_near(hit.t_min, 20, 1e-3);
    }
    sdv_hit hit = shoot(&c, v3(6, 0, 5), v3(0, 0, 1)); /* starts behind the twig */
    assert_int_equal(hit.cone, 1);
    assert_true(hit.d_min == SDV_FAR);
    done(&c);
}

/* ---- brute force in double */
static double union_distance(const sdv_grid *g, const double p[3], uint32_t *cone) {
    double least = 1e300;
    for (uint32_t k = 0; k < g->cone_count; k++) {
        double d = vessel_cone_distance(g->cones + 2 * k, p);
        if (d < least) {
            least = d;
            *cone = k;
        }
    }
    return least;
}
/* The same at t along a ray, for t that only grow: a distance changes by no more than the way, so a
   cone whose last one leaves too much is not looked at again. */
typedef struct along {
    double at[MOST], distance[MOST]; /* where each cone was last looked at, and what it gave */
} along;
static double union_distance_along(const sdv_grid *g, const double p[3], double t, along *last,
                                   uint32_t *cone) {
    double least = 1e300;
    for (uint32_t k = 0; k < g->cone_count; k++) {
        if (last->distance[k] - 1.0001 * (t - last->at[k]) > least)
            continue;
        last->at[k] = t;
        last->distance[k] = vessel_cone_distance(g->cones + 2 * k, p);
        if (last->distance[k] < least) {
            least = last->distance[k];
            *cone = k;
        }
    }
    return least;
}
typedef struct truth {
    double t, least, least_t; /* t < 0: no hit; least distance on the way */
    uint32_t cone;
} truth;
static truth brute(const sdv_grid *g, lao_v3 o, lao_v3 v, double end) {
    truth r = {-1, 1e300, 0, 0};
    double t = 0, hit = 1e-7;
    along last;
    assert_in_range(g->cone_count, 1, MOST);
    for (uint32_t k = 0; k < g->cone_count; k++)
        last.at[k] = last.distance[k] = -1e300;
    while (t < end) {
        double p[3] = {(double)o.x + t * (double)v.x, (double)o.y + t * (double)v.y,
                       (double)o.z + t * (double)v.z};
        double d = union_distance_along(g, p, t, &last, &r.cone);
        if (d < r.least) {
            r.least = d;
            r.least_t = t;
        }
        if (d < hit) {
            r.t = t;
            return r;
        }
        t += d < 0.02 ? fmax(d, 1e-4) : fmax(0.1 * d, fmin(d, 0.5)); /* the least to 0.2 % */
    }
    return r;
}

/* A ray from a sphere around the tree to a point near it. */
static void aim(uint32_t *seed, double size, lao_v3 *o, lao_v3 *v) {
    lao_v3 from = vessel_direction(seed);
    lao_v3 to = vessel_point(seed, size / 2);
    *o = lao_v3_scale(from, (float)(2 * size));
    *v = lao_v3_unit(lao_v3_sub(to, *o), *v);
}

static void random_rays(void **state) {
    (void)state;
    enum { RAYS = 10000 };
    static const struct {
        uint32_t nodes, resolution;
        double radius;
    } cases[] = {{60, 64, 4}, {120, 128, 1}, {120, 32, 0.2}, {30, 64, 15}};
    for (int i = 0; i < 4; i++) {
        uint32_t seed = (uint32_t)i, wrong = 0, hits = 0, other = 0, steps = 0, loose = 0, far = 0,
                 near_rays = 0, coarse = 0;
        scene c =
            make_random((uint32_t)i + 1, cases[i].nodes, 100, cases[i].radius, cases[i].resolution);
        double cell = (double)c.grid.cell, worst = 0, miss = 0, most = 0, most_near = 0;
        for (int k = 0; k < RAYS; k++) {
            lao_v3 o, v = v3(0, 0, 1);
            aim(&seed, 100, &o, &v);
            sdv_ray ray = {o, v, SDV_TRACE_NEAREST, 0};
            sdv_hit hit;
            sdv_trace(&c.grid, &ray, &hit);
            truth t = brute(&c.grid, o, v, 400);
            steps += hit.steps;
            if ((t.t >= 0) != (hit.cone != SDV_NONE)) {
                wrong +=
                    t.least > 1e-3 * cell || t.t >= 0; /* closer than that counts as touching */
                continue;
            }
            ray.reach = c.grid.cell; /* within reach, d_min is the same without the rest */
            sdv_hit close;
            sdv_trace(&c.grid, &ray, &close);
            assert_true((close.cone == SDV_NONE) == (hit.cone == SDV_NONE) && close.d_min >= 0);
            assert_near(close.t, hit.t, 1e-3 * cell); /* its steps begin a reach earlier */
            if (hit.d_min < ray.reach) {
                near_rays++;
                coarse += close.d_min > 1.002f * hit.d_min + 1e-4f;
                assert_true(close.d_min < 1.2f * hit.d_min + 1e-3f);
            }
            if (t.t < 0) { /* the least of the samples is at most their spacing off */
                double over = ((double)hit.d_min - 3e-5) / t.least - 1; /* rounding at 200 mm */
                far += over > 1e-3;
                most = fmax(most, over);
                if (t.least < 2 * cell)
                    most_near = fmax(most_near, over);
                double p[3] = {(double)o.x + (double)hit.t_min * (double)v.x,
                               (double)o.y + (double)hit.t_min * (double)v.y,
                               (double)o.z + (double)hit.t_min * (double)v.z};
                uint32_t near_cone;
                if (t.least < cell)
                    miss = fmax(miss,
                                fabs(union_distance(&c.grid, p, &near_cone) - (double)hit.d_min));
                continue;
            }
            hits++;
            double p[3] = {(double)hit.position.x, (double)hit.position.y, (double)hit.position.z};
            uint32_t nearest = SDV_NONE;
            double d = union_distance(&c.grid, p, &nearest);
            worst = fmax(worst, fabs(d));
            loose += fabs((double)hit.t - t.t) > 0.05 * cell;
            if (nearest != hit.cone) {
                other++;
                assert_near(vessel_cone_distance(c.grid.cones + 2 * hit.cone, p), d, 1e-4);
            }
            lao_v3 g = sdv_round_cone_gradient(hit.position, c.grid.cones[2 * hit.cone],
                                               c.grid.cones[2 * hit.cone + 1]);
            assert_memory_equal(&g, &hit.normal, sizeof g);
        }
        printf("%u segments, %u^3: %u of %d hit, %u disagree, |distance| < %.1e cells, %u ties, %u "
               "land "
               "elsewhere, d_min within %.1e mm, %.1f steps; %u d_min too great, at most %.2g, "
               "near %.2g; with a reach %u of %u\n",
               cases[i].nodes - 1, cases[i].resolution, hits, RAYS, wrong, worst / cell, other,
               loose, miss, (double)steps / RAYS, far, most, most_near, coarse, near_rays);
        assert_true(hits > 200);
        assert_true(wrong == 0);
        assert_true(loose <= RAYS / 10000);
        assert_true(worst < 1e-3 * cell);
        assert_true(miss < 1e-3);
        assert_true(coarse <= near_rays / 50);
        assert_true(most_near < 2e-3 && most < 0.35 && far < RAYS / 50);
        done(&c);
    }
}

static void no_vessel_is_too_thin(void **state) {
    (void)state;
    uint32_t seed = 5;
    scene c = make_random(6, 150, 100, 0.002, 32);
    for (int i = 0; i < 20000; i++) {
        uint32_t k = (uint32_t)lent_between(&seed, 0, c.grid.cone_count);
        const lao_v4 *a = c.grid.cones + 2 * k, *b = a + 1;
        float t = (float)lent_between(&seed, 0, 1);
        lao_v3 o, v = v3(0, 0, 1);
        lao_v3 p = v3((double)(a->x + t * (b->x - a->x)), (double)(a->y + t * (b->y - a->y)),
                      (double)(a->z + t * (b->z - a->z)));
        aim(&seed, 30, &o,
            &v); /* from nearer by, so that float rays do not miss it by themselves */
        sdv_ray ray = {o, lao_v3_unit(lao_v3_sub(p, o), v), 0, 0};
        sdv_hit hit;
        sdv_trace(&c.grid, &ray, &hit);
        assert_true(hit.cone != SDV_NONE);
    }
    done(&c);
}

static void starts_inside(void **state) {
    (void)state;
    const float p[] = {-20, 0, 0, 0, 0, 0, 20, 0, 0}, r[] = {3, 3, 2};
    const sdv_segment s[] = {{0, 1}, {1, 2}};
    scene c = make(3, p, r, 2, s, 64);
    sdv_hit hit = shoot(&c, v3(-10, 0, 0), v3(0, 1, 0));
    assert_int_equal(hit.inside, 1);
    assert_near(hit.t, 3, 1e-4);
    assert_near(hit.normal.y, -1, 1e-4);         /* the inner wall faces the viewer */
    hit = shoot(&c, v3(-10, 0, 0), v3(1, 0, 0)); /* along the vessel, past its joint */
    assert_int_equal(hit.inside, 1);
    assert_int_equal(hit.cone, 1);
    assert_near(hit.position.x, 22, 1e-3);
    hit = shoot(&c, v3(-10, 8, 0), v3(0, -1, 0)); /* inside the box */
    assert_int_equal(hit.inside, 0);
    assert_near(hit.t, 5, 1e-4);
    hit = shoot(&c, v3(-10, 8, 0), v3(0, 1, 0));
    assert_int_equal(hit.cone, SDV_NONE);
    assert_near(hit.d_min, 5, 1e-4);
    /* from random points inside random vessels the ray ends on a wall, which no other part covers
     */
    done(&c);
    c = make_random(9, 80, 60, 6, 64);
    uint32_t seed = 1, inside = 0;
    for (int i = 0; i < 3000; i++) {
        const lao_v4 *a = c.grid.cones + 2 * (i % (int)c.grid.cone_count);
        lao_v3 o = lao_v3_add(lao_v3_make(a->x, a->y, a->z), vessel_point(&seed, 3));
        if (sdv_grid_distance(&c.grid, o, NULL) > -0.01f)
            continue;
        inside++;
        lao_v3 v = vessel_direction(&seed);
        hit = shoot(&c, o, v);
        assert_int_equal(hit.inside, 1);
        assert_near(sdv_cones_distance(c.grid.cones, c.grid.cone_count, hit.position, NULL), 0,
                    2e-3);
        for (int k = 1; k < 50; k++) {
            lao_v3 q = lao_v3_along(o, v, hit.t * (float)k / 50);
            assert_true(sdv_cones_distance(c.grid.cones, c.grid.cone_count, q, NULL) < 2e-3f);
        }
    }
    assert_true(inside > 300);
    done(&c);
}

static void odd_rays_end(void **state) {
    (void)state;
    scene c = make_random(4, 50, 40, 2, 48);
    const double values[] = {0, 1, -1, 1e-30, 1e30, (double)NAN, (double)INFINITY};
    for (int i = 0; i < 7 * 7 * 7; i++) {
        for (int k = 0; k < 7; k++) {
            sdv_ray ray = {v3(values[k], 3, -60),
                           v3(values[i % 7], values[i / 7 % 7], values[i / 49]), SDV_TRACE_NEAREST,
                           0};
            sdv_hit hit;
            sdv_trace(&c.grid, &ray, &hit);
            assert_true(hit.cone == SDV_NONE || hit.cone < c.grid.cone_count);
        }
    }
    done(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balls),
        cmocka_unit_test(capsules),
        cmocka_unit_test(near_misses_before_a_hit),
        cmocka_unit_test(random_rays),
        cmocka_unit_test(no_vessel_is_too_thin),
        cmocka_unit_test(starts_inside),
        cmocka_unit_test(odd_rays_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
