/* Elliptic and noisy vessels: cross sections have the radii that were asked for, the noise moves
   the surface by no more than its amplitude and has the slope that is said, the bound is
   1-Lipschitz with the true normal as its gradient, cones meet without a step, rays stop where a
   walk in small steps does, ratio 1 and amplitude 0 change nothing, and a grid whose nodes moved is
   one built anew. */
#include "vessel_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { NODES = 40 };

typedef struct scene {
    sdv_tree tree;
    sdv_grid grid;
    sdv_attribute attributes[3];
    float ratio[NODES], amplitude[NODES], axis[3 * NODES];
} scene;

static float between(uint32_t *state, float low, float high) {
    *state = *state * 747796405u + 2891336453u;
    return low + (high - low) * (float)(*state >> 8) / 16777216.0f;
}
static lao_v3 somewhere(uint32_t *state, float reach) {
    float x = between(state, -reach, reach), y = between(state, -reach, reach);
    return lao_v3_make(x, y, between(state, -reach, reach));
}

/* round: ratio 1 and amplitude 0 throughout */
static void make(scene *s, uint32_t n, const float *positions, const float *radii,
                 const sdv_segment *segments, int round, uint32_t seed) {
    sdv_tree_desc desc;
    sdv_grid_desc grid;
    uint32_t i, k;
    memset(s, 0, sizeof *s);
    memset(&desc, 0, sizeof desc);
    memset(&grid, 0, sizeof grid);
    for (i = 0; i < n; i++) {
        s->ratio[i] = round ? 1.0f : between(&seed, 0.3f, 1.0f);
        s->amplitude[i] = round ? 0.0f : radii[i] * between(&seed, 0.0f, 0.5f);
        for (k = 0; k < 3; k++)
            s->axis[3 * i + k] = between(&seed, -1, 1);
    }
    s->attributes[0] = (sdv_attribute){SDV_SECTION_RATIO, 1, s->ratio};
    s->attributes[1] = (sdv_attribute){SDV_UNCERTAINTY, 1, s->amplitude};
    s->attributes[2] = (sdv_attribute){SDV_SECTION_AXIS, 3, s->axis};
    desc.node_count = n;
    desc.positions = positions;
    desc.radii = radii;
    desc.segment_count = n - 1;
    desc.segments = segments;
    desc.node_attributes = s->attributes;
    desc.node_attribute_count = 3;
    grid.resolution = 48;
    assert_int_equal(sdv_tree_build(NULL, &desc, &s->tree), LAO_OK);
    assert_int_equal(sdv_grid_build(NULL, &s->tree, &grid, &s->grid), LAO_OK);
    assert_true(round ? !s->grid.forms : s->grid.forms != NULL);
}
static void make_random(scene *s, uint32_t seed, int round) {
    float positions[3 * NODES], radii[NODES];
    sdv_segment segments[NODES];
    vessel_random_tree(seed, NODES, 10, 1.2, positions, radii, segments);
    make(s, NODES, positions, radii, segments, round, seed);
}
static void done(scene *s) {
    sdv_grid_free(&s->grid);
    sdv_tree_free(&s->tree);
}

static sdv_form form_of(const sdv_grid *g, uint32_t i) {
    const lao_v4 *f = g->forms + 3 * (size_t)i;
    return (sdv_form){f[0], f[1], f[2]};
}
/* The level of cone i, where it is known how fast it may rise, divided by that. */
static double level(const sdv_grid *g, uint32_t i, lao_v3 p) {
    const lao_v4 *c = g->cones + 2 * (size_t)i;
    sdv_form f = form_of(g, i);
    return (double)(lao_min(sdv_form_level(p, c[0], c[1], f).w, sdv_form_most(c[0], c[1], f)) /
                    f.bump.z);
}
static double least_level(const sdv_grid *g, lao_v3 p) {
    double least = 1e30;
    uint32_t i;
    for (i = 0; i < g->cone_count; i++)
        least = fmin(least, level(g, i, p));
    return least;
}

