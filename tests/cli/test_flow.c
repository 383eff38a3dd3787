/* lineao flow traces what it is given: lines of a turning fluid stay on their circles with the
 * right times and speeds, in every output format, on any number of threads, from volumes of every
 * kind; it says in one line what is missing and which flag gives it, and leaves whole files or
 * none. */
#include "program.h"

#include "image.h"
#include "volume_samples.h"

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
#include <unistd.h>

#include <cmocka.h>

static const char *program; /* its path, from the command line */

#define RUN(...) program_start(program, false, __VA_ARGS__)
#define SMALL "--size 96x64 --occlusion off --ssaa 1 "
#define SERIES "flow_0.vti flow_1.vti flow_2.vti flow_3.vti "

enum { SIDE = 21, HEIGHT = 5, FRAMES = 4 };
static const double turn = 0.005; /* rad/ms: 4 rad in a beat of 800 ms */

static cJSON *expect_json(program_run run) {
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    cJSON *json = cJSON_Parse(run.out);
    assert_non_null(json);
    assert_string_equal(run.err, "");
    program_free(&run);
    return json;
}

static void expect_ok(program_run run) {
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    assert_string_equal(run.err, "");
    assert_string_equal(run.out, "");
    program_free(&run);
}

static double number(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItem(object, key);
    assert_true(cJSON_IsNumber(item));
    return item->valuedouble;
}

static const char *text(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItem(object, key);
    assert_true(cJSON_IsString(item));
    return item->valuestring;
}

static void write_file(const char *path, const buffer *b) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fwrite(b->data, 1, b->size, file) == b->size);
    assert_int_equal(fclose(file), 0);
}

/* A fluid that turns around the z axis like a solid body, as ASCII VTI: linear in space, thus exact
 * between voxels. Its mask is a disk. */
static void write_turning(const char *path, const char *head) {
    buffer b = {NULL, 0, 0, false};
    put_format(&b,
               "<VTKFile type='ImageData'><ImageData WholeExtent='0 %d 0 %d 0 %d' Origin='-10 -10 "
               "-2' %s><Piece><PointData>\n<DataArray type='Float32' Name='flow' "
               "NumberOfComponents='3' format='ascii'>\n",
               SIDE - 1, SIDE - 1, HEIGHT - 1, head);
    for (int i = 0; i < SIDE * SIDE * HEIGHT; i++) {
        int x = i % SIDE - SIDE / 2, y = i / SIDE % SIDE - SIDE / 2;
        put_format(&b, "%.9g %.9g 0\n", -turn * y, turn * x);
    }
    put_text(&b, "</DataArray><DataArray type='UInt8' Name='disk' format='ascii'>\n");
    for (int i = 0; i < SIDE * SIDE * HEIGHT; i++) {
        int x = i % SIDE - SIDE / 2, y = i / SIDE % SIDE - SIDE / 2;
        put_text(&b, x * x + y * y <= 81 ? "1 " : "0 ");
    }
    put_text(&b, "</DataArray></PointData></Piece></ImageData></VTKFile>\n");
    write_file(path, &b);
    buffer_free(&b);
}

static int make_files(void **state) {
    static const char *const paths[FRAMES] = {"flow_0.vti", "flow_1.vti", "flow_2.vti",
                                              "flow_3.vti"};
    (void)state;
    for (int i = 0; i < FRAMES; i++)
        write_turning(paths[i], "Spacing='1 1 1'");
    write_turning("flow_bare.vti", "");
    return 0;
}

static int remove_files(void **state) {
    (void)state;
    DIR *folder = opendir(".");
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;)
        if (strncmp(entry->d_name, "flow_", 5) == 0)
            remove(entry->d_name);
    if (folder)
        closedir(folder);
    return 0;
}

static io_lines read_lines(const char *path) {
    io_lines lines;
    io_error error;
    if (!io_read_lines(path, NULL, &lines, &error))
        fail_msg("%s: %s", path, error.text);
    return lines;
}

static const float *attribute(const io_lines *lines, const char *name) {
    for (uint32_t i = 0; i < lines->point_attribute_count; i++)
        if (strcmp(lines->point_attributes[i].name, name) == 0)
            return lines->point_attributes[i].data;
    fail_msg("there is no attribute %s", name);
    return NULL;
}

/* ---- what is traced --------------------------------------------------------------------- */

