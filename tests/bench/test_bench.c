/* lineao_bench measures every pass and frame on both backends beside floors of the same frames, and
 * tells it as one JSON object; what it refuses, it refuses in one line. */
#include "cli/program.h"

#include <cJSON.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *program; /* its path, from the command line */
static bool slow;           /* both presets; else the one whose shader compiles sooner */

static const cJSON *field(const cJSON *object, const char *name) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    if (!item)
        print_error("%s is missing\n", name);
    assert_non_null(item);
    return item;
}

static double number(const cJSON *object, const char *name) {
    const cJSON *item = field(object, name);
    if (!cJSON_IsNumber(item))
        print_error("%s is not a number\n", name);
    assert_true(cJSON_IsNumber(item));
    return item->valuedouble;
}

static void expect_times(const cJSON *row) {
    assert_true(number(row, "min") >= 0);
    assert_true(number(row, "median") >= number(row, "min"));
}

static const cJSON *pass_find(const cJSON *preset, const char *name) {
    const cJSON *row;
    cJSON_ArrayForEach(row, field(preset, "passes")) {
        const char *pass = cJSON_GetStringValue(field(row, "pass"));
        if (strcmp(pass, name) == 0 ||
            (strcmp(name, "lines") == 0 && strncmp(pass, "lines_", 6) == 0)) /* with a halo */
            return row;
    }
    return NULL;
}

/* A number, or null where noise hid it. */
static void expect_quotient(const cJSON *object, const char *name) {
    const cJSON *item = field(object, name);
    assert_true(cJSON_IsNull(item) || (cJSON_IsNumber(item) && item->valuedouble >= 0));
}

static void expect_preset(const cJSON *preset, bool floors) {
    static const char *const passes[] = {"lines",     "level_zero", "level_one", "level_up",
                                         "occlusion", "shade",      "resolve"};
    const cJSON *row;
    for (size_t i = 0; i < sizeof passes / sizeof *passes; i++)
        assert_non_null(pass_find(preset, passes[i]));
    cJSON_ArrayForEach(row, field(preset, "passes")) {
        number(row, "level");
        expect_times(row);
    }
    assert_int_equal(pass_find(preset, "floor_lines") != NULL, floors);
    assert_int_equal(pass_find(preset, "floor_taps") != NULL, floors);
    assert_true(number(preset, "first_frame_ms") > 0);
    expect_times(field(preset, "frame_ms"));
    expect_times(field(preset, "pass_sum_ms"));
    assert_int_equal(cJSON_IsNumber(field(preset, "lines_over_floor")), floors);
    expect_quotient(preset, "occlusion_over_floor");
    assert_int_equal(cJSON_IsNumber(field(preset, "occlusion_pass_over_floor_pass")), floors);
    field(preset, "occlusion_ns_per_covered_pixel");
    field(preset, "floor_ns_per_pixel");
    expect_times(field(field(preset, "background"), "frame_ms"));
    number(field(preset, "background"), "occlusion_ns_per_pixel");
    expect_quotient(field(preset, "background"), "occlusion_over_covered");
}

static void expect_quotients(const cJSON *object, const char *name) {
    assert_int_equal(cJSON_IsNumber(field(object, name)), slow);
}

static double expect_backend(const cJSON *backend, bool is_gl) {
    bool floors = cJSON_IsTrue(field(backend, "floors"));
    assert_true(floors || !is_gl); /* Vulkan: only with glslangValidator at build time */
    assert_true(strlen(cJSON_GetStringValue(field(backend, "device"))) > 0);
    expect_preset(field(field(backend, "presets"), "classic"), floors);
    if (slow)
        expect_preset(field(field(backend, "presets"), "default"), floors);
    expect_quotients(backend, "anisotropic_over_classic");
    assert_true(number(backend, "peak_mb") > 1);
    return number(backend, "covered_pixels");
}

static void test_json(void **state) {
    (void)state;
    program_run run =
        program_start(program, false, "--quick --json%s", slow ? "" : " --presets classic");
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    assert_string_equal(run.err, "");
    cJSON *document = cJSON_Parse(run.out);
    assert_non_null(document);
    assert_true(number(document, "frames") == 3);
    assert_true(cJSON_IsArray(field(document, "notes")));
    assert_true(cJSON_IsArray(field(document, "missed")));
    assert_true(number(field(document, "targets"), "occlusion_over_floor") == 1.5);
    const cJSON *scenes = field(document, "scenes");
    assert_int_equal(cJSON_GetArraySize(scenes), 1);
    const cJSON *scene = cJSON_GetArrayItem(scenes, 0);
    assert_string_equal(cJSON_GetStringValue(field(scene, "scene")), "bundle");
    assert_true(number(scene, "lines") == 1000);
    assert_true(number(scene, "points") == 100000);
    assert_true(number(scene, "width") == 214 && number(scene, "height") == 230);
    assert_true(number(scene, "supersampling") == 1);
    const cJSON *backends = field(scene, "backends");
    double covered = expect_backend(field(backends, "gl"), true);
    assert_true(covered > 0 && covered < 214 * 230);
    if (expect_backend(field(backends, "vk"), false) != covered)
        fail_msg("the backends cover different pixels");
    if (slow)
        assert_true(number(field(scene, "gl_over_vk"), "default") > 0);
    assert_true(number(field(scene, "gl_over_vk"), "classic") > 0);
    cJSON_Delete(document);
    program_free(&run);
}

