#include "vessel_marks.h"

#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int by_distance(const void *a, const void *b) {
    const cli_branch *x = a, *y = b;
    if (x->distance < y->distance || x->distance > y->distance)
        return x->distance < y->distance ? -1 : 1;
    return x->node < y->node ? -1 : 1;
}

cli_branch *cli_branches_at_risk(const cli_tree *tree, uint32_t *count) {
    uint32_t all = tree->reduced.node_count;
    cli_branch *list = cli_new(all, sizeof *list);
    *count = 0;
    for (uint32_t i = 0; list && i < all; i++) {
        if (tree->distances[i] < (float)tree->risk)
            list[(*count)++] = (cli_branch){i, tree->distances[i]};
    }
    if (list)
        qsort(list, *count, sizeof *list, by_distance);
    return list;
}

/* ---- what is named ---------------------------------------------------------------------- */

/* The place of a branch that is named: the middle of what is seen of it and at risk; else of what
 * is seen; else its node that is nearest to the target. */
typedef struct spot {
    uint32_t node;              /* of the tree: at it, or on the edge above */
    double at[2];               /* px: in the tree's picture */
    double sums[2][2], seen[2]; /* of pixels and their number: at risk; not */
    double apart;               /* px: of `at` from the mean, squared */
} spot;

/* To px of the picture and its depth. */
static void project(const cli_shot *shot, const float place[3], double out[3]) {
    double p[4] = {(double)place[0], (double)place[1], (double)place[2], 1};
    const float *matrices[2] = {shot->view, shot->projection};
    double width = shot->width + 2.0 * shot->margin, height = shot->height + 2.0 * shot->margin;
    for (int m = 0; m < 2; m++) {
        double q[4] = {0, 0, 0, 0};
        for (int k = 0; k < 16; k++)
            q[k % 4] += (double)matrices[m][k] * p[k / 4];
        memcpy(p, q, sizeof p);
    }
    out[0] = (0.5 + 0.5 * p[0] / p[3]) * width - shot->margin;
    out[1] = (0.5 - 0.5 * p[1] / p[3]) * height - shot->margin;
    out[2] = p[2] / p[3];
}

static spot nearest_spot(const cli_tree *tree, const cli_shot *shot, uint32_t branch) {
    const sdv_tree *t = &tree->vessel.tree;
    uint32_t end = tree->reduced.nodes[tree->reduced.parents[branch]];
    uint32_t node = tree->reduced.nodes[branch];
    spot s = {node, {0, 0}, {{0, 0}, {0, 0}}, {0, 0}, HUGE_VAL};
    double at[3];
    float least = SDV_FAR;
    for (; node != end && node != SDV_NONE; node = t->parents[node]) {
        float d = cli_node_distance(tree, node);
        s.node = d < least ? node : s.node;
        least = fminf(least, d);
    }
    const lao_v4 *n = &t->nodes[s.node];
    project(shot, (const float[3]){n->x, n->y, n->z}, at);
    memcpy(s.at, at, sizeof s.at);
    return s;
}

/* The lower node of a cone on the tree's way to the root; SDV_NONE: it is on no branch. */
static uint32_t lower_node(const cli_tree *tree, float cone) {
    const sdv_tree *t = &tree->vessel.tree;
    if (!(cone >= 0) || !(cone < (float)tree->grid.cone_count))
        return SDV_NONE;
    const uint32_t *ends = tree->grid.cone_nodes + 2 * (size_t)cone;
    return t->parents[ends[1]] == ends[0]   ? ends[1]
           : t->parents[ends[0]] == ends[1] ? ends[0]
                                            : SDV_NONE;
}

/* A pixel of a branch: first all are counted, then that nearest to their mean is taken. */
static void add_pixel(spot *s, uint32_t node, const double at[2], bool risky, bool counted) {
    int kind = s->seen[0] > 0 ? 0 : 1;
    if (!counted) {
        s->seen[!risky] += 1;
        s->sums[!risky][0] += at[0];
        s->sums[!risky][1] += at[1];
        return;
    }
    double dx = at[0] - s->sums[kind][0] / s->seen[kind];
    double dy = at[1] - s->sums[kind][1] / s->seen[kind];
    if (kind != !risky || dx * dx + dy * dy >= s->apart)
        return;
    s->apart = dx * dx + dy * dy;
    s->node = node;
    memcpy(s->at, at, sizeof s->at);
}

