/* The Vulkan host. lineao gets the device and, in each frame, a command buffer and two images of
 * ours, each with the state in which it comes and shall be left. Instance, device and images come
 * from host_vk.h; swapchain and frames are here. */
#define GLFW_INCLUDE_VULKAN
#include "window.h"

#include "../host_depth_shaders.h"
#include "ground_shaders.h"
#include "host_vk.h"
#include "report.h"
#include "ui.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 2, MOST_IMAGES = 8, PUSH = 128 };

typedef struct vk_frame {
    VkCommandBuffer commands;
    VkFence done;
    VkSemaphore acquired;
} vk_frame;

/* An image of a swapchain, and the semaphore that says when it may be shown. */
typedef struct vk_shown {
    VkImage image;
    VkImageView view;
    VkFramebuffer framebuffer;
    VkSemaphore drawn;
} vk_shown;

typedef struct vk_slot {
    host_vk_image color, depth; /* color rests in TRANSFER_SRC, depth in DEPTH_ATTACHMENT */
    bool used;
} vk_slot;

typedef struct window_vk {
    host_vk *host;
    VkDevice device;
    VkSurfaceKHR surface;
    VkSurfaceFormatKHR format;
    VkSwapchainKHR swapchain;
    VkExtent2D extent;
    bool stale; /* the swapchain does not fit the window any more */
    vk_shown shown[MOST_IMAGES];
    uint32_t shown_count, image; /* image: of this frame */
    VkRenderPass interface;      /* the user interface, over what a frame shows */
    VkCommandPool pool;
    vk_frame frames[FRAMES];
    uint32_t frame;
    VkPipelineLayout layout;
    VkShaderModule shaders[4];
    VkPipeline box, ground;
    vk_slot slots[SLOT_COUNT];
} window_vk;

static bool check(VkResult code, const char *what) {
    return code == VK_SUCCESS || cli_fail("vk: %s (VkResult %d)", what, (int)code);
}

/* ---- barriers ----------------------------------------------------------------------------- */

/* A use of an image: its layout, and who touches it. */
typedef struct vk_use {
    VkImageLayout layout;
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
} vk_use;

static const vk_use use_nothing = {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                   0};
static const vk_use use_color = {
    VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
    VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
static const vk_use use_depth = {
    VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
static const vk_use use_source = {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                  VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                  VK_ACCESS_2_TRANSFER_READ_BIT};
static const vk_use use_target = {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                  VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                  VK_ACCESS_2_TRANSFER_WRITE_BIT};

static void barrier(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, vk_use from,
                    vk_use to) {
    const VkImageMemoryBarrier2 one = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                       .srcStageMask = from.stages,
                                       .srcAccessMask = from.access,
                                       .dstStageMask = to.stages,
                                       .dstAccessMask = to.access,
                                       .oldLayout = from.layout,
                                       .newLayout = to.layout,
                                       .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .image = image,
                                       .subresourceRange = {aspect, 0, 1, 0, 1}};
    const VkDependencyInfo info = {.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                   .imageMemoryBarrierCount = 1,
                                   .pImageMemoryBarriers = &one};
    vkCmdPipelineBarrier2(commands, &info);
}

static VkCommandBuffer commands_of(const window_vk *vk) {
    return vk->frames[vk->frame].commands;
}

/* ---- pipelines of the host's own things ---------------------------------------------------- */

static bool make_shaders(window_vk *vk) {
    const VkPushConstantRange range = {VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                       PUSH};
    const VkPipelineLayoutCreateInfo layout = {.sType =
                                                   VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .pushConstantRangeCount = 1,
                                               .pPushConstantRanges = &range};
    const struct {
        const uint32_t *words;
        size_t size;
    } texts[4] = {{host_depth_vert, sizeof host_depth_vert},
                  {host_depth_frag, sizeof host_depth_frag},
                  {ground_vert, sizeof ground_vert},
                  {ground_frag, sizeof ground_frag}};
    bool ok = check(vkCreatePipelineLayout(vk->device, &layout, NULL, &vk->layout), "no layout");
    for (int i = 0; i < 4 && ok; i++) {
        const VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                               .codeSize = texts[i].size,
                                               .pCode = texts[i].words};
        ok = check(vkCreateShaderModule(vk->device, &info, NULL, &vk->shaders[i]), "no shader");
    }
    return ok;
}

