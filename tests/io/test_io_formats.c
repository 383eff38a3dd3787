/* Each pitfall of the line formats that real files have is met: one synthetic file for each. */
#include "samples.h"

#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double position(const io_lines *lines, size_t point, unsigned axis) {
    return (double)lines->points[3 * point + axis] + lines->origin[axis];
}

static void assert_point(const io_lines *lines, size_t point, double x, double y, double z) {
    const double expected[3] = {x, y, z};
    for (unsigned axis = 0; axis < 3; axis++)
        if (!(fabs(position(lines, point, axis) - expected[axis]) < 1e-4))
            fail_msg("point %zu axis %u is %g, not %g", point, axis, position(lines, point, axis),
                     expected[axis]);
}

static io_lines read_text(const char *text, const char *name) {
    buffer b = {0};
    put_text(&b, text);
    io_lines lines = must_read(&b, name, NULL);
    buffer_free(&b);
    return lines;
}

static void fail_text(const char *text, const char *word) {
    buffer b = {0};
    put_text(&b, text);
    must_fail(&b, NULL, NULL, word);
    buffer_free(&b);
}

/* ---- TRK ------------------------------------------------------------------------------------- */

/* voxel mm -> RAS by hand: header order LPS, matrix RAS, voxels of 1 3 2 mm in a 4 x 5 x 7 volume.
 */
static void trk_voxel_order_flips(void **state) {
    (void)state;
    buffer b = make_trk(false, SAMPLE_LINES);
    const unsigned dim[3] = {4, 5, 7};
    const double size[3] = {1, 3, 2};
    for (unsigned i = 0; i < 3; i++) {
        b.data[6 + 2 * i] = (uint8_t)dim[i];
        patch_f32(&b, 12 + 4 * i, size[i]);
        patch_f32(&b, 440 + 20 * i, size[i]);
        patch_f32(&b, 440 + 16 * i + 12, 100);
    }
    memcpy(b.data + 948, "LPS", 3);
    io_lines lines = must_read(&b, NULL, NULL);
    for (size_t k = 0; k < SAMPLE_POINTS; k++) {
        double x = sample_position(k, 0) + 0.5, y = sample_position(k, 1) + 0.5,
               z = sample_position(k, 2) + 0.5;
        assert_point(&lines, k, 100 + 1 * (3 - (x / 1 - 0.5)), 100 + 3 * (4 - (y / 3 - 0.5)),
                     100 + 2 * (z / 2 - 0.5));
    }
    io_lines_free(&lines);
    memset(b.data + 948, 0, 4); /* no order means LPS */
    lines = must_read(&b, NULL, NULL);
    assert_point(&lines, 0, 100 + 3 - (sample_position(0, 0)),
                 100 + 3 * (4 - ((sample_position(0, 1) + 0.5) / 3 - 0.5)),
                 100 + 2 * ((sample_position(0, 2) + 0.5) / 2 - 0.5));
    assert_int_equal(lines.warning_count, 0);
    io_lines_free(&lines);
    memcpy(b.data + 948, "XYZ", 3);
    lines = must_read(&b, NULL, NULL);
    assert_true(has_warning(&lines, "voxel_order"));
    io_lines_free(&lines);
    memcpy(b.data + 948, "ASR", 3); /* a permutation keeps each point on its own axis system */
    lines = must_read(&b, NULL, NULL);
    assert_int_equal(lines.warning_count, 0);
    io_lines_free(&lines);
    buffer_free(&b);
}

/* Axes swapped: header ARS, matrix RAS; the first stored coordinate is A. */
static void trk_voxel_order_permutes(void **state) {
    (void)state;
    buffer b = make_trk(true, SAMPLE_LINES);
    memcpy(b.data + 948, "ARS", 3);
    io_lines lines = must_read(&b, NULL, NULL);
    for (size_t k = 0; k < SAMPLE_POINTS; k++)
        assert_point(&lines, k, sample_position(k, 1), sample_position(k, 0),
                     sample_position(k, 2));
    io_lines_free(&lines);
    buffer_free(&b);
}

