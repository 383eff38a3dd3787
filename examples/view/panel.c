/* The panels: at the left what is open, how it looks and from where; below the player; messages
 * over the picture. Nothing overlaps the picture but those. */
#include "view.h"

#include "image.h"
#include "orbit.h"
#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- scene ------------------------------------------------------------------------------- */

static void open_words(view *v, const char *const *words, uint32_t count) {
    v->hands.reopening = false;
    loader_start(v->loader, words, count);
}

/* A line as a shell would take it apart: words, and '...' or "..." around those with blanks. */
static void open_line(view *v) {
    static const uint32_t most = 256;
    const char *words[256];
    uint32_t count = 0;
    char copy[sizeof v->words], *text = copy, *to = copy;
    memcpy(copy, v->words, sizeof copy);
    while (*text && count < most) {
        char quote = 0;
        text += strspn(text, " ");
        if (!*text)
            break;
        words[count++] = to = text;
        for (; *text && (quote || *text != ' '); text++) {
            if (quote ? *text == quote : *text == '\'' || *text == '"')
                quote = quote ? 0 : *text;
            else
                *to++ = *text;
        }
        if (*text)
            text++;
        *to = '\0';
    }
    bool named = count && (strcmp(words[0], "lineao") == 0 || strcmp(words[0], "./run") == 0);
    open_words(v, words + named, count - named);
}

static void embedded(view *v) {
    uint32_t count;
    const char *const *names = scene_names(&count);
    const char *const surfaces[] = {"aorta", "aneurysm", "liver", "bone"};
    const char *words[3] = {"render", "--scene", NULL};
    ui_text_dim("Lines");
    ui_widget_name("lines");
    for (uint32_t i = 0; i < count; i++) {
        words[2] = names[i];
        if (ui_item(names[i], false))
            open_words(v, words, 3);
        ui_help(scene_help(names[i]));
    }
    ui_text_dim("Vessel tree");
    words[0] = "vessel";
    ui_widget_name("tree");
    if (ui_item("liver", false))
        open_words(v, words, 1);
    ui_text_dim("Surfaces");
    ui_group(1);
    words[0] = "surface";
    ui_widget_name("surface");
    for (int i = 0; i < 4; i++) {
        words[2] = surfaces[i];
        if (ui_item(surfaces[i], false))
            open_words(v, words, 3);
    }
    ui_widget_name(NULL);
    ui_group_end();
}

/* One of several files, but no volume that is made of several. */
static bool can_go(const document *doc, const cli_set *set) {
    return doc->command == CLI_RENDER && doc->options.file_count > 1 && set->source->path &&
           set->name == set->source->path;
}

static void describe(view *v) {
    const cli_scene *scene = v->doc->scene;
    char text[512];
    for (uint32_t i = 0; i < scene->count; i++) {
        const cli_set *set = &scene->sets[i];
        if (set->tree) {
            const sdv_tree_info *info = &set->tree->vessel.tree.info;
            snprintf(text, sizeof text, "%s: tree of %u nodes, %u segments, %u root%s", set->name,
                     info->nodes, info->segments, info->roots, info->roots == 1 ? "" : "s");
        } else if (set->wall) {
            snprintf(text, sizeof text, "%s: surface of %u vertices, %u triangles", set->name,
                     set->wall->mesh.vertex_count, set->wall->mesh.triangle_count);
        } else {
            snprintf(text, sizeof text, "%s: %u lines, %u points%s%s", set->name,
                     set->lines.line_count, set->lines.point_count,
                     set->value ? ", coloured by " : "", set->value ? set->value : "");
        }
        ui_text_wrapped(text);
        ui_group((int)i);
        if (can_go(v->doc, set) && ui_small_button("Take away"))
            stage_remove(v, set->source->path);
        ui_group_end();
    }
}

static void list_keys(void) {
    const char *key, *help;
    ui_text_wrapped("Drag: turn. Shift or middle button: move. Right button or wheel: nearer, "
                    "farther. Rest: what is there? Click: keep it, and do something with it.");
    if (!ui_table("keys", 2))
        return;
    for (uint32_t i = 0; i < input_keys(UINT32_MAX, &key, &help); i++) {
        input_keys(i, &key, &help);
        ui_cell();
        ui_text(key);
        ui_cell();
        ui_text_wrapped(help);
    }
    ui_table_end();
}