/* over: blends, and leaves the depth as it is. */
static bool make_pipeline(window_vk *vk, const VkShaderModule shaders[2],
                          VkPrimitiveTopology topology, bool over, VkPipeline *out) {
    const VkPipelineShaderStageCreateInfo stages[2] = {
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_VERTEX_BIT,
         .module = shaders[0],
         .pName = "main"},
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
         .module = shaders[1],
         .pName = "main"}};
    const VkPipelineVertexInputStateCreateInfo vertices = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO, .topology = topology};
    const VkPipelineViewportStateCreateInfo viewports = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    /* The camera's depth range is the scene's, not the ground's. */
    const VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .depthClampEnable = host_vk_features(vk->host)->depthClamp,
        .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = !over,
        .depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL};
    const VkPipelineColorBlendAttachmentState all = {
        .blendEnable = over,
        .srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
        .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
        .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
        .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
        .colorWriteMask = 15};
    const VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 1,
        .pAttachments = &all};
    const VkDynamicState changing[2] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineDynamicStateCreateInfo dynamic = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2,
        .pDynamicStates = changing};
    const VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
    const VkPipelineRenderingCreateInfo rendering = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = 1,
        .pColorAttachmentFormats = &format,
        .depthAttachmentFormat = VK_FORMAT_D32_SFLOAT};
    const VkGraphicsPipelineCreateInfo info = {.sType =
                                                   VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                               .pNext = &rendering,
                                               .stageCount = 2,
                                               .pStages = stages,
                                               .pVertexInputState = &vertices,
                                               .pInputAssemblyState = &assembly,
                                               .pViewportState = &viewports,
                                               .pRasterizationState = &raster,
                                               .pMultisampleState = &samples,
                                               .pDepthStencilState = &depth,
                                               .pColorBlendState = &blend,
                                               .pDynamicState = &dynamic,
                                               .layout = vk->layout};
    return check(vkCreateGraphicsPipelines(vk->device, VK_NULL_HANDLE, 1, &info, NULL, out),
                 "no pipeline");
}

/* ---- swapchain ----------------------------------------------------------------------------- */

/* Values of a picture are display values, so that the format must not encode them once more. */
static bool choose_format(window_vk *vk) {
    VkSurfaceFormatKHR formats[64];
    uint32_t count = 64;
    VkResult code = vkGetPhysicalDeviceSurfaceFormatsKHR(host_vk_physical(vk->host), vk->surface,
                                                         &count, formats);
    for (uint32_t i = 0; (code == VK_SUCCESS || code == VK_INCOMPLETE) && i < count; i++) {
        vk->format = formats[i];
        if ((formats[i].format == VK_FORMAT_B8G8R8A8_UNORM ||
             formats[i].format == VK_FORMAT_R8G8B8A8_UNORM) &&
            formats[i].colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)
            return true;
    }
    return cli_fail("vk: the window takes no 8-bit sRGB pictures");
}

static bool make_interface_pass(window_vk *vk) {
    const VkAttachmentDescription attachment = {.format = vk->format.format,
                                                .samples = VK_SAMPLE_COUNT_1_BIT,
                                                .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                                .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                                .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                                .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                                .initialLayout =
                                                    VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                                .finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR};
    const VkAttachmentReference color = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                          .colorAttachmentCount = 1,
                                          .pColorAttachments = &color};
    const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                         .attachmentCount = 1,
                                         .pAttachments = &attachment,
                                         .subpassCount = 1,
                                         .pSubpasses = &subpass};
    return check(vkCreateRenderPass(vk->device, &info, NULL, &vk->interface), "no render pass");
}

static void free_shown(window_vk *vk) {
    for (uint32_t i = 0; i < vk->shown_count; i++) {
        vkDestroyFramebuffer(vk->device, vk->shown[i].framebuffer, NULL);
        vkDestroyImageView(vk->device, vk->shown[i].view, NULL);
        vkDestroySemaphore(vk->device, vk->shown[i].drawn, NULL);
    }
    memset(vk->shown, 0, sizeof vk->shown);
    vk->shown_count = 0;
}

