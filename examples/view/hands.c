/* What a click can do with the place that it found: aim a target or an access path, cut a vessel
 * open, lay a lens over it, focus the blur. Each is a flag of the program: what is placed is part
 * of the words that the document is opened with, so that the copied command line makes the same
 * picture; and what was there before is kept, so that it can be taken back. */
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- words ------------------------------------------------------------------------------- */

enum { MOST_WORDS = 512 };

typedef struct word_list {
    char *text; /* owned; the words are in it, or stand still elsewhere */
    const char *words[MOST_WORDS];
    uint32_t count;
} word_list;

static void split(char *text, word_list *out) {
    out->text = text;
    out->count = 0;
    for (char *at = text; at && *at && out->count < MOST_WORDS;) {
        char *end = at + strcspn(at, "\n");
        out->words[out->count++] = at;
        at = *end ? end + 1 : end;
        *end = '\0';
    }
}

/* Leaves out a flag and its value, wherever they stand; of a value that begins so, unless NULL. */
static void drop(word_list *list, const char *flag, const char *begin) {
    uint32_t kept = 0;
    size_t length = strlen(flag);
    for (uint32_t i = 0; i < list->count; i++) {
        const char *word = list->words[i];
        bool joined = strncmp(word, flag, length) == 0 && word[length] == '=';
        bool apart = strcmp(word, flag) == 0 && i + 1 < list->count;
        const char *value = joined ? word + length + 1 : apart ? list->words[i + 1] : "";
        if ((joined || apart) && (!begin || strncmp(value, begin, strlen(begin)) == 0))
            i += apart;
        else
            list->words[kept++] = word;
    }
    list->count = kept;
}

static void add(word_list *list, const char *flag, const char *value) {
    if (list->count + 2 > MOST_WORDS)
        return;
    list->words[list->count++] = flag;
    list->words[list->count++] = value;
}

/* ---- taking back ------------------------------------------------------------------------- */

/* Takes the text over: words, or the value of --focus. */
static void remember(view *v, char *text) {
    hands *h = &v->hands;
    if (h->count == HANDS_UNDO) {
        free(h->undo[0]);
        memmove(h->undo, h->undo + 1, (HANDS_UNDO - 1) * sizeof *h->undo);
        h->count--;
    }
    if (text)
        h->undo[h->count++] = text;
}

void hands_forget(view *v) {
    while (v->hands.count)
        free(v->hands.undo[--v->hands.count]);
    v->hands.reopening = v->hands.pathing = v->hands.stale = false;
}

static void reopen(view *v, const word_list *list) {
    v->hands.pathing = v->hands.stale = false;
    v->hands.reopening = loader_start(v->loader, list->words, list->count);
    v->awake = 3;
}

/* ---- focus ------------------------------------------------------------------------------- */

static void focus_on(view *v, const char *text) {
    cli_surface_options *o = &v->doc->options.surface;
    static const int settings[3] = {VSF_SETTING_ID_focus, VSF_SETTING_ID_focus_near,
                                    VSF_SETTING_ID_focus_far};
    for (int i = 0; i < 3; i++)
        document_reset(v->doc, 0, settings[i]);
    snprintf(v->hands.focus, sizeof v->hands.focus, "%s", text);
    bool ball = cli_numbers(text, o->focus_at, 4), depths = cli_numbers(text, o->focus_at, 2);
    o->focus_numbers = ball ? 4 : depths ? 2 : 0;
    o->focus = o->focus_numbers ? v->hands.focus : NULL;
    if (ball)
        v->hands.sharp = (float)o->focus_at[3];
    trace(v, "focus %s", text);
    stage_changed(v, false);
}

static char *copy_of(const char *text) {
    char *copy = cli_new(strlen(text) + 1, 1);
    return copy ? strcpy(copy, text) : NULL;
}

/* What --focus says now; "" for nothing. */
static char *focus_now(const view *v) {
    const char *now = v->doc->options.surface.focus;
    return copy_of(now ? now : "");
}

static void focus_at(view *v, const double at[3]) {
    char text[HANDS_TEXT];
    snprintf(text, sizeof text, "%.6g,%.6g,%.6g,%.4g", at[0], at[1], at[2], (double)v->hands.sharp);
    focus_on(v, text);
}

/* ---- targets, paths, cuts ---------------------------------------------------------------- */

static void begin_words(view *v, word_list *list) {
    remember(v, document_words(v->doc, &v->shot));
    split(document_words(v->doc, &v->shot), list);
}

static void aim(view *v, const char *flag, const char *value) {
    word_list list;
    char risk[32];
    begin_words(v, &list);
    drop(&list, "--target", NULL);
    drop(&list, "--path", NULL);
    drop(&list, "--risk", NULL);
    cli_shortest(v->hands.risk, risk, sizeof risk);
    add(&list, flag, value);
    add(&list, "--risk", risk);
    trace(v, "placed %s %s", flag, value);
    reopen(v, &list);
    free(list.text);
}

