/* Proves that the ribbons of a line are one ribbon: at corners, hairpins and the seam of a closed
 * line every pixel within half a width of the line is covered and none beyond what a joint may
 * take, open ends are cut square, and nothing breaks at the eye, end-on or with two million
 * points. The reference is the union of the pieces as the eye sees them, in double precision. */
#include "render_host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static render_device *const gl = &render_devices[RENDER_GL];

/* One unit of a test is a pixel: orthographic, 1 mm per pixel, seen along -z. */
enum { SIZE = 160 };
static const double slack = 0.02; /* px: the rasteriser's grid is 1/256 */

typedef struct vertex {
    double x, y;
} vertex;

typedef struct polyline {
    vertex p[1024];
    int count, closed;
} polyline;

/* A line as the renderer understands it: repeated points merged, closed when it ends where it
 * began. */
static polyline flattened(const render_lines *lines, uint32_t line) {
    polyline out;
    const float *first = lines->points + 3 * (size_t)lines->offsets[line], *last = NULL;
    out.count = 0;
    for (uint32_t i = lines->offsets[line]; i < lines->offsets[line + 1]; i++) {
        const float *p = lines->points + 3 * (size_t)i;
        if (last && memcmp(p, last, 3 * sizeof *p) == 0)
            continue;
        last = p;
        assert_true(out.count < 1024);
        out.p[out.count].x = (double)p[0] + 0.5 * SIZE;
        out.p[out.count++].y = (double)p[1] + 0.5 * SIZE;
    }
    out.closed = out.count > 3 && memcmp(first, last, 3 * sizeof *first) == 0;
    return out;
}

/* 1: must be covered, 0: must not, -1: may be. A pixel must be covered when it lies beside a piece,
 * or around a joint but not beyond an open end. Joints share mitred corners or end square, which
 * reaches sqrt(2) half widths from the joint. */
static int expected(const polyline *line, double x, double y, double half) {
    int allowed = 0, around = 0, beyond = 0;
    double nearest = 1e30;
    for (int i = 0; i < line->count; i++) {
        double dx = x - line->p[i].x, dy = y - line->p[i].y, r = sqrt(dx * dx + dy * dy);
        double ex, ey, length, along, across;
        int open = !line->closed && (i == 0 || i + 1 == line->count);
        around |= !open && r < half - slack;
        allowed |= !open && r < sqrt(2.0) * half + slack;
        if (r < nearest)
            beyond = open;
        nearest = fmin(nearest, r);
        if (i + 1 == line->count)
            break;
        ex = line->p[i + 1].x - line->p[i].x;
        ey = line->p[i + 1].y - line->p[i].y;
        length = sqrt(ex * ex + ey * ey);
        if (length == 0)
            continue;
        along = (dx * ex + dy * ey) / length;
        across = fabs(dx * ey - dy * ex) / length;
        if (along > slack && along < length - slack && across < half - slack)
            return 1;
        if (along > 0 && along < length && across < nearest) {
            nearest = across;
            beyond = 0;
        }
        allowed |= along > -slack && along < length + slack && across < half + slack;
    }
    return around && !beyond ? 1 : allowed || around ? -1 : 0;
}

static render_result draw_flat(const render_lines *lines, double width) {
    render_shot shot;
    lao_settings settings;
    render_result result;
    memset(&shot, 0, sizeof shot);
    memset(&settings, 0, sizeof settings);
    settings.width = (float)width;
    settings.supersampling = 1;
    settings.set = LAO_SET(occlusion);
    shot.width = shot.height = SIZE;
    shot.camera = render_camera(0, 0, 1, 200);
    render_orthographic(&shot.camera, SIZE, 1, 1, 400);
    shot.lines[0] = lines;
    shot.settings[0] = &settings;
    shot.set_count = 1;
    render_draw(gl, &shot, &result);
    return result;
}

typedef struct coverage {
    int missing, extra;
    double x, y; /* of the first wrong pixel, in the test's units */
} coverage;

