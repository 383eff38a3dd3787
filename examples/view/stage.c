/* From a document to the window: the library is given what a host lends it, here and in the
 * backend's file alone. */
#include "view.h"

#include "commands.h"
#include "image.h"
#include "orbit.h"
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- opening ----------------------------------------------------------------------------- */

static void find_bounds(view *v) {
    bool any = false;
    for (uint32_t s = 0; s < v->doc->scene->count; s++) {
        const io_lines *lines = &v->doc->scene->sets[s].lines;
        for (size_t i = 0; i < 3 * (size_t)lines->point_count && !v->doc->scene->sets[s].overlay;
             i++) {
            size_t k = i % 3;
            float value = lines->points[i];
            if (!isfinite(value))
                continue;
            v->bounds[0][k] = any && v->bounds[0][k] < value ? v->bounds[0][k] : value;
            v->bounds[1][k] = any && v->bounds[1][k] > value ? v->bounds[1][k] : value;
            any = any || k == 2;
        }
    }
}

void stage_close(view *v) {
    film_cancel(v);
    compare_stop(v->compare);
    v->compare = NULL;
    v->comparison.ready = false;
    if (v->open) {
        v->window.backend->wait(&v->window);
        v->session.vk = NULL; /* the window's */
        cli_session_close(&v->session);
    }
    v->open = false;
    document_close(v->doc);
    v->doc = NULL;
    memset(v->drawn, 0, sizeof v->drawn);
    v->moving_view.id = 0;
    v->picked_lines.id = 0;
    memset(&v->picked, 0, sizeof v->picked);
    memset(&v->hovered, 0, sizeof v->hovered);
}

static bool start(view *v) {
    lao_backend functions;
    lao_view_desc small = {64, 64, 0};
    memset(&v->session, 0, sizeof v->session);
    v->session.backend = v->window.backend->name;
    if (!v->window.backend->lend(&v->window, &functions))
        return false;
    v->open = true;
    if (v->window.vk) {
        ui_vulkan from;
        window_vk_interface(&v->window, &from);
        v->session.vk = from.host;
    }
    return cli_session_start(&v->session, &functions, v->doc->scene, &v->shot, 0) &&
           lao_view_create(v->session.context, &small, &v->moving_view) == LAO_OK;
}

bool stage_open(view *v, document *doc) {
    stage_close(v);
    v->doc = doc;
    v->need = NEEDS_NOTHING;
    v->frame_ms = 0;
    v->warm = false;
    v->shot = v->fitted = doc->shot;
    v->aimed = doc->shot.camera;
    find_bounds(v);
    v->dirty = true;
    v->unfitted = !doc->options.camera || doc->added;
    v->comparison.looks[0].index = v->comparison.looks[1].index = -1;
    double first, length;
    player_range(v, &first, &length);
    v->player.speed = length > 0 ? length / 4 : 100;
    if (start(v)) {
        trace(v, "opened %s %s", doc->verb, document_name(doc));
        return true;
    }
    stage_close(v);
    return false;
}

/* Words, one a line, which are freed, and files behind them. */
static void open_text(view *v, char *words, const char *const *files, uint32_t count) {
    enum { MOST = 512 };
    const char *list[MOST];
    uint32_t said = 0, added = 0;
    for (char *at = words; at && *at && said < MOST; at += strcspn(at, "\n")) {
        if (*at == '\n')
            *at++ = '\0';
        list[said++] = at;
    }
    while (files && said + added < MOST && added < count) {
        list[said + added] = files[added];
        added++;
    }
    if (words)
        loader_add(v->loader, list, said + added, added);
    free(words);
}

void stage_answer(view *v) {
    document_need need = v->need;
    if (ui_active())
        return;
    v->need = NEEDS_NOTHING;
    if (need == NEEDS_OPENING) {
        open_text(v, document_words(v->doc, &v->shot), NULL, 0);
    } else if (need == NEEDS_MEASURES) {
        loader_stop(v->loader);
        document_wish_measured(v->doc);
        loader_measure(v->loader, v->doc);
    }
}

