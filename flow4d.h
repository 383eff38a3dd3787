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
                 of a field may then be called on several threads at once. */
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

#ifdef FLOW4D_IMPLEMENTATION
#ifndef FLOW4D_IMPLEMENTATION_DONE
#define FLOW4D_IMPLEMENTATION_DONE

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ================================================================================================
 * the host: memory, failures, work */

static void *flow4d__default_allocate(void *user, size_t size) {
    (void)user;
    return malloc(size);
}

static void flow4d__default_release(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}

/* The host with an allocator that works. */
static flow4d_host flow4d__host(const flow4d_host *host) {
    flow4d_host h;
    memset(&h, 0, sizeof h);
    if (host) {
        h = *host;
    }
    if (!h.allocator.allocate || !h.allocator.release) {
        h.allocator.allocate = flow4d__default_allocate;
        h.allocator.release = flow4d__default_release;
        h.allocator.user = NULL;
    }
    return h;
}

/* Zeroed memory for count items; NULL for none, on overflow or when there is no memory. */
static void *flow4d__new(const lao_allocator *allocator, size_t count, size_t size) {
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

static void flow4d__delete(const lao_allocator *allocator, void *memory, size_t count,
                           size_t size) {
    if (memory) {
        allocator->release(allocator->user, memory, count * size);
    }
}

static lao_result flow4d__fail(const flow4d_host *host, flow4d_log_item item, const char *detail) {
    static const struct {
        lao_result result;
        const char *text;
    } items[] = {
#define FLOW4D__ITEM(id, result, text) {result, text},
        FLOW4D_LOG_ITEMS(FLOW4D__ITEM)
#undef FLOW4D__ITEM
    };
    char text[512];
    if (host && host->log) {
        snprintf(text, sizeof text, "%s: %s", items[item].text, detail);
        host->log(host->user, item, items[item].result, text);
    }
    return items[item].result;
}

static void flow4d__run(const flow4d_host *host, uint32_t count, void (*fn)(void *, uint32_t),
                        void *arg) {
    uint32_t i;
    if (host->job.run) {
        host->job.run(host->job.user, count, fn, arg);
        return;
    }
    for (i = 0; i < count; i++) {
        fn(arg, i);
    }
}

/* Not 0: the host wants no more. */
static int flow4d__progress(const flow4d_host *host, uint64_t done, uint64_t total) {
    return host->job.progress && host->job.progress(host->job.user, done, total);
}

typedef struct flow4d__part {
    void (*fn)(void *arg, size_t index);
    void *arg;
    size_t first;
} flow4d__part;

static void flow4d__part_run(void *arg, uint32_t index) {
    const flow4d__part *part = (const flow4d__part *)arg;
    part->fn(part->arg, part->first + index);
}

/* All of `count` pieces of work, asking the host now and then. */
static lao_result flow4d__work(const flow4d_host *host, const char *name, size_t count,
                               void (*fn)(void *arg, size_t index), void *arg) {
    flow4d__part part;
    part.fn = fn;
    part.arg = arg;
    for (part.first = 0; part.first < count;) {
        size_t left = count - part.first;
        uint32_t now = left < 64 ? (uint32_t)left : 64u;
        flow4d__run(host, now, flow4d__part_run, &part);
        part.first += now;
        if (flow4d__progress(host, part.first, count)) {
            return flow4d__fail(host, FLOW4D_LOG_CANCELLED, name);
        }
    }
    return LAO_OK;
}

static int flow4d__number(double value) {
    return value - value == 0.0;
}

static int flow4d__finite(const double *values, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        if (!flow4d__number(values[i])) {
            return 0;
        }
    }
    return 1;
}

/* ================================================================================================
 * lattices: size and affine map */

/* values = product of the sizes, times `more`; 0 when one is 0 or the bytes overflow. */
static size_t flow4d__count(const uint32_t size[3], size_t more, size_t bytes) {
    size_t count = more, most = (size_t)-1 / bytes;
    int a;
    for (a = 0; a < 3; a++) {
        if (size[a] == 0 || count > most / size[a]) {
            return 0;
        }
        count *= size[a];
    }
    return count;
}

static double flow4d__determinant(const double m[12]) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

static double flow4d__edge(const double m[12], int axis) {
    return sqrt(m[axis] * m[axis] + m[axis + 4] * m[axis + 4] + m[axis + 8] * m[axis + 8]);
}

static double flow4d__shortest_edge(const double m[12]) {
    double shortest = flow4d__edge(m, 0);
    int a;
    for (a = 1; a < 3; a++) {
        if (flow4d__edge(m, a) < shortest) {
            shortest = flow4d__edge(m, a);
        }
    }
    return shortest;
}

/* Inverse of an affine map; 0, or -1 when there is none. Axes that are parallel to a trillionth
   count as such. */
static int flow4d__invert(const double m[12], double inverse[12]) {
    double d, scale;
    size_t i, j;
    if (!flow4d__finite(m, 12)) {
        return -1;
    }
    d = flow4d__determinant(m);
    scale = flow4d__edge(m, 0) * flow4d__edge(m, 1) * flow4d__edge(m, 2);
    if (!flow4d__number(scale) || !(fabs(d) > 1e-12 * scale)) {
        return -1;
    }
    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) {
            size_t a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, e = (i + 2) % 3;
            inverse[4 * i + j] = (m[4 * a + c] * m[4 * b + e] - m[4 * a + e] * m[4 * b + c]) / d;
        }
    }
    for (i = 0; i < 3; i++) {
        inverse[4 * i + 3] =
            -(inverse[4 * i] * m[3] + inverse[4 * i + 1] * m[7] + inverse[4 * i + 2] * m[11]);
    }
    return flow4d__finite(inverse, 12) ? 0 : -1;
}

static void flow4d__apply(const double m[12], const double p[3], double q[3]) {
    double x = p[0], y = p[1], z = p[2];
    q[0] = m[0] * x + m[1] * y + m[2] * z + m[3];
    q[1] = m[4] * x + m[5] * y + m[6] * z + m[7];
    q[2] = m[8] * x + m[9] * y + m[10] * z + m[11];
}

/* Checks size (of `more` items of `bytes` per voxel) and map, and inverts the map. */
static lao_result flow4d__lattice_check(const flow4d_host *host, const uint32_t size[3],
                                        size_t more, size_t bytes, const double to_world[12],
                                        double from_world[12]) {
    char text[96];
    if (!flow4d__count(size, more, bytes)) {
        snprintf(text, sizeof text, "%lu x %lu x %lu x %lu", (unsigned long)size[0],
                 (unsigned long)size[1], (unsigned long)size[2], (unsigned long)more);
        return flow4d__fail(host, FLOW4D_LOG_SIZE, text);
    }
    if (flow4d__invert(to_world, from_world) != 0) {
        snprintf(text, sizeof text, "determinant %g", flow4d__determinant(to_world));
        return flow4d__fail(host, FLOW4D_LOG_AFFINE, text);
    }
    return LAO_OK;
}

/* ================================================================================================
 * fields */

static lao_result flow4d__domain_check(const flow4d_host *host, const flow4d_field *field,
                                       double from_world[12]) {
    size_t frames = field->velocity_at ? 1 : field->frame_count;
    lao_result result = flow4d__lattice_check(host, field->size, frames, 3 * sizeof(float),
                                              field->to_world, from_world);
    if (result == LAO_OK && !(field->period >= 0.0 && flow4d__number(field->period) &&
                              (field->period > 0.0 || frames < 2))) {
        char text[64];
        snprintf(text, sizeof text, "%g ms for %lu frames", field->period, (unsigned long)frames);
        return flow4d__fail(host, FLOW4D_LOG_PERIOD, text);
    }
    return result;
}

lao_result flow4d_sampler_make(const flow4d_host *host, const flow4d_field *field,
                               flow4d_sampler *sampler) {
    flow4d_sampler made;
    lao_result result;
    if (!field || !sampler) {
        return flow4d__fail(host, FLOW4D_LOG_NULL_ARGUMENT, "the field or the sampler");
    }
    if (!field->velocity && !field->velocity_at) {
        return flow4d__fail(host, FLOW4D_LOG_VELOCITY, "velocity and velocity_at are NULL");
    }
    made.field = *field;
    result = flow4d__domain_check(host, field, made.from_world);
    if (result == LAO_OK) {
        *sampler = made;
    }
    return result;
}

lao_result flow4d_field_check(const flow4d_host *host, const flow4d_field *field) {
    flow4d_sampler sampler;
    return flow4d_sampler_make(host, field, &sampler);
}

void flow4d_to_world(const flow4d_sampler *sampler, const double index[3], double position[3]) {
    flow4d__apply(sampler->field.to_world, index, position);
}

void flow4d_from_world(const flow4d_sampler *sampler, const double position[3], double index[3]) {
    flow4d__apply(sampler->from_world, position, index);
}

/* The eight voxels around a place, clamped, and their weights. */
typedef struct flow4d__cell {
    size_t voxel[8];
    double weight[8];
} flow4d__cell;

static void flow4d__cell_make(const uint32_t size[3], const double index[3], flow4d__cell *cell) {
    size_t low[3], step[3], stride = 1;
    double part[3];
    int a, c;
    for (a = 0; a < 3; a++) {
        double last = (double)(size[a] - 1), g = index[a] > 0.0 ? index[a] : 0.0;
        double whole;
        g = g < last ? g : last;
        whole = floor(g);
        part[a] = g - whole;
        low[a] = (size_t)whole * stride;
        step[a] = whole < last ? stride : 0;
        stride *= size[a];
    }
    for (c = 0; c < 8; c++) {
        int x = c & 1, y = (c >> 1) & 1, z = c >> 2;
        cell->voxel[c] =
            low[0] + low[1] + low[2] + (x ? step[0] : 0) + (y ? step[1] : 0) + (z ? step[2] : 0);
        cell->weight[c] = (x ? part[0] : 1.0 - part[0]) * (y ? part[1] : 1.0 - part[1]) *
                          (z ? part[2] : 1.0 - part[2]);
    }
}

/* Adds one frame. Voxels without weight do not count, so that what is unknown beside a voxel centre
   does not spoil it. */
