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

   FILES  lineao.h sdfvessel.h. To draw with sdv_module(): also a backend (see lineao.h) and
   sdfvessel_shaders.h, beside lineao_shaders.h.

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
    X(IMAGE_SIZE, LAO_ERROR_INVALID_ARGUMENT,                                                      \
      "an image needs 1 to 32768 pixels each way and 1 to 64 channels")                            \
    X(TARGET_SHAPE, LAO_ERROR_INVALID_ARGUMENT,                                                    \
      "a target needs points that are finite, and triangles of points that exist")                 \
    X(GRID_CELLS, LAO_ERROR_INVALID_ARGUMENT,                                                      \
      "the grid needs 16 to 512 cells along its longest axis and 2^24 in all at most")             \
    X(GRID_LISTS, LAO_ERROR_INVALID_ARGUMENT,                                                      \
      "more than 2^24 segments or entries of cell lists; fewer cells make shorter lists")          \
    X(GRID_TREE, LAO_ERROR_INVALID_ARGUMENT, "the grid was built from another tree")               \
    X(GRID_DEVICE, LAO_OK,                                                                         \
      "the lists of this field may not fit the device's images: the CPU builds it")                \
    X(SHAPES, LAO_ERROR_INVALID_ARGUMENT,                                                          \
      "a tree takes at most 64 shapes, of finite numbers, whose samples exist")                    \
    X(MESH, LAO_ERROR_INVALID_ARGUMENT,                                                            \
      "a mesh needs 1 to 2^24 triangles of at most 2^24 / 3 vertices that exist and are finite")   \
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

/* Attributes of nodes that give vessels a form (L19 6). Their surface stays inside the round cones
   of the nodes' radii, with the amplitude added; all other functions than those that trace and
   shade, distances to targets among them, know the round cones alone.
   - SDV_SECTION_RATIO: the shorter over the longer axis of elliptic cross sections, 0.1 .. 1; the
   node's radius is the longer one. SDV_SECTION_AXIS: direction of the shorter one, of either sign
   (3 components, world; none: z); what of it is along the vessel does not count. Between two nodes
   the section changes from one's to the other's, so that surfaces meet at nodes. The faster it
   turns or flattens on the way, the shorter are the steps of rays there.
   - SDV_UNCERTAINTY: mm, up to 3/4 of the radius: by so much, in and out, noise moves the surface.
   What is no number counts as 1 and 0. */
#define SDV_SECTION_RATIO "section_ratio"
#define SDV_SECTION_AXIS "section_axis"
#define SDV_UNCERTAINTY "uncertainty"

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

/* A tree: read its arrays freely, change only `nodes` (then sdv_grid_update) and `bump_size`. Node
   and segment indices keep the order of the desc. The children of a node are counted by its
   segments; `parents` and `order` follow one spanning tree per root, so that they exist in graphs
   with loops too. */
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
    float bump_size; /* mm across a bump of SDV_UNCERTAINTY; 0: what suits it */
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

typedef struct sdv_drawing_desc {
    float width, height; /* mm; 0: 200 x 100, radial 150 x 150 */
    uint32_t radial;     /* non-zero: angle h, radius 1 - s */
    float thickness;     /* mm, full, of the thinnest edge; 0: what suits the number of edges */
} sdv_drawing_desc;
/* The layout as a tree of its own, to be drawn like any tree into a view of its own: an
   orthographic camera above the plane z = 0 sees it between (0, 0) and (width, height), the root on
   top. Its node k is node k of the tree, on the edge of its reduced node by its way along the
   vessel; from tree->node_count on come the extra nodes (sdv_reduced.ids), so that colours of nodes
   serve both. Edges are the thicker the wider their vessels, by the root of the radius, up to four
   times. Loops are cut. `desc` NULL: defaults. Free with sdv_tree_free. Fails with NULL_ARGUMENT,
   MEMORY. */
SDV_API lao_result sdv_layout_tree(const sdv_host *host, const sdv_tree *tree,
                                   const sdv_reduced *reduced, const sdv_layout *layout,
                                   const sdv_drawing_desc *desc, sdv_tree *drawing);

/* ------------------------------------------------------------------------------------------------
 * the distance field on a grid */

typedef struct sdv_grid_desc {
    uint32_t resolution; /* cells along the longest axis, 16 .. 512; 0: 128 */
    const float *origin; /* (Optional) keep an earlier grid's box: its origin (3), cell and size; */
    float cell;          /* the tree must lie inside. NULL: the bounds of all balls and 2 cells */
    uint32_t size[3];
} sdv_grid_desc;

/* The field of a tree (METHODS 5), ready for upload as texel buffers. A cone is a segment, or
   behind them a node that no segment touches (a ball); `cone_count` may thus exceed
   tree.segment_count. Cell (x, y, z) has index x + size[0] (y + size[1] z) and lists, in ascending
   order, the cones whose signed distance at its centre is at most 2 cells, inside ones too. Hence,
   from any point of the cell, every surface nearer than 1.13 cells is in its list, and an empty
   list means that there is none. Texel of a cell: x  distance at the centre, mm: exact where the
   list is not empty; else that to the list of the nearest cell that has one, d <= x <= d + 1.74
   cells y  that nearest cell (itself where occupied; ties: the lowest index) z  occupied: place of
   its list in `ids`; else how far a ray may go from any point of the cell, mm w  length of the list
   Memory: 20.2 bytes a cell, 4 an entry of the lists, 40 a cone. */
typedef struct sdv_grid {
    lao_v3 origin; /* lower corner, mm */
    float cell;    /* mm */
    uint32_t size[3];
    uint32_t cell_count, id_count, cone_count;
    lao_v4 *cells;    /* cell_count */
    float *ids;       /* id_count: numbers of cones */
    lao_v4 *cones;    /* 2 per cone: centre and radius of both ends (parent, child) */
    lao_v4 *forms;    /* behind the cones; 3 per cone, an sdv_form of the shared text; NULL: all are
                         round */
    lao_v4 *sections; /* private: per node, where there are forms: its section */
    uint32_t *cone_nodes; /* 2 per cone: the nodes */
    uint32_t *layer;      /* private: per cell x + 65536 y of the nearest occupied one at its z */
    uint32_t *occupied;   /* private: a bit per cell that lists something, words along x */
    uint32_t id_room;     /* private: how many `ids` there is memory for */
    uint32_t rebuilt;     /* sdv_grid_update: 1 when it had to build everything anew */
    lao_allocator allocator; /* private */
} sdv_grid;

/* Builds the field. Work is split by layers, so the result does not depend on threads. Fails with
   NULL_ARGUMENT, MEMORY, CANCELLED, GRID_CELLS, GRID_LISTS. `desc` NULL: defaults. */
SDV_API lao_result sdv_grid_build(const sdv_host *host, const sdv_tree *tree,
                                  const sdv_grid_desc *desc, sdv_grid *grid);
/* After the host changed tree->nodes[nodes[i]], i < count: rebuilds what depends on them, to the
   same bits as sdv_grid_build in the same box. A tree that has left the box gets a new one
   (`rebuilt`). On failure, or when cancelled, the grid is as before. */
SDV_API lao_result sdv_grid_update(const sdv_host *host, const sdv_tree *tree,
                                   const uint32_t *nodes, uint32_t count, sdv_grid *grid);
SDV_API void sdv_grid_free(sdv_grid *grid);
/* Signed distance at any point, mm: exact within 1.13 cells of a surface and inside, else at
   most 3.5 cells too great (mostly not at all); of a tree with forms a bound of that, 0 on the same
   surface. `cone` (Optional) gets the nearest one. Thread: any. */
SDV_API float sdv_grid_distance(const sdv_grid *grid, lao_v3 p, uint32_t *cone);
/* The same by going through all cones: the oracle. */
SDV_API float sdv_cones_distance(const lao_v4 *cones, uint32_t count, lao_v3 p, uint32_t *cone);

enum { SDV_TRACE_NEAREST = 1 /* also d_min and t_min */ };

typedef struct sdv_ray {
    lao_v3 origin, direction; /* mm; unit */
    uint32_t flags;           /* SDV_TRACE_... */
    float reach; /* mm: d_min does not matter beyond this, and may then be too great; 0: it
                    does, at several times the cost of a ray */
} sdv_ray;

typedef struct sdv_hit {
    uint32_t cone;   /* SDV_NONE: no hit */
    float t;         /* mm along the ray */
    lao_v3 position; /* mm */
    lao_v3 normal;   /* unit, towards the viewer: the field's gradient, turned round when the ray
                        starts inside a vessel */
    float d_min;     /* mm; hit: the least local minimum on the way (a near miss), SDV_FAR: none; no
                        hit: the least distance of the ray to the tree, exact up to 2 cells, beyond
                        rarely up to a third too great */
    float t_min;     /* where that is */
    uint32_t inside; /* non-zero: the ray starts inside a vessel and hits its wall from within */
    uint32_t steps;
} sdv_hit;

/* Sphere tracing (METHODS 5.3), the oracle of the shaders: the first point of the ray, t >= 0, on
   the surface, |distance| < 1e-3 cell there. No vessel is missed, however thin. A ray that starts
   inside a vessel goes to where it leaves the union: the viewer sees the inner wall. Thread: any.
 */
SDV_API void sdv_trace(const sdv_grid *grid, const sdv_ray *ray, sdv_hit *hit);

/* ------------------------------------------------------------------------------------------------
 * what the field gives for free */

enum { SDV_UNION = 0, SDV_INTERSECTION = 1, SDV_SUBTRACTION = 2 };
enum {
    SDV_SHAPE_BALL = 0,
    SDV_SHAPE_BOX = 1,
    SDV_SHAPE_PLANE = 2,
    SDV_SHAPE_FIELD = 3,
    SDV_SHAPE_TREE = 4 /* the tree itself once more: an organ, cut open, and the tree in it; not to
                          be subtracted */
    ,
    SDV_SHAPE_ELLIPSOID = 5
};

/* What a tree is combined with, one after the other (struct sdv_shape, below). `fields` holds the
   samples of the shapes of kind SDV_SHAPE_FIELD: signed distances, x fastest, none farther from the
   next than their places are. */
struct sdv_shape;
typedef struct sdv_shapes {
    const struct sdv_shape *shapes;
    uint32_t count; /* at most SDV_MOST_SHAPES */
    const float *fields;
    uint32_t field_count; /* samples of all */
} sdv_shapes;
#define SDV_MOST_SHAPES 64u

/* Traces the tree combined with shapes (NULL: none; L19 Fig. 11: max(a, -b) and so on): hit->cone
   is SDV_NONE - 1 where the surface is a shape's, and `shape` (Optional) says which; its normal is
   the shape's, turned inwards where it cuts. d_min (with SDV_TRACE_NEAREST) is that of the combined
   distances, found from samples inside the grid's box and `reach` around it: a few percent too
   great, and less than true in front of edges where shapes cut. Thread: any. */
#define SDV_CUT_CONE (SDV_NONE - 1u)
SDV_API void sdv_trace_shapes(const sdv_grid *grid, const sdv_shapes *shapes, const sdv_ray *ray,
                              sdv_hit *hit, uint32_t *shape);
/* Light that reaches p, 0 .. 1, from the unit direction `light`, past what the field of the tree,
   combined with shapes (NULL: none), says is near the way: 1 / hardness is the light's radius as
   seen from p. `bias` (mm) is the start, off the surface. */
SDV_API float sdv_shadow(const sdv_grid *grid, const sdv_shapes *shapes, lao_v3 p, lao_v3 light,
                         float hardness, float bias);
/* Openness of p along its normal, 0 .. 1, from the field of the tree, combined with shapes (NULL:
   none), at 5 places up to `reach` mm away; `inside` non-zero: of a wall seen from within, the room
   inside counts. */
SDV_API float sdv_openness(const sdv_grid *grid, const sdv_shapes *shapes, lao_v3 p, lao_v3 normal,
                           float reach, uint32_t inside);

/* Normal for shading at a place of the surface of `cone`: where segments meet, their normals go
   over into each other within `smoothness` of the radius, so that a chain of short segments has no
   rings. normal: the surface's own. Thread: any. */
SDV_API lao_v3 sdv_smooth_normal(const sdv_grid *grid, lao_v3 p, uint32_t cone, lao_v3 normal,
                                 float smoothness);

/* What distances are measured to: a ball, a path, a surface. */
typedef struct sdv_target_desc {
    uint32_t point_count;
    const float *points; /* 3 each, mm; without triangles a path through them, or one point */
    uint32_t triangle_count;
    const uint32_t *triangles; /* (Optional) 3 points each */
    float radius;              /* mm, around all of it: a ball is one point with a radius */
} sdv_target_desc;
typedef struct sdv_target sdv_target;

/* Copies the shape into a hierarchy of balls. Fails with NULL_ARGUMENT, MEMORY, TARGET_SHAPE. */
SDV_API lao_result sdv_target_create(const sdv_host *host, const sdv_target_desc *desc,
                                     sdv_target **target);
SDV_API void sdv_target_free(sdv_target *target);
/* Distance of a point to the target, mm; negative inside its radius only. Thread: any. */
SDV_API float sdv_target_point(const sdv_target *target, lao_v3 p);
/* Least signed distance to the round cone of the target's points, less its radius, exact: negative
   where they overlap. A closed surface around a cone does not touch it. Thread: any. */
SDV_API float sdv_target_cone(const sdv_target *target, lao_v4 a, lao_v4 b);
/* Per segment of the tree (`segments`, Optional) and per reduced node (`nodes`, Optional): the
   least over the segments from the node up to its reduced parent; NaN at roots and extra nodes. */
SDV_API lao_result sdv_target_distances(const sdv_host *host, const sdv_target *target,
                                        const sdv_tree *tree, const sdv_reduced *reduced,
                                        float *segments, float *nodes);

/* ------------------------------------------------------------------------------------------------
 * pull-push */

enum { SDV_PULL_MEAN = 0, SDV_PULL_SUM = 1 };     /* weight of a child: 1/4, 1 */
enum { SDV_PUSH_EQUAL = 0, SDV_PUSH_SPLINE = 1 }; /* the 4 nearest parents: 1/4; 9, 3, 3, 1 / 16 */

typedef struct sdv_pull_push_desc {
    uint32_t width, height, channels;
    float *values;     /* channels per pixel; in: where weights > 0, out: everywhere */
    float *weights;    /* 1 per pixel, >= 0 (else 0); out: 1 everywhere */
    uint32_t pull;     /* SDV_PULL_... */
    uint32_t push;     /* SDV_PUSH_... */
    uint32_t exponent; /* k, 1 .. 1023: how little a pixel takes over from its parents; 0: 1 */
} sdv_pull_push_desc;

/* Fills an image from its weighted pixels by a pyramid of ceil-halved levels (L19 3.3 with METHODS
   6). Nothing to fill from: values become 0, weights stay 0, *empty (Optional) is 1. Fails with
   NULL_ARGUMENT, IMAGE_SIZE, MEMORY, CANCELLED (the image is then in between). */
SDV_API lao_result sdv_pull_push(const sdv_host *host, const sdv_pull_push_desc *desc,
                                 uint32_t *empty);

/* X as SDV_SETTINGS, below: of the same on the device. */
#define SDV_PULL_PUSH_SETTINGS(X)                                                                  \
    X(pull, ENUM, 0, 1, 0, 1, "", "mean|sum", "weight of a child: 1/4, 1")                         \
    X(push, ENUM, 0, 1, 0, 1, "", "equal|spline", "the 4 nearest parents: 1/4; 9, 3, 3, 1 / 16")   \
    X(exponent, INT, 1, 1023, 1, 1, "", "", "k: how little a pixel takes over from its parents")
typedef struct sdv_pull_push_settings {
    uint64_t set;
    float pull, push, exponent;
} sdv_pull_push_settings;

/* A module (lao_desc.modules) that fills a host's own image in lao_render, to the same bits as
   sdv_pull_push. Each frame imports "pull_push_image" (RGBA32F; three channels and the weight; as
   large as the view, row 0 at the bottom) and (Optional) "pull_push_result", an image of the host's
   that is written (LAO_HOST_WRITABLE); lao_read knows it as "pull_push_filled" too. Settings: of
   the frame's first set, which need hold nothing else. More channels: more frames. Static. Thread:
   any. */
SDV_API const lao_module *sdv_pull_push_module(void);

/* ------------------------------------------------------------------------------------------------
 * drawing: a module for lao_desc.modules, whose object is a grid */

/* X(name, TYPE, minimum, maximum, default, structural, unit, choices, help), as LAO_SETTINGS. */
#define SDV_SETTINGS(X)                                                                            \
    X(near_miss, ENUM, 0, 2, 0, 1, "", "close|exact|none",                                         \
      "keep how near rays came to other vessels: silhouettes, contours, depth shadows")            \
    X(silhouette, FLOAT, 0, 1000, 1.25f, 0, "px", "", "width of the outline around vessels")       \
    X(contour, FLOAT, 0, 1000, 0.8f, 0, "px", "", "width of outlines in front of other vessels")   \
    X(outline_unit, ENUM, 0, 1, 0, 0, "", "px|mm", "what both widths are in")                      \
    X(shadow_ratio, FLOAT, 0, 10, 0.15f, 0, "", "",                                                \
      "width of a depth shadow per distance behind the edge (m of L19 Fig. 8)")                    \
    X(shadow_width, FLOAT, 0, 100, 1.5f, 0, "%", "",                                               \
      "widest depth shadow, of the scene's diameter (a of L19 Fig. 8)")                            \
    X(shadow_softness, FLOAT, 0, 1, 1, 0, "", "", "how much of a depth shadow fades; 0: none")     \
    X(shadow_strength, FLOAT, 0, 1, 0.6f, 0, "", "", "light that a depth shadow takes away")       \
    X(field_occlusion, BOOL, 0, 1, 1, 1, "", "", "ambient occlusion from the distance field")      \
    X(occlusion_reach, FLOAT, 0.01f, 100, 4, 0, "%", "",                                           \
      "how far field occlusion looks, of the scene's diameter")                                    \
    X(occlusion_strength, FLOAT, 0, 5, 0.75f, 0, "", "", "light that field occlusion takes away")  \
    X(joint_smoothness, FLOAT, 0, 1, 0.35f, 0, "", "",                                             \
      "how far light at a joint goes over from one segment to the next, of the radius; 0: "        \
      "creases")                                                                                   \
    X(surface_ambient, FLOAT, 0, 1, 0.25f, 0, "", "", "ambient part of a surface's illumination")  \
    X(surface_diffuse, FLOAT, 0, 2, 0.7f, 0, "", "", "diffuse part of a surface's illumination")   \
    X(surface_specular, FLOAT, 0, 2, 0.2f, 0, "", "", "specular part of a surface's illumination") \
    X(surface_shininess, INT, 1, 1000, 40, 1, "", "", "Phong exponent of a surface")               \
    X(parameterization, ENUM, 0, 2, 0, 1, "", "off|background|on",                                 \
      "the surface that fills the void; and texture coordinates (u, v) for every pixel")           \
    X(guide, ENUM, 0, 1, 0, 1, "", "contour|own",                                                  \
      "what u follows: the normals of contours, or the surface's own directions: axes of "         \
      "vessels, "                                                                                  \
      "those that came with a mesh")                                                               \
    X(guide_threshold, FLOAT, 0, 1, 0.2f, 0, "", "",                                               \
      "step of depth that is a contour, as part of the scene's diameter (t of L19)")               \
    X(ssp_period, FLOAT, 0.001f, 1000, 4, 0, "mm", "", "period of u and v on the surface")         \
    X(ssp_sweeps, INT, 0, 64, 4, 1, "", "", "optimisations per level of the pyramid (r of L19)")   \
    X(ssp_recycle, INT, -1, 15, -1, 0, "", "",                                                     \
      "coarsest level that a frame renews (l_p of L19); -1: 2^level <= period / 16 pixels")        \
    X(ssp_converge, BOOL, 0, 1, 0, 0, "", "", "optimise on where nothing changes")                 \
    X(style, ENUM, 0, 6, 0, 1, "", "plain|stipple|hatch|crosshatch|layered|shadow|pattern",        \
      "ink instead of shades (shadow: of depth shadows), where the parameterization is on")        \
    X(void_style, ENUM, 0, 3, 0, 1, "", "plain|chromadepth|stipple|hatch",                         \
      "what is drawn behind vessels, where the parameterization is on (chromadepth: or "           \
      "background)")                                                                               \
    X(void_exponent, INT, 1, 1000, 25, 1, "", "",                                                  \
      "how little the void's depth takes over from afar (k of L19)")                               \
    X(void_reach, FLOAT, 0, 1000, 6, 0, "%", "",                                                   \
      "how far from a vessel the void's ink ends, of the scene's diameter; 0: nowhere")            \
    X(isolines, INT, 0, 1000, 30, 0, "", "", "lines of depth of the chromadepth; 0: none")         \
    X(ink_step, FLOAT, 0.001f, 1, 0.1f, 0, "", "",                                                 \
      "how much of what a new solution changes of a place's ink shows in a frame; 1: all at once") \
    X(mark_style, ENUM, 0, 2, 0, 1, "", "stipple|hatch|crosshatch",                                \
      "pattern of marked vessels (colours of alpha below 1/2), where the parameterization is on")  \
    X(mark_darkness, FLOAT, 0, 1, 0.35f, 0, "", "", "how much of a marked surface is ink")         \
    X(mark_halo, FLOAT, 0, 100, 0, 0, "%", "",                                                     \
      "how far the pattern reaches beyond marked vessels, of the scene's diameter")                \
    X(field_shadow, BOOL, 0, 1, 0, 1, "", "",                                                      \
      "soft shadows from the distance field, of a light beside the viewer")                        \
    X(shadow_light_x, FLOAT, -100, 100, -0.7f, 0, "", "",                                          \
      "where that light is: to the right, per length towards the viewer")                          \
    X(shadow_light_y, FLOAT, -100, 100, 0.8f, 0, "", "", "and up")                                 \
    X(field_shadow_softness, FLOAT, 0.001f, 10, 0.08f, 0, "", "",                                  \
      "radius of that light per its distance")                                                     \
    X(field_shadow_strength, FLOAT, 0, 1, 0.55f, 0, "", "",                                        \
      "light that a field shadow takes away")                                                      \
    X(lens_side, ENUM, 0, 2, 0, 0, "", "none|inside|outside",                                      \
      "draw only inside or outside a circle on the picture, a magic lens")                         \
    X(lens_x, FLOAT, -10, 10, 0.5f, 0, "", "",                                                     \
      "its middle from the left, in widths of the picture")                                        \
    X(lens_y, FLOAT, -10, 10, 0.5f, 0, "", "", "from the top, in heights of the picture")          \
    X(lens_radius, FLOAT, 0, 10, 0.25f, 0, "", "", "its radius, in heights of the picture")        \
    X(lens_rim, FLOAT, 0, 100, 2, 0, "px", "", "width of the ring that what is inside draws")

/* What a vessel tree looks like; as lao_settings: zero is the default unless its bit is set. */
typedef struct sdv_settings {
    uint64_t set;
#define SDV__FIELD(name, type, minimum, maximum, standard, structural, unit, choices, help)        \
    float name;
    SDV_SETTINGS(SDV__FIELD)
#undef SDV__FIELD
} sdv_settings;

typedef enum sdv_setting {
#define SDV__ENUM(name, type, minimum, maximum, standard, structural, unit, choices, help)         \
    SDV_SETTING_ID_##name,
    SDV_SETTINGS(SDV__ENUM)
#undef SDV__ENUM
        SDV_SETTING_COUNT
} sdv_setting;
#define SDV_SET(name) ((uint64_t)1 << SDV_SETTING_ID_##name)

/* A camera for a picture that has `margin` more pixels on each side of width x height, in whose
   middle is what `camera` shows: surfaces have their texture coordinates before they come into view
   (L19 6). The host draws the larger picture and shows its middle. Thread: any. */
SDV_API void sdv_camera_margin(const lao_camera *camera, uint32_t width, uint32_t height,
                               uint32_t margin, lao_camera *wider);

/* Passes, images and settings that draw trees among a scene's lines. Static. Thread: any. */
SDV_API const lao_module *sdv_module(void);

/* A tree's field as the object of a set. `desc` refers to the struct itself and to the grid's
   arrays: it must not move, and both must live until lao_object_create or _update returns. */
typedef struct sdv_object {
    lao_object_desc desc;
    lao_object_buffer buffers[8];
    lao_v4 box[2];
    lao_v4 shapes[1 + 4 * SDV_MOST_SHAPES];
    lao_v4 *nearest;     /* private: the shapes, then the cones in a hierarchy, where colours ask */
    uint32_t on_device;  /* sdv_object_make_tree: 1 when the device builds the field */
    sdv_grid grid;       /* of sdv_object_make_tree; on_device: its box and cones, no cells */
    uint32_t image_size; /* private, like what follows */
    float *pattern;
    void *memory;
    lao_allocator allocator;
} sdv_object;

/* A mesh whose faces are drawn with ink: through the same passes, with position, normal and colour
   of its nearest face in place of what a tree's rays hit (L19 3.4). No near misses, no field. */
typedef struct sdv_mesh_desc {
    uint32_t vertex_count, triangle_count;
    const float *positions;    /* 3 per vertex, mm */
    const float *normals;      /* 3 per vertex */
    const uint32_t *triangles; /* 3 per triangle, any winding: both sides are seen */
    const float *directions;   /* (Optional) 3 per vertex, of either sign: what u follows with
                                  guide=own, the surer the longer, up to length 1; 0: nothing there.
                                  vsf_curvatures of vesselsurface.h makes those of curvature */
    const uint8_t *colors;     /* (Optional) RGBA per vertex, display values; NULL: paper white */
} sdv_mesh_desc;

/* Describes a grid for lao_object_create. `colors`: (Optional) 8 bytes a cone: RGBA at its first
   and at its second end, display values; where the alpha between them is below 1/2 the vessel is
   marked (mark_style); NULL: all alike. Free with sdv_object_free. Fails with
   NULL_ARGUMENT, MEMORY. */
SDV_API lao_result sdv_object_make(const sdv_host *host, const sdv_grid *grid,
                                   const uint8_t *colors, sdv_object *object);
/* Combines it with shapes, before it is created or in an update. `colors`: (Optional) red, green,
   blue of the surface of each, display values; red below 0: the colour of the vessel that is
   nearest to the place (L19 Fig. 11), exactly, however far it is: for that cones are put into a
   hierarchy of balls, in O(n log n). `shapes->fields` is referred to. Fails with NULL_ARGUMENT,
   SHAPES, MEMORY. */
SDV_API lao_result sdv_object_shapes(const sdv_host *host, const sdv_shapes *shapes,
                                     const float *colors, sdv_object *object);
/* The same for a tree whose nodes may change every frame: only its cones are uploaded, and rows of
   the module build the field on the device, anew in every frame and to the same bits as
   sdv_grid_build in the same box (its cells are the image "vessel_grid", its ids the first texels
   of "vessel_lists"). `image_size`: lao_limits.image_size. The images are sized by a bound of what
   the lists can hold; where that is more than 2^24 or than the device's images hold, GRID_DEVICE is
   logged and the CPU builds the grid (on_device is 0): the host need not care. `desc` and `colors`
   as in sdv_grid_build and sdv_object_make. Fails like those. */
SDV_API lao_result sdv_object_make_tree(const sdv_host *host, const sdv_tree *tree,
                                        const sdv_grid_desc *desc, uint32_t image_size,
                                        const uint8_t *colors, sdv_object *object);
/* After the host changed tree->nodes[nodes[i]], i < count: `desc` is then what lao_object_update
   takes. The box stays while the tree is inside. Fails like sdv_grid_update, with the object as
   before; or with MEMORY for the nearest vessels of shapes, which are then not to be drawn. */
SDV_API lao_result sdv_object_move(const sdv_host *host, const sdv_tree *tree,
                                   const uint32_t *nodes, uint32_t count, sdv_object *object);
/* Describes a mesh for lao_object_create, with copies of all it needs. Free with sdv_object_free.
   Fails with NULL_ARGUMENT, MESH, MEMORY. */
SDV_API lao_result sdv_object_mesh(const sdv_host *host, const sdv_mesh_desc *desc,
                                   sdv_object *object);
/* Describes a surface that the host has drawn itself. Each frame names images of its own
   (lao_frame.imports; as large as the view times `supersampling`, row 0 at the bottom):
   "vessel_position" (RGBA32F; world, mm; w 0 where there is a surface, -1 elsewhere), or in its
   place "vessel_drawn_depth" (x: a depth buffer's value, 0 .. 1 by lao_frame.camera; nothing where
   it is 0 or 1). (Optional) "vessel_normal" (RGBA32F; world, unit, towards the viewer; w: beside
   the surface mm from the ray to it, for void_reach) and "vessel_color" (RGBA8): else normals come
   from neighbouring places, and it is white. With guide=own "vessel_direction" (RGBA32F; world; w:
   how sure, 0 .. 1). bounds: lower and upper corner (6 floats), mm. Fails with NULL_ARGUMENT. */
SDV_API lao_result sdv_object_drawn(const sdv_host *host, const float *bounds, sdv_object *object);
/* Gives it a texture of ink for the style `pattern`: a picture of size x size grey values (1 ..
   SDV_MOST_PATTERN; smaller: inked first), which lies in half a period of (u, v) and is mirrored
   into the rest. Values are made even, so that any picture shows the right tone. Once for an
   object, after everything else. Fails with NULL_ARGUMENT, IMAGE_SIZE, MEMORY. */
#define SDV_MOST_PATTERN 256u
SDV_API lao_result sdv_object_pattern(const sdv_host *host, const float *values, uint32_t size,
                                      sdv_object *object);
/* Fine on an all-zero one. */
SDV_API void sdv_object_free(sdv_object *object);

#ifdef __cplusplus
}
#endif

/* -------------------------------------------------------------------------------------------------------
   shared text From here to SDV_SHARED_END the text is C99, C++11 and GLSL at once, behind
   lineao.h's (same rules: see there). */
/* SDV_SHARED_BEGIN */
LAO_FN lao_v3 sdv_xyz(lao_v4 v) {
    return lao_v3_make(v.x, v.y, v.z);
}
/* ---- round cones (L19 3.2 with METHODS 4): a, b = centre and radius of the two ends, mm */
/* A point seen from a cone: the balls between a and b reach nearest to it from `place`. */
struct sdv_cone_point {
    float distance; /* signed, mm */
    float place;    /* of the nearest ball, 0 at a, 1 at b */
    lao_v3 away;    /* from that ball's centre to the point */
    float radial;   /* length of away */
    lao_v3 axis;    /* from a to b, not unit */
};
#ifndef LAO_GLSL
typedef struct sdv_cone_point sdv_cone_point;
#endif
/* The three regions of METHODS 4 in one: with x along the axis and y away from it, the centre of
   the nearest ball is at x - y d / l, and stays between the ends. Where one ball holds the other it
   is the nearest. */
LAO_FN sdv_cone_point sdv_cone_point_make(lao_v3 p, lao_v4 a, lao_v4 b) {
    sdv_cone_point c;
    lao_v3 q = lao_v3_sub(p, sdv_xyz(a));
    c.axis = lao_v3_make(b.x - a.x, b.y - a.y, b.z - a.z);
    LAO_EXACT float s = lao_sqrt(lao_v3_dot(c.axis, c.axis));
    LAO_EXACT float d = a.w - b.w;
    LAO_EXACT float least = lao_abs(d) + 1.0e-6f * lao_max(a.w, b.w);
    LAO_EXACT float place = d < 0.0f ? 1.0f : 0.0f;
    if (s > least) {
        LAO_EXACT float inverse = 1.0f / s;
        LAO_EXACT float foot = lao_v3_dot(q, c.axis) * inverse * inverse;
        lao_v3 across = lao_v3_along(q, c.axis, -foot);
        LAO_EXACT float y = lao_sqrt(lao_v3_dot(across, across));
        LAO_EXACT float l = lao_sqrt((s - d) * (s + d));
        LAO_EXACT float back = y * (d * inverse / l);
        place = lao_clamp01(foot - back);
    }
    c.place = place;
    c.away = lao_v3_along(q, c.axis, -place);
    LAO_EXACT float radial = lao_sqrt(lao_v3_dot(c.away, c.away));
    LAO_EXACT float distance = radial - (a.w - place * d);
    c.radial = radial;
    c.distance = distance;
    return c;
}
/* Radius of the ball that is nearest to the point. */
LAO_FN float sdv_cone_ball_radius(sdv_cone_point c, lao_v4 a, lao_v4 b) {
    LAO_EXACT float radius = a.w + c.place * (b.w - a.w);
    return radius;
}
/* Signed distance in mm, exact outside and inside; one ball when it holds the other (Eqs. 1-3,
   corrected). */
