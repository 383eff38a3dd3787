#include "host_vk.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MESSAGE_SIZE = 1024, MOST_EXTENSIONS = 32 };

typedef struct command_slot {
    VkCommandBuffer commands;
    VkFence fence;
    bool in_flight;
} command_slot;

struct host_vk {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    command_slot slots[HOST_VK_COMMANDS];
    uint32_t next, family, api_version, messages;
    VkPhysicalDeviceFeatures features;
    VkPhysicalDeviceProperties properties;
    host_vk_message_fn message;
    void *user;
    char first[MESSAGE_SIZE];
};

static bool fail(char *error, const char *what, VkResult code) {
    if (error)
        snprintf(error, HOST_VK_ERROR_SIZE, "Vulkan: %s (VkResult %d)", what, (int)code);
    return false;
}

static bool check(char *error, const char *what, VkResult code) {
    return code == VK_SUCCESS || fail(error, what, code);
}

/* ---- instance --------------------------------------------------------------------------- */

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data,
                                                 void *user) {
    host_vk *host = user;
    (void)severity;
    (void)types;
    if (host->messages++ == 0)
        snprintf(host->first, sizeof host->first, "%s", data->pMessage);
    if (host->message)
        host->message(host->user, data->pMessage);
    return VK_FALSE;
}

static bool has_validation(void) {
    VkLayerProperties layers[64];
    uint32_t count = 64;
    VkResult code = vkEnumerateInstanceLayerProperties(&count, layers);
    for (uint32_t i = 0; (code == VK_SUCCESS || code == VK_INCOMPLETE) && i < count; i++) {
        if (strcmp(layers[i].layerName, "VK_LAYER_KHRONOS_validation") == 0)
            return true;
    }
    return false;
}

/* Adds to the list; false: there is no room. */
static bool add_extensions(const char **list, uint32_t *count, const char *const *names,
                           uint32_t name_count) {
    if (name_count > MOST_EXTENSIONS - *count)
        return false;
    for (uint32_t i = 0; i < name_count; i++)
        list[(*count)++] = names[i];
    return true;
}

static bool open_instance(host_vk *host, const host_vk_desc *desc, char *error) {
    static const char *const layer[] = {"VK_LAYER_KHRONOS_validation"};
    const char *extensions[MOST_EXTENSIONS];
    static const VkValidationFeatureEnableEXT enables[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    bool hazards = desc->synchronization_validation, validation = desc->validation || hazards;
    uint32_t count = 0;
    if (validation)
        extensions[count++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    if (hazards)
        extensions[count++] = VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME;
    if (!add_extensions(extensions, &count, desc->instance_extensions,
                        desc->instance_extension_count))
        return fail(error, "too many extensions", VK_ERROR_EXTENSION_NOT_PRESENT);
    if (validation && !has_validation()) {
        return fail(error, "no VK_LAYER_KHRONOS_validation; install vulkan-validationlayers",
                    VK_ERROR_LAYER_NOT_PRESENT);
    }
    const VkValidationFeaturesEXT features = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .enabledValidationFeatureCount = 1,
        .pEnabledValidationFeatures = enables,
    };
    /* chained to the instance, the messenger also sees its making and end */
    const VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .pNext = hazards ? &features : NULL,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = host,
    };
    const VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pApplicationName = "lineao host",
        .apiVersion = host->api_version,
    };
    const VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = validation ? &messenger : NULL,
        .pApplicationInfo = &application,
        .enabledLayerCount = validation ? 1 : 0,
        .ppEnabledLayerNames = layer,
        .enabledExtensionCount = count,
        .ppEnabledExtensionNames = extensions,
    };
    if (!check(error, "no instance", vkCreateInstance(&info, NULL, &host->instance)))
        return false;
    PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(host->instance,
                                                                  "vkCreateDebugUtilsMessengerEXT");
    if (!validation || !create)
        return true;
    VkDebugUtilsMessengerCreateInfoEXT lasting = messenger;
    lasting.pNext = NULL;
    return check(error, "no messenger", create(host->instance, &lasting, NULL, &host->messenger));
}

