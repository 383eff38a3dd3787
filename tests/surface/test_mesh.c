/* Proves that a mesh of arrays is welded, cleaned, turned outward and named where it is odd, that
   its areas, normals and rings are those of its triangles, and that smoothing and subdivision do
   what their formulas say. */
#include "surface_host.h"

#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void near_to(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g within %g", a, b, tolerance);
}

/* ---- triangles */

static void gradients_of_linear_functions(void **state) {
    const double p[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const double x[3] = {0, 1, 0}, y[3] = {0, 0, 1}, one[3] = {5, 5, 5}, zero[3] = {0, 0, 0};
    double g[3];
    uint32_t seed = 1;
    (void)state;
    vsf_triangle_gradient(p[0], p[1], p[2], x, g);
    assert_true(g[0] == 1 && g[1] == 0 && g[2] == 0);
    vsf_triangle_gradient(p[0], p[1], p[2], y, g);
    assert_true(g[0] == 0 && g[1] == 1 && g[2] == 0);
    vsf_triangle_gradient(p[0], p[1], p[2], one, g);
    assert_true(g[0] == 0 && g[1] == 0 && g[2] == 0);
    vsf_triangle_gradient(zero, zero, zero, x, g);
    assert_true(g[0] == 0 && g[1] == 0 && g[2] == 0);
    vsf_triangle_gradient(p[0], p[1], p[1], y, g); /* no area */
    assert_true(g[0] == 0 && g[1] == 0 && g[2] == 0);
    for (int i = 0; i < 1000; i++) {
        double q[3][3], a[3], l[3], e1[3], e2[3], n[3], an = 0, nn = 0;
        for (int k = 0; k < 3; k++) {
            a[k] = lent_between(&seed, -2, 2);
            for (int j = 0; j < 3; j++)
                q[j][k] = lent_between(&seed, -10, 10);
        }
        for (int j = 0; j < 3; j++)
            l[j] = a[0] * q[j][0] + a[1] * q[j][1] + a[2] * q[j][2];
        vsf_triangle_gradient(q[0], q[1], q[2], l, g);
        for (int k = 0; k < 3; k++) {
            e1[k] = q[1][k] - q[0][k];
            e2[k] = q[2][k] - q[0][k];
        }
        n[0] = e1[1] * e2[2] - e1[2] * e2[1];
        n[1] = e1[2] * e2[0] - e1[0] * e2[2];
        n[2] = e1[0] * e2[1] - e1[1] * e2[0];
        for (int k = 0; k < 3; k++) {
            an += a[k] * n[k];
            nn += n[k] * n[k];
        }
        for (int k = 0; k < 3; k++)
            near_to(g[k], a[k] - n[k] * an / nn, 1e-9);
    }
}

static void mixed_areas(void **state) {
    const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    const double top[3] = {0.5, sqrt(0.75), 0}, low[3] = {0.5, 0.1, 0};
    double a[3];
    uint32_t seed = 2;
    (void)state;
    vsf_corner_areas(o, x, top, a); /* equilateral: a third each */
    for (int k = 0; k < 3; k++)
        near_to(a[k], sqrt(0.75) / 6, 1e-15);
    vsf_corner_areas(o, x, y, a); /* right angle: the limit of Voronoi areas */
    near_to(a[0], 0.25, 1e-15);
    near_to(a[1], 0.125, 1e-15);
    near_to(a[2], 0.125, 1e-15);
    vsf_corner_areas(x, low, o, a); /* obtuse at its second corner */
    near_to(a[0], 0.05 / 4, 1e-15);
    near_to(a[1], 0.05 / 2, 1e-15);
    near_to(a[2], 0.05 / 4, 1e-15);
    vsf_corner_areas(o, x, x, a);
    assert_true(a[0] == 0 && a[1] == 0 && a[2] == 0);
    for (int i = 0; i < 100000; i++) {
        double p[3][3], e1[3], e2[3], c[3], area;
        for (int k = 0; k < 9; k++)
            p[k / 3][k % 3] = lent_between(&seed, -1, 1);
        for (int k = 0; k < 3; k++) {
            e1[k] = p[1][k] - p[0][k];
            e2[k] = p[2][k] - p[0][k];
        }
        c[0] = e1[1] * e2[2] - e1[2] * e2[1];
        c[1] = e1[2] * e2[0] - e1[0] * e2[2];
        c[2] = e1[0] * e2[1] - e1[1] * e2[0];
        area = 0.5 * sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        vsf_corner_areas(p[0], p[1], p[2], a);
        assert_true(a[0] >= 0 && a[1] >= 0 && a[2] >= 0);
        near_to(a[0] + a[1] + a[2], area, 1e-12);
    }
}

static void least_turns(void **state) {
    uint32_t seed = 3;
    (void)state;
    for (int i = 0; i < 1000; i++) {
        double a[3], b[3], v[3], t[3], la = 0, lb = 0, va = 0, tb = 0, vv = 0, tt = 0;
        for (int k = 0; k < 3; k++) {
            a[k] = lent_between(&seed, -1, 1);
            b[k] = lent_between(&seed, -1, 1);
            v[k] = lent_between(&seed, -1, 1);
            la += a[k] * a[k];
            lb += b[k] * b[k];
        }
        for (int k = 0; k < 3; k++) {
            a[k] /= sqrt(la);
            b[k] /= sqrt(lb);
        }
        assert_int_equal(vsf_turn(a, b, a, t), 0);
        for (int k = 0; k < 3; k++)
            near_to(t[k], b[k], 1e-9); /* from becomes to */
        assert_int_equal(vsf_turn(a, b, v, t), 0);
        for (int k = 0; k < 3; k++) {
            va += v[k] * a[k];
            tb += t[k] * b[k];
            vv += v[k] * v[k];
            tt += t[k] * t[k];
        }
        near_to(va, tb, 1e-9); /* angles and lengths stay */
        near_to(vv, tt, 1e-9);
        assert_int_equal(vsf_turn(a, a, v, t), 0);
        for (int k = 0; k < 3; k++)
            near_to(t[k], v[k], 1e-12);
        for (int k = 0; k < 3; k++)
            b[k] = -a[k];
        assert_int_equal(vsf_turn(a, b, v, t), -1);
        assert_true(t[0] == 0 && t[1] == 0 && t[2] == 0);
    }
}

/* ---- building */

static void check_topology(const vsf_mesh *mesh) {
    double area = 0;
    for (uint32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        uint32_t other = mesh->opposites[h], next = h % 3 == 2 ? h - 2 : h + 1;
        assert_true(mesh->triangles[h] < mesh->vertex_count);
        if (other != VSF_NONE) {
            uint32_t after = other % 3 == 2 ? other - 2 : other + 1;
            assert_int_equal(mesh->opposites[other], h);
            assert_int_equal(mesh->triangles[h], mesh->triangles[after]);
            assert_int_equal(mesh->triangles[next], mesh->triangles[other]);
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (uint32_t i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            assert_int_equal(mesh->triangles[mesh->ring_corners[i]], v);
            assert_true(i == mesh->ring_starts[v] ||
                        mesh->ring_corners[i] > mesh->ring_corners[i - 1]);
        }
        area += mesh->areas[v];
    }
    assert_int_equal(mesh->ring_starts[mesh->vertex_count], 3 * mesh->triangle_count);
    near_to(area / mesh->info.area, 1, 1e-12);
}

static void welds_what_is_in_one_place(void **state) {
    surface_shape shape = surface_sphere(2, 3), loose;
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh_desc desc;
    vsf_mesh mesh;
    uint32_t n = 3 * shape.triangle_count;
    (void)state;
    loose = shape;
    loose.vertex_count = n;
    loose.positions = (float *)malloc(3 * sizeof(float) * n);
    loose.triangles = (uint32_t *)malloc(sizeof(uint32_t) * n);
    for (uint32_t i = 0; i < n; i++) {
        loose.triangles[i] = i;
        memcpy(loose.positions + 3 * i, shape.positions + 3 * shape.triangles[i], 12);
        for (uint32_t k = 0; k < 3; k++) { /* -0 is 0 */
            float *x = loose.positions + 3 * i + k;
            *x = *x == 0 && i % 2 ? -0.0f : *x;
        }
    }
    desc = surface_describe(&loose);
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    assert_int_equal(mesh.vertex_count, 642);
    assert_int_equal(mesh.triangle_count, 1280);
    assert_int_equal(mesh.info.welded, n - 642);
    assert_int_equal(mesh.info.edges, 1920);
    assert_int_equal(mesh.info.open_edges, 0);
    assert_int_equal(mesh.info.parts, 1);
    assert_int_equal(mesh.info.closed_parts, 1);
    assert_int_equal(host.warnings, 0);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t v = mesh.vertex_targets[i];
        assert_true(mesh.vertex_sources[v] <= i);
        for (uint32_t k = 0; k < 3; k++)
            assert_true(mesh.positions[3 * v + k] == loose.positions[3 * i + k]);
    }
    for (uint32_t v = 1; v < mesh.vertex_count; v++) /* the desc's order */
        assert_true(mesh.vertex_sources[v] > mesh.vertex_sources[v - 1]);
    check_topology(&mesh);
    near_to(mesh.info.area / (4 * 3.14159265 * 4), 1, 0.01);
    near_to(mesh.info.volume / (4.0 / 3 * 3.14159265 * 8), 1, 0.02);
    for (uint32_t v = 0; v < mesh.vertex_count; v++) { /* normals point outward */
        const float *p = mesh.positions + 3 * v, *q = mesh.normals + 3 * v;
        near_to((double)(p[0] * q[0] + p[1] * q[1] + p[2] * q[2]), 2, 2e-3);
    }
    vsf_mesh_free(&mesh);
    desc.flags = VSF_MESH_NO_WELD;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    assert_int_equal(mesh.vertex_count, n);
    assert_int_equal(mesh.info.open_edges, n);
    assert_int_equal(host.seen[VSF_LOG_EDGES_OPEN], 1);
    vsf_mesh_free(&mesh);
    assert_int_equal(host.memory.bytes, 0);
    free(loose.positions);
    free(loose.triangles);
    surface_shape_free(&shape);
}

static void turns_what_runs_the_wrong_way(void **state) {
    surface_shape shape = surface_torus(5, 1, 24, 12);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh_desc desc = surface_describe(&shape);
    vsf_mesh right, mesh;
    uint32_t seed = 4, turned = 0;
    (void)state;
    assert_int_equal(vsf_mesh_build(&h, &desc, &right), LAO_OK);
    assert_int_equal(right.info.turned, 0);
    assert_true(right.info.volume > 0);
    for (uint32_t t = 0; t < shape.triangle_count; t++) { /* some */
        uint32_t *c = shape.triangles + 3 * t, v = c[0];
        if (lent_between(&seed, 0, 1) < 0.3) {
            c[0] = c[1];
            c[1] = v;
            turned++;
        }
    }
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    assert_int_equal(mesh.info.turned, turned);
    assert_int_equal(host.seen[VSF_LOG_WINDING_MENDED], 1);
    assert_int_equal(host.seen[VSF_LOG_PARTS_INWARD], 0);
    assert_memory_equal(mesh.normals, right.normals, 12 * right.vertex_count);
    near_to(mesh.info.volume, right.info.volume, 1e-6);
    check_topology(&mesh);
    vsf_mesh_free(&mesh);
    desc.flags = VSF_MESH_KEEP_WINDING; /* named only */
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    assert_int_equal(mesh.info.turned, 0);
    assert_true(mesh.info.twisted_edges > 0);
    assert_int_equal(host.seen[VSF_LOG_WINDING_TWISTED], 1);
    assert_memory_equal(mesh.triangles, shape.triangles, 12 * shape.triangle_count);
    check_topology(&mesh);
    vsf_mesh_free(&mesh);
    for (uint32_t t = 0; t < shape.triangle_count; t++) { /* all of them, from the right ones */
        shape.triangles[3 * t] = right.triangles[3 * t];
        shape.triangles[3 * t + 1] = right.triangles[3 * t + 2];
        shape.triangles[3 * t + 2] = right.triangles[3 * t + 1];
    }
    desc.flags = 0;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    assert_int_equal(host.seen[VSF_LOG_PARTS_INWARD], 1);
    assert_int_equal(mesh.info.turned, shape.triangle_count);
    assert_true(mesh.info.volume > 0);
    check_topology(&mesh);
    vsf_mesh_free(&mesh);
    desc.flags = VSF_MESH_KEEP_WINDING;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    near_to(mesh.info.volume, -right.info.volume, 1e-6);
    vsf_mesh_free(&mesh);
    desc.flags = VSF_MESH_FLIP;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    near_to(mesh.info.volume, -right.info.volume, 1e-6);
    check_topology(&mesh);
    vsf_mesh_free(&mesh);
    vsf_mesh_free(&right);
    surface_shape_free(&shape);
    assert_int_equal(host.memory.bytes, 0);
}

static void names_what_it_cannot_mend(void **state) {
    /* three triangles on one edge; a vertex of none; a wild one; a triangle without area; a Moebius
       strip of 5 triangles */
    static const float points[] = {0,  0,  0, 0, 0,  1,   1, 0,  0, -1, 1,  0,  -1,
                                   -1, 0,  9, 9, 9,  NAN, 0, 0,  0, 0,  2,  20, 0,
                                   0,  21, 0, 0, 20, 1,   0, 21, 1, 1,  22, 0,  1};
    static const uint32_t triangles[] = {0, 1, 2, 0,  1, 3,  0,  1,  4,  0,  1,  6,  0, 1,  7, 2, 2,
                                         1, 8, 9, 10, 9, 10, 11, 10, 11, 12, 11, 12, 8, 12, 8, 9};
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh_desc desc;
    vsf_mesh mesh;
    char text[200];
    (void)state;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = 13;
    desc.positions = points;
    desc.triangle_count = 11;
    desc.triangles = triangles;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    assert_int_equal(mesh.triangle_count, 8);
    assert_int_equal(mesh.vertex_count, 12);
    assert_int_equal(mesh.info.wild, 1);
    assert_int_equal(mesh.info.degenerate, 2);
    assert_int_equal(mesh.info.unreferenced, 2); /* 5, and 7 of the flat one */
    assert_int_equal(mesh.info.crowded_edges, 1);
    assert_int_equal(mesh.info.twisted_edges, 1);
    assert_int_equal(host.seen[VSF_LOG_TRIANGLES_WILD], 1);
    assert_int_equal(host.seen[VSF_LOG_EDGES_CROWDED], 1);
    assert_int_equal(host.seen[VSF_LOG_EDGES_OPEN], 1);
    assert_int_equal(host.seen[VSF_LOG_WINDING_TWISTED], 1);
    assert_int_equal(mesh.vertex_targets[6], VSF_NONE);
    assert_int_equal(mesh.vertex_targets[7], 6);
    assert_int_equal(mesh.triangle_sources[3], 6);
    for (uint32_t i = 0; i < mesh.warning_count; i++) {
        vsf_mesh_warning_text(&mesh, i, text, sizeof text);
        if (mesh.warnings[i].item == VSF_LOG_VERTICES_LOOSE)
            assert_string_equal(text, "2 vertices belong to no triangle, first: vertex 5");
    }
    for (uint32_t i = 0; i < 3 * mesh.vertex_count; i++)
        assert_true(mesh.normals[i] >= -1 && mesh.normals[i] <= 1);
    assert_true(mesh.info.bounds[1][0] == 22.0f); /* not the loose vertex' 9, 9, 9 alone */
    assert_true(mesh.info.bounds[1][2] == 1.0f);
    check_topology(&mesh);
    vsf_mesh_free(&mesh);
    assert_int_equal(host.memory.bytes, 0);
}

static void refuses_what_is_no_mesh(void **state) {
    static const float points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t good[] = {0, 1, 2}, bad[] = {0, 1, 3}, flat[] = {0, 1, 1};
    vsf_attribute attribute = {NULL, 1, points};
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh_desc desc;
    vsf_mesh mesh;
    (void)state;
    memset(&desc, 0, sizeof desc);
    memset(&mesh, 7, sizeof mesh);
    desc.vertex_count = 3;
    desc.positions = points;
    desc.triangle_count = 1;
    desc.triangles = bad;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_MESH_INDEX);
    assert_non_null(strstr(host.text, "triangle 0, vertex 3 of 3"));
    desc.triangles = flat;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_MESH_EMPTY);
    desc.triangle_count = 0;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_MESH_EMPTY);
    desc.triangle_count = 1;
    desc.triangles = good;
    desc.attributes = &attribute;
    desc.attribute_count = 1;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_MESH_ATTRIBUTE);
    desc.attribute_count = 0;
    desc.positions = NULL;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_NULL_ARGUMENT);
    desc.positions = points;
    desc.triangle_count = 1u << 30;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_MESH_COUNT);
    assert_int_equal(vsf_mesh_build(&h, NULL, &mesh), LAO_ERROR_INVALID_ARGUMENT);
    for (size_t i = 0; i < sizeof mesh; i++)
        assert_int_equal(((unsigned char *)&mesh)[i], 7); /* untouched */
    assert_int_equal(host.failures, 7);
    assert_int_equal(host.memory.bytes, 0);
}