void stage_add(view *v, const char *const *files, uint32_t count) {
    v->hands.reopening = false;
    if (v->open && document_joins(v->doc))
        open_text(v, document_joined(v->doc, &v->shot), files, count);
    else
        loader_start(v->loader, files, count);
}

void stage_remove(view *v, const char *file) {
    v->hands.reopening = false;
    open_text(v, document_without(v->doc, &v->shot, file), NULL, 0);
}

/* ---- what the host draws ----------------------------------------------------------------- */

static int up_axis(const view *v) {
    const float *up = v->doc->scene->up;
    return fabsf(up[2]) >= fabsf(up[0]) && fabsf(up[2]) >= fabsf(up[1]) ? 2
           : fabsf(up[1]) >= fabsf(up[0])                               ? 1
                                                                        : 0;
}

void stage_up(const view *v, double axis[3]) {
    int k = v->doc ? up_axis(v) : 2;
    axis[0] = axis[1] = axis[2] = 0;
    axis[k] = v->doc && v->doc->scene->up[k] < 0 ? -1 : 1;
}

static void multiply(const float a[16], const float b[16], float out[16]) {
    for (int i = 0; i < 16; i++) {
        double sum = 0;
        for (int k = 0; k < 4; k++)
            sum += (double)a[4 * k + i % 4] * (double)b[4 * (i / 4) + k];
        out[i] = (float)sum;
    }
}

/* The corner of the data from which the axes start: on the ground. */
static void corner_of(const view *v, float corner[3]) {
    double up[3];
    stage_up(v, up);
    for (int k = 0; k < 3; k++)
        corner[k] = up[k] < 0 ? v->bounds[1][k] : v->bounds[0][k];
}

static const float axis_colors[3][4] = {
    {0.80f, 0.30f, 0.25f, 1}, {0.36f, 0.62f, 0.30f, 1}, {0.25f, 0.42f, 0.80f, 1}};

const float *stage_axis(const view *v, int k, double end[3]) {
    float corner[3];
    corner_of(v, corner);
    for (int i = 0; i < 3; i++)
        end[i] = v->doc->scene->origin[i] + (double)corner[i];
    end[k] += 0.5 * (double)v->shot.sphere[3];
    return axis_colors[k];
}

static void make_axes(const view *v, const float clip[16], window_box bars[3]) {
    float corner[3], radius = v->shot.sphere[3], thick = 0.006f * radius;
    corner_of(v, corner);
    memset(bars, 0, 3 * sizeof *bars);
    for (int i = 0; i < 3; i++) {
        memcpy(bars[i].clip, clip, sizeof bars[i].clip);
        memcpy(bars[i].color, axis_colors[i], sizeof axis_colors[i]);
        for (int k = 0; k < 3; k++) {
            bars[i].lower[k] = corner[k] - thick;
            bars[i].upper[k] = corner[k] + (i == k ? 0.5f * radius : thick);
        }
    }
}

/* 1, 10, 100 ... mm, so that ten squares are about as large as the scene. */
static float ground_step(const view *v) {
    return powf(10, floorf(log10f(fmaxf(v->shot.sphere[3], 1e-3f))) - 1) * 2;
}

static window_ground make_ground(const view *v, const float clip[16]) {
    window_ground g;
    int up = up_axis(v);
    float corner[3], step = ground_step(v);
    float dark = v->shot.background[0] + v->shot.background[1] + v->shot.background[2] > 1.5f;
    memset(&g, 0, sizeof g);
    memcpy(g.clip, clip, sizeof g.clip);
    corner_of(v, corner);
    for (int k = 0; k < 3; k++)
        g.middle[k] = roundf(v->shot.sphere[k] / (10 * step)) * 10 * step;
    g.middle[up] = corner[up] + (v->doc->scene->up[up] < 0 ? 0.01f : -0.01f) * v->shot.sphere[3];
    g.middle[3] = step;
    g.right[(up + 1) % 3] = 1;
    g.right[3] = 1.8f * v->shot.sphere[3];
    g.up[(up + 2) % 3] = 1;
    g.color[0] = g.color[1] = g.color[2] = dark > 0 ? 0.25f : 0.8f;
    g.color[3] = 0.6f;
    return g;
}

