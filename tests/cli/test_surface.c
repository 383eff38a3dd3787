/* lineao surface tells of every vertex what the formulas say - place, normal, measure, distance to
 * the lit lines, nearness -, draws the same picture with OpenGL and Vulkan, dumps of the nearest
 * front face what the mesh has there, and says in one line what is wrong. */
#include "program.h"

#include "image.h"

#include <cJSON.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char *program; /* its path, from the command line */

#define RUN(...) program_start(program, false, __VA_ARGS__)
#define SMALL "--size 120x90 --ssaa 1 "

/* ---- files ------------------------------------------------------------------------------ */

enum { ROUND = 40, LONG = 30 };
static const double radius = 3, length = 12, shift[3] = {100, -50, 20};

/* An open tube along z around `shift`, of an OBJ file; inward: the other way round. */
static void write_tube(const char *path, int inward, double scale) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int j = 0; j <= LONG; j++) {
        for (int i = 0; i < ROUND; i++) {
            double a = 6.283185307179586 * i / ROUND;
            fprintf(file, "v %.7f %.7f %.7f\n", scale * (shift[0] + radius * cos(a)),
                    scale * (shift[1] + radius * sin(a)),
                    scale * (shift[2] + length * j / LONG - length / 2));
        }
    }
    for (int j = 0; j < LONG; j++) {
        for (int i = 0; i < ROUND; i++) {
            int a = j * ROUND + i + 1, b = j * ROUND + (i + 1) % ROUND + 1;
            fprintf(file, "f %d %d %d\nf %d %d %d\n", a, inward ? b + ROUND : b,
                    inward ? b : b + ROUND, a, inward ? a + ROUND : b + ROUND,
                    inward ? b + ROUND : a + ROUND);
        }
    }
    assert_int_equal(fclose(file), 0);
}

/* A line along the axis at y = shift + 1, 0 ms at its start, 1000 ms at its end, as times or as
   speed (m/s) or (NULL) not told; a VTK file. */
static void write_lines(const char *path, const char *array) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 61 float\n");
    for (int i = 0; i <= 60; i++)
        fprintf(file, "%.6f %.6f %.6f\n", shift[0], shift[1] + 1,
                shift[2] - length / 2 + length * i / 60);
    fprintf(file, "LINES 1 62\n61");
    for (int i = 0; i <= 60; i++)
        fprintf(file, " %d", i);
    if (array) {
        fprintf(file, "\nPOINT_DATA 61\nSCALARS %s float 1\nLOOKUP_TABLE default\n", array);
        for (int i = 0; i <= 60; i++)
            fprintf(file, "%.6f\n", strcmp(array, "time") == 0 ? 1000.0 * i / 60 : length / 1000);
    }
    fprintf(file, "\n");
    assert_int_equal(fclose(file), 0);
}

/* Are two files the same, byte by byte? */
static bool same_files(const char *a, const char *b) {
    FILE *x = fopen(a, "rb"), *y = fopen(b, "rb");
    assert_true(x && y);
    int p, q;
    do {
        p = fgetc(x);
        q = fgetc(y);
    } while (p == q && p != EOF);
    fclose(x);
    fclose(y);
    return p == q;
}

/* The numbers of an array of rows of `width`; null is NaN. For free(). */
static double *numbers(const cJSON *json, const char *key, int width, int *count) {
    const cJSON *array = cJSON_GetObjectItem(json, key), *row;
    assert_true(cJSON_IsArray(array));
    *count = cJSON_GetArraySize(array);
    double *values = calloc((size_t)(*count * width) + 1, sizeof *values);
    int i = 0;
    cJSON_ArrayForEach(row, array) {
        const cJSON *item = width == 1 ? row : row->child;
        for (int k = 0; k < width; k++, item = item->next, i++)
            values[i] = cJSON_IsNull(item) ? NAN : item->valuedouble;
    }
    assert_int_equal(i, *count * width);
    return values;
}

