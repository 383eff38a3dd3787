/* Colour maps are perceptually uniform: their lightness is monotone and even, their steps are of
 * one size, they stay within the display's gamut and are read back to the value that made them; a
 * range is what a sort of the values says; ticks are round numbers inside it. */
#include "colour.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *const names[] = {"viridis", "inferno",     "heat", "coolwarm",
                                    "phase",   "isoluminant", "gray"};
enum { MAPS = sizeof names / sizeof *names, LAST = COLOUR_STEPS - 1 };

static colour_map made(const char *name) {
    colour_map map;
    if (!colour_map_make(name, &map))
        fail_msg("no map %s", name);
    return map;
}

static void expect_near(double is, double want, double within, const char *what) {
    if (!(fabs(is - want) <= within))
        fail_msg("%s: %.9g is not %.9g within %g", what, is, want, within);
}

/* ---- spaces ----------------------------------------------------------------------------- */

/* Published values: Oklab of white and of linear red (Ottosson 2020), CIELAB of sRGB red, blue. */
static void spaces_have_published_values(void **state) {
    (void)state;
    const double white[3] = {1, 1, 1}, red[3] = {1, 0, 0}, blue[3] = {0, 0, 1};
    colour_lab lab = colour_lab_from_rgb(white);
    expect_near(lab.l, 1, 1e-6, "L of white");
    expect_near(hypot(lab.a, lab.b), 0, 1e-4, "chroma of white");
    lab = colour_lab_from_rgb(red);
    expect_near(lab.l, 0.62796, 1e-4, "L of red");
    expect_near(lab.a, 0.22486, 1e-4, "a of red");
    expect_near(lab.b, 0.12585, 1e-4, "b of red");
    lab = colour_cielab_from_rgb(red);
    expect_near(lab.l, 53.24, 0.01, "L* of red");
    expect_near(lab.a, 80.09, 0.02, "a* of red");
    expect_near(lab.b, 67.20, 0.02, "b* of red");
    lab = colour_cielab_from_rgb(blue);
    expect_near(lab.l, 32.30, 0.01, "L* of blue");
    expect_near(lab.a, 79.19, 0.02, "a* of blue");
    expect_near(lab.b, -107.86, 0.02, "b* of blue");
}

static void oklab_and_back_is_the_same_colour(void **state) {
    (void)state;
    for (int i = 0; i < 1000; i++) {
        const double rgb[3] = {i % 10 / 9.0, i / 10 % 10 / 9.0, i / 100 / 9.0};
        double back[3];
        colour_rgb_from_lab(colour_lab_from_rgb(rgb), back);
        for (int k = 0; k < 3; k++)
            expect_near(back[k], rgb[k], 1e-5, "channel");
    }
}

/* ---- maps ------------------------------------------------------------------------------- */

static void steps_are_of_one_size(void **state) {
    (void)state;
    for (int m = 0; m < MAPS; m++) {
        colour_map map = made(names[m]);
        double least = INFINITY, most = 0;
        for (int i = 0; i < LAST; i++) {
            double step = colour_difference(map.lab[i], map.lab[i + 1]);
            least = fmin(least, step);
            most = fmax(most, step);
        }
        if (!(least > 0) || most / least > 1.02)
            fail_msg("%s: steps from %g to %g", names[m], least, most);
    }
}

/* In CIELAB, another space than the one the maps are made in, over 16 steps of the bytes that are
 * shown. CIE76 takes strong chroma for more than it is, hence the room. */
static void steps_are_even_in_another_space_too(void **state) {
    (void)state;
    for (int m = 0; m < MAPS; m++) {
        colour_map map = made(names[m]);
        double least = INFINITY, most = 0;
        for (int i = 0; i < LAST; i += 16) {
            colour_lab ends[2];
            for (int e = 0; e < 2; e++) {
                double rgb[3];
                for (int k = 0; k < 3; k++)
                    rgb[k] = colour_byte(map.rgb[i + 16 * e][k]) / 255.0;
                ends[e] = colour_cielab_from_rgb(rgb);
            }
            double step = colour_difference(ends[0], ends[1]);
            least = fmin(least, step);
            most = fmax(most, step);
        }
        print_message("%-12s CIE76 between 17 colours: %.1f..%.1f\n", names[m], least, most);
        if (!(least > 3) || most / least > 2.5)
            fail_msg("%s: CIE76 from %g to %g", names[m], least, most);
    }
}

