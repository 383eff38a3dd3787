/* The flow is a sum of three fields, each free of divergence and zero on the wall.
 *
 * Two streams, one for each branch: from the parent's inlet through that branch, in a wall of their
 * own that is part of the whole. With the centreline's distance r, the wall's d, the angle a about
 * the centreline (against a frame that does not turn) and q = (r / (r + d))^2, which is 0 on the
 * centreline and 1 on the wall,
 *     v = flux grad(q - q^2 / 2) x grad(a)
 * is the curl of (q - q^2 / 2) grad(a): free of divergence, and along the surfaces of constant q.
 * In a straight tube it is Poiseuille's parabola; in the sac, which is part of both walls, the
 * stream follows the dome.
 *
 * Two vortices: one turns in the sac as the stream drives it, one in its neck about the stream,
 * which takes blood up into the sac on one side and down on the other: v = curl(f axis) = grad(f) x
 * axis,   f = strength g(depth below the wall) window, where g rises from slope 0 on the wall to
 * slope 0 in the middle of the sac. */
#include "flow_aneurysm.h"
#include "scene_shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979324;
static const double beat = 833.0; /* ms */

/* ---- shape -------------------------------------------------------------------------------- */

enum { PARENT = 48, BRANCH = 18, PATH = PARENT + BRANCH, BRANCHES = 2 };

/* Ends and radii of the branches. */
static const double branches[BRANCHES][5] = {{9, 7, -13, 1.8, 1.3}, {14, -6, 1, 1.8, 1.4}};
static const double sac[2][3] = {{-4.5, 2, 11}, {5.6, 5, 5.2}}; /* centre and radii */
static const double bleb[4] = {-8.6, 0, 14.6, 1.9};
static const double branch_blend = 1.2, sac_blend = 2.4, bleb_blend = 1.3;

static vec3 of(const double v[3]) {
    return vec3_make(v[0], v[1], v[2]);
}

/* The parent, a bend out of the plane; t in [0, 1]. */
static vec3 parent_at(double t) {
    double a = 3.4 * t - 0.5;
    return vec3_make(-9 * cos(a) - 5, 3.0 * sin(2.2 * t), 9 * sin(a) - 11.5 * (1 - t));
}
static double parent_radius(double t) {
    return 2.1 - 0.25 * t;
}

double flow_aneurysm_wall(const double position[3]) {
    vec3 p = of(position), last = parent_at(0);
    double wall = 1e9;
    for (int i = 1; i <= PARENT; i++) {
        double t = i / (double)PARENT, before = t - 1 / (double)PARENT;
        vec3 next = parent_at(t);
        double piece = shape_tube(p, last, next, parent_radius(before), parent_radius(t));
        wall = piece < wall ? piece : wall;
        last = next;
    }
    for (int i = 0; i < BRANCHES; i++) {
        const double *b = branches[i];
        wall = shape_join(wall, shape_tube(p, last, of(b), b[3], b[4]), branch_blend);
    }
    wall = shape_join(wall, shape_ellipsoid(p, of(sac[0]), of(sac[1])), sac_blend);
    return shape_join(wall, shape_ball(p, of(bleb), bleb[3]), bleb_blend);
}

/* ---- centrelines -------------------------------------------------------------------------- */

/* From the inlet through a branch, its corner rounded, and per voxel the nearest of its points. */
typedef struct path {
    vec3 points[PATH + 1], along[PATH + 1];
    double radii[PATH + 1];
    double least[3]; /* mm, of the voxels */
    uint32_t size[3];
    uint8_t *nearest;
} path;

typedef struct flow {
    path paths[BRANCHES];
} flow;

static double distance2(vec3 a, vec3 b) {
    vec3 d = vec3_sub(a, b);
    return vec3_dot(d, d);
}