/* ---- frames ------------------------------------------------------------------------------ */

static bool fit_view(view *v, lao_view of, uint32_t width, uint32_t height) {
    return lao_view_resize(v->session.context, of, width, height) == LAO_OK;
}

static bool has_contours(const document *doc) {
    const double *widths = doc->options.surface.contours;
    return doc->command == CLI_SURFACE && (widths[0] > 0 || widths[1] > 0);
}

bool stage_aim(view *v, const cli_shot *shot) {
    cli_wall *wall = &v->doc->wall;
    bool ok = true;
    if (v->doc->command == CLI_SURFACE)
        cli_wall_focus(wall, shot);
    if (!has_contours(v->doc) || memcmp(&v->aimed, &shot->camera, sizeof v->aimed) == 0)
        return true;
    compare_lock(v->compare);
    ok = cli_wall_aim(wall, shot);
    compare_unlock(v->compare);
    for (int i = 0; i < 2 && ok; i++) {
        if (wall->contours[i])
            ok = cli_session_renew(&v->session, v->doc->scene, wall->contours[i]);
    }
    v->aimed = shot->camera;
    return ok;
}

/* Sets of a small picture: one sample per pixel. Kept by the caller for the frame. */
static void lighten(const view *v, lao_set *sets, lao_settings *settings, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        sets[i] = v->session.sets[i];
        settings[i] = *sets[i].settings;
        settings[i].supersampling = 1;
        settings[i].set |= LAO_SET(supersampling);
        sets[i].settings = &settings[i];
    }
}

/* The selected line in a colour of its own, wider than it is. */
static uint32_t add_selection(const view *v, lao_set *set, lao_settings *settings) {
    if (!v->picked_lines.id)
        return 0;
    const cli_set *of = &v->doc->scene->sets[v->picked.set];
    memset(set, 0, sizeof *set);
    *settings = of->settings;
    settings->width = 2 * lao_settings_filled(&of->settings).width;
    settings->trail = LAO_TRAIL_NONE;
    settings->occlusion = 0;
    settings->set |= LAO_SET(width) | LAO_SET(trail) | LAO_SET(occlusion);
    set->lines = v->picked_lines;
    set->settings = settings;
    return 1;
}

static bool render(view *v, cli_shot *shot, bool small) {
    window *w = &v->window;
    uint32_t count = v->session.set_count;
    lao_set *sets = cli_new(count + 1u, sizeof *sets);
    lao_settings *settings = cli_new(count + 1u, sizeof *settings);
    lao_image color, depth;
    lao_import import;
    lao_frame frame;
    window_box bars[3];
    float clip[16];
    bool own = v->ground || v->axes;
    int slot = small ? SLOT_MOVING : SLOT_REST;
    if (!sets || !settings) {
        free(sets);
        free(settings);
        return false;
    }
    memset(&color, 0, sizeof color);
    memset(&depth, 0, sizeof depth);
    cli_shot_aim(v->doc->scene, shot);
    if (small && v->doc->command == CLI_SURFACE) /* contours are made anew when it rests */
        cli_wall_focus(&v->doc->wall, shot);
    else
        stage_aim(v, shot);
    multiply(shot->projection, shot->view, clip);
    make_axes(v, clip, bars);
    memcpy(sets, v->session.sets, count * sizeof *sets);
    if (small)
        lighten(v, sets, settings, count);
    cli_session_frame(&v->session, shot, 0, &frame);
    frame.sets = sets;
    frame.set_count = count + add_selection(v, &sets[count], &settings[count]);
    frame.view = small ? v->moving_view : v->session.view;
    bool ok = fit_view(v, frame.view, shot->width, shot->height) &&
              w->backend->canvas(w, slot, shot->width, shot->height, shot->background, bars,
                                 v->axes ? 3 : 0, &color, &depth, &frame.commands);
    /* quote frame */
    import.image = "host_depth";
    import.source = depth;
    frame.target = color;
    frame.imports = &import;
    frame.import_count = own ? 1 : 0;
    if (own)
        frame.background[3] = 0; /* what the host has drawn shows between the lines */
    ok = ok && lao_render(v->session.context, &frame) == LAO_OK;
    /* quote end */
    if (ok && v->ground) {
        window_ground g = make_ground(v, clip);
        w->backend->ground(w, slot, &g);
    } else if (!ok) {
        w->backend->drop(w);
    }
    free(sets);
    free(settings);
    return ok;
}