static void flow4d__add_frame(const flow4d__cell *cell, const float *velocity, double scale,
                              double sum[3]) {
    int c;
    for (c = 0; c < 8; c++) {
        double w = cell->weight[c] * scale;
        const float *v = velocity + 3 * cell->voxel[c];
        if (w > 0.0) {
            sum[0] += w * (double)v[0];
            sum[1] += w * (double)v[1];
            sum[2] += w * (double)v[2];
        }
    }
}

/* Velocity of the array at a place given as voxel index, all finite. */
static void flow4d__sample_array(const flow4d_field *field, const double index[3], double time,
                                 double velocity[3]) {
    size_t frame_floats = 3 * (size_t)field->size[0] * field->size[1] * field->size[2];
    flow4d__cell cell;
    uint32_t f = 0;
    double part = 0.0;
    if (field->frame_count > 1) {
        double cycles = time / field->period;
        double frames = (cycles - floor(cycles)) * (double)field->frame_count;
        /* a time a hair before 0 rounds to the end of the cycle, which is its beginning */
        f = frames < (double)field->frame_count ? (uint32_t)frames : 0;
        part = frames < (double)field->frame_count ? frames - (double)f : 0.0;
    }
    flow4d__cell_make(field->size, index, &cell);
    velocity[0] = velocity[1] = velocity[2] = 0.0;
    flow4d__add_frame(&cell, field->velocity + f * frame_floats, 1.0 - part, velocity);
    if (part > 0.0) {
        f = f + 1 < field->frame_count ? f + 1 : 0;
        flow4d__add_frame(&cell, field->velocity + f * frame_floats, part, velocity);
    }
}

static void flow4d__sample(const flow4d_sampler *sampler, const double position[3],
                           const double index[3], double time, double velocity[3]) {
    if (sampler->field.velocity_at) {
        sampler->field.velocity_at(sampler->field.user, position, time, velocity);
    } else {
        flow4d__sample_array(&sampler->field, index, time, velocity);
    }
}

void flow4d_sample(const flow4d_sampler *sampler, const double position[3], double time,
                   double velocity[3]) {
    double index[3];
    flow4d__apply(sampler->from_world, position, index);
    if (!flow4d__finite(index, 3) || !flow4d__number(time)) {
        velocity[0] = velocity[1] = velocity[2] =
            time - time + (index[0] - index[0]) + (index[1] - index[1]) + (index[2] - index[2]);
        return;
    }
    flow4d__sample(sampler, position, index, time, velocity);
}

static int flow4d__in_mask(const flow4d_field *field, const double index[3],
                           flow4d_mask_mode mode) {
    double sum = 0.0;
    flow4d__cell cell;
    int a, c;
    if (mode == FLOW4D_MASK_TRILINEAR) {
        flow4d__cell_make(field->size, index, &cell);
        for (c = 0; c < 8; c++) {
            sum += field->mask[cell.voxel[c]] ? cell.weight[c] : 0.0;
        }
        return sum >= 0.5;
    }
    {
        size_t voxel = 0, stride = 1;
        for (a = 0; a < 3; a++) { /* the upper face of the box belongs to the last voxel */
            size_t g = (size_t)(index[a] + 0.5);
            voxel += (g < field->size[a] ? g : (size_t)field->size[a] - 1) * stride;
            stride *= field->size[a];
        }
        return field->mask[voxel] != 0;
    }
}

/* NaN is outside. */
static int flow4d__inside(const flow4d_sampler *sampler, const double position[3],
                          const double index[3], flow4d_mask_mode mode) {
    const flow4d_field *field = &sampler->field;
    int a;
    for (a = 0; a < 3; a++) {
        if (!(index[a] >= -0.5 && index[a] <= (double)field->size[a] - 0.5)) {
            return 0;
        }
    }
    if (field->mask && mode != FLOW4D_MASK_NONE && !flow4d__in_mask(field, index, mode)) {
        return 0;
    }
    return !field->inside_at || field->inside_at(field->user, position);
}

int flow4d_inside(const flow4d_sampler *sampler, const double position[3], flow4d_mask_mode mode) {
    double index[3];
    flow4d__apply(sampler->from_world, position, index);
    return flow4d__inside(sampler, position, index, mode);
}

/* Velocity at a place that is inside; 0, or -1 when it is not or the velocity is not finite. */
static int flow4d__probe(const flow4d_sampler *sampler, flow4d_mask_mode mode,
                         const double position[3], double time, double velocity[3]) {
    double index[3];
    flow4d__apply(sampler->from_world, position, index);
    if (!flow4d__inside(sampler, position, index, mode)) {
        return -1;
    }
    flow4d__sample(sampler, position, index, time, velocity);
    return flow4d__finite(velocity, 3) ? 0 : -1;
}

/* Change of the velocity from one voxel index along an axis to the next, by central differences. */
static void flow4d__difference(const flow4d_sampler *sampler, const double index[3], int axis,
                               double time, double slope[3]) {
    const flow4d_field *field = &sampler->field;
    double last = (double)(field->size[axis] - 1), from[3], to[3], p[3], a[3], b[3];
    int i;
    memcpy(from, index, sizeof from);
    memcpy(to, index, sizeof to);
    if (field->velocity_at) {
        from[axis] -= 0.01;
        to[axis] += 0.01;
    } else {
        from[axis] = from[axis] - 1.0 > 0.0 ? from[axis] - 1.0 : 0.0;
        to[axis] = to[axis] + 1.0 < last ? to[axis] + 1.0 : last;
        from[axis] = from[axis] < last ? from[axis] : last;
        to[axis] = to[axis] > 0.0 ? to[axis] : 0.0;
    }
    slope[0] = slope[1] = slope[2] = 0.0;
    if (!(to[axis] > from[axis])) {
        return; /* a single voxel, or beyond the border: constant */
    }
    flow4d__apply(field->to_world, from, p);
    flow4d__sample(sampler, p, from, time, a);
    flow4d__apply(field->to_world, to, p);
    flow4d__sample(sampler, p, to, time, b);
    for (i = 0; i < 3; i++) {
        slope[i] = (b[i] - a[i]) / (to[axis] - from[axis]);
    }
}

void flow4d_vorticity(const flow4d_sampler *sampler, const double position[3], double time,
                      double vorticity[3]) {
    const double *g = sampler->from_world;
    double index[3], slope[3][3], d[3][3];
    int i, j;
    flow4d__apply(g, position, index);
    if (!flow4d__finite(index, 3) || !flow4d__number(time)) {
        flow4d_sample(sampler, position, time, vorticity); /* NaN */
        return;
    }
    for (i = 0; i < 3; i++) {
        flow4d__difference(sampler, index, i, time, slope[i]);
    }
    for (i = 0; i < 3; i++) { /* d[i][j] = dv_i / dx_j */
        for (j = 0; j < 3; j++) {
            d[i][j] = slope[0][i] * g[j] + slope[1][i] * g[4 + j] + slope[2][i] * g[8 + j];
        }
    }
    vorticity[0] = 1000.0 * (d[2][1] - d[1][2]); /* 1/ms to 1/s */
    vorticity[1] = 1000.0 * (d[0][2] - d[2][0]);
    vorticity[2] = 1000.0 * (d[1][0] - d[0][1]);
}

static double flow4d__length(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Times at which a function is looked at for its greatest speed. */
static uint32_t flow4d__looks(const flow4d_field *field) {
    if (!field->velocity_at) {
        return field->frame_count;
    }
    return !(field->period > 0.0) ? 1u : field->frame_count ? field->frame_count : 16u;
}

/* Greatest speed at a voxel over the cycle, 0 where there is none. */
static double flow4d__peak(const flow4d_sampler *sampler, const size_t voxel[3]) {
    const flow4d_field *field = &sampler->field;
    size_t row = voxel[0] + field->size[0] * (voxel[1] + field->size[1] * voxel[2]);
    size_t voxels = (size_t)field->size[0] * field->size[1] * field->size[2];
    uint32_t f, looks = flow4d__looks(field);
    double peak = 0.0, index[3], position[3];
    index[0] = (double)voxel[0];
    index[1] = (double)voxel[1];
    index[2] = (double)voxel[2];
    flow4d__apply(field->to_world, index, position);
    for (f = 0; f < looks; f++) {
        double v[3], speed;
        if (field->velocity_at) {
            field->velocity_at(field->user, position, field->period * f / looks, v);
        } else {
            const float *w = field->velocity + 3 * (f * voxels + row);
            v[0] = (double)w[0];
            v[1] = (double)w[1];
            v[2] = (double)w[2];
        }
        speed = flow4d__length(v);
        if (speed > peak && flow4d__number(speed)) {
            peak = speed;
        }
    }
    return peak;
}

double flow4d_max_speed(const flow4d_sampler *sampler) {
    const flow4d_field *field = &sampler->field;
    double greatest = 0.0;
    size_t v[3];
    for (v[2] = 0; v[2] < field->size[2]; v[2]++) {
        for (v[1] = 0; v[1] < field->size[1]; v[1]++) {
            for (v[0] = 0; v[0] < field->size[0]; v[0]++) {
                double index[3], position[3], peak;
                index[0] = (double)v[0];
                index[1] = (double)v[1];
                index[2] = (double)v[2];
                flow4d__apply(field->to_world, index, position);
                if (!flow4d__inside(sampler, position, index, FLOW4D_MASK_NEAREST)) {
                    continue;
                }
                peak = flow4d__peak(sampler, v);
                greatest = peak > greatest ? peak : greatest;
            }
        }
    }
    return greatest;
}

typedef struct flow4d__resampling {
    flow4d_sampler source;
    const flow4d_field *target;
    float *velocity;
    uint8_t *mask;
} flow4d__resampling;

/* One slice of one frame. */
static void flow4d__resample_slice(void *arg, size_t slice) {
    const flow4d__resampling *r = (const flow4d__resampling *)arg;
    const uint32_t *size = r->target->size;
    size_t voxel = slice * size[0] * size[1];
    size_t frame = slice / size[2];
    double time = r->target->period * (double)frame / r->target->frame_count;
    uint32_t x, y;
    for (y = 0; y < size[1]; y++) {
        for (x = 0; x < size[0]; x++, voxel++) {
            double index[3], position[3], source[3], v[3] = {0.0, 0.0, 0.0};
            index[0] = x;
            index[1] = y;
            index[2] = (double)(slice % size[2]);
            flow4d__apply(r->target->to_world, index, position);
            flow4d__apply(r->source.from_world, position, source);
            if (flow4d__inside(&r->source, position, source, FLOW4D_MASK_NEAREST)) {
                flow4d__sample(&r->source, position, source, time, v);
            }
            r->velocity[3 * voxel] = (float)v[0];
            r->velocity[3 * voxel + 1] = (float)v[1];
            r->velocity[3 * voxel + 2] = (float)v[2];
            if (r->mask && slice < size[2]) {
                r->mask[voxel] =
                    (uint8_t)flow4d__inside(&r->source, position, source, FLOW4D_MASK_NEAREST);
            }
        }
    }
}

lao_result flow4d_resample(const flow4d_host *host, const flow4d_field *source,
                           const flow4d_field *target, float *velocity, uint8_t *mask) {
    flow4d_host h = flow4d__host(host);
    flow4d__resampling r;
    flow4d_field lattice;
    double unused[12];
    lao_result result;
    if (!target || !velocity) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "target or velocity of flow4d_resample");
    }
    lattice = *target;
    lattice.velocity_at = NULL; /* an array is wanted, so frame_count matters */
    result = flow4d_sampler_make(&h, source, &r.source);
    if (result == LAO_OK) {
        result = flow4d__domain_check(&h, &lattice, unused);
    }
    if (result != LAO_OK) {
        return result;
    }
    r.target = target;
    r.velocity = velocity;
    r.mask = mask;
    return flow4d__work(&h, "flow4d_resample", (size_t)target->size[2] * target->frame_count,
                        flow4d__resample_slice, &r);
}

