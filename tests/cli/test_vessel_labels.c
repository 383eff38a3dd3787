/* Labels of a picture lie inside it, none on another one or on another's line, as many as there is
 * room for; one stands on what it names where that is wide, else beside it, and stays there while
 * what it names moves. */
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

/* Anchors that wander slowly: labels go with them, and seldom to another side; each that moves has
 * a reason. The same walk gives the same places. */
static uint32_t walk(cli_label *labels, bool kept, double *places) {
    const uint32_t size[2] = {WIDTH, HEIGHT};
    uint32_t jumps = 0;
    scatter(labels, 11, 0.7, 0);
    for (int frame = 0; frame < 60; frame++) {
        double before[MANY][2];
        bool placed[MANY];
        for (int i = 0; i < MANY; i++) {
            cli_label *l = &labels[i];
            placed[i] = l->placed;
            for (int k = 0; k < 2; k++)
                before[i][k] = l->at[k] - l->anchor[k];
            l->anchor[0] += 0.8 * cos(0.1 * frame + i);
            l->anchor[1] += 0.8 * sin(0.07 * frame + 2 * i);
            l->placed = false;
            l->kept = l->kept && kept;
        }
        place(labels, MANY, size);
        for (int i = 0; i < MANY; i++) {
            const cli_label *l = &labels[i];
            double x = l->at[0] - l->anchor[0] - before[i][0];
            double y = l->at[1] - l->anchor[1] - before[i][1];
            jumps += placed[i] && l->placed && hypot(x, y) > 1e-6;
            places[2 * i] = l->placed ? l->at[0] : -1;
            places[2 * i + 1] = l->placed ? l->at[1] : -1;
        }
    }
    return jumps;
}

static void steady(void **state) {
    cli_label labels[MANY];
    double places[2 * MANY], again[2 * MANY];
    (void)state;
    uint32_t anew = walk(labels, false, places), kept = walk(labels, true, places);
    print_message("of %d labels in 60 frames %u moved, %u when chosen anew\n", MANY, kept, anew);
    assert_true(kept < anew / 5 && kept < MANY * 60 / 20);
    assert_int_equal(walk(labels, true, again), kept);
    assert_memory_equal(places, again, sizeof places);
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
        cli_label label = {{20, 20}, {8, 5}, 0, {20, beside ? 38 : 20}, true, false, {0, 0}};
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
        cmocka_unit_test(steady),
        cmocka_unit_test(drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
