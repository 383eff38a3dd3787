/* Real files hold what independent readers measured in them; the same lines in different formats
 * are the same; big files load fast. */
#include "samples.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#ifndef LINEAO_SOURCE_DIR
#define LINEAO_SOURCE_DIR "."
#endif

static const char *root; /* $LINEAO_DATA or ../shared/data; NULL = absent */

static void path_of(char path[1024], const char *name) {
    snprintf(path, 1024, "%s/%s", root, name);
}

static io_lines read_real(const char *name) {
    char path[1024];
    io_lines lines = {0};
    io_error error;
    path_of(path, name);
    if (!io_read_lines(path, NULL, &lines, &error))
        fail_msg("%s: %s", name, error.text);
    return lines;
}

static bool absent(void) {
    if (!root)
        print_message("skipped: the real data is absent; set LINEAO_DATA to its folder\n");
    return !root;
}

/* Measured with nibabel 5.0, VTK 9.1 or numpy, printed with 4 digits. */
typedef struct measure {
    const char *name;
    uint32_t lines, points, shortest, longest, groups; /* shortest 0 = not measured */
    double box[2][3];
    const char *warning; /* NULL = none at all */
} measure;

#define EXAMPLE                                                                                    \
    {                                                                                              \
        {-47.95, -79.33, -3.223}, {                                                                \
            1.267, -8.752, 64.03                                                                   \
        }                                                                                          \
    }
#define SLICER                                                                                     \
    {                                                                                              \
        {-60.09, -86.66, -65.55}, {                                                                \
            4.334, -0.3122, 46.17                                                                  \
        }                                                                                          \
    }
#define DPSV                                                                                       \
    {                                                                                              \
        {-29.72, -79.5, -31.78}, {                                                                 \
            31.59, -11.53, 60.97                                                                   \
        }                                                                                          \
    }
#define SIMPLE                                                                                     \
    {                                                                                              \
        {0, 1, 2}, {                                                                               \
            12, 13, 14                                                                             \
        }                                                                                          \
    }
#define STANDARD                                                                                   \
    {                                                                                              \
        {-0.5, -1.5, -1}, {                                                                        \
            3.5, 13.5, 13                                                                          \
        }                                                                                          \
    }
