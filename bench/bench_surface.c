#include "bench_surface.h"

#include "bench_device.h"
#include "bench_modules.h"
#include "bench_scene.h"
#include "bench_host.h"
#include "scene_surface.h"
#include "vesselsurface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 5, MOST_ROWS = 128, MOST_PASSES = 32 };

/* ---- meshes ------------------------------------------------------------------------------- */

/* The embedded aneurysm, of which finer ones are subdivided. */
typedef struct mesh_row {
    uint32_t triangles; /* about */
    double spacing;
    uint32_t levels;
} mesh_row;
static const mesh_row mesh_rows[] = {{10000, 0.565, 0}, {100000, 0.357, 1}, {1000000, 0.452, 3}};

static bool make_mesh(const mesh_row *row, vsf_mesh *out) {
    scene_surface surface;
    vsf_mesh_desc desc;
    vsf_mesh coarse;
    memset(&desc, 0, sizeof desc);
    if (!scene_surface_make("aneurysm", row->spacing, &surface))
        return bench_fail("no memory for a mesh");
    desc.vertex_count = surface.vertex_count;
    desc.positions = surface.positions;
    desc.triangle_count = surface.triangle_count;
    desc.triangles = surface.triangles;
    lao_result result = vsf_mesh_build(NULL, &desc, row->levels ? &coarse : out);
    scene_surface_free(&surface);
    if (result == LAO_OK && row->levels) {
        result = vsf_mesh_subdivide(NULL, &coarse, row->levels, out);
        vsf_mesh_free(&coarse);
    }
    return result == LAO_OK || bench_fail("the mesh: %s", lao_result_text(result));
}

/* ---- the module, with a floor behind its rows --------------------------------------------- */

typedef struct floored {
    lao_module module;
    lao_pass_row passes[MOST_PASSES];
    lao_image_row images[MOST_PASSES];
} floored;

static void add_floor_image(floored *f, const char *name, lao_format format) {
    lao_image_row *row = &f->images[f->module.image_count++];
    memset(row, 0, sizeof *row);
    row->name = name;
    row->format = format;
    row->size = LAO_SIZE_FULL;
    row->flags = format == LAO_FORMAT_D32F ? 0 : LAO_IMAGE_HISTORY; /* or the graph is refused */
    row->clear[0] = format == LAO_FORMAT_D32F ? 1.0f : 0.0f;
}

static const lao_module *floored_make(floored *f) {
    f->module = *vsf_module();
    memcpy(f->passes, f->module.passes, f->module.pass_count * sizeof *f->passes);
    memcpy(f->images, f->module.images, f->module.image_count * sizeof *f->images);
    lao_pass_row *row = &f->passes[f->module.pass_count++];
    *row = f->module.passes[0]; /* back faces: the same reads */
    row->name = row->shader = "floor_gouraud";
    row->cull = LAO_CULL_BACK;
    row->writes[0].image = "floor_color";
    row->writes[0].load = LAO_LOAD_CLEAR;
    row->writes[1].image = "floor_z";
    row->writes[1].load = LAO_LOAD_CLEAR;
    add_floor_image(f, "floor_color", LAO_FORMAT_RGBA8);
    add_floor_image(f, "floor_z", LAO_FORMAT_D32F);
    f->module.passes = f->passes;
    f->module.images = f->images;
    f->module.shaders = bench_floor_shaders(&f->module.shader_count);
    return &f->module;
}

/* ---- frames ------------------------------------------------------------------------------- */

/* What is told: the sum of the rows of a name. */
static const char *const told[] = {"floor_gouraud", "surface_measure", "surface_back",
                                   "surface_front", "surface_peel",    "left",
                                   "surface_over",  "shadow",          "focus"};
enum { TOLD = sizeof told / sizeof *told };

typedef struct surface_case {
    bench_device *device;
    lao_context *context;
    lao_view view;
    vsf_object *object;
    lao_object handle;
    vsf_settings settings;
    lao_settings lines;
    double frame, update, passes[TOLD]; /* ms, the least of all rounds */
} surface_case;

