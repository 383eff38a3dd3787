/* lineao.h - dense 3D line sets with line ambient occlusion, for OpenGL and Vulkan hosts. MIT
   licence, see LICENSE.

   A rendering core that a host drops in as files. It draws brain-fibre tractograms, pathlines and
   other streamlines as view-aligned ribbons whose depth and structure can be read at a glance:
   LineAO (Eichelbaum 2013) and anisotropic LineAO (Koehler 2017). The frame graph is data: tables
   of passes, images and settings that a backend executes.

   EXAMPLE (OpenGL; for Vulkan only the three backend lines differ)
       #define LINEAO_IMPLEMENTATION       // in exactly one C or C++ file
       #include "lineao.h"                 // and compile lineao_gl.c (lineao_vk.c) beside it

       lao_gl_desc gl = {0};               // the host's context is current; functions come from its
   loader gl.get_proc = my_get_proc; lao_desc desc = {0}; lao_gl_backend(&gl, &desc.backend);
       lao_context *context;
       if (lao_create(&desc, &context) != LAO_OK) return 1;
       lao_lines_desc set = {0};           // points in millimetres, offsets[line_count + 1]
       set.line_count = n; set.offsets = offsets; set.points = points; set.point_count = offsets[n];
       lao_lines lines;
       lao_lines_create(context, &set, &lines);
       lao_view_desc size = {0};
       size.width = 1280; size.height = 720;
       lao_view view;
       lao_view_create(context, &size, &view);
       lao_set sets[1] = {0};              // zero: the recommended settings
       sets[0].lines = lines;
       lao_frame frame = {0};              // and for every frame:
       frame.view = view; frame.sets = sets; frame.set_count = 1;
       memcpy(frame.camera.view, my_view, 64); memcpy(frame.camera.projection, my_projection, 64);
       frame.target = my_target;           // a lao_image: the host's framebuffer, texture or image
       lao_render(context, &frame);

   DOES NOT open windows, create devices, contexts, queues or threads, submit or wait, read files,
   print, abort, keep global state or link to a GL or Vulkan library.

   FILES  OpenGL host: lineao.h lineao_shaders.h lineao_gl.c. Vulkan host: lineao.h lineao_shaders.h
   lineao_vk.c. A further module (sdfvessel.h, vesselsurface.h) brings its shaders in a file of its
   own (sdfvessel_shaders.h, ...), which lineao_shaders.h takes when it lies beside.

   CONFIGURATION (define before including)
       LINEAO_IMPLEMENTATION   the function bodies, in one translation unit
       LAO_API                 linkage of the public functions (default: extern)
       LAO_ASSERT(condition)   checks of our own invariants (default: nothing)

   CONTRACTS
       Units     millimetres, milliseconds, radians. Larger depth is farther.
       Images    row 0 of every image of the graph is the bottom of the picture; one flip, in the
   copy to the host's image. Threads   a context is used by one thread at a time; contexts are
   independent; functions without a context are pure. Memory    every CPU byte comes from
   lao_desc.allocator. lao_render allocates nothing once a view has drawn a frame of the same
   structure (size, structural settings, imports, number of sets). Errors    a failure returns one
   lao_result, logs one item and leaves out-parameters untouched. Versions  source compatibility
   within a major version: new fields come at the end and zero keeps the old behaviour. */
#ifndef LINEAO_H
#define LINEAO_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define LAO_VERSION 1000 /* major * 1000000 + minor * 1000 + patch */

#ifndef LAO_API
#define LAO_API extern
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------
 * results and hooks */

typedef enum lao_result {
    LAO_OK = 0,
    LAO_ERROR_INVALID_ARGUMENT, /* the host passed something that cannot be; the log says what */
    LAO_ERROR_STALE_HANDLE,     /* the handle was destroyed or never made */
    LAO_ERROR_OUT_OF_MEMORY,    /* the allocator returned NULL */
    LAO_ERROR_OUT_OF_DEVICE_MEMORY,
    LAO_ERROR_UNSUPPORTED, /* the device or its driver lacks something; the log names it */
    LAO_ERROR_SHADER,      /* a shader did not compile or link; the log holds the compiler's text */
    LAO_ERROR_GRAPH,       /* the tables contradict each other (module authors) */
    LAO_ERROR_BACKEND,     /* a call of the graphics library failed; the log names it */
    LAO_ERROR_DEVICE_LOST,
    LAO_ERROR_NOT_READY /* nothing has been rendered into this view yet */
} lao_result;

/* The result's name in words, a static string. */
LAO_API const char *lao_result_text(lao_result result);

/* One row per thing that can go wrong: X(id, result, text). Each failure logs exactly one. */
#define LAO_LOG_ITEMS(X)                                                                           \
    X(NULL_ARGUMENT, LAO_ERROR_INVALID_ARGUMENT, "a required pointer is NULL")                     \
    X(BACKEND_MISSING, LAO_ERROR_INVALID_ARGUMENT,                                                 \
      "lao_desc.backend was not filled by a lao_*_backend function")                               \
    X(BACKEND_ABI, LAO_ERROR_INVALID_ARGUMENT,                                                     \
      "the backend was built against another version of lineao.h")                                 \
    X(CONTEXT_MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory for the context")                        \
    X(GRAPH_BROKEN, LAO_ERROR_GRAPH,                                                               \
      "the tables of passes, images and settings contradict each other")                           \
    X(LINES_OFFSETS, LAO_ERROR_INVALID_ARGUMENT,                                                   \
      "offsets must start at 0, never fall and end at point_count")                                \
    X(LINES_COUNT, LAO_ERROR_INVALID_ARGUMENT, "too many points for 32-bit indices")               \
    X(LINES_MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory for the line set")                         \
    X(LINES_HANDLE, LAO_ERROR_STALE_HANDLE, "the lao_lines handle is not alive")                   \
    X(OBJECT_BUFFER, LAO_ERROR_INVALID_ARGUMENT,                                                   \
      "a buffer of an object is unknown, given twice, without data or too long")                   \
    X(OBJECT_MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory for the object")                          \
    X(OBJECT_HANDLE, LAO_ERROR_STALE_HANDLE, "the lao_object handle is not alive")                 \
    X(VIEW_SIZE, LAO_ERROR_INVALID_ARGUMENT,                                                       \
      "the view's size is zero or, times supersampling, above the device limit")                   \
    X(VIEW_MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory for the view")                              \
    X(VIEW_HANDLE, LAO_ERROR_STALE_HANDLE, "the lao_view handle is not alive")                     \
    X(PLAN_MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory for the plan")                              \
    X(CAMERA, LAO_ERROR_INVALID_ARGUMENT,                                                          \
      "a camera matrix is singular, not finite or not a projection")                               \
    X(SETTING_RANGE, LAO_ERROR_INVALID_ARGUMENT, "a setting is outside its range")                 \
    X(IMPORT, LAO_ERROR_INVALID_ARGUMENT,                                                          \
      "an imported image is not part of the graph or has the wrong size")                          \
    X(TARGET, LAO_ERROR_INVALID_ARGUMENT, "the target's size differs from the view's")             \
    X(FRAME_MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory for the frame")                            \
    X(IMAGE_UNKNOWN, LAO_ERROR_INVALID_ARGUMENT,                                                   \
      "no image of that name and level in the plan of this view")                                  \
    X(READ_SIZE, LAO_ERROR_INVALID_ARGUMENT, "the buffer is too small for the image")              \
    X(NOTHING_RENDERED, LAO_ERROR_NOT_READY, "the view has not been rendered yet")                 \
    X(TIMINGS_OFF, LAO_ERROR_NOT_READY,                                                            \
      "the last frame of the view was rendered without LAO_FRAME_TIMINGS")                         \
    X(UNITS, LAO_ERROR_UNSUPPORTED, "a pass reads more textures than the device has units")        \
    X(BACKEND_FUNCTION, LAO_ERROR_UNSUPPORTED, "a function of the graphics library is missing")    \
    X(BACKEND_FEATURE, LAO_ERROR_UNSUPPORTED, "the device lacks a required feature or format")     \
    X(BACKEND_MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory inside the backend")                     \
    X(DEVICE_MEMORY, LAO_ERROR_OUT_OF_DEVICE_MEMORY, "no device memory")                           \
    X(SHADER_COMPILE, LAO_ERROR_SHADER, "a shader was refused")                                    \
    X(BACKEND_CALL, LAO_ERROR_BACKEND, "a call of the graphics library failed")                    \
    X(BACKEND_STATE, LAO_ERROR_INVALID_ARGUMENT, "the host's state forbids the call")              \
    X(DEVICE_LOST, LAO_ERROR_DEVICE_LOST, "the device is lost")

typedef enum lao_log_item {
#define LAO__ENUM(id, result, text) LAO_LOG_##id,
    LAO_LOG_ITEMS(LAO__ENUM)
#undef LAO__ENUM
        LAO_LOG_ITEM_COUNT
} lao_log_item;

/* Receives one call per failure. `text` ends with what is special to the case (a name, a number);
 * valid during the call. */
typedef struct lao_logger {
    void (*log)(void *user, lao_log_item item, lao_result result,
                const char *text); /* NULL: silent */
    void *user;
} lao_logger;

/* Both or neither. NULL: malloc and free. Memory is aligned for any type. */
typedef struct lao_allocator {
    void *(*allocate)(void *user, size_t size);
    void (*release)(void *user, void *memory, size_t size);
    void *user;
} lao_allocator;

/* Runs `fn(arg, index)` for every index in [0, count), on as many threads as the host likes. All
   zero: serial. Chunks are fixed by the caller, so results do not depend on threads. `progress`
   (Optional) returns non-zero to cancel. */
typedef struct lao_job {
    void (*run)(void *user, uint32_t count, void (*fn)(void *arg, uint32_t index), void *arg);
    int (*progress)(void *user, uint64_t done, uint64_t total);
    void *user;
} lao_job;

/* ------------------------------------------------------------------------------------------------------------
   tables One array per concept and module; names tie them together. A new effect is a row here and
   a file in shaders/. */

typedef enum lao_format {
    LAO_FORMAT_NONE = 0,
    LAO_FORMAT_RGBA8,
    LAO_FORMAT_RGBA16F,
    LAO_FORMAT_RGBA32F,
    LAO_FORMAT_R32F,
    LAO_FORMAT_R32UI, /* one word of bits; cleared to 0, never blended */
    LAO_FORMAT_D32F,
    LAO_FORMAT_HOST, /* whatever the imported image has */
    LAO_FORMAT_COUNT
} lao_format;

/* Bytes of one texel; 0 for NONE and HOST. */
LAO_API uint32_t lao_format_bytes(lao_format format);

typedef enum lao_size {
    LAO_SIZE_FULL,  /* view size times the setting `supersampling` */
    LAO_SIZE_VIEW,  /* the view's size */
    LAO_SIZE_FIXED, /* width x height of the row */
    LAO_SIZE_ITEMS  /* one texel for each item of the set's object (vertex, node, segment), in rows
                       of LAO_ITEMS_WIDTH; the row's `width` says of which kind: 0 item_count, k
                       further_items[k - 1] */
} lao_size;
#define LAO_ITEMS_WIDTH 2048u
#define LAO_FURTHER_ITEMS 8

/* How lao_read turns texels into numbers. */
typedef enum lao_encoding {
    LAO_ENCODING_PLAIN,
    LAO_ENCODING_LEVEL, /* R32UI: lao_level_pack; three channels: the direction's two numbers by the
                           setting `align` of the set that wrote it, depth */
    LAO_ENCODING_SIGNED8 /* RGBA8: 2 v - 1; three channels in [-1, 1] */
} lao_encoding;

enum {
    LAO_IMAGE_IMPORT = 1 /* only ever given by the host */,
    LAO_IMAGE_HISTORY = 2 /* last frame's content is kept */
};

/* A condition: a setting (of the set's settings); with a leading '@', an import: 0 absent, 1
   readable, 2 writable; with a leading '#', a buffer of the set: 0 absent, 1 present. */
typedef struct lao_when {
    const char *name; /* NULL: always true */
    char compare;     /* '=', '!', '<', '>' */
    float value;
} lao_when;

typedef struct lao_image_row {
    const char *name;
    lao_format format;
    lao_size size;
    uint32_t width, height; /* LAO_SIZE_FIXED; LAO_SIZE_ITEMS: width is the kind of items */
    const char
        *levels; /* NULL: 1; "*": down to 1x1 by ceil halving; else the setting that counts them */
    uint32_t flags; /* LAO_IMAGE_... */
    lao_encoding encoding;
    float clear[4];
    lao_when when; /* the image does not exist where this is false; references to it are dropped */
    const char *channels[4]; /* names in a dump, "%d" is the level; NULL: not dumped */
} lao_image_row;

typedef enum lao_level {
    LAO_LEVEL_SAME,
    LAO_LEVEL_FINER,
    LAO_LEVEL_COARSER,
    LAO_LEVEL_INDEX
} lao_level;
typedef enum lao_phase {
    LAO_PHASE_THIS,    /* what was written last */
    LAO_PHASE_OTHER,   /* its ping-pong partner; becomes THIS once written */
    LAO_PHASE_PREVIOUS /* the last frame's (LAO_IMAGE_HISTORY) */
} lao_phase;
typedef enum lao_load {
    LAO_LOAD_CLEAR,  /* cleared by every step */
    LAO_LOAD_KEEP,   /* cleared by the first writer of the frame, kept by later ones */
    LAO_LOAD_DISCARD /* every texel is written: neither */
} lao_load;

typedef struct lao_reference {
    const char *image; /* NULL ends the list; "#name" is a buffer (lao_buffer_row) */
    lao_level level;
    uint32_t level_index; /* LAO_LEVEL_INDEX: past the last level means the last; or where
                             LAO_REPEAT_LEVELS_UP starts */
    lao_phase phase;
    lao_load load; /* writes only */
} lao_reference;

typedef enum lao_pass_kind {
    LAO_PASS_FULLSCREEN, /* one triangle over the image; reads buffers of the set's object */
    LAO_PASS_DRAW_MESH,  /* three vertices for each triangle of the set's object; nothing without
                            one */
    LAO_PASS_DRAW_LINES, /* four vertices for each segment of the set's lines; reads their buffers
                          */
    LAO_PASS_DRAW_LINES_FIRST, /* of a set drawn in parts the first, of any other everything */
    LAO_PASS_DRAW_LINES_REST   /* part 1 + lao_plan_step.iteration; nothing of any other set */
} lao_pass_kind;
#define LAO_PASS_DRAWS_LINES(kind) ((kind) >= LAO_PASS_DRAW_LINES)
typedef enum lao_repeat {
    LAO_REPEAT_NONE,
    LAO_REPEAT_LEVELS_UP,   /* the levels above writes[0].level_index .. last of that image */
    LAO_REPEAT_LEVELS_DOWN, /* last - 1 .. 0 */
    LAO_REPEAT_COUNT,       /* as often as the setting `repeat_setting` says */
    LAO_REPEAT_WITH_LAST    /* in every turn of the row before that is not WITH_LAST itself, behind
                               it, at its level and as its iteration; `repeat_setting` (optional):
                               so often each turn, which is the iteration then */
} lao_repeat;
typedef enum lao_scope {
    LAO_SCOPE_FRAME,  /* once, with the settings of the first set that its conditions hold for */
    LAO_SCOPE_PER_SET /* consecutive rows replay for each set; those that compose, behind all sets'
                         shading */
} lao_scope;
/* Rows of all modules run stage by stage; within a stage in order of modules and rows. */
typedef enum lao_stage {
    LAO_STAGE_DRAW,    /* geometry into the G-buffer and the depth buffer */
    LAO_STAGE_SHADE,   /* what is made of it, up to the image "shaded" */
    LAO_STAGE_COMPOSE, /* over the shaded scene of all sets */
    LAO_STAGE_PRESENT  /* the picture, and what goes back to the host */
} lao_stage;
/* By winding in the y-up picture: counter-clockwise triangles are front faces. */
typedef enum lao_cull { LAO_CULL_NONE, LAO_CULL_BACK, LAO_CULL_FRONT } lao_cull;
typedef enum lao_blend {
    LAO_BLEND_NONE,
    LAO_BLEND_OVER /* premultiplied */,
    LAO_BLEND_ADD
} lao_blend;
typedef enum lao_depth_test {
    LAO_DEPTH_NONE,
    LAO_DEPTH_NEARER,
    LAO_DEPTH_ALWAYS,
    LAO_DEPTH_COVERED /* full-screen: only where the depth image holds something; writes no depth.
                         Skips background before the shader, which on llvmpipe an early return does
                         not */
} lao_depth_test;

#define LAO_MAX_BUFFERS 24 /* of all modules of a context */
#define LAO_MAX_READS 16   /* texture units that every stage has at least (OpenGL 3.3, Vulkan) */
#define LAO_MAX_WRITES 6
#define LAO_MAX_CONSTANTS 12
#define LAO_MAX_CONDITIONS 3

typedef struct lao_pass_row {
    const char *name;
    lao_pass_kind kind;
    const char *shader;
    int variant; /* value of the shader's constant `variant`, for rows that share a shader */
    lao_stage stage;
    lao_scope scope;
    lao_repeat repeat;
    const char *repeat_setting;
    lao_blend blend;
    lao_depth_test depth; /* with a D32F (or host depth) image among the writes */
    lao_cull cull;
    lao_when when[LAO_MAX_CONDITIONS];
    lao_reference writes[LAO_MAX_WRITES]; /* colour outputs in location order; a depth image
                                             anywhere among them */
    lao_reference reads[LAO_MAX_READS];   /* index = binding of LAO_TEX in the shader */
} lao_pass_row;

/* A texel buffer that a line set or an object brings along. */
typedef struct lao_buffer_row {
    const char *name;  /* without the '#' of its references */
    lao_format format; /* RGBA32F, R32F or RGBA8 */
} lao_buffer_row;

typedef enum lao_setting_type {
    LAO_SETTING_FLOAT,
    LAO_SETTING_INT,
    LAO_SETTING_BOOL,
    LAO_SETTING_ENUM
} lao_setting_type;

typedef struct lao_setting_row {
    const char *name;
    lao_setting_type type;
    float minimum, maximum, standard;
    int structural; /* non-zero: changes the plan or a shader variant (a change costs a rebuild) */
    const char *unit;    /* "mm", "px", "" */
    const char *choices; /* LAO_SETTING_ENUM: "a|b|c", value = position */
    const char *help;
} lao_setting_row;

typedef struct lao_preset_row {
    const char *preset;
    const char *setting;
    float value;
} lao_preset_row;

typedef enum lao_texture_type { LAO_TEXTURE_2D, LAO_TEXTURE_BUFFER } lao_texture_type;

/* One stage's text, as lines without the shared prologue, and its SPIR-V. Either may be absent. */
typedef struct lao_shader_stage {
    const char *const *lines;
    uint32_t line_count;
    const uint32_t *words;
    uint32_t word_count;
} lao_shader_stage;

/* Generated by amalgamate.sh from shaders/NAME.glsl. */
typedef struct lao_shader {
    const char *name;
    const char *const *constants; /* settings, "variant" or "has_" and a buffer's name (1: the set
                                     has it), in order of their constant id */
    uint32_t constant_count;
    const char *const *texture_names; /* in order of binding */
    const lao_texture_type *texture_types;
    uint32_t texture_count;
    uint32_t output_count;
    lao_shader_stage vertex; /* empty: the shared full-screen triangle */
    lao_shader_stage fragment;
    const char *const
        *prologue; /* lines between the common prologue and the stage's: the module's */
    uint32_t prologue_count;
} lao_shader;

/* Everything that a group of effects adds to the graph. A settings struct is `uint64_t set; float
 * value[setting_count]`. */
typedef struct lao_module {
    const char *name;
    const lao_pass_row *passes;
    uint32_t pass_count;
    const lao_image_row *images;
    uint32_t image_count;
    const lao_setting_row *settings;
    uint32_t setting_count;
    const lao_preset_row *presets;
    uint32_t preset_count;
    const lao_shader *shaders; /* NULL: those of lineao_shaders.h and of what it takes */
    uint32_t shader_count;
    const lao_buffer_row *buffers;
    uint32_t buffer_count;
} lao_module;

/* The module of this header: line sets and line ambient occlusion. Static, never NULL. Thread: any.
 */
LAO_API const lao_module *lao_lines_module(void);
/* Its passes in order. Thread: any. */
LAO_API const lao_pass_row *lao_passes(int *count);

/* ----------------------------------------------------------------------------------------------------------
   settings X(name, TYPE, minimum, maximum, default, structural, unit, choices, help). This table is
   the only place of a range, a default and a help text: validation, uniforms, `lineao --help` and
   the README are made from it. */
#define LAO_SETTINGS(X)                                                                            \
    X(preset, ENUM, 0, 2, 0, 1, "", "default|classic|paper",                                       \
      "starting point that the other settings override")                                           \
    X(width, FLOAT, 0.0001f, 1000, 0.5f, 0, "mm", "", "full width of a line")                      \
    X(occlusion, BOOL, 0, 1, 1, 1, "", "", "compute ambient occlusion")                            \
    X(strength, FLOAT, 0, 5, 1.5f, 0, "", "",                                                      \
      "occlusion multiplier; classic: 1; as many as levels: the printed sum")                      \
    X(align, ENUM, 0, 2, 0, 1, "", "rotation|paper|none",                                          \
      "alignment of tangents: 1 - |t.t'|, the paper's, or none")                                   \
    X(align_intensity, FLOAT, 0, 100, 15, 0, "", "",                                               \
      "how fast misaligned lines darken each other (I of Eq. 11)")                                 \
    X(align_floor, FLOAT, 0, 1, 0.1f, 0, "", "",                                                   \
      "what parallel lines still darken each other (A0 of Eq. 11)")                                \
    X(light, ENUM, 0, 1, 0, 1, "", "paper|author",                                                 \
      "light that takes occlusion away: Eq. 8, or the author's program")                           \
    X(halo, ENUM, 0, 2, 2, 1, "", "none|uniform|depth",                                            \
      "dark border of lines: the same everywhere, or only where a line passes in front of others") \
    X(halo_width, FLOAT, 0, 0.5f, 0.1f, 0, "", "",                                                 \
      "border on each side in parts of half the width; twice this in depth halos (b)")             \
    X(halo_depth, FLOAT, 0, 1, 0.01f, 0, "", "",                                                   \
      "how far behind its line a depth halo reaches, in parts of the scene's depth (d_max)")       \
    X(halo_function, ENUM, 0, 2, 0, 1, "", "sqrt|linear|square",                                   \
      "how a depth halo falls back from the middle to the edge: square sets more lines apart")     \
    X(halo_border, ENUM, 0, 1, 0, 1, "", "hard|soft",                                              \
      "black border, or one that darkens towards the edge, as in the author's program")            \
    X(trail, ENUM, 0, 3, 0, 1, "", "none|taper|opacity|highlight",                                 \
      "what shows the time of a frame: nothing, a trail that narrows or fades, or lit lines")      \
    X(trail_length, FLOAT, 0.001f, 1e6f, 25, 0, "ms", "",                                          \
      "length of a trail before and behind the time of the frame")                                 \
    X(taper_start, FLOAT, 0, 0.999f, 0.333333333f, 0, "", "",                                      \
      "where a trail begins to narrow or fade, in parts of its length (p)")                        \
    X(taper_width, FLOAT, 0.001f, 1, 0.25f, 0, "", "",                                             \
      "width of a trail's end, in parts of the full width")                                        \
    X(period, FLOAT, 0, 1e6f, 0, 0, "ms", "",                                                      \
      "time after which the lines' times repeat, as a heart beat does; 0: never")                  \
    X(highlight_beta, FLOAT, 0.001f, 1e7f, 1600, 0, "ms^2", "",                                    \
      "how long the lit part of a line is: 2 sigma^2 of its bell curve in time (beta)")            \
    X(levels, INT, 1, 8, 3, 1, "", "",                                                             \
      "levels of the occlusion pyramid, each with a larger radius (s_r)")                          \
    X(samples, INT, 1, 128, 32, 1, "", "",                                                         \
      "samples of the finest level; level l takes samples / (l + 1) (s_h)")                        \
    X(pyramid, ENUM, 0, 1, 0, 1, "", "box|gaussian",                                               \
      "how a coarser level averages the covered texels below it")                                  \
    X(radius, FLOAT, 0.5f, 10, 1.5f, 0, "", "",                                                    \
      "sampling radius of the finest level, in line widths")                                       \
    X(radius_step, FLOAT, 0.01f, 100, 2, 0, "mm", "", "growth of the sampling radius per level")   \
    X(density, FLOAT, 0.001f, 2, 1, 0, "", "",                                                     \
      "depth at which occluders stop to matter, times (1 - l / levels)^2")                         \
    X(depth_threshold, FLOAT, 1e-7f, 0.01f, 1e-4f, 0, "", "",                                      \
      "nearest depth difference that occludes (delta 0)")                                          \
    X(depth_unit, ENUM, 0, 1, 0, 0, "", "scene|mm",                                                \
      "depth differences relative to the scene's size, or in mm")                                  \
    X(strict_zero, BOOL, 0, 1, 0, 1, "", "",                                                       \
      "equal depth occludes too, as in the author's program")                                      \
    X(light_intensity, FLOAT, 0, 1, 0.5f, 0, "", "", "head light of the occlusion term (I_s)")     \
    X(light_diffuse, FLOAT, 0, 1, 1, 0, "", "", "diffuse part of the occlusion light")             \
    X(light_specular, FLOAT, 0, 1, 1, 0, "", "", "specular part of the occlusion light")           \
    X(light_exponent, INT, 1, 1000, 100, 1, "", "", "Phong exponent of the occlusion light")       \
    X(ambient, FLOAT, 0, 1, 0.1f, 0, "", "", "ambient part of the line illumination")              \
    X(diffuse, FLOAT, 0, 2, 0.9f, 0, "", "", "diffuse part of the line illumination")              \
    X(specular, FLOAT, 0, 2, 0.35f, 0, "", "", "specular part of the line illumination")           \
    X(shininess, INT, 1, 1000, 100, 1, "", "", "Phong exponent of the line illumination")          \
    X(supersampling, INT, 1, 4, 2, 1, "", "",                                                      \
      "samples per pixel and axis; also scales time and memory")                                   \
    X(smoothing, INT, 0, 10, 0, 1, "", "",                                                         \
      "binomial blurs of the occlusion; for debugging: leaks shadows")                             \
    X(show, ENUM, 0, 8, 0, 1, "",                                                                  \
      "picture|occlusion|visibility|depth|light|alignment|visibility_depth|visibility_depth_"      \
      "light|color",                                                                               \
      "the picture, or factors of the occlusion alone (Koehler 2017, Fig. 4)")                     \
    X(ao_affects_color, ENUM, 0, 1, 0, 1, "", "multiply|luminance_preserving",                     \
      "what shading takes from a color: all of it, or saturation only, so that values can be "     \
      "read")                                                                                      \
    X(cull_hidden, BOOL, 0, 1, 1, 1, "", "",                                                       \
      "of many lines leave out what is hidden before it is drawn; does not change the picture")

/* What a line set looks like. A field counts when it is not zero or its bit in `set` is on;
   otherwise the preset's value holds, then the default. So `lao_settings s = {0}` is the
   recommended picture and an explicit 0 is `s.strength = 0; s.set |= LAO_SET(strength)`. Enumerated
   settings hold the position of the choice. */
typedef struct lao_settings {
    uint64_t set;
#define LAO__FIELD(name, type, minimum, maximum, standard, structural, unit, choices, help)        \
    float name;
    LAO_SETTINGS(LAO__FIELD)
#undef LAO__FIELD
} lao_settings;

typedef enum lao_setting {
#define LAO__ENUM(name, type, minimum, maximum, standard, structural, unit, choices, help)         \
    LAO_SETTING_ID_##name,
    LAO_SETTINGS(LAO__ENUM)
#undef LAO__ENUM
        LAO_SETTING_COUNT
} lao_setting;
#define LAO_SET(name) ((uint64_t)1 << LAO_SETTING_ID_##name)

/* Every field as it will be used, all bits of `set` on. NULL counts as all zero. Thread: any. */
LAO_API lao_settings lao_settings_filled(const lao_settings *settings);
/* The same for any module: `values` receives module->setting_count numbers. `settings` is the
   module's struct or NULL. Returns the index of the first setting outside its range (or not
   finite), -1 if none. Thread: any. */
LAO_API int lao_settings_resolve(const lao_module *module, const void *settings, float *values);
/* Index of the setting of that name, -1 if there is none. Thread: any. */
LAO_API int lao_setting_find(const lao_module *module, const char *name);
/* Sets one setting of a module's struct from text: a number, true/false/on/off, or a choice.
   Returns 0, or -1 when `text` is not a value of the setting (out of range, unknown choice);
   `settings` is then untouched. Thread: any. */
LAO_API int lao_setting_parse(const lao_module *module, int setting, const char *text,
                              void *settings);

/* -------------------------------------------------------------------------------------------------------------
 * camera */

enum {
    LAO_CAMERA_ZERO_TO_ONE =
        1, /* clip depth is [0, w] (Vulkan, Direct3D); otherwise [-w, w] (OpenGL) */
    LAO_CAMERA_REVERSE_DEPTH = 2, /* near is the larger depth */
    LAO_CAMERA_FLIP_Y = 4 /* the projection turns the picture upside down (clip y points down) */
};

/* Column-major, column vectors: clip = projection * view * world. Any handedness, perspective or
   orthographic, off-centre too; no shear beyond that. */
typedef struct lao_camera {
    float view[16];
    float projection[16];
    uint32_t flags; /* LAO_CAMERA_... */
} lao_camera;

/* The same camera in the graph's convention: right-handed view space looking along -z, y up, clip
   depth [0, w] (reversed or not as before). Returns 0, or -1 when a matrix is singular, not finite
   or not a projection. Thread: any. */
LAO_API int lao_camera_canonical(const lao_camera *camera, lao_camera *canonical);

/* -------------------------------------------------------------------------------------------------------------
 * images */

enum {
    LAO_HOST_TEXTURE = 0,      /* GL texture name (2D) or VkImage + VkImageView */
    LAO_HOST_RENDERBUFFER = 1, /* GL renderbuffer name: targets only */
    LAO_HOST_FRAMEBUFFER = 2   /* GL framebuffer name, 0 included: its first colour attachment (or
                                  back buffer); targets only */
};
enum {
    LAO_HOST_TOP_DOWN = 1,   /* row 0 of the image is the top of the picture: swapchains, and what
                                Vulkan hosts draw */
    LAO_HOST_WRITABLE = 2,   /* depth: our lines are written into it too */
    LAO_HOST_ENCODE_SRGB = 4 /* target: our display values are decoded before the write, for images
                                of an sRGB format that encode on write */
};

/* A host's image, by value, with the state in which it comes and shall be left. All zero: no image.
 */
typedef struct lao_image {
    uint64_t native; /* GL: name. Vulkan: VkImage */
    uint64_t
        native_view; /* Vulkan: VkImageView of one mip, one layer; depth aspect only for depth */
    uint32_t kind;   /* LAO_HOST_TEXTURE ... ; Vulkan: 0 */
    uint32_t flags;  /* LAO_HOST_TOP_DOWN ... */
    uint32_t native_format; /* GL internal format (may be 0) or VkFormat (required) */
    uint32_t width, height;
    uint32_t present; /* non-zero: this struct names an image (GL framebuffer 0 has native 0) */
    uint32_t layout_before, layout_after; /* VkImageLayout; after 0: as before */
    uint64_t stage_before, stage_after;   /* VkPipelineStageFlags2; 0: all commands */
    uint64_t access_before, access_after; /* VkAccessFlags2; 0: memory read and write */
} lao_image;

/* A host's image in place of one of the graph's: "host_depth" (depth to test against, view size),
   or the G-buffer of lao_occlude: "color", "tangent", "depth". */
typedef struct lao_import {
    const char *image;
    lao_image source;
} lao_import;

/* -------------------------------------------------------------------------------------------------
 * contexts and objects */

typedef struct lao_context lao_context;
typedef struct lao_lines {
    uint32_t id;
} lao_lines; /* 0: none */
typedef struct lao_object {
    uint32_t id;
} lao_object; /* 0: none */
typedef struct lao_view {
    uint32_t id;
} lao_view; /* 0: none */

#define LAO_BACKEND_ABI 4u
#define LAO_SPARE_PROGRAMS 32u /* kept unused, so that a plan that comes back compiles nothing */
struct lao_backend; /* the seam, below; the host only carries it from lao_*_backend to lao_create */

/* A set of polylines. Points on a line that repeat bit for bit are merged; a line whose first and
   last point are equal is closed; a point that is not finite ends its line and the rest begins
   another. */
typedef struct lao_lines_desc {
    uint32_t line_count;
    uint32_t point_count;
    const uint32_t *offsets; /* line_count + 1 indices of points; NULL: one line of all points */
    const float *points;     /* 3 * point_count, mm */
    const float *times;      /* (Optional) point_count, ms; NaN: never; absent: 0. A frame of a
                                trail draws the segments near its time alone, for which 4 bytes
                                each are kept */
    const uint8_t *colors;   /* (Optional) 4 * point_count, RGBA, display values */
    float color[4];          /* without `colors`: one colour, display values 0..1; all zero: sand */
} lao_lines_desc;

/* What a set brings for the passes of further modules (a vessel tree, a surface): their texel
   buffers by name. The headers of the modules make these arrays. */
typedef struct lao_object_buffer {
    const char *name;     /* of a lao_buffer_row, which tells the format */
    const void *data;     /* texel_count texels, tightly packed; copied */
    uint32_t texel_count; /* 1 or more */
} lao_object_buffer;
typedef struct lao_object_desc {
    const lao_object_buffer *buffers;
    uint32_t buffer_count;
    uint32_t triangle_count;                   /* of LAO_PASS_DRAW_MESH */
    uint32_t item_count;                       /* texels of LAO_SIZE_ITEMS images */
    uint32_t further_items[LAO_FURTHER_ITEMS]; /* of those whose row's width is 1, 2, ... */
    float bounds[2][3];                        /* axis-aligned box (mm): lower, upper corner */
} lao_object_desc;

typedef struct lao_view_desc {
    uint32_t width, height; /* px */
    uint32_t flags;         /* LAO_VIEW_... */
} lao_view_desc;
enum {
    LAO_VIEW_KEEP_IMAGES =
        1 /* no image shares memory with another, so that lao_read can read any: tests, tools */
};

typedef struct lao_set {
    lao_lines lines;              /* id 0: none, a set that draws nothing */
    const lao_settings *settings; /* NULL: the recommended ones. `supersampling` and `depth_unit`
                                     are the first set's */
    lao_object object;            /* (Optional) for further modules */
    const void *const *module_settings; /* (Optional) one settings struct, or NULL, for each of
                                           lao_desc.modules */
} lao_set;

enum {
    LAO_FRAME_TIMINGS = 1,         /* measure every pass (GL: finishes after each; slow) */
    LAO_FRAME_SHARED_OCCLUSION = 2 /* sets occlude each other: all are drawn into one G-buffer,
                                      which is occluded and shaded once, with the first set's
                                      settings; otherwise each occludes itself alone. Objects of
                                      further modules are drawn as ever */
};

typedef struct lao_frame {
    lao_view view;
    lao_camera camera;
    const lao_set
        *sets; /* drawn in order, each occluding itself, hidden by the others through depth */
    uint32_t set_count;
    uint32_t flags;      /* LAO_FRAME_... */
    float background[4]; /* display values, not premultiplied; alpha 0: the target's content shows
                            between lines */
    float sphere[4];  /* (Optional) centre and radius (mm) of everything that takes part; radius 0:
                         from the sets */
    lao_image target; /* where the picture goes; not present: nowhere (lao_read still reads it) */
    const lao_import *imports; /* (Optional) */
    uint32_t import_count;
    float time; /* ms */
    void
        *commands; /* Vulkan: the VkCommandBuffer to record into, outside a render pass. GL: NULL */
} lao_frame;

typedef struct lao_desc {
    const struct lao_backend
        *backend; /* filled by lao_gl_backend, lao_vk_backend or lao_null_backend; copied */
    lao_allocator allocator;
    lao_logger logger;
    const lao_module *const
        *modules; /* (Optional) further modules, in front of which the line module stands */
    uint32_t module_count;
} lao_desc;

/* Makes a context on the backend. The host's context or device must stay alive (GL: current) until
   lao_destroy. Thread: the one that will use the context. */
LAO_API lao_result lao_create(const lao_desc *desc, lao_context **context);
/* Destroys everything made with the context. Vulkan: the device must be done with its work. NULL is
 * allowed. */
LAO_API void lao_destroy(lao_context *context);

/* What the backend can hold: for hosts that choose between ways to bring their data. */
typedef struct lao_limits {
    uint32_t image_size;    /* px: most of an image each way */
    uint32_t buffer_texels; /* longest texel buffer */
} lao_limits;
LAO_API lao_result lao_limits_get(const lao_context *context, lao_limits *limits);

/* Uploads a line set. 0 lines is a legal set that draws nothing. */
LAO_API lao_result lao_lines_create(lao_context *context, const lao_lines_desc *desc,
                                    lao_lines *lines);
/* Replaces the content of a line set; on failure the old content stays. */
LAO_API lao_result lao_lines_update(lao_context *context, lao_lines lines,
                                    const lao_lines_desc *desc);
/* Destroys a line set; frames under way keep what they need. */
LAO_API lao_result lao_lines_destroy(lao_context *context, lao_lines lines);
/* Uploads an object of further modules. */
LAO_API lao_result lao_object_create(lao_context *context, const lao_object_desc *desc,
                                     lao_object *object);
/* Replaces the buffers named in `desc`, its counts and its box; other buffers stay. On failure
   nothing changes. */
LAO_API lao_result lao_object_update(lao_context *context, lao_object object,
                                     const lao_object_desc *desc);
/* Destroys an object; frames under way keep what they need. */
LAO_API lao_result lao_object_destroy(lao_context *context, lao_object object);

/* Axis-aligned box (mm) of the finite points: bounds[0] lower, bounds[1] upper corner. All zero for
 * an empty set. */
LAO_API lao_result lao_lines_bounds(lao_context *context, lao_lines lines, float bounds[2][3]);

/* A view holds the scratch images of one viewport. */
LAO_API lao_result lao_view_create(lao_context *context, const lao_view_desc *desc, lao_view *view);
LAO_API lao_result lao_view_resize(lao_context *context, lao_view view, uint32_t width,
                                   uint32_t height);
LAO_API lao_result lao_view_destroy(lao_context *context, lao_view view);

/* Draws one frame. GL: at once, in the current context. Vulkan: recorded into frame->commands. */
LAO_API lao_result lao_render(lao_context *context, const lao_frame *frame);

/* Occlusion and shading of a G-buffer that the host drew: `frame->imports` must name "color" (RGBA,
   alpha 1 where covered; 1/2 to 1 dims highlights), "tangent" (xyz: unit tangent in canonical view
   space; w: pixels per mm, 0: from depth) and "depth" (METHODS of docs/algorithm.md: 0..1 over the
   scene sphere), all of view size times supersampling, row 0 at the bottom. No sets are drawn;
   `settings` may be NULL. frame->sphere is required. */
LAO_API lao_result lao_occlude(lao_context *context, const lao_frame *frame,
                               const lao_settings *settings);

/* One image of the last frame as floats: channel_count of the image row interleaved, row 0 at the
   bottom, decoded (see lao_encoding). `data` may be NULL to ask for the size only. Stalls. Vulkan:
   needs lao_vk_desc.queue, and the frame's commands must have finished. */
typedef struct lao_read_info {
    uint32_t width, height, channels;
} lao_read_info;
LAO_API lao_result lao_read(lao_context *context, lao_view view, const char *image, uint32_t level,
                            float *data, size_t capacity /* floats */, lao_read_info *info);
/* The same, raw texels as stored: width * height * lao_format_bytes bytes. */
LAO_API lao_result lao_read_raw(lao_context *context, lao_view view, const char *image,
                                uint32_t level, void *data, size_t capacity /* bytes */,
                                lao_read_info *info);

/* Milliseconds of each pass of the last frame rendered with LAO_FRAME_TIMINGS, in order of the
   plan. `count` goes in as the capacity and comes out as the number of rows that there are. Vulkan:
   the commands must have finished. */
typedef struct lao_timing {
    const char *pass;
    uint32_t set, level;
    double milliseconds;
} lao_timing;
LAO_API lao_result lao_timings(lao_context *context, lao_view view, lao_timing *timings,
                               uint32_t *count);

/* The context's graph as Graphviz text, piece by piece. Thread: any. */
LAO_API void lao_graph_print(const lao_module *const *modules, uint32_t module_count,
                             void (*write)(void *user, const char *text), void *user);

/* -----------------------------------------------------------------------------------------------------------
 * backends */

enum {
    LAO_GL_RESTORE = 0 /* leave the host's state as it was */,
    LAO_GL_RESET = 1 /* leave GL's initial state */,
    LAO_GL_DIRTY = 2
};

typedef struct lao_gl_desc {
    void *(*get_proc)(const char *name,
                      void *user); /* required: the loader of the current context */
    double (*now)(void *user);     /* (Optional) seconds; for lao_timings */
    void *user;
    uint32_t state_mode; /* LAO_GL_RESTORE ... */
} lao_gl_desc;

/* Vulkan handles are passed as they are: dispatchable ones as pointers. Enabled on the device:
   dynamicRendering and synchronization2, as core 1.3 or as extensions of 1.2. */
typedef struct lao_vk_desc {
    void *instance, *physical_device, *device; /* VkInstance, VkPhysicalDevice, VkDevice */
    void *(*get_instance_proc)(void *instance,
                               const char *name); /* vkGetInstanceProcAddr; required */
    uint32_t
        api_version; /* VK_MAKE_API_VERSION(...) that instance and device were made for; 0: 1.3 */
    uint32_t queue_family; /* where the host's command buffers are submitted: graphics */
    void *queue; /* (Optional) VkQueue for lao_read; externally synchronised by the host */
    uint32_t frames_in_flight; /* frames recorded before the first of them has finished; 0: 2 */
    uint32_t
        debug_utils; /* non-zero: VK_EXT_debug_utils is enabled; passes and objects get names */
} lao_vk_desc;

/* Writes what it would do as text: for tests and for learning. */
typedef struct lao_null_desc {
    void (*write)(void *user, const char *text); /* NULL: silent */
    void *user;
    uint32_t fail_at;          /* (Tests) the n-th backend call fails; 0: never */
    const lao_shader *shaders; /* (Optional) checked for existence */
    uint32_t shader_count;
} lao_null_desc;

/* Each fills *backend and returns LAO_OK, or says what its desc lacks. The desc is copied. */
LAO_API lao_result lao_gl_backend(const lao_gl_desc *desc, struct lao_backend *backend);
LAO_API lao_result lao_vk_backend(const lao_vk_desc *desc, struct lao_backend *backend);
LAO_API lao_result lao_null_backend(const lao_null_desc *desc, struct lao_backend *backend);

/* --------------------------------------------------------------------------------------------------------
   the plan A frame graph flattened for one structure: no conditions, repeats or names are left.
   Pure data. */

#define LAO_NO_INDEX 0xffffffffu
/* Values of lao_plan_step.reads that are no instances: LAO_READ_BUFFER + index in
 * lao_graph.buffers. */
#define LAO_READ_BUFFER 0xffffff00u
#define LAO_READ_IS_BUFFER(read) ((read) >= LAO_READ_BUFFER && (read) != LAO_NO_INDEX)

typedef enum lao_access {
    LAO_ACCESS_NONE,
    LAO_ACCESS_SAMPLE,
    LAO_ACCESS_COLOR,
    LAO_ACCESS_DEPTH
} lao_access;

/* One (image, level, phase). Its memory is a slot; `slot[1]` is used in odd frames (history images
 * swap). */
typedef struct lao_plan_instance {
    uint32_t image; /* index in lao_graph.images */
    uint32_t level;
    uint32_t phase; /* 0, or 1: the ping-pong or history partner */
    uint32_t width, height;
    lao_format format;
    uint32_t slot[2]; /* LAO_NO_INDEX: imported */
    uint32_t import;  /* index of the frame's import list, LAO_NO_INDEX: ours; the target is
                         LAO_IMPORT_TARGET */
    uint32_t first_step, last_step;
} lao_plan_instance;
#define LAO_IMPORT_TARGET 0xfffffffeu

/* A piece of memory: a texture of this format and size. */
typedef struct lao_plan_slot {
    lao_format format;
    uint32_t width, height;
    uint32_t sampled, attached; /* non-zero: ever read, ever written */
} lao_plan_slot;

typedef struct lao_plan_write {
    uint32_t instance; /* LAO_NO_INDEX: this location is not there */
    uint32_t clear;    /* 1: clear first; 0: keep; 2: do not care */
    float value[4];    /* clear colour, or depth in [0] */
} lao_plan_write;

/* Before the step, the memory of `instance` passes from access `before` to `after`. `before` NONE:
   from the earlier frame, or from the host (imports). The barriers behind the last step give
   imports back: `after` NONE. */
typedef struct lao_plan_barrier {
    uint32_t instance;
    lao_access before, after;
    uint32_t discard; /* non-zero: the old content does not matter */
} lao_plan_barrier;

/* Same rows as lao_step_uniforms of the shared text. */
typedef struct lao_plan_step {
    uint32_t module, pass; /* rows of lao_graph */
    const lao_pass_row *row;
    uint32_t shader; /* index in lao_graph.shader_names */
    uint32_t set;    /* 0 for LAO_SCOPE_FRAME */
    uint32_t level, iteration;
    uint32_t width, height; /* of what is written */
    uint32_t color_count;   /* entries of `colors`, LAO_NO_INDEX holes included */
    lao_plan_write colors[LAO_MAX_WRITES];
    lao_plan_write depth; /* instance LAO_NO_INDEX: no depth attachment */
    uint32_t read_count;
    uint32_t reads[LAO_MAX_READS]; /* instances, LAO_READ_BUFFER + buffer; LAO_NO_INDEX: does not
                                      exist here */
    int32_t constants[LAO_MAX_CONSTANTS]; /* values of the shader's constants for this set */
    uint32_t barrier_first, barrier_count;
    float uniforms[8]; /* lao_step_uniforms */
} lao_plan_step;

typedef struct lao_plan {
    lao_plan_step *steps;
    uint32_t step_count, step_capacity;
    lao_plan_instance *instances;
    uint32_t instance_count, instance_capacity;
    lao_plan_slot *slots;
    uint32_t slot_count, slot_capacity;
    lao_plan_barrier *barriers;
    uint32_t barrier_count, barrier_capacity;
    uint32_t end_barrier_first; /* from here to barrier_count: after the last step */
    uint32_t reverse_depth;     /* the depth test and the clear value are turned round */
    uint32_t serial;            /* grows with every remake; backends compare it */
} lao_plan;

/* All modules of a context, names resolved. */
typedef struct lao_graph {
    const lao_module *const *modules;
    uint32_t module_count;
    const lao_image_row *const *images; /* of all modules */
    uint32_t image_count;
    const lao_pass_row *const *passes; /* of all modules, by stage */
    const uint32_t *pass_modules;
    uint32_t pass_count;
    const char *const *shader_names; /* each once */
    uint32_t shader_count;
    const lao_buffer_row *buffers[LAO_MAX_BUFFERS]; /* of all modules */
    uint32_t buffer_count;
} lao_graph;

typedef struct lao_plan_desc {
    uint32_t width, height; /* of the view */
    uint32_t flags;         /* LAO_VIEW_... */
    uint32_t reverse_depth;
    uint32_t set_count;
    const float *const *values; /* per set: resolved settings of all modules, one after another; at
                                   least one entry */
    const lao_import *imports;
    uint32_t import_count;
    uint32_t has_target;
    uint32_t item_count;                       /* the most that an object has */
    uint32_t further_items[LAO_FURTHER_ITEMS]; /* likewise */
    const uint32_t *buffers;   /* per set: bit i: has lao_graph.buffers[i]; NULL: lines alone */
    uint32_t shared_occlusion; /* LAO_FRAME_SHARED_OCCLUSION */
    const lao_shader *const
        *shaders; /* by index in lao_graph.shader_names; NULL entries allowed without constants */
} lao_plan_desc;

/* Flattens the graph. `plan` is all zero or an earlier plan, whose memory is used again. Pure but
 * for the allocator. */
LAO_API lao_result lao_plan_make(const lao_graph *graph, const lao_plan_desc *desc,
                                 const lao_allocator *allocator, lao_plan *plan);
LAO_API void lao_plan_free(const lao_allocator *allocator, lao_plan *plan);
/* Writes a plan as text, one line a step. Thread: any. */
LAO_API void lao_plan_print(const lao_graph *graph, const lao_plan *plan,
                            void (*write)(void *user, const char *text), void *user);

/* Joins modules into a graph. Free with lao_graph_free. */
LAO_API lao_result lao_graph_make(const lao_module *const *modules, uint32_t module_count,
                                  const lao_allocator *allocator, lao_graph *graph);
LAO_API void lao_graph_free(const lao_allocator *allocator, lao_graph *graph);
/* Proves that every read has an earlier write or an import, no row reads what it writes, every
   image is used, every setting, image and shader named exists, names are unique and every pass
   contributes to an output. Returns 0, or -1 with the first fault in `text`. `shaders` NULL:
   existence of shaders is not checked. Thread: any. */
LAO_API int lao_graph_check(const lao_graph *graph, const lao_shader *shaders,
                            uint32_t shader_count, char *text, size_t text_size);

/* -----------------------------------------------------------------------------------------------------------
   the seam What a backend is. See docs/porting.md. Functions return LAO_OK or log one item and
   return its result. */

typedef struct lao_backend_caps {
    uint32_t max_image_size;    /* px */
    uint32_t max_texture_units; /* textures one stage can read */
    uint32_t max_buffer_texels; /* longest texel buffer */
    const lao_shader *shaders;  /* lineao_shaders.h and what it takes */
    uint32_t shader_count;
} lao_backend_caps;

/* What a backend says, with the name, of a shader that is not there. */
#define LAO_NO_SHADER                                                                              \
    "%s: there is no such shader; a module's file of shaders (sdfvessel_shaders.h, ...) must lie " \
    "beside lineao_shaders.h"

/* What the core lends to its backend from attach to detach. */
typedef struct lao_host {
    lao_allocator allocator; /* both functions filled */
    void (*report)(void *context, lao_log_item item, const char *detail); /* logs one item */
    void *context;
    const lao_graph *graph;
    uint32_t settings_size; /* bytes of one set's settings block: a multiple of 16 */
} lao_host;

typedef struct lao_buffer_desc {
    lao_format format; /* RGBA32F, R32F or RGBA8 */
    uint32_t texel_count;
    const void *data;
} lao_buffer_desc;

/* Segments that begin at about the same time: texels first .. first + count - 1 of the buffer
   "#order" hold their numbers. */
typedef struct lao_group {
    float begin, end; /* ms: the earliest and the latest time of their points */
    uint32_t first, count;
} lao_group;

#define LAO_PARTS 4 /* in which many lines are drawn, each as many as those before (about) */

/* What one draw reads and how much it draws: an object, or a stretch of a line set that fits one
   texel buffer (segment s reads texels s .. s + 3). */
typedef struct lao_chunk {
    void
        *buffers[LAO_MAX_BUFFERS]; /* backend buffers by index in lao_graph.buffers; NULL: absent */
    uint32_t count;                /* segments; triangles */
    uint32_t ends[LAO_PARTS];      /* behind the last segment of each part */
    const lao_group *groups;       /* in order of time; NULL: the lines have no times */
    uint32_t group_count;
} lao_chunk;

/* The times that a set shows: |t - now| <= length (ms), to the nearest repetition (period > 0). */
typedef struct lao_window {
    int limited; /* 0: everything */
    float now, length, period;
} lao_window;

typedef struct lao_draw {
    const lao_chunk *chunks; /* of the lines */
    uint32_t chunk_count;
    lao_window window;       /* of the lines */
    int parted;              /* they are drawn in parts; not with a window */
    const lao_chunk *object; /* NULL: none */
} lao_draw;

typedef struct lao_execution {
    const lao_plan *plan;
    uint32_t parity;            /* which of slot[2] */
    const void *frame_uniforms; /* lao_frame_uniforms */
    uint32_t frame_size;        /* its bytes */
    const void *set_uniforms; /* blocks of lao_host.settings_size bytes: set * graph.module_count +
                                 module */
    const lao_draw *draws;    /* per set; see lao_step_draws */
    uint32_t set_count;       /* at least 1; lao_occlude has one set without chunks */
    const lao_import *imports;
    uint32_t import_count;
    lao_image target; /* not present: steps that write it were dropped */
    uint32_t flags;   /* LAO_FRAME_... */
    void *commands;
} lao_execution;

/* The draws of a step, one chunk each: returns how many. A full-screen step has one, whose chunk
   holds the buffers of the set's object. Thread: any. */
LAO_API uint32_t lao_step_draws(const lao_execution *execution, const lao_plan_step *step,
                                const lao_chunk **chunks);

/* A stretch of a draw: vertices of segments first .. first + count - 1. `next` is lao_step_range's
   own. */
typedef struct lao_range {
    uint32_t first, count, next;
} lao_range;
/* Turns `range`, all zero at first, into the next stretch of a chunk that a step which draws lines
   draws; returns 0 when there is none left. A row that reads "#order" leaves out the groups
   that the set's window does not reach; any other draws all segments. Thread: any. */
LAO_API int lao_step_range(const lao_execution *execution, const lao_plan_step *step,
                           const lao_chunk *chunk, lao_range *range);

typedef struct lao_backend {
    uint32_t abi; /* LAO_BACKEND_ABI */
    const char *name;
    uint64_t storage[32]; /* the backend's copy of its desc */
    /* Makes the backend's own state `self` (from host->allocator) and fills caps. `host` lives
     * until detach. */
    lao_result (*attach)(const struct lao_backend *backend, const lao_host *host, void **self,
                         lao_backend_caps *caps);
    void (*detach)(void *self);
    lao_result (*buffer_create)(void *self, const lao_buffer_desc *desc, void **buffer);
    void (*buffer_destroy)(void *self, void *buffer); /* frames under way keep it */
    lao_result (*view_create)(void *self, void **view);
    void (*view_destroy)(void *self, void *view); /* frames under way keep it */
    /* Makes textures, framebuffers and programs for a plan; called again when the plan's serial
       changed. Of programs that no view needs any more the last LAO_SPARE_PROGRAMS stay. After a
       failure the view is empty and may be prepared again. */
    lao_result (*view_prepare)(void *self, void *view, const lao_plan *plan,
                               const lao_shader *const *shaders);
    lao_result (*execute)(void *self, void *view, const lao_execution *execution);
    /* Raw texels of a slot, row 0 first, tightly packed. */
    lao_result (*read)(void *self, void *view, const lao_plan *plan, uint32_t slot, void *data,
                       size_t size);
    /* Milliseconds per step of the last execution with timings. */
    lao_result (*timings)(void *self, void *view, double *milliseconds, uint32_t step_count);
} lao_backend;

#ifdef __cplusplus
}
#endif

