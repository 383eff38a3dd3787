/* The same small tree and the same small mesh in every format and encoding, made in memory: for
 * tests and as seeds of the fuzzer. */
#ifndef LINEAO_TREE_SAMPLES_H
#define LINEAO_TREE_SAMPLES_H

#include "io_read.h"
#include "samples.h"

/* A trunk of two segments, then two branches, one of two segments. Numbers are exact in floats:
 *     0 - 1 - 2
 *          \- 3 - 4 */
enum { TREE_NODES = 5, TREE_SEGMENTS = 4 };
extern const double tree_positions[TREE_NODES][3];
extern const double tree_radii[TREE_NODES];
extern const uint32_t tree_segments[TREE_SEGMENTS][2];

typedef struct tree_sample {
    const char *name; /* with the extension of its format */
    buffer (*make)(void);
    const char *format, *unit;
    bool by_segment; /* radii stand at segments: the root has that of its widest segment, 1.5 */
    bool guessed;    /* the unit is a guess, which a warning tells */
} tree_sample;
extern const tree_sample tree_samples[];
extern const size_t tree_sample_count;

/* A pyramid on a square: 5 vertices, 5 faces, 6 triangles, closed. */
enum { MESH_VERTICES = 5, MESH_TRIANGLES = 6 };
extern const double mesh_positions[MESH_VERTICES][3];
extern const uint32_t mesh_triangles[MESH_TRIANGLES][3];
double mesh_stress(size_t vertex); /* vertex attribute "wss" */
double mesh_part(size_t triangle); /* triangle attribute "part": number of its face */

typedef struct mesh_sample {
    const char *name;
    buffer (*make)(void);
    const char *format;
    bool vertex_data, face_data; /* it has wss, part */
    bool loose;                  /* every triangle has vertices of its own */
} mesh_sample;
extern const mesh_sample mesh_samples[];
extern const size_t mesh_sample_count;

buffer text_file(const char *text);
buffer make_tree_sample(const char *name);
buffer make_mesh_sample(const char *name);

/* An HDF5 section graph from tables of doubles; structure with `width` columns. */
buffer make_h5(const double (*points)[4], size_t point_count, const double *structure,
               size_t section_count, size_t width, const double (*links)[2], size_t link_count);
/* One section, with further tables of a row per point. */
typedef struct h5_table {
    const char *name;
    size_t columns;
    const double *values;
} h5_table;
buffer make_h5_section(const double (*points)[4], size_t point_count, const h5_table *more,
                       size_t more_count);

#endif
