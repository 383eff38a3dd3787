/* The embedded scenes are well-formed, the same in every run, differ by seed, have the lines asked
 * for, and are made fast. */
#include "scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static void check_form(const scene_lines *s, const char *name) {
    assert_int_equal(s->offsets[0], 0);
    assert_int_equal(s->offsets[s->line_count], s->point_count);
    assert_true(s->width > 0.0f);
    for (uint32_t i = 0; i < s->line_count; i++) {
        uint32_t from = s->offsets[i], to = s->offsets[i + 1];
        assert_true(from <= to);
        if (strcmp(name, "bundle") == 0)
            assert_int_equal(to - from, 100);
        for (uint32_t k = from; s->times && k < to; k++) {
            assert_true(s->times[k] >= 0.0f && s->times[k] <= 833.001f);
            assert_true(k == from || s->times[k] > s->times[k - 1]);
            assert_true(s->values[k] >= 0.0f && s->values[k] < 5.0f);
        }
    }
    for (uint32_t i = 0; i < 3 * s->point_count; i++) {
        assert_true(isfinite(s->points[i]) && fabsf(s->points[i]) < 500.0f);
    }
}

static void check_equal(const scene_lines *a, const scene_lines *b) {
    assert_int_equal(a->line_count, b->line_count);
    assert_int_equal(a->point_count, b->point_count);
    assert_memory_equal(a->offsets, b->offsets, sizeof(uint32_t) * (a->line_count + 1));
    assert_memory_equal(a->points, b->points, 3 * sizeof(float) * a->point_count);
    assert_true(!a->times == !b->times && !a->values == !b->values);
    if (a->times)
        assert_memory_equal(a->times, b->times, sizeof(float) * a->point_count);
    if (a->values)
        assert_memory_equal(a->values, b->values, sizeof(float) * a->point_count);
}

static void scenes_are_well_formed(void **state) {
    (void)state;
    uint32_t count = 0;
    const char *const *names = scene_names(&count);
    assert_true(count >= 6);
    for (uint32_t i = 0; i < count; i++) {
        static const uint32_t sizes[] = {0, 1, 2, 137};
        assert_non_null(scene_help(names[i]));
        for (int k = 0; k < 4; k++) {
            scene_lines s, again;
            assert_true(scene_make(names[i], sizes[k], 0, &s));
            if (sizes[k])
                assert_int_equal(s.line_count, sizes[k]);
            check_form(&s, names[i]);
            assert_true(scene_make(names[i], sizes[k], 0, &again));
            check_equal(&s, &again);
            scene_free(&again);
            assert_true(scene_make(names[i], sizes[k], 1, &again));
            bool same = s.point_count == again.point_count && s.point_count > 0 &&
                        !memcmp(s.points, again.points, 3 * sizeof(float) * s.point_count);
            assert_true(strcmp(names[i], "stress") == 0 || !same);
            scene_free(&again);
            scene_free(&s);
            scene_free(&s);
        }
    }
}

static void unknown_names_are_refused(void **state) {
    (void)state;
    scene_lines s;
    assert_false(scene_make("cube", 0, 0, &s));
    assert_false(scene_make(NULL, 0, 0, &s));
    assert_null(scene_help("cube"));
}

/* The steps of a pathline fit its speeds, and no line leaves the vessel's box in a jump. */
static void speeds_fit_the_steps(void **state) {
    (void)state;
    scene_lines s;
    assert_true(scene_make("aorta", 500, 3, &s));
    for (uint32_t i = 0; i < s.line_count; i++) {
        for (uint32_t k = s.offsets[i] + 1; k + 1 < s.offsets[i + 1]; k++) {
            const float *p = &s.points[3 * k];
            float dx = p[3] - p[-3], dy = p[4] - p[-2], dz = p[5] - p[-1];
            float speed = sqrtf(dx * dx + dy * dy + dz * dz) / (s.times[k + 1] - s.times[k - 1]);
            assert_true(fabsf(speed - s.values[k]) < 2e-3f);
        }
    }
    scene_free(&s);
}

static void many_lines_take_little_time(void **state) {
    (void)state;
    uint32_t count = 0;
    const char *const *names = scene_names(&count);
    for (uint32_t i = 0; i < count; i++) {
        clock_t start = clock();
        scene_lines s;
        assert_true(scene_make(names[i], 10000, 0, &s));
        double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
        print_message("%-9s %6u lines %8u points %.2f s\n", names[i], s.line_count, s.point_count,
                      seconds);
        assert_true(seconds < 10.0 * LINEAO_SLOWDOWN); /* generous: busy machines */
        scene_free(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_are_well_formed),
        cmocka_unit_test(unknown_names_are_refused),
        cmocka_unit_test(speeds_fit_the_steps),
        cmocka_unit_test(many_lines_take_little_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