/* Pixels of the tree's picture and their depths, as the graph has them. */
typedef struct pixels {
    lao_read_info info;
    float *places, *depths; /* owned */
} pixels;

/* ranks: per reduced node, of its spot, SDV_NONE: it has none. */
static void add_pixels(const cli_tree *tree, const cli_shot *shot, const pixels *p,
                       const uint32_t *ranks, spot *spots, bool counted) {
    for (size_t i = 0; i < (size_t)p->info.width * p->info.height; i++) {
        const float *q = p->places + 4 * i;
        uint32_t node = lower_node(tree, q[3]);
        uint32_t owner = node == SDV_NONE ? SDV_NONE : tree->reduced.owners[node];
        double at[3];
        if (owner == SDV_NONE || ranks[owner] == SDV_NONE)
            continue;
        project(shot, q, at);
        bool inside = at[0] >= 0 && at[1] >= 0 && at[0] < shot->width && at[1] < shot->height;
        if (!inside || at[2] > (double)p->depths[i] + 1e-4) /* the target hides it */
            continue;
        float distance = sdv_target_point(tree->target, lao_v3_make(q[0], q[1], q[2]));
        add_pixel(&spots[ranks[owner]], node, at, distance < (float)tree->risk, counted);
    }
}

/* False: reported. */
static bool find_seen(const cli_tree *tree, const cli_shot *shot, cli_session *session,
                      const uint32_t *ranks, spot *spots) {
    pixels p;
    lao_read_info info;
    p.places = cli_session_image(session, "vessel_position", 0, &p.info);
    p.depths = p.places ? cli_session_image(session, "zbuffer", 0, &info) : NULL;
    bool ok = p.places && p.depths;
    for (int counted = 0; ok && counted < 2; counted++)
        add_pixels(tree, shot, &p, ranks, spots, counted);
    free(p.places);
    free(p.depths);
    return ok || cli_fail("what the picture shows cannot be read");
}

/* ---- where its number goes -------------------------------------------------------------- */

static void write_number(const cli_marks *n, uint32_t view, uint32_t index, char text[16]) {
    snprintf(text, 16, view == 0 && !n->seen[index] ? "(%u)" : "%u", index + 1);
}

/* The nearest first, until numbers cover so much of a picture that they hide what they name. */
static void place_all(cli_marks *n, const uint32_t size[2]) {
    const double most = (double)size[0] * size[1] / 32;
    double covered = 0;
    n->omitted = n->hidden = 0;
    for (uint32_t i = 0; i < 2 * n->count; i++) {
        cli_label *label = &n->labels[i % 2][i / 2];
        char text[16];
        write_number(n, i % 2, i / 2, text);
        label->half[0] = 0.5 * text_width(text, &n->style) + 1;
        label->half[1] = 0.45 * n->style.size;
        label->placed = false;
    }
    for (uint32_t i = 0; i < n->count; i++) {
        cli_label *in_tree = &n->labels[0][i], *in_layout = &n->labels[1][i];
        double area = 4 * in_tree->half[0] * in_tree->half[1];
        bool both = covered + area <= most && cli_label_place(n->labels[0], n->count, i, size) &&
                    cli_label_place(n->labels[1], n->count, i, size);
        in_tree->placed = in_layout->placed = both;
        covered += both ? area : 0;
        n->omitted += !both;
        n->hidden += both && !n->seen[i];
    }
}

/* In the largest letters of a few sizes that leave room for all, else in the smallest ones. */
static void fit_all(cli_marks *n, double size, const uint32_t room[2]) {
    static const double parts[] = {1, 0.85, 0.7};
    enum { LEGIBLE = 8 };
    double most = fmax(fmin(0.9 * size, 0.05 * fmin(room[0], room[1])), LEGIBLE + 1);
    n->style.bold = true;
    for (int k = 0; k < 3; k++)
        n->style.outline[k] = 1;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (i > 0 && (n->omitted == 0 || parts[i] * most < LEGIBLE))
            break;
        n->style.size = parts[i] * most;
        n->style.outline_width = fmax(1.2, 0.14 * n->style.size);
        place_all(n, room);
    }
}

