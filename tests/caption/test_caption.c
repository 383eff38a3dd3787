/* Text and legends stay within their boxes, can be read on any background, grow with the picture,
 * and show at every tick the colour of the value that is written there. */
#include "legend.h"
#include "text.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static picture filled(uint32_t width, uint32_t height, double grey) {
    const double rgb[3] = {grey, grey, grey};
    picture p;
    assert_true(picture_make(width, height, &p));
    picture_fill(&p, 0, 0, width, height, rgb, 1);
    return p;
}

/* Box of all pixels that differ from the first: left, upper, right, lower; left > right: none. */
static void changed(const picture *p, int64_t box[4]) {
    box[0] = p->width;
    box[1] = p->height;
    box[2] = box[3] = -1;
    for (int64_t i = 0; i < (int64_t)p->width * p->height; i++) {
        int64_t x = i % p->width, y = i / p->width;
        if (memcmp(p->pixels + 4 * i, p->pixels, 4) != 0) {
            box[0] = x < box[0] ? x : box[0];
            box[1] = y < box[1] ? y : box[1];
            box[2] = x > box[2] ? x : box[2];
            box[3] = y > box[3] ? y : box[3];
        }
    }
}

static text_style style_of(double size) {
    text_style style;
    memset(&style, 0, sizeof style);
    style.size = size;
    return style;
}

/* ---- text ------------------------------------------------------------------------------- */

static void text_stands_in_its_box(void **state) {
    (void)state;
    static const char *const texts[] = {"speed (m/s)", "-0.25", "gqyp", "0", "1.5e+06"};
    for (int i = 0; i < 5 * 3 * 3; i++) {
        const char *text = texts[i % 5];
        text_style style = style_of(15 + 13 * (i / 5 % 3));
        text_anchor anchor = (text_anchor)(i / 15);
        picture p = filled(600, 100, 1);
        int64_t box[4], width = text_width(text, &style);
        assert_true(text_draw(&p, 300, 20, anchor, text, &style));
        changed(&p, box);
        int64_t left = anchor == TEXT_LEFT     ? 300
                       : anchor == TEXT_CENTER ? 300 - width / 2
                                               : 300 - width;
        assert_true(box[0] >= left - 1 && box[2] <= left + width + 1);
        assert_true(box[2] - box[0] > width / 3); /* and fills it */
        assert_true(box[1] >= 19 && box[3] <= 21 + (int64_t)style.size);
        picture_free(&p);
    }
}

static void text_may_leave_the_picture(void **state) {
    (void)state;
    text_style style = style_of(30);
    style.outline_width = 3;
    picture p = filled(20, 20, 1);
    const int64_t places[][2] = {{-40, 5}, {15, 5}, {5, -25}, {5, 18}, {-100000, 100000}};
    for (int i = 0; i < 5; i++)
        assert_true(text_draw(&p, places[i][0], places[i][1], TEXT_LEFT, "lines", &style));
    assert_true(text_draw(&p, 0, 0, TEXT_LEFT, "", &style));
    assert_int_equal(text_width("", &style), 0);
    picture_free(&p);
}

static void text_breaks_between_words(void **state) {
    (void)state;
    text_style style = style_of(20);
    const char *text = "one two three";
    assert_int_equal(text_fit(text, 10000, &style), strlen(text));
    assert_int_equal(text_fit(text, text_width("one two", &style) + 1, &style), 7);
    assert_int_equal(text_fit(text, text_width("one tw", &style), &style), 3);
    assert_int_equal(text_fit("abcdef", text_width("abc", &style), &style), 3);
    assert_int_equal(text_fit("abcdef", 0, &style), 1);
    assert_int_equal(text_fit("\xc3\xa4\xc3\xa4", 0, &style), 2); /* a whole character */
    assert_int_equal(text_fit("", 100, &style), 0);
    char longer[2000];
    memset(longer, 'i', sizeof longer);
    longer[sizeof longer - 1] = '\0';
    uint32_t fits = text_fit(longer, 1000000, &style);
    assert_true(fits > 100 && fits < 512);
}

/* ---- legends ---------------------------------------------------------------------------- */

/* The longest run of pixels along a column or row whose colours run through the map from one end to
 * the other: the bar. Returns its length. */
