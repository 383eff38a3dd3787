/* Proves that trails are those of METHODS 2.7 and 9.1: their width, opacity and brightness at every
 * pixel follow from its time, their tips glide, a period has no seam, and without a trail times
 * change nothing. */
#include "render_host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 160 };

/* A line along x with t = x + 80 ms, so that time runs with the pixels; grey. */
static render_lines ruler(double step, double offset) {
    render_lines lines = {0};
    for (int i = 0; - 80 + step * i <= 80; i++) {
        render_point(&lines, -80 + step * i, 0, 0);
        lines.times[i] = (float)(step * i + offset);
        memset(lines.colors + 4 * (size_t)i, 200, 4);
    }
    render_line(&lines);
    return lines;
}

static lao_settings plain(int trail) {
    lao_settings s;
    memset(&s, 0, sizeof s);
    s.width = 64;
    s.supersampling = 1;
    s.trail = (float)trail;
    s.set = LAO_SET(occlusion) | LAO_SET(halo) | LAO_SET(cull_hidden); /* one image list for all */
    return s;
}

static render_result drawn(render_device *device, const render_lines *lines,
                           const lao_settings *settings, double time) {
    render_shot shot;
    render_result result;
    memset(&shot, 0, sizeof shot);
    shot.width = shot.height = SIZE;
    shot.camera = render_camera(0, 0, 1, 200);
    render_orthographic(&shot.camera, SIZE, 1, 1, 400);
    shot.lines[0] = lines;
    shot.settings[0] = settings;
    shot.set_count = 1;
    shot.time = (float)time;
    render_draw(device, &shot, &result);
    return result;
}

static int covered(const render_result *result, int x, int y) {
    return render_find(result, "color", 0)->data[4 * (y * SIZE + x) + 3] != 0;
}

static double width_at(double q, double start, double least) {
    return q > 1 ? 0 : q <= start ? 1 : 1 - (1 - least) * (q - start) / (1 - start);
}

/* The pixels of each column, against the formula at its middle. */
static void taper(render_device *device, double step, double time, double start, double least) {
    render_lines lines = ruler(step, 0);
    lao_settings settings = plain(LAO_TRAIL_TAPER);
    render_result result;
    settings.taper_start = (float)start;
    settings.taper_width = (float)least;
    settings.set |= LAO_SET(taper_start);
    result = drawn(device, &lines, &settings, time);
    for (int x = 0; x < SIZE; x++) {
        double q = fabs(x + 0.5 - time) / 25, want = 64 * width_at(q, start, least);
        int count = 0;
        for (int y = 0; y < SIZE; y++)
            count += covered(&result, x, y);
        /* the kink may lie inside a segment */
        if (fabs(q - 1) > 0.01 && fabs(count - want) > 1.2 + 64 / 25.0 * 0.5 * step)
            fail_msg("%s: time %g, x %d: %d pixels, not %g", device->name, time, x, count, want);
    }
    render_free(&result);
    render_lines_free(&lines);
}

static void test_taper(void **state) {
    (void)state;
    for (int d = 0; d < 2; d++) {
        render_need(&render_devices[d]);
        taper(&render_devices[d], 0.5, 80, 1.0 / 3, 0.25);
        taper(&render_devices[d], 0.5, 61.7, 0.25, 0.25);
        taper(&render_devices[d], 0.5, 10.3, 0, 0.5);
        taper(&render_devices[d], 0.5, 158, 0.9, 1);
    }
}

/* Segments much longer than a frame: the trail still begins and ends where the time says. */
static void test_tips(void **state) {
    (void)state;
    for (int i = 0; i < 40; i++) {
        render_device *device = &render_devices[i & 1];
        render_lines lines = ruler(16, 0);
        lao_settings settings = plain(LAO_TRAIL_TAPER);
        double time = 50 + 1.3 * i, first = 1e9, last = -1e9;
        render_result result;
        render_need(device);
        result = drawn(device, &lines, &settings, time);
        for (int x = 0; x < SIZE; x++) {
            if (covered(&result, x, SIZE / 2)) {
                first = fmin(first, x);
                last = fmax(last, x + 1);
            }
        }
        assert_true(fabs(first - (time - 25)) < 0.51);
        assert_true(fabs(last - fmin(time + 25, SIZE)) < 0.51);
        render_free(&result);
        render_lines_free(&lines);
    }
}

