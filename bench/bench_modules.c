#include "bench_modules.h"

#include "bench_shaders.h"

#include <stdio.h>
#include <string.h>

bool bench_floors_have_words(void) {
    return BENCH_HAVE_WORDS != 0;
}

const lao_shader *bench_floor_shaders(uint32_t *count) {
    *count = (uint32_t)(sizeof bench_shaders / sizeof *bench_shaders);
    return bench_shaders;
}

/* The settings block of a module holds its own settings, and the vertex stage of the line pass
 * reads those of the line module: so they are ours too, in the same places, under names that hide
 * none. */
static void add_settings(bench_floors *floors, const lao_settings *settings) {
    const lao_module *lines = lao_lines_module();
    float values[BENCH_SETTINGS];
    lao_settings_resolve(lines, settings, values);
    for (uint32_t i = 0; i < lines->setting_count; i++) {
        floors->settings[i] = lines->settings[i];
        floors->settings[i].standard = values[i];
        floors->settings[i].structural = 0;
        snprintf(floors->names[i], sizeof floors->names[i], "floor_%s", lines->settings[i].name);
        floors->settings[i].name = floors->names[i];
    }
    floors->module.settings = floors->settings;
    floors->module.setting_count = lines->setting_count;
}

/* HISTORY: what nothing reads is kept for the next frame, else the graph would be refused. */
static void add_image(bench_floors *floors, const char *name, lao_format format) {
    lao_image_row *row = &floors->images[floors->module.image_count++];
    memset(row, 0, sizeof *row);
    row->name = name;
    row->format = format;
    row->size = LAO_SIZE_FULL;
    row->flags = format == LAO_FORMAT_D32F ? 0 : LAO_IMAGE_HISTORY;
    row->clear[0] = format == LAO_FORMAT_D32F ? 1.0f : 0.0f;
    if (format == LAO_FORMAT_R32F) {
        row->when.name = "occlusion";
        row->when.compare = '=';
        row->when.value = 1;
    }
}

static lao_reference reference(const char *image, lao_load load) {
    lao_reference r;
    memset(&r, 0, sizeof r);
    r.image = image;
    r.load = load;
    return r;
}

static void add_lines(bench_floors *floors) {
    const lao_module *lines = lao_lines_module();
    lao_pass_row *row = &floors->passes[floors->module.pass_count++];
    for (uint32_t i = 0; i < lines->pass_count; i++) {
        if (strcmp(lines->passes[i].name, "lines") == 0)
            *row = lines->passes[i];
    }
    row->name = "floor_lines";
    row->shader = "floor_lines";
    row->kind = LAO_PASS_DRAW_LINES;        /* all of them, not the first part */
    memset(row->when, 0, sizeof row->when); /* beside whichever row draws the lines */
    memset(row->writes, 0, sizeof row->writes);
    row->writes[0] = reference("floor_color", LAO_LOAD_CLEAR);
    row->writes[1] = reference("floor_zbuffer", LAO_LOAD_CLEAR);
}

static void add_taps(bench_floors *floors) {
    lao_pass_row *row = &floors->passes[floors->module.pass_count++];
    memset(row, 0, sizeof *row);
    row->name = row->shader = "floor_taps";
    row->stage = LAO_STAGE_SHADE;
    row->scope = LAO_SCOPE_PER_SET;
    row->when[0].name = "occlusion";
    row->when[0].compare = '=';
    row->when[0].value = 1;
    row->writes[0] = reference("floor_taps", LAO_LOAD_DISCARD);
    for (uint32_t i = 0; i < 3; i++) {
        row->reads[i] = reference("level", LAO_LOAD_DISCARD);
        row->reads[i].level = LAO_LEVEL_INDEX;
        row->reads[i].level_index = i;
    }
}

const lao_module *bench_floors_make(bench_floors *floors, const lao_settings *settings) {
    memset(floors, 0, sizeof *floors);
    floors->module.name = "floors";
    floors->module.passes = floors->passes;
    floors->module.images = floors->images;
    floors->module.shaders = bench_floor_shaders(&floors->module.shader_count);
    add_settings(floors, settings);
    add_image(floors, "floor_color", LAO_FORMAT_RGBA8);
    add_image(floors, "floor_zbuffer", LAO_FORMAT_D32F);
    add_image(floors, "floor_taps", LAO_FORMAT_R32F);
    add_lines(floors);
    add_taps(floors);
    return &floors->module;
}
