/* What the field gives for free is right: outlines and shadows follow METHODS.md 5.4, Boolean
   operations follow brute force, light and openness follow geometry, and distances of balls, paths
   and surfaces to round cones are exact. */
#include "vessel_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <cmocka.h>

#define assert_near(a, b, tolerance) near_((double)(a), (double)(b), (tolerance), #a, __LINE__)
static void near_(double a, double b, double tolerance, const char *what, int line) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("line %d: %s is %.9g, not %.9g +- %.3g", line, what, a, b, tolerance);
}
static lao_v3 v3(double x, double y, double z) {
    return lao_v3_make((float)x, (float)y, (float)z);
}
static lao_v4 v4(double x, double y, double z, double w) {
    return lao_v4_make((float)x, (float)y, (float)z, (float)w);
}
static double length(lao_v3 v) {
    return sqrt((double)v.x * (double)v.x + (double)v.y * (double)v.y + (double)v.z * (double)v.z);
}

enum { MOST = 4096 };
static float positions[3 * MOST], radii[MOST];
static sdv_segment segments[MOST];
static sdv_tree tree_of(uint32_t n, const float *p, const float *r, uint32_t m,
                        const sdv_segment *s) {
    sdv_tree t;
    sdv_tree_desc desc = {n, p, r, m, s, 0, NULL, NULL, 0, 0};
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    return t;
}
static sdv_tree random_tree(uint32_t seed, uint32_t n, double size, double radius) {
    vessel_random_tree(seed, n, size, radius, positions, radii, segments);
    return tree_of(n, positions, radii, n - 1, segments);
}
static sdv_grid grid_of(const sdv_tree *t, uint32_t resolution) {
    sdv_grid g;
    sdv_grid_desc desc = {resolution, NULL, 0, {0, 0, 0}};
    assert_int_equal(sdv_grid_build(NULL, t, &desc, &g), LAO_OK);
    return g;
}

static void outlines_and_depth_shadows(void **state) {
    (void)state;
    assert_true(sdv_is_silhouette(false, 0.4f, 0.5f));
    assert_false(sdv_is_silhouette(true, 0.4f, 0.5f));
    assert_false(sdv_is_silhouette(false, 0.6f, 0.5f));
    assert_true(sdv_is_contour(0.4f, 0.5f));
    assert_false(sdv_is_contour(SDV_FAR, 0.5f));
    /* a ball of radius 1 and a plane 10 behind it: b - 1 < min(10 m, a) */
    for (double b = 1.01; b < 4; b += 0.03) {
        float d = (float)(b - 1);
        assert_int_equal(sdv_is_depth_shadow(d, 20, 30, 0.15f, 9), b - 1 < 1.5);
        assert_int_equal(sdv_is_depth_shadow(d, 20, 30, 0.15f, 0.8f), b - 1 < 0.8);
    }
}

