#include "surface_host.h"

#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void keep_log(void *user, vsf_log_item item, lao_result result, const char *text) {
    lent_log((lent_host *)user, (uint32_t)item, result, text);
}

vsf_host surface_host_make(lent_host *host) {
    vsf_host h;
    memset(host, 0, sizeof *host);
    memset(&h, 0, sizeof h);
    h.allocator = lent_allocator(&host->memory);
    h.job = lent_job(host);
    h.log = keep_log;
    h.user = host;
    return h;
}

static surface_shape shape_make(uint32_t vertices, uint32_t triangles) {
    surface_shape s;
    s.vertex_count = vertices;
    s.triangle_count = triangles;
    s.positions = (float *)malloc((size_t)vertices * 3 * sizeof(float));
    s.normals = (float *)malloc((size_t)vertices * 3 * sizeof(float));
    s.triangles = (uint32_t *)malloc((size_t)triangles * 3 * sizeof(uint32_t));
    assert_true(s.positions && s.normals && s.triangles);
    return s;
}

void surface_shape_free(surface_shape *shape) {
    free(shape->positions);
    free(shape->normals);
    free(shape->triangles);
    memset(shape, 0, sizeof *shape);
}

vsf_mesh_desc surface_describe(const surface_shape *shape) {
    vsf_mesh_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = shape->vertex_count;
    desc.positions = shape->positions;
    desc.triangle_count = shape->triangle_count;
    desc.triangles = shape->triangles;
    return desc;
}

vsf_mesh surface_build(const surface_shape *shape, uint32_t flags, int analytic_normals) {
    vsf_mesh_desc desc = surface_describe(shape);
    vsf_mesh mesh;
    desc.flags = flags;
    desc.normals = analytic_normals ? shape->normals : NULL;
    assert_int_equal(vsf_mesh_build(NULL, &desc, &mesh), LAO_OK);
    return mesh;
}

/* Every triangle of `from` with vertices of its own, each side's middle on the sphere. */
static surface_shape split(const surface_shape *from, double radius) {
    surface_shape s = shape_make(12 * from->triangle_count, 4 * from->triangle_count);
    static const int corner[12] = {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5};
    for (uint32_t t = 0; t < from->triangle_count; t++) {
        double p[6][3];
        for (int k = 0; k < 6; k++) {
            const float *a =
                from->positions + 3 * (size_t)from->triangles[3 * t + (uint32_t)(k % 3)];
            const float *b =
                from->positions + 3 * (size_t)from->triangles[3 * t + (uint32_t)((k + 1) % 3)];
            double length = 0;
            for (int i = 0; i < 3; i++) {
                p[k][i] = k < 3 ? (double)a[i] : (double)a[i] + (double)b[i];
                length += p[k][i] * p[k][i];
            }
            for (int i = 0; i < 3; i++)
                p[k][i] *= radius / sqrt(length);
        }
        for (uint32_t k = 0; k < 12; k++) {
            s.triangles[12 * t + k] = 12 * t + k;
            for (uint32_t i = 0; i < 3; i++) {
                double x = p[corner[k]][i];
                s.positions[3 * (12 * (size_t)t + k) + i] = (float)x;
                s.normals[3 * (12 * (size_t)t + k) + i] = (float)(x / radius);
            }
        }
    }
    return s;
}