typedef struct flow4d__maximum {
    flow4d_sampler sampler;
    float *values;
} flow4d__maximum;

static void flow4d__maximum_slice(void *arg, size_t z) {
    const flow4d__maximum *m = (const flow4d__maximum *)arg;
    const uint32_t *size = m->sampler.field.size;
    size_t v[3], i = z * size[0] * size[1];
    v[2] = z;
    for (v[1] = 0; v[1] < size[1]; v[1]++) {
        for (v[0] = 0; v[0] < size[0]; v[0]++) {
            m->values[i++] = (float)flow4d__peak(&m->sampler, v);
        }
    }
}

lao_result flow4d_temporal_maximum(const flow4d_host *host, const flow4d_field *field,
                                   float *values) {
    flow4d_host h = flow4d__host(host);
    flow4d__maximum m;
    lao_result result;
    if (!values) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "values of flow4d_temporal_maximum");
    }
    result = flow4d_sampler_make(&h, field, &m.sampler);
    if (result != LAO_OK) {
        return result;
    }
    m.values = values;
    return flow4d__work(&h, "flow4d_temporal_maximum", field->size[2], flow4d__maximum_slice, &m);
}

/* ================================================================================================
 * integrators */

typedef struct flow4d__tracer {
    flow4d_sampler sampler;
    flow4d_method method;
    flow4d_mask_mode mask;
    double tolerance;
    int frozen; /* streamlines: always at frozen_time */
    double frozen_time;
} flow4d__tracer;

static int flow4d__velocity(const flow4d__tracer *t, const double position[3], double time,
                            double velocity[3]) {
    return flow4d__probe(&t->sampler, t->mask, position, t->frozen ? t->frozen_time : time,
                         velocity);
}

/* Moves x by h, where v is the velocity at (x, time) and becomes that at the new place; 0, or -1
   when a stage or the new place is outside: x and v are then as before. */
