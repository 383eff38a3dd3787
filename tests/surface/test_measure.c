/* Proves that the suggestive-contour measure is the curvature towards the viewer times the squared
   sine of the angle to the view, on spheres, cylinders, tori, saddles and planes, for both kinds of
   camera; that the buffers' gradient is that of L14's formulas; and that principal curvatures and
   feature lines are where geometry puts them. */
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

static double dot(const float *a, const double *b) {
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}
/* From vertex v to the eye (not unit), and its part w across the true normal. */
static void view_of(const surface_shape *s, uint32_t v, const float eye[4], double view[3],
                    double w[3]) {
    double l = 0;
    for (uint32_t k = 0; k < 3; k++) {
        view[k] = (double)eye[k] - (double)eye[3] * (double)s->positions[3 * v + k];
        l += view[k] * (double)s->normals[3 * v + k];
    }
    for (uint32_t k = 0; k < 3; k++)
        w[k] = view[k] - l * (double)s->normals[3 * v + k];
}
static double length2(const double v[3]) {
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

typedef struct fixture {
    surface_shape shape;
    vsf_mesh mesh;
    vsf_buffers buffers;
    float *s;
} fixture;
static fixture fixture_make(surface_shape shape, uint32_t flags, int analytic) {
    fixture f;
    f.shape = shape;
    f.mesh = surface_build(&shape, flags, analytic);
    assert_int_equal(f.mesh.vertex_count, shape.vertex_count);
    assert_int_equal(vsf_buffers_make(NULL, &f.mesh, 0, &f.buffers), LAO_OK);
    assert_true(shape.vertex_count > 0);
    f.s = (float *)malloc(sizeof(float) * ((size_t)shape.vertex_count + 1));
    assert_non_null(f.s);
    return f;
}
static void fixture_free(fixture *f) {
    free(f->s);
    vsf_buffers_free(&f->buffers);
    vsf_mesh_free(&f->mesh);
    surface_shape_free(&f->shape);
}
static void measure(fixture *f, const float eye[4], uint32_t flags) {
    assert_int_equal(vsf_measure(NULL, &f->buffers, eye, flags, f->s), LAO_OK);
}

/* ---- the oracles of METHODS 10.3 */

static void on_a_sphere(fixture *f, const float eye[4], double radius, uint32_t flags, double *most,
                        double *mean) {
    *most = *mean = 0;
    measure(f, eye, flags);
    for (uint32_t v = 0; v < f->shape.vertex_count; v++) {
        double view[3], w[3], error;
        view_of(&f->shape, v, eye, view, w);
        error = fabs((double)f->s[v] - length2(w) / length2(view) / radius);
        *most = error > *most ? error : *most;
        *mean += error / f->shape.vertex_count;
    }
}
static void spheres(void **state) {
    static const float eyes[4][4] = {
        {6, 0, 0, 1}, {3, -4, 3.3f, 1}, {0, 0, 1, 0}, {0.6f, 0.48f, 0.64f, 0}};
    fixture exact = fixture_make(surface_sphere(2, 4), 0, 1);
    fixture plain = fixture_make(surface_sphere(2, 4), 0, 0);
    double most, mean, naive;
    (void)state;
    for (int i = 0; i < 4; i++) {
        on_a_sphere(&exact, eyes[i], 2, 0, &most, &mean);
        printf("sphere, camera %d: analytic normals max %.2e mean %.2e", i, most, mean);
        assert_true(most <= 3e-3);
        assert_true(mean <= 4.5e-4);
        on_a_sphere(&plain, eyes[i], 2, 0, &most, &mean);
        printf(", area-weighted max %.2e mean %.2e\n", most, mean);
        assert_true(most <= (i ? 3.5e-2 : 3.1e-2)); /* METHODS states the first camera's */
        assert_true(mean <= (i ? 4.8e-3 : 4.65e-3));
    }
    /* the naive view vectors are biased up to 0.084, and agree for an orthographic camera */
    on_a_sphere(&exact, eyes[0], 2, VSF_VIEW_NORMALIZED, &naive, &mean);
    near_to(naive, 0.084, 5e-3);
    on_a_sphere(&exact, eyes[2], 2, VSF_VIEW_NORMALIZED, &naive, &mean);
    assert_true(naive <= 3e-3);
    fixture_free(&exact);
    fixture_free(&plain);
}

static void inward_sphere(void **state) {
    const float eye[4] = {6, 0, 0, 1};
    fixture f;
    surface_shape shape = surface_sphere(2, 4);
    double most, mean;
    (void)state;
    for (uint32_t i = 0; i < 3 * shape.vertex_count; i++)
        shape.normals[i] = -shape.normals[i];
    f = fixture_make(shape, VSF_MESH_FLIP, 1);
    on_a_sphere(&f, eye, -2, 0, &most, &mean);
    assert_true(most <= 3e-3);
    fixture_free(&f);
}

static void planes(void **state) {
    static const float eyes[2][4] = {{1, 2, 3, 1}, {0.48f, 0.64f, 0.6f, 0}};
    fixture f = fixture_make(surface_saddle(0, 5, 30), 0, 0);
    (void)state;
    for (int i = 0; i < 2; i++) {
        measure(&f, eyes[i], 0);
        for (uint32_t v = 0; v < f.shape.vertex_count; v++)
            near_to((double)f.s[v], 0, 2e-7); /* n.v itself is rounded */
    }
    fixture_free(&f);
}

static void cylinders(void **state) {
    /* s = (part of v along the circumference)^2 / R, for every azimuth and angle to the axis */
    fixture f = fixture_make(surface_cylinder(2, 10, 180, 60), 0, 1);
    (void)state;
    for (int i = 0; i <= 6; i++) {
        double angle = 0.15 + 0.2 * i;
        const float eye[4] = {(float)(sin(angle) * 0.8), (float)(sin(angle) * 0.6),
                              (float)cos(angle), 0};
        measure(&f, eye, 0);
        for (uint32_t v = 0; v < f.shape.vertex_count; v++) {
            const float *n = f.shape.normals + 3 * v;
            double around = -(double)n[1] * (double)eye[0] + (double)n[0] * (double)eye[1];
            if (!f.mesh.borders[v])
                near_to((double)f.s[v], around * around / 2, 1.5e-3);
        }
    }
    fixture_free(&f);
}

static void tori(void **state) {
    /* curvatures 1 / r along the tube and cos b / (R + r cos b) around the axis */
    static const float eyes[2][4] = {{9, 5, 6, 1}, {0.48f, 0.64f, 0.6f, 0}};
    fixture f = fixture_make(surface_torus(5, 2, 240, 120), 0, 1);
    int negative = 0;
    (void)state;
    for (int i = 0; i < 2; i++) {
        measure(&f, eyes[i], 0);
        for (uint32_t v = 0; v < f.shape.vertex_count; v++) {
            const float *p = f.shape.positions + 3 * v, *n = f.shape.normals + 3 * v;
            double ring = sqrt((double)(p[0] * p[0] + p[1] * p[1])), view[3], w[3], a, b, want;
            double around[3] = {-(double)p[1] / ring, (double)p[0] / ring, 0};
            double cosine = (ring - 5) / 2;
            view_of(&f.shape, v, eyes[i], view, w);
            (void)n;
            a = w[0] * around[0] + w[1] * around[1];
            b = length2(w) - a * a;
            want = (a * a * cosine / ring + b / 2) / length2(view);
            near_to((double)f.s[v], want, 2e-3);
            negative += f.s[v] < 0;
        }
    }
    assert_true(negative > 100); /* the inner side is concave along the ring */
    fixture_free(&f);
}

static void saddles(void **state) {
    /* z = a x y seen along z: n.v = 1 / sqrt(1 + a^2 r^2) and s = w . grad(n.v) on the surface */
    const double a = 0.1;
    const float eye[4] = {0, 0, 1, 0};
    fixture f = fixture_make(surface_saddle(a, 4, 121), 0, 1);
    int signs[2] = {0, 0};
    (void)state;
    measure(&f, eye, 0);
    for (uint32_t v = 0; v < f.shape.vertex_count; v++) {
        const float *p = f.shape.positions + 3 * v;
        double x = (double)p[0], y = (double)p[1], g = 1 + a * a * (x * x + y * y);
        /* w points along grad z on the surface: -(dz/dx, dz/dy) reversed. Curvature along
           t = (y, x): II = -(2 a x y) / sqrt(g), positive convex */
        double want = -2 * a * (a * y) * (a * x) / (g * g * sqrt(g));
        if (f.mesh.borders[v])
            continue;
        near_to((double)f.s[v], want, 1e-4);
        if (fabs(x * y) > 0.5) /* changes sign across the asymptotic directions, the axes */
            assert_true((f.s[v] > 0) == (x * y < 0));
        signs[f.s[v] > 0]++;
    }
    assert_true(signs[0] > 1000 && signs[1] > 1000);
    fixture_free(&f);
}

/* ---- L14's formulas, face by face, in double precision */

static void literal_measure(const vsf_mesh *m, const float eye[4], double *s) {
    double *l = (double *)malloc(sizeof(double) * m->vertex_count), n[3], t[3][3], g[3], turned[3];
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        l[v] = 0;
        for (uint32_t k = 0; k < 3; k++)
            l[v] += (double)m->normals[3 * v + k] *
                    ((double)eye[k] - (double)eye[3] * (double)m->positions[3 * v + k]);
    }
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        double sum[3] = {0, 0, 0}, total = 0, view[3], w[3], areas[3];
        for (uint32_t k = 0; k < 3; k++) {
            n[k] = (double)m->normals[3 * v + k];
            view[k] = (double)eye[k] - (double)eye[3] * (double)m->positions[3 * v + k];
        }
        for (uint32_t k = 0; k < 3; k++)
            w[k] = view[k] - n[k] * (n[0] * view[0] + n[1] * view[1] + n[2] * view[2]);
        for (uint32_t f = 0; f < m->triangle_count; f++) {
            const uint32_t *c = m->triangles + 3 * f;
            double values[3], face[3], length, e1[3], e2[3];
            int at = c[0] == v ? 0 : c[1] == v ? 1 : c[2] == v ? 2 : -1;
            if (at < 0)
                continue;
            for (int i = 0; i < 3; i++) {
                values[i] = l[c[i]];
                for (int k = 0; k < 3; k++)
                    t[i][k] = (double)m->positions[3 * c[i] + (uint32_t)k];
            }
            for (int k = 0; k < 3; k++) {
                e1[k] = t[1][k] - t[0][k];
                e2[k] = t[2][k] - t[0][k];
            }
            face[0] = e1[1] * e2[2] - e1[2] * e2[1];
            face[1] = e1[2] * e2[0] - e1[0] * e2[2];
            face[2] = e1[0] * e2[1] - e1[1] * e2[0];
            length = sqrt(length2(face));
            for (int k = 0; k < 3; k++)
                face[k] /= length;
            vsf_triangle_gradient(t[0], t[1], t[2], values, g);
            if (vsf_turn(face, n, g, turned))
                continue;
            vsf_corner_areas(t[0], t[1], t[2], areas);
            total += areas[at];
            for (int k = 0; k < 3; k++)
                sum[k] += areas[at] * turned[k];
        }
        s[v] = 0;
        for (int k = 0; k < 3 && total > 0; k++)
            s[v] += w[k] * sum[k] / total / length2(view);
    }
    free(l);
}

