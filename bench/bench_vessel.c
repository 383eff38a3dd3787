#include "bench_vessel.h"

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

enum { ROUNDS = 3, TREES = 4, PASSES = 160, MOST_ROWS = 64 };

/* ---- trees -------------------------------------------------------------------------------- */

static bool make_tree(uint32_t nodes, sdv_tree *out) {
    sdv_tree_desc desc;
    scene_tree scene;
    memset(&desc, 0, sizeof desc);
    memset(&scene, 0, sizeof scene);
    if (!scene_tree_make(nodes, 0, &scene))
        return bench_fail("no memory for a tree of %u nodes", nodes);
    sdv_segment *segments = calloc(nodes, sizeof *segments);
    for (uint32_t i = 0; segments && i < scene.segment_count; i++) {
        segments[i].parent = scene.segments[2 * (size_t)i];
        segments[i].child = scene.segments[2 * (size_t)i + 1];
    }
    desc.node_count = nodes;
    desc.positions = scene.positions;
    desc.radii = scene.radii;
    desc.segment_count = scene.segment_count;
    desc.segments = segments;
    lao_result result = segments ? sdv_tree_build(NULL, &desc, out) : LAO_ERROR_OUT_OF_MEMORY;
    free(segments);
    scene_tree_free(&scene);
    return result == LAO_OK || bench_fail("sdv_tree_build: %s", lao_result_text(result));
}

/* ---- fields ------------------------------------------------------------------------------- */

static bool make_grid(const sdv_tree *tree, uint32_t resolution, bool two, sdv_grid *out) {
    sdv_host host;
    sdv_grid_desc desc;
    memset(&host, 0, sizeof host);
    memset(&desc, 0, sizeof desc);
    host.job.run = two ? bench_run_on_two : NULL;
    desc.resolution = resolution;
    lao_result result = sdv_grid_build(&host, tree, &desc, out);
    return result == LAO_OK || bench_fail("sdv_grid_build: %s", lao_result_text(result));
}