static void keeps_attributes_and_given_normals(void **state) {
    static const float points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1};
    static const uint32_t triangles[] = {0, 1, 2, 3, 4, 1};
    static const float shear[] = {1, 2, 3, 4, 5}, vector[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    static const float normals[] = {0, 0, 9, 0, 0, 0, NAN, 0, 0, 1, 0, 0, 0, 3, 4};
    const vsf_attribute attributes[2] = {{"wall shear stress", 0, shear}, {"flow", 2, vector}};
    vsf_mesh_desc desc;
    vsf_mesh mesh;
    (void)state;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = 5;
    desc.positions = points;
    desc.triangle_count = 2;
    desc.triangles = triangles;
    desc.attributes = attributes;
    desc.attribute_count = 2;
    desc.normals = normals;
    assert_int_equal(vsf_mesh_build(NULL, &desc, &mesh), LAO_OK);
    assert_int_equal(mesh.vertex_count, 4);
    assert_int_equal(mesh.attribute_count, 2);
    assert_string_equal(mesh.attributes[0].name, "wall shear stress");
    assert_int_equal(mesh.attributes[0].components, 1);
    assert_true(mesh.attributes[0].values[0] == 1 && mesh.attributes[0].values[3] == 5);
    assert_true(mesh.attributes[1].values[7] == 9);
    assert_true(mesh.normals[2] == 1);                          /* unit */
    assert_true(fabsf(mesh.normals[3 * 2 + 2] - 1.0f) < 1e-6f); /* NaN: from the face */
    assert_true(mesh.normals[3 * 3 + 1] == 0.6f && mesh.normals[3 * 3 + 2] == 0.8f);
    vsf_mesh_free(&mesh);
}

