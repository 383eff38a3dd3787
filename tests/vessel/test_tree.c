/* A tree built from arrays has the nodes, segments, directions, counts and warnings that DESIGN.md
   10 asks for, whatever the arrays look like; what cannot be is refused by name; attributes follow
   their nodes and segments; no memory is lost when there is none. */
#include "vessel_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

typedef struct sample {
    float p[64][3], r[64];
    sdv_segment s[64];
    sdv_tree_desc desc;
} sample;

static sample *start(void) {
    sample *s = calloc(1, sizeof *s);
    assert_non_null(s);
    s->desc.positions = s->p[0];
    s->desc.radii = s->r;
    s->desc.segments = s->s;
    return s;
}
static void node(sample *s, double x, double y, double z, double r) {
    uint32_t i = s->desc.node_count++;
    s->p[i][0] = (float)x;
    s->p[i][1] = (float)y;
    s->p[i][2] = (float)z;
    s->r[i] = (float)r;
}
static void segment(sample *s, uint32_t parent, uint32_t child) {
    s->s[s->desc.segment_count].parent = parent;
    s->s[s->desc.segment_count++].child = child;
}
/* What must hold of every tree. */
static void check_form(const sdv_tree *t) {
    uint8_t *placed = calloc(t->node_count, 1);
    uint32_t edges = 0;
    assert_non_null(placed);
    for (uint32_t i = 0; i < t->node_count; i++) {
        uint32_t n = t->order[i], p = t->parents[n];
        assert_true(n < t->node_count && !placed[n]);
        placed[n] = 1;
        if (p == SDV_NONE) {
            assert_int_equal(t->roots[t->components[n]], n);
            assert_int_equal(t->parent_segments[n], SDV_NONE);
        } else {
            const sdv_segment *s = t->segments + t->parent_segments[n];
            assert_true(placed[p]);
            assert_int_equal(s->parent, p);
            assert_int_equal(s->child, n);
            assert_int_equal(t->components[n], t->components[p]);
            edges++;
        }
        assert_true(t->nodes[n].w >= 0.0f);
    }
    assert_int_equal(edges, t->node_count - t->root_count);
    assert_int_equal(t->info.loops, t->segment_count - edges);
    assert_int_equal(t->info.nodes, t->node_count);
    assert_int_equal(t->info.segments, t->segment_count);
    assert_int_equal(t->info.roots, t->root_count);
    free(placed);
}
/* Builds, checks the form, frees the sample. */
static sdv_tree build(sample *s) {
    sdv_tree t;
    assert_int_equal(sdv_tree_build(NULL, &s->desc, &t), LAO_OK);
    check_form(&t);
    free(s);
    return t;
}
static uint32_t warned(const sdv_tree *t, sdv_log_item item) {
    for (uint32_t i = 0; i < t->warning_count; i++)
        if (t->warnings[i].item == item)
            return t->warnings[i].count;
    return 0;
}

static void one_node_is_a_ball(void **state) {
    (void)state;
    sample *s = start();
    node(s, 1, 2, 3, 4);
    sdv_tree t = build(s);
    assert_int_equal(t.root_count, 1);
    assert_int_equal(t.info.leaves, 0);
    assert_int_equal(t.info.max_children, 0);
    assert_int_equal(t.warning_count, 0);
    assert_true(t.info.bounds[0][1] == 2.0f && t.info.bounds[1][2] == 3.0f);
    sdv_tree_free(&t);
    sdv_tree_free(&t); /* fine twice */
    s = start();
    s->desc.flags = SDV_TREE_LINES; /* a lone point is not dropped away to nothing */
    node(s, 1, 2, 3, 4);
    t = build(s);
    assert_int_equal(t.node_count, 1);
    sdv_tree_free(&t);
}

