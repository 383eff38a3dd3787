/* Proves that halos are those of METHODS 3: borders are black as far in as b says, depth halos lie
 * D f(s) behind their line in view depth under every projection and hide what is farther than that
 * and nothing else, the far plane clips none, outlines run on around joints, the picture does not
 * depend on the order of lines, and only depth halos write depth. */
#include "render_host.h"

#define LINEAO_SHADERS_SPIRV
#include "lineao_shaders.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 160 };
static const double slack = 0.03; /* of s or px: the rasteriser's grid */

static render_shot shot_of(const render_lines *lines, const lao_settings *settings) {
    render_shot shot;
    memset(&shot, 0, sizeof shot);
    shot.width = shot.height = SIZE;
    shot.camera = render_camera(0, 0, 1, 200);
    render_orthographic(&shot.camera, SIZE, 1, 1, 400);
    shot.lines[0] = lines;
    shot.settings[0] = settings;
    shot.set_count = 1;
    return shot;
}

static lao_settings plain(double width, int halo) {
    lao_settings s;
    memset(&s, 0, sizeof s);
    s.width = (float)width;
    s.supersampling = 1;
    s.halo = (float)halo;
    s.set = LAO_SET(occlusion) | LAO_SET(halo) | LAO_SET(halo_depth);
    s.halo_depth = 0.01f;
    return s;
}

static void paint(render_lines *lines, uint32_t first, uint8_t r, uint8_t g, uint8_t b) {
    for (uint32_t i = first; i < lines->point_count; i++) {
        uint8_t *c = lines->colors + 4 * (size_t)i;
        c[0] = r;
        c[1] = g;
        c[2] = b;
    }
}

/* -1: background, 0: black, else the place of the largest component + 1 */
static int kind_of(const render_image *color, int x, int y) {
    const uint8_t *c = color->data + 4 * ((size_t)y * color->width + (size_t)x);
    int best = 0;
    if (c[3] == 0)
        return -1;
    for (int k = 1; k < 3; k++)
        best = c[k] > c[best] ? k : best;
    return c[best] == 0 ? 0 : best + 1;
}

/* ----------------------------------------------------------------------------------------- widths
 */

static void borders(render_device *device, lao_settings settings, double begin, double angle) {
    render_lines lines = {0};
    render_shot shot = shot_of(&lines, &settings);
    render_result result;
    const render_image *color;
    int black = 0, wrong = 0;
    double half = 0.5 * (double)settings.width, c = cos(angle), s = sin(angle);
    for (int i = -10; i <= 10; i++)
        render_point(&lines, 11 * i * c, 11 * i * s, 0);
    render_line(&lines);
    paint(&lines, 0, 200, 90, 60);
    render_draw(device, &shot, &result);
    color = render_find(&result, "color", 0);
    for (int y = 0; y < SIZE; y++) {
        for (int x = 0; x < SIZE; x++) {
            double across = fabs((x + 0.5 - SIZE / 2) * s - (y + 0.5 - SIZE / 2) * c);
            int want = across > half ? -1 : across < begin * half ? 1 : 0;
            double edge = fmin(fabs(across - half), fabs(across - begin * half));
            black += want == 0;
            wrong += edge > slack && kind_of(color, x, y) != want;
        }
    }
    if (wrong)
        print_message("%s: b %g, angle %g: %d pixels\n", device->name, (double)settings.halo_width,
                      angle, wrong);
    assert_int_equal(wrong, 0);
    assert_true(black > SIZE);
    render_free(&result);
    render_lines_free(&lines);
}

static void test_widths(void **state) {
    static const float widths[] = {0.1f, 0.25f};
    (void)state;
    for (int d = 0; d < 2; d++) {
        render_need(&render_devices[d]);
        for (int i = 0; i < 2; i++) {
            lao_settings s = plain(61, LAO_HALO_UNIFORM);
            s.halo_width = widths[i];
            borders(&render_devices[d], s, 1 - (double)widths[i], 0.4 * i);
            s.halo = LAO_HALO_DEPTH;
            borders(&render_devices[d], s, 1 - 2 * (double)widths[i], 0.4 * i);
        }
    }
}

