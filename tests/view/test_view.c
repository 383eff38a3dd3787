/* The viewer does what a user asks of it with pointer and keys, on OpenGL and on Vulkan, without a
 * message of a validation layer or an OpenGL error; and its picture, in the window and in a file,
 * is bit for bit that of the command line that it names.
 *
 * The screen is a server of its own (Xvfb); events come through XTest. */
#include "desktop.h"
#include "image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

/* A user interface of half the size takes every event that a whole one does, and pictures of a
 * quarter of the pixels are drawn in as much less time. */
#define SCALE "0.5"
enum { WIDTH = 410, HEIGHT = 300, PANEL = 165, PICTURE_HEIGHT = HEIGHT - 15 };
enum { MIDDLE = PANEL + (WIDTH - PANEL) / 2 };

/* Where occlusion is not what is tested: half the shaders need not be built. */
#define NO_OCCLUSION "--set", "occlusion=off"

static const char *viewer, *program; /* paths */
static char programs[4096];          /* where others are looked for */

typedef struct fixture {
    const char *backend;
    char folder[32]; /* of this run alone */
    desktop *desktop;
} fixture;

/* Words of the viewer: the backend, a small window, then `more` (ends with NULL). Nobody looks at
 * it, so that it need not wait for a monitor; follows_the_monitor does. */
static void start(fixture *f, const char *const *more) {
    char size[32];
    const char *words[32] = {"--backend", f->backend, "--window",  size,
                             "--scale",   SCALE,      "--no-vsync"};
    int count = 7;
    snprintf(size, sizeof size, "%dx%d", WIDTH, HEIGHT);
    if (strcmp(f->backend, "vk") == 0)
        words[count++] = "--validate";
    while (*more)
        words[count++] = *more++;
    viewer_start(f->desktop, viewer, words);
    viewer_hears(f->desktop, "opened");
    viewer_hears(f->desktop, "frame");
    viewer_rests(f->desktop);
}

static void quit(fixture *f) {
    user_types(f->desktop, "q");
    assert_string_equal(viewer_hears(f->desktop, "messages "), "0");
    assert_int_equal(viewer_end(f->desktop), 0);
}

static const char *const flow[] = {"render",  "--scene", "flow",   "--lines", "150",
                                   "--width", "1",       "--ssaa", "1",       NULL};

/* ---- handling ----------------------------------------------------------------------------- */

static float said_number(desktop *d, const char *begin) {
    return strtof(viewer_hears(d, begin), NULL);
}

/* Keys and clicks of the player: the time is that of the step, of the place on the timeline; the
 * speed changes by a half. */
static void steps_and_jumps(desktop *d) {
    user_clicks(d, "timeline"); /* its middle */
    float middle = said_number(d, "time ");
    viewer_rests(d); /* it is said while the button is down */
    user_types(d, "Right");
    float later = said_number(d, "time ");
    assert_true(later > middle);
    user_types(d, "Left");
    assert_float_equal(said_number(d, "time "), middle, 0.01f);
    user_types(d, "period");
    float fast = said_number(d, "speed ");
    user_types(d, "comma");
    assert_float_equal(said_number(d, "speed ") * 1.5f, fast, 0.001f * fast);
    user_types(d, "l");
    assert_string_equal(viewer_hears(d, "loop "), "off");
    user_types(d, "l");
    assert_string_equal(viewer_hears(d, "loop "), "on");
}

static void plays_and_stops(desktop *d) {
    user_types(d, "space");
    assert_string_equal(viewer_hears(d, "player "), "plays");
    for (int i = 0; i < 3; i++)
        viewer_hears(d, "frame");
    user_clicks(d, "Pause##play");
    assert_string_equal(viewer_hears(d, "player "), "pauses");
    viewer_rests(d);
    steps_and_jumps(d);
    user_clicks(d, "Stop");
    assert_string_equal(viewer_hears(d, "player "), "stops");
    assert_true(said_number(d, "time ") < 10); /* the first one */
}

/* A view that was kept, looked away from and returned to; written to a file, and read by name. */
static void keeps_views(desktop *d) {
    char camera[2048], command[8192];
    user_clicks(d, "View");
    viewer_rests(d);
    user_types(d, "2");
    user_types(d, "c");
    snprintf(camera, sizeof camera, "%s", strstr(viewer_hears(d, "command "), " --camera "));
    user_clicks(d, "1+##bookmark 1");
    user_clicks(d, "Save view");
    assert_string_equal(viewer_hears(d, "saved "), "camera.json");
    viewer_rests(d);                  /* what a bookmark allows is there */
    user_clicks(d, "Save bookmarks"); /* which is that view */
    assert_string_equal(viewer_hears(d, "saved "), "camera.json");
    user_types(d, "3");
    user_types(d, "c");
    assert_string_not_equal(strstr(viewer_hears(d, "command "), " --camera "), camera);
    user_clicks(d, "1##bookmark 1");
    user_types(d, "c");
    assert_string_equal(strstr(viewer_hears(d, "command "), " --camera "), camera);
    user_types(d, "4");
    user_clicks(d, "Load views");
    user_types(d, "c");
    snprintf(command, sizeof command, "%s", viewer_hears(d, "command "));
    assert_string_equal(strstr(command, " --camera "), camera);
}

