/* Objects of further modules: their buffers reach the rows that name them, rows run stage by stage
   and only for sets that bring what they need, and a broken object changes nothing. */
#include "core_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { SCALES, CORNERS_ROW, BUFFERS = 2 };

typedef struct probe_settings {
    uint64_t set;
    float probe_on, probe_gain;
} probe_settings;

static const lao_buffer_row buffers[BUFFERS] = {{"scales", LAO_FORMAT_R32F},
                                                {"corners", LAO_FORMAT_RGBA32F}};
static const lao_setting_row settings[2] = {
    {"probe_on", LAO_SETTING_BOOL, 0, 1, 1, 1, "", "", "draw the probe"},
    {"probe_gain", LAO_SETTING_FLOAT, 0, 10, 2, 0, "", "", "a number for the shader"}};

static const char *const constants[3] = {"has_scales", "has_corners", "probe_gain"};

typedef struct probe {
    lao_shader shader;
    lao_image_row images[2];
    lao_pass_row passes[4];
    lao_module module;
    const lao_module *modules[1];
} probe;

static lao_reference of(const char *image, lao_load load) {
    lao_reference reference;
    memset(&reference, 0, sizeof reference);
    reference.image = image;
    reference.load = load;
    return reference;
}

static lao_image_row image_row(const char *name, lao_size size) {
    lao_image_row row;
    memset(&row, 0, sizeof row);
    row.name = name;
    row.format = LAO_FORMAT_RGBA32F;
    row.size = size;
    return row;
}

/* Table order is not stage order: over, measure, draw, tint. */
static void probe_fill(probe *p) {
    static const char *const names[4] = {"over", "measure", "draw", "tint"};
    static const lao_stage stages[4] = {LAO_STAGE_COMPOSE, LAO_STAGE_DRAW, LAO_STAGE_DRAW,
                                        LAO_STAGE_SHADE};
    memset(p, 0, sizeof *p);
    p->images[0] = image_row("measures", LAO_SIZE_ITEMS);
    p->images[1] = image_row("mesh", LAO_SIZE_FULL);
    for (int i = 0; i < 4; i++) {
        p->passes[i].name = names[i];
        p->passes[i].shader = "none";
        p->passes[i].stage = stages[i];
        p->passes[i].scope = i == 0 ? LAO_SCOPE_FRAME : LAO_SCOPE_PER_SET;
    }
    p->passes[0].writes[0] = of("shaded", LAO_LOAD_KEEP);
    p->passes[0].reads[0] = of("mesh", LAO_LOAD_DISCARD);
    p->passes[1].writes[0] = of("measures", LAO_LOAD_DISCARD);
    p->passes[1].reads[0] = of("#scales", LAO_LOAD_DISCARD);
    p->passes[2].kind = LAO_PASS_DRAW_MESH;
    p->passes[2].writes[0] = of("mesh", LAO_LOAD_CLEAR);
    p->passes[2].reads[0] = of("measures", LAO_LOAD_DISCARD);
    p->passes[2].reads[1] = of("#corners", LAO_LOAD_DISCARD);
    p->passes[3].writes[0] = of("shaded", LAO_LOAD_KEEP);
    p->passes[3].reads[0] = of("mesh", LAO_LOAD_DISCARD);
    for (int i = 1; i < 4; i++) {
        p->passes[i].when[0].name = "#corners";
        p->passes[i].when[0].compare = '>';
        p->passes[i].when[1].name = "probe_on";
        p->passes[i].when[1].compare = '=';
        p->passes[i].when[1].value = 1;
    }
    p->passes[0].when[0].name = "probe_on"; /* of the first set that has it on */
    p->passes[0].when[0].compare = '=';
    p->passes[0].when[0].value = 1;
    p->module.name = "probe";
    p->module.passes = p->passes;
    p->module.pass_count = 4;
    p->module.images = p->images;
    p->module.image_count = 2;
    p->module.settings = settings;
    p->module.setting_count = 2;
    p->module.buffers = buffers;
    p->module.buffer_count = BUFFERS;
    p->shader.name = "none";
    p->shader.constants = constants;
    p->shader.constant_count = 3;
    p->module.shaders = &p->shader;
    p->module.shader_count = 1;
    p->modules[0] = &p->module;
}