static bool make_shown(window_vk *vk, VkImage image, vk_shown *out) {
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = vk->format.format,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    const VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    out->image = image;
    if (!check(vkCreateImageView(vk->device, &view, NULL, &out->view), "no view") ||
        !check(vkCreateSemaphore(vk->device, &semaphore, NULL, &out->drawn), "no semaphore"))
        return false;
    const VkFramebufferCreateInfo framebuffer = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                 .renderPass = vk->interface,
                                                 .attachmentCount = 1,
                                                 .pAttachments = &out->view,
                                                 .width = vk->extent.width,
                                                 .height = vk->extent.height,
                                                 .layers = 1};
    return check(vkCreateFramebuffer(vk->device, &framebuffer, NULL, &out->framebuffer),
                 "no framebuffer");
}

/* MAILBOX or IMMEDIATE without vsync, where there are such. */
static VkPresentModeKHR choose_mode(const window_vk *vk, bool vsync) {
    VkPresentModeKHR modes[16], best = VK_PRESENT_MODE_FIFO_KHR;
    uint32_t count = 16;
    vkGetPhysicalDeviceSurfacePresentModesKHR(host_vk_physical(vk->host), vk->surface, &count,
                                              modes);
    for (uint32_t i = 0; i < count && !vsync; i++) {
        if (modes[i] == VK_PRESENT_MODE_MAILBOX_KHR ||
            (modes[i] == VK_PRESENT_MODE_IMMEDIATE_KHR && best == VK_PRESENT_MODE_FIFO_KHR))
            best = modes[i];
    }
    return best;
}

/* Where the surface leaves its size to the swapchain, that is the window's. */
static uint32_t clamped(uint32_t value, uint32_t low, uint32_t high) {
    return value < low ? low : value > high ? high : value;
}

/* False, without a report: the window has no size now. */
static bool make_swapchain(window *w) {
    window_vk *vk = w->vk;
    VkSurfaceCapabilitiesKHR can;
    int width, height;
    vkDeviceWaitIdle(vk->device);
    glfwGetFramebufferSize(w->glfw, &width, &height);
    if (vkGetPhysicalDeviceSurfaceCapabilitiesKHR(host_vk_physical(vk->host), vk->surface, &can) !=
            VK_SUCCESS ||
        width <= 0 || height <= 0)
        return false;
    vk->extent = can.currentExtent;
    if (vk->extent.width == UINT32_MAX) {
        vk->extent.width =
            clamped((uint32_t)width, can.minImageExtent.width, can.maxImageExtent.width);
        vk->extent.height =
            clamped((uint32_t)height, can.minImageExtent.height, can.maxImageExtent.height);
    }
    if (vk->extent.width == 0 || vk->extent.height == 0)
        return false;
    uint32_t wanted = can.minImageCount + 1;
    VkSwapchainKHR old = vk->swapchain;
    const VkSwapchainCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = vk->surface,
        .minImageCount =
            can.maxImageCount && wanted > can.maxImageCount ? can.maxImageCount : wanted,
        .imageFormat = vk->format.format,
        .imageColorSpace = vk->format.colorSpace,
        .imageExtent = vk->extent,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
        .preTransform = can.currentTransform,
        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        .presentMode = choose_mode(vk, w->vsync),
        .clipped = VK_TRUE,
        .oldSwapchain = old};
    free_shown(vk);
    vk->swapchain = VK_NULL_HANDLE;
    bool ok = check(vkCreateSwapchainKHR(vk->device, &info, NULL, &vk->swapchain), "no swapchain");
    vkDestroySwapchainKHR(vk->device, old, NULL);
    VkImage images[MOST_IMAGES];
    uint32_t count = MOST_IMAGES;
    ok = ok && check(vkGetSwapchainImagesKHR(vk->device, vk->swapchain, &count, images),
                     "too many images");
    for (uint32_t i = 0; ok && i < count; i++) {
        vk->shown_count = i + 1;
        ok = make_shown(vk, images[i], &vk->shown[i]);
    }
    vk->stale = !ok;
    return ok;
}

/* ---- life ---------------------------------------------------------------------------------- */

