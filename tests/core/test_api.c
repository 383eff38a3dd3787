/* The public interface on the null backend keeps its contracts: each failure returns one result,
   logs exactly one item and leaves out-parameters, memory and later calls as they were, wherever
   memory or the backend gives out; zero is a good default everywhere; lao_render allocates nothing
   once it has drawn a frame of the same structure; and line sets become the texels that the vertex
   stage wants. */
#include "core_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Log items seen by any test of this program. */
static uint32_t seen[LAO_LOG_ITEM_COUNT];

static void remember(const core_host *host) {
    for (int i = 0; i < LAO_LOG_ITEM_COUNT; i++) {
        seen[i] += host->seen[i];
    }
}

static const lao_result item_results[] = {
#define ITEM(id, result, text) result,
    LAO_LOG_ITEMS(ITEM)
#undef ITEM
};
static const char *const item_names[] = {
#define ITEM(id, result, text) #id,
    LAO_LOG_ITEMS(ITEM)
#undef ITEM
};

typedef struct fixture {
    core_host host;
    lao_backend backend;
    lao_desc desc;
    lao_context *context;
    lao_lines lines;
    lao_view view;
    lao_lines_desc set;
    lao_set sets[3];
    lao_frame frame;
} fixture;

static const float zigzag[] = {0, 0, -20, 5, 1, -22, 9, -3, -25, 12, 2, -21, 3, 3, -30, 7, 3, -31};
static const uint32_t two_lines[] = {0, 4, 6};

static void fixture_frame(fixture *f) {
    f->set.line_count = 2;
    f->set.offsets = two_lines;
    f->set.points = zigzag;
    f->set.point_count = 6;
    memset(&f->frame, 0, sizeof f->frame);
    f->frame.view = f->view;
    f->frame.camera = core_camera();
    f->frame.sets = f->sets;
    f->frame.set_count = 1;
    f->frame.target.present = 1;
    f->frame.target.width = 64;
    f->frame.target.height = 48;
    for (int i = 0; i < 3; i++) {
        f->sets[i].lines = f->lines;
        f->sets[i].settings = NULL;
    }
}

static void fixture_begin(fixture *f) {
    lao_view_desc size = {64, 48, LAO_VIEW_KEEP_IMAGES};
    memset(f, 0, sizeof *f);
    core_window_clear();
    f->backend = core_backend(0);
    f->desc.backend = &f->backend;
    f->desc.allocator = lent_allocator(&f->host.memory);
    f->desc.logger = core_logger(&f->host);
    assert_int_equal(lao_create(&f->desc, &f->context), LAO_OK);
    fixture_frame(f);
    assert_int_equal(lao_lines_create(f->context, &f->set, &f->lines), LAO_OK);
    assert_int_equal(lao_view_create(f->context, &size, &f->view), LAO_OK);
    fixture_frame(f);
}

static void fixture_end(fixture *f) {
    lao_destroy(f->context);
    assert_int_equal(f->host.memory.bytes, 0);
    assert_int_equal(f->host.memory.blocks, 0);
    remember(&f->host);
}

