/* lineao_gl.c - the OpenGL executor of lineao's frame graphs. MIT licence, see LICENSE.

   Compile it beside the file with LINEAO_IMPLEMENTATION; it needs no GL header and links to no GL
   library. It loops over the steps of a plan and knows no effect.

   CONTRACT
   - Context: core profile, OpenGL 3.3 or later, current in every call. ARB_gpu_shader5 and
     ARB_clip_control are used where present. Nothing of the host's state is remembered.
   - State: lao__gl_state[] lists all that is touched. LAO_GL_RESTORE puts it back, LAO_GL_RESET
     leaves GL's initial values (but puts back the viewport, whose initial value is the window's),
     LAO_GL_DIRTY leaves it as it is. Framebuffers of the host are bound and drawn into; their
     attachments, draw buffers and read buffers stay.
   - Forbidden around a frame: an occlusion query and transform feedback (both are refused), and
     conditional rendering (GL cannot be asked about it; it may drop our draws).
   - Errors that the host left in GL's queue are dropped at entry: they are not ours. */
#include "lineao.h"
#define LINEAO_SHADERS_GLSL
#include "lineao_shaders.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#ifdef _WIN32
#define LAO__GL_CALL __stdcall
#else
#define LAO__GL_CALL
#endif

#ifndef LAO__GL_SKIPPED
/* Tests leave out one row of the state table, to prove that its absence is noticed. */
#define LAO__GL_SKIPPED(row) 0
#endif

/* ---------------------------------------------------------------------------- what we use of GL */

typedef unsigned int lao__gl_enum;
typedef unsigned int lao__gl_uint;
typedef int lao__gl_int;
typedef ptrdiff_t lao__gl_size;
typedef unsigned char lao__gl_bool;

// clang-format off
enum {
    LAO__GL_FRONT = 0x0404, LAO__GL_BACK = 0x0405, LAO__GL_FRONT_AND_BACK = 0x0408, LAO__GL_CCW = 0x0901, LAO__GL_CULL_FACE = 0x0B44, LAO__GL_LESS = 0x0201,
    LAO__GL_GREATER = 0x0204, LAO__GL_ALWAYS = 0x0207, LAO__GL_ONE = 1, LAO__GL_ONE_MINUS_SRC_ALPHA = 0x0303,
    LAO__GL_TRIANGLES = 4, LAO__GL_INVALID_ENUM = 0x0500, LAO__GL_OUT_OF_MEMORY = 0x0505, LAO__GL_CONTEXT_LOST = 0x0507,
    LAO__GL_DEPTH_TEST = 0x0B71,
    LAO__GL_BLEND = 0x0BE2, LAO__GL_MAX_TEXTURE_SIZE = 0x0D33, LAO__GL_MAX_VIEWPORT_DIMS = 0x0D3A,
    LAO__GL_TEXTURE_2D = 0x0DE1, LAO__GL_UNSIGNED_BYTE = 0x1401, LAO__GL_UNSIGNED_SHORT = 0x1403,
    LAO__GL_UNSIGNED_INT = 0x1405, LAO__GL_RED_INTEGER = 0x8D94,
    LAO__GL_FLOAT = 0x1406, LAO__GL_HALF_FLOAT = 0x140B, LAO__GL_COLOR = 0x1800, LAO__GL_DEPTH = 0x1801,
    LAO__GL_DEPTH_COMPONENT = 0x1902, LAO__GL_RED = 0x1903, LAO__GL_RGBA = 0x1908, LAO__GL_FILL = 0x1B02,
    LAO__GL_RENDERER = 0x1F01, LAO__GL_VERSION = 0x1F02, LAO__GL_EXTENSIONS = 0x1F03, LAO__GL_NEAREST = 0x2600,
    LAO__GL_TEXTURE_MAG_FILTER = 0x2800, LAO__GL_TEXTURE_MIN_FILTER = 0x2801, LAO__GL_TEXTURE_WRAP_S = 0x2802,
    LAO__GL_TEXTURE_WRAP_T = 0x2803, LAO__GL_FUNC_ADD = 0x8006, LAO__GL_BLEND_EQUATION_RGB = 0x8009,
    LAO__GL_RGBA8 = 0x8058, LAO__GL_BLEND_DST_RGB = 0x80C8, LAO__GL_BLEND_SRC_RGB = 0x80C9,
    LAO__GL_BLEND_DST_ALPHA = 0x80CA, LAO__GL_BLEND_SRC_ALPHA = 0x80CB, LAO__GL_CLAMP_TO_EDGE = 0x812F,
    LAO__GL_TEXTURE_MAX_LEVEL = 0x813D, LAO__GL_MAJOR_VERSION = 0x821B, LAO__GL_MINOR_VERSION = 0x821C,
    LAO__GL_NUM_EXTENSIONS = 0x821D, LAO__GL_R32F = 0x822E, LAO__GL_R32UI = 0x8236,
    LAO__GL_TEXTURE0 = 0x84C0, LAO__GL_RGBA32F = 0x8814,
    LAO__GL_RGBA16F = 0x881A, LAO__GL_BLEND_EQUATION_ALPHA = 0x883D, LAO__GL_CURRENT_QUERY = 0x8865,
    LAO__GL_MAX_TEXTURE_IMAGE_UNITS = 0x8872, LAO__GL_TEXTURE_COMPARE_MODE = 0x884C, LAO__GL_ARRAY_BUFFER = 0x8892,
    LAO__GL_ELEMENT_ARRAY_BUFFER = 0x8893, LAO__GL_STREAM_DRAW = 0x88E0, LAO__GL_STATIC_DRAW = 0x88E4,
    LAO__GL_SAMPLES_PASSED = 0x8914, LAO__GL_FIXED_ONLY = 0x891D, LAO__GL_UNIFORM_BUFFER = 0x8A11,
    LAO__GL_UNIFORM_BUFFER_BINDING = 0x8A28, LAO__GL_UNIFORM_BUFFER_START = 0x8A29,
    LAO__GL_UNIFORM_BUFFER_SIZE = 0x8A2A, LAO__GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT = 0x8A34,
    LAO__GL_FRAGMENT_SHADER = 0x8B30, LAO__GL_VERTEX_SHADER = 0x8B31,
    LAO__GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS = 0x8B4D, LAO__GL_COMPILE_STATUS = 0x8B81, LAO__GL_LINK_STATUS = 0x8B82,
    LAO__GL_TEXTURE_BUFFER = 0x8C2A, LAO__GL_MAX_TEXTURE_BUFFER_SIZE = 0x8C2B, LAO__GL_ANY_SAMPLES_PASSED = 0x8C2F,
    LAO__GL_LOWER_LEFT = 0x8CA1, LAO__GL_READ_FRAMEBUFFER = 0x8CA8, LAO__GL_DRAW_FRAMEBUFFER = 0x8CA9,
    LAO__GL_DEPTH_COMPONENT32F = 0x8CAC, LAO__GL_FRAMEBUFFER_COMPLETE = 0x8CD5, LAO__GL_COLOR_ATTACHMENT0 = 0x8CE0,
    LAO__GL_DEPTH_ATTACHMENT = 0x8D00, LAO__GL_RENDERBUFFER = 0x8D41, LAO__GL_FRAMEBUFFER_SRGB = 0x8DB9,
    LAO__GL_TRANSFORM_FEEDBACK_PAUSED = 0x8E23, LAO__GL_TRANSFORM_FEEDBACK_ACTIVE = 0x8E24,
    LAO__GL_FIRST_VERTEX_CONVENTION = 0x8E4D, LAO__GL_LAST_VERTEX_CONVENTION = 0x8E4E,
    LAO__GL_NEGATIVE_ONE_TO_ONE = 0x935E, LAO__GL_ZERO_TO_ONE = 0x935F, LAO__GL_NO_BLOCK = -1 /* GL_INVALID_INDEX, as int */
};
// clang-format on

/* What a context may have beyond 3.3: a version or an extension. */
enum {
    LAO__GL_GPU_SHADER5 = 1,
    LAO__GL_CLIP_CONTROL = 2,
    LAO__GL_VIEWPORT_ARRAY = 4,
    LAO__GL_BLEND_BUFFERS = 8,
    LAO__GL_FIXED_RESTART = 16,
    LAO__GL_PAUSED_FEEDBACK = 32,
    LAO__GL_RESET_STATUS = 64
};
typedef struct lao__gl_feature {
    uint32_t bit;
    int version;                    /* major * 10 + minor */
    const char *extension, *suffix; /* the suffix of its functions where the version is lower */
} lao__gl_feature;
static const lao__gl_feature lao__gl_features[] = {
    {LAO__GL_GPU_SHADER5, 40, "GL_ARB_gpu_shader5", ""},
    {LAO__GL_CLIP_CONTROL, 45, "GL_ARB_clip_control", ""},
    {LAO__GL_VIEWPORT_ARRAY, 41, "GL_ARB_viewport_array", ""},
    {LAO__GL_BLEND_BUFFERS, 40, "GL_ARB_draw_buffers_blend", "ARB"},
    {LAO__GL_FIXED_RESTART, 43, "GL_ARB_ES3_compatibility", ""},
    {LAO__GL_PAUSED_FEEDBACK, 40, "GL_ARB_transform_feedback2", ""},
    {LAO__GL_RESET_STATUS, 45, "GL_KHR_robustness", ""},
    {LAO__GL_RESET_STATUS, 45, "GL_ARB_robustness", "ARB"},
};

/* X(need, result, name, arguments): every function that we call. need 0: required; else the feature
 * it comes with. */
