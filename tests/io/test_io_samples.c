/* Every format in every encoding gives the same lines, attributes and groups; filters carry them
 * along; what is written reads back. */
#include "samples.h"

#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static void all_samples_hold_the_same(void **state) {
    (void)state;
    for (size_t i = 0; i < sample_count; i++) {
        print_message("%s\n", samples[i].name);
        buffer b = samples[i].make();
        const char *names[] = {samples[i].name, NULL, "misleading.tck"}; /* the content decides */
        for (size_t k = 0; k < 3; k++) {
            io_lines lines = must_read(&b, names[k], NULL);
            assert_sample(&lines, samples[i].attributes, samples[i].groups);
            assert_non_null(strstr(samples[i].name, lines.format));
            assert_string_equal(lines.unit, "mm");
            io_lines_free(&lines);
            io_lines_free(&lines); /* harmless */
        }
        buffer packed = {0};
        if (strstr(samples[i].name, ".gz"))
            put(&packed, b.data, b.size);
        else
            packed = gzip_of(&b);
        io_lines lines = must_read(&packed, NULL, NULL);
        assert_sample(&lines, samples[i].attributes, samples[i].groups);
        io_lines_free(&lines);
        buffer_free(&packed);
        buffer_free(&b);
    }
}

static io_lines read_sample(const char *name, const io_options *options) {
    buffer b = make_sample(name);
    io_lines lines = must_read(&b, name, options);
    buffer_free(&b);
    return lines;
}

static void every_keeps_rows_together(void **state) {
    (void)state;
    io_options options = {.every = 2};
    io_lines lines = read_sample("new.trx", &options);
    assert_int_equal(lines.line_count, 2);
    assert_int_equal(lines.point_count, 6);
    assert_true(line_attribute(&lines, "w")->data[1] == (float)sample_weight(2));
    assert_true(point_attribute(&lines, "s")->data[5] == (float)sample_scalar(7));
    assert_true(point_attribute(&lines, "v")->data[3 * 1 + 2] == (float)sample_vector(3, 2));
    assert_int_equal(lines.group_count, 1); /* group 7 lost its only line */
    assert_string_equal(lines.groups[0].name, "0");
    assert_int_equal(lines.groups[0].line_count, 2);
    assert_int_equal(lines.groups[0].lines[1], 1);
    io_lines_free(&lines);
}

static void min_length_drops_short_lines(void **state) {
    (void)state;
    io_options options = {.min_length = 0.01f};
    io_lines lines = read_sample("new.trx", &options);
    assert_int_equal(lines.line_count, 2); /* the line of one point has no length */
    assert_true(line_attribute(&lines, "w")->data[0] == (float)sample_weight(1));
    assert_true(lines.bounds[0][0] == sample_position(1, 0));
    io_lines_free(&lines);
    options.min_length = 1e9f;
    lines = read_sample("new.trx", &options);
    assert_int_equal(lines.line_count, 0);
    assert_int_equal(lines.point_attribute_count, 2);
    assert_int_equal(lines.offsets[0], 0);
    io_lines_free(&lines);
}

static void bundle_keeps_one_group(void **state) {
    (void)state;
    const char *files[] = {"clusters.tt", "new.trx"};
    for (size_t i = 0; i < 2; i++) {
        io_options options = {.bundle = "7"};
        io_lines lines = read_sample(files[i], &options);
        assert_int_equal(lines.line_count, 1);
        assert_int_equal(lines.point_count, 2);
        assert_int_equal(lines.group_count, 1);
        assert_string_equal(lines.groups[0].name, "7");
        io_lines_free(&lines);
    }
}

static void unknown_bundles_are_told(void **state) {
    (void)state;
    io_options options = {.bundle = "CST"};
    for (size_t i = 0; i < sample_count; i++) {
        buffer b = samples[i].make();
        must_fail(&b, samples[i].name, &options, samples[i].groups ? "0, 7" : "no bundles");
        buffer_free(&b);
    }
}

typedef struct counter {
    uint64_t calls, last, total, stop;
} counter;

static bool count_progress(void *user, uint64_t done, uint64_t total) {
    counter *c = user;
    assert_true(done >= c->last && done <= total);
    assert_true(!c->total || c->total == total);
    c->last = done;
    c->total = total;
    return ++c->calls == c->stop;
}

static void progress_ascends_and_cancels(void **state) {
    (void)state;
    for (size_t i = 0; i < sample_count; i++) {
        buffer b = samples[i].make();
        counter c = {0, 0, 0, 0};
        io_options options = {.progress = count_progress, .user = &c};
        io_lines lines = must_read(&b, NULL, &options);
        io_lines_free(&lines);
        assert_true(c.calls >= 3 && c.last == c.total);
        for (uint64_t stop = c.calls; stop; stop--) { /* at every place where it can be */
            counter again = {0, 0, 0, stop};
            options.user = &again;
            must_fail(&b, NULL, &options, "cancelled");
        }
        buffer_free(&b);
    }
}

