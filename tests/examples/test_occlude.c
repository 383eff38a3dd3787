/* Proves that a G-buffer which a host drew is occluded and shaded as our own: the images that
 * lao_render made of a scene, uploaded again as the host's, give the same picture bit by bit. */
#include "camera.h"
#include "host_gl.h"
#include "host_vk.h"
#include "lineao.h"
#include "scene.h"

#include <GL/glcorearb.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 120, HEIGHT = 90, GBUFFER = 3 };

/* The images of a G-buffer as the header names them, with the formats of either backend. */
static const struct gbuffer_row {
    const char *name;
    uint32_t texel_bytes;
    GLint gl_internal;
    GLenum gl_format, gl_type;
    VkFormat vk_format;
} gbuffer_rows[GBUFFER] = {
    {"color", 4, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, VK_FORMAT_R8G8B8A8_UNORM},
    {"tangent", 8, GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, VK_FORMAT_R16G16B16A16_SFLOAT},
    {"depth", 4, GL_R32F, GL_RED, GL_FLOAT, VK_FORMAT_R32_SFLOAT},
};

/* One case: settings by text, and the camera's kind. */
typedef struct variant {
    const char *name;
    const char *settings[3]; /* "name=value" */
    bool ortho;
} variant;

static const variant variants[] = {
    {"default", {NULL, NULL, NULL}, false},
    {"classic, one sample", {"preset=classic", "supersampling=1", NULL}, false},
    {"paper, author's light, orthographic", {"preset=paper", "light=author", "levels=4"}, true},
};

/* A context on either backend, and what it draws. */
typedef struct fixture {
    host_gl *gl;
    host_vk *vk;
    lao_context *context;
    lao_view view;
    VkCommandBuffer commands;
} fixture;

static void on_log(void *user, lao_log_item item, lao_result result, const char *text) {
    (void)user, (void)item, (void)result;
    print_error("lineao: %s\n", text);
}

static void fixture_open(fixture *f, bool vulkan) {
    char error[HOST_ERROR_SIZE] = "";
    lao_backend backend;
    lao_desc desc = {.backend = &backend, .logger = {on_log, NULL}};
    memset(f, 0, sizeof *f);
    if (vulkan) {
        host_vk_desc wanted = {.synchronization_validation = true};
        if (!host_vk_open(&wanted, &f->vk, error))
            fail_msg("%s", error);
        lao_vk_desc vk = {.instance = host_vk_instance(f->vk),
                          .physical_device = host_vk_physical(f->vk),
                          .device = host_vk_device(f->vk),
                          .queue = host_vk_queue(f->vk),
                          .queue_family = host_vk_family(f->vk)};
        PFN_vkGetInstanceProcAddr get_proc = host_vk_get_instance_proc(f->vk);
        memcpy(&vk.get_instance_proc, &get_proc, sizeof get_proc);
        assert_int_equal(lao_vk_backend(&vk, &backend), LAO_OK);
    } else {
        lao_gl_desc gl = {.get_proc = host_gl_get_proc};
        if (!host_gl_open(NULL, &f->gl, error))
            fail_msg("%s", error);
        assert_int_equal(lao_gl_backend(&gl, &backend), LAO_OK);
    }
    assert_int_equal(lao_create(&desc, &f->context), LAO_OK);
    lao_view_desc size = {WIDTH, HEIGHT, LAO_VIEW_KEEP_IMAGES};
    assert_int_equal(lao_view_create(f->context, &size, &f->view), LAO_OK);
}

static void fixture_close(fixture *f) {
    lao_destroy(f->context);
    host_gl_close(f->gl);
    if (f->vk && host_vk_messages(f->vk) > 0)
        print_error("%.300s\n", host_vk_first_message(f->vk));
    assert_int_equal(host_vk_close(f->vk), 0);
}

/* lao_render, or lao_occlude when the frame has no sets; on Vulkan with commands around it. */
static void run_frame(fixture *f, lao_frame *frame, const lao_settings *settings) {
    frame->commands = f->vk ? host_vk_begin(f->vk) : NULL;
    assert_int_equal(frame->set_count ? lao_render(f->context, frame)
                                      : lao_occlude(f->context, frame, settings),
                     LAO_OK);
    if (f->vk)
        assert_true(host_vk_submit_and_wait(f->vk, (VkCommandBuffer)frame->commands));
}

/* An image of the last frame, as stored; for free(). */
static uint8_t *read_image(fixture *f, const char *name, uint32_t texel_bytes, size_t *size,
                           lao_read_info *info) {
    assert_int_equal(lao_read_raw(f->context, f->view, name, 0, NULL, 0, info), LAO_OK);
    *size = (size_t)info->width * info->height * texel_bytes;
    uint8_t *data = (uint8_t *)malloc(*size);
    assert_non_null(data);
    assert_int_equal(lao_read_raw(f->context, f->view, name, 0, data, *size, info), LAO_OK);
    return data;
}

