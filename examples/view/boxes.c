#include "boxes.h"

#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDE = 8 }; /* boxes in a box */

/* ---- making ------------------------------------------------------------------------------ */

static void clear(float box[6]) {
    for (int k = 0; k < 3; k++) {
        box[k] = INFINITY;
        box[3 + k] = -INFINITY;
    }
}

static void join(float box[6], const float other[6]) {
    for (int k = 0; k < 3; k++) {
        box[k] = fminf(box[k], other[k]);
        box[3 + k] = fmaxf(box[3 + k], other[3 + k]);
    }
}

/* The bits of a number of 10 bits, two free ones between each. */
static uint32_t spread(uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

/* Where a box's middle is on a curve that fills the space (Morton 1966); the end for one that is
 * nowhere. */
static uint32_t place_of(const float box[6], const float all[6]) {
    uint32_t code = 0;
    for (int k = 0; k < 3; k++) {
        double size = (double)all[3 + k] - (double)all[k];
        double at = 0.5 * ((double)box[k] + (double)box[3 + k]) - (double)all[k];
        if (!(box[k] <= box[3 + k]))
            return UINT32_MAX;
        code |= spread((uint32_t)(size > 0 ? 1023 * fmax(0, fmin(1, at / size)) : 0)) << k;
    }
    return code;
}

static int by_value(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Puts the items into the order of the curve. */
static bool sort(boxes *b, boxes_of of, const void *user) {
    uint64_t *keys = cli_new(b->item_count, sizeof *keys);
    boxes_item *sorted = cli_new(b->item_count, sizeof *sorted);
    float all[6], box[6];
    clear(all);
    for (uint32_t i = 0; keys && sorted && i < b->item_count; i++) {
        of(user, b->items[i], box);
        join(all, box);
    }
    for (uint32_t i = 0; keys && sorted && i < b->item_count; i++) {
        of(user, b->items[i], box);
        keys[i] = (uint64_t)place_of(box, all) << 32 | i;
    }
    bool ok = keys && sorted;
    if (ok)
        qsort(keys, b->item_count, sizeof *keys, by_value);
    for (uint32_t i = 0; ok && i < b->item_count; i++)
        sorted[i] = b->items[(uint32_t)keys[i]];
    if (ok) {
        free(b->items);
        b->items = sorted;
    } else {
        free(sorted);
    }
    free(keys);
    return ok;
}

static bool add_level(boxes *b, boxes_of of, const void *user) {
    uint32_t level = b->level_count, below = level ? b->counts[level - 1] : b->item_count;
    float box[6];
    b->counts[level] = (below - 1) / WIDE + 1;
    b->levels[level] = cli_new(b->counts[level], sizeof *b->levels[level]);
    if (!b->levels[level])
        return false;
    b->level_count++;
    for (uint32_t i = 0; i < below; i++) {
        float *in = b->levels[level][i / WIDE];
        if (i % WIDE == 0)
            clear(in);
        if (!level)
            of(user, b->items[i], box);
        join(in, level ? b->levels[level - 1][i] : box);
    }
    return true;
}

bool boxes_make(boxes_item *items, uint32_t count, boxes_of of, const void *user, boxes *out) {
    memset(out, 0, sizeof *out);
    out->items = items;
    out->item_count = count;
    if (!count)
        return true;
    bool ok = sort(out, of, user) && add_level(out, of, user);
    while (ok && out->counts[out->level_count - 1] > 1)
        ok = add_level(out, of, user);
    if (!ok)
        boxes_free(out);
    return ok;
}

void boxes_free(boxes *b) {
    free(b->items);
    for (uint32_t i = 0; i < b->level_count; i++)
        free(b->levels[i]);
    memset(b, 0, sizeof *b);
}

/* ---- asking ------------------------------------------------------------------------------ */

typedef struct walk {
    const boxes *boxes;
    const boxes_ray *ray;
    boxes_visit visit;
    void *user;
    double limit;
} walk;

/* How far along the ray a box begins, INFINITY: the ray passes it by. It is grown by how near the
 * ray must come to its farthest corner. */
static double entry(const boxes_ray *ray, const float box[6]) {
    double far = 0, begin = 0, end = INFINITY;
    if (!(box[0] <= box[3]))
        return INFINITY;
    for (int k = 0; k < 3; k++)
        far += ray->to[k] * ((double)box[ray->to[k] > 0 ? 3 + k : k] - ray->from[k]);
    double grown = ray->near + ray->slope * fmax(0, far);
    for (int k = 0; k < 3; k++) {
        double low = (double)box[k] - grown - ray->from[k];
        double high = (double)box[3 + k] + grown - ray->from[k], way = 1 / ray->to[k];
        if (fabs(ray->to[k]) < 1e-12) {
            if (low > 0 || high < 0)
                return INFINITY;
            continue;
        }
        begin = fmax(begin, way > 0 ? low * way : high * way);
        end = fmin(end, way > 0 ? high * way : low * way);
    }
    return begin <= end ? begin : INFINITY;
}

static void visit_items(walk *w, uint32_t box) {
    uint32_t first = box * WIDE, end = first + WIDE;
    for (uint32_t i = first; i < end && i < w->boxes->item_count; i++)
        w->limit = fmin(w->limit, w->visit(w->user, w->boxes->items[i]));
}

static void descend(walk *w, uint32_t level, uint32_t first, uint32_t count) {
    double entries[WIDE];
    uint32_t order[WIDE], found = 0;
    for (uint32_t i = 0; i < count; i++) {
        double at = entry(w->ray, w->boxes->levels[level][first + i]);
        uint32_t place = found;
        if (!(at < w->limit))
            continue;
        for (; place > 0 && entries[place - 1] > at; place--) {
            entries[place] = entries[place - 1];
            order[place] = order[place - 1];
        }
        entries[place] = at;
        order[place] = first + i;
        found++;
    }
    for (uint32_t i = 0; i < found && entries[i] < w->limit; i++) {
        if (!level) {
            visit_items(w, order[i]);
            continue;
        }
        uint32_t below = order[i] * WIDE, left = w->boxes->counts[level - 1] - below;
        descend(w, level - 1, below, left < WIDE ? left : WIDE);
    }
}

void boxes_along(const boxes *b, const boxes_ray *ray, boxes_visit visit, void *user) {
    walk w = {b, ray, visit, user, INFINITY};
    if (b->level_count)
        descend(&w, b->level_count - 1, 0, 1);
}
