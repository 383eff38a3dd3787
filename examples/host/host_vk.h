/* A real Vulkan host without a window: instance, device with dynamic rendering and
 * synchronization2, one graphics queue, a few command buffers. It owns what lineao never owns. */
#ifndef LINEAO_HOST_VK_H
#define LINEAO_HOST_VK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <vulkan/vulkan_core.h>

#include "lineao.h"

enum { HOST_VK_ERROR_SIZE = 256, HOST_VK_COMMANDS = 3 };

/* Gets each validation message; called on the thread that made the Vulkan call. */
typedef void (*host_vk_message_fn)(void *user, const char *text);

typedef struct host_vk_desc {
    bool validation;                 /* Khronos validation layer; opening fails without it */
    bool synchronization_validation; /* also its hazard checks; implies validation */
    uint32_t api_version; /* 0 = VK_API_VERSION_1_3; with 1.2 both features come as extensions */
    VkPhysicalDeviceFeatures features; /* wanted: those that the device has are enabled */
    host_vk_message_fn message;        /* may be NULL */
    void *user;
    const char *const *instance_extensions; /* (Optional) further ones, for a window */
    uint32_t instance_extension_count;
    const char *const *device_extensions;
    uint32_t device_extension_count;
} host_vk_desc;

typedef struct host_vk host_vk;

/* Opens a device: the first with a graphics queue, a GPU before a software device, or the first
 * whose name contains the environment variable LINEAO_VK_DEVICE. desc may be NULL. False: one line
 * in error (may be NULL). Thread: a host is used by one thread at a time. */
bool host_vk_open(const host_vk_desc *desc, host_vk **out, char error[HOST_VK_ERROR_SIZE]);

/* Waits for the device and destroys everything; returns the count of validation messages, those
 * of destruction included. Fine on NULL. */
uint32_t host_vk_close(host_vk *host);

VkInstance host_vk_instance(const host_vk *host);
VkPhysicalDevice host_vk_physical(const host_vk *host);
VkDevice host_vk_device(const host_vk *host);
VkQueue host_vk_queue(const host_vk *host);
uint32_t host_vk_family(const host_vk *host);
uint32_t host_vk_api_version(const host_vk *host);                     /* that of desc, or 1.3 */
const VkPhysicalDeviceFeatures *host_vk_features(const host_vk *host); /* those enabled */
const char *host_vk_name(const host_vk *host);
bool host_vk_is_software(const host_vk *host);
PFN_vkGetInstanceProcAddr host_vk_get_instance_proc(const host_vk *host);

/* What lineao's Vulkan backend is lent of this host: all of it but frames_in_flight and
 * debug_utils, which are 0. */
lao_vk_desc host_vk_lend(const host_vk *host);

/* Validation messages (warnings and errors) so far, and the text of the first ("" without). */
uint32_t host_vk_messages(const host_vk *host);
const char *host_vk_first_message(const host_vk *host);

/* A command buffer in the recording state; waits while all HOST_VK_COMMANDS are in flight. NULL:
 * the device is lost or out of memory. At most one is recorded at a time. */
VkCommandBuffer host_vk_begin(host_vk *host);

/* Ends and submits it; the second also waits until its work is done. */
bool host_vk_submit(host_vk *host, VkCommandBuffer commands);
bool host_vk_submit_and_wait(host_vk *host, VkCommandBuffer commands);

/* A 2D image with one level, optimal tiling, in its own memory, and a view of it. */
typedef struct host_vk_image {
    VkImage image;
    VkImageView view;
    VkDeviceMemory memory;
    VkFormat format;
    VkImageAspectFlags aspect; /* colour, or depth for the formats D16, X8_D24 and D32 */
    uint32_t width, height;
} host_vk_image;

/* Makes one in VK_IMAGE_LAYOUT_UNDEFINED, good as attachment, for sampling and for transfer, and
 * for `usage` besides. */
bool host_vk_image_make(host_vk *host, VkFormat format, uint32_t width, uint32_t height,
                        VkImageUsageFlags usage, host_vk_image *out);

/* Destroys and zeroes it; its work must be done. Fine on {0}. */
void host_vk_image_free(host_vk *host, host_vk_image *image);

/* Bytes of a texel of the common uncompressed formats; 0 for others. */
size_t host_vk_texel_size(VkFormat format);

/* Copies the image, which is in `layout` (not UNDEFINED) and stays so, to tightly packed rows in
 * memory order; pixels has width * height * host_vk_texel_size(format) bytes. Waits. */
bool host_vk_image_read(host_vk *host, const host_vk_image *image, VkImageLayout layout,
                        void *pixels);
/* The same the other way round; whatever the image held is gone, and any layout may have been. */
bool host_vk_image_write(host_vk *host, const host_vk_image *image, VkImageLayout layout,
                         const void *pixels);
/* Records that everything before is finished and visible, in the other layout, for everything
 * after. */
void host_vk_image_layout(VkCommandBuffer commands, const host_vk_image *image, VkImageLayout from,
                          VkImageLayout to);

#endif