/* Hides the panels and waits for the picture in their place. */
static void fill_window(desktop *d) {
    char size[32];
    user_types(d, "h");
    snprintf(size, sizeof size, " %dx%d ok", WIDTH, HEIGHT);
    for (const char *said = ""; !strstr(said, size);)
        said = viewer_hears(d, "frame");
    viewer_hears(d, "tick");
}

static void turns_and_resizes(desktop *d) {
    static const int sizes[][2] = {{500, 300}, {700, 500}, {64, 64},   {1200, 90},     {90, 700},
                                   {401, 301}, {400, 300}, {233, 377}, {WIDTH, HEIGHT}};
    for (unsigned button = 1; button <= 3; button++) {
        user_points(d, MIDDLE, 100);
        user_presses(d, button, true);
        for (int i = 1; i <= 8; i++)
            user_points(d, MIDDLE + 5 * i, 100 + 2 * i);
        user_presses(d, button, false);
        viewer_hears(d, "frame");
    }
    user_presses(d, 4, true); /* the wheel */
    user_presses(d, 4, false);
    viewer_hears(d, "frame");
    for (int i = 0; i < 9; i++) {
        user_resizes(d, sizes[i][0], sizes[i][1]);
        user_waits(i % 3 ? 0.02 : 0.2);
    }
    viewer_rests(d);
    user_hides(d, true);
    user_hides(d, false);
    fill_window(d);
    user_types(d, "h");
    assert_int_equal(0, viewer_said(d, "error"));
    assert_int_equal(0, viewer_said(d, "warning vk"));
}

/* ---- pictures ------------------------------------------------------------------------------ */

/* Runs the copied command line with `output` in place of its own; pictures must be equal. */
static void run_command(const char *command, const char *output) {
    char line[8192];
    assert_true(strncmp(command, "lineao ", 7) == 0);
    snprintf(line, sizeof line, "'%s' %s", program, command + 7);
    char *out = strstr(line, " -o "), more[256];
    assert_non_null(out);
    snprintf(more, sizeof more, "%s", out + 4 + strcspn(out + 4, " ")); /* behind the name */
    snprintf(out, sizeof line - (size_t)(out - line), " -o %s%s", output, more);
    assert_int_equal(system(line), 0);
}

static void assert_same_file(const char *a, const char *b) {
    char error[IMAGE_ERROR_SIZE];
    uint32_t size[2][2];
    uint8_t *pixels[2];
    assert_true(image_read_png(a, 3, &size[0][0], &size[0][1], &pixels[0], error));
    assert_true(image_read_png(b, 3, &size[1][0], &size[1][1], &pixels[1], error));
    assert_memory_equal(size[0], size[1], sizeof size[0]);
    assert_memory_equal(pixels[0], pixels[1], (size_t)size[0][0] * size[0][1] * 3);
    free(pixels[0]);
    free(pixels[1]);
}

/* The window with the picture alone, against the command line at its size. */
static void assert_same_window(desktop *d, const char *path) {
    char error[IMAGE_ERROR_SIZE];
    uint32_t width, height;
    uint8_t *pixels, *seen;
    assert_true(image_read_png(path, 3, &width, &height, &pixels, error));
    seen = screen_picture(d, 0, 0, (int)width, (int)height);
    assert_memory_equal(seen, pixels, (size_t)width * height * 3);
    free(seen);
    free(pixels);
}

/* A turn, an edit, a picture, its command line. */
static void writes_what_the_program_writes(desktop *d, const char *setting) {
    char command[8192], name[64];
    user_points(d, MIDDLE, 100);
    user_presses(d, 1, true);
    user_points(d, MIDDLE + 20, 120);
    user_points(d, MIDDLE + 40, 130);
    user_presses(d, 1, false);
    user_clicks(d, "Look");
    snprintf(name, sizeof name, "%s ##value", setting);
    user_clicks(d, name);
    viewer_hears(d, "set ");
    user_clicks(d, "Save");
    user_clicks(d, "As in the window");
    user_clicks(d, "Save picture");
    assert_string_equal(viewer_hears(d, "saved "), "picture.png");
    user_clicks(d, "Copy command line");
    snprintf(command, sizeof command, "%s", viewer_hears(d, "command "));
    assert_non_null(strstr(command, setting));
    run_command(command, "program.png");
    assert_same_file("picture.png", "program.png");
}

/* Saves the picture and hears its command line, both of them of the window's size. */
static void save(desktop *d, char command[8192]) {
    user_clicks(d, "Save");
    user_clicks(d, "As in the window");
    viewer_rests(d); /* the line that is shown has another length than the last time */
    user_clicks(d, "Save picture");
    assert_string_equal(viewer_hears(d, "saved "), "picture.png");
    user_clicks(d, "Copy command line");
    snprintf(command, 8192, "%s", viewer_hears(d, "command "));
}

