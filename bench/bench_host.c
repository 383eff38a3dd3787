#include "bench_host.h"

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <time.h>

double bench_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct shared_work {
    void (*fn)(void *arg, uint32_t index);
    void *arg;
    uint32_t next, count;
    pthread_mutex_t lock;
} shared_work;

static void *work_on(void *argument) {
    shared_work *work = argument;
    for (;;) {
        pthread_mutex_lock(&work->lock);
        uint32_t index = work->next < work->count ? work->next++ : UINT32_MAX;
        pthread_mutex_unlock(&work->lock);
        if (index == UINT32_MAX)
            return NULL;
        work->fn(work->arg, index);
    }
}

void bench_run_on_two(void *user, uint32_t count, void (*fn)(void *arg, uint32_t index),
                      void *arg) {
    shared_work work = {fn, arg, 0, count, PTHREAD_MUTEX_INITIALIZER};
    pthread_t thread;
    bool two = pthread_create(&thread, NULL, work_on, &work) == 0;
    (void)user;
    work_on(&work);
    if (two)
        pthread_join(thread, NULL);
    pthread_mutex_destroy(&work.lock);
}
