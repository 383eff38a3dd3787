/* What is measured: a line set, its settings and its camera. */
#ifndef LINEAO_BENCH_SCENE_H
#define LINEAO_BENCH_SCENE_H

#include "camera.h"
#include "io.h"
#include "lineao.h"
#include "scene.h"

#include <stdbool.h>
#include <stdio.h>

/* A failure: one line "lineao: bench: ..." on standard error. Returns false. */
bool bench_fail(const char *format, ...);

typedef struct bench_scene {
    uint32_t line_count, point_count;
    const uint32_t *offsets;
    const float *points; /* mm */
    const float *times;  /* ms; NULL: none */
    float width;         /* mm */
    float sphere[4];     /* around the points; kept when they are released */
    camera_pose pose;    /* all of it, seen as a whole */
    scene_lines made;    /* one of the two owns the points */
    io_lines read;
} bench_scene;

/* The same of an embedded scene with times, of that name. */
bool bench_scene_timed(bench_scene *scene, const char *name, uint32_t line_count, double aspect);

/* Makes the embedded scene `bundle` (path NULL) or reads a file. aspect: width / height of the
 * view. False: reported. */
bool bench_scene_open(bench_scene *scene, const char *path, uint32_t line_count, double aspect);

/* Releases lines and points; fine on {0}. */
void bench_scene_release(bench_scene *scene);

/* Writes the raw file that vtk_peer.py reads, in the byte order of this machine:
 *   "LAOBENCH", uint32 line_count, uint32 point_count, float width,
 *   double eye[3] center[3] up[3] fovy, uint32 offsets[line_count + 1], float points[3 point_count]
 * False: reported. */
bool bench_scene_export(const bench_scene *scene, const char *path);

#endif
