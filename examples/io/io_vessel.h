/* From a tree that was read to a tree that can be drawn and counted: io_tree to sdv_tree. */
#ifndef LINEAO_IO_VESSEL_H
#define LINEAO_IO_VESSEL_H

#include "io_tree.h"
#include "sdfvessel.h"

/* All zero = none; valid for io_vessel_free. */
typedef struct io_vessel {
    sdv_tree tree;       /* in mm, minus origin; the attributes of the file in its unit */
    double origin[3];    /* mm; see io_lines.origin */
    double bounds[2][3]; /* of the nodes' centres, absolute, in the unit of the file */
    double radius[2];    /* least and greatest as read, in the unit of the file; NaN = none told */
} io_vessel;

/* Builds the tree as its kind asks: merges, joins, turns, counts (sdv_tree_build). Positions are
 * compared as they were read, before they become mm. host: allocator and job, may be NULL; its log
 * is not used, for warnings are in out->tree. On failure returns false, writes error and leaves out
 * untouched. */
bool io_vessel_build(const sdv_host *host, const io_tree *tree, io_vessel *out, io_error *error);
void io_vessel_free(io_vessel *vessel);

#endif