LAO_FN float sdv_round_cone(lao_v3 p, lao_v4 a, lao_v4 b) {
    sdv_cone_point c = sdv_cone_point_make(p, a, b);
    return c.distance;
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
    lao_v3 otherwise = sdv_perpendicular(c.axis);
    LAO_EXACT float s = lao_sqrt(lao_v3_dot(c.axis, c.axis));
    LAO_EXACT float d = a.w - b.w;
    if (s > lao_abs(d)) {
        LAO_EXACT float outward = lao_sqrt((s - d) * (s + d)) / s;
        LAO_EXACT float along = d / (s * s);
        otherwise = lao_v3_along(lao_v3_scale(otherwise, outward), c.axis, along);
    }
    return lao_v3_unit(c.away, otherwise);
}
/* Slope of the distance along a unit direction: gradient times direction. */
LAO_FN float sdv_cone_slope(sdv_cone_point c, lao_v3 direction) {
    LAO_EXACT float slope = lao_v3_dot(c.away, direction) / lao_max(c.radial, 1.0e-30f);
    return slope;
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
/* ---- grid and tracing (L19 3.2 with METHODS 5) */
#define SDV_FAR 1.0e30f
#define SDV_MAX_STEPS 1024
/* A box of cubic cells: lower corner, edge of a cell in mm, cells along each axis. */
struct sdv_box {
    lao_v3 origin;
    float cell;
    lao_v3 size;
};
#ifndef LAO_GLSL
typedef struct sdv_box sdv_box;
#endif
LAO_FN lao_v3 sdv_cell_centre(sdv_box box, lao_uint x, lao_uint y, lao_uint z) {
    LAO_EXACT float cx = box.origin.x + (LAO_F(x) + 0.5f) * box.cell;
    LAO_EXACT float cy = box.origin.y + (LAO_F(y) + 0.5f) * box.cell;
    LAO_EXACT float cz = box.origin.z + (LAO_F(z) + 0.5f) * box.cell;
    return lao_v3_make(cx, cy, cz);
}
/* Index of the cell that holds p, or of the one nearest to it. */
LAO_FN lao_int sdv_cell_at(sdv_box box, lao_v3 p) {
    LAO_EXACT float x = lao_floor((p.x - box.origin.x) / box.cell);
    LAO_EXACT float y = lao_floor((p.y - box.origin.y) / box.cell);
    LAO_EXACT float z = lao_floor((p.z - box.origin.z) / box.cell);
    lao_int ix = LAO_I(lao_min(lao_max(0.0f, x), box.size.x - 1.0f));
    lao_int iy = LAO_I(lao_min(lao_max(0.0f, y), box.size.y - 1.0f));
    lao_int iz = LAO_I(lao_min(lao_max(0.0f, z), box.size.z - 1.0f));
    return ix + LAO_I(box.size.x) * (iy + LAO_I(box.size.y) * iz);
}
/* What a cell lists: cones up to this distance from its centre, mm. */
LAO_FN float sdv_list_reach(float cell) {
    return 2.0f * cell;
}
/* The device builds the lists of cells from those of blocks, at most SDV_BLOCKS along an axis,
   those from lists of regions, SDV_REGION blocks along an axis, and those from chunks of SDV_CHUNK
   cones. The list of a block is made in SDV_BLOCK_PARTS parts. A grid has at most SDV_AXIS cells
   along an axis. */
#define SDV_BLOCKS 32
#define SDV_REGION 6
#define SDV_CHUNK 32
#define SDV_BLOCK_PARTS 8
#define SDV_AXIS 512
/* The middle of the cells from `low` to `last`, and (w) how far a cone that one of them lists may
   be from there. Distances are 1-Lipschitz; the margin is for rounding. */
LAO_FN lao_v4 sdv_block_reach(sdv_box box, lao_v3 low, lao_v3 last) {
    lao_v3 middle = lao_v3_scale(lao_v3_add(low, last), 0.5f);
    lao_v3 apart = lao_v3_sub(last, middle);
    LAO_EXACT float x = box.origin.x + (middle.x + 0.5f) * box.cell;
    LAO_EXACT float y = box.origin.y + (middle.y + 0.5f) * box.cell;
    LAO_EXACT float z = box.origin.z + (middle.z + 0.5f) * box.cell;
    LAO_EXACT float most = lao_abs(box.origin.x) + lao_abs(box.origin.y) + lao_abs(box.origin.z) +
                           (box.size.x + box.size.y + box.size.z) * box.cell;
    LAO_EXACT float reach = sdv_list_reach(box.cell) +
                            lao_sqrt(lao_v3_dot(apart, apart)) * box.cell + 0.02f * box.cell +
                            1.0e-5f * most;
    return lao_v4_make(x, y, z, reach);
}
/* From anywhere in a cell, what is nearer than this is in its list: 2 - sqrt(3) / 2, less rounding.
 */
LAO_FN float sdv_near_reach(float cell) {
    return 1.125f * cell;
}
/* How far a ray may go from anywhere in an empty cell whose centre is `apart` mm from the nearest
   centre of an occupied cell. The surface is 2 - sqrt(3) / 2 cells or more behind the last empty
   cell on the way to it: apart + 2 - sqrt(3) from the centre, another sqrt(3) / 2 less from p. */
LAO_FN float sdv_far_step(float apart, float cell) {
    LAO_EXACT float step = apart - 0.6f * cell;
    return lao_max(step, sdv_near_reach(cell));
}
/* Part of the ray inside the box: from x to y, x > y where it misses. */
LAO_FN float sdv_ray_slope(float d) {
    LAO_EXACT float r = 1.0f / (lao_abs(d) < 1.0e-12f ? (d < 0.0f ? -1.0e-12f : 1.0e-12f) : d);
    return r;
}
LAO_FN lao_v2 sdv_ray_box(lao_v3 origin, lao_v3 direction, sdv_box box) {
    lao_v3 slope = lao_v3_make(sdv_ray_slope(direction.x), sdv_ray_slope(direction.y),
                               sdv_ray_slope(direction.z));
    LAO_EXACT float x0 = (box.origin.x - origin.x) * slope.x;
    LAO_EXACT float y0 = (box.origin.y - origin.y) * slope.y;
    LAO_EXACT float z0 = (box.origin.z - origin.z) * slope.z;
    LAO_EXACT float x1 = (box.origin.x + box.size.x * box.cell - origin.x) * slope.x;
    LAO_EXACT float y1 = (box.origin.y + box.size.y * box.cell - origin.y) * slope.y;
    LAO_EXACT float z1 = (box.origin.z + box.size.z * box.cell - origin.z) * slope.z;
    LAO_EXACT float from =
        lao_max(lao_max(lao_min(x0, x1), lao_min(y0, y1)), lao_max(lao_min(z0, z1), 0.0f));
    LAO_EXACT float to = lao_min(lao_min(lao_max(x0, x1), lao_max(y0, y1)), lao_max(z0, z1));
    return lao_v2_make(from, to);
}

/* Distance of p to the box, 0 inside. */
LAO_FN float sdv_box_distance(lao_v3 p, sdv_box box) {
    LAO_EXACT float x = lao_max(box.origin.x - p.x, p.x - box.origin.x - box.size.x * box.cell);
    LAO_EXACT float y = lao_max(box.origin.y - p.y, p.y - box.origin.y - box.size.y * box.cell);
    LAO_EXACT float z = lao_max(box.origin.z - p.z, p.z - box.origin.z - box.size.z * box.cell);
    lao_v3 apart = lao_v3_make(lao_max(x, 0.0f), lao_max(y, 0.0f), lao_max(z, 0.0f));
    LAO_EXACT float r = lao_sqrt(lao_v3_dot(apart, apart));
    return r;
}

/* The nearest of the cones of a list at a point of a ray, and how far the ray may go before it can
   meet any of them. */
struct sdv_near {
    float distance, advance, cone;
};
#ifndef LAO_GLSL
typedef struct sdv_near sdv_near;
#endif
LAO_FN sdv_near sdv_near_start(float reach) {
    sdv_near n;
    n.distance = SDV_FAR;
    n.advance = reach;
    n.cone = -1.0f;
    return n;
}
/* Distance of p to the cone (x), and where the tangent of the distance along the ray falls to 0
   (y): a cone is convex, so its distance along a ray is too, and the ray cannot meet it sooner. */
LAO_FN lao_v2 sdv_cone_along(lao_v3 p, lao_v3 direction, lao_v4 a, lao_v4 b) {
    sdv_cone_point c = sdv_cone_point_make(p, a, b);
    LAO_EXACT float step = c.distance / lao_max(-sdv_cone_slope(c, direction), 1.0e-6f);
    return lao_v2_make(c.distance, step);
}
LAO_FN sdv_near sdv_near_add(sdv_near n, lao_v3 p, lao_v3 direction, lao_v4 a, lao_v4 b,
                             float cone) {
    sdv_near r = n;
    lao_v2 along = sdv_cone_along(p, direction, a, b);
    if (along.x < n.distance) {
        r.distance = along.x;
        r.cone = cone;
    }
    r.advance = lao_min(n.advance, along.y);
    return r;
}
/* Least distance of the whole line to the cone (x, mm; negative: it passes through it) and where
   (y): seen along the line, the cone is a flat round cone and the line a point. */
LAO_FN lao_v2 sdv_line_nearest(lao_v3 origin, lao_v3 direction, lao_v4 a, lao_v4 b) {
    lao_v3 qa = lao_v3_sub(sdv_xyz(a), origin);
    lao_v3 qb = lao_v3_sub(sdv_xyz(b), origin);
    LAO_EXACT float ta = lao_v3_dot(qa, direction);
    LAO_EXACT float tb = lao_v3_dot(qb, direction);
    lao_v3 fa = lao_v3_along(qa, direction, -ta);
    lao_v3 fb = lao_v3_along(qb, direction, -tb);
    lao_v4 pa = lao_v4_make(fa.x, fa.y, fa.z, a.w);
    lao_v4 pb = lao_v4_make(fb.x, fb.y, fb.z, b.w);
    lao_v3 zero = lao_v3_make(0.0f, 0.0f, 0.0f);
    sdv_cone_point c = sdv_cone_point_make(zero, pa, pb);
    LAO_EXACT float t = ta + (tb - ta) * c.place;
    return lao_v2_make(c.distance, t);
}

/* A ray under way. */
struct sdv_march {
    float t, end;         /* mm */
    float before, older;  /* t of the last two samples */
    float distance, cone; /* of the last sample */
    float falling;        /* 1: the distance fell up to the last sample */
    float d_min, t_min;   /* the least local minimum that was passed */
    float low, low_cone; /* over all samples: the ray's least distance to the nearest cone, and that
                            cone */
    float inside;        /* 1: it started inside a vessel */
    float steps;         /* samples so far */
    float state;         /* SDV_MARCH_... */
};
#ifndef LAO_GLSL
typedef struct sdv_march sdv_march;
#endif
#define SDV_MARCH_GOES 0.0f
#define SDV_MARCH_HITS 1.0f
#define SDV_MARCH_LEAVES 2.0f
LAO_FN sdv_march sdv_march_start(lao_v2 span) {
    sdv_march m;
    m.t = span.x;
    m.end = span.y;
    m.before = 0.0f;
    m.older = 0.0f;
    m.distance = SDV_FAR;
    m.cone = -1.0f;
    m.falling = 1.0f;
    m.d_min = SDV_FAR;
    m.t_min = 0.0f;
    m.low = SDV_FAR;
    m.low_cone = -1.0f;
    m.inside = 0.0f;
    m.steps = 0.0f;
    m.state = span.x <= span.y ? SDV_MARCH_GOES : SDV_MARCH_LEAVES;
    return m;
}
/* Distance below which a point is on the surface. */
LAO_FN float sdv_hit_distance(float cell) {
    return 1.0e-3f * cell;
}
/* A local minimum between two points of the ray, by going to where the ray is nearest to the cone
   that was nearest so far, a few times. */
struct sdv_minimum {
    float d, t;       /* the least distance so far and where */
    float cone, last; /* to be looked at, -1: none; the one before */
};
#ifndef LAO_GLSL
typedef struct sdv_minimum sdv_minimum;
#endif
#define SDV_MINIMUM_ROUNDS 3
LAO_FN sdv_minimum sdv_minimum_start(float cone) {
    sdv_minimum r;
    r.d = SDV_FAR;
    r.t = 0.0f;
    r.cone = cone;
    r.last = -1.0f;
    return r;
}
/* a, b: the ends of r.cone; the minimum is in [low, high]. */
LAO_FN sdv_minimum sdv_minimum_add(sdv_minimum r, lao_v3 origin, lao_v3 direction, lao_v4 a,
                                   lao_v4 b, float low, float high) {
    sdv_minimum n = r;
    lao_v2 nearest = sdv_line_nearest(origin, direction, a, b);
    LAO_EXACT float t = lao_min(lao_max(nearest.y, low), high);
    LAO_EXACT float d = sdv_round_cone(lao_v3_along(origin, direction, t), a, b);
    n.last = r.cone;
    if (d < r.d) {
        n.d = d;
        n.t = t;
    }
    return n;
}
/* The sample at r.t decides whether there is a better cone. */
LAO_FN sdv_minimum sdv_minimum_next(sdv_minimum r, sdv_near n) {
    sdv_minimum next = r;
    next.cone = n.distance < r.d && n.cone != r.last ? n.cone : -1.0f;
    return next;
}
LAO_FN sdv_march sdv_march_minimum(sdv_march m, sdv_minimum found) {
    sdv_march r = m;
    if (found.d < m.d_min) {
        r.d_min = found.d;
        r.t_min = found.t;
    }
    return r;
}
/* Keeps the cone that the whole ray, t >= 0, comes nearest to; `found`: one round from a sample's.
 */
LAO_FN sdv_march sdv_march_note(sdv_march m, sdv_minimum found) {
    sdv_march r = m;
    if (found.d < m.low) {
        r.low = found.d;
        r.low_cone = found.last;
    }
    return r;
}
/* The least distance of a ray that hits nothing is looked for between x and y: elsewhere it is more
   than `low` away from the ball around the box. Where it is nearest to the ball's middle: z. */
LAO_FN lao_v3 sdv_least_span(lao_v3 origin, lao_v3 direction, sdv_box box, float low) {
    lao_v3 middle = lao_v3_along(box.origin, box.size, 0.5f * box.cell);
    LAO_EXACT float reach = 0.5f * box.cell * lao_sqrt(lao_v3_dot(box.size, box.size)) + low;
    LAO_EXACT float t = lao_v3_dot(lao_v3_sub(middle, origin), direction);
    return lao_v3_make(lao_max(0.0f, t - reach), t + reach, lao_max(0.0f, t));
}
/* From one sample to the next: nothing in between is much nearer than `low`. */
#define SDV_LEAST_SAMPLES 128
LAO_FN float sdv_least_step(sdv_near n, bool occupied, float far_step, float low, float cell) {
    LAO_EXACT float clear = occupied ? lao_min(n.distance, sdv_near_reach(cell)) : far_step;
    LAO_EXACT float step = clear - 0.9f * low;
    return lao_max(lao_max(step, 0.2f * low), 0.25f * cell);
}
/* The sample before this one was a local minimum of the distance. */
LAO_FN bool sdv_march_passed(sdv_march m, sdv_near n) {
    return m.falling > 0.5f && m.inside < 0.5f && n.distance > m.distance;
}
/* Goes on from a sample at m.t: `n` comes from the list of the cell there when it is `occupied`,
   else of the nearest cell that has one (for its distance; or SDV_FAR when nobody wants d_min), and
   `far_step` is the cell's. */
LAO_FN sdv_march sdv_march_step(sdv_march m, sdv_near n, bool occupied, float far_step,
                                float cell) {
    sdv_march r = m;
    r.falling = n.distance > m.distance ? 0.0f : 1.0f;
    r.distance = n.distance;
    r.cone = n.cone;
    r.steps = m.steps + 1.0f;
    LAO_EXACT float step = occupied ? n.advance : far_step;
    if (occupied) {
        if (m.steps < 0.5f && n.distance < 0.0f) {
            r.inside = 1.0f;
        }
        LAO_EXACT float left = r.inside > 0.5f ? -n.distance : n.distance;
        if (left < sdv_hit_distance(cell)) {
            r.state = SDV_MARCH_HITS;
            return r;
        }
        step = r.inside > 0.5f ? left : step; /* the ball inside the nearest cone */
    }
    r.older = m.before;
    r.before = m.t;
    r.t = m.t + step;
    if (!(r.t <= m.end)) {
        r.state = SDV_MARCH_LEAVES;
    }
    return r;
}
/* May something as near as `reach` be seen from an empty cell? 0: everything matters. */
LAO_FN bool sdv_is_within(float far_step, float reach) {
    return !(reach > 0.0f) || far_step < reach;
}
/* Where rays look for near misses: the box, which has 2 cells around the tree, with a rim where
   that is less than `reach`. What lies in the box is no farther from a place outside than from that
   place's nearest one inside, so cells serve out there as well. */
LAO_FN sdv_box sdv_box_grown(sdv_box box, float reach) {
    sdv_box r = box;
    LAO_EXACT float by = lao_max(reach - 2.0f * box.cell, 0.0f);
    LAO_EXACT float cells = 2.0f * by / box.cell;
    r.origin = lao_v3_make(box.origin.x - by, box.origin.y - by, box.origin.z - by);
    r.size = lao_v3_make(box.size.x + cells, box.size.y + cells, box.size.z + cells);
    return r;
}
#define SDV_POLISH_ROUNDS 2
/* Newton's step from a point close to the surface onto it: where the field's tangent is 0. Of a ray
   that grazes it may lead away; then the place before is kept. */
LAO_FN float sdv_polish(float t, float distance, lao_v3 gradient, lao_v3 direction, float cell) {
    LAO_EXACT float slope = lao_v3_dot(gradient, direction);
    LAO_EXACT float steep = lao_max(lao_abs(slope), 0.02f);
    LAO_EXACT float step = distance / (slope < 0.0f ? steep : -steep);
    LAO_EXACT float most = 0.1f * cell;
    LAO_EXACT float r = t + lao_min(lao_max(step, -most), most);
    return r;
}
/* ---- shapes and Boolean operations */
/* kind: SDV_SHAPE_...; ball: a = centre, radius; box: a = centre, b = half its size; plane: a =
   unit normal, offset, inside where normal . p < offset; field: a = place of the first sample,
   distance of neighbours; b = samples along each axis, 2 or more, and where the first one is;
   ellipsoid: a = centre, b = half axes. */
struct sdv_shape {
    lao_v4 a, b;
    lao_int kind, operation;
};
#ifndef LAO_GLSL
typedef struct sdv_shape sdv_shape;
#endif
#ifdef LAO_GLSL
#define SDV_UNION 0
#define SDV_INTERSECTION 1
#define SDV_SUBTRACTION 2
#define SDV_SHAPE_BALL 0
#define SDV_SHAPE_BOX 1
#define SDV_SHAPE_PLANE 2
#define SDV_SHAPE_FIELD 3
#define SDV_SHAPE_TREE 4
#define SDV_SHAPE_ELLIPSOID 5
#endif
LAO_FN lao_v3 sdv_box_apart(lao_v3 p, lao_v4 centre, lao_v4 half_size) {
    LAO_EXACT float x = lao_abs(p.x - centre.x) - half_size.x;
    LAO_EXACT float y = lao_abs(p.y - centre.y) - half_size.y;
    LAO_EXACT float z = lao_abs(p.z - centre.z) - half_size.z;
    return lao_v3_make(x, y, z);
}
/* A place among the samples of a field: its lowest neighbour, the place between that and the next
   along each axis, 0 .. 1, and how far outside all samples it is, mm. */
struct sdv_lattice {
    lao_v3 part;
    lao_int at, row, layer; /* first sample; what leads to the next along y and z */
    float apart;
};
#ifndef LAO_GLSL
typedef struct sdv_lattice sdv_lattice;
#endif
LAO_FN lao_v2 sdv_lattice_axis(float p, float low, float cell, float count) {
    LAO_EXACT float at = lao_min(lao_max((p - low) / cell, 0.0f), count - 1.0f);
    LAO_EXACT float whole = lao_min(lao_floor(at), count - 2.0f);
    LAO_EXACT float part = at - whole;
    return lao_v2_make(whole, part);
}
LAO_FN sdv_lattice sdv_lattice_at(lao_v3 p, sdv_shape shape) {
    lao_v2 x = sdv_lattice_axis(p.x, shape.a.x, shape.a.w, shape.b.x);
    lao_v2 y = sdv_lattice_axis(p.y, shape.a.y, shape.a.w, shape.b.y);
    lao_v2 z = sdv_lattice_axis(p.z, shape.a.z, shape.a.w, shape.b.z);
    sdv_lattice r;
    r.part = lao_v3_make(x.y, y.y, z.y);
    r.row = LAO_I(shape.b.x);
    r.layer = r.row * LAO_I(shape.b.y);
    r.at = LAO_I(shape.b.w) + LAO_I(x.x) + r.row * LAO_I(y.x) + r.layer * LAO_I(z.x);
    LAO_EXACT float ex = shape.a.x + (shape.b.x - 1.0f) * shape.a.w;
    LAO_EXACT float ey = shape.a.y + (shape.b.y - 1.0f) * shape.a.w;
    LAO_EXACT float ez = shape.a.z + (shape.b.z - 1.0f) * shape.a.w;
    LAO_EXACT float ox = lao_max(lao_max(shape.a.x - p.x, p.x - ex), 0.0f);
    LAO_EXACT float oy = lao_max(lao_max(shape.a.y - p.y, p.y - ey), 0.0f);
    LAO_EXACT float oz = lao_max(lao_max(shape.a.z - p.z, p.z - ez), 0.0f);
    LAO_EXACT float apart = lao_sqrt(lao_v3_dot(lao_v3_make(ox, oy, oz), lao_v3_make(ox, oy, oz)));
    r.apart = apart;
    return r;
}
/* Trilinear value (w) and its gradient (x, y, z) from the eight samples around: low z, then high;
   of each (0, 0), (1, 0), (0, 1), (1, 1). */
LAO_FN lao_v4 sdv_lattice_value(lao_v3 part, lao_v4 low, lao_v4 high) {
    LAO_EXACT float x0 = low.x + (low.y - low.x) * part.x;
    LAO_EXACT float x1 = low.z + (low.w - low.z) * part.x;
    LAO_EXACT float x2 = high.x + (high.y - high.x) * part.x;
    LAO_EXACT float x3 = high.z + (high.w - high.z) * part.x;
    LAO_EXACT float y0 = x0 + (x1 - x0) * part.y;
    LAO_EXACT float y1 = x2 + (x3 - x2) * part.y;
    LAO_EXACT float value = y0 + (y1 - y0) * part.z;
    LAO_EXACT float gz = y1 - y0;
    LAO_EXACT float gy = (x1 - x0) + ((x3 - x2) - (x1 - x0)) * part.z;
    LAO_EXACT float d0 = (low.y - low.x) + ((low.w - low.z) - (low.y - low.x)) * part.y;
    LAO_EXACT float d1 = (high.y - high.x) + ((high.w - high.z) - (high.y - high.x)) * part.y;
    LAO_EXACT float gx = d0 + (d1 - d0) * part.z;
    return lao_v4_make(gx, gy, gz, value);
}
/* ---- forms: what the cone of a tree with such attributes is instead of round and smooth. Its
   surface stays inside the round cone a, b. */
/* a, b: section at that end: unit vector of the shorter axis, and what the ratio's inverse has over
   1; bump: amplitude at a and b, mm; the most that sdv_form_level may rise per mm; bumps per mm. */
struct sdv_form {
    lao_v4 a, b, bump;
};
#ifndef LAO_GLSL
typedef struct sdv_form sdv_form;
#endif
/* Of a corner of the lattice, in [-1, 1). */
LAO_FN float sdv_noise_corner(lao_uint x, lao_uint y, lao_uint z) {
    LAO_EXACT float r = 2.0f * lao_unit_float(lao_hash(x + lao_hash(y + lao_hash(z)))) - 1.0f;
    return r;
}
LAO_FN lao_v4 sdv_noise_four(lao_uint x, lao_uint y, lao_uint z) {
    return lao_v4_make(sdv_noise_corner(x, y, z), sdv_noise_corner(x + 1u, y, z),
                       sdv_noise_corner(x, y + 1u, z), sdv_noise_corner(x + 1u, y + 1u, z));
}
/* Between two corners (x, to the fifth power: no creases) and its slope (y). */
LAO_FN lao_v2 sdv_noise_fade(float f) {
    LAO_EXACT float fade = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
    LAO_EXACT float slope = 30.0f * f * f * (f * (f - 2.0f) + 1.0f);
    return lao_v2_make(fade, slope);
}
/* Gradient (xyz) and value (w, in [-1, 1]) of value noise on the lattice of whole numbers. The
   gradient is no longer than SDV_NOISE_SLOPE: 2 (corners) times 15/8 (fade). */
#define SDV_NOISE_SLOPE 3.76f
LAO_FN lao_v4 sdv_noise(lao_v3 p) {
    lao_v3 low = lao_v3_make(lao_floor(lao_min(lao_max(p.x, -1.0e9f), 1.0e9f)),
                             lao_floor(lao_min(lao_max(p.y, -1.0e9f), 1.0e9f)),
                             lao_floor(lao_min(lao_max(p.z, -1.0e9f), 1.0e9f)));
    lao_uint x = LAO_U(LAO_I(low.x));
    lao_uint y = LAO_U(LAO_I(low.y));
    lao_uint z = LAO_U(LAO_I(low.z));
    lao_v3 part = lao_v3_sub(p, low);
    lao_v2 u = sdv_noise_fade(lao_clamp01(part.x));
    lao_v2 v = sdv_noise_fade(lao_clamp01(part.y));
    lao_v2 w = sdv_noise_fade(lao_clamp01(part.z));
    lao_v4 n = sdv_lattice_value(lao_v3_make(u.x, v.x, w.x), sdv_noise_four(x, y, z),
                                 sdv_noise_four(x, y, z + 1u));
    LAO_EXACT float gx = n.x * u.y;
    LAO_EXACT float gy = n.y * v.y;
    LAO_EXACT float gz = n.z * w.y;
    return lao_v4_make(gx, gy, gz, n.w);
}
/* The lower of the ratios at both ends. */
LAO_FN float sdv_form_ratio(sdv_form form) {
    LAO_EXACT float ratio = 1.0f / (1.0f + lao_max(form.a.w, form.b.w));
    return ratio;
}
/* Where v, from a, is along the axis of a cone: 0 at a, 1 at b, not cut off. */
LAO_FN float sdv_form_foot(lao_v3 v, lao_v3 axis) {
    LAO_EXACT float foot = lao_v3_dot(v, axis) / lao_max(lao_v3_dot(axis, axis), 1.0e-30f);
    return foot;
}
/* By how much u . v grows where space is stretched by a section. */
LAO_FN float sdv_section_stretch(lao_v4 section, lao_v3 u, lao_v3 v) {
    lao_v3 m = sdv_xyz(section);
    LAO_EXACT float by = section.w * lao_v3_dot(m, u) * lao_v3_dot(m, v);
    return by;
}
LAO_FN lao_v3 sdv_section_add(lao_v3 to, lao_v3 v, lao_v4 section, float part) {
    lao_v3 m = sdv_xyz(section);
    LAO_EXACT float by = part * section.w * lao_v3_dot(v, m);
    return lao_v3_along(to, m, by);
}
/* Space stretched along the shorter axes, as it is at `foot`: there the ellipsoid of the section is
   a ball. */
LAO_FN lao_v3 sdv_form_stretched(lao_v3 v, sdv_form form, float foot) {
    LAO_EXACT float t = lao_clamp01(foot);
    return sdv_section_add(sdv_section_add(v, v, form.a, 1.0f - t), v, form.b, t);
}
/* The other end of the cone whose space is stretched around a. */
LAO_FN lao_v4 sdv_form_end(lao_v4 a, lao_v3 axis, float radius, sdv_form form, float foot) {
    lao_v3 end = lao_v3_add(sdv_xyz(a), sdv_form_stretched(axis, form, foot));
    return lao_v4_make(end.x, end.y, end.z, radius);
}
/* Below 0 inside the cone's form, 0 on its surface (w), and the gradient (xyz): the distance in
   stretched space and the noise, inwards from the round cone. */
LAO_FN lao_v4 sdv_form_level(lao_v3 p, lao_v4 a, lao_v4 b, sdv_form form) {
    lao_v3 axis = lao_v3_sub(sdv_xyz(b), sdv_xyz(a));
    lao_v3 v = lao_v3_sub(p, sdv_xyz(a));
    float foot = sdv_form_foot(v, axis);
    lao_v4 end = sdv_form_end(a, axis, b.w, form, foot);
    lao_v3 q = lao_v3_add(sdv_xyz(a), sdv_form_stretched(v, form, foot));
    sdv_cone_point c = sdv_cone_point_make(q, a, end);
    lao_v3 g = sdv_round_cone_gradient(q, a, end);
    LAO_EXACT float more = form.bump.y - form.bump.x;
    LAO_EXACT float amplitude = form.bump.x + lao_clamp01(foot) * more;
    lao_v4 noise = lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    if (amplitude > 0.0f) {
        noise = sdv_noise(lao_v3_scale(p, form.bump.w));
    }
    LAO_EXACT float lift = 1.0f + noise.w;
    LAO_EXACT float level = c.distance + amplitude * lift;
    LAO_EXACT float steep = amplitude * form.bump.w;
    lao_v3 slope = lao_v3_along(sdv_form_stretched(g, form, foot), sdv_xyz(noise), steep);
    if (foot > 0.0f && foot < 1.0f) { /* section and amplitude change along the cone */
        lao_v3 u = lao_v3_along(v, axis, -c.place);
        LAO_EXACT float change =
            sdv_section_stretch(form.b, u, g) - sdv_section_stretch(form.a, u, g) + more * lift;
        slope = lao_v3_along(slope, axis, change / lao_v3_dot(axis, axis));
    }
    return lao_v4_make(slope.x, slope.y, slope.z, level);
}
/* Outward normal (xyz), and the distance as far as level and gradient tell it (w). */
LAO_FN lao_v4 sdv_form_estimate(lao_v3 p, lao_v4 a, lao_v4 b, sdv_form form) {
    lao_v4 level = sdv_form_level(p, a, b, form);
    lao_v3 g = sdv_xyz(level);
    LAO_EXACT float steep = lao_sqrt(lao_v3_dot(g, g));
    LAO_EXACT float distance = level.w / lao_max(steep, 0.1f);
    g = lao_v3_unit(g, lao_v3_make(0.0f, 0.0f, 1.0f));
    return lao_v4_make(g.x, g.y, g.z, distance);
}
/* Where the level is less than this it rises by no more than form.bump.z per mm. */
LAO_FN float sdv_form_most(lao_v4 a, lao_v4 b, sdv_form form) {
    LAO_EXACT float most = 0.25f * lao_max(a.w, b.w) * (1.0f + lao_max(form.a.w, form.b.w));
    return most;
}
/* A bound of the distance that is 0 where that is, and 1-Lipschitz; round: sdv_round_cone. */
LAO_FN float sdv_form_bound(float round, lao_v4 level, lao_v4 a, lao_v4 b, sdv_form form) {
    LAO_EXACT float bound = lao_min(level.w, sdv_form_most(a, b, form)) / form.bump.z;
    return lao_max(round, bound);
}
/* Does the form of a cone matter to a sample? along: sdv_cone_along. The ray meets the round cone
   first. */
LAO_FN bool sdv_near_asks(sdv_near n, lao_v2 along) {
    return along.x < n.distance || along.y < n.advance;
}
/* sdv_near_add for a form that matters. */
LAO_FN sdv_near sdv_near_form(sdv_near n, lao_v2 along, lao_v3 p, lao_v4 a, lao_v4 b, sdv_form form,
                              float cone) {
    sdv_near r = n;
    float d = sdv_form_bound(along.x, sdv_form_level(p, a, b, form), a, b, form);
    if (d < n.distance) {
        r.distance = d;
        r.cone = cone;
    }
    r.advance = lao_min(n.advance, lao_max(along.y, d));
    return r;
}
/* sdv_minimum_add for a form: where the ray is nearest to the cone without bumps, with the section
   of where it is nearest to the round one. */
LAO_FN sdv_minimum sdv_minimum_form(sdv_minimum r, lao_v3 origin, lao_v3 direction, lao_v4 a,
                                    lao_v4 b, sdv_form form, float low, float high) {
    sdv_minimum n = r;
    lao_v3 from = sdv_xyz(a);
    lao_v3 axis = lao_v3_sub(sdv_xyz(b), from);
    lao_v2 round = sdv_line_nearest(origin, direction, a, b);
    float foot = sdv_form_foot(lao_v3_sub(lao_v3_along(origin, direction, round.y), from), axis);
    lao_v3 o = lao_v3_add(from, sdv_form_stretched(lao_v3_sub(origin, from), form, foot));
    lao_v3 d = sdv_form_stretched(direction, form, foot);
    LAO_EXACT float shorter = 1.0f / lao_sqrt(lao_v3_dot(d, d));
    lao_v4 end = sdv_form_end(a, axis, b.w, form, foot);
    LAO_EXACT float place = sdv_line_nearest(o, lao_v3_scale(d, shorter), a, end).y * shorter;
    LAO_EXACT float t = lao_min(lao_max(place, low), high);
    float distance = sdv_form_estimate(lao_v3_along(origin, direction, t), a, b, form).w;
    n.last = r.cone;
    if (distance < r.d) {
        n.d = distance;
        n.t = t;
    }
    return n;
}
/* A lower bound of the distance to where the trilinear value is 0: no slope of it is above sqrt(3);
   outside, the shape is no nearer than the nearest place inside is to it. */
LAO_FN float sdv_lattice_distance(sdv_lattice at, float value) {
    LAO_EXACT float d = 0.57f * value;
    return lao_max(d, at.apart > 0.0f ? at.apart : d);
}
/* What is nearer to the distance than that bound, and no bound. */
LAO_FN float sdv_lattice_estimate(sdv_lattice at, float value) {
    return lao_max(value, at.apart > 0.0f ? at.apart : value);
}
/* p from the middle of an ellipsoid, as if it were the unit ball. */
LAO_FN lao_v3 sdv_ellipsoid_place(lao_v3 p, sdv_shape shape) {
    LAO_EXACT float x = (p.x - shape.a.x) / shape.b.x;
    LAO_EXACT float y = (p.y - shape.a.y) / shape.b.y;
    LAO_EXACT float z = (p.z - shape.a.z) / shape.b.z;
    return lao_v3_make(x, y, z);
}
/* Across its surface, as long as the place there changes per mm. */
LAO_FN lao_v3 sdv_ellipsoid_slope(lao_v3 place, sdv_shape shape) {
    LAO_EXACT float x = place.x / shape.b.x;
    LAO_EXACT float y = place.y / shape.b.y;
    LAO_EXACT float z = place.z / shape.b.z;
    return lao_v3_make(x, y, z);
}
/* Of an ellipsoid a lower bound: no distance changes faster along the shortest half axis. */
LAO_FN float sdv_shape_distance(lao_v3 p, sdv_shape shape) {
    if (shape.kind == SDV_SHAPE_ELLIPSOID) {
        lao_v3 e = sdv_ellipsoid_place(p, shape);
        LAO_EXACT float d =
            (lao_sqrt(lao_v3_dot(e, e)) - 1.0f) * lao_min(shape.b.x, lao_min(shape.b.y, shape.b.z));
        return d;
    }
    if (shape.kind == SDV_SHAPE_PLANE) {
        LAO_EXACT float d = lao_v3_dot(p, sdv_xyz(shape.a)) - shape.a.w;
        return d;
    }
    if (shape.kind == SDV_SHAPE_BOX) {
        lao_v3 q = sdv_box_apart(p, shape.a, shape.b);
        lao_v3 o = lao_v3_make(lao_max(q.x, 0.0f), lao_max(q.y, 0.0f), lao_max(q.z, 0.0f));
        LAO_EXACT float d =
            lao_sqrt(lao_v3_dot(o, o)) + lao_min(lao_max(q.x, lao_max(q.y, q.z)), 0.0f);
        return d;
    }
    lao_v3 q = lao_v3_sub(p, sdv_xyz(shape.a));
    LAO_EXACT float d = lao_sqrt(lao_v3_dot(q, q)) - shape.a.w;
    return d;
}
/* For outlines, occlusion and shadows: as near to the distance as can be had, but no bound. */
LAO_FN float sdv_shape_estimate(lao_v3 p, sdv_shape shape) {
    if (shape.kind == SDV_SHAPE_ELLIPSOID) {
        lao_v3 e = sdv_ellipsoid_place(p, shape);
        lao_v3 slope = sdv_ellipsoid_slope(e, shape);
        LAO_EXACT float radial = lao_sqrt(lao_v3_dot(e, e));
        LAO_EXACT float steep = lao_max(lao_sqrt(lao_v3_dot(slope, slope)), 1.0e-30f);
        LAO_EXACT float d = radial * (radial - 1.0f) / steep;
        return d;
    }
    return sdv_shape_distance(p, shape);
}
LAO_FN lao_v3 sdv_shape_gradient(lao_v3 p, sdv_shape shape) {
    lao_v3 a = sdv_xyz(shape.a);
    lao_v3 up = lao_v3_make(0.0f, 0.0f, 1.0f);
    if (shape.kind == SDV_SHAPE_PLANE) {
        return a;
    }
    if (shape.kind == SDV_SHAPE_ELLIPSOID) {
        return lao_v3_unit(sdv_ellipsoid_slope(sdv_ellipsoid_place(p, shape), shape), up);
    }
    lao_v3 q = lao_v3_sub(p, a);
    if (shape.kind != SDV_SHAPE_BOX) {
        return lao_v3_unit(q, up);
    }
    lao_v3 d = sdv_box_apart(p, shape.a, shape.b);
    lao_v3 o = lao_v3_make(lao_max(d.x, 0.0f), lao_max(d.y, 0.0f), lao_max(d.z, 0.0f));
    if (!(lao_v3_dot(o, o) > 0.0f)) { /* inside: the nearest face */
        LAO_EXACT float most = lao_max(d.x, lao_max(d.y, d.z));
        o = lao_v3_make(0.0f, 0.0f, 1.0f);
        if (d.x >= most) {
            o = lao_v3_make(1.0f, 0.0f, 0.0f);
        } else if (d.y >= most) {
            o = lao_v3_make(0.0f, 1.0f, 0.0f);
        }
    }
    return lao_v3_unit(
        lao_v3_make(q.x < 0.0f ? -o.x : o.x, q.y < 0.0f ? -o.y : o.y, q.z < 0.0f ? -o.z : o.z), up);
}
/* A distance, and whose it is: part -1: the tree's; i: that of shape i. side -1: turned inside out.
 */
struct sdv_solid {
    float distance, side;
    lao_int part;
};
#ifndef LAO_GLSL
typedef struct sdv_solid sdv_solid;
#endif
LAO_FN sdv_solid sdv_solid_start(float distance) {
    sdv_solid s;
    s.distance = distance;
    s.side = 1.0f;
    s.part = -1;
    return s;
}
/* min(a, b), max(a, b), max(a, -b): lower bounds of the true distance, never of wrong sign. */
LAO_FN sdv_solid sdv_solid_add(sdv_solid s, float distance, lao_int operation, lao_int part) {
    sdv_solid r = s;
    LAO_EXACT float d = operation == SDV_SUBTRACTION ? -distance : distance;
    if (operation == SDV_UNION ? d < s.distance : d > s.distance) {
        r.distance = d;
        r.side = operation == SDV_SUBTRACTION ? -1.0f : 1.0f;
        r.part = part;
    }
    return r;
}

/* The nearest vessel to a place, however far: a complete binary tree of balls around cones, node i
   over 2 i and 2 i + 1, gone through in that order from the root, 1, to 0. A leaf has up to four.
 */
#define SDV_LEAF_CONES 4
/* Could a ball hold something as near as `least`? The margin is for rounding. */
LAO_FN bool sdv_ball_reaches(lao_v3 p, lao_v4 ball, float least) {
    lao_v3 q = lao_v3_sub(p, sdv_xyz(ball));
    LAO_EXACT float apart = lao_sqrt(lao_v3_dot(q, q));
    LAO_EXACT float nearest = 0.999999f * apart - ball.w;
    return nearest <= least;
}
/* The next node behind all that is below this one; 0: none. */
LAO_FN lao_int sdv_ball_next(lao_int node) {
    lao_int next = node;
    for (lao_int i = 0; i < 24; i++) {
        if (next / 2 * 2 == next) {
            break;
        }
        next = next / 2;
    }
    return next > 0 ? next + 1 : 0;
}
/* Of two cones the nearer, of two as near the lower. */
LAO_FN sdv_near sdv_nearer(sdv_near n, float distance, float cone) {
    sdv_near r = n;
    if (distance < n.distance || (distance == n.distance && cone < n.cone)) {
        r.distance = distance;
        r.cone = cone;
    }
    return r;
}
/* Part of a ray in which a tree with shapes is looked for: only a union adds to the tree's box. */
LAO_FN lao_v2 sdv_solid_span(lao_v2 box, bool united) {
    if (united) {
        return lao_v2_make(0.0f, SDV_FAR);
    }
    return box;
}
/* A lower bound of the tree's distance at p, exact close to the surface and inside, from the
   least of its cell's list and how far the cell is from any. */
LAO_FN float sdv_tree_bound(float least, bool occupied, float far_step, float outside, float cell) {
    float bound = far_step;
    if (occupied) {
        bound = lao_min(least, sdv_near_reach(cell));
    }
    return outside > 0.0f ? lao_max(bound, outside) : bound;
}

/* Near misses of a tree with shapes, whose distances tell nothing of the line but samples: where
   they have stopped falling, the least is looked for by halving what is on both sides. */
struct sdv_watch {
    float before, older;     /* t of the last two samples */
    float distance, falling; /* of the last one; 1: it was no more than the one before */
    float d_min, t_min;      /* the least local minimum so far */
};
struct sdv_dip {
    float low, high;   /* t: the minimum is between */
    float t, distance; /* the least so far */
};
#ifndef LAO_GLSL
typedef struct sdv_watch sdv_watch;
typedef struct sdv_dip sdv_dip;
#endif
#define SDV_DIP_ROUNDS 4
LAO_FN sdv_watch sdv_watch_start(float t) {
    sdv_watch w;
    w.before = t;
    w.older = t;
    w.distance = SDV_FAR;
    w.falling = 1.0f;
    w.d_min = SDV_FAR;
    w.t_min = 0.0f;
    return w;
}
/* The last sample was a local minimum that may matter; `distance`: of this one. */
LAO_FN bool sdv_watch_passed(sdv_watch w, float distance, float reach) {
    return w.falling > 0.5f && distance > w.distance &&
           (reach > 0.0f ? w.distance < 2.0f * reach : w.distance < SDV_FAR);
}
LAO_FN sdv_watch sdv_watch_next(sdv_watch w, float t, float distance) {
    sdv_watch r = w;
    r.older = w.before;
    r.before = t;
    r.distance = distance;
    r.falling = distance > w.distance ? 0.0f : 1.0f;
    return r;
}
LAO_FN sdv_watch sdv_watch_keep(sdv_watch w, sdv_dip d) {
    sdv_watch r = w;
    if (d.distance < w.d_min) {
        r.d_min = d.distance;
        r.t_min = d.t;
    }
    return r;
}
/* Between the sample before the last and t. */
LAO_FN sdv_dip sdv_dip_start(sdv_watch w, float t) {
    sdv_dip d;
    d.low = w.older;
    d.high = t;
    d.t = w.before;
    d.distance = w.distance;
    return d;
}
/* Where to look on the lower side (0) and on the upper one. */
LAO_FN float sdv_dip_place(sdv_dip d, lao_int side) {
    LAO_EXACT float t = 0.5f * (d.t + (side != 0 ? d.high : d.low));
    return t;
}
/* What was found there. */
LAO_FN sdv_dip sdv_dip_add(sdv_dip d, float below, float above) {
    sdv_dip r = d;
    float low = sdv_dip_place(d, 0), high = sdv_dip_place(d, 1);
    if (below < d.distance && below <= above) {
        r.high = d.t;
        r.t = low;
        r.distance = below;
    } else if (above < d.distance) {
        r.low = d.t;
        r.t = high;
        r.distance = above;
    } else {
        r.low = low;
        r.high = high;
    }
    return r;
}

/* ---- outlines and shadows from d_min (L19 5 with METHODS 5.4); lengths in mm */
/* Outside the tree, nearer to it than `width`. */
LAO_FN bool sdv_is_silhouette(bool hit, float d_min, float width) {
    return !hit && d_min < width;
}
/* The same, and in front of parts farther away. */
LAO_FN bool sdv_is_contour(float d_min, float width) {
    return d_min < width;
}
/* The rim of something `depth` mm in front, wider the deeper the gap: d_min < min(ratio depth,
   most). t, t_min: the ray's parameters of the surface and of the near miss. */
LAO_FN bool sdv_is_depth_shadow(float d_min, float t_min, float t, float ratio, float most) {
    LAO_EXACT float depth = lao_abs(t - t_min);
    LAO_EXACT float width = lao_min(ratio * depth, most);
    return d_min < width;
}
/* How dark that shadow is, 0 .. 1: the rim of it, a part `softness` of its width, fades. */
LAO_FN float sdv_depth_shadow(float d_min, float t_min, float t, float ratio, float most,
                              float softness) {
    LAO_EXACT float width = lao_min(ratio * lao_abs(t - t_min), most);
    LAO_EXACT float dark = (1.0f - d_min / lao_max(width, 1.0e-30f)) / lao_max(softness, 1.0e-3f);
    if (!(d_min < width)) {
        return 0.0f;
    }
    return lao_clamp01(dark);
}
/* Start of a shadow's way, off the surface. */
LAO_FN float sdv_shadow_bias(float cell) {
    LAO_EXACT float r = 0.05f * cell;
    return r;
}
/* Soft shadow: `light` so far, 1 at the start, after a sample of the field at t on the way. */
LAO_FN float sdv_shadow_add(float light, float distance, float t, float hardness) {
    LAO_EXACT float passed = hardness * distance / lao_max(t, 1.0e-6f);
    return lao_min(light, lao_max(passed, 0.0f));
}
/* Ambient occlusion: sample i of SDV_OPEN_SAMPLES is that far along the normal, and what it adds.
 */
#define SDV_OPEN_SAMPLES 5
LAO_FN float sdv_open_place(float reach, lao_int i) {
    LAO_EXACT float r = reach * (LAO_F(i) + 1.0f) / LAO_F(SDV_OPEN_SAMPLES);
    return r;
}
LAO_FN float sdv_open_weight(lao_int i) {
    return lao_bits_float(LAO_U(127 - i) << 23u); /* 2^-i */
}
/* From within a vessel it looks no farther than the middle, beyond which the field falls again:
   `room`, radius of the nearest cone at the place, whose distance is `distance`. */
LAO_FN float sdv_open_reach(float reach, float room, float distance, float cell) {
    float within = lao_min(reach, lao_max(room, sdv_hit_distance(cell)));
    return lao_abs(distance) < cell ? within : reach;
}
/* What the sample's ball lacks of free room, as part of it. */
LAO_FN float sdv_open_add(float closed, float distance, float place, lao_int i) {
    LAO_EXACT float lack = lao_clamp01((place - distance) / place);
    LAO_EXACT float r = closed + sdv_open_weight(i) * lack;
    return r;
}
LAO_FN float sdv_open_result(float closed) {
    LAO_EXACT float r = 1.0f - closed / (2.0f - sdv_open_weight(SDV_OPEN_SAMPLES - 1));
    return lao_clamp01(r);
}

/* ---- least distances to round cones, exact (a cone is convex, and so is its distance on a segment
   or triangle) */
/* Of the points p .. q. */
LAO_FN float sdv_segment_cone(lao_v3 p, lao_v3 q, lao_v4 a, lao_v4 b) {
    lao_v3 pq = lao_v3_sub(q, p);
    LAO_EXACT float length = lao_sqrt(lao_v3_dot(pq, pq));
    if (!(length > 1.0e-12f)) {
        return sdv_round_cone(p, a, b);
    }
    lao_v3 direction = lao_v3_scale(pq, 1.0f / length);
    lao_v2 nearest = sdv_line_nearest(p, direction, a, b);
    LAO_EXACT float t = lao_min(lao_max(0.0f, nearest.y), length);
    return sdv_round_cone(lao_v3_along(p, direction, t), a, b);
}
/* Where the point p of the plane of a triangle is: not outside of any edge. n: its normal, any
 * length. */
LAO_FN bool sdv_in_triangle(lao_v3 p, lao_v3 u, lao_v3 v, lao_v3 w, lao_v3 n) {
    LAO_EXACT float a = lao_v3_dot(lao_v3_cross(lao_v3_sub(v, u), lao_v3_sub(p, u)), n);
    LAO_EXACT float b = lao_v3_dot(lao_v3_cross(lao_v3_sub(w, v), lao_v3_sub(p, v)), n);
    LAO_EXACT float c = lao_v3_dot(lao_v3_cross(lao_v3_sub(u, w), lao_v3_sub(p, w)), n);
    return a >= 0.0f && b >= 0.0f && c >= 0.0f;
}
/* The ball at `s` of the way from a to b: of the points of the plane, its centre's foot is nearest.
 */
LAO_FN float sdv_triangle_ball(float least, lao_v3 u, lao_v3 v, lao_v3 w, lao_v3 n, lao_v4 a,
                               lao_v4 b, float s) {
    lao_v3 ab = lao_v3_make(b.x - a.x, b.y - a.y, b.z - a.z);
    lao_v3 c = lao_v3_along(sdv_xyz(a), ab, s);
    LAO_EXACT float height = lao_v3_dot(lao_v3_sub(c, u), n);
    lao_v3 foot = lao_v3_along(c, n, -height);
    if (!sdv_in_triangle(foot, u, v, w, n)) {
        return least;
    }
    return lao_min(least, sdv_round_cone(foot, a, b));
}
/* Of the points of a triangle: on an edge, or below an end of the axis, or where the axis meets the
 * plane. */
LAO_FN float sdv_triangle_cone(lao_v3 u, lao_v3 v, lao_v3 w, lao_v4 a, lao_v4 b) {
    LAO_EXACT float least =
        lao_min(sdv_segment_cone(u, v, a, b),
                lao_min(sdv_segment_cone(v, w, a, b), sdv_segment_cone(w, u, a, b)));
    lao_v3 zero = lao_v3_make(0.0f, 0.0f, 0.0f);
    lao_v3 n = lao_v3_unit(lao_v3_cross(lao_v3_sub(v, u), lao_v3_sub(w, u)), zero);
    if (!(lao_v3_dot(n, n) > 0.5f)) {
        return least;
    }
    LAO_EXACT float ha = lao_v3_dot(lao_v3_sub(sdv_xyz(a), u), n);
    LAO_EXACT float hb = lao_v3_dot(lao_v3_sub(sdv_xyz(b), u), n);
    least = sdv_triangle_ball(least, u, v, w, n, a, b, 0.0f);
    least = sdv_triangle_ball(least, u, v, w, n, a, b, 1.0f);
    if ((ha < 0.0f) != (hb < 0.0f)) {
        least = sdv_triangle_ball(least, u, v, w, n, a, b, ha / (ha - hb));
    }
    return least;
}

/* ---- pull-push (L19 Eqs. 4 - 9 with METHODS 6): four channels at a time */
struct sdv_mix {
    lao_v4 value;
    float weight, share; /* sums of h min(w, 1) and of h */
};
#ifndef LAO_GLSL
typedef struct sdv_mix sdv_mix;
#endif
LAO_FN sdv_mix sdv_mix_start(lao_v4 zero) {
    sdv_mix m;
    m.value = zero;
    m.weight = 0.0f;
    m.share = 0.0f;
    return m;
}
/* One child or parent that exists. */
LAO_FN sdv_mix sdv_mix_add(sdv_mix m, lao_v4 value, float weight, float h) {
    sdv_mix r = m;
    LAO_EXACT float w = h * lao_min(weight, 1.0f);
    if (!(w > 0.0f)) {
        r.share = m.share + h;
        return r;
    }
    LAO_EXACT float x = m.value.x + w * value.x;
    LAO_EXACT float y = m.value.y + w * value.y;
    LAO_EXACT float z = m.value.z + w * value.z;
    LAO_EXACT float v = m.value.w + w * value.w;
    r.value = lao_v4_make(x, y, z, v);
    r.weight = m.weight + w;
    r.share = m.share + h;
    return r;
}
/* 0 where nothing had a weight. */
LAO_FN lao_v4 sdv_mix_value(sdv_mix m) {
    if (!(m.weight > 0.0f)) {
        return lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float x = m.value.x / m.weight;
    LAO_EXACT float y = m.value.y / m.weight;
    LAO_EXACT float z = m.value.z / m.weight;
    LAO_EXACT float v = m.value.w / m.weight;
    return lao_v4_make(x, y, z, v);
}
/* Weight of a child in the pull. */
LAO_FN float sdv_pull_share(lao_int pull) {
    return pull == 1 ? 1.0f : 0.25f;
}
/* The two nearest parents of texel x along an axis, k = 0, 1, and their shares. */
LAO_FN lao_int sdv_push_parent(lao_int x, lao_int k) {
    lao_int beside = (x & 1) != 0 ? 1 : -1;
    return (x >> 1) + (k != 0 ? beside : 0);
}
LAO_FN float sdv_push_share(lao_int push, lao_int k) {
    if (push == 1) {
        return k != 0 ? 0.25f : 0.75f;
    }
    return 0.5f;
}
/* How much of its own a texel keeps: 1 - (1 - w)^k. */
LAO_FN float sdv_push_own(float weight, lao_int exponent) {
    LAO_EXACT float a = 1.0f - lao_power(1.0f - lao_clamp01(weight), exponent);
    return a;
}
/* A texel of value and own share after the push from its parents' mix. */
LAO_FN lao_v4 sdv_push_value(sdv_mix parents, lao_v4 value, float own) {
    if (!(own > 0.0f)) {
        return sdv_mix_value(parents);
    }
    if (!(parents.weight > 0.0f) || own >= 1.0f) {
        return value;
    }
    lao_v4 g = sdv_mix_value(parents);
    LAO_EXACT float through = 1.0f - own;
    LAO_EXACT float x = through * g.x + own * value.x;
    LAO_EXACT float y = through * g.y + own * value.y;
    LAO_EXACT float z = through * g.z + own * value.z;
    LAO_EXACT float v = through * g.w + own * value.w;
    return lao_v4_make(x, y, z, v);
}
LAO_FN float sdv_push_weight(sdv_mix parents, float own) {
    if (!(parents.weight > 0.0f)) {
        return own;
    }
    LAO_EXACT float w = (1.0f - own) * (parents.weight / parents.share) + own;
    return w;
}

/* ---- shading */
#define SDV_NEAR_MISS_CLOSE 0
#define SDV_NEAR_MISS_EXACT 1
#define SDV_NEAR_MISS_NONE 2
#define SDV_OUTLINE_PX 0
#define SDV_HALO_FOOTPRINT 0.3f /* periods per pixel: where the void is steeper, marks end */
/* A magic lens (Bier et al. 1993): a circle on the picture inside or outside which a set is drawn.
 */
#define SDV_LENS_NONE 0
#define SDV_LENS_INSIDE 1
#define SDV_LENS_OUTSIDE 2
/* On which side of the circle a pixel's centre is; on it: inside. lens: middle, from the left and
   the top, in widths and heights of the picture; radius in heights, less `rim` samples. x, y: in
   samples, row 0 at the bottom; viewport: of lao_frame_uniforms. */
LAO_FN float sdv_lens_part(lao_v3 lens, float rim, float x, float y, lao_v4 viewport) {
    LAO_EXACT float right = x - lens.x * viewport.x;
    LAO_EXACT float up = y - (1.0f - lens.y) * viewport.y;
    LAO_EXACT float radius = lens.z * viewport.y - rim;
    LAO_EXACT float beyond =
        right * right + up * up - lao_max(radius, 0.0f) * lao_max(radius, 0.0f);
    return beyond > 0.0f ? 2.0f : 1.0f;
}
/* Is a pixel on this part not drawn by a set of that lens_side? By arithmetic: drivers compile
   anew for every value of a uniform that is branched on. */
LAO_FN bool sdv_lens_hides(float side, float part) {
    return side * lao_abs(side - part) > 0.5f;
}
/* Is a pixel that is drawn on the ring? part: of the circle inside the ring. */
LAO_FN bool sdv_lens_rings(float side, float part) {
    return side * part == 2.0f;
}
/* Pixels of the picture per mm at view depth z; scale, depth: of lao_frame_uniforms. */
LAO_FN float sdv_zoom(lao_v4 scale, lao_v4 depth, float z, float supersampling) {
    float apart = lao_max(z, 1.0e-6f);
    LAO_EXACT float across = (depth.w > 0.5f ? 1.0f : apart) * supersampling;
    LAO_EXACT float r = lao_abs(scale.y) / across;
    return r;
}
/* An outline's width in mm. */
LAO_FN float sdv_outline_width(float width, float unit, float zoom) {
    LAO_EXACT float mm = width / zoom;
    return unit > 0.5f ? width : mm;
}
/* How near to a vessel a ray must pass for anything to be drawn of it, mm. `shadow`, `halo`, `ink`:
   % of the diameter. */
LAO_FN float sdv_near_miss_reach(float silhouette, float contour, float shadow, float halo,
                                 float ink, float diameter) {
    LAO_EXACT float widest = 0.01f * lao_max(lao_max(shadow, halo), ink) * diameter;
    return lao_max(lao_max(silhouette, contour), widest);
}
/* Place of p along a cone's axis, 0 at a, 1 at b. */
LAO_FN float sdv_cone_place(lao_v3 p, lao_v4 a, lao_v4 b) {
    lao_v3 axis = lao_v3_make(b.x - a.x, b.y - a.y, b.z - a.z);
    lao_v3 q = lao_v3_make(p.x - a.x, p.y - a.y, p.z - a.z);
    LAO_EXACT float along = lao_v3_dot(q, axis) / lao_max(lao_v3_dot(axis, axis), 1.0e-30f);
    return lao_clamp01(along);
}
/* Between the colours of a cone's ends, by the place along its axis. */
LAO_FN lao_v3 sdv_cone_color(lao_v3 p, lao_v4 a, lao_v4 b, lao_v3 color_a, lao_v3 color_b) {
    float t = sdv_cone_place(p, a, b);
    LAO_EXACT float x = color_a.x + t * (color_b.x - color_a.x);
    LAO_EXACT float y = color_a.y + t * (color_b.y - color_a.y);
    LAO_EXACT float z = color_a.z + t * (color_b.z - color_a.z);
    return lao_v3_make(x, y, z);
}
/* Radius of the cone at the place, mm. */
LAO_FN float sdv_cone_radius(lao_v3 p, lao_v4 a, lao_v4 b) {
    LAO_EXACT float r = a.w + sdv_cone_place(p, a, b) * (b.w - a.w);
    return r;
}
/* Is the place marked? alpha_a, alpha_b: of the colours of the cone's ends. */
LAO_FN bool sdv_is_marked(lao_v3 p, lao_v4 a, lao_v4 b, float alpha_a, float alpha_b) {
    LAO_EXACT float alpha = alpha_a + sdv_cone_place(p, a, b) * (alpha_b - alpha_a);
    return alpha < 0.5f;
}
/* How near to a place of the surface another cone takes part in its shading normal (x, mm: within
   what the cell's list is sure to hold), and the radius there (y). a, b: of the cone at p. */
LAO_FN lao_v2 sdv_joint_reach(lao_v3 p, lao_v4 a, lao_v4 b, float smoothness, float cell) {
    float radius = sdv_cone_radius(p, a, b);
    LAO_EXACT float reach = smoothness * radius;
    return lao_v2_make(lao_min(reach, sdv_near_reach(cell)), radius);
}
/* Cones as long as the radius add nothing: they are smooth where they bend outwards, and the balls
   at their ends would tilt the normal before the joint. */
LAO_FN float sdv_joint_part(lao_v4 a, lao_v4 b, float radius) {
    lao_v3 axis = lao_v3_make(b.x - a.x, b.y - a.y, b.z - a.z);
    LAO_EXACT float size = lao_sqrt(lao_v3_dot(axis, axis));
    LAO_EXACT float part = 2.0f - 2.0f * size / radius;
    return lao_clamp01(part);
}
/* What the cone at p, of this gradient, has more than its part. */
LAO_FN lao_v3 sdv_joint_start(lao_v3 gradient, lao_v4 a, lao_v4 b, lao_v2 reach) {
    LAO_EXACT float rest = 1.0f - sdv_joint_part(a, b, reach.y);
    return lao_v3_scale(gradient, rest);
}
/* Adds the gradient of a cone that is nearer than reach.x to those before, the less the farther its
   surface is. */
LAO_FN lao_v3 sdv_joint_add(lao_v3 sum, float distance, lao_v3 gradient, lao_v4 a, lao_v4 b,
                            lao_v2 reach) {
    LAO_EXACT float part = 1.0f - lao_max(distance, 0.0f) / reach.x;
    LAO_EXACT float weight = part * part * sdv_joint_part(a, b, reach.y);
    return lao_v3_along(sum, gradient, weight);
}
/* The mean of the gradients on the side of the surface's own normal, unit. */
LAO_FN lao_v3 sdv_joint_normal(lao_v3 sum, lao_v3 normal) {
    lao_v3 n = lao_v3_unit(sum, normal);
    if (lao_v3_dot(n, normal) < 0.0f) {
        return lao_v3_scale(n, -1.0f);
    }
    return n;
}
/* Light after something dark, 0 .. 1, of that strength. */
LAO_FN float sdv_dimmed(float light, float dark, float strength) {
    LAO_EXACT float r = light * lao_clamp01(1.0f - strength * dark);
    return r;
}
/* Ambient and diffuse part. From within a vessel one sees walls at grazing angles, which light that
   walls throw at each other fills: half of the diffuse part comes from everywhere. */
LAO_FN lao_v2 sdv_light_parts(float ambient, float diffuse, bool inside) {
    LAO_EXACT float moved = inside ? 0.5f * diffuse : 0.0f;
    return lao_v2_make(ambient + moved, diffuse - moved);
}
/* Phong with a head light; n and l (towards the light) are unit. `light`: what reaches the place of
   all of it. */
LAO_FN lao_v3 sdv_shade(lao_v3 color, lao_v3 n, lao_v3 l, float ambient, float diffuse,
                        float specular, lao_int exponent, float light) {
    LAO_EXACT float nl = lao_max(lao_v3_dot(n, l), 0.0f);
    LAO_EXACT float rl = lao_max(2.0f * nl * nl - 1.0f, 0.0f);
    LAO_EXACT float body = (ambient + diffuse * nl) * light;
    LAO_EXACT float shine = specular * lao_power(rl, exponent) * light;
    LAO_EXACT float x = color.x * body + shine;
    LAO_EXACT float y = color.y * body + shine;
    LAO_EXACT float z = color.z * body + shine;
    return lao_v3_make(lao_clamp01(x), lao_clamp01(y), lao_clamp01(z));
}

/* ---- the surface of the screen: vessels and what fills the void behind them (L19 3.4 with METHODS
   6.1) */
#define SDV_BACKGROUND_INERTIA 0.01f   /* w_B: weight of the last frame's depth */
#define SDV_BACKGROUND_PRESENCE 0.001f /* weight of the void beside vessels in coarser levels */
/* Whether a traced pixel shows a surface: a cone's or a cut's. */
LAO_FN bool sdv_is_covered(float cone) {
    return cone > -0.5f || cone < -1.5f;
}
/* Depth where a picture has nothing at all: beyond the far end by the scene's diameter. */
LAO_FN float sdv_empty_depth(lao_v4 depth) {
    LAO_EXACT float z = depth.x + 2.0f * depth.z;
    return z;
}
/* Depth of a place of the world before the camera, mm. */
LAO_FN float sdv_depth_of(lao_m4 view, lao_v3 p) {
    lao_v3 q = lao_transform(view, p);
    return -q.z;
}
/* Depth before the camera, mm, of a depth buffer's value: the inverse of the projection to 0 .. 1;
   SDV_FAR where the buffer holds either end, so nothing. */
LAO_FN float sdv_drawn_depth(lao_m4 projection, float value) {
    LAO_EXACT float over = projection.w.z - value * projection.w.w;
    LAO_EXACT float under = projection.z.z - value * projection.z.w;
    LAO_EXACT float z = over / under;
    return value > 0.0f && value < 1.0f && lao_abs(z) < SDV_FAR ? z : SDV_FAR;
}
/* The place of the world at that depth of a pixel. */
LAO_FN lao_v3 sdv_depth_place(lao_m4 world, lao_v2 slope, float depth, float orthographic) {
    float s = orthographic > 0.5f ? 1.0f : depth;
    LAO_EXACT float x = slope.x * s;
    LAO_EXACT float y = slope.y * s;
    return lao_transform(world, lao_v3_make(x, y, -depth));
}
/* The linear part of a transformation. */
LAO_FN lao_v3 sdv_turned(lao_m4 m, lao_v3 v) {
    LAO_EXACT float x = m.x.x * v.x + m.y.x * v.y + m.z.x * v.z;
    LAO_EXACT float y = m.x.y * v.x + m.y.y * v.y + m.z.y * v.z;
    LAO_EXACT float z = m.x.z * v.x + m.y.z * v.y + m.z.z * v.z;
    return lao_v3_make(x, y, z);
}
/* A direction that only depends on the camera, unit: no branch, see sdv_apart. */
LAO_FN lao_v3 sdv_camera_unit(lao_v3 v) {
    LAO_EXACT float inverse = 1.0f / lao_sqrt(lao_max(lao_v3_dot(v, v), 1.0e-24f));
    return lao_v3_scale(v, inverse);
}
/* Unit vector to the light of field shadows: x to the right and y up per length towards the viewer.
   world: of lao_frame_uniforms. */
LAO_FN lao_v3 sdv_shadow_light(lao_m4 world, float x, float y) {
    return sdv_camera_unit(sdv_turned(world, lao_v3_make(x, y, 1.0f)));
}
/* mm across a pixel at that depth. */
LAO_FN float sdv_pixel_size(lao_v4 ray, float depth, float orthographic) {
    float apart = lao_abs(depth);
    LAO_EXACT float r = lao_abs(ray.y) * (orthographic > 0.5f ? 1.0f : apart);
    return r;
}
/* From pixel to pixel along an axis, on the side where depth changes less. */
LAO_FN lao_v3 sdv_sheet_step(lao_v3 before, lao_v3 p, lao_v3 after, float depth_before, float depth,
                             float depth_after) {
    LAO_EXACT float a = lao_abs(depth - depth_before);
    LAO_EXACT float b = lao_abs(depth_after - depth);
    if (b <= a) {
        return lao_v3_sub(after, p);
    }
    return lao_v3_sub(p, before);
}
/* Normal from two such steps, on the side of `towards` (unit). */
LAO_FN lao_v3 sdv_sheet_normal(lao_v3 dx, lao_v3 dy, lao_v3 towards) {
    lao_v3 zero = lao_v3_make(0.0f, 0.0f, 0.0f);
    lao_v3 n = lao_v3_unit(lao_v3_cross(lao_v3_unit(dx, zero), lao_v3_unit(dy, zero)), towards);
    if (lao_v3_dot(n, towards) < 0.0f) {
        return lao_v3_scale(n, -1.0f);
    }
    return n;
}

/* ---- guiding field: directions without a sign (L19 3.5 with METHODS 7.1) */
#define SDV_GUIDE_CONTOUR 0
#define SDV_GUIDE_OWN 1
#define SDV_CONTOUR_WEIGHT 0.2f /* w_f */
/* Gradient of depth over three rows of three pixels, bottom up: a step reads as its height, as part
   of the scene's diameter. */
LAO_FN lao_v2 sdv_sobel(lao_v3 below, lao_v3 at, lao_v3 above, float inverse_diameter) {
    LAO_EXACT float x = 0.25f * inverse_diameter *
                        ((below.z - below.x) + 2.0f * (at.z - at.x) + (above.z - above.x));
    LAO_EXACT float y = 0.25f * inverse_diameter *
                        ((above.x - below.x) + 2.0f * (above.y - below.y) + (above.z - below.z));
    return lao_v2_make(x, y);
}
/* z z^T of a direction of the screen (xx, xy, yy) and its weight. */
LAO_FN lao_v4 sdv_tensor(float x, float y, float weight) {
    LAO_EXACT float xx = x * x;
    LAO_EXACT float xy = x * y;
    LAO_EXACT float yy = y * y;
    return lao_v4_make(xx, xy, yy, weight);
}
/* Of a covered pixel with that depth gradient and normal (view space): the projected normal where
   the step is higher than the threshold, else nothing. */
LAO_FN lao_v4 sdv_contour_tensor(lao_v2 gradient, lao_v3 normal, float threshold) {
    LAO_EXACT float rise = lao_sqrt(lao_v2_dot(gradient, gradient));
    if (!(rise > threshold)) {
        return lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float across = lao_sqrt(normal.x * normal.x + normal.y * normal.y);
    if (across > 1.0e-6f) {
        return sdv_tensor(normal.x / across, normal.y / across, SDV_CONTOUR_WEIGHT);
    }
    return sdv_tensor(-gradient.x / rise, -gradient.y / rise, SDV_CONTOUR_WEIGHT);
}
/* Of a surface's own direction (view space): certain where it is seen from the side, nothing
 * end-on.
 */
LAO_FN lao_v4 sdv_axis_tensor(lao_v3 axis) {
    lao_v3 a = lao_v3_unit(axis, lao_v3_make(0.0f, 0.0f, 0.0f));
    LAO_EXACT float across2 = a.x * a.x + a.y * a.y;
    if (!(across2 > 1.0e-6f)) {
        return lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float across = lao_sqrt(across2);
    return sdv_tensor(a.x / across, a.y / across, across2);
}
/* First eigenvector (x >= 0), and 1; (0, 0) and 0 where no direction stands out. */
LAO_FN lao_v3 sdv_tensor_axis(lao_v4 g) {
    LAO_EXACT float difference = g.x - g.z;
    LAO_EXACT float twice = 2.0f * g.y;
    LAO_EXACT float spread = lao_sqrt(difference * difference + twice * twice);
    LAO_EXACT float trace = g.x + g.z;
    if (!(spread > 1.0e-6f * trace)) {
        return lao_v3_make(0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float c = difference / spread; /* of the double angle */
    LAO_EXACT float s = twice / spread;
    if (c >= 0.0f) {
        LAO_EXACT float x = lao_sqrt(0.5f + 0.5f * c);
        LAO_EXACT float y = 0.5f * s / x;
        return lao_v3_make(x, y, 1.0f);
    }
    LAO_EXACT float v = lao_sqrt(0.5f - 0.5f * c);
    LAO_EXACT float u = 0.5f * lao_abs(s) / v;
    return lao_v3_make(u, s < 0.0f ? -v : v, 1.0f);
}
/* What is left of v in the plane of normal n, unit; (0, 0, 0) where that is nothing. */
LAO_FN lao_v3 sdv_tangent(lao_v3 v, lao_v3 n) {
    lao_v3 rest = lao_v3_along(v, n, -lao_v3_dot(v, n));
    if (!(lao_v3_dot(rest, rest) > 1.0e-12f)) {
        return lao_v3_make(0.0f, 0.0f, 0.0f);
    }
    return lao_v3_unit(rest, lao_v3_make(0.0f, 0.0f, 0.0f));
}
/* A direction of the screen (of sdv_tensor_axis) in the tangent plane of normal n (METHODS 7.2);
   else `otherwise` there, else any. */
LAO_FN lao_v3 sdv_lift(lao_m4 world, lao_v3 axis, lao_v3 n, lao_v3 otherwise) {
    lao_v3 right = sdv_xyz(world.x);
    lao_v3 up = sdv_xyz(world.y);
    lao_v3 z = sdv_tangent(lao_v3_along(lao_v3_scale(right, axis.x), up, axis.y), n);
    if (!(lao_v3_dot(z, z) > 0.5f)) {
        z = sdv_tangent(otherwise, n);
    }
    if (!(lao_v3_dot(z, z) > 0.5f)) {
        z = sdv_tangent(right, n);
    }
    if (!(lao_v3_dot(z, z) > 0.5f)) {
        z = sdv_tangent(up, n);
    }
    return z;
}
/* 1 / |p - q|^2, at most that of `least` mm. */
LAO_FN float sdv_nearness(lao_v3 p, lao_v3 q, float least) {
    lao_v3 apart = lao_v3_sub(p, q);
    LAO_EXACT float least2 = lao_max(least * least, 1.0e-30f);
    LAO_EXACT float r = 1.0f / lao_max(lao_v3_dot(apart, apart), least2);
    return r;
}
/* The same between a pixel of a level and its parents: whatever lies no further than parents lie
   apart on the screen counts alike, so that the stencil alone rules on a smooth surface (its
   weights times 1 / |p - q|^2 of L19 would be blocks) and only what lies behind or in front counts
   less. pixel: mm across one of the finest level. */
LAO_FN float sdv_parent_nearness(lao_v3 p, lao_v3 q, float pixel, float level) {
    LAO_EXACT float least = 2.2f * pixel * lao_exp2(level);
    return sdv_nearness(p, q, least);
}

/* ---- parameterization: two phases of every pixel, radians (L19 3.6 with METHODS 7.3) */
/* Phase of a pixel as a neighbour predicts it (x) and how much that counts (y): z, z_other: their
   directions, of either sign; apart: from the neighbour to the pixel, mm; frequency: radians per
   mm. */
LAO_FN lao_v2 sdv_phase_from(lao_v3 z, lao_v3 z_other, float phase, lao_v3 apart, float frequency) {
    LAO_EXACT float alike = lao_v3_dot(z, z_other);
    float s = alike < 0.0f ? -1.0f : 1.0f;
    lao_v3 both = lao_v3_along(z, z_other, s);
    LAO_EXACT float predicted = s * phase + 0.5f * frequency * lao_v3_dot(both, apart);
    return lao_v2_make(predicted, lao_abs(alike));
}
/* The same phase in [-pi, pi]; untouched where it is there already. */
LAO_FN float sdv_phase_wrap(float phase) {
    if (lao_abs(phase) <= 3.14159265f) {
        return phase;
    }
    LAO_EXACT float turns = phase / LAO_TURN;
    LAO_EXACT float r = (turns - lao_floor(turns + 0.5f)) * LAO_TURN;
    return lao_min(lao_max(r, -3.14159265f), 3.14159265f);
}
/* What neighbours predict together: sums of (cos, sin) and of weights for u and for v. */
struct sdv_phases {
    lao_v4 sum;   /* cos, sin of u, of v */
    lao_v2 share; /* of u, of v */
};
#ifndef LAO_GLSL
typedef struct sdv_phases sdv_phases;
#endif
LAO_FN sdv_phases sdv_phases_start(lao_v4 zero) {
    sdv_phases s;
    s.sum = zero;
    s.share = lao_v2_make(0.0f, 0.0f);
    return s;
}
/* u, v: from sdv_phase_from; h: weight of the neighbour but for its direction. */
LAO_FN sdv_phases sdv_phases_add(sdv_phases s, lao_v2 u, lao_v2 v, float h) {
    sdv_phases r = s;
    LAO_EXACT float hu = h * u.y;
    LAO_EXACT float hv = h * v.y;
    LAO_EXACT float tu = u.x / LAO_TURN;
    LAO_EXACT float tv = v.x / LAO_TURN;
    LAO_EXACT float x = s.sum.x + hu * lao_cos_turns(tu);
    LAO_EXACT float y = s.sum.y + hu * lao_sin_turns(tu);
    LAO_EXACT float z = s.sum.z + hv * lao_cos_turns(tv);
    LAO_EXACT float w = s.sum.w + hv * lao_sin_turns(tv);
    r.sum = lao_v4_make(x, y, z, w);
    r.share = lao_v2_make(s.share.x + hu, s.share.y + hv);
    return r;
}
/* Whether the predictions leave anything when added up. */
LAO_FN bool sdv_phase_agrees(float c, float s, float share) {
    LAO_EXACT float size2 = c * c + s * s;
    LAO_EXACT float least = 1.0e-4f * share;
    return share > 0.0f && size2 > least * least;
}
/* (u, v) that the neighbours agree on; where they do not, what it was. */
LAO_FN lao_v2 sdv_phases_mean(sdv_phases s, lao_v2 otherwise) {
    lao_v2 r = otherwise;
    if (sdv_phase_agrees(s.sum.x, s.sum.y, s.share.x)) {
        r.x = lao_atan2(s.sum.y, s.sum.x);
    }
    if (sdv_phase_agrees(s.sum.z, s.sum.w, s.share.y)) {
        r.y = lao_atan2(s.sum.w, s.sum.z);
    }
    return r;
}
/* Weight of a neighbour: near ones and vessels count (L19 Eq. 10), void alone counts alike. */
LAO_FN float sdv_phase_weight(lao_v3 p, lao_v3 q, float covered, float stencil, float pixel) {
    LAO_EXACT float h = stencil * lao_max(covered, 1.0e-6f) * sdv_nearness(p, q, 0.001f * pixel);
    return h;
}
/* One neighbour's part: place and share of vessels (w), both directions, phases. */
LAO_FN sdv_phases sdv_phases_hear(sdv_phases s, lao_v3 p, lao_v3 along, lao_v3 across, lao_v4 q,
                                  lao_v3 along_other, lao_v3 across_other, lao_v2 phase,
                                  float stencil, float frequency, float pixel) {
    lao_v3 place = sdv_xyz(q);
    lao_v3 apart = lao_v3_sub(p, place);
    return sdv_phases_add(s, sdv_phase_from(along, along_other, phase.x, apart, frequency),
                          sdv_phase_from(across, across_other, phase.y, apart, frequency),
                          sdv_phase_weight(p, place, q.w, stencil, pixel));
}

/* ---- frame coherence (L19 3.7 with METHODS 7.4) */
/* Coarsest level that a frame renews: the setting, or (negative) the largest with 2^level <= 1/16
   period, at least 1. period: pixels. busy 0: a solution at rest only goes on, by level 0. */
LAO_FN float sdv_recycle_level(float setting, float period, float busy) {
    LAO_EXACT float rule = 1.0f;
    LAO_EXACT float next = 63.995f;
    for (lao_int i = 0; i < 14; i++) {
        rule = rule + (period >= next ? 1.0f : 0.0f);
        next = next * 2.0f;
    }
    float level = setting > -0.5f ? setting : rule;
    return busy > 0.0f ? level : 0.0f;
}
/* 0 where two cameras are the same. A sum, and no comparisons one by one: lavapipe makes a program
   for each value of a uniform that a branch asks for, which would be several a frame. */
LAO_FN float sdv_apart_column(lao_v4 a, lao_v4 b) {
    LAO_EXACT float r =
        lao_abs(a.x - b.x) + lao_abs(a.y - b.y) + lao_abs(a.z - b.z) + lao_abs(a.w - b.w);
    return r;
}
LAO_FN float sdv_apart(lao_m4 a, lao_m4 b) {
    LAO_EXACT float r = sdv_apart_column(a.x, b.x) + sdv_apart_column(a.y, b.y) +
                        sdv_apart_column(a.z, b.z) + sdv_apart_column(a.w, b.w);
    return r;
}
/* The pixel of an image that shows p, and 1; 0: none does. */
LAO_FN lao_v3 sdv_pixel_of(lao_m4 view, lao_m4 projection, lao_v3 p, float width, float height) {
    lao_v4 clip = lao_project(projection, lao_transform(view, p));
    if (!(clip.w > 1.0e-12f)) {
        return lao_v3_make(0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float x = lao_floor((clip.x / clip.w * 0.5f + 0.5f) * width);
    LAO_EXACT float y = lao_floor((clip.y / clip.w * 0.5f + 0.5f) * height);
    if (!(x >= 0.0f && y >= 0.0f && x < width && y < height)) {
        return lao_v3_make(0.0f, 0.0f, 0.0f);
    }
    return lao_v3_make(x, y, 1.0f);
}
/* Whether q, seen there in the last frame, is the surface at p with normal n: else it came into
   view. pixel: mm. */
LAO_FN bool sdv_same_surface(lao_v3 p, lao_v3 n, lao_v3 q, float pixel) {
    lao_v3 apart = lao_v3_sub(q, p);
    LAO_EXACT float off = lao_abs(lao_v3_dot(apart, n));
    LAO_EXACT float most = 64.0f * pixel * pixel;
    return off <= 2.0f * pixel && lao_v3_dot(apart, apart) <= most;
}
/* What the surface image says of a covered pixel (negative: of the void): the period, which a set
   of the frame tells from other sets by a power of two. */
LAO_FN float sdv_surface_mark(float period, float set) {
    LAO_EXACT float r = period * lao_exp2(12.0f * set);
    return r;
}
/* A guide of the screen as the last frame's camera saw it, in the world; for its sign only. */
LAO_FN lao_v3 sdv_guide_world(lao_m4 view, float x, float y) {
    lao_v3 right = lao_v3_make(view.x.x, view.y.x, view.z.x);
    lao_v3 up = lao_v3_make(view.x.y, view.y.y, view.z.y);
    return lao_v3_along(lao_v3_scale(right, x), up, y);
}
/* The guide on the screen, unit: the axis of sdv_tensor_axis, else the lifted direction as it is
 * seen. */
LAO_FN lao_v2 sdv_guide_screen(lao_m4 view, lao_v3 axis, lao_v3 along) {
    if (axis.z > 0.5f) {
        return lao_v2_make(axis.x, axis.y);
    }
    lao_v3 seen = sdv_turned(view, along);
    lao_v3 unit = lao_v3_unit(lao_v3_make(seen.x, seen.y, 0.0f), lao_v3_make(1.0f, 0.0f, 0.0f));
    return lao_v2_make(unit.x, unit.y);
}
/* The last frame's (u, v) at q as (u, v) at p: `before` is its guide in the world. Turned by its
   sign, and moved along by what lies between. */
LAO_FN lao_v2 sdv_phase_recall(lao_v3 along, lao_v3 across, lao_v3 before, lao_v2 phase,
                               lao_v3 apart, float frequency) {
    float s = lao_v3_dot(along, before) < 0.0f ? -1.0f : 1.0f;
    LAO_EXACT float u = s * phase.x + frequency * lao_v3_dot(along, apart);
    LAO_EXACT float v = s * phase.y + frequency * lao_v3_dot(across, apart);
    return lao_v2_make(sdv_phase_wrap(u), sdv_phase_wrap(v));
}
/* now, before: of the surface image. A pixel that has not changed, seen by a camera that has not
   moved, keeps its phases. */
LAO_FN bool sdv_phase_stays(lao_v4 now, lao_v4 before) {
    return now.w == before.w &&
           (now.w < 0.0f || (now.x == before.x && now.y == before.y && now.z == before.z));
}

/* ---- illustration by (u, v): ink of a pixel, 0 .. 1, whose mean is the darkness (METHODS 7.5) */
#define SDV_STYLE_PLAIN 0
#define SDV_STYLE_STIPPLE 1
#define SDV_STYLE_HATCH 2
#define SDV_STYLE_CROSSHATCH 3
#define SDV_STYLE_LAYERED 4
#define SDV_STYLE_SHADOW 5 /* shaded, depth shadows hatched */
#define SDV_STYLE_PATTERN 6
#define SDV_VOID_PLAIN 0
#define SDV_VOID_CHROMADEPTH 1
#define SDV_VOID_STIPPLE 2
#define SDV_VOID_HATCH 3
/* Periods per pixel along the tangent z of a surface of normal n; right, up, direction: axes of the
   screen and the view ray, unit. */
LAO_FN float sdv_style_footprint(lao_v3 z, lao_v3 n, lao_v3 right, lao_v3 up, lao_v3 direction,
                                 float pixel, float period) {
    LAO_EXACT float facing = lao_min(lao_v3_dot(direction, n), -0.05f);
    LAO_EXACT float slope = lao_v3_dot(z, direction) / facing;
    LAO_EXACT float x = lao_v3_dot(z, right) - slope * lao_v3_dot(n, right);
    LAO_EXACT float y = lao_v3_dot(z, up) - slope * lao_v3_dot(n, up);
    LAO_EXACT float r = pixel * lao_sqrt(x * x + y * y) / period;
    return r;
}
/* Ink from 0 to x of lines at the whole numbers, as wide as `dark`. */
LAO_FN float sdv_lines_until(float x, float dark) {
    LAO_EXACT float n = lao_floor(x + 0.5f);
    LAO_EXACT float r = dark * n + lao_min(lao_max(x - n, -0.5f * dark), 0.5f * dark);
    return r;
}
/* The mean of the lines over a pixel `wide` periods wide: exact, so that thin lines keep their
 * tone. */
LAO_FN float sdv_lines_ink(float x, float dark, float wide) {
    LAO_EXACT float w = lao_max(wide, 1.0e-3f);
    LAO_EXACT float r =
        (sdv_lines_until(x + 0.5f * w, dark) - sdv_lines_until(x - 0.5f * w, dark)) / w;
    return lao_clamp01(r);
}
/* On thin vessels strokes and dots are finer: as many times as a period is longer than the vessel
   is wide, or than so many pixels. 1: as they are. radius, period, pixel: mm. */
#define SDV_INK_LEAST_PIXELS 5.0f
LAO_FN float sdv_ink_finer(float radius, float period, float pixel) {
    LAO_EXACT float room = lao_max(1.5f * radius, SDV_INK_LEAST_PIXELS * pixel);
    LAO_EXACT float r = lao_min(lao_max(period / room, 1.0f), 32.0f);
    return r;
}
/* How many cells of the finest lattice that is whole lie along a period (x: 1, 2, 4, ...), and how
   far strokes and dots between its own have grown (y, 0 .. 1). */
LAO_FN lao_v2 sdv_ink_lattice(float finer) {
    float cells = 1.0f;
    for (lao_int i = 0; i < 5; i++) {
        cells = finer >= 2.0f * cells ? 2.0f * cells : cells;
    }
    LAO_EXACT float grown = finer / cells - 1.0f;
    return lao_v2_make(cells, lao_max(grown, 0.0f));
}
/* How far from the middle of its cell a place is, 0 .. 1/2, where cells are `times` as fine. */
LAO_FN float sdv_finer_cell(float a, float times) {
    LAO_EXACT float x = lao_abs(a) * times;
    LAO_EXACT float r = lao_abs(x - lao_floor(x + 0.5f));
    return r;
}
/* Lines and, between them, those that grow while they thin: the mean stays `dark`. x: 0 .. 1/2. */
LAO_FN float sdv_growing_lines(float x, float dark, float wide, float grown) {
    LAO_EXACT float between = 0.5f * grown * dark;
    float ink = sdv_lines_ink(x, dark - between, wide);
    if (grown > 0.0f) {
        LAO_EXACT float both = ink + sdv_lines_ink(0.5f - x, between, wide);
        ink = lao_clamp01(both);
    }
    return ink;
}
/* A disc in the middle of a cell; its soft edge and what is smaller than a pixel keep their area.
   dark <= pi / 4. */
LAO_FN float sdv_dot_ink(float a, float b, float dark, float wide_a, float wide_b) {
    LAO_EXACT float r = lao_sqrt(a * a + b * b);
    LAO_EXACT float wa = a * wide_a;
    LAO_EXACT float wb = b * wide_b;
    LAO_EXACT float mean = 0.5f * (wide_a + wide_b);
    LAO_EXACT float w = lao_max(r > 1.0e-3f ? lao_sqrt(wa * wa + wb * wb) / r : mean, 1.0e-3f);
    LAO_EXACT float squared = 0.318309886f * dark - 0.0833333333f * w * w;
    LAO_EXACT float least = 0.25f * w * w;
    LAO_EXACT float radius = lao_sqrt(lao_max(squared, least));
    LAO_EXACT float share = lao_min(dark / (1.04719755f * w * w), 1.0f);
    LAO_EXACT float ink = lao_clamp01(0.5f + (radius - r) / w) * (squared < least ? share : 1.0f);
    return ink;
}
/* Dots and, between them, three times as many that grow to their size while they shrink; dark <=
   1/2, so that none touch. Cells that are too small to be seen turn grey. */
LAO_FN float sdv_growing_dots(float a, float b, float dark, float wide_a, float wide_b,
                              float grown) {
    LAO_EXACT float own = dark - 0.75f * grown * dark;
    float ink = sdv_dot_ink(a, b, own, wide_a, wide_b);
    if (grown > 0.0f && (a > 0.25f || b > 0.25f)) {
        LAO_EXACT float both = ink + sdv_dot_ink(sdv_finer_cell(a, 2.0f), sdv_finer_cell(b, 2.0f),
                                                 grown * dark, 2.0f * wide_a, 2.0f * wide_b);
        ink = lao_clamp01(both);
    }
    LAO_EXACT float blur = lao_clamp01(2.5f * (wide_a + wide_b) * (1.0f + grown) - 0.75f);
    LAO_EXACT float r = ink + blur * (dark - ink);
    return r;
}
/* Dots; above a half white ones, around the corners of cells. a, b: 0 .. 1/2. */
LAO_FN float sdv_stipple_ink(float a, float b, float dark, float wide_a, float wide_b,
                             float grown) {
    if (dark <= 0.5f) {
        return sdv_growing_dots(a, b, dark, wide_a, wide_b, grown);
    }
    LAO_EXACT float r =
        1.0f - sdv_growing_dots(0.5f - a, 0.5f - b, 1.0f - dark, wide_a, wide_b, grown);
    return r;
}
LAO_FN float sdv_crosshatch_ink(float a, float b, float dark, float wide_a, float wide_b,
                                float grown) {
    LAO_EXACT float each = 1.0f - lao_sqrt(lao_max(1.0f - dark, 0.0f));
    LAO_EXACT float r = 1.0f - (1.0f - sdv_growing_lines(a, each, wide_a, grown)) *
                                   (1.0f - sdv_growing_lines(b, each, wide_b, grown));
    return r;
}
/* u, v: radians; even in both, as (-u, -v) is the same place seen along the other direction.
   wide_u, wide_v: periods per pixel; finer: see sdv_ink_finer. */
LAO_FN float sdv_style_ink(lao_int style, float u, float v, float darkness, float wide_u,
                           float wide_v, float finer) {
    lao_v2 lattice = sdv_ink_lattice(finer);
    float a = sdv_finer_cell(u / LAO_TURN, lattice.x);
    float b = sdv_finer_cell(v / LAO_TURN, lattice.x);
    LAO_EXACT float wide_a = wide_u * lattice.x;
    LAO_EXACT float wide_b = wide_v * lattice.x;
    float dark = lao_clamp01(darkness);
    if (style == SDV_STYLE_STIPPLE || (style == SDV_STYLE_LAYERED && dark < 0.35f)) {
        return sdv_stipple_ink(a, b, dark, wide_a, wide_b, lattice.y);
    }
    if (style == SDV_STYLE_CROSSHATCH || (style == SDV_STYLE_LAYERED && dark > 0.7f)) {
        return sdv_crosshatch_ink(a, b, dark, wide_a, wide_b, lattice.y);
    }
    return sdv_growing_lines(b, dark, wide_b, lattice.y);
}
/* Sample i of SDV_PATTERN_SAMPLES^2 over a pixel at (a, b), periods: which of n x n thresholds
   holds there. The pattern lies in half a period and is mirrored, as (u, v) and (-u, -v) are one
   place. */
#define SDV_PATTERN_SAMPLES 4
LAO_FN lao_int sdv_pattern_axis(float a, float wide, lao_int i, lao_int n) {
    LAO_EXACT float x = a + wide * ((LAO_F(i) + 0.5f) / LAO_F(SDV_PATTERN_SAMPLES) - 0.5f);
    LAO_EXACT float off = lao_abs(x - lao_floor(x + 0.5f)) * 2.0f * LAO_F(n);
    return LAO_I(lao_min(off, LAO_F(n) - 0.5f));
}
LAO_FN lao_int sdv_pattern_at(lao_v2 phase, float wide_u, float wide_v, lao_int i, lao_int n) {
    LAO_EXACT float a = phase.x / LAO_TURN;
    LAO_EXACT float b = phase.y / LAO_TURN;
    return sdv_pattern_axis(b, wide_v, i / SDV_PATTERN_SAMPLES, n) * n +
           sdv_pattern_axis(a, wide_u, i % SDV_PATTERN_SAMPLES, n);
}
/* inked: of the samples; what is too small for a pixel keeps its tone. */
LAO_FN float sdv_pattern_ink(float inked, float dark, float wide_u, float wide_v) {
    LAO_EXACT float share = inked / LAO_F(SDV_PATTERN_SAMPLES * SDV_PATTERN_SAMPLES);
    LAO_EXACT float blur = lao_clamp01(2.5f * (wide_u + wide_v) - 0.75f);
    LAO_EXACT float r = share + blur * (dark - share);
    return r;
}
/* White that a style's ink and a depth shadow's lines, which go the other way, leave of a pixel.
   pattern: ink of SDV_STYLE_PATTERN. */
LAO_FN float sdv_style_paper(lao_int style, lao_v2 phase, float darkness, float shadow,
                             float wide_u, float wide_v, float finer, float pattern) {
    LAO_EXACT float lines = sdv_lines_ink(phase.x / LAO_TURN, lao_clamp01(shadow), wide_u);
    LAO_EXACT float left = 1.0f - lines;
    if (style == SDV_STYLE_PLAIN || style == SDV_STYLE_SHADOW) {
        return left;
    }
    float ink = pattern;
    if (style != SDV_STYLE_PATTERN) {
        ink = sdv_style_ink(style, phase.x, phase.y, darkness, wide_u, wide_v, finer);
    }
    LAO_EXACT float r = left * (1.0f - ink);
    return r;
}
/* Births and deaths of strokes and dots (which L19 5 leaves open). A place shows what its phases
   say, and a rest of what it showed before these changed; each frame lessens the rest by `step` of
   it. before: white by the recalled phases and the last frame's rest; now: by the new phases. As
   both move with the surface, only what a solution changed fades. */
LAO_FN float sdv_ink_rest(float before, float now, float step) {
    LAO_EXACT float r = (lao_clamp01(before) - now) * (1.0f - step);
    return lao_abs(r) < 0.004f ? 0.0f : r; /* below what a display shows */
}
/* What a head light leaves of white, without a highlight. */
LAO_FN float sdv_style_tone(float facing, float ambient, float diffuse, float light) {
    LAO_EXACT float r = (ambient + diffuse * lao_max(facing, 0.0f)) * light;
    return lao_clamp01(r);
}
/* What the void keeps of its ink where the ray passes a vessel at d_min mm: all beside it, nothing
   from `reach` mm on (0: no end, without a branch: see sdv_apart), and nothing where it is so steep
   that strokes would be grey. wide: periods per pixel. */
LAO_FN float sdv_void_share(float d_min, float reach, float wide) {
    LAO_EXACT float endless = lao_clamp01(1.0f - 1.0e6f * reach);
    LAO_EXACT float off = lao_max(d_min, 0.0f) / lao_max(reach, 1.0e-6f);
    LAO_EXACT float part = lao_clamp01(lao_max(1.0f - off, endless));
    LAO_EXACT float seen = lao_clamp01(2.0f - 2.0f * wide / SDV_HALO_FOOTPRINT);
    LAO_EXACT float r = seen * part * part * (3.0f - 2.0f * part);
    return r;
}
/* Red near, blue far (METHODS 6.1, RSH06). */
LAO_FN lao_v3 sdv_chromadepth(float depth) {
    float d = lao_clamp01(depth);
    return lao_v3_make(1.0f - d, 0.0f, d);
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

/* Number k of a vector. */
static float sdv__v3_at(lao_v3 v, uint32_t k) {
    return k == 0 ? v.x : k == 1 ? v.y : v.z;
}
static float sdv__v4_at(lao_v4 v, uint32_t k) {
    return k == 0 ? v.x : k == 1 ? v.y : k == 2 ? v.z : v.w;
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
        info->leaves += children == 0 && t->parents[i] != SDV_NONE;
        info->branches += children >= 2;
        info->multifurcations += children >= 3;
        info->max_children = children > info->max_children ? children : info->max_children;
        for (k = 0; k < 3; k++) {
            float v = sdv__v4_at(t->nodes[i], k);
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

/* ---- as a tree */
typedef struct sdv__drawing {
    const sdv_tree *tree;
    const sdv_reduced *reduced;
    const sdv_layout *layout;
    sdv_svg_desc page;
    float thin, widest; /* half thickness of the thinnest edge; greatest radius of a vessel, mm */
    float *positions, *radii;
    sdv_segment *segments;
    uint32_t node_count, segment_count;
} sdv__drawing;

static void sdv__drawing_put(sdv__drawing *d, uint32_t id, uint32_t node, lao_v2 at) {
    float part = d->widest > 0 ? lao_sqrt(d->tree->nodes[node].w / d->widest) : 0.0f;
    d->positions[3 * (size_t)id] = at.x;
    d->positions[3 * (size_t)id + 1] = d->page.height - at.y;
    d->positions[3 * (size_t)id + 2] = 0.0f;
    d->radii[id] = d->thin * (1.0f + 3.0f * part);
}
static void sdv__drawing_join(sdv__drawing *d, uint32_t parent, uint32_t child) {
    d->segments[d->segment_count].parent = parent;
    d->segments[d->segment_count++].child = child;
}
static float sdv__way(const sdv_tree *t, uint32_t node) {
    const lao_v4 *a = t->nodes + node, *b = t->nodes + t->parents[node];
    lao_v3 way = lao_v3_make(a->x - b->x, a->y - b->y, a->z - b->z);
    return lao_sqrt(lao_v3_dot(way, way));
}
/* The edge above a reduced node, from below, with all nodes of the tree on it. */
static void sdv__drawing_edge(sdv__drawing *d, uint32_t k) {
    const sdv_reduced *r = d->reduced;
    const sdv_tree *t = d->tree;
    uint32_t up = r->parents[k], node = r->nodes[k], end, count = 0, i;
    lao_v2 low = sdv__layout_place(d->layout, &d->page, k), top;
    float way = 0.0f, whole = 0.0f;
    if (up == SDV_NONE || r->ids[k] >= t->node_count) {
        sdv__drawing_put(d, r->ids[k], node, low);
        if (up != SDV_NONE) {
            sdv__drawing_join(d, r->ids[up], r->ids[k]);
        }
        return;
    }
    top = sdv__layout_place(d->layout, &d->page, up);
    end = r->nodes[up];
    for (; node != end; node = t->parents[node]) {
        whole += sdv__way(t, node);
        count++;
    }
    node = r->nodes[k];
    for (i = 0; i < count; i++, node = t->parents[node]) {
        float at = whole > 0.0f ? way / whole : (float)i / (float)count;
        sdv__drawing_put(d, node, node,
                         lao_v2_make(low.x + at * (top.x - low.x), low.y + at * (top.y - low.y)));
        sdv__drawing_join(d, t->parents[node] == end ? r->ids[up] : t->parents[node], node);
        way += sdv__way(t, node);
    }
}
/* The thinnest edge is a 200th of the page, less where edges are many, but never less than 2/5 of
   that. */
static void sdv__drawing_page(sdv__drawing *d, const sdv_drawing_desc *desc) {
    sdv_drawing_desc none = {0, 0, 0, 0};
    float unit, fits;
    uint32_t i;
    desc = desc ? desc : &none;
    d->page.radial = desc->radial;
    d->page.width = desc->width > 0 ? desc->width : desc->radial ? 150.0f : 200.0f;
    d->page.height = desc->height > 0 ? desc->height : desc->radial ? 150.0f : 100.0f;
    unit = lao_min(d->page.width, d->page.height) / 200.0f;
    fits = 0.35f * d->page.width / (float)d->reduced->node_count;
    d->thin = desc->thickness > 0 ? 0.5f * desc->thickness
                                  : lao_min(0.5f * unit, lao_max(fits, 0.2f * unit));
    for (i = 0; i < d->tree->node_count; i++) {
        d->widest = lao_max(d->widest, d->tree->nodes[i].w);
    }
}
SDV_API lao_result sdv_layout_tree(const sdv_host *host, const sdv_tree *tree,
                                   const sdv_reduced *reduced, const sdv_layout *layout,
                                   const sdv_drawing_desc *desc, sdv_tree *drawing) {
    lao_allocator a = sdv__allocator(host);
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    sdv__drawing d;
    sdv_tree_desc out;
    sdv_host silent;
    uint32_t k;
    if (!tree || !reduced || !layout || !drawing || !tree->memory || !reduced->memory ||
        !layout->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_layout_tree");
    }
    memset(&d, 0, sizeof d);
    memset(&out, 0, sizeof out);
    memset(&silent, 0, sizeof silent); /* edges of length 0 are none of the host's business */
    silent.allocator = a;
    d.tree = tree;
    d.reduced = reduced;
    d.layout = layout;
    d.node_count = tree->node_count;
    for (k = 0; k < reduced->node_count; k++) {
        d.node_count += reduced->ids[k] >= tree->node_count;
    }
    d.positions = (float *)sdv__take(&a, 3 * (uint64_t)d.node_count, sizeof *d.positions);
    d.radii = (float *)sdv__take(&a, d.node_count, sizeof *d.radii);
    d.segments = (sdv_segment *)sdv__take(&a, d.node_count, sizeof *d.segments);
    if (d.positions && d.radii && d.segments) {
        sdv__drawing_page(&d, desc);
        for (k = 0; k < reduced->node_count; k++) {
            sdv__drawing_edge(&d, k);
        }
        out.node_count = d.node_count;
        out.positions = d.positions;
        out.radii = d.radii;
        out.segment_count = d.segment_count;
        out.segments = d.segments;
        result = sdv_tree_build(&silent, &out, drawing);
    }
    sdv__give(&a, d.positions);
    sdv__give(&a, d.radii);
    sdv__give(&a, d.segments);
    return result == LAO_OK ? LAO_OK : sdv__fail(host, SDV_LOG_MEMORY, "drawing a layout");
}

/* ================================================================================================
 * jobs */

/* A piece of work in phases, for progress. */
typedef struct sdv__work {
    const sdv_host *host;
    uint64_t done, total; /* items of all phases */
} sdv__work;

typedef struct sdv__batch {
    void (*fn)(void *arg, uint32_t index);
    void *arg;
    uint32_t first;
} sdv__batch;

static void sdv__run_item(void *arg, uint32_t index) {
    const sdv__batch *b = (const sdv__batch *)arg;
    b->fn(b->arg, b->first + index);
}

/* fn(arg, 0 .. count - 1), as the host likes; progress after every 16. Non-zero: cancelled. */
static int sdv__run(sdv__work *work, uint32_t count, void (*fn)(void *arg, uint32_t index),
                    void *arg) {
    const lao_job *job = work->host ? &work->host->job : NULL;
    uint32_t first, i;
    for (first = 0; first < count; first += 16) {
        uint32_t n = count - first < 16 ? count - first : 16;
        sdv__batch batch;
        batch.fn = fn;
        batch.arg = arg;
        batch.first = first;
        if (job && job->run) {
            job->run(job->user, n, sdv__run_item, &batch);
        } else {
            for (i = 0; i < n; i++) {
                fn(arg, first + i);
            }
        }
        work->done += n;
        if (job && job->progress && job->progress(job->user, work->done, work->total)) {
            return 1;
        }
    }
    return 0;
}

/* ================================================================================================
 * grid */

enum { SDV__AXIS = SDV_AXIS };
#define SDV__EXACT 16777216u /* floats count to here */

static sdv_box sdv__grid_box(const sdv_grid *g) {
    sdv_box box;
    box.origin = g->origin;
    box.cell = g->cell;
    box.size = lao_v3_make((float)g->size[0], (float)g->size[1], (float)g->size[2]);
    return box;
}
static size_t sdv__row(const sdv_grid *g, uint32_t y, uint32_t z) {
    return (size_t)g->size[0] * (y + (size_t)g->size[1] * z);
}
static size_t sdv__layer_size(const sdv_grid *g) {
    return (size_t)g->size[0] * g->size[1];
}
/* ---- which cells list something: a bit each, words along x */
static uint32_t sdv__parts(uint32_t n, uint32_t size) {
    return (n + size - 1) / size;
}
static uint32_t sdv__words(const sdv_grid *g) {
    return sdv__parts(g->size[0], 32);
}
/* row: y + size[1] z */
static uint32_t *sdv__bits(const sdv_grid *g, size_t row) {
    return g->occupied + sdv__words(g) * row;
}
/* The first bit from x on that is set; `end`: none before it. */
static uint32_t sdv__next_bit(const uint32_t *bits, uint32_t x, uint32_t end) {
    while (x < end) {
        uint32_t word = bits[x / 32] >> (x % 32);
        if (word & 1u) {
            return x;
        }
        x = word ? x + 1 : (x | 31u) + 1;
    }
    return end;
}

/* ---- the box */
static void sdv__ball_bounds(const lao_v4 *balls, uint32_t count, double low[3], double high[3]) {
    uint32_t i, k;
    for (i = 0; i < count; i++) {
        for (k = 0; k < 3; k++) {
            double p = (double)sdv__v4_at(balls[i], k);
            double a = p - (double)balls[i].w, b = p + (double)balls[i].w;
            low[k] = i == 0 || a < low[k] ? a : low[k];
            high[k] = i == 0 || b > high[k] ? b : high[k];
        }
    }
}
/* The array of a node attribute, where it has so many components. */
static const float *sdv__node_values(const sdv_tree *tree, const char *name, uint32_t components) {
    uint32_t i;
    for (i = 0; i < tree->node_attribute_count; i++) {
        const sdv_attribute *a = &tree->node_attributes[i];
        if (strcmp(a->name, name) == 0 && (a->components ? a->components : 1) == components) {
            return a->values;
        }
    }
    return NULL;
}
/* Of the noise at a node, mm. */
static float sdv__amplitude(const sdv_tree *tree, uint32_t node) {
    const float *values = sdv__node_values(tree, SDV_UNCERTAINTY, 1);
    float v = values ? values[node] : 0.0f;
    return v > 0.0f ? lao_min(v, 0.75f * tree->nodes[node].w) : 0.0f;
}
static float sdv__ratio(const float *ratios, uint32_t node) {
    float r = ratios ? ratios[node] : 1.0f;
    return r > 0.0f ? lao_min(lao_max(r, 0.1f), 1.0f) : 1.0f;
}
/* The greatest amplitude of all nodes, mm. */
static float sdv__most_amplitude(const sdv_tree *tree) {
    float most = 0.0f;
    uint32_t i;
    for (i = 0; i < tree->node_count && sdv__node_values(tree, SDV_UNCERTAINTY, 1); i++) {
        most = lao_max(most, sdv__amplitude(tree, i));
    }
    return most;
}
static bool sdv__has_forms(const sdv_tree *tree) {
    const float *ratios = sdv__node_values(tree, SDV_SECTION_RATIO, 1);
    uint32_t i;
    for (i = 0; i < tree->node_count && ratios; i++) {
        if (sdv__ratio(ratios, i) < 1.0f) {
            return true;
        }
    }
    return sdv__most_amplitude(tree) > 0.0f;
}
static void sdv__tree_bounds(const sdv_tree *tree, double low[3], double high[3]) {
    double most = (double)sdv__most_amplitude(tree);
    uint32_t i;
    sdv__ball_bounds(tree->nodes, tree->node_count, low, high);
    for (i = 0; i < 3; i++) {
        low[i] -= most;
        high[i] += most;
    }
}
/* Cubic cells around all balls, and two more at every side. */
static int sdv__grid_fit(const sdv_tree *tree, uint32_t resolution, sdv_grid *g) {
    double low[3], high[3], most = 0;
    float origin[3];
    uint32_t k;
    if (resolution < 16 || resolution > SDV__AXIS) {
        return 0;
    }
    sdv__tree_bounds(tree, low, high);
    for (k = 0; k < 3; k++) {
        most = high[k] - low[k] > most ? high[k] - low[k] : most;
    }
    g->cell = most > 0 ? (float)(most / (double)(resolution - 4) * (1 + 1e-6)) : 1.0f;
    g->cell = g->cell > 0.0f ? g->cell : 1.0f;
    for (k = 0; k < 3; k++) {
        g->size[k] = (uint32_t)ceil((high[k] - low[k]) / (double)g->cell) + 4;
        origin[k] = (float)(0.5 * (low[k] + high[k]) - 0.5 * (double)g->size[k] * (double)g->cell);
    }
    g->origin = lao_v3_make(origin[0], origin[1], origin[2]);
    return 1;
}
static int sdv__grid_frame(const sdv_tree *tree, const sdv_grid_desc *desc, sdv_grid *g) {
    uint32_t k;
    double cells = 1;
    if (desc->origin) {
        g->origin = lao_v3_make(desc->origin[0], desc->origin[1], desc->origin[2]);
        g->cell = desc->cell;
        memcpy(g->size, desc->size, sizeof g->size);
    } else if (!sdv__grid_fit(tree, desc->resolution ? desc->resolution : 128, g)) {
        return 0;
    }
    for (k = 0; k < 3; k++) {
        cells *= (double)g->size[k];
        if (g->size[k] < 1 || g->size[k] > SDV__AXIS) {
            return 0;
        }
    }
    if (!(cells <= SDV__EXACT && g->cell > 0.0f && g->cell < 1e30f)) {
        return 0;
    }
    g->cell_count = (uint32_t)cells;
    return 1;
}
/* Are all balls inside the box? */
static int sdv__grid_holds(const sdv_grid *g, const sdv_tree *tree) {
    double low[3], high[3];
    uint32_t k;
    sdv__tree_bounds(tree, low, high);
    for (k = 0; k < 3; k++) {
        double origin = (double)sdv__v3_at(g->origin, k);
        double end = origin + (double)g->size[k] * (double)g->cell;
        if (!(low[k] >= origin && high[k] <= end)) {
            return 0;
        }
    }
    return 1;
}

/* ---- cones */
static int sdv__is_lone(const sdv_tree *tree, uint32_t node) {
    return tree->parents[node] == SDV_NONE && tree->child_counts[node] == 0;
}
static uint32_t sdv__lone_count(const sdv_tree *tree) {
    uint32_t i, n = 0;
    for (i = 0; i < tree->node_count; i++) {
        n += (uint32_t)sdv__is_lone(tree, i);
    }
    return n;
}
static void sdv__cone_set(const sdv_tree *tree, const uint32_t *nodes, lao_v4 *cone) {
    uint32_t k;
    for (k = 0; k < 2; k++) {
        cone[k] = tree->nodes[nodes[k]];
        cone[k].w += sdv__amplitude(tree, nodes[k]);
    }
}
/* ---- forms */
static lao_v3 sdv__minor(const float *axes, uint32_t node) {
    const lao_v3 z = lao_v3_make(0.0f, 0.0f, 1.0f);
    const float *v;
    if (!axes) {
        return z;
    }
    v = axes + 3 * (size_t)node;
    return lao_v3_unit(lao_v3_make(v[0], v[1], v[2]), z);
}
/* Of every node: its shorter axis, turned to a right angle to the mean of its cones, so that cones
   that meet there have the same ellipsoid. */
static void sdv__sections_fill(const sdv_tree *tree, sdv_grid *g) {
    const float *ratios = sdv__node_values(tree, SDV_SECTION_RATIO, 1);
    const float *axes = sdv__node_values(tree, SDV_SECTION_AXIS, 3);
    uint32_t i;
    memset(g->sections, 0, tree->node_count * sizeof *g->sections);
    for (i = 0; i < 2 * g->cone_count; i++) {
        const lao_v4 *cone = g->cones + 2 * (size_t)(i / 2);
        lao_v4 *node = &g->sections[g->cone_nodes[i]];
        lao_v3 along = lao_v3_unit(
            lao_v3_make(cone[1].x - cone[0].x, cone[1].y - cone[0].y, cone[1].z - cone[0].z),
            lao_v3_make(0.0f, 0.0f, 0.0f));
        *node = lao_v4_make(node->x + along.x, node->y + along.y, node->z + along.z, 0.0f);
    }
    for (i = 0; i < tree->node_count; i++) {
        lao_v3 along = lao_v3_make(g->sections[i].x, g->sections[i].y, g->sections[i].z);
        lao_v3 m = sdv__minor(axes, i);
        float size = lao_v3_dot(along, along);
        if (size > 0.0f) {
            m = lao_v3_along(m, along, -lao_v3_dot(m, along) / size);
        }
        m = lao_v3_unit(m, sdv_perpendicular(along));
        g->sections[i] = lao_v4_make(m.x, m.y, m.z, 1.0f / sdv__ratio(ratios, i) - 1.0f);
    }
}
/* The mean radius, and no less than twice the greatest amplitude: steeper bumps come off. */
static float sdv__bump_size(const sdv_tree *tree) {
    double sum = 0;
    uint32_t i, n = 0;
    if (tree->bump_size > 0.0f && tree->bump_size < SDV_FAR) {
        return tree->bump_size;
    }
    for (i = 0; i < tree->node_count; i++) {
        if (sdv__amplitude(tree, i) > 0.0f) {
            sum += (double)tree->nodes[i].w;
            n++;
        }
    }
    return n ? lao_max((float)(sum / n), 2.0f * sdv__most_amplitude(tree)) : 1.0f;
}
/* How much sdv_form_level rises per mm at most where it is below sdv_form_most: by what space is
   stretched, by the change of section (times how far the place then is from the nearest ball's
   centre) and of amplitude (under noise of up to 2) along the cone, and by the noise. */
static float sdv__form_rise(const lao_v4 *cone, double length, const sdv_form *form) {
    double c = (double)lao_v3_dot(lao_v3_make(form->a.x, form->a.y, form->a.z),
                                  lao_v3_make(form->b.x, form->b.y, form->b.z));
    double a = (double)form->a.w, b = (double)form->b.w, half = 0.5 * (a + b);
    double turn = 0.5 * fabs(a - b) + sqrt(fmax(half * half - a * b * c * c, 0));
    double reach = (double)(lao_max(cone[0].w, cone[1].w) + sdv_form_most(cone[0], cone[1], *form));
    double steep = (double)(lao_max(form->bump.x, form->bump.y) * form->bump.w * SDV_NOISE_SLOPE);
    double rise = 1 + fmax(a, b) + steep;
    if (length > 0) {
        rise += (turn * reach + 2 * fabs((double)(form->bump.x - form->bump.y))) / length;
    }
    return (float)(rise * (1 + 1e-5));
}
static sdv_form sdv__form(const sdv_tree *tree, const sdv_grid *g, uint32_t i, float size) {
    const lao_v4 *cone = g->cones + 2 * (size_t)i;
    uint32_t a = g->cone_nodes[2 * (size_t)i], b = g->cone_nodes[2 * (size_t)i + 1];
    double x = (double)cone[1].x - (double)cone[0].x, y = (double)cone[1].y - (double)cone[0].y;
    double z = (double)cone[1].z - (double)cone[0].z, s = sqrt(x * x + y * y + z * z);
    sdv_form form;
    if (s <= fabs((double)(cone[0].w - cone[1].w))) { /* one ball holds the other: that alone */
        a = cone[0].w < cone[1].w ? b : a;
        b = a;
    }
    form.a = g->sections[a];
    form.b = g->sections[b];
    form.bump = lao_v4_make(sdv__amplitude(tree, a), sdv__amplitude(tree, b), 1.0f, 1.0f / size);
    form.bump.z = sdv__form_rise(cone, s, &form);
    return form;
}
static sdv_form sdv__form_of(const sdv_grid *g, float cone) {
    const lao_v4 *f = g->forms + 3 * (size_t)cone;
    sdv_form form;
    form.a = f[0];
    form.b = f[1];
    form.bump = f[2];
    return form;
}
static void sdv__forms_fill(const sdv_tree *tree, sdv_grid *g) {
    uint32_t i;
    float size;
    if (!g->forms) {
        return;
    }
    size = sdv__bump_size(tree);
    sdv__sections_fill(tree, g);
    for (i = 0; i < g->cone_count; i++) {
        sdv_form form = sdv__form(tree, g, i, size);
        lao_v4 *to = g->forms + 3 * (size_t)i;
        to[0] = form.a;
        to[1] = form.b;
        to[2] = form.bump;
    }
}
/* Memory for cones, with forms behind them where the tree has any. */
static void sdv__cones_take(const sdv_tree *tree, sdv_grid *g) {
    uint64_t texels = 2 * (uint64_t)g->cone_count;
    uint64_t forms = sdv__has_forms(tree) ? 3 * (uint64_t)g->cone_count : 0;
    uint64_t sections = forms ? tree->node_count : 0;
    g->cones = (lao_v4 *)sdv__take(&g->allocator, texels + forms + sections, sizeof *g->cones);
    g->forms = g->cones && forms ? g->cones + texels : NULL;
    g->sections = g->forms ? g->forms + forms : NULL;
    g->cone_nodes = (uint32_t *)sdv__take(&g->allocator, texels, sizeof *g->cone_nodes);
}
static void sdv__cones_fill(const sdv_tree *tree, sdv_grid *g) {
    uint32_t i, n = tree->segment_count;
    for (i = 0; i < n; i++) {
        g->cone_nodes[2 * (size_t)i] = tree->segments[i].parent;
        g->cone_nodes[2 * (size_t)i + 1] = tree->segments[i].child;
    }
    for (i = 0; i < tree->node_count; i++) {
        if (sdv__is_lone(tree, i)) {
            g->cone_nodes[2 * (size_t)n] = i;
            g->cone_nodes[2 * (size_t)n + 1] = i;
            n++;
        }
    }
    for (i = 0; i < n; i++) {
        sdv__cone_set(tree, g->cone_nodes + 2 * (size_t)i, g->cones + 2 * (size_t)i);
    }
    sdv__forms_fill(tree, g);
}

/* ---- which cells a cone may be listed in: plane by plane, row by row. The balls of a cone have
   centre a + t (b - a) and radius ra + t (rb - ra); those that reach a plane across an axis have t
   in an interval. */
typedef struct sdv__raster {
    double a[3], b[3], ra, rb; /* radii with the reach of lists and a margin for rounding */
} sdv__raster;

static sdv__raster sdv__raster_make(const sdv_grid *g, const lao_v4 *cone) {
    sdv__raster r;
    double reach = (double)sdv_list_reach(g->cell) + 0.02 * (double)g->cell;
    uint32_t k;
    for (k = 0; k < 3; k++) {
        r.a[k] = (double)sdv__v4_at(cone[0], k);
        r.b[k] = (double)sdv__v4_at(cone[1], k);
        reach += 1e-6 * (fabs(r.a[k]) + fabs(r.b[k]) + fabs((double)sdv__v3_at(g->origin, k)));
    }
    r.ra = (double)cone[0].w * (1 + 1e-6) + reach;
    r.rb = (double)cone[1].w * (1 + 1e-6) + reach;
    return r;
}
/* Narrows t to the balls that reach the plane `at` across an axis; 0: none. */
static int sdv__raster_cut(const sdv__raster *r, int axis, double at, double t[2]) {
    double d = r->b[axis] - r->a[axis], dr = r->rb - r->ra, from = r->a[axis] - at;
    double slope[2], value[2];
    int i;
    slope[0] = d - dr; /* centre - at <= radius */
    value[0] = r->ra - from;
    slope[1] = -d - dr; /* at - centre <= radius */
    value[1] = r->ra + from;
    for (i = 0; i < 2; i++) {
        double limit = value[i] / slope[i];
        if (slope[i] > 0) {
            t[1] = limit < t[1] ? limit : t[1];
        } else if (slope[i] < 0) {
            t[0] = limit > t[0] ? limit : t[0];
        } else if (value[i] < 0) {
            return 0;
        }
    }
    return t[0] <= t[1];
}
/* Cells of an axis that the balls of t may reach: range[0] .. range[1] - 1. */
static void sdv__raster_range(const sdv_grid *g, const sdv__raster *r, int axis, const double t[2],
                              uint32_t range[2]) {
    double low = 0, high = 0, origin = (double)sdv__v3_at(g->origin, (uint32_t)axis),
           n = (double)g->size[axis];
    int i;
    for (i = 0; i < 2; i++) {
        double c = r->a[axis] + t[i] * (r->b[axis] - r->a[axis]);
        double radius = r->ra + t[i] * (r->rb - r->ra);
        low = i == 0 || c - radius < low ? c - radius : low;
        high = i == 0 || c + radius > high ? c + radius : high;
    }
    low = ceil((low - origin) / (double)g->cell - 0.5); /* centres within */
    high = floor((high - origin) / (double)g->cell - 0.5) + 1;
    range[0] = low > 0 ? (low < n ? (uint32_t)low : g->size[axis]) : 0;
    range[1] = high > 0 ? (high < n ? (uint32_t)high : g->size[axis]) : 0;
}
static double sdv__plane(const sdv_grid *g, int axis, uint32_t i) {
    return (double)sdv__v3_at(g->origin, (uint32_t)axis) + ((double)i + 0.5) * (double)g->cell;
}
/* Calls visit(arg, cell, centre) for every cell of layer z that the cone may be listed in. */
typedef void (*sdv__visitor)(void *arg, uint32_t cell, lao_v3 centre);
static void sdv__raster_layer(const sdv_grid *g, const lao_v4 *cone, uint32_t z, sdv__visitor visit,
                              void *arg) {
    sdv__raster r = sdv__raster_make(g, cone);
    sdv_box box = sdv__grid_box(g);
    double t[2] = {0, 1};
    uint32_t rows[2], y, x;
    if (!sdv__raster_cut(&r, 2, sdv__plane(g, 2, z), t)) {
        return;
    }
    sdv__raster_range(g, &r, 1, t, rows);
    for (y = rows[0]; y < rows[1]; y++) {
        double u[2];
        uint32_t columns[2];
        u[0] = t[0];
        u[1] = t[1];
        if (!sdv__raster_cut(&r, 1, sdv__plane(g, 1, y), u)) {
            continue;
        }
        sdv__raster_range(g, &r, 0, u, columns);
        for (x = columns[0]; x < columns[1]; x++) {
            visit(arg, (uint32_t)sdv__row(g, y, z) + x, sdv_cell_centre(box, x, y, z));
        }
    }
}
static void sdv__raster_layers(const sdv_grid *g, const lao_v4 *cone, uint32_t range[2]) {
    sdv__raster r = sdv__raster_make(g, cone);
    const double t[2] = {0, 1};
    sdv__raster_range(g, &r, 2, t, range);
}
static int sdv__is_listed(const sdv_grid *g, lao_v3 centre, const lao_v4 *cone) {
    return sdv_round_cone(centre, cone[0], cone[1]) <= sdv_list_reach(g->cell);
}

/* ---- lists: counted, then filled, layer by layer; cones come in ascending order */
typedef struct sdv__fill {
    sdv_grid *grid;
    const uint32_t *first, *binned; /* cones of each layer, ascending */
    uint64_t *layer_ids;            /* entries of each layer; later where they begin */
    uint32_t cone;
} sdv__fill;

static void sdv__count_cell(void *arg, uint32_t cell, lao_v3 centre) {
    sdv__fill *f = (sdv__fill *)arg;
    sdv_grid *g = f->grid;
    if (sdv__is_listed(g, centre, g->cones + 2 * (size_t)f->cone)) {
        g->cells[cell].w += 1.0f;
    }
}
static void sdv__fill_cell(void *arg, uint32_t cell, lao_v3 centre) {
    sdv__fill *f = (sdv__fill *)arg;
    sdv_grid *g = f->grid;
    if (sdv__is_listed(g, centre, g->cones + 2 * (size_t)f->cone)) {
        lao_v4 *c = g->cells + cell;
        g->ids[(size_t)c->z + (size_t)c->x] = (float)f->cone;
        c->x += 1.0f;
    }
}
static void sdv__raster_binned(const sdv__fill *f, uint32_t z, sdv__visitor visit) {
    sdv__fill own = *f;
    uint32_t i;
    for (i = f->first[z]; i < f->first[z + 1]; i++) {
        own.cone = f->binned[i];
        sdv__raster_layer(own.grid, own.grid->cones + 2 * (size_t)own.cone, z, visit, &own);
    }
}
static void sdv__count_layer(void *arg, uint32_t z) {
    sdv__fill *f = (sdv__fill *)arg;
    const sdv_grid *g = f->grid;
    lao_v4 *cells = g->cells + sdv__row(g, 0, z);
    size_t i, n = sdv__layer_size(g), rows = (size_t)g->size[1] * z;
    uint64_t sum = 0;
    memset(cells, 0, n * sizeof *cells);
    sdv__raster_binned(f, z, sdv__count_cell);
    memset(sdv__bits(g, rows), 0, sizeof(uint32_t) * sdv__words(g) * g->size[1]);
    for (i = 0; i < n; i++) {
        if (cells[i].w > 0.0f) {
            uint32_t x = (uint32_t)(i % g->size[0]);
            sdv__bits(g, rows + i / g->size[0])[x / 32] |= 1u << (x % 32);
            sum += (uint32_t)cells[i].w;
        }
    }
    f->layer_ids[z] = sum;
}

/* ---- nearest occupied cells: exact, separable, ties to the lowest index (METHODS 5.2) */
/* Lower envelope of parabolas apart[u] + (x - u)^2 in integers (Meijster 2000): ties to the lower
   u. apart < 0: no parabola. */
typedef struct sdv__envelope {
    int32_t place[SDV__AXIS], until[SDV__AXIS]; /* winners and the last x where they win */
    int32_t count;
} sdv__envelope;
static void sdv__envelope_make(sdv__envelope *e, const int32_t *apart, int32_t n) {
    int32_t u;
    e->count = 0;
    for (u = 0; u < n; u++) {
        int32_t until = -1;
        if (apart[u] < 0) {
            continue;
        }
        while (e->count > 0) { /* up to where does the last winner win against u? */
            int32_t i = e->place[e->count - 1];
            int32_t start = e->count > 1 ? e->until[e->count - 2] + 1 : 0;
            int32_t top = u * u - i * i + apart[u] - apart[i], bottom = 2 * (u - i);
            until = top >= 0 ? top / bottom : -((-top + bottom - 1) / bottom);
            if (until >= start) {
                break;
            }
            e->count--;
        }
        if (e->count > 0 && until >= n - 1) {
            continue;
        }
        if (e->count > 0) {
            e->until[e->count - 1] = until;
        }
        e->place[e->count] = u;
        e->until[e->count++] = n - 1;
    }
}

/* The nearest occupied x of each x of a row, of two as near the lower; SDV_NONE: none. */
static void sdv__row_nearest(const uint32_t *bits, uint32_t nx, uint32_t *row) {
    uint32_t x = 0, last = SDV_NONE, next = sdv__next_bit(bits, 0, nx);
    while (next < nx) {
        uint32_t until = last == SDV_NONE ? 0 : (last + next) / 2 + 1;
        for (; x < until; x++) {
            row[x] = last;
        }
        for (; x <= next; x++) {
            row[x] = next;
        }
        last = next;
        next = sdv__next_bit(bits, next + 1, nx);
    }
    for (; x < nx; x++) {
        row[x] = last;
    }
}
static void sdv__layer_rows(const sdv_grid *g, uint32_t z, uint32_t *rows) {
    uint32_t y;
    for (y = 0; y < g->size[1]; y++) {
        sdv__row_nearest(sdv__bits(g, y + (size_t)g->size[1] * z), g->size[0],
                         rows + (size_t)g->size[0] * y);
    }
}
/* What a cell keeps to be found anew in a change. */
enum { SDV__LISTED = 1, SDV__NEARER = 2, SDV__TURNED = 4 }; /* its list, nearest cell, `layer` */
/* From the rows x + 65536 y of the nearest occupied cell of the layer. `wanted` (Optional): the x
   that need it; `stale` (Optional): gets SDV__TURNED where that is news. */
static void sdv__layer_columns(const sdv_grid *g, const uint32_t *rows, const unsigned char *wanted,
                               uint32_t *out, unsigned char *stale) {
    uint32_t x, y, nx = g->size[0], ny = g->size[1];
    for (x = 0; x < nx; x++) {
        int32_t apart[SDV__AXIS], k = 0;
        uint32_t best[SDV__AXIS];
        sdv__envelope e;
        if (wanted && !wanted[x]) {
            continue;
        }
        for (y = 0; y < ny; y++) {
            int32_t d = (int32_t)rows[(size_t)nx * y + x] - (int32_t)x;
            best[y] = rows[(size_t)nx * y + x];
            apart[y] = best[y] == SDV_NONE ? -1 : d * d;
        }
        sdv__envelope_make(&e, apart, (int32_t)ny);
        for (y = 0; y < ny; y++) {
            uint32_t value = SDV_NONE;
            if (e.count > 0) {
                k += (int32_t)y > e.until[k];
                value = best[e.place[k]] + 65536 * (uint32_t)e.place[k];
            }
            if (stale && out[(size_t)nx * y + x] != value) {
                stale[(size_t)nx * y + x] |= SDV__TURNED;
            }
            out[(size_t)nx * y + x] = value;
        }
    }
}
static void sdv__fill_layer(void *arg, uint32_t z) {
    sdv__fill *f = (sdv__fill *)arg;
    sdv_grid *g = f->grid;
    size_t i, first = sdv__row(g, 0, z), n = sdv__layer_size(g);
    uint64_t at = f->layer_ids[z];
    for (i = first; i < first + n; i++) {
        g->cells[i].z = (float)at;
        at += (uint32_t)g->cells[i].w;
    }
    sdv__raster_binned(f, z, sdv__fill_cell);
    sdv__layer_rows(g, z, g->layer + first);
    sdv__layer_columns(g, g->layer + first, NULL, g->layer + first, NULL);
}

/* The nearest occupied cell of a cell, `apart2` cells squared away. `stale` (Optional): gets
   SDV__NEARER where that is news. */
static void sdv__nearest_write(sdv_grid *g, size_t cell, size_t nearest, int32_t apart2,
                               unsigned char *stale) {
    lao_v4 *c = g->cells + cell;
    if (stale) {
        if (c->y == (float)nearest) {
            return;
        }
        stale[cell] |= SDV__NEARER;
    }
    c->y = (float)nearest;
    if (!(c->w > 0.0f)) {
        c->z = sdv_far_step(lao_sqrt((float)apart2) * g->cell, g->cell);
    }
}
/* Columns along z at one y, 16 at a time: the nearest of all layers' nearest. `wanted`, `layers`
   (Optional): the columns and the z that need it. */
enum { SDV__WIDE = 16 };
static void sdv__column(sdv_grid *g, uint32_t x, uint32_t y, const uint32_t *best,
                        const unsigned char *layers, unsigned char *stale) {
    int32_t apart[SDV__AXIS], k = 0;
    sdv__envelope e;
    uint32_t z, nz = g->size[2];
    for (z = 0; z < nz; z++) {
        uint32_t cell = best[(size_t)z * SDV__WIDE];
        int32_t dx = (int32_t)(cell & 65535u) - (int32_t)x;
        int32_t dy = (int32_t)(cell >> 16) - (int32_t)y;
        apart[z] = cell == SDV_NONE ? -1 : dx * dx + dy * dy;
    }
    sdv__envelope_make(&e, apart, (int32_t)nz);
    for (z = 0; z < nz && e.count > 0; z++) {
        int32_t winner, dz;
        uint32_t cell;
        k += (int32_t)z > e.until[k];
        if (layers && !layers[z]) {
            continue;
        }
        winner = e.place[k];
        dz = winner - (int32_t)z;
        cell = best[(size_t)winner * SDV__WIDE];
        sdv__nearest_write(g, sdv__row(g, y, z) + x,
                           sdv__row(g, cell >> 16, (uint32_t)winner) + (cell & 65535u),
                           apart[winner] + dz * dz, stale);
    }
}
static void sdv__columns(sdv_grid *g, uint32_t x0, uint32_t y, const unsigned char *wanted,
                         const unsigned char *layers, unsigned char *stale) {
    uint32_t best[SDV__AXIS * SDV__WIDE], i, z;
    uint32_t wide = g->size[0] - x0 < SDV__WIDE ? g->size[0] - x0 : (uint32_t)SDV__WIDE;
    for (z = 0; z < g->size[2]; z++) {
        memcpy(best + (size_t)z * SDV__WIDE, g->layer + sdv__row(g, y, z) + x0,
               wide * sizeof *best);
    }
    for (i = 0; i < wide; i++) {
        if (!wanted || wanted[i]) {
            sdv__column(g, x0 + i, y, best + i, layers, stale);
        }
    }
}
static void sdv__column_slab(void *arg, uint32_t y) {
    sdv_grid *g = ((sdv__fill *)arg)->grid;
    uint32_t x0;
    for (x0 = 0; x0 < g->size[0]; x0 += SDV__WIDE) {
        sdv__columns(g, x0, y, NULL, NULL, NULL);
    }
}

/* ---- distances */
/* Of p to the cones of a cell's list. */
static float sdv__list_distance(const sdv_grid *g, const lao_v4 *cell, lao_v3 p, uint32_t *cone) {
    const float *ids = g->ids + (size_t)cell->z;
    uint32_t i, n = (uint32_t)cell->w;
    float least = SDV_FAR;
    for (i = 0; i < n; i++) {
        const lao_v4 *c = g->cones + 2 * (size_t)ids[i];
        float d = sdv_round_cone(p, c[0], c[1]);
        if (d < least) {
            least = d;
            *cone = (uint32_t)ids[i];
        }
    }
    return least;
}
/* Of the cells' centres to the list of their nearest occupied cell. */
static void sdv__refine_layer(void *arg, uint32_t z) {
    const sdv_grid *g = ((const sdv__fill *)arg)->grid;
    sdv_box box = sdv__grid_box(g);
    uint32_t x, y, cone;
    for (y = 0; y < g->size[1]; y++) {
        lao_v4 *row = g->cells + sdv__row(g, y, z);
        for (x = 0; x < g->size[0]; x++) {
            row[x].x = sdv__list_distance(g, g->cells + (size_t)row[x].y,
                                          sdv_cell_centre(box, x, y, z), &cone);
        }
    }
}

/* ---- building */
/* Cones of each layer, ascending. NULL: no memory. `first` has size[2] + 1 entries. */
static uint32_t *sdv__bin_cones(const sdv_grid *g, uint32_t *first) {
    uint32_t i, z, range[2], *binned;
    uint64_t sum = 0;
    memset(first, 0, (g->size[2] + 1) * sizeof *first);
    for (i = 0; i < g->cone_count; i++) {
        sdv__raster_layers(g, g->cones + 2 * (size_t)i, range);
        for (z = range[0]; z < range[1]; z++) {
            first[z]++;
        }
    }
    for (z = 0; z <= g->size[2]; z++) {
        uint32_t n = first[z];
        first[z] = (uint32_t)sum;
        sum += n;
    }
    binned = sum < SDV_NONE ? (uint32_t *)sdv__take(&g->allocator, sum, sizeof *binned) : NULL;
    for (i = 0; binned && i < g->cone_count; i++) {
        sdv__raster_layers(g, g->cones + 2 * (size_t)i, range);
        for (z = range[0]; z < range[1]; z++) { /* first = the next free place, */
            binned[first[z]++] = i;
        }
    }
    for (z = g->size[2]; binned && z > 0; z--) { /* and back */
        first[z] = first[z - 1];
    }
    first[0] = 0;
    return binned;
}

/* Entries of the layers to where they begin; returns the sum. */
static uint64_t sdv__layer_starts(const sdv_grid *g, uint64_t *layer_ids) {
    uint64_t sum = 0;
    uint32_t z;
    for (z = 0; z < g->size[2]; z++) {
        uint64_t n = layer_ids[z];
        layer_ids[z] = sum;
        sum += n;
    }
    return sum;
}

/* Fills the cells of a grid whose box, cones and memory are there. */
static lao_result sdv__grid_fill(sdv__work *work, sdv_grid *g, uint32_t *first,
                                 uint64_t *layer_ids) {
    const sdv_host *host = work->host;
    uint32_t *binned = sdv__bin_cones(g, first);
    uint64_t sum = 0;
    int cancelled;
    sdv__fill f;
    if (!binned) {
        return sdv__fail(host, SDV_LOG_MEMORY, "the cones of a grid's layers");
    }
    f.grid = g;
    f.first = first;
    f.binned = binned;
    f.layer_ids = layer_ids;
    f.cone = 0;
    cancelled = sdv__run(work, g->size[2], sdv__count_layer, &f);
    if (!cancelled) {
        sum = sdv__layer_starts(g, layer_ids);
        g->id_count = g->id_room = (uint32_t)sum;
        g->ids = sum <= SDV__EXACT ? (float *)sdv__take(&g->allocator, sum, sizeof *g->ids) : NULL;
    }
    if (g->ids) {
        cancelled = sdv__run(work, g->size[2], sdv__fill_layer, &f) ||
                    sdv__run(work, g->size[1], sdv__column_slab, &f) ||
                    sdv__run(work, g->size[2], sdv__refine_layer, &f);
    }
    sdv__give(&g->allocator, binned);
    if (cancelled) {
        return sdv__fail(host, SDV_LOG_CANCELLED, "building a grid");
    }
    if (sum > SDV__EXACT) {
        return sdv__fail(host, SDV_LOG_GRID_LISTS, "%llu entries", (unsigned long long)sum);
    }
    return g->ids ? LAO_OK
                  : sdv__fail(host, SDV_LOG_MEMORY, "a grid's %u list entries", g->id_count);
}

SDV_API lao_result sdv_grid_build(const sdv_host *host, const sdv_tree *tree,
                                  const sdv_grid_desc *desc, sdv_grid *grid) {
    sdv_grid_desc standard;
    sdv_grid g;
    sdv__work work;
    uint32_t *first;
    uint64_t *layer_ids;
    lao_result result;
    memset(&standard, 0, sizeof standard);
    memset(&g, 0, sizeof g);
    if (!tree || !grid || !tree->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_grid_build");
    }
    g.cone_count = tree->segment_count + sdv__lone_count(tree);
    if (g.cone_count > SDV__EXACT) {
        return sdv__fail(host, SDV_LOG_GRID_LISTS, "%u segments", g.cone_count);
    }
    if (!sdv__grid_frame(tree, desc ? desc : &standard, &g)) {
        return sdv__fail(host, SDV_LOG_GRID_CELLS, "%u x %u x %u", g.size[0], g.size[1], g.size[2]);
    }
    g.allocator = sdv__allocator(host);
    g.cells = (lao_v4 *)sdv__take(&g.allocator, g.cell_count, sizeof *g.cells);
    g.layer = (uint32_t *)sdv__take(&g.allocator, g.cell_count, sizeof *g.layer);
    g.occupied = (uint32_t *)sdv__take(
        &g.allocator, (uint64_t)sdv__words(&g) * g.size[1] * g.size[2], sizeof *g.occupied);
    sdv__cones_take(tree, &g);
    first = (uint32_t *)sdv__take(&g.allocator, SDV__AXIS + 1, sizeof *first);
    layer_ids = (uint64_t *)sdv__take(&g.allocator, SDV__AXIS, sizeof *layer_ids);
    if (g.cells && g.layer && g.occupied && g.cones && g.cone_nodes && first && layer_ids) {
        work.host = host;
        work.done = 0;
        work.total = 3 * (uint64_t)g.size[2] + g.size[1];
        sdv__cones_fill(tree, &g);
        result = sdv__grid_fill(&work, &g, first, layer_ids);
    } else {
        result = sdv__fail(host, SDV_LOG_MEMORY, "a grid of %u cells and %u cones", g.cell_count,
                           g.cone_count);
    }
    sdv__give(&g.allocator, first);
    sdv__give(&g.allocator, layer_ids);
    if (result != LAO_OK) {
        sdv_grid_free(&g);
        return result;
    }
    *grid = g;
    return LAO_OK;
}

SDV_API void sdv_grid_free(sdv_grid *grid) {
    if (grid && grid->allocator.release) {
        sdv__give(&grid->allocator, grid->cells);
        sdv__give(&grid->allocator, grid->layer);
        sdv__give(&grid->allocator, grid->occupied);
        sdv__give(&grid->allocator, grid->ids);
        sdv__give(&grid->allocator, grid->cones);
        sdv__give(&grid->allocator, grid->cone_nodes);
        memset(grid, 0, sizeof *grid);
    }
}

/* ---- changing */
/* Cells whose lists change are found, lists are moved up and down in place, what is nearest is
   found anew in the layers whose occupied cells change, and in those columns along z where that
   matters. Blocks of cells that are nearer to others than to all that changes are left out from the
   start. */
#define SDV__BLOCK 8u
typedef struct sdv__change {
    sdv_grid *grid;
    uint32_t *changed;         /* cones, ascending */
    lao_v4 *cones;             /* their new ends, 2 each; once the grid has those, the old ones */
    unsigned char *is_changed; /* per cone */
    uint32_t changed_count;
    unsigned char *stale;       /* per cell: SDV__LISTED, ... */
    unsigned char *close;       /* per block: something in it may change */
    uint32_t blocks[3];         /* along each axis */
    uint32_t *was;              /* occupied cells before */
    uint32_t *rows, row_layers; /* nearest along x in the layers whose occupied cells change */
    uint32_t row_layer[SDV__AXIS];
    unsigned char turned[SDV__AXIS]; /* per layer: is it one of those? */
    /* Cells whose list changes, layer by layer: the cell, the place and length of its old list, the
       length of its new one and how far (entries) what lies before it moves. */
    uint32_t *listed, *places, *olds, *news;
    int32_t *moves;                    /* one more: of what lies behind the last */
    uint32_t listed_in[SDV__AXIS + 1]; /* where a layer's begin */
    uint64_t fresh_in[SDV__AXIS + 1];  /* and their new lists */
    float *fresh;
    float *ids; /* a larger array, where the grid's is too small */
    uint32_t room;
} sdv__change;

static lao_v3 sdv__centre(const sdv_grid *g, size_t cell) {
    size_t row = cell / g->size[0];
    return sdv_cell_centre(sdv__grid_box(g), (uint32_t)(cell - row * g->size[0]),
                           (uint32_t)(row % g->size[1]), (uint32_t)(row / g->size[1]));
}
/* Blocks at y and z, along x. */
static const unsigned char *sdv__close_row(const sdv__change *c, uint32_t y, uint32_t z) {
    return c->close + c->blocks[0] * (y / SDV__BLOCK + (size_t)c->blocks[1] * (z / SDV__BLOCK));
}
/* ---- which lists change */
typedef struct sdv__marking {
    const sdv__change *change;
    const lao_v4 *cone;
} sdv__marking;
static void sdv__mark_cell(void *arg, uint32_t cell, lao_v3 centre) {
    const sdv__marking *m = (const sdv__marking *)arg;
    unsigned char *stale = m->change->stale + cell;
    if (!*stale && sdv__is_listed(m->change->grid, centre, m->cone)) {
        *stale = SDV__LISTED;
    }
}
static size_t sdv__next_listed(const sdv__change *c, size_t cell, size_t end) {
    const void *found = memchr(c->stale + cell, SDV__LISTED, end - cell);
    return found ? (size_t)((const unsigned char *)found - c->stale) : end;
}
/* The new list of a cell: the old one without changed cones, and the changed ones that are near
   enough, in order. Returns its length; `out` NULL: only that. */
static uint32_t sdv__merge_list(const sdv__change *c, size_t index, float *out) {
    const sdv_grid *g = c->grid;
    const lao_v4 *cell = g->cells + index;
    lao_v3 centre = sdv__centre(g, index);
    uint32_t i = 0, k = 0, n = 0, old_count = (uint32_t)cell->w;
    const float *old = old_count ? g->ids + (size_t)cell->z : NULL;
    while (i < old_count || k < c->changed_count) {
        uint32_t a = i < old_count ? (uint32_t)old[i] : SDV_NONE;
        uint32_t b = k < c->changed_count ? c->changed[k] : SDV_NONE;
        if (b > a || sdv__is_listed(g, centre, c->cones + 2 * (size_t)k)) {
            if (out) {
                out[n] = (float)(b > a ? a : b);
            }
            n++;
        }
        i += a <= b;
        k += b <= a;
    }
    return n;
}
static void sdv__mark_layer(void *arg, uint32_t z) {
    sdv__change *c = (sdv__change *)arg;
    const sdv_grid *g = c->grid;
    size_t first = sdv__row(g, 0, z), end = first + sdv__layer_size(g), cell;
    sdv__marking m;
    uint32_t k;
    m.change = c;
    memset(c->stale + first, 0, end - first);
    for (k = 0; k < c->changed_count; k++) {
        m.cone = g->cones + 2 * (size_t)c->changed[k];
        sdv__raster_layer(g, m.cone, z, sdv__mark_cell, &m);
        m.cone = c->cones + 2 * (size_t)k;
        sdv__raster_layer(g, m.cone, z, sdv__mark_cell, &m);
    }
    for (cell = sdv__next_listed(c, first, end); cell < end;
         cell = sdv__next_listed(c, cell + 1, end)) {
        uint32_t n = sdv__merge_list(c, cell, NULL);
        c->turned[z] |= (n > 0) != (g->cells[cell].w > 0.0f);
        c->listed_in[z]++;
        c->fresh_in[z] += n;
    }
}
static void sdv__merge_layer(void *arg, uint32_t z) {
    sdv__change *c = (sdv__change *)arg;
    const sdv_grid *g = c->grid;
    size_t first = sdv__row(g, 0, z), end = first + sdv__layer_size(g), cell;
    uint32_t i = c->listed_in[z];
    uint64_t at = c->fresh_in[z];
    for (cell = sdv__next_listed(c, first, end); cell < end;
         cell = sdv__next_listed(c, cell + 1, end)) {
        c->listed[i] = (uint32_t)cell;
        c->olds[i] = (uint32_t)g->cells[cell].w;
        c->news[i] = sdv__merge_list(c, cell, c->fresh + at);
        at += c->news[i++];
    }
}
/* Could anything in a block be nearest to a cell whose list changes? All cells of the block are
   within `reach` of its middle, whose nearest cell is `apart` away: within apart + reach of each is
   one that stays, unless it lists what changes. What lists it is within 2 cells of it. */
static void sdv__close_blocks(void *arg, uint32_t bz) {
    sdv__change *c = (sdv__change *)arg;
    const sdv_grid *g = c->grid;
    uint32_t b, k, axis, n = c->blocks[0] * c->blocks[1];
    for (b = 0; b < n; b++) {
        uint32_t at[3], middle[3];
        double reach = 0, apart = 0;
        size_t nearest;
        float within;
        lao_v3 p;
        at[0] = b % c->blocks[0];
        at[1] = b / c->blocks[0];
        at[2] = bz;
        for (axis = 0; axis < 3; axis++) {
            uint32_t low = SDV__BLOCK * at[axis], end = g->size[axis] - low;
            end = low + (end < SDV__BLOCK ? end : SDV__BLOCK);
            middle[axis] = (low + end) / 2;
            reach += (double)(middle[axis] - low) * (middle[axis] - low);
        }
        nearest = (size_t)g->cells[sdv__row(g, middle[1], middle[2]) + middle[0]].y;
        for (axis = 0; axis < 3; axis++) {
            double d = (double)(nearest % g->size[axis]) - middle[axis];
            nearest /= g->size[axis];
            apart += d * d;
        }
        p = sdv_cell_centre(sdv__grid_box(g), middle[0], middle[1], middle[2]);
        within = (float)(sqrt(apart) + 2 * sqrt(reach) + 2.1) * g->cell;
        c->close[(size_t)n * bz + b] = 0;
        for (k = 0; k < c->changed_count && !c->close[(size_t)n * bz + b]; k++) {
            const lao_v4 *old = g->cones + 2 * (size_t)c->changed[k],
                         *fresh = c->cones + 2 * (size_t)k;
            c->close[(size_t)n * bz + b] = sdv_round_cone(p, old[0], old[1]) < within ||
                                           sdv_round_cone(p, fresh[0], fresh[1]) < within;
        }
    }
}

/* ---- lists */
/* Where the old lists are and how far everything moves. */
static void sdv__place_lists(sdv__change *c, uint32_t count) {
    const sdv_grid *g = c->grid;
    uint32_t i, next = g->id_count;
    size_t end = g->cell_count;
    int32_t move = 0;
    for (i = count; i-- > 0;) { /* an empty list lies where the next one begins */
        size_t cell = c->listed[i];
        if (!c->olds[i]) {
            size_t row = cell / g->size[0], from = cell - row * g->size[0];
            for (; row * g->size[0] < end; row++, from = 0) {
                uint32_t x = sdv__next_bit(sdv__bits(g, row), (uint32_t)from, g->size[0]);
                if (x < g->size[0]) {
                    cell = row * g->size[0] + x;
                    next = cell < end ? (uint32_t)g->cells[cell].z : next;
                    break;
                }
            }
        }
        next = c->olds[i] ? (uint32_t)g->cells[cell].z : next;
        end = c->listed[i];
        c->places[i] = next;
    }
    for (i = 0; i < count; i++) {
        c->moves[i] = move;
        move += (int32_t)c->news[i] - (int32_t)c->olds[i];
    }
    c->moves[count] = move;
}
/* What lies between two changed lists, those that move up last to first, then those that move down
   first to last: none is written where another is still to be read. */
static void sdv__move_lists(const sdv__change *c, uint32_t count) {
    float *ids = c->grid->ids;
    const float *fresh = c->fresh;
    uint32_t k, i;
    for (k = 0; k < 2 * (count + 1); k++) {
        uint32_t from, until;
        int32_t move;
        i = k <= count ? count - k : k - count - 1;
        from = i > 0 ? c->places[i - 1] + c->olds[i - 1] : 0;
        until = i < count ? c->places[i] : c->grid->id_count;
        move = c->moves[i];
        if (k <= count ? move > 0 : move < 0) {
            memmove(ids + (int64_t)from + move, ids + from, (until - from) * sizeof *ids);
        }
    }
    for (i = 0; i < count; i++) {
        memcpy(ids + (int64_t)c->places[i] + c->moves[i], fresh, c->news[i] * sizeof *ids);
        fresh += c->news[i];
    }
}
/* Cells from .. until - 1: their lists have moved. */
static void sdv__move_cells(const sdv_grid *g, size_t from, size_t until, int32_t move) {
    size_t row = from / g->size[0];
    uint32_t x = (uint32_t)(from - row * g->size[0]);
    for (; move != 0 && from < until; row++, x = 0) {
        lao_v4 *cells = g->cells + row * g->size[0];
        uint32_t end = until - from < g->size[0] - x ? x + (uint32_t)(until - from) : g->size[0];
        from += end - x;
        for (x = sdv__next_bit(sdv__bits(g, row), x, end); x < end;
             x = sdv__next_bit(sdv__bits(g, row), x + 1, end)) {
            cells[x].z += (float)move;
        }
    }
}
static void sdv__relist_layer(void *arg, uint32_t z) {
    sdv__change *c = (sdv__change *)arg;
    sdv_grid *g = c->grid;
    size_t from = sdv__row(g, 0, z), until = from + sdv__layer_size(g);
    uint32_t i;
    for (i = c->listed_in[z]; i < c->listed_in[z + 1]; i++) {
        lao_v4 *cell = g->cells + c->listed[i];
        size_t row = c->listed[i] / g->size[0];
        uint32_t x = c->listed[i] - (uint32_t)(row * g->size[0]);
        sdv__move_cells(g, from, c->listed[i], c->moves[i]);
        from = (size_t)c->listed[i] + 1;
        cell->w = (float)c->news[i];
        if (c->news[i]) {
            cell->z = (float)((int64_t)c->places[i] + c->moves[i]);
            sdv__bits(g, row)[x / 32] |= 1u << (x % 32);
        } else {
            sdv__bits(g, row)[x / 32] &= ~(1u << (x % 32));
        }
    }
    sdv__move_cells(g, from, until, c->moves[i]);
}

/* ---- what is nearest */
static void sdv__renear_layer(void *arg, uint32_t z) {
    sdv__change *c = (sdv__change *)arg;
    const sdv_grid *g = c->grid;
    uint32_t nx = g->size[0], x, y, before[SDV__AXIS];
    unsigned char wanted[SDV__AXIS];
    uint32_t *rows;
    if (!c->turned[z]) {
        return;
    }
    rows = c->rows + sdv__layer_size(g) * c->row_layer[z];
    memset(wanted, 0, sizeof wanted);
    sdv__layer_rows(g, z, rows);
    for (y = 0; y < g->size[1]; y++) {
        size_t row = y + (size_t)g->size[1] * z;
        const uint32_t *was = c->was + sdv__words(g) * row;
        if (memcmp(was, sdv__bits(g, row), sdv__words(g) * sizeof *was) != 0) {
            sdv__row_nearest(was, nx, before);
            for (x = 0; x < nx; x++) {
                wanted[x] |= before[x] != rows[(size_t)nx * y + x];
            }
        }
    }
    sdv__layer_columns(g, rows, wanted, g->layer + sdv__row(g, 0, z), c->stale + sdv__row(g, 0, z));
}
/* The z of a group of columns that lie in close blocks; 0: none. */
static int sdv__close_layers(const sdv__change *c, uint32_t x0, uint32_t y, unsigned char *layers) {
    uint32_t z, last = x0 + SDV__WIDE - 1, any = 0;
    last = last < c->grid->size[0] ? last : c->grid->size[0] - 1;
    for (z = 0; z < c->grid->size[2]; z++) {
        const unsigned char *row = sdv__close_row(c, y, z);
        layers[z] = row[x0 / SDV__BLOCK] | row[last / SDV__BLOCK];
        any |= layers[z];
    }
    return any != 0;
}
static void sdv__renear_slab(void *arg, uint32_t y) {
    sdv__change *c = (sdv__change *)arg;
    sdv_grid *g = c->grid;
    unsigned char wanted[SDV__WIDE], layers[SDV__AXIS];
    uint32_t x0, i, z;
    for (x0 = 0; x0 < g->size[0]; x0 += SDV__WIDE) {
        uint32_t wide = g->size[0] - x0 < SDV__WIDE ? g->size[0] - x0 : (uint32_t)SDV__WIDE;
        memset(wanted, 0, sizeof wanted);
        if (!sdv__close_layers(c, x0, y, layers)) {
            continue;
        }
        for (z = 0; z < g->size[2]; z++) {
            const unsigned char *stale = c->stale + sdv__row(g, y, z) + x0;
            for (i = 0; c->turned[z] && i < wide; i++) {
                wanted[i] |= stale[i] & SDV__TURNED;
            }
        }
        if (memchr(wanted, SDV__TURNED, wide)) {
            sdv__columns(g, x0, y, wanted, layers, c->stale);
        }
    }
}

/* ---- distances */
/* Of a place whose nearest cell is as before but lists something else. What did not change is no
   nearer than all was before. */
static float sdv__changed_distance(const sdv__change *c, const lao_v4 *cell, lao_v3 p,
                                   float before) {
    const sdv_grid *g = c->grid;
    const float *ids = g->ids + (size_t)cell->z;
    uint32_t i, k, n = (uint32_t)cell->w, cone;
    float least = SDV_FAR;
    for (i = 0; i < n; i++) {
        if (c->is_changed[(size_t)ids[i]]) {
            const lao_v4 *ends = g->cones + 2 * (size_t)ids[i];
            float d = sdv_round_cone(p, ends[0], ends[1]);
            least = d < least ? d : least;
        }
    }
    if (least <= before) {
        return least;
    }
    for (k = 0; k < c->changed_count; k++) {
        const lao_v4 *ends = c->cones + 2 * (size_t)k;
        if (sdv_round_cone(p, ends[0], ends[1]) <= before) {
            return sdv__list_distance(g, cell, p, &cone);
        }
    }
    return before;
}
static void sdv__rerefine_layer(void *arg, uint32_t z) {
    const sdv__change *c = (const sdv__change *)arg;
    const sdv_grid *g = c->grid;
    sdv_box box = sdv__grid_box(g);
    uint32_t x, y, cone;
    for (y = 0; y < g->size[1]; y++) {
        size_t row = sdv__row(g, y, z);
        const unsigned char *close = sdv__close_row(c, y, z);
        for (x = 0; x < g->size[0]; x++) {
            lao_v4 *cell = g->cells + row + x;
            size_t nearest;
            if (!close[x / SDV__BLOCK]) {
                x |= SDV__BLOCK - 1;
                continue;
            }
            nearest = (size_t)cell->y;
            if (c->stale[row + x] & SDV__NEARER) {
                cell->x =
                    sdv__list_distance(g, g->cells + nearest, sdv_cell_centre(box, x, y, z), &cone);
            } else if (c->stale[nearest] & SDV__LISTED) {
                cell->x = sdv__changed_distance(c, g->cells + nearest,
                                                sdv_cell_centre(box, x, y, z), cell->x);
            }
        }
    }
}

/* ---- all of it */
/* The cones at the nodes, with their new ends. 0: no memory. */
static int sdv__changed_cones(const sdv_tree *tree, const uint32_t *nodes, uint32_t count,
                              sdv__change *c) {
    const sdv_grid *g = c->grid;
    const lao_allocator *a = &g->allocator;
    unsigned char *moved = (unsigned char *)sdv__take(a, tree->node_count, 1);
    uint32_t i, n = 0;
    c->is_changed = (unsigned char *)sdv__take(a, g->cone_count, 1);
    if (moved && c->is_changed) {
        memset(moved, 0, tree->node_count);
        for (i = 0; i < count; i++) {
            moved[nodes[i]] = 1;
        }
        for (i = 0; i < g->cone_count; i++) {
            const uint32_t *ends = g->cone_nodes + 2 * (size_t)i;
            c->is_changed[i] = moved[ends[0]] || moved[ends[1]];
            c->changed_count += c->is_changed[i];
        }
        c->changed = (uint32_t *)sdv__take(a, c->changed_count, sizeof *c->changed);
        c->cones = (lao_v4 *)sdv__take(a, 2 * (uint64_t)c->changed_count, sizeof *c->cones);
    }
    for (i = 0; c->changed && c->cones && i < g->cone_count; i++) {
        if (c->is_changed[i]) {
            c->changed[n] = i;
            sdv__cone_set(tree, g->cone_nodes + 2 * (size_t)i, c->cones + 2 * (size_t)n++);
        }
    }
    sdv__give(a, moved);
    return c->changed && c->cones;
}
/* What marking has counted becomes where each layer begins. Returns the number of lists. */
static uint32_t sdv__change_sizes(sdv__change *c) {
    const sdv_grid *g = c->grid;
    uint32_t z, lists = 0;
    uint64_t fresh = 0;
    for (z = 0; z <= g->size[2]; z++) {
        uint32_t n = c->listed_in[z];
        uint64_t m = c->fresh_in[z];
        c->listed_in[z] = lists;
        c->fresh_in[z] = fresh;
        lists += n;
        fresh += m;
        if (z < g->size[2]) {
            c->row_layer[z] = c->row_layers;
            c->row_layers += c->turned[z];
        }
    }
    return lists;
}
static int sdv__change_memory(sdv__change *c, uint32_t lists) {
    const sdv_grid *g = c->grid;
    const lao_allocator *a = &g->allocator;
    uint64_t words = (uint64_t)sdv__words(g) * g->size[1] * g->size[2];
    c->listed = (uint32_t *)sdv__take(a, 4 * (uint64_t)lists, sizeof *c->listed);
    c->moves = (int32_t *)sdv__take(a, (uint64_t)lists + 1, sizeof *c->moves);
    c->fresh = (float *)sdv__take(a, c->fresh_in[g->size[2]], sizeof *c->fresh);
    c->rows =
        (uint32_t *)sdv__take(a, c->row_layers * (uint64_t)sdv__layer_size(g), sizeof *c->rows);
    c->was = (uint32_t *)sdv__take(a, words, sizeof *c->was);
    if (!c->listed || !c->moves || !c->fresh || !c->rows || !c->was) {
        return 0;
    }
    c->places = c->listed + lists;
    c->olds = c->places + lists;
    c->news = c->olds + lists;
    memcpy(c->was, g->occupied, (size_t)words * sizeof *c->was);
    return 1;
}
/* Everything up to the point where nothing can fail any more. *sum: entries of all lists. */
static lao_result sdv__change_prepare(sdv__work *work, sdv__change *c, uint64_t *sum) {
    sdv_grid *g = c->grid;
    const lao_allocator *a = &g->allocator;
    uint32_t k, lists;
    for (k = 0; k < 3; k++) {
        c->blocks[k] = sdv__parts(g->size[k], SDV__BLOCK);
    }
    c->stale = (unsigned char *)sdv__take(a, g->cell_count, 1);
    c->close =
        (unsigned char *)sdv__take(a, (uint64_t)c->blocks[0] * c->blocks[1] * c->blocks[2], 1);
    if (!c->stale || !c->close) {
        return sdv__fail(work->host, SDV_LOG_MEMORY, "changing a grid");
    }
    if (sdv__run(work, g->size[2], sdv__mark_layer, c)) {
        return sdv__fail(work->host, SDV_LOG_CANCELLED, "changing a grid");
    }
    lists = sdv__change_sizes(c);
    if (!sdv__change_memory(c, lists)) {
        return sdv__fail(work->host, SDV_LOG_MEMORY, "changing a grid");
    }
    if (sdv__run(work, g->size[2], sdv__merge_layer, c)) {
        return sdv__fail(work->host, SDV_LOG_CANCELLED, "changing a grid");
    }
    sdv__place_lists(c, lists);
    *sum = (uint64_t)((int64_t)g->id_count + c->moves[lists]);
    if (*sum > SDV__EXACT) {
        return sdv__fail(work->host, SDV_LOG_GRID_LISTS, "%llu entries", (unsigned long long)*sum);
    }
    if (*sum > g->id_room) { /* and some more, for the changes to come */
        c->room = (uint32_t)(*sum + *sum / 8);
        c->ids = (float *)sdv__take(a, c->room, sizeof *c->ids);
        if (!c->ids) {
            return sdv__fail(work->host, SDV_LOG_MEMORY, "changing a grid");
        }
    }
    return LAO_OK;
}
static void sdv__change_apply(sdv__work *work, sdv__change *c) {
    sdv_grid *g = c->grid;
    uint32_t k;
    (void)sdv__run(work, c->blocks[2], sdv__close_blocks, c);
    if (c->ids) {
        float *old = g->ids;
        memcpy(c->ids, old, g->id_count * sizeof *old);
        g->ids = c->ids;
        g->id_room = c->room;
        c->ids = old;
    }
    sdv__move_lists(c, c->listed_in[g->size[2]]);
    (void)sdv__run(work, g->size[2], sdv__relist_layer, c);
    for (k = 0; k < 2 * c->changed_count; k++) {
        lao_v4 *end = g->cones + 2 * (size_t)c->changed[k / 2] + k % 2, old = *end;
        *end = c->cones[k];
        c->cones[k] = old;
    }
    (void)sdv__run(work, g->size[2], sdv__renear_layer, c);
    (void)sdv__run(work, g->size[1], sdv__renear_slab, c);
    (void)sdv__run(work, g->size[2], sdv__rerefine_layer, c);
}
static lao_result sdv__grid_change(const sdv_host *host, const sdv_tree *tree,
                                   const uint32_t *nodes, uint32_t count, sdv_grid *grid) {
    sdv__change c;
    sdv__work work;
    sdv_host silent;
    uint64_t sum = 0;
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    memset(&c, 0, sizeof c);
    c.grid = grid;
    work.host = host;
    work.done = 0;
    work.total =
        5 * (uint64_t)grid->size[2] + grid->size[1] + sdv__parts(grid->size[2], SDV__BLOCK);
    if (sdv__changed_cones(tree, nodes, count, &c)) {
        result = sdv__change_prepare(&work, &c, &sum);
    } else {
        sdv__fail(host, SDV_LOG_MEMORY, "changing a grid");
    }
    if (result == LAO_OK) {
        if (host) { /* no way back from here: the host is no longer asked whether to cancel */
            silent = *host;
            silent.job.progress = NULL;
            work.host = &silent;
        }
        sdv__change_apply(&work, &c);
        sdv__forms_fill(tree, grid);
        grid->id_count = (uint32_t)sum;
        grid->rebuilt = 0;
    }
    sdv__give(&grid->allocator, c.changed);
    sdv__give(&grid->allocator, c.cones);
    sdv__give(&grid->allocator, c.is_changed);
    sdv__give(&grid->allocator, c.stale);
    sdv__give(&grid->allocator, c.close);
    sdv__give(&grid->allocator, c.listed);
    sdv__give(&grid->allocator, c.moves);
    sdv__give(&grid->allocator, c.fresh);
    sdv__give(&grid->allocator, c.rows);
    sdv__give(&grid->allocator, c.was);
    sdv__give(&grid->allocator, c.ids);
    return result;
}

/* A new grid in place of the old one, with as many cells along its longest axis. */
static lao_result sdv__grid_renew(const sdv_host *host, const sdv_tree *tree, sdv_grid *grid) {
    sdv_grid_desc desc;
    sdv_grid fresh;
    lao_result result;
    uint32_t k;
    memset(&desc, 0, sizeof desc);
    desc.resolution = 16;
    for (k = 0; k < 3; k++) {
        desc.resolution = grid->size[k] > desc.resolution ? grid->size[k] : desc.resolution;
    }
    result = sdv_grid_build(host, tree, &desc, &fresh);
    if (result == LAO_OK) {
        sdv_grid_free(grid);
        *grid = fresh;
        grid->rebuilt = 1;
    }
    return result;
}

/* Is it the tree of the grid, and are the nodes its own? */
static lao_result sdv__grid_fits(const sdv_host *host, const sdv_tree *tree, const uint32_t *nodes,
                                 uint32_t count, const sdv_grid *grid) {
    uint32_t i;
    if (!tree || !grid || (count && !nodes) || !tree->memory || !grid->cones) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_grid_update");
    }
    for (i = 0; i < count; i++) {
        if (nodes[i] >= tree->node_count) {
            return sdv__fail(host, SDV_LOG_GRID_TREE, "node %u of %u", nodes[i], tree->node_count);
        }
    }
    return grid->cone_count == tree->segment_count + sdv__lone_count(tree)
               ? LAO_OK
               : sdv__fail(host, SDV_LOG_GRID_TREE, NULL);
}
SDV_API lao_result sdv_grid_update(const sdv_host *host, const sdv_tree *tree,
                                   const uint32_t *nodes, uint32_t count, sdv_grid *grid) {
    lao_result result = sdv__grid_fits(host, tree, nodes, count, grid);
    if (result == LAO_OK && !grid->cells) {
        result = sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_grid_update");
    }
    if (result != LAO_OK) {
        return result;
    }
    return sdv__grid_holds(grid, tree) ? sdv__grid_change(host, tree, nodes, count, grid)
                                       : sdv__grid_renew(host, tree, grid);
}

/* ---- reading */
/* Adds the forms of a cell's list to a sample. */
static sdv_near sdv__near_forms(const sdv_grid *g, const lao_v4 *cell, lao_v3 p, lao_v3 direction,
                                sdv_near n) {
    uint32_t i;
    for (i = 0; i < (uint32_t)cell->w; i++) {
        float id = g->ids[(size_t)cell->z + i];
        const lao_v4 *c = g->cones + 2 * (size_t)id;
        lao_v2 along = sdv_cone_along(p, direction, c[0], c[1]);
        if (sdv_near_asks(n, along)) {
            n = sdv_near_form(n, along, p, c[0], c[1], sdv__form_of(g, id), id);
        }
    }
    return n;
}
/* Of p to what a cell lists; of forms a bound. */
static float sdv__form_distance(const sdv_grid *g, const lao_v4 *cell, lao_v3 p, uint32_t *cone) {
    sdv_near n;
    if (!g->forms) {
        return sdv__list_distance(g, cell, p, cone);
    }
    n = sdv__near_forms(g, cell, p, lao_v3_make(0.0f, 0.0f, 1.0f), sdv_near_start(0.0f));
    if (n.cone >= 0.0f) {
        *cone = (uint32_t)n.cone;
    }
    return n.distance;
}
SDV_API float sdv_grid_distance(const sdv_grid *grid, lao_v3 p, uint32_t *cone) {
    const lao_v4 *cell = grid->cells + sdv_cell_at(sdv__grid_box(grid), p);
    uint32_t nearest = SDV_NONE;
    float d;
    cell = cell->w > 0.0f ? cell : grid->cells + (size_t)cell->y;
    d = sdv__form_distance(grid, cell, p, &nearest);
    if (cone) {
        *cone = nearest;
    }
    return d;
}
SDV_API float sdv_cones_distance(const lao_v4 *cones, uint32_t count, lao_v3 p, uint32_t *cone) {
    uint32_t i, nearest = SDV_NONE;
    float least = SDV_FAR;
    for (i = 0; i < count; i++) {
        float d = sdv_round_cone(p, cones[2 * (size_t)i], cones[2 * (size_t)i + 1]);
        if (d < least) {
            least = d;
            nearest = i;
        }
    }
    if (cone) {
        *cone = nearest;
    }
    return least;
}

/* ================================================================================================
 * tracing: what the shaders do, with the same shared functions */

/* One sample: from the list of the cell at p, or of the nearest cell that has one. */
static sdv_near sdv__near_at(const sdv_grid *g, const lao_v4 *cell, lao_v3 p, lao_v3 direction) {
    sdv_near n = sdv_near_start(sdv_near_reach(g->cell));
    const lao_v4 *from = cell->w > 0.0f ? cell : g->cells + (size_t)cell->y;
    uint32_t i;
    if (g->forms) {
        return sdv__near_forms(g, from, p, direction, n);
    }
    for (i = 0; i < (uint32_t)from->w; i++) {
        float id = g->ids[(size_t)from->z + i];
        const lao_v4 *cone = g->cones + 2 * (size_t)id;
        n = sdv_near_add(n, p, direction, cone[0], cone[1], id);
    }
    return n;
}
static sdv_minimum sdv__minimum_add(const sdv_grid *g, const sdv_ray *ray, sdv_minimum found,
                                    float low, float high) {
    const lao_v4 *ends = g->cones + 2 * (size_t)found.cone;
    return g->forms
               ? sdv_minimum_form(found, ray->origin, ray->direction, ends[0], ends[1],
                                  sdv__form_of(g, found.cone), low, high)
               : sdv_minimum_add(found, ray->origin, ray->direction, ends[0], ends[1], low, high);
}
/* Outward normal of a cone (xyz) and its distance (w), of a form as far as that can be told. round:
   that of the round cone. */
static lao_v4 sdv__estimate(const sdv_grid *g, uint32_t cone, lao_v3 p, float round) {
    const lao_v4 *ends = g->cones + 2 * (size_t)cone;
    lao_v3 n;
    if (g->forms) {
        return sdv_form_estimate(p, ends[0], ends[1], sdv__form_of(g, (float)cone));
    }
    n = sdv_round_cone_gradient(p, ends[0], ends[1]);
    return lao_v4_make(n.x, n.y, n.z, round);
}
static const lao_v4 *sdv__cell_at(const sdv_grid *g, lao_v3 p) {
    return g->cells + sdv_cell_at(sdv__grid_box(g), p);
}

/* Refines a local minimum whose sample was nearest to m.cone, with the cones that turn out to be
   nearest where the ray is nearest to those before. */
static sdv_march sdv__minimum(const sdv_grid *g, const sdv_ray *ray, sdv_march m, float cone,
                              float low, float high) {
    sdv_minimum found = sdv_minimum_start(cone);
    int i;
    for (i = 0; i < SDV_MINIMUM_ROUNDS && found.cone >= 0.0f; i++) {
        lao_v3 p;
        found = sdv__minimum_add(g, ray, found, low, high);
        p = lao_v3_along(ray->origin, ray->direction, found.t);
        found = sdv_minimum_next(found, sdv__near_at(g, sdv__cell_at(g, p), p, ray->direction));
    }
    return sdv_march_minimum(m, found);
}

static sdv_march sdv__note(const sdv_grid *g, const sdv_ray *ray, sdv_march m, sdv_near n) {
    if (n.cone >= 0.0f) {
        m = sdv_march_note(m, sdv__minimum_add(g, ray, sdv_minimum_start(n.cone), 0.0f, SDV_FAR));
    }
    return m;
}

/* The least distance of a ray that hits nothing. */
static sdv_march sdv__least(const sdv_grid *g, const sdv_ray *ray, sdv_march m) {
    sdv_box box = sdv__grid_box(g);
    lao_v3 span = sdv_least_span(ray->origin, ray->direction, box, 0.0f);
    float t = span.z;
    int i;
    for (i = 0; i < SDV_LEAST_SAMPLES && (i == 0 || t <= span.y); i++) {
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, t);
        const lao_v4 *cell = sdv__cell_at(g, p);
        sdv_near n = sdv__near_at(g, cell, p, ray->direction);
        m = sdv__note(g, ray, m, n);
        span = sdv_least_span(ray->origin, ray->direction, box, m.low);
        t = i == 0 ? span.x : t + sdv_least_step(n, cell->w > 0.0f, cell->z, m.low, g->cell);
    }
    return m;
}

/* On to the surface from a point close to it. */
static void sdv__land(const sdv_grid *g, const sdv_ray *ray, const sdv_march *m, sdv_hit *hit) {
    lao_v3 gradient = lao_v3_make(0.0f, 0.0f, 1.0f);
    float t = m->t, off = SDV_FAR;
    int i;
    for (i = 0; i <= SDV_POLISH_ROUNDS; i++) {
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, t);
        sdv_near n = sdv__near_at(g, sdv__cell_at(g, p), p, ray->direction);
        lao_v4 there;
        if (lao_abs(n.distance) > off) {
            break;
        }
        off = lao_abs(n.distance);
        there = sdv__estimate(g, (uint32_t)n.cone, p, n.distance);
        gradient = lao_v3_make(there.x, there.y, there.z);
        hit->position = p;
        hit->cone = (uint32_t)n.cone;
        hit->t = t;
        t = sdv_polish(t, there.w, gradient, ray->direction, g->cell);
    }
    hit->normal = m->inside > 0.5f ? lao_v3_scale(gradient, -1.0f) : gradient;
    hit->inside = m->inside > 0.5f;
}

SDV_API void sdv_trace(const sdv_grid *grid, const sdv_ray *ray, sdv_hit *hit) {
    sdv_box box = sdv__grid_box(grid);
    int nearest = (ray->flags & SDV_TRACE_NEAREST) != 0, i;
    lao_v2 span =
        sdv_ray_box(ray->origin, ray->direction, nearest ? sdv_box_grown(box, ray->reach) : box);
    sdv_march m = sdv_march_start(span);
    for (i = 0; i < SDV_MAX_STEPS && m.state == SDV_MARCH_GOES; i++) {
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, m.t);
        const lao_v4 *cell = sdv__cell_at(grid, p);
        bool occupied = cell->w > 0.0f;
        sdv_near n = sdv_near_start(0.0f);
        if (occupied || (nearest && sdv_is_within(cell->z, ray->reach))) {
            n = sdv__near_at(grid, cell, p, ray->direction);
        }
        if (nearest) {
            m = sdv__note(grid, ray, m, n);
            m = sdv_march_passed(m, n) ? sdv__minimum(grid, ray, m, m.cone, m.older, m.t) : m;
        }
        m = sdv_march_step(m, n, occupied, cell->z, grid->cell);
    }
    if (nearest && m.state != SDV_MARCH_HITS) {
        m = ray->reach > 0.0f ? m : sdv__least(grid, ray, m);
        m.d_min = SDV_FAR;
        m = sdv__minimum(grid, ray, m, m.low_cone, 0.0f, SDV_FAR);
    }
    memset(hit, 0, sizeof *hit);
    hit->cone = SDV_NONE;
    hit->steps = (uint32_t)m.steps;
    hit->d_min = m.d_min;
    hit->t_min = m.t_min;
    if (m.state == SDV_MARCH_HITS) {
        sdv__land(grid, ray, &m, hit);
    }
}

/* ================================================================================================
 * shapes, shadow, openness */

/* A lower bound of the tree's distance, exact close to the surface and inside. */
static float sdv__tree_bound(const sdv_grid *g, lao_v3 p, uint32_t *cone) {
    const lao_v4 *cell = sdv__cell_at(g, p);
    float least = cell->w > 0.0f ? sdv__form_distance(g, cell, p, cone) : SDV_FAR;
    return sdv_tree_bound(least, cell->w > 0.0f, cell->z, sdv_box_distance(p, sdv__grid_box(g)),
                          g->cell);
}
static lao_v4 sdv__four(const float *at, lao_int row) {
    return lao_v4_make(at[0], at[1], at[row], at[row + 1]);
}
static lao_v4 sdv__field_value(const sdv_shapes *shapes, const sdv_lattice *l) {
    const float *at = shapes->fields + l->at;
    return sdv_lattice_value(l->part, sdv__four(at, l->row), sdv__four(at + l->layer, l->row));
}
/* bound: no more than the distance; else as near to it as can be had. */
static float sdv__shape_distance(const sdv_shapes *shapes, uint32_t i, lao_v3 p, bool bound) {
    const sdv_shape shape = shapes->shapes[i];
    sdv_lattice l;
    float value;
    if (shape.kind != SDV_SHAPE_FIELD) {
        return bound ? sdv_shape_distance(p, shape) : sdv_shape_estimate(p, shape);
    }
    l = sdv_lattice_at(p, shape);
    value = sdv__field_value(shapes, &l).w;
    return bound ? sdv_lattice_distance(l, value) : sdv_lattice_estimate(l, value);
}
static lao_v3 sdv__shape_gradient(const sdv_shapes *shapes, lao_int i, lao_v3 p) {
    sdv_lattice l;
    lao_v4 v;
    if (shapes->shapes[i].kind != SDV_SHAPE_FIELD) {
        return sdv_shape_gradient(p, shapes->shapes[i]);
    }
    l = sdv_lattice_at(p, shapes->shapes[i]);
    v = sdv__field_value(shapes, &l);
    return lao_v3_unit(lao_v3_make(v.x, v.y, v.z), lao_v3_make(0.0f, 0.0f, 1.0f));
}
/* `tree`, its distance or a lower bound of that at p, combined with all shapes. */
static sdv_solid sdv__solid_of(const sdv_shapes *shapes, float tree, lao_v3 p, bool bound) {
    sdv_solid s = sdv_solid_start(tree);
    uint32_t i;
    for (i = 0; i < shapes->count; i++) {
        bool again = shapes->shapes[i].kind == SDV_SHAPE_TREE;
        s = sdv_solid_add(s, again ? tree : sdv__shape_distance(shapes, i, p, bound),
                          shapes->shapes[i].operation, again ? -1 : (lao_int)i);
    }
    return s;
}
static sdv_solid sdv__solid_at(const sdv_grid *g, const sdv_shapes *shapes, lao_v3 p,
                               uint32_t *cone) {
    return sdv__solid_of(shapes, sdv__tree_bound(g, p, cone), p, true);
}
static lao_v3 sdv__solid_gradient(const sdv_grid *g, const sdv_shapes *shapes, const sdv_solid *s,
                                  lao_v3 p, uint32_t cone) {
    lao_v4 there;
    if (s->part >= 0) {
        return lao_v3_scale(sdv__shape_gradient(shapes, s->part, p), s->side);
    }
    there = sdv__estimate(g, cone, p, s->distance);
    return lao_v3_make(there.x, there.y, there.z);
}
static void sdv__solid_land(const sdv_grid *g, const sdv_shapes *shapes, const sdv_ray *ray,
                            float t, sdv_hit *hit, uint32_t *shape) {
    float off = SDV_FAR;
    int i;
    for (i = 0; i <= SDV_POLISH_ROUNDS; i++) {
        uint32_t cone = 0;
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, t), gradient;
        sdv_solid s = sdv__solid_at(g, shapes, p, &cone);
        if (lao_abs(s.distance) > off) {
            break;
        }
        off = lao_abs(s.distance);
        gradient = sdv__solid_gradient(g, shapes, &s, p, cone);
        hit->position = p;
        hit->cone = s.part >= 0 ? SDV_CUT_CONE : cone;
        hit->normal = hit->inside ? lao_v3_scale(gradient, -1.0f) : gradient;
        hit->t = t;
        if (shape) {
            *shape = s.part >= 0 ? (uint32_t)s.part : SDV_NONE;
        }
        t = sdv_polish(t, s.distance, gradient, ray->direction, g->cell);
    }
}
static bool sdv__united(const sdv_shapes *shapes) {
    uint32_t i;
    for (i = 0; i < shapes->count; i++) {
        if (shapes->shapes[i].operation == SDV_UNION) {
            return true;
        }
    }
    return false;
}

/* What near misses go by: not only a bound, where it matters. */
static float sdv__watched(const sdv_grid *g, const sdv_shapes *shapes, lao_v3 p, float reach) {
    const lao_v4 *cell = sdv__cell_at(g, p);
    float tree = SDV_FAR;
    if (cell->w > 0.0f || sdv_is_within(cell->z, reach)) {
        tree = sdv_grid_distance(g, p, NULL);
    }
    return sdv__solid_of(shapes, tree, p, false).distance;
}
static sdv_watch sdv__dip(const sdv_grid *g, const sdv_shapes *shapes, const sdv_ray *ray,
                          sdv_watch w, float t) {
    sdv_dip d = sdv_dip_start(w, t);
    int i, k;
    for (i = 0; i < SDV_DIP_ROUNDS; i++) {
        float found[2];
        for (k = 0; k < 2; k++) {
            lao_v3 p = lao_v3_along(ray->origin, ray->direction, sdv_dip_place(d, k));
            found[k] = sdv__watched(g, shapes, p, ray->reach);
        }
        d = sdv_dip_add(d, found[0], found[1]);
    }
    return sdv_watch_keep(w, d);
}
static sdv_watch sdv__watch(const sdv_grid *g, const sdv_shapes *shapes, const sdv_ray *ray,
                            sdv_watch w, float t) {
    lao_v3 p = lao_v3_along(ray->origin, ray->direction, t);
    float d = sdv__watched(g, shapes, p, ray->reach);
    if (sdv_watch_passed(w, d, ray->reach)) {
        w = sdv__dip(g, shapes, ray, w, t);
    }
    return sdv_watch_next(w, t, d);
}

SDV_API void sdv_trace_shapes(const sdv_grid *grid, const sdv_shapes *shapes, const sdv_ray *ray,
                              sdv_hit *hit, uint32_t *shape) {
    static const sdv_shapes none = {NULL, 0, NULL, 0};
    bool nearest = (ray->flags & SDV_TRACE_NEAREST) != 0;
    sdv_box box = sdv__grid_box(grid);
    lao_v2 span;
    sdv_watch watch;
    uint32_t cone = 0, i;
    float t;
    shapes = shapes ? shapes : &none;
    box = nearest ? sdv_box_grown(box, ray->reach) : box;
    span = sdv_solid_span(sdv_ray_box(ray->origin, ray->direction, box), sdv__united(shapes));
    t = span.x;
    watch = sdv_watch_start(t);
    memset(hit, 0, sizeof *hit);
    hit->cone = SDV_NONE;
    if (shape) {
        *shape = SDV_NONE;
    }
    for (i = 0; i < SDV_MAX_STEPS && t <= span.y; i++) {
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, t);
        sdv_solid s = sdv__solid_at(grid, shapes, p, &cone);
        float left;
        hit->inside = i == 0 ? s.distance < 0.0f : hit->inside;
        left = hit->inside ? -s.distance : s.distance;
        hit->steps++;
        if (left < sdv_hit_distance(grid->cell)) {
            sdv__solid_land(grid, shapes, ray, t, hit, shape);
            break;
        }
        watch = nearest && !hit->inside ? sdv__watch(grid, shapes, ray, watch, t) : watch;
        t += left;
    }
    if (nearest && hit->cone == SDV_NONE && sdv_watch_passed(watch, SDV_FAR, ray->reach)) {
        watch = sdv__dip(grid, shapes, ray, watch, watch.before);
    }
    hit->d_min = watch.d_min;
    hit->t_min = watch.t_min;
}

SDV_API float sdv_shadow(const sdv_grid *grid, const sdv_shapes *shapes, lao_v3 p, lao_v3 light,
                         float hardness, float bias) {
    lao_v2 span = sdv_ray_box(p, light, sdv__grid_box(grid));
    float lit = 1.0f, t;
    int i;
    span = shapes ? sdv_solid_span(span, sdv__united(shapes)) : span;
    t = lao_max(bias, span.x);
    for (i = 0; i < SDV_MAX_STEPS && t <= span.y && lit > 0.0f; i++) {
        lao_v3 q = lao_v3_along(p, light, t);
        uint32_t cone;
        float d = sdv_grid_distance(grid, q, NULL), step = sdv__tree_bound(grid, q, &cone);
        d = shapes ? sdv__solid_of(shapes, d, q, false).distance : d;
        step = shapes ? sdv__solid_of(shapes, step, q, true).distance : step;
        lit = sdv_shadow_add(lit, d, t, hardness);
        lit = d < sdv_hit_distance(grid->cell) ? 0.0f : lit;
        t += lao_max(step, sdv_hit_distance(grid->cell));
    }
    return lit;
}
SDV_API lao_v3 sdv_smooth_normal(const sdv_grid *grid, lao_v3 p, uint32_t cone, lao_v3 normal,
                                 float smoothness) {
    const lao_v4 *cell = sdv__cell_at(grid, p), *own = grid->cones + 2 * (size_t)cone;
    lao_v2 reach = sdv_joint_reach(p, own[0], own[1], smoothness, grid->cell);
    lao_v4 at = sdv__estimate(grid, cone, p, 0.0f);
    lao_v3 sum = sdv_joint_start(lao_v3_make(at.x, at.y, at.z), own[0], own[1], reach);
    uint32_t i;
    if (!(reach.x > 0.0f)) {
        return normal;
    }
    for (i = 0; i < (uint32_t)cell->w; i++) {
        uint32_t other = (uint32_t)grid->ids[(size_t)cell->z + i];
        const lao_v4 *ends = grid->cones + 2 * (size_t)other;
        float round = grid->forms ? 0.0f : sdv_round_cone(p, ends[0], ends[1]);
        if (!(round < reach.x)) {
            continue;
        }
        at = sdv__estimate(grid, other, p, round);
        if (at.w < reach.x) {
            sum = sdv_joint_add(sum, at.w, lao_v3_make(at.x, at.y, at.z), ends[0], ends[1], reach);
        }
    }
    return sdv_joint_normal(sum, normal);
}
/* How far it is from the wall of a cone at p to the middle. */
static float sdv__room(const sdv_grid *g, uint32_t cone, lao_v3 p) {
    const lao_v4 *ends = g->cones + 2 * (size_t)cone;
    sdv_cone_point c = sdv_cone_point_make(p, ends[0], ends[1]);
    float room = sdv_cone_ball_radius(c, ends[0], ends[1]);
    return g->forms ? room * sdv_form_ratio(sdv__form_of(g, (float)cone)) : room;
}
SDV_API float sdv_openness(const sdv_grid *grid, const sdv_shapes *shapes, lao_v3 p, lao_v3 normal,
                           float reach, uint32_t inside) {
    float closed = 0.0f;
    lao_int i;
    if (inside && reach > 0.0f) {
        uint32_t cone = 0;
        float d = sdv_grid_distance(grid, p, &cone);
        reach = sdv_open_reach(reach, sdv__room(grid, cone, p), d, grid->cell);
    }
    for (i = 0; i < SDV_OPEN_SAMPLES && reach > 0.0f; i++) {
        float place = sdv_open_place(reach, i);
        lao_v3 q = lao_v3_along(p, normal, place);
        uint32_t cone = 0;
        float d = sdv_grid_distance(grid, q, &cone);
        d = grid->forms ? sdv__estimate(grid, cone, q, d).w : d;
        d = shapes ? sdv__solid_of(shapes, d, q, false).distance : d;
        closed = sdv_open_add(closed, inside ? -d : d, place, i);
    }
    return sdv_open_result(closed);
}

/* ================================================================================================
 * targets: pieces (points, segments, triangles) sorted along a Morton curve, under a binary tree of
   balls */

enum { SDV__PIECES = 4 }; /* of a leaf */
typedef struct sdv__piece {
    lao_v3 u, v, w; /* a segment has w = v, a point u = v = w */
} sdv__piece;
struct sdv_target {
    lao_allocator allocator;
    uint32_t piece_count, leaf_count; /* leaves: a power of two, the last ones may be empty */
    sdv__piece *pieces;
    lao_v4 *balls; /* 2 leaf_count: children of i are 2 i, 2 i + 1, the root is 1; w < 0: empty */
    float radius;
};

static lao_result sdv__target_check(const sdv_host *host, const sdv_target_desc *desc) {
    uint32_t i;
    if (!desc->points || (desc->triangle_count && !desc->triangles)) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "arrays of sdv_target_desc");
    }
    if (desc->point_count < 1 || desc->point_count > 1u << 28 || desc->triangle_count > 1u << 28 ||
        !(desc->radius >= 0.0f && desc->radius < SDV_FAR)) {
        return sdv__fail(host, SDV_LOG_TARGET_SHAPE, "%u points, %u triangles", desc->point_count,
                         desc->triangle_count);
    }
    for (i = 0; i < 3 * desc->point_count; i++) {
        if (!(fabsf(desc->points[i]) <= 1e9f)) {
            return sdv__fail(host, SDV_LOG_TARGET_SHAPE, "point %u", i / 3);
        }
    }
    for (i = 0; i < 3 * desc->triangle_count; i++) {
        if (desc->triangles[i] >= desc->point_count) {
            return sdv__fail(host, SDV_LOG_TARGET_SHAPE, "triangle %u", i / 3);
        }
    }
    return LAO_OK;
}

static lao_v3 sdv__point(const float *points, uint32_t i) {
    const float *p = points + 3 * (size_t)i;
    return lao_v3_make(p[0], p[1], p[2]);
}
static sdv__piece sdv__piece_make(const sdv_target_desc *desc, uint32_t i) {
    sdv__piece s;
    const uint32_t *corners = desc->triangle_count ? desc->triangles + 3 * (size_t)i : NULL;
    uint32_t last = desc->point_count - 1;
    s.u = sdv__point(desc->points, corners ? corners[0] : i);
    s.v = sdv__point(desc->points, corners ? corners[1] : i < last ? i + 1 : i);
    s.w = corners ? sdv__point(desc->points, corners[2]) : s.v;
    return s;
}
static uint32_t sdv__spread(uint32_t v) { /* 10 bits, two free ones between */
    v = (v | v << 16) & 0x030000ffu;
    v = (v | v << 8) & 0x0300f00fu;
    v = (v | v << 4) & 0x030c30c3u;
    return (v | v << 2) & 0x09249249u;
}
static uint32_t sdv__morton(const sdv__piece *s, const double low[3], double size) {
    uint32_t key = 0, k;
    for (k = 0; k < 3; k++) {
        double u = (double)sdv__v3_at(s->u, k), v = (double)sdv__v3_at(s->v, k);
        double c = (u + v + (double)sdv__v3_at(s->w, k)) / 3 - low[k];
        double cell = size > 0 ? c / size * 1023 : 0;
        key |= sdv__spread(cell > 0 ? (cell < 1023 ? (uint32_t)cell : 1023u) : 0u) << k;
    }
    return key;
}
/* Order of ascending keys, 10 bits a round; `order` and `other` have count entries each. */
static void sdv__sort(const uint32_t *keys, uint32_t count, uint32_t *order, uint32_t *other) {
    uint32_t round, i;
    for (i = 0; i < count; i++) {
        order[i] = i;
    }
    for (round = 0; round < 30; round += 10) {
        uint32_t first[1025];
        memset(first, 0, sizeof first);
        for (i = 0; i < count; i++) {
            first[(keys[i] >> round & 1023u) + 1]++;
        }
        for (i = 0; i < 1024; i++) {
            first[i + 1] += first[i];
        }
        for (i = 0; i < count; i++) {
            other[first[keys[order[i]] >> round & 1023u]++] = order[i];
        }
        memcpy(order, other, count * sizeof *order);
    }
}
/* The ball around the box of points; a margin makes up for rounding. */
static lao_v4 sdv__box_ball(const lao_v3 *low, const lao_v3 *high) {
    lao_v3 d = lao_v3_sub(*high, *low);
    lao_v3 c = lao_v3_along(*low, d, 0.5f);
    float margin = 1e-6f * (fabsf(c.x) + fabsf(c.y) + fabsf(c.z));
    return lao_v4_make(c.x, c.y, c.z, 0.50001f * lao_sqrt(lao_v3_dot(d, d)) + margin);
}
static void sdv__box_grow(lao_v3 *low, lao_v3 *high, lao_v3 p) {
    *low = lao_v3_make(lao_min(low->x, p.x), lao_min(low->y, p.y), lao_min(low->z, p.z));
    *high = lao_v3_make(lao_max(high->x, p.x), lao_max(high->y, p.y), lao_max(high->z, p.z));
}
static void sdv__target_balls(sdv_target *t) {
    uint32_t node, k, wide = t->leaf_count * SDV__PIECES; /* pieces below a node */
    for (node = 1; node < 2 * t->leaf_count; node++) {
        uint32_t first, end;
        lao_v3 low, high;
        wide /= node > 1 && (node & (node - 1)) == 0 ? 2u : 1u; /* the first of its level */
        first = node * wide - t->leaf_count * SDV__PIECES;
        end = first + wide < t->piece_count ? first + wide : t->piece_count;
        t->balls[node] = lao_v4_make(0.0f, 0.0f, 0.0f, -1.0f);
        if (first >= end) {
            continue;
        }
        low = high = t->pieces[first].u;
        for (k = first; k < end; k++) {
            sdv__box_grow(&low, &high, t->pieces[k].u);
            sdv__box_grow(&low, &high, t->pieces[k].v);
            sdv__box_grow(&low, &high, t->pieces[k].w);
        }
        t->balls[node] = sdv__box_ball(&low, &high);
    }
}
static void sdv__target_fill(sdv_target *t, const sdv_target_desc *desc, uint32_t *keys) {
    uint32_t *order = keys + t->piece_count, *other = order + t->piece_count, i, k;
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, size = 0;
    for (i = 0; i < desc->point_count; i++) {
        for (k = 0; k < 3; k++) {
            double v = (double)desc->points[3 * (size_t)i + k];
            low[k] = i == 0 || v < low[k] ? v : low[k];
            high[k] = i == 0 || v > high[k] ? v : high[k];
            size = high[k] - low[k] > size ? high[k] - low[k] : size;
        }
    }
    for (i = 0; i < t->piece_count; i++) {
        sdv__piece s = sdv__piece_make(desc, i);
        keys[i] = sdv__morton(&s, low, size);
    }
    sdv__sort(keys, t->piece_count, order, other);
    for (i = 0; i < t->piece_count; i++) {
        t->pieces[i] = sdv__piece_make(desc, order[i]);
    }
    sdv__target_balls(t);
}

SDV_API lao_result sdv_target_create(const sdv_host *host, const sdv_target_desc *desc,
                                     sdv_target **target) {
    lao_allocator a = sdv__allocator(host);
    sdv_target *t;
    uint32_t *keys;
    lao_result result;
    if (!desc || !target) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_target_create");
    }
    result = sdv__target_check(host, desc);
    if (result != LAO_OK) {
        return result;
    }
    t = (sdv_target *)sdv__take(&a, 1, sizeof *t);
    if (!t) {
        return sdv__fail(host, SDV_LOG_MEMORY, "a target");
    }
    memset(t, 0, sizeof *t);
    t->allocator = a;
    t->radius = desc->radius;
    t->piece_count = desc->triangle_count ? desc->triangle_count : desc->point_count - 1;
    t->piece_count = t->piece_count ? t->piece_count : 1; /* a point */
    for (t->leaf_count = 1; t->leaf_count * SDV__PIECES < t->piece_count; t->leaf_count *= 2) {
    }
    t->pieces = (sdv__piece *)sdv__take(&a, t->piece_count, sizeof *t->pieces);
    t->balls = (lao_v4 *)sdv__take(&a, 2 * (uint64_t)t->leaf_count, sizeof *t->balls);
    keys = (uint32_t *)sdv__take(&a, 3 * (uint64_t)t->piece_count, sizeof *keys);
    if (t->pieces && t->balls && keys) {
        sdv__target_fill(t, desc, keys);
        *target = t;
    } else {
        result = sdv__fail(host, SDV_LOG_MEMORY, "a target of %u pieces", t->piece_count);
        sdv_target_free(t);
    }
    sdv__give(&a, keys);
    return result;
}

SDV_API void sdv_target_free(sdv_target *target) {
    if (target) {
        lao_allocator a = target->allocator;
        sdv__give(&a, target->pieces);
        sdv__give(&a, target->balls);
        sdv__give(&a, target);
    }
}

static int sdv__same_point(lao_v3 a, lao_v3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}
static float sdv__piece_cone(const sdv__piece *s, lao_v4 a, lao_v4 b) {
    if (sdv__same_point(s->v, s->w)) {
        return sdv_segment_cone(s->u, s->v, a, b);
    }
    return sdv_triangle_cone(s->u, s->v, s->w, a, b);
}
/* No point of the ball is nearer to the cone than this. */
static float sdv__ball_cone(lao_v4 ball, lao_v4 a, lao_v4 b) {
    float d = sdv_round_cone(lao_v3_make(ball.x, ball.y, ball.z), a, b);
    return ball.w < 0.0f ? SDV_FAR : d - ball.w - 1e-5f * fabsf(d);
}
SDV_API float sdv_target_cone(const sdv_target *target, lao_v4 a, lao_v4 b) {
    uint32_t stack[64], n = 0, i;
    float least = SDV_FAR;
    stack[n++] = 1;
    while (n > 0) {
        uint32_t node = stack[--n];
        if (sdv__ball_cone(target->balls[node], a, b) >= least) {
            continue;
        }
        if (node < target->leaf_count) { /* the nearer child next */
            uint32_t child = 2 * node;
            uint32_t second = sdv__ball_cone(target->balls[child], a, b) <
                              sdv__ball_cone(target->balls[child + 1], a, b);
            stack[n++] = child + second;
            stack[n++] = child + !second;
            continue;
        }
        i = (node - target->leaf_count) * SDV__PIECES;
        for (node = i; node < i + SDV__PIECES && node < target->piece_count; node++) {
            const sdv__piece *s = target->pieces + node;
            lao_v3 low = s->u, high = s->u;
            sdv__box_grow(&low, &high, s->v);
            sdv__box_grow(&low, &high, s->w);
            if (sdv__ball_cone(sdv__box_ball(&low, &high), a, b) < least) {
                least = lao_min(least, sdv__piece_cone(s, a, b));
            }
        }
    }
    return least - target->radius;
}
SDV_API float sdv_target_point(const sdv_target *target, lao_v3 p) {
    lao_v4 ball = lao_v4_make(p.x, p.y, p.z, 0.0f);
    return sdv_target_cone(target, ball, ball);
}

enum { SDV__CHUNK = 64 }; /* segments or rows of one job item */
typedef struct sdv__measure {
    const sdv_target *target;
    const sdv_tree *tree;
    float *segments;
} sdv__measure;
static void sdv__measure_chunk(void *arg, uint32_t chunk) {
    const sdv__measure *m = (const sdv__measure *)arg;
    uint32_t i, first = chunk * SDV__CHUNK;
    for (i = first; i < first + SDV__CHUNK && i < m->tree->segment_count; i++) {
        const sdv_segment *s = m->tree->segments + i;
        m->segments[i] =
            sdv_target_cone(m->target, m->tree->nodes[s->parent], m->tree->nodes[s->child]);
    }
}
SDV_API lao_result sdv_target_distances(const sdv_host *host, const sdv_target *target,
                                        const sdv_tree *tree, const sdv_reduced *reduced,
                                        float *segments, float *nodes) {
    lao_allocator a = sdv__allocator(host);
    sdv__measure m;
    sdv__work work;
    uint32_t i;
    int cancelled;
    if (!target || !tree || !tree->memory || (nodes && (!reduced || !reduced->memory))) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_target_distances");
    }
    m.target = target;
    m.tree = tree;
    m.segments =
        segments ? segments : (float *)sdv__take(&a, tree->segment_count, sizeof *m.segments);
    if (!m.segments) {
        return sdv__fail(host, SDV_LOG_MEMORY, "%u distances", tree->segment_count);
    }
    work.host = host;
    work.done = 0;
    work.total = (tree->segment_count + SDV__CHUNK - 1) / SDV__CHUNK;
    cancelled = sdv__run(&work, (uint32_t)work.total, sdv__measure_chunk, &m);
    for (i = 0; nodes && !cancelled && i < reduced->node_count; i++) {
        nodes[i] = lao_bits_float(0x7fc00000u);
    }
    for (i = 0; nodes && !cancelled && i < tree->node_count; i++) {
        uint32_t segment = tree->parent_segments[i];
        float *least = nodes + reduced->owners[i];
        if (segment != SDV_NONE && !(*least <= m.segments[segment])) {
            *least = m.segments[segment];
        }
    }
    if (!segments) {
        sdv__give(&a, m.segments);
    }
    return cancelled ? sdv__fail(host, SDV_LOG_CANCELLED, "measuring distances") : LAO_OK;
}

/* ================================================================================================
 * pull-push */

typedef struct sdv__level {
    float *values, *weights;
    uint32_t width, height;
} sdv__level;
typedef struct sdv__pull {
    const sdv_pull_push_desc *desc;
    const sdv__level *fine, *coarse;
    lao_int exponent;
} sdv__pull;

/* Up to four channels of a texel from channel c on. */
static lao_v4 sdv__channels(const sdv__level *l, size_t texel, uint32_t channels, uint32_t c) {
    const float *v = l->values + texel * channels + c;
    uint32_t n = channels - c;
    return lao_v4_make(v[0], n > 1 ? v[1] : 0.0f, n > 2 ? v[2] : 0.0f, n > 3 ? v[3] : 0.0f);
}
static void sdv__channels_set(const sdv__level *l, size_t texel, uint32_t channels, uint32_t c,
                              lao_v4 value) {
    uint32_t k;
    for (k = 0; k < 4 && c + k < channels; k++) {
        l->values[texel * channels + c + k] = sdv__v4_at(value, k);
    }
}
static void sdv__pull_texel(const sdv__pull *p, uint32_t x, uint32_t y) {
    const sdv__level *fine = p->fine, *coarse = p->coarse;
    size_t texel = (size_t)coarse->width * y + x;
    uint32_t c, i, channels = p->desc->channels;
    float h = sdv_pull_share((lao_int)p->desc->pull);
    for (c = 0; c < channels; c += 4) {
        sdv_mix m = sdv_mix_start(lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f));
        for (i = 0; i < 4; i++) {
            uint32_t fx = 2 * x + (i & 1u), fy = 2 * y + (i >> 1);
            size_t child = (size_t)fine->width * fy + fx;
            if (fx < fine->width && fy < fine->height) {
                m = sdv_mix_add(m, sdv__channels(fine, child, channels, c), fine->weights[child],
                                h);
            }
        }
        sdv__channels_set(coarse, texel, channels, c, sdv_mix_value(m));
        coarse->weights[texel] = m.weight;
    }
}
static void sdv__push_texel(const sdv__pull *p, uint32_t x, uint32_t y) {
    const sdv__level *fine = p->fine, *coarse = p->coarse;
    size_t texel = (size_t)fine->width * y + x;
    uint32_t c, channels = p->desc->channels;
    lao_int i, push = (lao_int)p->desc->push;
    float own = sdv_push_own(fine->weights[texel], p->exponent), weight = 0.0f;
    for (c = 0; c < channels; c += 4) {
        sdv_mix m = sdv_mix_start(lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f));
        for (i = 0; i < 4; i++) {
            lao_int px = sdv_push_parent((lao_int)x, i & 1);
            lao_int py = sdv_push_parent((lao_int)y, i >> 1);
            float h = sdv_push_share(push, i & 1) * sdv_push_share(push, i >> 1);
            if (px >= 0 && py >= 0 && px < (lao_int)coarse->width && py < (lao_int)coarse->height) {
                size_t parent = (size_t)coarse->width * (size_t)py + (size_t)px;
                m = sdv_mix_add(m, sdv__channels(coarse, parent, channels, c),
                                coarse->weights[parent], h);
            }
        }
        sdv__channels_set(fine, texel, channels, c,
                          sdv_push_value(m, sdv__channels(fine, texel, channels, c), own));
        weight = sdv_push_weight(m, own);
    }
    fine->weights[texel] = weight;
}
static void sdv__pull_rows(void *arg, uint32_t chunk) {
    const sdv__pull *p = (const sdv__pull *)arg;
    uint32_t x, y, first = chunk * SDV__CHUNK;
    for (y = first; y < first + SDV__CHUNK && y < p->coarse->height; y++) {
        for (x = 0; x < p->coarse->width; x++) {
            sdv__pull_texel(p, x, y);
        }
    }
}
static void sdv__push_rows(void *arg, uint32_t chunk) {
    const sdv__pull *p = (const sdv__pull *)arg;
    uint32_t x, y, first = chunk * SDV__CHUNK;
    for (y = first; y < first + SDV__CHUNK && y < p->fine->height; y++) {
        for (x = 0; x < p->fine->width; x++) {
            sdv__push_texel(p, x, y);
        }
    }
}
/* A pixel without a weight has no value either. */
static void sdv__pull_clean(const sdv__level *l, uint32_t channels) {
    size_t i, n = (size_t)l->width * l->height;
    for (i = 0; i < n; i++) {
        if (!(l->weights[i] > 0.0f)) {
            l->weights[i] = 0.0f;
            memset(l->values + i * channels, 0, channels * sizeof *l->values);
        }
    }
}
enum { SDV__LEVELS = 17 };
static uint32_t sdv__chunks(uint32_t rows) {
    return (rows + SDV__CHUNK - 1) / SDV__CHUNK;
}
static int sdv__pull_run(const sdv_host *host, sdv__level *levels, uint32_t count, sdv__pull *p) {
    sdv__work work;
    const sdv__level *top = levels + count - 1;
    uint32_t i;
    work.host = host;
    work.done = 0;
    work.total = 0;
    for (i = 0; i < count; i++) {
        work.total += (i ? sdv__chunks(levels[i].height) : 0u) +
                      (i + 1 < count ? sdv__chunks(levels[i].height) : 0u);
    }
    for (i = 1; i < count; i++) {
        p->fine = levels + i - 1;
        p->coarse = levels + i;
        if (sdv__run(&work, sdv__chunks(levels[i].height), sdv__pull_rows, p)) {
            return 1;
        }
    }
    top->weights[0] = top->weights[0] > 0.0f ? 1.0f : 0.0f;
    for (i = count - 1; i-- > 0 && top->weights[0] > 0.0f;) {
        p->fine = levels + i;
        p->coarse = levels + i + 1;
        if (sdv__run(&work, sdv__chunks(levels[i].height), sdv__push_rows, p)) {
            return 1;
        }
    }
    return 0;
}

