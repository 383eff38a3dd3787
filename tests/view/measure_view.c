/* The viewer answers input within two frames, and its memory does not grow while it plays: measured
 * with 30,000 pathlines in a picture of 853 x 917 pixels, and over 10,000 frames.
 *
 *   measure_view VIEWER gl|vk [LINES [FRAMES]]
 *
 * prints what it measures; frames per second are those of this machine, and of what else it does.
 */
#include "desktop.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

typedef struct measure {
    const char *viewer, *backend, *lines;
    int frames;
    desktop *desktop;
} measure;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void start(const measure *m, const char *lines, const char *size) {
    const char *words[] = {"--backend", m->backend,   "--window", size,      "--scale",
                           "1",         "--no-vsync", "render",   "--scene", "flow",
                           "--lines",   lines,        NULL};
    viewer_start(m->desktop, m->viewer, words);
    viewer_hears(m->desktop, "opened");
    viewer_hears(m->desktop, "frame");
}

static void quit(desktop *d) {
    user_types(d, "q");
    assert_int_equal(viewer_end(d), 0);
}

/* How many frames of the window pass from an event to the one that shows its picture, that one
 * included. */
static int frames_to_picture(desktop *d) {
    int ticks = 0;
    bool drawn = false;
    viewer_hears(d, "event");
    while (!drawn || ticks == 0) {
        const char *line = viewer_hears(d, "");
        if (strncmp(line, "frame", 5) == 0)
            drawn = true;
        if (strcmp(line, "tick") == 0 && ++ticks && drawn)
            break;
    }
    return ticks;
}

static void answers_within_two_frames(void **state) {
    const measure *m = *state;
    desktop *d = m->desktop;
    enum { MOVES = 12, STEPS = 3 };
    int worst = 0, frames = 0;
    double begin, longest = 0;
    char size[64] = "";
    start(m, m->lines, "853x917");
    user_types(d, "h");
    while (!strstr(size, "853x917"))
        snprintf(size, sizeof size, "%s", viewer_hears(d, "frame "));
    user_types(d, "space");
    viewer_hears(d, "player plays");
    for (int i = 0; i < 8; i++) /* until the size has been found that keeps the pace */
        viewer_hears(d, "frame ");
    for (begin = now(); now() - begin < 10; frames++)
        snprintf(size, sizeof size, "%s", viewer_hears(d, "frame "));
    print_message("%s, %s pathlines: playing %.2f frames per second; the last was %s\n", m->backend,
                  m->lines, frames / (now() - begin), size);
    user_types(d, "space");
    viewer_rests(d);
    for (int i = 0; i < STEPS; i++) {
        begin = now();
        user_types(d, "Right");
        snprintf(size, sizeof size, "%s", viewer_hears(d, "frame "));
        longest = now() - begin > longest ? now() - begin : longest;
        viewer_rests(d);
    }
    print_message("%s: at rest %.2f frames per second; the last was %s\n", m->backend, 1 / longest,
                  size);
    user_points(d, 400, 400);
    user_presses(d, 1, true);
    user_points(d, 420, 400);
    for (int i = 0; i < MOVES; i++) {
        viewer_rests(d);
        user_points(d, 420 + 10 * (i + 1), 400 + 5 * i);
        int ticks = frames_to_picture(d);
        worst = ticks > worst ? ticks : worst;
    }
    user_presses(d, 1, false);
    print_message("%s: from input to its picture %d frame(s) at most\n", m->backend, worst);
    assert_in_range(worst, 1, 2);
    quit(d);
}

static void keeps_its_memory(void **state) {
    const measure *m = *state;
    desktop *d = m->desktop;
    int early = m->frames / 10, frame = 0;
    double memory[2] = {0, 0}, begin = now();
    start(m, "60", "160x120");
    user_types(d, "space");
    while (frame < m->frames) {
        frame = atoi(viewer_hears(d, "frame "));
        if (frame == early)
            memory[0] = viewer_memory(d);
    }
    memory[1] = viewer_memory(d);
    print_message("%s: resident %.2f MB after %d frames, %.2f MB after %d (%.0f s)\n", m->backend,
                  memory[0], early, memory[1], frame, now() - begin);
    assert_true(memory[1] - memory[0] < 1.0);
    quit(d);
}

static int clean_up(void **state) {
    const measure *m = *state;
    viewer_kill(m->desktop);
    return 0;
}

int main(int argc, char **argv) {
    if (argc < 3) {
        fprintf(stderr, "usage: measure_view VIEWER gl|vk [LINES [FRAMES]]\n");
        return 2;
    }
    measure m = {argv[1], argv[2], argc > 3 ? argv[3] : "30000", argc > 4 ? atoi(argv[4]) : 10000,
                 desktop_start()};
    const struct CMUnitTest tests[] = {
        {"answers_within_two_frames", answers_within_two_frames, NULL, clean_up, &m},
        {"keeps_its_memory", keeps_its_memory, NULL, clean_up, &m},
    };
    if (!m.desktop) {
        fprintf(stderr, "Xvfb cannot be started; ./run setup installs it\n");
        return 1;
    }
    int failed = cmocka_run_group_tests_name(m.backend, tests, NULL, NULL);
    desktop_stop(m.desktop);
    return failed;
}
