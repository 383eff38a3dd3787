#include "bench_report.h"

#include <stdio.h>
#include <string.h>

/* name in the document, most that it may be */
typedef struct target {
    const char *name;
    double most;
} target;

static const target preset_targets[] = {{"lines_over_floor", 1.5}, {"occlusion_over_floor", 1.5}};
static const target backend_targets[] = {{"anisotropic_over_classic", 1.05}, {"peak_mb", 500}};
/* a background pixel next to a covered one: "near zero" */
static const target table1_targets[] = {{"trail_over_full", 0.2}};
static const target background_targets[] = {{"occlusion_over_covered", 0.1}};

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const cJSON *get(const cJSON *object, const char *name) {
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static double number(const cJSON *object, const char *name) {
    const cJSON *item = get(object, name);
    return cJSON_IsNumber(item) ? item->valuedouble : -1;
}

static const char *text(const cJSON *object, const char *name) {
    const char *value = cJSON_GetStringValue(get(object, name));
    return value ? value : "";
}

/* ---- targets ------------------------------------------------------------------------------ */

static void declare(cJSON *targets, const target *rows, size_t count) {
    for (size_t i = 0; i < count; i++)
        cJSON_AddNumberToObject(targets, rows[i].name, rows[i].most);
}

static void judge(cJSON *missed, const cJSON *scene, const char *where, const char *preset,
                  const cJSON *object, const target *rows, size_t count) {
    char line[256];
    for (size_t i = 0; i < count; i++) {
        double value = number(object, rows[i].name);
        if (value <= rows[i].most)
            continue;
        snprintf(line, sizeof line, "%s, %.0f lines, %.0fx%.0f, %s%s%s: %s is %.3g, not %.3g",
                 text(scene, "scene"), number(scene, "lines"), number(scene, "width"),
                 number(scene, "height"), where, *preset ? " " : "", preset, rows[i].name, value,
                 rows[i].most);
        cJSON_AddItemToArray(missed, cJSON_CreateString(line));
    }
}

void bench_report_judge(cJSON *document) {
    cJSON *targets = cJSON_AddObjectToObject(document, "targets");
    cJSON *missed = cJSON_AddArrayToObject(document, "missed");
    const cJSON *scene, *backend, *preset;
    char line[128];
    cJSON_ArrayForEach(backend, get(document, "table1")) {
        double value = number(backend, table1_targets[0].name);
        snprintf(line, sizeof line, "table 1, %s: %s is %.3g, not %.3g", backend->string,
                 table1_targets[0].name, value, table1_targets[0].most);
        if (value > table1_targets[0].most)
            cJSON_AddItemToArray(missed, cJSON_CreateString(line));
    }
    declare(targets, table1_targets, COUNT(table1_targets));
    declare(targets, preset_targets, COUNT(preset_targets));
    declare(targets, backend_targets, COUNT(backend_targets));
    declare(targets, background_targets, COUNT(background_targets));
    cJSON_ArrayForEach(scene, get(document, "scenes")) {
        cJSON_ArrayForEach(backend, get(scene, "backends")) {
            cJSON_ArrayForEach(preset, get(backend, "presets")) {
                judge(missed, scene, backend->string, preset->string, preset, preset_targets,
                      COUNT(preset_targets));
                judge(missed, scene, backend->string, preset->string, get(preset, "background"),
                      background_targets, COUNT(background_targets));
            }
            judge(missed, scene, backend->string, "", backend, backend_targets,
                  COUNT(backend_targets));
        }
    }
}

/* ---- table -------------------------------------------------------------------------------- */

static void cell(const cJSON *object, const char *name) {
    double value = number(object, name);
    if (value < 0)
        printf("%12s", "-");
    else
        printf("%12.3f", value);
}

/* One line: a label, then median and least of each backend. */
static void print_times(const char *label, const cJSON *const *rows, int count) {
    printf("  %-28s", label);
    for (int i = 0; i < count; i++) {
        cell(rows[i], "median");
        cell(rows[i], "min");
    }
    printf("\n");
}

static void print_values(const char *name, const cJSON *const *objects, int count) {
    printf("  %-28s", name);
    for (int i = 0; i < count; i++) {
        cell(objects[i], name);
        printf("%12s", "");
    }
    printf("\n");
}

enum { SIDES = 4 };

static void print_passes(const cJSON *const *presets, int count) {
    int rows = cJSON_GetArraySize(get(presets[0], "passes"));
    for (int r = 0; r < rows; r++) {
        const cJSON *cells[SIDES] = {NULL};
        const cJSON *first = cJSON_GetArrayItem(get(presets[0], "passes"), r);
        char label[64];
        snprintf(label, sizeof label, "  %s %.0f", text(first, "pass"), number(first, "level"));
        if (number(first, "level") <= 0)
            label[strlen(label) - 2] = 0;
        for (int i = 0; i < count; i++)
            cells[i] = cJSON_GetArrayItem(get(presets[i], "passes"), r);
        print_times(label, cells, count);
    }
}

static void print_preset(const char *name, const cJSON *const *presets, int count) {
    static const char *const values[] = {"lines_over_floor", "occlusion_over_floor",
                                         "occlusion_ns_per_covered_pixel"};
    const cJSON *cells[SIDES] = {NULL};
    for (int i = 0; i < count; i++)
        cells[i] = get(presets[i], "frame_ms");
    print_times(name, cells, count);
    print_passes(presets, count);
    for (int i = 0; i < count; i++)
        cells[i] = get(get(presets[i], "background"), "frame_ms");
    print_times("  frame of background alone", cells, count);
    for (size_t v = 0; v < COUNT(values); v++)
        print_values(values[v], presets, count);
    for (int i = 0; i < count; i++)
        cells[i] = get(presets[i], "background");
    print_values("occlusion_over_covered", cells, count);
}

static void print_scene(const cJSON *scene) {
    const cJSON *backends[SIDES] = {NULL}, *cells[SIDES] = {NULL}, *backend, *preset;
    int count = 0;
    cJSON_ArrayForEach(backend, get(scene, "backends")) {
        if (count < SIDES)
            backends[count++] = backend;
    }
    printf("\n%s, %.0f lines, %.0f points, %.0fx%.0f (supersampling %.0f), %.0f pixels covered\n",
           text(scene, "scene"), number(scene, "lines"), number(scene, "points"),
           number(scene, "width"), number(scene, "height"), number(scene, "supersampling"),
           count ? number(backends[0], "covered_pixels") : 0);
    printf("  %-28s", "ms");
    for (int i = 0; i < count; i++)
        printf("%9s %s%12s", "median", backends[i]->string, "min");
    printf("\n");
    cJSON_ArrayForEach(preset, get(count ? backends[0] : NULL, "presets")) {
        for (int i = 0; i < count; i++)
            cells[i] = get(get(backends[i], "presets"), preset->string);
        print_preset(preset->string, cells, count);
    }
    print_values("anisotropic_over_classic", backends, count);
    print_values("peak_mb", backends, count);
    cJSON_ArrayForEach(preset, get(scene, "gl_over_vk")) {
        if (cJSON_IsNumber(preset))
            printf("  gl_over_vk, %-16s%12.3f\n", preset->string, preset->valuedouble);
    }
}

static void print_table1(const cJSON *backend) {
    const cJSON *row;
    printf("\ntable 1, %s, %.0f lines, %.0f points, %.0fx%.0f (supersampling %.0f)\n",
           backend->string, number(backend, "lines"), number(backend, "points"),
           number(backend, "width"), number(backend, "height"), number(backend, "supersampling"));
    printf("  %-10s%-10s%-14s%12s%12s%12s%12s\n", "animation", "halo", "occlusion", "median ms",
           "min ms", "over first", "paper");
    cJSON_ArrayForEach(row, get(backend, "rows")) {
        printf("  %-10s%-10s%-14s", text(row, "animation"), text(row, "halo"),
               text(row, "occlusion"));
        cell(get(row, "frame_ms"), "median");
        cell(get(row, "frame_ms"), "min");
        cell(row, "over_first");
        cell(row, "paper_over_first");
        printf("\n");
    }
    print_values("trail_over_full", &backend, 1);
}

void bench_report_print(const cJSON *document) {
    const cJSON *item;
    printf("%.0f frames after %.0f to warm up; whole frames from call to fence, without timings\n",
           number(document, "frames"), number(document, "warm_up"));
    cJSON_ArrayForEach(item, get(document, "notes")) {
        printf("note: %s\n", item->valuestring);
    }
    cJSON_ArrayForEach(item, get(document, "scenes")) {
        print_scene(item);
    }
    cJSON_ArrayForEach(item, get(document, "table1")) {
        print_table1(item);
    }
    printf("\n");
    cJSON_ArrayForEach(item, get(document, "missed")) {
        printf("missed: %s\n", item->valuestring);
    }
    if (cJSON_GetArraySize(get(document, "missed")) == 0)
        printf("no target was missed\n");
}