/* ---------------------------------------------------------------------------------------- tests */

static void noise(void **state) {
    uint32_t seed = 1, i;
    double most = 0, low = 1, high = -1;
    (void)state;
    for (i = 0; i < 300000; i++) {
        lao_v3 p = somewhere(&seed, 40);
        lao_v4 n = sdv_noise(p);
        lao_v3 g = lao_v3_make(n.x, n.y, n.z), d = somewhere(&seed, 1.0f / 256);
        float value = sdv_noise(lao_v3_add(p, d)).w;
        double step = sqrt((double)lao_v3_dot(d, d));
        most = fmax(most, sqrt((double)lao_v3_dot(g, g)));
        low = fmin(low, (double)n.w);
        high = fmax(high, (double)n.w);
        assert_true(fabs((double)(value - n.w)) <= SDV_NOISE_SLOPE * step + 1e-6);
        assert_true(fabs((double)(value - n.w - lao_v3_dot(g, d))) <= 20 * step * step + 4e-6);
    }
    assert_true(most <= (double)SDV_NOISE_SLOPE && most > 2.5);
    assert_true(low >= -1 && low < -0.8 && high <= 1 && high > 0.8);
    assert_true(isfinite(sdv_noise(lao_v3_make(1e30f, -1e30f, 3e9f)).w));
}

/* One straight vessel along x, ellipses of 2 x 1 mm, the shorter axis along z. */
static void sections(void **state) {
    static const float positions[] = {0, 0, 0, 20, 0, 0}, radii[] = {2, 2};
    static const sdv_segment segments[] = {{0, 1}};
    scene s;
    int i;
    (void)state;
    make(&s, 2, positions, radii, segments, 1, 1);
    for (i = 0; i < 2; i++) {
        s.ratio[i] = 0.5f;
        s.axis[3 * i] = s.axis[3 * i + 1] = 0;
        s.axis[3 * i + 2] = i ? -1.0f : 1.0f; /* the same axis */
    }
    s.tree.node_attributes = s.attributes;
    sdv_grid_free(&s.grid);
    assert_int_equal(sdv_grid_build(NULL, &s.tree, NULL, &s.grid), LAO_OK);
    for (i = 0; i < 64; i++) {
        float turn = (float)i / 64, y = 2 * lao_cos_turns(turn), z = lao_sin_turns(turn);
        sdv_ray ray;
        sdv_hit hit;
        memset(&ray, 0, sizeof ray);
        ray.direction = lao_v3_unit(lao_v3_make(0, -y, -z), lao_v3_make(0, 0, 1));
        ray.origin = lao_v3_along(lao_v3_make(9, 0, 0), ray.direction, -15);
        sdv_trace(&s.grid, &ray, &hit);
        assert_int_equal(hit.cone, 0);
        assert_true(fabsf(hit.position.y - y) < 1e-3f && fabsf(hit.position.z - z) < 1e-3f);
        lao_v3 n = lao_v3_unit(lao_v3_make(0, y / 4, z), lao_v3_make(0, 0, 1));
        assert_true(lao_v3_dot(n, hit.normal) > 0.99999f);
    }
    done(&s);
}

/* A straight vessel of 2 mm, uncertain by 0.4 at one end and 0.8 at the other: the surface goes up
   to that from the radius, in and out, and no farther. */
