/* vesselsurface.h - vessel surfaces that show their shape and let the flow inside be seen. MIT
   licence, see LICENSE.

   After Lawonn et al. 2014, "Adaptive Surface Visualization of Vessels with Animated Blood Flow"
   (below L14): a triangle mesh is welded, checked and turned the right way round; its
   suggestive-contour measure, which says per vertex how convex or concave the wall is towards the
   viewer, and its distance to the pathlines that are lit at a time give two numbers, from which a
   look-up makes colour and opacity. It includes lineao.h for types, results, allocator, job and
   shared math only: no backend and no GPU is needed.

   EXAMPLE
       #define VESSELSURFACE_IMPLEMENTATION   // in exactly one C or C++ file
       #include "vesselsurface.h"

       vsf_mesh_desc desc = {0};
       desc.vertex_count = v;   desc.positions = positions;     // mm
       desc.triangle_count = t; desc.triangles = corners;
       vsf_mesh mesh;
       if (vsf_mesh_build(NULL, &desc, &mesh) != LAO_OK) return 1;  // NULL: malloc, serial, silent
       vsf_mesh_smooth(NULL, &mesh, NULL);           // (Optional) Taubin, 20 double steps
       vsf_buffers buffers;
       vsf_buffers_make(NULL, &mesh, 0, &buffers);
       vsf_measure(NULL, &buffers, eye, 0, measure); // 1/mm per vertex, per frame
       vsf_near_desc lines = {0};                    // pathlines with times (ms)
       ...
       vsf_near table;
       vsf_near_make(NULL, &lines, &table);                     // table.gamma; distances per step
       vsf_near_sample(&table, time, distances);
       ...
       vsf_near_free(&table); vsf_buffers_free(&buffers); vsf_mesh_free(&mesh);

   FILES  lineao.h vesselsurface.h. To draw with vsf_module(): also a backend (see lineao.h) and
   vesselsurface_shaders.h, beside lineao_shaders.h.

   CONFIGURATION (define before including)
       VESSELSURFACE_IMPLEMENTATION   the function bodies, in one translation unit
       VSF_API                        linkage of the public functions (default: extern)

   CONTRACTS
       Units     millimetres, milliseconds. The measure is a curvature, 1/mm: other units of length
                 need another brightness.
       Errors    a failure returns one lao_result, logs one item (VSF_LOG_ITEMS) and leaves
                 out-parameters untouched. What is merely odd is mended and logged as a warning: an
                 item whose result is LAO_OK.
       Memory    every byte comes from vsf_host.allocator, which is only called on the thread that
                 called us; objects keep a copy of it for their free function, which is fine on an
                 all-zero object.
       Threads   no function keeps state outside its arguments: different objects may be used on
                 different threads, and one object read on several. Work runs through vsf_host.job
                 in fixed chunks: results do not depend on the number of threads, to the bit.
       Size      nothing recurses; time and memory grow linearly with the mesh. */
#ifndef VESSELSURFACE_H
#define VESSELSURFACE_H

#include "lineao.h"

#ifndef VSF_API
#define VSF_API extern
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------
 * what can go wrong, what was mended */

/* X(id, result, text). LAO_OK: a warning, the work went on. */
#define VSF_LOG_ITEMS(X)                                                                           \
    X(NULL_ARGUMENT, LAO_ERROR_INVALID_ARGUMENT, "a required pointer is NULL")                     \
    X(MEMORY, LAO_ERROR_OUT_OF_MEMORY, "no memory")                                                \
    X(CANCELLED, LAO_ERROR_NOT_READY, "the host cancelled the work")                               \
    X(MESH_COUNT, LAO_ERROR_INVALID_ARGUMENT, "more than 2^29 vertices or triangles")              \
    X(MESH_INDEX, LAO_ERROR_INVALID_ARGUMENT, "a triangle names a vertex that does not exist")     \
    X(MESH_EMPTY, LAO_ERROR_INVALID_ARGUMENT, "the mesh has no triangle with an area")             \
    X(MESH_ATTRIBUTE, LAO_ERROR_INVALID_ARGUMENT, "an attribute has no name or no values")         \
    X(MESH_DEVICE, LAO_ERROR_UNSUPPORTED,                                                          \
      "the mesh is too large for the device; decimate it (vsf_mesh_decimate), extract it on a "    \
      "coarser grid or subdivide it less")                                                         \
    X(SETTING, LAO_ERROR_INVALID_ARGUMENT, "a setting is out of its range or no number")           \
    X(LINES_OFFSETS, LAO_ERROR_INVALID_ARGUMENT,                                                   \
      "offsets must start at 0, never fall and end at point_count")                                \
    X(NEAR_COUNT, LAO_ERROR_INVALID_ARGUMENT,                                                      \
      "more points than 2^30, or more distances than memory can hold")                             \
    X(VERTICES_LOOSE, LAO_OK, "vertices belong to no triangle")                                    \
    X(VERTICES_WILD, LAO_OK, "vertices are not finite or beyond 1e9 mm and were dropped")          \
    X(TRIANGLES_WILD, LAO_OK, "triangles had a dropped vertex and were dropped")                   \
    X(TRIANGLES_DEGENERATE, LAO_OK, "triangles without area were dropped")                         \
    X(EDGES_OPEN, LAO_OK, "edges have one triangle: the surface is open")                          \
    X(EDGES_CROWDED, LAO_OK, "edges have more than two triangles: the surface is no manifold")     \
    X(WINDING_MENDED, LAO_OK, "triangles ran against their neighbours and were turned round")      \
    X(WINDING_TWISTED, LAO_OK,                                                                     \
      "edges have two triangles that do not agree which side is out (one-sided, as a Moebius "     \
      "strip, or VSF_MESH_KEEP_WINDING)")                                                          \
    X(PARTS_INWARD, LAO_OK, "closed parts faced inward and were turned round")                     \
    X(PARTS_SUSPECT, LAO_OK, "open parts seem to face inward; VSF_MESH_FLIP turns all round")

typedef enum vsf_log_item {
#define VSF__ENUM(id, result, text) VSF_LOG_##id,
    VSF_LOG_ITEMS(VSF__ENUM)
#undef VSF__ENUM
        VSF_LOG_ITEM_COUNT
} vsf_log_item;

/* What the host lends to a call. All zero, or NULL instead: malloc, serial, silent. */
typedef struct vsf_host {
    lao_allocator allocator;
    lao_job job; /* progress is called on the calling thread, between chunks */
    /* One call per failure (result != LAO_OK) or warning (LAO_OK). `text` is the item's sentence
       with a place or a number; valid during the call. */
    void (*log)(void *user, vsf_log_item item, lao_result result, const char *text);
    void *user; /* of log */
} vsf_host;

/* ------------------------------------------------------------------------------------------------
 * meshes */

#define VSF_NONE 0xffffffffu

/* A named array of `components` floats per vertex: wall shear stress, pressure. NaN: no value. */
typedef struct vsf_attribute {
    const char *name;
    uint32_t components; /* 0: 1 */
    const float *values;
} vsf_attribute;

enum {
    VSF_MESH_NO_WELD = 1,      /* vertices at one place stay apart */
    VSF_MESH_KEEP_WINDING = 2, /* no triangle is turned round; faults are named only */
    VSF_MESH_FLIP = 4          /* all triangles are turned round at the end */
};

/* Arrays are borrowed during the call. */
typedef struct vsf_mesh_desc {
    uint32_t vertex_count;
    const float *positions; /* 3 per vertex, mm */
    uint32_t triangle_count;
    const uint32_t *triangles; /* 3 vertices each, counter-clockwise seen from outside */
    const float *normals;      /* (Optional) 3 per vertex, of any length, instead of those from the
                                  faces; a zero or no number: from the faces there */
    const vsf_attribute *attributes;
    uint32_t attribute_count;
    uint32_t flags; /* VSF_MESH_... */
} vsf_mesh_desc;

typedef struct vsf_mesh_info {
    uint32_t welded;       /* vertices that were at the place of an earlier one */
    uint32_t degenerate;   /* triangles dropped: two corners in one place, or no area */
    uint32_t unreferenced; /* vertices of no triangle, which stay */
    uint32_t wild;         /* vertices dropped: not finite or beyond 1e9 mm */
    uint32_t edges, open_edges, crowded_edges, twisted_edges;
    uint32_t parts, closed_parts; /* connected through edges of two triangles */
    uint32_t turned;              /* triangles turned round */
    double area;                  /* mm^2 */
    double volume;      /* mm^3 inside, positive: outward normals; means nothing with open edges */
    double mean_edge;   /* mm */
    float bounds[2][3]; /* mm, of the vertices of triangles */
} vsf_mesh_info;

/* One kind of warning. */
typedef struct vsf_warning {
    vsf_log_item item;
    uint32_t count;
    uint32_t first; /* the first of them, an index of the desc's vertices or triangles */
} vsf_warning;

/* A triangle mesh. Read its arrays freely. Vertices and triangles keep the order of the desc.
   Half-edge 3 t + k leads from corner k of triangle t to corner (k + 1) % 3. */
typedef struct vsf_mesh {
    uint32_t vertex_count, triangle_count;
    float *positions;         /* 3 per vertex, mm */
    float *normals;           /* 3 per vertex, unit; 0 where no face gives one */
    double *areas;            /* per vertex: mixed Voronoi area, mm^2; together info.area */
    uint32_t *triangles;      /* 3 per triangle */
    uint32_t *opposites;      /* 3 per triangle: the half-edge that runs against this one, VSF_NONE
                                 at open, crowded and twisted edges */
    uint32_t *ring_starts;    /* vertex_count + 1 */
    uint32_t *ring_corners;   /* from ring_starts[v]: the corners 3 t + k that are vertex v */
    unsigned char *borders;   /* per vertex: not 0 at an edge that is open, crowded or twisted */
    uint32_t *vertex_sources; /* per vertex: index in the desc (of welded ones the first); VSF_NONE:
                                 added by subdivision */
    uint32_t *triangle_sources;
    uint32_t *vertex_targets;  /* per vertex of the desc: vertex here, VSF_NONE: dropped */
    uint32_t source_count;     /* entries of vertex_targets; 0 after subdivision */
    vsf_attribute *attributes; /* of the vertices; welded ones have the first's values */
    uint32_t attribute_count;
    vsf_mesh_info info;
    vsf_warning warnings[VSF_LOG_ITEM_COUNT];
    uint32_t warning_count;
    lao_allocator allocator; /* private */
    void *memory;            /* private */
} vsf_mesh;

/* Builds a mesh from arrays, mends what is odd and counts it:
   - vertices at bit-equal positions (-0 is 0) become one, unless VSF_MESH_NO_WELD;
   - triangles with two corners in one place or without area go;
   - triangles that run against their neighbours are turned round: of each part the side with less
     area. A closed part is then turned so that its volume is positive: normals point outward;
   - normals are the area-weighted sum of the faces (L14 6.1), areas those of Meyer et al. 2002.
   Memory: about 100 bytes per triangle and 75 per vertex while building. Fails with NULL_ARGUMENT,
   MEMORY, CANCELLED, MESH_COUNT, MESH_INDEX, MESH_EMPTY, MESH_ATTRIBUTE. Thread: any. */
VSF_API lao_result vsf_mesh_build(const vsf_host *host, const vsf_mesh_desc *desc, vsf_mesh *mesh);
VSF_API void vsf_mesh_free(vsf_mesh *mesh);
/* The text of warning i, as it was logged: "3 vertices belong to no triangle, first: 17". Returns
   its length, which may exceed size - 1; `text` is always terminated. */
VSF_API size_t vsf_mesh_warning_text(const vsf_mesh *mesh, uint32_t i, char *text, size_t size);

/* Zero, or NULL instead: 20 double steps of 0.5 and -0.53. */
typedef struct vsf_smooth_desc {
    uint32_t steps;    /* double steps; 0: 20 */
    double lambda, mu; /* 0 < lambda < -mu; both 0: 0.5, -0.53 */
    int uniform; /* not 0: neighbours weigh alike, not by cotangents: evens triangles out, best
                    for meshes of marching cubes */
} vsf_smooth_desc;
/* Taubin's smoothing with cotangent weights of the first shape, negative ones taken as 0 (METHODS
   11.6). Vertices on borders stay. Normals are made anew from the faces. On failure the mesh is
   unchanged. Fails with NULL_ARGUMENT, SETTING, MEMORY, CANCELLED. */
VSF_API lao_result vsf_mesh_smooth(const vsf_host *host, vsf_mesh *mesh,
                                   const vsf_smooth_desc *desc);

/* Loop's subdivision (with Warren's weights), each level with four times the triangles: an edge
   gets a vertex, borders become cubic splines and do not shrink into the surface. Attributes are
   interpolated along edges. Normals are made anew. Levels 1 to 8. Fails with NULL_ARGUMENT,
   SETTING, MESH_COUNT, MEMORY, CANCELLED. */
VSF_API lao_result vsf_mesh_subdivide(const vsf_host *host, const vsf_mesh *mesh, uint32_t levels,
                                      vsf_mesh *finer);

/* A mesh of at most `most` triangles (4 or more), for one that is too large for a device: the
   vertices in a cell of a lattice become one, where the planes of their triangles meet best
   (Lindstrom 2000: the sum of the planes' quadrics, held near the mean), and triangles keep their
   corners' cells. The finest lattice with so few triangles is found by halving. What is thinner
   than a cell may join or vanish; attributes are means of the numbers among them. Normals are made
   anew. Linear in the mesh; memory: 24 bytes per vertex, 120 per cell. Fails with NULL_ARGUMENT,
   SETTING, MEMORY, CANCELLED, MESH_EMPTY. */
VSF_API lao_result vsf_mesh_decimate(const vsf_host *host, const vsf_mesh *mesh, uint32_t most,
                                     vsf_mesh *coarser);

/* The parts of which all is made, in double precision. Thread: any.
   Gradient of the linear function with values l at the corners (L14 Eq. 1), in the triangle's
   plane, 0 where there is no area. */
VSF_API void vsf_triangle_gradient(const double p0[3], const double p1[3], const double p2[3],
                                   const double l[3], double gradient[3]);
/* v turned by the least rotation that takes the unit vector `from` to the unit vector `to`. Returns
   0, or -1 where they are opposite and no rotation is the least: `turned` is then 0. */
VSF_API int vsf_turn(const double from[3], const double to[3], const double v[3], double turned[3]);
/* The share of each corner in the triangle's area (mixed Voronoi areas, Meyer et al. 2002):
   together the area. */
VSF_API void vsf_corner_areas(const double p0[3], const double p1[3], const double p2[3],
                              double areas[3]);

/* Principal curvatures (1/mm, greater first, positive: convex) per vertex, by fitting the second
   fundamental form to the normals of each face's corners (Rusinkiewicz 2004), and the unit
   direction of the first. `curvatures` holds 2, `directions` (Optional) 3 floats per vertex. 0
   where a vertex has no face. Fails with NULL_ARGUMENT, CANCELLED. */
VSF_API lao_result vsf_curvatures(const vsf_host *host, const vsf_mesh *mesh, float *curvatures,
                                  float *directions);

/* ------------------------------------------------------------------------------------------------
 * what a device gets */

/* The texel buffers of a surface: X(name, format). Vertex indices are numbers, so that a mesh has
   at most 2^24 vertices.
     surface_points     per vertex: position; ring start / 256
     surface_normals    per vertex: normal; (ring start % 256) * 65536 + number of ring entries
     surface_rings      per neighbour of a vertex: g; the neighbour. The gradient of a function l on
                        the surface is the sum of g (l(neighbour) - l(vertex)): triangle gradients,
                        turned into the vertex's tangent plane and averaged by mixed Voronoi areas,
                        are linear in l and do not depend on the view
     surface_triangles  per triangle: its three vertices; 0
     surface_values     per vertex: any value, such as an attribute
     surface_near       two per vertex: distances at two steps, see vsf_near_pair
     surface_map        any number of colours: the map of near_colors=map, x from 0 to 1
   The last three are the host's to give: vsf_buffers_make does not make them. */
#define VSF_BUFFERS(X)                                                                             \
    X(surface_points, LAO_FORMAT_RGBA32F)                                                          \
    X(surface_normals, LAO_FORMAT_RGBA32F)                                                         \
    X(surface_rings, LAO_FORMAT_RGBA32F)                                                           \
    X(surface_triangles, LAO_FORMAT_RGBA32F)                                                       \
    X(surface_values, LAO_FORMAT_R32F)                                                             \
    X(surface_near, LAO_FORMAT_R32F)                                                               \
    X(surface_map, LAO_FORMAT_RGBA32F)

/* The rows of VSF_BUFFERS, for the table of a module. Thread: any. */
VSF_API const lao_buffer_row *vsf_buffer_rows(uint32_t *count);

typedef struct vsf_buffers {
    uint32_t vertex_count, ring_count, triangle_count;
    float *points;    /* 4 per vertex */
    float *normals;   /* 4 per vertex */
    float *rings;     /* 4 per entry */
    float *triangles; /* 4 per triangle */
    float bounds[2][3];
    lao_allocator allocator; /* private */
    void *memory;            /* private */
} vsf_buffers;

/* Makes the buffers of a mesh. `max_texels` is the device's longest texel buffer; 0: no limit but
   ours. Fails with NULL_ARGUMENT, MEMORY, CANCELLED, MESH_DEVICE. */
VSF_API lao_result vsf_buffers_make(const vsf_host *host, const vsf_mesh *mesh, uint32_t max_texels,
                                    vsf_buffers *buffers);
VSF_API void vsf_buffers_free(vsf_buffers *buffers);
/* The same for lao_object_create: fills `list` and points `desc` at it; both are borrowed from
   `buffers`. More entries may be added behind. Thread: any. */
VSF_API void vsf_buffers_describe(const vsf_buffers *buffers, lao_object_buffer list[4],
                                  lao_object_desc *desc);

enum { VSF_VIEW_NORMALIZED = 1 /* the naive measure, with unit view vectors: for comparison */ };

/* The suggestive-contour measure of every vertex (METHODS 10.3), the bits that the pass
   surface_measure makes of the same buffers: `measure` holds vertex_count floats, 1/mm. `eye` as
   vsf_eye gives it: the camera's place and 1, or the unit direction to an orthographic camera and
   0. Fails with NULL_ARGUMENT, CANCELLED. */
VSF_API lao_result vsf_measure(const vsf_host *host, const vsf_buffers *buffers, const float eye[4],
                               uint32_t flags, float *measure);
/* The gradient of any function on the surface: `gradients` holds 3 floats per vertex. */
VSF_API lao_result vsf_gradients(const vsf_host *host, const vsf_buffers *buffers,
                                 const float *values, float *gradients);

/* ------------------------------------------------------------------------------------------------
 * feature lines */

typedef enum vsf_feature {
    VSF_CONTOURS,           /* n.v = 0: where the surface turns away */
    VSF_SUGGESTIVE_CONTOURS /* measure = 0, rising towards the viewer, on faces towards the viewer
                             */
} vsf_feature;

/* Polylines, for lao_lines_create. */
typedef struct vsf_polylines {
    uint32_t line_count, point_count;
    uint32_t *offsets; /* line_count + 1 */
    float *points;     /* 3 per point, mm; a closed line's last point is its first */
    float *values;     /* per point: slope of the measure towards the viewer, 1/mm^2; contours: 0 */
    lao_allocator allocator; /* private */
    void *memory;            /* private */
} vsf_polylines;

/* Zero sets on the mesh, straight in each triangle (L14 5.1, DeCarlo et al. 2003). Suggestive
   contours are kept where the derivative of the measure along w, per mm, exceeds `threshold`
   (1/mm^2, 0 or more), and cut there. `buffers` are those of the mesh. Fails with NULL_ARGUMENT,
   SETTING, MEMORY, CANCELLED. */
VSF_API lao_result vsf_feature_lines(const vsf_host *host, const vsf_mesh *mesh,
                                     const vsf_buffers *buffers, const float eye[4],
                                     vsf_feature feature, float threshold, vsf_polylines *lines);
VSF_API void vsf_polylines_free(vsf_polylines *lines);

/* ------------------------------------------------------------------------------------------------
 * distance to the lit parts of pathlines */

enum {
    VSF_NEAR_POINTS = 1, /* distance to lit points, as L14's program; otherwise to lit segments */
    VSF_NEAR_HALF = 2,   /* distances are stored in 2 bytes (relative error 2^-11, at most 65504 mm)
                            instead of 4 */
    VSF_NEAR_BRUTE = 4   /* every vertex against every lit segment: for tests and measurements */
};

/* Arrays are borrowed during vsf_near_make. */
typedef struct vsf_near_desc {
    uint32_t vertex_count;
    const float *positions; /* 3 per vertex, mm: where distances are wanted */
    uint32_t line_count, point_count;
    const uint32_t *offsets; /* line_count + 1; NULL: one line of all points */
    const float *points;     /* 3 per point, mm; a point that is not finite interrupts its line */
    const float *times;      /* per point, ms */
    uint32_t step_count;     /* K times from 0 to the last one; 0: 100 */
    double beta;   /* ms^2, length of the lit parts: f = exp(-(T - t)^2 / beta); 0: twice the median
                      of the lines' last times in ms (L14 5.2, METHODS 9.1); where that is not
                      positive 1600 */
    double period; /* ms; > 0: times count modulo it, steps run from 0 to it. 0: steps run from 0 to
                      the last time of all lines */
    uint32_t flags; /* VSF_NEAR_... */
} vsf_near_desc;

/* Distances of every vertex to what is lit, for K times T_k = k * duration / (K - 1). Lit is where
   f > 0.25, so where |T - t| < reach = sqrt(beta ln 4); time is linear along a segment. */
typedef struct vsf_near {
    uint32_t vertex_count, step_count;
    double beta;     /* ms^2 */
    double sigma;    /* ms, sqrt(beta / 2) */
    double reach;    /* ms */
    double period;   /* ms; 0: none */
    double duration; /* ms, of all steps */
    float gamma;     /* mm: 1 % quantile (type 7) of all finite distances as stored, at least 1e-6;
                        0 when nothing is ever lit */
    uint64_t lit;    /* pieces of lines that were lit, summed over the steps */
    uint32_t bytes;  /* stored per vertex and step: 2 or 4 */
    uint32_t flags;  /* VSF_NEAR_... */
    void *values;    /* step by step; read with the functions below */
    lao_allocator allocator; /* private */
    void *index;             /* private */
} vsf_near;

/* Computes the table. Segments lie in space-filling order; per time the lit ones get a tree of
   boxes, which vertices descend in such an order too, each starting with its predecessor's
   distance: the same bits as VSF_NEAR_BRUTE. Memory: `bytes` per vertex
   and step, 16 per vertex, 32 per point (80 while building) and 50 per piece lit at a time. Fails
   with NULL_ARGUMENT, SETTING, LINES_OFFSETS, NEAR_COUNT, MEMORY, CANCELLED. */
VSF_API lao_result vsf_near_make(const vsf_host *host, const vsf_near_desc *desc, vsf_near *table);
VSF_API void vsf_near_free(vsf_near *table);
/* Another beta (ms^2, > 0). Where lit parts grow, the old distances bound the new ones. The same
   bits as vsf_near_make; the old table stays until the new one is done, and on failure. For
   programs in which the highlight changes while the lines stay, such as lineao-view: a program that
   makes one table, as `lineao surface` does for all its frames, gives vsf_near_make the beta at
   once. A vsf_object that showed the old table needs its `step` set to VSF_NONE, so that
   vsf_object_time takes the new distances. Fails with NULL_ARGUMENT, SETTING, MEMORY, CANCELLED. */
VSF_API lao_result vsf_near_update(const vsf_host *host, vsf_near *table, double beta);
/* Distances (mm) at a step; VSF_FAR where nothing is lit. `distances`: vertex_count floats. A step
   beyond the last is the last. Thread: any. */
VSF_API void vsf_near_step(const vsf_near *table, uint32_t step, float *distances);
/* The step before a time and how far (0 to 1) it is to the next: times are clamped, or taken modulo
   the period. Returns the step; `part` is what vsf_near_mix takes. Thread: any. */
VSF_API uint32_t vsf_near_find(const vsf_near *table, double time, float *part);
/* Distances at a time, interpolated between steps. Thread: any. */
VSF_API void vsf_near_sample(const vsf_near *table, double time, float *distances);
/* Texels of surface_near, 2 per vertex: the distances at `step` and at the next. Thread: any. */
VSF_API void vsf_near_pair(const vsf_near *table, uint32_t step, float *texels);
/* Distances at a time, not interpolated but computed. Use it to stream steps that would not fit
   into memory (a table of step_count 1), or for a still picture. Fails with NULL_ARGUMENT, SETTING,
   MEMORY, CANCELLED. */
VSF_API lao_result vsf_near_exact(const vsf_host *host, const vsf_near *table, double time,
                                  float *distances);

/* Square of the distance (mm^2) from p to the part of the segment from a to b between the fractions
   `from` and `to`. Thread: any. */
VSF_API double vsf_segment_distance2(const float p[3], const float a[3], const float b[3],
                                     double from, double to);

/* ------------------------------------------------------------------------------------------------
   the module: passes of surfaces for lao_desc.modules */

