/* sdfvessel.h - vessel trees as signed distance fields, with a 2D layout of the tree. MIT licence,
   see LICENSE.

   A vessel tree is a set of nodes (position and radius, mm) and of segments between them; its
   surface is the union of the round cones of all segments (Lichtenberg et al. 2019, "Distance Field
   Visualization and 2D Abstraction of Vessel Tree Structures with on-the-fly Parameterization",
   below L19). This header builds and mends trees, reduces them to branches, lays them out in 2D,
   samples their distance field on a grid and traces rays through it. It includes lineao.h for
   types, results, allocator, job and shared math only: no backend and no GPU is needed.

   EXAMPLE
       #define SDFVESSEL_IMPLEMENTATION     // in exactly one C or C++ file
       #include "sdfvessel.h"

       sdv_tree_desc desc = {0};
       desc.node_count = 3;    desc.positions = positions;    desc.radii = radii;   // mm
       desc.segment_count = 2; desc.segments = parent_child_pairs;
       sdv_tree tree;
       if (sdv_tree_build(NULL, &desc, &tree) != LAO_OK) return 1;  // NULL: malloc, serial, silent
       sdv_reduced reduced;
       sdv_reduce(NULL, &tree, &reduced);
       sdv_layout layout;
       sdv_layout_make(NULL, &tree, &reduced, NULL, &layout);
       ...
       sdv_layout_free(&layout); sdv_reduced_free(&reduced); sdv_tree_free(&tree);

   CONFIGURATION (define before including)
       SDFVESSEL_IMPLEMENTATION   the function bodies, in one translation unit
       SDV_API                    linkage of the public functions (default: extern)

   CONTRACTS
       Units     millimetres, radians.
       Errors    a failure returns one lao_result, logs one item (SDV_LOG_ITEMS) and leaves
                 out-parameters untouched. What is merely odd is mended and logged as a warning: an
                 item whose result is LAO_OK.
       Memory    every byte comes from sdv_host.allocator; objects keep a copy of it for their free
                 function, which is fine on an all-zero object.
       Threads   no function keeps state outside its arguments: different objects may be used on
                 different threads, and one object read on several. Work runs through sdv_host.job
                 in fixed chunks, so that results do not depend on the number of threads.
       Size      nothing recurses: a chain of a million nodes is as good as any tree. */
#ifndef SDFVESSEL_H
#define SDFVESSEL_H

#include "lineao.h"

#ifndef SDV_API
#define SDV_API extern
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------
 * what can go wrong, what was mended */

/* X(id, result, text). LAO_OK: a warning, the work went on. */
#define SDV_LOG_ITEMS(X)                                                                           \
    X(NULL_ARGUMENT, LAO_ERROR_INVALID_ARGUMENT, "a required pointer is NULL")                     \
    X(MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory")                                                \
    X(CANCELLED, LAO_ERROR_NOT_READY, "the host cancelled the work")                               \
    X(TREE_EMPTY, LAO_ERROR_INVALID_ARGUMENT, "a tree needs at least one node")                    \
    X(TREE_COUNT, LAO_ERROR_INVALID_ARGUMENT, "more than 2^30 nodes or segments")                  \
    X(TREE_POSITION, LAO_ERROR_INVALID_ARGUMENT,                                                   \
      "a node's position is not finite or beyond 1e9 mm")                                          \
    X(TREE_SEGMENT, LAO_ERROR_INVALID_ARGUMENT, "a segment names a node that does not exist")      \
    X(TREE_ATTRIBUTE, LAO_ERROR_INVALID_ARGUMENT, "an attribute has no name or no values")         \
    X(LAYOUT_PH, LAO_ERROR_INVALID_ARGUMENT, "p_h is negative or no number")                       \
    X(RADIUS_MISSING, LAO_OK,                                                                      \
      "nodes have no radius (negative, no number or beyond 1e9 mm): 0 is taken")                   \
    X(RADIUS_ZERO, LAO_OK, "nodes have radius 0")                                                  \
    X(NODES_MERGED, LAO_OK, "points at the position of an earlier point became one node")          \
    X(NODES_ISOLATED, LAO_OK, "points on no line were dropped")                                    \
    X(SEGMENTS_LOOSE, LAO_OK, "segments from a node to itself were dropped")                       \
    X(SEGMENTS_REPEATED, LAO_OK, "repeated segments were dropped")                                 \
    X(SEGMENTS_ZERO, LAO_OK, "segments have length 0")                                             \
    X(SEGMENTS_TURNED, LAO_OK, "segments pointed to the root and were turned round")               \
    X(LINES_JOINED, LAO_OK, "ends of lines lay inside another line and were joined to it")         \
    X(TREE_ROOTS, LAO_OK, "the tree has several roots")                                            \
    X(TREE_LOOPS, LAO_OK, "segments close loops; the tree is a graph, they are kept")

typedef enum sdv_log_item {
#define SDV__ENUM(id, result, text) SDV_LOG_##id,
    SDV_LOG_ITEMS(SDV__ENUM)
#undef SDV__ENUM
        SDV_LOG_ITEM_COUNT
} sdv_log_item;

/* What the host lends to a call. All zero, or NULL instead: malloc, serial, silent. */
typedef struct sdv_host {
    lao_allocator allocator;
    lao_job job;
    /* One call per failure (result != LAO_OK) or warning (LAO_OK). `text` is the item's sentence
       with a place or a number; valid during the call. */
    void (*log)(void *user, sdv_log_item item, lao_result result, const char *text);
    void *user;
} sdv_host;

/* ------------------------------------------------------------------------------------------------
 * the tree */

#define SDV_NONE 0xffffffffu

/* A named array of `components` floats per node or segment. NaN means no value. */
typedef struct sdv_attribute {
    const char *name;
    uint32_t components; /* 0: 1 */
    const float *values;
} sdv_attribute;

typedef struct sdv_segment {
    uint32_t parent, child; /* nodes */
} sdv_segment;

enum {
    SDV_TREE_MERGE = 1,      /* points at bit-equal positions are one node (VTP, VTK centrelines) */
    SDV_TREE_DROP = 2,       /* points on no segment are no nodes */
    SDV_TREE_JOIN = 4,       /* an end of a line inside a sphere of another line is joined to it */
    SDV_TREE_UNDIRECTED = 8, /* the direction of a segment means nothing */
    SDV_TREE_LINES = 15      /* all four: what a set of centrelines wants */
};

/* Arrays are borrowed during the call. */
typedef struct sdv_tree_desc {
    uint32_t node_count;
    const float *positions;      /* 3 per node, mm */
    const float *radii;          /* (Optional) 1 per node, mm; NULL: all 0 */
    uint32_t segment_count;      /* 0 with one node: a ball */
    const sdv_segment *segments; /* any order, parents before or behind their children */
    uint32_t flags;              /* SDV_TREE_... */
    const sdv_attribute *node_attributes, *segment_attributes;
    uint32_t node_attribute_count, segment_attribute_count;
} sdv_tree_desc;

/* Counts and ranges. */
typedef struct sdv_tree_info {
    uint32_t nodes, segments;
    uint32_t roots;           /* one per connected component */
    uint32_t leaves;          /* no child and not a root */
    uint32_t branches;        /* 2 children or more */
    uint32_t multifurcations; /* 3 children or more */
    uint32_t max_children;
    uint32_t loops;     /* segments - nodes + roots */
    uint32_t joined;    /* segments added by SDV_TREE_JOIN, the last ones of the tree */
    float radius[2];    /* least and greatest as given; 0, 0 where none is a number */
    float bounds[2][3]; /* mm, of the nodes' centres */
} sdv_tree_info;

/* One kind of warning of a tree. */
typedef struct sdv_warning {
    sdv_log_item item;
    uint32_t count; /* how many nodes, segments, roots, loops */
    uint32_t first; /* the first of them: index in the desc's array (nodes, segments), or node */
} sdv_warning;

/* A tree: read its arrays freely, change only `nodes` (then sdv_grid_update). Node and segment
   indices keep the order of the desc. The children of a node are counted by its segments; `parents`
   and `order` follow one spanning tree per root, so that they exist in graphs with loops too. */
typedef struct sdv_tree {
    uint32_t node_count, segment_count, root_count;
    lao_v4 *nodes;             /* x, y, z, radius, mm */
    sdv_segment *segments;     /* turned so that parents are nearer to the root along the tree */
    uint32_t *roots;           /* root_count nodes, ascending by component's lowest node */
    uint32_t *parents;         /* per node: its parent, SDV_NONE at a root */
    uint32_t *parent_segments; /* per node: the segment to its parent, SDV_NONE at a root */
    uint32_t *components;      /* per node: index in roots */
    uint32_t *order;           /* all nodes, parents before children */
    uint32_t *child_counts;    /* per node: segments that leave it */
    uint32_t *node_sources;    /* per node: index in the desc (the first of merged points) */
    uint32_t *segment_sources; /* per segment: index in the desc; SDV_NONE: added by joining */
    uint32_t *node_targets;    /* per node of the desc: node here, SDV_NONE: dropped */
    uint32_t source_count;     /* entries of node_targets */
    sdv_attribute *node_attributes, *segment_attributes;
    uint32_t node_attribute_count, segment_attribute_count;
    sdv_tree_info info;
    sdv_warning warnings[SDV_LOG_ITEM_COUNT];
    uint32_t warning_count;
    lao_allocator allocator; /* private */
    void *memory;            /* private */
} sdv_tree;

/* Builds a tree from arrays, mends what is odd and counts it (DESIGN.md 10, "Tree"):
   - a radius that is negative or no number becomes 0; merged points take the greatest radius;
   - segments from a node to itself and repeated ones (either direction) go; other segments of
   length 0 stay, because ids rule in formats that have them;
   - a component's root is the node that no segment enters, the lowest if there are several; without
     one, or with SDV_TREE_UNDIRECTED, the first node of the component's first segment. From there
     segments are followed along their direction first, against it (and turned) only where nothing
     else reaches a node;
   - loops are kept: as segments, not in `parents`;
   - SDV_TREE_JOIN adds a segment from the nearest node of another component whose sphere holds an
     end of a line (a node with one segment or none), end by end in ascending order, unless that
     would close a loop. Added segments have NaN attributes.
   Linear time but for the sorting of segments. Fails with NULL_ARGUMENT, MEMORY, TREE_EMPTY,
   TREE_COUNT, TREE_POSITION, TREE_SEGMENT, TREE_ATTRIBUTE. Thread: any. */
SDV_API lao_result sdv_tree_build(const sdv_host *host, const sdv_tree_desc *desc, sdv_tree *tree);
SDV_API void sdv_tree_free(sdv_tree *tree);
/* The text of warning i, as it was logged: "3 nodes have radius 0, first: 17". Returns its length,
   which may exceed size - 1; `text` is always terminated. */
SDV_API size_t sdv_tree_warning_text(const sdv_tree *tree, uint32_t i, char *text, size_t size);

/* ------------------------------------------------------------------------------------------------
 * the reduced tree and its layout */

/* Roots, branches and leaves, made binary (L19 3, METHODS 8): a node with n > 2 children keeps the
   first and gets an extra node with the rest; a root with several children gets one extra child.
   Children ascend by id. Loops are cut (sdv_tree.parents). */
typedef struct sdv_reduced {
    uint32_t node_count, root_count;
    uint32_t *ids;   /* the tree's node, or from tree.node_count on: an extra node */
    uint32_t *nodes; /* the tree's node where this one is drawn; an extra node: that of its owner */
    uint32_t *parents;  /* index here, SDV_NONE at a root */
    uint32_t *children; /* 2 per node: indices here, SDV_NONE: none; a root has one at most */
    uint32_t *order;    /* all nodes, parents before children */
    uint32_t *roots;    /* root_count indices here */
    uint32_t *owners;   /* per node of the tree: index here of the first reduced node at it or below
                           it, whose edge it lies on */
    lao_allocator allocator; /* private */
    void *memory;            /* private */
} sdv_reduced;

SDV_API lao_result sdv_reduce(const sdv_host *host, const sdv_tree *tree, sdv_reduced *reduced);
SDV_API void sdv_reduced_free(sdv_reduced *reduced);

enum {
    SDV_LAYOUT_ALL_NODES =
        1,             /* weights sum over all nodes of the tree, not only the reduced ones */
    SDV_LAYOUT_OWN = 2 /* a node's scalar is its weight: no sum over the sub-tree */
};

typedef struct sdv_layout_desc {
    const float
        *scalars;    /* (Optional) per node of the tree, > 0; NULL: 1, weights are node counts */
    float ph;        /* >= 0; how much unbalanced sub-trees close up; used when has_ph */
    uint32_t has_ph; /* 0: 4 / node_count of the reduced tree */
    uint32_t flags;  /* SDV_LAYOUT_... */
} sdv_layout_desc;

typedef struct sdv_layout {
    uint32_t node_count; /* of the reduced tree; arrays are in its order */
    float *h;            /* [0, 1], across; hue in turns; angle of the radial drawing in turns */
    float *s;            /* [0, 1], 1 at the root, 0 at the deepest leaf; saturation */
    float *weights;
    lao_allocator allocator; /* private */
    void *memory;            /* private */
} sdv_layout;

/* Algorithm 1 of L19 with METHODS 8. `desc` NULL: defaults. A scalar that is not a positive finite
   number counts as 0; a sub-tree of weight 0 as the least positive weight. Several roots share
   [0, 1] across in proportion to their weights. No recursion, O(n). */
SDV_API lao_result sdv_layout_make(const sdv_host *host, const sdv_tree *tree,
                                   const sdv_reduced *reduced, const sdv_layout_desc *desc,
                                   sdv_layout *layout);
SDV_API void sdv_layout_free(sdv_layout *layout);

/* Receives text piece by piece; non-zero stops the writer, which returns it. */
typedef struct sdv_writer {
    int (*write)(void *user, const char *text, size_t length);
    void *user;
} sdv_writer;

/* {"nodes":[{"id","parent","h","s","weight","distance"}]} (DESIGN.md 10): id = node of the tree,
   extra nodes from tree.node_count on; parent -1 at a root. `distances` (Optional): per reduced
   node, mm, written as null where NaN; NULL: all null. */
SDV_API int sdv_layout_write_json(const sdv_reduced *reduced, const sdv_layout *layout,
                                  const float *distances, const sdv_writer *writer);

typedef struct sdv_svg_desc {
    float width, height; /* px; 0: 1024 x 512, radial 768 x 768 */
    uint32_t radial;     /* non-zero: angle h, radius 1 - s */
    float line_width;    /* px; 0: 2 */
    const float
        *distances; /* (Optional) per reduced node, mm: nodes nearer than `risk` are marked */
    float risk;     /* mm */
} sdv_svg_desc;
/* The layout as SVG: one line per edge in the colour of its lower node, sdv_hsv(h, s, 1). `desc`
 * NULL: defaults. */
SDV_API int sdv_layout_write_svg(const sdv_reduced *reduced, const sdv_layout *layout,
                                 const sdv_svg_desc *desc, const sdv_writer *writer);

#ifdef __cplusplus
}
#endif

