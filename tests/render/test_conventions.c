/* Proves that a host's conventions do not show: the same camera with clip depth 0..1 or -1..1,
 * reversed or not, right- or left-handed, upside down into a top-down target, gives the same images
 * on both backends; reversed depth alone rounds differently where lines touch. */
#include "render_host.h"

#include <stdlib.h>
#include <string.h>

static render_device *const gl = &render_devices[RENDER_GL];
static render_device *const vk = &render_devices[RENDER_VK];
static render_lines tangle;

enum { NEGATIVE_ONE = 1, REVERSED = 2, LEFT_HANDED = 4, UPSIDE_DOWN = 8, COMBINATIONS = 16 };

/* Near 16 and far 48: all forms of the projection are exact in floats. */
static lao_camera convention(int orthographic, int combination) {
    lao_camera camera = render_camera(0.2, 0.3, 1, 32);
    float *p = camera.projection, *v = camera.view;
    if (orthographic)
        render_orthographic(&camera, 24, 71.0 / 63.0, 16, 48);
    else
        render_perspective(&camera, 40, 71.0 / 63.0, 16, 48);
    render_shift(&camera, 0.125, -0.25);
    if (combination & REVERSED)
        render_reverse(&camera);
    for (int c = 0; c < 4; c++) {
        if (combination & NEGATIVE_ONE)
            p[4 * c + 2] = 2 * p[4 * c + 2] - p[4 * c + 3];
        if (combination & UPSIDE_DOWN)
            p[4 * c + 1] = -p[4 * c + 1];
        if (combination & LEFT_HANDED) {
            v[4 * c + 2] = -v[4 * c + 2];
            p[8 + c] = -p[8 + c];
        }
    }
    if (combination & NEGATIVE_ONE)
        camera.flags &= ~(uint32_t)LAO_CAMERA_ZERO_TO_ONE;
    if (combination & UPSIDE_DOWN)
        camera.flags |= LAO_CAMERA_FLIP_Y;
    return camera;
}

static void shoot(render_device *device, int orthographic, int combination, render_result *result) {
    render_shot shot;
    lao_settings settings;
    memset(&shot, 0, sizeof shot);
    memset(&settings, 0, sizeof settings);
    settings.width = 0.8f;
    settings.samples = 20;
    settings.supersampling = 1;
    shot.width = 71;
    shot.height = 63;
    shot.camera = convention(orthographic, combination);
    shot.lines[0] = &tangle;
    shot.settings[0] = &settings;
    shot.set_count = 1;
    shot.background[0] = 0.5f;
    shot.background[3] = 1;
    shot.target = RENDER_TARGET_RGBA8;
    shot.target_flags = combination & UPSIDE_DOWN ? LAO_HOST_TOP_DOWN : 0;
    render_draw(device, &shot, result);
}

/* The host's image of the upside-down camera has its rows the other way round, and then is equal.
 */
static void turn_rows(render_image *image) {
    size_t row = (size_t)image->width * lao_format_bytes(image->format);
    uint8_t *copy = malloc(row * image->height);
    assert_non_null(copy);
    memcpy(copy, image->data, row * image->height);
    for (uint32_t y = 0; y < image->height; y++)
        memcpy(image->data + row * y, copy + row * (image->height - 1 - y), row);
    free(copy);
}

static void compare(const char *what, const render_result *usual, render_result *other,
                    int combination, int exact) {
    for (uint32_t i = 0; i < usual->count; i++) {
        const render_image *image = &usual->images[i];
        const render_image *same = render_find(other, image->name, image->level);
        if ((combination & REVERSED) && (strcmp(image->name, "zbuffer") == 0 ||
                                         strncmp(image->name, "far", 3) == 0)) /* taken from it */
            continue;
        if (combination & REVERSED)
            assert_true(render_compare(what, image, same).texels <=
                        image->width * image->height / 200);
        else if (exact)
            assert_int_equal(render_compare(what, image, same).texels, 0);
        else
            assert_true(render_compare(what, image, same).mean < 1e-2);
    }
    if (combination & UPSIDE_DOWN)
        turn_rows(&other->target);
    assert_int_equal(render_compare(what, render_find(other, "out", 0), &other->target).texels, 0);
}

static void conventions(render_device *device) {
    static const char *const names[] = {"0..1", "-1..1"};
    render_need(device);
    for (int orthographic = 0; orthographic < 2; orthographic++) {
        render_result usual;
        shoot(device, orthographic, 0, &usual);
        for (int combination = 0; combination < COMBINATIONS; combination++) {
            render_result other;
            shoot(device, orthographic, combination, &other);
            compare(names[combination & NEGATIVE_ONE], &usual, &other, combination,
                    device->software);
            render_free(&other);
        }
        render_free(&usual);
    }
}

static void test_gl(void **state) {
    (void)state;
    conventions(gl);
}

static void test_vk(void **state) {
    (void)state;
    conventions(vk);
}

static int setup(void **state) {
    render_scatter(&tangle, 100, 3, 12, 9, 7);
    render_scene(&tangle, "helix", 10, 0.2, 0, 0, 0);
    return render_open_both(state);
}

static int teardown(void **state) {
    render_lines_free(&tangle);
    return render_close_both(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gl),
        cmocka_unit_test(test_vk),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
