/* The flow is made in coordinates (s, a, b) of the vessel: s along the centreline (mm), and the
 * place in the cross-section divided by the radius R(s), a away from the centre of the arch, b
 * sideways; the bulge is wider on the outer side, because there the cross-sections are shifted. In
 * these coordinates the vessel is a straight cylinder a^2 + b^2 < 1, and a field of fluxes F is
 * free of divergence when dFs/ds + dFa/da + dFb/db = 0. The velocity is then
 *     v = (Fs ds + Fa da + Fb db) / J,   ds = dx/ds, ...,   J = det(ds, da, db),
 * and it is free of divergence in space. With q = 1 - a^2 - b^2, three such F are summed:
 *     stream  the profile 2 q, which is the narrow jet 4 q^3 at the inlet
 *     vortex  Fs = d(chi)/da, Fa = -d(chi)/ds,  chi = strength(t) window(s) q^2
 *     helix   Fa = d(psi)/db, Fb = -d(psi)/da,  psi = strength(t) window(s) q^2
 * All have a factor q, so the velocity is zero on the wall. The centreline is a straight line, half
 * a circle and a straight line; where they meet the curvature jumps, but F is Fs alone there and R
 * has no slope, so that the velocity stays smooth. Shears, which keep volumes, and a rotation bring
 * the vessel into the patient. */
#include "flow_phantom.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double beat = 833.0;       /* ms */
static const double arch_radius = 34.0; /* mm, of the centreline */
static const double ascending = 92.0, descending = 112.0;
static const double tilt = -0.16; /* sideways by forward */
static const double pi = 3.14159265358979324;
/* The patient's directions of the arch's plane and of its normal: right front to left back. */
static const double forward[2] = {-0.6, -0.8}, sideways[2] = {0.8, -0.6};

/* ---- shapes in space and time ------------------------------------------------------------- */

/* A value and its slope. */
typedef struct graph {
    double value, slope;
} graph;

/* (1 - u^2)^4 for u = (s - middle) / half in [-1, 1], else 0. */
static graph window(double s, double middle, double half) {
    graph g = {0.0, 0.0};
    double u = (s - middle) / half, w = 1.0 - u * u;
    if (w > 0.0) {
        g.value = w * w * w * w;
        g.slope = -8.0 * u * w * w * w / half;
    }
    return g;
}

/* From 0 before `from` to 1 behind `to`; slope and bend are 0 at both. */
static graph ramp(double s, double from, double to) {
    graph g = {0.0, 0.0};
    double u = (s - from) / (to - from);
    u = u < 0.0 ? 0.0 : u > 1.0 ? 1.0 : u;
    g.value = u * u * u * (u * (6.0 * u - 15.0) + 10.0);
    g.slope = 30.0 * u * u * (1.0 - u) * (1.0 - u) / (to - from);
    return g;
}

/* 2 u / (1 + u^2): a bend one way and back, within -1..1. */
static graph bend(double z, double middle, double half) {
    double u = (z - middle) / half, d = 1.0 / (1.0 + u * u);
    graph g = {2.0 * u * d, 2.0 * (1.0 - u * u) * d * d / half};
    return g;
}

/* A wave of the heart beat: `rest`, and `more` where the beat's phase (cosine and sine of the time
 * as an angle) is that of `peak`, ms; the greater `sharpness`, the shorter. */
static double pulse(const double phase[2], double peak, int sharpness, double rest, double more) {
    double angle = 2.0 * pi / beat * peak, wave = 1.0;
    double near = 0.5 + 0.5 * (phase[0] * cos(angle) + phase[1] * sin(angle));
    for (int i = 0; i < sharpness; i++)
        wave *= near;
    return rest + more * wave;
}

static graph vessel_radius(double s) {
    graph bulge = window(s, 47.0, 45.0), r = {12.5, 0.0};
    graph taper = ramp(s, ascending, ascending + pi * arch_radius);
    r.value += 9.0 * bulge.value - 3.3 * taper.value;
    r.slope = 9.0 * bulge.slope - 3.3 * taper.slope;
    return r;
}

/* How far the cross-sections lie outward of the centreline. */
static graph vessel_shift(double s) {
    graph shift = window(s, 47.0, 45.0);
    shift.value *= 5.0;
    shift.slope *= 5.0;
    return shift;
}

/* ---- the vessel's coordinates ------------------------------------------------------------- */

typedef struct place {
    double s, a, b;
    double along[2], out[2]; /* in the arch's plane: directions of the centreline and of a */
    double stretch;          /* length of a line at constant a over that of the centreline */
    graph radius, shift;
    graph sway, lean; /* shears by up: both limbs sway forward, the arch leans sideways */
} place;

static place find_place(const double p[3]) {
    place at;
    double z = p[2], x = forward[0] * p[0] + forward[1] * p[1], y, off;
    at.sway = bend(z, -30.0, 32.0);
    at.lean = bend(z, -50.0, 70.0);
    y = sideways[0] * p[0] + sideways[1] * p[1] - 9.0 * at.lean.value - tilt * x;
    x += 4.5 * at.sway.value;
    at.stretch = 1.0;
    if (z > 0.0) {
        double r = sqrt(x * x + z * z);
        at.s = ascending + arch_radius * atan2(z, -x);
        at.out[0] = x / r;
        at.out[1] = z / r;
        off = r - arch_radius;
        at.stretch = r / arch_radius;
    } else {
        at.s = x < 0.0 ? ascending + z : ascending + pi * arch_radius - z;
        at.out[0] = x < 0.0 ? -1.0 : 1.0;
        at.out[1] = 0.0;
        off = fabs(x) - arch_radius;
    }
    at.along[0] = at.out[1];
    at.along[1] = -at.out[0];
    at.radius = vessel_radius(at.s);
    at.shift = vessel_shift(at.s);
    at.a = (off - at.shift.value) / at.radius.value;
    at.b = y / at.radius.value;
    return at;
}