/* ---- smoothing */

static void smoothing_has_its_transfer(void **state) {
    /* the icosahedron: neighbours' mean is p / sqrt(5), so L p = -k p with k = 1 - 1 / sqrt(5), for
       uniform and by symmetry for cotangent weights */
    const double k = 1 - 1 / sqrt(5.0), lambda = 0.4, mu = 1 / (k - 1 / 0.4);
    surface_shape shape = surface_sphere(10, 0);
    (void)state;
    for (int uniform = 0; uniform < 2; uniform++) {
        vsf_smooth_desc desc;
        vsf_mesh mesh = surface_build(&shape, 0, 0);
        double factor = pow((1 - 0.5 * k) * (1 + 0.53 * k), 20);
        memset(&desc, 0, sizeof desc);
        desc.uniform = uniform;
        assert_int_equal(vsf_mesh_smooth(NULL, &mesh, &desc), LAO_OK);
        for (uint32_t i = 0; i < 36; i++)
            near_to((double)mesh.positions[i], factor * (double)shape.positions[i], 5e-6);
        vsf_mesh_free(&mesh);
        /* at the pass band's edge nothing changes: (1 - lambda k)(1 - mu k) = 1 */
        mesh = surface_build(&shape, 0, 0);
        desc.lambda = lambda;
        desc.mu = mu;
        desc.steps = 50;
        assert_int_equal(vsf_mesh_smooth(NULL, &mesh, &desc), LAO_OK);
        for (uint32_t i = 0; i < 36; i++)
            near_to((double)mesh.positions[i], (double)shape.positions[i], 5e-6);
        vsf_mesh_free(&mesh);
    }
    surface_shape_free(&shape);
}

