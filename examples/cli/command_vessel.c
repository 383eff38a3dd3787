/* lineao vessel: vessel trees as pictures, layouts and numbers. */
#include "commands.h"
#include "image.h"
#include "report.h"
#include "writing.h"
#include "vessel.h"
#include "video.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- text files -------------------------------------------------------------------------- */

static bool write_layout(const cli_tree *tree, const char *path, bool svg) {
    cli_text t = {NULL, 0, 0, false};
    const sdv_writer writer = {cli_text_add, &t};
    sdv_svg_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.radial = tree->source->layout.layout_radial > 0;
    if (svg)
        sdv_layout_write_svg(&tree->reduced, &tree->layout, &desc, &writer);
    else
        sdv_layout_write_json(&tree->reduced, &tree->layout, tree->distances, &writer);
    return cli_text_write(&t, path);
}

/* The segments of the tree, then those nodes that are balls of their own, as the field counts. */
static bool write_tree(const cli_tree *tree, const char *path) {
    const sdv_tree *t = &tree->vessel.tree;
    const double *o = tree->vessel.origin;
    cli_text out = {NULL, 0, 0, false};
    const char *comma = "";
    cli_text_print(&out, "{\"nodes\":[");
    for (uint32_t i = 0; i < t->node_count && !out.broken; i++) {
        const lao_v4 *n = &t->nodes[i];
        char r[32];
        cli_shortest(n->w, r, sizeof r);
        cli_text_print(&out, "%s\n{\"p\":[%.9g,%.9g,%.9g],\"r\":%s}", i ? "," : "",
                       o[0] + (double)n->x, o[1] + (double)n->y, o[2] + (double)n->z, r);
    }
    cli_text_print(&out, "],\n\"segments\":[");
    for (uint32_t i = 0; i < t->segment_count && !out.broken; i++, comma = ",")
        cli_text_print(&out, "%s\n[%u,%u]", comma, t->segments[i].parent, t->segments[i].child);
    bool *touched = cli_new(t->node_count, sizeof *touched);
    if (!touched) {
        free(out.text);
        return false;
    }
    memset(touched, 0, t->node_count * sizeof *touched);
    for (uint32_t i = 0; i < t->segment_count; i++)
        touched[t->segments[i].parent] = touched[t->segments[i].child] = true;
    for (uint32_t i = 0; i < t->node_count && !out.broken; i++) {
        if (!touched[i]) {
            cli_text_print(&out, "%s\n[%u,%u]", comma, i, i);
            comma = ",";
        }
    }
    free(touched);
    cli_text_print(&out, "]}\n");
    return cli_text_write(&out, path);
}

/* ---- dumps ------------------------------------------------------------------------------- */

/* Positions become absolute; what the field does not know is added: mask and distance. */
static bool edit_planes(void *user, cli_planes *planes) {
    static const char *const names[3] = {"position.X", "position.Y", "position.Z"};
    static const char *const behind[3] = {"bgposition.X", "bgposition.Y", "bgposition.Z"};
    const cli_tree *tree = user;
    size_t count;
    const float *segment = cli_planes_find(planes, "segment.V", &count);
    float *p[3], *b[3], *mask = cli_planes_add(planes, "mask.V");
    float *distance = tree->target ? cli_planes_add(planes, "distance.V") : NULL;
    if (!segment || !mask || (tree->target && !distance))
        return segment != NULL || cli_fail("the dump has no segments");
    for (int k = 0; k < 3; k++) {
        p[k] = cli_planes_find(planes, names[k], &count);
        b[k] = cli_planes_find(planes, behind[k], &count);
    }
    for (size_t i = 0; i < count; i++) {
        bool covered = segment[i] != -1;
        mask[i] = covered ? 1.0f : 0.0f;
        if (distance)
            distance[i] =
                covered ? sdv_target_point(tree->target, lao_v3_make(p[0][i], p[1][i], p[2][i]))
                        : SDV_FAR;
        for (int k = 0; k < 3; k++) {
            double o = tree->vessel.origin[k];
            p[k][i] = covered ? (float)((double)p[k][i] + o) : 0.0f;
            if (b[k])
                b[k][i] = (float)((double)b[k][i] + o);
        }
    }
    return true;
}

