/* Proves that results do not depend on the number of threads, to the bit, and that memory is asked
 * for on the caller's thread alone. */
#include "flow_host.h"
#include "flow_phantom.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RUNS = 4 };
static const uint32_t threads[RUNS] = {0, 1, 2, 7};

static void check_same(const flow4d_lines *a, const flow4d_lines *b) {
    assert_int_equal(a->line_count, b->line_count);
    assert_int_equal(a->point_count, b->point_count);
    size_t n = sizeof(float) * a->point_count;
    assert_memory_equal(a->offsets, b->offsets, 4 * (size_t)a->line_count + 4);
    assert_memory_equal(a->points, b->points, 3 * n);
    assert_memory_equal(a->times, b->times, n);
    assert_memory_equal(a->speeds, b->speeds, n);
    assert_memory_equal(a->vorticity, b->vorticity, n);
    assert_memory_equal(a->curvature, b->curvature, n);
}

static void lines_do_not_depend_on_threads(void **state) {
    (void)state;
    flow4d_field grid, field;
    flow_phantom_field(&field);
    assert_true(flow_phantom_grid((const double[]){4, 4, 4}, 6, &grid));
    for (int method = 0; method < 2; method++) {
        flow4d_lines lines[RUNS];
        flow_host hosts[RUNS];
        flow4d_trace_settings s;
        memset(&s, 0, sizeof s);
        s.line_count = 300;
        s.method = (flow4d_method)method;
        s.span = FLOW4D_SPAN_LOOP;
        s.attributes = FLOW4D_VORTICITY | FLOW4D_CURVATURE;
        for (int i = 0; i < RUNS; i++) {
            flow_host_make(&hosts[i], threads[i]);
            assert_int_equal(flow4d_trace(&hosts[i].host, method ? &field : &grid, &s, &lines[i]),
                             LAO_OK);
            check_same(&lines[0], &lines[i]);
        }
        for (int i = 0; i < RUNS; i++) {
            flow4d_lines_free(&lines[i]);
            assert_int_equal(hosts[i].live, 0);
            assert_int_equal(hosts[i].wrong_calls, 0);
        }
    }
    flow_phantom_grid_free(&grid);
}

static void images_do_not_depend_on_threads(void **state) {
    (void)state;
    flow4d_field grid;
    assert_true(flow_phantom_grid((const double[]){4, 4, 4}, 6, &grid));
    size_t voxels = (size_t)grid.size[0] * grid.size[1] * grid.size[2];
    float *values[RUNS], *images[RUNS];
    lao_camera camera;
    memset(&camera, 0, sizeof camera);
    camera.view[0] = camera.view[9] = camera.view[15] = 1; /* along y */
    camera.view[6] = -1;
    camera.projection[0] = camera.projection[5] = 0.01f;
    camera.projection[10] = -0.005f;
    camera.projection[15] = 1;
    for (int i = 0; i < RUNS; i++) {
        flow_host h;
        flow4d_volume volume;
        flow_host_make(&h, threads[i]);
        values[i] = malloc(voxels * sizeof(float));
        images[i] = malloc(sizeof(float) * 100 * 90);
        assert_true(values[i] && images[i]);
        assert_int_equal(flow4d_temporal_maximum(&h.host, &grid, values[i]), LAO_OK);
        memset(&volume, 0, sizeof volume);
        memcpy(volume.size, grid.size, sizeof volume.size);
        memcpy(volume.to_world, grid.to_world, sizeof volume.to_world);
        volume.values = values[i];
        assert_int_equal(flow4d_project_maximum(&h.host, &volume, &camera, 100, 90, images[i]),
                         LAO_OK);
        assert_memory_equal(values[0], values[i], voxels * sizeof(float));
        assert_memory_equal(images[0], images[i], sizeof(float) * 100 * 90);
    }
    float brightest = 0;
    for (int i = 0; i < 100 * 90; i++)
        brightest = images[0][i] > brightest ? images[0][i] : brightest;
    assert_true(brightest > 0.5f);
    for (int i = 0; i < RUNS; i++) {
        free(values[i]);
        free(images[i]);
    }
    flow_phantom_grid_free(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_do_not_depend_on_threads),
        cmocka_unit_test(images_do_not_depend_on_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