/* X(name, TYPE, minimum, maximum, default, structural, unit, choices, help) */
#define VSF_SETTINGS(X)                                                                            \
    X(shading, ENUM, 0, 2, 0, 1, "", "adaptive|transparent|fresnel",                               \
      "front faces: the look-up by shape and flow (L14), alike everywhere, or by angle")           \
    X(brightness, FLOAT, 0, 1e6f, 1.5f, 0, "mm", "",                                               \
      "adaptive: opacity and colour per curvature; more shows more shape and hides more (c)")      \
    X(blend, ENUM, 0, 1, 0, 1, "", "over|add",                                                     \
      "how front faces join what is behind them: cover it, or add light")                          \
    X(opacity, FLOAT, 0, 1, 0.4f, 0, "", "", "transparent: opacity of front faces")                \
    X(falloff, FLOAT, 0.01f, 100, 1.5f, 0, "", "", "fresnel: edge fall-off (r)")                   \
    X(falloff_form, ENUM, 0, 1, 0, 1, "", "paper|rim",                                             \
      "fresnel: 1 - |n.v|^r, more opaque for larger r; or (1 - |n.v|)^r, less")                    \
    X(layers, INT, 0, 31, 7, 1, "", "",                                                            \
      "front faces drawn behind the nearest one, exactly, where surfaces overlap")                 \
    X(near_source, ENUM, 0, 1, 0, 1, "", "distance|value",                                         \
      "what shifts the hue: distance to lit lines, or the values of the vertices")                 \
    X(near_colors, ENUM, 0, 1, 0, 1, "", "hues|map",                                               \
      "what near is shown by: the hues of the look-up, or a colour map of its own")                \
    X(near_opacity, FLOAT, 0, 1, 0.8f, 0, "", "",                                                  \
      "map: least opacity where x is 1, less elsewhere, however flat the wall")                    \
    X(near_gamma, FLOAT, 0, 1e6f, 0, 0, "mm", "",                                                  \
      "distance at which lit lines stop to matter; 0: none is near (gamma)")                       \
    X(near_part, FLOAT, 0, 1, 0, 0, "", "",                                                        \
      "where the time is between the two steps of the distances")                                  \
    X(near_steps, INT, 1, 100000, 100, 0, "", "",                                                  \
      "times of the table of distances; for the program that makes it (K)")                        \
    X(value_low, FLOAT, -1e30f, 1e30f, 0, 0, "", "", "value whose hue is that of far")             \
    X(value_high, FLOAT, -1e30f, 1e30f, 1, 0, "", "", "value whose hue is that of near")           \
    X(wall_red, FLOAT, 0, 1, 0.86f, 0, "", "", "colour of back faces, and of the baselines")       \
    X(wall_green, FLOAT, 0, 1, 0.81f, 0, "", "", "its green")                                      \
    X(wall_blue, FLOAT, 0, 1, 0.76f, 0, "", "", "its blue")                                        \
    X(wall_ambient, FLOAT, 0, 1, 0.45f, 0, "", "", "light on the wall from everywhere")            \
    X(wall_diffuse, FLOAT, 0, 2, 0.55f, 0, "", "", "light on the wall from the viewer")            \
    X(depth_shadow, BOOL, 0, 1, 0, 1, "", "",                                                      \
      "darken what lies close behind something nearer (Luft 2006)")                                \
    X(depth_shadow_strength, FLOAT, 0, 100, 2, 0, "", "", "of the depth shadow (lambda)")          \
    X(depth_shadow_width, FLOAT, 0.01f, 5, 2, 0, "%", "",                                          \
      "of the depth shadow: sigma, of the picture's diagonal")                                     \
    X(focus, BOOL, 0, 1, 0, 1, "", "", "blur what is not between focus_near and focus_far")        \
    X(focus_near, FLOAT, -1e9f, 1e9f, 0, 0, "mm", "", "depth from the eye where focus begins")     \
    X(focus_far, FLOAT, -1e9f, 1e9f, 1e9f, 0, "mm", "", "depth from the eye where focus ends")     \
    X(focus_growth, FLOAT, 0, 100, 0.2f, 0, "px/mm", "", "blur per distance from focus")           \
    X(focus_blur, FLOAT, 0, 32, 8, 0, "px", "", "widest blur")                                     \
    X(attenuation, BOOL, 0, 1, 0, 1, "", "", "let the scene fade with depth")                      \
    X(attenuation_strength, FLOAT, 0, 1, 0.5f, 0, "", "", "how much of the farthest is gone")      \
    X(surface_geometry, BOOL, 0, 1, 0, 1, "", "",                                                  \
      "keep position, normal, measure and look-up of the nearest front face as images")

/* What a surface looks like; as lao_settings: zero is the default unless its bit is set. Depth
   shadow, focus and attenuation are those of the first surface that has them on. */
typedef struct vsf_settings {
    uint64_t set;
#define VSF__FIELD(name, type, minimum, maximum, standard, structural, unit, choices, help)        \
    float name;
    VSF_SETTINGS(VSF__FIELD)
#undef VSF__FIELD
} vsf_settings;

typedef enum vsf_setting {
#define VSF__ENUM(name, type, minimum, maximum, standard, structural, unit, choices, help)         \
    VSF_SETTING_ID_##name,
    VSF_SETTINGS(VSF__ENUM)
#undef VSF__ENUM
        VSF_SETTING_COUNT
} vsf_setting;
#define VSF_SET(name) ((uint64_t)1 << VSF_SETTING_ID_##name)

/* Passes, images and settings that draw ghosted surfaces around a scene's lines: back faces opaque,
   front faces over everything that is behind them. Nested surfaces are exact in one object (a mesh
   of several parts); objects are composed in the order of their sets. Static. Thread: any. */
VSF_API const lao_module *vsf_module(void);

enum { VSF_MAP_COLORS = 256 };
/* A mesh as the object of a set. `desc` refers to the struct itself: it must not move. `near_pair`,
   `values` and `map` may be filled by the host before lao_object_create or _update. */
typedef struct vsf_object {
    lao_object_desc desc; /* all buffers */
    lao_object_buffer list[7];
    vsf_buffers buffers;
    float *near_pair;        /* 2 per vertex, mm: distances at two steps; VSF_FAR at first */
    float *values;           /* 1 per vertex; 0 at first */
    float *map;              /* 4 for each of VSF_MAP_COLORS, display values; greys at first */
    uint32_t step;           /* of near_pair; VSF_NONE at first */
    lao_allocator allocator; /* private */
} vsf_object;

/* Describes a mesh for lao_object_create, with copies of all it needs. `max_texels` as for
   vsf_buffers_make. Free with vsf_object_free, fine on an all-zero one, once lao_object_create has
   returned and no update will come. Fails with NULL_ARGUMENT, MEMORY, CANCELLED, MESH_DEVICE. */
VSF_API lao_result vsf_object_make(const vsf_host *host, const vsf_mesh *mesh, uint32_t max_texels,
                                   vsf_object *object);
VSF_API void vsf_object_free(vsf_object *object);
/* The setting `layers` that shows all there is of a mesh seen from outside: in closed parts that do
   not cut themselves every further front face lies behind an opaque back face, unless parts are
   nested (single pixels of silhouettes apart, by rounding). Open meshes: the default. Each layer
   costs a drawing of the mesh. Thread: any. */
VSF_API uint32_t vsf_mesh_layers(const vsf_mesh *mesh);
/* Shows a time (ms): sets near_part and near_gamma, and fills near_pair where the time is between
   other steps than before. Then it returns 1, and `update` is what lao_object_update needs: the
   distances alone. Otherwise 0, nothing to upload. `table` is of the object's vertices. */
VSF_API int vsf_object_time(vsf_object *object, const vsf_near *table, double time,
                            vsf_settings *settings, lao_object_desc *update);

#ifdef __cplusplus
}
#endif

/* -------------------------------------------------------------------------------------------------------
   shared text From here to VSF_SHARED_END the text is C99, C++11 and GLSL at once, behind
   lineao.h's (same rules: see there). */
/* VSF_SHARED_BEGIN */
#define VSF_FAR 3.0e38f /* a distance where nothing is lit */

/* ---- view (METHODS 10.3) */
/* The camera for the functions below: its place (mm) and 1, or the unit direction to an
   orthographic one and 0. `view`: world to view space, a rotation, reflection, translation and
   scale. */
LAO_FN lao_v4 vsf_eye(lao_m4 view, float orthographic) {
    lao_v3 right = lao_v3_make(view.x.x, view.y.x, view.z.x);
    lao_v3 up = lao_v3_make(view.x.y, view.y.y, view.z.y);
    lao_v3 back = lao_v3_make(view.x.z, view.y.z, view.z.z);
    LAO_EXACT float scale2 = lao_v3_dot(back, back);
    LAO_EXACT float inverse = 1.0f / lao_sqrt(scale2);
    LAO_EXACT float x = -(right.x * view.w.x + up.x * view.w.y + back.x * view.w.z) / scale2;
    LAO_EXACT float y = -(right.y * view.w.x + up.y * view.w.y + back.y * view.w.z) / scale2;
    LAO_EXACT float z = -(right.z * view.w.x + up.z * view.w.y + back.z * view.w.z) / scale2;
    lao_v3 direction = lao_v3_scale(back, inverse);
    bool flat_view = orthographic > 0.5f; /* choices, no branch: see vsf_near_mix */
    return lao_v4_make(flat_view ? direction.x : x, flat_view ? direction.y : y,
                       flat_view ? direction.z : z, flat_view ? 0.0f : 1.0f);
}
/* From a point to the camera, as long as it is far; unit when `naive` (or orthographic). */
LAO_FN lao_v3 vsf_to_eye(lao_v4 eye, lao_v3 p, bool naive) {
    LAO_EXACT float x = eye.x - eye.w * p.x;
    LAO_EXACT float y = eye.y - eye.w * p.y;
    LAO_EXACT float z = eye.z - eye.w * p.z;
    lao_v3 v = lao_v3_make(x, y, z);
    return naive ? lao_v3_unit(v, lao_v3_make(0.0f, 0.0f, 0.0f)) : v;
}
/* l = n.v */
LAO_FN float vsf_light(lao_v4 eye, lao_v3 p, lao_v3 n, bool naive) {
    LAO_EXACT float l = lao_v3_dot(n, vsf_to_eye(eye, p, naive));
    return l;
}

/* ---- suggestive-contour measure s = w . grad(n.v) / |v|^2, w = v - (n.v) n */
/* Ring start and number of entries, from w of surface_points and of surface_normals. */
LAO_FN lao_uint vsf_ring_count(float normal_w) {
    return LAO_U(normal_w) & 65535u;
}
LAO_FN lao_uint vsf_ring_start(float point_w, float normal_w) {
    return LAO_U(point_w) * 256u + (LAO_U(normal_w) >> 16u);
}
struct vsf_ring_sum {
    lao_v3 w;
    float light, view2, sum;
};
#ifndef LAO_GLSL
typedef struct vsf_ring_sum vsf_ring_sum;
#endif
LAO_FN vsf_ring_sum vsf_ring_begin(lao_v4 eye, lao_v3 p, lao_v3 n, bool naive) {
    vsf_ring_sum r;
    lao_v3 v = vsf_to_eye(eye, p, naive);
    LAO_EXACT float light = lao_v3_dot(n, v);
    LAO_EXACT float view2 = lao_v3_dot(v, v);
    r.w = lao_v3_along(v, n, -light);
    r.light = light;
    r.view2 = view2;
    r.sum = 0.0f;
    return r;
}
/* One texel of surface_rings, and n.v of the neighbour that it names. */
LAO_FN vsf_ring_sum vsf_ring_add(vsf_ring_sum ring, lao_v4 entry, float light) {
    vsf_ring_sum r = ring;
    LAO_EXACT float along = lao_v3_dot(ring.w, lao_v3_make(entry.x, entry.y, entry.z));
    LAO_EXACT float sum = ring.sum + along * (light - ring.light);
    r.sum = sum;
    return r;
}
LAO_FN float vsf_ring_end(vsf_ring_sum ring) {
    LAO_EXACT float s = ring.sum / lao_max(ring.view2, 1.0e-30f);
    return lao_abs(s) < 1.0e30f ? s : 0.0f; /* no number: 0 */
}

/* ---- the two coordinates of the look-up (METHODS 9.2, 9.3) */
/* A distance between those at two steps; VSF_FAR where either is (0 and 1 take one step alone).
   Choices and no branches: lavapipe compiles a program anew, frame by frame, whose branches ask for
   a uniform. */
LAO_FN float vsf_near_mix(float before, float after, float part) {
    LAO_EXACT float between = before + part * (after - before);
    float d = lao_max(before, after) >= VSF_FAR ? VSF_FAR : between;
    d = part < 1.0f ? d : after;
    return part > 0.0f ? d : before;
}
/* x = 1 - distance / gamma in [0, 1]; 0 where nothing is lit */
LAO_FN float vsf_near_x(float distance, float gamma) {
    LAO_EXACT float x = 1.0f - distance / gamma;
    float near_x = distance < VSF_FAR ? lao_clamp01(x) : 0.0f;
    return gamma > 0.0f ? near_x : 0.0f;
}
/* y = c s in [-1, 1] */
LAO_FN float vsf_measure_y(float measure, float brightness) {
    LAO_EXACT float y = brightness * measure;
    return lao_min(lao_max(y, -1.0f), 1.0f);
}
/* The pure colour of a hue in turns: HLS(hue, 1/2, 1). */
LAO_FN lao_v3 vsf_hue(float hue) {
    LAO_EXACT float t = 6.0f * hue;
    LAO_EXACT float r = lao_clamp01(lao_abs(t - 3.0f) - 1.0f);
    LAO_EXACT float g = lao_clamp01(2.0f - lao_abs(t - 2.0f));
    LAO_EXACT float b = lao_clamp01(2.0f - lao_abs(t - 4.0f));
    return lao_v3_make(r, g, b);
}
/* The look-up (L14 Fig. 4), x in [0, 1] and y in [-1, 1]: a premultiplied colour with opacity |y|.
   Upper half orange to red, lower half cyan to green, black at y = 0. */
LAO_FN lao_v4 vsf_lookup(float x, float y) {
    LAO_EXACT float far_hue = y < 0.0f ? 0.544262973f : 0.0744865201f;
    LAO_EXACT float near_hue = y < 0.0f ? 0.333333333f : 0.0f;
    LAO_EXACT float hue = far_hue * (1.0f - x) + near_hue * x;
    LAO_EXACT float opacity = lao_abs(y);
    lao_v3 color = lao_v3_scale(vsf_hue(hue), opacity);
    return lao_v4_make(color.x, color.y, color.z, opacity);
}

/* Where in a map of `count` colours x is: how far behind a colour, and that colour (whole, so that
   there is one behind it). */
LAO_FN lao_v2 vsf_map_place(float x, float count) {
    LAO_EXACT float at = lao_clamp01(x) * (count - 1.0f);
    LAO_EXACT float before = lao_max(lao_min(lao_floor(at), count - 2.0f), 0.0f);
    return lao_v2_make(at - before, before);
}
/* The other look: a colour that tells x, premultiplied with |y|, or more where x is large. */
LAO_FN lao_v4 vsf_mapped(lao_v3 color, float x, float y, float opacity) {
    LAO_EXACT float least = opacity * x;
    LAO_EXACT float most = lao_max(lao_abs(y), least);
    lao_v3 c = lao_v3_scale(color, most);
    return lao_v4_make(c.x, c.y, c.z, most);
}

/* ---- opacity of the baselines (METHODS 10.4) */
/* a^r for a in [0, 1] and r > 0 */
LAO_FN float vsf_power(float a, float r) {
    LAO_EXACT float x = r * lao_log2(a);
    return a > 0.0f ? lao_exp2(x) : 0.0f;
}
/* 1 - |n.v|^r, unit vectors: larger r, more opaque */
LAO_FN float vsf_fresnel(float n_dot_v, float falloff) {
    LAO_EXACT float a = lao_min(lao_abs(n_dot_v), 1.0f);
    LAO_EXACT float o = 1.0f - vsf_power(a, falloff);
    return lao_clamp01(o);
}
/* The other common form, (1 - |n.v|)^r: larger r, less opaque */
LAO_FN float vsf_fresnel_rim(float n_dot_v, float falloff) {
    LAO_EXACT float a = 1.0f - lao_min(lao_abs(n_dot_v), 1.0f);
    return vsf_power(a, falloff);
}
/* A colour that is not premultiplied, with an opacity: premultiplied. */
LAO_FN lao_v4 vsf_premultiply(lao_v3 color, float opacity) {
    lao_v3 c = lao_v3_scale(color, opacity);
    return lao_v4_make(c.x, c.y, c.z, opacity);
}
/* One premultiplied colour over another. */
LAO_FN lao_v4 vsf_over(lao_v4 front, lao_v4 behind) {
    LAO_EXACT float t = 1.0f - front.w;
    LAO_EXACT float x = front.x + t * behind.x;
    LAO_EXACT float y = front.y + t * behind.y;
    LAO_EXACT float z = front.z + t * behind.z;
    LAO_EXACT float w = front.w + t * behind.w;
    return lao_v4_make(x, y, z, w);
}
/* The greater of two, component by component. */
LAO_FN lao_v4 vsf_greater(lao_v4 a, lao_v4 b) {
    return lao_v4_make(lao_max(a.x, b.x), lao_max(a.y, b.y), lao_max(a.z, b.z), lao_max(a.w, b.w));
}
/* The alternative: light is added, at most 1. */
LAO_FN lao_v4 vsf_add(lao_v4 front, lao_v4 behind) {
    LAO_EXACT float x = front.x + behind.x; /* exact: no sum may join a caller's product */
    LAO_EXACT float y = front.y + behind.y;
    LAO_EXACT float z = front.z + behind.z;
    LAO_EXACT float w = front.w + behind.w;
    return lao_v4_make(lao_min(x, 1.0f), lao_min(y, 1.0f), lao_min(z, 1.0f), lao_min(w, 1.0f));
}
/* ---- focus (METHODS 10.5) */
/* How far a depth is outside the focus region, mm */
LAO_FN float vsf_outside(float z, float focus_near, float focus_far) {
    LAO_EXACT float before = focus_near - z;
    LAO_EXACT float behind = z - focus_far;
    return lao_max(lao_max(before, behind), 0.0f);
}
/* Width of the blur in pixels */
LAO_FN float vsf_blur_sigma(float outside, float growth, float sigma_max) {
    LAO_EXACT float sigma = growth * outside;
    return lao_min(sigma, sigma_max);
}
/* exp(-d^2 / (2 sigma^2)); without a width 1 at the centre and 0 elsewhere */
LAO_FN float vsf_gauss(float distance2, float sigma) {
    if (!(sigma > 0.0f)) {
        return distance2 > 0.0f ? 0.0f : 1.0f;
    }
    LAO_EXACT float x = -0.72134752f * (distance2 / sigma / sigma);
    return x < -125.0f ? 0.0f : lao_exp2(x);
}
#define VSF_BLUR_REACH 3.0f /* samples farther than this many sigmas do not count */
#define VSF_BLUR_MOST 96    /* pixels to either side: the widest setting's reach */
/* The focus blur passes by tiles of 16 x 16 pixels to which it brings no colour. */
#define VSF_FOCUS_LEVEL 4u
#define VSF_FOCUS_PIXELS 16
/* Does a sample count in the blur of a centre of depth `z`? Only if it is behind it, or if its own
   blur reaches it, so that what is in focus does not bleed. */
LAO_FN bool vsf_blur_counts(float distance2, float z, float sample_sigma, float sample_z) {
    LAO_EXACT float reach = VSF_BLUR_REACH * sample_sigma;
    LAO_EXACT float reach2 = reach * reach;
    return !(sample_z < z) || distance2 <= reach2;
}
/* Weight of a sample in the blur of a centre with width `sigma`. The sums of weights and of
   weighted colours make a mean; the centre has weight 1. */
LAO_FN float vsf_blur_weight(float distance2, float sigma, float z, float sample_sigma,
                             float sample_z) {
    LAO_EXACT float reach = VSF_BLUR_REACH * sigma;
    LAO_EXACT float reach2 = reach * reach;
    if (distance2 > reach2 || !vsf_blur_counts(distance2, z, sample_sigma, sample_z)) {
        return 0.0f;
    }
    return vsf_gauss(distance2, sigma);
}

/* ---- shadow from the depth buffer (METHODS 10.6) */
/* The colour, darker where the blurred depth (0..1, larger is farther) is less than the depth. */
LAO_FN lao_v3 vsf_unsharp(lao_v3 color, float depth, float blurred, float strength) {
    LAO_EXACT float rise = blurred - depth;
    LAO_EXACT float shade = strength * lao_min(rise, 0.0f);
    LAO_EXACT float x = color.x + shade;
    LAO_EXACT float y = color.y + shade;
    LAO_EXACT float z = color.z + shade;
    return lao_v3_make(lao_max(x, 0.0f), lao_max(y, 0.0f), lao_max(z, 0.0f));
}

/* ---- what the passes are made of */
#define VSF_LEFT_TILES 64 /* along both sides of the picture */
#define VSF_SHADING_ADAPTIVE 0
#define VSF_SHADING_TRANSPARENT 1
#define VSF_SHADING_FRESNEL 2
#define VSF_FALLOFF_PAPER 0
#define VSF_FALLOFF_RIM 1
#define VSF_BLEND_OVER 0
#define VSF_BLEND_ADD 1
#define VSF_NEAR_DISTANCE 0
#define VSF_NEAR_VALUE 1
#define VSF_NEAR_HUES 0
#define VSF_NEAR_MAP 1
/* x of a value between the two that are 0 and 1; 0 for no number */
LAO_FN float vsf_value_x(float value, float low, float high) {
    LAO_EXACT float x = (value - low) / (high - low);
    return x > 0.0f ? lao_min(x, 1.0f) : 0.0f;
}
/* A wall under a head light, whichever side is seen. */
LAO_FN lao_v3 vsf_wall(lao_v3 color, float n_dot_v, float ambient, float diffuse) {
    LAO_EXACT float light = ambient + diffuse * lao_abs(n_dot_v);
    lao_v3 c = lao_v3_scale(color, light);
    return lao_v3_make(lao_clamp01(c.x), lao_clamp01(c.y), lao_clamp01(c.z));
}
/* View depth (mm) of a depth buffer's value d. */
LAO_FN float vsf_view_depth(lao_v4 unproject, float d) {
    LAO_EXACT float z = (unproject.x + unproject.y * d) / (unproject.z + unproject.w * d);
    return z;
}
/* The nearer of two depth buffer values. */
LAO_FN float vsf_nearer(float a, float b, float reversed) {
    return reversed > 0.5f ? lao_max(a, b) : lao_min(a, b);
}
/* Is depth buffer value a in front of b? */
LAO_FN bool vsf_in_front(float a, float b, float reversed) {
    return reversed > 0.5f ? a > b : a < b;
}
/* Has anything been drawn there? */
LAO_FN bool vsf_is_covered(float d, float reversed) {
    return reversed > 0.5f ? d > 0.0f : d < 1.0f;
}
/* Depths of what is covered: their sum over their weight; `otherwise` where there are none. */
LAO_FN float vsf_covered_mean(float sum, float weight, float otherwise) {
    LAO_EXACT float mean = sum / weight;
    return weight > 1.0e-12f ? mean : otherwise;
}
/* A premultiplied colour times a number. */
LAO_FN lao_v4 vsf_scaled(lao_v4 color, float s) {
    LAO_EXACT float x = color.x * s;
    LAO_EXACT float y = color.y * s;
    LAO_EXACT float z = color.z * s;
    LAO_EXACT float w = color.w * s;
    return lao_v4_make(x, y, z, w);
}
/* sum + color weight */
LAO_FN lao_v4 vsf_sum(lao_v4 sum, lao_v4 color, float weight) {
    LAO_EXACT float x = sum.x + color.x * weight;
    LAO_EXACT float y = sum.y + color.y * weight;
    LAO_EXACT float z = sum.z + color.z * weight;
    LAO_EXACT float w = sum.w + color.w * weight;
    return lao_v4_make(x, y, z, w);
}
LAO_FN lao_v4 vsf_mix(lao_v4 a, lao_v4 b, float t) {
    LAO_EXACT float s = 1.0f - t;
    return vsf_sum(vsf_scaled(a, s), b, t);
}

/* The shadow's blurred depth is made at a quarter of the view's size: a texel for 4 x 4 pixels. */
#define VSF_SHADOW_PIXELS 4.0f
#define VSF_SHADOW_LEVEL 2u
#define VSF_SHADOW_REACH 160 /* most texels to either side */
/* Width of its Gaussian in those texels; `width` in parts of the view's diagonal (px). */
LAO_FN float vsf_shadow_sigma(float width, float view_width, float view_height) {
    LAO_EXACT float diagonal = lao_sqrt(view_width * view_width + view_height * view_height);
    LAO_EXACT float sigma = width * diagonal / VSF_SHADOW_PIXELS;
    return sigma;
}
/* Three sigmas, in whole texels or pixels. */
LAO_FN lao_int vsf_reach(float sigma, lao_int most) {
    LAO_EXACT float reach = lao_floor(VSF_BLUR_REACH * sigma);
    return reach < LAO_F(most) ? LAO_I(reach) : most;
}
/* Where a sample's centre lies between texels that cover `samples` of it: x, and the texel before
   it (whole, may be -1). */
LAO_FN lao_v2 vsf_between(float sample_index, float samples) {
    LAO_EXACT float at = (sample_index + 0.5f) / samples - 0.5f;
    LAO_EXACT float before = lao_floor(at);
    return lao_v2_make(at - before, before);
}
LAO_FN float vsf_bilinear(float a, float b, float c, float d, float x, float y) {
    LAO_EXACT float low = a + (b - a) * x;
    LAO_EXACT float high = c + (d - c) * x;
    LAO_EXACT float r = low + (high - low) * y;
    return r;
}
/* The unsharp shadow of a premultiplied colour. */
LAO_FN lao_v4 vsf_shadowed(lao_v4 color, float depth, float blurred, float strength) {
    LAO_EXACT float s = strength * color.w;
    lao_v3 c = vsf_unsharp(lao_v3_make(color.x, color.y, color.z), depth, blurred, s);
    return lao_v4_make(c.x, c.y, c.z, color.w);
}
/* A premultiplied colour that fades with depth (0..1). */
LAO_FN lao_v4 vsf_attenuated(lao_v4 color, float depth, float strength) {
    LAO_EXACT float keep = 1.0f - strength * depth;
    return vsf_scaled(color, lao_clamp01(keep));
}
/* VSF_SHARED_END */