static const measure measures[] = {
    {"lines/example.trk", 305, 44249, 90, 196, 0, EXAMPLE, NULL},
    {"lines/example.tck", 305, 44249, 90, 196, 0, EXAMPLE, NULL},
    {"lines/example.vtk", 305, 44249, 90, 196, 0, EXAMPLE, NULL},
    {"lines/example.vtp",
     305,
     44249,
     90,
     196,
     0,
     {{-47.95, -79.33, -3.223}, {1.269, -8.752, 64.03}},
     NULL},
    {"lines/tracks300.trk",
     300,
     14576,
     30,
     91,
     0,
     {{64.02, 78.36, 61.47}, {115.6, 121.1, 91.91}},
     NULL},
    {"lines/sift_phantom.tck",
     5000,
     105802,
     10,
     27,
     0,
     {{-12.33, -3, -6.998}, {12.33, 3, 7}},
     NULL},
    {"lines/tensor_det.tck",
     257,
     15355,
     51,
     77,
     0,
     {{31.61, 41.71, 26.63}, {46.39, 57.18, 40.91}},
     NULL},
    {"lines/tckconvert_tracks_binary.vtk",
     500,
     3408,
     0,
     0,
     0,
     {{32.09, 41.21, 26.13}, {47.18, 61.12, 46.93}},
     NULL},
    {"lines/afq_arcuate.trx",
     508,
     141447,
     0,
     0,
     2,
     {{-64.4, -72.82, -31.34}, {40, 58.27, 69.97}},
     NULL},
    {"lines/dpsv_u32off.trx", 459, 95708, 0, 0, 0, DPSV, "157 vertices"},
    {"lines/dpsv_u64off.trx", 460, 95865, 0, 0, 0, DPSV, NULL},
    {"lines/TR_S_R.tt.gz",
     1159,
     143324,
     61,
     177,
     0,
     {{3.344, -59.09, -1.562}, {60.78, 46.31, 74.38}},
     NULL},
    {"lines/INDI_rhesus.tt.gz",
     16481,
     1624039,
     20,
     755,
     66,
     {{-27.92, -43.25, -17.55}, {27.75, 28.7, 26.27}},
     NULL},
    {"lines/slicerdmri_tractography.vtk", 20, 1293, 0, 0, 0, SLICER, NULL},
    {"lines/slicerdmri_tractography.vtp", 20, 1293, 0, 0, 0, SLICER, NULL},
    {"lines/edge_nibabel/simple.trk", 3, 8, 1, 5, 0, SIMPLE, NULL},
    {"lines/edge_nibabel/complex.trk", 3, 8, 1, 5, 0, SIMPLE, NULL},
    {"lines/edge_nibabel/empty.trk", 0, 0, 0, 0, 0, {{0, 0, 0}, {0, 0, 0}}, NULL},
    {"lines/edge_nibabel/standard.trk", 120, 360, 3, 3, 0, STANDARD, NULL},
    {"lines/edge_nibabel/simple.tck", 3, 8, 1, 5, 0, SIMPLE, NULL},
    {"lines/edge_nibabel/empty.tck", 0, 0, 0, 0, 0, {{0, 0, 0}, {0, 0, 0}}, NULL},
    {"lines/edge_nibabel/standard.tck", 120, 360, 3, 3, 0, STANDARD, NULL},
    {"derived/jet_streamlines.vtp",
     100,
     15800,
     0,
     0,
     0,
     {{0.01238, 0.1, 0.01559}, {0.9029, 1.992, 0.9744}},
     NULL},
    {"trees/vmr_0080_H_PULM_H.vtp",
     142,
     14780,
     0,
     0,
     0,
     {{-7.625, -5.757, -6.411}, {7.667, 10.72, 11.23}},
     NULL},
    {"trees/vmtk_aorta-centerline.vtp",
     2,
     409,
     0,
     0,
     0,
     {{210.2, 101.3, 21.67}, {234.7, 175.9, 31.69}},
     NULL},
    {"trees/vascpy_penetrating_artery.vtk",
     1273,
     2546,
     2,
     2,
     0,
     {{323.1, 176.8, 533.6}, {611.5, 542.8, 1618}},
     NULL},
    {"trees/vascpy_test_smaller_vasculature.vtk",
     897,
     1794,
     2,
     2,
     0,
     {{607.2, 554.7, 1883}, {824.2, 826.4, 1916}},
     NULL},
};

static void assert_printed(const char *name, double value, double expected) {
    char a[32], b[32];
    snprintf(a, sizeof a, "%.4g", value);
    snprintf(b, sizeof b, "%.4g", expected);
    if (strcmp(a, b) != 0)
        fail_msg("%s: %s, not %s", name, a, b);
}

static void assert_measure(const measure *m, const io_lines *lines) {
    uint32_t shortest = UINT32_MAX, longest = 0;
    for (uint32_t i = 0; i < lines->line_count; i++) {
        uint32_t count = lines->offsets[i + 1] - lines->offsets[i];
        shortest = count < shortest ? count : shortest;
        longest = count > longest ? count : longest;
    }
    assert_int_equal(lines->line_count, m->lines);
    assert_int_equal(lines->point_count, m->points);
    assert_int_equal(lines->offsets[m->lines], m->points);
    assert_int_equal(lines->group_count, m->groups);
    if (m->shortest)
        assert_true(shortest == m->shortest && longest == m->longest);
    for (int i = 0; i < 2; i++)
        for (int axis = 0; axis < 3; axis++)
            assert_printed(m->name, lines->bounds[i][axis], m->box[i][axis]);
    if (m->warning ? !has_warning(lines, m->warning) : lines->warning_count > 0)
        fail_msg("%s: %s", m->name,
                 lines->warning_count ? lines->warnings[0] : "a warning is missing");
}