static void failed_(fixture *f, lao_result result, lao_log_item item, const char *detail,
                    uint32_t logs, int line) {
    if (result != item_results[item] || f->host.logs != logs + 1 || f->host.item != item ||
        f->host.result != result) {
        fail_msg("line %d: wanted one %s, got result %d, %u items, the last %s", line,
                 item_names[item], (int)result, f->host.logs - logs,
                 f->host.logs ? item_names[f->host.item] : "-");
    }
    if (detail && !strstr(f->host.text, detail)) {
        fail_msg("line %d: '%s' does not name '%s'", line, f->host.text, detail);
    }
}
/* The call fails with this item, logged once; `detail` is in the text. */
#define assert_fails(f, call, item, detail)                                                        \
    do {                                                                                           \
        uint32_t logs_ = (f)->host.logs;                                                           \
        failed_(f, (call), LAO_LOG_##item, detail, logs_, __LINE__);                               \
    } while (0)
#define assert_ok(call) assert_int_equal(call, LAO_OK)

/* ----------------------------------------------------------------------------------------------
 * zero, NULL and handles */

static void results_have_words(void **state) {
    (void)state;
    for (int i = LAO_OK; i <= LAO_ERROR_NOT_READY; i++) {
        for (int k = LAO_OK; k < i; k++) {
            assert_string_not_equal(lao_result_text((lao_result)i), lao_result_text((lao_result)k));
        }
        assert_string_not_equal(lao_result_text((lao_result)i), lao_result_text((lao_result)99));
    }
    assert_int_equal(lao_format_bytes(LAO_FORMAT_NONE), 0);
    assert_int_equal(lao_format_bytes(LAO_FORMAT_RGBA8), 4);
    assert_int_equal(lao_format_bytes(LAO_FORMAT_RGBA16F), 8);
    assert_int_equal(lao_format_bytes(LAO_FORMAT_RGBA32F), 16);
    assert_int_equal(lao_format_bytes(LAO_FORMAT_R32F), 4);
    assert_int_equal(lao_format_bytes(LAO_FORMAT_R32UI), 4);
    assert_int_equal(lao_format_bytes(LAO_FORMAT_D32F), 4);
    assert_int_equal(lao_format_bytes(LAO_FORMAT_HOST), 0);
    assert_int_equal(lao_format_bytes((lao_format)99), 0);
}

static void null_arguments(void **state) {
    fixture f;
    float bounds[2][3];
    uint32_t count = 1;
    lao_context *context = NULL;
    (void)state;
    fixture_begin(&f);
    /* without a context there is nobody to tell */
    assert_int_equal(lao_create(NULL, &context), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_lines_create(NULL, &f.set, &f.lines), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_lines_update(NULL, f.lines, &f.set), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_lines_destroy(NULL, f.lines), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_lines_bounds(NULL, f.lines, bounds), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_view_create(NULL, NULL, NULL), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_view_resize(NULL, f.view, 1, 1), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_view_destroy(NULL, f.view), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_render(NULL, &f.frame), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_occlude(NULL, &f.frame, NULL), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_read(NULL, f.view, "ao", 0, NULL, 0, NULL), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_read_raw(NULL, f.view, "ao", 0, NULL, 0, NULL),
                     LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_timings(NULL, f.view, NULL, &count), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_null_backend(NULL, NULL), LAO_ERROR_INVALID_ARGUMENT);
    lao_destroy(NULL);
    assert_int_equal(f.host.logs, 0);
    /* with one, each is logged */
    assert_fails(&f, lao_create(&f.desc, NULL), NULL_ARGUMENT, "lao_create");
    assert_fails(&f, lao_lines_create(f.context, NULL, &f.lines), NULL_ARGUMENT,
                 "lao_lines_create");
    assert_fails(&f, lao_lines_create(f.context, &f.set, NULL), NULL_ARGUMENT, "lao_lines_create");
    assert_fails(&f, lao_lines_update(f.context, f.lines, NULL), NULL_ARGUMENT, "lao_lines_update");
    assert_fails(&f, lao_lines_bounds(f.context, f.lines, NULL), NULL_ARGUMENT, "lao_lines_bounds");
    assert_fails(&f, lao_view_create(f.context, NULL, &f.view), NULL_ARGUMENT, "lao_view_create");
    assert_fails(&f, lao_render(f.context, NULL), NULL_ARGUMENT, "lao_render");
    f.frame.sets = NULL;
    assert_fails(&f, lao_render(f.context, &f.frame), NULL_ARGUMENT, "lao_render");
    fixture_frame(&f);
    f.frame.import_count = 1;
    assert_fails(&f, lao_render(f.context, &f.frame), NULL_ARGUMENT, "lao_render");
    assert_fails(&f, lao_occlude(f.context, &f.frame, NULL), NULL_ARGUMENT, "lao_occlude");
    assert_fails(&f, lao_occlude(f.context, NULL, NULL), NULL_ARGUMENT, "lao_occlude");
    assert_fails(&f, lao_read(f.context, f.view, NULL, 0, NULL, 0, NULL), NULL_ARGUMENT,
                 "lao_read");
    assert_fails(&f, lao_timings(f.context, f.view, NULL, NULL), NULL_ARGUMENT, "lao_timings");
    f.set.points = NULL;
    assert_fails(&f, lao_lines_create(f.context, &f.set, &f.lines), NULL_ARGUMENT, "points");
    fixture_frame(&f);
    f.set.offsets = NULL;
    assert_fails(&f, lao_lines_create(f.context, &f.set, &f.lines), NULL_ARGUMENT, "offsets");
    f.desc.module_count = 1;
    assert_fails(&f, lao_create(&f.desc, &context), NULL_ARGUMENT, "modules");
    assert_null(context);
    fixture_end(&f);
}

static void zero_is_a_good_default(void **state) {
    lao_desc desc;
    lao_backend backend;
    lao_context *context;
    lao_lines_desc none;
    lao_lines lines;
    lao_view_desc size = {1, 1, 0};
    lao_frame frame;
    float bounds[2][3];
    (void)state;
    /* no allocator, no log, nothing in the line set, no sets, no target */
    memset(&desc, 0, sizeof desc);
    memset(&none, 0, sizeof none);
    memset(&frame, 0, sizeof frame);
    assert_int_equal(lao_create(&desc, &context), LAO_ERROR_INVALID_ARGUMENT); /* silent */
    assert_ok(lao_null_backend(NULL, &backend));
    desc.backend = &backend;
    assert_ok(lao_create(&desc, &context));
    assert_ok(lao_lines_create(context, &none, &lines));
    assert_ok(lao_lines_bounds(context, lines, bounds));
    for (int i = 0; i < 6; i++) {
        assert_true(bounds[i / 3][i % 3] == 0);
    }
    assert_ok(lao_lines_update(context, lines, &none));
    assert_ok(lao_view_create(context, &size, &frame.view));
    assert_int_equal(lao_render(context, &frame),
                     LAO_ERROR_INVALID_ARGUMENT); /* a zero camera is none */
    frame.camera = core_camera();
    assert_ok(lao_render(context, &frame));
    assert_ok(lao_lines_destroy(context, lines));
    assert_ok(lao_view_destroy(context, frame.view));
    lao_destroy(context);
    { /* a backend desc that nobody filled, and one from another version */
        core_host host;
        lao_backend empty;
        lao_context *untouched = (lao_context *)(void *)&host;
        memset(&host, 0, sizeof host);
        memset(&empty, 0, sizeof empty);
        desc.logger = core_logger(&host);
        desc.backend = &empty;
        assert_int_equal(lao_create(&desc, &untouched), LAO_ERROR_INVALID_ARGUMENT);
        assert_int_equal(host.item, LAO_LOG_BACKEND_MISSING);
        desc.backend = NULL;
        assert_int_equal(lao_create(&desc, &untouched), LAO_ERROR_INVALID_ARGUMENT);
        assert_int_equal(host.seen[LAO_LOG_BACKEND_MISSING], 2);
        desc.backend = &backend;
        backend.abi = LAO_BACKEND_ABI + 1;
        assert_int_equal(lao_create(&desc, &untouched), LAO_ERROR_INVALID_ARGUMENT);
        assert_int_equal(host.item, LAO_LOG_BACKEND_ABI);
        assert_int_equal(host.logs, 3);
        assert_ptr_equal(untouched, (lao_context *)(void *)&host);
        remember(&host);
    }
}

static void stale_handles(void **state) {
    fixture f;
    float bounds[2][3];
    uint32_t count = 0;
    lao_lines fresh, none = {0}, wild = {0xffffffffu};
    lao_view no_view = {0};
    lao_view_desc size = {8, 8, 0};
    (void)state;
    fixture_begin(&f);
    for (int i = 0; i < 5; i++) { /* a slot that is used again does not wake the old handle */
        lao_lines old = f.lines;
        assert_ok(lao_lines_destroy(f.context, old));
        assert_fails(&f, lao_lines_destroy(f.context, old), LINES_HANDLE, "lao_lines_destroy");
        assert_ok(lao_lines_create(f.context, &f.set, &fresh));
        assert_int_not_equal(fresh.id, old.id);
        assert_int_not_equal(fresh.id, 0);
        f.lines = old;
        assert_fails(&f, lao_lines_update(f.context, old, &f.set), LINES_HANDLE,
                     "lao_lines_update");
        assert_fails(&f, lao_lines_bounds(f.context, old, bounds), LINES_HANDLE,
                     "lao_lines_bounds");
        f.sets[0].lines = old;
        assert_fails(&f, lao_render(f.context, &f.frame), LINES_HANDLE, "lao_frame.sets");
        f.sets[0].lines = f.lines = fresh;
        assert_ok(lao_render(f.context, &f.frame));
    }
    assert_fails(&f, lao_lines_destroy(f.context, none), LINES_HANDLE, NULL);
    assert_fails(&f, lao_lines_destroy(f.context, wild), LINES_HANDLE, NULL);
    for (int i = 0; i < 3; i++) {
        lao_view old = f.view;
        assert_ok(lao_view_destroy(f.context, old));
        assert_fails(&f, lao_view_destroy(f.context, old), VIEW_HANDLE, "lao_view_destroy");
        assert_ok(lao_view_create(f.context, &size, &f.view));
        assert_int_not_equal(f.view.id, old.id);
        assert_fails(&f, lao_view_resize(f.context, old, 4, 4), VIEW_HANDLE, "lao_view_resize");
        f.frame.view = old;
        assert_fails(&f, lao_render(f.context, &f.frame), VIEW_HANDLE, "lao_render");
        assert_fails(&f, lao_read(f.context, old, "ao", 0, NULL, 0, NULL), VIEW_HANDLE, "lao_read");
        assert_fails(&f, lao_timings(f.context, old, NULL, &count), VIEW_HANDLE, "lao_timings");
        f.frame.view = f.view;
    }
    assert_fails(&f, lao_view_destroy(f.context, no_view), VIEW_HANDLE, NULL);
    for (uint32_t i = 0; i < 9000;
         i++) { /* generations wrap; the handle never becomes 0 and the last one stays dead */
        lao_lines old = f.lines;
        assert_ok(lao_lines_destroy(f.context, old));
        assert_ok(lao_lines_create(f.context, &f.set, &f.lines));
        assert_true(f.lines.id != 0 && f.lines.id != old.id);
    }
    fixture_end(&f);
}

static void two_contexts_are_strangers(void **state) {
    fixture a, b;
    lao_lines second;
    (void)state;
    fixture_begin(&a);
    fixture_begin(&b);
    core_seen.buffers_alive = 4; /* the window looks at both */
    assert_ok(lao_lines_create(a.context, &a.set, &second));
    assert_fails(&b, lao_lines_destroy(b.context, second), LINES_HANDLE, NULL);
    assert_int_equal(a.host.logs, 0);
    assert_ok(lao_render(a.context, &a.frame));
    assert_ok(lao_render(b.context, &b.frame));
    assert_ok(lao_render(a.context, &a.frame));
    fixture_end(&b);
    assert_ok(lao_render(a.context, &a.frame));
    fixture_end(&a);
}

/* -------------------------------------------------------------------------------------------------------
 * argument errors */

static void wrong_arguments(void **state) {
    static const uint32_t falling[] = {0, 5, 4}, late[] = {1, 4, 6}, beyond[] = {0, 4, 7},
                          early[] = {0, 4, 5};
    static const uint32_t *const offsets[] = {falling, late, beyond, early};
    fixture f;
    lao_view_desc size = {0, 4, 0};
    lao_view view = {77};
    lao_lines lines = {77};
    lao_settings settings;
    lao_import imports[4];
    lao_read_info info = {7, 7, 7};
    float pixels[64 * 48 * 4];
    uint32_t count = 77;
    (void)state;
    fixture_begin(&f);
    for (int i = 0; i < 4; i++) {
        f.set.offsets = offsets[i];
        assert_fails(&f, lao_lines_create(f.context, &f.set, &lines), LINES_OFFSETS, "offsets[");
        assert_fails(&f, lao_lines_update(f.context, f.lines, &f.set), LINES_OFFSETS, NULL);
    }
    assert_int_equal(lines.id, 77);
    assert_fails(&f, lao_view_create(f.context, &size, &view), VIEW_SIZE, NULL);
    size.width = 16385;
    assert_fails(&f, lao_view_create(f.context, &size, &view), VIEW_SIZE, NULL);
    assert_int_equal(view.id, 77);
    assert_fails(&f, lao_view_resize(f.context, f.view, 5, 0), VIEW_SIZE, NULL);
    assert_fails(&f, lao_view_resize(f.context, f.view, 5, 16385), VIEW_SIZE, NULL);
    assert_ok(lao_view_resize(f.context, f.view, 9000, 3)); /* too large only when supersampled */
    assert_fails(&f, lao_render(f.context, &f.frame), TARGET, NULL);
    f.frame.target.width = 9000;
    f.frame.target.height = 3;
    assert_fails(&f, lao_render(f.context, &f.frame), VIEW_SIZE, NULL);
    assert_ok(lao_view_resize(f.context, f.view, 64, 48));
    f.frame.target.width = 64;
    f.frame.target.height = 48;
    assert_fails(&f, lao_read(f.context, f.view, "ao", 0, NULL, 0, &info), NOTHING_RENDERED, "ao");
    assert_fails(&f, lao_timings(f.context, f.view, NULL, &count), TIMINGS_OFF, NULL);
    f.frame.camera.view[3] = NAN;
    assert_fails(&f, lao_render(f.context, &f.frame), CAMERA, NULL);
    f.frame.camera = core_camera();
    /* settings */
    memset(&settings, 0, sizeof settings);
    settings.strength = 6;
    f.sets[0].settings = &settings;
    assert_fails(&f, lao_render(f.context, &f.frame), SETTING_RANGE,
                 "strength = 6, must be 0 to 5");
    settings.strength = 0;
    settings.levels = 2.5f;
    assert_fails(&f, lao_render(f.context, &f.frame), SETTING_RANGE, "levels");
    f.sets[0].settings = NULL;
    assert_ok(lao_render(f.context, &f.frame));
    /* imports */
    memset(imports, 0, sizeof imports);
    f.frame.imports = imports;
    f.frame.import_count = 1;
    imports[0].source.present = 1;
    imports[0].source.width = 64;
    imports[0].source.height = 48;
    assert_fails(&f, lao_render(f.context, &f.frame), IMPORT, "(no name)");
    imports[0].image = "no_such";
    assert_fails(&f, lao_render(f.context, &f.frame), IMPORT, "no_such");
    imports[0].image = "target";
    assert_fails(&f, lao_render(f.context, &f.frame), IMPORT, "target");
    imports[0].image = "host_depth";
    imports[0].source.present = 0;
    assert_fails(&f, lao_render(f.context, &f.frame), IMPORT, "host_depth");
    imports[0].source.present = 1;
    imports[0].source.width = 63;
    assert_fails(&f, lao_render(f.context, &f.frame), IMPORT, "host_depth");
    imports[0].source.width = 64;
    assert_ok(lao_render(f.context, &f.frame));
    imports[0].image = "color"; /* supersampled by 2 */
    assert_fails(&f, lao_render(f.context, &f.frame), IMPORT, "color");
    imports[0].source.width = 128;
    imports[0].source.height = 96;
    assert_fails(&f, lao_render(f.context, &f.frame), IMPORT,
                 "tangent"); /* its maker is dropped, too */
    assert_fails(&f, lao_occlude(f.context, &f.frame, NULL), IMPORT, "lao_occlude");
    imports[2] = imports[1] = imports[0];
    imports[1].image = "tangent";
    imports[2].image = "depth";
    f.frame.import_count = 3;
    assert_fails(&f, lao_occlude(f.context, &f.frame, NULL), IMPORT, "sphere");
    f.frame.sphere[3] = 10;
    imports[2].image = "color";
    assert_fails(&f, lao_occlude(f.context, &f.frame, NULL), IMPORT, NULL);
    imports[2].image = "depth";
    settings.levels = 99;
    assert_fails(&f, lao_occlude(f.context, &f.frame, &settings), SETTING_RANGE, "levels");
    assert_ok(lao_occlude(f.context, &f.frame, NULL));
    /* reading */
    assert_fails(&f, lao_read(f.context, f.view, "no_such", 0, NULL, 0, &info), IMAGE_UNKNOWN,
                 "no_such");
    assert_fails(&f, lao_read(f.context, f.view, "color", 0, NULL, 0, &info), IMAGE_UNKNOWN,
                 "color"); /* the host's */
    assert_fails(&f, lao_read(f.context, f.view, "level", 3, NULL, 0, &info), IMAGE_UNKNOWN,
                 "level");
    assert_fails(&f, lao_read(f.context, f.view, "tensor", 0, NULL, 0, &info), IMAGE_UNKNOWN,
                 "tensor"); /* sums begin at level 1 */
    assert_fails(&f, lao_read(f.context, f.view, "out", 0, pixels, 64 * 48 * 4 - 1, &info),
                 READ_SIZE, "out");
    assert_fails(&f, lao_read_raw(f.context, f.view, "out", 0, pixels, 64 * 48 * 4 - 1, &info),
                 READ_SIZE, "out");
    assert_int_equal(info.width, 7);
    assert_ok(lao_read(f.context, f.view, "out", 0, NULL, 0, &info));
    assert_true(info.width == 64 && info.height == 48 && info.channels == 4);
    assert_ok(lao_read(f.context, f.view, "out", 0, pixels, 64 * 48 * 4, NULL));
    assert_ok(lao_read_raw(f.context, f.view, "out", 0, pixels, 64 * 48 * 4, &info));
    assert_ok(lao_read(f.context, f.view, "level", 2, NULL, 0, &info));
    assert_true(info.width == 32 && info.height == 24 && info.channels == 3);
    assert_ok(lao_read(f.context, f.view, "ao", 0, NULL, 0, &info));
    assert_int_equal(info.channels, 1);
    assert_fails(&f, lao_timings(f.context, f.view, NULL, &count), TIMINGS_OFF, NULL);
    assert_int_equal(count, 77);
    fixture_end(&f);
}

static void memory_that_was_used_again_is_not_read(void **state) {
    fixture f;
    lao_view_desc size = {64, 48, 0};
    lao_read_info info;
    (void)state;
    fixture_begin(&f);
    assert_ok(lao_view_create(f.context, &size, &f.frame.view));
    assert_ok(lao_render(f.context, &f.frame));
    assert_ok(lao_read(f.context, f.frame.view, "out", 0, NULL, 0, &info));
    /* ao is R32F as depth is: it takes its memory */
    assert_fails(&f, lao_read(f.context, f.frame.view, "depth", 0, NULL, 0, &info), IMAGE_UNKNOWN,
                 "LAO_VIEW_KEEP_IMAGES");
    assert_ok(lao_render(f.context, &f.frame));
    f.frame.view = f.view; /* keeps */
    assert_ok(lao_render(f.context, &f.frame));
    assert_ok(lao_read(f.context, f.view, "depth", 0, NULL, 0, &info));
    fixture_end(&f);
}

static void limits_of_the_device(void **state) {
    fixture f;
    (void)state;
    fixture_begin(&f);
    fixture_end(&f);
    core_window_clear();
    memset(&f.host, 0, sizeof f.host);
    core_seen.max_texture_units = 3; /* occlusion reads tangent and 3 levels */
    core_seen.max_image_size = 128;
    f.backend = core_backend(0);
    assert_ok(lao_create(&f.desc, &f.context));
    {
        lao_view_desc size = {64, 48, 0};
        lao_settings settings;
        memset(&settings, 0, sizeof settings);
        f.frame.set_count = 0;
        assert_ok(lao_view_create(f.context, &size, &f.view));
        f.frame.view = f.view;
        assert_fails(&f, lao_render(f.context, &f.frame), UNITS, "occlusion");
        assert_ok(lao_lines_create(f.context, &f.set, &f.sets[0].lines));
        f.frame.set_count = 1;
        settings.levels = 2;
        f.sets[0].settings = &settings;
        assert_ok(lao_render(f.context, &f.frame));
        settings.supersampling = 3;
        assert_fails(&f, lao_render(f.context, &f.frame), VIEW_SIZE, "lines");
        settings.supersampling = 1;
        assert_ok(lao_render(f.context, &f.frame));
    }
    fixture_end(&f);
}

static void broken_modules_are_refused(void **state) {
    fixture f;
    lao_module module;
    const lao_module *modules[16];
    lao_context *context = NULL;
    (void)state;
    fixture_begin(&f);
    module = *lao_lines_module(); /* every name twice */
    for (int i = 0; i < 16; i++) {
        modules[i] = &module;
    }
    f.desc.modules = modules;
    f.desc.module_count = 1;
    assert_fails(&f, lao_create(&f.desc, &context), GRAPH_BROKEN, "two images");
    f.desc.module_count = 16;
    assert_fails(&f, lao_create(&f.desc, &context), GRAPH_BROKEN, "15 modules");
    assert_null(context);
    fixture_end(&f);
}

/* -------------------------------------------------------------------------------------------
 * whatever gives out, wherever */

/* One call of the session: after a failure everything is as before, one item is logged, and the
 * next attempt works. */
#define ATTEMPT(call, untouched)                                                                   \
    do {                                                                                           \
        uint32_t logs_ = host->logs;                                                               \
        lao_result result_ = (call);                                                               \
        if (result_ != LAO_OK) {                                                                   \
            failures++;                                                                            \
            if (host->logs != logs_ + 1 || host->result != result_ ||                              \
                item_results[host->item] != result_ || !(untouched)) {                             \
                fail_msg("line %d: result %d, %u items, last %s, out-parameters %s", __LINE__,     \
                         (int)result_, host->logs - logs_, item_names[host->item],                 \
                         (untouched) ? "untouched" : "touched");                                   \
            }                                                                                      \
            result_ = (call);                                                                      \
        }                                                                                          \
        if (result_ != LAO_OK || host->logs > logs_ + 1) {                                         \
            fail_msg("line %d: the next attempt fails, too: %s", __LINE__, host->text);            \
        }                                                                                          \
    } while (0)

static int all_are(const float *values, size_t count, float value) {
    for (size_t i = 0; i < count; i++) {
        if (values[i] != value) {
            return 0;
        }
    }
    return 1;
}

/* Returns how many calls failed. */
static int session(core_host *host, uint32_t fail_allocation, uint32_t fail_call) {
    static float pixels[40 * 30 * 4];
    int failures = 0;
    lao_backend backend;
    lao_desc desc;
    lao_context *context = NULL;
    lao_lines a = {0}, b = {0}, many[17];
    lao_view view = {0}, views[17];
    lao_view_desc size = {40, 30, LAO_VIEW_KEEP_IMAGES};
    lao_lines_desc set;
    lao_set sets[3];
    lao_settings settings;
    lao_frame frame;
    lao_import imports[3];
    lao_timing timings[64];
    lao_read_info info = {0, 0, 0};
    uint32_t count = 64, buffers;
    float bounds[2][3], before[2][3];

    memset(host, 0, sizeof *host);
    memset(sets, 0, sizeof sets);
    core_window_clear();
    core_seen.max_buffer_texels = 6; /* several chunks */
    backend = core_backend(fail_call);
    memset(&desc, 0, sizeof desc);
    desc.backend = &backend;
    desc.allocator = lent_allocator(&host->memory);
    desc.logger = core_logger(host);
    host->memory.fail_allocation = fail_allocation;
    { /* each attempt has its own backend state, so a failing call would fail again */
        uint32_t logs = host->logs;
        lao_result result = lao_create(&desc, &context);
        if (result != LAO_OK) {
            failures++;
            assert_int_equal(host->logs, logs + 1);
            assert_null(context);
            assert_int_equal(host->memory.bytes, 0);
            backend = core_backend(0);
            assert_ok(lao_create(&desc, &context));
        }
    }
    memset(&set, 0, sizeof set);
    set.line_count = 2;
    set.offsets = two_lines;
    set.points = zigzag;
    set.point_count = 6;
    ATTEMPT(lao_lines_create(context, &set, &a), a.id == 0);
    ATTEMPT(lao_lines_create(context, &set, &b), b.id == 0);
    for (int i = 0; i < 17; i++) { /* the table of handles grows */
        many[i].id = 0;
        ATTEMPT(lao_lines_create(context, &set, &many[i]), many[i].id == 0);
    }
    assert_ok(lao_lines_bounds(context, a, before));
    set.line_count = 1;
    set.offsets = NULL;
    set.point_count = 5;
    buffers = core_seen.buffers_alive;
    ATTEMPT(lao_lines_update(context, a, &set), lao_lines_bounds(context, a, bounds) == LAO_OK &&
                                                    memcmp(bounds, before, sizeof bounds) == 0 &&
                                                    core_seen.buffers_alive == buffers);
    ATTEMPT(lao_view_create(context, &size, &view), view.id == 0);
    for (int i = 0; i < 17; i++) {
        views[i].id = 0;
        ATTEMPT(lao_view_create(context, &size, &views[i]), views[i].id == 0);
        assert_ok(lao_view_destroy(context, views[i]));
        views[i].id = 0;
    }
    memset(&frame, 0, sizeof frame);
    memset(&settings, 0, sizeof settings);
    frame.view = view;
    frame.camera = core_camera();
    frame.sets = sets;
    frame.set_count = 1;
    frame.target.present = 1;
    frame.target.width = 40;
    frame.target.height = 30;
    sets[0].lines = a;
    sets[0].settings = NULL;
    sets[1].lines = b;
    sets[1].settings = &settings;
    sets[2] = sets[1];
    settings.preset = 1;
    ATTEMPT(lao_render(context, &frame), 1);
    frame.flags = LAO_FRAME_TIMINGS;
    frame.set_count = 3;
    ATTEMPT(lao_render(context, &frame), 1);
    settings.levels = 8;
    ATTEMPT(lao_render(context, &frame), 1);
    ATTEMPT(lao_view_resize(context, view, 20, 30), 1);
    frame.target.width = 20;
    frame.set_count = 2;
    ATTEMPT(lao_render(context, &frame), 1);
    memset(timings, 0, sizeof timings);
    ATTEMPT(lao_timings(context, view, timings, &count), count == 64 && timings[0].pass == NULL);
    assert_string_equal(timings[0].pass, "lines_halo");
    assert_true(count > 10 && count < 64);
    for (size_t i = 0; i < sizeof pixels / sizeof pixels[0]; i++) {
        pixels[i] = 7;
    }
    ATTEMPT(lao_read(context, view, "out", 0, pixels, sizeof pixels / sizeof pixels[0], &info),
            all_are(pixels, sizeof pixels / sizeof pixels[0], 7) && info.width == 0);
    assert_int_equal(info.width, 20);
    info.width = 0;
    for (size_t i = 0; i < sizeof pixels / sizeof pixels[0]; i++) {
        pixels[i] = 7;
    }
    ATTEMPT(lao_read_raw(context, view, "out", 0, pixels, sizeof pixels, &info),
            all_are(pixels, sizeof pixels / sizeof pixels[0], 7) && info.width == 0);
    memset(imports, 0, sizeof imports);
    for (int i = 0; i < 3; i++) {
        static const char *const names[] = {"color", "tangent", "depth"};
        imports[i].image = names[i];
        imports[i].source.present = 1;
        imports[i].source.width = 40;
        imports[i].source.height = 60;
    }
    frame.imports = imports;
    frame.import_count = 3;
    frame.sphere[3] = 10;
    ATTEMPT(lao_occlude(context, &frame, NULL), 1);
    frame.imports = NULL;
    frame.import_count = 0;
    ATTEMPT(lao_render(context, &frame), 1);
    assert_ok(lao_lines_destroy(context, a));
    ATTEMPT(lao_lines_create(context, &set, &a), 1);
    assert_ok(lao_view_destroy(context, view));
    lao_destroy(context);
    assert_int_equal(host->memory.bytes, 0);
    assert_int_equal(host->memory.blocks, 0);
    assert_int_equal(core_seen.buffers_alive, 0);
    remember(host);
    return failures;
}

static void memory_gives_out_at_any_allocation(void **state) {
    core_host host;
    uint32_t n, total;
    (void)state;
    assert_int_equal(session(&host, 0, 0), 0);
    assert_int_equal(host.logs, 0);
    total = host.memory.allocations;
    for (n = 1; n <= total; n++) {
        assert_int_equal(session(&host, n, 0), 1);
        assert_int_equal(host.logs, 1);
        assert_true(host.result == LAO_ERROR_OUT_OF_MEMORY);
    }
    assert_true(total > 100);
}

static void the_backend_fails_at_any_call(void **state) {
    core_host host;
    uint32_t n = 1;
    (void)state;
    while (session(&host, 0, n) == 1) {
        assert_int_equal(host.logs, 1);
        assert_int_equal(host.result, LAO_ERROR_BACKEND);
        n++;
    }
    assert_true(n > 80);
}

static void rendering_allocates_nothing_twice(void **state) {
    fixture f;
    lao_settings settings;
    uint32_t allocations, prepares;
    (void)state;
    fixture_begin(&f);
    memset(&settings, 0, sizeof settings);
    f.sets[0].settings = &settings;
    for (int structure = 0; structure < 6; structure++) {
        settings.levels = structure == 1 ? 5.0f : 0.0f;
        settings.preset = structure == 2 ? 2.0f : 0.0f;
        f.frame.set_count = structure == 3 ? 3 : 1;
        f.frame.target.present = structure != 4;
        f.frame.camera.flags =
            LAO_CAMERA_ZERO_TO_ONE | (structure == 5 ? LAO_CAMERA_REVERSE_DEPTH : 0u);
        prepares = core_seen.prepares;
        assert_ok(lao_render(f.context, &f.frame));
        assert_int_equal(core_seen.prepares, prepares + 1); /* a new structure, made once */
        allocations = f.host.memory.allocations;
        for (int i = 0; i < 10; i++) {
            settings.strength = (float)i * 0.1f; /* what may change from frame to frame */
            settings.width = 1 + (float)i;
            f.frame.camera.view[12] = (float)i;
            f.frame.background[3] = (float)(i % 2);
            f.frame.time = (float)i;
            f.frame.flags = i % 2 ? LAO_FRAME_TIMINGS : 0u;
            f.frame.sphere[3] = (float)i;
            f.sets[1].settings = i % 2 ? &settings : NULL;
            f.sets[1].settings = NULL;
            assert_ok(lao_render(f.context, &f.frame));
            assert_int_equal(f.host.memory.allocations, allocations);
            assert_int_equal(core_seen.prepares, prepares + 1);
            assert_int_equal(core_seen.parity, (core_seen.executions - 1) & 1);
        }
    }
    assert_ok(
        lao_lines_update(f.context, f.lines, &f.set)); /* other lines are no other structure */
    allocations = f.host.memory.allocations;
    assert_ok(lao_render(f.context, &f.frame));
    assert_int_equal(f.host.memory.allocations, allocations);
    fixture_end(&f);
}

static void a_failed_frame_does_not_spoil_the_next(void **state) {
    fixture f;
    lao_settings settings;
    (void)state;
    fixture_begin(&f);
    memset(&settings, 0, sizeof settings);
    f.sets[0].settings = &settings;
    assert_ok(lao_render(f.context, &f.frame));
    /* a structural change that fails for another reason must not be forgotten */
    settings.levels = 5;
    settings.strength = 9;
    assert_fails(&f, lao_render(f.context, &f.frame), SETTING_RANGE, NULL);
    settings.strength = 0;
    assert_ok(lao_render(f.context, &f.frame));
    assert_int_equal(core_seen.plan->step_count,
                     10); /* lines, level_zero, 4 levels, occlusion, shade, resolve, present */
    /* nor one that the first set brought before the second failed */
    f.frame.set_count = 2;
    assert_ok(lao_render(f.context, &f.frame));
    f.sets[1].lines.id = 999;
    settings.levels = 2;
    assert_fails(&f, lao_render(f.context, &f.frame), LINES_HANDLE, NULL);
    f.sets[1].lines = f.lines;
    assert_ok(lao_render(f.context, &f.frame));
    assert_int_equal(core_seen.plan->step_count,
                     5 + 6 + 2); /* two levels, the default three, the end */
    fixture_end(&f);
}

/* --------------------------------------------------------------------------------------------------------------
 * settings */

static void settings_table(void **state) {
    const lao_module *module = lao_lines_module();
    float values[64];
    lao_settings s, filled;
    (void)state;
    assert_int_equal(module->setting_count, LAO_SETTING_COUNT);
    assert_int_equal(sizeof(lao_settings) - sizeof(uint64_t),
                     ((LAO_SETTING_COUNT + 1) / 2 * 2) * sizeof(float)); /* no holes */
    for (uint32_t i = 0; i < module->setting_count; i++) {
        const lao_setting_row *row = &module->settings[i];
        assert_true(row->standard >= row->minimum && row->standard <= row->maximum);
        assert_true(row->help && *row->help);
        assert_int_equal(lao_setting_find(module, row->name), i);
        if (row->type == LAO_SETTING_ENUM) {
            int choices = 1;
            for (const char *c = row->choices; *c; c++) {
                choices += *c == '|';
            }
            assert_int_equal(row->maximum, choices - 1);
        }
        if (row->type == LAO_SETTING_BOOL) {
            assert_true(row->minimum == 0 && row->maximum == 1);
        }
    }
    assert_int_equal(lao_setting_find(module, "no_such"), -1);
    assert_int_equal(lao_setting_find(module, NULL), -1);
    assert_int_equal(lao_setting_find(NULL, "width"), -1);
    /* zero and NULL are the defaults */
    memset(&s, 0, sizeof s);
    assert_int_equal(lao_settings_resolve(module, &s, values), -1);
    for (uint32_t i = 0; i < module->setting_count; i++) {
        assert_true(values[i] == module->settings[i].standard);
    }
    assert_int_equal(lao_settings_resolve(module, NULL, values), -1);
    for (uint32_t i = 0; i < module->setting_count; i++) {
        assert_true(values[i] == module->settings[i].standard);
    }
    assert_true(s.set == 0);
    filled = lao_settings_filled(NULL);
    assert_true(filled.width == 0.5f && filled.strength == 1.5f && filled.levels == 3 &&
                filled.samples == 32 && filled.supersampling == 2);
    assert_true(filled.set == (((uint64_t)1 << LAO_SETTING_COUNT) - 1));
    { /* what is filled stays as it is */
        lao_settings again = lao_settings_filled(&filled);
        assert_memory_equal(&again, &filled, LAO_SETTING_COUNT * sizeof(float) + sizeof(uint64_t));
    }
    /* presets, and what overrides them */
    s.preset = 1;
    filled = lao_settings_filled(&s);
    assert_true(filled.align == LAO_ALIGN_NONE && filled.strength == 1 && filled.preset == 1);
    s.strength = 2;
    filled = lao_settings_filled(&s);
    assert_true(filled.strength == 2 && filled.align == LAO_ALIGN_NONE);
    s.strength = 0; /* an explicit 0 needs its bit */
    assert_true(lao_settings_filled(&s).strength == 1);
    s.set = LAO_SET(strength) | LAO_SET(align);
    filled = lao_settings_filled(&s);
    assert_true(filled.strength == 0 && filled.align == LAO_ALIGN_ROTATION);
    s.set = 0;
    s.preset = 2;
    filled = lao_settings_filled(&s);
    assert_true(filled.align == LAO_ALIGN_PAPER && filled.strength == 1.5f);
    /* ranges: each end is in, what lies beyond and what is no number is out */
    for (uint32_t i = 0; i < module->setting_count; i++) {
        const lao_setting_row *row = &module->settings[i];
        const float bad[] = {row->maximum + 1, row->minimum - 1, NAN,
                             INFINITY,         -INFINITY,        row->minimum + 0.5f};
        const float good[] = {row->minimum, row->maximum, row->standard};
        float *field;
        memset(&s, 0, sizeof s);
        field = (float *)(void *)((char *)&s + sizeof s.set) + i;
        s.set = (uint64_t)1 << i;
        for (int k = 0; k < 3; k++) {
            *field = good[k];
            assert_int_equal(lao_settings_resolve(module, &s, values), -1);
            assert_true(values[i] == good[k]);
        }
        for (int k = 0; k < (row->type == LAO_SETTING_FLOAT ? 5 : 6); k++) {
            *field = bad[k];
            assert_int_equal(lao_settings_resolve(module, &s, values), (int)i);
        }
    }
}

static void settings_from_text(void **state) {
    static const struct {
        const char *setting, *text;
        int result;
        float value;
    } cases[] = {
        {"strength", "2.5", 0, 2.5f},
        {"strength", "+1e0", 0, 1},
        {"strength", ".5", 0, 0.5f},
        {"strength", "25e-1", 0, 2.5f},
        {"strength", "0", 0, 0},
        {"strength", "-0", 0, 0},
        {"strength", "5.", 0, 5},
        {"strength", "5.1", -1, 0},
        {"strength", "-1", -1, 0},
        {"strength", "", -1, 0},
        {"strength", "one", -1, 0},
        {"strength", "1 ", -1, 0},
        {"strength", " 1", -1, 0},
        {"strength", "1,5", -1, 0},
        {"strength", "nan", -1, 0},
        {"strength", "inf", -1, 0},
        {"strength", "1e999", -1, 0},
        {"strength", "0e999", -1, 0},
        {"strength", "1e", -1, 0},
        {"strength", "1e+", -1, 0},
        {"strength", "0x1", -1, 0},
        {"strength", "--1", -1, 0},
        {"strength", ".", -1, 0},
        {"strength", "true", -1, 0},
        {"depth_threshold", "1e-7", 0, 1e-7f},
        {"levels", "8", 0, 8},
        {"levels", "2.5", -1, 0},
        {"levels", "0", -1, 0},
        {"occlusion", "false", 0, 0},
        {"occlusion", "off", 0, 0},
        {"occlusion", "no", 0, 0},
        {"occlusion", "true", 0, 1},
        {"occlusion", "on", 0, 1},
        {"occlusion", "yes", 0, 1},
        {"occlusion", "1", 0, 1},
        {"occlusion", "2", -1, 0},
        {"occlusion", "maybe", -1, 0},
        {"align", "paper", 0, 1},
        {"align", "none", 0, 2},
        {"align", "2", 0, 2},
        {"align", "3", -1, 0},
        {"align", "pape", -1, 0},
        {"align", "paper|none", -1, 0},
        {"align", "", -1, 0},
        {"show", "visibility_depth", 0, 6},
        {"preset", "classic", 0, 1},
    };
    const lao_module *module = lao_lines_module();
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        lao_settings s, before;
        int index = lao_setting_find(module, cases[i].setting);
        memset(&s, 0, sizeof s);
        s.radius = 7;
        before = s;
        if (lao_setting_parse(module, index, cases[i].text, &s) != cases[i].result) {
            fail_msg("%s = '%s' is %s", cases[i].setting, cases[i].text,
                     cases[i].result ? "taken" : "refused");
        }
        if (cases[i].result) {
            assert_memory_equal(&s, &before, sizeof s);
        } else {
            float value = ((float *)(void *)((char *)&s + sizeof s.set))[index];
            assert_true(fabsf(value - cases[i].value) <= 1e-6f * fabsf(cases[i].value));
            assert_true(s.set == (uint64_t)1 << index && s.radius == 7);
        }
    }
    {
        lao_settings s;
        memset(&s, 0, sizeof s);
        assert_int_equal(lao_setting_parse(module, -1, "1", &s), -1);
        assert_int_equal(lao_setting_parse(module, LAO_SETTING_COUNT, "1", &s), -1);
        assert_int_equal(lao_setting_parse(module, 1, NULL, &s), -1);
        assert_int_equal(lao_setting_parse(module, 1, "1", NULL), -1);
        assert_int_equal(lao_setting_parse(NULL, 1, "1", &s), -1);
    }
}

