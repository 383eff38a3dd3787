/* One picture of a tree and its layout: side by side, or with several paths and targets a column
 * for each, the tree above its layout; one scale for all (L19 5, Figs. 2 and 10). */
#include "vessel_page.h"

#include "report.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SMALLEST = 32 }; /* px: of a panel */

static double text_size(const cli_options *options) {
    return fmin(fmax(0.028 * fmin(options->size[0], options->size[1]), 11), 80);
}

bool cli_page_make(const cli_options *options, bool scaled, cli_page *out) {
    const char *side = options->legend ? options->legend : "bottom";
    double size = text_size(options);
    int64_t room[2] = {options->size[0], options->size[1]};
    memset(out, 0, sizeof *out);
    out->options = options;
    out->columns = options->vessel.target_count ? options->vessel.target_count : 1;
    out->side = scaled && strcmp(side, "off") != 0 ? side : NULL;
    out->gap = (uint32_t)(0.5 * size) + 1;
    out->head = options->vessel.target_count ? (uint32_t)(1.7 * size) : 0;
    out->left = out->side && strcmp(side, "left") == 0 ? (uint32_t)(8.5 * size) : 0;
    if (out->side && strcmp(side, "right") == 0)
        room[0] -= (int64_t)(8.5 * size);
    if (out->side && strcmp(side, "bottom") == 0)
        room[1] -= (int64_t)(5.6 * size);
    uint32_t across = out->columns == 1 ? 2 : out->columns, down = out->columns == 1 ? 1 : 2;
    int64_t w = (room[0] - out->left - (int64_t)out->gap * (across + 1)) / across;
    int64_t h = (room[1] - out->head - (int64_t)out->gap * (down + 1)) / down;
    if (w < SMALLEST || h < SMALLEST)
        return cli_fail("--size: %ux%u is too small for %u views and their layouts",
                        options->size[0], options->size[1], out->columns);
    out->panel[0] = (uint32_t)w;
    out->panel[1] = (uint32_t)h;
    return true;
}

/* The left upper corner of a column's tree (0) or layout (1). */
static void corner(const cli_page *page, uint32_t column, uint32_t which, int64_t at[2]) {
    uint32_t x = page->columns == 1 ? which : column, y = page->columns == 1 ? 0 : which;
    at[0] = page->left + page->gap + (int64_t)x * (page->panel[0] + page->gap);
    at[1] = page->gap + page->head + (int64_t)y * (page->panel[1] + page->gap);
}

uint32_t cli_tree_at_risk(const cli_tree *tree, float *least) {
    uint32_t count = 0;
    *least = SDV_FAR;
    for (uint32_t i = 0; i < tree->reduced.node_count; i++) {
        *least = fminf(*least, tree->distances[i]);
        count += tree->distances[i] < (float)tree->risk ? 1 : 0;
    }
    for (uint32_t i = 0; i < tree->cone_count; i++) /* balls are on no edge */
        *least = fminf(*least, tree->cone_distances[i]);
    return count;
}

/* "path 2: 7 of 310 branches nearer than 15 mm, the nearest 3.2 mm" */
static bool head(const cli_page *page, const cli_tree *tree, uint32_t column, picture *p) {
    char text[160], number[32] = "";
    float least;
    int64_t at[2];
    uint32_t count = cli_tree_at_risk(tree, &least), all = 0;
    for (uint32_t i = 0; i < tree->reduced.node_count; i++)
        all += isnan(tree->distances[i]) ? 0 : 1;
    if (page->columns > 1)
        snprintf(number, sizeof number, "%u: ", column + 1);
    snprintf(text, sizeof text, "%s%u of %u branches nearer than %g mm; nearest %.1f mm", number,
             count, all, tree->risk, (double)least);
    text_style style;
    memset(&style, 0, sizeof style);
    style.size = text_size(page->options);
    uint32_t room = page->columns == 1 ? 2 * page->panel[0] + page->gap : page->panel[0];
    double width = 1.06 * text_width(text, &style);
    if (width > room)
        style.size = fmax(style.size * room / width, 7);
    corner(page, column, 0, at);
    bool dark = picture_luma(p, at[0], 0, room, page->head, 1) < 0.45;
    for (int k = 0; k < 3; k++)
        style.ink[k] = dark ? 0.97 : 0.08;
    return text_draw(p, at[0], page->gap + (int64_t)(0.2 * style.size), TEXT_LEFT, text, &style) ||
           cli_fail("out of memory");
}

/* ---- numbers of the nearest branches, the same in both views ---------------------------- */

uint32_t cli_nearest_branches(const cli_tree *tree, uint32_t list[CLI_NUMBERED]) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < tree->reduced.node_count; i++) {
        const float *d = tree->distances;
        uint32_t at = count;
        if (!(d[i] < (float)tree->risk))
            continue;
        while (at > 0 && d[i] < d[list[at - 1]])
            at--;
        count += count < CLI_NUMBERED;
        for (uint32_t k = count - 1; k > at && k < CLI_NUMBERED; k--)
            list[k] = list[k - 1];
        if (at < CLI_NUMBERED)
            list[at] = i;
    }
    return count;
}