/* ---- the flow ----------------------------------------------------------------------------- */

/* Adds the vortex and the helices, each where its window is open. */
static void add_turns(const place *at, const double phase[2], double q, double f[3]) {
    const double middle = ascending + 0.5 * pi * arch_radius, half = 0.5 * pi * arch_radius;
    graph eddy = window(at->s, 50.0, 40.0), arch = window(at->s, middle, half);
    if (eddy.value > 0.0) {
        double vortex = pulse(phase, 280.0, 2, 12.0, 115.0);
        f[0] -= 4.0 * vortex * eddy.value * at->a * q;
        f[1] -= vortex * eddy.slope * q * q;
    }
    if (eddy.value > 0.0 || arch.value > 0.0) {
        double helix = 4.0 * q *
                       (arch.value * pulse(phase, 220.0, 3, 0.5, 3.6) -
                        eddy.value * pulse(phase, 330.0, 2, 0.5, 5.0));
        f[1] -= helix * at->b;
        f[2] += helix * at->a;
    }
}

static void fluxes(const place *at, double time, double f[3]) {
    double q = 1.0 - at->a * at->a - at->b * at->b;
    double phase[2] = {cos(2.0 * pi / beat * time), sin(2.0 * pi / beat * time)};
    double stream = pulse(phase, 150.0, 6, 7.0, 88.0); /* mm^3/ms over pi: speed times R^2 */
    graph jet = ramp(at->s, 0.0, 55.0);
    /* fluid moves outward as the jet widens, by the flux within r of 4 q^3 less that of 2 q */
    double spread = 0.5 * q * q * (1.0 + q) * jet.slope;
    f[0] = stream * (2.0 * q * jet.value + 4.0 * q * q * q * (1.0 - jet.value));
    f[1] = stream * spread * at->a;
    f[2] = stream * spread * at->b;
    add_turns(at, phase, q, f);
}

static void velocity_at(void *user, const double position[3], double time, double velocity[3]) {
    place at = find_place(position);
    double f[3], r = at.radius.value, inverse = 1.0 / (r * r * at.stretch), x, y, z, out;
    (void)user;
    velocity[0] = velocity[1] = velocity[2] = 0.0;
    if (!(at.a * at.a + at.b * at.b < 1.0))
        return;
    fluxes(&at, time, f);
    out = (f[0] * (at.radius.slope * at.a + at.shift.slope) + f[1] * r) * inverse;
    x = f[0] / (r * r) * at.along[0] + out * at.out[0];
    z = f[0] / (r * r) * at.along[1] + out * at.out[1];
    y = (f[0] * at.radius.slope * at.b + f[2] * r) * inverse;
    x -= 4.5 * at.sway.slope * z;
    y += tilt * x + 9.0 * at.lean.slope * z;
    velocity[0] = forward[0] * x + sideways[0] * y;
    velocity[1] = forward[1] * x + sideways[1] * y;
    velocity[2] = z;
}

static int inside_at(void *user, const double position[3]) {
    place at = find_place(position);
    (void)user;
    return at.s >= 0.0 && at.s <= ascending + pi * arch_radius + descending &&
           at.a * at.a + at.b * at.b < 1.0;
}

double flow_phantom_wall(const double position[3]) {
    place at = find_place(position);
    return (sqrt(at.a * at.a + at.b * at.b) - 1.0) * at.radius.value;
}

/* ---- fields ------------------------------------------------------------------------------- */

/* A lattice of these voxels around the vessel, one voxel wider on each side. */
static void lattice(const double spacing[3], flow4d_field *field) {
    static const double low[3] = {-45, -38, -112}, high[3] = {54, 45, 46};
    for (size_t a = 0; a < 3; a++) {
        field->size[a] = (uint32_t)ceil((high[a] - low[a]) / spacing[a]) + 2;
        field->to_world[5 * a] = spacing[a];
        field->to_world[4 * a + 3] = low[a] - 0.5 * spacing[a];
    }
    field->period = beat;
    field->frame_count = 21;
}

static const double usual_spacing[3] = {2.0, 2.0, 3.0};

void flow_phantom_field(flow4d_field *field) {
    memset(field, 0, sizeof *field);
    lattice(usual_spacing, field);
    field->velocity_at = velocity_at;
    field->inside_at = inside_at;
}

bool flow_phantom_grid(const double spacing[3], uint32_t frame_count, flow4d_field *grid) {
    flow4d_field source, target;
    flow_phantom_field(&source);
    memset(&target, 0, sizeof target);
    spacing = spacing ? spacing : usual_spacing;
    for (int a = 0; a < 3; a++) {
        if (!(spacing[a] >= 0.05 && spacing[a] <= 1000.0))
            return false;
    }
    lattice(spacing, &target);
    target.frame_count = frame_count ? frame_count : target.frame_count;
    size_t voxels = (size_t)target.size[0] * target.size[1] * target.size[2];
    float *velocity = calloc(voxels, 3 * sizeof(float) * target.frame_count);
    uint8_t *mask = calloc(voxels, 1);
    if (!velocity || !mask || flow4d_resample(NULL, &source, &target, velocity, mask) != LAO_OK) {
        free(velocity);
        free(mask);
        return false;
    }
    target.velocity = velocity;
    target.mask = mask;
    *grid = target;
    return true;
}

void flow_phantom_grid_free(flow4d_field *grid) {
    free((void *)(uintptr_t)grid->velocity);
    free((void *)(uintptr_t)grid->mask);
    memset(grid, 0, sizeof *grid);
}