void stage_fit_first(view *v) {
    if (!v->open || !v->unfitted || v->picture.width < 1 || v->picture.height < 1)
        return;
    stage_fit(v);
    v->fitted.camera = v->shot.camera;
    v->unfitted = false;
}

void stage_draw(view *v) {
    cli_shot shot = v->shot;
    bool small = v->steady.on && v->steady.moving;
    double scale = small ? (double)v->steady.scale : 1;
    v->dirty = v->dirty && v->open; /* there is nothing to draw, and nothing to stay awake for */
    if (!v->dirty || v->picture.width < 1 || v->picture.height < 1)
        return;
    shot.width = (uint32_t)fmax(1, round(v->picture.width * scale));
    shot.height = (uint32_t)fmax(1, round(v->picture.height * scale));
    v->dirty = false;
    bool ok = render(v, &shot, small);
    int *drawn = v->drawn[small ? SLOT_MOVING : SLOT_REST];
    drawn[0] = ok ? (int)shot.width : 0;
    drawn[1] = ok ? (int)shot.height : 0;
    v->frames++;
    trace(v, "frame %u %ux%u %s", v->frames, shot.width, shot.height, ok ? "ok" : "failed");
}

void stage_show(view *v) {
    int slot = v->steady.on && v->steady.moving ? SLOT_MOVING : SLOT_REST;
    window_rect from = {0, 0, v->drawn[slot][0], v->drawn[slot][1]};
    if (v->open && from.width > 0 && v->picture.width > 0 && v->picture.height > 0)
        v->window.backend->show(&v->window, slot, from, v->picture);
}

void stage_changed(view *v, bool reach) {
    cli_shot fresh;
    camera_pose camera = v->shot.camera;
    float time = v->shot.time;
    if (!v->open)
        return;
    if (reach && cli_shot_make(&v->doc->options, v->doc->scene, &fresh)) {
        v->shot = fresh;
        v->shot.camera = camera;
        v->shot.time = time;
    }
    v->dirty = true;
}

void stage_time(view *v) {
    lao_object_desc update;
    bool surface = v->open && v->doc->command == CLI_SURFACE;
    compare_lock(v->compare);
    bool changed = surface && cli_wall_time(&v->doc->wall, (double)v->shot.time, &update);
    compare_unlock(v->compare);
    if (changed)
        lao_object_update(v->session.context, v->session.sets[0].object, &update);
    v->dirty = true;
}

void stage_relight(view *v, bool ok) {
    compare_lock(v->compare);
    document_show_measured(v->doc, ok);
    compare_unlock(v->compare);
    stage_time(v);
    trace(v, "measured %g", v->doc->wall.near.beta);
}

