/* The hosts of the tests open and close without a window, leak or validation message, again and
 * again; what they report about themselves is true, and images come back as they were cleared. */
#include "host_gl.h"
#include "host_vk.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { REPEATS = 20 };

static void gl_opens_and_closes(void **state) {
    (void)state;
    char error[HOST_ERROR_SIZE] = "";
    for (int i = 0; i < REPEATS; i++) {
        const host_gl_desc descs[3] = {{0, 0, false}, {3, 3, i % 2 == 0}, {4, 5, true}};
        host_gl *host = NULL;
        if (!host_gl_open(&descs[i % 3], &host, error))
            fail_msg("%s", error);
        assert_non_null(host_gl_get_proc("glDrawArrays", NULL));
        assert_true(strlen(host_gl_version(host)) > 2 && strlen(host_gl_renderer(host)) > 2);
        if (strstr(host_gl_renderer(host), "llvmpipe"))
            assert_true(host_gl_is_software(host));
        host_gl_close(host);
    }
    host_gl_close(NULL);
}

static void gl_hosts_do_not_disturb_each_other(void **state) {
    (void)state;
    char error[HOST_ERROR_SIZE];
    host_gl *first = NULL, *second = NULL;
    assert_true(host_gl_open(NULL, &first, error));
    assert_true(host_gl_open(NULL, &second, error));
    assert_true(host_gl_make_current(first));
    host_gl_close(second);
    assert_true(host_gl_make_current(first));
    host_gl_close(first);
}

static void gl_says_what_it_can_not(void **state) {
    (void)state;
    char error[HOST_ERROR_SIZE] = "";
    const host_gl_desc desc = {9, 9, false};
    host_gl *host = NULL;
    assert_false(host_gl_open(&desc, &host, error));
    assert_memory_equal(error, "OpenGL: ", 8);
    assert_null(host);
}

static void clear(host_vk *host, const host_vk_image *image, VkImageLayout layout) {
    VkCommandBuffer commands = host_vk_begin(host);
    assert_non_null(commands);
    const VkImageSubresourceRange range = {image->aspect, 0, 1, 0, 1};
    VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image->image,
        .subresourceRange = range,
    };
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
    if (image->aspect == VK_IMAGE_ASPECT_DEPTH_BIT) {
        const VkClearDepthStencilValue value = {0.25f, 0};
        vkCmdClearDepthStencilImage(commands, image->image, layout, &value, 1, &range);
    } else {
        const VkClearColorValue value = {.float32 = {1.0f, 0.5f, 0.0f, 0.75f}};
        vkCmdClearColorImage(commands, image->image, layout, &value, 1, &range);
    }
    assert_true(host_vk_submit(host, commands)); /* the read waits */
}

static void images_come_back(host_vk *host) {
    enum { W = 37, H = 5 };
    host_vk_image colour, depth;
    static float pixels[W * H * 4];
    const VkImageLayout layout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    assert_true(host_vk_image_make(host, VK_FORMAT_R32G32B32A32_SFLOAT, W, H, 0, &colour));
    assert_true(host_vk_image_make(host, VK_FORMAT_D32_SFLOAT, W, H, 0, &depth));
    clear(host, &colour, layout);
    clear(host, &depth, layout);
    for (int again = 0; again < 2; again++) { /* the layout is as before */
        assert_true(host_vk_image_read(host, &colour, layout, pixels));
        for (int i = 0; i < W * H; i++) {
            const float wanted[4] = {1.0f, 0.5f, 0.0f, 0.75f};
            assert_memory_equal(pixels + 4 * i, wanted, sizeof wanted);
        }
        assert_true(host_vk_image_read(host, &depth, layout, pixels));
        for (int i = 0; i < W * H; i++)
            assert_true(pixels[i] == 0.25f);
    }
    host_vk_image_free(host, &depth);
    host_vk_image_free(host, &depth);
    host_vk_image_free(host, &colour);
}

static void vk_opens_and_closes(void **state) {
    (void)state;
    char error[HOST_VK_ERROR_SIZE] = "";
    for (int i = 0; i < REPEATS; i++) {
        host_vk_desc desc;
        memset(&desc, 0, sizeof desc);
        desc.validation = i % 4 != 3;
        desc.synchronization_validation = i % 4 == 1;
        desc.api_version = i % 2 ? VK_API_VERSION_1_2 : 0;
        desc.features.fragmentStoresAndAtomics = VK_TRUE;
        desc.features.sparseBinding = VK_TRUE; /* lavapipe has none: left out, not an error */
        host_vk *host = NULL;
        if (!host_vk_open(&desc, &host, error))
            fail_msg("%s", error);
        assert_true(host_vk_instance(host) && host_vk_physical(host) && host_vk_device(host));
        assert_true(host_vk_queue(host) && strlen(host_vk_name(host)) > 2);
        assert_non_null(host_vk_get_instance_proc(host)(host_vk_instance(host), "vkCreateDevice"));
        const char *barrier = i % 2 ? "vkCmdPipelineBarrier2KHR" : "vkCmdPipelineBarrier2";
        assert_non_null(vkGetDeviceProcAddr(host_vk_device(host), barrier));
        images_come_back(host);
        for (int k = 0; k < 3 * HOST_VK_COMMANDS; k++) {
            assert_true(host_vk_submit(host, host_vk_begin(host)));
        }
        assert_string_equal(host_vk_first_message(host), "");
        assert_int_equal(host_vk_close(host), 0);
    }
    assert_int_equal(host_vk_close(NULL), 0);
}

static void count_message(void *user, const char *text) {
    assert_non_null(strstr(text, "VUID"));
    ++*(int *)user;
}

static void vk_mistakes_are_counted(void **state) {
    (void)state;
    int told = 0;
    host_vk_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.validation = true;
    desc.message = count_message;
    desc.user = &told;
    host_vk *host = NULL;
    assert_true(host_vk_open(&desc, &host, NULL));
    host_vk_image image;
    assert_true(host_vk_image_make(host, VK_FORMAT_R8_UNORM, 4, 4, 0, &image));
    vkDestroyImageView(host_vk_device(host), image.view, NULL);
    const VkImageViewCreateInfo wrong = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image.image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = VK_FORMAT_R8_UNORM,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 3, 1, 0, 1}, /* there is no level 3 */
    };
    image.view = VK_NULL_HANDLE;
    if (vkCreateImageView(host_vk_device(host), &wrong, NULL, &image.view) == VK_SUCCESS) {
        assert_true(host_vk_messages(host) > 0);
    }
    assert_non_null(strstr(host_vk_first_message(host), "VUID"));
    host_vk_image_free(host, &image);
    assert_int_equal(host_vk_close(host), told);
    assert_true(told > 0);
}

static void vk_device_can_be_named(void **state) {
    (void)state;
    char error[HOST_VK_ERROR_SIZE] = "";
    host_vk *host = NULL;
    assert_int_equal(setenv("LINEAO_VK_DEVICE", "no such device", 1), 0);
    bool opened = host_vk_open(NULL, &host, error);
    unsetenv("LINEAO_VK_DEVICE");
    assert_false(opened);
    assert_memory_equal(error, "Vulkan: ", 8);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gl_opens_and_closes),
        cmocka_unit_test(gl_hosts_do_not_disturb_each_other),
        cmocka_unit_test(gl_says_what_it_can_not),
        cmocka_unit_test(vk_opens_and_closes),
        cmocka_unit_test(vk_mistakes_are_counted),
        cmocka_unit_test(vk_device_can_be_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