static void rings_are_the_printed_formulas(void **state) {
    static const float eyes[2][4] = {{14, 3, 5, 1}, {0.48f, 0.64f, 0.6f, 0}};
    surface_shape shape = surface_torus(5, 2, 24, 12);
    uint32_t seed = 8;
    (void)state;
    for (uint32_t i = 0; i < 3 * shape.vertex_count; i++) /* obtuse, uneven triangles */
        shape.positions[i] += (float)lent_between(&seed, -0.35, 0.35);
    shape.triangle_count -= 40; /* and a border */
    {
        fixture f = fixture_make(shape, 0, 0);
        double *want = (double *)malloc(sizeof(double) * f.mesh.vertex_count);
        for (int i = 0; i < 2; i++) {
            measure(&f, eyes[i], 0);
            literal_measure(&f.mesh, eyes[i], want);
            for (uint32_t v = 0; v < f.mesh.vertex_count; v++)
                near_to((double)f.s[v], want[v], 5e-6 * (1 + fabs(want[v])));
        }
        /* each neighbour once: 2 edges' ends, and every entry names one */
        assert_int_equal(f.buffers.ring_count, 2 * f.mesh.info.edges);
        for (uint32_t v = 0; v < f.mesh.vertex_count; v++) {
            float pw = f.buffers.points[4 * v + 3], nw = f.buffers.normals[4 * v + 3];
            uint32_t start = vsf_ring_start(pw, nw), end = start + vsf_ring_count(nw);
            assert_true(end <= f.buffers.ring_count);
            for (uint32_t i = start; i < end; i++) {
                uint32_t other = (uint32_t)f.buffers.rings[4 * i + 3];
                assert_true(other < f.mesh.vertex_count && other != v);
                for (uint32_t j = start; j < i; j++)
                    assert_true(f.buffers.rings[4 * j + 3] != f.buffers.rings[4 * i + 3]);
            }
        }
        free(want);
        fixture_free(&f);
    }
}

