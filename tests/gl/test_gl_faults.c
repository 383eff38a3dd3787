/* Proves: whatever the driver, the loader or the allocator refuses, the OpenGL executor returns an
   error, logs exactly one item, leaks nothing and can go on; and the floor, OpenGL 3.3 without
   extensions, draws the same picture. */
#include "gl_frame.h"
#include "gl_wrap.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { PIXELS = GL_FRAME_SIZE * GL_FRAME_SIZE };
static double seconds;
static double now(void *user) {
    (void)user;
    return seconds += 0.001;
}

static lao_backend make_backend(void) {
    lao_gl_desc desc = {0};
    lao_backend backend;
    desc.get_proc = gl_wrap_proc;
    desc.now = now;
    assert_int_equal(lao_gl_backend(&desc, &backend), LAO_OK);
    return backend;
}

/* One life of the executor, up to the first failure: buffers, two views' worth of preparing, three
   frames, reading. `picture` receives the history image. The present step has no target here and is
   left out. */
static lao_result live(gl_frame_core *core, float picture[PIXELS * 4]) {
    lao_backend backend = make_backend();
    lao_backend_caps caps;
    gl_frame frame;
    void *self = NULL, *view = NULL;
    double times[GL_FRAME_STEPS];
    lao_result result = backend.attach(&backend, &core->host, &self, &caps);
    if (result) {
        assert_null(self);
        return result;
    }
    gl_frame_init(&frame, 2 * GL_FRAME_SIZE);
    frame.plan.step_count--;
    result = gl_frame_lines_create(&frame, &backend, self);
    if (!result)
        result = backend.view_create(self, &view);
    if (!result)
        result = backend.view_prepare(self, view, &frame.plan, gl_frame_shaders);
    if (!result)
        result = backend.execute(self, view, &frame.execution);
    if (!result) { /* the window shrinks */
        lao_chunk chunk = frame.chunk;
        gl_frame_init(&frame, GL_FRAME_SIZE);
        frame.plan.step_count--;
        frame.chunk = chunk;
        result = backend.view_prepare(self, view, &frame.plan, gl_frame_shaders);
    }
    if (!result)
        result = backend.execute(self, view, &frame.execution);
    frame.execution.parity = 1;
    frame.execution.flags = LAO_FRAME_TIMINGS;
    if (!result)
        result = backend.execute(self, view, &frame.execution);
    if (!result)
        result = backend.timings(self, view, times, frame.plan.step_count);
    if (!result) /* parity 1: NOW is slot 4 */
        result = backend.read(self, view, &frame.plan, 4, picture, sizeof(float) * 4 * PIXELS);
    if (view)
        backend.view_destroy(self, view);
    gl_frame_lines_destroy(&frame, &backend, self);
    backend.detach(self);
    return result;
}

static void check_balance(const gl_frame_core *core) {
    assert_int_equal(gl_wrap.live, 0);
    assert_int_equal(core->memory.bytes, 0);
}

/* One life that must go well, with the same picture as ever. */
static void check_health(const float expected[PIXELS * 4]) {
    static float picture[PIXELS * 4];
    gl_frame_core core;
    gl_wrap_reset();
    gl_frame_core_init(&core);
    assert_int_equal(live(&core, picture), LAO_OK);
    assert_int_equal(core.logs, 0);
    check_balance(&core);
    if (expected)
        assert_memory_equal(picture, expected, sizeof picture);
}

static void every_call_that_can_fail_is_noticed(void **state) {
    static float expected[PIXELS * 4], picture[PIXELS * 4];
    gl_frame_core core;
    int n, failed = 1;
    (void)state;
    gl_frame_core_init(&core);
    gl_wrap_reset();
    assert_int_equal(live(&core, expected), LAO_OK);
    for (n = 1; failed; n++) {
        gl_wrap_reset();
        gl_wrap.fail_call = n;
        gl_frame_core_init(&core);
        lao_result result = live(&core, picture);
        failed = gl_wrap.failed;
        assert_int_equal(result != LAO_OK, failed != 0);
        assert_int_equal(core.logs, failed != 0);
        check_balance(&core);
    }
    assert_true(n > 30);
    check_health(expected);
}