static sdv_shape shape(int kind, int operation, lao_v4 a, lao_v4 b) {
    sdv_shape s = {a, b, kind, operation};
    return s;
}
static void shapes_have_distances(void **state) {
    (void)state;
    sdv_shape ball = shape(SDV_SHAPE_BALL, 0, v4(1, 2, 3, 2), v4(0, 0, 0, 0));
    sdv_shape box = shape(SDV_SHAPE_BOX, 0, v4(1, 2, 3, 0), v4(2, 1, 3, 0));
    sdv_shape plane = shape(SDV_SHAPE_PLANE, 0, v4(0, 0.6, 0.8, 2), v4(0, 0, 0, 0));
    assert_near(sdv_shape_distance(v3(1, 2, 8), ball), 3, 1e-6);
    assert_near(sdv_shape_distance(v3(1, 2, 3), ball), -2, 1e-6);
    assert_near(sdv_shape_distance(v3(6, 2, 3), box), 3, 1e-6);
    assert_near(sdv_shape_distance(v3(6, 7, 3), box), 5, 1e-6);
    assert_near(sdv_shape_distance(v3(1, 2.5, 3), box), -0.5, 1e-6);
    assert_near(sdv_shape_distance(v3(0, 0, 5), plane), 2, 1e-6);
    uint32_t seed = 1;
    const sdv_shape *all[] = {&ball, &box, &plane};
    for (int i = 0; i < 3000; i++) { /* gradients are slopes, off the creases */
        lao_v3 p = vessel_point(&seed, 6);
        const sdv_shape *s = all[i % 3];
        lao_v3 g = sdv_shape_gradient(p, *s);
        lao_v3 q = lao_v3_along(p, g, 1e-3f);
        assert_near(length(g), 1, 1e-6);
        assert_near(sdv_shape_distance(q, *s) - sdv_shape_distance(p, *s), 1e-3, 1e-4);
    }
    sdv_shape egg = shape(SDV_SHAPE_ELLIPSOID, 0, v4(1, 2, 3, 0), v4(4, 2, 3, 0));
    for (int i = 0; i < 300; i++) { /* a bound of the least distance to places of the surface */
        lao_v3 p = vessel_point(&seed, 7), e = sdv_ellipsoid_place(p, egg);
        double least = INFINITY, sign = length(e) < 1 ? -1 : 1;
        for (int k = 0; k < 20000; k++) {
            lao_v3 u = vessel_direction(&seed);
            lao_v3 q = v3(1 + 4 * (double)u.x, 2 + 2 * (double)u.y, 3 + 3 * (double)u.z);
            least = fmin(least, length(lao_v3_sub(p, q)));
        }
        double d = (double)sdv_shape_distance(p, egg);
        assert_true(sign * d >= 0 && fabs(d) <= least + 1e-5);
        assert_true(fabs((double)sdv_shape_estimate(p, egg) - sign * least) <
                    0.05 + (sign > 0 ? 0.35 : 1) * least);
        lao_v3 on = lao_v3_along(v3(1, 2, 3), lao_v3_sub(p, v3(1, 2, 3)), 1 / (float)length(e));
        lao_v3 g = sdv_shape_gradient(on, egg);
        lao_v3 above = lao_v3_along(on, g, 1e-2f);
        assert_near(sdv_shape_distance(on, egg), 0, 1e-5);
        assert_near(sdv_shape_estimate(above, egg), 1e-2, 3e-4);
    }
    lao_v3 zero = sdv_shape_gradient(v3(1, 2, 3), ball),
           middle = sdv_shape_gradient(v3(1, 2, 3), box);
    assert_near(length(zero), 1, 1e-6);
    assert_near(length(middle), 1, 1e-6);
}