static void path_shape(path *way, const double branch[5]) {
    vec3 from = parent_at(1);
    for (int i = 0; i <= PATH; i++) {
        double t = i / (double)PARENT, u = (i - PARENT) / (double)BRANCH;
        bool parent = i <= PARENT;
        way->points[i] = parent ? parent_at(t) : vec3_mad(from, vec3_sub(of(branch), from), u);
        way->radii[i] = parent ? parent_radius(t) : branch[3] + u * (branch[4] - branch[3]);
    }
    for (int round = 0; round < 8; round++) { /* the corner */
        vec3 before = way->points[PARENT - 7];
        for (int i = PARENT - 6; i <= PARENT + 6; i++) {
            vec3 here = way->points[i];
            way->points[i] = vec3_scale(
                vec3_add(vec3_add(before, way->points[i + 1]), vec3_scale(here, 2)), 0.25);
            before = here;
        }
    }
    for (int i = 0; i <= PATH; i++)
        way->along[i] =
            vec3_unit(vec3_sub(way->points[i < PATH ? i + 1 : i], way->points[i > 0 ? i - 1 : 0]));
}

/* Each voxel's nearest point: where a search begins. */
static void path_index(path *way) {
    uint8_t *out = way->nearest;
    for (uint32_t z = 0; z < way->size[2]; z++) {
        for (uint32_t y = 0; y < way->size[1]; y++) {
            for (uint32_t x = 0; x < way->size[0]; x++, out++) {
                vec3 p = vec3_make(way->least[0] + x, way->least[1] + y, way->least[2] + z);
                *out = 0;
                for (int i = 1; i <= PATH; i++) {
                    if (distance2(p, way->points[i]) < distance2(p, way->points[*out]))
                        *out = (uint8_t)i;
                }
            }
        }
    }
}

/* Where a place is beside a centreline. */
typedef struct beside {
    vec3 along, out; /* unit: of the centreline, and from it to the place, across it */
    double distance, radius;
    bool behind; /* an end of it */
    bool shared; /* on the way to the branches: the same for both */
} beside;

/* The place on segment i nearest to p, as a fraction of it. */
static double on_segment(const path *way, int i, vec3 p) {
    vec3 d = vec3_sub(way->points[i + 1], way->points[i]);
    double u = vec3_dot(d, vec3_sub(p, way->points[i])) / vec3_dot(d, d);
    return u < 0 ? 0 : u > 1 ? 1 : u;
}

static int nearest_point(const path *way, vec3 p) {
    const double at[3] = {p.x, p.y, p.z};
    size_t voxel = 0;
    for (int k = 2; k >= 0; k--) {
        double cell = floor(at[k] - way->least[k] + 0.5), most = way->size[k] - 1.0;
        cell = cell > 0 ? cell < most ? cell : most : 0; /* no number: 0 */
        voxel = voxel * way->size[k] + (size_t)cell;
    }
    int i = way->nearest[voxel];
    while (i < PATH && distance2(p, way->points[i + 1]) < distance2(p, way->points[i]))
        i++;
    while (i > 0 && distance2(p, way->points[i - 1]) < distance2(p, way->points[i]))
        i--;
    return i;
}

static beside find_beside(const path *way, vec3 p) {
    int i = nearest_point(way, p), best = i < PATH ? i : PATH - 1;
    double least = 1e30, u = 0;
    beside b;
    for (int s = i > 0 ? i - 1 : 0; s <= i && s < PATH; s++) {
        double v = on_segment(way, s, p);
        vec3 d = vec3_sub(way->points[s + 1], way->points[s]);
        double d2 = distance2(p, vec3_mad(way->points[s], d, v));
        if (d2 < least) {
            least = d2;
            best = s;
            u = v;
        }
    }
    vec3 from = vec3_mad(way->points[best], vec3_sub(way->points[best + 1], way->points[best]), u);
    b.along =
        vec3_unit(vec3_mad(way->along[best], vec3_sub(way->along[best + 1], way->along[best]), u));
    vec3 off = vec3_sub(p, from);
    b.out = vec3_unit(vec3_mad(off, b.along, -vec3_dot(off, b.along)));
    b.distance = sqrt(least);
    b.radius = way->radii[best] + u * (way->radii[best + 1] - way->radii[best]);
    b.shared = best < PARENT - 10;
    b.behind = (best == 0 && u <= 0) || (best == PATH - 1 && u >= 1);
    return b;
}

