/* Proves that a trail draws the segments that its window reaches, each once, and few others: the
   order of segments holds every one that has times, its groups tell their times, and the ranges of
   a frame hold whatever the vertex stage would keep, whatever the times, the period and the day;
   and that the parts of many lines are all of them, each line once. */
#include "core_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST_TEXELS = 70000, MOST_RANGES = 300, MOST_ROWS = 8, MOST_CHUNKS = 1024 };

/* What went through the seam. */
static struct {
    float points[4 * MOST_TEXELS], order[MOST_TEXELS];
    uint32_t point_count, order_count; /* texels; 0: no such buffer */
    lao_range ranges[MOST_RANGES];
    uint32_t range_count, segment_count;
    lao_range rows[MOST_ROWS][MOST_CHUNKS]; /* the first range of each row of a frame */
    uint32_t counts[MOST_CHUNKS];           /* segments */
    uint32_t row_count, chunk_count;
    lao_group groups[300];
    uint32_t group_count;
    int foreign; /* the rows do not read the order */
} seen;

static lao_backend inner;

static lao_result keep_buffer(void *self, const lao_buffer_desc *desc, void **buffer) {
    assert_true(desc->texel_count <= MOST_TEXELS);
    if (desc->format == LAO_FORMAT_RGBA32F) {
        memcpy(seen.points, desc->data, 16 * (size_t)desc->texel_count);
        seen.point_count = desc->texel_count;
        seen.order_count = 0;
    } else if (desc->format == LAO_FORMAT_R32F) {
        memcpy(seen.order, desc->data, 4 * (size_t)desc->texel_count);
        seen.order_count = desc->texel_count;
    }
    return inner.buffer_create(self, desc, buffer);
}

static void keep_ranges(const lao_execution *execution, lao_plan_step step) {
    const lao_chunk *chunks;
    seen.chunk_count = lao_step_draws(execution, &step, &chunks);
    assert_in_range(seen.chunk_count, 1, MOST_CHUNKS);
    assert_true(seen.row_count < MOST_ROWS);
    step.read_count = seen.foreign ? 2 : step.read_count;
    for (uint32_t i = 0; i < seen.chunk_count; i++) {
        lao_range range = {0, 0, 0};
        seen.segment_count = chunks[i].count;
        seen.group_count = chunks[i].group_count;
        if (chunks[i].groups)
            memcpy(seen.groups, chunks[i].groups, chunks[i].group_count * sizeof *seen.groups);
        for (seen.range_count = 0; lao_step_range(execution, &step, &chunks[i], &range);) {
            assert_true(seen.range_count < MOST_RANGES);
            seen.ranges[seen.range_count++] = range;
        }
        assert_false(lao_step_range(execution, &step, &chunks[i], &range)); /* over stays over */
        seen.counts[i] = chunks[i].count;
        seen.rows[seen.row_count][i] = seen.range_count ? seen.ranges[0] : range;
    }
    seen.row_count++;
}

static lao_result keep_draws(void *self, void *view, const lao_execution *execution) {
    seen.row_count = 0;
    for (uint32_t i = 0; i < execution->plan->step_count; i++) {
        if (LAO_PASS_DRAWS_LINES(execution->plan->steps[i].row->kind))
            keep_ranges(execution, execution->plan->steps[i]);
    }
    return inner.execute(self, view, execution);
}

/* ---- a context with one set --------------------------------------------------------------------
 */

typedef struct fixture {
    core_host host;
    lao_backend backend;
    lao_context *context;
    lao_lines lines;
    lao_settings settings;
    lao_set set;
    lao_frame frame;
    float *points, *times;
    uint32_t *offsets;
    lao_lines_desc desc;
} fixture;