#endif /* VESSELSURFACE_H */

#ifdef VESSELSURFACE_IMPLEMENTATION
#ifndef VESSELSURFACE_IMPLEMENTATION_DONE
#define VESSELSURFACE_IMPLEMENTATION_DONE

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ================================================================================================
 * host */

typedef struct vsf__item_row {
    lao_result result;
    const char *text;
} vsf__item_row;

static const vsf__item_row vsf__items[] = {
#define VSF__ROW(id, result, text) {result, text},
    VSF_LOG_ITEMS(VSF__ROW)
#undef VSF__ROW
};

/* Logs a failure with a place (printf) or NULL; returns its result. */
static lao_result vsf__fail(const vsf_host *host, vsf_log_item item, const char *place, ...) {
    char text[320];
    size_t n;
    if (!host || !host->log) {
        return vsf__items[item].result;
    }
    n = (size_t)snprintf(text, sizeof text, "%s", vsf__items[item].text);
    if (place && n + 2 < sizeof text) {
        va_list list;
        memcpy(text + n, ": ", 3);
        va_start(list, place);
        vsnprintf(text + n + 2, sizeof text - n - 2, place, list);
        va_end(list);
    }
    host->log(host->user, item, vsf__items[item].result, text);
    return vsf__items[item].result;
}

static void *vsf__malloc(void *user, size_t size) {
    (void)user;
    return malloc(size);
}
static void vsf__free(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}
static lao_allocator vsf__allocator(const vsf_host *host) {
    lao_allocator a;
    if (host && host->allocator.allocate && host->allocator.release) {
        return host->allocator;
    }
    a.allocate = vsf__malloc;
    a.release = vsf__free;
    a.user = NULL;
    return a;
}

/* Memory that knows its size, in front of it. NULL: none left, or more than size_t can count. */
enum { VSF__HEAD = 16 };
static void *vsf__take(const lao_allocator *allocator, uint64_t count, size_t size) {
    unsigned char *memory;
    size_t bytes;
    if (count > (SIZE_MAX / 2 - VSF__HEAD) / size) {
        return NULL;
    }
    bytes = VSF__HEAD + (size_t)count * size;
    memory = (unsigned char *)allocator->allocate(allocator->user, bytes);
    if (!memory) {
        return NULL;
    }
    memcpy(memory, &bytes, sizeof bytes);
    return memory + VSF__HEAD;
}
static void vsf__give(const lao_allocator *allocator, void *taken) {
    if (taken) {
        unsigned char *memory = (unsigned char *)taken - VSF__HEAD;
        size_t bytes;
        memcpy(&bytes, memory, sizeof bytes);
        allocator->release(allocator->user, memory, bytes);
    }
}

/* Cuts one block into arrays: a first round with base NULL counts, a second one with the memory
   cuts. Counts stay below 2^34, so that sums of a few dozen parts do not overflow. */
typedef struct vsf__block {
    unsigned char *base;
    uint64_t used;
} vsf__block;
static void *vsf__part(vsf__block *block, uint64_t count, size_t size) {
    unsigned char *part = block->base ? block->base + block->used : NULL;
    block->used += (count * size + 15u) & ~(uint64_t)15u;
    return part;
}
static uint32_t *vsf__part_u32(vsf__block *block, uint64_t count) {
    return (uint32_t *)vsf__part(block, count, sizeof(uint32_t));
}
static float *vsf__part_float(vsf__block *block, uint64_t count) {
    return (float *)vsf__part(block, count, sizeof(float));
}

/* Work in fixed chunks through the host's job. `done` of `total` is what progress hears. */
typedef struct vsf__progress {
    const vsf_host *host;
    uint64_t done, total;
} vsf__progress;
typedef struct vsf__work {
    void (*fn)(void *arg, uint32_t first, uint32_t end);
    void *arg;
    uint32_t items, chunk, offset;
} vsf__work;
static void vsf__work_chunk(void *arg, uint32_t index) {
    const vsf__work *work = (const vsf__work *)arg;
    uint64_t first = ((uint64_t)work->offset + index) * work->chunk;
    uint64_t end = first + work->chunk;
    work->fn(work->arg, (uint32_t)first, end < work->items ? (uint32_t)end : work->items);
}
/* Returns 0, or -1 when the host cancels. Every item counts one unit of progress. */
static int vsf__run(vsf__progress *progress, uint32_t items, uint32_t chunk, void *arg,
                    void (*fn)(void *arg, uint32_t first, uint32_t end)) {
    const vsf_host *host = progress->host;
    const uint32_t batch = 64;
    uint32_t chunks = items / chunk + (items % chunk != 0), i;
    vsf__work work;
    work.fn = fn;
    work.arg = arg;
    work.items = items;
    work.chunk = chunk;
    for (work.offset = 0; work.offset < chunks; work.offset += batch) {
        uint32_t count = chunks - work.offset < batch ? chunks - work.offset : batch;
        uint64_t units = (uint64_t)count * chunk;
        if (host && host->job.run) {
            host->job.run(host->job.user, count, vsf__work_chunk, &work);
        } else {
            for (i = 0; i < count; i++) {
                vsf__work_chunk(&work, i);
            }
        }
        progress->done += units;
        if (progress->done > progress->total) {
            progress->done = progress->total;
        }
        if (host && host->job.progress &&
            host->job.progress(host->job.user, progress->done, progress->total)) {
            return -1;
        }
    }
    return 0;
}
static vsf__progress vsf__progress_make(const vsf_host *host, uint64_t total) {
    vsf__progress p;
    p.host = host;
    p.done = 0;
    p.total = total;
    return p;
}
enum { VSF__CHUNK = 4096 };

/* ================================================================================================
 * triangles, in double precision */

static void vsf__load(const float *p, double v[3]) {
    v[0] = (double)p[0];
    v[1] = (double)p[1];
    v[2] = (double)p[2];
}
static void vsf__sub(const double a[3], const double b[3], double r[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        r[k] = a[k] - b[k];
    }
}
static double vsf__dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static void vsf__cross(const double a[3], const double b[3], double r[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
    r[0] = x;
    r[1] = y;
}
/* Divides by the length and returns it; a vector without one becomes 0. */
static double vsf__unit(double v[3]) {
    double length = sqrt(vsf__dot(v, v));
    int k;
    for (k = 0; k < 3; k++) {
        v[k] = length > 0 ? v[k] / length : 0;
    }
    return length;
}
/* Unit normal of a triangle; returns twice its area. */
static double vsf__face(const double p0[3], const double p1[3], const double p2[3],
                        double normal[3]) {
    double a[3], b[3];
    vsf__sub(p1, p0, a);
    vsf__sub(p2, p0, b);
    vsf__cross(a, b, normal);
    return vsf__unit(normal);
}
/* The gradient is a (l1 - l0) + b (l2 - l0). Returns twice the area, 0 without one. */
static double vsf__gradient_parts(const double p0[3], const double p1[3], const double p2[3],
                                  double normal[3], double a[3], double b[3]) {
    double e1[3], e2[3], area2 = vsf__face(p0, p1, p2, normal);
    int k;
    vsf__sub(p0, p2, e2);
    vsf__sub(p1, p0, e1);
    vsf__cross(normal, e2, a);
    vsf__cross(normal, e1, b);
    for (k = 0; k < 3; k++) {
        a[k] = area2 > 0 ? a[k] / area2 : 0;
        b[k] = area2 > 0 ? b[k] / area2 : 0;
    }
    return area2;
}
VSF_API void vsf_triangle_gradient(const double p0[3], const double p1[3], const double p2[3],
                                   const double l[3], double gradient[3]) {
    double n[3], a[3], b[3];
    int k;
    vsf__gradient_parts(p0, p1, p2, n, a, b);
    for (k = 0; k < 3; k++) {
        gradient[k] = a[k] * (l[1] - l[0]) + b[k] * (l[2] - l[0]);
    }
}
VSF_API int vsf_turn(const double from[3], const double to[3], const double v[3],
                     double turned[3]) {
    double axis[3], across[3], c = vsf__dot(from, to), along, input[3];
    int k;
    memcpy(input, v, sizeof input);
    vsf__cross(from, to, axis);
    vsf__cross(axis, input, across);
    along = vsf__dot(axis, input);
    for (k = 0; k < 3; k++) { /* Rodrigues; |axis| is the sine */
        turned[k] = c > -1 + 1e-9 ? c * input[k] + across[k] + axis[k] * (along / (1 + c)) : 0;
    }
    return c > -1 + 1e-9 ? 0 : -1;
}
VSF_API void vsf_corner_areas(const double p0[3], const double p1[3], const double p2[3],
                              double areas[3]) {
    const double *p[3];
    double e[3][3], dot[3], n[3], area;
    int k, obtuse = -1;
    p[0] = p0;
    p[1] = p1;
    p[2] = p2;
    area = 0.5 * vsf__face(p0, p1, p2, n);
    for (k = 0; k < 3; k++) {
        vsf__sub(p[(k + 2) % 3], p[(k + 1) % 3], e[k]); /* opposite to corner k */
    }
    for (k = 0; k < 3; k++) {
        dot[k] = -vsf__dot(e[(k + 1) % 3], e[(k + 2) % 3]);
        obtuse = dot[k] < 0 ? k : obtuse;
    }
    for (k = 0; k < 3; k++) {
        int q = (k + 1) % 3, r = (k + 2) % 3;
        if (!(area > 0)) {
            areas[k] = 0;
        } else if (obtuse >= 0) {
            areas[k] = obtuse == k ? area / 2 : area / 4;
        } else { /* cot = dot / (2 area), at the angle opposite to the edge */
            areas[k] =
                (vsf__dot(e[q], e[q]) * dot[q] + vsf__dot(e[r], e[r]) * dot[r]) / (16 * area);
        }
    }
}

/* ================================================================================================
 * building a mesh */

/* What building needs until the mesh exists. All arrays come from one block. */
typedef struct vsf__build {
    const vsf_host *host;
    const vsf_mesh_desc *desc;
    uint32_t *target;     /* per desc vertex: first vertex at its place, later its index */
    uint32_t *source;     /* per vertex: desc vertex */
    uint32_t *table;      /* hash table of places */
    uint32_t *corners;    /* 3 per triangle */
    uint32_t *origin;     /* per triangle: desc triangle */
    uint32_t *opposites;  /* 3 per triangle */
    uint32_t *order[2];   /* 3 per triangle: half-edges by their ends */
    uint32_t *starts;     /* per vertex + 1: counting sort */
    uint32_t *part;       /* per triangle: its part */
    uint32_t *queue;      /* per triangle */
    unsigned char *flags; /* per triangle: VSF__TURN, VSF__FLAT */
    unsigned char *borders;
    uint32_t table_mask, vertex_count, triangle_count;
    vsf_mesh_info info;
    vsf_warning warnings[VSF_LOG_ITEM_COUNT];
    uint32_t warning_count;
} vsf__build;
enum { VSF__TURN = 1, VSF__FLAT = 2 };

static void vsf__warn(vsf__build *b, vsf_log_item item, uint32_t place, uint32_t count) {
    uint32_t i = 0;
    if (count == 0) {
        return;
    }
    while (i < b->warning_count && b->warnings[i].item != item) {
        i++;
    }
    if (i == b->warning_count) {
        b->warnings[i].item = item;
        b->warnings[i].count = 0;
        b->warnings[i].first = place;
        b->warning_count++;
    }
    b->warnings[i].count += count;
}

static lao_result vsf__mesh_check(const vsf_host *host, const vsf_mesh_desc *desc) {
    const uint32_t most = 1u << 29;
    uint32_t i;
    if (desc->vertex_count > most || desc->triangle_count > most) {
        return vsf__fail(host, VSF_LOG_MESH_COUNT, "%u vertices, %u triangles", desc->vertex_count,
                         desc->triangle_count);
    }
    if ((desc->vertex_count && !desc->positions) || (desc->triangle_count && !desc->triangles) ||
        (desc->attribute_count && !desc->attributes)) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "arrays of vsf_mesh_desc");
    }
    for (i = 0; i < desc->attribute_count; i++) {
        const vsf_attribute *a = desc->attributes + i;
        if (!a->name || (!a->values && desc->vertex_count) || a->components > 1024) {
            return vsf__fail(host, VSF_LOG_MESH_ATTRIBUTE, "attribute %u", i);
        }
    }
    for (i = 0; i < 3 * desc->triangle_count; i++) {
        if (desc->triangles[i] >= desc->vertex_count) {
            return vsf__fail(host, VSF_LOG_MESH_INDEX, "triangle %u, vertex %u of %u", i / 3,
                             desc->triangles[i], desc->vertex_count);
        }
    }
    return LAO_OK;
}

static void vsf__build_parts(vsf__build *b, vsf__block *block) {
    uint64_t n = b->desc->vertex_count, m = b->desc->triangle_count, size = 16;
    while (size < 2 * n) {
        size *= 2;
    }
    b->table_mask = (uint32_t)(size - 1);
    b->target = vsf__part_u32(block, n);
    b->source = vsf__part_u32(block, n);
    b->table = vsf__part_u32(block, b->desc->flags & VSF_MESH_NO_WELD ? 0 : size);
    b->corners = vsf__part_u32(block, 3 * m);
    b->origin = vsf__part_u32(block, m);
    b->opposites = vsf__part_u32(block, 3 * m);
    b->order[0] = vsf__part_u32(block, 3 * m);
    b->order[1] = vsf__part_u32(block, 3 * m);
    b->starts = vsf__part_u32(block, n + 1);
    b->part = vsf__part_u32(block, m);
    b->queue = vsf__part_u32(block, m);
    b->flags = (unsigned char *)vsf__part(block, m, 1);
    b->borders = (unsigned char *)vsf__part(block, n, 1);
}

/* target = the first vertex at the same place, VSF_NONE where there is no place */
static void vsf__weld(vsf__build *b) {
    const float *p = b->desc->positions;
    uint32_t i, n = b->desc->vertex_count, weld = !(b->desc->flags & VSF_MESH_NO_WELD);
    if (weld) {
        memset(b->table, 0xff, ((size_t)b->table_mask + 1) * sizeof *b->table);
    }
    for (i = 0; i < n; i++, p += 3) {
        uint32_t slot;
        b->target[i] = i;
        if (!(fabsf(p[0]) <= 1e9f && fabsf(p[1]) <= 1e9f && fabsf(p[2]) <= 1e9f)) {
            b->target[i] = VSF_NONE;
            vsf__warn(b, VSF_LOG_VERTICES_WILD, i, 1);
            b->info.wild++;
            continue;
        }
        if (!weld) {
            continue;
        }
        slot =
            lao_hash(lao_float_bits(p[0] + 0.0f) +
                     lao_hash(lao_float_bits(p[1] + 0.0f) + lao_hash(lao_float_bits(p[2] + 0.0f))));
        for (slot &= b->table_mask; b->table[slot] != VSF_NONE; slot = (slot + 1) & b->table_mask) {
            const float *q = b->desc->positions + 3 * (size_t)b->table[slot];
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) { /* finite: equal but for -0 */
                break;
            }
        }
        if (b->table[slot] == VSF_NONE) {
            b->table[slot] = i;
        } else {
            b->target[i] = b->table[slot];
            b->info.welded++;
        }
    }
}

/* Gives vertices their indices, in the order of the desc. */
static void vsf__pick_vertices(vsf__build *b) {
    uint32_t i;
    for (i = 0; i < b->desc->vertex_count; i++) {
        if (b->target[i] == VSF_NONE) {
            continue;
        }
        if (b->target[i] < i) {
            b->target[i] = b->target[b->target[i]]; /* the first one has its index already */
        } else {
            b->source[b->vertex_count] = i;
            b->target[i] = b->vertex_count++;
        }
    }
}

static void vsf__corner(const vsf__build *b, uint32_t half, double p[3]) {
    vsf__load(b->desc->positions + 3 * (size_t)b->source[b->corners[half]], p);
}

/* Triangles whose corners are apart; those without area are marked and go later, because they may
   connect others. */
static void vsf__pick_triangles(vsf__build *b) {
    uint32_t t, m = 0;
    for (t = 0; t < b->desc->triangle_count; t++) {
        const uint32_t *from = b->desc->triangles + 3 * (size_t)t;
        uint32_t *to = b->corners + 3 * (size_t)m;
        double p[3][3], n[3];
        int k;
        for (k = 0; k < 3; k++) {
            to[k] = b->target[from[k]];
        }
        if (to[0] == VSF_NONE || to[1] == VSF_NONE || to[2] == VSF_NONE) {
            vsf__warn(b, VSF_LOG_TRIANGLES_WILD, t, 1);
            continue;
        }
        if (to[0] == to[1] || to[1] == to[2] || to[2] == to[0]) {
            vsf__warn(b, VSF_LOG_TRIANGLES_DEGENERATE, t, 1);
            b->info.degenerate++;
            continue;
        }
        for (k = 0; k < 3; k++) {
            vsf__corner(b, 3 * m + (uint32_t)k, p[k]);
        }
        b->flags[m] = 0;
        if (!(vsf__face(p[0], p[1], p[2], n) > 0)) {
            b->flags[m] = VSF__FLAT;
            vsf__warn(b, VSF_LOG_TRIANGLES_DEGENERATE, t, 1);
            b->info.degenerate++;
        }
        b->origin[m++] = t;
    }
    b->triangle_count = m;
}

static uint32_t vsf__next(uint32_t half) {
    return half % 3 == 2 ? half - 2 : half + 1;
}
static uint32_t vsf__previous(uint32_t half) {
    return half % 3 == 0 ? half + 2 : half - 1;
}

/* Counting sort of half-edges by their lower (or higher) end; stable. */
static void vsf__sort_halves(vsf__build *b, const uint32_t *from, uint32_t *to, int by_lower) {
    uint32_t i, count = 3 * b->triangle_count, sum = 0;
    memset(b->starts, 0, ((size_t)b->vertex_count + 1) * sizeof *b->starts);
    for (i = 0; i < count; i++) {
        uint32_t v = b->corners[i], w = b->corners[vsf__next(i)];
        b->starts[(v < w) == by_lower ? v : w]++;
    }
    for (i = 0; i <= b->vertex_count; i++) {
        uint32_t n = b->starts[i];
        b->starts[i] = sum;
        sum += n;
    }
    for (i = 0; i < count; i++) {
        uint32_t half = from ? from[i] : i;
        uint32_t v = b->corners[half], w = b->corners[vsf__next(half)];
        to[b->starts[(v < w) == by_lower ? v : w]++] = half;
    }
}
static int vsf__same_edge(const vsf__build *b, uint32_t h, uint32_t g) {
    uint32_t a = b->corners[h], c = b->corners[vsf__next(h)];
    uint32_t d = b->corners[g], e = b->corners[vsf__next(g)];
    return (a == d && c == e) || (a == e && c == d);
}
static void vsf__border(vsf__build *b, uint32_t half) {
    b->borders[b->corners[half]] = 1;
    b->borders[b->corners[vsf__next(half)]] = 1;
}
/* opposites, whatever their direction: where an edge has two triangles */
static void vsf__pair_halves(vsf__build *b) {
    uint32_t i, j, count = 3 * b->triangle_count;
    memset(b->borders, 0, b->vertex_count);
    vsf__sort_halves(b, NULL, b->order[0], 0);
    vsf__sort_halves(b, b->order[0], b->order[1], 1);
    for (i = 0; i < count; i = j) {
        const uint32_t *h = b->order[1] + i;
        uint32_t k;
        for (j = i + 1; j < count && vsf__same_edge(b, h[0], b->order[1][j]); j++) {
        }
        b->info.edges++;
        for (k = i; k < j; k++) {
            b->opposites[b->order[1][k]] = VSF_NONE;
        }
        if (j - i == 2) {
            b->opposites[h[0]] = h[1];
            b->opposites[h[1]] = h[0];
        } else {
            uint32_t triangle = b->origin[h[0] / 3];
            vsf__border(b, h[0]);
            vsf__warn(b, j - i == 1 ? VSF_LOG_EDGES_OPEN : VSF_LOG_EDGES_CROWDED, triangle, 1);
            b->info.open_edges += j - i == 1;
            b->info.crowded_edges += j - i > 2;
        }
    }
}

/* Do two opposite half-edges run the same way, so that one triangle must be turned? */
static int vsf__runs_along(const vsf__build *b, uint32_t half, uint32_t opposite) {
    return b->corners[half] == b->corners[opposite];
}
/* A part is what hangs together through paired edges. Marks the triangles to be turned so that all
   run like its first; returns the part's end in the queue, which begins at `first`. */
static uint32_t vsf__flood(vsf__build *b, uint32_t first, uint32_t part) {
    uint32_t end = first + 1, i, k;
    b->part[b->queue[first]] = part;
    for (i = first; i < end; i++) {
        uint32_t t = b->queue[i];
        for (k = 0; k < 3; k++) {
            uint32_t half = 3 * t + k, other = b->opposites[half], u = other / 3;
            if (other == VSF_NONE || b->part[u] != VSF_NONE) {
                continue;
            }
            b->part[u] = part;
            b->flags[u] =
                (unsigned char)((b->flags[u] & ~VSF__TURN) |
                                ((b->flags[t] ^ vsf__runs_along(b, half, other)) & VSF__TURN));
            b->queue[end++] = u;
        }
    }
    return end;
}

/* Area of the triangles that run like the first and of the others; six times the signed volume as
   if all ran like the first, about a point of the part; is it closed? */
typedef struct vsf__shape {
    double area[2], volume6;
    int closed;
} vsf__shape;
static void vsf__part_centre(const vsf__build *b, uint32_t first, uint32_t end, double centre[3]) {
    uint32_t i;
    int k, axis;
    centre[0] = centre[1] = centre[2] = 0;
    for (i = first; i < end; i++) {
        for (k = 0; k < 3; k++) {
            double p[3];
            vsf__corner(b, 3 * b->queue[i] + (uint32_t)k, p);
            for (axis = 0; axis < 3; axis++) {
                centre[axis] += p[axis] / (3.0 * (double)(end - first));
            }
        }
    }
}
static vsf__shape vsf__measure_part(const vsf__build *b, uint32_t first, uint32_t end) {
    vsf__shape shape;
    double centre[3];
    uint32_t i, k;
    memset(&shape, 0, sizeof shape);
    shape.closed = 1;
    vsf__part_centre(b, first, end, centre);
    for (i = first; i < end; i++) {
        uint32_t t = b->queue[i];
        double p[3][3], c[3], a[3], d[3];
        int turned = b->flags[t] & VSF__TURN;
        for (k = 0; k < 3; k++) {
            vsf__corner(b, 3 * t + k, p[k]);
            vsf__sub(p[k], centre, p[k]);
            shape.closed &= b->opposites[3 * t + k] != VSF_NONE;
        }
        vsf__cross(p[1], p[2], c);
        shape.volume6 += (turned ? -1 : 1) * vsf__dot(p[0], c);
        vsf__sub(p[1], p[0], a);
        vsf__sub(p[2], p[0], d);
        vsf__cross(a, d, c);
        shape.area[turned ? 1 : 0] += 0.5 * sqrt(vsf__dot(c, c));
    }
    return shape;
}

/* Exchanges corners 1 and 2 of a marked triangle: its half-edges k become 2 - k. */
static uint32_t vsf__turned_half(const vsf__build *b, uint32_t half) {
    if (half == VSF_NONE || !(b->flags[half / 3] & VSF__TURN)) {
        return half;
    }
    return half - half % 3 + (2 - half % 3);
}
static void vsf__turn_triangles(vsf__build *b) {
    uint32_t t, k;
    for (t = 0; t < b->triangle_count; t++) {
        uint32_t *h = b->opposites + 3 * (size_t)t, *c = b->corners + 3 * (size_t)t;
        for (k = 0; k < 3; k++) {
            h[k] = vsf__turned_half(b, h[k]);
        }
        if (b->flags[t] & VSF__TURN) {
            uint32_t x = h[0], v = c[1];
            h[0] = h[2];
            h[2] = x;
            c[1] = c[2];
            c[2] = v;
        }
    }
}

/* Chooses for each part which side is out, and says what was wrong. */
static void vsf__orient_part(vsf__build *b, uint32_t first, uint32_t end) {
    vsf__shape shape = vsf__measure_part(b, first, end);
    int keep = (b->desc->flags & VSF_MESH_KEEP_WINDING) != 0;
    int flip = (b->desc->flags & VSF_MESH_FLIP) != 0, turn_all;
    uint32_t i, mended = 0, place = VSF_NONE;
    b->info.parts++;
    b->info.closed_parts += shape.closed != 0;
    turn_all = shape.area[1] > shape.area[0]; /* the side with more area is as the file meant it */
    if (!keep) {
        double volume6 = turn_all ? -shape.volume6 : shape.volume6;
        uint32_t triangle = b->origin[b->queue[first]];
        for (i = first; i < end; i++) {
            uint32_t t = b->queue[i];
            if (((b->flags[t] & VSF__TURN) != 0) != turn_all) {
                mended++;
                place = b->origin[t] < place ? b->origin[t] : place;
            }
        }
        vsf__warn(b, VSF_LOG_WINDING_MENDED, place, mended);
        if (volume6 < 0 && shape.closed) {
            turn_all = !turn_all;
            vsf__warn(b, VSF_LOG_PARTS_INWARD, triangle, 1);
        } else if (volume6 < 0 && !flip) {
            vsf__warn(b, VSF_LOG_PARTS_SUSPECT, triangle, 1);
        }
    }
    for (i = first; i < end; i++) {
        uint32_t t = b->queue[i];
        unsigned turn = keep ? 0u : (b->flags[t] & VSF__TURN) ^ (unsigned)turn_all;
        turn ^= (unsigned)flip;
        b->info.turned += turn;
        b->flags[t] = (unsigned char)((b->flags[t] & VSF__FLAT) | turn);
    }
}

