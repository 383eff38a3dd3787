/* Proves that the oldest platforms get the same picture: OpenGL 3.3 without extensions, where clip
 * depth is -1..1 and GLSL has no `precise`, within a tolerance of the last bits; and Vulkan 1.2
 * with the two extensions, to the bit. */
#include "gl_wrap.h"
#include "render_host.h"

#include <stdlib.h>
#include <string.h>

static render_device usual, masked;
static render_lines tangle;

static void shoot(render_device *device, int reversed, render_result *result) {
    render_shot shot;
    lao_settings settings;
    memset(&shot, 0, sizeof shot);
    memset(&settings, 0, sizeof settings);
    settings.width = 0.8f;
    settings.samples = 20;
    shot.width = 71;
    shot.height = 63;
    shot.camera = render_camera(0.2, 0.3, 1, 32);
    render_perspective(&shot.camera, 40, 71.0 / 63.0, 16, 48);
    if (reversed)
        render_reverse(&shot.camera);
    shot.lines[0] = &tangle;
    shot.settings[0] = &settings;
    shot.set_count = 1;
    shot.background[2] = 0.5f;
    shot.background[3] = 1;
    shot.target = RENDER_TARGET_RGBA8;
    render_draw(device, &shot, result);
}

static int close_both(void **state) {
    (void)state;
    render_close(&usual);
    render_close(&masked);
    gl_wrap_reset();
    return 0;
}

/* Measured on llvmpipe: z buffer off by 3e-6 because (2 z - w + w) / 2 loses bits, occlusion by
 * 7e-7 because nothing forbids reordering, 1 of 4473 bytes of the picture by 1; all else equal. */
static void within(const char *name, render_difference d, uint32_t size) {
    if (strcmp(name, "zbuffer") == 0 || strcmp(name, "ao") == 0)
        assert_true(d.mean < 1e-6);
    else /* who covers a pixel may change where two are equally near */
        assert_true(d.texels <= size / 200);
    if (strcmp(name, "zbuffer") == 0 && usual.software)
        assert_true(d.texels > 0); /* the mask works */
}

static void test_gl33(void **state) {
    (void)state;
    render_open_gl(&usual, NULL);
    gl_wrap_reset();
    gl_wrap.floor = 1;
    render_open_gl(&masked, gl_wrap_proc);
    render_need(&usual);
    render_need(&masked);
    for (int reversed = 0; reversed < 2; reversed++) {
        render_result a, b;
        shoot(&usual, reversed, &a);
        shoot(&masked, reversed, &b);
        assert_int_equal(a.count, b.count);
        for (uint32_t i = 0; i < a.count; i++) {
            const render_image *other = render_find(&b, a.images[i].name, a.images[i].level);
            within(a.images[i].name, render_compare("floor", &a.images[i], other),
                   other->width * other->height);
        }
        assert_int_equal(render_compare("target", render_find(&b, "out", 0), &b.target).texels, 0);
        render_free(&a);
        render_free(&b);
    }
}

static void test_vk12(void **state) {
    (void)state;
    render_open_vk(&usual, 0);
    render_open_vk(&masked, VK_API_VERSION_1_2);
    render_need(&usual);
    render_need(&masked);
    assert_true(host_vk_api_version(masked.vk) == VK_API_VERSION_1_2);
    for (int reversed = 0; reversed < 2; reversed++) {
        render_result a, b;
        shoot(&usual, reversed, &a);
        shoot(&masked, reversed, &b);
        assert_int_equal(a.count, b.count);
        render_same_images("Vulkan 1.2", &a, &b);
        assert_int_equal(render_compare("target", &a.target, &b.target).texels, 0);
        render_free(&a);
        render_free(&b);
    }
}

static int setup(void **state) {
    (void)state;
    render_scatter(&tangle, 100, 3, 12, 9, 7);
    render_scene(&tangle, "helix", 10, 0.2, 0, 0, 0);
    return 0;
}

static int teardown(void **state) {
    (void)state;
    render_lines_free(&tangle);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_gl33, close_both),
        cmocka_unit_test_teardown(test_vk12, close_both),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