/* -------------------------------------------------------------------------------------------------------
   shared text From here to LAO_SHARED_END the text is C99, C++11 and GLSL at once: amalgamate.sh
   puts its bytes in front of every shader, so that what the tests prove is what the GPU runs. Only
   + - * /, sqrt, floor, abs, min, max, comparisons and integers; every expression of several
   operations is assigned to an LAO_EXACT local, so that no compiler may contract or reorder it: C,
   OpenGL and Vulkan agree to the bit (docs/algorithm.md, "Bit-equal"). */
/* LAO_SHARED_BEGIN */
#ifndef LAO_GLSL
#ifndef __cplusplus
#include <stdbool.h>
#endif
#define LAO_FN static inline
#define LAO_EXACT
#define LAO_F(x) ((float)(x))
#define LAO_U(x) ((uint32_t)(x))
#define LAO_I(x) ((int32_t)(x))
typedef uint32_t lao_uint;
typedef int32_t lao_int;
typedef struct lao_v2 {
    float x, y;
} lao_v2;
typedef struct lao_v3 {
    float x, y, z;
} lao_v3;
typedef struct lao_v4 {
    float x, y, z, w;
} lao_v4;
LAO_FN lao_v2 lao_v2_make(float x, float y) {
    lao_v2 v;
    v.x = x;
    v.y = y;
    return v;
}
LAO_FN lao_v3 lao_v3_make(float x, float y, float z) {
    lao_v3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
LAO_FN lao_v4 lao_v4_make(float x, float y, float z, float w) {
    lao_v4 v;
    v.x = x;
    v.y = y;
    v.z = z;
    v.w = w;
    return v;
}
LAO_FN float lao_sqrt(float x) {
    return sqrtf(x);
}
LAO_FN float lao_floor(float x) {
    return floorf(x);
}
LAO_FN float lao_abs(float x) {
    return fabsf(x);
}
LAO_FN float lao_min(float a, float b) {
    return b < a ? b : a;
}
LAO_FN float lao_max(float a, float b) {
    return a < b ? b : a;
}
LAO_FN float lao_bits_float(lao_uint u) {
    union {
        uint32_t u;
        float f;
    } b;
    b.u = u;
    return b.f;
}
LAO_FN lao_uint lao_float_bits(float f) {
    union {
        uint32_t u;
        float f;
    } b;
    b.f = f;
    return b.u;
}
#else
#define LAO_FN
#ifdef LAO_PRECISE
#define LAO_EXACT precise
#else
#define LAO_EXACT
#endif
#define LAO_F(x) float(x)
#define LAO_U(x) uint(x)
#define LAO_I(x) int(x)
#define lao_uint uint
#define lao_int int
#define lao_v2 vec2
#define lao_v3 vec3
#define lao_v4 vec4
#define lao_v2_make vec2
#define lao_v3_make vec3
#define lao_v4_make vec4
#define lao_sqrt sqrt
#define lao_floor floor
#define lao_abs abs
#define lao_min min
#define lao_max max
#define lao_bits_float uintBitsToFloat
#define lao_float_bits floatBitsToUint
#endif

/* A matrix as its four columns. */
struct lao_m4 {
    lao_v4 x, y, z, w;
};
#ifndef LAO_GLSL
typedef struct lao_m4 lao_m4;
#endif

/* Per frame. Rows of four floats only, so that std140 and C lay them out alike. */
struct lao_frame_uniforms {
    lao_m4 view;       /* world to canonical view space */
    lao_m4 projection; /* canonical view space to clip space */
    lao_m4 world;      /* canonical view space to world */
    lao_v4 ray; /* view slope of a pixel centre: x = ray.x * px + ray.z, y = ray.y * py + ray.w */
    lao_v4 viewport; /* supersampled width, height, 1 / width, 1 / height */
    lao_v4 depth; /* z0, 1 / (z1 - z0) of the scene sphere; z1 - z0; 1 for an orthographic camera */
    lao_v4 scale; /* pixels per unit of NDC slope: W/2 * P00, H/2 * P11; 1 for reverse depth; time
                     in ms */
    lao_v4 unproject;     /* canonical window depth d to view depth z: (x + y d) / (z + w d) */
    lao_v4 background;    /* premultiplied */
    lao_v4 target;        /* target width, height; 1: flip rows; 1: decode sRGB */
    lao_v4 host_depth;    /* size of the host's depth image; 1: flip rows; depth differences times w
                             are in depth_unit */
    lao_m4 previous_view; /* of the view's last frame */
    lao_m4 previous_projection;
    lao_v4 history; /* frames for which LAO_IMAGE_HISTORY images have been written; 0: they hold
                       nothing yet */
};
/* Per step of the plan. */
struct lao_step_uniforms {
    lao_v4 size;   /* width, height of what is written; level; iteration */
    lao_v4 source; /* width, height of the first image read; set; number of levels of the first
                      image written */
};
#ifndef LAO_GLSL
typedef struct lao_frame_uniforms lao_frame_uniforms;
typedef struct lao_step_uniforms lao_step_uniforms;
#endif

#define LAO_TURN 6.28318531f
#define LAO_GHOST_TIME 3.0e38f /* w of a point buffer texel that is no point of a line */

/* ---- vectors: explicit order of evaluation */
LAO_FN lao_v3 lao_v3_add(lao_v3 a, lao_v3 b) {
    return lao_v3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}
LAO_FN lao_v3 lao_v3_sub(lao_v3 a, lao_v3 b) {
    return lao_v3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}
LAO_FN lao_v3 lao_v3_scale(lao_v3 a, float s) {
    return lao_v3_make(a.x * s, a.y * s, a.z * s);
}
LAO_FN float lao_v2_dot(lao_v2 a, lao_v2 b) {
    LAO_EXACT float r = a.x * b.x + a.y * b.y;
    return r;
}
LAO_FN float lao_v3_dot(lao_v3 a, lao_v3 b) {
    LAO_EXACT float r = a.x * b.x + a.y * b.y + a.z * b.z;
    return r;
}
LAO_FN lao_v3 lao_v3_cross(lao_v3 a, lao_v3 b) {
    LAO_EXACT float x = a.y * b.z - a.z * b.y;
    LAO_EXACT float y = a.z * b.x - a.x * b.z;
    LAO_EXACT float z = a.x * b.y - a.y * b.x;
    return lao_v3_make(x, y, z);
}
/* a + b s */
LAO_FN lao_v3 lao_v3_along(lao_v3 a, lao_v3 b, float s) {
    LAO_EXACT float x = a.x + b.x * s;
    LAO_EXACT float y = a.y + b.y * s;
    LAO_EXACT float z = a.z + b.z * s;
    return lao_v3_make(x, y, z);
}
/* Unit vector of v, or `otherwise` when v is shorter than 1e-12. */
LAO_FN lao_v3 lao_v3_unit(lao_v3 v, lao_v3 otherwise) {
    LAO_EXACT float length2 = lao_v3_dot(v, v);
    if (!(length2 > 1.0e-24f)) {
        return otherwise;
    }
    LAO_EXACT float inverse = 1.0f / lao_sqrt(length2);
    return lao_v3_scale(v, inverse);
}
LAO_FN lao_v3 lao_transform(lao_m4 m, lao_v3 p) {
    LAO_EXACT float x = m.x.x * p.x + m.y.x * p.y + m.z.x * p.z + m.w.x;
    LAO_EXACT float y = m.x.y * p.x + m.y.y * p.y + m.z.y * p.z + m.w.y;
    LAO_EXACT float z = m.x.z * p.x + m.y.z * p.y + m.z.z * p.z + m.w.z;
    return lao_v3_make(x, y, z);
}
LAO_FN lao_v4 lao_project(lao_m4 m, lao_v3 p) {
    LAO_EXACT float x = m.x.x * p.x + m.y.x * p.y + m.z.x * p.z + m.w.x;
    LAO_EXACT float y = m.x.y * p.x + m.y.y * p.y + m.z.y * p.z + m.w.y;
    LAO_EXACT float z = m.x.z * p.x + m.y.z * p.y + m.z.z * p.z + m.w.z;
    LAO_EXACT float w = m.x.w * p.x + m.y.w * p.y + m.z.w * p.z + m.w.w;
    return lao_v4_make(x, y, z, w);
}

/* ---- elementary functions: minimax polynomials, each tested against double precision */
LAO_FN float lao_clamp01(float x) {
    return lao_min(lao_max(x, 0.0f), 1.0f);
}
/* h(x) = 3 x^2 - 2 x^3 on [0, 1] (Koehler 2017, Eq. 6) */
LAO_FN float lao_hermite(float x) {
    LAO_EXACT float t = lao_clamp01(x);
    LAO_EXACT float r = t * t * (3.0f - 2.0f * t);
    return r;
}
/* cos(2 pi t), t in turns; absolute error below 3e-7 for |t| < 16 */
LAO_FN float lao_cos_turns(float t) {
    LAO_EXACT float a = 0.25f - lao_abs(t - lao_floor(t + 0.5f));
    LAO_EXACT float s = a * a;
    LAO_EXACT float r =
        a * (6.28318528f +
             s * (-41.3416807f + s * (81.6024851f + s * (-76.5813965f + s * 39.7616174f))));
    return r;
}
LAO_FN float lao_sin_turns(float t) {
    return lao_cos_turns(t - 0.25f);
}
/* 2^x for x in [-126, 127], clamped outside; relative error below 3e-7 */
LAO_FN float lao_exp2(float x) {
    LAO_EXACT float c = lao_min(lao_max(x, -126.0f), 127.0f);
    LAO_EXACT float n = lao_floor(c + 0.5f);
    LAO_EXACT float f = c - n;
    LAO_EXACT float p =
        1.0f + f * (0.693147207f +
                    f * (0.240226515f +
                         f * (0.0555032722f +
                              f * (0.00961799451f + f * (0.00134004317f + f * 0.000154780225f)))));
    LAO_EXACT float r = p * lao_bits_float(LAO_U(LAO_I(n) + 127) << 23u);
    return r;
}
/* log2(x) for normal x > 0; absolute error below 3e-7 + 1e-7 |result|. x <= 0: -127 */
LAO_FN float lao_log2(float x) {
    if (!(x >= 1.17549435e-38f)) {
        return -127.0f;
    }
    lao_uint bits = lao_float_bits(x);
    lao_int exponent = LAO_I((bits >> 23u) & 255u) - 127;
    LAO_EXACT float m = lao_bits_float((bits & 8388607u) | 1065353216u);
    if (m > 1.41421356f) {
        m = m * 0.5f;
        exponent = exponent + 1;
    }
    LAO_EXACT float f = m - 1.0f;
    LAO_EXACT float p =
        f *
        (1.442695f +
         f * (-0.721347199f +
              f * (0.48091028f +
                   f * (-0.360716264f +
                        f * (0.287939095f +
                             f * (-0.23867568f +
                                  f * (0.215212249f + f * (-0.208933813f + f * 0.1292643f))))))));
    LAO_EXACT float r = p + LAO_F(exponent);
    return r;
}
/* atan2(y, x) in (-pi, pi]; atan2(0, 0) = 0; absolute error below 5e-7 */
LAO_FN float lao_atan2(float y, float x) {
    LAO_EXACT float ax = lao_abs(x);
    LAO_EXACT float ay = lao_abs(y);
    LAO_EXACT float large = lao_max(ax, ay);
    if (!(large > 0.0f)) {
        return 0.0f;
    }
    LAO_EXACT float t = lao_min(ax, ay) / large;
    LAO_EXACT float s = t * t;
    LAO_EXACT float r =
        t * (0.999999986f +
             s * (-0.33333094f +
                  s * (0.199930542f +
                       s * (-0.142071342f +
                            s * (0.106546796f +
                                 s * (-0.0753368101f +
                                      s * (0.0430394294f +
                                           s * (-0.0162830477f + s * 0.00290356285f))))))));
    if (ay > ax) {
        r = 1.57079633f - r;
    }
    if (x < 0.0f) {
        r = 3.14159265f - r;
    }
    if (y < 0.0f) {
        r = -r;
    }
    return r;
}
/* acos(x), x clamped to [-1, 1]; absolute error below 1e-6 */
LAO_FN float lao_acos(float x) {
    LAO_EXACT float c = lao_min(lao_max(x, -1.0f), 1.0f);
    LAO_EXACT float s = (1.0f - c) * (1.0f + c);
    return lao_atan2(lao_sqrt(s), c);
}
/* The least x whose power n is at least 2^-100. */
LAO_FN float lao_power_least(lao_int n) {
    return lao_exp2(-100.0f / LAO_F(n > 0 ? n : 1));
}
/* x^n, 0 <= n < 1024, by repeated squaring; x: 0, or lao_power_least to 1 */
LAO_FN float lao_squarings(float x, lao_int n) {
    LAO_EXACT float r = 1.0f;
    LAO_EXACT float b = x;
    lao_int m = n;
    for (lao_int i = 0; i < 10; i = i + 1) {
        if ((m & 1) != 0) {
            r = r * b;
        }
        b = b * b;
        m = m >> 1;
    }
    return r;
}
/* x^n, 0 <= x <= 1, 0 <= n < 1024; results below 2^-100 are 0, because denormal numbers on the way
   to them cost a CPU more than all the rest */
LAO_FN float lao_power(float x, lao_int n) {
    return lao_squarings(x < lao_power_least(n) ? 0.0f : x, n);
}

/* ---- noise: counter-based, so that a pixel's value depends on nothing but its coordinates */
LAO_FN lao_uint lao_hash(lao_uint v) {
    lao_uint state = v * 747796405u + 2891336453u;
    lao_uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}
/* [0, 1), 24 bits */
LAO_FN float lao_unit_float(lao_uint v) {
    LAO_EXACT float r = LAO_F(v >> 8u) * 5.96046448e-8f;
    return r;
}
/* Unit vector from two numbers in [0, 1): uniform on the sphere. */
LAO_FN lao_v3 lao_sphere_point(float u, float v) {
    LAO_EXACT float z = 1.0f - 2.0f * u;
    LAO_EXACT float r = lao_sqrt(lao_max(1.0f - z * z, 0.0f));
    LAO_EXACT float x = r * lao_cos_turns(v);
    LAO_EXACT float y = r * lao_sin_turns(v);
    return lao_v3_make(x, y, z);
}
/* The unit vector N of a pixel at which the sample directions are mirrored (METHODS 1.6). */
LAO_FN lao_v3 lao_pixel_noise(lao_uint x, lao_uint y) {
    lao_uint h = lao_hash(x + lao_hash(y));
    return lao_sphere_point(lao_unit_float(h), lao_unit_float(lao_hash(h ^ 2654435769u)));
}
/* Sample direction i of `count` on level `level`: a spherical Fibonacci set, turned per level, from
   both ends in turn, so that neighbours share the products of their z. */
LAO_FN lao_v3 lao_sample_direction(lao_uint level, lao_uint i, lao_uint count) {
    lao_uint j = (i & 1u) == 0u ? i >> 1u : count - 1u - (i >> 1u);
    LAO_EXACT float u = (LAO_F(j) + 0.5f) / LAO_F(count);
    LAO_EXACT float v = lao_unit_float(j * 2654435769u + level * 1640531527u);
    return lao_sphere_point(u, v);
}
/* Samples of a level: max(1, round(samples / (level + 1))) */
LAO_FN lao_uint lao_sample_count(lao_uint samples, lao_uint level) {
    lao_uint n = (2u * samples + level + 1u) / (2u * (level + 1u));
    return n < 1u ? 1u : n;
}

/* ---- texels */
/* Cosine and sine of the double angle to the paper's alpha = |t.x| (Eq. 10) and its validity. */
LAO_FN lao_v2 lao_axial_alpha(lao_v2 axial) {
    LAO_EXACT float length2 = lao_v2_dot(axial, axial);
    if (!(length2 > 0.25f)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float alpha = lao_sqrt(lao_max(0.5f + 0.5f * axial.x, 0.0f));
    return lao_v2_make(alpha, 1.0f);
}
/* A mean of axial vectors as a direction; (0, 0) where they cancel. */
LAO_FN lao_v2 lao_axial_unit(lao_v2 mean) {
    LAO_EXACT float length2 = lao_v2_dot(mean, mean);
    if (!(length2 > 1.0e-4f)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float c = mean.x / lao_sqrt(length2);
    LAO_EXACT float s = mean.y / lao_sqrt(length2);
    return lao_v2_make(c, s);
}
/* Mean of alpha times validity, and of validity, as alpha and validity. */
LAO_FN lao_v2 lao_alpha_mean(lao_v2 mean) {
    if (!(mean.y > 0.0f)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float alpha = mean.x / mean.y;
    return lao_v2_make(alpha, mean.y);
}
/* Components in [-1, 1] to [0, 1] and back. */
LAO_FN lao_v3 lao_signed_pack(lao_v3 v) {
    LAO_EXACT float x = v.x * 0.5f + 0.5f;
    LAO_EXACT float y = v.y * 0.5f + 0.5f;
    LAO_EXACT float z = v.z * 0.5f + 0.5f;
    return lao_v3_make(x, y, z);
}
LAO_FN lao_v3 lao_signed_unpack(lao_v4 texel) {
    LAO_EXACT float x = texel.x * 2.0f - 1.0f;
    LAO_EXACT float y = texel.y * 2.0f - 1.0f;
    LAO_EXACT float z = texel.z * 2.0f - 1.0f;
    return lao_v3_make(x, y, z);
}

#define LAO_ALIGN_ROTATION 0
#define LAO_ALIGN_PAPER 1
#define LAO_ALIGN_NONE 2
/* What a sample of the occlusion reads of a level is one word: nearness in bits 0 - 19 (depth 1 is
   1, depth 0 is LAO_LEVEL_NEAREST; 0: nothing is covered), in bit 20 whether a direction is known,
   the direction in bits 21 - 31: 1/2048 of a half turn, so that differences of words wrap as
   directions do; in the paper's alignment 1/2047 of alpha. */
#define LAO_LEVEL_NEAREST 1048575u
#define LAO_LEVEL_KNOWN 1048576u
#define LAO_LEVEL_TURN 4292870144u /* the bits of the direction */
#define LAO_LEVEL_STEPS 1048574.0f /* between depth 0 and 1 */
/* A covered texel; direction: cosine and sine of the double angle, or alpha and its validity. */
LAO_FN lao_uint lao_level_pack(float depth, lao_v2 direction, lao_int align) {
    LAO_EXACT float q = lao_floor(lao_clamp01(depth) * LAO_LEVEL_STEPS + 0.5f);
    lao_uint word = LAO_LEVEL_NEAREST - LAO_U(q > 0.0f ? lao_min(q, LAO_LEVEL_STEPS) : 0.0f);
    if (align == LAO_ALIGN_ROTATION && lao_v2_dot(direction, direction) > 0.25f) {
        LAO_EXACT float turn = lao_floor(lao_atan2(direction.y, direction.x) * 325.949323f + 0.5f);
        word = word | LAO_LEVEL_KNOWN | (LAO_U(LAO_I(turn)) << 21u);
    }
    if (align == LAO_ALIGN_PAPER && direction.y > 0.5f) {
        LAO_EXACT float alpha = lao_floor(lao_clamp01(direction.x) * 2047.0f + 0.5f);
        word = word | LAO_LEVEL_KNOWN | (LAO_U(alpha) << 21u);
    }
    return word;
}
LAO_FN bool lao_level_known(lao_uint word) {
    return (word & LAO_LEVEL_KNOWN) != 0u;
}
/* In [0, 1]; 1 where nothing is covered. */
LAO_FN float lao_level_depth(lao_uint word) {
    LAO_EXACT float d =
        LAO_F(LAO_I(LAO_LEVEL_NEAREST - (word & LAO_LEVEL_NEAREST))) / LAO_LEVEL_STEPS;
    return lao_min(d, 1.0f);
}
/* The two numbers of lao_level_pack; (0, 0) where no direction is known. */
LAO_FN lao_v2 lao_level_direction(lao_uint word, lao_int align) {
    if (!lao_level_known(word)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float code = LAO_F(LAO_I(word >> 21u));
    if (align == LAO_ALIGN_PAPER) {
        return lao_v2_make(code / 2047.0f, 1.0f);
    }
    LAO_EXACT float turn = code * 0.00048828125f;
    return lao_v2_make(lao_cos_turns(turn), lao_sin_turns(turn));
}
/* How much nearer than `centre` a texel is, in steps of depth. */
LAO_FN float lao_level_nearer(lao_uint centre, lao_uint word) {
    return LAO_F(LAO_I(word & LAO_LEVEL_NEAREST) - LAO_I(centre & LAO_LEVEL_NEAREST));
}

/* ---- pyramid (METHODS 1.10) */
/* A texel of the sums: two numbers of the direction, covered texels of level 0 below it, depth. */
struct lao_level_sum {
    float x, y, depth, weight, covered;
    lao_v3 tangent;
};
#ifndef LAO_GLSL
typedef struct lao_level_sum lao_level_sum;
#endif
LAO_FN lao_level_sum lao_level_sum_start(lao_v3 zero) {
    lao_level_sum sum;
    sum.x = 0.0f;
    sum.y = 0.0f;
    sum.depth = 0.0f;
    sum.weight = 0.0f;
    sum.covered = 0.0f;
    sum.tangent = zero;
    return sum;
}
/* Stencil [1 3 3 1] / 8 at child -1 .. 2 of a texel. */
LAO_FN float lao_gauss_weight(lao_int child) {
    return child == 0 || child == 1 ? 0.375f : 0.125f;
}
/* Adds a child; its tangent is turned to the side of those before it. */
LAO_FN lao_level_sum lao_level_sum_add(lao_level_sum sum, lao_v4 child, lao_v3 tangent,
                                       float stencil) {
    lao_level_sum r = sum;
    LAO_EXACT float w = stencil * child.z;
    LAO_EXACT float x = sum.x + w * child.x;
    LAO_EXACT float y = sum.y + w * child.y;
    LAO_EXACT float d = sum.depth + w * child.w;
    LAO_EXACT float side = lao_v3_dot(sum.tangent, tangent) < 0.0f ? -w : w;
    r.x = x;
    r.y = y;
    r.depth = d;
    r.weight = sum.weight + w;
    r.covered = sum.covered + 4.0f * w;
    r.tangent = lao_v3_along(sum.tangent, tangent, side);
    return r;
}
/* Nothing covered: direction 0, depth 1 (far). */
LAO_FN lao_v4 lao_level_sum_mean(lao_level_sum sum) {
    if (!(sum.weight > 0.0f)) {
        return lao_v4_make(0.0f, 0.0f, 0.0f, 1.0f);
    }
    LAO_EXACT float x = sum.x / sum.weight;
    LAO_EXACT float y = sum.y / sum.weight;
    LAO_EXACT float d = sum.depth / sum.weight;
    return lao_v4_make(x, y, sum.covered, d);
}

/* A texel of level 0 as a child of level 1. */
LAO_FN lao_v4 lao_level_child(lao_uint word, lao_int align) {
    lao_v2 direction = lao_level_direction(word, align);
    LAO_EXACT float covered = (word & LAO_LEVEL_NEAREST) != 0u ? 1.0f : 0.0f;
    return lao_v4_make(direction.x, direction.y, covered, lao_level_depth(word));
}
/* What a sample reads of a mean. */
LAO_FN lao_uint lao_level_word(lao_v4 mean, lao_int align) {
    lao_v2 direction = lao_v2_make(mean.x, mean.y);
    if (!(mean.z > 0.0f)) {
        return 0u;
    }
    if (align == LAO_ALIGN_ROTATION) {
        direction = lao_axial_unit(direction);
    }
    if (align == LAO_ALIGN_PAPER) {
        direction = lao_alpha_mean(direction);
    }
    return lao_level_pack(mean.w, direction, align);
}

/* ---- camera */
/* View depth (mm along the view axis) to the depth that occlusion compares: 0..1 over the scene
 * sphere (METHODS 1.3). */
LAO_FN float lao_scene_depth(lao_v4 depth, float z) {
    LAO_EXACT float d = (z - depth.x) * depth.y;
    return lao_clamp01(d);
}
LAO_FN float lao_view_depth(lao_v4 depth, float scene_depth) {
    LAO_EXACT float z = depth.x + scene_depth * depth.z;
    return z;
}
/* Slope (perspective) or position (orthographic) of the view ray through a pixel centre; px = ix +
 * 0.5. */
LAO_FN lao_v2 lao_pixel_slope(lao_v4 ray, float px, float py) {
    LAO_EXACT float x = ray.x * px + ray.z;
    LAO_EXACT float y = ray.y * py + ray.w;
    return lao_v2_make(x, y);
}
/* The view ray through a pixel centre in the world, from the eye (orthographic: from the eye's
   plane): a point and a unit vector. Choices, no branch: lavapipe compiles a pass anew in every
   frame for a branch that depends on uniforms alone. */
LAO_FN lao_v3 lao_ray_origin(lao_m4 world, lao_v2 slope, float orthographic) {
    bool flat_view = orthographic > 0.5f;
    lao_v3 plane = lao_transform(world, lao_v3_make(slope.x, slope.y, 0.0f));
    return lao_v3_make(flat_view ? plane.x : world.w.x, flat_view ? plane.y : world.w.y,
                       flat_view ? plane.z : world.w.z);
}
LAO_FN lao_v3 lao_ray_direction(lao_m4 world, lao_v2 slope, float orthographic) {
    lao_v2 s = orthographic > 0.5f ? lao_v2_make(0.0f, 0.0f) : slope;
    LAO_EXACT float x = world.x.x * s.x + world.y.x * s.y - world.z.x;
    LAO_EXACT float y = world.x.y * s.x + world.y.y * s.y - world.z.y;
    LAO_EXACT float z = world.x.z * s.x + world.y.z * s.y - world.z.z;
    return lao_v3_unit(lao_v3_make(x, y, z), lao_v3_make(0.0f, 0.0f, -1.0f));
}
/* Unit vector from the surface at that pixel towards the eye: the direction of the head light. */
LAO_FN lao_v3 lao_towards_eye(lao_v2 slope, float orthographic) {
    lao_v3 axis = lao_v3_make(0.0f, 0.0f, 1.0f);
    bool flat_view = orthographic > 0.5f;
    return lao_v3_unit(lao_v3_make(flat_view ? 0.0f : -slope.x, flat_view ? 0.0f : -slope.y, 1.0f),
                       axis);
}
/* Pixels per mm at view position p across the direction o (METHODS 1.4): Eq. 14 in pixels,
 * aspect-correct, xy only. */
LAO_FN float lao_zoom(lao_m4 projection, lao_v4 viewport, lao_v3 p, lao_v3 o) {
    lao_v4 a = lao_project(projection, p);
    lao_v4 b = lao_project(projection, lao_v3_add(p, o));
    LAO_EXACT float aw = lao_max(lao_abs(a.w), 1.0e-6f);
    LAO_EXACT float bw = lao_max(lao_abs(b.w), 1.0e-6f);
    LAO_EXACT float x = 0.5f * viewport.x * (b.x / bw - a.x / aw);
    LAO_EXACT float y = 0.5f * viewport.y * (b.y / bw - a.y / aw);
    LAO_EXACT float r = lao_sqrt(x * x + y * y);
    return r;
}

/* Pixels per mm from depth alone, for a host's G-buffer without zoom: exact on the view axis. */
LAO_FN float lao_pixel_zoom(lao_v4 scale, lao_v4 depth, float scene_depth) {
    LAO_EXACT float z = lao_max(lao_view_depth(depth, scene_depth), 1.0e-6f);
    LAO_EXACT float r = lao_abs(scale.y) / (depth.w > 0.5f ? 1.0f : z);
    return r;
}

/* ---- lines (METHODS 1.2, 2.8) */
/* Where one end of a segment puts its two corners: p + along -/+ across. */
struct lao_line_end {
    lao_v3 across, along, tangent, normal;
    float square; /* 1: ends square, half a width beyond the joint; 0: at it, or mitred */
    float seen;   /* length of `own` across the view */
};
#ifndef LAO_GLSL
typedef struct lao_line_end lao_line_end;
#endif
/* e: direction of view at the end point; own, other: the segment's and its neighbour's vector in
   the line's direction (other = 0: no neighbour); outward: +1 at the segment's end, -1 at its
   start. Turns up to 90 degrees as seen share mitred corners; sharper ones, and mitres longer than
   half a segment, end square, half a width beyond the joint, so that the two ends cover the wedge
   between them. */
LAO_FN lao_line_end lao_line_join(lao_v3 e, lao_v3 own, lao_v3 other, float half_width,
                                  float outward) {
    lao_line_end end;
    lao_v3 ray = lao_v3_unit(e, lao_v3_make(0.0f, 0.0f, -1.0f));
    lao_v3 right = lao_v3_make(1.0f, 0.0f, 0.0f);
    lao_v3 own_cross = lao_v3_cross(ray, lao_v3_unit(own, right));
    lao_v3 other_cross = lao_v3_cross(ray, lao_v3_unit(other, lao_v3_make(0.0f, 0.0f, 0.0f)));
    lao_v3 o = lao_v3_unit(own_cross, right);
    LAO_EXACT float own_length2 = lao_v3_dot(own_cross, own_cross);
    LAO_EXACT float other_length2 = lao_v3_dot(other_cross, other_cross);
    if (own_length2 < 1.0e-12f) {
        o = right;
    }
    end.normal = o;
    end.across = lao_v3_scale(o, half_width);
    end.along = lao_v3_make(0.0f, 0.0f, 0.0f);
    end.tangent = lao_v3_unit(own, right);
    end.square = 0.0f;
    LAO_EXACT float seen = lao_sqrt(own_length2 * lao_v3_dot(own, own));
    end.seen = seen;
    if (other_length2 > 1.0e-12f) {
        lao_v3 n = lao_v3_unit(other_cross, o);
        LAO_EXACT float c = lao_v3_dot(o, n);
        LAO_EXACT float reach2 = half_width * half_width * (1.0f - c) / lao_max(1.0f + c, 1.0e-6f);
        LAO_EXACT float shorter =
            lao_min(own_length2 * lao_v3_dot(own, own), other_length2 * lao_v3_dot(other, other));
        if (own_length2 >= 1.0e-12f && (c >= 0.87f || (c >= 0.0f && 4.0f * reach2 <= shorter))) {
            LAO_EXACT float s = half_width / (1.0f + c);
            end.across = lao_v3_scale(lao_v3_add(o, n), s);
            end.tangent = lao_v3_unit(lao_v3_add(own, other), end.tangent);
        } else {
            end.along = lao_v3_scale(lao_v3_cross(o, ray), half_width * outward);
            end.square = 1.0f;
        }
    }
    return end;
}
/* n = (T x L) x T, the line normal that faces the light L (Zoeckler 1996); any normal where the
 * line is seen end-on. */
LAO_FN lao_v3 lao_line_normal(lao_v3 t, lao_v3 l) {
    LAO_EXACT float tl = lao_v3_dot(t, l);
    lao_v3 n = lao_v3_along(l, t, -tl);
    LAO_EXACT float length2 = lao_v3_dot(n, n);
    if (!(length2 > 1.0e-12f)) {
        lao_v3 up = lao_v3_make(0.0f, 1.0f, 0.0f);
        LAO_EXACT float tu = lao_v3_dot(t, up);
        return lao_v3_unit(lao_v3_along(up, t, -tu), lao_v3_make(1.0f, 0.0f, 0.0f));
    }
    LAO_EXACT float inverse = 1.0f / lao_sqrt(length2);
    return lao_v3_scale(n, inverse);
}
/* The line's direction on the screen as an axial vector (cos 2a, sin 2a), (0, 0) when it is seen
   end-on (METHODS 2.1, 2.3): the projection of the view-space tangent, exact at every pixel.
   `scale` is lao_frame_uniforms.scale. */
LAO_FN lao_v2 lao_screen_axial(lao_v3 t, lao_v2 slope, lao_v4 scale, float orthographic) {
    LAO_EXACT float k = orthographic > 0.5f ? 0.0f : t.z;
    LAO_EXACT float x = (t.x + slope.x * k) * scale.x;
    LAO_EXACT float y = (t.y + slope.y * k) * scale.y;
    LAO_EXACT float length2 = x * x + y * y;
    LAO_EXACT float least = 1.0e-8f * scale.y * scale.y;
    if (!(length2 > least)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float c = (x * x - y * y) / length2;
    LAO_EXACT float s = 2.0f * x * y / length2;
    return lao_v2_make(c, s);
}

/* ---- segments hidden behind others */
/* Half the size (px, each way) of what a ball of radius r (mm) around p covers, at most: seen in
   perspective x / w is bent by r / w for its own sake and by |x / w| r / w for that of w. scale:
   lao_frame_uniforms.scale. Not positive where the ball reaches behind the eye. */
LAO_FN lao_v2 lao_ball_size(lao_v3 p, float r, lao_v4 scale, float orthographic) {
    LAO_EXACT float w = orthographic > 0.5f ? 1.0f : -p.z - r;
    LAO_EXACT float sx = orthographic > 0.5f ? 1.0f : 1.0f + lao_abs(p.x / p.z);
    LAO_EXACT float sy = orthographic > 0.5f ? 1.0f : 1.0f + lao_abs(p.y / p.z);
    LAO_EXACT float x = lao_abs(scale.x) * r * sx / w;
    LAO_EXACT float y = lao_abs(scale.y) * r * sy / w;
    return lao_v2_make(x, y);
}
/* Is a fragment at least as deep as `near` behind all of `far`? By several times what
   interpolation takes from a depth of 1, where clip depth is [-w, w] too. */
LAO_FN bool lao_behind(float near, float far, float reversed) {
    LAO_EXACT float behind = reversed > 0.5f ? far - near : near - far;
    return behind > 2.0e-5f;
}

/* ---- halos (METHODS 3; Koehler 2017, 4.3; Everts 2009) */
#define LAO_HALO_NONE 0
#define LAO_HALO_UNIFORM 1
#define LAO_HALO_DEPTH 2
#define LAO_HALO_SQRT 0
#define LAO_HALO_LINEAR 1
#define LAO_HALO_SQUARE 2
#define LAO_HALO_HARD 0
#define LAO_HALO_SOFT 1
/* What a corner of a segment gives the fragments to tell how far out they are: x = -1 .. 1 across
   the line; y, z: how far beyond the end and the start of the segment, in half widths, so that a
   square end has a border as the sides have; a mitred or open one has none, as it ends at 0.
   length: of the segment as seen, in half widths. */
LAO_FN lao_v3 lao_rim_corner(float side, bool at_end, float square, float length) {
    LAO_EXACT float beyond = -length - square;
    return lao_v3_make(side, at_end ? square : beyond, at_end ? beyond : square);
}
/* A place x, seen from a joint where two segments end square, in half widths of the neighbour,
   which leaves in the line's direction (outward: 1) or comes from there (-1): across it, and how
   far beyond its end. Far outside where the ends are not square. */
LAO_FN lao_v2 lao_rim_neighbour(lao_v3 x, lao_v3 e, lao_v3 other, float half_width, float outward,
                                float square) {
    if (square < 0.5f) {
        return lao_v2_make(2.0f, 2.0f);
    }
    lao_v3 right = lao_v3_make(1.0f, 0.0f, 0.0f);
    lao_v3 ray = lao_v3_unit(e, lao_v3_make(0.0f, 0.0f, -1.0f));
    lao_v3 o = lao_v3_unit(lao_v3_cross(ray, lao_v3_unit(other, right)), right);
    LAO_EXACT float across = lao_v3_dot(x, o) / half_width;
    LAO_EXACT float along = -outward * lao_v3_dot(x, lao_v3_cross(o, ray)) / half_width;
    return lao_v2_make(across, along);
}
/* The outline of two ribbons that overlap at a joint is that of their union. */
LAO_FN float lao_rim_union(float s, lao_v2 neighbour) {
    return lao_min(s, lao_max(lao_abs(neighbour.x), neighbour.y));
}
/* 0 in the middle of a line, 1 at its outline. */
LAO_FN float lao_rim(lao_v3 rim) {
    float s = lao_abs(rim.x);
    s = rim.y > s ? rim.y : s;
    return rim.z > s ? rim.z : s;
}
/* Where the border begins. */
LAO_FN float lao_halo_begin(float width, lao_int halo) {
    LAO_EXACT float begin = 1.0f - (halo == LAO_HALO_DEPTH ? 2.0f * width : width);
    return begin;
}
/* The light that a fragment keeps: all of it inside, none in a hard border. */
LAO_FN float lao_halo_light(float s, float begin, lao_int border) {
    LAO_EXACT float t = (1.0f - s) / lao_max(1.0f - begin, 1.0e-6f);
    LAO_EXACT float soft = t * t;
    return s < begin ? 1.0f : (border == LAO_HALO_SOFT ? soft : 0.0f);
}
/* The alpha of the G-buffer's colour: covered (at least 1/2), and the light kept in 128 steps, by
   which highlights are dimmed as the colour is. */
LAO_FN float lao_light_pack(float light) {
    LAO_EXACT float alpha = 0.501960784f + 0.498039216f * light; /* (128 + 127 light) / 255 */
    return alpha;
}
LAO_FN float lao_light_unpack(float alpha) {
    LAO_EXACT float light = (255.0f * alpha - 128.0f) / 127.0f;
    return lao_clamp01(light);
}
/* How far back a fragment is moved, in parts of the largest displacement: 0 inside, f(s) in the
   border (f_displacement). */
LAO_FN float lao_halo_displacement(float s, float begin, lao_int function) {
    LAO_EXACT float square = s * s;
    float f = function == LAO_HALO_SQRT ? lao_sqrt(s) : (function == LAO_HALO_LINEAR ? s : square);
    return s < begin ? 0.0f : f;
}
/* Depth buffer value of view depth z: the inverse of lao_frame_uniforms.unproject. */
LAO_FN float lao_window_depth(lao_v4 unproject, float z) {
    LAO_EXACT float d = (unproject.x - z * unproject.z) / (z * unproject.w - unproject.y);
    return d;
}
/* Depth buffer value of a fragment moved back to view depth z, reversed or not: never so far that
   the cleared buffer would hide it. */
LAO_FN float lao_halo_depth(lao_v4 unproject, float z) {
    float d = lao_window_depth(unproject, z);
    d = d < 0.99999994f ? d : 0.99999994f;
    return d > 1.0e-30f ? d : 1.0e-30f;
}

/* ---- trails (METHODS 2.7, 9.1; Koehler 2017, 4.1; Lawonn 2014, 5.2) */
#define LAO_TRAIL_NONE 0
#define LAO_TRAIL_TAPER 1
#define LAO_TRAIL_OPACITY 2
#define LAO_TRAIL_HIGHLIGHT 3
/* The time of the frame within its period; itself where there is none. */
LAO_FN float lao_trail_now(float time, float period) {
    LAO_EXACT float now = time - period * lao_floor(time / period);
    return period > 0.0f ? now : time;
}
/* What to take from t - now to bring it nearest to 0: whole periods. */
LAO_FN float lao_trail_shift(float t, float now, float period) {
    LAO_EXACT float shift = period * lao_floor((t - now) / period + 0.5f);
    return period > 0.0f ? shift : 0.0f;
}
/* |t - now|, to the nearest repetition. */
LAO_FN float lao_trail_distance(float t, float now, float period) {
    LAO_EXACT float distance = lao_abs(t - now - lao_trail_shift(t, now, period));
    return distance;
}
/* The part of a segment, 0 .. 1 from its start to its end, that a trail covers; first >= last:
   none. */
struct lao_trail_part {
    float first, last;
};
#ifndef LAO_GLSL
typedef struct lao_trail_part lao_trail_part;
#endif
/* t1, t2: times of the segment's ends; |t - now| <= length is covered, to the nearest repetition of
   the segment's middle. */
LAO_FN lao_trail_part lao_trail_clip(float t1, float t2, float now, float length, float period) {
    lao_trail_part part;
    LAO_EXACT float middle = 0.5f * t1 + 0.5f * t2;
    float shift = lao_trail_shift(middle, now, period);
    LAO_EXACT float a = t1 - now - shift;
    LAO_EXACT float b = t2 - now - shift;
    part.first = 0.0f;
    part.last = 1.0f;
    if (period > 0.0f && 2.0f * length >= period) {
        return part;
    }
    if (!(lao_min(a, b) <= length && lao_max(a, b) >= -length)) {
        part.last = 0.0f;
        return part;
    }
    if (lao_abs(a) > length) {
        LAO_EXACT float u = ((a < 0.0f ? -length : length) - a) / (b - a);
        part.first = lao_clamp01(u);
    }
    if (lao_abs(b) > length) {
        LAO_EXACT float u = ((b < 0.0f ? -length : length) - a) / (b - a);
        part.last = lao_clamp01(u);
    }
    return part;
}
/* Width of a trail at q = |t - now| / length: 1 up to `start`, then falling to `least` at 1, 0
   beyond. */
LAO_FN float lao_trail_width(float q, float start, float least) {
    LAO_EXACT float width = 1.0f - (1.0f - least) * lao_max(q - start, 0.0f) / (1.0f - start);
    return q <= 1.0f ? width : 0.0f;
}
/* Opacity of the fade that tapering replaces: 1 up to `start`, then falling to 0 at 1. */
LAO_FN float lao_trail_opacity(float q, float start) {
    return lao_trail_width(q, start, 0.0f);
}
/* Least opacity that is drawn at a pixel, (n + 1/2) / 16: an ordered pattern of 4 x 4 in which each
   2 x 2 has a quarter, so that supersampling averages it. */
LAO_FN float lao_screen_door(lao_uint x, lao_uint y) {
    lao_uint d = x ^ y;
    lao_uint n = ((d & 1u) << 3u) | ((y & 1u) << 2u) | (d & 2u) | ((y >> 1u) & 1u);
    LAO_EXACT float least = (LAO_F(n) + 0.5f) * 0.0625f;
    return least;
}
/* Brightness of a line at |t - now|: exp(-distance^2 / beta), clamped to [1/4, 1]. */
LAO_FN float lao_trail_highlight(float distance, float beta) {
    LAO_EXACT float x = -1.44269504f * distance * distance / beta;
    return lao_max(lao_exp2(x), 0.25f);
}
/* The colour half-way to the grey of its luminance. */
LAO_FN lao_v3 lao_desaturate(lao_v3 color) {
    LAO_EXACT float grey = 0.2126f * color.x + 0.7152f * color.y + 0.0722f * color.z;
    LAO_EXACT float x = 0.5f * color.x + 0.5f * grey;
    LAO_EXACT float y = 0.5f * color.y + 0.5f * grey;
    LAO_EXACT float z = 0.5f * color.z + 0.5f * grey;
    return lao_v3_make(x, y, z);
}

/* ---- occlusion (METHODS 1.5 - 1.9, 2.3 - 2.5) */
#define LAO_LIGHT_PAPER 0
#define LAO_LIGHT_AUTHOR 1
#define LAO_PYRAMID_BOX 0
#define LAO_SHOW_PICTURE 0
#define LAO_SHOW_OCCLUSION 1
#define LAO_SHOW_VISIBILITY 2
#define LAO_SHOW_DEPTH 3
#define LAO_SHOW_LIGHT 4
#define LAO_SHOW_ALIGNMENT 5
#define LAO_SHOW_VISIBILITY_DEPTH 6
#define LAO_SHOW_VISIBILITY_DEPTH_LIGHT 7
#define LAO_SHOW_COLOR 8
#define LAO_COLOR_MULTIPLY 0
#define LAO_COLOR_LUMINANCE_PRESERVING 1
/* Which factors a sample's weight is made of: all of them, or what the setting `show` singles out
 * (Fig. 4). */
LAO_FN bool lao_uses_visibility(lao_int show) {
    return show != LAO_SHOW_DEPTH && show != LAO_SHOW_LIGHT && show != LAO_SHOW_ALIGNMENT;
}
LAO_FN bool lao_uses_depth(lao_int show) {
    return show != LAO_SHOW_VISIBILITY && show != LAO_SHOW_LIGHT && show != LAO_SHOW_ALIGNMENT;
}
LAO_FN bool lao_uses_light(lao_int show) {
    return show <= LAO_SHOW_OCCLUSION || show == LAO_SHOW_LIGHT ||
           show >= LAO_SHOW_VISIBILITY_DEPTH_LIGHT;
}
LAO_FN bool lao_uses_alignment(lao_int show) {
    return show <= LAO_SHOW_OCCLUSION || show == LAO_SHOW_ALIGNMENT || show == LAO_SHOW_COLOR;
}

/* delta(l) = density (1 - l / levels)^2 (Eq. 7, corrected) */
LAO_FN float lao_depth_reach(float density, lao_uint level, lao_uint levels) {
    LAO_EXACT float t = 1.0f - LAO_F(level) / LAO_F(levels);
    LAO_EXACT float r = density * t * t;
    return r;
}
/* Eq. 5: 1 below delta 0, 0 beyond reach; `beyond` delta 0. slope: lao_depth_weight_slope. It is
   1 - h(t) with t stretched by the cube root of 2, which takes h's factors away. */
LAO_FN float lao_depth_weight_beyond(float beyond, float slope) { /* of beyond >= 0 */
    LAO_EXACT float steep = slope * 1.25992095f;
    LAO_EXACT float t = lao_min(beyond * steep, 1.25992095f);
    LAO_EXACT float r = 1.0f + t * t * (t - 1.88988161f);
    return r;
}
LAO_FN float lao_depth_weight(float beyond, float slope) {
    return lao_depth_weight_beyond(lao_max(beyond, 0.0f), slope);
}
/* 1 / (reach - delta 0); steep enough for a step where reach does not exceed delta 0. */
LAO_FN float lao_depth_weight_slope(float reach, float threshold) {
    LAO_EXACT float width = lao_max(reach - threshold, 1.0e-20f);
    LAO_EXACT float slope = 1.0f / width;
    return slope;
}
/* What the normal and the reflected light of a pixel are scaled by, so that their cosines to omega
   carry the light's parts: I k_d n.l (not 0, whose products would have no sign), and the root of
   I k_s that the exponent takes back. */
LAO_FN float lao_light_diffuse(float intensity, float diffuse, float nl) {
    LAO_EXACT float scale = lao_max(intensity * diffuse * nl, 1.0e-20f);
    return scale;
}
LAO_FN float lao_light_specular(float intensity, float specular, lao_int exponent) {
    LAO_EXACT float scale = intensity * specular;
    return scale > 0.0f ? lao_exp2(lao_log2(scale) / LAO_F(exponent)) : 0.0f;
}
/* Eq. 8 and 9 with the receiver's cosine: I k_d (n.l)(n.omega), and the root of the specular part
   (below 0 counts as 0) */
LAO_FN float lao_light_weight(float diffuse, float root, lao_int exponent) {
    float shine = lao_squarings(lao_max(root, lao_power_least(exponent)), exponent);
    LAO_EXACT float g = 1.0f - lao_min(diffuse + shine, 1.0f);
    return g;
}
/* The light form of the author's program: 1.5 - max(omega.n, 0)(spec + diff), the reflection at the
   occluder, whose normal faces omega; l: towards the eye (METHODS 1.8). */
LAO_FN float lao_light_weight_author(lao_v3 omega, float n_omega, lao_v3 occluder, lao_v3 l,
                                     lao_int exponent) {
    if (!(lao_v3_dot(occluder, occluder) > 0.25f)) {
        return 1.5f;
    }
    lao_v3 t = lao_v3_unit(occluder, lao_v3_make(1.0f, 0.0f, 0.0f));
    lao_v3 n = lao_line_normal(t, omega);
    lao_v3 h = lao_v3_unit(lao_v3_add(l, omega), n);
    LAO_EXACT float diffuse = lao_max(lao_v3_dot(n, l), 0.0f);
    LAO_EXACT float specular = lao_power(lao_max(lao_v3_dot(h, n), 0.0f), exponent);
    LAO_EXACT float g = lao_max(1.5f - n_omega * (specular + diffuse), 0.0f);
    return g;
}
/* Difference of direction x in [0, 1], 1 - |t.t'|, of two words with directions; absolute error
   below 1e-5 besides that of the steps. */
LAO_FN float lao_axial_difference(lao_uint a, lao_uint b) {
    LAO_EXACT float t = LAO_F(LAO_I((a & LAO_LEVEL_TURN) - (b & LAO_LEVEL_TURN))) * 2.40889417e-10f;
    LAO_EXACT float s = t * t;
    LAO_EXACT float x = s * (4.60955151f + s * (s - 3.52867133f));
    return x;
}
/* Eq. 10 as printed: x = ||t.x| - |t'.x|| */
LAO_FN float lao_alpha_difference(lao_uint a, lao_uint b) {
    LAO_EXACT float x = lao_abs(LAO_F(LAO_I(a >> 21u) - LAO_I(b >> 21u))) / 2047.0f;
    return x;
}
/* Eq. 11 for a difference in [0, 1]: I h(x), at most 1, at least A0 */
LAO_FN float lao_align_weight(float difference, float intensity, float least) {
    LAO_EXACT float triple = 3.0f * intensity;
    LAO_EXACT float twice = 2.0f * intensity;
    LAO_EXACT float g = difference * difference * (triple - twice * difference);
    return lao_max(lao_min(g, 1.0f), least);
}

/* What a pixel needs for all samples of one level: the mirror at N and the radius folded into three
   vectors, so that omega.x r, omega.y r and omega.n are one dot product each with the literal
   direction. */
struct lao_sampler {
    lao_v3 x, y, n, r; /* rows: offset in texels of the level, normal, reflected light */
    lao_v2 centre;     /* pixel centre in texels of the level */
    lao_v2 own;        /* the texel that it lies in */
};
#ifndef LAO_GLSL
typedef struct lao_sampler lao_sampler;
#endif
/* v mirrored at the plane of N: dot(R, mirror(v, N)) = dot(mirror(R, N), v) */
LAO_FN lao_v3 lao_mirror(lao_v3 v, lao_v3 n) {
    LAO_EXACT float t = -2.0f * lao_v3_dot(v, n);
    return lao_v3_along(v, n, t);
}
/* radius in pixels of the finest level; texel = 1 / 2^level */
LAO_FN lao_sampler lao_sampler_make(lao_v3 noise, lao_v3 normal, lao_v3 reflected, float radius,
                                    float texel, float px, float py) {
    lao_sampler s;
    LAO_EXACT float scale = lao_max(radius * texel, 1.5f);
    s.x = lao_v3_scale(lao_mirror(lao_v3_make(1.0f, 0.0f, 0.0f), noise), scale);
    s.y = lao_v3_scale(lao_mirror(lao_v3_make(0.0f, 1.0f, 0.0f), noise), scale);
    s.n = lao_mirror(normal, noise);
    s.r = lao_mirror(reflected, noise);
    s.centre = lao_v2_make(px * texel, py * texel);
    s.own = lao_v2_make(lao_floor(s.centre.x), lao_floor(s.centre.y));
    return s;
}
/* v, its sign turned round where `side` is the sign bit. */
LAO_FN float lao_turned(float v, lao_uint side) {
    return lao_bits_float(lao_float_bits(v) ^ side);
}
/* One sample: texel (x, y) of the level and its centre in [0, 1], cosines to normal and reflection,
   the side that omega was turned to, whether it counts (not outside the image, not the centre's own
   texel). inverse: 1 / width, 1 / height of the level. */
struct lao_tap {
    lao_v2 at;
    float x, y, n_omega, r_omega;
    lao_uint side;
    bool counts;
};
#ifndef LAO_GLSL
typedef struct lao_tap lao_tap;
#endif
LAO_FN lao_tap lao_tap_make(lao_sampler s, lao_v3 direction, lao_v2 inverse) {
    lao_tap tap;
    LAO_EXACT float c = lao_v3_dot(direction, s.n);
    lao_uint side = lao_float_bits(c) & 2147483648u;
    LAO_EXACT float x = lao_floor(s.centre.x + lao_turned(lao_v3_dot(direction, s.x), side));
    LAO_EXACT float y = lao_floor(s.centre.y + lao_turned(lao_v3_dot(direction, s.y), side));
    LAO_EXACT float u = (x + 0.5f) * inverse.x;
    LAO_EXACT float v = (y + 0.5f) * inverse.y;
    /* both in [0, 1): the bits of less than 1, and no sign */
    bool inside = lao_float_bits(u) < 1065353216u && lao_float_bits(v) < 1065353216u;
    tap.counts = inside && (x != s.own.x || y != s.own.y);
    tap.side = side;
    tap.n_omega = lao_abs(c);
    tap.r_omega = lao_turned(lao_v3_dot(direction, s.r), side);
    tap.at = lao_v2_make(u, v);
    tap.x = x;
    tap.y = y;
    return tap;
}
/* Radius of a level in pixels of the finest (METHODS 1.4): zoom (factor width + level step). */
LAO_FN float lao_sample_radius(float zoom, float factor, float width, float step, lao_uint level) {
    LAO_EXACT float r = zoom * (factor * width + LAO_F(level) * step);
    return r;
}

/* ---- shading (METHODS 1.2, 1.8, 1.9): Phong with a head light, then all of it times 1 - occlusion
 */
LAO_FN lao_v3 lao_shade(lao_v3 color, lao_v3 t, lao_v3 l, float ambient, float diffuse,
                        float specular, lao_int exponent, float occlusion) {
    lao_v3 n = lao_line_normal(t, l);
    LAO_EXACT float nl = lao_max(lao_v3_dot(n, l), 0.0f);
    LAO_EXACT float rl = lao_max(2.0f * nl * nl - 1.0f, 0.0f);
    LAO_EXACT float body = ambient + diffuse * nl;
    LAO_EXACT float shine = specular * lao_power(rl, exponent);
    LAO_EXACT float light = 1.0f - lao_clamp01(occlusion);
    LAO_EXACT float x = (color.x * body + shine) * light;
    LAO_EXACT float y = (color.y * body + shine) * light;
    LAO_EXACT float z = (color.z * body + shine) * light;
    return lao_v3_make(lao_clamp01(x), lao_clamp01(y), lao_clamp01(z));
}
/* Display value to linear light (sRGB), for targets that encode on write. */
LAO_FN float lao_srgb_decode(float v) {
    if (v <= 0.04045f) {
        return v / 12.92f;
    }
    return lao_exp2(2.4f * lao_log2((v + 0.055f) / 1.055f));
}
/* Linear light to display value (sRGB). */
LAO_FN float lao_srgb_encode(float v) {
    if (v <= 0.0031308f) {
        return 12.92f * v;
    }
    LAO_EXACT float r = 1.055f * lao_exp2(lao_log2(v) / 2.4f) - 0.055f;
    return r;
}
/* What shading may take from the chroma of a color: the fifth that stays keeps its hue. */
#define LAO_FADE 0.8f
/* The same light as lao_shade, shown without a change of luminance: the darker it is, the more of
   the color's chroma gives way to the grey of the same luminance. So a color map whose lightness
   or hue tells the value stays readable (Koehler 2017, 5.2). No highlight. */
LAO_FN lao_v3 lao_shade_luminance(lao_v3 color, lao_v3 t, lao_v3 l, float ambient, float diffuse,
                                  float occlusion) {
    lao_v3 n = lao_line_normal(t, l);
    LAO_EXACT float nl = lao_max(lao_v3_dot(n, l), 0.0f);
    LAO_EXACT float body = lao_clamp01(ambient + diffuse * nl);
    LAO_EXACT float light = body * (1.0f - lao_clamp01(occlusion));
    LAO_EXACT float keep = 1.0f - LAO_FADE * (1.0f - light);
    float r = lao_srgb_decode(color.x);
    float g = lao_srgb_decode(color.y);
    float b = lao_srgb_decode(color.z);
    LAO_EXACT float grey = 0.2126f * r + 0.7152f * g + 0.0722f * b;
    LAO_EXACT float x = grey + keep * (r - grey);
    LAO_EXACT float y = grey + keep * (g - grey);
    LAO_EXACT float z = grey + keep * (b - grey);
    LAO_EXACT float red = lao_srgb_encode(x);
    LAO_EXACT float green = lao_srgb_encode(y);
    LAO_EXACT float blue = lao_srgb_encode(z);
    return lao_v3_make(lao_clamp01(red), lao_clamp01(green), lao_clamp01(blue));
}
/* Sum of `count` premultiplied samples over a premultiplied background. */
LAO_FN lao_v4 lao_over(lao_v4 sum, float count, lao_v4 background) {
    LAO_EXACT float w = sum.w / count;
    LAO_EXACT float through = 1.0f - w;
    LAO_EXACT float x = sum.x / count + background.x * through;
    LAO_EXACT float y = sum.y / count + background.y * through;
    LAO_EXACT float z = sum.z / count + background.z * through;
    LAO_EXACT float a = w + background.w * through;
    return lao_v4_make(x, y, z, a);
}
/* LAO_SHARED_END */

#endif /* LINEAO_H */

#ifdef LINEAO_IMPLEMENTATION
#ifndef LINEAO_IMPLEMENTATION_DONE
#define LINEAO_IMPLEMENTATION_DONE

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef LAO_ASSERT
#define LAO_ASSERT(condition) ((void)0)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ================================================================================================
 * tables of the module */
// clang-format off
#define LAO__NOTHING {NULL, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__READ(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__READ_FINER(image) {image, LAO_LEVEL_FINER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__READ_LEVEL(image, level) {image, LAO_LEVEL_INDEX, level, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__READ_COARSE(image) LAO__READ_LEVEL(image, 1), LAO__READ_LEVEL(image, 2), LAO__READ_LEVEL(image, 3), LAO__READ_LEVEL(image, 4), \
                                LAO__READ_LEVEL(image, 5), LAO__READ_LEVEL(image, 6), LAO__READ_LEVEL(image, 7)
#define LAO__READ_ALL(image) LAO__READ_LEVEL(image, 0), LAO__READ_COARSE(image)
#define LAO__CLEAR(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_CLEAR}
#define LAO__KEEP(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_KEEP}
#define LAO__WRITE(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__OTHER(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD}
#define LAO__WRITE_LEVEL(image, level) {image, LAO_LEVEL_INDEX, level, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__WRITE_ABOVE(image, level) {image, LAO_LEVEL_SAME, level, LAO_PHASE_THIS, LAO_LOAD_DISCARD} /* LAO_REPEAT_LEVELS_UP */
#define LAO__UNKNOWN 0.501960784f /* no tangent: 128 of 255, about 0 */
#define LAO__ALWAYS {{NULL, 0, 0}}
#define LAO__ANY {NULL, 0, 0}
#define LAO__LINES {"#points", '>', 0} /* sets of objects alone have nothing to draw or to shade here */

static const lao_image_row lao__images[] = {
    /* name          format              size           w  h  levels    flags             encoding               clear         when                                    channels */
    {"host_depth",    LAO_FORMAT_HOST,    LAO_SIZE_VIEW, 0, 0, NULL,     LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {NULL, NULL, NULL, NULL}},
    {"target",        LAO_FORMAT_HOST,    LAO_SIZE_VIEW, 0, 0, NULL,     LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {NULL, NULL, NULL, NULL}},
    {"color",         LAO_FORMAT_RGBA8,   LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {"color.R", "color.G", "color.B", "mask.V"}},
    {"tangent",       LAO_FORMAT_RGBA16F, LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {"tangent.X", "tangent.Y", "tangent.Z", "zoom.V"}},
    {"depth",         LAO_FORMAT_R32F,    LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {1, 1, 1, 1}, LAO__ANY,                               {"depth.Z", NULL, NULL, NULL}},
    {"zbuffer",       LAO_FORMAT_D32F,    LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {1, 0, 0, 0}, LAO__ANY,                               {NULL, NULL, NULL, NULL}},
    {"far_tiles",     LAO_FORMAT_R32F,    LAO_SIZE_FULL, 0, 0, "*",      0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, {"cull_hidden", '>', 0},                {NULL, NULL, NULL, NULL}},
    {"far",           LAO_FORMAT_R32F,    LAO_SIZE_FULL, 0, 0, "*",      0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, {"cull_hidden", '>', 0},                {NULL, NULL, NULL, NULL}},
    {"tensor",        LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "levels", 0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, {"occlusion", '=', 1},                  {NULL, NULL, NULL, NULL}},
    {"level",         LAO_FORMAT_R32UI,   LAO_SIZE_FULL, 0, 0, "levels", 0,                LAO_ENCODING_LEVEL,   {0, 0, 0, 0}, {"occlusion", '=', 1},                  {"axial%d.C", "axial%d.S", "axial%d.D", NULL}},
    {"level_tangent", LAO_FORMAT_RGBA8,   LAO_SIZE_FULL, 0, 0, "levels", 0,                LAO_ENCODING_SIGNED8, {LAO__UNKNOWN, LAO__UNKNOWN, LAO__UNKNOWN, LAO__UNKNOWN}, {"light", '=', LAO_LIGHT_AUTHOR},       {NULL, NULL, NULL, NULL}},
    {"ao",            LAO_FORMAT_R32F,    LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, {"occlusion", '=', 1},                  {"ao.V", NULL, NULL, NULL}},
    {"shaded",        LAO_FORMAT_RGBA8,   LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {NULL, NULL, NULL, NULL}},
    {"out",           LAO_FORMAT_RGBA8,   LAO_SIZE_VIEW, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {"out.R", "out.G", "out.B", "out.A"}}
};

static const lao_pass_row lao__passes[] = {
    /* the host's depth, so that its objects hide our lines */
    {"import_depth", LAO_PASS_FULLSCREEN, "import_depth", 0, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_ALWAYS, LAO_CULL_NONE, {{"@host_depth", '>', 0}},
     {LAO__WRITE("zbuffer")}, {LAO__READ("host_depth")}},
    /* G-buffer: colour and mask, tangent and zoom, linear depth (METHODS 1.1). One row of four draws a set: what the fragments need to know of the line's
       outline or of a fade costs where there is none, and who writes depth is tested late */
    {"lines", LAO_PASS_DRAW_LINES_FIRST, "lines", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_NONE}, {"trail", '!', LAO_TRAIL_OPACITY}},
     {LAO__CLEAR("color"), LAO__CLEAR("tangent"), LAO__CLEAR("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order")}},
    {"lines_fading", LAO_PASS_DRAW_LINES_FIRST, "lines_rim", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_NONE}, {"trail", '=', LAO_TRAIL_OPACITY}},
     {LAO__CLEAR("color"), LAO__CLEAR("tangent"), LAO__CLEAR("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order")}},
    {"lines_rim", LAO_PASS_DRAW_LINES_FIRST, "lines_rim", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_UNIFORM}},
     {LAO__CLEAR("color"), LAO__CLEAR("tangent"), LAO__CLEAR("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order")}},
    {"lines_halo", LAO_PASS_DRAW_LINES_FIRST, "lines_halo", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_DEPTH}},
     {LAO__CLEAR("color"), LAO__CLEAR("tangent"), LAO__CLEAR("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order")}},
    /* of many lines a part is drawn first; of each further part only what does not lie wholly behind the farthest depth around it */
    {"far_tiles", LAO_PASS_FULLSCREEN, "far", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "cull_hidden", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"@color", '=', 0}},
     {LAO__WRITE_LEVEL("far_tiles", 2)}, {LAO__READ("zbuffer")}},
    {"far", LAO_PASS_FULLSCREEN, "far", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"@color", '=', 0}},
     {LAO__WRITE_LEVEL("far", 2)}, {LAO__READ_LEVEL("far_tiles", 2)}},
    {"lines_rest", LAO_PASS_DRAW_LINES_REST, "lines", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"halo", '=', LAO_HALO_NONE}},
     {LAO__KEEP("color"), LAO__KEEP("tangent"), LAO__KEEP("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order"), LAO__READ_LEVEL("far", 2)}},
    {"lines_rim_rest", LAO_PASS_DRAW_LINES_REST, "lines_rim", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"halo", '=', LAO_HALO_UNIFORM}},
     {LAO__KEEP("color"), LAO__KEEP("tangent"), LAO__KEEP("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order"), LAO__READ_LEVEL("far", 2)}},
    {"lines_halo_rest", LAO_PASS_DRAW_LINES_REST, "lines_halo", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"halo", '=', LAO_HALO_DEPTH}},
     {LAO__KEEP("color"), LAO__KEEP("tangent"), LAO__KEEP("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order"), LAO__READ_LEVEL("far", 2)}},
    /* the host's G-buffer instead of our lines: its mask as depth, for the passes that skip background by it */
    {"cover", LAO_PASS_FULLSCREEN, "cover", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_ALWAYS, LAO_CULL_NONE, {{"@color", '>', 0}},
     {LAO__CLEAR("zbuffer")}, {LAO__READ("color")}},
    /* level 0 of what a sample reads */
    {"level_zero", LAO_PASS_FULLSCREEN, "level_zero", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_COVERED, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__CLEAR("level"), LAO__CLEAR("level_tangent"), LAO__KEEP("zbuffer")},
     {LAO__READ("color"), LAO__READ("tangent"), LAO__READ("depth")}},
    /* coarser levels, and from level 1 on the sums that the next one is made of */
    {"level_one", LAO_PASS_FULLSCREEN, "level_one", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}, {"levels", '>', 1}},
     {LAO__WRITE_LEVEL("tensor", 1), LAO__WRITE_LEVEL("level", 1), LAO__WRITE_LEVEL("level_tangent", 1)},
     {LAO__READ_LEVEL("level", 0), LAO__READ_LEVEL("level_tangent", 0)}},
    {"level_up", LAO_PASS_FULLSCREEN, "level_up", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__WRITE_ABOVE("tensor", 1), LAO__WRITE("level"), LAO__WRITE("level_tangent")},
     {LAO__READ_FINER("tensor"), LAO__READ_FINER("level_tangent")}},
    {"occlusion", LAO_PASS_FULLSCREEN, "occlusion", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_COVERED, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__CLEAR("ao"), LAO__KEEP("zbuffer")},
     {LAO__READ("tangent"), LAO__READ_ALL("level"), LAO__READ_COARSE("level_tangent")}},
    /* for debugging only: shadows leak into what is not shadowed (Koehler 2017, 4.4) */
    {"smooth_x", LAO_PASS_FULLSCREEN, "smooth", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "smoothing", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__OTHER("ao")}, {LAO__READ("ao"), LAO__READ("color")}},
    {"smooth_y", LAO_PASS_FULLSCREEN, "smooth", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "smoothing", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__OTHER("ao")}, {LAO__READ("ao"), LAO__READ("color")}},
    {"shade", LAO_PASS_FULLSCREEN, "shade", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_COVERED, LAO_CULL_NONE, {LAO__LINES},
     {LAO__KEEP("shaded"), LAO__KEEP("zbuffer")}, {LAO__READ("color"), LAO__READ("tangent"), LAO__READ("ao")}},
    /* box filter over the samples of a pixel, and the background */
    {"resolve", LAO_PASS_FULLSCREEN, "resolve", 0, LAO_STAGE_PRESENT, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, LAO__ALWAYS,
     {LAO__WRITE("out")}, {LAO__READ("shaded")}},
    {"present", LAO_PASS_FULLSCREEN, "present", 0, LAO_STAGE_PRESENT, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_OVER, LAO_DEPTH_NONE, LAO_CULL_NONE, {{"@target", '>', 0}},
     {LAO__KEEP("target")}, {LAO__READ("out")}},
    {"export_depth", LAO_PASS_FULLSCREEN, "export_depth", 0, LAO_STAGE_PRESENT, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {{"@host_depth", '>', 1}},
     {LAO__KEEP("host_depth")}, {LAO__READ("zbuffer")}}
};

