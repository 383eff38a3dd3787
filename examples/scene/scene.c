#include "scene.h"
#include "scene_build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* name, lines, width, has times and speeds, view direction, up, help */
#define SCENES(X)                                                                                  \
    X(aorta, 3000, 0.5f, true, 0.66f, -0.74f, -0.12f, 0, 0, 1,                                     \
      "pathlines of one heart beat in an aortic arch with a vortex in its bulge (3000 lines)")     \
    X(crossing, 2000, 0.5f, false, 0.5f, -0.75f, -0.4f, 0, 0, 1,                                   \
      "three kinds of nerve fibre bundles crossing at angles (2000 lines)")                        \
    X(helix, 1500, 0.4f, false, -0.35f, -0.75f, -0.55f, 1, 0, 1.1f,                                \
      "two strands winding around and through a straight bundle (1500 lines)")                     \
    X(ball, 1000, 0.5f, false, 0.4f, -0.85f, -0.35f, 0, 0, 1,                                      \
      "smooth random curves filling a ball (1000 lines)")                                          \
    X(bundle, 5000, 0.4f, false, 0.6f, -0.7f, -0.4f, 0, 0, 1,                                      \
      "24 fanning bundles, every line exactly 100 points, for benchmarks (5000 lines)")            \
    X(flow, 4000, 0.45f, true, 0.8f, -0.6f, -0.06f, 0, 0, 1,                                       \
      "pathlines through a phantom of 4D flow: a jet, a vortex in a bulge, a helix (4000 lines)")  \
    X(aneurysm, 400, 0.2f, true, 0.25f, 0.96f, -0.12f, 0, 0, 1,                                    \
      "pathlines through a cerebral artery and its aneurysm, in which a vortex turns (400 lines)") \
    X(stress, 24, 1.0f, false, 0, 0, -1, 0, 1, 0,                                                  \
      "degenerate lines: empty, one point, repeats, loops, hairpins, end-on (24 lines)")

const char *const *scene_names(uint32_t *count) {
#define X_NAME(name, lines, width, timed, dx, dy, dz, ux, uy, uz, help) #name,
    static const char *const names[] = {SCENES(X_NAME)};
    *count = (uint32_t)(sizeof names / sizeof *names);
    return names;
}

typedef struct scene_row {
    const char *name, *help;
    uint32_t lines;
    float width;
    bool timed;
    float direction[3], up[3];
    void (*build)(scene_builder *builder, uint32_t count);
} scene_row;

static const scene_row *find_scene(const char *name) {
#define X_ROW(name, lines, width, timed, dx, dy, dz, ux, uy, uz, help)                             \
    {#name, help, lines, width, timed, {dx, dy, dz}, {ux, uy, uz}, scene_build_##name},
    static const scene_row rows[] = {SCENES(X_ROW)};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (name && strcmp(rows[i].name, name) == 0)
            return &rows[i];
    }
    return NULL;
}

const char *scene_help(const char *name) {
    const scene_row *row = find_scene(name);
    return row ? row->help : NULL;
}

bool scene_make(const char *name, uint32_t line_count, uint32_t seed, scene_lines *out) {
    const scene_row *row = find_scene(name);
    if (!row)
        return false;
    scene_builder builder;
    memset(&builder, 0, sizeof builder);
    builder.seed = seed;
    row->build(&builder, line_count ? line_count : row->lines);
    if (builder.failed) {
        scene_free(&builder.lines);
        return false;
    }
    if (!row->timed) {
        free(builder.lines.times);
        free(builder.lines.values);
        builder.lines.times = builder.lines.values = NULL;
    }
    *out = builder.lines;
    out->width = row->width;
    memcpy(out->view_direction, row->direction, sizeof row->direction);
    memcpy(out->up, row->up, sizeof row->up);
    return true;
}

void scene_free(scene_lines *lines) {
    free(lines->offsets);
    free(lines->points);
    free(lines->times);
    free(lines->values);
    memset(lines, 0, sizeof *lines);
}

/* ---- the builder ------------------------------------------------------------------------ */