static void settings_reach_the_uniforms(void **state) {
    fixture f;
    lao_settings s, filled;
    (void)state;
    fixture_begin(&f);
    memset(&s, 0, sizeof s);
    s.width = 0.75f;
    s.preset = 2;
    s.depth_unit = 1;
    f.sets[0].settings = &s;
    f.frame.sphere[3] = 12;
    f.frame.background[0] = 0.5f;
    f.frame.background[3] = 0.5f;
    f.frame.time = 42;
    assert_ok(lao_render(f.context, &f.frame));
    filled = lao_settings_filled(&s);
    assert_memory_equal(core_seen.settings, (char *)&filled + sizeof filled.set,
                        LAO_SETTING_COUNT * sizeof(float));
    assert_true(core_seen.frame.background.x == 0.25f &&
                core_seen.frame.background.w == 0.5f); /* premultiplied */
    assert_true(core_seen.frame.scale.w == 42);
    assert_true(core_seen.frame.host_depth.w == 24); /* differences of depth in mm */
    assert_true(core_seen.frame.target.x == 64 && core_seen.frame.target.y == 48);
    fixture_end(&f);
}

/* -----------------------------------------------------------------------------------------------------------------
 * lines */

/* The texels as words: a point by its x coordinate, a ghost in brackets; chunks by '|'. */
static void texels_as_text(char *text, size_t size) {
    size_t used = 0;
    text[0] = 0;
    for (uint32_t b = 0; b < core_seen.buffer_count; b++) {
        if (core_seen.buffers[b].format != LAO_FORMAT_RGBA32F) {
            continue;
        }
        used += (size_t)snprintf(text + used, size - used, "%s", used ? "| " : "");
        for (uint32_t i = 0; i < core_seen.buffers[b].texel_count; i++) {
            const float *t = core_seen.buffers[b].texels + 4 * i;
            used += (size_t)snprintf(text + used, size - used,
                                     t[3] >= LAO_GHOST_TIME ? "(%g) " : "%g ", (double)t[0]);
        }
    }
}

