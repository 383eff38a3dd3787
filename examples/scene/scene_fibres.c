/* Scenes of bundles: each bundle is a row of ribs, ellipses that a smooth curve passes through. */
#include "scene_build.h"

#include <math.h>

/* A cross-section of a bundle: centre and two half axes, mm. */
typedef struct rib {
    double centre[3], a[3], b[3];
} rib;

static vec3 rib_point(const rib *r, double u, double v) {
    return vec3_make(r->centre[0] + u * r->a[0] + v * r->b[0],
                     r->centre[1] + u * r->a[1] + v * r->b[1],
                     r->centre[2] + u * r->a[2] + v * r->b[2]);
}

/* Place (u, v) of the cross-section at t in [0, 1] along a bundle: a uniform cubic B-spline over
 * the ribs, with end ribs mirrored outwards so that it starts and ends on them. */
static vec3 bundle_point(const rib *ribs, int count, double t, double u, double v) {
    double x = t * (double)(count - 1);
    int span = x >= (double)(count - 1) ? count - 2 : (int)x;
    double f = x - (double)span, g = 1.0 - f;
    const double weights[4] = {g * g * g / 6.0, (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0,
                               (3.0 * g * g * g - 6.0 * g * g + 4.0) / 6.0, f * f * f / 6.0};
    vec3 sum = {0.0, 0.0, 0.0};
    for (int k = 0; k < 4; k++) {
        int i = span - 1 + k, last = count - 1;
        vec3 p;
        if (i < 0 || i > last) {
            int end = i < 0 ? 0 : last, inner = i < 0 ? 1 : last - 1;
            vec3 edge = rib_point(&ribs[end], u, v);
            p = vec3_sub(vec3_scale(edge, 2.0), rib_point(&ribs[inner], u, v));
        } else {
            p = rib_point(&ribs[i], u, v);
        }
        sum = vec3_mad(sum, p, weights[k]);
    }
    return sum;
}

/* How a bundle's lines differ from one another. */
typedef struct fibre_style {
    uint32_t points;
    double wander; /* size of the waves across the bundle, in half axes */
    double trim;   /* most that a line may lack at an end, as part of its length */
} fibre_style;

/* Adds `lines` lines of a bundle; `id` tells bundles apart in the random numbers. */
static void add_bundle(scene_builder *builder, const rib *ribs, int count, uint32_t id,
                       uint32_t lines, fibre_style style) {
    uint32_t seed = builder->seed * 131u + id;
    for (uint32_t i = 0; i < lines && !builder->failed; i++) {
        double u, v, early = scene_random(seed, i, 90), late = scene_random(seed, i, 91);
        scene_disc(seed, i, lines, &u, &v);
        double t0 = style.trim * early * early, t1 = 1.0 - style.trim * late * late;
        for (uint32_t k = 0; k < style.points; k++) {
            double t = t0 + (t1 - t0) * (double)k / (double)(style.points - 1);
            double du = style.wander * scene_wave(seed, i, 0, t);
            double dv = style.wander * scene_wave(seed, i, 1, t);
            scene_point(builder, bundle_point(ribs, count, t, u + du, v + dv), 0.0, 0.0);
        }
        scene_end_line(builder);
    }
}

/* The lines of item i when `count` are dealt out in the given parts of `whole`. */
static uint32_t share(uint32_t count, uint32_t from, uint32_t to, uint32_t whole) {
    return (uint32_t)((uint64_t)count * to / whole - (uint64_t)count * from / whole);
}

/* ---- crossing --------------------------------------------------------------------------- */

/* Right halves, after the places of the corpus callosum, the corticospinal tract and the arcuate
 * fasciculus, whose fibres cross beside the ventricles. */
static const rib callosum[] = {
    {{-54, -2, 56}, {-4, 40, -12}, {-13, 0, 5}}, {{-46, -2, 40}, {-3, 33, -6}, {-9, 0, 7}},
    {{-30, -2, 22}, {0, 25, -2}, {-4, 0, 6}},    {{-14, -2, 13}, {0, 21, -2}, {0, 0, 4.5}},
    {{0, -2, 11}, {0, 20, -2}, {0, 0, 4}},       {{14, -2, 13}, {0, 21, -2}, {0, 0, 4.5}},
    {{30, -2, 22}, {0, 25, -2}, {4, 0, 6}},      {{46, -2, 40}, {3, 33, -6}, {9, 0, 7}},
    {{54, -2, 56}, {4, 40, -12}, {13, 0, 5}},
};
static const rib corticospinal[] = {
    {{7, -26, -66}, {3.5, 0, 0}, {0, 3.5, 0}},  {{9, -23, -46}, {4, 0, 0}, {0, 4, 0}},
    {{14, -17, -24}, {4.5, 0, 1}, {0, 5.5, 0}}, {{23, -11, -4}, {4, 0, 1}, {0, 8, 0}},
    {{27, -9, 16}, {4.5, 0, 0}, {0, 10, 0}},    {{29, -10, 38}, {9, 0, -2}, {0, 14, 0}},
    {{32, -12, 58}, {17, 0, -6}, {0, 20, -2}},  {{34, -13, 74}, {22, 0, -9}, {0, 24, -3}},
};
static const rib arcuate[] = {
    {{44, 50, 8}, {9, 0, 4}, {0, 4, 10}},     {{41, 36, 18}, {6, 0, 2}, {0, 2, 7}},
    {{38, 16, 27}, {4.5, 0, 1}, {0, 1, 5}},   {{37, -8, 31}, {4, 0, 0}, {0, 0, 4.5}},
    {{38, -30, 28}, {4, 0, 0}, {0, 2, 4.5}},  {{41, -45, 15}, {4.5, 0, 0}, {0, 4.5, 1}},
    {{46, -44, -4}, {4.5, 0, 0}, {0, 4, -3}}, {{51, -30, -17}, {5, 0, 0}, {0, 2, -5}},
    {{54, -10, -22}, {6, 0, 2}, {0, 0, -7}},  {{55, 8, -22}, {8, 0, 2}, {0, 0, -9}},
};

static void mirror(const rib *ribs, int count, rib *out) {
    for (int i = 0; i < count; i++) {
        out[i] = ribs[i];
        out[i].centre[0] = -out[i].centre[0];
        out[i].a[0] = -out[i].a[0];
        out[i].b[0] = -out[i].b[0];
    }
}

void scene_build_crossing(scene_builder *builder, uint32_t count) {
    enum { CC = sizeof callosum / sizeof(rib), CST = sizeof corticospinal / sizeof(rib) };
    enum { AF = sizeof arcuate / sizeof(rib) };
    const fibre_style style = {100, 0.14, 0.16};
    rib left[CC + CST + AF];
    add_bundle(builder, callosum, CC, 1, share(count, 0, 40, 100), style);
    add_bundle(builder, corticospinal, CST, 2, share(count, 40, 56, 100), style);
    mirror(corticospinal, CST, left);
    add_bundle(builder, left, CST, 3, share(count, 56, 72, 100), style);
    add_bundle(builder, arcuate, AF, 4, share(count, 72, 86, 100), style);
    mirror(arcuate, AF, left);
    add_bundle(builder, left, AF, 5, share(count, 86, 100, 100), style);
}

/* ---- bundle: a ball of 24 bundles for benchmarks ----------------------------------------- */

void scene_build_bundle(scene_builder *builder, uint32_t count) {
    enum { BUNDLES = 24, RIBS = 6 };
    static const double reach[RIBS] = {68, 52, 34, 34, 52, 68}, fan[RIBS] = {14, 8, 5, 5, 8, 14};
    const fibre_style style = {100, 0.12, 0.0};
    for (uint32_t k = 0; k < BUNDLES; k++) {
        /* from a Fibonacci point of the sphere to a far but not opposite place */
        double z = 1.0 - (2.0 * k + 1.0) / BUNDLES, ring = sqrt(1.0 - z * z), turn = 2.39996323 * k;
        vec3 from = vec3_make(ring * cos(turn), ring * sin(turn), z);
        vec3 random = vec3_make(scene_random(7, k, 0) - 0.5, scene_random(7, k, 1) - 0.5,
                                scene_random(7, k, 2) - 0.5);
        vec3 side = vec3_unit(vec3_cross(from, random));
        double angle = 1.3 + 1.1 * scene_random(7, k, 3);
        vec3 axis = vec3_cross(from, side);
        rib ribs[RIBS];
        for (int i = 0; i < RIBS; i++) {
            double a = angle * (double)i / (RIBS - 1);
            vec3 d = vec3_add(vec3_scale(from, cos(a)), vec3_scale(side, sin(a)));
            vec3 along = vec3_sub(vec3_scale(side, cos(a)), vec3_scale(from, sin(a)));
            /* ends stand upright on the surface, the middle runs round the centre */
            double upright = i == 0 || i == RIBS - 1 ? 1.0 : 0.45;
            vec3 b = vec3_unit(vec3_add(vec3_scale(along, upright), vec3_scale(d, 1.0 - upright)));
            const rib r = {
                {d.x * reach[i], d.y * reach[i] * 1.2, d.z * reach[i]},
                {axis.x * fan[i] * 1.3, axis.y * fan[i] * 1.3, axis.z * fan[i] * 1.3},
                {b.x * fan[i] * 0.8, b.y * fan[i] * 0.8, b.z * fan[i] * 0.8},
            };
            ribs[i] = r;
        }
        add_bundle(builder, ribs, RIBS, 20 + k, share(count, k, k + 1, BUNDLES), style);
    }
}

/* ---- helix ------------------------------------------------------------------------------ */

void scene_build_helix(scene_builder *builder, uint32_t count) {
    enum { POINTS = 120 };
    static const rib core[] = {
        {{0, 0, -47}, {12, 0, 0}, {0, 12, 0}}, {{0, 0, -30}, {10.5, 0, 0}, {0, 10.5, 0}},
        {{0, 0, 0}, {9.5, 0, 0}, {0, 9.5, 0}}, {{0, 0, 30}, {10.5, 0, 0}, {0, 10.5, 0}},
        {{0, 0, 47}, {12, 0, 0}, {0, 12, 0}},
    };
    const fibre_style style = {POINTS, 0.06, 0.08};
    add_bundle(builder, core, 5, 10, share(count, 0, 50, 100), style);
    for (uint32_t strand = 0; strand < 2; strand++) {
        uint32_t lines = share(count, 50 + 25 * strand, 75 + 25 * strand, 100);
        uint32_t seed = builder->seed * 131u + 11 + strand;
        for (uint32_t i = 0; i < lines && !builder->failed; i++) {
            double u, v, early = scene_random(seed, i, 90), late = scene_random(seed, i, 91);
            scene_disc(seed, i, lines, &u, &v);
            for (uint32_t k = 0; k < POINTS; k++) {
                double t = 0.08 * early * early +
                           (1.0 - 0.08 * (early * early + late * late)) * (double)k / (POINTS - 1);
                double turn = 6.2831853 * (1.8 * t + 0.5 * strand), twist = 6.2831853 * 1.5 * t;
                double wu = u + 0.08 * scene_wave(seed, i, 0, t);
                double wv = v + 0.08 * scene_wave(seed, i, 1, t);
                double out = wu * cos(twist) - wv * sin(twist);
                double along = wu * sin(twist) + wv * cos(twist);
                double radius = 11.4 + 3.6 * out;
                /* the strand's section is square to its own, inclined course */
                scene_point(builder,
                            vec3_make(radius * cos(turn) + 2.2 * along * sin(turn),
                                      radius * sin(turn) - 2.2 * along * cos(turn),
                                      -44.0 + 88.0 * t + 3.2 * along),
                            0.0, 0.0);
            }
            scene_end_line(builder);
        }
    }
}

/* ---- ball ------------------------------------------------------------------------------- */

enum { BALL_MODES = 5 };

typedef struct ball_field {
    vec3 wave[BALL_MODES], side[BALL_MODES], other[BALL_MODES]; /* other = wave x side */
    double phase[BALL_MODES];
} ball_field;

static ball_field make_ball_field(uint32_t seed) {
    ball_field field;
    for (uint32_t m = 0; m < BALL_MODES; m++) {
        vec3 k, a;
        k = vec3_make(scene_random(seed, m, 0) - 0.5, scene_random(seed, m, 1) - 0.5,
                      scene_random(seed, m, 2) - 0.5);
        a = vec3_make(scene_random(seed, m, 3) - 0.5, scene_random(seed, m, 4) - 0.5,
                      scene_random(seed, m, 5) - 0.5);
        field.wave[m] = vec3_scale(vec3_unit(k), 2.2 + 2.2 * scene_random(seed, m, 6));
        field.side[m] = vec3_unit(vec3_cross(k, a));
        field.other[m] = vec3_cross(field.wave[m], field.side[m]);
        field.phase[m] = 6.2831853 * scene_random(seed, m, 7);
    }
    return field;
}

/* Direction at p in the unit ball: the curl of (1 - |p|^2) * sum of waves, so that the lines fill
 * the ball evenly and run along its surface instead of through it. */
static vec3 ball_direction(const ball_field *field, vec3 p) {
    vec3 potential = {0, 0, 0}, curl = {0, 0, 0};
    for (int m = 0; m < BALL_MODES; m++) {
        double at = vec3_dot(field->wave[m], p) + field->phase[m];
        potential = vec3_mad(potential, field->side[m], sin(at));
        curl = vec3_mad(curl, field->other[m], cos(at));
    }
    vec3 along = vec3_scale(curl, 1.0 - vec3_dot(p, p));
    return vec3_unit(vec3_mad(along, vec3_cross(p, potential), -2.0));
}

void scene_build_ball(scene_builder *builder, uint32_t count) {
    enum { POINTS = 60 };
    const double radius = 50.0;
    uint32_t seed = builder->seed * 131u + 50;
    const ball_field field = make_ball_field(seed);
    for (uint32_t i = 0; i < count && !builder->failed; i++) {
        double z = 2.0 * scene_random(seed, i, 20) - 1.0,
               turn = 6.2831853 * scene_random(seed, i, 21);
        double ring = sqrt(1.0 - z * z), r = 0.985 * cbrt(scene_random(seed, i, 22));
        double step = (0.8 + 0.9 * scene_random(seed, i, 23)) / radius;
        vec3 p = vec3_make(r * ring * cos(turn), r * ring * sin(turn), r * z);
        for (int k = 0; k < POINTS; k++) {
            scene_point(builder, vec3_scale(p, radius), 0.0, 0.0);
            vec3 middle = vec3_mad(p, ball_direction(&field, p), 0.5 * step);
            p = vec3_mad(p, ball_direction(&field, middle), step);
            double length = sqrt(vec3_dot(p, p));
            if (length > 1.0)
                p = vec3_scale(p, 1.0 / length);
        }
        scene_end_line(builder);
    }
}
