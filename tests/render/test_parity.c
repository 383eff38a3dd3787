/* Proves that OpenGL and Vulkan draw the same picture: every image of the graph, on every level,
 * has the same bits on both, for perspective, orthographic and reversed off-centre cameras, for all
 * presets and for each way of leaving the default. Where the driver is not Mesa's llvmpipe the
 * differences are printed instead. */
#include "render_host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static render_device *const gl = &render_devices[RENDER_GL];
static render_device *const vk = &render_devices[RENDER_VK];
static render_lines board, few;
/* Compiling the unrolled samples of the shipped number takes seconds for each variant, so only the
 * presets do; the rest takes the loop, or with the argument 32 the unrolled ones too. */
static const char *samples = "20";

enum { CAMERAS = 3 };

/* Sizes are odd, so that levels end in half texels. */
static render_shot mixed(int camera) {
    render_shot shot;
    double aspect = 95.0 / 87.0;
    memset(&shot, 0, sizeof shot);
    shot.width = 95;
    shot.height = 87;
    if (camera == 0) {
        shot.camera = render_camera(0.3, 0.2, 1, 40);
        render_perspective(&shot.camera, 35, aspect, 10, 90);
    } else if (camera == 1) {
        shot.camera = render_camera(-0.4, 0.3, 0.8, 50);
        render_orthographic(&shot.camera, 24, aspect, 5, 95);
    } else {
        shot.camera = render_camera(0.5, -0.6, 0.7, 33);
        render_perspective(&shot.camera, 50, aspect, 6, 80);
        render_shift(&shot.camera, 0.2, -0.15);
        render_reverse(&shot.camera);
    }
    shot.lines[0] = &board;
    shot.set_count = 1;
    shot.time = 23.4f;
    for (int k = 0; k < 3; k++)
        shot.background[k] = 0.2f + 0.3f * (float)k;
    shot.background[3] = 1;
    return shot;
}

static void compare(const char *what, const render_shot *shot) {
    render_result a, b;
    uint32_t differing = 0, covered = 0;
    const render_image *color;
    render_draw(gl, shot, &a);
    render_draw(vk, shot, &b);
    assert_int_equal(a.count, b.count);
    for (uint32_t i = 0; i < a.count; i++) {
        const render_image *other = render_find(&b, a.images[i].name, a.images[i].level);
        assert_non_null(other);
        differing += render_compare(what, &a.images[i], other).texels;
    }
    if (a.target.data)
        differing += render_compare(what, &a.target, &b.target).texels;
    if (a.depth_after.data)
        differing += render_compare(what, &a.depth_after, &b.depth_after).texels;
    color = render_find(&a, "color", 0);
    assert_non_null(color);
    for (uint32_t i = 0; i < color->width * color->height; i++)
        covered += color->data[4 * i + 3] != 0;
    assert_true(covered * 10 > color->width * color->height); /* there is something to compare */
    assert_true(memcmp(&a.frame, &b.frame, sizeof a.frame) == 0);
    if (gl->software && vk->software)
        assert_int_equal(differing, 0);
    else
        print_message("%s: %u texels differ on this driver\n", what, differing);
    render_free(&a);
    render_free(&b);
}

/* One shot with settings given as text. */
static void shoot(const char *what, int camera, const char *const *settings) {
    const lao_module *module = lao_lines_module();
    render_shot shot = mixed(camera);
    lao_settings chosen;
    memset(&chosen, 0, sizeof chosen);
    for (; *settings; settings += 2)
        assert_int_equal(
            lao_setting_parse(module, lao_setting_find(module, settings[0]), settings[1], &chosen),
            0);
    shot.settings[0] = &chosen;
    compare(what, &shot);
}

static void both(void) {
    render_need(gl);
    render_need(vk);
}

/* ---------------------------------------------------------------------------------------- tests */

static void presets(int camera) {
    static const char *const names[] = {"default", "classic", "paper"};
    both();
    for (int i = 0; i < 3; i++) {
        const char *settings[] = {"preset", names[i], NULL};
        char what[64];
        snprintf(what, sizeof what, "camera %d, %s", camera, names[i]);
        shoot(what, camera, settings);
    }
}

static void test_perspective(void **state) {
    (void)state;
    presets(0);
}

static void test_orthographic(void **state) {
    (void)state;
    presets(1);
}

static void test_reverse_off_centre(void **state) {
    (void)state;
    presets(2);
}

