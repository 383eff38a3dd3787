#include "bench_screen.h"

#include "bench_device.h"
#include "bench_modules.h"
#include "bench_scene.h"
#include "bench_host.h"
#include "scene_tree.h"
#include "sdfvessel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 4, MOST_PASSES = 64, MOST_IMAGES = 64, MOST_TIMINGS = 512, SWEEPS = 4 };

/* Seconds of processor time: what fills is measured beside others that use one thread. */
/* ---- what passes do ------------------------------------------------------------------------ */

/* Texels that a pass fetches and writes for each texel of its output, and how many of these there
 * are for a pixel: levels of a pyramid add up to 4 / 3, those above the finest to 1 / 3. */
typedef struct pass_row {
    const char *name, *step;
    double fetches, writes, texels;
} pass_row;
static const pass_row pass_rows[] = {
    {"vessel_depth", "void", 2, 1, 1},
    {"vessel_depth_up", "void", 4, 1, 1 / 3.0},
    {"vessel_fill", "void", 5, 1, 4 / 3.0},
    {"vessel_surface", "void", 16, 5, 1},
    {"vessel_place_up", "guide", 9, 2, 1 / 3.0},
    {"vessel_tensor_up", "guide", 4, 1, 1 / 3.0},
    {"vessel_guide", "guide", 12, 3, 4 / 3.0},
    {"vessel_recall", "phases", 7, 1, 1},
    {"vessel_recall_up", "phases", 19, 1, 1 / 3.0},
    {"vessel_phase", "phases", 21, 1, 4 / 3.0},
    {"vessel_sweep", "phases", 20, 1, SWEEPS * 4 / 3.0},
    {"vessel_uv", "phases", 6, 1, 1},
    {"vessel_ink", "ink", 6, 1, 1},
};
enum { PASSES = sizeof pass_rows / sizeof *pass_rows, FLOORS = 3 };
static const char *const steps[] = {"void", "guide", "phases", "ink"};
enum { STEPS = sizeof steps / sizeof *steps };
/* Passes that do nothing but fetch and write as many texels: what all others are held against. */
static const pass_row floor_rows[FLOORS] = {{"floor_fetch", NULL, 1, 1, 1},
                                            {"floor_fetch8", NULL, 8, 1, 1},
                                            {"floor_write4", NULL, 1, 4, 1}};

/* ---- the module, with floors behind its rows ------------------------------------------------ */

typedef struct floored {
    lao_module module;
    lao_pass_row passes[MOST_PASSES];
    lao_image_row images[MOST_IMAGES];
} floored;

static const lao_module *floored_make(floored *f) {
    static const char *const names[4] = {"floor_0", "floor_1", "floor_2", "floor_3"};
    f->module = *sdv_module();
    memcpy(f->passes, f->module.passes, f->module.pass_count * sizeof *f->passes);
    memcpy(f->images, f->module.images, f->module.image_count * sizeof *f->images);
    for (int i = 0; i < 4; i++) {
        lao_image_row *row = &f->images[f->module.image_count++];
        memset(row, 0, sizeof *row);
        row->name = names[i];
        row->format = LAO_FORMAT_RGBA32F;
        row->size = LAO_SIZE_FULL;
        row->flags = LAO_IMAGE_HISTORY; /* or the graph is refused, as nothing reads it */
    }
    for (int i = 0; i < FLOORS; i++) {
        lao_pass_row *row = &f->passes[f->module.pass_count++];
        memset(row, 0, sizeof *row);
        row->name = row->shader = floor_rows[i].name;
        row->stage = LAO_STAGE_SHADE;
        row->scope = LAO_SCOPE_PER_SET;
        row->reads[0].image = "vessel_position";
        for (int k = 0; k < floor_rows[i].writes; k++) {
            row->writes[k].image = names[k];
            row->writes[k].load = LAO_LOAD_DISCARD;
        }
    }
    f->module.passes = f->passes;
    f->module.images = f->images;
    f->module.shaders = bench_floor_shaders(&f->module.shader_count);
    return &f->module;
}

/* ---- the scene ------------------------------------------------------------------------------- */

typedef struct subject {
    sdv_tree tree;
    sdv_grid grid;
    sdv_object object;
} subject;