/* ---------------------------------------------------------------------------------------------
 * a context with the module, a view, a line set and an object */

static const float corners[9][4] = {{0, 0, -20, 1}, {4, 0, -20, 1}, {0, 4, -20, 1}};
static const float scales[5] = {1, 2, 3, 4, 5};

typedef struct fixture {
    probe probe;
    core_host host;
    lao_backend backend;
    lao_desc desc;
    lao_context *context;
    lao_view view;
    lao_lines lines;
    lao_object object;
    lao_object_buffer both[2];
    lao_object_desc source;
    lao_set sets[3];
    lao_frame frame;
} fixture;

static void describe(fixture *f) {
    memset(f->both, 0, sizeof f->both);
    memset(&f->source, 0, sizeof f->source);
    f->both[0].name = "corners";
    f->both[0].data = corners;
    f->both[0].texel_count = 9;
    f->both[1].name = "scales";
    f->both[1].data = scales;
    f->both[1].texel_count = 5;
    f->source.buffers = f->both;
    f->source.buffer_count = 2;
    f->source.triangle_count = 3;
    f->source.item_count = 5;
    f->source.bounds[0][2] = -20;
    f->source.bounds[1][0] = f->source.bounds[1][1] = 4;
    f->source.bounds[1][2] = -20;
}

static void begin(fixture *f) {
    static const float points[6] = {0, 0, -20, 5, 1, -22};
    lao_view_desc size = {64, 48, LAO_VIEW_KEEP_IMAGES};
    lao_lines_desc line;
    memset(f, 0, sizeof *f);
    memset(&line, 0, sizeof line);
    core_window_clear();
    probe_fill(&f->probe);
    f->backend = core_backend(0);
    f->desc.backend = &f->backend;
    f->desc.allocator = lent_allocator(&f->host.memory);
    f->desc.logger = core_logger(&f->host);
    f->desc.modules = f->probe.modules;
    f->desc.module_count = 1;
    assert_int_equal(lao_create(&f->desc, &f->context), LAO_OK);
    line.line_count = 1;
    line.point_count = 2;
    line.points = points;
    describe(f);
    assert_int_equal(lao_lines_create(f->context, &line, &f->lines), LAO_OK);
    assert_int_equal(lao_object_create(f->context, &f->source, &f->object), LAO_OK);
    assert_int_equal(lao_view_create(f->context, &size, &f->view), LAO_OK);
    f->frame.view = f->view;
    f->frame.camera = core_camera();
    f->frame.sets = f->sets;
    f->frame.set_count = 1;
    f->sets[0].object = f->object;
}

static void end(fixture *f) {
    lao_destroy(f->context);
    assert_int_equal(f->host.memory.bytes, 0);
    assert_int_equal(core_seen.buffers_alive, 0);
}

/* Number of steps of the last frame's plan with that row name; the last one in *found. */
static uint32_t steps_of(const char *name, const lao_plan_step **found) {
    uint32_t i, count = 0;
    for (i = 0; i < core_seen.plan->step_count; i++) {
        if (strcmp(core_seen.plan->steps[i].row->name, name) == 0) {
            count++;
            if (found) {
                *found = &core_seen.plan->steps[i];
            }
        }
    }
    return count;
}

/* ---------------------------------------------------------------------------------------- tests */

static void rows_run_stage_by_stage(void **state) {
    static const char *const order[] = {"lines_halo", "measure",  "draw",      "level_zero",
                                        "level_one",  "level_up", "occlusion", "shade",
                                        "tint",       "over",     "resolve"};
    fixture f;
    (void)state;
    begin(&f);
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(core_seen.plan->step_count, sizeof order / sizeof order[0]);
    for (uint32_t i = 0; i < core_seen.plan->step_count; i++) {
        assert_string_equal(core_seen.plan->steps[i].row->name, order[i]);
    }
    end(&f);
}

static void a_set_without_the_buffers_has_no_such_steps(void **state) {
    fixture f;
    (void)state;
    begin(&f);
    f.sets[1].lines = f.lines;
    f.frame.set_count = 2;
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("draw", NULL), 1);
    assert_int_equal(steps_of("lines_halo", NULL), 2);
    f.sets[1].object = f.object; /* a plan of its own */
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("draw", NULL), 2);
    end(&f);
}

