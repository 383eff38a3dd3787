/* A backend without a window, and frames on it that are timed from call to fence. */
#ifndef LINEAO_BENCH_DEVICE_H
#define LINEAO_BENCH_DEVICE_H

#include "lineao.h"

#include <stdbool.h>

typedef struct bench_device {
    const char *backend; /* "gl" or "vk" */
    lao_backend functions;
    struct host_gl *gl;
    struct host_vk *vk;
    void (*finish)(void); /* glFinish */
} bench_device;

/* False: reported; close it in any case. */
bool bench_device_open(bench_device *device, const char *backend);

/* After its contexts; fine on {0}. */
void bench_device_close(bench_device *device);

/* Driver and device in words. */
const char *bench_device_name(const bench_device *device);

/* A context on the device, with a further module unless that is NULL. Failures of the context are
 * reported as they happen. */
bool bench_device_context(bench_device *device, const lao_module *module, lao_context **context);

/* Draws a frame and waits for its end. False: reported. */
bool bench_device_frame(bench_device *device, lao_context *context, const lao_frame *frame,
                        double *milliseconds);

#endif
