#include "gl_frame.h"

#include <stdlib.h>
#include <string.h>

/* -------------------------------------------------------------------------------------- shaders */

static const char *const lines_vertex[] = {
    "uniform samplerBuffer t_points;\n",
    "uniform samplerBuffer t_colors;\n",
    "flat out vec4 t_color;\n",
    "void main() {\n",
    "    int segment = gl_VertexID / 4, corner = gl_VertexID % 4;\n",
    "    vec4 p = texelFetch(t_points, segment + 1 + corner / 2);\n",
    "    t_color = texelFetch(t_colors, segment + 1 + corner / 2);\n",
    "    float y = p.y + (corner % 2 == 0 ? -0.3 : 0.3);\n",
    "#ifdef LAO_CLIP_NEGATIVE_ONE\n",
    "    gl_Position = vec4(p.x, y, 2.0 * p.z - 1.0, 1.0);\n",
    "#else\n",
    "    gl_Position = vec4(p.x, y, p.z, 1.0);\n",
    "#endif\n",
    "}\n"};
static const char *const lines_fragment[] = {"flat in vec4 t_color;\n",
                                             "layout(location = 0) out vec4 t_out;\n",
                                             "layout(location = 2) out vec4 t_depth;\n",
                                             "void main() {\n",
                                             "    t_out = t_color;\n",
                                             "    t_depth = vec4(gl_FragCoord.z);\n",
                                             "}\n"};
static const char *const over_fragment[] = {
    "LAO_SETTINGS_BLOCK(2)\n",
    "uniform sampler2D t_depth;\n",
    "uniform sampler2D t_nothing;\n",
    "layout(location = 0) out vec4 t_out;\n",
    "void main() {\n",
    "    ivec2 at = ivec2(gl_FragCoord.xy);\n",
    "    float d = texelFetch(t_depth, at, 0).x + texelFetch(t_nothing, at, 0).x;\n",
    "    float uniforms = lao_frame.target.x + lao_settings_rows[1].x + lao_step.size.z;\n",
    "    t_out = vec4(d * 0.25 * float(lao_constant_scale), uniforms, 0.0, 0.5);\n",
    "}\n"};
static const char *const history_fragment[] = {
    "uniform sampler2D t_color;\n",
    "uniform sampler2D t_before;\n",
    "uniform sampler2D t_depth;\n",
    "layout(location = 0) out vec4 t_out;\n",
    "void main() {\n",
    "    ivec2 at = ivec2(gl_FragCoord.xy);\n",
    "    t_out = texelFetch(t_color, at, 0) + 0.5 * texelFetch(t_before, at, 0);\n",
    "    t_out.w += texelFetch(t_depth, at, 0).x;\n",
    "}\n"};
static const char *const depth_fragment[] = {
    "uniform sampler2D t_depth;\n", "void main() {\n", "    ivec2 at = ivec2(gl_FragCoord.xy);\n",
    "    gl_FragDepth = 1.0 - texelFetch(t_depth, at, 0).x;\n", "}\n"};
static const char *const present_fragment[] = {"uniform sampler2D t_image;\n",
                                               "layout(location = 0) out vec4 t_out;\n",
                                               "void main() {\n",
                                               "    ivec2 at = ivec2(gl_FragCoord.xy);\n",
                                               "    t_out = texelFetch(t_image, at, 0);\n",
                                               "}\n"};
static const char *const line_names[] = {"t_points", "t_colors"};
static const char *const over_names[] = {"t_depth", "t_nothing"};
static const char *const history_names[] = {"t_color", "t_before", "t_depth"};
static const char *const depth_names[] = {"t_depth"};
static const char *const present_names[] = {"t_image"};
static const char *const over_constants[] = {"scale"};
static const lao_texture_type buffers[] = {LAO_TEXTURE_BUFFER, LAO_TEXTURE_BUFFER};
static const lao_texture_type images[] = {LAO_TEXTURE_2D, LAO_TEXTURE_2D, LAO_TEXTURE_2D};
#define STAGE(lines)                                                                               \
    { lines, sizeof lines / sizeof *lines, NULL, 0 }
#define NO_STAGE                                                                                   \
    { NULL, 0, NULL, 0 }
static const lao_shader shaders[GL_FRAME_STEPS] = {
    {"t_lines", NULL, 0, line_names, buffers, 2, 3, STAGE(lines_vertex), STAGE(lines_fragment),
     NULL, 0},
    {"t_over", over_constants, 1, over_names, images, 2, 1, NO_STAGE, STAGE(over_fragment), NULL,
     0},
    {"t_history", NULL, 0, history_names, images, 3, 1, NO_STAGE, STAGE(history_fragment), NULL, 0},
    {"t_depth", NULL, 0, depth_names, images, 1, 0, NO_STAGE, STAGE(depth_fragment), NULL, 0},
    {"t_present", NULL, 0, present_names, images, 1, 1, NO_STAGE, STAGE(present_fragment), NULL, 0},
};
const lao_shader *const gl_frame_shaders[GL_FRAME_STEPS] = {&shaders[0], &shaders[1], &shaders[2],
                                                            &shaders[3], &shaders[4]};

