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
       Size      nothing recurses; time and memory grow linearly with the mesh.

   ORDER  the interface; the shared text, which is C and GLSL at once; the implementation. Each
   section begins with what it holds and which others it uses. */
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
    VSF_SETTINGS(LAO_SETTING_FIELD)
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