static void vsf__orient(vsf__build *b) {
    uint32_t t, end = 0;
    memset(b->part, 0xff, (size_t)b->triangle_count * sizeof *b->part);
    for (t = 0; t < b->triangle_count; t++) {
        if (b->part[t] == VSF_NONE) {
            uint32_t first = end;
            b->queue[first] = t;
            end = vsf__flood(b, first, t);
            vsf__orient_part(b, first, end);
        }
    }
    vsf__turn_triangles(b);
    for (t = 0; t < 3 * b->triangle_count; t++) {
        uint32_t other = b->opposites[t];
        if (other != VSF_NONE && vsf__runs_along(b, t, other)) {
            vsf__border(b, t);
            b->opposites[t] = b->opposites[other] = VSF_NONE;
            b->info.twisted_edges++;
            vsf__warn(b, VSF_LOG_WINDING_TWISTED, b->origin[t / 3], 1);
        }
    }
}

/* Triangles without area go now; their neighbours lose them. */
static void vsf__drop_flat(vsf__build *b) {
    uint32_t t, k, m = 0;
    for (t = 0; t < b->triangle_count; t++) {
        b->part[t] = b->flags[t] & VSF__FLAT ? VSF_NONE : m++;
    }
    for (t = 0; t < b->triangle_count; t++) {
        uint32_t to = b->part[t];
        if (to == VSF_NONE) {
            continue;
        }
        for (k = 0; k < 3; k++) {
            uint32_t other = b->opposites[3 * t + k];
            if (other != VSF_NONE) {
                uint32_t u = b->part[other / 3];
                other = u == VSF_NONE ? VSF_NONE : 3 * u + other % 3;
            }
            b->opposites[3 * to + k] = other;
            b->corners[3 * to + k] = b->corners[3 * t + k];
        }
        b->origin[to] = b->origin[t];
    }
    b->triangle_count = m;
}

/* ---- the mesh itself */

static void vsf__mesh_parts(vsf_mesh *mesh, const vsf_attribute *attributes, vsf__block *block) {
    uint64_t n = mesh->vertex_count, m = mesh->triangle_count;
    uint32_t i;
    mesh->positions = vsf__part_float(block, 3 * n);
    mesh->normals = vsf__part_float(block, 3 * n);
    mesh->areas = (double *)vsf__part(block, n, sizeof(double));
    mesh->triangles = vsf__part_u32(block, 3 * m);
    mesh->opposites = vsf__part_u32(block, 3 * m);
    mesh->ring_starts = vsf__part_u32(block, n + 1);
    mesh->ring_corners = vsf__part_u32(block, 3 * m);
    mesh->borders = (unsigned char *)vsf__part(block, n, 1);
    mesh->vertex_sources = vsf__part_u32(block, n);
    mesh->triangle_sources = vsf__part_u32(block, m);
    mesh->vertex_targets = vsf__part_u32(block, mesh->source_count);
    mesh->attributes =
        (vsf_attribute *)vsf__part(block, mesh->attribute_count, sizeof(vsf_attribute));
    for (i = 0; i < mesh->attribute_count; i++) {
        uint32_t components = attributes[i].components ? attributes[i].components : 1;
        size_t length = strlen(attributes[i].name) + 1;
        float *values = vsf__part_float(block, n * components);
        char *name = (char *)vsf__part(block, length, 1);
        if (block->base) {
            memcpy(name, attributes[i].name, length);
            mesh->attributes[i].name = name;
            mesh->attributes[i].components = components;
            mesh->attributes[i].values = values;
        }
    }
}

/* Normals and areas of the vertices, corner by corner in the order of the triangles. */
static void vsf__vertex_shapes(void *arg, uint32_t first, uint32_t end) {
    vsf_mesh *mesh = (vsf_mesh *)arg;
    uint32_t v, i;
    int k;
    for (v = first; v < end; v++) {
        double normal[3] = {0, 0, 0}, area = 0;
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t half = mesh->ring_corners[i];
            double p[3][3], n[3], areas[3], area2;
            vsf__load(mesh->positions + 3 * (size_t)v, p[0]);
            vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__next(half)], p[1]);
            vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__previous(half)], p[2]);
            area2 = vsf__face(p[0], p[1], p[2], n);
            vsf_corner_areas(p[0], p[1], p[2], areas);
            for (k = 0; k < 3; k++) {
                normal[k] += area2 * n[k];
            }
            area += areas[0];
        }
        vsf__unit(normal);
        for (k = 0; k < 3; k++) {
            mesh->normals[3 * (size_t)v + (size_t)k] = (float)normal[k];
        }
        mesh->areas[v] = area;
    }
}

/* What depends on positions. Returns 0, or -1 when the host cancels. */
static int vsf__mesh_shape(vsf__progress *progress, vsf_mesh *mesh) {
    double edges = 0, area = 0, volume6 = 0, centre[3];
    uint32_t t, v;
    int k, any = 0;
    memset(mesh->info.bounds, 0, sizeof mesh->info.bounds);
    for (v = 0; v < mesh->vertex_count; v++) {
        const float *p = mesh->positions + 3 * (size_t)v;
        if (mesh->ring_starts[v] == mesh->ring_starts[v + 1]) {
            continue;
        }
        for (k = 0; k < 3; k++) {
            float *low = &mesh->info.bounds[0][k], *high = &mesh->info.bounds[1][k];
            *low = !any || p[k] < *low ? p[k] : *low;
            *high = !any || p[k] > *high ? p[k] : *high;
        }
        any = 1;
    }
    for (k = 0; k < 3; k++) {
        centre[k] = 0.5 * ((double)mesh->info.bounds[0][k] + (double)mesh->info.bounds[1][k]);
    }
    for (t = 0; t < mesh->triangle_count; t++) {
        double p[3][3], n[3], e[3], area2;
        for (k = 0; k < 3; k++) {
            vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (uint32_t)k], p[k]);
        }
        area2 = vsf__face(p[0], p[1], p[2], n);
        vsf__sub(p[0], centre, e);
        area += 0.5 * area2;
        volume6 += area2 * vsf__dot(n, e);
        for (k = 0; k < 3; k++) {
            vsf__sub(p[k], p[(k + 1) % 3], e);
            edges += sqrt(vsf__dot(e, e));
        }
    }
    mesh->info.area = area;
    mesh->info.volume = volume6 / 6;
    mesh->info.mean_edge = mesh->triangle_count ? edges / (3.0 * mesh->triangle_count) : 0;
    return vsf__run(progress, mesh->vertex_count, VSF__CHUNK, mesh, vsf__vertex_shapes);
}

static void vsf__mesh_rings(vsf_mesh *mesh) {
    uint32_t i, sum = 0, count = 3 * mesh->triangle_count;
    uint32_t *starts = mesh->ring_starts;
    memset(starts, 0, ((size_t)mesh->vertex_count + 1) * sizeof *starts);
    for (i = 0; i < count; i++) {
        starts[mesh->triangles[i]]++;
    }
    for (i = 0; i <= mesh->vertex_count; i++) {
        uint32_t n = starts[i];
        starts[i] = sum;
        sum += n;
    }
    for (i = 0; i < count; i++) {
        mesh->ring_corners[starts[mesh->triangles[i]]++] = i;
    }
    for (i = mesh->vertex_count; i > 0; i--) {
        starts[i] = starts[i - 1];
    }
    starts[0] = 0;
}

/* A file's normals, where they are any. */
static void vsf__given_normals(vsf_mesh *mesh, const float *normals) {
    uint32_t v;
    int k;
    for (v = 0; v < mesh->vertex_count; v++) {
        double n[3];
        vsf__load(normals + 3 * (size_t)mesh->vertex_sources[v], n);
        if (fabs(n[0]) <= 1e30 && fabs(n[1]) <= 1e30 && fabs(n[2]) <= 1e30 &&
            vsf__unit(n) > 1e-20) {
            for (k = 0; k < 3; k++) {
                mesh->normals[3 * (size_t)v + (size_t)k] = (float)n[k];
            }
        }
    }
}

static void vsf__mesh_fill(const vsf__build *b, vsf_mesh *mesh) {
    const vsf_mesh_desc *desc = b->desc;
    uint32_t i, k;
    for (i = 0; i < mesh->vertex_count; i++) {
        memcpy(mesh->positions + 3 * (size_t)i, desc->positions + 3 * (size_t)b->source[i],
               3 * sizeof(float));
    }
    memcpy(mesh->triangles, b->corners, 3 * (size_t)mesh->triangle_count * sizeof(uint32_t));
    memcpy(mesh->opposites, b->opposites, 3 * (size_t)mesh->triangle_count * sizeof(uint32_t));
    memcpy(mesh->triangle_sources, b->origin, mesh->triangle_count * sizeof(uint32_t));
    memcpy(mesh->borders, b->borders, mesh->vertex_count);
    memcpy(mesh->vertex_sources, b->source, mesh->vertex_count * sizeof(uint32_t));
    if (mesh->source_count) {
        memcpy(mesh->vertex_targets, b->target, mesh->source_count * sizeof(uint32_t));
    }
    for (k = 0; k < mesh->attribute_count; k++) {
        uint32_t n = mesh->attributes[k].components;
        float *to = (float *)(uintptr_t)mesh->attributes[k].values;
        for (i = 0; i < mesh->vertex_count; i++) {
            memcpy(to + (size_t)i * n, desc->attributes[k].values + (size_t)b->source[i] * n,
                   n * sizeof(float));
        }
    }
}

static void vsf__log_warnings(const vsf_host *host, const vsf_mesh *mesh) {
    char text[256];
    uint32_t i;
    for (i = 0; host && host->log && i < mesh->warning_count; i++) {
        vsf_mesh_warning_text(mesh, i, text, sizeof text);
        host->log(host->user, mesh->warnings[i].item, LAO_OK, text);
    }
}

/* The second half: a mesh of what was picked. */
static lao_result vsf__mesh_finish(vsf__build *b, vsf__progress *progress, vsf_mesh *mesh) {
    vsf_mesh m;
    vsf__block block = {NULL, 0};
    uint32_t v;
    memset(&m, 0, sizeof m);
    m.allocator = vsf__allocator(b->host);
    m.vertex_count = b->vertex_count;
    m.triangle_count = b->triangle_count;
    m.source_count = b->desc->vertex_count;
    m.attribute_count = b->desc->attribute_count;
    vsf__mesh_parts(&m, b->desc->attributes, &block);
    m.memory = vsf__take(&m.allocator, block.used, 1);
    if (!m.memory) {
        return vsf__fail(b->host, VSF_LOG_MEMORY, "%u vertices, %u triangles", m.vertex_count,
                         m.triangle_count);
    }
    block.base = (unsigned char *)m.memory;
    block.used = 0;
    vsf__mesh_parts(&m, b->desc->attributes, &block);
    vsf__mesh_fill(b, &m);
    vsf__mesh_rings(&m);
    for (v = 0; v < m.vertex_count; v++) {
        if (m.ring_starts[v] == m.ring_starts[v + 1]) {
            vsf__warn(b, VSF_LOG_VERTICES_LOOSE, m.vertex_sources[v], 1);
            b->info.unreferenced++;
        }
    }
    m.info = b->info;
    memcpy(m.warnings, b->warnings, sizeof m.warnings);
    m.warning_count = b->warning_count;
    if (vsf__mesh_shape(progress, &m)) {
        vsf_mesh_free(&m);
        return vsf__fail(b->host, VSF_LOG_CANCELLED, NULL);
    }
    if (b->desc->normals) {
        vsf__given_normals(&m, b->desc->normals);
    }
    vsf__log_warnings(b->host, &m);
    *mesh = m;
    return LAO_OK;
}

/* Between the long phases. Returns 0, or -1 when the host cancels. */
static int vsf__tick(vsf__progress *progress, uint64_t units) {
    const vsf_host *host = progress->host;
    progress->done += units;
    return host && host->job.progress &&
                   host->job.progress(host->job.user, progress->done, progress->total)
               ? -1
               : 0;
}

static lao_result vsf__mesh_make(vsf__build *b, vsf_mesh *mesh) {
    uint64_t n = b->desc->vertex_count;
    vsf__progress progress = vsf__progress_make(b->host, 4 * n);
    vsf__weld(b);
    vsf__pick_vertices(b);
    if (vsf__tick(&progress, n)) {
        return vsf__fail(b->host, VSF_LOG_CANCELLED, NULL);
    }
    vsf__pick_triangles(b);
    vsf__pair_halves(b);
    if (vsf__tick(&progress, n)) {
        return vsf__fail(b->host, VSF_LOG_CANCELLED, NULL);
    }
    vsf__orient(b);
    vsf__drop_flat(b);
    if (vsf__tick(&progress, n)) {
        return vsf__fail(b->host, VSF_LOG_CANCELLED, NULL);
    }
    if (b->triangle_count == 0) {
        return vsf__fail(b->host, VSF_LOG_MESH_EMPTY, "%u vertices, %u triangles given",
                         b->desc->vertex_count, b->desc->triangle_count);
    }
    return vsf__mesh_finish(b, &progress, mesh);
}

VSF_API lao_result vsf_mesh_build(const vsf_host *host, const vsf_mesh_desc *desc, vsf_mesh *mesh) {
    lao_allocator allocator = vsf__allocator(host);
    vsf__build b;
    vsf__block block = {NULL, 0};
    void *memory;
    lao_result result;
    if (!desc || !mesh) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_mesh_build");
    }
    result = vsf__mesh_check(host, desc);
    if (result != LAO_OK) {
        return result;
    }
    memset(&b, 0, sizeof b);
    b.host = host;
    b.desc = desc;
    vsf__build_parts(&b, &block);
    memory = vsf__take(&allocator, block.used + 16, 1);
    if (!memory) {
        return vsf__fail(host, VSF_LOG_MEMORY, "%u vertices, %u triangles", desc->vertex_count,
                         desc->triangle_count);
    }
    block.base = (unsigned char *)memory;
    block.used = 0;
    vsf__build_parts(&b, &block);
    result = vsf__mesh_make(&b, mesh);
    vsf__give(&allocator, memory);
    return result;
}

VSF_API void vsf_mesh_free(vsf_mesh *mesh) {
    if (mesh && mesh->memory) {
        vsf__give(&mesh->allocator, mesh->memory);
    }
    if (mesh) {
        memset(mesh, 0, sizeof *mesh);
    }
}

VSF_API size_t vsf_mesh_warning_text(const vsf_mesh *mesh, uint32_t i, char *text, size_t size) {
    const vsf_warning *w;
    int of_vertex;
    if (!mesh || i >= mesh->warning_count) {
        if (size) {
            text[0] = 0;
        }
        return 0;
    }
    w = mesh->warnings + i;
    of_vertex = w->item == VSF_LOG_VERTICES_LOOSE || w->item == VSF_LOG_VERTICES_WILD;
    return (size_t)snprintf(text, size, "%u %s, first: %s %u", w->count, vsf__items[w->item].text,
                            of_vertex ? "vertex" : "triangle", w->first);
}

/* ================================================================================================
 * smoothing and subdivision */

/* The neighbours of a vertex, each once: corner by corner the one ahead, and the one behind where
   no triangle lies beyond. Calls back with the half-edge that leads to (or from) the neighbour. */
static uint32_t vsf__neighbour_count(const vsf_mesh *mesh, uint32_t v) {
    uint32_t i, count = 0;
    for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
        uint32_t half = mesh->ring_corners[i];
        count += 1u + (mesh->opposites[vsf__previous(half)] == VSF_NONE);
    }
    return count;
}

typedef struct vsf__smoother {
    const vsf_mesh *mesh;
    uint32_t *starts;     /* vertex_count + 1 */
    uint32_t *neighbours; /* from starts[v] */
    double *weights;      /* sum 1, or all 0 */
    double *from, *to;    /* 3 per vertex */
    double factor;
    int uniform;
} vsf__smoother;

/* Cotangent at the corner `half`, 0 without area. */
static double vsf__cotangent(const vsf_mesh *mesh, uint32_t half) {
    double p[3][3], a[3], b[3], n[3], area2;
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[half], p[0]);
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__next(half)], p[1]);
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__previous(half)], p[2]);
    area2 = vsf__face(p[0], p[1], p[2], n);
    vsf__sub(p[1], p[0], a);
    vsf__sub(p[2], p[0], b);
    return area2 > 0 ? vsf__dot(a, b) / area2 : 0;
}
/* Of the edge of a half-edge: half the cotangents of the angles that look at it. */
static double vsf__edge_weight(const vsf__smoother *s, uint32_t half) {
    uint32_t other = s->mesh->opposites[half];
    double w = 1;
    if (!s->uniform) {
        w = vsf__cotangent(s->mesh, vsf__previous(half));
        w = 0.5 * (w + (other == VSF_NONE ? 0 : vsf__cotangent(s->mesh, vsf__previous(other))));
    }
    return w > 0 ? w : 0;
}
static void vsf__smooth_weights(void *arg, uint32_t first, uint32_t end) {
    vsf__smoother *s = (vsf__smoother *)arg;
    const vsf_mesh *mesh = s->mesh;
    uint32_t v, i;
    for (v = first; v < end; v++) {
        uint32_t slot = s->starts[v];
        double sum = 0;
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t half = mesh->ring_corners[i], behind = vsf__previous(half);
            s->neighbours[slot] = mesh->triangles[vsf__next(half)];
            s->weights[slot++] = vsf__edge_weight(s, half);
            if (mesh->opposites[behind] == VSF_NONE) {
                s->neighbours[slot] = mesh->triangles[behind];
                s->weights[slot++] = vsf__edge_weight(s, behind);
            }
        }
        for (i = s->starts[v]; i < slot; i++) {
            sum += s->weights[i];
        }
        for (i = s->starts[v]; i < slot; i++) {
            s->weights[i] = sum > 0 && !mesh->borders[v] ? s->weights[i] / sum : 0;
        }
    }
}
static void vsf__smooth_step(void *arg, uint32_t first, uint32_t end) {
    vsf__smoother *s = (vsf__smoother *)arg;
    uint32_t v, i;
    int k;
    for (v = first; v < end; v++) {
        const double *p = s->from + 3 * (size_t)v;
        double move[3] = {0, 0, 0};
        for (i = s->starts[v]; i < s->starts[v + 1]; i++) {
            const double *q = s->from + 3 * (size_t)s->neighbours[i];
            for (k = 0; k < 3; k++) {
                move[k] += s->weights[i] * (q[k] - p[k]);
            }
        }
        for (k = 0; k < 3; k++) {
            s->to[3 * (size_t)v + (size_t)k] = p[k] + s->factor * move[k];
        }
    }
}
static int vsf__smooth_run(vsf__progress *progress, vsf__smoother *s, uint32_t steps, double lambda,
                           double mu) {
    uint32_t i, n = s->mesh->vertex_count;
    if (vsf__run(progress, n, VSF__CHUNK, s, vsf__smooth_weights)) {
        return -1;
    }
    for (i = 0; i < 2 * steps; i++) {
        double *swap = s->from;
        s->factor = i % 2 ? mu : lambda;
        if (vsf__run(progress, n, VSF__CHUNK, s, vsf__smooth_step)) {
            return -1;
        }
        s->from = s->to;
        s->to = swap;
    }
    return 0;
}

static lao_result vsf__smooth_checked(const vsf_host *host, vsf_mesh *mesh, uint32_t steps,
                                      double lambda, double mu, int uniform) {
    lao_allocator allocator = vsf__allocator(host);
    vsf__progress progress =
        vsf__progress_make(host, (uint64_t)mesh->vertex_count * (2 * (uint64_t)steps + 2));
    vsf__smoother s;
    vsf__block block = {NULL, 0};
    uint64_t n = mesh->vertex_count, round;
    void *memory = NULL;
    size_t i;
    int cancelled;
    memset(&s, 0, sizeof s);
    s.mesh = mesh;
    s.uniform = uniform;
    for (round = 0; round < 2; round++) {
        s.starts = vsf__part_u32(&block, n + 1);
        s.neighbours = vsf__part_u32(&block, 6 * (uint64_t)mesh->triangle_count);
        s.weights = (double *)vsf__part(&block, 6 * (uint64_t)mesh->triangle_count, sizeof(double));
        s.from = (double *)vsf__part(&block, 3 * n, sizeof(double));
        s.to = (double *)vsf__part(&block, 3 * n, sizeof(double));
        if (round == 0) {
            memory = vsf__take(&allocator, block.used, 1);
            if (!memory) {
                return vsf__fail(host, VSF_LOG_MEMORY, "smoothing");
            }
            block.base = (unsigned char *)memory;
            block.used = 0;
        }
    }
    s.starts[0] = 0;
    for (i = 0; i < n; i++) {
        s.starts[i + 1] = s.starts[i] + vsf__neighbour_count(mesh, (uint32_t)i);
    }
    for (i = 0; i < 3 * n; i++) {
        s.from[i] = (double)mesh->positions[i];
    }
    cancelled = vsf__smooth_run(&progress, &s, steps, lambda, mu);
    if (!cancelled) {
        vsf__progress quiet = vsf__progress_make(NULL, 0); /* from here on the mesh changes */
        for (i = 0; i < 3 * n; i++) {
            mesh->positions[i] = (float)s.from[i];
        }
        vsf__mesh_shape(&quiet, mesh);
    }
    vsf__give(&allocator, memory);
    return cancelled ? vsf__fail(host, VSF_LOG_CANCELLED, NULL) : LAO_OK;
}
VSF_API lao_result vsf_mesh_smooth(const vsf_host *host, vsf_mesh *mesh,
                                   const vsf_smooth_desc *desc) {
    uint32_t steps = desc && desc->steps ? desc->steps : 20;
    double lambda = desc ? desc->lambda : 0, mu = desc ? desc->mu : 0;
    if (!mesh || !mesh->memory) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_mesh_smooth");
    }
    if (lambda == 0 && mu == 0) {
        lambda = 0.5;
        mu = -0.53;
    }
    if (!(lambda > 0 && lambda < -mu && mu >= -10) || steps > 100000) {
        return vsf__fail(host, VSF_LOG_SETTING,
                         "smoothing wants 0 < lambda < -mu <= 10 and at most 100000 steps, not %g, "
                         "%g and %u",
                         lambda, mu, steps);
    }
    return vsf__smooth_checked(host, mesh, steps, lambda, mu, desc && desc->uniform);
}

/* One level of subdivision: arrays of the finer mesh, for vsf_mesh_build. */
typedef struct vsf__loop {
    const vsf_mesh *mesh;
    uint32_t *edge_vertices; /* per half-edge */
    uint32_t *triangles;
    float *positions;
    vsf_attribute *attributes; /* values are cut from the block */
    uint32_t vertex_count;
} vsf__loop;

static void vsf__loop_parts(vsf__loop *l, vsf__block *block) {
    uint32_t i;
    l->edge_vertices = vsf__part_u32(block, 3 * (uint64_t)l->mesh->triangle_count);
    l->triangles = vsf__part_u32(block, 12 * (uint64_t)l->mesh->triangle_count);
    l->positions = vsf__part_float(block, 3 * (uint64_t)l->vertex_count);
    l->attributes =
        (vsf_attribute *)vsf__part(block, l->mesh->attribute_count, sizeof(vsf_attribute));
    for (i = 0; i < l->mesh->attribute_count; i++) {
        uint32_t n = l->mesh->attributes[i].components;
        float *values = vsf__part_float(block, (uint64_t)l->vertex_count * n);
        if (block->base) {
            l->attributes[i] = l->mesh->attributes[i];
            l->attributes[i].values = values;
        }
    }
}

static uint32_t vsf__edge_count(const vsf_mesh *mesh) {
    uint32_t half, count = 0;
    for (half = 0; half < 3 * mesh->triangle_count; half++) {
        count += mesh->opposites[half] == VSF_NONE || mesh->opposites[half] > half;
    }
    return count;
}

