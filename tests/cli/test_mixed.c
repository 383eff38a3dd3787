/* `lineao render` draws lines, trees, surfaces and volumes in one picture: what is in front hides
 * what is behind whatever module drew it, on both backends to the bit; a file alone looks as its
 * own command draws it; flags bind to their FILE; a dump has the images of all modules. */
#include "program.h"

#include "image.h"

#include <cJSON.h>
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

/* From +z at the origin, two pixels for each mm. */
enum { SIZE = 120, RADIUS = 8, WALL = 14 };
#define VIEW "--camera above.json --size 120x120 --ssaa 1 --occlusion off --parameterization off "
#define LINE "line.obj --color #ff0000 --width 2 --halo none "
#define BALL "ball.swc --unit mm --color #2040ff "

static void expect_ok(program_run run) {
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    program_free(&run);
}

/* ---- files -------------------------------------------------------------------------------- */

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* A sphere around the origin, 2 * 24 triangles at its poles and 2 * 24 * 14 between. */
static void write_wall(void) {
    enum { AROUND = 24, UP = 16 };
    FILE *file = fopen("wall.obj", "wb");
    assert_non_null(file);
    for (int i = 1; i < UP; i++) {
        for (int j = 0; j < AROUND; j++) {
            double t = 3.14159265358979 * i / UP, p = 6.28318530717959 * j / AROUND;
            fprintf(file, "v %.9g %.9g %.9g\n", WALL * sin(t) * cos(p), WALL * sin(t) * sin(p),
                    WALL * cos(t));
        }
    }
    int top = AROUND * (UP - 1) + 1;
    fprintf(file, "v 0 0 %d\nv 0 0 %d\n", WALL, -WALL);
    for (int j = 0; j < AROUND; j++) {
        int k = (j + 1) % AROUND, last = AROUND * (UP - 2);
        fprintf(file, "f %d %d %d\nf %d %d %d\n", top, j + 1, k + 1, top + 1, last + k + 1,
                last + j + 1);
        for (int i = 0; i + 2 < UP; i++) {
            int a = AROUND * i + j + 1, b = AROUND * i + k + 1;
            fprintf(file, "f %d %d %d %d\n", a, a + AROUND, b + AROUND, b);
        }
    }
    assert_int_equal(fclose(file), 0);
}

/* Blood that flows along x through a box of 15 mm, to the right of everything else. */
static void write_volume(void) {
    FILE *file = fopen("flow.vtk", "wb");
    assert_non_null(file);
    fputs("# vtk DataFile Version 3.0\nflow\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 6 6 6\n"
          "ORIGIN 20 -8 -8\nSPACING 3 3 3\nPOINT_DATA 216\nVECTORS velocity float\n",
          file);
    for (int i = 0; i < 216; i++)
        fputs("0.1 0 0\n", file);
    assert_int_equal(fclose(file), 0);
}

/* A line through a ball and the sphere around it, from behind on the left to the front on the
 * right: z = x. */
static int write_files(void **state) {
    (void)state;
    write_file("above.json", "{\"eye\":[0,0,100],\"center\":[0,0,0],\"up\":[0,1,0],"
                             "\"ortho_height\":60}");
    write_file("line.obj", "v -20 0 -20\nv 0 0 0\nv 20 0 20\nl 1 2 3\n");
    write_file("ball.swc", "1 0 0 0 0 8 -1\n");
    write_file("twig.swc", "1 0 0 12 0 2 -1\n2 0 12 20 0 1 1\n");
    write_file("broken.swc", "1 0 0\n");
    write_file("centre.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n"
                             "POINTS 3 float\n-15 -8 0\n0 -10 0\n15 -8 0\nLINES 1 4\n3 0 1 2\n"
                             "POINT_DATA 3\nSCALARS radius float 1\nLOOKUP_TABLE default\n3 4 2\n");
    write_wall();
    write_volume();
    return 0;
}