static void lightness_is_even(void **state) {
    (void)state;
    for (int m = 0; m < MAPS; m++) {
        colour_map map = made(names[m]);
        double first = map.lab[0].l, middle = map.lab[LAST / 2].l, last = map.lab[LAST].l;
        double bend = 0;
        for (int i = 0; i < LAST; i++) {
            double t = (double)i / LAST, rise = map.lab[i + 1].l - map.lab[i].l;
            double even = first + t * (last - first);
            if (map.kind == COLOUR_SEQUENTIAL && !(rise > 0))
                fail_msg("%s: lightness falls at %d", names[m], i);
            if (map.kind == COLOUR_DIVERGING) {
                if (!(i < LAST / 2 ? rise > 0 : rise < 0))
                    fail_msg("%s: lightness turns at %d", names[m], i);
                even = i < LAST / 2 ? first + 2 * t * (middle - first)
                                    : middle + (2 * t - 1) * (last - middle);
            }
            bend = fmax(bend, fabs(map.lab[i].l - even));
        }
        print_message("%-12s lightness %.2f %.2f %.2f, off a straight line by %.3f\n", names[m],
                      first, middle, last, bend);
        if (bend > 0.03)
            fail_msg("%s: lightness is off its line by %g", names[m], bend);
        if (map.kind == COLOUR_CYCLIC || map.kind == COLOUR_ISOLUMINANT)
            expect_near(last, first, 1e-9, "even lightness");
    }
}

static void colours_are_within_the_gamut(void **state) {
    (void)state;
    for (int m = 0; m < MAPS; m++) {
        colour_map map = made(names[m]);
        for (int i = 0; i <= LAST; i++) {
            double rgb[3];
            colour_rgb_from_lab(map.lab[i], rgb);
            for (int k = 0; k < 3; k++) {
                if (rgb[k] < -0.012 || rgb[k] > 1.012)
                    fail_msg("%s: channel %d of colour %d is %g", names[m], k, i, rgb[k]);
            }
        }
    }
}

/* The ten colours that are published as viridis. */
static void viridis_is_viridis(void **state) {
    (void)state;
    static const uint32_t published[10] = {0x440154, 0x482878, 0x3e4989, 0x31688e, 0x26828e,
                                           0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725};
    colour_map map = made("viridis");
    for (int i = 0; i < 10; i++) {
        const double rgb[3] = {(published[i] >> 16) / 255.0, (published[i] >> 8 & 255) / 255.0,
                               (published[i] & 255) / 255.0};
        double ours[3];
        colour_map_at(&map, i / 9.0, ours);
        expect_near(colour_difference(colour_lab_from_rgb(rgb), colour_lab_from_rgb(ours)), 0,
                    0.025, "difference from viridis");
    }
}

static void special_kinds_keep_their_promise(void **state) {
    (void)state;
    colour_map phase = made("phase"), warm = made("coolwarm");
    expect_near(colour_difference(phase.lab[0], phase.lab[LAST]), 0, 1e-9, "ends of a cycle");
    expect_near(hypot(warm.lab[LAST / 2].a, warm.lab[LAST / 2].b), 0, 0.002, "neutral middle");
    double halves = colour_difference(warm.lab[LAST / 2 - 1], warm.lab[LAST / 2]) /
                    colour_difference(warm.lab[LAST / 2], warm.lab[LAST / 2 + 1]);
    expect_near(halves, 1, 0.02, "steps of both halves");
}

/* From the byte colours of the picture back to the value, half a step of the map at worst, and a
 * bit for the rounding of the bytes. */
static void a_colour_is_read_back_to_its_value(void **state) {
    (void)state;
    for (int m = 0; m < MAPS; m++) {
        colour_map map = made(names[m]);
        double worst = 0;
        for (int i = 1; i < 1000; i++) {
            double rgb[3], distance;
            colour_map_at(&map, i / 1000.0, rgb);
            for (int k = 0; k < 3; k++)
                rgb[k] = colour_byte(rgb[k]) / 255.0;
            double off = fabs(colour_map_find(&map, rgb, &distance) - i / 1000.0);
            worst = fmax(worst, map.kind == COLOUR_CYCLIC ? fmin(off, 1 - off) : off);
            assert_true(distance < 0.01);
        }
        if (worst > 1.5 / LAST)
            fail_msg("%s: read back wrong by %g", names[m], worst);
    }
}