static void trk_half_voxel_is_an_option(void **state) {
    (void)state;
    buffer b = make_trk(false, SAMPLE_LINES);
    io_options options = {.trk_no_half_voxel = true};
    io_lines lines = must_read(&b, NULL, &options);
    assert_point(&lines, 0, sample_position(0, 0) + 0.5, sample_position(0, 1) + 0.5,
                 sample_position(0, 2) + 0.5);
    io_lines_free(&lines);
    buffer_free(&b);
}

static void trk_without_matrix_stays_in_voxels(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        buffer b = make_trk(false, SAMPLE_LINES);
        if (i == 0)
            patch_f32(&b, 440 + 60, 0); /* not recorded */
        else if (i == 1)
            patch_f32(&b, 440 + 20, 0); /* singular */
        else
            patch_f32(&b, 440 + 20, NAN);
        io_lines lines = must_read(&b, NULL, NULL);
        assert_true(has_warning(&lines, "vox_to_ras"));
        assert_point(&lines, 0, sample_position(0, 0), sample_position(0, 1),
                     sample_position(0, 2));
        io_lines_free(&lines);
        buffer_free(&b);
    }
}

static void trk_voxel_size_zero_is_guarded(void **state) {
    (void)state;
    const double sizes[] = {0, NAN, -1, INFINITY};
    for (size_t i = 0; i < 4; i++) {
        buffer b = make_trk(false, SAMPLE_LINES);
        patch_f32(&b, 16, sizes[i]);
        io_lines lines = must_read(&b, NULL, NULL);
        assert_true(has_warning(&lines, "voxel_size"));
        assert_point(&lines, 7, sample_position(7, 0), sample_position(7, 1),
                     sample_position(7, 2));
        io_lines_free(&lines);
        buffer_free(&b);
    }
}

static void trk_counts(void **state) {
    (void)state;
    buffer b = make_trk(false, 0);
    io_lines lines = must_read(&b, NULL, NULL); /* unknown: to the end */
    assert_sample(&lines, true, false);
    io_lines_free(&lines);
    patch_u32(&b, 988, 2);
    lines = must_read(&b, NULL, NULL);
    assert_int_equal(lines.line_count, 2);
    assert_true(has_warning(&lines, "behind the last line"));
    io_lines_free(&lines);
    patch_u32(&b, 988, 4);
    must_fail(&b, NULL, NULL, "promises 4");
    patch_u32(&b, 988, (uint32_t)-5);
    lines = must_read(&b, NULL, NULL);
    assert_int_equal(lines.line_count, 3);
    io_lines_free(&lines);
    patch_u32(&b, 1000, 0x7FFFFFFF); /* a hostile number of points */
    must_fail(&b, NULL, NULL, "0 lines are whole");
    patch_u32(&b, 1000, 0xFFFFFFFF);
    must_fail(&b, NULL, NULL, "negative");
    patch_u32(&b, 996, 999);
    must_fail(&b, NULL, NULL, "hdr_size");
    buffer_free(&b);
}

static void trk_points_not_finite_are_dropped(void **state) {
    (void)state;
    buffer b = make_trk(false, SAMPLE_LINES);
    patch_f32(&b, 1004, NAN);                   /* the only point of line 0 */
    patch_f32(&b, 1004 + 28 + 4 + 4, INFINITY); /* the first of line 1 */
    io_lines lines = must_read(&b, NULL, NULL);
    assert_int_equal(lines.line_count, 2);
    assert_int_equal(lines.point_count, 6);
    assert_true(has_warning(&lines, "2 points were left out"));
    assert_true(has_warning(&lines, "1 lines were left out"));
    assert_true(line_attribute(&lines, "w")->data[0] == (float)sample_weight(1));
    assert_true(point_attribute(&lines, "s")->data[0] == (float)sample_scalar(2));
    io_lines_free(&lines);
    buffer_free(&b);
}

static void trk_unnamed_scalars_are_kept(void **state) {
    (void)state;
    buffer b = make_trk(false, SAMPLE_LINES);
    memset(b.data + 38 + 20, 0, 20); /* the vector loses its name */
    io_lines lines = must_read(&b, NULL, NULL);
    assert_int_equal(point_attribute(&lines, "scalars")->components, 3);
    assert_true(point_attribute(&lines, "scalars")->data[3 * 7 + 2] == (float)sample_vector(7, 2));
    io_lines_free(&lines);
    memcpy(b.data + 38 + 20, "\xFF\x01v", 3); /* a name that is no text */
    lines = must_read(&b, NULL, NULL);
    assert_non_null(point_attribute(&lines, "\?\?v"));
    io_lines_free(&lines);
    buffer_free(&b);
}

