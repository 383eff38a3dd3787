/* Proves that pathlines are what METHODS 11.3 asks for: the integrators have their order and
 * reverse, lines keep to their span, points and inside, seeds are uniform, unknown velocities and
 * settings end a line or a call, and memory stays within bounds and is given back. */
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

static const double turn = 6.28318530717958648;

/* ---- fields with known pathlines ------------------------------------------------------------ */

static uint64_t calls; /* of a function of this program's one thread */

static void constant_at(void *user, const double p[3], double t, double v[3]) {
    (void)user, (void)p, (void)t;
    v[0] = 0.5, v[1] = -0.25, v[2] = 2.0;
}

/* One turn about z per 800 ms. */
static void rotation_at(void *user, const double p[3], double t, double v[3]) {
    (void)user, (void)t;
    v[0] = -turn / 800 * p[1], v[1] = turn / 800 * p[0], v[2] = 0;
}

static void breath_at(void *user, const double p[3], double t, double v[3]) {
    (void)user, (void)p;
    v[0] = cos(turn * t / 800), v[1] = v[2] = 0;
}

/* Rises along x with time and place: x(t) = x0 exp(sin(turn t / 800)). */
static void swell_at(void *user, const double p[3], double t, double v[3]) {
    (void)user;
    v[0] = p[0] * turn / 800 * cos(turn * t / 800), v[1] = v[2] = 0;
}

/* Lamb and Oseen's vortex: circles, the inner ones faster. */
static double lamb_speed(double r2) {
    return r2 > 0 ? 0.9 * (1 - exp(-r2 / 9)) / r2 : 0.1;
}
static void lamb_at(void *user, const double p[3], double t, double v[3]) {
    double w = lamb_speed(p[0] * p[0] + p[1] * p[1]);
    (void)user, (void)t;
    calls++;
    v[0] = -w * p[1], v[1] = w * p[0], v[2] = 0.01;
}

static void none_at(void *user, const double p[3], double t, double v[3]) {
    (void)user, (void)t;
    v[0] = p[0] > 3.0 ? (double)NAN : 1.0, v[1] = v[2] = 0;
}

typedef void velocity_fn(void *user, const double p[3], double t, double v[3]);

/* A box of 400 mm around 0. */
static flow4d_field make_field(velocity_fn *velocity, double period) {
    flow4d_field field;
    flow_lattice(&field, 20, 20, 20, 20.0, -190.0);
    field.velocity_at = velocity;
    field.period = period;
    return field;
}

static flow4d_sampler make_sampler(velocity_fn *velocity, double period) {
    flow4d_field field = make_field(velocity, period);
    flow4d_sampler s;
    assert_int_equal(flow4d_sampler_make(NULL, &field, &s), LAO_OK);
    return s;
}

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* `steps` steps over `duration` from time `from`. */
static void go(const flow4d_sampler *s, flow4d_method method, double from, double duration,
               int steps, double x[3]) {
    for (int k = 0; k < steps; k++) {
        double time = from + duration * k / steps;
        assert_int_equal(
            flow4d_step(s, method, FLOW4D_MASK_NEAREST, time, duration / steps, 1e-9, x), 0);
    }
}

static void constant_velocity_is_exact(void **state) {
    (void)state;
    flow4d_sampler s = make_sampler(constant_at, 800);
    for (int m = 0; m < 2; m++) {
        double x[3] = {1, 2, -40}, expected[3] = {1 + 0.5 * 32, 2 - 0.25 * 32, -40 + 2.0 * 32};
        go(&s, (flow4d_method)m, 0, 32, 8, x);
        assert_true(distance(x, expected) < 1e-12);
    }
}

static void a_turn_keeps_its_radius(void **state) {
    (void)state;
    flow4d_sampler s = make_sampler(rotation_at, 800);
    double x[3] = {1, 0, 0}, start[3] = {1, 0, 0};
    go(&s, FLOW4D_RK4, 0, 800, 200, x);
    assert_true(fabs(sqrt(x[0] * x[0] + x[1] * x[1]) - 1) < 1e-7);
    assert_true(distance(x, start) < 1e-5);
}

