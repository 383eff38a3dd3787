/* What a measurement lends to the code that it measures: a clock and a second thread. */
#ifndef LINEAO_BENCH_HOST_H
#define LINEAO_BENCH_HOST_H

#include <stdint.h>

/* Seconds of a clock that never jumps. */
double bench_now(void);

/* lao_job's run, on two threads: this one and another. */
void bench_run_on_two(void *user, uint32_t count, void (*fn)(void *arg, uint32_t index), void *arg);

#endif
