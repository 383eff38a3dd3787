/* Proves that every full-screen pass computes what the functions of lineao.h say: C loops over the
 * images that were read back make the same bits as the shaders, on OpenGL for all presets and ways
 * of leaving them, on Vulkan for the default (the rest follows from test_parity). Drivers other
 * than Mesa's llvmpipe have tolerances. */
#include "c_passes.h"

#include <stdlib.h>
#include <string.h>

static render_device *const gl = &render_devices[RENDER_GL];
static render_device *const vk = &render_devices[RENDER_VK];
static render_lines board;

static render_shot mixed(void) {
    render_shot shot;
    memset(&shot, 0, sizeof shot);
    shot.width = 61;
    shot.height = 53;
    shot.camera = render_camera(0.3, 0.2, 1, 40);
    render_perspective(&shot.camera, 35, 61.0 / 53.0, 10, 90);
    shot.lines[0] = &board;
    shot.set_count = 1;
    shot.background[0] = 0.25f;
    shot.background[2] = 0.75f;
    shot.background[3] = 1;
    return shot;
}

/* largest: of the mean absolute difference, where bits cannot be promised */
static void same(const render_device *device, const char *what, const render_image *c,
                 const render_image *drawn, double largest) {
    render_difference d;
    assert_non_null(drawn);
    d = render_compare(what, c, drawn);
    if (device->software)
        assert_int_equal(d.texels, 0);
    else
        assert_true(d.mean <= largest);
}

static void check_level(const render_device *device, const char *what, const c_inputs *in,
                        c_level c, uint32_t level) {
    if (level > 0 && level < C_MOST_LEVELS)
        same(device, what, &c.tensor, in->tensor[level], 1e-4);
    same(device, what, &c.words, in->level[level], 1e-2);
    if (in->level_tangent[level])
        same(device, what, &c.tangent, in->level_tangent[level], 1e-3);
    c_free(&c.tensor);
    c_free(&c.words);
    c_free(&c.tangent);
}

static void check_occlusion(const render_device *device, const char *what, const c_inputs *in) {
    render_image ao = c_occlusion(in);
    double sum = 0;
    /* each of the two rows repeats by itself */
    for (int i = 0; i < 2 * (int)in->settings.smoothing; i++) {
        int along_y = i >= (int)in->settings.smoothing;
        render_image next = c_smooth(in, &ao, !along_y, along_y);
        c_free(&ao);
        ao = next;
    }
    same(device, what, &ao, in->ao, 1e-3);
    for (uint32_t i = 0; i < ao.width * ao.height; i++)
        sum += (double)((const float *)(const void *)ao.data)[i];
    assert_true(sum > 0.001 * ao.width * ao.height); /* there is something to compare */
    c_free(&ao);
}

/* All passes between the G-buffer and `out`. */
static void check(const render_device *device, const char *what, const render_result *result,
                  const lao_settings *settings) {
    c_inputs in;
    render_image image;
    c_inputs_find(&in, result, settings);
    if (in.settings.occlusion != 0) {
        check_level(device, what, &in, c_level_zero(&in), 0);
        for (uint32_t level = 1; level < (uint32_t)in.settings.levels; level++)
            check_level(device, what, &in, c_level_up(&in, level), level);
        check_occlusion(device, what, &in);
    }
    image = c_shade(&in);
    same(device, what, &image, in.shaded, 2e-3);
    c_free(&image);
    image = c_resolve(&in);
    same(device, what, &image, in.out, 2e-3);
    c_free(&image);
}

static void shoot(render_device *device, const char *what, const char *const *text) {
    const lao_module *module = lao_lines_module();
    render_shot shot = mixed();
    render_result result;
    lao_settings settings;
    render_need(device);
    memset(&settings, 0, sizeof settings);
    for (; *text; text += 2)
        assert_int_equal(
            lao_setting_parse(module, lao_setting_find(module, text[0]), text[1], &settings), 0);
    shot.settings[0] = &settings;
    shot.time = 20;
    render_draw(device, &shot, &result);
    check(device, what, &result, &settings);
    render_free(&result);
}

/* ---------------------------------------------------------------------------------------- tests */

static void test_default_gl(void **state) {
    static const char *const text[] = {NULL};
    (void)state;
    shoot(gl, "default", text);
}

static void test_default_vk(void **state) {
    static const char *const text[] = {NULL};
    (void)state;
    shoot(vk, "default on Vulkan", text);
}

static void test_classic(void **state) {
    static const char *const text[] = {"preset", "classic", NULL};
    (void)state;
    shoot(gl, "classic", text);
}

static void test_paper(void **state) {
    static const char *const text[] = {"preset", "paper", NULL};
    (void)state;
    shoot(gl, "paper", text);
}

/* Borders keep part of the light; tapered lines are occluded as wide ones. */
static void test_soft_trails(void **state) {
    static const char *const text[] = {"halo_border",  "soft", "trail",      "taper",
                                       "trail_length", "40",   "halo_width", "0.2",
                                       "samples",      "20",   NULL};
    (void)state;
    shoot(gl, "soft halos of trails", text);
}

static void test_author_light(void **state) {
    static const char *const text[] = {"light",         "author", "samples", "12",
                                       "supersampling", "1",      NULL};
    (void)state;
    shoot(gl, "author", text);
}

static void test_author_gaussian(void **state) {
    static const char *const text[] = {"light",   "author", "pyramid", "gaussian",
                                       "samples", "12",     NULL};
    (void)state;
    shoot(gl, "author, gaussian", text);
}

static void test_gaussian_paper(void **state) {
    static const char *const text[] = {"preset", "paper",  "pyramid", "gaussian", "samples",
                                       "9",      "levels", "4",       NULL};
    (void)state;
    shoot(gl, "gaussian, paper", text);
}