static void counts_are_right(void **state) {
    (void)state;
    sample *s = start(); /* 0 -> 1 -> {2, 3 -> {4, 5, 6}}, parents behind children */
    for (int i = 0; i < 7; i++)
        node(s, i, i * i, -i, 1 + 0.5 * i);
    segment(s, 3, 6);
    segment(s, 3, 5);
    segment(s, 3, 4);
    segment(s, 1, 3);
    segment(s, 1, 2);
    segment(s, 0, 1);
    sdv_tree t = build(s);
    assert_int_equal(t.roots[0], 0);
    assert_int_equal(t.info.leaves, 4);
    assert_int_equal(t.info.branches, 2);
    assert_int_equal(t.info.multifurcations, 1);
    assert_int_equal(t.info.max_children, 3);
    assert_int_equal(t.info.loops, 0);
    assert_true(t.info.radius[0] == 1.0f && t.info.radius[1] == 4.0f);
    assert_true(t.info.bounds[1][1] == 36.0f && t.info.bounds[0][2] == -6.0f);
    assert_int_equal(t.warning_count, 0);
    for (uint32_t i = 0; i < 6; i++)
        assert_int_equal(t.segment_sources[i], i);
    sdv_tree_free(&t);
}

static void several_roots_are_kept(void **state) {
    (void)state;
    sample *s = start();
    for (int i = 0; i < 5; i++)
        node(s, i, 0, 0, 1);
    segment(s, 3, 1); /* the component of node 1, rooted at 3 */
    segment(s, 0, 2);
    sdv_tree t = build(s);
    assert_int_equal(t.root_count, 3);
    assert_int_equal(t.roots[0], 0);
    assert_int_equal(t.roots[1], 3);
    assert_int_equal(t.roots[2], 4);
    assert_int_equal(t.info.leaves, 2);
    assert_int_equal(warned(&t, SDV_LOG_TREE_ROOTS), 3);
    char text[128];
    assert_true(sdv_tree_warning_text(&t, 0, text, sizeof text) > 0);
    assert_non_null(strstr(text, "several roots (3"));
    assert_true(sdv_tree_warning_text(&t, 0, text, 5) > 5 && strlen(text) == 4);
    sdv_tree_free(&t);
}

static void loops_are_kept_and_cycles_end(void **state) {
    (void)state;
    sample *s = start(); /* a node with two parents */
    for (int i = 0; i < 4; i++)
        node(s, i, 0, 0, 1);
    segment(s, 0, 1);
    segment(s, 0, 2);
    segment(s, 1, 3);
    segment(s, 2, 3);
    sdv_tree t = build(s);
    assert_int_equal(t.info.loops, 1);
    assert_int_equal(t.info.leaves, 1);
    assert_int_equal(t.info.branches, 1);
    assert_int_equal(t.segments[3].parent, 2);
    assert_int_equal(warned(&t, SDV_LOG_TREE_LOOPS), 1);
    assert_int_equal(warned(&t, SDV_LOG_SEGMENTS_TURNED), 0);
    sdv_tree_free(&t);
    s = start(); /* nothing but a cycle */
    for (int i = 0; i < 3; i++)
        node(s, i, i, 0, 1);
    segment(s, 1, 2);
    segment(s, 2, 0);
    segment(s, 0, 1);
    t = build(s);
    assert_int_equal(t.root_count, 1);
    assert_int_equal(t.roots[0], 1);
    assert_int_equal(t.info.loops, 1);
    assert_int_equal(t.info.leaves, 0);
    sdv_tree_free(&t);
}

static void segments_against_the_flow_are_turned(void **state) {
    (void)state;
    sample *s = start(); /* two sources, 0 and 3, meet at 1 */
    for (int i = 0; i < 4; i++)
        node(s, i, 0, 0, 1);
    segment(s, 0, 1);
    segment(s, 3, 1);
    segment(s, 1, 2);
    sdv_tree t = build(s);
    assert_int_equal(t.segments[1].parent, 1);
    assert_int_equal(t.segments[1].child, 3);
    assert_int_equal(warned(&t, SDV_LOG_SEGMENTS_TURNED), 1);
    assert_int_equal(t.info.branches, 1);
    assert_int_equal(t.info.leaves, 2);
    sdv_tree_free(&t);
    s = start(); /* no direction: the first node of the first segment is the root */
    s->desc.flags = SDV_TREE_UNDIRECTED;
    for (int i = 0; i < 4; i++)
        node(s, i, 0, 0, 1);
    segment(s, 2, 1);
    segment(s, 3, 2);
    segment(s, 0, 1);
    t = build(s);
    assert_int_equal(t.roots[0], 2);
    assert_int_equal(t.parents[3], 2);
    assert_int_equal(t.parents[0], 1);
    assert_int_equal(t.warning_count, 0);
    sdv_tree_free(&t);
}

