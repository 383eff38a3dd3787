/* Images come back from PNG and OpenEXR files as they went in, bit by bit; a failure names the
 * file and leaves nothing behind. */
#include "image.h"

#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

enum { PATH_SIZE = 256 };

static int make_folder(void **state) {
    char *folder = malloc(PATH_SIZE);
    assert_non_null(folder);
    strcpy(folder, "/tmp/lineao-image-XXXXXX");
    *state = folder;
    return mkdtemp(folder) ? 0 : -1;
}

static int count_files(const char *folder) {
    int count = 0;
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    for (struct dirent *entry; (entry = readdir(dir)) != NULL;)
        count += entry->d_name[0] != '.';
    closedir(dir);
    return count;
}

static int remove_folder(void **state) {
    char *folder = *state;
    int left = count_files(folder);
    rmdir(folder);
    free(folder);
    return left; /* a test that leaves a file behind fails */
}

static void path_in(char path[PATH_SIZE], const char *folder, const char *name) {
    snprintf(path, PATH_SIZE, "%s/%s", folder, name);
}

static void png_round_trip(void **state) {
    char path[PATH_SIZE], error[IMAGE_ERROR_SIZE] = "";
    path_in(path, *state, "Bild \xC3\xA4\xE2\x82\xAC.png"); /* a name outside ASCII */
    enum { W = 37, H = 11 };
    for (int channels = 3; channels <= 4; channels++) {
        uint8_t pixels[W * H * 4];
        for (int i = 0; i < W * H * channels; i++)
            pixels[i] = (uint8_t)(i * 7 + i / 64);
        assert_true(image_write_png(path, W, H, pixels, channels, error));
        uint32_t width = 0, height = 0;
        uint8_t *back = NULL;
        assert_true(image_read_png(path, channels, &width, &height, &back, error));
        assert_int_equal(width, W);
        assert_int_equal(height, H);
        assert_memory_equal(back, pixels, (size_t)(W * H * channels));
        free(back);
    }
    assert_int_equal(count_files(*state), 1);
    remove(path);
}

static void exr_single_part(void **state) {
    char path[PATH_SIZE], error[IMAGE_ERROR_SIZE] = "";
    path_in(path, *state, "\xC3\xBC.exr");
    enum { W = 70, H = 33 }; /* more than two blocks of 16 lines */
    static float red[W * H], green[W * H];
    for (int i = 0; i < W * H; i++) {
        red[i] = (float)i * 0.37f - 100.0f;
        green[i] = i % 5 ? 1e-42f : (float)NAN;
    }
    green[1] = (float)INFINITY;
    green[2] = -0.0f;
    const image_channel channels[2] = {{"color.R", red}, {"color.G", green}};
    const image_part part = {NULL, W, H, 2, channels};
    assert_true(image_write_exr(path, &part, 1, NULL, error));

    image_exr image;
    assert_true(image_read_exr(path, &image, error));
    assert_int_equal(image.part_count, 1);
    assert_null(image.attribute);
    assert_string_equal(image.parts[0].name, "");
    assert_int_equal(image.parts[0].width, W);
    assert_int_equal(image.parts[0].height, H);
    assert_string_equal(image.parts[0].channels[0].name, "color.G"); /* sorted */
    assert_memory_equal(image_exr_channel(&image, "color.R", NULL), red, sizeof red);
    assert_memory_equal(image_exr_channel(&image, "color.G", NULL), green, sizeof green);
    assert_null(image_exr_channel(&image, "color.B", NULL));
    image_exr_free(&image);

    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    unsigned char head[8] = {0};
    assert_int_equal(fread(head, 1, 8, file), 8);
    fclose(file);
    assert_int_equal(head[5] & 0x10, 0); /* bit 12 of the version: not multi-part */
    assert_int_equal(count_files(*state), 1);
    remove(path);
}

