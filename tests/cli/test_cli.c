/* The lineao program keeps the contract that scripts rely on: exit codes, one line per failure, one
 * JSON object, whole files or none, flags that bind to their FILE, dumps with named channels, and
 * the same picture from OpenGL and Vulkan. */
#include "program.h"

#include "image.h"
#include "io.h"

#include <cJSON.h>
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static const char *program; /* its path, from the command line */

#define RUN(...) program_start(program, false, __VA_ARGS__)
#define SMALL "--size 96x64 --lines 40 "
#define PLAIN SMALL "--occlusion off --ssaa 1 " /* no pass that takes long to compile */

static void expect_ok(program_run run) {
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    assert_string_equal(run.err, "");
    program_free(&run);
}

static bool same_pictures(const char *a, const char *b) {
    uint32_t size[4];
    uint8_t *x, *y;
    assert_true(image_read_png(a, 4, &size[0], &size[1], &x, NULL));
    assert_true(image_read_png(b, 4, &size[2], &size[3], &y, NULL));
    bool same = size[0] == size[2] && size[1] == size[3] &&
                memcmp(x, y, (size_t)size[0] * size[1] * 4) == 0;
    free(x);
    free(y);
    return same;
}

static double number(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItem(object, key);
    assert_true(cJSON_IsNumber(item));
    return item->valuedouble;
}

/* Two bundles of straight lines; the second lies at `x` mm, and has an attribute "fa". */
static void write_lines(const char *path, float x, double origin) {
    enum { LINES = 8, POINTS = 5 };
    uint32_t offsets[LINES + 1];
    float points[3 * LINES * POINTS], values[LINES * POINTS];
    io_attribute attribute = {(char[]){"fa"}, 1, values};
    io_lines lines;
    io_error error;
    memset(&lines, 0, sizeof lines);
    for (uint32_t i = 0; i < LINES * POINTS; i++) {
        uint32_t line = i / POINTS;
        offsets[line + 1] = i + 1;
        points[3 * (size_t)i] = x + (float)line;
        points[3 * (size_t)i + 1] = (float)(i % POINTS) * 2;
        points[3 * (size_t)i + 2] = (float)(line % 3);
        values[i] = (float)i;
    }
    offsets[0] = 0;
    lines.line_count = LINES;
    lines.point_count = LINES * POINTS;
    lines.offsets = offsets;
    lines.points = points;
    lines.origin[2] = origin;
    lines.point_attribute_count = 1;
    lines.point_attributes = &attribute;
    assert_true(io_write_lines(path, &lines, &error));
}

/* ---- words only ------------------------------------------------------------------------- */

static void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void test_help(void **state) {
    static const char *const lines[] = {"--help",     "help",        "info --help", "render --help",
                                        "compare -h", "help render", "--version"};
    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        program_run run = RUN("%s", lines[i]);
        assert_int_equal(run.code, 0);
        assert_string_equal(run.err, "");
        assert_true(strlen(run.out) > 8);
        program_free(&run);
    }
    program_run run = RUN("render --help");
    assert_non_null(strstr(run.out, "--align-intensity")); /* from the table of settings */
    assert_non_null(strstr(run.out, "0..100"));
    program_free(&run);
}