/* Every point on the circle of its line, at the angle that its time tells. */
static void check_turning(const io_lines *lines, double step) {
    const float *times = attribute(lines, "time"), *speeds = attribute(lines, "speed");
    for (uint32_t line = 0; line < lines->line_count; line++) {
        uint32_t first = lines->offsets[line];
        double x0 = (double)lines->points[3 * first], y0 = (double)lines->points[3 * first + 1];
        double radius = hypot(x0, y0);
        for (uint32_t i = first; i < lines->offsets[line + 1]; i++) {
            double x = (double)lines->points[3 * i], y = (double)lines->points[3 * i + 1];
            double angle = turn * ((double)times[i] - (double)times[first]);
            assert_true(fabs(hypot(x, y) - radius) < 1e-4);
            assert_true(fabs(x - (x0 * cos(angle) - y0 * sin(angle))) < 1e-3);
            assert_true(fabs(lines->points[3 * i + 2] - lines->points[3 * first + 2]) < 1e-6f);
            assert_true(fabs((double)speeds[i] - turn * radius) < 1e-5);
            if (i > first)
                assert_true(fabs((double)(times[i] - times[i - 1]) - step) < 1e-3);
        }
    }
}

static void pathlines_keep_to_their_circles(void **state) {
    (void)state;
    cJSON *json = expect_json(RUN("flow " SERIES "--period 800 --names flow,disk --seeds 60 "
                                  "-o flow_a.vtp --json"));
    io_lines lines = read_lines("flow_a.vtp");
    assert_string_equal(text(json, "out"), "flow_a.vtp");
    assert_string_equal(text(json, "format"), "vti");
    assert_true(number(json, "lines") == lines.line_count);
    assert_true(number(json, "points") == lines.point_count);
    assert_true(number(json, "frames") == FRAMES && number(json, "period") == 800);
    assert_true(number(json, "mask_voxels") == 253 * HEIGHT);
    assert_true(number(json, "seconds") >= 0);
    assert_true(cJSON_IsFalse(cJSON_GetObjectItem(json, "streamlines")));
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 3; k++) {
            cJSON *corner = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "bbox"), side);
            assert_true(fabs(cJSON_GetArrayItem(corner, k)->valuedouble - lines.bounds[side][k]) <
                        1e-6);
        }
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "attributes")), 2);
    cJSON_Delete(json);
    assert_true(lines.line_count > 30 && lines.line_count <= 60);
    check_turning(&lines, 4); /* period / 200 */
    const float *times = attribute(&lines, "time");
    for (uint32_t i = 0; i < lines.point_count; i++) /* one beat */
        assert_true(times[i] >= -1e-3f && times[i] <= 800.001f);
    io_lines_free(&lines);
}

static void options_change_what_is_traced(void **state) {
    (void)state;
    static const struct {
        const char *flags;
        double step;
    } cases[] = {
        {"--method dopri --tolerance 1e-6 --step 8", 8},
        {"--streamlines --at 100 --step 2", 2},
        {"--span loop --step 10", 10},
        {"--span free --max-points 50 --step 5", 5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        expect_ok(RUN("flow " SERIES "--time-step 200 --mask disk --seeds 20 %s -o flow_b.vtp",
                      cases[i].flags));
        io_lines lines = read_lines("flow_b.vtp");
        assert_true(lines.line_count > 5);
        check_turning(&lines, cases[i].step);
        for (uint32_t k = 0; i == 3 && k < lines.line_count; k++)
            assert_true(lines.offsets[k + 1] - lines.offsets[k] <= 50);
        io_lines_free(&lines);
    }
    expect_ok(RUN("flow flow_0.vti --mask disk --seeds 20 --attributes all --min-length 3 "
                  "-o flow_b.vtp"));
    io_lines lines = read_lines("flow_b.vtp");
    const float *curvature = attribute(&lines, "curvature");
    const float *vorticity = attribute(&lines, "vorticity");
    for (uint32_t i = 0; i < lines.point_count; i++)
        assert_true(fabs((double)vorticity[i] - 2000 * turn) < 1e-2 && curvature[i] >= 0);
    for (uint32_t line = 0; line < lines.line_count; line++) {
        double length = 0;
        for (uint32_t i = lines.offsets[line] + 1; i < lines.offsets[line + 1]; i++) {
            const float *p = lines.points + 3 * (size_t)i;
            length += hypot((double)(p[0] - p[-3]), (double)(p[1] - p[-2]));
        }
        assert_true(length >= 3);
    }
    io_lines_free(&lines);
}

/* TRK holds what VTP holds; TCK the positions. */
static void every_format_holds_the_same(void **state) {
    (void)state;
    static const char *const names[3] = {"flow_c.vtp", "flow_c.trk", "flow_c.tck"};
    io_lines lines[3];
    for (int i = 0; i < 3; i++) {
        expect_ok(RUN("flow " SERIES "--period 800 --mask disk --seeds 30 -o %s", names[i]));
        lines[i] = read_lines(names[i]);
        assert_int_equal(lines[i].point_count, lines[0].point_count);
        assert_int_equal(lines[i].line_count, lines[0].line_count);
        for (size_t k = 0; k < 3 * (size_t)lines[0].point_count; k++)
            assert_true(fabsf(lines[i].points[k] - lines[0].points[k]) < 1e-4f);
    }
    check_turning(&lines[1], 4);
    assert_int_equal(lines[2].point_attribute_count, 0);
    for (int i = 0; i < 3; i++)
        io_lines_free(&lines[i]);
}

static char *read_bytes(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size);
    assert_non_null(bytes);
    assert_true(fread(bytes, 1, *size, file) == *size);
    fclose(file);
    return bytes;
}