/* ---- pictures ---------------------------------------------------------------------------- */

/* frame -1: the only one. */
static bool write_frame(cli_tree *tree, cli_session *session, const cli_shot *shot,
                        cli_video *video, int64_t frame) {
    const char *paths[2] = {tree->options->dump, tree->options->out};
    bool ok = true;
    for (int i = 0; i < 2 && ok; i++) {
        if (!paths[i])
            continue;
        char *numbered = frame < 0 ? NULL : cli_frame_path(paths[i], (uint32_t)frame);
        const char *path = numbered ? numbered : paths[i];
        ok = (frame < 0 || numbered) && cli_go_on() &&
             (i == 0 ? cli_dump(path, session, &tree->scene, shot, edit_planes, tree)
                     : cli_write_picture(path, video, session, shot));
        free(numbered);
    }
    return ok;
}

/* Where the frames are taken from. */
typedef struct view_list {
    camera_pose *poses; /* owned; NULL: the shot's camera, turned */
    uint32_t count;
    bool numbered;
} view_list;

static bool read_views(const cli_options *options, view_list *out) {
    char error[CAMERA_ERROR_SIZE];
    *out = (view_list){NULL, options->frames ? options->frames : 1, options->frames > 0};
    if (!options->vessel.cameras)
        return true;
    out->numbered = true;
    return camera_read_all(options->vessel.cameras, &out->poses, &out->count, error) ||
           cli_fail("%s", error);
}

/* The camera turned around its up vector through the point that it looks at, by a part of a turn.
 */