surface_shape surface_sphere(double radius, uint32_t level) {
    static const float g = 1.6180340f;
    const float corners[12][3] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                  {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                  {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    static const uint32_t faces[60] = {0, 11, 5, 0, 5,  1,  0,  1,  7,  0,  7, 10, 0, 10, 11,
                                       1, 5,  9, 5, 11, 4,  11, 10, 2,  10, 7, 6,  7, 1,  8,
                                       3, 9,  4, 3, 4,  2,  3,  2,  6,  3,  6, 8,  3, 8,  9,
                                       4, 9,  5, 2, 4,  11, 6,  2,  10, 8,  6, 7,  9, 8,  1};
    surface_shape s = shape_make(12, 20);
    for (uint32_t i = 0; i < 12; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            s.normals[3 * i + k] = corners[i][k] / sqrtf(1 + g * g);
            s.positions[3 * i + k] = (float)(radius * (double)s.normals[3 * i + k]);
        }
    }
    memcpy(s.triangles, faces, sizeof faces);
    for (uint32_t i = 0; i < level; i++) {
        surface_shape finer = split(&s, radius);
        vsf_mesh mesh = surface_build(&finer, 0, 1); /* welds */
        surface_shape_free(&s);
        s = shape_make(mesh.vertex_count, mesh.triangle_count);
        memcpy(s.positions, mesh.positions, 3 * sizeof(float) * mesh.vertex_count);
        for (uint32_t k = 0; k < 3 * mesh.vertex_count; k++)
            s.normals[k] = (float)((double)s.positions[k] / radius);
        memcpy(s.triangles, mesh.triangles, 3 * sizeof(uint32_t) * mesh.triangle_count);
        vsf_mesh_free(&mesh);
        surface_shape_free(&finer);
    }
    return s;
}

surface_shape surface_grid(uint32_t nu, uint32_t nv, int wrap_u, int wrap_v, surface_map *map,
                           void *arg) {
    uint32_t cu = wrap_u ? nu : nu - 1, cv = wrap_v ? nv : nv - 1, t = 0;
    surface_shape s = shape_make(nu * nv, 2 * cu * cv);
    for (uint32_t i = 0; i < nu * nv; i++) {
        double p[3], n[3];
        map(arg, i % nu, i / nu, p, n);
        for (uint32_t k = 0; k < 3; k++) {
            s.positions[3 * i + k] = (float)p[k];
            s.normals[3 * i + k] = (float)n[k];
        }
    }
    for (uint32_t v = 0; v < cv; v++) {
        for (uint32_t u = 0; u < cu; u++) {
            uint32_t a = v * nu + u, b = v * nu + (u + 1) % nu;
            uint32_t c = (v + 1) % nv * nu + u, d = (v + 1) % nv * nu + (u + 1) % nu;
            const uint32_t corners[6] = {a, b, d, a, d, c};
            memcpy(s.triangles + 3 * t, corners, sizeof corners);
            t += 2;
        }
    }
    return s;
}

typedef struct numbers {
    double a, b, c, d;
} numbers;
static const double turn = 6.283185307179586;

static void torus_map(void *arg, double u, double v, double p[3], double n[3]) {
    const numbers *t = (const numbers *)arg;
    double a = turn * u / t->c, b = turn * v / t->d;
    n[0] = cos(b) * cos(a);
    n[1] = cos(b) * sin(a);
    n[2] = sin(b);
    p[0] = t->a * cos(a) + t->b * n[0];
    p[1] = t->a * sin(a) + t->b * n[1];
    p[2] = t->b * n[2];
}
surface_shape surface_torus(double ring, double tube, uint32_t nu, uint32_t nv) {
    numbers t = {ring, tube, nu, nv};
    return surface_grid(nu, nv, 1, 1, torus_map, &t);
}

static void cylinder_map(void *arg, double u, double v, double p[3], double n[3]) {
    const numbers *t = (const numbers *)arg;
    double a = turn * u / t->c;
    n[0] = cos(a);
    n[1] = sin(a);
    n[2] = 0;
    p[0] = t->a * n[0];
    p[1] = t->a * n[1];
    p[2] = t->b * (v / (t->d - 1) - 0.5);
}
surface_shape surface_cylinder(double radius, double length, uint32_t nu, uint32_t nv) {
    numbers t = {radius, length, nu, nv};
    return surface_grid(nu, nv, 1, 0, cylinder_map, &t);
}

static void saddle_map(void *arg, double u, double v, double p[3], double n[3]) {
    const numbers *t = (const numbers *)arg;
    double length;
    p[0] = t->b * (2 * (u + 0.3) / (t->c - 1) - 1);
    p[1] = t->b * (2 * (v + 0.2) / (t->c - 1) - 1);
    p[2] = t->a * p[0] * p[1];
    n[0] = -t->a * p[1];
    n[1] = -t->a * p[0];
    n[2] = 1;
    length = sqrt(n[0] * n[0] + n[1] * n[1] + 1);
    for (int k = 0; k < 3; k++)
        n[k] /= length;
}
surface_shape surface_saddle(double a, double size, uint32_t n) {
    numbers t = {a, size, n, 0};
    return surface_grid(n, n, 0, 0, saddle_map, &t);
}
