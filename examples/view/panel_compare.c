/* Side by side: the widgets, and the divided picture. */
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_NAME = 128 };

void compare_end(view *v) {
    compare_stop(v->compare);
    v->compare = NULL;
    v->dirty = true;
}

/* The i-th image of the frame graph that a dump would have, or the picture. */
static const lao_image_row *image_row(const view *v, uint32_t i) {
    const cli_scene *scene = v->doc->scene;
    for (uint32_t m = 0; m <= scene->module_count; m++) {
        const lao_module *module = m ? scene->modules[m - 1] : lao_lines_module();
        for (uint32_t k = 0; k < module->image_count; k++) {
            const lao_image_row *row = &module->images[k];
            if (row->format != LAO_FORMAT_HOST && !(row->flags & LAO_IMAGE_IMPORT) &&
                row->format != LAO_FORMAT_D32F && i-- == 0)
                return row;
        }
    }
    return NULL;
}

static void choose_image(view *v) {
    comparison *c = &v->comparison;
    char names[4096] = "";
    int chosen = 0, level = (int)c->level;
    const lao_image_row *row, *shown = NULL;
    for (uint32_t i = 0; (row = image_row(v, i)) != NULL; i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", i ? "|" : "", row->name);
        if (strcmp(row->name, c->image) == 0) {
            chosen = (int)i;
            shown = row;
        }
    }
    ui_width(-1);
    if (ui_combo("##image", &chosen, names) && (row = image_row(v, (uint32_t)chosen)) != NULL) {
        snprintf(c->image, sizeof c->image, "%s", row->name);
        c->level = row->levels ? c->level : 0;
        v->dirty = true;
    }
    ui_help("any image of the frame graph; out is the picture. Numbers are shown between their "
            "least and greatest");
    if (!shown || !shown->levels)
        return;
    ui_width(-1);
    if (ui_combo("##level", &level,
                 "level 0|level 1|level 2|level 3|level 4|level 5|level 6|level 7")) {
        c->level = (uint32_t)level;
        v->dirty = true;
    }
    ui_help("level of an image that has several");
}

/* Presets are of lines. */
static bool has_presets(const view *v) {
    bool has = false;
    for (uint32_t i = 0; i < v->doc->settings_count; i++)
        has = has || (v->doc->settings[i].module == lao_lines_module() &&
                      document_offers(v->doc, i, LAO_SETTING_ID_preset));
    return has;
}

static void choose_side(view *v, int side) {
    compare_look *look = &v->comparison.looks[side];
    bool presets = has_presets(v);
    float width;
    ui_group(side);
    ui_widget_name(side ? "right" : "left");
    ui_text_dim(side ? "Right" : "Left");
    ui_width_left(&width);
    ui_width(presets ? 0.35f * width : -1);
    v->dirty = ui_combo("##backend", &look->backend, "OpenGL|Vulkan") || v->dirty;
    if (presets) {
        ui_same_line();
        ui_width(-1);
        v->dirty =
            ui_combo("##preset", &look->preset, "settings as they are|default|classic|paper") ||
            v->dirty;
        ui_help("what the look of lines begins with; settings that were edited stay");
    } else {
        look->preset = 0;
    }
    ui_widget_name(NULL);
    ui_group_end();
}

/* Entries of the list of settings: what is chosen, by document.settings and number. */
static bool setting_at(const view *v, int entry, int *index, int *setting) {
    for (uint32_t i = 0; i < v->doc->settings_count; i++) {
        for (uint32_t k = 0; k < v->doc->settings[i].module->setting_count; k++) {
            if (document_offers(v->doc, i, (int)k) &&
                document_needs(v->doc, i, (int)k) == NEEDS_NOTHING && entry-- == 0) {
                *index = (int)i;
                *setting = (int)k;
                return true;
            }
        }
    }
    return false;
}

static const lao_setting_row *row_of(const view *v, const compare_look *look) {
    return &v->doc->settings[look->index].module->settings[look->setting];
}