static void lines_become_texels(void **state) {
    static const struct {
        const char *what;
        uint32_t line_count, point_count, most;
        uint32_t offsets[6];
        float x[12];
        const char *texels;
    } cases[] = {
        {"nothing", 0, 0, 0, {0}, {0}, ""},
        {"a line of no points", 1, 0, 0, {0, 0}, {0}, ""},
        {"a line of one point", 1, 1, 0, {0, 1}, {5}, ""},
        {"one segment", 1, 2, 0, {0, 2}, {1, 2}, "(1) 1 2 (2) "},
        {"ghosts at the ends", 1, 4, 0, {0, 4}, {1, 2, 3, 4}, "(1) 1 2 3 4 (4) "},
        {"two lines", 2, 5, 0, {0, 2, 5}, {1, 2, 3, 4, 5}, "(1) 1 2 (2) (3) 3 4 5 (5) "},
        {"empty and single ones between",
         5,
         5,
         0,
         {0, 2, 2, 3, 3, 5},
         {1, 2, 9, 4, 5},
         "(1) 1 2 (2) (4) 4 5 (5) "},
        {"repeated points", 1, 6, 0, {0, 6}, {1, 1, 2, 2, 2, 3}, "(1) 1 2 3 (3) "},
        {"nothing but repeats", 1, 3, 0, {0, 3}, {4, 4, 4}, ""},
        {"closed", 1, 4, 0, {0, 4}, {1, 2, 3, 1}, "(3) 1 2 3 1 (2) "},
        {"closed with repeats", 1, 7, 0, {0, 7}, {1, 1, 2, 3, 3, 1, 1}, "(3) 1 2 3 1 (2) "},
        {"there and back is not closed", 1, 3, 0, {0, 3}, {1, 2, 1}, "(1) 1 2 1 (1) "},
        {"not finite: split", 1, 6, 0, {0, 6}, {1, 2, NAN, 4, 5, 6}, "(1) 1 2 (2) (4) 4 5 6 (6) "},
        {"not finite: at the ends", 1, 5, 0, {0, 5}, {INFINITY, 2, 3, 4, NAN}, "(2) 2 3 4 (4) "},
        {"not finite: a single point is left", 1, 5, 0, {0, 5}, {1, NAN, 3, -INFINITY, 5}, ""},
        {"a split line is not closed",
         1,
         6,
         0,
         {0, 6},
         {1, 2, 3, NAN, 4, 1},
         "(1) 1 2 3 (3) (4) 4 1 (1) "},
        {"chunks", 1, 6, 5, {0, 6}, {1, 2, 3, 4, 5, 6}, "(1) 1 2 3 4 | 2 3 4 5 6 | 4 5 6 (6) "},
        {"chunks that just fit", 1, 4, 6, {0, 4}, {1, 2, 3, 4}, "(1) 1 2 3 4 (4) "},
        {"chunks of one segment", 1, 3, 4, {0, 3}, {1, 2, 3}, "(1) 1 2 3 | 1 2 3 (3) "},
        {"chunks across lines",
         2,
         4,
         5,
         {0, 2, 4},
         {1, 2, 3, 4},
         "(1) 1 2 (2) (3) | 2 (2) (3) 3 4 | (3) 3 4 (4) "},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fixture f;
        float points[36];
        char text[1024];
        lao_lines lines;
        fixture_begin(&f);
        lao_destroy(f.context);
        core_window_clear();
        core_seen.max_buffer_texels = cases[i].most;
        f.backend = core_backend(0);
        assert_ok(lao_create(&f.desc, &f.context));
        for (int k = 0; k < 12; k++) {
            points[3 * k] = cases[i].x[k];
            points[3 * k + 1] = points[3 * k + 2] = 0;
        }
        f.set.line_count = cases[i].line_count;
        f.set.offsets = cases[i].offsets;
        f.set.points = points;
        f.set.point_count = cases[i].point_count;
        assert_ok(lao_lines_create(f.context, &f.set, &lines));
        texels_as_text(text, sizeof text);
        if (strcmp(text, cases[i].texels) != 0) {
            fail_msg("%s: '%s', not '%s'", cases[i].what, text, cases[i].texels);
        }
        fixture_end(&f);
    }
}

