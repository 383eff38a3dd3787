/* See volume_checks.h. */
#include "volume_checks.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

bool volume_warns(const io_volume *volume, const char *word) {
    for (uint32_t i = 0; i < volume->warning_count; i++)
        if (strstr(volume->warnings[i], word))
            return true;
    return false;
}

void assert_volume(const io_volume *v, uint32_t frames, bool mask, bool origin) {
    size_t inside = 0;
    double low = INFINITY, high = 0;
    assert_int_equal(v->size[0], SIZE_X);
    assert_int_equal(v->size[1], SIZE_Y);
    assert_int_equal(v->size[2], SIZE_Z);
    assert_int_equal(v->frame_count, frames);
    assert_true(fabs(v->time_step - (frames > 1 ? sample_step : 0)) < 1e-5);
    assert_true(fabs(v->period - (frames > 1 ? sample_step * frames : 0)) < 1e-5);
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++) {
            double expected = column == 3     ? (origin ? sample_origin[row] : 0)
                              : row == column ? sample_spacing[row]
                                              : 0;
            assert_true(fabs(v->to_mm[row][column] - expected) < 1e-9);
        }
    assert_true(mask == (v->mask != NULL));
    for (size_t i = 0; i < VOXELS; i++) {
        inside += !mask || sample_inside(i);
        if (mask)
            assert_int_equal(v->mask[i], sample_inside(i));
        for (unsigned f = 0; f < frames; f++) {
            double squared = 0;
            for (unsigned k = 0; k < 3; k++) {
                double got = (double)v->velocity[3 * (i + VOXELS * f) + k];
                assert_true(fabs(got - sample_velocity(i, k, f)) < 1e-6);
                squared += got * got;
            }
            if (!mask || sample_inside(i)) {
                low = fmin(low, sqrt(squared));
                high = fmax(high, sqrt(squared));
            }
        }
    }
    assert_true(v->mask_voxels == inside);
    assert_true(fabs(v->speed[0] - low) < 1e-6 && fabs(v->speed[1] - high) < 1e-6);
}

io_volume must_read_volume(const buffer *files, uint32_t count, const io_volume_options *options) {
    io_volume volume = {0};
    io_error error;
    uint32_t failed = 99;
    if (!read_sample(files, count, options, &volume, &failed, &error))
        fail_msg("file %u: %s", failed, error.text);
    return volume;
}

void must_fail_volume(const buffer *files, uint32_t count, const io_volume_options *options,
                      uint32_t at, const char *word) {
    io_volume volume, before;
    io_error error = {""};
    uint32_t failed = 99;
    memset(&volume, 0x5A, sizeof volume);
    before = volume;
    assert_false(read_sample(files, count, options, &volume, &failed, &error));
    assert_memory_equal(&volume, &before, sizeof volume);
    if (!strstr(error.text, word))
        fail_msg("'%s' is missing in: %s", word, error.text);
    assert_int_equal(failed, at);
}