static void on_message(void *user, const char *text) {
    window *w = user;
    w->messages++;
    cli_warn("vk", text);
}

static bool open_device(window *w) {
    static const char *const swapchain[1] = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
    char error[HOST_VK_ERROR_SIZE];
    host_vk_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.synchronization_validation = w->debug;
    desc.message = on_message;
    desc.user = w;
    desc.features.depthClamp = VK_TRUE;
    desc.instance_extensions = glfwGetRequiredInstanceExtensions(&desc.instance_extension_count);
    desc.device_extensions = swapchain;
    desc.device_extension_count = 1;
    if (!desc.instance_extensions)
        return cli_fail("vk: the window system has no Vulkan");
    if (!host_vk_open(&desc, &w->vk->host, error))
        return cli_fail("vk: %s", error);
    w->vk->device = host_vk_device(w->vk->host);
    VkBool32 presents = VK_FALSE;
    return check(glfwCreateWindowSurface(host_vk_instance(w->vk->host), w->glfw, NULL,
                                         &w->vk->surface),
                 "no surface for the window") &&
           ((vkGetPhysicalDeviceSurfaceSupportKHR(host_vk_physical(w->vk->host),
                                                  host_vk_family(w->vk->host), w->vk->surface,
                                                  &presents) == VK_SUCCESS &&
             presents) ||
            cli_fail("vk: the device cannot show pictures in this window"));
}

static bool make_frames(window_vk *vk) {
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                          .queueFamilyIndex = host_vk_family(vk->host)};
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                     .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    const VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    bool ok = check(vkCreateCommandPool(vk->device, &pool, NULL, &vk->pool), "no pool");
    for (int i = 0; i < FRAMES && ok; i++) {
        const VkCommandBufferAllocateInfo buffer = {
            .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
            .commandPool = vk->pool,
            .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
            .commandBufferCount = 1};
        vk_frame *frame = &vk->frames[i];
        ok =
            check(vkAllocateCommandBuffers(vk->device, &buffer, &frame->commands), "no commands") &&
            check(vkCreateFence(vk->device, &fence, NULL, &frame->done), "no fence") &&
            check(vkCreateSemaphore(vk->device, &semaphore, NULL, &frame->acquired),
                  "no semaphore");
    }
    return ok;
}

static bool open(window *w, const char *title, int width, int height) {
    w->vk = cli_new(1, sizeof *w->vk);
    if (!w->vk)
        return false;
    memset(w->vk, 0, sizeof *w->vk);
    window_vk *vk = w->vk;
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    w->glfw = glfwCreateWindow(width, height, title, NULL, NULL);
    return (w->glfw || cli_fail("vk: no window; is there a display?")) && open_device(w) &&
           choose_format(vk) && make_interface_pass(vk) && make_frames(vk) && make_swapchain(w) &&
           make_shaders(vk) &&
           make_pipeline(vk, vk->shaders, VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST, false, &vk->box) &&
           make_pipeline(vk, vk->shaders + 2, VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP, true,
                         &vk->ground);
}

static void free_slot(window_vk *vk, vk_slot *slot) {
    host_vk_image_free(vk->host, &slot->color);
    host_vk_image_free(vk->host, &slot->depth);
    slot->used = false;
}

static void close_device(window_vk *vk) {
    vkDeviceWaitIdle(vk->device);
    for (int i = 0; i < SLOT_COUNT; i++)
        free_slot(vk, &vk->slots[i]);
    vkDestroyPipeline(vk->device, vk->box, NULL);
    vkDestroyPipeline(vk->device, vk->ground, NULL);
    for (int i = 0; i < 4; i++)
        vkDestroyShaderModule(vk->device, vk->shaders[i], NULL);
    vkDestroyPipelineLayout(vk->device, vk->layout, NULL);
    for (int i = 0; i < FRAMES; i++) {
        vkDestroyFence(vk->device, vk->frames[i].done, NULL);
        vkDestroySemaphore(vk->device, vk->frames[i].acquired, NULL);
    }
    vkDestroyCommandPool(vk->device, vk->pool, NULL);
    free_shown(vk);
    vkDestroySwapchainKHR(vk->device, vk->swapchain, NULL);
    vkDestroyRenderPass(vk->device, vk->interface, NULL);
    vkDestroySurfaceKHR(host_vk_instance(vk->host), vk->surface, NULL);
}