/* -------------------------------------------------------------------------------------------------------
   shared text From here to SDV_SHARED_END the text is C99, C++11 and GLSL at once, behind
   lineao.h's (same rules: see there). */
/* SDV_SHARED_BEGIN */
/* ---- round cones (L19 3.2 with METHODS 4): a, b = centre and radius of the two ends, mm */
/* Where p is in the plane of the axis: x along it from a, y away from it; s its length, l and d the
   tangent's length and rise; part: -1 nearest to ball a, 1 to ball b, 0 to the cone between. */
struct sdv_cone_point {
    lao_v3 axis, away; /* unit; away is 0 on the axis */
    float x, y, s, l, d, part;
};
#ifndef LAO_GLSL
typedef struct sdv_cone_point sdv_cone_point;
#endif
LAO_FN sdv_cone_point sdv_cone_point_make(lao_v3 p, lao_v4 a, lao_v4 b) {
    sdv_cone_point c;
    lao_v3 q = lao_v3_sub(p, lao_v3_make(a.x, a.y, a.z));
    lao_v3 ab = lao_v3_make(b.x - a.x, b.y - a.y, b.z - a.z);
    LAO_EXACT float s = lao_sqrt(lao_v3_dot(ab, ab));
    LAO_EXACT float d = a.w - b.w;
    LAO_EXACT float least = lao_abs(d) + 1.0e-6f * lao_max(a.w, b.w);
    c.s = s;
    c.d = d;
    c.axis = lao_v3_make(0.0f, 0.0f, 0.0f);
    c.away = c.axis;
    c.x = 0.0f;
    c.y = 0.0f;
    c.l = 0.0f;
    if (!(s > least)) { /* one ball holds the other */
        c.part = d < 0.0f ? 1.0f : -1.0f;
        return c;
    }
    LAO_EXACT float inverse = 1.0f / s;
    lao_v3 axis = lao_v3_scale(ab, inverse);
    LAO_EXACT float x = lao_v3_dot(q, axis);
    lao_v3 away = lao_v3_along(q, axis, -x);
    LAO_EXACT float y = lao_sqrt(lao_v3_dot(away, away));
    LAO_EXACT float l = lao_sqrt((s - d) * (s + d));
    LAO_EXACT float u = (l * x - d * y) * inverse;
    c.axis = axis;
    c.away = y > 0.0f ? lao_v3_scale(away, 1.0f / y) : c.away;
    c.x = x;
    c.y = y;
    c.l = l;
    c.part = u < 0.0f ? -1.0f : (u > l ? 1.0f : 0.0f);
    return c;
}
LAO_FN float sdv_ball(lao_v3 p, lao_v4 ball) {
    lao_v3 q = lao_v3_sub(p, lao_v3_make(ball.x, ball.y, ball.z));
    LAO_EXACT float r = lao_sqrt(lao_v3_dot(q, q)) - ball.w;
    return r;
}
/* Signed distance in mm, exact outside and inside; one ball when it holds the other (Eqs. 1-3,
   corrected). */
