/* A mesh while it is read. Private to examples/io. */
#ifndef LINEAO_IO_SURFACE_H
#define LINEAO_IO_SURFACE_H

#include "io_internal.h"

struct io_surface {
    double *positions;     /* x y z */
    uint32_t *vertex_rows; /* row of each vertex in the file's arrays */
    size_t vertex_count, vertex_capacity;
    uint32_t *triangles; /* three vertices each */
    uint32_t *triangle_rows;
    size_t triangle_count, triangle_capacity;
    size_t broken;    /* triangles dropped for a vertex that is not finite */
    size_t not_faces; /* polygons of fewer than three vertices */
    float *normals;   /* x y z of the first normal_count vertices; NULL = none at all */
    size_t normal_count, normal_capacity;
    io_columns vertex_columns, triangle_columns;
};

/* Zeroed, and the reader's surface from now on; NULL = no memory. */
io_surface *io_surface_new(io_reader *reader);
/* Vertices keep their numbers, also those that are not finite: triangles that use them go. */
bool io_surface_add_vertex(io_reader *reader, const double position[3], size_t row);
/* A fan around the first of count vertices, each below vertex_count. row: of the polygon. */
bool io_surface_add_polygon(io_reader *reader, const uint32_t *vertices, size_t count, size_t row);
/* Every second triangle of a strip turns the other way. */
bool io_surface_add_strip(io_reader *reader, const uint32_t *vertices, size_t count, size_t row);
/* The normals of the vertices from first on; those before without one get 0. */
bool io_surface_add_normals(io_reader *reader, size_t first, const io_view *normals);
/* Hands the mesh over. */
bool io_finish_mesh(io_reader *reader, const char *format, io_mesh *out);

#endif