// clang-format off
#define LAO__GL_FUNCTIONS(X)                                                                                            \
    X(0, void, ActiveTexture, (lao__gl_enum unit))                                                                      \
    X(0, void, AttachShader, (lao__gl_uint program, lao__gl_uint shader))                                               \
    X(0, void, BindBuffer, (lao__gl_enum target, lao__gl_uint buffer))                                                  \
    X(0, void, BindBufferBase, (lao__gl_enum target, lao__gl_uint index, lao__gl_uint buffer))                          \
    X(0, void, BindBufferRange, (lao__gl_enum target, lao__gl_uint index, lao__gl_uint buffer, lao__gl_size offset,     \
                                 lao__gl_size size))                                                                    \
    X(0, void, BindFramebuffer, (lao__gl_enum target, lao__gl_uint framebuffer))                                        \
    X(0, void, BindSampler, (lao__gl_uint unit, lao__gl_uint sampler))                                                  \
    X(0, void, BindTexture, (lao__gl_enum target, lao__gl_uint texture))                                                \
    X(0, void, BindVertexArray, (lao__gl_uint array))                                                                   \
    X(0, void, BlendEquationSeparate, (lao__gl_enum rgb, lao__gl_enum alpha))                                           \
    X(0, void, BlendFuncSeparate, (lao__gl_enum source_rgb, lao__gl_enum target_rgb, lao__gl_enum source_alpha,         \
                                   lao__gl_enum target_alpha))                                                          \
    X(0, void, BufferData, (lao__gl_enum target, lao__gl_size size, const void *data, lao__gl_enum usage))              \
    X(0, lao__gl_enum, CheckFramebufferStatus, (lao__gl_enum target))                                                   \
    X(0, void, ClampColor, (lao__gl_enum target, lao__gl_enum clamp))                                                   \
    X(0, void, ClearBufferfv, (lao__gl_enum buffer, lao__gl_int index, const float *value))                             \
    X(0, void, ClearBufferuiv, (lao__gl_enum buffer, lao__gl_int index, const lao__gl_uint *value))                     \
    X(0, void, ColorMaski, (lao__gl_uint buffer, lao__gl_bool r, lao__gl_bool g, lao__gl_bool b, lao__gl_bool a))       \
    X(0, void, CompileShader, (lao__gl_uint shader))                                                                    \
    X(0, lao__gl_uint, CreateProgram, (void))                                                                           \
    X(0, lao__gl_uint, CreateShader, (lao__gl_enum type))                                                               \
    X(0, void, DeleteBuffers, (lao__gl_int count, const lao__gl_uint *names))                                           \
    X(0, void, DeleteFramebuffers, (lao__gl_int count, const lao__gl_uint *names))                                      \
    X(0, void, DeleteProgram, (lao__gl_uint program))                                                                   \
    X(0, void, DeleteSamplers, (lao__gl_int count, const lao__gl_uint *names))                                          \
    X(0, void, DeleteShader, (lao__gl_uint shader))                                                                     \
    X(0, void, DeleteTextures, (lao__gl_int count, const lao__gl_uint *names))                                          \
    X(0, void, DeleteVertexArrays, (lao__gl_int count, const lao__gl_uint *names))                                      \
    X(0, void, DepthFunc, (lao__gl_enum function))                                                                      \
    X(0, void, CullFace, (lao__gl_enum face))                                                                           \
    X(0, void, FrontFace, (lao__gl_enum winding))                                                                       \
    X(0, void, DepthMask, (lao__gl_bool on))                                                                            \
    X(0, void, DepthRange, (double near_value, double far_value))                                                       \
    X(0, void, Disable, (lao__gl_enum what))                                                                            \
    X(0, void, Disablei, (lao__gl_enum what, lao__gl_uint index))                                                       \
    X(0, void, DrawArrays, (lao__gl_enum mode, lao__gl_int first, lao__gl_int count))                                   \
    X(0, void, DrawBuffers, (lao__gl_int count, const lao__gl_enum *buffers))                                           \
    X(0, void, DrawElementsBaseVertex, (lao__gl_enum mode, lao__gl_int count, lao__gl_enum type, const void *indices,   \
                                        lao__gl_int base))                                                              \
    X(0, void, Enable, (lao__gl_enum what))                                                                             \
    X(0, void, Enablei, (lao__gl_enum what, lao__gl_uint index))                                                        \
    X(0, void, Finish, (void))                                                                                          \
    X(0, void, FramebufferRenderbuffer, (lao__gl_enum target, lao__gl_enum point, lao__gl_enum kind,                    \
                                         lao__gl_uint renderbuffer))                                                    \
    X(0, void, FramebufferTexture2D, (lao__gl_enum target, lao__gl_enum point, lao__gl_enum kind, lao__gl_uint texture, \
                                      lao__gl_int level))                                                               \
    X(0, void, GenBuffers, (lao__gl_int count, lao__gl_uint *names))                                                    \
    X(0, void, GenFramebuffers, (lao__gl_int count, lao__gl_uint *names))                                               \
    X(0, void, GenSamplers, (lao__gl_int count, lao__gl_uint *names))                                                   \
    X(0, void, GenTextures, (lao__gl_int count, lao__gl_uint *names))                                                   \
    X(0, void, GenVertexArrays, (lao__gl_int count, lao__gl_uint *names))                                               \
    X(0, void, GetDoublev, (lao__gl_enum what, double *values))                                                         \
    X(0, lao__gl_enum, GetError, (void))                                                                                \
    X(0, void, GetInteger64i_v, (lao__gl_enum what, lao__gl_uint index, int64_t *values))                               \
    X(0, void, GetIntegeri_v, (lao__gl_enum what, lao__gl_uint index, lao__gl_int *values))                             \
    X(0, void, GetIntegerv, (lao__gl_enum what, lao__gl_int *values))                                                   \
    X(0, void, GetProgramInfoLog, (lao__gl_uint program, lao__gl_int capacity, lao__gl_int *length, char *text))        \
    X(0, void, GetProgramiv, (lao__gl_uint program, lao__gl_enum what, lao__gl_int *values))                            \
    X(0, void, GetQueryiv, (lao__gl_enum target, lao__gl_enum what, lao__gl_int *values))                               \
    X(0, void, GetShaderInfoLog, (lao__gl_uint shader, lao__gl_int capacity, lao__gl_int *length, char *text))          \
    X(0, void, GetShaderiv, (lao__gl_uint shader, lao__gl_enum what, lao__gl_int *values))                              \
    X(0, const lao__gl_bool *, GetString, (lao__gl_enum what))                                                          \
    X(0, const lao__gl_bool *, GetStringi, (lao__gl_enum what, lao__gl_uint index))                                     \
    X(0, lao__gl_uint, GetUniformBlockIndex, (lao__gl_uint program, const char *name))                                  \
    X(0, lao__gl_int, GetUniformLocation, (lao__gl_uint program, const char *name))                                     \
    X(0, lao__gl_bool, IsEnabled, (lao__gl_enum what))                                                                  \
    X(0, lao__gl_bool, IsEnabledi, (lao__gl_enum what, lao__gl_uint index))                                             \
    X(0, lao__gl_bool, IsProgram, (lao__gl_uint program))                                                               \
    X(0, void, LinkProgram, (lao__gl_uint program))                                                                     \
    X(0, void, PixelStorei, (lao__gl_enum what, lao__gl_int value))                                                     \
    X(0, void, PolygonMode, (lao__gl_enum face, lao__gl_enum mode))                                                     \
    X(0, void, ProvokingVertex, (lao__gl_enum mode))                                                                    \
    X(0, void, ReadBuffer, (lao__gl_enum buffer))                                                                       \
    X(0, void, ReadPixels, (lao__gl_int x, lao__gl_int y, lao__gl_int width, lao__gl_int height, lao__gl_enum format,   \
                            lao__gl_enum type, void *data))                                                             \
    X(0, void, SamplerParameteri, (lao__gl_uint sampler, lao__gl_enum what, lao__gl_int value))                         \
    X(0, void, ShaderSource, (lao__gl_uint shader, lao__gl_int count, const char *const *lines,                         \
                              const lao__gl_int *lengths))                                                              \
    X(0, void, TexBuffer, (lao__gl_enum target, lao__gl_enum format, lao__gl_uint buffer))                              \
    X(0, void, TexImage2D, (lao__gl_enum target, lao__gl_int level, lao__gl_int internal_format, lao__gl_int width,     \
                            lao__gl_int height, lao__gl_int border, lao__gl_enum format, lao__gl_enum type,             \
                            const void *data))                                                                          \
    X(0, void, TexParameteri, (lao__gl_enum target, lao__gl_enum what, lao__gl_int value))                              \
    X(0, void, Uniform1i, (lao__gl_int location, lao__gl_int value))                                                    \
    X(0, void, UniformBlockBinding, (lao__gl_uint program, lao__gl_uint block, lao__gl_uint binding))                   \
    X(0, void, UseProgram, (lao__gl_uint program))                                                                      \
    X(0, void, Viewport, (lao__gl_int x, lao__gl_int y, lao__gl_int width, lao__gl_int height))                         \
    X(LAO__GL_BLEND_BUFFERS, void, BlendEquationSeparatei, (lao__gl_uint buffer, lao__gl_enum rgb, lao__gl_enum alpha)) \
    X(LAO__GL_BLEND_BUFFERS, void, BlendFuncSeparatei, (lao__gl_uint buffer, lao__gl_enum source_rgb,                   \
                              lao__gl_enum target_rgb, lao__gl_enum source_alpha, lao__gl_enum target_alpha))           \
    X(LAO__GL_CLIP_CONTROL, void, ClipControl, (lao__gl_enum origin, lao__gl_enum depth))                               \
    X(LAO__GL_VIEWPORT_ARRAY, void, DepthRangeIndexed, (lao__gl_uint index, double near_value, double far_value))       \
    X(LAO__GL_VIEWPORT_ARRAY, void, GetDoublei_v, (lao__gl_enum what, lao__gl_uint index, double *values))              \
    X(LAO__GL_VIEWPORT_ARRAY, void, ViewportIndexedf, (lao__gl_uint index, float x, float y, float width, float height))\
    X(LAO__GL_RESET_STATUS, lao__gl_enum, GetGraphicsResetStatus, (void))
// clang-format on

/* -------------------------------------------------------------------------------------- objects */

/* A program with constants baked in. Views share programs; the last one to let go deletes. */
typedef struct lao__gl_program {
    const lao_shader *shader;
    int32_t constants[LAO_MAX_CONSTANTS];
    lao__gl_uint name;
    uint32_t users;
    struct lao__gl_program *next;
} lao__gl_program;

typedef struct lao__gl_buffer {
    lao__gl_uint buffer, texture;
} lao__gl_buffer;

typedef struct lao__gl_step {
    lao__gl_program *program;
    lao__gl_uint framebuffers[2]; /* per parity; equal where no history image is written */
    double milliseconds;
} lao__gl_step;

typedef struct lao__gl_view {
    lao__gl_uint *textures; /* per slot */
    uint32_t texture_count;
    lao__gl_step *steps;
    uint32_t step_count;
    uint32_t unit_count; /* texture units that any step reads */
    uint32_t timed;      /* the last frame was measured */
} lao__gl_view;

/* The backend's own state. Functions first, so that calls read gl->BindTexture(...). */
typedef struct lao__gl {
#define LAO__GL_MEMBER(need, result, name, arguments) result(LAO__GL_CALL *name) arguments;
    LAO__GL_FUNCTIONS(LAO__GL_MEMBER)
#undef LAO__GL_MEMBER
    lao_gl_desc desc;
    const lao_host *host;
    uint32_t features;
    int software;                 /* Mesa's processor that draws: lao__gl_draw_segments */
    const lao_shader *fullscreen; /* the vertex stage of shaders that have none */
    lao__gl_uint vertex_array, quads, uniforms, sampler, reader;
    size_t alignment; /* of offsets into `uniforms` */
    lao__gl_program *programs;
    uint8_t *staging; /* the uniforms of one frame */
    size_t staging_size;
    uint32_t entry;      /* the entry point under way */
    uint32_t unit_count; /* texture units that it touches */
    double (*saved)[4];  /* the host's values of lao__gl_state */
    size_t size;         /* of this struct with `saved` behind it */
} lao__gl;

typedef struct lao__gl_function {
    const char *name;
    size_t offset;
    uint32_t need;
} lao__gl_function;
static const lao__gl_function lao__gl_functions[] = {
#define LAO__GL_ROW(need, result, name, arguments) {"gl" #name, offsetof(lao__gl, name), need},
    LAO__GL_FUNCTIONS(LAO__GL_ROW)
#undef LAO__GL_ROW
};

typedef struct lao__gl_format {
    lao__gl_int internal;
    lao__gl_enum format, type;
    uint32_t bytes;
} lao__gl_format;
static const lao__gl_format lao__gl_formats[LAO_FORMAT_COUNT] = {
    {0, 0, 0, 0}, /* LAO_FORMAT_NONE */
    {LAO__GL_RGBA8, LAO__GL_RGBA, LAO__GL_UNSIGNED_BYTE, 4},
    {LAO__GL_RGBA16F, LAO__GL_RGBA, LAO__GL_HALF_FLOAT, 8},
    {LAO__GL_RGBA32F, LAO__GL_RGBA, LAO__GL_FLOAT, 16},
    {LAO__GL_R32F, LAO__GL_RED, LAO__GL_FLOAT, 4},
    {LAO__GL_R32UI, LAO__GL_RED_INTEGER, LAO__GL_UNSIGNED_INT, 4},
    {LAO__GL_DEPTH_COMPONENT32F, LAO__GL_DEPTH_COMPONENT, LAO__GL_FLOAT, 4},
    {0, 0, 0, 0}, /* LAO_FORMAT_HOST */
};

enum { LAO__GL_BLOCK_FRAME, LAO__GL_BLOCK_SETTINGS, LAO__GL_BLOCK_STEP, LAO__GL_BLOCK_COUNT };
static const char *const lao__gl_blocks[LAO__GL_BLOCK_COUNT] = {
    "lao_frame_block", "lao_settings_block", "lao_step_block"};

#define LAO__GL_QUADS 16384u /* 65536 vertices: as many as 16-bit indices reach */
#define LAO__GL_PIECES 4u    /* of LAO__GL_QUADS, before a processor catches up */
#define LAO__GL_BUFFERS 8    /* draw buffers that every context has */
#define LAO__GL_DRAIN 64     /* a lost context may report errors for ever */

/* -------------------------------------------------------------------------- memory and failures */

static void *lao__gl_allocate(const lao__gl *gl, size_t size) {
    const lao_allocator *allocator = &gl->host->allocator;
    void *memory = allocator->allocate(allocator->user, size);
    if (memory)
        memset(memory, 0, size);
    return memory;
}

static void lao__gl_release(const lao__gl *gl, void *memory, size_t size) {
    const lao_allocator *allocator = &gl->host->allocator;
    if (memory)
        allocator->release(allocator->user, memory, size);
}

/* Logs the one item of a failure and returns its result. */
static lao_result lao__gl_fail(const lao_host *host, lao_log_item item, const char *format, ...) {
    static const lao_result results[] = {
#define LAO__GL_RESULT(id, result, text) result,
        LAO_LOG_ITEMS(LAO__GL_RESULT)
#undef LAO__GL_RESULT
    };
    char text[1536];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    host->report(host->context, item, text);
    return results[item];
}