static void begin_in(fixture *f, uint32_t line_count, uint32_t length, uint32_t most_texels) {
    const lao_view_desc size = {16, 16, 0};
    const uint32_t n = line_count * length;
    lao_desc desc;
    memset(f, 0, sizeof *f);
    memset(&seen, 0, sizeof seen);
    memset(&desc, 0, sizeof desc);
    core_window_clear();
    core_seen.max_buffer_texels = most_texels;
    inner = core_backend(0);
    f->backend = inner;
    f->backend.buffer_create = keep_buffer;
    f->backend.execute = keep_draws;
    desc.backend = &f->backend;
    desc.allocator = lent_allocator(&f->host.memory);
    desc.logger = core_logger(&f->host);
    assert_int_equal(lao_create(&desc, &f->context), LAO_OK);
    assert_int_equal(lao_view_create(f->context, &size, &f->frame.view), LAO_OK);
    f->points = calloc(3 * (size_t)n, sizeof *f->points);
    f->times = calloc(n, sizeof *f->times);
    f->offsets = calloc(line_count + (size_t)1, sizeof *f->offsets);
    assert_true(f->points && f->times && f->offsets);
    for (uint32_t i = 0; i < n; i++)
        f->points[3 * i] = (float)i;
    for (uint32_t i = 0; i <= line_count; i++)
        f->offsets[i] = i * length;
    f->desc.line_count = line_count;
    f->desc.point_count = n;
    f->desc.offsets = f->offsets;
    f->desc.points = f->points;
    f->desc.times = f->times;
    f->settings.trail = LAO_TRAIL_TAPER;
    f->set.settings = &f->settings;
    f->frame.camera = core_camera();
    f->frame.sets = &f->set;
    f->frame.set_count = 1;
}

static void begin(fixture *f, uint32_t line_count, uint32_t length) {
    begin_in(f, line_count, length, 0);
}

static void upload(fixture *f) {
    lao_result result = f->lines.id ? lao_lines_update(f->context, f->lines, &f->desc)
                                    : lao_lines_create(f->context, &f->desc, &f->lines);
    assert_int_equal(result, LAO_OK);
    f->set.lines = f->lines;
}

static void draw(fixture *f, double time) {
    f->frame.time = (float)time;
    assert_int_equal(lao_render(f->context, &f->frame), LAO_OK);
}

static void end(fixture *f) {
    lao_destroy(f->context);
    assert_int_equal(f->host.memory.bytes, 0);
    free(f->points);
    free(f->times);
    free(f->offsets);
}

/* ---- oracles
 * ------------------------------------------------------------------------------------- */

static int timed(uint32_t segment) {
    return seen.points[4 * (segment + 1) + 3] < 1e30f && seen.points[4 * (segment + 2) + 3] < 1e30f;
}

/* Every segment with times stands in the order once, in a group that knows them. */
static void check_order(void) {
    uint32_t count = 0, filled = 0;
    uint8_t *found = calloc(seen.point_count, 1);
    assert_non_null(found);
    for (uint32_t i = 0; i + 3 < seen.point_count; i++)
        count += (uint32_t)timed(i);
    for (uint32_t g = 0; g < seen.group_count; g++) {
        const lao_group *group = &seen.groups[g];
        assert_int_equal(group->first, filled);
        assert_true(group->count > 0 && group->begin <= group->end);
        assert_true(g == 0 || group->begin >= seen.groups[g - 1].begin);
        for (uint32_t k = 0; k < group->count; k++) {
            uint32_t segment = (uint32_t)seen.order[filled + k];
            float a = seen.points[4 * (segment + 1) + 3], b = seen.points[4 * (segment + 2) + 3];
            assert_true(timed(segment) && !found[segment]++);
            assert_true(fminf(a, b) >= group->begin && fmaxf(a, b) <= group->end);
            assert_true(k == 0 || seen.order[filled + k] > seen.order[filled + k - 1]);
        }
        filled += group->count;
    }
    assert_int_equal(filled, count);
    assert_int_equal(seen.order_count, count ? count : 1);
    free(found);
}

/* Nothing that the vertex stage would keep is left out; returns how many segments are drawn and,
 * in *kept, how many of them it keeps. */
static uint32_t check_ranges(const fixture *f, uint32_t *kept) {
    const lao_settings all = lao_settings_filled(&f->settings);
    const float now = lao_trail_now(f->frame.time, all.period);
    uint8_t *drawn = calloc(seen.point_count, 1);
    uint32_t count = 0;
    assert_non_null(drawn);
    for (uint32_t r = 0; r < seen.range_count; r++) {
        const lao_range *range = &seen.ranges[r];
        assert_true(range->count > 0 && range->first + range->count <= seen.order_count);
        assert_true(r == 0 || range->first > seen.ranges[r - 1].first + seen.ranges[r - 1].count);
        for (uint32_t k = 0; k < range->count; k++)
            drawn[(uint32_t)seen.order[range->first + k]] = 1;
        count += range->count;
    }
    *kept = 0;
    for (uint32_t i = 0; i + 3 < seen.point_count; i++) {
        lao_trail_part part =
            lao_trail_clip(seen.points[4 * (i + 1) + 3], seen.points[4 * (i + 2) + 3], now,
                           all.trail_length, all.period);
        if (timed(i) && part.first < part.last) {
            assert_true(drawn[i]);
            *kept += 1;
        }
    }
    free(drawn);
    return count;
}