static void threads_change_nothing(void **state) {
    (void)state;
    static const char *const threads[3] = {"1", "3", "nonsense"};
    char *bytes[4];
    size_t sizes[4];
    for (int i = 0; i < 4; i++) {
        setenv("LINEAO_THREADS", threads[i < 3 ? i : 0], 1);
        expect_ok(RUN("flow " SERIES
                      "--period 800 --mask disk --seeds 3000 --seed %d -o flow_d.vtp",
                      i < 3 ? 7 : 8));
        bytes[i] = read_bytes("flow_d.vtp", &sizes[i]);
    }
    unsetenv("LINEAO_THREADS");
    for (int i = 1; i < 3; i++) {
        assert_int_equal(sizes[i], sizes[0]);
        assert_memory_equal(bytes[i], bytes[0], sizes[0]);
    }
    assert_true(sizes[3] != sizes[0] || memcmp(bytes[3], bytes[0], sizes[0]) != 0);
    for (int i = 0; i < 4; i++)
        free(bytes[i]);
}

/* Without a mask, where it is fast: the rim, not the axis. */
static void thresholds_choose_the_inside(void **state) {
    (void)state;
    cJSON *json = expect_json(RUN("flow flow_0.vti --threshold 0.04 --seeds 200 --json "
                                  "-o flow_e.vtp"));
    io_lines lines = read_lines("flow_e.vtp");
    for (uint32_t i = 0; i < lines.point_count; i++)
        assert_true(hypot((double)lines.points[3 * i], (double)lines.points[3 * i + 1]) > 6.5);
    assert_true(cJSON_IsTrue(cJSON_GetObjectItem(json, "streamlines"))); /* one frame is steady */
    assert_true(number(json, "period") == 0);
    io_lines_free(&lines);
    cJSON_Delete(json);
    json = expect_json(RUN("flow flow_0.vti --seeds 200 --json -o flow_e.vtp"));
    int within = 0; /* a tenth of the highest speed, which is sqrt(2) 10 turn: radius sqrt(2) */
    for (int i = 0; i < SIDE * SIDE; i++) {
        int x = i % SIDE - SIDE / 2, y = i / SIDE - SIDE / 2;
        within += x * x + y * y > 2;
    }
    double inside = number(json, "mask_voxels");
    assert_true(inside >= within * HEIGHT && inside <= (within + 4) * HEIGHT);
    cJSON_Delete(json);
    expect_fault(RUN("flow flow_0.vti --threshold 5 -o flow_e.vtp"), 1, "lower --threshold");
}

/* ---- other commands --------------------------------------------------------------------- */

