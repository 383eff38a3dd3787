/* Ribbons have neither gaps nor notches: neighbouring quads share their corners for turns up to 90
   degrees, sharper turns cover the wedge between them, no segment is thinner than its width, and
   closed lines have no seam. */
#include "core_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define PI 3.14159265358979323846

static uint32_t seed = 7;
static float any(double low, double high) {
    return (float)core_between(&seed, low, high);
}

/* The four corners of a segment as shaders/lines.glsl makes them, seen along `e`. */
typedef struct quad {
    lao_v3 corner[4]; /* start -, start +, end -, end + */
} quad;

static quad quad_of(lao_v3 e, lao_v3 before, lao_v3 p1, lao_v3 p2, lao_v3 after, float half_width) {
    quad q;
    for (int at_end = 0; at_end < 2; at_end++) {
        lao_v3 p = at_end ? p2 : p1;
        lao_v3 other = at_end ? lao_v3_sub(after, p2) : lao_v3_sub(p1, before);
        lao_line_end end =
            lao_line_join(e, lao_v3_sub(p2, p1), other, half_width, at_end ? 1.0f : -1.0f);
        for (int side = 0; side < 2; side++) {
            q.corner[2 * at_end + side] =
                lao_v3_add(lao_v3_along(p, end.across, side ? 1.0f : -1.0f), end.along);
        }
    }
    return q;
}

static double area(lao_v3 a, lao_v3 b, double x, double y) {
    return ((double)b.x - a.x) * (y - a.y) - ((double)b.y - a.y) * (x - a.x);
}

static int triangle_covers(lao_v3 a, lao_v3 b, lao_v3 c, double x, double y) {
    double u = area(a, b, x, y), v = area(b, c, x, y), w = area(c, a, x, y), slack = 1e-6;
    return (u >= -slack && v >= -slack && w >= -slack) || (u <= slack && v <= slack && w <= slack);
}

/* The triangles of the index buffer: 0 1 2, 2 1 3. */
static int quad_covers(const quad *q, double x, double y) {
    return triangle_covers(q->corner[0], q->corner[1], q->corner[2], x, y) ||
           triangle_covers(q->corner[2], q->corner[1], q->corner[3], x, y);
}

/* The side of a turn: +1 when quads share corners there. */
static int shared(const quad *a, const quad *b) {
    return memcmp(&a->corner[2], &b->corner[0], 2 * sizeof a->corner[0]) == 0;
}

static const lao_v3 away = {0, 0, -1};

static void corners_are_shared_up_to_90_degrees(void **state) {
    (void)state;
    for (int i = 0; i < 20000; i++) {
        /* any view, any two segments much longer than wide, any turn as seen */
        lao_v3 e = lao_v3_make(any(-1, 1), any(-1, 1), any(-2, -1)), p[4],
               unit = lao_v3_unit(e, away);
        float half_width = any(0.01, 0.5);
        lao_v3 d1, d2, c1, c2;
        quad a, b;
        double turn;
        do {
            for (int k = 0; k < 4; k++) {
                p[k] = lao_v3_make(any(-50, 50), any(-50, 50), any(-50, 50));
            }
            d1 = lao_v3_unit(lao_v3_sub(p[1], p[0]), e);
            d2 = lao_v3_unit(lao_v3_sub(p[2], p[1]), e);
            c1 = lao_v3_cross(unit, d1);
            c2 = lao_v3_cross(unit, d2);
        } while (lao_v3_dot(c1, c1) < 0.01f || lao_v3_dot(c2, c2) < 0.01f ||
                 lao_v3_dot(lao_v3_sub(p[1], p[0]), lao_v3_sub(p[1], p[0])) < 100 ||
                 lao_v3_dot(lao_v3_sub(p[2], p[1]), lao_v3_sub(p[2], p[1])) < 100);
        turn = (double)lao_v3_dot(lao_v3_unit(c1, e), lao_v3_unit(c2, e));
        a = quad_of(e, p[0], p[0], p[1], p[2], half_width);
        b = quad_of(e, p[0], p[1], p[2], p[2], half_width);
        if (fabs(turn) > 1e-6) {
            assert_int_equal(shared(&a, &b), turn > 0);
        }
    }
    { /* exactly straight, exactly 90 */
        lao_v3 p0 = {-1, 0, 0}, p1 = {0, 0, 0}, p2 = {1, 0, 0}, p3 = {0, 1, 0};
        quad a = quad_of(away, p0, p0, p1, p2, 0.1f), b = quad_of(away, p0, p1, p2, p2, 0.1f);
        assert_true(shared(&a, &b));
        a = quad_of(away, p0, p0, p1, p3, 0.1f);
        b = quad_of(away, p0, p1, p3, p3, 0.1f);
        assert_true(shared(&a, &b));
    }
}

/* What butt ends would leave open: the part of the disc around the joint that lies beyond both
   segments. Also the disc itself where the segments are long enough to reach all of it. */