static void what_is_odd_is_mended(void **state) {
    (void)state;
    sample *s = start();
    node(s, 0, 0, 0, 0);
    node(s, 1, 0, 0, -1);
    node(s, 1, 0, 0, 1);
    node(s, 3, 0, 0, (double)NAN);
    segment(s, 0, 1);
    segment(s, 1, 2); /* length 0, ids rule: kept */
    segment(s, 2, 2);
    segment(s, 1, 0);
    segment(s, 2, 3);
    segment(s, 2, 3);
    sdv_tree t = build(s);
    assert_int_equal(t.node_count, 4);
    assert_int_equal(t.segment_count, 3);
    assert_int_equal(warned(&t, SDV_LOG_RADIUS_MISSING), 2);
    assert_int_equal(warned(&t, SDV_LOG_RADIUS_ZERO), 1);
    assert_int_equal(warned(&t, SDV_LOG_SEGMENTS_ZERO), 1);
    assert_int_equal(warned(&t, SDV_LOG_SEGMENTS_LOOSE), 1);
    assert_int_equal(warned(&t, SDV_LOG_SEGMENTS_REPEATED), 2);
    assert_int_equal(t.segment_sources[2], 4);
    assert_true(t.nodes[1].w == 0.0f && t.nodes[3].w == 0.0f && t.info.radius[0] == -1.0f);
    sdv_tree_free(&t);
}

static void points_become_nodes(void **state) {
    (void)state;
    sample *s = start(); /* two lines root -> tip that repeat the trunk, and a stray point */
    s->desc.flags = SDV_TREE_MERGE | SDV_TREE_DROP;
    node(s, 0, 0, 0, 2);
    node(s, 9, 9, 9, 7); /* on no line */
    node(s, 1, 0, 0, 1.5);
    node(s, 2, 1, 0, 1);
    node(s, 0, -0.0, 0, 3); /* bit-equal but for the sign of zero */
    node(s, 1, 0, 0, 1.5);
    node(s, 2, -1, 0, 1);
    segment(s, 0, 2);
    segment(s, 2, 3);
    segment(s, 4, 5);
    segment(s, 5, 6);
    sdv_tree t = build(s);
    assert_int_equal(t.node_count, 4);
    assert_int_equal(t.segment_count, 3);
    assert_int_equal(warned(&t, SDV_LOG_NODES_MERGED), 2);
    assert_int_equal(warned(&t, SDV_LOG_NODES_ISOLATED), 1);
    assert_int_equal(warned(&t, SDV_LOG_SEGMENTS_REPEATED), 1);
    assert_int_equal(t.node_targets[1], SDV_NONE);
    assert_int_equal(t.node_targets[4], 0);
    assert_int_equal(t.node_targets[5], 1);
    assert_int_equal(t.node_targets[6], 3);
    assert_int_equal(t.node_sources[3], 6);
    assert_true(t.nodes[0].w == 3.0f); /* the greatest of the merged */
    assert_true(t.info.radius[1] == 3.0f);
    assert_int_equal(t.info.branches, 1);
    sdv_tree_free(&t);
}