static void info_describes_volumes(void **state) {
    (void)state;
    cJSON *json = expect_json(RUN("info flow_0.vti flow_a.vtp --mask disk --json"));
    cJSON *files = cJSON_GetObjectItem(json, "files"), *file = cJSON_GetArrayItem(files, 0);
    assert_int_equal(cJSON_GetArraySize(files), 2);
    assert_true(number(file, "lines") == 0 && number(file, "points") == 0);
    assert_true(number(file, "frames") == 1 && number(file, "period") == 0);
    assert_string_equal(text(file, "unit"), "mm");
    assert_string_equal(text(file, "velocity_unit"), "m/s");
    assert_true(number(file, "mask_voxels") == 253 * HEIGHT);
    static const char *const lists[] = {"size", "spacing", "speed", "bbox", "attributes", "to_mm"};
    static const double values[][2] = {{SIDE, SIDE}, {1, 1}, {0, 9 * 0.005}};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        cJSON *list = cJSON_GetObjectItem(file, lists[i]);
        assert_true(cJSON_IsArray(list));
        for (int k = 0; i < 3 && k < 2; k++)
            assert_true(fabs(cJSON_GetArrayItem(list, k)->valuedouble - values[i][k]) < 1e-6);
    }
    cJSON *box = cJSON_GetObjectItem(file, "bbox");
    assert_true(cJSON_GetArrayItem(cJSON_GetArrayItem(box, 0), 2)->valuedouble == -2);
    assert_true(cJSON_GetArrayItem(cJSON_GetArrayItem(box, 1), 0)->valuedouble == 10);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(file, "warnings")), 0);
    assert_true(number(cJSON_GetArrayItem(files, 1), "lines") > 0);
    cJSON_Delete(json);
    json = expect_json(RUN("info flow_bare.vti --json")); /* what is missing is a warning here */
    file = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "files"), 0);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(file, "warnings")), 1);
    cJSON_Delete(json);
    program_run run = RUN("info flow_0.vti");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "21 x 21 x 5 of 1 x 1 x 1 mm"));
    assert_non_null(strstr(run.out, "steady"));
    program_free(&run);
}

static bool same_pictures(const char *first, const char *second) {
    uint32_t size[4];
    uint8_t *a, *b;
    assert_true(image_read_png(first, 3, &size[0], &size[1], &a, NULL));
    assert_true(image_read_png(second, 3, &size[2], &size[3], &b, NULL));
    bool same = size[0] == size[2] && size[1] == size[3] &&
                memcmp(a, b, (size_t)size[0] * size[1] * 3) == 0;
    free(a);
    free(b);
    return same;
}

/* Rendering a volume is tracing it and rendering the lines; colours too. */
static void render_traces(void **state) {
    (void)state;
    expect_ok(RUN("flow " SERIES "--period 800 --mask disk --seeds 200 -o flow_f.vtp"));
    expect_ok(RUN("render flow_f.vtp --color speed " SMALL "-o flow_f.png"));
    expect_ok(RUN("render " SERIES "--color speed --period 800 --mask disk --seeds 200 " SMALL
                  "-o flow_g.png"));
    assert_true(same_pictures("flow_f.png", "flow_g.png"));
    expect_fault(RUN("render flow_f.vtp --seeds 5 " SMALL "-o flow_f.png"), 1, "no FILE is one");
}

/* The period of the volume is that of its trails. */
static void trails_repeat(void **state) {
    static const char *const times[3] = {"100", "900", "400"};
    (void)state;
    for (int i = 0; i < 3; i++)
        expect_ok(RUN("render " SERIES "--time-step 200 --mask disk --seeds 100 --time %s " SMALL
                      "-o flow_t%d.png",
                      times[i], i));
    assert_true(same_pictures("flow_t0.png", "flow_t1.png"));
    assert_false(same_pictures("flow_t0.png", "flow_t2.png"));
}

#ifdef LINEAO_HAVE_HDF5
static void hdf5_needs_what_it_lacks(void **state) {
    (void)state;
    buffer b = make_hdf5((hdf5_spec){true, false, false, false, false, false, false, 2});
    write_file("flow_h.h5", &b);
    buffer_free(&b);
    expect_fault(RUN("flow flow_h.h5 -o flow_h.vtp"), 1, "flow_h.h5: tells no size of its voxels");
    expect_fault(RUN("flow flow_h.h5 --spacing 1 -o flow_h.vtp"), 1, "--time-step MS");
    expect_ok(RUN("flow flow_h.h5 --spacing 1,2,3 --time-step 40 --min-length 0 -o flow_h.vtp"));
    cJSON *json = expect_json(RUN("info flow_h.h5 --json"));
    cJSON *file = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "files"), 0);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(file, "warnings")), 2);
    cJSON_Delete(json);
}
#endif

/* ---- failures --------------------------------------------------------------------------- */