/* ---- runs ------------------------------------------------------------------------------- */

/* Warnings are fine, faults are not. */
static void expect_ok(program_run run) {
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    assert_string_equal(run.out, "");
    for (const char *at = run.err; *at; at = strchr(at, '\n') + 1)
        assert_non_null(strstr(at, ": warning: "));
    program_free(&run);
}

static void write_camera(const char *path, int ortho) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "{\"eye\":[%g,%g,%g],\"center\":[%g,%g,%g],\"up\":[0,0,1],%s}", shift[0] + 20,
            shift[1] - 15, shift[2] + 12, shift[0], shift[1], shift[2],
            ortho ? "\"ortho_height\":16" : "\"fovy\":30");
    assert_int_equal(fclose(file), 0);
}

/* ---- tests ------------------------------------------------------------------------------ */

/* A cylinder's normals and measure: radial curvature 1/R times the square of the view's share
   around the axis; perspective by the vector to the eye, without its bias. */
static void vertices_of_a_tube(void **state) {
    (void)state;
    write_tube("tube.obj", 0, 1);
    for (int ortho = 0; ortho < 2; ortho++) {
        write_camera("camera.json", ortho);
        expect_ok(RUN("surface tube.obj --camera camera.json --vertices v.json"));
        cJSON *json = read_json("v.json");
        int n, m, count;
        double *p = numbers(json, "p", 3, &n), *normal = numbers(json, "n", 3, &m);
        double *measure = numbers(json, "measure", 1, &count);
        double worst = 0, largest = 0;
        assert_int_equal(n, ROUND * (LONG + 1));
        assert_int_equal(m, n);
        assert_int_equal(count, n);
        assert_null(cJSON_GetObjectItem(json, "phi"));
        assert_null(cJSON_GetObjectItem(json, "gamma"));
        assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "triangles")),
                         2 * ROUND * LONG);
        for (int i = 0; i < n; i++) {
            double a = 6.283185307179586 * (i % ROUND) / ROUND;
            double v[3] = {20, -15, 12}, size = 0, around;
            assert_true(fabs(p[3 * i] - shift[0] - radius * cos(a)) < 2e-5);
            bool end = i < ROUND || i >= n - ROUND; /* fewer faces there */
            assert_true(fabs(normal[3 * i] - cos(a)) < (end ? 0.05 : 1e-3));
            assert_true(fabs(normal[3 * i + 1] - sin(a)) < (end ? 0.05 : 1e-3));
            for (int k = 0; k < 3; k++) {
                v[k] += ortho ? 0 : shift[k] - p[3 * i + k];
                size += v[k] * v[k];
            }
            around = -v[0] * sin(a) + v[1] * cos(a);
            largest = fmax(largest, fabs(measure[i]));
            if (i >= 2 * ROUND && i < n - 2 * ROUND) /* whose neighbours are not at an end */
                worst = fmax(worst, fabs(measure[i] - around * around / size / radius));
        }
        if (!(largest > 0.2 && worst < 0.01))
            print_error("largest %g, worst %g\n", largest, worst);
        assert_true(largest > 0.2 && worst < 0.01);
        free(p);
        free(normal);
        free(measure);
        cJSON_Delete(json);
    }
}

/* phi is the distance to the lit part of the line at the time; gamma the 1 % quantile over all
   steps; near = 1 - phi / gamma. */