/* ---- a stream ----------------------------------------------------------------------------- */

/* A distance and how it rises. */
typedef struct rising {
    double value;
    vec3 slope;
} rising;

static rising rising_join(rising a, rising b, double k) {
    double h = k - fabs(a.value - b.value), t = h > 0 ? h / (2 * k) : 0;
    bool first = a.value < b.value;
    rising r = {shape_join(a.value, b.value, k), {0, 0, 0}};
    r.slope =
        vec3_add(vec3_scale(a.slope, first ? 1 - t : t), vec3_scale(b.slope, first ? t : 1 - t));
    return r;
}

/* shape_ellipsoid, k (k - 1) / l with k = |d / radii| and l = |d / radii^2|. */
static rising rising_sac(vec3 p) {
    vec3 d = vec3_sub(p, of(sac[0])), r = of(sac[1]);
    vec3 one = vec3_make(d.x / (r.x * r.x), d.y / (r.y * r.y), d.z / (r.z * r.z));
    vec3 two = vec3_make(one.x / (r.x * r.x), one.y / (r.y * r.y), one.z / (r.z * r.z));
    double k = sqrt(vec3_dot(d, one)), l = sqrt(vec3_dot(one, one));
    rising s = {1e9, {0, 0, 0}};
    if (k > 2) /* too far to blend with anything inside */
        return s;
    s.value = l > 1e-9 ? k * (k - 1) / l : -r.x;
    if (!(l > 1e-9))
        return s;
    s.slope = vec3_scale(one, (2 - 1 / k) / l);
    s.slope = vec3_mad(s.slope, two, -s.value / (l * l));
    return s;
}

static rising rising_ball(vec3 p) {
    vec3 off = vec3_sub(p, of(bleb));
    rising b = {shape_ball(p, of(bleb), bleb[3]), vec3_unit(off)};
    return b;
}

/* The sac with its bleb, of which each stream's wall is a part. */
static rising rising_dome(vec3 p) {
    rising dome = rising_sac(p);
    return dome.value < 1e8 ? rising_join(dome, rising_ball(p), bleb_blend) : dome;
}

static rising stream_wall(const beside *b, const rising *dome) {
    rising tube = {b->distance - b->radius, b->out};
    return rising_join(tube, *dome, sac_blend);
}

/* Of a flux of 1 mm^3/ms over pi / 2. */
static vec3 stream_at(const beside *b, const rising *wall) {
    if (!(wall->value < 0) || b->behind)
        return vec3_make(0, 0, 0);
    double sum = b->distance - wall->value, q = b->distance / sum;
    double size = 2 * (1 - q * q) / (sum * sum * sum);
    vec3 turn = vec3_cross(wall->slope, vec3_cross(b->along, b->out));
    return vec3_scale(vec3_mad(vec3_scale(b->along, -wall->value), turn, b->distance), size);
}

/* ---- the flow ----------------------------------------------------------------------------- */

/* A wave of the heart beat: from `rest` to `most`, which it is at `peak` ms. */
static double pulse(double time, double peak, double rest, double most) {
    double near = 0.5 + 0.5 * cos(2 * pi / beat * (time - peak));
    return rest + (most - rest) * near * near * near;
}

typedef struct vortex {
    vec3 axis, middle;
    double reach;            /* mm, of its window */
    double peak, rest, most; /* ms; mm^2/ms */
} vortex;
static const vortex vortices[2] = {
    {{0.28, -0.96, 0}, {-4.8, 2.2, 10}, 8, 230, 0.3, 0.7},
    {{0.96, 0.28, 0}, {-4.9, 2.6, 7}, 6.5, 200, 0.5, 1.4},
};

