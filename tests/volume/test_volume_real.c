/* Volumes that others made are read as independent readers read them: sizes, spacing, masks and
 * speeds are those of data/INDEX.md, and the flow of a simulation has no divergence, as it must
 * when axes and components belong together. */
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

static bool read_real(const char *name, const io_volume_options *options, io_volume *out) {
    const char *folder = getenv("LINEAO_DATA");
    char path[1024];
    const char *paths[] = {path};
    io_error error;
    snprintf(path, sizeof path, "%s/flow/%s", folder ? folder : LINEAO_SOURCE_DIR "/../shared/data",
             name);
    FILE *file = fopen(path, "rb");
    if (!file) {
        print_message("%s is not there; LINEAO_DATA names the folder of real data\n", name);
        return false;
    }
    fclose(file);
    assert_true(io_is_volume(path));
    if (!io_read_volume(paths, 1, options, out, NULL, &error))
        fail_msg("%s: %s", name, error.text);
    return true;
}

static void assert_near(double got, double expected, double within) {
    if (!(fabs(got - expected) <= within))
        fail_msg("%.9g is not %.9g", got, expected);
}

static void assert_size(const io_volume *v, uint32_t x, uint32_t y, uint32_t z) {
    assert_int_equal(v->size[0], x);
    assert_int_equal(v->size[1], y);
    assert_int_equal(v->size[2], z);
    assert_int_equal(v->frame_count, 1);
    assert_true(v->time_step == 0 && v->period == 0);
}

/* Squared divergence over the squared derivatives that it is made of, where all neighbours are
 * inside; and the same with the components in another order. */
static double divergence(const io_volume *v, const uint32_t order[3]) {
    const size_t step[3] = {1, v->size[0], (size_t)v->size[0] * v->size[1]};
    double squares = 0, parts = 0;
    for (size_t i = step[2]; i + step[2] < step[2] * v->size[2]; i++) {
        double sum = 0, own = 0;
        bool inside = v->mask[i];
        for (int k = 0; k < 3; k++) {
            double d = (double)v->velocity[3 * (i + step[k]) + order[k]] -
                       (double)v->velocity[3 * (i - step[k]) + order[k]];
            inside = inside && v->mask[i + step[k]] && v->mask[i - step[k]];
            sum += d;
            own += d * d;
        }
        squares += inside ? sum * sum : 0;
        parts += inside ? own : 0;
    }
    return squares / parts;
}

static void aorta(void **state) {
    static const uint32_t right[3] = {0, 1, 2}, wrong[3] = {2, 1, 0};
    (void)state;
    io_volume v = {0};
    if (!read_real("4dflownet_aorta_HR.h5", NULL, &v))
        skip(); /* does not return */
    double largest = 0;
    assert_string_equal(v.format, "hdf5");
    assert_size(&v, 84, 76, 72);
    for (int k = 0; k < 3; k++)
        assert_near(v.to_mm[k][k], 0.5938, 5e-5);
    assert_near((double)v.mask_voxels / (84 * 76 * 72), 0.122, 5e-4);
    for (size_t i = 0; i < (size_t)84 * 76 * 72; i++) {
        const float *p = v.velocity + 3 * i;
        largest = fmax(largest, sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])));
    }
    assert_near(largest, 0.849, 5e-4);
    assert_near(v.speed[1], largest, 1e-6);
    print_message("divergence %.4f, with axes exchanged %.4f\n", divergence(&v, right),
                  divergence(&v, wrong));
    assert_true(divergence(&v, right) < 0.05);
    assert_true(divergence(&v, wrong) > 0.5);
    assert_int_equal(v.warning_count, 0);
    io_volume_free(&v);
}

static void noisy_aorta(void **state) {
    (void)state;
    io_volume v = {0};
    if (!read_real("4dflownet_aorta_LR.h5", NULL, &v))
        skip(); /* does not return */
    double largest = 0;
    assert_size(&v, 42, 38, 36);
    assert_near(v.to_mm[2][2], 1.188, 5e-4);
    assert_near((double)v.mask_voxels / (42 * 38 * 36), 0.119, 5e-4);
    for (size_t i = 0; i < (size_t)42 * 38 * 36; i++) {
        const float *p = v.velocity + 3 * i;
        largest = fmax(largest, sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])));
    }
    assert_near(largest, 2.57, 5e-3); /* noise; inside it is slower */
    assert_true(v.speed[1] < 1);
    assert_int_equal(v.array_count, 7);
    io_volume_free(&v);
}

static void carotid(void **state) {
    (void)state;
    io_volume v = {0};
    io_volume_options options;
    memset(&options, 0, sizeof options);
    if (!read_real("carotid.vtk", &options, &v))
        skip(); /* does not return */
    assert_string_equal(v.format, "vtk");
    assert_size(&v, 76, 49, 45);
    const double box[2][3] = {{100, 80, 1}, {175, 128, 45}};
    for (int k = 0; k < 3; k++) {
        assert_near(v.to_mm[k][3], box[0][k], 0);
        assert_near(v.to_mm[k][3] + v.to_mm[k][k] * (v.size[k] - 1), box[1][k], 0);
    }
    assert_near(v.speed[0], 0, 0);
    assert_near(v.speed[1], 22.69, 6e-3);
    assert_true(!v.mask && volume_warns(&v, "--unit"));
    io_volume_free(&v);
    options.unit = "cm/s";
    assert_true(read_real("carotid.vtk", &options, &v));
    assert_near(v.speed[1], 0.2269, 6e-5);
    assert_int_equal(v.warning_count, 0);
    io_volume_free(&v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(aorta),
        cmocka_unit_test(noisy_aorta),
        cmocka_unit_test(carotid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