/* ---- TCK ------------------------------------------------------------------------------------- */

static buffer tck_of(const char *head, size_t offset, const double *values, size_t count) {
    buffer b = {0};
    put_text(&b, head);
    while (b.size < offset)
        put_u8(&b, ' ');
    for (size_t i = 0; i < count; i++)
        put_f32(&b, values[i]);
    return b;
}

#define ROW(v) v, v, v
static const double one_line[] = {1, 2, 3, 4, 5, 6, ROW(NAN), ROW(INFINITY)};

static void tck_offset_rules(void **state) {
    static const struct {
        const char *head, *warning; /* NULL: none */
    } heads[] = {
        {"mrtrix tracks\ndatatype: Float32LE\nfile: . 100\nEND\n", NULL},
        {"mrtrix tracks\ndatatype: Float32LE\nfile: . 100\nEND ",
         NULL}, /* a blank, not a line end */
        {"mrtrix tracks    \r\ndatatype: Float32LE\r\nfile: . 100\r\nEND\r\n", NULL},
        {"mrtrix tracks\ndatatype: Float32LE\nfile: . 100\n", "no END"},
        {"mrtrix tracks\nfile: . 100\ndatatype: Float32LE\nfile: . 7\ndatatype: Int8\nEND\n",
         NULL}, /* the first counts */
        {"mrtrix tracks\ndatatype: Float32LE\ncount: 615000\nfile: . 100\nEND\n", "615000"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof heads / sizeof heads[0]; i++) {
        buffer b = tck_of(heads[i].head, 100, one_line, 12);
        io_lines lines = must_read(&b, NULL, NULL);
        assert_int_equal(lines.line_count, 1);
        assert_point(&lines, 1, 4, 5, 6);
        assert_int_equal(lines.warning_count, heads[i].warning ? 1 : 0);
        assert_true(!heads[i].warning || has_warning(&lines, heads[i].warning));
        io_lines_free(&lines);
        buffer_free(&b);
    }
    /* an offset inside the header, or none at all: behind END */
    const char *wrong[] = {"mrtrix tracks\ndatatype: Float32LE\nfile: . 20\nEND\n",
                           "mrtrix tracks\ndatatype: Float32LE\nEND\n"};
    for (size_t i = 0; i < 2; i++) {
        buffer b = tck_of(wrong[i], 0, one_line, 12);
        io_lines lines = must_read(&b, NULL, NULL);
        assert_int_equal(lines.point_count, 2);
        assert_true(has_warning(&lines, "offset"));
        io_lines_free(&lines);
        buffer_free(&b);
    }
}

static void tck_header_errors(void **state) {
    (void)state;
    fail_text("mrtrix tracks\ndatatype: Float32LE\nfile: . 1000\nEND\n", "byte 1000");
    fail_text("mrtrix tracks\ndatatype: Int32LE\nfile: . 10\nEND\n", "Int32LE");
    fail_text("mrtrix tracks\nfile: . 10\nEND\n", "datatype");
    fail_text("mrtrix tracks\ndatatype: Float32LE\nfile: other.dat 0\nEND\n", "another file");
    fail_text("mrtrix tracks\ndatatype: Float32LE\n", "without END");
}

static void tck_ends(void **state) {
    static const double empties[] = {ROW(NAN), ROW(NAN),       1, 2, 3, ROW(NAN), ROW(NAN), 4, 5,
                                     6,        ROW(-INFINITY), 7, 8, 9};
    const char *head = "mrtrix tracks\ndatatype: Float32LE\nfile: . 60\nEND\n";
    (void)state;
    buffer b = tck_of(head, 60, empties, sizeof empties / sizeof empties[0]);
    patch_u32(&b, 60, 0xFFC00000); /* another NaN */
    io_lines lines = must_read(&b, NULL, NULL);
    assert_int_equal(
        lines.line_count,
        2); /* the last line needs no NaN before the end mark; what follows is not read */
    assert_int_equal(lines.warning_count, 0);
    io_lines_free(&lines);
    buffer_free(&b);
    b = tck_of(head, 60, one_line, 9); /* no end mark */
    lines = must_read(&b, NULL, NULL);
    assert_int_equal(lines.line_count, 1);
    assert_true(has_warning(&lines, "end mark"));
    io_lines_free(&lines);
    buffer_free(&b);
}

static void wrong_byte_order_is_noticed(void **state) {
    (void)state;
    buffer b = make_tck("Float32BE", false, false);
    must_fail(&b, NULL, NULL, NULL); /* NaN and infinity are not found */
    buffer_free(&b);
    io_lines lines =
        read_text("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n"
                  "1e20 0 0 2 3 4\nLINES 1 3 2 0 1\n",
                  NULL);
    assert_true(has_warning(&lines, "byte order"));
    io_lines_free(&lines);
}

/* ---- VTK ------------------------------------------------------------------------------------- */

#define VTK(mode) "# vtk DataFile Version 4.2\nany title\n" mode "\nDATASET POLYDATA\n"
#define TRIANGLE VTK("ASCII") "POINTS 3 float\n0 0 0 1 0 0 1 1 0\nLINES 2 6\n2 2 0\n2 1 1\n"

static void vtk_ascii_numbers(void **state) {
    (void)state;
    io_lines lines =
        read_text(VTK("ascii") "points 6 float\n+1.5e1 -.5 1E-45\n nan 1.#QNAN -1.#IND\n 1 -inf 2\n"
                               "1.#INF 0 0\n123456789012345678901234567890 0 0\n0.1 1d2 "
                               "00000.00000000000000000000001\n"
                               "lines 1 7 6 0 1 2 3 4 5\n",
                  NULL);
    assert_int_equal(lines.point_count, 3);
    assert_true(has_warning(&lines, "3 points"));
    assert_true(position(&lines, 0, 0) == 15 && position(&lines, 0, 1) == -0.5);
    assert_true(position(&lines, 0, 2) == (double)1e-45f);
    assert_true(position(&lines, 1, 0) == (double)1.2345679e29f);
    assert_true(position(&lines, 2, 0) == (double)0.1f && position(&lines, 2, 1) == 100);
    io_lines_free(&lines);
    const char *wrong[] = {"1,5", "1e", "e5", "--1",     "0x10", "1.2.3",
                           "1f",  ".",  "-",  "infinit", "\xFF"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, VTK("ASCII") "POINTS 1 float\n0 %s 0\n", wrong[i]);
        fail_text(text, "not a number");
    }
}