static void lao__gl_drain(const lao__gl *gl) {
    int i;
    for (i = 0; i < LAO__GL_DRAIN && gl->GetError(); i++)
        ;
}

/* Turns the first error in GL's queue into a failure. */
static lao_result lao__gl_check(const lao__gl *gl, const char *what, const char *name) {
    static const char *const names[] = {"invalid enum",
                                        "invalid value",
                                        "invalid operation",
                                        "stack overflow",
                                        "stack underflow",
                                        "out of memory",
                                        "invalid framebuffer operation",
                                        "context lost"};
    lao__gl_enum error = gl->GetError();
    int lost = error == LAO__GL_CONTEXT_LOST ||
               (gl->GetGraphicsResetStatus && gl->GetGraphicsResetStatus());
    const char *text = error >= LAO__GL_INVALID_ENUM && error <= LAO__GL_CONTEXT_LOST
                           ? names[error - LAO__GL_INVALID_ENUM]
                           : "an error";
    if (!error && !lost)
        return LAO_OK;
    lao__gl_drain(gl);
    if (lost)
        return lao__gl_fail(gl->host, LAO_LOG_DEVICE_LOST, "%s%s", what, name);
    return lao__gl_fail(
        gl->host, error == LAO__GL_OUT_OF_MEMORY ? LAO_LOG_DEVICE_MEMORY : LAO_LOG_BACKEND_CALL,
        "%s%s: GL reports %s (0x%04x)", what, name, text, error);
}

/* ---------------------------------------------------------------------------------------- state */

/* All that we touch, one row each. Saving goes down the table and restoring goes up. So the active
   texture, by which units are reached, is saved first and restored last; and the general uniform
   binding, which indexed bindings change as well, is restored after those. */

typedef enum lao__gl_kind {
    LAO__GL_IS_TOGGLE,      /* Enable(query + index) */
    LAO__GL_IS_BLEND,       /* Enablei(query, index) */
    LAO__GL_IS_SCISSOR,     /* of viewport 0 */
    LAO__GL_IS_VIEWPORT,    /* of viewport 0 */
    LAO__GL_IS_DEPTH_RANGE, /* of viewport 0 */
    LAO__GL_IS_BLEND_FUNC,  /* per draw buffer where GL can */
    LAO__GL_IS_BLEND_EQUATION,
    LAO__GL_IS_COLOR_MASK,
    LAO__GL_IS_ACTIVE_TEXTURE,
    LAO__GL_IS_TEXTURE, /* of `target`, per unit */
    LAO__GL_IS_SAMPLER, /* per unit */
    LAO__GL_IS_VERTEX_ARRAY,
    LAO__GL_IS_BUFFER,
    LAO__GL_IS_UNIFORM_RANGE,
    LAO__GL_IS_PROGRAM,
    LAO__GL_IS_FRAMEBUFFER,
    LAO__GL_IS_DEPTH_MASK,
    LAO__GL_IS_DEPTH_FUNC,
    LAO__GL_IS_CULL_MODE,
    LAO__GL_IS_FRONT_FACE,
    LAO__GL_IS_POLYGON_MODE,
    LAO__GL_IS_PROVOKING,
    LAO__GL_IS_CLIP_CONTROL,
    LAO__GL_IS_PIXEL_STORE,
    LAO__GL_IS_CLAMP
} lao__gl_kind;

enum { /* entry points: who touches a row */
       LAO__GL_ATTACH = 1,
       LAO__GL_BUFFER = 2,
       LAO__GL_PREPARE = 4,
       LAO__GL_DRAW = 8,
       LAO__GL_READ = 16
};
enum {                /* what happens to a row when an entry point begins */
       LAO__GL_LATER, /* the code below sets it */
       LAO__GL_FIXED, /* gets `ours` */
       LAO__GL_WINDOW /* LATER, and has no initial value: RESET puts the host's back */
};

typedef struct lao__gl_row {
    const char *name;
    lao__gl_kind kind;
    lao__gl_enum query, target;
    uint32_t count; /* indices */
    uint32_t need;  /* feature */
    uint32_t entries;
    double initial[4];
    uint32_t begin;
    double ours[2];
} lao__gl_row;

// clang-format off
static const lao__gl_row lao__gl_state[] = {
    /* name                 kind                        query   target  count            need  entries                      initial                     begin           ours */
    {"active texture",      LAO__GL_IS_ACTIVE_TEXTURE,  0x84E0, 0,      1,               0, LAO__GL_BUFFER | LAO__GL_PREPARE | LAO__GL_DRAW, {LAO__GL_TEXTURE0}, LAO__GL_LATER, {0}},
    {"2D textures",         LAO__GL_IS_TEXTURE,         0x8069, 0x0DE1, LAO_MAX_READS,   0, LAO__GL_PREPARE | LAO__GL_DRAW, {0},                      LAO__GL_LATER,  {0}},
    {"buffer textures",     LAO__GL_IS_TEXTURE,         0x8C2C, 0x8C2A, LAO_MAX_READS,   0, LAO__GL_BUFFER | LAO__GL_DRAW,  {0},                      LAO__GL_LATER,  {0}},
    {"samplers",            LAO__GL_IS_SAMPLER,         0x8919, 0,      LAO_MAX_READS,   0, LAO__GL_DRAW,                {0},                         LAO__GL_LATER,  {0}},
    {"vertex array",        LAO__GL_IS_VERTEX_ARRAY,    0x85B5, 0,      1,               0, LAO__GL_ATTACH | LAO__GL_DRAW, {0},                       LAO__GL_LATER,  {0}},
    {"array buffer",        LAO__GL_IS_BUFFER,          0x8894, 0x8892, 1,               0, LAO__GL_BUFFER,              {0},                         LAO__GL_LATER,  {0}},
    {"unpack buffer",       LAO__GL_IS_BUFFER,          0x88EF, 0x88EC, 1,               0, LAO__GL_PREPARE,             {0},                         LAO__GL_FIXED,  {0}},
    {"pack buffer",         LAO__GL_IS_BUFFER,          0x88ED, 0x88EB, 1,               0, LAO__GL_READ,                {0},                         LAO__GL_FIXED,  {0}},
    {"uniform buffer",      LAO__GL_IS_BUFFER,          0x8A28, 0x8A11, 1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_LATER,  {0}},
    {"uniform ranges",      LAO__GL_IS_UNIFORM_RANGE,   0x8A28, 0x8A11, LAO__GL_BLOCK_COUNT, 0, LAO__GL_DRAW,            {0},                         LAO__GL_LATER,  {0}},
    {"program",             LAO__GL_IS_PROGRAM,         0x8B8D, 0,      1,               0, LAO__GL_PREPARE | LAO__GL_DRAW, {0},                      LAO__GL_LATER,  {0}},
    {"draw framebuffer",    LAO__GL_IS_FRAMEBUFFER,     0x8CA6, 0x8CA9, 1,               0, LAO__GL_PREPARE | LAO__GL_DRAW, {0},                      LAO__GL_LATER,  {0}},
    {"read framebuffer",    LAO__GL_IS_FRAMEBUFFER,     0x8CAA, 0x8CA8, 1,               0, LAO__GL_READ,                {0},                         LAO__GL_LATER,  {0}},
    {"viewport",            LAO__GL_IS_VIEWPORT,        0x0BA2, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_WINDOW, {0}},
    {"depth range",         LAO__GL_IS_DEPTH_RANGE,     0x0B70, 0,      1,               0, LAO__GL_DRAW,                {0, 1},                      LAO__GL_FIXED,  {0, 1}},
    {"scissor test",        LAO__GL_IS_SCISSOR,         0x0C11, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"blend",               LAO__GL_IS_BLEND,           0x0BE2, 0,      LAO__GL_BUFFERS, 0, LAO__GL_DRAW,                {0},                         LAO__GL_LATER,  {0}},
    {"blend function",      LAO__GL_IS_BLEND_FUNC,      0,      0,      LAO__GL_BUFFERS, 0, LAO__GL_DRAW,                {1, 0, 1, 0},                LAO__GL_LATER,  {0}},
    {"blend equation",      LAO__GL_IS_BLEND_EQUATION,  0,      0,      LAO__GL_BUFFERS, 0, LAO__GL_DRAW, {LAO__GL_FUNC_ADD, LAO__GL_FUNC_ADD},       LAO__GL_FIXED,  {LAO__GL_FUNC_ADD, LAO__GL_FUNC_ADD}},
    {"color mask",          LAO__GL_IS_COLOR_MASK,      0x0C23, 0,      LAO__GL_BUFFERS, 0, LAO__GL_DRAW,                {1, 1, 1, 1},                LAO__GL_LATER,  {0}},
    {"depth test",          LAO__GL_IS_TOGGLE,          0x0B71, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_LATER,  {0}},
    {"depth mask",          LAO__GL_IS_DEPTH_MASK,      0x0B72, 0,      1,               0, LAO__GL_DRAW,                {1},                         LAO__GL_FIXED,  {1}},
    {"depth function",      LAO__GL_IS_DEPTH_FUNC,      0x0B74, 0,      1,               0, LAO__GL_DRAW,                {LAO__GL_LESS},              LAO__GL_LATER,  {0}},
    {"stencil test",        LAO__GL_IS_TOGGLE,          0x0B90, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"cull face",           LAO__GL_IS_TOGGLE,          0x0B44, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_LATER,  {0}},
    {"cull face mode",      LAO__GL_IS_CULL_MODE,       0x0B45, 0,      1,               0, LAO__GL_DRAW,                {LAO__GL_BACK},              LAO__GL_LATER,  {0}},
    {"front face",          LAO__GL_IS_FRONT_FACE,      0x0B46, 0,      1,               0, LAO__GL_DRAW,                {LAO__GL_CCW},               LAO__GL_FIXED,  {LAO__GL_CCW}},
    {"polygon mode",        LAO__GL_IS_POLYGON_MODE,    0x0B40, 0,      1,               0, LAO__GL_DRAW,                {LAO__GL_FILL, LAO__GL_FILL}, LAO__GL_FIXED, {LAO__GL_FILL, LAO__GL_FILL}},
    {"polygon offset",      LAO__GL_IS_TOGGLE,          0x8037, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"polygon smooth",      LAO__GL_IS_TOGGLE,          0x0B41, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"primitive restart",   LAO__GL_IS_TOGGLE,          0x8F9D, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"fixed restart",       LAO__GL_IS_TOGGLE,          0x8D69, 0,      1, LAO__GL_FIXED_RESTART, LAO__GL_DRAW,          {0},                         LAO__GL_FIXED,  {0}},
    {"rasterizer discard",  LAO__GL_IS_TOGGLE,          0x8C89, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"multisample",         LAO__GL_IS_TOGGLE,          0x809D, 0,      1,               0, LAO__GL_DRAW,                {1},                         LAO__GL_FIXED,  {1}},
    {"alpha to coverage",   LAO__GL_IS_TOGGLE,          0x809E, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"alpha to one",        LAO__GL_IS_TOGGLE,          0x809F, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"sample coverage",     LAO__GL_IS_TOGGLE,          0x80A0, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"sample mask",         LAO__GL_IS_TOGGLE,          0x8E51, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"framebuffer sRGB",    LAO__GL_IS_TOGGLE,          0x8DB9, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_LATER,  {0}},
    {"clip distances",      LAO__GL_IS_TOGGLE,          0x3000, 0,      8,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"color logic op",      LAO__GL_IS_TOGGLE,          0x0BF2, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"depth clamp",         LAO__GL_IS_TOGGLE,          0x864F, 0,      1,               0, LAO__GL_DRAW,                {0},                         LAO__GL_FIXED,  {0}},
    {"dither",              LAO__GL_IS_TOGGLE,          0x0BD0, 0,      1,               0, LAO__GL_DRAW,                {1},                         LAO__GL_FIXED,  {0}},
    {"provoking vertex",    LAO__GL_IS_PROVOKING,       0x8E4F, 0,      1,               0, LAO__GL_DRAW, {LAO__GL_LAST_VERTEX_CONVENTION},          LAO__GL_FIXED,  {LAO__GL_FIRST_VERTEX_CONVENTION}},
    {"clip control",        LAO__GL_IS_CLIP_CONTROL,    0x935C, 0x935D, 1, LAO__GL_CLIP_CONTROL, LAO__GL_DRAW, {LAO__GL_LOWER_LEFT, LAO__GL_NEGATIVE_ONE_TO_ONE}, LAO__GL_FIXED, {LAO__GL_LOWER_LEFT, LAO__GL_ZERO_TO_ONE}},
    {"pack swap bytes",     LAO__GL_IS_PIXEL_STORE,     0x0D00, 0,      1,               0, LAO__GL_READ,                {0},                         LAO__GL_FIXED,  {0}},
    {"pack row length",     LAO__GL_IS_PIXEL_STORE,     0x0D02, 0,      1,               0, LAO__GL_READ,                {0},                         LAO__GL_FIXED,  {0}},
    {"pack skip rows",      LAO__GL_IS_PIXEL_STORE,     0x0D03, 0,      1,               0, LAO__GL_READ,                {0},                         LAO__GL_FIXED,  {0}},
    {"pack skip pixels",    LAO__GL_IS_PIXEL_STORE,     0x0D04, 0,      1,               0, LAO__GL_READ,                {0},                         LAO__GL_FIXED,  {0}},
    {"pack alignment",      LAO__GL_IS_PIXEL_STORE,     0x0D05, 0,      1,               0, LAO__GL_READ,                {4},                         LAO__GL_FIXED,  {1}},
    {"clamp read color",    LAO__GL_IS_CLAMP,           0x891C, 0,      1,               0, LAO__GL_READ,                {LAO__GL_FIXED_ONLY},        LAO__GL_FIXED,  {0}},
};
// clang-format on
#define LAO__GL_STATE_COUNT (sizeof lao__gl_state / sizeof lao__gl_state[0])

