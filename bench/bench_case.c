#include "bench_case.h"

#include "bench_device.h"
#include "bench_modules.h"
#include "bench_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* ---- numbers ------------------------------------------------------------------------------ */

enum { PASSES = 24, NAME = 24 };

typedef struct series {
    double values[BENCH_FRAMES];
    uint32_t count;
} series;

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(const series *s) {
    double sorted[BENCH_FRAMES];
    if (!s->count)
        return 0;
    memcpy(sorted, s->values, s->count * sizeof *sorted);
    qsort(sorted, s->count, sizeof *sorted, by_value);
    return 0.5 * (sorted[s->count / 2] + sorted[(s->count - 1) / 2]);
}

static double least(const series *s) {
    double value = s->count ? s->values[0] : 0;
    for (uint32_t i = 1; i < s->count; i++)
        value = s->values[i] < value ? s->values[i] : value;
    return value;
}

static void keep(series *s, double value) {
    if (s->count < BENCH_FRAMES)
        s->values[s->count++] = value;
}

/* The median of a quotient that is taken frame by frame: both numbers of a frame were measured one
 * after the other, so that a busy machine disturbs the quotient little. Below 0: there is none. */
static double quotient(const series *a, const series *b) {
    series q;
    if (!a || !b || !a->count || a->count != b->count)
        return -1;
    q.count = 0;
    for (uint32_t i = 0; i < a->count; i++) {
        if (a->values[i] > 0 && b->values[i] > 0)
            keep(&q, a->values[i] / b->values[i]);
    }
    return q.count ? median(&q) : -1;
}

static double rounded(double value) {
    return floor(value * 1e4 + 0.5) / 1e4;
}

static cJSON *add_number(cJSON *object, const char *name, double value) {
    return value < 0 ? cJSON_AddNullToObject(object, name)
                     : cJSON_AddNumberToObject(object, name, rounded(value));
}

static void add_series(cJSON *object, const char *name, const series *s) {
    cJSON *row = name ? cJSON_AddObjectToObject(object, name) : object;
    add_number(row, "median", median(s));
    add_number(row, "min", least(s));
}

/* ---- what is measured --------------------------------------------------------------------- */

typedef struct pass_time {
    char name[NAME];
    uint32_t level;
    series time;
} pass_time;

/* One preset, or the background: views in both contexts and what was measured. */
typedef struct shot {
    lao_settings settings;
    lao_view plain, floored;
    lao_set plain_set, floored_set;
    double first; /* ms of the first frame: shaders are compiled */
    series frame, sum;
    pass_time passes[PASSES];
    uint32_t pass_count;
} shot;

/* `plain` is lineao as a host has it; `floored` has the floors behind its passes, and is the one
 * that times each pass. */
typedef struct side {
    bench_device device;
    lao_context *plain, *floored;
    bench_floors floors;
    bool has_floors;
    lao_lines lines[2], nothing[2];
    shot shots[BENCH_PRESETS], backgrounds[BENCH_PRESETS];
    uint32_t covered;
} side;

typedef struct work {
    const bench_case *it;
    bench_scene scene;
    lao_frame frame;
    side sides[BENCH_BACKENDS];
} work;

static bool settings_make(const bench_case *it, const char *preset, float width,
                          lao_settings *settings) {
    const lao_module *module = lao_lines_module();
    memset(settings, 0, sizeof *settings);
    settings->width = width;
    settings->supersampling = (float)it->supersampling;
    lao_setting_parse(module, lao_setting_find(module, "halo"), it->halo, settings);
    return lao_setting_parse(module, lao_setting_find(module, "preset"), preset, settings) == 0 ||
           bench_fail("--presets: there is no preset %s", preset);
}

static void frame_make(work *w) {
    const double center[3] = {w->scene.sphere[0], w->scene.sphere[1], w->scene.sphere[2]};
    memset(&w->frame, 0, sizeof w->frame);
    camera_matrices(&w->scene.pose, (double)w->it->width / w->it->height, center,
                    w->scene.sphere[3], true, w->frame.camera.view, w->frame.camera.projection);
    w->frame.camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    w->frame.set_count = 1;
    memcpy(w->frame.sphere, w->scene.sphere, sizeof w->frame.sphere);
    for (int k = 0; k < 4; k++)
        w->frame.background[k] = 1.0f;
}

static bool lines_make(lao_context *context, const bench_scene *scene, lao_lines *lines,
                       lao_lines *nothing) {
    static const uint32_t no_offsets[1] = {0};
    lao_lines_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.offsets = no_offsets;
    if (lao_lines_create(context, &desc, nothing) != LAO_OK)
        return false;
    desc.line_count = scene->line_count;
    desc.point_count = scene->point_count;
    desc.offsets = scene->offsets;
    desc.points = scene->points;
    return lao_lines_create(context, &desc, lines) == LAO_OK;
}