LAO_FN float sdv_round_cone(lao_v3 p, lao_v4 a, lao_v4 b) {
    sdv_cone_point c = sdv_cone_point_make(p, a, b);
    if (c.part < 0.0f) {
        return sdv_ball(p, a);
    }
    if (c.part > 0.0f) {
        return sdv_ball(p, b);
    }
    LAO_EXACT float r = (c.d * c.x + c.l * c.y) / c.s - a.w;
    return r;
}
/* Any unit vector at a right angle to the unit vector v. */
LAO_FN lao_v3 sdv_perpendicular(lao_v3 v) {
    LAO_EXACT float x = lao_abs(v.x);
    LAO_EXACT float y = lao_abs(v.y);
    LAO_EXACT float z = lao_abs(v.z);
    lao_v3 least = lao_v3_make(0.0f, 0.0f, 1.0f);
    if (x <= y && x <= z) {
        least = lao_v3_make(1.0f, 0.0f, 0.0f);
    } else if (y <= z) {
        least = lao_v3_make(0.0f, 1.0f, 0.0f);
    }
    return lao_v3_unit(lao_v3_cross(v, least), least);
}
/* Gradient of the distance: a unit vector, the outward normal on the surface. At the centre of a
   ball and on the axis any of the possible ones. */
LAO_FN lao_v3 sdv_round_cone_gradient(lao_v3 p, lao_v4 a, lao_v4 b) {
    sdv_cone_point c = sdv_cone_point_make(p, a, b);
    lao_v3 any = lao_v3_make(0.0f, 0.0f, 1.0f);
    if (c.part < 0.0f) {
        return lao_v3_unit(lao_v3_sub(p, lao_v3_make(a.x, a.y, a.z)), any);
    }
    if (c.part > 0.0f) {
        return lao_v3_unit(lao_v3_sub(p, lao_v3_make(b.x, b.y, b.z)), any);
    }
    lao_v3 away = c.y > 0.0f ? c.away : sdv_perpendicular(c.axis);
    LAO_EXACT float along = c.d / c.s;
    LAO_EXACT float out = c.l / c.s;
    return lao_v3_unit(lao_v3_along(lao_v3_scale(away, out), c.axis, along), any);
}

/* ---- colours */
/* Hue in turns, saturation, value to RGB. */
LAO_FN lao_v3 sdv_hsv(float h, float s, float v) {
    LAO_EXACT float t = 6.0f * (h - lao_floor(h));
    LAO_EXACT float r = lao_clamp01(lao_abs(t - 3.0f) - 1.0f);
    LAO_EXACT float g = lao_clamp01(2.0f - lao_abs(t - 2.0f));
    LAO_EXACT float b = lao_clamp01(2.0f - lao_abs(t - 4.0f));
    LAO_EXACT float x = v * (1.0f - s * (1.0f - r));
    LAO_EXACT float y = v * (1.0f - s * (1.0f - g));
    LAO_EXACT float z = v * (1.0f - s * (1.0f - b));
    return lao_v3_make(x, y, z);
}
/* Place of (h, s) in the radial drawing, in the unit disc: the root in the middle (L19 3.1). */
LAO_FN lao_v2 sdv_radial(float h, float s) {
    LAO_EXACT float reach = 1.0f - s;
    LAO_EXACT float x = reach * lao_cos_turns(h);
    LAO_EXACT float y = reach * lao_sin_turns(h);
    return lao_v2_make(x, y);
}
/* SDV_SHARED_END */

#endif /* SDFVESSEL_H */

#ifdef SDFVESSEL_IMPLEMENTATION
#ifndef SDFVESSEL_IMPLEMENTATION_DONE
#define SDFVESSEL_IMPLEMENTATION_DONE

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ================================================================================================
 * host */

typedef struct sdv__item_row {
    lao_result result;
    const char *text;
} sdv__item_row;

static const sdv__item_row sdv__items[] = {
#define SDV__ROW(id, result, text) {result, text},
    SDV_LOG_ITEMS(SDV__ROW)
#undef SDV__ROW
};

/* Logs a failure with a place (printf) or NULL; returns its result. */
static lao_result sdv__fail(const sdv_host *host, sdv_log_item item, const char *place, ...) {
    char text[256];
    size_t n;
    if (!host || !host->log) {
        return sdv__items[item].result;
    }
    n = (size_t)snprintf(text, sizeof text, "%s", sdv__items[item].text);
    if (place && n + 2 < sizeof text) {
        va_list list;
        memcpy(text + n, ": ", 3);
        va_start(list, place);
        vsnprintf(text + n + 2, sizeof text - n - 2, place, list);
        va_end(list);
    }
    host->log(host->user, item, sdv__items[item].result, text);
    return sdv__items[item].result;
}

static void *sdv__malloc(void *user, size_t size) {
    (void)user;
    return malloc(size);
}
static void sdv__free(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}
static lao_allocator sdv__allocator(const sdv_host *host) {
    lao_allocator a;
    if (host && host->allocator.allocate && host->allocator.release) {
        return host->allocator;
    }
    a.allocate = sdv__malloc;
    a.release = sdv__free;
    a.user = NULL;
    return a;
}

/* Memory that knows its size, in front of it. NULL: none left, or more than size_t can count. */
enum { SDV__HEAD = 16 };
static void *sdv__take(const lao_allocator *allocator, uint64_t count, size_t size) {
    unsigned char *memory;
    size_t bytes;
    if (count > (SIZE_MAX - SDV__HEAD) / size) {
        return NULL;
    }
    bytes = SDV__HEAD + (size_t)count * size;
    memory = (unsigned char *)allocator->allocate(allocator->user, bytes);
    if (!memory) {
        return NULL;
    }
    memcpy(memory, &bytes, sizeof bytes);
    return memory + SDV__HEAD;
}
static void sdv__give(const lao_allocator *allocator, void *taken) {
    if (taken) {
        unsigned char *memory = (unsigned char *)taken - SDV__HEAD;
        size_t bytes;
        memcpy(&bytes, memory, sizeof bytes);
        allocator->release(allocator->user, memory, bytes);
    }
}

/* Cuts one block into arrays: a first round with base NULL counts, a second one with the memory
   cuts. */
typedef struct sdv__block {
    unsigned char *base;
    uint64_t used;
} sdv__block;
static void *sdv__part(sdv__block *block, uint64_t count, size_t size) {
    unsigned char *part = block->base ? block->base + block->used : NULL;
    block->used += (count * size + 15u) & ~(uint64_t)15u;
    return part;
}
static uint32_t *sdv__part_u32(sdv__block *block, uint64_t count) {
    return (uint32_t *)sdv__part(block, count, sizeof(uint32_t));
}

/* ================================================================================================
 * tree */

/* What building needs until the tree exists. All arrays come from one block. */
typedef struct sdv__build {
    const sdv_host *host;
    const sdv_tree_desc *desc;
    lao_allocator allocator;
    uint32_t *target;      /* per desc node: first node at its position, later its final index */
    uint32_t *source;      /* per node: desc node */
    uint32_t *group;       /* union-find; later the component */
    uint32_t *degree;      /* per node */
    sdv_segment *segments; /* room for joins: + node_count */
    uint32_t *segment_source;
    uint32_t *table; /* hash table */
    uint32_t table_mask;
    uint32_t *first, *incident; /* segments of each node; twice the segments */
    uint32_t *later;            /* segments to be followed backwards */
    unsigned char *turned;      /* per segment */
    uint32_t *entered;          /* per node: segments that enter it */
    uint32_t *next;             /* per node: next in its cell of the join grid */
    float *radius;              /* per node */
    uint32_t node_count, segment_count, root_count, joined;
    sdv_warning warnings[SDV_LOG_ITEM_COUNT];
    uint32_t warning_count;
} sdv__build;

static void sdv__warn(sdv__build *b, sdv_log_item item, uint32_t place) {
    uint32_t i = 0;
    while (i < b->warning_count && b->warnings[i].item != item) {
        i++;
    }
    if (i == b->warning_count) {
        b->warnings[i].item = item;
        b->warnings[i].count = 0;
        b->warnings[i].first = place;
        b->warning_count++;
    }
    b->warnings[i].count++;
}

static lao_result sdv__tree_check(const sdv_host *host, const sdv_tree_desc *desc) {
    const uint32_t most = 1u << 30;
    uint32_t i;
    if (desc->node_count == 0) {
        return sdv__fail(host, SDV_LOG_TREE_EMPTY, NULL);
    }
    if (desc->node_count > most || desc->segment_count > most) {
        return sdv__fail(host, SDV_LOG_TREE_COUNT, NULL);
    }
    if (!desc->positions || (desc->segment_count && !desc->segments) ||
        (desc->node_attribute_count && !desc->node_attributes) ||
        (desc->segment_attribute_count && !desc->segment_attributes)) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "arrays of sdv_tree_desc");
    }
    for (i = 0; i < desc->node_count; i++) {
        const float *p = desc->positions + 3 * (size_t)i;
        if (!(fabsf(p[0]) <= 1e9f && fabsf(p[1]) <= 1e9f && fabsf(p[2]) <= 1e9f)) {
            return sdv__fail(host, SDV_LOG_TREE_POSITION, "node %u", i);
        }
    }
    for (i = 0; i < desc->segment_count; i++) {
        const sdv_segment *s = desc->segments + i;
        if (s->parent >= desc->node_count || s->child >= desc->node_count) {
            return sdv__fail(host, SDV_LOG_TREE_SEGMENT, "segment %u from node %u to node %u", i,
                             s->parent, s->child);
        }
    }
    for (i = 0; i < desc->node_attribute_count + desc->segment_attribute_count; i++) {
        uint32_t n = desc->node_attribute_count;
        const sdv_attribute *a =
            i < n ? desc->node_attributes + i : desc->segment_attributes + (i - n);
        if (!a->name || (!a->values && (i < n || desc->segment_count)) || a->components > 1024) {
            return sdv__fail(host, SDV_LOG_TREE_ATTRIBUTE, "attribute %u of the %s",
                             i < n ? i : i - n, i < n ? "nodes" : "segments");
        }
    }
    return LAO_OK;
}