/* Seconds for the distance of every cell to all segments, from one cell in SAMPLED. */
static double brute_force(const sdv_tree *tree, uint32_t resolution) {
    enum { SAMPLED = 997 };
    sdv_grid grid;
    volatile float sum = 0;
    if (!make_grid(tree, resolution, true, &grid))
        return NAN;
    double start = bench_now();
    for (uint32_t i = 0; i < grid.cell_count; i += SAMPLED) {
        uint32_t x = i % grid.size[0], y = i / grid.size[0] % grid.size[1];
        uint32_t z = i / grid.size[0] / grid.size[1];
        lao_v3 p = lao_v3_make(grid.origin.x + ((float)x + 0.5f) * grid.cell,
                               grid.origin.y + ((float)y + 0.5f) * grid.cell,
                               grid.origin.z + ((float)z + 0.5f) * grid.cell);
        sum = sum + sdv_cones_distance(grid.cones, grid.cone_count, p, NULL);
    }
    double seconds = SAMPLED * (bench_now() - start);
    sdv_grid_free(&grid);
    return seconds;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A node goes up by a hundredth of the extent and comes back: the less of both counts. */
static bool move_node(sdv_tree *tree, uint32_t node, sdv_grid *grid, double *seconds) {
    float by = 0.01f * grid->cell * (float)grid->size[2];
    for (int i = 0; i < 2; i++) {
        tree->nodes[node].z += i ? -by : by;
        double start = bench_now();
        if (sdv_grid_update(NULL, tree, &node, 1, grid) != LAO_OK)
            return bench_fail("sdv_grid_update");
        *seconds = grid->rebuilt ? *seconds : fmin(*seconds, bench_now() - start);
    }
    return true;
}

/* One node after the other, the root first: the median and the worst, on one thread. */
static bool measure_moves(cJSON *row, sdv_tree *tree, uint32_t resolution) {
    enum { MOVES = 200 };
    double seconds[MOVES];
    uint32_t step = 1 + (tree->node_count - 1) / MOVES, count = 0;
    sdv_grid grid;
    if (!make_grid(tree, resolution, false, &grid))
        return false;
    bool ok = true;
    for (uint32_t node = 0; ok && node < tree->node_count; node += step) {
        seconds[count] = INFINITY;
        ok = move_node(tree, node, &grid, &seconds[count]);
        count += isfinite(seconds[count]) ? 1 : 0; /* not those that leave the box */
    }
    sdv_grid_free(&grid);
    if (!ok || !count)
        return ok || bench_fail("all moves leave the box");
    qsort(seconds, count, sizeof *seconds, by_value);
    cJSON_AddNumberToObject(row, "moves", count);
    cJSON_AddNumberToObject(row, "ms_move", 1e3 * seconds[count / 2]);
    cJSON_AddNumberToObject(row, "ms_move_worst", 1e3 * seconds[count - 1]);
    return true;
}

static bool measure_field(cJSON *list, sdv_tree *tree, uint32_t resolution) {
    double seconds[2] = {INFINITY, INFINITY};
    cJSON *row = cJSON_CreateObject();
    cJSON_AddItemToArray(list, row);
    for (int round = 0; round < 2 * ROUNDS;
         round++) { /* in turn: what disturbs one disturbs both */
        sdv_grid grid;
        double start = bench_now();
        if (!make_grid(tree, resolution, round % 2 != 0, &grid))
            return false;
        seconds[round % 2] = fmin(seconds[round % 2], bench_now() - start);
        if (round == 0) {
            cJSON_AddNumberToObject(row, "segments", tree->segment_count);
            cJSON_AddNumberToObject(row, "resolution", resolution);
            cJSON_AddNumberToObject(row, "cells", grid.cell_count);
            cJSON_AddNumberToObject(row, "listed", grid.id_count);
            cJSON_AddNumberToObject(row, "cell_bytes",
                                    20.125 + 4.0 * grid.id_count / grid.cell_count);
            cJSON_AddNumberToObject(row, "segment_bytes", 40);
        }
        sdv_grid_free(&grid);
    }
    cJSON_AddNumberToObject(row, "ms_brute_1", 1e3 * brute_force(tree, resolution));
    cJSON_AddNumberToObject(row, "ms_1", 1e3 * seconds[0]);
    cJSON_AddNumberToObject(row, "ms_2", 1e3 * seconds[1]);
    return measure_moves(row, tree, resolution);
}

/* ---- the module, with a floor behind its rows --------------------------------------------- */

typedef struct floored {
    lao_module module;
    lao_pass_row passes[MOST_ROWS];
    lao_image_row images[MOST_ROWS];
} floored;

/* A row as the trace's, with the same outputs: kept for a next frame, else the graph is refused. */
static const lao_module *floored_make(floored *f) {
    static const char *const names[3] = {"floor_position", "floor_normal", "floor_ray"};
    f->module = *sdv_module();
    memcpy(f->passes, f->module.passes, f->module.pass_count * sizeof *f->passes);
    memcpy(f->images, f->module.images, f->module.image_count * sizeof *f->images);
    lao_pass_row *row = &f->passes[f->module.pass_count++];
    memset(row, 0, sizeof *row);
    row->name = row->shader = "floor_ball";
    row->stage = LAO_STAGE_DRAW;
    row->scope = LAO_SCOPE_PER_SET;
    for (int i = 0; i < 3; i++) {
        lao_image_row *image = &f->images[f->module.image_count++];
        memset(image, 0, sizeof *image);
        image->name = names[i];
        image->format = LAO_FORMAT_RGBA32F;
        image->size = LAO_SIZE_FULL;
        image->flags = LAO_IMAGE_HISTORY;
        row->writes[i].image = names[i];
        row->writes[i].load = LAO_LOAD_DISCARD;
    }
    f->module.passes = f->passes;
    f->module.images = f->images;
    f->module.shaders = bench_floor_shaders(&f->module.shader_count);
    return &f->module;
}

/* ---- rays --------------------------------------------------------------------------------- */

typedef struct subject {
    uint32_t segments;
    sdv_tree tree;
    sdv_grid grid;
    sdv_object object;
    lao_object handle;
} subject;

/* The same rays for all: a view of the embedded organ from a corner. */
static void make_frame(lao_frame *frame, lao_set *set) {
    const camera_pose pose = {{-190, 180, 140}, {0, 0, 0}, {0, 0, 1}, 36, 0};
    const double centre[3] = {0, 0, 0};
    memset(frame, 0, sizeof *frame);
    camera_matrices(&pose, 1, centre, 130, true, frame->camera.view, frame->camera.projection);
    frame->camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    frame->sphere[3] = 130;
    frame->sets = set;
    frame->set_count = 1;
    frame->flags = LAO_FRAME_TIMINGS;
}

static bool read_steps(lao_context *context, lao_view view, double *steps, double *hits) {
    lao_read_info info;
    memset(&info, 0, sizeof info);
    if (lao_read(context, view, "vessel_ray", 0, NULL, 0, &info) != LAO_OK)
        return false;
    size_t count = (size_t)info.width * info.height, room = count * info.channels;
    float *data = malloc(room * sizeof *data);
    bool ok = data && lao_read(context, view, "vessel_ray", 0, data, room, NULL) == LAO_OK;
    *steps = *hits = 0;
    for (size_t i = 0; ok && i < count; i++) {
        *steps += (double)data[i * info.channels + 2] / (double)count;
        *hits += (data[i * info.channels] > 0 ? 1.0 : 0.0) / (double)count;
    }
    free(data);
    return ok;
}

static double pass_time(const lao_timing *rows, uint32_t count, const char *name) {
    for (uint32_t i = 0; i < count && i < PASSES; i++) {
        if (strcmp(rows[i].pass, name) == 0)
            return rows[i].milliseconds;
    }
    return 0;
}

/* One kind of rays at one size, on all subjects. */
typedef struct ray_case {
    bench_device *device;
    lao_context *context;
    lao_view view;
    uint32_t size;
    sdv_settings settings;
    double floor[TREES], trace[TREES], shade[TREES], steps[TREES], hits[TREES];
} ray_case;

static bool draw_subject(ray_case *c, const subject *s, uint32_t index) {
    const void *settings[1] = {&c->settings};
    lao_settings lines;
    lao_timing rows[PASSES];
    uint32_t count = PASSES;
    lao_frame frame;
    lao_set set;
    double ms;
    memset(&set, 0, sizeof set);
    memset(&lines, 0, sizeof lines);
    lines.supersampling = 1;
    set.object = s->handle;
    set.settings = &lines;
    set.module_settings = settings;
    make_frame(&frame, &set);
    frame.view = c->view;
    if (!bench_device_frame(c->device, c->context, &frame, &ms) ||
        lao_timings(c->context, c->view, rows, &count) != LAO_OK ||
        !read_steps(c->context, c->view, &c->steps[index], &c->hits[index]))
        return false;
    c->floor[index] = fmin(c->floor[index], pass_time(rows, count, "floor_ball"));
    c->trace[index] = fmin(c->trace[index], pass_time(rows, count, "vessel_trace"));
    c->shade[index] = fmin(c->shade[index], pass_time(rows, count, "vessel_shade"));
    return true;
}

static void add_case(cJSON *list, const ray_case *c, const subject *subjects, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "backend", c->device->backend);
        cJSON_AddNumberToObject(row, "segments", subjects[i].segments);
        cJSON_AddNumberToObject(row, "size", c->size);
        cJSON_AddStringToObject(row, "near_miss", c->settings.near_miss > 0 ? "none" : "close");
        cJSON_AddNumberToObject(row, "hits", c->hits[i]);
        cJSON_AddNumberToObject(row, "steps", c->steps[i]);
        cJSON_AddNumberToObject(row, "trace_ms", c->trace[i]);
        cJSON_AddNumberToObject(row, "shade_ms", c->shade[i]);
        cJSON_AddNumberToObject(row, "floor_ms", c->floor[i]);
        cJSON_AddNumberToObject(row, "trace_over_floor", c->trace[i] / c->floor[i]);
        cJSON_AddItemToArray(list, row);
    }
}