SDV_API lao_result sdv_pull_push(const sdv_host *host, const sdv_pull_push_desc *desc,
                                 uint32_t *empty) {
    lao_allocator a = sdv__allocator(host);
    sdv__level levels[SDV__LEVELS];
    sdv__pull p;
    uint64_t texels = 0;
    uint32_t i, count = 1;
    float *memory, *at;
    int cancelled;
    if (!desc || !desc->values || !desc->weights) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_pull_push");
    }
    if (desc->width < 1 || desc->height < 1 || desc->width > 32768 || desc->height > 32768 ||
        desc->channels < 1 || desc->channels > 64) {
        return sdv__fail(host, SDV_LOG_IMAGE_SIZE, "%u x %u, %u channels", desc->width,
                         desc->height, desc->channels);
    }
    levels[0].width = desc->width;
    levels[0].height = desc->height;
    levels[0].values = desc->values;
    levels[0].weights = desc->weights;
    for (; levels[count - 1].width > 1 || levels[count - 1].height > 1; count++) {
        levels[count].width = (levels[count - 1].width + 1) / 2;
        levels[count].height = (levels[count - 1].height + 1) / 2;
        texels += (uint64_t)levels[count].width * levels[count].height;
    }
    memory = (float *)sdv__take(&a, texels * (desc->channels + 1), sizeof *memory);
    if (!memory) {
        return sdv__fail(host, SDV_LOG_MEMORY, "the pyramid of a %u x %u image", desc->width,
                         desc->height);
    }
    for (i = 1, at = memory; i < count; i++) {
        size_t n = (size_t)levels[i].width * levels[i].height;
        levels[i].values = at;
        levels[i].weights = at + n * desc->channels;
        at += n * (desc->channels + 1);
    }
    p.desc = desc;
    p.exponent = desc->exponent ? (lao_int)desc->exponent : 1;
    p.exponent = p.exponent < 1023 ? p.exponent : 1023;
    sdv__pull_clean(levels, desc->channels);
    cancelled = sdv__pull_run(host, levels, count, &p);
    if (empty && !cancelled) {
        *empty = !(levels[count - 1].weights[0] > 0.0f);
    }
    sdv__give(&a, memory);
    return cancelled ? sdv__fail(host, SDV_LOG_CANCELLED, "filling an image") : LAO_OK;
}

