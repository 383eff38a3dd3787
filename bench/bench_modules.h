/* Floors: passes of a further module that cost what a pass of lineao cannot do without.
 *
 *   floor_lines    the quads of the line pass, by its own vertex stage, one flat colour, one target
 *   floor_taps     32 + 16 + 11 reads of the pyramid at literal offsets, summed, nothing else, on
 *                  every pixel: its time over all pixels is what a covered one cannot do without
 *   floor_gouraud  a mesh with light at its vertices, one target (bench_surface.c has its row)
 *   floor_ball     a ray a pixel to one ball, by its formula, with the outputs of the vessel trace
 *                  (bench_vessel.c has its row)
 *
 * They run in the frame of the passes that they stand beside, so that what disturbs the one
 * disturbs the other. */
#ifndef LINEAO_BENCH_MODULES_H
#define LINEAO_BENCH_MODULES_H

#include "lineao.h"

#include <stdbool.h>

enum { BENCH_SETTINGS = 64 };

/* One module; it must outlive the contexts that it is given to, and not move. */
typedef struct bench_floors {
    lao_module module;
    lao_pass_row passes[2];
    lao_image_row images[3];
    lao_setting_row settings[BENCH_SETTINGS];
    char names[BENCH_SETTINGS][32];
} bench_floors;

/* Makes the module for line sets with these settings: their `width` goes into the quads. */
const lao_module *bench_floors_make(bench_floors *floors, const lao_settings *settings);

/* The shaders of all floors. */
const lao_shader *bench_floor_shaders(uint32_t *count);

/* Was glslangValidator there at build time, so that the floors run on Vulkan too? */
bool bench_floors_have_words(void);

#endif