static void joints_have_no_gap(void **state) {
    (void)state;
    for (int degrees = -180; degrees <= 180; degrees++) {
        for (int trial = 0; trial < 12; trial++) {
            double angle = degrees * PI / 180, half_width = 1;
            double long1 = trial < 4 ? 5 : (double)any(0.02, 3),
                   long2 = trial < 4 ? 5 : (double)any(0.02, 3);
            double d1x = 1, d1y = 0, d2x = cos(angle), d2y = sin(angle);
            lao_v3 p0 = lao_v3_make((float)-long1, 0, trial % 2 ? any(-3, 3) : 0), p1 = {0, 0, 0};
            lao_v3 p2 =
                lao_v3_make((float)(long2 * d2x), (float)(long2 * d2y), trial % 2 ? any(-3, 3) : 0);
            quad a = quad_of(away, p0, p0, p1, p2, (float)half_width),
                 b = quad_of(away, p0, p1, p2, p2, (float)half_width);
            for (int i = 0; i < 60; i++) {
                double t = (double)any(0, 2 * PI), r = half_width * 0.999 * sqrt((double)any(0, 1)),
                       x = r * cos(t), y = r * sin(t);
                int beyond = x * d1x + y * d1y >= 0 && x * d2x + y * d2y <= 0;
                if (abs(degrees) == 180 && trial >= 4) {
                    continue;
                }
                if (beyond || (long1 >= 1.5 && long2 >= 1.5)) {
                    if (!quad_covers(&a, x, y) && !quad_covers(&b, x, y)) {
                        fail_msg("turn of %d degrees, lengths %g %g: (%g, %g) is open", degrees,
                                 long1, long2, x, y);
                    }
                }
            }
        }
    }
}

static void no_segment_is_thinner_than_its_width(void **state) {
    (void)state;
    for (int i = 0; i < 40000; i++) {
        lao_v3 e = lao_v3_unit(lao_v3_make(any(-1, 1), any(-1, 1), any(-2, -1)), away);
        lao_v3 own = lao_v3_make(any(-1, 1), any(-1, 1), any(-1, 1)),
               other = lao_v3_make(any(-1, 1), any(-1, 1), any(-1, 1));
        lao_v3 o = lao_v3_cross(e, lao_v3_unit(own, e));
        float half_width = any(0.01, 2);
        lao_line_end end;
        double on;
        if (lao_v3_dot(o, o) < 0.01f || lao_v3_dot(own, own) < 0.01f) {
            continue;
        }
        o = lao_v3_unit(o, e);
        end = lao_line_join(e, own, other, half_width, i % 2 ? 1.0f : -1.0f);
        on = (double)lao_v3_dot(end.across, o);
        if (!(fabs(on - (double)half_width) < 2e-5 * (double)half_width)) {
            fail_msg("half width %g, not %g", on, (double)half_width);
        }
        assert_true(fabs((double)lao_v3_dot(end.along, o)) < 1e-5 * (double)half_width);
        assert_true(fabs((double)lao_v3_dot(end.across, e)) <
                    1e-5 * (double)half_width); /* view-aligned */
        assert_true(fabs((double)lao_v3_dot(end.normal, o) - 1) < 1e-5);
        assert_true(fabs((double)lao_v3_dot(end.tangent, end.tangent) - 1) < 1e-5);
        /* no corner is far from the joint: the mitre's limit */
        assert_true((double)lao_v3_dot(end.across, end.across) <
                    2.01 * (double)half_width * (double)half_width);
        assert_true((double)lao_v3_dot(end.along, end.along) <
                    1.01 * (double)half_width * (double)half_width);
    }
}

static void degenerate_ends(void **state) {
    lao_v3 own = {3, 0, 0}, none = {0, 0, 0}, end_on = {0, 0, -2};
    lao_line_end end = lao_line_join(away, own, none, 0.5f, 1);
    (void)state;
    /* no neighbour: a butt end */
    assert_true(end.along.x == 0 && end.along.y == 0 && end.along.z == 0);
    assert_true(fabsf(end.across.y) == 0.5f && end.across.x == 0);
    assert_true(end.tangent.x == 1);
    /* a neighbour that is seen end-on bends nothing */
    end = lao_line_join(away, own, end_on, 0.5f, 1);
    assert_true(fabsf(end.across.y) == 0.5f && end.across.x == 0);
    /* seen end-on itself: across the camera's right */
    end = lao_line_join(away, end_on, none, 0.5f, 1);
    assert_true(end.across.x == 0.5f && end.across.y == 0 && end.across.z == 0);
    /* straight back: square ends on both sides of the joint */
    end = lao_line_join(away, own, lao_v3_scale(own, -1), 0.5f, 1);
    assert_true(fabsf(end.along.x - 0.5f) < 1e-6f);
    end = lao_line_join(away, own, lao_v3_scale(own, -1), 0.5f, -1);
    assert_true(fabsf(end.along.x + 0.5f) < 1e-6f);
    /* the two ends of a joint agree about their tangent, so that shading does not jump */
    for (int i = 0; i < 1000; i++) {
        lao_v3 a = lao_v3_make(1, any(-0.5, 0.5), any(-1, 1)),
               b = lao_v3_make(1, any(-0.5, 0.5), any(-1, 1));
        lao_line_end first = lao_line_join(away, a, b, 0.1f, 1),
                     second = lao_line_join(away, b, a, 0.1f, -1);
        assert_memory_equal(&first.tangent, &second.tangent, sizeof first.tangent);
    }
}

