/* Proves that the embedded surfaces are closed, whole, outward, on the wall that their
   formulas describe and clear of the lattice's border; that spacing refines them; that the
   pathlines of `flow` run inside the aorta; and that those of `aneurysm` run through vessel and
   sac, in a flow that is free of divergence, zero on the wall and turns in the sac. */
#include "surface_host.h"

#include "flow_aneurysm.h"
#include "flow_phantom.h"
#include "scene.h"
#include "scene_surface.h"

#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static vsf_mesh mesh_of(const scene_surface *surface, lent_host *host) {
    vsf_host h = surface_host_make(host);
    vsf_mesh_desc desc;
    vsf_mesh mesh;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = surface->vertex_count;
    desc.positions = surface->positions;
    desc.triangle_count = surface->triangle_count;
    desc.triangles = surface->triangles;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    return mesh;
}

static void surfaces_are_whole(void **state) {
    uint32_t count;
    const char *const *names = scene_surface_names(&count);
    (void)state;
    assert_int_equal(count, 4);
    for (uint32_t i = 0; i < count; i++) {
        scene_surface surface, coarse, again;
        lent_host host;
        vsf_mesh mesh;
        double spacing;
        assert_non_null(scene_surface_help(names[i]));
        assert_true(scene_surface_make(names[i], 0, &surface));
        mesh = mesh_of(&surface, &host);
        assert_int_equal(host.warnings, 0);
        assert_int_equal(mesh.info.open_edges, 0);
        uint32_t parts = strcmp(names[i], "liver") == 0 ? 2 : 1; /* with a vein in it */
        assert_int_equal(mesh.info.parts, parts);
        assert_int_equal(mesh.info.turned, 0); /* outward as it comes */
        assert_int_equal(mesh.vertex_count + mesh.triangle_count - mesh.info.edges,
                         2 * parts); /* a ball's */
        assert_true(mesh.triangle_count > 30000 && mesh.triangle_count < 120000);
        spacing = mesh.info.mean_edge;
        for (uint32_t v = 0; v < mesh.vertex_count; v++) {
            double p[3] = {(double)mesh.positions[3 * v], (double)mesh.positions[3 * v + 1],
                           (double)mesh.positions[3 * v + 2]};
            assert_true(fabs(scene_surface_distance(names[i], p)) < 0.02 * spacing);
        }
        printf("%s: %u triangles, %.0f mm^2, %.0f mm^3\n", names[i], mesh.triangle_count,
               mesh.info.area, mesh.info.volume);
        assert_true(scene_surface_make(names[i], 2 * spacing, &coarse));
        assert_true(scene_surface_make(names[i], 2 * spacing, &again)); /* the same bits */
        assert_true(coarse.triangle_count < surface.triangle_count / 2);
        assert_memory_equal(again.positions, coarse.positions, 12 * coarse.vertex_count);
        scene_surface_free(&again);
        scene_surface_free(&coarse);
        scene_surface_free(&surface);
        vsf_mesh_free(&mesh);
    }
}

static void the_neck_is_concave_and_the_bleb_convex(void **state) {
    /* what the shading must show: nearest vertices to the bleb's tip and to the neck */
    static const float places[2][3] = {{-10.3f, -0.4f, 15.3f}, {-1.2f, 6.0f, 6.6f}};
    scene_surface surface;
    lent_host host;
    vsf_mesh mesh;
    vsf_smooth_desc smooth = {0, 0, 0, 1};
    float *k;
    (void)state;
    assert_true(scene_surface_make("aneurysm", 0, &surface));
    mesh = mesh_of(&surface, &host);
    assert_int_equal(vsf_mesh_smooth(NULL, &mesh, &smooth), LAO_OK);
    k = (float *)malloc(8 * mesh.vertex_count);
    assert_int_equal(vsf_curvatures(NULL, &mesh, k, NULL), LAO_OK);
    for (int i = 0; i < 2; i++) {
        uint32_t best = 0;
        double least = 1e9;
        for (uint32_t v = 0; v < mesh.vertex_count; v++) {
            double d = 0;
            for (uint32_t j = 0; j < 3; j++)
                d += pow((double)mesh.positions[3 * v + j] - (double)places[i][j], 2);
            if (d < least) {
                least = d;
                best = v;
            }
        }
        printf("place %d: %.2f mm away, curvatures %.2f and %.2f\n", i, sqrt(least),
               (double)k[2 * best], (double)k[2 * best + 1]);
        assert_true(k[2 * best] > 0.1f);
        assert_true(i == 0 ? k[2 * best + 1] > 0.1f : k[2 * best + 1] < -0.1f);
    }
    free(k);
    vsf_mesh_free(&mesh);
    scene_surface_free(&surface);
}

static void flow_stays_inside_the_aorta(void **state) {
    scene_lines lines;
    (void)state;
    assert_true(scene_make("flow", 300, 1, &lines));
    assert_true(lines.point_count > 1000);
    for (uint32_t i = 0; i < lines.point_count; i++) {
        double p[3] = {(double)lines.points[3 * i], (double)lines.points[3 * i + 1],
                       (double)lines.points[3 * i + 2]};
        assert_true(scene_surface_distance("aorta", p) < 1e-3);
    }
    scene_free(&lines);
}

