/* Pathlines through an aortic arch with a dilated ascending part, in an invented velocity field.
 *
 * The field lives in the vessel's own coordinates: s along the centreline (mm) and (a, b), the
 * place in the cross-section divided by the local radius, a pointing to the outer side of the
 * arch. It is a sum of terms that keep the measure R(s)^2 ds da db, so that lines which start
 * evenly stay even, and that vanish or run along the wall, so that they never leave the vessel. */
#include "scene_build.h"

#include <stddef.h>
#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979324

enum { TUBE_SAMPLES = 1025, BEAT_STEPS = 200, CONTROL_MAX = 20 };
static const double beat = 833.0; /* ms */

/* ---- the vessel ------------------------------------------------------------------------- */

/* A vessel to be made: control points of its centreline (a uniform cubic B-spline, from the second
 * to the last but one), radius as knots over the fraction of its length, and its flow. */
typedef struct vessel_plan {
    int controls, knots;
    double control[CONTROL_MAX][3]; /* in the plane of the arch: forward, sideways, up */
    double radius[12][2];           /* fraction of the length, mm */
    double speed;                   /* mean speed at radius 12.5 mm in systole, m/s */
    double vortex[3];               /* strength; centre and half length along s, mm */
    double swirl[3];                /* turn per mm; centre and half length along s, mm */
} vessel_plan;

typedef struct lumen {
    double length, step;
    vec3 centre[TUBE_SAMPLES], outer[TUBE_SAMPLES], side[TUBE_SAMPLES];
    double radius[TUBE_SAMPLES], volume[TUBE_SAMPLES]; /* volume: from the inlet, normalised */
    const vessel_plan *vessel;
} lumen;

static const vessel_plan aorta = {
    16,
    11,
    {{7, 1, -16},
     {3, 0, 0},
     {-3, -1, 16},
     {-8, -1, 32},
     {-10, 0, 48},
     {-5, 1, 65},
     {7, 2, 80},
     {24, 1, 89},
     {42, -1, 88},
     {56, -3, 76},
     {62, -4, 58},
     {63, -4, 38},
     {62, -3, 18},
     {62, -2, -2},
     {63, -1, -22},
     {65, 0, -42}},
    {{0.0, 13.0},
     {0.05, 13.6},
     {0.1, 16.0},
     {0.15, 20.2},
     {0.2, 21.8},
     {0.25, 19.5},
     {0.31, 15.0},
     {0.4, 12.4},
     {0.6, 10.8},
     {0.8, 9.7},
     {1.0, 9.0}},
    0.62,
    {0.62, 46.0, 15.0},
    {0.075, 118.0, 34.0},
};

/* The branches to head and arms leave the roof of the arch; their first part lies inside it. */
static const vessel_plan branches[3] = {
    {8,
     4,
     {{-4, 1, 60},
      {2, 1, 72},
      {8, 0, 82},
      {11, -2, 94},
      {9, -6, 108},
      {4, -11, 122},
      {-1, -15, 137},
      {-5, -17, 152}},
     {{0.0, 7.5}, {0.25, 7.0}, {0.45, 5.6}, {1.0, 4.8}},
     0.10,
     {0, 0, 1},
     {0.05, 30, 30}},
    {8,
     4,
     {{8, 1, 76},
      {15, 1, 83},
      {22, 1, 90},
      {26, 0, 101},
      {26, -1, 115},
      {24, -2, 129},
      {22, -3, 143},
      {21, -4, 157}},
     {{0.0, 5.5}, {0.25, 4.8}, {0.45, 3.6}, {1.0, 3.2}},
     0.045,
     {0, 0, 1},
     {-0.05, 30, 30}},
    {8,
     4,
     {{20, 0, 83},
      {29, 0, 87},
      {37, 0, 92},
      {41, 1, 103},
      {43, 4, 117},
      {46, 9, 130},
      {52, 15, 141},
      {60, 21, 149}},
     {{0.0, 6.0}, {0.25, 5.5}, {0.45, 4.3}, {1.0, 3.8}},
     0.06,
     {0, 0, 1},
     {0.05, 30, 30}},
};

/* From the plane of the arch to the patient: forward goes from the right front to the left back. */
static vec3 arch_to_patient(const double p[3]) {
    double forward = p[0] - 28.0, across = p[1];
    return vec3_make(-0.74 * forward - 0.67 * across, -0.67 * forward + 0.74 * across, p[2] - 30.0);
}