static bool subject_make(subject *s, uint32_t nodes) {
    sdv_tree_desc desc;
    sdv_grid_desc grid;
    scene_tree scene;
    memset(&desc, 0, sizeof desc);
    memset(&grid, 0, sizeof grid);
    if (!scene_tree_make(nodes, 0, &scene))
        return bench_fail("no memory for a tree");
    sdv_segment *segments = calloc(nodes, sizeof *segments);
    for (uint32_t i = 0; segments && i < scene.segment_count; i++) {
        segments[i].parent = scene.segments[2 * (size_t)i];
        segments[i].child = scene.segments[2 * (size_t)i + 1];
    }
    desc.node_count = scene.node_count;
    desc.positions = scene.positions;
    desc.radii = scene.radii;
    desc.segment_count = scene.segment_count;
    desc.segments = segments;
    grid.resolution = 64;
    bool ok = segments && sdv_tree_build(NULL, &desc, &s->tree) == LAO_OK &&
              sdv_grid_build(NULL, &s->tree, &grid, &s->grid) == LAO_OK &&
              sdv_object_make(NULL, &s->grid, NULL, &s->object) == LAO_OK;
    free(segments);
    scene_tree_free(&scene);
    return ok || bench_fail("no memory for a tree");
}

static void subject_free(subject *s) {
    sdv_object_free(&s->object);
    sdv_grid_free(&s->grid);
    sdv_tree_free(&s->tree);
}

/* ---- frames ---------------------------------------------------------------------------------- */

typedef struct screen_case {
    bench_device *device;
    lao_context *context;
    lao_view view;
    lao_object handle;
    uint32_t size;
    double passes[PASSES], floors[FLOORS]; /* ms, the least of all rounds */
} screen_case;

static double sum_of(const lao_timing *rows, uint32_t count, const char *name) {
    size_t length = strlen(name);
    double sum = 0;
    for (uint32_t i = 0; i < count && i < MOST_TIMINGS; i++) {
        const char *pass = rows[i].pass; /* "vessel_fill_top" counts as "vessel_fill" */
        if (strncmp(pass, name, length) == 0 &&
            (pass[length] == '\0' || strcmp(pass + length, "_top") == 0))
            sum += rows[i].milliseconds;
    }
    return sum;
}

/* Turns by a degree a frame, so that phases are recalled as in L19's Table 1. */
static bool draw(screen_case *c, int round) {
    static lao_timing rows[MOST_TIMINGS];
    const double angle = 0.75 + 0.0175 * round, centre[3] = {0, 0, 0};
    const camera_pose pose = {
        {-260 * sin(angle), 260 * cos(angle), 140}, {0, 0, 0}, {0, 0, 1}, 36, 0};
    sdv_settings vessel;
    lao_settings lines;
    lao_frame frame;
    lao_set set;
    uint32_t count = MOST_TIMINGS;
    double ms;
    memset(&vessel, 0, sizeof vessel);
    memset(&lines, 0, sizeof lines);
    memset(&set, 0, sizeof set);
    memset(&frame, 0, sizeof frame);
    vessel.parameterization = 2;
    vessel.style = SDV_STYLE_HATCH;
    vessel.ssp_recycle = 3; /* as measured by L19 */
    vessel.ssp_sweeps = SWEEPS;
    vessel.field_occlusion = 0;
    vessel.set = SDV_SET(ssp_recycle) | SDV_SET(field_occlusion);
    lines.supersampling = 1;
    set.object = c->handle;
    set.settings = &lines;
    const void *settings[1] = {&vessel};
    set.module_settings = settings;
    camera_matrices(&pose, 1, centre, 130, true, frame.camera.view, frame.camera.projection);
    frame.camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    frame.sphere[3] = 130;
    frame.sets = &set;
    frame.set_count = 1;
    frame.flags = LAO_FRAME_TIMINGS;
    frame.view = c->view;
    if (!bench_device_frame(c->device, c->context, &frame, &ms) ||
        lao_timings(c->context, c->view, rows, &count) != LAO_OK)
        return false;
    for (int i = 0; i < PASSES; i++)
        c->passes[i] = fmin(c->passes[i], sum_of(rows, count, pass_rows[i].name));
    for (int i = 0; i < FLOORS; i++)
        c->floors[i] = fmin(c->floors[i], sum_of(rows, count, floor_rows[i].name));
    return true;
}

/* What a pass costs that only moves its texels: a texel's own time and that of each fetch and
 * write, from the three floors of the same frames. */