/* How far a place is in the sac: less than 1 inside its ellipsoid. */
static double in_sac(const double p[3]) {
    return pow((p[0] + 4.5) / 5.6, 2) + pow((p[1] - 2) / 5, 2) + pow((p[2] - 11) / 5.2, 2);
}

/* Pathlines enter by the parent, pass by or through the sac and leave by both branches. */
static void flow_runs_through_the_aneurysm(void **state) {
    uint32_t through = 0, left[2] = {0, 0}, in = 0, speeds = 0;
    scene_lines lines;
    (void)state;
    assert_true(scene_make("aneurysm", 400, 1, &lines));
    for (uint32_t line = 0; line < lines.line_count; line++) {
        bool inside = false, outside = false;
        for (uint32_t i = lines.offsets[line]; i < lines.offsets[line + 1]; i++) {
            const float *q = lines.points + 3 * (size_t)i;
            const double p[3] = {(double)q[0], (double)q[1], (double)q[2]};
            assert_true(scene_surface_distance("aneurysm", p) < 0.01);
            inside |= in_sac(p) < 1 && p[2] > 8;
            outside |= p[2] < 5;
            left[0] += p[2] < -10 && p[0] > 7;
            left[1] += p[0] > 12;
            in += p[2] < -10 && p[0] < -10;
            speeds += (double)lines.values[i] > 0.2;
        }
        through += inside && outside;
    }
    printf("%u of 400 lines come from or go to the sac; points in the parent %u, branches %u, %u, "
           "faster than 0.2 m/s %u of %u\n",
           through, in, left[0], left[1], speeds, lines.point_count);
    assert_true(through > 20 && in > 200 && left[0] > 100 && left[1] > 100);
    assert_true(speeds > lines.point_count / 10);
    scene_free(&lines);
}

static void aneurysm_velocity(const flow4d_field *field, const double p[3], int axis, double step,
                              double v[3]) {
    double at[3] = {p[0], p[1], p[2]};
    at[axis] += step;
    field->velocity_at(field->user, at, 150, v);
}

static double random_in(uint32_t *seed, double low, double high) {
    *seed = *seed * 1664525u + 1013904223u;
    return low + (high - low) * (double)(*seed >> 8) / 16777216.0;
}

static void aneurysm_flow_is_a_flow(void **state) {
    flow4d_field field;
    double turn = 0, worst_wall = 0, steep = 0;
    uint32_t seed = 5, checked = 0, divergent = 0, walls = 0;
    (void)state;
    assert_true(flow_aneurysm_field(&field));
    for (int i = 0; i < 200000; i++) {
        const double p[3] = {random_in(&seed, -20, 16), random_in(&seed, -10, 10),
                             random_in(&seed, -19, 20)};
        double wall = flow_aneurysm_wall(p), v[3], sum = 0, slope = 0;
        field.velocity_at(field.user, p, 150, v);
        double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        assert_true(isfinite(speed));
        if (wall > 0.01)
            assert_true(speed == 0);
        if (wall < 0 && wall > -0.02) { /* no faster than its slope times the way from the wall */
            worst_wall = fmax(worst_wall, speed);
            walls++;
        }
        if (wall > -0.1 || !field.inside_at(field.user, p))
            continue;
        for (int axis = 0; axis < 3; axis++) {
            double a[3], b[3];
            aneurysm_velocity(&field, p, axis, 1e-3, a);
            aneurysm_velocity(&field, p, axis, -1e-3, b);
            sum += (a[axis] - b[axis]) / 2e-3;
            for (int k = 0; k < 3; k++)
                slope = fmax(slope, fabs(a[k] - b[k]) / 2e-3);
        }
        checked++;
        divergent += fabs(sum) > 0.1 * slope + 1e-4;
        steep = fmax(steep, slope);
        if (in_sac(p) < 0.6) /* about the vortex' axis, along +x below it as the stream */
            turn += 0.96 * ((p[2] - 11) * v[0] - (p[0] + 4.5) * v[2]);
    }
    printf("%u places, %u with divergence; fastest beside the wall %.3f m/s of %u, steepest %.2f; "
           "turn %.1f\n",
           checked, divergent, worst_wall, walls, steep, turn);
    assert_true(checked > 5000 && walls > 100);
    assert_true(divergent < checked / 10); /* corners of the branches */
    assert_true(worst_wall < 0.05);
    assert_true(turn < -100);
    flow_aneurysm_free(&field);
    flow_aneurysm_free(&field);
}

static void refuses(void **state) {
    scene_surface surface;
    (void)state;
    memset(&surface, 7, sizeof surface);
    assert_false(scene_surface_make("nothing", 0, &surface));
    assert_false(scene_surface_make("liver", -1, &surface));
    assert_false(scene_surface_make("liver", 1e-6, &surface));
    assert_false(scene_surface_make("liver", (double)NAN, &surface));
    for (size_t i = 0; i < sizeof surface; i++)
        assert_int_equal(((unsigned char *)&surface)[i], 7);
    assert_null(scene_surface_help("nothing"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_are_whole),
        cmocka_unit_test(the_neck_is_concave_and_the_bleb_convex),
        cmocka_unit_test(flow_stays_inside_the_aorta),
        cmocka_unit_test(flow_runs_through_the_aneurysm),
        cmocka_unit_test(aneurysm_flow_is_a_flow),
        cmocka_unit_test(refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
