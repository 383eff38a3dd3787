/* One case: a scene at a size, every preset on every backend, in turn. */
#ifndef LINEAO_BENCH_CASE_H
#define LINEAO_BENCH_CASE_H

#include <cJSON.h>
#include <stdbool.h>
#include <stdint.h>

enum { BENCH_PRESETS = 3, BENCH_BACKENDS = 2, BENCH_FRAMES = 99, BENCH_WARM_UP = 2 };

typedef struct bench_case {
    const char *path;    /* NULL: the embedded scene */
    uint32_t line_count; /* of the embedded scene */
    uint32_t width, height, supersampling;
    const char *presets[BENCH_PRESETS];
    uint32_t preset_count;
    const char *halo; /* of all presets, so that they differ in the occlusion alone */
    const char *backends[BENCH_BACKENDS];
    uint32_t backend_count;
    uint32_t frames; /* measured, after BENCH_WARM_UP */
} bench_case;

/* Measures: to be run in a process of its own. NULL: reported. */
cJSON *bench_case_run(const bench_case *it);

/* Draws three frames of the first preset on the first backend alone, and tells the most memory
 * that the process had: to be run in a process of its own. NULL: reported. */
cJSON *bench_case_memory(const bench_case *it);

#endif