static void lao__gl_toggle(const lao__gl *gl, lao__gl_enum what, int on) {
    if (on)
        gl->Enable(what);
    else
        gl->Disable(what);
}

static void lao__gl_toggle_indexed(const lao__gl *gl, lao__gl_enum what, uint32_t index, int on) {
    if (on)
        gl->Enablei(what, index);
    else
        gl->Disablei(what, index);
}

/* The calls without an index change all viewports or draw buffers: used only where there is nothing
 * finer. */
static void lao__gl_viewport(const lao__gl *gl, const double v[4]) {
    if (gl->ViewportIndexedf)
        gl->ViewportIndexedf(0, (float)v[0], (float)v[1], (float)v[2], (float)v[3]);
    else
        gl->Viewport((lao__gl_int)v[0], (lao__gl_int)v[1], (lao__gl_int)v[2], (lao__gl_int)v[3]);
}

static void lao__gl_depth_range(const lao__gl *gl, const double v[4]) {
    if (gl->DepthRangeIndexed)
        gl->DepthRangeIndexed(0, v[0], v[1]);
    else
        gl->DepthRange(v[0], v[1]);
}

static void lao__gl_scissor(const lao__gl *gl, lao__gl_enum what, int on) {
    if (gl->ViewportIndexedf)
        lao__gl_toggle_indexed(gl, what, 0, on);
    else
        lao__gl_toggle(gl, what, on);
}

static void lao__gl_uniform_range(const lao__gl *gl, uint32_t index, const double v[4]) {
    lao__gl_uint buffer = (lao__gl_uint)v[0];
    if (buffer && v[2] > 0)
        gl->BindBufferRange(LAO__GL_UNIFORM_BUFFER, index, buffer, (lao__gl_size)v[1],
                            (lao__gl_size)v[2]);
    else
        gl->BindBufferBase(LAO__GL_UNIFORM_BUFFER, index, buffer);
}

/* A program that was deleted while in use went for good with our first UseProgram. */
static void lao__gl_use(const lao__gl *gl, lao__gl_uint program) {
    gl->UseProgram(program && gl->IsProgram(program) ? program : 0);
}

static void lao__gl_blend_func(const lao__gl *gl, uint32_t index, const double v[4]) {
    lao__gl_enum a = (lao__gl_enum)v[0], b = (lao__gl_enum)v[1], c = (lao__gl_enum)v[2],
                 d = (lao__gl_enum)v[3];
    if (gl->BlendFuncSeparatei)
        gl->BlendFuncSeparatei(index, a, b, c, d);
    else if (index == 0)
        gl->BlendFuncSeparate(a, b, c, d);
}

static void lao__gl_blend_equation(const lao__gl *gl, uint32_t index, const double v[4]) {
    if (gl->BlendEquationSeparatei)
        gl->BlendEquationSeparatei(index, (lao__gl_enum)v[0], (lao__gl_enum)v[1]);
    else if (index == 0)
        gl->BlendEquationSeparate((lao__gl_enum)v[0], (lao__gl_enum)v[1]);
}

/* Both faces in core profiles; compatibility profiles have a mode for each. */
static void lao__gl_polygon_mode(const lao__gl *gl, const double v[4]) {
    if (v[1] == 0 || v[1] == v[0]) {
        gl->PolygonMode(LAO__GL_FRONT_AND_BACK, (lao__gl_enum)v[0]);
        return;
    }
    gl->PolygonMode(LAO__GL_FRONT, (lao__gl_enum)v[0]);
    gl->PolygonMode(LAO__GL_BACK, (lao__gl_enum)v[1]);
}

/* GL converts whatever it holds to doubles, which are exact for names, enums, flags and floats. */
static void lao__gl_get_indexed(const lao__gl *gl, const lao__gl_enum *queries, int count,
                                uint32_t index, double v[4]) {
    lao__gl_int value;
    int i;
    for (i = 0; i < count; i++) {
        value = 0;
        gl->GetIntegeri_v(queries[i], index, &value);
        v[i] = value;
    }
}

static void lao__gl_get_blend(const lao__gl *gl, const lao__gl_enum *queries, int count,
                              uint32_t index, double v[4]) {
    int i;
    if (gl->features & LAO__GL_BLEND_BUFFERS)
        lao__gl_get_indexed(gl, queries, count, index, v);
    else
        for (i = 0; i < count; i++)
            gl->GetDoublev(queries[i], &v[i]);
}

static void lao__gl_get_viewport(const lao__gl *gl, lao__gl_enum query, double v[4]) {
    if (gl->GetDoublei_v)
        gl->GetDoublei_v(query, 0, v);
    else
        gl->GetDoublev(query, v);
}

static void lao__gl_get_unit(const lao__gl *gl, lao__gl_enum query, uint32_t unit, double v[4]) {
    gl->ActiveTexture(LAO__GL_TEXTURE0 + unit);
    gl->GetDoublev(query, v);
}

static void lao__gl_get_mask(const lao__gl *gl, lao__gl_enum query, uint32_t index, double v[4]) {
    lao__gl_int mask[4] = {0, 0, 0, 0};
    int i;
    gl->GetIntegeri_v(query, index, mask);
    for (i = 0; i < 4; i++)
        v[i] = mask[i] != 0;
}

static void lao__gl_get_range(const lao__gl *gl, lao__gl_enum query, uint32_t index, double v[4]) {
    int64_t start = 0, size = 0;
    lao__gl_get_indexed(gl, &query, 1, index, v);
    gl->GetInteger64i_v(LAO__GL_UNIFORM_BUFFER_START, index, &start);
    gl->GetInteger64i_v(LAO__GL_UNIFORM_BUFFER_SIZE, index, &size);
    v[1] = (double)start;
    v[2] = (double)size;
}

static void lao__gl_get(const lao__gl *gl, const lao__gl_row *row, uint32_t index, double v[4]) {
    static const lao__gl_enum function[4] = {LAO__GL_BLEND_SRC_RGB, LAO__GL_BLEND_DST_RGB,
                                             LAO__GL_BLEND_SRC_ALPHA, LAO__GL_BLEND_DST_ALPHA};
    static const lao__gl_enum equation[2] = {LAO__GL_BLEND_EQUATION_RGB,
                                             LAO__GL_BLEND_EQUATION_ALPHA};
    memset(v, 0, 4 * sizeof *v);
    // clang-format off
    switch (row->kind) {
    case LAO__GL_IS_TOGGLE:         v[0] = gl->IsEnabled(row->query + index); break;
    case LAO__GL_IS_BLEND:          v[0] = gl->IsEnabledi(row->query, index); break;
    case LAO__GL_IS_SCISSOR:        v[0] = gl->ViewportIndexedf ? gl->IsEnabledi(row->query, 0) : gl->IsEnabled(row->query); break;
    case LAO__GL_IS_VIEWPORT:
    case LAO__GL_IS_DEPTH_RANGE:    lao__gl_get_viewport(gl, row->query, v); break;
    case LAO__GL_IS_BLEND_FUNC:     lao__gl_get_blend(gl, function, 4, index, v); break;
    case LAO__GL_IS_BLEND_EQUATION: lao__gl_get_blend(gl, equation, 2, index, v); break;
    case LAO__GL_IS_COLOR_MASK:     lao__gl_get_mask(gl, row->query, index, v); break;
    case LAO__GL_IS_TEXTURE:
    case LAO__GL_IS_SAMPLER:        lao__gl_get_unit(gl, row->query, index, v); break;
    case LAO__GL_IS_UNIFORM_RANGE:  lao__gl_get_range(gl, row->query, index, v); break;
    case LAO__GL_IS_CLIP_CONTROL:   gl->GetDoublev(row->query, &v[0]); gl->GetDoublev(row->target, &v[1]); break;
    default:                        gl->GetDoublev(row->query, v); break;
    }
    // clang-format on
}

static void lao__gl_put(const lao__gl *gl, const lao__gl_row *row, uint32_t index,
                        const double v[4]) {
    lao__gl_uint value = (lao__gl_uint)v[0];
    // clang-format off
    switch (row->kind) {
    case LAO__GL_IS_TOGGLE:         lao__gl_toggle(gl, row->query + index, v[0] != 0); break;
    case LAO__GL_IS_BLEND:          lao__gl_toggle_indexed(gl, row->query, index, v[0] != 0); break;
    case LAO__GL_IS_SCISSOR:        lao__gl_scissor(gl, row->query, v[0] != 0); break;
    case LAO__GL_IS_VIEWPORT:       lao__gl_viewport(gl, v); break;
    case LAO__GL_IS_DEPTH_RANGE:    lao__gl_depth_range(gl, v); break;
    case LAO__GL_IS_BLEND_FUNC:     lao__gl_blend_func(gl, index, v); break;
    case LAO__GL_IS_BLEND_EQUATION: lao__gl_blend_equation(gl, index, v); break;
    case LAO__GL_IS_COLOR_MASK:     gl->ColorMaski(index, v[0] != 0, v[1] != 0, v[2] != 0, v[3] != 0); break;
    case LAO__GL_IS_ACTIVE_TEXTURE: gl->ActiveTexture(value); break;
    case LAO__GL_IS_TEXTURE:        gl->ActiveTexture(LAO__GL_TEXTURE0 + index); gl->BindTexture(row->target, value); break;
    case LAO__GL_IS_SAMPLER:        gl->BindSampler(index, value); break;
    case LAO__GL_IS_VERTEX_ARRAY:   gl->BindVertexArray(value); break;
    case LAO__GL_IS_BUFFER:         gl->BindBuffer(row->target, value); break;
    case LAO__GL_IS_UNIFORM_RANGE:  lao__gl_uniform_range(gl, index, v); break;
    case LAO__GL_IS_PROGRAM:        lao__gl_use(gl, value); break;
    case LAO__GL_IS_FRAMEBUFFER:    gl->BindFramebuffer(row->target, value); break;
    case LAO__GL_IS_DEPTH_MASK:     gl->DepthMask(v[0] != 0); break;
    case LAO__GL_IS_DEPTH_FUNC:     gl->DepthFunc(value); break;
    case LAO__GL_IS_CULL_MODE:      gl->CullFace(value); break;
    case LAO__GL_IS_FRONT_FACE:     gl->FrontFace(value); break;
    case LAO__GL_IS_POLYGON_MODE:   lao__gl_polygon_mode(gl, v); break;
    case LAO__GL_IS_PROVOKING:      gl->ProvokingVertex(value); break;
    case LAO__GL_IS_CLIP_CONTROL:   gl->ClipControl(value, (lao__gl_enum)v[1]); break;
    case LAO__GL_IS_PIXEL_STORE:    gl->PixelStorei(row->query, (lao__gl_int)v[0]); break;
    case LAO__GL_IS_CLAMP:          gl->ClampColor(row->query, value); break;
    }
    // clang-format on
}

/* Indices of a row that the entry point under way touches. */
static uint32_t lao__gl_touched(const lao__gl *gl, const lao__gl_row *row) {
    if (!(row->entries & gl->entry) || (row->need && !(row->need & gl->features)))
        return 0;
    if (row->kind == LAO__GL_IS_TEXTURE || row->kind == LAO__GL_IS_SAMPLER)
        return gl->unit_count;
    return row->count;
}

