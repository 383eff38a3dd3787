/* The same velocity field gives the same numbers from every format and encoding; orientation,
 * units, time and masks follow the rules of the formats and the options; and what cannot be known
 * is asked for by name. */
#include "volume_checks.h"

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

static const io_volume_options none;

static void write_file(const char *path, const buffer *b) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fwrite(b->data, 1, b->size, file) == b->size);
    assert_int_equal(fclose(file), 0);
}

static void same_numbers_from_every_format(void **state) {
    (void)state;
    for (size_t i = 0; i < volume_sample_count; i++) {
        const volume_sample *s = &volume_samples[i];
        buffer files[MOST_FILES] = {{0}};
        io_volume_options options = none;
        print_message("%s\n", s->name);
        options.time_step = s->timed ? 0 : sample_step;
        s->make(files);
        io_volume v = must_read_volume(files, s->files, &options);
        assert_volume(&v, s->frames, s->mask, !s->hdf5);
        assert_int_equal(v.warning_count, 0);
        io_volume_free(&v);
        free_files(files);
    }
}

/* From files, one of them compressed; what is a volume is known by its content. */
static void files_are_known_by_content(void **state) {
    (void)state;
    const char *path = "volume_test.bin";
    for (size_t i = 0; i < volume_sample_count; i++) {
        const volume_sample *s = &volume_samples[i];
        buffer files[MOST_FILES] = {{0}};
        s->make(files);
        write_file(path, &files[0]);
        assert_true(io_is_volume(path));
        if (s->files == 1) {
            io_volume_options options = none;
            io_volume v;
            io_error error;
            options.time_step = s->timed ? 0 : sample_step;
            assert_true(io_read_volume(&path, 1, &options, &v, NULL, &error));
            assert_volume(&v, s->frames, s->mask, !s->hdf5);
            io_volume_free(&v);
        }
        free_files(files);
    }
    buffer lines = make_vtk(true, true);
    write_file(path, &lines);
    assert_false(io_is_volume(path));
    buffer_free(&lines);
    remove(path);
    assert_false(io_is_volume(path));
    io_volume v;
    io_error error;
    uint32_t failed = 99;
    assert_false(io_read_volume(&path, 1, NULL, &v, &failed, &error));
    assert_non_null(strstr(error.text, "cannot be opened"));
    assert_int_equal(failed, 0);
}

/* ---- Space ----------------------------------------------------------------------------------- */

static void assert_row(const io_volume *v, int row, double a, double b, double c, double d) {
    const double expected[4] = {a, b, c, d};
    for (int k = 0; k < 4; k++)
        if (fabs(v->to_mm[row][k] - expected[k]) > 1e-5)
            fail_msg("to_mm[%d][%d] = %g, not %g", row, k, v->to_mm[row][k], expected[k]);
}

#ifdef LINEAO_HAVE_NIFTI
static void put_f32_at(buffer *b, size_t at, double value) {
    float narrow = (float)value;
    uint32_t bits;
    memcpy(&bits, &narrow, 4);
    patch_bytes(b, at, bits, 4);
}