static vec3 spline_point(const vessel_plan *vessel, double t) {
    int spans = vessel->controls - 3, i = (int)(t * spans);
    if (i >= spans)
        i = spans - 1;
    double f = t * spans - i, g = 1.0 - f;
    const double weights[4] = {g * g * g / 6.0, (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0,
                               (3.0 * g * g * g - 6.0 * g * g + 4.0) / 6.0, f * f * f / 6.0};
    vec3 sum = {0.0, 0.0, 0.0};
    for (int k = 0; k < 4; k++) {
        sum = vec3_mad(sum, arch_to_patient(vessel->control[i + k]), weights[k]);
    }
    return sum;
}

/* Radius at a fraction of the length: cubic between the knots, with their mean slopes. */
static double knot_radius(const vessel_plan *vessel, double x) {
    const double(*knot)[2] = vessel->radius;
    int last = vessel->knots - 1, i = 0;
    while (i < last - 1 && x > knot[i + 1][0])
        i++;
    int before = i > 0 ? i - 1 : 0, after = i + 2 < last ? i + 2 : last;
    double width = knot[i + 1][0] - knot[i][0], f = (x - knot[i][0]) / width;
    double m0 = (knot[i + 1][1] - knot[before][1]) / (knot[i + 1][0] - knot[before][0]) * width;
    double m1 = (knot[after][1] - knot[i][1]) / (knot[after][0] - knot[i][0]) * width;
    double f2 = f * f, f3 = f2 * f;
    return (2.0 * f3 - 3.0 * f2 + 1.0) * knot[i][1] + (f3 - 2.0 * f2 + f) * m0 +
           (3.0 * f2 - 2.0 * f3) * knot[i + 1][1] + (f3 - f2) * m1;
}

/* Samples the spline evenly by length and carries a frame along without twist. */
static void make_tube(lumen *tube, const vessel_plan *vessel) {
    enum { FINE = 4 * TUBE_SAMPLES };
    tube->vessel = vessel;
    tube->length = 0.0;
    vec3 last = spline_point(vessel, 0.0);
    for (int i = 1; i <= FINE; i++) {
        vec3 p = spline_point(vessel, (double)i / FINE), d = vec3_sub(p, last);
        tube->length += sqrt(vec3_dot(d, d));
        last = p;
    }
    tube->step = tube->length / (TUBE_SAMPLES - 1);
    tube->centre[0] = last = spline_point(vessel, 0.0);
    double walked = 0.0;
    for (int i = 1, k = 1; i <= FINE && k < TUBE_SAMPLES; i++) {
        vec3 p = spline_point(vessel, (double)i / FINE), d = vec3_sub(p, last);
        double piece = sqrt(vec3_dot(d, d));
        for (; k < TUBE_SAMPLES && walked + piece >= k * tube->step - 1e-9; k++) {
            tube->centre[k] = vec3_mad(last, d, (k * tube->step - walked) / piece);
        }
        walked += piece;
        last = p;
    }
    tube->centre[TUBE_SAMPLES - 1] = spline_point(vessel, 1.0);

    const double backward[3] = {27.0, 0.0, 30.0}; /* arch_to_patient turns this to (-1, 0, 0) */
    vec3 outer = arch_to_patient(backward);
    for (int k = 0; k < TUBE_SAMPLES; k++) {
        int i = k > 0 ? k - 1 : 0, j = k < TUBE_SAMPLES - 1 ? k + 1 : k;
        vec3 along = vec3_unit(vec3_sub(tube->centre[j], tube->centre[i]));
        outer = vec3_unit(vec3_mad(outer, along, -vec3_dot(outer, along)));
        tube->outer[k] = outer;
        tube->side[k] = vec3_cross(along, outer);
        tube->radius[k] = knot_radius(vessel, (double)k / (TUBE_SAMPLES - 1));
        double area = tube->radius[k] * tube->radius[k];
        tube->volume[k] = k ? tube->volume[k - 1] + area : 0.0;
    }
    for (int k = 0; k < TUBE_SAMPLES; k++) {
        tube->volume[k] /= tube->volume[TUBE_SAMPLES - 1];
    }
}

/* Splits s into a sample and the way to the next. */
static int tube_index(const lumen *tube, double s, double *f) {
    double x = s / tube->step;
    int i = x <= 0.0 ? 0 : x >= TUBE_SAMPLES - 2 ? TUBE_SAMPLES - 2 : (int)x;
    *f = x - i;
    return i;
}

static double tube_radius(const lumen *tube, double s) {
    double f;
    int i = tube_index(tube, s, &f);
    return tube->radius[i] + f * (tube->radius[i + 1] - tube->radius[i]);
}

static vec3 mix3(vec3 a, vec3 b, double f) {
    return vec3_mad(a, vec3_sub(b, a), f);
}

static vec3 tube_point(const lumen *tube, vec3 q) {
    double f, radius = tube_radius(tube, q.x);
    int i = tube_index(tube, q.x, &f);
    vec3 p = mix3(tube->centre[i], tube->centre[i + 1], f);
    p = vec3_mad(p, mix3(tube->outer[i], tube->outer[i + 1], f), radius * q.y);
    return vec3_mad(p, mix3(tube->side[i], tube->side[i + 1], f), radius * q.z);
}

/* The s before which a fraction x of the vessel's volume lies. */
static double tube_at_volume(const lumen *tube, double x) {
    int low = 0, high = TUBE_SAMPLES - 1;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (tube->volume[middle] <= x) {
            low = middle;
        } else {
            high = middle;
        }
    }
    double width = tube->volume[high] - tube->volume[low];
    return tube->step * (low + (x - tube->volume[low]) / width);
}

