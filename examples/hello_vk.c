/* The smallest Vulkan host: makes lines, lets lineao draw them into an image, writes a picture.
 *     cc -std=c99 -I. examples/hello_vk.c lineao_vk.c -lvulkan -lm -o hello_vk && ./hello_vk
 * The host owns device, queue, commands, images; lineao owns what it makes, and never submits. */
#define LINEAO_IMPLEMENTATION /* in exactly one file of a program */
#include "lineao.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

enum { WIDTH = 640, HEIGHT = 480, LINES = 400, POINTS = 160 };
static float points[LINES * POINTS][3]; /* mm */
static uint32_t offsets[LINES + 1];     /* line i has points offsets[i] .. offsets[i + 1] - 1 */
enum { SEEN = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT };
#define TRY(call) ((call) ? (fprintf(stderr, "hello_vk: %s failed\n", #call), exit(1)) : (void)0)
#define INFO(Type, TYPE, ...) Vk##Type Type = {VK_STRUCTURE_TYPE_##TYPE, __VA_ARGS__}

/* lineao never prints and never aborts: a failure is a result and one call of the logger. */
static void print_error(void *user, lao_log_item item, lao_result result, const char *text) {
    fprintf((FILE *)user, "lineao: %s (%d): %s\n", lao_result_text(result), (int)item, text);
}

/* ISO C has no cast from a function to an object pointer, so the bits are copied. */
static void *get_proc(void *instance, const char *name) {
    PFN_vkVoidFunction function = vkGetInstanceProcAddr((VkInstance)instance, name);
    void *address = NULL;
    memcpy(&address, &function, sizeof address);
    return address;
}

/* A straight bundle, and a coil of the other half of the lines around it. */
static void make_lines(void) {
    for (uint32_t i = 0; i < LINES * POINTS; i++) {
        uint32_t line = i / POINTS, coil = line % 2;
        double r = sqrt((double)line / LINES), a = r * cos(2.4 * line), b = r * sin(2.4 * line);
        double t = 2.0 * (i % POINTS) / (POINTS - 1) - 1; /* along the line */
        points[i][0] = (float)(coil ? 45 * t : 8 * a);
        points[i][1] = (float)(coil ? (20 + 6 * a) * cos(6 * t + 2 * b) : 34 * t);
        points[i][2] = (float)(coil ? (20 + 6 * a) * sin(6 * t + 2 * b) : 8 * b - 20 * t);
        offsets[line + 1] = i + 1;
    }
}

static VkInstance instance;
static VkPhysicalDevice physical;
static VkDevice device;

/* Any host has these already. Of the device lineao needs the two features of Vulkan 1.3. */
static void open_vulkan(void) {
    INFO(ApplicationInfo, APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3);
    INFO(InstanceCreateInfo, INSTANCE_CREATE_INFO, .pApplicationInfo = &ApplicationInfo);
    TRY(vkCreateInstance(&InstanceCreateInfo, NULL, &instance));
    TRY(vkEnumeratePhysicalDevices(instance, &(uint32_t){1}, &physical) < 0 || !physical);
    INFO(PhysicalDeviceVulkan13Features, PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
         .dynamicRendering = VK_TRUE, .synchronization2 = VK_TRUE);
    INFO(DeviceQueueCreateInfo, DEVICE_QUEUE_CREATE_INFO, .queueFamilyIndex = 0, .queueCount = 1,
         .pQueuePriorities = &(float){1}); /* family 0 draws, except on exotic devices */
    INFO(DeviceCreateInfo, DEVICE_CREATE_INFO, .pNext = &PhysicalDeviceVulkan13Features,
         .queueCreateInfoCount = 1, .pQueueCreateInfos = &DeviceQueueCreateInfo);
    TRY(vkCreateDevice(physical, &DeviceCreateInfo, NULL, &device));
}