static double floor_of(const screen_case *c, const pass_row *row) {
    double fetch = fmax(c->floors[1] - c->floors[0], 0) / 7;
    double write = fmax(c->floors[2] - c->floors[0], 0) / 3;
    double own = fmax(c->floors[0] - fetch - write, 0);
    return row->texels * (own + row->fetches * fetch + row->writes * write);
}

static void add_case(cJSON *document, const screen_case *c) {
    cJSON *step_list = cJSON_GetObjectItemCaseSensitive(document, "steps");
    cJSON *pass_list = cJSON_GetObjectItemCaseSensitive(document, "passes");
    double pixels = (double)c->size * c->size;
    for (int s = 0; s < STEPS; s++) {
        double ms = 0, least = 0, bytes = 0;
        for (int i = 0; i < PASSES; i++) {
            const pass_row *row = &pass_rows[i];
            if (strcmp(row->step, steps[s]) != 0)
                continue;
            ms += c->passes[i];
            least += floor_of(c, row);
            bytes += 16 * row->texels * (row->fetches + row->writes);
            cJSON *json = cJSON_CreateObject();
            cJSON_AddStringToObject(json, "backend", c->device->backend);
            cJSON_AddNumberToObject(json, "size", c->size);
            cJSON_AddStringToObject(json, "pass", row->name);
            cJSON_AddNumberToObject(json, "ms", c->passes[i]);
            cJSON_AddNumberToObject(json, "over_floor", c->passes[i] / floor_of(c, row));
            cJSON_AddItemToArray(pass_list, json);
        }
        cJSON *json = cJSON_CreateObject();
        cJSON_AddStringToObject(json, "backend", c->device->backend);
        cJSON_AddNumberToObject(json, "size", c->size);
        cJSON_AddStringToObject(json, "step", steps[s]);
        cJSON_AddNumberToObject(json, "ms", ms);
        cJSON_AddNumberToObject(json, "ns_per_pixel", 1e6 * ms / pixels);
        cJSON_AddNumberToObject(json, "bytes_per_pixel", bytes);
        cJSON_AddNumberToObject(json, "over_floor", ms / least);
        cJSON_AddItemToArray(step_list, json);
    }
}

static bool measure_size(screen_case *c, cJSON *document) {
    lao_view_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.width = desc.height = c->size;
    bool ok = lao_view_create(c->context, &desc, &c->view) == LAO_OK;
    for (int round = 0; ok && round < ROUNDS + 2; round++) {
        for (int i = 0; i < PASSES && round < 3; i++) /* the first two compile */
            c->passes[i] = INFINITY;
        for (int i = 0; i < FLOORS && round < 3; i++)
            c->floors[i] = INFINITY;
        ok = draw(c, round);
    }
    if (ok)
        add_case(document, c);
    lao_view_destroy(c->context, c->view);
    return ok;
}

static bool measure_backend(const char *backend, const subject *s, bool quick, cJSON *document) {
    static const uint32_t sizes[] = {512, 1024, 2048};
    bench_device device;
    screen_case c;
    floored module;
    memset(&c, 0, sizeof c);
    c.device = &device;
    bool ok = bench_device_open(&device, backend) &&
              bench_device_context(&device, floored_make(&module), &c.context) &&
              lao_object_create(c.context, &s->object.desc, &c.handle) == LAO_OK;
    for (int i = 0; ok && i < (quick ? 1 : 3); i++) {
        c.size = quick ? 64 : sizes[i];
        ok = measure_size(&c, document);
    }
    lao_destroy(c.context);
    bench_device_close(&device);
    return ok;
}

/* ---- pull-push beside inverse distances ------------------------------------------------------ */

/* A ring of depths with branches, in a void: what both fill. truth: what the void was cut out of.
 * Returns how many pixels it covers. */
static uint32_t draw_ring(uint32_t size, float *values, float *weights, float *truth) {
    uint32_t covered = 0;
    for (uint32_t i = 0; i < size * size; i++) {
        uint32_t row = i / size;
        double x = 2.0 * (i % size) / size - 1, y = 2.0 * row / size - 1;
        double r = hypot(x, y), a = atan2(y, x);
        bool on = fabs(r - 0.5 - 0.1 * sin(5 * a)) < 0.03 || (fabs(sin(4 * a)) < 0.04 && r > 0.4);
        truth[i] = (float)(100 + 40 * x + 20 * sin(3 * a));
        values[i] = on ? truth[i] : 0;
        weights[i] = on ? 1 : 0;
        covered += on;
    }
    return covered;
}