static void lines_are_joined(void **state) {
    (void)state;
    sample *s = start();
    s->desc.flags = SDV_TREE_LINES;
    for (int i = 0; i < 5; i++) /* a thick trunk along x */
        node(s, 2 * i, 0, 0, 2);
    for (int i = 0; i < 3; i++) /* a twig that starts inside the trunk, near node 2 */
        node(s, 4.1, 1 + 2 * i, 0, 0.5);
    for (int i = 0; i < 2; i++) /* a line that touches nothing */
        node(s, 0, 0, 20 + i, 0.5);
    for (int i = 0; i < 2; i++) /* both ends inside the trunk: joined once, no loop */
        node(s, 1 + 6 * i, 0, 1, 0.1);
    for (uint32_t i = 0; i < 4; i++)
        segment(s, i, i + 1);
    segment(s, 6, 5);
    segment(s, 7, 6);
    segment(s, 8, 9);
    segment(s, 10, 11);
    sdv_tree t = build(s);
    assert_int_equal(t.info.joined, 2);
    assert_int_equal(t.root_count, 2);
    assert_int_equal(t.info.loops, 0);
    assert_int_equal(warned(&t, SDV_LOG_LINES_JOINED), 2);
    assert_int_equal(t.parents[5], 2);
    assert_int_equal(t.parents[6], 5);
    assert_int_equal(t.parents[10], 0); /* ties: the lowest */
    assert_int_equal(t.segment_sources[t.segment_count - 1], SDV_NONE);
    sdv_tree_free(&t);
}

static void joining_equals_brute_force(void **state) {
    (void)state;
    enum { LINES = 60, POINTS = 5, N = LINES * POINTS };
    static float p[3 * N], r[N];
    static sdv_segment segments[N];
    for (uint32_t seed = 1; seed <= 20; seed++) {
        uint32_t m = 0, state_ = seed, joined = 0, group[N];
        for (uint32_t i = 0; i < N; i++) {
            for (uint32_t k = 0; k < 3; k++)
                p[3 * i + k] = (float)lent_between(&state_, -20, 20);
            r[i] = (float)exp(lent_between(&state_, -6, 2));
            if (i % POINTS) {
                segments[m].parent = i - 1;
                segments[m++].child = i;
            }
            group[i] = i / POINTS;
        }
        sdv_tree_desc desc = {N, p, r, m, segments, SDV_TREE_LINES, NULL, NULL, 0, 0};
        sdv_tree t;
        assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
        check_form(&t);
        for (uint32_t i = 0; i < N; i++) {
            if (i % POINTS != 0 && i % POINTS != POINTS - 1)
                continue;
            uint32_t best = SDV_NONE;
            double least = 0;
            for (uint32_t j = 0; j < N; j++) {
                double x = (double)p[3 * i] - (double)p[3 * j];
                double y = (double)p[3 * i + 1] - (double)p[3 * j + 1];
                double z = (double)p[3 * i + 2] - (double)p[3 * j + 2];
                double d = x * x + y * y + z * z;
                if (d <= (double)r[j] * (double)r[j] && group[j] != group[i] &&
                    (best == SDV_NONE || d < least)) {
                    best = j;
                    least = d;
                }
            }
            if (best != SDV_NONE) {
                const sdv_segment *s = t.segments + m + joined++;
                uint32_t from = group[i], to = group[best];
                assert_true((s->parent == i && s->child == best) ||
                            (s->parent == best && s->child == i));
                for (uint32_t j = 0; j < N; j++)
                    group[j] = group[j] == from ? to : group[j];
            }
        }
        assert_int_equal(t.info.joined, joined);
        assert_int_equal(t.segment_count, m + joined);
        sdv_tree_free(&t);
    }
}

