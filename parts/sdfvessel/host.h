/* ================================================================================================
 * host: failures and jobs, as the host wants them; memory comes from lineao.h (its section host).
   The implementation begins here and ends with the last section; all of it uses the interface, the
   shared text and lineao.h's host. */
#ifdef SDFVESSEL_IMPLEMENTATION
#ifndef SDFVESSEL_IMPLEMENTATION_DONE
#define SDFVESSEL_IMPLEMENTATION_DONE

#define LAO__HOST
#include "lineao.h"

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
    va_list arguments;
    if (host && host->log) {
        va_start(arguments, place);
        lao__failure_text(text, sizeof text, sdv__items[item].text, place, arguments);
        va_end(arguments);
        host->log(host->user, item, sdv__items[item].result, text);
    }
    return sdv__items[item].result;
}

static lao_allocator sdv__allocator(const sdv_host *host) {
    return lao__allocator_or_default(host ? &host->allocator : NULL);
}

/* Number k of a vector. */
static float sdv__v3_at(lao_v3 v, uint32_t k) {
    return k == 0 ? v.x : k == 1 ? v.y : v.z;
}
static float sdv__v4_at(lao_v4 v, uint32_t k) {
    return k == 0 ? v.x : k == 1 ? v.y : k == 2 ? v.z : v.w;
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
    sdv__batch batch;
    batch.fn = fn;
    batch.arg = arg;
    for (batch.first = 0; batch.first < count; batch.first += 16) {
        uint32_t n = count - batch.first < 16 ? count - batch.first : 16;
        lao__job_run(job, n, sdv__run_item, &batch);
        work->done += n;
        if (lao__job_cancelled(job, work->done, work->total)) {
            return 1;
        }
    }
    return 0;
}

enum { SDV__CHUNK = 64 }; /* segments or rows of one job item */