/* All subjects in turn, round by round; the least of all rounds but the first counts, which
 * compiles. */
static bool measure_rays(bench_device *device, lao_context *context, const subject *subjects,
                         uint32_t count, uint32_t size, float near_miss, cJSON *list) {
    ray_case c;
    lao_view_desc desc;
    memset(&c, 0, sizeof c);
    memset(&desc, 0, sizeof desc);
    c.device = device;
    c.context = context;
    c.size = desc.width = desc.height = size;
    c.settings.near_miss = near_miss;
    desc.flags = LAO_VIEW_KEEP_IMAGES;
    bool ok = lao_view_create(context, &desc, &c.view) == LAO_OK;
    int rounds = size > 512 ? 2 : 1 + ROUNDS;
    for (int round = 0; ok && round < rounds; round++) {
        for (uint32_t i = 0; ok && i < count; i++) {
            if (round < 2)
                c.floor[i] = c.trace[i] = c.shade[i] = INFINITY;
            ok = draw_subject(&c, &subjects[i], i);
        }
    }
    if (ok)
        add_case(list, &c, subjects, count);
    lao_view_destroy(context, c.view);
    return ok;
}

/* ---- fields by the device ----------------------------------------------------------------- */

/* Times of the rows that build the field, from the first to the last of them. */
static double field_time(const lao_timing *rows, uint32_t count, cJSON *passes) {
    double sum = 0;
    bool inside = false;
    for (uint32_t i = 0; i < count && i < PASSES; i++) {
        inside = inside || strcmp(rows[i].pass, "vessel_region_counts") == 0;
        if (!inside)
            continue;
        cJSON *known = cJSON_GetObjectItemCaseSensitive(passes, rows[i].pass);
        if (known)
            cJSON_SetNumberValue(known, cJSON_GetNumberValue(known) + rows[i].milliseconds);
        else
            cJSON_AddNumberToObject(passes, rows[i].pass, rows[i].milliseconds);
        sum += rows[i].milliseconds;
        if (strcmp(rows[i].pass, "vessel_grid") == 0)
            break;
    }
    return sum;
}