/* A soft border darkens with the square of the way to the edge, and so do highlights. */
static void test_soft(void **state) {
    (void)state;
    for (int d = 0; d < 2; d++) {
        render_lines lines = {0};
        lao_settings settings = plain(101, LAO_HALO_DEPTH);
        render_shot shot = shot_of(&lines, &settings);
        render_result result;
        const render_image *color;
        render_need(&render_devices[d]);
        settings.halo_border = LAO_HALO_SOFT;
        settings.halo_width = 0.25f;
        render_point(&lines, -70, 0, 0);
        render_point(&lines, 70, 0, 0);
        render_line(&lines);
        paint(&lines, 0, 250, 250, 250);
        render_draw(&render_devices[d], &shot, &result);
        color = render_find(&result, "color", 0);
        for (int y = 30; y < 130; y++) {
            double s = fabs(y + 0.5 - 80) / 50.5, light = s < 0.5 ? 1 : pow((1 - s) / 0.5, 2);
            const uint8_t *c = color->data + 4 * ((size_t)y * SIZE + SIZE / 2);
            if (s < 1 - slack && fabs(s - 0.5) > slack) {
                assert_true(fabs(c[0] - 250 * light) < 1.5);
                assert_true(fabs(c[3] - 128 - 127 * light) < 1.5);
            }
        }
        render_free(&result);
        render_lines_free(&lines);
    }
}

/* ------------------------------------------------------------------------------------------ depth
 */

typedef struct crossing {
    double gap, reach; /* mm: between the lines; D */
    int function, camera;
} crossing;

static double f_of(int function, double s) {
    return function == LAO_HALO_SQRT ? sqrt(s) : function == LAO_HALO_LINEAR ? s : s * s;
}

/* A red line along x in front of a green one along y: what each pixel must be, and with what depth.
 */
static void crossed(render_device *device, crossing it, int swapped) {
    render_lines lines = {0};
    lao_settings settings = plain(8, LAO_HALO_DEPTH);
    render_shot shot = shot_of(&lines, &settings);
    render_result result;
    const render_image *color, *depth;
    double z1 = 30, z2 = 30 + it.gap, half = 4, z0 = 0, tall = 24;
    int wrong = 0, counts[3] = {0, 0, 0};
    for (int k = 0; k < 2; k++) {
        uint32_t first = lines.point_count;
        int along_x = k == swapped;
        for (int i = -3; i <= 3; i++)
            render_point(&lines, along_x ? 5 * i : 0, along_x ? 0 : 5 * i, along_x ? -z1 : -z2);
        render_line(&lines);
        paint(&lines, first, along_x ? 255 : 0, along_x ? 0 : 255, 0);
    }
    settings.halo_depth = (float)(it.reach / 100); /* of a sphere of 100 mm */
    settings.halo_function = (float)it.function;
    shot.sphere[2] = -32;
    shot.sphere[3] = 50;
    z0 = 32 - 50;
    shot.camera = render_camera(0, 0, 1, 0);
    if (it.camera & 1)
        render_orthographic(&shot.camera, tall, 1, 2, 60);
    else
        render_perspective(&shot.camera, 45, 1, 2, 60);
    if (it.camera & 2)
        render_reverse(&shot.camera);
    render_draw(device, &shot, &result);
    color = render_find(&result, "color", 0);
    depth = render_find(&result, "depth", 0);
    for (int y = 0; y < SIZE; y++) {
        for (int x = 0; x < SIZE; x++) {
            double px = (x + 0.5) / SIZE * 2 - 1, py = (y + 0.5) / SIZE * 2 - 1;
            double scale1 = it.camera & 1 ? tall / 2 : tan(0.5 * 45 * 0.017453292519943295) * z1;
            double scale2 = it.camera & 1 ? tall / 2 : scale1 / z1 * z2;
            double s1 = fabs(py * scale1) / half, s2 = fabs(px * scale2) / half, at1, at2, edge;
            int want, got = kind_of(color, x, y);
            at1 = s1 > 1 ? 1e30 : z1 + (s1 >= 0.8 ? it.reach * f_of(it.function, s1) : 0);
            at2 = s2 > 1 ? 1e30 : z2 + (s2 >= 0.8 ? it.reach * f_of(it.function, s2) : 0);
            edge = fmin(fmin(fabs(s1 - 1), fabs(s1 - 0.8)), fmin(fabs(s2 - 1), fabs(s2 - 0.8)));
            if (edge < slack || fabs(at1 - at2) < 0.02 * it.reach)
                continue;
            want = at1 == at2 ? -1 : at1 < at2 ? (s1 < 0.8 ? 1 : 0) : (s2 < 0.8 ? 2 : 0);
            wrong += got != want;
            if (got >= 0) {
                double d = (double)((const float *)(const void *)depth->data)[y * SIZE + x];
                double z = at1 < at2 ? z1 : z2; /* as if there were no halo */
                assert_true(fabs(d - (z - z0) / 100) < 1e-4);
                counts[got]++;
            }
        }
    }
    if (wrong)
        print_message("%s: gap %g, reach %g, f %d, camera %d: %d pixels\n", device->name, it.gap,
                      it.reach, it.function, it.camera, wrong);
    assert_int_equal(wrong, 0);
    assert_true(counts[0] > 100 && counts[1] > 100 && counts[2] > 100);
    render_free(&result);
    render_lines_free(&lines);
}

