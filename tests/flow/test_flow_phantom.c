/* Proves that the phantom is what it says: free of divergence, along the wall and zero on it,
 * smooth, periodic, with a jet, a vortex that turns back, a helix in the arch, and a box that holds
 * it; and that its grid, its surface and its lines agree with it. */
#include "flow_host.h"
#include "flow_phantom.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static flow4d_sampler phantom(void) {
    flow4d_field field;
    flow4d_sampler s;
    flow_phantom_field(&field);
    assert_int_equal(flow4d_sampler_make(NULL, &field, &s), LAO_OK);
    return s;
}

/* A random place of the box. */
static void pick(const flow4d_sampler *s, uint32_t i, double p[3]) {
    double g[3];
    for (uint32_t a = 0; a < 3; a++) {
        double u = (double)lao_hash(lao_hash(i) + a) / 4294967296.0;
        g[a] = u * s->field.size[a] - 0.5;
    }
    flow4d_to_world(s, g, p);
}

static double length(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void divergence_is_zero(void **state) {
    (void)state;
    flow4d_sampler s = phantom();
    const double h = 1e-4;
    double steepest = 0;
    int inside = 0;
    for (uint32_t i = 0; i < 200000; i++) {
        double p[3], q[3], a[3], b[3], sum = 0, time = i % 833;
        pick(&s, i, p);
        if (flow_phantom_wall(p) > -2 * h || !flow4d_inside(&s, p, FLOW4D_MASK_NEAREST))
            continue;
        inside++;
        for (int c = 0; c < 3; c++) {
            memcpy(q, p, sizeof q);
            q[c] = p[c] + h;
            flow4d_sample(&s, q, time, a);
            q[c] = p[c] - h;
            flow4d_sample(&s, q, time, b);
            double slope = (a[c] - b[c]) / (2 * h);
            steepest = fmax(steepest, fabs(slope));
            sum += slope;
        }
        assert_true(fabs(sum) < 1e-9); /* 1/ms; slopes reach 0.2 */
    }
    assert_true(inside > 10000 && steepest > 0.1);
}

/* From a place inside outward along x or y: the wall, by bisection. */
static void wall_beside(const double inside[3], int axis, double wall[3]) {
    double out = 0, in = 0;
    memcpy(wall, inside, 3 * sizeof(double));
    for (; flow_phantom_wall(wall) < 0; out += 0.25)
        wall[axis] = inside[axis] + out;
    for (int k = 0; k < 100; k++) {
        double middle = 0.5 * (in + out);
        wall[axis] = inside[axis] + middle;
        if (flow_phantom_wall(wall) < 0)
            in = middle;
        else
            out = middle;
    }
    wall[axis] = inside[axis] + in;
}

static void flow_is_zero_on_the_wall_and_along_it(void **state) {
    (void)state;
    flow4d_sampler s = phantom();
    int walls = 0;
    for (uint32_t i = 0; i < 100000 && walls < 5000; i++) {
        double p[3], w[3], v[3], n[3], along = 0, time = i % 833;
        pick(&s, i, p);
        if (!flow4d_inside(&s, p, FLOW4D_MASK_NEAREST))
            continue;
        wall_beside(p, (int)(i % 2), w);
        flow4d_sample(&s, w, time, v);
        assert_true(length(v) < 1e-9);
        if (!flow4d_inside(&s, w, FLOW4D_MASK_NEAREST))
            continue; /* beyond an open end */
        walls++;
        for (int c = 0; c < 3; c++) { /* the wall's normal, and a place a little inside */
            double q[3] = {w[0], w[1], w[2]}, r[3] = {w[0], w[1], w[2]};
            q[c] += 1e-5, r[c] -= 1e-5;
            n[c] = (flow_phantom_wall(q) - flow_phantom_wall(r)) / 2e-5;
        }
        double size = length(n);
        assert_true(size > 0.6 && size < 1.4); /* about a distance */
        for (int c = 0; c < 3; c++)
            w[c] -= 1e-3 * n[c] / size;
        flow4d_sample(&s, w, time, v);
        for (int c = 0; c < 3; c++)
            along += v[c] * n[c] / size;
        if (length(v) > 1e-5)
            assert_true(fabs(along) < 0.01 * length(v));
    }
    assert_int_equal(walls, 5000);
}

static void flow_is_smooth_and_periodic(void **state) {
    (void)state;
    flow4d_sampler s = phantom();
    for (uint32_t i = 0; i < 50000; i++) {
        double p[3], q[3], a[3], b[3], time = i % 833;
        pick(&s, i, p);
        flow4d_sample(&s, p, time, a);
        flow4d_sample(&s, p, time + 3 * 833.0, b);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(a[c] - b[c]) < 1e-12);
        memcpy(q, p, sizeof q);
        q[i % 3] += 1e-6; /* mm: nowhere a jump, at the seams of the centreline neither */
        flow4d_sample(&s, q, time, b);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(a[c] - b[c]) < 1e-6);
    }
    for (int k = 0; k < 2000; k++) { /* across the seams, up = 0 */
        double p[3] = {-60 + 0.06 * k, -60 + 0.055 * (k * 7 % 2000), 1e-9}, q[3], a[3], b[3];
        memcpy(q, p, sizeof q);
        q[2] = -1e-9;
        flow4d_sample(&s, p, 200, a);
        flow4d_sample(&s, q, 200, b);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(a[c] - b[c]) < 1e-8);
    }
}

