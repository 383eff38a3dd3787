/* The Vulkan executor keeps the core and synchronisation validation layers silent, in every use of
 * the public functions, on Vulkan 1.3 and on 1.2 with its two extensions, and frees what it made.
 */
#include "vk_fixture.h"

#include <stdlib.h>
#include <string.h>

enum { WIDTH = 48, HEIGHT = 32 };

static void assert_rendered(fixture *f, lao_context *context, lao_frame *frame) {
    lao_result result = fixture_render(f, context, frame);
    if (result != LAO_OK)
        print_message("%s\n", f->text);
    assert_int_equal(result, LAO_OK);
}

/* Pixels of the image "out" that a line covers. */
static int covered(lao_context *context, lao_view view) {
    static float data[64 * 64 * 4];
    lao_read_info info;
    int count = 0;
    assert_int_equal(lao_read(context, view, "out", 0, data, sizeof data / sizeof data[0], &info),
                     LAO_OK);
    for (uint32_t i = 0; i < info.width * info.height; i++)
        count += data[info.channels * i + 3] > 0.5f;
    return count;
}

static void close_all(fixture *f, lao_context *context) {
    fixture_wait(f);
    assert_int_equal(f->logs, 0);
    lao_destroy(context);
    fixture_close(f);
}

/* Frames allocate nothing once the first is drawn, and each picture is the same. */
static void frames_in_ring_order(void **state) {
    fixture f;
    lao_context *context;
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 1, &context), LAO_OK);
    lao_set set = {fixture_lines_create(context, 0), fixture_settings(), {0}, NULL};
    lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), &set, 1);
    assert_rendered(&f, context, &frame);
    fixture_wait(&f);
    int first = covered(context, frame.view);
    uint32_t allocations = f.memory.allocations;
    for (int i = 0; i < 20; i++)
        assert_rendered(&f, context, &frame);
    assert_int_equal(f.memory.allocations, allocations);
    fixture_wait(&f);
    assert_true(first > 50);
    assert_int_equal(covered(context, frame.view), first);
    close_all(&f, context);
}

static void lines_change_in_flight(void **state) {
    fixture f;
    lao_context *context;
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 0, &context), LAO_OK);
    lao_set sets[2];
    memset(sets, 0, sizeof sets);
    sets[0].settings = sets[1].settings = fixture_settings();
    sets[0].lines = fixture_lines_create(context, 0);
    sets[1].lines = fixture_lines_create(context, 1);
    lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), sets, 2);
    for (uint32_t i = 0; i < 12; i++) {
        lao_lines_desc desc = fixture_lines(i);
        assert_rendered(&f, context, &frame);
        if (i % 3 == 2) {
            assert_int_equal(lao_lines_destroy(context, sets[1].lines), LAO_OK);
            sets[1].lines = fixture_lines_create(context, i);
        }
        assert_int_equal(lao_lines_update(context, sets[0].lines, &desc), LAO_OK);
    }
    close_all(&f, context);
}

/* More views than frames in flight, each drawn once a frame: what a view used must outlive the
 * whole frame and those behind it. */
static void many_views_in_a_frame(void **state) {
    enum { VIEWS = 2 * FIXTURE_FRAMES };
    fixture f;
    lao_context *context;
    lao_view views[VIEWS];
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 0, &context), LAO_OK);
    lao_set set = {fixture_lines_create(context, 0), fixture_settings(), {0}, NULL};
    lao_frame frame = fixture_frame((lao_view){0}, &set, 1);
    for (int i = 0; i < VIEWS; i++)
        views[i] = fixture_view_create(context, 16, 16);
    for (uint32_t i = 0; i < 8; i++) {
        VkCommandBuffer commands = host_vk_begin(f.host);
        lao_lines_desc desc = fixture_lines(i);
        assert_non_null(commands);
        frame.commands = commands;
        for (uint32_t k = 0; k < VIEWS; k++) {
            frame.view = views[(k + i) % VIEWS]; /* the order of the views changes */
            if (k == i % VIEWS)
                assert_int_equal(lao_lines_update(context, set.lines, &desc), LAO_OK);
            assert_int_equal(lao_render(context, &frame), LAO_OK);
        }
        assert_true(host_vk_submit(f.host, commands));
        if (i == 5) {
            assert_int_equal(lao_view_destroy(context, views[2]), LAO_OK);
            views[2] = fixture_view_create(context, 24, 8);
        }
    }
    close_all(&f, context);
}