static void close(window *w) {
    if (w->vk && w->vk->host) {
        close_device(w->vk);
        host_vk_close(w->vk->host); /* its last messages are counted by on_message */
    }
    if (w->glfw)
        glfwDestroyWindow(w->glfw);
    free(w->vk);
    w->vk = NULL;
    w->glfw = NULL;
}

/* quote lend */
static bool lend(window *w, lao_backend *out) {
    const host_vk *host = w->vk->host;
    PFN_vkGetInstanceProcAddr get_proc = host_vk_get_instance_proc(host);
    lao_vk_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.instance = host_vk_instance(host);
    desc.physical_device = host_vk_physical(host);
    desc.device = host_vk_device(host);
    memcpy(&desc.get_instance_proc, &get_proc, sizeof get_proc);
    desc.api_version = host_vk_api_version(host);
    desc.queue_family = host_vk_family(host);
    desc.queue = host_vk_queue(host); /* for pictures that are read back; drawing submits nothing */
    desc.frames_in_flight = FRAMES;
    return lao_vk_backend(&desc, out) == LAO_OK || cli_fail("vk: the backend refused its device");
}
/* quote end */

void window_vk_interface(const window *w, ui_vulkan *out) {
    memset(out, 0, sizeof *out);
    out->host = w->vk->host;
    out->pass = w->vk->interface;
    out->images = w->vk->shown_count;
}

/* ---- frames -------------------------------------------------------------------------------- */

static void begin_commands(window_vk *vk) {
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                           .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    const float *gray = ui_background();
    const VkClearColorValue color = {{gray[0], gray[1], gray[2], 1}};
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkImage image = vk->shown[vk->image].image;
    vkBeginCommandBuffer(commands_of(vk), &info);
    barrier(commands_of(vk), image, VK_IMAGE_ASPECT_COLOR_BIT, use_nothing, use_target);
    vkCmdClearColorImage(commands_of(vk), image, use_target.layout, &color, 1, &all);
}

static bool begin(window *w) {
    window_vk *vk = w->vk;
    int width, height;
    glfwGetFramebufferSize(w->glfw, &width, &height);
    if (width <= 0 || height <= 0)
        return false;
    if (vk->stale || (uint32_t)width != vk->extent.width || (uint32_t)height != vk->extent.height) {
        if (!make_swapchain(w))
            return false;
    }
    vk_frame *frame = &vk->frames[vk->frame];
    vkWaitForFences(vk->device, 1, &frame->done, VK_TRUE, UINT64_MAX);
    VkResult code = vkAcquireNextImageKHR(vk->device, vk->swapchain, UINT64_MAX, frame->acquired,
                                          VK_NULL_HANDLE, &vk->image);
    vk->stale = code != VK_SUCCESS; /* a suboptimal one is shown once more */
    if (code != VK_SUCCESS && code != VK_SUBOPTIMAL_KHR)
        return false;
    w->width = (int)vk->extent.width;
    w->height = (int)vk->extent.height;
    begin_commands(vk);
    return true;
}

static void drop(window *w) {
    for (int i = 0; i < SLOT_CANVASES; i++)
        w->vk->slots[i].used = false;
    vkEndCommandBuffer(commands_of(w->vk));
    begin_commands(w->vk);
}

/* All that still uses the old image has ended. */
static bool make_slot(window_vk *vk, int index, uint32_t width, uint32_t height) {
    vk_slot *slot = &vk->slots[index];
    if (slot->color.width == width && slot->color.height == height)
        return true;
    vkDeviceWaitIdle(vk->device);
    free_slot(vk, slot);
    return (host_vk_image_make(vk->host, VK_FORMAT_R8G8B8A8_UNORM, width, height, 0,
                               &slot->color) &&
            (index >= SLOT_CANVASES ||
             host_vk_image_make(vk->host, VK_FORMAT_D32_SFLOAT, width, height, 0, &slot->depth))) ||
           cli_fail("vk: no memory for a picture of that size");
}