static void ends_and_unknown_values_have_a_colour(void **state) {
    (void)state;
    colour_map map = made("viridis"), same = map;
    double rgb[3], end[3];
    const double beyond[4] = {-1, -INFINITY, 2, INFINITY};
    for (int i = 0; i < 4; i++) {
        colour_map_at(&map, beyond[i], rgb);
        colour_map_at(&map, i < 2 ? 0 : 1, end);
        assert_memory_equal(rgb, end, sizeof rgb);
    }
    colour_map_at(&map, NAN, rgb);
    assert_true(rgb[0] == rgb[1] && rgb[1] == rgb[2]);
    assert_false(colour_map_make("jet", &map));
    assert_memory_equal(&map, &same, sizeof map);
    char list[] = COLOUR_MAPS;
    int count = 0;
    for (char *at = strtok(list, "|"); at; at = strtok(NULL, "|"), count++)
        assert_string_equal(made(at).name, at);
    assert_int_equal(count, MAPS);
    assert_int_equal(colour_byte(NAN), 0);
    assert_int_equal(colour_byte(0.5), 128);
    assert_int_equal(colour_byte(7), 255);
}

/* ---- ranges ----------------------------------------------------------------------------- */

static int by_size(const void *x, const void *y) {
    double a = *(const double *)x, b = *(const double *)y;
    return (a > b) - (a < b);
}

static void percentiles_are_those_of_a_sort(void **state) {
    (void)state;
    uint32_t random = 1;
    for (int trial = 0; trial < 300; trial++) {
        double values[64], sorted[64];
        size_t count = (size_t)(trial % 64) + 1, finite = 0;
        for (size_t i = 0; i < count; i++) {
            random = random * 1664525u + 1013904223u;
            values[i] = trial % 3 == 0 ? (random >> 24) % 4 : (random >> 8) / 16777216.0;
            if ((random >> 4) % 11 == 0)
                values[i] = (random >> 5) % 2 ? NAN : -INFINITY;
            if (isfinite(values[i]))
                sorted[finite++] = values[i];
        }
        qsort(sorted, finite, sizeof *sorted, by_size);
        double percent = (random >> 16) % 101, is = colour_percentile(values, count, percent);
        if (finite == 0) {
            assert_true(isnan(is));
            continue;
        }
        double x = (double)(finite - 1) * percent / 100;
        size_t k = (size_t)x;
        double next = k + 1 < finite ? sorted[k + 1] : sorted[k];
        expect_near(is, sorted[k] + (x - (double)k) * (next - sorted[k]), 1e-12, "percentile");
    }
}

static void ranges_always_have_a_width(void **state) {
    (void)state;
    const colour_end all[2] = {{0, true}, {100, true}}, mixed[2] = {{7, false}, {50, true}};
    const colour_end most[2] = {{2, true}, {98, true}}, turned[2] = {{9, false}, {-9, false}};
    double values[101], range[2], none[2] = {NAN, INFINITY}, one[1] = {4};
    for (int i = 0; i <= 100; i++)
        values[i] = (i * 37) % 101;
    colour_range(values, 101, most, range);
    expect_near(range[0], 2, 1e-12, "2 %");
    expect_near(range[1], 98, 1e-12, "98 %");
    colour_range(values, 101, all, range);
    assert_true(range[0] == 0 && range[1] == 100);
    colour_range(values, 101, mixed, range);
    assert_true(range[0] == 7 && range[1] == 50);
    colour_range(values, 101, turned, range);
    assert_true(range[0] == 9 && range[1] == -9);
    const colour_end middle[2] = {{50, true}, {75, true}};
    double holes[5] = {1, 2, NAN, 4, 5};
    colour_range(holes, 5, middle, range); /* both of the same four */
    assert_true(range[0] == 3 && range[1] == 4.25);
    colour_range(none, 2, most, range);
    assert_true(range[0] == -1 && range[1] == 1);
    colour_range(NULL, 0, most, range);
    assert_true(range[0] == -1 && range[1] == 1);
    colour_range(one, 1, most, range);
    assert_true(range[0] == 3 && range[1] == 5);
}

/* ---- ticks ------------------------------------------------------------------------------ */

