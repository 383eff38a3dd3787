/* The frame graph is data that proves itself: lao_graph_check passes for the line module and finds
   each planted fault, and every plan made from tables, shipped or random, reads only what was
   written, shares no memory between what lives at the same time, and names every change of access.
   The plans in tests/core/plans are the shipped ones as text; write them anew with
   LINEAO_WRITE_PLANS=1. */
#include "core_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* --------------------------------------------------------------------------------------------------
 * a small module */

enum { IMAGES = 5, PASSES = 5, SETTINGS = 3, PRESETS = 1 };

/* in -> first -> a -> second -> b -> third -> kept; levels of b. All of it can be damaged. */
typedef struct tables {
    lao_image_row images[IMAGES];
    lao_pass_row passes[PASSES];
    lao_setting_row settings[SETTINGS];
    lao_preset_row presets[PRESETS];
    lao_shader shaders[2];
    lao_module module;
} tables;

static lao_reference at(const char *image, lao_level level, uint32_t index, lao_phase phase,
                        lao_load load) {
    lao_reference r;
    memset(&r, 0, sizeof r);
    r.image = image;
    r.level = level;
    r.level_index = index;
    r.phase = phase;
    r.load = load;
    return r;
}
static lao_reference simply(const char *image) {
    return at(image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD);
}

static lao_image_row image_row(const char *name, lao_format format, lao_size size,
                               const char *levels, uint32_t flags) {
    lao_image_row row;
    memset(&row, 0, sizeof row);
    row.name = name;
    row.format = format;
    row.size = size;
    row.width = 37;
    row.height = 23;
    row.levels = levels;
    row.flags = flags;
    return row;
}

static lao_pass_row pass_row(const char *name, lao_reference write, lao_reference read) {
    lao_pass_row row;
    memset(&row, 0, sizeof row);
    row.name = name;
    row.shader = "s";
    row.writes[0] = write;
    row.reads[0] = read;
    return row;
}

static lao_setting_row setting_row(const char *name, float standard) {
    lao_setting_row row;
    memset(&row, 0, sizeof row);
    row.name = name;
    row.type = LAO_SETTING_INT;
    row.maximum = 8;
    row.standard = standard;
    row.structural = 1;
    row.unit = row.choices = row.help = "";
    return row;
}

static void tables_fill(tables *t) {
    memset(t, 0, sizeof *t);
    t->images[0] = image_row("in", LAO_FORMAT_HOST, LAO_SIZE_VIEW, NULL, LAO_IMAGE_IMPORT);
    t->images[1] = image_row("a", LAO_FORMAT_RGBA8, LAO_SIZE_FULL, NULL, 0);
    t->images[2] = image_row("b", LAO_FORMAT_RGBA16F, LAO_SIZE_FULL, "levels", 0);
    t->images[3] = image_row("kept", LAO_FORMAT_R32F, LAO_SIZE_VIEW, NULL, LAO_IMAGE_HISTORY);
    t->images[4] = image_row("c", LAO_FORMAT_RGBA8, LAO_SIZE_FULL, NULL, 0);
    t->passes[0] = pass_row("first", simply("a"), simply("in"));
    t->passes[1] = pass_row("second", simply("b"), simply("a"));
    t->passes[2] =
        pass_row("up", simply("b"), at("b", LAO_LEVEL_FINER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD));
    t->passes[2].repeat = LAO_REPEAT_LEVELS_UP;
    t->passes[3] = pass_row("third", simply("c"),
                            at("b", LAO_LEVEL_INDEX, 9, LAO_PHASE_THIS, LAO_LOAD_DISCARD));
    t->passes[4] = pass_row("last", simply("kept"), simply("c"));
    t->passes[4].reads[1] = at("kept", LAO_LEVEL_SAME, 0, LAO_PHASE_PREVIOUS, LAO_LOAD_DISCARD);
    t->settings[0] = setting_row("levels", 3);
    t->settings[1] = setting_row("turns", 2);
    t->settings[2] = setting_row("preset", 0);
    t->settings[2].type = LAO_SETTING_ENUM;
    t->settings[2].choices = "this|other";
    t->presets[0].preset = "other";
    t->presets[0].setting = "levels";
    t->shaders[0].name = "s";
    t->shaders[1].name = "unused";
    t->module.name = "small";
    t->module.images = t->images;
    t->module.image_count = IMAGES;
    t->module.passes = t->passes;
    t->module.pass_count = PASSES;
    t->module.settings = t->settings;
    t->module.setting_count = SETTINGS;
    t->module.presets = t->presets;
    t->module.preset_count = PRESETS;
}

/* -----------------------------------------------------------------------------------------------------------
 * faults */

typedef struct fault {
    void (*plant)(tables *t);
    const char *text;
} fault;

static void two_images(tables *t) {
    t->images[4].name = "a";
}
static void two_passes(tables *t) {
    t->passes[3].name = "first";
}
static void two_settings(tables *t) {
    t->settings[1].name = "levels";
}
static void levels_setting(tables *t) {
    t->images[2].levels = "no_such";
}
static void first_repeats_with_none(tables *t) {
    t->passes[0].repeat = LAO_REPEAT_WITH_LAST;
}
static void preset_setting(tables *t) {
    t->presets[0].setting = "no_such";
}
static void words_cleared(tables *t) {
    t->images[1].format = LAO_FORMAT_R32UI;
    t->images[1].clear[3] = 1;
}
static void words_blended(tables *t) {
    t->images[1].format = LAO_FORMAT_R32UI;
    t->passes[0].blend = LAO_BLEND_ADD;
}
static void writes_nothing(tables *t) {
    t->passes[0].writes[0].image = NULL;
}
static void writes_unknown(tables *t) {
    t->passes[0].writes[0].image = "no_such";
}
static void reads_unknown(tables *t) {
    t->passes[1].reads[1] = simply("no_such");
}
static void reads_unknown_buffer(tables *t) {
    t->passes[1].reads[1] = simply("#no_such");
}
static void read_before_write(tables *t) {
    t->passes[0].reads[0].image = "c";
}
static void read_before_write_up(tables *t) {
    t->passes[1].writes[0].image = "c";
}
static void reads_what_it_writes(tables *t) {
    t->passes[3].reads[1] = simply("c");
}
static void reads_what_it_writes_by_index(tables *t) {
    t->passes[4].reads[1] = simply("kept");
    t->passes[4].reads[1].level = LAO_LEVEL_INDEX;
}
static void reads_what_it_writes_in_other(tables *t) {
    t->passes[3].writes[0].phase = LAO_PHASE_OTHER;
    t->passes[3].reads[1] = at("c", LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD);
}
static void image_unused(tables *t) {
    t->passes[3].writes[0].image = "kept";
    t->passes[4].reads[0] = at("b", LAO_LEVEL_INDEX, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD);
}
static void shader_missing(tables *t) {
    t->passes[2].shader = "no_such";
}
static void setting_unknown(tables *t) {
    t->passes[2].when[0].name = "no_such", t->passes[2].when[0].compare = '=';
}
static void setting_unknown_last(tables *t) {
    t->passes[2].when[2].name = "no_such", t->passes[2].when[2].compare = '=';
}
static void import_unknown(tables *t) {
    t->passes[0].when[0].name = "@no_such", t->passes[0].when[0].compare = '>';
}
static void comparison_unknown(tables *t) {
    t->passes[2].when[0].name = "levels", t->passes[2].when[0].compare = '~';
}
static void comparison_missing(tables *t) {
    t->passes[2].when[0].name = "levels";
}
static void image_setting_unknown(tables *t) {
    t->images[1].when.name = "no_such", t->images[1].when.compare = '=';
}
static void repeat_unknown(tables *t) {
    t->passes[3].repeat = LAO_REPEAT_COUNT, t->passes[3].repeat_setting = "no_such";
}
static void repeat_missing(tables *t) {
    t->passes[3].repeat = LAO_REPEAT_COUNT;
}
static void pass_useless(tables *t) {
    t->passes[4].reads[0] = at("b", LAO_LEVEL_INDEX, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD);
}