static void a_breath_returns(void **state) {
    (void)state;
    flow4d_sampler s = make_sampler(breath_at, 800);
    double x[3] = {1, 0, 0};
    go(&s, FLOW4D_RK4, 0, 800, 200, x);
    assert_true(fabs(x[0] - 1) < 1e-10);
}

static void backward_undoes_forward(void **state) {
    (void)state;
    flow4d_sampler fields[2] = {make_sampler(rotation_at, 800), make_sampler(swell_at, 800)};
    for (int f = 0; f < 2; f++) {
        for (int m = 0; m < 2; m++) {
            double x[3] = {3, -2, 1}, start[3] = {3, -2, 1};
            go(&fields[f], (flow4d_method)m, 100, 400, 200, x);
            assert_true(distance(x, start) > 0.1);
            go(&fields[f], (flow4d_method)m, 500, -400, 200, x);
            assert_true(distance(x, start) < 1e-8);
        }
    }
}

/* Halving the step divides the error by 16, in space and time. */
static void runge_kutta_has_order_four(void **state) {
    (void)state;
    for (int f = 0; f < 2; f++) {
        flow4d_sampler s = make_sampler(f ? swell_at : rotation_at, 800);
        double before = 0;
        for (int steps = 25; steps <= 200; steps *= 2) {
            double x[3] = {5, 1, 0}, angle = turn / 800 * 500, exact[3] = {0, 0, 0};
            if (f) {
                exact[0] = 5 * exp(sin(turn * 500 / 800)), exact[1] = 1;
            } else {
                exact[0] = 5 * cos(angle) - sin(angle), exact[1] = 5 * sin(angle) + cos(angle);
            }
            go(&s, FLOW4D_RK4, 0, 500, steps, x);
            double error = distance(x, exact);
            if (before > 0) {
                assert_true(before / error > 16 * 0.8 && before / error < 16 * 1.2);
            }
            before = error;
        }
    }
}

/* The error of a step stays within the tolerance of its parts, and parts are as many as needed. */
static void dormand_prince_keeps_its_tolerance(void **state) {
    (void)state;
    flow4d_sampler s = make_sampler(lamb_at, 0);
    uint64_t before = 0;
    static const double tolerances[] = {1e-3, 1e-5, 1e-7, 1e-9};
    for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++) {
        double tolerance = tolerances[i];
        for (int k = 0; k < 20; k++) {
            double r = 0.3 + 0.5 * k, angle = 0.7 * k, time = 150;
            double x[3] = {r * cos(angle), r * sin(angle), 0}, exact[3];
            calls = 0;
            assert_int_equal(
                flow4d_step(&s, FLOW4D_DOPRI, FLOW4D_MASK_NEAREST, 0, time, tolerance, x), 0);
            double parts = (double)(calls - 1) / 6;
            angle += time * lamb_speed(r * r);
            exact[0] = r * cos(angle), exact[1] = r * sin(angle), exact[2] = 0.01 * time;
            /* an early error across the circle grows along it by the shear of the vortex */
            double shear = (lamb_speed((r + 1e-5) * (r + 1e-5)) - lamb_speed(r * r)) / 1e-5;
            assert_true(distance(x, exact) < tolerance * parts * (1 + fabs(shear) * r * time));
            if (k == 0) {
                assert_true(calls > before); /* a smaller tolerance costs more */
                before = calls;
            }
        }
    }
    double x[3] = {1, 0, 0}; /* a step where nothing turns is one part */
    flow4d_sampler c = make_sampler(breath_at, 800);
    assert_int_equal(flow4d_step(&c, FLOW4D_DOPRI, FLOW4D_MASK_NEAREST, 0, 1, 1e-6, x), 0);
}

