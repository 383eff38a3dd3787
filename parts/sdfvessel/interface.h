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
       Size      nothing recurses: a chain of a million nodes is as good as any tree.

   ORDER  the interface; the shared text, which is C and GLSL at once; the implementation. Each
   section begins with what it holds and which others it uses. */
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
    SDV_SETTINGS(LAO_SETTING_FIELD)
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
