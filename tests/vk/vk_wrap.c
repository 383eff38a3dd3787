#include "vk_wrap.h"

#include <stdio.h>
#include <string.h>

struct vk_wrap vk_wrap;

void vk_wrap_reset(void) {
    memset(&vk_wrap, 0, sizeof vk_wrap);
}

/* Whether this call fails. Vulkan leaves a failed call's results undefined, so they are spoilt. */
static int fails(const char *name, void *output, size_t size) {
    vk_wrap.pipelines += strcmp(name, "vkCreateGraphicsPipelines") == 0;
    if (++vk_wrap.calls != vk_wrap.fail_call)
        return 0;
    vk_wrap.failed = name;
    if (output)
        memset(output, 0xcd, size);
    return 1;
}

/* W(name, parameters, arguments, where its result goes) */
/* clang-format off */
#define MAKER(W, name, object) \
    W(name, (VkDevice d, const Vk##object##CreateInfo *i, const VkAllocationCallbacks *a, Vk##object *o), (d, i, a, o), o)
#define WRAPPED(W) \
    MAKER(W, CreateBuffer, Buffer) MAKER(W, CreateBufferView, BufferView) MAKER(W, CreateImage, Image) \
    MAKER(W, CreateImageView, ImageView) MAKER(W, CreateSampler, Sampler) MAKER(W, CreatePipelineCache, PipelineCache) \
    MAKER(W, CreateDescriptorSetLayout, DescriptorSetLayout) MAKER(W, CreatePipelineLayout, PipelineLayout) \
    MAKER(W, CreateDescriptorPool, DescriptorPool) MAKER(W, CreateShaderModule, ShaderModule) \
    MAKER(W, CreateQueryPool, QueryPool) MAKER(W, CreateCommandPool, CommandPool) \
    W(AllocateMemory, (VkDevice d, const VkMemoryAllocateInfo *i, const VkAllocationCallbacks *a, VkDeviceMemory *o), (d, i, a, o), o) \
    W(MapMemory, (VkDevice d, VkDeviceMemory m, VkDeviceSize b, VkDeviceSize n, VkMemoryMapFlags f, void **o), (d, m, b, n, f, o), o) \
    W(BindBufferMemory, (VkDevice d, VkBuffer b, VkDeviceMemory m, VkDeviceSize n), (d, b, m, n), (char *)NULL) \
    W(BindImageMemory, (VkDevice d, VkImage b, VkDeviceMemory m, VkDeviceSize n), (d, b, m, n), (char *)NULL) \
    W(ResetDescriptorPool, (VkDevice d, VkDescriptorPool p, VkDescriptorPoolResetFlags f), (d, p, f), (char *)NULL) \
    W(AllocateDescriptorSets, (VkDevice d, const VkDescriptorSetAllocateInfo *i, VkDescriptorSet *o), (d, i, o), o) \
    W(CreateGraphicsPipelines, (VkDevice d, VkPipelineCache c, uint32_t n, const VkGraphicsPipelineCreateInfo *i, \
                                const VkAllocationCallbacks *a, VkPipeline *o), (d, c, n, i, a, o), o) \
    W(GetQueryPoolResults, (VkDevice d, VkQueryPool p, uint32_t q, uint32_t n, size_t s, void *o, VkDeviceSize t, \
                            VkQueryResultFlags f), (d, p, q, n, s, o, t, f), (char *)NULL) \
    W(AllocateCommandBuffers, (VkDevice d, const VkCommandBufferAllocateInfo *i, VkCommandBuffer *o), (d, i, o), o) \
    W(BeginCommandBuffer, (VkCommandBuffer c, const VkCommandBufferBeginInfo *i), (c, i), (char *)NULL) \
    W(EndCommandBuffer, (VkCommandBuffer c), (c), (char *)NULL) \
    W(QueueSubmit, (VkQueue q, uint32_t n, const VkSubmitInfo *i, VkFence f), (q, n, i, f), (char *)NULL) \
    W(QueueWaitIdle, (VkQueue q), (q), (char *)NULL)
/* clang-format on */

#define FUNCTION(name, parameters, arguments, output)                                              \
    static VKAPI_ATTR VkResult VKAPI_CALL wrapped_##name parameters {                              \
        return fails("vk" #name, output, sizeof *(output)) ? vk_wrap.result : vk##name arguments;  \
    }
WRAPPED(FUNCTION)

static int hides(const char *name) {
    if (++vk_wrap.procs != vk_wrap.fail_proc)
        return 0;
    snprintf(vk_wrap.hidden, sizeof vk_wrap.hidden, "%s", name);
    return 1;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_proc(VkDevice device, const char *name) {
    static const struct {
        const char *name;
        PFN_vkVoidFunction function;
    } rows[] = {
#define ROW(name, parameters, arguments, output) {"vk" #name, (PFN_vkVoidFunction)wrapped_##name},
        WRAPPED(ROW)
#undef ROW
    };
    if (hides(name))
        return NULL;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if (strcmp(rows[i].name, name) == 0)
            return rows[i].function;
    }
    return vkGetDeviceProcAddr(device, name);
}

void *vk_wrap_proc(void *instance, const char *name) {
    PFN_vkVoidFunction function = NULL;
    void *address;
    if (!hides(name)) {
        function = strcmp(name, "vkGetDeviceProcAddr") == 0
                       ? (PFN_vkVoidFunction)device_proc
                       : vkGetInstanceProcAddr((VkInstance)instance, name);
    }
    memcpy(&address, &function, sizeof address);
    return address;
}
