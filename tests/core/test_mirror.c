/* What the tests prove about the shared functions in C is what the GPU runs: the same lines over
   the same inputs give the same bits through C, OpenGL and Vulkan. The harness is a module of its
   own, with passes, images, settings and shaders in its tables and no word of it in a backend. */
#include "core_host.h"
#include "mirror.h"

#include "host_gl.h"
#include "host_vk.h"
#ifdef MIRROR_WORDS
#include "mirror_copy.words.h"
#include "mirror_main.words.h"
#endif

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { TEXT = 65536, VALUES = MIRROR_ROWS * MIRROR_INPUTS * 4, OFFSET = 5 };

/* --------------------------------------------------------------------------------------------------------
 * the module */

static const lao_image_row images[] = {
    {"mirror",
     LAO_FORMAT_RGBA32F,
     LAO_SIZE_FIXED,
     MIRROR_INPUTS,
     MIRROR_ROWS,
     NULL,
     0,
     LAO_ENCODING_PLAIN,
     {0, 0, 0, 0},
     {NULL, 0, 0},
     {NULL, NULL, NULL, NULL}},
    {"mirror_moved",
     LAO_FORMAT_RGBA32F,
     LAO_SIZE_FIXED,
     MIRROR_INPUTS,
     MIRROR_ROWS,
     NULL,
     LAO_IMAGE_HISTORY,
     LAO_ENCODING_PLAIN,
     {0, 0, 0, 0},
     {NULL, 0, 0},
     {NULL, NULL, NULL, NULL}},
};
static const lao_setting_row settings[] = {
    {"mirror_offset", LAO_SETTING_INT, 0, 9, OFFSET, 1, "px", "",
     "how far the second pass moves the picture"},
};
static const char *const constants[] = {"mirror_offset"};
static const char *const texture_names[] = {"source"};
static const lao_texture_type texture_types[] = {LAO_TEXTURE_2D};

static char shared_text[TEXT], main_text[TEXT], copy_text[TEXT];
static const char *const main_lines[] = {shared_text, main_text}, *const copy_lines[] = {copy_text};
static lao_shader shaders[2];
static lao_pass_row passes[2];
static lao_module module;

static void load(const char *name, char *text) {
    char path[1024];
    FILE *file;
    size_t n;
    snprintf(path, sizeof path, "%s/tests/core/%s", LINEAO_SOURCE_DIR, name);
    file = fopen(path, "r");
    assert_non_null(file);
    n = fread(text, 1, TEXT - 1, file);
    assert_true(n < TEXT - 1);
    text[n] = 0;
    fclose(file);
}

static int module_make(void **state) {
    (void)state;
    load("mirror.h", shared_text);
    load("mirror_main.glsl", main_text);
    load("mirror_copy.glsl", copy_text);
    shaders[0].name = "mirror_main";
    shaders[0].output_count = 1;
    shaders[0].fragment.lines = main_lines;
    shaders[0].fragment.line_count = 2;
    shaders[1].name = "mirror_copy";
    shaders[1].output_count = 1;
    shaders[1].constants = constants;
    shaders[1].constant_count = 1;
    shaders[1].texture_names = texture_names;
    shaders[1].texture_types = texture_types;
    shaders[1].texture_count = 1;
    shaders[1].fragment.lines = copy_lines;
    shaders[1].fragment.line_count = 1;
#ifdef MIRROR_WORDS
    shaders[0].fragment.words = mirror_main_words;
    shaders[0].fragment.word_count =
        (uint32_t)(sizeof mirror_main_words / sizeof mirror_main_words[0]);
    shaders[1].fragment.words = mirror_copy_words;
    shaders[1].fragment.word_count =
        (uint32_t)(sizeof mirror_copy_words / sizeof mirror_copy_words[0]);
#endif
    passes[0].name = "mirror_pass";
    passes[0].shader = "mirror_main";
    passes[0].writes[0].image = "mirror";
    passes[0].writes[0].load = LAO_LOAD_DISCARD;
    passes[1].name = "mirror_move_pass";
    passes[1].shader = "mirror_copy";
    passes[1].writes[0].image = "mirror_moved";
    passes[1].writes[0].load = LAO_LOAD_DISCARD;
    passes[1].reads[0].image = "mirror";
    module.name = "mirror";
    module.passes = passes;
    module.pass_count = 2;
    module.images = images;
    module.image_count = 2;
    module.settings = settings;
    module.setting_count = 1;
    module.shaders = shaders;
    module.shader_count = 2;
    return 0;
}

