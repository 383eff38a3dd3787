/* The embedded liver has the nodes asked for, one root, two children or fewer, radii by Murray's
   law, fills its ellipsoid and leaves the tumour out; it is the same in every run, differs by seed,
   and is made fast. */
#include "scene_tree.h"
#include "vessel_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <cmocka.h>

static sdv_tree build(const scene_tree *s) {
    sdv_tree t;
    sdv_segment *segments = malloc((s->segment_count + 1) * sizeof *segments);
    assert_non_null(segments);
    for (uint32_t i = 0; i < s->segment_count; i++) {
        segments[i].parent = s->segments[2 * i];
        segments[i].child = s->segments[2 * i + 1];
    }
    sdv_tree_desc desc = {
        s->node_count, s->positions, s->radii, s->segment_count, segments, 0, NULL, NULL, 0, 0};
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    free(segments);
    return t;
}

static void trees_are_well_formed(void **state) {
    (void)state;
    static const uint32_t sizes[] = {1, 2, 3, 17, 0, 20000};
    for (int i = 0; i < 6; i++) {
        scene_tree s, again;
        assert_true(scene_tree_make(sizes[i], 1, &s));
        assert_true(scene_tree_make(sizes[i], 1, &again));
        assert_int_equal(s.node_count, sizes[i] ? sizes[i] : 3000);
        assert_memory_equal(s.positions, again.positions, 3 * s.node_count * sizeof(float));
        assert_memory_equal(s.radii, again.radii, s.node_count * sizeof(float));
        assert_memory_equal(s.segments, again.segments, 2 * s.segment_count * sizeof(uint32_t));
        sdv_tree t = build(&s);
        assert_int_equal(t.warning_count, 0);
        assert_int_equal(t.info.roots, 1);
        assert_int_equal(t.info.loops, 0);
        assert_true(t.info.max_children <= 2);
        double *cubes = calloc(s.node_count, sizeof *cubes);
        assert_non_null(cubes);
        for (uint32_t k = 0; k < s.node_count; k++) {
            const float *p = s.positions + 3 * k;
            double u = 0, d = 0;
            for (int c = 0; c < 3; c++) {
                u += pow((double)(p[c] / s.liver[c]), 2);
                d += pow((double)p[c] - (double)s.tumour[c], 2);
            }
            assert_true(u < 1 && sqrt(d) > (double)s.tumour[3]);
            if (k)
                cubes[s.segments[2 * k - 2]] += pow((double)s.radii[k], 3);
        }
        for (uint32_t k = 0; k < s.node_count; k++)
            if (t.child_counts[k])
                assert_true(fabs(pow((double)s.radii[k], 3) / cubes[k] - 1) < 1e-5);
        free(cubes);
        sdv_tree_free(&t);
        scene_tree_free(&s);
        scene_tree_free(&again);
    }
    scene_tree a, b;
    assert_true(scene_tree_make(100, 1, &a) && scene_tree_make(100, 2, &b));
    assert_true(memcmp(a.positions, b.positions, 300 * sizeof(float)) != 0);
    scene_tree_free(&a);
    scene_tree_free(&b);
    assert_false(scene_tree_make(SCENE_TREE_MOST + 1, 1, &a));
}

/* Every eighth of the organ has its part of the nodes, and leaves reach everywhere. */
static void trees_fill_the_organ(void **state) {
    (void)state;
    scene_tree s;
    uint32_t parts[8] = {0};
    assert_true(scene_tree_make(10000, 3, &s));
    for (uint32_t k = 0; k < s.node_count; k++) {
        const float *p = s.positions + 3 * k;
        parts[(p[0] > 0) + 2 * (p[1] > 0) + 4 * (p[2] > 0)]++;
    }
    for (int i = 0; i < 8; i++)
        assert_true(parts[i] > 10000 / 8 * 0.55);
    sdv_tree t = build(&s);
    sdv_grid g;
    sdv_grid_desc desc = {64, NULL, 0, {0, 0, 0}};
    assert_int_equal(sdv_grid_build(NULL, &t, &desc, &g), LAO_OK);
    uint32_t seed = 1, far = 0;
    for (int i = 0; i < 2000; i++) {
        lao_v3 u = vessel_direction(&seed);
        float r = 0.9f * (float)cbrt(lent_between(&seed, 0, 1));
        lao_v3 p = lao_v3_make(r * u.x * s.liver[0], r * u.y * s.liver[1], r * u.z * s.liver[2]);
        lao_v3 d = lao_v3_make(p.x - s.tumour[0], p.y - s.tumour[1], p.z - s.tumour[2]);
        far += lao_v3_dot(d, d) > 400 && sdv_grid_distance(&g, p, NULL) > 9;
    }
    assert_true(far < 20);
    sdv_grid_free(&g);
    sdv_tree_free(&t);
    scene_tree_free(&s);
}

static void trees_are_made_fast(void **state) {
    (void)state;
    struct timespec a, b;
    scene_tree s;
    clock_gettime(CLOCK_MONOTONIC, &a);
    assert_true(scene_tree_make(100000, 1, &s));
    clock_gettime(CLOCK_MONOTONIC, &b);
    sdv_tree t = build(&s);
    printf("100,000 nodes in %.0f ms: %u leaves, radii %.3f to %.1f mm\n",
           1e3 * (double)(b.tv_sec - a.tv_sec) + 1e-6 * (double)(b.tv_nsec - a.tv_nsec),
           t.info.leaves, (double)t.info.radius[0], (double)t.info.radius[1]);
    assert_true(b.tv_sec - a.tv_sec < 30);
    sdv_tree_free(&t);
    scene_tree_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_well_formed),
        cmocka_unit_test(trees_fill_the_organ),
        cmocka_unit_test(trees_are_made_fast),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
