/* A layer between the executor and the driver that injects faults and hides functions. Vulkan's
 * lookup carries no user pointer, so the layer is one global, for tests alone. */
#ifndef VK_WRAP_H
#define VK_WRAP_H

#include <vulkan/vulkan_core.h>

struct vk_wrap {
    int fail_call;      /* the n-th call that can fail does; 0: none */
    VkResult result;    /* what it returns */
    int fail_proc;      /* the n-th name asked for is not found; 0: none */
    int calls, procs;   /* counted since vk_wrap_reset */
    int pipelines;      /* made since then */
    const char *failed; /* the function that failed; NULL: none yet */
    char hidden[64];    /* the name that was not found */
};
extern struct vk_wrap vk_wrap;

void vk_wrap_reset(void);

/* lao_vk_desc.get_instance_proc. */
void *vk_wrap_proc(void *instance, const char *name);

#endif