static void sdv__build_parts(sdv__build *b, sdv__block *block) {
    uint64_t n = b->desc->node_count, m = b->desc->segment_count, all = n + m, size = 16;
    while (size < 2 * (n > m ? n : m)) {
        size *= 2;
    }
    b->table_mask = (uint32_t)(size - 1);
    b->target = sdv__part_u32(block, n);
    b->source = sdv__part_u32(block, n);
    b->group = sdv__part_u32(block, n);
    b->degree = sdv__part_u32(block, n);
    b->segments = (sdv_segment *)sdv__part(block, all, sizeof(sdv_segment));
    b->segment_source = sdv__part_u32(block, all);
    b->table = sdv__part_u32(block, size);
    b->first = sdv__part_u32(block, n + 1);
    b->incident = sdv__part_u32(block, 2 * all);
    b->later = sdv__part_u32(block, 2 * all);
    b->turned = (unsigned char *)sdv__part(block, all, 1);
    b->entered = sdv__part_u32(block, n);
    b->next = sdv__part_u32(block, n);
    b->radius = (float *)sdv__part(block, n, sizeof(float));
}

static uint32_t sdv__mix(uint32_t a, uint32_t b, uint32_t c) {
    return lao_hash(a + lao_hash(b + lao_hash(c)));
}

/* The position's bits, -0 as 0. */
static void sdv__position_bits(const float *p, uint32_t bits[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        bits[k] = lao_float_bits(p[k] + 0.0f);
    }
}

/* target = the first node at the same position */
static void sdv__merge(sdv__build *b) {
    const float *p = b->desc->positions;
    uint32_t i, n = b->desc->node_count;
    for (i = 0; i < n; i++) {
        b->target[i] = i;
    }
    if (!(b->desc->flags & SDV_TREE_MERGE)) {
        return;
    }
    memset(b->table, 0xff, ((size_t)b->table_mask + 1) * sizeof *b->table);
    for (i = 0; i < n; i++) {
        uint32_t bits[3], slot;
        sdv__position_bits(p + 3 * (size_t)i, bits);
        slot = sdv__mix(bits[0], bits[1], bits[2]) & b->table_mask;
        for (; b->table[slot] != SDV_NONE; slot = (slot + 1) & b->table_mask) {
            uint32_t other[3];
            sdv__position_bits(p + 3 * (size_t)b->table[slot], other);
            if (memcmp(bits, other, sizeof bits) == 0) {
                break;
            }
        }
        if (b->table[slot] == SDV_NONE) {
            b->table[slot] = i;
        } else {
            b->target[i] = b->table[slot];
            sdv__warn(b, SDV_LOG_NODES_MERGED, i);
        }
    }
}

/* Segments between merged nodes, each pair once. */
static void sdv__pick_segments(sdv__build *b) {
    uint32_t i;
    memset(b->table, 0xff, ((size_t)b->table_mask + 1) * sizeof *b->table);
    for (i = 0; i < b->desc->segment_count; i++) {
        uint32_t from = b->target[b->desc->segments[i].parent];
        uint32_t to = b->target[b->desc->segments[i].child];
        uint32_t low = from < to ? from : to, high = from < to ? to : from, slot;
        if (from == to) {
            sdv__warn(b, SDV_LOG_SEGMENTS_LOOSE, i);
            continue;
        }
        slot = sdv__mix(low, high, 7) & b->table_mask;
        for (; b->table[slot] != SDV_NONE; slot = (slot + 1) & b->table_mask) {
            const sdv_segment *s = b->segments + b->table[slot];
            if ((s->parent == low && s->child == high) || (s->parent == high && s->child == low)) {
                break;
            }
        }
        if (b->table[slot] != SDV_NONE) {
            sdv__warn(b, SDV_LOG_SEGMENTS_REPEATED, i);
            continue;
        }
        b->table[slot] = b->segment_count;
        b->segments[b->segment_count].parent = from;
        b->segments[b->segment_count].child = to;
        b->segment_source[b->segment_count++] = i;
    }
}

static float sdv__radius(sdv__build *b, uint32_t i) {
    float r = b->desc->radii ? b->desc->radii[i] : 0.0f;
    if (!(r >= 0.0f && r <= 1e9f)) {
        sdv__warn(b, SDV_LOG_RADIUS_MISSING, i);
        return 0.0f;
    }
    if (r == 0.0f && b->desc->radii) {
        sdv__warn(b, SDV_LOG_RADIUS_ZERO, i);
    }
    return r + 0.0f;
}

/* Gives the nodes that stay their final indices, in the order of the desc. */
static void sdv__pick_nodes(sdv__build *b) {
    uint32_t i, n = b->desc->node_count;
    int drop = (b->desc->flags & SDV_TREE_DROP) && b->segment_count > 0;
    memset(b->degree, 0, n * sizeof *b->degree);
    for (i = 0; i < b->segment_count; i++) {
        b->degree[b->segments[i].parent]++;
        b->degree[b->segments[i].child]++;
    }
    for (i = 0; i < n; i++) {
        if (b->target[i] < i) { /* merged: the first one has its index already */
            uint32_t first = b->target[b->target[i]];
            b->target[i] = first;
            if (first != SDV_NONE) {
                float r = sdv__radius(b, i);
                b->radius[first] = r > b->radius[first] ? r : b->radius[first];
            }
        } else if (drop && b->degree[i] == 0) {
            sdv__warn(b, SDV_LOG_NODES_ISOLATED, i);
            b->target[i] = SDV_NONE;
        } else {
            b->degree[b->node_count] = b->degree[i];
            b->radius[b->node_count] = sdv__radius(b, i);
            b->source[b->node_count] = i;
            b->target[i] = b->node_count++;
        }
    }
    for (i = 0; i < b->segment_count; i++) {
        b->segments[i].parent = b->target[b->segments[i].parent];
        b->segments[i].child = b->target[b->segments[i].child];
    }
}

static const float *sdv__build_position(const sdv__build *b, uint32_t node) {
    return b->desc->positions + 3 * (size_t)b->source[node];
}

/* Union-find with path halving; a group is named by its lowest node. */
static uint32_t sdv__group(uint32_t *group, uint32_t i) {
    while (group[i] != i) {
        group[i] = group[group[i]];
        i = group[i];
    }
    return i;
}
static int sdv__unite(uint32_t *group, uint32_t a, uint32_t b) {
    a = sdv__group(group, a);
    b = sdv__group(group, b);
    if (a < b) {
        group[b] = a;
    } else {
        group[a] = b;
    }
    return a != b;
}
static void sdv__group_segments(sdv__build *b) {
    uint32_t i;
    for (i = 0; i < b->node_count; i++) {
        b->group[i] = i;
    }
    for (i = 0; i < b->segment_count; i++) {
        sdv__unite(b->group, b->segments[i].parent, b->segments[i].child);
    }
}

/* ---- joining: spheres lie in hashed cells at least as wide as they are, one grid per power of
   two, so that whatever holds a point is in the 27 cells around it */