/* The middle of the picture, which is beside the panels. */
static void click_middle(desktop *d, int right) {
    user_points(d, MIDDLE + right, PICTURE_HEIGHT / 2);
    user_presses(d, 1, true);
    user_presses(d, 1, false);
}

/* The wall's contours follow the camera, and the focus the place that was clicked. */
static void focuses_surfaces(fixture *f) {
    char command[8192];
    desktop *d = f->desktop;
    click_middle(d, -20); /* on the shaft */
    assert_int_equal(viewer_hears(d, "picked ")[0], '3');
    user_clicks(d, "Focus here");
    assert_non_null(strchr(viewer_hears(d, "focus "), ','));
    viewer_hears(d, "frame");
    save(d, command);
    assert_non_null(strstr(command, "--focus "));
    run_command(command, "program.png");
    assert_same_file("picture.png", "program.png");
    user_clicks(d, "Undo");
    assert_string_equal(viewer_hears(d, "focus "), "");
    save(d, command);
    assert_null(strstr(command, "--focus "));
    run_command(command, "sharp.png");
    assert_same_file("picture.png", "sharp.png");
    assert_int_not_equal(system("cmp -s program.png sharp.png"), 0); /* the blur was one */
}

/* Of a wall that nothing lights: its look is offered, but nothing of that light. */
static void offers_what_has_a_meaning(desktop *d) {
    char name[64];
    assert_true(user_finds(d, "near_colors ##value", 0, name, sizeof name));
    assert_true(user_finds(d, "value_low ##value", 0, name, sizeof name));
    assert_false(user_finds(d, "near_gamma ##value", 0, name, sizeof name));
    assert_false(user_finds(d, "near_part ##value", 0, name, sizeof name));
    assert_false(user_finds(d, "near_steps ##value", 0, name, sizeof name));
}

static void saves_surfaces(void **state) {
    static const char *const words[] = {"surface", "--scene",    "bone", "--ssaa",
                                        "1",       "--contours", "0.3",  NULL};
    fixture *f = *state;
    start(f, words);
    writes_what_the_program_writes(f->desktop, "opacity");
    offers_what_has_a_meaning(f->desktop);
    focuses_surfaces(f);
    quit(f);
}

/* Another length of what is lit is measured beside the window, and the picture is that of a
 * document opened with it. */
static void relights_walls(void **state) {
    static const char *const words[] = {"surface", "--ssaa", "1", "--set", "near_steps=8", NULL};
    fixture *f = *state;
    desktop *d = f->desktop;
    int place[4];
    char command[8192];
    start(f, words);
    user_clicks(d, "Look");
    user_clicks(d, "##filter");
    user_writes(d, "beta");
    viewer_rests(d);
    user_sees(d, "highlight_beta ##value", place);
    user_points(d, place[0] + place[2] / 2, place[1] + place[3] / 2);
    user_presses(d, 1, true);
    for (int i = 1; i <= 3; i++)
        user_points(d, place[0] + place[2] / 2 + 40 * i, place[1] + place[3] / 2);
    assert_int_equal(viewer_said(d, "measured "), 0); /* not before it is let go */
    user_presses(d, 1, false);
    assert_true(said_number(d, "measured ") > 0);
    viewer_rests(d);
    assert_int_equal(viewer_said(d, "opened "), 1);
    save(d, command);
    assert_non_null(strstr(command, " highlight_beta="));
    run_command(command, "program.png");
    assert_same_file("picture.png", "program.png");
    quit(f);
}

/* A tree of which a branch leads through the middle of the picture. */
static const char tree_file[] =
    "1 1 0 0 0 4 -1\n2 1 0 0 30 3 1\n3 1 10 0 50 2 2\n4 1 -10 0 50 2 2\n";
static void write_file(const char *path, const char *text);

/* Hears that the document is open again, with what was placed. */
static void assert_placed(desktop *d, const char *flag, bool placed) {
    viewer_hears(d, "opened vessel");
    viewer_hears(d, "frame");
    viewer_rests(d);
    user_types(d, "c");
    assert_true((strstr(viewer_hears(d, "command "), flag) != NULL) == placed);
}

/* The picture that is saved now is that of the command line. */
static void assert_saved(desktop *d) {
    char command[8192];
    save(d, command);
    run_command(command, "program.png");
    assert_same_file("picture.png", "program.png");
}

/* With the pointer above a leaf the wheel makes it larger there, so that it is the nearest one from
 * afar; dragged along, the other one is there, and nothing has been selected. */
static void moves_the_flat_tree(desktop *d, int leaf) {
    int place[4];
    user_sees(d, "layout", place);
    int x = place[0] + place[2] / 4, y = place[1] + 7 * place[3] / 10;
    int right = x + place[2] / 2, left = x - place[2] / 5;
    user_points(d, x, y);
    for (int i = 0; i < 6; i++) {
        user_presses(d, 4, true);
        user_presses(d, 4, false);
    }
    uint32_t hovered = viewer_said(d, "hovers "), nodes = viewer_said(d, "node ");
    user_points(d, right, y);
    viewer_rests(d);
    assert_int_equal(viewer_said(d, "hovers "), hovered);
    for (int i = 0; i < 2; i++) {
        user_points(d, right, y);
        user_presses(d, 1, true);
        user_points(d, x, y);
        user_points(d, left, y);
        user_presses(d, 1, false);
    }
    user_points(d, x, y);
    viewer_hears(d, leaf == 2 ? "hovers 2 0 2 3" : "hovers 2 0 1 2");
    assert_int_equal(viewer_said(d, "node "), nodes);
}