static void items_unknown(tables *t) {
    t->images[1].size = LAO_SIZE_ITEMS;
    t->images[1].width = LAO_FURTHER_ITEMS + 1;
}
static void previous_not_kept(tables *t) {
    t->passes[1].reads[1] = at("a", LAO_LEVEL_SAME, 0, LAO_PHASE_PREVIOUS, LAO_LOAD_DISCARD);
}
static void previous_not_written(tables *t) {
    t->images[3].flags = 0;
    t->images[4].flags = LAO_IMAGE_HISTORY;
    t->passes[3].writes[0].image = "kept";
    t->passes[4].writes[0].image = "a";
    t->passes[4].reads[0].image = "kept";
    t->passes[4].reads[1].image = "c";
}
static void preset_unknown(tables *t) {
    t->presets[0].preset = "no_such";
}
static void presets_without_setting(tables *t) {
    t->settings[2].name = "look";
}
static void too_many_settings(tables *t) {
    static lao_setting_row rows[65];
    static char names[65][16];
    for (int i = 0; i < 65; i++) {
        snprintf(names[i], sizeof names[i], "s%d", i);
        rows[i] = setting_row(i == 0 ? "levels" : i == 1 ? "preset" : names[i], 0);
    }
    t->module.settings = rows;
    t->module.setting_count = 65;
}

static void too_many_textures(tables *t) {
    t->shaders[0].texture_count = LAO_MAX_READS + 1;
}

static const fault faults[] = {
    {first_repeats_with_none, "pass 'first' has no row before it to repeat with"},
    {items_unknown, "image 'a' is of an unknown kind of items"},
    {previous_not_kept, "pass 'second' reads the last frame's 'a', which is not kept"},
    {previous_not_written, "pass 'last' reads 'c', which nothing has written"},
    {preset_unknown, "module 'small' has no preset 'no_such'"},
    {presets_without_setting, "module 'small' has no preset 'other'"},
    {too_many_settings, "module 'small' has more than 64 settings"},
    {two_images, "two images are named 'a'"},
    {two_passes, "two passes are named 'first'"},
    {two_settings, "two settings of module 'small' are named 'levels'"},
    {levels_setting, "image 'b' counts its levels by the unknown setting 'no_such'"},
    {preset_setting, "preset 'other' names the unknown setting 'no_such'"},
    {writes_nothing, "pass 'first' writes nothing"},
    {words_cleared, "image 'a' holds words, which are cleared to 0"},
    {words_blended, "pass 'first' blends the words of 'a'"},
    {writes_unknown, "pass 'first' writes the unknown image 'no_such'"},
    {reads_unknown, "pass 'second' reads the unknown image 'no_such'"},
    {reads_unknown_buffer, "pass 'second' reads the unknown buffer '#no_such'"},
    {read_before_write, "pass 'first' reads 'c', which nothing has written"},
    {read_before_write_up, "pass 'up' reads 'b', which nothing has written"},
    {reads_what_it_writes, "pass 'third' reads what it writes: 'c'"},
    {reads_what_it_writes_by_index, "pass 'last' reads what it writes: 'kept'"},
    {reads_what_it_writes_in_other, "pass 'third' reads what it writes: 'c'"},
    {image_unused, "no pass uses image 'c'"},
    {too_many_textures, "shader 's' of pass 'first' has more textures than a pass can read"},
    {shader_missing, "pass 'up' has no shader 'no_such'"},
    {setting_unknown, "'up' asks for the unknown setting 'no_such'"},
    {setting_unknown_last, "'up' asks for the unknown setting 'no_such'"},
    {import_unknown, "'first' asks for the unknown image 'no_such'"},
    {comparison_unknown, "'up' has a condition on 'levels' without a comparison"},
    {comparison_missing, "'up' has a condition on 'levels' without a comparison"},
    {image_setting_unknown, "'a' asks for the unknown setting 'no_such'"},
    {repeat_unknown, "pass 'third' repeats by an unknown setting"},
    {repeat_missing, "pass 'third' repeats by an unknown setting"},
    {pass_useless, "nothing uses what pass 'third' writes"},
};

static lao_graph graph_of(const lao_module *module) {
    lao_graph graph;
    assert_int_equal(lao_graph_make(&module, 1, NULL, &graph), LAO_OK);
    return graph;
}

static void planted_faults_are_found(void **state) {
    (void)state;
    for (size_t i = 0; i <= sizeof faults / sizeof faults[0]; i++) {
        tables t;
        lao_graph graph;
        char text[256] = "";
        int result;
        tables_fill(&t);
        if (i > 0) {
            faults[i - 1].plant(&t);
        }
        graph = graph_of(&t.module);
        result = lao_graph_check(&graph, t.shaders, 2, text, sizeof text);
        if (i == 0 && result != 0) {
            fail_msg("the sound module: %s", text);
        }
        if (i > 0 && (result == 0 || strcmp(text, faults[i - 1].text) != 0)) {
            fail_msg("wanted: %s\n  got: %s", faults[i - 1].text, result ? text : "(nothing)");
        }
        assert_int_equal(lao_graph_check(&graph, t.shaders, 2, NULL, 0),
                         result); /* the text is optional */
        lao_graph_free(NULL, &graph);
    }
}