/* ---- the flow --------------------------------------------------------------------------- */

/* Speed factors of a moment: forward flow (systole, then a slow run-off), the vortex, which grows
 * late in systole and outlives it, and a phase that lets small disturbances drift. */
typedef struct pulse {
    double flow, vortex, drift;
} pulse;

static pulse pulse_at(double time) {
    double t = time / beat;
    double rise = t < 0.42 ? sin(PI * t / 0.42) : 0.0;
    double late = exp(-(t - 0.38) * (t - 0.38) / 0.06);
    pulse now = {0.16 + 0.84 * rise * rise, 0.3 + 0.7 * late, 2.0 * PI * t};
    return now;
}

/* d(s, a, b)/dt at q, per ms; zero outside of the wall. */
static vec3 velocity(const lumen *tube, const pulse *now, vec3 q) {
    const vessel_plan *vessel = tube->vessel;
    double s = q.x, a = q.y, b = q.z, core = 1.0 - a * a - b * b;
    vec3 rate = {0.0, 0.0, 0.0};
    if (core <= 0.0)
        return rate;
    double radius = tube_radius(tube, s), widening = 12.5 * 12.5 / (radius * radius);

    /* laminar: a parabola over the cross-section, its flux the same along the vessel */
    double forward = 2.0 * vessel->speed * now->flow * widening * core;
    rate.x = forward;

    /* swirl: turns with the flow, so that its pitch does not depend on the pulse */
    double from = (s - vessel->swirl[1]) / vessel->swirl[2];
    double turn = vessel->swirl[0] * exp(-from * from) * (forward + 0.05 * core);
    rate.y = -turn * b;
    rate.z = turn * a;

    /* vortex: stream function strength * exp(-x^2) * core in the plane of s and a, so that it
     * sweeps along the outer wall against the flow and lies open to the side */
    double x = (s - vessel->vortex[1]) / vessel->vortex[2];
    if (vessel->vortex[0] != 0.0 && fabs(x) < 4.0) {
        double psi = vessel->vortex[0] * now->vortex * widening * exp(-x * x);
        rate.x -= 2.0 * a * psi;
        rate.y += 2.0 * x / vessel->vortex[2] * core * psi;
    }

    /* disturbances: stream functions amount * core^2 * sin(...) in the planes (s, a) and (s, b) */
    double amount = 0.05 * vessel->speed * (0.4 + 0.6 * now->vortex) * widening * core;
    double first = 0.11 * s + 2.1 * b - now->drift, second = 0.083 * s - 1.7 * a + now->drift + 1.0;
    rate.x += -4.0 * amount * (a * sin(first) + b * sin(second));
    rate.y += -0.11 * amount * core * cos(first);
    rate.z += -0.083 * amount * core * cos(second);
    return rate;
}