/* slack: of beta, by how lines are written. */
static void distances_by(const char *lines, double slack) {
    expect_ok(RUN("surface tube.obj --lines %s --time 300 --set near_steps=11 "
                  "--vertices v.json",
                  lines));
    cJSON *json = read_json("v.json");
    int n, count;
    double *p = numbers(json, "p", 3, &n), *phi = numbers(json, "phi", 1, &count);
    double *near = numbers(json, "near", 1, &count);
    double beta = cJSON_GetObjectItem(json, "beta")->valuedouble;
    double gamma = cJSON_GetObjectItem(json, "gamma")->valuedouble;
    double reach = sqrt(beta * log(4)), some = 0;
    assert_true(fabs(beta - 2000) < slack); /* twice the median of the last times */
    for (int i = 0; i < n; i++) {           /* 300 ms is one of the 11 steps */
        double z = p[3 * i + 2] - shift[2] + length / 2;
        double low = (300 - reach) / 1000 * length, high = (300 + reach) / 1000 * length;
        double along = z < low ? low - z : z > high ? z - high : 0;
        double x = p[3 * i] - shift[0], y = p[3 * i + 1] - shift[1] - 1;
        double wanted = sqrt(x * x + y * y + along * along);
        double tau = 1 - phi[i] / gamma;
        assert_true(fabs(phi[i] - wanted) < 1e-4);
        assert_true(fabs(near[i] - (tau > 0 ? tau : 0)) < 1e-5);
        some += near[i] > 0;
    }
    assert_true(some > 0 && some < 0.2 * n);
    free(p);
    free(phi);
    free(near);
    cJSON_Delete(json);
}

static void distances_of_a_tube(void **state) {
    (void)state;
    write_tube("tube.obj", 0, 1);
    write_lines("line.vtk", "time");
    write_lines("steady.vtk", "speed");
    distances_by("line.vtk", 1e-6);
    distances_by("steady.vtk", 1e-3);
    expect_fault(RUN("surface tube.obj --lines line.vtk --set near_steps=0 -o x.png"), 2,
                 "near_steps");
}

static const float *channel(const image_exr *exr, const char *name) {
    for (uint32_t c = 0; c < exr->parts[0].channel_count; c++) {
        if (strcmp(exr->parts[0].channels[c].name, name) == 0)
            return exr->parts[0].channels[c].data;
    }
    print_error("no channel %s\n", name);
    fail();
    return NULL;
}

/* Positions are on the tube, normals radial, colours those of the look-up. */
static void dump_of_a_tube(void **state) {
    char error[IMAGE_ERROR_SIZE];
    image_exr exr[2];
    (void)state;
    write_tube("tube.obj", 0, 1);
    write_lines("line.vtk", "time");
    write_camera("camera.json", 0);
    for (int b = 0; b < 2; b++) {
        expect_ok(RUN("surface tube.obj --lines line.vtk --time 300 --camera camera.json " SMALL
                      "--set brightness=2 --backend %s --dump %s.exr -o %s.png",
                      b ? "vk" : "gl", b ? "vk" : "gl", b ? "vk" : "gl"));
        assert_true(image_read_exr(b ? "vk.exr" : "gl.exr", &exr[b], error));
    }
    const char *const names[] = {"position.X", "position.Y", "position.Z", "normal.X", "normal.Y",
                                 "measure.V",  "near.V",     "mask.V",     "lut.R",    "lut.G",
                                 "lut.B",      "normal.Z",   "out.R"};
    const float *c[13];
    uint32_t covered = 0, size = 120 * 90;
    for (int i = 0; i < 13; i++) {
        c[i] = channel(&exr[0], names[i]);
        assert_memory_equal(c[i], channel(&exr[1], names[i]), size * sizeof(float));
    }
    for (uint32_t i = 0; i < size; i++) {
        if (c[7][i] < 0.5f) {
            assert_true(c[0][i] == 0 && c[5][i] == 0 && c[6][i] == 0 && c[8][i] == 0);
            continue;
        }
        double x = (double)c[0][i] - shift[0], y = (double)c[1][i] - shift[1];
        double r = sqrt(x * x + y * y), opacity = fmin(fabs(2 * (double)c[5][i]), 1);
        double most = fmax((double)c[8][i], fmax((double)c[9][i], (double)c[10][i]));
        covered++;
        assert_true(r > radius * 0.99 && r < radius * 1.0001);
        assert_true(fabs((double)c[3][i] - x / r) < 0.05 && fabs((double)c[4][i] - y / r) < 0.05);
        assert_true(fabs(most - opacity) < 1e-5);  /* a pure hue times |y| */
        assert_true(c[5][i] < 0 || c[10][i] == 0); /* orange to red has no blue */
    }
    assert_in_range(covered, 2000, size);
    image_exr_free(&exr[0]);
    image_exr_free(&exr[1]);
    assert_true(same_files("gl.png", "vk.png"));
}

