/* ================================================================================================
 * seam: what an executor is given and what it must do: the plan, a frame graph flattened for one
   structure (no conditions, repeats or names are left), and lao_backend; see docs/porting.md. Uses
   interface. */

/* ---- the plan: pure data */

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

/* ---- the backend: functions return LAO_OK, or log one item and return its result */

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
