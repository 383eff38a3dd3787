/* lineao_vk.c - the Vulkan executor of lineao's frame graph. MIT licence, see LICENSE.

   Compile beside the file that defines LINEAO_IMPLEMENTATION: cc -c lineao_vk.c. Needs the Vulkan
   headers (1.3.204 or newer) and no Vulkan library: every function comes from
   lao_vk_desc.get_instance_proc. The device is Vulkan 1.3, or 1.2 with VK_KHR_dynamic_rendering and
   VK_KHR_synchronization2; both features must be enabled.

   DOES NOT submit, wait or own a queue (lao_read uses lao_vk_desc.queue, when given), keep global
   state, or know any effect: it loops over the steps of a plan.

   LIFETIME  What a recorded frame uses is kept until `frames_in_flight` further frames were
   recorded. Frames are counted in epochs: a new one begins when a view is executed that was already
   executed in the current one, so that several views per frame count as one frame. A frame that
   was recorded but never submitted costs nothing but its picture. */
#include "lineao.h"

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <vulkan/vulkan_core.h>

#define LINEAO_SHADERS_SPIRV
#include "lineao_shaders.h"

#include <stdio.h>
#include <string.h>

/* ------------------------------------------------------------------------------------ functions */
/* X(name, source). CORE13 names fall back to their KHR alias; OPTIONAL ones belong to
 * VK_EXT_debug_utils. */

/* clang-format off */
#define LAO__VK_FUNCTIONS(X)                                                                       \
    X(GetDeviceProcAddr, INSTANCE) X(GetPhysicalDeviceProperties2, INSTANCE)                       \
    X(GetPhysicalDeviceMemoryProperties, INSTANCE)                                                 \
    X(GetPhysicalDeviceQueueFamilyProperties, INSTANCE)                                            \
    X(GetPhysicalDeviceFormatProperties, INSTANCE) X(AllocateMemory, DEVICE) X(FreeMemory, DEVICE) \
    X(MapMemory, DEVICE) X(CreateBuffer, DEVICE) X(DestroyBuffer, DEVICE)                          \
    X(GetBufferMemoryRequirements, DEVICE) X(BindBufferMemory, DEVICE) X(CreateBufferView, DEVICE) \
    X(DestroyBufferView, DEVICE) X(CreateImage, DEVICE) X(DestroyImage, DEVICE)                    \
    X(GetImageMemoryRequirements, DEVICE) X(BindImageMemory, DEVICE) X(CreateImageView, DEVICE)    \
    X(DestroyImageView, DEVICE) X(CreateSampler, DEVICE) X(DestroySampler, DEVICE)                 \
    X(CreateDescriptorSetLayout, DEVICE) X(DestroyDescriptorSetLayout, DEVICE)                     \
    X(CreatePipelineLayout, DEVICE) X(DestroyPipelineLayout, DEVICE)                               \
    X(CreateDescriptorPool, DEVICE) X(DestroyDescriptorPool, DEVICE)                               \
    X(ResetDescriptorPool, DEVICE) X(AllocateDescriptorSets, DEVICE)                               \
    X(UpdateDescriptorSets, DEVICE) X(CreateShaderModule, DEVICE) X(DestroyShaderModule, DEVICE)   \
    X(CreatePipelineCache, DEVICE) X(DestroyPipelineCache, DEVICE)                                 \
    X(CreateGraphicsPipelines, DEVICE) X(DestroyPipeline, DEVICE) X(CreateQueryPool, DEVICE)       \
    X(DestroyQueryPool, DEVICE) X(GetQueryPoolResults, DEVICE) X(CreateCommandPool, DEVICE)        \
    X(DestroyCommandPool, DEVICE) X(AllocateCommandBuffers, DEVICE) X(BeginCommandBuffer, DEVICE)  \
    X(EndCommandBuffer, DEVICE) X(QueueSubmit, DEVICE) X(QueueWaitIdle, DEVICE)                    \
    X(CmdBindPipeline, DEVICE) X(CmdBindDescriptorSets, DEVICE) X(CmdBindIndexBuffer, DEVICE)      \
    X(CmdPushConstants, DEVICE) X(CmdSetViewport, DEVICE) X(CmdSetScissor, DEVICE)                 \
    X(CmdDraw, DEVICE) X(CmdDrawIndexed, DEVICE) X(CmdResetQueryPool, DEVICE)                      \
    X(CmdWriteTimestamp, DEVICE) X(CmdCopyImageToBuffer, DEVICE) X(CmdBeginRendering, CORE13)      \
    X(CmdEndRendering, CORE13) X(CmdPipelineBarrier2, CORE13)                                      \
    X(CmdBeginDebugUtilsLabelEXT, OPTIONAL) X(CmdEndDebugUtilsLabelEXT, OPTIONAL)                  \
    X(SetDebugUtilsObjectNameEXT, OPTIONAL)
/* clang-format on */

typedef struct lao__vk_functions {
#define LAO__VK_MEMBER(name, source) PFN_vk##name name;
    LAO__VK_FUNCTIONS(LAO__VK_MEMBER)
#undef LAO__VK_MEMBER
} lao__vk_functions;

/* Declares a Vulkan struct, all zero but for its type. */
#define LAO__VK_STRUCT(type, name, structure_type)                                                 \
    type name;                                                                                     \
    memset(&name, 0, sizeof name);                                                                 \
    name.sType = VK_STRUCTURE_TYPE_##structure_type