static void items_have_an_image(void **state) {
    static const uint32_t counts[5][3] = {
        {1, 1, 1}, {2048, 2048, 1}, {2049, 2048, 2}, {4096, 2048, 2}, {1000000, 2048, 489}};
    const lao_plan_step *step = NULL;
    fixture f;
    (void)state;
    begin(&f);
    for (int i = 0; i < 5; i++) {
        f.source.item_count = counts[i][0];
        assert_int_equal(lao_object_update(f.context, f.object, &f.source), LAO_OK);
        assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
        assert_int_equal(steps_of("measure", &step), 1);
        assert_int_equal(step->width, counts[i][1]);
        assert_int_equal(step->height, counts[i][2]);
    }
    { /* of several sets the largest counts */
        lao_object small;
        f.source.item_count = 3;
        assert_int_equal(lao_object_create(f.context, &f.source, &small), LAO_OK);
        f.sets[1].object = small;
        f.frame.set_count = 2;
        assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
        assert_int_equal(steps_of("measure", &step), 2);
        assert_int_equal(step->height, 489);
    }
    { /* of another kind */
        f.probe.images[0].width = 3;
        f.source.further_items[2] = 5000;
        assert_int_equal(lao_object_update(f.context, f.object, &f.source), LAO_OK);
        assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
        assert_int_equal(steps_of("measure", &step), 2);
        assert_int_equal(step->width, 2048);
        assert_int_equal(step->height, 3);
    }
    end(&f);
}

static void a_shader_knows_what_a_set_has(void **state) {
    const lao_plan_step *step = NULL;
    lao_object without;
    fixture f;
    (void)state;
    begin(&f);
    f.source.buffer_count = 1;
    assert_int_equal(lao_object_create(f.context, &f.source, &without), LAO_OK);
    f.sets[0].object = without;
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("draw", &step), 1);
    assert_int_equal(step->constants[0], 0);
    assert_int_equal(step->constants[1], 1);
    end(&f);
}

static void a_step_finds_its_buffers(void **state) {
    const lao_plan_step *step = NULL;
    lao_execution execution;
    lao_chunk object;
    lao_draw draw;
    const lao_chunk *chunks = NULL;
    fixture f;
    (void)state;
    begin(&f);
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("draw", &step), 1);
    assert_int_equal(step->constants[0], 1);
    assert_int_equal(step->constants[1], 1);
    assert_int_equal(step->constants[2], 2);
    /* the line module's three buffers stand before ours */
    assert_int_equal(step->reads[1], LAO_READ_BUFFER + 3 + CORNERS_ROW);
    assert_true(LAO_READ_IS_BUFFER(step->reads[1]));
    assert_false(LAO_READ_IS_BUFFER(step->reads[0]));
    assert_false(LAO_READ_IS_BUFFER(LAO_NO_INDEX));
    memset(&execution, 0, sizeof execution);
    memset(&object, 0, sizeof object);
    memset(&draw, 0, sizeof draw);
    execution.draws = &draw;
    assert_int_equal(lao_step_draws(&execution, step, &chunks), 0);
    draw.object = &object;
    assert_int_equal(lao_step_draws(&execution, step, &chunks), 0); /* no triangles */
    object.count = 3;
    assert_int_equal(lao_step_draws(&execution, step, &chunks), 1);
    assert_ptr_equal(chunks, &object);
    assert_int_equal(steps_of("measure", &step), 1);
    assert_int_equal(lao_step_draws(&execution, step, &chunks), 1);
    assert_ptr_equal(chunks, &object);
    draw.object = NULL;
    assert_int_equal(lao_step_draws(&execution, step, &chunks), 1);
    assert_null(chunks[0].buffers[0]);
    assert_int_equal(steps_of("lines_halo", &step), 1);
    assert_int_equal(lao_step_draws(&execution, step, &chunks), 0);
    end(&f);
}

static void settings_of_the_module(void **state) {
    probe_settings own;
    const void *given[1];
    fixture f;
    (void)state;
    begin(&f);
    memset(&own, 0, sizeof own);
    given[0] = &own;
    f.sets[0].module_settings = given;
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("draw", NULL), 1);
    own.set = 1; /* probe_on = 0 */
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("draw", NULL), 0);
    assert_int_equal(steps_of("over", NULL), 0);
    own.set = 0;
    own.probe_gain = 11;
    assert_int_equal(lao_render(f.context, &f.frame), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(f.host.item, LAO_LOG_SETTING_RANGE);
    assert_non_null(strstr(f.host.text, "probe_gain"));
    given[0] = NULL;
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    end(&f);
}

