/* lineao.h - dense 3D line sets with line ambient occlusion, for OpenGL and Vulkan hosts. MIT
   licence, see LICENSE.

   A rendering core that a host drops in as files. It draws brain-fibre tractograms, pathlines and
   other streamlines as view-aligned ribbons whose depth and structure can be read at a glance:
   LineAO (Eichelbaum 2013) and anisotropic LineAO (Koehler 2017). The frame graph is data: tables
   of passes, images and settings that a backend executes.

   EXAMPLE (OpenGL; for Vulkan only the three backend lines differ)
       #define LINEAO_IMPLEMENTATION       // in exactly one C or C++ file
       #include "lineao.h"                 // and compile lineao_gl.c (lineao_vk.c) beside it

       lao_gl_desc gl = {0};               // the host's context is current
       gl.get_proc = my_get_proc;          // functions come from the host's loader
       lao_desc desc = {0};
       lao_gl_backend(&gl, &desc.backend);
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
                 copy to the host's image.
       Threads   a context is used by one thread at a time; contexts are independent; functions
                 without a context are pure.
       Memory    every CPU byte comes from lao_desc.allocator. lao_render allocates nothing once a
                 view has drawn a frame of the same structure (size, structural settings, imports,
                 number of sets).
       Errors    a failure returns one lao_result, logs one item and leaves out-parameters
                 untouched.
       Versions  source compatibility within a major version: new fields come at the end and zero
                 keeps the old behaviour.

   ORDER  the interface; what backends are made from; the shared text, which is C and GLSL at once;
   the implementation. Each section begins with what it holds and which others it uses. */
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

/* ------------------------------------------------------------------------------------------------
 * tables: one array per concept and module; names tie them together. A new effect is a row here and
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

/* References for tables of passes. Reads: an image as it was written last, at the level of the
   step, the level below it or above it, or one level; as it was in the last frame. Writes: every
   texel; cleared by each step, or by the first of a frame; the ping-pong partner; one level; the
   levels above one (LAO_REPEAT_LEVELS_UP). */
// clang-format off
#define LAO_READ(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO_READ_FINER(image) {image, LAO_LEVEL_FINER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO_READ_COARSER(image) {image, LAO_LEVEL_COARSER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO_READ_LEVEL(image, level) {image, LAO_LEVEL_INDEX, level, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO_READ_OTHER(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD}
#define LAO_READ_PREVIOUS(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_PREVIOUS, LAO_LOAD_DISCARD}
#define LAO_WRITE(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO_WRITE_CLEARED(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_CLEAR}
#define LAO_WRITE_KEPT(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_KEEP}
#define LAO_WRITE_OTHER(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD}
#define LAO_WRITE_OTHER_CLEARED(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_CLEAR}
#define LAO_WRITE_LEVEL(image, level) {image, LAO_LEVEL_INDEX, level, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO_WRITE_ABOVE(image, level) {image, LAO_LEVEL_SAME, level, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
// clang-format on

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
/* A row of such a list as LAO_SETTINGS, in a table and in a struct of settings. */
#define LAO_SETTING_ROW(name, type, minimum, maximum, standard, structural, unit, choices, help)   \
    {#name, LAO_SETTING_##type, minimum, maximum, standard, structural, unit, choices, help},
#define LAO_SETTING_FIELD(name, type, minimum, maximum, standard, structural, unit, choices, help) \
    float name;

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

/* ------------------------------------------------------------------------------------------------
 * settings: X(name, TYPE, minimum, maximum, default, structural, unit, choices, help). This table
   is the one place of a range, a default and a help text: validation, uniforms, `lineao --help` and
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
    LAO_SETTINGS(LAO_SETTING_FIELD)
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

/* ------------------------------------------------------------------------------------------------
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

/* ------------------------------------------------------------------------------------------------
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

/* ------------------------------------------------------------------------------------------------
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

/* ------------------------------------------------------------------------------------------------
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