/* ---- Files -------------------------------------------------------------------------------------
 */

static char folder[64];

static int make_folder(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/lineao_io_XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int files_in_folder(void) {
    int count = 0;
    DIR *open = opendir(folder);
    for (struct dirent *entry; (entry = readdir(open)) != NULL;)
        count += entry->d_name[0] != '.';
    closedir(open);
    return count;
}

static int remove_folder(void **state) {
    (void)state;
    return rmdir(folder);
}

static void path_in_folder(char path[128], const char *name) {
    snprintf(path, 128, "%s/%s", folder, name);
}

static void written_files_read_back(void **state) {
    (void)state;
    const char *names[] = {"a.tck", "a.TRK", "a.vtp"};
    for (size_t i = 0; i < 3; i++) {
        char path[128];
        io_error error = {""};
        path_in_folder(path, names[i]);
        io_lines lines = read_sample("new.trx", NULL), back = {0};
        for (int twice = 0; twice < 2; twice++) /* the second time it replaces the first file */
            if (!io_write_lines(path, &lines, &error))
                fail_msg("%s", error.text);
        assert_int_equal(files_in_folder(), 1);
        if (!io_read_lines(path, NULL, &back, &error))
            fail_msg("%s", error.text);
        assert_sample(&back, i > 0, false);
        assert_memory_equal(back.points, lines.points, sizeof(float) * SAMPLE_POINTS * 3);
        io_lines_free(&back);
        io_lines_free(&lines);
        unlink(path);
    }
}

static void empty_sets_are_written(void **state) {
    (void)state;
    const char *names[] = {"e.tck", "e.trk", "e.vtp"};
    for (size_t i = 0; i < 3; i++) {
        char path[128];
        io_lines none = {0}, back = {0};
        io_error error = {""};
        path_in_folder(path, names[i]);
        if (!io_write_lines(path, &none, &error) || !io_read_lines(path, NULL, &back, &error))
            fail_msg("%s: %s", names[i], error.text);
        assert_int_equal(back.line_count, 0);
        assert_int_equal(back.warning_count, 0);
        io_lines_free(&back);
        unlink(path);
    }
}

static void names_survive_writing(void **state) {
    (void)state;
    char path[128];
    io_error error = {""};
    io_lines lines = read_sample("old.trx", NULL), back = {0};
    lines.point_attributes[0].name[0] = '<';
    path_in_folder(path, "n.vtp");
    if (!io_write_lines(path, &lines, &error) || !io_read_lines(path, NULL, &back, &error))
        fail_msg("%s", error.text);
    assert_non_null(point_attribute(&back, "<"));
    io_lines_free(&back);
    io_lines_free(&lines);
    unlink(path);
}

/* Doubles far from zero: the spacing of floats at 1100 is 1e-4, the file keeps 1e-7. */
static void far_away_lines_keep_their_detail(void **state) {
    (void)state;
    buffer b = {0};
    put_text(&b, "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n"
                 "1 2 -1100.0000011 3 4 -1101.0000022\nLINES 1 3 2 0 1\n");
    io_lines lines = must_read(&b, NULL, NULL), back = {0};
    buffer_free(&b);
    char path[128];
    io_error error = {""};
    path_in_folder(path, "far.vtp");
    assert_true(lines.origin[0] == 0 && lines.origin[2] < -1000);
    if (!io_write_lines(path, &lines, &error) || !io_read_lines(path, NULL, &back, &error)) {
        fail_msg("%s", error.text);
        return;
    }
    for (int i = 0; i < 2; i++) {
        const io_lines *l = i ? &back : &lines;
        assert_true(fabs((double)l->points[2] + l->origin[2] + 1100.0000011) < 1e-7);
        assert_true(fabs((double)l->points[5] + l->origin[2] + 1101.0000022) < 1e-7);
        assert_true(fabs(l->bounds[1][2] + 1100.0000011) < 1e-7);
    }
    io_lines_free(&back);
    io_lines_free(&lines);
    unlink(path);
}

static void failed_writes_leave_nothing(void **state) {
    (void)state;
    io_lines lines = read_sample("new.trx", NULL);
    char path[128];
    io_error error = {""};
    const char *wrong[] = {"a.trx", "a", "a.tck.gz", ".tck/", "a.txt"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        path_in_folder(path, wrong[i]);
        assert_false(io_write_lines(path, &lines, &error));
        assert_true(error.text[0]);
    }
    path_in_folder(path, "missing/a.tck");
    assert_false(io_write_lines(path, &lines, &error));
    assert_non_null(strstr(error.text, "cannot be written"));
    path_in_folder(path, "folder.tck"); /* a folder of that name cannot be replaced */
    assert_int_equal(0, mkdir(path, 0777));
    assert_false(io_write_lines(path, &lines, &error));
    assert_int_equal(files_in_folder(), 1);
    rmdir(path);
    assert_false(io_write_lines("/dev/full/a.tck", &lines, &error));
    io_lines_free(&lines);
}

/* A disk that fills up, played by a limit on the size of files. */
static void full_disks_leave_nothing(void **state) {
    (void)state;
    const char *names[] = {"f.tck", "f.trk", "f.vtp"};
    io_lines lines = read_sample("new.trx", NULL);
    struct rlimit before, tight;
    getrlimit(RLIMIT_FSIZE, &before);
    tight = before;
    tight.rlim_cur = 50;
    signal(SIGXFSZ, SIG_IGN);
    for (size_t i = 0; i < 3; i++) {
        char path[128];
        io_error error = {""};
        path_in_folder(path, names[i]);
        setrlimit(RLIMIT_FSIZE, &tight);
        bool written = io_write_lines(path, &lines, &error);
        setrlimit(RLIMIT_FSIZE, &before);
        assert_false(written);
        assert_non_null(strstr(error.text, "too large"));
        assert_int_equal(files_in_folder(), 0);
    }
    io_lines_free(&lines);
}

static void missing_and_foreign_files_are_told(void **state) {
    (void)state;
    io_lines lines = {0};
    io_error error = {""};
    char path[128];
    path_in_folder(path, "missing.trk");
    assert_false(io_read_lines(path, NULL, &lines, &error));
    assert_non_null(strstr(error.text, "No such file"));
    assert_null(strstr(error.text, folder)); /* the caller names the file */
    assert_false(io_read_lines(folder, NULL, &lines, &error));
    assert_non_null(strstr(error.text, "header.json"));
    buffer b = {0};
    must_fail(&b, NULL, NULL, "empty");
    put_text(&b, "hello");
    must_fail(&b, NULL, NULL, "in no format");
    must_fail(&b, "a.trk", NULL, "1000 bytes");
    must_fail(&b, "a.tck.gz", NULL, "mrtrix tracks");
    must_fail(&b, "a.trx", NULL, "zip");
    must_fail(&b, "a.tt", NULL, "damaged");
    must_fail(&b, "a.vtk", NULL, "vtk DataFile");
    must_fail(&b, "a.vtp", NULL, "XML");
    buffer_free(&b);
}

static void write_item(const char *name, const buffer *content) {
    char path[128];
    path_in_folder(path, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fwrite(content->data, 1, content->size, file);
    fclose(file);
}

static void unpacked_trx_folders_are_read(void **state) {
    (void)state;
    const char *folders[] = {"dpv", "dps"};
    const char *files[] = {"header.json", "positions.3.float64", "offsets.uint32", "dpv/s.int8",
                           "dps/w.uint16"};
    buffer content[5] = {{0}};
    char path[128];
    for (size_t i = 0; i < 2; i++) {
        path_in_folder(path, folders[i]);
        assert_int_equal(0, mkdir(path, 0777));
    }
    put_text(&content[0], "{\"NB_VERTICES\":3,\"NB_STREAMLINES\":2}");
    for (unsigned i = 0; i < 9; i++)
        put_f64(&content[1], i);
    put_u32(&content[2], 0);
    put_u32(&content[2], 1);
    put_u32(&content[2], 3);
    for (unsigned i = 0; i < 3; i++)
        put_u8(&content[3], 255 - i);
    put_u16(&content[4], 5);
    put_u16(&content[4], 65535);
    for (size_t i = 0; i < 5; i++)
        write_item(files[i], &content[i]);
    io_lines lines = {0};
    io_error error = {""};
    if (!io_read_lines(folder, NULL, &lines, &error))
        fail_msg("%s", error.text);
    assert_string_equal(lines.format, "trx");
    assert_int_equal(lines.line_count, 2);
    assert_true(point_attribute(&lines, "s")->data[2] == -3);
    assert_true(line_attribute(&lines, "w")->data[1] == 65535);
    io_lines_free(&lines);
    for (size_t i = 0; i < 5; i++) {
        path_in_folder(path, files[i]);
        unlink(path);
        buffer_free(&content[i]);
    }
    for (size_t i = 0; i < 2; i++) {
        path_in_folder(path, folders[i]);
        rmdir(path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_samples_hold_the_same),
        cmocka_unit_test(every_keeps_rows_together),
        cmocka_unit_test(min_length_drops_short_lines),
        cmocka_unit_test(bundle_keeps_one_group),
        cmocka_unit_test(unknown_bundles_are_told),
        cmocka_unit_test(progress_ascends_and_cancels),
        cmocka_unit_test(written_files_read_back),
        cmocka_unit_test(empty_sets_are_written),
        cmocka_unit_test(names_survive_writing),
        cmocka_unit_test(far_away_lines_keep_their_detail),
        cmocka_unit_test(failed_writes_leave_nothing),
        cmocka_unit_test(full_disks_leave_nothing),
        cmocka_unit_test(missing_and_foreign_files_are_told),
        cmocka_unit_test(unpacked_trx_folders_are_read),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