static void resize_storm(void **state) {
    fixture f;
    lao_context *context;
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 1, &context), LAO_OK);
    lao_set set = {fixture_lines_create(context, 0), fixture_settings(), {0}, NULL};
    lao_frame frame = fixture_frame(fixture_view_create(context, 1, 1), &set, 1);
    for (uint32_t i = 0; i < 24; i++) {
        uint32_t size = 1 + i * 29 % 61;
        assert_int_equal(lao_view_resize(context, frame.view, size, 62 - size), LAO_OK);
        if (i % 4 != 3) /* sometimes twice without a frame */
            assert_rendered(&f, context, &frame);
    }
    fixture_wait(&f);
    assert_true(covered(context, frame.view) > 0);
    close_all(&f, context);
}

/* All modes of the occlusion, and both depth directions: every variant of every shader. */
static void every_variant(void **state) {
    static const struct {
        const char *name;
        float values[3];
    } rows[] = {{"align", {0, 1, 2}},         {"light", {0, 1, 0}},     {"pyramid", {0, 1, 0}},
                {"smoothing", {0, 2, 1}},     {"levels", {1, 3, 8}},    {"samples", {1, 32, 7}},
                {"supersampling", {1, 2, 3}}, {"occlusion", {0, 1, 1}}, {"show", {0, 1, 5}}};
    fixture f;
    lao_context *context;
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 0, &context), LAO_OK);
    lao_settings settings;
    lao_set set = {fixture_lines_create(context, 0), &settings, {0}, NULL};
    lao_frame frame = fixture_frame(fixture_view_create(context, 20, 12), &set, 1);
    for (size_t row = 0; row < sizeof rows / sizeof rows[0]; row++) {
        for (int i = 0; i < 3; i++) {
            int setting = lao_setting_find(lao_lines_module(), rows[row].name);
            assert_true(setting >= 0);
            settings = *fixture_settings();
            memcpy((char *)&settings + sizeof settings.set + (size_t)setting * sizeof(float),
                   &rows[row].values[i], sizeof(float));
            settings.set = (uint64_t)1 << setting;
            assert_rendered(&f, context, &frame);
        }
    }
    settings = *fixture_settings();
    frame.camera.projection[10] = 1.0f / 19.0f;
    frame.camera.projection[14] = 20.0f / 19.0f;
    frame.camera.flags |= LAO_CAMERA_REVERSE_DEPTH;
    assert_rendered(&f, context, &frame);
    close_all(&f, context);
}

static void two_contexts(void **state) {
    fixture f;
    lao_context *contexts[2];
    lao_frame frames[2];
    lao_set sets[2];
    memset(sets, 0, sizeof sets);
    fixture_open(&f, *(uint32_t *)*state);
    for (uint32_t i = 0; i < 2; i++) {
        assert_int_equal(fixture_context(&f, 1, &contexts[i]), LAO_OK);
        sets[i].settings = fixture_settings();
        sets[i].lines = fixture_lines_create(contexts[i], i);
        lao_view view = fixture_view_create(contexts[i], WIDTH, HEIGHT);
        frames[i] = fixture_frame(view, &sets[i], 1);
    }
    for (int i = 0; i < 6; i++) {
        VkCommandBuffer commands = host_vk_begin(f.host);
        assert_non_null(commands);
        for (int k = 0; k < 2; k++) {
            frames[k].commands = commands;
            assert_int_equal(lao_render(contexts[k], &frames[k]), LAO_OK);
        }
        assert_true(host_vk_submit(f.host, commands));
    }
    fixture_wait(&f);
    lao_destroy(contexts[0]);
    assert_rendered(&f, contexts[1], &frames[1]);
    fixture_wait(&f);
    assert_true(covered(contexts[1], frames[1].view) > 50);
    close_all(&f, contexts[1]);
}

