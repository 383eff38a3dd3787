/* Proves that surfaces are closed and turned outward for every mask (all neighbourhoods of 2 and 3
 * voxels, and random ones), have the right Euler number, area and volume, and lie where the values
 * cross (METHODS 11.5). */
#include "flow_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static flow4d_volume make_volume(uint32_t x, uint32_t y, uint32_t z, const float *values,
                                 const uint8_t *mask) {
    flow4d_volume v;
    memset(&v, 0, sizeof v);
    v.size[0] = x;
    v.size[1] = y;
    v.size[2] = z;
    v.to_world[0] = v.to_world[5] = v.to_world[10] = 1;
    v.values = values;
    v.mask = mask;
    return v;
}

static int compare(const void *a, const void *b) {
    const uint64_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

typedef struct measure {
    double area, volume;
    int64_t euler;
} measure;

/* Every edge twice, in opposite directions; no triangle without area; every vertex in use, once. */
static measure check_closed(const flow4d_surface *s) {
    measure m = {0, 0, 0};
    size_t edges = 3 * (size_t)s->triangle_count;
    uint64_t *there = malloc(8 * edges + 8), *back = malloc(8 * edges + 8);
    uint8_t *used = calloc(s->vertex_count + 1u, 1);
    assert_true(there && back && used);
    for (uint32_t t = 0; t < s->triangle_count; t++) {
        const uint32_t *i = s->triangles + 3 * (size_t)t;
        double p[3][3], n[3];
        for (int k = 0; k < 3; k++) {
            uint64_t a = i[k], b = i[(k + 1) % 3];
            assert_true(a < s->vertex_count && a != b);
            used[a] = 1;
            there[3 * t + (uint32_t)k] = a << 32 | b;
            back[3 * t + (uint32_t)k] = b << 32 | a;
            for (int c = 0; c < 3; c++)
                p[k][c] = (double)s->vertices[3 * i[k] + (uint32_t)c];
        }
        for (int c = 0; c < 3; c++) {
            int d = (c + 1) % 3, e = (c + 2) % 3;
            n[c] = (p[1][d] - p[0][d]) * (p[2][e] - p[0][e]) -
                   (p[1][e] - p[0][e]) * (p[2][d] - p[0][d]);
        }
        double area = 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        assert_true(area > 0);
        m.area += area;
        m.volume += (p[0][0] * n[0] + p[0][1] * n[1] + p[0][2] * n[2]) / 6;
    }
    qsort(there, edges, 8, compare);
    qsort(back, edges, 8, compare);
    for (size_t e = 0; e < edges; e++) {
        assert_true(there[e] == back[e]);
        assert_true(e == 0 || there[e] != there[e - 1]);
    }
    for (uint32_t v = 0; v < s->vertex_count; v++)
        assert_true(used[v]);
    m.euler = (int64_t)s->vertex_count - (int64_t)(edges / 2) + (int64_t)s->triangle_count;
    free(there);
    free(back);
    free(used);
    return m;
}

static measure make_and_check(const flow4d_volume *volume, double iso,
                              const flow4d_surface_settings *settings) {
    flow4d_surface s;
    assert_int_equal(flow4d_surface_make(NULL, volume, iso, settings, &s), LAO_OK);
    measure m = check_closed(&s);
    flow4d_surface_free(&s);
    return m;
}

static void one_voxel_is_an_octahedron(void **state) {
    (void)state;
    static const uint8_t mask[27] = {[13] = 1}, alone[1] = {1};
    flow4d_volume volumes[2] = {make_volume(3, 3, 3, NULL, mask),
                                make_volume(1, 1, 1, NULL, alone)};
    for (int i = 0; i < 2; i++) {
        flow4d_surface s;
        assert_int_equal(flow4d_surface_make(NULL, &volumes[i], 0.5, NULL, &s), LAO_OK);
        assert_int_equal(s.triangle_count, 8);
        assert_int_equal(s.vertex_count, 6);
        measure m = check_closed(&s);
        assert_int_equal(m.euler, 2);
        assert_true(fabs(m.volume - 1.0 / 6) < 1e-6); /* of half diagonals 0.5 */
        assert_true(fabs(m.area - sqrt(3.0)) < 1e-6);
        flow4d_surface_free(&s);
        flow4d_surface_free(&s);
    }
    flow4d_surface_free(NULL);
}

/* All masks of a cell and of two cells side by side along each axis: so every case of the table,
 * and every pair that shares a face, is closed and outward. */
static void every_pair_of_cells_fits(void **state) {
    (void)state;
    static const uint32_t sizes[4][3] = {{2, 2, 2}, {3, 2, 2}, {2, 3, 2}, {2, 2, 3}};
    for (int k = 0; k < 4; k++) {
        const uint32_t *n = sizes[k], count = n[0] * n[1] * n[2];
        for (uint32_t bits = 0; bits < 1u << count; bits++) {
            uint8_t mask[12];
            uint32_t inside = 0;
            for (uint32_t i = 0; i < count; i++)
                inside += mask[i] = bits >> i & 1;
            flow4d_volume volume = make_volume(n[0], n[1], n[2], NULL, mask);
            measure m = make_and_check(&volume, 0.5, NULL);
            /* at least the voxels' octahedra, at most their boxes */
            assert_true(m.volume >= inside / 6.0 - 1e-5 && m.volume <= inside + 1e-5);
            assert_int_equal(m.euler % 2, 0);
        }
    }
}

static void random_masks_are_closed(void **state) {
    (void)state;
    enum { N = 24 };
    static uint8_t mask[N * N * N];
    for (uint32_t seed = 0; seed < 8; seed++) {
        uint32_t inside = 0;
        for (uint32_t i = 0; i < N * N * N; i++)
            inside += mask[i] = lao_hash(i + lao_hash(seed)) % 8 <= seed;
        if (seed == 7) /* and the mask of nothing but corners that meet across diagonals */
            for (uint32_t i = 0; i < N * N * N; i++)
                mask[i] = (i + i / N + i / (N * N)) % 2 == 0;
        flow4d_volume volume = make_volume(N, N, N, NULL, mask);
        measure m = make_and_check(&volume, 0.5, NULL);
        if (seed < 7)
            assert_true(m.volume > inside / 6.0 &&
                        m.volume < N * N * N - (N * N * N - inside) / 6.0);
        else /* kept apart: octahedra */
            assert_true(fabs(m.volume - N * N * N / 12.0) < 1e-2);
    }
}

enum { S = 48 };
static float values[S * S * S];

/* Distance to a sphere, a torus, or a torus of two holes; centre of the volume is the origin. */
static double shape(int which, double x, double y, double z) {
    double ring = sqrt(x * x + y * y) - 14;
    if (which == 0)
        return sqrt(x * x + y * y + z * z) - 17.3;
    if (which == 1)
        return sqrt(ring * ring + z * z) - 5.2;
    double left = sqrt((x - 9) * (x - 9) + y * y) - 8, right = sqrt((x + 9) * (x + 9) + y * y) - 8;
    return fmin(sqrt(left * left + z * z), sqrt(right * right + z * z)) - 3.6;
}

static flow4d_volume make_shape(int which) {
    for (int i = 0; i < S * S * S; i++) {
        int row = i / S, slice = i / (S * S);
        double half = (S - 1) / 2.0;
        values[i] = (float)shape(which, i % S - half, row % S - half, slice - half);
    }
    return make_volume(S, S, S, values, NULL);
}

static void shapes_have_their_measures(void **state) {
    (void)state;
    const double pi = 3.14159265358979324;
    static const int64_t euler[3] = {2, 0, -2};
    const double area[2] = {4 * pi * 17.3 * 17.3, 4 * pi * pi * 14 * 5.2};
    const double body[2] = {4 * pi / 3 * 17.3 * 17.3 * 17.3, 2 * pi * pi * 14 * 5.2 * 5.2};
    flow4d_surface_settings s;
    memset(&s, 0, sizeof s);
    for (int k = 0; k < 3; k++) {
        flow4d_volume volume = make_shape(k);
        s.inside_is_less = 1;
        measure m = make_and_check(&volume, 0.0, &s);
        assert_int_equal(m.euler, euler[k]);
        if (k < 2) {
            assert_true(fabs(m.area / area[k] - 1) < 0.02);
            assert_true(fabs(m.volume / body[k] - 1) < 0.02);
        }
        /* the rest of the volume: a box with the shape as a cavity */
        s.inside_is_less = 0;
        measure rest = make_and_check(&volume, 0.0, &s);
        assert_int_equal(rest.euler, euler[k] + 2);
        assert_true(rest.volume > 0 && rest.volume + m.volume < (double)S * S * S);
        assert_true(rest.volume + m.volume > (double)S * S * S - 6 * S);
        /* its mask: within a shell of a voxel */
        static uint8_t mask[S * S * S];
        uint32_t inside = 0;
        for (int i = 0; i < S * S * S; i++)
            inside += mask[i] = values[i] < 0;
        flow4d_volume binary = make_volume(S, S, S, NULL, mask);
        measure b = make_and_check(&binary, 0.5, NULL);
        assert_int_equal(b.euler, euler[k]);
        assert_true(fabs(b.volume - inside) < 0.5 * b.area);
    }
}

/* Vertices lie on the crossing, in world space; a mirrored lattice still turns outward. */
static void vertices_lie_on_the_crossing(void **state) {
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        flow4d_volume volume = make_shape(0);
        flow4d_surface_settings s = {1, 0};
        flow4d_surface surface;
        double edge[3] = {2, 3, mirrored ? -0.5 : 0.5};
        for (size_t a = 0; a < 3; a++) {
            volume.to_world[5 * a] = edge[a];
            volume.to_world[4 * a + 3] = 10.0 * (double)a;
        }
        assert_int_equal(flow4d_surface_make(NULL, &volume, 1.5, &s, &surface), LAO_OK);
        measure m = check_closed(&surface);
        double body = 4 * 3.14159265358979324 / 3 * pow(18.8, 3) * 3;
        assert_true(fabs(m.volume / body - 1) < 0.02); /* positive: outward */
        for (uint32_t i = 0; i < surface.vertex_count; i++) {
            double p[3];
            for (uint32_t a = 0; a < 3; a++)
                p[a] = ((double)surface.vertices[3 * i + a] - 10.0 * a) / edge[a] - (S - 1) / 2.0;
            assert_true(fabs(shape(0, p[0], p[1], p[2]) - 1.5) < 0.02);
        }
        flow4d_surface_free(&surface);
    }
}