/* Every segment is drawn once, with its neighbours, whatever the longest buffer. */
static void chunks_repeat_and_lose_nothing(void **state) {
    uint32_t seed = 2;
    (void)state;
    for (uint32_t most = 4; most < 40; most++) {
        fixture f;
        float points[3 * 60];
        uint32_t offsets[6] = {0, 7, 9, 30, 30, 60}, whole, segments = 0, texels = 0;
        for (int i = 0; i < 180; i++) {
            points[i] = (float)core_between(&seed, -9, 9);
        }
        memset(&f, 0, sizeof f);
        fixture_begin(&f);
        f.set.line_count = 5;
        f.set.offsets = offsets;
        f.set.points = points;
        f.set.point_count = 60;
        lao_destroy(f.context);
        core_window_clear();
        f.backend = core_backend(0);
        assert_ok(lao_create(&f.desc, &f.context));
        assert_ok(lao_lines_create(f.context, &f.set, &f.lines));
        whole = core_seen.buffers[0].texel_count;
        assert_int_equal(whole, 60 + 2 * 4);
        lao_destroy(f.context);
        {
            static float all[4 * CORE_TEXELS];
            memcpy(all, core_seen.buffers[0].texels, sizeof all);
            core_window_clear();
            core_seen.max_buffer_texels = most;
            f.backend = core_backend(0);
            assert_ok(lao_create(&f.desc, &f.context));
            assert_ok(lao_lines_create(f.context, &f.set, &f.lines));
            for (uint32_t b = 0;
                 b < core_seen.buffer_count && core_seen.buffer_count < CORE_BUFFERS; b += 2) {
                uint32_t count = core_seen.buffers[b].texel_count;
                assert_true(count <= most && count >= 4);
                assert_int_equal(core_seen.buffers[b + 1].texel_count, count);
                assert_memory_equal(core_seen.buffers[b].texels, all + 4 * segments, count * 16);
                segments += count - 3;
                texels += count;
            }
            if (core_seen.buffer_count < CORE_BUFFERS) {
                assert_int_equal(segments, whole - 3);
                assert_int_equal(texels, whole - 3 + 3 * (core_seen.buffer_count / 2));
            }
        }
        fixture_end(&f);
    }
}

