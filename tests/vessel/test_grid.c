/* The grid of a tree's field holds what its description says: lists, nearest cells, distances and
   steps equal brute force; no sign is wrong; the order of work does not matter; a moved node
   changes it to the bits of a full build, be it the root of a thick trunk; what cannot be is
   refused and nothing leaks. */
#include "vessel_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <cmocka.h>

enum { MOST = 8192 };
static float positions[3 * MOST], radii[MOST];
static sdv_segment segments[MOST];

static sdv_tree random_tree(uint32_t seed, uint32_t n, double size, double radius) {
    sdv_tree t;
    vessel_random_tree(seed, n, size, radius, positions, radii, segments);
    sdv_tree_desc desc = {n, positions, radii, n - 1, segments, 0, NULL, NULL, 0, 0};
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    return t;
}
/* Balls without segments. */
static sdv_tree loose_tree(uint32_t seed, uint32_t n, double size, double radius) {
    sdv_tree t;
    vessel_random_tree(seed, n, size, radius, positions, radii, segments);
    sdv_tree_desc desc = {n, positions, radii, 0, NULL, 0, NULL, NULL, 0, 0};
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    return t;
}
static sdv_grid build(const sdv_tree *tree, uint32_t resolution) {
    sdv_grid g;
    sdv_grid_desc desc = {resolution, NULL, 0, {0, 0, 0}};
    assert_int_equal(sdv_grid_build(NULL, tree, &desc, &g), LAO_OK);
    return g;
}
static sdv_box box_of(const sdv_grid *g) {
    sdv_box box = {g->origin, g->cell, {(float)g->size[0], (float)g->size[1], (float)g->size[2]}};
    return box;
}
static lao_v3 centre_of(const sdv_grid *g, uint32_t i) {
    return sdv_cell_centre(box_of(g), i % g->size[0], i / g->size[0] % g->size[1],
                           i / g->size[0] / g->size[1]);
}
static void assert_same(const sdv_grid *a, const sdv_grid *b) {
    assert_memory_equal(&a->origin, &b->origin, sizeof a->origin);
    assert_true(a->cell == b->cell);
    assert_memory_equal(a->size, b->size, sizeof a->size);
    assert_int_equal(a->id_count, b->id_count);
    assert_int_equal(a->cone_count, b->cone_count);
    assert_memory_equal(a->cones, b->cones, 2 * a->cone_count * sizeof *a->cones);
    assert_memory_equal(a->ids, b->ids, a->id_count * sizeof *a->ids);
    assert_memory_equal(a->cells, b->cells, a->cell_count * sizeof *a->cells);
    assert_memory_equal(a->layer, b->layer, a->cell_count * sizeof *a->layer);
    assert_memory_equal(a->occupied, b->occupied,
                        (size_t)(a->size[0] + 31) / 32 * a->size[1] * a->size[2] * 4);
}

