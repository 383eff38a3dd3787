/* lineao vessel: vessel trees as pictures, layouts and numbers. */
#include "commands.h"
#include "image.h"
#include "legends.h"
#include "report.h"
#include "writing.h"
#include "vessel_lens.h"
#include "vessel_marks.h"
#include "vessel_page.h"
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

/* ---- pictures ---------------------------------------------------------------------------- */

/* What is drawn: one tree, or with --link one for each path and target. */
typedef struct stage {
    const cli_options *options; /* of the whole picture */
    cli_tree *trees;
    uint32_t count;
    cli_lens *lens;
    cli_shot shot;
    cli_session sessions[CLI_TARGETS];
    cli_page page;              /* with --link */
    picture flats[CLI_TARGETS]; /* owned; layouts */
    cli_video *video;
    char note[CLI_NOTE]; /* what pictures have no room for, or "" */
} stage;

static bool write_page(const char *path, stage *s) {
    bool opaque = !(s->options->background[3] < 1);
    picture whole;
    if (!picture_make(s->options->size[0], s->options->size[1], &whole))
        return cli_fail("out of memory");
    bool ok = cli_page_draw(&s->page, s->trees, s->sessions, s->flats, &whole) &&
              cli_write_pixels(path, s->video, &whole, opaque);
    picture_free(&whole);
    return ok;
}

/* The tree whose colours show a number, if one does. */
static const cli_tree *scaled_tree(const stage *s) {
    return s->trees[0].value ? &s->trees[0] : &s->lens->tree;
}

static bool draw_legend(void *user, picture *p) {
    stage *s = user;
    return cli_tree_legend(scaled_tree(s), s->options->legend, p);
}

static bool write_view(const char *path, stage *s) {
    return cli_write_picture(path, s->video, &s->sessions[0], s->shot.background[3] >= 1,
                             draw_legend, s);
}