static void test_depth(void **state) {
    /* no halo, a part of it, all of it */
    static const double gaps[] = {0.5, 0.95, 1.1};
    (void)state;
    for (int d = 0; d < 2; d++) {
        render_need(&render_devices[d]);
        for (int i = 0; i < 3 * 4 * 3; i++) {
            crossing it;
            it.reach = i % 2 ? 1 : 4;
            it.gap = gaps[i % 3] * it.reach;
            it.camera = i / 3 % 4;
            it.function = i / 12;
            crossed(&render_devices[d], it, i & 1);
        }
    }
}

/* Near the far plane, displaced beyond it, a border is as black as elsewhere. */
static void test_far_plane(void **state) {
    (void)state;
    for (int i = 0; i < 8; i++) {
        render_device *device = &render_devices[i & 1];
        render_lines lines = {0};
        lao_settings settings = plain(40, LAO_HALO_DEPTH);
        render_shot shot = shot_of(&lines, &settings);
        render_result result;
        const render_image *color;
        render_need(device);
        render_point(&lines, -70, 0, -299);
        render_point(&lines, 70, 0, -299);
        render_line(&lines);
        settings.halo_depth = 1;
        shot.camera = render_camera(0, 0, 1, 0);
        if (i & 2)
            render_orthographic(&shot.camera, SIZE, 1, 1, 300);
        else
            render_perspective(&shot.camera, 30, 1, 1, 300);
        if (i & 4)
            render_reverse(&shot.camera);
        render_draw(device, &shot, &result);
        color = render_find(&result, "color", 0);
        {
            int counts[2] = {0, 0};
            for (int y = 0; y < SIZE; y++) {
                int kind = kind_of(color, SIZE / 2, y);
                if (kind >= 0)
                    counts[kind > 0]++;
            }
            assert_true(abs(counts[0] * 4 - counts[1]) <= 6 && counts[1] > 20);
        }
        render_free(&result);
        render_lines_free(&lines);
    }
}

/* ----------------------------------------------------------------------------------------- joints
 */

/* No pixel deep inside a line is black, and none at its outline is lit but at its open ends. */
static void outline(render_device *device, int halo, double turn, int closed) {
    enum { REACH = 16 };
    render_lines lines = {0};
    lao_settings settings = plain(36, halo);
    render_shot shot = shot_of(&lines, &settings);
    render_result result;
    const render_image *color;
    double border = 4.5, half = closed ? 3.14159265 / closed : 0.5 * turn, x = -62, y = -28;
    double inner = border / cos(half) + 1.6; /* borders meet in a mitre at the inner corner */
    int inside = 0, outside = 0;
    settings.halo_width = halo == LAO_HALO_DEPTH ? 0.125f : 0.25f;
    if (closed) {
        for (int i = 0; i <= closed; i++)
            render_point(&lines, 50 * cos(6.283185307 * (i % closed) / closed),
                         50 * sin(6.283185307 * (i % closed) / closed), 0);
    } else {
        for (int k = 0; k < 4; k++) {
            render_point(&lines, x, y, 0);
            x += 58 * cos(half);
            y += 58 * sin(half) * (k % 2 ? -1 : 1);
        }
    }
    render_line(&lines);
    paint(&lines, 0, 255, 255, 255);
    render_draw(device, &shot, &result);
    color = render_find(&result, "color", 0);
    for (int py = REACH; py < SIZE - REACH; py++) {
        for (int px = REACH; px < SIZE - REACH; px++) {
            double nearest = 1e9, open = 1e9;
            int kind = kind_of(color, px, py);
            if (kind < 0)
                continue;
            for (int j = -REACH; j <= REACH; j++) {
                for (int i = -REACH; i <= REACH; i++) {
                    if (kind_of(color, px + i, py + j) < 0)
                        nearest = fmin(nearest, hypot(i, j));
                }
            }
            for (int k = 0; !closed && k < 2; k++) {
                const float *p = lines.points + (k ? 3 * (lines.point_count - 1) : 0);
                open = fmin(open, hypot(px + 0.5 - SIZE / 2 - (double)p[0],
                                        py + 0.5 - SIZE / 2 - (double)p[1]));
            }
            inside += kind == 0 && nearest > inner;
            outside += kind > 0 && nearest < border - 1.1 && open > 30;
        }
    }
    if (inside + outside)
        print_message("%s, halo %d, turn %g, closed %d: %d black inside, %d lit at the outline\n",
                      device->name, halo, turn, closed, inside, outside);
    assert_int_equal(inside + outside, 0);
    render_free(&result);
    render_lines_free(&lines);
}