/* ---- device ----------------------------------------------------------------------------- */

static bool find_family(VkPhysicalDevice physical, uint32_t *family) {
    VkQueueFamilyProperties families[32];
    uint32_t count = 32;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
    for (*family = 0; *family < count; ++*family) {
        if (families[*family].queueFlags & VK_QUEUE_GRAPHICS_BIT)
            return true;
    }
    return false;
}

/* The named device, else a GPU, else what there is. */
static bool choose_device(host_vk *host, char *error) {
    const char *wanted = getenv("LINEAO_VK_DEVICE");
    VkPhysicalDevice devices[16];
    uint32_t count = 16;
    VkResult code = vkEnumeratePhysicalDevices(host->instance, &count, devices);
    if (code != VK_SUCCESS && code != VK_INCOMPLETE)
        return fail(error, "no devices", code);
    int best = -1;
    for (uint32_t i = 0; i < count; i++) {
        VkPhysicalDeviceProperties properties;
        uint32_t family;
        vkGetPhysicalDeviceProperties(devices[i], &properties);
        if (!find_family(devices[i], &family))
            continue;
        if (wanted && *wanted && !strstr(properties.deviceName, wanted))
            continue;
        int rank = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU ? 0 : 1;
        if (rank <= best)
            continue;
        best = rank;
        host->physical = devices[i];
        host->family = family;
        host->properties = properties;
    }
    return best >= 0 || fail(error, "no device with a graphics queue has the wanted name",
                             VK_ERROR_INITIALIZATION_FAILED);
}

/* Both structs hold nothing but VkBool32 after their header. */
static void keep_supported(VkPhysicalDeviceFeatures *wanted, VkPhysicalDevice physical) {
    enum { COUNT = sizeof(VkPhysicalDeviceFeatures) / sizeof(VkBool32) };
    VkPhysicalDeviceFeatures supported;
    VkBool32 want[COUNT], have[COUNT];
    vkGetPhysicalDeviceFeatures(physical, &supported);
    memcpy(want, wanted, sizeof want);
    memcpy(have, &supported, sizeof have);
    for (int i = 0; i < COUNT; i++)
        want[i] = want[i] && have[i];
    memcpy(wanted, want, sizeof want);
}

static bool open_device(host_vk *host, const host_vk_desc *desc, char *error) {
    static const char *const aliases[] = {VK_KHR_DYNAMIC_RENDERING_EXTENSION_NAME,
                                          VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME};
    bool core = host->api_version >= VK_API_VERSION_1_3;
    const char *extensions[MOST_EXTENSIONS];
    uint32_t count = 0;
    if (!add_extensions(extensions, &count, aliases, core ? 0 : 2) ||
        !add_extensions(extensions, &count, desc->device_extensions, desc->device_extension_count))
        return fail(error, "too many extensions", VK_ERROR_EXTENSION_NOT_PRESENT);
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = host->family,
        .queueCount = 1,
        .pQueuePriorities = &priority,
    };
    VkPhysicalDeviceSynchronization2Features synchronization = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES,
        .synchronization2 = VK_TRUE,
    };
    VkPhysicalDeviceDynamicRenderingFeatures rendering = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES,
        .pNext = &synchronization,
        .dynamicRendering = VK_TRUE,
    };
    const VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = &rendering,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .enabledExtensionCount = count,
        .ppEnabledExtensionNames = extensions,
        .pEnabledFeatures = &host->features,
    };
    keep_supported(&host->features, host->physical);
    return check(error, "no device with dynamic rendering and synchronization2",
                 vkCreateDevice(host->physical, &info, NULL, &host->device));
}

static bool open_commands(host_vk *host, char *error) {
    vkGetDeviceQueue(host->device, host->family, 0, &host->queue);
    const VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
        .queueFamilyIndex = host->family,
    };
    if (!check(error, "no pool", vkCreateCommandPool(host->device, &pool, NULL, &host->pool))) {
        return false;
    }
    for (int i = 0; i < HOST_VK_COMMANDS; i++) {
        const VkCommandBufferAllocateInfo buffer = {
            .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
            .commandPool = host->pool,
            .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
            .commandBufferCount = 1,
        };
        const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        command_slot *slot = &host->slots[i];
        if (!check(error, "no command buffer",
                   vkAllocateCommandBuffers(host->device, &buffer, &slot->commands)) ||
            !check(error, "no fence", vkCreateFence(host->device, &fence, NULL, &slot->fence))) {
            return false;
        }
    }
    return true;
}