/* Neighbours along borders: how many, and the sum of their places. */
static uint32_t vsf__border_sum(const vsf_mesh *mesh, uint32_t v, double sum[3]) {
    uint32_t i, j, count = 0;
    int k;
    sum[0] = sum[1] = sum[2] = 0;
    for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
        uint32_t half[2];
        half[0] = mesh->ring_corners[i];
        half[1] = vsf__previous(half[0]);
        for (j = 0; j < 2; j++) {
            uint32_t w = mesh->triangles[j ? half[1] : vsf__next(half[0])];
            if (mesh->opposites[half[j]] == VSF_NONE) {
                for (k = 0; k < 3; k++) {
                    sum[k] += (double)mesh->positions[3 * (size_t)w + (size_t)k];
                }
                count++;
            }
        }
    }
    return count;
}
static void vsf__loop_vertex(const vsf__loop *l, uint32_t v) {
    const vsf_mesh *mesh = l->mesh;
    uint32_t i, n = mesh->ring_starts[v + 1] - mesh->ring_starts[v];
    double sum[3] = {0, 0, 0}, keep = 1, each = 0;
    int k;
    if (mesh->borders[v]) {
        uint32_t count = vsf__border_sum(mesh, v, sum);
        keep = count == 2 ? 0.75 : 1;
        each = count == 2 ? 0.125 : 0;
    } else if (n >= 3) {
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t w = mesh->triangles[vsf__next(mesh->ring_corners[i])];
            for (k = 0; k < 3; k++) {
                sum[k] += (double)mesh->positions[3 * (size_t)w + (size_t)k];
            }
        }
        each = n == 3 ? 0.1875 : 0.375 / n;
        keep = 1 - each * n;
    }
    for (k = 0; k < 3; k++) {
        size_t at = 3 * (size_t)v + (size_t)k;
        l->positions[at] = (float)(keep * (double)mesh->positions[at] + each * sum[k]);
    }
}
static void vsf__loop_edge(const vsf__loop *l, uint32_t half) {
    const vsf_mesh *mesh = l->mesh;
    uint32_t other = mesh->opposites[half], made = l->edge_vertices[half], i, k;
    const uint32_t *c = mesh->triangles;
    size_t a = c[half], b = c[vsf__next(half)];
    for (k = 0; k < 3; k++) {
        double p = (double)mesh->positions[3 * a + k] + (double)mesh->positions[3 * b + k];
        if (other == VSF_NONE) {
            p *= 0.5;
        } else {
            size_t d = c[vsf__previous(half)], e = c[vsf__previous(other)];
            p = 0.375 * p +
                0.125 * ((double)mesh->positions[3 * d + k] + (double)mesh->positions[3 * e + k]);
        }
        l->positions[3 * (size_t)made + k] = (float)p;
    }
    for (i = 0; i < mesh->attribute_count; i++) {
        uint32_t n = mesh->attributes[i].components;
        const float *from = mesh->attributes[i].values;
        float *to = (float *)(uintptr_t)l->attributes[i].values;
        for (k = 0; k < n; k++) {
            to[(size_t)made * n + k] = 0.5f * from[a * n + k] + 0.5f * from[b * n + k];
        }
    }
}
static void vsf__loop_fill(vsf__loop *l) {
    const vsf_mesh *mesh = l->mesh;
    uint32_t v, t, i, made = mesh->vertex_count;
    for (v = 0; v < mesh->vertex_count; v++) {
        vsf__loop_vertex(l, v);
    }
    for (i = 0; i < mesh->attribute_count; i++) {
        memcpy((float *)(uintptr_t)l->attributes[i].values, mesh->attributes[i].values,
               (size_t)mesh->vertex_count * mesh->attributes[i].components * sizeof(float));
    }
    for (i = 0; i < 3 * mesh->triangle_count; i++) {
        uint32_t other = mesh->opposites[i];
        if (other != VSF_NONE && other < i) {
            l->edge_vertices[i] = l->edge_vertices[other];
        } else {
            l->edge_vertices[i] = made++;
            vsf__loop_edge(l, i);
        }
    }
    for (t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->triangles + 3 * (size_t)t;
        const uint32_t *e = l->edge_vertices + 3 * (size_t)t;
        uint32_t *to = l->triangles + 12 * (size_t)t;
        for (i = 0; i < 3; i++) { /* a corner with its two edges, and the middle */
            const uint32_t corner[3] = {c[i], e[i], e[(i + 2) % 3]};
            memcpy(to + (size_t)3 * i, corner, sizeof corner);
            to[9 + i] = e[i];
        }
    }
}

static lao_result vsf__subdivide_once(const vsf_host *host, const vsf_mesh *mesh, vsf_mesh *finer) {
    lao_allocator allocator = vsf__allocator(host);
    uint64_t vertices = (uint64_t)mesh->vertex_count + vsf__edge_count(mesh);
    vsf__loop l;
    vsf__block block = {NULL, 0};
    vsf_mesh_desc desc;
    lao_result result;
    void *memory;
    uint32_t i;
    if (vertices > 1u << 29 || mesh->triangle_count > 1u << 27) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    memset(&l, 0, sizeof l);
    l.mesh = mesh;
    l.vertex_count = (uint32_t)vertices;
    vsf__loop_parts(&l, &block);
    memory = vsf__take(&allocator, block.used, 1);
    if (!memory) {
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    block.base = (unsigned char *)memory;
    block.used = 0;
    vsf__loop_parts(&l, &block);
    vsf__loop_fill(&l);
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = l.vertex_count;
    desc.positions = l.positions;
    desc.triangle_count = 4 * mesh->triangle_count;
    desc.triangles = l.triangles;
    desc.attributes = l.attributes;
    desc.attribute_count = mesh->attribute_count;
    desc.flags = VSF_MESH_KEEP_WINDING; /* unpaired edges got a vertex for each triangle */
    if (!mesh->info.crowded_edges && !mesh->info.twisted_edges) {
        desc.flags |= VSF_MESH_NO_WELD;
    }
    result = vsf_mesh_build(host, &desc, finer);
    for (i = 0; result == LAO_OK && i < finer->vertex_count; i++) {
        uint32_t from = finer->vertex_sources[i];
        finer->vertex_sources[i] =
            from < mesh->vertex_count ? mesh->vertex_sources[from] : VSF_NONE;
    }
    for (i = 0; result == LAO_OK && i < finer->triangle_count; i++) {
        finer->triangle_sources[i] = mesh->triangle_sources[finer->triangle_sources[i] / 4];
    }
    if (result == LAO_OK) {
        finer->source_count = 0;
    }
    vsf__give(&allocator, memory);
    return result;
}

VSF_API lao_result vsf_mesh_subdivide(const vsf_host *host, const vsf_mesh *mesh, uint32_t levels,
                                      vsf_mesh *finer) {
    vsf_host quiet; /* warnings of the coarse mesh need no repetition */
    vsf_mesh now, next;
    lao_result result = LAO_OK;
    uint32_t i;
    if (!mesh || !mesh->memory || !finer) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_mesh_subdivide");
    }
    if (levels < 1 || levels > 8) {
        return vsf__fail(host, VSF_LOG_SETTING, "%u levels of subdivision, not 1 to 8", levels);
    }
    memset(&quiet, 0, sizeof quiet);
    if (host) {
        quiet = *host;
        quiet.log = NULL;
    }
    memset(&now, 0, sizeof now);
    for (i = 0; i < levels && result == LAO_OK; i++) {
        result = vsf__subdivide_once(&quiet, i ? &now : mesh, &next);
        if (result == LAO_OK) {
            vsf_mesh_free(&now);
            now = next;
        }
    }
    if (result != LAO_OK) {
        vsf_mesh_free(&now);
        return vsf__fail(host,
                         result == LAO_ERROR_OUT_OF_MEMORY ? VSF_LOG_MEMORY
                         : result == LAO_ERROR_NOT_READY   ? VSF_LOG_CANCELLED
                                                           : VSF_LOG_MESH_COUNT,
                         "subdivision level %u", i);
    }
    *finer = now;
    return LAO_OK;
}

/* ================================================================================================
 * decimation */

enum { VSF__MOST_CELLS = 1 << 20 }; /* along an axis */

/* What meets in a cell: the sum of the quadrics of its corners' planes about its middle, and means
   weighted by area. */
typedef struct vsf__cell {
    double planes[6], toward[3], mean[3], weight;
    uint32_t first;  /* vertex */
    uint32_t vertex; /* of the coarser mesh; VSF_NONE: no triangle is left there */
} vsf__cell;

typedef struct vsf__lattice {
    const vsf_mesh *mesh;
    double low[3], span, size; /* mm: corner, longest side, side of a cell */
    uint64_t *keys;            /* per cell, in the order of the vertices: its place */
    uint32_t *cells;           /* per vertex */
    uint32_t *table;           /* hashed: cell + 1 */
    uint32_t mask, count;
    vsf__cell *parts; /* per cell */
} vsf__lattice;

static uint64_t vsf__cell_key(const vsf__lattice *l, const float *p) {
    const double most = (double)VSF__MOST_CELLS;
    uint64_t key = 0;
    int k;
    for (k = 0; k < 3; k++) {
        double at = floor(((double)p[k] - l->low[k]) / l->size);
        at = at < most ? at : most;
        key = key << 21 | (uint64_t)(at > 0 ? at : 0);
    }
    return key;
}
/* Triangles whose corners are in three cells. */
static uint32_t vsf__cells_left(const vsf__lattice *l) {
    const uint32_t *t = l->mesh->triangles;
    uint32_t i, left = 0;
    for (i = 0; i < l->mesh->triangle_count; i++, t += 3) {
        uint32_t a = l->cells[t[0]], b = l->cells[t[1]], c = l->cells[t[2]];
        left += a != b && b != c && c != a;
    }
    return left;
}
/* Gives every vertex its cell, with n of them along the longest axis. */
static void vsf__cells_find(vsf__lattice *l, uint32_t n) {
    uint32_t v;
    l->size = l->span / n;
    l->count = 0;
    memset(l->table, 0, ((size_t)l->mask + 1) * sizeof *l->table);
    for (v = 0; v < l->mesh->vertex_count; v++) {
        uint64_t key = vsf__cell_key(l, l->mesh->positions + 3 * (size_t)v);
        uint32_t at = lao_hash((uint32_t)key ^ lao_hash((uint32_t)(key >> 32))) & l->mask;
        while (l->table[at] && l->keys[l->table[at] - 1] != key) {
            at = (at + 1) & l->mask;
        }
        if (!l->table[at]) {
            l->keys[l->count++] = key;
            l->table[at] = l->count;
        }
        l->cells[v] = l->table[at] - 1;
    }
}
/* The finest lattice with at most `most` triangles. Returns 0, or -1 when the host cancels. */
static int vsf__cells_fit(vsf__progress *progress, vsf__lattice *l, uint32_t most) {
    uint32_t few = 1, many = VSF__MOST_CELLS;
    while (many - few > 1) {
        uint32_t middle = few + (many - few) / 2;
        vsf__cells_find(l, middle);
        if (vsf__cells_left(l) <= most) {
            few = middle;
        } else {
            many = middle;
        }
        if (vsf__tick(progress, 1)) {
            return -1;
        }
    }
    vsf__cells_find(l, few);
    return 0;
}

static void vsf__cell_middle(const vsf__lattice *l, uint32_t cell, double middle[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        uint32_t at = (uint32_t)(l->keys[cell] >> (42 - 21 * k)) & 0x1fffffu;
        middle[k] = l->low[k] + (at + 0.5) * l->size;
    }
}
static void vsf__cell_add(const vsf__lattice *l, uint32_t v, const double n[3], double area) {
    vsf__cell *c = &l->parts[l->cells[v]];
    double middle[3], p[3], off;
    int k;
    vsf__cell_middle(l, l->cells[v], middle);
    vsf__load(l->mesh->positions + 3 * (size_t)v, p);
    vsf__sub(p, middle, p);
    off = vsf__dot(n, p);
    for (k = 0; k < 3; k++) {
        c->planes[k] += area * n[k] * n[k];
        c->planes[3 + k] += area * n[k] * n[(k + 1) % 3]; /* xy, yz, zx */
        c->toward[k] += area * off * n[k];
        c->mean[k] += area * p[k];
    }
    c->weight += area;
}
/* Quadrics of all corners, and a number for each cell in which a triangle that stays has one.
   Returns how many there are. */
static uint32_t vsf__cells_sum(vsf__lattice *l, uint32_t *triangles, uint32_t *sources) {
    const uint32_t *t = l->mesh->triangles;
    uint32_t i, k, vertices = 0, left = 0;
    memset(l->parts, 0, (size_t)l->count * sizeof *l->parts);
    for (i = 0; i < l->count; i++) {
        l->parts[i].first = l->parts[i].vertex = VSF_NONE;
    }
    for (i = 0; i < l->mesh->triangle_count; i++, t += 3) {
        uint32_t cell[3];
        double p[3][3], n[3], area;
        for (k = 0; k < 3; k++) {
            cell[k] = l->cells[t[k]];
            vsf__load(l->mesh->positions + 3 * (size_t)t[k], p[k]);
        }
        area = vsf__face(p[0], p[1], p[2], n);
        for (k = 0; k < 3; k++) {
            vsf__cell_add(l, t[k], n, area);
            l->parts[cell[k]].first =
                t[k] < l->parts[cell[k]].first ? t[k] : l->parts[cell[k]].first;
        }
        if (cell[0] == cell[1] || cell[1] == cell[2] || cell[2] == cell[0]) {
            continue;
        }
        for (k = 0; k < 3; k++) {
            vsf__cell *c = &l->parts[cell[k]];
            c->vertex = c->vertex == VSF_NONE ? vertices++ : c->vertex;
            triangles[3 * (size_t)left + k] = c->vertex;
        }
        sources[left++] = i;
    }
    return vertices;
}
/* The place that the quadric likes best, held to the mean by a hundredth of its weight, and within
   a cell's size of it. */
static void vsf__cell_place(const vsf__lattice *l, uint32_t cell, float out[3]) {
    const vsf__cell *c = &l->parts[cell];
    const double hold = 0.01 * c->weight, weight = c->weight > 0 ? c->weight : 1;
    double a[3][3], b[3], middle[3], cross[3][3], det;
    int k, j;
    for (k = 0; k < 3; k++) {
        a[k][k] = c->planes[k] + hold;
        a[k][(k + 1) % 3] = a[(k + 1) % 3][k] = c->planes[3 + k];
        b[k] = c->toward[k] + hold * c->mean[k] / weight;
    }
    for (k = 0; k < 3; k++) {
        vsf__cross(a[(k + 1) % 3], a[(k + 2) % 3], cross[k]);
    }
    det = vsf__dot(a[0], cross[0]);
    vsf__cell_middle(l, cell, middle);
    for (k = 0; k < 3; k++) {
        double at = 0, mean = c->mean[k] / weight;
        for (j = 0; j < 3; j++) {
            at += cross[j][k] * b[j];
        }
        at = det > 0 ? at / det : mean;
        at = at > mean - l->size ? at < mean + l->size ? at : mean + l->size : mean - l->size;
        out[k] = (float)(middle[k] + at);
    }
}
/* Means of the vertices of each cell, of the numbers alone. */
static void vsf__cells_attribute(const vsf__lattice *l, const vsf_attribute *from, double *sums,
                                 float *to) {
    const uint32_t width = from->components;
    uint32_t v, k, i;
    for (k = 0; k < width; k++) {
        memset(sums, 0, 2 * (size_t)l->count * sizeof *sums);
        for (v = 0; v < l->mesh->vertex_count; v++) {
            double value = (double)from->values[(size_t)v * width + k];
            double *sum = sums + 2 * (size_t)l->cells[v];
            if (fabs(value) < 1e300) {
                sum[0] += value;
                sum[1] += 1;
            }
        }
        for (i = 0; i < l->count; i++) {
            if (l->parts[i].vertex != VSF_NONE) {
                to[(size_t)l->parts[i].vertex * width + k] =
                    (float)(sums[2 * (size_t)i] / sums[2 * (size_t)i + 1]);
            }
        }
    }
}

/* What the coarser mesh is made of. */
typedef struct vsf__coarse {
    float *positions;
    uint32_t *triangles, *sources;
    uint32_t *firsts; /* per vertex: of the finer mesh */
    uint32_t *table;  /* hashed: triangle + 1 */
    uint32_t mask;
    vsf_attribute *attributes;
    double *sums;
} vsf__coarse;

static void vsf__coarse_parts(vsf__coarse *c, const vsf__lattice *l, uint32_t left,
                              vsf__block *block) {
    const vsf_mesh *mesh = l->mesh;
    uint32_t i;
    c->positions = vsf__part_float(block, 3 * (uint64_t)l->count);
    c->triangles = vsf__part_u32(block, 3 * (uint64_t)left);
    c->sources = vsf__part_u32(block, left);
    c->firsts = vsf__part_u32(block, l->count);
    for (c->mask = 1; c->mask < 2 * (uint64_t)left; c->mask *= 2) {
    }
    c->table = vsf__part_u32(block, c->mask--);
    c->sums = (double *)vsf__part(block, mesh->attribute_count ? 2 * (uint64_t)l->count : 0,
                                  sizeof(double));
    c->attributes = (vsf_attribute *)vsf__part(block, mesh->attribute_count, sizeof(vsf_attribute));
    for (i = 0; i < mesh->attribute_count; i++) {
        float *values = vsf__part_float(block, (uint64_t)l->count * mesh->attributes[i].components);
        if (block->base) {
            c->attributes[i] = mesh->attributes[i];
            c->attributes[i].values = values;
        }
    }
}

/* Where a triangle's three vertices are in the table, or would be. */
static uint32_t vsf__fold_find(const vsf__coarse *c, uint32_t triangle) {
    const uint32_t *t = c->triangles + 3 * (size_t)triangle;
    uint32_t sum = t[0] + t[1] + t[2], at, k;
    at = lao_hash(sum ^ lao_hash(t[0] ^ t[1] ^ t[2])) & c->mask;
    for (; c->table[at]; at = (at + 1) & c->mask) {
        const uint32_t *o = c->triangles + 3 * (size_t)(c->table[at] - 1);
        for (k = 0; k < 3 && (t[k] == o[0] || t[k] == o[1] || t[k] == o[2]); k++) {
        }
        if (k == 3) {
            break;
        }
    }
    return at;
}
/* Where a wrinkle was pressed flat two triangles lie on each other, face to face: they go. Returns
   how many triangles are left. */
static uint32_t vsf__drop_folds(vsf__coarse *c, uint32_t count) {
    uint32_t i, k, left = 0;
    memset(c->table, 0, ((size_t)c->mask + 1) * sizeof *c->table);
    for (i = 0; i < count; i++) {
        uint32_t at = vsf__fold_find(c, i);
        const uint32_t *t = c->triangles + 3 * (size_t)i, *o;
        if (!c->table[at]) {
            c->table[at] = i + 1;
            continue;
        }
        o = c->triangles + 3 * (size_t)(c->table[at] - 1);
        k = t[0] == o[0] ? 0 : t[0] == o[1] ? 1 : 2;
        if (c->sources[c->table[at] - 1] != VSF_NONE && t[1] == o[(k + 2) % 3]) {
            c->sources[c->table[at] - 1] = c->sources[i] = VSF_NONE;
        }
    }
    for (i = 0; i < count; i++) {
        if (c->sources[i] != VSF_NONE) {
            memmove(c->triangles + 3 * (size_t)left, c->triangles + 3 * (size_t)i,
                    3 * sizeof *c->triangles);
            c->sources[left++] = c->sources[i];
        }
    }
    return left;
}

/* The mesh of a lattice's cells. */
static lao_result vsf__coarse_build(const vsf_host *host, vsf__lattice *l, vsf__coarse *c,
                                    uint32_t left, vsf_mesh *coarser) {
    const vsf_mesh *mesh = l->mesh;
    vsf_mesh_desc desc;
    lao_result result;
    uint32_t i;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = vsf__cells_sum(l, c->triangles, c->sources);
    desc.positions = c->positions;
    desc.triangle_count = vsf__drop_folds(c, left);
    desc.triangles = c->triangles;
    desc.attributes = c->attributes;
    desc.attribute_count = mesh->attribute_count;
    for (i = 0; i < l->count; i++) {
        if (l->parts[i].vertex != VSF_NONE) {
            vsf__cell_place(l, i, c->positions + 3 * (size_t)l->parts[i].vertex);
            c->firsts[l->parts[i].vertex] = l->parts[i].first;
        }
    }
    for (i = 0; i < mesh->attribute_count; i++) {
        vsf__cells_attribute(l, &mesh->attributes[i], c->sums,
                             (float *)(uintptr_t)c->attributes[i].values); /* ours */
    }
    result = vsf_mesh_build(host, &desc, coarser);
    if (result != LAO_OK) {
        return result;
    }
    for (i = 0; i < coarser->vertex_count; i++) {
        coarser->vertex_sources[i] = mesh->vertex_sources[c->firsts[coarser->vertex_sources[i]]];
    }
    for (i = 0; i < coarser->triangle_count; i++) {
        coarser->triangle_sources[i] =
            mesh->triangle_sources[c->sources[coarser->triangle_sources[i]]];
    }
    coarser->source_count = 0;
    return LAO_OK;
}

static lao_result vsf__decimate_cells(const vsf_host *host, vsf__lattice *l, uint32_t left,
                                      vsf_mesh *coarser) {
    lao_allocator allocator = vsf__allocator(host);
    vsf__block block = {NULL, 0};
    vsf__coarse c;
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    void *memory;
    memset(&c, 0, sizeof c);
    vsf__coarse_parts(&c, l, left, &block);
    memory = vsf__take(&allocator, block.used, 1);
    l->parts = (vsf__cell *)vsf__take(&allocator, l->count, sizeof *l->parts);
    if (memory && l->parts) {
        block.base = (unsigned char *)memory;
        block.used = 0;
        vsf__coarse_parts(&c, l, left, &block);
        result = vsf__coarse_build(host, l, &c, left, coarser);
    }
    vsf__give(&allocator, memory);
    vsf__give(&allocator, l->parts);
    return result;
}

static void vsf__lattice_parts(vsf__lattice *l, vsf__block *block) {
    l->keys = (uint64_t *)vsf__part(block, l->mesh->vertex_count, sizeof *l->keys);
    l->cells = vsf__part_u32(block, l->mesh->vertex_count);
    l->table = vsf__part_u32(block, (uint64_t)l->mask + 1);
}

/* Without words: the caller says what failed. */
static lao_result vsf__decimate(const vsf_host *host, const vsf_mesh *mesh, uint32_t most,
                                vsf_mesh *coarser) {
    lao_allocator allocator = vsf__allocator(host);
    vsf__progress progress = vsf__progress_make(host, 20);
    vsf__block block = {NULL, 0};
    vsf__lattice l;
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    void *memory;
    int k;
    memset(&l, 0, sizeof l);
    l.mesh = mesh;
    for (k = 0; k < 3; k++) {
        double side = (double)mesh->info.bounds[1][k] - (double)mesh->info.bounds[0][k];
        l.low[k] = (double)mesh->info.bounds[0][k];
        l.span = side > l.span ? side : l.span;
    }
    for (l.mask = 1; l.mask < 2 * mesh->vertex_count; l.mask *= 2) {
    }
    l.mask--;
    vsf__lattice_parts(&l, &block);
    memory = vsf__take(&allocator, block.used, 1);
    if (memory) {
        block.base = (unsigned char *)memory;
        block.used = 0;
        vsf__lattice_parts(&l, &block);
        result = vsf__cells_fit(&progress, &l, most)
                     ? LAO_ERROR_NOT_READY
                     : vsf__decimate_cells(host, &l, vsf__cells_left(&l), coarser);
        vsf__give(&allocator, memory);
    }
    return result;
}

VSF_API lao_result vsf_mesh_decimate(const vsf_host *host, const vsf_mesh *mesh, uint32_t most,
                                     vsf_mesh *coarser) {
    vsf_host quiet; /* warnings of the fine mesh need no repetition */
    lao_result result;
    if (!mesh || !mesh->memory || !coarser) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_mesh_decimate");
    }
    if (most < 4) {
        return vsf__fail(host, VSF_LOG_SETTING, "%u triangles to be left, not 4 or more", most);
    }
    memset(&quiet, 0, sizeof quiet);
    if (host) {
        quiet = *host;
        quiet.log = NULL;
    }
    result = vsf__decimate(&quiet, mesh, most, coarser);
    if (result != LAO_OK) {
        return vsf__fail(host,
                         result == LAO_ERROR_OUT_OF_MEMORY ? VSF_LOG_MEMORY
                         : result == LAO_ERROR_NOT_READY   ? VSF_LOG_CANCELLED
                                                           : VSF_LOG_MESH_EMPTY,
                         "decimation of %u triangles to %u", mesh->triangle_count, most);
    }
    return LAO_OK;
}

/* ================================================================================================
 * curvatures */

typedef struct vsf__curver {
    const vsf_mesh *mesh;
    float *curvatures, *directions;
} vsf__curver;

/* Second fundamental form of a face in its frame (u, v): least squares over the three edges of
   II(e) = difference of normals. Returns 0, or -1 without area. */
static int vsf__face_form(const double p[3][3], const double n[3][3], double u[3], double v[3],
                          double normal[3], double form[3]) {
    double uu = 0, uv = 0, vv = 0, r0 = 0, r1 = 0, r2 = 0, m, det;
    int k;
    if (!(vsf__face(p[0], p[1], p[2], normal) > 0)) {
        return -1;
    }
    vsf__sub(p[1], p[0], u);
    vsf__unit(u);
    vsf__cross(normal, u, v);
    for (k = 0; k < 3; k++) {
        double e[3], d[3], eu, ev, du, dv;
        vsf__sub(p[(k + 1) % 3], p[k], e);
        vsf__sub(n[(k + 1) % 3], n[k], d);
        eu = vsf__dot(e, u);
        ev = vsf__dot(e, v);
        du = vsf__dot(d, u);
        dv = vsf__dot(d, v);
        uu += eu * eu;
        uv += eu * ev;
        vv += ev * ev;
        r0 += du * eu;
        r1 += du * ev + dv * eu;
        r2 += dv * ev;
    }
    m = uu + vv; /* [uu uv 0; uv m uv; 0 uv vv] form = r */
    det = uu * (m * vv - uv * uv) - uv * uv * vv;
    if (!(fabs(det) > 0)) {
        return -1;
    }
    form[0] = (r0 * (m * vv - uv * uv) - uv * (r1 * vv - uv * r2)) / det;
    form[1] = (uu * (r1 * vv - uv * r2) - r0 * uv * vv) / det;
    form[2] = (uu * (m * r2 - uv * r1) - uv * (uv * r2) + r0 * uv * uv) / det;
    return 0;
}

/* Eigenvalues and first direction of a symmetric form in the plane across the unit vector n. */
static void vsf__principal(const double n[3], double form[3][3], double k[2], double direction[3]) {
    double t[3] = {0, 0, 0}, s[3], a = 0, b = 0, c = 0, angle, spread;
    int i, j,
        least = fabs(n[0]) <= fabs(n[1]) && fabs(n[0]) <= fabs(n[2]) ? 0
                : fabs(n[1]) <= fabs(n[2])                           ? 1
                                                                     : 2;
    t[least] = 1;
    vsf__cross(n, t, s);
    vsf__unit(s);
    vsf__cross(s, n, t);
    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) {
            a += t[i] * form[i][j] * t[j];
            b += t[i] * form[i][j] * s[j];
            c += s[i] * form[i][j] * s[j];
        }
    }
    spread = sqrt(0.25 * (a - c) * (a - c) + b * b);
    k[0] = 0.5 * (a + c) + spread;
    k[1] = 0.5 * (a + c) - spread;
    angle = 0.5 * atan2(2 * b, a - c);
    for (i = 0; i < 3; i++) {
        direction[i] = cos(angle) * t[i] + sin(angle) * s[i];
    }
}

