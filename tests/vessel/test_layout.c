/* The reduced tree is binary with the ids that DESIGN.md 10 asks for; the layout is Algorithm 1 of
   L19 with the oracles of METHODS.md 8, for any tree, weight and size, fast; JSON and SVG say what
   it is, and as a tree in a plane it has every node on its edge, by its way along the vessel. */
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
        fail_msg("line %d: %s is %.9g, not %.9g", line, what, a, b);
}

typedef struct case_ {
    sdv_tree tree;
    sdv_reduced reduced;
    sdv_layout layout;
} case_;

static case_ lay(uint32_t n, const float *p, const float *r, uint32_t m, const sdv_segment *s,
                 const sdv_layout_desc *desc) {
    case_ c;
    sdv_tree_desc tree = {n, p, r, m, s, 0, NULL, NULL, 0, 0};
    assert_int_equal(sdv_tree_build(NULL, &tree, &c.tree), LAO_OK);
    assert_int_equal(sdv_reduce(NULL, &c.tree, &c.reduced), LAO_OK);
    assert_int_equal(sdv_layout_make(NULL, &c.tree, &c.reduced, desc, &c.layout), LAO_OK);
    return c;
}
static void done(case_ *c) {
    sdv_layout_free(&c->layout);
    sdv_reduced_free(&c->reduced);
    sdv_tree_free(&c->tree);
}
/* Parents as an array: -1 is a root. */
static case_ lay_parents(uint32_t n, const int *parents, const sdv_layout_desc *desc) {
    static float p[3 * 64], r[64];
    static sdv_segment s[64];
    uint32_t m = 0;
    for (uint32_t i = 0; i < n; i++) {
        p[3 * i] = (float)i;
        r[i] = 1;
        if (parents[i] >= 0) {
            s[m].parent = (uint32_t)parents[i];
            s[m++].child = i;
        }
    }
    return lay(n, p, r, m, s, desc);
}

static void check_form(const sdv_tree *t, const sdv_reduced *r) {
    uint32_t extras = 0;
    for (uint32_t i = 0; i < r->node_count; i++) {
        uint32_t node = r->order[i], parent = r->parents[node];
        const uint32_t *c = r->children + 2 * node;
        if (parent != SDV_NONE)
            assert_true(r->children[2 * parent] == node || r->children[2 * parent + 1] == node);
        else
            assert_int_equal(c[1], SDV_NONE);
        if (c[0] == SDV_NONE)
            assert_int_equal(c[1], SDV_NONE);
        if (c[1] != SDV_NONE) {
            assert_true(r->ids[c[0]] < r->ids[c[1]]);
            assert_int_equal(r->parents[c[1]], node);
        } else if (c[0] != SDV_NONE) {
            assert_int_equal(parent, SDV_NONE); /* only roots have one child */
        }
        extras += r->ids[node] >= t->node_count;
        assert_true(r->nodes[node] < t->node_count);
    }
    for (uint32_t i = 0; i < r->node_count; i++) /* extra ids follow one another */
        assert_true(r->ids[i] < t->node_count + extras && (!i || r->ids[i] > r->ids[i - 1]));
    for (uint32_t i = 0; i < t->node_count; i++) {
        uint32_t below = r->ids[r->owners[i]], k = below;
        while (k != i && t->parents[k] != SDV_NONE)
            k = t->parents[k];
        assert_int_equal(k, i);
        if (below != i)
            assert_int_equal(t->child_counts[i], 1);
    }
}