static void check_lists(const sdv_grid *g) {
    uint32_t at = 0;
    for (uint32_t i = 0; i < g->cell_count; i++) {
        const lao_v4 *cell = g->cells + i;
        lao_v3 p = centre_of(g, i);
        uint32_t n = 0;
        for (uint32_t k = 0; k < g->cone_count; k++) {
            if (sdv_round_cone(p, g->cones[2 * k], g->cones[2 * k + 1]) <= 2.0f * g->cell) {
                assert_true((float)n < cell->w && g->ids[at + n] == (float)k);
                n++;
            }
        }
        assert_true(cell->w == (float)n);
        if (n)
            assert_true(cell->z == (float)at);
        at += n;
    }
    assert_int_equal(at, g->id_count);
}
static int64_t apart2(const sdv_grid *g, uint32_t i, uint32_t j) {
    int64_t sum = 0;
    for (int k = 0; k < 3; k++) {
        int64_t d = (int64_t)(i % g->size[k]) - (int64_t)(j % g->size[k]);
        sum += d * d;
        i /= g->size[k];
        j /= g->size[k];
    }
    return sum;
}
static void check_nearest(const sdv_grid *g) {
    for (uint32_t i = 0; i < g->cell_count; i++) {
        int64_t least = INT64_MAX;
        uint32_t best = 0;
        for (uint32_t k = 0; k < g->cell_count; k++) {
            if (g->cells[k].w > 0 && apart2(g, i, k) < least) {
                least = apart2(g, i, k);
                best = k;
            }
        }
        assert_true(g->cells[i].y == (float)best);
    }
}
/* How far the distances of empty cells are too great, in cells; on average in *mean. */
static double check_distances(const sdv_grid *g, uint32_t rounds, double *mean) {
    uint32_t seed = 7, empty = 0;
    double most = 0, sum = 0;
    for (uint32_t i = 0; i < rounds; i++) {
        uint32_t c = (uint32_t)lent_between(&seed, 0, g->cell_count), cone, nearest;
        const lao_v4 *cell = g->cells + c;
        lao_v3 p = centre_of(g, c), q = p;
        float d = sdv_cones_distance(g->cones, g->cone_count, p, NULL);
        q.x += g->cell * (float)lent_between(&seed, -0.5, 0.5);
        q.y += g->cell * (float)lent_between(&seed, -0.5, 0.5);
        q.z += g->cell * (float)lent_between(&seed, -0.5, 0.5);
        float e = sdv_cones_distance(g->cones, g->cone_count, q, &nearest);
        float own = sdv_grid_distance(g, q, &cone);
        if (cell->w > 0) {
            assert_true(cell->x == d && cell->y == (float)c);
            if (e < 1.125f * g->cell) {
                assert_true(own == e);
                assert_int_equal(cone, nearest);
            }
        } else {
            double over = (double)(cell->x - d) / (double)g->cell;
            assert_true(over >= 0 && over <= 1.74);
            most = fmax(most, over);
            sum += over;
            empty++;
            assert_true(e >= cell->z); /* a ray may go that far from anywhere in the cell */
        }
        assert_true(own >= e && own <= e + 3.47f * g->cell);
        assert_true((own < 0) == (e < 0)); /* no wrong sign */
    }
    *mean = sum / fmax(empty, 1);
    return most;
}

static void equals_brute_force(void **state) {
    (void)state;
    for (uint32_t seed = 0; seed < 12; seed++) {
        sdv_tree t = seed % 3 == 2 ? loose_tree(seed, 40, 100, seed % 2 ? 0.01 : 5)
                                   : random_tree(seed, 60, 100, seed % 2 ? 9 : 1);
        sdv_grid g = build(&t, seed % 4 ? 16 : 24);
        double mean;
        check_lists(&g);
        check_nearest(&g);
        check_distances(&g, 3000, &mean);
        assert_int_equal(g.cone_count, seed % 3 == 2 ? 40 : 59);
        sdv_grid_free(&g);
        sdv_grid_free(&g);
        sdv_tree_free(&t);
    }
}

/* A thick trunk with a thin branch that starts on its axis: two-sided lists would get signs wrong.
 */
