/* Proves that a still surface keeps its shading while lines move elsewhere: from frame to frame of
 * an animation its occlusion changes by at most 0.2 % of the full range where nothing within reach
 * of its samples changed, and measures how much it changes where only the pixel itself stayed as it
 * was, for our pattern of sample directions and for those of white noise. */
#include "c_passes.h"

#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static render_device *const gl = &render_devices[RENDER_GL];

enum { SIZE = 300, FRAMES = 5 };

/* Pathlines of a heart beat, one in `share`, among lines that stay: their time is the frame's. */
static void scene_build(render_lines *moving, render_lines *still, uint32_t share) {
    scene_lines beat;
    assert_true(scene_make("aorta", 700, 0, &beat));
    for (uint32_t line = 0; line < beat.line_count; line++) {
        for (uint32_t i = beat.offsets[line]; i < beat.offsets[line + 1]; i++) {
            const float *p = beat.points + 3 * (size_t)i;
            render_lines *to = line % share == 0 ? moving : still;
            render_point(to, (double)p[0], (double)p[1], (double)p[2]);
            to->times[to->point_count - 1] = beat.times[i];
        }
        render_line(line % share == 0 ? moving : still);
    }
    scene_free(&beat);
}

/* Both as one set, so that they shade each other. */
static render_lines joined(const render_lines *moving, const render_lines *still, double time) {
    render_lines all = {0};
    for (int k = 0; k < 2; k++) {
        const render_lines *from = k ? still : moving;
        for (uint32_t line = 0; line < from->line_count; line++) {
            for (uint32_t i = from->offsets[line]; i < from->offsets[line + 1]; i++) {
                const float *p = from->points + 3 * (size_t)i;
                render_point(&all, (double)p[0], (double)p[1], (double)p[2]);
                all.times[all.point_count - 1] = k ? (float)time : from->times[i];
                memset(all.colors + 4 * (size_t)(all.point_count - 1), 180, 4);
            }
            render_line(&all);
        }
    }
    return all;
}

/* ---- patterns ------------------------------------------------------------------------------ */

static lao_v3 white(uint32_t seed, uint32_t x, uint32_t y) {
    uint32_t state = lao_hash(seed * 0x9e3779b9u + lao_hash(y * 1024u + x));
    for (;;) { /* rejection: even on the sphere */
        float v[3], length2 = 0;
        for (int k = 0; k < 3; k++) {
            state = state * 1664525u + 1013904223u;
            v[k] = (float)(state >> 8) / 8388608.0f - 1.0f;
            length2 += v[k] * v[k];
        }
        if (length2 > 1e-3f && length2 <= 1)
            return lao_v3_scale(lao_v3_make(v[0], v[1], v[2]), 1.0f / sqrtf(length2));
    }
}

/* A texture of 1024 x 1024 over the screen, as Koehler 2017, 4.4 */
static lao_v3 white_texture(uint32_t frame, uint32_t x, uint32_t y) {
    (void)frame;
    return white(1, x & 1023, y & 1023);
}

static lao_v3 white_each_frame(uint32_t frame, uint32_t x, uint32_t y) {
    return white(frame + 2, x, y);
}

static const struct {
    const char *name;
    lao_v3 (*noise)(uint32_t frame, uint32_t x, uint32_t y);
} patterns[] = {{"ours, a hash of the pixel", NULL},
                {"white noise, one texture", white_texture},
                {"white noise, new in each frame", white_each_frame}};
enum { PATTERNS = sizeof patterns / sizeof *patterns };

/* ---- measures ------------------------------------------------------------------------------ */

typedef struct measure {
    double sum, largest;
    uint32_t count;
} measure;

static void add(measure *m, double difference) {
    m->sum += difference;
    m->largest = fmax(m->largest, difference);
    m->count++;
}

static int same_texel(const c_inputs *a, const c_inputs *b, size_t i) {
    return memcmp(a->color->data + 4 * i, b->color->data + 4 * i, 4) == 0 &&
           memcmp(a->tangent->data + 8 * i, b->tangent->data + 8 * i, 8) == 0 &&
           memcmp(a->depth->data + 4 * i, b->depth->data + 4 * i, 4) == 0;
}

/* sums[(y + 1) * (SIZE + 1) + x + 1]: texels that changed in [0, x] x [0, y] */
static void changes(const c_inputs *a, const c_inputs *b, uint32_t *sums) {
    memset(sums, 0, (SIZE + 1) * (SIZE + 1) * sizeof *sums);
    for (size_t y = 0; y < SIZE; y++) {
        for (size_t x = 0; x < SIZE; x++) {
            size_t at = (y + 1) * (SIZE + 1) + x + 1;
            sums[at] = sums[at - 1] + sums[at - SIZE - 1] - sums[at - SIZE - 2] +
                       !same_texel(a, b, y * SIZE + x);
        }
    }
}

