/* What tests lend to the headers: memory that is counted and refused on demand, a job in either
   order, a log that is kept. */
#ifndef LENT_H
#define LENT_H

#include "lineao.h"

typedef struct lent_memory {
    long bytes, blocks;       /* alive */
    uint32_t allocations;     /* so far */
    uint32_t fail_allocation; /* this one is refused; 0: none */
    uint32_t refused;         /* so far */
} lent_memory;

/* All zero is fresh memory. What it gives is never zero; a wrong size on release shows up as bytes
 * that are left. */
lao_allocator lent_allocator(lent_memory *memory);

enum { LENT_LOG_ITEMS = 64 };

typedef struct lent_host {
    lent_memory memory;
    uint32_t failures, warnings; /* logged */
    uint32_t item;               /* the last failure */
    lao_result result;
    char text[320], warning[320];
    uint32_t seen[LENT_LOG_ITEMS];      /* how often each item was logged */
    uint32_t cancel_at, progress_calls; /* progress cancels at the n-th call, 0: never */
    uint64_t done, total;
    int backwards; /* the job runs its items last to first */
} lent_host;

/* On this thread; its user is the host. */
lao_job lent_job(lent_host *host);
/* What a module's log calls, whose items have a type of their own. */
void lent_log(lent_host *host, uint32_t item, lao_result result, const char *text);

/* In [low, high), from a state that the call moves on. */
double lent_between(uint32_t *seed, double low, double high);

#endif
