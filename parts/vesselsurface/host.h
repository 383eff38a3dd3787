/* ================================================================================================
 * host: failures and jobs, as the host wants them; memory comes from lineao.h (its section host).
   The implementation begins here and ends with the last section; all of it uses the interface, the
   shared text and lineao.h's host. */
#ifdef VESSELSURFACE_IMPLEMENTATION
#ifndef VESSELSURFACE_IMPLEMENTATION_DONE
#define VESSELSURFACE_IMPLEMENTATION_DONE

#define LAO__HOST
#include "lineao.h"

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
    va_list arguments;
    if (host && host->log) {
        va_start(arguments, place);
        lao__failure_text(text, sizeof text, vsf__items[item].text, place, arguments);
        va_end(arguments);
        host->log(host->user, item, vsf__items[item].result, text);
    }
    return vsf__items[item].result;
}

static lao_allocator vsf__allocator(const vsf_host *host) {
    return lao__allocator_or_default(host ? &host->allocator : NULL);
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
    const lao_job *job = progress->host ? &progress->host->job : NULL;
    const uint32_t batch = 64;
    uint32_t chunks = items / chunk + (items % chunk != 0);
    vsf__work work;
    work.fn = fn;
    work.arg = arg;
    work.items = items;
    work.chunk = chunk;
    for (work.offset = 0; work.offset < chunks; work.offset += batch) {
        uint32_t count = chunks - work.offset < batch ? chunks - work.offset : batch;
        uint64_t units = (uint64_t)count * chunk;
        lao__job_run(job, count, vsf__work_chunk, &work);
        progress->done += units;
        if (progress->done > progress->total) {
            progress->done = progress->total;
        }
        if (lao__job_cancelled(job, progress->done, progress->total)) {
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