static int flow4d__rk4(const flow4d__tracer *t, double time, double h, double x[3], double v[3]) {
    static const double part[3] = {0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    double k[4][3], y[3], end[3];
    int s, i;
    memcpy(k[0], v, sizeof k[0]);
    for (s = 0; s < 3; s++) {
        for (i = 0; i < 3; i++) {
            y[i] = x[i] + h * part[s] * k[s][i];
        }
        if (flow4d__velocity(t, y, time + h * part[s], k[s + 1]) != 0) {
            return -1;
        }
    }
    for (i = 0; i < 3; i++) {
        double sum = 0.0;
        for (s = 0; s < 4; s++) {
            sum += weight[s] * k[s][i];
        }
        y[i] = x[i] + h / 6.0 * sum;
    }
    if (flow4d__velocity(t, y, time + h, end) != 0) {
        return -1;
    }
    memcpy(x, y, sizeof y);
    memcpy(v, end, sizeof end);
    return 0;
}

/* Dormand and Prince 1980: one part of a step. *error is the distance (mm) of the 4th from the 5th
   order result. */
static int flow4d__dopri_part(const flow4d__tracer *t, double time, double h, double x[3],
                              double v[3], double *error) {
    static const double at[7] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
    static const double a[7][6] = {
        {0, 0, 0, 0, 0, 0},
        {1.0 / 5, 0, 0, 0, 0, 0},
        {3.0 / 40, 9.0 / 40, 0, 0, 0, 0},
        {44.0 / 45, -56.0 / 15, 32.0 / 9, 0, 0, 0},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729, 0, 0},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656, 0},
        {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    static const double e[7] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
    double k[7][3], y[3] = {0.0, 0.0, 0.0}, d[3];
    int s, r, i;
    memcpy(k[0], v, sizeof k[0]);
    for (s = 1; s < 7; s++) {
        for (i = 0; i < 3; i++) {
            double sum = 0.0;
            for (r = 0; r < s; r++) {
                sum += a[s][r] * k[r][i];
            }
            y[i] = x[i] + h * sum;
        }
        if (flow4d__velocity(t, y, time + h * at[s], k[s]) != 0) {
            return -1;
        }
    }
    for (i = 0; i < 3; i++) {
        d[i] = 0.0;
        for (s = 0; s < 7; s++) {
            d[i] += h * e[s] * k[s][i];
        }
    }
    *error = flow4d__length(d);
    memcpy(x, y, sizeof y);       /* the last stage is the new place */
    memcpy(v, k[6], sizeof k[6]); /* and its velocity */
    return 0;
}

/* A whole step in parts, none shorter than a 4096th of it: there the result is taken as it is. */
static int flow4d__dopri(const flow4d__tracer *t, double time, double h, double x[3], double v[3]) {
    double done = 0.0, part = 1.0, y[3], w[3], error = 0.0;
    const double least = 1.0 / 4096;
    memcpy(y, x, sizeof y);
    memcpy(w, v, sizeof w);
    while (done < 1.0) {
        double now = part < 1.0 - done ? part : 1.0 - done, p[3], q[3], change;
        memcpy(p, y, sizeof p);
        memcpy(q, w, sizeof q);
        if (flow4d__dopri_part(t, time + h * done, h * now, p, q, &error) != 0) {
            if (now <= least) {
                return -1;
            }
            part =
                now * 0.25 > least ? now * 0.25 : least; /* outside: perhaps only of a long one */
            continue;
        }
        change = error > 0.0 ? 0.9 * pow(t->tolerance / error, 0.2) : 5.0;
        change = change < 0.2 ? 0.2 : change > 5.0 ? 5.0 : change;
        part = now * change > least ? now * change : least;
        if (error <= t->tolerance || now <= least) {
            /* what the last part leaves over by rounding is no further part */
            done = now < 1.0 - done ? done + now : 1.0;
            memcpy(y, p, sizeof y);
            memcpy(w, q, sizeof w);
        }
    }
    memcpy(x, y, sizeof y);
    memcpy(v, w, sizeof w);
    return 0;
}

static int flow4d__advance(const flow4d__tracer *t, double time, double h, double x[3],
                           double v[3]) {
    return t->method == FLOW4D_DOPRI ? flow4d__dopri(t, time, h, x, v)
                                     : flow4d__rk4(t, time, h, x, v);
}

int flow4d_step(const flow4d_sampler *sampler, flow4d_method method, flow4d_mask_mode mask,
                double time, double step, double tolerance, double position[3]) {
    flow4d__tracer t;
    double v[3], end = time + step;
    t.sampler = *sampler;
    t.method = method;
    t.mask = mask;
    t.tolerance = tolerance;
    t.frozen = 0;
    t.frozen_time = 0.0;
    if (!flow4d__number(end) || flow4d__velocity(&t, position, time, v) != 0) {
        return -1;
    }
    return flow4d__advance(&t, time, step, position, v);
}

/* ================================================================================================
 * seeds */

/* Where random seeds may lie: how many voxels of the mask lie in all rows before each row. */
typedef struct flow4d__rows {
    uint64_t *before; /* NULL: every voxel */
    size_t count;     /* rows */
    uint64_t voxels;  /* inside */
} flow4d__rows;

static lao_result flow4d__rows_make(const flow4d_host *host, const flow4d_field *field,
                                    flow4d_mask_mode mode, flow4d__rows *rows) {
    size_t r, i;
    rows->before = NULL;
    rows->count = (size_t)field->size[1] * field->size[2];
    rows->voxels = (uint64_t)rows->count * field->size[0];
    if (!field->mask || mode == FLOW4D_MASK_NONE) {
        return LAO_OK;
    }
    rows->before = (uint64_t *)flow4d__new(&host->allocator, rows->count, sizeof(uint64_t));
    if (!rows->before) {
        return flow4d__fail(host, FLOW4D_LOG_MEMORY, "rows of the mask");
    }
    rows->voxels = 0;
    for (r = 0; r < rows->count; r++) {
        rows->before[r] = rows->voxels;
        for (i = 0; i < field->size[0]; i++) {
            rows->voxels += field->mask[r * field->size[0] + i] != 0;
        }
    }
    return LAO_OK;
}

/* Index of the n-th voxel inside. */
static void flow4d__rows_pick(const flow4d__rows *rows, const flow4d_field *field, uint64_t n,
                              double index[3]) {
    size_t row = (size_t)(n / field->size[0]), x = (size_t)(n % field->size[0]);
    if (rows->before) {
        size_t low = 0, high = rows->count; /* the last row with before[row] <= n */
        while (high - low > 1) {
            size_t middle = low + (high - low) / 2;
            if (rows->before[middle] <= n) {
                low = middle;
            } else {
                high = middle;
            }
        }
        row = low;
        n -= rows->before[row];
        for (x = 0;; x++) {
            if (field->mask[row * field->size[0] + x] && n-- == 0) {
                break;
            }
        }
    }
    index[0] = (double)x;
    index[1] = (double)(row % field->size[1]);
    row /= field->size[1];
    index[2] = (double)row;
}

/* Number `use` of a line, in [0, 1), 53 bits. */
static double flow4d__random(uint32_t seed, uint32_t line, uint32_t use) {
    uint32_t high = lao_hash(lao_hash(lao_hash(seed) + line) + use);
    uint32_t low = lao_hash(high ^ 2654435769u);
    return ((double)(high >> 5) * 67108864.0 + (double)(low >> 6)) / 9007199254740992.0;
}

/* The seed of a line: place and time; 0, or -1 when no place was found (inside_at and the trilinear
   mask can refuse a place in a voxel of the mask). */
static int flow4d__seed(const flow4d__tracer *t, const flow4d__rows *rows,
                        const flow4d_trace_settings *s, uint32_t line, double x[3], double *time) {
    const flow4d_field *field = &t->sampler.field;
    uint32_t attempt, a;
    if (s->seeds) {
        memcpy(x, s->seeds + 4 * (size_t)line, 3 * sizeof(double));
        *time = s->seeds[4 * (size_t)line + 3];
        return flow4d__finite(time, 1) && flow4d_inside(&t->sampler, x, t->mask) ? 0 : -1;
    }
    *time = t->frozen ? 0.0 : flow4d__random(s->seed, line, 0) * field->period;
    for (attempt = 0; attempt < 4096; attempt++) {
        double index[3], u = flow4d__random(s->seed, line, 4 * attempt + 1);
        uint64_t n = (uint64_t)(u * (double)rows->voxels);
        flow4d__rows_pick(rows, field, n < rows->voxels ? n : rows->voxels - 1, index);
        for (a = 0; a < 3; a++) {
            index[a] += flow4d__random(s->seed, line, 4 * attempt + 2 + a) - 0.5;
        }
        flow4d__apply(field->to_world, index, x);
        if (flow4d_inside(&t->sampler, x, t->mask)) {
            return 0;
        }
    }
    return -1;
}

/* ================================================================================================
 * lines */

#define FLOW4D__BATCH_POINTS 524288u /* points of the scratch of one batch */
#define FLOW4D__CHUNK 16u            /* lines of one piece of work */

/* Points of one batch of lines, or of its lines packed together. */
typedef struct flow4d__points {
    float *memory; /* all arrays below, one behind the other */
    size_t count;
    float *points, *times, *speeds, *vorticity, *curvature;
} flow4d__points;

typedef struct flow4d__trace {
    flow4d__tracer tracer;
    flow4d_trace_settings settings; /* with defaults filled in */
    flow4d__rows rows;
    uint32_t slot;  /* points of the scratch per line */
    uint32_t lines; /* of a batch */
    uint32_t first; /* line of the batch */
    uint32_t now;   /* lines of this batch */
    flow4d__points scratch;
    uint32_t *begins; /* per line of the batch: its first point in its slot */
    uint32_t *counts; /* per line of the trace */
} flow4d__trace;

static size_t flow4d__floats(uint32_t attributes) {
    return 5u + (attributes & FLOW4D_VORTICITY ? 1u : 0u) +
           (attributes & FLOW4D_CURVATURE ? 1u : 0u);
}

static int flow4d__points_make(const flow4d_host *host, uint32_t attributes, size_t count,
                               flow4d__points *points) {
    size_t floats = flow4d__floats(attributes);
    float *next;
    memset(points, 0, sizeof *points);
    if (count == 0) {
        return 0;
    }
    points->memory = (float *)flow4d__new(&host->allocator, count, floats * sizeof(float));
    if (!points->memory) {
        return -1;
    }
    points->count = count;
    points->points = points->memory;
    points->times = points->memory + 3 * count;
    points->speeds = points->memory + 4 * count;
    next = points->memory + 5 * count;
    if (attributes & FLOW4D_VORTICITY) {
        points->vorticity = next;
        next += count;
    }
    points->curvature = attributes & FLOW4D_CURVATURE ? next : NULL;
    return 0;
}

static void flow4d__points_free(const flow4d_host *host, uint32_t attributes,
                                flow4d__points *points) {
    flow4d__delete(&host->allocator, points->memory, points->count,
                   flow4d__floats(attributes) * sizeof(float));
    memset(points, 0, sizeof *points);
}

static void flow4d__copy(const flow4d__points *from, size_t at, flow4d__points *to, size_t where,
                         size_t count) {
    memcpy(to->points + 3 * where, from->points + 3 * at, 3 * count * sizeof(float));
    memcpy(to->times + where, from->times + at, count * sizeof(float));
    memcpy(to->speeds + where, from->speeds + at, count * sizeof(float));
    if (from->vorticity) {
        memcpy(to->vorticity + where, from->vorticity + at, count * sizeof(float));
    }
    if (from->curvature) {
        memcpy(to->curvature + where, from->curvature + at, count * sizeof(float));
    }
}

/* Curvature of the circle through three points: four times the area over the product of edges. */
static double flow4d__circle(const double a[3], const double b[3], const double c[3]) {
    double u[3], v[3], w[3], n[3], edges;
    int i;
    for (i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - b[i];
        w[i] = c[i] - a[i];
    }
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    edges = flow4d__length(u) * flow4d__length(v) * flow4d__length(w);
    return edges > 0.0 ? 2.0 * flow4d__length(n) / edges : 0.0;
}

static void flow4d__put(const flow4d__trace *trace, size_t at, const double x[3], double time,
                        const double v[3]) {
    const flow4d__points *s = &trace->scratch;
    s->points[3 * at] = (float)x[0];
    s->points[3 * at + 1] = (float)x[1];
    s->points[3 * at + 2] = (float)x[2];
    s->times[at] = (float)time;
    s->speeds[at] = (float)flow4d__length(v);
    if (s->vorticity) {
        double curl[3], size;
        flow4d_vorticity(&trace->tracer.sampler, x,
                         trace->tracer.frozen ? trace->tracer.frozen_time : time, curl);
        size = flow4d__length(curl);
        s->vorticity[at] = flow4d__number(size) ? (float)size : 0.0f;
    }
}

/* How many steps of a span fit, at most the points of a line. */
static uint32_t flow4d__steps(const flow4d__trace *trace, double span) {
    double n = floor(span / trace->settings.step + 1e-9), most = trace->settings.max_points;
    return !(n > 0.0) ? 0u : n < most ? (uint32_t)n : (uint32_t)most;
}

/* Steps forward ([0]) and backward ([1]) from a seed at this time. */
static void flow4d__reach(const flow4d__trace *trace, double time, uint32_t steps[2]) {
    const flow4d_trace_settings *s = &trace->settings;
    double period = trace->tracer.sampler.field.period, ahead = 1e300, back = 1e300;
    uint32_t room = trace->slot - 1, half = room / 2, i;
    if (!trace->tracer.frozen && period > 0.0 && s->span != FLOW4D_SPAN_FREE) {
        double into = time - floor(time / period) * period;
        back = s->span == FLOW4D_SPAN_LOOP ? 0.5 * period : into;
        ahead = period - back;
    }
    steps[0] = flow4d__steps(trace, s->duration > 0.0 && s->duration < ahead ? s->duration : ahead);
    steps[1] = flow4d__steps(trace, s->duration > 0.0 && s->duration < back ? s->duration : back);
    steps[0] = s->direction == FLOW4D_BACKWARD ? 0 : steps[0];
    steps[1] = s->direction == FLOW4D_FORWARD ? 0 : steps[1];
    i = steps[0] < steps[1]; /* the longer one gives way, forward last */
    if (steps[0] > room || steps[1] > room - steps[0]) {
        uint32_t shorter = steps[1 - i] < half ? steps[1 - i] : half;
        steps[1 - i] = shorter;
        steps[i] = room - shorter < steps[i] ? room - shorter : steps[i];
    }
}

/* Steps from the seed, whose point is at `at`, in one direction; `first` receives the place after
   the first step. Returns the number of points made. */
static uint32_t flow4d__sweep(const flow4d__trace *trace, size_t at, uint32_t steps, int backward,
                              const double seed[3], const double velocity[3], double time,
                              double first[3]) {
    double before[3], x[3], v[3], h = backward ? -trace->settings.step : trace->settings.step;
    float *curvature = trace->scratch.curvature;
    uint32_t k;
    memcpy(before, seed, sizeof before);
    memcpy(x, seed, sizeof x);
    memcpy(v, velocity, sizeof v);
    for (k = 0; k < steps; k++) {
        double here[3], t = time + h * k;
        size_t place = backward ? at - k : at + k;
        memcpy(here, x, sizeof here);
        if (flow4d__length(v) < trace->settings.stop_speed ||
            flow4d__advance(&trace->tracer, t, h, x, v) != 0) {
            break;
        }
        if (curvature && k > 0) {
            curvature[place] = (float)flow4d__circle(before, here, x);
        }
        memcpy(before, here, sizeof before);
        if (k == 0) {
            memcpy(first, x, 3 * sizeof(double));
        }
        flow4d__put(trace, backward ? place - 1 : place + 1, x, time + h * (k + 1), v);
    }
    if (curvature && k > 0) {
        curvature[backward ? at - k : at + k] = 0.0f; /* the end */
    }
    return k;
}

static void flow4d__line(const flow4d__trace *trace, uint32_t local) {
    uint32_t line = trace->first + local, steps[2], ahead, back;
    double x[3], v[3], next[3], last[3], time;
    size_t at;
    trace->counts[line] = 0;
    trace->begins[local] = 0;
    if (flow4d__seed(&trace->tracer, &trace->rows, &trace->settings, line, x, &time) != 0) {
        return;
    }
    if (trace->tracer.frozen) {
        time = 0.0;
    }
    if (flow4d__velocity(&trace->tracer, x, time, v) != 0) {
        return;
    }
    flow4d__reach(trace, time, steps);
    at = (size_t)local * trace->slot + steps[1];
    flow4d__put(trace, at, x, time, v);
    ahead = flow4d__sweep(trace, at, steps[0], 0, x, v, time, next);
    back = flow4d__sweep(trace, at, steps[1], 1, x, v, time, last);
    if (trace->scratch.curvature) {
        trace->scratch.curvature[at] = ahead && back ? (float)flow4d__circle(last, x, next) : 0.0f;
    }
    trace->begins[local] = steps[1] - back;
    trace->counts[line] = back + 1 + ahead;
}

static void flow4d__chunk(void *arg, uint32_t chunk) {
    const flow4d__trace *trace = (const flow4d__trace *)arg;
    uint32_t i = chunk * FLOW4D__CHUNK, end = i + FLOW4D__CHUNK;
    for (; i < end && i < trace->now; i++) {
        flow4d__line(trace, i);
    }
}

static lao_result flow4d__setting_fail(const flow4d_host *host, const char *name, double value) {
    char text[64];
    snprintf(text, sizeof text, "%s is %g", name, value);
    return flow4d__fail(host, FLOW4D_LOG_SETTING, text);
}

/* Fills in what is 0 and refuses what cannot be. */
static lao_result flow4d__settings(const flow4d_host *host, const flow4d_sampler *sampler,
                                   flow4d_trace_settings *s) {
    const struct {
        const char *name;
        double value, least, most;
    } rows[] = {
        {"step", s->step, 0.0, 1e30},
        {"duration", s->duration, 0.0, 1e30},
        {"tolerance", s->tolerance, 0.0, 1e30},
        {"stop_speed", s->stop_speed, -1e30, 1e30},
        {"time", s->time, -1e30, 1e30},
        {"max_points", (double)s->max_points, 0.0, 4194304.0},
        {"method", (double)s->method, 0.0, FLOW4D_DOPRI},
        {"direction", (double)s->direction, 0.0, FLOW4D_BACKWARD},
        {"span", (double)s->span, 0.0, FLOW4D_SPAN_FREE},
        {"mask", (double)s->mask, 0.0, FLOW4D_MASK_NONE},
        {"attributes", (double)s->attributes, 0.0, FLOW4D_VORTICITY + FLOW4D_CURVATURE},
        {"line_count beyond seed_count", s->seeds ? (double)s->line_count : 0.0, 0.0,
         (double)s->seed_count},
        {"line_count", (double)s->line_count, 0.0, 4294967294.0},
        {"seed_count", (double)s->seed_count, 0.0, 4294967294.0},
    };
    size_t i;
    for (i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if (!(rows[i].value >= rows[i].least && rows[i].value <= rows[i].most)) {
            return flow4d__setting_fail(host, rows[i].name, rows[i].value);
        }
    }
    s->line_count = s->line_count ? s->line_count : s->seeds ? s->seed_count : 30000u;
    s->max_points = s->max_points ? s->max_points : 200u;
    s->tolerance = s->tolerance > 0.0 ? s->tolerance : 1e-4;
    s->stop_speed = s->stop_speed == 0.0 ? 1e-6 : s->stop_speed;
    if (!(s->step > 0.0)) {
        s->step = sampler->field.period / 200.0;
        if (s->streamlines || !(s->step > 0.0)) {
            double fastest = flow4d_max_speed(sampler);
            s->step = 0.5 * flow4d__shortest_edge(sampler->field.to_world) /
                      (fastest > 0.0 ? fastest : 1.0);
        }
    }
    if (!(s->step > 0.0 && s->step <= 1e30)) {
        return flow4d__setting_fail(host, "step", s->step);
    }
    return LAO_OK;
}

/* The most points that a line can have. */
static uint32_t flow4d__slot(const flow4d__trace *trace) {
    const flow4d_trace_settings *s = &trace->settings;
    double period = trace->tracer.sampler.field.period, span = 1e300;
    uint32_t steps;
    if (!trace->tracer.frozen && period > 0.0 && s->span != FLOW4D_SPAN_FREE) {
        span = period;
    }
    if (s->duration > 0.0 && 2.0 * s->duration < span) {
        span = 2.0 * s->duration;
    }
    steps = flow4d__steps(trace, span);
    return steps + 1 < s->max_points ? steps + 1 : s->max_points;
}

/* Integrates one batch and packs its lines. */
static lao_result flow4d__batch(const flow4d_host *host, flow4d__trace *trace,
                                flow4d__points *packed) {
    uint32_t i;
    size_t count = 0, where = 0;
    flow4d__run(host, (trace->now + FLOW4D__CHUNK - 1) / FLOW4D__CHUNK, flow4d__chunk, trace);
    for (i = 0; i < trace->now; i++) {
        count += trace->counts[trace->first + i];
    }
    if (flow4d__points_make(host, trace->settings.attributes, count, packed) != 0) {
        return flow4d__fail(host, FLOW4D_LOG_MEMORY, "points of a batch of lines");
    }
    for (i = 0; i < trace->now; i++) {
        uint32_t points = trace->counts[trace->first + i];
        if (points) {
            flow4d__copy(&trace->scratch, (size_t)i * trace->slot + trace->begins[i], packed, where,
                         points);
        }
        where += points;
    }
    return LAO_OK;
}

static lao_result flow4d__batches(const flow4d_host *host, flow4d__trace *trace,
                                  flow4d__points *batches) {
    lao_result result = LAO_OK;
    uint32_t done, b = 0;
    uint32_t lines = trace->settings.line_count;
    for (done = 0; done < lines && result == LAO_OK; done += trace->now, b++) {
        trace->first = done;
        trace->now = lines - done < trace->lines ? lines - done : trace->lines;
        result = flow4d__batch(host, trace, &batches[b]);
        if (result == LAO_OK && flow4d__progress(host, (uint64_t)done + trace->now, lines)) {
            result = flow4d__fail(host, FLOW4D_LOG_CANCELLED, "flow4d_trace");
        }
    }
    return result;
}

/* The arrays of the result, and where batches are copied to. */
static lao_result flow4d__lines_make(const flow4d_host *host, uint32_t attributes,
                                     uint32_t line_count, uint32_t point_count, flow4d_lines *lines,
                                     flow4d__points *view) {
    const lao_allocator *a = &host->allocator;
    size_t n = point_count, size = sizeof(float);
    memset(lines, 0, sizeof *lines);
    memset(view, 0, sizeof *view);
    lines->allocator = *a;
    lines->line_count = lines->line_room = line_count;
    lines->point_count = lines->point_room = point_count;
    lines->offsets = (uint32_t *)flow4d__new(a, (size_t)line_count + 1, sizeof(uint32_t));
    lines->points = view->points = (float *)flow4d__new(a, n, 3 * size);
    lines->times = view->times = (float *)flow4d__new(a, n, size);
    lines->speeds = view->speeds = (float *)flow4d__new(a, n, size);
    if (attributes & FLOW4D_VORTICITY) {
        lines->vorticity = view->vorticity = (float *)flow4d__new(a, n, size);
    }
    if (attributes & FLOW4D_CURVATURE) {
        lines->curvature = view->curvature = (float *)flow4d__new(a, n, size);
    }
    if (!lines->offsets || (n && (!lines->points || !lines->times || !lines->speeds)) ||
        (n && (attributes & FLOW4D_VORTICITY) && !lines->vorticity) ||
        (n && (attributes & FLOW4D_CURVATURE) && !lines->curvature)) {
        flow4d_lines_free(lines);
        return flow4d__fail(host, FLOW4D_LOG_MEMORY, "the lines");
    }
    return LAO_OK;
}

static lao_result flow4d__gather(const flow4d_host *host, const flow4d__trace *trace,
                                 const flow4d__points *batches, size_t batch_count,
                                 flow4d_lines *lines) {
    flow4d__points view;
    uint64_t points = 0;
    size_t b, where = 0;
    uint32_t i;
    lao_result result;
    for (b = 0; b < batch_count; b++) {
        points += batches[b].count;
    }
    if (points == 0 && !trace->settings.seeds) {
        return flow4d__fail(host, FLOW4D_LOG_EMPTY, "no random seed was inside with a velocity");
    }
    if (points > 0xfffffffeu) {
        return flow4d__fail(host, FLOW4D_LOG_COUNT, "points of all lines");
    }
    result = flow4d__lines_make(host, trace->settings.attributes, trace->settings.line_count,
                                (uint32_t)points, lines, &view);
    if (result != LAO_OK) {
        return result;
    }
    for (b = 0; b < batch_count; b++) {
        if (batches[b].count) {
            flow4d__copy(&batches[b], 0, &view, where, batches[b].count);
        }
        where += batches[b].count;
    }
    for (i = 0; i < lines->line_count; i++) {
        lines->offsets[i + 1] = lines->offsets[i] + trace->counts[i];
    }
    lines->step = trace->settings.step;
    return LAO_OK;
}

/* With the seeds' rows there: scratch, batches, result. */
static lao_result flow4d__trace_lines(const flow4d_host *host, flow4d__trace *trace,
                                      flow4d_lines *lines) {
    const lao_allocator *a = &host->allocator;
    uint32_t line_count = trace->settings.line_count, attributes = trace->settings.attributes;
    size_t batch_count, b;
    flow4d__points *batches;
    lao_result result;
    trace->slot = flow4d__slot(trace);
    trace->lines = FLOW4D__BATCH_POINTS / trace->slot;
    trace->lines = trace->lines < 1 ? 1 : trace->lines < line_count ? trace->lines : line_count;
    batch_count = (size_t)line_count / trace->lines + (line_count % trace->lines != 0);
    batches = (flow4d__points *)flow4d__new(a, batch_count, sizeof *batches);
    trace->begins = (uint32_t *)flow4d__new(a, trace->lines, sizeof(uint32_t));
    trace->counts = (uint32_t *)flow4d__new(a, line_count, sizeof(uint32_t));
    if (!batches || !trace->begins || !trace->counts ||
        flow4d__points_make(host, attributes, (size_t)trace->lines * trace->slot,
                            &trace->scratch) != 0) {
        result = flow4d__fail(host, FLOW4D_LOG_MEMORY, "scratch of the lines");
    } else {
        result = flow4d__batches(host, trace, batches);
    }
    flow4d__points_free(host, attributes, &trace->scratch);
    if (result == LAO_OK) {
        result = flow4d__gather(host, trace, batches, batch_count, lines);
    }
    for (b = 0; batches && b < batch_count; b++) {
        flow4d__points_free(host, attributes, &batches[b]);
    }
    flow4d__delete(a, batches, batch_count, sizeof *batches);
    flow4d__delete(a, trace->begins, trace->lines, sizeof(uint32_t));
    flow4d__delete(a, trace->counts, line_count, sizeof(uint32_t));
    return result;
}

lao_result flow4d_trace(const flow4d_host *host, const flow4d_field *field,
                        const flow4d_trace_settings *settings, flow4d_lines *lines) {
    flow4d_host h = flow4d__host(host);
    flow4d__trace trace;
    flow4d_lines made;
    lao_result result;
    memset(&trace, 0, sizeof trace);
    if (!lines) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "lines of flow4d_trace");
    }
    if (settings) {
        trace.settings = *settings;
    }
    result = flow4d_sampler_make(&h, field, &trace.tracer.sampler);
    if (result == LAO_OK) {
        result = flow4d__settings(&h, &trace.tracer.sampler, &trace.settings);
    }
    if (result != LAO_OK) {
        return result;
    }
    trace.tracer.method = trace.settings.method;
    trace.tracer.mask = trace.settings.mask;
    trace.tracer.tolerance = trace.settings.tolerance;
    trace.tracer.frozen = trace.settings.streamlines != 0 || !(field->period > 0.0);
    trace.tracer.frozen_time = trace.settings.time;
    if (trace.settings.seeds && trace.settings.line_count == 0) { /* no lines: a result like any */
        flow4d__points unused;
        result = flow4d__lines_make(&h, trace.settings.attributes, 0, 0, &made, &unused);
        made.step = trace.settings.step;
    } else {
        result = flow4d__rows_make(&h, field, trace.settings.mask, &trace.rows);
        if (result == LAO_OK && trace.rows.voxels == 0 && !trace.settings.seeds) {
            result = flow4d__fail(&h, FLOW4D_LOG_EMPTY, "the mask has no voxel inside");
        }
        if (result == LAO_OK) {
            result = flow4d__trace_lines(&h, &trace, &made);
        }
        flow4d__delete(&h.allocator, trace.rows.before, trace.rows.count, sizeof(uint64_t));
    }
    if (result == LAO_OK) {
        *lines = made;
    }
    return result;
}

