/* Lines that break renderers, on a 6 x 4 board of 20 mm cells, seen along -z. */
#include "scene_build.h"

#include <stddef.h>

#include <math.h>

static void add(scene_builder *builder, vec3 origin, double x, double y, double z) {
    scene_point(builder, vec3_make(origin.x + x, origin.y + y, origin.z + z), 0.0, 0.0);
}

/* A line through the given x, y pairs; a pair given twice is a repeated point. */
static void path(scene_builder *builder, vec3 origin, const double *pairs, int count) {
    for (size_t i = 0; i < (size_t)count; i++)
        add(builder, origin, pairs[2 * i], pairs[2 * i + 1], 0.0);
}

/* An arc of a circle, or a closed loop (turns = 1) whose last point is bit-equal to its first. */
static void arc(scene_builder *builder, vec3 origin, double radius, int points, double turns,
                double rise) {
    for (int i = 0; i < points; i++) {
        double t = (double)i / (points - 1), angle = 6.283185307179586 * turns * t;
        if (turns == 1.0 && rise == 0.0 && i == points - 1)
            angle = 0.0;
        add(builder, origin, radius * cos(angle), radius * sin(angle), rise * t);
    }
}

/* A zig-zag whose corners turn by `degrees`. */
static void zigzag(scene_builder *builder, vec3 origin, int corners, double degrees) {
    double half = 0.5 * degrees * 3.14159265358979 / 180.0, step = 14.0 / (corners + 1);
    double rise = fmin(step * tan(half), 12.0);
    for (int i = 0; i < corners + 2; i++) {
        add(builder, origin, -7.0 + step * i, i % 2 ? 0.5 * rise : -0.5 * rise, 0.0);
    }
}

static void add_case(scene_builder *builder, uint32_t which, vec3 o) {
    static const double dot[] = {0, 0, 0, 0},
                        repeats[] = {-7, -4, -7, -4, 0, 3, 0, 3, 0, 3, 7, -4, 7, -4};
    static const double hairpin[] = {-7, 0, 7, 0, -7, 0},
                        pins[] = {-7, -1, 7, -1, -7, 0, 7, 0, -7, 1, 7, 1};
    static const double corner[] = {-6, -6, 6, -6, 6, 6},
                        square[] = {-6, -6, 6, -6, 6, 6, -6, 6, -6, -6};
    static const double two[] = {-7, -7, 7, 7}, tiny[] = {0, 0, 1e-4, 0, 2e-4, 0};
    static const double uneven[] = {-7, 0, -6.9999, 0, 6.9, 1, 7, 1, 7, 1.001};
    static const double tick[] = {-7, 0, 0, 0, 0, 0.05, 7, 0.05};
    switch (which) {
    case 0:
        break; /* no points */
    case 1:
        path(builder, o, dot, 1);
        break;
    case 2:
        path(builder, o, dot, 2);
        break; /* zero length */
    case 3:
        path(builder, o, tiny, 3);
        break;
    case 4:
        path(builder, o, two, 2);
        break;
    case 5:
        path(builder, o, repeats, 7);
        break;
    case 6:
        path(builder, o, hairpin, 3);
        break;
    case 7:
        path(builder, o, pins, 6);
        break;
    case 8:
        path(builder, o, corner, 3);
        break;
    case 9:
        path(builder, o, square, 5);
        break;
    case 10:
        path(builder, o, uneven, 5);
        break;
    case 11:
        path(builder, o, tick, 4);
        break;
    case 12:
        arc(builder, o, 6.5, 4, 1.0, 0.0);
        break; /* a closed triangle */
    case 13:
        arc(builder, o, 6.5, 65, 1.0, 0.0);
        break;
    case 14:
        arc(builder, o, 0.6, 33, 1.0, 0.0);
        break; /* narrower than its line */
    case 15:
        arc(builder, o, 6.5, 49, 0.98, 0.0);
        break; /* nearly closed */
    case 16:
        arc(builder, o, 5.0, 97, 4.0, -30.0);
        break; /* a spring seen end-on */
    case 17:
        arc(builder, o, 0.0, 40, 1.0, -20.0);
        break; /* straight away from the viewer */
    case 18:
        arc(builder, o, 0.4, 40, 0.5, -40.0);
        break; /* nearly so */
    case 19:
        zigzag(builder, o, 9, 60.0);
        break;
    case 20:
        zigzag(builder, o, 9, 120.0);
        break;
    case 21:
        zigzag(builder, o, 13, 165.0);
        break;
    case 22:
        zigzag(builder, o, 3, 179.0);
        break;
    default:
        zigzag(builder, o, 60, 90.0);
        break; /* corners nearer than the line is wide */
    }
}

void scene_build_stress(scene_builder *builder, uint32_t count) {
    enum { CASES = 24, COLUMNS = 6 };
    for (uint32_t i = 0; i < count && !builder->failed; i++) {
        uint32_t which = i % CASES, layer = i / CASES, row = which / COLUMNS;
        add_case(builder, which, vec3_make(20.0 * (which % COLUMNS), -20.0 * row, -60.0 * layer));
        scene_end_line(builder);
    }
}