static void test_gaussian(void **state) {
    static const char *const settings[] = {"pyramid", "gaussian", NULL};
    (void)state;
    both();
    shoot("gaussian", 0, settings);
}

static void test_author_light(void **state) {
    const char *const settings[] = {"light", "author", "samples", samples, NULL};
    (void)state;
    both();
    shoot("author", 0, settings);
}

static void test_smoothing(void **state) {
    static const char *const settings[] = {"smoothing", "2", NULL};
    (void)state;
    both();
    shoot("smoothing", 0, settings);
}

static void test_supersampling(void **state) {
    static const char *const one[] = {"supersampling", "1", NULL};
    static const char *const three[] = {"supersampling", "3", NULL};
    (void)state;
    both();
    shoot("supersampling 1", 0, one);
    shoot("supersampling 3", 0, three);
}

static void test_samples(void **state) {
    static const char *const settings[] = {"samples", "7", "levels", "2", NULL};
    (void)state;
    both();
    shoot("7 samples on 2 levels", 0, settings);
}

static void test_levels(void **state) {
    const char *const one[] = {"levels", "1", "samples", samples, NULL};
    const char *const five[] = {"levels", "5", "samples", samples, NULL};
    (void)state;
    both();
    shoot("1 level", 0, one);
    shoot("5 levels", 0, five);
}

static void test_halos(void **state) {
    static const char *const shots[][9] = {
        {"halo", "uniform", "occlusion", "off"},
        {"halo", "uniform", "halo_border", "soft", "occlusion", "off"},
        {"halo", "depth", "halo_border", "soft", "halo_width", "0.3", "occlusion", "off"},
        {"halo", "depth", "halo_function", "linear", "halo_depth", "0.1", "occlusion", "off"},
        {"halo", "depth", "halo_function", "square", "halo_depth", "1", "occlusion", "off"}};
    (void)state;
    both();
    for (size_t i = 0; i < sizeof shots / sizeof *shots; i++) {
        for (int camera = 0; camera < CAMERAS; camera++)
            shoot(shots[i][3], camera, shots[i]);
    }
}

static void test_trails(void **state) {
    static const char *const modes[] = {"taper", "opacity", "highlight"};
    static const char *const halos[] = {"none", "uniform", "depth"};
    (void)state;
    both();
    for (int i = 0; i < 9; i++) {
        const char *const settings[] = {"trail",        modes[i % 3], "halo",      halos[i / 3],
                                        "trail_length", "30",         "occlusion", "off",
                                        "period",       "100",        NULL};
        shoot(modes[i % 3], i % CAMERAS, settings);
    }
    {
        static const char *const settings[] = {"trail", "taper", "trail_length", "30", NULL};
        shoot("taper with occlusion", 0, settings);
    }
}

static void test_two_sets(void **state) {
    render_shot shot = mixed(0);
    lao_settings wide, narrow;
    (void)state;
    both();
    memset(&wide, 0, sizeof wide);
    memset(&narrow, 0, sizeof narrow);
    wide.width = 1.5f;
    narrow.width = 0.3f;
    narrow.preset = 1; /* without halo, and the other with one */
    narrow.strength = 2;
    shot.lines[1] = &few;
    shot.settings[0] = &narrow;
    shot.settings[1] = &wide;
    shot.set_count = 2;
    shot.target = RENDER_TARGET_RGBA8;
    shot.target_flags = LAO_HOST_TOP_DOWN;
    compare("two sets", &shot);
}

/* More segments than a processor takes at once: it catches up in between (4 texels a line). */
/* Lines first .. end - 1 of `from`. */
static void part(render_lines *lines, const render_lines *from, uint32_t first, uint32_t end) {
    for (uint32_t l = first; l < end; l++) {
        for (uint32_t i = from->offsets[l]; i < from->offsets[l + 1]; i++) {
            const float *p = from->points + 3 * (size_t)i;
            render_point(lines, (double)p[0], (double)p[1], (double)p[2]);
        }
        render_line(lines);
    }
    memcpy(lines->colors, from->colors + 4 * (size_t)from->offsets[first],
           4 * (size_t)lines->point_count);
}