static void test_strict_zero(void **state) {
    static const char *const text[] = {"strict_zero",    "on", "samples", "5", "depth_unit", "mm",
                                       "light_exponent", "7",  NULL};
    (void)state;
    shoot(gl, "strict zero, mm", text);
}

static void test_smoothing(void **state) {
    static const char *const text[] = {"smoothing", "2", "samples", "5", NULL};
    (void)state;
    shoot(gl, "smoothing", text);
}

static void test_luminance_preserving(void **state) {
    static const char *const text[] = {
        "ao_affects_color", "luminance_preserving", "strength", "3", "samples", "9", NULL};
    (void)state;
    shoot(gl, "luminance preserving", text);
    shoot(vk, "luminance preserving on Vulkan", text);
}

static void test_no_occlusion(void **state) {
    static const char *const text[] = {"occlusion",     "off", "shininess", "3",
                                       "supersampling", "3",   NULL};
    (void)state;
    shoot(gl, "no occlusion", text);
}

static void test_show(void **state) {
    static const char *const shows[] = {
        "occlusion", "visibility",       "depth", "light",
        "alignment", "visibility_depth", "color", "visibility_depth_light"};
    (void)state;
    for (size_t i = 0; i < sizeof shows / sizeof *shows; i++) {
        const char *text[] = {"show", shows[i], "samples", "5", NULL};
        shoot(gl, shows[i], text);
    }
}

/* The last copy: flipped or not, decoded or not, over the host's picture. */
static void present(render_device *device, lao_format format, uint32_t flags, float alpha) {
    static const lao_settings none = {0};
    render_shot shot = mixed();
    lao_settings settings = none;
    render_result result;
    render_image image;
    c_inputs in;
    render_need(device);
    settings.set = LAO_SET(occlusion);
    shot.settings[0] = &settings;
    shot.target = format == LAO_FORMAT_RGBA8 ? RENDER_TARGET_RGBA8 : RENDER_TARGET_RGBA32F;
    shot.target_flags = flags;
    shot.target_value = 0.4f;
    shot.background[3] = alpha;
    render_draw(device, &shot, &result);
    c_inputs_find(&in, &result, &settings);
    image = c_present(&in, format, 0.4f);
    if (format == LAO_FORMAT_RGBA8 && alpha < 1) {
        /* blended in bytes by the driver */
        assert_true(render_compare("present", &image, &result.target).largest < 2.01 / 255);
    } else {
        same(device, "present", &image, &result.target, 1e-3);
    }
    c_free(&image);
    render_free(&result);
}

static void test_present(void **state) {
    static const lao_format formats[] = {LAO_FORMAT_RGBA8, LAO_FORMAT_RGBA32F};
    (void)state;
    for (int f = 0; f < 2; f++) {
        for (uint32_t flags = 0; flags < 8; flags++) {
            if (flags & LAO_HOST_WRITABLE)
                continue;
            present(gl, formats[f], flags, 1);
            present(gl, formats[f], flags, 0);
        }
    }
    present(vk, LAO_FORMAT_RGBA8, LAO_HOST_TOP_DOWN, 1);
}

/* Where nothing is drawn our depth is the host's; where something is, it is nearer; the host gets
 * the nearest sample of each pixel. */
static void host_depth(int reversed, uint32_t flags) {
    static const lao_settings none = {0};
    render_shot shot = mixed();
    lao_settings settings = none;
    render_result result;
    render_image image;
    c_inputs in;
    uint32_t hidden = 0, covered = 0;
    settings.set = LAO_SET(occlusion);
    if (reversed)
        render_reverse(&shot.camera);
    shot.settings[0] = &settings;
    shot.host_depth = 1;
    shot.depth_flags = flags;
    shot.depth_value = reversed ? 0.1f : 0.85f;
    render_draw(gl, &shot, &result);
    c_inputs_find(&in, &result, &settings);
    image = c_export_depth(&in, &result.depth_before);
    same(gl, "export_depth", &image, &result.depth_after, 1e-6);
    for (uint32_t i = 0; i < in.color->width * in.color->height; i++) {
        float z = ((const float *)(const void *)in.zbuffer->data)[i];
        if (in.color->data[4 * i + 3] == 0) {
            assert_true(z == shot.depth_value);
            hidden++;
        } else {
            assert_true(reversed ? z > shot.depth_value : z < shot.depth_value);
            covered++;
        }
    }
    assert_true(hidden > 100 && covered > 100);
    c_free(&image);
    render_free(&result);
}

static void test_host_depth(void **state) {
    (void)state;
    render_need(gl);
    host_depth(0, 0);
    host_depth(1, 0);
    host_depth(0, LAO_HOST_TOP_DOWN);
}

static int setup(void **state) {
    render_scene(&board, "stress", 48, 0.28, -14, 8.4, 3);
    render_scene(&board, "helix", 20, 0.25, 0, 0, 0);
    render_scatter(&board, 120, 1, 9, 12, 9);
    return render_open_both(state);
}

static int teardown(void **state) {
    render_lines_free(&board);
    return render_close_both(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_default_gl),
        cmocka_unit_test(test_default_vk),
        cmocka_unit_test(test_classic),
        cmocka_unit_test(test_paper),
        cmocka_unit_test(test_author_light),
        cmocka_unit_test(test_author_gaussian),
        cmocka_unit_test(test_gaussian_paper),
        cmocka_unit_test(test_strict_zero),
        cmocka_unit_test(test_smoothing),
        cmocka_unit_test(test_no_occlusion),
        cmocka_unit_test(test_luminance_preserving),
        cmocka_unit_test(test_show),
        cmocka_unit_test(test_present),
        cmocka_unit_test(test_host_depth),
        cmocka_unit_test(test_soft_trails),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
