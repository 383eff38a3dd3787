/* ================================================================================================
 * host: failures, memory and jobs, as the host wants them. The implementation begins here and ends
   with the last section; all of it uses the interface and the shared text. */
#ifdef VESSELSURFACE_IMPLEMENTATION
#ifndef VESSELSURFACE_IMPLEMENTATION_DONE
#define VESSELSURFACE_IMPLEMENTATION_DONE

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct vsf__item_row {
    lao_result result;
    const char *text;
} vsf__item_row;

static const vsf__item_row vsf__items[] = {
#define VSF__ROW(id, result, text) {result, text},
    VSF_LOG_ITEMS(VSF__ROW)
#undef VSF__ROW
};

/* Logs a failure with a place (printf) or NULL; returns its result. */
static lao_result vsf__fail(const vsf_host *host, vsf_log_item item, const char *place, ...) {
    char text[320];
    size_t n;
    if (!host || !host->log) {
        return vsf__items[item].result;
    }
    n = (size_t)snprintf(text, sizeof text, "%s", vsf__items[item].text);
    if (place && n + 2 < sizeof text) {
        va_list list;
        memcpy(text + n, ": ", 3);
        va_start(list, place);
        vsnprintf(text + n + 2, sizeof text - n - 2, place, list);
        va_end(list);
    }
    host->log(host->user, item, vsf__items[item].result, text);
    return vsf__items[item].result;
}

static void *vsf__malloc(void *user, size_t size) {
    (void)user;
    return malloc(size);
}
static void vsf__free(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}
static lao_allocator vsf__allocator(const vsf_host *host) {
    lao_allocator a;
    if (host && host->allocator.allocate && host->allocator.release) {
        return host->allocator;
    }
    a.allocate = vsf__malloc;
    a.release = vsf__free;
    a.user = NULL;
    return a;
}

/* Memory that knows its size, in front of it. NULL: none left, or more than size_t can count. */
enum { VSF__HEAD = 16 };
static void *vsf__take(const lao_allocator *allocator, uint64_t count, size_t size) {
    unsigned char *memory;
    size_t bytes;
    if (count > (SIZE_MAX / 2 - VSF__HEAD) / size) {
        return NULL;
    }
    bytes = VSF__HEAD + (size_t)count * size;
    memory = (unsigned char *)allocator->allocate(allocator->user, bytes);
    if (!memory) {
        return NULL;
    }
    memcpy(memory, &bytes, sizeof bytes);
    return memory + VSF__HEAD;
}
static void vsf__give(const lao_allocator *allocator, void *taken) {
    if (taken) {
        unsigned char *memory = (unsigned char *)taken - VSF__HEAD;
        size_t bytes;
        memcpy(&bytes, memory, sizeof bytes);
        allocator->release(allocator->user, memory, bytes);
    }
}

/* Cuts one block into arrays: a first round with base NULL counts, a second one with the memory
   cuts. Counts stay below 2^34, so that sums of a few dozen parts do not overflow. */
typedef struct vsf__block {
    unsigned char *base;
    uint64_t used;
} vsf__block;
static void *vsf__part(vsf__block *block, uint64_t count, size_t size) {
    unsigned char *part = block->base ? block->base + block->used : NULL;
    block->used += (count * size + 15u) & ~(uint64_t)15u;
    return part;
}
static uint32_t *vsf__part_u32(vsf__block *block, uint64_t count) {
    return (uint32_t *)vsf__part(block, count, sizeof(uint32_t));
}
static float *vsf__part_float(vsf__block *block, uint64_t count) {
    return (float *)vsf__part(block, count, sizeof(float));
}

/* Work in fixed chunks through the host's job. `done` of `total` is what progress hears. */
typedef struct vsf__progress {
    const vsf_host *host;
    uint64_t done, total;
} vsf__progress;
typedef struct vsf__work {
    void (*fn)(void *arg, uint32_t first, uint32_t end);
    void *arg;
    uint32_t items, chunk, offset;
} vsf__work;
static void vsf__work_chunk(void *arg, uint32_t index) {
    const vsf__work *work = (const vsf__work *)arg;
    uint64_t first = ((uint64_t)work->offset + index) * work->chunk;
    uint64_t end = first + work->chunk;
    work->fn(work->arg, (uint32_t)first, end < work->items ? (uint32_t)end : work->items);
}
/* Returns 0, or -1 when the host cancels. Every item counts one unit of progress. */
static int vsf__run(vsf__progress *progress, uint32_t items, uint32_t chunk, void *arg,
                    void (*fn)(void *arg, uint32_t first, uint32_t end)) {
    const vsf_host *host = progress->host;
    const uint32_t batch = 64;
    uint32_t chunks = items / chunk + (items % chunk != 0), i;
    vsf__work work;
    work.fn = fn;
    work.arg = arg;
    work.items = items;
    work.chunk = chunk;
    for (work.offset = 0; work.offset < chunks; work.offset += batch) {
        uint32_t count = chunks - work.offset < batch ? chunks - work.offset : batch;
        uint64_t units = (uint64_t)count * chunk;
        if (host && host->job.run) {
            host->job.run(host->job.user, count, vsf__work_chunk, &work);
        } else {
            for (i = 0; i < count; i++) {
                vsf__work_chunk(&work, i);
            }
        }
        progress->done += units;
        if (progress->done > progress->total) {
            progress->done = progress->total;
        }
        if (host && host->job.progress &&
            host->job.progress(host->job.user, progress->done, progress->total)) {
            return -1;
        }
    }
    return 0;
}
static vsf__progress vsf__progress_make(const vsf_host *host, uint64_t total) {
    vsf__progress p;
    p.host = host;
    p.done = 0;
    p.total = total;
    return p;
}
enum { VSF__CHUNK = 4096 };