static void vsf__curve(void *arg, uint32_t first, uint32_t end) {
    const vsf__curver *c = (const vsf__curver *)arg;
    const vsf_mesh *mesh = c->mesh;
    uint32_t v, i, k, j;
    for (v = first; v < end; v++) {
        double form[3][3], total = 0, at[3], result[2], direction[3];
        vsf__load(mesh->normals + 3 * (size_t)v, at);
        memset(form, 0, sizeof form);
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t half = mesh->ring_corners[i], corner[3];
            double p[3][3], n[3][3], fu[3], fv[3], fn[3], f[3], areas[3];
            corner[0] = v;
            corner[1] = mesh->triangles[vsf__next(half)];
            corner[2] = mesh->triangles[vsf__previous(half)];
            for (k = 0; k < 3; k++) {
                vsf__load(mesh->positions + 3 * (size_t)corner[k], p[k]);
                vsf__load(mesh->normals + 3 * (size_t)corner[k], n[k]);
            }
            if (vsf__face_form((const double(*)[3])p, (const double(*)[3])n, fu, fv, fn, f) ||
                vsf_turn(fn, at, fu, fu) || vsf_turn(fn, at, fv, fv)) {
                continue;
            }
            vsf_corner_areas(p[0], p[1], p[2], areas);
            total += areas[0];
            for (k = 0; k < 3; k++) {
                for (j = 0; j < 3; j++) {
                    form[k][j] += areas[0] * (f[0] * fu[k] * fu[j] + f[2] * fv[k] * fv[j] +
                                              f[1] * (fu[k] * fv[j] + fv[k] * fu[j]));
                }
            }
        }
        for (k = 0; k < 9; k++) {
            form[k / 3][k % 3] = total > 0 ? form[k / 3][k % 3] / total : 0;
        }
        vsf__principal(at, form, result, direction);
        c->curvatures[2 * (size_t)v] = (float)result[0];
        c->curvatures[2 * (size_t)v + 1] = (float)result[1];
        for (k = 0; c->directions && k < 3; k++) {
            c->directions[3 * (size_t)v + k] = total > 0 ? (float)direction[k] : 0.0f;
        }
    }
}

VSF_API lao_result vsf_curvatures(const vsf_host *host, const vsf_mesh *mesh, float *curvatures,
                                  float *directions) {
    vsf__curver curver;
    vsf__progress progress;
    if (!mesh || !mesh->memory || !curvatures) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_curvatures");
    }
    curver.mesh = mesh;
    curver.curvatures = curvatures;
    curver.directions = directions;
    progress = vsf__progress_make(host, mesh->vertex_count);
    if (vsf__run(&progress, mesh->vertex_count, VSF__CHUNK, &curver, vsf__curve)) {
        return vsf__fail(host, VSF_LOG_CANCELLED, NULL);
    }
    return LAO_OK;
}

/* ================================================================================================
 * buffers and the measure */

static const lao_buffer_row vsf__buffer_rows[] = {
#define VSF__ROW(name, format) {#name, format},
    VSF_BUFFERS(VSF__ROW)
#undef VSF__ROW
};
VSF_API const lao_buffer_row *vsf_buffer_rows(uint32_t *count) {
    if (count) {
        *count = (uint32_t)(sizeof vsf__buffer_rows / sizeof vsf__buffer_rows[0]);
    }
    return vsf__buffer_rows;
}

/* The gradient at corner `half` of a triangle, turned to its vertex's normal: `ahead` times
   l(next) - l(here) plus `behind` times l(previous) - l(here). Returns its weight, the corner's
   share of area; 0 where there is none. */
static double vsf__corner_gradient(const vsf_mesh *mesh, uint32_t half, double ahead[3],
                                   double behind[3]) {
    double p[3][3], n[3], face[3], areas[3];
    size_t v = mesh->triangles[half];
    vsf__load(mesh->positions + 3 * v, p[0]);
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__next(half)], p[1]);
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__previous(half)], p[2]);
    vsf__load(mesh->normals + 3 * v, n);
    if (!(vsf__dot(n, n) > 0) ||
        !(vsf__gradient_parts(p[0], p[1], p[2], face, ahead, behind) > 0) ||
        vsf_turn(face, n, ahead, ahead) || vsf_turn(face, n, behind, behind)) {
        return 0;
    }
    vsf_corner_areas(p[0], p[1], p[2], areas);
    return areas[0];
}

static void vsf__ring_entry(float *entry, const double a[3], double weight_a, const double b[3],
                            double weight_b, double total, uint32_t neighbour) {
    int k;
    for (k = 0; k < 3; k++) {
        double g = (weight_a > 0 ? weight_a * a[k] : 0) + (weight_b > 0 ? weight_b * b[k] : 0);
        entry[k] = total > 0 ? (float)(g / total) : 0.0f;
    }
    entry[3] = (float)neighbour;
}

typedef struct vsf__ringer {
    const vsf_mesh *mesh;
    const vsf_buffers *buffers;
    const uint32_t *starts;
} vsf__ringer;

static void vsf__ring_fill(void *arg, uint32_t first, uint32_t end) {
    const vsf__ringer *r = (const vsf__ringer *)arg;
    const vsf_mesh *mesh = r->mesh;
    uint32_t v, i;
    for (v = first; v < end; v++) {
        uint32_t start = r->starts[v];
        float *point = r->buffers->points + 4 * (size_t)v,
              *normal = r->buffers->normals + 4 * (size_t)v;
        float *entry = r->buffers->rings + 4 * (size_t)start;
        double total = 0, a[3], b[3], a2[3], b2[3];
        memcpy(point, mesh->positions + 3 * (size_t)v, 3 * sizeof(float));
        memcpy(normal, mesh->normals + 3 * (size_t)v, 3 * sizeof(float));
        point[3] = (float)(start >> 8);
        normal[3] = (float)((start & 255u) * 65536u + (r->starts[v + 1] - start));
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            total += vsf__corner_gradient(mesh, mesh->ring_corners[i], a, b);
        }
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t half = mesh->ring_corners[i], behind = vsf__previous(half);
            uint32_t beyond = mesh->opposites[half];
            double w = vsf__corner_gradient(mesh, half, a, b), w2 = 0;
            if (beyond != VSF_NONE) { /* it runs back to v: v is the corner behind its start */
                w2 = vsf__corner_gradient(mesh, vsf__next(beyond), a2, b2);
            }
            vsf__ring_entry(entry, a, w, b2, w2, total, mesh->triangles[vsf__next(half)]);
            entry += 4;
            if (mesh->opposites[behind] == VSF_NONE) {
                vsf__ring_entry(entry, b, w, b, 0, total, mesh->triangles[behind]);
                entry += 4;
            }
        }
    }
}

static void vsf__buffers_parts(vsf_buffers *b, vsf__block *block) {
    b->points = vsf__part_float(block, 4 * (uint64_t)b->vertex_count);
    b->normals = vsf__part_float(block, 4 * (uint64_t)b->vertex_count);
    b->rings = vsf__part_float(block, 4 * (uint64_t)b->ring_count);
    b->triangles = vsf__part_float(block, 4 * (uint64_t)b->triangle_count);
}

/* What a device cannot take is said before any memory is taken. */
static lao_result vsf__buffers_check(const vsf_host *host, const vsf_mesh *mesh,
                                     uint32_t max_texels, uint32_t *ring_count) {
    const uint32_t most = 1u << 24; /* whole numbers that a float holds */
    uint64_t rings = 0;
    uint32_t v, texels;
    for (v = 0; v < mesh->vertex_count; v++) {
        uint32_t n = vsf__neighbour_count(mesh, v);
        if (n > 65535u) {
            return vsf__fail(host, VSF_LOG_MESH_DEVICE,
                             "vertex %u has %u neighbours, 65535 at most", mesh->vertex_sources[v],
                             n);
        }
        rings += n;
    }
    if (mesh->vertex_count > most || rings > 0xffffffffu) {
        return vsf__fail(host, VSF_LOG_MESH_DEVICE, "%u vertices, %u at most", mesh->vertex_count,
                         most);
    }
    texels = rings > mesh->triangle_count ? (uint32_t)rings : mesh->triangle_count;
    if (max_texels && texels > max_texels) {
        return vsf__fail(host, VSF_LOG_MESH_DEVICE,
                         "%u triangles need a buffer of %u texels, the device has %u; about %u "
                         "triangles would fit",
                         mesh->triangle_count, texels, max_texels,
                         (uint32_t)((uint64_t)mesh->triangle_count * max_texels / texels));
    }
    *ring_count = (uint32_t)rings;
    return LAO_OK;
}

VSF_API lao_result vsf_buffers_make(const vsf_host *host, const vsf_mesh *mesh, uint32_t max_texels,
                                    vsf_buffers *buffers) {
    vsf_buffers b;
    vsf__block block = {NULL, 0};
    vsf__progress progress;
    vsf__ringer ringer;
    uint32_t *starts, i;
    lao_result result;
    if (!mesh || !mesh->memory || !buffers) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_buffers_make");
    }
    memset(&b, 0, sizeof b);
    b.allocator = vsf__allocator(host);
    b.vertex_count = mesh->vertex_count;
    b.triangle_count = mesh->triangle_count;
    memcpy(b.bounds, mesh->info.bounds, sizeof b.bounds);
    result = vsf__buffers_check(host, mesh, max_texels, &b.ring_count);
    if (result != LAO_OK) {
        return result;
    }
    vsf__buffers_parts(&b, &block);
    b.memory = vsf__take(&b.allocator, block.used, 1);
    starts = (uint32_t *)vsf__take(&b.allocator, (uint64_t)mesh->vertex_count + 1, sizeof *starts);
    if (!b.memory || !starts) {
        vsf__give(&b.allocator, b.memory);
        vsf__give(&b.allocator, starts);
        return vsf__fail(host, VSF_LOG_MEMORY, "buffers of %u triangles", mesh->triangle_count);
    }
    block.base = (unsigned char *)b.memory;
    block.used = 0;
    vsf__buffers_parts(&b, &block);
    starts[0] = 0;
    for (i = 0; i < mesh->vertex_count; i++) {
        starts[i + 1] = starts[i] + vsf__neighbour_count(mesh, i);
    }
    for (i = 0; i < mesh->triangle_count; i++) {
        float *to = b.triangles + 4 * (size_t)i;
        to[0] = (float)mesh->triangles[3 * (size_t)i];
        to[1] = (float)mesh->triangles[3 * (size_t)i + 1];
        to[2] = (float)mesh->triangles[3 * (size_t)i + 2];
        to[3] = 0.0f;
    }
    ringer.mesh = mesh;
    ringer.buffers = &b;
    ringer.starts = starts;
    progress = vsf__progress_make(host, mesh->vertex_count);
    if (vsf__run(&progress, mesh->vertex_count, VSF__CHUNK, &ringer, vsf__ring_fill)) {
        result = vsf__fail(host, VSF_LOG_CANCELLED, NULL);
    }
    vsf__give(&b.allocator, starts);
    if (result != LAO_OK) {
        vsf_buffers_free(&b);
        return result;
    }
    *buffers = b;
    return LAO_OK;
}

VSF_API void vsf_buffers_free(vsf_buffers *buffers) {
    if (buffers && buffers->memory) {
        vsf__give(&buffers->allocator, buffers->memory);
    }
    if (buffers) {
        memset(buffers, 0, sizeof *buffers);
    }
}

VSF_API void vsf_buffers_describe(const vsf_buffers *buffers, lao_object_buffer list[4],
                                  lao_object_desc *desc) {
    const void *data[4];
    uint32_t counts[4], i;
    data[0] = buffers->points;
    data[1] = buffers->normals;
    data[2] = buffers->rings;
    data[3] = buffers->triangles;
    counts[0] = counts[1] = buffers->vertex_count;
    counts[2] = buffers->ring_count;
    counts[3] = buffers->triangle_count;
    for (i = 0; i < 4; i++) {
        list[i].name = vsf__buffer_rows[i].name;
        list[i].data = data[i];
        list[i].texel_count = counts[i];
    }
    memset(desc, 0, sizeof *desc);
    desc->buffers = list;
    desc->buffer_count = 4;
    desc->triangle_count = buffers->triangle_count;
    desc->item_count = buffers->vertex_count;
    memcpy(desc->bounds, buffers->bounds, sizeof desc->bounds);
}

static lao_v4 vsf__texel(const float *texels, uint32_t i) {
    const float *t = texels + 4 * (size_t)i;
    return lao_v4_make(t[0], t[1], t[2], t[3]);
}
static lao_v3 vsf__xyz(lao_v4 v) {
    return lao_v3_make(v.x, v.y, v.z);
}

typedef struct vsf__measurer {
    const vsf_buffers *buffers;
    lao_v4 eye;
    bool naive;
    const float *values; /* of vsf_gradients; of features: the measure */
    float *out;
} vsf__measurer;

/* What the pass surface_measure does for each texel. */
static void vsf__measure_vertices(void *arg, uint32_t first, uint32_t end) {
    const vsf__measurer *m = (const vsf__measurer *)arg;
    const vsf_buffers *b = m->buffers;
    uint32_t v, i;
    for (v = first; v < end; v++) {
        lao_v4 point = vsf__texel(b->points, v), normal = vsf__texel(b->normals, v);
        lao_uint start = vsf_ring_start(point.w, normal.w), count = vsf_ring_count(normal.w);
        vsf_ring_sum ring = vsf_ring_begin(m->eye, vsf__xyz(point), vsf__xyz(normal), m->naive);
        for (i = 0; i < count; i++) {
            lao_v4 entry = vsf__texel(b->rings, start + i);
            lao_uint other = LAO_U(entry.w);
            float light = vsf_light(m->eye, vsf__xyz(vsf__texel(b->points, other)),
                                    vsf__xyz(vsf__texel(b->normals, other)), m->naive);
            ring = vsf_ring_add(ring, entry, light);
        }
        m->out[v] = vsf_ring_end(ring);
    }
}

static int vsf__eye_bad(const float eye[4]) {
    return !(fabsf(eye[0]) <= 1e15f && fabsf(eye[1]) <= 1e15f && fabsf(eye[2]) <= 1e15f &&
             (eye[3] == 0.0f || eye[3] == 1.0f));
}
static vsf__measurer vsf__measurer_make(const vsf_buffers *buffers, const float eye[4],
                                        uint32_t flags, float *out) {
    vsf__measurer m;
    m.buffers = buffers;
    m.eye = lao_v4_make(eye[0], eye[1], eye[2], eye[3]);
    m.naive = (flags & VSF_VIEW_NORMALIZED) != 0;
    m.values = NULL;
    m.out = out;
    return m;
}

VSF_API lao_result vsf_measure(const vsf_host *host, const vsf_buffers *buffers, const float eye[4],
                               uint32_t flags, float *measure) {
    vsf__measurer m;
    vsf__progress progress;
    if (!buffers || !buffers->memory || !eye || !measure) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_measure");
    }
    if (vsf__eye_bad(eye)) {
        return vsf__fail(host, VSF_LOG_SETTING, "the eye: finite, its fourth number 0 or 1");
    }
    m = vsf__measurer_make(buffers, eye, flags, measure);
    progress = vsf__progress_make(host, buffers->vertex_count);
    return vsf__run(&progress, buffers->vertex_count, VSF__CHUNK, &m, vsf__measure_vertices)
               ? vsf__fail(host, VSF_LOG_CANCELLED, NULL)
               : LAO_OK;
}

static void vsf__gradient(const vsf_buffers *b, const float *values, uint32_t v, double g[3]) {
    float pw = b->points[4 * (size_t)v + 3], nw = b->normals[4 * (size_t)v + 3];
    uint32_t start = vsf_ring_start(pw, nw), end = start + vsf_ring_count(nw), i;
    int k;
    g[0] = g[1] = g[2] = 0;
    for (i = start; i < end; i++) {
        const float *entry = b->rings + 4 * (size_t)i;
        double rise = (double)values[(uint32_t)entry[3]] - (double)values[v];
        for (k = 0; k < 3; k++) {
            g[k] += (double)entry[k] * rise;
        }
    }
}
static void vsf__gradient_vertices(void *arg, uint32_t first, uint32_t end) {
    const vsf__measurer *m = (const vsf__measurer *)arg;
    uint32_t v;
    int k;
    for (v = first; v < end; v++) {
        double g[3];
        vsf__gradient(m->buffers, m->values, v, g);
        for (k = 0; k < 3; k++) {
            m->out[3 * (size_t)v + (size_t)k] = (float)g[k];
        }
    }
}
VSF_API lao_result vsf_gradients(const vsf_host *host, const vsf_buffers *buffers,
                                 const float *values, float *gradients) {
    const float nowhere[4] = {0, 0, 0, 0};
    vsf__measurer m;
    vsf__progress progress;
    if (!buffers || !buffers->memory || !values || !gradients) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_gradients");
    }
    m = vsf__measurer_make(buffers, nowhere, 0, gradients);
    m.values = values;
    progress = vsf__progress_make(host, buffers->vertex_count);
    return vsf__run(&progress, buffers->vertex_count, VSF__CHUNK, &m, vsf__gradient_vertices)
               ? vsf__fail(host, VSF_LOG_CANCELLED, NULL)
               : LAO_OK;
}

/* ================================================================================================
 * feature lines */

/* Per vertex: the function whose zeros are wanted, and two that must be positive on the way: the
   slope towards the viewer above the threshold, and n.v. */
typedef struct vsf__features {
    const vsf_mesh *mesh;
    const float *zero;
    float *slope, *facing;
    unsigned char *seen; /* per triangle */
    float threshold;
    int suggestive;
    float *points, *values; /* of the lines, NULL: count only */
    uint32_t *offsets;
    uint32_t point_count, line_count;
} vsf__features;

static void vsf__slopes(void *arg, uint32_t first, uint32_t end) {
    const vsf__measurer *m = (const vsf__measurer *)arg;
    uint32_t v;
    for (v = first; v < end; v++) {
        const float *p = m->buffers->points + 4 * (size_t)v;
        const float *normal = m->buffers->normals + 4 * (size_t)v;
        double g[3], w[3], n[3], l;
        int k;
        vsf__load(normal, n);
        for (k = 0; k < 3; k++) {
            const float eye[3] = {m->eye.x, m->eye.y, m->eye.z};
            w[k] = (double)eye[k] - (double)m->eye.w * (double)p[k];
        }
        l = vsf__dot(n, w);
        for (k = 0; k < 3; k++) {
            w[k] -= l * n[k];
        }
        vsf__unit(w);
        vsf__gradient(m->buffers, m->values, v, g);
        m->out[v] = (float)vsf__dot(w, g);
    }
}

/* Where a triangle's segment crosses its half-edges: returns 0 without one; `half[0]` is where it
   comes in, with the positive side to the left. Zero counts as positive. */
static int vsf__crossing(const vsf__features *f, uint32_t t, uint32_t half[2]) {
    int found = 0, k;
    for (k = 0; k < 3; k++) {
        uint32_t h = 3 * t + (uint32_t)k;
        int from = f->zero[f->mesh->triangles[h]] >= 0,
            to = f->zero[f->mesh->triangles[vsf__next(h)]] >= 0;
        if (from != to) {
            half[from ? 0 : 1] = h;
            found = 1;
        }
    }
    return found;
}

/* A place on an edge: its point, and the two functions there. */
typedef struct vsf__place {
    double p[3], slope, facing;
} vsf__place;
static vsf__place vsf__place_on(const vsf__features *f, uint32_t half) {
    uint32_t a = f->mesh->triangles[half], b = f->mesh->triangles[vsf__next(half)];
    vsf__place place;
    double u;
    int k;
    if (a > b) { /* the same bits from both sides */
        uint32_t c = a;
        a = b;
        b = c;
    }
    u = (double)f->zero[a] / ((double)f->zero[a] - (double)f->zero[b]);
    for (k = 0; k < 3; k++) {
        double from = (double)f->mesh->positions[3 * (size_t)a + (size_t)k];
        double to = (double)f->mesh->positions[3 * (size_t)b + (size_t)k];
        place.p[k] = from + u * (to - from);
    }
    place.slope =
        f->suggestive ? (double)f->slope[a] + u * ((double)f->slope[b] - (double)f->slope[a]) : 0;
    place.facing = f->suggestive
                       ? (double)f->facing[a] + u * ((double)f->facing[b] - (double)f->facing[a])
                       : 1;
    return place;
}
static void vsf__feature_point(vsf__features *f, const vsf__place *a, const vsf__place *b,
                               double u) {
    int k;
    if (f->points) {
        for (k = 0; k < 3; k++) {
            f->points[3 * (size_t)f->point_count + (size_t)k] =
                (float)(a->p[k] + u * (b->p[k] - a->p[k]));
        }
        f->values[f->point_count] = (float)(a->slope + u * (b->slope - a->slope));
    }
    f->point_count++;
}
static void vsf__feature_end(vsf__features *f, uint32_t *first) {
    if (f->point_count > *first + 1) {
        f->line_count++;
    } else {
        f->point_count = *first; /* a single point is no line */
    }
    if (f->offsets) {
        f->offsets[f->line_count] = f->point_count;
    }
    *first = f->point_count;
}
/* The part of a -> b on which a linear function from g to h is positive, cut from [from, to]. */
static void vsf__keep_positive(double g, double h, double *from, double *to) {
    if (!(g > 0) && !(h > 0)) {
        *to = *from;
    } else if (!(g > 0)) {
        double u = g / (g - h);
        *from = u > *from ? u : *from;
    } else if (!(h > 0)) {
        double u = g / (g - h);
        *to = u < *to ? u : *to;
    }
}
/* Appends the wanted part of a segment to the open line that began at point `first`. */
static void vsf__feature_segment(vsf__features *f, const vsf__place *a, const vsf__place *b,
                                 uint32_t *first) {
    double from = 0, to = 1;
    if (f->suggestive) {
        vsf__keep_positive(a->slope - (double)f->threshold, b->slope - (double)f->threshold, &from,
                           &to);
        vsf__keep_positive(a->facing, b->facing, &from, &to);
    }
    if (!(from < to)) {
        vsf__feature_end(f, first);
        return;
    }
    if (from > 0 || f->point_count == *first) {
        vsf__feature_end(f, first);
        vsf__feature_point(f, a, b, from);
    }
    vsf__feature_point(f, a, b, to);
    if (to < 1) {
        vsf__feature_end(f, first);
    }
}

/* Follows the zero set through triangle t back to where it begins, then from there to its end. */
static void vsf__feature_trace(vsf__features *f, uint32_t t) {
    const uint32_t *opposites = f->mesh->opposites;
    uint32_t half[2] = {0, 0}, start = t, first = f->point_count, from;
    vsf__place a, b;
    for (;;) {
        vsf__crossing(f, start, half);
        from = opposites[half[0]];
        if (from == VSF_NONE || from / 3 == t) {
            break;
        }
        start = from / 3;
    }
    from = half[0];
    a = vsf__place_on(f, from);
    for (t = start; !f->seen[t]; t = opposites[half[1]] / 3) {
        f->seen[t] = 1;
        vsf__crossing(f, t, half);
        b = vsf__place_on(f, half[1]);
        vsf__feature_segment(f, &a, &b, &first);
        a = b;
        if (opposites[half[1]] == VSF_NONE) {
            break;
        }
    }
    vsf__feature_end(f, &first);
}

static void vsf__feature_all(vsf__features *f) {
    uint32_t t, half[2];
    f->point_count = f->line_count = 0;
    memset(f->seen, 0, f->mesh->triangle_count);
    for (t = 0; t < f->mesh->triangle_count; t++) {
        if (!f->seen[t] && vsf__crossing(f, t, half)) {
            vsf__feature_trace(f, t);
        }
    }
}

static lao_result vsf__features_out(const vsf_host *host, vsf__features *f, vsf_polylines *lines) {
    vsf_polylines out;
    vsf__block block = {NULL, 0};
    int round;
    memset(&out, 0, sizeof out);
    out.allocator = vsf__allocator(host);
    vsf__feature_all(f);
    out.line_count = f->line_count;
    out.point_count = f->point_count;
    for (round = 0; round < 2; round++) {
        out.offsets = vsf__part_u32(&block, (uint64_t)f->line_count + 1);
        /* room for the single points that are taken back */
        out.points = vsf__part_float(&block, 3 * ((uint64_t)f->point_count + 2));
        out.values = vsf__part_float(&block, (uint64_t)f->point_count + 2);
        if (round == 0) {
            out.memory = vsf__take(&out.allocator, block.used, 1);
            if (!out.memory) {
                return vsf__fail(host, VSF_LOG_MEMORY, "%u points of lines", f->point_count);
            }
            block.base = (unsigned char *)out.memory;
            block.used = 0;
        }
    }
    f->offsets = out.offsets;
    f->points = out.points;
    f->values = out.values;
    out.offsets[0] = 0;
    vsf__feature_all(f);
    *lines = out;
    return LAO_OK;
}

