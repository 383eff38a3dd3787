/* A blood flow made of formulas: an aortic arch with a bulge, for the scene `flow`, tests and the
 * benchmark of flow4d.h.
 *
 * One heart beat of 833 ms repeats. A systolic jet enters a dilated ascending part, where a vortex
 * stands beside it once it slows down; the arch turns the flow into a helix; the descending part is
 * laminar. The velocity is smooth, free of divergence, tangential to the wall and zero on it, all
 * by construction (flow_phantom.c says how).
 *
 * Lengths in mm, times in ms, speeds in m/s, world frame RAS. Thread: any. */
#ifndef LINEAO_FLOW_PHANTOM_H
#define LINEAO_FLOW_PHANTOM_H

#include "flow4d.h"

#include <stdbool.h>

/* The phantom as a function: velocity_at, inside_at, period, and the lattice of voxels (spacing 2,
 * 2, 3 mm, 21 frames of about 40 ms, as MRI measures) around it. Owns nothing. */
void flow_phantom_field(flow4d_field *field);

/* About the distance to the wall, negative inside; exactly 0 on the wall. The flat ends of the
 * vessel count as open: beyond them it is as if the vessel went on. */
double flow_phantom_wall(const double position[3]);

/* The phantom as a measurement would give it: velocities at voxel centres, 0 outside, and the mask,
 * with these voxels (mm; NULL: 2, 2, 3) and frames (0: 21). False: out of memory, or spacing that
 * is no positive number. Release with flow_phantom_grid_free. */
bool flow_phantom_grid(const double spacing[3], uint32_t frame_count, flow4d_field *grid);

/* Releases and zeroes; fine on {0}. */
void flow_phantom_grid_free(flow4d_field *grid);

#endif