/* frame -1: the only one. */
static bool write_frame(stage *s, int64_t frame) {
    const char *paths[2] = {s->options->dump, s->options->out};
    bool ok = true;
    for (int i = 0; i < 2 && ok; i++) {
        if (!paths[i])
            continue;
        char *numbered = frame < 0 ? NULL : cli_frame_path(paths[i], (uint32_t)frame);
        const char *path = numbered ? numbered : paths[i];
        ok = (frame < 0 || numbered) && cli_go_on();
        if (ok && i == 0)
            ok = cli_dump(path, &s->sessions[0], &s->trees[0].scene, &s->shot, cli_tree_planes,
                          &s->trees[0]);
        else if (ok)
            ok = s->options->vessel.link ? write_page(path, s) : write_view(path, s);
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
    if (!camera_read_all(options->vessel.cameras, &out->poses, &out->count, error))
        return cli_fail("%s", error);
    if (options->frames && options->frames < out->count)
        out->count = options->frames;
    return true;
}

static bool draw_all(stage *s, uint32_t flags) {
    bool ok = true;
    for (uint32_t i = 0; ok && i < s->count; i++)
        ok = cli_session_render(&s->sessions[i], &s->shot, flags);
    return ok;
}

static bool number_all(stage *s) {
    return !s->options->vessel.link || !s->options->out ||
           cli_page_number(&s->page, s->trees, &s->shot, s->sessions);
}

static bool draw_views(stage *s, const view_list *views) {
    const cli_options *options = s->options;
    uint32_t flags = options->timings ? LAO_FRAME_TIMINGS : 0;
    cli_progress progress = {"rendering", options->out ? options->out : "", -1};
    const camera_pose first = s->shot.camera;
    bool ok = !flags || draw_all(s, flags);
    for (uint32_t i = 0; ok && i < views->count; i++) {
        if (views->poses)
            s->shot.camera = views->poses[i];
        else if (i > 0)
            cli_turn(&first, (double)i / views->count, &s->shot.camera);
        cli_shot_aim(&s->trees[0].scene, &s->shot);
        if (views->count > 1)
            cli_progress_show(&progress, i, views->count);
        bool last = options->vessel.last, shown = !last || i + 1 == views->count;
        ok = draw_all(s, flags) && number_all(s) &&
             (!shown || write_frame(s, views->numbered && !last ? (int64_t)i : -1));
    }
    cli_progress_end(&progress);
    return ok;
}

static bool draw(stage *s, const view_list *views) {
    const cli_options *options = s->options;
    cli_video video;
    if (!cli_is_video(options->out))
        return draw_views(s, views);
    if (!cli_video_open(&video, options->out, options->size[0], options->size[1],
                        options->fps ? options->fps : 25))
        return false;
    s->video = &video;
    bool ok = cli_video_close(&video, draw_views(s, views));
    s->video = NULL;
    return ok;
}

bool cli_write_camera(const cli_options *options, const camera_pose *camera) {
    if (!options->save_camera)
        return true;
    char *text = camera_print(camera);
    bool ok = text ? cli_write_text(options->save_camera, text) : cli_fail("out of memory");
    free(text);
    return ok;
}

static bool write_layout_picture(const cli_tree *tree, const char *path, const char *side) {
    bool opaque = !(tree->options->background[3] < 1);
    picture p;
    if (!cli_layout_picture(tree, &p))
        return false;
    bool ok = cli_tree_legend(tree, side, &p) && cli_write_pixels(path, NULL, &p, opaque);
    picture_free(&p);
    return ok;
}

/* Layouts do not turn with the camera: they are drawn once. */
static bool draw_flats(stage *s) {
    bool ok = true;
    for (uint32_t i = 0; ok && i < s->count; i++)
        ok = (picture_make(s->shot.width, s->shot.height, &s->flats[i]) ||
              cli_fail("out of memory")) &&
             cli_flat_draw(&s->trees[i], &s->flats[i]);
    return ok;
}

/* All pictures, the layout's too, have the size that was asked for. */
static bool check_legend(stage *s) {
    const cli_options *options = s->options;
    const char *name = options->out ? options->out : options->vessel.layout[2];
    bool page = options->vessel.link && options->out;
    const cli_tree *tree = page ? &s->trees[0] : scaled_tree(s);
    if (!name)
        return true;
    if (!cli_tree_legend_check(tree, page ? s->page.side : options->legend, options->size, s->note))
        return false;
    cli_legends_warn(options, name, s->note);
    return true;
}

static bool prepare(stage *s, const view_list *views) {
    const cli_options *options = s->options;
    const char *side = options->legend;
    bool scaled = side && strcmp(side, "off") != 0, ok = true;
    for (uint32_t i = 0; ok && i < s->count; i++)
        ok = cli_tree_prepare(&s->trees[i]);
    ok = ok && cli_lens_prepare(s->lens, &s->trees[0]);
    if (ok && scaled && !scaled_tree(s)->value)
        ok = cli_fail("--legend: these colours show no number; write --color radius, order or "
                      "distance, or the NAME of an attribute");
    ok = ok && cli_shot_make(s->trees[0].options, &s->trees[0].scene, &s->shot);
    if (ok && views->poses)
        s->shot.camera = views->poses[0];
    for (uint32_t i = 0; ok && i < s->count; i++)
        cli_tree_fit_period(&s->trees[i], &s->shot);
    if (ok)
        cli_lens_fit(s->lens, &s->trees[0], &s->shot);
    return ok && check_legend(s) && cli_write_camera(options, &s->shot.camera) &&
           (!options->vessel.link || !options->out || draw_flats(s));
}

/* For dumps, and for what the page numbers. */
static bool keeps_images(const stage *s, uint32_t tree) {
    return (s->options->dump && tree == 0) || (s->options->vessel.link && s->trees[tree].risk > 0);
}

static bool render(stage *s) {
    const cli_options *options = s->options;
    view_list views;
    const char *flat = options->vessel.layout[2];
    if (!options->out && !options->dump && !options->timings && !options->save_camera && !flat)
        return true;
    if (!read_views(options, &views))
        return false;
    bool ok =
        prepare(s, &views) && (!flat || write_layout_picture(&s->trees[0], flat, options->legend));
    if (ok && (options->out || options->dump || options->timings)) {
        for (uint32_t i = 0; ok && i < s->count; i++)
            ok = cli_session_open(&s->sessions[i], options->backend, &s->trees[i].scene, &s->shot,
                                  keeps_images(s, i) ? LAO_VIEW_KEEP_IMAGES : 0);
        ok = ok && draw(s, &views);
        if (ok && options->timings) {
            cJSON *json = cli_timings(&s->sessions[0], &s->shot);
            ok = json && cli_write_json(options->timings, json);
        }
    }
    free(views.poses);
    return ok;
}

/* ---- report ------------------------------------------------------------------------------ */

static void add_warnings(const cli_tree *tree, cJSON *list) {
    char text[256];
    for (uint32_t i = 0; cli_tree_warning(tree, i, text, sizeof text); i++) {
        if (list)
            cJSON_AddItemToArray(list, cJSON_CreateString(text));
        else
            cli_warn(tree->name, text);
    }
}

/* Segments that are at risk, counted as --tree does, and branches, by their numbers in the linked
 * view: the nearest first. False: reported. */
static bool add_target(const cli_tree *tree, cJSON *list) {
    cJSON *target = cJSON_CreateObject();
    float least, risk = (float)tree->risk;
    cli_tree_at_risk(tree, &least);
    cJSON_AddItemToArray(list, target);
    cJSON_AddStringToObject(target, tree->aim->path ? "path" : "target", tree->aim->text);
    cJSON_AddItemToObject(target, "least_distance",
                          least < SDV_FAR ? cli_json_float(least) : cJSON_CreateNull());
    if (!(tree->risk > 0))
        return true;
    cJSON_AddItemToObject(target, "risk", cli_json_float(risk));
    cJSON *segments = cJSON_AddArrayToObject(target, "segments");
    for (uint32_t i = 0; i < tree->cone_count; i++) {
        if (!(tree->cone_distances[i] < risk))
            continue;
        cJSON *item = cJSON_CreateObject();
        cJSON_AddNumberToObject(item, "segment", i);
        cJSON_AddItemToObject(item, "distance", cli_json_float(tree->cone_distances[i]));
        cJSON_AddItemToArray(segments, item);
    }
    uint32_t count;
    cli_branch *at_risk = cli_branches_at_risk(tree, &count);
    cJSON *branches = cJSON_AddArrayToObject(target, "branches");
    for (uint32_t i = 0; at_risk && i < count; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddNumberToObject(item, "number", i + 1);
        cJSON_AddNumberToObject(item, "id", tree->reduced.ids[at_risk[i].node]);
        cJSON_AddItemToObject(item, "distance", cli_json_float(at_risk[i].distance));
        cJSON_AddItemToArray(branches, item);
    }
    free(at_risk);
    return at_risk != NULL;
}

static bool report(const stage *s) {
    const cli_tree *tree = &s->trees[0];
    const sdv_tree_info *info = &tree->vessel.tree.info;
    cJSON *json = cJSON_CreateObject();
    bool ok = true;
    cJSON_AddStringToObject(json, tree->source->path ? "path" : "scene", tree->name);
    if (tree->mesh.vertex_count) {
        cJSON_AddNumberToObject(json, "vertices", tree->mesh.vertex_count);
        cJSON_AddNumberToObject(json, "triangles", tree->mesh.triangle_count);
    }
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
        cJSON_AddStringToObject(grid, "by", tree->by_device ? "device" : "cpu");
        if (!tree->by_device) { /* else the device alone knows */
            cJSON_AddNumberToObject(grid, "listed", tree->grid.id_count);
            cJSON_AddItemToObject(grid, "seconds", cli_json_float((float)tree->grid_seconds));
        }
    }
    if (tree->aim) {
        float least;
        cli_tree_at_risk(tree, &least);
        cJSON_AddItemToObject(json, "least_distance",
                              least < SDV_FAR ? cli_json_float(least) : cJSON_CreateNull());
        cJSON *targets = cJSON_AddArrayToObject(json, "targets");
        for (uint32_t i = 0; ok && i < s->count; i++)
            ok = add_target(&tree[i], targets);
    }
    cJSON *warnings = cJSON_AddArrayToObject(json, "warnings");
    add_warnings(tree, warnings);
    if (*s->note)
        cJSON_AddItemToArray(warnings, cJSON_CreateString(s->note));
    if (ok)
        return cli_write_json(NULL, json);
    cJSON_Delete(json);
    return false;
}