static vec3 vortex_at(const vortex *one, vec3 p, const rising *wall) {
    vec3 d = vec3_scale(vec3_sub(p, one->middle), 1 / one->reach);
    double e = vec3_dot(d, d), u = -wall->value / 5.2, rise;
    if (!(u > 0) || !(e < 1))
        return vec3_make(0, 0, 0);
    u = u < 1 ? u : 1;
    rise = -6 * u * (1 - u) / 5.2;
    vec3 slope = vec3_scale(d, -4 / one->reach * (1 - e) * u * u * (3 - 2 * u));
    return vec3_cross(vec3_mad(slope, wall->slope, rise * (1 - e) * (1 - e)), one->axis);
}

static void velocity_at(void *user, const double position[3], double time, double velocity[3]) {
    const flow *f = user;
    static const double shares[BRANCHES] = {0.55, 0.45};
    double flux = pulse(time, 150, 0.45, 1.1); /* speed on the centreline times R^2 / 2 */
    vec3 p = of(position), v = {0, 0, 0};
    rising dome = rising_dome(p);
    beside b = find_beside(&f->paths[0], p);
    rising wall = stream_wall(&b, &dome);
    for (int i = 0; i < 2; i++) {
        const vortex *one = &vortices[i];
        v = vec3_mad(v, vortex_at(one, p, &wall), pulse(time, one->peak, one->rest, one->most));
    }
    v = vec3_mad(v, stream_at(&b, &wall), b.shared ? flux : shares[0] * flux);
    if (!b.shared) {
        b = find_beside(&f->paths[1], p);
        wall = stream_wall(&b, &dome);
        v = vec3_mad(v, stream_at(&b, &wall), shares[1] * flux);
    }
    velocity[0] = v.x;
    velocity[1] = v.y;
    velocity[2] = v.z;
}

static int inside_at(void *user, const double position[3]) {
    const flow *f = user;
    vec3 p = of(position);
    rising dome = rising_dome(p);
    for (int i = 0; i < BRANCHES; i++) {
        beside b = find_beside(&f->paths[i], p);
        if (!b.behind && stream_wall(&b, &dome).value < 0)
            return 1;
        if (b.shared)
            return 0;
    }
    return 0;
}

bool flow_aneurysm_field(flow4d_field *field) {
    static const double low[3] = {-20, -10, -19}, high[3] = {16, 10, 20}, spacing = 0.75;
    size_t voxels = 1;
    flow *f = calloc(1, sizeof *f);
    if (!f)
        return false;
    memset(field, 0, sizeof *field);
    field->user = f;
    for (size_t a = 0; a < 3; a++) {
        field->size[a] = (uint32_t)ceil((high[a] - low[a]) / spacing) + 1;
        field->to_world[5 * a] = spacing;
        field->to_world[4 * a + 3] = low[a];
        voxels *= (size_t)(high[a] - low[a]) + 1;
    }
    for (int i = 0; i < BRANCHES; i++) {
        path *way = &f->paths[i];
        path_shape(way, branches[i]);
        way->nearest = malloc(voxels);
        if (!way->nearest) {
            flow_aneurysm_free(field);
            return false;
        }
        for (int a = 0; a < 3; a++) {
            way->least[a] = low[a];
            way->size[a] = (uint32_t)(high[a] - low[a]) + 1;
        }
        path_index(way);
    }
    field->period = beat;
    field->frame_count = 21;
    field->velocity_at = velocity_at;
    field->inside_at = inside_at;
    return true;
}

void flow_aneurysm_free(flow4d_field *field) {
    flow *f = field->user;
    for (int i = 0; f && i < BRANCHES; i++)
        free(f->paths[i].nearest);
    free(f);
    memset(field, 0, sizeof *field);
}
