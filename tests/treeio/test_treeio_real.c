/* Real trees and meshes hold what independent readers (VTK 9.1, h5py, numpy) measured in them. */
#include "io_vessel.h" /* first: samples.h has a global of the name of a parameter */

#include "tree_samples.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

static const char *root; /* $LINEAO_DATA or ../shared/data; NULL = absent */

static bool absent(void) {
    if (!root)
        print_message("skipped: the real data is absent; set LINEAO_DATA to its folder\n");
    return !root;
}

/* Measured numbers were printed with four digits. */
static void assert_measured(double value, double measured) {
    if (fabs(value - measured) > 1e-3 * fmax(fabs(measured), 1e-2))
        fail_msg("%.9g is not %.9g", value, measured);
}

/* ---- Trees ----------------------------------------------------------------------------------- */

typedef struct tree_measure {
    const char *name, *unit;
    uint32_t nodes, segments, roots, leaves, branches, multifurcations, max_children, loops, joined;
    double radius[2], box[2][3];
} tree_measure;

/* Centrelines: nodes are the points after merging, less those on no line; of degree 1 there are
 * root and leaves, of degree 3 the branches. Joined are all lines of VascularPathlines but one. */
// clang-format off
static const tree_measure trees[] = {
    {"BG001.CNG.swc", "mm", 2810, 2809, 1, 99, 98, 0, 2, 0, 0, {0.31, 2.629}, {{18.6, -119.7, 20.46}, {155.6, -4.03, 176.7}}},
    {"BG0002.CNG.swc", "mm", 3514, 3513, 1, 106, 105, 0, 2, 0, 0, {0, 2.17}, {{24.18, -104.2, 17.36}, {152.8, -3.1, 175.5}}},
    {"BG05.CNG.swc", "mm", 3196, 3195, 1, 98, 97, 0, 2, 0, 0, {0.31, 3.1}, {{21.7, -137.6, 16.74}, {152.8, -7.44, 182.3}}},
    {"BG07.CNG.swc", "mm", 3419, 3418, 1, 126, 125, 0, 2, 0, 0, {0.31, 2.48}, {{25.11, -121.5, 25.42}, {151.3, -4.65, 176.1}}},
    {"BG09.CNG.swc", "mm", 3301, 3300, 1, 110, 109, 0, 2, 0, 0, {0.31, 2.48}, {{22.94, -134.5, 17.98}, {152.8, -7.75, 176.7}}},
    {"P1_whole_brain_BraVa.swc", "mm", 2541, 2540, 1, 79, 78, 0, 2, 0, 0, {0.5, 2.629}, {{18.6, 21.3, 3.72}, {155.9, 177.5, 119.3}}},
    {"example_centerline_ICA.swc", "mm", 96, 95, 1, 3, 2, 0, 2, 0, 0, {0.5421, 2.09}, {{45.36, 2.456, 42.59}, {78.35, 60.57, 63.68}}},
    {"navis_722817260.swc", "um", 4332, 4331, 1, 656, 612 + 21, 21, 4, 0, 0, {11, 142.5}, {{3418, 11610, 10330}, {22100, 37440, 28020}}},
    {"opencco_liver_N995.gxl.xml", "mm", 1990, 1989, 1, 995, 994, 0, 2, 0, 0, {0.073, 1.55}, {{26, 60, 39}, {100, 125, 102}}},
    {"vascusynth_N200.gxl.xml", "mm", 400, 399, 1, 200, 199, 0, 2, 0, 0, {0.007862, 0.08652}, {{0, 0, 0}, {99, 99, 99}}},
    {"vmtk_aorta-centerline.vtp", "mm", 346, 345, 1, 2, 1, 0, 2, 0, 0, {2.776, 7.578}, {{210.2, 101.3, 21.67}, {234.7, 175.9, 31.69}}},
    {"vmtk_aorta-centerline-branches.vtp", "mm", 350, 349, 1, 2, 1, 0, 2, 0, 0, {2.776, 7.578}, {{210.2, 101.3, 21.67}, {234.7, 175.9, 31.69}}},
    {"vmr_0080_H_PULM_H.vtp", "cm", 14780, 14779, 1, 142, 141, 0, 2, 0, 141, {0.1488, 1.445}, {{-7.625, -5.757, -6.411}, {7.667, 10.72, 11.23}}},
    {"vmr_0052_H_CERE_H.vtp", "cm", 2534, 2533, 1, 14, 13, 0, 2, 0, 13, {0.08357, 0.1984}, {{-3.758, -1.835, -11.34}, {2.794, 2.475, 0.5094}}},
    {"vmr_0030_H_ABAO_H.vtp", "cm", 4735, 4734, 1, 19, 18, 0, 2, 0, 18, {0.1808, 1.201}, {{-8.371, -4.364, -20.8}, {8.23, 6.366, 15.14}}},
    {"vascpy_penetrating_artery_diameters_on_points.vtk", "um", 1274, 1273, 1, 2, 1, 0, 2, 0, 0, {21.05 / 2, 28.16 / 2}, {{323.1, 176.8, 533.6}, {611.5, 542.8, 1618}}},
    {"vascpy_penetrating_artery.vtk", "um", 1274, 1273, 1, 2, 1, 0, 2, 0, 0, {10.4489, 14.0789}, {{323.1, 176.8, 533.6}, {611.5, 542.8, 1618}}},
    {"vascpy_test_smaller_vasculature.vtk", "um", 912, 897, 15, 21, 6, 0, 2, 0, 0, {0.7644, 3.789}, {{607.2, 554.7, 1883}, {824.2, 826.4, 1916}}},
    {"vmv_sample_2.h5", "um", 912, 897, 15, 21, 6, 0, 2, 0, 0, {0.7644 / 2, 3.789 / 2}, {{607.2, 554.7, 1883}, {824.2, 826.4, 1916}}},
    {"vmv_sample-1.vmv", "um", 643, 637, 7, 16, 10, 0, 2, 1, 0, {1, 2.12132}, {{2, 2, 8}, {49, 99, 199}}},
};
// clang-format on