/* "strength", or "strength (Lines)" where there are several kinds. */
static void choose_setting(view *v) {
    enum { ROOM = 16384 };
    compare_look *looks = v->comparison.looks;
    char *names = cli_new(ROOM, 1);
    int chosen = 0, index, setting;
    if (!names)
        return;
    size_t used = (size_t)snprintf(names, ROOM, "no setting differs");
    for (int i = 0; setting_at(v, i, &index, &setting) && used < ROOM; i++) {
        const document_settings *s = &v->doc->settings[index];
        bool one = v->doc->settings_count == 1;
        used += (size_t)snprintf(names + used, ROOM - used, one ? "|%s" : "|%s (%s)",
                                 s->module->settings[setting].name, s->title);
        if (looks->index == index && looks->setting == setting)
            chosen = i + 1;
    }
    ui_width(-1);
    if (ui_combo("##differs", &chosen, names)) {
        for (int side = 0; side < 2; side++) {
            compare_look *look = &looks[side];
            look->index = -1;
            if (chosen && setting_at(v, chosen - 1, &look->index, &look->setting))
                look->value = document_value(v->doc, (uint32_t)look->index, look->setting);
        }
        v->dirty = true;
    }
    ui_help("one setting that is not the same left and right");
    free(names);
}

/* Its values on both sides. */
static void edit_setting(view *v) {
    compare_look *looks = v->comparison.looks;
    if (looks->index < 0)
        return;
    const lao_setting_row *row = row_of(v, looks);
    if (!ui_table("sides", 2, 1))
        return;
    for (int side = 0; side < 2; side++) {
        ui_group(side);
        ui_widget_name(side ? "right value" : "left value");
        ui_cell();
        ui_label(side ? "right" : "left");
        ui_cell();
        if (panel_edit(row, &looks[side].value)) {
            if (row->type == LAO_SETTING_INT)
                looks[side].value = roundf(looks[side].value);
            v->dirty = true;
        }
        panel_explain(row);
        ui_widget_name(NULL);
        ui_group_end();
    }
    ui_table_end();
}

static bool same_pass(const lao_timing *a, const lao_timing *b) {
    return strcmp(a->pass, b->pass) == 0 && a->level == b->level;
}

/* The pass of `in` that is the i-th of `of`: of equal ones as many come before it. NULL: none. */
static const lao_timing *find_pass(const compare_result *in, const compare_result *of, uint32_t i) {
    uint32_t before = 0;
    for (uint32_t k = 0; k < i; k++)
        before += same_pass(&of->passes[k], &of->passes[i]);
    for (uint32_t k = 0; k < in->pass_count; k++) {
        if (same_pass(&in->passes[k], &of->passes[i]) && before-- == 0)
            return &in->passes[k];
    }
    return NULL;
}

/* A pass that one side does not have is left empty there. */
static void pass_row(const lao_timing *of, const lao_timing *left, const lao_timing *right) {
    const lao_timing *sides[2] = {left, right};
    char text[64];
    snprintf(text, sizeof text, of->level ? "%s %u" : "%s", of->pass, of->level);
    ui_cell();
    ui_text(text);
    for (int k = 0; k < 2; k++) {
        snprintf(text, sizeof text, "%.2f", sides[k] ? sides[k]->milliseconds : 0);
        ui_cell();
        ui_text(sides[k] ? text : "");
    }
}

static void pass_times(const compare_result *const r[2]) {
    char text[64];
    if (!ui_table("passes", 3, 0))
        return;
    ui_cell();
    ui_text("milliseconds");
    for (int k = 0; k < 2; k++) {
        ui_cell();
        ui_text(k ? "right" : "left");
    }
    ui_cell();
    ui_text("frame");
    for (int k = 0; k < 2; k++) {
        snprintf(text, sizeof text, "%.2f", r[k]->milliseconds);
        ui_cell();
        ui_text(text);
    }
    for (uint32_t i = 0; i < r[0]->pass_count; i++)
        pass_row(&r[0]->passes[i], &r[0]->passes[i], find_pass(r[1], r[0], i));
    for (uint32_t i = 0; i < r[1]->pass_count; i++) {
        if (!find_pass(r[0], r[1], i))
            pass_row(&r[1]->passes[i], NULL, &r[1]->passes[i]);
    }
    ui_table_end();
}