/* ---- pictures ------------------------------------------------------------------------------ */

typedef struct shown {
    uint32_t width, height;
    uint8_t *pixels; /* RGB, top row first */
} shown;

static shown look(const char *path) {
    char error[IMAGE_ERROR_SIZE];
    shown s;
    assert_true(image_read_png(path, 3, &s.width, &s.height, &s.pixels, error));
    return s;
}

static void assert_same(const char *a, const char *b, bool same) {
    shown x = look(a), y = look(b);
    assert_int_equal(x.width, y.width);
    assert_int_equal(x.height, y.height);
    assert_int_equal(memcmp(x.pixels, y.pixels, (size_t)3 * x.width * x.height) == 0, same);
    free(x.pixels);
    free(y.pixels);
}

/* The pixel at x, y mm. */
static const uint8_t *at(const shown *s, double x, double y) {
    int column = SIZE / 2 + (int)floor(2 * x), row = SIZE / 2 - 1 - (int)floor(2 * y);
    return s->pixels + 3 * (size_t)(row * SIZE + column);
}

static bool is_red(const uint8_t *p) {
    return p[0] > p[2] + 40 && p[0] > p[1] + 40;
}

static bool is_blue(const uint8_t *p) {
    return p[2] > p[0] + 40;
}

/* The same picture from both backends. */
static void draw(const char *words, const char *out) {
    char other[64];
    snprintf(other, sizeof other, "vk_%s", out);
    expect_ok(RUN("render " VIEW "%s -o %s", words, out));
    expect_ok(RUN("render " VIEW "%s -o %s --backend vk", words, other));
    assert_same(out, other, true);
}

/* ---- tests --------------------------------------------------------------------------------- */

/* The line leaves the ball where x = z = 8 / sqrt(2), about 5.7. */
static void a_line_through_a_ball(void **state) {
    (void)state;
    draw(LINE BALL, "through.png");
    shown s = look("through.png");
    const double edge = RADIUS / sqrt(2.0);
    for (double x = -15; x < 15; x += 0.5) {
        const uint8_t *p = at(&s, x, 0);
        if (x < -RADIUS - 1.5 || x > edge + 1)
            assert_true(is_red(p));
        else if (x > -RADIUS + 1.5 && x < edge - 1)
            assert_true(is_blue(p));
    }
    assert_true(is_blue(at(&s, 0, 6)));
    free(s.pixels);
    draw(BALL LINE, "turned.png"); /* in whatever order */
    assert_same("through.png", "turned.png", true);
    draw("--shared-occlusion " BALL LINE, "shared.png");
    s = look("shared.png");
    assert_true(is_blue(at(&s, 0, 6)) && is_blue(at(&s, 2, 0)) && is_red(at(&s, 12, 0)));
    free(s.pixels);
}

/* Its back faces are opaque, its front faces let through what is inside. */
static void a_wall_around_both(void **state) {
    shown all, none, without;
    (void)state;
    draw(LINE BALL "wall.obj", "all.png");
    draw("wall.obj " BALL LINE, "first.png");
    draw(LINE BALL, "none.png");
    draw(BALL "wall.obj", "without.png");
    assert_same("all.png", "first.png", true);
    all = look("all.png");
    none = look("none.png");
    without = look("without.png");
    assert_memory_equal(at(&all, 12, 0), at(&none, 12, 0), 3);      /* before the wall */
    assert_memory_equal(at(&all, -11, 0), at(&without, -11, 0), 3); /* behind it */
    assert_true(is_red(at(&all, 7, 0)));                            /* inside, before the ball */
    assert_true(is_blue(at(&all, 2, 0)));                           /* in the ball */
    assert_true(memcmp(at(&all, 7, 0), at(&without, 7, 0), 3) != 0);
    assert_true(memcmp(at(&all, 2, 10), at(&none, 2, 10), 3) != 0); /* the wall itself */
    free(all.pixels);
    free(none.pixels);
    free(without.pixels);
}

