/* What the surface tests share: a host that counts bytes, fails on demand and keeps what was
   logged, jobs in any order, shapes whose curvature is known. */
#ifndef SURFACE_HOST_H
#define SURFACE_HOST_H

#include "lent.h"
#include "vesselsurface.h"

/* Clears `host` and returns what calls take. */
vsf_host surface_host_make(lent_host *host);

/* Arrays of a mesh in the making: shared vertices, outward, counter-clockwise. */
typedef struct surface_shape {
    uint32_t vertex_count, triangle_count;
    float *positions, *normals; /* 3 per vertex; analytic */
    uint32_t *triangles;
} surface_shape;
void surface_shape_free(surface_shape *shape);
vsf_mesh_desc surface_describe(const surface_shape *shape);

/* A sphere about 0 from an icosahedron, `level` times split in four. */
surface_shape surface_sphere(double radius, uint32_t level);
/* (u, v) in [0, nu) x [0, nv) to points and normals; wraps in either direction where asked. */
typedef void surface_map(void *arg, double u, double v, double p[3], double n[3]);
surface_shape surface_grid(uint32_t nu, uint32_t nv, int wrap_u, int wrap_v, surface_map *map,
                           void *arg);
/* A torus about z: radii of the ring and of the tube. */
surface_shape surface_torus(double ring, double tube, uint32_t nu, uint32_t nv);
/* An open cylinder along z. */
surface_shape surface_cylinder(double radius, double length, uint32_t nu, uint32_t nv);
/* z = a x y over [-size, size]^2; a = 0: a plane. Its grid is shifted so that rows do not lie on
   the axes. */
surface_shape surface_saddle(double a, double size, uint32_t n);

/* Builds, failing the test when that fails. */
vsf_mesh surface_build(const surface_shape *shape, uint32_t flags, int analytic_normals);

#endif