static void steps_that_leave_move_nothing(void **state) {
    (void)state;
    flow4d_sampler s = make_sampler(constant_at, 800), n = make_sampler(none_at, 0);
    for (int m = 0; m < 2; m++) {
        double x[3] = {0, 0, 195}, same[3] = {0, 0, 195}, far[3] = {0, 0, 201};
        assert_int_equal(flow4d_step(&s, (flow4d_method)m, FLOW4D_MASK_NEAREST, 0, 3, 1e-3, x), -1);
        assert_memory_equal(x, same, sizeof x);
        assert_int_equal(flow4d_step(&s, (flow4d_method)m, FLOW4D_MASK_NEAREST, 0, 2, 1e-3, x), 0);
        assert_true(fabs(x[2] - 199) < 1e-12);
        assert_int_equal(flow4d_step(&s, (flow4d_method)m, FLOW4D_MASK_NEAREST, 0, 1, 1e-3, far),
                         -1);
        double y[3] = {2.5, 0, 0};
        assert_int_equal(flow4d_step(&n, (flow4d_method)m, FLOW4D_MASK_NEAREST, 0, 1, 1e-3, y), -1);
        assert_true(y[0] == 2.5);
        assert_int_equal(
            flow4d_step(&n, (flow4d_method)m, FLOW4D_MASK_NEAREST, (double)NAN, 1, 1e-3, y), -1);
    }
}

/* ---- lines -------------------------------------------------------------------------------- */

static void check_form(const flow4d_lines *lines) {
    assert_int_equal(lines->offsets[0], 0);
    assert_int_equal(lines->offsets[lines->line_count], lines->point_count);
    for (uint32_t i = 0; i < lines->line_count; i++) {
        assert_true(lines->offsets[i] <= lines->offsets[i + 1]);
        for (uint32_t k = lines->offsets[i] + 1; k < lines->offsets[i + 1]; k++) {
            assert_true(fabs((double)(lines->times[k] - lines->times[k - 1]) - lines->step) < 1e-3);
        }
    }
    for (size_t k = 0; k < lines->point_count; k++)
        assert_true(isfinite(lines->points[3 * k]) && isfinite(lines->speeds[k]));
}

static flow4d_lines trace(const flow4d_field *field, const flow4d_trace_settings *settings) {
    flow4d_lines lines;
    assert_int_equal(flow4d_trace(NULL, field, settings, &lines), LAO_OK);
    check_form(&lines);
    return lines;
}

static flow4d_trace_settings from_seeds(const double *seeds, uint32_t count) {
    flow4d_trace_settings s;
    memset(&s, 0, sizeof s);
    s.seeds = seeds;
    s.seed_count = count;
    return s;
}

/* First and last time and number of points of line i. */
static void check_line(const flow4d_lines *lines, uint32_t i, double first, double last,
                       uint32_t count) {
    uint32_t from = lines->offsets[i], to = lines->offsets[i + 1];
    assert_int_equal(to - from, count);
    assert_true(fabs((double)lines->times[from] - first) < 1e-3);
    assert_true(fabs((double)lines->times[to - 1] - last) < 1e-3);
}

