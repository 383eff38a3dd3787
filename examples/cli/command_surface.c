/* lineao surface: vessel walls as pictures and numbers. */
#include "commands.h"
#include "legends.h"
#include "report.h"
#include "surface.h"
#include "writing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The time that shows the embedded flow best: systole. Of a volume's it is when half of the lines
 * are half way: a quarter of beta. */
#define EMBEDDED_TIME 180

/* ---- numbers of vertices ---------------------------------------------------------------- */

static void write_rows(cli_text *t, const char *name, const float *values, uint32_t count,
                       const double *origin) {
    cli_text_print(t, ",\n\"%s\":[", name);
    for (uint32_t i = 0; i < count && !t->broken; i++) {
        const float *v = values + 3 * (size_t)i;
        cli_text_print(t, "%s\n[%.9g,%.9g,%.9g]", i ? "," : "", (double)v[0] + origin[0],
                       (double)v[1] + origin[1], (double)v[2] + origin[2]);
    }
    cli_text_print(t, "]");
}

/* step: floats from one to the next. VSF_FAR becomes null. */
static void write_numbers(cli_text *t, const char *name, const float *values, uint32_t count) {
    cli_text_print(t, ",\n\"%s\":[", name);
    for (uint32_t i = 0; i < count && !t->broken; i++) {
        cli_text_print(t, "%s", i ? "," : "");
        cli_text_float(t, values[i] < VSF_FAR ? values[i] : NAN);
    }
    cli_text_print(t, "]");
}

/* x of the look-up, as the vertex stage makes it. */
static void nearness(const cli_wall *wall, float *near) {
    float v[VSF_SETTING_COUNT];
    lao_settings_resolve(vsf_module(), &wall->settings, v);
    for (uint32_t i = 0; i < wall->mesh.vertex_count; i++) {
        const float *pair = wall->object.near_pair + 2 * (size_t)i;
        near[i] = v[VSF_SETTING_ID_near_source] > 0
                      ? vsf_value_x(wall->object.values[i], v[VSF_SETTING_ID_value_low],
                                    v[VSF_SETTING_ID_value_high])
                      : vsf_near_x(vsf_near_mix(pair[0], pair[1], v[VSF_SETTING_ID_near_part]),
                                   v[VSF_SETTING_ID_near_gamma]);
    }
}

static bool write_vertices(const cli_wall *wall, const cli_shot *shot, const char *path) {
    static const double zero[3] = {0, 0, 0};
    const vsf_mesh *mesh = &wall->mesh;
    float eye[4], *measure = cli_new(mesh->vertex_count, 2 * sizeof *measure);
    cli_text t = {NULL, 0, 0, false};
    if (!measure)
        return false;
    cli_wall_eye(shot, eye);
    bool ok = vsf_measure(&wall->host, &wall->object.buffers, eye, 0, measure) == LAO_OK;
    cli_text_print(&t, "{\"triangles\":[");
    for (uint32_t i = 0; i < mesh->triangle_count && !t.broken; i++) {
        const uint32_t *c = mesh->triangles + 3 * (size_t)i;
        cli_text_print(&t, "%s\n[%u,%u,%u]", i ? "," : "", c[0], c[1], c[2]);
    }
    cli_text_print(&t, "]");
    write_rows(&t, "p", mesh->positions, mesh->vertex_count, wall->scene.origin);
    write_rows(&t, "n", mesh->normals, mesh->vertex_count, zero);
    write_numbers(&t, "measure", measure, mesh->vertex_count);
    nearness(wall, measure + mesh->vertex_count);
    write_numbers(&t, "near", measure + mesh->vertex_count, mesh->vertex_count);
    if (wall->lit) {
        vsf_near_sample(&wall->near, (double)shot->time, measure);
        write_numbers(&t, "phi", measure, mesh->vertex_count);
        cli_text_print(&t, ",\n\"beta\":%.17g,\"gamma\":", wall->near.beta);
        cli_text_float(&t, wall->near.gamma);
    }
    cli_text_print(&t, "}\n");
    free(measure);
    ok = ok && !t.broken;
    if (!ok)
        free(t.text);
    return ok && cli_text_write(&t, path);
}

/* ---- pictures --------------------------------------------------------------------------- */

/* frame -1: the only one. */
static bool write_frame(cli_wall *wall, cli_session *session, const cli_shot *shot,
                        cli_video *video, int64_t frame) {
    const char *paths[2] = {wall->options->dump, wall->options->out};
    bool ok = true;
    for (int i = 0; i < 2 && ok; i++) {
        if (!paths[i])
            continue;
        char *numbered = frame < 0 ? NULL : cli_frame_path(paths[i], (uint32_t)frame);
        const char *path = numbered ? numbered : paths[i];
        ok = (frame < 0 || numbered) && cli_go_on() &&
             (i == 0 ? cli_dump(path, session, &wall->scene, shot, cli_wall_planes, wall)
                     : cli_write_picture(path, video, session, shot->background[3] >= 1,
                                         cli_wall_legends, wall));
        free(numbered);
    }
    return ok;
}