static bool tells(const char *pass, const char *name) {
    if (strcmp(name, "shadow") == 0)
        return strstr(pass, "shadow") != NULL;
    if (strcmp(name, "focus") == 0)
        return strncmp(pass, "focus", 5) == 0;
    if (strcmp(name, "left") == 0) /* whether there is anything left to peel */
        return strncmp(pass, "surface_tiles", 13) == 0 || strcmp(pass, "surface_left") == 0;
    return strcmp(pass, name) == 0;
}

/* One frame of an animation: new distances, then all passes; with timings each is finished. */
static bool draw(surface_case *c, uint32_t flags, bool counts) {
    const camera_pose pose = {{-12, -75, 8}, {-2, 0, 1}, {0, 0, 1}, 30, 0};
    const double centre[3] = {-2, 0, 1};
    const void *settings[1] = {&c->settings};
    lao_object_desc update = c->object->desc;
    lao_timing rows[MOST_ROWS];
    uint32_t count = MOST_ROWS;
    lao_frame frame;
    lao_set set;
    double ms, start = bench_now();
    memset(&frame, 0, sizeof frame);
    memset(&set, 0, sizeof set);
    update.buffers = &c->object->list[5];
    update.buffer_count = 1;
    if (lao_object_update(c->context, c->handle, &update) != LAO_OK)
        return false;
    double uploaded = 1e3 * (bench_now() - start);
    set.object = c->handle;
    set.settings = &c->lines;
    set.module_settings = settings;
    camera_matrices(&pose, 853.0 / 917, centre, 30, true, frame.camera.view,
                    frame.camera.projection);
    frame.camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    frame.view = c->view;
    frame.sets = &set;
    frame.set_count = 1;
    frame.flags = flags;
    if (!bench_device_frame(c->device, c->context, &frame, &ms))
        return false;
    if (counts && !flags) {
        c->frame = fmin(c->frame, ms + uploaded);
        c->update = fmin(c->update, uploaded);
    }
    if (!flags || !counts)
        return true;
    if (lao_timings(c->context, c->view, rows, &count) != LAO_OK)
        return false;
    for (int t = 0; t < TOLD; t++) {
        double sum = 0;
        for (uint32_t i = 0; i < count && i < MOST_ROWS; i++)
            sum += tells(rows[i].pass, told[t]) ? rows[i].milliseconds : 0;
        c->passes[t] = fmin(c->passes[t], sum);
    }
    return true;
}

/* Frames with and without timings in turn, so that what disturbs one disturbs both. */
static bool measure(surface_case *c, uint32_t width, uint32_t height, uint32_t supersampling) {
    lao_view_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.width = width;
    desc.height = height;
    c->lines.occlusion = 0;
    c->lines.set = LAO_SET(occlusion);
    c->lines.supersampling = (float)supersampling;
    c->frame = c->update = INFINITY;
    for (int t = 0; t < TOLD; t++)
        c->passes[t] = INFINITY;
    bool ok = lao_view_create(c->context, &desc, &c->view) == LAO_OK;
    for (int round = 0; ok && round <= ROUNDS; round++)
        ok = draw(c, 0, round > 0) && draw(c, LAO_FRAME_TIMINGS, round > 0);
    lao_view_destroy(c->context, c->view);
    return ok;
}

static void add_row(cJSON *list, const surface_case *c, uint32_t triangles, uint32_t width,
                    uint32_t height, const char *effects) {
    cJSON *row = cJSON_CreateObject();
    cJSON_AddStringToObject(row, "backend", c->device->backend);
    cJSON_AddNumberToObject(row, "triangles", triangles);
    cJSON_AddNumberToObject(row, "width", width);
    cJSON_AddNumberToObject(row, "height", height);
    cJSON_AddNumberToObject(row, "layers", (double)c->settings.layers);
    cJSON_AddStringToObject(row, "effects", effects);
    cJSON_AddNumberToObject(row, "frame_ms", c->frame);
    cJSON_AddNumberToObject(row, "update_ms", c->update);
    for (int t = 0; t < TOLD; t++)
        cJSON_AddNumberToObject(row, told[t], c->passes[t]);
    cJSON_AddNumberToObject(row, "frame_over_gouraud", c->frame / c->passes[0]);
    cJSON_AddItemToArray(list, row);
}