static void the_line_module_is_sound(void **state) {
    const lao_module *module = lao_lines_module();
    lao_graph graph = graph_of(module);
    char text[256] = "";
    int count = 0;
    (void)state;
    if (lao_graph_check(&graph, NULL, 0, text, sizeof text) != 0) {
        fail_msg("%s", text);
    }
    assert_ptr_equal(lao_passes(&count), module->passes);
    assert_int_equal(count, module->pass_count);
    assert_ptr_equal(lao_passes(NULL), module->passes);
    lao_graph_free(NULL, &graph);
    { /* shaders of the module itself count, those of another module do not */
        tables t, o;
        const lao_module *modules[2];
        tables_fill(&t);
        t.module.shaders = t.shaders;
        t.module.shader_count = 1;
        graph = graph_of(&t.module);
        assert_int_equal(lao_graph_check(&graph, t.shaders + 1, 1, text, sizeof text), 0);
        assert_int_equal(lao_graph_check(&graph, t.shaders + 1, 0, text, sizeof text), 0);
        lao_graph_free(NULL, &graph);
        tables_fill(&o);
        o.module.name = "other";
        modules[0] = module;
        modules[1] = &t.module;
        assert_int_equal(lao_graph_make(modules, 2, NULL, &graph), LAO_OK);
        assert_int_equal(graph.image_count, module->image_count + IMAGES);
        assert_int_equal(graph.pass_count, module->pass_count + PASSES);
        assert_int_equal(lao_graph_check(&graph, NULL, 0, text, sizeof text), 0);
        lao_graph_free(NULL, &graph);
        modules[0] = &o.module; /* the same names twice */
        assert_int_equal(lao_graph_make(modules, 2, NULL, &graph), LAO_OK);
        assert_int_equal(lao_graph_check(&graph, NULL, 0, text, sizeof text), -1);
        lao_graph_free(NULL, &graph);
    }
}

/* ------------------------------------------------------------------------------------------------------------
 * plans */

enum { TEXT = 65536, SETS = 3 };

static void append(void *user, const char *text) {
    char *all = (char *)user;
    size_t used = strlen(all);
    assert_true(used + strlen(text) + 1 < TEXT);
    strcpy(all + used, text);
}

typedef struct planning {
    lao_graph graph;
    lao_plan_desc desc;
    lao_plan plan;
    lao_import imports[4];
    float values[SETS][64];
    const float *rows[SETS];
    char text[TEXT];
} planning;

static void planning_begin(planning *p, const lao_module *module, uint32_t sets) {
    memset(p, 0, sizeof *p);
    p->graph = graph_of(module);
    p->desc.width = 50;
    p->desc.height = 37;
    p->desc.set_count = sets;
    p->desc.values = p->rows;
    p->desc.imports = p->imports;
    p->desc.has_target = 1;
    for (uint32_t s = 0; s < SETS; s++) {
        p->rows[s] = p->values[s];
        assert_int_equal(lao_settings_resolve(module, NULL, p->values[s]), -1);
    }
}

static void planning_settings(planning *p, uint32_t set, const lao_settings *settings) {
    assert_int_equal(lao_settings_resolve(lao_lines_module(), settings, p->values[set]), -1);
}

static void planning_import(planning *p, const char *image, uint32_t flags) {
    lao_import *import = &p->imports[p->desc.import_count++];
    import->image = image;
    import->source.present = 1;
    import->source.flags = flags;
}

static void planning_make(planning *p) {
    assert_int_equal(lao_plan_make(&p->graph, &p->desc, NULL, &p->plan), LAO_OK);
    p->text[0] = 0;
    lao_plan_print(&p->graph, &p->plan, append, p->text);
}

static void planning_end(planning *p) {
    lao_plan_free(NULL, &p->plan);
    lao_graph_free(NULL, &p->graph);
}

#define BROKEN(...)                                                                                \
    do {                                                                                           \
        fprintf(stderr, "%s", p->text);                                                            \
        fail_msg(__VA_ARGS__);                                                                     \
    } while (0)

static const char *name_of(const planning *p, uint32_t instance) {
    return p->graph.images[p->plan.instances[instance].image]->name;
}

/* Which steps use an instance, from the steps alone. */
static void life(const lao_plan *plan, uint32_t instance, uint32_t *first, uint32_t *last) {
    *first = LAO_NO_INDEX;
    *last = 0;
    for (uint32_t s = 0; s < plan->step_count; s++) {
        const lao_plan_step *step = &plan->steps[s];
        int uses = step->depth.instance == instance;
        for (uint32_t i = 0; i < step->read_count; i++) {
            uses |= step->reads[i] == instance;
        }
        for (uint32_t i = 0; i < step->color_count; i++) {
            uses |= step->colors[i].instance == instance;
        }
        if (uses) {
            *first = *first == LAO_NO_INDEX ? s : *first;
            *last = s;
        }
    }
}

static void check_memory(planning *p) {
    lao_plan *plan = &p->plan;
    for (uint32_t i = 0; i < plan->instance_count; i++) {
        const lao_plan_instance *a = &plan->instances[i];
        const lao_image_row *row = p->graph.images[a->image];
        uint32_t first, last, w, h;
        life(plan, i, &first, &last);
        if (first != a->first_step || last != a->last_step) {
            BROKEN("%s lives %u..%u, not %u..%u", name_of(p, i), first, last, a->first_step,
                   a->last_step);
        }
        w = row->size == LAO_SIZE_FIXED ? row->width : p->desc.width;
        h = row->size == LAO_SIZE_FIXED ? row->height : p->desc.height;
        if (row->size == LAO_SIZE_FULL) {
            int s = lao_setting_find(p->graph.modules[0], "supersampling");
            w *= s < 0 ? 1 : (uint32_t)p->values[0][s];
            h *= s < 0 ? 1 : (uint32_t)p->values[0][s];
        }
        if (a->width != (uint32_t)ceil((double)w / (double)(1u << a->level)) ||
            a->height != (uint32_t)ceil((double)h / (double)(1u << a->level))) {
            BROKEN("%s.%u is %ux%u", name_of(p, i), a->level, a->width, a->height);
        }
        if ((a->import == LAO_NO_INDEX) != (a->slot[0] != LAO_NO_INDEX)) {
            BROKEN("%s has memory and is imported, or neither", name_of(p, i));
        }
        for (int k = 0; k < 2 && a->import == LAO_NO_INDEX; k++) {
            const lao_plan_slot *slot = &plan->slots[a->slot[k]];
            if (slot->width != a->width || slot->height != a->height || slot->format != a->format) {
                BROKEN("the memory of %s does not fit", name_of(p, i));
            }
        }
        for (uint32_t k = 0; k < i && a->import == LAO_NO_INDEX; k++) {
            const lao_plan_instance *b = &plan->instances[k];
            uint32_t b_first, b_last;
            int history = ((p->graph.images[a->image]->flags | p->graph.images[b->image]->flags) &
                           LAO_IMAGE_HISTORY) != 0;
            life(plan, k, &b_first, &b_last);
            for (int parity = 0; parity < 2; parity++) {
                if (b->slot[parity] == a->slot[parity] && b->import == LAO_NO_INDEX &&
                    (history || !(b_last < first || last < b_first) ||
                     (p->desc.flags & LAO_VIEW_KEEP_IMAGES))) {
                    BROKEN("%s.%u and %s.%u share memory while both live", name_of(p, i), a->level,
                           name_of(p, k), b->level);
                }
            }
        }
    }
}