static const lao_pass_row rows[GL_FRAME_STEPS] = {
    {"lines",
     LAO_PASS_DRAW_LINES,
     "t_lines",
     0,
     LAO_STAGE_DRAW,
     LAO_SCOPE_PER_SET,
     LAO_REPEAT_NONE,
     NULL,
     LAO_BLEND_NONE,
     LAO_DEPTH_NEARER,
     LAO_CULL_NONE,
     {{0}},
     {{0}},
     {{0}}},
    {"over",
     LAO_PASS_FULLSCREEN,
     "t_over",
     0,
     LAO_STAGE_DRAW,
     LAO_SCOPE_FRAME,
     LAO_REPEAT_NONE,
     NULL,
     LAO_BLEND_OVER,
     LAO_DEPTH_NONE,
     LAO_CULL_NONE,
     {{0}},
     {{0}},
     {{0}}},
    {"history",
     LAO_PASS_FULLSCREEN,
     "t_history",
     0,
     LAO_STAGE_DRAW,
     LAO_SCOPE_FRAME,
     LAO_REPEAT_NONE,
     NULL,
     LAO_BLEND_NONE,
     LAO_DEPTH_NONE,
     LAO_CULL_NONE,
     {{0}},
     {{0}},
     {{0}}},
    {"depth",
     LAO_PASS_FULLSCREEN,
     "t_depth",
     0,
     LAO_STAGE_DRAW,
     LAO_SCOPE_FRAME,
     LAO_REPEAT_NONE,
     NULL,
     LAO_BLEND_NONE,
     LAO_DEPTH_ALWAYS,
     LAO_CULL_NONE,
     {{0}},
     {{0}},
     {{0}}},
    {"present",
     LAO_PASS_FULLSCREEN,
     "t_present",
     0,
     LAO_STAGE_DRAW,
     LAO_SCOPE_FRAME,
     LAO_REPEAT_NONE,
     NULL,
     LAO_BLEND_ADD,
     LAO_DEPTH_NONE,
     LAO_CULL_NONE,
     {{0}},
     {{0}},
     {{0}}},
};

/* ----------------------------------------------------------------------------------------- core */

static void core_report(void *context, lao_log_item item, const char *detail) {
    gl_frame_core *core = (gl_frame_core *)context;
    core->logs++;
    core->item = item;
    strncpy(core->text, detail, sizeof core->text - 1);
}

void gl_frame_core_init(gl_frame_core *core) {
    memset(core, 0, sizeof *core);
    core->host.allocator = lent_allocator(&core->memory);
    core->host.report = core_report;
    core->host.context = core;
    core->host.settings_size = GL_FRAME_SETTINGS * sizeof(float);
    core->host.graph = &core->graph;
    core->graph.module_count = GL_FRAME_MODULES;
}

/* ----------------------------------------------------------------------------------------- plan */

static void instance(gl_frame *frame, uint32_t index, uint32_t size, uint32_t even, uint32_t odd) {
    lao_plan_instance *it = &frame->instances[index];
    it->width = it->height = size;
    it->slot[0] = even;
    it->slot[1] = odd;
    it->import = even == LAO_NO_INDEX ? LAO_IMPORT_TARGET : LAO_NO_INDEX;
}

enum { COLOR, LINEAR_DEPTH, DEPTH, NOW, BEFORE, TARGET }; /* instances */

/* The pass "over" adds three numbers, one of each block, to 1 / 8; everywhere else stands a 9. */
static void uniforms(gl_frame *frame) {
    lao_frame_uniforms *of_frame = &frame->frame_uniforms;
    uint32_t i;
    for (i = 0; i < GL_FRAME_SETS * GL_FRAME_MODULES * GL_FRAME_SETTINGS; i++)
        frame->settings[i] = 9;
    frame->settings[(1 * GL_FRAME_MODULES + 1) * GL_FRAME_SETTINGS + 4] = 1 / 32.0f;
    of_frame->target.x = 1 / 16.0f;
    for (i = 0; i < GL_FRAME_STEPS; i++)
        frame->steps[i].uniforms[2] = i == 1 ? 1 / 32.0f : 9;
    frame->steps[1].set = 1;
    frame->steps[1].module = 1;
    frame->execution.frame_uniforms = of_frame;
    frame->execution.frame_size = sizeof *of_frame;
    frame->execution.set_uniforms = frame->settings;
    frame->execution.set_count = GL_FRAME_SETS;
}

