/* Proves that a mesh, its smoothing, buffers, measure, curvatures and near-wall distances have the
   same bits on four threads as on one. */
#include "surface_host.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { THREADS = 4 };

typedef struct share {
    void (*fn)(void *arg, uint32_t index);
    void *arg;
    uint32_t first, count;
} share;
static void *work(void *arg) {
    const share *s = (const share *)arg;
    for (uint32_t i = s->first; i < s->count; i += THREADS)
        s->fn(s->arg, i);
    return NULL;
}
static void run(void *user, uint32_t count, void (*fn)(void *arg, uint32_t index), void *arg) {
    pthread_t threads[THREADS];
    share shares[THREADS];
    (void)user;
    for (uint32_t i = 0; i < THREADS; i++) {
        shares[i].fn = fn;
        shares[i].arg = arg;
        shares[i].first = i;
        shares[i].count = count;
        assert_int_equal(pthread_create(threads + i, NULL, work, shares + i), 0);
    }
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
}

typedef struct results {
    vsf_mesh mesh;
    vsf_buffers buffers;
    vsf_near table;
    float *measure, *curvatures;
} results;

static results compute(const vsf_host *host, const surface_shape *shape) {
    static const float points[] = {0, 0, 0, 5, 0, 1, 5, 5, 0, 0, 5, -1, -5, 0, 0};
    static const float times[] = {0, 20, 45, 60, 90};
    const float eye[4] = {20, 9, 12, 1};
    vsf_mesh_desc desc = surface_describe(shape);
    vsf_near_desc lines;
    results r;
    assert_int_equal(vsf_mesh_build(host, &desc, &r.mesh), LAO_OK);
    assert_int_equal(vsf_mesh_smooth(host, &r.mesh, NULL), LAO_OK);
    assert_int_equal(vsf_buffers_make(host, &r.mesh, 0, &r.buffers), LAO_OK);
    r.measure = (float *)malloc(sizeof(float) * r.mesh.vertex_count);
    r.curvatures = (float *)malloc(sizeof(float) * 2 * r.mesh.vertex_count);
    assert_int_equal(vsf_measure(host, &r.buffers, eye, 0, r.measure), LAO_OK);
    assert_int_equal(vsf_curvatures(host, &r.mesh, r.curvatures, NULL), LAO_OK);
    memset(&lines, 0, sizeof lines);
    lines.vertex_count = r.mesh.vertex_count;
    lines.positions = r.mesh.positions;
    lines.point_count = 5;
    lines.points = points;
    lines.times = times;
    lines.step_count = 5;
    assert_int_equal(vsf_near_make(host, &lines, &r.table), LAO_OK);
    return r;
}
static void release(results *r) {
    vsf_near_free(&r->table);
    free(r->measure);
    free(r->curvatures);
    vsf_buffers_free(&r->buffers);
    vsf_mesh_free(&r->mesh);
}

static void threads_change_nothing(void **state) {
    surface_shape shape = surface_torus(5, 2, 200, 100);
    vsf_host host;
    results one, many;
    size_t v = shape.vertex_count;
    (void)state;
    memset(&host, 0, sizeof host);
    host.job.run = run;
    one = compute(NULL, &shape);
    many = compute(&host, &shape);
    assert_memory_equal(one.mesh.positions, many.mesh.positions, 12 * v);
    assert_memory_equal(one.mesh.normals, many.mesh.normals, 12 * v);
    assert_memory_equal(one.buffers.rings, many.buffers.rings, 16 * (size_t)one.buffers.ring_count);
    assert_memory_equal(one.measure, many.measure, 4 * v);
    assert_memory_equal(one.curvatures, many.curvatures, 8 * v);
    assert_memory_equal(one.table.values, many.table.values, 5 * 4 * v);
    assert_true(one.table.gamma == many.table.gamma);
    release(&one);
    release(&many);
    surface_shape_free(&shape);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(threads_change_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