/* ---- tests
 * ------------------------------------------------------------------------------------------ */

/* 500 lines of 100 points, 8 ms apart, that begin at any time of a beat: of 50 ms that repeat, and
 * that do not. */
static void few_others_are_drawn(void **state) {
    uint32_t seed = 1, kept;
    fixture f;
    (void)state;
    begin(&f, 500, 100);
    for (uint32_t i = 0; i < 500; i++) {
        double start = core_between(&seed, -833, 833);
        for (uint32_t k = 0; k < 100; k++)
            f.times[100 * i + k] = (float)(start + 8.0 * k);
    }
    upload(&f);
    for (int i = 0; i < 200; i++) {
        f.settings.period = i & 1 ? 833.0f : 0.0f;
        draw(&f, core_between(&seed, -1000, 2000));
        if (i == 0)
            check_order();
        uint32_t drawn = check_ranges(&f, &kept);
        assert_true(drawn <= 1.5 * kept + 3 * 500 * 100 / 256);
    }
    end(&f);
}

static void windows_wrap(void **state) {
    uint32_t kept;
    fixture f;
    (void)state;
    begin(&f, 1, 834);
    for (uint32_t k = 0; k < 834; k++)
        f.times[k] = (float)k;
    upload(&f);
    f.settings.period = 833;
    draw(&f, 400);
    assert_int_equal(seen.range_count, 1);
    assert_in_range(check_ranges(&f, &kept), 50, 60);
    draw(&f, 833 * 5 + 10); /* over the beat's end */
    assert_int_equal(seen.range_count, 2);
    assert_int_equal(seen.ranges[0].first, 0);
    assert_int_equal(seen.ranges[1].first + seen.ranges[1].count, 833);
    assert_in_range(check_ranges(&f, &kept), 50, 64);
    f.settings.period = 100; /* the line lasts eight and a third of them */
    draw(&f, 50);
    assert_int_equal(seen.range_count, 9);
    check_ranges(&f, &kept);
    f.settings.trail_length = 50; /* a window as long as the period shows everything */
    draw(&f, 50);
    assert_int_equal(seen.range_count, 1);
    assert_int_equal(check_ranges(&f, &kept), 833);
    f.settings.period = 0;
    f.settings.trail_length = 1e6f;
    draw(&f, 0);
    assert_int_equal(seen.range_count, 1);
    assert_int_equal(check_ranges(&f, &kept), 833);
    f.settings.trail_length = 25;
    draw(&f, 5000);
    assert_int_equal(seen.range_count, 0);
    end(&f);
}

/* Other modes, other rows and lines without times: all segments as they are. */
static void others_draw_everything(void **state) {
    static const int trails[3] = {LAO_TRAIL_NONE, LAO_TRAIL_HIGHLIGHT, LAO_TRAIL_TAPER};
    fixture f;
    (void)state;
    for (int i = 0; i < 3; i++) {
        begin(&f, 3, 10);
        f.settings.trail = (float)trails[i];
        seen.foreign = i == 2;
        upload(&f);
        draw(&f, 1e6);
        assert_int_equal(seen.range_count, 1);
        assert_int_equal(seen.ranges[0].first, 0);
        assert_int_equal(seen.ranges[0].count, 33);
        end(&f);
    }
    begin(&f, 3, 10);
    f.desc.times = NULL;
    upload(&f);
    assert_int_equal(seen.order_count, 0);
    draw(&f, 1e6);
    assert_int_equal(seen.range_count, 1);
    assert_int_equal(seen.ranges[0].count, 33);
    f.desc.times = f.times; /* an update brings them */
    upload(&f);
    draw(&f, 1e6);
    check_order();
    assert_int_equal(seen.range_count, 0);
    draw(&f, 0);
    assert_int_equal(seen.range_count, 1);
    assert_int_equal(seen.ranges[0].count, 27);
    end(&f);
}