/* Lines share a G-buffer; objects are drawn and shaded set by set behind it. */
static void sets_that_occlude_each_other(void **state) {
    static const struct {
        const char *row;
        uint32_t set;
    } order[] = {{"lines_halo", 0}, {"lines_halo", 1}, {"level_zero", 0}, {"level_one", 0},
                 {"level_up", 0},   {"occlusion", 0},  {"shade", 0},      {"measure", 0},
                 {"draw", 0},       {"tint", 0},       {"measure", 2},    {"draw", 2},
                 {"tint", 2},       {"over", 0},       {"resolve", 0}};
    fixture f;
    uint32_t lines = 0;
    (void)state;
    begin(&f);
    f.sets[0].lines = f.sets[1].lines = f.lines;
    f.sets[2].object = f.object;
    f.frame.set_count = 3;
    f.frame.flags = LAO_FRAME_SHARED_OCCLUSION;
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(core_seen.plan->step_count, sizeof order / sizeof order[0]);
    for (uint32_t i = 0; i < core_seen.plan->step_count; i++) {
        const lao_plan_step *step = &core_seen.plan->steps[i];
        assert_string_equal(step->row->name, order[i].row);
        assert_int_equal(step->set, order[i].set);
        if (strcmp(order[i].row, "lines_halo") == 0) { /* the second keeps what the first drew */
            assert_int_equal(step->colors[0].clear, lines == 0);
            assert_int_equal(step->depth.clear, lines == 0);
            lines++;
        } else if (strcmp(order[i].row, "draw") == 0) { /* each clears its own images */
            assert_int_equal(step->colors[0].clear, 1);
        }
    }
    f.frame.flags = 0; /* a plan of its own: each set of lines clears */
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("occlusion", NULL), 2);
    end(&f);
}

/* A set of objects alone leaves the lines' images as they are, unless it is the first one. */
static void lines_are_drawn_where_there_are_any(void **state) {
    static const uint32_t counts[3][2] = {{1, 1}, {2, 1}, {2, 1}}; /* of "shade", of "draw" */
    fixture f;
    (void)state;
    begin(&f);
    for (int i = 0; i < 3; i++) { /* lines, object; object, lines; nothing, object */
        memset(f.sets, 0, sizeof f.sets);
        f.sets[i == 1].lines.id = i < 2 ? f.lines.id : 0;
        f.sets[i != 1].object = f.object;
        f.frame.set_count = 2;
        if (i == 2) { /* and a third that draws nothing */
            f.frame.set_count = 3;
        }
        assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
        assert_int_equal(steps_of("shade", NULL), counts[i][0]);
        assert_int_equal(steps_of("draw", NULL), counts[i][1]);
    }
    end(&f);
}

/* A row of the whole frame goes by the first set that asks for it, with that set's settings. */
static void a_frame_row_follows_the_set_that_asks(void **state) {
    const lao_plan_step *step = NULL;
    probe_settings off, on;
    const void *given[2][1];
    fixture f;
    (void)state;
    begin(&f);
    memset(&off, 0, sizeof off);
    memset(&on, 0, sizeof on);
    off.set = 1; /* probe_on = 0 */
    on.set = 2;
    on.probe_gain = 5;
    given[0][0] = &off;
    given[1][0] = &on;
    f.sets[0].module_settings = given[0];
    f.sets[1].object = f.object;
    f.sets[1].module_settings = given[1];
    f.frame.set_count = 2;
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("over", &step), 1);
    assert_int_equal(step->set, 1);
    assert_int_equal(step->constants[2], 5);
    on.set = 3;
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("over", NULL), 0);
    end(&f);
}

static void the_scene_holds_the_object(void **state) {
    fixture f;
    (void)state;
    begin(&f);
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_true(core_seen.frame.depth.z > 5.6568f && core_seen.frame.depth.z < 5.6569f);
    f.sets[1].lines = f.lines; /* now -22 .. -20 deep and 5 wide */
    f.frame.set_count = 2;
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_true(core_seen.frame.depth.z > 6.7082f && core_seen.frame.depth.z < 6.7083f);
    end(&f);
}