/* ---------------------------------------------------------------------------------------------------------
 * both ways */

static float wanted[VALUES], got[VALUES], moved[VALUES], other[VALUES], of_gl[VALUES];
static int has_gl;

static void evaluate_in_c(void) {
    for (uint32_t row = 0; row < MIRROR_ROWS; row++) {
        for (uint32_t n = 0; n < MIRROR_INPUTS; n++) {
            lao_v4 v = mirror(row, n);
            memcpy(wanted + 4 * (row * MIRROR_INPUTS + n), &v, sizeof v);
        }
    }
}

/* Bit by bit. `either_zero`: 0 and -0 are the same, because Mesa drops the addition in x + 0 even
 * where it is precise. */
static void compare(const float *a, const float *b, int either_zero, const char *what) {
    uint32_t rows = 0, values = 0;
    for (uint32_t row = 0; row < MIRROR_ROWS; row++) {
        uint32_t differing = 0;
        for (uint32_t i = 0; i < MIRROR_INPUTS * 4; i++) {
            uint32_t k = row * MIRROR_INPUTS * 4 + i;
            if (memcmp(a + k, b + k, sizeof *a) != 0 && !(either_zero && a[k] == 0 && b[k] == 0)) {
                if (differing++ == 0) {
                    fprintf(stderr, "%s: row %u input %u.%c: %.9g (%08x), %.9g (%08x)\n", what, row,
                            i / 4, "xyzw"[i % 4], (double)a[k], lao_float_bits(a[k]), (double)b[k],
                            lao_float_bits(b[k]));
                }
            }
        }
        if (differing) {
            fprintf(stderr, "%s: row %u: %u of %u values differ\n", what, row, differing,
                    MIRROR_INPUTS * 4);
        }
        rows += differing > 0;
        values += differing;
    }
    if (values) {
        fail_msg("%s: %u values in %u rows differ", what, values, rows);
    }
}

static lao_context *context_make(const lao_backend *backend, core_host *host, lao_frame *frame) {
    static const lao_module *const modules[] = {&module};
    lao_view_desc size = {16, 16, 0};
    lao_desc desc;
    lao_context *context;
    memset(host, 0, sizeof *host);
    memset(&desc, 0, sizeof desc);
    memset(frame, 0, sizeof *frame);
    desc.backend = backend;
    desc.allocator = lent_allocator(&host->memory);
    desc.logger = core_logger(host);
    desc.modules = modules;
    desc.module_count = 1;
    if (lao_create(&desc, &context) != LAO_OK) {
        fail_msg("%s", host->text);
    }
    size.flags = LAO_VIEW_KEEP_IMAGES;
    assert_int_equal(lao_view_create(context, &size, &frame->view), LAO_OK);
    frame->camera = core_camera();
    { /* no occlusion: its shader takes seconds to compile, and is not what is looked at here */
        static lao_settings plain;
        static lao_set set;
        lao_lines_desc none;
        memset(&none, 0, sizeof none);
        plain.set = LAO_SET(occlusion);
        set.settings = &plain;
        assert_int_equal(lao_lines_create(context, &none, &set.lines), LAO_OK);
        frame->sets = &set;
        frame->set_count = 1;
    }
    return context;
}

static void results_read(lao_context *context, const core_host *host, const lao_frame *frame) {
    lao_read_info info;
    if (lao_read_raw(context, frame->view, "mirror", 0, got, sizeof got, &info) != LAO_OK ||
        lao_read_raw(context, frame->view, "mirror_moved", 0, moved, sizeof moved, &info) !=
            LAO_OK) {
        fail_msg("%s", host->text);
    }
    assert_int_equal(info.width, MIRROR_INPUTS);
    assert_int_equal(info.height, MIRROR_ROWS);
    for (uint32_t i = 0; i < MIRROR_ROWS * MIRROR_INPUTS; i++) {
        uint32_t n = (i % MIRROR_INPUTS + OFFSET) % MIRROR_INPUTS;
        memcpy(other + 4 * i, got + 4 * (i - i % MIRROR_INPUTS + n), 4 * sizeof(float));
    }
}