static void alone_as_its_own_command(void **state) {
    (void)state;
    draw(BALL, "tree.png");
    expect_ok(RUN("vessel " VIEW BALL "-o own.png"));
    assert_same("tree.png", "own.png", true);
    draw("wall.obj", "wall.png");
    expect_ok(RUN("surface --camera above.json --size 120x120 --ssaa 1 wall.obj -o own.png"));
    assert_same("wall.png", "own.png", true);
}

/* Lines with a radius are lines, unless told. */
static void of_several_meanings(void **state) {
    (void)state;
    draw("centre.vtk --unit mm --as tree --color #2040ff", "centre_tree.png");
    expect_ok(RUN("vessel " VIEW "centre.vtk --unit mm --color #2040ff -o own.png"));
    assert_same("centre_tree.png", "own.png", true);
    expect_ok(RUN("render " VIEW "centre.vtk --color #2040ff -o centre.png"));
    expect_ok(RUN("render " VIEW "centre.vtk --as lines --color #2040ff -o lines.png"));
    assert_same("centre.png", "lines.png", true);
    assert_same("centre.png", "own.png", false);
    expect_fault(RUN("render wall.obj --as tree -o x.png"), 1, "not a vessel tree");
    expect_fault(RUN("render flow.vtk --as tree -o x.png"), 1, "velocity volume");
}

static cJSON *images_of(const cJSON *json) {
    return cJSON_GetObjectItem(json, "images");
}

/* Every image of the graph, of all kinds at once. */
static void all_kinds_in_every_image(void **state) {
    static const char *const names[] = {"color", "shaded", "vessel_position", "surface_over"};
    (void)state;
    program_run run = RUN("compare --size 96x72 --ssaa 1 --seeds 20 flow.vtk line.obj "
                          "ball.swc --unit mm wall.obj twig.swc --unit mm --json");
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    cJSON *json = cJSON_Parse(run.out);
    assert_true(cJSON_IsTrue(cJSON_GetObjectItem(json, "equal")));
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        bool found = false;
        const cJSON *image;
        cJSON_ArrayForEach(image, images_of(json)) found =
            found || strcmp(cJSON_GetObjectItem(image, "name")->valuestring, names[i]) == 0;
        assert_true(found);
    }
    cJSON_Delete(json);
    program_free(&run);
}

/* The values of a channel of a part. */
static const float *channel_of(const image_exr *image, const char *part, const char *name) {
    for (uint32_t i = 0; i < image->part_count; i++) {
        const image_part *p = &image->parts[i];
        for (uint32_t k = 0; strcmp(p->name, part) == 0 && k < p->channel_count; k++) {
            if (strcmp(p->channels[k].name, name) == 0)
                return p->channels[k].data;
        }
    }
    return NULL;
}

static double number(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItem(object, key);
    assert_true(cJSON_IsNumber(item));
    return item->valuedouble;
}

