/* Proves that a full-screen pass over one texel per vertex, which walks the buffers of
   vsf_buffers_make, gives the bits of vsf_measure, on OpenGL and on Vulkan, and that the functions
   of the shared text give those of C. */
#include "surface_host.h"
#include "surface_mirror.h"

#include "host_gl.h"
#include "host_vk.h"
#ifdef MIRROR_WORDS
#include "surface_mirror.words.h"
#endif

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { TEXT = 65536, ROWS = 4, WIDTH = 2048 };

/* ---- the module */

static char shared_text[TEXT], mirror_text[TEXT], pass_text[TEXT];
static const char *const lines[] = {"#ifndef VSF_FAR\n", shared_text, "#endif\n", mirror_text,
                                    pass_text};
static const char *const image_names[ROWS] = {"surface_row0", "surface_row1", "surface_row2",
                                              "surface_row3"};
static const char *const texture_names[] = {"points", "normals", "rings"};
static const lao_texture_type texture_types[] = {LAO_TEXTURE_BUFFER, LAO_TEXTURE_BUFFER,
                                                 LAO_TEXTURE_BUFFER};
static lao_shader shader;
static lao_image_row images[ROWS];
static lao_pass_row pass;
static lao_module module;

static void load(const char *name, char *text) {
    char path[1024];
    FILE *file;
    size_t n;
    snprintf(path, sizeof path, "%s/%s", LINEAO_SOURCE_DIR, name);
    file = fopen(path, "r");
    assert_non_null(file);
    n = fread(text, 1, TEXT - 1, file);
    text[n] = 0;
    fclose(file);
}

static int module_make(void **state) {
    char *begin, *end;
    (void)state;
    load("vesselsurface.h", shared_text); /* its beginning: the declarations and the shared text */
    begin = strstr(shared_text, "/* VSF_SHARED_BEGIN */");
    end = strstr(shared_text, "/* VSF_SHARED_END */");
    assert_true(begin && end);
    *end = 0;
    memmove(shared_text, begin, strlen(begin) + 1);
    load("tests/surface/surface_mirror.h", mirror_text);
    load("tests/surface/surface_mirror.glsl", pass_text);
    shader.name = "surface_mirror";
    shader.output_count = ROWS;
    shader.texture_names = texture_names;
    shader.texture_types = texture_types;
    shader.texture_count = 3;
    shader.fragment.lines = lines;
    shader.fragment.line_count = 5;
#ifdef MIRROR_WORDS
    shader.fragment.words = surface_mirror_words;
    shader.fragment.word_count =
        (uint32_t)(sizeof surface_mirror_words / sizeof surface_mirror_words[0]);
#endif
    pass.name = "surface_mirror_pass";
    pass.shader = "surface_mirror";
    pass.scope = LAO_SCOPE_PER_SET;
    for (int i = 0; i < ROWS; i++) {
        images[i].name = image_names[i];
        images[i].format = LAO_FORMAT_RGBA32F;
        images[i].size = LAO_SIZE_ITEMS;
        images[i].flags = LAO_IMAGE_HISTORY; /* counts as an output */
        pass.writes[i].image = image_names[i];
        pass.writes[i].load = LAO_LOAD_DISCARD;
    }
    pass.reads[0].image = "#surface_points";
    pass.reads[1].image = "#surface_normals";
    pass.reads[2].image = "#surface_rings";
    module.name = "surface_mirror";
    module.passes = &pass;
    module.pass_count = 1;
    module.images = images;
    module.image_count = ROWS;
    module.shaders = &shader;
    module.shader_count = 1;
    module.buffers = vsf_buffer_rows(&module.buffer_count);
    return 0;
}

/* ---- a mesh with obtuse triangles, a border and more than one row of texels */

static vsf_mesh mesh;
static vsf_buffers buffers;
static float *wanted, *got;