static void test_opacity(void **state) {
    (void)state;
    for (int i = 0; i < 6; i++) {
        render_device *device = &render_devices[i & 1];
        render_lines lines = ruler(1, 0);
        lao_settings settings = plain(LAO_TRAIL_OPACITY);
        render_result result;
        render_need(device);
        settings.halo = (float)(i / 2);
        settings.taper_start = 0.2f;
        settings.trail_length = 75;
        result = drawn(device, &lines, &settings, 80);
        for (int x = 0; x < SIZE; x += 4) { /* over the pattern */
            double want = 0;
            int count = 0;
            for (int k = 0; k < 4 * 40; k++)
                count += covered(&result, x + k % 4, 60 + k / 4);
            for (int k = 0; k < 4; k++) {
                double q = fabs(x + k + 0.5 - 80) / 75;
                want += 0.25 * (q > 1 ? 0 : q <= 0.2 ? 1 : 1 - (q - 0.2) / 0.8);
            }
            if (fabs(count / 160.0 - want) >=
                0.06) /* 1/32, and 1/40 as it changes within the pattern */
                fail_msg("halo %d, x %d: %g, not %g", i / 2, x, count / 160.0, want);
        }
        render_free(&result);
        render_lines_free(&lines);
    }
}

static void test_highlight(void **state) {
    (void)state;
    for (int i = 0; i < 6; i++) {
        render_device *device = &render_devices[i & 1];
        render_lines lines = ruler(1, 0);
        lao_settings settings = plain(LAO_TRAIL_HIGHLIGHT);
        render_result result;
        const render_image *color;
        double time = 30 + 20 * i, beta = i < 2 ? 1600 : 400;
        render_need(device);
        settings.highlight_beta = (float)beta;
        result = drawn(device, &lines, &settings, time);
        color = render_find(&result, "color", 0);
        for (int x = 0; x < SIZE; x++) {
            double f = 0; /* per point, linear between them */
            for (int k = 0; k < 2; k++)
                f += 0.5 * fmax(exp(-pow(x + k - time, 2) / beta), 0.25);
            assert_true(covered(&result, x, SIZE / 2)); /* all of every line */
            if (fabs(color->data[4 * (SIZE / 2 * SIZE + x)] - 200 * f) >= 0.7)
                fail_msg("time %g, x %d: %d, not %g", time, x,
                         color->data[4 * (SIZE / 2 * SIZE + x)], 200 * f);
        }
        render_free(&result);
        render_lines_free(&lines);
    }
}

static void same(const char *what, const render_result *a, const render_result *b) {
    assert_int_equal(a->count, b->count);
    render_same_images(what, a, b);
}

/* Lines that run over the period's end, as of a looping heart beat. */
static void test_period(void **state) {
    (void)state;
    for (int i = 0; i < 12; i++) {
        render_device *device = &render_devices[i & 1];
        render_lines lines = ruler(1, 700.5); /* 700.5 .. 860.5, period 800 */
        lao_settings settings = plain(LAO_TRAIL_TAPER + i / 2 % 3);
        double time = (i < 6 ? 0 : 799.25);
        render_result a, b;
        render_need(device);
        settings.period = 800;
        a = drawn(device, &lines, &settings, time);
        b = drawn(device, &lines, &settings, time + 800);
        same("one period later", &a, &b);
        render_free(&b);
        b = drawn(device, &lines, &settings, time - 800);
        same("one period earlier", &a, &b);
        render_free(&b);
        if (settings.trail == (float)LAO_TRAIL_TAPER) { /* t = 800 is x = 99.5 */
            double middle = 99.5 + (i < 6 ? 0 : -0.75), first = 1e9, last = -1e9;
            for (int x = 0; x < SIZE; x++) {
                if (covered(&a, x, SIZE / 2)) {
                    first = fmin(first, x);
                    last = fmax(last, x + 1);
                }
            }
            assert_true(fabs(first - (middle - 25)) < 0.6 && fabs(last - (middle + 25)) < 0.6);
        }
        render_free(&a);
        render_lines_free(&lines);
    }
}