static void attributes_follow_their_points(void **state) {
    static const uint8_t colors[4 * 6] = {1, 1, 1, 255, 2, 2, 2, 255, 3, 3, 3, 255,
                                          4, 4, 4, 255, 5, 5, 5, 255, 6, 6, 6, 255};
    static const float times[6] = {10, 20, 30, 40, 50, 60};
    static const float loop[] = {0, 0, 0, 1, 0, 0, 1, 0, 0,
                                 1, 1, 0, 0, 1, 0, 0, 0, 0}; /* one point twice, closed */
    fixture f;
    const float *t;
    const uint8_t *c;
    (void)state;
    fixture_begin(&f);
    core_seen.buffer_count = 0;
    f.set.line_count = 1;
    f.set.offsets = NULL;
    f.set.points = loop;
    f.set.times = times;
    f.set.colors = colors;
    assert_ok(lao_lines_update(f.context, f.lines, &f.set));
    assert_int_equal(core_seen.buffer_count, 3);           /* points, colors, order of segments */
    assert_int_equal(core_seen.buffers[0].texel_count, 7); /* ghost 1 2 4 5 6 ghost */
    t = core_seen.buffers[0].texels;
    c = (const uint8_t *)core_seen.buffers[1].texels;
    assert_true(t[4 * 1 + 3] == 10 && t[4 * 2 + 3] == 20 && t[4 * 3 + 3] == 40 &&
                t[4 * 5 + 3] == 60);
    assert_true(c[4 * 1] == 1 && c[4 * 2] == 2 && c[4 * 3] == 4 && c[4 * 5] == 6);
    assert_true(t[3] >= LAO_GHOST_TIME && t[4 * 6 + 3] >= LAO_GHOST_TIME);
    assert_true(t[0] == 0 && t[1] == 1 && t[4 * 6] == 1 &&
                t[4 * 6 + 1] == 0); /* the points beyond the seam */
    /* one colour, rounded; none: sand */
    core_seen.buffer_count = 0;
    f.set.colors = NULL;
    f.set.color[0] = 0.5f;
    f.set.color[1] = 2;
    f.set.color[2] = -1;
    f.set.color[3] = 1;
    assert_ok(lao_lines_update(f.context, f.lines, &f.set));
    c = (const uint8_t *)core_seen.buffers[1].texels;
    assert_true(c[4] == 128 && c[5] == 255 && c[6] == 0 && c[7] == 255);
    core_seen.buffer_count = 0;
    memset(f.set.color, 0, sizeof f.set.color);
    assert_ok(lao_lines_update(f.context, f.lines, &f.set));
    c = (const uint8_t *)core_seen.buffers[1].texels;
    assert_true(c[4] > c[5] && c[5] > c[6] && c[6] > 0 && c[7] == 255);
    fixture_end(&f);
}