bool host_vk_open(const host_vk_desc *desc, host_vk **out, char error[HOST_VK_ERROR_SIZE]) {
    host_vk_desc zero;
    memset(&zero, 0, sizeof zero);
    if (!desc)
        desc = &zero;
    host_vk *host = calloc(1, sizeof *host);
    if (!host)
        return fail(error, "out of memory", VK_ERROR_OUT_OF_HOST_MEMORY);
    host->api_version = desc->api_version ? desc->api_version : VK_API_VERSION_1_3;
    host->features = desc->features;
    host->message = desc->message;
    host->user = desc->user;
    if (!open_instance(host, desc, error) || !choose_device(host, error) ||
        !open_device(host, desc, error) || !open_commands(host, error)) {
        host_vk_close(host);
        return false;
    }
    *out = host;
    return true;
}

uint32_t host_vk_close(host_vk *host) {
    if (!host)
        return 0;
    if (host->device) {
        vkDeviceWaitIdle(host->device);
        for (int i = 0; i < HOST_VK_COMMANDS; i++) {
            vkDestroyFence(host->device, host->slots[i].fence, NULL);
        }
        vkDestroyCommandPool(host->device, host->pool, NULL);
        vkDestroyDevice(host->device, NULL);
    }
    if (host->messenger) {
        PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                host->instance, "vkDestroyDebugUtilsMessengerEXT");
        destroy(host->instance, host->messenger, NULL);
    }
    if (host->instance)
        vkDestroyInstance(host->instance, NULL);
    uint32_t messages = host->messages;
    free(host);
    return messages;
}

VkInstance host_vk_instance(const host_vk *host) {
    return host->instance;
}
VkPhysicalDevice host_vk_physical(const host_vk *host) {
    return host->physical;
}
VkDevice host_vk_device(const host_vk *host) {
    return host->device;
}
VkQueue host_vk_queue(const host_vk *host) {
    return host->queue;
}
uint32_t host_vk_family(const host_vk *host) {
    return host->family;
}
uint32_t host_vk_api_version(const host_vk *host) {
    return host->api_version;
}
lao_vk_desc host_vk_lend(const host_vk *host) {
    PFN_vkGetInstanceProcAddr get_proc = host_vk_get_instance_proc(host);
    lao_vk_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.instance = host->instance;
    desc.physical_device = host->physical;
    desc.device = host->device;
    memcpy(&desc.get_instance_proc, &get_proc,
           sizeof get_proc); /* types that differ in name only */
    desc.api_version = host->api_version;
    desc.queue_family = host->family;
    desc.queue = host->queue;
    return desc;
}
const VkPhysicalDeviceFeatures *host_vk_features(const host_vk *host) {
    return &host->features;
}
const char *host_vk_name(const host_vk *host) {
    return host->properties.deviceName;
}
uint32_t host_vk_messages(const host_vk *host) {
    return host->messages;
}
const char *host_vk_first_message(const host_vk *host) {
    return host->first;
}

bool host_vk_is_software(const host_vk *host) {
    return host->properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
}

PFN_vkGetInstanceProcAddr host_vk_get_instance_proc(const host_vk *host) {
    (void)host;
    return vkGetInstanceProcAddr;
}

/* ---- commands --------------------------------------------------------------------------- */

static bool await(host_vk *host, command_slot *slot) {
    if (!slot->in_flight)
        return true;
    if (vkWaitForFences(host->device, 1, &slot->fence, VK_TRUE, UINT64_MAX) != VK_SUCCESS) {
        return false;
    }
    slot->in_flight = false;
    return vkResetFences(host->device, 1, &slot->fence) == VK_SUCCESS;
}

