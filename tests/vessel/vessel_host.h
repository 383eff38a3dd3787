/* What the vessel tests share: a host that counts bytes, fails on demand and keeps what was logged,
   numbers that look random, jobs on one thread in any order. */
#ifndef VESSEL_HOST_H
#define VESSEL_HOST_H

#include "lent.h"
#include "sdfvessel.h"

/* Clears `host` and returns what calls take. */
sdv_host vessel_host_make(lent_host *host);

/* Each coordinate in [-size, size). */
lao_v3 vessel_point(uint32_t *seed, double size);
/* A unit vector. */
lao_v3 vessel_direction(uint32_t *seed);

/* A random tree of n nodes in a box of `size` mm: parents[i] < i, radii up to `radius`. Static
   storage is not used: positions 3n, radii n, segments n - 1 are the caller's. */
void vessel_random_tree(uint32_t seed, uint32_t n, double size, double radius, float *positions,
                        float *radii, sdv_segment *segments);

/* Signed distance of p to a round cone (centre and radius of both ends) in double precision, by the
   three regions of METHODS.md 4. */
double vessel_cone_distance(const lao_v4 *cone, const double p[3]);

#endif