static void aim_ball(view *v, const double at[3]) {
    char text[HANDS_TEXT];
    snprintf(text, sizeof text, "%.6g,%.6g,%.6g,%.4g", at[0], at[1], at[2],
             (double)v->hands.radius);
    aim(v, "--target", text);
}

static void aim_path(view *v, const double from[3], const double to[3]) {
    char text[HANDS_TEXT];
    snprintf(text, sizeof text, "%.6g,%.6g,%.6g:%.6g,%.6g,%.6g", from[0], from[1], from[2], to[0],
             to[1], to[2]);
    aim(v, "--path", text);
}

static void cut(view *v, const double at[3]) {
    word_list list;
    char text[HANDS_TEXT];
    begin_words(v, &list);
    snprintf(text, sizeof text, "sphere:%.6g,%.6g,%.6g,%.4g", at[0], at[1], at[2],
             (double)v->hands.lens);
    add(&list, "--subtract", text);
    trace(v, "placed --subtract %s", text);
    reopen(v, &list);
    free(list.text);
}

/* ---- lenses ------------------------------------------------------------------------------ */

static void drop_lens(word_list *list) {
    drop(list, "--lens", NULL);
    drop(list, "--lens-style", NULL);
    drop(list, "--lens-color", NULL);
    drop(list, "--lens-tree", NULL);
}

/* A ball or a circle with another look; the one that was there moves here. */
static void look_in(view *v, const char *where) {
    const cli_vessel_options *o = &v->doc->options.vessel;
    word_list list;
    begin_words(v, &list);
    drop(&list, "--lens", NULL);
    add(&list, "--lens", where);
    if (!o->lens.text) /* far from any other look */
        add(&list, "--lens-style", o->style && strcmp(o->style, "ink") == 0 ? "default" : "ink");
    trace(v, "placed --lens %s", where);
    reopen(v, &list);
    free(list.text);
}

static void look_in_ball(view *v, const double at[3]) {
    char text[HANDS_TEXT];
    snprintf(text, sizeof text, "sphere:%.6g,%.6g,%.6g,%.4g", at[0], at[1], at[2],
             2 * (double)v->hands.lens);
    look_in(v, text);
}

static void look_in_circle(view *v, const double at[3]) {
    char text[HANDS_TEXT];
    const window_rect *p = &v->picture;
    float place[2];
    if (!stage_place(v, at, place))
        return;
    snprintf(text, sizeof text, "circle:%.4f,%.4f,0.25",
             ((double)place[0] - p->x) / fmax(1, p->width),
             ((double)place[1] - p->y) / fmax(1, p->height));
    look_in(v, text);
}

/* The circle that can be moved, px; false: there is none. */
static bool circle_of(const view *v, double circle[3]) {
    const cli_lens_option *lens = &v->doc->options.vessel.lens;
    const window_rect *p = &v->picture;
    if (!v->open || v->doc->command != CLI_VESSEL || !lens->text || !lens->is_circle)
        return false;
    circle[0] = p->x + lens->circle[0] * p->width;
    circle[1] = p->y + lens->circle[1] * p->height;
    circle[2] = lens->circle[2] * p->height;
    return true;
}

bool hands_grabs(const view *v, double x, double y) {
    double circle[3];
    return !v->compare && circle_of(v, circle) &&
           fabs(hypot(x - circle[0], y - circle[1]) - circle[2]) < 7 * (double)ui_scale();
}

static void move_circle(view *v, double x, double y, double radius) {
    const double *now = v->doc->options.vessel.lens.circle;
    const double circle[3] = {fmax(0, fmin(1, now[0] + x)), fmax(0, fmin(1, now[1] + y)), radius};
    document_move_lens(v->doc, circle);
    v->steady.last = glfwGetTime();
    v->dirty = true;
}

void hands_grab(view *v) {
    remember(v, document_words(v->doc, &v->shot));
}

void hands_drag(view *v, double x, double y) {
    move_circle(v, x / fmax(1, v->picture.width), y / fmax(1, v->picture.height),
                v->doc->options.vessel.lens.circle[2]);
}

void hands_let_go(view *v) {
    trace(v, "lens %s", v->doc->options.vessel.lens.text);
}

/* ---- back -------------------------------------------------------------------------------- */

static void take_away(view *v) {
    word_list list;
    begin_words(v, &list);
    drop_lens(&list);
    drop(&list, "--target", NULL);
    drop(&list, "--path", NULL);
    drop(&list, "--risk", NULL);
    drop(&list, "--color", "distance");
    drop(&list, "--layout-weight", "near");
    drop(&list, "--subtract", "sphere:");
    trace(v, "placed nothing");
    reopen(v, &list);
    free(list.text);
}

static void take_back(view *v) {
    hands *h = &v->hands;
    if (!h->count)
        return;
    char *text = h->undo[--h->count];
    trace(v, "back");
    if (v->doc->command == CLI_SURFACE) {
        focus_on(v, text);
    } else { /* as it was, but seen from here */
        word_list list;
        char *camera = camera_print(&v->shot.camera);
        split(text, &list);
        drop(&list, "--camera", NULL);
        add(&list, "--camera", camera ? camera : "");
        if (camera)
            reopen(v, &list);
        free(camera);
    }
    free(text);
}