static uint32_t find_bar(const picture *p, const colour_map *map, bool upright) {
    uint32_t longest = 0, lines = upright ? p->width : p->height;
    uint32_t length = upright ? p->height : p->width;
    for (uint32_t line = 0; line < lines; line++) {
        uint32_t run = 0;
        double before = -1;
        for (uint32_t i = 0; i < length; i++) {
            uint32_t x = upright ? line : i, y = upright ? length - 1 - i : line;
            const uint8_t *c = p->pixels + 4 * ((size_t)y * p->width + x);
            const double rgb[3] = {c[0] / 255.0, c[1] / 255.0, c[2] / 255.0};
            double distance, at = colour_map_find(map, rgb, &distance);
            run = distance < 0.01 && at >= before - 0.01 ? run + 1 : 0;
            before = run ? at : -1;
            if (run > longest && at > 1 - 1.0 / run)
                longest = run;
        }
    }
    return longest;
}

static void bars_run_from_low_to_high(void **state) {
    (void)state;
    colour_map map;
    assert_true(colour_map_make("viridis", &map));
    const legend one = {&map, {0, 1.5}, "speed (m/s)"};
    for (int side = 0; side < 3; side++) {
        for (int dark = 0; dark < 2; dark++) {
            picture p = filled(640, 480, dark ? 0.06 : 0.96);
            int64_t box[4];
            assert_true(legend_draw(&p, (legend_side)side, &one, 1));
            uint32_t bar = find_bar(&p, &map, side != LEGEND_BOTTOM);
            uint32_t whole = side == LEGEND_BOTTOM ? 640 : 480;
            assert_in_range(bar, whole * 2 / 5, whole / 2);
            changed(&p, box); /* at its side, and within the picture */
            assert_true(box[0] > 2 && box[1] > 2 && box[2] < 637 && box[3] < 477);
            assert_true(side == LEGEND_LEFT    ? box[2] < 200
                        : side == LEGEND_RIGHT ? box[0] > 440
                                               : box[1] > 380);
            picture_free(&p);
        }
    }
}

/* Ink and what is around it differ by more than half of the way from black to white. */
static void ink_is_the_opposite_of_the_background(void **state) {
    (void)state;
    colour_map map;
    assert_true(colour_map_make("gray", &map));
    const legend one = {&map, {-1, 1}, "x"};
    for (int grey = 0; grey <= 10; grey++) {
        picture p = filled(500, 500, grey / 10.0);
        int darkest = 255, lightest = 0;
        assert_true(legend_draw(&p, LEGEND_RIGHT, &one, 1));
        for (size_t i = 0; i < 500 * 500; i++) {
            darkest = p.pixels[4 * i] < darkest ? p.pixels[4 * i] : darkest;
            lightest = p.pixels[4 * i] > lightest ? p.pixels[4 * i] : lightest;
            assert_int_equal(p.pixels[4 * i + 3], 255);
        }
        assert_true(darkest < 32 && lightest > 220);
        picture_free(&p);
    }
}

static bool ink(const uint8_t *pixel) {
    return pixel[0] + pixel[1] + pixel[2] < 120;
}

/* At the middle of each tick mark, the colour of the bar beside it is that of the tick's value. */
static void ticks_stand_at_their_values(void **state) {
    (void)state;
    colour_map map;
    assert_true(colour_map_make("isoluminant", &map));
    const legend one = {&map, {3.2, -2.3}, NULL};
    picture p = filled(800, 800, 1);
    assert_true(legend_draw(&p, LEGEND_LEFT, &one, 1));
    colour_ticks ticks = colour_ticks_make(3.2, -2.3, 7);
    uint32_t found = 0;
    /* tick marks: dark runs that begin where the bar ends */
    for (uint32_t y = 1; y + 1 < 800; y++) {
        for (uint32_t x = 8; x + 1 < 800; x++) {
            const uint8_t *c = p.pixels + 4 * ((size_t)y * 800 + x), *bar = c - 4 * 6;
            const double rgb[3] = {bar[0] / 255.0, bar[1] / 255.0, bar[2] / 255.0};
            double distance, at = colour_map_find(&map, rgb, &distance);
            bool rim = ink(c), beyond = ink(c + 4 * 4), above = ink(c + 4 * 4 - 3200);
            if (distance > 0.01 || !rim || !beyond || above || ink(c - 4))
                continue;
            double value = 3.2 - 5.5 * at, nearest = INFINITY;
            for (uint32_t i = 0; i < ticks.count; i++)
                nearest = fmin(nearest, fabs(ticks.at[i] - value));
            assert_true(nearest < 0.04);
            found++;
        }
    }
    assert_int_equal(found, ticks.count);
    picture_free(&p);
}

