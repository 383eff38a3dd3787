/* Vessel trees from files: SWC; GXL (VascuSynth, OpenCCO); VTP and legacy VTK centrelines with a
 * radius; HDF5 section graphs (Blue Brain, VessMorphoVis); VessMorphoVis .vmv; each also
 * gzip-compressed.
 *
 * A reader says what stands in the file: nodes and segments. Merging repeated points, joining
 * disjoint lines, finding roots and counting is the work of sdv_tree_build (sdfvessel.h);
 * io_tree_build below hands the one to the other. */
#ifndef LINEAO_IO_TREE_H
#define LINEAO_IO_TREE_H

#include "io.h"

typedef enum io_tree_kind {
    IO_TREE_IDS, /* SWC, GXL: every node is one of its own, segments point away from the root */
    IO_TREE_SECTIONS, /* HDF5: points at bit-equal positions are one node; segments are directed */
    IO_TREE_STRANDS,  /* vmv: the same, but the direction of a segment means nothing */
    IO_TREE_LINES     /* VTP, VTK: the same, and lines may be disjoint where they belong together */
} io_tree_kind;

/* All zero = no tree; valid for every function here. */
typedef struct io_tree {
    const char *format; /* "swc", "gxl", "vtp", "vtk", "h5", "vmv": static text */
    const char *unit;   /* "m", "mm", "cm", "um" or "nm": static text */
    double millimetres; /* in one unit */
    io_tree_kind kind;
    uint32_t node_count;
    uint32_t segment_count;
    double *positions;  /* owned; x y z per node, in the file's unit, finite */
    double *radii;      /* owned; per node, in the file's unit; NaN = not told; else >= 0 */
    uint32_t *segments; /* owned; two nodes each: parent, child */
    uint32_t node_attribute_count;
    io_attribute *node_attributes; /* owned; node_count rows each */
    uint32_t segment_attribute_count;
    io_attribute *segment_attributes; /* owned; segment_count rows each */
    uint32_t warning_count;
    char **warnings; /* owned; plain sentences that do not name the file */
} io_tree;

/* Reads a file. options may be NULL; of them only unit, progress and user matter. On failure
 * returns false, writes error and leaves out untouched; on success out is overwritten (free what it
 * held before) and the caller owns it. */
bool io_read_tree(const char *path, const io_options *options, io_tree *out, io_error *error);

/* The same from size bytes in memory; name_hint as in io_read_lines_memory. */
bool io_read_tree_memory(const void *bytes, size_t size, const char *name_hint,
                         const io_options *options, io_tree *out, io_error *error);

/* Frees what tree owns and zeroes it. Harmless on zeroed or NULL trees. */
void io_tree_free(io_tree *tree);

#endif
