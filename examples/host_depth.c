/* A host with a scene of its own: its triangles and our lines hide each other, on both backends.
 *
 *     host_depth [--backend gl|vk] [--depth normal|reverse|gl] [--ortho] [--read-only] OUT.png
 *
 * 1. The host draws boxes into its own colour and depth images.
 * 2. lao_render draws the lines over the colour (background alpha 0), tested against the host's
 *    depth ("host_depth"), and leaves their depth in it (LAO_HOST_WRITABLE; not with --read-only).
 * 3. The host draws one more box, which the lines in front of it hide.
 * --depth: clip depth 0 .. w, the same reversed (near is 1), or -w .. w (OpenGL without clip
 * control). */
#include "lineao.h"

#include "camera.h"
#include "host_depth_shaders.h"
#include "host_gl.h"
#include "host_vk.h"
#include "image.h"

#include <GL/glcorearb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 640, HEIGHT = 480, LINES = 90, POINTS = 60, BOXES = 4 };
typedef enum depth_kind { DEPTH_NORMAL, DEPTH_REVERSE, DEPTH_GL } depth_kind;

typedef struct options {
    bool vulkan, ortho, read_only;
    depth_kind depth;
    const char *path;
} options;

/* What the shader draws one box from: its uniforms in OpenGL, its push constants in Vulkan. */
typedef struct box {
    float clip[16], lower[4], upper[4], color[4];
} box;

/* Everything that both backends draw. */
typedef struct stage {
    options options;
    lao_camera camera;
    box boxes[BOXES]; /* the last one is drawn after the lines */
    float points[LINES * POINTS][3];
    uint32_t offsets[LINES + 1];
    uint8_t pixels[WIDTH * HEIGHT * 4]; /* the picture, top row first */
} stage;

/* ---------------------------------------------------------------------------------- the scene */

/* Three bundles of 30 lines: in front of the boxes, behind them, and through one of them. */
static void make_lines(stage *s) {
    for (uint32_t i = 0; i < LINES * POINTS; i++) {
        uint32_t line = i / POINTS, bundle = line % 3;
        double r = 3 * sqrt((double)line / LINES), a = r * cos(0.8 * line), b = r * sin(0.8 * line);
        double t = 2.0 * (i % POINTS) / (POINTS - 1) - 1;
        s->points[i][0] = (float)(bundle == 2 ? a - 8 : 36 * t);
        s->points[i][1] = (float)(bundle == 2 ? b + 1 : b);
        s->points[i][2] = (float)(bundle == 2 ? 28 * t : bundle == 1 ? a - 20 : a + 20);
        s->offsets[line + 1] = i + 1;
    }
}

static void make_boxes(stage *s) {
    static const float boxes[BOXES][3][4] = {
        {{-40, -12, -32}, {40, -10, 32}, {0.70f, 0.70f, 0.68f, 1}}, /* the ground */
        {{-16, -10, -8}, {2, 12, 6}, {0.80f, 0.40f, 0.32f, 1}},     /* two that meet */
        {{-4, -10, -2}, {12, 4, 12}, {0.85f, 0.70f, 0.35f, 1}},
        {{17, -10, -4}, {29, 8, 12}, {0.40f, 0.70f, 0.40f, 1}}, /* the late one */
    };
    /* The host multiplies its matrices once; lineao gets them apart. */
    const float *v = s->camera.view, *p = s->camera.projection;
    for (int i = 0; i < BOXES; i++) {
        for (int k = 0; k < 16; k++) {
            double sum = 0;
            for (int j = 0; j < 4; j++)
                sum += (double)p[4 * j + k % 4] * v[k / 4 * 4 + j];
            s->boxes[i].clip[k] = (float)sum;
        }
        memcpy(s->boxes[i].lower, boxes[i], sizeof boxes[i]);
    }
}