static void gradients_of_linear_functions(void **state) {
    /* of a.x: the part of a across the normal, on a plane exactly */
    fixture f = fixture_make(surface_saddle(0, 5, 30), 0, 0);
    float values[900], g[2700];
    (void)state;
    for (uint32_t v = 0; v < 900; v++)
        values[v] = 2 * f.shape.positions[3 * v] - 3 * f.shape.positions[3 * v + 1] + 1;
    assert_int_equal(vsf_gradients(NULL, &f.buffers, values, g), LAO_OK);
    for (uint32_t v = 0; v < 900; v++) {
        near_to((double)g[3 * v], 2, 2e-5);
        near_to((double)g[3 * v + 1], -3, 2e-5);
        near_to((double)g[3 * v + 2], 0, 1e-6);
    }
    fixture_free(&f);
}

/* ---- invariance (METHODS 17.13) */

static void moves_and_scales(void **state) {
    const float eye[4] = {9, 5, 6, 1};
    /* a turn about (1, 2, 3), by Rodrigues, in double */
    const double c = cos(1.0), s = sin(1.0), q = sqrt(14.0);
    const double u[3] = {1 / q, 2 / q, 3 / q};
    fixture f = fixture_make(surface_torus(5, 2, 60, 30), 0, 0), moved, scaled;
    surface_shape turned = surface_torus(5, 2, 60, 30), large = surface_torus(5, 2, 60, 30);
    float to[4] = {0, 0, 0, 1};
    (void)state;
    for (uint32_t i = 0; i <= turned.vertex_count; i++) {
        float *p = i < turned.vertex_count ? turned.positions + 3 * i : to;
        const float *from = i < turned.vertex_count ? f.shape.positions + 3 * i : eye;
        double along = dot(from, u);
        double across[3] = {u[1] * (double)from[2] - u[2] * (double)from[1],
                            u[2] * (double)from[0] - u[0] * (double)from[2],
                            u[0] * (double)from[1] - u[1] * (double)from[0]};
        for (int k = 0; k < 3; k++)
            p[k] = (float)(c * (double)from[k] + s * across[k] + (1 - c) * along * u[k] + 3);
    }
    for (uint32_t i = 0; i < 3 * large.vertex_count; i++)
        large.positions[i] *= 4;
    moved = fixture_make(turned, 0, 0);
    scaled = fixture_make(large, 0, 0);
    measure(&f, eye, 0);
    measure(&moved, to, 0);
    {
        const float far_eye[4] = {36, 20, 24, 1};
        measure(&scaled, far_eye, 0);
    }
    for (uint32_t v = 0; v < f.mesh.vertex_count; v++) {
        near_to((double)moved.s[v], (double)f.s[v], 1e-5);
        near_to(4 * (double)scaled.s[v], (double)f.s[v], 1e-6); /* 1 / length */
    }
    fixture_free(&f);
    fixture_free(&moved);
    fixture_free(&scaled);
}

