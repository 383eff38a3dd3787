/* The full-screen passes in C: for each shader of the line module a loop over pixels that calls the
 * functions of lineao.h in the shader's order, on raw texels as the device stored them. */
#ifndef C_PASSES_H
#define C_PASSES_H

#include "render_host.h"

enum { C_MOST_LEVELS = 8 };

/* What the passes read. Images that do not exist in the frame at hand are NULL. */
typedef struct c_inputs {
    lao_frame_uniforms frame;
    lao_settings settings; /* filled */
    const render_image *color, *tangent, *depth, *zbuffer, *shaded, *out, *ao;
    const render_image *tensor[C_MOST_LEVELS]; /* from level 1 on */
    const render_image *level[C_MOST_LEVELS], *level_tangent[C_MOST_LEVELS];
    lao_v3 (*noise)(uint32_t frame, uint32_t x, uint32_t y); /* NULL: lao_pixel_noise */
    uint32_t noise_frame;
} c_inputs;

void c_inputs_find(c_inputs *in, const render_result *result, const lao_settings *settings);

typedef struct c_level {
    render_image tensor, words, tangent;
} c_level;

/* Each makes images for c_free, named and sized as those of the graph. */
c_level c_level_zero(const c_inputs *in);
c_level c_level_up(const c_inputs *in, uint32_t level);
render_image c_occlusion(const c_inputs *in);
render_image c_smooth(const c_inputs *in, const render_image *ao, int dx, int dy);
render_image c_shade(const c_inputs *in);
render_image c_resolve(const c_inputs *in);
/* Over a target of grey `before`; `format` RGBA8 or RGBA32F. */
render_image c_present(const c_inputs *in, lao_format format, float before);
render_image c_export_depth(const c_inputs *in, const render_image *before);
void c_free(render_image *image);

#endif