static lao_camera camera_make(int orthographic) {
    /* a turn about y and a tilt, 30 mm away */
    static const float view[16] = {0.8f, 0.36f,  -0.48f, 0, 0, 0.8f, 0.6f, 0,
                                   0.6f, -0.48f, 0.64f,  0, 1, 2,    -30,  1};
    lao_camera c;
    memset(&c, 0, sizeof c);
    memcpy(c.view, view, sizeof view);
    c.flags = LAO_CAMERA_ZERO_TO_ONE;
    c.projection[0] = c.projection[5] = orthographic ? 0.1f : 1.5f;
    c.projection[10] = orthographic ? -0.01f : -1.01f;
    c.projection[11] = orthographic ? 0 : -1;
    c.projection[14] = orthographic ? 0 : -1.01f;
    c.projection[15] = orthographic ? 1 : 0;
    return c;
}

static void surface_make(void) {
    surface_shape shape = surface_torus(5, 2, 120, 60);
    uint32_t seed = 20;
    for (uint32_t i = 0; i < 3 * shape.vertex_count; i++)
        shape.positions[i] += (float)lent_between(&seed, -0.05, 0.05);
    shape.triangle_count -= 500;
    mesh = surface_build(&shape, 0, 0);
    assert_int_equal(vsf_buffers_make(NULL, &mesh, 0, &buffers), LAO_OK);
    surface_shape_free(&shape);
    wanted = (float *)malloc(sizeof(float) * 4 * mesh.vertex_count * ROWS);
    got = (float *)malloc(sizeof(float) * 4 * WIDTH * 4);
}

static void evaluate_in_c(const lao_camera *camera, int orthographic) {
    lao_camera canonical;
    lao_m4 view;
    lao_v4 eye;
    float eye_numbers[4], *s = (float *)malloc(sizeof(float) * mesh.vertex_count);
    const float *m;
    assert_int_equal(lao_camera_canonical(camera, &canonical), 0);
    m = canonical.view;
    view.x = lao_v4_make(m[0], m[1], m[2], m[3]);
    view.y = lao_v4_make(m[4], m[5], m[6], m[7]);
    view.z = lao_v4_make(m[8], m[9], m[10], m[11]);
    view.w = lao_v4_make(m[12], m[13], m[14], m[15]);
    eye = vsf_eye(view, orthographic ? 1.0f : 0.0f);
    memcpy(eye_numbers, &eye, sizeof eye);
    assert_int_equal(vsf_measure(NULL, &buffers, eye_numbers, 0, s), LAO_OK);
    for (uint32_t row = 0; row < ROWS; row++) {
        for (uint32_t v = 0; v < mesh.vertex_count; v++) {
            const float *p = mesh.positions + 3 * v, *n = mesh.normals + 3 * v;
            lao_v4 value = surface_mirror(row, s[v], eye, lao_v3_make(p[0], p[1], p[2]),
                                          lao_v3_make(n[0], n[1], n[2]));
            memcpy(wanted + 4 * (row * mesh.vertex_count + v), &value, sizeof value);
        }
    }
    free(s);
}

static void keep_log(void *user, lao_log_item item, lao_result result, const char *text) {
    (void)item;
    (void)result;
    snprintf((char *)user, 1000, "%s", text);
}