static void tell_difference(const comparison *c, const compare_result *r) {
    const compare_count *n = &c->count;
    char text[160];
    if (n->bits < 0) {
        ui_text("the images have different sizes");
        return;
    }
    snprintf(text, sizeof text, "%lld of %lld bits differ", (long long)n->bits, (long long)n->all);
    ui_text(text);
    if (n->bits) {
        snprintf(text, sizeof text, "in %lld pixels, at most by %.4g%s", (long long)n->pixels,
                 (double)n->worst, r->values ? "" : " of 255");
        ui_text(text);
    }
    if (r->values) {
        snprintf(text, sizeof text, "%u x %u, black %.4g, white %.4g", r->width, r->height,
                 (double)r->range[0], (double)r->range[1]);
        ui_text(text);
    }
}

void panel_compare(view *v) {
    comparison *c = &v->comparison;
    const compare_result *r[2];
    bool on = v->compare != NULL;
    if (ui_toggle("Two pictures side by side", &on)) {
        if (on)
            v->compare = compare_start(v->doc, &v->listener);
        else
            compare_end(v);
        v->dirty = true;
    }
    if (!v->compare) {
        ui_text_dim("The same view on OpenGL and Vulkan, with two presets, or with two values of a "
                    "setting; every image of the frame graph, and the time of every pass.");
        return;
    }
    choose_side(v, 0);
    choose_side(v, 1);
    choose_setting(v);
    edit_setting(v);
    ui_text_dim("Image");
    choose_image(v);
    ui_toggle("Difference", &c->difference);
    ui_help("|left - right|, amplified");
    if (c->difference) {
        ui_same_line();
        ui_width(-1);
        c->stale = ui_slider("##gain", &c->gain, 1, 255, "x %.0f") || c->stale;
    }
    compare_results(v->compare, r);
    if (compare_busy(v->compare))
        ui_text("drawing ...");
    else if (!r[0]->pixels || !r[1]->pixels)
        ui_text_wrapped("This image does not exist with these settings.");
    else
        tell_difference(c, r[0]);
    ui_scroll("times", 0);
    pass_times(r);
    ui_scroll_end();
}

/* Asks for what is out of date, and takes what is done to the window. */
void compare_draw(view *v) {
    comparison *c = &v->comparison;
    const window_backend *backend = v->window.backend;
    const compare_result *r[2];
    if (v->dirty && v->picture.width > 0 && v->picture.height > 0) {
        cli_shot shot = v->shot;
        shot.width = (uint32_t)v->picture.width;
        shot.height = (uint32_t)v->picture.height;
        cli_shot_aim(v->doc->scene, &shot);
        stage_aim(v, &shot);
        compare_ask(v->compare, &shot, c->looks, c->image, c->level);
        v->dirty = false;
    }
    bool news = compare_take(v->compare);
    compare_results(v->compare, r);
    if (news) {
        v->awake = v->awake > 2 ? v->awake : 2; /* the panel tells of it, then has room for it */
        c->ready = r[0]->pixels && r[1]->pixels;
        c->count = compare_differences(r[0], r[1]);
        for (int k = 0; k < 2 && c->ready; k++)
            c->ready =
                backend->upload(&v->window, SLOT_LEFT + k, r[k]->width, r[k]->height, r[k]->pixels);
        trace(v, "range %g %g", (double)r[0]->range[0], (double)r[0]->range[1]);
        trace(v, "compared %s %ux%u %lld", c->image, r[0]->width, r[0]->height,
              (long long)c->count.bits);
    }
    if ((news || c->stale) && c->ready && c->difference) {
        uint8_t *pixels = compare_difference(r[0], r[1], c->gain);
        if (pixels)
            backend->upload(&v->window, SLOT_DIFFERENCE, r[0]->width, r[0]->height, pixels);
        free(pixels);
        c->stale = false;
    }
    c->size[0][0] = (int)r[0]->width;
    c->size[0][1] = (int)r[0]->height;
    c->size[1][0] = (int)r[1]->width;
    c->size[1][1] = (int)r[1]->height;
    c->stale = c->stale || (c->difference && !c->differed);
    c->differed = c->difference;
}