static void test_wrong_usage(void **state) {
    (void)state;
    expect_fault(RUN("%s", ""), 2, "command");
    expect_fault(RUN("rendr"), 2, "render");
    expect_fault(RUN("vesel"), 2, "info, render, compare");
    expect_fault(RUN("render"), 2, "-o");
    expect_fault(RUN("info"), 2, "FILE");
    expect_fault(RUN("info --strength 2 x"), 2, "--strength");
    expect_fault(RUN("render --sise 9x9 -o x.png"), 2, "--size");
    expect_fault(RUN("render -o"), 2, "-o");
    expect_fault(RUN("render --ortho=1 -o x.png"), 2, "--ortho");
    expect_fault(RUN("render --size 0x9 -o x.png"), 2, "--size");
    expect_fault(RUN("render --size 9 -o x.png"), 2, "WxH");
    expect_fault(RUN("render --size 99999x9 -o x.png"), 2, "1 to 32768");
    expect_fault(RUN("render -o x.JPEG"), 2, "must end in .png");
    expect_fault(RUN("render --every 1.5 -o x.png"), 2, "--every");
    expect_fault(RUN("render --time 1,5 -o x.png"), 2, "--time");
    expect_fault(RUN("render --time 0x10 -o x.png"), 2, "--time");
    expect_fault(RUN("render --range 3,3 -o x.png"), 2, "--range");
    expect_fault(RUN("render --color #12345 -o x.png"), 2, "--color");
    expect_fault(RUN("render --background 2,0,0 -o x.png"), 2, "--background");
    expect_fault(RUN("render --backend metal -o x.png"), 2, "gl|vk");
    expect_fault(RUN("render --view front -o x.png"), 2, "axial");
    expect_fault(RUN("render --scene aorte -o x.png"), 2, "aorta");
    expect_fault(RUN("render --set strenth=2 -o x.png"), 2, "strength");
    expect_fault(RUN("render --set strength -o x.png"), 2, "name=value");
    expect_fault(RUN("render --strength 99 -o x.png"), 2, "0..5");
    expect_fault(RUN("render --preset clasic -o x.png"), 2, "classic");
    expect_fault(RUN("render --camera a --view iso -o x.png"), 2, "--view");
    expect_fault(RUN("render a.trk --lines 5 -o x.png"), 2, "--every");
    expect_fault(RUN("render --every 5 -o x.png"), 2, "--every");
}

static void test_failures(void **state) {
    (void)state;
    write_lines("fail.vtp", 0, 0);
    expect_fault(RUN("info no.trk"), 1, "no.trk: ");
    expect_fault(RUN("info --json fail.vtp no.trk"), 1, "no.trk: ");
    expect_fault(RUN("render no.trk -o fail.png"), 1, "no.trk: ");
    expect_fault(RUN("render no\nline.trk -o fail.png"), 1, "no line.trk: ");
    expect_fault(RUN("render --camera no.json -o fail.png"), 1, "no.json: ");
    expect_fault(RUN("render fail.vtp --color fb -o fail.png"), 1, "fa");
    expect_fault(RUN("render fail.vtp --bundle b -o fail.png"), 1, "fail.vtp: ");
    write_lines("fail.trk", 0, 0);
    expect_fault(RUN("vessel fail.trk -o fail.png"), 1, "lineao render draws it");
    expect_fault(RUN("surface fail.trk -o fail.png"), 1, "lineao render draws it");
    assert_int_equal(access("fail.png", F_OK), -1);
    write_text("empty.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n"
                            "POINTS 0 float\nLINES 0 0\n");
    program_run run = RUN("render empty.vtk --size 16x16 --ssaa 1 -o empty.png");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.err, "lineao: empty.vtk: warning: there are no lines to draw"));
    program_free(&run);
}

/* Lines of another unit than mm are drawn as wide as suits them, which is told once; those of a
 * usual size as ever, and all as --width says. */
static void test_odd_sizes(void **state) {
    static const struct {
        double size;
        const char *flags, *told; /* NULL: nothing is */
    } rows[] = {{2, "", "too wide; they are 0.0067 mm"},
                {2, "--width 0.1", NULL},
                {150, "", NULL},
                {3000, "", "too thin; they are 10 mm"}};
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[160];
        snprintf(text, sizeof text,
                 "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0 %g "
                 "0 0\nLINES 1 3\n2 0 1\n",
                 rows[i].size);
        write_text("odd.vtk", text);
        program_run run = RUN("render odd.vtk %s --size 32x32 --ssaa 1 -o odd.png", rows[i].flags);
        assert_int_equal(run.code, 0);
        if (rows[i].told)
            assert_non_null(strstr(run.err, rows[i].told));
        assert_int_equal(program_lines(run.err), rows[i].told ? 1 : 0);
        program_free(&run);
    }
}