static void wrong_usage(void **state) {
    (void)state;
    expect_fault(RUN("flow"), 2, "no VOLUME is given");
    expect_fault(RUN("flow flow_0.vti"), 2, "-o lines.vtp");
    expect_fault(RUN("flow flow_0.vti -o flow_x.png"), 2, ".vtp, .trk or .tck");
    expect_fault(RUN("flow flow_0.vti -o flow_x.vtp --unit km/h"), 2, "m/s|cm/s|mm/s");
    expect_fault(RUN("flow flow_0.vti -o flow_x.vtp --step 0"), 2, "MS|auto");
    expect_fault(RUN("flow flow_0.vti -o flow_x.vtp --spacing 1,2"), 2, "--spacing");
    expect_fault(RUN("flow flow_0.vti -o flow_x.vtp --spacing 0"), 2, "--spacing");
    expect_fault(RUN("flow flow_0.vti -o flow_x.vtp --period -1"), 2, "--period");
    expect_fault(RUN("flow flow_0.vti -o flow_x.vtp --method euler"), 2, "rk4|dopri");
    expect_fault(RUN("flow flow_0.vti -o flow_x.vtp --sedes 5"), 2, "--seeds");
    expect_fault(RUN("flow flow_0.vti -o flow_x.vtp --strength 1"), 2, "unknown flag");
    expect_fault(RUN("render --seeds 5 -o flow_x.png"), 2, "no FILE is given");
    assert_int_equal(access("flow_x.vtp", F_OK), -1);
}

static void work_that_fails(void **state) {
    (void)state;
    expect_fault(RUN("flow " SERIES "-o flow_x.vtp"), 1, "--time-step MS, or --period MS");
    expect_fault(RUN("flow flow_bare.vti -o flow_x.vtp"), 1, "--spacing X,Y,Z");
    expect_fault(RUN("flow flow_0.vti --names disk -o flow_x.vtp"), 1, "velocity has 3");
    expect_fault(RUN("flow flow_0.vti --names u,v,w -o flow_x.vtp"), 1, "flow[3], disk");
    expect_fault(RUN("flow flow_0.vti --mask nothing -o flow_x.vtp"), 1, "--mask picks");
    expect_fault(RUN("flow flow_0.vti --mask none.nii -o flow_x.vtp"), 1,
                 "none.nii: cannot be opened");
    expect_fault(RUN("flow none.vti -o flow_x.vtp"), 1, "none.vti: cannot be opened");
    expect_fault(RUN("flow flow_a.vtp -o flow_x.vtp"), 1, "not a volume");
    expect_fault(RUN("flow flow_0.vti flow_a.vtp -o flow_x.vtp"), 1, "flow_a.vtp: is not a volume");
    expect_fault(RUN("flow flow_0.vti --bundle a -o flow_x.vtp"), 2, "--bundle");
    expect_fault(RUN("flow flow_0.vti -o no/such/x.vtp"), 1, "no/such/x.vtp");
    assert_int_equal(access("flow_x.vtp", F_OK), -1);
}

static void interrupts_leave_nothing(void **state) {
    (void)state;
    expect_fault(program_start(program, true, "flow flow_0.vti -o flow_x.vtp"), 1, "interrupted");
    DIR *folder = opendir(".");
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder)) != NULL;)
        assert_null(strstr(entry->d_name, "flow_x"));
    closedir(folder);
}

static void help_teaches(void **state) {
    (void)state;
    program_run run = RUN("help flow");
    assert_int_equal(run.code, 0);
    static const char *const words[] = {"--spacing",   "lineao flow u.nii v.nii w.nii",
                                        "streamlines", "LINEAO_THREADS",
                                        "mm|grid",     "4DFlowNet"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        assert_non_null(strstr(run.out, words[i]));
    program_free(&run);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pathlines_keep_to_their_circles),
        cmocka_unit_test(options_change_what_is_traced),
        cmocka_unit_test(every_format_holds_the_same),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(thresholds_choose_the_inside),
        cmocka_unit_test(info_describes_volumes),
        cmocka_unit_test(render_traces),
        cmocka_unit_test(trails_repeat),
#ifdef LINEAO_HAVE_HDF5
        cmocka_unit_test(hdf5_needs_what_it_lacks),
#endif
        cmocka_unit_test(wrong_usage),
        cmocka_unit_test(work_that_fails),
        cmocka_unit_test(interrupts_leave_nothing),
        cmocka_unit_test(help_teaches),
    };
    if (argc != 2)
        return 2;
    program = argv[1];
    return cmocka_run_group_tests(tests, make_files, remove_files);
}
