/* Buttons, sliders and marks of what is placed. */
#include "hands.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- widgets ----------------------------------------------------------------------------- */

static void tree_buttons(view *v) {
    if (ui_small_button("Target here"))
        hands_aim_ball(v, v->picked.at);
    ui_help("a ball around this place, a tumour: vessels nearer than the risk are marked");
    ui_same_line();
    if (ui_small_button("Path to here")) {
        v->hands.pathing = true;
        memcpy(v->hands.end, v->picked.at, sizeof v->hands.end);
        trace(v, "path to");
    }
    ui_help("a needle that ends here; the next click says where it enters");
    ui_same_line();
    if (ui_small_button("Cut open here"))
        hands_cut(v, v->picked.at);
    ui_help("takes a ball away, to look inside");
    if (ui_small_button("Lens here"))
        hands_look_in_ball(v, v->picked.at);
    ui_help("a ball around this place, in which the vessels have another look");
    ui_same_line();
    if (ui_small_button("Round lens"))
        hands_look_in_circle(v, v->picked.at);
    ui_help("a circle on the picture; what is seen through it has another look. Drag its ring to "
            "move it");
}

void hands_buttons(view *v) {
    if (v->picked.kind == PICKED_TREE && v->doc->command == CLI_VESSEL)
        tree_buttons(v);
    if (v->doc->command == CLI_SURFACE) {
        if (ui_small_button("Focus here"))
            hands_focus_here(v, v->picked.at);
        ui_help("sharp is what is as near as this place, the rest is blurred");
        hands_focus(v);
    }
    if (v->hands.pathing)
        ui_text_wrapped("Click where the path enters (on a vessel or beside it); Esc: no path.");
}

void hands_focus(view *v) {
    const cli_surface_options *o = &v->doc->options.surface;
    if (v->hands.count) {
        ui_same_line();
        if (ui_small_button("Undo"))
            hands_undo(v);
    }
    if (o->focus_numbers != 4)
        return;
    ui_same_line();
    if (ui_small_button("All sharp")) {
        hands_unfocus(v);
        return;
    }
    double at[3] = {o->focus_at[0], o->focus_at[1], o->focus_at[2]};
    ui_width(-1);
    if (ui_slider("##sharp", &v->hands.sharp, 0, 1.2f * v->shot.sphere[3], "sharp within %.3g mm"))
        hands_focus_at(v, at);
}

/* What was placed, above the flat tree. */
void hands_tree(view *v) {
    const cli_vessel_options *o = &v->doc->options.vessel;
    hands *h = &v->hands;
    const cli_target_option *aimed = o->target_count ? &o->targets[0] : NULL;
    bool ball =
        aimed && !aimed->path && strspn(aimed->text, "0123456789.,-+e") == strlen(aimed->text);
    if (!aimed && !o->shape_count && !o->lens.text && !h->count) {
        ui_text_dim("Click a vessel to aim at it: a target or a path, and what is at risk near it; "
                    "or to cut it open.");
        return;
    }
    ui_text_dim(!aimed ? "Placed" : aimed->path ? "Path" : "Target");
    if (aimed) {
        ui_text_wrapped(aimed->text);
        ui_width(-1);
        h->stale =
            ui_slider("##risk", &h->risk, 0.1f, v->shot.sphere[3], "at risk within %.3g mm") ||
            h->stale;
    }
    if (ball) {
        ui_width(-1);
        h->stale = ui_slider("##radius", &h->radius, 0, v->shot.sphere[3],
                             "radius of the target %.3g mm") ||
                   h->stale;
    }
    if (o->lens.text && o->lens.is_circle) {
        float radius = (float)o->lens.circle[2];
        ui_width(-1);
        if (ui_slider("##lens", &radius, 0.02f, 1, "radius of the lens %.2f of the height"))
            hands_move_circle(v, 0, 0, (double)radius);
    }
    if (h->count && ui_button("Undo"))
        hands_undo(v);
    if (h->count)
        ui_same_line();
    if ((aimed || o->shape_count || o->lens.text) && ui_button("Take away"))
        hands_take_away(v);
    ui_help("target, path, cut balls and lens");
    if (h->stale && !ui_active() && aimed) { /* the slider has been let go */
        double at[4];
        h->stale = false;
        if (ball && cli_numbers(aimed->text, at, 4))
            hands_aim_ball(v, at);
        else
            hands_aim(v, aimed->path ? "--path" : "--target", aimed->text);
    }
}

/* ---- marks ------------------------------------------------------------------------------- */

/* A ball as a ring around it. */
static void draw_ball(const view *v, const double ball[4], uint32_t color) {
    enum { PARTS = 48 };
    cli_shot shot = v->shot;
    shot.width = (uint32_t)v->picture.width;
    shot.height = (uint32_t)v->picture.height;
    cli_shot_aim(v->doc->scene, &shot);
    double last[3];
    for (int i = 0; i <= PARTS; i++) {
        double angle = 6.283185307179586 * i / PARTS, at[3];
        for (size_t k = 0; k < 3; k++)
            at[k] = ball[k] + ball[3] * (cos(angle) * (double)shot.view[4 * k] +
                                         sin(angle) * (double)shot.view[4 * k + 1]);
        if (i)
            marks_way(v, last, at, color, 2);
        memcpy(last, at, sizeof last);
    }
}

/* "x,y,z:x,y,z..." point after point. */
static void draw_path(const view *v, const char *text, uint32_t color) {
    double last[3], at[3];
    char point[HANDS_TEXT];
    for (bool first = true; *text; first = false) {
        size_t length = strcspn(text, ":");
        snprintf(point, sizeof point, "%.*s", (int)length, text);
        if (!cli_numbers(point, at, 3))
            return;
        if (!first)
            marks_way(v, last, at, color, 2);
        memcpy(last, at, sizeof last);
        text += length + (text[length] == ':');
    }
}

void hands_marks(const view *v) {
    const uint32_t green = 0xff4a962c, ochre = 0xff60aad6;
    double ball[4];
    if (!v->open || v->picture.width < 1 || v->picture.height < 1)
        return;
    if (v->doc->command == CLI_VESSEL && v->doc->options.vessel.target_count &&
        !v->doc->options.vessel.link) {
        const cli_target_option *aimed = &v->doc->options.vessel.targets[0];
        if (aimed->path)
            draw_path(v, aimed->text, green);
        else if (cli_numbers(aimed->text, ball, 4))
            draw_ball(v, ball, ochre);
    }
    double circle[3];
    if (!v->compare && hands_circle(v, circle)) {
        bool near = hands_grabs(v, v->pointer.x, v->pointer.y);
        ui_draw_ring(true, (float)circle[0], (float)circle[1], (float)circle[2],
                     near || v->lensing ? 0xffe09a4a : 0xff808080, (near ? 3 : 1.5f) * ui_scale());
    }
    float end[2];
    if (v->hands.pathing && stage_place(v, v->hands.end, end))
        ui_draw_line(true, end[0], end[1], (float)v->pointer.x, (float)v->pointer.y, green,
                     2 * ui_scale());
}
