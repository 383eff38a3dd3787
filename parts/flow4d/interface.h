/* flow4d.h - time-resolved velocity fields: sampling, pathlines, temporal maximum, surfaces. MIT
   licence, see LICENSE.

   4D PC-MRI measures blood velocity on a grid of voxels over one heart beat. This header takes such
   a grid (or a function that stands for one) and makes what lineao.h draws: pathlines with a time
   and a speed per point (Koehler 2017, 2.2), the vessel's surface by marching cubes, the temporal
   maximum of speed and its projection as an anatomical background. It includes lineao.h for types,
   results, allocator and job only and needs no other implementation, no backend and no GPU.

   EXAMPLE (docs/flow4d.md goes through it)
       #define FLOW4D_IMPLEMENTATION       // in exactly one C or C++ file
       #include "flow4d.h"

       flow4d_field field = {0};
       field.size[0] = 90; field.size[1] = 70; field.size[2] = 40;
       field.frame_count = 20; field.period = 800;       // ms
       field.velocity = velocity;                        // m/s, 3 * 90 * 70 * 40 * 20 floats
       field.mask = vessel;                              // 90 * 70 * 40 bytes, or NULL
       memcpy(field.to_world, affine, sizeof field.to_world);
       flow4d_lines lines;                               // 30,000 pathlines of at most 200 points
       if (flow4d_trace(NULL, &field, NULL, &lines) != LAO_OK) return 1;
       ...                                               // lines.points, .times, .speeds, .offsets
       flow4d_lines_free(&lines);

   CONFIGURATION (define before including)
       FLOW4D_IMPLEMENTATION   the function bodies, in one translation unit
       FLOW4D_API              linkage of the public functions (default: extern)

   CONTRACTS
       Units     millimetres, milliseconds, metres per second (1 m/s = 1 mm/ms). World is whatever
                 `to_world` leads to; velocities point along world directions.
       Numbers   positions, times and velocities are double while computing, float where stored.
       Errors    a failure returns one lao_result, logs one item (FLOW4D_LOG_ITEMS) through
                 flow4d_host.log and leaves out-parameters untouched.
       Memory    every byte comes from flow4d_host.allocator, which is only ever called on the
                 thread that called us; results keep a copy of it for their free function, which is
                 fine on an all-zero result. Fields are borrowed, never copied.
       Threads   no function keeps state outside its arguments. Work runs through flow4d_host.job in
                 fixed chunks: results do not depend on the number of threads, to the bit. Callbacks
                 of a field may then be called on several threads at once.

   ORDER  the interface, then the implementation, in sections that each begin with what they hold
   and which others they use. */
#ifndef FLOW4D_H
#define FLOW4D_H

#include "lineao.h"

#ifndef FLOW4D_API
#define FLOW4D_API extern
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------
 * what can go wrong */