/* ================================================================================================
 * the module */
// clang-format off
#define SDV__WRITE(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define SDV__READ(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define SDV__CLEAR(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_CLEAR}
#define SDV__KEEP(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_KEEP}
#define SDV__OTHER(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD}
#define SDV__BEFORE(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_PREVIOUS, LAO_LOAD_DISCARD}
#define SDV__FINER(image) {image, LAO_LEVEL_FINER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define SDV__COARSER(image) {image, LAO_LEVEL_COARSER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define SDV__TOP(image) {image, LAO_LEVEL_INDEX, 31, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define SDV__BACKGROUND {"parameterization", '>', 0}
#define SDV__PARAMETERIZED {"parameterization", '>', 1}
#define SDV__WITH_BACKGROUND {{"#vessel_box", '>', 0}, SDV__BACKGROUND}
#define SDV__WITH_PHASES {{"#vessel_box", '>', 0}, SDV__PARAMETERIZED}
/* a tree, one with shapes, and what is only seen: a mesh, a surface that the host drew */
#define SDV__TREE {"#vessel_cones", '>', 0}, {"#vessel_shapes", '=', 0}
#define SDV__SHAPES {"#vessel_cones", '>', 0}, {"#vessel_shapes", '>', 0}
#define SDV__SEEN {"#vessel_box", '>', 0}, {"#vessel_cones", '=', 0}
#define SDV__DRAWN {SDV__SEEN, {"#vessel_triangles", '=', 0}}
#define SDV__WITH_TREE {SDV__TREE}
#define SDV__WITH_SHAPES {SDV__SHAPES}
/* sdv_object_make_tree: the object has no cells of its own */
#define SDV__BY_DEVICE {"#vessel_cells", '=', 0}
#define SDV__WITH_CONES_ONLY {{"#vessel_cones", '>', 0}, SDV__BY_DEVICE}