static void check_access(planning *p) {
    lao_plan *plan = &p->plan;
    lao_access state[512];
    uint32_t b = 0;
    memset(state, 0, sizeof state);
    assert_true(plan->slot_count + plan->instance_count < 512);
    for (uint32_t s = 0; s <= plan->step_count; s++) {
        const lao_plan_step *step = s < plan->step_count ? &plan->steps[s] : NULL;
        uint32_t end = step ? step->barrier_first + step->barrier_count : plan->barrier_count;
        if (b != (step ? step->barrier_first : plan->end_barrier_first)) {
            BROKEN("barriers of step %u begin at the wrong place", s);
        }
        for (; b < end; b++) {
            const lao_plan_barrier *barrier = &plan->barriers[b];
            uint32_t slot = plan->instances[barrier->instance].slot[0];
            lao_access *now =
                &state[slot != LAO_NO_INDEX ? slot : plan->slot_count + barrier->instance];
            if (barrier->before != *now) {
                BROKEN("step %u: a barrier of %s comes from the wrong access", s,
                       name_of(p, barrier->instance));
            }
            if (!step && (barrier->after != LAO_ACCESS_NONE ||
                          plan->instances[barrier->instance].import == LAO_NO_INDEX)) {
                BROKEN("only imports are given back");
            }
            *now = barrier->after;
        }
        for (uint32_t i = 0; step && i < step->read_count; i++) {
            if (step->reads[i] < plan->instance_count) {
                uint32_t slot = plan->instances[step->reads[i]].slot[0];
                if (state[slot != LAO_NO_INDEX ? slot : plan->slot_count + step->reads[i]] !=
                    LAO_ACCESS_SAMPLE) {
                    BROKEN("step %u reads %s without a barrier", s, name_of(p, step->reads[i]));
                }
                assert_true(slot == LAO_NO_INDEX || plan->slots[slot].sampled);
            }
        }
        for (uint32_t i = 0; step && i <= step->color_count; i++) {
            uint32_t instance =
                         i < step->color_count ? step->colors[i].instance : step->depth.instance,
                     slot, found = 0;
            if (instance == LAO_NO_INDEX) {
                continue;
            }
            slot = plan->instances[instance].slot[0];
            if (state[slot != LAO_NO_INDEX ? slot : plan->slot_count + instance] !=
                (i < step->color_count ? LAO_ACCESS_COLOR : LAO_ACCESS_DEPTH)) {
                BROKEN("step %u writes %s without a barrier", s, name_of(p, instance));
            }
            /* also between two writers in a row */
            for (uint32_t k = step->barrier_first; k < step->barrier_first + step->barrier_count;
                 k++) {
                found += plan->barriers[k].instance == instance &&
                         plan->barriers[k].after != LAO_ACCESS_SAMPLE;
            }
            if (found != 1) {
                BROKEN("step %u has %u barriers for its write of %s", s, found,
                       name_of(p, instance));
            }
            assert_true(slot == LAO_NO_INDEX || plan->slots[slot].attached);
            if (plan->instances[instance].width != step->width ||
                plan->instances[instance].height != step->height) {
                BROKEN("step %u writes images of two sizes", s);
            }
            for (uint32_t r = 0; r < step->read_count; r++) {
                if (step->reads[r] == instance) {
                    BROKEN("step %u reads %s, which it writes", s, name_of(p, instance));
                }
            }
        }
    }
    for (uint32_t i = 0; i < plan->instance_count; i++) {
        if (plan->instances[i].import != LAO_NO_INDEX &&
            state[plan->slot_count + i] != LAO_ACCESS_NONE) {
            BROKEN("%s is not given back", name_of(p, i));
        }
    }
}

/* Three frames on memory that remembers who wrote it. */
static void check_content(planning *p) {
    lao_plan *plan = &p->plan;
    struct {
        uint32_t image, level, phase, frame, valid;
    } memory[512];
    memset(memory, 0, sizeof memory);
    assert_true(plan->slot_count < 512);
    for (uint32_t frame = 0; frame < 3; frame++) {
        uint32_t parity = frame & 1;
        for (uint32_t s = 0; s < plan->step_count; s++) {
            const lao_plan_step *step = &plan->steps[s];
            for (uint32_t i = 0; i < step->read_count; i++) {
                const lao_plan_instance *a;
                uint32_t slot, previous;
                if (step->reads[i] >= plan->instance_count ||
                    plan->instances[step->reads[i]].import != LAO_NO_INDEX) {
                    continue;
                }
                a = &plan->instances[step->reads[i]];
                slot = a->slot[parity];
                previous = (p->graph.images[a->image]->flags & LAO_IMAGE_HISTORY) && a->phase == 1;
                if (previous && frame == 0) {
                    continue; /* there is none yet */
                }
                if (!memory[slot].valid || memory[slot].image != a->image ||
                    memory[slot].level != a->level || memory[slot].frame != frame - previous ||
                    memory[slot].phase != (previous ? 0 : a->phase)) {
                    BROKEN("frame %u step %u reads %s.%u%s, which is not there", frame, s,
                           name_of(p, step->reads[i]), a->level, a->phase ? "'" : "");
                }
            }
            for (uint32_t i = 0; i <= step->color_count; i++) {
                const lao_plan_write *write =
                    i < step->color_count ? &step->colors[i] : &step->depth;
                const lao_plan_instance *a;
                uint32_t slot;
                if (write->instance == LAO_NO_INDEX ||
                    plan->instances[write->instance].import != LAO_NO_INDEX) {
                    continue;
                }
                a = &plan->instances[write->instance];
                slot = a->slot[parity];
                if (write->clear == 0 &&
                    (!memory[slot].valid || memory[slot].image != a->image ||
                     memory[slot].level != a->level || memory[slot].frame != frame ||
                     memory[slot].phase != a->phase)) {
                    BROKEN("frame %u step %u keeps what %s.%u never had", frame, s,
                           name_of(p, write->instance), a->level);
                }
                memory[slot].valid = 1;
                memory[slot].image = a->image;
                memory[slot].level = a->level;
                memory[slot].phase = a->phase;
                memory[slot].frame = frame;
            }
        }
    }
}

static void check_plan(planning *p) {
    check_memory(p);
    check_access(p);
    check_content(p);
}

static void compare_with_file(const char *name, const char *text) {
    static char wanted[TEXT];
    char path[1024];
    FILE *file;
    size_t n = 0;
    snprintf(path, sizeof path, "%s/tests/core/plans/%s.txt", LINEAO_SOURCE_DIR, name);
    if (getenv("LINEAO_WRITE_PLANS")) {
        file = fopen(path, "w");
        assert_non_null(file);
        fputs(text, file);
        fclose(file);
    }
    file = fopen(path, "r");
    if (file) {
        n = fread(wanted, 1, sizeof wanted - 1, file);
        fclose(file);
    }
    wanted[n] = 0;
    if (strcmp(wanted, text) != 0) {
        fail_msg("the plan differs from %s (LINEAO_WRITE_PLANS=1 writes it anew):\n%s", path, text);
    }
}