static void every_allocation_may_fail(void **state) {
    static float picture[PIXELS * 4];
    gl_frame_core core;
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    uint32_t n;
    (void)state;
    for (n = 1; result; n++) {
        gl_wrap_reset();
        gl_frame_core_init(&core);
        core.memory.fail_allocation = n;
        result = live(&core, picture);
        assert_int_equal(result, core.memory.allocations < n ? LAO_OK : LAO_ERROR_OUT_OF_MEMORY);
        assert_int_equal(core.logs, result != LAO_OK);
        check_balance(&core);
    }
    assert_true(n > 10);
    check_health(NULL);
}

/* What the floor has must be there; what it lacks is not missed. */
static void every_function_may_be_missing(void **state) {
    static float picture[PIXELS * 4];
    gl_frame_core core;
    lao_result result;
    int n, optional = 0, procs;
    (void)state;
    check_health(NULL);
    procs = gl_wrap.procs;
    for (n = 1; n <= procs; n++) {
        gl_wrap_reset();
        gl_wrap.fail_proc = n;
        gl_frame_core_init(&core);
        result = live(&core, picture);
        optional += !result;
        assert_true(result == LAO_OK || result == LAO_ERROR_UNSUPPORTED);
        assert_int_equal(core.logs, result != LAO_OK);
        if (result) {
            assert_int_equal(core.item, LAO_LOG_BACKEND_FUNCTION);
            assert_non_null(strstr(core.text, "gl"));
        }
        check_balance(&core);
    }
    assert_true(procs > 60);
    assert_true(optional > 0 && optional < 10);
    check_health(NULL);
}

static void the_floor_draws_the_same_picture(void **state) {
    static float expected[PIXELS * 4], picture[PIXELS * 4];
    gl_frame_core core;
    int i;
    (void)state;
    gl_wrap_reset();
    gl_frame_core_init(&core);
    assert_int_equal(live(&core, expected), LAO_OK);
    gl_wrap_reset();
    gl_wrap.floor = 1;
    assert_int_equal(live(&core, picture), LAO_OK);
    assert_int_equal(core.logs, 0);
    check_balance(&core);
    for (i = 0; i < PIXELS * 4; i++) /* depth goes another way through [-1, 1] */
        assert_true(picture[i] - expected[i] < 1e-6f && expected[i] - picture[i] < 1e-6f);
}

static void an_older_version_is_refused_by_name(void **state) {
    static float picture[PIXELS * 4];
    gl_frame_core core;
    (void)state;
    gl_wrap_reset();
    gl_wrap.version = 32;
    gl_frame_core_init(&core);
    assert_int_equal(live(&core, picture), LAO_ERROR_UNSUPPORTED);
    assert_int_equal(core.item, LAO_LOG_BACKEND_FEATURE);
    assert_non_null(strstr(core.text, "3.3"));
    check_balance(&core);
}

static void a_lost_device_is_reported_and_freed(void **state) {
    lao_backend backend = make_backend();
    lao_backend_caps caps;
    gl_frame_core core;
    gl_frame frame;
    void *self, *view;
    (void)state;
    gl_wrap_reset();
    gl_frame_core_init(&core);
    gl_frame_init(&frame, GL_FRAME_SIZE);
    frame.plan.step_count--;
    assert_int_equal(backend.attach(&backend, &core.host, &self, &caps), LAO_OK);
    assert_int_equal(gl_frame_lines_create(&frame, &backend, self), LAO_OK);
    assert_int_equal(backend.view_create(self, &view), LAO_OK);
    assert_int_equal(backend.view_prepare(self, view, &frame.plan, gl_frame_shaders), LAO_OK);
    gl_wrap.lost = 1;
    assert_int_equal(backend.execute(self, view, &frame.execution), LAO_ERROR_DEVICE_LOST);
    assert_int_equal(core.logs, 1);
    assert_int_equal(backend.view_prepare(self, view, &frame.plan, gl_frame_shaders),
                     LAO_ERROR_DEVICE_LOST);
    assert_int_equal(core.logs, 2);
    backend.view_destroy(self, view);
    gl_frame_lines_destroy(&frame, &backend, self);
    backend.detach(self);
    check_balance(&core);
}