/* Both sizes of the paper's pictures: one sample a pixel, and two each way. With the default of
 * layers, with none behind the nearest, and with all effects. */
static bool measure_mesh(bench_device *device, lao_context *context, const mesh_row *mesh,
                         bool quick, cJSON *list) {
    vsf_object object;
    vsf_mesh built;
    surface_case c;
    memset(&built, 0, sizeof built);
    memset(&c, 0, sizeof c);
    if (!make_mesh(mesh, &built))
        return false;
    uint32_t triangles = built.triangle_count;
    lao_result result = vsf_object_make(NULL, &built, 0, &object);
    vsf_mesh_free(&built);
    if (result != LAO_OK)
        return bench_fail("the object: %s", lao_result_text(result));
    c.device = device;
    c.context = context;
    c.object = &object;
    bool ok = lao_object_create(context, &object.desc, &c.handle) == LAO_OK;
    for (int k = 0; ok && k < (quick ? 1 : 4); k++) {
        uint32_t samples = k == 1 ? 2 : 1, width = quick ? 214 : 853, height = quick ? 230 : 917;
        c.settings.set = VSF_SET(layers);
        c.settings.layers = k == 2 ? 0 : 7;
        c.settings.depth_shadow = c.settings.focus = k == 3;
        c.settings.focus_far = 70;
        ok = measure(&c, width, height, samples);
        if (ok)
            add_row(list, &c, triangles, width * samples, height * samples, k == 3 ? "on" : "off");
    }
    lao_object_destroy(context, c.handle);
    vsf_object_free(&object);
    return ok;
}

bool bench_surface_run(cJSON *document, bool quick) {
    static const char *const backends[] = {"gl", "vk"};
    cJSON *list = cJSON_AddArrayToObject(document, "surface");
    floored floor;
    bool ok = true;
    const lao_module *module = floored_make(&floor);
    for (int b = 0; ok && b < (bench_floors_have_words() ? 2 : 1); b++) {
        bench_device device;
        lao_context *context = NULL;
        ok = bench_device_open(&device, backends[b]) &&
             bench_device_context(&device, module, &context);
        for (size_t i = 0; ok && i < (quick ? 1 : sizeof mesh_rows / sizeof *mesh_rows); i++)
            ok = measure_mesh(&device, context, &mesh_rows[i], quick, list);
        lao_destroy(context);
        bench_device_close(&device);
    }
    return ok;
}

void bench_surface_print(const cJSON *document) {
    const cJSON *row;
    printf("milliseconds, least of %d frames\n"
           "triangles  pixels     layers  effects  backend  frame  upload  gouraud  measure  back "
           " front   peel   left   over  shadow  focus  frame/gouraud\n",
           ROUNDS);
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(document, "surface")) {
        static const char *const names[] = {
            "triangles",         "width", "height", "layers", "frame_ms", "update_ms",
            "frame_over_gouraud"};
        double n[7], p[TOLD];
        for (int i = 0; i < 7; i++)
            n[i] = cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(row, names[i]));
        for (int t = 0; t < TOLD; t++)
            p[t] = cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(row, told[t]));
        printf("%9.0f %5.0fx%-5.0f %5.0f %8s %8s %7.1f %7.1f %8.1f %8.1f %5.1f %6.1f %6.1f %6.1f "
               "%6.1f %7.1f %6.1f %10.1f\n",
               n[0], n[1], n[2], n[3],
               cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, "effects")),
               cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, "backend")), n[4], n[5],
               p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], n[6]);
    }
}