static void shipped_plans_are_as_written(void **state) {
    static planning p;
    static const char *const presets[] = {"default", "classic", "paper"};
    lao_settings settings;
    (void)state;
    for (uint32_t preset = 0; preset < 3; preset++) {
        planning_begin(&p, lao_lines_module(), 1);
        memset(&settings, 0, sizeof settings);
        settings.preset = (float)preset;
        planning_settings(&p, 0, &settings);
        planning_make(&p);
        check_plan(&p);
        compare_with_file(presets[preset], p.text);
        planning_end(&p);
    }
    planning_begin(&p, lao_lines_module(), 2); /* another look for the second set */
    memset(&settings, 0, sizeof settings);
    settings.preset = 1;
    settings.levels = 2;
    planning_settings(&p, 1, &settings);
    planning_make(&p);
    check_plan(&p);
    compare_with_file("two_sets", p.text);
    planning_end(&p);
    for (uint32_t writable = 0; writable < 2; writable++) {
        planning_begin(&p, lao_lines_module(), 1);
        planning_import(&p, "host_depth", writable ? LAO_HOST_WRITABLE : 0u);
        p.desc.reverse_depth = writable;
        planning_make(&p);
        check_plan(&p);
        compare_with_file(writable ? "host_depth_writable" : "host_depth", p.text);
        assert_int_equal(p.plan.reverse_depth, writable);
        planning_end(&p);
    }
    planning_begin(&p, lao_lines_module(),
                   1); /* lao_occlude: the host's G-buffer instead of lines */
    planning_import(&p, "color", 0);
    planning_import(&p, "tangent", 0);
    planning_import(&p, "depth", 0);
    planning_make(&p);
    check_plan(&p);
    compare_with_file("occlude", p.text);
    assert_null(strstr(p.text, " lines set"));
    assert_non_null(strstr(p.text, " cover set")); /* its mask stands in for our depth */
    planning_end(&p);
    planning_begin(&p, lao_lines_module(), 1);
    memset(&settings, 0, sizeof settings);
    settings.smoothing = 2;
    settings.light = LAO_LIGHT_AUTHOR;
    settings.supersampling = 1;
    planning_settings(&p, 0, &settings);
    p.desc.has_target = 0;
    planning_make(&p);
    check_plan(&p);
    compare_with_file("smoothing_no_target", p.text);
    planning_end(&p);
    planning_begin(&p, lao_lines_module(), 1);
    settings.set = LAO_SET(occlusion);
    settings.occlusion = 0;
    planning_settings(&p, 0, &settings);
    planning_make(&p);
    check_plan(&p);
    compare_with_file("no_occlusion", p.text);
    planning_end(&p);
}

static void every_structure_of_the_line_module_is_sound(void **state) {
    static planning p;
    uint32_t seed = 11;
    (void)state;
    for (int i = 0; i < 600; i++) {
        const lao_module *module = lao_lines_module();
        planning_begin(&p, module, 1 + core_random(&seed) % SETS);
        for (uint32_t s = 0; s < p.desc.set_count; s++) {
            for (uint32_t k = 0; k < module->setting_count; k++) {
                const lao_setting_row *row = &module->settings[k];
                if (row->structural && core_random(&seed) % 2) {
                    p.values[s][k] =
                        row->minimum +
                        (float)(core_random(&seed) % (uint32_t)(row->maximum - row->minimum + 1));
                }
            }
        }
        p.desc.width = 1 + core_random(&seed) % 300;
        p.desc.height = 1 + core_random(&seed) % 300;
        p.desc.flags = core_random(&seed) % 4 == 0 ? LAO_VIEW_KEEP_IMAGES : 0u;
        p.desc.has_target = core_random(&seed) % 2;
        if (core_random(&seed) % 2) {
            planning_import(&p, "host_depth", core_random(&seed) % 2 ? LAO_HOST_WRITABLE : 0u);
        } else if (core_random(&seed) % 2) {
            planning_import(&p, "tangent", 0);
            planning_import(&p, "color", 0);
            planning_import(&p, "depth", 0);
        }
        planning_make(&p);
        check_plan(&p);
        /* the same again into the same memory */
        {
            lao_plan_step *steps = p.plan.steps;
            uint32_t serial = p.plan.serial;
            planning_make(&p);
            assert_ptr_equal(p.plan.steps, steps);
            assert_int_equal(p.plan.serial, serial + 1);
        }
        planning_end(&p);
    }
}

/* Pull-push, sweeps and history: what the line module does not use yet. */
static void repeats_levels_and_phases(void **state) {
    static planning p;
    tables t;
    lao_image_row images[6];
    lao_pass_row passes[6];
    (void)state;
    tables_fill(&t);
    images[0] = image_row("pyramid", LAO_FORMAT_RGBA16F, LAO_SIZE_FIXED, "*", 0);
    images[1] = image_row("fill", LAO_FORMAT_RGBA16F, LAO_SIZE_FIXED, "*", 0);
    images[2] = image_row("sweep", LAO_FORMAT_RGBA16F, LAO_SIZE_FIXED, NULL, 0);
    images[3] = image_row("kept", LAO_FORMAT_RGBA16F, LAO_SIZE_FIXED, NULL, LAO_IMAGE_HISTORY);
    passes[0] = pass_row("base", simply("pyramid"),
                         at("kept", LAO_LEVEL_SAME, 0, LAO_PHASE_PREVIOUS, LAO_LOAD_DISCARD));
    passes[1] = pass_row("pull", simply("pyramid"),
                         at("pyramid", LAO_LEVEL_FINER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD));
    passes[1].repeat = LAO_REPEAT_LEVELS_UP;
    passes[2] = pass_row("top", at("fill", LAO_LEVEL_INDEX, 99, LAO_PHASE_THIS, LAO_LOAD_DISCARD),
                         at("pyramid", LAO_LEVEL_INDEX, 99, LAO_PHASE_THIS, LAO_LOAD_DISCARD));
    passes[3] = pass_row("push", simply("fill"),
                         at("fill", LAO_LEVEL_COARSER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD));
    passes[3].repeat = LAO_REPEAT_LEVELS_DOWN;
    passes[3].reads[1] = simply("pyramid");
    passes[4] = pass_row("start", simply("sweep"), simply("fill"));
    passes[5] = pass_row("turn", at("sweep", LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD),
                         simply("sweep"));
    passes[5].repeat = LAO_REPEAT_COUNT;
    passes[5].repeat_setting = "turns";
    {
        lao_pass_row more[7];
        memcpy(more, passes, sizeof passes);
        more[6] = pass_row("keep", simply("kept"), simply("sweep"));
        t.module.images = images;
        t.module.image_count = 4;
        t.module.passes = more;
        t.module.pass_count = 7;
        for (uint32_t turns = 0; turns < 5; turns++) {
            char text[256] = "";
            uint32_t count[7] = {0, 0, 0, 0, 0, 0, 0};
            planning_begin(&p, &t.module, 1);
            if (lao_graph_check(&p.graph, NULL, 0, text, sizeof text) != 0) {
                fail_msg("%s", text);
            }
            p.values[0][1] = (float)turns;
            planning_make(&p);
            check_plan(&p);
            if (turns == 3) {
                compare_with_file("pull_push", p.text);
            }
            for (uint32_t s = 0; s < p.plan.step_count; s++) {
                const lao_plan_step *step = &p.plan.steps[s];
                count[step->pass]++;
                if (step->pass == 1) {
                    assert_int_equal(p.plan.instances[step->reads[0]].level + 1, step->level);
                    assert_int_equal(step->uniforms[4], p.plan.instances[step->reads[0]].width);
                    assert_int_equal(step->uniforms[0], step->width);
                    assert_int_equal(step->uniforms[2], step->level);
                }
                if (step->pass == 3) {
                    assert_int_equal(p.plan.instances[step->reads[0]].level, step->level + 1);
                    assert_int_equal(p.plan.instances[step->reads[1]].level, step->level);
                }
                if (step->pass == 5) {
                    assert_int_equal(step->uniforms[3], step->iteration);
                    assert_true(step->reads[0] != step->colors[0].instance);
                }
            }
            /* 37x23 19x12 10x6 5x3 3x2 2x1 1x1 */
            assert_int_equal(count[1], 6);
            assert_int_equal(count[3], 6);
            assert_int_equal(count[5], turns);
            planning_end(&p);
        }
    }
}

