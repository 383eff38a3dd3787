/* What the surface tests share: a host that counts bytes, fails on demand and keeps what was
   logged, jobs in any order, shapes whose curvature is known. */
#ifndef SURFACE_HOST_H
#define SURFACE_HOST_H

#include "vesselsurface.h"

typedef struct surface_host {
    uint64_t bytes;              /* taken now */
    uint32_t takes, fail_at;     /* allocations so far; the n-th fails, 0: none */
    uint32_t failures, warnings; /* logged */
    vsf_log_item item;           /* the last failure */
    char text[320], warning[320];
    uint32_t seen[VSF_LOG_ITEM_COUNT];  /* how often each item was logged */
    uint32_t cancel_at, progress_calls; /* progress cancels at the n-th call, 0: never */
    uint64_t done, total;
    int backwards; /* the job runs its items last to first */
} surface_host;

/* Clears `host` and returns what calls take. */
vsf_host surface_host_make(surface_host *host);

/* In [low, high), from a state that the call moves on. */
double surface_between(uint32_t *seed, double low, double high);

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
