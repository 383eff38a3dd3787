/* What lies under the pointer: found on the CPU, so that it is the same on every backend. */
#ifndef LINEAO_VIEW_PICK_H
#define LINEAO_VIEW_PICK_H

#include "boxes.h"
#include "load.h"
#include "session.h"
#include "vesselsurface.h"

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

/* Something that is known of what was picked. */
typedef struct picked_fact {
    char name[32];
    const char *unit; /* "" for none */
    uint32_t count;   /* of values */
    double values[4];
} picked_fact;

enum { PICKED_FACTS = 12 };

typedef struct picked {
    picked_kind kind;
    uint32_t set, line, point; /* of a line: its nearest point; of a tree: `line` is the segment; of
                                  a surface: `line` is the triangle, `point` its nearest vertex */
    double at[3];              /* mm, absolute */
    char title[160];           /* what it is */
    picked_fact facts[PICKED_FACTS];
    uint32_t fact_count;
} picked;

/* x, y: -1 .. 1 in the picture, y up. near: how far from a line still counts, in parts of the
 * picture's height. Quick enough to be asked by every movement of a pointer. */
void pick_at(const pickable *p, const cli_shot *shot, double x, double y, double near, picked *out);
/* A node of a tree, as if it had been clicked. */
void pick_node(const cli_scene *scene, const struct cli_tree *tree, uint32_t node, picked *out);
/* The triangles of a set, which a wall has, or a surface in place of a tree; NULL: none. */
const vsf_mesh *pick_mesh(const cli_set *set);

/* ---- pick_tell.c ---- */

/* Finds title and facts, which change with time and targets. */
void pick_tell(const cli_scene *scene, picked *of);
/* A fact as text, "radius: 2.1 mm". */
void pick_print(const picked_fact *fact, char *text, size_t size);
/* All of it as JSON; for free(). NULL: reported. */
char *pick_json(const cli_scene *scene, const picked *of);

/* The tree that was picked, or NULL. */
const struct cli_tree *picked_on(const cli_scene *scene, const picked *of);
/* The same, else the first there is, or NULL. */
const struct cli_tree *picked_tree(const cli_scene *scene, const picked *of);

#endif