static void amplitudes(void **state) {
    static const float positions[] = {0, 0, 0, 40, 0, 0}, radii[] = {2, 2};
    static const sdv_segment segments[] = {{0, 1}};
    uint32_t seed = 5, i;
    float low = 0, high = 0;
    scene s;
    (void)state;
    make(&s, 2, positions, radii, segments, 1, 1);
    s.amplitude[0] = 0.4f;
    s.amplitude[1] = 0.8f;
    s.tree.node_attributes = s.attributes;
    sdv_grid_free(&s.grid);
    assert_int_equal(sdv_grid_build(NULL, &s.tree, NULL, &s.grid), LAO_OK);
    for (i = 0; i < 2000; i++) {
        float turn = between(&seed, 0, 1), x = between(&seed, 3, 37), off;
        sdv_ray ray;
        sdv_hit hit;
        memset(&ray, 0, sizeof ray);
        ray.direction = lao_v3_make(0, -lao_cos_turns(turn), -lao_sin_turns(turn));
        ray.origin = lao_v3_along(lao_v3_make(x, 0, 0), ray.direction, -15);
        sdv_trace(&s.grid, &ray, &hit);
        assert_int_equal(hit.cone, 0);
        off = (15 - hit.t - 2) / (0.4f + 0.4f * x / 40);
        low = lao_min(low, off);
        high = lao_max(high, off);
    }
    assert_true(low >= -1.02f && low < -0.5f && high <= 1.02f && high > 0.5f);
    done(&s);
}

static void lipschitz(void **state) {
    uint32_t seed = 3, i, outside = 0, inside = 0;
    scene s;
    (void)state;
    make_random(&s, 5, 0);
    for (i = 0; i < 200000; i++) {
        uint32_t k = i % s.grid.cone_count;
        const lao_v4 *c = s.grid.cones + 2 * (size_t)k;
        sdv_form f = form_of(&s.grid, k);
        float reach = i % 3 ? 2.0f : 20.0f;
        lao_v3 p = lao_v3_add(lao_v3_make(c[0].x, c[0].y, c[0].z), somewhere(&seed, reach));
        lao_v3 d = somewhere(&seed, i % 2 ? 0.02f : 3.0f), q = lao_v3_add(p, d);
        lao_v4 there = sdv_form_level(p, c[0], c[1], f), elsewhere;
        float round = sdv_round_cone(p, c[0], c[1]);
        float bound = sdv_form_bound(round, there, c[0], c[1], f), other;
        elsewhere = sdv_form_level(q, c[0], c[1], f);
        other = sdv_form_bound(sdv_round_cone(q, c[0], c[1]), elsewhere, c[0], c[1], f);
        assert_true(fabsf(bound - other) <= lao_sqrt(lao_v3_dot(d, d)) + 2e-5f);
        assert_true(bound >= round); /* lies inside the round cone */
        assert_true((bound < 0) == (there.w < 0) || fabsf(there.w) < 1e-5f);
        outside += round > 0;
        inside += there.w < 0;
    }
    assert_true(outside > 1000 && inside > 1000);
    done(&s);
}

/* The gradient is that of the level, by differences, where those on both sides agree. */
static void gradients(void **state) {
    uint32_t seed = 9, i, checked = 0;
    scene s;
    (void)state;
    make_random(&s, 6, 0);
    for (i = 0; i < 40000; i++) {
        const float h = 4e-3f;
        uint32_t k = i % s.grid.cone_count;
        const lao_v4 *c = s.grid.cones + 2 * (size_t)k;
        sdv_form f = form_of(&s.grid, k);
        float ratio = 1 / (1 + lao_max(f.a.w, f.b.w)); /* levels are of stretched space */
        lao_v3 p = lao_v3_add(lao_v3_make(c[0].x, c[0].y, c[0].z), somewhere(&seed, 2));
        lao_v3 d = lao_v3_unit(somewhere(&seed, 1), lao_v3_make(1, 0, 0));
        lao_v4 at = sdv_form_level(p, c[0], c[1], f);
        float up = ratio * (sdv_form_level(lao_v3_along(p, d, h), c[0], c[1], f).w - at.w);
        float down = ratio * (at.w - sdv_form_level(lao_v3_along(p, d, -h), c[0], c[1], f).w);
        float slope = ratio * lao_v3_dot(lao_v3_make(at.x, at.y, at.z), d);
        if (fabsf(up - down) < 0.02f * h) {
            assert_true(fabsf(0.5f * (up + down) / h - slope) < 0.012f);
            checked++;
        }
    }
    assert_true(checked > 10000);
    done(&s);
}

/* Rays against steps of 1/500 mm through all cones: none passes what they find, and what is hit is
   the surface of its cone. */