/* ---- images of the host ----------------------------------------------------------------- */

static void targets(void **state) {
    static const struct {
        VkFormat format;
        VkImageLayout before, after, read;
    } rows[] = {
        {VK_FORMAT_B8G8R8A8_UNORM, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
         VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
        {VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
         VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL},
        {VK_FORMAT_R16G16B16A16_SFLOAT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
         VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL},
        {VK_FORMAT_B8G8R8A8_SRGB, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_UNDEFINED,
         VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
    };
    fixture f;
    lao_context *context;
    host_vk_image images[4];
    static unsigned char empty[WIDTH * HEIGHT * 8], pixels[WIDTH * HEIGHT * 8];
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 0, &context), LAO_OK);
    lao_set set = {fixture_lines_create(context, 0), fixture_settings(), {0}, NULL};
    lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), &set, 1);
    frame.background[3] = 1;
    for (int i = 0; i < 4; i++) {
        VkImageLayout begin = rows[i].before ? rows[i].before : VK_IMAGE_LAYOUT_GENERAL;
        images[i] = fixture_image_make(&f, rows[i].format, WIDTH, HEIGHT, 1, begin);
    }
    for (int round = 0; round < 2; round++) { /* a swapchain of different images */
        for (int i = 0; i < 4; i++) {
            VkImageLayout before = round ? rows[i].read : rows[i].before;
            frame.target = fixture_image(&images[i], before, rows[i].read);
            if (rows[i].after == VK_IMAGE_LAYOUT_UNDEFINED) /* as before, or as it comes */
                frame.target.layout_after = VK_IMAGE_LAYOUT_UNDEFINED;
            assert_rendered(&f, context, &frame);
        }
    }
    for (int i = 0; i < 4; i++) {
        size_t size = host_vk_texel_size(rows[i].format) * WIDTH * HEIGHT;
        assert_true(host_vk_image_read(f.host, &images[i], rows[i].read, pixels));
        memset(empty, pixels[0], sizeof empty);
        assert_memory_not_equal(pixels, empty, size);
        host_vk_image_free(f.host, &images[i]);
    }
    close_all(&f, context);
}

/* Depth with stencil: both aspects change layout together. */
static host_vk_image depth_stencil_make(fixture *f) {
    const VkFormat format = VK_FORMAT_D32_SFLOAT_S8_UINT;
    host_vk_image image;
    VkDevice device = host_vk_device(f->host);
    VkImageCreateInfo info;
    VkMemoryRequirements need;
    VkMemoryAllocateInfo memory;
    VkImageViewCreateInfo view;
    memset(&image, 0, sizeof image);
    memset(&info, 0, sizeof info);
    memset(&memory, 0, sizeof memory);
    memset(&view, 0, sizeof view);
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = image.format = format;
    info.extent.width = image.width = WIDTH;
    info.extent.height = image.height = HEIGHT;
    info.extent.depth = info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    assert_int_equal(vkCreateImage(device, &info, NULL, &image.image), VK_SUCCESS);
    vkGetImageMemoryRequirements(device, image.image, &need);
    memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    memory.allocationSize = need.size;
    while (!(need.memoryTypeBits >> memory.memoryTypeIndex & 1))
        memory.memoryTypeIndex++;
    assert_int_equal(vkAllocateMemory(device, &memory, NULL, &image.memory), VK_SUCCESS);
    assert_int_equal(vkBindImageMemory(device, image.image, image.memory, 0), VK_SUCCESS);
    view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    view.image = image.image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format;
    view.subresourceRange.aspectMask = image.aspect = VK_IMAGE_ASPECT_DEPTH_BIT;
    view.subresourceRange.levelCount = view.subresourceRange.layerCount = 1;
    assert_int_equal(vkCreateImageView(device, &view, NULL, &image.view), VK_SUCCESS);
    return image;
}