static void reduced_trees(void **state) {
    (void)state;
    /* 0 -> 1 -> 2 -> {3 -> 4, 5, 6, 7} */
    const int parents[] = {-1, 0, 1, 2, 3, 2, 2, 2};
    case_ c = lay_parents(8, parents, NULL);
    check_form(&c.tree, &c.reduced);
    /* kept: 0 2 4 5 6 7, extra: 8 = {5, 9}, 9 = {6, 7} */
    const uint32_t ids[] = {0, 2, 4, 5, 6, 7, 8, 9};
    const int up[] = {-1, 0, 1, 6, 7, 7, 1, 6};
    assert_int_equal(c.reduced.node_count, 8);
    for (int i = 0; i < 8; i++) {
        assert_int_equal(c.reduced.ids[i], ids[i]);
        assert_int_equal((int)c.reduced.parents[i], up[i]);
    }
    assert_int_equal(c.reduced.owners[3], 2);
    assert_int_equal(c.reduced.owners[1], 1);
    assert_int_equal(c.reduced.nodes[7], 2);
    done(&c);
    const int star[] = {-1, 0, 0, 0}; /* a root with three children: one extra child */
    c = lay_parents(4, star, NULL);
    check_form(&c.tree, &c.reduced);
    assert_int_equal(c.reduced.node_count, 6);
    assert_int_equal(c.reduced.children[0], 4);
    assert_int_equal(c.reduced.children[8], 1);
    assert_int_equal(c.reduced.children[9], 5);
    done(&c);
    const int pair[] = {-1, 0, 0};
    c = lay_parents(3, pair, NULL);
    check_form(&c.tree, &c.reduced);
    assert_int_equal(c.reduced.node_count, 4);
    done(&c);
    const int alone[] = {-1};
    c = lay_parents(1, alone, NULL);
    assert_int_equal(c.reduced.node_count, 1);
    assert_near(c.layout.h[0], 0.5, 0);
    assert_near(c.layout.s[0], 1, 0);
    done(&c);
}

static void paper_example(void **state) {
    (void)state;
    /* root 0, n1 = 1, a = 2 (leaves 4, 5), b = 3 */
    const int parents[] = {-1, 0, 1, 1, 2, 2};
    case_ c = lay_parents(6, parents, NULL);
    const double h[] = {0.5, 0.5, 0.486111111, 0.541666667, 0.298611111, 0.673611111};
    const double s[] = {1, 1, 0.5, 0.711324865, 0, 0};
    const double w[] = {6, 5, 3, 1, 1, 1};
    for (int i = 0; i < 6; i++) {
        assert_near(c.layout.h[i], h[i], 1e-6);
        assert_near(c.layout.s[i], s[i], 1e-6);
        assert_near(c.layout.weights[i], w[i], 0);
    }
    done(&c);
    const int edge[] = {-1, 0};
    c = lay_parents(2, edge, NULL);
    assert_near(c.layout.s[1], 1, 0); /* no range to scale */
    done(&c);
}

static void balanced_trees(void **state) {
    (void)state;
    int parents[32];
    parents[0] = -1;
    for (int i = 1; i < 32; i++) /* root 0, n1 = 1, children 2 i and 2 i + 1 */
        parents[i] = i / 2;
    case_ c = lay_parents(32, parents, NULL);
    for (int i = 1; i < 32; i++) {
        int depth = 0;
        for (int k = i; k > 1; k /= 2)
            depth++;
        int place = i - (1 << depth);
        assert_near(c.layout.h[i], (2 * place + 1) / pow(2, depth + 1), 1e-6);
        assert_near(c.layout.s[i], 1 - depth / 4.0, 1e-6);
    }
    done(&c);
}

