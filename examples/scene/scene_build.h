/* Private to lineao_scene: what the makers of scenes share. */
#ifndef LINEAO_SCENE_BUILD_H
#define LINEAO_SCENE_BUILD_H

#include "scene.h"

typedef struct vec3 {
    double x, y, z;
} vec3;

vec3 vec3_make(double x, double y, double z);
vec3 vec3_add(vec3 a, vec3 b);
vec3 vec3_sub(vec3 a, vec3 b);
vec3 vec3_scale(vec3 a, double s);
vec3 vec3_mad(vec3 a, vec3 b, double s); /* a + b * s */
double vec3_dot(vec3 a, vec3 b);
vec3 vec3_cross(vec3 a, vec3 b);
vec3 vec3_unit(vec3 a); /* (1, 0, 0) when a is zero */

/* Random number in (0, 1), a hash of its counters: no state, no order. */
double scene_random(uint32_t seed, uint32_t item, uint32_t use);

/* Two waves of random phase, about -1..1 and smooth over t in [0, 1]. */
double scene_wave(uint32_t seed, uint32_t item, uint32_t use, double t);

/* Item i of n spread evenly over the unit disc: a sunflower, jittered so that no spiral shows. */
void scene_disc(uint32_t seed, uint32_t i, uint32_t n, double *u, double *v);

/* A scene under construction. After a failed allocation all calls do nothing. */
typedef struct scene_builder {
    scene_lines lines;
    uint32_t line_room, point_room, seed;
    bool failed;
} scene_builder;

/* Adds a point to the open line. */
void scene_point(scene_builder *builder, vec3 position, double time, double value);

/* Ends the open line, which may be empty. */
void scene_end_line(scene_builder *builder);

/* Each adds `count` lines. */
void scene_build_aorta(scene_builder *builder, uint32_t count);
void scene_build_crossing(scene_builder *builder, uint32_t count);
void scene_build_helix(scene_builder *builder, uint32_t count);
void scene_build_ball(scene_builder *builder, uint32_t count);
void scene_build_bundle(scene_builder *builder, uint32_t count);
void scene_build_flow(scene_builder *builder, uint32_t count);
void scene_build_aneurysm(scene_builder *builder, uint32_t count);
void scene_build_stress(scene_builder *builder, uint32_t count);

#endif
