/* The tree drawn flat (Lichtenberg 2019), beside the picture: what is clicked in one is marked in
 * the other. */
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* sdv_hsv as a colour of the user interface. */
static uint32_t color_of(float h, float s) {
    lao_v3 c = sdv_hsv(h, s, 1);
    return 0xff000000u | (uint32_t)(255 * c.z) << 16 | (uint32_t)(255 * c.y) << 8 |
           (uint32_t)(255 * c.x);
}

/* Where the tree is drawn: a place in the panel, and what of the tree it shows. */
typedef struct flat_tree {
    ui_area area;
    flat_view shown;
    const cli_tree *tree;
} flat_tree;

static void place_of(const flat_tree *f, uint32_t node, float at[2]) {
    const ui_area *a = &f->area;
    const flat_view *part = &f->shown;
    float border = 8 * ui_scale();
    at[0] = a->x + border +
            (f->tree->layout.h[node] - part->left) * part->zoom * (a->width - 2 * border);
    at[1] = a->y + border +
            (1 - f->tree->layout.s[node] - part->top) * part->zoom * (a->height - 2 * border);
}

/* The reduced node that is drawn nearest to the pointer. */
static uint32_t nearest(const flat_tree *f) {
    uint32_t best = SDV_NONE;
    float least = 1e30f, at[2];
    for (uint32_t i = 0; i < f->tree->reduced.node_count; i++) {
        place_of(f, i, at);
        float d = hypotf(at[0] - f->area.pointer[0], at[1] - f->area.pointer[1]);
        if (d < least) {
            least = d;
            best = i;
        }
    }
    return best;
}

/* The wheel zooms about the pointer, a drag moves; there is nothing beyond the whole. */
static void move(flat_view *part, const ui_area *a) {
    float before = part->zoom >= 1 ? part->zoom : 1;
    float x = (a->pointer[0] - a->x) / a->width, y = (a->pointer[1] - a->y) / a->height;
    part->zoom = fmaxf(1, fminf(64, before * powf(1.25f, a->wheel)));
    part->left += x / before - x / part->zoom - a->moved[0] / a->width / part->zoom;
    part->top += y / before - y / part->zoom - a->moved[1] / a->height / part->zoom;
    part->left = fmaxf(0, fminf(1 - 1 / part->zoom, part->left));
    part->top = fmaxf(0, fminf(1 - 1 / part->zoom, part->top));
}

/* As the end of the branch has it in the picture. */
static uint32_t color_at(const cli_tree *tree, uint32_t branch) {
    uint32_t cone = tree->vessel.tree.parent_segments[tree->reduced.nodes[branch]];
    if (!tree->colors || cone >= tree->grid.cone_count)
        return color_of(tree->layout.h[branch], tree->layout.s[branch]);
    const uint8_t *c = tree->colors + 8 * (size_t)cone + 4;
    return 0xff000000u | (uint32_t)c[2] << 16 | (uint32_t)c[1] << 8 | c[0];
}

static void draw(const flat_tree *f) {
    const cli_tree *tree = f->tree;
    const sdv_reduced *reduced = &tree->reduced;
    for (uint32_t k = 0; k < reduced->node_count; k++) {
        uint32_t i = reduced->order[k], parent = reduced->parents[i];
        float from[2], to[2];
        if (parent == SDV_NONE)
            continue;
        place_of(f, parent, from);
        place_of(f, i, to);
        ui_draw_line(false, from[0], from[1], to[0], to[1], color_at(tree, i), 1.5f * ui_scale());
    }
}

/* The branch (reduced node) that a node of the tree lies on; SDV_NONE: none, or of another tree. */
static uint32_t branch_of(const cli_tree *tree, const view *v, const picked *p) {
    return tree && picked_on(v->doc->scene, p) == tree ? tree->reduced.owners[p->point] : SDV_NONE;
}

/* In the flat tree: the edge of a branch, and its end. */
static void mark_flat(const flat_tree *f, uint32_t branch, uint32_t color) {
    uint32_t parent = branch == SDV_NONE ? SDV_NONE : f->tree->reduced.parents[branch];
    float from[2], to[2];
    if (branch == SDV_NONE)
        return;
    place_of(f, branch, to);
    ui_draw_disc(false, to[0], to[1], 4 * ui_scale(), color);
    if (parent == SDV_NONE)
        return;
    place_of(f, parent, from);
    ui_draw_line(false, from[0], from[1], to[0], to[1], color, 3 * ui_scale());
}

/* The tree that is laid out, if it has branches, or NULL. */
static const cli_tree *shown_tree(const view *v) {
    const cli_tree *tree = v->open ? picked_tree(v->doc->scene, &v->picked) : NULL;
    return tree && tree->reduced.node_count > 0 ? tree : NULL;
}

/* What the pointer is on is marked in both views, and what is clicked is told. */
static void point(view *v, const flat_tree *f) {
    uint32_t over = f->area.hovered ? nearest(f) : SDV_NONE;
    picked found;
    if (over != SDV_NONE) {
        pick_node(v->doc->scene, f->tree, f->tree->reduced.nodes[over], &found);
        marks_hover(v, &found);
        ui_help(found.title);
    } else if (v->hovered_flat) {
        memset(&v->hovered, 0, sizeof v->hovered);
    }
    v->hovered_flat = over != SDV_NONE;
    if (over == SDV_NONE || !f->area.clicked)
        return;
    v->picked = found;
    stage_select(v);
    trace(v, "node %u", found.point);
}

/* All of it can be seen, and nothing moves when a click makes room for what was picked. */
static float height_of(const view *v, float width) {
    float left = ui_height_left();
    if (v->picked.kind == PICKED_NOTHING)
        left -= (float)panel_picked_height();
    return fmaxf(0.5f * width, fminf(1.2f * width, left));
}

void panel_tree(view *v) {
    flat_tree f = {.tree = shown_tree(v)};
    float width;
    if (v->doc->command == CLI_VESSEL) /* which has targets and cuts */
        hands_tree(v);
    ui_space();
    if (!f.tree)
        return;
    ui_text_dim("The branches side by side, the root above. Point at one, or click it, here or in "
                "the picture. Wheel: larger. Drag: move.");
    ui_width_left(&width);
    f.area = ui_canvas("layout", width, height_of(v, width));
    move(&v->flat, &f.area);
    f.shown = v->flat;
    const window_rect place = {(int)f.area.x, (int)f.area.y, (int)f.area.width, (int)f.area.height};
    point(v, &f);
    ui_draw_box(false, f.area.x, f.area.y, f.area.x + f.area.width, f.area.y + f.area.height,
                0xff202224);
    ui_clip(false, place);
    draw(&f);
    mark_flat(&f, branch_of(f.tree, v, &v->picked), 0xff1030f0);
    mark_flat(&f, branch_of(f.tree, v, &v->hovered), 0xffffffff);
    ui_clip_end(false);
}