static void assert_tree(const tree_measure *m, const io_tree *tree, const io_vessel *v) {
    const sdv_tree_info *i = &v->tree.info;
    assert_string_equal(tree->unit, m->unit);
    assert_int_equal(i->nodes, m->nodes);
    assert_int_equal(i->segments, m->segments);
    assert_int_equal(i->roots, m->roots);
    assert_int_equal(i->leaves, m->leaves);
    assert_int_equal(i->branches, m->branches);
    assert_int_equal(i->multifurcations, m->multifurcations);
    assert_int_equal(i->max_children, m->max_children);
    assert_int_equal(i->loops, m->loops);
    assert_int_equal(i->joined, m->joined);
    for (int k = 0; k < 2; k++) {
        assert_measured(v->radius[k], m->radius[k]);
        for (int axis = 0; axis < 3; axis++)
            assert_measured(v->bounds[k][axis], m->box[k][axis]);
    }
}

static void real_trees(void **state) {
    (void)state;
    for (size_t i = 0; !absent() && i < sizeof trees / sizeof trees[0]; i++) {
        char path[1024];
        io_tree tree = {0};
        io_vessel vessel = {0};
        io_error error;
        snprintf(path, sizeof path, "%s/trees/%s", root, trees[i].name);
        print_message("%s\n", trees[i].name);
        if (!io_read_tree(path, NULL, &tree, &error) ||
            !io_vessel_build(NULL, &tree, &vessel, &error))
            fail_msg("%s: %s", trees[i].name, error.text);
        assert_tree(&trees[i], &tree, &vessel);
        io_vessel_free(&vessel);
        io_tree_free(&tree);
    }
}

/* ---- Meshes ---------------------------------------------------------------------------------- */

typedef struct mesh_measure {
    const char *name;
    uint32_t vertices, triangles, boundary;
    const char *attribute; /* of a vertex; NULL = none known */
    double range[2];       /* of its length */
    double box[2][3];
} mesh_measure;

// clang-format off
#define AORTA {{205.6, 97.67, 12.45}, {239.9, 181.6, 35.36}}
#define ATRIUM {{-25.27, -189.5, -1113}, {34.06, -141, -1059}}
static const mesh_measure meshes[] = {
    {"surfaces/vmtk_aorta-surface.stl", 6468, 12932, 0, NULL, {0, 0}, AORTA},
    {"surfaces/vmtk_aorta-surface.vtp", 6468, 12932, 0, "Normals_", {1, 1}, AORTA},
    {"surfaces/vmtk_aorta-surface-open-ends.stl", 6068, 11887, 251, NULL, {0, 0}, {{205.7, 101, 12.45}, {239.9, 179, 35.24}}},
    {"surfaces/vampy_atrium.vtp", 10516, 20576, 462, NULL, {0, 0}, {{201.9, 141.2, 65.11}, {245, 209, 149.5}}},
    {"surfaces/vascularmd_ica_stenosis_quads.vtk", 30814, 2 * 30720, 192, NULL, {0, 0}, {{44.11, 2.424, 41.91}, {78.94, 60.77, 65.58}}},
    {"surfaces/moving_atrium/model_moved_00.vtp", 4581, 9023, 145, "displacement", {2.214e-18, 0.1872}, ATRIUM},
    {"surfaces/moving_atrium/model_moved_04.vtp", 4581, 9023, 145, "displacement", {5.335e-17, 2.95}, ATRIUM},
    {"surfaces/moving_atrium/model_moved_08.vtp", 4581, 9023, 145, "displacement", {1.664e-17, 2.49}, ATRIUM},
    {"surfaces/moving_atrium/model_moved_12.vtp", 4581, 9023, 145, "displacement", {5.862e-18, 1.93}, ATRIUM},
    {"surfaces/moving_atrium/model_moved_16.vtp", 4581, 9023, 145, "displacement", {2.7e-17, 1.801}, ATRIUM},
    {"flow/flow4D_inlet/meanProf_03.vtp", 1071, 2039, 101, "Velocity", {0.003807, 1.468}, {{-0.9995, -0.9999, 0}, {1, 0.9999, 0}}},
    {"meshes/bunny.ply", 35947, 69451, 223, NULL, {0, 0}, {{-0.09469, 0.03299, -0.06187}, {0.06101, 0.1873, 0.0588}}},
};
// clang-format on

