/* The 2D layout as a picture: edges in the colours of the tree, the thicker the wider their
 * vessels, and their distances spread over the plane between them (L19 3.4 and 5, Figs. 2 and 10;
 * METHODS 6.1, 8). L19 spreads the places of the tree and measures from there; but the mean of two
 * places far apart lies in the middle of the organ, where no vessel of the plane's neighbourhood
 * is, and the plane showed risks that there are not. A mean of distances lies between them. */
#include "vessel.h"

#include "colour.h"
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A part of an edge between two neighbouring nodes of the tree. */
typedef struct piece {
    double a[2], b[2];     /* px */
    double wide_a, wide_b; /* half widths, px */
    uint32_t from, to;     /* nodes */
} piece;

typedef struct flat {
    const cli_tree *tree;
    uint32_t width, height;
    double unit;              /* px: a 200th of the smaller side */
    cli_edges edges;          /* px */
    uint8_t *tones;           /* 4 per node of the tree */
    float *apart;             /* per pixel: signed distance to the nearest edge's rim, px */
    uint32_t *owner;          /* per pixel: the piece that is nearest */
    float *along;             /* and where on it, 0 .. 1 */
    float *nodes;             /* per node of the tree, mm: its distance; NULL: no target */
    float *distances, *other; /* per pixel, mm */
} flat;

/* ---- edges ------------------------------------------------------------------------------ */

static void place_of(const flat *f, uint32_t reduced, double out[2]) {
    const sdv_layout *l = &f->tree->layout;
    double margin = 8 * f->unit, w = f->width - 2 * margin, h = f->height - 2 * margin;
    if (f->tree->source->layout.layout_radial > 0) {
        lao_v2 p = sdv_radial(l->h[reduced], l->s[reduced]);
        double reach = 0.5 * fmin(w, h);
        out[0] = 0.5 * f->width + reach * (double)p.x;
        out[1] = 0.5 * f->height - reach * (double)p.y;
        return;
    }
    out[0] = margin + w * (double)l->h[reduced];
    out[1] = margin + h * (1 - (double)l->s[reduced]);
}

static double length(const lao_v4 *a, const lao_v4 *b) {
    return hypot(hypot((double)(a->x - b->x), (double)(a->y - b->y)), (double)(a->z - b->z));
}

/* Where edges are few the thinnest have a 200th of the page and the widest four times as much; the
 * more there are the thinner they get, down to what can be seen, and those of the trunk less so. */
cli_edges cli_edges_make(const cli_tree *tree, double width, double height, double pixel) {
    const sdv_tree *t = &tree->vessel.tree;
    double unit = fmin(width, height) / 200, fits = 0.35 * width / tree->layout.node_count;
    cli_edges e = {0, 0, SDV_FAR, 0};
    for (uint32_t i = 0; i < t->node_count; i++) {
        e.least = fmin(e.least, sqrt((double)t->nodes[i].w));
        e.widest = fmax(e.widest, sqrt((double)t->nodes[i].w));
    }
    e.thin = fmin(fmax(fits, 0.7 * pixel), 0.5 * unit);
    e.thick = fmax(4 * e.thin, 0.8 * unit);
    return e;
}

double cli_edge_half(const cli_edges *edges, const cli_tree *tree, uint32_t node) {
    double root = sqrt((double)tree->vessel.tree.nodes[node].w),
           range = edges->widest - edges->least;
    double part = range > 1e-3 * edges->widest ? (root - edges->least) / range : 0.5;
    return edges->thin + part * (edges->thick - edges->thin);
}

/* Signed distance in px of a place to a piece, and where on it. */
static double piece_distance(const piece *p, double x, double y, double *t) {
    double dx = p->b[0] - p->a[0], dy = p->b[1] - p->a[1], size = dx * dx + dy * dy;
    *t = size > 0 ? fmin(fmax(((x - p->a[0]) * dx + (y - p->a[1]) * dy) / size, 0), 1) : 1;
    double u = x - p->a[0] - *t * dx, v = y - p->a[1] - *t * dy;
    return sqrt(u * u + v * v) - (p->wide_a + *t * (p->wide_b - p->wide_a));
}