/* Bytes of the images of a device's field, none sharing memory with another; of a pyramid 4/3. */
static double image_bytes(const uint32_t *items) {
    const lao_module *module = sdv_module();
    double sum = 0;
    for (uint32_t i = 0; i < module->image_count; i++) {
        const lao_image_row *row = &module->images[i];
        if (row->size == LAO_SIZE_ITEMS)
            sum += (row->levels ? 4.0 / 3.0 : 1.0) * lao_format_bytes(row->format) *
                   items[row->width - 1];
    }
    return sum;
}

static bool draw_field(bench_device *device, lao_context *context, lao_view view, lao_object object,
                       lao_timing *rows, uint32_t *count) {
    const void *settings[1] = {NULL};
    lao_settings lines;
    lao_frame frame;
    lao_set set;
    double ms;
    memset(&set, 0, sizeof set);
    memset(&lines, 0, sizeof lines);
    lines.supersampling = 1;
    set.object = object;
    set.settings = &lines;
    set.module_settings = settings;
    make_frame(&frame, &set);
    frame.view = view;
    return bench_device_frame(device, context, &frame, &ms) &&
           lao_timings(context, view, rows, count) == LAO_OK;
}

/* A tree that moves: the upload of its cones, and the rows that make its field of them. */
static bool measure_device_field(bench_device *device, lao_context *context, sdv_tree *tree,
                                 uint32_t resolution, cJSON *list) {
    const lao_view_desc size = {64, 64, 0};
    lao_timing rows[PASSES];
    lao_limits limits;
    lao_object handle = {0};
    lao_view view = {0};
    sdv_grid_desc desc;
    sdv_object object;
    double upload = INFINITY, field = INFINITY;
    cJSON *row = cJSON_CreateObject(), *best = NULL;
    memset(&desc, 0, sizeof desc);
    desc.resolution = resolution;
    cJSON_AddItemToArray(list, row);
    lao_limits_get(context, &limits);
    if (sdv_object_make_tree(NULL, tree, &desc, limits.image_size, NULL, &object) != LAO_OK)
        return bench_fail("sdv_object_make_tree");
    bool ok = lao_object_create(context, &object.desc, &handle) == LAO_OK &&
              lao_view_create(context, &size, &view) == LAO_OK;
    for (int round = 0; ok && round <= ROUNDS; round++) {
        const uint32_t node = tree->node_count / 2;
        uint32_t count = PASSES;
        cJSON *passes = cJSON_CreateObject();
        double start = bench_now();
        ok = sdv_object_move(NULL, tree, &node, 1, &object) == LAO_OK &&
             lao_object_update(context, handle, &object.desc) == LAO_OK;
        upload = round > 0 ? fmin(upload, 1e3 * (bench_now() - start)) : upload;
        ok = ok && draw_field(device, context, view, handle, rows, &count);
        double ms = ok ? field_time(rows, count, passes) : 0;
        if (ok && round > 0 && ms < field) {
            field = ms;
            cJSON_Delete(best);
            best = passes;
        } else {
            cJSON_Delete(passes);
        }
    }
    cJSON_AddStringToObject(row, "backend", device->backend);
    cJSON_AddNumberToObject(row, "segments", tree->segment_count);
    cJSON_AddNumberToObject(row, "resolution", resolution);
    cJSON_AddBoolToObject(row, "on_device", object.on_device != 0);
    cJSON_AddNumberToObject(row, "cell_bytes",
                            image_bytes(object.desc.further_items) / object.grid.cell_count);
    cJSON_AddNumberToObject(row, "upload_ms", upload);
    cJSON_AddNumberToObject(row, "ms", field);
    cJSON_AddItemToObject(row, "passes", best ? best : cJSON_CreateObject());
    lao_view_destroy(context, view);
    lao_object_destroy(context, handle);
    sdv_object_free(&object);
    return ok || bench_fail("a field on the device");
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* Fields of these trees are measured, and rays through those. */
typedef struct bench_trees {
    sdv_tree fields[2];
    subject rays[TREES];
    uint32_t field_count, ray_count;
} bench_trees;

static bool trees_make(bench_trees *t, bool quick) {
    static const uint32_t fields[] = {1000, 6000}, rays[TREES] = {1000, 3000, 30000, 300000};
    const uint32_t field_count = quick ? 1 : 2, ray_count = quick ? 1 : TREES;
    t->field_count = field_count;
    t->ray_count = ray_count;
    for (uint32_t i = 0; i < field_count; i++) {
        if (!make_tree(fields[i], &t->fields[i]))
            return false;
    }
    for (uint32_t i = 0; i < ray_count; i++) {
        subject *s = &t->rays[i];
        if (!make_tree(rays[i], &s->tree) || !make_grid(&s->tree, quick ? 48 : 128, true, &s->grid))
            return false;
        s->segments = s->tree.segment_count;
        if (sdv_object_make(NULL, &s->grid, NULL, &s->object) != LAO_OK)
            return bench_fail("no memory");
    }
    return true;
}

static void trees_free(bench_trees *t) {
    for (uint32_t i = 0; i < t->field_count; i++)
        sdv_tree_free(&t->fields[i]);
    for (uint32_t i = 0; i < t->ray_count; i++) {
        sdv_object_free(&t->rays[i].object);
        sdv_grid_free(&t->rays[i].grid);
        sdv_tree_free(&t->rays[i].tree);
    }
}

static bool measure_backend(const char *backend, const lao_module *module, bench_trees *t,
                            bool quick, cJSON *fields, cJSON *rays) {
    bench_device device;
    lao_context *context = NULL;
    bool ok =
        bench_device_open(&device, backend) && bench_device_context(&device, module, &context);
    for (uint32_t i = 0; ok && i < t->field_count; i++)
        ok = measure_device_field(&device, context, &t->fields[i], 64, fields) &&
             (quick || measure_device_field(&device, context, &t->fields[i], 128, fields));
    for (uint32_t i = 0; ok && i < t->ray_count; i++)
        ok = lao_object_create(context, &t->rays[i].object.desc, &t->rays[i].handle) == LAO_OK;
    for (int k = 0; ok && k < (quick ? 1 : 2); k++) {
        uint32_t size = quick ? 128 : k == 0 ? 512 : 1024;
        ok = measure_rays(&device, context, t->rays, t->ray_count, size, SDV_NEAR_MISS_CLOSE,
                          rays) &&
             (k > 0 || measure_rays(&device, context, t->rays, t->ray_count, size,
                                    SDV_NEAR_MISS_NONE, rays));
    }
    lao_destroy(context);
    bench_device_close(&device);
    return ok;
}

bool bench_vessel_run(cJSON *document, bool quick) {
    bench_trees *trees = calloc(1, sizeof *trees);
    cJSON *fields = cJSON_AddArrayToObject(document, "fields");
    cJSON *device_fields = cJSON_AddArrayToObject(document, "device_fields");
    cJSON *rays = cJSON_AddArrayToObject(document, "rays");
    floored floor;
    const lao_module *module = floored_make(&floor);
    bool ok = trees && trees_make(trees, quick);
    if (!trees)
        bench_fail("no memory");
    for (uint32_t i = 0; ok && i < trees->field_count; i++)
        ok = measure_field(fields, &trees->fields[i], 64) &&
             (quick || measure_field(fields, &trees->fields[i], 128));
    ok = ok && measure_backend("gl", module, trees, quick, device_fields, rays) &&
         (!bench_floors_have_words() ||
          measure_backend("vk", module, trees, quick, device_fields, rays));
    if (trees)
        trees_free(trees);
    free(trees);
    return ok;
}

static double number(const cJSON *row, const char *name) {
    return cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(row, name));
}
static const char *text_of(const cJSON *row, const char *name) {
    return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, name));
}

