/* What lies under the pointer: found on the CPU, so that it is the same on every backend. */
#ifndef LINEAO_VIEW_PICK_H
#define LINEAO_VIEW_PICK_H

#include "boxes.h"
#include "load.h"
#include "session.h"

/* All of a scene that a ray may meet, set by set; made once, beside the window. */
typedef struct pickable {
    const cli_scene *scene; /* must outlive it */
    boxes *sets;            /* owned */
    uint32_t count;
} pickable;
/* False: reported; free it in any case. */
bool pick_prepare(const cli_scene *scene, pickable *out);
void pick_free(pickable *p);

typedef enum picked_kind { PICKED_NOTHING, PICKED_LINE, PICKED_TREE, PICKED_SURFACE } picked_kind;

typedef struct picked {
    picked_kind kind;
    uint32_t set, line, point; /* of a line: its nearest point; of a tree: `line` is the segment; of
                                  a surface: `line` is the triangle, `point` its nearest vertex */
    double at[3];              /* mm, absolute */
    char text[512];            /* what is known of it, a line each; the first is its name */
} picked;

/* x, y: -1 .. 1 in the picture, y up. near: how far from a line still counts, in parts of the
 * picture's height. Quick enough to be asked by every movement of a pointer. */
void pick_at(const pickable *p, const cli_shot *shot, double x, double y, double near, picked *out);
/* Writes what is known of it now: times and targets change. */
void pick_tell(const cli_scene *scene, picked *of);
/* A node of a tree, as if it had been clicked. */
void pick_node(const cli_scene *scene, const struct cli_tree *tree, uint32_t node, picked *out);
/* The tree that was picked, or NULL. */
const struct cli_tree *picked_on(const cli_scene *scene, const picked *of);
/* The same, else the first there is, or NULL. */
const struct cli_tree *picked_tree(const cli_scene *scene, const picked *of);

#endif