static void weights_by_scalar(void **state) {
    (void)state;
    const int parents[] = {-1, 0, 1, 1, 2, 2};
    float scalars[] = {1, 1, 1, 1, 1, 1};
    sdv_layout_desc desc = {scalars, 0, 1, 0};
    case_ plain = lay_parents(6, parents, NULL);
    sdv_layout_desc same = {scalars, 0, 0, 0};
    case_ c = lay_parents(6, parents, &same); /* all 1 is the default */
    assert_memory_equal(c.layout.h, plain.layout.h, 6 * sizeof(float));
    done(&c);
    done(&plain);
    scalars[3] = 12; /* with p_h = 0 shares of h are those of the weights: a 3, b 12 */
    c = lay_parents(6, parents, &desc);
    assert_near(c.layout.weights[3], 12, 0);
    assert_near(c.layout.h[2], 0.1, 1e-6);
    assert_near(c.layout.h[3], 0.6, 1e-6);
    assert_near(c.layout.h[4], 0.05, 1e-6);
    done(&c);
    desc.flags = SDV_LAYOUT_OWN; /* a 1, b 12 */
    c = lay_parents(6, parents, &desc);
    assert_near(c.layout.h[2], 0.5 / 13, 1e-6);
    done(&c);
    scalars[3] = -1; /* no number: as good as the least weight there is */
    scalars[4] = NAN;
    desc.flags = 0;
    c = lay_parents(6, parents, &desc);
    assert_near(c.layout.weights[3], 1, 0);
    assert_near(c.layout.h[2], 1.0 / 3, 1e-6);
    done(&c);
    const int chain[] = {-1, 0, 1, 2, 2, 4}; /* 4 -> 5 is a chain of two nodes */
    sdv_layout_desc all = {NULL, 0, 1, SDV_LAYOUT_ALL_NODES};
    c = lay_parents(6, chain, &all);
    assert_int_equal(c.reduced.node_count, 4);
    assert_near(c.layout.weights[3], 2, 0);
    assert_near(c.layout.weights[0], 6, 0);
    done(&c);
}

static void random_trees(void **state) {
    (void)state;
    enum { N = 2000 };
    static float p[3 * N], r[N];
    static sdv_segment s[N];
    for (uint32_t seed = 0; seed < 8; seed++) {
        sdv_layout_desc desc = {NULL, 0.0f, seed % 2, 0};
        vessel_random_tree(seed, N, 100, 3, p, r, s);
        case_ c = lay(N, p, r, N - 1, s, &desc);
        check_form(&c.tree, &c.reduced);
        for (uint32_t i = 0; i < c.reduced.node_count; i++) {
            uint32_t up = c.reduced.parents[i];
            assert_true(c.layout.h[i] >= 0 && c.layout.h[i] <= 1);
            assert_true(c.layout.s[i] >= 0 && c.layout.s[i] <= 1);
            if (up != SDV_NONE && c.reduced.parents[up] != SDV_NONE) {
                const uint32_t *kids = c.reduced.children + 2 * up;
                float share = c.layout.weights[kids[0]] + c.layout.weights[kids[1]];
                assert_true(c.layout.s[i] < c.layout.s[up]);
                assert_near(share + 1, c.layout.weights[up], 0);
            }
        }
        done(&c);
    }
}