static void spans_hold(void **state) {
    (void)state;
    static const double seeds[4 * 4] = {1, 0, 0, 0, 1, 0, 0, 301, 1, 0, 0, 798, 1, 0, 0, 1001};
    flow4d_field field = make_field(rotation_at, 800);
    flow4d_trace_settings s = from_seeds(seeds, 4);
    flow4d_lines lines = trace(&field, &s); /* one cycle at steps of 4 ms, 200 points */
    assert_true(lines.step == 4.0);
    check_line(&lines, 0, 0, 796, 200);
    check_line(&lines, 1, 1, 797, 200);
    check_line(&lines, 2, 2, 798, 200);
    check_line(&lines, 3, 801, 1597, 200); /* the cycle that it lies in */
    flow4d_lines_free(&lines);
    s.max_points = 201;
    lines = trace(&field, &s);
    check_line(&lines, 0, 0, 800, 201);
    check_line(&lines, 1, 1, 797, 200);
    flow4d_lines_free(&lines);
    s.max_points = 11; /* the longer side gives way */
    lines = trace(&field, &s);
    check_line(&lines, 0, 0, 40, 11);
    check_line(&lines, 1, 281, 321, 11);
    check_line(&lines, 2, 758, 798, 11);
    flow4d_lines_free(&lines);
    s.max_points = 0;
    s.span = FLOW4D_SPAN_LOOP;
    lines = trace(&field, &s);
    check_line(&lines, 0, -396, 400, 200);
    check_line(&lines, 1, -95, 701, 200);
    flow4d_lines_free(&lines);
    s.direction = FLOW4D_FORWARD;
    lines = trace(&field, &s);
    check_line(&lines, 1, 301, 701, 101);
    flow4d_lines_free(&lines);
    s.direction = FLOW4D_BACKWARD;
    s.duration = 100;
    lines = trace(&field, &s);
    check_line(&lines, 1, 201, 301, 26);
    flow4d_lines_free(&lines);
    s.direction = FLOW4D_BOTH;
    s.span = FLOW4D_SPAN_FREE;
    s.duration = 1600;
    s.max_points = 2000;
    s.step = 8;
    lines = trace(&field, &s);
    check_line(&lines, 0, -1600, 1600, 401);
    flow4d_lines_free(&lines);
}

/* The points of a line, its speeds, its vorticity and its curvature, on circles. */
static void attributes_are_right(void **state) {
    (void)state;
    static const double seeds[2 * 4] = {10, 0, 3, 200, 0, 25, 0, 700};
    flow4d_field field = make_field(rotation_at, 800);
    flow4d_trace_settings s = from_seeds(seeds, 2);
    s.attributes = FLOW4D_VORTICITY | FLOW4D_CURVATURE;
    for (int m = 0; m < 2; m++) {
        s.method = (flow4d_method)m;
        flow4d_lines lines = trace(&field, &s);
        for (uint32_t i = 0; i < 2; i++) {
            double r = i ? 25 : 10, phase = i ? turn / 4 : 0;
            for (size_t k = lines.offsets[i]; k < lines.offsets[i + 1]; k++) {
                double angle = phase + turn * ((double)lines.times[k] - seeds[4 * i + 3]) / 800;
                bool end = k == lines.offsets[i] || k + 1 == lines.offsets[i + 1];
                assert_true(fabs((double)lines.points[3 * k] - r * cos(angle)) < 1e-4);
                assert_true(fabs((double)lines.points[3 * k + 1] - r * sin(angle)) < 1e-4);
                assert_true(fabs((double)lines.speeds[k] - r * turn / 800) < 1e-6);
                assert_true(fabs((double)lines.vorticity[k] - 2000 * turn / 800) < 1e-4);
                assert_true(fabs((double)lines.curvature[k] - (end ? 0 : 1 / r)) < 1e-6);
            }
        }
        flow4d_lines_free(&lines);
        s.max_points = 1; /* no neighbours */
        lines = trace(&field, &s);
        assert_int_equal(lines.point_count, 2);
        assert_true(lines.curvature[0] == 0.0f);
        flow4d_lines_free(&lines);
        s.max_points = 0;
    }
    s.attributes = 0;
    flow4d_lines lines = trace(&field, &s);
    assert_true(!lines.vorticity && !lines.curvature);
    lao_lines_desc desc = flow4d_lines_describe(&lines);
    assert_true(desc.line_count == 2 && desc.point_count == lines.point_count &&
                desc.offsets == lines.offsets && desc.points == lines.points &&
                desc.times == lines.times && !desc.colors);
    flow4d_lines_free(&lines);
    flow4d_lines_free(&lines);
    flow4d_lines_free(NULL);
}

