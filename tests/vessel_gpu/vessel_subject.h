/* What the tests of trees on both backends draw: a tree built to hurt, as an object (thick and
 * thin, a child inside its parent, a lone ball, a radius of 0), and a shot of one. */
#ifndef VESSEL_SUBJECT_H
#define VESSEL_SUBJECT_H

#include "render_host.h"
#include "sdfvessel.h"

#include <stdlib.h>
#include <string.h>

typedef struct subject {
    sdv_tree tree;
    sdv_grid grid;
    sdv_object object;
    uint8_t *colors;
    sdv_attribute attributes[3]; /* of a subject with forms */
    float *values;
} subject;

static uint32_t random_of(uint32_t *state) {
    *state = *state * 747796405u + 2891336453u;
    return *state >> 8;
}

static float between(uint32_t *state, float low, float high) {
    return low + (high - low) * (float)random_of(state) / 16777216.0f;
}

static void subject_make(subject *s, uint32_t nodes, uint32_t seed) {
    float *positions = calloc(nodes, 3 * sizeof(float)), *radii = calloc(nodes, sizeof(float));
    sdv_segment *segments = calloc(nodes, sizeof *segments);
    uint32_t count = 0;
    sdv_tree_desc desc;
    sdv_grid_desc grid;
    memset(s, 0, sizeof *s);
    memset(&desc, 0, sizeof desc);
    memset(&grid, 0, sizeof grid);
    assert_true(positions && radii && segments);
    for (uint32_t i = 0; i < nodes; i++) {
        uint32_t parent = i ? random_of(&seed) % i : 0;
        for (uint32_t k = 0; k < 3; k++) {
            positions[3 * i + k] = i ? positions[3 * parent + k] + between(&seed, -6, 6) : 0.0f;
        }
        radii[i] = i % 11 == 5 ? 0.0f : between(&seed, 0.05f, i % 7 == 0 ? 3.0f : 0.6f);
        if (i && i != nodes - 1) { /* the last one is a lone ball */
            segments[count].parent = parent;
            segments[count++].child = i;
        }
    }
    radii[0] = 2;
    desc.node_count = nodes;
    desc.positions = positions;
    desc.radii = radii;
    desc.segment_count = count;
    desc.segments = segments;
    grid.resolution = 40;
    assert_int_equal(sdv_tree_build(NULL, &desc, &s->tree), LAO_OK);
    assert_int_equal(sdv_grid_build(NULL, &s->tree, &grid, &s->grid), LAO_OK);
    s->colors = malloc(8 * (size_t)s->grid.cone_count);
    assert_non_null(s->colors);
    for (uint32_t i = 0; i < 8 * s->grid.cone_count; i++) {
        s->colors[i] = (uint8_t)random_of(&seed);
    }
    assert_int_equal(sdv_object_make(NULL, &s->grid, s->colors, &s->object), LAO_OK);
    free(positions);
    free(radii);
    free(segments);
}

/* Gives its vessels forms: ellipses, some of them circles or without a value, and noise, here and
 * there of no amplitude or too much. */
static inline void subject_form(subject *s, uint32_t seed) {
    uint32_t n = s->tree.node_count;
    sdv_grid_desc grid;
    memset(&grid, 0, sizeof grid);
    grid.resolution = 40;
    s->values = malloc(5 * n * sizeof(float));
    assert_non_null(s->values);
    for (uint32_t i = 0; i < n; i++) {
        s->values[i] = i % 5 == 0 ? 1.0f : between(&seed, -0.1f, 1.1f);
        s->values[n + i] = i % 7 == 3 ? 0.0f : s->tree.nodes[i].w * between(&seed, 0.0f, 0.9f);
        for (uint32_t k = 0; k < 3; k++)
            s->values[2 * n + 3 * i + k] = i % 13 == 1 ? 0.0f : between(&seed, -1, 1);
    }
    s->attributes[0] = (sdv_attribute){SDV_SECTION_RATIO, 1, s->values};
    s->attributes[1] = (sdv_attribute){SDV_UNCERTAINTY, 1, s->values + n};
    s->attributes[2] = (sdv_attribute){SDV_SECTION_AXIS, 3, s->values + 2 * n};
    s->tree.node_attributes = s->attributes;
    s->tree.node_attribute_count = 3;
    sdv_object_free(&s->object);
    sdv_grid_free(&s->grid);
    assert_int_equal(sdv_grid_build(NULL, &s->tree, &grid, &s->grid), LAO_OK);
    assert_non_null(s->grid.forms);
    assert_int_equal(sdv_object_make(NULL, &s->grid, s->colors, &s->object), LAO_OK);
}

static void subject_free(subject *s) {
    free(s->values);
    sdv_object_free(&s->object);
    sdv_grid_free(&s->grid);
    sdv_tree_free(&s->tree);
    free(s->colors);
}

/* Nothing but the sets, a pixel as it is traced; the camera sees all of a subject. */
static void shot_make(render_shot *shot, lao_settings *lines, uint32_t width, uint32_t height) {
    memset(shot, 0, sizeof *shot);
    memset(lines, 0, sizeof *lines);
    shot->width = width;
    shot->height = height;
    shot->background[3] = 1;
    lines->set = LAO_SET(occlusion);
    lines->supersampling = 1;
    shot->camera = render_camera(0.3, 0.5, 0.8, 45);
    render_perspective(&shot->camera, 40, (double)width / height, 1, 200);
}

/* A shot of one set. */
typedef struct scene {
    render_shot shot;
    lao_settings lines;
    sdv_settings vessel;
    const void *settings[1];
} scene;

/* `object` NULL: none. It must not move. */
static inline void scene_make(scene *s, const lao_object_desc *object, uint32_t width,
                              uint32_t height) {
    memset(s, 0, sizeof *s);
    shot_make(&s->shot, &s->lines, width, height);
    s->settings[0] = &s->vessel;
    s->shot.set_count = 1;
    s->shot.settings[0] = &s->lines;
    s->shot.objects[0] = object;
    s->shot.module_settings[0] = s->settings;
}

#endif
