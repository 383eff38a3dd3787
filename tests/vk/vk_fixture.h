/* A device under core and synchronisation validation, contexts with a counting allocator and log,
 * a small scene, and images of the host. */
#ifndef VK_FIXTURE_H
#define VK_FIXTURE_H

#include "host_vk.h"
#include "lent.h"
#include "vk_wrap.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { FIXTURE_FRAMES = HOST_VK_COMMANDS };

typedef struct fixture {
    host_vk *host;
    lent_memory memory;
    int logs;
    lao_log_item item;
    char text[1024]; /* of the last log item */
} fixture;

/* Skips the test where there is no device, or fails it when LINEAO_EXPECT_GPU is set. */
void fixture_open(fixture *f, uint32_t api_version);
/* Fails on any validation message, those of the device's destruction included, and on leaks. */
void fixture_close(fixture *f);

/* A context of FIXTURE_FRAMES frames in flight; `queue`: lao_read works. */
lao_result fixture_context(fixture *f, int queue, lao_context **context);

/* Two lines, one of them closed; another shape for another seed. */
lao_lines_desc fixture_lines(uint32_t seed);
lao_lines fixture_lines_create(lao_context *context, uint32_t seed);
lao_view fixture_view_create(lao_context *context, uint32_t width, uint32_t height);

/* Few samples and levels: pipelines that are compiled quickly. Of static storage. */
const lao_settings *fixture_settings(void);

/* A frame that sees the lines, without a target. */
lao_frame fixture_frame(lao_view view, const lao_set *sets, uint32_t set_count);
lao_image fixture_image(const host_vk_image *image, VkImageLayout before, VkImageLayout after);
/* A host image that holds a colour or a depth, already in `layout`. */
host_vk_image fixture_image_make(fixture *f, VkFormat format, uint32_t width, uint32_t height,
                                 float value, VkImageLayout layout);

/* Records the frame and submits it without waiting. */
lao_result fixture_render(fixture *f, lao_context *context, lao_frame *frame);
/* The host's fences have been waited for and everything has finished. */
void fixture_wait(fixture *f);

#endif
