/* ================================================================================================
 * host: memory, failures and work, as hosts want them. A part of every implementation: those of
   modules define LAO__HOST and include lineao.h again, and need no other function of it. Uses the
   interface. */
#if defined(LINEAO_IMPLEMENTATION) || defined(LAO__HOST)
#ifndef LAO__HOST_DONE
#define LAO__HOST_DONE

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline void *lao__default_allocate(void *user, size_t size) {
    (void)user;
    return malloc(size);
}

static inline void lao__default_release(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}

static inline lao_allocator lao__allocator_or_default(const lao_allocator *allocator) {
    lao_allocator a;
    memset(&a, 0, sizeof a);
    if (allocator && allocator->allocate && allocator->release) {
        return *allocator;
    }
    a.allocate = lao__default_allocate;
    a.release = lao__default_release;
    return a;
}

/* Zeroed memory for count items; NULL for none, on overflow or when there is no memory. */
static inline void *lao__new(const lao_allocator *allocator, size_t count, size_t size) {
    void *memory;
    if (count == 0 || count > (size_t)-1 / size) {
        return NULL;
    }
    memory = allocator->allocate(allocator->user, count * size);
    if (memory) {
        memset(memory, 0, count * size);
    }
    return memory;
}

static inline void lao__delete(const lao_allocator *allocator, void *memory, size_t count,
                               size_t size) {
    if (memory) {
        allocator->release(allocator->user, memory, count * size);
    }
}

/* Makes room for one more item; 0 on success. */
static inline int lao__grow(const lao_allocator *allocator, void **items, uint32_t count,
                            uint32_t *capacity, size_t size) {
    uint32_t larger;
    void *memory;
    if (count < *capacity) {
        return 0;
    }
    larger = *capacity ? *capacity * 2 : 16;
    memory = lao__new(allocator, larger, size);
    if (!memory) {
        return -1;
    }
    if (*items) {
        memcpy(memory, *items, (size_t)count * size);
        lao__delete(allocator, *items, *capacity, size);
    }
    *items = memory;
    *capacity = larger;
    return 0;
}

static inline int lao__finite(const float *values, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        if (!(values[i] - values[i] == 0.0f)) {
            return 0;
        }
    }
    return 1;
}

/* Memory that knows its size, in front of it. NULL: none left, or more than size_t can count. */
enum { LAO__HEAD = 16 };
static inline void *lao__take(const lao_allocator *allocator, uint64_t count, size_t size) {
    unsigned char *memory;
    size_t bytes;
    if (count > (SIZE_MAX / 2 - LAO__HEAD) / size) {
        return NULL;
    }
    bytes = LAO__HEAD + (size_t)count * size;
    memory = (unsigned char *)allocator->allocate(allocator->user, bytes);
    if (!memory) {
        return NULL;
    }
    memcpy(memory, &bytes, sizeof bytes);
    return memory + LAO__HEAD;
}

static inline void lao__give(const lao_allocator *allocator, void *taken) {
    if (taken) {
        unsigned char *memory = (unsigned char *)taken - LAO__HEAD;
        size_t bytes;
        memcpy(&bytes, memory, sizeof bytes);
        allocator->release(allocator->user, memory, bytes);
    }
}

/* Cuts one block into arrays: a first round with base NULL counts, a second one with the memory
   cuts. Counts stay below 2^34, so that sums of a few dozen parts do not overflow. */
typedef struct lao__block {
    unsigned char *base;
    uint64_t used;
} lao__block;
static inline void *lao__part(lao__block *block, uint64_t count, size_t size) {
    unsigned char *part = block->base ? block->base + block->used : NULL;
    block->used += (count * size + 15u) & ~(uint64_t)15u;
    return part;
}
static inline uint32_t *lao__part_u32(lao__block *block, uint64_t count) {
    return (uint32_t *)lao__part(block, count, sizeof(uint32_t));
}
static inline float *lao__part_float(lao__block *block, uint64_t count) {
    return (float *)lao__part(block, count, sizeof(float));
}

/* What a failure is, and with a place (printf; NULL: none) where. */
static inline void lao__failure_text(char *text, size_t size, const char *what, const char *place,
                                     va_list arguments) {
    size_t n = (size_t)snprintf(text, size, "%s", what);
    if (place && n + 2 < size) {
        memcpy(text + n, ": ", 3);
        vsnprintf(text + n + 2, size - n - 2, place, arguments);
    }
}

/* fn(arg, 0 .. count - 1), as the host likes. */
static inline void lao__job_run(const lao_job *job, uint32_t count,
                                void (*fn)(void *arg, uint32_t index), void *arg) {
    uint32_t i;
    if (job && job->run) {
        job->run(job->user, count, fn, arg);
        return;
    }
    for (i = 0; i < count; i++) {
        fn(arg, i);
    }
}

/* Not 0: the host wants no more. */
static inline int lao__job_cancelled(const lao_job *job, uint64_t done, uint64_t total) {
    return job && job->progress && job->progress(job->user, done, total);
}

#endif /* LAO__HOST_DONE */
#endif