/* ---- clicks ------------------------------------------------------------------------------ */

void hands_click(view *v, const double from[3], const double to[3]) {
    double eye[3], depth = 0, along = 0, at[3];
    hands *h = &v->hands;
    const camera_pose *pose = &v->shot.camera;
    if (v->picked.kind != PICKED_NOTHING) {
        aim_path(v, v->picked.at, h->end);
        return;
    }
    for (int k = 0; k < 3; k++) { /* in the void: as deep as where the path ends */
        eye[k] = pose->center[k] - pose->eye[k];
        depth += (h->end[k] - from[k]) * eye[k];
        along += to[k] * eye[k];
    }
    for (int k = 0; k < 3; k++)
        at[k] = from[k] + depth / along * to[k];
    aim_path(v, at, h->end);
}

/* ---- widgets ----------------------------------------------------------------------------- */

/* Two digits of a part of the scene's size. */
static float round_part(const view *v, double part) {
    char text[32];
    snprintf(text, sizeof text, "%.1e", part * (double)v->shot.sphere[3]);
    return strtof(text, NULL);
}

void hands_begin(view *v) {
    hands *h = &v->hands;
    const cli_vessel_options *o = &v->doc->options.vessel;
    double ball[4];
    h->pathing = h->stale = false;
    h->sharp = h->lens = round_part(v, 0.15);
    h->radius = round_part(v, 0.06);
    h->risk = o->risk > 0 ? (float)o->risk : fminf(15, round_part(v, 0.15));
    if (o->target_count && !o->targets[0].path && cli_numbers(o->targets[0].text, ball, 4))
        h->radius = (float)ball[3];
    if (v->doc->options.surface.focus_numbers == 4)
        h->sharp = (float)v->doc->options.surface.focus_at[3];
}

static void tree_buttons(view *v) {
    if (ui_small_button("Target here"))
        aim_ball(v, v->picked.at);
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
        cut(v, v->picked.at);
    ui_help("takes a ball away, to look inside");
    if (ui_small_button("Lens here"))
        look_in_ball(v, v->picked.at);
    ui_help("a ball around this place, in which the vessels have another look");
    ui_same_line();
    if (ui_small_button("Round lens"))
        look_in_circle(v, v->picked.at);
    ui_help("a circle on the picture; what is seen through it has another look. Drag its ring to "
            "move it");
}

void hands_buttons(view *v) {
    if (v->picked.kind == PICKED_TREE && v->doc->command == CLI_VESSEL)
        tree_buttons(v);
    if (v->doc->command == CLI_SURFACE) {
        if (ui_small_button("Focus here")) {
            remember(v, focus_now(v));
            focus_at(v, v->picked.at);
        }
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
            take_back(v);
    }
    if (o->focus_numbers != 4)
        return;
    ui_same_line();
    if (ui_small_button("All sharp")) {
        remember(v, focus_now(v));
        focus_on(v, "");
        document_set(v->doc, 0, VSF_SETTING_ID_focus, 0);
        return;
    }
    double at[3] = {o->focus_at[0], o->focus_at[1], o->focus_at[2]};
    ui_width(-1);
    if (ui_slider("##sharp", &v->hands.sharp, 0, 1.2f * v->shot.sphere[3], "sharp within %.3g mm"))
        focus_at(v, at);
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
    ui_text_dim(aimed ? (aimed->path ? "Path" : "Target") : "No target");
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
        if (ui_slider("##lens", &radius, 0.02f, 1, "lens of %.2f picture heights"))
            move_circle(v, 0, 0, (double)radius);
    }
    if (h->count && ui_button("Undo"))
        take_back(v);
    if (h->count)
        ui_same_line();
    if ((aimed || o->shape_count || o->lens.text) && ui_button("Take away"))
        take_away(v);
    ui_help("target, path, cut balls and lens");
    if (h->stale && !ui_active() && aimed) { /* the slider has been let go */
        double at[4];
        h->stale = false;
        if (ball && cli_numbers(aimed->text, at, 4))
            aim_ball(v, at);
        else
            aim(v, aimed->path ? "--path" : "--target", aimed->text);
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
    if (!v->compare && circle_of(v, circle)) {
        bool near = hands_grabs(v, v->pointer.x, v->pointer.y);
        ui_draw_ring(true, (float)circle[0], (float)circle[1], (float)circle[2],
                     near || v->lensing ? 0xffe09a4a : 0xff808080, (near ? 3 : 1.5f) * ui_scale());
    }
    float end[2];
    if (v->hands.pathing && stage_place(v, v->hands.end, end))
        ui_draw_line(true, end[0], end[1], (float)v->pointer.x, (float)v->pointer.y, green,
                     2 * ui_scale());
}