/* A locale with a decimal comma must not matter; the test says so when the system has none. */
static void locale_does_not_matter(void **state) {
    (void)state;
    const char *found = setlocale(LC_ALL, "de_DE.UTF-8");
    if (!found)
        print_message(
            "no locale with a decimal comma here; the reader is tested in the one there is\n");
    io_lines lines =
        read_text(VTK("ASCII") "POINTS 1 float\n1.5 2.25 3.125\nLINES 1 2 1 0\n", NULL);
    assert_point(&lines, 0, 1.5, 2.25, 3.125);
    io_lines_free(&lines);
    setlocale(LC_ALL, "C");
}

static void vtk_indices_are_resolved(void **state) {
    (void)state;
    io_lines lines = read_text(TRIANGLE "CELL_DATA 2\nSCALARS c int 1\nLOOKUP_TABLE default\n7 8\n"
                                        "POINT_DATA 3\nSCALARS p double\n10 11 12\n",
                               NULL);
    assert_int_equal(lines.line_count, 2);
    assert_int_equal(lines.point_count, 4);
    assert_point(&lines, 0, 1, 1, 0);
    assert_point(&lines, 3, 1, 0, 0);
    assert_true(point_attribute(&lines, "p")->data[0] == 12 &&
                point_attribute(&lines, "p")->data[1] == 10);
    assert_true(line_attribute(&lines, "c")->data[1] == 8);
    io_lines_free(&lines);
}