static const lao_setting_row lao__settings[] = {
#define LAO__ROW(name, type, minimum, maximum, standard, structural, unit, choices, help) \
    {#name, LAO_SETTING_##type, minimum, maximum, standard, structural, unit, choices, help},
    LAO_SETTINGS(LAO__ROW)
#undef LAO__ROW
};

static const lao_preset_row lao__presets[] = {
    {"classic", "align", LAO_ALIGN_NONE},
    {"classic", "strength", 1},
    {"classic", "halo", LAO_HALO_NONE},
    {"paper", "align", LAO_ALIGN_PAPER}
};

static const lao_buffer_row lao__buffers[] = {{"points", LAO_FORMAT_RGBA32F}, {"colors", LAO_FORMAT_RGBA8}, {"order", LAO_FORMAT_R32F}};

static const lao_module lao__lines_module = {
    "lines",
    lao__passes, (uint32_t)(sizeof lao__passes / sizeof lao__passes[0]),
    lao__images, (uint32_t)(sizeof lao__images / sizeof lao__images[0]),
    lao__settings, (uint32_t)(sizeof lao__settings / sizeof lao__settings[0]),
    lao__presets, (uint32_t)(sizeof lao__presets / sizeof lao__presets[0]),
    NULL, 0,
    lao__buffers, (uint32_t)(sizeof lao__buffers / sizeof lao__buffers[0])
};
// clang-format on

const lao_module *lao_lines_module(void) {
    return &lao__lines_module;
}

const lao_pass_row *lao_passes(int *count) {
    if (count) {
        *count = (int)lao__lines_module.pass_count;
    }
    return lao__passes;
}

const char *lao_result_text(lao_result result) {
    static const char *const text[] = {"done",
                                       "invalid argument",
                                       "stale handle",
                                       "out of memory",
                                       "out of device memory",
                                       "unsupported",
                                       "shader refused",
                                       "broken graph",
                                       "graphics library error",
                                       "device lost",
                                       "not ready"};
    return (uint32_t)result < sizeof text / sizeof text[0] ? text[result] : "unknown result";
}

uint32_t lao_format_bytes(lao_format format) {
    static const uint8_t bytes[LAO_FORMAT_COUNT] = {0, 4, 8, 16, 4, 4, 4, 0};
    return (uint32_t)format < LAO_FORMAT_COUNT ? bytes[format] : 0;
}

/* =======================================================================================================
 * small helpers */

static void *lao__default_allocate(void *user, size_t size) {
    (void)user;
    return malloc(size);
}

static void lao__default_release(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}

static lao_allocator lao__allocator_or_default(const lao_allocator *allocator) {
    lao_allocator a;
    memset(&a, 0, sizeof a);
    if (allocator && allocator->allocate && allocator->release) {
        return *allocator;
    }
    a.allocate = lao__default_allocate;
    a.release = lao__default_release;
    return a;
}

/* Zeroed memory for count items; NULL for none, on overflow or when there is no memory. */
static void *lao__new(const lao_allocator *allocator, size_t count, size_t size) {
    void *memory;
    if (count == 0 || count > (size_t)-1 / size) {
        return NULL;
    }
    memory = allocator->allocate(allocator->user, count * size);
    if (memory) {
        memset(memory, 0, count * size);
    }
    return memory;
}

static void lao__delete(const lao_allocator *allocator, void *memory, size_t count, size_t size) {
    if (memory) {
        allocator->release(allocator->user, memory, count * size);
    }
}

/* Makes room for one more item; 0 on success. */
static int lao__grow(const lao_allocator *allocator, void **items, uint32_t count,
                     uint32_t *capacity, size_t size) {
    uint32_t larger;
    void *memory;
    if (count < *capacity) {
        return 0;
    }
    larger = *capacity ? *capacity * 2 : 16;
    memory = lao__new(allocator, larger, size);
    if (!memory) {
        return -1;
    }
    if (*items) {
        memcpy(memory, *items, (size_t)count * size);
        lao__delete(allocator, *items, *capacity, size);
    }
    *items = memory;
    *capacity = larger;
    return 0;
}

static int lao__finite(const float *values, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        if (!(values[i] - values[i] == 0.0f)) {
            return 0;
        }
    }
    return 1;
}