int main(int count, char **arguments) {
    make_lines();
    open_vulkan();
    /* The host's image, in memory that the CPU sees; optimal tiling would change nothing below. */
    VkImage image;
    VkImageView view;
    VkMemoryRequirements needs;
    VkPhysicalDeviceMemoryProperties has;
    VkDeviceMemory memory;
    VkSubresourceLayout rows;
    void *pixels;
    INFO(ImageCreateInfo, IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
         .format = VK_FORMAT_R8G8B8A8_UNORM, .extent = {WIDTH, HEIGHT, 1}, .mipLevels = 1,
         .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT, .tiling = VK_IMAGE_TILING_LINEAR,
         .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
    TRY(vkCreateImage(device, &ImageCreateInfo, NULL, &image));
    vkGetImageSubresourceLayout(device, image, &(VkImageSubresource){.aspectMask = 1}, &rows);
    vkGetImageMemoryRequirements(device, image, &needs);
    vkGetPhysicalDeviceMemoryProperties(physical, &has);
    INFO(MemoryAllocateInfo, MEMORY_ALLOCATE_INFO, .allocationSize = needs.size);
    for (uint32_t i = 0; i < has.memoryTypeCount; i++)
        if ((needs.memoryTypeBits >> i & 1) && (has.memoryTypes[i].propertyFlags & SEEN) == SEEN)
            MemoryAllocateInfo.memoryTypeIndex = i;
    TRY(vkAllocateMemory(device, &MemoryAllocateInfo, NULL, &memory));
    TRY(vkBindImageMemory(device, image, memory, 0));
    TRY(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &pixels));
    INFO(ImageViewCreateInfo, IMAGE_VIEW_CREATE_INFO, .image = image,
         .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = VK_FORMAT_R8G8B8A8_UNORM,
         .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1});
    TRY(vkCreateImageView(device, &ImageViewCreateInfo, NULL, &view));

    /* Once: a context, the lines, copied to the GPU, and a view, the scratch images of a window. */
    lao_vk_desc vk = {instance, physical, device, get_proc, .queue_family = 0};
    lao_backend backend;
    lao_desc desc = {.backend = &backend, .logger = {print_error, stderr}};
    lao_context *context;
    TRY(lao_vk_backend(&vk, &backend) || lao_create(&desc, &context));
    lao_lines_desc lines = {LINES, LINES * POINTS, offsets, points[0], .times = NULL};
    lao_set set = {.settings = NULL}; /* the recommended ones */
    lao_frame frame = {.sets = &set, .set_count = 1, .background = {0.95f, 0.95f, 0.95f, 1}};
    TRY(lao_lines_create(context, &lines, &set.lines));
    TRY(lao_view_create(context, &(lao_view_desc){WIDTH, HEIGHT, 0}, &frame.view));

    /* The host's own matrices, column-major. Flags: y points down and clip depth is 0 .. w. */
    frame.camera =
        (lao_camera){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -128, 1},
                     {3.0f * HEIGHT / WIDTH, 0, 0, 0, 0, -3, 0, 0, 0, 0, -1.5f, -1, 0, 0, -96, 0},
                     LAO_CAMERA_ZERO_TO_ONE | LAO_CAMERA_FLIP_Y};
    /* The image, with the state in which it comes (zero: undefined) and that in which it goes. */
    frame.target = (lao_image){.present = 1, .width = WIDTH, .height = HEIGHT};
    memcpy(&frame.target.native, &image, sizeof image);
    memcpy(&frame.target.native_view, &view, sizeof view);
    frame.target.native_format = VK_FORMAT_R8G8B8A8_UNORM;
    frame.target.flags = LAO_HOST_TOP_DOWN; /* row 0 is the top of the picture */
    frame.target.layout_after = VK_IMAGE_LAYOUT_GENERAL;
    frame.target.stage_after = VK_PIPELINE_STAGE_2_HOST_BIT;
    frame.target.access_after = VK_ACCESS_2_HOST_READ_BIT;

    /* Every frame: lineao records into our commands, outside of rendering; we submit. */
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer commands;
    vkGetDeviceQueue(device, 0, 0, &queue);
    INFO(CommandPoolCreateInfo, COMMAND_POOL_CREATE_INFO, .queueFamilyIndex = 0);
    TRY(vkCreateCommandPool(device, &CommandPoolCreateInfo, NULL, &pool));
    INFO(CommandBufferAllocateInfo, COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = pool,
         .commandBufferCount = 1);
    TRY(vkAllocateCommandBuffers(device, &CommandBufferAllocateInfo, &commands));
    INFO(CommandBufferBeginInfo, COMMAND_BUFFER_BEGIN_INFO, .flags = 0);
    TRY(vkBeginCommandBuffer(commands, &CommandBufferBeginInfo));
    frame.commands = commands;
    TRY(lao_render(context, &frame) || vkEndCommandBuffer(commands));
    INFO(SubmitInfo, SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands);
    TRY(vkQueueSubmit(queue, 1, &SubmitInfo, VK_NULL_HANDLE) || vkQueueWaitIdle(queue));
    lao_destroy(context); /* with its lines and views, when the device is done with them */
    FILE *file = fopen(count > 1 ? arguments[1] : "hello_vk.ppm", "wb");
    TRY(!file || fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT) < 0);
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        TRY(!fwrite((uint8_t *)pixels + i / WIDTH * rows.rowPitch + i % WIDTH * 4, 3, 1, file));
    vkDestroyCommandPool(device, pool, NULL);
    vkDestroyImageView(device, view, NULL);
    vkDestroyImage(device, image, NULL);
    vkFreeMemory(device, memory, NULL);
    vkDestroyDevice(device, NULL);
    vkDestroyInstance(instance, NULL);
    return fclose(file) != 0;
}