/* Systole is fast, diastole slow but never at rest; beside the jet the vortex turns back. */
static void jet_and_vortex_are_there(void **state) {
    (void)state;
    flow4d_sampler s = phantom();
    double fastest[2] = {0, 0};
    uint32_t back = 0, bulge = 0;
    for (uint32_t i = 0; i < 200000; i++) {
        double p[3], v[3];
        pick(&s, i, p);
        if (!flow4d_inside(&s, p, FLOW4D_MASK_NEAREST))
            continue;
        flow4d_sample(&s, p, 150, v);
        fastest[0] = fmax(fastest[0], length(v));
        flow4d_sample(&s, p, 700, v);
        fastest[1] = fmax(fastest[1], length(v));
        flow4d_sample(&s, p, 330, v);
        if (p[2] > -70 && p[2] < -20 && p[0] > 0) { /* the ascending part: up is onward */
            bulge++;
            back += v[2] < -0.01;
        }
    }
    assert_true(fastest[0] > 1.5 && fastest[0] < 3.0);
    assert_true(fastest[1] > 0.1 && fastest[1] < 0.6);
    assert_true(back > bulge / 10 && back < bulge / 2);
}

static void the_box_holds_the_vessel(void **state) {
    (void)state;
    flow4d_sampler s = phantom();
    double g[3], p[3];
    uint32_t n[3] = {s.field.size[0], s.field.size[1], s.field.size[2]}, checked = 0;
    for (int face = 0; face < 6; face++) {
        for (int u = 0; u <= 100; u++) {
            for (int w = 0; w <= 100; w++) {
                int a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3;
                g[a] = face % 2 ? n[a] - 0.5 : -0.5;
                g[b] = 0.01 * u * n[b] - 0.5;
                g[c] = 0.01 * w * n[c] - 0.5;
                flow4d_to_world(&s, g, p);
                assert_false(s.field.inside_at(NULL, p));
                checked++;
            }
        }
    }
    assert_true(checked > 50000);
}

/* Lines of the field end where the vessel ends, not at its wall; lines of the grid, which blurs
 * the wall, are mostly the same. */
static void lines_follow_the_vessel(void **state) {
    (void)state;
    flow4d_field field, grid;
    flow4d_trace_settings s;
    flow4d_lines lines;
    memset(&s, 0, sizeof s);
    s.line_count = 1000;
    s.attributes = FLOW4D_VORTICITY | FLOW4D_CURVATURE;
    flow_phantom_field(&field);
    assert_int_equal(flow4d_trace(NULL, &field, &s, &lines), LAO_OK);
    uint32_t walls = 0;
    for (uint32_t i = 0; i < lines.line_count; i++) {
        uint32_t ends[2] = {lines.offsets[i], lines.offsets[i + 1] - 1};
        for (int k = 0; k < 2 && ends[1] - ends[0] < 198; k++) {
            const float *p = lines.points + 3 * (size_t)ends[k];
            double cut = fmin(fabs((double)p[2] + 92), fabs((double)p[2] + 112));
            double t = (double)lines.times[ends[k]];
            walls += t > 5 && t < 828 && cut > 12; /* at most one step from an open end */
        }
    }
    assert_true(walls < 10);
    flow4d_lines_free(&lines);
    assert_true(flow_phantom_grid(NULL, 0, &grid));
    assert_int_equal(grid.frame_count, 21);
    assert_int_equal(flow4d_trace(NULL, &grid, &s, &lines), LAO_OK);
    assert_true(lines.point_count > 100000);
    flow4d_lines_free(&lines);
    flow_phantom_grid_free(&grid);
    flow_phantom_grid_free(&grid);
    assert_false(flow_phantom_grid((const double[]){0, 1, 1}, 0, &grid));
}

/* The surface of the wall's distance is a tube: closed, of one piece without a hole. */
static void the_wall_is_a_surface(void **state) {
    (void)state;
    flow4d_sampler s = phantom();
    size_t count = (size_t)s.field.size[0] * s.field.size[1] * s.field.size[2];
    float *values = malloc(count * sizeof(float));
    flow4d_volume volume;
    flow4d_surface surface;
    flow4d_surface_settings settings = {1, 0};
    assert_non_null(values);
    for (size_t i = 0; i < count; i++) {
        size_t row = i / s.field.size[0], slice = row / s.field.size[1];
        double g[3] = {(double)(i % s.field.size[0]), (double)(row % s.field.size[1]),
                       (double)slice};
        double p[3];
        flow4d_to_world(&s, g, p);
        values[i] = s.field.inside_at(NULL, p) ? (float)flow_phantom_wall(p)
                                               : (float)fmax(flow_phantom_wall(p), 1.0);
    }
    memset(&volume, 0, sizeof volume);
    memcpy(volume.size, s.field.size, sizeof volume.size);
    memcpy(volume.to_world, s.field.to_world, sizeof volume.to_world);
    volume.values = values;
    assert_int_equal(flow4d_surface_make(NULL, &volume, 0, &settings, &surface), LAO_OK);
    assert_int_equal((int64_t)surface.vertex_count - surface.triangle_count / 2, 2);
    flow4d_surface_free(&surface);
    free(values);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(divergence_is_zero),
        cmocka_unit_test(flow_is_zero_on_the_wall_and_along_it),
        cmocka_unit_test(flow_is_smooth_and_periodic),
        cmocka_unit_test(jet_and_vortex_are_there),
        cmocka_unit_test(the_box_holds_the_vessel),
        cmocka_unit_test(lines_follow_the_vessel),
        cmocka_unit_test(the_wall_is_a_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