VkCommandBuffer host_vk_begin(host_vk *host) {
    command_slot *slot = &host->slots[host->next];
    const VkCommandBufferBeginInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    if (!await(host, slot) || vkBeginCommandBuffer(slot->commands, &info) != VK_SUCCESS)
        return NULL;
    host->next = (host->next + 1) % HOST_VK_COMMANDS;
    return slot->commands;
}

static command_slot *slot_of(host_vk *host, VkCommandBuffer commands) {
    for (int i = 0; i < HOST_VK_COMMANDS; i++) {
        if (host->slots[i].commands == commands)
            return &host->slots[i];
    }
    return NULL;
}

bool host_vk_submit(host_vk *host, VkCommandBuffer commands) {
    command_slot *slot = slot_of(host, commands);
    if (!commands || !slot || vkEndCommandBuffer(commands) != VK_SUCCESS)
        return false;
    const VkSubmitInfo info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .commandBufferCount = 1,
        .pCommandBuffers = &commands,
    };
    slot->in_flight = vkQueueSubmit(host->queue, 1, &info, slot->fence) == VK_SUCCESS;
    return slot->in_flight;
}

bool host_vk_submit_and_wait(host_vk *host, VkCommandBuffer commands) {
    return host_vk_submit(host, commands) && await(host, slot_of(host, commands));
}

/* ---- images ----------------------------------------------------------------------------- */

/* Allocates memory of a type that has `flags`; NULL: none. */
static VkDeviceMemory allocate(host_vk *host, const VkMemoryRequirements *needs,
                               VkMemoryPropertyFlags flags) {
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(host->physical, &memory);
    for (uint32_t i = 0; i < memory.memoryTypeCount; i++) {
        if (!(needs->memoryTypeBits >> i & 1))
            continue;
        if ((memory.memoryTypes[i].propertyFlags & flags) != flags)
            continue;
        const VkMemoryAllocateInfo info = {
            .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
            .allocationSize = needs->size,
            .memoryTypeIndex = i,
        };
        VkDeviceMemory got = VK_NULL_HANDLE;
        if (vkAllocateMemory(host->device, &info, NULL, &got) == VK_SUCCESS)
            return got;
    }
    return VK_NULL_HANDLE;
}

static bool is_depth(VkFormat format) {
    return format == VK_FORMAT_D16_UNORM || format == VK_FORMAT_X8_D24_UNORM_PACK32 ||
           format == VK_FORMAT_D32_SFLOAT;
}

bool host_vk_image_make(host_vk *host, VkFormat format, uint32_t width, uint32_t height,
                        VkImageUsageFlags usage, host_vk_image *out) {
    host_vk_image made;
    memset(&made, 0, sizeof made);
    made.format = format;
    made.width = width;
    made.height = height;
    made.aspect = is_depth(format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = format,
        .extent = {width, height, 1},
        .mipLevels = 1,
        .arrayLayers = 1,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = usage | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                 (is_depth(format) ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                   : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT),
    };
    VkMemoryRequirements needs;
    bool ok = vkCreateImage(host->device, &info, NULL, &made.image) == VK_SUCCESS;
    if (ok) {
        vkGetImageMemoryRequirements(host->device, made.image, &needs);
        made.memory = allocate(host, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        ok = made.memory &&
             vkBindImageMemory(host->device, made.image, made.memory, 0) == VK_SUCCESS;
    }
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = made.image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = format,
        .subresourceRange = {made.aspect, 0, 1, 0, 1},
    };
    ok = ok && vkCreateImageView(host->device, &view, NULL, &made.view) == VK_SUCCESS;
    if (ok) {
        *out = made;
    } else {
        host_vk_image_free(host, &made);
    }
    return ok;
}

void host_vk_image_free(host_vk *host, host_vk_image *image) {
    vkDestroyImageView(host->device, image->view, NULL);
    vkDestroyImage(host->device, image->image, NULL);
    vkFreeMemory(host->device, image->memory, NULL);
    memset(image, 0, sizeof *image);
}

