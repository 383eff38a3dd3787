#include "bench_flow.h"

#include "bench_scene.h"
#include "bench_host.h"
#include "flow_phantom.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 3 };

/* ---- an allocator that counts ---------------------------------------------------------------- */

typedef struct flow_memory {
    size_t live, peak;
} flow_memory;

static void *flow_allocate(void *user, size_t size) {
    flow_memory *memory = user;
    void *block = malloc(size);
    memory->live += block ? size : 0;
    memory->peak = memory->live > memory->peak ? memory->live : memory->peak;
    return block;
}

static void flow_release(void *user, void *block, size_t size) {
    ((flow_memory *)user)->live -= size;
    free(block);
}

/* ---- measuring ------------------------------------------------------------------------------ */

typedef struct flow_row {
    const char *source; /* "grid": a measurement's voxels; "function": formulas */
    const char *method;
    uint32_t threads, points;
    double seconds;      /* the least of all rounds */
    size_t result, peak; /* bytes */
} flow_row;

static bool measure(flow_row *row, const flow4d_field *field, uint32_t line_count) {
    flow_memory memory = {0, 0};
    flow4d_host host;
    flow4d_trace_settings settings;
    flow4d_lines lines;
    memset(&host, 0, sizeof host);
    memset(&settings, 0, sizeof settings);
    host.allocator.allocate = flow_allocate;
    host.allocator.release = flow_release;
    host.allocator.user = &memory;
    host.job.run = row->threads == 2 ? bench_run_on_two : NULL;
    settings.line_count = line_count;
    settings.method = strcmp(row->method, "rk4") == 0 ? FLOW4D_RK4 : FLOW4D_DOPRI;
    double start = bench_now();
    lao_result result = flow4d_trace(&host, field, &settings, &lines);
    double seconds = bench_now() - start;
    if (result != LAO_OK)
        return bench_fail("flow4d_trace: %s", lao_result_text(result));
    row->points = lines.point_count;
    row->result = memory.live;
    row->peak = memory.peak;
    row->seconds = row->seconds > 0 && row->seconds < seconds ? row->seconds : seconds;
    flow4d_lines_free(&lines);
    return true;
}

static void add_row(cJSON *rows, const flow_row *row, uint32_t line_count) {
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "field", row->source);
    cJSON_AddStringToObject(item, "method", row->method);
    cJSON_AddNumberToObject(item, "threads", row->threads);
    cJSON_AddNumberToObject(item, "lines", line_count);
    cJSON_AddNumberToObject(item, "points", row->points);
    cJSON_AddNumberToObject(item, "seconds", row->seconds);
    cJSON_AddNumberToObject(item, "points_per_second", row->points / row->seconds);
    cJSON_AddNumberToObject(item, "result_mb", (double)row->result / 1e6);
    cJSON_AddNumberToObject(item, "peak_mb", (double)row->peak / 1e6);
    cJSON_AddItemToArray(rows, item);
}

bool bench_flow_run(cJSON *document, uint32_t line_count) {
    flow_row rows[] = {{"grid", "rk4", 1, 0, 0, 0, 0},     {"grid", "rk4", 2, 0, 0, 0, 0},
                       {"grid", "dopri", 1, 0, 0, 0, 0},   {"grid", "dopri", 2, 0, 0, 0, 0},
                       {"function", "rk4", 1, 0, 0, 0, 0}, {"function", "rk4", 2, 0, 0, 0, 0}};
    flow4d_field function, grid;
    bool ok = true;
    flow_phantom_field(&function);
    if (!flow_phantom_grid(NULL, 0, &grid))
        return bench_fail("no memory for the phantom's grid");
    for (int round = 0; round < ROUNDS; round++) { /* in turn: what disturbs one disturbs all */
        for (size_t i = 0; ok && i < sizeof rows / sizeof *rows; i++)
            ok = measure(&rows[i], rows[i].source[0] == 'g' ? &grid : &function, line_count);
    }
    flow_phantom_grid_free(&grid);
    cJSON *list = cJSON_AddArrayToObject(document, "flow");
    for (size_t i = 0; ok && i < sizeof rows / sizeof *rows; i++)
        add_row(list, &rows[i], line_count);
    return ok;
}

void bench_flow_print(const cJSON *document) {
    const cJSON *row;
    printf("field     method  threads   lines    points  seconds  points/s  result MB  peak MB\n");
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(document, "flow")) {
        double n[7];
        static const char *const names[7] = {"threads",           "lines",     "points", "seconds",
                                             "points_per_second", "result_mb", "peak_mb"};
        for (int i = 0; i < 7; i++)
            n[i] = cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(row, names[i]));
        printf("%-9s %-7s %7.0f %7.0f %9.0f %8.2f %9.3g %10.1f %8.1f\n",
               cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, "field")),
               cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, "method")), n[0], n[1],
               n[2], n[3], n[4], n[5], n[6]);
    }
}
