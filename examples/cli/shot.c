/* Where a frame is taken from. */
#include "session.h"

#include "report.h"
#include "vessel.h"

#include <math.h>
#include <string.h>

/* Centre and radius of the box around all points, at least half a line wide, as lineao would. */
static void find_sphere(const cli_scene *scene, float sphere[4]) {
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, squared = 0, widest = 0;
    bool any = false;
    for (uint32_t s = 0; s < scene->count; s++) {
        const io_lines *lines = &scene->sets[s].lines;
        lao_settings settings = lao_settings_filled(&scene->sets[s].settings);
        if (scene->sets[s].overlay)
            continue;
        widest = settings.width > widest ? settings.width : widest;
        for (uint32_t i = 0; i < lines->point_count; i++) {
            const float *p = lines->points + 3 * (size_t)i;
            if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
                continue;
            for (int k = 0; k < 3; k++) {
                low[k] = any && low[k] < p[k] ? low[k] : p[k];
                high[k] = any && high[k] > p[k] ? high[k] : p[k];
            }
            any = true;
        }
    }
    for (int k = 0; k < 3; k++) {
        sphere[k] = (float)(0.5 * (low[k] + high[k]));
        squared += 0.25 * (high[k] - low[k]) * (high[k] - low[k]);
    }
    sphere[3] = (float)fmax(sqrt(squared), 0.5 * widest);
}

/* Nodes of a tree are balls; of other sets the points tell. */
static void add_to_orbit(const cli_set *set, camera_orbit *orbit) {
    const sdv_tree *tree = set->tree ? &set->tree->vessel.tree : NULL;
    if (tree && tree->node_count)
        camera_orbit_add(orbit, &tree->nodes->x, 4, tree->node_count);
    camera_orbit_add(orbit, set->lines.points, 3, set->lines.point_count);
}

static void fit_camera(const cli_options *options, const cli_scene *scene, double aspect,
                       camera_pose *out) {
    camera_fit fit;
    camera_orbit orbit;
    camera_fit_begin(&fit, scene->direction, scene->up, aspect, 0.05, options->ortho ? 0 : 30);
    for (uint32_t s = 0; s < scene->count; s++) {
        if (!scene->sets[s].overlay)
            camera_fit_add(&fit, scene->sets[s].lines.points, scene->sets[s].lines.point_count);
    }
    camera_fit_add(&fit, scene->outline.positions, scene->outline.vertex_count);
    camera_fit_end(&fit, out);
    if (scene->turns) {
        camera_orbit_begin(&orbit, &fit);
        for (uint32_t s = 0; s < scene->count; s++)
            add_to_orbit(&scene->sets[s], &orbit);
        camera_orbit_end(&orbit, out);
    }
    for (int k = 0; k < 3; k++) {
        out->eye[k] += scene->origin[k];
        out->center[k] += scene->origin[k];
    }
}

void cli_shot_aim(const cli_scene *scene, cli_shot *shot) {
    /* From the absolute camera, so that a saved one gives the same matrices to the bit. */
    camera_pose local = shot->camera;
    double center[3];
    for (int k = 0; k < 3; k++) {
        local.eye[k] -= scene->origin[k];
        local.center[k] -= scene->origin[k];
        center[k] = shot->sphere[k];
    }
    float widest = 0; /* a ribbon reaches out of the ball of its points */
    for (uint32_t s = 0; s < scene->count; s++) {
        if (!scene->sets[s].overlay)
            widest = fmaxf(widest, lao_settings_filled(&scene->sets[s].settings).width);
    }
    camera_matrices(&local, (double)shot->width / shot->height, center,
                    (double)shot->sphere[3] + widest, true, shot->view, shot->projection);
    if (shot->margin) {
        lao_camera seen;
        memset(&seen, 0, sizeof seen);
        memcpy(seen.projection, shot->projection, sizeof seen.projection);
        sdv_camera_margin(&seen, shot->width, shot->height, shot->margin, &seen);
        memcpy(shot->projection, seen.projection, sizeof seen.projection);
    }
}

bool cli_shot_make(const cli_options *options, const cli_scene *scene, cli_shot *out) {
    char error[CAMERA_ERROR_SIZE];
    double aspect = (double)options->size[0] / options->size[1];
    memset(out, 0, sizeof *out);
    out->margin = options->vessel.margin;
    out->width = options->size[0];
    out->height = options->size[1];
    out->time = (float)(!isnan(options->time) ? options->time
                        : options->frames     ? scene->beat[0]
                                              : 0);
    out->frame_flags = options->shared_occlusion ? LAO_FRAME_SHARED_OCCLUSION : 0;
    for (int k = 0; k < 4; k++)
        out->background[k] = (float)options->background[k];
    find_sphere(scene, out->sphere);
    if (!options->camera)
        fit_camera(options, scene, aspect, &out->camera);
    else if (!(*options->camera == '{'
                   ? camera_parse("--camera", options->camera, &out->camera, error)
                   : camera_read(options->camera, &out->camera, error)))
        return cli_fail("%s", error);
    cli_shot_aim(scene, out);
    return true;
}

void cli_turn(const camera_pose *from, double part, camera_pose *out) {
    double angle = 6.283185307179586 * part, c = cos(angle), s = sin(angle), size = 0, along = 0;
    double axis[3], arm[3];
    *out = *from;
    for (int k = 0; k < 3; k++)
        size += from->up[k] * from->up[k];
    for (int k = 0; k < 3; k++) {
        axis[k] = from->up[k] / sqrt(size);
        arm[k] = from->eye[k] - from->center[k];
        along += axis[k] * arm[k];
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double across = axis[i] * arm[j] - axis[j] * arm[i];
        out->eye[k] = from->center[k] + c * arm[k] + s * across + (1 - c) * along * axis[k];
    }
}