/* Grows an array to `room` items; keeps it when that fails. */
static void *grow(scene_builder *builder, void *array, size_t item, uint32_t room) {
    void *grown = builder->failed ? NULL : realloc(array, item * room);
    if (!grown)
        builder->failed = true;
    return grown ? grown : array;
}

static uint32_t more(scene_builder *builder, uint32_t room) {
    if (room > UINT32_MAX / 2)
        builder->failed = true;
    return room ? room * 2 : 1024;
}

void scene_point(scene_builder *builder, vec3 position, double time, double value) {
    scene_lines *lines = &builder->lines;
    if (lines->point_count == builder->point_room) {
        uint32_t room = more(builder, builder->point_room);
        lines->points = grow(builder, lines->points, 3 * sizeof(float), room);
        lines->times = grow(builder, lines->times, sizeof(float), room);
        lines->values = grow(builder, lines->values, sizeof(float), room);
        if (!builder->failed)
            builder->point_room = room;
    }
    if (builder->failed)
        return;
    float *point = &lines->points[3 * (size_t)lines->point_count];
    point[0] = (float)position.x;
    point[1] = (float)position.y;
    point[2] = (float)position.z;
    lines->times[lines->point_count] = (float)time;
    lines->values[lines->point_count] = (float)value;
    lines->point_count++;
}

void scene_end_line(scene_builder *builder) {
    scene_lines *lines = &builder->lines;
    if (lines->line_count + 1 >= builder->line_room) { /* one more offset than lines */
        uint32_t room = more(builder, builder->line_room);
        lines->offsets = grow(builder, lines->offsets, sizeof(uint32_t), room);
        if (!builder->failed)
            builder->line_room = room;
    }
    if (builder->failed)
        return;
    if (lines->line_count == 0)
        lines->offsets[0] = 0;
    lines->offsets[++lines->line_count] = lines->point_count;
}

/* ---- random numbers --------------------------------------------------------------------- */

static uint32_t mix(uint32_t h) {
    h = (h ^ (h >> 16)) * 0x7FEB352Du;
    h = (h ^ (h >> 15)) * 0x846CA68Bu;
    return h ^ (h >> 16);
}

double scene_random(uint32_t seed, uint32_t item, uint32_t use) {
    uint32_t h = mix(mix(mix(seed + 0x9E3779B9u) ^ item) + use * 0x85EBCA6Bu);
    return ((double)h + 0.5) / 4294967296.0;
}

double scene_wave(uint32_t seed, uint32_t item, uint32_t use, double t) {
    double slow = scene_random(seed, item, 3 * use), fast = scene_random(seed, item, 3 * use + 1);
    double pace = scene_random(seed, item, 3 * use + 2);
    return 0.7 * sin(6.2831853 * ((0.6 + 0.6 * pace) * t + slow)) +
           0.3 * sin(6.2831853 * ((1.7 + 1.3 * pace) * t + fast));
}

void scene_disc(uint32_t seed, uint32_t i, uint32_t n, double *u, double *v) {
    double jitter = scene_random(seed, i, 101) - 0.5, turn = scene_random(seed, i, 102) - 0.5;
    double place = ((double)i + 0.5 + 0.8 * jitter) / (double)n;
    double radius = sqrt(place),
           angle = 2.399963229728653 * (double)i + turn / sqrt((double)i + 1.0);
    *u = radius * cos(angle);
    *v = radius * sin(angle);
}

/* ---- vectors ---------------------------------------------------------------------------- */

vec3 vec3_make(double x, double y, double z) {
    vec3 v = {x, y, z};
    return v;
}

vec3 vec3_add(vec3 a, vec3 b) {
    return vec3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}

vec3 vec3_sub(vec3 a, vec3 b) {
    return vec3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}

vec3 vec3_scale(vec3 a, double s) {
    return vec3_make(a.x * s, a.y * s, a.z * s);
}

vec3 vec3_mad(vec3 a, vec3 b, double s) {
    return vec3_make(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}

double vec3_dot(vec3 a, vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

vec3 vec3_cross(vec3 a, vec3 b) {
    return vec3_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

vec3 vec3_unit(vec3 a) {
    double length = sqrt(vec3_dot(a, a));
    return length > 0.0 ? vec3_scale(a, 1.0 / length) : vec3_make(1.0, 0.0, 0.0);
}