/* LAO_LOAD_KEEP clears each piece of memory the first time that the frame writes it, whatever else
 * of the image is there. */
static void keep_clears_each_level_and_partner_once(void **state) {
    static planning p;
    tables t;
    lao_image_row images[3];
    lao_pass_row passes[5];
    (void)state;
    tables_fill(&t);
    images[0] = image_row("sums", LAO_FORMAT_RGBA16F, LAO_SIZE_FIXED, "levels", 0);
    images[1] = image_row("sweep", LAO_FORMAT_RGBA16F, LAO_SIZE_FIXED, NULL, 0);
    images[2] = image_row("kept", LAO_FORMAT_RGBA16F, LAO_SIZE_FIXED, NULL, LAO_IMAGE_HISTORY);
    passes[0] = pass_row("base", simply("sums"),
                         at("kept", LAO_LEVEL_SAME, 0, LAO_PHASE_PREVIOUS, LAO_LOAD_DISCARD));
    passes[0].writes[0].load = LAO_LOAD_KEEP;
    passes[1] = pass_row("up", simply("sums"),
                         at("sums", LAO_LEVEL_FINER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD));
    passes[1].repeat = LAO_REPEAT_LEVELS_UP;
    passes[1].writes[0].load = LAO_LOAD_KEEP;
    passes[2] = pass_row("start", simply("sweep"),
                         at("sums", LAO_LEVEL_INDEX, 1, LAO_PHASE_THIS, LAO_LOAD_DISCARD));
    passes[3] = pass_row("turn", at("sweep", LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_KEEP),
                         simply("sweep"));
    passes[3].repeat = LAO_REPEAT_COUNT;
    passes[3].repeat_setting = "turns";
    passes[4] = pass_row("keep", simply("kept"), simply("sweep"));
    t.module.images = images;
    t.module.image_count = 3;
    t.module.passes = passes;
    t.module.pass_count = 5;
    planning_begin(&p, &t.module, 1);
    p.values[0][1] = 3;
    planning_make(&p);
    check_plan(&p);
    planning_end(&p);
}

/* A push down a pyramid with two sweeps on every level: each sweep reads what the one before wrote,
   and the next level starts from the last. */
static void rows_repeat_together(void **state) {
    static const char *const order[7] = {"top", "push", "sweep", "sweep", "push", "sweep", "sweep"};
    static const uint32_t levels[7] = {0, 1, 1, 1, 0, 0, 0};
    static planning p;
    tables t;
    lao_image_row images[2];
    lao_pass_row passes[4];
    char text[256];
    (void)state;
    tables_fill(&t);
    images[0] = image_row("field", LAO_FORMAT_RGBA16F, LAO_SIZE_FIXED, "levels", 0);
    images[1] = image_row("kept", LAO_FORMAT_RGBA16F, LAO_SIZE_FIXED, NULL, LAO_IMAGE_HISTORY);
    passes[0] = pass_row("top", at("field", LAO_LEVEL_INDEX, 99, LAO_PHASE_THIS, LAO_LOAD_DISCARD),
                         at("kept", LAO_LEVEL_SAME, 0, LAO_PHASE_PREVIOUS, LAO_LOAD_DISCARD));
    passes[1] = pass_row("push", simply("field"),
                         at("field", LAO_LEVEL_COARSER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD));
    passes[1].repeat = LAO_REPEAT_LEVELS_DOWN;
    passes[2] = pass_row("sweep", at("field", LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD),
                         simply("field"));
    passes[2].repeat = LAO_REPEAT_WITH_LAST;
    passes[2].repeat_setting = "turns";
    passes[3] = pass_row("keep", simply("kept"), simply("field"));
    t.module.images = images;
    t.module.image_count = 2;
    t.module.passes = passes;
    t.module.pass_count = 4;
    for (uint32_t turns = 0; turns < 4; turns++) {
        uint32_t last = LAO_NO_INDEX, i;
        planning_begin(&p, &t.module, 1);
        assert_int_equal(lao_graph_check(&p.graph, NULL, 0, text, sizeof text), 0);
        p.values[0][1] = (float)turns;
        planning_make(&p);
        check_plan(&p);
        assert_int_equal(p.plan.step_count, 4 + 2 * turns);
        for (i = 0; i < p.plan.step_count; i++) {
            const lao_plan_step *step = &p.plan.steps[i];
            if (turns == 2 && i < 7) {
                assert_string_equal(step->row->name, order[i]);
                assert_int_equal(step->level, levels[i]);
            }
            if (i > 0) { /* a chain */
                assert_int_equal(step->reads[0], last);
            }
            last = step->colors[0].instance;
        }
        planning_end(&p);
    }
    passes[2].when[0].name = "turns"; /* its own condition drops it alone */
    passes[2].when[0].compare = '>';
    passes[2].when[0].value = 2;
    planning_begin(&p, &t.module, 1);
    planning_make(&p);
    assert_int_equal(p.plan.step_count, 4);
    planning_end(&p);
}

/* ----------------------------------------------------------------------------------------------------
 * random graphs */

enum { RANDOM_IMAGES = 8, RANDOM_PASSES = 20 };

typedef struct random_graph {
    char names[RANDOM_IMAGES + RANDOM_PASSES][16];
    lao_image_row images[RANDOM_IMAGES + 1];
    lao_pass_row passes[RANDOM_PASSES + 1];
    uint32_t image_count, pass_count;
    int built[RANDOM_IMAGES]; /* 1: level 0, 2: all levels */
} random_graph;

