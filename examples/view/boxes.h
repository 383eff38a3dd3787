/* Boxes around many small things, in a tree of eight each, so that a ray comes near few of them. */
#ifndef LINEAO_VIEW_BOXES_H
#define LINEAO_VIEW_BOXES_H

#include <stdbool.h>
#include <stdint.h>

/* A thing: what its numbers mean is its owner's affair. */
typedef struct boxes_item {
    uint32_t id, first;
} boxes_item;

enum { BOXES_LEVELS = 12 };

/* All zero: no boxes. */
typedef struct boxes {
    boxes_item *items; /* owned; neighbours in space are neighbours here */
    uint32_t item_count, level_count;
    uint32_t counts[BOXES_LEVELS];    /* of boxes: level 0 is around eight items each */
    float (*levels[BOXES_LEVELS])[6]; /* owned; lower corner, upper corner */
} boxes;

/* Lower and upper corner of a thing. One that is nowhere has an upper corner below the lower. */
typedef void (*boxes_of)(const void *user, boxes_item item, float out[6]);

/* Takes the items over, also on failure. False: out of memory, reported. */
bool boxes_make(boxes_item *items, uint32_t count, boxes_of of, const void *user, boxes *out);
void boxes_free(boxes *b);

/* A ray: what lies within near + slope * t of it counts, t being the way along it. */
typedef struct boxes_ray {
    double from[3], to[3]; /* to: unit direction */
    double near, slope;
} boxes_ray;

/* Is shown things that may lie within reach of the ray, the nearest boxes first; returns how far
 * along the ray a further one may be to matter. */
typedef double (*boxes_visit)(void *user, boxes_item item);
void boxes_along(const boxes *b, const boxes_ray *ray, boxes_visit visit, void *user);

#endif