/* The pointer on a branch of the picture, then on one of the flat tree, which is clicked. */
static void hovers_and_picks(desktop *d) {
    int place[4];
    user_points(d, MIDDLE, PICTURE_HEIGHT / 2);
    assert_string_equal(viewer_hears(d, "hovers "), "2 0 0 1"); /* the end of the first branch */
    user_clicks(d, "Tree");
    viewer_rests(d);
    user_sees(d, "layout", place);
    user_points(d, place[0] + place[2] / 4, place[1] + place[3] - 10); /* a leaf */
    int leaf = viewer_hears(d, "hovers 2 0 ")[2] - '0'; /* its segment is the one before */
    assert_true(leaf == 2 || leaf == 3);
    user_presses(d, 1, true);
    user_presses(d, 1, false);
    assert_int_equal(atoi(viewer_hears(d, "node ")), leaf);
    moves_the_flat_tree(d, leaf);
}

/* marks: what is at risk is hatched, which wants texture coordinates and all their shaders. */
static void start_tree(fixture *f, bool marks) {
    const char *words[] = {
        "vessel",   "aim.swc",
        "--unit",   "mm",
        "--grid",   "32",
        "--ssaa",   "1",
        "--camera", "{\"eye\":[0,-200,25],\"center\":[0,0,25],\"up\":[0,0,1],\"ortho_height\":80}",
        "--set",    "parameterization=off",
        NULL};
    if (marks)
        words[10] = NULL;
    write_file("aim.swc", tree_file);
    start(f, words);
}

/* The command line of what is seen. */
static void hear_command(desktop *d, char command[8192]) {
    user_types(d, "c");
    snprintf(command, 8192, "%s", viewer_hears(d, "command "));
}

/* What was placed last is taken back: all is as it was. */
static void undoes(desktop *d, const char *before) {
    char command[8192];
    user_clicks(d, "Tree");
    user_clicks(d, "Undo");
    viewer_hears(d, "opened vessel");
    viewer_rests(d);
    hear_command(d, command);
    assert_string_equal(command, before);
}

/* What was clicked, with its distance from the target that is there since. */
static void tells_of_the_target(desktop *d) {
    double radius = 0, distance = 1;
    user_clicks(d, "Copy JSON");
    assert_int_equal(
        sscanf(viewer_hears(d, "json "),
               "{\"kind\":\"tree\",\"of\":\"aim.swc\",\"segment\":0,\"node\":1,\"facts\":"
               "{\"radius\":%lf,\"from the target\":%lf,",
               &radius, &distance),
        2);
    assert_true(fabs(radius - 3) < 1e-6);
    assert_true(distance < 0); /* the ball is on the vessel */
}

/* A picture; a branch in both views, and a target on one; and back. */
static void places_on_trees(void **state) {
    fixture *f = *state;
    desktop *d = f->desktop;
    char before[8192];
    start_tree(f, false);
    writes_what_the_program_writes(d, "shadow_ratio");
    user_types(d, "Home");
    hovers_and_picks(d);
    hear_command(d, before);
    click_middle(d, 0);
    assert_int_equal(viewer_hears(d, "picked ")[0], '2');
    user_clicks(d, "Target here");
    assert_placed(d, " --target ", true);
    tells_of_the_target(d);
    undoes(d, before);
    quit(f);
}

/* The circle is taken at the right end of its ring and left elsewhere; nothing is opened anew. */
static void drags_the_lens(desktop *d) {
    double x, y, radius, there;
    char command[8192];
    uint32_t opened = viewer_said(d, "opened ");
    hear_command(d, command);
    assert_int_equal(
        sscanf(strstr(command, " --lens circle:"), " --lens circle:%lf,%lf,%lf", &x, &y, &radius),
        3);
    int wide = WIDTH - PANEL,
        at[2] = {PANEL + (int)(x * wide + radius * PICTURE_HEIGHT), (int)(y * PICTURE_HEIGHT)};
    user_points(d, at[0], at[1]);
    user_presses(d, 1, true);
    user_points(d, at[0] - 8, at[1]);
    user_points(d, at[0] - wide / 5, at[1]);
    user_presses(d, 1, false);
    assert_int_equal(sscanf(viewer_hears(d, "lens "), "circle:%lf", &there), 1);
    assert_true(fabs(there - (x - 0.2)) < 0.01);
    viewer_rests(d);
    assert_int_equal(viewer_said(d, "opened "), opened);
    hear_command(d, command);
    assert_int_equal(sscanf(strstr(command, " --lens circle:"), " --lens circle:%lf", &x), 1);
    assert_true(fabs(x - there) < 1e-9);
}