static void begin_drawing(window_vk *vk, const vk_slot *slot, const float *paper) {
    VkAttachmentLoadOp load = paper ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
    float c[3] = {0, 0, 0};
    float width = (float)slot->color.width, height = (float)slot->color.height;
    memcpy(c, paper ? paper : c, sizeof c);
    const VkRenderingAttachmentInfo color = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                             .imageView = slot->color.view,
                                             .imageLayout = use_color.layout,
                                             .loadOp = load,
                                             .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                             .clearValue = {.color = {{c[0], c[1], c[2], 1}}}};
    const VkRenderingAttachmentInfo depth = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                             .imageView = slot->depth.view,
                                             .imageLayout = use_depth.layout,
                                             .loadOp = load,
                                             .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                             .clearValue = {.depthStencil = {1, 0}}};
    const VkRenderingInfo info = {.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                  .renderArea = {{0, 0}, {slot->color.width, slot->color.height}},
                                  .layerCount = 1,
                                  .colorAttachmentCount = 1,
                                  .pColorAttachments = &color,
                                  .pDepthAttachment = &depth};
    const VkViewport viewport = {0, height, width, -height, 0, 1}; /* y up, as in OpenGL */
    vkCmdBeginRendering(commands_of(vk), &info);
    vkCmdSetViewport(commands_of(vk), 0, 1, &viewport);
    vkCmdSetScissor(commands_of(vk), 0, 1, &info.renderArea);
}

static void push(window_vk *vk, VkPipeline pipeline, const void *data, uint32_t size) {
    vkCmdBindPipeline(commands_of(vk), VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    vkCmdPushConstants(commands_of(vk), vk->layout,
                       VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, size, data);
}

/* quote images */
/* An image of ours as lineao shall see it: it comes as our last drawing left it, and goes back for
 * the next one. The barriers between are lineao's. */
static lao_image lend_image(const host_vk_image *image, vk_use before, vk_use after) {
    lao_image lent;
    memset(&lent, 0, sizeof lent);
    memcpy(&lent.native, &image->image, sizeof image->image);
    memcpy(&lent.native_view, &image->view, sizeof image->view);
    lent.native_format = (uint32_t)image->format;
    lent.width = image->width;
    lent.height = image->height;
    lent.present = 1;
    lent.flags = LAO_HOST_TOP_DOWN; /* row 0 is the top */
    lent.layout_before = (uint32_t)before.layout;
    lent.stage_before = before.stages;
    lent.access_before = before.access;
    lent.layout_after = (uint32_t)after.layout;
    lent.stage_after = after.stages;
    lent.access_after = after.access;
    return lent;
}
/* quote end */

static bool canvas(window *w, int index, uint32_t width, uint32_t height, const float paper[4],
                   const window_box *boxes, int count, lao_image *color, lao_image *depth,
                   void **commands) {
    window_vk *vk = w->vk;
    vk_slot *slot = &vk->slots[index];
    if (!make_slot(vk, index, width, height))
        return false;
    vk_use from = slot->used ? use_source : use_nothing; /* the last frame may still read it */
    from.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    barrier(commands_of(vk), slot->color.image, slot->color.aspect, from, use_color);
    vk_use before = use_depth;
    before.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    barrier(commands_of(vk), slot->depth.image, slot->depth.aspect, before, use_depth);
    begin_drawing(vk, slot, paper);
    for (int i = 0; i < count; i++) {
        push(vk, vk->box, &boxes[i], sizeof boxes[i]);
        vkCmdDraw(commands_of(vk), 36, 1, 0, 0);
    }
    vkCmdEndRendering(commands_of(vk));
    slot->used = true;
    *color = lend_image(&slot->color, use_color, use_source);
    *depth = lend_image(&slot->depth, use_depth, use_depth);
    depth->flags |= LAO_HOST_WRITABLE;
    *commands = commands_of(vk);
    return true;
}

static void ground(window *w, int index, const window_ground *g) {
    window_vk *vk = w->vk;
    const vk_slot *slot = &vk->slots[index];
    barrier(commands_of(vk), slot->color.image, slot->color.aspect, use_source, use_color);
    begin_drawing(vk, slot, NULL);
    push(vk, vk->ground, g, sizeof *g);
    vkCmdDraw(commands_of(vk), 4, 1, 0, 0);
    vkCmdEndRendering(commands_of(vk));
    barrier(commands_of(vk), slot->color.image, slot->color.aspect, use_color, use_source);
}

static bool upload(window *w, int index, uint32_t width, uint32_t height, const uint8_t *pixels) {
    window_vk *vk = w->vk;
    vk_slot *slot = &vk->slots[index];
    if (!make_slot(vk, index, width, height))
        return false;
    vkDeviceWaitIdle(vk->device);
    slot->used = host_vk_image_write(vk->host, &slot->color, use_source.layout, pixels);
    return slot->used || cli_fail("vk: a picture could not be copied");
}

static void show(window *w, int index, window_rect from, window_rect to) {
    window_vk *vk = w->vk;
    const vk_slot *slot = &vk->slots[index];
    VkImage image = vk->shown[vk->image].image;
    bool same = from.width == to.width && from.height == to.height;
    const VkImageBlit region = {
        .srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .srcOffsets = {{from.x, from.y, 0}, {from.x + from.width, from.y + from.height, 1}},
        .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .dstOffsets = {{to.x, to.y, 0}, {to.x + to.width, to.y + to.height, 1}}};
    if (!slot->used || from.width <= 0 || from.height <= 0 || to.width <= 0 || to.height <= 0)
        return;
    barrier(commands_of(vk), image, VK_IMAGE_ASPECT_COLOR_BIT, use_target, use_target);
    vkCmdBlitImage(commands_of(vk), slot->color.image, use_source.layout, image, use_target.layout,
                   1, &region, same ? VK_FILTER_NEAREST : VK_FILTER_LINEAR);
}

static void draw_interface(window_vk *vk) {
    const VkRenderPassBeginInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                        .renderPass = vk->interface,
                                        .framebuffer = vk->shown[vk->image].framebuffer,
                                        .renderArea = {{0, 0}, vk->extent}};
    barrier(commands_of(vk), vk->shown[vk->image].image, VK_IMAGE_ASPECT_COLOR_BIT, use_target,
            use_color);
    vkCmdBeginRenderPass(commands_of(vk), &info, VK_SUBPASS_CONTENTS_INLINE);
    ui_draw_vk(commands_of(vk));
    vkCmdEndRenderPass(commands_of(vk));
}

