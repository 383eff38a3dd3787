/* Halos and trails are those of METHODS 3, 2.7 and 9.1: the oracles hold, displacement is linear in
   view depth under every projection, a trail's ends move with time without a jump, and no input
   gives anything but numbers. */
#include "core_host.h"
#include "near.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static uint32_t seed = 3;
static float any(double low, double high) {
    return (float)core_between(&seed, low, high);
}

/* ------------------------------------------------------------------------------------------ halos
 */

static void displacement_oracles(void **state) {
    float begin = lao_halo_begin(0.1f, LAO_HALO_DEPTH);
    (void)state;
    assert_near(begin, 0.8, 1e-7);
    assert_near(lao_halo_begin(0.1f, LAO_HALO_UNIFORM), 0.9, 1e-7);
    assert_true(lao_halo_displacement(0.79f, begin, LAO_HALO_SQRT) == 0);
    assert_near(lao_halo_displacement(0.8f, begin, LAO_HALO_SQRT), 0.894427, 1e-6);
    assert_true(lao_halo_displacement(1, begin, LAO_HALO_SQRT) == 1);
    assert_near(lao_halo_displacement(0.9f, begin, LAO_HALO_LINEAR), 0.9, 1e-7);
    assert_near(lao_halo_displacement(0.9f, begin, LAO_HALO_SQUARE), 0.81, 1e-7);
    /* what of a halo is seen before something `gap` behind it, D = 1: s up to gap^2 */
    for (int i = 0; i <= 1000; i++) {
        float s = (float)i / 1000;
        double back = (double)lao_halo_displacement(s, begin, LAO_HALO_SQRT);
        assert_false(s >= begin && back < 0.5);
        assert_int_equal(s >= begin && back < 0.95, s >= begin && (double)s < 0.9025);
        assert_true(back <= 1);
    }
}

static void border_colours(void **state) {
    float begin = lao_halo_begin(0.1f, LAO_HALO_DEPTH);
    (void)state;
    assert_true(lao_halo_light(0.79f, begin, LAO_HALO_HARD) == 1);
    assert_true(lao_halo_light(0.81f, begin, LAO_HALO_HARD) == 0);
    assert_true(lao_halo_light(0.79f, begin, LAO_HALO_SOFT) == 1);
    assert_near(lao_halo_light(0.9f, begin, LAO_HALO_SOFT), 0.25, 1e-5);
    assert_true(lao_halo_light(1, begin, LAO_HALO_SOFT) == 0);
    for (int i = 0; i < 128; i++) { /* through a byte and back */
        float light = (float)i / 127, byte = lao_floor(lao_light_pack(light) * 255 + 0.5f);
        assert_true(byte >= 128);
        assert_near(lao_light_unpack(byte / 255), light, 1e-5);
    }
    assert_true(lao_light_unpack(1) == 1);
    assert_true(lao_light_unpack(128.0f / 255) == 0);
}

/* u->unproject as lao_render makes it, of a camera with near 2 and far 50. */
static lao_v4 unproject_of(int orthographic, int reversed) {
    double n = reversed ? 50 : 2, f = reversed ? 2 : 50;
    if (orthographic)
        return lao_v4_make((float)(-n / (f - n)), -1, (float)(-1 / (f - n)), 0);
    return lao_v4_make((float)(-n * f / (f - n)), 0, (float)(-f / (f - n)), 1);
}

static void displacement_is_linear_in_view_depth(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        lao_v4 u = unproject_of(kind & 1, kind & 2);
        double last = kind & 2 ? 2 : -1;
        for (int i = 0; i <= 480; i++) {
            double z = 2 + 0.1 * i, d = (double)lao_window_depth(u, (float)z), n = 2, f = 50;
            double normal = kind & 1 ? (z - n) / (f - n) : f * (z - n) / (z * (f - n));
            assert_near(d, kind & 2 ? 1 - normal : normal, 1e-6);
            assert_near(((double)u.x + (double)u.y * d) / ((double)u.z + (double)u.w * d), z, 3e-4);
            assert_true(kind & 2 ? d < last : d > last); /* the depth test keeps their order */
            last = d;
            d = (double)lao_halo_depth(u, (float)z);
            assert_true(d > 0 && d < 1); /* not hidden by the cleared buffer */
        }
        assert_true(lao_halo_depth(u, 400) > 0 && lao_halo_depth(u, 400) < 1);
    }
}