void flow4d_lines_free(flow4d_lines *lines) {
    size_t n;
    if (!lines || !lines->allocator.release) {
        return;
    }
    n = lines->point_room;
    flow4d__delete(&lines->allocator, lines->offsets, (size_t)lines->line_room + 1,
                   sizeof(uint32_t));
    flow4d__delete(&lines->allocator, lines->points, n, 3 * sizeof(float));
    flow4d__delete(&lines->allocator, lines->times, n, sizeof(float));
    flow4d__delete(&lines->allocator, lines->speeds, n, sizeof(float));
    flow4d__delete(&lines->allocator, lines->vorticity, n, sizeof(float));
    flow4d__delete(&lines->allocator, lines->curvature, n, sizeof(float));
    memset(lines, 0, sizeof *lines);
}

lao_lines_desc flow4d_lines_describe(const flow4d_lines *lines) {
    lao_lines_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.line_count = lines->line_count;
    desc.point_count = lines->point_count;
    desc.offsets = lines->offsets;
    desc.points = lines->points;
    desc.times = lines->times;
    return desc;
}

/* ================================================================================================
 * volumes */

static lao_result flow4d__volume_check(const flow4d_host *host, const flow4d_volume *volume,
                                       double from_world[12]) {
    if (!volume || (!volume->values && !volume->mask)) {
        return flow4d__fail(host, FLOW4D_LOG_NULL_ARGUMENT, "the volume, or its values and mask");
    }
    return flow4d__lattice_check(host, volume->size, 1, sizeof(float), volume->to_world,
                                 from_world);
}