static void eyes_of_cameras(void **state) {
    /* view = scale * turn about y * mirror x, translated */
    const float c = 0.6f, s = 0.8f, k = 2.0f;
    lao_m4 m;
    lao_v4 eye;
    lao_v3 back;
    (void)state;
    m.x = lao_v4_make(-k * c, 0, -k * s, 0);
    m.y = lao_v4_make(0, k, 0, 0);
    m.z = lao_v4_make(-k * s, 0, k * c, 0);
    m.w = lao_v4_make(3, -4, -7, 1);
    eye = vsf_eye(m, 0.0f);
    assert_true(eye.w == 1.0f);
    back = lao_transform(m, lao_v3_make(eye.x, eye.y, eye.z)); /* the eye is at 0 of view space */
    assert_true(fabsf(back.x) < 1e-5f && fabsf(back.y) < 1e-5f && fabsf(back.z) < 1e-5f);
    eye = vsf_eye(m, 1.0f);
    assert_true(eye.w == 0.0f);
    near_to((double)(eye.x * eye.x + eye.y * eye.y + eye.z * eye.z), 1, 1e-6);
    m.w = lao_v4_make(0, 0, 0, 1); /* moving towards the eye raises z */
    back = lao_transform(m, lao_v3_make(eye.x, eye.y, eye.z));
    near_to((double)back.z, 2, 1e-6);
}