static lao_image gl_upload(const struct gbuffer_row *row, uint32_t width, uint32_t height,
                           const uint8_t *data) {
    void *addresses[3] = {host_gl_get_proc("glGenTextures", NULL),
                          host_gl_get_proc("glBindTexture", NULL),
                          host_gl_get_proc("glTexImage2D", NULL)};
    PFNGLGENTEXTURESPROC gen_textures;
    PFNGLBINDTEXTUREPROC bind_texture;
    PFNGLTEXIMAGE2DPROC tex_image;
    GLuint texture;
    memcpy(&gen_textures, &addresses[0], sizeof gen_textures);
    memcpy(&bind_texture, &addresses[1], sizeof bind_texture);
    memcpy(&tex_image, &addresses[2], sizeof tex_image);
    gen_textures(1, &texture);
    bind_texture(GL_TEXTURE_2D, texture);
    tex_image(GL_TEXTURE_2D, 0, row->gl_internal, (GLsizei)width, (GLsizei)height, 0,
              row->gl_format, row->gl_type, data);
    return (lao_image){.native = texture, .width = width, .height = height, .present = 1};
}

/* A Vulkan image that the CPU fills in place. */
typedef struct upload {
    VkImage image;
    VkImageView view;
    VkDeviceMemory memory;
} upload;

static VkDeviceMemory vk_memory(host_vk *host, VkImage image) {
    const VkMemoryPropertyFlags seen =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkMemoryRequirements needs;
    VkPhysicalDeviceMemoryProperties has;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    vkGetImageMemoryRequirements(host_vk_device(host), image, &needs);
    vkGetPhysicalDeviceMemoryProperties(host_vk_physical(host), &has);
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                 .allocationSize = needs.size};
    while (info.memoryTypeIndex < has.memoryTypeCount &&
           (!(needs.memoryTypeBits >> info.memoryTypeIndex & 1) ||
            (has.memoryTypes[info.memoryTypeIndex].propertyFlags & seen) != seen))
        info.memoryTypeIndex++;
    assert_int_equal(vkAllocateMemory(host_vk_device(host), &info, NULL, &memory), VK_SUCCESS);
    assert_int_equal(vkBindImageMemory(host_vk_device(host), image, memory, 0), VK_SUCCESS);
    return memory;
}

static void vk_fill(VkDevice device, const upload *out, const uint8_t *data, size_t row_bytes,
                    uint32_t height) {
    const VkImageSubresource color = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0};
    VkSubresourceLayout rows;
    void *mapped;
    vkGetImageSubresourceLayout(device, out->image, &color, &rows);
    assert_int_equal(vkMapMemory(device, out->memory, 0, VK_WHOLE_SIZE, 0, &mapped), VK_SUCCESS);
    for (uint32_t y = 0; y < height; y++)
        memcpy((uint8_t *)mapped + rows.offset + y * rows.rowPitch, data + y * row_bytes,
               row_bytes);
    vkUnmapMemory(device, out->memory);
}

static lao_image vk_upload(host_vk *host, const struct gbuffer_row *row, uint32_t width,
                           uint32_t height, const uint8_t *data, upload *out) {
    VkDevice device = host_vk_device(host);
    const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                    .imageType = VK_IMAGE_TYPE_2D,
                                    .format = row->vk_format,
                                    .extent = {width, height, 1},
                                    .mipLevels = 1,
                                    .arrayLayers = 1,
                                    .samples = VK_SAMPLE_COUNT_1_BIT,
                                    .tiling = VK_IMAGE_TILING_LINEAR,
                                    .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                                    .initialLayout = VK_IMAGE_LAYOUT_PREINITIALIZED};
    assert_int_equal(vkCreateImage(device, &info, NULL, &out->image), VK_SUCCESS);
    out->memory = vk_memory(host, out->image);
    vk_fill(device, out, data, (size_t)width * row->texel_bytes, height);
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = out->image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = row->vk_format,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    assert_int_equal(vkCreateImageView(device, &view, NULL, &out->view), VK_SUCCESS);
    lao_image lent = {.width = width, .height = height, .present = 1};
    memcpy(&lent.native, &out->image, sizeof out->image);
    memcpy(&lent.native_view, &out->view, sizeof out->view);
    lent.native_format = (uint32_t)row->vk_format;
    lent.layout_before = VK_IMAGE_LAYOUT_PREINITIALIZED;
    lent.layout_after = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    lent.stage_before = VK_PIPELINE_STAGE_2_HOST_BIT;
    lent.access_before = VK_ACCESS_2_HOST_WRITE_BIT;
    return lent;
}

