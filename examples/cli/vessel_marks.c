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

/* The place of a branch that is named is a place of its middle line: that of the last picture while
 * something of the vessel is seen there; else the one nearest to the middle of what is seen of the
 * branch and at risk; else of what is seen; else that of the last picture, or the node that is
 * nearest to the target. Its label points to the pixel of the branch that is nearest to there. */
typedef struct spot {
    cli_axis axis;
    double middle[2];           /* px: the place on the middle line, in the tree's picture */
    double at[2];               /* px: what is pointed to */
    double apart;               /* px: of `at` from the middle, squared; HUGE_VAL: none is seen */
    double sums[2][2], seen[2]; /* of pixels and their number: at risk; not */
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

/* The ball of the tree at a place of its middle line. */
static lao_v4 ball_at(const cli_tree *tree, const cli_axis *axis) {
    const sdv_tree *t = &tree->vessel.tree;
    const lao_v4 *a = &t->nodes[axis->node];
    const lao_v4 *b = t->parents[axis->node] == SDV_NONE ? a : &t->nodes[t->parents[axis->node]];
    return lao_v4_make(a->x + axis->part * (b->x - a->x), a->y + axis->part * (b->y - a->y),
                       a->z + axis->part * (b->z - a->z), a->w + axis->part * (b->w - a->w));
}

static float distance_to(const lao_v4 *ball, const float place[3]) {
    return hypotf(hypotf(place[0] - ball->x, place[1] - ball->y), place[2] - ball->z);
}

/* The place of the middle line above a node that is nearest to one of its vessel's surface. */
static cli_axis axis_at(const cli_tree *tree, uint32_t node, const float place[3]) {
    const cli_axis from = {node, 0}, to = {node, 1};
    const lao_v4 a = ball_at(tree, &from), b = ball_at(tree, &to);
    float d[3] = {b.x - a.x, b.y - a.y, b.z - a.z};
    float size = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    float along = (place[0] - a.x) * d[0] + (place[1] - a.y) * d[1] + (place[2] - a.z) * d[2];
    return (cli_axis){node, size > 0 ? fminf(fmaxf(along / size, 0), 1) : 0};
}

static cli_axis nearest_axis(const cli_tree *tree, uint32_t branch) {
    const sdv_tree *t = &tree->vessel.tree;
    uint32_t end = tree->reduced.nodes[tree->reduced.parents[branch]];
    uint32_t node = tree->reduced.nodes[branch];
    cli_axis nearest = {node, 0};
    float least = SDV_FAR;
    for (; node != end && node != SDV_NONE; node = t->parents[node]) {
        float d = cli_node_distance(tree, node);
        nearest.node = d < least ? node : nearest.node;
        least = fminf(least, d);
    }
    return nearest;
}

static void set_spot(const cli_tree *tree, const cli_shot *shot, cli_axis axis, spot *s) {
    lao_v4 ball = ball_at(tree, &axis);
    double at[3];
    project(shot, (const float[3]){ball.x, ball.y, ball.z}, at);
    s->axis = axis;
    memcpy(s->middle, at, sizeof s->middle);
    memcpy(s->at, at, sizeof s->at);
    s->apart = HUGE_VAL;
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

/* A pixel that shows a place of a branch. */
typedef struct seen_pixel {
    const float *place;
    uint32_t node; /* it is on the edge above */
    double at[2];
    bool risky;
} seen_pixel;

static double apart(const double a[2], const double b[2]) {
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
}

/* First all are counted, and those that show the place of the last picture compared; then, where
 * none did, that nearest to the mean is looked for; then again that which shows it best. */
enum { COUNTED, MEAN, SHOWN, PASSES };
static void add_pixel(const cli_tree *tree, const seen_pixel *p, int pass, spot *s) {
    lao_v4 ball = ball_at(tree, &s->axis);
    int kind = s->seen[0] > 0 ? 0 : 1;
    if (pass == COUNTED) {
        s->seen[!p->risky] += 1;
        s->sums[!p->risky][0] += p->at[0];
        s->sums[!p->risky][1] += p->at[1];
    }
    if (pass == MEAN) { /* of a spot whose place is not seen */
        const double mean[2] = {s->sums[kind][0] / s->seen[kind], s->sums[kind][1] / s->seen[kind]};
        double d = apart(p->at, mean);
        if (kind == !p->risky && d < s->apart) {
            s->axis = axis_at(tree, p->node, p->place);
            memcpy(s->at, p->at, sizeof s->at);
            s->apart = d;
        }
    } else if (distance_to(&ball, p->place) <= 1.25f * ball.w) {
        double d = apart(p->at, s->middle);
        if (d < s->apart) {
            memcpy(s->at, p->at, sizeof s->at);
            s->apart = d;
        }
    }
}

/* Pixels of the tree's picture and their depths, as the graph has them. */
typedef struct pixels {
    lao_read_info info;
    float *places, *depths; /* owned */
} pixels;

/* Looks at all pixels; ranks: per reduced node, of its spot, SDV_NONE: none is looked for. */
static void add_pixels(const cli_tree *tree, const cli_shot *shot, const pixels *p,
                       const uint32_t *ranks, spot *spots, int pass) {
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
        float distance =
            pass == SHOWN ? 0 : sdv_target_point(tree->target, lao_v3_make(q[0], q[1], q[2]));
        const seen_pixel seen = {q, node, {at[0], at[1]}, distance < (float)tree->risk};
        add_pixel(tree, &seen, pass, &spots[ranks[owner]]);
    }
}

/* After a pass the next one looks for spots that have no pixel yet. */
static void choose(const cli_tree *tree, const cli_shot *shot, const cli_marks *n, int pass,
                   uint32_t *ranks, spot *spots) {
    for (uint32_t i = 0; i < n->count; i++) {
        spot *s = &spots[i];
        uint32_t *rank = &ranks[n->branches[i].node];
        bool any = s->seen[0] > 0 || s->seen[1] > 0;
        if (pass == COUNTED && (!any || s->apart < HUGE_VAL))
            *rank = SDV_NONE;
        if (pass == MEAN && *rank != SDV_NONE) {
            double at[2] = {s->at[0], s->at[1]};
            set_spot(tree, shot, s->axis, s);
            memcpy(s->at, at, sizeof at);
            s->apart = apart(at, s->middle);
        }
    }
}

/* False: reported. */
static bool find_seen(const cli_tree *tree, const cli_shot *shot, cli_session *session,
                      const cli_marks *n, uint32_t *ranks, spot *spots) {
    pixels p;
    lao_read_info info;
    p.places = cli_session_image(session, "vessel_position", 0, &p.info);
    p.depths = p.places ? cli_session_image(session, "zbuffer", 0, &info) : NULL;
    bool ok = p.places && p.depths;
    for (int pass = 0; ok && pass < PASSES; pass++) {
        add_pixels(tree, shot, &p, ranks, spots, pass);
        choose(tree, shot, n, pass, ranks, spots);
    }
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

/* In the largest letters of a few sizes that leave room for all, else in the smallest ones; further
 * pictures have those of the first. */
static void fit_all(cli_marks *n, double size, const uint32_t room[2]) {
    static const double parts[] = {1, 0.85, 0.7};
    enum { LEGIBLE = 8 };
    if (n->style.size > 0) {
        place_all(n, room);
        return;
    }
    double most = fmax(fmin(0.9 * size, 0.05 * fmin(room[0], room[1])), LEGIBLE + 1);
    n->style.bold = true;
    for (int k = 0; k < 3; k++)
        n->style.outline[k] = 1;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (i > 0 && (n->omitted == 0 || parts[i] * most < LEGIBLE))
            break;
        for (uint32_t k = 0; k < n->count; k++) /* places are of letters of their size */
            n->labels[0][k].kept = n->labels[1][k].kept = false;
        n->style.size = parts[i] * most;
        n->style.outline_width = fmax(1.2, 0.14 * n->style.size);
        place_all(n, room);
    }
}

/* Of the vessel at a spot in the picture, px: what a diameter to the camera's right spans. */
static double vessel_width(const cli_tree *tree, const cli_shot *shot, const spot *s) {
    const lao_v4 n = ball_at(tree, &s->axis);
    double a[3], b[3];
    float places[2][3];
    for (int k = 0; k < 2; k++) {
        float step = (k ? 1 : -1) * n.w;
        places[k][0] = n.x + step * shot->view[0];
        places[k][1] = n.y + step * shot->view[4];
        places[k][2] = n.z + step * shot->view[8];
    }
    project(shot, places[0], a);
    project(shot, places[1], b);
    return hypot(a[0] - b[0], a[1] - b[1]);
}

/* Layouts do not turn: there the place of the first picture stays. */
static bool anchor(const cli_tree *tree, const cli_shot *shot, cli_session *session, cli_marks *n) {
    const uint32_t size[2] = {shot->width, shot->height};
    bool first = !(n->style.size > 0);
    uint32_t *ranks = cli_new(tree->reduced.node_count, sizeof *ranks);
    spot *spots = cli_new(n->count, sizeof *spots);
    bool ok = ranks && spots;
    for (uint32_t i = 0; ok && i < tree->reduced.node_count; i++)
        ranks[i] = SDV_NONE;
    for (uint32_t i = 0; ok && i < n->count; i++) {
        uint32_t branch = n->branches[i].node;
        memset(&spots[i], 0, sizeof spots[i]);
        ranks[branch] = i;
        set_spot(tree, shot, first ? nearest_axis(tree, branch) : n->axes[i], &spots[i]);
        if (first) /* it is not to be kept */
            spots[i].middle[0] = HUGE_VAL;
    }
    ok = ok && find_seen(tree, shot, session, n, ranks, spots);
    for (uint32_t i = 0; ok && i < n->count; i++) {
        cli_label *flat = &n->labels[1][i];
        n->axes[i] = spots[i].axis;
        n->seen[i] = spots[i].apart < HUGE_VAL;
        memcpy(n->labels[0][i].anchor, spots[i].at, sizeof spots[i].at);
        n->labels[0][i].wide = n->seen[i] ? vessel_width(tree, shot, &spots[i]) : HUGE_VAL;
        if (first)
            flat->wide =
                cli_flat_place(tree, size, n->branches[i].node, spots[i].axis.node, flat->anchor);
    }
    free(ranks);
    free(spots);
    return ok;
}

/* What all pictures have in common. */
static bool begin(const cli_tree *tree, cli_marks *n) {
    n->branches = cli_branches_at_risk(tree, &n->count);
    n->seen = cli_new(n->count, sizeof *n->seen);
    n->axes = cli_new(n->count, sizeof *n->axes);
    bool ok = n->branches && n->seen && n->axes;
    for (int k = 0; k < 2; k++) {
        n->labels[k] = cli_new(n->count, sizeof *n->labels[k]);
        ok = ok && n->labels[k];
        if (n->labels[k])
            memset(n->labels[k], 0, n->count * sizeof *n->labels[k]);
    }
    return ok;
}

bool cli_marks_make(const cli_tree *tree, const cli_shot *shot, cli_session *session, double size,
                    cli_marks *marks) {
    const uint32_t room[2] = {shot->width, shot->height};
    if ((!marks->branches && !begin(tree, marks)) || !anchor(tree, shot, session, marks))
        return false;
    fit_all(marks, size, room);
    return true;
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
    free(numbers->branches);
    free(numbers->seen);
    free(numbers->axes);
    free(numbers->labels[0]);
    free(numbers->labels[1]);
    memset(numbers, 0, sizeof *numbers);
}