/* Inverse distances as in void space surfaces (KHR18): each empty pixel from all pixels of the
 * contour, with weights 1 / distance^4. */
static void fill_by_distance(uint32_t size, float *values, const float *weights,
                             uint32_t *contour) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < size * size; i++) {
        uint32_t x = i % size, y = i / size;
        bool inner = x > 0 && y > 0 && x + 1 < size && y + 1 < size && weights[i - 1] > 0 &&
                     weights[i + 1] > 0 && weights[i - size] > 0 && weights[i + size] > 0;
        if (weights[i] > 0 && !inner)
            contour[count++] = i;
    }
    for (uint32_t i = 0; i < size * size; i++) {
        uint32_t row = i / size;
        float sum = 0, total = 0, x = (float)(i % size), y = (float)row;
        for (uint32_t k = 0; weights[i] <= 0 && k < count; k++) {
            uint32_t from = contour[k] / size;
            float dx = x - (float)(contour[k] % size), dy = y - (float)from;
            float d2 = dx * dx + dy * dy, w = 1 / (d2 * d2);
            sum += w * values[contour[k]];
            total += w;
        }
        if (weights[i] <= 0)
            values[i] = total > 0 ? sum / total : 0;
    }
}

/* Root mean square over what was empty. */
static double fill_error(uint32_t size, const float *filled, const float *covered,
                         const float *truth) {
    double sum = 0, count = 0;
    for (uint32_t i = 0; i < size * size; i++) {
        double off = (double)filled[i] - (double)truth[i];
        sum += covered[i] > 0 ? 0 : off * off;
        count += covered[i] > 0 ? 0 : 1;
    }
    return sqrt(sum / fmax(count, 1));
}

/* Picture, covered pixels (1) and truth, one behind the other, for bench/fill_peer.py. */
static bool export_fill(uint32_t size, float *planes, const char *folder) {
    char path[1024];
    size_t pixels = (size_t)size * size;
    int length = snprintf(path, sizeof path, "%s/fill_%u.f32", folder, size);
    FILE *file = length > 0 && (size_t)length < sizeof path ? fopen(path, "wb") : NULL;
    if (!file)
        return bench_fail("%s: cannot be written", folder);
    draw_ring(size, planes, planes + pixels, planes + 2 * pixels);
    bool ok = fwrite(planes, sizeof *planes, 3 * pixels, file) == 3 * pixels;
    ok &= fclose(file) == 0;
    return ok || bench_fail("%s: cannot be written", path);
}

static bool measure_fill(uint32_t size, const char *folder, cJSON *list) {
    size_t pixels = (size_t)size * size;
    float *memory = calloc(5 * pixels, sizeof *memory);
    uint32_t *contour = calloc(pixels, sizeof *contour);
    bool ok = memory && contour;
    double seconds[2] = {INFINITY, INFINITY}, apart = 0;
    float *pushed = memory, *weights = memory + pixels, *near = memory + 2 * pixels;
    float *truth = memory + 3 * pixels, *mask = memory + 4 * pixels;
    uint32_t covered = 0;
    if (!ok)
        bench_fail("no memory");
    for (int round = 0; ok && round < 3; round++) {
        sdv_pull_push_desc desc;
        memset(&desc, 0, sizeof desc);
        desc.width = desc.height = size;
        desc.channels = 1;
        desc.values = pushed;
        desc.weights = weights;
        desc.push = SDV_PUSH_SPLINE;
        desc.exponent = 25;
        double start;
        if (round == 0) { /* takes long, and a long time needs no second one */
            covered = draw_ring(size, near, mask, truth);
            start = bench_now();
            fill_by_distance(size, near, mask, contour);
            seconds[1] = bench_now() - start;
        }
        draw_ring(size, pushed, weights, truth);
        start = bench_now();
        ok = sdv_pull_push(NULL, &desc, NULL) == LAO_OK;
        seconds[0] = fmin(seconds[0], bench_now() - start);
    }
    for (size_t i = 0; ok && i < pixels; i++)
        apart += fabs((double)pushed[i] - (double)near[i]) / (double)pixels;
    cJSON *row = cJSON_CreateObject();
    cJSON_AddItemToArray(list, row);
    cJSON_AddNumberToObject(row, "size", size);
    cJSON_AddNumberToObject(row, "covered", covered / (double)pixels);
    cJSON_AddNumberToObject(row, "pull_push_ms", 1e3 * seconds[0]);
    cJSON_AddNumberToObject(row, "distances_ms", 1e3 * seconds[1]);
    cJSON_AddNumberToObject(row, "mean_difference", apart);
    if (ok) {
        cJSON_AddNumberToObject(row, "pull_push_error", fill_error(size, pushed, mask, truth));
        cJSON_AddNumberToObject(row, "distances_error", fill_error(size, near, mask, truth));
    }
    ok = ok && (!folder || export_fill(size, memory, folder));
    free(memory);
    free(contour);
    return ok;
}