static void random_reads(random_graph *g, lao_pass_row *row, uint32_t *seed, uint32_t from) {
    uint32_t count = core_random(seed) % 4, r = from;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t x = core_random(seed) % g->image_count;
        int written = 0;
        for (uint32_t w = 0; w < LAO_MAX_WRITES && row->writes[w].image; w++) {
            written |= row->writes[w].image == g->images[x].name;
        }
        if ((g->images[x].flags & LAO_IMAGE_HISTORY) && core_random(seed) % 2) {
            row->reads[r++] =
                at(g->images[x].name, LAO_LEVEL_INDEX, 0, LAO_PHASE_PREVIOUS, LAO_LOAD_DISCARD);
        } else if (g->built[x] && !written) {
            row->reads[r++] =
                at(g->images[x].name, LAO_LEVEL_INDEX, g->built[x] == 2 ? core_random(seed) % 9 : 0,
                   LAO_PHASE_THIS, LAO_LOAD_DISCARD);
        }
    }
}

static lao_pass_row *random_pass(random_graph *g, uint32_t *seed, uint32_t x) {
    lao_pass_row *row = &g->passes[g->pass_count];
    memset(row, 0, sizeof *row);
    snprintf(g->names[RANDOM_IMAGES + g->pass_count], 8, "p%u", g->pass_count);
    row->name = g->names[RANDOM_IMAGES + g->pass_count++];
    row->shader = "s";
    row->scope = core_random(seed) % 2 ? LAO_SCOPE_PER_SET : LAO_SCOPE_FRAME;
    row->depth = core_random(seed) % 2 ? LAO_DEPTH_NEARER : LAO_DEPTH_NONE;
    row->writes[0] =
        at(g->images[x].name, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, (lao_load)(core_random(seed) % 3));
    return row;
}

static void random_fill(random_graph *g, uint32_t *seed) {
    static const lao_format formats[] = {LAO_FORMAT_RGBA8, LAO_FORMAT_RGBA8, LAO_FORMAT_RGBA16F,
                                         LAO_FORMAT_D32F};
    static const char *const levels[] = {NULL, NULL, NULL, "*", "levels"};
    lao_pass_row *row;
    memset(g, 0, sizeof *g);
    g->image_count = 3 + core_random(seed) % (RANDOM_IMAGES - 3);
    for (uint32_t i = 0; i < g->image_count; i++) {
        snprintf(g->names[i], sizeof g->names[i], "i%u", i);
        g->images[i] =
            image_row(g->names[i], formats[core_random(seed) % 4],
                      (lao_size)(core_random(seed) % 3), levels[core_random(seed) % 5], 0);
        if (!g->images[i].levels && core_random(seed) % 4 == 0) {
            g->images[i].flags = LAO_IMAGE_HISTORY;
        }
    }
    while (g->pass_count < RANDOM_PASSES - 2) {
        uint32_t x = core_random(seed) % g->image_count, y = core_random(seed) % g->image_count;
        if (g->built[x] == 1 && !g->images[x].levels && !g->images[x].flags &&
            core_random(seed) % 2) {
            row = random_pass(g, seed, x); /* ping-pong */
            row->writes[0].phase = LAO_PHASE_OTHER;
            row->repeat = core_random(seed) % 2 ? LAO_REPEAT_COUNT : LAO_REPEAT_NONE;
            row->repeat_setting = "turns";
            row->reads[0] = simply(g->images[x].name);
            random_reads(g, row, seed, 1);
            continue;
        }
        row = random_pass(g, seed, x);
        if (y != x && g->images[y].size == g->images[x].size &&
            (g->images[y].format != LAO_FORMAT_D32F || g->images[x].format != LAO_FORMAT_D32F)) {
            row->writes[1] = at(g->images[y].name, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS,
                                (lao_load)(core_random(seed) % 3));
        }
        random_reads(g, row, seed, 0);
        g->built[x] = g->built[x] ? g->built[x] : 1;
        if (row->writes[1].image) {
            g->built[y] = g->built[y] ? g->built[y] : 1;
        }
        if (g->images[x].levels) {
            row = random_pass(g, seed, x);
            row->repeat = LAO_REPEAT_LEVELS_UP;
            row->reads[0] =
                at(g->images[x].name, LAO_LEVEL_FINER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD);
            random_reads(g, row, seed, 1);
            g->built[x] = 2;
        }
    }
    g->images[g->image_count] =
        image_row("final", LAO_FORMAT_R32F, LAO_SIZE_VIEW, NULL, LAO_IMAGE_HISTORY);
    row = &g->passes[g->pass_count++];
    memset(row, 0, sizeof *row);
    row->name = "end";
    row->shader = "s";
    row->writes[0] = simply("final");
    for (uint32_t i = 0, r = 0; i < g->image_count; i++) {
        int read = 0; /* by a pass that comes after a writer of it */
        for (uint32_t k = 0; k + 1 < g->pass_count; k++) {
            for (uint32_t m = 0; m < LAO_MAX_READS && g->passes[k].reads[m].image; m++) {
                read |= g->passes[k].reads[m].image == g->images[i].name &&
                        g->passes[k].reads[m].level == LAO_LEVEL_INDEX;
            }
            for (uint32_t m = 0; m < LAO_MAX_WRITES && g->passes[k].writes[m].image; m++) {
                read &= g->passes[k].writes[m].image != g->images[i].name;
            }
        }
        if (g->built[i] && !read) {
            row->reads[r++] = simply(g->images[i].name);
        }
    }
}

static void random_graphs_plan_soundly(void **state) {
    static planning p;
    static random_graph g;
    uint32_t seed = 5, good = 0, shared = 0, refused = 0;
    (void)state;
    for (int i = 0; i < 4000; i++) {
        tables t;
        char text[256] = "";
        tables_fill(&t);
        random_fill(&g, &seed);
        t.module.images = g.images;
        t.module.image_count = g.image_count + 1;
        t.module.passes = g.passes;
        t.module.pass_count = g.pass_count;
        planning_begin(&p, &t.module, 1 + core_random(&seed) % SETS);
        if (lao_graph_check(&p.graph, NULL, 0, text, sizeof text) == 0) {
            uint32_t instances = 0;
            for (uint32_t s = 0; s < SETS; s++) {
                p.values[s][0] = (float)(core_random(&seed) % 6);
                p.values[s][1] = (float)(core_random(&seed) % 5);
            }
            /* images are level by level those of the first set: one number of levels for all */
            p.values[1][0] = p.values[2][0] = p.values[0][0];
            p.desc.flags = core_random(&seed) % 8 == 0 ? LAO_VIEW_KEEP_IMAGES : 0u;
            planning_make(&p);
            check_plan(&p);
            for (uint32_t k = 0; k < p.plan.instance_count; k++) {
                instances += p.plan.instances[k].import == LAO_NO_INDEX;
            }
            shared += instances > p.plan.slot_count;
            good++;
        } else {
            refused++;
            if (!strstr(text, "no pass uses") && !strstr(text, "which nothing has written")) {
                fail_msg("%s", text);
            }
        }
        planning_end(&p);
    }
    assert_true(good > 1000);
    assert_true(shared > good / 10); /* memory is really shared, or the proof proves nothing */
}

