/* Embedded scenes: line sets made by code, for the program, the tests and the benchmarks.
 *
 * All lengths in mm, times in ms, speeds in m/s; the frame is RAS (+x right, +y anterior, +z
 * superior of the patient). The same name, count and seed give the same bits in every run.
 * Thread: all functions are free of shared state. */
#ifndef LINEAO_SCENE_H
#define LINEAO_SCENE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct scene_lines {
    uint32_t line_count, point_count;
    uint32_t *offsets; /* line_count + 1: line i has points offsets[i] .. offsets[i + 1] - 1 */
    float *points;     /* 3 * point_count, mm; NULL when there are none */
    float *times;      /* point_count, ms, rising along each line; NULL: the scene has none */
    float *values;     /* point_count, speed in m/s; NULL: the scene has none */
    float width;       /* suggested full line width, mm */
    float view_direction[3], up[3]; /* suggested camera: it looks along view_direction */
} scene_lines;

/* The names that scene_make knows, the default scene first. */
const char *const *scene_names(uint32_t *count);

/* One line about a scene, with its default line count; NULL for an unknown name. */
const char *scene_help(const char *name);

/* Makes a scene of line_count lines (0 = its default; `stress` has a fixed number of cases and
 * repeats them). False: unknown name or out of memory, *out is then untouched. */
bool scene_make(const char *name, uint32_t line_count, uint32_t seed, scene_lines *out);

/* Releases and zeroes; fine on {0}. */
void scene_free(scene_lines *lines);

#endif