static void outlines_of_ribbons(void **state) {
    lao_v3 away = lao_v3_make(0, 0, -1), x;
    lao_v2 beside;
    (void)state;
    /* across alone where ends are open or mitred */
    assert_near(lao_rim(lao_rim_corner(-1, true, 0, 5)), 1, 0);
    assert_near(lao_rim(lao_v3_make(0.3f, 0, -5)), 0.3, 1e-7);
    assert_near(lao_rim(lao_v3_make(0.3f, 0.7f, -5.7f)), 0.7, 1e-7);
    x = lao_rim_corner(1, false, 1, 5); /* the start: 1 beyond itself, 6 before the end */
    assert_near(x.y, -6, 0);
    assert_near(x.z, 1, 0);
    /* a line along +x ends at the origin, its neighbour leaves along +y, half widths 2 */
    beside = lao_rim_neighbour(lao_v3_make(1, -2, 7), away, lao_v3_make(0, 9, 0), 2, 1, 1);
    assert_near(lao_abs(beside.x), 0.5, 1e-6);
    assert_near(beside.y, 1, 1e-6);
    beside = lao_rim_neighbour(lao_v3_make(1, -3, 7), away, lao_v3_make(0, 9, 0), 2, -1, 1);
    assert_near(beside.y, -1.5, 1e-6);
    beside = lao_rim_neighbour(lao_v3_make(1, -2, 7), away, lao_v3_make(0, 9, 0), 2, 1, 0);
    assert_near(lao_rim_union(0.95f, beside), 0.95, 1e-7);
    assert_near(lao_rim_union(0.95f, lao_v2_make(-0.5f, -3)), 0.5, 0);
}

/* ----------------------------------------------------------------------------------------- trails
 */

static void taper_oracles(void **state) {
    float third = 1.0f / 3;
    (void)state;
    assert_true(lao_trail_width(0, third, 0.25f) == 1);
    assert_near(lao_trail_width(third, third, 0.25f), 1, 1e-6);
    assert_near(lao_trail_width(2 * third, third, 0.25f), 0.625, 1e-6);
    assert_near(lao_trail_width(1, third, 0.25f), 0.25, 1e-6);
    assert_true(lao_trail_width(1.0001f, third, 0.25f) == 0);
    assert_near(lao_trail_width(15.0f / 25, 0.25f, 0.25f), 0.65, 1e-6); /* the author's 1.25 - q */
    assert_near(lao_trail_opacity(2 * third, third), 0.5, 1e-6);
    assert_near(lao_trail_opacity(1, third), 0, 1e-6);
    for (int i = 0; i < 1000; i++) { /* the same before and behind */
        float dt = any(0, 40);
        assert_near(lao_trail_distance(100 + dt, 100, 0), dt, 1e-5);
        assert_near(lao_trail_distance(100 - dt, 100, 0), dt, 1e-5);
    }
}

static void highlight_oracles(void **state) {
    (void)state;
    assert_near(lao_trail_highlight(0, 1600), 1, 0);
    assert_near(lao_trail_highlight(33.302184f, 1600), 0.5, 1e-6);
    assert_near(lao_trail_highlight(1.1773f * 40, 1600), 0.25007, 1e-4);
    assert_true(lao_trail_highlight(1.1775f * 40, 1600) == 0.25f);
    assert_true(lao_trail_highlight(1e30f, 1e-3f) == 0.25f);
    {
        lao_v3 c = lao_desaturate(lao_v3_make(1, 0, 0));
        assert_near(c.x, 0.6063, 1e-6);
        assert_near(c.y, 0.1063, 1e-6);
        c = lao_desaturate(lao_v3_make(0.4f, 0.4f, 0.4f));
        assert_near(c.x, 0.4, 1e-7);
    }
}

static void clip_is_the_window(void **state) {
    (void)state;
    for (int i = 0; i < 200000; i++) {
        float t1 = any(-200, 1000), t2 = t1 + any(-30, 30), length = any(1, 60);
        float period = i % 2 ? any(300, 900) : 0, now = lao_trail_now(any(-900, 3000), period);
        lao_trail_part part;
        t2 = i % 17 ? t2 : t1;
        part = lao_trail_clip(t1, t2, now, length, period);
        for (int k = 0; k <= 8; k++) {
            double u = k / 8.0, t = (double)t1 + u * ((double)t2 - (double)t1);
            double q = t - (double)now, inside;
            q -= period > 0 ? (double)period * floor(q / (double)period + 0.5) : 0;
            inside = (double)length - fabs(q);
            if (inside > 1e-3)
                assert_true(part.first < part.last && u >= (double)part.first - 1e-3 &&
                            u <= (double)part.last + 1e-3);
            if (inside < -0.05 * (fabs((double)t2 - (double)t1) + 1))
                assert_true(part.first >= part.last || u <= (double)part.first + 1e-3 ||
                            u >= (double)part.last - 1e-3);
        }
    }
}

