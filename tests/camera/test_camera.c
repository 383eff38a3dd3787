/* A camera read from a file, framed around data and turned into matrices shows what it promises:
 * all of the data, as large as fits, in the stated conventions; a bad file is told clearly. */
#include "camera.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

/* Normalised device coordinates of a point, by the column-major matrices. */
static void project(const float view[16], const float projection[16], const double p[3],
                    double ndc[3]) {
    double eye[4], clip[4];
    for (int r = 0; r < 4; r++) {
        eye[r] = (double)view[12 + r];
        for (int c = 0; c < 3; c++)
            eye[r] += (double)view[4 * c + r] * p[c];
    }
    for (int r = 0; r < 4; r++) {
        clip[r] = 0.0;
        for (int c = 0; c < 4; c++)
            clip[r] += (double)projection[4 * c + r] * eye[c];
    }
    for (int i = 0; i < 3; i++)
        ndc[i] = clip[i] / clip[3];
}

/* Even, repeatable numbers in -1..1. */
static float next(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (float)((double)(*state >> 8) / 8388608.0 - 1.0);
}

static void framing_is_tight(void **state) {
    (void)state;
    enum { COUNT = 300 };
    uint32_t seed = 1;
    for (int trial = 0; trial < 200; trial++) {
        float points[3 * COUNT], direction[3], up[3];
        for (int i = 0; i < COUNT; i++) {
            points[3 * i] = 40.0f * next(&seed) + 100.0f;
            points[3 * i + 1] = 3.0f * next(&seed);
            points[3 * i + 2] = 90.0f * next(&seed) - 7.0f;
        }
        points[3] = (float)NAN; /* must not count */
        for (int i = 0; i < 3; i++) {
            direction[i] = next(&seed);
            up[i] = next(&seed);
        }
        const double aspect = trial % 3 == 0 ? 0.5 : trial % 3 == 1 ? 1.0 : 16.0 / 9.0;
        const double fovy = trial % 4 == 0 ? 0.0 : trial % 4 == 1 ? 50.0 : 30.0, margin = 0.05;
        camera_fit fit;
        camera_pose camera;
        camera_fit_begin(&fit, direction, up, aspect, margin, fovy);
        camera_fit_add(&fit, points, COUNT / 2);
        camera_fit_add(&fit, points + 3 * (COUNT / 2), COUNT - COUNT / 2);
        camera_fit_end(&fit, &camera);
        float view[16], projection[16];
        const double middle[3] = {100.0, 0.0, -7.0};
        camera_matrices(&camera, aspect, middle, 99.0, true, view, projection);
        double low[2] = {9, 9}, high[2] = {-9, -9};
        for (int i = 0; i < COUNT; i++) {
            if (i == 1)
                continue;
            const double p[3] = {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
            double ndc[3];
            project(view, projection, p, ndc);
            assert_true(ndc[2] >= 0.0 && ndc[2] <= 1.0);
            for (int k = 0; k < 2; k++) {
                low[k] = fmin(low[k], ndc[k]);
                high[k] = fmax(high[k], ndc[k]);
            }
        }
        /* the wider of both axes fills the image but for the margin, and both are centred */
        double size = fmax(fmax(high[0], -low[0]), fmax(high[1], -low[1]));
        assert_near(size, 1.0 - margin, 2e-5);
        int wide = high[0] > high[1] ? 0 : 1;
        assert_near(high[wide], -low[wide], 4e-5);
    }
}

/* How far balls are inside the picture but for its margin when the camera of a turn has gone `part`
 * of it: the least distance to the four planes through the eye, or two pairs of parallel ones. */
static double room_in_turn(const camera_pose *camera, double part, double aspect, double margin,
                           const float *balls, int count) {
    double ahead[3], side[3], away = 0.0, least = 1e9;
    const double *up = camera->up;
    for (int k = 0; k < 3; k++)
        away += pow(camera->center[k] - camera->eye[k], 2.0);
    away = sqrt(away);
    for (int k = 0; k < 3; k++)
        ahead[k] = (camera->center[k] - camera->eye[k]) / away;
    for (int k = 0; k < 3; k++)
        side[k] = ahead[(k + 1) % 3] * up[(k + 2) % 3] - ahead[(k + 2) % 3] * up[(k + 1) % 3];
    double c = cos(6.283185307179586 * part), s = sin(6.283185307179586 * part);
    double slope = (1.0 - margin) * tan(0.5 * camera->fovy * 0.017453292519943295);
    for (int i = 0; i < count; i++) {
        double x = 0.0, y = 0.0, z = 0.0;
        for (int k = 0; k < 3; k++) {
            double to = (double)balls[4 * i + k] - camera->center[k];
            x += to * side[k];
            y += to * up[k];
            z += to * ahead[k];
        }
        double across[2] = {fabs(c * x + s * z), fabs(y)}, deep = away + c * z - s * x;
        for (int k = 0; k < 2; k++) {
            double steep = slope * (k ? 1.0 : aspect), rim = sqrt(1.0 + steep * steep);
            double room = (steep * deep - across[k]) / rim;
            if (!(camera->fovy > 0.0))
                room = 0.5 * (1.0 - margin) * camera->ortho_height * (k ? 1.0 : aspect) - across[k];
            least = fmin(least, room - (double)balls[4 * i + 3]);
        }
    }
    return least;
}

static void a_turn_is_framed_whole_and_tightly(void **state) {
    (void)state;
    enum { COUNT = 60, STEPS = 720 };
    uint32_t seed = 3;
    for (int trial = 0; trial < 60; trial++) {
        float balls[4 * COUNT], direction[3], up[3], tall = trial % 2 ? 90.0f : 8.0f;
        for (int i = 0; i < COUNT; i++) {
            balls[4 * i] = 40.0f * next(&seed) + 100.0f;
            balls[4 * i + 1] = 3.0f * next(&seed);
            balls[4 * i + 2] = tall * next(&seed) - 7.0f;
            balls[4 * i + 3] = fabsf(4.0f * next(&seed));
        }
        balls[7] = (float)NAN; /* must not count */
        for (int i = 0; i < 3; i++) {
            direction[i] = next(&seed);
            up[i] = next(&seed);
        }
        const double aspect = trial % 3 == 0 ? 0.5 : trial % 3 == 1 ? 1.0 : 16.0 / 9.0;
        const double fovy = trial % 4 == 0 ? 0.0 : trial % 4 == 1 ? 50.0 : 30.0, margin = 0.05;
        camera_fit fit;
        camera_orbit orbit;
        camera_pose camera;
        double least = 1e9;
        camera_fit_begin(&fit, direction, up, aspect, margin, fovy);
        for (int i = 0; i < COUNT; i++)
            camera_fit_add(&fit, balls + 4 * i, 1);
        camera_orbit_begin(&orbit, &fit);
        camera_orbit_add(&orbit, balls, 4, COUNT / 2);
        camera_orbit_add(&orbit, balls + 4 * (COUNT / 2), 4, COUNT - COUNT / 2);
        camera_orbit_end(&orbit, &camera);
        balls[7] = -1e6f; /* of no size at all */
        for (int step = 0; step < STEPS; step++)
            least = fmin(least,
                         room_in_turn(&camera, (double)step / STEPS, aspect, margin, balls, COUNT));
        assert_true(least > -1e-4);
        assert_true(least < 0.02); /* of 80 to 180 mm: what lies between two steps */
    }
}

static void framing_survives_anything(void **state) {
    (void)state;
    const float zero[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    const float line[6] = {1, 2, 3, 1, 2, 13}, bad[3] = {NAN, INFINITY, 0};
    const struct {
        const float *points;
        size_t count;
    } sets[] = {{line, 0}, {line, 1}, {line, 2}, {bad, 1}, {NULL, 0}};
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        for (int k = 0; k < 2; k++) { /* no direction, a direction along up and the line */
            camera_pose camera;
            camera_frame(zero, zero, sets[i].points, sets[i].count, k ? up : zero, up, 1.5, 0.05,
                         &camera);
            double far = 0.0;
            for (int a = 0; a < 3; a++) {
                assert_true(isfinite(camera.eye[a]) && isfinite(camera.up[a]));
                far += fabs(camera.eye[a] - camera.center[a]);
            }
            assert_true(far > 1e-3);
            camera_fit fit;
            camera_orbit orbit;
            camera_fit_begin(&fit, k ? up : zero, up, 1.5, 0.05, 30.0 * k);
            camera_fit_add(&fit, sets[i].points, sets[i].count);
            camera_orbit_begin(&orbit, &fit);
            camera_orbit_add(&orbit, sets[i].points, 3, sets[i].count);
            camera_orbit_end(&orbit, &camera);
            assert_true(k || camera.ortho_height > 1e-3);
            far = 0.0;
            for (int a = 0; a < 3; a++)
                far += fabs(camera.eye[a] - camera.center[a]);
            assert_true(isfinite(far) && far > 1e-3);
            float view[16], projection[16];
            camera_matrices(&camera, 1.5, camera.center, 0.0, true, view, projection);
            for (int a = 0; a < 16; a++)
                assert_true(isfinite(view[a]) && isfinite(projection[a]));
        }
    }
}

static void matrices_keep_the_conventions(void **state) {
    (void)state;
    camera_pose cameras[2] = {{{0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 90.0, 0.0},
                              {{0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 0.0, 20.0}};
    const double origin[3] = {0, 0, 0};
    for (int i = 0; i < 2; i++) {
        for (int zero_to_one = 0; zero_to_one < 2; zero_to_one++) {
            float view[16], projection[16];
            camera_matrices(&cameras[i], 2.0, origin, 5.0, zero_to_one == 1, view, projection);
            const double corner[3] = {20, 10, 0}, front[3] = {0, 0, 5.005},
                         back[3] = {0, 0, -5.005};
            double ndc[3];
            project(view, projection, corner, ndc); /* +x right, +y up, width = 2 heights */
            assert_near(ndc[0], 1.0, 1e-6);
            assert_near(ndc[1], 1.0, 1e-6);
            project(view, projection, front, ndc);
            assert_near(ndc[2], zero_to_one ? 0.0 : -1.0, 1e-5);
            project(view, projection, back, ndc);
            assert_near(ndc[2], 1.0, 1e-5);
        }
    }
}

static void views_are_named(void **state) {
    (void)state;
    const struct {
        const char *name;
        double right[3], up[3]; /* what lies at the right and the top of the picture */
    } views[] = {{"axial", {1, 0, 0}, {0, 1, 0}},
                 {"coronal", {-1, 0, 0}, {0, 0, 1}},
                 {"sagittal", {0, -1, 0}, {0, 0, 1}}};
    float direction[3], up[3];
    const float lo[3] = {-1, -1, -1}, hi[3] = {1, 1, 1};
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        assert_true(camera_view(views[i].name, direction, up));
        camera_pose camera;
        camera_frame(lo, hi, NULL, 0, direction, up, 1.0, 0.0, &camera);
        float view[16], projection[16];
        camera_matrices(&camera, 1.0, camera.center, 2.0, true, view, projection);
        double ndc[3];
        project(view, projection, views[i].right, ndc);
        assert_true(ndc[0] > 0.5 && fabs(ndc[1]) < 1e-6);
        project(view, projection, views[i].up, ndc);
        assert_true(ndc[1] > 0.5 && fabs(ndc[0]) < 1e-6);
    }
    assert_true(camera_view("iso", direction, up));
    assert_false(camera_view("oblong", direction, up));
    assert_false(camera_view(NULL, direction, up));
}

static void files_round_trip(void **state) {
    (void)state;
    const char *path = "test_camera_\xC3\xA4.json";
    char error[CAMERA_ERROR_SIZE] = "";
    const camera_pose written[2] = {{{1.0 / 3.0, -2e-7, 1e6}, {0, 0, 0}, {0, 0.1, 1}, 30.1, 0.0},
                                    {{1, 2, 3}, {4, 5, 6.7}, {0, 0, 1}, 0.0, 123.4}};
    for (int i = 0; i < 2; i++) {
        camera_pose read;
        assert_true(camera_write(path, &written[i], error));
        assert_true(camera_read(path, &read, error));
        assert_memory_equal(&read, &written[i], sizeof read);
        camera_pose *all = NULL;
        uint32_t count = 0;
        assert_true(camera_read_all(path, &all, &count, error));
        assert_int_equal(count, 1);
        assert_memory_equal(all, &written[i], sizeof read);
        free(all);
    }
    assert_true(camera_write_all(path, written, 2, error));
    camera_pose *all = NULL;
    uint32_t count = 0;
    assert_true(camera_read_all(path, &all, &count, error));
    assert_int_equal(count, 2);
    assert_memory_equal(all, written, sizeof written);
    free(all);
    camera_pose read;
    assert_false(camera_read(path, &read, error)); /* one is wanted, two are there */
    remove(path);
    assert_false(camera_write("absent/camera.json", &written[0], error));
    assert_memory_equal(error, "absent/camera.json: ", 20);
    char left[64];
    snprintf(left, sizeof left, "..%ld-0.tmp", (long)getpid());
    assert_false(camera_write(".", &written[0], error)); /* a folder: what was begun is gone */
    assert_int_not_equal(access(left, F_OK), 0);
    assert_false(camera_read(".", &read, error));
    assert_false(camera_read("absent.json", &read, error));
    assert_memory_equal(error, "absent.json: ", 13);
}

static void bad_cameras_are_explained(void **state) {
    (void)state;
#define EYE "\"eye\":[0,0,5]"
#define CENTER "\"center\":[0,0,0]"
#define UP "\"up\":[0,1,0]"
    const struct {
        const char *text, *said;
    } cases[] = {
        {"", "line 1 is not JSON"},
        {"{\n" EYE ",\n" CENTER "\n" UP "}", "line 4 is not JSON"},
        {"[1]", "not a camera"},
        {"{" CENTER "," UP ",\"fovy\":30}", "\"eye\""},
        {"{\"eye\":[0,0]," CENTER "," UP ",\"fovy\":30}", "\"eye\""},
        {"{\"eye\":[0,0,\"5\"]," CENTER "," UP ",\"fovy\":30}", "\"eye\""},
        {"{\"eye\":[0,0,1e999]," CENTER "," UP ",\"fovy\":30}", "\"eye\""},
        {"{" EYE "," UP ",\"fovy\":30}", "\"center\""},
        {"{" EYE "," CENTER ",\"fovy\":30}", "\"up\""},
        {"{" EYE "," CENTER "," UP "}", "either"},
        {"{" EYE "," CENTER "," UP ",\"fovy\":30,\"ortho_height\":3}", "either"},
        {"{" EYE "," CENTER "," UP ",\"fovy\":180}", "degrees"},
        {"{" EYE "," CENTER "," UP ",\"fovy\":\"30\"}", "degrees"},
        {"{" EYE "," CENTER "," UP ",\"ortho_height\":0}", "above 0"},
        {"{\"eye\":[0,0,0]," CENTER "," UP ",\"fovy\":30}", "same point"},
        {"{" EYE "," CENTER ",\"up\":[0,0,0],\"fovy\":30}", "zero"},
        {"{" EYE "," CENTER ",\"up\":[0,0,-2],\"fovy\":30}", "along the view"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        camera_pose camera;
        char error[CAMERA_ERROR_SIZE] = "";
        assert_false(camera_parse("cam.json", cases[i].text, &camera, error));
        assert_memory_equal(error, "cam.json: ", 10);
        if (!strstr(error, cases[i].said))
            fail_msg("\"%s\" lacks \"%s\"", error, cases[i].said);
        assert_false(camera_parse("cam.json", cases[i].text, &camera, NULL));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(framing_is_tight),
        cmocka_unit_test(a_turn_is_framed_whole_and_tightly),
        cmocka_unit_test(framing_survives_anything),
        cmocka_unit_test(matrices_keep_the_conventions),
        cmocka_unit_test(views_are_named),
        cmocka_unit_test(files_round_trip),
        cmocka_unit_test(bad_cameras_are_explained),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