static void end(window *w) {
    window_vk *vk = w->vk;
    vk_frame *frame = &vk->frames[vk->frame];
    const VkPipelineStageFlags waits = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    VkCommandBuffer commands = commands_of(vk);
    draw_interface(vk);
    vkEndCommandBuffer(commands);
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                 .waitSemaphoreCount = 1,
                                 .pWaitSemaphores = &frame->acquired,
                                 .pWaitDstStageMask = &waits,
                                 .commandBufferCount = 1,
                                 .pCommandBuffers = &commands,
                                 .signalSemaphoreCount = 1,
                                 .pSignalSemaphores = &vk->shown[vk->image].drawn};
    const VkPresentInfoKHR present = {.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                      .waitSemaphoreCount = 1,
                                      .pWaitSemaphores = &vk->shown[vk->image].drawn,
                                      .swapchainCount = 1,
                                      .pSwapchains = &vk->swapchain,
                                      .pImageIndices = &vk->image};
    vkResetFences(vk->device, 1, &frame->done);
    VkResult code = vkQueueSubmit(host_vk_queue(vk->host), 1, &submit, frame->done);
    if (code == VK_SUCCESS)
        code = vkQueuePresentKHR(host_vk_queue(vk->host), &present);
    if (code == VK_ERROR_OUT_OF_DATE_KHR || code == VK_SUBOPTIMAL_KHR)
        vk->stale = true;
    else if (!check(code, "a frame was refused; the device may be lost"))
        w->messages++;
    vk->frame = (vk->frame + 1) % FRAMES;
}

static void wait(window *w) {
    vkDeviceWaitIdle(w->vk->device);
}

const window_backend window_vk_backend = {"vk",   "Vulkan", open,   close, lend, begin, canvas,
                                          ground, drop,     upload, show,  end,  wait};