/* Calls a function of the table; a failure is logged under its name. */
#define LAO__VK_TRY(vk, name, arguments) lao__vk_check(vk, (vk)->call.name arguments, "vk" #name)
/* vkCreate...: a failed call leaves its handle undefined, so that it is cleared here. */
#define LAO__VK_CREATE(vk, name, info, handle)                                                     \
    lao__vk_made(LAO__VK_TRY(vk, Create##name, ((vk)->device, info, NULL, handle)), handle)

/* ---------------------------------------------------------------------------------------- types */

/* Segments per indexed draw: four vertices each must fit 16-bit indices. */
#define LAO__VK_PIECES 4u /* of LAO__VK_QUADS, before a processor catches up */
#define LAO__VK_QUADS 16384u
#define LAO__VK_BARRIERS 16u
#define LAO__VK_STAGES (VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT)

struct lao__vk;

/* The head of whatever frames under way may still use. */
typedef struct lao__vk_object {
    struct lao__vk_object *next;
    uint64_t last_use; /* epoch; 0: never used */
    void (*destroy)(struct lao__vk *vk, struct lao__vk_object *object);
} lao__vk_object;

typedef struct lao__vk_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkBufferView view; /* of texel buffers */
    VkDeviceSize size;
    void *data; /* mapped for life */
} lao__vk_buffer;

typedef struct lao__vk_texels {
    lao__vk_object object;
    lao__vk_buffer buffer;
} lao__vk_texels;

typedef struct lao__vk_image {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
    VkFormat format;
    uint32_t width, height;
    lao_access access; /* the last recorded one; NONE: never used */
} lao__vk_image;

/* The layouts of one shader. */
typedef struct lao__vk_program {
    const lao_shader *shader; /* NULL: not made yet */
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
} lao__vk_program;

/* Everything that tells one pipeline from another; compared byte by byte, so there are no gaps. */
typedef struct lao__vk_key {
    uint32_t shader, blend;
    uint32_t depth_compare; /* VkCompareOp; NEVER: neither test nor write */
    uint32_t depth_read_only;
    uint32_t cull;
    uint32_t depth_format, color_count;
    uint32_t color_formats[LAO_MAX_WRITES];
    int32_t constants[LAO_MAX_CONSTANTS];
} lao__vk_key;

typedef struct lao__vk_pipeline {
    lao__vk_object object; /* `next` chains all pipelines of the context */
    lao__vk_key key;
    VkPipeline pipeline;
    uint32_t users; /* steps of builds */
} lao__vk_pipeline;

/* Descriptor sets, and what they are made of. */
typedef struct lao__vk_need {
    uint32_t sets, images, texels;
} lao__vk_need;

/* What one of the frames in flight has for itself. */
typedef struct lao__vk_frame {
    VkDescriptorPool pool;
    lao__vk_need capacity;
    lao__vk_buffer uniforms;
} lao__vk_frame;

/* A view, made for one plan. */
typedef struct lao__vk_build {
    lao__vk_object object;
    size_t size; /* of this block, the arrays included */
    uint32_t serial, slot_count, step_count;
    uint32_t padded; /* non-zero: a step reads an image that does not exist */
    uint64_t executions;
    lao__vk_image *slots;
    lao__vk_frame *frames;        /* frames_in_flight */
    lao__vk_pipeline **pipelines; /* per step; NULL until the host's formats are known */
    VkDescriptorSet *sets;        /* of the execution being recorded */
    uint32_t set_capacity;
    VkQueryPool queries; /* step_count + 1 timestamps, made with the first timed frame */
    uint32_t timed;      /* non-zero: an execution has written them */
} lao__vk_build;

typedef struct lao__vk_view {
    lao__vk_build *build; /* NULL: empty */
    uint64_t epoch;       /* of the last execution */
} lao__vk_view;

typedef struct lao__vk {
    lao_vk_desc desc;
    const lao_host *host;
    lao__vk_functions call;
    VkDevice device;
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceSize uniform_alignment;
    uint32_t units;          /* textures of one stage */
    double timestamp_period; /* ns */
    uint64_t timestamp_mask; /* 0: no timestamps */
    int software;            /* the device is a processor: lao__vk_catch_up */
    const lao_shader *fullscreen;
    VkSampler sampler;
    VkPipelineCache cache;
    lao__vk_buffer quads;      /* indices of LAO__VK_QUADS quads */
    lao__vk_image absent;      /* stands for images that a plan does not have */
    lao__vk_buffer vacant;     /* the same for texel buffers */
    lao__vk_program *programs; /* per shader of the graph */
    lao__vk_object *pipelines, *retired;
    uint64_t epoch;
} lao__vk;

/* The desc travels by value in lao_backend.storage. */
typedef char lao__vk_desc_fits[sizeof(lao_vk_desc) <= sizeof(((lao_backend *)0)->storage) ? 1 : -1];

/* -------------------------------------------------------------------------- failures and memory */

static lao_result lao__vk_fail(const lao__vk *vk, lao_log_item item, const char *detail) {
#define LAO__VK_RESULT(id, result, text) result,
    static const lao_result results[] = {LAO_LOG_ITEMS(LAO__VK_RESULT)};
#undef LAO__VK_RESULT
    vk->host->report(vk->host->context, item, detail);
    return results[item];
}

static lao_result lao__vk_check(const lao__vk *vk, VkResult result, const char *function) {
    char text[96];
    switch (result) {
    case VK_SUCCESS:
        return LAO_OK;
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return lao__vk_fail(vk, LAO_LOG_BACKEND_MEMORY, function);
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
    case VK_ERROR_FRAGMENTED_POOL:
    case VK_ERROR_TOO_MANY_OBJECTS:
        return lao__vk_fail(vk, LAO_LOG_DEVICE_MEMORY, function);
    case VK_ERROR_DEVICE_LOST:
        return lao__vk_fail(vk, LAO_LOG_DEVICE_LOST, function);
    default:
        snprintf(text, sizeof text, "%s: VkResult %d", function, (int)result);
        return lao__vk_fail(vk, LAO_LOG_BACKEND_CALL, text);
    }
}

static lao_result lao__vk_made(lao_result result, void *handle) {
    if (result)
        memset(handle, 0, sizeof(VkImage)); /* non-dispatchable handles have one size */
    return result;
}

/* Zeroed memory, or NULL with a log item. */
static void *lao__vk_alloc(const lao__vk *vk, size_t size) {
    void *memory = vk->host->allocator.allocate(vk->host->allocator.user, size);
    if (memory) {
        memset(memory, 0, size);
    } else {
        lao__vk_fail(vk, LAO_LOG_BACKEND_MEMORY, "Vulkan");
    }
    return memory;
}

static void lao__vk_free(const lao__vk *vk, void *memory, size_t size) {
    if (memory)
        vk->host->allocator.release(vk->host->allocator.user, memory, size);
}

/* Names an object for debuggers and validation layers. `handle` points to it. */
static void lao__vk_name(const lao__vk *vk, VkObjectType type, const void *handle,
                         const char *name) {
    LAO__VK_STRUCT(VkDebugUtilsObjectNameInfoEXT, info, DEBUG_UTILS_OBJECT_NAME_INFO_EXT);
    if (!vk->call.SetDebugUtilsObjectNameEXT)
        return;
    info.objectType = type;
    info.pObjectName = name;
    memcpy(&info.objectHandle, handle, sizeof(VkImage));
    vk->call.SetDebugUtilsObjectNameEXT(vk->device, &info);
}

/* --------------------------------------------------------------------------- objects and epochs */

static int lao__vk_idle(const lao__vk *vk, const lao__vk_object *object) {
    /* One epoch more than frames in flight: an epoch may begin in the middle of the host's frame.
     */
    return !object->last_use || object->last_use + vk->desc.frames_in_flight < vk->epoch;
}

/* Destroys the object as soon as no frame under way can need it. */
static void lao__vk_retire(lao__vk *vk, lao__vk_object *object) {
    if (lao__vk_idle(vk, object)) {
        object->destroy(vk, object);
    } else {
        object->next = vk->retired;
        vk->retired = object;
    }
}

/* Destroys what neither a step nor a frame in flight uses, but for the `spare` last used: a plan
 * that comes back, as when a setting is tried, finds its pipelines compiled. With 0 nothing may be
 * in use, and all go. */
static void lao__vk_pipelines_trim(lao__vk *vk, uint32_t spare) {
    lao__vk_object **link = &vk->pipelines;
    int all = spare == 0;
    while (*link) {
        lao__vk_pipeline *pipeline = (lao__vk_pipeline *)*link;
        if (all || (!pipeline->users && !spare && lao__vk_idle(vk, *link))) {
            *link = pipeline->object.next;
            pipeline->object.destroy(vk, &pipeline->object);
        } else {
            spare -= !pipeline->users && spare ? 1 : 0;
            link = &pipeline->object.next;
        }
    }
}

static void lao__vk_collect(lao__vk *vk, int all) {
    lao__vk_object **link = &vk->retired;
    while (*link) {
        lao__vk_object *object = *link;
        if (all || lao__vk_idle(vk, object)) {
            *link = object->next;
            object->destroy(vk, object);
        } else {
            link = &object->next;
        }
    }
    lao__vk_pipelines_trim(vk, all ? 0 : LAO_SPARE_PROGRAMS);
}

/* ----------------------------------------------------------------------------- device resources */

/* Memory of a type that has all of the first wish, or else of the second. */
static lao_result lao__vk_memory(const lao__vk *vk, const VkMemoryRequirements *need,
                                 VkMemoryPropertyFlags wish, VkMemoryPropertyFlags otherwise,
                                 VkDeviceMemory *memory) {
    /* Types with further properties (protected, lazy, uncached for debugging) want features that we
     * cannot know of. */
    const VkMemoryPropertyFlags plain =
        VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
        VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
    uint32_t tried = 0, type, round;
    LAO__VK_STRUCT(VkMemoryAllocateInfo, info, MEMORY_ALLOCATE_INFO);
    info.allocationSize = need->size;
    for (round = 0; round < 2; round++) {
        for (type = 0; type < vk->memory.memoryTypeCount; type++) {
            VkMemoryPropertyFlags flags = vk->memory.memoryTypes[type].propertyFlags;
            if (!(need->memoryTypeBits & 1u << type & ~tried) || (flags & ~plain) ||
                (~flags & (round ? otherwise : wish)))
                continue;
            tried |= 1u << type;
            info.memoryTypeIndex = type;
            result = vk->call.AllocateMemory(vk->device, &info, NULL, memory);
            if (result != VK_ERROR_OUT_OF_DEVICE_MEMORY)
                return lao__vk_made(lao__vk_check(vk, result, "vkAllocateMemory"), memory);
        }
    }
    return lao__vk_made(lao__vk_check(vk, result, "vkAllocateMemory"), memory);
}

static void lao__vk_buffer_free(const lao__vk *vk, lao__vk_buffer *buffer) {
    vk->call.DestroyBufferView(vk->device, buffer->view, NULL);
    vk->call.DestroyBuffer(vk->device, buffer->buffer, NULL);
    vk->call.FreeMemory(vk->device, buffer->memory, NULL); /* unmaps */
    memset(buffer, 0, sizeof *buffer);
}

/* A mapped buffer; with a format also its texel view. After a failure `buffer` is empty. */
static lao_result lao__vk_buffer_make(const lao__vk *vk, VkDeviceSize size,
                                      VkBufferUsageFlags usage, VkFormat format, const char *name,
                                      lao__vk_buffer *buffer) {
    const VkMemoryPropertyFlags mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    /* What the CPU reads back wants cached memory, what the GPU reads wants its own. */
    const VkMemoryPropertyFlags better = usage & VK_BUFFER_USAGE_TRANSFER_DST_BIT
                                             ? VK_MEMORY_PROPERTY_HOST_CACHED_BIT
                                             : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    lao_result result;
    VkMemoryRequirements need;
    LAO__VK_STRUCT(VkBufferCreateInfo, info, BUFFER_CREATE_INFO);
    LAO__VK_STRUCT(VkBufferViewCreateInfo, view, BUFFER_VIEW_CREATE_INFO);
    memset(buffer, 0, sizeof *buffer);
    info.size = size;
    info.usage = usage;
    result = LAO__VK_CREATE(vk, Buffer, &info, &buffer->buffer);
    if (!result) {
        vk->call.GetBufferMemoryRequirements(vk->device, buffer->buffer, &need);
        result = lao__vk_memory(vk, &need, mapped | better, mapped, &buffer->memory);
    }
    if (!result)
        result = LAO__VK_TRY(vk, BindBufferMemory, (vk->device, buffer->buffer, buffer->memory, 0));
    if (!result)
        result = LAO__VK_TRY(vk, MapMemory,
                             (vk->device, buffer->memory, 0, VK_WHOLE_SIZE, 0, &buffer->data));
    if (!result && format != VK_FORMAT_UNDEFINED) {
        view.buffer = buffer->buffer;
        view.format = format;
        view.range = VK_WHOLE_SIZE;
        result = LAO__VK_CREATE(vk, BufferView, &view, &buffer->view);
    }
    if (result) {
        lao__vk_buffer_free(vk, buffer);
    } else {
        buffer->size = size;
        lao__vk_name(vk, VK_OBJECT_TYPE_BUFFER, &buffer->buffer, name);
    }
    return result;
}

static VkFormat lao__vk_format(lao_format format) {
    switch (format) {
    case LAO_FORMAT_RGBA8:
        return VK_FORMAT_R8G8B8A8_UNORM;
    case LAO_FORMAT_RGBA16F:
        return VK_FORMAT_R16G16B16A16_SFLOAT;
    case LAO_FORMAT_RGBA32F:
        return VK_FORMAT_R32G32B32A32_SFLOAT;
    case LAO_FORMAT_R32F:
        return VK_FORMAT_R32_SFLOAT;
    case LAO_FORMAT_R32UI:
        return VK_FORMAT_R32_UINT;
    case LAO_FORMAT_D32F:
        return VK_FORMAT_D32_SFLOAT;
    default:
        return VK_FORMAT_UNDEFINED;
    }
}

/* Of a whole image, as barriers want it: hosts may bring depth with stencil. */
static VkImageAspectFlags lao__vk_aspects(VkFormat format) {
    switch (format) {
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D32_SFLOAT:
        return VK_IMAGE_ASPECT_DEPTH_BIT;
    case VK_FORMAT_D16_UNORM_S8_UINT:
    case VK_FORMAT_D24_UNORM_S8_UINT:
    case VK_FORMAT_D32_SFLOAT_S8_UINT:
        return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
    default:
        return VK_IMAGE_ASPECT_COLOR_BIT;
    }
}

static void lao__vk_image_free(const lao__vk *vk, lao__vk_image *image) {
    vk->call.DestroyImageView(vk->device, image->view, NULL);
    vk->call.DestroyImage(vk->device, image->image, NULL);
    vk->call.FreeMemory(vk->device, image->memory, NULL);
    memset(image, 0, sizeof *image);
}

/* After a failure `image` is empty. */
static lao_result lao__vk_image_make(const lao__vk *vk, const lao_plan_slot *slot, const char *name,
                                     lao__vk_image *image) {
    const VkImageUsageFlags attachment = slot->format == LAO_FORMAT_D32F
                                             ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                             : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    lao_result result;
    VkMemoryRequirements need;
    LAO__VK_STRUCT(VkImageCreateInfo, info, IMAGE_CREATE_INFO);
    LAO__VK_STRUCT(VkImageViewCreateInfo, view, IMAGE_VIEW_CREATE_INFO);
    memset(image, 0, sizeof *image);
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = lao__vk_format(slot->format);
    info.extent.width = slot->width;
    info.extent.height = slot->height;
    info.extent.depth = info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | (slot->attached ? attachment : 0u);
    if (slot->sampled || !slot->attached)
        info.usage |= VK_IMAGE_USAGE_SAMPLED_BIT;
    result = LAO__VK_CREATE(vk, Image, &info, &image->image);
    if (!result) {
        vk->call.GetImageMemoryRequirements(vk->device, image->image, &need);
        result = lao__vk_memory(vk, &need, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0, &image->memory);
    }
    if (!result)
        result = LAO__VK_TRY(vk, BindImageMemory, (vk->device, image->image, image->memory, 0));
    if (!result) {
        view.image = image->image;
        view.viewType = VK_IMAGE_VIEW_TYPE_2D;
        view.format = info.format;
        view.subresourceRange.aspectMask = lao__vk_aspects(info.format);
        view.subresourceRange.levelCount = view.subresourceRange.layerCount = 1;
        result = LAO__VK_CREATE(vk, ImageView, &view, &image->view);
    }
    if (result) {
        lao__vk_image_free(vk, image);
        return result;
    }
    image->format = info.format;
    image->width = slot->width;
    image->height = slot->height;
    lao__vk_name(vk, VK_OBJECT_TYPE_IMAGE, &image->image, name);
    return LAO_OK;
}

/* ---------------------------------------------------------------------------- attach and detach */

/* Looks up every function; the missing ones are named in one log item. */
static lao_result lao__vk_load(lao__vk *vk) {
    enum { INSTANCE, DEVICE, CORE13, OPTIONAL };
    static const struct {
        const char *name;
        size_t offset;
        int source;
    } rows[] = {
#define LAO__VK_ROW(name, source) {"vk" #name, offsetof(lao__vk_functions, name), source},
        LAO__VK_FUNCTIONS(LAO__VK_ROW)
#undef LAO__VK_ROW
    };
    char missing[512] = "", alias[64];
    size_t i, used = 0;
    for (i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        void *found = NULL;
        PFN_vkVoidFunction function = NULL;
        if (rows[i].source == INSTANCE) {
            found = vk->desc.get_instance_proc(vk->desc.instance, rows[i].name);
            memcpy(&function, &found, sizeof function);
        } else if (vk->call.GetDeviceProcAddr &&
                   (rows[i].source != OPTIONAL || vk->desc.debug_utils)) {
            /* A 1.2 device may know the 1.3 names of its driver; they are not for us to call. */
            if (rows[i].source != CORE13 || vk->desc.api_version >= VK_API_VERSION_1_3)
                function = vk->call.GetDeviceProcAddr(vk->device, rows[i].name);
            snprintf(alias, sizeof alias, "%sKHR", rows[i].name);
            if (!function && rows[i].source == CORE13)
                function = vk->call.GetDeviceProcAddr(vk->device, alias);
        }
        memcpy((char *)&vk->call + rows[i].offset, &function, sizeof function);
        if (!function && rows[i].source != OPTIONAL && used + 64 < sizeof missing)
            used += (size_t)snprintf(missing + used, sizeof missing - used, "%s%s",
                                     used ? ", " : "", rows[i].name);
        if (!function && !vk->call.GetDeviceProcAddr)
            break; /* everything else would be missing too */
    }
    return used ? lao__vk_fail(vk, LAO_LOG_BACKEND_FUNCTION, missing) : LAO_OK;
}

static uint32_t lao__vk_least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static lao_result lao__vk_check_formats(const lao__vk *vk) {
    static const struct {
        lao_format format;
        VkFormatFeatureFlags image, buffer;
        const char *name;
    } rows[] = {
#define LAO__VK_COLOR (VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT)
        {LAO_FORMAT_RGBA8, LAO__VK_COLOR, VK_FORMAT_FEATURE_UNIFORM_TEXEL_BUFFER_BIT, "RGBA8"},
        {LAO_FORMAT_RGBA16F, LAO__VK_COLOR, 0, "RGBA16F"},
        {LAO_FORMAT_RGBA32F, LAO__VK_COLOR, VK_FORMAT_FEATURE_UNIFORM_TEXEL_BUFFER_BIT, "RGBA32F"},
        {LAO_FORMAT_R32F, LAO__VK_COLOR, 0, "R32F"},
        {LAO_FORMAT_R32UI, LAO__VK_COLOR, 0, "R32UI"},
        {LAO_FORMAT_D32F,
         VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT, 0,
         "D32F"},
#undef LAO__VK_COLOR
    };
    size_t i;
    for (i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        VkFormatProperties has;
        vk->call.GetPhysicalDeviceFormatProperties((VkPhysicalDevice)vk->desc.physical_device,
                                                   lao__vk_format(rows[i].format), &has);
        if ((rows[i].image & ~has.optimalTilingFeatures) || (rows[i].buffer & ~has.bufferFeatures))
            return lao__vk_fail(vk, LAO_LOG_BACKEND_FEATURE, rows[i].name);
    }
    return LAO_OK;
}

/* The family that the host submits to: it must draw, and may or may not have a clock. */
static lao_result lao__vk_check_queue(lao__vk *vk, float timestamp_period) {
    VkQueueFamilyProperties families[32];
    uint32_t count = 32, bits;
    vk->call.GetPhysicalDeviceQueueFamilyProperties((VkPhysicalDevice)vk->desc.physical_device,
                                                    &count, families);
    if (vk->desc.queue_family >= count ||
        !(families[vk->desc.queue_family].queueFlags & VK_QUEUE_GRAPHICS_BIT))
        return lao__vk_fail(vk, LAO_LOG_BACKEND_FEATURE, "a queue family that draws");
    bits = families[vk->desc.queue_family].timestampValidBits;
    vk->timestamp_mask = bits >= 64 ? ~(uint64_t)0 : ((uint64_t)1 << bits) - 1;
    vk->timestamp_period = (double)timestamp_period;
    return LAO_OK;
}

/* Fills caps, or says what the device lacks. */
static lao_result lao__vk_check_device(lao__vk *vk, lao_backend_caps *caps) {
    const VkPhysicalDevice physical = (VkPhysicalDevice)vk->desc.physical_device;
    VkPhysicalDeviceLimits limits;
    VkDeviceSize texels = 1u << 27; /* four vertices a segment, in 31 bits of vertex offset */
    lao_result result;
    LAO__VK_STRUCT(VkPhysicalDeviceProperties2, properties, PHYSICAL_DEVICE_PROPERTIES_2);
    LAO__VK_STRUCT(VkPhysicalDeviceMaintenance3Properties, most,
                   PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES);
    properties.pNext = &most;
    vk->call.GetPhysicalDeviceMemoryProperties(physical, &vk->memory);
    vk->call.GetPhysicalDeviceProperties2(physical, &properties);
    if (vk->desc.api_version < VK_API_VERSION_1_2 ||
        properties.properties.apiVersion < VK_API_VERSION_1_2)
        return lao__vk_fail(vk, LAO_LOG_BACKEND_FEATURE, "Vulkan 1.2");
    limits = properties.properties.limits;
    result = lao__vk_check_queue(vk, limits.timestampPeriod);
    if (!result)
        result = lao__vk_check_formats(vk);
    if (result)
        return result;
    vk->software = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    vk->uniform_alignment = limits.minUniformBufferOffsetAlignment;
    if (texels > most.maxMemoryAllocationSize / 16)
        texels = most.maxMemoryAllocationSize / 16;
    caps->max_buffer_texels = lao__vk_least((uint32_t)texels, limits.maxTexelBufferElements);
    caps->max_image_size =
        lao__vk_least(limits.maxImageDimension2D,
                      lao__vk_least(limits.maxFramebufferWidth, limits.maxFramebufferHeight));
    caps->max_texture_units = vk->units = lao__vk_least(limits.maxPerStageDescriptorSamplers,
                                                        limits.maxPerStageDescriptorSampledImages);
    caps->shaders = lao_shaders;
    caps->shader_count = lao_shader_count;
    return LAO_OK;
}

static lao_result lao__vk_sampler_make(lao__vk *vk) {
    LAO__VK_STRUCT(VkSamplerCreateInfo, info, SAMPLER_CREATE_INFO);
    info.magFilter = info.minFilter = VK_FILTER_NEAREST;
    info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
    info.addressModeU = info.addressModeV = info.addressModeW =
        VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    /* not 0, though images have one level: lavapipe samples at half the speed behind a clamp to it
     */
    info.maxLod = VK_LOD_CLAMP_NONE;
    return LAO__VK_CREATE(vk, Sampler, &info, &vk->sampler);
}

static lao_result lao__vk_quads_make(lao__vk *vk) {
    uint32_t quad, corner;
    uint16_t *index;
    lao_result result = lao__vk_buffer_make(vk, (VkDeviceSize)LAO__VK_QUADS * 6 * sizeof(uint16_t),
                                            VK_BUFFER_USAGE_INDEX_BUFFER_BIT, VK_FORMAT_UNDEFINED,
                                            "lineao quads", &vk->quads);
    if (result)
        return result;
    index = (uint16_t *)vk->quads.data;
    for (quad = 0; quad < LAO__VK_QUADS; quad++) {
        static const uint16_t corners[6] = {0, 1, 2, 2, 1, 3};
        for (corner = 0; corner < 6; corner++)
            *index++ = (uint16_t)(4 * quad + corners[corner]);
    }
    return LAO_OK;
}

/* What all views share. */
static lao_result lao__vk_common_make(lao__vk *vk) {
    lao_plan_slot slot;
    uint32_t i;
    lao_result result;
    LAO__VK_STRUCT(VkPipelineCacheCreateInfo, cache, PIPELINE_CACHE_CREATE_INFO);
    memset(&slot, 0, sizeof slot);
    slot.format = LAO_FORMAT_RGBA8;
    slot.width = slot.height = slot.sampled = 1;
    for (i = 0; i < lao_shader_count; i++) {
        if (strcmp(lao_shaders[i].name, "fullscreen") == 0)
            vk->fullscreen = &lao_shaders[i];
    }
    vk->programs = (lao__vk_program *)lao__vk_alloc(vk, (vk->host->graph->shader_count + 1) *
                                                            sizeof *vk->programs);
    if (!vk->programs)
        return LAO_ERROR_OUT_OF_MEMORY;
    result = lao__vk_sampler_make(vk);
    if (!result)
        result = LAO__VK_CREATE(vk, PipelineCache, &cache, &vk->cache);
    if (!result)
        result = lao__vk_quads_make(vk);
    if (!result)
        result = lao__vk_image_make(vk, &slot, "lineao absent", &vk->absent);
    if (!result)
        result = lao__vk_buffer_make(vk, 16, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
                                     VK_FORMAT_R32G32B32A32_SFLOAT, "lineao vacant", &vk->vacant);
    return result;
}

static void lao__vk_common_free(lao__vk *vk) {
    uint32_t i;
    lao__vk_collect(vk, 1);
    for (i = 0; vk->programs && i < vk->host->graph->shader_count; i++) {
        vk->call.DestroyPipelineLayout(vk->device, vk->programs[i].layout, NULL);
        vk->call.DestroyDescriptorSetLayout(vk->device, vk->programs[i].set_layout, NULL);
    }
    lao__vk_free(vk, vk->programs, (vk->host->graph->shader_count + 1) * sizeof *vk->programs);
    lao__vk_buffer_free(vk, &vk->vacant);
    lao__vk_image_free(vk, &vk->absent);
    lao__vk_buffer_free(vk, &vk->quads);
    vk->call.DestroyPipelineCache(vk->device, vk->cache, NULL);
    vk->call.DestroySampler(vk->device, vk->sampler, NULL);
}

static void lao__vk_detach(void *self) {
    lao__vk *vk = (lao__vk *)self;
    lao__vk_common_free(vk);
    lao__vk_free(vk, vk, sizeof *vk);
}

static lao_result lao__vk_attach(const lao_backend *backend, const lao_host *host, void **self,
                                 lao_backend_caps *caps) {
    lao__vk *vk = (lao__vk *)host->allocator.allocate(host->allocator.user, sizeof *vk);
    lao_result result;
    if (!vk) {
        host->report(host->context, LAO_LOG_BACKEND_MEMORY, "Vulkan");
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    memset(vk, 0, sizeof *vk);
    memcpy(&vk->desc, backend->storage, sizeof vk->desc);
    vk->host = host;
    vk->device = (VkDevice)vk->desc.device;
    vk->epoch = 1;
    result = lao__vk_load(vk);
    if (!result)
        result = lao__vk_check_device(vk, caps);
    if (result) {
        lao__vk_free(vk, vk, sizeof *vk);
        return result;
    }
    result = lao__vk_common_make(vk);
    if (result) {
        lao__vk_detach(vk);
    } else {
        *self = vk;
    }
    return result;
}

/* -------------------------------------------------------------------------------------- buffers */

static void lao__vk_texels_free(lao__vk *vk, lao__vk_object *object) {
    lao__vk_texels *texels = (lao__vk_texels *)object;
    lao__vk_buffer_free(vk, &texels->buffer);
    lao__vk_free(vk, texels, sizeof *texels);
}

static lao_result lao__vk_buffer_create(void *self, const lao_buffer_desc *desc, void **buffer) {
    lao__vk *vk = (lao__vk *)self;
    const size_t size = (size_t)desc->texel_count * lao_format_bytes(desc->format);
    lao__vk_texels *texels = (lao__vk_texels *)lao__vk_alloc(vk, sizeof *texels);
    lao_result result;
    if (!texels)
        return LAO_ERROR_OUT_OF_MEMORY;
    texels->object.destroy = lao__vk_texels_free;
    result = lao__vk_buffer_make(vk, size ? size : 16, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
                                 lao__vk_format(desc->format), "lineao line set", &texels->buffer);
    if (result) {
        lao__vk_free(vk, texels, sizeof *texels);
        return result;
    }
    if (size)
        memcpy(texels->buffer.data, desc->data, size);
    *buffer = texels;
    return LAO_OK;
}

static void lao__vk_buffer_destroy(void *self, void *buffer) {
    lao__vk_texels *texels = (lao__vk_texels *)buffer;
    if (texels)
        lao__vk_retire((lao__vk *)self, &texels->object);
}

/* ----------------------------------------------------------------------- programs and pipelines */

/* The image that the host lends for an instance; NULL: the image is ours. */
static const lao_image *lao__vk_lent(const lao_execution *execution,
                                     const lao_plan_instance *instance) {
    if (instance->import == LAO_NO_INDEX)
        return NULL;
    return instance->import == LAO_IMPORT_TARGET ? &execution->target
                                                 : &execution->imports[instance->import].source;
}

/* Layouts of the shader, made once. */
static lao_result lao__vk_program_make(lao__vk *vk, uint32_t index, const lao_shader *shader) {
    lao__vk_program *program = &vk->programs[index], made;
    VkDescriptorSetLayoutBinding bindings[2 + LAO_MAX_READS];
    VkPushConstantRange step;
    char text[256];
    uint32_t i;
    lao_result result;
    LAO__VK_STRUCT(VkDescriptorSetLayoutCreateInfo, set, DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    LAO__VK_STRUCT(VkPipelineLayoutCreateInfo, layout, PIPELINE_LAYOUT_CREATE_INFO);
    if (program->shader)
        return LAO_OK;
    if (!shader || !shader->fragment.words || (!shader->vertex.words && !vk->fullscreen)) {
        snprintf(text, sizeof text, LAO_NO_SHADER, vk->host->graph->shader_names[index]);
        return lao__vk_fail(vk, LAO_LOG_SHADER_COMPILE, text);
    }
    if (shader->texture_count > lao__vk_least(vk->units, LAO_MAX_READS))
        return lao__vk_fail(vk, LAO_LOG_UNITS, shader->name);
    memset(&made, 0, sizeof made);
    memset(bindings, 0, sizeof bindings);
    for (i = 0; i < 2 + shader->texture_count; i++) {
        bindings[i].binding = i;
        bindings[i].descriptorCount = 1;
        bindings[i].stageFlags = LAO__VK_STAGES;
        bindings[i].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        if (i >= 2 && shader->texture_types[i - 2] == LAO_TEXTURE_BUFFER) {
            bindings[i].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
        } else if (i >= 2) {
            bindings[i].descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
            bindings[i].pImmutableSamplers = &vk->sampler;
        }
    }
    set.bindingCount = i;
    set.pBindings = bindings;
    step.stageFlags = LAO__VK_STAGES;
    step.offset = 0;
    step.size = sizeof(((lao_plan_step *)0)->uniforms);
    layout.setLayoutCount = layout.pushConstantRangeCount = 1;
    layout.pSetLayouts = &made.set_layout;
    layout.pPushConstantRanges = &step;
    result = LAO__VK_CREATE(vk, DescriptorSetLayout, &set, &made.set_layout);
    if (!result)
        result = LAO__VK_CREATE(vk, PipelineLayout, &layout, &made.layout);
    if (result) {
        vk->call.DestroyDescriptorSetLayout(vk->device, made.set_layout, NULL);
        return result;
    }
    made.shader = shader;
    *program = made;
    return LAO_OK;
}

/* Without the locations at the end that are not there: validation warns about outputs to them. */
static uint32_t lao__vk_color_count(const lao_plan_step *step) {
    uint32_t count = step->color_count;
    while (count && step->colors[count - 1].instance == LAO_NO_INDEX)
        count--;
    return count;
}

/* The key of a step's pipeline. Returns 0 when it hangs on a format that only the host knows and
 * `execution` is NULL. */
static int lao__vk_key_make(const lao_plan *plan, const lao_plan_step *step,
                            const lao_execution *execution, lao__vk_key *key) {
    uint32_t i;
    int known = 1;
    memset(key, 0, sizeof *key);
    key->shader = step->shader;
    key->blend = (uint32_t)step->row->blend;
    key->cull = (uint32_t)step->row->cull;
    key->color_count = lao__vk_color_count(step);
    memcpy(key->constants, step->constants, sizeof key->constants);
    for (i = 0; i <= key->color_count; i++) {
        const int depth = i == key->color_count;
        const uint32_t index = (depth ? &step->depth : &step->colors[i])->instance;
        uint32_t *format = depth ? &key->depth_format : &key->color_formats[i];
        const lao_plan_instance *instance;
        if (index == LAO_NO_INDEX)
            continue; /* VK_FORMAT_UNDEFINED */
        instance = &plan->instances[index];
        if (instance->import == LAO_NO_INDEX) {
            *format = (uint32_t)lao__vk_format(instance->format);
        } else if (execution) {
            *format = lao__vk_lent(execution, instance)->native_format;
        } else {
            known = 0;
        }
    }
    if (step->depth.instance != LAO_NO_INDEX && step->row->depth == LAO_DEPTH_ALWAYS)
        key->depth_compare = VK_COMPARE_OP_ALWAYS;
    if (step->depth.instance != LAO_NO_INDEX && step->row->depth == LAO_DEPTH_NEARER)
        key->depth_compare = plan->reverse_depth ? VK_COMPARE_OP_GREATER : VK_COMPARE_OP_LESS;
    if (step->depth.instance != LAO_NO_INDEX && step->row->depth == LAO_DEPTH_COVERED) {
        key->depth_compare = plan->reverse_depth ? VK_COMPARE_OP_LESS : VK_COMPARE_OP_GREATER;
        key->depth_read_only = 1;
    }
    return known;
}

static VkPipelineColorBlendAttachmentState lao__vk_blend(lao_blend blend) {
    VkPipelineColorBlendAttachmentState state;
    memset(&state, 0, sizeof state);
    state.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                           VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    state.blendEnable = blend != LAO_BLEND_NONE;
    state.srcColorBlendFactor = state.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
    state.dstColorBlendFactor = state.dstAlphaBlendFactor =
        blend == LAO_BLEND_OVER ? VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA : VK_BLEND_FACTOR_ONE;
    return state;
}

/* Fixed functions and the call; `stages` hold the modules. */
static lao_result lao__vk_pipeline_compile(lao__vk *vk, const lao__vk_key *key,
                                           const VkPipelineShaderStageCreateInfo stages[2],
                                           VkPipeline *pipeline) {
    static const VkDynamicState dynamics[2] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineColorBlendAttachmentState blends[LAO_MAX_WRITES];
    VkFormat formats[LAO_MAX_WRITES];
    uint32_t i;
    LAO__VK_STRUCT(VkPipelineVertexInputStateCreateInfo, vertices,
                   PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
    LAO__VK_STRUCT(VkPipelineInputAssemblyStateCreateInfo, assembly,
                   PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
    LAO__VK_STRUCT(VkPipelineViewportStateCreateInfo, viewport,
                   PIPELINE_VIEWPORT_STATE_CREATE_INFO);
    LAO__VK_STRUCT(VkPipelineRasterizationStateCreateInfo, raster,
                   PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
    LAO__VK_STRUCT(VkPipelineMultisampleStateCreateInfo, samples,
                   PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
    LAO__VK_STRUCT(VkPipelineDepthStencilStateCreateInfo, depth,
                   PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
    LAO__VK_STRUCT(VkPipelineColorBlendStateCreateInfo, blend,
                   PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
    LAO__VK_STRUCT(VkPipelineDynamicStateCreateInfo, dynamic, PIPELINE_DYNAMIC_STATE_CREATE_INFO);
    LAO__VK_STRUCT(VkPipelineRenderingCreateInfo, rendering, PIPELINE_RENDERING_CREATE_INFO);
    LAO__VK_STRUCT(VkGraphicsPipelineCreateInfo, info, GRAPHICS_PIPELINE_CREATE_INFO);
    for (i = 0; i < key->color_count; i++) {
        formats[i] = (VkFormat)key->color_formats[i];
        blends[i] =
            lao__vk_blend((lao_blend)key->blend); /* all alike: no independentBlend needed */
    }
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    viewport.viewportCount = viewport.scissorCount = 1;
    raster.polygonMode = VK_POLYGON_MODE_FILL;
    raster.cullMode = key->cull == LAO_CULL_BACK    ? VK_CULL_MODE_BACK_BIT
                      : key->cull == LAO_CULL_FRONT ? VK_CULL_MODE_FRONT_BIT
                                                    : VK_CULL_MODE_NONE;
    raster.frontFace =
        VK_FRONT_FACE_CLOCKWISE; /* rows count upwards, so it is the other way round */
    raster.lineWidth = 1;
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    depth.depthCompareOp = (VkCompareOp)key->depth_compare;
    depth.depthTestEnable = key->depth_compare != VK_COMPARE_OP_NEVER;
    depth.depthWriteEnable = depth.depthTestEnable && !key->depth_read_only;
    blend.attachmentCount = rendering.colorAttachmentCount = key->color_count;
    blend.pAttachments = blends;
    dynamic.dynamicStateCount = 2;
    dynamic.pDynamicStates = dynamics;
    rendering.pColorAttachmentFormats = formats;
    rendering.depthAttachmentFormat = (VkFormat)key->depth_format;
    info.pNext = &rendering;
    info.stageCount = 2;
    info.pStages = stages;
    info.pVertexInputState = &vertices;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = vk->programs[key->shader].layout;
    return LAO__VK_TRY(vk, CreateGraphicsPipelines,
                       (vk->device, vk->cache, 1, &info, NULL, pipeline));
}

/* Modules and constants, then the rest. */
static lao_result lao__vk_pipeline_make(lao__vk *vk, const lao__vk_key *key, VkPipeline *pipeline) {
    const lao_shader *shader = vk->programs[key->shader].shader;
    const lao_shader_stage *texts[2];
    VkPipelineShaderStageCreateInfo stages[2];
    VkSpecializationMapEntry entries[LAO_MAX_CONSTANTS];
    VkSpecializationInfo constants;
    lao_result result = LAO_OK;
    uint32_t i;
    texts[0] = shader->vertex.words ? &shader->vertex : &vk->fullscreen->vertex;
    texts[1] = &shader->fragment;
    for (i = 0; i < LAO_MAX_CONSTANTS; i++) {
        entries[i].constantID = i;
        entries[i].offset = i * (uint32_t)sizeof key->constants[0];
        entries[i].size = sizeof key->constants[0];
    }
    constants.mapEntryCount = lao__vk_least(shader->constant_count, LAO_MAX_CONSTANTS);
    constants.pMapEntries = entries;
    constants.dataSize = sizeof key->constants;
    constants.pData = key->constants;
    memset(stages, 0, sizeof stages);
    for (i = 0; i < 2 && !result; i++) {
        LAO__VK_STRUCT(VkShaderModuleCreateInfo, info, SHADER_MODULE_CREATE_INFO);
        info.codeSize = texts[i]->word_count * sizeof(uint32_t);
        info.pCode = texts[i]->words;
        stages[i].sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        stages[i].stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT;
        stages[i].pName = "main";
        stages[i].pSpecializationInfo = &constants;
        result = LAO__VK_CREATE(vk, ShaderModule, &info, &stages[i].module);
    }
    if (!result)
        result = lao__vk_pipeline_compile(vk, key, stages, pipeline);
    for (i = 0; i < 2; i++)
        vk->call.DestroyShaderModule(vk->device, stages[i].module, NULL);
    return result;
}

static void lao__vk_pipeline_free(lao__vk *vk, lao__vk_object *object) {
    lao__vk_pipeline *pipeline = (lao__vk_pipeline *)object;
    vk->call.DestroyPipeline(vk->device, pipeline->pipeline, NULL);
    lao__vk_free(vk, pipeline, sizeof *pipeline);
}

static lao_result lao__vk_pipeline_new(lao__vk *vk, const lao__vk_key *key, const char *name,
                                       lao__vk_pipeline **made) {
    lao__vk_pipeline *pipeline = (lao__vk_pipeline *)lao__vk_alloc(vk, sizeof *pipeline);
    lao_result result;
    if (!pipeline)
        return LAO_ERROR_OUT_OF_MEMORY;
    result = lao__vk_pipeline_make(vk, key, &pipeline->pipeline);
    if (result) {
        lao__vk_free(vk, pipeline, sizeof *pipeline);
        return result;
    }
    pipeline->key = *key;
    pipeline->object.destroy = lao__vk_pipeline_free;
    lao__vk_name(vk, VK_OBJECT_TYPE_PIPELINE, &pipeline->pipeline, name);
    *made = pipeline;
    return LAO_OK;
}

/* Gives a step the pipeline of this key, made or found, in place of the one it has; the last used
 * stands first. */
static lao_result lao__vk_pipeline_use(lao__vk *vk, const lao__vk_key *key, const char *name,
                                       lao__vk_pipeline **used) {
    lao__vk_object **link = &vk->pipelines;
    lao__vk_pipeline *found;
    lao_result result = LAO_OK;
    if (*used && memcmp(&(*used)->key, key, sizeof *key) == 0)
        return LAO_OK;
    while (*link && memcmp(&((lao__vk_pipeline *)*link)->key, key, sizeof *key) != 0)
        link = &(*link)->next;
    found = (lao__vk_pipeline *)*link;
    if (found)
        *link = found->object.next;
    else
        result = lao__vk_pipeline_new(vk, key, name, &found);
    if (result)
        return result;
    found->object.next = vk->pipelines;
    vk->pipelines = &found->object;
    if (*used)
        (*used)->users--;
    found->users++;
    *used = found;
    return LAO_OK;
}

/* ---------------------------------------------------------------------------------------- views */

static lao_result lao__vk_view_create(void *self, void **view) {
    void *made = lao__vk_alloc((lao__vk *)self, sizeof(lao__vk_view));
    if (!made)
        return LAO_ERROR_OUT_OF_MEMORY;
    *view = made;
    return LAO_OK;
}

static void lao__vk_build_free(lao__vk *vk, lao__vk_object *object) {
    lao__vk_build *build = (lao__vk_build *)object;
    uint32_t i;
    for (i = 0; i < build->slot_count; i++)
        lao__vk_image_free(vk, &build->slots[i]);
    for (i = 0; i < vk->desc.frames_in_flight; i++) {
        vk->call.DestroyDescriptorPool(vk->device, build->frames[i].pool, NULL);
        lao__vk_buffer_free(vk, &build->frames[i].uniforms);
    }
    vk->call.DestroyQueryPool(vk->device, build->queries, NULL);
    lao__vk_free(vk, build->sets, build->set_capacity * sizeof(VkDescriptorSet));
    lao__vk_free(vk, build, build->size);
}

/* Empties a view. */
static void lao__vk_view_clear(lao__vk *vk, lao__vk_view *view) {
    lao__vk_build *build = view->build;
    uint32_t i;
    view->build = NULL;
    if (!build)
        return;
    for (i = 0; i < build->step_count; i++) {
        if (build->pipelines[i])
            build->pipelines[i]->users--;
    }
    lao__vk_retire(vk, &build->object);
    lao__vk_collect(vk, 0);
}

static void lao__vk_view_destroy(void *self, void *view) {
    if (view) {
        lao__vk_view_clear((lao__vk *)self, (lao__vk_view *)view);
        lao__vk_free((lao__vk *)self, view, sizeof(lao__vk_view));
    }
}

/* One block: the struct, then its arrays, the most strictly aligned first. */
static lao__vk_build *lao__vk_build_alloc(lao__vk *vk, const lao_plan *plan) {
    const size_t slots = plan->slot_count * sizeof(lao__vk_image);
    const size_t frames = vk->desc.frames_in_flight * sizeof(lao__vk_frame);
    const size_t size =
        sizeof(lao__vk_build) + slots + frames + plan->step_count * sizeof(lao__vk_pipeline *);
    char *block = (char *)lao__vk_alloc(vk, size);
    lao__vk_build *build = (lao__vk_build *)(void *)block;
    if (!build)
        return NULL;
    build->object.destroy = lao__vk_build_free;
    build->size = size;
    build->serial = plan->serial;
    build->slot_count = plan->slot_count;
    build->step_count = plan->step_count;
    build->slots = (lao__vk_image *)(void *)(block + sizeof *build);
    build->frames = (lao__vk_frame *)(void *)(block + sizeof *build + slots);
    build->pipelines = (lao__vk_pipeline **)(void *)(block + sizeof *build + slots + frames);
    return build;
}

/* The row name of the first image that lives in a slot. */
static const char *lao__vk_slot_name(const lao__vk *vk, const lao_plan *plan, uint32_t slot) {
    uint32_t i;
    for (i = 0; i < plan->instance_count; i++) {
        const lao_plan_instance *instance = &plan->instances[i];
        if (instance->import == LAO_NO_INDEX &&
            (instance->slot[0] == slot || instance->slot[1] == slot))
            return vk->host->graph->images[instance->image]->name;
    }
    return "lineao image";
}

static int lao__vk_step_padded(const lao_plan_step *step, const lao_shader *shader) {
    uint32_t i;
    for (i = 0; i < shader->texture_count; i++) {
        if (shader->texture_types[i] == LAO_TEXTURE_2D &&
            (i >= step->read_count || step->reads[i] == LAO_NO_INDEX))
            return 1;
    }
    return 0;
}

static lao_result lao__vk_build_fill(lao__vk *vk, lao__vk_build *build, const lao_plan *plan,
                                     const lao_shader *const *shaders) {
    uint32_t i;
    lao_result result = LAO_OK;
    for (i = 0; i < plan->slot_count && !result; i++)
        result = lao__vk_image_make(vk, &plan->slots[i], lao__vk_slot_name(vk, plan, i),
                                    &build->slots[i]);
    for (i = 0; i < plan->step_count && !result; i++) {
        const lao_plan_step *step = &plan->steps[i];
        lao__vk_key key;
        result = lao__vk_program_make(vk, step->shader, shaders[step->shader]);
        if (!result && lao__vk_step_padded(step, shaders[step->shader]))
            build->padded = 1;
        if (!result && lao__vk_key_make(plan, step, NULL, &key))
            result = lao__vk_pipeline_use(vk, &key, step->row->name, &build->pipelines[i]);
    }
    return result;
}

static lao_result lao__vk_view_prepare(void *self, void *view, const lao_plan *plan,
                                       const lao_shader *const *shaders) {
    lao__vk *vk = (lao__vk *)self;
    lao__vk_view *target = (lao__vk_view *)view, old = *target;
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    target->build = lao__vk_build_alloc(vk, plan);
    if (target->build)
        result = lao__vk_build_fill(vk, target->build, plan, shaders);
    if (result)
        lao__vk_view_clear(vk, target);
    lao__vk_view_clear(vk, &old); /* last, so that the new build finds its pipelines */
    return result;
}

/* -------------------------------------------------------------------- a frame, before recording */
/* Whatever can fail happens before the first command, so that a failed frame leaves the host's
   commands as they were. */

static lao_result lao__vk_check_lent(const lao__vk *vk, const lao_execution *execution) {
    const lao_plan *plan = execution->plan;
    uint32_t i;
    for (i = 0; i < plan->instance_count; i++) {
        const lao_image *image = lao__vk_lent(execution, &plan->instances[i]);
        if (image && (!image->native || !image->native_view || !image->native_format))
            return lao__vk_fail(vk, LAO_LOG_IMPORT, "VkImage, VkImageView and VkFormat are needed");
    }
    return LAO_OK;
}

static lao__vk_need lao__vk_need_of(const lao__vk *vk, const lao_execution *execution) {
    lao__vk_need need = {0, 0, 0};
    uint32_t i, k;
    for (i = 0; i < execution->plan->step_count; i++) {
        const lao_plan_step *step = &execution->plan->steps[i];
        const lao_shader *shader = vk->programs[step->shader].shader;
        const lao_chunk *chunks;
        const uint32_t draws = lao_step_draws(execution, step, &chunks);
        need.sets += draws;
        for (k = 0; k < shader->texture_count; k++)
            *(shader->texture_types[k] == LAO_TEXTURE_2D ? &need.images : &need.texels) += draws;
    }
    return need;
}

static lao_result lao__vk_pool_make(const lao__vk *vk, const lao__vk_need *need,
                                    VkDescriptorPool *pool) {
    VkDescriptorPoolSize sizes[3];
    LAO__VK_STRUCT(VkDescriptorPoolCreateInfo, info, DESCRIPTOR_POOL_CREATE_INFO);
    sizes[0].type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    sizes[0].descriptorCount = 2 * need->sets;
    sizes[1].type = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    sizes[1].descriptorCount = need->images + 1; /* none is not allowed */
    sizes[2].type = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    sizes[2].descriptorCount = need->texels + 1;
    info.maxSets = need->sets;
    info.poolSizeCount = 3;
    info.pPoolSizes = sizes;
    return LAO__VK_CREATE(vk, DescriptorPool, &info, pool);
}

/* Makes the frame large enough. The frame that used it before has finished, so its parts may go at
 * once. */
static lao_result lao__vk_frame_fit(const lao__vk *vk, lao__vk_frame *frame,
                                    const lao__vk_need *need, VkDeviceSize uniforms) {
    if (need->sets > frame->capacity.sets || need->images > frame->capacity.images ||
        need->texels > frame->capacity.texels) {
        lao_result result;
        vk->call.DestroyDescriptorPool(vk->device, frame->pool, NULL);
        memset(&frame->pool, 0, sizeof(VkDescriptorPool));
        memset(&frame->capacity, 0, sizeof frame->capacity);
        result = lao__vk_pool_make(vk, need, &frame->pool);
        if (result)
            return result;
        frame->capacity = *need;
    }
    if (uniforms <= frame->uniforms.size)
        return LAO_OK;
    lao__vk_buffer_free(vk, &frame->uniforms);
    return lao__vk_buffer_make(vk, uniforms, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
                               VK_FORMAT_UNDEFINED, "lineao uniforms", &frame->uniforms);
}

static VkDeviceSize lao__vk_align(const lao__vk *vk, uint32_t size) {
    const VkDeviceSize step = vk->uniform_alignment ? vk->uniform_alignment : 1;
    return ((size ? size : 16) + step - 1) / step * step;
}

/* Sizes the frame and fills its uniforms: the frame's block, then each set's. */
static lao_result lao__vk_frame_begin(lao__vk *vk, lao__vk_build *build,
                                      const lao_execution *execution, lao__vk_frame *frame) {
    const lao__vk_need need = lao__vk_need_of(vk, execution);
    const uint32_t block = vk->host->settings_size;
    const VkDeviceSize first = lao__vk_align(vk, execution->frame_size),
                       next = lao__vk_align(vk, block);
    const uint32_t blocks = execution->set_count * vk->host->graph->module_count;
    const VkDeviceSize total = first + next * blocks;
    lao_result result = LAO_OK;
    uint32_t i;
    if (need.sets > build->set_capacity) {
        lao__vk_free(vk, build->sets, build->set_capacity * sizeof(VkDescriptorSet));
        build->set_capacity = 0;
        build->sets = (VkDescriptorSet *)lao__vk_alloc(vk, need.sets * sizeof(VkDescriptorSet));
        if (!build->sets)
            return LAO_ERROR_OUT_OF_MEMORY;
        build->set_capacity = need.sets;
    }
    result = lao__vk_frame_fit(vk, frame, &need, total);
    if (!result && frame->pool)
        result = LAO__VK_TRY(vk, ResetDescriptorPool, (vk->device, frame->pool, 0));
    if (result)
        return result;
    memcpy(frame->uniforms.data, execution->frame_uniforms, execution->frame_size);
    for (i = 0; i < blocks && block; i++)
        memcpy((char *)frame->uniforms.data + first + next * i,
               (const char *)execution->set_uniforms + (size_t)block * i, block);
    return LAO_OK;
}

static VkImageView lao__vk_attachment_view(const lao__vk_build *build,
                                           const lao_execution *execution, uint32_t index) {
    const lao_plan_instance *instance = &execution->plan->instances[index];
    const lao_image *lent = lao__vk_lent(execution, instance);
    VkImageView view;
    if (!lent)
        return build->slots[instance->slot[execution->parity & 1]].view;
    memcpy(&view, &lent->native_view, sizeof(VkImageView));
    return view;
}

static VkBufferView lao__vk_texel_view(const lao__vk *vk, const lao_chunk *chunk, uint32_t read) {
    const void *buffer = LAO_READ_IS_BUFFER(read) ? chunk->buffers[read - LAO_READ_BUFFER] : NULL;
    return buffer ? ((const lao__vk_texels *)buffer)->buffer.view : vk->vacant.view;
}

/* Writes one descriptor set: frame block, set's block, what the step reads. */
static void lao__vk_describe(const lao__vk *vk, const lao__vk_build *build,
                             const lao__vk_frame *frame, const lao_execution *execution,
                             const lao_plan_step *step, const lao_chunk *chunk,
                             VkDescriptorSet set) {
    const lao_shader *shader = vk->programs[step->shader].shader;
    const VkDeviceSize first = lao__vk_align(vk, execution->frame_size);
    const VkDeviceSize next = lao__vk_align(vk, vk->host->settings_size);
    VkDescriptorBufferInfo blocks[2];
    VkDescriptorImageInfo images[LAO_MAX_READS];
    VkBufferView texels[LAO_MAX_READS];
    VkWriteDescriptorSet writes[1 + LAO_MAX_READS];
    uint32_t i;
    memset(images, 0, sizeof images);
    memset(writes, 0, sizeof writes);
    blocks[0].buffer = blocks[1].buffer = frame->uniforms.buffer;
    blocks[0].offset = 0;
    blocks[0].range = first;
    blocks[1].offset = first + next * (step->set * vk->host->graph->module_count + step->module);
    blocks[1].range = next;
    for (i = 0; i <= shader->texture_count; i++) {
        writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        writes[i].dstSet = set;
        writes[i].dstBinding = i ? i + 1 : 0;
        writes[i].descriptorCount = i ? 1 : 2; /* both blocks at once */
        writes[i].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    }
    writes[0].pBufferInfo = blocks;
    for (i = 0; i < shader->texture_count; i++) {
        const uint32_t read = i < step->read_count ? step->reads[i] : LAO_NO_INDEX;
        if (shader->texture_types[i] == LAO_TEXTURE_BUFFER) {
            texels[i] = lao__vk_texel_view(vk, chunk, read);
            writes[i + 1].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
            writes[i + 1].pTexelBufferView = &texels[i];
        } else {
            images[i].imageView = read < execution->plan->instance_count
                                      ? lao__vk_attachment_view(build, execution, read)
                                      : vk->absent.view;
            images[i].imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
            writes[i + 1].descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
            writes[i + 1].pImageInfo = &images[i];
        }
    }
    vk->call.UpdateDescriptorSets(vk->device, shader->texture_count + 1, writes, 0, NULL);
}

/* A descriptor set for every draw, in the order of recording. */
static lao_result lao__vk_describe_all(const lao__vk *vk, lao__vk_build *build,
                                       const lao__vk_frame *frame, const lao_execution *execution) {
    VkDescriptorSet *set = build->sets;
    uint32_t i, k;
    LAO__VK_STRUCT(VkDescriptorSetAllocateInfo, info, DESCRIPTOR_SET_ALLOCATE_INFO);
    info.descriptorPool = frame->pool;
    info.descriptorSetCount = 1;
    for (i = 0; i < execution->plan->step_count; i++) {
        const lao_plan_step *step = &execution->plan->steps[i];
        const lao_chunk *chunks;
        const uint32_t count = lao_step_draws(execution, step, &chunks);
        for (k = 0; k < count; k++, set++) {
            lao_result result;
            info.pSetLayouts = &vk->programs[step->shader].set_layout;
            result = LAO__VK_TRY(vk, AllocateDescriptorSets, (vk->device, &info, set));
            if (result)
                return result;
            lao__vk_describe(vk, build, frame, execution, step, &chunks[k], *set);
        }
    }
    return LAO_OK;
}

/* Pipelines that hang on the formats of the host's images, and the clock. */
static lao_result lao__vk_execution_fit(lao__vk *vk, lao__vk_build *build,
                                        const lao_execution *execution) {
    const lao_plan *plan = execution->plan;
    lao__vk_key key;
    uint32_t i;
    lao_result result = LAO_OK;
    for (i = 0; i < plan->step_count && !result; i++) {
        if (lao__vk_key_make(plan, &plan->steps[i], NULL, &key))
            continue; /* made in view_prepare */
        lao__vk_key_make(plan, &plan->steps[i], execution, &key);
        result = lao__vk_pipeline_use(vk, &key, plan->steps[i].row->name, &build->pipelines[i]);
    }
    if (!result && (execution->flags & LAO_FRAME_TIMINGS) && vk->timestamp_mask &&
        !build->queries) {
        LAO__VK_STRUCT(VkQueryPoolCreateInfo, info, QUERY_POOL_CREATE_INFO);
        info.queryType = VK_QUERY_TYPE_TIMESTAMP;
        info.queryCount = build->step_count + 1;
        result = LAO__VK_CREATE(vk, QueryPool, &info, &build->queries);
    }
    return result;
}

/* --------------------------------------------------------------------------- a frame, recording */

typedef struct lao__vk_state {
    VkPipelineStageFlags2 stage;
    VkAccessFlags2 access;
    VkImageLayout layout;
} lao__vk_state;

static lao__vk_state lao__vk_state_of(lao_access access) {
    lao__vk_state state = {0, 0, VK_IMAGE_LAYOUT_UNDEFINED}; /* never used: nothing to wait for */
    if (access == LAO_ACCESS_SAMPLE) {
        state.stage =
            VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
        state.access = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
        state.layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    } else if (access == LAO_ACCESS_COLOR) {
        state.stage = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
        state.access =
            VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
        state.layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    } else if (access == LAO_ACCESS_DEPTH) {
        state.stage = VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT |
                      VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
        state.access = VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                       VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
        state.layout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    }
    return state;
}

static VkImageMemoryBarrier2 lao__vk_barrier(VkImage image, VkFormat format, lao__vk_state before,
                                             lao__vk_state after) {
    LAO__VK_STRUCT(VkImageMemoryBarrier2, barrier, IMAGE_MEMORY_BARRIER_2);
    barrier.srcStageMask = before.stage;
    barrier.srcAccessMask = before.access;
    barrier.oldLayout = before.layout;
    barrier.dstStageMask = after.stage;
    barrier.dstAccessMask = after.access;
    barrier.newLayout = after.layout;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange.aspectMask = lao__vk_aspects(format);
    barrier.subresourceRange.levelCount = VK_REMAINING_MIP_LEVELS;
    barrier.subresourceRange.layerCount = VK_REMAINING_ARRAY_LAYERS;
    return barrier;
}

/* The host's image: it comes and goes in the states that its lao_image names. */
static VkImageMemoryBarrier2 lao__vk_barrier_lent(const lao_image *image,
                                                  const lao_plan_barrier *row) {
    lao__vk_state before = lao__vk_state_of(row->before), after = lao__vk_state_of(row->after);
    VkImage handle;
    if (row->before == LAO_ACCESS_NONE) {
        before.stage =
            image->stage_before ? image->stage_before : VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        before.access = image->access_before
                            ? image->access_before
                            : VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
        before.layout = (VkImageLayout)image->layout_before;
    }
    if (row->after == LAO_ACCESS_NONE) {
        const uint32_t layout = image->layout_after ? image->layout_after : image->layout_before;
        after.stage =
            image->stage_after ? image->stage_after : VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        after.access = image->access_after
                           ? image->access_after
                           : VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
        /* "As before" of an image that came without a layout: it keeps ours. */
        after.layout = layout ? (VkImageLayout)layout : before.layout;
    }
    if (row->discard)
        before.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    memcpy(&handle, &image->native, sizeof(VkImage));
    return lao__vk_barrier(handle, (VkFormat)image->native_format, before, after);
}

static void lao__vk_barriers_flush(const lao__vk *vk, VkCommandBuffer commands,
                                   const VkImageMemoryBarrier2 *barriers, uint32_t count) {
    LAO__VK_STRUCT(VkDependencyInfo, info, DEPENDENCY_INFO);
    info.imageMemoryBarrierCount = count;
    info.pImageMemoryBarriers = barriers;
    if (count)
        vk->call.CmdPipelineBarrier2(commands, &info);
}

/* Rows [first, end) of the plan's barriers. Our own images come from the access that was recorded
   last, be it of this frame, the one before, or another image in the same slot. */
static void lao__vk_barriers(const lao__vk *vk, lao__vk_build *build,
                             const lao_execution *execution, VkCommandBuffer commands,
                             uint32_t first, uint32_t end) {
    VkImageMemoryBarrier2 barriers[LAO__VK_BARRIERS];
    uint32_t count = 0;
    for (; first < end; first++) {
        const lao_plan_barrier *row = &execution->plan->barriers[first];
        const lao_plan_instance *instance = &execution->plan->instances[row->instance];
        const lao_image *lent = lao__vk_lent(execution, instance);
        if (count == LAO__VK_BARRIERS) {
            lao__vk_barriers_flush(vk, commands, barriers, count);
            count = 0;
        }
        if (lent) {
            barriers[count++] = lao__vk_barrier_lent(lent, row);
        } else if (row->after != LAO_ACCESS_NONE) {
            lao__vk_image *slot = &build->slots[instance->slot[execution->parity & 1]];
            lao__vk_state before = lao__vk_state_of(slot->access);
            if (row->discard)
                before.layout = VK_IMAGE_LAYOUT_UNDEFINED;
            barriers[count++] =
                lao__vk_barrier(slot->image, slot->format, before, lao__vk_state_of(row->after));
            slot->access = row->after;
        }
    }
    lao__vk_barriers_flush(vk, commands, barriers, count);
}

static VkRenderingAttachmentInfo lao__vk_attachment(const lao__vk_build *build,
                                                    const lao_execution *execution,
                                                    const lao_plan_write *write, int depth) {
    LAO__VK_STRUCT(VkRenderingAttachmentInfo, info, RENDERING_ATTACHMENT_INFO);
    if (write->instance == LAO_NO_INDEX)
        return info; /* no view: writes to this location are dropped */
    info.imageView = lao__vk_attachment_view(build, execution, write->instance);
    info.imageLayout = lao__vk_state_of(depth ? LAO_ACCESS_DEPTH : LAO_ACCESS_COLOR).layout;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    info.loadOp = write->clear == 1   ? VK_ATTACHMENT_LOAD_OP_CLEAR
                  : write->clear == 0 ? VK_ATTACHMENT_LOAD_OP_LOAD
                                      : VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    if (depth) {
        info.clearValue.depthStencil.depth = write->value[0];
    } else {
        /* words are cleared to 0 alone, which has no bits either way */
        memcpy(info.clearValue.color.float32, write->value, sizeof write->value);
    }
    return info;
}

/* again: to go on with what the step has drawn so far */
static void lao__vk_begin(const lao__vk *vk, const lao__vk_build *build,
                          const lao_execution *execution, const lao_plan_step *step, int again,
                          VkCommandBuffer commands) {
    VkRenderingAttachmentInfo colors[LAO_MAX_WRITES], depth;
    VkViewport viewport;
    uint32_t i;
    LAO__VK_STRUCT(VkRenderingInfo, info, RENDERING_INFO);
    info.colorAttachmentCount = lao__vk_color_count(step);
    for (i = 0; i < info.colorAttachmentCount; i++)
        colors[i] = lao__vk_attachment(build, execution, &step->colors[i], 0);
    depth = lao__vk_attachment(build, execution, &step->depth, 1);
    for (i = 0; i < info.colorAttachmentCount && again; i++)
        colors[i].loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
    if (again)
        depth.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
    info.renderArea.extent.width = step->width;
    info.renderArea.extent.height = step->height;
    info.layerCount = 1;
    info.pColorAttachments = colors;
    info.pDepthAttachment = depth.imageView ? &depth : NULL;
    viewport.x = viewport.y = viewport.minDepth = 0;
    viewport.width = (float)step->width;
    viewport.height = (float)step->height;
    viewport.maxDepth = 1;
    vk->call.CmdBeginRendering(commands, &info);
    vk->call.CmdSetViewport(commands, 0, 1, &viewport);
    vk->call.CmdSetScissor(commands, 0, 1, &info.renderArea);
}

/* A processor that draws keeps every triangle it has not come to yet, about 500 bytes each, and may
   be millions behind: it catches up before more are recorded. */
static void lao__vk_catch_up(const lao__vk *vk, const lao__vk_build *build,
                             const lao_execution *execution, const lao_plan_step *step,
                             VkCommandBuffer commands) {
    LAO__VK_STRUCT(VkMemoryBarrier2, barrier, MEMORY_BARRIER_2);
    LAO__VK_STRUCT(VkDependencyInfo, info, DEPENDENCY_INFO);
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT |
                                                  VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT |
                                                  VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
    barrier.srcAccessMask =
        VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
    barrier.dstAccessMask = barrier.srcAccessMask | VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT |
                            VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT;
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &barrier;
    vk->call.CmdEndRendering(commands);
    vk->call.CmdPipelineBarrier2(commands, &info);
    lao__vk_begin(vk, build, execution, step, 1, commands);
}

/* Segments in pieces that 16-bit indices reach. */
static void lao__vk_draw_segments(const lao__vk *vk, const lao__vk_build *build,
                                  const lao_execution *execution, const lao_plan_step *step,
                                  const lao_range *range, VkCommandBuffer commands) {
    uint32_t first, left;
    for (first = 0; first < range->count; first += LAO__VK_QUADS) {
        left = lao__vk_least(range->count - first, LAO__VK_QUADS);
        if (vk->software && first % (LAO__VK_QUADS * LAO__VK_PIECES) == 0 && first > 0)
            lao__vk_catch_up(vk, build, execution, step, commands);
        vk->call.CmdDrawIndexed(commands, 6 * left, 1, 0, (int32_t)(4 * (range->first + first)), 0);
    }
}

static void lao__vk_draw(const lao__vk *vk, const lao__vk_build *build,
                         const lao_execution *execution, const lao_plan_step *step,
                         const lao_chunk *chunk, VkCommandBuffer commands) {
    lao_range range = {0, 0, 0};
    uint32_t i;
    for (i = 0; i < LAO_MAX_BUFFERS; i++) {
        if (chunk->buffers[i])
            ((lao__vk_texels *)chunk->buffers[i])->object.last_use = vk->epoch;
    }
    if (LAO_PASS_DRAWS_LINES(step->row->kind)) {
        while (lao_step_range(execution, step, chunk, &range))
            lao__vk_draw_segments(vk, build, execution, step, &range, commands);
    } else if (step->row->kind == LAO_PASS_DRAW_MESH)
        vk->call.CmdDraw(commands, 3 * chunk->count, 1, 0, 0);
    else
        vk->call.CmdDraw(commands, 3, 1, 0, 0);
}

/* Records one step; `sets` are its descriptor sets, one a draw. */
static void lao__vk_step(const lao__vk *vk, const lao__vk_build *build,
                         const lao_execution *execution, const lao_plan_step *step,
                         const VkDescriptorSet *sets, VkCommandBuffer commands) {
    lao__vk_pipeline *pipeline = build->pipelines[step - execution->plan->steps];
    const VkPipelineLayout layout = vk->programs[step->shader].layout;
    const lao_chunk *chunks;
    const uint32_t count = lao_step_draws(execution, step, &chunks);
    uint32_t i;
    pipeline->object.last_use = vk->epoch;
    lao__vk_begin(vk, build, execution, step, 0, commands);
    vk->call.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline->pipeline);
    vk->call.CmdPushConstants(commands, layout, LAO__VK_STAGES, 0, sizeof step->uniforms,
                              step->uniforms);
    if (LAO_PASS_DRAWS_LINES(step->row->kind))
        vk->call.CmdBindIndexBuffer(commands, vk->quads.buffer, 0, VK_INDEX_TYPE_UINT16);
    for (i = 0; i < count; i++) {
        vk->call.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1,
                                       &sets[i], 0, NULL);
        lao__vk_draw(vk, build, execution, step, &chunks[i], commands);
    }
    vk->call.CmdEndRendering(commands);
}

static void lao__vk_label(const lao__vk *vk, VkCommandBuffer commands, const char *name) {
    LAO__VK_STRUCT(VkDebugUtilsLabelEXT, label, DEBUG_UTILS_LABEL_EXT);
    label.pLabelName = name;
    if (!vk->call.CmdBeginDebugUtilsLabelEXT || !vk->call.CmdEndDebugUtilsLabelEXT)
        return;
    if (name) {
        vk->call.CmdBeginDebugUtilsLabelEXT(commands, &label);
    } else {
        vk->call.CmdEndDebugUtilsLabelEXT(commands);
    }
}

/* The stand-in for absent images has no content, but must have a layout; a frame that is never
   submitted must not leave the next one without it. */
static void lao__vk_absent_ready(const lao__vk *vk, VkCommandBuffer commands) {
    const lao__vk_state read = lao__vk_state_of(LAO_ACCESS_SAMPLE);
    lao__vk_state before = read;
    VkImageMemoryBarrier2 barrier;
    before.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    barrier = lao__vk_barrier(vk->absent.image, vk->absent.format, before, read);
    lao__vk_barriers_flush(vk, commands, &barrier, 1);
}

static void lao__vk_record(const lao__vk *vk, lao__vk_build *build,
                           const lao_execution *execution) {
    const lao_plan *plan = execution->plan;
    const VkCommandBuffer commands = (VkCommandBuffer)execution->commands;
    const VkPipelineStageFlagBits done = VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT;
    const int timed = (execution->flags & LAO_FRAME_TIMINGS) && build->queries;
    const VkDescriptorSet *sets = build->sets;
    uint32_t i;
    if (build->padded)
        lao__vk_absent_ready(vk, commands);
    if (timed) {
        vk->call.CmdResetQueryPool(commands, build->queries, 0, build->step_count + 1);
        vk->call.CmdWriteTimestamp(commands, done, build->queries, 0);
        build->timed = 1;
    }
    for (i = 0; i < plan->step_count; i++) {
        const lao_plan_step *step = &plan->steps[i];
        const lao_chunk *chunks;
        lao__vk_label(vk, commands, step->row->name);
        lao__vk_barriers(vk, build, execution, commands, step->barrier_first,
                         step->barrier_first + step->barrier_count);
        lao__vk_step(vk, build, execution, step, sets, commands);
        sets += lao_step_draws(execution, step, &chunks);
        if (timed)
            vk->call.CmdWriteTimestamp(commands, done, build->queries, i + 1);
        lao__vk_label(vk, commands, NULL);
    }
    lao__vk_barriers(vk, build, execution, commands, plan->end_barrier_first, plan->barrier_count);
}

static lao_result lao__vk_execute(void *self, void *view, const lao_execution *execution) {
    lao__vk *vk = (lao__vk *)self;
    lao__vk_view *target = (lao__vk_view *)view;
    lao__vk_build *build = target->build;
    lao__vk_frame *frame;
    lao_result result;
    if (!execution->commands)
        return lao__vk_fail(vk, LAO_LOG_BACKEND_STATE, "lao_frame.commands is NULL");
    if (!build || build->serial != execution->plan->serial)
        return lao__vk_fail(vk, LAO_LOG_BACKEND_STATE, "the view was not prepared for this plan");
    frame = &build->frames[build->executions % vk->desc.frames_in_flight];
    result = lao__vk_check_lent(vk, execution);
    if (!result)
        result = lao__vk_execution_fit(vk, build, execution);
    if (!result)
        result = lao__vk_frame_begin(vk, build, execution, frame);
    if (!result)
        result = lao__vk_describe_all(vk, build, frame, execution);
    if (result)
        return result;
    if (target->epoch == vk->epoch)
        vk->epoch++;
    target->epoch = build->object.last_use = vk->epoch;
    lao__vk_record(vk, build, execution);
    build->executions++;
    lao__vk_collect(vk, 0);
    return LAO_OK;
}

/* -------------------------------------------------------------------------- timings and reading */

static lao_result lao__vk_timings(void *self, void *view, double *milliseconds,
                                  uint32_t step_count) {
    lao__vk *vk = (lao__vk *)self;
    const lao__vk_build *build = ((lao__vk_view *)view)->build;
    uint64_t ticks[2] = {0, 0};
    uint32_t i;
    if (!vk->timestamp_mask)
        return lao__vk_fail(vk, LAO_LOG_BACKEND_FEATURE, "timestamps on this queue family");
    if (!build || !build->timed || step_count > build->step_count)
        return lao__vk_fail(vk, LAO_LOG_TIMINGS_OFF, "Vulkan");
    for (i = 0; i <= step_count; i++) {
        uint64_t *tick = &ticks[i & 1];
        const VkResult got =
            vk->call.GetQueryPoolResults(vk->device, build->queries, i, 1, sizeof *tick, tick,
                                         sizeof *tick, VK_QUERY_RESULT_64_BIT);
        if (got == VK_NOT_READY)
            return lao__vk_fail(vk, LAO_LOG_TIMINGS_OFF, "or its commands have not finished");
        if (got)
            return lao__vk_check(vk, got, "vkGetQueryPoolResults");
        if (i)
            milliseconds[i - 1] = (double)((*tick - ticks[~i & 1]) & vk->timestamp_mask) *
                                  vk->timestamp_period * 1e-6;
    }
    return LAO_OK;
}

/* Records the copy of an image, which is left as it was. */
static void lao__vk_copy(const lao__vk *vk, const lao__vk_image *image, VkBuffer buffer,
                         VkCommandBuffer commands) {
    const lao__vk_state owner = lao__vk_state_of(image->access);
    lao__vk_state copy;
    VkImageMemoryBarrier2 barrier;
    VkBufferImageCopy region;
    LAO__VK_STRUCT(VkMemoryBarrier2, host, MEMORY_BARRIER_2);
    LAO__VK_STRUCT(VkDependencyInfo, info, DEPENDENCY_INFO);
    copy.stage = VK_PIPELINE_STAGE_2_COPY_BIT;
    copy.access = VK_ACCESS_2_TRANSFER_READ_BIT;
    copy.layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    barrier = lao__vk_barrier(image->image, image->format, owner, copy);
    lao__vk_barriers_flush(vk, commands, &barrier, 1);
    memset(&region, 0, sizeof region);
    region.imageSubresource.aspectMask = lao__vk_aspects(image->format);
    region.imageSubresource.layerCount = 1;
    region.imageExtent.width = image->width;
    region.imageExtent.height = image->height;
    region.imageExtent.depth = 1;
    vk->call.CmdCopyImageToBuffer(commands, image->image, copy.layout, buffer, 1, &region);
    barrier = lao__vk_barrier(image->image, image->format, copy, owner);
    host.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
    host.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    host.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
    host.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
    info.memoryBarrierCount = info.imageMemoryBarrierCount = 1;
    info.pMemoryBarriers = &host;
    info.pImageMemoryBarriers = &barrier;
    vk->call.CmdPipelineBarrier2(commands, &info);
}

/* Records the copy into a command buffer of its own, and runs it. */
static lao_result lao__vk_copy_run(const lao__vk *vk, const lao__vk_image *image, VkBuffer buffer,
                                   VkCommandPool pool) {
    const VkQueue queue = (VkQueue)vk->desc.queue;
    VkCommandBuffer commands;
    lao_result result;
    LAO__VK_STRUCT(VkCommandBufferAllocateInfo, allocate, COMMAND_BUFFER_ALLOCATE_INFO);
    LAO__VK_STRUCT(VkCommandBufferBeginInfo, begin, COMMAND_BUFFER_BEGIN_INFO);
    LAO__VK_STRUCT(VkSubmitInfo, submit, SUBMIT_INFO);
    allocate.commandPool = pool;
    allocate.commandBufferCount = submit.commandBufferCount = 1;
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    submit.pCommandBuffers = &commands;
    result = LAO__VK_TRY(vk, AllocateCommandBuffers, (vk->device, &allocate, &commands));
    if (!result)
        result = LAO__VK_TRY(vk, BeginCommandBuffer, (commands, &begin));
    if (result)
        return result;
    lao__vk_copy(vk, image, buffer, commands);
    result = LAO__VK_TRY(vk, EndCommandBuffer, (commands));
    if (!result)
        result = LAO__VK_TRY(vk, QueueSubmit, (queue, 1, &submit, VK_NULL_HANDLE));
    if (result)
        return result;
    result = LAO__VK_TRY(vk, QueueWaitIdle, (queue));
    if (result)
        vk->call.QueueWaitIdle(
            queue); /* what the copy uses is about to go; a lost device returns at once */
    return result;
}

static lao_result lao__vk_read(void *self, void *view, const lao_plan *plan, uint32_t slot,
                               void *data, size_t size) {
    lao__vk *vk = (lao__vk *)self;
    const lao__vk_build *build = ((lao__vk_view *)view)->build;
    lao__vk_buffer buffer;
    VkCommandPool pool;
    lao_result result;
    LAO__VK_STRUCT(VkCommandPoolCreateInfo, info, COMMAND_POOL_CREATE_INFO);
    if (!vk->desc.queue)
        return lao__vk_fail(vk, LAO_LOG_BACKEND_STATE,
                            "lao_vk_desc.queue is needed to read images");
    if (!build || build->serial != plan->serial || slot >= build->slot_count ||
        build->slots[slot].access == LAO_ACCESS_NONE)
        return lao__vk_fail(vk, LAO_LOG_NOTHING_RENDERED, "Vulkan");
    if (size < (size_t)plan->slots[slot].width * plan->slots[slot].height *
                   lao_format_bytes(plan->slots[slot].format))
        return lao__vk_fail(vk, LAO_LOG_READ_SIZE, "Vulkan");
    size = (size_t)plan->slots[slot].width * plan->slots[slot].height *
           lao_format_bytes(plan->slots[slot].format);
    result = lao__vk_buffer_make(vk, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, VK_FORMAT_UNDEFINED,
                                 "lineao read", &buffer);
    if (result)
        return result;
    info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    info.queueFamilyIndex = vk->desc.queue_family;
    result = LAO__VK_CREATE(vk, CommandPool, &info, &pool);
    if (!result) {
        result = lao__vk_copy_run(vk, &build->slots[slot], buffer.buffer, pool);
        vk->call.DestroyCommandPool(vk->device, pool, NULL);
    }
    if (!result)
        memcpy(data, buffer.data, size);
    lao__vk_buffer_free(vk, &buffer);
    return result;
}

/* --------------------------------------------------------------------------------------- public */

lao_result lao_vk_backend(const lao_vk_desc *desc, lao_backend *backend) {
    lao_vk_desc filled;
    if (!desc || !backend || !desc->instance || !desc->physical_device || !desc->device ||
        !desc->get_instance_proc)
        return LAO_ERROR_INVALID_ARGUMENT;
    filled = *desc;
    if (!filled.api_version)
        filled.api_version = VK_API_VERSION_1_3;
    if (!filled.frames_in_flight)
        filled.frames_in_flight = 2;
    memset(backend, 0, sizeof *backend);
    backend->abi = LAO_BACKEND_ABI;
    backend->name = "vulkan";
    memcpy(backend->storage, &filled, sizeof filled);
    backend->attach = lao__vk_attach;
    backend->detach = lao__vk_detach;
    backend->buffer_create = lao__vk_buffer_create;
    backend->buffer_destroy = lao__vk_buffer_destroy;
    backend->view_create = lao__vk_view_create;
    backend->view_destroy = lao__vk_view_destroy;
    backend->view_prepare = lao__vk_view_prepare;
    backend->execute = lao__vk_execute;
    backend->read = lao__vk_read;
    backend->timings = lao__vk_timings;
    return LAO_OK;
}
