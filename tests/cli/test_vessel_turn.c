/* While a tree turns, the numbers of its branches at risk stay beside what they name: few of them
 * change sides in the tree's picture, none walks about in the layout's, and the same turn gives the
 * same places; a layout's edges are as wide as there is room for. */
#include "report.h"
#include "vessel_page.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { FRAMES = 8, STEPS = 72, MANY = 64 };

typedef struct places {
    double off[FRAMES][2][MANY][2]; /* per view and branch: from the anchor to the box */
    double at[FRAMES][2][MANY][2];
    bool placed[FRAMES][MANY];
    uint32_t count;
} places;

typedef struct scene {
    cli_options options;
    cli_tree tree;
    cli_shot shot;
    cli_session session;
} scene;

static void begin(scene *s) {
    static char words[][24] = {"--nodes", "300",      "--link", "--target", "32,8,12,1", "--risk",
                               "30",      "--frames", "12",     "--size",   "240x180",   "--grid",
                               "48",      "--ssaa",   "1",      "-o",       "none.png"};
    char *list[sizeof words / sizeof *words];
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        list[i] = words[i];
    memset(s, 0, sizeof *s);
    assert_true(cli_parse(CLI_VESSEL, (int)(sizeof words / sizeof *words), list, &s->options));
    assert_true(cli_tree_load(&s->options, NULL, 0, &s->tree));
    assert_true(cli_tree_prepare(&s->tree));
    assert_true(cli_shot_make(&s->options, &s->tree.scene, &s->shot));
    assert_true(
        cli_session_open(&s->session, "gl", &s->tree.scene, &s->shot, LAO_VIEW_KEEP_IMAGES));
}

static void end(scene *s) {
    cli_session_close(&s->session);
    cli_tree_free(&s->tree);
    cli_options_free(&s->options);
}

static void keep(const cli_marks *marks, int frame, places *out) {
    assert_in_range(marks->count, 8, MANY);
    out->count = marks->count;
    for (uint32_t i = 0; i < marks->count; i++) {
        out->placed[frame][i] = marks->labels[0][i].placed;
        assert_int_equal(marks->labels[0][i].placed, marks->labels[1][i].placed);
        for (int view = 0; view < 2; view++) {
            const cli_label *l = &marks->labels[view][i];
            for (int k = 0; k < 2; k++) {
                out->off[frame][view][i][k] = l->at[k] - l->anchor[k];
                out->at[frame][view][i][k] = l->at[k];
            }
        }
    }
}

/* A ninth of a turn; anew: every picture as if it were the first. */
static void turn(scene *s, bool anew, places *out) {
    const camera_pose first = s->shot.camera;
    cli_marks marks;
    memset(&marks, 0, sizeof marks);
    memset(out, 0, sizeof *out);
    for (int frame = 0; frame < FRAMES; frame++) {
        cli_turn(&first, (double)frame / STEPS, &s->shot.camera);
        cli_shot_aim(&s->tree.scene, &s->shot);
        assert_true(cli_session_render(&s->session, &s->shot, 0));
        if (anew)
            cli_marks_free(&marks);
        assert_true(cli_marks_make(&s->tree, &s->shot, &s->session, 12, &marks));
        keep(&marks, frame, out);
    }
    cli_marks_free(&marks);
    s->shot.camera = first;
}

/* How often a label that is in two pictures in succession changes its side, by view. */
static uint32_t jumps(const places *p, int view) {
    uint32_t count = 0;
    for (int frame = 1; frame < FRAMES; frame++) {
        for (uint32_t i = 0; i < p->count; i++) {
            double x = p->off[frame][view][i][0] - p->off[frame - 1][view][i][0];
            double y = p->off[frame][view][i][1] - p->off[frame - 1][view][i][1];
            count += p->placed[frame][i] && p->placed[frame - 1][i] && hypot(x, y) > 1e-6;
        }
    }
    return count;
}

/* The longest way that a label goes in the layout's picture, px. */
static double walked(const places *p) {
    double most = 0;
    for (int frame = 1; frame < FRAMES; frame++) {
        for (uint32_t i = 0; i < p->count; i++) {
            const double *a = p->at[frame - 1][1][i], *b = p->at[frame][1][i];
            if (p->placed[frame][i] && p->placed[frame - 1][i])
                most = fmax(most, hypot(a[0] - b[0], a[1] - b[1]));
        }
    }
    return most;
}

static void numbers_stay(void **state) {
    static places kept, again, anew; /* large */
    static scene s;
    (void)state;
    begin(&s);
    turn(&s, false, &kept);
    turn(&s, false, &again);
    turn(&s, true, &anew);
    end(&s);
    uint32_t placed = 0;
    for (int frame = 0; frame < FRAMES; frame++) {
        for (uint32_t i = 0; i < kept.count; i++)
            placed += kept.placed[frame][i];
    }
    print_message("%u labels in %d pictures: %u change sides, %u when chosen anew\n", placed,
                  FRAMES, jumps(&kept, 0), jumps(&anew, 0));
    assert_memory_equal(&kept, &again, sizeof kept);
    assert_true(placed > kept.count * FRAMES / 2);
    assert_true(jumps(&kept, 0) < placed / 8);
    assert_true(jumps(&kept, 0) < jumps(&anew, 0) / 3); /* the rest is in the way of others */
    assert_true(walked(&kept) == 0);
    assert_true(walked(&anew) > 0);
}

/* Edges of a layout: wider vessels have wider ones, none is thinner than can be seen, and the
 * narrowest leave room between the leaves as long as pixels allow it. */
static void edges_have_room(void **state) {
    static const uint32_t nodes[] = {20, 300, 4000};
    double before = HUGE_VAL;
    (void)state;
    for (int i = 0; i < 3; i++) {
        cli_options options;
        cli_tree tree;
        char number[16], flag[] = "--nodes", out[] = "-o", name[] = "none.png";
        char *words[] = {flag, number, out, name};
        snprintf(number, sizeof number, "%u", nodes[i]);
        assert_true(cli_parse(CLI_VESSEL, 4, words, &options));
        assert_true(cli_tree_load(&options, NULL, 0, &tree));
        const cli_edges e = cli_edges_make(&tree, 1600, 1200, 1),
                        large = cli_edges_make(&tree, 1600, 1200, 1e-3);
        const sdv_tree *t = &tree.vessel.tree;
        for (uint32_t k = 0; k < t->node_count; k++) {
            double half = cli_edge_half(&e, &tree, k),
                   next = cli_edge_half(&e, &tree, t->node_count - 1 - k);
            assert_true(half >= e.thin - 1e-9 && half <= e.thick + 1e-9);
            if (t->nodes[k].w > t->nodes[t->node_count - 1 - k].w)
                assert_true(half >= next);
        }
        assert_true(e.thin >= 0.7 && e.thick >= 4.8 && e.thin <= before);
        assert_true(2 * large.thin <=
                    1600.0 / tree.reduced.node_count); /* where pixels are small */
        before = e.thin;
        cli_tree_free(&tree);
        cli_options_free(&options);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_have_room),
        cmocka_unit_test(numbers_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
