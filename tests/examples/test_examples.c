/* Proves that the examples do what they teach: hello_gl and hello_vk fit on a page and write the
 * same picture; in host_depth lines and triangles hide each other, for each camera convention, and
 * both backends give the same picture.
 *
 *     test_examples HELLO_GL HELLO_VK HOST_DEPTH */
#include "image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include <cmocka.h>

static const char *hello[2], *host_depth;

/* Runs a program; its errors go to the test's own. Returns its exit code. */
static int run(const char *program, const char *arguments) {
    char command[2048];
    int length = snprintf(command, sizeof command, "'%s' %s", program, arguments);
    assert_in_range(length, 1, sizeof command - 1);
    int status = system(command); /* NOLINT: the test's own programs */
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/* A whole file; for free(). */
static char *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *data = (char *)malloc(*size + 1);
    assert_non_null(data);
    assert_int_equal(fread(data, 1, *size, file), *size);
    data[*size] = 0;
    fclose(file);
    return data;
}

static void test_length(void **state) {
    static const char *const paths[] = {LINEAO_SOURCE_DIR "/examples/hello_gl.c",
                                        LINEAO_SOURCE_DIR "/examples/hello_vk.c"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        size_t size, lines = 0;
        char *text = read_file(paths[i], &size);
        for (size_t k = 0; k < size; k++)
            lines += text[k] == '\n';
        free(text);
        assert_in_range(lines, 1, 149);
    }
}

static void test_hello(void **state) {
    static const char *const paths[2] = {"hello_gl.ppm", "hello_vk.ppm"};
    size_t size[2], shades = 0;
    char *data[2], seen[256] = {0};
    (void)state;
    for (int i = 0; i < 2; i++) {
        remove(paths[i]);
        assert_int_equal(run(hello[i], paths[i]), 0);
    }
    for (int i = 0; i < 2; i++)
        data[i] = read_file(paths[i], &size[i]);
    assert_int_equal(size[0], strlen("P6 640 480 255\n") + (size_t)640 * 480 * 3);
    assert_int_equal(strncmp(data[0], "P6 640 480 255\n", 15), 0);
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(data[0], data[1], size[0]);
    for (size_t i = 15; i < size[0]; i += 3)
        seen[(unsigned char)data[0][i]] = 1;
    for (int i = 0; i < 256; i++)
        shades += (size_t)seen[i];
    assert_in_range(shades, 100, 256); /* lines, light and shadow: no flat picture */
    for (int i = 0; i < 2; i++) {
        free(data[i]);
    }
    assert_int_not_equal(run(hello[0], "/nonexistent/hello.ppm 2>/dev/null"), 0);
}

/* ----------------------------------------------------------------------------------- host_depth */

typedef struct picture {
    uint32_t width, height;
    uint8_t *pixels;
} picture;

static picture render(const char *backend, const char *flags, const char *path) {
    char arguments[256], error[IMAGE_ERROR_SIZE];
    picture p;
    snprintf(arguments, sizeof arguments, "--backend %s %s %s", backend, flags, path);
    assert_int_equal(run(host_depth, arguments), 0);
    if (!image_read_png(path, 3, &p.width, &p.height, &p.pixels, error))
        fail_msg("%s", error);
    return p;
}

/* What a pixel shows, by its hue: the host's objects are flat, so their colour is exact. */
static char seen_at(const picture *p, int x, int y) {
    const uint8_t *c = p->pixels + 3 * ((size_t)y * p->width + (size_t)x);
    if (c[2] > c[1] + 15 && c[1] > c[0] + 10)
        return 'L'; /* lines: blue */
    if (c[0] > 2 * c[2] - 20 && c[1] < c[0] * 6 / 10)
        return 'R'; /* red box */
    if (c[0] > 3 * c[2] / 2 && c[1] > c[0] * 7 / 10)
        return 'Y'; /* yellow box */
    if (c[1] > c[0] + 20 && c[1] > c[2] + 20)
        return 'G';                           /* green box, drawn after the lines */
    return abs(c[0] - c[2]) < 12 ? '.' : '?'; /* ground and background */
}

typedef struct place {
    int x, y;
    char expected;
    const char *what;
} place;

static const place perspective[] = {
    {330, 310, 'L', "the front bundle hides the yellow box"},
    {300, 265, 'Y', "the yellow box, above the front bundle"},
    {300, 347, 'Y', "the yellow box, below the front bundle"},
    {260, 180, 'R', "the red box hides the bundle behind it"},
    {400, 186, 'L', "the bundle behind, beside the red box"},
    {170, 155, 'L', "the bundle behind, on the other side"},
    {190, 260, 'L', "the third bundle, outside of the red box"},
    {300, 205, 'R', "the third bundle, inside of the red box"},
    {480, 270, 'G', "the late box, above the front bundle"},
    {480, 335, 'L', "the front bundle hides the late box"},
    {470, 380, 'G', "the late box, below the front bundle"},
    {500, 195, 'G', "the late box hides the bundle behind it"},
    {600, 215, 'L', "the bundle behind, beside the late box"},
    {100, 350, '.', "the ground"},
    {20, 20, '.', "the host's background"},
};