static coverage covered(const render_lines *lines, double width) {
    render_result result = draw_flat(lines, width);
    const render_image *color = render_find(&result, "color", 0);
    polyline *flat = malloc(lines->line_count * sizeof *flat);
    coverage c = {0, 0, 0, 0};
    assert_non_null(flat);
    for (uint32_t line = 0; line < lines->line_count; line++)
        flat[line] = flattened(lines, line);
    for (int y = 0; y < SIZE; y++) {
        for (int x = 0; x < SIZE; x++) {
            int want = 0, is = color->data[4 * (y * SIZE + x) + 3] != 0;
            for (uint32_t line = 0; line < lines->line_count && want != 1; line++) {
                int one = expected(&flat[line], x + 0.5, y + 0.5, 0.5 * width);
                want = one != 0 ? one : want;
            }
            if ((want == 1 && !is) || (want == 0 && is)) {
                if (c.missing + c.extra == 0) {
                    c.x = x + 0.5 - 0.5 * SIZE;
                    c.y = y + 0.5 - 0.5 * SIZE;
                }
                c.missing += want == 1;
                c.extra += want == 0;
            }
        }
    }
    free(flat);
    render_free(&result);
    return c;
}

static void check(const char *what, double parameter, render_lines *lines, double width) {
    coverage c = covered(lines, width);
    if (c.missing + c.extra > 0)
        print_message("%s %g: %d pixels missing, %d too many, first at (%g, %g)\n", what, parameter,
                      c.missing, c.extra, c.x, c.y);
    render_lines_free(lines);
    assert_int_equal(c.missing + c.extra, 0);
}

static void arc(render_lines *lines, double radius, int points, double turns) {
    for (int i = 0; i < points; i++) {
        double angle = 6.283185307179586 * turns * i / (points - 1);
        if (turns == 1 && i == points - 1)
            angle = 0;
        render_point(lines, radius * cos(angle), radius * sin(angle), 0);
    }
    render_line(lines);
}

/* ---------------------------------------------------------------------------------------- tests */

static void test_segment(void **state) {
    (void)state;
    render_need(gl);
    for (int i = 0; i < 12; i++) {
        render_lines lines = {0};
        double angle = 0.13 + 0.5236 * i;
        render_point(&lines, -55.3 * cos(angle), -55.3 * sin(angle), 3);
        render_point(&lines, 47.9 * cos(angle), 47.9 * sin(angle), -5);
        render_line(&lines);
        check("segment at angle", angle, &lines, i % 2 ? 13.7 : 1.9);
    }
}

static void test_zigzag(void **state) {
    static const double turns[] = {3, 20, 45, 59, 61, 85, 89.9, 90.1, 100, 120, 150, 165, 175, 179};
    (void)state;
    render_need(gl);
    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++) {
        render_lines lines = {0};
        double half = turns[i] * 3.14159265358979 / 360, x = -60, y = -20;
        for (int k = 0; x < 60 && fabs(y) < 70 && k < 12; k++) {
            render_point(&lines, x, y, 0);
            x += 45 * cos(half);
            y += 45 * sin(half) * (k % 2 ? -1 : 1);
        }
        render_line(&lines);
        check("zig-zag turning by", turns[i], &lines, 12.5);
    }
}

static void test_hairpin(void **state) {
    (void)state;
    render_need(gl);
    for (int i = 0; i < 5; i++) {
        render_lines lines = {0};
        double angle = 0.3 * i;
        for (int k = 0; k < 4; k++) {
            double at = k % 2 ? 50 : -40;
            render_point(&lines, at * cos(angle), at * sin(angle), 0);
        }
        render_line(&lines);
        check("hairpin at angle", angle, &lines, 11);
    }
}

static void test_closed(void **state) {
    static const int corners[] = {3, 4, 5, 7, 12, 64};
    (void)state;
    render_need(gl);
    for (size_t i = 0; i < sizeof corners / sizeof *corners; i++) {
        render_lines lines = {0};
        arc(&lines, 55, corners[i] + 1, 1);
        check("closed line, corners", corners[i], &lines, 9.3);
    }
}

/* Where a closed line begins cannot be seen. */
static void test_no_seam(void **state) {
    render_result results[2];
    (void)state;
    render_need(gl);
    for (int start = 0; start < 2; start++) {
        render_lines lines = {0};
        for (int i = 0; i <= 24; i++) {
            double angle = 6.283185307179586 * ((i + 7 * start) % 24) / 24;
            render_point(&lines, 55 * cos(angle), 40 * sin(angle), 20 * cos(2 * angle));
        }
        render_line(&lines);
        for (uint32_t i = 0; i < lines.point_count; i++)
            memset(lines.colors + 4 * (size_t)i, 200, 4);
        results[start] = draw_flat(&lines, 9.3);
        render_lines_free(&lines);
    }
    for (uint32_t i = 0; i < results[0].count; i++) {
        const render_image *image = &results[0].images[i];
        render_difference d =
            render_compare("seam", image, render_find(&results[1], image->name, image->level));
        assert_int_equal(d.texels, 0);
    }
    render_free(&results[0]);
    render_free(&results[1]);
}

