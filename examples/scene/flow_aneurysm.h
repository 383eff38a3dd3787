/* A blood flow made of formulas: a cerebral artery that bends and divides, with a sac on the outer
 * side of the bend and a bleb on the sac, for the scene `aneurysm` and its tests.
 *
 * One heart beat of 833 ms repeats. The stream enters by the parent artery and leaves by both
 * branches; a part of it passes through the sac along its dome, and a vortex turns in the sac. The
 * velocity is zero on the wall, tangential beside it, and free of divergence but for the bends of
 * the branches (flow_aneurysm.c says how).
 *
 * Lengths in mm, times in ms, speeds in m/s. Thread: any. */
#ifndef LINEAO_FLOW_ANEURYSM_H
#define LINEAO_FLOW_ANEURYSM_H

#include "flow4d.h"

#include <stdbool.h>

/* About the distance to the wall, negative inside; the vessel's ends are closed. */
double flow_aneurysm_wall(const double position[3]);

/* The flow as a function: velocity_at, inside_at, period, and a lattice of voxels around it. False:
 * out of memory. Release with flow_aneurysm_free. */
bool flow_aneurysm_field(flow4d_field *field);

/* Releases and zeroes; fine on {0}. */
void flow_aneurysm_free(flow4d_field *field);

#endif