static void test_joints(void **state) {
    static const double turns[] = {0.2, 0.7, 1.2, 1.54, 1.6, 2.0, 2.4};
    (void)state;
    for (int d = 0; d < 2; d++) {
        render_need(&render_devices[d]);
        for (int halo = LAO_HALO_UNIFORM; halo <= LAO_HALO_DEPTH; halo++) {
            for (size_t i = 0; i < sizeof turns / sizeof *turns; i++)
                outline(&render_devices[d], halo, turns[i], 0);
            for (int closed = 3; closed < 24; closed += 5)
                outline(&render_devices[d], halo, 0, closed);
        }
    }
}

/* ------------------------------------------------------------------------------------------- rest
 */

static void test_order(void **state) {
    render_lines lines = {0}, backwards = {0};
    (void)state;
    render_scatter(&lines, 150, 5, 12, 9, 9);
    for (uint32_t line = lines.line_count; line-- > 0;) {
        for (uint32_t i = lines.offsets[line]; i < lines.offsets[line + 1]; i++) {
            const float *p = lines.points + 3 * (size_t)i;
            render_point(&backwards, (double)p[0], (double)p[1], (double)p[2]);
            memcpy(backwards.colors + 4 * (size_t)(backwards.point_count - 1),
                   lines.colors + 4 * (size_t)i, 4);
        }
        render_line(&backwards);
    }
    for (int i = 0; i < 6; i++) {
        render_device *device = &render_devices[i & 1];
        lao_settings settings = plain(1.1, i / 2);
        render_shot shot = shot_of(&lines, &settings);
        render_result a, b;
        render_need(device);
        settings.halo_depth = 0.05f;
        render_perspective(&shot.camera, 9, 1, 1, 400);
        render_reverse(&shot.camera); /* finer depths, so that no two are equal */
        render_draw(device, &shot, &a);
        shot.lines[0] = &backwards;
        render_draw(device, &shot, &b);
        render_same_images("order of lines", &a, &b);
        render_free(&a);
        render_free(&b);
    }
    render_lines_free(&lines);
    render_lines_free(&backwards);
}

static void test_who_writes_depth(void **state) {
    enum { EXECUTION_MODE = 16, DEPTH_REPLACING = 12 };
    int found = 0;
    (void)state;
    for (uint32_t i = 0; i < lao_shader_count; i++) {
        const lao_shader_stage *stage = &lao_shaders[i].fragment;
        int writes = 0;
        if (strncmp(lao_shaders[i].name, "lines", 5) != 0)
            continue;
        for (uint32_t k = 5; k < stage->word_count; k += stage->words[k] >> 16)
            writes |= (stage->words[k] & 0xffff) == EXECUTION_MODE &&
                      stage->words[k + 2] == DEPTH_REPLACING;
        assert_int_equal(writes, strcmp(lao_shaders[i].name, "lines_halo") == 0);
        found++;
    }
    assert_int_equal(found, 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_widths),
        cmocka_unit_test(test_soft),
        cmocka_unit_test(test_depth),
        cmocka_unit_test(test_far_plane),
        cmocka_unit_test(test_joints),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_who_writes_depth),
    };
    return cmocka_run_group_tests(tests, render_open_both, render_close_both);
}