static void scene_tab(view *v) {
    char text[MESSAGE_SIZE];
    float part;
    if (loader_busy(v->loader, text, &part)) {
        ui_text_wrapped(text);
        ui_progress(part, NULL);
        if (ui_button("Cancel"))
            loader_cancel(v->loader);
        ui_line();
    }
    if (v->open)
        describe(v);
    ui_space();
    ui_text_dim("Files dropped on the window join what is open. Names typed here, with flags of "
                "lineao render, vessel or surface, take its place.");
    ui_width(-1);
    if (ui_input("##words", v->words, sizeof v->words, "FILE... or render FILE --color fa"))
        open_line(v);
    if (ui_section("Scenes made by code", true))
        embedded(v);
    if (ui_section("Pointer and keys (F1)", false))
        list_keys();
}

/* ---- view -------------------------------------------------------------------------------- */

static void bookmarks(view *v) {
    char label[64], error[CAMERA_ERROR_SIZE];
    ui_text_dim("Bookmarks");
    for (int i = 0; i < BOOKMARKS; i++) {
        snprintf(label, sizeof label, "%d%s##bookmark %d", i + 1, v->bookmarked[i] ? "" : "+",
                 i + 1);
        if (i)
            ui_same_line();
        if (ui_small_button(label)) {
            if (v->bookmarked[i])
                v->shot.camera = v->bookmarks[i];
            else
                v->bookmarks[i] = v->shot.camera;
            v->bookmarked[i] = true;
            v->dirty = true;
        }
        ui_help(v->bookmarked[i] ? "go there" : "keep this view");
    }
    ui_width(-1);
    ui_input("##bookmark file", v->bookmark_path, sizeof v->bookmark_path, "camera.json");
    if (ui_button("Save view") && camera_write(v->bookmark_path, &v->shot.camera, error))
        trace(v, "saved %s", v->bookmark_path);
    ui_help("as a file for --camera");
    ui_same_line();
    if (ui_button("Load views")) {
        camera_pose *poses;
        uint32_t count;
        if (!camera_read_all(v->bookmark_path, &poses, &count, error)) {
            messages_add(v->messages, true, error);
        } else {
            for (uint32_t i = 0; i < count && i < BOOKMARKS; i++) {
                v->bookmarks[i] = poses[i];
                v->bookmarked[i] = true;
            }
            v->shot.camera = poses[0];
            v->dirty = true;
            free(poses);
        }
    }
    ui_help("one camera or an array of them");
}

static void view_tab(view *v) {
    static const char *const names[] = {"axial", "coronal", "sagittal", "iso"};
    bool orthographic = !(v->shot.camera.fovy > 0);
    ui_text_dim("Look from");
    for (int i = 0; i < 4; i++) {
        float direction[3], up[3];
        if (i)
            ui_same_line();
        if (ui_button(names[i]) && camera_view(names[i], direction, up)) {
            orbit_look(&v->shot.camera, direction, up);
            v->dirty = true;
        }
    }
    if (ui_button("Fit"))
        stage_fit(v);
    ui_same_line();
    if (ui_button("First view")) {
        v->shot.camera = v->fitted.camera;
        v->dirty = true;
    }
    if (ui_toggle("Orthographic", &orthographic)) {
        orbit_project(&v->shot.camera, orthographic);
        v->dirty = true;
    }
    ui_toggle("Turntable", &v->turntable);
    ui_help("what is up stays up; off: turn freely");
    v->dirty = ui_toggle("Ground", &v->ground) || v->dirty;
    ui_same_line();
    v->dirty = ui_toggle("Axes", &v->axes) || v->dirty;
    ui_help("x red, y green, z blue: half the size of the scene");
    ui_space();
    bookmarks(v);
    ui_space();
    ui_text_dim("While the view moves");
    ui_toggle("Keep it steady", &v->steady.on);
    ui_help("fewer pixels and samples while the view moves; all of them when it rests");
    if (v->steady.on) {
        ui_width(-1);
        ui_slider("##frame time", &v->steady.wanted, 10, 500, "%.0f ms per frame");
    }
}