/* Curves of short pieces, wider than a piece is long but not than the curve. */
static void test_curves(void **state) {
    (void)state;
    render_need(gl);
    for (int i = 0; i < 6; i++) {
        render_lines lines = {0};
        double radius = 8 + 9 * i;
        arc(&lines, radius, 80, i % 2 ? 0.8 : 1.0);
        check("arc of radius", radius, &lines, 12);
    }
}

/* Curves narrower than their line: nothing lies beyond the joints, and the line itself and most of
 * its width are covered. */
static void test_tight_curves(void **state) {
    (void)state;
    render_need(gl);
    for (int i = 0; i < 6; i++) {
        render_lines lines = {0};
        double radius = 1 + i;
        arc(&lines, radius, i % 2 ? 12 : 40, i % 2 ? 0.6 : 1);
        check("tight arc of radius", radius, &lines, 14);
    }
}

static void test_random_walks(void **state) {
    (void)state;
    render_need(gl);
    for (uint32_t seed = 0; seed < 12; seed++) {
        render_lines lines = {0};
        double x = 0, y = 0, angle = 0;
        for (uint32_t i = 0; i < 30; i++) {
            double turn = (double)lao_unit_float(lao_hash(100 * seed + 2 * i)) - 0.5;
            double step = 9 + 9 * (double)lao_unit_float(lao_hash(100 * seed + 2 * i + 1));
            render_point(&lines, x, y, seed < 6 ? 0 : 60 * sin(9.0 * i));
            angle += 6 * turn;
            step *= seed >= 6 && i % 3 == 1 ? 0.1 : 1; /* seen nearly end-on */
            if (fabs(x + step * cos(angle)) > 70 || fabs(y + step * sin(angle)) > 70)
                angle += 3.1;
            x += step * cos(angle);
            y += step * sin(angle);
        }
        render_line(&lines);
        if (seed < 6) {
            check("random walk", seed, &lines, 8);
        } else { /* sharp turns at both ends of a piece shorter than its width may cost a pixel */
            coverage c = covered(&lines, 8);
            render_lines_free(&lines);
            assert_true(c.missing <= 4);
            assert_int_equal(c.extra, 0);
        }
    }
}

/* A piece that runs along the view is a point on the screen; the line goes on behind it. */
static void test_end_on(void **state) {
    (void)state;
    render_need(gl);
    for (int i = 0; i < 18; i++) {
        render_lines lines = {0};
        double in = 0.35 * (i % 3), out = in + 6.283185307179586 * i / 18;
        render_point(&lines, -50 * cos(in), -50 * sin(in), 0);
        render_point(&lines, 0, 0, 0);
        render_point(&lines, 0, 0, -30);
        render_point(&lines, 50 * cos(out), 50 * sin(out), -30);
        render_line(&lines);
        check("end-on piece in a turn of", 20 * i, &lines, 12);
    }
}

static void test_only_end_on(void **state) {
    render_lines lines = {0};
    render_result result;
    const render_image *color;
    (void)state;
    render_need(gl);
    render_point(&lines, 0.5, 0.5, 10);
    render_point(&lines, 0.5, 0.5, -10);
    render_line(&lines);
    result = draw_flat(&lines, 12);
    color = render_find(&result, "color", 0);
    for (int i = 0; i < SIZE * SIZE; i++) /* at most its own width */
        assert_true(color->data[4 * i + 3] == 0 ||
                    (abs(i % SIZE - SIZE / 2) <= 7 && abs(i / SIZE - SIZE / 2) <= 7));
    render_free(&result);
    render_lines_free(&lines);
}

/* ---- at the eye ------------------------------------------------------------------------- */