static void degenerate_eyes_and_vertices(void **state) {
    static const float points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 5, 5, 5};
    static const uint32_t triangles[] = {0, 1, 2, 1, 3, 2}; /* a leaf with two sides: normals 0 */
    const float at_vertex[4] = {0, 0, 0, 1}, bad[4] = {NAN, 0, 0, 1}, half[4] = {0, 0, 0, 0.5f};
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_mesh_desc desc;
    vsf_mesh mesh;
    vsf_buffers buffers;
    float s[4] = {7, 7, 7, 7};
    (void)state;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = 5;
    desc.positions = points;
    desc.triangle_count = 2;
    desc.triangles = triangles;
    desc.flags = VSF_MESH_KEEP_WINDING;
    assert_int_equal(vsf_mesh_build(&h, &desc, &mesh), LAO_OK);
    assert_int_equal(vsf_buffers_make(&h, &mesh, 0, &buffers), LAO_OK);
    assert_int_equal(vsf_measure(&h, &buffers, at_vertex, 0, s), LAO_OK);
    for (int i = 0; i < 4; i++)
        assert_true(s[i] == 0);
    assert_int_equal(vsf_measure(&h, &buffers, bad, 0, s), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(vsf_measure(&h, &buffers, half, 0, s), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(vsf_measure(&h, NULL, half, 0, s), LAO_ERROR_INVALID_ARGUMENT);
    vsf_buffers_free(&buffers);
    vsf_mesh_free(&mesh);
    assert_int_equal(host.memory.bytes, 0);
}

static void buffers_describe_an_object(void **state) {
    fixture f = fixture_make(surface_torus(5, 2, 60, 30), 0, 0);
    lao_object_buffer list[4];
    lao_object_desc desc;
    uint32_t count;
    const lao_buffer_row *rows = vsf_buffer_rows(&count);
    (void)state;
    vsf_buffers_describe(&f.buffers, list, &desc);
    assert_int_equal(count, 7);
    assert_int_equal(desc.item_count, 1800);
    assert_int_equal(desc.triangle_count, 3600);
    assert_int_equal(desc.buffer_count, 4);
    for (int i = 0; i < 4; i++) {
        assert_string_equal(list[i].name, rows[i].name);
        assert_int_equal(rows[i].format, LAO_FORMAT_RGBA32F);
    }
    assert_int_equal(list[2].texel_count, 6 * 1800);
    for (uint32_t t = 0; t < 3600; t++)
        for (uint32_t k = 0; k < 3; k++)
            assert_int_equal((uint32_t)f.buffers.triangles[4 * t + k], f.mesh.triangles[3 * t + k]);
    near_to((double)desc.bounds[1][0], 7, 1e-5);
    fixture_free(&f);
}

static void ring_numbers_survive_floats(void **state) {
    static const uint32_t starts[] = {0, 1, 255, 256, 16777215, 16777217, 100000007, 4294967295u};
    (void)state;
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        float p = (float)(starts[i] >> 8), n = (float)((starts[i] & 255u) * 65536u + 65535u);
        assert_int_equal(vsf_ring_start(p, n), starts[i]);
        assert_int_equal(vsf_ring_count(n), 65535);
    }
}