static uint32_t lao__gl_state_size(void) {
    uint32_t size = 0, i;
    for (i = 0; i < LAO__GL_STATE_COUNT; i++)
        size += lao__gl_state[i].count;
    return size;
}

/* Every entry point stands between begin and end. */
static void lao__gl_begin(lao__gl *gl, uint32_t entry, uint32_t unit_count) {
    uint32_t at = 0, i, k;
    gl->entry = entry;
    gl->unit_count = unit_count;
    lao__gl_drain(gl);
    for (i = 0; i < LAO__GL_STATE_COUNT; at += lao__gl_state[i++].count) {
        const lao__gl_row *row = &lao__gl_state[i];
        if (gl->desc.state_mode == LAO_GL_RESTORE ||
            (gl->desc.state_mode == LAO_GL_RESET && row->begin == LAO__GL_WINDOW))
            for (k = 0; k < lao__gl_touched(gl, row); k++)
                lao__gl_get(gl, row, k, gl->saved[at + k]);
    }
    for (i = 0; i < LAO__GL_STATE_COUNT; i++) {
        const lao__gl_row *row = &lao__gl_state[i];
        double ours[4] = {0, 0, 0, 0};
        memcpy(ours, row->ours, sizeof row->ours);
        for (k = 0; row->begin == LAO__GL_FIXED && k < lao__gl_touched(gl, row); k++)
            lao__gl_put(gl, row, k, ours);
    }
}

static void lao__gl_end(lao__gl *gl) {
    uint32_t at = lao__gl_state_size(), i, k;
    for (i = LAO__GL_STATE_COUNT; i-- > 0;) {
        const lao__gl_row *row = &lao__gl_state[i];
        int initial = gl->desc.state_mode == LAO_GL_RESET && row->begin != LAO__GL_WINDOW;
        at -= row->count;
        if (gl->desc.state_mode == LAO_GL_DIRTY || LAO__GL_SKIPPED(i))
            continue;
        for (k = 0; k < lao__gl_touched(gl, row); k++)
            lao__gl_put(gl, row, k, initial ? row->initial : gl->saved[at + k]);
    }
}

/* What would break our passes and can be asked for. */
static lao_result lao__gl_refuse(const lao__gl *gl) {
    lao__gl_int samples = 0, any = 0, feedback = 0, paused = 0;
    gl->GetQueryiv(LAO__GL_SAMPLES_PASSED, LAO__GL_CURRENT_QUERY, &samples);
    gl->GetQueryiv(LAO__GL_ANY_SAMPLES_PASSED, LAO__GL_CURRENT_QUERY, &any);
    if (gl->features & LAO__GL_PAUSED_FEEDBACK) {
        gl->GetIntegerv(LAO__GL_TRANSFORM_FEEDBACK_ACTIVE, &feedback);
        gl->GetIntegerv(LAO__GL_TRANSFORM_FEEDBACK_PAUSED, &paused);
    }
    if (samples || any)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_STATE, "an occlusion query is active");
    if (feedback && !paused)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_STATE, "transform feedback is active");
    return LAO_OK;
}

/* ------------------------------------------------------------------------------------- programs */

enum { LAO__GL_LOG_SIZE = 1280, LAO__GL_CONSTANT_SIZE = 96, LAO__GL_HEAD = 5 };

/* The lines of one stage: head, constants, shared text, its own. Returns how many there are. */
static uint32_t lao__gl_stage_text(const lao__gl *gl, const lao_shader *shader,
                                   const lao_shader_stage *stage, lao__gl_enum type,
                                   const int32_t *values, char (*text)[LAO__GL_CONSTANT_SIZE],
                                   const char **lines) {
    uint32_t count = 0, i;
    lines[count++] = "#version 330 core\n";
    if (gl->features & LAO__GL_GPU_SHADER5)
        lines[count++] = "#extension GL_ARB_gpu_shader5 : enable\n#define LAO_PRECISE 1\n";
    lines[count++] = "#define LAO_GLSL 1\n";
    lines[count++] =
        type == LAO__GL_VERTEX_SHADER ? "#define LAO_VERTEX 1\n" : "#define LAO_FRAGMENT 1\n";
    if (!(gl->features & LAO__GL_CLIP_CONTROL))
        lines[count++] = "#define LAO_CLIP_NEGATIVE_ONE 1\n";
    for (i = 0; i < shader->constant_count; i++) {
        snprintf(text[i], LAO__GL_CONSTANT_SIZE, "const int lao_constant_%s = %d;\n",
                 shader->constants[i], (int)values[i]);
        lines[count++] = text[i];
    }
    for (i = 0; i < lao_shader_prologue_count; i++)
        lines[count++] = lao_shader_prologue[i];
    for (i = 0; i < shader->prologue_count; i++)
        lines[count++] = shader->prologue[i];
    for (i = 0; i < stage->line_count; i++)
        lines[count++] = stage->lines[i];
    return count;
}

static lao_result lao__gl_stage_make(const lao__gl *gl, const lao_shader *shader,
                                     const lao_shader_stage *stage, lao__gl_enum type,
                                     const int32_t *values, lao__gl_uint *name) {
    char text[LAO_MAX_CONSTANTS][LAO__GL_CONSTANT_SIZE], log[LAO__GL_LOG_SIZE] = "";
    size_t size = (LAO__GL_HEAD + LAO_MAX_CONSTANTS + lao_shader_prologue_count +
                   shader->prologue_count + stage->line_count) *
                  sizeof(char *);
    const char **lines = (const char **)lao__gl_allocate(gl, size);
    lao__gl_int done = 0;
    uint32_t count;
    if (!lines)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_MEMORY, "text of shader %s", shader->name);
    count = lao__gl_stage_text(gl, shader, stage, type, values, text, lines);
    *name = gl->CreateShader(type);
    gl->ShaderSource(*name, (lao__gl_int)count, lines, NULL);
    gl->CompileShader(*name);
    gl->GetShaderiv(*name, LAO__GL_COMPILE_STATUS, &done);
    lao__gl_release(gl, (void *)lines, size);
    if (done)
        return LAO_OK;
    gl->GetShaderInfoLog(*name, LAO__GL_LOG_SIZE, NULL, log);
    gl->DeleteShader(*name);
    *name = 0;
    return lao__gl_fail(gl->host, LAO_LOG_SHADER_COMPILE, "%s, %s stage: %s", shader->name,
                        type == LAO__GL_VERTEX_SHADER ? "vertex" : "fragment", log);
}

static lao_result lao__gl_link(const lao__gl *gl, const lao_shader *shader, const int32_t *values,
                               lao__gl_uint program) {
    const lao_shader *vertex = shader->vertex.line_count ? shader : gl->fullscreen;
    char log[LAO__GL_LOG_SIZE] = "";
    lao__gl_uint stages[2] = {0, 0};
    lao__gl_int done = 0;
    lao_result result;
    if (!vertex)
        return lao__gl_fail(gl->host, LAO_LOG_GRAPH_BROKEN, "shader %s has no vertex stage",
                            shader->name);
    /* both stages with the same prologue: the linker compares their blocks */
    result =
        lao__gl_stage_make(gl, shader, &vertex->vertex, LAO__GL_VERTEX_SHADER, values, &stages[0]);
    if (!result)
        result = lao__gl_stage_make(gl, shader, &shader->fragment, LAO__GL_FRAGMENT_SHADER, values,
                                    &stages[1]);
    if (!result) {
        gl->AttachShader(program, stages[0]);
        gl->AttachShader(program, stages[1]);
        gl->LinkProgram(program);
        gl->GetProgramiv(program, LAO__GL_LINK_STATUS, &done);
        if (!done) {
            gl->GetProgramInfoLog(program, LAO__GL_LOG_SIZE, NULL, log);
            result = lao__gl_fail(gl->host, LAO_LOG_SHADER_COMPILE, "%s, linking: %s", shader->name,
                                  log);
        }
    }
    gl->DeleteShader(stages[0]); /* 0 is ignored; attached ones go with the program */
    gl->DeleteShader(stages[1]);
    return result;
}

/* GLSL 330 cannot say which block or texture has which number. */
static void lao__gl_bind_names(const lao__gl *gl, const lao_shader *shader, lao__gl_uint program) {
    uint32_t i;
    gl->UseProgram(program);
    for (i = 0; i < LAO__GL_BLOCK_COUNT; i++) {
        lao__gl_uint block = gl->GetUniformBlockIndex(program, lao__gl_blocks[i]);
        if (block != (lao__gl_uint)LAO__GL_NO_BLOCK)
            gl->UniformBlockBinding(program, block, i);
    }
    for (i = 0; i < shader->texture_count; i++) {
        lao__gl_int location = gl->GetUniformLocation(program, shader->texture_names[i]);
        if (location >= 0)
            gl->Uniform1i(location, (lao__gl_int)i);
    }
}

/* Deletes what no step uses, but for the `spare` last used: a plan that comes back, as when a
 * setting is tried or the scene empties for a moment, finds its programs compiled. */
static void lao__gl_programs_trim(lao__gl *gl, uint32_t spare) {
    lao__gl_program **link = &gl->programs;
    while (*link) {
        lao__gl_program *program = *link;
        if (program->users || spare) {
            spare -= program->users ? 0 : 1;
            link = &program->next;
        } else {
            *link = program->next;
            gl->DeleteProgram(program->name);
            lao__gl_release(gl, program, sizeof *program);
        }
    }
}

static lao_result lao__gl_program_make(lao__gl *gl, const lao_shader *shader,
                                       const int32_t *constants, lao__gl_program **made) {
    lao__gl_program *program = (lao__gl_program *)lao__gl_allocate(gl, sizeof *program);
    lao_result result;
    if (!program)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_MEMORY, "program %s", shader->name);
    program->shader = shader;
    memcpy(program->constants, constants, shader->constant_count * sizeof *constants);
    program->name = gl->CreateProgram();
    result = lao__gl_link(gl, shader, constants, program->name);
    if (result) {
        gl->DeleteProgram(program->name);
        lao__gl_release(gl, program, sizeof *program);
        return result;
    }
    lao__gl_bind_names(gl, shader, program->name);
    *made = program;
    return LAO_OK;
}

/* The program of a shader with these constants, made or found; the last used stands first. */
static lao_result lao__gl_program_get(lao__gl *gl, const lao_shader *shader,
                                      const int32_t *constants, lao__gl_program **found) {
    size_t size = shader->constant_count * sizeof *constants;
    lao__gl_program **link = &gl->programs, *program;
    lao_result result = LAO_OK;
    while (*link && ((*link)->shader != shader || memcmp((*link)->constants, constants, size) != 0))
        link = &(*link)->next;
    program = *link;
    if (program)
        *link = program->next;
    else
        result = lao__gl_program_make(gl, shader, constants, &program);
    if (!program)
        return result;
    program->next = gl->programs;
    gl->programs = program;
    program->users++;
    *found = program;
    return LAO_OK;
}

/* ---------------------------------------------------------------------------- attach and detach */

/* Fetches the functions of one need, all or none; returns whether all are there. `missing` collects
   the names of the others. Only what the context promises is asked for: some loaders return a stub
   for any name. */
static int lao__gl_fetch(lao__gl *gl, uint32_t need, const char *suffix, char *missing,
                         size_t size) {
    void *function;
    char name[64];
    size_t i;
    missing[0] = 0;
    for (i = 0; i < sizeof lao__gl_functions / sizeof lao__gl_functions[0]; i++) {
        if (lao__gl_functions[i].need != need)
            continue;
        snprintf(name, sizeof name, "%s%s", lao__gl_functions[i].name, suffix);
        function = gl->desc.get_proc(name, gl->desc.user);
        memcpy((char *)gl + lao__gl_functions[i].offset, &function, sizeof function);
        if (!function)
            snprintf(missing + strlen(missing), size - strlen(missing), " %s", name);
    }
    function = NULL;
    for (i = 0; need && missing[0] && i < sizeof lao__gl_functions / sizeof lao__gl_functions[0];
         i++)
        if (lao__gl_functions[i].need == need)
            memcpy((char *)gl + lao__gl_functions[i].offset, &function, sizeof function);
    return !missing[0];
}