/* sform before qform before pixdim; a quaternion turns as the standard says. */
static void nifti_orientation(void **state) {
    (void)state;
    buffer b = make_nifti((nifti){1, false, 16, 0, 1, FIFTH_AXIS, 0, true});
    io_volume_options options = none;
    put_f32_at(&b, 264, sqrt(0.5)); /* quatern_d: a quarter turn about z, x to y */
    put_f32_at(&b, 76, -1);         /* qfac: z flipped */
    io_volume v = must_read_volume(&b, 1, NULL);
    assert_row(&v, 0, 0, -1, 0, 10);
    assert_row(&v, 1, 0.5, 0, 0, -20);
    assert_row(&v, 2, 0, 0, -2, 30);
    for (int k = 0; k < 3; k++) /* components are along the mm unless told */
        assert_true(fabs((double)v.velocity[k] - sample_velocity(0, (unsigned)k, 0)) < 1e-6);
    io_volume_free(&v);
    options.along_grid = true;
    v = must_read_volume(&b, 1, &options);
    assert_true(fabs((double)v.velocity[0] + sample_velocity(0, 1, 0)) < 1e-6);
    assert_true(fabs((double)v.velocity[1] - sample_velocity(0, 0, 0)) < 1e-6);
    assert_true(fabs((double)v.velocity[2] + sample_velocity(0, 2, 0)) < 1e-6);
    io_volume_free(&v);
    options.along_grid = false;
    options.spacing[0] = 4;
    options.spacing[1] = 5;
    options.spacing[2] = 6; /* keeps the directions */
    v = must_read_volume(&b, 1, &options);
    assert_row(&v, 0, 0, -5, 0, 10);
    assert_row(&v, 1, 4, 0, 0, -20);
    assert_row(&v, 2, 0, 0, -6, 30);
    io_volume_free(&v);
    patch_bytes(&b, 254, 1, 2); /* now the sform rules, and differs */
    v = must_read_volume(&b, 1, NULL);
    assert_row(&v, 0, 0.5, 0, 0, 10);
    assert_true(volume_warns(&v, "sform and qform differ"));
    io_volume_free(&v);
    for (size_t at = 280; at < 328; at += 4)
        put_f32_at(&b, at, 0); /* an sform of zeros is none */
    v = must_read_volume(&b, 1, NULL);
    assert_row(&v, 0, 0, -1, 0, 10);
    assert_true(volume_warns(&v, "sform is no orientation"));
    io_volume_free(&v);
    patch_bytes(&b, 252, 0, 2);
    patch_bytes(&b, 254, 0, 2); /* neither: pixdim alone */
    v = must_read_volume(&b, 1, NULL);
    assert_row(&v, 0, 0.5, 0, 0, 0);
    assert_row(&v, 2, 0, 0, 2, 0);
    assert_true(volume_warns(&v, "no orientation"));
    io_volume_free(&v);
    buffer_free(&b);
}

static void nifti_units(void **state) {
    (void)state;
    buffer b = make_nifti((nifti){1, false, 16, 0, 2, FIFTH_AXIS, 0, false});
    b.data[123] = 3 + 16; /* micrometres, milliseconds */
    io_volume v = must_read_volume(&b, 1, NULL);
    assert_true(fabs(v.to_mm[0][0] - 0.0005) < 1e-9 && fabs(v.time_step - 0.04) < 1e-6);
    io_volume_free(&v);
    b.data[123] = 1 + 24; /* metres, microseconds */
    v = must_read_volume(&b, 1, NULL);
    assert_true(fabs(v.to_mm[2][2] - 2000) < 1e-6 && fabs(v.time_step - 4e-5) < 1e-9);
    io_volume_free(&v);
    b.data[123] = 0; /* neither told */
    must_fail_volume(&b, 1, NULL, 0, "--time-step");
    io_volume_options options = none;
    options.period = 80;
    v = must_read_volume(&b, 1, &options);
    assert_true(volume_warns(&v, "no unit of length"));
    assert_true(fabs(v.time_step - 40) < 1e-9);
    io_volume_free(&v);
    options.time_step = 30;
    must_fail_volume(&b, 1, &options, 0, "give one of --period and --time-step");
    options.time_step = 40;
    v = must_read_volume(&b, 1, &options);
    io_volume_free(&v);
    buffer_free(&b);
}

static void nifti_scaling_and_broken_values(void **state) {
    (void)state;
    buffer b = make_nifti((nifti){1, false, 16, 0, 1, FIFTH_AXIS, 0, false});
    put_f32_at(&b, 112, 2);
    put_f32_at(&b, 116, 0.25);
    io_volume v = must_read_volume(&b, 1, NULL);
    assert_true(fabs((double)v.velocity[4] - (2 * sample_velocity(1, 1, 0) + 0.25)) < 1e-6);
    io_volume_free(&v);
    put_f32_at(&b, 112, NAN); /* as 0: no scaling */
    put_f32_at(&b, 352 + 4 * (VOXELS + 7), NAN);
    put_f32_at(&b, 352 + 4 * 9, INFINITY);
    v = must_read_volume(&b, 1, NULL);
    assert_true(volume_warns(&v, "2 voxels have a velocity that is not finite"));
    assert_non_null(v.mask);
    for (size_t i = 0; i < VOXELS; i++)
        assert_int_equal(v.mask[i], i != 7 && i != 9);
    assert_true(v.velocity[21] == 0 && v.velocity[22] == 0 && v.velocity[23] == 0);
    assert_true(v.mask_voxels == VOXELS - 2);
    io_volume_free(&v);
    put_f32_at(&b, 112, 0); /* speeds beyond blood's */
    put_f32_at(&b, 352, 2000);
    v = must_read_volume(&b, 1, NULL);
    assert_true(volume_warns(&v, "--unit tells"));
    io_volume_free(&v);
    io_volume_options options = none;
    options.unit = "cm/s";
    v = must_read_volume(&b, 1, &options);
    assert_false(volume_warns(&v, "--unit"));
    assert_true(fabs((double)v.velocity[0] - 20) < 1e-5);
    assert_true(fabs((double)v.velocity[1] - sample_velocity(0, 1, 0) / 100) < 1e-6);
    io_volume_free(&v);
    options.unit = "mm/s";
    v = must_read_volume(&b, 1, &options);
    assert_true(fabs((double)v.velocity[0] - 2) < 1e-5);
    io_volume_free(&v);
    options.unit = "km/h";
    must_fail_volume(&b, 1, &options, 0, "--unit m/s, cm/s or mm/s");
    buffer_free(&b);
}