/* Units, an open tube inside out, sequences, the embedded surfaces, cameras. */
static void uses(void **state) {
    (void)state;
    write_tube("cm.obj", 1, 0.1);
    write_lines("line.vtk", "time");
    program_run run = RUN("surface cm.obj --unit cm --vertices v.json --json");
    assert_int_equal(run.code, 0);
    assert_string_equal(run.err, "");
    assert_non_null(strstr(run.out, "turned round"));
    program_free(&run);
    cJSON *json = read_json("v.json");
    int n;
    double *p = numbers(json, "p", 3, &n), *normal = numbers(json, "n", 3, &n);
    assert_true(fabs(p[0] - shift[0] - radius) < 1e-3 && normal[0] > 0.9);
    free(p);
    free(normal);
    cJSON_Delete(json);
    expect_ok(RUN("surface cm.obj --unit cm --lines line.vtk --frames 3 " SMALL "-o f_%%02d.png"));
    assert_int_equal(access("f_00.png", F_OK) | access("f_02.png", F_OK), 0);
    assert_false(same_files("f_00.png", "f_02.png"));
    expect_ok(RUN("surface --scene aneurysm " SMALL "-o a.png --save-camera c.json"));
    expect_ok(RUN("surface --scene aneurysm --camera c.json " SMALL "-o b.png --backend vk"));
    assert_true(same_files("a.png", "b.png"));
    expect_ok(RUN("surface --scene aneurysm --lines none --camera c.json " SMALL "-o b.png"));
    assert_false(same_files("a.png", "b.png")); /* it has a flow of its own */
    expect_ok(RUN("surface cm.obj --unit cm --baseline transparent " SMALL "-o t.png"));
    expect_ok(RUN("surface cm.obj --unit cm --focus 20,30 --depth-shadow on --attenuation on " SMALL
                  "-o e.png --timings t.json"));
    char *a = read_text("t.json");
    assert_non_null(strstr(a, "\"focus_y\""));
    free(a);
}

/* ---- trees and volumes ------------------------------------------------------------------ */

/* A capsule from (0,0,0) to (0,0,20) mm of radius 2, and a twig of radius `twig`. */
static void write_tree(const char *path, double twig) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "1 3 50 60 70 2 -1\n2 3 50 60 90 2 1\n");
    if (twig > 0)
        fprintf(file, "3 3 65 60 90 %g 2\n", twig);
    assert_int_equal(fclose(file), 0);
}

static double number_of(const cJSON *json, const char *key) {
    const cJSON *item = cJSON_GetObjectItem(json, key);
    assert_true(cJSON_IsNumber(item));
    return item->valuedouble;
}

/* The wall of a tree is a closed mesh on the tree's round cones; a twig that no voxel could hold is
   made wide enough, and that is said. */