static double flow4d__value(const flow4d_volume *volume, size_t voxel) {
    return volume->values ? (double)volume->values[voxel] : volume->mask[voxel] ? 1.0 : 0.0;
}

/* ---- projection */

/* Inverse of a column-major 4x4 matrix by elimination with pivots; 0, or -1 when there is none. */
static int flow4d__invert4(const double m[16], double inverse[16]) {
    double a[4][8];
    int r, c, k;
    for (r = 0; r < 4; r++) {
        for (c = 0; c < 8; c++) {
            a[r][c] = c < 4 ? m[4 * c + r] : c - 4 == r ? 1.0 : 0.0;
        }
    }
    for (k = 0; k < 4; k++) {
        int best = k;
        for (r = k + 1; r < 4; r++) {
            best = fabs(a[r][k]) > fabs(a[best][k]) ? r : best;
        }
        if (!(fabs(a[best][k]) > 0.0)) {
            return -1;
        }
        for (c = 0; c < 8; c++) {
            double swapped = a[best][c];
            a[best][c] = a[k][c];
            a[k][c] = swapped;
        }
        for (r = 0; r < 4; r++) {
            double factor = a[r][k] / a[k][k];
            for (c = 0; c < 8 && r != k; c++) {
                a[r][c] -= factor * a[k][c];
            }
        }
    }
    for (r = 0; r < 4; r++) {
        for (c = 0; c < 4; c++) {
            inverse[4 * c + r] = a[r][c + 4] / a[r][r];
        }
    }
    return flow4d__finite(inverse, 16) ? 0 : -1;
}

typedef struct flow4d__projection {
    const flow4d_volume *volume;
    double from_world[12];
    double from_clip[16];
    double near_depth, middle_depth; /* NDC */
    double step;                     /* mm */
    double up;                       /* 1, or -1 when the camera turns the picture over */
    uint32_t width, height;
    float *image;
} flow4d__projection;

static int flow4d__unproject(const double m[16], double x, double y, double z, double p[3]) {
    double w = m[3] * x + m[7] * y + m[11] * z + m[15];
    int i;
    for (i = 0; i < 3; i++) {
        p[i] = (m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i]) / w;
    }
    return flow4d__finite(p, 3) ? 0 : -1;
}

/* Part of the ray from + t along (voxel indices), t >= 0, that lies in the box; 0 when none. */
static int flow4d__clip(const uint32_t size[3], const double from[3], const double along[3],
                        double span[2]) {
    int a;
    span[0] = 0.0;
    span[1] = 1e300;
    for (a = 0; a < 3; a++) {
        double low = -0.5 - from[a], high = (double)size[a] - 0.5 - from[a];
        if (along[a] == 0.0) {
            if (low > 0.0 || high < 0.0) {
                return 0;
            }
            continue;
        }
        low /= along[a];
        high /= along[a];
        span[0] = fmax(span[0], fmin(low, high));
        span[1] = fmin(span[1], fmax(low, high));
    }
    return span[1] >= span[0];
}

static double flow4d__ray(const flow4d__projection *p, const double from[3], const double to[3]) {
    double a[3], b[3], along[3], span[2], length, greatest = 0.0, way[3];
    size_t k, samples;
    int i, c;
    for (i = 0; i < 3; i++) {
        way[i] = to[i] - from[i];
    }
    length = flow4d__length(way);
    flow4d__apply(p->from_world, from, a);
    flow4d__apply(p->from_world, to, b);
    for (i = 0; i < 3; i++) {
        along[i] = (b[i] - a[i]) / length;
    }
    if (!flow4d__finite(along, 3) || !flow4d__clip(p->volume->size, a, along, span)) {
        return 0.0;
    }
    samples = (size_t)ceil((span[1] - span[0]) / p->step) + 1;
    for (k = 0; k < samples; k++) {
        double t = span[0] + (span[1] - span[0]) * ((double)k + 0.5) / (double)samples, index[3];
        double sum = 0.0;
        flow4d__cell cell;
        for (i = 0; i < 3; i++) {
            index[i] = a[i] + t * along[i];
        }
        flow4d__cell_make(p->volume->size, index, &cell);
        for (c = 0; c < 8; c++) {
            if (cell.weight[c] > 0.0) {
                sum += cell.weight[c] * flow4d__value(p->volume, cell.voxel[c]);
            }
        }
        greatest = sum > greatest ? sum : greatest; /* NaN is not */
    }
    return greatest;
}

static void flow4d__project_row(void *arg, size_t row) {
    const flow4d__projection *p = (const flow4d__projection *)arg;
    double y = p->up * (2.0 * ((double)row + 0.5) / p->height - 1.0);
    uint32_t i;
    for (i = 0; i < p->width; i++) {
        double x = 2.0 * ((double)i + 0.5) / p->width - 1.0, from[3], to[3], value = 0.0;
        if (flow4d__unproject(p->from_clip, x, y, p->near_depth, from) == 0 &&
            flow4d__unproject(p->from_clip, x, y, p->middle_depth, to) == 0) {
            value = flow4d__ray(p, from, to);
        }
        p->image[row * p->width + i] = (float)value;
    }
}

static int flow4d__camera(const lao_camera *camera, flow4d__projection *p) {
    double clip[16], least = camera->flags & LAO_CAMERA_ZERO_TO_ONE ? 0.0 : -1.0;
    int r, c, k;
    for (c = 0; c < 4; c++) {
        for (r = 0; r < 4; r++) {
            clip[4 * c + r] = 0.0;
            for (k = 0; k < 4; k++) {
                clip[4 * c + r] +=
                    (double)camera->projection[4 * k + r] * (double)camera->view[4 * c + k];
            }
        }
    }
    p->near_depth = camera->flags & LAO_CAMERA_REVERSE_DEPTH ? 1.0 : least;
    p->middle_depth = 0.5 * (1.0 + least);
    p->up = camera->flags & LAO_CAMERA_FLIP_Y ? -1.0 : 1.0;
    return flow4d__finite(clip, 16) ? flow4d__invert4(clip, p->from_clip) : -1;
}