static void variant_settings(const variant *v, float width, lao_settings *settings) {
    memset(settings, 0, sizeof *settings);
    settings->width = width;
    for (size_t i = 0; i < 3 && v->settings[i]; i++) {
        char name[64];
        const char *value = strchr(v->settings[i], '=') + 1;
        snprintf(name, sizeof name, "%.*s", (int)(value - 1 - v->settings[i]), v->settings[i]);
        int setting = lao_setting_find(lao_lines_module(), name);
        assert_int_equal(lao_setting_parse(lao_lines_module(), setting, value, settings), 0);
    }
}

static void frame_scene(const variant *v, const scene_lines *scene, const float box[2][3],
                        lao_frame *frame) {
    camera_pose pose;
    double center[3], squared = 0;
    camera_frame(box[0], box[1], scene->points, scene->point_count, scene->view_direction,
                 scene->up, (double)WIDTH / HEIGHT, 0.05, &pose);
    for (int k = 0; k < 3; k++) {
        center[k] = 0.5 * (box[0][k] + box[1][k]);
        squared += 0.25 * (box[1][k] - box[0][k]) * (box[1][k] - box[0][k]);
        frame->sphere[k] = (float)center[k];
    }
    frame->sphere[3] = (float)sqrt(squared);
    if (v->ortho) {
        pose.fovy = 0;
        pose.ortho_height = 1.2 * sqrt(squared);
    }
    camera_matrices(&pose, (double)WIDTH / HEIGHT, center, sqrt(squared), true, frame->camera.view,
                    frame->camera.projection);
    frame->camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    frame->background[0] = frame->background[3] = 1;
}

static void check_variant(fixture *f, const variant *v) {
    scene_lines scene;
    lao_settings settings;
    lao_lines_desc desc = {0};
    lao_set set = {.settings = &settings};
    lao_frame frame = {.view = f->view, .sets = &set, .set_count = 1};
    lao_import imports[GBUFFER];
    lao_read_info info;
    uint8_t *data[GBUFFER], *ours, *theirs;
    upload uploads[GBUFFER] = {{0}};
    float box[2][3];
    size_t size, covered = 0;
    assert_true(scene_make("crossing", 120, 0, &scene));
    variant_settings(v, scene.width, &settings);
    desc.line_count = scene.line_count;
    desc.point_count = scene.point_count;
    desc.offsets = scene.offsets;
    desc.points = scene.points;
    assert_int_equal(lao_lines_create(f->context, &desc, &set.lines), LAO_OK);
    assert_int_equal(lao_lines_bounds(f->context, set.lines, box), LAO_OK);
    frame_scene(v, &scene, (const float(*)[3])box, &frame);

    run_frame(f, &frame, NULL);
    ours = read_image(f, "out", 4, &size, &info);
    for (size_t i = 0; i < size; i += 4)
        covered += ours[i + 2] > 0; /* the background is red */
    assert_in_range(covered, WIDTH * HEIGHT / 10, WIDTH * HEIGHT - 1);
    for (size_t i = 0; i < GBUFFER; i++) {
        const struct gbuffer_row *row = &gbuffer_rows[i];
        data[i] = read_image(f, row->name, row->texel_bytes, &size, &info);
        imports[i].image = row->name;
        imports[i].source =
            f->vk ? vk_upload(f->vk, row, info.width, info.height, data[i], &uploads[i])
                  : gl_upload(row, info.width, info.height, data[i]);
    }

    frame.sets = NULL;
    frame.set_count = 0;
    frame.imports = imports;
    frame.import_count = GBUFFER;
    for (int pass = 0; pass < 2; pass++) { /* the second time the plan is there already */
        run_frame(f, &frame, &settings);
        theirs = read_image(f, "out", 4, &size, &info);
        size_t different = 0;
        for (size_t i = 0; i < size; i++)
            different += ours[i] != theirs[i];
        if (different)
            fail_msg("%s, %s: %zu of %zu bytes differ", f->vk ? "vk" : "gl", v->name, different,
                     size);
        free(theirs);
        for (size_t i = 0; i < GBUFFER && f->vk; i++)
            imports[i].source.layout_before = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    }
    free(ours);
    for (size_t i = 0; i < GBUFFER; i++) {
        free(data[i]);
        if (f->vk) {
            vkDestroyImageView(host_vk_device(f->vk), uploads[i].view, NULL);
            vkDestroyImage(host_vk_device(f->vk), uploads[i].image, NULL);
            vkFreeMemory(host_vk_device(f->vk), uploads[i].memory, NULL);
        }
    }
    assert_int_equal(lao_lines_destroy(f->context, set.lines), LAO_OK);
    scene_free(&scene);
}

static void check_backend(bool vulkan) {
    fixture f;
    fixture_open(&f, vulkan);
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++)
        check_variant(&f, &variants[i]);
    fixture_close(&f);
}

static void test_gl(void **state) {
    (void)state;
    check_backend(false);
}

static void test_vk(void **state) {
    (void)state;
    check_backend(true);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_gl), cmocka_unit_test(test_vk)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