/* Nothing is left where nothing can be written. */
static void test_no_folder(void **state) {
    (void)state;
    mkdir("cli_folder", 0700);
    expect_fault(RUN("render -o cli_folder/no/a.png"), 1, "cli_folder/no/a.png: ");
    expect_fault(RUN("render -o cli_folder"), 1, "cli_folder: ");
    expect_fault(RUN("render -o cli_folder/a.png --dump cli_folder/no/a.exr"), 1, "no/a.exr: ");
    expect_fault(RUN("compare -o cli_folder/no/a.png"), 1, "no/a.png: ");
    if (geteuid() != 0) {
        chmod("cli_folder", 0500);
        expect_fault(RUN("render -o cli_folder/a.png"), 1, "cli_folder/a.png: ");
        chmod("cli_folder", 0700);
    }
    assert_int_equal(rmdir("cli_folder"), 0); /* was empty */
}

static void test_interrupt(void **state) {
    (void)state;
    remove("stop.png");
    write_lines("stop.vtp", 0, 0);
    expect_fault(program_start(program, true, "render stop.vtp -o stop.png"), 1, "interrupted");
    expect_fault(program_start(program, true, "info stop.vtp --json"), 1, "interrupted");
    expect_fault(program_start(program, true, "render " PLAIN "-o stop.png"), 1, "interrupted");
    assert_int_equal(access("stop.png", F_OK), -1);
}

static void test_info(void **state) {
    (void)state;
    write_lines("info.vtp", 3, 0);
    program_run run = RUN("info info.vtp info.vtp --json");
    assert_int_equal(run.code, 0);
    cJSON *json = cJSON_Parse(run.out), *files = cJSON_GetObjectItem(json, "files");
    assert_int_equal(cJSON_GetArraySize(files), 2);
    const cJSON *file = files->child, *box = cJSON_GetObjectItem(file, "bbox");
    assert_string_equal(cJSON_GetObjectItem(file, "path")->valuestring, "info.vtp");
    assert_string_equal(cJSON_GetObjectItem(file, "format")->valuestring, "vtp");
    assert_string_equal(cJSON_GetObjectItem(file, "unit")->valuestring, "mm");
    assert_int_equal(number(file, "lines"), 8);
    assert_int_equal(number(file, "points"), 40);
    assert_true(box->child->child->valuedouble == 3 && box->child->next->child->valuedouble == 10);
    assert_string_equal(cJSON_GetObjectItem(file, "attributes")->child->valuestring, "fa");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(file, "warnings")), 0);
    cJSON_Delete(json);
    program_free(&run);
    run = RUN("info info.vtp");
    assert_non_null(strstr(run.out, "fa (per point)"));
    program_free(&run);
}

/* The first file of `lineao info ...`; *json is to be deleted. */
static const cJSON *info_of(const char *arguments, cJSON **json) {
    program_run run = program_start(program, false, arguments);
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    *json = cJSON_Parse(run.out);
    assert_non_null(*json);
    program_free(&run);
    return cJSON_GetObjectItem(*json, "files")->child;
}

/* One root, a branch of three, a radius of 0, and a parent that is missing. */
static void test_info_tree(void **state) {
    static const struct {
        const char *key;
        double value;
    } figures[] = {{"lines", 0},        {"points", 6}, {"nodes", 6},    {"segments", 4},
                   {"roots", 2},        {"leaves", 3}, {"branches", 1}, {"multifurcations", 1},
                   {"max_children", 3}, {"loops", 0},  {"joined", 0}};
    (void)state;
    write_text("tree.swc", "1 1 0 0 0 2 -1\n2 3 0 0 4 1.5 1\n3 3 1 0 8 1 2\n4 3 -1 0 8 0.5 2\n"
                           "5 3 0 1 9 0 2\n6 3 5 5 5 0.25 99\n");
    cJSON *json;
    const cJSON *file = info_of("info --json tree.swc --unit um", &json);
    for (size_t i = 0; i < sizeof figures / sizeof figures[0]; i++)
        assert_true(number(file, figures[i].key) == figures[i].value);
    assert_string_equal(cJSON_GetObjectItem(file, "format")->valuestring, "swc");
    assert_string_equal(cJSON_GetObjectItem(file, "unit")->valuestring, "um");
    const cJSON *radius = cJSON_GetObjectItem(file, "radius");
    assert_true(radius->child->valuedouble == 0 && radius->child->next->valuedouble == 2);
    const cJSON *box = cJSON_GetObjectItem(file, "bbox");
    assert_true(box->child->child->valuedouble == -1 && box->child->next->child->valuedouble == 5);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(file, "warnings")), 3);
    cJSON_Delete(json);
    file = info_of("info --json tree.swc", &json); /* and that the unit is a guess */
    assert_string_equal(cJSON_GetObjectItem(file, "unit")->valuestring, "mm");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(file, "warnings")), 4);
    cJSON_Delete(json);
    program_run run = RUN("info tree.swc --unit um");
    assert_non_null(strstr(run.out, "max children        3"));
    assert_int_equal(program_lines(run.err), 3);
    program_free(&run);
    write_text("ring.swc", "1 1 0 0 0 2 2\n2 3 0 0 4 1.5 1\n");
    expect_fault(RUN("info ring.swc"), 1, "cycle");
    expect_fault(RUN("info tree.swc --unit mile"), 2, "mile");
    expect_fault(RUN("render tree.swc --as lines -o tree.png"), 1, "vessel tree");
}