static void history_is_counted(void **state) {
    fixture f;
    (void)state;
    begin(&f);
    for (int i = 0; i < 3; i++) {
        f.frame.camera.view[14] = (float)-i;
        assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
        assert_true(core_seen.frame.history.x == (float)i);
        assert_true(core_seen.frame.previous_view.w.z == (i > 0 ? (float)(1 - i) : 0.0f));
    }
    assert_int_equal(lao_view_resize(f.context, f.view, 32, 32), LAO_OK);
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_true(core_seen.frame.history.x == 0);
    end(&f);
}

static void world_undoes_the_view(void **state) {
    fixture f;
    uint32_t seed = 7;
    (void)state;
    begin(&f);
    for (int turn = 0; turn < 50; turn++) {
        lao_v3 p = lao_v3_make(3, -5, 7), q;
        for (int c = 0; c < 4; c++) {
            for (int r = 0; r < 3; r++) {
                f.frame.camera.view[c * 4 + r] =
                    (float)core_between(&seed, -3, 3) + (c == r ? 6.0f : 0.0f);
            }
        }
        assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
        q = lao_transform(core_seen.frame.world, lao_transform(core_seen.frame.view, p));
        assert_true(lao_v3_dot(lao_v3_sub(p, q), lao_v3_sub(p, q)) < 1e-9f);
    }
    end(&f);
}

