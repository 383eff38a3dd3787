/* A value can be read off the picture: attributes of points and of lines become the colours that
 * the map says, over the range that was asked for; with luminance-preserving shading the value read
 * back from the finished picture is many times nearer to the true one than with multiplied shading,
 * while occlusion still is plain to see (Koehler et al. 2017, 5.2). */
#include "colour.h"

#include "cli/program.h"
#include "image.h"
#include "io.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char *program; /* its path, from the command line */

#define RUN(...) program_start(program, false, __VA_ARGS__)

static void expect_ok(program_run run) {
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    assert_string_equal(run.err, "");
    program_free(&run);
}

/* ---- lines ------------------------------------------------------------------------------ */

enum { LINES = 5, POINTS = 4 };

/* Straight lines, line i at x = shift + 2 i, with the line attribute "v" (values[i]) and the point
 * attributes "w" (-10 values[i]) and "time" (a point each 2 mm and 2 / values[i] ms). */
static void write_lines(const char *path, float shift, const float values[LINES]) {
    uint32_t offsets[LINES + 1] = {0};
    float points[3 * LINES * POINTS], w[LINES * POINTS], times[LINES * POINTS], v[LINES];
    io_attribute of_points[2] = {{(char[]){"w"}, 1, w}, {(char[]){"time"}, 1, times}};
    io_attribute of_lines = {(char[]){"v"}, 1, v};
    io_lines lines;
    io_error error;
    memset(&lines, 0, sizeof lines);
    for (uint32_t i = 0; i < LINES * POINTS; i++) {
        uint32_t line = i / POINTS;
        offsets[line + 1] = i + 1;
        points[3 * (size_t)i] = shift + 2 * (float)line;
        points[3 * (size_t)i + 1] = (float)(i % POINTS) * 2;
        points[3 * (size_t)i + 2] = 0;
        w[i] = -10 * values[line];
        times[i] = (float)(i % POINTS) * 2 / values[line];
        v[line] = values[line];
    }
    lines.line_count = LINES;
    lines.point_count = LINES * POINTS;
    lines.offsets = offsets;
    lines.points = points;
    lines.point_attribute_count = 2;
    lines.point_attributes = of_points;
    lines.line_attribute_count = 1;
    lines.line_attributes = &of_lines;
    assert_true(io_write_lines(path, &lines, &error));
}

/* The colours of a dump. */
typedef struct shot {
    image_exr exr;
    size_t count;
    const float *color[3], *out[3], *alpha, *mask, *ao;
} shot;

static shot read_shot(const char *path) {
    static const char *const names[9] = {"color.R", "color.G", "color.B", "out.R", "out.G",
                                         "out.B",   "mask.V",  "ao.V",    "out.A"};
    shot s;
    const float **at[9] = {&s.color[0], &s.color[1], &s.color[2], &s.out[0], &s.out[1],
                           &s.out[2],   &s.mask,     &s.ao,       &s.alpha};
    const image_part *part = NULL;
    assert_true(image_read_exr(path, &s.exr, NULL));
    for (int i = 0; i < 9; i++)
        *at[i] = image_exr_channel(&s.exr, names[i], i == 0 ? &part : NULL);
    assert_non_null(s.mask);
    assert_true(s.out[2] && s.alpha);
    s.count = (size_t)part->width * part->height;
    return s;
}

/* How many pixels have the color of `at` in the map (NaN: of an unknown value). */
static size_t count_color(const shot *s, const colour_map *map, double at) {
    double rgb[3];
    size_t found = 0;
    colour_map_at(map, at, rgb);
    for (size_t i = 0; i < s->count; i++) {
        bool same = s->alpha[i] > 0.5f;
        for (int k = 0; k < 3 && same; k++)
            same = fabs(s->out[k][i] * 255.0 - colour_byte(rgb[k])) < 0.6;
        found += same;
    }
    return found;
}

static size_t count_covered(const shot *s) {
    size_t found = 0;
    for (size_t i = 0; i < s->count; i++)
        found += s->alpha[i] > 0.5f;
    return found;
}

/* Each of the values has its color, and nothing else is there. */
static void expect_colors(const char *what, const char *map_name, const double *at, int count) {
    colour_map map;
    size_t found = 0;
    assert_true(colour_map_make(map_name, &map));
    expect_ok(RUN("render --size 120x90 --ssaa 1 --occlusion off --width 1 --view axial --show "
                  "color --halo none --background 0,0,0,0 --dump v.exr %s",
                  what));
    shot s = read_shot("v.exr");
    for (int i = 0; i < count; i++) {
        size_t here = count_color(&s, &map, at[i]);
        if (here < 20)
            fail_msg("%s: the color of %g is missing", what, at[i]);
        found += here;
    }
    if (found != count_covered(&s))
        fail_msg("%s: %zu of %zu pixels have other colors", what, count_covered(&s) - found,
                 count_covered(&s));
    image_exr_free(&s.exr);
}