/* Keeps a piece where it is the nearest. */
static void put_piece(flat *f, const piece *p, uint32_t index) {
    double wide = fmax(p->wide_a, p->wide_b) + 4;
    int64_t x0 = (int64_t)floor(fmin(p->a[0], p->b[0]) - wide), x1, y0, y1;
    x1 = (int64_t)ceil(fmax(p->a[0], p->b[0]) + wide);
    y0 = (int64_t)floor(fmin(p->a[1], p->b[1]) - wide);
    y1 = (int64_t)ceil(fmax(p->a[1], p->b[1]) + wide);
    for (int64_t y = y0 < 0 ? 0 : y0; y < y1 && y < f->height; y++) {
        for (int64_t x = x0 < 0 ? 0 : x0; x < x1 && x < f->width; x++) {
            size_t i = (size_t)y * f->width + (size_t)x;
            double t, d = piece_distance(p, (double)x + 0.5, (double)y + 0.5, &t);
            if (d < (double)f->apart[i]) {
                f->apart[i] = (float)d;
                f->owner[i] = index;
                f->along[i] = (float)t;
            }
        }
    }
}

/* The edge above a reduced node, cut at the tree's nodes by their way along the vessel. Returns the
 * number of pieces; `to` NULL: only counted. */
static uint32_t edge_pieces(const flat *f, uint32_t reduced, piece *to) {
    const sdv_reduced *r = &f->tree->reduced;
    const sdv_tree *t = &f->tree->vessel.tree;
    uint32_t end = r->nodes[r->parents[reduced]], node, count = 0;
    double top[2], low[2], total = 0, done = 0;
    for (node = r->nodes[reduced]; node != end && t->parents[node] != SDV_NONE; count++) {
        total += length(&t->nodes[node], &t->nodes[t->parents[node]]);
        node = t->parents[node];
    }
    if (!to)
        return count ? count : 1;
    place_of(f, r->parents[reduced], top);
    place_of(f, reduced, low);
    node = r->nodes[reduced];
    for (uint32_t i = 0; i < (count ? count : 1); i++) {
        uint32_t above = count ? t->parents[node] : node;
        double from = total > 0 ? done / total : (double)i / (count ? count : 1), until;
        done += length(&t->nodes[node], &t->nodes[above]);
        until = i + 1 >= count ? 1 : total > 0 ? done / total : (double)(i + 1) / count;
        for (int k = 0; k < 2; k++) {
            to[i].b[k] = low[k] + from * (top[k] - low[k]);
            to[i].a[k] = low[k] + until * (top[k] - low[k]);
        }
        to[i].from = above;
        to[i].to = node;
        to[i].wide_a = cli_edge_half(&f->edges, f->tree, above);
        to[i].wide_b = cli_edge_half(&f->edges, f->tree, node);
        node = above;
    }
    return count ? count : 1;
}

/* All pieces, for free(). NULL: reported. */
static piece *make_pieces(const flat *f, uint32_t *count) {
    const sdv_reduced *r = &f->tree->reduced;
    *count = 0;
    for (uint32_t i = 0; i < r->node_count; i++)
        *count += r->parents[i] == SDV_NONE ? 0 : edge_pieces(f, i, NULL);
    piece *pieces = cli_new(*count, sizeof *pieces);
    uint32_t done = 0;
    for (uint32_t i = 0; pieces && i < r->node_count; i++) {
        if (r->parents[i] != SDV_NONE)
            done += edge_pieces(f, i, pieces + done);
    }
    return pieces;
}

/* ---- the plane between them ------------------------------------------------------------- */

/* Distances where an edge is; then everywhere. */
static bool spread(flat *f, const piece *pieces) {
    size_t count = (size_t)f->width * f->height;
    sdv_pull_push_desc desc;
    for (size_t i = 0; i < count; i++) {
        const piece *p = f->owner[i] == SDV_NONE ? NULL : &pieces[f->owner[i]];
        bool on = p && f->apart[i] < 0.5f;
        f->other[i] = on ? 1 : 0;
        f->distances[i] =
            on ? f->nodes[p->from] + f->along[i] * (f->nodes[p->to] - f->nodes[p->from]) : 0;
    }
    memset(&desc, 0, sizeof desc);
    desc.width = f->width;
    desc.height = f->height;
    desc.channels = 1;
    desc.values = f->distances;
    desc.weights = f->other;
    desc.exponent = 25; /* what is near counts, as in the void of the 3D view */
    return sdv_pull_push(&f->tree->host, &desc, NULL) == LAO_OK;
}

/* One step of diffusion everywhere but where there is a risk, which stays as it is (L19 5). */
static void smooth_once(flat *f) {
    float risk = (float)f->tree->risk, *d = f->distances;
    size_t w = f->width;
    for (size_t y = 0; y < f->height; y++) {
        for (size_t x = 0; x < w; x++) {
            size_t i = y * w + x;
            float sum = d[x ? i - 1 : i] + d[x + 1 < w ? i + 1 : i] + d[y ? i - w : i] +
                        d[y + 1 < f->height ? i + w : i];
            f->other[i] = d[i] < risk ? d[i] : fmaxf(risk, 0.25f * sum);
        }
    }
    f->distances = f->other;
    f->other = d;
}