/* Shows the shot's time: distances go up where the time passed a step of the table. */
static bool show_time(cli_wall *wall, cli_session *session, const cli_shot *shot) {
    lao_object_desc update;
    return !cli_wall_time(wall, (double)shot->time, &update) ||
           lao_object_update(session->context, session->sets[0].object, &update) == LAO_OK;
}

static bool draw_frames(cli_wall *wall, cli_session *session, cli_shot *shot, cli_video *video) {
    const cli_options *options = wall->options;
    uint32_t count = options->frames ? options->frames : 1;
    uint32_t flags = options->timings ? LAO_FRAME_TIMINGS : 0;
    double start = (double)shot->time;
    cli_progress progress = {"rendering", options->out ? options->out : "", -1};
    bool ok = !flags || cli_session_render(session, shot, flags);
    for (uint32_t i = 0; ok && i < count; i++) {
        shot->time = (float)(start + wall->scene.period * i / count);
        if (count > 1)
            cli_progress_show(&progress, i, count);
        ok = show_time(wall, session, shot) && cli_session_render(session, shot, flags) &&
             write_frame(wall, session, shot, video, options->frames ? (int64_t)i : -1);
    }
    cli_progress_end(&progress);
    return ok;
}

static bool draw(cli_wall *wall, cli_session *session, cli_shot *shot) {
    const cli_options *options = wall->options;
    cli_video video;
    if (!cli_is_video(options->out))
        return draw_frames(wall, session, shot, NULL);
    return cli_video_open(&video, options->out, shot->width, shot->height,
                          options->fps ? options->fps : 25) &&
           cli_video_close(&video, draw_frames(wall, session, shot, &video));
}

static bool render(cli_wall *wall) {
    const cli_options *options = wall->options;
    lao_object_desc update;
    cli_session session;
    cli_shot shot;
    if (!cli_shot_make(options, &wall->scene, &shot))
        return false;
    if (isnan(options->time) && !options->frames && wall->lit && !options->surface.lines)
        shot.time = wall->source->path ? (float)wall->near.beta / 4 : EMBEDDED_TIME;
    if (!cli_wall_aim(wall, &shot))
        return false;
    cli_wall_time(wall, (double)shot.time, &update); /* all goes up with the object */
    bool ok =
        cli_wall_legends_check(wall, &shot) && cli_write_camera(options, &shot.camera) &&
        (!options->surface.vertices || write_vertices(wall, &shot, options->surface.vertices));
    if (ok)
        cli_legends_warn(options, options->out, wall->note);
    if (!ok || (!options->out && !options->dump && !options->timings))
        return ok;
    ok = cli_session_open(&session, options->backend, &wall->scene, &shot,
                          options->dump ? LAO_VIEW_KEEP_IMAGES : 0) &&
         draw(wall, &session, &shot);
    if (ok && options->timings) {
        cJSON *json = cli_timings(&session, &shot);
        ok = json && cli_write_json(options->timings, json);
    }
    cli_session_close(&session);
    return ok;
}

/* ---- report ----------------------------------------------------------------------------- */

static void add_warnings(const cli_wall *wall, cJSON *list) {
    char text[512];
    for (uint32_t i = 0; cli_wall_warning(wall, i, text, sizeof text); i++) {
        if (list)
            cJSON_AddItemToArray(list, cJSON_CreateString(text));
        else
            cli_warn(wall->name, text);
    }
    if (list && *wall->note)
        cJSON_AddItemToArray(list, cJSON_CreateString(wall->note));
    cli_scene_warn(&wall->scene);
}

static bool report(const cli_wall *wall) {
    const vsf_mesh_info *info = &wall->mesh.info;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, wall->source->path ? "path" : "scene", wall->name);
    cJSON_AddNumberToObject(json, "vertices", wall->mesh.vertex_count);
    cJSON_AddNumberToObject(json, "triangles", wall->mesh.triangle_count);
    cJSON_AddNumberToObject(json, "open_edges", info->open_edges);
    cJSON_AddNumberToObject(json, "parts", info->parts);
    cJSON_AddNumberToObject(json, "area", info->area);
    cJSON_AddNumberToObject(json, "volume", info->volume);
    if (wall->lit) {
        cJSON_AddNumberToObject(json, "beta", wall->near.beta);
        cJSON_AddItemToObject(json, "gamma", cli_json_float(wall->near.gamma));
        cJSON_AddNumberToObject(json, "steps", wall->near.step_count);
        cJSON_AddNumberToObject(json, "bytes", /* of all distances */
                                (double)wall->near.bytes * wall->near.vertex_count *
                                    wall->near.step_count);
    }
    add_warnings(wall, cJSON_AddArrayToObject(json, "warnings"));
    return cli_write_json(NULL, json);
}

int cli_surface(const cli_options *options) {
    const char *outputs[5] = {options->out, options->dump, options->timings, options->save_camera,
                              options->surface.vertices};
    cli_wall wall;
    for (int i = 0; i < 5; i++) {
        if (!cli_writable(outputs[i]))
            return CLI_FAILED;
    }
    bool ok = cli_wall_load(options, NULL, &wall) && render(&wall);
    if (ok && options->json)
        ok = report(&wall);
    else if (ok)
        add_warnings(&wall, NULL);
    cli_wall_free(&wall);
    return ok ? CLI_OK : CLI_FAILED;
}