static void legends_grow_with_the_picture(void **state) {
    (void)state;
    colour_map map;
    assert_true(colour_map_make("heat", &map));
    const legend one = {&map, {0, 1}, "speed"};
    double width[2], height[2];
    for (int i = 0; i < 2; i++) {
        picture p = filled(600u << i, 600u << i, 1);
        int64_t box[4];
        assert_true(legend_draw(&p, LEGEND_RIGHT, &one, 1));
        changed(&p, box);
        width[i] = (double)(box[2] - box[0]);
        height[i] = (double)(box[3] - box[1]);
        picture_free(&p);
    }
    assert_true(height[1] > 1.8 * height[0] && height[1] < 2.2 * height[0]);
    assert_true(width[1] > 1.4 * width[0] && width[1] < 2.6 * width[0]);
}

static void several_legends_do_not_touch(void **state) {
    (void)state;
    colour_map maps[2];
    assert_true(colour_map_make("heat", &maps[0]) && colour_map_make("viridis", &maps[1]));
    const legend two[2] = {{&maps[0], {0, 1}, "a"}, {&maps[1], {0, 9}, "b"}};
    for (int side = 0; side < 3; side++) {
        picture p = filled(600, 600, 1);
        assert_true(legend_draw(&p, (legend_side)side, two, 2));
        for (int m = 0; m < 2; m++)
            assert_true(find_bar(&p, &maps[m], side != LEGEND_BOTTOM) > 200);
        picture_free(&p);
    }
}

/* In a picture of any size each legend that is drawn has a whole bar, none goes over the rim or the
 * middle, and what has no room is left out whole. */
static void legends_of_small_pictures_keep_apart(void **state) {
    static const uint32_t sizes[][3] = {/* width, height, at least so many */
                                        {320, 240, 2}, {180, 240, 2}, {200, 150, 1},
                                        {120, 90, 0},  {60, 60, 0},   {20, 20, 0}};
    colour_map maps[3];
    (void)state;
    assert_true(colour_map_make("heat", &maps[0]) && colour_map_make("viridis", &maps[1]) &&
                colour_map_make("coolwarm", &maps[2]));
    const legend three[3] = {{&maps[0], {0, 1}, "mm to flow"},
                             {&maps[1], {0, 1.2}, "concave"},
                             {&maps[2], {0, 1}, "speed (m/s)"}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        for (int side = 0; side < 3; side++) {
            uint32_t room = legend_room(sizes[i][0], sizes[i][1], (legend_side)side, three, 3);
            picture p = filled(sizes[i][0], sizes[i][1], 1);
            int64_t box[4];
            assert_in_range(room, sizes[i][2], 3);
            assert_true(legend_draw(&p, (legend_side)side, three, 3));
            changed(&p, box);
            assert_true(room > 0 || box[0] > box[2]);
            for (uint32_t m = 0; m < room; m++)
                assert_true(find_bar(&p, &maps[m], side != LEGEND_BOTTOM) >= 20);
            if (room > 0) { /* the middle of the picture stays free, and so does its rim */
                assert_true(box[0] > 0 && box[1] > 0 && box[2] < (int64_t)p.width - 1 &&
                            box[3] < (int64_t)p.height - 1);
                assert_true(side == LEGEND_LEFT    ? (double)box[2] < 0.62 * p.width
                            : side == LEGEND_RIGHT ? (double)box[0] > 0.38 * p.width
                                                   : (double)box[1] > 0.38 * p.height);
            }
            picture_free(&p);
        }
    }
}

static void strange_legends_are_drawn_too(void **state) {
    (void)state;
    colour_map map;
    assert_true(colour_map_make("coolwarm", &map));
    const double ranges[][2] = {{0, 0}, {NAN, 1}, {-1e300, 1e300}, {0, 1e-300}, {1e9, 1e9 + 1}};
    for (int i = 0; i < 5; i++) {
        const legend one = {
            &map, {ranges[i][0], ranges[i][1]}, "a title longer than the picture is wide"};
        for (uint32_t size = 1; size < 90; size += 22) {
            picture p = filled(size, size, 1);
            for (int side = 0; side < 3; side++)
                assert_true(legend_draw(&p, (legend_side)side, &one, 1));
            picture_free(&p);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_stands_in_its_box),
        cmocka_unit_test(text_may_leave_the_picture),
        cmocka_unit_test(text_breaks_between_words),
        cmocka_unit_test(bars_run_from_low_to_high),
        cmocka_unit_test(ink_is_the_opposite_of_the_background),
        cmocka_unit_test(ticks_stand_at_their_values),
        cmocka_unit_test(legends_grow_with_the_picture),
        cmocka_unit_test(several_legends_do_not_touch),
        cmocka_unit_test(legends_of_small_pictures_keep_apart),
        cmocka_unit_test(strange_legends_are_drawn_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