static void smooth(flat *f) {
    uint32_t steps = (uint32_t)(8 * f->unit * f->unit) + 4; /* a Gaussian of 2 units */
    for (uint32_t i = 0; i < (steps < 400 ? steps : 400); i++)
        smooth_once(f);
}

/* ---- colours ---------------------------------------------------------------------------- */

/* Ink of lines where the value is a multiple of `gap`, `wide` px thick. */
static double isoline(const flat *f, size_t x, size_t y, double gap, double wide) {
    const float *d = f->distances;
    size_t w = f->width, i = y * w + x;
    double dx = (double)(d[x + 1 < w ? i + 1 : i] - d[x ? i - 1 : i]) / (x && x + 1 < w ? 2 : 1);
    double dy = (double)(d[y + 1 < f->height ? i + w : i] - d[y ? i - w : i]) /
                (y && y + 1 < f->height ? 2 : 1);
    double steep = fmax(sqrt(dx * dx + dy * dy), 1e-3 * gap / f->unit);
    double off = fabs((double)d[i] / gap - floor((double)d[i] / gap + 0.5)) * gap / steep;
    return fmin(fmax(0.5 * wide + 0.5 - off, 0), 1);
}

/* The pattern of what is at risk: the styles' own, on a grid of the page. */
static double pattern(const flat *f, double x, double y) {
    const sdv_settings *s = &f->tree->settings;
    double period = 4.5 * f->unit, u = x / period, v = y / period;
    float values[SDV_SETTING_COUNT];
    lao_settings_resolve(sdv_module(), s, values);
    return (double)sdv_style_ink(
        (lao_int)values[SDV_SETTING_ID_mark_style] + SDV_STYLE_STIPPLE,
        (float)(LAO_TURN * (u - floor(u + 0.5))), (float)(LAO_TURN * (v - floor(v + 0.5))),
        values[SDV_SETTING_ID_mark_darkness], (float)(1 / period), (float)(1 / period), 1);
}

static void mix(double rgb[3], const double other[3], double part) {
    for (int k = 0; k < 3; k++)
        rgb[k] += part * (other[k] - rgb[k]);
}

/* A pixel of the plane between the edges. */
static void plane_colour(const flat *f, const colour_map *map, double gap, size_t x, size_t y,
                         double rgb[3]) {
    static const double black[3] = {0, 0, 0}, paper[3] = {1, 1, 1};
    const cli_tree *tree = f->tree;
    double d = (double)f->distances[y * f->width + x], risk = tree->risk;
    colour_map_at(map, (d - tree->range[0]) / (tree->range[1] - tree->range[0]), rgb);
    mix(rgb, paper, 0.42);
    if (d < fmax(tree->range[0], tree->range[1])) /* beyond, the scale tells nothing either */
        mix(rgb, black, 0.4 * isoline(f, x, y, gap, 0.45 * f->unit));
    if (!(risk > 0) || d >= 1.5 * risk)
        return;
    if (d < risk)
        mix(rgb, black, 0.85 * pattern(f, (double)x + 0.5, (double)y + 0.5));
    mix(rgb, black, 0.9 * isoline(f, x, y, risk, 0.9 * f->unit) * (d > 0.5 * risk));
}

static void edge_colour(const flat *f, const piece *p, double t, double rgb[3]) {
    for (int k = 0; k < 3; k++) {
        double a = f->tones[4 * (size_t)p->from + (size_t)k];
        rgb[k] = (a + t * (f->tones[4 * (size_t)p->to + (size_t)k] - a)) / 255;
    }
}

/* Distance between isolines: that of the ticks beside the scale. */
static double tick_gap(const cli_tree *tree) {
    colour_ticks ticks = colour_ticks_make(tree->range[0], tree->range[1], 7);
    return ticks.count > 1 ? ticks.at[1] - ticks.at[0]
                           : fabs(tree->range[1] - tree->range[0]) / 4 + 1e-6;
}