static void attributes_follow(void **state) {
    (void)state;
    sample *s = start();
    const float of_nodes[] = {0, 1, 2, 3, 4}, of_segments[] = {10, 11, 20, 21, 30, 31};
    sdv_attribute a = {"flow", 0, of_nodes}, b = {"pair", 2, of_segments};
    s->desc.flags = SDV_TREE_MERGE | SDV_TREE_DROP | SDV_TREE_JOIN;
    node(s, 0, 0, 0, 1);
    node(s, 5, 5, 5, 1);
    node(s, 1, 0, 0, 1);
    node(s, 1.5, 0, 0, 1);
    node(s, 2, 0, 0, 1);
    segment(s, 0, 0);
    segment(s, 0, 2);
    segment(s, 3, 4);
    s->desc.node_attributes = &a;
    s->desc.node_attribute_count = 1;
    s->desc.segment_attributes = &b;
    s->desc.segment_attribute_count = 1;
    sdv_tree t = build(s);
    assert_int_equal(t.node_attribute_count, 1);
    assert_string_equal(t.node_attributes[0].name, "flow");
    assert_int_equal(t.node_attributes[0].components, 1);
    assert_true(t.node_attributes[0].values[1] == 2.0f);
    assert_true(t.node_attributes[0].values[3] == 4.0f);
    assert_int_equal(t.segment_count, 3);
    assert_true(t.segment_attributes[0].values[1] == 21.0f - 0.0f);
    assert_true(t.segment_attributes[0].values[2] == 30.0f);
    assert_true(isnan(t.segment_attributes[0].values[4])); /* the joined one */
    sdv_tree_free(&t);
}