static bool view_make(const bench_case *it, lao_context *context, uint32_t flags, lao_view *view) {
    lao_view_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.width = it->width;
    desc.height = it->height;
    desc.flags = flags;
    return lao_view_create(context, &desc, view) == LAO_OK;
}

/* The background is the same views without lines. Images are kept where floors are timed, so that
 * the mask can be counted afterwards. */
static bool shot_make(const bench_case *it, side *s, uint32_t preset) {
    shot *out = &s->shots[preset];
    out->plain_set.lines = s->lines[0];
    out->floored_set.lines = s->lines[1];
    out->plain_set.settings = out->floored_set.settings = &out->settings;
    if (!view_make(it, s->plain, 0, &out->plain) ||
        !view_make(it, s->floored, LAO_VIEW_KEEP_IMAGES, &out->floored))
        return false;
    s->backgrounds[preset] = *out;
    s->backgrounds[preset].plain_set.lines = s->nothing[0];
    s->backgrounds[preset].floored_set.lines = s->nothing[1];
    return true;
}

static bool side_open(const work *w, side *s, const char *backend) {
    const bench_case *it = w->it;
    if (!bench_device_open(&s->device, backend))
        return false;
    for (uint32_t p = 0; p < it->preset_count; p++) {
        if (!settings_make(it, it->presets[p], w->scene.width, &s->shots[p].settings))
            return false;
    }
    s->has_floors = strcmp(backend, "vk") != 0 || bench_floors_have_words();
    const lao_module *module =
        s->has_floors ? bench_floors_make(&s->floors, &s->shots[0].settings) : NULL;
    if (!bench_device_context(&s->device, NULL, &s->plain) ||
        !bench_device_context(&s->device, module, &s->floored) ||
        !lines_make(s->plain, &w->scene, &s->lines[0], &s->nothing[0]) ||
        !lines_make(s->floored, &w->scene, &s->lines[1], &s->nothing[1]))
        return false;
    for (uint32_t p = 0; p < it->preset_count; p++) {
        if (!shot_make(it, s, p))
            return false;
    }
    return true;
}

static void work_close(work *w) {
    for (uint32_t b = 0; b < w->it->backend_count; b++) {
        lao_destroy(w->sides[b].plain);
        lao_destroy(w->sides[b].floored);
        bench_device_close(&w->sides[b].device);
    }
    bench_scene_release(&w->scene);
    free(w);
}

static work *work_open(const bench_case *it) {
    work *w = calloc(1, sizeof *w);
    if (!w) {
        bench_fail("no memory");
        return NULL;
    }
    w->it = it;
    bool ok = bench_scene_open(&w->scene, it->path, it->line_count,
                               (double)it->width / (double)it->height);
    if (ok)
        frame_make(w);
    for (uint32_t b = 0; ok && b < it->backend_count; b++)
        ok = side_open(w, &w->sides[b], it->backends[b]);
    if (!ok) {
        work_close(w);
        return NULL;
    }
    return w;
}

/* ---- measuring ---------------------------------------------------------------------------- */

static bool is_floor(const char *pass) {
    return strncmp(pass, "floor_", 6) == 0;
}

static bool passes_keep(side *s, shot *it) {
    lao_timing rows[PASSES];
    uint32_t count = PASSES;
    double sum = 0;
    if (lao_timings(s->floored, it->floored, rows, &count) != LAO_OK)
        return false;
    if (count > PASSES)
        return bench_fail("the frame graph has more than %d steps", (int)PASSES);
    for (uint32_t i = 0; i < count; i++) {
        if (!is_floor(rows[i].pass))
            sum += rows[i].milliseconds;
        strncpy(it->passes[i].name, rows[i].pass, NAME - 1);
        it->passes[i].level = rows[i].level;
        keep(&it->passes[i].time, rows[i].milliseconds);
    }
    it->pass_count = count;
    keep(&it->sum, sum);
    return true;
}

/* A whole frame without timings, then one with. */
static bool shot_run(work *w, side *s, shot *it, uint32_t round) {
    lao_frame frame = w->frame;
    double time;
    frame.view = it->plain;
    frame.sets = &it->plain_set;
    if (!bench_device_frame(&s->device, s->plain, &frame, &time))
        return false;
    if (round == 0)
        it->first = time;
    if (round >= BENCH_WARM_UP)
        keep(&it->frame, time);
    frame.view = it->floored;
    frame.sets = &it->floored_set;
    frame.flags = LAO_FRAME_TIMINGS;
    if (!bench_device_frame(&s->device, s->floored, &frame, &time))
        return false;
    return round < BENCH_WARM_UP || passes_keep(s, it);
}