/* The node of a branch that is nearest to the target, in pixels of the tree's picture. */
static void place_in_view(const cli_tree *tree, const cli_shot *shot, uint32_t branch,
                          double out[2]) {
    const sdv_tree *t = &tree->vessel.tree;
    uint32_t end = tree->reduced.nodes[tree->reduced.parents[branch]];
    uint32_t node = tree->reduced.nodes[branch], best = node;
    for (; node != end && node != SDV_NONE; node = t->parents[node])
        best = cli_node_distance(tree, node) < cli_node_distance(tree, best) ? node : best;
    double p[4] = {(double)t->nodes[best].x, (double)t->nodes[best].y, (double)t->nodes[best].z, 1};
    const float *matrices[2] = {shot->view, shot->projection};
    for (int m = 0; m < 2; m++) {
        double q[4] = {0, 0, 0, 0};
        for (int k = 0; k < 16; k++)
            q[k % 4] += (double)matrices[m][k] * p[k / 4];
        memcpy(p, q, sizeof p);
    }
    out[0] = (0.5 + 0.5 * p[0] / p[3]) * shot->width;
    out[1] = (0.5 - 0.5 * p[1] / p[3]) * shot->height;
}

/* The first place on a widening spiral where the number covers none before it. */
static void give_way(double places[][2], uint32_t index, double size) {
    double from[2] = {places[index][0], places[index][1]};
    for (int turn = 0; turn < 40; turn++) {
        bool free_place = true;
        double reach = 0.16 * turn * size;
        places[index][0] = from[0] + reach * cos(2.4 * turn);
        places[index][1] = from[1] + reach * sin(2.4 * turn);
        for (uint32_t i = 0; free_place && i < index; i++)
            free_place = fabs(places[i][0] - places[index][0]) > 0.75 * size ||
                         fabs(places[i][1] - places[index][1]) > size;
        if (free_place)
            return;
    }
}

static bool number_branches(const cli_page *page, const cli_tree *tree, const cli_shot *shot,
                            const int64_t at[2], uint32_t which, picture *p) {
    uint32_t list[CLI_NUMBERED], count = cli_nearest_branches(tree, list);
    double places[CLI_NUMBERED][2];
    text_style style;
    bool ok = true;
    memset(&style, 0, sizeof style);
    style.size = fmin(1.1 * text_size(page->options), 0.08 * fmin(page->panel[0], page->panel[1]));
    style.outline_width = fmax(1.2, 0.14 * style.size);
    style.bold = true;
    for (int k = 0; k < 3; k++)
        style.outline[k] = 1;
    for (uint32_t i = 0; ok && i < count; i++) {
        char text[16];
        if (which)
            cli_flat_place(tree, page->panel, list[i], places[i]);
        else
            place_in_view(tree, shot, list[i], places[i]);
        give_way(places, i, style.size);
        snprintf(text, sizeof text, "%u", i + 1);
        if (places[i][0] > 0 && places[i][0] < page->panel[0] && places[i][1] > 0 &&
            places[i][1] < page->panel[1])
            ok = text_draw(p, at[0] + (int64_t)places[i][0],
                           at[1] + (int64_t)(places[i][1] - 0.5 * style.size), TEXT_CENTER, text,
                           &style);
    }
    return ok || cli_fail("out of memory");
}

static void frame(picture *p, const int64_t at[2], const uint32_t size[2]) {
    static const double grey[3] = {0.45, 0.45, 0.45};
    picture_fill(p, at[0] - 1, at[1] - 1, size[0] + 2, 1, grey, 1);
    picture_fill(p, at[0] - 1, at[1] + size[1], size[0] + 2, 1, grey, 1);
    picture_fill(p, at[0] - 1, at[1], 1, size[1], grey, 1);
    picture_fill(p, at[0] + size[0], at[1], 1, size[1], grey, 1);
}

bool cli_page_draw(const cli_page *page, const cli_tree *trees, const cli_shot *shot,
                   const picture *solids, const picture *flats, picture *p) {
    const double *paper = page->options->background;
    bool ok = true;
    picture_fill(p, 0, 0, p->width, p->height, paper, paper[3]);
    for (uint32_t i = 0; ok && i < page->columns; i++) {
        const picture *views[2] = {&solids[i], &flats[i]};
        for (uint32_t which = 0; ok && which < 2; which++) {
            int64_t at[2];
            corner(page, i, which, at);
            picture_over(p, at[0], at[1], views[which]);
            frame(p, at, page->panel);
            ok = !(trees[i].risk > 0) || number_branches(page, &trees[i], shot, at, which, p);
        }
        ok = ok && (!trees[i].aim || head(page, &trees[i], i, p));
    }
    return ok && (!page->side || cli_tree_legend(&trees[0], page->side, p));
}
