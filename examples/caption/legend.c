#include "legend.h"

#include "text.h"

#include <math.h>
#include <string.h>

/* One legend's place in pixels: the bar, its ticks and the whole with its text. */
typedef struct layout {
    bool upright;
    int64_t x, y, length, thickness; /* of the bar */
    int64_t tick, gap;               /* length of a tick; between things */
    int64_t box[4];                  /* x, y, width, height of all */
    text_style style;
    colour_ticks ticks;
} layout;

static double text_size(const picture *p) {
    double least = p->width < p->height ? p->width : p->height;
    return fmin(fmax(0.028 * least, 11), 80);
}

/* Widest number beside the bar. */
static int64_t widest_tick(const layout *l) {
    int64_t widest = 0;
    for (uint32_t i = 0; i < l->ticks.count; i++) {
        char text[32];
        colour_tick_text(&l->ticks, i, text, sizeof text);
        int64_t width = text_width(text, &l->style);
        widest = width > widest ? width : widest;
    }
    return widest;
}

/* Sizes for a bar of this length, as if the whole began at (0, 0). */
static layout measure(legend_side side, const legend *one, double size, int64_t length) {
    layout l;
    memset(&l, 0, sizeof l);
    l.style.size = size;
    l.style.outline_width = fmax(1, 0.11 * size);
    l.upright = side != LEGEND_BOTTOM;
    l.length = length;
    l.thickness = (int64_t)(0.8 * size);
    l.tick = (int64_t)(0.3 * size) + 1;
    l.gap = (int64_t)(0.35 * size) + 1;
    uint32_t most = (uint32_t)fmax(2, (double)l.length / size / (l.upright ? 2.2 : 4));
    l.ticks = colour_ticks_make(one->range[0], one->range[1], most < 7 ? most : 7);
    int64_t line = (int64_t)ceil(size), title = 0,
            width = text_width(one->title ? one->title : "", &l.style);
    if (one->title && *one->title)
        title = line + (l.upright ? line / 2 : l.gap / 2);
    int64_t number = widest_tick(&l);
    if (l.upright) { /* numbers reach half a line over the ends of the bar */
        l.box[2] = l.thickness + l.tick + l.gap + number;
        l.box[3] = title + l.length + line / 2;
    } else {
        l.x = number / 2;
        l.box[2] = l.length + number;
        l.box[3] = title + l.thickness + l.tick + l.gap + line;
    }
    l.box[2] = l.box[2] > width ? l.box[2] : width;
    l.y = title;
    return l;
}

static void move(layout *l, int64_t x, int64_t y) {
    l->x += x;
    l->y += y;
    l->box[0] += x;
    l->box[1] += y;
}

/* Dark on light and light on dark; the outline is the other. */
static void choose_ink(const picture *p, layout *l) {
    double luma = picture_luma(p, l->box[0], l->box[1], l->box[2], l->box[3], 1);
    for (int k = 0; k < 3; k++) {
        l->style.ink[k] = luma > 0.45 ? 0.08 : 0.97;
        l->style.outline[k] = luma > 0.45 ? 1 : 0.05;
    }
}

/* Bar with a frame; low values at the bottom or at the left. */
static void draw_bar(picture *p, const layout *l, const colour_map *map) {
    int64_t width = l->upright ? l->thickness : l->length;
    int64_t height = l->upright ? l->length : l->thickness;
    int64_t rim = (int64_t)(l->style.size / 18) + 1;
    picture_fill(p, l->x - 2 * rim, l->y - 2 * rim, width + 4 * rim, height + 4 * rim,
                 l->style.outline, 0.7);
    picture_fill(p, l->x - rim, l->y - rim, width + 2 * rim, height + 2 * rim, l->style.ink, 1);
    for (int64_t i = 0; i < l->length; i++) {
        double rgb[3];
        colour_map_at(map, ((double)i + 0.5) / (double)l->length, rgb);
        if (l->upright)
            picture_fill(p, l->x, l->y + l->length - 1 - i, l->thickness, 1, rgb, 1);
        else
            picture_fill(p, l->x + i, l->y, 1, l->thickness, rgb, 1);
    }
}