void bench_vessel_print(const cJSON *document) {
    const cJSON *row;
    printf("field by the CPU: segments  resolution     cells    listed  bytes a cell  ms, 1 thread"
           "  2 threads  brute force, 1 thread (of a sample)  a node moves: median    worst\n");
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(document, "fields")) {
        printf("%26.0f %11.0f %9.0f %9.0f %13.1f %13.1f %10.1f %22.0f %38.2f %8.2f\n",
               number(row, "segments"), number(row, "resolution"), number(row, "cells"),
               number(row, "listed"), number(row, "cell_bytes"), number(row, "ms_1"),
               number(row, "ms_2"), number(row, "ms_brute_1"), number(row, "ms_move"),
               number(row, "ms_move_worst"));
    }
    printf("a segment takes 40 bytes\n\nfield by the device, every frame: segments  resolution  "
           "backend  bytes a cell  move and upload ms  rows ms\n");
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(document, "device_fields")) {
        printf("%42.0f %11.0f %8s %13.1f %19.1f %8.1f%s\n", number(row, "segments"),
               number(row, "resolution"), text_of(row, "backend"), number(row, "cell_bytes"),
               number(row, "upload_ms"), number(row, "ms"),
               cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(row, "on_device")) ? "" : "  (CPU)");
    }
    printf(
        "\nrays: segments  backend  size  near miss   hits  steps  trace ms  shade ms  floor ms  "
        "trace over floor (one ball, by its formula)\n");
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(document, "rays")) {
        printf("%14.0f %8s %5.0f %10s %6.2f %6.1f %9.1f %9.1f %9.1f %11.1f\n",
               number(row, "segments"), text_of(row, "backend"), number(row, "size"),
               text_of(row, "near_miss"), number(row, "hits"), number(row, "steps"),
               number(row, "trace_ms"), number(row, "shade_ms"), number(row, "floor_ms"),
               number(row, "trace_over_floor"));
    }
}