static int sdv__sphere_level(float radius) {
    int exponent;
    (void)frexpf(radius, &exponent);
    return exponent; /* radius < 2^exponent = width of the cells */
}
static uint32_t sdv__cell_slot(const sdv__build *b, const float *p, int level, const int step[3]) {
    uint32_t h = (uint32_t)level;
    int k;
    for (k = 0; k < 3; k++) {
        double cell = floor(ldexp((double)p[k], -level)) + step[k];
        uint64_t bits;
        memcpy(&bits, &cell, sizeof bits);
        h = sdv__mix(h, (uint32_t)bits, (uint32_t)(bits >> 32));
    }
    return h & b->table_mask;
}
static double sdv__distance2(const float *p, const float *q) {
    double x = (double)p[0] - (double)q[0], y = (double)p[1] - (double)q[1],
           z = (double)p[2] - (double)q[2];
    return x * x + y * y + z * z;
}
/* The nearest node of another component whose sphere holds the point; SDV_NONE: none. */
static uint32_t sdv__holder(const sdv__build *b, uint32_t end, uint64_t levels) {
    const float *p = sdv__build_position(b, end);
    uint32_t own = sdv__group(b->group, end), best = SDV_NONE;
    double least = 0;
    int level, i;
    for (level = -149; level <= 30; level++) {
        int bit = level < -31 ? 0 : level + 32; /* the smallest share a flag */
        if (!(levels >> bit & 1)) {
            continue;
        }
        for (i = 0; i < 27; i++) {
            int step[3];
            uint32_t node;
            step[0] = i % 3 - 1;
            step[1] = i / 3 % 3 - 1;
            step[2] = i / 9 - 1;
            node = b->table[sdv__cell_slot(b, p, level, step)];
            for (; node != SDV_NONE; node = b->next[node]) {
                double r = (double)b->radius[node];
                double d = sdv__distance2(p, sdv__build_position(b, node));
                if (d <= r * r && sdv__group(b->group, node) != own &&
                    (best == SDV_NONE || d < least || (d == least && node < best))) {
                    best = node;
                    least = d;
                }
            }
        }
    }
    return best;
}
static void sdv__join(sdv__build *b) {
    static const int here[3] = {0, 0, 0};
    uint32_t i, ends = b->node_count;
    uint64_t levels = 0;
    memset(b->table, 0xff, ((size_t)b->table_mask + 1) * sizeof *b->table);
    for (i = 0; i < b->node_count; i++) {
        if (b->radius[i] > 0.0f) {
            int level = sdv__sphere_level(b->radius[i]);
            uint32_t slot = sdv__cell_slot(b, sdv__build_position(b, i), level, here);
            levels |= (uint64_t)1 << (level < -31 ? 0 : level + 32);
            b->next[i] = b->table[slot];
            b->table[slot] = i;
        }
    }
    for (i = 0; i < ends; i++) {
        uint32_t node = b->degree[i] <= 1 ? sdv__holder(b, i, levels) : SDV_NONE;
        if (node != SDV_NONE) {
            sdv__unite(b->group, i, node);
            b->segments[b->segment_count].parent = node;
            b->segments[b->segment_count].child = i;
            b->segment_source[b->segment_count++] = SDV_NONE;
            b->joined++;
            sdv__warn(b, SDV_LOG_LINES_JOINED, b->source[i]);
        }
    }
}

/* The segments of each node, ascending. */
static void sdv__build_incidence(sdv__build *b) {
    uint32_t i, sum = 0;
    memset(b->first, 0, ((size_t)b->node_count + 1) * sizeof *b->first);
    for (i = 0; i < b->segment_count; i++) {
        b->first[b->segments[i].parent]++;
        b->first[b->segments[i].child]++;
    }
    for (i = 0; i <= b->node_count; i++) {
        uint32_t count = i < b->node_count ? b->first[i] : 0;
        b->first[i] = sum;
        sum += count;
    }
    for (i = 0; i < b->segment_count; i++) { /* first = the next free place, */
        b->incident[b->first[b->segments[i].parent]++] = i;
        b->incident[b->first[b->segments[i].child]++] = i;
    }
    for (i = b->node_count; i > 0; i--) { /* and back */
        b->first[i] = b->first[i - 1];
    }
    b->first[0] = 0;
}

static void sdv__tree_parts(const sdv__build *b, sdv_tree *t, sdv__block *block) {
    const sdv_tree_desc *desc = b->desc;
    uint64_t n = t->node_count, m = t->segment_count;
    uint32_t i;
    t->nodes = (lao_v4 *)sdv__part(block, n, sizeof(lao_v4));
    t->segments = (sdv_segment *)sdv__part(block, m, sizeof(sdv_segment));
    t->roots = sdv__part_u32(block, t->root_count);
    t->parents = sdv__part_u32(block, n);
    t->parent_segments = sdv__part_u32(block, n);
    t->components = sdv__part_u32(block, n);
    t->order = sdv__part_u32(block, n);
    t->child_counts = sdv__part_u32(block, n);
    t->node_sources = sdv__part_u32(block, n);
    t->segment_sources = sdv__part_u32(block, m);
    t->node_targets = sdv__part_u32(block, t->source_count);
    t->node_attributes =
        (sdv_attribute *)sdv__part(block, t->node_attribute_count, sizeof(sdv_attribute));
    t->segment_attributes =
        (sdv_attribute *)sdv__part(block, t->segment_attribute_count, sizeof(sdv_attribute));
    for (i = 0; i < t->node_attribute_count + t->segment_attribute_count; i++) {
        int of_node = i < t->node_attribute_count;
        uint32_t k = of_node ? i : i - t->node_attribute_count;
        const sdv_attribute *from =
            (of_node ? desc->node_attributes : desc->segment_attributes) + k;
        uint32_t components = from->components ? from->components : 1;
        char *name = (char *)sdv__part(block, strlen(from->name) + 1, 1);
        float *values = (float *)sdv__part(block, (of_node ? n : m) * components, sizeof(float));
        if (block->base) {
            sdv_attribute *to = (of_node ? t->node_attributes : t->segment_attributes) + k;
            memcpy(name, from->name, strlen(from->name) + 1);
            to->name = name;
            to->components = components;
            to->values = values;
        }
    }
}

/* Copies the values of an attribute; a source SDV_NONE has none. */
static void sdv__attribute_copy(const sdv_attribute *from, const sdv_attribute *to,
                                const uint32_t *sources, uint32_t count) {
    float *values = (float *)(uintptr_t)to->values;
    uint32_t i, k, n = to->components;
    for (i = 0; i < count; i++) {
        for (k = 0; k < n; k++) {
            values[(size_t)i * n + k] = sources[i] == SDV_NONE
                                            ? lao_bits_float(0x7fc00000u)
                                            : from->values[(size_t)sources[i] * n + k];
        }
    }
}

/* Per component its root: the lowest node that no segment enters, else the first node of its first
   segment, else the node itself. */
static void sdv__tree_roots(sdv__build *b, sdv_tree *t) {
    uint32_t i, directed = !(b->desc->flags & SDV_TREE_UNDIRECTED);
    uint32_t *root = t->roots;
    for (i = 0; i < t->root_count; i++) {
        root[i] = SDV_NONE;
    }
    for (i = 0; directed && i < t->node_count; i++) {
        if (b->entered[i] == 0 && root[t->components[i]] == SDV_NONE) {
            root[t->components[i]] = i;
        }
    }
    for (i = 0; i < t->segment_count; i++) {
        uint32_t c = t->components[b->segments[i].parent];
        root[c] = root[c] == SDV_NONE ? b->segments[i].parent : root[c];
    }
    for (i = 0; i < t->node_count; i++) {
        uint32_t c = t->components[i];
        root[c] = root[c] == SDV_NONE ? i : root[c];
    }
}

static void sdv__visit(sdv_tree *t, uint32_t node, uint32_t parent, uint32_t segment,
                       uint32_t *tail) {
    t->parents[node] = parent;
    t->parent_segments[node] = segment;
    t->order[(*tail)++] = node;
}

/* Breadth first along the segments; against them only when nothing else is left. */
static void sdv__tree_grow(sdv__build *b, sdv_tree *t) {
    uint32_t undirected = b->desc->flags & SDV_TREE_UNDIRECTED;
    uint32_t i, k, head = 0, tail = 0, later_head = 0, later_tail = 0;
    const uint32_t unseen = SDV_NONE - 1;
    for (i = 0; i < t->node_count; i++) {
        t->parents[i] = unseen;
    }
    for (i = 0; i < t->root_count; i++) {
        sdv__visit(t, t->roots[i], SDV_NONE, SDV_NONE, &tail);
        while (head < tail || later_head < later_tail) {
            if (head == tail) {
                uint32_t e = b->later[later_head++];
                if (t->parents[b->segments[e].parent] == unseen) {
                    b->turned[e] = 1;
                    sdv__visit(t, b->segments[e].parent, b->segments[e].child, e, &tail);
                }
                continue;
            }
            for (k = b->first[t->order[head]]; k < b->first[t->order[head] + 1]; k++) {
                uint32_t node = t->order[head], e = b->incident[k];
                int along = b->segments[e].parent == node;
                uint32_t other = along ? b->segments[e].child : b->segments[e].parent;
                if (t->parents[other] != unseen) {
                    continue;
                }
                if (along || undirected || b->segment_source[e] == SDV_NONE) {
                    b->turned[e] = (unsigned char)!along;
                    sdv__visit(t, other, node, e, &tail);
                } else {
                    b->later[later_tail++] = e;
                }
            }
            head++;
        }
    }
}

/* Final directions: along the tree; loops of undirected segments from the node reached first. */
static void sdv__tree_segments(sdv__build *b, sdv_tree *t) {
    uint32_t i, *place = b->first; /* free by now */
    for (i = 0; i < t->node_count; i++) {
        place[t->order[i]] = i;
    }
    for (i = 0; i < t->segment_count; i++) {
        sdv_segment s = b->segments[i];
        int tree = t->parent_segments[s.parent] == i || t->parent_segments[s.child] == i;
        int undirected = (b->desc->flags & SDV_TREE_UNDIRECTED) || b->segment_source[i] == SDV_NONE;
        if (tree ? b->turned[i] : (undirected && place[s.parent] > place[s.child])) {
            uint32_t swap = s.parent;
            s.parent = s.child;
            s.child = swap;
            if (!undirected) {
                sdv__warn(b, SDV_LOG_SEGMENTS_TURNED, b->segment_source[i]);
            }
        }
        t->segments[i] = s;
        t->segment_sources[i] = b->segment_source[i];
        t->child_counts[s.parent]++;
        if (!tree) {
            sdv__warn(b, SDV_LOG_TREE_LOOPS, b->segment_source[i]);
        }
        if (memcmp(&t->nodes[s.parent], &t->nodes[s.child], 3 * sizeof(float)) == 0) {
            sdv__warn(b, SDV_LOG_SEGMENTS_ZERO, b->segment_source[i]);
        }
    }
}