/* A path of two clicks in place of a target, a lens that is a ball, then a circle, which is moved,
 * a cut; and one after the other back. */
static void long_places_on_trees(void **state) {
    static const char *const buttons[] = {
        "Target here", "Path to here", "Lens here", "Round lens", "", "Cut open here"};
    static const char *const flags[] = {
        " --target ", " --path ", " --lens sphere:", " --lens circle:", "", " --subtract sphere:"};
    enum { COUNT = 6 };
    static char before[COUNT][8192];
    fixture *f = *state;
    desktop *d = f->desktop;
    start_tree(f, true);
    for (int i = 0; i < COUNT; i++) {
        hear_command(d, before[i]);
        assert_true(!*flags[i] || !strstr(before[i], flags[i]));
        if (!*buttons[i]) {
            drags_the_lens(d);
            continue;
        }
        click_middle(d, 0);
        assert_int_equal(viewer_hears(d, "picked ")[0], '2');
        user_clicks(d, buttons[i]);
        if (strcmp(buttons[i], "Path to here") == 0)
            click_middle(d, 75); /* beside the vessels */
        assert_placed(d, flags[i], true);
    }
    assert_saved(d); /* with path, risk, lens and cut */
    for (int i = COUNT; i-- > 0;)
        undoes(d, before[i]);
    click_middle(d, 0);
    user_clicks(d, "Target here");
    assert_placed(d, " --target ", true);
    user_clicks(d, "Tree");
    user_clicks(d, "Take away");
    assert_placed(d, " --target ", false);
    quit(f);
}

/* ---- videos -------------------------------------------------------------------------------- */

static const char *const film_words[] = {"render",  "--scene",    "flow",   "--lines", "60",
                                         "--width", "1",          "--ssaa", "1",       "--frames",
                                         "3",       NO_OCCLUSION, NULL};

/* In place of ffmpeg, which is looked for in the folder of the test alone. */
static void make_ffmpeg(const char *last_line) {
    char text[256];
    snprintf(text, sizeof text, "#!/bin/sh\nfor name; do :; done\n%s\n", last_line);
    write_file("ffmpeg.new", text);
    assert_int_equal(chmod("ffmpeg.new", 0755), 0);
    assert_int_equal(rename("ffmpeg.new", "ffmpeg"), 0);
}

static void film(desktop *d, const char *end) {
    user_clicks(d, "Save video");
    viewer_hears(d, "video begins");
    assert_string_equal(viewer_hears(d, "video "), end);
}

/* Its frames are those of the program; without ffmpeg, or when it fails or is stopped, there is no
 * file, and the viewer says why. */
static void makes_videos(void **state) {
    fixture *f = *state;
    desktop *d = f->desktop;
    char command[8192], folder[900];
    assert_non_null(getcwd(folder, sizeof folder));
    setenv("PATH", folder, 1);
    make_ffmpeg("/bin/cat > \"$name\"");
    start(f, film_words);
    user_clicks(d, "Save");
    user_clicks(d, "As in the window");
    film(d, "saved video.mp4");
    user_clicks(d, "Copy its command line");
    snprintf(command, sizeof command, "%s", viewer_hears(d, "command "));
    assert_non_null(strstr(command, " --frames 3 --fps 25"));
    run_command(command, "program.mp4");
    setenv("PATH", programs, 1);
    assert_int_equal(system("test -s video.mp4 && cmp video.mp4 program.mp4"), 0);
    assert_int_equal(system("rm video.mp4 program.mp4"), 0);
    make_ffmpeg("/bin/cat > /dev/null; echo it broke >&2; exit 3");
    film(d, "unsaved video.mp4");
    assert_non_null(strstr(viewer_hears(d, "error "), "ffmpeg: it broke"));
    viewer_rests(d);
    user_clicks(d, "Close");
    make_ffmpeg("/bin/sleep 1; /bin/cat > /dev/null"); /* its pipe is full at the first frame */
    user_clicks(d, "Save video");
    viewer_hears(d, "video begins");
    user_types(d, "Escape");
    assert_string_equal(viewer_hears(d, "video "), "unsaved video.mp4");
    assert_int_equal(remove("ffmpeg"), 0);
    user_clicks(d, "Save video");
    assert_non_null(strstr(viewer_hears(d, "error "), "ffmpeg is not in PATH"));
    assert_int_not_equal(system("ls | grep -q '^video\\|\\.video'"), 0); /* nor a part of one */
    quit(f);
}

static void shows_what_the_program_writes(desktop *d) {
    char command[1024];
    user_types(d, "g");
    user_types(d, "x");
    user_types(d, "1");
    fill_window(d);
    user_types(d, "c"); /* copies the command line of what is seen */
    snprintf(command, sizeof command, "%s", viewer_hears(d, "command "));
    run_command(command, "window.png");
    assert_same_window(d, "window.png");
    user_types(d, "h");
}

/* ---- files --------------------------------------------------------------------------------- */

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* A steady stream along x. */
static void write_volume(const char *path) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("# vtk DataFile Version 3.0\nstream\nASCII\nDATASET STRUCTURED_POINTS\n"
          "DIMENSIONS 12 8 8\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 768\n"
          "VECTORS velocity float\n",
          file);
    for (int i = 0; i < 768; i++)
        fputs("0.5 0 0\n", file);
    fclose(file);
}