static void wrong_objects(void **state) {
    fixture f;
    lao_object none = {0};
    uint32_t alive;
    (void)state;
    begin(&f);
    alive = core_seen.buffers_alive;
#define REFUSED(log_item, word)                                                                    \
    do {                                                                                           \
        uint32_t logs = f.host.logs;                                                               \
        assert_int_not_equal(lao_object_create(f.context, &f.source, &none), LAO_OK);              \
        assert_int_equal(f.host.logs, logs + 1);                                                   \
        assert_int_equal(f.host.item, LAO_LOG_##log_item);                                         \
        assert_non_null(strstr(f.host.text, word));                                                \
        assert_int_equal(none.id, 0);                                                              \
        assert_int_equal(core_seen.buffers_alive, alive);                                          \
        describe(&f);                                                                              \
    } while (0)
    f.both[1].name = "nobody";
    REFUSED(OBJECT_BUFFER, "nobody");
    f.both[1].name = NULL;
    REFUSED(OBJECT_BUFFER, "no name");
    f.both[1].name = "corners";
    REFUSED(OBJECT_BUFFER, "corners");
    f.both[1].data = NULL;
    REFUSED(OBJECT_BUFFER, "scales");
    f.both[1].texel_count = 0;
    REFUSED(OBJECT_BUFFER, "scales");
    f.both[0].texel_count = 0xffffffffu;
    REFUSED(OBJECT_BUFFER, "corners");
    f.source.triangle_count = 0x30000000u;
    REFUSED(OBJECT_BUFFER, "triangle_count");
    f.source.buffers = NULL;
    REFUSED(NULL_ARGUMENT, "buffers");
    assert_int_equal(lao_object_create(f.context, NULL, &none), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_object_update(f.context, f.object, NULL), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(lao_object_update(f.context, none, &f.source), LAO_ERROR_STALE_HANDLE);
    assert_int_equal(lao_object_destroy(f.context, none), LAO_ERROR_STALE_HANDLE);
    assert_int_equal(lao_object_destroy(f.context, f.object), LAO_OK);
    assert_int_equal(lao_render(f.context, &f.frame), LAO_ERROR_STALE_HANDLE);
    assert_int_equal(f.host.item, LAO_LOG_OBJECT_HANDLE);
    assert_int_equal(core_seen.buffers_alive, alive - 2);
    end(&f);
}

static void an_update_keeps_other_buffers(void **state) {
    static const float one[1] = {9};
    fixture f;
    (void)state;
    begin(&f);
    f.both[1].data = one;
    f.both[1].texel_count = 1;
    f.source.buffers = &f.both[1];
    f.source.buffer_count = 1;
    core_seen.buffer_count = 0;
    assert_int_equal(lao_object_update(f.context, f.object, &f.source), LAO_OK);
    assert_int_equal(core_seen.buffer_count, 1);
    assert_int_equal(core_seen.buffers_alive, 4); /* the lines' two, corners, the new one */
    assert_true(core_seen.buffers[0].texels[0] == 9);
    assert_int_equal(core_seen.buffers[0].format, LAO_FORMAT_R32F);
    assert_int_equal(lao_render(f.context, &f.frame), LAO_OK);
    assert_int_equal(steps_of("draw", NULL), 1);
    end(&f);
}

/* Every allocation and every backend call of making and changing an object gives out once. */
static void nothing_is_left_of_a_failure(void **state) {
    int failures = 0;
    (void)state;
    for (uint32_t n = 1; n <= 12; n++) {
        fixture f;
        lao_object more = {0};
        uint32_t alive;
        begin(&f);
        alive = core_seen.buffers_alive;
        f.host.memory.fail_allocation = f.host.memory.allocations + n;
        if (lao_object_create(f.context, &f.source, &more) != LAO_OK) {
            failures++;
            assert_int_equal(f.host.result, LAO_ERROR_OUT_OF_MEMORY);
            assert_int_equal(more.id, 0);
            assert_int_equal(core_seen.buffers_alive, alive);
            assert_int_equal(lao_object_create(f.context, &f.source, &more), LAO_OK);
        }
        if (lao_object_update(f.context, more, &f.source) != LAO_OK) {
            failures++;
            assert_int_equal(core_seen.buffers_alive, alive + 2);
            assert_int_equal(lao_object_update(f.context, more, &f.source), LAO_OK);
        }
        end(&f);
    }
    assert_in_range(failures, 5, 11);
}

static void modules_with_broken_buffers(void **state) {
    static lao_buffer_row many[LAO_MAX_BUFFERS + 4];
    static char names[LAO_MAX_BUFFERS + 4][16];
    char most[32];
    fixture f;
    lao_context *context = NULL;
    (void)state;
    begin(&f);
    for (int i = 0; i < LAO_MAX_BUFFERS + 4; i++) {
        snprintf(names[i], sizeof names[i], "b%d", i);
        many[i].name = names[i];
        many[i].format = LAO_FORMAT_R32F;
    }
    f.probe.module.buffers = many;
    f.probe.module.buffer_count = LAO_MAX_BUFFERS + 4;
    assert_int_equal(lao_create(&f.desc, &context), LAO_ERROR_GRAPH);
    snprintf(most, sizeof most, "%d buffers", (int)LAO_MAX_BUFFERS);
    assert_non_null(strstr(f.host.text, most));
    f.probe.module.buffer_count = 3;
    assert_int_equal(lao_create(&f.desc, &context), LAO_ERROR_GRAPH);
    assert_non_null(strstr(f.host.text, "#corners"));
    many[0].name = "points";
    assert_int_equal(lao_create(&f.desc, &context), LAO_ERROR_GRAPH);
    assert_non_null(strstr(f.host.text, "points"));
    probe_fill(&f.probe);
    f.probe.passes[3].when[0].name = "#nothing";
    assert_int_equal(lao_create(&f.desc, &context), LAO_ERROR_GRAPH);
    assert_non_null(strstr(f.host.text, "#nothing"));
    assert_null(context);
    probe_fill(&f.probe);
    end(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_run_stage_by_stage),
        cmocka_unit_test(a_set_without_the_buffers_has_no_such_steps),
        cmocka_unit_test(items_have_an_image),
        cmocka_unit_test(a_shader_knows_what_a_set_has),
        cmocka_unit_test(a_step_finds_its_buffers),
        cmocka_unit_test(settings_of_the_module),
        cmocka_unit_test(sets_that_occlude_each_other),
        cmocka_unit_test(lines_are_drawn_where_there_are_any),
        cmocka_unit_test(a_frame_row_follows_the_set_that_asks),
        cmocka_unit_test(the_scene_holds_the_object),
        cmocka_unit_test(history_is_counted),
        cmocka_unit_test(world_undoes_the_view),
        cmocka_unit_test(wrong_objects),
        cmocka_unit_test(an_update_keeps_other_buffers),
        cmocka_unit_test(nothing_is_left_of_a_failure),
        cmocka_unit_test(modules_with_broken_buffers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