static void order_of_work_does_not_matter(void **state) {
    fixture f = fixture_make(surface_torus(5, 2, 150, 100), 0, 0);
    lent_host host;
    vsf_host h = surface_host_make(&host);
    vsf_buffers other;
    const float eye[4] = {9, 5, 6, 1};
    float *s = (float *)malloc(4 * 15000);
    (void)state;
    host.backwards = 1;
    assert_int_equal(vsf_buffers_make(&h, &f.mesh, 0, &other), LAO_OK);
    assert_memory_equal(other.rings, f.buffers.rings, 16 * other.ring_count);
    measure(&f, eye, 0);
    assert_int_equal(vsf_measure(&h, &other, eye, 0, s), LAO_OK);
    assert_memory_equal(s, f.s, 4 * 15000);
    host.progress_calls = 0;
    host.cancel_at = 1;
    assert_int_equal(vsf_measure(&h, &other, eye, 0, s), LAO_ERROR_NOT_READY);
    vsf_buffers_free(&other);
    assert_int_equal(host.memory.bytes, 0);
    free(s);
    fixture_free(&f);
}

/* ---- principal curvatures */

static void curvatures_of_known_shapes(void **state) {
    fixture sphere = fixture_make(surface_sphere(2, 4), 0, 1);
    fixture torus = fixture_make(surface_torus(5, 2, 240, 120), 0, 1);
    fixture saddle = fixture_make(surface_saddle(0.1, 4, 81), 0, 1);
    float *k = (float *)malloc(8 * 30000), *d = (float *)malloc(12 * 30000);
    (void)state;
    assert_int_equal(vsf_curvatures(NULL, &sphere.mesh, k, NULL), LAO_OK);
    for (uint32_t v = 0; v < 2 * sphere.mesh.vertex_count; v++)
        near_to((double)k[v], 0.5, 2e-3);
    assert_int_equal(vsf_curvatures(NULL, &torus.mesh, k, d), LAO_OK);
    for (uint32_t v = 0; v < torus.mesh.vertex_count; v++) {
        const float *p = torus.shape.positions + 3 * v;
        double ring = sqrt((double)(p[0] * p[0] + p[1] * p[1]));
        double around[3] = {-(double)p[1] / ring, (double)p[0] / ring, 0};
        near_to((double)k[2 * v], 0.5, 2e-3);
        near_to((double)k[2 * v + 1], (ring - 5) / 2 / ring, 2e-3);
        near_to(dot(d + 3 * v, around), 0, 2e-3); /* the first runs around the tube */
        near_to((double)(d[3 * v] * d[3 * v] + d[3 * v + 1] * d[3 * v + 1] +
                         d[3 * v + 2] * d[3 * v + 2]),
                1, 1e-6);
    }
    assert_int_equal(vsf_curvatures(NULL, &saddle.mesh, k, d), LAO_OK);
    for (uint32_t v = 0; v < saddle.mesh.vertex_count; v++) {
        const float *p = saddle.shape.positions + 3 * v;
        double x = (double)p[0], y = (double)p[1], a = 0.1, g = 1 + a * a * (x * x + y * y);
        double gauss = -a * a / (g * g), mean = a * a * a * x * y / (g * sqrt(g)); /* outward: + */
        if (saddle.mesh.borders[v])
            continue;
        near_to((double)k[2 * v] * (double)k[2 * v + 1], gauss, 2e-4);
        near_to(0.5 * ((double)k[2 * v] + (double)k[2 * v + 1]), mean, 2e-4);
    }
    free(k);
    free(d);
    fixture_free(&sphere);
    fixture_free(&torus);
    fixture_free(&saddle);
}