/* ---- report -----------------------------------------------------------------------------------
 */

bool bench_screen_run(cJSON *document, bool quick, const char *folder) {
    static const char *const backends[] = {"gl", "vk"};
    subject s;
    memset(&s, 0, sizeof s);
    cJSON_AddArrayToObject(document, "steps");
    cJSON_AddArrayToObject(document, "passes");
    cJSON *fills = cJSON_AddArrayToObject(document, "fills");
    bool ok = subject_make(&s, quick ? 300 : 3000);
    for (uint32_t size = quick ? 64 : 128; ok && size <= (quick ? 64u : 512u); size *= 2)
        ok = measure_fill(size, folder, fills);
    for (int b = 0; ok && !folder && b < 2; b++)
        ok = (b == 1 && !bench_floors_have_words()) ||
             measure_backend(backends[b], &s, quick, document);
    subject_free(&s);
    return ok;
}

static double number(const cJSON *row, const char *name) {
    return cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(row, name));
}
static const char *text(const cJSON *row, const char *name) {
    return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, name));
}
/* Milliseconds of a step; 0: it was not measured. */
static double step_ms(const cJSON *list, const char *backend, const char *step, double size) {
    const cJSON *row;
    cJSON_ArrayForEach(row, list) {
        if (strcmp(text(row, "backend"), backend) == 0 && strcmp(text(row, "step"), step) == 0 &&
            number(row, "size") == size)
            return number(row, "ms");
    }
    return 0;
}

/* L19, Table 1 (GTX 1080): void 0.34 and 1.15 ms, parameterization 4.36 and 15.09 ms. */
static void print_table1(const cJSON *list, const char *backend) {
    double sheet[2], phases[2];
    for (int i = 0; i < 2; i++) {
        double size = i ? 1024 : 512;
        sheet[i] = step_ms(list, backend, "void", size);
        phases[i] = step_ms(list, backend, "guide", size) + step_ms(list, backend, "phases", size);
    }
    if (sheet[0] > 0 && sheet[1] > 0)
        printf("%s: 1024 over 512: void %.2f (L19 3.38), guide and phases %.2f (3.46); guide and "
               "phases over void %.1f and %.1f (12.8 and 13.1)\n",
               backend, sheet[1] / sheet[0], phases[1] / phases[0], phases[0] / sheet[0],
               phases[1] / sheet[1]);
}

void bench_screen_print(const cJSON *document) {
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(document, "steps"), *row;
    printf("step     backend  size        ms  ns a pixel  bytes a pixel  over the floor\n");
    cJSON_ArrayForEach(row, list) printf(
        "%-8s %7s %5.0f %9.2f %11.1f %14.0f %15.2f\n", text(row, "step"), text(row, "backend"),
        number(row, "size"), number(row, "ms"), number(row, "ns_per_pixel"),
        number(row, "bytes_per_pixel"), number(row, "over_floor"));
    print_table1(list, "gl");
    print_table1(list, "vk");
    printf("\npass              backend  size        ms  over the floor\n");
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(document, "passes"))
        printf("%-17s %7s %5.0f %9.2f %15.2f\n", text(row, "pass"), text(row, "backend"),
               number(row, "size"), number(row, "ms"), number(row, "over_floor"));
    printf(
        "\nfill (1 thread): size  covered  pull-push ms (error)  inverse distances ms (error)\n");
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(document, "fills"))
        printf("%21.0f %8.2f %13.2f (%5.2f) %21.1f (%5.2f)\n", number(row, "size"),
               number(row, "covered"), number(row, "pull_push_ms"), number(row, "pull_push_error"),
               number(row, "distances_ms"), number(row, "distances_error"));
}