/* Near depth of the host hides every line; far depth none; what is writable gets ours. */
static void host_depth(void **state) {
    const VkImageLayout layout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    fixture f;
    lao_context *context;
    static float depth[WIDTH * HEIGHT];
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 1, &context), LAO_OK);
    lao_set set = {fixture_lines_create(context, 0), fixture_settings(), {0}, NULL};
    lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), &set, 1);
    host_vk_image near = fixture_image_make(&f, VK_FORMAT_D32_SFLOAT, WIDTH, HEIGHT, 0, layout);
    host_vk_image far = fixture_image_make(&f, VK_FORMAT_D32_SFLOAT, WIDTH, HEIGHT, 1, layout);
    host_vk_image both = depth_stencil_make(&f);
    lao_import import = {"host_depth", fixture_image(&near, layout, VK_IMAGE_LAYOUT_UNDEFINED)};
    frame.imports = &import;
    frame.import_count = 1;
    assert_rendered(&f, context, &frame);
    fixture_wait(&f);
    assert_int_equal(covered(context, frame.view), 0);
    import.source = fixture_image(&far, layout, VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL);
    import.source.flags = LAO_HOST_WRITABLE;
    import.source.stage_before = VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
    import.source.access_before = VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
    assert_rendered(&f, context, &frame);
    fixture_wait(&f);
    assert_true(covered(context, frame.view) > 50);
    assert_true(
        host_vk_image_read(f.host, &far, VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL, depth));
    int written = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        written += depth[i] < 1.0f;
    assert_true(written > 50);
    import.source = fixture_image(&both, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    import.source.flags = LAO_HOST_WRITABLE;
    assert_rendered(&f, context, &frame);
    import.source.layout_before = VK_IMAGE_LAYOUT_GENERAL;
    assert_rendered(&f, context, &frame);
    fixture_wait(&f);
    host_vk_image_free(f.host, &near);
    host_vk_image_free(f.host, &far);
    host_vk_image_free(f.host, &both);
    close_all(&f, context);
}

static void host_geometry(void **state) {
    static const char *const names[3] = {"color", "tangent", "depth"};
    static const VkFormat formats[3] = {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R16G16B16A16_SFLOAT,
                                        VK_FORMAT_R32_SFLOAT};
    const VkImageLayout layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    fixture f;
    lao_context *context;
    host_vk_image images[3];
    lao_import imports[3];
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 1, &context), LAO_OK);
    lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), NULL, 0);
    for (int i = 0; i < 3; i++) {
        images[i] = fixture_image_make(&f, formats[i], WIDTH, HEIGHT, 0.5f,
                                       i == 1 ? VK_IMAGE_LAYOUT_GENERAL : layout);
        imports[i].image = names[i];
        imports[i].source = fixture_image(&images[i], i == 1 ? VK_IMAGE_LAYOUT_GENERAL : layout, 0);
    }
    frame.imports = imports;
    frame.import_count = 3;
    frame.sphere[3] = 3;
    for (int i = 0; i < 4; i++) {
        VkCommandBuffer commands = host_vk_begin(f.host);
        frame.commands = commands;
        assert_int_equal(lao_occlude(context, &frame, fixture_settings()), LAO_OK);
        assert_true(host_vk_submit(f.host, commands));
    }
    fixture_wait(&f);
    assert_int_equal(covered(context, frame.view), WIDTH * HEIGHT);
    for (int i = 0; i < 3; i++)
        host_vk_image_free(f.host, &images[i]);
    close_all(&f, context);
}

/* ---- nothing to draw, odd orders, the way back ------------------------------------------ */