/* ---- feature lines */

static void contours_of_a_sphere(void **state) {
    /* orthographic along z: the equator, one closed line; none of the suggestive kind */
    const float eye[4] = {0, 0, 1, 0}, close[4] = {0, 0, 4, 1};
    fixture f = fixture_make(surface_sphere(2, 4), 0, 1);
    vsf_polylines lines;
    (void)state;
    assert_int_equal(vsf_feature_lines(NULL, &f.mesh, &f.buffers, eye, VSF_CONTOURS, 0, &lines),
                     LAO_OK);
    assert_int_equal(lines.line_count, 1);
    assert_int_equal(lines.offsets[1], lines.point_count);
    assert_memory_equal(lines.points, lines.points + 3 * (lines.point_count - 1), 12);
    for (uint32_t i = 0; i < lines.point_count; i++) {
        const float *p = lines.points + 3 * i;
        near_to((double)p[2], 0, 1e-6);
        near_to(sqrt((double)(p[0] * p[0] + p[1] * p[1])), 2, 5e-3);
    }
    vsf_polylines_free(&lines);
    assert_int_equal(vsf_feature_lines(NULL, &f.mesh, &f.buffers, close, VSF_CONTOURS, 0, &lines),
                     LAO_OK);
    for (uint32_t i = 0; i < lines.point_count; i++) /* n.(c - p) = 0: z = R^2 / 4 */
        near_to((double)lines.points[3 * i + 2], 1, 2e-3);
    vsf_polylines_free(&lines);
    assert_int_equal(
        vsf_feature_lines(NULL, &f.mesh, &f.buffers, eye, VSF_SUGGESTIVE_CONTOURS, 0, &lines),
        LAO_OK);
    assert_int_equal(lines.line_count, 0);
    assert_int_equal(lines.offsets[0], 0);
    vsf_polylines_free(&lines);
    assert_int_equal(vsf_feature_lines(NULL, &f.mesh, &f.buffers, eye, VSF_CONTOURS, -1, &lines),
                     LAO_ERROR_INVALID_ARGUMENT);
    fixture_free(&f);
}

/* n.v and the radial curvature times |w|^2 of the torus at the point nearest to p, for a view along
   a unit vector; *p goes there, and its w comes out. */
static double torus_measure(double p[3], const double view[3], double *facing, double w[3]) {
    double ring = sqrt(p[0] * p[0] + p[1] * p[1]), n[3], length, around[3], a, b;
    n[0] = p[0] - 5 * p[0] / ring;
    n[1] = p[1] - 5 * p[1] / ring;
    n[2] = p[2];
    length = sqrt(length2(n));
    *facing = 0;
    for (int k = 0; k < 3; k++) {
        n[k] /= length;
        p[k] += (2 - length) * n[k];
        *facing += n[k] * view[k];
    }
    for (int k = 0; k < 3; k++)
        w[k] = view[k] - *facing * n[k];
    ring = sqrt(p[0] * p[0] + p[1] * p[1]);
    around[0] = -p[1] / ring;
    around[1] = p[0] / ring;
    a = w[0] * around[0] + w[1] * around[1];
    b = length2(w) - a * a;
    return a * a * (ring - 5) / 2 / ring + b / 2;
}