static void bounds_and_the_scene_sphere(void **state) {
    static const float points[] = {-1, 2, -10, 5, NAN, 100, 3, 8, -20};
    static const float far[] = {99, 0, -50, 101, 0, -50};
    fixture f;
    float b[2][3];
    lao_lines other, empty;
    lao_lines_desc none;
    (void)state;
    fixture_begin(&f);
    f.set.line_count = 1;
    f.set.offsets = NULL;
    f.set.points = points;
    f.set.point_count = 3;
    assert_ok(lao_lines_update(f.context, f.lines, &f.set));
    assert_ok(lao_lines_bounds(f.context, f.lines, b));
    assert_true(b[0][0] == -1 && b[0][1] == 2 && b[0][2] == -20 && b[1][0] == 3 && b[1][1] == 8 &&
                b[1][2] == -10);
    assert_ok(lao_render(f.context, &f.frame)); /* centre (1, 5, -15), half diagonal */
    assert_true(fabsf(core_seen.frame.depth.z - sqrtf(16 + 36 + 100)) < 1e-4f);
    assert_true(fabsf(core_seen.frame.depth.x - (15 - 0.5f * sqrtf(152))) < 1e-4f);
    f.set.points = far;
    f.set.point_count = 2;
    assert_ok(lao_lines_create(f.context, &f.set, &other));
    memset(&none, 0, sizeof none);
    assert_ok(lao_lines_create(f.context, &none, &empty));
    f.sets[0].lines = empty; /* counts for nothing, first or last */
    f.sets[1].lines = f.lines;
    f.sets[2].lines = other;
    f.frame.set_count = 3;
    assert_ok(lao_render(f.context, &f.frame));
    assert_true(fabsf(core_seen.frame.depth.z - sqrtf(102 * 102 + 8 * 8 + 40 * 40)) < 1e-3f);
    f.frame.sphere[0] = 0; /* the host's own */
    f.frame.sphere[2] = -30;
    f.frame.sphere[3] = 7;
    assert_ok(lao_render(f.context, &f.frame));
    assert_true(fabsf(core_seen.frame.depth.x - 23) < 1e-5f &&
                fabsf(core_seen.frame.depth.z - 14) < 1e-5f);
    f.frame.sphere[3] = 0; /* nothing to see: half a line width */
    f.sets[0].lines = empty;
    f.frame.set_count = 1;
    assert_ok(lao_render(f.context, &f.frame));
    assert_true(core_seen.frame.depth.z == 0.5f);
    fixture_end(&f);
}