static void several_trees_share_the_width(void **state) {
    (void)state;
    const int parents[] = {-1, 0, -1, 2, 3, 3}; /* weights 2 and 4 */
    sdv_layout_desc desc = {NULL, 0, 1, 0};
    case_ c = lay_parents(6, parents, &desc);
    assert_int_equal(c.reduced.root_count, 2);
    assert_near(c.layout.h[0], 1.0 / 6, 1e-6);
    assert_near(c.layout.h[2], 2.0 / 3, 1e-6);
    assert_near(c.layout.h[4], 0.5, 1e-6);
    assert_near(c.layout.h[5], 5.0 / 6, 1e-6);
    done(&c);
}

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
/* Every node has two children or none; `caterpillar`: one of them a leaf, all the way down. */
static double layout_time(uint32_t n, int caterpillar) {
    float *p = calloc(3 * n, sizeof *p), *r = calloc(n, sizeof *r);
    sdv_segment *s = malloc(n * sizeof *s);
    assert_true(p && r && s);
    for (uint32_t i = 1; i < n; i++) {
        s[i - 1].parent = i == 1 ? 0 : caterpillar ? (i - 1) / 2 * 2 - (i > 2) : i / 2;
        s[i - 1].child = i;
    }
    sdv_tree_desc desc = {n, p, r, n - 1, s, 0, NULL, NULL, 0, 0};
    sdv_tree t;
    sdv_reduced reduced;
    sdv_layout layout;
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    double best = 1e9;
    for (int i = 0; i < 5; i++) {
        double start = seconds();
        assert_int_equal(sdv_reduce(NULL, &t, &reduced), LAO_OK);
        assert_int_equal(sdv_layout_make(NULL, &t, &reduced, NULL, &layout), LAO_OK);
        best = fmin(best, seconds() - start);
        assert_true(reduced.node_count >= n);
        for (uint32_t k = 0; k < reduced.node_count; k++)
            assert_true(layout.h[k] >= 0 && layout.h[k] <= 1 && layout.s[k] >= 0);
        sdv_layout_free(&layout);
        sdv_reduced_free(&reduced);
    }
    sdv_tree_free(&t);
    free(p);
    free(r);
    free(s);
    return 1e3 * best;
}
static void layouts_are_fast(void **state) {
    (void)state;
    double small = layout_time(10000, 0), large = layout_time(1000000, 0);
    double deep = layout_time(1000001, 1);
    printf("reduce and lay out: 10,000 nodes %.2f ms, 1,000,000 %.0f ms, as deep as wide %.0f ms\n",
           small, large, deep);
#ifndef __SANITIZE_ADDRESS__
    assert_true(small < 10);
    assert_true(large < 5000 && deep < 5000);
#endif
}

typedef struct text {
    char bytes[8192];
    size_t length;
    int stop_after;
} text;
static int keep(void *user, const char *bytes, size_t length) {
    text *t = (text *)user;
    if (t->stop_after && --t->stop_after == 0)
        return 7;
    assert_true(t->length + length < sizeof t->bytes);
    memcpy(t->bytes + t->length, bytes, length);
    t->length += length;
    t->bytes[t->length] = 0;
    return 0;
}
static void texts(void **state) {
    (void)state;
    const int parents[] = {-1, 0, 0};
    const float distances[] = {NAN, 1.5f, -0.25f, NAN};
    case_ c = lay_parents(3, parents, NULL);
    text t = {"", 0, 0};
    sdv_writer writer = {keep, &t};
    assert_int_equal(sdv_layout_write_json(&c.reduced, &c.layout, distances, &writer), 0);
    assert_string_equal(
        t.bytes, "{\"nodes\":[\n"
                 "{\"id\":0,\"parent\":-1,\"h\":0.5,\"s\":1,\"weight\":4,\"distance\":null},\n"
                 "{\"id\":1,\"parent\":3,\"h\":0.25,\"s\":0,\"weight\":1,\"distance\":1.5},\n"
                 "{\"id\":2,\"parent\":3,\"h\":0.75,\"s\":0,\"weight\":1,\"distance\":-0.25},\n"
                 "{\"id\":3,\"parent\":0,\"h\":0.5,\"s\":1,\"weight\":3,\"distance\":null}\n]}\n");
    memset(&t, 0, sizeof t);
    sdv_svg_desc svg = {200, 100, 0, 3, distances, 0};
    assert_int_equal(sdv_layout_write_svg(&c.reduced, &c.layout, &svg, &writer), 0);
    assert_non_null(strstr(t.bytes, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\""));
    assert_non_null(strstr(t.bytes, "<line x1=\"100\" y1=\"3\" x2=\"53\" y2=\"97\" "
                                    "stroke=\"#ffffff\" stroke-width=\"3\"/>"));
    assert_non_null(strstr(t.bytes, "x2=\"147\" y2=\"97\" stroke=\"#c03028\" stroke-width=\"12\""));
    assert_non_null(strstr(t.bytes, "</svg>\n"));
    for (svg.radial = 0; svg.radial < 2; svg.radial++) {
        memset(&t, 0, sizeof t);
        t.stop_after = 3;
        assert_int_equal(sdv_layout_write_svg(&c.reduced, &c.layout, &svg, &writer), 7);
        t.stop_after = 0;
    }
    memset(&t, 0, sizeof t);
    t.stop_after = 2;
    assert_int_equal(sdv_layout_write_json(&c.reduced, &c.layout, NULL, &writer), 7);
    done(&c);
}

