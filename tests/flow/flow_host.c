#include "flow_host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(void *user, size_t size) {
    flow_host *h = user;
    h->wrong_calls += !pthread_equal(pthread_self(), h->owner);
    if (++h->allocations == h->fail_at)
        return NULL;
    size_t *memory = malloc(size + 16);
    if (!memory)
        return NULL;
    memory[0] = size;
    h->live += size;
    h->peak = h->live > h->peak ? h->live : h->peak;
    return memory + 2;
}

static void release(void *user, void *memory, size_t size) {
    flow_host *h = user;
    size_t *block = (size_t *)memory - 2;
    h->wrong_calls += !pthread_equal(pthread_self(), h->owner) || block[0] != size;
    h->live -= block[0];
    free(block);
}

static void take_log(void *user, flow4d_log_item item, lao_result result, const char *text) {
    flow_host *h = user;
    (void)result;
    h->failures++;
    h->last_item = item;
    snprintf(h->last_text, sizeof h->last_text, "%s", text);
}

static int progress(void *user, uint64_t done, uint64_t total) {
    flow_host *h = user;
    h->done = done;
    h->total = total;
    return ++h->progress_calls == h->cancel_at;
}

typedef struct worker {
    void (*fn)(void *arg, uint32_t index);
    void *arg;
    uint32_t first, step, count;
} worker;

static void *work(void *argument) {
    worker *w = argument;
    for (uint32_t i = w->first; i < w->count; i += w->step) {
        w->fn(w->arg, w->count - 1 - i); /* no order that a result might lean on */
    }
    return NULL;
}

static void run(void *user, uint32_t count, void (*fn)(void *, uint32_t), void *arg) {
    flow_host *h = user;
    pthread_t threads[16];
    worker workers[16];
    for (uint32_t i = 0; i < h->threads; i++) {
        workers[i] = (worker){fn, arg, i, h->threads, count};
        if (pthread_create(&threads[i], NULL, work, &workers[i]) != 0)
            abort();
    }
    for (uint32_t i = 0; i < h->threads; i++)
        pthread_join(threads[i], NULL);
}

void flow_host_make(flow_host *h, uint32_t threads) {
    memset(h, 0, sizeof *h);
    h->owner = pthread_self();
    h->threads = threads < 16 ? threads : 16;
    h->host.allocator.allocate = allocate;
    h->host.allocator.release = release;
    h->host.allocator.user = h;
    h->host.job.run = threads ? run : NULL;
    h->host.job.progress = progress;
    h->host.job.user = h;
    h->host.log = take_log;
    h->host.user = h;
}

void flow_lattice(flow4d_field *field, uint32_t x, uint32_t y, uint32_t z, double edge,
                  double origin) {
    memset(field, 0, sizeof *field);
    field->size[0] = x;
    field->size[1] = y;
    field->size[2] = z;
    for (size_t a = 0; a < 3; a++) {
        field->to_world[5 * a] = edge;
        field->to_world[4 * a + 3] = origin;
    }
}