static void tree_as_mesh(void **state) {
    (void)state;
    write_tree("tree.swc", 0);
    program_run run = RUN("surface tree.swc --unit mm --json --vertices v.json");
    assert_int_equal(run.code, 0);
    cJSON *report = cJSON_Parse(run.out), *json = read_json("v.json");
    const double pi = 3.141592653589793;
    double area = 2 * pi * 2 * 20 + 4 * pi * 4, volume = pi * 4 * 20 + 4 * pi * 8 / 3;
    assert_true(number_of(report, "open_edges") == 0 && number_of(report, "parts") == 1);
    assert_true(fabs(number_of(report, "area") - area) < 0.01 * area);
    assert_true(fabs(number_of(report, "volume") - volume) < 0.01 * volume);
    int n, m;
    double *p = numbers(json, "p", 3, &n), *normal = numbers(json, "n", 3, &m);
    for (int i = 0; i < n; i++) {
        double z = fmin(fmax(p[3 * i + 2] - 70, 0), 20) + 70, d[3], r = 0, along = 0;
        for (int k = 0; k < 3; k++) {
            d[k] = p[3 * i + k] - (k == 0 ? 50 : k == 1 ? 60 : z);
            r += d[k] * d[k];
            along += d[k] * normal[3 * i + k];
        }
        assert_true(fabs(sqrt(r) - 2) < 0.01 && along > 0.99 * sqrt(r));
    }
    free(p);
    free(normal);
    cJSON_Delete(json);
    cJSON_Delete(report);
    program_free(&run);
    write_tree("twig.swc", 0.001);
    run = RUN("surface twig.swc --unit mm --grid 64 --json");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "--grid makes it less"));
    report = cJSON_Parse(run.out);
    assert_true(number_of(report, "parts") == 1 && number_of(report, "open_edges") == 0);
    cJSON_Delete(report);
    program_free(&run);
    expect_fault(RUN("surface tree.swc --value wss -o x.png"), 1, "is a tree");
    expect_fault(RUN("surface tree.swc --grid 8 -o x.png"), 2, "--grid");
    expect_fault(RUN("surface tree.swc --seeds 10 -o x.png"), 2, "--seeds");
}

/* Blood that flows along x through a square duct of 10 x 10 voxels of 1 mm. */
static void write_volume(const char *path) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\n"
                  "DIMENSIONS 24 16 16\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 6144\n"
                  "VECTORS velocity float\n");
    for (int i = 0; i < 6144; i++) {
        int y = i / 24 % 16, z = i / 384;
        bool in = y >= 3 && y < 13 && z >= 3 && z < 13;
        fprintf(file, "%s\n", in ? "0.5 0 0" : "0 0 0");
    }
    assert_int_equal(fclose(file), 0);
}

/* A volume gives its wall and its flow: the mesh around where the blood is, and lines in it, which
   in steady flow start at 0. */
static void volume_as_mesh(void **state) {
    (void)state;
    write_volume("duct.vtk");
    program_run run = RUN("surface duct.vtk --seeds 50 --smooth 5 --json --vertices v.json");
    assert_int_equal(run.code, 0);
    cJSON *report = cJSON_Parse(run.out), *json = read_json("v.json");
    double volume = number_of(report, "volume"), beta = number_of(report, "beta");
    int n, m;
    double *p = numbers(json, "p", 3, &n), *phi = numbers(json, "phi", 1, &m);
    assert_true(fabs(volume - 2400) < 0.1 * 2400);
    assert_true(number_of(report, "open_edges") == 0);
    assert_true(beta > 10 && beta <= 2 * 48); /* lines of 24 mm at most, 0.5 mm / ms */
    for (int i = 0; i < n; i++) {
        assert_true(p[3 * i] > -1.5 && p[3 * i] < 24.5);
        assert_true(p[3 * i + 1] > 1.5 && p[3 * i + 1] < 13.5);
        assert_true(phi[i] >= 0 && phi[i] < 24);
    }
    free(p);
    free(phi);
    cJSON_Delete(json);
    cJSON_Delete(report);
    program_free(&run);
    expect_ok(RUN("surface duct.vtk --seeds 50 --frames 2 " SMALL "-o duct_%%d.png"));
    expect_ok(RUN("surface duct.vtk --seeds 50 --time 0 --span cycle " SMALL "-o zero.png"));
    assert_true(same_files("duct_0.png", "zero.png")); /* frames begin where lines do */
    assert_false(same_files("duct_0.png", "duct_1.png"));
    expect_fault(RUN("surface duct.vtk --lines line.vtk -o x.png"), 2, "--lines");
}