/* In double, by small steps: where the combined distance first changes its sign. */
static double solid_truth(const sdv_grid *g, const sdv_shape *s, uint32_t n, lao_v3 o, lao_v3 v,
                          double end) {
    double t = 0;
    while (t < end) {
        lao_v3 p = lao_v3_along(o, v, (float)t);
        double d = (double)sdv_cones_distance(g->cones, g->cone_count, p, NULL);
        for (uint32_t i = 0; i < n; i++) {
            double e = (double)sdv_shape_distance(p, s[i]);
            d = s[i].operation == SDV_UNION          ? fmin(d, e)
                : s[i].operation == SDV_INTERSECTION ? fmax(d, e)
                                                     : fmax(d, -e);
        }
        if (d < 1e-3 * (double)g->cell)
            return t;
        t += d;
    }
    return -1;
}
static void boolean_operations(void **state) {
    (void)state;
    sdv_tree t = random_tree(3, 100, 60, 5);
    sdv_grid g = grid_of(&t, 64);
    uint32_t seed = 5, cut = 0, tree = 0, wrong = 0;
    for (int i = 0; i < 3000; i++) {
        sdv_shape s[2];
        uint32_t n = 1 + (uint32_t)i % 2, which;
        for (uint32_t k = 0; k < n; k++) {
            lao_v3 at = vessel_point(&seed, 20);
            s[k] = shape((i / 2 + (int)k) % 3, (i / 6 + (int)k) % 3,
                         v4((double)at.x, (double)at.y, (double)at.z, 15), v4(12, 8, 17, 0));
            if (s[k].kind == SDV_SHAPE_PLANE) {
                lao_v3 normal = lao_v3_unit(at, at);
                s[k].a = v4((double)normal.x, (double)normal.y, (double)normal.z, 3);
            }
        }
        lao_v3 from = lao_v3_scale(vessel_direction(&seed), 120);
        lao_v3 to = vessel_point(&seed, 25);
        sdv_ray ray = {from, lao_v3_unit(lao_v3_sub(to, from), to), 0, 0};
        sdv_hit hit;
        if (sdv_shape_distance(from, s[0]) < 0 || (n > 1 && sdv_shape_distance(from, s[1]) < 0))
            continue; /* starts inside: see below */
        const sdv_shapes shapes = {s, n, NULL, 0};
        sdv_trace_shapes(&g, &shapes, &ray, &hit, &which);
        double truth = solid_truth(&g, s, n, from, ray.direction, 400);
        if ((truth < 0) != (hit.cone == SDV_NONE)) {
            wrong++;
            continue;
        }
        if (truth < 0)
            continue;
        assert_near(hit.t, truth, 0.05);
        if (hit.cone == SDV_CUT_CONE) {
            lao_v3 normal = sdv_shape_gradient(hit.position, s[which]);
            float side = s[which].operation == SDV_SUBTRACTION ? -1.0f : 1.0f;
            cut++;
            assert_near(sdv_shape_distance(hit.position, s[which]), 0, 2e-3);
            assert_near(lao_v3_dot(normal, hit.normal), (double)side, 1e-5);
        } else {
            tree++;
            assert_int_equal(which, SDV_NONE);
            assert_near(sdv_cones_distance(g.cones, g.cone_count, hit.position, NULL), 0, 2e-3);
        }
        assert_true(lao_v3_dot(hit.normal, ray.direction) < 0.01f);
    }
    printf("shapes: %u hits on cuts, %u on the tree, %u of 3000 disagree\n", cut, tree, wrong);
    assert_true(cut > 300 && tree > 300 && wrong <= 3);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

static void carving_opens_vessels(void **state) {
    (void)state;
    const float p[] = {-20, 0, 0, 20, 0, 0}, r[] = {4, 4};
    const sdv_segment s[] = {{0, 1}};
    sdv_tree t = tree_of(2, p, r, 1, s);
    sdv_grid g = grid_of(&t, 64);
    sdv_shape cut = shape(SDV_SHAPE_PLANE, SDV_SUBTRACTION, v4(0, 0, -1, -1), v4(0, 0, 0, 0));
    sdv_ray ray = {v3(0, 1, 30), v3(0, 0, -1), 0, 0}; /* the half z > 1 goes */
    sdv_hit hit;
    uint32_t which;
    const sdv_shapes shapes = {&cut, 1, NULL, 0};
    sdv_trace_shapes(&g, &shapes, &ray, &hit, &which);
    assert_int_equal(hit.cone, SDV_CUT_CONE);
    assert_int_equal((int32_t)hit.cone, -2);
    assert_near(hit.position.z, 1, 1e-3);
    assert_near(hit.normal.z, 1, 1e-6);
    sdv_trace_shapes(&g, NULL, &ray, &hit, NULL); /* no shapes: the tree */
    assert_near(hit.position.z, sqrt(15), 1e-3);
    ray.origin = v3(0, 0, 0); /* from inside: the wall that is left */
    sdv_trace_shapes(&g, &shapes, &ray, &hit, &which);
    assert_int_equal(hit.inside, 1);
    assert_near(hit.position.z, -4, 1e-3);
    assert_near(hit.normal.z, 1, 1e-4);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

/* Rays past the tree, past a ball that is added and past what a cut has left: the near miss is
   where the ray is nearest to what is drawn, not to what is cut away. */
static void near_misses_of_shapes(void **state) {
    (void)state;
    const float p[] = {0, -20, 0, 0, 20, 0}, r[] = {2, 2};
    const sdv_segment s[] = {{0, 1}};
    sdv_tree t = tree_of(2, p, r, 1, s);
    sdv_grid g = grid_of(&t, 96);
    const sdv_shape list[2] = {
        shape(SDV_SHAPE_PLANE, SDV_SUBTRACTION, v4(0, 1, 0, 0), v4(0, 0, 0, 0)), /* y < 0 goes */
        shape(SDV_SHAPE_BALL, SDV_UNION, v4(14, 10, 5, 3), v4(0, 0, 0, 0))};
    const sdv_shapes shapes = {list, 2, NULL, 0};
    for (int i = 0; i < 2; i++) {
        float reach = i ? 3.0f : 0.0f; /* exact, close */
        sdv_ray ray = {v3(2.5f, 10, 40), v3(0, 0, -1), SDV_TRACE_NEAREST, reach};
        sdv_hit hit;
        sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL);
        assert_int_equal(hit.cone, SDV_NONE);
        assert_near(hit.d_min, 0.5, 0.02); /* the vessel */
        assert_near(hit.t_min, 40, 0.6);
        for (double x = 2.1; x < 4.9; x += 0.05) { /* wherever the samples are */
            ray.origin = v3(x, 10, 37.3);
            sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL);
            assert_near(hit.d_min, x - 2, 0.004 * (x - 2));
        }
        ray.origin = v3(10.2f, 10, 40); /* the ball, whose middle is 3.8 mm beside */
        sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL);
        assert_int_equal(hit.cone, SDV_NONE);
        assert_near(hit.d_min, 0.8, 0.03);
        assert_near(hit.t_min, 35, 0.6);
        ray.origin = v3(1, -0.7f, 40); /* in front of the cut's rim: an edge at y = 0 */
        sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL);
        assert_int_equal(hit.cone, SDV_NONE);
        assert_near(hit.d_min, 0.7, 0.03);
        ray.origin = v3(1, -10, 40); /* what is cut away is passed through */
        sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL);
        assert_int_equal(hit.cone, SDV_NONE);
        assert_true(hit.d_min > 3);
        ray.origin = v3(2.3f, 10, -40); /* past the tree, then onto the ball */
        ray.direction = lao_v3_unit(v3(12.0f - 2.3f, 0, 45), v3(0, 0, 1));
        sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL);
        assert_true(hit.cone == SDV_CUT_CONE || hit.d_min < SDV_FAR);
        ray.flags = 0;
        sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL);
        assert_true(hit.d_min == SDV_FAR);
    }
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