static void files_hold_what_was_measured(void **state) {
    (void)state;
    if (absent())
        return;
    for (size_t i = 0; i < sizeof measures / sizeof measures[0]; i++) {
        struct timespec begin, end;
        clock_gettime(CLOCK_MONOTONIC, &begin);
        io_lines lines = read_real(measures[i].name);
        clock_gettime(CLOCK_MONOTONIC, &end);
        double ms = (double)(end.tv_sec - begin.tv_sec) * 1e3 +
                    (double)(end.tv_nsec - begin.tv_nsec) * 1e-6;
        print_message("%7.1f ms %s\n", ms, measures[i].name);
        assert_measure(&measures[i], &lines);
        io_lines_free(&lines);
    }
}

static void broken_files_are_rejected(void **state) {
    static const char *const names[] = {"lines/edge_nibabel/no_header_end.tck",
                                        "lines/edge_nibabel/no_magic_number.tck",
                                        "flow/carotid.vtk"};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof names[0] && !absent(); i++) {
        char path[1024];
        io_lines lines = {0};
        io_error error = {""};
        path_of(path, names[i]);
        assert_false(io_read_lines(path, NULL, &lines, &error));
        assert_true(error.text[0]);
    }
}

/* Ranges of one component, or of the length of vectors, as VTK prints them. */
typedef struct range {
    const char *file, *name;
    double low, high;
    uint32_t components;
    bool of_lines;
} range;

// clang-format off
static const range ranges[] = {
    {"lines/example.vtk", "NormalizedSignalEstimationError", 0, 0.04994, 1, false},
    {"lines/example.vtk", "EstimatedUncertainty", 0.03873, 1.521e4, 1, false},
    {"lines/example.vtk", "RTOP1", 1.667, 164, 1, false},
    {"lines/example.vtk", "RTOP2", 1.619, 755.7, 1, false},
    {"lines/example.vtk", "RTAP1", 1.49, 18.35, 1, false},
    {"lines/example.vtk", "RTAP2", 1.201, 943.1, 1, false},
    {"lines/example.vtk", "RTPP1", 0.91, 7.224, 1, false},
    {"lines/example.vtk", "RTPP2", 0.8019, 3.772, 1, false},
    {"lines/example.vtk", "SignalMean", 2.474e-5, 0.03614, 1, false},
    {"lines/example.vtp", "RTOP1", 1.667, 164, 1, false},
    {"lines/example.vtp", "RTAP2", 1.201, 943.1, 1, false},
    {"lines/example.vtp", "SignalMean", 2.474e-5, 0.03614, 1, false},
    {"lines/slicerdmri_tractography.vtk", "EstimatedUncertainty", 0.03162, 1.156e4, 1, false},
    {"lines/slicerdmri_tractography.vtk", "tensor1", 0.0003388, 0.002052, 9, false},
    {"lines/slicerdmri_tractography.vtk", "tensor2", 0.00053, 0.001715, 9, false},
    {"lines/slicerdmri_tractography.vtp", "EstimatedUncertainty", 0.03162, 1.156e4, 1, false},
    {"lines/slicerdmri_tractography.vtp", "tensor1", 0.0003388, 0.002052, 9, false},
    {"lines/slicerdmri_tractography.vtp", "tensor2", 0.00053, 0.001715, 9, false},
    {"derived/jet_streamlines.vtp", "velocity", 0.1776, 11.65, 3, false},
    {"trees/vmr_0080_H_PULM_H.vtp", "MaximumInscribedSphereRadius", 0.1488, 1.445, 1, false},
    {"trees/vmtk_aorta-centerline.vtp", "EdgeArray", 2677, 3.017e4, 2, false},
    {"lines/dpsv_u64off.trx", "z", -31.78, 60.97, 1, false},
};
// clang-format on