static vec3 rk4_step(const lumen *tube, const pulse pulses[2 * BEAT_STEPS + 1], int k, int way,
                     vec3 q) {
    double h = way * beat / BEAT_STEPS;
    const pulse *from = pulses + 2 * (ptrdiff_t)k, *middle = from + way;
    const pulse *to = from + 2 * (ptrdiff_t)way;
    vec3 k1 = velocity(tube, from, q), k2 = velocity(tube, middle, vec3_mad(q, k1, 0.5 * h));
    vec3 k3 = velocity(tube, middle, vec3_mad(q, k2, 0.5 * h));
    vec3 k4 = velocity(tube, to, vec3_mad(q, k3, h));
    vec3 sum = vec3_add(vec3_add(k1, k4), vec3_scale(vec3_add(k2, k3), 2.0));
    return vec3_mad(q, sum, h / 6.0);
}

static bool inside(const lumen *tube, vec3 q) {
    return q.x >= 0.0 && q.x <= tube->length && q.y * q.y + q.z * q.z < 0.999;
}

/* One pathline through the whole beat: forward and backward from a seed at step `k`. */
static void add_pathline(scene_builder *builder, const lumen *tube,
                         const pulse pulses[2 * BEAT_STEPS + 1], vec3 seed, int k) {
    vec3 way[BEAT_STEPS + 1], place[BEAT_STEPS + 1];
    int first = k, last = k;
    way[k] = seed;
    for (; last < BEAT_STEPS; last++) {
        way[last + 1] = rk4_step(tube, pulses, last, 1, way[last]);
        if (!inside(tube, way[last + 1]))
            break;
    }
    for (; first > 0; first--) {
        way[first - 1] = rk4_step(tube, pulses, first, -1, way[first]);
        if (!inside(tube, way[first - 1]))
            break;
    }
    for (int i = first; i <= last; i++)
        place[i] = tube_point(tube, way[i]);
    for (int i = first; i <= last; i++) {
        int before = i > first ? i - 1 : i, after = i < last ? i + 1 : i;
        vec3 d = vec3_sub(place[after], place[before]);
        double time = (after - before) * beat / BEAT_STEPS;
        double speed = time > 0.0 ? sqrt(vec3_dot(d, d)) / time : 0.0;
        scene_point(builder, place[i], i * beat / BEAT_STEPS, speed);
    }
    scene_end_line(builder);
}

/* Seeds that fill the vessel evenly: a low-discrepancy sequence over volume, ring and angle. */
static void add_vessel(scene_builder *builder, lumen *tube, const vessel_plan *vessel,
                       const pulse pulses[2 * BEAT_STEPS + 1], uint32_t id, uint32_t count) {
    make_tube(tube, vessel);
    uint32_t seed = builder->seed * 131u + 70 + id;
    double shift[3];
    for (uint32_t d = 0; d < 3; d++)
        shift[d] = scene_random(seed, 0, d);
    for (uint32_t i = 0; i < count && !builder->failed; i++) {
        double x[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
        for (int d = 0; d < 3; d++)
            x[d] = fmod(x[d] * (i + 1.0) + shift[d], 1.0);
        double radius = 0.97 * sqrt(x[1]), angle = 2.0 * PI * x[2];
        vec3 q = vec3_make(tube_at_volume(tube, x[0]), radius * cos(angle), radius * sin(angle));
        int k = (int)(BEAT_STEPS * scene_random(seed, i + 1, 5));
        add_pathline(builder, tube, pulses, q, k);
    }
}

void scene_build_aorta(scene_builder *builder, uint32_t count) {
    pulse pulses[2 * BEAT_STEPS + 1];
    for (int k = 0; k <= 2 * BEAT_STEPS; k++)
        pulses[k] = pulse_at(0.5 * k * beat / BEAT_STEPS);
    lumen *tube = malloc(sizeof *tube);
    if (!tube) {
        builder->failed = true;
        return;
    }
    const uint32_t thousandths[3] = {45, 20, 25};
    uint32_t rest = count;
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t part = (uint32_t)((uint64_t)count * thousandths[i] / 1000);
        add_vessel(builder, tube, &branches[i], pulses, i + 1, part);
        rest -= part;
    }
    add_vessel(builder, tube, &aorta, pulses, 0, rest);
    free(tube);
}