static uint32_t unlike(const char *image, const render_result *a, const render_result *b) {
    const render_image *first = render_find(a, image, 0), *second = render_find(b, image, 0);
    uint32_t count = 0;
    assert_int_equal(first->width * first->height, second->width * second->height);
    float *x = render_floats(first, 0), *y = render_floats(second, 0);
    for (uint32_t i = 0; i < first->width * first->height; i++)
        count += memcmp(&x[i], &y[i], sizeof *x) != 0;
    free(x);
    free(y);
    return count;
}

/* A set that is cut in two gives the picture of the whole when its halves occlude each other. */
static void test_shared_occlusion(void **state) {
    render_shot shot = mixed(0);
    render_result whole, halves, apart;
    render_lines front, back;
    (void)state;
    both();
    memset(&front, 0, sizeof front);
    memset(&back, 0, sizeof back);
    part(&front, &board, 0, 90);
    part(&back, &board, 90, board.line_count);
    shot.sphere[3] = 20;
    render_draw(gl, &shot, &whole);
    shot.lines[0] = &front;
    shot.lines[1] = &back;
    shot.set_count = 2;
    render_draw(gl, &shot, &apart);
    assert_true(unlike("out", &whole, &apart) > 100);
    shot.frame_flags = LAO_FRAME_SHARED_OCCLUSION;
    render_draw(gl, &shot, &halves);
    assert_int_equal(unlike("ao", &whole, &halves), 0);
    assert_int_equal(unlike("out", &whole, &halves), 0);
    compare("two sets that occlude each other", &shot);
    render_free(&whole);
    render_free(&halves);
    render_free(&apart);
    render_lines_free(&front);
    render_lines_free(&back);
}

static void test_many_segments(void **state) {
    render_shot shot = mixed(0);
    render_lines crowd;
    (void)state;
    both();
    memset(&crowd, 0, sizeof crowd);
    render_scatter(&crowd, 36000, 5, 1.5, 9, 9);
    shot.lines[0] = &crowd;
    compare("many segments", &shot);
    render_lines_free(&crowd);
}

static void test_targets(void **state) {
    render_shot shot = mixed(1);
    (void)state;
    both();
    shot.target = RENDER_TARGET_RGBA32F;
    shot.target_value = 0.3f;
    shot.target_flags = LAO_HOST_ENCODE_SRGB;
    shot.background[3] = 0.5f;
    compare("half transparent, decoded", &shot);
    shot.target = RENDER_TARGET_RGBA8;
    shot.target_flags = 0;
    shot.background[3] = 0;
    compare("transparent", &shot);
}

static void test_host_depth(void **state) {
    render_shot shot = mixed(0);
    lao_settings settings;
    (void)state;
    both();
    memset(&settings, 0, sizeof settings);
    settings.width = 0.7f;
    shot.settings[0] = &settings;
    shot.host_depth = 1;
    shot.depth_value = 1;
    shot.depth_lines = &few;
    compare("host's depth", &shot);
    shot = mixed(2);
    shot.settings[0] = &settings;
    shot.host_depth = 1;
    shot.depth_flags = LAO_HOST_TOP_DOWN;
    shot.depth_value = 0;
    shot.depth_lines = &few;
    compare("host's depth, reversed, top down", &shot);
}

static int setup(void **state) {
    /* two layers of the board of degenerate lines, and lines in depth */
    render_scene(&board, "stress", 48, 0.28, -14, 8.4, 3);
    render_scene(&board, "helix", 20, 0.25, 0, 0, 0);
    render_scatter(&board, 120, 1, 9, 12, 9);
    render_scatter(&few, 30, 2, 15, 9, 9);
    return render_open_both(state);
}

static int teardown(void **state) {
    render_lines_free(&board);
    render_lines_free(&few);
    return render_close_both(state);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_perspective),
        cmocka_unit_test(test_orthographic),
        cmocka_unit_test(test_reverse_off_centre),
        cmocka_unit_test(test_gaussian),
        cmocka_unit_test(test_author_light),
        cmocka_unit_test(test_smoothing),
        cmocka_unit_test(test_supersampling),
        cmocka_unit_test(test_samples),
        cmocka_unit_test(test_levels),
        cmocka_unit_test(test_two_sets),
        cmocka_unit_test(test_shared_occlusion),
        cmocka_unit_test(test_many_segments),
        cmocka_unit_test(test_targets),
        cmocka_unit_test(test_host_depth),
        cmocka_unit_test(test_halos),
        cmocka_unit_test(test_trails),
    };
    if (argc > 1)
        samples = argv[1];
    return cmocka_run_group_tests(tests, setup, teardown);
}
