/* Proves that leaving out hidden segments does not change the picture: every image has the same
 * bits with `cull_hidden` as without, for all halos and projections, with two sets, with a host's
 * depth, at every distance; and that it happens, and only where many lines are. */
#include "render_host.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SIZE = 160 };

/* One number in [0, 1) after the other. */
static double next(uint32_t *seed) {
    *seed = lao_hash(*seed + 1u);
    return *seed / 4294967296.0;
}

/* Curved lines of segments of `length` mm everywhere in a ball of radius 30 mm, in which many lie
   behind each other. */
static render_lines tangle_of(uint32_t count, uint32_t seed, double length) {
    render_lines lines = {0};
    for (uint32_t i = 0; i < count; i++) {
        double a = 6.3 * next(&seed), z = 2 * next(&seed) - 1, r = 30 * cbrt(next(&seed));
        double x = r * sqrt(1 - z * z) * cos(a), y = r * sqrt(1 - z * z) * sin(a);
        double turn = 0.4 * next(&seed) - 0.2, rise = 2 * next(&seed) - 1;
        for (int k = 0; k < 40; k++) {
            double s = a + turn * k;
            render_point(&lines, x, y, r * z + rise * k);
            x += length * cos(s);
            y += length * sin(s);
        }
        render_line(&lines);
    }
    for (uint32_t i = 0; i < lines.point_count; i++)
        lines.colors[4 * i] = (uint8_t)i;
    return lines;
}

static render_lines tangle(uint32_t count, uint32_t seed) {
    return tangle_of(count, seed, 1.5);
}

static int has_row(const render_result *result, const char *image) {
    for (uint32_t i = 0; i < result->count; i++) {
        if (strcmp(result->images[i].name, image) == 0)
            return 1;
    }
    return 0;
}

/* Images of the frame without parts that differ in that with parts. */
static void same(int which, const render_result *whole, const render_result *parts) {
    char what[32];
    snprintf(what, sizeof what, "case %d", which);
    render_same_images(what, whole, parts);
    if (whole->depth_after.data)
        assert_int_equal(render_compare(what, &whole->depth_after, &parts->depth_after).texels, 0);
}

static lao_settings settings_of(int which) {
    lao_settings s;
    memset(&s, 0, sizeof s);
    s.width = which % 5 ? 1.0f : 2.5f;
    s.supersampling = (float)(1 + which / 3 % 2);
    s.halo = (float)(which % 3);
    s.halo_border = (float)(which / 4 % 2);
    s.trail = which % 7 == 6 ? (float)LAO_TRAIL_HIGHLIGHT : 0.0f;
    s.levels = 1;
    s.set = LAO_SET(halo) | LAO_SET(cull_hidden);
    s.cull_hidden = 1;
    return s;
}

static void camera_of(int which, lao_camera *camera) {
    static const double distances[4] = {160, 70, 400, 20}; /* the last is inside */
    double a = 0.9 * which;
    *camera = render_camera(cos(a), sin(a), 0.4, distances[which % 4]);
    if (which / 2 % 3 == 2)
        render_orthographic(camera, which % 4 == 3 ? 30 : 110, 1, 1, 600);
    else
        render_perspective(camera, 40, 1, which % 4 == 3 ? 0.5 : 5, 1000);
    if (which / 2 % 2)
        render_reverse(camera);
}

static void test_same_picture(void **state) {
    (void)state;
    render_lines lines = tangle(2000, 1), second = tangle(1000, 2), longer = tangle_of(2000, 5, 9);
    uint32_t parted = 0;
    for (int i = 0; i < 36; i++) {
        render_device *device = &render_devices[i & 1];
        lao_settings on = settings_of(i / 2), off = on;
        render_result whole, parts;
        render_shot shot;
        render_need(device);
        memset(&shot, 0, sizeof shot);
        shot.width = shot.height = SIZE;
        camera_of(i / 2, &shot.camera);
        shot.lines[0] = i / 2 % 3 == 1 ? &longer : &lines; /* tested piece by piece */
        shot.lines[1] = &second;
        shot.set_count = i / 2 % 4 == 1 ? 2 : 1;
        shot.frame_flags = i / 2 % 8 == 5 ? LAO_FRAME_SHARED_OCCLUSION : 0u;
        shot.host_depth = i / 2 % 5 == 4;
        shot.depth_value = i / 2 / 2 % 2 ? 0.0f : 1.0f; /* reversed */
        shot.depth_lines = shot.host_depth ? &second : NULL;
        shot.settings[0] = shot.settings[1] = &on;
        shot.time = 60;
        render_draw(device, &shot, &parts);
        parted += (uint32_t)has_row(&parts, "far");
        off.cull_hidden = 0;
        shot.settings[0] = shot.settings[1] = &off;
        render_draw(device, &shot, &whole);
        assert_false(has_row(&whole, "far"));
        same(i / 2, &whole, &parts);
        render_free(&whole);
        render_free(&parts);
    }
    assert_int_equal(parted, 36);
    render_lines_free(&lines);
    render_lines_free(&second);
    render_lines_free(&longer);
}

/* Where the farthest depth around is behind everything, nothing may be left out: the image tells
   how far the first part got. */
static void test_farthest_depth(void **state) {
    (void)state;
    for (int d = 0; d < 2; d++) {
        render_lines lines = tangle(2000, 3);
        lao_settings settings = settings_of(0);
        render_result result;
        render_shot shot;
        render_need(&render_devices[d]);
        memset(&shot, 0, sizeof shot);
        shot.width = shot.height = SIZE;
        camera_of(1, &shot.camera);
        shot.lines[0] = &lines;
        shot.settings[0] = &settings;
        shot.set_count = 1;
        render_draw(&render_devices[d], &shot, &result);
        const render_image *z = render_find(&result, "zbuffer", 0);
        const render_image *far = render_find(&result, "far", 2);
        const float *last = (const void *)z->data, *first = (const void *)far->data;
        uint32_t closed = 0;
        assert_int_equal(far->width, SIZE / 4);
        for (uint32_t y = 0; y < SIZE; y++) {
            for (uint32_t x = 0; x < SIZE; x++) /* the rest only brings depth nearer */
                assert_true(last[y * SIZE + x] <= first[y / 4 * far->width + x / 4]);
        }
        for (uint32_t i = 0; i < far->width * far->height; i++)
            closed += first[i] < 1;
        assert_true(closed > 10); /* tiles behind which segments are left out */
        render_free(&result);
        render_lines_free(&lines);
    }
}

/* Few lines, lines far apart and trails are drawn at once. */
static void test_few_lines(void **state) {
    (void)state;
    for (int i = 0; i < 6; i++) {
        render_lines lines = tangle(i < 2 ? 40 : i < 4 ? 150 : 2000, 4);
        lao_settings settings = settings_of(1);
        render_result result;
        render_shot shot;
        render_need(&render_devices[i & 1]);
        settings.trail = i < 4 ? 0.0f : (float)(i < 5 ? LAO_TRAIL_TAPER : LAO_TRAIL_OPACITY);
        memset(&shot, 0, sizeof shot);
        shot.width = shot.height = i < 2 ? 16 : SIZE;
        camera_of(0, &shot.camera);
        shot.lines[0] = &lines;
        shot.settings[0] = &settings;
        shot.set_count = 1;
        render_draw(&render_devices[i & 1], &shot, &result);
        assert_false(has_row(&result, "far"));
        render_free(&result);
        render_lines_free(&lines);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_picture),
        cmocka_unit_test(test_farthest_depth),
        cmocka_unit_test(test_few_lines),
    };
    return cmocka_run_group_tests(tests, render_open_both, render_close_both);
}