static void no_sign_is_wrong(void **state) {
    (void)state;
    const float p[] = {0, 0, 0, 30, 0, 0, 15, 0, 0, 15, 20, 0}, r[] = {6, 6, 2, 2};
    const sdv_segment s[] = {{0, 1}, {2, 3}};
    sdv_tree_desc desc = {4, p, r, 2, s, 0, NULL, NULL, 0, 0};
    sdv_tree t;
    double mean;
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    sdv_grid g = build(&t, 34);
    check_lists(&g);
    check_distances(&g, 100000, &mean);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

static void one_ball(void **state) {
    (void)state;
    const float p[] = {1, 2, 3}, r[] = {10};
    sdv_tree_desc desc = {1, p, r, 0, NULL, 0, NULL, NULL, 0, 0};
    sdv_tree t;
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    sdv_grid g = build(&t, 64);
    assert_int_equal(g.size[0], 64);
    for (uint32_t i = 0; i < g.cell_count; i++) {
        lao_v3 c = centre_of(&g, i);
        double x = (double)c.x - 1, y = (double)c.y - 2, z = (double)c.z - 3;
        assert_true(fabs((double)g.cells[i].x - (sqrt(x * x + y * y + z * z) - 10)) <= 1e-5);
    }
    sdv_grid_free(&g);
    t.nodes[0].w = 0; /* a point */
    g = build(&t, 16);
    assert_true(g.cell == 1.0f && g.id_count > 0);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

static void order_does_not_matter(void **state) {
    (void)state;
    lent_host host;
    sdv_host h = vessel_host_make(&host);
    sdv_tree t = random_tree(5, 300, 100, 3);
    sdv_grid a = build(&t, 64), b;
    sdv_grid_desc desc = {64, NULL, 0, {0, 0, 0}};
    host.backwards = 1;
    assert_int_equal(sdv_grid_build(&h, &t, &desc, &b), LAO_OK);
    assert_same(&a, &b);
    assert_true(host.progress_calls > 10 && host.done == host.total);
    sdv_grid_free(&a);
    sdv_grid_free(&b);
    assert_int_equal(host.memory.bytes, 0);
    sdv_tree_free(&t);
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now); /* not what others run */
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static sdv_grid build_like(const sdv_tree *t, const sdv_grid *g) {
    sdv_grid fresh;
    sdv_grid_desc desc = {0, &g->origin.x, g->cell, {g->size[0], g->size[1], g->size[2]}};
    assert_int_equal(sdv_grid_build(NULL, t, &desc, &fresh), LAO_OK);
    return fresh;
}

static void moved_nodes_equal_a_full_build(void **state) {
    (void)state;
    for (uint32_t round = 0; round < 6; round++) {
        uint32_t seed = round + 1, n = round < 4 ? 200 : 50;
        sdv_tree t = round == 5 ? loose_tree(round, n, 90, 4) : random_tree(round, n, 90, 3);
        sdv_grid g = build(&t, 32 + 8 * round);
        lent_host host;
        sdv_host h = vessel_host_make(&host);
        host.backwards = (int)round % 2;
        for (int i = 0; i < 12; i++) {
            uint32_t nodes[3], count = 1 + (uint32_t)i % 3;
            for (uint32_t k = 0; k < count; k++) {
                nodes[k] = (uint32_t)lent_between(&seed, 0, n);
                lao_v4 *p = t.nodes + nodes[k];
                p->x += (float)lent_between(&seed, -8, 8);
                p->y += (float)lent_between(&seed, -8, 8);
                p->z += (float)lent_between(&seed, -8, 8);
                p->w = (float)lent_between(&seed, 0, 3);
            }
            assert_int_equal(sdv_grid_update(&h, &t, nodes, count, &g), LAO_OK);
            sdv_grid fresh = build_like(&t, &g);
            assert_same(&g, &fresh);
            sdv_grid_free(&fresh);
        }
        sdv_grid_free(&g);
        sdv_tree_free(&t);
    }
}

static void leaving_the_box_builds_anew(void **state) {
    (void)state;
    sdv_tree t = random_tree(3, 100, 50, 2);
    sdv_grid g = build(&t, 32);
    uint32_t node = 5;
    t.nodes[node].x += 100;
    assert_int_equal(sdv_grid_update(NULL, &t, &node, 1, &g), LAO_OK);
    assert_int_equal(g.rebuilt, 1);
    sdv_grid fresh = build(&t, 32);
    assert_same(&g, &fresh);
    sdv_grid_free(&fresh);
    t.nodes[node].x -= 1;
    assert_int_equal(sdv_grid_update(NULL, &t, &node, 1, &g), LAO_OK);
    assert_int_equal(g.rebuilt, 0);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

/* Like trees of organs: short segments, radii a hundredth of the extent or less. */
static sdv_tree organ_tree(uint32_t n) {
    sdv_tree t = random_tree(11, n, 200, 2);
    for (uint32_t i = 1; i < n; i++) { /* pull every node towards its parent */
        const lao_v4 *a = t.nodes + t.parents[i];
        t.nodes[i].x = a->x + 0.25f * (t.nodes[i].x - a->x);
        t.nodes[i].y = a->y + 0.25f * (t.nodes[i].y - a->y);
        t.nodes[i].z = a->z + 0.25f * (t.nodes[i].z - a->z);
    }
    return t;
}
/* A thick trunk of long edges (the first TRUNK nodes) with combs of thin, short ones. */
enum { TRUNK = 9, COMBS = 40 };
static sdv_tree comb_tree(uint32_t n) {
    uint32_t seed = 5;
    for (uint32_t i = 0; i < n; i++) {
        bool trunk = i < TRUNK;
        uint32_t parent = trunk ? i - 1 : i < TRUNK + COMBS ? i % TRUNK : i - COMBS;
        double angle = 1.1 * ((i - TRUNK) % COMBS), step = i < TRUNK + COMBS ? 12 : 2.5;
        float *p = positions + 3 * i;
        const float *q = positions + 3 * (i ? parent : 0);
        p[0] = trunk ? 0 : q[0] + (float)(cos(angle) * step + lent_between(&seed, -1, 1));
        p[1] = trunk ? 0 : q[1] + (float)(sin(angle) * step + lent_between(&seed, -1, 1));
        p[2] = trunk ? 25.0f * (float)i : q[2] + (float)lent_between(&seed, -1, 1);
        radii[i] = trunk ? 10 - 0.8f * (float)i : 0.4f;
        if (i)
            segments[i - 1] = (sdv_segment){parent, i};
    }
    sdv_tree t;
    sdv_tree_desc desc = {n, positions, radii, n - 1, segments, 0, NULL, NULL, 0, 0};
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    return t;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}
/* Seconds of a move of one node there and back by a hundredth of the extent: the less of both,
   which what else runs disturbs least. */
static double move_node(sdv_tree *t, uint32_t node, uint32_t *seed, sdv_grid *g) {
    const lao_v4 home = t->nodes[node];
    double extent = (double)g->cell * (double)g->size[2], least = INFINITY;
    lao_v3 by = lao_v3_scale(vessel_direction(seed), (float)(0.01 * extent));
    for (int i = 0; i < 2; i++) {
        double start = seconds();
        t->nodes[node] =
            i ? home : lao_v4_make(home.x + by.x, home.y + by.y, home.z + by.z, home.w);
        assert_int_equal(sdv_grid_update(NULL, t, &node, 1, g), LAO_OK);
        least = g->rebuilt ? least : fmin(least, seconds() - start);
    }
    return least;
}
/* The trunk and a part of all others. What a move costs is told, and measured in bench_vessel.c. */
static void check_moves(const char *name, sdv_tree t, uint32_t resolution) {
    enum { MOVES = 80 };
    double full = INFINITY, moves[MOVES], mean;
    uint32_t seed = 3, count = 0;
    sdv_grid g = build(&t, resolution);
    for (uint32_t i = 0; i < MOVES; i++) {
        uint32_t node = i < TRUNK ? i : i * (t.node_count / MOVES);
        double start = seconds();
        if (i % 16 == 0) {
            sdv_grid fresh = build_like(&t, &g);
            full = fmin(full, seconds() - start);
            assert_same(&g, &fresh);
            sdv_grid_free(&fresh);
        }
        double least = move_node(&t, node, &seed, &g);
        if (isfinite(least))
            moves[count++] = least / full;
    }
    assert_in_range(count, MOVES / 2, MOVES);
    qsort(moves, count, sizeof *moves, by_value);
    double most = check_distances(&g, 5000, &mean);
    printf(
        "%s, %u^3, %u segments: built in %.1f ms; a moved node costs 1/%.0f of that, at most "
        "1/%.1f; %.1f ids a near cell; far distances too great by %.2f cells on average, %.2f at "
        "most\n",
        name, resolution, t.segment_count, 1e3 * full, 1 / moves[count / 2], 1 / moves[count - 1],
        (double)g.id_count / g.cell_count, mean, most);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}
static void moves_keep_the_grid(void **state) {
    (void)state;
    for (uint32_t resolution = 64; resolution <= 128; resolution *= 2) {
        check_moves("branches everywhere", organ_tree(2000), resolution);
        check_moves("a thick trunk", comb_tree(3000), resolution);
    }
}

/* Every node of a trunk, far and near, alone and together; lists that grow and shrink. */
static void moved_trunks_equal_a_full_build(void **state) {
    (void)state;
    uint32_t seed = 9;
    sdv_tree t = comb_tree(400);
    sdv_grid g = build(&t, 50);
    for (uint32_t i = 0; i < 36; i++) {
        uint32_t nodes[2] = {i % TRUNK, (i * 7) % 400}, count = 1 + i % 2;
        for (uint32_t k = 0; k < count; k++) {
            lao_v4 *p = t.nodes + nodes[k];
            lao_v3 by = lao_v3_scale(vessel_direction(&seed), i % 3 ? 3.0f : 14.0f);
            *p = lao_v4_make(0.7f * (p->x + by.x), 0.7f * (p->y + by.y), p->z + 0.3f * by.z,
                             i % 4 ? p->w : 0.5f * p->w + (float)lent_between(&seed, 0, 4));
        }
        assert_int_equal(sdv_grid_update(NULL, &t, nodes, count, &g), LAO_OK);
        sdv_grid fresh = build_like(&t, &g);
        assert_same(&g, &fresh);
        sdv_grid_free(&fresh);
    }
    sdv_grid_free(&g);
    sdv_tree_free(&t);
}

static void what_cannot_be_is_refused(void **state) {
    (void)state;
    lent_host host;
    sdv_host h = vessel_host_make(&host);
    sdv_tree t = random_tree(2, 50, 50, 2), other = random_tree(2, 40, 50, 2);
    sdv_grid g, before;
    const float origin[] = {0, 0, 0};
    sdv_grid_desc small = {15, NULL, 0, {0, 0, 0}}, large = {513, NULL, 0, {0, 0, 0}};
    sdv_grid_desc many = {0, origin, 1, {512, 512, 65}}, flat = {0, origin, 0, {20, 20, 20}};
    uint32_t node = 50;
    memset(&g, 0x33, sizeof g);
    before = g;
#define REFUSED(call, what)                                                                        \
    do {                                                                                           \
        uint32_t failures = host.failures;                                                         \
        assert_true((call) != LAO_OK);                                                             \
        assert_int_equal(host.failures, failures + 1);                                             \
        assert_int_equal(host.item, SDV_LOG_##what);                                               \
        assert_memory_equal(&g, &before, sizeof g);                                                \
    } while (0)
    REFUSED(sdv_grid_build(&h, &t, &small, &g), GRID_CELLS);
    REFUSED(sdv_grid_build(&h, &t, &large, &g), GRID_CELLS);
    REFUSED(sdv_grid_build(&h, &t, &many, &g), GRID_CELLS);
    REFUSED(sdv_grid_build(&h, &t, &flat, &g), GRID_CELLS);
    REFUSED(sdv_grid_build(&h, NULL, NULL, &g), NULL_ARGUMENT);
    sdv_grid_desc desc = {32, NULL, 0, {0, 0, 0}};
    for (uint32_t n = 1; n < 8; n++) {
        host.cancel_at = host.progress_calls + n;
        REFUSED(sdv_grid_build(&h, &t, &desc, &g), CANCELLED);
        assert_int_equal(host.memory.bytes, 0);
    }
    host.cancel_at = 0;
    assert_int_equal(sdv_grid_build(&h, &t, &desc, &g), LAO_OK);
    before = g;
    REFUSED(sdv_grid_update(&h, &t, &node, 1, &g), GRID_TREE);
    node = 4;
    REFUSED(sdv_grid_update(&h, &other, &node, 1, &g), GRID_TREE);
    REFUSED(sdv_grid_update(&h, &t, NULL, 1, &g), NULL_ARGUMENT);
    host.cancel_at = host.progress_calls + 1;
    REFUSED(sdv_grid_update(&h, &t, &node, 1, &g), CANCELLED);
    sdv_grid_free(&g);
    assert_int_equal(host.memory.bytes, 0);
    sdv_tree_free(&t);
    sdv_tree_free(&other);
}

static void memory_may_end(void **state) {
    (void)state;
    sdv_tree t = random_tree(2, 50, 50, 2);
    sdv_grid_desc desc = {24, NULL, 0, {0, 0, 0}};
    uint32_t node = 7, n = 1;
    for (int built = 0; built < 2; n++) {
        lent_host host;
        sdv_host h = vessel_host_make(&host);
        sdv_grid g;
        host.memory.fail_allocation = n;
        lao_result result = sdv_grid_build(&h, &t, &desc, &g);
        if (result == LAO_OK) {
            sdv_grid before = build_like(&t, &g);
            float x = t.nodes[node].x;
            built = 1;
            t.nodes[node].x = 0.9f * x;
            result = sdv_grid_update(&h, &t, &node, 1, &g);
            t.nodes[node].x = x;
            if (result == LAO_OK)
                built = 2;
            else
                assert_same(&g, &before);
            sdv_grid_free(&before);
            sdv_grid_free(&g);
        }
        assert_true(result == LAO_OK || result == LAO_ERROR_OUT_OF_MEMORY);
        assert_int_equal(host.failures, result != LAO_OK);
        assert_int_equal(host.memory.bytes, 0);
    }
    assert_int_equal(n, 22);
    sdv_tree_free(&t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equals_brute_force),
        cmocka_unit_test(no_sign_is_wrong),
        cmocka_unit_test(one_ball),
        cmocka_unit_test(order_does_not_matter),
        cmocka_unit_test(moved_nodes_equal_a_full_build),
        cmocka_unit_test(leaving_the_box_builds_anew),
        cmocka_unit_test(moved_trunks_equal_a_full_build),
        cmocka_unit_test(moves_keep_the_grid),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(memory_may_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