static const lao_buffer_row sdv__buffers[] = {
    {"vessel_box", LAO_FORMAT_RGBA32F}, {"vessel_cells", LAO_FORMAT_RGBA32F}, {"vessel_ids", LAO_FORMAT_R32F},
    {"vessel_cones", LAO_FORMAT_RGBA32F}, {"vessel_forms", LAO_FORMAT_RGBA32F}, {"vessel_colors", LAO_FORMAT_RGBA8},
    {"vessel_shapes", LAO_FORMAT_RGBA32F}, {"vessel_fields", LAO_FORMAT_R32F},
    {"vessel_vertices", LAO_FORMAT_RGBA32F}, {"vessel_triangles", LAO_FORMAT_RGBA32F},
    {"vessel_pattern", LAO_FORMAT_R32F}
};

/* Kinds of items of the images below: lao_object_desc.further_items[kind - 1]. */
enum {
    SDV__CELLS = 1, SDV__REGION_PARTS, SDV__REGION_ENTRIES, SDV__BLOCK_PARTS, SDV__BLOCK_ENTRIES, SDV__ENTRIES, SDV__WORDS
};

static const lao_image_row sdv__images[] = {
    /* the field that the device builds; of pyramids of sums, levels down to one texel */
    {"vessel_region_counts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__REGION_PARTS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_region_masks", LAO_FORMAT_R32UI, LAO_SIZE_ITEMS, SDV__REGION_PARTS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_region_starts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__REGION_PARTS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_region_cones", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__REGION_ENTRIES, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_block_counts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__BLOCK_PARTS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_block_masks", LAO_FORMAT_R32UI, LAO_SIZE_ITEMS, SDV__BLOCK_PARTS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_block_starts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__BLOCK_PARTS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_block_cones", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__BLOCK_ENTRIES, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_counts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_masks", LAO_FORMAT_R32UI, LAO_SIZE_ITEMS, SDV__CELLS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_starts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_lists", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__ENTRIES, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_words", LAO_FORMAT_R32UI, LAO_SIZE_ITEMS, SDV__WORDS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_nearest_x", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_nearest_xy", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_grid", LAO_FORMAT_RGBA32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_position", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, -1}, {NULL, 0, 0}, {"position.X", "position.Y", "position.Z", "segment.V"}},
    {"vessel_normal",   LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0},  {NULL, 0, 0}, {"normal.X", "normal.Y", "normal.Z", "dmin.V"}},
    {"vessel_ray",      LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0},  {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"vessel_color",    LAO_FORMAT_RGBA8,   LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0},  {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"vessel_direction", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"guide", '>', 0}, {NULL, NULL, NULL, NULL}},
    {"vessel_drawn_depth", LAO_FORMAT_HOST, LAO_SIZE_FULL, 0, 0, NULL, LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"vessel_z",        LAO_FORMAT_D32F,    LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {1, 0, 0, 0},  {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    /* where there is a parameterization: of pyramids, levels down to one texel; what each holds stands in its shader */
    {"vessel_depth", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BACKGROUND, {NULL, NULL, NULL, NULL}},
    {"vessel_filled", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BACKGROUND, {NULL, NULL, NULL, NULL}},
    {"vessel_surface", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, LAO_IMAGE_HISTORY, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BACKGROUND, {"bgposition.X", "bgposition.Y", "bgposition.Z", NULL}},
    {"vessel_bgnormal", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BACKGROUND, {"bgnormal.X", "bgnormal.Y", "bgnormal.Z", NULL}},
    {"vessel_place", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_facing", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_tensor", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_spread", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_along", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_across", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_recalled", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_phase", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_uv", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, LAO_IMAGE_HISTORY, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {"uv.U", "uv.V", "guide.X", "guide.Y"}},
    {"vessel_ink", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, LAO_IMAGE_HISTORY, LAO_ENCODING_PLAIN, {1, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}}
};

static const lao_pass_row sdv__passes[] = {
    /* the field from cones alone: lists of regions, blocks and cells, then the nearest cell that has one */
    {"vessel_region_counts", LAO_PASS_FULLSCREEN, "vessel_lists", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_region_counts"), SDV__WRITE("vessel_region_masks")},
     {SDV__READ("#vessel_box"), SDV__READ("#vessel_cones")}},
    {"vessel_region_sums", LAO_PASS_FULLSCREEN, "vessel_sum", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_region_counts")},
     {SDV__FINER("vessel_region_counts")}},
    {"vessel_region_top", LAO_PASS_FULLSCREEN, "vessel_start", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__TOP("vessel_region_starts")},
     {SDV__TOP("vessel_region_counts")}},
    {"vessel_region_starts", LAO_PASS_FULLSCREEN, "vessel_start", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_region_starts")},
     {SDV__COARSER("vessel_region_starts"), SDV__READ("vessel_region_counts")}},
    {"vessel_region_cones", LAO_PASS_FULLSCREEN, "vessel_lists", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_region_cones")},
     {SDV__READ("#vessel_box"), SDV__READ("#vessel_cones"), SDV__READ("vessel_region_starts"), SDV__READ("vessel_region_starts"), SDV__READ("vessel_region_starts"), SDV__READ("vessel_region_masks")}},
    {"vessel_block_counts", LAO_PASS_FULLSCREEN, "vessel_lists", 2, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_block_counts"), SDV__WRITE("vessel_block_masks")},
     {SDV__READ("#vessel_box"), SDV__READ("#vessel_cones"), SDV__READ("vessel_region_starts"), SDV__READ("vessel_region_cones")}},
    {"vessel_block_sums", LAO_PASS_FULLSCREEN, "vessel_sum", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_block_counts")},
     {SDV__FINER("vessel_block_counts")}},
    {"vessel_block_top", LAO_PASS_FULLSCREEN, "vessel_start", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__TOP("vessel_block_starts")},
     {SDV__TOP("vessel_block_counts")}},
    {"vessel_block_starts", LAO_PASS_FULLSCREEN, "vessel_start", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_block_starts")},
     {SDV__COARSER("vessel_block_starts"), SDV__READ("vessel_block_counts")}},
    {"vessel_block_cones", LAO_PASS_FULLSCREEN, "vessel_lists", 3, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_block_cones")},
     {SDV__READ("#vessel_box"), SDV__READ("#vessel_cones"), SDV__READ("vessel_region_starts"), SDV__READ("vessel_region_cones"), SDV__READ("vessel_block_starts"), SDV__READ("vessel_block_masks")}},
    {"vessel_counts", LAO_PASS_FULLSCREEN, "vessel_lists", 4, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_counts"), SDV__WRITE("vessel_masks")},
     {SDV__READ("#vessel_box"), SDV__READ("#vessel_cones"), SDV__READ("vessel_block_starts"), SDV__READ("vessel_block_cones")}},
    {"vessel_sums", LAO_PASS_FULLSCREEN, "vessel_sum", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_counts")},
     {SDV__FINER("vessel_counts")}},
    {"vessel_top", LAO_PASS_FULLSCREEN, "vessel_start", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__TOP("vessel_starts")},
     {SDV__TOP("vessel_counts")}},
    {"vessel_starts", LAO_PASS_FULLSCREEN, "vessel_start", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_starts")},
     {SDV__COARSER("vessel_starts"), SDV__READ("vessel_counts")}},
    {"vessel_lists", LAO_PASS_FULLSCREEN, "vessel_lists", 5, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_lists")},
     {SDV__READ("#vessel_box"), SDV__READ("#vessel_cones"), SDV__READ("vessel_block_starts"), SDV__READ("vessel_block_cones"), SDV__READ("vessel_starts"), SDV__READ("vessel_masks")}},
    {"vessel_words", LAO_PASS_FULLSCREEN, "vessel_words", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_words")},
     {SDV__READ("#vessel_box"), SDV__READ("vessel_counts")}},
    {"vessel_rows", LAO_PASS_FULLSCREEN, "vessel_rows", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_nearest_x")},
     {SDV__READ("#vessel_box"), SDV__READ("vessel_words")}},
    {"vessel_columns", LAO_PASS_FULLSCREEN, "vessel_columns", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_nearest_xy")},
     {SDV__READ("#vessel_box"), SDV__READ("vessel_nearest_x")}},
    {"vessel_grid", LAO_PASS_FULLSCREEN, "vessel_grid", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__WRITE("vessel_grid")},
     {SDV__READ("#vessel_box"), SDV__READ("#vessel_cones"), SDV__READ("vessel_counts"), SDV__READ("vessel_starts"), SDV__READ("vessel_lists"), SDV__READ("vessel_nearest_xy")}},
    {"vessel_trace", LAO_PASS_FULLSCREEN, "vessel_trace", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_TREE,
     {SDV__WRITE("vessel_position"), SDV__WRITE("vessel_normal"), SDV__WRITE("vessel_ray")},
     {SDV__READ("#vessel_box"), SDV__READ("#vessel_cells"), SDV__READ("#vessel_ids"), SDV__READ("#vessel_cones"), SDV__READ("vessel_grid"), SDV__READ("vessel_lists")}},
    {"vessel_carve", LAO_PASS_FULLSCREEN, "vessel_carve", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_SHAPES,
     {SDV__WRITE("vessel_position"), SDV__WRITE("vessel_normal"), SDV__WRITE("vessel_ray")},
     {SDV__READ("#vessel_box"), SDV__READ("#vessel_cells"), SDV__READ("#vessel_ids"), SDV__READ("#vessel_cones"), SDV__READ("#vessel_shapes"), SDV__READ("#vessel_fields"), SDV__READ("vessel_grid"), SDV__READ("vessel_lists")}},
    {"vessel_mesh", LAO_PASS_DRAW_MESH, "vessel_mesh", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {{"#vessel_triangles", '>', 0}},
     {SDV__CLEAR("vessel_position"), SDV__CLEAR("vessel_normal"), SDV__CLEAR("vessel_color"), SDV__CLEAR("vessel_direction"), SDV__CLEAR("vessel_z")},
     {SDV__READ("#vessel_vertices"), SDV__READ("#vessel_triangles"), SDV__READ("#vessel_colors")}},
    /* of a surface that the host drew what it does not bring itself */
    {"vessel_drawn_place", LAO_PASS_FULLSCREEN, "vessel_drawn", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__DRAWN,
     {SDV__WRITE("vessel_position")},
     {SDV__READ("vessel_drawn_depth")}},
    {"vessel_drawn_normal", LAO_PASS_FULLSCREEN, "vessel_drawn", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__DRAWN,
     {SDV__WRITE("vessel_normal")},
     {SDV__READ("vessel_position")}},
    {"vessel_drawn_color", LAO_PASS_FULLSCREEN, "vessel_drawn", 2, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__DRAWN,
     {SDV__WRITE("vessel_color")},
     {SDV__READ("vessel_position")}},
    /* the void: depth pulled up and pushed down, then a place and a normal for every pixel (L19 3.4) */
    {"vessel_depth", LAO_PASS_FULLSCREEN, "vessel_depth", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_BACKGROUND,
     {SDV__WRITE("vessel_depth")},
     {SDV__READ("vessel_position"), SDV__BEFORE("vessel_surface")}},
    {"vessel_depth_up", LAO_PASS_FULLSCREEN, "vessel_pull", SDV_PULL_MEAN, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_BACKGROUND,
     {SDV__WRITE("vessel_depth")},
     {SDV__FINER("vessel_depth")}},
    {"vessel_fill_top", LAO_PASS_FULLSCREEN, "vessel_fill", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_BACKGROUND,
     {SDV__TOP("vessel_filled")},
     {SDV__TOP("vessel_depth"), SDV__TOP("vessel_depth")}},
    {"vessel_fill", LAO_PASS_FULLSCREEN, "vessel_fill", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_BACKGROUND,
     {SDV__WRITE("vessel_filled")},
     {SDV__READ("vessel_depth"), SDV__COARSER("vessel_filled")}},
    {"vessel_surface", LAO_PASS_FULLSCREEN, "vessel_surface", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {{"#vessel_cones", '>', 0}, SDV__BACKGROUND},
     {SDV__WRITE("vessel_surface"), SDV__WRITE("vessel_bgnormal"), SDV__WRITE("vessel_place"), SDV__WRITE("vessel_facing"), SDV__WRITE("vessel_tensor")},
     {SDV__READ("vessel_filled"), SDV__READ("vessel_depth"), SDV__READ("vessel_position"), SDV__READ("vessel_normal"), SDV__READ("#vessel_cones"), SDV__READ("vessel_normal")}},
    {"vessel_surface_seen", LAO_PASS_FULLSCREEN, "vessel_surface", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__SEEN, SDV__BACKGROUND},
     {SDV__WRITE("vessel_surface"), SDV__WRITE("vessel_bgnormal"), SDV__WRITE("vessel_place"), SDV__WRITE("vessel_facing"), SDV__WRITE("vessel_tensor")},
     {SDV__READ("vessel_filled"), SDV__READ("vessel_depth"), SDV__READ("vessel_position"), SDV__READ("vessel_normal"), SDV__READ("#vessel_cones"), SDV__READ("vessel_direction")}},
    /* the guiding field of the contours (L19 3.5) */
    {"vessel_place_up", LAO_PASS_FULLSCREEN, "vessel_gather", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__WRITE("vessel_place"), SDV__WRITE("vessel_facing")},
     {SDV__FINER("vessel_place"), SDV__FINER("vessel_facing")}},
    {"vessel_tensor_up", LAO_PASS_FULLSCREEN, "vessel_pull", SDV_PULL_SUM, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__WRITE("vessel_tensor")},
     {SDV__FINER("vessel_tensor")}},
    {"vessel_guide_top", LAO_PASS_FULLSCREEN, "vessel_guide", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__TOP("vessel_spread"), SDV__TOP("vessel_along"), SDV__TOP("vessel_across")},
     {SDV__TOP("vessel_tensor"), SDV__TOP("vessel_place"), SDV__TOP("vessel_facing"), SDV__TOP("vessel_tensor"), SDV__TOP("vessel_place"), SDV__TOP("vessel_facing")}},
    {"vessel_guide", LAO_PASS_FULLSCREEN, "vessel_guide", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__WRITE("vessel_spread"), SDV__WRITE("vessel_along"), SDV__WRITE("vessel_across")},
     {SDV__READ("vessel_tensor"), SDV__READ("vessel_place"), SDV__READ("vessel_facing"), SDV__COARSER("vessel_spread"), SDV__COARSER("vessel_place"), SDV__COARSER("vessel_along")}},
    /* phases: the last frame's pulled up, then pushed down and optimised (L19 3.6, 3.7) */
    {"vessel_recall", LAO_PASS_FULLSCREEN, "vessel_recall", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__WRITE("vessel_recalled")},
     {SDV__READ("vessel_surface"), SDV__READ("vessel_bgnormal"), SDV__READ("vessel_along"), SDV__READ("vessel_across"), SDV__BEFORE("vessel_surface"), SDV__BEFORE("vessel_uv"), SDV__BEFORE("vessel_ink")}},
    {"vessel_recall_up", LAO_PASS_FULLSCREEN, "vessel_recall_up", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__WRITE("vessel_recalled")},
     {SDV__FINER("vessel_recalled"), SDV__FINER("vessel_place"), SDV__FINER("vessel_along"), SDV__FINER("vessel_across"), SDV__READ("vessel_place"), SDV__READ("vessel_along"), SDV__READ("vessel_across")}},
    {"vessel_phase_top", LAO_PASS_FULLSCREEN, "vessel_phase", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__TOP("vessel_phase")},
     {SDV__TOP("vessel_recalled"), SDV__TOP("vessel_place"), SDV__TOP("vessel_along"), SDV__TOP("vessel_across"), SDV__TOP("vessel_place"), SDV__TOP("vessel_along"), SDV__TOP("vessel_across"), SDV__TOP("vessel_recalled")}},
    {"vessel_phase", LAO_PASS_FULLSCREEN, "vessel_phase", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__WRITE("vessel_phase")},
     {SDV__READ("vessel_recalled"), SDV__READ("vessel_place"), SDV__READ("vessel_along"), SDV__READ("vessel_across"), SDV__COARSER("vessel_place"), SDV__COARSER("vessel_along"), SDV__COARSER("vessel_across"), SDV__COARSER("vessel_phase")}},
    {"vessel_sweep", LAO_PASS_FULLSCREEN, "vessel_sweep", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, "ssp_sweeps", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__OTHER("vessel_phase")},
     {SDV__READ("vessel_phase"), SDV__READ("vessel_place"), SDV__READ("vessel_along"), SDV__READ("vessel_across")}},
    {"vessel_uv", LAO_PASS_FULLSCREEN, "vessel_uv", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__WRITE("vessel_uv")},
     {SDV__READ("vessel_phase"), SDV__READ("vessel_spread"), SDV__READ("vessel_along"), SDV__READ("vessel_surface"), SDV__BEFORE("vessel_surface"), SDV__BEFORE("vessel_uv")}},
    /* strokes and dots, where phases changed faded over */
    {"vessel_ink", LAO_PASS_FULLSCREEN, "vessel_ink", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__TREE, SDV__PARAMETERIZED},
     {SDV__WRITE("vessel_ink")},
     {SDV__READ("vessel_surface"), SDV__READ("vessel_bgnormal"), SDV__READ("vessel_normal"), SDV__READ("vessel_ray"),
      SDV__READ("#vessel_box"), SDV__READ("#vessel_cells"), SDV__READ("#vessel_ids"), SDV__READ("#vessel_cones"),
      SDV__READ("#vessel_shapes"), SDV__READ("#vessel_fields"), SDV__READ("vessel_uv"), SDV__READ("vessel_recalled"),
      SDV__READ("#vessel_pattern"), SDV__READ("#vessel_colors"), SDV__READ("vessel_grid"), SDV__READ("vessel_lists")}},
    {"vessel_ink_cut", LAO_PASS_FULLSCREEN, "vessel_ink", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__SHAPES, SDV__PARAMETERIZED},
     {SDV__WRITE("vessel_ink")},
     {SDV__READ("vessel_surface"), SDV__READ("vessel_bgnormal"), SDV__READ("vessel_normal"), SDV__READ("vessel_ray"),
      SDV__READ("#vessel_box"), SDV__READ("#vessel_cells"), SDV__READ("#vessel_ids"), SDV__READ("#vessel_cones"),
      SDV__READ("#vessel_shapes"), SDV__READ("#vessel_fields"), SDV__READ("vessel_uv"), SDV__READ("vessel_recalled"),
      SDV__READ("#vessel_pattern"), SDV__READ("#vessel_colors"), SDV__READ("vessel_grid"), SDV__READ("vessel_lists")}},
    {"vessel_ink_seen", LAO_PASS_FULLSCREEN, "vessel_ink", 2, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__SEEN, SDV__PARAMETERIZED},
     {SDV__WRITE("vessel_ink")},
     {SDV__READ("vessel_surface"), SDV__READ("vessel_bgnormal"), SDV__READ("vessel_normal"), SDV__READ("vessel_normal"),
      SDV__READ("#vessel_box"), SDV__READ("#vessel_cells"), SDV__READ("#vessel_ids"), SDV__READ("#vessel_cones"),
      SDV__READ("#vessel_shapes"), SDV__READ("#vessel_fields"), SDV__READ("vessel_uv"), SDV__READ("vessel_recalled"),
      SDV__READ("#vessel_pattern"), SDV__READ("#vessel_colors"), SDV__READ("vessel_normal"), SDV__READ("vessel_normal")}},
    {"vessel_shade", LAO_PASS_FULLSCREEN, "vessel_shade", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, SDV__WITH_TREE,
     {SDV__KEEP("shaded"), SDV__KEEP("zbuffer")},
     {SDV__READ("vessel_position"), SDV__READ("vessel_normal"), SDV__READ("vessel_ray"), SDV__READ("#vessel_colors"),
      SDV__READ("#vessel_box"), SDV__READ("#vessel_cells"), SDV__READ("#vessel_ids"), SDV__READ("#vessel_cones"),
      SDV__READ("#vessel_shapes"), SDV__READ("#vessel_fields"),
      SDV__READ("vessel_surface"), SDV__READ("vessel_bgnormal"), SDV__READ("vessel_ink"), SDV__READ("vessel_normal"), SDV__READ("vessel_grid"), SDV__READ("vessel_lists")}},
    {"vessel_shade_cut", LAO_PASS_FULLSCREEN, "vessel_shade", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, SDV__WITH_SHAPES,
     {SDV__KEEP("shaded"), SDV__KEEP("zbuffer")},
     {SDV__READ("vessel_position"), SDV__READ("vessel_normal"), SDV__READ("vessel_ray"), SDV__READ("#vessel_colors"),
      SDV__READ("#vessel_box"), SDV__READ("#vessel_cells"), SDV__READ("#vessel_ids"), SDV__READ("#vessel_cones"),
      SDV__READ("#vessel_shapes"), SDV__READ("#vessel_fields"),
      SDV__READ("vessel_surface"), SDV__READ("vessel_bgnormal"), SDV__READ("vessel_ink"), SDV__READ("vessel_normal"), SDV__READ("vessel_grid"), SDV__READ("vessel_lists")}},
    {"vessel_shade_seen", LAO_PASS_FULLSCREEN, "vessel_shade", 2, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {SDV__SEEN},
     {SDV__KEEP("shaded"), SDV__KEEP("zbuffer")},
     {SDV__READ("vessel_position"), SDV__READ("vessel_normal"), SDV__READ("vessel_normal"), SDV__READ("#vessel_colors"),
      SDV__READ("#vessel_box"), SDV__READ("#vessel_cells"), SDV__READ("#vessel_ids"), SDV__READ("#vessel_cones"),
      SDV__READ("#vessel_shapes"), SDV__READ("#vessel_fields"),
      SDV__READ("vessel_surface"), SDV__READ("vessel_bgnormal"), SDV__READ("vessel_ink"), SDV__READ("vessel_color"), SDV__READ("vessel_normal"), SDV__READ("vessel_normal")}}
};