/* Everything in turn, so that a slow moment of the machine falls on all. */
static bool measure(work *w) {
    const bench_case *it = w->it;
    for (uint32_t round = 0; round < it->frames + BENCH_WARM_UP; round++) {
        for (uint32_t p = 0; p < it->preset_count; p++) {
            for (uint32_t b = 0; b < it->backend_count; b++) {
                if (!shot_run(w, &w->sides[b], &w->sides[b].shots[p], round) ||
                    !shot_run(w, &w->sides[b], &w->sides[b].backgrounds[p], round))
                    return false;
            }
        }
    }
    return true;
}

static bool covered_count(const work *w, side *s) {
    const shot *it = &s->shots[0];
    lao_frame frame = w->frame;
    lao_read_info info;
    double time;
    frame.view = it->floored;
    frame.sets = &it->floored_set;
    if (!bench_device_frame(&s->device, s->floored, &frame, &time) ||
        lao_read_raw(s->floored, it->floored, "color", 0, NULL, 0, &info) != LAO_OK)
        return false;
    size_t count = (size_t)info.width * info.height;
    uint8_t *texels = malloc(4 * count);
    if (!texels)
        return bench_fail("no memory");
    bool ok = lao_read_raw(s->floored, it->floored, "color", 0, texels, 4 * count, NULL) == LAO_OK;
    for (size_t i = 0; ok && i < count; i++)
        s->covered += texels[4 * i + 3] >= 128;
    free(texels);
    return ok;
}

/* ---- telling ------------------------------------------------------------------------------ */

/* What drew the lines: its rows, and those that find what is hidden. */
static series lines_sum(const shot *it) {
    series sum = {{0}, 0};
    for (uint32_t i = 0; i < it->pass_count; i++) {
        const series *pass = &it->passes[i].time;
        if (strncmp(it->passes[i].name, "lines", 5) != 0 &&
            strncmp(it->passes[i].name, "far", 3) != 0)
            continue;
        for (uint32_t k = 0; k < pass->count; k++)
            sum.values[k] += pass->values[k];
        sum.count = pass->count;
    }
    return sum;
}

static const series *pass_find(const shot *it, const char *name) {
    for (uint32_t i = 0; i < it->pass_count; i++) {
        if (strcmp(it->passes[i].name, name) == 0)
            return &it->passes[i].time;
    }
    return NULL;
}

/* What the occlusion costs on a covered pixel and on a background pixel, ns; below 0: not known. A
 * frame with lines takes covered * C + (pixels - covered) * B, one without them pixels * B: least
 * times, because noise grows in the difference. */
typedef struct pixel_cost {
    double covered, background;
} pixel_cost;

static pixel_cost occlusion_cost(const side *s, uint32_t preset, uint32_t pixels) {
    const series *with = pass_find(&s->shots[preset], "occlusion");
    const series *without = pass_find(&s->backgrounds[preset], "occlusion");
    pixel_cost cost = {-1, -1};
    if (!with || !without || !s->covered)
        return cost;
    cost.background = 1e6 * least(without) / pixels;
    cost.covered = (1e6 * least(with) - cost.background * (pixels - s->covered)) / s->covered;
    return cost;
}

/* A floor of taps costs the same on every pixel. */
static double floor_cost(const shot *it, const char *pass, uint32_t pixels) {
    const series *s = pass_find(it, pass);
    return s ? 1e6 * least(s) / pixels : -1;
}

static double over(double a, double b) {
    return a >= 0 && b > 0 ? a / b : -1;
}

static void shot_tell(const side *s, uint32_t preset, uint32_t pixels, cJSON *out) {
    const shot *it = &s->shots[preset];
    pixel_cost cost = occlusion_cost(s, preset, pixels);
    double taps = floor_cost(it, "floor_taps", pixels);
    const series lines = lines_sum(it);
    add_number(out, "first_frame_ms", it->first);
    add_series(out, "frame_ms", &it->frame);
    add_series(out, "pass_sum_ms", &it->sum);
    cJSON *passes = cJSON_AddArrayToObject(out, "passes");
    for (uint32_t i = 0; i < it->pass_count; i++) {
        cJSON *row = cJSON_CreateObject();
        cJSON_AddItemToArray(passes, row);
        cJSON_AddStringToObject(row, "pass", it->passes[i].name);
        cJSON_AddNumberToObject(row, "level", it->passes[i].level);
        add_series(row, NULL, &it->passes[i].time);
    }
    add_number(out, "lines_over_floor", quotient(&lines, pass_find(it, "floor_lines")));
    add_number(out, "occlusion_over_floor", over(cost.covered, taps));
    add_number(out, "occlusion_pass_over_floor_pass",
               quotient(pass_find(it, "occlusion"), pass_find(it, "floor_taps")));
    add_number(out, "occlusion_ns_per_covered_pixel", cost.covered);
    add_number(out, "floor_ns_per_pixel", taps);
    cJSON *background = cJSON_AddObjectToObject(out, "background");
    add_series(background, "frame_ms", &s->backgrounds[preset].frame);
    add_number(background, "occlusion_ns_per_pixel", cost.background);
    add_number(background, "occlusion_over_covered", over(cost.background, cost.covered));
}