static lao_result lao__gl_version(const lao__gl *gl, int *version) {
    lao__gl_int major = 0, minor = 0;
    const lao__gl_bool *text;
    if (!gl->GetIntegerv || !gl->GetString)
        return LAO_OK; /* they are in the list of missing functions */
    gl->GetIntegerv(LAO__GL_MAJOR_VERSION, &major);
    gl->GetIntegerv(LAO__GL_MINOR_VERSION, &minor);
    *version = major * 10 + minor;
    text = gl->GetString(LAO__GL_VERSION);
    if (!text)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_STATE, "no OpenGL context is current");
    if (*version < 33 || strncmp((const char *)text, "OpenGL ES", 9) == 0)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_FEATURE, "OpenGL 3.3 is needed; this is %s",
                            (const char *)text);
    return LAO_OK;
}

static int lao__gl_has_extension(const lao__gl *gl, const char *name) {
    lao__gl_int count = 0, i;
    gl->GetIntegerv(LAO__GL_NUM_EXTENSIONS, &count);
    for (i = 0; i < count; i++) {
        const lao__gl_bool *found = gl->GetStringi(LAO__GL_EXTENSIONS, (lao__gl_uint)i);
        if (found && strcmp((const char *)found, name) == 0)
            return 1;
    }
    return 0;
}

static lao_result lao__gl_load(lao__gl *gl) {
    char missing[1024];
    const lao__gl_bool *renderer;
    int version = 0, all = lao__gl_fetch(gl, 0, "", missing, sizeof missing);
    lao_result result =
        lao__gl_version(gl, &version); /* first: an old context lacks many functions */
    size_t i;
    if (result)
        return result;
    if (!all)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_FUNCTION, "not found:%s", missing);
    renderer = gl->GetString(LAO__GL_RENDERER);
    gl->software = renderer && strstr((const char *)renderer, "llvmpipe") != NULL;
    for (i = 0; i < sizeof lao__gl_features / sizeof lao__gl_features[0]; i++) {
        const lao__gl_feature *row = &lao__gl_features[i];
        int core = version >= row->version;
        if (!(gl->features & row->bit) && (core || lao__gl_has_extension(gl, row->extension)) &&
            lao__gl_fetch(gl, row->bit, core ? "" : row->suffix, missing, sizeof missing))
            gl->features |= row->bit;
    }
    return LAO_OK;
}

static uint32_t lao__gl_limit(const lao__gl *gl, lao__gl_enum what) {
    lao__gl_int values[2] = {0, 0}; /* MAX_VIEWPORT_DIMS has two */
    gl->GetIntegerv(what, values);
    return values[0] > 0 ? (uint32_t)values[0] : 0;
}

static uint32_t lao__gl_lower(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static void lao__gl_caps(const lao__gl *gl, lao_backend_caps *caps) {
    caps->max_image_size = lao__gl_lower(lao__gl_limit(gl, LAO__GL_MAX_TEXTURE_SIZE),
                                         lao__gl_limit(gl, LAO__GL_MAX_VIEWPORT_DIMS));
    caps->max_texture_units =
        lao__gl_lower(lao__gl_limit(gl, LAO__GL_MAX_TEXTURE_IMAGE_UNITS),
                      lao__gl_limit(gl, LAO__GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS));
    caps->max_buffer_texels = lao__gl_limit(gl, LAO__GL_MAX_TEXTURE_BUFFER_SIZE);
    caps->shaders = lao_shaders;
    caps->shader_count = lao_shader_count;
}

/* The indices of the vertex array: two triangles for every four vertices. */
static lao_result lao__gl_quads_make(lao__gl *gl) {
    static const uint32_t corner[6] = {0, 1, 2, 2, 1, 3};
    size_t size = sizeof(uint16_t) * 6 * LAO__GL_QUADS;
    uint16_t *indices = (uint16_t *)lao__gl_allocate(gl, size);
    uint32_t i;
    if (!indices)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_MEMORY, "indices of quads");
    for (i = 0; i < LAO__GL_QUADS * 6; i++)
        indices[i] = (uint16_t)(i / 6 * 4 + corner[i % 6]);
    lao__gl_begin(gl, LAO__GL_ATTACH, 0);
    gl->GenVertexArrays(1, &gl->vertex_array);
    gl->GenBuffers(1, &gl->quads);
    gl->BindVertexArray(gl->vertex_array);
    gl->BindBuffer(LAO__GL_ELEMENT_ARRAY_BUFFER, gl->quads); /* belongs to the vertex array */
    gl->BufferData(LAO__GL_ELEMENT_ARRAY_BUFFER, (lao__gl_size)size, indices, LAO__GL_STATIC_DRAW);
    gl->BindVertexArray(0);
    lao__gl_end(gl);
    lao__gl_release(gl, indices, size);
    return LAO_OK;
}

static lao_result lao__gl_objects_make(lao__gl *gl) {
    static const lao__gl_int parameters[][2] = {{LAO__GL_TEXTURE_MIN_FILTER, LAO__GL_NEAREST},
                                                {LAO__GL_TEXTURE_MAG_FILTER, LAO__GL_NEAREST},
                                                {LAO__GL_TEXTURE_WRAP_S, LAO__GL_CLAMP_TO_EDGE},
                                                {LAO__GL_TEXTURE_WRAP_T, LAO__GL_CLAMP_TO_EDGE},
                                                {LAO__GL_TEXTURE_COMPARE_MODE, 0}};
    lao_result result = lao__gl_quads_make(gl);
    size_t i;
    if (result)
        return result;
    gl->GenBuffers(1, &gl->uniforms);
    gl->GenFramebuffers(1, &gl->reader);
    gl->GenSamplers(1, &gl->sampler); /* of all units: host textures keep their own parameters */
    for (i = 0; i < sizeof parameters / sizeof parameters[0]; i++)
        gl->SamplerParameteri(gl->sampler, (lao__gl_enum)parameters[i][0], parameters[i][1]);
    gl->alignment = lao__gl_limit(gl, LAO__GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT);
    return lao__gl_check(gl, "attach", "");
}

static const lao_shader *lao__gl_fullscreen(void) {
    uint32_t i;
    for (i = 0; i < lao_shader_count; i++)
        if (strcmp(lao_shaders[i].name, "fullscreen") == 0)
            return &lao_shaders[i];
    return NULL;
}

static void lao__gl_detach(void *self) {
    lao__gl *gl = (lao__gl *)self;
    if (gl->vertex_array) { /* otherwise the functions may be missing */
        gl->DeleteVertexArrays(1, &gl->vertex_array);
        gl->DeleteBuffers(1, &gl->quads);
        gl->DeleteBuffers(1, &gl->uniforms);
        gl->DeleteFramebuffers(1, &gl->reader);
        gl->DeleteSamplers(1, &gl->sampler);
        lao__gl_programs_trim(gl, 0);
    }
    lao__gl_release(gl, gl->staging, gl->staging_size);
    lao__gl_release(gl, gl, gl->size);
}

static lao_result lao__gl_attach(const struct lao_backend *backend, const lao_host *host,
                                 void **self, lao_backend_caps *caps) {
    size_t size = sizeof(lao__gl) + lao__gl_state_size() * sizeof(double[4]);
    lao__gl *gl = (lao__gl *)host->allocator.allocate(host->allocator.user, size);
    lao_result result;
    if (!gl)
        return lao__gl_fail(host, LAO_LOG_BACKEND_MEMORY, "the executor");
    memset(gl, 0, size);
    memcpy(&gl->desc, backend->storage, sizeof gl->desc);
    gl->host = host;
    gl->size = size;
    gl->saved = (double(*)[4])(gl + 1);
    gl->fullscreen = lao__gl_fullscreen();
    result = lao__gl_load(gl);
    if (!result)
        result = lao__gl_objects_make(gl);
    if (result) {
        lao__gl_detach(gl);
        return result;
    }
    lao__gl_caps(gl, caps);
    *self = gl;
    return LAO_OK;
}

/* -------------------------------------------------------------------------------------- buffers */

static void lao__gl_buffer_destroy(void *self, void *buffer) {
    const lao__gl *gl = (const lao__gl *)self;
    lao__gl_buffer *it = (lao__gl_buffer *)buffer;
    if (!it)
        return;
    gl->DeleteTextures(1, &it->texture);
    gl->DeleteBuffers(1, &it->buffer);
    lao__gl_release(gl, it, sizeof *it);
}

static lao_result lao__gl_buffer_create(void *self, const lao_buffer_desc *desc, void **buffer) {
    lao__gl *gl = (lao__gl *)self;
    const lao__gl_format *format = &lao__gl_formats[desc->format];
    lao__gl_buffer *it = (lao__gl_buffer *)lao__gl_allocate(gl, sizeof *it);
    lao_result result;
    if (!it)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_MEMORY, "buffer");
    lao__gl_begin(gl, LAO__GL_BUFFER, 1);
    gl->GenBuffers(1, &it->buffer);
    gl->GenTextures(1, &it->texture);
    gl->BindBuffer(LAO__GL_ARRAY_BUFFER, it->buffer);
    gl->BufferData(LAO__GL_ARRAY_BUFFER,
                   (lao__gl_size)desc->texel_count * (lao__gl_size)format->bytes, desc->data,
                   LAO__GL_STATIC_DRAW);
    gl->ActiveTexture(LAO__GL_TEXTURE0);
    gl->BindTexture(LAO__GL_TEXTURE_BUFFER, it->texture);
    gl->TexBuffer(LAO__GL_TEXTURE_BUFFER, (lao__gl_enum)format->internal, it->buffer);
    lao__gl_end(gl);
    result = lao__gl_check(gl, "buffer", "");
    if (result)
        lao__gl_buffer_destroy(gl, it);
    else
        *buffer = it;
    return result;
}

/* ---------------------------------------------------------------------------------------- views */

/* Never 0, for which an allocator may return NULL. */
static size_t lao__gl_view_size(const lao__gl_view *view) {
    return (view->step_count + (size_t)1) * sizeof(lao__gl_step) +
           view->texture_count * sizeof(lao__gl_uint);
}

static void lao__gl_view_free_images(const lao__gl *gl, lao__gl_view *view) {
    uint32_t i;
    for (i = 0; i < view->step_count; i++) {
        lao__gl_step *step = &view->steps[i];
        gl->DeleteFramebuffers(step->framebuffers[1] == step->framebuffers[0] ? 1 : 2,
                               step->framebuffers);
        step->framebuffers[0] = step->framebuffers[1] = 0;
    }
    if (view->texture_count)
        gl->DeleteTextures((lao__gl_int)view->texture_count, view->textures);
}

static void lao__gl_view_free_programs(lao__gl *gl, lao__gl_view *view) {
    uint32_t i;
    for (i = 0; i < view->step_count; i++) {
        if (view->steps[i].program)
            view->steps[i].program->users--;
    }
    lao__gl_programs_trim(gl, LAO_SPARE_PROGRAMS);
    lao__gl_release(gl, view->steps, lao__gl_view_size(view));
    memset(view, 0, sizeof *view);
}

static lao_result lao__gl_textures_make(const lao__gl *gl, const lao__gl_view *view,
                                        const lao_plan *plan) {
    uint32_t i;
    gl->GenTextures((lao__gl_int)view->texture_count, view->textures);
    gl->ActiveTexture(LAO__GL_TEXTURE0);
    for (i = 0; i < view->texture_count; i++) {
        const lao_plan_slot *slot = &plan->slots[i];
        const lao__gl_format *format = &lao__gl_formats[slot->format];
        gl->BindTexture(LAO__GL_TEXTURE_2D, view->textures[i]);
        gl->TexParameteri(LAO__GL_TEXTURE_2D, LAO__GL_TEXTURE_MAX_LEVEL, 0);
        gl->TexImage2D(LAO__GL_TEXTURE_2D, 0, format->internal, (lao__gl_int)slot->width,
                       (lao__gl_int)slot->height, 0, format->format, format->type, NULL);
    }
    return lao__gl_check(gl, "images of the view", "");
}

/* The texture of one instance; 0 for imports and for what does not exist in this plan. */
static lao__gl_uint lao__gl_texture(const lao__gl_view *view, const lao_plan *plan,
                                    uint32_t instance, uint32_t parity) {
    uint32_t slot;
    if (instance == LAO_NO_INDEX)
        return 0;
    slot = plan->instances[instance].slot[parity];
    return slot == LAO_NO_INDEX ? 0 : view->textures[slot];
}

/* The host's image behind an instance, NULL if it is ours. */
static const lao_image *lao__gl_host_image(const lao_execution *execution, uint32_t instance) {
    uint32_t import =
        instance == LAO_NO_INDEX ? LAO_NO_INDEX : execution->plan->instances[instance].import;
    if (import == LAO_NO_INDEX)
        return NULL;
    return import == LAO_IMPORT_TARGET ? &execution->target : &execution->imports[import].source;
}

