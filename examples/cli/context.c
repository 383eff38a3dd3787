#include "context.h"

#include "backdrop.h"
#include "colour.h"
#include "flow4d.h"
#include "flow_phantom.h"
#include "report.h"
#include "threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- volumes ---------------------------------------------------------------------------- */

static void on_log(void *user, flow4d_log_item item, lao_result result, const char *text) {
    (void)user;
    (void)result;
    if (item != FLOW4D_LOG_CANCELLED)
        cli_fail("--backdrop: %s", text);
}

static flow4d_host host_of(cli_threads *threads) {
    flow4d_host host;
    memset(&host, 0, sizeof host);
    host.job = cli_threads_job(threads, NULL);
    host.log = on_log;
    return host;
}

/* The 1-2-1 filter along one axis; beyond the border as at it. room: size[axis] values. */
static void smooth(float *values, const uint32_t size[3], int axis, float *room) {
    size_t stride = axis == 0 ? 1 : axis == 1 ? size[0] : (size_t)size[0] * size[1];
    size_t n = size[axis], count = (size_t)size[0] * size[1] * size[2];
    for (size_t row = 0; row < count / n; row++) {
        float *v = values + row / stride * stride * n + row % stride;
        for (size_t i = 0; i < n; i++)
            room[i] = v[i * stride];
        for (size_t i = 0; i < n; i++)
            v[i * stride] = 0.25f * room[i > 0 ? i - 1 : i] + 0.5f * room[i] +
                            0.25f * room[i + 1 < n ? i + 1 : i];
    }
}

/* A mask whose steps are rounded. Vessels of one voxel, which rounding would take away, stay. */
static bool round_mask(const uint8_t *mask, cli_volume *volume) {
    const uint32_t *size = volume->size;
    size_t count = (size_t)size[0] * size[1] * size[2];
    uint32_t longest = size[0] > size[1] ? size[0] : size[1];
    float *room = cli_new(longest > size[2] ? longest : size[2], sizeof *room);
    for (size_t i = 0; room && i < count; i++)
        volume->inside[i] = !mask || mask[i] ? 1 : 0;
    for (int axis = 0; room && axis < 3; axis++)
        smooth(volume->inside, size, axis, room);
    for (size_t i = 0; room && i < count; i++) {
        if (mask && mask[i] && volume->inside[i] < 0.3f) /* a corner of a wide one has 0.42 */
            volume->inside[i] = 0.6f;
    }
    bool ok = room != NULL;
    free(room);
    return ok;
}

bool cli_context_keep(cli_scene *scene, const flow4d_field *field) {
    cli_volume *volumes = realloc(scene->volumes, (scene->volume_count + 1) * sizeof *volumes);
    size_t count = (size_t)field->size[0] * field->size[1] * field->size[2];
    cli_threads *threads = volumes ? cli_threads_start() : NULL;
    if (!volumes)
        return cli_fail("out of memory");
    scene->volumes = volumes;
    if (!threads)
        return false;
    cli_volume *volume = &volumes[scene->volume_count++];
    memset(volume, 0, sizeof *volume); /* freed with the scene from here on */
    memcpy(volume->size, field->size, sizeof volume->size);
    memcpy(volume->to_mm, field->to_world, sizeof volume->to_mm);
    volume->fastest = cli_new(count, sizeof *volume->fastest);
    volume->inside = cli_new(count, sizeof *volume->inside);
    flow4d_host host = host_of(threads);
    bool ok = volume->fastest && volume->inside && round_mask(field->mask, volume) &&
              flow4d_temporal_maximum(&host, field, volume->fastest) == LAO_OK;
    cli_threads_stop(threads);
    return ok && cli_go_on();
}

bool cli_context_keep_embedded(cli_scene *scene, const char *name) {
    static const double fine[3] = {1.5, 1.5, 1.5};
    flow4d_field grid;
    if (strcmp(name, "flow") != 0)
        return true;
    if (!flow_phantom_grid(fine, 0, &grid))
        return cli_fail("out of memory");
    bool ok = cli_context_keep(scene, &grid);
    flow_phantom_grid_free(&grid);
    return ok;
}

/* ---- projections ------------------------------------------------------------------------ */

/* Greatest of `image` and the projection, whose first row is the bottom one. */
static void merge(float *image, const float *projection, uint32_t width, uint32_t height) {
    for (size_t y = 0; y < height; y++) {
        for (size_t x = 0; x < width; x++) {
            float v = projection[(height - 1 - y) * width + x], *p = &image[y * width + x];
            *p = v > *p ? v : *p;
        }
    }
}