/* 4 GiB: llvmpipe says no for real. A driver that can do it is not at fault. */
static void real_lack_of_device_memory_leaves_an_empty_view(void **state) {
    lao_backend backend = make_backend();
    lao_backend_caps caps;
    gl_frame_core core;
    gl_frame huge, frame;
    void *self, *view;
    lao_result result;
    (void)state;
    gl_wrap_reset();
    gl_frame_core_init(&core);
    gl_frame_init(&huge, GL_FRAME_SIZE);
    huge.plan.step_count--;
    huge.slots[3].width = huge.slots[3].height = 16384;
    gl_frame_init(&frame, GL_FRAME_SIZE);
    frame.plan.step_count--;
    assert_int_equal(backend.attach(&backend, &core.host, &self, &caps), LAO_OK);
    assert_true(caps.max_image_size >= 1024 && caps.max_texture_units >= 16);
    assert_true(caps.max_buffer_texels >= 65536 && caps.shader_count > 0);
    assert_int_equal(backend.view_create(self, &view), LAO_OK);
    result = backend.view_prepare(self, view, &huge.plan, gl_frame_shaders);
    if (result) {
        assert_int_equal(result, LAO_ERROR_OUT_OF_DEVICE_MEMORY);
        assert_int_equal(core.logs, 1);
        assert_int_equal(backend.execute(self, view, &huge.execution), LAO_ERROR_NOT_READY);
        assert_int_equal(core.logs, 2);
    } else {
        print_message("the driver has 4 GiB to spare\n");
    }
    assert_int_equal(backend.view_prepare(self, view, &frame.plan, gl_frame_shaders), LAO_OK);
    frame.draws[0].chunk_count = 0; /* a set without lines */
    assert_int_equal(backend.execute(self, view, &frame.execution), LAO_OK);
    backend.view_destroy(self, view);
    backend.detach(self);
    check_balance(&core);
}

static void a_refused_shader_is_named_with_the_compilers_text(void **state) {
    static const char *const lines[] = {"void main() { this is no GLSL }\n"};
    lao_shader broken = *gl_frame_shaders[1];
    const lao_shader *shaders[GL_FRAME_STEPS];
    lao_backend backend = make_backend();
    lao_backend_caps caps;
    gl_frame_core core;
    gl_frame frame;
    void *self, *view;
    (void)state;
    memcpy(shaders, gl_frame_shaders, sizeof shaders);
    broken.fragment.lines = lines;
    broken.fragment.line_count = 1;
    shaders[1] = &broken;
    gl_wrap_reset();
    gl_frame_core_init(&core);
    gl_frame_init(&frame, GL_FRAME_SIZE);
    assert_int_equal(backend.attach(&backend, &core.host, &self, &caps), LAO_OK);
    assert_int_equal(backend.view_create(self, &view), LAO_OK);
    assert_int_equal(backend.view_prepare(self, view, &frame.plan, shaders), LAO_ERROR_SHADER);
    assert_int_equal(core.logs, 1);
    assert_non_null(strstr(core.text, "t_over, fragment stage: 0:"));
    shaders[1] = NULL; /* its module's file is not there */
    assert_int_equal(backend.view_prepare(self, view, &frame.plan, shaders), LAO_ERROR_SHADER);
    assert_int_equal(core.logs, 2);
    assert_non_null(strstr(core.text, "must lie beside lineao_shaders.h"));
    backend.view_destroy(self, view);
    backend.detach(self);
    check_balance(&core);
}