/* ============================================================================================================
 * settings */

int lao_setting_find(const lao_module *module, const char *name) {
    uint32_t i;
    for (i = 0; module && name && i < module->setting_count; i++) {
        if (strcmp(module->settings[i].name, name) == 0) {
            return (int)i;
        }
    }
    return -1;
}

/* Position of `word` (length n) in "a|b|c", or -1. */
static int lao__choice(const char *choices, const char *word, size_t n) {
    int index = 0;
    const char *c = choices;
    while (*c) {
        size_t length = strcspn(c, "|");
        if (length == n && strncmp(c, word, n) == 0) {
            return index;
        }
        c += length;
        if (*c) {
            c++;
        }
        index++;
    }
    return -1;
}

static const float *lao__settings_values(const void *settings) {
    return (const float *)(const void *)((const char *)settings + sizeof(uint64_t));
}

static int lao__setting_given(const void *settings, uint32_t index) {
    uint64_t set;
    if (!settings) {
        return 0;
    }
    memcpy(&set, settings, sizeof set);
    return ((set >> index) & 1) != 0 || lao__settings_values(settings)[index] != 0.0f;
}

static int lao__setting_valid(const lao_setting_row *row, float value) {
    if (!(value >= row->minimum && value <= row->maximum)) {
        return 0;
    }
    return row->type == LAO_SETTING_FLOAT || value == floorf(value);
}

