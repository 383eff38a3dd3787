/* What the pointer is on and what was clicked, marked over the picture: nothing of the picture is
 * drawn again for that. */
#include "view.h"

#include <stdio.h>
#include <string.h>

static const uint32_t chosen_color = 0xff1030f0, hovered_color = 0xffffffff;

enum { TIP_FACTS = 6, MARK_POINTS = 400 };

/* ---- places ------------------------------------------------------------------------------ */

/* Of the i-th point of a tree or a set of lines, mm, absolute. */
static void absolute(const float *point, const double origin[3], double at[3]) {
    for (int k = 0; k < 3; k++)
        at[k] = (double)point[k] + origin[k];
}

static void node_place(const cli_tree *tree, uint32_t node, double at[3]) {
    const lao_v4 *n = &tree->vessel.tree.nodes[node];
    const float point[3] = {n->x, n->y, n->z};
    absolute(point, tree->vessel.origin, at);
}

void marks_way(const view *v, const double a[3], const double b[3], uint32_t color, float width) {
    float from[2], to[2];
    if (stage_place(v, a, from) && stage_place(v, b, to))
        ui_draw_line(true, from[0], from[1], to[0], to[1], color, width * ui_scale());
}

/* ---- marks ------------------------------------------------------------------------------- */

/* The middle line of a branch. */
static void mark_branch(const view *v, const picked *p, uint32_t color) {
    const cli_tree *tree = picked_on(v->doc->scene, p);
    uint32_t branch = tree ? tree->reduced.owners[p->point] : SDV_NONE;
    for (uint32_t i = 0; branch != SDV_NONE && i < tree->vessel.tree.node_count; i++) {
        uint32_t parent = tree->vessel.tree.parents[i];
        double a[3], b[3];
        if (tree->reduced.owners[i] != branch || parent == SDV_NONE)
            continue;
        node_place(tree, parent, a);
        node_place(tree, i, b);
        marks_way(v, a, b, color, 2.5f);
    }
}

/* A line, as far as a few hundred of its points tell. */
static void mark_line(const view *v, const picked *p, uint32_t color) {
    const io_lines *lines = &v->doc->scene->sets[p->set].lines;
    uint32_t first = lines->offsets[p->line], last = lines->offsets[p->line + 1] - 1;
    uint32_t step = 1 + (last - first) / MARK_POINTS;
    double a[3], b[3];
    absolute(lines->points + 3 * (size_t)first, v->doc->scene->origin, a);
    for (uint32_t i = first; i < last;) {
        i = last - i > step ? i + step : last;
        absolute(lines->points + 3 * (size_t)i, v->doc->scene->origin, b);
        marks_way(v, a, b, color, 1.5f);
        memcpy(a, b, sizeof a);
    }
}

/* A cross where it was clicked. */
static void mark_place(const view *v, const picked *p, uint32_t color) {
    float at[2], r = 7 * ui_scale();
    if (!stage_place(v, p->at, at))
        return;
    for (int i = 0; i < 4; i++) {
        float x = i < 2 ? (i ? r : -r) : 0, y = i < 2 ? 0 : (i > 2 ? r : -r);
        ui_draw_line(true, at[0] + x, at[1] + y, at[0] + 0.3f * x, at[1] + 0.3f * y, color,
                     2 * ui_scale());
    }
}

/* What the axes are called, behind their ends. */
static void name_axes(const view *v) {
    for (int k = 0; k < 3; k++) {
        const char name[2] = {(char)('x' + k), '\0'};
        double end[3];
        float at[2], s = ui_scale();
        const float *color = stage_axis(v, k, end);
        if (!stage_place(v, end, at))
            continue;
        uint32_t rgba = 0xff000000u;
        for (int i = 0; i < 3; i++)
            rgba |= (uint32_t)(255 * color[i]) << 8 * i;
        ui_draw_text(true, at[0] + 5 * s, at[1] - ui_text_height(), rgba, name);
    }
}

/* Beside the pointer: what it is on. */
static void tell(const picked *p) {
    char text[512], fact[128];
    size_t used = (size_t)snprintf(text, sizeof text, "%s", p->title);
    for (uint32_t i = 0; i < p->fact_count && i < TIP_FACTS && used < sizeof text; i++) {
        pick_print(&p->facts[i], fact, sizeof fact);
        used += (size_t)snprintf(text + used, sizeof text - used, "\n%s", fact);
    }
    ui_tip(text);
}

void marks_draw(const view *v) {
    if (!v->open || v->picture.width < 1 || v->picture.height < 1)
        return;
    ui_clip(true, v->picture);
    if (v->axes && !v->compare)
        name_axes(v);
    if (v->picked.kind != PICKED_NOTHING) {
        mark_branch(v, &v->picked, chosen_color);
        mark_place(v, &v->picked, chosen_color);
    }
    mark_branch(v, &v->hovered, hovered_color);
    if (v->hovered.kind == PICKED_LINE)
        mark_line(v, &v->hovered, hovered_color);
    hands_marks(v);
    ui_clip_end(true);
    if (v->hovered.kind != PICKED_NOTHING && !v->hovered_flat && v->pointer.button < 0 &&
        !ui_has_pointer()) /* a dialog has opened there */
        tell(&v->hovered);
}

/* ---- the pointer ------------------------------------------------------------------------- */

void marks_hover(view *v, const picked *at) {
    const picked *was = &v->hovered;
    bool same = was->kind == at->kind && was->set == at->set && was->line == at->line &&
                was->point == at->point;
    v->hovered = *at;
    if (!same)
        trace(v, "hovers %d %u %u %u", (int)at->kind, at->set, at->line, at->point);
}
