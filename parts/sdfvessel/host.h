/* ================================================================================================
 * host: failures, memory and jobs, as the host wants them. The implementation begins here and ends
   with the last section; all of it uses the interface and the shared text. */
#ifdef SDFVESSEL_IMPLEMENTATION
#ifndef SDFVESSEL_IMPLEMENTATION_DONE
#define SDFVESSEL_IMPLEMENTATION_DONE

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sdv__item_row {
    lao_result result;
    const char *text;
} sdv__item_row;

static const sdv__item_row sdv__items[] = {
#define SDV__ROW(id, result, text) {result, text},
    SDV_LOG_ITEMS(SDV__ROW)
#undef SDV__ROW
};

/* Logs a failure with a place (printf) or NULL; returns its result. */
static lao_result sdv__fail(const sdv_host *host, sdv_log_item item, const char *place, ...) {
    char text[256];
    size_t n;
    if (!host || !host->log) {
        return sdv__items[item].result;
    }
    n = (size_t)snprintf(text, sizeof text, "%s", sdv__items[item].text);
    if (place && n + 2 < sizeof text) {
        va_list list;
        memcpy(text + n, ": ", 3);
        va_start(list, place);
        vsnprintf(text + n + 2, sizeof text - n - 2, place, list);
        va_end(list);
    }
    host->log(host->user, item, sdv__items[item].result, text);
    return sdv__items[item].result;
}

static void *sdv__malloc(void *user, size_t size) {
    (void)user;
    return malloc(size);
}
static void sdv__free(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}
static lao_allocator sdv__allocator(const sdv_host *host) {
    lao_allocator a;
    if (host && host->allocator.allocate && host->allocator.release) {
        return host->allocator;
    }
    a.allocate = sdv__malloc;
    a.release = sdv__free;
    a.user = NULL;
    return a;
}

/* Memory that knows its size, in front of it. NULL: none left, or more than size_t can count. */
enum { SDV__HEAD = 16 };
static void *sdv__take(const lao_allocator *allocator, uint64_t count, size_t size) {
    unsigned char *memory;
    size_t bytes;
    if (count > (SIZE_MAX - SDV__HEAD) / size) {
        return NULL;
    }
    bytes = SDV__HEAD + (size_t)count * size;
    memory = (unsigned char *)allocator->allocate(allocator->user, bytes);
    if (!memory) {
        return NULL;
    }
    memcpy(memory, &bytes, sizeof bytes);
    return memory + SDV__HEAD;
}
static void sdv__give(const lao_allocator *allocator, void *taken) {
    if (taken) {
        unsigned char *memory = (unsigned char *)taken - SDV__HEAD;
        size_t bytes;
        memcpy(&bytes, memory, sizeof bytes);
        allocator->release(allocator->user, memory, bytes);
    }
}

/* Number k of a vector. */
static float sdv__v3_at(lao_v3 v, uint32_t k) {
    return k == 0 ? v.x : k == 1 ? v.y : v.z;
}
static float sdv__v4_at(lao_v4 v, uint32_t k) {
    return k == 0 ? v.x : k == 1 ? v.y : k == 2 ? v.z : v.w;
}

/* Cuts one block into arrays: a first round with base NULL counts, a second one with the memory
   cuts. */
typedef struct sdv__block {
    unsigned char *base;
    uint64_t used;
} sdv__block;
static void *sdv__part(sdv__block *block, uint64_t count, size_t size) {
    unsigned char *part = block->base ? block->base + block->used : NULL;
    block->used += (count * size + 15u) & ~(uint64_t)15u;
    return part;
}
static uint32_t *sdv__part_u32(sdv__block *block, uint64_t count) {
    return (uint32_t *)sdv__part(block, count, sizeof(uint32_t));
}

/* A piece of work in phases, for progress. */
typedef struct sdv__work {
    const sdv_host *host;
    uint64_t done, total; /* items of all phases */
} sdv__work;

typedef struct sdv__batch {
    void (*fn)(void *arg, uint32_t index);
    void *arg;
    uint32_t first;
} sdv__batch;

static void sdv__run_item(void *arg, uint32_t index) {
    const sdv__batch *b = (const sdv__batch *)arg;
    b->fn(b->arg, b->first + index);
}

/* fn(arg, 0 .. count - 1), as the host likes; progress after every 16. Non-zero: cancelled. */
static int sdv__run(sdv__work *work, uint32_t count, void (*fn)(void *arg, uint32_t index),
                    void *arg) {
    const lao_job *job = work->host ? &work->host->job : NULL;
    uint32_t first, i;
    for (first = 0; first < count; first += 16) {
        uint32_t n = count - first < 16 ? count - first : 16;
        sdv__batch batch;
        batch.fn = fn;
        batch.arg = arg;
        batch.first = first;
        if (job && job->run) {
            job->run(job->user, n, sdv__run_item, &batch);
        } else {
            for (i = 0; i < n; i++) {
                fn(arg, first + i);
            }
        }
        work->done += n;
        if (job && job->progress && job->progress(job->user, work->done, work->total)) {
            return 1;
        }
    }
    return 0;
}

enum { SDV__CHUNK = 64 }; /* segments or rows of one job item */