static void nothing_to_draw(void **state) {
    fixture f;
    lao_context *context;
    lao_lines_desc none;
    memset(&none, 0, sizeof none);
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 1, &context), LAO_OK);
    lao_set set;
    memset(&set, 0, sizeof set);
    set.settings = fixture_settings();
    assert_int_equal(lao_lines_create(context, &none, &set.lines), LAO_OK);
    lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), &set, 1);
    for (int i = 0; i < 4; i++) {
        frame.set_count = i & 1;
        assert_rendered(&f, context, &frame);
    }
    fixture_wait(&f);
    assert_int_equal(covered(context, frame.view), 0);
    close_all(&f, context);
}

/* More segments than a processor takes at once: rendering ends and begins again in between. */
static void many_segments(void **state) {
    enum { LINES = 36000 }; /* four texels each */
    fixture f;
    lao_context *context;
    lao_lines_desc desc;
    float *points = calloc(6 * LINES, sizeof *points);
    uint32_t *offsets = calloc(LINES + 1, sizeof *offsets);
    assert_true(points && offsets);
    for (uint32_t i = 0; i < LINES; i++) {
        float t = 6.2831853f * (float)i / LINES;
        points[6 * i + 3] = 2 * cosf(t); /* spokes */
        points[6 * i + 4] = 2 * sinf(t);
        offsets[i + 1] = 2 * i + 2;
    }
    memset(&desc, 0, sizeof desc);
    desc.line_count = LINES;
    desc.point_count = 2 * LINES;
    desc.offsets = offsets;
    desc.points = points;
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 1, &context), LAO_OK);
    lao_set set;
    memset(&set, 0, sizeof set);
    set.settings = fixture_settings();
    assert_int_equal(lao_lines_create(context, &desc, &set.lines), LAO_OK);
    lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), &set, 1);
    assert_rendered(&f, context, &frame);
    fixture_wait(&f);
    assert_true(covered(context, frame.view) > 0);
    close_all(&f, context);
    free(points);
    free(offsets);
}

static void destroyed_in_any_order(void **state) {
    for (int order = 0; order < 5; order++) {
        fixture f;
        lao_context *context;
        fixture_open(&f, *(uint32_t *)*state);
        assert_int_equal(fixture_context(&f, 0, &context), LAO_OK);
        lao_set set = {fixture_lines_create(context, 0), fixture_settings(), {0}, NULL};
        lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), &set, 1);
        if (order != 3) /* never drawn */
            assert_rendered(&f, context, &frame);
        if (order == 4)
            fixture_wait(&f);
        if (order == 0 || order == 4)
            assert_int_equal(lao_view_destroy(context, frame.view), LAO_OK);
        if (order <= 1)
            assert_int_equal(lao_lines_destroy(context, set.lines), LAO_OK);
        if (order == 1)
            assert_int_equal(lao_view_destroy(context, frame.view), LAO_OK);
        close_all(&f, context);
    }
}

/* A host may throw a recorded frame away. */
static void recorded_but_not_submitted(void **state) {
    fixture f;
    lao_context *context;
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 1, &context), LAO_OK);
    lao_set set = {fixture_lines_create(context, 0), fixture_settings(), {0}, NULL};
    lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), &set, 1);
    for (uint32_t i = 0; i < 10; i++) {
        lao_lines_desc desc = fixture_lines(i);
        VkCommandBuffer commands = host_vk_begin(f.host);
        assert_non_null(commands);
        frame.commands = commands;
        assert_int_equal(lao_render(context, &frame), LAO_OK);
        if (i % 3 == 1) {
            assert_true(host_vk_submit(f.host, commands));
        } else {
            assert_int_equal(vkEndCommandBuffer(commands), VK_SUCCESS);
        }
        assert_int_equal(lao_lines_update(context, set.lines, &desc), LAO_OK);
    }
    assert_rendered(&f, context, &frame);
    fixture_wait(&f);
    assert_true(covered(context, frame.view) > 50);
    close_all(&f, context);
}