/* An organ around the tree, cut open, with the tree in it again: L19 Fig. 11. */
static void tree_in_a_cut(void **state) {
    (void)state;
    const float p[] = {-20, 0, 0, 20, 0, 0}, r[] = {2, 2};
    const sdv_segment s[] = {{0, 1}};
    sdv_tree t = tree_of(2, p, r, 1, s);
    sdv_grid g = grid_of(&t, 64);
    const sdv_shape list[3] = {
        shape(SDV_SHAPE_BALL, SDV_UNION, v4(0, 0, 0, 30), v4(0, 0, 0, 0)),
        shape(SDV_SHAPE_BALL, SDV_SUBTRACTION, v4(0, 0, 20, 20), v4(0, 0, 0, 0)),
        shape(SDV_SHAPE_TREE, SDV_UNION, v4(0, 0, 0, 0), v4(0, 0, 0, 0))};
    sdv_shapes shapes = {list, 2, NULL, 0};
    sdv_ray ray = {v3(1, 0, 60), v3(0, 0, -1), 0, 0};
    sdv_hit hit;
    sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL); /* the cut took half of the vessel */
    assert_int_equal(hit.cone, SDV_CUT_CONE);
    assert_near(hit.position.z, 20 - sqrt(399), 2e-3);
    shapes.count = 3;
    sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL);
    assert_int_equal(hit.cone, 0);
    assert_near(hit.position.z, 2, 2e-3);
    ray.origin = v3(25, 0, 60); /* beside the cut: the organ */
    sdv_trace_shapes(&g, &shapes, &ray, &hit, NULL);
    assert_int_equal(hit.cone, SDV_CUT_CONE);
    assert_near(hit.position.z, sqrt(900 - 625), 2e-3);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

/* Along a chain of short segments whose radii alternate, exact normals jump at every joint; those
   for shading turn slowly. Where a segment is alone both are the same. */