static const lao_setting_row sdv__settings[] = {
#define SDV__ROW(name, type, minimum, maximum, standard, structural, unit, choices, help) \
    {#name, LAO_SETTING_##type, minimum, maximum, standard, structural, unit, choices, help},
    SDV_SETTINGS(SDV__ROW)
};

static const lao_module sdv__module = {
    "vessel",
    sdv__passes, (uint32_t)(sizeof sdv__passes / sizeof sdv__passes[0]),
    sdv__images, (uint32_t)(sizeof sdv__images / sizeof sdv__images[0]),
    sdv__settings, (uint32_t)(sizeof sdv__settings / sizeof sdv__settings[0]),
    NULL, 0, NULL, 0,
    sdv__buffers, (uint32_t)(sizeof sdv__buffers / sizeof sdv__buffers[0])
};
// clang-format on

/* ---- pull-push of a host's image */
// clang-format off
#define SDV__OF_HOST {"@pull_push_image", '>', 0}
static const lao_image_row sdv__pull_push_images[] = {
    {"pull_push_image",  LAO_FORMAT_HOST,    LAO_SIZE_VIEW, 0, 0, NULL, LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"pull_push_result", LAO_FORMAT_HOST,    LAO_SIZE_VIEW, 0, 0, NULL, LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"pull_push_level",  LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*",  0,                LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"pull_push_filled", LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*",  0,                LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}}
};
static const lao_pass_row sdv__pull_push_passes[] = {
    {"pull_push_start", LAO_PASS_FULLSCREEN, "vessel_push", 2, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST},
     {SDV__WRITE("pull_push_level")},
     {SDV__READ("pull_push_image"), SDV__READ("pull_push_image")}},
    {"pull_push_mean", LAO_PASS_FULLSCREEN, "vessel_pull", SDV_PULL_MEAN, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST, {"pull", '=', SDV_PULL_MEAN}},
     {SDV__WRITE("pull_push_level")},
     {SDV__FINER("pull_push_level")}},
    {"pull_push_sum", LAO_PASS_FULLSCREEN, "vessel_pull", SDV_PULL_SUM, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST, {"pull", '=', SDV_PULL_SUM}},
     {SDV__WRITE("pull_push_level")},
     {SDV__FINER("pull_push_level")}},
    {"pull_push_top", LAO_PASS_FULLSCREEN, "vessel_push", 1, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST},
     {SDV__TOP("pull_push_filled")},
     {SDV__TOP("pull_push_level"), SDV__TOP("pull_push_level")}},
    {"pull_push_down", LAO_PASS_FULLSCREEN, "vessel_push", 0, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST},
     {SDV__WRITE("pull_push_filled")},
     {SDV__READ("pull_push_level"), SDV__COARSER("pull_push_filled")}},
    {"pull_push_result", LAO_PASS_FULLSCREEN, "vessel_push", 2, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST, {"@pull_push_result", '>', 0}},
     {SDV__WRITE("pull_push_result")},
     {SDV__READ("pull_push_filled"), SDV__READ("pull_push_filled")}}
};
static const lao_setting_row sdv__pull_push_settings[] = {
    SDV_PULL_PUSH_SETTINGS(SDV__ROW)
};
#undef SDV__ROW
static const lao_module sdv__pull_push_module = {
    "pull_push",
    sdv__pull_push_passes, (uint32_t)(sizeof sdv__pull_push_passes / sizeof sdv__pull_push_passes[0]),
    sdv__pull_push_images, (uint32_t)(sizeof sdv__pull_push_images / sizeof sdv__pull_push_images[0]),
    sdv__pull_push_settings, (uint32_t)(sizeof sdv__pull_push_settings / sizeof sdv__pull_push_settings[0]),
    NULL, 0, NULL, 0, NULL, 0
};
// clang-format on