/* The host's camera in the convention of its API; the flags tell lineao which one that is. */
static void make_camera(stage *s) {
    camera_pose pose = {{34, 38, 84}, {0, -1, 0}, {0, 1, 0}, 34, 0};
    const double center[3] = {0, 0, 0};
    float *p = s->camera.projection;
    if (s->options.ortho) {
        pose.fovy = 0;
        pose.ortho_height = 56;
    }
    camera_matrices(&pose, (double)WIDTH / HEIGHT, center, 60, s->options.depth != DEPTH_GL,
                    s->camera.view, p);
    s->camera.flags = s->options.depth != DEPTH_GL ? LAO_CAMERA_ZERO_TO_ONE : 0;
    if (s->options.depth == DEPTH_REVERSE) {
        for (int column = 0; column < 4; column++) /* z becomes w - z */
            p[4 * column + 2] = p[4 * column + 3] - p[4 * column + 2];
        s->camera.flags |= LAO_CAMERA_REVERSE_DEPTH;
    }
    if (s->options.vulkan) {
        for (int column = 0; column < 4; column++) /* Vulkan's clip space has y down */
            p[4 * column + 1] = -p[4 * column + 1];
        s->camera.flags |= LAO_CAMERA_FLIP_Y;
    }
}

/* ---------------------------------------------------------------------------------- the lines */

static void print_error(void *user, lao_log_item item, lao_result result, const char *text) {
    (void)user, (void)item;
    fprintf(stderr, "host_depth: %s: %s\n", lao_result_text(result), text);
}

/* The one part that both backends share, as any host of lineao would: `color` and `depth` say where
 * the host's images are and, in Vulkan, in which state. */
static bool draw_lines(const stage *s, lao_context *context, lao_image color, lao_image depth,
                       void *commands) {
    lao_lines_desc desc = {LINES, LINES * POINTS, s->offsets, s->points[0], .color = {0}};
    lao_view_desc size = {WIDTH, HEIGHT, 0};
    lao_settings settings = {.width = 1.0f}; /* mm */
    settings.specular = 0;                   /* zero stands for the default, ... */
    settings.set |= LAO_SET(specular);       /* ... unless its bit says that it is meant */
    lao_set set = {.settings = &settings};
    lao_import import = {"host_depth", depth};
    lao_frame frame = {.camera = s->camera, .sets = &set, .set_count = 1, .commands = commands};
    desc.color[0] = 0.35f, desc.color[1] = 0.55f, desc.color[2] = 0.90f, desc.color[3] = 1;
    import.source.flags |= s->options.read_only ? 0 : LAO_HOST_WRITABLE;
    frame.imports = &import;
    frame.import_count = 1;
    frame.target = color; /* and frame.background[3] stays 0: the host's picture is kept */
    return !lao_lines_create(context, &desc, &set.lines) &&
           !lao_view_create(context, &size, &frame.view) && !lao_render(context, &frame);
}

/* ------------------------------------------------------------------------------------- OpenGL */

/* X(name, NAME): the functions that this host itself uses. */
/* clang-format off */
#define GL_FUNCTIONS(X)                                                                            \
    X(CreateShader, CREATESHADER) X(ShaderSource, SHADERSOURCE) X(CompileShader, COMPILESHADER)    \
    X(CreateProgram, CREATEPROGRAM) X(AttachShader, ATTACHSHADER) X(LinkProgram, LINKPROGRAM)      \
    X(GetProgramiv, GETPROGRAMIV) X(UseProgram, USEPROGRAM)                                        \
    X(GetUniformLocation, GETUNIFORMLOCATION) X(UniformMatrix4fv, UNIFORMMATRIX4FV)                \
    X(Uniform4fv, UNIFORM4FV) X(GenVertexArrays, GENVERTEXARRAYS)                                  \
    X(BindVertexArray, BINDVERTEXARRAY) X(GenTextures, GENTEXTURES) X(BindTexture, BINDTEXTURE)    \
    X(TexImage2D, TEXIMAGE2D) X(GenFramebuffers, GENFRAMEBUFFERS)                                  \
    X(BindFramebuffer, BINDFRAMEBUFFER) X(FramebufferTexture2D, FRAMEBUFFERTEXTURE2D)              \
    X(Viewport, VIEWPORT) X(ClearColor, CLEARCOLOR) X(ClearDepth, CLEARDEPTH) X(Clear, CLEAR)      \
    X(Enable, ENABLE) X(DepthFunc, DEPTHFUNC) X(DrawArrays, DRAWARRAYS) X(ReadPixels, READPIXELS)  \
    X(ClipControl, CLIPCONTROL)