static void sdv__tree_nodes(const sdv__build *b, sdv_tree *t) {
    uint32_t i, k;
    for (i = 0; i < t->node_count; i++) {
        const float *p = sdv__build_position(b, i);
        t->nodes[i].x = p[0] + 0.0f;
        t->nodes[i].y = p[1] + 0.0f;
        t->nodes[i].z = p[2] + 0.0f;
        t->nodes[i].w = b->radius[i];
        t->node_sources[i] = b->source[i];
        t->child_counts[i] = 0;
    }
    memcpy(t->node_targets, b->target, t->source_count * sizeof *b->target);
    for (k = 0; k < t->node_attribute_count; k++) {
        sdv__attribute_copy(b->desc->node_attributes + k, t->node_attributes + k, t->node_sources,
                            t->node_count);
    }
    for (k = 0; k < t->segment_attribute_count; k++) {
        sdv__attribute_copy(b->desc->segment_attributes + k, t->segment_attributes + k,
                            b->segment_source, t->segment_count);
    }
}

static void sdv__tree_components(sdv__build *b, sdv_tree *t) {
    uint32_t i, n = 0;
    for (i = 0; i < t->node_count;
         i++) { /* a group is named by its lowest node, which comes first */
        uint32_t g = sdv__group(b->group, i);
        t->components[i] = g == i ? n++ : t->components[g];
    }
    memset(b->entered, 0, t->node_count * sizeof *b->entered);
    for (i = 0; i < t->segment_count; i++) {
        b->entered[b->segments[i].child] += b->segment_source[i] != SDV_NONE;
    }
}

static void sdv__tree_info(const sdv__build *b, sdv_tree *t) {
    sdv_tree_info *info = &t->info;
    uint32_t i, k, seen = 0;
    memset(info, 0, sizeof *info);
    info->nodes = t->node_count;
    info->segments = t->segment_count;
    info->roots = t->root_count;
    info->loops = t->segment_count + t->root_count - t->node_count;
    info->joined = b->joined;
    for (i = 0; i < t->node_count; i++) {
        uint32_t children = t->child_counts[i];
        const float *p = &t->nodes[i].x;
        info->leaves += children == 0 && t->parents[i] != SDV_NONE;
        info->branches += children >= 2;
        info->multifurcations += children >= 3;
        info->max_children = children > info->max_children ? children : info->max_children;
        for (k = 0; k < 3; k++) {
            float v = p[k];
            info->bounds[0][k] = i == 0 || v < info->bounds[0][k] ? v : info->bounds[0][k];
            info->bounds[1][k] = i == 0 || v > info->bounds[1][k] ? v : info->bounds[1][k];
        }
    }
    for (i = 0; b->desc->radii && i < b->desc->node_count; i++) {
        float r = b->desc->radii[i];
        if (b->target[i] != SDV_NONE && r - r == 0.0f) {
            info->radius[0] = !seen || r < info->radius[0] ? r : info->radius[0];
            info->radius[1] = !seen || r > info->radius[1] ? r : info->radius[1];
            seen = 1;
        }
    }
}

static size_t sdv__warning_text(const sdv_warning *w, char *text, size_t size) {
    int n;
    if (w->first == SDV_NONE) {
        n = snprintf(text, size, "%s (%u)", sdv__items[w->item].text, w->count);
    } else {
        n = snprintf(text, size, "%s (%u, first: %u)", sdv__items[w->item].text, w->count,
                     w->first);
    }
    return (size_t)n;
}
SDV_API size_t sdv_tree_warning_text(const sdv_tree *tree, uint32_t i, char *text, size_t size) {
    if (!tree || i >= tree->warning_count) {
        if (size) {
            text[0] = 0;
        }
        return 0;
    }
    return sdv__warning_text(tree->warnings + i, text, size);
}
static void sdv__tree_warnings(sdv__build *b, sdv_tree *t) {
    uint32_t i;
    for (i = 1; i < t->root_count; i++) {
        sdv__warn(b, SDV_LOG_TREE_ROOTS, t->roots[0]);
    }
    for (i = 0; i < b->warning_count; i++) {
        char text[256];
        if (b->warnings[i].item == SDV_LOG_TREE_ROOTS) {
            b->warnings[i].count = t->root_count;
        }
        sdv__warning_text(b->warnings + i, text, sizeof text);
        if (b->host && b->host->log) {
            b->host->log(b->host->user, b->warnings[i].item, LAO_OK, text);
        }
    }
    memcpy(t->warnings, b->warnings, sizeof t->warnings);
    t->warning_count = b->warning_count;
}

/* The tree from what was picked. */
static lao_result sdv__tree_finish(sdv__build *b, sdv_tree *out) {
    sdv_tree t;
    sdv__block block = {NULL, 0};
    uint32_t i;
    memset(&t, 0, sizeof t);
    t.node_count = b->node_count;
    t.segment_count = b->segment_count;
    t.source_count = b->desc->node_count;
    t.node_attribute_count = b->desc->node_attribute_count;
    t.segment_attribute_count = b->desc->segment_attribute_count;
    for (i = 0; i < b->node_count; i++) {
        t.root_count += b->group[i] == i;
    }
    sdv__tree_parts(b, &t, &block);
    t.memory = sdv__take(&b->allocator, block.used, 1);
    if (!t.memory) {
        return sdv__fail(b->host, SDV_LOG_MEMORY, "the tree");
    }
    block.base = (unsigned char *)t.memory;
    block.used = 0;
    sdv__tree_parts(b, &t, &block);
    t.allocator = b->allocator;
    sdv__build_incidence(b);
    sdv__tree_nodes(b, &t);
    sdv__tree_components(b, &t);
    sdv__tree_roots(b, &t);
    sdv__tree_grow(b, &t);
    sdv__tree_segments(b, &t);
    sdv__tree_info(b, &t);
    sdv__tree_warnings(b, &t);
    *out = t;
    return LAO_OK;
}

SDV_API lao_result sdv_tree_build(const sdv_host *host, const sdv_tree_desc *desc, sdv_tree *tree) {
    sdv__build b;
    sdv__block block = {NULL, 0};
    lao_result result;
    if (!desc || !tree) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_tree_build");
    }
    result = sdv__tree_check(host, desc);
    if (result != LAO_OK) {
        return result;
    }
    memset(&b, 0, sizeof b);
    b.host = host;
    b.desc = desc;
    b.allocator = sdv__allocator(host);
    sdv__build_parts(&b, &block);
    block.base = (unsigned char *)sdv__take(&b.allocator, block.used, 1);
    if (!block.base) {
        return sdv__fail(host, SDV_LOG_MEMORY, "building a tree of %u nodes", desc->node_count);
    }
    block.used = 0;
    sdv__build_parts(&b, &block);
    memset(b.turned, 0, (size_t)desc->node_count + desc->segment_count);
    sdv__merge(&b);
    sdv__pick_segments(&b);
    sdv__pick_nodes(&b);
    sdv__group_segments(&b);
    if (desc->flags & SDV_TREE_JOIN) {
        sdv__join(&b);
    }
    result = sdv__tree_finish(&b, tree);
    sdv__give(&b.allocator, block.base);
    return result;
}

SDV_API void sdv_tree_free(sdv_tree *tree) {
    if (tree && tree->memory) {
        sdv__give(&tree->allocator, tree->memory);
        memset(tree, 0, sizeof *tree);
    }
}

/* ================================================================================================
 * reduced tree */

static void sdv__reduced_parts(sdv_reduced *r, uint32_t tree_nodes, sdv__block *block) {
    r->ids = sdv__part_u32(block, r->node_count);
    r->nodes = sdv__part_u32(block, r->node_count);
    r->parents = sdv__part_u32(block, r->node_count);
    r->children = sdv__part_u32(block, 2 * (uint64_t)r->node_count);
    r->order = sdv__part_u32(block, r->node_count);
    r->roots = sdv__part_u32(block, r->root_count);
    r->owners = sdv__part_u32(block, tree_nodes);
}

/* Children along the spanning tree. */
static void sdv__count_children(const sdv_tree *t, uint32_t *counts) {
    uint32_t i;
    memset(counts, 0, t->node_count * sizeof *counts);
    for (i = 0; i < t->node_count; i++) {
        if (t->parents[i] != SDV_NONE) {
            counts[t->parents[i]]++;
        }
    }
}
static int sdv__is_kept(const sdv_tree *t, const uint32_t *counts, uint32_t i) {
    return counts[i] != 1 || t->parents[i] == SDV_NONE;
}
static uint32_t sdv__extra_count(const sdv_tree *t, const uint32_t *counts, uint32_t i) {
    uint32_t root = t->parents[i] == SDV_NONE;
    return counts[i] < 2 ? 0 : counts[i] - 2 + root;
}