SDV_API const lao_module *sdv_pull_push_module(void) {
    return &sdv__pull_push_module;
}

SDV_API void sdv_camera_margin(const lao_camera *camera, uint32_t width, uint32_t height,
                               uint32_t margin, lao_camera *wider) {
    double x = (double)width / ((double)width + 2.0 * margin);
    double y = (double)height / ((double)height + 2.0 * margin);
    size_t column;
    *wider = *camera;
    for (column = 0; column < 16; column += 4) {
        wider->projection[column] = (float)(x * (double)camera->projection[column]);
        wider->projection[column + 1] = (float)(y * (double)camera->projection[column + 1]);
    }
}

SDV_API const lao_module *sdv_module(void) {
    return &sdv__module;
}

/* Gives the object a buffer, in place of the one of that name. */
static void sdv__object_buffer(sdv_object *object, const char *name, const void *data,
                               uint32_t count) {
    uint32_t i = 0;
    while (i < object->desc.buffer_count && strcmp(object->buffers[i].name, name) != 0) {
        i++;
    }
    object->buffers[i].name = name;
    object->buffers[i].data = data;
    object->buffers[i].texel_count = count;
    object->desc.buffers = object->buffers;
    object->desc.buffer_count += i == object->desc.buffer_count;
}

static void sdv__object_drop(sdv_object *object, const char *name) {
    uint32_t i, kept = 0;
    for (i = 0; i < object->desc.buffer_count; i++) {
        if (strcmp(object->buffers[i].name, name) != 0) {
            object->buffers[kept++] = object->buffers[i];
        }
    }
    object->desc.buffer_count = kept;
}