/* A step writes its colours and then, as the last of `color_count + 1`, its depth. */
static const lao_plan_write *lao__gl_write(const lao_plan_step *step, uint32_t i) {
    return i < step->color_count ? &step->colors[i] : &step->depth;
}

static lao__gl_enum lao__gl_point(const lao_plan_step *step, uint32_t i) {
    return i < step->color_count ? (lao__gl_enum)LAO__GL_COLOR_ATTACHMENT0 + i
                                 : (lao__gl_enum)LAO__GL_DEPTH_ATTACHMENT;
}

/* Attaches our images of a step to the framebuffer that is bound. Returns how many images the host
 * will have to give. */
static uint32_t lao__gl_attach_images(const lao__gl *gl, const lao__gl_view *view,
                                      const lao_plan *plan, const lao_plan_step *step,
                                      uint32_t parity) {
    lao__gl_enum buffers[LAO_MAX_WRITES];
    uint32_t imports = 0, i;
    for (i = 0; i <= step->color_count; i++) {
        uint32_t instance = lao__gl_write(step, i)->instance;
        lao__gl_uint texture = lao__gl_texture(view, plan, instance, parity);
        if (texture)
            gl->FramebufferTexture2D(LAO__GL_DRAW_FRAMEBUFFER, lao__gl_point(step, i),
                                     LAO__GL_TEXTURE_2D, texture, 0);
        else if (instance != LAO_NO_INDEX)
            imports++;
        if (i < step->color_count)
            buffers[i] = instance == LAO_NO_INDEX ? 0 : lao__gl_point(step, i);
    }
    gl->DrawBuffers((lao__gl_int)step->color_count, buffers);
    return imports;
}

static lao_result lao__gl_complete(const lao__gl *gl, lao_log_item item, const char *pass) {
    lao__gl_enum status = gl->CheckFramebufferStatus(LAO__GL_DRAW_FRAMEBUFFER);
    if (status == LAO__GL_FRAMEBUFFER_COMPLETE)
        return LAO_OK;
    return lao__gl_fail(gl->host, item, "pass %s: the framebuffer is not complete (0x%04x)", pass,
                        status);
}

static int lao__gl_alternates(const lao_plan *plan, const lao_plan_write *write) {
    const lao_plan_instance *it =
        write->instance == LAO_NO_INDEX ? NULL : &plan->instances[write->instance];
    return it && it->slot[0] != it->slot[1];
}

static lao_result lao__gl_framebuffers_make(const lao__gl *gl, const lao__gl_view *view,
                                            const lao_plan *plan, uint32_t index) {
    const lao_plan_step *step = &plan->steps[index];
    lao__gl_uint *names = view->steps[index].framebuffers;
    uint32_t count = 1, parity, i;
    lao_result result = LAO_OK;
    for (i = 0; i <= step->color_count; i++)
        count = lao__gl_alternates(plan, lao__gl_write(step, i)) ? 2 : count;
    gl->GenFramebuffers((lao__gl_int)count, names);
    if (count == 1)
        names[1] = names[0];
    for (parity = 0; parity < count && !result; parity++) {
        gl->BindFramebuffer(LAO__GL_DRAW_FRAMEBUFFER, names[parity]);
        if (!lao__gl_attach_images(gl, view, plan, step,
                                   parity)) /* else once the host's images are known */
            result = lao__gl_complete(gl, LAO_LOG_BACKEND_FEATURE, step->row->name);
    }
    return result;
}

static lao_result lao__gl_view_make(lao__gl *gl, lao__gl_view *view, const lao_plan *plan,
                                    const lao_shader *const *shaders) {
    lao_result result;
    uint32_t i;
    view->step_count = plan->step_count;
    view->texture_count = plan->slot_count;
    view->steps = (lao__gl_step *)lao__gl_allocate(gl, lao__gl_view_size(view));
    if (!view->steps) {
        memset(view, 0, sizeof *view);
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_MEMORY, "view");
    }
    view->textures = (lao__gl_uint *)(view->steps + view->step_count + 1);
    result = lao__gl_textures_make(gl, view, plan);
    for (i = 0; i < plan->step_count && !result; i++) {
        const lao_plan_step *step = &plan->steps[i];
        view->unit_count =
            step->read_count > view->unit_count ? step->read_count : view->unit_count;
        result = lao__gl_framebuffers_make(gl, view, plan, i);
        if (!result && !shaders[step->shader])
            result =
                lao__gl_fail(gl->host, LAO_LOG_SHADER_COMPILE, LAO_NO_SHADER, step->row->shader);
        if (!result)
            result = lao__gl_program_get(gl, shaders[step->shader], step->constants,
                                         &view->steps[i].program);
    }
    return result;
}

/* The old programs go last, so that those which the new plan wants as well are not built again. */
static lao_result lao__gl_view_prepare(void *self, void *view, const lao_plan *plan,
                                       const lao_shader *const *shaders) {
    lao__gl *gl = (lao__gl *)self;
    lao__gl_view *it = (lao__gl_view *)view, old = *it;
    lao_result result;
    memset(it, 0, sizeof *it);
    lao__gl_view_free_images(gl, &old);
    lao__gl_begin(gl, LAO__GL_PREPARE, 1);
    result = lao__gl_view_make(gl, it, plan, shaders);
    lao__gl_end(gl);
    lao__gl_view_free_programs(gl, &old);
    if (result)
        lao__gl_drain(gl);
    else
        result = lao__gl_check(gl, "preparing the view", "");
    if (result) {
        lao__gl_view_free_images(gl, it);
        lao__gl_view_free_programs(gl, it);
    }
    return result;
}

static lao_result lao__gl_view_create(void *self, void **view) {
    lao__gl *gl = (lao__gl *)self;
    void *it = lao__gl_allocate(gl, sizeof(lao__gl_view));
    if (!it)
        return lao__gl_fail(gl->host, LAO_LOG_BACKEND_MEMORY, "view");
    *view = it;
    return LAO_OK;
}

static void lao__gl_view_destroy(void *self, void *view) {
    lao__gl *gl = (lao__gl *)self;
    if (!view)
        return;
    lao__gl_view_free_images(gl, (lao__gl_view *)view);
    lao__gl_view_free_programs(gl, (lao__gl_view *)view);
    lao__gl_release(gl, view, sizeof(lao__gl_view));
}

/* -------------------------------------------------------------------------------------- a frame */

static size_t lao__gl_align(const lao__gl *gl, size_t size) {
    size_t unit = gl->alignment > 16 ? gl->alignment : 16;
    return (size + unit - 1) / unit * unit;
}

/* Blocks of settings: one for each module of each set. */
static size_t lao__gl_settings_offset(const lao__gl *gl, const lao_execution *execution,
                                      uint32_t set, uint32_t module) {
    size_t index = (size_t)set * gl->host->graph->module_count + module;
    return lao__gl_align(gl, execution->frame_size) +
           index * lao__gl_align(gl, gl->host->settings_size);
}

static size_t lao__gl_step_offset(const lao__gl *gl, const lao_execution *execution,
                                  uint32_t step) {
    return lao__gl_settings_offset(gl, execution, execution->set_count, 0) +
           step * lao__gl_align(gl, sizeof execution->plan->steps->uniforms);
}

static lao_result lao__gl_stage(lao__gl *gl, size_t size) {
    if (size <= gl->staging_size)
        return LAO_OK;
    lao__gl_release(gl, gl->staging, gl->staging_size);
    gl->staging = (uint8_t *)lao__gl_allocate(gl, size);
    gl->staging_size = gl->staging ? size : 0;
    return gl->staging ? LAO_OK
                       : lao__gl_fail(gl->host, LAO_LOG_BACKEND_MEMORY, "uniforms of a frame");
}

/* All uniforms of a frame go up at once: the frame's, the settings, every step's. */
static lao_result lao__gl_upload(lao__gl *gl, const lao_execution *execution) {
    const lao_plan *plan = execution->plan;
    const uint8_t *settings = (const uint8_t *)execution->set_uniforms;
    size_t size = lao__gl_step_offset(gl, execution, plan->step_count);
    lao_result result = lao__gl_stage(gl, size);
    uint32_t set, module, i;
    if (result)
        return result;
    memcpy(gl->staging, execution->frame_uniforms, execution->frame_size);
    for (set = 0; set < execution->set_count; set++)
        for (module = 0; module < gl->host->graph->module_count; module++) {
            memcpy(gl->staging + lao__gl_settings_offset(gl, execution, set, module), settings,
                   gl->host->settings_size);
            settings += gl->host->settings_size;
        }
    for (i = 0; i < plan->step_count; i++)
        memcpy(gl->staging + lao__gl_step_offset(gl, execution, i), plan->steps[i].uniforms,
               sizeof plan->steps[i].uniforms);
    gl->BindBuffer(LAO__GL_UNIFORM_BUFFER, gl->uniforms);
    gl->BufferData(LAO__GL_UNIFORM_BUFFER, (lao__gl_size)size, gl->staging, LAO__GL_STREAM_DRAW);
    return LAO_OK;
}

static void lao__gl_bind_block(const lao__gl *gl, uint32_t block, size_t offset, size_t size) {
    if (size)
        gl->BindBufferRange(LAO__GL_UNIFORM_BUFFER, block, gl->uniforms, (lao__gl_size)offset,
                            (lao__gl_size)size);
}

/* Attaches the host's textures and renderbuffers to our framebuffer of a step, or takes them off
   again, so that the host may delete them. Returns how many there are. */
static uint32_t lao__gl_borrow(const lao__gl *gl, const lao_plan_step *step,
                               const lao_execution *execution, int on) {
    uint32_t count = 0, i;
    for (i = 0; i <= step->color_count; i++) {
        const lao_image *image = lao__gl_host_image(execution, lao__gl_write(step, i)->instance);
        lao__gl_uint name = image && on ? (lao__gl_uint)image->native : 0;
        if (!image || image->kind == LAO_HOST_FRAMEBUFFER)
            continue;
        count++;
        if (image->kind == LAO_HOST_RENDERBUFFER)
            gl->FramebufferRenderbuffer(LAO__GL_DRAW_FRAMEBUFFER, lao__gl_point(step, i),
                                        LAO__GL_RENDERBUFFER, name);
        else
            gl->FramebufferTexture2D(LAO__GL_DRAW_FRAMEBUFFER, lao__gl_point(step, i),
                                     LAO__GL_TEXTURE_2D, name, 0);
    }
    return count;
}

/* Binds what a step writes: our framebuffer, or the host's as it is. */
static lao_result lao__gl_bind_writes(const lao__gl *gl, const lao__gl_step *step,
                                      const lao_plan_step *row, const lao_execution *execution) {
    const lao_image *foreign = NULL;
    uint32_t borrowed, i;
    int srgb = 0;
    gl->BindFramebuffer(LAO__GL_DRAW_FRAMEBUFFER, step->framebuffers[execution->parity & 1]);
    borrowed = lao__gl_borrow(gl, row, execution, 1);
    for (i = 0; i <= row->color_count; i++) {
        const lao_image *image = lao__gl_host_image(execution, lao__gl_write(row, i)->instance);
        srgb |= image && (image->flags & LAO_HOST_ENCODE_SRGB);
        if (image && image->kind == LAO_HOST_FRAMEBUFFER)
            foreign = image;
    }
    if (foreign)
        gl->BindFramebuffer(LAO__GL_DRAW_FRAMEBUFFER, (lao__gl_uint)foreign->native);
    for (i = 0; i < LAO__GL_BUFFERS;
         i++) { /* further draw buffers of a host's framebuffer are none of ours */
        lao__gl_bool on = !foreign || i < row->color_count;
        gl->ColorMaski(i, on, on, on, on);
    }
    lao__gl_toggle(gl, LAO__GL_FRAMEBUFFER_SRGB, srgb);
    return foreign || borrowed ? lao__gl_complete(gl, LAO_LOG_BACKEND_CALL, row->row->name)
                               : LAO_OK;
}

static void lao__gl_give_back(const lao__gl *gl, const lao__gl_step *step, const lao_plan_step *row,
                              const lao_execution *execution) {
    gl->BindFramebuffer(LAO__GL_DRAW_FRAMEBUFFER, step->framebuffers[execution->parity & 1]);
    lao__gl_borrow(gl, row, execution, 0);
}