static bool draw_ticks(picture *p, const layout *l, const double range[2]) {
    int64_t rim = (int64_t)(l->style.size / 18) + 1;
    bool ok = true;
    for (uint32_t i = 0; i < l->ticks.count && ok; i++) {
        char text[32];
        double at = (l->ticks.at[i] - range[0]) / (range[1] - range[0]);
        int64_t along = (int64_t)(at * (double)(l->length - 1) + 0.5);
        colour_tick_text(&l->ticks, i, text, sizeof text);
        if (l->upright) {
            int64_t y = l->y + l->length - 1 - along, x = l->x + l->thickness;
            picture_fill(p, x, y - rim / 2, l->tick, rim, l->style.ink, 1);
            ok = text_draw(p, x + l->tick + l->gap, y - (int64_t)(0.5 * l->style.size), TEXT_LEFT,
                           text, &l->style);
        } else {
            int64_t x = l->x + along, y = l->y + l->thickness;
            picture_fill(p, x - rim / 2, y, rim, l->tick, l->style.ink, 1);
            ok = text_draw(p, x, y + l->tick + l->gap / 2, TEXT_CENTER, text, &l->style);
        }
    }
    return ok;
}

static bool draw(picture *p, layout *l, const legend *one) {
    int64_t title = l->upright ? l->x : l->x + l->length / 2;
    choose_ink(p, l);
    draw_bar(p, l, one->map);
    return draw_ticks(p, l, one->range) &&
           text_draw(p, title, l->box[1], l->upright ? TEXT_LEFT : TEXT_CENTER,
                     one->title ? one->title : "", &l->style);
}

/* ---- where they stand ------------------------------------------------------------------- */

enum { MOST = 16 };
typedef struct arrangement {
    uint32_t count;
    layout each[MOST];
} arrangement;

/* The length of bars that stand in one line along their side. */
static int64_t shared_length(legend_side side, const legend *legends, uint32_t count, double size,
                             int64_t side_length, int64_t margin) {
    int64_t left = side_length - margin;
    for (uint32_t i = 0; i < count; i++)
        left -= measure(side, &legends[i], size, 0).box[side == LEGEND_BOTTOM ? 2 : 3] + margin;
    return left > 0 ? left / count : 0;
}

/* Places legends with text of this size, each further away from the side than the one before, or in
 * line along it. False: they do not fit, or would take too much of the picture. */
static bool arrange(const picture *p, legend_side side, const legend *legends, uint32_t count,
                    double size, bool in_line, arrangement *out) {
    bool bottom = side == LEGEND_BOTTOM;
    int64_t margin = (int64_t)(1.2 * size), used = margin, deepest = 0, at = 0;
    int64_t width = p->width, height = p->height, along = bottom ? width : height;
    int64_t length = (int64_t)((double)along * 0.45);
    if (in_line) {
        int64_t shared = shared_length(side, legends, count, size, along, margin);
        length = shared < length ? shared : length;
    }
    if ((double)length < 4 * size)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        layout *l = &out->each[i];
        *l = measure(side, &legends[i], size, length);
        int64_t extent = l->box[bottom ? 2 : 3], depth = l->box[bottom ? 3 : 2];
        int64_t start = in_line ? at : (along - extent) / 2;
        if (extent > along)
            return false;
        if (bottom)
            move(l, start, height - used - depth);
        else
            move(l, side == LEGEND_LEFT ? used : width - used - depth, start);
        at += extent + margin;
        deepest = depth > deepest ? depth : deepest;
        used += in_line ? 0 : depth + margin;
    }
    for (uint32_t i = 0; i < count && in_line; i++) { /* one edge, their middle at the side's */
        layout *l = &out->each[i];
        int64_t middle = (along - at + margin) / 2, edge = l->box[bottom ? 3 : 2] - deepest;
        move(l, bottom ? middle : side == LEGEND_RIGHT ? edge : 0, bottom ? edge : middle);
    }
    out->count = count;
    used += in_line ? deepest + margin : 0;
    return (double)used <= (in_line ? 0.6 : 0.42) * (double)(bottom ? height : width);
}

/* As many as there is room for, with text as large as there is. */
static arrangement arrange_most(const picture *p, legend_side side, const legend *legends,
                                uint32_t count) {
    const double usual = text_size(p), least = 8;
    arrangement made;
    for (count = count < MOST ? count : MOST; count > 0; count--) {
        double size = usual;
        while (size >= least) {
            if (arrange(p, side, legends, count, size, false, &made) ||
                (count > 1 && arrange(p, side, legends, count, size, true, &made)))
                return made;
            size *= 0.9;
        }
    }
    made.count = 0;
    return made;
}

uint32_t legend_room(uint32_t width, uint32_t height, legend_side side, const legend *legends,
                     uint32_t count) {
    picture p;
    memset(&p, 0, sizeof p);
    p.width = width;
    p.height = height;
    return arrange_most(&p, side, legends, count).count;
}

bool legend_draw(picture *p, legend_side side, const legend *legends, uint32_t count) {
    arrangement made = arrange_most(p, side, legends, count);
    bool ok = true;
    for (uint32_t i = 0; i < made.count && ok; i++)
        ok = draw(p, &made.each[i], &legends[i]);
    return ok;
}