static void no_gpu(const char *error) {
    if (getenv("LINEAO_EXPECT_GPU")) {
        fail_msg("%s", error);
    }
    print_message("%s\n", error);
    skip();
}

static void inputs_are_numbers(void **state) {
    (void)state;
    evaluate_in_c();
    for (uint32_t i = 0; i < VALUES; i++) {
        if (!(wanted[i] - wanted[i] == 0)) {
            fail_msg("row %u, input %u: %g", i / (4 * MIRROR_INPUTS), i / 4 % MIRROR_INPUTS,
                     (double)wanted[i]);
        }
    }
    for (uint32_t row = 0; row + 1 < MIRROR_ROWS; row++) { /* and no row is one number only */
        const float *v = wanted + row * MIRROR_INPUTS * 4;
        uint32_t different = 0;
        for (uint32_t n = 1; n < MIRROR_INPUTS; n++) {
            different += memcmp(v, v + 4 * n, 4 * sizeof *v) != 0;
        }
        assert_true(different > MIRROR_INPUTS / 4);
    }
}

static void opengl_gives_the_bits_of_c(void **state) {
    char error[HOST_ERROR_SIZE] = "";
    host_gl *gl = NULL;
    lao_gl_desc desc;
    lao_backend backend;
    core_host host;
    lao_frame frame;
    lao_context *context;
    (void)state;
    if (!host_gl_open(NULL, &gl, error)) {
        no_gpu(error);
    }
    memset(&desc, 0, sizeof desc);
    desc.get_proc = host_gl_get_proc;
    assert_int_equal(lao_gl_backend(&desc, &backend), LAO_OK);
    context = context_make(&backend, &host, &frame);
    if (lao_render(context, &frame) != LAO_OK) {
        fail_msg("%s", host.text);
    }
    results_read(context, &host, &frame);
    evaluate_in_c();
    compare(wanted, got, 1, "C, GL");
    memcpy(of_gl, got, sizeof got);
    has_gl = 1;
    compare(other, moved, 0, "GL, moved by the second pass");
    lao_destroy(context);
    assert_int_equal(host.memory.bytes, 0);
    host_gl_close(gl);
}

static void vulkan_gives_the_bits_of_c(void **state) {
    (void)state;
#ifdef MIRROR_WORDS
    {
        char error[HOST_VK_ERROR_SIZE] = "";
        host_vk *vk = NULL;
        lao_vk_desc desc;
        lao_backend backend;
        core_host host;
        lao_frame frame;
        lao_context *context;
        VkCommandBuffer commands;
        if (!host_vk_open(NULL, &vk, error)) {
            no_gpu(error);
        }
        desc = host_vk_lend(vk);
        assert_int_equal(lao_vk_backend(&desc, &backend), LAO_OK);
        context = context_make(&backend, &host, &frame);
        commands = host_vk_begin(vk);
        frame.commands = commands;
        if (lao_render(context, &frame) != LAO_OK) {
            fail_msg("%s", host.text);
        }
        assert_true(host_vk_submit_and_wait(vk, commands));
        results_read(context, &host, &frame);
        evaluate_in_c();
        compare(wanted, got, 1, "C, Vulkan");
        if (has_gl) {
            compare(of_gl, got, 0, "GL, Vulkan");
        }
        compare(other, moved, 0, "Vulkan, moved by the second pass");
        lao_destroy(context);
        assert_int_equal(host.memory.bytes, 0);
        host_vk_close(vk);
    }
#else
    print_message("glslangValidator was not there when this was built\n");
    skip();
#endif
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inputs_are_numbers),
        cmocka_unit_test(opengl_gives_the_bits_of_c),
        cmocka_unit_test(vulkan_gives_the_bits_of_c),
    };
    return cmocka_run_group_tests(tests, module_make, NULL);
}
