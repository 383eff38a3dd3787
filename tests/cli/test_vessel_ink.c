/* `lineao vessel` draws surfaces by the passes of trees, embedded ones and files, shows the middle
 * of a picture with a margin, and the last picture of a sequence alone; what wants a tree is
 * refused.
 */
#include "program.h"

#include "image.h"

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
#define SMALL "--size 48x36 --ssaa 1 "
#define INK SMALL "--set parameterization=on --set style=hatch "

static void expect(program_run run, int code, const char *word) {
    if (run.code != code || !strstr(code ? run.err : run.out, word))
        print_error("expected %d and '%s', got %d: %s%s", code, word, run.code, run.err, run.out);
    assert_int_equal(run.code, code);
    assert_non_null(strstr(code ? run.err : run.out, word));
    assert_true(code == 0 || program_lines(run.err) == 1);
    program_free(&run);
}

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* RGBA; how many of its pixels are dark. */
static uint32_t dark(const char *path, uint32_t wanted_width, uint32_t wanted_height) {
    char error[IMAGE_ERROR_SIZE];
    uint32_t width, height, count = 0;
    uint8_t *pixels = NULL;
    assert_true(image_read_png(path, 4, &width, &height, &pixels, error));
    assert_int_equal(width, wanted_width);
    assert_int_equal(height, wanted_height);
    for (uint32_t i = 0; i < width * height; i++)
        count += pixels[4 * i] < 128;
    free(pixels);
    return count;
}

static void surfaces(void **state) {
    (void)state;
    expect(RUN("vessel --surface liver " INK "--set ssp_period=20 -o a.png --json"), 0,
           "\"triangles\"");
    assert_true(dark("a.png", 48, 36) > 50);
    write_file("t.obj", "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    expect(RUN("vessel t.obj --unit mm " SMALL "-o t.png --dump t.exr --json"), 0, "\"vertices\":");
    assert_true(dark("t.png", 48, 36) > 0);
    expect(RUN("vessel t.obj --unit mm --layout l.svg"), 1, "surface");
    expect(RUN("vessel t.obj --unit mm " SMALL "--set style=pattern -o m.png"), 1, "--pattern");
    expect(RUN("vessel t.obj --unit mm " SMALL "--pattern t.obj -o m.png"), 1, "t.obj");
    expect(RUN("vessel --surface moon -o m.png"), 1, "moon");
    expect(RUN("vessel --surface liver --target 1,2,3,4 -o m.png"), 1, "tree");
    assert_int_not_equal(access("m.png", F_OK), 0);
}

/* The middle of a larger picture; the pictures of a sequence up to one of them. */
static void sequences(void **state) {
    (void)state;
    write_file("cams.json",
               "[{\"eye\":[0,-300,60],\"center\":[0,0,0],\"up\":[0,0,1],\"fovy\":30},"
               "{\"eye\":[9,-300,60],\"center\":[0,0,0],\"up\":[0,0,1],\"fovy\":30},"
               "{\"eye\":[18,-300,60],\"center\":[0,0,0],\"up\":[0,0,1],\"fovy\":30}]");
    expect(RUN("vessel --surface liver " SMALL "--cameras cams.json --frames 2 -o f_%%04d.png"), 0,
           "");
    assert_int_equal(access("f_0001.png", F_OK), 0);
    assert_int_not_equal(access("f_0002.png", F_OK), 0);
    expect(RUN("vessel --surface liver " SMALL "--cameras cams.json --frames 2 --last -o last.png"),
           0, "");
    assert_int_equal(dark("last.png", 48, 36), dark("f_0001.png", 48, 36));
    expect(
        RUN("vessel --surface liver " SMALL "--cameras cams.json --frames 1 --last -o whole.png"),
        0, "");
    expect(RUN("vessel --surface liver " SMALL "--cameras cams.json --frames 1 --last --margin 8 "
               "-o middle.png"),
           0, "");
    uint32_t whole = dark("whole.png", 48, 36), middle = dark("middle.png", 48, 36);
    assert_true(whole > 0 && middle + 3 > whole && whole + 3 > middle);
}

static int enter(void **state) {
    char folder[] = "/tmp/lineao_ink_XXXXXX";
    (void)state;
    assert_non_null(mkdtemp(folder));
    return chdir(folder);
}

static int leave(void **state) {
    (void)state;
    return system("rm -f -- *.png *.exr *.json *.obj") != 0;
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces),
        cmocka_unit_test(sequences),
    };
    if (argc < 2)
        return 1;
    program = argv[1];
    return cmocka_run_group_tests(tests, enter, leave);
}