static double length_of(const io_attribute *a, size_t row) {
    double sum = 0;
    for (size_t k = 0; k < a->components; k++)
        sum += (double)a->data[row * a->components + k] * (double)a->data[row * a->components + k];
    return sqrt(sum);
}

static void assert_attribute(const io_mesh *mesh, const mesh_measure *m) {
    const io_attribute *found = NULL;
    for (uint32_t i = 0; i < mesh->vertex_attribute_count; i++)
        if (!strcmp(mesh->vertex_attributes[i].name, m->attribute))
            found = &mesh->vertex_attributes[i];
    assert_non_null(found);
    double least = INFINITY, most = 0;
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        least = fmin(least, length_of(found, i));
        most = fmax(most, length_of(found, i));
    }
    assert_measured(least, m->range[0]);
    assert_measured(most, m->range[1]);
}

static void assert_mesh(const mesh_measure *m, const io_mesh *mesh) {
    io_mesh_edges edges;
    io_error error;
    assert_true(io_mesh_count_edges(mesh, &edges, &error));
    assert_int_equal(mesh->vertex_count, m->vertices);
    assert_int_equal(mesh->triangle_count, m->triangles);
    assert_int_equal(edges.boundary, m->boundary);
    assert_int_equal(edges.non_manifold, 0);
    assert_int_equal(mesh->warning_count, 0);
    for (int k = 0; k < 2; k++)
        for (int axis = 0; axis < 3; axis++)
            assert_measured(mesh->bounds[k][axis], m->box[k][axis]);
    if (m->attribute)
        assert_attribute(mesh, m);
}

static io_mesh read_welded(const char *name) {
    char path[1024];
    io_mesh mesh = {0};
    io_error error;
    snprintf(path, sizeof path, "%s/%s", root, name);
    if (!io_read_mesh(path, NULL, &mesh, &error) || !io_mesh_weld(&mesh, &error))
        fail_msg("%s: %s", name, error.text);
    return mesh;
}

static void real_meshes(void **state) {
    (void)state;
    for (size_t i = 0; !absent() && i < sizeof meshes / sizeof meshes[0]; i++) {
        print_message("%s\n", meshes[i].name);
        io_mesh mesh = read_welded(meshes[i].name);
        assert_mesh(&meshes[i], &mesh);
        io_mesh_free(&mesh);
    }
}

/* The same surface as STL and as VTP, triangle by triangle. */
static void stl_and_vtp_are_one_surface(void **state) {
    (void)state;
    if (absent())
        return;
    io_mesh stl = read_welded("surfaces/vmtk_aorta-surface.stl");
    io_mesh vtp = read_welded("surfaces/vmtk_aorta-surface.vtp");
    double worst = 0;
    assert_true(vtp.normals && !stl.normals);
    for (size_t i = 0; i < 3 * (size_t)stl.triangle_count; i++)
        for (size_t axis = 0; axis < 3; axis++) {
            double a =
                (double)stl.positions[3 * (size_t)stl.triangles[i] + axis] + stl.origin[axis];
            double b =
                (double)vtp.positions[3 * (size_t)vtp.triangles[i] + axis] + vtp.origin[axis];
            worst = fmax(worst, fabs(a - b));
        }
    print_message("largest difference of a coordinate: %g\n", worst);
    assert_true(worst < 1e-4);
    io_mesh_free(&stl);
    io_mesh_free(&vtp);
}

int main(void) {
    struct stat info;
    root = getenv("LINEAO_DATA");
    if (!root || !*root)
        root = LINEAO_SOURCE_DIR "/../shared/data";
    if (stat(root, &info))
        root = NULL;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(real_trees),
        cmocka_unit_test(real_meshes),
        cmocka_unit_test(stl_and_vtp_are_one_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
