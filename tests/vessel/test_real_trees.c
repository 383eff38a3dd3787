/* Rays through real trees agree with brute force over all segments in double precision: what they
   hit, that it is on the surface, the segment, the normal and, where they hit nothing, how near
   they came. */
#include "io_read.h"
#include "io_vessel.h"
#include "vessel_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { RAYS = 1500 };

typedef struct ray_truth {
    double least;   /* of the whole line to the union, mm; negative: it passes through */
    double t;       /* where it enters, where least < 0 */
    uint32_t cones; /* that it passes through */
} ray_truth;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Seen along the line, a round cone is a flat one and the line a point. */
static double line_distance(const lao_v4 *cone, const double o[3], const double v[3]) {
    const double zero[3] = {0, 0, 0};
    lao_v4 flat[2];
    for (int i = 0; i < 2; i++) {
        const double p[3] = {(double)cone[i].x - o[0], (double)cone[i].y - o[1],
                             (double)cone[i].z - o[2]};
        double t = dot(p, v);
        flat[i] = lao_v4_make((float)(p[0] - t * v[0]), (float)(p[1] - t * v[1]),
                              (float)(p[2] - t * v[2]), cone[i].w);
    }
    return vessel_cone_distance(flat, zero);
}

/* By small steps, along what it passes through alone. */
static double entry(const lao_v4 *cones, const uint32_t *list, uint32_t count, const double o[3],
                    const double v[3], double end) {
    for (double t = 0; t < end;) {
        const double p[3] = {o[0] + t * v[0], o[1] + t * v[1], o[2] + t * v[2]};
        double d = INFINITY;
        for (uint32_t i = 0; i < count; i++)
            d = fmin(d, vessel_cone_distance(cones + 2 * (size_t)list[i], p));
        if (d < 1e-7)
            return t;
        t += fmax(d, 1e-7);
    }
    return NAN;
}

static ray_truth brute(const sdv_grid *g, const double o[3], const double v[3], double end) {
    static uint32_t list[20000];
    ray_truth r = {INFINITY, NAN, 0};
    for (uint32_t i = 0; i < g->cone_count; i++) {
        double d = line_distance(g->cones + 2 * (size_t)i, o, v);
        r.least = fmin(r.least, d);
        if (d < 0)
            list[r.cones++] = i;
    }
    if (r.cones)
        r.t = entry(g->cones, list, r.cones, o, v, end);
    return r;
}

static double nearest_cone(const sdv_grid *g, const double p[3], uint32_t *cone, double *second) {
    double least = INFINITY;
    *second = INFINITY;
    for (uint32_t i = 0; i < g->cone_count; i++) {
        double d = vessel_cone_distance(g->cones + 2 * (size_t)i, p);
        *second = d < least ? least : fmin(*second, d);
        *cone = d < least ? i : *cone;
        least = fmin(least, d);
    }
    return least;
}

/* Degrees between the normal and the slope of the double distance. */
static double normal_error(const lao_v4 *cone, const double p[3], lao_v3 normal) {
    const double n[3] = {(double)normal.x, (double)normal.y, (double)normal.z};
    double g[3], h = 1e-5 * (1 + (double)cone[0].w + (double)cone[1].w);
    for (int k = 0; k < 3; k++) {
        double a[3] = {p[0], p[1], p[2]}, b[3] = {p[0], p[1], p[2]};
        a[k] -= h;
        b[k] += h;
        g[k] = (vessel_cone_distance(cone, b) - vessel_cone_distance(cone, a)) / (2 * h);
    }
    const double c[3] = {g[1] * n[2] - g[2] * n[1], g[2] * n[0] - g[0] * n[2],
                         g[0] * n[1] - g[1] * n[0]};
    return atan2(sqrt(dot(c, c)), dot(g, n)) * 57.29577951;
}

typedef struct tally {
    uint32_t hits, wrong, ties, grazing;
    double off, turned, missed, late; /* most: cells, degrees, cells, cells */
} tally;