static void lao__gl_clear(const lao__gl *gl, const lao_plan *plan, const lao_plan_step *step) {
    static const lao__gl_uint nothing[4] = {0, 0, 0, 0};
    uint32_t i;
    for (i = 0; i < step->color_count; i++) {
        const lao_plan_write *write = &step->colors[i];
        if (write->instance == LAO_NO_INDEX || write->clear != 1)
            continue;
        if (plan->instances[write->instance].format == LAO_FORMAT_R32UI)
            gl->ClearBufferuiv(LAO__GL_COLOR, (lao__gl_int)i, nothing);
        else
            gl->ClearBufferfv(LAO__GL_COLOR, (lao__gl_int)i, write->value);
    }
    if (step->depth.instance != LAO_NO_INDEX && step->depth.clear == 1) {
        gl->DepthMask(1); /* clears obey it */
        gl->ClearBufferfv(LAO__GL_DEPTH, 0, step->depth.value);
    }
}

static void lao__gl_set_tests(const lao__gl *gl, const lao_plan *plan, const lao_plan_step *step) {
    static const double over[4] = {LAO__GL_ONE, LAO__GL_ONE_MINUS_SRC_ALPHA, LAO__GL_ONE,
                                   LAO__GL_ONE_MINUS_SRC_ALPHA};
    static const double add[4] = {LAO__GL_ONE, LAO__GL_ONE, LAO__GL_ONE, LAO__GL_ONE};
    lao_blend blend = step->row->blend;
    lao_depth_test depth = step->row->depth;
    uint32_t i;
    for (i = 0; i < step->color_count; i++) {
        lao__gl_toggle_indexed(gl, LAO__GL_BLEND, i, blend != LAO_BLEND_NONE);
        if (blend != LAO_BLEND_NONE)
            lao__gl_blend_func(gl, i, blend == LAO_BLEND_ADD ? add : over);
    }
    lao__gl_toggle(gl, LAO__GL_DEPTH_TEST,
                   depth != LAO_DEPTH_NONE && step->depth.instance != LAO_NO_INDEX);
    gl->DepthMask(depth != LAO_DEPTH_COVERED);
    if (depth == LAO_DEPTH_NEARER)
        gl->DepthFunc(plan->reverse_depth ? LAO__GL_GREATER : LAO__GL_LESS);
    else if (depth == LAO_DEPTH_COVERED)
        gl->DepthFunc(plan->reverse_depth ? LAO__GL_LESS : LAO__GL_GREATER);
    else
        gl->DepthFunc(LAO__GL_ALWAYS);
    lao__gl_toggle(gl, LAO__GL_CULL_FACE, step->row->cull != LAO_CULL_NONE);
    gl->CullFace(step->row->cull == LAO_CULL_FRONT ? LAO__GL_FRONT : LAO__GL_BACK);
}

static lao_result lao__gl_bind_reads(const lao__gl *gl, const lao__gl_view *view,
                                     const lao_plan_step *step, const lao_execution *execution) {
    uint32_t i;
    for (i = 0; i < step->read_count; i++) {
        const lao_image *image;
        if (LAO_READ_IS_BUFFER(step->reads[i]))
            continue; /* with each draw */
        image = lao__gl_host_image(execution, step->reads[i]);
        if (image && image->kind != LAO_HOST_TEXTURE)
            return lao__gl_fail(gl->host, LAO_LOG_IMPORT,
                                "pass %s reads an image that is not a texture", step->row->name);
        gl->ActiveTexture(LAO__GL_TEXTURE0 + i);
        gl->BindTexture(
            LAO__GL_TEXTURE_2D,
            image ? (lao__gl_uint)image->native
                  : lao__gl_texture(view, execution->plan, step->reads[i], execution->parity & 1));
        gl->BindSampler(i, gl->sampler);
    }
    return LAO_OK;
}

static void lao__gl_bind_buffers(const lao__gl *gl, const lao_plan_step *step,
                                 const lao_chunk *chunk) {
    uint32_t i;
    for (i = 0; i < step->read_count; i++) {
        const void *buffer = LAO_READ_IS_BUFFER(step->reads[i])
                                 ? chunk->buffers[step->reads[i] - LAO_READ_BUFFER]
                                 : NULL;
        if (!buffer)
            continue;
        gl->ActiveTexture(LAO__GL_TEXTURE0 + i);
        gl->BindTexture(LAO__GL_TEXTURE_BUFFER, ((const lao__gl_buffer *)buffer)->texture);
    }
}

/* Segments in pieces that 16-bit indices reach. */
static void lao__gl_draw_segments(const lao__gl *gl, const lao_range *range) {
    uint32_t first, count;
    for (first = 0; first < range->count; first += count) {
        count = lao__gl_lower(range->count - first, LAO__GL_QUADS);
        /* llvmpipe keeps every triangle it has not come to yet, about 500 bytes each, and may be
           millions behind: it catches up before more are drawn */
        if (gl->software && first % (LAO__GL_QUADS * LAO__GL_PIECES) == 0 && first > 0)
            gl->Finish();
        gl->DrawElementsBaseVertex(LAO__GL_TRIANGLES, (lao__gl_int)(count * 6),
                                   LAO__GL_UNSIGNED_SHORT, NULL,
                                   (lao__gl_int)((range->first + first) * 4));
    }
}

static void lao__gl_draw(const lao__gl *gl, const lao_plan_step *step,
                         const lao_execution *execution) {
    const lao_chunk *chunks;
    const uint32_t count = lao_step_draws(execution, step, &chunks);
    uint32_t i;
    for (i = 0; i < count; i++) {
        lao__gl_bind_buffers(gl, step, &chunks[i]);
        if (LAO_PASS_DRAWS_LINES(step->row->kind)) {
            lao_range range = {0, 0, 0};
            while (lao_step_range(execution, step, &chunks[i], &range))
                lao__gl_draw_segments(gl, &range);
        } else if (step->row->kind == LAO_PASS_DRAW_MESH)
            gl->DrawArrays(LAO__GL_TRIANGLES, 0, (lao__gl_int)(chunks[i].count * 3));
        else
            gl->DrawArrays(LAO__GL_TRIANGLES, 0, 3);
    }
}

static lao_result lao__gl_run_step(const lao__gl *gl, const lao__gl_view *view, uint32_t index,
                                   const lao_execution *execution) {
    const lao_plan_step *step = &execution->plan->steps[index];
    double viewport[4] = {0, 0, 0, 0};
    lao_result result = lao__gl_bind_writes(gl, &view->steps[index], step, execution);
    if (!result)
        result = lao__gl_bind_reads(gl, view, step, execution);
    if (!result) {
        viewport[2] = step->width;
        viewport[3] = step->height;
        lao__gl_viewport(gl, viewport);
        lao__gl_clear(gl, execution->plan, step);
        lao__gl_set_tests(gl, execution->plan, step);
        lao__gl_bind_block(gl, LAO__GL_BLOCK_SETTINGS,
                           lao__gl_settings_offset(gl, execution, step->set, step->module),
                           gl->host->settings_size);
        lao__gl_bind_block(gl, LAO__GL_BLOCK_STEP, lao__gl_step_offset(gl, execution, index),
                           sizeof step->uniforms);
        gl->UseProgram(view->steps[index].program->name);
        lao__gl_draw(gl, step, execution);
    }
    lao__gl_give_back(gl, &view->steps[index], step, execution);
    return result;
}

static double lao__gl_now(const lao__gl *gl) {
    gl->Finish();
    return gl->desc.now(gl->desc.user);
}

static lao_result lao__gl_run(lao__gl *gl, lao__gl_view *view, const lao_execution *execution) {
    lao_result result = lao__gl_upload(gl, execution);
    double start = 0;
    uint32_t i;
    if (result)
        return result;
    gl->BindVertexArray(gl->vertex_array);
    lao__gl_bind_block(gl, LAO__GL_BLOCK_FRAME, 0, execution->frame_size);
    view->timed = (execution->flags & LAO_FRAME_TIMINGS) && gl->desc.now;
    for (i = 0; i < execution->plan->step_count && !result; i++) {
        if (view->timed)
            start = lao__gl_now(gl);
        result = lao__gl_run_step(gl, view, i, execution);
        if (view->timed &&
            !result) { /* each pass finishes anyway: a moment to learn whose error it is */
            view->steps[i].milliseconds = (lao__gl_now(gl) - start) * 1000;
            result = lao__gl_check(gl, "pass ", execution->plan->steps[i].row->name);
        }
    }
    return result;
}

static lao_result lao__gl_execute(void *self, void *view, const lao_execution *execution) {
    lao__gl *gl = (lao__gl *)self;
    lao__gl_view *it = (lao__gl_view *)view;
    lao_result result;
    if (!it->steps || it->step_count != execution->plan->step_count)
        return lao__gl_fail(gl->host, LAO_LOG_NOTHING_RENDERED,
                            "the view is not prepared for this plan");
    result = lao__gl_refuse(gl);
    if (result)
        return result;
    lao__gl_begin(gl, LAO__GL_DRAW, it->unit_count);
    result = lao__gl_run(gl, it, execution);
    lao__gl_end(gl);
    if (!result)
        return lao__gl_check(gl, "a frame", " (LAO_FRAME_TIMINGS names the pass)");
    lao__gl_drain(gl);
    return result;
}

static lao_result lao__gl_read(void *self, void *view, const lao_plan *plan, uint32_t slot,
                               void *data, size_t size) {
    lao__gl *gl = (lao__gl *)self;
    const lao__gl_view *it = (const lao__gl_view *)view;
    const lao_plan_slot *row = &plan->slots[slot];
    const lao__gl_format *format = &lao__gl_formats[row->format];
    lao__gl_enum point =
        row->format == LAO_FORMAT_D32F ? LAO__GL_DEPTH_ATTACHMENT : LAO__GL_COLOR_ATTACHMENT0;
    if (slot >= it->texture_count)
        return lao__gl_fail(gl->host, LAO_LOG_NOTHING_RENDERED, "slot %u", (unsigned)slot);
    if (size < (size_t)row->width * row->height * format->bytes)
        return lao__gl_fail(gl->host, LAO_LOG_READ_SIZE, "slot %u", (unsigned)slot);
    lao__gl_begin(gl, LAO__GL_READ, 0);
    gl->BindFramebuffer(LAO__GL_READ_FRAMEBUFFER, gl->reader);
    gl->FramebufferTexture2D(LAO__GL_READ_FRAMEBUFFER, point, LAO__GL_TEXTURE_2D,
                             it->textures[slot], 0);
    gl->ReadBuffer(point == LAO__GL_COLOR_ATTACHMENT0 ? point : 0);
    gl->ReadPixels(0, 0, (lao__gl_int)row->width, (lao__gl_int)row->height, format->format,
                   format->type, data);
    gl->FramebufferTexture2D(LAO__GL_READ_FRAMEBUFFER, point, LAO__GL_TEXTURE_2D, 0, 0);
    lao__gl_end(gl);
    return lao__gl_check(gl, "read", "");
}

static lao_result lao__gl_timings(void *self, void *view, double *milliseconds,
                                  uint32_t step_count) {
    const lao__gl *gl = (const lao__gl *)self;
    const lao__gl_view *it = (const lao__gl_view *)view;
    uint32_t i;
    if (!it->timed)
        return lao__gl_fail(gl->host, LAO_LOG_TIMINGS_OFF,
                            gl->desc.now ? "" : "lao_gl_desc.now is NULL");
    for (i = 0; i < step_count && i < it->step_count; i++)
        milliseconds[i] = it->steps[i].milliseconds;
    return LAO_OK;
}

LAO_API lao_result lao_gl_backend(const lao_gl_desc *desc, struct lao_backend *backend) {
    if (!desc || !backend || !desc->get_proc || desc->state_mode > LAO_GL_DIRTY)
        return LAO_ERROR_INVALID_ARGUMENT;
    memset(backend, 0, sizeof *backend);
    backend->abi = LAO_BACKEND_ABI;
    backend->name = "OpenGL";
    memcpy(backend->storage, desc, sizeof *desc);
    backend->attach = lao__gl_attach;
    backend->detach = lao__gl_detach;
    backend->buffer_create = lao__gl_buffer_create;
    backend->buffer_destroy = lao__gl_buffer_destroy;
    backend->view_create = lao__gl_view_create;
    backend->view_destroy = lao__gl_view_destroy;
    backend->view_prepare = lao__gl_view_prepare;
    backend->execute = lao__gl_execute;
    backend->read = lao__gl_read;
    backend->timings = lao__gl_timings;
    return LAO_OK;
}