/* Through lao_lines_create, with the texels that a backend gets. */
static void closed_lines_have_no_seam(void **state) {
    enum { CORNERS = 24 };
    float points[3 * (CORNERS + 1)];
    core_host host;
    lao_desc desc;
    lao_lines_desc set;
    lao_lines lines;
    lao_backend backend = core_backend(0);
    lao_context *context;
    (void)state;
    memset(&host, 0, sizeof host);
    memset(&desc, 0, sizeof desc);
    memset(&set, 0, sizeof set);
    desc.backend = &backend;
    desc.logger = core_logger(&host);
    assert_int_equal(lao_create(&desc, &context), LAO_OK);
    for (int corners = 3; corners <= CORNERS; corners++) {
        int joints = 0, segments = 0;
        quad quads[CORNERS];
        for (int i = 0; i < corners; i++) {
            points[3 * i] = 10 * (float)cos(2 * PI * i / corners);
            points[3 * i + 1] = 10 * (float)sin(2 * PI * i / corners);
            points[3 * i + 2] = (float)(i % 3) - 20.0f;
        }
        memcpy(points + 3 * corners, points, 3 * sizeof *points);
        core_window_clear();
        set.line_count = 1;
        set.point_count = (uint32_t)corners + 1;
        set.points = points;
        assert_int_equal(lao_lines_create(context, &set, &lines), LAO_OK);
        assert_int_equal(core_seen.buffer_count, 2);
        for (uint32_t s = 0; s + 3 < core_seen.buffers[0].texel_count; s++) {
            lao_v3 p[4];
            const float *t = core_seen.buffers[0].texels + 4 * s;
            if (t[7] >= LAO_GHOST_TIME || t[11] >= LAO_GHOST_TIME) {
                continue;
            }
            for (int k = 0; k < 4; k++) {
                p[k] = lao_v3_make(t[4 * k], t[4 * k + 1], t[4 * k + 2]);
            }
            quads[segments++] = quad_of(away, p[0], p[1], p[2], p[3], 0.3f);
        }
        assert_int_equal(segments, corners);
        for (int i = 0; i < segments; i++) {
            joints += shared(&quads[i], &quads[(i + 1) % segments]);
        }
        assert_int_equal(
            joints,
            corners == 3 ? 0 : corners); /* a triangle turns by 120 degrees, a square by 90 */
        assert_int_equal(lao_lines_destroy(context, lines), LAO_OK);
    }
    assert_int_equal(host.logs, 0);
    lao_destroy(context);
}

/* Every point of a ball is seen within its size of the centre, in perspective and without. */
static void balls_are_not_larger(void **state) {
    const lao_v4 scale = lao_v4_make(700, 900, 0, 0);
    (void)state;
    for (int i = 0; i < 200000; i++) {
        const int flat = i & 1;
        const double r = core_between(&seed, 0.001, 3), a = core_between(&seed, 0, 2 * PI);
        const double c = core_between(&seed, -1, 1), s = sqrt(1 - c * c);
        lao_v3 p = lao_v3_make(any(-60, 60), any(-60, 60), any(-90, -3.5));
        lao_v2 size = lao_ball_size(p, (float)r, scale, (float)flat);
        double x = p.x + r * s * cos(a), y = p.y + r * s * sin(a), z = p.z + r * c;
        double dx = flat ? x - p.x : x / -z - p.x / (double)-p.z;
        double dy = flat ? y - p.y : y / -z - p.y / (double)-p.z;
        assert_true(fabs(700 * dx) <= size.x * 1.00001 && fabs(900 * dy) <= size.y * 1.00001);
    }
    assert_true(lao_ball_size(lao_v3_make(0, 0, -1), 2, scale, 0).x < 0); /* around the eye */
    assert_true(lao_behind(0.6f, 0.5f, 0) && !lao_behind(0.5f, 0.5f, 0));
    assert_true(lao_behind(0.4f, 0.5f, 1) && !lao_behind(0.6f, 0.5f, 1));
    assert_false(lao_behind(0.50001f, 0.5f, 0));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_are_shared_up_to_90_degrees),
        cmocka_unit_test(joints_have_no_gap),
        cmocka_unit_test(no_segment_is_thinner_than_its_width),
        cmocka_unit_test(degenerate_ends),
        cmocka_unit_test(closed_lines_have_no_seam),
        cmocka_unit_test(balls_are_not_larger),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