static void exr_many_parts(void **state) {
    char path[PATH_SIZE], error[IMAGE_ERROR_SIZE] = "", names[6][16], json[5000];
    path_in(path, *state, "parts.exr");
    memset(json, 'x', sizeof json);
    memcpy(json, "{\"camera\":\"\xC3\xA4", 13);
    json[sizeof json - 1] = 0;

    image_part parts[6];
    image_channel channels[6][3];
    float *data[6];
    for (uint32_t p = 0; p < 6; p++) { /* a pyramid: each part its own size, 1 x 1 at last */
        uint32_t width = 41u >> p, height = 32u >> p;
        snprintf(names[p], sizeof names[p], "axial%u", (unsigned)p);
        data[p] = malloc(sizeof(float) * width * height * 3);
        assert_non_null(data[p]);
        for (uint32_t i = 0; i < width * height * 3; i++)
            data[p][i] = (float)(i * (p + 1));
        const char *const letters[3] = {"S", "C", "D"};
        for (uint32_t c = 0; c < 3; c++) {
            channels[p][c].name = letters[c];
            channels[p][c].data = data[p] + c * width * height;
        }
        const image_part part = {names[p], width, height, 3, channels[p]};
        parts[p] = part;
    }
    assert_true(image_write_exr(path, parts, 6, json, error));

    image_exr image;
    assert_true(image_read_exr(path, &image, error));
    assert_int_equal(image.part_count, 6);
    assert_string_equal(image.attribute, json);
    for (uint32_t p = 0; p < 6; p++) {
        const image_part *part = &image.parts[p];
        assert_string_equal(part->name, names[p]);
        assert_int_equal(part->width, parts[p].width);
        assert_int_equal(part->height, parts[p].height);
        for (uint32_t c = 0; c < 3; c++) {
            const char *const sorted[3] = {"C", "D", "S"};
            const uint32_t ours = c == 0 ? 1 : c == 1 ? 2 : 0;
            assert_string_equal(part->channels[c].name, sorted[c]);
            assert_memory_equal(part->channels[c].data, channels[p][ours].data,
                                sizeof(float) * part->width * part->height);
        }
        free(data[p]);
    }
    image_exr_free(&image);
    assert_int_equal(count_files(*state), 1);
    remove(path);
}

static void failures_name_the_file(void **state) {
    char path[PATH_SIZE], error[IMAGE_ERROR_SIZE];
    const uint8_t pixel[4] = {1, 2, 3, 4};
    const float value = 1.0f;
    const image_channel twice[2] = {{"a", &value}, {"a", &value}};
    const image_part part = {NULL, 1, 1, 1, twice}, doubled = {NULL, 1, 1, 2, twice};
    image_exr image;
    uint32_t width, height;
    uint8_t *pixels;

    const char *const bad[2] = {"absent/a.out", "folder"}; /* no such folder; it is a folder */
    path_in(path, *state, "folder");
    assert_int_equal(mkdir(path, 0777), 0);
    for (int i = 0; i < 2; i++) {
        path_in(path, *state, bad[i]);
        assert_false(image_write_png(path, 1, 1, pixel, 4, error));
        assert_memory_equal(error, path, strlen(path));
        assert_false(image_write_exr(path, &part, 1, NULL, error));
        assert_memory_equal(error, path, strlen(path));
        assert_false(image_read_png(path, 4, &width, &height, &pixels, error));
        assert_memory_equal(error, path, strlen(path));
        assert_false(image_read_exr(path, &image, error));
        assert_memory_equal(error, path, strlen(path));
        assert_false(image_write_png(path, 1, 1, pixel, 4, NULL));
    }
    path_in(path, *state, "folder");
    rmdir(path);

    path_in(path, *state, "never");
    assert_false(image_write_png(path, 0, 1, pixel, 4, error));
    assert_false(image_write_png(path, 1, 1, pixel, 2, error));
    assert_false(image_write_exr(path, &doubled, 1, NULL, error)); /* the same channel twice */
    assert_false(image_write_exr(path, &part, 0, NULL, error));
    assert_int_equal(count_files(*state), 0);
}

static void a_failure_keeps_the_old_file(void **state) {
    char path[PATH_SIZE], error[IMAGE_ERROR_SIZE];
    path_in(path, *state, "kept.png");
    const uint8_t pixel[4] = {1, 2, 3, 4};
    assert_true(image_write_png(path, 1, 1, pixel, 4, error));
    assert_false(image_write_png(path, 0, 1, pixel, 4, error));
    uint32_t width, height;
    uint8_t *back = NULL;
    assert_true(image_read_png(path, 4, &width, &height, &back, error));
    assert_memory_equal(back, pixel, 4);
    free(back);
    assert_int_equal(count_files(*state), 1);
    remove(path);
}

static void broken_files_are_errors(void **state) {
    char path[PATH_SIZE], error[IMAGE_ERROR_SIZE] = "";
    path_in(path, *state, "cut.exr");
    enum { W = 16, H = 40 };
    static float data[W * H];
    for (int i = 0; i < W * H; i++)
        data[i] = (float)(i * i % 977);
    const image_channel channel = {"V", data};
    const image_part part = {"ao", W, H, 1, &channel};
    assert_true(image_write_exr(path, &part, 1, "{}", error));
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    for (long size = (long)info.st_size - 1; size >= 0; size -= 13) {
        assert_int_equal(truncate(path, size), 0);
        image_exr image;
        error[0] = 0;
        assert_false(image_read_exr(path, &image, error));
        assert_memory_equal(error, path, strlen(path));
    }
    remove(path);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, make_folder, remove_folder)
    const struct CMUnitTest tests[] = {
        TEST(png_round_trip),
        TEST(exr_single_part),
        TEST(exr_many_parts),
        TEST(failures_name_the_file),
        TEST(a_failure_keeps_the_old_file),
        TEST(broken_files_are_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