/* ----------------------------------------------------------------------------------------------------
 * small print */

static void conditions_and_constants(void **state) {
    static planning p;
    tables t;
    static const struct {
        char compare;
        float value;
        int holds[3]; /* for levels = 2, 3, 4 */
    } cases[] = {
        {'=', 3, {0, 1, 0}}, {'!', 3, {1, 0, 1}}, {'<', 3, {1, 0, 0}}, {'>', 3, {0, 0, 1}}};
    static const char *const names[] = {"turns", "levels"};
    lao_shader shader;
    const lao_shader *shaders[1] = {&shader};
    (void)state;
    memset(&shader, 0, sizeof shader);
    shader.name = "s";
    shader.constants = names;
    shader.constant_count = 2;
    for (int i = 0; i < 4; i++) {
        for (int levels = 2; levels <= 4; levels++) {
            tables_fill(&t);
            t.passes[2].when[0].name = "levels";
            t.passes[2].when[0].compare = cases[i].compare;
            t.passes[2].when[0].value = cases[i].value;
            t.passes[3].reads[0].level_index = 0;
            planning_begin(&p, &t.module, 1);
            p.desc.shaders = shaders;
            p.values[0][0] = (float)levels;
            planning_make(&p);
            assert_int_equal(strstr(p.text, " up set ") != NULL, cases[i].holds[levels - 2]);
            for (uint32_t s = 0; s < p.plan.step_count; s++) {
                assert_int_equal(p.plan.steps[s].constants[0], 2);
                assert_int_equal(p.plan.steps[s].constants[1], levels);
            }
            planning_end(&p);
        }
    }
    /* the host's images: absent, readable, writable */
    for (int present = 0; present < 3; present++) {
        for (int asked = 0; asked < 3; asked++) {
            tables_fill(&t);
            t.passes[1].when[0].name = "@in";
            t.passes[1].when[0].compare = '=';
            t.passes[1].when[0].value = (float)asked;
            planning_begin(&p, &t.module, 1);
            if (present) {
                planning_import(&p, "in", present == 2 ? LAO_HOST_WRITABLE : 0u);
            }
            planning_make(&p);
            assert_int_equal(strstr(p.text, " second set ") != NULL, present == asked);
            planning_end(&p);
        }
    }
    /* an image that does not exist here is a hole, not a reference */
    tables_fill(&t);
    t.images[1].when.name = "turns";
    t.images[1].when.compare = '>';
    t.images[1].when.value = 5;
    planning_begin(&p, &t.module, 1);
    planning_make(&p);
    assert_int_equal(p.plan.steps[0].colors[0].instance, LAO_NO_INDEX);
    assert_int_equal(p.plan.steps[1].reads[0], LAO_NO_INDEX);
    planning_end(&p);
}

/* Another module's setting of the same name does not get in between. */
static void settings_belong_to_their_module(void **state) {
    static planning p;
    tables t;
    const lao_module *modules[2];
    (void)state;
    tables_fill(&t);
    planning_begin(&p, lao_lines_module(), 1);
    lao_graph_free(NULL, &p.graph);
    modules[0] = lao_lines_module(); /* has a setting "levels", too */
    modules[1] = &t.module;
    assert_int_equal(lao_graph_make(modules, 2, NULL, &p.graph), LAO_OK);
    planning_import(&p, "in", 0);
    p.values[0][LAO_SETTING_ID_levels] = 4;
    p.values[0][LAO_SETTING_COUNT] = 2; /* ours */
    p.values[0][LAO_SETTING_COUNT + 1] = 0;
    planning_make(&p);
    check_plan(&p);
    assert_non_null(strstr(p.text, "level_up set 0 level 3"));
    assert_non_null(strstr(p.text, " up set 0 level 1"));
    assert_null(strstr(p.text, " up set 0 level 2"));
    planning_end(&p);
}

static void memory_runs_out_anywhere(void **state) {
    static planning p;
    uint32_t n, failed = 0;
    (void)state;
    for (n = 1;; n++) {
        core_host host;
        lao_allocator allocator;
        const lao_module *module = lao_lines_module();
        lao_graph graph;
        lao_result result;
        memset(&host, 0, sizeof host);
        allocator = lent_allocator(&host.memory);
        host.memory.fail_allocation = n;
        planning_begin(&p, module, 2);
        result = lao_graph_make(&module, 1, &allocator, &graph);
        if (result == LAO_OK) {
            result = lao_plan_make(&graph, &p.desc, &allocator, &p.plan);
            if (result != LAO_OK) {
                failed++;
                assert_int_equal(result, LAO_ERROR_OUT_OF_MEMORY);
                assert_int_equal(p.plan.step_count, 0);
                assert_int_equal(lao_plan_make(&graph, &p.desc, &allocator, &p.plan),
                                 LAO_OK); /* goes on */
            }
            check_plan(&p);
            lao_plan_free(&allocator, &p.plan);
            lao_graph_free(&allocator, &graph);
        }
        assert_int_equal(host.memory.bytes, 0);
        assert_int_equal(host.memory.blocks, 0);
        planning_end(&p);
        if (!host.memory.refused) {
            break;
        }
        assert_int_equal(result, LAO_ERROR_OUT_OF_MEMORY);
    }
    assert_true(n > 10 && failed > 5);
}

static void the_graph_prints_itself(void **state) {
    static char text[TEXT];
    const lao_module *module = lao_lines_module();
    (void)state;
    text[0] = 0;
    lao_graph_print(&module, 1, append, text);
    assert_int_equal(strncmp(text, "digraph lineao {", 16), 0);
    for (uint32_t i = 0; i < module->pass_count; i++) {
        char wanted[128];
        snprintf(wanted, sizeof wanted, "\"pass %s\" -> \"%s\";", module->passes[i].name,
                 module->passes[i].writes[0].image);
        assert_non_null(strstr(text, wanted));
        snprintf(wanted, sizeof wanted, "\"%s\" -> \"pass %s\";", module->passes[i].reads[0].image,
                 module->passes[i].name);
        assert_non_null(strstr(text, wanted));
    }
    assert_non_null(strstr(text, "\"host_depth\" [shape=ellipse, style=dashed]"));
    assert_string_equal(text + strlen(text) - 2, "}\n");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planted_faults_are_found),
        cmocka_unit_test(the_line_module_is_sound),
        cmocka_unit_test(shipped_plans_are_as_written),
        cmocka_unit_test(every_structure_of_the_line_module_is_sound),
        cmocka_unit_test(repeats_levels_and_phases),
        cmocka_unit_test(keep_clears_each_level_and_partner_once),
        cmocka_unit_test(rows_repeat_together),
        cmocka_unit_test(random_graphs_plan_soundly),
        cmocka_unit_test(conditions_and_constants),
        cmocka_unit_test(settings_belong_to_their_module),
        cmocka_unit_test(memory_runs_out_anywhere),
        cmocka_unit_test(the_graph_prints_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
