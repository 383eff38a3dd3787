/* The time that is shown: playing, stepping, the timeline (Lawonn 2014, 6.2 and 6.3). */
#include "view.h"

#include <math.h>
#include <stdio.h>

enum { STEPS = 50 }; /* of one run */

bool player_timed(const view *v) {
    double first, length;
    player_range(v, &first, &length);
    return v->open && v->doc->timed && length > 0;
}

void player_range(const view *v, double *first, double *length) {
    *first = v->doc ? v->doc->scene->beat[0] : 0;
    *length = v->doc ? v->doc->scene->period : 0;
}

void player_go(view *v, double time) {
    if (!player_timed(v))
        return;
    v->shot.time = (float)time;
    if (v->doc->command == CLI_RENDER)
        document_show_time(v->doc, true);
    stage_time(v);
}

void player_pace(view *v, double factor) {
    v->player.speed *= factor;
    trace(v, "speed %g", v->player.speed);
}

void player_step(view *v, int steps) {
    double first, length;
    player_range(v, &first, &length);
    double at = fmod((double)v->shot.time - first + steps * length / STEPS, length);
    v->player.playing = false;
    player_go(v, first + (at < 0 ? at + length : at));
    trace(v, "time %g", (double)v->shot.time);
}

void player_toggle(view *v) {
    v->player.playing = !v->player.playing && player_timed(v);
    v->player.last = glfwGetTime();
    trace(v, "player %s", v->player.playing ? "plays" : "pauses");
}

void player_stop(view *v) {
    double first, length;
    player_range(v, &first, &length);
    v->player.playing = false;
    player_go(v, first);
    trace(v, "player stops");
    trace(v, "time %g", (double)v->shot.time);
}

/* While the camera turns, time stands still. */
bool player_advance(view *v, double now) {
    player *p = &v->player;
    double first, length, passed = fmin(now - p->last, 0.5);
    p->last = now;
    if (!p->playing || !player_timed(v) || v->pointer.button >= 0)
        return p->playing;
    player_range(v, &first, &length);
    double at = (double)v->shot.time - first + passed * p->speed;
    if (at >= length && !p->loop) {
        p->playing = false;
        at = length;
    }
    player_go(v, first + (p->playing ? fmod(at, length) : at));
    return p->playing;
}

static void draw_timeline(view *v, double first, double length) {
    float width;
    char text[64];
    ui_width_left(&width);
    ui_area a = ui_canvas("timeline", width, 1.6f * ui_text_height());
    float middle = a.y + 0.35f * a.height, line = ui_scale();
    double part = ((double)v->shot.time - first) / length;
    int decimals = length >= 40 ? 0 : length >= 4 ? 1 : 3; /* so that places differ */
    ui_draw_box(false, a.x, middle - 2 * line, a.x + a.width, middle + 2 * line, 0xff606468);
    ui_draw_box(false, a.x, middle - 2 * line, a.x + (float)part * a.width, middle + 2 * line,
                0xffe09a4a);
    ui_draw_disc(false, a.x + (float)part * a.width, middle, 6 * line, 0xfff0f0f0);
    for (int i = 0; i <= 4; i++) {
        snprintf(text, sizeof text, i == 4 ? "%.*f ms" : "%.*f", decimals, first + i * length / 4);
        float at = a.x + (float)i * 0.25f * a.width, wide = ui_text_width(text);
        ui_draw_text(false,
                     i == 4 ? at - wide
                     : i    ? at - wide / 2
                            : at,
                     a.y + 0.55f * a.height, 0xffa0a4a8, text);
    }
    if (a.pressed) {
        float x = (a.pointer[0] - a.x) / a.width;
        player_go(v, first + length * (double)(x < 0 ? 0 : x > 1 ? 1 : x));
        v->steady.last = glfwGetTime();
        trace(v, "time %g", (double)v->shot.time);
    }
}

void player_panel(view *v, window_rect place) {
    double first, length;
    bool shown = document_shows_time(v->doc) || v->doc->command == CLI_SURFACE;
    player_range(v, &first, &length);
    ui_panel("Player", place);
    ui_disable(v->film.running);
    if (ui_button(v->player.playing ? "Pause##play" : "Play##play"))
        player_toggle(v);
    ui_help("(Space)");
    ui_same_line();
    if (ui_button("Stop"))
        player_stop(v);
    ui_help("back to the first time");
    ui_same_line();
    if (ui_button("<##back"))
        player_step(v, -1);
    ui_help("a step back (Left)");
    ui_same_line();
    if (ui_button(">##forth"))
        player_step(v, 1);
    ui_help("a step forward (Right)");
    ui_same_line();
    if (ui_button("Slower"))
        player_pace(v, 1 / 1.5);
    ui_help("(comma)");
    ui_same_line();
    if (ui_button("Faster"))
        player_pace(v, 1.5);
    ui_help("(full stop)");
    ui_same_line();
    ui_toggle("Loop", &v->player.loop);
    ui_help("again and again, or once (L)");
    if (v->doc->command == CLI_RENDER) {
        ui_same_line();
        if (ui_toggle("Trails", &shown)) {
            document_show_time(v->doc, shown);
            v->player.playing = v->player.playing && shown;
            stage_changed(v, false);
        }
        ui_help("show the lines around the time alone, or all of them");
    }
    draw_timeline(v, first, length);
    ui_disable_end();
    ui_panel_end();
}
