/* What the vessel tests share: a host that counts bytes, fails on demand and keeps what was logged,
   numbers that look random, jobs on one thread in any order. */
#ifndef VESSEL_HOST_H
#define VESSEL_HOST_H

#include "sdfvessel.h"

typedef struct vessel_host {
    uint64_t bytes, most;        /* taken now; most at one time */
    uint32_t takes, fail_at;     /* allocations so far; the n-th fails, 0: none */
    uint32_t failures, warnings; /* logged */
    sdv_log_item item;           /* the last failure */
    lao_result result;
    char text[256], warning[256];
    uint32_t seen[SDV_LOG_ITEM_COUNT];  /* how often each item was logged */
    uint32_t cancel_at, progress_calls; /* progress cancels at the n-th call, 0: never */
    uint64_t done, total;
    int backwards; /* the job runs its items last to first */
} vessel_host;

/* Clears `host` and returns what calls take. */
sdv_host vessel_host_make(vessel_host *host);

/* In [low, high), from a state that the call moves on. */
double vessel_between(uint32_t *seed, double low, double high);
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