/* Box, cones, and the lists where there are any. */
static void sdv__object_grid(sdv_object *object, const sdv_grid *grid) {
    size_t i;
    int k;
    object->box[0] = lao_v4_make(grid->origin.x, grid->origin.y, grid->origin.z, grid->cell);
    object->box[1] = lao_v4_make((float)grid->size[0], (float)grid->size[1], (float)grid->size[2],
                                 (float)grid->cone_count);
    sdv__object_buffer(object, "vessel_box", object->box, 2);
    if (grid->cells) {
        sdv__object_buffer(object, "vessel_cells", grid->cells, grid->cell_count);
        sdv__object_buffer(object, "vessel_ids", grid->ids, grid->id_count);
    }
    sdv__object_buffer(object, "vessel_cones", grid->cones,
                       (grid->forms ? 5 : 2) * grid->cone_count);
    if (grid->forms) {
        sdv__object_buffer(object, "vessel_forms", grid->forms, 1);
    }
    object->desc.item_count = grid->cone_count;
    for (i = 0; i < grid->cone_count * (size_t)2; i++) {
        const lao_v4 *ball = &grid->cones[i];
        const float centre[3] = {ball->x, ball->y, ball->z};
        for (k = 0; k < 3; k++) {
            float low = centre[k] - ball->w, high = centre[k] + ball->w;
            object->desc.bounds[0][k] = i ? lao_min(object->desc.bounds[0][k], low) : low;
            object->desc.bounds[1][k] = i ? lao_max(object->desc.bounds[1][k], high) : high;
        }
    }
}

/* The host's colours of cones, or coral for all. 0: no memory. */
static int sdv__object_colors(sdv_object *object, const uint8_t *colors, uint32_t cone_count) {
    static const uint8_t coral[4] = {226, 106, 92, 255};
    size_t i, size = 8 * (size_t)cone_count;
    if (!colors) {
        uint8_t *own = (uint8_t *)sdv__take(&object->allocator, size, 1);
        if (!own) {
            return 0;
        }
        for (i = 0; i < size; i++) {
            own[i] = coral[i % 4];
        }
        object->memory = own;
        colors = own;
    }
    sdv__object_buffer(object, "vessel_colors", colors, 2 * cone_count);
    return 1;
}

SDV_API lao_result sdv_object_make(const sdv_host *host, const sdv_grid *grid,
                                   const uint8_t *colors, sdv_object *object) {
    if (!grid || !object || !grid->cells || !grid->cone_count) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_make");
    }
    memset(object, 0, sizeof *object);
    object->allocator = sdv__allocator(host);
    sdv__object_grid(object, grid);
    return sdv__object_colors(object, colors, grid->cone_count)
               ? LAO_OK
               : sdv__fail(host, SDV_LOG_MEMORY, "colours of cones");
}

/* ---- built by the device */
/* Cells along an axis to a block of the lists; as the shader has it. */
static uint32_t sdv__block_edge(const sdv_grid *g) {
    uint32_t k, most = 0;
    for (k = 0; k < 3; k++) {
        most = g->size[k] > most ? g->size[k] : most;
    }
    return (most + SDV_BLOCKS - 1) / SDV_BLOCKS;
}
/* Blocks (or regions) of so many cells along an axis, all of them. */
static double sdv__blocks(const sdv_grid *g, uint32_t edge) {
    double n = 1;
    uint32_t k;
    for (k = 0; k < 3; k++) {
        n *= (double)sdv__parts(g->size[k], edge);
    }
    return n;
}
/* Most cells that list a cone: those in its box with the reach of lists around it, and no more than
   the volume that their own volumes reach into. */
static double sdv__most_cells(const sdv_grid *g, const lao_v4 *cone) {
    sdv__raster r = sdv__raster_make(g, cone);
    const double t[2] = {0, 1};
    double cells = 1, length = 0, radius = (r.ra > r.rb ? r.ra : r.rb) / (double)g->cell + 0.8661;
    uint32_t range[2];
    int k;
    for (k = 0; k < 3; k++) {
        double d = (r.b[k] - r.a[k]) / (double)g->cell;
        sdv__raster_range(g, &r, k, t, range);
        cells *= range[1] > range[0] ? (double)(range[1] - range[0]) : 0.0;
        length += d * d;
    }
    length = 3.1416 * radius * radius * (sqrt(length) + 4.0 / 3.0 * radius) + 1.0;
    return cells < length ? cells : length;
}
/* Most blocks of so many cells that list it: those whose middles are in its box with their reach
   around it. The last along an axis may be smaller, and its middle lower. */
static double sdv__most_blocks(const sdv_grid *g, const lao_v4 *cone, uint32_t edge) {
    lao_v3 last = lao_v3_make(1, 1, 1);
    double blocks = 1, size = (double)edge * (double)g->cell, reach;
    uint32_t k;
    last = lao_v3_scale(last, (float)(edge - 1));
    reach = 1.01 * (double)sdv_block_reach(sdv__grid_box(g), lao_v3_make(0, 0, 0), last).w;
    for (k = 0; k < 3; k++) {
        double n = (double)sdv__parts(g->size[k], edge);
        float a = sdv__v4_at(cone[0], k), b = sdv__v4_at(cone[1], k);
        double origin = (double)sdv__v3_at(g->origin, k);
        double low = (double)lao_min(a - cone[0].w, b - cone[1].w) - reach;
        double high = (double)lao_max(a + cone[0].w, b + cone[1].w) + reach;
        low = ceil((low - origin) / size - 0.5);
        high = floor((high - origin) / size - 0.5);
        low = low > 0 ? low : 0;
        high = high >= n - 2 ? n - 1 : high;
        blocks *= high >= low ? high - low + 1 : 0;
    }
    return blocks;
}
/* Room for a little more, so that not every move makes a new plan: in steps of 1/8. */
static double sdv__roomy(double n) {
    double step = 1;
    while (8 * step < n) {
        step *= 2;
    }
    return step * ceil(n / step);
}
/* Sizes the images of items; 0: the device cannot hold them. Nothing shrinks. */
static int sdv__device_items(const sdv_grid *g, uint32_t image_size, uint32_t *items) {
    double count[LAO_FURTHER_ITEMS + 1] = {0}; /* by kind */
    uint32_t i, edge = sdv__block_edge(g);
    for (i = 0; i < g->cone_count; i++) {
        const lao_v4 *cone = g->cones + 2 * (size_t)i;
        count[SDV__REGION_ENTRIES] += sdv__most_blocks(g, cone, edge * SDV_REGION);
        count[SDV__BLOCK_ENTRIES] += sdv__most_blocks(g, cone, edge);
        count[SDV__ENTRIES] += sdv__most_cells(g, cone);
    }
    count[SDV__REGION_ENTRIES] = sdv__roomy(count[SDV__REGION_ENTRIES]);
    count[SDV__BLOCK_ENTRIES] = sdv__roomy(count[SDV__BLOCK_ENTRIES]);
    count[SDV__ENTRIES] = sdv__roomy(count[SDV__ENTRIES]);
    /* one more of each holds the sum */
    count[SDV__REGION_PARTS] =
        sdv__blocks(g, edge * SDV_REGION) * ceil((double)g->cone_count / SDV_CHUNK) + 1;
    count[SDV__BLOCK_PARTS] = sdv__blocks(g, edge) * SDV_BLOCK_PARTS + 1;
    count[SDV__CELLS] = (double)g->cell_count + 1;
    count[SDV__WORDS] = ceil(g->size[0] / 32.0) * g->size[1] * g->size[2];
    for (i = 0; i < LAO_FURTHER_ITEMS; i++) {
        double n = count[i + 1];
        if (image_size < LAO_ITEMS_WIDTH || n > SDV__EXACT ||
            n > (double)LAO_ITEMS_WIDTH * image_size) {
            return 0;
        }
    }
    for (i = 0; i < LAO_FURTHER_ITEMS; i++) {
        items[i] = count[i + 1] > items[i] ? (uint32_t)count[i + 1] : items[i];
    }
    return 1;
}

/* A grid's box and cones, without its cells. */
static lao_result sdv__grid_cones(const sdv_host *host, const sdv_tree *tree,
                                  const sdv_grid_desc *desc, sdv_grid *g) {
    memset(g, 0, sizeof *g);
    g->allocator = sdv__allocator(host);
    g->cone_count = tree->segment_count + sdv__lone_count(tree);
    if (g->cone_count > SDV__EXACT) {
        return sdv__fail(host, SDV_LOG_GRID_LISTS, "%u segments", g->cone_count);
    }
    if (!sdv__grid_frame(tree, desc, g)) {
        return sdv__fail(host, SDV_LOG_GRID_CELLS, "%u x %u x %u", g->size[0], g->size[1],
                         g->size[2]);
    }
    sdv__cones_take(tree, g);
    if (!g->cones || !g->cone_nodes) {
        sdv_grid_free(g);
        return sdv__fail(host, SDV_LOG_MEMORY, "a grid's %u cones", g->cone_count);
    }
    sdv__cones_fill(tree, g);
    return LAO_OK;
}
/* Cells for a grid that has its box and cones. On failure the grid is as before. */
static lao_result sdv__grid_complete(const sdv_host *host, const sdv_tree *tree, sdv_grid *grid) {
    sdv_grid_desc same;
    sdv_grid built;
    lao_result result;
    memset(&same, 0, sizeof same);
    same.origin = &grid->origin.x;
    same.cell = grid->cell;
    memcpy(same.size, grid->size, sizeof same.size);
    result = sdv_grid_build(host, tree, &same, &built);
    if (result == LAO_OK) {
        sdv_grid_free(grid);
        *grid = built;
    }
    return result;
}
/* Who builds the field of the grid: the device if it can, else the CPU, here. */
static lao_result sdv__object_field(const sdv_host *host, const sdv_tree *tree, sdv_grid *grid,
                                    sdv_object *object) {
    uint32_t items[LAO_FURTHER_ITEMS];
    lao_result result = LAO_OK;
    int fits;
    memcpy(items, object->desc.further_items, sizeof items);
    fits = sdv__device_items(grid, object->image_size, items);
    if (!fits) {
        (void)sdv__fail(host, SDV_LOG_GRID_DEVICE, "%u cells, %u segments", grid->cell_count,
                        grid->cone_count);
        result = sdv__grid_complete(host, tree, grid);
    }
    if (result == LAO_OK) {
        object->on_device = (uint32_t)fits;
        memcpy(object->desc.further_items, items, sizeof items);
    }
    return result;
}

SDV_API lao_result sdv_object_make_tree(const sdv_host *host, const sdv_tree *tree,
                                        const sdv_grid_desc *desc, uint32_t image_size,
                                        const uint8_t *colors, sdv_object *object) {
    sdv_grid_desc standard;
    lao_result result;
    memset(&standard, 0, sizeof standard);
    if (!tree || !object || !tree->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_make_tree");
    }
    memset(object, 0, sizeof *object);
    object->allocator = sdv__allocator(host);
    object->image_size = image_size;
    result = sdv__grid_cones(host, tree, desc ? desc : &standard, &object->grid);
    if (result == LAO_OK) {
        result = sdv__object_field(host, tree, &object->grid, object);
    }
    if (result == LAO_OK) {
        sdv__object_grid(object, &object->grid);
        if (!sdv__object_colors(object, colors, object->grid.cone_count)) {
            result = sdv__fail(host, SDV_LOG_MEMORY, "colours of cones");
        }
    }
    if (result != LAO_OK) {
        sdv_object_free(object);
    }
    return result;
}

/* ---- the vessel that is nearest, however far */
/* Cones in the order of their middles, SDV_LEAF_CONES a leaf, under balls around what is below
   (see the shared text). */
static void sdv__nearest_order(const lao_v4 *cones, uint32_t count, uint32_t *keys) {
    double low[3], high[3], size = 0;
    uint32_t i, k;
    sdv__ball_bounds(cones, 2 * count, low, high);
    for (k = 0; k < 3; k++) {
        size = high[k] - low[k] > size ? high[k] - low[k] : size;
    }
    for (i = 0; i < count; i++) {
        const lao_v4 *c = cones + 2 * (size_t)i;
        lao_v3 a = lao_v3_make(c[0].x, c[0].y, c[0].z), b = lao_v3_make(c[1].x, c[1].y, c[1].z);
        sdv__piece s;
        s.u = a;
        s.v = b;
        s.w = lao_v3_along(a, lao_v3_sub(b, a), 0.5f);
        keys[i] = sdv__morton(&s, low, size);
    }
    sdv__sort(keys, count, keys + count, keys + 2 * (size_t)count);
}
static lao_v4 sdv__nearest_ball(const lao_v4 *cones, const uint32_t *order, uint32_t first,
                                uint32_t end) {
    lao_v3 low = lao_v3_make(SDV_FAR, SDV_FAR, SDV_FAR), high = lao_v3_scale(low, -1.0f);
    uint32_t i, k;
    for (i = first; i < end; i++) {
        for (k = 0; k < 2; k++) {
            lao_v4 c = cones[2 * (size_t)order[i] + k];
            sdv__box_grow(&low, &high, lao_v3_make(c.x - c.w, c.y - c.w, c.z - c.w));
            sdv__box_grow(&low, &high, lao_v3_make(c.x + c.w, c.y + c.w, c.z + c.w));
        }
    }
    return first < end ? sdv__box_ball(&low, &high) : lao_v4_make(0.0f, 0.0f, 0.0f, -SDV_FAR);
}
static void sdv__nearest_fill(const lao_v4 *cones, uint32_t count, const uint32_t *order,
                              uint32_t leaves, lao_v4 *balls) {
    uint32_t node, i, wide = leaves * SDV_LEAF_CONES; /* cones below a node */
    balls[0] = lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    for (node = 1; node < 2 * leaves; node++) {
        uint32_t first, end;
        wide /= node > 1 && (node & (node - 1)) == 0 ? 2u : 1u; /* the first of its level */
        first = node * wide - leaves * SDV_LEAF_CONES;
        end = first + wide < count ? first + wide : count;
        balls[node] = sdv__nearest_ball(cones, order, first, end);
    }
    for (i = 0; i < leaves; i++) {
        float id[SDV_LEAF_CONES];
        uint32_t k;
        for (k = 0; k < SDV_LEAF_CONES; k++) {
            uint32_t at = i * SDV_LEAF_CONES + k;
            id[k] = at < count ? (float)order[at] : -1.0f;
        }
        balls[2 * (size_t)leaves + i] = lao_v4_make(id[0], id[1], id[2], id[3]);
    }
}
/* The buffer of the shapes, which are in object->shapes: with the hierarchy behind them where one
   takes the colour of the nearest vessel. */
static lao_result sdv__object_nearest(const sdv_host *host, sdv_object *object) {
    const lao_allocator *a = &object->allocator;
    const lao_v4 *cones = NULL;
    uint32_t i, wanted = 0, leaves = 1, count = 0, *keys;
    uint32_t shapes = (uint32_t)object->shapes[0].x, first = 1 + 4 * shapes;
    lao_v4 *texels;
    for (i = 0; i < shapes; i++) {
        wanted |= object->shapes[4 + 4 * (size_t)i].w < 0.5f;
    }
    for (i = 0; i < object->desc.buffer_count; i++) {
        if (strcmp(object->buffers[i].name, "vessel_cones") == 0) {
            cones = (const lao_v4 *)object->buffers[i].data;
            count = (uint32_t)object->box[1].w;
        }
    }
    if (!wanted || !cones) {
        object->shapes[0].w = 0.0f;
        sdv__object_buffer(object, "vessel_shapes", object->shapes, first);
        return LAO_OK;
    }
    for (; leaves * SDV_LEAF_CONES < count; leaves *= 2) {
    }
    texels = (lao_v4 *)sdv__take(a, first + 3 * (uint64_t)leaves, sizeof *texels);
    keys = (uint32_t *)sdv__take(a, 3 * (uint64_t)count, sizeof *keys); /* and order, other */
    if (texels && keys) {
        object->shapes[0].z = (float)first;
        object->shapes[0].w = (float)leaves;
        memcpy(texels, object->shapes, first * sizeof *texels);
        sdv__nearest_order(cones, count, keys);
        sdv__nearest_fill(cones, count, keys + count, leaves, texels + first);
        sdv__give(a, object->nearest);
        object->nearest = texels;
        sdv__object_buffer(object, "vessel_shapes", texels, first + 3 * leaves);
        sdv__give(a, keys);
        return LAO_OK;
    }
    sdv__give(a, texels);
    sdv__give(a, keys);
    return sdv__fail(host, SDV_LOG_MEMORY, "the nearest of %u vessels", count);
}

/* The cones of the tree as it is now, and a new box where it has left the old one. */
static lao_result sdv__object_renew(const sdv_host *host, const sdv_tree *tree,
                                    sdv_object *object) {
    const sdv_grid *old = &object->grid;
    sdv_grid_desc desc;
    sdv_grid grid;
    lao_result result;
    uint32_t k;
    memset(&desc, 0, sizeof desc);
    if (sdv__grid_holds(old, tree)) {
        desc.origin = &old->origin.x;
        desc.cell = old->cell;
        memcpy(desc.size, old->size, sizeof desc.size);
    }
    desc.resolution = 16;
    for (k = 0; k < 3; k++) {
        desc.resolution = old->size[k] > desc.resolution ? old->size[k] : desc.resolution;
    }
    result = sdv__grid_cones(host, tree, &desc, &grid);
    if (result == LAO_OK) {
        result = sdv__object_field(host, tree, &grid, object);
        sdv_grid_free(result == LAO_OK ? &object->grid : &grid);
    }
    if (result == LAO_OK) {
        object->grid = grid;
    }
    return result;
}

SDV_API lao_result sdv_object_move(const sdv_host *host, const sdv_tree *tree,
                                   const uint32_t *nodes, uint32_t count, sdv_object *object) {
    lao_result result;
    if (!object || !object->grid.cones) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_move");
    }
    result = sdv__grid_fits(host, tree, nodes, count, &object->grid);
    if (result == LAO_OK) {
        result = object->on_device ? sdv__object_renew(host, tree, object)
                                   : sdv_grid_update(host, tree, nodes, count, &object->grid);
    }
    if (result == LAO_OK) {
        sdv__object_grid(object, &object->grid);
        result = object->nearest ? sdv__object_nearest(host, object) : LAO_OK;
    }
    return result;
}

static bool sdv__shape_fits(const sdv_shape *s, uint32_t field_count) {
    double size = (double)s->b.x * (double)s->b.y * (double)s->b.z;
    uint32_t i;
    for (i = 0; i < 4; i++) {
        if (!(fabsf(sdv__v4_at(s->a, i)) <= 1e9f && fabsf(sdv__v4_at(s->b, i)) <= 1e9f)) {
            return false;
        }
    }
    if (s->kind == SDV_SHAPE_TREE) {
        return s->operation != SDV_SUBTRACTION;
    }
    if (s->kind == SDV_SHAPE_ELLIPSOID) {
        return s->b.x > 0.0f && s->b.y > 0.0f && s->b.z > 0.0f;
    }
    return s->kind != SDV_SHAPE_FIELD ||
           (s->a.w > 0.0f && s->b.x >= 2.0f && s->b.y >= 2.0f && s->b.z >= 2.0f && s->b.w >= 0.0f &&
            (double)s->b.w + size <= field_count);
}

SDV_API lao_result sdv_object_shapes(const sdv_host *host, const sdv_shapes *shapes,
                                     const float *colors, sdv_object *object) {
    uint32_t i;
    if (!object || !shapes || (shapes->count && !shapes->shapes)) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_shapes");
    }
    if (shapes->count > SDV_MOST_SHAPES || (shapes->field_count && !shapes->fields) ||
        shapes->field_count > 1u << 24) {
        return sdv__fail(host, SDV_LOG_SHAPES, "%u shapes", shapes->count);
    }
    for (i = 0; i < shapes->count; i++) {
        if (!sdv__shape_fits(&shapes->shapes[i], shapes->field_count)) {
            return sdv__fail(host, SDV_LOG_SHAPES, "shape %u", i);
        }
    }
    object->shapes[0] =
        lao_v4_make((float)shapes->count, sdv__united(shapes) ? 1.0f : 0.0f, 0.0f, 0.0f);
    for (i = 0; i < shapes->count; i++) {
        const sdv_shape *s = &shapes->shapes[i];
        lao_v4 *to = object->shapes + 1 + 4 * (size_t)i;
        to[0] = s->a;
        to[1] = s->b;
        to[2] = lao_v4_make((float)s->kind, (float)s->operation, 0.0f, 0.0f);
        to[3] = lao_v4_make(0.93f, 0.86f, 0.72f, 1.0f);
        if (colors) {
            const float *c = colors + (size_t)3 * i;
            to[3] = lao_v4_make(c[0], c[1], c[2], c[0] < 0.0f ? 0.0f : 1.0f);
        }
    }
    if (shapes->field_count) {
        sdv__object_buffer(object, "vessel_fields", shapes->fields, shapes->field_count);
    } else {
        sdv__object_drop(object, "vessel_fields");
    }
    return sdv__object_nearest(host, object);
}

/* Fills the buffers of a mesh, which stand one behind the other in `memory`: three texels a vertex,
   one a triangle, colours. 0: the mesh is none. */
static int sdv__mesh_fill(const sdv_mesh_desc *d, lao_v4 *vertices, lao_v4 *triangles,
                          uint8_t *colors, float bounds[2][3]) {
    uint32_t i, k;
    for (i = 0; i < d->vertex_count; i++) {
        const float *p = d->positions + 3 * (size_t)i, *n = d->normals + 3 * (size_t)i;
        const float *z = d->directions ? d->directions + 3 * (size_t)i : NULL;
        lao_v4 *to = vertices + 3 * (size_t)i;
        for (k = 0; k < 3; k++) {
            if (!(fabsf(p[k]) <= 1e9f && fabsf(n[k]) <= 1e9f && (!z || fabsf(z[k]) <= 1e9f))) {
                return 0;
            }
            bounds[0][k] = i ? lao_min(bounds[0][k], p[k]) : p[k];
            bounds[1][k] = i ? lao_max(bounds[1][k], p[k]) : p[k];
        }
        to[0] = lao_v4_make(p[0], p[1], p[2], 1.0f);
        to[1] = lao_v4_make(n[0], n[1], n[2], 0.0f);
        to[2] = lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
        if (z) {
            float sure = lao_sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2]);
            to[2] = lao_v4_make(z[0], z[1], z[2], lao_min(sure, 1.0f));
        }
    }
    for (i = 0; i < d->triangle_count; i++) {
        const uint32_t *t = d->triangles + 3 * (size_t)i;
        if (t[0] >= d->vertex_count || t[1] >= d->vertex_count || t[2] >= d->vertex_count) {
            return 0;
        }
        triangles[i] = lao_v4_make((float)t[0], (float)t[1], (float)t[2], 0.0f);
    }
    for (i = 0; i < 4 * d->vertex_count; i++) {
        colors[i] = d->colors ? d->colors[i] : 255;
    }
    return 1;
}

SDV_API lao_result sdv_object_drawn(const sdv_host *host, const float *bounds, sdv_object *object) {
    if (!bounds || !object) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_drawn");
    }
    memset(object, 0, sizeof *object);
    object->allocator = sdv__allocator(host);
    memcpy(object->desc.bounds, bounds, sizeof object->desc.bounds);
    sdv__object_buffer(object, "vessel_box", object->box, 2);
    return LAO_OK;
}

SDV_API lao_result sdv_object_mesh(const sdv_host *host, const sdv_mesh_desc *desc,
                                   sdv_object *object) {
    lao_allocator allocator = sdv__allocator(host);
    const uint32_t most = 1u << 24;
    float bounds[2][3];
    lao_v4 *memory;
    size_t size;
    if (!desc || !object || !desc->positions || !desc->normals || !desc->triangles) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_mesh");
    }
    if (!desc->vertex_count || !desc->triangle_count || desc->vertex_count > most / 3 ||
        desc->triangle_count > most) {
        return sdv__fail(host, SDV_LOG_MESH, "%u vertices, %u triangles", desc->vertex_count,
                         desc->triangle_count);
    }
    size = (3 * (size_t)desc->vertex_count + desc->triangle_count) * sizeof *memory +
           4 * (size_t)desc->vertex_count;
    memory = (lao_v4 *)sdv__take(&allocator, size, 1);
    if (!memory) {
        return sdv__fail(host, SDV_LOG_MEMORY, "a mesh of %u vertices", desc->vertex_count);
    }
    if (!sdv__mesh_fill(desc, memory, memory + 3 * (size_t)desc->vertex_count,
                        (uint8_t *)(memory + 3 * (size_t)desc->vertex_count + desc->triangle_count),
                        bounds)) {
        sdv__give(&allocator, memory);
        return sdv__fail(host, SDV_LOG_MESH, NULL);
    }
    sdv_object_drawn(host, bounds[0], object);
    object->memory = memory;
    object->desc.triangle_count = desc->triangle_count;
    sdv__object_buffer(object, "vessel_vertices", memory, 3 * desc->vertex_count);
    memory += 3 * (size_t)desc->vertex_count;
    sdv__object_buffer(object, "vessel_triangles", memory, desc->triangle_count);
    sdv__object_buffer(object, "vessel_colors", memory + desc->triangle_count, desc->vertex_count);
    return LAO_OK;
}

typedef struct sdv__grey {
    float value;
    uint32_t place;
} sdv__grey;
static int sdv__by_grey(const void *a, const void *b) {
    const sdv__grey *x = (const sdv__grey *)a, *y = (const sdv__grey *)b;
    if (x->value != y->value) {
        return x->value < y->value ? -1 : 1;
    }
    return x->place < y->place ? -1 : x->place > y->place;
}

SDV_API lao_result sdv_object_pattern(const sdv_host *host, const float *values, uint32_t size,
                                      sdv_object *object) {
    lao_allocator a = sdv__allocator(host);
    uint32_t i, count = size * size;
    sdv__grey *greys;
    float *pattern;
    if (!values || !object || object->pattern || !object->desc.buffers) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_pattern");
    }
    if (size < 1 || size > SDV_MOST_PATTERN) {
        return sdv__fail(host, SDV_LOG_IMAGE_SIZE, "a pattern of %u x %u", size, size);
    }
    greys = (sdv__grey *)sdv__take(&a, count, sizeof *greys);
    pattern = (float *)sdv__take(&a, count + 1, sizeof *pattern);
    if (!greys || !pattern) {
        sdv__give(&a, greys);
        sdv__give(&a, pattern);
        return sdv__fail(host, SDV_LOG_MEMORY, "a pattern of %u x %u", size, size);
    }
    for (i = 0; i < count; i++) {
        greys[i].value = values[i] == values[i] ? values[i] : 0.0f;
        greys[i].place = i;
    }
    qsort(greys, count, sizeof *greys, sdv__by_grey);
    pattern[0] = (float)size;
    for (i = 0; i < count; i++) {
        pattern[1 + greys[i].place] = ((float)i + 0.5f) / (float)count;
    }
    sdv__give(&a, greys);
    object->pattern = pattern;
    sdv__object_buffer(object, "vessel_pattern", pattern, count + 1);
    return LAO_OK;
}

SDV_API void sdv_object_free(sdv_object *object) {
    if (object && object->allocator.release) {
        sdv__give(&object->allocator, object->pattern);
        sdv__give(&object->allocator, object->nearest);
        sdv__give(&object->allocator, object->memory);
        sdv_grid_free(&object->grid);
        memset(object, 0, sizeof *object);
    }
}

#ifdef __cplusplus
}
#endif

#endif /* SDFVESSEL_IMPLEMENTATION_DONE */
#endif /* SDFVESSEL_IMPLEMENTATION */
