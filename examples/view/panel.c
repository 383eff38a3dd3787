/* What is around the picture: at the left the tabs and what was clicked, below the player and a
 * line of numbers; dialogs over the picture. Nothing overlaps the picture but those. */
#include "view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void copy_json(const view *v) {
    char *json = pick_json(v->doc->scene, &v->picked);
    if (json) {
        ui_copy(json);
        trace(v, "json %s", json);
    }
    free(json);
}

int panel_picked_height(void) {
    return (int)(9 * ui_text_height());
}

/* What was clicked, and what can be done with it. */
static void picked_text(view *v, window_rect place) {
    char text[160];
    int height = panel_picked_height();
    if (v->picked.kind == PICKED_NOTHING)
        return;
    ui_panel("Picked",
             (window_rect){place.x, place.y + place.height - height, place.width, height});
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
    ui_same_line();
    if (ui_small_button("Copy JSON"))
        copy_json(v);
    ui_help("what is told below, for a program");
    hands_buttons(v);
    ui_disable_end();
    ui_text_wrapped(v->picked.title);
    for (uint32_t i = 0; i < v->picked.fact_count; i++) {
        pick_print(&v->picked.facts[i], text, sizeof text);
        ui_text(text);
    }
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
} tabs[] = {{"Scene", panel_scene, NULL},
            {"Look", panel_settings, has_document},
            {"View", panel_view, has_document},
            {"Save", panel_save, has_document},
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
    if (ui_dialog("Pointer and keys", v->picture, false, &v->keys)) {
        panel_keys();
        v->keys = !ui_button("Close##keys") && v->keys;
    }
    ui_panel_end();
}

/* What is opened again says the same again: once is enough. */
static bool told(char (*texts)[MESSAGE_SIZE], uint32_t i) {
    bool same = false;
    for (uint32_t k = 0; k < i && !same; k++)
        same = strcmp(texts[k], texts[i]) == 0;
    return same;
}

/* The last things that were said, until they are closed. Warnings leave the middle free, where the
 * picture is that they are about; busy: their place is taken, they wait. */
static void said(view *v, bool busy) {
    enum { SHOWN = 6 };
    char texts[SHOWN][MESSAGE_SIZE];
    bool failures[SHOWN], failed = false, open = true;
    uint32_t count = messages_count(v->messages), shown = 0;
    while (shown < SHOWN && shown < count - v->seen &&
           messages_get(v->messages, shown, &failures[shown], texts[shown]))
        failed = failures[shown++] || failed;
    if (!shown || (busy && !failed))
        return;
    if (ui_dialog(failed ? "Not done" : "Messages", v->picture, !failed, &open)) {
        for (uint32_t i = 0; i < shown; i++) {
            if (!told(texts, i))
                (failures[i] ? ui_text_error : ui_text_wrapped)(texts[i]);
        }
        open = !ui_button("Close") && open;
    }
    ui_panel_end();
    if (!open)
        v->seen = count;
}

/* What goes on beside the window, once it has taken long enough to be read. Is it there? */
static bool work(view *v) {
    static const double soon = 0.3; /* s */
    char doing[MESSAGE_SIZE];
    float part;
    bool busy = loader_busy(v->loader, doing, &part);
    double now = glfwGetTime();
    v->busy_since = !busy ? 0 : v->busy_since > 0 ? v->busy_since : now;
    if (!v->next && !(busy && now - v->busy_since > soon))
        return false;
    if (ui_dialog("At work", v->picture, v->open, NULL)) {
        ui_text_wrapped(busy ? doing : "building shaders: the window answers when they are there");
        if (busy) {
            ui_progress(part, NULL);
            if (ui_button("Cancel (Esc)##work"))
                loader_cancel(v->loader);
        }
    }
    ui_panel_end();
    return true;
}

/* Where a picture will be. */
static void invite(const view *v) {
    const char *const text = "Drop files here, or choose a scene at the left.";
    const window_rect *p = &v->picture;
    if (!v->open && v->panels)
        ui_draw_text(true, (float)p->x + ((float)p->width - ui_text_width(text)) / 2,
                     (float)p->y + (float)p->height / 2, 0xffa0a4a8, text);
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

static void status(const view *v, window_rect place, bool narrow) {
    char size[32] = "", samples[64] = "", time[64] = "", frame[32] = "";
    const char *parts[] = {"", "nothing is open", size, time, samples, frame};
    float width;
    if (narrow)
        parts[0] = "too narrow for the panels";
    if (v->open) {
        parts[1] = v->compare ? "two pictures" : v->window.backend->title;
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

/* Panels around the picture, which has what they leave. */
static void surround(view *v) {
    int width = (int)(330 * ui_scale()), line = (int)(1.7f * ui_text_height());
    int timeline = v->open && player_timed(v) ? (int)(4.2f * ui_text_height()) : 0;
    int below = v->picked.kind != PICKED_NOTHING ? panel_picked_height() : 0;
    window_rect all = {0, 0, v->window.width, v->window.height};
    v->picture = all;
    if (!v->panels)
        return;
    bool narrow = all.width <= 2 * width;
    if (narrow)
        width = timeline = 0;
    v->picture = (window_rect){width, 0, all.width - width, all.height - timeline - line};
    status(v, (window_rect){width, all.height - line, v->picture.width, line}, narrow);
    if (narrow)
        return;
    left(v, (window_rect){0, 0, width, all.height - below});
    picked_text(v, (window_rect){0, 0, width, all.height});
    if (timeline)
        player_panel(v, (window_rect){width, v->picture.height, v->picture.width, timeline});
}

void panel_draw(view *v) {
    window_rect before = v->picture;
    surround(v);
    if (memcmp(&before, &v->picture, sizeof before) != 0)
        v->dirty = true;
    if (v->open)
        stage_answer(v);
    input_hover(v);
    marks_draw(v);
    if (v->compare)
        compare_marks(v);
    invite(v);
    film_panel(v);
    bool busy = work(v) || v->film.running || v->keys;
    keys_dialog(v);
    said(v, busy);
}