static void steady_lines_and_streamlines(void **state) {
    (void)state;
    static const double seeds[4] = {10, 0, 0, 123};
    flow4d_field field = make_field(rotation_at, 0);
    flow4d_trace_settings s = from_seeds(seeds, 1);
    flow4d_lines lines = trace(&field, &s);
    /* half a voxel at the greatest speed, that of the box's corner voxels */
    double step = 10 / (turn / 800 * 190 * sqrt(2));
    assert_true(fabs(lines.step - step) < 1e-9);
    check_line(&lines, 0, -99 * step, 100 * step, 200);
    flow4d_lines_free(&lines);
    field = make_field(breath_at, 800);
    s.streamlines = 1;
    s.time = 400; /* backward at full speed */
    s.duration = 20;
    s.step = 1;
    lines = trace(&field, &s);
    check_line(&lines, 0, -20, 20, 41);
    assert_true(fabsf(lines.points[0] - 30) < 1e-5f && fabsf(lines.points[120] + 10) < 1e-5f);
    flow4d_lines_free(&lines);
    s.time = 200; /* at rest: a seed alone, unless rest is no reason to stop */
    lines = trace(&field, &s);
    check_line(&lines, 0, 0, 0, 1);
    flow4d_lines_free(&lines);
    s.stop_speed = -1;
    lines = trace(&field, &s);
    check_line(&lines, 0, -20, 20, 41);
    flow4d_lines_free(&lines);
}

static void what_is_unknown_ends_a_line(void **state) {
    (void)state;
    static const double seeds[4 * 4] = {0, 0, 0, 0, 5, 0, 0, 0, 500, 0, 0, 0, 0, 0, 0, (double)NAN};
    flow4d_field field = make_field(none_at, 0);
    flow4d_trace_settings s = from_seeds(seeds, 4);
    s.step = 1;
    s.direction = FLOW4D_FORWARD;
    flow4d_lines lines = trace(&field, &s);
    assert_int_equal(lines.offsets[1], 4);  /* 0, 1, 2, 3 */
    assert_int_equal(lines.point_count, 4); /* no velocity, not inside, no time: no points */
    assert_int_equal(lines.line_count, 4);
    flow4d_lines_free(&lines);
    static float velocity[3 * 64]; /* the same in an array */
    for (size_t i = 0; i < 64; i++) {
        velocity[3 * i] = i % 4 == 3 ? NAN : 1.0f;
        velocity[3 * i + 1] = velocity[3 * i + 2] = 0.0f;
    }
    flow_lattice(&field, 4, 4, 4, 1.0, 0.0);
    field.velocity = velocity;
    field.frame_count = 1;
    s.step = 0.25;
    lines = trace(&field, &s);
    assert_int_equal(lines.offsets[1], 9); /* to x = 2, from where on the last voxel has weight */
    flow4d_lines_free(&lines);
    for (int i = 0; i < 3 * 64; i++)
        velocity[i] = NAN;
    flow_host h;
    flow_host_make(&h, 0);
    memset(&s, 0, sizeof s);
    s.line_count = 5;
    s.step = 1;
    assert_int_equal(flow4d_trace(&h.host, &field, &s, &lines), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(h.last_item, FLOW4D_LOG_EMPTY);
    assert_int_equal(h.live, 0);
}

/* ---- seeds -------------------------------------------------------------------------------- */

static void seeds_are_uniform_inside(void **state) {
    (void)state;
    enum { N = 40000, SIDE = 4 };
    static uint8_t mask[SIDE * SIDE * SIDE];
    flow4d_field field = make_field(constant_at, 800);
    flow_lattice(&field, SIDE, SIDE, SIDE, 2.0, 0.0);
    field.velocity_at = constant_at;
    field.period = 800;
    field.mask = mask;
    int inside = 0;
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++)
        inside += mask[i] = lao_hash(i) % 3 == 0;
    assert_true(inside > 10);
    flow4d_trace_settings s;
    memset(&s, 0, sizeof s);
    s.line_count = N;
    s.max_points = 1;
    flow4d_lines lines = trace(&field, &s);
    static uint32_t per_voxel[SIDE * SIDE * SIDE], per_time[8], per_octant[8];
    memset(per_voxel, 0, sizeof per_voxel);
    assert_int_equal(lines.point_count, N);
    for (uint32_t i = 0; i < N; i++) {
        double g[3], part[3];
        uint32_t voxel = 0, octant = 0;
        for (int a = 2; a >= 0; a--) {
            g[a] = floor((double)lines.points[3 * i + (uint32_t)a] / 2 + 0.5);
            part[a] = (double)lines.points[3 * i + (uint32_t)a] / 2 + 0.5 - g[a];
            voxel = voxel * SIDE + (uint32_t)g[a];
            octant = 2 * octant + (part[a] >= 0.5);
        }
        assert_true(mask[voxel]);
        per_voxel[voxel]++;
        per_octant[octant]++;
        per_time[(uint32_t)(lines.times[i] / 100)]++;
    }
    double sigma = sqrt((double)N / inside);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        if (mask[i])
            assert_true(fabs(per_voxel[i] - (double)N / inside) < 5 * sigma);
    }
    for (int i = 0; i < 8; i++) {
        assert_true(fabs(per_octant[i] - N / 8.0) < 5 * sqrt(N / 8.0));
        assert_true(fabs(per_time[i] - N / 8.0) < 5 * sqrt(N / 8.0));
    }
    s.line_count = 100; /* line i does not depend on how many there are, but on the seed */
    flow4d_lines few = trace(&field, &s);
    assert_memory_equal(few.points, lines.points, 300 * sizeof(float));
    flow4d_lines_free(&few);
    s.seed = 1;
    few = trace(&field, &s);
    assert_memory_not_equal(few.points, lines.points, 300 * sizeof(float));
    flow4d_lines_free(&few);
    s.mask = FLOW4D_MASK_TRILINEAR;
    flow4d_sampler sampler;
    flow4d_sampler_make(NULL, &field, &sampler);
    few = trace(&field, &s);
    for (size_t i = 0; i < few.point_count; i++) {
        double p[3] = {(double)few.points[3 * i], (double)few.points[3 * i + 1],
                       (double)few.points[3 * i + 2]};
        field.mask = NULL;
        assert_true(flow4d_inside(&sampler, p, FLOW4D_MASK_NEAREST));
    }
    assert_true(few.point_count >= 90);
    flow4d_lines_free(&few);
    flow4d_lines_free(&lines);
}

