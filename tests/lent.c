#include "lent.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void *allocate(void *user, size_t size) {
    lent_memory *m = (lent_memory *)user;
    void *memory;
    if (++m->allocations == m->fail_allocation) {
        m->refused++;
        return NULL;
    }
    memory = malloc(size);
    if (memory) {
        memset(memory, 0xa5, size); /* nobody may count on zeros */
        m->blocks++;
        m->bytes += (long)size;
    }
    return memory;
}

static void release(void *user, void *memory, size_t size) {
    lent_memory *m = (lent_memory *)user;
    m->blocks--;
    m->bytes -= (long)size;
    free(memory);
}

lao_allocator lent_allocator(lent_memory *memory) {
    lao_allocator allocator;
    allocator.allocate = allocate;
    allocator.release = release;
    allocator.user = memory;
    return allocator;
}

static void run(void *user, uint32_t count, void (*fn)(void *arg, uint32_t index), void *arg) {
    const lent_host *host = (const lent_host *)user;
    for (uint32_t i = 0; i < count; i++)
        fn(arg, host->backwards ? count - 1 - i : i);
}

static int progress(void *user, uint64_t done, uint64_t total) {
    lent_host *host = (lent_host *)user;
    assert_true(done <= total);
    host->done = done;
    host->total = total;
    return ++host->progress_calls == host->cancel_at;
}

lao_job lent_job(lent_host *host) {
    lao_job job;
    memset(&job, 0, sizeof job);
    job.run = run;
    job.progress = progress;
    job.user = host;
    return job;
}

void lent_log(lent_host *host, uint32_t item, lao_result result, const char *text) {
    host->seen[item < LENT_LOG_ITEMS ? item : LENT_LOG_ITEMS - 1]++;
    if (result == LAO_OK) {
        host->warnings++;
        snprintf(host->warning, sizeof host->warning, "%s", text);
    } else {
        host->failures++;
        host->item = item;
        host->result = result;
        snprintf(host->text, sizeof host->text, "%s", text);
    }
}

double lent_between(uint32_t *seed, double low, double high) {
    *seed = *seed * 1664525u + 1013904223u;
    return low + (high - low) * (double)(lao_hash(*seed) >> 8) / 16777216.0;
}