lao_result flow4d_project_maximum(const flow4d_host *host, const flow4d_volume *volume,
                                  const lao_camera *camera, uint32_t width, uint32_t height,
                                  float *image) {
    flow4d_host h = flow4d__host(host);
    flow4d__projection p;
    lao_result result;
    if (!camera || !image) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "camera or image of the projection");
    }
    result = flow4d__volume_check(&h, volume, p.from_world);
    if (result != LAO_OK) {
        return result;
    }
    if (width == 0 || height == 0 || width > (size_t)-1 / sizeof(float) / height) {
        return flow4d__fail(&h, FLOW4D_LOG_IMAGE, "width or height");
    }
    if (flow4d__camera(camera, &p) != 0) {
        return flow4d__fail(&h, FLOW4D_LOG_CAMERA, "projection times view");
    }
    p.volume = volume;
    p.step = 0.5 * flow4d__shortest_edge(volume->to_world);
    p.width = width;
    p.height = height;
    p.image = image;
    return flow4d__work(&h, "flow4d_project_maximum", height, flow4d__project_row, &p);
}

/* ---- marching cubes */

/* Triangles per case: bit c of the case is 1 when corner c = x + 2 y + 4 z of the cell is inside.
   Three letters per triangle, a..l: edges 0..11, four along x, four along y, four along z, in order
   of the corner that they leave. Made by one rule, so that neighbours agree on every face: a face's
   runs of inside corners are each cut off by one segment, the segments of all six faces close to
   loops, and a loop is cut into triangles without a diagonal inside a face. tests/flow proves it.
 */
// clang-format off
static const char *const flow4d__cases[256] = {
    "", "aei", "ajf", "eiffij", "bke", "abiibk", "ajfbke", "bkffkjjki", "bfl", "aeibfl", "ajbbjl",
    "bellejjei", "efkkfl", "afiifkkfl", "ajeejkkjl", "ijkkjl", "cig", "aecceg", "ajfcig",
    "cjggjeejf", "bkecig", "abccbggbk", "ajfbkecig", "bkffkjjkcckg", "bflcig", "aeccegbfl",
    "ajbbjlcig", "bellejjecceg", "cigefkkfl", "afccfggfkkfl", "ajeejkkjlcig", "cjggjkkjl", "chj",
    "aeichj", "acffch", "chiiheehf", "bkechj", "abiibkchj", "acffchbke", "bkffkhhkccki", "bflchj",
    "aeibflchj", "acbbcllch", "bellehheccei", "chjefkkfl", "afiifkkflchj", "aceeckkcllch",
    "chiihkkhl", "ghiihj", "aejjehheg", "aiffihhig", "egffgh", "bkeghiihj", "abjjbhhbggbk",
    "aiffihhigbke", "bkffkhhkg", "bflghiihj", "aejjehhegbfl", "aibbillihhig", "bellehheg",
    "efkkflghiihj", "agjjghafggfkkfl", "aleelkaillihhig", "ghkkhl", "dgk", "aeidgk", "ajfdgk",
    "dgkeiffij", "bdeedg", "abiibggbd", "ajfbdeedg", "bdffdjjdiidg", "bfldgk", "aeibfldgk",
    "ajbbjldgk", "bellejjeidgk", "dgllgffge", "afiifggfddfl", "ajeejggjddjl", "dgllgjjgi", "ciddik",
    "aecceddek", "ajfciddik", "cjddjkkjeejf", "bdeediidc", "abccbd", "ajfbdeediidc", "bdffdjjdc",
    "bflciddik", "aecceddekbfl", "ajbbjlciddik", "bellejjecceddek", "ciddilliffie", "afccfddfl",
    "ajeediidcejddjl", "cjddjl", "chjdgk", "aeichjdgk", "acffchdgk", "chiiheehfdgk", "bdeedgchj",
    "abiibggbdchj", "acffchbdeedg", "bdffihhicfdiidg", "bflchjdgk", "aeibflchjdgk", "acbbcllchdgk",
    "bellehhecceidgk", "chjdgllgffge", "afiifggfddflchj", "aceelggldecllch", "chiilggldihl",
    "dhkkhiihj", "aejjehheddek", "aiffihhiddik", "dhkkheehf", "bdeediidjjdh", "abjjbhhbd",
    "aiffihhiddibbie", "bdffdh", "bfldhkkhiihj", "aejjehheddekbfl", "aibbillihhiddik",
    "bellehheddek", "dellefdheehiihj", "adjjdhafddfl", "aiedhl", "dhl", "dlh", "aeidlh", "ajfdlh",
    "dlheiffij", "bkedlh", "abiibkdlh", "ajfbkedlh", "bkffkjjkidlh", "bfddfh", "aeibfddfh",
    "ajbbjddjh", "beddehhejjei", "dkhhkffke", "afiifkkfddfh", "ajeejkkjddjh", "dkhhkjjki", "cigdlh",
    "aeccegdlh", "ajfcigdlh", "cjggjeejfdlh", "bkecigdlh", "abccbggbkdlh", "ajfbkecigdlh",
    "bkffkjjkcckgdlh", "bfddfhcig", "aeccegbfddfh", "ajbbjddjhcig", "beddehhejjecceg",
    "cigdkhhkffke", "afccfggfkkfddfh", "ajeejkkjddjhcig", "cjggjkkjddjh", "cdjjdl", "aeicdjjdl",
    "acffcllcd", "cdiideedffdl", "bkecdjjdl", "abiibkcdjjdl", "acffcllcdbke", "bkffcllcdfkccki",
    "bfddfccfj", "aeibfddfccfj", "acbbcd", "beddeccei", "cdjjdffdeedk", "afiifkkfddfccfj",
    "aceeckkcd", "cdiidk", "dlggliilj", "aejjelleddeg", "aiffilliddig", "dlggleelf", "bkedlggliilj",
    "abjjgllgdjbggbk", "aiffilliddigbke", "bkffgllgdfkg", "bfddfggfiifj", "aejjdffdbjeddeg",
    "aibbiddig", "beddeg", "djggjidkjjkffke", "afjdkg", "adeedkaiddig", "dkg", "gkhhkl",
    "aeigkhhkl", "ajfgkhhkl", "eiffijgkhhkl", "bleelgglh", "abiibggbhhbl", "ajfbleelgglh",
    "biffijbliilgglh", "bfkkfggfh", "aeibfkkfggfh", "ajbbjkkjggjh", "bhkkhgbehhejjei", "efggfh",
    "afiifggfh", "ajeejggjh", "gihhij", "cihhillik", "aeccehhellek", "ajfcihhillik",
    "ckhhklcjkkjeejf", "bleeliilcclh", "abccbhhbl", "ajfbleeliilcclh", "bcffcjblcclh",
    "bfkkfiifccfh", "aeccehhkffkbhek", "ajbbjkkhiihckjh", "bekcjh", "cihhiffie", "afccfh",
    "ajeehiihcejh", "cjh", "cgjjgllgk", "aeicgjjgllgk", "acffcllckkcg", "cfiifecgffgllgk",
    "bleelgglcclj", "abiibggbccbjjbl", "acffcllcbbceecg", "blfcgi", "bfkkfggfccfj",
    "aeibfkkfggfccfj", "acbbckkcg", "bckkcgbeccei", "cgjjgffge", "afiifggfccfj", "aceecg", "cgi",
    "ikjjkl", "aejjellek", "aiffillik", "ekffkl", "bleeliilj", "abjjbl", "aiffillibbie", "blf",
    "bfkkfiifj", "aejjkffkbjek", "aibbik", "bek", "efiifj", "afj", "aie", ""
};
// clang-format on

typedef struct flow4d__march {
    const flow4d_volume *volume;
    const float *smooth; /* or NULL: the volume's own values */
    double iso;
    int inside_is_less;
    int mirrored;          /* to_world turns triangles over */
    size_t width, row;     /* of a slice of points: size[0] + 2, (size[0] + 2) * (size[1] + 2) */
    uint8_t *inside[2];    /* slices z and z + 1, with a border of outside points */
    uint32_t *along[2][2]; /* vertices on edges along x, y, per slice */
    uint32_t *across;      /* vertices on edges between the slices */
    uint64_t vertex_count, triangle_count;
    float *vertices; /* NULL: only count */
    uint32_t *triangles;
} flow4d__march;

/* Value at a point of the padded slices: point 0 is voxel -1. NaN outside the volume. */
static double flow4d__march_value(const flow4d__march *m, size_t x, size_t y, size_t z) {
    const uint32_t *size = m->volume->size;
    size_t voxel;
    if (x < 1 || y < 1 || z < 1 || x > size[0] || y > size[1] || z > size[2]) {
        return (double)NAN;
    }
    voxel = x - 1 + size[0] * (y - 1 + size[1] * (z - 1));
    return m->smooth ? (double)m->smooth[voxel] : flow4d__value(m->volume, voxel);
}

static void flow4d__march_slice(const flow4d__march *m, size_t z, uint8_t *inside) {
    size_t x, y;
    for (y = 0; y < m->row / m->width; y++) {
        for (x = 0; x < m->width; x++) {
            double v = flow4d__march_value(m, x, y, z);
            inside[y * m->width + x] = m->inside_is_less ? v < m->iso : v >= m->iso;
        }
    }
}

/* The vertex on the edge from point (x, y, z) along an axis, whose ends differ. Not nearer to an
   end than 1/1024, so that no triangle shrinks to nothing; half-way when an end has no value. */
static uint32_t flow4d__march_vertex(flow4d__march *m, size_t x, size_t y, size_t z, int axis) {
    if (m->vertices) {
        double a = flow4d__march_value(m, x, y, z);
        double b = flow4d__march_value(m, x + (axis == 0), y + (axis == 1), z + (axis == 2));
        double t = (m->iso - a) / (b - a), index[3], p[3];
        float *vertex = m->vertices + 3 * m->vertex_count;
        t = flow4d__number(t) ? fmin(fmax(t, 1.0 / 1024), 1023.0 / 1024) : 0.5;
        index[0] = (double)x - 1.0;
        index[1] = (double)y - 1.0;
        index[2] = (double)z - 1.0;
        index[axis] += t;
        flow4d__apply(m->volume->to_world, index, p);
        vertex[0] = (float)p[0];
        vertex[1] = (float)p[1];
        vertex[2] = (float)p[2];
    }
    return (uint32_t)m->vertex_count++;
}