static void what_cannot_be_is_refused(void **state) {
    (void)state;
    lent_host host;
    sdv_host h = vessel_host_make(&host);
    sample *s = start();
    sdv_tree t;
    const sdv_attribute nameless = {NULL, 1, s->r};
    memset(&t, 0x5a, sizeof t);
    sdv_tree before = t;
#define REFUSED(what)                                                                              \
    do {                                                                                           \
        uint32_t failures = host.failures;                                                         \
        assert_true(sdv_tree_build(&h, &s->desc, &t) != LAO_OK);                                   \
        assert_int_equal(host.failures, failures + 1);                                             \
        assert_int_equal(host.item, SDV_LOG_##what);                                               \
        assert_memory_equal(&t, &before, sizeof t);                                                \
    } while (0)
    REFUSED(TREE_EMPTY);
    node(s, 0, 0, 0, 1);
    node(s, 1, 0, 0, 1);
    segment(s, 0, 2);
    REFUSED(TREE_SEGMENT);
    assert_non_null(strstr(host.text, "segment 0 from node 0 to node 2"));
    s->s[0].child = 1;
    s->p[1][1] = INFINITY;
    REFUSED(TREE_POSITION);
    assert_non_null(strstr(host.text, "node 1"));
    s->p[1][1] = 0;
    s->desc.node_attributes = &nameless;
    s->desc.node_attribute_count = 1;
    REFUSED(TREE_ATTRIBUTE);
    s->desc.node_attribute_count = 0;
    s->desc.positions = NULL;
    REFUSED(NULL_ARGUMENT);
    s->desc.node_count = 0xfffffff0u;
    REFUSED(TREE_COUNT);
    assert_int_equal(sdv_tree_build(&h, NULL, &t), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.warnings, 0);
    assert_int_equal(host.memory.bytes, 0);
    free(s);
}

static void memory_may_end(void **state) {
    (void)state;
    float p[300], r[100];
    sdv_segment segments[99];
    vessel_random_tree(3, 100, 50, 3, p, r, segments);
    sdv_tree_desc desc = {100, p, r, 99, segments, SDV_TREE_LINES, NULL, NULL, 0, 0};
    for (uint32_t n = 1;; n++) {
        lent_host host;
        sdv_host h = vessel_host_make(&host);
        sdv_tree t;
        sdv_reduced reduced;
        sdv_layout layout;
        memset(&t, 0, sizeof t);
        memset(&reduced, 0, sizeof reduced);
        memset(&layout, 0, sizeof layout);
        host.memory.fail_allocation = n;
        lao_result result = sdv_tree_build(&h, &desc, &t);
        if (result == LAO_OK)
            result = sdv_reduce(&h, &t, &reduced);
        if (result == LAO_OK)
            result = sdv_layout_make(&h, &t, &reduced, NULL, &layout);
        assert_true(result == LAO_OK || result == LAO_ERROR_OUT_OF_MEMORY);
        assert_int_equal(host.failures, result != LAO_OK);
        sdv_layout_free(&layout);
        sdv_reduced_free(&reduced);
        sdv_tree_free(&t);
        assert_int_equal(host.memory.bytes, 0);
        if (result == LAO_OK) {
            assert_int_equal(n, 7);
            break;
        }
    }
}

/* The same tree with its nodes renamed and its segments shuffled. */
static void order_does_not_matter(void **state) {
    (void)state;
    enum { N = 500 };
    static float p[3 * N], r[N], q[3 * N], s[N];
    static sdv_segment a[N], b[N];
    uint32_t name[N], seed = 5;
    vessel_random_tree(9, N, 80, 3, p, r, a);
    for (uint32_t i = 0; i < N; i++)
        name[i] = i;
    for (uint32_t i = N - 1; i > 0; i--) {
        uint32_t k = (uint32_t)lent_between(&seed, 0, i + 1), swap = name[i];
        name[i] = name[k];
        name[k] = swap;
    }
    for (uint32_t i = 0; i < N; i++) {
        memcpy(q + 3 * name[i], p + 3 * i, 3 * sizeof *p);
        s[name[i]] = r[i];
    }
    for (uint32_t i = 0; i < N - 1; i++) {
        b[N - 2 - i].parent = name[a[i].parent];
        b[N - 2 - i].child = name[a[i].child];
    }
    sdv_tree_desc first = {N, p, r, N - 1, a, 0, NULL, NULL, 0, 0};
    sdv_tree_desc second = {N, q, s, N - 1, b, 0, NULL, NULL, 0, 0};
    sdv_tree t, u;
    assert_int_equal(sdv_tree_build(NULL, &first, &t), LAO_OK);
    assert_int_equal(sdv_tree_build(NULL, &second, &u), LAO_OK);
    check_form(&t);
    check_form(&u);
    assert_memory_equal(&t.info, &u.info, sizeof t.info);
    for (uint32_t i = 0; i < N; i++) {
        uint32_t parent = t.parents[i];
        assert_int_equal(u.parents[name[i]], parent == SDV_NONE ? SDV_NONE : name[parent]);
        assert_int_equal(u.child_counts[name[i]], t.child_counts[i]);
    }
    sdv_tree_free(&t);
    sdv_tree_free(&u);
}

static void a_million_nodes_in_a_chain(void **state) {
    (void)state;
    const uint32_t n = 1000000;
    float *p = malloc(3 * n * sizeof *p), *r = malloc(n * sizeof *r);
    sdv_segment *s = malloc(n * sizeof *s);
    assert_true(p && r && s);
    for (uint32_t i = 0; i < n; i++) { /* numbered from the tip */
        p[3 * i] = (float)i;
        p[3 * i + 1] = p[3 * i + 2] = 0;
        r[i] = 0.3f;
        s[i].parent = i + 1;
        s[i].child = i;
    }
    sdv_tree_desc desc = {n, p, r, n - 1, s, SDV_TREE_MERGE | SDV_TREE_DROP, NULL, NULL, 0, 0};
    sdv_tree t;
    sdv_reduced reduced;
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    check_form(&t);
    assert_int_equal(t.roots[0], n - 1);
    assert_int_equal(t.info.leaves, 1);
    assert_int_equal(sdv_reduce(NULL, &t, &reduced), LAO_OK);
    assert_int_equal(reduced.node_count, 2);
    assert_int_equal(reduced.owners[n / 2], 0);
    sdv_reduced_free(&reduced);
    sdv_tree_free(&t);
    free(p);
    free(r);
    free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_node_is_a_ball),
        cmocka_unit_test(counts_are_right),
        cmocka_unit_test(several_roots_are_kept),
        cmocka_unit_test(loops_are_kept_and_cycles_end),
        cmocka_unit_test(segments_against_the_flow_are_turned),
        cmocka_unit_test(what_is_odd_is_mended),
        cmocka_unit_test(points_become_nodes),
        cmocka_unit_test(lines_are_joined),
        cmocka_unit_test(joining_equals_brute_force),
        cmocka_unit_test(attributes_follow),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(memory_may_end),
        cmocka_unit_test(order_does_not_matter),
        cmocka_unit_test(a_million_nodes_in_a_chain),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