static void values_have_their_colors(void **state) {
    (void)state;
    const float values[LINES] = {1, 2, NAN, 4, 5};
    const double even[LINES] = {0, 0.25, NAN, 0.75, 1}, half[LINES] = {0.1, 0.2, NAN, 0.4, 0.5};
    write_lines("v.vtp", 0, values);
    expect_colors("v.vtp --color v --range 1,5", "viridis", even, LINES);
    expect_colors("v.vtp --color v --range 0%,100% --colormap heat", "heat", even, LINES);
    expect_colors("v.vtp --color w --range -10,-50 --colormap coolwarm", "coolwarm", even, LINES);
    expect_colors("v.vtp --color v --range 0,10 --colormap phase", "phase", half, LINES);
    const double percent[3] = {0, NAN, 1}; /* 1 2 4 5: half-way between neighbours */
    expect_colors("v.vtp --color v --range 50%,51%", "viridis", percent, 3);
    const double mixed[LINES] = {0.2, 0.4, NAN, 0.8, 1};
    expect_colors("v.vtp --color v --range 0,100%", "viridis", mixed, LINES);
}

/* Way over time; the file has no attribute of that name. A file that has none of either fails. */
static void speed_comes_from_times(void **state) {
    (void)state;
    const float values[LINES] = {0.25f, 0.5f, NAN, 1, 2};
    const double at[LINES] = {0.125, 0.25, NAN, 0.5, 1};
    write_lines("s.vtp", 0, values);
    expect_colors("s.vtp --color speed --range 0,2", "viridis", at, LINES);
    expect_fault(RUN("render s.vtp --color fa -o x.png"), 1, "direction, line, w, time, v");
    expect_fault(RUN("render --scene bundle --color speed -o x.png"), 1, "speed");
}

/* One color is one value in the whole picture. */
static void files_share_a_range(void **state) {
    (void)state;
    const float low[LINES] = {1, 2, 3, 4, 5}, high[LINES] = {6, 7, 8, 9, 11};
    const double both[2 * LINES] = {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1};
    write_lines("low.vtp", 0, low);
    write_lines("high.vtp", 20, high);
    expect_colors("--color v --range 0%,100% low.vtp high.vtp", "viridis", both, 2 * LINES);
    const double own[LINES] = {0, 0.25, 0.5, 0.75, 1}; /* another range: each its own */
    expect_colors("low.vtp --color v --range 1,100% low.vtp --color v --range 0%,5", "viridis", own,
                  LINES);
}

static void wrong_ranges_are_refused(void **state) {
    static const char *const wrong[] = {"3,3",    "2%,2%", "1",     "1,",    "%,1",  "-1%,5",
                                        "1,101%", "a,b",   "1,2,3", "nan,1", "1%%,2"};
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        expect_fault(RUN("render --range %s -o x.png", wrong[i]), 2, "--range");
    expect_fault(RUN("render --colormap jet -o x.png"), 2, "viridis");
    expect_fault(RUN("render --legend top -o x.png"), 2, "off|left|right|bottom");
}

/* ---- reading values from pictures ------------------------------------------------------- */

/* What a reader makes of a picture. */
typedef struct reading {
    double error; /* mean of |value read - true value| over all covered pixels, part of the range */
    double cue;   /* mean difference to the unshaded color where much is occluded */
    double lightness; /* largest change of CIELAB lightness */
} reading;

static reading read_values(const char *map_name, const char *flags) {
    colour_map map;
    reading r = {0, 0, 0};
    size_t covered = 0, occluded = 0;
    assert_true(colour_map_make(map_name, &map));
    expect_ok(RUN("render --scene aorta --lines 1200 --size 240x200 --ssaa 1 --color speed "
                  "--range 0,1 --dump r.exr --colormap %s %s",
                  map_name, flags));
    shot s = read_shot("r.exr");
    assert_non_null(s.ao);
    for (size_t i = 0; i < s.count; i++) {
        if (s.mask[i] < 0.5f)
            continue;
        const double base[3] = {s.color[0][i], s.color[1][i], s.color[2][i]};
        const double out[3] = {s.out[0][i], s.out[1][i], s.out[2][i]};
        double off = colour_map_find(&map, out, NULL) - colour_map_find(&map, base, NULL);
        r.error += fabs(off);
        covered++;
        r.lightness =
            fmax(r.lightness, fabs(colour_cielab_from_rgb(out).l - colour_cielab_from_rgb(base).l));
        if (1.5f * s.ao[i] > 0.4f) {
            r.cue += colour_difference(colour_lab_from_rgb(base), colour_lab_from_rgb(out));
            occluded++;
        }
    }
    image_exr_free(&s.exr);
    assert_true(covered > 4000 && occluded > 100);
    r.error /= (double)covered;
    r.cue /= (double)occluded;
    return r;
}

