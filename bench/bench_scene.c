#include "bench_scene.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

bool bench_fail(const char *format, ...) {
    char text[512];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    for (char *c = text; *c; c++) {
        if (*c == '\n' || *c == '\r')
            *c = ' ';
    }
    fprintf(stderr, "lineao: bench: %s\n", text);
    return false;
}

static bool make(bench_scene *scene, const char *name, uint32_t line_count, float direction[3],
                 float up[3]) {
    if (!scene_make(name, line_count, 0, &scene->made))
        return bench_fail("no memory for the scene");
    scene->line_count = scene->made.line_count;
    scene->point_count = scene->made.point_count;
    scene->offsets = scene->made.offsets;
    scene->points = scene->made.points;
    scene->times = scene->made.times;
    scene->width = scene->made.width;
    memcpy(direction, scene->made.view_direction, 3 * sizeof *direction);
    memcpy(up, scene->made.up, 3 * sizeof *up);
    return true;
}

static bool fill(bench_scene *scene, const char *path, uint32_t line_count, float direction[3],
                 float up[3]) {
    static const float left[3] = {1, 0, 0}, head[3] = {0, 0, 1};
    if (!path)
        return make(scene, "bundle", line_count, direction, up);
    io_error error;
    if (!io_read_lines(path, NULL, &scene->read, &error))
        return bench_fail("%s: %s", path, error.text);
    scene->line_count = scene->read.line_count;
    scene->point_count = scene->read.point_count;
    scene->offsets = scene->read.offsets;
    scene->points = scene->read.points;
    scene->width = lao_settings_filled(NULL).width;
    memcpy(direction, left, sizeof left);
    memcpy(up, head, sizeof head);
    return true;
}

/* The sphere around the box of the points, as lineao takes it. */
static void enclose(bench_scene *scene, float lo[3], float hi[3]) {
    double squared = 0;
    for (int k = 0; k < 3; k++) {
        lo[k] = hi[k] = scene->point_count ? scene->points[k] : 0.0f;
        for (uint32_t i = 1; i < scene->point_count; i++) {
            float value = scene->points[3 * (size_t)i + (size_t)k];
            lo[k] = value < lo[k] ? value : lo[k];
            hi[k] = value > hi[k] ? value : hi[k];
        }
        scene->sphere[k] = 0.5f * (lo[k] + hi[k]);
        squared += 0.25 * (double)(hi[k] - lo[k]) * (double)(hi[k] - lo[k]);
    }
    scene->sphere[3] = (float)sqrt(squared);
}

static void look(bench_scene *scene, const float direction[3], const float up[3], double aspect) {
    float lo[3], hi[3];
    enclose(scene, lo, hi);
    camera_frame(lo, hi, scene->points, scene->point_count, direction, up, aspect, 0.05,
                 &scene->pose);
}

bool bench_scene_open(bench_scene *scene, const char *path, uint32_t line_count, double aspect) {
    float direction[3], up[3];
    memset(scene, 0, sizeof *scene);
    if (!fill(scene, path, line_count, direction, up))
        return false;
    look(scene, direction, up, aspect);
    return true;
}

bool bench_scene_timed(bench_scene *scene, const char *name, uint32_t line_count, double aspect) {
    float direction[3], up[3];
    memset(scene, 0, sizeof *scene);
    if (!make(scene, name, line_count, direction, up))
        return false;
    look(scene, direction, up, aspect);
    return scene->times || bench_fail("the scene %s has no times", name);
}

void bench_scene_release(bench_scene *scene) {
    scene_free(&scene->made);
    io_lines_free(&scene->read);
    scene->offsets = NULL;
    scene->points = NULL;
    scene->times = NULL;
}

bool bench_scene_export(const bench_scene *scene, const char *path) {
    const camera_pose *pose = &scene->pose;
    FILE *file = fopen(path, "wb");
    if (!file)
        return bench_fail("%s: the file cannot be written", path);
    size_t offsets = scene->line_count + (size_t)1, points = 3 * (size_t)scene->point_count;
    bool ok = fwrite("LAOBENCH", 8, 1, file) == 1 && fwrite(&scene->line_count, 4, 1, file) == 1 &&
              fwrite(&scene->point_count, 4, 1, file) == 1 &&
              fwrite(&scene->width, 4, 1, file) == 1 && fwrite(pose->eye, 8, 3, file) == 3 &&
              fwrite(pose->center, 8, 3, file) == 3 && fwrite(pose->up, 8, 3, file) == 3 &&
              fwrite(&pose->fovy, 8, 1, file) == 1 &&
              fwrite(scene->offsets, 4, offsets, file) == offsets &&
              fwrite(scene->points, 4, points, file) == points;
    ok = fclose(file) == 0 && ok;
    return ok || bench_fail("%s: the file could not be written; is the disk full?", path);
}