/* From far around, every other ray past a node. */
static void shoot(const sdv_tree *t, const sdv_grid *g, uint32_t *seed, tally *out) {
    double cell = (double)g->cell,
           size[3] = {g->size[0] * cell, g->size[1] * cell, g->size[2] * cell};
    double reach = sqrt(dot(size, size)), second;
    lao_v3 middle =
        lao_v3_make(g->origin.x + 0.5f * (float)size[0], g->origin.y + 0.5f * (float)size[1],
                    g->origin.z + 0.5f * (float)size[2]);
    const lao_v4 *node = t->nodes + (uint32_t)lent_between(seed, 0, t->node_count);
    lao_v3 from = lao_v3_along(middle, vessel_direction(seed), (float)reach);
    lao_v3 to = lao_v3_along(lao_v3_make(node->x, node->y, node->z), vessel_direction(seed),
                             node->w * (float)lent_between(seed, 0, 2));
    if (lent_between(seed, 0, 1) < 0.5)
        to = lao_v3_add(middle, vessel_point(seed, 0.4 * reach));
    sdv_ray ray = {from, lao_v3_unit(lao_v3_sub(to, from), from), SDV_TRACE_NEAREST, 0};
    const double o[3] = {(double)from.x, (double)from.y, (double)from.z};
    const double v[3] = {(double)ray.direction.x, (double)ray.direction.y, (double)ray.direction.z};
    sdv_hit hit;
    sdv_trace(g, &ray, &hit);
    ray_truth truth = brute(g, o, v, 3 * reach);
    if (fabs(truth.least) < 1e-3 * cell) /* touches */
        return;
    if ((truth.least < 0) != (hit.cone != SDV_NONE)) {
        out->wrong++;
        return;
    }
    if (hit.cone == SDV_NONE) {
        if (truth.least < 2 * cell)
            out->missed = fmax(out->missed, fabs((double)hit.d_min - truth.least) / cell);
        return;
    }
    const double p[3] = {(double)hit.position.x, (double)hit.position.y, (double)hit.position.z};
    uint32_t nearest = SDV_NONE;
    double d = nearest_cone(g, p, &nearest, &second);
    out->hits++;
    out->off = fmax(out->off, fabs(d) / cell);
    out->grazing += fabs((double)hit.t - truth.t) > 0.05 * cell;
    out->late = fmax(out->late, fabs((double)hit.t - truth.t) / cell);
    if (nearest != hit.cone) { /* no other is nearer than floats tell */
        const lao_v4 *ends = g->cones + 2 * (size_t)hit.cone;
        out->ties++;
        assert_true(vessel_cone_distance(ends, p) - d < 1e-5 * reach);
    }
    out->turned = fmax(out->turned, normal_error(g->cones + 2 * (size_t)hit.cone, p, hit.normal));
}

static void trees_as_they_are(void **state) {
    static const struct {
        const char *name, *unit;
    } files[] = {{"BG001.CNG.swc", "mm"},         {"BG05.CNG.swc", "mm"},
                 {"navis_722817260.swc", "um"},   {"opencco_liver_N995.gxl.xml", "mm"},
                 {"vmr_0080_H_PULM_H.vtp", "cm"}, {"vmtk_aorta-centerline.vtp", "mm"}};
    const char *root = getenv("LINEAO_DATA");
    (void)state;
    if (!root) {
        print_message("skipped: the real data is absent; set LINEAO_DATA to its folder\n");
        skip();
    }
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const sdv_grid_desc desc = {96, NULL, 0, {0, 0, 0}};
        tally sum = {0, 0, 0, 0, 0, 0, 0, 0};
        uint32_t seed = (uint32_t)i + 1;
        char path[1024];
        io_contents contents;
        io_options options;
        io_vessel vessel;
        io_error error;
        sdv_grid grid;
        memset(&options, 0, sizeof options);
        options.every = 1;
        options.unit = files[i].unit;
        snprintf(path, sizeof path, "%s/trees/%s", root, files[i].name);
        assert_true(io_read(path, IO_TREE, &options, &contents, &error));
        assert_true(io_vessel_build(NULL, &contents.tree, &vessel, &error));
        assert_int_equal(sdv_grid_build(NULL, &vessel.tree, &desc, &grid), LAO_OK);
        for (int k = 0; k < RAYS; k++)
            shoot(&vessel.tree, &grid, &seed, &sum);
        printf("%s: %u segments, %u of %u hit, %u disagree, off the surface by %.1e cells, normals "
               "by %.2g degrees, near misses by %.1e cells, %u ties, %u graze (%.2g cells)\n",
               files[i].name, grid.cone_count, sum.hits, (unsigned)RAYS, sum.wrong, sum.off,
               sum.turned, sum.missed, sum.ties, sum.grazing, sum.late);
        assert_in_range(sum.hits, RAYS / 5, RAYS);
        assert_int_equal(sum.wrong, 0);
        assert_true(sum.off < 1e-3);
        assert_true(sum.turned < 0.1);
        assert_true(sum.missed < 1e-2);
        assert_true(sum.ties <= RAYS / 100 && sum.grazing <= RAYS / 100);
        sdv_grid_free(&grid);
        io_vessel_free(&vessel);
        io_contents_free(&contents);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(trees_as_they_are)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