/* clang-format on */

typedef struct gl_functions {
#define GL_MEMBER(name, NAME) PFNGL##NAME##PROC name;
    GL_FUNCTIONS(GL_MEMBER)
#undef GL_MEMBER
} gl_functions;

static void gl_load(gl_functions *gl) {
    void *address;
#define GL_LOAD(name, NAME)                                                                        \
    address = host_gl_get_proc("gl" #name, NULL);                                                  \
    memcpy(&gl->name, &address, sizeof address);
    GL_FUNCTIONS(GL_LOAD)
#undef GL_LOAD
}

static GLuint gl_program(const gl_functions *gl) {
    static const char *const heads[2] = {"#version 330 core\n#define VERTEX\n",
                                         "#version 330 core\n"};
    GLuint program = gl->CreateProgram();
    GLint linked = 0;
    for (int i = 0; i < 2; i++) {
        const char *text[2] = {heads[i], host_depth_glsl};
        GLuint shader = gl->CreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        gl->ShaderSource(shader, 2, text, NULL);
        gl->CompileShader(shader);
        gl->AttachShader(program, shader);
    }
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
    return linked ? program : 0;
}

static GLuint gl_texture(const gl_functions *gl, GLint internal, GLenum format, GLenum type) {
    GLuint texture;
    gl->GenTextures(1, &texture);
    gl->BindTexture(GL_TEXTURE_2D, texture);
    gl->TexImage2D(GL_TEXTURE_2D, 0, internal, WIDTH, HEIGHT, 0, format, type, NULL);
    return texture;
}

static void gl_draw_box(const gl_functions *gl, GLuint program, const box *b) {
    gl->UniformMatrix4fv(gl->GetUniformLocation(program, "box.clip"), 1, GL_FALSE, b->clip);
    gl->Uniform4fv(gl->GetUniformLocation(program, "box.lower"), 1, b->lower);
    gl->Uniform4fv(gl->GetUniformLocation(program, "box.upper"), 1, b->upper);
    gl->Uniform4fv(gl->GetUniformLocation(program, "box.color"), 1, b->color);
    gl->DrawArrays(GL_TRIANGLES, 0, 36);
}

/* The state that the host draws with stays set across lao_render: lineao puts it back. */
static bool gl_begin(const gl_functions *gl, const stage *s, GLuint program) {
    GLuint array;
    if (s->options.depth != DEPTH_GL) {
        if (!gl->ClipControl)
            return false;
        gl->ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    }
    gl->GenVertexArrays(1, &array);
    gl->BindVertexArray(array);
    gl->UseProgram(program);
    gl->Viewport(0, 0, WIDTH, HEIGHT);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(s->options.depth == DEPTH_REVERSE ? GL_GREATER : GL_LESS);
    gl->ClearDepth(s->options.depth == DEPTH_REVERSE ? 0 : 1);
    gl->ClearColor(0.93f, 0.94f, 0.96f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    return true;
}

static bool gl_draw(stage *s, const gl_functions *gl, lao_context *context) {
    GLuint program = gl_program(gl), framebuffer;
    GLuint color = gl_texture(gl, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
    GLuint depth = gl_texture(gl, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT);
    const GLenum points[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    const GLuint names[2] = {color, depth};
    gl->GenFramebuffers(1, &framebuffer);
    gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    for (int i = 0; i < 2; i++)
        gl->FramebufferTexture2D(GL_FRAMEBUFFER, points[i], GL_TEXTURE_2D, names[i], 0);
    if (!program || !gl_begin(gl, s, program))
        return false;
    for (int i = 0; i < BOXES - 1; i++)
        gl_draw_box(gl, program, &s->boxes[i]);

    lao_image target = {.native = color, .width = WIDTH, .height = HEIGHT, .present = 1};
    lao_image tested = {.native = depth, .width = WIDTH, .height = HEIGHT, .present = 1};
    if (!draw_lines(s, context, target, tested, NULL))
        return false;

    gl_draw_box(gl, program, &s->boxes[BOXES - 1]);
    for (int y = 0; y < HEIGHT; y++) /* row 0 of OpenGL is the bottom */
        gl->ReadPixels(0, HEIGHT - 1 - y, WIDTH, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                       s->pixels + (size_t)y * WIDTH * 4);
    return true;
}

static bool gl_run(stage *s) {
    char error[HOST_ERROR_SIZE];
    host_gl *host;
    gl_functions functions;
    lao_gl_desc gl = {.get_proc = host_gl_get_proc};
    lao_backend backend;
    lao_desc desc = {.backend = &backend, .logger = {print_error, NULL}};
    lao_context *context = NULL;
    if (!host_gl_open(NULL, &host, error)) {
        fprintf(stderr, "host_depth: %s\n", error);
        return false;
    }
    gl_load(&functions);
    bool ok = !lao_gl_backend(&gl, &backend) && !lao_create(&desc, &context) &&
              gl_draw(s, &functions, context);
    lao_destroy(context); /* before the OpenGL context that it lives in */
    host_gl_close(host);
    return ok;
}

/* ------------------------------------------------------------------------------------- Vulkan */

/* The host's images, and the pipeline of its boxes. */
typedef struct vk_scene {
    host_vk_image color, depth;
    VkShaderModule shaders[2];
    VkPipelineLayout layout;
    VkPipeline pipeline;
} vk_scene;

static bool vk_layout(VkDevice device, vk_scene *scene) {
    const VkPushConstantRange range = {VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(box)};
    const VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &range,
    };
    VkShaderModuleCreateInfo words[2] = {
        {.codeSize = sizeof host_depth_vert, .pCode = host_depth_vert},
        {.codeSize = sizeof host_depth_frag, .pCode = host_depth_frag},
    };
    bool ok = vkCreatePipelineLayout(device, &info, NULL, &scene->layout) == VK_SUCCESS;
    for (int i = 0; i < 2 && ok; i++) {
        words[i].sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
        ok = vkCreateShaderModule(device, &words[i], NULL, &scene->shaders[i]) == VK_SUCCESS;
    }
    return ok;
}

static bool vk_pipeline(VkDevice device, bool reverse, vk_scene *scene) {
    const VkPipelineShaderStageCreateInfo stages[2] = {
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_VERTEX_BIT,
         .module = scene->shaders[0],
         .pName = "main"},
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
         .module = scene->shaders[1],
         .pName = "main"},
    };
    const VkPipelineVertexInputStateCreateInfo vertices = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkViewport viewport = {0, 0, WIDTH, HEIGHT, 0, 1};
    const VkRect2D scissor = {{0, 0}, {WIDTH, HEIGHT}};
    const VkPipelineViewportStateCreateInfo viewports = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .pViewports = &viewport,
        .scissorCount = 1,
        .pScissors = &scissor};
    const VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = VK_TRUE,
        .depthCompareOp = reverse ? VK_COMPARE_OP_GREATER : VK_COMPARE_OP_LESS};
    const VkPipelineColorBlendAttachmentState all = {.colorWriteMask = 15};
    const VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 1,
        .pAttachments = &all};
    const VkPipelineRenderingCreateInfo rendering = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = 1,
        .pColorAttachmentFormats = &scene->color.format,
        .depthAttachmentFormat = scene->depth.format};
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
                                               .layout = scene->layout};
    return vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &scene->pipeline) ==
           VK_SUCCESS;
}