static void rays(void **state) {
    uint32_t seed = 11, i, hits = 0;
    scene s;
    (void)state;
    make_random(&s, 7, 0);
    for (i = 0; i < 250; i++) {
        sdv_ray ray;
        sdv_hit hit;
        double t, end;
        memset(&ray, 0, sizeof ray);
        lao_v3 to = somewhere(&seed, 6);
        ray.origin = lao_v3_scale(lao_v3_unit(somewhere(&seed, 1), to), 25);
        ray.direction = lao_v3_unit(lao_v3_sub(to, ray.origin), to);
        sdv_trace(&s.grid, &ray, &hit);
        end = hit.cone != SDV_NONE ? (double)hit.t - 2e-3 : 50;
        for (t = 10; t < end; t += 2e-3) {
            double d = least_level(&s.grid, lao_v3_along(ray.origin, ray.direction, (float)t));
            assert_true(d > -2e-4); /* of a ray that grazes: it passes by less than a hit is off */
            t += fmax(d - 1e-3, 0);
        }
        if (hit.cone != SDV_NONE) {
            const lao_v4 *c = s.grid.cones + 2 * (size_t)hit.cone;
            lao_v4 n = sdv_form_estimate(hit.position, c[0], c[1], form_of(&s.grid, hit.cone));
            assert_true(fabsf(n.w) < 4e-3f * s.grid.cell);
            assert_true(level(&s.grid, hit.cone, hit.position) <=
                        least_level(&s.grid, hit.position) + 1e-6);
            assert_true(lao_v3_dot(hit.normal, lao_v3_make(n.x, n.y, n.z)) > 0.9999f);
            hits++;
        }
    }
    assert_true(hits > 50 && hits < 240);
    done(&s);
}

/* The ellipsoid that stands at a node: its shorter axis at a right angle to the mean of the two
 * cones that meet there. A direction of unit length to its surface, from the middle. */
static lao_v3 on_ellipsoid(const scene *s, uint32_t node, lao_v3 u, lao_v3 *minor) {
    const lao_v4 *n = s->tree.nodes + node;
    double along[3] = {0, 0, 0}, m[3], d[2][3], by = 0, size = 0, length[2] = {0, 0};
    int i, k;
    for (i = 0; i < 2; i++) {
        d[i][0] = (double)n[i].x - (double)n[i - 1].x;
        d[i][1] = (double)n[i].y - (double)n[i - 1].y;
        d[i][2] = (double)n[i].z - (double)n[i - 1].z;
        for (k = 0; k < 3; k++)
            length[i] += d[i][k] * d[i][k];
    }
    for (k = 0; k < 3; k++) {
        along[k] = d[0][k] / sqrt(length[0]) + d[1][k] / sqrt(length[1]);
        by += along[k] * (double)s->axis[3 * node + (uint32_t)k];
        size += along[k] * along[k];
    }
    for (k = 0; k < 3; k++)
        m[k] = (double)s->axis[3 * node + (uint32_t)k] - by / size * along[k];
    *minor = lao_v3_unit(lao_v3_make((float)m[0], (float)m[1], (float)m[2]), u);
    return lao_v3_along(u, *minor, (s->ratio[node] - 1) * lao_v3_dot(u, *minor));
}

/* A bent vessel whose section flattens and turns from node to node: where two cones meet, both have
 * the ellipsoid of the node as their end, so that there is no step between them. */