int lao_settings_resolve(const lao_module *module, const void *settings, float *values) {
    uint32_t i;
    int fault = -1;
    int preset = lao_setting_find(module, "preset");
    for (i = 0; i < module->setting_count; i++) {
        values[i] = module->settings[i].standard;
    }
    if (preset >= 0 && lao__setting_given(settings, (uint32_t)preset)) {
        float wanted = lao__settings_values(settings)[preset];
        for (i = 0; i < module->preset_count; i++) {
            const lao_preset_row *row = &module->presets[i];
            if ((float)lao__choice(module->settings[preset].choices, row->preset,
                                   strlen(row->preset)) == wanted) {
                values[lao_setting_find(module, row->setting)] = row->value;
            }
        }
    }
    for (i = 0; i < module->setting_count; i++) {
        if (lao__setting_given(settings, i)) {
            values[i] = lao__settings_values(settings)[i];
        }
        if (fault < 0 && !lao__setting_valid(&module->settings[i], values[i])) {
            fault = (int)i;
        }
    }
    return fault;
}

lao_settings lao_settings_filled(const lao_settings *settings) {
    lao_settings filled;
    float values[LAO_SETTING_COUNT];
    lao_settings_resolve(&lao__lines_module, settings, values);
    filled.set = ((uint64_t)1 << LAO_SETTING_COUNT) - 1;
    memcpy((char *)&filled + sizeof filled.set, values, sizeof values);
    return filled;
}

/* A decimal number without the locale's help: [+-]digits[.digits][e[+-]digits]. Returns the end, or
 * NULL. */
static const char *lao__number(const char *text, double *value) {
    double sign = 1, mantissa = 0, scale = 1;
    int exponent = 0, exponent_sign = 1, digits = 0;
    if (*text == '+' || *text == '-') {
        sign = *text++ == '-' ? -1 : 1;
    }
    for (; *text >= '0' && *text <= '9'; text++, digits++) {
        mantissa = mantissa * 10 + (*text - '0');
    }
    if (*text == '.') {
        for (text++; *text >= '0' && *text <= '9'; text++, digits++) {
            scale /= 10;
            mantissa += scale * (*text - '0');
        }
    }
    if (digits && (*text == 'e' || *text == 'E')) {
        text++;
        if (*text == '+' || *text == '-') {
            exponent_sign = *text++ == '-' ? -1 : 1;
        }
        digits = 0;
        for (; *text >= '0' && *text <= '9' && exponent < 1000; text++, digits++) {
            exponent = exponent * 10 + (*text - '0');
        }
    }
    *value = sign * mantissa * pow(10.0, (double)(exponent_sign * exponent));
    return digits ? text : NULL;
}

int lao_setting_parse(const lao_module *module, int setting, const char *text, void *settings) {
    const lao_setting_row *row;
    double number = 0;
    float value;
    uint64_t set;
    int choice;
    const char *end;
    if (!module || setting < 0 || (uint32_t)setting >= module->setting_count || !text ||
        !settings) {
        return -1;
    }
    row = &module->settings[setting];
    choice = row->type == LAO_SETTING_ENUM ? lao__choice(row->choices, text, strlen(text)) : -1;
    if (row->type == LAO_SETTING_BOOL) {
        choice = lao__choice("false|true", text, strlen(text));
        choice = choice < 0 ? lao__choice("off|on", text, strlen(text)) : choice;
        choice = choice < 0 ? lao__choice("no|yes", text, strlen(text)) : choice;
    }
    if (choice >= 0) {
        value = (float)choice;
    } else {
        end = lao__number(text, &number);
        if (!end || *end) {
            return -1;
        }
        value = (float)number;
    }
    if (!lao__setting_valid(row, value)) {
        return -1;
    }
    memcpy((char *)settings + sizeof set + (size_t)setting * sizeof value, &value, sizeof value);
    memcpy(&set, settings, sizeof set);
    set |= (uint64_t)1 << setting;
    memcpy(settings, &set, sizeof set);
    return 0;
}

/* ==============================================================================================================
 * camera */