/* Every point of a line is inside, whatever inside means. */
static void lines_stay_inside(void **state) {
    (void)state;
    flow4d_field grid;
    flow4d_sampler sampler;
    flow4d_trace_settings s;
    assert_true(flow_phantom_grid((const double[]){4, 4, 5}, 8, &grid));
    memset(&s, 0, sizeof s);
    s.line_count = 200;
    flow4d_sampler_make(NULL, &grid, &sampler);
    for (int mode = 0; mode < 3; mode++) {
        uint32_t shorter = 0;
        s.mask = (flow4d_mask_mode)mode;
        flow4d_lines lines = trace(&grid, &s);
        for (size_t i = 0; i < lines.point_count; i++) {
            double p[3] = {(double)lines.points[3 * i], (double)lines.points[3 * i + 1],
                           (double)lines.points[3 * i + 2]};
            /* stored as float: a point on the very edge may round over it */
            bool in = flow4d_inside(&sampler, p, s.mask);
            for (int k = 0; k < 6 && !in; k++) {
                double q[3] = {p[0], p[1], p[2]};
                q[k / 2] += k % 2 ? 1e-4 : -1e-4;
                in = flow4d_inside(&sampler, q, s.mask);
            }
            assert_true(in);
        }
        for (uint32_t i = 0; i < lines.line_count; i++)
            shorter += lines.offsets[i + 1] - lines.offsets[i] < 200;
        assert_true(mode == 2 || shorter > 5); /* some lines do leave */
        flow4d_lines_free(&lines);
    }
    flow_phantom_grid_free(&grid);
}