static void assert_range(const range *expected, const io_lines *lines) {
    const io_attribute *found =
        (expected->of_lines ? line_attribute : point_attribute)(lines, expected->name);
    double low = INFINITY, high = -INFINITY;
    if (!found) {
        fail_msg("%s lacks %s", expected->file, expected->name);
        return;
    }
    assert_int_equal(found->components, expected->components);
    for (size_t i = 0; i < (expected->of_lines ? lines->line_count : lines->point_count); i++) {
        double sum = 0;
        for (size_t k = 0; k < found->components; k++) {
            double value = (double)found->data[i * found->components + k];
            sum += found->components > 1 ? value * value : value;
        }
        sum = found->components > 1 ? sqrt(sum) : sum;
        low = fmin(low, sum);
        high = fmax(high, sum);
    }
    assert_printed(expected->name, low, expected->low);
    assert_printed(expected->name, high, expected->high);
}

static void attributes_have_their_ranges(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0] && !absent(); i++) {
        io_lines lines = read_real(ranges[i].file);
        assert_range(&ranges[i], &lines);
        io_lines_free(&lines);
    }
}

static void names_are_all_there(void **state) {
    static const char *const cells[] = {"EmbeddingCoordinate", "ClusterNumber", "EmbeddingColor",
                                        "TotalFiberSimilarity", "MeasuredFiberSimilarity"};
    static const char *const files[] = {"lines/example.vtk", "lines/example.vtp"};
    (void)state;
    if (absent())
        return;
    for (size_t i = 0; i < 2; i++) {
        io_lines lines = read_real(files[i]);
        assert_int_equal(lines.point_attribute_count, 9);
        assert_int_equal(lines.line_attribute_count, 5);
        for (size_t k = 0; k < 5; k++)
            assert_non_null(line_attribute(&lines, cells[k]));
        io_lines_free(&lines);
    }
    io_lines lines = read_real("lines/edge_nibabel/complex.trk");
    assert_int_equal(point_attribute(&lines, "colors")->components, 3);
    assert_int_equal(point_attribute(&lines, "fa")->components, 1);
    assert_int_equal(line_attribute(&lines, "mean_colors")->components, 3);
    assert_non_null(line_attribute(&lines, "mean_curvature"));
    assert_non_null(line_attribute(&lines, "mean_torsion"));
    io_lines_free(&lines);
    lines = read_real("lines/afq_arcuate.trx");
    assert_string_equal(lines.groups[0].name, "ARC_L");
    assert_int_equal(lines.groups[0].line_count, 486);
    assert_string_equal(lines.groups[1].name, "ARC_R");
    assert_int_equal(lines.groups[1].line_count, 22);
    io_lines_free(&lines);
}

static double largest_difference(const char *first, const char *second) {
    io_lines a = read_real(first), b = read_real(second);
    assert_int_equal(a.point_count, b.point_count);
    assert_int_equal(a.line_count, b.line_count);
    assert_memory_equal(a.offsets, b.offsets, (a.line_count + 1) * sizeof *a.offsets);
    double largest = 0;
    for (size_t i = 0; i < 3 * (size_t)a.point_count; i++)
        largest = fmax(largest, fabs((double)a.points[i] + a.origin[i % 3] - (double)b.points[i] -
                                     b.origin[i % 3]));
    io_lines_free(&a);
    io_lines_free(&b);
    return largest;
}

static void formats_agree(void **state) {
    (void)state;
    if (absent())
        return;
    assert_true(largest_difference("lines/example.trk", "lines/example.tck") == 0);
    assert_true(largest_difference("lines/example.trk", "lines/example.vtk") == 0);
    assert_true(largest_difference("lines/example.trk", "lines/example.vtp") < 0.0022);
    assert_true(largest_difference("lines/edge_nibabel/standard.trk",
                                   "lines/edge_nibabel/standard.tck") < 1e-6);
    assert_true(largest_difference("lines/slicerdmri_tractography.vtk",
                                   "lines/slicerdmri_tractography.vtp") < 0.001);
}

