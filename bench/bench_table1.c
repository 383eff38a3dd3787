#include "bench_table1.h"

#include "bench_device.h"
#include "bench_scene.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS = 8 };

/* Frames per second as printed; of animated rows the first number, at systole. */
static const struct {
    int animated, halo, anisotropic;
    double fps;
} rows[ROWS] = {
    {0, LAO_HALO_UNIFORM, 0, 64}, {0, LAO_HALO_UNIFORM, 1, 63},  {0, LAO_HALO_DEPTH, 0, 60},
    {0, LAO_HALO_DEPTH, 1, 60},   {1, LAO_HALO_UNIFORM, 0, 175}, {1, LAO_HALO_UNIFORM, 1, 170},
    {1, LAO_HALO_DEPTH, 0, 175},  {1, LAO_HALO_DEPTH, 1, 165},
};

typedef struct table {
    const bench_case *it;
    bench_scene scene;
    bench_device device;
    lao_context *context;
    lao_lines lines;
    lao_frame frame;
    double times[ROWS][BENCH_FRAMES]; /* ms */
} table;

static bool table_open(table *t) {
    const bench_case *it = t->it;
    lao_lines_desc lines;
    lao_view_desc view;
    if (!bench_scene_timed(&t->scene, "aorta", it->line_count, (double)it->width / it->height) ||
        !bench_device_open(&t->device, it->backends[0]) ||
        !bench_device_context(&t->device, NULL, &t->context))
        return false;
    const double center[3] = {t->scene.sphere[0], t->scene.sphere[1], t->scene.sphere[2]};
    memset(&lines, 0, sizeof lines);
    lines.line_count = t->scene.line_count;
    lines.point_count = t->scene.point_count;
    lines.offsets = t->scene.offsets;
    lines.points = t->scene.points;
    lines.times = t->scene.times;
    memset(&view, 0, sizeof view);
    view.width = it->width;
    view.height = it->height;
    camera_matrices(&t->scene.pose, (double)it->width / it->height, center, t->scene.sphere[3],
                    true, t->frame.camera.view, t->frame.camera.projection);
    t->frame.camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    t->frame.set_count = 1;
    memcpy(t->frame.sphere, t->scene.sphere, sizeof t->frame.sphere);
    t->frame.background[3] = 1;
    return lao_lines_create(t->context, &lines, &t->lines) == LAO_OK &&
           lao_view_create(t->context, &view, &t->frame.view) == LAO_OK;
}

static lao_settings settings_of(const table *t, int row) {
    lao_settings s;
    memset(&s, 0, sizeof s);
    s.preset = rows[row].anisotropic ? 0.0f : 1.0f; /* default, classic */
    s.width = t->scene.width;
    s.supersampling = (float)t->it->supersampling;
    s.halo = (float)rows[row].halo;
    s.trail = rows[row].animated ? (float)LAO_TRAIL_TAPER : 0.0f;
    s.period = 833;
    return s;
}

/* A first frame makes images and programs, the second counts. */
static bool row_run(table *t, int row, double *milliseconds) {
    lao_settings settings = settings_of(t, row);
    lao_frame frame = t->frame;
    lao_set set;
    memset(&set, 0, sizeof set);
    set.lines = t->lines;
    set.settings = &settings;
    frame.sets = &set;
    for (int i = 0; i < 2; i++) {
        frame.time = 300 + 8.33f * (float)i;
        if (!bench_device_frame(&t->device, t->context, &frame, milliseconds))
            return false;
    }
    return true;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(const double *values, uint32_t count) {
    double sorted[BENCH_FRAMES];
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, by_value);
    return 0.5 * (sorted[count / 2] + sorted[(count - 1) / 2]);
}

/* Of each round, because its rows were measured one after the other. */
static double quotient(const table *t, int a, int b) {
    double q[BENCH_FRAMES] = {0};
    for (uint32_t i = 0; i < t->it->frames; i++)
        q[i] = t->times[a][i] / t->times[b][i];
    return median(q, t->it->frames);
}

static cJSON *row_tell(const table *t, int row) {
    double least = t->times[row][0];
    cJSON *out = cJSON_CreateObject(), *time = cJSON_CreateObject();
    for (uint32_t i = 1; i < t->it->frames; i++)
        least = t->times[row][i] < least ? t->times[row][i] : least;
    cJSON_AddStringToObject(out, "animation", rows[row].animated ? "on" : "off");
    cJSON_AddStringToObject(out, "halo", rows[row].halo == LAO_HALO_DEPTH ? "depth" : "uniform");
    cJSON_AddStringToObject(out, "occlusion", rows[row].anisotropic ? "anisotropic" : "classic");
    cJSON_AddItemToObject(out, "frame_ms", time);
    cJSON_AddNumberToObject(time, "median", median(t->times[row], t->it->frames));
    cJSON_AddNumberToObject(time, "min", least);
    cJSON_AddNumberToObject(out, "over_first", quotient(t, row, 0));
    cJSON_AddNumberToObject(out, "paper_over_first", rows[0].fps / rows[row].fps);
    return out;
}

static cJSON *table_tell(const table *t) {
    const bench_case *it = t->it;
    cJSON *out = cJSON_CreateObject();
    cJSON_AddStringToObject(out, "device", bench_device_name(&t->device));
    cJSON_AddNumberToObject(out, "lines", t->scene.line_count);
    cJSON_AddNumberToObject(out, "points", t->scene.point_count);
    cJSON_AddNumberToObject(out, "supersampling", it->supersampling);
    cJSON_AddNumberToObject(out, "width", it->width * it->supersampling);
    cJSON_AddNumberToObject(out, "height", it->height * it->supersampling);
    cJSON *list = cJSON_AddArrayToObject(out, "rows");
    for (int row = 0; row < ROWS; row++)
        cJSON_AddItemToArray(list, row_tell(t, row));
    /* our usual frame: depth halos, anisotropic */
    cJSON_AddNumberToObject(out, "trail_over_full", quotient(t, 7, 3));
    return out;
}

cJSON *bench_table1_run(const bench_case *it) {
    cJSON *out = NULL;
    table *t = calloc(1, sizeof *t);
    if (!t) {
        bench_fail("no memory");
        return NULL;
    }
    t->it = it;
    bool ok = table_open(t);
    for (uint32_t round = 0; ok && round < it->frames; round++) {
        for (int row = 0; ok && row < ROWS; row++)
            ok = row_run(t, row, &t->times[row][round]);
    }
    if (ok)
        out = table_tell(t);
    lao_destroy(t->context);
    bench_device_close(&t->device);
    bench_scene_release(&t->scene);
    free(t);
    return out;
}