static void smoothing_keeps_volume_planes_and_borders(void **state) {
    surface_shape sphere = surface_sphere(10, 4), plane = surface_saddle(0, 5, 20);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh mesh = surface_build(&sphere, 0, 0), copy;
    vsf_mesh_desc desc;
    double volume = mesh.info.volume, rough;
    uint32_t seed = 5;
    (void)state;
    assert_int_equal(vsf_mesh_smooth(&h, &mesh, NULL), LAO_OK);
    assert_true(fabs(mesh.info.volume / volume - 1) < 0.01);
    check_topology(&mesh);
    vsf_mesh_free(&mesh);
    for (uint32_t i = 0; i < 3 * sphere.vertex_count; i++) /* noise goes */
        sphere.positions[i] *= (float)lent_between(&seed, 0.98, 1.02);
    mesh = surface_build(&sphere, 0, 0);
    rough = mesh.info.area;
    host.backwards = 1;
    assert_int_equal(vsf_mesh_smooth(&h, &mesh, NULL), LAO_OK);
    assert_true(mesh.info.area < rough);
    copy = surface_build(&sphere, 0, 0);
    assert_int_equal(vsf_mesh_smooth(NULL, &copy, NULL), LAO_OK);
    assert_memory_equal(copy.positions, mesh.positions, 12 * mesh.vertex_count);
    vsf_mesh_free(&copy);
    vsf_mesh_free(&mesh);
    for (uint32_t i = 0; i < 400; i++) { /* inner points of a plane move in it only */
        uint32_t x = i % 20, y = i / 20;
        if (x % 19 && y % 19)
            plane.positions[3 * i] += (float)lent_between(&seed, -0.1, 0.1);
        plane.positions[3 * i + 2] = 0.5f;
    }
    desc = surface_describe(&plane);
    assert_int_equal(vsf_mesh_build(NULL, &desc, &mesh), LAO_OK);
    assert_int_equal(vsf_mesh_smooth(NULL, &mesh, NULL), LAO_OK);
    for (uint32_t i = 0; i < 400; i++) {
        assert_true(mesh.positions[3 * i + 2] == 0.5f);
        if (!(i % 20 % 19) || !(i / 20 % 19)) {
            assert_true(mesh.borders[i]);
            assert_memory_equal(mesh.positions + 3 * i, plane.positions + 3 * i, 12);
        }
    }
    vsf_mesh_free(&mesh);
    surface_shape_free(&plane);
    surface_shape_free(&sphere);
}