/* An open box of two triangles, one of them told with vertices of its own. */
static void test_info_mesh(void **state) {
    (void)state;
    write_text("mesh.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 1 1 0\nv 0 1 0\n"
                           "f 1 2 3\nf 4 5 6\nf 1 4 2\n");
    cJSON *json;
    const cJSON *file = info_of("info --json mesh.obj", &json);
    assert_int_equal(number(file, "points"), 6);
    assert_int_equal(number(file, "vertices"), 4);
    assert_int_equal(number(file, "triangles"), 2);
    assert_int_equal(number(file, "boundary_edges"), 4);
    assert_int_equal(number(file, "non_manifold_edges"), 0);
    assert_int_equal(number(file, "components"), 1);
    assert_string_equal(cJSON_GetObjectItem(file, "kinds")->child->valuestring, "mesh");
    cJSON_Delete(json);
}

/* ---- pictures --------------------------------------------------------------------------- */

/* Every flag that changes the picture does, and those that should not do not. */
static void test_flags(void **state) {
    static const char *const same[] = {"--occlusion off",      "--time 400 --trail none",
                                       "--backend vk",         "--set width=0.5",
                                       "--background #f4f4f2", "--scene aorta"};
    static const char *const other[] = {"--time 400",
                                        "--trail highlight --time 400",
                                        "--halo none",
                                        "--width 2",
                                        "--set width=2",
                                        "--color line",
                                        "--color direction",
                                        "--color speed",
                                        "--color speed --colormap inferno",
                                        "--color speed --range 0,9",
                                        "--color 0.2,0.4,1",
                                        "--background 0,0,0,0",
                                        "--view coronal",
                                        "--ortho",
                                        "--scene helix",
                                        "--diffuse 0.5",
                                        "--show color"};
    (void)state;
    expect_ok(RUN("render " PLAIN "-o flag.png"));
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        expect_ok(RUN("render " PLAIN "%s -o flag2.png", same[i]));
        assert_true(same_pictures("flag.png", "flag2.png"));
    }
    for (size_t i = 0; i < sizeof other / sizeof *other; i++) {
        expect_ok(RUN("render " PLAIN "%s -o flag2.png", other[i]));
        assert_false(same_pictures("flag.png", "flag2.png"));
    }
    expect_ok(RUN("render " PLAIN "--color #3366cc -o flag.png"));
    expect_ok(RUN("render " PLAIN "--color=0.2,0.4,0.8 -o flag2.png"));
    assert_true(same_pictures("flag.png", "flag2.png"));
}