size_t host_vk_texel_size(VkFormat format) {
    switch (format) {
    case VK_FORMAT_R8_UNORM:
        return 1;
    case VK_FORMAT_R8G8_UNORM:
    case VK_FORMAT_R16_UNORM:
    case VK_FORMAT_R16_SFLOAT:
    case VK_FORMAT_D16_UNORM:
        return 2;
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_SRGB:
    case VK_FORMAT_R8G8B8A8_SNORM:
    case VK_FORMAT_B8G8R8A8_UNORM:
    case VK_FORMAT_B8G8R8A8_SRGB:
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
    case VK_FORMAT_R16G16_UNORM:
    case VK_FORMAT_R16G16_SNORM:
    case VK_FORMAT_R16G16_SFLOAT:
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D32_SFLOAT:
        return 4;
    case VK_FORMAT_R16G16B16A16_UNORM:
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R32G32_SFLOAT:
        return 8;
    case VK_FORMAT_R32G32B32A32_UINT:
    case VK_FORMAT_R32G32B32A32_SFLOAT:
        return 16;
    default:
        return 0;
    }
}

void host_vk_image_layout(VkCommandBuffer commands, const host_vk_image *image, VkImageLayout from,
                          VkImageLayout to) {
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = from,
        .newLayout = to,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image->image,
        .subresourceRange = {image->aspect, 0, 1, 0, 1},
    };
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

/* Between the image and the buffer. */
static bool copy(host_vk *host, const host_vk_image *image, VkImageLayout layout, VkBuffer buffer,
                 bool write) {
    VkImageLayout here =
        write ? VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    VkCommandBuffer commands = host_vk_begin(host);
    if (!commands)
        return false;
    const VkBufferImageCopy region = {
        .imageSubresource = {image->aspect, 0, 0, 1},
        .imageExtent = {image->width, image->height, 1},
    };
    host_vk_image_layout(commands, image, write ? VK_IMAGE_LAYOUT_UNDEFINED : layout, here);
    if (write)
        vkCmdCopyBufferToImage(commands, buffer, image->image, here, 1, &region);
    else
        vkCmdCopyImageToBuffer(commands, image->image, here, buffer, 1, &region);
    host_vk_image_layout(commands, image, here, layout);
    const VkMemoryBarrier to_host = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_HOST_READ_BIT,
    };
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &to_host, 0, NULL, 0, NULL);
    return host_vk_submit_and_wait(host, commands);
}

/* To `out`, or from `in`. */
static bool transfer(host_vk *host, const host_vk_image *image, VkImageLayout layout, void *out,
                     const void *in) {
    bool write = in != NULL;
    size_t size = host_vk_texel_size(image->format) * image->width * image->height;
    if (size == 0)
        return false;
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = size,
        .usage = write ? VK_BUFFER_USAGE_TRANSFER_SRC_BIT : VK_BUFFER_USAGE_TRANSFER_DST_BIT,
    };
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    void *mapped = NULL;
    bool ok = vkCreateBuffer(host->device, &info, NULL, &buffer) == VK_SUCCESS;
    if (ok) {
        VkMemoryRequirements needs;
        vkGetBufferMemoryRequirements(host->device, buffer, &needs);
        memory =
            allocate(host, &needs,
                     VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
        ok = memory && vkBindBufferMemory(host->device, buffer, memory, 0) == VK_SUCCESS &&
             vkMapMemory(host->device, memory, 0, VK_WHOLE_SIZE, 0, &mapped) == VK_SUCCESS;
    }
    ok = ok && mapped;
    if (ok && write)
        memcpy(mapped, in, size);
    ok = ok && copy(host, image, layout, buffer, write);
    if (ok && out)
        memcpy(out, mapped, size);
    vkDestroyBuffer(host->device, buffer, NULL);
    vkFreeMemory(host->device, memory, NULL);
    return ok;
}

bool host_vk_image_read(host_vk *host, const host_vk_image *image, VkImageLayout layout,
                        void *pixels) {
    return transfer(host, image, layout, pixels, NULL);
}

bool host_vk_image_write(host_vk *host, const host_vk_image *image, VkImageLayout layout,
                         const void *pixels) {
    return transfer(host, image, layout, NULL, pixels);
}
