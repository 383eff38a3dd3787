/* What the tests of the core share: a host that counts and refuses memory and keeps the log, and
   the null backend with a window in it: what is uploaded and executed can be looked at. */
#ifndef CORE_HOST_H
#define CORE_HOST_H

#include "lent.h"

typedef struct core_host {
    lent_memory memory;
    uint32_t logs; /* so far */
    uint32_t seen[LAO_LOG_ITEM_COUNT];
    lao_log_item item; /* the last one */
    lao_result result;
    char text[1200];
} core_host;

/* All zero is a fresh host. */
lao_logger core_logger(core_host *host);

enum { CORE_BUFFERS = 64, CORE_TEXELS = 256 };

/* What went through the seam since core_window_clear. One window for the whole program. */
typedef struct core_window {
    uint32_t max_buffer_texels, max_texture_units,
        max_image_size; /* 0: those of the null backend */
    uint32_t buffer_count, buffers_alive;
    struct {
        lao_format format;
        uint32_t texel_count;
        float texels[4 * CORE_TEXELS];
    } buffers[CORE_BUFFERS];
    lao_frame_uniforms frame;
    float settings[64];
    uint32_t executions, prepares, parity, set_count;
    const lao_plan *plan;
} core_window;
extern core_window core_seen;

void core_window_clear(void);
/* The null backend behind the window. `fail_at`: the n-th backend call fails, 0: none. */
lao_backend core_backend(uint32_t fail_at);

/* The camera of many tests: at the origin, looking along -z with 90 degrees, clip depth [0, w],
 * near 1, far 100. */
lao_camera core_camera(void);

/* Even, repeatable numbers: [0, 2^32) and [low, high]. */
uint32_t core_random(uint32_t *state);
double core_between(uint32_t *state, double low, double high);

#endif
