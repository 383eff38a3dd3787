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

static void place_of(const ui_area *a, const sdv_layout *layout, uint32_t node, float at[2]) {
    float border = 8 * ui_scale();
    at[0] = a->x + border + layout->h[node] * (a->width - 2 * border);
    at[1] = a->y + border + (1 - layout->s[node]) * (a->height - 2 * border);
}

/* The reduced node that is drawn nearest to the pointer. */
static uint32_t nearest(const ui_area *a, const cli_tree *tree) {
    uint32_t best = SDV_NONE;
    float least = 1e30f, at[2];
    for (uint32_t i = 0; i < tree->reduced.node_count; i++) {
        place_of(a, &tree->layout, i, at);
        float d = hypotf(at[0] - a->pointer[0], at[1] - a->pointer[1]);
        if (d < least) {
            least = d;
            best = i;
        }
    }
    return best;
}

/* As the end of the branch has it in the picture. */
static uint32_t color_at(const cli_tree *tree, uint32_t branch) {
    uint32_t cone = tree->vessel.tree.parent_segments[tree->reduced.nodes[branch]];
    if (!tree->colors || cone >= tree->grid.cone_count)
        return color_of(tree->layout.h[branch], tree->layout.s[branch]);
    const uint8_t *c = tree->colors + 8 * (size_t)cone + 4;
    return 0xff000000u | (uint32_t)c[2] << 16 | (uint32_t)c[1] << 8 | c[0];
}

static void draw(const ui_area *a, const cli_tree *tree) {
    const sdv_reduced *reduced = &tree->reduced;
    for (uint32_t k = 0; k < reduced->node_count; k++) {
        uint32_t i = reduced->order[k], parent = reduced->parents[i];
        float from[2], to[2];
        if (parent == SDV_NONE)
            continue;
        place_of(a, &tree->layout, parent, from);
        place_of(a, &tree->layout, i, to);
        ui_draw_line(false, from[0], from[1], to[0], to[1], color_at(tree, i), 1.5f * ui_scale());
    }
}

/* The branch (reduced node) that a node of the tree lies on; SDV_NONE: none, or of another tree. */
static uint32_t branch_of(const cli_tree *tree, const view *v, const picked *p) {
    return tree && picked_on(v->doc->scene, p) == tree ? tree->reduced.owners[p->point] : SDV_NONE;
}

/* In the flat tree: the edge of a branch, and its end. */
static void mark_flat(const ui_area *a, const cli_tree *tree, uint32_t branch, uint32_t color) {
    uint32_t parent = branch == SDV_NONE ? SDV_NONE : tree->reduced.parents[branch];
    float from[2], to[2];
    if (branch == SDV_NONE)
        return;
    place_of(a, &tree->layout, branch, to);
    ui_draw_disc(false, to[0], to[1], 4 * ui_scale(), color);
    if (parent == SDV_NONE)
        return;
    place_of(a, &tree->layout, parent, from);
    ui_draw_line(false, from[0], from[1], to[0], to[1], color, 3 * ui_scale());
}

/* The tree that is laid out, if it has branches, or NULL. */
static const cli_tree *shown_tree(const view *v) {
    const cli_tree *tree = v->open ? picked_tree(v->doc->scene, &v->picked) : NULL;
    return tree && tree->reduced.node_count > 0 ? tree : NULL;
}

void panel_tree(view *v) {
    const cli_tree *tree = shown_tree(v);
    float width;
    char text[128];
    picked found;
    if (v->doc->command == CLI_VESSEL) /* which has targets and cuts */
        hands_tree(v);
    ui_space();
    if (!tree)
        return;
    ui_text_dim("The branches side by side, the root above. Point at one, or click it, here or in "
                "the picture.");
    ui_width_left(&width);
    ui_area a = ui_canvas("layout", width, 1.2f * width);
    ui_draw_box(false, a.x, a.y, a.x + a.width, a.y + a.height, 0xff202224);
    draw(&a, tree);
    uint32_t over = a.hovered ? nearest(&a, tree) : SDV_NONE;
    if (over != SDV_NONE) {
        uint32_t node = tree->reduced.nodes[over];
        pick_node(v->doc->scene, tree, node, &found);
        marks_hover(v, &found);
        snprintf(text, sizeof text, "node %u", node);
        ui_help(text);
        if (a.pressed && v->picked.point != node) {
            v->picked = found;
            stage_select(v);
            trace(v, "node %u", node);
        }
    } else if (v->hovered_flat) {
        memset(&v->hovered, 0, sizeof v->hovered);
    }
    v->hovered_flat = over != SDV_NONE;
    mark_flat(&a, tree, branch_of(tree, v, &v->picked), 0xff1030f0);
    mark_flat(&a, tree, branch_of(tree, v, &v->hovered), 0xffffffff);
}
