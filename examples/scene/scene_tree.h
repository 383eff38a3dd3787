/* An embedded vessel tree: a portal vein made by code in an ellipsoid "liver" with a tumour.
 *
 * Lengths in mm, RAS, the organ's middle at the origin. The same count and seed give the same bits
 * in every run. Thread: free of shared state. */
#ifndef LINEAO_SCENE_TREE_H
#define LINEAO_SCENE_TREE_H

#include <stdbool.h>
#include <stdint.h>

enum { SCENE_TREE_MOST = 1000000 }; /* nodes */

typedef struct scene_tree {
    uint32_t node_count, segment_count; /* one root, node 0; segment i - 1 ends in node i */
    float *positions;                   /* 3 * node_count */
    float *radii;                       /* node_count; r^3 of a node = sum of its children's r^3 */
    uint32_t *segments;                 /* 2 * segment_count: parent < child */
    float liver[3];                     /* half axes of the ellipsoid */
    float tumour[4];                    /* centre and radius; no node is inside */
} scene_tree;

/* Makes a tree of exactly node_count nodes (0: 3000) that fills the organ evenly, with two children
 * or fewer per node. False: more than SCENE_TREE_MOST or out of memory, *out is then untouched. */
bool scene_tree_make(uint32_t node_count, uint32_t seed, scene_tree *out);

/* Releases and zeroes; fine on {0}. */
void scene_tree_free(scene_tree *tree);

#endif
