/* What a click can do with the place that it found: aim a target or an access path, cut a vessel
 * open, lay a lens over it, focus the blur. Each is a flag of the program: what is placed is part
 * of the words that the document is opened with, so that the copied command line makes the same
 * picture; and what was there before is kept, so that it can be taken back. */
#include "hands.h"

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

void hands_focus_at(view *v, const double at[3]) {
    char text[HANDS_TEXT];
    snprintf(text, sizeof text, "%.6g,%.6g,%.6g,%.4g", at[0], at[1], at[2], (double)v->hands.sharp);
    focus_on(v, text);
}

void hands_focus_here(view *v, const double at[3]) {
    remember(v, focus_now(v));
    hands_focus_at(v, at);
}

void hands_unfocus(view *v) {
    remember(v, focus_now(v));
    focus_on(v, "");
    document_set(v->doc, 0, VSF_SETTING_ID_focus, 0);
}

/* ---- targets, paths, cuts ---------------------------------------------------------------- */

static void begin_words(view *v, word_list *list) {
    remember(v, document_words(v->doc, &v->shot));
    split(document_words(v->doc, &v->shot), list);
}

void hands_aim(view *v, const char *flag, const char *value) {
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

void hands_aim_ball(view *v, const double at[3]) {
    char text[HANDS_TEXT];
    snprintf(text, sizeof text, "%.6g,%.6g,%.6g,%.4g", at[0], at[1], at[2],
             (double)v->hands.radius);
    hands_aim(v, "--target", text);
}

static void aim_path(view *v, const double from[3], const double to[3]) {
    char text[HANDS_TEXT];
    snprintf(text, sizeof text, "%.6g,%.6g,%.6g:%.6g,%.6g,%.6g", from[0], from[1], from[2], to[0],
             to[1], to[2]);
    hands_aim(v, "--path", text);
}

void hands_cut(view *v, const double at[3]) {
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

void hands_look_in_ball(view *v, const double at[3]) {
    char text[HANDS_TEXT];
    snprintf(text, sizeof text, "sphere:%.6g,%.6g,%.6g,%.4g", at[0], at[1], at[2],
             2 * (double)v->hands.lens);
    look_in(v, text);
}

void hands_look_in_circle(view *v, const double at[3]) {
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
bool hands_circle(const view *v, double circle[3]) {
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
    return !v->compare && hands_circle(v, circle) &&
           fabs(hypot(x - circle[0], y - circle[1]) - circle[2]) < 7 * (double)ui_scale();
}

void hands_move_circle(view *v, double x, double y, double radius) {
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
    hands_move_circle(v, x / fmax(1, v->picture.width), y / fmax(1, v->picture.height),
                      v->doc->options.vessel.lens.circle[2]);
}

void hands_let_go(view *v) {
    trace(v, "lens %s", v->doc->options.vessel.lens.text);
}

/* ---- back -------------------------------------------------------------------------------- */

void hands_take_away(view *v) {
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

void hands_undo(view *v) {
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

/* ---- sizes that suit a document ---------------------------------------------------------- */

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
