/* The benchmark of vesselsurface.h's passes: animated frames of embedded meshes on both backends,
 * pass by pass, beside a plain Gouraud mesh in the same frames. */
#ifndef LINEAO_BENCH_SURFACE_H
#define LINEAO_BENCH_SURFACE_H

#include <cJSON.h>
#include <stdbool.h>

/* Adds "surface", an array of measurements, to the document. quick: the smallest mesh, small.
 * False: reported. */
bool bench_surface_run(cJSON *document, bool quick);

/* Prints it as a table. */
void bench_surface_print(const cJSON *document);

#endif