/* Vertices on the edges of slice z + 1 and between it and slice z. */
static void flow4d__march_edges(flow4d__march *m, size_t z) {
    size_t x, y, i = 0, height = m->row / m->width;
    for (y = 0; y < height; y++) {
        for (x = 0; x < m->width; x++, i++) {
            const uint8_t *next = m->inside[1];
            if (m->inside[0][i] != next[i]) {
                m->across[i] = flow4d__march_vertex(m, x, y, z, 2);
            }
            if (x + 1 < m->width && next[i] != next[i + 1]) {
                m->along[1][0][i] = flow4d__march_vertex(m, x, y, z + 1, 0);
            }
            if (y + 1 < height && next[i] != next[i + m->width]) {
                m->along[1][1][i] = flow4d__march_vertex(m, x, y, z + 1, 1);
            }
        }
    }
}

/* The vertex on edge 0..11 of the cell whose first corner is point i of the slice. */
static uint32_t flow4d__march_edge(const flow4d__march *m, size_t i, int edge) {
    int axis = edge / 4, u = edge & 1, v = (edge >> 1) & 1;
    if (axis == 2) {
        return m->across[i + (size_t)u + (v ? m->width : 0)];
    }
    return m->along[v][axis][i + (u ? (axis == 0 ? m->width : 1) : 0)];
}

static void flow4d__march_cells(flow4d__march *m) {
    size_t x, y, height = m->row / m->width;
    for (y = 0; y + 1 < height; y++) {
        for (x = 0; x + 1 < m->width; x++) {
            size_t i = y * m->width + x;
            const char *letter;
            unsigned which = 0;
            int c;
            for (c = 0; c < 8; c++) {
                const uint8_t *slice = m->inside[c >> 2];
                which |= (unsigned)slice[i + (c & 1) + (c & 2 ? m->width : 0)] << c;
            }
            for (letter = flow4d__cases[which]; *letter; letter += 3) {
                if (m->triangles) {
                    uint32_t *t = m->triangles + 3 * m->triangle_count;
                    t[0] = flow4d__march_edge(m, i, letter[0] - 'a');
                    t[1] = flow4d__march_edge(m, i, letter[m->mirrored ? 2 : 1] - 'a');
                    t[2] = flow4d__march_edge(m, i, letter[m->mirrored ? 1 : 2] - 'a');
                }
                m->triangle_count++;
            }
        }
    }
}

/* All cells: counts, or with arrays there, fills them. `done`: slices before, for the host. */
static lao_result flow4d__march_run(const flow4d_host *host, flow4d__march *m, size_t done) {
    size_t z, slices = (size_t)m->volume->size[2] + 1;
    m->vertex_count = m->triangle_count = 0;
    memset(m->inside[0], 0, m->row);
    for (z = 0; z < slices; z++) {
        uint8_t *inside = m->inside[0];
        uint32_t *along[2];
        flow4d__march_slice(m, z + 1, m->inside[1]);
        flow4d__march_edges(m, z);
        flow4d__march_cells(m);
        memcpy(along, m->along[0], sizeof along);
        memcpy(m->along[0], m->along[1], sizeof along);
        memcpy(m->along[1], along, sizeof along);
        m->inside[0] = m->inside[1];
        m->inside[1] = inside;
        if (flow4d__progress(host, done + z + 1, 2 * (uint64_t)slices)) {
            return flow4d__fail(host, FLOW4D_LOG_CANCELLED, "flow4d_surface_make");
        }
    }
    return LAO_OK;
}

/* Counts, allocates, fills. */
static lao_result flow4d__march_make(const flow4d_host *host, flow4d__march *m,
                                     flow4d_surface *surface) {
    size_t size = 3 * sizeof(float);
    lao_result result = flow4d__march_run(host, m, 0);
    if (result != LAO_OK) {
        return result;
    }
    if (m->vertex_count > 0xfffffffeu || m->triangle_count > 0xfffffffeu) {
        return flow4d__fail(host, FLOW4D_LOG_COUNT, "vertices or triangles of the surface");
    }
    memset(surface, 0, sizeof *surface);
    surface->allocator = host->allocator;
    if (m->triangle_count == 0) {
        return LAO_OK;
    }
    surface->vertex_count = (uint32_t)m->vertex_count;
    surface->triangle_count = (uint32_t)m->triangle_count;
    surface->vertices = (float *)flow4d__new(&host->allocator, surface->vertex_count, size);
    surface->triangles =
        (uint32_t *)flow4d__new(&host->allocator, surface->triangle_count, 3 * sizeof(uint32_t));
    if (!surface->vertices || !surface->triangles) {
        result = flow4d__fail(host, FLOW4D_LOG_MEMORY, "the surface");
    } else {
        m->vertices = surface->vertices;
        m->triangles = surface->triangles;
        result = flow4d__march_run(host, m, (size_t)m->volume->size[2] + 1);
    }
    if (result != LAO_OK) {
        flow4d_surface_free(surface);
    }
    return result;
}

/* One 1-2-1 pass along a row of `count` values, `stride` apart; the ends are repeated. A voxel
   without a value keeps none and has no weight for its neighbours. */
static void flow4d__smooth_row(float *values, size_t stride, size_t count) {
    float before = values[0];
    size_t i;
    for (i = 0; i < count; i++) {
        float here = values[i * stride];
        float after = i + 1 < count ? values[(i + 1) * stride] : here;
        if (here == here) {
            double a = before == before ? (double)before : (double)here;
            double b = after == after ? (double)after : (double)here;
            values[i * stride] = (float)(0.25 * a + 0.5 * (double)here + 0.25 * b);
        }
        before = here;
    }
}

static void flow4d__smooth(float *values, const uint32_t size[3]) {
    size_t x = size[0], y = size[1], z = size[2], i, j;
    for (i = 0; i < y * z; i++) {
        flow4d__smooth_row(values + i * x, 1, x);
    }
    for (j = 0; j < z; j++) {
        for (i = 0; i < x; i++) {
            flow4d__smooth_row(values + j * x * y + i, x, y);
        }
    }
    for (i = 0; i < x * y; i++) {
        flow4d__smooth_row(values + i, x * y, z);
    }
}

/* A smoothed copy of the volume; NULL when there is no memory. */
static float *flow4d__smoothed(const flow4d_host *host, const flow4d_volume *volume,
                               uint32_t passes) {
    size_t i, count = flow4d__count(volume->size, 1, sizeof(float));
    float *values = (float *)flow4d__new(&host->allocator, count, sizeof(float));
    for (i = 0; values && i < count; i++) {
        values[i] = (float)flow4d__value(volume, i);
    }
    for (i = 0; values && i < passes; i++) {
        flow4d__smooth(values, volume->size);
    }
    return values;
}

/* Memory for slices of points: `bytes` of flags behind `words` of vertices. */
static lao_result flow4d__march_memory(const flow4d_host *host, flow4d__march *m,
                                       flow4d_surface *surface) {
    const lao_allocator *a = &host->allocator;
    uint32_t *words = (uint32_t *)flow4d__new(a, m->row, 5 * sizeof(uint32_t));
    uint8_t *flags = (uint8_t *)flow4d__new(a, m->row, 2);
    lao_result result;
    if (!words || !flags) {
        result = flow4d__fail(host, FLOW4D_LOG_MEMORY, "slices of the surface");
    } else {
        m->inside[0] = flags;
        m->inside[1] = flags + m->row;
        m->along[0][0] = words;
        m->along[0][1] = words + m->row;
        m->along[1][0] = words + 2 * m->row;
        m->along[1][1] = words + 3 * m->row;
        m->across = words + 4 * m->row;
        result = flow4d__march_make(host, m, surface);
    }
    flow4d__delete(a, words, m->row, 5 * sizeof(uint32_t));
    flow4d__delete(a, flags, m->row, 2);
    return result;
}

lao_result flow4d_surface_make(const flow4d_host *host, const flow4d_volume *volume, double iso,
                               const flow4d_surface_settings *settings, flow4d_surface *surface) {
    flow4d_host h = flow4d__host(host);
    flow4d__march m;
    flow4d_surface made;
    uint32_t padded[3], smoothing = settings ? settings->smoothing : 0;
    double unused[12];
    float *smooth = NULL;
    lao_result result;
    if (!surface) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "surface of flow4d_surface_make");
    }
    result = flow4d__volume_check(&h, volume, unused);
    if (result != LAO_OK) {
        return result;
    }
    if (!flow4d__number(iso)) {
        return flow4d__fail(&h, FLOW4D_LOG_ISO, "flow4d_surface_make");
    }
    if (smoothing > 100) {
        return flow4d__setting_fail(&h, "smoothing", (double)smoothing);
    }
    memset(&m, 0, sizeof m);
    padded[0] = volume->size[0] + 2;
    padded[1] = volume->size[1] + 2;
    padded[2] = 1;
    m.row = padded[0] < 2 || padded[1] < 2 ? 0 : flow4d__count(padded, 1, 5 * sizeof(uint32_t));
    if (m.row == 0) {
        return flow4d__fail(&h, FLOW4D_LOG_SIZE, "a slice with a border");
    }
    if (smoothing) {
        smooth = flow4d__smoothed(&h, volume, smoothing);
        if (!smooth) {
            return flow4d__fail(&h, FLOW4D_LOG_MEMORY, "the smoothed volume");
        }
    }
    m.volume = volume;
    m.smooth = smooth;
    m.iso = iso;
    m.inside_is_less = settings && settings->inside_is_less;
    m.mirrored = flow4d__determinant(volume->to_world) < 0.0;
    m.width = padded[0];
    result = flow4d__march_memory(&h, &m, &made);
    flow4d__delete(&h.allocator, smooth, flow4d__count(volume->size, 1, sizeof(float)),
                   sizeof(float));
    if (result == LAO_OK) {
        *surface = made;
    }
    return result;
}

void flow4d_surface_free(flow4d_surface *surface) {
    if (!surface || !surface->allocator.release) {
        return;
    }
    flow4d__delete(&surface->allocator, surface->vertices, surface->vertex_count,
                   3 * sizeof(float));
    flow4d__delete(&surface->allocator, surface->triangles, surface->triangle_count,
                   3 * sizeof(uint32_t));
    memset(surface, 0, sizeof *surface);
}

#ifdef __cplusplus
}
#endif

#endif /* FLOW4D_IMPLEMENTATION_DONE */
#endif /* FLOW4D_IMPLEMENTATION */