/* ---- picture ----------------------------------------------------------------------------- */

static void picture_tab(view *v) {
    cli_shot shot = v->shot;
    float width;
    ui_text_dim("The picture alone, without ground and axes");
    ui_width(-1);
    ui_input("##picture file", v->shot_path, sizeof v->shot_path, "picture.png");
    ui_width_left(&width);
    ui_width(0.36f * width);
    ui_slider_int("##wide", &v->shot_size[0], 16, 8192, "%d");
    ui_same_line();
    ui_label("x");
    ui_same_line();
    ui_width(0.36f * width);
    ui_slider_int("##high", &v->shot_size[1], 16, 8192, "%d");
    ui_help("Ctrl and a click: type the number");
    if (ui_button("As in the window")) {
        v->shot_size[0] = v->picture.width;
        v->shot_size[1] = v->picture.height;
    }
    ui_same_line();
    if (ui_button("Save picture"))
        stage_save(v, v->shot_path, (uint32_t)v->shot_size[0], (uint32_t)v->shot_size[1]);
    ui_help("the same bits as the command line below writes");
    ui_space();
    shot.width = (uint32_t)v->shot_size[0];
    shot.height = (uint32_t)v->shot_size[1];
    char *command = document_command(v->doc, &shot, v->shot_path);
    ui_text_dim("The same without a window");
    ui_text_wrapped(command ? command : "");
    if (ui_button("Copy command line") && command) {
        ui_copy(command);
        trace(v, "command %s", command);
    }
    free(command);
    ui_space();
    film_widgets(v);
}

/* ---- all of it --------------------------------------------------------------------------- */

/* What was clicked: words below, a mark in the picture. */
static void picked_text(view *v, window_rect place) {
    float height = 9 * ui_text_height();
    if (v->picked.kind == PICKED_NOTHING)
        return;
    ui_panel("Picked", (window_rect){place.x, place.y + place.height - (int)height, place.width,
                                     (int)height});
    ui_line();
    ui_disable(v->film.running);
    if (ui_small_button("Look there")) {
        for (int k = 0; k < 3; k++) {
            v->shot.camera.eye[k] += v->picked.at[k] - v->shot.camera.center[k];
            v->shot.camera.center[k] = v->picked.at[k];
        }
        v->dirty = true;
    }
    ui_help("turn around this place");
    ui_same_line();
    if (ui_small_button("Forget")) {
        memset(&v->picked, 0, sizeof v->picked);
        v->hands.pathing = false;
        stage_select(v);
    }
    hands_buttons(v);
    ui_disable_end();
    ui_text_wrapped(v->picked.text);
    ui_panel_end();
}

static bool has_document(const view *v) {
    return v->open;
}

static bool has_tree(const view *v) {
    return v->open && picked_tree(v->doc->scene, &v->picked);
}

static const struct tab {
    const char *name;
    void (*draw)(view *v);
    bool (*there)(const view *v); /* NULL: always */
} tabs[] = {{"Scene", scene_tab, NULL},
            {"Look", panel_settings, has_document},
            {"View", view_tab, has_document},
            {"Save", picture_tab, has_document},
            {"Compare", panel_compare, has_document},
            {"Tree", panel_tree, has_tree}};

static void left(view *v, window_rect place) {
    ui_panel("Panel", place);
    ui_disable(v->film.running);
    if (ui_tabs("tabs")) {
        for (size_t i = 0; i < sizeof tabs / sizeof *tabs; i++) {
            if ((!tabs[i].there || tabs[i].there(v)) && ui_tab(tabs[i].name)) {
                tabs[i].draw(v);
                ui_tab_end();
            }
        }
        ui_tabs_end();
    }
    ui_disable_end();
    ui_panel_end();
}