static void opens_what_is_dropped(desktop *d) {
    char path[1024], folder[900];
    assert_non_null(getcwd(folder, sizeof folder));
    write_file("tree.swc", tree_file);
    snprintf(path, sizeof path, "%s/tree.swc", folder);
    user_drops(d, path);
    assert_string_equal(viewer_hears(d, "opened "), "render cross.obj"); /* both */
    viewer_hears(d, "frame");
    user_types(d, "c");
    assert_non_null(strstr(viewer_hears(d, "command "), "/tree.swc"));
    write_file("broken.swc", "1 1 0 0\n");
    snprintf(path, sizeof path, "%s/broken.swc", folder);
    user_drops(d, path);
    assert_non_null(strstr(viewer_hears(d, "error "), "broken.swc"));
    viewer_rests(d);
    user_clicks(d, "Close");
    user_types(d, "1"); /* the others are still there */
    assert_non_null(strstr(viewer_hears(d, "frame"), "ok"));
    user_types(d, "c");
    snprintf(path, sizeof path, "%s", viewer_hears(d, "command "));
    assert_non_null(strstr(path, "/tree.swc"));
    assert_null(strstr(path, "broken"));
    write_volume("blood.vtk");
    write_file("wall.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\n"
                           "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    for (int i = 0; i < 2; i++) {
        static const char *const files[2] = {"wall.obj", "blood.vtk"};
        snprintf(path, sizeof path, "%s/%s", folder, files[i]);
        user_drops(d, path);
        assert_string_equal(viewer_hears(d, "opened "), "render cross.obj");
        assert_non_null(strstr(viewer_hears(d, "frame"), "ok"));
        user_types(d, "c");
        assert_non_null(strstr(viewer_hears(d, "command "), files[i]));
    }
}

/* The pointer rests on a line, a tree, a wall and nothing: each is named, and the picture is not
 * drawn again for that. */
static void names_what_it_points_at(desktop *d) {
    static const struct {
        float x, z; /* mm */
        const char *said;
    } places[] = {{-20, 40, "1 0 0 1"}, {0, 15, "2 1 0 1"}, {25, 12, "3 2 1 "}, {30, 60, "0 "}};
    uint32_t frames = viewer_said(d, "frame ");
    for (int i = 0; i < 4; i++) {
        double scale = PICTURE_HEIGHT / 80.0;
        user_points(d, (int)(MIDDLE + scale * (double)places[i].x),
                    (int)(PICTURE_HEIGHT / 2 - scale * ((double)places[i].z - 25)));
        const char *said = viewer_hears(d, "hovers ");
        assert_memory_equal(said, places[i].said, strlen(places[i].said));
    }
    viewer_rests(d);
    assert_int_equal(viewer_said(d, "frame "), frames);
}

/* Of a file that cannot be read; then there is nothing to draw, and nothing is done. */
static void explains_and_rests(void **state) {
    fixture *f = *state;
    const char *words[] = {"--backend", f->backend, "--window", "700x400", "broken.swc", NULL};
    write_file("broken.swc", "1 1 0 0\n");
    viewer_start(f->desktop, viewer, words);
    assert_non_null(strstr(viewer_hears(f->desktop, "error "), "broken.swc"));
    viewer_rests(f->desktop);
    user_clicks(f->desktop, "Close");
    viewer_rests(f->desktop);
    quit(f);
}