static void nifti_refusals(void **state) {
    (void)state;
    buffer b = make_nifti((nifti){1, false, 16, 0, 1, FIFTH_AXIS, 0, true}), changed;
    static const struct {
        size_t at;
        uint64_t bits;
        unsigned size;
        const char *word;
    } cases[] = {
        {76 + 4, 0, 4, "--spacing"},          /* a pixdim of 0 */
        {76 + 8, 0x7FC00000, 4, "--spacing"}, /* NaN */
        {70, 32, 2, "COMPLEX64"},
        {70, 128, 2, "RGB24"},
        {345, 'i', 1, "pair"},
        {42, 0, 2, "axis 1"},
        {42, 0xFFFF, 2, "header is damaged"},
        {46, 0x7FFF, 2, "ends too early"},
        {48, 2, 2, "ends too early"},
        {52, 2, 2, "axis 6"},
        {40, 2, 2, "axes"},
        {108, 0x7F800000, 4, "values at byte inf"},
        {108, 0x43000000, 4, "values at byte 128"}, /* inside the header */
        {50, 2, 2, "velocity has 3"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        memset(&changed, 0, sizeof changed);
        put(&changed, b.data, b.size);
        if (cases[i].at == 52)
            patch_bytes(&changed, 40, 6, 2);
        patch_bytes(&changed, cases[i].at, cases[i].bits, cases[i].size);
        if (!strcmp(cases[i].word, "velocity has 3")) {
            io_volume_options options = none;
            options.names = "values";
            must_fail_volume(&changed, 1, &options, 0, cases[i].word);
        } else {
            must_fail_volume(&changed, 1, NULL, 0, cases[i].word);
        }
        buffer_free(&changed);
    }
    buffer_free(&b);
}

/* Three scalar files are components, whatever their order of bytes; one is none. */
static void components_in_files(void **state) {
    (void)state;
    buffer files[MOST_FILES] = {{0}};
    for (unsigned k = 0; k < 3; k++)
        files[k] = make_nifti((nifti){1, false, 16, 0, 1, ONE_COMPONENT, k, false});
    must_fail_volume(files, 1, NULL, 0, "no velocity");
    must_fail_volume(files, 2, NULL, 0, "all three components");
    files[2].data[44] = 2; /* another size */
    must_fail_volume(files, 3, NULL, 2, "the first file has 4 x 3 x 2");
    buffer_free(&files[2]);
    files[2] = make_nifti((nifti){1, false, 16, 0, 2, ONE_COMPONENT, 2, false});
    must_fail_volume(files, 3, NULL, 0, "as many frames");
    free_files(files);
    buffer b = make_nifti((nifti){1, false, 16, 0, 1, FOURTH_AXIS, 0, false});
    patch_bytes(&b, 68, 0, 2); /* the intent is not told: the frames are guessed to be components */
    io_volume v = must_read_volume(&b, 1, NULL);
    assert_true(volume_warns(&v, "three frames are taken"));
    assert_volume(&v, 1, false, true);
    io_volume_free(&v);
    buffer_free(&b);
}
#endif

static void vti_grid(void **state) {
    (void)state;
    buffer b = make_vti(VTI_RAW, false, true, 0,
                        "WholeExtent=\"3 6 0 2 -1 0\" Origin=\"1 2 3\" Spacing=\"0.5 1 2\" "
                        "Direction=\"0 -1 0 1 0 0 0 0 1\"");
    io_volume v = must_read_volume(&b, 1, NULL);
    assert_row(&v, 0, 0, -1, 0, 1);
    assert_row(&v, 1, 0.5, 0, 0, 2 + 1.5);
    assert_row(&v, 2, 0, 0, 2, 3 - 2);
    io_volume_free(&v);
    buffer_free(&b);
    static const char *const heads[][2] = {
        {"WholeExtent=\"3 6 0 2 -1 0\" Origin=\"1 2 3\"", "--spacing"},
        {"WholeExtent=\"3 6 0 2 -1 0\" Spacing=\"0.5 0 2\"", "--spacing"},
        {"WholeExtent=\"3 6 0 2 -1 0\" Spacing=\"0.5 1\"", "broken Spacing"},
        {"WholeExtent=\"3 6 0 2 -1 0\" Spacing=\"0.5 x 2\"", "broken Spacing"},
        {"WholeExtent=\"3 6 0 2 -1 0\" Spacing=\"1 1 1\" Direction=\"1 0 0 0 1 0 nan 0 1\"",
         "no orientation"},
        {"WholeExtent=\"3 6 0 2 -1 0\" Spacing=\"1 1 1\" Direction=\"1 0 0 1 0 0 0 0 1\"",
         "no orientation"},
        {"WholeExtent=\"3 6 0 2 -1 0\" Spacing=\"1 inf 1\"", "broken Spacing"},
        {"WholeExtent=\"3 6 0 2 -1 0\" Spacing=\"1 1 1\" Origin=\"nan 0 0\"", "broken Origin"},
        {"WholeExtent=\"3 2 0 2 -1 0\" Spacing=\"1 1 1\"", "empty extent"},
        {"WholeExtent=\"0 1 0 2 -1 0\" Spacing=\"1 1 1\"", "not within the WholeExtent"},
        {"WholeExtent=\"3 7 0 2 -1 0\" Spacing=\"1 1 1\"", "24 voxels in its Pieces"},
        {"WholeExtent=\"0 2e9 0 2e9 -1 0\" Spacing=\"1 1 1\"", "voxels"},
        {"WholeExtent=\"0.5 6 0 2 -1 0\" Spacing=\"1 1 1\"", "whole numbers"},
        {"Spacing=\"1 1 1\"", "WholeExtent"},
    };
    for (size_t i = 0; i < sizeof heads / sizeof heads[0]; i++) {
        b = make_vti(VTI_RAW, false, true, 0, heads[i][0]);
        must_fail_volume(&b, 1, NULL, 0, heads[i][1]);
        buffer_free(&b);
    }
    b = make_vti(VTI_RAW, false, true, 0, heads[0][0]);
    io_volume_options options = none;
    options.guess = true;
    v = must_read_volume(&b, 1, &options);
    assert_row(&v, 1, 0, 1, 0, 2);
    assert_true(volume_warns(&v, "--spacing gives it"));
    io_volume_free(&v);
    options.spacing[0] = options.spacing[1] = options.spacing[2] = 3;
    v = must_read_volume(&b, 1, &options);
    assert_row(&v, 1, 0, 3, 0, 2);
    io_volume_free(&v);
    buffer_free(&b);
}

/* Parts of a grid, and values in its cells, in text that shows what is meant. */
static void vti_pieces_and_cells(void **state) {
    (void)state;
    buffer b = {0};
    put_text(&b, "<VTKFile type='ImageData'><ImageData WholeExtent='0 1 0 1 0 1' Origin='0 0 0' "
                 "Spacing='1 1 1'>"
                 "<Piece Extent='0 1 0 1 0 0'><PointData><DataArray type='Float32' Name='a' "
                 "NumberOfComponents='3'>0 0 0 1 0 0 2 0 0 3 0 0</DataArray></PointData></Piece>"
                 "<Piece Extent='0 1 0 1 1 1'><PointData><DataArray type='Float32' Name='a' "
                 "NumberOfComponents='3'>4 0 0 5 0 0 6 0 0 7 0 0</DataArray></PointData></Piece>"
                 "</ImageData></VTKFile>");
    io_volume v = must_read_volume(&b, 1, NULL);
    for (int i = 0; i < 8; i++)
        assert_true(v.velocity[3 * i] == (float)i);
    io_volume_free(&v);
    buffer_free(&b);
    put_text(&b, "<VTKFile type='ImageData'><ImageData WholeExtent='0 2 0 1 0 1' Origin='0 0 0' "
                 "Spacing='2 2 2'><Piece Extent='0 2 0 1 0 1'><PointData/><CellData><DataArray "
                 "type='Float32' Name='a' NumberOfComponents='3'>1 0 0 2 0 0</DataArray>"
                 "</CellData></Piece></ImageData></VTKFile>");
    v = must_read_volume(&b, 1, NULL);
    assert_int_equal(v.size[0], 2);
    assert_int_equal(v.size[1], 1);
    assert_row(&v, 0, 2, 0, 0, 1); /* cell centres */
    assert_row(&v, 2, 0, 0, 2, 1);
    assert_true(v.velocity[0] == 1 && v.velocity[3] == 2);
    io_volume_free(&v);
    buffer_free(&b);
}

/* ---- Arrays ---------------------------------------------------------------------------------- */

/* ASCII VTK of two voxels with these array announcements, all values 1 2 3 .... */
static buffer points_with(const char *arrays) {
    buffer b = {0};
    put_text(&b, "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 "
                 "1\nSPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 2\n");
    put_text(&b, arrays);
    return b;
}

static void names_pick_arrays(void **state) {
    (void)state;
    io_volume_options options = none;
    buffer b = points_with("VECTORS a float\n1 2 3 4 5 6\nVECTORS b float\n7 8 9 10 11 12\n"
                           "SCALARS s float\nLOOKUP_TABLE default\n0 1\n"
                           "SCALARS t float\nLOOKUP_TABLE default\n5 6\n");
    must_fail_volume(&b, 1, NULL, 0, "a[3], b[3], s, t; pick one with --names");
    options.names = "b";
    io_volume v = must_read_volume(&b, 1, &options);
    assert_true(v.velocity[0] == 7 && v.velocity[5] == 12 && !v.mask);
    assert_int_equal(v.array_count, 4);
    assert_string_equal(v.arrays[2], "s");
    io_volume_free(&v);
    options.names = "A,s";
    v = must_read_volume(&b, 1, &options);
    assert_true(v.velocity[0] == 1 && v.mask && !v.mask[0] && v.mask[1]);
    assert_true(v.mask_voxels == 1);
    io_volume_free(&v);
    options.names = "t,s,t,s";
    v = must_read_volume(&b, 1, &options);
    assert_true(v.velocity[0] == 5 && v.velocity[1] == 0 && v.velocity[5] == 6 && !v.mask[0]);
    io_volume_free(&v);
    static const char *const wrong[][2] = {
        {"q", "no array 'q'; its arrays are: a[3], b[3], s, t; --names"},
        {"s", "has 1 values per voxel"},
        {"a,b,s", "1 value and as many"},
        {"a,q", "no array 'q'"},
        {"a,b", "a mask has 1"},
        {"a,,b", "write velocity"},
        {"a,b,c,d,e", "write velocity"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        options.names = wrong[i][0];
        must_fail_volume(&b, 1, &options, 0, wrong[i][1]);
    }
    options.names = "a";
    options.mask = "q";
    must_fail_volume(&b, 1, &options, 0, "--mask picks");
    options.mask = "s";
    v = must_read_volume(&b, 1, &options);
    assert_true(v.mask_voxels == 1);
    io_volume_free(&v);
    buffer_free(&b);
    b = points_with("VECTORS gradient float\n1 2 3 4 5 6\nVECTORS Velocity float\n7 8 9 10 11 12\n"
                    "SCALARS segmentation float\nLOOKUP_TABLE default\n0 0\n");
    v = must_read_volume(&b, 1, NULL); /* called velocity: no doubt */
    assert_true(v.velocity[0] == 7 && v.mask_voxels == 0);
    assert_true(volume_warns(&v, "mask is empty"));
    assert_true(v.speed[0] == 0 && v.speed[1] == 0);
    io_volume_free(&v);
    buffer_free(&b);
}

static void masks_in_files(void **state) {
    (void)state;
    buffer b = points_with("VECTORS a float\n1 2 3 4 5 6\n");
    buffer mask = points_with("SCALARS any float\nLOOKUP_TABLE default\n0.4 0.6\n");
    buffer other = make_points(false);
    const char *path = "volume_mask.vtk";
    io_volume_options options = none;
    options.mask_file = path;
    write_file(path, &mask);
    io_volume v = must_read_volume(&b, 1, &options);
    assert_true(v.mask && !v.mask[0] && v.mask[1]);
    io_volume_free(&v);
    write_file(path, &other);
    must_fail_volume(&b, 1, &options, 1, "the first file has 2 x 1 x 1");
    write_file(path, &b);
    must_fail_volume(&b, 1, &options, 1, "cannot be a mask");
    remove(path);
    must_fail_volume(&b, 1, &options, 1, "cannot be opened");
    buffer_free(&b);
    buffer_free(&mask);
    buffer_free(&other);
}

#ifdef LINEAO_HAVE_HDF5
static void hdf5_rules(void **state) {
    (void)state;
    buffer b = make_hdf5((hdf5_spec){true, false, false, false, false, false, false, 2});
    io_volume_options options = none;
    options.time_step = sample_step;
    must_fail_volume(&b, 1, &options, 0, "--spacing");
    memcpy(options.spacing, sample_spacing, sizeof options.spacing);
    io_volume v = must_read_volume(&b, 1, &options);
    assert_volume(&v, 2, false, false);
    io_volume_free(&v);
    options.time_step = 0;
    must_fail_volume(&b, 1, &options, 0, "--time-step");
    options.guess = true;
    v = must_read_volume(&b, 1, &options);
    assert_true(v.period == 2 && volume_warns(&v, "--time-step gives it"));
    io_volume_free(&v);
    options.period = 80;
    options.names = "w,u,v";
    v = must_read_volume(&b, 1, &options);
    assert_true(fabs((double)v.velocity[0] - sample_velocity(0, 2, 0)) < 1e-6);
    io_volume_free(&v);
    buffer_free(&b);
}
#endif

static void what_is_no_volume(void **state) {
    (void)state;
    buffer b = {0};
    must_fail_volume(&b, 1, NULL, 0, "empty");
    must_fail_volume(&b, 0, NULL, 0, "no file");
    put_text(&b, "hello");
    must_fail_volume(&b, 1, NULL, 0, "not a volume");
    buffer_free(&b);
    b = make_vtk(false, false);
    must_fail_volume(&b, 1, NULL, 0, "not a volume");
    buffer_free(&b);
    b = make_vti(VTI_RAW, false, true, 0, NULL); /* and no line reader takes one */
    must_fail(&b, "a.vti", NULL, "are read from PolyData");
    buffer_free(&b);
    b = make_points(true);
    must_fail(&b, "a.vtk", NULL, "are read from POLYDATA");
    buffer_free(&b);
    io_volume zero = {0};
    io_volume_free(&zero);
    io_volume_free(NULL);
}

static bool cancel(void *user, uint64_t done, uint64_t total) {
    uint64_t *last = user;
    assert_true(done <= total && done >= *last);
    *last = done;
    return done * 2 > total;
}

static void progress_rises_and_cancels(void **state) {
    (void)state;
    buffer files[MOST_FILES] = {{0}};
    uint64_t last = 0;
    io_volume_options options = none;
    options.progress = cancel;
    options.user = &last;
    options.time_step = 1;
    files[0] = make_vti(VTI_RAW, false, true, 0, NULL);
    files[1] = make_vti(VTI_RAW, false, true, 1, NULL);
    must_fail_volume(files, 2, &options, 0, "cancelled");
    free_files(files);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_numbers_from_every_format),
        cmocka_unit_test(files_are_known_by_content),
#ifdef LINEAO_HAVE_NIFTI
        cmocka_unit_test(nifti_orientation),
        cmocka_unit_test(nifti_units),
        cmocka_unit_test(nifti_scaling_and_broken_values),
        cmocka_unit_test(nifti_refusals),
        cmocka_unit_test(components_in_files),
#endif
        cmocka_unit_test(vti_grid),
        cmocka_unit_test(vti_pieces_and_cells),
        cmocka_unit_test(names_pick_arrays),
        cmocka_unit_test(masks_in_files),
#ifdef LINEAO_HAVE_HDF5
        cmocka_unit_test(hdf5_rules),
#endif
        cmocka_unit_test(what_is_no_volume),
        cmocka_unit_test(progress_rises_and_cancels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
