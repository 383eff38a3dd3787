/* Labels of a picture lie inside it, none on another one or on another's line, as many as there is
 * room for; one stands on what it names where that is wide, else beside it. */
#include "vessel_labels.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { MANY = 60, WIDTH = 300, HEIGHT = 200 };

static double random_below(uint32_t *seed, double most) {
    *seed = *seed * 1664525u + 1013904223u;
    return most * (*seed >> 8) / 16777216.0;
}

/* Places all in turn; returns how many have a place. */
static uint32_t place(cli_label *labels, uint32_t count, const uint32_t size[2]) {
    uint32_t placed = 0;
    for (uint32_t i = 0; i < count; i++)
        placed += cli_label_place(labels, count, i, size);
    return placed;
}

/* Anchors in a part of the picture, around its middle. */
static void scatter(cli_label *labels, uint32_t seed, double part, double wide) {
    memset(labels, 0, MANY * sizeof *labels);
    for (int i = 0; i < MANY; i++) {
        labels[i].anchor[0] = 0.5 * (1 - part) * WIDTH + random_below(&seed, part * WIDTH);
        labels[i].anchor[1] = 0.5 * (1 - part) * HEIGHT + random_below(&seed, part * HEIGHT);
        labels[i].half[0] = 8;
        labels[i].half[1] = 5;
        labels[i].wide = wide;
    }
}

/* By places along the line, a quarter of a pixel apart: is one inside the other's box? */
static bool line_enters(const cli_label *line, const cli_label *box) {
    double x = line->anchor[0] - line->at[0], y = line->anchor[1] - line->at[1];
    int steps = (int)(4 * hypot(x, y)) + 1;
    for (int i = 0; i <= steps; i++) {
        double dx = line->at[0] + x * i / steps - box->at[0];
        double dy = line->at[1] + y * i / steps - box->at[1];
        if (fabs(dx) < box->half[0] - 1e-9 && fabs(dy) < box->half[1] - 1e-9)
            return true;
    }
    return false;
}

static void apart(void **state) {
    static const double parts[] = {1, 0.5, 0.1};
    const uint32_t size[2] = {WIDTH, HEIGHT};
    cli_label labels[MANY];
    uint32_t placed[3];
    (void)state;
    for (int c = 0; c < 3; c++) {
        scatter(labels, 7, parts[c], 0);
        placed[c] = place(labels, MANY, size);
        for (int i = 0; i < MANY; i++) {
            const cli_label *a = &labels[i];
            if (!a->placed)
                continue;
            assert_true(a->at[0] >= 8 && a->at[0] <= WIDTH - 8);
            assert_true(a->at[1] >= 5 && a->at[1] <= HEIGHT - 5);
            for (int k = 0; k < MANY; k++) {
                const cli_label *b = &labels[k];
                if (k == i || !b->placed)
                    continue;
                assert_true(fabs(a->at[0] - b->at[0]) >= 16 || fabs(a->at[1] - b->at[1]) >= 10);
                assert_false(line_enters(a, b));
            }
        }
    }
    assert_true(labels[0].placed); /* the first never gives way */
    print_message("%u, %u and %u of %d placed\n", placed[0], placed[1], placed[2], MANY);
    assert_true(placed[0] >= MANY - 2);
    assert_in_range(placed[2], MANY / 4, MANY - 10);
}

static void on_or_beside(void **state) {
    const uint32_t size[2] = {WIDTH, HEIGHT}, tiny[2] = {14, 40};
    cli_label label;
    (void)state;
    for (int wide = 0; wide < 2; wide++) {
        memset(&label, 0, sizeof label);
        label.anchor[0] = 100;
        label.anchor[1] = 90;
        label.half[0] = 8;
        label.half[1] = 5;
        label.wide = wide ? 11 : 4;
        assert_true(cli_label_place(&label, 1, 0, size));
        double off = hypot(label.at[0] - 100, label.at[1] - 90);
        assert_true(wide ? off == 0 : off > 5 && off < 20);
        assert_false(cli_label_place(&label, 1, 0, tiny));
        assert_false(label.placed);
    }
}

/* The pointer is drawn beside the box alone, in the picture alone. */
static void drawn(void **state) {
    const int64_t corner[2] = {10, 10};
    text_style style;
    picture p;
    (void)state;
    memset(&style, 0, sizeof style);
    style.size = 12;
    assert_true(picture_make(80, 60, &p));
    for (int beside = 0; beside < 2; beside++) {
        cli_label label = {{20, 20}, {8, 5}, 0, {20, beside ? 38 : 20}, true};
        uint32_t inked = 0;
        memset(p.pixels, 0, 4 * (size_t)p.width * p.height);
        assert_true(cli_label_draw(&label, "7", &style, corner, &p));
        for (int y = 29; y < 34; y++)
            inked += p.pixels[4 * (y * 80 + 30) + 3] > 0;
        assert_true(inked >= (beside ? 4u : 1u));
        assert_true((p.pixels[4 * (30 * 80 + 30) + 3] > 0) || !beside);
        label.anchor[0] = 500;
        assert_true(cli_label_draw(&label, "7", &style, corner, &p));
    }
    picture_free(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(apart),
        cmocka_unit_test(on_or_beside),
        cmocka_unit_test(drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