/* Lines, a tree and a wall in one picture; then without one of them. */
static void mixes(void **state) {
    static const char *const words[] = {
        "beam.obj",
        "--width",
        "2",
        "aim.swc",
        "--unit",
        "mm",
        "tent.obj",
        "--ssaa",
        "1",
        "--camera",
        "{\"eye\":[0,-200,25],\"center\":[0,0,25],\"up\":[0,0,1],\"ortho_height\":80}",
        NULL};
    fixture *f = *state;
    desktop *d = f->desktop;
    write_file("beam.obj", "v -30 0 40\nv -21 0 40\nv -10 0 40\nl 1 2 3\n");
    write_file("aim.swc", tree_file);
    write_file("tent.obj", "v 15 -10 0\nv 35 -10 0\nv 25 10 0\nv 25 0 25\n"
                           "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    start(f, words);
    names_what_it_points_at(d);
    writes_what_the_program_writes(d, "strength");
    user_types(d, "c");
    assert_non_null(strstr(viewer_hears(d, "command "), "beam.obj --width 2 --set strength="));
    user_clicks(d, "Scene");
    user_clicks(d, "Take away"); /* the last: the wall */
    assert_string_equal(viewer_hears(d, "opened "), "render beam.obj");
    viewer_hears(d, "frame");
    user_types(d, "c");
    const char *command = viewer_hears(d, "command ");
    assert_null(strstr(command, "tent.obj"));
    assert_non_null(strstr(command, "aim.swc --unit mm"));
    assert_non_null(strstr(command, "beam.obj --width 2 --set strength="));
    quit(f);
}

/* ---- picking and comparing
 * ------------------------------------------------------------------- */

/* Two lines cross, the upper one (the second) nearer to an eye above; a click on the crossing takes
 * that one, beside it the other, into the void nothing. */
static void picks_and_opens(void **state) {
    static const char *const words[] = {
        "render",
        NO_OCCLUSION,
        "cross.obj",
        "--width",
        "4",
        "--ssaa",
        "1",
        "--camera",
        "{\"eye\":[0,0,100],\"center\":[0,0,0],\"up\":[0,1,0],\"ortho_height\":60}",
        NULL};
    static const struct {
        float x, y, z; /* mm */
        int kind, line;
    } clicks[] = {{0, 0, 5, 1, 1}, {12, 0, -5, 1, 0}, {0, -12, 5, 1, 1}, {12, 12, 0, 0, 0}};
    fixture *f = *state;
    desktop *d = f->desktop;
    write_file("cross.obj", "v -20 0 -5\nv 0 0 -5\nv 20 0 -5\nv 0 -20 5\nv 0 0 5\nv 0 20 5\n"
                            "l 1 2 3\nl 4 5 6\n");
    start(f, words);
    fill_window(d);
    for (int i = 0; i < 4; i++) {
        int kind, set, line, point;
        float at[3], mm = (float)HEIGHT / 60;
        user_points(d, (int)(WIDTH / 2 + mm * clicks[i].x), (int)(HEIGHT / 2 - mm * clicks[i].y));
        user_presses(d, 1, true);
        user_presses(d, 1, false);
        const char *said = viewer_hears(d, "picked ");
        assert_int_equal(sscanf(said, "%d %d %d %d %f %f %f", &kind, &set, &line, &point, &at[0],
                                &at[1], &at[2]),
                         7);
        assert_int_equal(kind, clicks[i].kind);
        assert_int_equal(line, clicks[i].line);
        for (int k = 0; kind && k < 3; k++)
            assert_float_equal(at[k], (&clicks[i].x)[k], 0.2);
    }
    opens_what_is_dropped(d);
    quit(f);
}

/* Bits that differ. */
static long said_bits(desktop *d) {
    const char *said = viewer_hears(d, "compared ");
    return strtol(strrchr(said, ' '), NULL, 10);
}

/* One setting, alike on both sides at first; with two values the pictures differ. */
static void compares_settings(desktop *d) {
    viewer_rests(d);
    user_clicks(d, "##differs");
    user_clicks(d, "##differs occlusion");
    assert_int_equal(said_bits(d), 0);
    user_clicks(d, "right value ##value");
    assert_true(said_bits(d) > 0);
}

static void compares_backends(desktop *d) {
    user_clicks(d, "Compare");
    viewer_rests(d); /* the panel has its final places */
    user_clicks(d, "Two pictures side by side");
    for (int i = 0; i < 2; i++) {
        const char *said = viewer_hears(d, "compared out ");
        assert_string_equal(said + strlen(said) - 2, " 0"); /* bits that differ */
        user_points(d, MIDDLE, 30);                         /* the divider */
        user_presses(d, 1, true);
        user_points(d, MIDDLE + 12, 30);
        user_points(d, MIDDLE + 30, 30);
        user_presses(d, 1, false);
        user_clicks(d, "Difference");
        user_types(d, "2");
    }
    viewer_hears(d, "compared out ");
    compares_settings(d);
    user_clicks(d, "Two pictures side by side");
    viewer_hears(d, "frame");
}

/* Every image that the list names is read from both sides, which agree, and is painted between two
 * numbers; or it does not exist with these settings, on neither side. Returns how many exist. */
static int shows_images(desktop *d) {
    char label[128];
    int there = 0;
    uint32_t i = 0;
    user_clicks(d, "Compare");
    viewer_rests(d);
    user_clicks(d, "Two pictures side by side");
    viewer_hears(d, "compared out ");
    viewer_rests(d);
    user_clicks(d, "##image");
    viewer_rests(d);
    for (; user_finds(d, "##image ", i, label, sizeof label); i++) {
        const char *name = label + strlen("##image ");
        char said[160];
        float low = 0, high = 0;
        if (strcmp(name, "out") == 0)
            continue;
        user_clicks(d, label);
        assert_int_equal(sscanf(viewer_hears(d, "range "), "%f %f", &low, &high), 2);
        snprintf(said, sizeof said, "%s", viewer_hears(d, "compared "));
        assert_memory_equal(said, name, strlen(name));
        if (strstr(said, " 0x0 -1")) /* in this plan there is none */
            low = high = 0;
        else
            there++;
        if (!strstr(said, " 0x0 -1"))
            assert_string_equal(strrchr(said, ' '), " 0");
        assert_true(isfinite(low) && isfinite(high) && low <= high);
        viewer_rests(d);
        user_clicks(d, "##image"); /* the list again, with this one in its middle */
        viewer_rests(d);
    }
    user_types(d, "Escape");
    assert_int_equal(0, viewer_said(d, "error"));
    assert_true(i > 1);
    print_message("%d of %u images\n", there, i - 1);
    return there;
}

static void images(void **state, const char *const *words) {
    fixture *f = *state;
    start(f, words);
    assert_true(shows_images(f->desktop) > 3);
    quit(f);
}

static void long_images_of_lines(void **state) {
    images(state, flow);
}

static void long_images_of_trees(void **state) {
    static const char *const words[] = {"vessel", "aim.swc", "--unit", "mm", "--grid",
                                        "32",     "--ssaa",  "1",      NULL};
    write_file("aim.swc", tree_file);
    images(state, words);
}

static void long_images_of_surfaces(void **state) {
    static const char *const words[] = {"surface", "--scene", "bone", "--ssaa", "1", NULL};
    images(state, words);
}

/* All that one viewer can show of lines. */
static void shows_lines(void **state) {
    fixture *f = *state;
    start(f, flow);
    plays_and_stops(f->desktop);
    keeps_views(f->desktop);
    turns_and_resizes(f->desktop);
    writes_what_the_program_writes(f->desktop, "strength");
    shows_what_the_program_writes(f->desktop);
    compares_backends(f->desktop);
    quit(f);
}

/* On a monitor of twice the pixels per inch everything is twice as large, unless told; so is the
 * window, as far as there is room. */
static void follows_the_monitor(void **state) {
    fixture *f = *state;
    const char *words[] = {"--backend", f->backend, "render",     "--scene", "crossing",
                           "--lines",   "50",       NO_OCCLUSION, NULL};
    static const char *const sizes[2] = {" 950x768 ok", " 940x936 ok"}; /* of the picture */
    int heights[2];
    for (int i = 0; i < 2; i++) {
        int place[4];
        desktop_resolution(f->desktop, i ? 192 : 96);
        viewer_start(f->desktop, viewer, words);
        assert_non_null(strstr(viewer_hears(f->desktop, "frame"), sizes[i]));
        user_sees(f->desktop, "Scene", place);
        heights[i] = place[3];
        quit(f);
    }
    desktop_resolution(f->desktop, 96);
    assert_in_range(heights[1], 2 * heights[0] - 2, 2 * heights[0] + 2);
}

/* ---- all of it ----------------------------------------------------------------------------- */

static int set_up(void **state) {
    char cache[1024];
    fixture *f = *state;
    f->desktop = desktop_start();
    if (!f->desktop) {
        print_error("Xvfb cannot be started; ./run setup installs it\n");
        return -1;
    }
    snprintf(programs, sizeof programs, "%s", getenv("PATH"));
    strcpy(f->folder, "view_XXXXXX");
    if (!mkdtemp(f->folder) || chdir(f->folder) != 0 || !getcwd(cache, sizeof cache))
        return -1;
    setenv("MESA_SHADER_CACHE_DISABLE", "false", 1); /* of this run alone */
    setenv("MESA_SHADER_CACHE_DIR", cache, 1);
    return 0;
}

static int clean_up(void **state) {
    fixture *f = *state;
    viewer_kill(f->desktop);
    setenv("PATH", programs, 1);
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    char line[64];
    snprintf(line, sizeof line, "cd .. && rm -rf '%s'", f->folder);
    if (system(line) != 0)
        print_error("%s stays\n", f->folder);
    desktop_stop(f->desktop);
    return 0;
}

int main(int argc, char **argv) {
    if (argc != 4 && argc != 5) {
        fprintf(stderr, "usage: test_view VIEWER LINEAO gl|vk [NAME|long_*]\n");
        return 2;
    }
    fixture f = {argv[3], "", NULL};
    viewer = argv[1];
    program = argv[2];
    const struct CMUnitTest tests[] = {
        {"shows_lines", shows_lines, NULL, clean_up, &f},
        {"saves_surfaces", saves_surfaces, NULL, clean_up, &f},
        {"places_on_trees", places_on_trees, NULL, clean_up, &f},
        {"makes_videos", makes_videos, NULL, clean_up, &f},
        {"follows_the_monitor", follows_the_monitor, NULL, clean_up, &f},
        {"picks_and_opens", picks_and_opens, NULL, clean_up, &f},
        {"explains_and_rests", explains_and_rests, NULL, clean_up, &f},
        {"mixes", mixes, NULL, clean_up, &f},
        {"relights_walls", relights_walls, NULL, clean_up, &f},
        {"long_places_on_trees", long_places_on_trees, NULL, clean_up, &f},
        {"long_images_of_lines", long_images_of_lines, NULL, clean_up, &f},
        {"long_images_of_trees", long_images_of_trees, NULL, clean_up, &f},
        {"long_images_of_surfaces", long_images_of_surfaces, NULL, clean_up, &f},
    };
    void *state = &f;
    if (argc > 4) /* those of this name */
        cmocka_set_test_filter(argv[4]);
    else
        cmocka_set_skip_filter("long_*");
    if (set_up(&state) != 0)
        return 1;
    int failed = cmocka_run_group_tests_name(f.backend, tests, NULL, NULL);
    tear_down(&state);
    return failed;
}