static void ticks_are_round_and_inside(void **state) {
    (void)state;
    uint32_t random = 7;
    for (int trial = 0; trial < 2000; trial++) {
        double ends[2];
        for (int i = 0; i < 2; i++) {
            random = random * 1664525u + 1013904223u;
            ends[i] = ((random >> 8) / 16777216.0 - 0.5) * pow(10, (int)(random >> 16) % 9 - 4);
        }
        uint32_t most = 3 + random % 8;
        double low = fmin(ends[0], ends[1]), high = fmax(ends[0], ends[1]);
        colour_ticks ticks = colour_ticks_make(ends[0], ends[1], most);
        assert_in_range(ticks.count, 1, most);
        double step = ticks.count > 1 ? ticks.at[1] - ticks.at[0] : 0;
        char texts[COLOUR_TICKS][32];
        for (uint32_t i = 0; i < ticks.count; i++) {
            colour_tick_text(&ticks, i, texts[i], sizeof texts[i]);
            assert_true(ticks.at[i] >= low - 1e-8 * (high - low) &&
                        ticks.at[i] <= high + 1e-8 * (high - low));
            if (step > 0) {
                double digit = step / pow(10, floor(log10(step) + 1e-9));
                assert_true(fabs(digit - 1) < 1e-6 || fabs(digit - 2) < 1e-6 ||
                            fabs(digit - 5) < 1e-6);
                expect_near(atof(texts[i]), ticks.at[i], 1e-3 * step, texts[i]);
            }
            for (uint32_t j = 0; j < i; j++)
                assert_string_not_equal(texts[i], texts[j]);
        }
        if (ticks.count > 1) /* not much fewer than there is room for */
            assert_true((ticks.count + 1) * step > 0.999 * (high - low) && ticks.count * 6 >= most);
    }
}

static void expect_ticks(double a, double b, uint32_t most, const char *want) {
    colour_ticks ticks = colour_ticks_make(a, b, most);
    char text[256] = "";
    for (uint32_t i = 0; i < ticks.count; i++) {
        char one[32];
        colour_tick_text(&ticks, i, one, sizeof one);
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", i ? " " : "", one);
    }
    assert_string_equal(text, want);
}

static void ticks_read_well(void **state) {
    (void)state;
    expect_ticks(0, 1, 6, "0.0 0.2 0.4 0.6 0.8 1.0");
    expect_ticks(1, 0, 6, "0.0 0.2 0.4 0.6 0.8 1.0");
    expect_ticks(0.013, 0.997, 5, "0.2 0.4 0.6 0.8");
    expect_ticks(-833, 833, 5, "-500 0 500");
    expect_ticks(12, 831, 6, "200 400 600 800");
    expect_ticks(0, 2.5e7, 4, "0 1e+07 2e+07");
    expect_ticks(0, 2.4e-7, 4, "0 1e-07 2e-07");
    expect_ticks(3, 3, 6, "");
    expect_ticks(0, INFINITY, 6, "");
    expect_ticks(NAN, 1, 6, "");
}

/* ---- directions ------------------------------------------------------------------------- */

static void directions_are_axial_and_total(void **state) {
    (void)state;
    double x[3], back[3], none[3], missing[3];
    colour_direction(1, 2, -3, x);
    colour_direction(-2, -4, 6, back);
    assert_memory_equal(x, back, sizeof x);
    assert_true(x[2] > x[1] && x[1] > x[0]);
    colour_direction(1e-200, 0, 0, x);
    colour_missing(missing);
    const double bad[4][3] = {{0, 0, 0}, {NAN, 0, 1}, {INFINITY, 1, 1}, {1, -INFINITY, 0}};
    for (int i = 0; i < 4; i++) {
        colour_direction(bad[i][0], bad[i][1], bad[i][2], none);
        assert_memory_equal(none, missing, sizeof none);
    }
    for (uint32_t i = 0; i < 4000; i++) {
        colour_of_line(i, x);
        colour_of_line(i + 1, back);
        for (int k = 0; k < 3; k++)
            assert_true(x[k] >= 0 && x[k] <= 1);
        assert_true(colour_difference(colour_lab_from_rgb(x), colour_lab_from_rgb(back)) > 0.1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spaces_have_published_values),
        cmocka_unit_test(oklab_and_back_is_the_same_colour),
        cmocka_unit_test(steps_are_of_one_size),
        cmocka_unit_test(steps_are_even_in_another_space_too),
        cmocka_unit_test(lightness_is_even),
        cmocka_unit_test(colours_are_within_the_gamut),
        cmocka_unit_test(viridis_is_viridis),
        cmocka_unit_test(special_kinds_keep_their_promise),
        cmocka_unit_test(a_colour_is_read_back_to_its_value),
        cmocka_unit_test(ends_and_unknown_values_have_a_colour),
        cmocka_unit_test(percentiles_are_those_of_a_sort),
        cmocka_unit_test(ranges_always_have_a_width),
        cmocka_unit_test(ticks_are_round_and_inside),
        cmocka_unit_test(ticks_read_well),
        cmocka_unit_test(directions_are_axial_and_total),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