/* Of the vessel at a spot in the picture, px: what a diameter to the camera's right spans. */
static double vessel_width(const cli_tree *tree, const cli_shot *shot, const spot *s) {
    const lao_v4 *n = &tree->vessel.tree.nodes[s->node];
    double a[3], b[3];
    float places[2][3];
    for (int k = 0; k < 2; k++) {
        float step = (k ? 1 : -1) * n->w;
        places[k][0] = n->x + step * shot->view[0];
        places[k][1] = n->y + step * shot->view[4];
        places[k][2] = n->z + step * shot->view[8];
    }
    project(shot, places[0], a);
    project(shot, places[1], b);
    return hypot(a[0] - b[0], a[1] - b[1]);
}

static bool anchor(const cli_tree *tree, const cli_shot *shot, cli_session *session,
                   const cli_branch *branches, cli_marks *n) {
    const uint32_t size[2] = {shot->width, shot->height};
    uint32_t *ranks = cli_new(tree->reduced.node_count, sizeof *ranks);
    spot *spots = cli_new(n->count, sizeof *spots);
    bool ok = ranks && spots;
    for (uint32_t i = 0; ok && i < tree->reduced.node_count; i++)
        ranks[i] = SDV_NONE;
    for (uint32_t i = 0; ok && i < n->count; i++) {
        ranks[branches[i].node] = i;
        spots[i] = nearest_spot(tree, shot, branches[i].node);
    }
    ok = ok && find_seen(tree, shot, session, ranks, spots);
    for (uint32_t i = 0; ok && i < n->count; i++) {
        cli_label *flat = &n->labels[1][i];
        n->seen[i] = spots[i].apart < HUGE_VAL;
        memcpy(n->labels[0][i].anchor, spots[i].at, sizeof spots[i].at);
        n->labels[0][i].wide = n->seen[i] ? vessel_width(tree, shot, &spots[i]) : HUGE_VAL;
        flat->wide = cli_flat_place(tree, size, branches[i].node, spots[i].node, flat->anchor);
    }
    free(ranks);
    free(spots);
    return ok;
}

bool cli_marks_make(const cli_tree *tree, const cli_shot *shot, cli_session *session, double size,
                    cli_marks *out) {
    const uint32_t room[2] = {shot->width, shot->height};
    memset(out, 0, sizeof *out);
    cli_branch *branches = cli_branches_at_risk(tree, &out->count);
    out->seen = cli_new(out->count, sizeof *out->seen);
    for (int k = 0; k < 2; k++)
        out->labels[k] = cli_new(out->count, sizeof *out->labels[k]);
    bool ok = branches && out->seen && out->labels[0] && out->labels[1] &&
              anchor(tree, shot, session, branches, out);
    free(branches);
    if (ok)
        fit_all(out, size, room);
    return ok;
}

/* In the lower left corner of the tree's picture: what the numbers leave open. */
static bool draw_note(const cli_marks *n, const int64_t corner[2], uint32_t height, picture *p) {
    char text[96] = "";
    if (n->omitted > 0)
        snprintf(text, sizeof text, "no room for %u of %u numbers", n->omitted, n->count);
    if (n->hidden > 0)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s(n): hidden",
                 n->omitted > 0 ? "; " : "");
    return !*text || text_draw(p, corner[0] + (int64_t)(0.5 * n->style.size),
                               corner[1] + (int64_t)(height - 1.4 * n->style.size), TEXT_LEFT, text,
                               &n->style);
}

bool cli_marks_draw(const cli_marks *numbers, uint32_t view, const int64_t corner[2],
                    uint32_t height, picture *p) {
    bool ok = true;
    for (uint32_t i = numbers->count; ok && i-- > 0;) { /* the nearest is on top */
        char text[16];
        write_number(numbers, view, i, text);
        ok = !numbers->labels[view][i].placed ||
             cli_label_draw(&numbers->labels[view][i], text, &numbers->style, corner, p);
    }
    ok = ok && (view > 0 || draw_note(numbers, corner, height, p));
    return ok || cli_fail("out of memory");
}

void cli_marks_free(cli_marks *numbers) {
    free(numbers->seen);
    free(numbers->labels[0]);
    free(numbers->labels[1]);
    memset(numbers, 0, sizeof *numbers);
}