static void vtk_arrays_of_all_kinds(void **state) {
    (void)state;
    io_lines lines =
        read_text(TRIANGLE "POINT_DATA 3\n"
                           "SCALARS Fractional%20Anisotropy%zz unsigned_char 2\nLOOKUP_TABLE my\n1 "
                           "2 3 4 5 6\nLOOKUP_TABLE my 2\n0 0 0 1 1 1 1 1\n"
                           "COLOR_SCALARS rgb 3\n0 .5 1 0 .5 1 0 .5 1\nNORMALS n float\n1 0 0 0 1 "
                           "0 0 0 1\nTENSORS t float\n"
                           "1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 "
                           "90\n\nTEXTURE_COORDINATES uv 2 float\n0 1 2 3 4 5\n"
                           "METADATA\nCOMPONENT_NAMES\nu\nv\n\nFIELD f 4\nNULL_ARRAY\nwords 1 3 "
                           "string\none\ntwo words\nthree\nflags 1 3 bit\n1 0 1\n"
                           "METADATA\nINFORMATION 0\n\nlast 1 3 vtktypeint64\n-4 -5 -6\n",
                  NULL);
    assert_int_equal(lines.warning_count, 0);
    assert_int_equal(point_attribute(&lines, "Fractional Anisotropy%zz")->components, 2);
    assert_true(point_attribute(&lines, "Fractional Anisotropy%zz")->data[1] == 6);
    assert_true(point_attribute(&lines, "rgb")->data[1] == 0.5f);
    assert_true(point_attribute(&lines, "t")->data[8] == 90);
    assert_true(point_attribute(&lines, "n")->data[2] == 1);
    assert_true(point_attribute(&lines, "uv")->data[0] == 4);
    assert_true(point_attribute(&lines, "last")->data[0] == -6);
    io_lines_free(&lines);
}

static void vtk_binary_details(void **state) {
    (void)state;
    buffer b = {NULL, 0, 0, true};
    put_text(
        &b, VTK("BINARY") "POINTS 2 float       \r\n"); /* blanks and a return before the numbers */
    for (int i = 0; i < 6; i++)
        put_f32(&b, i);
    put_text(&b, "LINES 1 3\n"); /* no line end behind the numbers */
    put_u32(&b, 2);
    put_u32(&b, 1);
    put_u32(&b, 0);
    put_text(&b, "\nPOINT_DATA 2\nSCALARS a short\n"); /* no LOOKUP_TABLE */
    put_u16(&b, 0xFFFF);
    put_u16(&b, 0x0A0A); /* looks like line ends */
    put_text(&b, "\nCOLOR_SCALARS c 1\n\n\x80\nSCALARS l long 1\nLOOKUP_TABLE default\n");
    put_u64(&b, 1);
    put_u64(&b, UINT64_MAX);
    put_text(&b, "\nFIELD f 2\ns 1 2 string\n");
    put_text(&b, "\xC1z\xC2zz"); /* lengths of one byte */
    put_text(&b, "\nu 1 2 unsigned_int\n");
    put_u32(&b, 0xFFFFFFFF);
    put_u32(&b, 3);
    io_lines lines = must_read(&b, NULL, NULL);
    assert_int_equal(lines.warning_count, 0);
    assert_point(&lines, 0, 3, 4, 5);
    assert_true(point_attribute(&lines, "a")->data[0] == 0x0A0A &&
                point_attribute(&lines, "a")->data[1] == -1);
    assert_true(point_attribute(&lines, "c")->data[0] == 128 &&
                point_attribute(&lines, "c")->data[1] == 10);
    assert_true(point_attribute(&lines, "l")->data[0] == -1);
    assert_true(point_attribute(&lines, "u")->data[1] == 4294967295.0f);
    io_lines_free(&lines);
    buffer_free(&b);
}

static void vtk_without_lines(void **state) {
    (void)state;
    io_lines lines = read_text(VTK("ASCII") "POINTS 0 float\n", NULL);
    assert_int_equal(lines.line_count, 0);
    assert_int_equal(lines.warning_count, 0);
    io_lines_free(&lines);
    lines = read_text(VTK("ASCII") "POINTS 3 float 0 0 0 1 0 0 0 1 0 POLYGONS 1 4 3 0 1 2\n", NULL);
    assert_true(has_warning(&lines, "polygons"));
    io_lines_free(&lines);
    fail_text("# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n",
              "STRUCTURED_POINTS");
    fail_text("# vtk DataFile Version 3.0\nt\nbase64\n", "third line");
    fail_text("# vtk DataFile Version 3.0\nt\n", "cut");
    fail_text(VTK("ASCII") "POINTS 1 complex\n", "type");
    lines = read_text(TRIANGLE "POINT_DATA 2\nSCALARS a int\n1 2\nHELLO\n", NULL);
    assert_true(has_warning(&lines, "'HELLO' in line 13"));
    assert_true(has_warning(&lines, "2 rows for 3 points"));
    assert_int_equal(lines.point_attribute_count, 0);
    io_lines_free(&lines);
}