static double lao__determinant3(const double m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

int lao_camera_canonical(const lao_camera *camera, lao_camera *canonical) {
    double p[4][4], v[4][4], linear[3][3]; /* [row][column] */
    int r, c;
    if (!lao__finite(camera->view, 16) || !lao__finite(camera->projection, 16)) {
        return -1;
    }
    for (r = 0; r < 4; r++) {
        for (c = 0; c < 4; c++) {
            p[r][c] = camera->projection[c * 4 + r];
            v[r][c] = camera->view[c * 4 + r];
        }
    }
    /* The shaders' view rays know no shear: rows (a 0 b 0), (0 d e 0), (0 0 g h), (0 0 +-1 0), or
       (a 0 0 c), (0 d 0 f), (0 0 g h), (0 0 0 1). */
    if (p[0][1] != 0 || p[1][0] != 0 || p[2][0] != 0 || p[2][1] != 0 || p[3][0] != 0 ||
        p[3][1] != 0 || p[0][p[3][2] == 0 ? 2 : 3] != 0 || p[1][p[3][2] == 0 ? 2 : 3] != 0 ||
        (p[3][2] == 0) == (p[3][3] == 0) || p[0][0] == 0 || p[1][1] == 0 ||
        p[2][2] * p[3][3] == p[2][3] * p[3][2]) {
        return -1;
    }
    for (c = 0; c < 4; c++) {
        if (camera->flags & LAO_CAMERA_FLIP_Y) {
            p[1][c] = -p[1][c];
        }
        if (!(camera->flags & LAO_CAMERA_ZERO_TO_ONE)) {
            p[2][c] = 0.5 * (p[2][c] + p[3][c]);
        }
    }
    /* Left-handed: the eye looks along +z. Turn z round in both matrices. For an orthographic
       projection the sign of the depth row tells: unreversed depth must grow along -z. */
    {
        int reverse = (camera->flags & LAO_CAMERA_REVERSE_DEPTH) != 0;
        int left = p[3][2] != 0 ? p[3][2] > 0 : ((p[2][2] / p[3][3] > 0) != reverse);
        double w = p[3][2] != 0 ? fabs(p[3][2]) : p[3][3];
        for (r = 0; r < 4; r++) {
            if (left) {
                p[r][2] = -p[r][2];
                v[2][r] = -v[2][r];
            }
        }
        for (r = 0; r < 4; r++) {
            for (c = 0; c < 4; c++) {
                p[r][c] /= w;
            }
        }
    }
    for (r = 0; r < 3; r++) {
        for (c = 0; c < 3; c++) {
            linear[r][c] = v[r][c];
        }
    }
    if (!(fabs(lao__determinant3((const double(*)[3])linear)) > 1e-30) || v[3][0] != 0 ||
        v[3][1] != 0 || v[3][2] != 0 || v[3][3] != 1) {
        return -1;
    }
    for (r = 0; r < 4; r++) {
        for (c = 0; c < 4; c++) {
            canonical->projection[c * 4 + r] = (float)p[r][c];
            canonical->view[c * 4 + r] = (float)v[r][c];
        }
    }
    canonical->flags = LAO_CAMERA_ZERO_TO_ONE | (camera->flags & LAO_CAMERA_REVERSE_DEPTH);
    return 0;
}

/* ===============================================================================================================
 * graph */

#define LAO__MOST_SETTINGS 64u /* bits of `set` */
#define LAO__BUFFER_MARK '#'
#define LAO__IMPORT_MARK '@'

static uint32_t lao__image_find(const lao_graph *graph, const char *name) {
    uint32_t i;
    for (i = 0; i < graph->image_count; i++) {
        if (strcmp(graph->images[i]->name, name) == 0) {
            return i;
        }
    }
    return LAO_NO_INDEX;
}

/* Index of a buffer by its reference "#name", or LAO_NO_INDEX. */
static uint32_t lao__buffer_find(const lao_graph *graph, const char *reference) {
    uint32_t i;
    for (i = 0; i < graph->buffer_count; i++) {
        if (strcmp(graph->buffers[i]->name, reference + 1) == 0) {
            return i;
        }
    }
    return LAO_NO_INDEX;
}

/* The module that has a setting of that name, the asking one first; its index within the
 * concatenated values. */
static uint32_t lao__value_find(const lao_graph *graph, uint32_t module, const char *name) {
    uint32_t pass, m, first;
    for (pass = 0; pass < 2; pass++) {
        for (m = 0, first = 0; m < graph->module_count;
             first += graph->modules[m]->setting_count, m++) {
            int i = (pass == 0) == (m == module) ? lao_setting_find(graph->modules[m], name) : -1;
            if (i >= 0) {
                return first + (uint32_t)i;
            }
        }
    }
    return LAO_NO_INDEX;
}

void lao_graph_free(const lao_allocator *allocator, lao_graph *graph) {
    lao_allocator a = lao__allocator_or_default(allocator);
    lao__delete(&a, (void *)graph->modules, graph->module_count, sizeof *graph->modules);
    lao__delete(&a, (void *)graph->images, graph->image_count, sizeof *graph->images);
    lao__delete(&a, (void *)graph->passes, graph->pass_count, sizeof *graph->passes);
    lao__delete(&a, (void *)graph->pass_modules, graph->pass_count, sizeof *graph->pass_modules);
    lao__delete(&a, (void *)graph->shader_names, graph->pass_count, sizeof *graph->shader_names);
    memset(graph, 0, sizeof *graph);
}

static uint32_t lao__shader_name(lao_graph *graph, const char **names, const char *name) {
    uint32_t i;
    for (i = 0; i < graph->shader_count; i++) {
        if (strcmp(names[i], name) == 0) {
            return i;
        }
    }
    names[graph->shader_count] = name;
    return graph->shader_count++;
}

/* Buffers beyond LAO_MAX_BUFFERS are only counted: lao_graph_check refuses them. */
static void lao__graph_buffers(lao_graph *graph) {
    uint32_t m, i;
    for (m = 0; m < graph->module_count; m++) {
        for (i = 0; i < graph->modules[m]->buffer_count; i++) {
            if (graph->buffer_count < LAO_MAX_BUFFERS) {
                graph->buffers[graph->buffer_count] = &graph->modules[m]->buffers[i];
            }
            graph->buffer_count++;
        }
    }
}

lao_result lao_graph_make(const lao_module *const *modules, uint32_t module_count,
                          const lao_allocator *allocator, lao_graph *graph) {
    lao_allocator a = lao__allocator_or_default(allocator);
    lao_graph g;
    uint32_t m, i, stage, image = 0, pass = 0;
    const lao_module **own;
    const lao_image_row **images;
    const lao_pass_row **passes;
    uint32_t *pass_modules;
    const char **names;
    memset(&g, 0, sizeof g);
    for (m = 0; m < module_count; m++) {
        g.image_count += modules[m]->image_count;
        g.pass_count += modules[m]->pass_count;
    }
    g.module_count = module_count;
    g.modules = own = (const lao_module **)lao__new(&a, module_count, sizeof *own);
    g.images = images = (const lao_image_row **)lao__new(&a, g.image_count, sizeof *images);
    g.passes = passes = (const lao_pass_row **)lao__new(&a, g.pass_count, sizeof *passes);
    g.pass_modules = pass_modules = (uint32_t *)lao__new(&a, g.pass_count, sizeof *pass_modules);
    g.shader_names = names = (const char **)lao__new(&a, g.pass_count, sizeof *names);
    if (!own || !images || !passes || !pass_modules || !names) {
        lao_graph_free(&a, &g);
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    for (m = 0; m < module_count; m++) {
        own[m] = modules[m];
        for (i = 0; i < modules[m]->image_count; i++) {
            images[image++] = &modules[m]->images[i];
        }
    }
    for (stage = LAO_STAGE_DRAW; stage <= LAO_STAGE_PRESENT; stage++) {
        for (m = 0; m < module_count; m++) {
            for (i = 0; i < modules[m]->pass_count; i++) {
                if ((uint32_t)modules[m]->passes[i].stage == stage) {
                    passes[pass] = &modules[m]->passes[i];
                    pass_modules[pass++] = m;
                    lao__shader_name(&g, names, modules[m]->passes[i].shader);
                }
            }
        }
    }
    g.pass_count = pass; /* fewer only where a stage is none of these */
    lao__graph_buffers(&g);
    *graph = g;
    return LAO_OK;
}

static int lao__fault(char *text, size_t size, const char *format, const char *a, const char *b) {
    if (text && size) {
        snprintf(text, size, format, a, b);
    }
    return -1;
}

static int lao__check_names(const lao_graph *graph, char *text, size_t size) {
    uint32_t i, k, m;
    for (i = 0; i < graph->image_count; i++) {
        for (k = 0; k < i; k++) {
            if (strcmp(graph->images[i]->name, graph->images[k]->name) == 0) {
                return lao__fault(text, size, "two images are named '%s'%s", graph->images[i]->name,
                                  "");
            }
        }
        if (graph->images[i]->levels && strcmp(graph->images[i]->levels, "*") != 0 &&
            lao__value_find(graph, 0, graph->images[i]->levels) == LAO_NO_INDEX) {
            return lao__fault(text, size,
                              "image '%s' counts its levels by the unknown setting '%s'",
                              graph->images[i]->name, graph->images[i]->levels);
        }
        if (graph->images[i]->size == LAO_SIZE_ITEMS &&
            graph->images[i]->width > LAO_FURTHER_ITEMS) {
            return lao__fault(text, size, "image '%s' is of an unknown kind of items%s",
                              graph->images[i]->name, "");
        }
        for (k = 0; k < 4 && graph->images[i]->format == LAO_FORMAT_R32UI; k++) {
            if (graph->images[i]->clear[k] != 0) {
                return lao__fault(text, size, "image '%s' holds words, which are cleared to 0%s",
                                  graph->images[i]->name, "");
            }
        }
    }
    for (i = 0; i < graph->pass_count; i++) {
        for (k = 0; k < i; k++) {
            if (strcmp(graph->passes[i]->name, graph->passes[k]->name) == 0) {
                return lao__fault(text, size, "two passes are named '%s'%s", graph->passes[i]->name,
                                  "");
            }
        }
    }
    if (graph->buffer_count > LAO_MAX_BUFFERS) {
        char most[16];
        snprintf(most, sizeof most, "%d", (int)LAO_MAX_BUFFERS);
        return lao__fault(text, size, "the modules have more than %s buffers%s", most, "");
    }
    for (i = 0; i < graph->buffer_count; i++) {
        for (k = 0; k < i; k++) {
            if (strcmp(graph->buffers[i]->name, graph->buffers[k]->name) == 0) {
                return lao__fault(text, size, "two buffers are named '%s'%s",
                                  graph->buffers[i]->name, "");
            }
        }
    }
    for (m = 0; m < graph->module_count; m++) {
        const lao_module *module = graph->modules[m];
        for (i = 0; i < module->setting_count; i++) {
            if (lao_setting_find(module, module->settings[i].name) != (int)i) {
                return lao__fault(text, size, "two settings of module '%s' are named '%s'",
                                  module->name, module->settings[i].name);
            }
        }
        if (module->setting_count > LAO__MOST_SETTINGS) {
            return lao__fault(text, size, "module '%s' has more than 64 settings%s", module->name,
                              "");
        }
        for (i = 0; i < module->preset_count; i++) {
            int preset = lao_setting_find(module, "preset");
            if (preset < 0 ||
                lao__choice(module->settings[preset].choices, module->presets[i].preset,
                            strlen(module->presets[i].preset)) < 0) {
                return lao__fault(text, size, "module '%s' has no preset '%s'", module->name,
                                  module->presets[i].preset);
            }
            if (lao_setting_find(module, module->presets[i].setting) < 0) {
                return lao__fault(text, size, "preset '%s' names the unknown setting '%s'",
                                  module->presets[i].preset, module->presets[i].setting);
            }
        }
    }
    return 0;
}

static int lao__check_when(const lao_graph *graph, uint32_t module, const char *owner,
                           const lao_when *when, char *text, size_t size) {
    if (!when->name) {
        return 0;
    }
    if (!when->compare || !strchr("=!<>", when->compare)) {
        return lao__fault(text, size, "'%s' has a condition on '%s' without a comparison", owner,
                          when->name);
    }
    if (when->name[0] == LAO__IMPORT_MARK) {
        uint32_t image = lao__image_find(graph, when->name + 1);
        return image == LAO_NO_INDEX
                   ? lao__fault(text, size, "'%s' asks for the unknown image '%s'", owner,
                                when->name + 1)
                   : 0;
    }
    if (when->name[0] == LAO__BUFFER_MARK) {
        return lao__buffer_find(graph, when->name) == LAO_NO_INDEX
                   ? lao__fault(text, size, "'%s' asks for the unknown buffer '%s'", owner,
                                when->name)
                   : 0;
    }
    return lao__value_find(graph, module, when->name) == LAO_NO_INDEX
               ? lao__fault(text, size, "'%s' asks for the unknown setting '%s'", owner, when->name)
               : 0;
}

/* Whether two references of a row name one level in every turn. */
static int lao__same_level(const lao_pass_row *row, const lao_reference *a,
                           const lao_reference *b) {
    int levels = row->repeat == LAO_REPEAT_LEVELS_UP || row->repeat == LAO_REPEAT_LEVELS_DOWN;
    uint32_t i = a->level == LAO_LEVEL_INDEX ? a->level_index : 0,
             k = b->level == LAO_LEVEL_INDEX ? b->level_index : 0;
    return a->level == b->level ? i == k : !levels && i == k;
}

/* Writes and reads of one row against everything written so far. */
static int lao__check_row(const lao_graph *graph, uint32_t index, const lao_pass_row *row,
                          char *text, size_t size) {
    uint32_t r, w, p, end;
    for (r = 0; r < LAO_MAX_READS && row->reads[r].image; r++) {
        const lao_reference *read = &row->reads[r];
        uint32_t image;
        int written = 0;
        if (read->image[0] == LAO__BUFFER_MARK) {
            if (lao__buffer_find(graph, read->image) == LAO_NO_INDEX) {
                return lao__fault(text, size, "pass '%s' reads the unknown buffer '%s'", row->name,
                                  read->image);
            }
            continue;
        }
        image = lao__image_find(graph, read->image);
        if (image == LAO_NO_INDEX) {
            return lao__fault(text, size, "pass '%s' reads the unknown image '%s'", row->name,
                              read->image);
        }
        for (w = 0; w < LAO_MAX_WRITES && row->writes[w].image; w++) {
            const lao_reference *write = &row->writes[w];
            if (strcmp(write->image, read->image) == 0) {
                if (write->phase == read->phase && lao__same_level(row, write, read)) {
                    return lao__fault(text, size, "pass '%s' reads what it writes: '%s'", row->name,
                                      read->image);
                }
            }
        }
        if (read->phase == LAO_PHASE_PREVIOUS &&
            !(graph->images[image]->flags & LAO_IMAGE_HISTORY)) {
            return lao__fault(text, size,
                              "pass '%s' reads the last frame's '%s', which is not kept", row->name,
                              read->image);
        }
        written = (graph->images[image]->flags & LAO_IMAGE_IMPORT) != 0;
        end = read->phase == LAO_PHASE_PREVIOUS ? graph->pass_count : index + 1;
        for (p = 0; p < end && !written; p++) {
            const lao_pass_row *earlier = graph->passes[p];
            for (w = 0; w < LAO_MAX_WRITES && earlier->writes[w].image; w++) {
                /* a repeated row may read what its earlier turn wrote */
                written |= strcmp(earlier->writes[w].image, read->image) == 0 &&
                           (p != index || row->repeat == LAO_REPEAT_LEVELS_DOWN ||
                            read->phase == LAO_PHASE_PREVIOUS);
            }
        }
        if (!written) {
            return lao__fault(text, size, "pass '%s' reads '%s', which nothing has written",
                              row->name, read->image);
        }
    }
    return 0;
}

/* Whether anything after (or the host) wants what the row writes. */
static int lao__row_is_used(const lao_graph *graph, uint32_t index) {
    const lao_pass_row *row = graph->passes[index];
    uint32_t w, p, r;
    for (w = 0; w < LAO_MAX_WRITES && row->writes[w].image; w++) {
        uint32_t image = lao__image_find(graph, row->writes[w].image);
        if (image != LAO_NO_INDEX &&
            (graph->images[image]->flags & (LAO_IMAGE_IMPORT | LAO_IMAGE_HISTORY))) {
            return 1;
        }
        for (p = index; p < graph->pass_count; p++) {
            for (r = 0; r < LAO_MAX_READS && graph->passes[p]->reads[r].image; r++) {
                if (strcmp(graph->passes[p]->reads[r].image, row->writes[w].image) == 0) {
                    return 1;
                }
            }
        }
    }
    return 0;
}

static const lao_shader *lao__shader_find(const lao_shader *shaders, uint32_t count,
                                          const char *name) {
    uint32_t i;
    for (i = 0; i < count; i++) {
        if (strcmp(shaders[i].name, name) == 0) {
            return &shaders[i];
        }
    }
    return NULL;
}

int lao_graph_check(const lao_graph *graph, const lao_shader *shaders, uint32_t shader_count,
                    char *text, size_t text_size) {
    const lao_shader *shader;
    uint32_t i, k, m, used;
    if (lao__check_names(graph, text, text_size) != 0) {
        return -1;
    }
    for (i = 0; i < graph->pass_count; i++) {
        const lao_pass_row *row = graph->passes[i];
        m = graph->pass_modules[i];
        if (!row->writes[0].image) {
            return lao__fault(text, text_size, "pass '%s' writes nothing%s", row->name, "");
        }
        for (k = 0; k < LAO_MAX_WRITES && row->writes[k].image; k++) {
            if (lao__image_find(graph, row->writes[k].image) == LAO_NO_INDEX) {
                return lao__fault(text, text_size, "pass '%s' writes the unknown image '%s'",
                                  row->name, row->writes[k].image);
            }
            if (row->blend != LAO_BLEND_NONE &&
                graph->images[lao__image_find(graph, row->writes[k].image)]->format ==
                    LAO_FORMAT_R32UI) {
                return lao__fault(text, text_size, "pass '%s' blends the words of '%s'", row->name,
                                  row->writes[k].image);
            }
        }
        for (k = 0; k < LAO_MAX_CONDITIONS; k++) {
            if (lao__check_when(graph, m, row->name, &row->when[k], text, text_size) != 0) {
                return -1;
            }
        }
        if ((row->repeat == LAO_REPEAT_COUNT && !row->repeat_setting) ||
            (row->repeat_setting &&
             lao__value_find(graph, m, row->repeat_setting) == LAO_NO_INDEX)) {
            return lao__fault(text, text_size, "pass '%s' repeats by an unknown setting%s",
                              row->name, "");
        }
        if (row->repeat == LAO_REPEAT_WITH_LAST && (i == 0 || graph->pass_modules[i - 1] != m ||
                                                    graph->passes[i - 1]->scope != row->scope)) {
            return lao__fault(text, text_size, "pass '%s' has no row before it to repeat with%s",
                              row->name, "");
        }
        if (lao__check_row(graph, i, row, text, text_size) != 0) {
            return -1;
        }
        if (!lao__row_is_used(graph, i)) {
            return lao__fault(text, text_size, "nothing uses what pass '%s' writes%s", row->name,
                              "");
        }
        shader = lao__shader_find(graph->modules[m]->shaders, graph->modules[m]->shader_count,
                                  row->shader);
        if (!shader) {
            shader = lao__shader_find(shaders, shaders ? shader_count : 0, row->shader);
        }
        if (shaders && !shader) {
            return lao__fault(text, text_size, "pass '%s' has no shader '%s'", row->name,
                              row->shader);
        }
        if (shader && shader->texture_count > LAO_MAX_READS) {
            return lao__fault(text, text_size,
                              "shader '%s' of pass '%s' has more textures than a pass can read",
                              row->shader, row->name);
        }
    }
    for (i = 0; i < graph->image_count; i++) {
        for (k = 0, used = 0; k < graph->pass_count; k++) {
            for (m = 0; m < LAO_MAX_READS && graph->passes[k]->reads[m].image; m++) {
                used |= strcmp(graph->passes[k]->reads[m].image, graph->images[i]->name) == 0;
            }
            for (m = 0; m < LAO_MAX_WRITES && graph->passes[k]->writes[m].image; m++) {
                used |= strcmp(graph->passes[k]->writes[m].image, graph->images[i]->name) == 0;
            }
        }
        if (!used) {
            return lao__fault(text, text_size, "no pass uses image '%s'%s", graph->images[i]->name,
                              "");
        }
        if (lao__check_when(graph, 0, graph->images[i]->name, &graph->images[i]->when, text,
                            text_size) != 0) {
            return -1;
        }
    }
    return 0;
}

void lao_graph_print(const lao_module *const *modules, uint32_t module_count,
                     void (*write)(void *user, const char *text), void *user) {
    char line[256];
    uint32_t m, i, k;
    write(user, "digraph lineao {\n    rankdir=LR;\n    node [fontname=\"sans-serif\"];\n");
    for (m = 0; m < module_count; m++) {
        for (i = 0; i < modules[m]->image_count; i++) {
            snprintf(line, sizeof line, "    \"%s\" [shape=ellipse%s];\n",
                     modules[m]->images[i].name,
                     modules[m]->images[i].flags & LAO_IMAGE_IMPORT ? ", style=dashed" : "");
            write(user, line);
        }
        for (i = 0; i < modules[m]->pass_count; i++) {
            const lao_pass_row *row = &modules[m]->passes[i];
            snprintf(line, sizeof line, "    \"pass %s\" [shape=box, label=\"%s\"];\n", row->name,
                     row->name);
            write(user, line);
            for (k = 0; k < LAO_MAX_READS && row->reads[k].image; k++) {
                if (k == 0 || strcmp(row->reads[k].image, row->reads[k - 1].image) != 0) {
                    snprintf(line, sizeof line, "    \"%s\" -> \"pass %s\";\n", row->reads[k].image,
                             row->name);
                    write(user, line);
                }
            }
            for (k = 0; k < LAO_MAX_WRITES && row->writes[k].image; k++) {
                snprintf(line, sizeof line, "    \"pass %s\" -> \"%s\";\n", row->name,
                         row->writes[k].image);
                write(user, line);
            }
        }
    }
    write(user, "}\n");
}

/* ================================================================================================================
 * plan */

typedef struct lao__planner {
    const lao_graph *graph;
    const lao_plan_desc *desc;
    lao_allocator allocator;
    lao_plan *plan;
    uint32_t supersampling;
    uint8_t *phase; /* per image: which ping-pong partner is THIS */
    int failed;     /* out of memory */
} lao__planner;

void lao_plan_free(const lao_allocator *allocator, lao_plan *plan) {
    lao_allocator a = lao__allocator_or_default(allocator);
    lao__delete(&a, plan->steps, plan->step_capacity, sizeof *plan->steps);
    lao__delete(&a, plan->instances, plan->instance_capacity, sizeof *plan->instances);
    lao__delete(&a, plan->slots, plan->slot_capacity, sizeof *plan->slots);
    lao__delete(&a, plan->barriers, plan->barrier_capacity, sizeof *plan->barriers);
    memset(plan, 0, sizeof *plan);
}

static float lao__value(const lao__planner *p, uint32_t module, uint32_t set, const char *name) {
    uint32_t index = lao__value_find(p->graph, module, name);
    return index == LAO_NO_INDEX ? 0.0f : p->desc->values[set][index];
}

/* The frame's import of that image, or LAO_NO_INDEX; the target has a code of its own. */
static uint32_t lao__import_find(const lao_plan_desc *desc, const char *image) {
    uint32_t i;
    if (strcmp(image, "target") == 0) {
        return desc->has_target ? LAO_IMPORT_TARGET : LAO_NO_INDEX;
    }
    for (i = 0; i < desc->import_count; i++) {
        if (strcmp(desc->imports[i].image, image) == 0) {
            return i;
        }
    }
    return LAO_NO_INDEX;
}

/* Buffers of the lines, the first of every context. */
#define LAO__LINE_BUFFERS ((1u << lao__lines_module.buffer_count) - 1)

/* Which buffers a set has, as bits. */
static uint32_t lao__set_buffers(const lao__planner *p, uint32_t set) {
    if (p->desc->buffers) {
        return p->desc->buffers[set];
    }
    return p->graph->modules[0] == &lao__lines_module ? LAO__LINE_BUFFERS : 0;
}

static int lao__holds(const lao__planner *p, uint32_t module, uint32_t set, const lao_when *when) {
    float value;
    if (!when->name) {
        return 1;
    }
    if (when->name[0] == LAO__IMPORT_MARK) {
        uint32_t import = lao__import_find(p->desc, when->name + 1);
        value = import == LAO_NO_INDEX ? 0.0f : 1.0f;
        if (import < p->desc->import_count &&
            (p->desc->imports[import].source.flags & LAO_HOST_WRITABLE)) {
            value = 2.0f;
        }
    } else if (when->name[0] == LAO__BUFFER_MARK) {
        uint32_t present = lao__set_buffers(p, set);
        value = (float)((present >> lao__buffer_find(p->graph, when->name)) & 1u);
    } else {
        value = lao__value(p, module, set, when->name);
    }
    switch (when->compare) {
    case '=':
        return value == when->value;
    case '!':
        return value != when->value;
    case '<':
        return value < when->value;
    default:
        return value > when->value;
    }
}

static void lao__level_size(const lao__planner *p, const lao_image_row *row, uint32_t level,
                            uint32_t *width, uint32_t *height) {
    uint32_t w = row->size == LAO_SIZE_FIXED ? row->width : p->desc->width;
    uint32_t h = row->size == LAO_SIZE_FIXED ? row->height : p->desc->height;
    if (row->size == LAO_SIZE_FULL) {
        w *= p->supersampling;
        h *= p->supersampling;
    }
    if (row->size == LAO_SIZE_ITEMS) {
        uint32_t items = row->width ? p->desc->further_items[row->width - 1] : p->desc->item_count;
        items = items > 0 ? items : 1;
        w = items < LAO_ITEMS_WIDTH ? items : LAO_ITEMS_WIDTH;
        h = items / LAO_ITEMS_WIDTH + (items % LAO_ITEMS_WIDTH != 0);
    }
    for (; level > 0; level--) {
        w = (w + 1) / 2;
        h = (h + 1) / 2;
    }
    *width = w;
    *height = h;
}

static uint32_t lao__level_count(const lao__planner *p, uint32_t module, uint32_t set,
                                 const lao_image_row *row) {
    uint32_t w, h, n = 1;
    if (!row->levels) {
        return 1;
    }
    if (strcmp(row->levels, "*") != 0) {
        n = (uint32_t)lao__value(p, module, set, row->levels);
        return n < 1 ? 1 : n;
    }
    lao__level_size(p, row, 0, &w, &h);
    for (; w > 1 || h > 1; n++) {
        w = (w + 1) / 2;
        h = (h + 1) / 2;
    }
    return n;
}

static uint32_t lao__instance(lao__planner *p, uint32_t image, uint32_t level, uint32_t phase) {
    lao_plan *plan = p->plan;
    const lao_image_row *row = p->graph->images[image];
    lao_plan_instance *instance;
    uint32_t i;
    for (i = 0; i < plan->instance_count; i++) {
        instance = &plan->instances[i];
        if (instance->image == image && instance->level == level && instance->phase == phase) {
            return i;
        }
    }
    if (lao__grow(&p->allocator, (void **)&plan->instances, plan->instance_count,
                  &plan->instance_capacity, sizeof *plan->instances) != 0) {
        p->failed = 1;
        return LAO_NO_INDEX;
    }
    instance = &plan->instances[plan->instance_count];
    memset(instance, 0, sizeof *instance);
    instance->image = image;
    instance->level = level;
    instance->phase = phase;
    instance->format = row->format;
    lao__level_size(p, row, level, &instance->width, &instance->height);
    instance->import = lao__import_find(p->desc, row->name);
    instance->slot[0] = instance->slot[1] = LAO_NO_INDEX;
    instance->first_step = LAO_NO_INDEX;
    return plan->instance_count++;
}

/* Resolves a reference of a row; LAO_NO_INDEX when its image does not exist under these settings.
 */
static uint32_t lao__resolve(lao__planner *p, const lao_plan_step *step,
                             const lao_reference *reference) {
    uint32_t image, level = 0, last, phase = 0, i;
    const lao_image_row *row;
    if (reference->image[0] == LAO__BUFFER_MARK) {
        return LAO_READ_BUFFER + lao__buffer_find(p->graph, reference->image);
    }
    image = lao__image_find(p->graph, reference->image);
    row = p->graph->images[image];
    if (!lao__holds(p, step->module, step->set, &row->when)) {
        return LAO_NO_INDEX;
    }
    last = lao__level_count(p, step->module, step->set, row) - 1;
    switch (reference->level) {
    case LAO_LEVEL_SAME:
        level = step->level;
        break;
    case LAO_LEVEL_FINER:
        level = step->level - 1;
        break;
    case LAO_LEVEL_COARSER:
        level = step->level + 1;
        break;
    case LAO_LEVEL_INDEX:
        level = reference->level_index;
        break;
    }
    level = level > last ? last : level;
    phase = reference->phase == LAO_PHASE_THIS ? p->phase[image] : (uint32_t)!p->phase[image];
    i = lao__instance(p, image, level, phase);
    if (i != LAO_NO_INDEX) {
        lao_plan_instance *instance = &p->plan->instances[i];
        if (instance->first_step == LAO_NO_INDEX) {
            instance->first_step = p->plan->step_count;
        }
        instance->last_step = p->plan->step_count;
    }
    return i;
}

/* Every written image is the host's to make: nothing is left to do. */
static int lao__imported_away(const lao__planner *p, const lao_pass_row *row) {
    uint32_t w, produced = 0;
    for (w = 0; w < LAO_MAX_WRITES && row->writes[w].image; w++) {
        const lao_image_row *image =
            p->graph->images[lao__image_find(p->graph, row->writes[w].image)];
        if (!(image->flags & LAO_IMAGE_IMPORT) &&
            lao__import_find(p->desc, image->name) != LAO_NO_INDEX) {
            produced++;
        }
    }
    return produced > 0;
}

/* Whether one of the first `end` steps writes it. */
static int lao__is_written(const lao_plan *plan, uint32_t instance, uint32_t end) {
    uint32_t s, i;
    for (s = 0; s < end; s++) {
        for (i = 0; i < plan->steps[s].color_count; i++) {
            if (plan->steps[s].colors[i].instance == instance) {
                return 1;
            }
        }
        if (plan->steps[s].depth.instance == instance) {
            return 1;
        }
    }
    return 0;
}

/* Whether the row draws the lines of all sets into one G-buffer. */
static int lao__draws_together(const lao__planner *p, uint32_t pass) {
    const lao_pass_row *row = p->graph->passes[pass];
    return p->desc->shared_occlusion && p->graph->pass_modules[pass] == 0 &&
           row->stage == LAO_STAGE_DRAW && row->scope == LAO_SCOPE_PER_SET;
}

static void lao__step_write(lao__planner *p, lao_plan_step *step, const lao_reference *reference) {
    uint32_t instance = lao__resolve(p, step, reference);
    uint32_t image = lao__image_find(p->graph, reference->image);
    const lao_image_row *row = p->graph->images[image];
    lao_plan_write write;
    int is_depth = row->format == LAO_FORMAT_D32F ||
                   (row->format == LAO_FORMAT_HOST && step->row->depth != LAO_DEPTH_NONE);
    memset(&write, 0, sizeof write);
    write.instance = instance;
    memcpy(write.value, row->clear, sizeof write.value);
    if (is_depth && p->desc->reverse_depth) {
        write.value[0] = 1.0f - write.value[0];
    }
    write.clear = reference->load == LAO_LOAD_DISCARD ? 2 : reference->load == LAO_LOAD_CLEAR;
    /* sets that share one G-buffer draw into what the first of them cleared */
    if ((reference->load == LAO_LOAD_KEEP ||
         (reference->load == LAO_LOAD_CLEAR && lao__draws_together(p, step->pass))) &&
        !(row->flags & LAO_IMAGE_IMPORT)) {
        write.clear =
            instance != LAO_NO_INDEX && lao__is_written(p->plan, instance, p->plan->step_count) ? 0
                                                                                                : 1;
    }
    if (is_depth) {
        step->depth = write;
    } else {
        step->colors[step->color_count++] = write;
    }
    if (instance != LAO_NO_INDEX) {
        step->width = p->plan->instances[instance].width;
        step->height = p->plan->instances[instance].height;
    }
}

/* "variant", a setting, or "has_" and the name of a buffer: 1 where the set has it. */
static int32_t lao__step_constant(const lao__planner *p, const lao_plan_step *step,
                                  const char *name) {
    uint32_t i;
    if (strcmp(name, "variant") == 0) {
        return (int32_t)step->row->variant;
    }
    for (i = 0; strncmp(name, "has_", 4) == 0 && i < p->graph->buffer_count; i++) {
        if (strcmp(p->graph->buffers[i]->name, name + 4) == 0) {
            return (int32_t)((lao__set_buffers(p, step->set) >> i) & 1u);
        }
    }
    return (int32_t)lao__value(p, step->module, step->set, name);
}
static void lao__step_constants(const lao__planner *p, lao_plan_step *step) {
    const lao_shader *shader = p->desc->shaders ? p->desc->shaders[step->shader] : NULL;
    uint32_t i;
    for (i = 0; shader && i < shader->constant_count && i < LAO_MAX_CONSTANTS; i++) {
        step->constants[i] = lao__step_constant(p, step, shader->constants[i]);
    }
}

static void lao__step_add(lao__planner *p, uint32_t pass, uint32_t set, uint32_t level,
                          uint32_t iteration) {
    const lao_pass_row *row = p->graph->passes[pass];
    lao_plan *plan = p->plan;
    lao_plan_step *step;
    uint32_t i;
    if (lao__grow(&p->allocator, (void **)&plan->steps, plan->step_count, &plan->step_capacity,
                  sizeof *plan->steps) != 0) {
        p->failed = 1;
        return;
    }
    step = &plan->steps[plan->step_count];
    memset(step, 0, sizeof *step);
    step->row = row;
    step->pass = pass;
    step->module = p->graph->pass_modules[pass];
    step->set = set;
    step->level = level;
    step->iteration = iteration;
    step->depth.instance = LAO_NO_INDEX;
    for (step->shader = 0; strcmp(p->graph->shader_names[step->shader], row->shader) != 0;
         step->shader++) {
    }
    for (i = 0; i < LAO_MAX_READS && row->reads[i].image; i++) {
        step->reads[i] = lao__resolve(p, step, &row->reads[i]);
        if (step->reads[i] < plan->instance_count && step->uniforms[4] == 0.0f) {
            step->uniforms[4] = (float)plan->instances[step->reads[i]].width;
            step->uniforms[5] = (float)plan->instances[step->reads[i]].height;
        }
    }
    step->read_count = i;
    for (i = 0; i < LAO_MAX_WRITES && row->writes[i].image; i++) {
        lao__step_write(p, step, &row->writes[i]);
    }
    /* partners swap once the step has written OTHER */
    for (i = 0; i < LAO_MAX_WRITES && row->writes[i].image; i++) {
        if (row->writes[i].phase == LAO_PHASE_OTHER) {
            uint32_t image = lao__image_find(p->graph, row->writes[i].image);
            p->phase[image] = !p->phase[image];
        }
    }
    step->uniforms[0] = (float)step->width;
    step->uniforms[1] = (float)step->height;
    step->uniforms[2] = (float)level;
    step->uniforms[3] = (float)iteration;
    step->uniforms[6] = (float)set;
    lao__step_constants(p, step);
    plan->step_count++;
}

static int lao__row_runs(const lao__planner *p, uint32_t pass, uint32_t set) {
    const lao_pass_row *row = p->graph->passes[pass];
    uint32_t i;
    for (i = 0; i < LAO_MAX_CONDITIONS; i++) {
        if (!lao__holds(p, p->graph->pass_modules[pass], set, &row->when[i])) {
            return 0;
        }
    }
    return !lao__imported_away(p, row);
}

/* One turn of a row, with the rows that repeat with it. */
static void lao__plan_turn(lao__planner *p, uint32_t pass, uint32_t set, uint32_t level,
                           uint32_t iteration) {
    const lao_graph *graph = p->graph;
    uint32_t i, k, n;
    lao__step_add(p, pass, set, level, iteration);
    for (i = pass + 1; i < graph->pass_count && graph->passes[i]->repeat == LAO_REPEAT_WITH_LAST;
         i++) {
        const char *setting = graph->passes[i]->repeat_setting;
        n = setting ? (uint32_t)lao__value(p, graph->pass_modules[i], set, setting) : 1;
        for (k = 0; k < n && lao__row_runs(p, i, set); k++) {
            lao__step_add(p, i, set, level, setting ? k : iteration);
        }
    }
}

static void lao__plan_pass(lao__planner *p, uint32_t pass, uint32_t set) {
    const lao_pass_row *row = p->graph->passes[pass];
    uint32_t module = p->graph->pass_modules[pass], i, n;
    const lao_image_row *first = p->graph->images[lao__image_find(p->graph, row->writes[0].image)];
    if (!lao__row_runs(p, pass, set)) {
        return;
    }
    switch (row->repeat) {
    case LAO_REPEAT_NONE:
        lao__plan_turn(p, pass, set, 0, 0);
        break;
    case LAO_REPEAT_LEVELS_UP:
        n = lao__level_count(p, module, set, first);
        for (i = row->writes[0].level_index + 1; i < n; i++) {
            lao__plan_turn(p, pass, set, i, i - 1);
        }
        break;
    case LAO_REPEAT_LEVELS_DOWN:
        n = lao__level_count(p, module, set, first);
        for (i = n - 1; i > 0; i--) {
            lao__plan_turn(p, pass, set, i - 1, n - 1 - i);
        }
        break;
    case LAO_REPEAT_COUNT:
        n = (uint32_t)lao__value(p, module, set, row->repeat_setting);
        for (i = 0; i < n; i++) {
            lao__plan_turn(p, pass, set, 0, i);
        }
        break;
    case LAO_REPEAT_WITH_LAST:
        break; /* in the turns of the row before */
    }
}

/* Consecutive rows of each set. With shared occlusion a row of the lines at a time draws all sets,
   and what comes after drawing runs once, by the first set's settings; further modules follow. */
static void lao__plan_sets(lao__planner *p, uint32_t first, uint32_t end) {
    int shared = p->desc->shared_occlusion && p->graph->passes[first]->stage != LAO_STAGE_COMPOSE;
    uint32_t i, set, count;
    for (i = first; shared && i < end; i++) {
        count = p->graph->pass_modules[i] > 0 ? 0
                : lao__draws_together(p, i)   ? p->desc->set_count
                                              : 1;
        for (set = 0; set < count; set++) {
            lao__plan_pass(p, i, set);
        }
    }
    for (set = 0; set < p->desc->set_count; set++) {
        for (i = first; i < end; i++) {
            if (!shared || p->graph->pass_modules[i] > 0) {
                lao__plan_pass(p, i, set);
            }
        }
    }
}

/* The set whose settings a row of the whole frame follows. */
static uint32_t lao__frame_set_of(const lao__planner *p, uint32_t pass) {
    uint32_t set;
    for (set = 0; set < p->desc->set_count; set++) {
        if (lao__row_runs(p, pass, set)) {
            return set;
        }
    }
    return 0;
}

/* Gives every instance memory; those whose lives do not meet share it. */
static void lao__plan_slots(lao__planner *p) {
    lao_plan *plan = p->plan;
    uint32_t i, k, s;
    int share = !(p->desc->flags & LAO_VIEW_KEEP_IMAGES);
    for (i = 0; i < plan->instance_count; i++) {
        lao_plan_instance *instance = &plan->instances[i];
        int history = (p->graph->images[instance->image]->flags & LAO_IMAGE_HISTORY) != 0;
        if (instance->import != LAO_NO_INDEX) {
            continue;
        }
        for (s = 0; share && !history && s < plan->slot_count; s++) {
            lao_plan_slot *slot = &plan->slots[s];
            int fits = slot->format == instance->format && slot->width == instance->width &&
                       slot->height == instance->height;
            for (k = 0; fits && k < i; k++) {
                const lao_plan_instance *other = &plan->instances[k];
                if (other->slot[0] == s || other->slot[1] == s) {
                    fits = !(p->graph->images[other->image]->flags & LAO_IMAGE_HISTORY) &&
                           (other->last_step < instance->first_step ||
                            instance->last_step < other->first_step);
                }
            }
            if (fits) {
                break;
            }
        }
        if (!share || history || s == plan->slot_count) {
            s = plan->slot_count;
            if (lao__grow(&p->allocator, (void **)&plan->slots, s, &plan->slot_capacity,
                          sizeof *plan->slots) != 0) {
                p->failed = 1;
                return;
            }
            memset(&plan->slots[s], 0, sizeof plan->slots[s]);
            plan->slots[s].format = instance->format;
            plan->slots[s].width = instance->width;
            plan->slots[s].height = instance->height;
            plan->slot_count++;
        }
        instance->slot[0] = instance->slot[1] = s;
    }
    /* the two phases of a history image change places every frame */
    for (i = 0; i < plan->instance_count; i++) {
        for (k = 0; k < i; k++) {
            lao_plan_instance *a = &plan->instances[i], *b = &plan->instances[k];
            if (a->image == b->image && a->level == b->level &&
                (p->graph->images[a->image]->flags & LAO_IMAGE_HISTORY)) {
                a->slot[1] = b->slot[0];
                b->slot[1] = a->slot[0];
            }
        }
    }
}

static void lao__barrier(lao__planner *p, uint8_t *state, uint32_t instance, lao_access after,
                         int discard) {
    lao_plan *plan = p->plan;
    const lao_plan_instance *i = &plan->instances[instance];
    /* imports are tracked behind the slots, one entry per instance */
    uint8_t *before = &state[i->slot[0] != LAO_NO_INDEX ? i->slot[0] : plan->slot_count + instance];
    lao_plan_barrier *barrier;
    if (*before == (uint8_t)after && after == LAO_ACCESS_SAMPLE) {
        return;
    }
    if (lao__grow(&p->allocator, (void **)&plan->barriers, plan->barrier_count,
                  &plan->barrier_capacity, sizeof *plan->barriers) != 0) {
        p->failed = 1;
        return;
    }
    barrier = &plan->barriers[plan->barrier_count++];
    barrier->instance = instance;
    barrier->before = (lao_access)*before;
    barrier->after = after;
    barrier->discard = (uint32_t)discard;
    *before = (uint8_t)after;
}

static void lao__plan_barriers(lao__planner *p) {
    lao_plan *plan = p->plan;
    uint32_t s, i, count = plan->slot_count + plan->instance_count;
    uint8_t *state = (uint8_t *)lao__new(&p->allocator, count ? count : 1, 1);
    if (!state) {
        p->failed = 1;
        return;
    }
    for (s = 0; s < plan->step_count && !p->failed; s++) {
        lao_plan_step *step = &plan->steps[s];
        step->barrier_first = plan->barrier_count;
        for (i = 0; i < step->read_count; i++) {
            if (step->reads[i] < plan->instance_count) {
                lao__barrier(p, state, step->reads[i], LAO_ACCESS_SAMPLE, 0);
            }
        }
        for (i = 0; i < step->color_count; i++) {
            if (step->colors[i].instance != LAO_NO_INDEX) {
                lao__barrier(p, state, step->colors[i].instance, LAO_ACCESS_COLOR,
                             step->colors[i].clear != 0);
            }
        }
        if (step->depth.instance != LAO_NO_INDEX) {
            lao__barrier(p, state, step->depth.instance, LAO_ACCESS_DEPTH, step->depth.clear != 0);
        }
        step->barrier_count = plan->barrier_count - step->barrier_first;
    }
    plan->end_barrier_first = plan->barrier_count;
    for (i = 0; i < plan->instance_count && !p->failed; i++) {
        if (plan->instances[i].import != LAO_NO_INDEX) {
            lao__barrier(p, state, i, LAO_ACCESS_NONE, 0);
        }
    }
    lao__delete(&p->allocator, state, count ? count : 1, 1);
}

static void lao__plan_usage(lao_plan *plan) {
    uint32_t s, i, b;
    for (b = 0; b < plan->barrier_count; b++) {
        for (i = 0; i < 2; i++) {
            s = plan->instances[plan->barriers[b].instance].slot[i];
            if (s != LAO_NO_INDEX) {
                plan->slots[s].sampled |= plan->barriers[b].after == LAO_ACCESS_SAMPLE;
                plan->slots[s].attached |= plan->barriers[b].after == LAO_ACCESS_COLOR ||
                                           plan->barriers[b].after == LAO_ACCESS_DEPTH;
            }
        }
    }
}

lao_result lao_plan_make(const lao_graph *graph, const lao_plan_desc *desc,
                         const lao_allocator *allocator, lao_plan *plan) {
    lao__planner p;
    uint32_t pass, end;
    memset(&p, 0, sizeof p);
    p.graph = graph;
    p.desc = desc;
    p.allocator = lao__allocator_or_default(allocator);
    p.plan = plan;
    p.phase = (uint8_t *)lao__new(&p.allocator, graph->image_count, 1);
    if (!p.phase) {
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    p.supersampling = (uint32_t)lao__value(&p, 0, 0, "supersampling");
    p.supersampling = p.supersampling < 1 ? 1 : p.supersampling;
    plan->step_count = plan->instance_count = plan->slot_count = plan->barrier_count = 0;
    plan->reverse_depth = desc->reverse_depth;
    plan->serial++;
    for (pass = 0; pass < graph->pass_count && !p.failed; pass = end) {
        end = pass + 1;
        if (graph->passes[pass]->scope == LAO_SCOPE_FRAME) {
            lao__plan_pass(&p, pass, lao__frame_set_of(&p, pass));
            continue;
        }
        /* composing begins when all sets are shaded */
        while (end < graph->pass_count && graph->passes[end]->scope == LAO_SCOPE_PER_SET &&
               (graph->passes[end]->stage < LAO_STAGE_COMPOSE ||
                graph->passes[end]->stage == graph->passes[pass]->stage)) {
            end++;
        }
        lao__plan_sets(&p, pass, end);
    }
    if (!p.failed) {
        lao__plan_slots(&p);
    }
    if (!p.failed) {
        lao__plan_barriers(&p);
    }
    lao__delete(&p.allocator, p.phase, graph->image_count, 1);
    if (p.failed) {
        plan->step_count = 0;
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    lao__plan_usage(plan);
    return LAO_OK;
}

static void lao__print_instance(const lao_graph *graph, const lao_plan *plan, uint32_t index,
                                void (*write)(void *, const char *), void *user) {
    char text[96];
    const lao_plan_instance *instance;
    if (LAO_READ_IS_BUFFER(index)) {
        snprintf(text, sizeof text, " #%s", graph->buffers[index - LAO_READ_BUFFER]->name);
        write(user, text);
        return;
    }
    if (index == LAO_NO_INDEX) {
        write(user, " -");
        return;
    }
    instance = &plan->instances[index];
    snprintf(text, sizeof text, " %s.%u%s", graph->images[instance->image]->name, instance->level,
             instance->phase ? "'" : "");
    write(user, text);
}

static void lao__print_barriers(const lao_graph *graph, const lao_plan *plan, uint32_t first,
                                uint32_t end, void (*write)(void *, const char *), void *user) {
    static const char *const name[] = {"none", "sample", "color", "depth"};
    char text[64];
    for (; first < end; first++) {
        const lao_plan_barrier *barrier = &plan->barriers[first];
        write(user, "  barrier");
        lao__print_instance(graph, plan, barrier->instance, write, user);
        snprintf(text, sizeof text, " %s -> %s%s\n", name[barrier->before], name[barrier->after],
                 barrier->discard ? " (discard)" : "");
        write(user, text);
    }
}

void lao_plan_print(const lao_graph *graph, const lao_plan *plan,
                    void (*write)(void *user, const char *text), void *user) {
    static const char *const clear[] = {"", " clear", " discard"};
    char text[160];
    uint32_t s, i;
    for (s = 0; s < plan->step_count; s++) {
        const lao_plan_step *step = &plan->steps[s];
        lao__print_barriers(graph, plan, step->barrier_first,
                            step->barrier_first + step->barrier_count, write, user);
        snprintf(text, sizeof text, "step %u %s set %u level %u turn %u %ux%u reads", s,
                 step->row->name, step->set, step->level, step->iteration, step->width,
                 step->height);
        write(user, text);
        for (i = 0; i < step->read_count; i++) {
            lao__print_instance(graph, plan, step->reads[i], write, user);
        }
        write(user, " writes");
        for (i = 0; i < step->color_count; i++) {
            lao__print_instance(graph, plan, step->colors[i].instance, write, user);
            write(user, clear[step->colors[i].clear]);
        }
        if (step->depth.instance != LAO_NO_INDEX) {
            lao__print_instance(graph, plan, step->depth.instance, write, user);
            write(user, clear[step->depth.clear]);
        }
        write(user, "\n");
    }
    lao__print_barriers(graph, plan, plan->end_barrier_first, plan->barrier_count, write, user);
}

/* =============================================================================================================
 * context */

#define LAO__KEY_SIZE 9
#define LAO__GROUPS 256u /* of a chunk, at most */
#define LAO__PARTED 64u  /* lines; fewer are one part */
#define LAO__DENSE 4.0   /* pixels of a segment, at most, where parts pay */

typedef struct lao__lines {
    lao_chunk *chunks;
    uint32_t chunk_count;
    float bounds[2][3];
    int has_points;
} lao__lines;

typedef struct lao__object {
    lao_chunk chunk;
    uint32_t item_count, further_items[LAO_FURTHER_ITEMS];
    float bounds[2][3];
} lao__object;

typedef struct lao__view {
    uint32_t width, height, flags;
    void *backend_view;
    lao_plan plan;
    float *values; /* resolved settings of the sets that the plan was made for */
    const float **value_rows;
    uint8_t *uniforms; /* settings blocks of all sets */
    lao_draw *draws;
    uint32_t *buffers; /* per set: which buffers it has */
    uint32_t set_capacity;
    uint32_t key[LAO__KEY_SIZE];               /* structure: size, sets, imports, ... */
    uint32_t item_count;                       /* the most of its objects */
    uint32_t further_items[LAO_FURTHER_ITEMS]; /* likewise */
    uint32_t frame;                            /* counts rendered frames */
    uint32_t history;                          /* of them, since the plan was made */
    lao_camera previous;                       /* canonical camera of the last one */
    int prepared, rendered, timed;
} lao__view;

typedef struct lao__handle {
    void *object;
    uint32_t generation;
} lao__handle;

typedef struct lao__pool {
    lao__handle *handles;
    uint32_t count, capacity;
} lao__pool;

struct lao_context {
    lao_allocator allocator;
    lao_logger logger;
    lao_backend backend;
    lao_host host;
    lao_backend_caps caps;
    void *self; /* the backend's */
    lao_graph graph;
    const lao_shader **shaders; /* by graph.shader_names */
    uint32_t value_count;       /* settings of all modules */
    lao__pool lines, objects, views;
    uint32_t next_serial;
};

static lao_result lao__log(const lao_logger *logger, lao_log_item item, const char *detail) {
    static const struct {
        lao_result result;
        const char *text;
    } items[] = {
#define LAO__ITEM(id, result, text) {result, text},
        LAO_LOG_ITEMS(LAO__ITEM)
#undef LAO__ITEM
    };
    char text[1024];
    if (logger->log) {
        if (detail && *detail) {
            snprintf(text, sizeof text, "%s: %s", items[item].text, detail);
            logger->log(logger->user, item, items[item].result, text);
        } else {
            logger->log(logger->user, item, items[item].result, items[item].text);
        }
    }
    return items[item].result;
}

static lao_result lao__fail(lao_context *context, lao_log_item item, const char *detail) {
    return lao__log(&context->logger, item, detail);
}

static void lao__report(void *context, lao_log_item item, const char *detail) {
    lao__log(&((lao_context *)context)->logger, item, detail);
}

/* ---- handles: index in the low 20 bits, generation above; 0 is none */

#define LAO__INDEX_BITS 20u

static uint32_t lao__handle_add(const lao_allocator *allocator, lao__pool *pool, void *object) {
    uint32_t i;
    for (i = 0; i < pool->count && pool->handles[i].object; i++) {
    }
    if (i == pool->count) {
        if (i >= (1u << LAO__INDEX_BITS) - 1 ||
            lao__grow(allocator, (void **)&pool->handles, pool->count, &pool->capacity,
                      sizeof *pool->handles) != 0) {
            return 0;
        }
        pool->handles[i].generation = 0;
        pool->count++;
    }
    pool->handles[i].object = object;
    pool->handles[i].generation = (pool->handles[i].generation + 1) & 0xfffu;
    return (pool->handles[i].generation << LAO__INDEX_BITS) | (i + 1);
}

static lao__handle *lao__handle_get(lao__pool *pool, uint32_t id) {
    uint32_t i = (id & ((1u << LAO__INDEX_BITS) - 1)) - 1;
    if (id == 0 || i >= pool->count || !pool->handles[i].object ||
        pool->handles[i].generation != id >> LAO__INDEX_BITS) {
        return NULL;
    }
    return &pool->handles[i];
}

/* ---- create and destroy */

static lao_result lao__shaders_find(lao_context *context) {
    uint32_t i, k, m;
    context->shaders = (const lao_shader **)lao__new(&context->allocator, context->graph.pass_count,
                                                     sizeof *context->shaders);
    if (!context->shaders) {
        return lao__fail(context, LAO_LOG_CONTEXT_MEMORY, NULL);
    }
    for (i = 0; i < context->graph.shader_count; i++) {
        const char *name = context->graph.shader_names[i];
        for (k = 0; k < context->caps.shader_count; k++) {
            if (strcmp(context->caps.shaders[k].name, name) == 0) {
                context->shaders[i] = &context->caps.shaders[k];
            }
        }
        for (m = 0; m < context->graph.module_count; m++) {
            for (k = 0; k < context->graph.modules[m]->shader_count; k++) {
                if (strcmp(context->graph.modules[m]->shaders[k].name, name) == 0) {
                    context->shaders[i] = &context->graph.modules[m]->shaders[k];
                }
            }
        }
    }
    return LAO_OK;
}

static lao_result lao__graph_open(lao_context *context, const lao_desc *desc) {
    const lao_module *modules[16];
    char text[256];
    uint32_t m;
    if (desc->module_count > 0 && !desc->modules) {
        return lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_desc.modules");
    }
    if (desc->module_count >= 16) {
        return lao__fail(context, LAO_LOG_GRAPH_BROKEN, "more than 15 modules");
    }
    modules[0] = &lao__lines_module;
    for (m = 0; m < desc->module_count; m++) {
        modules[m + 1] = desc->modules[m];
    }
    if (lao_graph_make(modules, desc->module_count + 1, &context->allocator, &context->graph) !=
        LAO_OK) {
        return lao__fail(context, LAO_LOG_CONTEXT_MEMORY, NULL);
    }
    if (lao_graph_check(&context->graph, NULL, 0, text, sizeof text) != 0) {
        return lao__fail(context, LAO_LOG_GRAPH_BROKEN, text);
    }
    for (m = 0; m < context->graph.module_count; m++) {
        uint32_t rows = (context->graph.modules[m]->setting_count + 3) / 4;
        context->value_count += context->graph.modules[m]->setting_count;
        if (rows * 16 > context->host.settings_size) {
            context->host.settings_size = rows * 16;
        }
    }
    return LAO_OK;
}

lao_result lao_create(const lao_desc *desc, lao_context **context) {
    lao_logger silent;
    lao_allocator allocator;
    lao_context *c;
    lao_result result;
    memset(&silent, 0, sizeof silent);
    if (!desc || !context) {
        return lao__log(desc ? &desc->logger : &silent, LAO_LOG_NULL_ARGUMENT, "lao_create");
    }
    if (!desc->backend || !desc->backend->attach) {
        return lao__log(&desc->logger, LAO_LOG_BACKEND_MISSING, NULL);
    }
    if (desc->backend->abi != LAO_BACKEND_ABI) {
        return lao__log(&desc->logger, LAO_LOG_BACKEND_ABI, desc->backend->name);
    }
    allocator = lao__allocator_or_default(&desc->allocator);
    c = (lao_context *)lao__new(&allocator, 1, sizeof *c);
    if (!c) {
        return lao__log(&desc->logger, LAO_LOG_CONTEXT_MEMORY, NULL);
    }
    c->allocator = allocator;
    c->logger = desc->logger;
    c->backend = *desc->backend;
    c->host.allocator = allocator;
    c->host.report = lao__report;
    c->host.context = c;
    c->host.graph = &c->graph;
    result = lao__graph_open(c, desc);
    if (result == LAO_OK) {
        result = c->backend.attach(&c->backend, &c->host, &c->self, &c->caps);
    }
    if (result == LAO_OK) {
        result = lao__shaders_find(c);
    }
    if (result != LAO_OK) {
        lao_destroy(c);
        return result;
    }
    *context = c;
    return LAO_OK;
}

static void lao__chunk_clear(lao_context *context, lao_chunk *chunk) {
    uint32_t i;
    for (i = 0; i < LAO_MAX_BUFFERS; i++) {
        if (chunk->buffers[i]) {
            context->backend.buffer_destroy(context->self, chunk->buffers[i]);
        }
    }
    lao__delete(&context->allocator, (void *)chunk->groups, LAO__GROUPS, sizeof *chunk->groups);
    memset(chunk, 0, sizeof *chunk);
}

static void lao__lines_clear(lao_context *context, lao__lines *lines) {
    uint32_t i;
    for (i = 0; i < lines->chunk_count; i++) {
        lao__chunk_clear(context, &lines->chunks[i]);
    }
    lao__delete(&context->allocator, lines->chunks, lines->chunk_count, sizeof *lines->chunks);
    memset(lines, 0, sizeof *lines);
}

static void lao__view_frames_free(lao_context *context, lao__view *view) {
    uint32_t n = view->set_capacity, modules = context->graph.module_count;
    lao__delete(&context->allocator, view->values, (size_t)n * context->value_count,
                sizeof *view->values);
    lao__delete(&context->allocator, (void *)view->value_rows, n, sizeof *view->value_rows);
    lao__delete(&context->allocator, view->uniforms,
                (size_t)n * modules * context->host.settings_size, 1);
    lao__delete(&context->allocator, view->draws, n, sizeof *view->draws);
    lao__delete(&context->allocator, view->buffers, n, sizeof *view->buffers);
    view->values = NULL;
    view->value_rows = NULL;
    view->uniforms = NULL;
    view->draws = NULL;
    view->buffers = NULL;
    view->set_capacity = 0;
}

static void lao__view_free(lao_context *context, lao__view *view) {
    if (view->backend_view) {
        context->backend.view_destroy(context->self, view->backend_view);
    }
    lao_plan_free(&context->allocator, &view->plan);
    lao__view_frames_free(context, view);
    lao__delete(&context->allocator, view, 1, sizeof *view);
}

static void lao__object_free(lao_context *context, lao__object *object) {
    lao__chunk_clear(context, &object->chunk);
    lao__delete(&context->allocator, object, 1, sizeof *object);
}

void lao_destroy(lao_context *context) {
    lao_allocator allocator;
    uint32_t i;
    if (!context) {
        return;
    }
    for (i = 0; i < context->views.count; i++) {
        if (context->views.handles[i].object) {
            lao__view_free(context, (lao__view *)context->views.handles[i].object);
        }
    }
    for (i = 0; i < context->lines.count; i++) {
        if (context->lines.handles[i].object) {
            lao__lines_clear(context, (lao__lines *)context->lines.handles[i].object);
            lao__delete(&context->allocator, context->lines.handles[i].object, 1,
                        sizeof(lao__lines));
        }
    }
    for (i = 0; i < context->objects.count; i++) {
        if (context->objects.handles[i].object) {
            lao__object_free(context, (lao__object *)context->objects.handles[i].object);
        }
    }
    if (context->self) {
        context->backend.detach(context->self);
    }
    lao__delete(&context->allocator, context->views.handles, context->views.capacity,
                sizeof *context->views.handles);
    lao__delete(&context->allocator, context->lines.handles, context->lines.capacity,
                sizeof *context->lines.handles);
    lao__delete(&context->allocator, context->objects.handles, context->objects.capacity,
                sizeof *context->objects.handles);
    lao__delete(&context->allocator, (void *)context->shaders, context->graph.pass_count,
                sizeof *context->shaders);
    lao_graph_free(&context->allocator, &context->graph);
    allocator = context->allocator;
    lao__delete(&allocator, context, 1, sizeof *context);
}

/* ===============================================================================================================
 * lines */

/* Texels of a line set as the vertex stage wants them: each run of points between two ghosts, so
   that the neighbours of a segment's ends are always one texel away. A ghost repeats the end point
   (no neighbour) or, in a closed line, the point beyond the seam. With points NULL the walk only
   counts. */
typedef struct lao__texels {
    float *points;   /* x, y, z, time */
    uint8_t *colors; /* RGBA */
    uint64_t count;
    uint64_t ends[LAO_PARTS]; /* behind each part */
    int timed;
} lao__texels;

/* A time that is none, or too large to be told from a ghost's, is never reached. */
static float lao__time(float time) {
    return time > -1.0e30f && time < 1.0e30f ? time : 1.0e30f;
}

static void lao__texel(lao__texels *out, const lao_lines_desc *desc, uint32_t position,
                       uint32_t attribute, int ghost) {
    if (out->points) {
        float *p = out->points + 4 * out->count;
        uint8_t *c = out->colors + 4 * out->count;
        memcpy(p, desc->points + 3 * (size_t)position, 3 * sizeof *p);
        p[3] = ghost ? LAO_GHOST_TIME : desc->times ? lao__time(desc->times[attribute]) : 0.0f;
        if (desc->colors) {
            memcpy(c, desc->colors + 4 * (size_t)attribute, 4);
        } else {
            static const float sand[4] = {0.93f, 0.80f, 0.50f, 1.0f};
            const float *color = desc->color;
            int i, none = color[0] == 0 && color[1] == 0 && color[2] == 0 && color[3] == 0;
            for (i = 0; i < 4; i++) {
                c[i] = (uint8_t)(lao_clamp01(none ? sand[i] : color[i]) * 255.0f + 0.5f);
            }
        }
    }
    out->count++;
}

static int lao__same_point(const lao_lines_desc *desc, uint32_t a, uint32_t b) {
    return memcmp(desc->points + 3 * (size_t)a, desc->points + 3 * (size_t)b, 3 * sizeof(float)) ==
           0;
}

/* One run of finite points [first, end). */
static void lao__run(lao__texels *out, const lao_lines_desc *desc, uint32_t first, uint32_t end) {
    uint32_t i, next, distinct = 0, second = first, before_last = first, last = first;
    for (i = first + 1; i < end; i++) {
        if (!lao__same_point(desc, i, last)) {
            if (distinct++ == 0) {
                second = i;
            }
            before_last = last;
            last = i;
        }
    }
    if (distinct == 0) {
        return; /* nothing but one point */
    }
    i = distinct >= 3 && lao__same_point(desc, first, last); /* closed */
    lao__texel(out, desc, i ? before_last : first, first, 1);
    lao__texel(out, desc, first, first, 0);
    for (last = first, next = first + 1; next < end; next++) {
        if (!lao__same_point(desc, next, last)) {
            lao__texel(out, desc, next, next, 0);
            last = next;
        }
    }
    lao__texel(out, desc, i ? second : last, last, 1);
}

static void lao__line(lao__texels *out, const lao_lines_desc *desc, uint32_t begin, uint32_t end) {
    uint32_t i, first;
    for (first = i = begin; i < end; i++) {
        if (!lao__finite(desc->points + 3 * (size_t)i, 3)) {
            lao__run(out, desc, first, i);
            first = i + 1;
        }
    }
    lao__run(out, desc, first, i);
}

/* Of many lines every eighth, every eighth, every fourth, every second: each part is spread over
   the whole set. */
static uint32_t lao__part_of(const lao_lines_desc *desc, uint32_t line) {
    uint32_t part = LAO_PARTS - 1;
    while (part > 0 && line % 2 == 0) {
        line /= 2;
        part--;
    }
    return desc->line_count < LAO__PARTED ? 0 : part;
}

/* Lines part by part. */
static void lao__lines_walk(lao__texels *out, const lao_lines_desc *desc, const uint32_t *offsets) {
    uint32_t line, part;
    for (part = 0; part < LAO_PARTS; part++) {
        for (line = 0; line < desc->line_count; line++) {
            if (lao__part_of(desc, line) == part) {
                lao__line(out, desc, offsets[line], offsets[line + 1]);
            }
        }
        out->ends[part] = out->count;
    }
}

static lao_result lao__lines_check(lao_context *context, const lao_lines_desc *desc,
                                   const uint32_t *offsets) {
    uint32_t i;
    char text[96];
    if (desc->point_count > 0 && desc->line_count > 0 && !desc->points) {
        return lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_desc.points");
    }
    if (!desc->offsets && desc->line_count > 1) {
        return lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_desc.offsets");
    }
    if (desc->line_count == 0) {
        return LAO_OK;
    }
    for (i = 0; i <= desc->line_count; i++) {
        if ((i == 0 && offsets[0] != 0) || (i > 0 && offsets[i] < offsets[i - 1]) ||
            offsets[i] > desc->point_count) {
            snprintf(text, sizeof text, "offsets[%u] = %u", i, offsets[i]);
            return lao__fail(context, LAO_LOG_LINES_OFFSETS, text);
        }
    }
    if (offsets[desc->line_count] != desc->point_count) {
        snprintf(text, sizeof text, "offsets[%u] = %u, point_count = %u", desc->line_count,
                 offsets[desc->line_count], desc->point_count);
        return lao__fail(context, LAO_LOG_LINES_OFFSETS, text);
    }
    return LAO_OK;
}

static void lao__lines_box(lao__lines *lines, const lao_lines_desc *desc) {
    uint32_t i, k;
    for (i = 0; desc->line_count > 0 && i < desc->point_count; i++) {
        const float *p = desc->points + 3 * (size_t)i;
        if (lao__finite(p, 3)) {
            for (k = 0; k < 3; k++) {
                lines->bounds[0][k] = lines->has_points ? lao_min(lines->bounds[0][k], p[k]) : p[k];
                lines->bounds[1][k] = lines->has_points ? lao_max(lines->bounds[1][k], p[k]) : p[k];
            }
            lines->has_points = 1;
        }
    }
}

/* Rows of the line module's buffers, which stand first in every graph. */
enum { LAO__BUFFER_POINTS, LAO__BUFFER_COLORS, LAO__BUFFER_ORDER };

/* The time at which segment i begins; of none that is never reached, or lies between two lines. */
static int lao__segment_time(const float *points, uint32_t i, float *begin, float *end) {
    const float a = points[4 * ((size_t)i + 1) + 3], b = points[4 * ((size_t)i + 2) + 3];
    *begin = lao_min(a, b);
    *end = lao_max(a, b);
    return *end < 1.0e30f;
}

enum { LAO__BINS = 65536 };

/* Segments by the bin of time in which they begin; `groups` of about as many segments each. */
typedef struct lao__order {
    const float *points;
    uint32_t segment_count, total, group_count;
    double earliest, per_bin;
    uint32_t *bins; /* LAO__BINS: first segments, then groups */
    lao_group *groups;
    float *order; /* numbers of segments: floats tell them apart */
} lao__order;

static uint32_t lao__bin(const lao__order *o, float begin) {
    return (uint32_t)((begin - o->earliest) * o->per_bin);
}

static void lao__order_count(lao__order *o) {
    float begin, end, earliest = 0, latest = 0;
    uint32_t i;
    for (i = 0; i < o->segment_count; i++) {
        if (lao__segment_time(o->points, i, &begin, &end)) {
            earliest = o->total ? lao_min(earliest, begin) : begin;
            latest = o->total ? lao_max(latest, begin) : begin;
            o->total++;
        }
    }
    o->earliest = earliest;
    o->per_bin = latest > earliest ? (LAO__BINS - 1) / ((double)latest - earliest) : 0;
    for (i = 0; i < o->segment_count; i++) {
        if (lao__segment_time(o->points, i, &begin, &end)) {
            o->bins[lao__bin(o, begin)]++;
        }
    }
}

/* Bins, in order, into the last group until it has its share. */
static void lao__order_group(lao__order *o) {
    uint32_t i, filled = 0;
    for (i = 0; i < LAO__BINS; i++) {
        uint32_t n = o->bins[i];
        if (n > 0 && (uint64_t)filled * LAO__GROUPS >= (uint64_t)o->group_count * o->total) {
            o->groups[o->group_count++].first = filled;
        }
        o->bins[i] = n > 0 ? o->group_count - 1 : 0;
        filled += n;
    }
}

/* Within a group segments keep the order of the lines, in which their points lie in memory. */
static void lao__order_fill(lao__order *o) {
    float begin, end;
    uint32_t i;
    for (i = 0; i < o->segment_count; i++) {
        if (lao__segment_time(o->points, i, &begin, &end)) {
            lao_group *group = &o->groups[o->bins[lao__bin(o, begin)]];
            group->begin = group->count ? lao_min(group->begin, begin) : begin;
            group->end = group->count ? lao_max(group->end, end) : end;
            o->order[group->first + group->count++] = (float)i;
        }
    }
}

/* Puts the buffer "#order" and its groups into a chunk whose points are given. */
static lao_result lao__chunk_order(lao_context *context, lao_chunk *chunk, const float *points) {
    const lao_allocator *allocator = &context->allocator;
    lao_result result;
    lao_buffer_desc buffer;
    lao__order o;
    memset(&o, 0, sizeof o);
    o.points = points;
    o.segment_count = chunk->count;
    o.bins = (uint32_t *)lao__new(allocator, LAO__BINS, sizeof *o.bins);
    o.order = (float *)lao__new(allocator, chunk->count, sizeof *o.order);
    o.groups = (lao_group *)lao__new(allocator, LAO__GROUPS, sizeof *o.groups);
    chunk->groups = o.groups;
    if (o.bins && o.order && o.groups) {
        lao__order_count(&o);
        lao__order_group(&o);
        lao__order_fill(&o);
        chunk->group_count = o.group_count;
        buffer.format = LAO_FORMAT_R32F;
        buffer.texel_count = o.total ? o.total : 1;
        buffer.data = o.order;
        result = context->backend.buffer_create(context->self, &buffer,
                                                &chunk->buffers[LAO__BUFFER_ORDER]);
    } else {
        result = lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
    }
    lao__delete(allocator, o.bins, LAO__BINS, sizeof *o.bins);
    lao__delete(allocator, o.order, chunk->count, sizeof *o.order);
    return result;
}

static lao_result lao__chunk_make(lao_context *context, lao_chunk *chunk, const lao__texels *texels,
                                  uint64_t first, uint32_t count) {
    lao_buffer_desc buffer;
    lao_result result;
    uint32_t i;
    buffer.texel_count = count;
    buffer.format = LAO_FORMAT_RGBA32F;
    buffer.data = texels->points + 4 * first;
    result =
        context->backend.buffer_create(context->self, &buffer, &chunk->buffers[LAO__BUFFER_POINTS]);
    if (result == LAO_OK) {
        buffer.format = LAO_FORMAT_RGBA8;
        buffer.data = texels->colors + 4 * first;
        result = context->backend.buffer_create(context->self, &buffer,
                                                &chunk->buffers[LAO__BUFFER_COLORS]);
    }
    chunk->count = count - 3;
    for (i = 0; i < LAO_PARTS; i++) {
        const uint64_t end = texels->ends[i] > first ? texels->ends[i] - first : 0;
        chunk->ends[i] = end < chunk->count ? (uint32_t)end : chunk->count;
    }
    if (result == LAO_OK && texels->timed) {
        result = lao__chunk_order(context, chunk, texels->points + 4 * first);
    }
    return result;
}

/* Buffers of at most max_buffer_texels; a chunk begins 3 texels before the last one's end, where
 * its segments end. */
static lao_result lao__lines_upload(lao_context *context, const lao__texels *texels,
                                    lao__lines *lines) {
    uint64_t most = context->caps.max_buffer_texels, first, segments;
    lao_result result = LAO_OK;
    uint32_t i;
    most = most > 0x1000000u ? 0x1000000u : most; /* segments that floats tell apart */
    if (texels->count < 4) {
        return LAO_OK;
    }
    segments = texels->count - 3;
    lines->chunk_count = (uint32_t)((segments + most - 4) / (most - 3));
    lines->chunks =
        (lao_chunk *)lao__new(&context->allocator, lines->chunk_count, sizeof *lines->chunks);
    if (!lines->chunks) {
        lines->chunk_count = 0;
        return lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
    }
    for (i = 0, first = 0; i < lines->chunk_count && result == LAO_OK; i++) {
        uint64_t count = texels->count - first < most ? texels->count - first : most;
        result = lao__chunk_make(context, &lines->chunks[i], texels, first, (uint32_t)count);
        first += count - 3;
    }
    return result;
}

static lao_result lao__lines_fill(lao_context *context, const lao_lines_desc *desc,
                                  lao__lines *lines) {
    uint32_t whole[2];
    const uint32_t *offsets = desc->offsets;
    lao__texels texels;
    lao_result result;
    uint64_t capacity;
    memset(lines, 0, sizeof *lines);
    memset(&texels, 0, sizeof texels);
    texels.timed = desc->times != NULL;
    whole[0] = 0;
    whole[1] = desc->point_count;
    offsets = offsets ? offsets : whole;
    result = lao__lines_check(context, desc, offsets);
    if (result != LAO_OK) {
        return result;
    }
    lao__lines_walk(&texels, desc, offsets);
    capacity = texels.count;
    if (capacity > 0xfffffff0u) {
        return lao__fail(context, LAO_LOG_LINES_COUNT, NULL);
    }
    if (capacity > 0) {
        texels.count = 0;
        texels.points = (float *)lao__new(&context->allocator, (size_t)capacity, 4 * sizeof(float));
        texels.colors = (uint8_t *)lao__new(&context->allocator, (size_t)capacity, 4);
        if (texels.points && texels.colors) {
            lao__lines_walk(&texels, desc, offsets);
            result = lao__lines_upload(context, &texels, lines);
        } else {
            result = lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
        }
        lao__delete(&context->allocator, texels.points, (size_t)capacity, 4 * sizeof(float));
        lao__delete(&context->allocator, texels.colors, (size_t)capacity, 4);
    }
    if (result != LAO_OK) {
        lao__lines_clear(context, lines);
        return result;
    }
    lao__lines_box(lines, desc);
    return LAO_OK;
}

lao_result lao_limits_get(const lao_context *context, lao_limits *limits) {
    if (!context || !limits) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    limits->image_size = context->caps.max_image_size;
    limits->buffer_texels = context->caps.max_buffer_texels;
    return LAO_OK;
}

lao_result lao_lines_create(lao_context *context, const lao_lines_desc *desc, lao_lines *lines) {
    lao__lines *object;
    lao_result result;
    uint32_t id;
    if (!context || !desc || !lines) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_create")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    object = (lao__lines *)lao__new(&context->allocator, 1, sizeof *object);
    if (!object) {
        return lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
    }
    result = lao__lines_fill(context, desc, object);
    if (result == LAO_OK) {
        id = lao__handle_add(&context->allocator, &context->lines, object);
        if (id) {
            lines->id = id;
            return LAO_OK;
        }
        lao__lines_clear(context, object);
        result = lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
    }
    lao__delete(&context->allocator, object, 1, sizeof *object);
    return result;
}

static lao__lines *lao__lines_get(lao_context *context, lao_lines lines) {
    lao__handle *handle = lao__handle_get(&context->lines, lines.id);
    return handle ? (lao__lines *)handle->object : NULL;
}

lao_result lao_lines_update(lao_context *context, lao_lines lines, const lao_lines_desc *desc) {
    lao__lines *object, fresh;
    lao_result result;
    if (!context || !desc) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_update")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    object = lao__lines_get(context, lines);
    if (!object) {
        return lao__fail(context, LAO_LOG_LINES_HANDLE, "lao_lines_update");
    }
    result = lao__lines_fill(context, desc, &fresh);
    if (result == LAO_OK) {
        lao__lines_clear(context, object);
        *object = fresh;
    }
    return result;
}

lao_result lao_lines_destroy(lao_context *context, lao_lines lines) {
    lao__handle *handle;
    if (!context) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    handle = lao__handle_get(&context->lines, lines.id);
    if (!handle) {
        return lao__fail(context, LAO_LOG_LINES_HANDLE, "lao_lines_destroy");
    }
    lao__lines_clear(context, (lao__lines *)handle->object);
    lao__delete(&context->allocator, handle->object, 1, sizeof(lao__lines));
    handle->object = NULL;
    return LAO_OK;
}

lao_result lao_lines_bounds(lao_context *context, lao_lines lines, float bounds[2][3]) {
    lao__lines *object;
    if (!context || !bounds) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_bounds")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    object = lao__lines_get(context, lines);
    if (!object) {
        return lao__fail(context, LAO_LOG_LINES_HANDLE, "lao_lines_bounds");
    }
    memcpy(bounds, object->bounds, sizeof object->bounds);
    return LAO_OK;
}

/* ===============================================================================================================
 * objects */

static lao_result lao__object_check(lao_context *context, const lao_object_desc *desc) {
    uint32_t i, k;
    if (desc->buffer_count > 0 && !desc->buffers) {
        return lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_object_desc.buffers");
    }
    for (i = 0; i < desc->buffer_count; i++) {
        const lao_object_buffer *buffer = &desc->buffers[i];
        uint32_t known = 0;
        for (k = 0; buffer->name && k < context->graph.buffer_count; k++) {
            known += strcmp(context->graph.buffers[k]->name, buffer->name) == 0;
        }
        for (k = 0; known && k < i; k++) {
            known = strcmp(desc->buffers[k].name, buffer->name) != 0 && known;
        }
        if (!known || !buffer->data || buffer->texel_count == 0 ||
            buffer->texel_count > context->caps.max_buffer_texels) {
            return lao__fail(context, LAO_LOG_OBJECT_BUFFER,
                             buffer->name ? buffer->name : "(no name)");
        }
    }
    if (desc->triangle_count > 0x2aaaaaaau) {
        return lao__fail(context, LAO_LOG_OBJECT_BUFFER, "triangle_count is beyond 32-bit indices");
    }
    return LAO_OK;
}

/* Uploads all buffers of desc, then puts them into `object` in place of those that are there. */
static lao_result lao__object_fill(lao_context *context, const lao_object_desc *desc,
                                   lao__object *object) {
    lao_chunk fresh;
    lao_result result = lao__object_check(context, desc);
    uint32_t i, k;
    memset(&fresh, 0, sizeof fresh);
    for (i = 0; i < desc->buffer_count && result == LAO_OK; i++) {
        lao_buffer_desc buffer;
        for (k = 0; strcmp(context->graph.buffers[k]->name, desc->buffers[i].name) != 0; k++) {
        }
        buffer.format = context->graph.buffers[k]->format;
        buffer.texel_count = desc->buffers[i].texel_count;
        buffer.data = desc->buffers[i].data;
        result = context->backend.buffer_create(context->self, &buffer, &fresh.buffers[k]);
    }
    if (result != LAO_OK) {
        lao__chunk_clear(context, &fresh);
        return result;
    }
    for (i = 0; i < LAO_MAX_BUFFERS; i++) {
        if (fresh.buffers[i]) {
            if (object->chunk.buffers[i]) {
                context->backend.buffer_destroy(context->self, object->chunk.buffers[i]);
            }
            object->chunk.buffers[i] = fresh.buffers[i];
        }
    }
    object->chunk.count = desc->triangle_count;
    object->item_count = desc->item_count;
    memcpy(object->further_items, desc->further_items, sizeof object->further_items);
    memcpy(object->bounds, desc->bounds, sizeof object->bounds);
    return LAO_OK;
}

lao_result lao_object_create(lao_context *context, const lao_object_desc *desc,
                             lao_object *object) {
    lao__object *made;
    lao_result result;
    uint32_t id;
    if (!context || !desc || !object) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_object_create")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    made = (lao__object *)lao__new(&context->allocator, 1, sizeof *made);
    if (!made) {
        return lao__fail(context, LAO_LOG_OBJECT_MEMORY, NULL);
    }
    result = lao__object_fill(context, desc, made);
    if (result == LAO_OK) {
        id = lao__handle_add(&context->allocator, &context->objects, made);
        if (id) {
            object->id = id;
            return LAO_OK;
        }
        result = lao__fail(context, LAO_LOG_OBJECT_MEMORY, NULL);
    }
    lao__object_free(context, made);
    return result;
}

static lao__object *lao__object_get(lao_context *context, lao_object object) {
    lao__handle *handle = lao__handle_get(&context->objects, object.id);
    return handle ? (lao__object *)handle->object : NULL;
}

lao_result lao_object_update(lao_context *context, lao_object object, const lao_object_desc *desc) {
    lao__object *found;
    if (!context || !desc) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_object_update")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    found = lao__object_get(context, object);
    return found ? lao__object_fill(context, desc, found)
                 : lao__fail(context, LAO_LOG_OBJECT_HANDLE, "lao_object_update");
}

lao_result lao_object_destroy(lao_context *context, lao_object object) {
    lao__handle *handle;
    if (!context) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    handle = lao__handle_get(&context->objects, object.id);
    if (!handle) {
        return lao__fail(context, LAO_LOG_OBJECT_HANDLE, "lao_object_destroy");
    }
    lao__object_free(context, (lao__object *)handle->object);
    handle->object = NULL;
    return LAO_OK;
}

/* ===============================================================================================================
 * views */

static lao__view *lao__view_get(lao_context *context, lao_view view) {
    lao__handle *handle = lao__handle_get(&context->views, view.id);
    return handle ? (lao__view *)handle->object : NULL;
}

static int lao__view_size_ok(const lao_context *context, uint32_t width, uint32_t height) {
    return width > 0 && height > 0 && width <= context->caps.max_image_size &&
           height <= context->caps.max_image_size;
}

lao_result lao_view_create(lao_context *context, const lao_view_desc *desc, lao_view *view) {
    lao__view *object;
    lao_result result;
    uint32_t id = 0;
    if (!context || !desc || !view) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_view_create")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    if (!lao__view_size_ok(context, desc->width, desc->height)) {
        return lao__fail(context, LAO_LOG_VIEW_SIZE, "lao_view_create");
    }
    object = (lao__view *)lao__new(&context->allocator, 1, sizeof *object);
    if (!object) {
        return lao__fail(context, LAO_LOG_VIEW_MEMORY, NULL);
    }
    object->width = desc->width;
    object->height = desc->height;
    object->flags = desc->flags;
    result = context->backend.view_create(context->self, &object->backend_view);
    if (result == LAO_OK) {
        id = lao__handle_add(&context->allocator, &context->views, object);
        result = id ? LAO_OK : lao__fail(context, LAO_LOG_VIEW_MEMORY, NULL);
    }
    if (result != LAO_OK) {
        lao__view_free(context, object);
        return result;
    }
    view->id = id;
    return LAO_OK;
}

lao_result lao_view_resize(lao_context *context, lao_view view, uint32_t width, uint32_t height) {
    lao__view *object;
    if (!context) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    object = lao__view_get(context, view);
    if (!object) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_view_resize");
    }
    if (!lao__view_size_ok(context, width, height)) {
        return lao__fail(context, LAO_LOG_VIEW_SIZE, "lao_view_resize");
    }
    object->width = width;
    object->height = height;
    return LAO_OK;
}

lao_result lao_view_destroy(lao_context *context, lao_view view) {
    lao__handle *handle;
    if (!context) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    handle = lao__handle_get(&context->views, view.id);
    if (!handle) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_view_destroy");
    }
    lao__view_free(context, (lao__view *)handle->object);
    handle->object = NULL;
    return LAO_OK;
}

/* ==============================================================================================================
 * frames */

static lao_result lao__view_reserve(lao_context *context, lao__view *view, uint32_t sets) {
    if (sets <= view->set_capacity) {
        return LAO_OK;
    }
    lao__view_frames_free(context, view);
    view->prepared = 0;
    view->set_capacity = sets;
    view->values = (float *)lao__new(&context->allocator, (size_t)sets * context->value_count,
                                     sizeof *view->values);
    view->value_rows =
        (const float **)lao__new(&context->allocator, sets, sizeof *view->value_rows);
    view->uniforms = (uint8_t *)lao__new(
        &context->allocator,
        (size_t)sets * context->graph.module_count * context->host.settings_size, 1);
    view->draws = (lao_draw *)lao__new(&context->allocator, sets, sizeof *view->draws);
    view->buffers = (uint32_t *)lao__new(&context->allocator, sets, sizeof *view->buffers);
    if (!view->values || !view->value_rows || !view->uniforms || !view->draws || !view->buffers) {
        lao__view_frames_free(context, view);
        return lao__fail(context, LAO_LOG_FRAME_MEMORY, NULL);
    }
    return LAO_OK;
}

/* Resolves one set's settings; sets *structural when a value that shapes the plan changed. */
/* Is it worth while to draw a set's lines in parts? Not where few lie behind each other. */
static int lao__parted(const lao__view *view, const lao_frame *frame, uint32_t set,
                       const float *values) {
    const int trail = (int)values[LAO_SETTING_ID_trail];
    const lao_draw *draw = &view->draws[set];
    const double factor = values[LAO_SETTING_ID_supersampling];
    const double pixels = factor * factor * view->width * view->height;
    double segments = 0, rest = 0;
    uint32_t i;
    for (i = 0; i < draw->chunk_count; i++) {
        segments += draw->chunks[i].count;
        rest += draw->chunks[i].count - draw->chunks[i].ends[0];
    }
    for (i = 0; i < frame->import_count; i++) { /* a G-buffer of the host's: nothing is drawn */
        const char *image = frame->imports[i].image;
        rest = image && strcmp(image, "host_depth") == 0 ? rest : 0;
    }
    return values[LAO_SETTING_ID_cull_hidden] > 0 && trail != LAO_TRAIL_TAPER &&
           trail != LAO_TRAIL_OPACITY && rest > 0 && segments * LAO__DENSE >= pixels;
}

static lao_result lao__set_resolve(lao_context *context, lao__view *view, const lao_frame *frame,
                                   uint32_t set, const lao_set *source, int *structural) {
    float *values = view->values + (size_t)set * context->value_count;
    uint32_t m, i, first = 0;
    char text[128];
    for (m = 0; m < context->graph.module_count; m++) {
        const lao_module *module = context->graph.modules[m];
        uint8_t *block = view->uniforms + ((size_t)set * context->graph.module_count + m) *
                                              context->host.settings_size;
        const void *settings = NULL;
        float fresh[LAO__MOST_SETTINGS];
        int fault;
        if (source && m == 0) {
            settings = source->settings;
        } else if (source && source->module_settings) {
            settings = source->module_settings[m - 1];
        }
        fault = lao_settings_resolve(module, settings, fresh);
        if (fault >= 0) {
            const lao_setting_row *row = &module->settings[fault];
            snprintf(text, sizeof text, "%s = %g, must be %g to %g", row->name,
                     (double)fresh[fault], (double)row->minimum, (double)row->maximum);
            return lao__fail(context, LAO_LOG_SETTING_RANGE, text);
        }
        memcpy(block, fresh, module->setting_count * sizeof *fresh);
        if (m == 0) { /* the plan follows what is done */
            view->draws[set].parted = lao__parted(view, frame, set, fresh);
            fresh[LAO_SETTING_ID_cull_hidden] = view->draws[set].parted ? LAO_PARTS - 1.0f : 0.0f;
        }
        for (i = 0; i < module->setting_count; i++) {
            *structural |= module->settings[i].structural && fresh[i] != values[first + i];
        }
        memcpy(values + first, fresh, module->setting_count * sizeof *fresh);
        first += module->setting_count;
    }
    view->value_rows[set] = values;
    return LAO_OK;
}

static uint32_t lao__mix(uint32_t h, uint32_t v) {
    return lao_hash(h ^ (v + 0x9e3779b9u + (h << 6)));
}

/* What besides settings shapes a plan. */
static void lao__plan_key(const lao__view *view, const lao_frame *frame, uint32_t sets,
                          uint32_t key[LAO__KEY_SIZE]) {
    uint32_t i;
    memset(key, 0, LAO__KEY_SIZE * sizeof *key);
    key[0] = view->width;
    key[1] = view->height;
    key[2] = sets;
    key[3] = frame->camera.flags & LAO_CAMERA_REVERSE_DEPTH;
    key[4] = frame->target.present != 0;
    key[5] = frame->import_count;
    for (i = 0; i < frame->import_count; i++) {
        const char *c;
        for (c = frame->imports[i].image; *c; c++) {
            key[6] = lao__mix(key[6], (uint32_t)(unsigned char)*c);
        }
        key[6] = lao__mix(key[6], frame->imports[i].source.flags & LAO_HOST_WRITABLE);
    }
    key[8] = lao__mix(view->item_count, frame->flags & LAO_FRAME_SHARED_OCCLUSION);
    for (i = 0; i < LAO_FURTHER_ITEMS; i++) {
        key[8] = lao__mix(key[8], view->further_items[i]);
    }
    for (i = 0; i < sets; i++) {
        key[8] = lao__mix(key[8], view->buffers[i]);
    }
    /* attachments of pipelines carry the host's formats */
    key[7] = lao__mix(frame->target.native_format, frame->target.flags & LAO_HOST_ENCODE_SRGB);
    for (i = 0; i < frame->import_count; i++) {
        key[7] = lao__mix(key[7], frame->imports[i].source.native_format);
    }
}

static lao_result lao__imports_check(lao_context *context, const lao__view *view,
                                     const lao_frame *frame) {
    uint32_t i, factor = (uint32_t)view->values[LAO_SETTING_ID_supersampling];
    if (frame->target.present &&
        (frame->target.width != view->width || frame->target.height != view->height)) {
        return lao__fail(context, LAO_LOG_TARGET, "lao_frame.target");
    }
    for (i = 0; i < frame->import_count; i++) {
        const lao_import *import = &frame->imports[i];
        uint32_t image =
            import->image ? lao__image_find(&context->graph, import->image) : LAO_NO_INDEX;
        uint32_t scale;
        if (image == LAO_NO_INDEX || !import->source.present ||
            strcmp(import->image, "target") == 0) {
            return lao__fail(context, LAO_LOG_IMPORT, import->image ? import->image : "(no name)");
        }
        scale = context->graph.images[image]->size == LAO_SIZE_FULL ? factor : 1;
        if (import->source.width != view->width * scale ||
            import->source.height != view->height * scale) {
            return lao__fail(context, LAO_LOG_IMPORT, import->image);
        }
    }
    return LAO_OK;
}

/* An import drops the passes that make its image; what else they made must then not be missed. */
static const char *lao__missing_image(const lao_graph *graph, const lao_plan *plan, uint32_t s) {
    const lao_plan_step *step = &plan->steps[s];
    uint32_t i;
    for (i = 0; i < step->read_count; i++) {
        if (step->reads[i] < plan->instance_count) {
            const lao_plan_instance *instance = &plan->instances[step->reads[i]];
            const lao_image_row *row = graph->images[instance->image];
            int previous = (row->flags & LAO_IMAGE_HISTORY) && instance->phase == 1;
            if (instance->import == LAO_NO_INDEX && !previous &&
                !lao__is_written(plan, step->reads[i], s)) {
                return row->name;
            }
        }
    }
    return NULL;
}

static lao_result lao__plan_check(lao_context *context, const lao_plan *plan,
                                  const uint32_t *buffers) {
    uint32_t s, i, n;
    char text[160];
    for (s = 0; s < plan->step_count; s++) {
        const lao_plan_step *step = &plan->steps[s];
        const char *missing = lao__missing_image(&context->graph, plan, s);
        if (missing) {
            snprintf(text, sizeof text, "'%s' is not imported, and nothing else makes it", missing);
            return lao__fail(context, LAO_LOG_IMPORT, text);
        }
        for (i = 0, n = 0; i < step->read_count; i++) {
            int absent = step->reads[i] == LAO_NO_INDEX ||
                         (LAO_READ_IS_BUFFER(step->reads[i]) &&
                          !((buffers[step->set] >> (step->reads[i] - LAO_READ_BUFFER)) & 1u));
            n += !absent && (i == 0 || step->reads[i] != step->reads[i - 1]);
        }
        if (n > context->caps.max_texture_units) {
            return lao__fail(context, LAO_LOG_UNITS, step->row->name);
        }
        if (step->width > context->caps.max_image_size ||
            step->height > context->caps.max_image_size) {
            return lao__fail(context, LAO_LOG_VIEW_SIZE, step->row->name);
        }
    }
    return LAO_OK;
}

static lao_result lao__view_plan(lao_context *context, lao__view *view, const lao_frame *frame,
                                 uint32_t sets) {
    lao_plan_desc desc;
    lao_result result;
    memset(&desc, 0, sizeof desc);
    desc.width = view->width;
    desc.height = view->height;
    desc.flags = view->flags;
    desc.reverse_depth = (frame->camera.flags & LAO_CAMERA_REVERSE_DEPTH) != 0;
    desc.set_count = sets;
    desc.values = view->value_rows;
    desc.imports = frame->imports;
    desc.import_count = frame->import_count;
    desc.has_target = frame->target.present != 0;
    desc.shaders = context->shaders;
    desc.item_count = view->item_count;
    memcpy(desc.further_items, view->further_items, sizeof desc.further_items);
    desc.buffers = view->buffers;
    desc.shared_occlusion = (frame->flags & LAO_FRAME_SHARED_OCCLUSION) != 0;
    view->prepared = 0;
    view->rendered = 0;
    view->history = 0;
    view->plan.serial = context->next_serial++;
    if (lao_plan_make(&context->graph, &desc, &context->allocator, &view->plan) != LAO_OK) {
        return lao__fail(context, LAO_LOG_PLAN_MEMORY, NULL);
    }
    result = lao__plan_check(context, &view->plan, view->buffers);
    if (result == LAO_OK) {
        result = context->backend.view_prepare(context->self, view->backend_view, &view->plan,
                                               context->shaders);
    }
    view->prepared = result == LAO_OK;
    return result;
}

/* Centre and radius of everything that is drawn (METHODS 1.3). */
static void lao__scene_sphere(lao_context *context, const lao_frame *frame, float least,
                              double sphere[4]) {
    double lo[3] = {0, 0, 0}, hi[3] = {0, 0, 0}, squared = 0;
    uint32_t s, k;
    int any = 0;
    if (frame->sphere[3] > 0) {
        for (k = 0; k < 4; k++) {
            sphere[k] = frame->sphere[k];
        }
        return;
    }
    for (s = 0; s < 2 * frame->set_count; s++) {
        const lao_set *set = &frame->sets[s / 2];
        const lao__lines *lines = s & 1 ? NULL : lao__lines_get(context, set->lines);
        const lao__object *object = s & 1 ? lao__object_get(context, set->object) : NULL;
        const float(*box)[3] = lines && lines->has_points ? (const float(*)[3])lines->bounds
                               : object                   ? (const float(*)[3])object->bounds
                                                          : NULL;
        for (k = 0; box && k < 3; k++) {
            lo[k] = any && lo[k] < box[0][k] ? lo[k] : box[0][k];
            hi[k] = any && hi[k] > box[1][k] ? hi[k] : box[1][k];
        }
        any |= box != NULL;
    }
    for (k = 0; k < 3; k++) {
        sphere[k] = 0.5 * (lo[k] + hi[k]);
        squared += 0.25 * (hi[k] - lo[k]) * (hi[k] - lo[k]);
    }
    sphere[3] = sqrt(squared);
    sphere[3] = sphere[3] < 0.5 * least ? 0.5 * least : sphere[3];
}

static lao_v4 lao__column(const float *m) {
    return lao_v4_make(m[0], m[1], m[2], m[3]);
}

static lao_m4 lao__matrix(const float m[16]) {
    lao_m4 r;
    r.x = lao__column(m);
    r.y = lao__column(m + 4);
    r.z = lao__column(m + 8);
    r.w = lao__column(m + 12);
    return r;
}

/* The inverse of an affine matrix; lao_camera_canonical has refused singular ones. */
static lao_m4 lao__affine_inverse(const float m[16]) {
    double a[3][3], inverse[3][3], d;
    float out[16];
    int r, c;
    for (r = 0; r < 3; r++) {
        for (c = 0; c < 3; c++) {
            a[r][c] = m[c * 4 + r];
        }
    }
    d = lao__determinant3((const double(*)[3])a);
    memset(out, 0, sizeof out);
    for (r = 0; r < 3; r++) {
        for (c = 0; c < 3; c++) { /* cofactors, transposed */
            int i = (c + 1) % 3, k = (c + 2) % 3, j = (r + 1) % 3, l = (r + 2) % 3;
            inverse[r][c] = (a[i][j] * a[k][l] - a[i][l] * a[k][j]) / d;
            out[c * 4 + r] = (float)inverse[r][c];
        }
    }
    for (r = 0; r < 3; r++) {
        out[12 + r] =
            (float)-(inverse[r][0] * m[12] + inverse[r][1] * m[13] + inverse[r][2] * m[14]);
    }
    out[15] = 1;
    return lao__matrix(out);
}

static void lao__frame_uniforms_fill(const lao__view *view, const lao_frame *frame,
                                     const lao_camera *camera, const double sphere[4],
                                     lao_frame_uniforms *u) {
    const float *p = camera->projection, *v = camera->view;
    double factor = view->values[LAO_SETTING_ID_supersampling];
    double w = view->width * factor, h = view->height * factor;
    double zc = -(v[2] * sphere[0] + v[6] * sphere[1] + v[10] * sphere[2] + v[14]);
    double range = 2 * sphere[3];
    const lao_image *depth = NULL;
    uint32_t i;
    int orthographic = p[11] == 0, mm = view->values[LAO_SETTING_ID_depth_unit] > 0.5f;
    memset(u, 0, sizeof *u);
    u->view = lao__matrix(v);
    u->projection = lao__matrix(p);
    u->world = lao__affine_inverse(v);
    /* ndc = P00 slope - P02 (perspective), P00 x + P03 (orthographic) */
    u->ray.x = (float)(2 / (w * p[0]));
    u->ray.y = (float)(2 / (h * p[5]));
    u->ray.z = (float)((-1 + (orthographic ? -p[12] : p[8])) / p[0]);
    u->ray.w = (float)((-1 + (orthographic ? -p[13] : p[9])) / p[5]);
    u->viewport = lao_v4_make((float)w, (float)h, (float)(1 / w), (float)(1 / h));
    u->depth = lao_v4_make((float)(zc - sphere[3]), (float)(1 / range), (float)range,
                           orthographic ? 1.0f : 0.0f);
    u->scale = lao_v4_make((float)(0.5 * w * p[0]), (float)(0.5 * h * p[5]),
                           camera->flags & LAO_CAMERA_REVERSE_DEPTH ? 1.0f : 0.0f, frame->time);
    u->unproject = lao_v4_make(p[14], -p[15], p[10], -p[11]);
    {
        const float *b = frame->background;
        float alpha = lao_clamp01(b[3]);
        u->background = lao_v4_make(lao_clamp01(b[0]) * alpha, lao_clamp01(b[1]) * alpha,
                                    lao_clamp01(b[2]) * alpha, alpha);
    }
    u->target = lao_v4_make((float)frame->target.width, (float)frame->target.height,
                            frame->target.flags & LAO_HOST_TOP_DOWN ? 1.0f : 0.0f,
                            frame->target.flags & LAO_HOST_ENCODE_SRGB ? 1.0f : 0.0f);
    for (i = 0; i < frame->import_count; i++) {
        depth =
            strcmp(frame->imports[i].image, "host_depth") == 0 ? &frame->imports[i].source : depth;
    }
    if (depth) {
        u->host_depth = lao_v4_make((float)depth->width, (float)depth->height,
                                    depth->flags & LAO_HOST_TOP_DOWN ? 1.0f : 0.0f, 0.0f);
    }
    u->host_depth.w =
        mm ? (float)range : 1.0f; /* depth differences times this are what the thresholds mean */
    u->previous_view = lao__matrix(view->history ? view->previous.view : v);
    u->previous_projection = lao__matrix(view->history ? view->previous.projection : p);
    u->history.x = (float)(view->history < 0xffffffu ? view->history : 0xffffffu);
}

/* The window of time that a trail leaves of a set's lines. */
static lao_window lao__window(const float *values, float time) {
    const int trail = (int)values[LAO_SETTING_ID_trail];
    lao_window window;
    window.limited = trail == LAO_TRAIL_TAPER || trail == LAO_TRAIL_OPACITY;
    window.length = values[LAO_SETTING_ID_trail_length];
    window.period = values[LAO_SETTING_ID_period];
    window.now = lao_trail_now(time, window.period);
    return window;
}

/* Settings, lines and object of one set. */
static lao_result lao__frame_set(lao_context *context, lao__view *view, const lao_frame *frame,
                                 const lao_set *set, uint32_t index, int *structural) {
    const lao__lines *lines = set ? lao__lines_get(context, set->lines) : NULL;
    const lao__object *object = set ? lao__object_get(context, set->object) : NULL;
    lao_draw *draw = &view->draws[index];
    lao_result result;
    uint32_t i;
    if (set && set->lines.id != 0 && !lines) {
        return lao__fail(context, LAO_LOG_LINES_HANDLE, "lao_frame.sets");
    }
    if (set && set->object.id != 0 && !object) {
        return lao__fail(context, LAO_LOG_OBJECT_HANDLE, "lao_frame.sets");
    }
    memset(draw, 0, sizeof *draw);
    if (lines && lines->chunk_count > 0) {
        draw->chunks = lines->chunks;
        draw->chunk_count = lines->chunk_count;
    }
    draw->object = object ? &object->chunk : NULL;
    /* the first set, and one that draws nothing, clear what others draw into */
    view->buffers[index] = index == 0 || !object ? LAO__LINE_BUFFERS : 0;
    for (i = 0; i < LAO_MAX_BUFFERS; i++) {
        if ((draw->chunks && draw->chunks[0].buffers[i]) ||
            (draw->object && draw->object->buffers[i])) {
            view->buffers[index] |= 1u << i;
        }
    }
    if (object && object->item_count > view->item_count) {
        view->item_count = object->item_count;
    }
    for (i = 0; object && i < LAO_FURTHER_ITEMS; i++) {
        if (object->further_items[i] > view->further_items[i]) {
            view->further_items[i] = object->further_items[i];
        }
    }
    result = lao__set_resolve(context, view, frame, index, set, structural);
    draw->window = lao__window(view->value_rows[index], frame->time);
    return result;
}

static lao_result lao__frame_sets(lao_context *context, lao__view *view, const lao_frame *frame,
                                  uint32_t sets, int *structural) {
    lao_result result = LAO_OK;
    uint32_t s;
    view->item_count = 0;
    memset(view->further_items, 0, sizeof view->further_items);
    for (s = 0; s < sets && result == LAO_OK; s++) {
        result = lao__frame_set(context, view, frame, s < frame->set_count ? &frame->sets[s] : NULL,
                                s, structural);
    }
    return result;
}

uint32_t lao_step_draws(const lao_execution *execution, const lao_plan_step *step,
                        const lao_chunk **chunks) {
    static const lao_chunk nothing = {{NULL}, 0, {0}, NULL, 0};
    const lao_draw *draw = &execution->draws[step->set];
    switch (step->row->kind) {
    case LAO_PASS_DRAW_LINES:
    case LAO_PASS_DRAW_LINES_FIRST:
    case LAO_PASS_DRAW_LINES_REST:
        *chunks = draw->chunks;
        return draw->chunk_count;
    case LAO_PASS_DRAW_MESH:
        *chunks = draw->object;
        return draw->object && draw->object->count > 0;
    default:
        *chunks = draw->object ? draw->object : &nothing;
        return 1;
    }
}

/* Does some repetition of the window reach the group? Rather too often than that rounding lets the
   vertex stage see what is left out here. */
static int lao__group_seen(const lao_group *group, const lao_window *window) {
    const double now = window->now, reach = window->length, period = window->period;
    const double begin = group->begin, end = group->end;
    const double slack = 1e-5 * (fabs(begin) + fabs(end) + fabs(now) + reach + period);
    const double low = begin - now - reach - slack, high = end - now + reach + slack;
    return !(period > 0 ? period * floor(high / period) < low : low > 0 || high < 0);
}

static void lao__range_part(lao_range *range, const lao_draw *draw, const lao_chunk *chunk,
                            const lao_plan_step *step) {
    const lao_pass_kind kind = step->row->kind;
    const uint32_t part = kind == LAO_PASS_DRAW_LINES_REST ? step->iteration + 1 : 0;
    const int whole = kind == LAO_PASS_DRAW_LINES || !draw->parted;
    range->first = part > 0 ? chunk->ends[part - 1] : 0;
    range->count = (whole ? chunk->count : chunk->ends[part]) - range->first;
}

int lao_step_range(const lao_execution *execution, const lao_plan_step *step,
                   const lao_chunk *chunk, lao_range *range) {
    const lao_window *window = &execution->draws[step->set].window;
    const lao_group *groups = chunk->groups;
    uint32_t i, g = range->next;
    int ordered = 0;
    for (i = 0; i < step->read_count; i++) {
        ordered |= step->reads[i] == LAO_READ_BUFFER + LAO__BUFFER_ORDER;
    }
    if (!ordered || !window->limited || !groups) {
        lao__range_part(range, &execution->draws[step->set], chunk, step);
        return range->next++ == 0 && range->count > 0;
    }
    while (g < chunk->group_count && !lao__group_seen(&groups[g], window)) {
        g++;
    }
    for (i = g; g < chunk->group_count && lao__group_seen(&groups[g], window); g++) {
        range->first = groups[i].first;
        range->count = groups[g].first + groups[g].count - range->first;
    }
    range->next = g;
    return g > i;
}

static lao_result lao__frame_execute(lao_context *context, lao__view *view, const lao_frame *frame,
                                     const lao_camera *camera, uint32_t sets) {
    lao_execution execution;
    lao_frame_uniforms uniforms;
    double sphere[4];
    float widest = 0;
    lao_result result;
    uint32_t s;
    for (s = 0; s < sets; s++) {
        widest = lao_max(widest, view->value_rows[s][LAO_SETTING_ID_width]);
    }
    lao__scene_sphere(context, frame, widest, sphere);
    lao__frame_uniforms_fill(view, frame, camera, sphere, &uniforms);
    memset(&execution, 0, sizeof execution);
    execution.plan = &view->plan;
    execution.parity = view->frame & 1;
    execution.frame_uniforms = &uniforms;
    execution.frame_size = (uint32_t)sizeof uniforms;
    execution.set_uniforms = view->uniforms;
    execution.draws = view->draws;
    execution.set_count = sets;
    execution.imports = frame->imports;
    execution.import_count = frame->import_count;
    execution.target = frame->target;
    execution.flags = frame->flags;
    execution.commands = frame->commands;
    result = context->backend.execute(context->self, view->backend_view, &execution);
    if (result == LAO_OK) {
        view->frame++;
        view->history++;
        view->previous = *camera;
        view->rendered = 1;
        view->timed = (frame->flags & LAO_FRAME_TIMINGS) != 0;
    }
    return result;
}

lao_result lao_render(lao_context *context, const lao_frame *frame) {
    lao__view *view;
    lao_camera camera;
    lao_result result;
    uint32_t sets, key[LAO__KEY_SIZE];
    int structural = 0;
    if (!context || !frame || (frame->set_count > 0 && !frame->sets) ||
        (frame->import_count > 0 && !frame->imports)) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_render")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    view = lao__view_get(context, frame->view);
    if (!view) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_render");
    }
    if (lao_camera_canonical(&frame->camera, &camera) != 0) {
        return lao__fail(context, LAO_LOG_CAMERA, NULL);
    }
    sets = frame->set_count > 0 ? frame->set_count : 1;
    result = lao__view_reserve(context, view, sets);
    if (result == LAO_OK) {
        result = lao__frame_sets(context, view, frame, sets, &structural);
    }
    if (result == LAO_OK) {
        result = lao__imports_check(context, view, frame);
    }
    if (result != LAO_OK) {
        view->prepared = 0; /* resolved values no longer tell what the plan was made for */
        return result;
    }
    lao__plan_key(view, frame, sets, key);
    if (!view->prepared || structural || memcmp(key, view->key, sizeof key) != 0) {
        result = lao__view_plan(context, view, frame, sets);
        if (result != LAO_OK) {
            return result;
        }
        memcpy(view->key, key, sizeof key);
    }
    return lao__frame_execute(context, view, frame, &camera, sets);
}