static void turn(const camera_pose *from, double part, camera_pose *out) {
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

static bool draw_views(cli_tree *tree, cli_session *session, cli_shot *shot, const view_list *views,
                       cli_video *video) {
    const cli_options *options = tree->options;
    uint32_t flags = options->timings ? LAO_FRAME_TIMINGS : 0;
    cli_progress progress = {"rendering", options->out ? options->out : "", -1};
    const camera_pose first = shot->camera;
    bool ok = !flags || cli_session_render(session, shot, flags);
    for (uint32_t i = 0; ok && i < views->count; i++) {
        if (views->poses)
            shot->camera = views->poses[i];
        else if (i > 0)
            turn(&first, (double)i / views->count, &shot->camera);
        cli_shot_aim(&tree->scene, shot);
        if (views->count > 1)
            cli_progress_show(&progress, i, views->count);
        ok = cli_session_render(session, shot, flags) &&
             write_frame(tree, session, shot, video, views->numbered ? (int64_t)i : -1);
    }
    cli_progress_end(&progress);
    return ok;
}

static bool draw(cli_tree *tree, cli_session *session, cli_shot *shot, const view_list *views) {
    const cli_options *options = tree->options;
    cli_video video;
    if (!cli_is_video(options->out))
        return draw_views(tree, session, shot, views, NULL);
    return cli_video_open(&video, options->out, shot->width, shot->height,
                          options->fps ? options->fps : 25) &&
           cli_video_close(&video, draw_views(tree, session, shot, views, &video));
}

bool cli_write_camera(const cli_options *options, const camera_pose *camera) {
    if (!options->save_camera)
        return true;
    char *text = camera_print(camera);
    bool ok = text ? cli_write_text(options->save_camera, text) : cli_fail("out of memory");
    free(text);
    return ok;
}

static bool render(cli_tree *tree) {
    const cli_options *options = tree->options;
    cli_session session;
    cli_shot shot;
    view_list views;
    if (!options->out && !options->dump && !options->timings && !options->save_camera)
        return true;
    if (!read_views(options, &views))
        return false;
    bool ok = cli_tree_prepare(tree) && cli_shot_make(options, &tree->scene, &shot);
    if (ok && views.poses)
        shot.camera = views.poses[0];
    ok = ok && cli_write_camera(options, &shot.camera);
    if (ok && (options->out || options->dump || options->timings)) {
        ok = cli_session_open(&session, options->backend, &tree->scene, &shot,
                              options->dump ? LAO_VIEW_KEEP_IMAGES : 0) &&
             draw(tree, &session, &shot, &views);
        if (ok && options->timings) {
            cJSON *json = cli_timings(&session, &shot);
            ok = json && cli_write_json(options->timings, json);
        }
        cli_session_close(&session);
    }
    free(views.poses);
    return ok;
}

/* ---- report ------------------------------------------------------------------------------ */

static void add_warnings(const cli_tree *tree, cJSON *list) {
    const io_tree *read = &tree->contents.tree;
    const sdv_tree *t = &tree->vessel.tree;
    for (uint32_t i = 0; i < read->warning_count + t->warning_count; i++) {
        char text[256];
        if (i < read->warning_count)
            snprintf(text, sizeof text, "%s", read->warnings[i]);
        else
            sdv_tree_warning_text(t, i - read->warning_count, text, sizeof text);
        if (list)
            cJSON_AddItemToArray(list, cJSON_CreateString(text));
        else
            cli_warn(tree->name, text);
    }
}

static bool report(const cli_tree *tree) {
    const sdv_tree_info *info = &tree->vessel.tree.info;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, tree->source->path ? "path" : "scene", tree->name);
    cJSON_AddNumberToObject(json, "nodes", info->nodes);
    cJSON_AddNumberToObject(json, "segments", info->segments);
    cJSON_AddNumberToObject(json, "roots", info->roots);
    cJSON_AddNumberToObject(json, "reduced_nodes", tree->reduced.node_count);
    if (tree->grid.cell_count) {
        cJSON *grid = cJSON_AddObjectToObject(json, "grid");
        cJSON_AddItemToObject(
            grid, "size",
            cJSON_CreateIntArray((const int[3]){(int)tree->grid.size[0], (int)tree->grid.size[1],
                                                (int)tree->grid.size[2]},
                                 3));
        cJSON_AddItemToObject(grid, "cell", cli_json_float(tree->grid.cell));
        cJSON_AddNumberToObject(grid, "listed", tree->grid.id_count);
        cJSON_AddItemToObject(grid, "seconds", cli_json_float((float)tree->grid_seconds));
    }
    if (tree->distances) {
        float least = SDV_FAR;
        for (uint32_t i = 0; i < tree->reduced.node_count; i++)
            least = fminf(least, tree->distances[i]);
        cJSON_AddItemToObject(json, "least_distance",
                              least < SDV_FAR ? cli_json_float(least) : cJSON_CreateNull());
    }
    add_warnings(tree, cJSON_AddArrayToObject(json, "warnings"));
    return cli_write_json(NULL, json);
}

static bool run(cli_tree *tree) {
    const cli_vessel_options *o = &tree->options->vessel;
    if ((o->tree && !write_tree(tree, o->tree)) ||
        (o->layout[0] && !write_layout(tree, o->layout[0], true)) ||
        (o->layout[1] && !write_layout(tree, o->layout[1], false)) || !render(tree))
        return false;
    if (tree->options->json)
        return report(tree);
    add_warnings(tree, NULL);
    return true;
}

int cli_vessel(const cli_options *options) {
    const cli_vessel_options *o = &options->vessel;
    const char *outputs[7] = {options->out, options->dump, options->timings, options->save_camera,
                              o->tree,      o->layout[0],  o->layout[1]};
    cli_tree tree;
    for (int i = 0; i < 7; i++) {
        if (!cli_writable(outputs[i]))
            return CLI_FAILED;
    }
    bool ok = cli_tree_load(options, &tree) && run(&tree);
    cli_tree_free(&tree);
    return ok ? CLI_OK : CLI_FAILED;
}