static double cotangent(const float *at, const float *a, const float *b) {
    double u[3], v[3], dot = 0, cross2 = 0, uu = 0, vv = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = (double)a[k] - (double)at[k];
        v[k] = (double)b[k] - (double)at[k];
        dot += u[k] * v[k];
        uu += u[k] * u[k];
        vv += v[k] * v[k];
    }
    cross2 = uu * vv - dot * dot;
    return dot / sqrt(cross2);
}
static void smoothing_takes_no_negative_weight(void **state) {
    /* a fan about vertex 0, with a rim that stays: one double step, by hand. The edge to the far
       vertex 1 has negative weight, because the angles that look at it are obtuse */
    static const float points[] = {0, 0, 0.5f, 9, 0, 0, 2, 2, 0, -2, 2, 0, -2, -2, 0, 2, -2, 0};
    static const uint32_t triangles[] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 1};
    vsf_smooth_desc once = {1, 0, 0, 0};
    double w[5], sum = 0, least = 0, want[3];
    vsf_mesh_desc desc;
    vsf_mesh mesh;
    (void)state;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = 6;
    desc.positions = points;
    desc.triangle_count = 5;
    desc.triangles = triangles;
    desc.flags = VSF_MESH_KEEP_WINDING;
    for (uint32_t i = 0; i < 5; i++) {
        const float *rim = points + 3 * (i + 1), *before = points + 3 * ((i + 4) % 5 + 1);
        const float *after = points + 3 * ((i + 1) % 5 + 1);
        w[i] = 0.5 * (cotangent(before, points, rim) + cotangent(after, points, rim));
        least = w[i] < least ? w[i] : least;
        w[i] = w[i] > 0 ? w[i] : 0;
        sum += w[i];
    }
    assert_true(least < -0.05);
    for (int k = 0; k < 3; k++) {
        double mean = 0;
        for (int i = 0; i < 5; i++)
            mean += w[i] / sum * (double)points[3 * (i + 1) + k];
        want[k] = (double)points[k] + 0.5 * (mean - (double)points[k]);
        want[k] -= 0.53 * (mean - want[k]);
    }
    assert_int_equal(vsf_mesh_build(NULL, &desc, &mesh), LAO_OK);
    assert_int_equal(vsf_mesh_smooth(NULL, &mesh, &once), LAO_OK);
    for (int k = 0; k < 3; k++)
        near_to((double)mesh.positions[k], want[k], 1e-6);
    vsf_mesh_free(&mesh);
}