VSF_API lao_result vsf_feature_lines(const vsf_host *host, const vsf_mesh *mesh,
                                     const vsf_buffers *buffers, const float eye[4],
                                     vsf_feature feature, float threshold, vsf_polylines *lines) {
    lao_allocator allocator = vsf__allocator(host);
    vsf__features f;
    vsf__progress progress;
    vsf__measurer m;
    float *values;
    size_t n;
    uint32_t v;
    lao_result result;
    if (!mesh || !mesh->memory || !buffers || !buffers->memory || !eye || !lines) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_feature_lines");
    }
    if (vsf__eye_bad(eye) || !(threshold >= 0 && threshold <= 3e38f) ||
        buffers->vertex_count != mesh->vertex_count) {
        return vsf__fail(host, VSF_LOG_SETTING,
                         "the eye, the threshold, or buffers of another mesh");
    }
    memset(&f, 0, sizeof f);
    n = mesh->vertex_count;
    values = (float *)vsf__take(&allocator, 3 * (uint64_t)n, sizeof(float));
    f.seen = (unsigned char *)vsf__take(&allocator, mesh->triangle_count, 1);
    if (!values || !f.seen) {
        vsf__give(&allocator, values);
        vsf__give(&allocator, f.seen);
        return vsf__fail(host, VSF_LOG_MEMORY, "feature lines");
    }
    f.mesh = mesh;
    f.slope = values + n;
    f.facing = values + 2 * n;
    f.threshold = threshold;
    f.suggestive = feature == VSF_SUGGESTIVE_CONTOURS;
    m = vsf__measurer_make(buffers, eye, 0, values);
    progress = vsf__progress_make(host, 2 * (uint64_t)n);
    for (v = 0; v < mesh->vertex_count; v++) {
        f.facing[v] = vsf_light(m.eye, vsf__xyz(vsf__texel(buffers->points, v)),
                                vsf__xyz(vsf__texel(buffers->normals, v)), false);
    }
    f.zero = f.suggestive ? values : f.facing;
    result = f.suggestive &&
                     vsf__run(&progress, mesh->vertex_count, VSF__CHUNK, &m, vsf__measure_vertices)
                 ? LAO_ERROR_NOT_READY
                 : LAO_OK;
    m.values = values;
    m.out = f.slope;
    if (result == LAO_OK && f.suggestive &&
        vsf__run(&progress, mesh->vertex_count, VSF__CHUNK, &m, vsf__slopes)) {
        result = LAO_ERROR_NOT_READY;
    }
    result = result == LAO_OK ? vsf__features_out(host, &f, lines)
                              : vsf__fail(host, VSF_LOG_CANCELLED, NULL);
    vsf__give(&allocator, values);
    vsf__give(&allocator, f.seen);
    return result;
}

VSF_API void vsf_polylines_free(vsf_polylines *lines) {
    if (lines && lines->memory) {
        vsf__give(&lines->allocator, lines->memory);
    }
    if (lines) {
        memset(lines, 0, sizeof *lines);
    }
}

/* ================================================================================================
 * distance to what is lit */

VSF_API double vsf_segment_distance2(const float p[3], const float a[3], const float b[3],
                                     double from, double to) {
    double q[3], d[3], r[3], dd, u;
    int k;
    for (k = 0; k < 3; k++) {
        q[k] = (double)p[k] - (double)a[k];
        d[k] = (double)b[k] - (double)a[k];
    }
    dd = vsf__dot(d, d);
    u = dd > 0 ? vsf__dot(q, d) / dd : 0;
    u = u < to ? u : to;
    u = u > from ? u : from;
    for (k = 0; k < 3; k++) {
        r[k] = q[k] - u * d[k];
    }
    return vsf__dot(r, r);
}

/* A segment (or a point, twice) of a pathline with its times. */
typedef struct vsf__track {
    float a[3], b[3];
    float ta, tb;
} vsf__track;
/* The lit part of a track. */
typedef struct vsf__piece {
    float a[3], b[3];
    double from, to;
} vsf__piece;
typedef struct vsf__box {
    float low[3], high[3];
} vsf__box;

/* All that a table needs to compute distances: tracks and vertices, each along a Morton curve. */
typedef struct vsf__index {
    uint32_t vertex_count, track_count;
    float *positions;   /* 3 per vertex, in order */
    uint32_t *vertices; /* per place in order: the vertex */
    vsf__track *tracks; /* in order */
    double period;      /* ms; 0: none */
    double extent2;     /* mm^2: squared diagonal of everything */
    void *memory;
} vsf__index;

/* What is lit at one time: pieces in order, and above them boxes of 4 pieces, of 4 boxes, ... */
enum { VSF__WIDTH = 4, VSF__LEVELS = 17 };
typedef struct vsf__lit {
    vsf__piece *pieces;
    vsf__box *boxes;
    uint32_t piece_count, level_count;
    uint32_t first[VSF__LEVELS], count[VSF__LEVELS]; /* boxes of a level; 0 is the finest */
    void *memory;
} vsf__lit;

static int vsf__finite3(const float *p) {
    return fabsf(p[0]) <= 1e9f && fabsf(p[1]) <= 1e9f && fabsf(p[2]) <= 1e9f;
}

/* ---- order along a Morton curve */

static uint32_t vsf__spread_bits(uint32_t v) { /* 10 bits, two zeros between them */
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
}
static uint32_t vsf__morton(const float *p, const double low[3], double scale) {
    uint32_t code = 0;
    int k;
    for (k = 0; k < 3; k++) {
        double x = ((double)p[k] - low[k]) * scale;
        uint32_t cell = x > 0 ? x < 1023 ? (uint32_t)x : 1023u : 0u; /* no number: 0 */
        code |= vsf__spread_bits(cell) << k;
    }
    return code;
}
/* Stable sort of items by 30-bit codes; `work` holds as many items again. */
typedef struct vsf__coded {
    uint32_t code, item;
} vsf__coded;
static void vsf__sort_codes(vsf__coded *items, vsf__coded *work, uint32_t count) {
    uint32_t starts[1024], shift, i;
    for (shift = 0; shift < 30; shift += 10) {
        uint32_t sum = 0;
        vsf__coded *swap = items;
        memset(starts, 0, sizeof starts);
        for (i = 0; i < count; i++) {
            starts[(items[i].code >> shift) & 1023u]++;
        }
        for (i = 0; i < 1024; i++) {
            uint32_t n = starts[i];
            starts[i] = sum;
            sum += n;
        }
        for (i = 0; i < count; i++) {
            work[starts[(items[i].code >> shift) & 1023u]++] = items[i];
        }
        items = work;
        work = swap;
    }
    memcpy(work, items, (size_t)count * sizeof *items); /* three rounds end in the other array */
}

/* ---- building the index */

static uint32_t vsf__line_range(const vsf_near_desc *desc, uint32_t line, uint32_t *end) {
    *end = desc->offsets ? desc->offsets[line + 1] : desc->point_count;
    return desc->offsets ? desc->offsets[line] : 0;
}
static int vsf__point_ok(const vsf_near_desc *desc, uint32_t i) {
    return vsf__finite3(desc->points + 3 * (size_t)i) && fabsf(desc->times[i]) <= 1e15f;
}
static void vsf__track_make(vsf__track *track, const vsf_near_desc *desc, uint32_t i, uint32_t j) {
    memcpy(track->a, desc->points + 3 * (size_t)i, sizeof track->a);
    memcpy(track->b, desc->points + 3 * (size_t)j, sizeof track->b);
    track->ta = desc->times[i];
    track->tb = desc->times[j];
}
/* Segments between neighbours on a line; points where they are wanted or stand alone. Returns how
   many; `tracks` may be NULL. */
static uint32_t vsf__tracks(const vsf_near_desc *desc, vsf__track *tracks) {
    uint32_t lines = desc->offsets ? desc->line_count : desc->point_count != 0, line, i, count = 0;
    for (line = 0; line < lines; line++) {
        uint32_t end, begin = vsf__line_range(desc, line, &end);
        for (i = begin; i < end; i++) {
            int here = vsf__point_ok(desc, i), before = i > begin && vsf__point_ok(desc, i - 1);
            int after = i + 1 < end && vsf__point_ok(desc, i + 1);
            int alone = here && ((desc->flags & VSF_NEAR_POINTS) || (!before && !after));
            if (alone || (here && before)) {
                if (tracks) {
                    vsf__track_make(tracks + count, desc, alone ? i : i - 1, i);
                }
                count++;
            }
        }
    }
    return count;
}

static void vsf__grow(double low[3], double high[3], const float *p) {
    int k;
    for (k = 0; k < 3 && vsf__finite3(p); k++) {
        double x = (double)p[k];
        low[k] = x < low[k] ? x : low[k];
        high[k] = x > high[k] ? x : high[k];
    }
}
static double vsf__span(const double low[3], const double high[3]) {
    double span = 0;
    int k;
    for (k = 0; k < 3; k++) {
        span = high[k] - low[k] > span ? high[k] - low[k] : span;
    }
    return span;
}

static void vsf__order_vertices(vsf__index *x, const float *positions, vsf__coded *codes,
                                const double low[3], double scale) {
    uint32_t i;
    for (i = 0; i < x->vertex_count; i++) {
        codes[i].code = vsf__morton(positions + 3 * (size_t)i, low, scale);
        codes[i].item = i;
    }
    vsf__sort_codes(codes, codes + x->vertex_count, x->vertex_count);
    for (i = 0; i < x->vertex_count; i++) {
        x->vertices[i] = codes[i].item;
        memcpy(x->positions + 3 * (size_t)i, positions + 3 * (size_t)codes[i].item,
               3 * sizeof(float));
    }
}
static void vsf__order_tracks(vsf__index *x, const vsf__track *tracks, vsf__coded *codes,
                              const double low[3], double scale) {
    uint32_t i;
    int k;
    for (i = 0; i < x->track_count; i++) {
        float middle[3];
        for (k = 0; k < 3; k++) {
            middle[k] = 0.5f * tracks[i].a[k] + 0.5f * tracks[i].b[k];
        }
        codes[i].code = vsf__morton(middle, low, scale);
        codes[i].item = i;
    }
    vsf__sort_codes(codes, codes + x->track_count, x->track_count);
    for (i = 0; i < x->track_count; i++) {
        x->tracks[i] = tracks[codes[i].item];
    }
}

static void vsf__index_parts(vsf__index *x, vsf__block *block) {
    x->positions = vsf__part_float(block, 3 * (uint64_t)x->vertex_count);
    x->vertices = vsf__part_u32(block, x->vertex_count);
    x->tracks = (vsf__track *)vsf__part(block, x->track_count, sizeof(vsf__track));
}
static void vsf__index_free(const lao_allocator *allocator, vsf__index *x) {
    if (x) {
        vsf__give(allocator, x->memory);
        vsf__give(allocator, x);
    }
}
static void vsf__index_fill(vsf__index *x, const vsf_near_desc *desc, vsf__track *tracks,
                            vsf__coded *codes) {
    double low[3] = {1e30, 1e30, 1e30}, high[3] = {-1e30, -1e30, -1e30}, span, scale;
    uint32_t i;
    int k;
    vsf__tracks(desc, tracks);
    for (i = 0; i < x->track_count; i++) {
        vsf__grow(low, high, tracks[i].a);
        vsf__grow(low, high, tracks[i].b);
    }
    for (i = 0; i < x->vertex_count; i++) {
        vsf__grow(low, high, desc->positions + 3 * (size_t)i);
    }
    for (k = 0; k < 3; k++) {
        x->extent2 += high[k] > low[k] ? (high[k] - low[k]) * (high[k] - low[k]) : 0;
    }
    span = vsf__span(low, high);
    scale = span > 0 ? 1023.999 / span : 0;
    vsf__order_vertices(x, desc->positions, codes, low, scale);
    vsf__order_tracks(x, tracks, codes, low, scale);
}
static vsf__index *vsf__index_make(const lao_allocator *allocator, const vsf_near_desc *desc) {
    vsf__index *x = (vsf__index *)vsf__take(allocator, 1, sizeof *x);
    vsf__block block = {NULL, 0};
    vsf__track *tracks;
    vsf__coded *codes;
    uint64_t most;
    if (!x) {
        return NULL;
    }
    memset(x, 0, sizeof *x);
    x->vertex_count = desc->vertex_count;
    x->track_count = vsf__tracks(desc, NULL);
    x->period = desc->period;
    vsf__index_parts(x, &block);
    x->memory = vsf__take(allocator, block.used, 1);
    most = x->vertex_count > x->track_count ? x->vertex_count : x->track_count;
    tracks = (vsf__track *)vsf__take(allocator, x->track_count, sizeof *tracks);
    codes = (vsf__coded *)vsf__take(allocator, 2 * most, sizeof *codes);
    if (x->memory && tracks && codes) {
        block.base = (unsigned char *)x->memory;
        block.used = 0;
        vsf__index_parts(x, &block);
        vsf__index_fill(x, desc, tracks, codes);
    } else {
        vsf__index_free(allocator, x);
        x = NULL;
    }
    vsf__give(allocator, tracks);
    vsf__give(allocator, codes);
    return x;
}

/* ---- what is lit at a time */

/* Appends the part of a track with times in (low, high); `pieces` may be NULL. */
static uint32_t vsf__light_window(const vsf__track *t, double low, double high,
                                  vsf__piece *pieces) {
    double ta = (double)t->ta, tb = (double)t->tb, from = 0, to = 1;
    if (ta == tb) {
        if (!(ta > low && ta < high)) {
            return 0;
        }
    } else {
        double u = (low - ta) / (tb - ta), v = (high - ta) / (tb - ta);
        double first = u < v ? u : v, last = u < v ? v : u;
        from = first > 0 ? first : 0;
        to = last < 1 ? last : 1;
        if (!(from < to)) {
            return 0;
        }
    }
    if (pieces) {
        memcpy(pieces->a, t->a, sizeof t->a);
        memcpy(pieces->b, t->b, sizeof t->b);
        pieces->from = from;
        pieces->to = to;
    }
    return 1;
}
static uint32_t vsf__light_track(const vsf__track *t, double time, double reach, double period,
                                 vsf__piece *pieces) {
    double least = (double)(t->ta < t->tb ? t->ta : t->tb),
           most = (double)(t->ta < t->tb ? t->tb : t->ta);
    double turn;
    uint32_t count = 0;
    int turns, i;
    if (!(period > 0)) {
        return most <= time - reach || least >= time + reach
                   ? 0
                   : vsf__light_window(t, time - reach, time + reach, pieces);
    }
    if (2 * reach >= period || most - least > 4 * period) { /* all of it, or all but slivers */
        return vsf__light_window(t, -1e30, 1e30, pieces);
    }
    turn = ceil((least - time - reach) / period);
    turns = (int)(floor((most - time + reach) / period) - turn); /* 5 at most */
    for (i = 0; i <= turns; i++) {
        double now = time + (turn + i) * period;
        count += vsf__light_window(t, now - reach, now + reach, pieces ? pieces + count : NULL);
    }
    return count;
}

static void vsf__box_grow(vsf__box *box, const vsf__box *other) {
    int k;
    for (k = 0; k < 3; k++) {
        box->low[k] = other->low[k] < box->low[k] ? other->low[k] : box->low[k];
        box->high[k] = other->high[k] > box->high[k] ? other->high[k] : box->high[k];
    }
}
/* The lit part in single precision, rounded outward. */
static vsf__box vsf__piece_box(const vsf__piece *piece) {
    vsf__box box;
    int k;
    for (k = 0; k < 3; k++) {
        double a = (double)piece->a[k], d = (double)piece->b[k] - a;
        double x = a + piece->from * d, y = a + piece->to * d, low = x < y ? x : y,
               high = x < y ? y : x;
        double slack = 1.2e-7 * (fabs(low) + fabs(high)) + 1e-30;
        box.low[k] = (float)(low - slack);
        box.high[k] = (float)(high + slack);
    }
    return box;
}
static void vsf__lit_boxes(vsf__lit *lit) {
    uint32_t level, i, below = lit->piece_count;
    for (level = 0; level < lit->level_count; level++) {
        vsf__box *boxes = lit->boxes + lit->first[level];
        const vsf__box *children = level ? lit->boxes + lit->first[level - 1] : NULL;
        for (i = 0; i < below; i++) {
            vsf__box box = level ? children[i] : vsf__piece_box(lit->pieces + i);
            if (i % VSF__WIDTH == 0) {
                boxes[i / VSF__WIDTH] = box;
            } else {
                vsf__box_grow(boxes + i / VSF__WIDTH, &box);
            }
        }
        below = lit->count[level];
    }
}
/* Pieces lit at a time and the boxes above them. Returns 0, or -1 without memory. */
static int vsf__lit_make(const lao_allocator *allocator, const vsf__index *x, double time,
                         double reach, vsf__lit *lit) {
    vsf__block block = {NULL, 0};
    uint64_t pieces = 0, boxes = 0, below;
    uint32_t i;
    memset(lit, 0, sizeof *lit);
    for (i = 0; i < x->track_count; i++) {
        pieces += vsf__light_track(x->tracks + i, time, reach, x->period, NULL);
    }
    if (pieces > 0xfffffff0u) {
        return -1;
    }
    lit->piece_count = (uint32_t)pieces;
    for (below = pieces; pieces && (lit->level_count == 0 || below > 1);
         below = lit->count[lit->level_count++]) {
        lit->first[lit->level_count] = (uint32_t)boxes;
        lit->count[lit->level_count] = (uint32_t)((below + VSF__WIDTH - 1) / VSF__WIDTH);
        boxes += lit->count[lit->level_count];
    }
    for (i = 0; i < 2; i++) {
        lit->pieces = (vsf__piece *)vsf__part(&block, pieces, sizeof(vsf__piece));
        lit->boxes = (vsf__box *)vsf__part(&block, boxes, sizeof(vsf__box));
        if (i == 0) {
            lit->memory = vsf__take(allocator, block.used, 1);
            if (!lit->memory) {
                return -1;
            }
            block.base = (unsigned char *)lit->memory;
            block.used = 0;
        }
    }
    pieces = 0;
    for (i = 0; i < x->track_count; i++) {
        pieces += vsf__light_track(x->tracks + i, time, reach, x->period, lit->pieces + pieces);
    }
    vsf__lit_boxes(lit);
    return 0;
}

/* ---- one vertex */

static float vsf__box_distance2(const vsf__box *box, const float p[3]) {
    float sum = 0;
    int k;
    for (k = 0; k < 3; k++) {
        float below = box->low[k] - p[k], above = p[k] - box->high[k];
        float d = below > above ? below : above;
        sum += d > 0 ? d * d : 0;
    }
    return sum;
}
typedef struct vsf__visit {
    uint32_t level, box;
    float distance2;
} vsf__visit;

/* A squared distance and what boxes must stay below to hold anything nearer: the slack covers the
   rounding of both, so that no order of visits changes the result. */
typedef struct vsf__best {
    double distance2;
    float limit;
    double slack;
} vsf__best;
static void vsf__best_limit(vsf__best *best, double distance2) {
    double limit = distance2 * (1 + 4e-6) + best->slack;
    float f = limit < 3e38 ? (float)limit : 3e38f;
    f = f + f * 1.2e-7f;
    best->limit = f < best->limit ? f : best->limit;
}
static void vsf__try_pieces(const vsf__lit *lit, uint32_t first, const float p[3],
                            vsf__best *best) {
    uint32_t end = first + VSF__WIDTH < lit->piece_count ? first + VSF__WIDTH : lit->piece_count, i;
    for (i = first; i < end; i++) {
        const vsf__piece *piece = lit->pieces + i;
        double d2 = vsf_segment_distance2(p, piece->a, piece->b, piece->from, piece->to);
        if (d2 < best->distance2) {
            best->distance2 = d2;
            vsf__best_limit(best, d2);
        }
    }
}
/* Puts the children of a box on the stack, the nearest on top. */
static uint32_t vsf__push_children(const vsf__lit *lit, vsf__visit from, const float p[3],
                                   float limit, vsf__visit *stack, uint32_t top) {
    uint32_t level = from.level - 1, base = top, i, j;
    uint32_t first = from.box * VSF__WIDTH, end = first + VSF__WIDTH;
    end = end < lit->count[level] ? end : lit->count[level];
    for (i = first; i < end; i++) {
        vsf__visit visit;
        visit.level = level;
        visit.box = i;
        visit.distance2 = vsf__box_distance2(lit->boxes + lit->first[level] + i, p);
        if (visit.distance2 > limit) {
            continue;
        }
        for (j = top++; j > base && stack[j - 1].distance2 < visit.distance2; j--) {
            stack[j] = stack[j - 1];
        }
        stack[j] = visit;
    }
    return top;
}
static double vsf__search(const vsf__lit *lit, const float p[3], double bound2, double slack) {
    vsf__visit stack[VSF__LEVELS * VSF__WIDTH];
    vsf__best best;
    uint32_t top = 1;
    best.distance2 = 1e300;
    best.slack = slack;
    best.limit = 3e38f;
    vsf__best_limit(&best, bound2);
    stack[0].level = lit->level_count - 1;
    stack[0].box = 0;
    stack[0].distance2 = 0;
    while (top > 0) {
        vsf__visit visit = stack[--top];
        if (visit.distance2 > best.limit) {
            continue;
        }
        if (visit.level == 0) {
            vsf__try_pieces(lit, visit.box * VSF__WIDTH, p, &best);
        } else {
            top = vsf__push_children(lit, visit, p, best.limit, stack, top);
        }
    }
    return best.distance2;
}
static double vsf__search_all(const vsf__lit *lit, const float p[3]) {
    double best = 1e300;
    uint32_t i;
    for (i = 0; i < lit->piece_count; i++) {
        const vsf__piece *piece = lit->pieces + i;
        double d2 = vsf_segment_distance2(p, piece->a, piece->b, piece->from, piece->to);
        best = d2 < best ? d2 : best;
    }
    return best;
}

/* ---- all vertices at one time */

static float vsf__from_half(uint32_t h) { /* 0 or more, or infinity */
    uint32_t exponent = h >> 10, fraction = h & 1023u;
    if (exponent == 31) {
        return VSF_FAR;
    }
    if (exponent == 0) {
        return (float)fraction * 5.96046448e-8f;
    }
    return lao_bits_float(((exponent + 112u) << 23) | (fraction << 13));
}
static uint32_t vsf__to_half(float f) { /* to nearest, ties to even; f is 0 or more */
    uint32_t bits = lao_float_bits(f);
    if (f >= VSF_FAR) {
        return 0x7c00u;
    }
    if (f >= 65504.0f) {
        return 0x7bffu;
    }
    if (f < 6.10351562e-5f) {
        return (uint32_t)(f * 16777216.0f + 0.5f); /* below the normal range: to nearest */
    }
    bits -= 112u << 23;
    return (bits + 0xfffu + ((bits >> 13) & 1u)) >> 13;
}
static float vsf__stored(const void *values, uint32_t bytes, uint64_t i) {
    return bytes == 2 ? vsf__from_half(((const uint16_t *)values)[i]) : ((const float *)values)[i];
}

typedef struct vsf__query {
    const vsf__index *index;
    vsf__lit lit;
    const vsf_near *old; /* distances that bound the new ones; NULL: none */
    uint64_t old_first;  /* of the step, in old->values */
    void *out;           /* vertex_count values of the step */
    uint32_t bytes, brute;
} vsf__query;

static void vsf__store(const vsf__query *q, uint32_t vertex, float distance) {
    if (q->bytes == 2) {
        ((uint16_t *)q->out)[vertex] = (uint16_t)vsf__to_half(distance);
    } else {
        ((float *)q->out)[vertex] = distance;
    }
}
static void vsf__query_vertices(void *arg, uint32_t first, uint32_t end) {
    const vsf__query *q = (const vsf__query *)arg;
    const vsf__index *x = q->index;
    const double slack = 1e-14 * x->extent2, room = 1e-9 * sqrt(x->extent2);
    double last = -1; /* distance of the vertex before, none yet */
    uint32_t i;
    for (i = first; i < end; i++) {
        const float *p = x->positions + 3 * (size_t)i;
        uint32_t vertex = x->vertices[i];
        double bound = 1e18, d2;
        if (!vsf__finite3(p) || q->lit.piece_count == 0) {
            vsf__store(q, vertex, VSF_FAR);
            last = -1;
            continue;
        }
        if (last >= 0) { /* a distance does not change faster than the place */
            double step[3], a[3], b[3];
            vsf__load(p, a);
            vsf__load(p - 3, b);
            vsf__sub(a, b, step);
            bound = (last + sqrt(vsf__dot(step, step))) * (1 + 1e-6) + room;
        }
        if (q->old) {
            double was = (double)vsf__stored(q->old->values, q->old->bytes, q->old_first + vertex);
            was = was * (q->bytes == 2 ? 1.001 : 1.000001) + room + (q->bytes == 2 ? 1e-7 : 0);
            bound = was < bound && was < 65504 ? was : bound;
        }
        d2 = q->brute ? vsf__search_all(&q->lit, p) : vsf__search(&q->lit, p, bound * bound, slack);
        last = sqrt(d2);
        vsf__store(q, vertex, (float)last);
    }
}

/* ---- the table */

/* Value of a rank among the finite ones: two rounds of counting by 16 bits each. */
static float vsf__rank(const vsf_near *n, uint64_t values, uint64_t rank, uint64_t *counts) {
    uint32_t high = 0, i;
    uint64_t k;
    memset(counts, 0, 65536 * sizeof *counts);
    for (k = 0; k < values; k++) {
        float f = vsf__stored(n->values, n->bytes, k);
        if (f < VSF_FAR) {
            counts[lao_float_bits(f) >> 16]++;
        }
    }
    while (rank >= counts[high]) {
        rank -= counts[high++];
    }
    memset(counts, 0, 65536 * sizeof *counts);
    for (k = 0; k < values; k++) {
        uint32_t bits = lao_float_bits(vsf__stored(n->values, n->bytes, k));
        if (bits >> 16 == high) {
            counts[bits & 65535u]++;
        }
    }
    for (i = 0; rank >= counts[i]; i++) {
        rank -= counts[i];
    }
    return lao_bits_float((high << 16) | i);
}
/* 1 % quantile, type 7, of all finite values; 0 without any. */
static float vsf__gamma(const vsf_near *n, uint64_t *counts) {
    uint64_t values = (uint64_t)n->vertex_count * n->step_count, finite = 0, k;
    double place, low, high, gamma;
    for (k = 0; k < values; k++) {
        finite += vsf__stored(n->values, n->bytes, k) < VSF_FAR;
    }
    if (finite == 0) {
        return 0;
    }
    place = 0.01 * (double)(finite - 1);
    k = (uint64_t)place;
    low = (double)vsf__rank(n, values, k, counts);
    high = k + 1 < finite ? (double)vsf__rank(n, values, k + 1, counts) : low;
    gamma = low + (place - (double)k) * (high - low);
    return gamma > 1e-6 ? (float)gamma : 1e-6f;
}

