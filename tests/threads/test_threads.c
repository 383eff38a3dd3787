/* Proves that contexts share nothing: two threads, each with its own context, get what one thread
 * alone gets. */
#include "lineao.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { THREADS = 2, FRAMES = 20 };

typedef struct worker {
    uint32_t hash; /* of everything that the null backend would have done */
    lao_result result;
} worker;

static void hash_text(void *user, const char *text) {
    worker *w = (worker *)user;
    for (; *text; text++) {
        w->hash = (w->hash ^ (uint32_t)(unsigned char)*text) * 16777619u;
    }
}

/* A whole session: lines, frames of changing size and settings, destruction. */
static void *session(void *argument) {
    static const float points[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 2, 1, 1};
    static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const float projection[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -0.1f, 0, 0, 0, 0, 1};
    worker *w = (worker *)argument;
    lao_null_desc null = {hash_text, w, 0, NULL, 0};
    lao_backend backend;
    lao_desc desc;
    lao_context *context = NULL;
    lao_lines_desc set;
    lao_view_desc size = {64, 48, 0};
    lao_frame frame;
    lao_settings settings;
    lao_set sets[1];
    uint32_t i;
    memset(&desc, 0, sizeof desc);
    memset(&set, 0, sizeof set);
    memset(&frame, 0, sizeof frame);
    memset(&settings, 0, sizeof settings);
    memset(sets, 0, sizeof sets);
    lao_null_backend(&null, &backend);
    desc.backend = &backend;
    w->result = lao_create(&desc, &context);
    if (w->result != LAO_OK) {
        return NULL;
    }
    set.line_count = 1;
    set.point_count = 4;
    set.points = points;
    w->result = lao_lines_create(context, &set, &sets[0].lines);
    sets[0].settings = &settings;
    if (w->result == LAO_OK) {
        w->result = lao_view_create(context, &size, &frame.view);
    }
    memcpy(frame.camera.view, identity, sizeof identity);
    memcpy(frame.camera.projection, projection, sizeof projection);
    frame.sets = sets;
    frame.set_count = 1;
    for (i = 0; i < FRAMES && w->result == LAO_OK; i++) {
        settings.levels = (float)(1 + i % 8);
        settings.preset = (float)(i % 3);
        lao_view_resize(context, frame.view, 32 + i, 48);
        w->result = lao_render(context, &frame);
    }
    lao_destroy(context);
    return NULL;
}

static void threads_do_not_meet(void **state) {
    worker alone = {2166136261u, LAO_OK}, workers[THREADS];
    pthread_t threads[THREADS];
    int i;
    (void)state;
    session(&alone);
    assert_int_equal(alone.result, LAO_OK);
    assert_int_not_equal(alone.hash, 2166136261u);
    for (i = 0; i < THREADS; i++) {
        workers[i].hash = 2166136261u;
        workers[i].result = LAO_OK;
        assert_int_equal(pthread_create(&threads[i], NULL, session, &workers[i]), 0);
    }
    for (i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        assert_int_equal(workers[i].result, LAO_OK);
        assert_int_equal(workers[i].hash, alone.hash);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(threads_do_not_meet)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
