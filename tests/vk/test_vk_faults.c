/* Whichever call of Vulkan fails, function is missing or allocation returns NULL: the public
 * function returns the matching error, logs exactly one item, leaks nothing, and works when it is
 * called again. And a plan that comes back makes no pipeline. */
#include "vk_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 16 };

/* One life of a context. Every step may be repeated after a failure. */
typedef struct life {
    fixture f;
    lao_context *context;
    lao_set sets[1];
    lao_settings settings; /* without occlusion, whose pipelines take long and fail like others */
    lao_view view;
    float data[SIZE * SIZE * 4 * 4];
} life;

static lao_result make_context(life *l) {
    return fixture_context(&l->f, 1, &l->context);
}

static lao_result make_lines(life *l) {
    lao_lines_desc desc = fixture_lines(0);
    l->settings = *fixture_settings();
    l->settings.set = LAO_SET(occlusion);
    l->sets[0].settings = &l->settings;
    return lao_lines_create(l->context, &desc, &l->sets[0].lines);
}

static lao_result change_lines(life *l) {
    lao_lines_desc desc = fixture_lines(1);
    return lao_lines_update(l->context, l->sets[0].lines, &desc);
}

static lao_result make_view(life *l) {
    lao_view_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.width = desc.height = SIZE;
    return lao_view_create(l->context, &desc, &l->view);
}

static lao_result draw(life *l) {
    lao_frame frame = fixture_frame(l->view, l->sets, 1);
    frame.flags = LAO_FRAME_TIMINGS;
    return fixture_render(&l->f, l->context, &frame);
}

static lao_result draw_larger(life *l) {
    lao_result result = lao_view_resize(l->context, l->view, 2 * SIZE, SIZE);
    assert_int_equal(result, LAO_OK);
    return draw(l);
}

static lao_result read_image(life *l) {
    lao_read_info info;
    fixture_wait(&l->f);
    return lao_read(l->context, l->view, "out", 0, l->data, sizeof l->data / sizeof l->data[0],
                    &info);
}

static lao_result read_times(life *l) {
    lao_timing timings[64];
    uint32_t count = 64;
    return lao_timings(l->context, l->view, timings, &count);
}

static const struct {
    const char *name;
    lao_result (*run)(life *l);
} steps[] = {
    {"lao_create", make_context},
    {"lao_lines_create", make_lines},
    {"lao_view_create", make_view},
    {"lao_render", draw},
    {"lao_read", read_image},
    {"lao_timings", read_times},
    {"lao_lines_update", change_lines},
    {"lao_render after a change", draw},
    {"lao_render after a resize", draw_larger},
};

/* Lives once, with faults already armed. Returns the number of steps that failed, each of which
 * succeeded when repeated; *result is what the last of them returned. */
static int live(life *l, lao_result *result) {
    int failures = 0;
    l->context = NULL;
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        l->f.logs = 0;
        lao_result first = steps[i].run(l);
        if (first == LAO_OK) {
            assert_int_equal(l->f.logs, 0);
            continue;
        }
        if (l->f.logs != 1)
            fail_msg("%s: %d log items, the last: %s", steps[i].name, l->f.logs, l->f.text);
        failures++;
        *result = first;
        lao_result again = steps[i].run(l);
        if (again != LAO_OK)
            fail_msg("%s, repeated after \"%s\": %s", steps[i].name, l->f.text,
                     lao_result_text(again));
    }
    fixture_wait(&l->f);
    lao_destroy(l->context);
    if (l->f.memory.bytes != 0)
        fail_msg("%ld bytes leak", l->f.memory.bytes);
    return failures;
}

/* Faults that end a life early: destroyed at once, without a second try. */
static void die(life *l) {
    l->context = NULL;
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        if (steps[i].run(l) != LAO_OK)
            break;
    }
    fixture_wait(&l->f);
    lao_destroy(l->context);
    assert_int_equal(l->f.memory.bytes, 0);
}

