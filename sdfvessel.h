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
    X(RADIUS_MISSING, LAO_OK, "nodes have no radius (not a number or negative), 0 is taken")       \
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
    void *memory[2];         /* private */
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
/* The layout as SVG: one line per edge in the colour of its lower node. `desc` NULL: defaults. */
SDV_API int sdv_layout_write_svg(const sdv_reduced *reduced, const sdv_layout *layout,
                                 const sdv_svg_desc *desc, const sdv_writer *writer);

#ifdef __cplusplus
}
#endif

#endif /* SDFVESSEL_H */