/* X(id, result, text) */
#define FLOW4D_LOG_ITEMS(X)                                                                        \
    X(NULL_ARGUMENT, LAO_ERROR_INVALID_ARGUMENT, "a required pointer is NULL")                     \
    X(MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory")                                                \
    X(CANCELLED, LAO_ERROR_NOT_READY, "the host cancelled the work")                               \
    X(SIZE, LAO_ERROR_INVALID_ARGUMENT,                                                            \
      "a size or frame count is zero, or the array would not fit into memory")                     \
    X(AFFINE, LAO_ERROR_INVALID_ARGUMENT, "to_world is not finite or not invertible")              \
    X(PERIOD, LAO_ERROR_INVALID_ARGUMENT,                                                          \
      "the period must be a positive number of ms for several frames, and at least 0 for one")     \
    X(VELOCITY, LAO_ERROR_INVALID_ARGUMENT, "a field needs velocities: an array or a function")    \
    X(EMPTY, LAO_ERROR_INVALID_ARGUMENT, "nothing of the field is inside: no place for seeds")     \
    X(SETTING, LAO_ERROR_INVALID_ARGUMENT, "a setting is out of its range or no number")           \
    X(COUNT, LAO_ERROR_INVALID_ARGUMENT, "more points, vertices or triangles than 32 bits count")  \
    X(ISO, LAO_ERROR_INVALID_ARGUMENT, "the iso value is not finite")                              \
    X(IMAGE, LAO_ERROR_INVALID_ARGUMENT, "the image has no pixels or would not fit into memory")   \
    X(CAMERA, LAO_ERROR_INVALID_ARGUMENT, "a camera matrix is singular or not finite")

typedef enum flow4d_log_item {
#define FLOW4D__ENUM(id, result, text) FLOW4D_LOG_##id,
    FLOW4D_LOG_ITEMS(FLOW4D__ENUM)
#undef FLOW4D__ENUM
        FLOW4D_LOG_ITEM_COUNT
} flow4d_log_item;

/* What the host lends to a call. All zero, or NULL instead: malloc, serial, silent. */
typedef struct flow4d_host {
    lao_allocator allocator;
    lao_job job; /* progress is called on the calling thread, between chunks */
    /* One call per failure. `text` is the item's sentence, ending with what is special to the case
       (a name, a number); valid during the call. */
    void (*log)(void *user, flow4d_log_item item, lao_result result, const char *text);
    void *user; /* of log */
} flow4d_host;

/* ------------------------------------------------------------------------------------------------
 * fields */

/* A velocity field on a lattice of voxels, periodic in time. The lattice is its domain, the box
   [-0.5, size - 0.5] in voxel indices; its velocities are an array or a function.

   Array: `velocity` holds 3 * size[0] * size[1] * size[2] * frame_count floats, the three
   components of a voxel side by side, then x fastest, y, z, frame. Frame f is the velocity at time
   f * period / frame_count, and frame 0 follows the last one.
   Function: `velocity_at` is asked instead (`velocity` and frame_count do not matter); the lattice
   is the box that bounds it, its voxels' edges the scale on which derivatives are taken.

   All memory is borrowed. A steady field has one frame and period 0 (or any: nothing changes). */
typedef struct flow4d_field {
    uint32_t size[3];      /* voxels, each at least 1; one voxel along an axis: constant along it */
    uint32_t frame_count;  /* frames of `velocity` */
    double period;         /* ms, duration of all frames; 0: steady */
    const float *velocity; /* m/s, along world axes. NaN: unknown there, lines end */
    const uint8_t *mask;   /* (Optional) size[0] * size[1] * size[2] bytes: not 0 is inside */
    double to_world[12];   /* rows of a 3x4 matrix: voxel index (whole numbers are voxel centres)
                              to mm. Any invertible affine map, mirrors included */
    void (*velocity_at)(void *user, const double position[3] /* mm */, double time /* ms */,
                        double velocity[3] /* m/s */);
    int (*inside_at)(void *user, const double position[3]); /* (Optional) with or without
                        velocity_at: not 0 is inside; a `mask` and the box hold besides */
    void *user;
} flow4d_field;

/* What `mask` means between voxel centres. */
typedef enum flow4d_mask_mode {
    FLOW4D_MASK_NEAREST,   /* the voxel that the point lies in */
    FLOW4D_MASK_TRILINEAR, /* the interpolated mask (0 or 1, clamped) is at least 0.5 */
    FLOW4D_MASK_NONE       /* the mask array does not matter; inside_at and the box do */
} flow4d_mask_mode;

/* Is the field well-formed? Sizes, products that overflow, period, affine map. Does not look at
   velocities. Fails with NULL_ARGUMENT, SIZE, PERIOD, VELOCITY, AFFINE. Thread: any. */
FLOW4D_API lao_result flow4d_field_check(const flow4d_host *host, const flow4d_field *field);

/* A field that was checked, with what sampling needs. By value; owns nothing; valid as long as the
   field's arrays. */
typedef struct flow4d_sampler {
    flow4d_field field;
    double from_world[12]; /* mm to voxel index */
} flow4d_sampler;

/* Makes a sampler; fails like flow4d_field_check. Thread: any. */
FLOW4D_API lao_result flow4d_sampler_make(const flow4d_host *host, const flow4d_field *field,
                                          flow4d_sampler *sampler);

/* Voxel index to mm, and back. Thread: any. */
FLOW4D_API void flow4d_to_world(const flow4d_sampler *sampler, const double index[3],
                                double position[3]);
FLOW4D_API void flow4d_from_world(const flow4d_sampler *sampler, const double position[3],
                                  double index[3]);

/* Velocity (m/s) at a place (mm) and time (ms): trilinear on 8 voxels, clamped to the outermost
   voxel centres; linear between two frames, periodic (METHODS 11.2). Masks do not matter here.
   Any time, negative too. A place or time that is not finite gives NaN. Thread: any. */
FLOW4D_API void flow4d_sample(const flow4d_sampler *sampler, const double position[3], double time,
                              double velocity[3]);

/* Not 0 when the place is in the box, the mask and inside_at. Thread: any. */
FLOW4D_API int flow4d_inside(const flow4d_sampler *sampler, const double position[3],
                             flow4d_mask_mode mode);

/* Curl of the velocity (1/s), by central differences over one voxel to each side (clamped at the
   border of an array; a hundredth of a voxel for a function). Exact for linear fields. Thread: any.
 */
FLOW4D_API void flow4d_vorticity(const flow4d_sampler *sampler, const double position[3],
                                 double time, double vorticity[3]);

/* Samples any field at the voxels of another's lattice: `target` gives size, frame_count, period
   and to_world; `velocity` (the floats of such an array) and `mask` (its bytes; (Optional)) are the
   caller's and are filled; the mask by flow4d_inside with FLOW4D_MASK_NEAREST. The arrays may then
   be given to `target`. Outside the source's box velocities are 0.
   Fails like flow4d_field_check, and with CANCELLED. */
FLOW4D_API lao_result flow4d_resample(const flow4d_host *host, const flow4d_field *source,
                                      const flow4d_field *target, float *velocity, uint8_t *mask);

/* Greatest speed (m/s) of the array at voxels inside the mask, or of the function at voxel centres
   inside (16 times of the cycle). NaN and infinite speeds do not count. Thread: any. */
FLOW4D_API double flow4d_max_speed(const flow4d_sampler *sampler);

/* ------------------------------------------------------------------------------------------------
 * pathlines */

typedef enum flow4d_method {
    FLOW4D_RK4,  /* classic Runge-Kutta, fixed step (METHODS 11.3) */
    FLOW4D_DOPRI /* Dormand-Prince 5(4): each step in as many parts as `tolerance` needs */
} flow4d_method;

typedef enum flow4d_direction { FLOW4D_BOTH, FLOW4D_FORWARD, FLOW4D_BACKWARD } flow4d_direction;

/* How far a line reaches in time. Without effect on steady fields and streamlines, whose lines end
   by `duration` and `max_points`. */
typedef enum flow4d_span {
    FLOW4D_SPAN_CYCLE, /* from time 0 to the period: one heart beat, the same for all lines */
    FLOW4D_SPAN_LOOP,  /* from half a period before the seed to half after it: for animations that
                          loop, because each line has a seam of its own. Times are then in
                          [-period / 2, 3 period / 2]; compare them modulo the period */
    FLOW4D_SPAN_FREE   /* by `duration` and `max_points`, over any number of cycles */
} flow4d_span;

enum {
    FLOW4D_VORTICITY = 1, /* fill flow4d_lines.vorticity */
    FLOW4D_CURVATURE = 2  /* fill flow4d_lines.curvature */
};

/* All zero, or NULL instead: 30,000 pathlines of one cycle by RK4 at 200 steps per period. */
typedef struct flow4d_trace_settings {
    uint32_t line_count; /* 0: 30,000, or seed_count with `seeds` */
    uint32_t seed;       /* of the random places and times */
    flow4d_method method;
    flow4d_direction direction;
    flow4d_span span;
    flow4d_mask_mode mask;
    uint32_t attributes; /* FLOW4D_VORTICITY ... */
    uint32_t max_points; /* per line, its seed included; 0: 200. At most 2^22 */
    double step;         /* ms between the points of a line, > 0. 0: period / 200; steady fields and
                            streamlines: half the shortest voxel edge over the greatest speed */
    double duration;     /* ms from the seed in each direction, at most; 0: as far as `span` and
                            max_points let it */
    double tolerance;    /* FLOW4D_DOPRI: mm of error per part of a step; 0: 1e-4 */
    double stop_speed;   /* m/s below which a line ends; 0: 1e-6; negative: never */
    int streamlines;     /* not 0: integrate the field of one instant, `time` */
    double time;         /* ms, of streamlines */
    const double *seeds; /* (Optional) x, y, z (mm), time (ms) per line instead of random ones */
    uint32_t seed_count; /* of `seeds` */
} flow4d_trace_settings;

/* Lines in order of their seeds. Points lie on the times seed + k step, rising along the line. A
   line holds its seed, so it has one point where no step was possible, and none where the seed is
   not inside. A host may thin the lines in place and lower the two counts. */
typedef struct flow4d_lines {
    uint32_t line_count, point_count;
    uint32_t *offsets; /* line_count + 1: line i has points offsets[i] .. offsets[i + 1] - 1 */
    float *points;     /* 3 * point_count, mm */
    float *times;      /* point_count, ms; steady fields and streamlines: since the seed, whose
                          `time` counts as 0 */
    float *speeds;     /* point_count, m/s */
    float *vorticity;  /* point_count, magnitude of the curl, 1/s; NULL unless asked for */
    float *curvature;  /* point_count, 1/mm, of the circle through a point and its two neighbours,
                          0 at ends; NULL unless asked for */
    double step;       /* ms, that was taken */
    uint32_t line_room, point_room; /* private: what was allocated */
    lao_allocator allocator;        /* private */
} flow4d_lines;

/* Integrates lines. Random seeds are uniform in the inside: a random voxel, a random place in it,
   and a random time of the cycle, from a hash of (seed, line): line i is the same for any
   line_count. A line ends where it would leave the inside (every point and every stage of a step is
   looked at), where the velocity is not finite or slower than stop_speed, and at the end of its
   span. Where both directions together exceed max_points, the longer one gives way.
   Peak memory: twice the result and 15 MB (one line's max_points times 28 bytes where that is
   more). Fails with NULL_ARGUMENT, SETTING, EMPTY, COUNT, MEMORY, CANCELLED and like
   flow4d_field_check. */
FLOW4D_API lao_result flow4d_trace(const flow4d_host *host, const flow4d_field *field,
                                   const flow4d_trace_settings *settings, flow4d_lines *lines);
FLOW4D_API void flow4d_lines_free(flow4d_lines *lines);

/* The same as a description for lao_lines_create: points, times and offsets, borrowed. */
FLOW4D_API lao_lines_desc flow4d_lines_describe(const flow4d_lines *lines);

/* One step of an integrator, as flow4d_trace takes it: moves `position` (mm) from `time` by `step`
   (ms, negative: backward). Returns 0, or -1 where a stage was outside or not finite; `position` is
   then untouched. `tolerance` is for FLOW4D_DOPRI (mm, > 0). Thread: any. */
FLOW4D_API int flow4d_step(const flow4d_sampler *sampler, flow4d_method method,
                           flow4d_mask_mode mask, double time, double step, double tolerance,
                           double position[3]);

/* ------------------------------------------------------------------------------------------------
 * scalar volumes: temporal maximum, projection, surface */

/* Values on a lattice like a field's. Borrowed. */
typedef struct flow4d_volume {
    uint32_t size[3];
    double to_world[12]; /* as in flow4d_field */
    const float *values; /* x fastest, then y, z; NaN counts as outside and as no value */
    const uint8_t *mask; /* used where `values` is NULL: not 0 is 1 */
} flow4d_volume;

/* Temporal maximum intensity: per voxel the greatest speed (m/s) of all frames, NaN left out
   (METHODS 11.4). `values`: size[0] * size[1] * size[2] floats of the caller. Of a function: of
   frame_count times of the cycle (0: 16). Fails like flow4d_field_check, and with CANCELLED. */
FLOW4D_API lao_result flow4d_temporal_maximum(const flow4d_host *host, const flow4d_field *field,
                                              float *values);

/* Maximum intensity projection: per pixel the greatest value along its ray, trilinear, sampled
   every half of the shortest voxel edge; 0 where the ray meets no value above 0. `image`: width *
   height floats of the caller, row 0 at the bottom of the picture, as lao_read has them. Any camera
   that lao_render takes; what is in front of the near plane does not count.
   Fails with NULL_ARGUMENT, SIZE, AFFINE, IMAGE, CAMERA, CANCELLED. */
FLOW4D_API lao_result flow4d_project_maximum(const flow4d_host *host, const flow4d_volume *volume,
                                             const lao_camera *camera, uint32_t width,
                                             uint32_t height, float *image);

/* All zero, or NULL instead: values of at least iso are inside, nothing is smoothed. */
typedef struct flow4d_surface_settings {
    int inside_is_less; /* not 0: values below iso are inside (a signed distance) */
    uint32_t smoothing; /* passes of the 1-2-1 filter along each axis before, 0 to 100; 1 rounds the
                           stairs of a mask */
} flow4d_surface_settings;

/* A closed triangle mesh: every edge has exactly two triangles, that run along it in opposite
   directions. Vertices are shared. Seen from outside triangles turn counter-clockwise. */
typedef struct flow4d_surface {
    uint32_t vertex_count, triangle_count;
    float *vertices;         /* 3 * vertex_count, mm */
    uint32_t *triangles;     /* 3 * triangle_count */
    lao_allocator allocator; /* private */
} flow4d_surface;

/* The surface where the volume has the value `iso` (0.5 for a mask), by marching cubes
   (METHODS 11.5). Where the inside reaches the border of the volume the surface
   closes half a voxel beyond it. Corners that meet only across a face's diagonal are kept apart.
   An empty inside gives no triangles and is no failure.
   Fails with NULL_ARGUMENT, SIZE, AFFINE, ISO, SETTING, COUNT, MEMORY, CANCELLED. */
FLOW4D_API lao_result flow4d_surface_make(const flow4d_host *host, const flow4d_volume *volume,
                                          double iso, const flow4d_surface_settings *settings,
                                          flow4d_surface *surface);
FLOW4D_API void flow4d_surface_free(flow4d_surface *surface);

#ifdef __cplusplus
}
#endif

#endif /* FLOW4D_H */