/* Times of any size and order, some none: nothing is lost and nothing breaks. */
static void any_times(void **state) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, 0, -0.0f, 1e-40f, 1e29f, -1e29f, 3.4e38f};
    uint32_t seed = 7, kept;
    (void)state;
    for (int i = 0; i < 120; i++) {
        const double size = pow(10, core_between(&seed, -3, 9));
        fixture f;
        begin(&f, 1 + core_random(&seed) % 9, 2 + core_random(&seed) % 90);
        for (uint32_t k = 0; k < f.desc.point_count; k++) {
            f.times[k] = (float)(core_between(&seed, -1, 1) * size);
            if (i % 3 == 0 && core_random(&seed) % 5 == 0)
                f.times[k] = odd[core_random(&seed) % (i % 2 ? 4 : 9)];
            if (i == 10 || i == 11)
                f.times[k] = i == 10 ? NAN : 5;
        }
        upload(&f);
        for (int k = 0; k < 20; k++) {
            f.settings.trail_length = (float)fmax(size * core_between(&seed, 0, 0.3), 0.001);
            f.settings.trail_length = fminf(f.settings.trail_length, 1e6f);
            f.settings.period = k % 2 ? 0 : (float)fmin(size * core_between(&seed, 0, 3), 1e6);
            draw(&f, core_between(&seed, -4, 4) * size);
            check_order();
            if (i % 3)
                check_ranges(&f, &kept);
        }
        draw(&f, (double)NAN);
        draw(&f, (double)INFINITY);
        end(&f);
    }
}

/* Many lines in a small picture are drawn in parts: every eighth line, every eighth, every fourth
   and every second. */
static void parts_are_everything(void **state) {
    static const struct {
        uint32_t first, step, count; /* lines */
    } parts[LAO_PARTS] = {{0, 8, 13}, {4, 8, 13}, {2, 4, 25}, {1, 2, 50}};
    uint32_t line = 0;
    fixture f;
    (void)state;
    begin(&f, 101, 10);
    f.settings.trail = 0;
    upload(&f);
    draw(&f, 0);
    assert_int_equal(seen.row_count, LAO_PARTS);
    for (uint32_t i = 0; i < LAO_PARTS; i++) {
        const uint32_t end = i + 1 < LAO_PARTS ? 12 * (line + parts[i].count) : seen.segment_count;
        assert_int_equal(seen.rows[i][0].first, 12 * line); /* a line between its ghosts */
        assert_int_equal(seen.rows[i][0].first + seen.rows[i][0].count, end);
        for (uint32_t k = 0; k < parts[i].count; k++, line++) { /* x counts points */
            uint32_t expected = 10 * (parts[i].first + parts[i].step * k);
            assert_true(seen.points[4 * (12 * line + 1)] == (float)expected);
        }
    }
    assert_int_equal(line, 101);
    f.settings.set = LAO_SET(cull_hidden);
    draw(&f, 0);
    assert_int_equal(seen.row_count, 1);
    assert_int_equal(seen.ranges[0].first, 0);
    assert_int_equal(seen.ranges[0].count, seen.segment_count);
    end(&f);
}

/* However short buffers are: the parts of each are all of it. */
static void parts_of_chunks(void **state) {
    uint32_t seed = 5;
    (void)state;
    for (int i = 0; i < 60; i++) {
        fixture f;
        begin_in(&f, 64 + core_random(&seed) % 40, 2 + core_random(&seed) % 9,
                 4 + core_random(&seed) % 300);
        f.settings.trail = 0;
        upload(&f);
        draw(&f, 0);
        assert_int_equal(seen.row_count, LAO_PARTS);
        for (uint32_t c = 0; c < seen.chunk_count; c++) {
            uint32_t drawn = 0;
            for (uint32_t row = 0; row < seen.row_count; row++) {
                if (seen.rows[row][c].count > 0)
                    assert_int_equal(seen.rows[row][c].first, drawn);
                drawn += seen.rows[row][c].count;
            }
            assert_int_equal(drawn, seen.counts[c]);
        }
        end(&f);
    }
}

/* A refused allocation refuses the set, and nothing leaks. */
static void memory_runs_out(void **state) {
    fixture f;
    uint32_t n = 1, failed = 0;
    (void)state;
    begin(&f, 3, 10);
    for (;; n++) {
        lao_lines lines = {0};
        f.host.memory.fail_allocation = f.host.memory.allocations + n;
        if (lao_lines_create(f.context, &f.desc, &lines) == LAO_OK)
            break;
        assert_int_equal(f.host.result, LAO_ERROR_OUT_OF_MEMORY);
        assert_int_equal(lines.id, 0);
        failed++;
    }
    f.host.memory.fail_allocation = 0;
    assert_true(failed >= 7); /* set, points, colors, chunks, bins, order, groups */
    end(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(few_others_are_drawn),   cmocka_unit_test(windows_wrap),
        cmocka_unit_test(others_draw_everything), cmocka_unit_test(any_times),
        cmocka_unit_test(parts_are_everything),   cmocka_unit_test(parts_of_chunks),
        cmocka_unit_test(memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