static void joints(void **state) {
    float positions[3 * NODES], radii[NODES];
    sdv_segment segments[NODES];
    uint32_t seed = 21, i, k, ends = 0;
    scene s;
    (void)state;
    for (i = 0; i < NODES; i++) {
        positions[3 * i] = 2.5f * (float)i;
        positions[3 * i + 1] = 3 * lao_cos_turns((float)i / 12);
        positions[3 * i + 2] = 3 * lao_sin_turns((float)i / 9);
        radii[i] = 1.5f;
        segments[i] = (sdv_segment){i, i + 1};
    }
    make(&s, NODES, positions, radii, segments, 0, 3);
    memset(s.amplitude, 0, sizeof s.amplitude);
    s.tree.node_attributes = s.attributes;
    sdv_grid_free(&s.grid);
    assert_int_equal(sdv_grid_build(NULL, &s.tree, NULL, &s.grid), LAO_OK);
    for (i = 0; i < 20000; i++) {
        uint32_t node = 1 + i % (NODES - 2);
        lao_v3 u = lao_v3_unit(somewhere(&seed, 1), lao_v3_make(1, 0, 0)), m;
        lao_v3 off = lao_v3_scale(on_ellipsoid(&s, node, u, &m), 1.5f);
        const float *at = positions + 3 * (size_t)node;
        for (k = 0; k < 2;
             k++) { /* the cone that comes, seen from its end, and the one that goes */
            const lao_v4 *c = s.grid.cones + 2 * (size_t)(node - 1 + k);
            lao_v3 axis = lao_v3_sub(sdv_xyz(c[1 - k]), sdv_xyz(c[k])), stretched;
            sdv_form f = form_of(&s.grid, node - 1 + k);
            if (lao_v3_dot(off, axis) < 0)
                continue; /* not behind the end */
            float d =
                sdv_form_level(lao_v3_add(lao_v3_make(at[0], at[1], at[2]), off), c[0], c[1], f).w;
            stretched = lao_v3_along(axis, m, (1 / s.ratio[node] - 1) * lao_v3_dot(axis, m));
            assert_true(d < 2e-5f);
            if (lao_v3_dot(u, stretched) > 0) {
                assert_true(d > -2e-5f);
                ends++;
            }
        }
    }
    assert_true(ends > 10000);
    done(&s);
}

/* Where no node has an ellipse or noise, the grid is that of a tree without such attributes. */
static void round_forms(void **state) {
    scene s;
    sdv_grid plain;
    sdv_grid_desc desc;
    (void)state;
    memset(&desc, 0, sizeof desc);
    make_random(&s, 8, 1);
    s.tree.node_attribute_count = 0;
    desc.resolution = 48;
    assert_int_equal(sdv_grid_build(NULL, &s.tree, &desc, &plain), LAO_OK);
    assert_int_equal(plain.id_count, s.grid.id_count);
    assert_memory_equal(plain.cells, s.grid.cells, plain.cell_count * sizeof *plain.cells);
    assert_memory_equal(plain.cones, s.grid.cones, 2 * plain.cone_count * sizeof *plain.cones);
    sdv_grid_free(&plain);
    done(&s);
}

/* Moved nodes give the bits of a new grid in the same box, forms included. */
static void moved(void **state) {
    static const uint32_t nodes[] = {4, 17};
    scene s;
    sdv_grid fresh;
    sdv_grid_desc box;
    (void)state;
    make_random(&s, 9, 0);
    s.tree.nodes[4].x += 0.7f;
    s.tree.nodes[17].w *= 0.8f;
    assert_int_equal(sdv_grid_update(NULL, &s.tree, nodes, 2, &s.grid), LAO_OK);
    memset(&box, 0, sizeof box);
    box.origin = &s.grid.origin.x;
    box.cell = s.grid.cell;
    memcpy(box.size, s.grid.size, sizeof box.size);
    assert_int_equal(sdv_grid_build(NULL, &s.tree, &box, &fresh), LAO_OK);
    assert_memory_equal(fresh.cones, s.grid.cones, 5 * fresh.cone_count * sizeof *fresh.cones);
    assert_memory_equal(fresh.cells, s.grid.cells, fresh.cell_count * sizeof *fresh.cells);
    sdv_grid_free(&fresh);
    done(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise),     cmocka_unit_test(sections),    cmocka_unit_test(amplitudes),
        cmocka_unit_test(lipschitz), cmocka_unit_test(gradients),   cmocka_unit_test(rays),
        cmocka_unit_test(joints),    cmocka_unit_test(round_forms), cmocka_unit_test(moved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
