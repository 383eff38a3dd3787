/* Embedded surfaces: closed triangle meshes of signed distances, made by marching cubes of
 * flow4d.h and moved onto the wall, with its normals.
 *
 * Lengths in mm, the frame is RAS. The same name and spacing give the same bits in every run.
 * Thread: all functions are free of shared state. */
#ifndef LINEAO_SCENE_SURFACE_H
#define LINEAO_SCENE_SURFACE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct scene_surface {
    uint32_t vertex_count, triangle_count;
    float *positions;               /* 3 per vertex, mm: on the wall */
    float *normals;                 /* 3 per vertex: the wall's, outward; 0 on an edge of it */
    uint32_t *triangles;            /* 3 per triangle, counter-clockwise seen from outside */
    float view_direction[3], up[3]; /* suggested camera: it looks along view_direction */
} scene_surface;

/* The names that scene_surface_make knows, the default first. */
const char *const *scene_surface_names(uint32_t *count);

/* One line about a surface; NULL for an unknown name. */
const char *scene_surface_help(const char *name);

/* About the distance to a surface's nearest wall, negative inside it: what is meshed. `name` must
 * be known. */
double scene_surface_distance(const char *name, const double position[3]);

/* Makes a surface with voxels of `spacing` mm (0: its default; the number of triangles grows with
 * 1 / spacing^2). False: unknown name, a spacing that is no positive number or far too fine, or out
 * of memory; *out is then untouched. */
bool scene_surface_make(const char *name, double spacing, scene_surface *out);

/* Releases and zeroes; fine on {0}. */
void scene_surface_free(scene_surface *surface);

#endif