static lao_plan_step *step(gl_frame *frame, uint32_t index, uint32_t size, uint32_t color) {
    lao_plan_step *it = &frame->steps[index];
    it->row = &rows[index];
    it->shader = index;
    it->width = it->height = size;
    it->depth.instance = LAO_NO_INDEX;
    it->color_count = color != LAO_NO_INDEX;
    it->colors[0].instance = color;
    it->colors[0].clear = 2;
    return it;
}

static void reads(lao_plan_step *it, uint32_t count, uint32_t a, uint32_t b, uint32_t c) {
    it->read_count = count;
    it->reads[0] = a;
    it->reads[1] = b;
    it->reads[2] = c;
}

void gl_frame_init(gl_frame *frame, uint32_t size) {
    static const lao_format formats[GL_FRAME_SLOTS] = {LAO_FORMAT_RGBA16F, LAO_FORMAT_R32F,
                                                       LAO_FORMAT_D32F, LAO_FORMAT_RGBA32F,
                                                       LAO_FORMAT_RGBA32F};
    lao_plan_step *it;
    uint32_t i;
    memset(frame, 0, sizeof *frame);
    for (i = 0; i < GL_FRAME_SLOTS; i++) {
        frame->slots[i].format = formats[i];
        frame->slots[i].width = frame->slots[i].height = size;
    }
    instance(frame, COLOR, size, 0, 0);
    instance(frame, LINEAR_DEPTH, size, 1, 1);
    instance(frame, DEPTH, size, 2, 2);
    instance(frame, NOW, size, 3, 4);
    instance(frame, BEFORE, size, 4, 3);
    instance(frame, TARGET, size, LAO_NO_INDEX, LAO_NO_INDEX);
    it = step(frame, 0, size, COLOR);
    it->color_count = 3;
    it->colors[0].clear = it->colors[2].clear = it->depth.clear = 1;
    it->colors[0].value[2] = 0.25f;
    it->colors[1].instance = LAO_NO_INDEX;
    it->colors[2].instance = LINEAR_DEPTH;
    it->depth.instance = DEPTH;
    it->depth.value[0] = 1;
    reads(it, 2, LAO_READ_BUFFER, LAO_READ_BUFFER + 1, 0);
    it = step(frame, 1, size, COLOR);
    it->colors[0].clear = 0;
    it->constants[0] = 3;
    reads(it, 2, LINEAR_DEPTH, LAO_NO_INDEX, 0);
    reads(step(frame, 2, size, NOW), 3, COLOR, BEFORE, DEPTH);
    it = step(frame, 3, size, LAO_NO_INDEX);
    it->depth.instance = DEPTH;
    reads(it, 1, LINEAR_DEPTH, 0, 0);
    reads(step(frame, 4, size, TARGET), 1, NOW, 0, 0);
    frame->plan.steps = frame->steps;
    frame->plan.step_count = GL_FRAME_STEPS;
    frame->plan.instances = frame->instances;
    frame->plan.instance_count = GL_FRAME_INSTANCES;
    frame->plan.slots = frame->slots;
    frame->plan.slot_count = GL_FRAME_SLOTS;
    frame->draws[0].chunks = &frame->chunk;
    frame->draws[0].chunk_count = 1;
    frame->execution.plan = &frame->plan;
    frame->execution.draws = frame->draws;
    uniforms(frame);
}

lao_result gl_frame_lines_create(gl_frame *frame, const lao_backend *backend, void *self) {
    /* two segments that cross; the second is farther */
    static const float points[5][4] = {{0, 0, 0, 0},
                                       {-0.8f, -0.5f, 0.25f, 0},
                                       {0.8f, 0.5f, 0.5f, 0},
                                       {-0.6f, 0.5f, 0.75f, 0},
                                       {0, 0, 0, 0}};
    static const uint8_t colors[5][4] = {
        {0}, {255, 0, 0, 255}, {200, 100, 0, 255}, {0, 99, 50, 128}, {0}};
    lao_buffer_desc desc;
    lao_result result;
    desc.format = LAO_FORMAT_RGBA32F;
    desc.texel_count = 5;
    desc.data = points;
    frame->chunk.count = 2;
    result = backend->buffer_create(self, &desc, &frame->chunk.buffers[0]);
    if (result)
        return result;
    desc.format = LAO_FORMAT_RGBA8;
    desc.data = colors;
    return backend->buffer_create(self, &desc, &frame->chunk.buffers[1]);
}

void gl_frame_lines_destroy(gl_frame *frame, const lao_backend *backend, void *self) {
    backend->buffer_destroy(self, frame->chunk.buffers[0]);
    backend->buffer_destroy(self, frame->chunk.buffers[1]);
    frame->chunk.buffers[0] = frame->chunk.buffers[1] = NULL;
}