/* Both images pass from no content to the layouts in which the host and lineao hand them about. */
static void vk_ready(const vk_scene *scene, VkCommandBuffer commands) {
    VkImageMemoryBarrier2 barriers[2] = {
        {.image = scene->color.image,
         .dstStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
         .dstAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
         .newLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
        {.image = scene->depth.image,
         .dstStageMask = VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT,
         .dstAccessMask = VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
         .newLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL},
    };
    const VkDependencyInfo info = {.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                   .imageMemoryBarrierCount = 2,
                                   .pImageMemoryBarriers = barriers};
    for (int i = 0; i < 2; i++) {
        barriers[i].sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
        barriers[i].subresourceRange =
            (VkImageSubresourceRange){i ? scene->depth.aspect : scene->color.aspect, 0, 1, 0, 1};
    }
    vkCmdPipelineBarrier2(commands, &info);
}

/* Draws boxes [first, end), over what is there or over a cleared picture. */
static void vk_draw_boxes(const stage *s, const vk_scene *scene, VkCommandBuffer commands,
                          int first, int end) {
    const VkAttachmentLoadOp load =
        first ? VK_ATTACHMENT_LOAD_OP_LOAD : VK_ATTACHMENT_LOAD_OP_CLEAR;
    const VkRenderingAttachmentInfo color = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                             .imageView = scene->color.view,
                                             .imageLayout =
                                                 VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                             .loadOp = load,
                                             .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                             .clearValue = {.color = {{0.93f, 0.94f, 0.96f, 1}}}};
    const VkRenderingAttachmentInfo depth = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
        .imageView = scene->depth.view,
        .imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
        .loadOp = load,
        .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
        .clearValue = {.depthStencil = {s->options.depth == DEPTH_REVERSE ? 0.0f : 1.0f, 0}}};
    const VkRenderingInfo info = {.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                  .renderArea = {{0, 0}, {WIDTH, HEIGHT}},
                                  .layerCount = 1,
                                  .colorAttachmentCount = 1,
                                  .pColorAttachments = &color,
                                  .pDepthAttachment = &depth};
    vkCmdBeginRendering(commands, &info);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, scene->pipeline);
    for (int i = first; i < end; i++) {
        vkCmdPushConstants(commands, scene->layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(box),
                           &s->boxes[i]);
        vkCmdDraw(commands, 36, 1, 0, 0);
    }
    vkCmdEndRendering(commands);
}

