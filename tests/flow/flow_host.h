/* What the tests of flow4d.h lend to it: an allocator that counts and fails on demand, a job on
 * threads, a log. */
#ifndef FLOW_HOST_H
#define FLOW_HOST_H

#include "flow4d.h"

#include <pthread.h>

typedef struct flow_host {
    flow4d_host host;
    pthread_t owner;           /* the only thread that may allocate */
    size_t live, peak;         /* bytes */
    uint32_t allocations;      /* so far */
    uint32_t fail_at;          /* this allocation fails, counted from 1; 0: none */
    uint32_t wrong_calls;      /* allocations off the owner's thread, releases of a wrong size */
    uint32_t threads;          /* of the job */
    uint32_t failures;         /* logged */
    flow4d_log_item last_item; /* of them */
    char last_text[512];
    uint64_t done, total; /* of the last progress */
    uint32_t cancel_at;   /* this call of progress cancels, counted from 1; 0: none */
    uint32_t progress_calls;
} flow_host;

/* `threads` 0: no job. The struct must not move. */
void flow_host_make(flow_host *host, uint32_t threads);

/* Counts n voxels; to_world is a shift by `origin` of a lattice with these voxel edges. */
void flow_lattice(flow4d_field *field, uint32_t x, uint32_t y, uint32_t z, double edge,
                  double origin);

#endif
