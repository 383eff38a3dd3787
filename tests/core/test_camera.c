/* A camera may come in any convention: {perspective, orthographic, off-centre} x {normal, reverse
   depth} x {-1..1, 0..1} x {left-, right-handed} x {y up, y down} all give the same canonical
   camera, and what cannot be drawn is refused. */
#include "core_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { PERSPECTIVE, PERSPECTIVE_OFF, ORTHOGRAPHIC, ORTHOGRAPHIC_OFF, KINDS };
enum { REVERSE = 1, NEGATIVE = 2, LEFT = 4, FLIP = 8, CONVENTIONS = 16 };

static uint32_t seed = 3;
static float any(double low, double high) {
    return (float)core_between(&seed, low, high);
}

/* Right-handed, y up, clip depth 0..1. [row][column] */
static void reference(int kind, int reverse, double view[4][4], double p[4][4]) {
    const double n = 2, f = 300, aspect = 1.6;
    int ortho = kind >= ORTHOGRAPHIC, off = kind == PERSPECTIVE_OFF || kind == ORTHOGRAPHIC_OFF;
    double c = cos(0.7), s = sin(0.7), c2 = cos(-0.3), s2 = sin(-0.3);
    const double rotation[3][3] = {{c, 0, s}, {s * s2, c2, -c * s2}, {-s * c2, s2, c * c2}};
    const double move[3] = {4, -7, -90};
    memset(view, 0, 16 * sizeof view[0][0]);
    memset(p, 0, 16 * sizeof p[0][0]);
    for (int r = 0; r < 3; r++) {
        memcpy(view[r], rotation[r], 3 * sizeof view[0][0]);
        view[r][3] = move[r];
    }
    view[3][3] = 1;
    p[0][0] = (ortho ? 0.02 : 1.3) / aspect;
    p[1][1] = ortho ? 0.02 : 1.3;
    if (off) {
        p[0][ortho ? 3 : 2] = 0.31;
        p[1][ortho ? 3 : 2] = -0.17;
    }
    if (ortho) {
        p[2][2] = (reverse ? 1 : -1) / (f - n);
        p[2][3] = reverse ? f / (f - n) : -n / (f - n);
        p[3][3] = 1;
    } else {
        p[2][2] = reverse ? n / (f - n) : -f / (f - n);
        p[2][3] = (reverse ? 1 : -1) * n * f / (f - n);
        p[3][2] = -1;
    }
}

static void columns(const double m[4][4], float out[16]) {
    for (int r = 0; r < 4; r++) {
        for (int c = 0; c < 4; c++) {
            out[4 * c + r] = (float)m[r][c];
        }
    }
}

/* The reference as a host of this convention would hold it. */
static lao_camera host_camera(int kind, int convention, double size) {
    double view[4][4], p[4][4];
    lao_camera camera;
    reference(kind, convention & REVERSE, view, p);
    for (int c = 0; c < 4; c++) {
        if (convention & NEGATIVE) {
            p[2][c] = 2 * p[2][c] - p[3][c];
        }
        if (convention & FLIP) {
            p[1][c] = -p[1][c];
        }
        if (convention & LEFT) {
            view[2][c] = -view[2][c];
            p[c][2] = -p[c][2];
        }
    }
    for (int r = 0; r < 4; r++) {
        for (int c = 0; c < 4; c++) {
            p[r][c] *= size; /* clip coordinates are homogeneous */
        }
    }
    columns((const double(*)[4])view, camera.view);
    columns((const double(*)[4])p, camera.projection);
    camera.flags = (convention & NEGATIVE ? 0u : LAO_CAMERA_ZERO_TO_ONE) |
                   (convention & REVERSE ? LAO_CAMERA_REVERSE_DEPTH : 0u) |
                   (convention & FLIP ? LAO_CAMERA_FLIP_Y : 0u);
    return camera;
}

static void every_convention_gives_the_same_camera(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        for (int convention = 0; convention < CONVENTIONS; convention++) {
            for (int size = 1; size <= 3; size++) {
                double view[4][4], p[4][4];
                float wanted_view[16], wanted[16];
                lao_camera camera = host_camera(kind, convention, size), got;
                reference(kind, convention & REVERSE, view, p);
                columns((const double(*)[4])view, wanted_view);
                columns((const double(*)[4])p, wanted);
                assert_int_equal(lao_camera_canonical(&camera, &got), 0);
                for (int i = 0; i < 16; i++) {
                    assert_true(fabsf(got.view[i] - wanted_view[i]) <=
                                1e-6f * fabsf(wanted_view[i]));
                    assert_true(fabsf(got.projection[i] - wanted[i]) <=
                                2e-6f * fabsf(wanted[i]) + 2e-7f);
                }
                assert_int_equal(got.flags,
                                 LAO_CAMERA_ZERO_TO_ONE |
                                     (convention & REVERSE ? LAO_CAMERA_REVERSE_DEPTH : 0u));
                camera = got; /* canonical already: stays as it is */
                assert_int_equal(lao_camera_canonical(&got, &camera), 0);
                assert_memory_equal(&camera, &got, sizeof got);
            }
        }
    }
}

/* A point's window depth, as the host's own depth buffer would hold it, and its pixel give the
 * point back. */