/* An image of ours as lineao shall see it: it comes as the host's last rendering left it, and goes
 * back for the next one. The barriers between are lineao's. */
static lao_image vk_lend(const host_vk_image *image, VkImageLayout layout,
                         VkPipelineStageFlags2 stages, VkAccessFlags2 access) {
    lao_image lent = {.width = WIDTH, .height = HEIGHT, .present = 1};
    memcpy(&lent.native, &image->image, sizeof image->image);
    memcpy(&lent.native_view, &image->view, sizeof image->view);
    lent.native_format = (uint32_t)image->format;
    lent.flags = LAO_HOST_TOP_DOWN; /* the host draws with y down: row 0 is the top */
    lent.layout_before = lent.layout_after = (uint32_t)layout;
    lent.stage_before = lent.stage_after = stages;
    lent.access_before = lent.access_after = access;
    return lent;
}

static bool vk_draw(stage *s, host_vk *host, vk_scene *scene, lao_context *context) {
    VkDevice device = host_vk_device(host);
    if (!host_vk_image_make(host, VK_FORMAT_R8G8B8A8_UNORM, WIDTH, HEIGHT, 0, &scene->color) ||
        !host_vk_image_make(host, VK_FORMAT_D32_SFLOAT, WIDTH, HEIGHT, 0, &scene->depth) ||
        !vk_layout(device, scene) || !vk_pipeline(device, s->options.depth == DEPTH_REVERSE, scene))
        return false;
    VkCommandBuffer commands = host_vk_begin(host);
    if (!commands)
        return false;
    vk_ready(scene, commands);
    vk_draw_boxes(s, scene, commands, 0, BOXES - 1);

    lao_image target =
        vk_lend(&scene->color, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
    lao_image tested = vk_lend(&scene->depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                               VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT |
                                   VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                               VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                   VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT);
    bool ok = draw_lines(s, context, target, tested, commands);

    vk_draw_boxes(s, scene, commands, BOXES - 1, BOXES);
    return host_vk_submit_and_wait(host, commands) && ok &&
           host_vk_image_read(host, &scene->color, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                              s->pixels);
}

static void vk_free(host_vk *host, vk_scene *scene) {
    VkDevice device = host_vk_device(host);
    vkDestroyPipeline(device, scene->pipeline, NULL);
    vkDestroyPipelineLayout(device, scene->layout, NULL);
    for (int i = 0; i < 2; i++)
        vkDestroyShaderModule(device, scene->shaders[i], NULL);
    host_vk_image_free(host, &scene->color);
    host_vk_image_free(host, &scene->depth);
}

/* HOST_DEPTH_VALIDATION=1 in the environment: with the Khronos layer; its messages are failures. */
static bool vk_run(stage *s) {
    char error[HOST_VK_ERROR_SIZE];
    host_vk *host;
    vk_scene scene = {0};
    lao_backend backend;
    lao_desc desc = {.backend = &backend, .logger = {print_error, NULL}};
    lao_context *context = NULL;
    host_vk_desc wanted = {.synchronization_validation = getenv("HOST_DEPTH_VALIDATION") != NULL};
    if (!host_vk_open(&wanted, &host, error)) {
        fprintf(stderr, "host_depth: %s\n", error);
        return false;
    }
    lao_vk_desc vk = {host_vk_instance(host), host_vk_physical(host), host_vk_device(host),
                      .queue_family = host_vk_family(host)};
    PFN_vkGetInstanceProcAddr get_proc = host_vk_get_instance_proc(host);
    memcpy(&vk.get_instance_proc, &get_proc, sizeof get_proc);
    bool ok = !lao_vk_backend(&vk, &backend) && !lao_create(&desc, &context) &&
              vk_draw(s, host, &scene, context);
    lao_destroy(context); /* the device is done with its work, and still there */
    vk_free(host, &scene);
    if (host_vk_messages(host) > 0)
        fprintf(stderr, "host_depth: %.200s\n", host_vk_first_message(host));
    return host_vk_close(host) == 0 && ok;
}

/* --------------------------------------------------------------------------------------- main */

static bool parse(int count, char **arguments, options *out) {
    static const char *const names[] = {"normal", "reverse", "gl"};
    int depth = 0;
    for (int i = 1; i < count; i++) {
        const char *word = arguments[i], *value = i + 1 < count ? arguments[i + 1] : "";
        if (!strcmp(word, "--ortho")) {
            out->ortho = true;
        } else if (!strcmp(word, "--read-only")) {
            out->read_only = true;
        } else if (!strcmp(word, "--backend") && (!strcmp(value, "gl") || !strcmp(value, "vk"))) {
            out->vulkan = !strcmp(value, "vk");
            i++;
        } else if (!strcmp(word, "--depth")) {
            for (depth = 0; depth < 3 && strcmp(value, names[depth]) != 0;)
                depth++;
            i++;
        } else if (word[0] != '-' && !out->path) {
            out->path = word;
        } else {
            return false;
        }
    }
    out->depth = (depth_kind)depth;
    return out->path && depth < 3 && !(out->vulkan && out->depth == DEPTH_GL);
}

int main(int count, char **arguments) {
    char error[IMAGE_ERROR_SIZE];
    stage *s = calloc(1, sizeof *s);
    if (!s || !parse(count, arguments, &s->options)) {
        fprintf(stderr, "usage: host_depth [--backend gl|vk] [--depth normal|reverse|gl (not vk)] "
                        "[--ortho] [--read-only] OUT.png\n");
        free(s);
        return 2;
    }
    make_lines(s);
    make_camera(s);
    make_boxes(s);
    bool ok = s->options.vulkan ? vk_run(s) : gl_run(s);
    if (ok && !image_write_png(s->options.path, WIDTH, HEIGHT, s->pixels, 4, error)) {
        fprintf(stderr, "host_depth: %s\n", error);
        ok = false;
    }
    free(s);
    return ok ? 0 : 1;
}