static flow4d_volume volume_of(const cli_volume *volume, const double origin[3]) {
    flow4d_volume v;
    memset(&v, 0, sizeof v);
    memcpy(v.size, volume->size, sizeof v.size);
    memcpy(v.to_world, volume->to_mm, sizeof v.to_world);
    for (int k = 0; k < 3; k++)
        v.to_world[4 * k + 3] -= origin[k];
    return v;
}

/* The speed that one voxel in a hundred of the masks exceeds. */
static bool find_brightest(const cli_scene *scene, double *brightest) {
    size_t count = 0, kept = 0;
    for (uint32_t i = 0; i < scene->volume_count; i++) {
        const uint32_t *size = scene->volumes[i].size;
        count += (size_t)size[0] * size[1] * size[2];
    }
    double *values = cli_new(count, sizeof *values);
    for (uint32_t i = 0; values && i < scene->volume_count; i++) {
        const cli_volume *v = &scene->volumes[i];
        for (size_t k = 0; k < (size_t)v->size[0] * v->size[1] * v->size[2]; k++) {
            if (v->inside[k] >= 0.5f)
                values[kept++] = v->fastest[k];
        }
    }
    if (values)
        *brightest = colour_percentile(values, kept, 99);
    free(values);
    return values != NULL;
}

static bool project(const cli_scene *scene, const cli_shot *shot, const flow4d_host *host,
                    float *room, cli_context *out) {
    lao_camera camera;
    memset(&camera, 0, sizeof camera);
    memcpy(camera.view, shot->view, sizeof camera.view);
    memcpy(camera.projection, shot->projection, sizeof camera.projection);
    camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    bool ok = true;
    for (uint32_t i = 0; i < 2 * scene->volume_count && ok; i++) {
        const cli_volume *volume = &scene->volumes[i / 2];
        flow4d_volume v = volume_of(volume, scene->origin);
        v.values = i % 2 ? volume->inside : volume->fastest;
        ok = flow4d_project_maximum(host, &v, &camera, shot->width, shot->height, room) == LAO_OK &&
             cli_go_on();
        if (ok)
            merge(i % 2 ? out->coverage : out->intensity, room, shot->width, shot->height);
    }
    return ok;
}

/* How much of the brightest a silhouette without a volume shows. */
#define SILHOUETTE 0.4

/* The silhouette of --outline: to be outlined, and evenly tinted where nothing is brighter. */
static void cover(const cli_scene *scene, const cli_shot *shot, cli_context *out) {
    backdrop_mesh mesh = {
        scene->outline.triangle_count, scene->outline.positions, scene->outline.triangles, {0}};
    for (int i = 0; i < 16; i++) {
        for (int k = 0; k < 4; k++)
            mesh.to_clip[i] +=
                (double)shot->projection[4 * k + i % 4] * (double)shot->view[i / 4 * 4 + k];
    }
    backdrop_cover(&mesh, shot->width, shot->height, 1, out->coverage);
    backdrop_cover(&mesh, shot->width, shot->height, (float)(SILHOUETTE * out->brightest),
                   out->intensity);
}

bool cli_context_make(const cli_scene *scene, const cli_shot *shot, cli_context *out) {
    size_t count = (size_t)shot->width * shot->height;
    memset(out, 0, sizeof *out);
    if (scene->volume_count == 0 && scene->outline.triangle_count == 0)
        return true;
    out->intensity = cli_new(count, sizeof *out->intensity);
    out->coverage = cli_new(count, sizeof *out->coverage);
    float *room = cli_new(count, sizeof *room);
    cli_threads *threads = room ? cli_threads_start() : NULL;
    bool ok = out->intensity && out->coverage && threads && find_brightest(scene, &out->brightest);
    if (!(out->brightest > 0))
        out->brightest = 1;
    if (ok) {
        flow4d_host host = host_of(threads);
        memset(out->intensity, 0, count * sizeof *out->intensity);
        memset(out->coverage, 0, count * sizeof *out->coverage);
        ok = project(scene, shot, &host, room, out);
        cover(scene, shot, out);
    }
    cli_threads_stop(threads);
    free(room);
    return ok;
}

void cli_context_free(cli_context *context) {
    free(context->intensity);
    free(context->coverage);
    memset(context, 0, sizeof *context);
}

bool cli_context_compose(const cli_context *context, const float paper[4], picture *lines) {
    backdrop_look look;
    memset(&look, 0, sizeof look);
    bool opaque = paper[3] >= 1, light = paper[0] + paper[1] + paper[2] > 1.5f;
    for (int k = 0; k < 3; k++) {
        look.low[k] = (double)paper[k];
        look.high[k] = look.low[k] + (light ? -0.2 : 0.2);
        look.line[k] = light || !opaque ? 0.2 : 0.85;
    }
    look.range[1] = context->brightest;
    return backdrop_compose(lines, opaque ? context->intensity : NULL, context->coverage, &look) ||
           cli_fail("out of memory");
}