lao_result lao_occlude(lao_context *context, const lao_frame *frame, const lao_settings *settings) {
    static const char *const needed[3] = {"color", "tangent", "depth"};
    lao_set set;
    lao_frame own;
    uint32_t i, k, found = 0;
    if (!context || !frame || (frame->import_count > 0 && !frame->imports)) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_occlude")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    for (k = 0; k < 3; k++) {
        for (i = 0; i < frame->import_count; i++) {
            found += frame->imports[i].image && strcmp(frame->imports[i].image, needed[k]) == 0;
        }
    }
    if (found != 3 || !(frame->sphere[3] > 0)) {
        return lao__fail(context, LAO_LOG_IMPORT,
                         "lao_occlude needs color, tangent, depth and a sphere");
    }
    memset(&set, 0, sizeof set);
    set.settings = settings;
    own = *frame;
    own.sets = &set;
    own.set_count = 1;
    return lao_render(context, &own);
}

/* =============================================================================================================
 * reading */

static lao_result lao__read_instance(lao_context *context, lao_view handle, const char *image,
                                     uint32_t level, lao__view **view,
                                     const lao_plan_instance **found) {
    uint32_t i, k, row;
    const lao_plan *plan;
    *found = NULL;
    if (!context || !image) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_read")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    *view = lao__view_get(context, handle);
    if (!*view) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_read");
    }
    if (!(*view)->rendered) {
        return lao__fail(context, LAO_LOG_NOTHING_RENDERED, image);
    }
    plan = &(*view)->plan;
    row = lao__image_find(&context->graph, image);
    /* of ping-pong partners the one that was written last */
    for (i = 0; i < plan->instance_count; i++) {
        const lao_plan_instance *instance = &plan->instances[i];
        if (instance->image == row && instance->level == level &&
            instance->import == LAO_NO_INDEX &&
            (!*found || instance->last_step > (*found)->last_step)) {
            *found = instance;
        }
    }
    for (i = 0; *found && i < plan->instance_count; i++) {
        for (k = 0; k < 2; k++) {
            if (plan->instances[i].slot[k] == (*found)->slot[0] &&
                plan->instances[i].first_step > (*found)->last_step) {
                return lao__fail(
                    context, LAO_LOG_IMAGE_UNKNOWN,
                    "its memory was used again; create the view with LAO_VIEW_KEEP_IMAGES");
            }
        }
    }
    return *found ? LAO_OK : lao__fail(context, LAO_LOG_IMAGE_UNKNOWN, image);
}

