#include "vessel_labels.h"

#include <math.h>

/* ---- where they go ---------------------------------------------------------------------- */

static bool boxes_meet(const cli_label *a, const cli_label *b) {
    return fabs(a->at[0] - b->at[0]) < a->half[0] + b->half[0] &&
           fabs(a->at[1] - b->at[1]) < a->half[1] + b->half[1];
}

static bool box_holds(const cli_label *a, const double p[2]) {
    return fabs(a->at[0] - p[0]) < a->half[0] && fabs(a->at[1] - p[1]) < a->half[1];
}

/* Does the line from b's box to its anchor go through a's box? Its part inside a slab of each axis
 * is an interval. */
static bool line_meets_box(const cli_label *a, const cli_label *b) {
    double from = 0, to = 1;
    for (int k = 0; k < 2; k++) {
        double start = b->at[k] - a->at[k], step = b->anchor[k] - b->at[k];
        double low = (-a->half[k] - start) / step, high = (a->half[k] - start) / step;
        if (fabs(step) < 1e-9) {
            if (fabs(start) >= a->half[k])
                return false;
            continue;
        }
        from = fmax(from, fmin(low, high));
        to = fmin(to, fmax(low, high));
    }
    return from < to;
}

/* Twice the area of a triangle, by its sense. */
static double turn(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool lines_cross(const cli_label *a, const cli_label *b) {
    return turn(a->at, a->anchor, b->at) * turn(a->at, a->anchor, b->anchor) < 0 &&
           turn(b->at, b->anchor, a->at) * turn(b->at, b->anchor, a->anchor) < 0;
}

/* From a line with two ends to a place. */
static double line_distance(const double a[2], const double b[2], double x, double y) {
    double dx = b[0] - a[0], dy = b[1] - a[1], size = dx * dx + dy * dy;
    double t = size > 0 ? fmin(fmax(((x - a[0]) * dx + (y - a[1]) * dy) / size, 0), 1) : 0;
    return hypot(x - a[0] - t * dx, y - a[1] - t * dy);
}

/* Would it lie where another one was in the picture before? */
static bool meets_kept(const cli_label *own, const cli_label *other) {
    cli_label before = *other;
    for (int k = 0; k < 2; k++)
        before.at[k] = other->anchor[k] + other->from[k];
    return boxes_meet(own, &before);
}

/* How bad a place is, in px of a longer line; INFINITY: impossible. */
static double cost(const cli_label *labels, uint32_t count, uint32_t index,
                   const uint32_t size[2]) {
    const cli_label *own = &labels[index];
    double sum = hypot(own->at[0] - own->anchor[0], own->at[1] - own->anchor[1]);
    double high = 2 * own->half[1];
    if (box_holds(own, own->anchor) && own->wide < high)
        sum += 1.3 * high;
    for (int k = 0; k < 2; k++) {
        if (own->at[k] < own->half[k] || own->at[k] > size[k] - own->half[k])
            return INFINITY;
    }
    for (uint32_t i = 0; i < count; i++) {
        const cli_label *other = &labels[i];
        if (i == index)
            continue;
        if (other->placed && (boxes_meet(own, other) || line_meets_box(own, other) ||
                              line_meets_box(other, own) || lines_cross(own, other)))
            return INFINITY;
        if (!other->placed && other->kept && meets_kept(own, other))
            sum += high;
        if (box_holds(own, other->anchor) ||
            line_distance(own->at, own->anchor, other->anchor[0], other->anchor[1]) < 0.3 * high)
            sum += high;
    }
    return sum;
}

bool cli_label_place(cli_label *labels, uint32_t count, uint32_t index, const uint32_t size[2]) {
    enum { RINGS = 12, ROUND = 16, WORTH = 3 };
    cli_label *own = &labels[index];
    double least = INFINITY, best[2] = {0, 0};
    own->placed = false;
    for (int i = 0; i < 1 + RINGS * ROUND; i++) {
        int rings = i ? (i - 1) / ROUND + 1 : 0;
        double ring = rings;
        double angle = (i + 0.5 * ring) * 6.283185307179586 / ROUND;
        own->at[0] = own->anchor[0] + 0.9 * ring * (own->half[0] + own->half[1]) * cos(angle);
        own->at[1] = own->anchor[1] + 1.5 * ring * own->half[1] * sin(angle);
        double bad = cost(labels, count, index, size);
        if (bad < least) {
            least = bad;
            best[0] = own->at[0];
            best[1] = own->at[1];
        }
    }
    for (int k = 0; k < 2; k++)
        own->at[k] = own->anchor[k] + own->from[k];
    own->placed = least < INFINITY;
    if (own->kept && cost(labels, count, index, size) <= least + WORTH * 2 * own->half[1])
        return own->placed;
    for (int k = 0; k < 2; k++) {
        own->at[k] = best[k];
        own->from[k] = own->placed ? best[k] - own->anchor[k] : own->from[k];
    }
    own->kept = own->kept || own->placed;
    return own->placed;
}

/* ---- how they look ---------------------------------------------------------------------- */

/* A line with round ends, `half` px to each side. */
static void draw_line(picture *p, const double a[2], const double b[2], double half,
                      const double rgb[3]) {
    int64_t x0 = (int64_t)floor(fmin(a[0], b[0]) - half), x1, y0, y1;
    x1 = (int64_t)ceil(fmax(a[0], b[0]) + half);
    y0 = (int64_t)floor(fmin(a[1], b[1]) - half);
    y1 = (int64_t)ceil(fmax(a[1], b[1]) + half);
    for (int64_t y = y0; y <= y1; y++) {
        for (int64_t x = x0; x <= x1; x++) {
            double off = line_distance(a, b, (double)x + 0.5, (double)y + 0.5);
            picture_blend(p, x, y, rgb, fmin(fmax(half + 0.5 - off, 0), 1));
        }
    }
}

/* From where the line leaves the box to the anchor, which has a dot. */
static void draw_pointer(const cli_label *l, double unit, const text_style *style,
                         const int64_t corner[2], picture *p) {
    double from[2], to[2], part = 1;
    for (int k = 0; k < 2; k++) {
        double off = fabs(l->anchor[k] - l->at[k]);
        part = off > 0 ? fmin(part, 0.8 * l->half[k] / off) : part;
    }
    for (int k = 0; k < 2; k++) {
        from[k] = (double)corner[k] + l->at[k] + part * (l->anchor[k] - l->at[k]);
        to[k] = (double)corner[k] + l->anchor[k];
    }
    draw_line(p, from, to, 1.6 * unit, style->outline);
    draw_line(p, to, to, 2.6 * unit, style->outline);
    draw_line(p, from, to, 0.6 * unit, style->ink);
    draw_line(p, to, to, 1.6 * unit, style->ink);
}

bool cli_label_draw(const cli_label *label, const char *text, const text_style *style,
                    const int64_t corner[2], picture *p) {
    if (!box_holds(label, label->anchor))
        draw_pointer(label, fmax(style->size / 14, 0.8), style, corner, p);
    return text_draw(p, corner[0] + (int64_t)lround(label->at[0]),
                     corner[1] + (int64_t)lround(label->at[1] - 0.5 * style->size), TEXT_CENTER,
                     text, style);
}