static void test_flags_of_files(void **state) {
    (void)state;
    write_lines("a.vtp", 0, 0);
    write_lines("b.vtp", 20, 0);
    const char *size = "--size 96x64 --occlusion off --ssaa 1";
    expect_ok(RUN("render %s a.vtp b.vtp -o f0.png", size));
    expect_ok(RUN("render %s a.vtp b.vtp --width 1.5 -o f1.png", size));
    expect_ok(RUN("render %s a.vtp --width 1.5 b.vtp -o f2.png", size));
    expect_ok(RUN("render %s --width 1.5 a.vtp b.vtp --width 0.5 -o f3.png", size));
    assert_false(same_pictures("f0.png", "f1.png"));
    assert_false(same_pictures("f1.png", "f2.png"));
    assert_true(same_pictures("f2.png", "f3.png"));
    expect_ok(RUN("render %s a.vtp b.vtp --every 2 --min-length 1 --color fa -o f4.png", size));
    assert_false(same_pictures("f0.png", "f4.png"));
    expect_ok(
        RUN("render --size 48x32 --occlusion off a.vtp --ssaa 3 b.vtp --backend vk -o f5.png"));
    write_lines("c.vtp", 0.5f, -1); /* behind those of a.vtp */
    size = "--size 96x64 --ssaa 1 --samples 20 --width 0.5 --halo none";
    expect_ok(RUN("render %s a.vtp c.vtp -o f0.png", size));
    expect_ok(RUN("render %s a.vtp c.vtp --shared-occlusion -o f1.png", size));
    expect_ok(RUN("render %s a.vtp c.vtp --shared-occlusion --backend vk -o f2.png", size));
    assert_false(same_pictures("f0.png", "f1.png"));
    assert_true(same_pictures("f1.png", "f2.png"));
}

/* Far from zero too. */
static void test_camera(void **state) {
    (void)state;
    write_lines("far.vtp", 0.3f, -1100.7);
    const char *rest = "--size 96x64 --occlusion off --ssaa 1 far.vtp --width 1";
    for (int ortho = 0; ortho < 2; ortho++) {
        expect_ok(
            RUN("render %s %s --save-camera cam.json -o c0.png", rest, ortho ? "--ortho" : ""));
        expect_ok(RUN("render %s --camera cam.json --save-camera cam2.json -o c1.png", rest));
        assert_true(same_pictures("c0.png", "c1.png"));
        char *a = read_text("cam.json"), *b = read_text("cam2.json");
        assert_string_equal(a, b);
        free(a);
        free(b);
        cJSON *json = read_json("cam.json");
        assert_true(number(json, ortho ? "ortho_height" : "fovy") > 0);
        assert_true(cJSON_GetArrayItem(cJSON_GetObjectItem(json, "center"), 2)->valuedouble <
                    -1000);
        cJSON_Delete(json);
    }
}

static void test_sequence(void **state) {
    (void)state;
    expect_ok(RUN("render " PLAIN "--frames 2 -o seq.png"));
    expect_ok(RUN("render " PLAIN "--frames 2 -o seq-%%02d.x.png"));
    assert_true(same_pictures("seq_0000.png", "seq-00.x.png"));
    assert_int_equal(access("seq_0001.png", F_OK), 0);
    assert_int_equal(access("seq-01.x.png", F_OK), 0);
    assert_int_equal(access("seq.png", F_OK), -1);
}

/* Frame k of N is the picture of the first time plus k parts of the period. */
static void test_times(void **state) {
    (void)state;
    expect_ok(RUN("render " PLAIN "--frames 4 --period 800 --time 100 -o beat.png"));
    expect_ok(RUN("render " PLAIN "--period 800 --time 300 -o frame.png"));
    assert_true(same_pictures("beat_0001.png", "frame.png"));
    assert_false(same_pictures("beat_0000.png", "frame.png"));
    expect_ok(RUN("render " PLAIN "--period 800 --time 1100 -o frame.png"));
    assert_true(same_pictures("beat_0001.png", "frame.png"));
    expect_fault(RUN("render " PLAIN "--scene helix --time 5 -o none.png"), 1, "time");
    expect_fault(RUN("render " PLAIN "--scene helix --frames 2 -o none.png"), 1, "time");
    expect_fault(RUN("render " PLAIN "--scene helix --trail taper -o none.png"), 1, "time");
    assert_int_equal(access("none.png", F_OK), -1);
    expect_fault(RUN("render " PLAIN "-o v.mp4"), 2, "--frames");
    expect_fault(RUN("render " PLAIN "--fps 9 -o v.png"), 2, "--fps");
    expect_fault(RUN("render " PLAIN "--frames 2 --background 0,0,0,0 -o v.gif"), 2,
                 "--background");
}

/* A stand-in for ffmpeg, in the folder that alone is in PATH. */
static void fake_ffmpeg(const char *script) {
    FILE *file = fopen("bin/ffmpeg", "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\n%s\n", script);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod("bin/ffmpeg", 0755), 0);
}