/* 1-2-1 along x: 0 0 1 1 becomes 0 .25 .75 1. */
static void smoothing_is_binomial(void **state) {
    (void)state;
    uint8_t mask[4 * 9 * 9];
    for (int i = 0; i < 4 * 81; i++)
        mask[i] = i % 4 >= 2;
    flow4d_volume volume = make_volume(4, 9, 9, NULL, mask);
    static const struct {
        uint32_t passes;
        double iso, x;
    } rows[] = {{0, 0.5, 1.5}, {1, 0.5, 1.5}, {1, 0.3, 1.1}, {1, 0.2, 0.8}, {2, 0.625, 1.75}};
    /* twice: 0.0625 .3125 .6875 .9375 */
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        flow4d_surface_settings s = {0, rows[k].passes};
        flow4d_surface surface;
        double least = 9, expected = rows[k].passes < 2 ? rows[k].x : 1 + (0.625 - 0.3125) / 0.375;
        assert_int_equal(flow4d_surface_make(NULL, &volume, rows[k].iso, &s, &surface), LAO_OK);
        check_closed(&surface);
        for (size_t i = 0; i < surface.vertex_count; i++)
            least = fmin(least, (double)surface.vertices[3 * i]);
        assert_true(fabs(least - expected) < 1e-6);
        flow4d_surface_free(&surface);
    }
}