static void dumps_have_all_modules(void **state) {
    image_exr gl, vk;
    char error[IMAGE_ERROR_SIZE];
    (void)state;
    const char *words = VIEW LINE "twig.swc --unit mm --contour 0 " BALL "wall.obj";
    expect_ok(RUN("render %s --dump gl.exr", words));
    expect_ok(RUN("render %s --dump vk.exr --backend vk", words));
    assert_true(image_read_exr("gl.exr", &gl, error));
    assert_true(image_read_exr("vk.exr", &vk, error));
    assert_int_equal(gl.part_count, vk.part_count);
    for (uint32_t i = 0; i < gl.part_count; i++) {
        for (uint32_t k = 0; k < gl.parts[i].channel_count; k++)
            assert_memory_equal(gl.parts[i].channels[k].data, vk.parts[i].channels[k].data,
                                (size_t)gl.parts[i].width * gl.parts[i].height * sizeof(float));
    }
    const float *z = channel_of(&gl, "vessel", "position.Z"), *mask;
    size_t place = (size_t)(SIZE / 2 - 1) * SIZE + SIZE / 2 - 8; /* at -3.75, 0.25 mm */
    assert_non_null(z); /* that of the last tree: the ball */
    assert_true(fabs((double)z[place] - sqrt(64 - 3.75 * 3.75 - 0.0625)) < 1e-3);
    z = channel_of(&gl, "surface", "position.Z");
    mask = channel_of(&gl, "surface", "mask.V");
    assert_true(z && mask && mask[place] == 1 && z[place] > 12 && z[place] < WALL);
    mask = channel_of(&gl, "full", "mask.V"); /* of the lines, whatever hides them */
    assert_non_null(channel_of(&gl, "full", "out.R"));
    assert_true(mask && mask[place] == 1 && mask[place - 24] == 1 && mask[0] == 0);
    cJSON *json = cJSON_Parse(gl.attribute), *sets = cJSON_GetObjectItem(json, "sets");
    assert_int_equal(cJSON_GetArraySize(sets), 4);
    const cJSON *settings[4];
    for (int i = 0; i < 4; i++)
        settings[i] = cJSON_GetObjectItem(cJSON_GetArrayItem(sets, i), "settings");
    assert_true(number(settings[0], "width") == 2);
    assert_true(number(settings[1], "contour") == 0); /* the twig's own */
    assert_true(number(settings[2], "contour") > 0);
    assert_null(cJSON_GetObjectItem(settings[3], "contour"));
    assert_non_null(cJSON_GetObjectItem(settings[3], "brightness"));
    cJSON_Delete(json);
    image_exr_free(&gl);
    image_exr_free(&vk);
}

static void what_is_wrong(void **state) {
    struct stat status;
    (void)state;
    remove("bad.png");
    expect_fault(RUN("render " LINE "broken.swc wall.obj -o bad.png"), 1, "broken.swc: ");
    expect_fault(RUN("render line.obj --unit cm -o bad.png"), 1, "--unit");
    expect_fault(RUN("render wall.obj --color wss -o bad.png"), 1, "wss");
    expect_fault(RUN("render " BALL "line.obj --trail taper -o bad.png"), 1, "line.obj: trail");
    assert_int_not_equal(stat("bad.png", &status), 0);
}

/* A brain's arteries and tracts. */
static void real_data(void **state) {
    const char *data = getenv("LINEAO_DATA");
    char words[1024];
    (void)state;
    if (!data || access(data, R_OK) != 0) {
        print_message("LINEAO_DATA names no folder: no real data\n");
        skip();
    }
    snprintf(words, sizeof words,
             "--size 160x120 --ssaa 1 %s/trees/BG001.CNG.swc --unit mm %s/lines/example.trk", data,
             data);
    expect_ok(RUN("render %s -o gl.png", words));
    expect_ok(RUN("render %s -o vk.png --backend vk", words));
    assert_same("gl.png", "vk.png", true);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_through_a_ball),
        cmocka_unit_test(a_wall_around_both),
        cmocka_unit_test(alone_as_its_own_command),
        cmocka_unit_test(of_several_meanings),
        cmocka_unit_test(all_kinds_in_every_image),
        cmocka_unit_test(dumps_have_all_modules),
        cmocka_unit_test(what_is_wrong),
        cmocka_unit_test(real_data),
    };
    char folder[] = "mixed_XXXXXX", line[64];
    if (argc != 2 && argc != 3)
        return 2;
    program = argv[1];
    if (argc > 2) /* those of this name */
        cmocka_set_test_filter(argv[2]);
    if (!mkdtemp(folder) || chdir(folder) != 0)
        return 1;
    int failed = cmocka_run_group_tests(tests, write_files, NULL);
    snprintf(line, sizeof line, "cd .. && rm -rf '%s'", folder);
    return system(line) != 0 ? 1 : failed;
}