/* Nothing but these files lies here: no half video, no temporary file. */
static int files_of_video(void) {
    struct dirent *entry;
    DIR *folder = opendir(".");
    int count = 0;
    assert_non_null(folder);
    while ((entry = readdir(folder)) != NULL)
        count += strncmp(entry->d_name, "film", 4) == 0;
    closedir(folder);
    return count;
}

static void test_videos(void **state) {
    const char *set = getenv("PATH");
    char *before = strdup(set ? set : ""), *here = getcwd(NULL, 0), path[4096];
    struct stat status;
    (void)state;
    assert_non_null(before);
    assert_non_null(here);
    mkdir("bin", 0755);
    remove("bin/ffmpeg"); /* of a run that was stopped */
    assert_true(snprintf(path, sizeof path, "%s/bin", here) < (int)sizeof path);
    setenv("PATH", path, 1);
    expect_fault(RUN("render " PLAIN "--frames 2 -o film.mp4"), 1,
                 "film.mp4: ffmpeg is not in PATH");
    assert_int_equal(files_of_video(), 0);
    fake_ffmpeg("for last; do :; done\n/bin/cat >\"$last\"");
    expect_ok(RUN("render " PLAIN "--frames 3 -o film.webm"));
    assert_int_equal(stat("film.webm", &status), 0);
    assert_int_equal(status.st_size, 3 * 3 * 96 * 64);
    assert_int_equal(remove("film.webm"), 0);
    fake_ffmpeg("echo no such codec >&2\nexit 1");
    expect_fault(RUN("render " PLAIN "--frames 40 -o film.mp4"), 1,
                 "film.mp4: ffmpeg: no such codec");
    assert_int_equal(files_of_video(), 0);
    fake_ffmpeg("for last; do :; done\n/bin/cat >\"$last\"\nexit 3");
    expect_fault(RUN("render " PLAIN "--frames 2 -o film.gif"), 1, "film.gif: ffmpeg failed");
    expect_fault(program_start(program, true, "render " PLAIN "--frames 2 -o film.gif"), 1,
                 "interrupted");
    assert_int_equal(files_of_video(), 0);
    setenv("PATH", before, 1);
    free(before);
    free(here);
}

static void test_timings(void **state) {
    (void)state;
    expect_ok(RUN("render " PLAIN "--backend vk --timings t.json"));
    expect_ok(RUN("render " PLAIN "--timings t.json"));
    cJSON *json = read_json("t.json"), *passes = cJSON_GetObjectItem(json, "passes");
    double sum = 0;
    for (const cJSON *pass = passes->child; pass; pass = pass->next)
        sum += number(pass, "ms");
    assert_true(cJSON_GetArraySize(passes) >= 3);
    assert_true(sum > 0 && sum <= 1.05 * number(json, "frame_ms"));
    cJSON_Delete(json);
}

/* ---- numbers ---------------------------------------------------------------------------- */

static const float *channel(const image_exr *exr, const char *name, uint32_t width,
                            uint32_t height) {
    const image_part *part;
    const float *data = image_exr_channel(exr, name, &part);
    if (!data)
        print_error("no channel %s\n", name);
    assert_non_null(data);
    assert_int_equal(part->width, width);
    assert_int_equal(part->height, height);
    return data;
}

static void check_attribute(const image_exr *exr) {
    static const char *const keys[] = {"version",  "backend", "size",      "camera",
                                       "matrices", "sphere",  "settings",  "sets",
                                       "origin",   "time",    "background"};
    cJSON *json = cJSON_Parse(exr->attribute);
    assert_non_null(json);
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        assert_non_null(cJSON_GetObjectItem(json, keys[i]));
    const cJSON *matrices = cJSON_GetObjectItem(json, "matrices");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(matrices, "view")), 16);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(matrices, "projection")), 16);
    const cJSON *settings = cJSON_GetObjectItem(json, "settings");
    assert_true(number(settings, "strength") == 2.5);
    assert_string_equal(cJSON_GetObjectItem(settings, "align")->valuestring, "rotation");
    cJSON_Delete(json);
}