static void suggestive_contours_of_a_torus(void **state) {
    /* at every point: nearly no measure, rising towards the viewer as fast as said, facing him. On
       a saddle seen from its front it falls everywhere: no line */
    const float eye[4] = {0.6f, 0, 0.8f, 0}, above[4] = {0.0995037f, 0, 0.9950372f, 0};
    const double view[3] = {0.6, 0, 0.8};
    fixture torus = fixture_make(surface_torus(5, 2, 240, 120), 0, 1);
    fixture saddle = fixture_make(surface_saddle(0.1, 4, 121), 0, 1);
    double total[2] = {0, 0};
    vsf_polylines lines;
    (void)state;
    for (int i = 0; i < 2; i++) {
        float threshold = i ? 0.008f : 0.0f;
        assert_int_equal(vsf_feature_lines(NULL, &torus.mesh, &torus.buffers, eye,
                                           VSF_SUGGESTIVE_CONTOURS, threshold, &lines),
                         LAO_OK);
        assert_true(lines.line_count > 0 && lines.line_count < 10);
        for (uint32_t j = 0; j < lines.point_count; j++) {
            double p[3], q[3], w[3], facing, slope, length;
            for (uint32_t k = 0; k < 3; k++)
                p[k] = (double)lines.points[3 * j + k];
            near_to(torus_measure(p, view, &facing, w), 0, 2e-3);
            assert_true(facing > -1e-3);
            length = sqrt(length2(w));
            for (int k = 0; k < 3; k++)
                q[k] = p[k] + 1e-4 * w[k] / length;
            slope = -torus_measure(p, view, &facing, w);
            slope += torus_measure(q, view, &facing, w);
            near_to((double)lines.values[j], slope / 1e-4, 8e-4);
            assert_true(lines.values[j] >= threshold - 1e-6f);
        }
        for (uint32_t j = 0; j < lines.line_count; j++) {
            assert_true(lines.offsets[j + 1] >= lines.offsets[j] + 2);
            for (uint32_t k = lines.offsets[j] + 1; k < lines.offsets[j + 1]; k++) {
                const float *p = lines.points + 3 * k;
                total[i] += sqrt((double)((p[0] - p[-3]) * (p[0] - p[-3]) +
                                          (p[1] - p[-2]) * (p[1] - p[-2]) +
                                          (p[2] - p[-1]) * (p[2] - p[-1])));
            }
        }
        vsf_polylines_free(&lines);
    }
    printf("suggestive contours of a torus: %.2f mm, %.2f with a threshold\n", total[0], total[1]);
    assert_true(total[0] > 1 && total[1] > 0.1 && total[1] < 0.95 * total[0]);
    assert_int_equal(vsf_feature_lines(NULL, &saddle.mesh, &saddle.buffers, above,
                                       VSF_SUGGESTIVE_CONTOURS, 0, &lines),
                     LAO_OK);
    for (uint32_t j = 0; j < lines.point_count; j++) /* but for the border's one-sided rings */
        assert_true(fabsf(lines.points[3 * j]) > 3.7f || fabsf(lines.points[3 * j + 1]) > 3.7f);
    vsf_polylines_free(&lines);
    fixture_free(&torus);
    fixture_free(&saddle);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres),
        cmocka_unit_test(inward_sphere),
        cmocka_unit_test(planes),
        cmocka_unit_test(cylinders),
        cmocka_unit_test(tori),
        cmocka_unit_test(saddles),
        cmocka_unit_test(rings_are_the_printed_formulas),
        cmocka_unit_test(gradients_of_linear_functions),
        cmocka_unit_test(moves_and_scales),
        cmocka_unit_test(eyes_of_cameras),
        cmocka_unit_test(degenerate_eyes_and_vertices),
        cmocka_unit_test(buffers_describe_an_object),
        cmocka_unit_test(ring_numbers_survive_floats),
        cmocka_unit_test(order_of_work_does_not_matter),
        cmocka_unit_test(curvatures_of_known_shapes),
        cmocka_unit_test(contours_of_a_sphere),
        cmocka_unit_test(suggestive_contours_of_a_torus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