static void smoothing_refuses_and_stops(void **state) {
    surface_shape sphere = surface_sphere(1, 1);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh mesh = surface_build(&sphere, 0, 0);
    vsf_smooth_desc desc = {1, 0.5, -0.4, 0};
    (void)state;
    assert_int_equal(vsf_mesh_smooth(&h, &mesh, &desc), LAO_ERROR_INVALID_ARGUMENT);
    desc.mu = NAN;
    assert_int_equal(vsf_mesh_smooth(&h, &mesh, &desc), LAO_ERROR_INVALID_ARGUMENT);
    desc.lambda = -1;
    assert_int_equal(vsf_mesh_smooth(&h, &mesh, &desc), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_SETTING);
    host.cancel_at = 10;
    assert_int_equal(vsf_mesh_smooth(&h, &mesh, NULL), LAO_ERROR_NOT_READY);
    assert_memory_equal(mesh.positions, sphere.positions, 12 * mesh.vertex_count);
    assert_int_equal(host.memory.bytes, 0);
    vsf_mesh_free(&mesh);
    surface_shape_free(&sphere);
}

/* ---- subdivision */

static void subdivision_is_loops(void **state) {
    surface_shape ico = surface_sphere(1, 0), plane = surface_saddle(0, 4, 9);
    float values[81];
    vsf_attribute attribute = {"x", 1, values};
    vsf_mesh mesh = surface_build(&ico, 0, 0), finer;
    vsf_mesh_desc desc;
    (void)state;
    assert_int_equal(vsf_mesh_subdivide(NULL, &mesh, 3, &finer), LAO_OK);
    assert_int_equal(finer.triangle_count, 20 * 64);
    assert_int_equal(finer.vertex_count, 642);
    assert_int_equal(finer.info.open_edges, 0);
    check_topology(&finer);
    for (uint32_t v = 12; v < 642; v++)
        assert_int_equal(finer.vertex_sources[v], VSF_NONE);
    assert_int_equal(finer.vertex_sources[11], 11);
    assert_int_equal(finer.triangle_sources[1279], 19);
    vsf_mesh_free(&finer);
    assert_int_equal(vsf_mesh_subdivide(NULL, &mesh, 1, &finer), LAO_OK);
    {
        /* valence 5: p (1 - 5 b) + b sum of neighbours, b = 3 / 40, their sum is sqrt(5) p */
        double f = 1 - 0.375 + 0.375 / 5 * sqrt(5.0);
        for (uint32_t i = 0; i < 36; i++)
            near_to((double)finer.positions[i], f * (double)ico.positions[i], 2e-7);
    }
    vsf_mesh_free(&finer);
    vsf_mesh_free(&mesh);
    for (uint32_t i = 0; i < 81; i++)
        values[i] = plane.positions[3 * i];
    desc = surface_describe(&plane);
    desc.attributes = &attribute;
    desc.attribute_count = 1;
    assert_int_equal(vsf_mesh_build(NULL, &desc, &mesh), LAO_OK);
    assert_int_equal(vsf_mesh_subdivide(NULL, &mesh, 2, &finer), LAO_OK);
    assert_int_equal(finer.vertex_count, 33 * 33);
    check_topology(&finer);
    for (uint32_t v = 0; v < finer.vertex_count; v++) {
        assert_true(finer.positions[3 * v + 2] == 0);
        if (!finer.borders[v]) /* regular: linear functions are reproduced inside */
            near_to((double)finer.positions[3 * v], (double)finer.attributes[0].values[v], 0.26);
    }
    /* the box but for the rounded corners */
    assert_true(finer.info.bounds[0][0] == mesh.info.bounds[0][0]);
    assert_true(finer.info.bounds[1][1] == mesh.info.bounds[1][1]);
    vsf_mesh_free(&finer);
    assert_int_equal(vsf_mesh_subdivide(NULL, &mesh, 0, &finer), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(vsf_mesh_subdivide(NULL, &mesh, 9, &finer), LAO_ERROR_INVALID_ARGUMENT);
    vsf_mesh_free(&mesh);
    surface_shape_free(&plane);
    surface_shape_free(&ico);
}

/* ---- decimation */

/* The distance (mm) to a torus of these radii around z. */
static double off_torus(const float *p, double ring, double tube) {
    double r = hypot((double)p[0], (double)p[1]) - ring;
    return hypot(r, (double)p[2]) - tube;
}

static void decimation_keeps_the_shape(void **state) {
    static const uint32_t most[3] = {20000, 4000, 800};
    surface_shape shape = surface_torus(5, 2, 200, 100);
    const uint32_t n = shape.vertex_count;
    float *values = (float *)malloc(2 * sizeof(float) * n);
    vsf_attribute attribute = {"x and, of few, y", 2, values};
    vsf_mesh_desc desc = surface_describe(&shape);
    vsf_mesh mesh, coarser;
    (void)state;
    for (uint32_t i = 0; i < n; i++) {
        values[2 * i] = shape.positions[3 * i];
        values[2 * i + 1] = i % 7 ? NAN : shape.positions[3 * i + 1];
    }
    desc.attributes = &attribute;
    desc.attribute_count = 1;
    assert_int_equal(vsf_mesh_build(NULL, &desc, &mesh), LAO_OK);
    for (int i = 0; i < 3; i++) {
        double worst = 0, side;
        assert_int_equal(vsf_mesh_decimate(NULL, &mesh, most[i], &coarser), LAO_OK);
        assert_in_range(coarser.triangle_count, most[i] * 7 / 10, most[i]);
        check_topology(&coarser);
        assert_int_equal(coarser.info.open_edges + coarser.info.crowded_edges, 0);
        assert_int_equal(coarser.info.parts, 1);
        assert_true(fabs(coarser.info.area / mesh.info.area - 1) < 0.01);
        assert_true(fabs(coarser.info.volume / mesh.info.volume - 1) < 0.03);
        assert_int_equal(coarser.source_count, 0);
        side = coarser.info.mean_edge;
        for (uint32_t v = 0; v < coarser.vertex_count; v++) {
            const float *p = coarser.positions + 3 * v, *value = coarser.attributes[0].values;
            uint32_t from = coarser.vertex_sources[v];
            assert_true(from < n);
            worst = fmax(worst, fabs(off_torus(p, 5, 2)));
            assert_true(fabs((double)p[0] - (double)shape.positions[3 * from]) < 2 * side);
            assert_true(fabs((double)value[2 * v] - (double)p[0]) < side);
            assert_true(!(fabs((double)value[2 * v + 1] - (double)p[1]) > 2 * side));
        }
        for (uint32_t t = 0; t < coarser.triangle_count; t++)
            assert_true(coarser.triangle_sources[t] < mesh.triangle_count);
        assert_true(worst < side * side / 16); /* the sag of an edge over the tube: side^2 / 8 R */
        vsf_mesh_free(&coarser);
    }
    vsf_mesh_free(&mesh);
    surface_shape_free(&shape);
    free(values);
}

static void decimation_of_planes_and_faults(void **state) {
    surface_shape plane = surface_saddle(0, 2, 40);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh mesh = surface_build(&plane, 0, 0), coarser;
    (void)state;
    assert_int_equal(vsf_mesh_decimate(&h, &mesh, 500, &coarser), LAO_OK);
    for (uint32_t v = 0; v < coarser.vertex_count; v++)
        assert_true(fabsf(coarser.positions[3 * v + 2]) < 1e-6f &&
                    coarser.normals[3 * v + 2] > 0.999f);
    assert_int_equal(host.failures, 0);
    vsf_mesh_free(&coarser);
    assert_int_equal(vsf_mesh_decimate(&h, &mesh, 3, &coarser), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, VSF_LOG_SETTING);
    assert_int_equal(vsf_mesh_decimate(&h, NULL, 100, &coarser), LAO_ERROR_INVALID_ARGUMENT);
    h = surface_host_make(&host);
    host.cancel_at = 3;
    assert_int_equal(vsf_mesh_decimate(&h, &mesh, 100, &coarser), LAO_ERROR_NOT_READY);
    assert_int_equal(host.item, VSF_LOG_CANCELLED);
    assert_int_equal(host.memory.bytes, 0);
    vsf_mesh_free(&mesh);
    surface_shape_free(&plane);
}

/* ---- memory, cancelling, order of work, size */

static void survives_every_failed_allocation(void **state) {
    surface_shape shape = surface_torus(5, 2, 20, 10);
    vsf_mesh_desc desc = surface_describe(&shape);
    (void)state;
    for (uint32_t n = 1;; n++) {
        lent_host host;
        vsf_host h = surface_host_make(&host);
        vsf_mesh mesh, finer, coarser;
        vsf_buffers buffers;
        vsf_polylines lines;
        const float eye[4] = {0, 0, 1, 0};
        lao_result result;
        memset(&mesh, 0, sizeof mesh);
        memset(&finer, 0, sizeof finer);
        memset(&coarser, 0, sizeof coarser);
        memset(&buffers, 0, sizeof buffers);
        memset(&lines, 0, sizeof lines);
        host.memory.fail_allocation = n;
        result = vsf_mesh_build(&h, &desc, &mesh);
        if (result == LAO_OK)
            result = vsf_mesh_smooth(&h, &mesh, NULL);
        if (result == LAO_OK)
            result = vsf_mesh_subdivide(&h, &mesh, 2, &finer);
        if (result == LAO_OK)
            result = vsf_mesh_decimate(&h, &finer, 1000, &coarser);
        if (result == LAO_OK)
            result = vsf_buffers_make(&h, &finer, 0, &buffers);
        if (result == LAO_OK)
            result =
                vsf_feature_lines(&h, &finer, &buffers, eye, VSF_SUGGESTIVE_CONTOURS, 0, &lines);
        vsf_polylines_free(&lines);
        vsf_buffers_free(&buffers);
        vsf_mesh_free(&coarser);
        vsf_mesh_free(&finer);
        vsf_mesh_free(&mesh);
        assert_int_equal(host.memory.bytes, 0);
        if (result == LAO_OK) {
            assert_true(n > 10);
            break;
        }
        assert_int_equal(result, LAO_ERROR_OUT_OF_MEMORY);
        assert_int_equal(host.item, VSF_LOG_MEMORY);
        assert_int_equal(host.failures, 1);
    }
    surface_shape_free(&shape);
}

static void cancels_and_ignores_the_order_of_work(void **state) {
    surface_shape shape = surface_torus(5, 2, 200, 100);
    vsf_mesh_desc desc = surface_describe(&shape);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh serial, mesh;
    (void)state;
    assert_int_equal(vsf_mesh_build(NULL, &desc, &serial), LAO_OK);
    host.backwards = 1;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    assert_int_equal(host.done, host.total);
    assert_memory_equal(mesh.normals, serial.normals, 12 * mesh.vertex_count);
    assert_memory_equal(mesh.areas, serial.areas, 8 * mesh.vertex_count);
    vsf_mesh_free(&mesh);
    for (uint32_t n = 1; n <= 4; n++) {
        h = surface_host_make(&host);
        host.cancel_at = n;
        assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_ERROR_NOT_READY);
        assert_int_equal(host.item, VSF_LOG_CANCELLED);
        assert_int_equal(host.memory.bytes, 0);
    }
    vsf_mesh_free(&serial);
    surface_shape_free(&shape);
}