/* With --link the trees are drawn in panels of the page. */
static bool plan(stage *s, cli_options *panel) {
    const cli_vessel_options *o = &s->options->vessel;
    const cli_source *source = s->options->file_count ? &s->options->files[0] : &s->options->all;
    const char *color = source->color ? source->color : o->target_count ? "distance" : "layout";
    bool scaled = strcmp(color, "layout") != 0 && !cli_parse_color(color, (double[4]){0});
    if (!o->link)
        return true;
    if (!cli_page_make(s->options, scaled, &s->page))
        return false;
    memcpy(panel->size, s->page.panel, sizeof panel->size);
    return true;
}

static bool run(stage *s) {
    const cli_vessel_options *o = &s->options->vessel;
    const cli_tree *tree = &s->trees[0];
    if ((o->tree && !write_tree(tree, o->tree)) ||
        (o->layout[0] && !write_layout(tree, o->layout[0], true)) ||
        (o->layout[1] && !write_layout(tree, o->layout[1], false)) || !render(s))
        return false;
    if (s->options->json)
        return report(s);
    add_warnings(tree, NULL);
    return true;
}

int cli_vessel(const cli_options *options) {
    const cli_vessel_options *o = &options->vessel;
    const char *outputs[8] = {options->out, options->dump, options->timings, options->save_camera,
                              o->tree,      o->layout[0],  o->layout[1],     o->layout[2]};
    cli_options panel = *options; /* of one tree's picture */
    cli_tree trees[CLI_TARGETS];
    cli_lens lens;
    stage s;
    for (int i = 0; i < 8; i++) {
        if (!cli_writable(outputs[i]))
            return CLI_FAILED;
    }
    memset(&s, 0, sizeof s);
    memset(trees, 0, sizeof trees);
    memset(&lens, 0, sizeof lens);
    s.options = options;
    s.trees = trees;
    s.lens = &lens;
    bool ok = plan(&s, &panel);
    cli_lens_plan(&panel, &lens);
    do
        ok = ok && cli_tree_load(&panel, NULL, s.count, &trees[s.count]);
    while (++s.count < o->target_count && ok);
    ok = ok && cli_lens_load(&lens, &trees[0]) && run(&s);
    for (uint32_t i = 0; i < s.count; i++) {
        cli_session_close(&s.sessions[i]);
        picture_free(&s.flats[i]);
        cli_tree_free(&trees[i]);
    }
    cli_tree_free(&lens.tree);
    cli_page_free(&s.page);
    return ok ? CLI_OK : CLI_FAILED;
}