/* ----------------------------------------------------------------------------------------------------------
 * all log items */

static void every_log_item_of_the_core_was_seen(void **state) {
    /* Backends alone report these; LINES_COUNT takes four thousand million points; objects have a
       test program of their own (test_objects). */
    static const lao_log_item elsewhere[] = {LAO_LOG_BACKEND_FUNCTION, LAO_LOG_BACKEND_FEATURE,
                                             LAO_LOG_DEVICE_MEMORY,    LAO_LOG_SHADER_COMPILE,
                                             LAO_LOG_BACKEND_STATE,    LAO_LOG_DEVICE_LOST,
                                             LAO_LOG_LINES_COUNT,      LAO_LOG_OBJECT_BUFFER,
                                             LAO_LOG_OBJECT_MEMORY,    LAO_LOG_OBJECT_HANDLE};
    (void)state;
    for (int i = 0; i < LAO_LOG_ITEM_COUNT; i++) {
        int expected = 1;
        for (size_t k = 0; k < sizeof elsewhere / sizeof elsewhere[0]; k++) {
            expected &= (int)elsewhere[k] != i;
        }
        if (expected && !seen[i]) {
            fail_msg("no test reaches %s", item_names[i]);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(results_have_words),
        cmocka_unit_test(null_arguments),
        cmocka_unit_test(zero_is_a_good_default),
        cmocka_unit_test(stale_handles),
        cmocka_unit_test(two_contexts_are_strangers),
        cmocka_unit_test(wrong_arguments),
        cmocka_unit_test(memory_that_was_used_again_is_not_read),
        cmocka_unit_test(limits_of_the_device),
        cmocka_unit_test(broken_modules_are_refused),
        cmocka_unit_test(memory_gives_out_at_any_allocation),
        cmocka_unit_test(the_backend_fails_at_any_call),
        cmocka_unit_test(rendering_allocates_nothing_twice),
        cmocka_unit_test(a_failed_frame_does_not_spoil_the_next),
        cmocka_unit_test(settings_table),
        cmocka_unit_test(settings_from_text),
        cmocka_unit_test(settings_reach_the_uniforms),
        cmocka_unit_test(lines_become_texels),
        cmocka_unit_test(chunks_repeat_and_lose_nothing),
        cmocka_unit_test(attributes_follow_their_points),
        cmocka_unit_test(bounds_and_the_scene_sphere),
        cmocka_unit_test(every_log_item_of_the_core_was_seen), /* last: looks back at all of them */
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