static void odd_values_are_no_harm(void **state) {
    (void)state;
    enum { N = 12 };
    static float odd[N * N * N];
    for (uint32_t i = 0; i < N * N * N; i++) {
        uint32_t h = lao_hash(i) % 8;
        odd[i] = h == 0   ? NAN
                 : h == 1 ? INFINITY
                 : h == 2 ? -INFINITY
                 : h == 3 ? 0.5f
                 : h == 4 ? 1e38f
                          : lao_unit_float(lao_hash(i + 7));
    }
    flow4d_volume volume = make_volume(N, N, N, odd, NULL);
    for (int k = 0; k < 4; k++) {
        flow4d_surface_settings s = {k % 2, k < 2 ? 0u : 2u};
        flow4d_surface surface;
        assert_int_equal(flow4d_surface_make(NULL, &volume, 0.5, &s, &surface), LAO_OK);
        check_closed(&surface);
        for (uint32_t i = 0; i < 3 * surface.vertex_count; i++)
            assert_true(isfinite(surface.vertices[i]));
        flow4d_surface_free(&surface);
    }
    for (uint32_t i = 0; i < N * N * N; i++)
        odd[i] = NAN;
    flow4d_surface none;
    assert_int_equal(flow4d_surface_make(NULL, &volume, 0.5, NULL, &none), LAO_OK);
    assert_true(none.vertex_count == 0 && none.triangle_count == 0 && !none.vertices);
    flow4d_surface_free(&none);
}