/* ---- failures ----------------------------------------------------------------------------- */

static void check_setting(const flow4d_trace_settings *s, flow4d_log_item item) {
    flow_host h;
    flow4d_lines lines, before;
    flow4d_field field = make_field(constant_at, 800);
    flow_host_make(&h, 0);
    memset(&lines, 0x5a, sizeof lines);
    before = lines;
    assert_int_not_equal(flow4d_trace(&h.host, &field, s, &lines), LAO_OK);
    assert_memory_equal(&lines, &before, sizeof lines);
    assert_int_equal(h.failures, 1);
    assert_int_equal(h.last_item, item);
    assert_int_equal(h.live, 0);
}

static void bad_settings_are_refused(void **state) {
    (void)state;
    static const double seeds[8] = {0};
    flow4d_trace_settings zero, s;
    memset(&zero, 0, sizeof zero);
    s = zero;
    double *numbers[] = {&s.step, &s.duration, &s.tolerance, &s.time};
    for (int i = 0; i < 4; i++) {
        static const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY, 1e31};
        for (int k = 0; k < 4; k++) {
            s = zero;
            *numbers[i] = bad[k];
            check_setting(&s, FLOW4D_LOG_SETTING);
        }
    }
    s = zero;
    s.step = -1;
    check_setting(&s, FLOW4D_LOG_SETTING);
    s = zero;
    s.stop_speed = (double)NAN;
    check_setting(&s, FLOW4D_LOG_SETTING);
    s = zero;
    s.max_points = (1u << 22) + 1;
    check_setting(&s, FLOW4D_LOG_SETTING);
    s = zero;
    s.line_count = 0xffffffffu;
    check_setting(&s, FLOW4D_LOG_SETTING);
    s = zero;
    s.attributes = 4;
    check_setting(&s, FLOW4D_LOG_SETTING);
    s = zero;
    s.method = (flow4d_method)2;
    check_setting(&s, FLOW4D_LOG_SETTING);
    s = zero;
    s.seeds = seeds;
    s.seed_count = 2;
    s.line_count = 3;
    check_setting(&s, FLOW4D_LOG_SETTING);
    flow4d_field field = make_field(constant_at, 800);
    static const uint8_t empty[8000] = {0};
    flow4d_lines lines;
    flow_host h;
    flow_host_make(&h, 0);
    assert_int_not_equal(flow4d_trace(&h.host, &field, NULL, NULL), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_NULL_ARGUMENT);
    assert_int_not_equal(flow4d_trace(&h.host, NULL, NULL, &lines), LAO_OK);
    field.mask = empty;
    assert_int_not_equal(flow4d_trace(&h.host, &field, NULL, &lines), LAO_OK);
    assert_int_equal(h.last_item, FLOW4D_LOG_EMPTY);
    assert_int_equal(h.failures, 3);
    assert_int_equal(h.live, 0);
    s = from_seeds(seeds, 0); /* no seeds: no lines, no failure */
    lines = trace(&field, &s);
    assert_int_equal(lines.line_count, 0);
    flow4d_lines_free(&lines);
    s = from_seeds(seeds, 2); /* seeds in an empty mask: lines without points */
    lines = trace(&field, &s);
    assert_int_equal(lines.line_count, 2);
    assert_int_equal(lines.point_count, 0);
    flow4d_lines_free(&lines);
}

