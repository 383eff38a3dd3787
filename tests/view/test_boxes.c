/* A ray is shown every thing that lies within its reach, however things lie, and of many of them
 * few others: so the pointer finds what a search through all would find. */
#include "boxes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 20000 };

typedef struct things {
    float boxes[MOST][6];
    uint8_t seen[MOST];
    uint32_t count, visits;
    double limit;
} things;

static double random_part(uint64_t *state) { /* 0 .. 1 */
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 40) / (double)(1 << 24);
}

static void box_of(const void *user, boxes_item item, float out[6]) {
    const things *t = user;
    memcpy(out, t->boxes[item.id], sizeof t->boxes[item.id]);
}

static double visit(void *user, boxes_item item) {
    things *t = user;
    t->seen[item.id]++;
    t->visits++;
    return t->limit;
}

/* Small boxes in a cube of 100 mm; some of them points, some nowhere, some without a number. */
static things *make_things(uint32_t count, uint64_t seed) {
    things *t = calloc(1, sizeof *t);
    assert_non_null(t);
    t->count = count;
    t->limit = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            t->boxes[i][k] = (float)(100 * random_part(&seed));
            t->boxes[i][3 + k] = t->boxes[i][k] + (float)(i % 5 == 0 ? 0 : 3 * random_part(&seed));
        }
        if (i % 97 == 96) {
            t->boxes[i][0] = INFINITY;
            t->boxes[i][3] = -INFINITY;
        }
    }
    return t;
}

static void make_boxes(const things *t, boxes *out) {
    boxes_item *items = malloc((t->count + 1) * sizeof *items);
    assert_non_null(items);
    for (uint32_t i = 0; i < t->count; i++)
        items[i] = (boxes_item){i, 0};
    assert_true(boxes_make(items, t->count, box_of, t, out));
}

static boxes_ray make_ray(uint64_t *seed, bool along_an_axis) {
    boxes_ray ray;
    double size = 0;
    for (int k = 0; k < 3; k++) {
        ray.from[k] = 140 * random_part(seed) - 20;
        ray.to[k] = along_an_axis ? k == 2 : random_part(seed) - 0.5;
        size += ray.to[k] * ray.to[k];
    }
    for (int k = 0; k < 3; k++)
        ray.to[k] /= sqrt(size);
    ray.near = 10 * random_part(seed);
    ray.slope = 0.05 * random_part(seed);
    return ray;
}

/* Is some place of the box, of a few thousand tried, within reach of the ray before the limit? */
static bool is_reached(const boxes_ray *ray, const float box[6], double limit) {
    enum { PARTS = 9 };
    for (int i = 0; i < PARTS * PARTS * PARTS; i++) {
        const int at[3] = {i % PARTS, i / PARTS % PARTS, i / PARTS / PARTS};
        double p[3], t = 0, squared = 0;
        for (int k = 0; k < 3; k++) {
            double part = (double)at[k] / (PARTS - 1);
            p[k] = (double)box[k] + part * ((double)box[3 + k] - (double)box[k]) - ray->from[k];
            t += p[k] * ray->to[k];
        }
        for (int k = 0; k < 3; k++)
            squared += (p[k] - t * ray->to[k]) * (p[k] - t * ray->to[k]);
        if (t > 0 && t < limit && sqrt(squared) <= ray->near + ray->slope * t)
            return true;
    }
    return false;
}

static void shows_what_is_within_reach(void **state) {
    static const uint32_t counts[] = {1, 7, 8, 9, 64, 65, 3000};
    uint64_t seed = 1;
    uint32_t reached = 0;
    (void)state;
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        things *t = make_things(counts[c], 100 + c);
        boxes b;
        make_boxes(t, &b);
        for (int r = 0; r < 12; r++) {
            boxes_ray ray = make_ray(&seed, r % 4 == 0);
            t->limit = r % 3 == 0 ? 40 : INFINITY; /* nothing behind matters from the first on */
            memset(t->seen, 0, sizeof t->seen);
            boxes_along(&b, &ray, visit, t);
            for (uint32_t i = 0; i < t->count; i++) {
                assert_in_range(t->seen[i], 0, 1);
                if (isfinite(t->boxes[i][0]) && is_reached(&ray, t->boxes[i], t->limit)) {
                    assert_int_equal(t->seen[i], 1);
                    reached++;
                }
            }
        }
        boxes_free(&b);
        free(t);
    }
    print_message("%u things in reach\n", reached);
    assert_true(reached > 100);
}

static void shows_few_others(void **state) {
    uint64_t seed = 7;
    things *t = make_things(MOST, 9);
    boxes b;
    (void)state;
    make_boxes(t, &b);
    for (int r = 0; r < 100; r++) {
        boxes_ray ray = make_ray(&seed, false);
        ray.near = ray.slope = 0;
        boxes_along(&b, &ray, visit, t);
    }
    print_message("%g of %d things in a ray\n", t->visits / 100.0, MOST);
    assert_in_range(t->visits, 100, 100 * MOST / 50);
    boxes_free(&b);
    free(t);
}

/* The nearest box comes first, so that what it holds ends the search. */
static void ends_at_the_first(void **state) {
    things *t = calloc(1, sizeof *t);
    boxes b;
    boxes_ray ray = {{50, 50, -10}, {0, 0, 1}, 0, 0};
    (void)state;
    assert_non_null(t);
    t->count = 4000;
    for (uint32_t i = 0; i < t->count; i++) {
        for (int k = 0; k < 3; k++) {
            t->boxes[i][k] = k == 2 ? (float)(t->count - i) : 49;
            t->boxes[i][3 + k] = k == 2 ? (float)(t->count - i) : 51;
        }
    }
    make_boxes(t, &b);
    t->limit = 12;
    boxes_along(&b, &ray, visit, t);
    assert_int_equal(t->seen[t->count - 1], 1);
    assert_in_range(t->visits, 1, 16);
    boxes_free(&b);
    free(t);
}

static void takes_none(void **state) {
    boxes b, zero;
    boxes_ray ray = {{0, 0, 0}, {0, 0, 1}, 1, 1};
    things *t = make_things(0, 1);
    (void)state;
    memset(&zero, 0, sizeof zero);
    make_boxes(t, &b);
    boxes_along(&b, &ray, visit, t);
    boxes_along(&zero, &ray, visit, t);
    assert_int_equal(t->visits, 0);
    boxes_free(&b);
    boxes_free(&zero);
    free(t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shows_what_is_within_reach),
        cmocka_unit_test(shows_few_others),
        cmocka_unit_test(ends_at_the_first),
        cmocka_unit_test(takes_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