/* A part of one side: `from` and `to` in parts of the picture's width. */
static void show_part(const view *v, int slot, const int size[2], double from, double to) {
    int a = (int)round(from * v->picture.width), b = (int)round(to * v->picture.width);
    int x = (int)round(from * size[0]), end = (int)round(to * size[0]);
    v->window.backend->show(
        (window *)(uintptr_t)&v->window, slot, (window_rect){x, 0, end - x, size[1]},
        (window_rect){v->picture.x + a, v->picture.y, b - a, v->picture.height});
}

void compare_show(view *v) {
    const comparison *c = &v->comparison;
    if (!c->ready || v->picture.width < 2)
        return;
    if (c->difference) {
        show_part(v, SLOT_DIFFERENCE, c->size[0], 0, 1);
        return;
    }
    show_part(v, SLOT_LEFT, c->size[0], 0, c->divider);
    show_part(v, SLOT_RIGHT, c->size[1], c->divider, 1);
}

static const char *side_name(const view *v, int side, char text[SIDE_NAME]) {
    static const char *const presets[] = {"", " default", " classic", " paper"};
    const compare_look *look = &v->comparison.looks[side];
    char value[32] = "";
    if (look->index >= 0)
        cli_setting_text(row_of(v, look), look->value, value, sizeof value);
    snprintf(text, SIDE_NAME, "%s%s%s%s%s%s", look->backend ? "Vulkan" : "OpenGL",
             presets[look->preset], *value ? " " : "", *value ? row_of(v, look)->name : "",
             *value ? " " : "", value);
    return text;
}

/* At the upper border of the picture, from `x` on. */
static void draw_label(const view *v, float x, const char *text) {
    float top = (float)v->picture.y, s = ui_scale();
    ui_draw_box(true, x - 4 * s, top + 6 * s, x + ui_text_width(text) + 4 * s,
                top + 8 * s + ui_text_height(), 0xc0202020);
    ui_draw_text(true, x, top + 7 * s, 0xffffffff, text);
}

/* A black picture tells nothing by itself. */
static void label_difference(const view *v) {
    const comparison *c = &v->comparison;
    char text[2 * SIDE_NAME + 32], left[SIDE_NAME], right[SIDE_NAME];
    snprintf(text, sizeof text, "|%s - %s| x %.0f%s", side_name(v, 0, left), side_name(v, 1, right),
             (double)c->gain, c->ready && c->count.bits == 0 ? ": no bit differs" : "");
    draw_label(v, (float)v->picture.x + 12 * ui_scale(), text);
}

void compare_marks(view *v) {
    const comparison *c = &v->comparison;
    char text[SIDE_NAME];
    float x = (float)v->picture.x + (float)c->divider * (float)v->picture.width;
    float top = (float)v->picture.y, bottom = top + (float)v->picture.height, s = ui_scale();
    if (c->difference) {
        label_difference(v);
        return;
    }
    ui_draw_line(true, x, top, x, bottom, 0xc0202020, 2 * s);
    ui_draw_disc(true, x, (top + bottom) / 2, 8 * s, 0xff202020);
    ui_draw_disc(true, x, (top + bottom) / 2, 5 * s, 0xffe09a4a);
    for (int side = 0; side < 2; side++) {
        side_name(v, side, text);
        draw_label(v, side ? x + 12 * s : x - 12 * s - ui_text_width(text), text);
    }
}

bool compare_grabs(const view *v, double x) {
    double at = v->picture.x + v->comparison.divider * v->picture.width;
    return v->compare && !v->comparison.difference && fabs(x - at) < 9 * (double)ui_scale();
}

void compare_divide(view *v, double x) {
    double part = (x - v->picture.x) / fmax(1, v->picture.width);
    v->comparison.divider = fmax(0.02, fmin(0.98, part));
}