static void no_memory_is_no_crash(void **state) {
    (void)state;
    static uint8_t mask[8000];
    flow4d_field field = make_field(rotation_at, 800);
    flow4d_trace_settings s;
    memset(mask, 1, sizeof mask);
    field.mask = mask;
    memset(&s, 0, sizeof s);
    s.line_count = 6000; /* three batches */
    s.attributes = FLOW4D_VORTICITY | FLOW4D_CURVATURE;
    s.step = 40;
    s.max_points = 250;
    s.span = FLOW4D_SPAN_FREE;
    s.duration = 80;
    bool done = false;
    for (uint32_t n = 1; !done; n++) {
        flow_host h;
        flow4d_lines lines, before;
        flow_host_make(&h, 0);
        h.fail_at = n;
        memset(&lines, 0x5a, sizeof lines);
        before = lines;
        lao_result result = flow4d_trace(&h.host, &field, &s, &lines);
        done = result == LAO_OK;
        if (done) {
            assert_true(n > 10);
            flow4d_lines_free(&lines);
        } else {
            assert_int_equal(result, LAO_ERROR_OUT_OF_MEMORY);
            assert_int_equal(h.failures, 1);
            assert_int_equal(h.last_item, FLOW4D_LOG_MEMORY);
            assert_memory_equal(&lines, &before, sizeof lines);
        }
        assert_int_equal(h.live, 0);
        assert_int_equal(h.wrong_calls, 0);
    }
}

static void the_host_can_cancel(void **state) {
    (void)state;
    flow4d_field field = make_field(rotation_at, 800);
    flow4d_trace_settings s;
    memset(&s, 0, sizeof s);
    s.line_count = 8000;
    bool done = false;
    uint32_t n;
    for (n = 1; !done; n++) {
        flow_host h;
        flow4d_lines lines;
        flow_host_make(&h, 0);
        h.cancel_at = n;
        lao_result result = flow4d_trace(&h.host, &field, &s, &lines);
        done = result == LAO_OK;
        assert_int_equal(h.total, 8000);
        if (done) {
            assert_int_equal(h.done, 8000);
            flow4d_lines_free(&lines);
        } else {
            assert_int_equal(result, LAO_ERROR_NOT_READY);
            assert_int_equal(h.last_item, FLOW4D_LOG_CANCELLED);
            assert_int_equal(h.failures, 1);
        }
        assert_int_equal(h.live, 0);
    }
    assert_true(n > 3);
}

static void memory_stays_within_bounds(void **state) {
    (void)state;
    flow4d_field field;
    flow4d_trace_settings s;
    flow4d_lines lines;
    flow_phantom_field(&field);
    memset(&s, 0, sizeof s);
    for (uint32_t count = 1; count <= 10000; count *= 100) {
        flow_host h;
        flow_host_make(&h, 0);
        s.line_count = count;
        assert_int_equal(flow4d_trace(&h.host, &field, &s, &lines), LAO_OK);
        size_t result = 20 * (size_t)lines.point_count + 4 * ((size_t)count + 1);
        print_message("%u lines: result %zu bytes, peak %zu\n", (unsigned)count, result, h.peak);
        assert_int_equal(h.live, result);
        assert_true(h.peak <= 2 * result + 15000000);
        assert_true(count < 10000 || h.peak <= 3 * result);
        lines.line_count = lines.point_count = count > 1; /* thinned by the host */
        flow4d_lines_free(&lines);
        assert_int_equal(h.live, 0);
        assert_int_equal(h.wrong_calls, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_velocity_is_exact),
        cmocka_unit_test(a_turn_keeps_its_radius),
        cmocka_unit_test(a_breath_returns),
        cmocka_unit_test(backward_undoes_forward),
        cmocka_unit_test(runge_kutta_has_order_four),
        cmocka_unit_test(dormand_prince_keeps_its_tolerance),
        cmocka_unit_test(steps_that_leave_move_nothing),
        cmocka_unit_test(spans_hold),
        cmocka_unit_test(attributes_are_right),
        cmocka_unit_test(steady_lines_and_streamlines),
        cmocka_unit_test(what_is_unknown_ends_a_line),
        cmocka_unit_test(seeds_are_uniform_inside),
        cmocka_unit_test(lines_stay_inside),
        cmocka_unit_test(bad_settings_are_refused),
        cmocka_unit_test(no_memory_is_no_crash),
        cmocka_unit_test(the_host_can_cancel),
        cmocka_unit_test(memory_stays_within_bounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