/* The end of a trail is where |t - now| = length, to rounding: it glides, by no whole segments. */
static void tips_glide(void **state) {
    double last = -1;
    (void)state;
    for (int i = 0; i <= 400; i++) {
        float now = 70 + 0.1f * (float)i, t1 = 100, t2 = 120;
        lao_trail_part part = lao_trail_clip(t1, t2, now, 25, 0);
        double tip = fmin(fmax(((double)now + 25 - 100) / 20, 0), 1),
               got = part.first < part.last ? part.last : 0;
        assert_near(got, tip, 2e-6);
        assert_true(got >= last);
        last = got;
    }
    assert_true(last == 1);
}

static void times_repeat(void **state) {
    (void)state;
    for (int i = 0; i < 20000; i++) {
        float period = 800.25f, t = any(-900, 900);
        float now = (float)(core_random(&seed) % 3201) * 0.25f; /* now + period has no rounding */
        now = now < period ? now : 0;
        for (int k = 1; k < 4; k++)
            assert_true(lao_trail_now(now, period) ==
                        lao_trail_now(now + (float)k * period, period));
        assert_true(lao_trail_distance(t, now, period) <= 0.5f * period * 1.000001f);
    }
    /* a whole period is all of every line */
    assert_true(lao_trail_clip(0, 800, 3, 400, 800).last == 1);
    assert_true(lao_trail_now(12.5f, 0) == 12.5f);
}

static void screen_door_is_even(void **state) {
    int seen[16] = {0};
    (void)state;
    for (uint32_t y = 0; y < 4; y++)
        for (uint32_t x = 0; x < 4; x++)
            seen[(int)(lao_screen_door(x, y) * 16)]++;
    for (int i = 0; i < 16; i++)
        assert_int_equal(seen[i], 1);
    for (uint32_t y = 0; y < 8; y += 2) { /* each pixel of 2 x 2 samples has one of every quarter */
        for (uint32_t x = 0; x < 8; x += 2) {
            int quarters[4] = {0};
            for (uint32_t k = 0; k < 4; k++)
                quarters[(int)(lao_screen_door(x + k % 2, y + k / 2) * 4)]++;
            for (int k = 0; k < 4; k++)
                assert_int_equal(quarters[k], 1);
        }
    }
}

static void everything_is_total(void **state) {
    static const float odd[] = {0, 1, -1, 1e-30f, 1e30f, -1e30f, 25, 833.33f};
    enum { ODD = sizeof odd / sizeof *odd };
    (void)state;
    for (int i = 0; i < 40000; i++) {
        float a = odd[core_random(&seed) % ODD], b = odd[core_random(&seed) % ODD];
        float c = odd[core_random(&seed) % ODD], period = i % 3 ? any(0.001, 1e6) : 0;
        lao_trail_part part =
            lao_trail_clip(a, b, lao_trail_now(c, period), any(0.001, 1e6), period);
        float r[6];
        r[0] = part.first;
        r[1] = part.last;
        r[2] = lao_halo_light(any(0, 1), any(0, 1), i % 2);
        r[3] = lao_halo_depth(unproject_of(i & 1, i & 2), any(-10, 1000));
        r[4] = lao_trail_width(any(0, 1), any(0, 0.999), any(0.001, 1));
        r[5] = lao_trail_highlight(a, any(0.001, 1e9));
        for (int k = 0; k < 6; k++)
            assert_true(r[k] >= 0 && r[k] <= 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(displacement_oracles),
        cmocka_unit_test(border_colours),
        cmocka_unit_test(displacement_is_linear_in_view_depth),
        cmocka_unit_test(outlines_of_ribbons),
        cmocka_unit_test(taper_oracles),
        cmocka_unit_test(highlight_oracles),
        cmocka_unit_test(clip_is_the_window),
        cmocka_unit_test(tips_glide),
        cmocka_unit_test(times_repeat),
        cmocka_unit_test(screen_door_is_even),
        cmocka_unit_test(everything_is_total),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
