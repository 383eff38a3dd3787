/* ================================================================================================
 * host: memory, as the host gives it. The implementation begins here and ends with the last
   section; all of it uses the interface and the shared text. */
#ifdef LINEAO_IMPLEMENTATION
#ifndef LINEAO_IMPLEMENTATION_DONE
#define LINEAO_IMPLEMENTATION_DONE

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef LAO_ASSERT
#define LAO_ASSERT(condition) ((void)0)
#endif

#ifdef __cplusplus
extern "C" {
#endif

static void *lao__default_allocate(void *user, size_t size) {
    (void)user;
    return malloc(size);
}

static void lao__default_release(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}

static lao_allocator lao__allocator_or_default(const lao_allocator *allocator) {
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
static void *lao__new(const lao_allocator *allocator, size_t count, size_t size) {
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

static void lao__delete(const lao_allocator *allocator, void *memory, size_t count, size_t size) {
    if (memory) {
        allocator->release(allocator->user, memory, count * size);
    }
}

/* Makes room for one more item; 0 on success. */
static int lao__grow(const lao_allocator *allocator, void **items, uint32_t count,
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

static int lao__finite(const float *values, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        if (!(values[i] - values[i] == 0.0f)) {
            return 0;
        }
    }
    return 1;
}