/* Owners, upwards: a node between branches belongs to the first kept node below it. */
static void sdv__reduced_owners(const sdv_tree *t, const uint32_t *counts, sdv_reduced *r) {
    uint32_t i, n = 0;
    for (i = 0; i < t->node_count; i++) {
        if (sdv__is_kept(t, counts, i)) {
            r->ids[n] = i;
            r->nodes[n] = i;
            r->owners[i] = n++;
        }
    }
    for (i = t->node_count; i-- > 0;) {
        uint32_t node = t->order[i], parent = t->parents[node];
        if (parent != SDV_NONE && !sdv__is_kept(t, counts, parent)) {
            r->owners[parent] = r->owners[node];
        }
    }
}

/* Hangs `children`, ascending, below the kept node k; extra nodes are taken from *extra on. */
static void sdv__reduced_hang(sdv_reduced *r, uint32_t k, int root, const uint32_t *children,
                              uint32_t count, uint32_t first_id, uint32_t first_extra,
                              uint32_t *extra) {
    uint32_t at = k, i = 0;
    while (count - i > (at == k && root ? 1u : 2u)) {
        uint32_t e = (*extra)++, only = at == k && root;
        r->ids[e] = first_id + (e - first_extra);
        r->nodes[e] = r->nodes[k];
        r->parents[e] = at;
        if (!only) {
            r->parents[children[i]] = at;
        }
        r->children[2 * (size_t)at] = only ? e : children[i++];
        r->children[2 * (size_t)at + 1] = only ? SDV_NONE : e;
        at = e;
    }
    for (k = 0; k < 2; k++) {
        uint32_t child = i + k < count ? children[i + k] : SDV_NONE;
        r->children[2 * (size_t)at + k] = child;
        if (child != SDV_NONE) {
            r->parents[child] = at;
        }
    }
}

static void sdv__reduced_fill(const sdv_tree *t, const uint32_t *counts, uint32_t kept,
                              uint32_t *first, uint32_t *list, sdv_reduced *r) {
    uint32_t k, sum = 0, extra = kept, roots = 0, head = 0, tail = 0;
    sdv__reduced_owners(t, counts, r);
    for (k = 0; k < kept; k++) { /* parents and child lists of the kept nodes, ascending */
        first[k] = sum;
        sum += counts[r->ids[k]];
    }
    for (k = 0; k < kept; k++) {
        uint32_t up = t->parents[r->ids[k]];
        while (up != SDV_NONE && !sdv__is_kept(t, counts, up)) {
            up = t->parents[up];
        }
        r->parents[k] = SDV_NONE;
        if (up != SDV_NONE) {
            list[first[r->owners[up]]++] = k;
        } else {
            r->roots[roots++] = k;
        }
    }
    for (k = 0; k < kept; k++) {
        uint32_t n = counts[r->ids[k]], root = t->parents[r->ids[k]] == SDV_NONE;
        sdv__reduced_hang(r, k, (int)root, list + (first[k] - n), n, t->node_count, kept, &extra);
    }
    for (k = 0; k < roots; k++) {
        r->order[tail++] = r->roots[k];
    }
    for (; head < tail; head++) {
        for (k = 0; k < 2; k++) {
            uint32_t child = r->children[2 * (size_t)r->order[head] + k];
            if (child != SDV_NONE) {
                r->order[tail++] = child;
            }
        }
    }
}

SDV_API lao_result sdv_reduce(const sdv_host *host, const sdv_tree *tree, sdv_reduced *reduced) {
    lao_allocator a = sdv__allocator(host);
    sdv__block block = {NULL, 0};
    sdv_reduced r;
    uint32_t i, kept = 0, *scratch;
    uint64_t n;
    if (!tree || !reduced || !tree->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_reduce");
    }
    n = tree->node_count;
    scratch = (uint32_t *)sdv__take(&a, 3 * n, sizeof *scratch); /* counts, first, list */
    if (!scratch) {
        return sdv__fail(host, SDV_LOG_MEMORY, "reducing a tree of %u nodes", tree->node_count);
    }
    memset(&r, 0, sizeof r);
    r.allocator = a;
    sdv__count_children(tree, scratch);
    for (i = 0; i < tree->node_count; i++) {
        kept += (uint32_t)sdv__is_kept(tree, scratch, i);
        r.node_count += sdv__extra_count(tree, scratch, i);
        r.root_count += tree->parents[i] == SDV_NONE;
    }
    r.node_count += kept;
    sdv__reduced_parts(&r, tree->node_count, &block);
    r.memory = sdv__take(&a, block.used, 1);
    if (!r.memory) {
        sdv__give(&a, scratch);
        return sdv__fail(host, SDV_LOG_MEMORY, "a reduced tree of %u nodes", r.node_count);
    }
    block.base = (unsigned char *)r.memory;
    block.used = 0;
    sdv__reduced_parts(&r, tree->node_count, &block);
    sdv__reduced_fill(tree, scratch, kept, scratch + n, scratch + 2 * n, &r);
    sdv__give(&a, scratch);
    *reduced = r;
    return LAO_OK;
}

SDV_API void sdv_reduced_free(sdv_reduced *reduced) {
    if (reduced && reduced->memory) {
        sdv__give(&reduced->allocator, reduced->memory);
        memset(reduced, 0, sizeof *reduced);
    }
}

/* ================================================================================================
 * layout */

typedef struct sdv__layout_work {
    const sdv_reduced *r;
    double *h, *s, *low, *high, *weight;
    double ph;
} sdv__layout_work;

static double sdv__scalar(const float *scalars, uint32_t node) {
    double v = scalars ? (double)scalars[node] : 1.0;
    return v > 0.0 && v <= 3.5e38 ? v : 0.0;
}

/* Weights (METHODS 8): the sum over the sub-tree, in the reduced tree or in the whole one. Extra
   nodes count as nodes and carry no scalar. */
static void sdv__layout_weights(const sdv_tree *t, const sdv_layout_desc *desc,
                                sdv__layout_work *w) {
    const sdv_reduced *r = w->r;
    uint32_t i, n = r->node_count, own = desc->flags & SDV_LAYOUT_OWN;
    double least = 0;
    for (i = 0; i < n; i++) {
        int extra = r->ids[i] >= t->node_count;
        w->weight[i] =
            !extra || own ? sdv__scalar(desc->scalars, r->nodes[i]) : (desc->scalars ? 0.0 : 1.0);
    }
    for (i = 0; !own && (desc->flags & SDV_LAYOUT_ALL_NODES) && i < t->node_count; i++) {
        if (r->ids[r->owners[i]] != i) {
            w->weight[r->owners[i]] += sdv__scalar(desc->scalars, i);
        }
    }
    for (i = n; !own && i-- > 0;) {
        uint32_t node = r->order[i], parent = r->parents[node];
        if (parent != SDV_NONE) {
            w->weight[parent] += w->weight[node];
        }
    }
    for (i = 0; i < n; i++) {
        if (w->weight[i] > 0 && (least == 0 || w->weight[i] < least)) {
            least = w->weight[i];
        }
    }
    for (i = 0; i < n; i++) {
        if (!(w->weight[i] > 0)) {
            w->weight[i] = least > 0 ? least : 1.0;
        }
    }
}

/* Roots and their children lie at the same place; several roots share [0, 1]. */
static void sdv__layout_start(sdv__layout_work *w) {
    const sdv_reduced *r = w->r;
    double sum = 0, at = 0;
    uint32_t i;
    for (i = 0; i < r->root_count; i++) {
        sum += w->weight[r->roots[i]];
    }
    for (i = 0; i < r->root_count; i++) {
        uint32_t root = r->roots[i], child = r->children[2 * (size_t)root];
        double low = at / sum;
        at += w->weight[root];
        w->low[root] = low;
        w->high[root] = i + 1 == r->root_count ? 1.0 : at / sum;
        w->h[root] = 0.5 * (low + w->high[root]);
        w->s[root] = 1.0;
        if (child != SDV_NONE) {
            w->low[child] = low;
            w->high[child] = w->high[root];
            w->h[child] = w->h[root];
            w->s[child] = 1.0;
        }
    }
}

/* Algorithm 1, lines 3 to 12, for one node with two children. */
static void sdv__layout_children(sdv__layout_work *w, uint32_t n) {
    uint32_t c1 = w->r->children[2 * (size_t)n], c2 = w->r->children[2 * (size_t)n + 1];
    double w1 = w->weight[c1], w2 = w->weight[c2], r1 = w->low[n], r2 = w->high[n];
    double less = w1 < w2 ? w1 / w2 : w2 / w1, more = w1 < w2 ? w2 / w1 : w1 / w2;
    double share = w1 / (w1 + w2), exponent = w->ph * more;
    double wr = pow(less, exponent < 1e6 ? exponent : 1e6);
    double middle = r1 + (r2 - r1) * share;
    double m1 = (wr - 1) * (0.5 * (r1 + middle) - w->h[n]);
    double m2 = (wr - 1) * (0.5 * (middle + r2) - w->h[n]);
    w->s[c1] = w->s[n] - (w1 < w2 ? sqrt(less) : 1.0);
    w->s[c2] = w->s[n] - (w2 < w1 ? sqrt(less) : 1.0);
    w->low[c1] = r1 + m1;
    w->high[c1] = middle + m1;
    w->low[c2] = middle + m2;
    w->high[c2] = r2 + m2;
    w->h[c1] = 0.5 * (w->low[c1] + w->high[c1]);
    w->h[c2] = 0.5 * (w->low[c2] + w->high[c2]);
}