static void a_fan_of_many_triangles(void **state) {
    /* one vertex with 70,000 neighbours: linear work, and too many for a device */
    const uint32_t n = 70000;
    float *points = (float *)malloc(3 * sizeof(float) * (n + 1));
    uint32_t *triangles = (uint32_t *)malloc(3 * sizeof(uint32_t) * n);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh_desc desc;
    vsf_mesh mesh;
    vsf_buffers buffers;
    (void)state;
    memset(points, 0, 12);
    for (uint32_t i = 0; i < n; i++) {
        points[3 * i + 3] = cosf((float)i * 6.2831853f / (float)n);
        points[3 * i + 4] = sinf((float)i * 6.2831853f / (float)n);
        points[3 * i + 5] = 0.5f;
        triangles[3 * i] = 0;
        triangles[3 * i + 1] = i + 1;
        triangles[3 * i + 2] = (i + 1) % n + 1;
    }
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = n + 1;
    desc.positions = points;
    desc.triangle_count = n;
    desc.triangles = triangles;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    assert_int_equal(vsf_mesh_smooth(&h, &mesh, NULL), LAO_OK);
    assert_int_equal(vsf_buffers_make(&h, &mesh, 0, &buffers), LAO_ERROR_UNSUPPORTED);
    assert_int_equal(host.item, VSF_LOG_MESH_DEVICE);
    assert_non_null(strstr(host.text, "decimate it"));
    vsf_mesh_free(&mesh);
    assert_int_equal(host.memory.bytes, 0);
    free(points);
    free(triangles);
}