/* Each preset's numbers of a direction: cos 2a and sin 2a; alpha = |cos a| and its validity; none.
 */
static void test_dump_of_directions(void **state) {
    static const char *const presets[] = {"default", "paper", "classic"};
    enum { W = 192, H = 128 };
    image_exr exr[3];
    char error[IMAGE_ERROR_SIZE], command[256];
    const float *c[3], *s[3], *d[3], *mask = NULL, *depth = NULL;
    uint32_t covered = 0;
    (void)state;
    for (int i = 0; i < 3; i++) {
        snprintf(command, sizeof command, "render %s--halo none --preset %s --dump directions.exr",
                 SMALL, presets[i]);
        expect_ok(RUN(command));
        assert_true(image_read_exr("directions.exr", &exr[i], error));
        c[i] = channel(&exr[i], "axial0.C", W, H);
        s[i] = channel(&exr[i], "axial0.S", W, H);
        d[i] = channel(&exr[i], "axial0.D", W, H);
        mask = channel(&exr[i], "mask.V", W, H);
        depth = channel(&exr[i], "depth.Z", W, H);
    }
    for (uint32_t i = 0; i < W * H; i++) {
        assert_true(c[2][i] == 0 && s[2][i] == 0);
        if (mask[i] == 0) {
            assert_true(c[0][i] == 0 && s[0][i] == 0 && c[1][i] == 0 && s[1][i] == 0);
            assert_true(d[0][i] == 1 && d[1][i] == 1 && d[2][i] == 1);
            continue;
        }
        covered++;
        assert_true(s[1][i] == 1);
        assert_float_equal(c[0][i] * c[0][i] + s[0][i] * s[0][i], 1, 1e-6);
        assert_float_equal(c[1][i] * c[1][i], 0.5f + 0.5f * c[0][i], 2e-3);
        assert_float_equal(d[0][i], depth[i], 6e-7);
        assert_true(d[0][i] == d[1][i] && d[0][i] == d[2][i]);
    }
    assert_true(covered > 100);
    for (int i = 0; i < 3; i++)
        image_exr_free(&exr[i]);
}

static void test_dump(void **state) {
    static const char *const names[] = {"color.R", "color.G",  "color.B",  "tangent.X",
                                        "zoom.V",  "axial0.C", "axial0.S", "axial0.D"};
    enum { W = 192, H = 128 };
    image_exr exr;
    char error[IMAGE_ERROR_SIZE];
    uint32_t covered = 0, width, height;
    (void)state;
    expect_ok(RUN("render " SMALL "--strength 2.5 --dump d.exr -o d.png"));
    assert_true(image_read_exr("d.exr", &exr, error));
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        channel(&exr, names[i], W, H);
    channel(&exr, "axial1.C", W / 2, H / 2);
    channel(&exr, "axial2.D", W / 4, H / 4);
    const float *mask = channel(&exr, "mask.V", W, H), *depth = channel(&exr, "depth.Z", W, H);
    const float *ao = channel(&exr, "ao.V", W, H), *x = channel(&exr, "tangent.X", W, H);
    const float *y = channel(&exr, "tangent.Y", W, H), *z = channel(&exr, "tangent.Z", W, H);
    for (uint32_t i = 0; i < W * H; i++) {
        assert_true(mask[i] == 0 || mask[i] == 1);
        if (mask[i] == 0)
            continue;
        covered++;
        assert_float_equal(x[i] * x[i] + y[i] * y[i] + z[i] * z[i], 1, 2e-3);
        assert_true(depth[i] >= 0 && depth[i] <= 1);
        assert_true(ao[i] >= 0 && isfinite(ao[i]));
    }
    assert_true(covered > 100 && covered < W * H - 100);
    /* the part "out" is the picture, top row first */
    const float *out = channel(&exr, "out.R", 96, 64);
    uint8_t *pixels;
    assert_true(image_read_png("d.png", 3, &width, &height, &pixels, NULL));
    for (uint32_t i = 0; i < 96 * 64; i++)
        assert_float_equal(out[i] * 255, pixels[3 * (size_t)i], 1e-3);
    free(pixels);
    check_attribute(&exr);
    image_exr_free(&exr);
    expect_ok(RUN("render " PLAIN "--dump d1.exr"));
    assert_true(image_read_exr("d1.exr", &exr, error));
    assert_int_equal(exr.part_count, 1); /* all of one size */
    channel(&exr, "out.G", 96, 64);
    image_exr_free(&exr);
}