/* ---- VTP ------------------------------------------------------------------------------------- */

#define VTP(lines)                                                                                 \
    "\xEF\xBB\xBF<?xml version='1.0' encoding='UTF-8'?>\n<!-- a comment > -->\n<VTKFile "          \
    "type='PolyData'>"                                                                             \
    "<PolyData><FieldData><DataArray type='Float64' Name='TimeValue' "                             \
    "NumberOfTuples='1'>1</DataArray></FieldData>" lines "</PolyData></VTKFile>"
#define LINES(points, ends, indices)                                                               \
    "<Points><DataArray type='Float64' NumberOfComponents='3'>" points "</DataArray></Points>"     \
    "<Lines><DataArray type='Int64' Name='connectivity'>" indices                                  \
    "</DataArray><DataArray type='UInt8' Name='offsets'>" ends "</DataArray></Lines>"

/* Cells of vertices come first in the cell arrays; a name may stand in both sections; entities are
 * decoded. */
static void vtp_cells_and_names(void **state) {
    (void)state;
    io_lines lines = read_text(
        VTP("<Piece NumberOfPoints='3' NumberOfVerts='1' NumberOfLines='2' NumberOfPolys='1'>"
            "<CellData><DataArray type='Int16' Name='a&amp;b'>99 1 2 77</DataArray></CellData>"
            "<PointData><DataArray type='Int16' Name='a&amp;b'>5 6 7</DataArray><DataArray "
            "type='String' Name='t'>1</DataArray>"
            "</PointData>" LINES("0 0 0 1 0 0 2 <!-- text --> 0 0", "2 4",
                                 "2 1 1 <![CDATA[0]]>") "</Piece>"),
        NULL);
    assert_int_equal(lines.line_count, 2);
    assert_int_equal(lines.warning_count, 0);
    assert_true(line_attribute(&lines, "a&b")->data[0] == 1 &&
                line_attribute(&lines, "a&b")->data[1] == 2);
    assert_true(point_attribute(&lines, "a&b")->data[0] == 7 &&
                point_attribute(&lines, "a&b")->data[3] == 5);
    io_lines_free(&lines);
}

/* An array that only one piece has is NaN in the others; empty pieces are stepped over. */
static void vtp_pieces_with_different_arrays(void **state) {
    (void)state;
    io_lines lines = read_text(
        VTP("<Piece NumberOfPoints='0' NumberOfLines='0'/>"
            "<Piece NumberOfPoints='1' NumberOfLines='1'>" LINES(
                "1 2 3", "1",
                "0") "</Piece>"
                     "<Piece NumberOfPoints='1' NumberOfLines='1'><PointData><DataArray "
                     "type='Float32' Name='q'>4</DataArray></PointData>" LINES(
                         "4 5 6", "1", "0") "</Piece>"
                                            "<Piece NumberOfPoints='1' NumberOfLines='1'>" LINES(
                                                "7 8 9", "1", "0") "</Piece>"),
        NULL);
    assert_int_equal(lines.line_count, 3);
    const io_attribute *q = point_attribute(&lines, "q");
    assert_true(isnan(q->data[0]) && q->data[1] == 4 && isnan(q->data[2]));
    io_lines_free(&lines);
}

static void vtp_errors(void **state) {
    (void)state;
    fail_text(VTP("<Piece NumberOfPoints='1' NumberOfLines='1'>" LINES("1 2", "1", "0") "</Piece>"),
              "'unnamed'");
    fail_text(
        VTP("<Piece NumberOfPoints='1' NumberOfLines='1'>" LINES("1 2 3", "1", "1") "</Piece>"),
        "line 1 uses a point");
    fail_text(
        VTP("<Piece NumberOfPoints='1' NumberOfLines='2'>" LINES("1 2 3", "1 0", "0") "</Piece>"),
        "broken end");
    fail_text(VTP("<Piece NumberOfPoints='1' NumberOfLines='1'></Piece>"), "lacks the arrays");
    fail_text("<VTKFile type='UnstructuredGrid'/>", "UnstructuredGrid");
    fail_text("<?xml version='1.0'?><svg/>", "<svg>");
    fail_text("<VTKFile type='PolyData' compressor='vtkLZMADataCompressor'/>",
              "vtkLZMADataCompressor");
    fail_text("<VTKFile type='PolyData'><PolyData>", "XML in line 1");
    fail_text("<VTKFile type='PolyData'><AppendedData encoding='raw'>", "appended data");
}