static void sdv__layout_parts(sdv_layout *l, sdv__block *block) {
    l->h = (float *)sdv__part(block, l->node_count, sizeof(float));
    l->s = (float *)sdv__part(block, l->node_count, sizeof(float));
    l->weights = (float *)sdv__part(block, l->node_count, sizeof(float));
}

static void sdv__layout_finish(const sdv__layout_work *w, sdv_layout *l) {
    uint32_t i;
    double least = 1.0;
    for (i = 0; i < l->node_count; i++) {
        least = w->s[i] < least ? w->s[i] : least;
    }
    for (i = 0; i < l->node_count; i++) {
        double s = least < 1.0 ? (w->s[i] - least) / (1.0 - least) : 1.0;
        double h = w->h[i] < 0.0 ? 0.0 : w->h[i] > 1.0 ? 1.0 : w->h[i];
        l->h[i] = (float)h;
        l->s[i] = (float)s;
        l->weights[i] = (float)w->weight[i];
    }
}

SDV_API lao_result sdv_layout_make(const sdv_host *host, const sdv_tree *tree,
                                   const sdv_reduced *reduced, const sdv_layout_desc *desc,
                                   sdv_layout *layout) {
    const sdv_layout_desc standard = {NULL, 0, 0, 0};
    sdv__layout_work w;
    sdv__block block = {NULL, 0};
    sdv_layout l;
    double *scratch;
    uint32_t i;
    if (!tree || !reduced || !layout || !reduced->memory || !tree->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_layout_make");
    }
    desc = desc ? desc : &standard;
    if (desc->has_ph && !(desc->ph >= 0.0f)) {
        return sdv__fail(host, SDV_LOG_LAYOUT_PH, NULL);
    }
    memset(&l, 0, sizeof l);
    l.node_count = reduced->node_count;
    l.allocator = sdv__allocator(host);
    scratch = (double *)sdv__take(&l.allocator, 5 * (uint64_t)l.node_count, sizeof *scratch);
    sdv__layout_parts(&l, &block);
    l.memory = scratch ? sdv__take(&l.allocator, block.used, 1) : NULL;
    if (!l.memory) {
        sdv__give(&l.allocator, scratch);
        return sdv__fail(host, SDV_LOG_MEMORY, "a layout of %u nodes", l.node_count);
    }
    block.base = (unsigned char *)l.memory;
    block.used = 0;
    sdv__layout_parts(&l, &block);
    w.r = reduced;
    w.h = scratch;
    w.s = scratch + l.node_count;
    w.low = scratch + 2 * (size_t)l.node_count;
    w.high = scratch + 3 * (size_t)l.node_count;
    w.weight = scratch + 4 * (size_t)l.node_count;
    w.ph = desc->has_ph ? (double)desc->ph : 4.0 / (double)l.node_count;
    sdv__layout_weights(tree, desc, &w);
    sdv__layout_start(&w);
    for (i = 0; i < l.node_count; i++) {
        if (reduced->children[2 * (size_t)reduced->order[i] + 1] != SDV_NONE) {
            sdv__layout_children(&w, reduced->order[i]);
        }
    }
    sdv__layout_finish(&w, &l);
    sdv__give(&l.allocator, scratch);
    *layout = l;
    return LAO_OK;
}

SDV_API void sdv_layout_free(sdv_layout *layout) {
    if (layout && layout->memory) {
        sdv__give(&layout->allocator, layout->memory);
        memset(layout, 0, sizeof *layout);
    }
}

/* Formatted text to a writer; a locale's decimal comma becomes a point. Numbers only. */
static int sdv__print(const sdv_writer *writer, const char *format, ...) {
    char text[512];
    va_list list;
    int n;
    va_start(list, format);
    n = vsnprintf(text, sizeof text, format, list);
    va_end(list);
    if (n < 0 || (size_t)n >= sizeof text) {
        n = 0;
    }
    return writer->write(writer->user, text, (size_t)n);
}
/* A number as JSON and SVG want it, in `text`; "null" where it is none. */
enum { SDV__NUMBER = 32 };
static const char *sdv__number(double v, char text[SDV__NUMBER]) {
    char *p;
    if (!(v - v == 0.0)) {
        return "null";
    }
    snprintf(text, SDV__NUMBER, "%.9g", v);
    for (p = text; *p; p++) {
        *p = *p == ',' ? '.' : *p;
    }
    return text;
}

SDV_API int sdv_layout_write_json(const sdv_reduced *reduced, const sdv_layout *layout,
                                  const float *distances, const sdv_writer *writer) {
    uint32_t i;
    int stop = sdv__print(writer, "{\"nodes\":[");
    for (i = 0; !stop && i < reduced->node_count; i++) {
        char h[SDV__NUMBER], s[SDV__NUMBER], w[SDV__NUMBER], d[SDV__NUMBER];
        uint32_t parent = reduced->parents[i];
        stop = sdv__print(
            writer,
            "%s\n{\"id\":%u,\"parent\":%lld,\"h\":%s,\"s\":%s,\"weight\":%s,\"distance\":%s}",
            i ? "," : "", reduced->ids[i],
            parent == SDV_NONE ? -1LL : (long long)reduced->ids[parent],
            sdv__number((double)layout->h[i], h), sdv__number((double)layout->s[i], s),
            sdv__number((double)layout->weights[i], w),
            distances ? sdv__number((double)distances[i], d) : "null");
    }
    return stop ? stop : sdv__print(writer, "\n]}\n");
}

static lao_v2 sdv__layout_place(const sdv_layout *l, const sdv_svg_desc *d, uint32_t i) {
    float margin = 0.03f, free_width = d->width * (1 - 2 * margin),
          free_height = d->height * (1 - 2 * margin);
    if (d->radial) {
        float reach = 0.5f * (free_width < free_height ? free_width : free_height);
        lao_v2 p = sdv_radial(l->h[i], l->s[i]);
        return lao_v2_make(0.5f * d->width + reach * p.x, 0.5f * d->height - reach * p.y);
    }
    return lao_v2_make(d->width * margin + free_width * l->h[i],
                       d->height * margin + free_height * (1 - l->s[i]));
}

static int sdv__svg_edge(const sdv_layout *l, const sdv_svg_desc *d, uint32_t from, uint32_t to,
                         const char *color, float width, const sdv_writer *writer) {
    char text[5][SDV__NUMBER];
    lao_v2 p = sdv__layout_place(l, d, from), q = sdv__layout_place(l, d, to);
    return sdv__print(writer,
                      "<line x1=\"%s\" y1=\"%s\" x2=\"%s\" y2=\"%s\" stroke=\"%s\" "
                      "stroke-width=\"%s\"/>\n",
                      sdv__number((double)p.x, text[0]), sdv__number((double)p.y, text[1]),
                      sdv__number((double)q.x, text[2]), sdv__number((double)q.y, text[3]), color,
                      sdv__number((double)width, text[4]));
}

SDV_API int sdv_layout_write_svg(const sdv_reduced *reduced, const sdv_layout *layout,
                                 const sdv_svg_desc *desc, const sdv_writer *writer) {
    sdv_svg_desc d = {0, 0, 0, 0, NULL, 0};
    char width[SDV__NUMBER], height[SDV__NUMBER];
    uint32_t i, round;
    int stop;
    d = desc ? *desc : d;
    d.width = d.width > 0 ? d.width : d.radial ? 768.0f : 1024.0f;
    d.height = d.height > 0 ? d.height : d.radial ? 768.0f : 512.0f;
    d.line_width = d.line_width > 0 ? d.line_width : 2.0f;
    sdv__number((double)d.width, width);
    sdv__number((double)d.height, height);
    stop = sdv__print(writer,
                      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%s\" height=\"%s\">\n"
                      "<rect width=\"%s\" height=\"%s\" fill=\"#303030\"/>\n"
                      "<g stroke-linecap=\"round\">\n",
                      width, height, width, height);
    for (round = d.distances ? 0 : 1; round < 2; round++) { /* marks, then edges over them */
        for (i = 0; !stop && i < reduced->node_count; i++) {
            char color[16];
            lao_v3 c = sdv_hsv(layout->h[i], layout->s[i], 1.0f);
            int risk = d.distances && d.distances[i] < d.risk;
            if (reduced->parents[i] == SDV_NONE || (round == 0 && !risk)) {
                continue;
            }
            snprintf(color, sizeof color, "#%02x%02x%02x", (unsigned)(c.x * 255.0f + 0.5f),
                     (unsigned)(c.y * 255.0f + 0.5f), (unsigned)(c.z * 255.0f + 0.5f));
            stop = sdv__svg_edge(layout, &d, reduced->parents[i], i, round ? color : "#c03028",
                                 round ? d.line_width : 4 * d.line_width, writer);
        }
    }
    return stop ? stop : sdv__print(writer, "</g>\n</svg>\n");
}

#ifdef __cplusplus
}
#endif

#endif /* SDFVESSEL_IMPLEMENTATION_DONE */
#endif /* SDFVESSEL_IMPLEMENTATION */