static void check_compare(program_run run) {
    assert_string_equal(run.err, "");
    assert_int_equal(run.code, 0);
    cJSON *json = cJSON_Parse(run.out), *images = cJSON_GetObjectItem(json, "images");
    assert_true(cJSON_IsTrue(cJSON_GetObjectItem(json, "equal")));
    assert_true(cJSON_GetArraySize(images) >= 10);
    assert_string_equal(cJSON_GetObjectItem(images->child, "name")->valuestring, "out");
    for (const cJSON *image = images->child; image; image = image->next)
        assert_true(number(image, "differing_bits") == 0 && number(image, "differing_texels") == 0);
    cJSON_Delete(json);
    program_free(&run);
}

static void test_compare(void **state) {
    uint32_t width, height;
    uint8_t *pixels;
    (void)state;
    check_compare(RUN("compare " SMALL "-o sheet.png --json"));
    assert_true(image_read_png("sheet.png", 3, &width, &height, &pixels, NULL));
    assert_true(width > 3 * 96 && height > 10 * 64);
    free(pixels);
    check_compare(RUN("compare --scene stress --size 96x64 --json"));
    program_run run = RUN("compare " PLAIN "--preset classic");
    assert_int_equal(run.code, 0);
    assert_int_equal(strncmp(run.out, "image ", 6), 0);
    program_free(&run);
}

static void test_both_backends(void **state) {
    (void)state;
    expect_ok(RUN("render " SMALL "--scene crossing -o gl.png"));
    expect_ok(RUN("render " SMALL "--scene crossing --backend vk -o vk.png"));
    char *a = read_text("gl.png"), *b = read_text("vk.png");
    struct stat x, y;
    assert_int_equal(stat("gl.png", &x) | stat("vk.png", &y), 0);
    assert_true(x.st_size == y.st_size && x.st_size < 1 << 16);
    assert_memory_equal(a, b, (size_t)x.st_size);
    free(a);
    free(b);
}

static void test_real_file(void **state) {
    char path[1024];
    const char *data = getenv("LINEAO_DATA");
    (void)state;
    snprintf(path, sizeof path, "%s/lines/example.trk", data ? data : "");
    if (access(path, R_OK) != 0) {
        print_message("LINEAO_DATA has no lines/example.trk; not tested\n");
        skip();
    }
    expect_ok(RUN("render %s --size 96x64 --occlusion off -o real.png", path));
}

/* Runs last: all of this made no other files than those asked for. */
static void test_nothing_left(void **state) {
    DIR *folder = opendir(".");
    (void)state;
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder)) != NULL;)
        assert_null(strstr(entry->d_name, ".tmp"));
    closedir(folder);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_help),           cmocka_unit_test(test_wrong_usage),
        cmocka_unit_test(test_failures),       cmocka_unit_test(test_odd_sizes),
        cmocka_unit_test(test_no_folder),      cmocka_unit_test(test_interrupt),
        cmocka_unit_test(test_info),           cmocka_unit_test(test_info_tree),
        cmocka_unit_test(test_info_mesh),      cmocka_unit_test(test_flags),
        cmocka_unit_test(test_flags_of_files), cmocka_unit_test(test_camera),
        cmocka_unit_test(test_sequence),       cmocka_unit_test(test_times),
        cmocka_unit_test(test_videos),         cmocka_unit_test(test_timings),
        cmocka_unit_test(test_dump),           cmocka_unit_test(test_dump_of_directions),
        cmocka_unit_test(test_compare),        cmocka_unit_test(test_both_backends),
        cmocka_unit_test(test_real_file),      cmocka_unit_test(test_nothing_left),
    };
    if (argc < 2)
        return 2;
    program = argv[1];
    mkdir("cli", 0700); /* a folder of its own: other tests run beside */
    return chdir("cli") == 0 ? cmocka_run_group_tests(tests, NULL, NULL) : 2;
}