/* Did anything change that a sample of this pixel can read, on any level? */
static int reached(const uint32_t *sums, const c_inputs *in, int x, int y, float zoom) {
    const lao_settings *s = &in->settings;
    uint32_t top = (uint32_t)s->levels - 1;
    float radius = lao_sample_radius(zoom, s->radius, s->width, s->radius_step, top);
    int r = (int)ceilf(lao_max(radius, 1.5f * (float)(1u << top))) + (2 << top);
    int x0 = x - r < 0 ? 0 : x - r, x1 = x + r >= SIZE ? SIZE : x + r + 1;
    int y0 = y - r < 0 ? 0 : y - r, y1 = y + r >= SIZE ? SIZE : y + r + 1;
    return sums[y1 * (SIZE + 1) + x1] - sums[y0 * (SIZE + 1) + x1] - sums[y1 * (SIZE + 1) + x0] +
               sums[y0 * (SIZE + 1) + x0] !=
           0;
}

static void compare(const c_inputs *a, const c_inputs *b, const render_image *ao_a,
                    const render_image *ao_b, measure out[2]) {
    static uint32_t sums[(SIZE + 1) * (SIZE + 1)];
    float *zooms = render_floats(a->tangent, 3);
    changes(a, b, sums);
    for (int y = 0; y < SIZE; y++) {
        for (int x = 0; x < SIZE; x++) {
            size_t i = (size_t)y * SIZE + (size_t)x;
            double difference = fabs((double)((const float *)(const void *)ao_a->data)[i] -
                                     (double)((const float *)(const void *)ao_b->data)[i]);
            if (a->color->data[4 * i + 3] == 0 || !same_texel(a, b, i))
                continue;
            add(&out[1], difference);
            if (!reached(sums, a, x, y, zooms[i]))
                add(&out[0], difference);
        }
    }
    free(zooms);
}

static void animate(uint32_t share) {
    static render_result results[FRAMES];
    static c_inputs inputs[FRAMES];
    measure measures[PATTERNS][2];
    render_lines moving = {0}, still = {0};
    lao_settings settings;
    render_need(gl);
    scene_build(&moving, &still, share);
    print_message("one line in %u moves\n", share);
    memset(measures, 0, sizeof measures);
    memset(&settings, 0, sizeof settings);
    settings.supersampling = 1;
    settings.samples = 31; /* the loop: compiles sooner */
    settings.trail = LAO_TRAIL_TAPER;
    for (int f = 0; f < FRAMES; f++) { /* 1/100 of a beat apart */
        render_lines all = joined(&moving, &still, 400 + 8.33 * f);
        render_shot shot;
        memset(&shot, 0, sizeof shot);
        shot.width = shot.height = SIZE;
        shot.camera = render_camera(0.2, 0.1, 1, 300);
        render_perspective(&shot.camera, 30, 1, 10, 900);
        shot.lines[0] = &all;
        shot.settings[0] = &settings;
        shot.set_count = 1;
        shot.time = (float)(400 + 8.33 * f);
        render_draw(gl, &shot, &results[f]);
        c_inputs_find(&inputs[f], &results[f], &settings);
        render_lines_free(&all);
    }
    for (int p = 0; p < PATTERNS; p++) {
        render_image aos[FRAMES];
        for (int f = 0; f < FRAMES; f++) {
            inputs[f].noise = patterns[p].noise;
            inputs[f].noise_frame = (uint32_t)f;
            aos[f] = c_occlusion(&inputs[f]);
            if (p == 0 && gl->software)
                assert_int_equal(render_compare("occlusion", &aos[f], inputs[f].ao).texels, 0);
        }
        for (int f = 1; f < FRAMES; f++)
            compare(&inputs[f - 1], &inputs[f], &aos[f - 1], &aos[f], measures[p]);
        for (int f = 0; f < FRAMES; f++)
            c_free(&aos[f]);
    }
    for (int p = 0; p < PATTERNS; p++) {
        const measure *m = measures[p];
        print_message("%-31s nothing in reach changed: %.4f %% (largest %.4f %%, %u pixels); "
                      "same texel: %.4f %% (largest %.1f %%, %u pixels)\n",
                      patterns[p].name, 100 * m[0].sum / fmax(m[0].count, 1), 100 * m[0].largest,
                      m[0].count, 100 * m[1].sum / m[1].count, 100 * m[1].largest, m[1].count);
        assert_true(m[1].count > 10000 && m[1].count > 2 * m[0].count);
    }
    if (share > 2) { /* else there is no such pixel */
        assert_true(measures[0][0].count > 10000);
        assert_true(measures[0][0].sum / measures[0][0].count <= 0.002);
        assert_true(measures[0][0].largest == 0); /* a pattern that stays: not at all */
        assert_true(measures[2][0].sum / measures[2][0].count > 0.002); /* the measure tells */
    }
    /* no worse than a texture of white noise, within what another seed would change */
    assert_true(measures[0][1].sum <= 1.05 * measures[1][1].sum);
    assert_true(measures[0][1].sum < measures[2][1].sum);
    for (int f = 0; f < FRAMES; f++)
        render_free(&results[f]);
    render_lines_free(&moving);
    render_lines_free(&still);
}

static void test_patterns(void **state) {
    (void)state;
    animate(12);
    animate(2);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_patterns)};
    return cmocka_run_group_tests(tests, render_open_opengl, render_close_both);
}