/* ---- TRX and TT ------------------------------------------------------------------------------ */

typedef struct trx_parts {
    const char *json, *positions, *offsets; /* the arrays' names; values below */
    unsigned point_count, offset_count;
    const uint32_t *offset;
} trx_parts;

static buffer trx_of(trx_parts parts) {
    zip_item items[6] = {{"header.json", {0}},         {parts.positions, {0}},
                         {parts.offsets, {0}},         {"groups/g.uint32", {0}},
                         {"dpg/g/color.3.uint8", {0}}, {"dps/", {0}}};
    put_text(&items[0].content, parts.json);
    for (unsigned i = 0; i < 3 * parts.point_count; i++)
        put_f32(&items[1].content, i);
    for (unsigned i = 0; i < parts.offset_count; i++)
        put_u32(&items[2].content, parts.offset[i]);
    put_u32(&items[3].content, 1);
    put_u32(&items[3].content, 9);
    put_u8(&items[4].content, 0);
    return make_zip(items, 6, true);
}

static io_lines read_trx(trx_parts parts) {
    buffer b = trx_of(parts);
    io_lines lines = must_read(&b, NULL, NULL);
    buffer_free(&b);
    return lines;
}

static void trx_offsets(void **state) {
    (void)state;
    const uint32_t fresh[] = {0, 2, 5}, orphans[] = {0, 2, 4}, unsorted[] = {0, 4, 2},
                   beyond[] = {0, 2, 50};
    trx_parts parts = {"{\"NB_VERTICES\":5,\"NB_STREAMLINES\":2}",
                       "positions.3.float32",
                       "offsets.uint32",
                       5,
                       3,
                       fresh};
    io_lines lines = read_trx(parts);
    assert_int_equal(lines.offsets[2], 5);
    assert_int_equal(lines.groups[0].line_count, 1);
    assert_true(has_warning(&lines, "not in the file")); /* line 9 of the group */
    io_lines_free(&lines);
    parts.offset_count = 2; /* old: the last line is implicit */
    lines = read_trx(parts);
    assert_int_equal(lines.offsets[2], 5);
    io_lines_free(&lines);
    parts.offset_count = 3;
    parts.offset = orphans;
    lines = read_trx(parts);
    assert_int_equal(lines.offsets[2], 4);
    assert_true(has_warning(&lines, "1 vertices belong to no line"));
    io_lines_free(&lines);
    parts.offset = beyond;
    lines = read_trx(parts);
    assert_int_equal(lines.offsets[2], 5);
    assert_true(has_warning(&lines, "do not ascend"));
    io_lines_free(&lines);
    parts.offset = unsorted;
    lines = read_trx(parts);
    assert_int_equal(lines.line_count, 1);
    assert_true(has_warning(&lines, "do not ascend"));
    io_lines_free(&lines);
}

static void trx_errors(void **state) {
    (void)state;
    const uint32_t offset[] = {0, 2, 5};
    const trx_parts good = {"{\"NB_VERTICES\":5,\"NB_STREAMLINES\":2}",
                            "positions.3.float32",
                            "offsets.uint32",
                            5,
                            3,
                            offset};
    const char *headers[] = {"",
                             "[]",
                             "{\"NB_VERTICES\":5}",
                             "{\"NB_VERTICES\":-1,\"NB_STREAMLINES\":2}",
                             "{\"NB_VERTICES\":1e99,\"NB_STREAMLINES\":2}",
                             "{\"NB_VERTICES\":\"5\",\"NB_STREAMLINES\":2}"};
    trx_parts parts = good;
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++) {
        parts.json = headers[i];
        buffer b = trx_of(parts);
        must_fail(&b, NULL, NULL, "header.json");
        buffer_free(&b);
    }
    const char *words[] = {"positions", "5 points", "offsets for 9 lines"};
    const trx_parts wrong[] = {
        {good.json, "positions.2.float32", good.offsets, 5, 3, offset},
        {"{\"NB_VERTICES\":9,\"NB_STREAMLINES\":2}", good.positions, good.offsets, 5, 3, offset},
        {"{\"NB_VERTICES\":5,\"NB_STREAMLINES\":9}", good.positions, good.offsets, 5, 3, offset}};
    for (size_t i = 0; i < 3; i++) {
        buffer b = trx_of(wrong[i]);
        must_fail(&b, NULL, NULL, words[i]);
        buffer_free(&b);
    }
    zip_item none = {"readme.txt", {0}};
    put_text(&none.content, "hello");
    buffer b = make_zip(&none, 1, false);
    must_fail(&b, NULL, NULL, "no header.json");
    buffer_free(&b);
}

