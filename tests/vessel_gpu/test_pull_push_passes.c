/* The passes that fill a host's own image give the bits of sdv_pull_push, on OpenGL and on Vulkan,
   for both pulls and pushes, any exponent and size, and write the result into the host's image. */
#include "render_host.h"
#include "sdfvessel.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 64 * 64 };

/* A few weighted pixels; kind 0: none. Weights that are no numbers or negative count as 0. */
static void scatter(uint32_t kind, uint32_t count, float *texels) {
    uint32_t seed = 7 * kind + 1;
    for (uint32_t i = 0; i < count; i++) {
        float *t = texels + 4 * (size_t)i;
        for (int k = 0; k < 4; k++) {
            seed = seed * 1664525u + 1013904223u;
            t[k] = (float)(seed >> 8) / 16777216.0f;
        }
        t[0] = 100 * t[0] - 50;
        t[3] = kind == 0 ? 0 : t[3] < 0.1f ? 10 * t[3] : i % 5 == 0 ? -1.0f : 0;
    }
}

static void fill_in_c(const sdv_pull_push_settings *s, uint32_t width, uint32_t height,
                      const float *texels, float *filled) {
    static float values[3 * MOST], weights[MOST];
    sdv_pull_push_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.width = width;
    desc.height = height;
    desc.channels = 3;
    desc.values = values;
    desc.weights = weights;
    desc.pull = (uint32_t)s->pull;
    desc.push = (uint32_t)s->push;
    desc.exponent = (uint32_t)s->exponent;
    for (uint32_t i = 0; i < width * height; i++) {
        memcpy(values + 3 * (size_t)i, texels + 4 * (size_t)i, 3 * sizeof *values);
        weights[i] = texels[4 * (size_t)i + 3];
    }
    assert_int_equal(sdv_pull_push(NULL, &desc, NULL), LAO_OK);
    for (uint32_t i = 0; i < width * height; i++) {
        memcpy(filled + 4 * (size_t)i, values + 3 * (size_t)i, 3 * sizeof *values);
        filled[4 * (size_t)i + 3] = weights[i];
    }
}

static void check(const sdv_pull_push_settings *s, uint32_t kind, uint32_t width, uint32_t height) {
    static float texels[4 * MOST], filled[4 * MOST], nothing[4 * MOST];
    const void *settings[1] = {s};
    lao_settings lines;
    const render_image images[2] = {
        {"pull_push_image", 0, width, height, LAO_FORMAT_RGBA32F, (uint8_t *)texels},
        {"pull_push_result", 0, width, height, LAO_FORMAT_RGBA32F, (uint8_t *)nothing}};
    render_shot shot;
    memset(&shot, 0, sizeof shot);
    memset(&lines, 0, sizeof lines);
    lines.set = LAO_SET(occlusion);
    scatter(kind, width * height, texels);
    fill_in_c(s, width, height, texels, filled);
    shot.width = width;
    shot.height = height;
    shot.set_count = 1;
    shot.settings[0] = &lines;
    shot.module_settings[0] = settings;
    shot.imports = images;
    shot.import_count = 2;
    shot.sphere[3] = 1;
    shot.camera = render_camera(0, 0, 1, 5);
    render_perspective(&shot.camera, 40, (double)width / height, 1, 10);
    for (int i = 0; i < 2; i++) {
        render_result result;
        const render_image *ours;
        render_need(&render_devices[i]);
        render_draw(&render_devices[i], &shot, &result);
        ours = render_find(&result, "pull_push_filled", 0);
        assert_non_null(ours);
        assert_int_equal(ours->width * ours->height, width * height);
        assert_memory_equal(ours->data, filled, width * height * 4 * sizeof *filled);
        assert_memory_equal(result.import_after.data, filled, width * height * 4 * sizeof *filled);
        render_free(&result);
    }
}

static void as_in_c(void **state) {
    (void)state;
    for (int pull = 0; pull < 2; pull++) {
        for (int push = 0; push < 2; push++) {
            for (int k = 1; k <= 25; k += 24) {
                sdv_pull_push_settings s;
                memset(&s, 0, sizeof s);
                s.set = 7;
                s.pull = (float)pull;
                s.push = (float)push;
                s.exponent = (float)k;
                check(&s, 1 + (uint32_t)k, 49, 35);
            }
        }
    }
}

static void any_size_and_nothing(void **state) {
    static const uint32_t sizes[][2] = {{1, 1}, {3, 5}, {64, 64}, {1, 17}};
    sdv_pull_push_settings s;
    (void)state;
    memset(&s, 0, sizeof s);
    s.exponent = 25;
    s.push = SDV_PUSH_SPLINE;
    s.set = 6;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        check(&s, 3, sizes[i][0], sizes[i][1]);
    check(&s, 0, 33, 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(as_in_c),
                                       cmocka_unit_test(any_size_and_nothing)};
    render_module(sdv_pull_push_module());
    return cmocka_run_group_tests(tests, render_open_both, render_close_both);
}