lao_result lao_read_raw(lao_context *context, lao_view view, const char *image, uint32_t level,
                        void *data, size_t capacity, lao_read_info *info) {
    lao__view *object = NULL;
    const lao_plan_instance *instance;
    lao_result result = lao__read_instance(context, view, image, level, &object, &instance);
    size_t size;
    if (result != LAO_OK) {
        return result;
    }
    size = (size_t)instance->width * instance->height * lao_format_bytes(instance->format);
    if (data && capacity < size) {
        return lao__fail(context, LAO_LOG_READ_SIZE, image);
    }
    if (data) {
        uint32_t parity = (object->frame - 1) & 1;
        result = context->backend.read(context->self, object->backend_view, &object->plan,
                                       instance->slot[parity], data, size);
    }
    if (result == LAO_OK && info) {
        info->width = instance->width;
        info->height = instance->height;
        info->channels = lao_format_bytes(instance->format);
    }
    return result;
}

static float lao__half(uint32_t h) {
    uint32_t sign = (h & 0x8000u) << 16, exponent = (h >> 10) & 31u, mantissa = h & 0x3ffu;
    if (exponent == 0) {
        float small = (float)mantissa * 5.96046448e-8f;
        return sign ? -small : small;
    }
    if (exponent == 31) {
        return lao_bits_float(sign | 0x7f800000u | (mantissa << 13));
    }
    return lao_bits_float(sign | ((exponent + 112u) << 23) | (mantissa << 13));
}

static uint32_t lao__channel_count(const lao_image_row *row) {
    static const uint8_t plain[LAO_FORMAT_COUNT] = {0, 4, 4, 4, 1, 1, 1, 0};
    static const uint8_t coded[] = {0, 3, 3};
    return row->encoding == LAO_ENCODING_PLAIN ? plain[row->format] : coded[row->encoding];
}

/* One raw texel to the numbers it stands for. align: of the set that wrote it. */
static void lao__decode(const lao_image_row *row, int32_t align, const uint8_t *texel, float *out) {
    float f[4] = {0, 0, 0, 0};
    lao_v4 v;
    uint16_t half[4];
    uint32_t word = 0;
    int i;
    if (row->format == LAO_FORMAT_RGBA8) {
        for (i = 0; i < 4; i++) {
            f[i] = (float)texel[i] * (1.0f / 255.0f); /* as devices do */
        }
    } else if (row->format == LAO_FORMAT_RGBA16F) {
        memcpy(half, texel, sizeof half);
        for (i = 0; i < 4; i++) {
            f[i] = lao__half(half[i]);
        }
    } else if (row->format == LAO_FORMAT_R32UI) {
        memcpy(&word, texel, sizeof word);
        f[0] = (float)word;
    } else {
        memcpy(f, texel, lao_format_bytes(row->format));
    }
    v = lao_v4_make(f[0], f[1], f[2], f[3]);
    if (row->encoding == LAO_ENCODING_LEVEL) {
        lao_v2 direction = lao_level_direction(word, align);
        v = lao_v4_make(direction.x, direction.y, lao_level_depth(word), 0);
    } else if (row->encoding == LAO_ENCODING_SIGNED8) {
        v = lao_v4_make(2 * v.x - 1, 2 * v.y - 1, 2 * v.z - 1, 0);
    }
    memcpy(out, &v, lao__channel_count(row) * sizeof *out);
}

lao_result lao_read(lao_context *context, lao_view view, const char *image, uint32_t level,
                    float *data, size_t capacity, lao_read_info *info) {
    lao__view *object = NULL;
    const lao_plan_instance *instance;
    const lao_image_row *row;
    lao_result result = lao__read_instance(context, view, image, level, &object, &instance);
    size_t i, texels, bytes;
    uint32_t channels, set;
    int32_t align;
    uint8_t *raw;
    if (result != LAO_OK) {
        return result;
    }
    row = context->graph.images[instance->image];
    set = object->plan.steps[instance->last_step].set;
    align =
        (int32_t)object->values[(size_t)set * context->value_count + (size_t)LAO_SETTING_ID_align];
    texels = (size_t)instance->width * instance->height;
    bytes = lao_format_bytes(row->format);
    channels = lao__channel_count(row);
    if (data) {
        if (capacity < texels * channels) {
            return lao__fail(context, LAO_LOG_READ_SIZE, image);
        }
        raw = (uint8_t *)lao__new(&context->allocator, texels, bytes);
        if (!raw) {
            return lao__fail(context, LAO_LOG_FRAME_MEMORY, NULL);
        }
        result = lao_read_raw(context, view, image, level, raw, texels * bytes, NULL);
        for (i = 0; i < texels && result == LAO_OK; i++) {
            lao__decode(row, align, raw + i * bytes, data + i * channels);
        }
        lao__delete(&context->allocator, raw, texels, bytes);
    }
    if (result == LAO_OK && info) {
        info->width = instance->width;
        info->height = instance->height;
        info->channels = channels;
    }
    return result;
}

lao_result lao_timings(lao_context *context, lao_view view, lao_timing *timings, uint32_t *count) {
    lao__view *object;
    lao_result result;
    double *milliseconds;
    uint32_t i, n;
    if (!context || !count) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_timings")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    object = lao__view_get(context, view);
    if (!object) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_timings");
    }
    if (!object->rendered || !object->timed) {
        return lao__fail(context, LAO_LOG_TIMINGS_OFF, NULL);
    }
    n = object->plan.step_count;
    milliseconds = (double *)lao__new(&context->allocator, n, sizeof *milliseconds);
    if (!milliseconds) {
        return lao__fail(context, LAO_LOG_FRAME_MEMORY, NULL);
    }
    result = context->backend.timings(context->self, object->backend_view, milliseconds, n);
    for (i = 0; result == LAO_OK && timings && i < n && i < *count; i++) {
        timings[i].pass = object->plan.steps[i].row->name;
        timings[i].set = object->plan.steps[i].set;
        timings[i].level = object->plan.steps[i].level;
        timings[i].milliseconds = milliseconds[i];
    }
    if (result == LAO_OK) {
        *count = n;
    }
    lao__delete(&context->allocator, milliseconds, n, sizeof *milliseconds);
    return result;
}

/* ========================================================================================================
 * null backend */

typedef struct lao__null {
    lao_null_desc desc;
    const lao_host *host;
    uint32_t calls;
} lao__null;

static lao_result lao__null_call(lao__null *null, const char *name) {
    null->calls++;
    if (null->desc.fail_at == null->calls) {
        null->host->report(null->host->context, LAO_LOG_BACKEND_CALL, name);
        return LAO_ERROR_BACKEND;
    }
    return LAO_OK;
}

static lao_result lao__null_attach(const lao_backend *backend, const lao_host *host, void **self,
                                   lao_backend_caps *caps) {
    lao__null *null = (lao__null *)lao__new(&host->allocator, 1, sizeof *null);
    lao_result result;
    if (!null) {
        host->report(host->context, LAO_LOG_BACKEND_MEMORY, "null");
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    memcpy(&null->desc, backend->storage, sizeof null->desc);
    null->host = host;
    result = lao__null_call(null, "attach");
    if (result != LAO_OK) {
        lao__delete(&host->allocator, null, 1, sizeof *null);
        return result;
    }
    *self = null;
    caps->max_image_size = 16384;
    caps->max_texture_units = 32;
    caps->max_buffer_texels = 1u << 27;
    caps->shaders = null->desc.shaders;
    caps->shader_count = null->desc.shader_count;
    return LAO_OK;
}

static void lao__null_detach(void *self) {
    lao__null *null = (lao__null *)self;
    lao_allocator allocator = null->host->allocator;
    lao__delete(&allocator, null, 1, sizeof *null);
}

static lao_result lao__null_make(lao__null *null, const char *name, void **object) {
    lao_result result = lao__null_call(null, name);
    void *memory;
    if (result != LAO_OK) {
        return result;
    }
    memory = lao__new(&null->host->allocator, 1, 1);
    if (!memory) {
        null->host->report(null->host->context, LAO_LOG_BACKEND_MEMORY, name);
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    *object = memory;
    return LAO_OK;
}

static lao_result lao__null_buffer_create(void *self, const lao_buffer_desc *desc, void **buffer) {
    (void)desc;
    return lao__null_make((lao__null *)self, "buffer_create", buffer);
}

static lao_result lao__null_view_create(void *self, void **view) {
    return lao__null_make((lao__null *)self, "view_create", view);
}

static void lao__null_object_destroy(void *self, void *object) {
    lao__delete(&((lao__null *)self)->host->allocator, object, 1, 1);
}

static lao_result lao__null_view_prepare(void *self, void *view, const lao_plan *plan,
                                         const lao_shader *const *shaders) {
    (void)view;
    (void)plan;
    (void)shaders;
    return lao__null_call((lao__null *)self, "view_prepare");
}

static lao_result lao__null_execute(void *self, void *view, const lao_execution *execution) {
    lao__null *null = (lao__null *)self;
    lao_result result = lao__null_call(null, "execute");
    (void)view;
    if (result == LAO_OK && null->desc.write) {
        lao_plan_print(null->host->graph, execution->plan, null->desc.write, null->desc.user);
    }
    return result;
}

static lao_result lao__null_read(void *self, void *view, const lao_plan *plan, uint32_t slot,
                                 void *data, size_t size) {
    (void)view;
    (void)plan;
    (void)slot;
    {
        lao_result result = lao__null_call((lao__null *)self, "read");
        if (result == LAO_OK) {
            memset(data, 0, size);
        }
        return result;
    }
}

static lao_result lao__null_timings(void *self, void *view, double *milliseconds,
                                    uint32_t step_count) {
    (void)view;
    (void)milliseconds;
    (void)step_count;
    return lao__null_call((lao__null *)self, "timings");
}

lao_result lao_null_backend(const lao_null_desc *desc, lao_backend *backend) {
    if (!backend) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    memset(backend, 0, sizeof *backend);
    backend->abi = LAO_BACKEND_ABI;
    backend->name = "null";
    if (desc) {
        memcpy(backend->storage, desc, sizeof *desc);
    }
    backend->attach = lao__null_attach;
    backend->detach = lao__null_detach;
    backend->buffer_create = lao__null_buffer_create;
    backend->buffer_destroy = lao__null_object_destroy;
    backend->view_create = lao__null_view_create;
    backend->view_destroy = lao__null_object_destroy;
    backend->view_prepare = lao__null_view_prepare;
    backend->execute = lao__null_execute;
    backend->read = lao__null_read;
    backend->timings = lao__null_timings;
    return LAO_OK;
}

#ifdef __cplusplus
}
#endif

#endif /* LINEAO_IMPLEMENTATION_DONE */
#endif /* LINEAO_IMPLEMENTATION */