static void depth_gives_the_position_back(void **state) {
    core_host host;
    lao_desc desc;
    lao_backend backend = core_backend(0);
    lao_context *context;
    lao_view_desc size = {320, 200, 0};
    lao_frame frame;
    (void)state;
    memset(&host, 0, sizeof host);
    memset(&desc, 0, sizeof desc);
    memset(&frame, 0, sizeof frame);
    core_window_clear();
    desc.backend = &backend;
    desc.logger = core_logger(&host);
    assert_int_equal(lao_create(&desc, &context), LAO_OK);
    assert_int_equal(lao_view_create(context, &size, &frame.view), LAO_OK);
    for (int kind = 0; kind < KINDS; kind++) {
        for (int convention = 0; convention < CONVENTIONS; convention++) {
            const lao_frame_uniforms *u = &core_seen.frame;
            frame.camera = host_camera(kind, convention, 1);
            frame.sphere[3] = 50;
            assert_int_equal(lao_render(context, &frame), LAO_OK);
            assert_int_equal(core_seen.plan->reverse_depth, convention & REVERSE ? 1 : 0);
            for (int i = 0; i < 200; i++) {
                const float world[3] = {any(-30, 30), any(-30, 30), any(-30, 30)};
                double eye[4], clip[4], d, px, py, z;
                lao_v3 canonical =
                    lao_transform(u->view, lao_v3_make(world[0], world[1], world[2]));
                lao_v2 slope;
                for (int r = 0; r < 4; r++) {
                    eye[r] = (double)frame.camera.view[12 + r];
                    for (int c = 0; c < 3; c++) {
                        eye[r] += (double)frame.camera.view[4 * c + r] * (double)world[c];
                    }
                }
                for (int r = 0; r < 4; r++) {
                    clip[r] = 0;
                    for (int c = 0; c < 4; c++) {
                        clip[r] += (double)frame.camera.projection[4 * c + r] * eye[c];
                    }
                }
                assert_true(clip[3] > 0);
                d = clip[2] / clip[3];
                d = convention & NEGATIVE ? 0.5 * d + 0.5 : d;
                px = (0.5 * clip[0] / clip[3] + 0.5) * (double)u->viewport.x;
                py = ((convention & FLIP ? -0.5 : 0.5) * clip[1] / clip[3] + 0.5) *
                     (double)u->viewport.y;
                slope = lao_pixel_slope(u->ray, (float)px, (float)py);
                z = ((double)u->unproject.x + (double)u->unproject.y * d) /
                    ((double)u->unproject.z + (double)u->unproject.w * d);
                assert_true(fabs(z + (double)canonical.z) < 2e-3);
                z = u->depth.w > 0.5f ? 1 : z;
                assert_true(fabs((double)slope.x * z - (double)canonical.x) < 2e-3);
                assert_true(fabs((double)slope.y * z - (double)canonical.y) < 2e-3);
            }
        }
    }
    assert_int_equal(host.logs, 0);
    lao_destroy(context);
}

static void assert_refused(const lao_camera *camera) {
    lao_camera out, before;
    memset(&out, 0x5a, sizeof out);
    before = out;
    assert_int_equal(lao_camera_canonical(camera, &out), -1);
    assert_memory_equal(&out, &before, sizeof out);
}

static void what_cannot_be_drawn_is_refused(void **state) {
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    static const int shear_of_both[] = {
        1, 2, 3, 4, 6, 7}; /* column-major: what is 0 in any of our projections */
    lao_camera camera;
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        int ortho = kind >= ORTHOGRAPHIC;
        for (int i = 0; i < 16; i++) {
            for (int b = 0; b < 3; b++) {
                camera = host_camera(kind, 0, 1);
                camera.view[i] = bad[b];
                assert_refused(&camera);
                camera = host_camera(kind, 0, 1);
                camera.projection[i] = bad[b];
                assert_refused(&camera);
            }
        }
        for (int i = 0; i < 6; i++) {
            camera = host_camera(kind, 0, 1);
            camera.projection[shear_of_both[i]] = 0.1f;
            assert_refused(&camera);
        }
        /* oblique: the view rays have no place for it */
        camera = host_camera(kind, 0, 1);
        camera.projection[ortho ? 8 : 12] = 0.1f;
        assert_refused(&camera);
        camera = host_camera(kind, 0, 1);
        camera.projection[ortho ? 9 : 13] = 0.1f;
        assert_refused(&camera);
        for (int i = 0; i < 3; i++) { /* singular */
            camera = host_camera(kind, 0, 1);
            camera.projection[5 * i] = 0;
            camera.projection[14] = i == 2 ? 0 : camera.projection[14];
            assert_refused(&camera);
            camera = host_camera(kind, 0, 1);
            camera.view[i] = camera.view[4 + i] = camera.view[8 + i] = 0;
            assert_refused(&camera);
        }
        camera = host_camera(kind, 0, 1); /* neither perspective nor orthographic */
        camera.projection[11] = camera.projection[15] = 0;
        assert_refused(&camera);
        camera.projection[11] = camera.projection[15] = 1;
        assert_refused(&camera);
        for (int i = 3; i < 16; i += 4) { /* a view is affine */
            camera = host_camera(kind, 0, 1);
            camera.view[i] += 0.5f;
            assert_refused(&camera);
        }
    }
    memset(&camera, 0, sizeof camera);
    assert_refused(&camera);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_convention_gives_the_same_camera),
        cmocka_unit_test(depth_gives_the_position_back),
        cmocka_unit_test(what_cannot_be_drawn_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