/* A mesh of too many triangles is decimated, keeps its size, and that is said. */
static void too_many_triangles(void **state) {
    (void)state;
    write_tube("tube.obj", 0, 1);
    program_run run = RUN("surface tube.obj --triangles 600 --json --vertices v.json");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "of 2400 triangles are left; --triangles says how many"));
    cJSON *report = cJSON_Parse(run.out);
    double area = 2 * 3.141592653589793 * radius * length;
    assert_true(number_of(report, "triangles") > 300 && number_of(report, "triangles") <= 600);
    assert_true(fabs(number_of(report, "area") - area) < 0.06 * area);
    cJSON_Delete(report);
    program_free(&run);
    run = RUN("surface tube.obj --triangles 2400 --json");
    assert_null(strstr(run.out, "triangles are left"));
    program_free(&run);
    expect_fault(RUN("surface tube.obj --triangles 99 -o x.png"), 2, "--triangles");
}

/* ---- what is drawn on top ---------------------------------------------------------------- */

/* Legends, a colour map for the wall and contours change the picture, alike on both backends. */
static void looks(void **state) {
    static const char *const flags[] = {"", "--legend right",
                                        "--wall-colormap inferno --near-gamma 6", "--contours 0.2",
                                        "--suggestive-contours 0.2 --suggestive-threshold 0"};
    (void)state;
    write_tube("tube.obj", 0, 1);
    write_lines("line.vtk", "time");
    write_camera("camera.json", 0);
    for (int i = 0; i < 5; i++) {
        for (int b = 0; b < 2; b++)
            expect_ok(RUN("surface tube.obj --lines line.vtk --camera camera.json --time 300 "
                          "--size 240x180 --ssaa 1 "
                          "--backend %s -o %s%d.png %s",
                          b ? "vk" : "gl", b ? "vk" : "gl", i, flags[i]));
        char gl[32], vk[32];
        snprintf(gl, sizeof gl, "gl%d.png", i);
        snprintf(vk, sizeof vk, "vk%d.png", i);
        assert_true(same_files(gl, vk));
        if (i > 0 && i < 4) /* a straight tube has no suggestive contour */
            assert_false(same_files("gl0.png", gl));
    }
    /* three legends stand in line where they have no room side by side; in less room one is left
     * out */
    expect_ok(
        RUN("surface --scene aneurysm --legend right --size 240x180 --ssaa 1 -o legends.png"));
    program_run run =
        RUN("surface --scene aneurysm --legend right --size 120x90 --ssaa 1 -o x.png");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.err, "x.png: warning: no room for"));
    program_free(&run);
    expect_fault(RUN("surface tube.obj --contours 0 -o x.png"), 2, "--contours");
    expect_fault(RUN("surface tube.obj --wall-colormap rainbow -o x.png"), 2, "--wall-colormap");
}

/* A mesh in metres, of which 1.5 mm would show all, gets the brightness of its own curvature; one
 * of a vessel's size keeps 1.5 mm. */
static void odd_sizes(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        write_tube("odd.obj", 0, i ? 1e-3 : 1);
        expect_ok(RUN("surface odd.obj --size 48x36 --ssaa 1 -o odd.png"));
        expect_ok(RUN("surface odd.obj --size 48x36 --ssaa 1 --brightness auto -o auto.png"));
        assert_true(same_files("odd.png", "auto.png") == (i == 1));
    }
    expect_ok(RUN("surface odd.obj --size 48x36 --ssaa 1 --brightness 1.5 -o print.png"));
    assert_false(same_files("odd.png", "print.png"));
}

