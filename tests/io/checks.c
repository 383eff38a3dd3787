/* Assertions about samples; see samples.h. */
#include "samples.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

const io_attribute *point_attribute(const io_lines *lines, const char *name) {
    for (uint32_t i = 0; i < lines->point_attribute_count; i++)
        if (!strcmp(lines->point_attributes[i].name, name))
            return &lines->point_attributes[i];
    return NULL;
}

const io_attribute *line_attribute(const io_lines *lines, const char *name) {
    for (uint32_t i = 0; i < lines->line_attribute_count; i++)
        if (!strcmp(lines->line_attributes[i].name, name))
            return &lines->line_attributes[i];
    return NULL;
}

bool has_warning(const io_lines *lines, const char *word) {
    for (uint32_t i = 0; i < lines->warning_count; i++)
        if (strstr(lines->warnings[i], word))
            return true;
    return false;
}

static void assert_near(double a, double b) {
    assert_true(a - b < 1e-6 && b - a < 1e-6);
}

void assert_sample(const io_lines *lines, bool attributes, bool groups) {
    assert_int_equal(lines->line_count, SAMPLE_LINES);
    assert_int_equal(lines->point_count, SAMPLE_POINTS);
    assert_memory_equal(lines->offsets, sample_offsets, sizeof sample_offsets);
    for (size_t k = 0; k < SAMPLE_POINTS; k++)
        for (unsigned axis = 0; axis < 3; axis++)
            assert_near((double)lines->points[3 * k + axis] + lines->origin[axis],
                        sample_position(k, axis));
    assert_int_equal(lines->warning_count, 0);
    if (attributes) {
        const io_attribute *s = point_attribute(lines, "s"), *v = point_attribute(lines, "v");
        const io_attribute *w = line_attribute(lines, "w");
        assert_true(s && s->components == 1 && v && v->components == 3 && w && w->components == 1);
        for (size_t k = 0; k < SAMPLE_POINTS; k++) {
            assert_near((double)s->data[k], sample_scalar(k));
            for (unsigned axis = 0; axis < 3; axis++)
                assert_near((double)v->data[3 * k + axis], sample_vector(k, axis));
        }
        for (size_t i = 0; i < SAMPLE_LINES; i++)
            assert_near((double)w->data[i], sample_weight(i));
    }
    assert_int_equal(lines->group_count, groups ? 2 : 0);
    if (groups) {
        const uint32_t first[2] = {0, 2};
        assert_string_equal(lines->groups[0].name, "0");
        assert_string_equal(lines->groups[1].name, "7");
        assert_int_equal(lines->groups[0].line_count, 2);
        assert_memory_equal(lines->groups[0].lines, first, sizeof first);
        assert_int_equal(lines->groups[1].line_count, 1);
        assert_int_equal(lines->groups[1].lines[0], 1);
    }
}

io_lines must_read(const buffer *b, const char *name, const io_options *options) {
    io_lines lines = {0};
    io_error error;
    if (!io_read_lines_memory(b->data, b->size, name, options, &lines, &error))
        fail_msg("%s: %s", name ? name : "memory", error.text);
    return lines;
}

void must_fail(const buffer *b, const char *name, const io_options *options, const char *word) {
    io_lines lines, before;
    io_error error = {""};
    memset(&lines, 0x5A, sizeof lines);
    before = lines;
    bool done = io_read_lines_memory(b->data, b->size, name, options, &lines, &error);
    assert_false(done);
    assert_memory_equal(&lines, &before, sizeof lines);
    assert_true(error.text[0]);
    if (word && !strstr(error.text, word))
        fail_msg("'%s' is missing in: %s", word, error.text);
}