/* As in Koehler's Fig. 7 (no illumination) and with our default illumination. */
static void shading_leaves_values_readable(void **state) {
    static const char *const cases[][2] = {{"viridis", "--ambient 1 --diffuse 0 --specular 0"},
                                           {"inferno", "--ambient 1 --diffuse 0 --specular 0"},
                                           {"heat", "--ambient 1 --diffuse 0 --specular 0"},
                                           {"coolwarm", "--ambient 1 --diffuse 0 --specular 0"},
                                           {"viridis", ""},
                                           {"heat", ""}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char flags[160];
        snprintf(flags, sizeof flags, "%s --ao-affects-color luminance_preserving", cases[i][1]);
        reading times = read_values(cases[i][0], cases[i][1]);
        reading kept = read_values(cases[i][0], flags);
        print_message("%-9s %s: error %.4f to %.4f, %.1f times less; cue %.3f to %.3f; lightness "
                      "changes by %.1f to %.1f\n",
                      cases[i][0], *cases[i][1] ? "unlit" : "lit  ", times.error, kept.error,
                      times.error / kept.error, times.cue, kept.cue, times.lightness,
                      kept.lightness);
        assert_true(times.error > 4 * kept.error);
        assert_true(kept.error < 0.015);
        assert_true(kept.cue > 0.02); /* more than is just seen */
        assert_true(kept.lightness < 1 && times.lightness > 10);
    }
}

/* Ways to show occlusion: how much of the light and of the chroma a full occlusion takes. */
typedef struct candidate {
    const char *name;
    double darken, fade;
} candidate;