static void paint(const flat *f, const piece *pieces, const colour_map *map, picture *p) {
    static const double dark[3] = {0.1, 0.1, 0.12};
    double gap = map ? tick_gap(f->tree) : 1, rim = fmin(0.35 * f->unit, 1.4 * f->edges.thin);
    for (size_t y = 0; y < f->height; y++) {
        for (size_t x = 0; x < f->width; x++) {
            size_t i = y * f->width + x;
            double rgb[3], apart = (double)f->apart[i];
            if (map) {
                plane_colour(f, map, gap, x, y, rgb);
                picture_blend(p, (int64_t)x, (int64_t)y, rgb, 1);
            }
            if (f->owner[i] == SDV_NONE)
                continue;
            edge_colour(f, &pieces[f->owner[i]], (double)f->along[i], rgb);
            picture_blend(p, (int64_t)x, (int64_t)y, dark, fmin(fmax(0.5 + rim - apart, 0), 1));
            picture_blend(p, (int64_t)x, (int64_t)y, rgb, fmin(fmax(0.5 - apart, 0), 1));
        }
    }
}

/* ---- all -------------------------------------------------------------------------------- */

static bool make(flat *f) {
    const cli_tree *tree = f->tree;
    size_t count = (size_t)f->width * f->height;
    f->tones = cli_new(tree->vessel.tree.node_count, 4);
    f->apart = cli_new(count, sizeof *f->apart);
    f->owner = cli_new(count, sizeof *f->owner);
    f->along = cli_new(count, sizeof *f->along);
    if (!f->tones || !f->apart || !f->owner || !f->along)
        return false;
    memset(f->tones, 200, 4 * (size_t)tree->vessel.tree.node_count);
    for (uint32_t i = 0; i < 2 * tree->grid.cone_count; i++)
        memcpy(f->tones + 4 * (size_t)tree->grid.cone_nodes[i], tree->colors + 4 * (size_t)i, 4);
    for (size_t i = 0; i < count; i++) {
        f->apart[i] = SDV_FAR;
        f->owner[i] = SDV_NONE;
    }
    if (!tree->target || !tree->value || strcmp(tree->value, "distance") != 0)
        return true;
    f->nodes = cli_new(tree->vessel.tree.node_count, sizeof *f->nodes);
    f->distances = cli_new(count, sizeof *f->distances);
    f->other = cli_new(count, sizeof *f->other);
    for (uint32_t i = 0; f->nodes && i < tree->vessel.tree.node_count; i++)
        f->nodes[i] = cli_node_distance(tree, i);
    return f->nodes && f->distances && f->other;
}

static bool draw(flat *f, picture *p) {
    uint32_t count;
    piece *pieces = make_pieces(f, &count);
    colour_map *map = f->distances ? cli_new(1, sizeof *map) : NULL;
    bool ok = pieces && (!f->distances || map);
    for (uint32_t i = 0; ok && i < count; i++)
        put_piece(f, &pieces[i], i);
    if (ok && map) {
        colour_map_make(f->tree->colormap, map);
        ok = spread(f, pieces);
    }
    if (ok && map)
        smooth(f);
    if (ok)
        paint(f, pieces, map, p);
    free(map);
    free(pieces);
    return ok;
}

static flat begin(const cli_tree *tree, uint32_t width, uint32_t height) {
    flat f;
    memset(&f, 0, sizeof f);
    f.tree = tree;
    f.width = width;
    f.height = height;
    f.unit = fmin(width, height) / 200.0;
    f.edges = cli_edges_make(tree, width, height, 1);
    return f;
}

/* Length of the tree from a node up to another one, mm. */
static double way_up(const sdv_tree *t, uint32_t node, uint32_t end) {
    double sum = 0;
    for (; node != end && t->parents[node] != SDV_NONE; node = t->parents[node])
        sum += length(&t->nodes[node], &t->nodes[t->parents[node]]);
    return sum;
}

double cli_flat_place(const cli_tree *tree, const uint32_t size[2], uint32_t branch, uint32_t node,
                      double out[2]) {
    const flat f = begin(tree, size[0], size[1]);
    const sdv_tree *t = &tree->vessel.tree;
    uint32_t above = tree->reduced.parents[branch];
    double whole = way_up(t, tree->reduced.nodes[branch], tree->reduced.nodes[above]), part = 0.5;
    double top[2], low[2];
    place_of(&f, above, top);
    place_of(&f, branch, low);
    if (whole > 0)
        part = way_up(t, node, tree->reduced.nodes[above]) / whole;
    part = fmin(fmax(part, 0.15), 0.85); /* ends are those of other branches too */
    for (int k = 0; k < 2; k++)
        out[k] = top[k] + part * (low[k] - top[k]);
    return 2 * cli_edge_half(&f.edges, tree, node);
}

bool cli_flat_draw(const cli_tree *tree, picture *p) {
    flat f = begin(tree, p->width, p->height);
    bool ok = make(&f) && draw(&f, p);
    free(f.tones);
    free(f.apart);
    free(f.owner);
    free(f.along);
    free(f.nodes);
    free(f.distances);
    free(f.other);
    return ok;
}