/* Renders both cameras; `run` records and submits on Vulkan. */
static void compare_backend(const lao_backend *backend,
                            void (*run)(void *, lao_context *, lao_frame *), void *user,
                            const char *what) {
    static const lao_module *const modules[] = {&module};
    static char text[1000];
    lao_view_desc size = {16, 16, LAO_VIEW_KEEP_IMAGES};
    lao_desc desc;
    lao_context *context;
    lao_frame frame;
    lao_set set;
    lao_settings plain;
    lao_object_buffer list[4];
    lao_object_desc object;
    memset(&desc, 0, sizeof desc);
    memset(&frame, 0, sizeof frame);
    memset(&set, 0, sizeof set);
    memset(&plain, 0, sizeof plain);
    desc.backend = backend;
    desc.logger.log = keep_log;
    desc.logger.user = text;
    desc.modules = modules;
    desc.module_count = 1;
    if (lao_create(&desc, &context) != LAO_OK)
        fail_msg("%s: %s", what, text);
    plain.set = LAO_SET(occlusion);
    set.settings = &plain;
    vsf_buffers_describe(&buffers, list, &object);
    assert_int_equal(lao_object_create(context, &object, &set.object), LAO_OK);
    assert_int_equal(lao_view_create(context, &size, &frame.view), LAO_OK);
    frame.sets = &set;
    frame.set_count = 1;
    for (int orthographic = 0; orthographic < 2; orthographic++) {
        frame.camera = camera_make(orthographic);
        evaluate_in_c(&frame.camera, orthographic);
        run(user, context, &frame);
        for (uint32_t row = 0; row < ROWS; row++) {
            uint32_t differing = 0, first = 0;
            lao_read_info info;
            if (lao_read_raw(context, frame.view, image_names[row], 0, got,
                             sizeof(float) * 4 * WIDTH * 4, &info) != LAO_OK)
                fail_msg("%s: %s", what, text);
            assert_int_equal(info.width, WIDTH);
            assert_int_equal(info.height, (mesh.vertex_count + WIDTH - 1) / WIDTH);
            for (uint32_t i = 0; i < 4 * mesh.vertex_count; i++) {
                float a = wanted[4 * row * mesh.vertex_count + i], b = got[i];
                if (memcmp(&a, &b, sizeof a) != 0 && !(a == 0 && b == 0)) {
                    first = differing ? first : i;
                    differing++;
                }
            }
            if (differing)
                fail_msg("%s, camera %d, row %u: %u values differ, first of vertex %u.%c: C %.9g, "
                         "GPU %.9g",
                         what, orthographic, row, differing, first / 4, "xyzw"[first % 4],
                         (double)wanted[4 * row * mesh.vertex_count + first], (double)got[first]);
        }
    }
    lao_destroy(context);
}

static void no_gpu(const char *error) {
    if (getenv("LINEAO_EXPECT_GPU"))
        fail_msg("%s", error);
    print_message("%s\n", error);
    skip();
}

static void run_gl(void *user, lao_context *context, lao_frame *frame) {
    (void)user;
    assert_int_equal(lao_render(context, frame), LAO_OK);
}
static void opengl_gives_the_bits_of_c(void **state) {
    char error[HOST_ERROR_SIZE] = "";
    host_gl *gl = NULL;
    lao_gl_desc desc;
    lao_backend backend;
    (void)state;
    if (!host_gl_open(NULL, &gl, error))
        no_gpu(error);
    memset(&desc, 0, sizeof desc);
    desc.get_proc = host_gl_get_proc;
    assert_int_equal(lao_gl_backend(&desc, &backend), LAO_OK);
    compare_backend(&backend, run_gl, NULL, "OpenGL");
    host_gl_close(gl);
}

#ifdef MIRROR_WORDS
static void run_vk(void *user, lao_context *context, lao_frame *frame) {
    host_vk *vk = (host_vk *)user;
    VkCommandBuffer commands = host_vk_begin(vk);
    frame->commands = commands;
    assert_int_equal(lao_render(context, frame), LAO_OK);
    assert_true(host_vk_submit_and_wait(vk, commands));
}
static void vulkan_gives_the_bits_of_c(void **state) {
    char error[HOST_VK_ERROR_SIZE] = "";
    host_vk *vk = NULL;
    lao_vk_desc desc;
    lao_backend backend;
    (void)state;
    if (!host_vk_open(NULL, &vk, error))
        no_gpu(error);
    desc = host_vk_lend(vk);
    assert_int_equal(lao_vk_backend(&desc, &backend), LAO_OK);
    compare_backend(&backend, run_vk, vk, "Vulkan");
    host_vk_close(vk);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opengl_gives_the_bits_of_c),
#ifdef MIRROR_WORDS
        cmocka_unit_test(vulkan_gives_the_bits_of_c),
#endif
    };
    int failed;
    surface_make();
    failed = cmocka_run_group_tests(tests, module_make, NULL);
    free(wanted);
    free(got);
    vsf_buffers_free(&buffers);
    vsf_mesh_free(&mesh);
    return failed;
}