void stage_fit(view *v) {
    camera_fit fit;
    camera_pose *pose = &v->shot.camera;
    float direction[3], up[3];
    if (!v->doc)
        return;
    for (int k = 0; k < 3; k++) {
        direction[k] = (float)(pose->center[k] - pose->eye[k]);
        up[k] = (float)pose->up[k];
    }
    camera_fit_begin(&fit, direction, up, (double)v->picture.width / fmax(1, v->picture.height),
                     0.05, pose->fovy);
    for (uint32_t s = 0; s < v->doc->scene->count; s++) {
        const cli_set *set = &v->doc->scene->sets[s];
        if (!set->overlay)
            camera_fit_add(&fit, set->lines.points, set->lines.point_count);
    }
    camera_fit_end(&fit, pose);
    for (int k = 0; k < 3; k++) {
        pose->eye[k] += v->doc->scene->origin[k];
        pose->center[k] += v->doc->scene->origin[k];
    }
    v->dirty = true;
}

bool stage_place(const view *v, const double at[3], float place[2]) {
    cli_shot shot = v->shot;
    float clip[16], p[4];
    if (!v->open || v->picture.width < 1 || v->picture.height < 1)
        return false;
    shot.width = (uint32_t)v->picture.width;
    shot.height = (uint32_t)v->picture.height;
    cli_shot_aim(v->doc->scene, &shot);
    multiply(shot.projection, shot.view, clip);
    for (int i = 0; i < 4; i++) {
        double sum = (double)clip[12 + i];
        for (int k = 0; k < 3; k++)
            sum += (double)clip[4 * k + i] * (at[k] - v->doc->scene->origin[k]);
        p[i] = (float)sum;
    }
    if (!(p[3] > 0))
        return false;
    place[0] = (float)v->picture.x + (0.5f + 0.5f * p[0] / p[3]) * (float)v->picture.width;
    place[1] = (float)v->picture.y + (0.5f - 0.5f * p[1] / p[3]) * (float)v->picture.height;
    return true;
}

/* ---- selection --------------------------------------------------------------------------- */

void stage_select(view *v) {
    lao_lines_desc desc;
    v->dirty = v->dirty || v->picked_lines.id || v->picked.kind == PICKED_LINE;
    if (v->picked_lines.id)
        lao_lines_destroy(v->session.context, v->picked_lines);
    v->picked_lines.id = 0;
    if (v->picked.kind != PICKED_LINE)
        return;
    const io_lines *lines = &v->doc->scene->sets[v->picked.set].lines;
    uint32_t first = lines->offsets[v->picked.line];
    memset(&desc, 0, sizeof desc);
    desc.point_count = lines->offsets[v->picked.line + 1] - first;
    desc.line_count = 1;
    desc.points = lines->points + 3 * (size_t)first;
    desc.color[0] = 1;
    desc.color[1] = 0.35f;
    desc.color[3] = 1;
    lao_lines_create(v->session.context, &desc, &v->picked_lines);
}

/* ---- pictures in files ------------------------------------------------------------------- */

bool stage_settled(const view *v, const char *path) {
    return !loader_measures(v->loader) ||
           cli_fail("%s: distances to the flow are being measured; save it when they are", path);
}

bool stage_save(view *v, const char *path, uint32_t width, uint32_t height) {
    cli_session session = v->session;
    cli_shot shot = v->shot;
    lao_view_desc size = {width, height, 0};
    shot.width = width;
    shot.height = height;
    if (!stage_settled(v, path))
        return false;
    cli_shot_aim(v->doc->scene, &shot);
    stage_aim(v, &shot);
    v->window.backend->wait(&v->window);
    memset(&session.view, 0, sizeof session.view);
    bool ok =
        lao_view_create(session.context, &size, &session.view) == LAO_OK &&
        cli_session_render(&session, &shot, 0) &&
        cli_write_picture(path, NULL, &session, shot.background[3] >= 1, document_surround, v->doc);
    if (session.view.id)
        lao_view_destroy(session.context, session.view);
    trace(v, "%s %s", ok ? "saved" : "unsaved", path);
    return ok;
}