static void failures_are_clean(void **state) {
    (void)state;
    static const uint8_t mask[8] = {1, 0, 1, 1, 0, 1, 0, 1};
    flow4d_volume good = make_volume(2, 2, 2, NULL, mask), bad;
    flow4d_surface_settings smooth = {0, 1}, much = {0, 101};
    flow_host h;
    flow4d_surface s, before;
    memset(&s, 0x5a, sizeof s);
    before = s;
    bool done = false;
    for (uint32_t n = 1; !done; n++) {
        flow_host_make(&h, 0);
        h.fail_at = n;
        lao_result result = flow4d_surface_make(&h.host, &good, 0.5, &smooth, &s);
        done = result == LAO_OK;
        if (!done) {
            assert_int_equal(result, LAO_ERROR_OUT_OF_MEMORY);
            assert_int_equal(h.failures, 1);
            assert_memory_equal(&s, &before, sizeof s);
        } else {
            assert_true(n == 6);
            flow4d_surface_free(&s);
        }
        assert_int_equal(h.live, 0);
        assert_int_equal(h.wrong_calls, 0);
    }
    for (uint32_t n = 1; n <= 6; n++) { /* three slices of cells, twice */
        flow_host_make(&h, 0);
        h.cancel_at = n;
        assert_int_equal(flow4d_surface_make(&h.host, &good, 0.5, &smooth, &s),
                         LAO_ERROR_NOT_READY);
        assert_int_equal(h.live, 0);
        assert_int_equal(h.failures, 1);
        assert_true(h.done == n && h.total == 6);
    }
    flow_host_make(&h, 0);
    bad = good;
    bad.mask = NULL;
    assert_int_not_equal(flow4d_surface_make(&h.host, &bad, 0.5, NULL, &s), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_NULL_ARGUMENT);
    assert_int_not_equal(flow4d_surface_make(&h.host, NULL, 0.5, NULL, &s), LAO_OK);
    assert_int_not_equal(flow4d_surface_make(&h.host, &good, 0.5, NULL, NULL), LAO_OK);
    bad = good;
    bad.size[1] = 0;
    assert_int_not_equal(flow4d_surface_make(&h.host, &bad, 0.5, NULL, &s), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_SIZE);
    bad.size[1] = 0xffffffffu;
    bad.size[2] = 1;
    assert_int_not_equal(flow4d_surface_make(&h.host, &bad, 0.5, NULL, &s), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_SIZE);
    bad = good;
    bad.to_world[0] = 0;
    assert_int_not_equal(flow4d_surface_make(&h.host, &bad, 0.5, NULL, &s), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_AFFINE);
    assert_int_not_equal(flow4d_surface_make(&h.host, &good, (double)NAN, NULL, &s), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_ISO);
    assert_int_not_equal(flow4d_surface_make(&h.host, &good, 0.5, &much, &s), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_SETTING);
    assert_int_equal(h.failures, 8);
    assert_int_equal(h.allocations, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_voxel_is_an_octahedron),
        cmocka_unit_test(every_pair_of_cells_fits),
        cmocka_unit_test(random_masks_are_closed),
        cmocka_unit_test(shapes_have_their_measures),
        cmocka_unit_test(vertices_lie_on_the_crossing),
        cmocka_unit_test(smoothing_is_binomial),
        cmocka_unit_test(odd_values_are_no_harm),
        cmocka_unit_test(failures_are_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