static void timings_and_reading(void **state) {
    fixture f;
    lao_context *context;
    lao_timing timings[64];
    uint32_t count = 64;
    lao_read_info info;
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 0, &context), LAO_OK);
    lao_set set = {fixture_lines_create(context, 0), fixture_settings(), {0}, NULL};
    lao_frame frame = fixture_frame(fixture_view_create(context, WIDTH, HEIGHT), &set, 1);
    frame.flags = LAO_FRAME_TIMINGS;
    for (int i = 0; i < 5; i++)
        assert_rendered(&f, context, &frame);
    fixture_wait(&f);
    assert_int_equal(lao_timings(context, frame.view, timings, &count), LAO_OK);
    assert_true(count > 4 && count < 64);
    for (uint32_t i = 0; i < count; i++)
        assert_true(timings[i].milliseconds >= 0 && timings[i].milliseconds < 60000);
    assert_int_equal(f.logs, 0);
    static float data[64 * 64 * 4];
    assert_int_equal(
        lao_read(context, frame.view, "out", 0, data, sizeof data / sizeof data[0], &info),
        LAO_ERROR_INVALID_ARGUMENT); /* without a queue */
    assert_int_equal(f.logs, 1);
    assert_int_equal(f.item, LAO_LOG_BACKEND_STATE);
    assert_non_null(strstr(f.text, "lao_vk_desc.queue"));
    frame.commands = NULL;
    assert_int_equal(lao_render(context, &frame), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(f.logs, 2);
    assert_int_equal(f.item, LAO_LOG_BACKEND_STATE);
    f.logs = 0;
    close_all(&f, context);
}

static void every_image_reads_back(void **state) {
    fixture f;
    lao_context *context;
    lao_read_info info;
    lao_view_desc desc;
    lao_view view;
    static unsigned char raw[96 * 64 * 16];
    memset(&desc, 0, sizeof desc);
    desc.width = WIDTH;
    desc.height = HEIGHT;
    desc.flags = LAO_VIEW_KEEP_IMAGES;
    fixture_open(&f, *(uint32_t *)*state);
    assert_int_equal(fixture_context(&f, 1, &context), LAO_OK);
    assert_int_equal(lao_view_create(context, &desc, &view), LAO_OK);
    lao_set set = {fixture_lines_create(context, 0), fixture_settings(), {0}, NULL};
    lao_frame frame = fixture_frame(view, &set, 1);
    static const char *const names[] = {"color", "tangent", "depth",  "zbuffer",
                                        "level", "ao",      "shaded", "out"};
    for (int round = 0; round < 2; round++) { /* reading leaves the images fit for the next frame */
        assert_rendered(&f, context, &frame);
        fixture_wait(&f);
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
            assert_int_equal(lao_read_raw(context, view, names[i], 0, raw, sizeof raw, &info),
                             LAO_OK);
        }
    }
    close_all(&f, context);
}

int main(void) {
    static uint32_t versions[2] = {VK_API_VERSION_1_3, VK_API_VERSION_1_2};
#define ON13(test)                                                                                 \
    { #test " on Vulkan 1.3", test, NULL, NULL, &versions[0] }
#define BOTH(test)                                                                                 \
    ON13(test), {                                                                                  \
#test " on Vulkan 1.2", test, NULL, NULL, &versions[1]                                     \
    }
    const struct CMUnitTest tests[] = {
        BOTH(frames_in_ring_order),
        BOTH(lines_change_in_flight),
        BOTH(many_views_in_a_frame),
        BOTH(resize_storm),
        ON13(every_variant),
        BOTH(two_contexts),
        BOTH(targets),
        BOTH(host_depth),
        BOTH(host_geometry),
        ON13(nothing_to_draw),
        BOTH(many_segments),
        ON13(destroyed_in_any_order),
        BOTH(recorded_but_not_submitted),
        BOTH(timings_and_reading),
        BOTH(every_image_reads_back),
    };
    return cmocka_run_group_tests_name("vk_clean", tests, NULL, NULL);
}