static void smooth_normals(void **state) {
    (void)state;
    enum { CHAIN = 60 };
    float p[3 * CHAIN] = {0}, r[CHAIN];
    sdv_segment s[CHAIN];
    for (uint32_t i = 0; i < CHAIN; i++) {
        p[3 * i] = i + 1 < CHAIN ? 0.4f * (float)i : 60.0f; /* the last one is long */
        r[i] = 3.0f + (i % 2 && i + 2 < CHAIN ? 0.05f : 0.0f);
        s[i] = (sdv_segment){i, i + 1};
    }
    sdv_tree t = tree_of(CHAIN, p, r, CHAIN - 1, s);
    sdv_grid g = grid_of(&t, 64);
    double jump[2] = {0, 0};
    lao_v3 before[2] = {{0, 0, 1}, {0, 0, 1}};
    for (double x = 4; x < 20; x += 0.02) {
        sdv_ray ray = {v3(x, 0, 20), v3(0, 0, -1), 0, 0};
        sdv_hit hit;
        sdv_trace(&g, &ray, &hit);
        lao_v3 n[2] = {hit.normal,
                       sdv_smooth_normal(&g, hit.position, hit.cone, hit.normal, 0.35f)};
        for (int k = 0; k < 2 && x > 4.1; k++)
            jump[k] = fmax(jump[k], length(lao_v3_sub(n[k], before[k])));
        memcpy(before, n, sizeof n);
        assert_near(length(n[1]), 1, 1e-6);
        lao_v3 same = sdv_smooth_normal(&g, hit.position, hit.cone, hit.normal, 0);
        assert_memory_equal(&same, &hit.normal, sizeof same);
    }
    assert_true(jump[0] > 0.1 && jump[1] < 0.1 * jump[0]);
    sdv_ray ray = {v3(45, 0.5, 20), v3(0, 0, -1), 0, 0};
    sdv_hit hit;
    sdv_trace(&g, &ray, &hit);
    lao_v3 alone = sdv_smooth_normal(&g, hit.position, hit.cone, hit.normal, 0.35f);
    assert_near(length(lao_v3_sub(alone, hit.normal)), 0, 1e-6);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

/* What a cut has taken away casts no shadow, what is added does. */
static void shapes_cast_shadows(void **state) {
    (void)state;
    const float p[] = {-30, 0, 0, 30, 0, 0, 0, -30, 12, 0, 30, 12}, r[] = {5, 5, 1, 1};
    const sdv_segment s[] = {{0, 1}, {2, 3}};
    sdv_tree t = tree_of(4, p, r, 2, s);
    sdv_grid g = grid_of(&t, 96);
    const sdv_shape list[2] = {
        shape(SDV_SHAPE_BOX, SDV_SUBTRACTION, v4(0, 0, 12, 0), v4(8, 8, 3, 0)),
        shape(SDV_SHAPE_BALL, SDV_UNION, v4(15, 0, 60, 3), v4(0, 0, 0, 0))}; /* out of the box */
    const sdv_shapes shapes = {list, 2, NULL, 0};
    lao_v3 up = v3(0, 0, 1);
    assert_true(sdv_shadow(&g, NULL, v3(0, 0, 5), up, 8, 0.1f) == 0.0f);
    assert_true(sdv_shadow(&g, &shapes, v3(0, 0, 5), up, 8, 0.1f) > 0.5f);
    assert_true(sdv_shadow(&g, &shapes, v3(15, 0, 5), up, 8, 0.1f) == 0.0f);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

static void light_and_openness(void **state) {
    (void)state;
    /* a wide vessel below, a thin one above it, across */
    const float p[] = {-30, 0, 0, 30, 0, 0, 0, -30, 12, 0, 30, 12}, r[] = {5, 5, 1, 1};
    const sdv_segment s[] = {{0, 1}, {2, 3}};
    sdv_tree t = tree_of(4, p, r, 2, s);
    sdv_grid g = grid_of(&t, 96);
    lao_v3 up = v3(0, 0, 1);
    assert_true(sdv_shadow(&g, NULL, v3(0, 0, 5), up, 8, 0.1f) == 0.0f);  /* in the umbra */
    assert_true(sdv_shadow(&g, NULL, v3(15, 0, 5), up, 8, 0.1f) > 0.95f); /* far beside */
    double before = 0;
    for (double x = 1; x < 6; x += 0.25) { /* light comes back with the distance */
        double lit = (double)sdv_shadow(&g, NULL, v3(x, 0, 5), up, 8, 0.1f);
        assert_true(lit >= before - 0.02 && lit <= 1);
        before = lit;
    }
    assert_true(before > 0.9);
    assert_true(sdv_shadow(&g, NULL, v3(0, 0, 13), up, 8, 0.1f) ==
                1.0f); /* on top: nothing above */
    float open = sdv_openness(&g, NULL, v3(20, 0, 5), up, 4, 0),
          below = sdv_openness(&g, NULL, v3(0, 0, 5), up, 8, 0);
    assert_true(open > 0.99f && below < 0.9f && below > 0.1f);
    assert_true(sdv_openness(&g, NULL, v3(0, 0, 0), up, 4, 0) == 0.0f); /* inside */
    assert_true(sdv_openness(&g, NULL, v3(0, 0, 5), up, 0, 0) == 1.0f);
    /* in a straight vessel no wall is dark, however far one looks; what looks along it is */
    assert_true(sdv_openness(&g, NULL, v3(15, 0, -5), up, 4, 1) > 0.999f);
    assert_true(sdv_openness(&g, NULL, v3(15, 0, -5), up, 40, 1) > 0.999f);
    assert_true(sdv_openness(&g, NULL, v3(15, 0, 5), v3(1, 0, 0), 40, 1) < 0.2f);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

/* ---- distances */
static void random_cone(uint32_t *seed, lao_v4 c[2]) {
    for (int i = 0; i < 2; i++) {
        lao_v3 p = vessel_point(seed, 10);
        c[i] = lao_v4_make(p.x, p.y, p.z, (float)lent_between(seed, 0, 4));
    }
    if (lent_between(seed, 0, 1) < 0.2)
        c[1].w = c[0].w;
}
static lao_v3 mix(lao_v3 a, lao_v3 b, double t) {
    return lao_v3_along(a, lao_v3_sub(b, a), (float)t);
}
/* Least over a triangle's points, by ever finer grids around the best one; the distance is convex.
 */
static double triangle_truth(lao_v3 u, lao_v3 v, lao_v3 w, const lao_v4 c[2]) {
    double least = 1e9, a0 = 0.5, b0 = 0.5, reach = 0.5;
    for (int round = 0; round < 60; round++) {
        double a1 = a0, b1 = b0;
        for (int i = -8; i <= 8; i++) {
            for (int k = -8; k <= 8; k++) {
                double a = fmin(fmax(a0 + reach * i / 8, 0), 1);
                double b = fmin(fmax(b0 + reach * k / 8, 0), 1 - a);
                lao_v3 p = lao_v3_along(lao_v3_along(u, lao_v3_sub(v, u), (float)a),
                                        lao_v3_sub(w, u), (float)b);
                double d = (double)sdv_round_cone(p, c[0], c[1]);
                if (d < least) {
                    least = d;
                    a1 = a;
                    b1 = b;
                }
            }
        }
        a0 = a1;
        b0 = b1;
        reach *= 0.82;
    }
    return least;
}
static void pieces_are_exact(void **state) {
    (void)state;
    uint32_t seed = 11;
    for (int i = 0; i < 1500; i++) {
        lao_v4 c[2];
        double size = i % 3 ? 12 : 40, least = 1e9;
        random_cone(&seed, c);
        lao_v3 u = vessel_point(&seed, size), v = vessel_point(&seed, size),
               w = vessel_point(&seed, size);
        for (int k = 0; k <= 4000; k++)
            least = fmin(least, (double)sdv_round_cone(mix(u, v, k / 4000.0), c[0], c[1]));
        double d = (double)sdv_segment_cone(u, v, c[0], c[1]);
        assert_true(d <= least + 1e-5 && d >= least - length(lao_v3_sub(u, v)) / 8000 - 1e-5);
        double e = triangle_truth(u, v, w, c);
        double f = (double)sdv_triangle_cone(u, v, w, c[0], c[1]);
        assert_true(f <= e + 1e-5 && f >= e - 2e-3); /* the search may stop a little early */
        assert_near(sdv_triangle_cone(u, u, u, c[0], c[1]), sdv_round_cone(u, c[0], c[1]), 1e-5);
        assert_near(sdv_triangle_cone(u, v, v, c[0], c[1]), d, 1e-5);
    }
}

/* A ball-shaped mesh. */
static uint32_t make_mesh(lao_v3 centre, float radius, uint32_t rings, float *p,
                          uint32_t *triangles) {
    uint32_t n = 0, around = 2 * rings;
    for (uint32_t i = 0; i <= rings; i++) {
        for (uint32_t k = 0; k < around; k++) {
            double a = 3.14159265 * i / rings, b = 6.28318531 * k / around;
            float *q = p + 3 * (i * around + k);
            q[0] = centre.x + radius * (float)(sin(a) * cos(b));
            q[1] = centre.y + radius * (float)(sin(a) * sin(b));
            q[2] = centre.z + radius * (float)cos(a);
        }
    }
    for (uint32_t i = 0; i < rings; i++) {
        for (uint32_t k = 0; k < around; k++) {
            uint32_t a = i * around + k, b = i * around + (k + 1) % around;
            const uint32_t t[] = {a, b, a + around, b, b + around, a + around};
            memcpy(triangles + 3 * n, t, sizeof t);
            n += 2;
        }
    }
    return n;
}
static void targets_equal_brute_force(void **state) {
    (void)state;
    static float p[3 * 2000];
    static uint32_t triangles[3 * 4000];
    uint32_t seed = 3, n = make_mesh(v3(5, 5, 0), 8, 20, p, triangles);
    sdv_target *mesh, *path, *ball;
    sdv_target_desc of_mesh = {21 * 40, p, n, triangles, 0}, of_path = {200, p, 0, NULL, 0.5f};
    const float middle[] = {1, 2, 3};
    sdv_target_desc of_ball = {1, middle, 0, NULL, 4};
    assert_int_equal(sdv_target_create(NULL, &of_mesh, &mesh), LAO_OK);
    assert_int_equal(sdv_target_create(NULL, &of_path, &path), LAO_OK);
    assert_int_equal(sdv_target_create(NULL, &of_ball, &ball), LAO_OK);
#define POINT(i) lao_v3_make(p[3 * (i)], p[3 * (i) + 1], p[3 * (i) + 2])
    for (int i = 0; i < 300; i++) {
        lao_v4 c[2];
        float to_mesh = 1e9f, to_path = 1e9f;
        random_cone(&seed, c);
        for (uint32_t k = 0; k < n; k++)
            to_mesh = fminf(to_mesh,
                            sdv_triangle_cone(POINT(triangles[3 * k]), POINT(triangles[3 * k + 1]),
                                              POINT(triangles[3 * k + 2]), c[0], c[1]));
        for (uint32_t k = 0; k + 1 < 200; k++)
            to_path = fminf(to_path, sdv_segment_cone(POINT(k), POINT(k + 1), c[0], c[1]));
        assert_near(sdv_target_cone(mesh, c[0], c[1]), (double)to_mesh, 2e-6);
        assert_near(sdv_target_cone(path, c[0], c[1]), (double)to_path - 0.5, 2e-6);
        assert_near(sdv_target_cone(ball, c[0], c[1]),
                    (double)sdv_round_cone(v3(1, 2, 3), c[0], c[1]) - 4, 2e-6);
        lao_v3 q = vessel_point(&seed, 30);
        assert_near(sdv_target_point(ball, q), length(lao_v3_sub(q, v3(1, 2, 3))) - 4, 1e-5);
        double outside = fabs(length(lao_v3_sub(q, v3(5, 5, 0))) - 8);
        assert_near(sdv_target_point(mesh, q), outside, 0.06); /* facets */
    }
    sdv_target_free(mesh);
    sdv_target_free(path);
    sdv_target_free(ball);
    sdv_target_free(NULL);
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
static void distances_of_branches(void **state) {
    (void)state;
    enum { N = 3000, RINGS = 100 };
    static float p[3 * (RINGS + 1) * 2 * RINGS], per_segment[N], per_node[2 * N];
    static uint32_t triangles[3 * 4 * RINGS * RINGS];
    sdv_tree t = random_tree(8, N, 200, 2);
    sdv_reduced r;
    sdv_target *target;
    sdv_target_desc desc = {(RINGS + 1) * 2 * RINGS, p,
                            make_mesh(v3(10, 20, 30), 25, RINGS, p, triangles), triangles, 0};
    lent_host host;
    sdv_host h = vessel_host_make(&host);
    assert_int_equal(sdv_reduce(NULL, &t, &r), LAO_OK);
    assert_int_equal(sdv_target_create(&h, &desc, &target), LAO_OK);
    double start = seconds();
    assert_int_equal(sdv_target_distances(&h, target, &t, &r, per_segment, per_node), LAO_OK);
    printf("%u segments to %u triangles: %.0f ms\n", t.segment_count, desc.triangle_count,
           1e3 * (seconds() - start));
    for (uint32_t i = 0; i < r.node_count; i++) {
        uint32_t node = r.ids[i];
        float least = NAN;
        if (node < t.node_count && t.parents[node] != SDV_NONE) {
            do { /* up to the reduced parent */
                least = fminf(least, per_segment[t.parent_segments[node]]);
                node = t.parents[node];
            } while (t.child_counts[node] == 1 && t.parents[node] != SDV_NONE);
        }
        assert_true(isnan(least) ? isnan(per_node[i]) : least == per_node[i]);
    }
    static float again[2 * N];
    host.backwards = 1;
    assert_int_equal(sdv_target_distances(&h, target, &t, &r, NULL, again), LAO_OK);
    assert_memory_equal(per_node, again, r.node_count * sizeof *again);
    host.cancel_at = host.progress_calls + 1;
    assert_int_equal(sdv_target_distances(&h, target, &t, &r, NULL, again), LAO_ERROR_NOT_READY);
    host.memory.fail_allocation = host.memory.allocations + 1;
    assert_int_equal(sdv_target_distances(&h, target, &t, &r, NULL, again),
                     LAO_ERROR_OUT_OF_MEMORY);
    assert_int_equal(sdv_target_distances(&h, target, &t, NULL, NULL, again),
                     LAO_ERROR_INVALID_ARGUMENT);
    sdv_target_free(target);
    assert_int_equal(host.memory.bytes, 0);
    sdv_reduced_free(&r);
    sdv_tree_free(&t);
}

static void odd_targets(void **state) {
    (void)state;
    lent_host host;
    sdv_host h = vessel_host_make(&host);
    const float p[] = {0, 0, 0, 0, 0, 0, 1, 0, 0, 1, NAN, 0};
    const uint32_t triangles[] = {0, 1, 2, 0, 0, 0, 2, 2, 4};
    sdv_target *t = NULL;
    sdv_target_desc desc = {4, p, 0, NULL, 0};
#define REFUSED(what)                                                                              \
    do {                                                                                           \
        assert_true(sdv_target_create(&h, &desc, &t) != LAO_OK);                                   \
        assert_int_equal(host.item, SDV_LOG_##what);                                               \
        assert_null(t);                                                                            \
        assert_int_equal(host.memory.bytes, 0);                                                    \
    } while (0)
    REFUSED(TARGET_SHAPE);
    desc.point_count = 3;
    desc.triangle_count = 3;
    desc.triangles = triangles;
    REFUSED(TARGET_SHAPE);
    assert_non_null(strstr(host.text, "triangle 2"));
    desc.triangle_count = 2;
    desc.radius = NAN;
    REFUSED(TARGET_SHAPE);
    desc.radius = 0;
    desc.points = NULL;
    REFUSED(NULL_ARGUMENT);
    desc.points = p;
    for (uint32_t n = 1; n <= 4; n++) {
        host.memory.fail_allocation = host.memory.allocations + n;
        REFUSED(MEMORY);
    }
    host.memory.fail_allocation = 0;
    for (uint32_t kind = 0; kind < 2; kind++) { /* degenerate triangles, a path */
        desc.triangle_count = kind == 0 ? 2 : 0;
        assert_int_equal(sdv_target_create(&h, &desc, &t), LAO_OK);
        assert_near(sdv_target_point(t, v3(1, 2, 0)), 2, 1e-6);
        assert_near(sdv_target_point(t, v3(0.5, 2, 0)), 2, 1e-6);
        sdv_target_free(t);
    }
    assert_int_equal(host.memory.bytes, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outlines_and_depth_shadows),
        cmocka_unit_test(shapes_have_distances),
        cmocka_unit_test(boolean_operations),
        cmocka_unit_test(carving_opens_vessels),
        cmocka_unit_test(near_misses_of_shapes),
        cmocka_unit_test(shapes_cast_shadows),
        cmocka_unit_test(tree_in_a_cut),
        cmocka_unit_test(smooth_normals),
        cmocka_unit_test(light_and_openness),
        cmocka_unit_test(pieces_are_exact),
        cmocka_unit_test(targets_equal_brute_force),
        cmocka_unit_test(distances_of_branches),
        cmocka_unit_test(odd_targets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