static void keys_dialog(view *v) {
    if (!v->keys)
        return;
    if (ui_dialog("Pointer and keys", v->picture, &v->keys)) {
        list_keys();
        v->keys = !ui_button("Close##keys") && v->keys;
    }
    ui_panel_end();
}

/* The last things that were said, until they are closed. */
static void said(view *v) {
    char text[MESSAGE_SIZE];
    bool failure, open = true;
    uint32_t count = messages_count(v->messages);
    if (count == v->seen)
        return;
    window_rect place = v->picture;
    if (ui_dialog("Messages", place, &open)) {
        for (uint32_t i = 0; i < count - v->seen && i < 6; i++) {
            if (!messages_get(v->messages, i, &failure, text))
                break;
            if (failure)
                ui_text_error(text);
            else
                ui_text_wrapped(text);
        }
        open = !ui_button("Close") && open;
    }
    ui_panel_end();
    if (!open)
        v->seen = count;
}

/* "1 sample per pixel", or how many pixels there are while the view moves. */
static void tell_samples(const view *v, char text[64]) {
    const lao_settings settings = lao_settings_filled(&v->doc->scene->sets[0].settings);
    int samples = (int)(settings.supersampling * settings.supersampling);
    if (v->steady.on && v->steady.moving)
        snprintf(text, 64, "drawn at %.0f %% while it moves", 100 * (double)v->steady.scale);
    else
        snprintf(text, 64, "%d sample%s per pixel", samples, samples > 1 ? "s" : "");
}

/* The first of these that fit; empty ones are passed over. */
static void status_line(const char *const *parts, int count, float width) {
    char text[256] = "";
    for (int i = 0; i < count; i++) {
        size_t used = strlen(text);
        if (*parts[i])
            snprintf(text + used, sizeof text - used, "%s%s", used ? "   " : "", parts[i]);
        if (used && ui_text_width(text) > width)
            text[used] = '\0';
    }
    ui_text(text);
}

static void status(const view *v, window_rect place) {
    char size[32] = "", samples[64] = "", time[64] = "", frame[32] = "";
    const char *parts[] = {v->next ? "building shaders ..." : "nothing is open", size, time,
                           samples, frame};
    float width;
    if (v->open && !v->next) {
        parts[0] = v->compare ? "two pictures" : v->window.backend->title;
        snprintf(size, sizeof size, "%d x %d px", v->picture.width, v->picture.height);
        tell_samples(v, samples);
    }
    if (player_timed(v))
        snprintf(time, sizeof time, "%.4g ms, plays %.3g ms per second", (double)v->shot.time,
                 v->player.speed);
    if (v->open && !v->compare && v->frame_ms > 0)
        snprintf(frame, sizeof frame, "last frame %.0f ms", v->frame_ms);
    ui_panel("Status", place);
    ui_width_left(&width);
    status_line(parts, sizeof parts / sizeof *parts, width);
    ui_panel_end();
}

void panel_draw(view *v) {
    int width = (int)(330 * ui_scale()), line = (int)(1.7f * ui_text_height());
    int timeline = v->open && player_timed(v) ? (int)(4.2f * ui_text_height()) : 0;
    window_rect all = {0, 0, v->window.width, v->window.height}, before = v->picture;
    bool shown = v->panels && all.width > 2 * width;
    v->picture = all;
    if (shown) {
        v->picture = (window_rect){width, 0, all.width - width, all.height - timeline - line};
        bool any = v->picked.kind != PICKED_NOTHING;
        int below = any ? (int)(9 * ui_text_height()) : 0;
        left(v, (window_rect){0, 0, width, all.height - below});
        picked_text(v, (window_rect){0, 0, width, all.height});
        if (timeline)
            player_panel(v, (window_rect){width, v->picture.height, v->picture.width, timeline});
        status(v, (window_rect){width, all.height - line, v->picture.width, line});
    }
    if (memcmp(&before, &v->picture, sizeof before) != 0)
        v->dirty = true;
    if (v->open)
        stage_answer(v);
    input_hover(v);
    marks_draw(v);
    if (v->compare)
        compare_marks(v);
    film_panel(v);
    keys_dialog(v);
    said(v);
}