static void any_call_fails(void **state) {
    static const struct {
        VkResult injected;
        lao_result expected;
    } rows[] = {{VK_ERROR_OUT_OF_DEVICE_MEMORY, LAO_ERROR_OUT_OF_DEVICE_MEMORY},
                {VK_ERROR_OUT_OF_HOST_MEMORY, LAO_ERROR_OUT_OF_MEMORY},
                {VK_ERROR_DEVICE_LOST, LAO_ERROR_DEVICE_LOST},
                {VK_ERROR_UNKNOWN, LAO_ERROR_BACKEND}};
    static life l;
    int n, last = 1;
    (void)state;
    fixture_open(&l.f, 0);
    for (n = 1; last; n++) {
        int row = n % 4;
        lao_result result = LAO_OK;
        vk_wrap_reset();
        vk_wrap.fail_call = n;
        vk_wrap.result = rows[row].injected;
        last = live(&l, &result);
        if (last != (vk_wrap.failed != NULL) || (last && result != rows[row].expected))
            fail_msg("call %d, %s: %d failures, %s", n, vk_wrap.failed, last,
                     lao_result_text(result));
        if (last && !strstr(l.f.text, "vk") && l.f.logs)
            fail_msg("\"%s\" does not name %s", l.f.text, vk_wrap.failed);
    }
    assert_true(n > 100); /* the sweep reached the calls that it is about */
    print_message("%d calls\n", n - 2);
    fixture_close(&l.f);
}

static void any_call_fails_and_the_host_gives_up(void **state) {
    static life l;
    int n = 1;
    (void)state;
    fixture_open(&l.f, VK_API_VERSION_1_2);
    do {
        vk_wrap_reset();
        vk_wrap.fail_call = n;
        vk_wrap.result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
        die(&l);
        n += n < 40 ? 1 : 3;
    } while (vk_wrap.failed);
    fixture_close(&l.f);
}

static void any_function_is_missing(void **state) {
    static life l;
    int n = 1;
    (void)state;
    fixture_open(&l.f, 0);
    do {
        lao_result result;
        vk_wrap_reset();
        vk_wrap.fail_proc = n++;
        l.f.logs = 0;
        result = fixture_context(&l.f, 1, &l.context);
        if (result == LAO_OK) { /* optional, or known under another name */
            assert_int_equal(l.f.logs, 0);
            lao_destroy(l.context);
            continue;
        }
        assert_int_equal(result, LAO_ERROR_UNSUPPORTED);
        assert_int_equal(l.f.logs, 1);
        assert_int_equal(l.f.item, LAO_LOG_BACKEND_FUNCTION);
        if (!strstr(l.f.text, vk_wrap.hidden))
            fail_msg("\"%s\" does not name %s", l.f.text, vk_wrap.hidden);
        assert_int_equal(l.f.memory.bytes, 0);
    } while (vk_wrap.hidden[0]);
    assert_true(n > 60);
    fixture_close(&l.f);
}

static void any_allocation_fails(void **state) {
    static life l;
    uint32_t n = 1;
    (void)state;
    fixture_open(&l.f, 0);
    for (int failures = 1; failures; n++) {
        lao_result result = LAO_ERROR_OUT_OF_MEMORY;
        vk_wrap_reset();
        l.f.memory.allocations = 0;
        l.f.memory.fail_allocation = n;
        failures = live(&l, &result);
        assert_int_equal(result, LAO_ERROR_OUT_OF_MEMORY);
    }
    assert_true(n > 20);
    print_message("%u allocations\n", n - 2);
    fixture_close(&l.f);
}

static void a_plan_that_comes_back_makes_no_pipeline(void **state) {
    static const float halos[] = {LAO_HALO_NONE, LAO_HALO_UNIFORM, LAO_HALO_DEPTH};
    static life l;
    int made = 0;
    (void)state;
    fixture_open(&l.f, 0);
    vk_wrap_reset();
    assert_int_equal(make_context(&l), LAO_OK);
    assert_int_equal(make_lines(&l), LAO_OK);
    assert_int_equal(make_view(&l), LAO_OK);
    l.settings.set |= LAO_SET(halo);
    for (int i = 0; i < 6; i++) {
        l.settings.halo = halos[i % 3];
        assert_int_equal(draw(&l), LAO_OK);
        fixture_wait(&l.f);
        assert_true(i > 2 || vk_wrap.pipelines > made);
        made = i < 3 ? vk_wrap.pipelines : made;
    }
    assert_int_equal(vk_wrap.pipelines, made);
    lao_destroy(l.context);
    assert_int_equal(l.f.memory.bytes, 0);
    fixture_close(&l.f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_call_fails),
        cmocka_unit_test(any_call_fails_and_the_host_gives_up),
        cmocka_unit_test(any_function_is_missing),
        cmocka_unit_test(any_allocation_fails),
        cmocka_unit_test(a_plan_that_comes_back_makes_no_pipeline),
    };
    /* Hundreds of contexts compile the same shaders and no pixel is looked at: Mesa's compiler need
       not optimise them, which takes almost half the time. */
    setenv("GALLIVM_PERF", "nopt", 1);
    return cmocka_run_group_tests_name("vk_faults", tests, NULL, NULL);
}
