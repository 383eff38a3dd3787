/* One picture of a tree and its layout: side by side, or with several paths and targets a column
 * for each, the tree above its layout; one scale for all (L19 5, Figs. 2 and 10). */
#include "vessel_page.h"

#include "report.h"

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
        return cli_fail("--size: %ux%u is too small for %u tree%s and layout%s; write a larger one",
                        options->size[0], options->size[1], out->columns,
                        out->columns > 1 ? "s" : "", out->columns > 1 ? "s" : "");
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

/* "2: 7 of 310 branches nearer than 15 mm; nearest 3.2 mm" */
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

static void frame(picture *p, const int64_t at[2], const uint32_t size[2]) {
    static const double grey[3] = {0.45, 0.45, 0.45};
    picture_fill(p, at[0] - 1, at[1] - 1, size[0] + 2, 1, grey, 1);
    picture_fill(p, at[0] - 1, at[1] + size[1], size[0] + 2, 1, grey, 1);
    picture_fill(p, at[0] - 1, at[1], 1, size[1], grey, 1);
    picture_fill(p, at[0] + size[0], at[1], 1, size[1], grey, 1);
}

/* A column: both views, their numbers, the line above. */
static bool draw_column(const cli_page *page, const cli_tree *tree, cli_session *session,
                        const picture *flat, uint32_t column, picture *p) {
    picture solid;
    if (!cli_session_picture(session, &solid))
        return false;
    const picture *views[2] = {&solid, flat};
    bool ok = true;
    for (uint32_t view = 0; ok && view < 2; view++) {
        int64_t at[2];
        corner(page, column, view, at);
        picture_over(p, at[0], at[1], views[view]);
        frame(p, at, page->panel);
        ok = cli_marks_draw(&page->marks[column], view, at, page->panel[1], p);
    }
    ok = ok && (!tree->aim || head(page, tree, column, p));
    picture_free(&solid);
    return ok;
}

bool cli_page_draw(const cli_page *page, const cli_tree *trees, cli_session *sessions,
                   const picture *flats, picture *p) {
    const double *paper = page->options->background;
    bool ok = true;
    picture_fill(p, 0, 0, p->width, p->height, paper, paper[3]);
    for (uint32_t i = 0; ok && i < page->columns; i++)
        ok = draw_column(page, &trees[i], &sessions[i], &flats[i], i, p);
    return ok && (!page->side || cli_tree_legend(&trees[0], page->side, p));
}

bool cli_page_number(cli_page *page, const cli_tree *trees, const cli_shot *shot,
                     cli_session *sessions) {
    double size = text_size(page->options);
    bool ok = true;
    for (uint32_t i = 0; ok && i < page->columns; i++)
        ok = !(trees[i].risk > 0) ||
             cli_marks_make(&trees[i], shot, &sessions[i], size, &page->marks[i]);
    return ok;
}

void cli_page_free(cli_page *page) {
    for (uint32_t i = 0; i < CLI_TARGETS; i++)
        cli_marks_free(&page->marks[i]);
}