static void says_what_a_device_cannot_take(void **state) {
    surface_shape shape = surface_torus(5, 2, 100, 50);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh mesh = surface_build(&shape, 0, 0);
    vsf_buffers buffers;
    (void)state;
    assert_int_equal(vsf_buffers_make(&h, &mesh, 29999, &buffers), LAO_ERROR_UNSUPPORTED);
    assert_non_null(strstr(host.text, "10000 triangles need a buffer of 30000 texels, the device "
                                      "has 29999; about 9999 triangles would fit"));
    assert_int_equal(host.memory.allocations, 0);
    assert_int_equal(vsf_buffers_make(&h, &mesh, 30000, &buffers), LAO_OK);
    vsf_buffers_free(&buffers);
    assert_int_equal(host.memory.bytes, 0);
    vsf_mesh_free(&mesh);
    surface_shape_free(&shape);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gradients_of_linear_functions),
        cmocka_unit_test(mixed_areas),
        cmocka_unit_test(least_turns),
        cmocka_unit_test(welds_what_is_in_one_place),
        cmocka_unit_test(turns_what_runs_the_wrong_way),
        cmocka_unit_test(names_what_it_cannot_mend),
        cmocka_unit_test(refuses_what_is_no_mesh),
        cmocka_unit_test(keeps_attributes_and_given_normals),
        cmocka_unit_test(smoothing_has_its_transfer),
        cmocka_unit_test(smoothing_keeps_volume_planes_and_borders),
        cmocka_unit_test(smoothing_takes_no_negative_weight),
        cmocka_unit_test(smoothing_refuses_and_stops),
        cmocka_unit_test(subdivision_is_loops),
        cmocka_unit_test(decimation_keeps_the_shape),
        cmocka_unit_test(decimation_of_planes_and_faults),
        cmocka_unit_test(survives_every_failed_allocation),
        cmocka_unit_test(cancels_and_ignores_the_order_of_work),
        cmocka_unit_test(a_fan_of_many_triangles),
        cmocka_unit_test(says_what_a_device_cannot_take),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