static const shot *shot_find(const bench_case *it, const side *s, const char *preset) {
    for (uint32_t p = 0; p < it->preset_count; p++) {
        if (strcmp(it->presets[p], preset) == 0)
            return &s->shots[p];
    }
    return NULL;
}

static double preset_quotient(const bench_case *it, const side *s, const char *a, const char *b) {
    const shot *x = shot_find(it, s, a), *y = shot_find(it, s, b);
    return x && y ? quotient(&x->frame, &y->frame) : -1;
}

static void side_tell(const bench_case *it, const side *s, cJSON *out) {
    uint32_t pixels = it->width * it->height * it->supersampling * it->supersampling;
    cJSON_AddStringToObject(out, "device", bench_device_name(&s->device));
    cJSON_AddBoolToObject(out, "floors", s->has_floors);
    cJSON_AddNumberToObject(out, "covered_pixels", s->covered);
    cJSON *presets = cJSON_AddObjectToObject(out, "presets");
    for (uint32_t p = 0; p < it->preset_count; p++)
        shot_tell(s, p, pixels, cJSON_AddObjectToObject(presets, it->presets[p]));
    add_number(out, "anisotropic_over_classic", preset_quotient(it, s, "default", "classic"));
}

static const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static cJSON *work_tell(const work *w) {
    const bench_case *it = w->it;
    cJSON *out = cJSON_CreateObject();
    cJSON_AddStringToObject(out, "scene", it->path ? base_name(it->path) : "bundle");
    cJSON_AddNumberToObject(out, "lines", w->scene.line_count);
    cJSON_AddNumberToObject(out, "points", w->scene.point_count);
    cJSON_AddNumberToObject(out, "supersampling", it->supersampling);
    cJSON_AddNumberToObject(out, "width", it->width * it->supersampling);
    cJSON_AddNumberToObject(out, "height", it->height * it->supersampling);
    cJSON *backends = cJSON_AddObjectToObject(out, "backends");
    for (uint32_t b = 0; b < it->backend_count; b++)
        side_tell(it, &w->sides[b], cJSON_AddObjectToObject(backends, it->backends[b]));
    cJSON *quotients = cJSON_AddObjectToObject(out, "gl_over_vk");
    for (uint32_t p = 0; p < it->preset_count; p++)
        add_number(quotients, it->presets[p],
                   it->backend_count == 2
                       ? quotient(&w->sides[0].shots[p].frame, &w->sides[1].shots[p].frame)
                       : -1);
    return out;
}

cJSON *bench_case_run(const bench_case *it) {
    cJSON *out = NULL;
    work *w = work_open(it);
    if (!w)
        return NULL;
    bool ok = measure(w);
    for (uint32_t b = 0; ok && b < it->backend_count; b++)
        ok = covered_count(w, &w->sides[b]);
    if (ok)
        out = work_tell(w);
    work_close(w);
    return out;
}

/* ---- memory ------------------------------------------------------------------------------- */

/* A host's process: lines are let go as soon as they are uploaded. */
static bool memory_run(work *w, side *s, const char *backend) {
    shot *it = &s->shots[0];
    double time;
    if (!settings_make(w->it, w->it->presets[0], w->scene.width, &it->settings) ||
        !bench_device_open(&s->device, backend) ||
        !bench_device_context(&s->device, NULL, &s->plain) ||
        !lines_make(s->plain, &w->scene, &s->lines[0], &s->nothing[0]) ||
        !view_make(w->it, s->plain, 0, &it->plain))
        return false;
    bench_scene_release(&w->scene);
    it->plain_set.lines = s->lines[0];
    it->plain_set.settings = &it->settings;
    w->frame.view = it->plain;
    w->frame.sets = &it->plain_set;
    for (int i = 0; i < 3; i++) {
        if (!bench_device_frame(&s->device, s->plain, &w->frame, &time))
            return false;
    }
    return true;
}

cJSON *bench_case_memory(const bench_case *it) {
    bench_case nobody = *it;
    struct rusage usage;
    cJSON *out = NULL;
    nobody.backend_count = 0;
    work *w = work_open(&nobody);
    if (!w)
        return NULL;
    nobody.backend_count = 1; /* closed with the rest */
    if (memory_run(w, &w->sides[0], it->backends[0]) && getrusage(RUSAGE_SELF, &usage) == 0)
        out = cJSON_CreateNumber(rounded((double)usage.ru_maxrss / 1024.0));
    work_close(w);
    return out;
}