static double vsf__step_time(const vsf_near *n, uint32_t step) {
    return n->step_count > 1 ? n->duration * step / (n->step_count - 1) : 0;
}
/* All vertices at a time into `out`. */
static lao_result vsf__near_time(vsf__progress *progress, const vsf_near *n, double time,
                                 vsf__query *query, uint64_t *lit_count) {
    const vsf__index *x = (const vsf__index *)n->index;
    lao_allocator allocator = vsf__allocator(progress->host);
    int cancelled;
    if (vsf__lit_make(&allocator, x, time, n->reach, &query->lit)) {
        return vsf__fail(progress->host, VSF_LOG_MEMORY, "lit parts at %g ms", time);
    }
    query->index = x;
    query->bytes = n->bytes;
    query->brute = (n->flags & VSF_NEAR_BRUTE) != 0;
    cancelled = vsf__run(progress, x->vertex_count, 512, query, vsf__query_vertices);
    *lit_count += query->lit.piece_count;
    vsf__give(&allocator, query->lit.memory);
    query->lit.memory = NULL;
    return cancelled ? vsf__fail(progress->host, VSF_LOG_CANCELLED, NULL) : LAO_OK;
}
/* Fills n->values, which are new; `old` bounds them where its reach is less. */
static lao_result vsf__near_fill(const vsf_host *host, vsf_near *n, const vsf_near *old) {
    uint64_t v = n->vertex_count, values = v * n->step_count;
    vsf__progress progress = vsf__progress_make(host, values);
    uint64_t *counts;
    uint32_t step;
    lao_result result = LAO_OK;
    n->values = vsf__take(&n->allocator, values, n->bytes);
    counts = (uint64_t *)vsf__take(&n->allocator, 65536, sizeof *counts);
    if (!n->values || !counts) {
        vsf__give(&n->allocator, n->values);
        vsf__give(&n->allocator, counts);
        n->values = NULL;
        return vsf__fail(host, VSF_LOG_MEMORY, "%u vertices at %u times", n->vertex_count,
                         n->step_count);
    }
    n->lit = 0;
    for (step = 0; step < n->step_count && result == LAO_OK; step++) {
        vsf__query query;
        memset(&query, 0, sizeof query);
        query.out = (unsigned char *)n->values + v * step * n->bytes;
        query.old = old && old->reach <= n->reach ? old : NULL;
        query.old_first = v * step;
        result = vsf__near_time(&progress, n, vsf__step_time(n, step), &query, &n->lit);
        progress.done = v * (step + 1);
    }
    if (result == LAO_OK) {
        n->gamma = vsf__gamma(n, counts);
    } else {
        vsf__give(&n->allocator, n->values);
        n->values = NULL;
    }
    vsf__give(&n->allocator, counts);
    return result;
}

static void vsf__near_beta(vsf_near *n, double beta) {
    n->beta = beta;
    n->sigma = sqrt(0.5 * beta);
    n->reach = sqrt(beta * 1.3862943611198906);
}

static lao_result vsf__near_check(const vsf_host *host, const vsf_near_desc *desc) {
    uint32_t i;
    if ((desc->vertex_count && !desc->positions) ||
        (desc->point_count && (!desc->points || !desc->times))) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "arrays of vsf_near_desc");
    }
    if (desc->vertex_count > 1u << 30 || desc->point_count > 1u << 30 ||
        (uint64_t)desc->vertex_count * (desc->step_count ? desc->step_count : 100) > (uint64_t)1
                                                                                         << 40) {
        return vsf__fail(host, VSF_LOG_NEAR_COUNT, "%u vertices at %u times, %u points",
                         desc->vertex_count, desc->step_count, desc->point_count);
    }
    if (!(desc->beta >= 0 && desc->beta <= 1e15) || !(desc->period >= 0 && desc->period <= 1e15)) {
        return vsf__fail(host, VSF_LOG_SETTING, "beta and period are 0 to 1e15, not %g and %g",
                         desc->beta, desc->period);
    }
    for (i = 0; desc->offsets && i < desc->line_count; i++) {
        if (desc->offsets[0] != 0 || desc->offsets[i] > desc->offsets[i + 1]) {
            return vsf__fail(host, VSF_LOG_LINES_OFFSETS, "line %u", i);
        }
    }
    if (desc->offsets && desc->line_count && desc->offsets[desc->line_count] != desc->point_count) {
        return vsf__fail(host, VSF_LOG_LINES_OFFSETS, "%u of %u points",
                         desc->offsets[desc->line_count], desc->point_count);
    }
    return LAO_OK;
}

/* Bits of a float as a number that sorts like it. */
static uint32_t vsf__sortable(float f) {
    uint32_t bits = lao_float_bits(f);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}
/* k-th of `count` numbers that sort like floats, by halving: 32 rounds. */
static double vsf__kth(const uint32_t *values, uint32_t count, uint32_t k) {
    uint32_t low = 0, high = 0xffffffffu, i;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2, below = 0;
        for (i = 0; i < count; i++) {
            below += values[i] <= middle;
        }
        if (below > k) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return (double)lao_bits_float(low & 0x80000000u ? low & 0x7fffffffu : ~low);
}
/* Median of the lines' last times, and their greatest; 0 and 0 without any. Returns 0, or -1
   without memory. */
static int vsf__median_time(const lao_allocator *allocator, const vsf_near_desc *desc,
                            double *median, double *last) {
    uint32_t lines = desc->offsets ? desc->line_count : desc->point_count != 0, i, line, count = 0;
    uint32_t *times = (uint32_t *)vsf__take(allocator, lines, sizeof *times);
    *median = *last = 0;
    if (!times) {
        return -1;
    }
    for (line = 0; line < lines; line++) {
        uint32_t end, most = 0;
        for (i = vsf__line_range(desc, line, &end); i < end; i++) {
            uint32_t t = fabsf(desc->times[i]) <= 1e15f ? vsf__sortable(desc->times[i] + 0.0f) : 0;
            most = t > most ? t : most;
        }
        if (most) {
            times[count++] = most;
        }
    }
    if (count) {
        *median =
            0.5 * (vsf__kth(times, count, (count - 1) / 2) + vsf__kth(times, count, count / 2));
        *last = vsf__kth(times, count, count - 1);
    }
    vsf__give(allocator, times);
    return 0;
}

VSF_API lao_result vsf_near_make(const vsf_host *host, const vsf_near_desc *desc, vsf_near *table) {
    vsf_near n;
    double median, last;
    lao_result result;
    if (!desc || !table) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_near_make");
    }
    result = vsf__near_check(host, desc);
    if (result != LAO_OK) {
        return result;
    }
    memset(&n, 0, sizeof n);
    n.allocator = vsf__allocator(host);
    n.vertex_count = desc->vertex_count;
    n.step_count = desc->step_count ? desc->step_count : 100;
    n.flags = desc->flags;
    n.bytes = desc->flags & VSF_NEAR_HALF ? 2 : 4;
    if (vsf__median_time(&n.allocator, desc, &median, &last)) {
        return vsf__fail(host, VSF_LOG_MEMORY, "times of %u lines", desc->line_count);
    }
    n.period = desc->period;
    n.duration = desc->period > 0 ? desc->period : last > 0 ? last : 0;
    vsf__near_beta(&n, desc->beta > 0 ? desc->beta : median > 0 ? 2 * median : 1600);
    n.index = vsf__index_make(&n.allocator, desc);
    if (!n.index) {
        return vsf__fail(host, VSF_LOG_MEMORY, "index of %u points", desc->point_count);
    }
    result = vsf__near_fill(host, &n, NULL);
    if (result != LAO_OK) {
        vsf_near_free(&n);
        return result;
    }
    *table = n;
    return LAO_OK;
}

VSF_API void vsf_near_free(vsf_near *table) {
    if (table && table->index) {
        vsf__index_free(&table->allocator, (vsf__index *)table->index);
        vsf__give(&table->allocator, table->values);
    }
    if (table) {
        memset(table, 0, sizeof *table);
    }
}

VSF_API lao_result vsf_near_update(const vsf_host *host, vsf_near *table, double beta) {
    vsf_near n;
    lao_result result;
    if (!table || !table->index) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_near_update");
    }
    if (!(beta > 0 && beta <= 1e15)) {
        return vsf__fail(host, VSF_LOG_SETTING, "beta is more than 0 and at most 1e15, not %g",
                         beta);
    }
    n = *table;
    vsf__near_beta(&n, beta);
    result = vsf__near_fill(host, &n, table);
    if (result == LAO_OK) {
        vsf__give(&table->allocator, table->values);
        *table = n;
    }
    return result;
}

VSF_API void vsf_near_step(const vsf_near *table, uint32_t step, float *distances) {
    uint64_t first =
        (uint64_t)table->vertex_count * (step < table->step_count ? step : table->step_count - 1);
    uint32_t i;
    for (i = 0; i < table->vertex_count; i++) {
        distances[i] = vsf__stored(table->values, table->bytes, first + i);
    }
}

VSF_API uint32_t vsf_near_find(const vsf_near *table, double time, float *part) {
    uint32_t step;
    double place;
    *part = 0;
    if (table->step_count < 2 || !(table->duration > 0) || !(fabs(time) <= 1e15)) {
        return 0;
    }
    if (table->period > 0) {
        time -= table->period * floor(time / table->period);
    }
    place = time / table->duration * (table->step_count - 1);
    if (!(place > 0)) {
        return 0;
    }
    if (place >= table->step_count - 1) {
        *part = 1;
        return table->step_count - 2;
    }
    step = (uint32_t)place;
    *part = (float)(place - step);
    return step;
}

VSF_API void vsf_near_sample(const vsf_near *table, double time, float *distances) {
    float part;
    uint64_t v = table->vertex_count;
    uint32_t step = vsf_near_find(table, time, &part), i;
    uint64_t first = v * step, next = step + 1 < table->step_count ? first + v : first;
    for (i = 0; i < table->vertex_count; i++) {
        distances[i] = vsf_near_mix(vsf__stored(table->values, table->bytes, first + i),
                                    vsf__stored(table->values, table->bytes, next + i), part);
    }
}

VSF_API void vsf_near_pair(const vsf_near *table, uint32_t step, float *texels) {
    uint32_t last = table->step_count - 1, i;
    uint64_t v = table->vertex_count, first = v * (step < last ? step : last);
    uint64_t next = v * (step < last ? step + 1 : last);
    for (i = 0; i < table->vertex_count; i++) {
        texels[2 * (size_t)i] = vsf__stored(table->values, table->bytes, first + i);
        texels[2 * (size_t)i + 1] = vsf__stored(table->values, table->bytes, next + i);
    }
}

VSF_API lao_result vsf_near_exact(const vsf_host *host, const vsf_near *table, double time,
                                  float *distances) {
    vsf__progress progress;
    vsf__query query;
    vsf_near n;
    uint64_t lit = 0;
    if (!table || !table->index || !distances) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_near_exact");
    }
    if (!(fabs(time) <= 1e15)) {
        return vsf__fail(host, VSF_LOG_SETTING, "the time is no number");
    }
    n = *table;
    n.bytes = 4; /* the caller's floats */
    memset(&query, 0, sizeof query);
    query.out = distances;
    progress = vsf__progress_make(host, n.vertex_count);
    return vsf__near_time(&progress, &n, time, &query, &lit);
}

/* ================================================================================================
 * the module */
// clang-format off
#define VSF__WRITE(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define VSF__READ(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define VSF__OTHER(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD}
#define VSF__CLEAR(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_CLEAR}
#define VSF__CLEAR_OTHER(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_CLEAR}
#define VSF__KEEP(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_KEEP}
#define VSF__SMALL(image) {image, LAO_LEVEL_INDEX, VSF_SHADOW_LEVEL, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define VSF__TILES(image) {image, LAO_LEVEL_INDEX, VSF_FOCUS_LEVEL, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define VSF__SURFACE {"#surface_points", '>', 0}
#define VSF__ANY {NULL, 0, 0}
#define VSF__MESH VSF__READ("#surface_points"), VSF__READ("#surface_normals"), VSF__READ("#surface_triangles")
#define VSF__FRONT VSF__MESH, VSF__READ("surface_measure"), VSF__READ("surface_nearness"), VSF__READ("zbuffer"), VSF__READ("#surface_map")
#define VSF__PLAIN(format, size) format, size, 0, 0, NULL, 0, LAO_ENCODING_PLAIN

static const lao_image_row vsf__images[] = {
    /* one texel per vertex: its measure (1/mm); its nearness, x of the look-up */
    {"surface_measure",  VSF__PLAIN(LAO_FORMAT_R32F, LAO_SIZE_ITEMS), {0, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    {"surface_nearness", VSF__PLAIN(LAO_FORMAT_R32F, LAO_SIZE_ITEMS), {0, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    /* front faces, premultiplied, composed so far: a layer writes one partner from the other, and only where it has pixels.
       What a pixel has composed only grows, so the greater of both partners is all of it */
    {"surface_over",     VSF__PLAIN(LAO_FORMAT_RGBA16F, LAO_SIZE_FULL), {0, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    {"surface_composed", VSF__PLAIN(LAO_FORMAT_RGBA16F, LAO_SIZE_FULL), {0, 0, 0, 0}, {"surface_geometry", '=', 1}, {NULL, NULL, NULL, NULL}},
    /* whether the layer before has any pixel: by tiles, and all in all */
    {"surface_tiles",    LAO_FORMAT_R32F, LAO_SIZE_FIXED, VSF_LEFT_TILES, VSF_LEFT_TILES, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"layers", '>', 0}, {NULL, NULL, NULL, NULL}},
    {"surface_left",     LAO_FORMAT_R32F, LAO_SIZE_FIXED, 1, 1, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"layers", '>', 0}, {NULL, NULL, NULL, NULL}},
    {"surface_z",        VSF__PLAIN(LAO_FORMAT_D32F, LAO_SIZE_FULL),    {1, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    /* the nearest front faces of all sets, for the effects */
    {"surface_nearest",  VSF__PLAIN(LAO_FORMAT_D32F, LAO_SIZE_FULL),    {1, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    {"surface_position", VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_FULL), {0, 0, 0, 0}, {"surface_geometry", '=', 1}, {"position.X", "position.Y", "position.Z", "mask.V"}},
    {"surface_normal",   VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_FULL), {0, 0, 0, 0}, {"surface_geometry", '=', 1}, {"normal.X", "normal.Y", "normal.Z", "measure.V"}},
    {"surface_lut",      VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_FULL), {0, 0, 0, 0}, {"surface_geometry", '=', 1}, {"lut.R", "lut.G", "lut.B", "near.V"}},
    /* depth shadow: depths of what is covered at a quarter of the view's size (sum, weight), blurred along x, then y */
    {"shadow_depth",     LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"depth_shadow", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"shadow_x",         LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"depth_shadow", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"shadow_blurred",   LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"depth_shadow", '=', 1}, {NULL, NULL, NULL, NULL}},
    /* focus: what is out of focus in a pixel and its depth (mm), blurred along x, then along y; by tiles whether there is any
       colour, and whether there is any that the blur along x, and along both, brings there */
    {"focus_color",      VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW), {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_depth",      VSF__PLAIN(LAO_FORMAT_R32F, LAO_SIZE_VIEW),    {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_tiles",      LAO_FORMAT_R32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_near_tiles", LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_x",          VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW), {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_blurred",    VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW), {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}}
};

static const lao_pass_row vsf__passes[] = {
    /* back faces, opaque, among the scene: lines and they hide each other by depth */
    {"surface_back", LAO_PASS_DRAW_MESH, "surface_mesh", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_FRONT, {VSF__SURFACE},
     {VSF__KEEP("shaded"), VSF__KEEP("zbuffer")}, {VSF__MESH}},
    {"surface_measure", LAO_PASS_FULLSCREEN, "surface_measure", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE},
     {VSF__WRITE("surface_measure"), VSF__WRITE("surface_nearness")}, {VSF__READ("#surface_points"), VSF__READ("#surface_normals"), VSF__READ("#surface_rings"), VSF__READ("#surface_near"), VSF__READ("#surface_values")}},
    /* the nearest front face, then peel by peel those behind it, and all of them over the scene */
    {"surface_front", LAO_PASS_DRAW_MESH, "surface_mesh", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_BACK, {VSF__SURFACE},
     {VSF__CLEAR("surface_over"), VSF__CLEAR_OTHER("surface_over"), VSF__CLEAR("surface_position"), VSF__CLEAR("surface_normal"), VSF__CLEAR("surface_lut"), VSF__CLEAR("surface_z")}, {VSF__FRONT}},
    {"surface_nearest", LAO_PASS_FULLSCREEN, "surface_nearest", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {VSF__SURFACE},
     {VSF__KEEP("surface_nearest")}, {VSF__READ("surface_z")}},
    {"surface_tiles", LAO_PASS_FULLSCREEN, "surface_left", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"layers", '>', 0}},
     {VSF__WRITE("surface_tiles")}, {VSF__READ("surface_z")}},
    {"surface_left", LAO_PASS_FULLSCREEN, "surface_left", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "layers", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE},
     {VSF__WRITE("surface_left")}, {VSF__READ("surface_tiles")}},
    {"surface_peel", LAO_PASS_DRAW_MESH, "surface_mesh", 2, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_BACK, {VSF__SURFACE},
     {{"surface_over", LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_KEEP}, VSF__CLEAR_OTHER("surface_z")}, {VSF__FRONT, VSF__READ("surface_z"), VSF__READ("surface_left"), VSF__READ("surface_over")}},
    {"surface_tiles_left", LAO_PASS_FULLSCREEN, "surface_left", 2, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE},
     {VSF__OTHER("surface_tiles")}, {VSF__READ("surface_z"), VSF__READ("surface_tiles")}},
    {"surface_over", LAO_PASS_FULLSCREEN, "surface_layers", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE},
     {VSF__OTHER("shaded"), VSF__WRITE("surface_composed")}, {VSF__READ("surface_over"), {"surface_over", LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD}, VSF__READ("shaded")}},
    /* effects of the whole picture */
    {"shadow_depth", LAO_PASS_FULLSCREEN, "surface_shadow", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"depth_shadow", '=', 1}},
     {VSF__SMALL("shadow_depth")}, {VSF__READ("zbuffer"), VSF__READ("surface_nearest")}},
    {"shadow_x", LAO_PASS_FULLSCREEN, "surface_shadow", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"depth_shadow", '=', 1}},
     {VSF__SMALL("shadow_x")}, {VSF__SMALL("shadow_depth")}},
    {"shadow_y", LAO_PASS_FULLSCREEN, "surface_shadow", 2, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"depth_shadow", '=', 1}},
     {VSF__SMALL("shadow_blurred")}, {VSF__SMALL("shadow_x")}},
    {"depth_shadow", LAO_PASS_FULLSCREEN, "surface_effect", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"depth_shadow", '=', 1}},
     {VSF__OTHER("shaded")}, {VSF__READ("shaded"), VSF__READ("zbuffer"), VSF__READ("surface_nearest"), VSF__SMALL("shadow_blurred")}},
    {"attenuation", LAO_PASS_FULLSCREEN, "surface_effect", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"attenuation", '=', 1}},
     {VSF__OTHER("shaded")}, {VSF__READ("shaded"), VSF__READ("zbuffer"), VSF__READ("surface_nearest")}},
    {"focus_pixels", LAO_PASS_FULLSCREEN, "surface_focus", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {VSF__WRITE("focus_color"), VSF__WRITE("focus_depth")}, {VSF__READ("shaded"), VSF__READ("zbuffer"), VSF__READ("surface_nearest")}},
    {"focus_tiles", LAO_PASS_FULLSCREEN, "surface_tiles", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {VSF__TILES("focus_tiles")}, {VSF__READ("focus_color")}},
    {"focus_near_tiles", LAO_PASS_FULLSCREEN, "surface_tiles", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {VSF__TILES("focus_near_tiles")}, {VSF__TILES("focus_tiles")}},
    {"focus_x", LAO_PASS_FULLSCREEN, "surface_blur", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {VSF__WRITE("focus_x")}, {VSF__READ("focus_color"), VSF__READ("focus_depth"), VSF__TILES("focus_near_tiles")}},
    {"focus_y", LAO_PASS_FULLSCREEN, "surface_blur", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {VSF__WRITE("focus_blurred")}, {VSF__READ("focus_x"), VSF__READ("focus_depth"), VSF__TILES("focus_near_tiles")}},
    {"focus", LAO_PASS_FULLSCREEN, "surface_effect", 2, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {VSF__OTHER("shaded")}, {VSF__READ("shaded"), VSF__READ("zbuffer"), VSF__READ("surface_nearest"), VSF__READ("focus_blurred")}}
};

static const lao_setting_row vsf__settings[] = {
#define VSF__ROW(name, type, minimum, maximum, standard, structural, unit, choices, help) \
    {#name, LAO_SETTING_##type, minimum, maximum, standard, structural, unit, choices, help},
    VSF_SETTINGS(VSF__ROW)
#undef VSF__ROW
};

static const lao_module vsf__module = {
    "surface",
    vsf__passes, (uint32_t)(sizeof vsf__passes / sizeof vsf__passes[0]),
    vsf__images, (uint32_t)(sizeof vsf__images / sizeof vsf__images[0]),
    vsf__settings, (uint32_t)(sizeof vsf__settings / sizeof vsf__settings[0]),
    NULL, 0, NULL, 0,
    vsf__buffer_rows, (uint32_t)(sizeof vsf__buffer_rows / sizeof vsf__buffer_rows[0])
};
// clang-format on

VSF_API const lao_module *vsf_module(void) {
    return &vsf__module;
}

static void vsf__object_extra(vsf_object *object, uint32_t index, const float *data,
                              uint32_t count) {
    object->list[index].name = vsf__buffer_rows[index].name;
    object->list[index].data = data;
    object->list[index].texel_count = count;
}

VSF_API lao_result vsf_object_make(const vsf_host *host, const vsf_mesh *mesh, uint32_t max_texels,
                                   vsf_object *object) {
    lao_allocator a = vsf__allocator(host);
    vsf_buffers buffers;
    lao_result result;
    float *extra;
    uint32_t n, i, k;
    if (!mesh || !object) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_object_make");
    }
    result = vsf_buffers_make(host, mesh, max_texels, &buffers);
    if (result != LAO_OK) {
        return result;
    }
    n = buffers.vertex_count;
    if (max_texels && 2 * n > max_texels) {
        vsf_buffers_free(&buffers);
        return vsf__fail(host, VSF_LOG_MESH_DEVICE,
                         "distances of %u vertices need %u texels, the device has %u", n, 2 * n,
                         max_texels);
    }
    extra = (float *)vsf__take(&a, 3 * (uint64_t)n + (uint64_t)4 * VSF_MAP_COLORS, sizeof *extra);
    if (!extra) {
        vsf_buffers_free(&buffers);
        return vsf__fail(host, VSF_LOG_MEMORY, "distances of %u vertices", n);
    }
    memset(object, 0, sizeof *object);
    object->allocator = a;
    object->buffers = buffers;
    object->near_pair = extra;
    object->values = extra + 2 * (size_t)n;
    object->map = extra + 3 * (size_t)n;
    object->step = VSF_NONE;
    for (i = 0; i < n; i++) {
        object->near_pair[2 * (size_t)i] = object->near_pair[2 * (size_t)i + 1] = VSF_FAR;
        object->values[i] = 0.0f;
    }
    for (i = 0; i < VSF_MAP_COLORS; i++) {
        for (k = 0; k < 4; k++) {
            object->map[4 * i + k] = k < 3 ? (float)i / (VSF_MAP_COLORS - 1) : 1.0f;
        }
    }
    vsf_buffers_describe(&object->buffers, object->list, &object->desc);
    vsf__object_extra(object, 4, object->values, n);
    vsf__object_extra(object, 5, object->near_pair, 2 * n);
    vsf__object_extra(object, 6, object->map, VSF_MAP_COLORS);
    object->desc.buffer_count = 7;
    return LAO_OK;
}

VSF_API void vsf_object_free(vsf_object *object) {
    if (object && object->near_pair) {
        vsf__give(&object->allocator, object->near_pair);
        vsf_buffers_free(&object->buffers);
        memset(object, 0, sizeof *object);
    }
}

VSF_API uint32_t vsf_mesh_layers(const vsf_mesh *mesh) {
    const vsf_mesh_info *info = &mesh->info;
    uint32_t most = (uint32_t)vsf__settings[VSF_SETTING_ID_layers].standard;
    if (info->open_edges || info->crowded_edges || info->twisted_edges || info->parts > most) {
        return most;
    }
    return info->parts > 0 ? info->parts - 1 : 0;
}

VSF_API int vsf_object_time(vsf_object *object, const vsf_near *table, double time,
                            vsf_settings *settings, lao_object_desc *update) {
    uint32_t step = vsf_near_find(table, time, &settings->near_part);
    settings->near_gamma = table->gamma;
    settings->set |= VSF_SET(near_part) | VSF_SET(near_gamma);
    *update = object->desc;
    update->buffers = &object->list[5];
    update->buffer_count = 1;
    if (step == object->step || table->vertex_count != object->buffers.vertex_count) {
        return 0;
    }
    vsf_near_pair(table, step, object->near_pair);
    object->step = step;
    return 1;
}

#ifdef __cplusplus
}
#endif

#endif /* VESSELSURFACE_IMPLEMENTATION_DONE */
#endif /* VESSELSURFACE_IMPLEMENTATION */
