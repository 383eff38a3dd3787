/* The passes of shaders/vessel_*.glsl behind the tracing, in C over arrays of texels: what a GPU's
 * images are compared with, and what the oracles of METHODS.md 6 and 7 are asked of. */
#ifndef SCREEN_PASSES_H
#define SCREEN_PASSES_H

#include "sdfvessel.h"

enum { SCREEN_LEVELS = 12 };

typedef lao_v4 *screen_pyramid[SCREEN_LEVELS];

typedef struct screen {
    uint32_t width, height, levels;
    lao_frame_uniforms frame;
    float threshold, period, recycle, converge, set;
    int guide, sweeps;
    const lao_v4 *cones;      /* two each; for SDV_GUIDE_OWN of trees */
    const uint8_t *colors;    /* RGBA, two each; for marks; NULL: none */
    const float *pattern;     /* of sdv_object; NULL: none */
    const lao_v4 *directions; /* of what is not a tree; else NULL */
    screen_pyramid depth, filled, place, facing, tensor, spread, along, across, recalled, phase,
        swept; /* scratch of the sweeps */
    lao_v4 *surface, *bgnormal, *uv, *ink;
    lao_v4 *surface_before, *uv_before, *ink_before; /* of the last frame */
    float values[SDV_SETTING_COUNT];                 /* of the void and the ink */
} screen;

/* Takes its memory and the settings' defaults; false: no memory. */
bool screen_make(screen *s, uint32_t width, uint32_t height);
void screen_free(screen *s);
void screen_size(const screen *s, uint32_t level, uint32_t *width, uint32_t *height);

/* What vessel_drawn makes of depth, or (NULL) of the positions that are there. */
void screen_drawn(const screen *s, const float *depth, lao_v4 *position, lao_v4 *normal);
/* In the order of the graph. position: world, cone (-1: nothing); normal: world. */
void screen_background(screen *s, const lao_v4 *position, const lao_v4 *normal);
void screen_guide(screen *s);
void screen_parameterize(screen *s);
/* Without field occlusion. ray: as traced, NULL: no depth shadows. */
void screen_ink(screen *s, const lao_v4 *position, const lao_v4 *normal, const lao_v4 *ray);
/* One coarse to fine run from given directions (along, across, place of all levels) alone. */
void screen_phases(screen *s);
/* This frame becomes the last one. */
void screen_next(screen *s);

#endif
