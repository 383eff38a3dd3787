#include "vk_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void on_message(void *user, const char *text) {
    (void)user;
    print_message("%s\n", text);
}

void fixture_open(fixture *f, uint32_t api_version) {
    char error[HOST_VK_ERROR_SIZE];
    host_vk_desc desc;
    memset(f, 0, sizeof *f);
    memset(&desc, 0, sizeof desc);
    desc.synchronization_validation = true;
    desc.api_version = api_version;
    desc.message = on_message;
    vk_wrap_reset();
    if (host_vk_open(&desc, &f->host, error))
        return;
    print_message("%s\n", error);
    if (getenv("LINEAO_EXPECT_GPU"))
        fail_msg("LINEAO_EXPECT_GPU is set");
    skip();
}

void fixture_close(fixture *f) {
    uint32_t messages = host_vk_close(f->host);
    assert_int_equal(messages, 0);
    assert_int_equal(f->memory.bytes, 0);
}

static void on_log(void *user, lao_log_item item, lao_result result, const char *text) {
    fixture *f = user;
    (void)result;
    f->logs++;
    f->item = item;
    snprintf(f->text, sizeof f->text, "%s", text);
}

lao_result fixture_context(fixture *f, int queue, lao_context **context) {
    lao_vk_desc vk;
    lao_backend backend;
    lao_desc desc;
    vk = host_vk_lend(f->host);
    vk.get_instance_proc = vk_wrap_proc;
    vk.debug_utils = 1; /* the host enables it with the validation layer */
    vk.queue = queue ? vk.queue : NULL;
    vk.frames_in_flight = FIXTURE_FRAMES;
    assert_int_equal(lao_vk_backend(&vk, &backend), LAO_OK);
    memset(&desc, 0, sizeof desc);
    desc.backend = &backend;
    desc.allocator = lent_allocator(&f->memory);
    desc.logger.log = on_log;
    desc.logger.user = f;
    return lao_create(&desc, context);
}

/* ---- the scene -------------------------------------------------------------------------- */

enum { LINE_POINTS = 24 };

lao_lines_desc fixture_lines(uint32_t seed) {
    static float points[2 * LINE_POINTS * 3];
    static const uint32_t offsets[3] = {0, LINE_POINTS, 2 * LINE_POINTS};
    lao_lines_desc desc;
    for (size_t i = 0; i < 2 * LINE_POINTS; i++) {
        int line = i >= LINE_POINTS;
        float t = 6.2831853f * (float)(i % LINE_POINTS) / (float)(LINE_POINTS - 1);
        points[3 * i + 0] = (line ? 1.2f : 2.0f) * cosf(t);
        points[3 * i + 1] = (line ? 1.2f : 2.0f) * sinf(t + 0.1f * (float)seed);
        points[3 * i + 2] = line ? 0.3f * t : 0.0f;
    }
    memcpy(&points[3 * (LINE_POINTS - 1)], points, 3 * sizeof points[0]);
    memset(&desc, 0, sizeof desc);
    desc.line_count = 2;
    desc.point_count = 2 * LINE_POINTS;
    desc.offsets = offsets;
    desc.points = points;
    return desc;
}

lao_lines fixture_lines_create(lao_context *context, uint32_t seed) {
    lao_lines_desc desc = fixture_lines(seed);
    lao_lines lines = {0};
    assert_int_equal(lao_lines_create(context, &desc, &lines), LAO_OK);
    return lines;
}

lao_view fixture_view_create(lao_context *context, uint32_t width, uint32_t height) {
    lao_view_desc desc;
    lao_view view = {0};
    memset(&desc, 0, sizeof desc);
    desc.width = width;
    desc.height = height;
    assert_int_equal(lao_view_create(context, &desc, &view), LAO_OK);
    return view;
}

const lao_settings *fixture_settings(void) {
    static lao_settings settings;
    settings.levels = 2;
    settings.samples = 2;
    settings.supersampling = 1;
    return &settings;
}

lao_frame fixture_frame(lao_view view, const lao_set *sets, uint32_t set_count) {
    lao_frame frame;
    float *v = frame.camera.view, *p = frame.camera.projection;
    memset(&frame, 0, sizeof frame);
    frame.view = view;
    frame.sets = sets;
    frame.set_count = set_count;
    v[0] = v[5] = v[10] = v[15] = 1;
    v[14] = -6; /* perspective, 1 .. 20 mm, depth 0 .. 1 */
    p[0] = p[5] = 2;
    p[10] = -20.0f / 19.0f;
    p[11] = -1;
    p[14] = -20.0f / 19.0f;
    frame.camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    return frame;
}

/* ---- images and frames ------------------------------------------------------------------ */

lao_image fixture_image(const host_vk_image *image, VkImageLayout before, VkImageLayout after) {
    lao_image out;
    memset(&out, 0, sizeof out);
    memcpy(&out.native, &image->image, sizeof image->image);
    memcpy(&out.native_view, &image->view, sizeof image->view);
    out.native_format = (uint32_t)image->format;
    out.width = image->width;
    out.height = image->height;
    out.present = 1;
    out.layout_before = (uint32_t)before;
    out.layout_after = (uint32_t)after;
    return out;
}

static void change_layout(VkCommandBuffer commands, const host_vk_image *image, VkImageLayout from,
                          VkImageLayout to) {
    VkImageMemoryBarrier barrier;
    memset(&barrier, 0, sizeof barrier);
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
    barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image->image;
    barrier.subresourceRange.aspectMask = image->aspect;
    barrier.subresourceRange.levelCount = barrier.subresourceRange.layerCount = 1;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

host_vk_image fixture_image_make(fixture *f, VkFormat format, uint32_t width, uint32_t height,
                                 float value, VkImageLayout layout) {
    const VkImageLayout to = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    VkImageSubresourceRange range = {0, 0, 1, 0, 1};
    VkClearColorValue color = {{value, value, value, 1}};
    VkClearDepthStencilValue depth = {value, 0};
    host_vk_image image;
    VkCommandBuffer commands;
    assert_true(host_vk_image_make(f->host, format, width, height, 0, &image));
    commands = host_vk_begin(f->host);
    assert_non_null(commands);
    range.aspectMask = image.aspect;
    change_layout(commands, &image, VK_IMAGE_LAYOUT_UNDEFINED, to);
    if (image.aspect == VK_IMAGE_ASPECT_COLOR_BIT) {
        vkCmdClearColorImage(commands, image.image, to, &color, 1, &range);
    } else {
        vkCmdClearDepthStencilImage(commands, image.image, to, &depth, 1, &range);
    }
    change_layout(commands, &image, to, layout);
    assert_true(host_vk_submit_and_wait(f->host, commands));
    return image;
}

lao_result fixture_render(fixture *f, lao_context *context, lao_frame *frame) {
    VkCommandBuffer commands = host_vk_begin(f->host);
    lao_result result;
    assert_non_null(commands);
    frame->commands = commands;
    result = lao_render(context, frame);
    assert_true(host_vk_submit(f->host, commands)); /* empty after a failure */
    return result;
}

void fixture_wait(fixture *f) {
    for (int i = 0; i < HOST_VK_COMMANDS; i++) {
        VkCommandBuffer commands = host_vk_begin(f->host);
        assert_non_null(commands);
        assert_true(host_vk_submit_and_wait(f->host, commands));
    }
}