static void finite(const render_result *result, const char *name, double lowest, double highest) {
    const render_image *image = render_find(result, name, 0);
    float *values = render_floats(image, 0);
    for (uint32_t i = 0; i < image->width * image->height; i++) {
        if (!((double)values[i] >= lowest && (double)values[i] <= highest))
            fail_msg("%s (%u, %u) = %g", name, i % image->width, i / image->width,
                     (double)values[i]);
    }
    free(values);
}

/* A line 1 mm below the eye runs from 10 mm in front of it past it; the picture of the ribbon is a
 * triangle that grows towards the viewer and ends at the near plane. */
static void past_the_eye(double near, const double *z, int count) {
    render_lines lines = {0};
    render_shot shot;
    lao_settings settings;
    render_result result;
    const render_image *color;
    int wrong = 0;
    memset(&shot, 0, sizeof shot);
    memset(&settings, 0, sizeof settings);
    for (int i = 0; i < count; i++)
        render_point(&lines, 0, -1, z[i]);
    render_line(&lines);
    settings.width = 0.6f;
    settings.supersampling = 1;
    settings.levels = 2;
    settings.samples = 5;
    shot.width = shot.height = SIZE;
    shot.camera = render_camera(0, 0, 1, 0);
    render_perspective(&shot.camera, 90, 1, near, 50);
    shot.lines[0] = &lines;
    shot.settings[0] = &settings;
    shot.set_count = 1;
    render_draw(gl, &shot, &result);
    color = render_find(&result, "color", 0);
    for (int y = 0; y < SIZE; y++) {
        for (int x = 0; x < SIZE; x++) {
            double down = 0.5 * SIZE - (y + 0.5), side = fabs(x + 0.5 - 0.5 * SIZE);
            double depth = 0.5 * SIZE / down; /* of the line in that row */
            int is = color->data[4 * (y * SIZE + x) + 3] != 0;
            int want = down > 0 && depth < 10 && depth > near && side < 0.3 * down;
            double edge = fmin(fabs(side - 0.3 * down),
                               fmin(fabs(down - 0.05 * SIZE), fabs(down - 0.5 * SIZE / near)));
            wrong += is != want && edge > 2 * slack;
        }
    }
    finite(&result, "ao", 0, 1);
    finite(&result, "depth", 0, 1);
    render_free(&result);
    render_lines_free(&lines);
    assert_int_equal(wrong, 0);
}

static void test_near_plane(void **state) {
    static const double behind[] = {-10, 5}, at_the_eye[] = {-10, 0}, steps[] = {-10, -1, 0, 1},
                        close[] = {-10, -1e-3, 3};
    (void)state;
    render_need(gl);
    past_the_eye(0.5, behind, 2);
    past_the_eye(1.6, behind, 2);
    past_the_eye(0.5, at_the_eye, 2);
    past_the_eye(0.5, steps, 4);
    past_the_eye(0.5, close, 3);
}

static void test_two_million_points(void **state) {
    enum { LINES = 2000, POINTS = 1000 };
    render_lines lines = {0};
    render_result result;
    uint32_t count = 0;
    const render_image *color;
    (void)state;
    render_need(gl);
    for (uint32_t i = 0; i < LINES; i++) {
        for (uint32_t k = 0; k < POINTS; k++) {
            double t = 6.283185307179586 * k / POINTS, r = 70.0 * i / LINES;
            render_point(&lines, r * cos(t), r * sin(3 * t), r * sin(2 * t));
        }
        render_line(&lines);
    }
    result = draw_flat(&lines, 0.5);
    print_message("2 million points: %.0f ms\n", gl->milliseconds);
    assert_true(gl->milliseconds < 60000);
    color = render_find(&result, "color", 0);
    for (int i = 0; i < SIZE * SIZE; i++)
        count += color->data[4 * i + 3] != 0;
    assert_true(count > SIZE * SIZE / 4);
    render_free(&result);
    render_lines_free(&lines);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_segment),      cmocka_unit_test(test_zigzag),
        cmocka_unit_test(test_hairpin),      cmocka_unit_test(test_closed),
        cmocka_unit_test(test_no_seam),      cmocka_unit_test(test_curves),
        cmocka_unit_test(test_tight_curves), cmocka_unit_test(test_random_walks),
        cmocka_unit_test(test_end_on),       cmocka_unit_test(test_only_end_on),
        cmocka_unit_test(test_near_plane),   cmocka_unit_test(test_two_million_points),
    };
    return cmocka_run_group_tests(tests, render_open_opengl, render_close_both);
}