/* lineao render --outline: a mesh's silhouette behind and around lines, which stay as they are. */
static void outlines(void **state) {
    char error[IMAGE_ERROR_SIZE];
    uint32_t width, height;
    (void)state;
    write_tube("tube.obj", 0, 1);
    write_lines("line.vtk", "time");
    write_camera("camera.json", 1); /* 16 mm high: 7.5 pixels are a mm */
    expect_ok(RUN("render line.vtk --width 1 --camera camera.json --size 160x120 -o plain.png"));
    expect_ok(RUN("render line.vtk --width 1 --outline tube.obj --camera camera.json "
                  "--size 160x120 -o outline.png"));
    uint8_t *pixels[2];
    for (int i = 0; i < 2; i++)
        assert_true(
            image_read_png(i ? "outline.png" : "plain.png", 4, &width, &height, &pixels[i], error));
    uint32_t counts[3] = {0, 0, 0}; /* as before, tinted, ink */
    for (uint32_t i = 0; i < width * height; i++) {
        const uint8_t *a = pixels[0] + 4 * i, *b = pixels[1] + 4 * i;
        counts[memcmp(a, b, 3) == 0 ? 0 : b[1] > 200 ? 1 : 2]++;
    }
    /* The tube's silhouette is 6 mm wide; along z it is seen at 25.6 degrees to the picture. */
    double area = 6 * 12 * cos(0.4478) + 3.14159 * 9 * sin(0.4478), ring = 2 * (6 + 12);
    assert_true(fabs(counts[1] + 0.5 * counts[2] - (area - 12 * 0.9) * 56.25) <
                0.15 * 56.25 * area);
    assert_true(counts[2] > 1.0 * ring * 7.5 && counts[2] < 2.5 * ring * 7.5);
    free(pixels[0]);
    free(pixels[1]);
    expect_fault(RUN("render line.vtk --outline none.stl -o x.png"), 1, "none.stl");
}

static void faults(void **state) {
    (void)state;
    write_tube("tube.obj", 0, 1);
    write_lines("plain.vtk", NULL);
    expect_fault(RUN("surface"), 2, "no output");
    expect_fault(RUN("surface none.stl -o x.png"), 1, "none.stl");
    expect_fault(RUN("surface tube.obj tube.obj -o x.png"), 2, "second MESH");
    expect_fault(RUN("surface tube.obj --scene bone -o x.png"), 2, "--scene");
    expect_fault(RUN("surface tube.obj --time 3 -o x.png"), 2, "--lines");
    expect_fault(RUN("surface tube.obj --lines plain.vtk -o x.png"), 1, "time");
    expect_fault(RUN("surface tube.obj --value wss -o x.png"), 1, "wss");
    expect_fault(RUN("surface tube.obj --focus 1 -o x.png"), 2, "--focus");
    expect_fault(RUN("surface tube.obj --baseline best -o x.png"), 2, "--baseline");
    expect_fault(RUN("surface tube.obj --set brightness=-1 -o x.png"), 2, "brightness");
    expect_fault(RUN("surface tube.obj -o nowhere/x.png"), 1, "nowhere");
    program_run run = RUN("help surface");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "--vertices"));
    assert_non_null(strstr(run.out, "--depth-shadow"));
    program_free(&run);
}

static int enter(void **state) {
    (void)state;
    static char place[] = "/tmp/lineao_surface_XXXXXX";
    return mkdtemp(place) && chdir(place) == 0 ? 0 : -1;
}

static int leave(void **state) {
    char place[256], command[300];
    (void)state;
    if (!getcwd(place, sizeof place) || strncmp(place, "/tmp/lineao_surface_", 20) != 0)
        return -1;
    snprintf(command, sizeof command, "rm -r %s", place);
    return chdir("/") == 0 ? system(command) : -1;
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_of_a_tube),
        cmocka_unit_test(distances_of_a_tube),
        cmocka_unit_test(dump_of_a_tube),
        cmocka_unit_test(uses),
        cmocka_unit_test(tree_as_mesh),
        cmocka_unit_test(volume_as_mesh),
        cmocka_unit_test(too_many_triangles),
        cmocka_unit_test(looks),
        cmocka_unit_test(outlines),
        cmocka_unit_test(odd_sizes),
        cmocka_unit_test(faults),
    };
    program = argc > 1 ? argv[1] : "lineao";
    return cmocka_run_group_tests(tests, enter, leave);
}