static void test_table(void **state) {
    (void)state;
    program_run run = program_start(
        program, false, "--backend gl --presets classic --lines 20 --size 64x48@2 --frames 1");
    assert_int_equal(run.code, 0);
    assert_string_equal(run.err, "");
    assert_non_null(strstr(run.out, "bundle, 20 lines, 2000 points, 128x96 (supersampling 2)"));
    assert_non_null(strstr(run.out, "floor_taps"));
    assert_null(strstr(run.out, "vk"));
    program_free(&run);
}

static void test_export(void **state) {
    (void)state;
    program_run run =
        program_start(program, false, "--lines 7 --size 64x48 --export-lines bench_lines.raw");
    assert_int_equal(run.code, 0);
    program_free(&run);
    FILE *file = fopen("bench_lines.raw", "rb");
    assert_non_null(file);
    char mark[8];
    assert_int_equal(fread(mark, 1, sizeof mark, file), sizeof mark);
    assert_memory_equal(mark, "LAOBENCH", sizeof mark);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    assert_int_equal(ftell(file), 20 + 10 * 8 + 4 * 8 + 12 * 700);
    fclose(file);
    remove("bench_lines.raw");
}

/* Pathlines: every row has its numbers, and memory keeps its promise. */
static void test_flow(void **state) {
    (void)state;
    program_run run = program_start(program, false, "--flow --lines 300 --json");
    assert_int_equal(run.code, 0);
    assert_string_equal(run.err, "");
    cJSON *document = cJSON_Parse(run.out);
    const cJSON *rows = field(document, "flow"), *row;
    assert_int_equal(cJSON_GetArraySize(rows), 6);
    cJSON_ArrayForEach(row, rows) {
        assert_true(number(row, "lines") == 300);
        assert_true(number(row, "points") > 10000 && number(row, "seconds") > 0);
        assert_true(number(row, "points_per_second") > 1000);
        assert_true(number(row, "result_mb") > 20e-6 * number(row, "points"));
        assert_true(number(row, "peak_mb") <= 3 * number(row, "result_mb"));
    }
    cJSON_Delete(document);
    program_free(&run);
    run = program_start(program, false, "--flow --lines 10");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "function  rk4"));
    program_free(&run);
}

static void test_usage(void **state) {
    (void)state;
    static const char *const wrong[] = {
        "--lines",         "--lines 0",          "--lines 10x",   "--lines 1,2,3,4,5,6,7,8,9",
        "--size 10",       "--size 10x",         "--size 10x5@9", "--size 10x5@2x",
        "--backend metal", "--presets shiny",    "--frames 0",    "--frames 100",
        "--colour",        "--presets classic,", "more"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        program_run run = program_start(program, false, "%s", wrong[i]);
        if (run.code != 2 || program_lines(run.err) != 1)
            print_error("'%s' gave %d: %s", wrong[i], run.code, run.err);
        assert_int_equal(run.code, 2);
        assert_int_equal(program_lines(run.err), 1);
        assert_int_equal(strncmp(run.err, "lineao: ", 8), 0);
        assert_string_equal(run.out, "");
        program_free(&run);
    }
    program_run run = program_start(program, false, "--help");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "--export-lines"));
    program_free(&run);
}

static void test_table1(void **state) {
    (void)state;
    program_run run = program_start(
        program, false, "--table1 --backend gl --lines 60 --size 96x64 --frames 1 --json");
    assert_int_equal(run.code, 0);
    cJSON *document = cJSON_Parse(run.out);
    assert_non_null(document);
    const cJSON *gl = field(field(document, "table1"), "gl"), *row;
    int count = 0;
    cJSON_ArrayForEach(row, field(gl, "rows")) {
        expect_times(field(row, "frame_ms"));
        assert_true(number(row, "over_first") > 0);
        assert_true(number(row, "paper_over_first") > 0.3 && number(row, "paper_over_first") < 1.1);
        count++;
    }
    assert_int_equal(count, 8);
    assert_true(number(gl, "trail_over_full") > 0);
    assert_true(number(gl, "lines") == 60);
    cJSON_Delete(document);
    program_free(&run);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_json),   cmocka_unit_test(test_table),
                                       cmocka_unit_test(test_export), cmocka_unit_test(test_table1),
                                       cmocka_unit_test(test_flow),   cmocka_unit_test(test_usage)};
    if (argc < 2) {
        fprintf(stderr, "usage: test_bench path/to/lineao_bench [slow]\n");
        return 2;
    }
    program = argv[1];
    slow = argc > 2;
    /* contexts and processes of one benchmark compile the same shaders: with a cache, once */
    setenv("MESA_SHADER_CACHE_DISABLE", "false", 1);
    setenv("MESA_SHADER_CACHE_DIR", "bench_shader_cache", 1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