static const place orthographic[] = {
    {310, 300, 'L', "the front bundle hides the yellow box"},
    {300, 260, 'Y', "the yellow box, above the front bundle"},
    {300, 347, 'Y', "the yellow box, below the front bundle"},
    {260, 180, 'R', "the red box hides the bundle behind it"},
    {390, 170, 'L', "the bundle behind, beside the red box"},
    {120, 125, 'L', "the bundle behind, on the other side"},
    {213, 232, 'L', "the third bundle, outside of the red box"},
    {270, 190, 'R', "the third bundle, inside of the red box"},
    {460, 260, 'G', "the late box, above the front bundle"},
    {460, 320, 'L', "the front bundle hides the late box"},
    {450, 360, 'G', "the late box, below the front bundle"},
    {500, 195, 'G', "the late box hides the bundle behind it"},
    {610, 205, 'L', "the bundle behind, beside the late box"},
    {100, 330, '.', "the ground"},
    {20, 20, '.', "the host's background"},
};

static void check_places(const picture *p, const char *name, bool ortho) {
    const place *places = ortho ? orthographic : perspective;
    size_t count =
        ortho ? sizeof orthographic / sizeof *places : sizeof perspective / sizeof *places;
    for (size_t i = 0; i < count; i++) {
        char seen = seen_at(p, places[i].x, places[i].y);
        if (seen != places[i].expected)
            fail_msg("%s: %s: '%c' instead of '%c' at %d, %d", name, places[i].what, seen,
                     places[i].expected, places[i].x, places[i].y);
    }
}

static size_t different_pixels(const picture *a, const picture *b) {
    size_t count = 0;
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    for (size_t i = 0; i < (size_t)a->width * a->height; i++)
        count += memcmp(a->pixels + 3 * i, b->pixels + 3 * i, 3) != 0;
    return count;
}

/* Every convention shows the same scene, and both backends agree on it to the last pixel; Vulkan's
 * validation has nothing to say. OpenGL's own clip depth, -w .. w, may differ where surfaces meet.
 */
static void check_conventions(bool ortho) {
    static const char *const depths[] = {"--depth normal", "--depth reverse", "--depth gl"};
    picture first = {0, 0, NULL};
    for (int i = 0; i < 3; i++) {
        char flags[64];
        snprintf(flags, sizeof flags, "%s %s", depths[i], ortho ? "--ortho" : "");
        picture gl = render("gl", flags, "host_depth_gl.png");
        check_places(&gl, flags, ortho);
        if (i < 2) {
            setenv("HOST_DEPTH_VALIDATION", "1", 1);
            picture vk = render("vk", flags, "host_depth_vk.png");
            unsetenv("HOST_DEPTH_VALIDATION");
            check_places(&vk, flags, ortho);
            assert_int_equal(different_pixels(&gl, &vk), 0);
            free(vk.pixels);
        }
        if (i == 0) {
            first = gl;
        } else {
            assert_in_range(different_pixels(&first, &gl), 0, 20);
            free(gl.pixels);
        }
    }
    free(first.pixels);
}

static void test_perspective(void **state) {
    (void)state;
    check_conventions(false);
}

static void test_orthographic(void **state) {
    (void)state;
    check_conventions(true);
}

/* Without LAO_HOST_WRITABLE our depth stays with us, and the late box covers the lines. */
static void test_read_only(void **state) {
    (void)state;
    picture gl = render("gl", "--read-only", "host_depth_gl.png");
    picture vk = render("vk", "--read-only", "host_depth_vk.png");
    assert_int_equal(seen_at(&gl, 480, 335), 'G');
    assert_int_equal(seen_at(&gl, 330, 310), 'L');
    assert_int_equal(different_pixels(&gl, &vk), 0);
    free(gl.pixels);
    free(vk.pixels);
}

static void test_usage(void **state) {
    static const char *const wrong[] = {"",
                                        "--backend",
                                        "--backend metal a.png",
                                        "--depth x a.png",
                                        "--backend vk --depth gl a.png",
                                        "a.png b.png"};
    char arguments[256];
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snprintf(arguments, sizeof arguments, "%s 2>/dev/null", wrong[i]);
        assert_int_equal(run(host_depth, arguments), 2);
    }
}

int main(int count, char **arguments) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_length),      cmocka_unit_test(test_hello),
        cmocka_unit_test(test_perspective), cmocka_unit_test(test_orthographic),
        cmocka_unit_test(test_read_only),   cmocka_unit_test(test_usage),
    };
    if (count != 4)
        return 2;
    hello[0] = arguments[1];
    hello[1] = arguments[2];
    host_depth = arguments[3];
    /* a dozen programs compile the same shaders: they share a cache of this test's own */
    setenv("MESA_SHADER_CACHE_DISABLE", "false", 1);
    setenv("MESA_SHADER_CACHE_DIR", "test_examples.cache", 1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