static void a_plan_that_comes_back_links_nothing(void **state) {
    lao_backend backend = make_backend();
    lao_backend_caps caps;
    gl_frame_core core;
    gl_frame frame;
    void *self = NULL, *view = NULL;
    int linked;
    (void)state;
    gl_wrap_reset();
    gl_frame_core_init(&core);
    assert_int_equal(backend.attach(&backend, &core.host, &self, &caps), LAO_OK);
    gl_frame_init(&frame, GL_FRAME_SIZE);
    frame.plan.step_count--; /* without the target */
    assert_int_equal(backend.view_create(self, &view), LAO_OK);
    assert_int_equal(backend.view_prepare(self, view, &frame.plan, gl_frame_shaders), LAO_OK);
    linked = gl_wrap.linked;
    assert_true(linked > 1);
    for (int i = 0; i < 2; i++) {
        frame.plan.step_count -= 3;
        assert_int_equal(backend.view_prepare(self, view, &frame.plan, gl_frame_shaders), LAO_OK);
        frame.plan.step_count += 3;
        assert_int_equal(backend.view_prepare(self, view, &frame.plan, gl_frame_shaders), LAO_OK);
    }
    assert_int_equal(gl_wrap.linked, linked);
    backend.view_destroy(self, view);
    backend.detach(self);
    check_balance(&core);
}

/* Of programs that nothing uses so many stay, and no more. */
static void programs_without_use_are_counted(void **state) {
    lao_backend backend = make_backend();
    lao_backend_caps caps;
    gl_frame_core core;
    gl_frame frame;
    void *self = NULL, *view = NULL;
    int empty;
    (void)state;
    gl_wrap_reset();
    gl_frame_core_init(&core);
    assert_int_equal(backend.attach(&backend, &core.host, &self, &caps), LAO_OK);
    gl_frame_init(&frame, GL_FRAME_SIZE);
    frame.plan.step_count = 2;
    assert_int_equal(backend.view_create(self, &view), LAO_OK);
    assert_int_equal(backend.view_prepare(self, view, &frame.plan, gl_frame_shaders), LAO_OK);
    empty = gl_wrap.live;
    for (int i = 1; i < 3 * (int)LAO_SPARE_PROGRAMS; i++) {
        frame.steps[1].constants[0] = 100 + i; /* another program each time */
        assert_int_equal(backend.view_prepare(self, view, &frame.plan, gl_frame_shaders), LAO_OK);
        assert_int_equal(gl_wrap.live - empty,
                         i < (int)LAO_SPARE_PROGRAMS ? i : (int)LAO_SPARE_PROGRAMS);
    }
    backend.view_destroy(self, view);
    backend.detach(self);
    check_balance(&core);
}

static void a_desc_that_lacks_something_is_refused(void **state) {
    lao_gl_desc desc = {0};
    lao_backend backend;
    (void)state;
    assert_int_equal(lao_gl_backend(NULL, &backend), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_gl_backend(&desc, &backend), LAO_ERROR_INVALID_ARGUMENT);
    desc.get_proc = gl_wrap_proc;
    assert_int_equal(lao_gl_backend(&desc, NULL), LAO_ERROR_INVALID_ARGUMENT);
    desc.state_mode = LAO_GL_DIRTY + 1;
    assert_int_equal(lao_gl_backend(&desc, &backend), LAO_ERROR_INVALID_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_call_that_can_fail_is_noticed),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(every_function_may_be_missing),
        cmocka_unit_test(the_floor_draws_the_same_picture),
        cmocka_unit_test(an_older_version_is_refused_by_name),
        cmocka_unit_test(a_lost_device_is_reported_and_freed),
        cmocka_unit_test(real_lack_of_device_memory_leaves_an_empty_view),
        cmocka_unit_test(a_refused_shader_is_named_with_the_compilers_text),
        cmocka_unit_test(a_plan_that_comes_back_links_nothing),
        cmocka_unit_test(programs_without_use_are_counted),
        cmocka_unit_test(a_desc_that_lacks_something_is_refused),
    };
    int result;
    /* As test_vk_faults.c; what pictures are compared are made in the same way. */
    setenv("GALLIVM_PERF", "nopt", 1);
    if (!gl_wrap_open())
        return 0;
    result = cmocka_run_group_tests(tests, NULL, NULL);
    gl_wrap_close();
    return result;
}
