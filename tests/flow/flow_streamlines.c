/* Streamlines of a raw steady grid, for vtk_streamlines.py: standard input to standard output.
 * In:  uint32 nx ny nz, seeds, steps; float64 spacing origin step; float32 velocities (x fastest);
 *      float64 x y z per seed. Out: per seed the float64 x y z after `steps` steps, NaN where the
 *      line ended before. */
#define FLOW4D_IMPLEMENTATION
#include "flow4d.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int fail(const char *what) {
    fprintf(stderr, "flow_streamlines: %s\n", what);
    return 1;
}

static int walk(const flow4d_sampler *sampler, uint32_t steps, double step, double x[3]) {
    for (uint32_t k = 0; k < steps; k++) {
        if (flow4d_step(sampler, FLOW4D_RK4, FLOW4D_MASK_NEAREST, 0.0, step, 0.0, x) != 0)
            return -1;
    }
    return 0;
}

int main(void) {
    uint32_t head[5];
    double scale[7]; /* spacing, origin, step */
    flow4d_field field;
    flow4d_sampler sampler;
    memset(&field, 0, sizeof field);
    if (fread(head, 4, 5, stdin) != 5 || fread(scale, 8, 7, stdin) != 7)
        return fail("no header");
    for (size_t a = 0; a < 3; a++) {
        field.size[a] = head[a];
        field.to_world[5 * a] = scale[a];
        field.to_world[4 * a + 3] = scale[3 + a];
        if (head[a] == 0 || head[a] > 1024)
            return fail("a size is not 1 to 1024");
    }
    size_t floats = 3 * (size_t)head[0] * head[1] * head[2];
    float *velocity = malloc(floats * sizeof *velocity);
    field.velocity = velocity;
    field.frame_count = 1;
    int ok = velocity && fread(velocity, 4, floats, stdin) == floats &&
             flow4d_sampler_make(NULL, &field, &sampler) == LAO_OK;
    for (uint32_t i = 0; ok && i < head[3]; i++) {
        double x[3];
        ok = fread(x, 8, 3, stdin) == 3;
        if (ok && walk(&sampler, head[4], scale[6], x) != 0)
            x[0] = x[1] = x[2] = (double)NAN;
        ok = ok && fwrite(x, 8, 3, stdout) == 3;
    }
    free(velocity);
    return ok ? 0 : fail("the input is short or the field is refused");
}