static void radial_and_colours(void **state) {
    (void)state;
    lao_v2 p = sdv_radial(0.25f, 0.5f);
    assert_near(p.x, 0, 1e-6);
    assert_near(p.y, 0.5, 1e-6);
    const double rgb[][6] = {{0, 1, 1, 1, 0, 0},
                             {1.0 / 3, 1, 1, 0, 1, 0},
                             {2.0 / 3, 1, 1, 0, 0, 1},
                             {1, 1, 1, 1, 0, 0},
                             {0.5, 1, 0.5, 0, 0.5, 0.5},
                             {0.123, 0, 1, 1, 1, 1},
                             {1.0 / 12, 0.5, 1, 1, 0.75, 0.5}};
    for (size_t i = 0; i < sizeof rgb / sizeof rgb[0]; i++) {
        lao_v3 c = sdv_hsv((float)rgb[i][0], (float)rgb[i][1], (float)rgb[i][2]);
        assert_near(c.x, rgb[i][3], 1e-6);
        assert_near(c.y, rgb[i][4], 1e-6);
        assert_near(c.z, rgb[i][5], 1e-6);
    }
}

/* Where the drawing should have a reduced node. */
static void expect_place(const case_ *c, const sdv_tree *flat, uint32_t k, float width,
                         float height, bool radial) {
    const lao_v4 *at = flat->nodes + c->reduced.ids[k];
    double h = (double)c->layout.h[k], s = (double)c->layout.s[k], x, y;
    double reach = 0.47 * (double)fminf(width, height);
    x = radial ? 0.5 * (double)width + reach * (1 - s) * cos(6.283185307 * h)
               : (double)width * (0.03 + 0.94 * h);
    y = radial ? 0.5 * (double)height + reach * (1 - s) * sin(6.283185307 * h)
               : (double)height * (0.03 + 0.94 * s);
    assert_near(at->x, x, 1e-3);
    assert_near(at->y, y, 1e-3);
    assert_true(at->z == 0.0f);
}
static void check_drawing(const case_ *c, const sdv_drawing_desc *desc) {
    const sdv_tree *t = &c->tree;
    const sdv_reduced *r = &c->reduced;
    sdv_tree flat;
    float width = desc && desc->width > 0 ? desc->width : desc && desc->radial ? 150.0f : 200.0f;
    float height = desc && desc->height > 0 ? desc->height : desc && desc->radial ? 150.0f : 100.0f;
    uint32_t extra = 0;
    assert_int_equal(sdv_layout_tree(NULL, t, r, &c->layout, desc, &flat), LAO_OK);
    for (uint32_t k = 0; k < r->node_count; k++) {
        extra += r->ids[k] >= t->node_count;
        expect_place(c, &flat, k, width, height, desc && desc->radial);
        uint32_t up = r->parents[k];
        if (up == SDV_NONE) {
            assert_int_equal(flat.parents[r->ids[k]], SDV_NONE);
            continue;
        }
        /* from the node up: a straight line, in steps as long as the vessel's, to the parent */
        const lao_v4 *low = flat.nodes + r->ids[k], *top = flat.nodes + r->ids[up];
        double whole = 0, way = 0;
        for (uint32_t n = r->nodes[k]; r->ids[k] < t->node_count && n != r->nodes[up];
             n = t->parents[n]) {
            const lao_v4 *a = t->nodes + n, *b = t->nodes + t->parents[n];
            whole += sqrt(pow((double)(a->x - b->x), 2) + pow((double)(a->y - b->y), 2) +
                          pow((double)(a->z - b->z), 2));
        }
        uint32_t n = r->ids[k];
        for (; n != r->ids[up]; n = flat.parents[n]) {
            double part = whole > 0 ? way / whole : 0;
            assert_true(n == r->ids[k] || n < t->node_count);
            assert_near(flat.nodes[n].x, (double)low->x + part * (double)(top->x - low->x), 2e-3);
            assert_near(flat.nodes[n].y, (double)low->y + part * (double)(top->y - low->y), 2e-3);
            if (n < t->node_count) {
                const lao_v4 *a = t->nodes + n, *b = t->nodes + t->parents[n];
                way += sqrt(pow((double)(a->x - b->x), 2) + pow((double)(a->y - b->y), 2) +
                            pow((double)(a->z - b->z), 2));
            }
        }
        assert_near(way, whole, 1e-3 * whole + 1e-6);
    }
    assert_int_equal(flat.node_count, t->node_count + extra);
    assert_int_equal(flat.segment_count, flat.node_count - r->root_count);
    assert_int_equal(flat.root_count, r->root_count);
    for (uint32_t i = 0; i < t->node_count; i++) { /* wider vessels, thicker edges */
        const uint32_t other = (i * 7 + 3) % t->node_count;
        assert_true(flat.nodes[i].w > 0);
        assert_true(t->nodes[i].w <= t->nodes[other].w || flat.nodes[i].w >= flat.nodes[other].w);
        assert_true(flat.nodes[i].w <= 4.001f * flat.nodes[other].w);
    }
    sdv_tree_free(&flat);
}
static void drawings(void **state) {
    (void)state;
    enum { N = 300 };
    static float p[3 * N], radii[N];
    static sdv_segment s[N];
    const sdv_drawing_desc wide = {320, 90, 0, 2}, round = {0, 0, 1, 0};
    for (uint32_t seed = 0; seed < 6; seed++) {
        vessel_random_tree(seed, N, 80, 3, p, radii, s);
        for (uint32_t i = 1; i < N && seed % 2; i++) /* nodes between, and of many children */
            s[i - 1].parent = i % 5 ? i - 1 : i / 5;
        case_ c = lay(N, p, radii, seed == 4 ? N / 2 : N - 1, s, NULL); /* 4: several roots */
        check_drawing(&c, NULL);
        check_drawing(&c, &wide);
        check_drawing(&c, &round);
        done(&c);
    }
    const float one[] = {1, 2, 3}, ball[] = {0};
    case_ c = lay(1, one, ball, 0, NULL, NULL);
    check_drawing(&c, NULL);
    lent_host host;
    sdv_host h = vessel_host_make(&host);
    sdv_tree flat;
    assert_int_equal(sdv_layout_tree(&h, NULL, &c.reduced, &c.layout, NULL, &flat),
                     LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.failures, 1);
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    for (uint32_t n = 1; result != LAO_OK; n++) {
        uint32_t failures = host.failures;
        host.memory.fail_allocation = host.memory.allocations + n;
        result = sdv_layout_tree(&h, &c.tree, &c.reduced, &c.layout, NULL, &flat);
        assert_int_equal(host.failures, failures + (result != LAO_OK));
        assert_true(result == LAO_OK ||
                    (result == LAO_ERROR_OUT_OF_MEMORY && host.memory.bytes == 0));
    }
    sdv_tree_free(&flat);
    assert_int_equal(host.memory.bytes, 0);
    assert_int_equal(host.warnings, 0);
    done(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reduced_trees),      cmocka_unit_test(paper_example),
        cmocka_unit_test(balanced_trees),     cmocka_unit_test(weights_by_scalar),
        cmocka_unit_test(random_trees),       cmocka_unit_test(several_trees_share_the_width),
        cmocka_unit_test(layouts_are_fast),   cmocka_unit_test(texts),
        cmocka_unit_test(radial_and_colours), cmocka_unit_test(drawings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