static void test_none(void **state) {
    (void)state;
    for (int d = 0; d < 2; d++) {
        render_lines lines = ruler(1, 0);
        lao_settings settings = plain(LAO_TRAIL_NONE);
        render_result a, b;
        render_need(&render_devices[d]);
        a = drawn(&render_devices[d], &lines, &settings, 0);
        for (uint32_t i = 0; i < lines.point_count; i++)
            lines.times[i] = i % 3 ? (float)i : NAN;
        b = drawn(&render_devices[d], &lines, &settings, 50);
        same("times without a trail", &a, &b);
        render_free(&b);
        /* a point without a time is never shown, and harms nobody */
        settings = plain(LAO_TRAIL_TAPER);
        b = drawn(&render_devices[d], &lines, &settings, 50);
        for (int x = 0; x < SIZE; x++)
            assert_true(abs(x - 50) < 27 || !covered(&b, x, SIZE / 2));
        render_free(&a);
        render_free(&b);
        render_lines_free(&lines);
    }
}

/* Lines at all angles whose times go through two periods, forwards and backwards. */
static render_lines timed(void) {
    render_lines lines = {0};
    uint32_t seed = 5;
    for (int i = 0; i < 300; i++) {
        double a = 0.7 * i, x = 70 * cos(2.4 * i), y = 70 * sin(2.4 * i), z = i % 37 - 18;
        double start = (double)(lao_hash(seed++) % 800);
        for (int k = 0; k < 30; k++) {
            double s = 0.09 * k;
            render_point(&lines, x + 3 * k * cos(a + s), y + 3 * k * sin(a + s), z + 0.3 * k);
            lines.times[lines.point_count - 1] = (float)(start + (i & 1 ? 25 : -25) * k);
        }
        render_line(&lines);
    }
    for (uint32_t i = 0; i < lines.point_count; i++)
        lines.colors[4 * i] = (uint8_t)i;
    return lines;
}

/* What is left out of a frame would not have been seen; and a window over everything shows what no
   window shows. */
static void test_order(void **state) {
    (void)state;
    for (int i = 0; i < 24; i++) {
        render_device *device = &render_devices[i & 1];
        render_lines lines = timed();
        lao_settings settings = plain(i % 3 ? LAO_TRAIL_TAPER : LAO_TRAIL_OPACITY);
        double time = 67.3 * i;
        render_result a, b;
        render_need(device);
        settings.width = 3;
        settings.halo = (float)(i / 2 % 3);
        settings.period = i % 4 < 2 ? 800 : 0;
        a = drawn(device, &lines, &settings, time);
        render_endless(1);
        b = drawn(device, &lines, &settings, time);
        render_endless(0);
        same("groups left out", &a, &b);
        render_free(&a);
        render_free(&b);
        settings.trail_length = 1e6f;
        a = drawn(device, &lines, &settings, time);
        settings.trail = LAO_TRAIL_NONE;
        b = drawn(device, &lines, &settings, time);
        if (i % 3)
            same("everything in order of time", &a, &b);
        render_free(&a);
        render_free(&b);
        render_lines_free(&lines);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_taper),   cmocka_unit_test(test_tips),
        cmocka_unit_test(test_opacity), cmocka_unit_test(test_highlight),
        cmocka_unit_test(test_period),  cmocka_unit_test(test_none),
        cmocka_unit_test(test_order),
    };
    return cmocka_run_group_tests(tests, render_open_both, render_close_both);
}