static void assert_same_attributes(const io_attribute *a, const io_attribute *b, uint32_t count,
                                   size_t rows) {
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(a[i].components, b[i].components);
        assert_memory_equal(a[i].data, b[i].data, rows * a[i].components * sizeof(float));
    }
}

static void round_trip(const char *name, const char *path, uint32_t point_attributes,
                       uint32_t line_attributes, double bound) {
    io_lines a = read_real(name), b = {0};
    io_error error;
    if (!io_write_lines(path, &a, &error) || !io_read_lines(path, NULL, &b, &error)) {
        fail_msg("%s: %s", path, error.text);
        return;
    }
    unlink(path);
    assert_int_equal(b.line_count, a.line_count);
    assert_int_equal(b.point_attribute_count, point_attributes);
    assert_int_equal(b.line_attribute_count, line_attributes);
    assert_memory_equal(a.offsets, b.offsets, (a.line_count + 1) * sizeof *a.offsets);
    for (size_t i = 0; i < 3 * (size_t)a.point_count; i++)
        assert_true(fabs((double)a.points[i] + a.origin[i % 3] - (double)b.points[i] -
                         b.origin[i % 3]) <= bound);
    assert_same_attributes(a.point_attributes, b.point_attributes, point_attributes, a.point_count);
    assert_same_attributes(a.line_attributes, b.line_attributes, line_attributes, a.line_count);
    assert_int_equal(b.warning_count, 0);
    io_lines_free(&a);
    io_lines_free(&b);
}

static void written_files_hold_the_same(void **state) {
    (void)state;
    if (absent())
        return;
    char folder[] = "/tmp/lineao_real_XXXXXX", tck[64], trk[64], vtp[64];
    assert_non_null(mkdtemp(folder));
    snprintf(tck, sizeof tck, "%s/a.tck", folder);
    snprintf(trk, sizeof trk, "%s/a.trk", folder);
    snprintf(vtp, sizeof vtp, "%s/a.vtp", folder);
    round_trip("lines/example.vtk", tck, 0, 0, 0);
    round_trip("lines/example.vtk", vtp, 9, 5, 0);
    round_trip("lines/slicerdmri_tractography.vtk", trk, 3, 0, 1e-5);
    round_trip("lines/tensor_det.tck", tck, 0, 0, 0);
    round_trip("lines/tensor_det.tck", vtp, 0, 0, 0);
    round_trip("lines/INDI_rhesus.tt.gz", trk, 0, 1, 1e-5);
    rmdir(folder);
}

static void clusters_are_bundles(void **state) {
    (void)state;
    if (absent())
        return;
    char path[1024];
    io_lines lines = {0};
    io_error error = {""};
    io_options options = {.bundle = "3", .every = 10};
    io_lines all = read_real("lines/INDI_rhesus.tt.gz");
    path_of(path, "lines/INDI_rhesus.tt.gz");
    assert_true(io_read_lines(path, &options, &lines, &error));
    assert_int_equal(lines.group_count, 1);
    assert_string_equal(lines.groups[0].name, "3");
    assert_int_equal(lines.line_count, (all.groups[3].line_count + 9) / 10);
    assert_true(line_attribute(&lines, "cluster")->data[0] == 3);
    io_lines_free(&lines);
    options.bundle = "66";
    assert_false(io_read_lines(path, &options, &lines, &error));
    assert_non_null(strstr(error.text, "0, 1, 2"));
    io_lines_free(&all);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_hold_what_was_measured),
        cmocka_unit_test(broken_files_are_rejected),
        cmocka_unit_test(attributes_have_their_ranges),
        cmocka_unit_test(names_are_all_there),
        cmocka_unit_test(formats_agree),
        cmocka_unit_test(written_files_hold_the_same),
        cmocka_unit_test(clusters_are_bundles),
    };
    struct stat info;
    root = getenv("LINEAO_DATA");
    if (!root)
        root = LINEAO_SOURCE_DIR "/../shared/data";
    if (stat(root, &info))
        root = NULL;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