static double decode(double v) {
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static double encode(double v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

static void show_occlusion(const candidate *c, const double base[3], double occlusion,
                           double out[3]) {
    double grey = 0.2126 * decode(base[0]) + 0.7152 * decode(base[1]) + 0.0722 * decode(base[2]);
    for (int k = 0; k < 3; k++) {
        double light = grey + (1 - c->fade * occlusion) * (decode(base[k]) - grey);
        out[k] = colour_byte((1 - c->darken * occlusion) * encode(light)) / 255.0;
    }
}

/* Error of reading and visibility of the occlusion, as in `reading`. */
static reading judge(const candidate *c, const colour_map *map, const shot *s) {
    reading r = {0, 0, 0};
    size_t covered = 0, occluded = 0;
    for (size_t i = 0; i < s->count; i++) {
        double occlusion = fmin(1.5 * (double)s->ao[i], 1), out[3];
        const double base[3] = {s->color[0][i], s->color[1][i], s->color[2][i]};
        if (s->mask[i] < 0.5f)
            continue;
        show_occlusion(c, base, occlusion, out);
        r.error += fabs(colour_map_find(map, out, NULL) - colour_map_find(map, base, NULL));
        covered++;
        if (occlusion > 0.4) {
            r.cue += colour_difference(colour_lab_from_rgb(base), colour_lab_from_rgb(out));
            occluded++;
        }
    }
    r.error /= (double)covered;
    r.cue /= (double)occluded;
    return r;
}

/* The table of docs/algorithm.md: what was chosen shows the most for the error it makes, among
 * those that leave a hue (fade < 1) and can be seen. */
static void the_chosen_way_shows_most_for_its_error(void **state) {
    static const candidate candidates[] = {{"multiply", 1, 0},
                                           {"darken to 0.7", 0.3, 0},
                                           {"darken to 0.8", 0.2, 0},
                                           {"0.8, fade to 0.5", 0.2, 0.5},
                                           {"0.85, fade to 0.3", 0.15, 0.7},
                                           {"0.9, fade to 0.5", 0.1, 0.5},
                                           {"fade to 0.6", 0, 0.4},
                                           {"fade to 0.4", 0, 0.6},
                                           {"fade to 0.2: chosen", 0, 0.8}};
    static const char *const maps[] = {"viridis", "heat"};
    enum { CANDIDATES = sizeof candidates / sizeof *candidates };
    (void)state;
    for (int m = 0; m < 2; m++) {
        colour_map map;
        assert_true(colour_map_make(maps[m], &map));
        expect_ok(RUN("render --scene aorta --lines 1200 --size 240x200 --ssaa 1 --halo none "
                      "--color speed --range 0,1 --dump r.exr --colormap %s",
                      maps[m]));
        shot s = read_shot("r.exr");
        double worth[CANDIDATES];
        for (int i = 0; i < CANDIDATES; i++) {
            reading r = judge(&candidates[i], &map, &s);
            worth[i] = r.cue / r.error;
            print_message("%-8s %-20s error %.4f, cue %.3f, ratio %.0f\n", maps[m],
                          candidates[i].name, r.error, r.cue, worth[i]);
        }
        for (int i = 0; i + 1 < CANDIDATES; i++)
            assert_true(worth[CANDIDATES - 1] > worth[i]);
        assert_true(worth[CANDIDATES - 1] > 1.5 * worth[0]);
        image_exr_free(&s.exr);
    }
}

/* Where the value is in the hue alone, multiplied shading does no harm. */
static void hues_alone_survive_multiplication(void **state) {
    (void)state;
    reading r = read_values("isoluminant", "--ambient 1 --diffuse 0 --specular 0");
    print_message("isoluminant, multiplied: error %.4f, cue %.3f\n", r.error, r.cue);
    assert_true(r.error < 0.005 && r.cue > 0.2); /* viridis: 0.02 and 0.13 */
}

/* ---- legends and sheets ----------------------------------------------------------------- */

typedef struct pixels {
    uint32_t width, height;
    uint8_t *rgb;
} pixels;

static pixels read_pixels(const char *path) {
    pixels p;
    assert_true(image_read_png(path, 3, &p.width, &p.height, &p.rgb, NULL));
    return p;
}

/* Pixels of the left and of the right half that differ. */
static void count_differing(const char *a, const char *b, size_t halves[2]) {
    pixels x = read_pixels(a), y = read_pixels(b);
    assert_true(x.width == y.width && x.height == y.height);
    halves[0] = halves[1] = 0;
    for (size_t i = 0; i < (size_t)x.width * x.height; i++)
        halves[i % x.width >= x.width / 2] += memcmp(x.rgb + 3 * i, y.rgb + 3 * i, 3) != 0;
    free(x.rgb);
    free(y.rgb);
}

static void legends_are_drawn_where_asked(void **state) {
    const char *shot_flags = "--size 300x200 --lines 50 --ssaa 1 --occlusion off";
    size_t halves[2];
    (void)state;
    expect_ok(RUN("render %s --color speed -o l0.png", shot_flags));
    expect_ok(RUN("render %s --color speed --legend off -o l1.png", shot_flags));
    count_differing("l0.png", "l1.png", halves);
    assert_true(halves[0] == 0 && halves[1] == 0);
    expect_ok(RUN("render %s --color speed --legend left -o l1.png", shot_flags));
    count_differing("l0.png", "l1.png", halves);
    assert_true(halves[0] > 500 && halves[1] == 0);
    expect_ok(RUN("render %s --color speed --legend right -o l2.png", shot_flags));
    count_differing("l0.png", "l2.png", halves);
    assert_true(halves[0] == 0 && halves[1] > 500);
    expect_ok(RUN("render %s --color speed --legend left --legend-title v -o l2.png", shot_flags));
    count_differing("l1.png", "l2.png", halves);
    assert_true(halves[0] > 50 && halves[1] == 0);
    /* no attribute: nothing to explain */
    expect_ok(RUN("render %s --legend left -o l1.png", shot_flags));
    expect_ok(RUN("render %s -o l2.png", shot_flags));
    count_differing("l1.png", "l2.png", halves);
    assert_true(halves[0] == 0 && halves[1] == 0);
}

/* The picture stands in the sheet pixel by pixel. */
static bool holds(const pixels *sheet, const pixels *part, uint32_t x, uint32_t y) {
    bool same = x + part->width <= sheet->width && y + part->height <= sheet->height;
    for (uint32_t row = 0; row < part->height && same; row++) {
        same = memcmp(sheet->rgb + 3 * ((size_t)(y + row) * sheet->width + x),
                      part->rgb + 3 * (size_t)row * part->width, 3 * (size_t)part->width) == 0;
    }
    return same;
}

static bool holds_anywhere(const pixels *sheet, const pixels *part) {
    for (uint32_t i = 0; i < sheet->width * sheet->height; i++) {
        if (holds(sheet, part, i % sheet->width, i / sheet->width))
            return true;
    }
    return false;
}

static void sheets_hold_their_pictures(void **state) {
    (void)state;
    expect_ok(RUN("render --size 90x60 --lines 50 --ssaa 1 --occlusion off -o p0.png"));
    expect_ok(RUN("render --size 70x80 --lines 60 --ssaa 1 --occlusion off -o p1.png"));
    expect_ok(RUN("sheet one=p0.png two=p1.png three=p0.png = p1.png --columns 2 --title T "
                  "--note N -o sheet.png"));
    pixels sheet = read_pixels("sheet.png"),
           parts[2] = {read_pixels("p0.png"), read_pixels("p1.png")};
    assert_true(holds_anywhere(&sheet, &parts[0]) && holds_anywhere(&sheet, &parts[1]));
    free(sheet.rgb);
    expect_ok(RUN("sheet p0.png --widest 45 -o sheet.png"));
    sheet = read_pixels("sheet.png");
    assert_false(holds_anywhere(&sheet, &parts[0]));
    free(sheet.rgb);
    free(parts[0].rgb);
    free(parts[1].rgb);
    expect_fault(RUN("sheet p0.png"), 2, "-o");
    expect_fault(RUN("sheet -o x.png"), 2, "FILE.png");
    expect_fault(RUN("sheet a=nosuch.png -o x.png"), 1, "nosuch.png");
    expect_fault(RUN("sheet p0.png --width 3 -o x.png"), 2, "--width");
    expect_fault(RUN("sheet p0.png -o nosuch/x.png"), 1, "nosuch/x.png");
    assert_int_equal(access("x.png", F_OK), -1);
}

/* Behind and around the lines, and never instead of them: with the backdrop a pixel that lines
 * cover entirely changes by the outline alone; elsewhere the paper gets darker, not dark, where the
 * blood is fast; dark pixels run all around. */
static void backdrops_stand_behind_the_lines(void **state) {
    const char *flags = "--scene flow --lines 60 --size 240x200 --ssaa 1 --occlusion off";
    (void)state;
    expect_ok(RUN("render %s -o l0.png", flags));
    expect_ok(RUN("render %s --background 0,0,0,0 -o l1.png", flags));
    expect_ok(RUN("render %s --backdrop -o l2.png", flags));
    pixels plain = read_pixels("l0.png"), with = read_pixels("l2.png");
    uint32_t width, height, kept = 0, drawn = 0, darker = 0, dark = 0;
    uint8_t *lines;
    assert_true(image_read_png("l1.png", 4, &width, &height, &lines, NULL));
    for (size_t i = 0; i < (size_t)width * height; i++) {
        const uint8_t *a = plain.rgb + 3 * i, *b = with.rgb + 3 * i;
        bool same = memcmp(a, b, 3) == 0;
        drawn += lines[4 * i + 3] == 255;
        kept += lines[4 * i + 3] == 255 && same;
        dark += lines[4 * i + 3] == 0 && b[0] < 120;
        darker += lines[4 * i + 3] == 0 && b[0] < a[0] - 8 && b[0] > 180;
        if (lines[4 * i + 3] == 0)
            assert_true(b[0] <= a[0] + 1); /* never lighter than paper */
    }
    assert_true(drawn > 3000 && kept > drawn * 9 / 10);
    assert_true(darker > 300); /* the projection */
    assert_true(dark > 200);   /* the outline */
    free(lines);
    free(plain.rgb);
    free(with.rgb);
    expect_fault(RUN("render --backdrop -o x.png"), 1, "--backdrop");
}

static int enter_folder(void **state) {
    static char folder[] = "/tmp/lineao-values-XXXXXX";
    *state = folder;
    return mkdtemp(folder) ? chdir(folder) : -1;
}

static int leave_folder(void **state) {
    static const char *const names[] = {"v.vtp",    "v.exr",  "s.vtp",  "low.vtp",
                                        "high.vtp", "r.exr",  "l0.png", "l1.png",
                                        "l2.png",   "p0.png", "p1.png", "sheet.png"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        unlink(names[i]);
    return rmdir(*state); /* nothing else is there */
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_have_their_colors),
        cmocka_unit_test(speed_comes_from_times),
        cmocka_unit_test(files_share_a_range),
        cmocka_unit_test(wrong_ranges_are_refused),
        cmocka_unit_test(shading_leaves_values_readable),
        cmocka_unit_test(the_chosen_way_shows_most_for_its_error),
        cmocka_unit_test(hues_alone_survive_multiplication),
        cmocka_unit_test(legends_are_drawn_where_asked),
        cmocka_unit_test(sheets_hold_their_pictures),
        cmocka_unit_test(backdrops_stand_behind_the_lines),
    };
    program = argc > 1 ? argv[1] : "lineao";
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
