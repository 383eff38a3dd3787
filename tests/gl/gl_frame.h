/* A tiny frame through the seam, written by hand so that executors are tested without any effect:
   all kinds of passes, formats, tests, blends, clears, history, a hole among the outputs, a missing
   input and a target of the host. */
#ifndef GL_FRAME_H
#define GL_FRAME_H

#include "lent.h"

enum {
    GL_FRAME_SIZE = 24,
    GL_FRAME_STEPS = 5,
    GL_FRAME_SLOTS = 5,
    GL_FRAME_INSTANCES = 6,
    GL_FRAME_SETS = 2,
    GL_FRAME_MODULES = 2,
    GL_FRAME_SETTINGS = 256 /* floats of a block: as many as any shader wants */
};

/* What the core would be: memory, log. */
typedef struct gl_frame_core {
    lao_host host;
    lao_graph graph; /* its number of modules */
    lent_memory memory;
    int logs;
    lao_log_item item;
    char text[2048];
} gl_frame_core;

typedef struct gl_frame {
    lao_plan plan;
    lao_plan_step steps[GL_FRAME_STEPS];
    lao_plan_instance instances[GL_FRAME_INSTANCES];
    lao_plan_slot slots[GL_FRAME_SLOTS];
    lao_execution execution;
    lao_draw draws[GL_FRAME_SETS];
    lao_chunk chunk;
    lao_frame_uniforms frame_uniforms;
    float settings[GL_FRAME_SETS * GL_FRAME_MODULES * GL_FRAME_SETTINGS];
} gl_frame;

extern const lao_shader *const gl_frame_shaders[GL_FRAME_STEPS];

void gl_frame_core_init(gl_frame_core *core);
/* The plan for images of this size. */
void gl_frame_init(gl_frame *frame, uint32_t size);
/* The line set, in buffers of the backend. */
lao_result gl_frame_lines_create(gl_frame *frame, const lao_backend *backend, void *self);
void gl_frame_lines_destroy(gl_frame *frame, const lao_backend *backend, void *self);

#endif