/* A new zip64 or stored entry with extra bytes is libzip's matter; a wrong checksum must be told.
 */
static void trx_damage_is_told(void **state) {
    (void)state;
    buffer b = make_sample("new.trx");
    size_t at = 0;
    while (memcmp(b.data + at, "positions", 9) != 0)
        at++;
    b.data[at + 30] ^= 1; /* a byte of the first coordinates */
    must_fail(&b, NULL, NULL, "positions.3.float32");
    buffer_free(&b);
}

static void put_tt_matrix(buffer *b, const char *name, const void *data, uint32_t size) {
    put_u32(b, 50);
    put_u32(b, 1);
    put_u32(b, size);
    put_u32(b, 0);
    put_u32(b, (uint32_t)strlen(name) + 1);
    put(b, name, strlen(name) + 1);
    put(b, data, size);
}

/* Big files split their lines over track, track1, ...; without trans_to_mni voxels are scaled. */
static void tt_goes_on_in_more_arrays(void **state) {
    (void)state;
    const uint8_t record[19] = {6, 0, 0,    0,    32,   0,    0,  0,    64, 0,
                                0, 0, 0xE0, 0xFF, 0xFF, 0xFF, 32, 0x80, 0};
    buffer b = {0};
    put_tt_matrix(&b, "track", record, 19);
    put_tt_matrix(&b, "track1", record, 19);
    io_lines lines = must_read(&b, NULL, NULL);
    assert_int_equal(lines.line_count, 2);
    assert_point(&lines, 2, 1, 2, -1);
    assert_point(&lines, 3, 2, -2, -1);
    assert_true(has_warning(&lines, "trans_to_mni"));
    io_lines_free(&lines);
    put_tt_matrix(&b, "track2", record, 18); /* cut */
    must_fail(&b, NULL, NULL, "2 lines are whole");
    buffer_free(&b);
    put_tt_matrix(&b, "trial", record, 19);
    must_fail(&b, NULL, NULL, "no array 'track'");
    buffer_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trk_voxel_order_flips),
        cmocka_unit_test(trk_voxel_order_permutes),
        cmocka_unit_test(trk_half_voxel_is_an_option),
        cmocka_unit_test(trk_without_matrix_stays_in_voxels),
        cmocka_unit_test(trk_voxel_size_zero_is_guarded),
        cmocka_unit_test(trk_counts),
        cmocka_unit_test(trk_points_not_finite_are_dropped),
        cmocka_unit_test(trk_unnamed_scalars_are_kept),
        cmocka_unit_test(tck_offset_rules),
        cmocka_unit_test(tck_header_errors),
        cmocka_unit_test(tck_ends),
        cmocka_unit_test(wrong_byte_order_is_noticed),
        cmocka_unit_test(vtk_ascii_numbers),
        cmocka_unit_test(locale_does_not_matter),
        cmocka_unit_test(vtk_indices_are_resolved),
        cmocka_unit_test(vtk_arrays_of_all_kinds),
        cmocka_unit_test(vtk_binary_details),
        cmocka_unit_test(vtk_without_lines),
        cmocka_unit_test(vtp_cells_and_names),
        cmocka_unit_test(vtp_pieces_with_different_arrays),
        cmocka_unit_test(vtp_errors),
        cmocka_unit_test(trx_offsets),
        cmocka_unit_test(trx_errors),
        cmocka_unit_test(trx_damage_is_told),
        cmocka_unit_test(tt_goes_on_in_more_arrays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
