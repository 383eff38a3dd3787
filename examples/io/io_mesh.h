/* Triangle meshes from files: STL, PLY, OBJ, VTP, legacy VTK polygons; each also gzip-compressed.
 * Polygons become fans of triangles around their first vertex, strips their triangles. */
#ifndef LINEAO_IO_MESH_H
#define LINEAO_IO_MESH_H

#include "io.h"

/* All zero = no mesh; valid for every function here. */
typedef struct io_mesh {
    const char *format; /* "stl", "ply", "obj", "vtp" or "vtk": static text */
    const char *unit;   /* as io_options.unit, else "mm": these formats define none */
    double millimetres; /* in one unit */
    uint32_t vertex_count;
    uint32_t triangle_count;
    float *positions;    /* owned; x y z per vertex in the file's unit, minus origin */
    double origin[3];    /* in the file's unit; see io_lines.origin */
    double bounds[2][3]; /* in the file's unit; lowest and highest x y z, absolute; zero if empty */
    uint32_t *triangles; /* owned; three vertices each, counter-clockwise as the file has them */
    float *normals;      /* owned; x y z per vertex as the file has them; NULL = it has none */
    uint32_t vertex_attribute_count;
    io_attribute *vertex_attributes; /* owned; vertex_count rows each (wall shear stress, ...) */
    uint32_t triangle_attribute_count;
    io_attribute *triangle_attributes; /* owned; triangle_count rows each */
    uint32_t warning_count;
    char **warnings; /* owned; plain sentences that do not name the file */
} io_mesh;

/* Reads a file. options may be NULL; of them only unit, progress and user matter. On failure
 * returns false, writes error and leaves out untouched; on success out is overwritten (free what it
 * held before) and the caller owns it. */
bool io_read_mesh(const char *path, const io_options *options, io_mesh *out, io_error *error);

/* The same from size bytes in memory; name_hint as in io_read_lines_memory. */
bool io_read_mesh_memory(const void *bytes, size_t size, const char *name_hint,
                         const io_options *options, io_mesh *out, io_error *error);

/* Frees what mesh owns and zeroes it. Harmless on zeroed or NULL meshes. */
void io_mesh_free(io_mesh *mesh);

/* Makes one vertex of those at bit-equal positions (-0 is 0), keeping the normal and attributes of
 * the first, and drops triangles that then use a vertex twice. The order of what stays is kept.
 * False with an error when memory is short; the mesh is then as it was. */
bool io_mesh_weld(io_mesh *mesh, io_error *error);

/* What the edges tell. An edge is a pair of vertices: weld first. */
typedef struct io_mesh_edges {
    uint32_t edges;
    uint32_t boundary;     /* of one triangle */
    uint32_t non_manifold; /* of three triangles or more */
    uint32_t components;   /* parts that hang together by vertices; a lone vertex is none */
} io_mesh_edges;
/* False with an error when memory is short. */
bool io_mesh_count_edges(const io_mesh *mesh, io_mesh_edges *out, io_error *error);

#endif
