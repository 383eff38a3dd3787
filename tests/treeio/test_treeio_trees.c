/* Every tree format gives the same tree from the same numbers, decides by content, and handles each
 * known defect as the contract says: mended with a warning, or refused with a place. */
#include "io_vessel.h" /* first: samples.h has a global of the name of a parameter */

#include "tree_samples.h"

#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

/* ---- Help ------------------------------------------------------------------------------------ */

static io_tree read_tree(const buffer *b, const char *name, const char *unit) {
    io_tree tree = {0};
    io_error error;
    io_options options;
    memset(&options, 0, sizeof options);
    options.unit = unit;
    if (!io_read_tree_memory(b->data, b->size, name, &options, &tree, &error))
        fail_msg("%s: %s", name ? name : "memory", error.text);
    return tree;
}

static io_tree tree_of_text(const char *text) {
    buffer b = text_file(text);
    io_tree tree = read_tree(&b, NULL, "mm");
    buffer_free(&b);
    return tree;
}

static void refuse(buffer b, const char *name, const char *word) {
    io_tree tree, before;
    io_error error = {""};
    memset(&tree, 0x5A, sizeof tree);
    before = tree;
    assert_false(io_read_tree_memory(b.data, b.size, name, NULL, &tree, &error));
    assert_memory_equal(&tree, &before, sizeof tree);
    if (!strstr(error.text, word))
        fail_msg("'%s' is missing in: %s", word, error.text);
    buffer_free(&b);
}

static void refuse_text(const char *text, const char *word) {
    refuse(text_file(text), NULL, word);
}

static bool warns(const io_tree *tree, const char *word) {
    for (uint32_t i = 0; i < tree->warning_count; i++)
        if (strstr(tree->warnings[i], word))
            return true;
    return false;
}

static void expect_warning(const char *text, const char *word) {
    io_tree tree = tree_of_text(text);
    if (!warns(&tree, word))
        fail_msg("no warning of '%s' (%u warnings)", word, tree.warning_count);
    io_tree_free(&tree);
}

static io_vessel build(const io_tree *tree) {
    io_vessel vessel = {0};
    io_error error;
    if (!io_vessel_build(NULL, tree, &vessel, &error))
        fail_msg("%s", error.text);
    return vessel;
}

static bool near(double a, double b) {
    return fabs(a - b) <= 1e-5 * fmax(1, fabs(b));
}

/* ---- Samples --------------------------------------------------------------------------------- */

/* In mm and absolute, as a renderer takes it. */
static void assert_vessel(const io_vessel *v, const tree_sample *of, double mm) {
    const sdv_tree *t = &v->tree;
    assert_int_equal(t->node_count, TREE_NODES);
    assert_int_equal(t->segment_count, TREE_SEGMENTS);
    for (uint32_t i = 0; i < TREE_NODES; i++) {
        double radius = !i && of->by_segment ? 1.5 : tree_radii[i];
        assert_true(near((double)t->nodes[i].x + v->origin[0], mm * tree_positions[i][0]));
        assert_true(near((double)t->nodes[i].y + v->origin[1], mm * tree_positions[i][1]));
        assert_true(near((double)t->nodes[i].z + v->origin[2], mm * tree_positions[i][2]));
        assert_true(near((double)t->nodes[i].w, mm * radius));
    }
    uint32_t parents[TREE_NODES] = {SDV_NONE, 0, 1, 1, 3};
    assert_memory_equal(t->parents, parents, sizeof parents);
    assert_int_equal(t->info.roots, 1);
    assert_int_equal(t->info.leaves, 2);
    assert_int_equal(t->info.branches, 1);
    assert_int_equal(t->info.loops, 0);
    assert_int_equal(t->info.joined, 0);
    assert_true(near(v->radius[0], 0.25) && near(v->radius[1], of->by_segment ? 1.5 : 2));
    assert_true(near(v->bounds[0][0], -1) && near(v->bounds[1][2], 12));
}

static void every_format_gives_the_tree(void **state) {
    (void)state;
    for (size_t i = 0; i < tree_sample_count; i++) {
        const tree_sample *of = &tree_samples[i];
        buffer b = of->make();
        io_tree tree = read_tree(&b, NULL, NULL); /* no name: the content alone decides */
        print_message("%s\n", of->name);
        assert_string_equal(tree.format, of->format);
        assert_string_equal(tree.unit, of->unit);
        assert_int_equal(warns(&tree, "unit"), of->guessed);
        io_vessel vessel = build(&tree);
        assert_vessel(&vessel, of, tree.millimetres);
        io_vessel_free(&vessel);
        io_tree_free(&tree);
        buffer_free(&b);
    }
}

/* A name of another format does not change what the content says. */
static void names_do_not_matter(void **state) {
    (void)state;
    for (size_t i = 0; i < tree_sample_count; i++) {
        buffer b = tree_samples[i].make();
        io_tree tree = read_tree(&b, i % 2 ? "a.stl" : "a.trk", NULL);
        assert_string_equal(tree.format, tree_samples[i].format);
        io_tree_free(&tree);
        buffer_free(&b);
    }
}

static void numbers_do_not_depend_on_the_locale(void **state) {
    (void)state;
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8") && !setlocale(LC_NUMERIC, "fr_FR.UTF-8"))
        print_message("no locale with a decimal comma is installed; the test says less\n");
    every_format_gives_the_tree(state);
    setlocale(LC_NUMERIC, "C");
}

/* ---- Units ----------------------------------------------------------------------------------- */

static void units(void **state) {
    static const struct {
        const char *asked, *name;
        double mm;
    } rows[] = {{"mm", "mm", 1},
                {"cm", "cm", 10},
                {"um", "um", 1e-3},
                {"m", "m", 1000},
                {"nm", "nm", 1e-6}};
    (void)state;
    buffer b = make_tree_sample("dos.swc"); /* tells microns itself */
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        io_tree tree = read_tree(&b, NULL, rows[i].asked);
        assert_string_equal(tree.unit, rows[i].name);
        assert_true(tree.millimetres == rows[i].mm);
        assert_false(warns(&tree, "unit"));
        io_tree_free(&tree);
    }
    io_options options = {0};
    io_error error = {""};
    io_tree tree;
    options.unit = "parsec";
    assert_false(io_read_tree_memory(b.data, b.size, NULL, &options, &tree, &error));
    assert_non_null(strstr(error.text, "parsec"));
    buffer_free(&b);
}

static void units_are_guessed_by_size(void **state) {
    (void)state;
    buffer b = text_file("1 1 0 0 0 1 -1\n2 1 5000 0 0 1 1\n"); /* no vessel is 5 m long */
    io_tree tree = read_tree(&b, NULL, NULL);
    assert_string_equal(tree.unit, "um");
    io_tree_free(&tree);
    buffer_free(&b);
    b = make_tree_sample("vmtk.vtk");
    put_u8(&b, 0); /* ends what strstr reads */
    char *radii = strstr((char *)b.data, "default\n");
    assert_non_null(radii);
    b.size = (size_t)(radii + 8 - (char *)b.data);
    put_text(&b, ".2 .2 .2 .2 .2 .2\n");
    tree = read_tree(&b, NULL, NULL);
    assert_string_equal(tree.unit, "cm"); /* SimVascular's */
    io_tree_free(&tree);
    buffer_free(&b);
}

/* ---- SWC ------------------------------------------------------------------------------------- */

static void swc_defects(void **state) {
    (void)state;
    expect_warning("1 1 0 0 0 1 -1\n2 3 0 0 1 1 77\n", "parent that is missing");
    expect_warning("1 1 0 0 0 1 -1\n2 3 0 0 1 1 2\n", "themselves");
    expect_warning("1 1 0 0 0 1 -1\n1 3 0 0 1 1 1\n", "id of an earlier node");
    expect_warning("1 1 0 0 0 1 -1 8\n2 3 0 0 1 1 1\n", "behind the seventh");
    expect_warning("1 1 0 0 0 -1\n2 3 0 0 1 1\n", "radii are missing");
    expect_warning("1 0 0 0 2.5 -1\n2 0.5 0 1 1 1\n", "id, x, y, z, radius, parent");
    refuse_text("1 1 0 0 0 1 -1\n2 3 0 0 1 1\n", "line 2");
    refuse_text("1 1 0 0 0 1 -1\n\n2 3 0 nan 1 1 1\n", "line 3");
    refuse_text("1 1 0 0 0 1 -1\n2 3 0 1e999 1 1 1\n", "line 2");
    refuse_text("1 1 0 0 0 1 -1\n2 3 0 zero 1 1 1\n", "line 2");
    refuse_text("1 1 0 0 0 1 -1\n2.5 3 0 0 1 1 1\n", "whole");
    refuse(text_file("# nothing\n\n"), "a.swc", "no line of numbers");
}

static void swc_cycles_are_refused(void **state) {
    (void)state;
    refuse_text("1 1 0 0 0 1 2\n2 3 0 0 1 1 3\n3 3 0 0 2 1 1\n", "cycle");
    refuse_text("9 1 0 0 0 1 -1\n1 3 0 0 0 1 4\n2 3 0 0 1 1 1\n3 3 0 0 2 1 2\n4 3 0 0 3 1 3\n",
                "cycle");
}

/* Radius 0 and missing radii are taken; two roots, a parent of 0, and a chain of length 0 stand. */
static void swc_odd_trees_stand(void **state) {
    (void)state;
    io_tree tree = tree_of_text("5 1 0 0 0 0 0\n6 3 0 0 0 1 5\n7 3 1 0 0 -1 6\n8 1 9 9 9 nan -1\n");
    io_vessel vessel = build(&tree);
    assert_int_equal(tree.warning_count, 0);
    assert_int_equal(vessel.tree.info.nodes, 4); /* ids rule: equal places are not merged */
    assert_int_equal(vessel.tree.info.segments, 2);
    assert_int_equal(vessel.tree.info.roots, 2);
    assert_int_equal(vessel.tree.info.leaves, 1);
    assert_true(vessel.radius[0] == 0 && vessel.radius[1] == 1);
    assert_true(isnan(tree.radii[2]) && isnan(tree.radii[3]));
    assert_true(vessel.tree.warning_count >= 2);
    assert_string_equal(tree.node_attributes[0].name, "type");
    assert_true(tree.node_attributes[0].data[1] == 3);
    io_vessel_free(&vessel);
    io_tree_free(&tree);
}

static void swc_of_six_columns(void **state) {
    (void)state;
    io_tree tree = tree_of_text("1 1 0 0 2 -1\n2 3 0 0 1 1\n"); /* without radius */
    assert_true(tree.segment_count == 1 && tree.segments[0] == 0 && tree.positions[2] == 2);
    assert_true(isnan(tree.radii[0]) && tree.node_attributes[0].data[1] == 3);
    io_tree_free(&tree);
    tree = tree_of_text("1 0 0 2.5 4 -1\n2 0.5 0 1 3 1\n"); /* without type */
    assert_true(tree.segment_count == 1 && tree.segments[1] == 1 && tree.positions[3] == 0.5);
    assert_true(tree.radii[0] == 4 && tree.node_attributes[0].data[1] == 0);
    io_tree_free(&tree);
}

/* A node 0 may be a parent. */
static void swc_parent_zero(void **state) {
    (void)state;
    io_tree tree = tree_of_text("0 1 0 0 0 1 -1\n1 3 0 0 1 1 0\n");
    assert_int_equal(tree.segment_count, 1);
    io_tree_free(&tree);
}

/* A chain of a million nodes, ids shuffled, parents anywhere. */
static void swc_of_a_million_lines(void **state) {
    enum { COUNT = 1000000, STEP = 700001 };
    (void)state;
    buffer b = {0};
    for (uint64_t i = 0; i < COUNT; i++) {
        uint64_t id = i * STEP % COUNT + 1; /* STEP and COUNT have no common factor */
        put_format(&b, "%llu 3 %llu.25 0 0 1.5 %lld\n", (unsigned long long)id,
                   (unsigned long long)id, id == 1 ? -1 : (long long)id - 1);
    }
    clock_t begin = clock();
    io_tree tree = read_tree(&b, NULL, "mm");
    double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
    print_message("%d lines: %.2f s of processor time\n", COUNT, seconds);
    assert_int_equal(tree.node_count, COUNT);
    assert_int_equal(tree.segment_count, COUNT - 1);
    for (uint32_t i = 0; i < tree.segment_count; i++) {
        double parent = tree.positions[3 * (size_t)tree.segments[2 * (size_t)i]];
        double child = tree.positions[3 * (size_t)tree.segments[2 * (size_t)i + 1]];
        assert_true(child == parent + 1);
    }
    assert_true(seconds < 60); /* quadratic time would be an hour */
    io_tree_free(&tree);
    buffer_free(&b);
}

/* ---- GXL ------------------------------------------------------------------------------------- */

#define NODE(id, position)                                                                         \
    "<node id='" id "'><attr name=' position'><tup>" position "</tup></attr></node>"
#define EDGE(from, to, radius)                                                                     \
    "<edge from='" from "' to='" to "'><attr name=' radius'><float>" radius "</float></attr></"    \
    "edge>"
#define F(a) "<float>" a "</float>"

static void gxl_odd_files(void **state) {
    (void)state;
    io_tree tree = tree_of_text("<gxl><graph>" NODE(" a", F("1") F("2")) NODE("b ", F("3") F("4"))
                                    EDGE("a", "b", "0.5") "</graph></gxl>");
    assert_int_equal(tree.node_count, 2);
    assert_true(tree.positions[5] == 0 && tree.radii[0] == 0.5 && tree.radii[1] == 0.5);
    assert_true(warns(&tree, "two coordinates"));
    assert_string_equal(tree.segment_attributes[0].name, "radius");
    io_tree_free(&tree);
    tree = tree_of_text("<gxl><graph>" NODE("a", F("1") F("2") F("3"))
                            NODE("b", F("3") F("4")) "</graph></gxl>");
    assert_true(tree.positions[2] == 3 && tree.positions[5] == 0);
    io_tree_free(&tree);
    expect_warning("<gxl><graph>" NODE("a", F("1") F("2") F("3"))
                       EDGE("a", "x", "1") "</graph></gxl>",
                   "missing");
    expect_warning("<gxl><graph>" NODE("a", F("1") F("2") F("3"))
                       NODE("a", F("1") F("2") F("3")) "<edge from='a' to='a'/></graph></gxl>",
                   "earlier node");
    refuse_text("<gxl><graph>" NODE("a", F("1")) "</graph></gxl>", "position");
    refuse_text("<gxl><graph>" NODE("a", F("1") F("nan") F("2")) "</graph></gxl>", "finite");
    refuse_text("<gxl><graph>" NODE("a", F("one") F("2")) "</graph></gxl>", "'one'");
    refuse_text("<gxl><graph><node><attr/></node></graph></gxl>", "'id'");
    refuse_text("<gxl><graph></graph></gxl>", "no nodes");
    refuse_text("<gxl><graph>", "XML");
    refuse_text(
        "<gxl><graph>" NODE(
            "a",
            F("1") F(
                "2")) "<edge from='a' to='a'><attr name='radius'>"
                      "<float>1<attr name='b'/></float></attr></edge><node id='b'/></graph></gxl>",
        "position"); /* a tag within a number */
}

/* The widest of several: of the edges that enter a node, and for the root of those that leave. */
static void gxl_radii(void **state) {
    (void)state;
    io_tree tree =
        tree_of_text("<gxl><graph>" NODE("r", F("0") F("0") F("0")) NODE("a", F("1") F("0") F("0"))
                         NODE("b", F("2") F("0") F("0")) EDGE("r", "a", "1") EDGE("r", "b", "3")
                             EDGE("a", "b", "2") "</graph></gxl>");
    assert_true(tree.radii[0] == 3 && tree.radii[1] == 1 && tree.radii[2] == 3);
    io_vessel vessel = build(&tree);
    assert_int_equal(vessel.tree.info.loops, 1);
    io_vessel_free(&vessel);
    io_tree_free(&tree);
}

/* ---- Forms ----------------------------------------------------------------------------------- */

/* A vessel of three nodes with an ellipse and noise, in cm. */
static const double form_points[3][4] = {{0, 0, 0, 2}, {1, 0, 0, 2}, {2, 1, 0, 1}};
static const double form_ratio[3] = {1, 0.5, 0.75};
static const double form_axis[9] = {0, 0, 1, 0, 1, 0, 0, 0.5, -0.5};
static const double form_amplitude[3] = {0, 0.125, 0.25};

static const double *form_values(const sdv_attribute *a) {
    if (!strcmp(a->name, SDV_SECTION_AXIS) && a->components == 3)
        return form_axis;
    if (a->components != 1)
        return NULL;
    return !strcmp(a->name, SDV_SECTION_RATIO) ? form_ratio
           : !strcmp(a->name, SDV_UNCERTAINTY) ? form_amplitude
                                               : NULL;
}

/* The three attributes reach the field, lengths in mm. */
static void assert_forms(buffer b) {
    io_tree tree = read_tree(&b, NULL, "cm");
    io_vessel vessel = build(&tree);
    sdv_tree *t = &vessel.tree;
    sdv_grid grid;
    int found = 0;
    assert_int_equal(t->node_count, 3);
    for (uint32_t i = 0; i < t->node_attribute_count; i++) {
        const sdv_attribute *a = &t->node_attributes[i];
        const double *values = form_values(a);
        double scale = values == form_amplitude ? 10 : 1;
        for (uint32_t k = 0; values && k < 3 * a->components; k++)
            assert_true(near((double)a->values[k], scale * values[k]));
        found += values != NULL;
    }
    assert_int_equal(found, 3);
    assert_int_equal(sdv_grid_build(NULL, t, NULL, &grid), LAO_OK);
    assert_non_null(grid.forms);
    sdv_grid_free(&grid);
    io_vessel_free(&vessel);
    io_tree_free(&tree);
    buffer_free(&b);
}

static const char swc_form_rows[] = "1 0 0 0 0 1 -1 1 0 0 1 0\n"
                                    "2 0 1 0 0 1 1 0.5 0 1 0 0.125\n"
                                    "3 0 2 1 0 0.5 2 0.75 0 0.5 -0.5 0.25\n";
#define SWC_NAMES "# id type x y z radius parent section_ratio " SWC_AXES " uncertainty\n"
#define SWC_AXES "section_axis section_axis section_axis"

static void forms_of_swc(void **state) {
    buffer b = text_file("# a vessel\n" SWC_NAMES);
    (void)state;
    put_text(&b, swc_form_rows);
    assert_forms(b);
    /* other words are no names; a word that is no number is no value */
    b = text_file("# section_ratio uncertainty\n");
    put_text(&b, swc_form_rows);
    io_tree tree = read_tree(&b, NULL, "mm");
    assert_int_equal(tree.node_attribute_count, 1); /* the type */
    assert_true(warns(&tree, "seventh"));
    io_tree_free(&tree);
    buffer_free(&b);
    tree = tree_of_text("# a b c d e f g flow wall\n1 0 0 0 0 1 -1 7 x\n2 0 1 0 0 1 1 8\n");
    assert_int_equal(tree.node_attribute_count, 3);
    assert_string_equal(tree.node_attributes[1].name, "flow");
    assert_true(tree.node_attributes[1].data[1] == 8);
    assert_true(isnan(tree.node_attributes[2].data[0]) && isnan(tree.node_attributes[2].data[1]));
    assert_false(warns(&tree, "seventh"));
    io_tree_free(&tree);
}

static void forms_of_vtk(void **state) {
    (void)state;
    assert_forms(text_file(
        "# vtk DataFile Version 3.0\nvessel\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n"
        "0 0 0 1 0 0 2 1 0\nLINES 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS radius float 1\n"
        "LOOKUP_TABLE default\n1 1 0.5\nVECTORS section_axis float\n0 0 1 0 1 0 0 0.5 -0.5\n"
        "FIELD FieldData 2\nsection_ratio 1 3 float\n1 0.5 0.75\n"
        "uncertainty 1 3 float\n0 0.125 0.25\n"));
}

static void forms_of_vtp(void **state) {
#define ARRAY(type, name, parts, values)                                                           \
    "<DataArray type=\"" type "\" Name=\"" name "\" NumberOfComponents=\"" parts                   \
    "\" format=\"ascii\">" values "</DataArray>\n"
    (void)state;
    assert_forms(text_file(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
        "byte_order=\"LittleEndian\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfLines=\"1\" "
        "NumberOfVerts=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData>"  //
        ARRAY("Float32", "radius", "1", "1 1 0.5")                                    //
        ARRAY("Float32", "section_ratio", "1", "1 0.5 0.75")                          //
        ARRAY("Float64", "section_axis", "3", "0 0 1 0 1 0 0 0.5 -0.5")               //
        ARRAY("Float32", "uncertainty", "1", "0 0.125 0.25") "</PointData>\n<Points>" //
        ARRAY("Float32", "Points", "3", "0 0 0 1 0 0 2 1 0") "</Points>\n<Lines>"     //
        ARRAY("Int32", "connectivity", "1", "0 1 2")                                  //
        ARRAY("Int32", "offsets", "1", "3") "</Lines></Piece></PolyData></VTKFile>\n"));
}

static void forms_of_h5(void **state) {
    const h5_table more[] = {{"section_ratio", 1, form_ratio},
                             {"section_axis", 3, form_axis},
                             {"uncertainty", 1, form_amplitude}};
    (void)state;
    assert_forms(make_h5_section(form_points, 3, more, 3));
    /* one of the wrong width is told with its name */
    const h5_table narrow = {"section_axis", 2, form_axis};
    refuse(make_h5_section(form_points, 3, &narrow, 1), NULL, "section_axis");
}

/* ---- vmv ------------------------------------------------------------------------------------- */

static void vmv_defects(void **state) {
    (void)state;
    expect_warning("$PARAM_BEGIN\nNUM_VERTS 9\n$PARAM_END\n$VERT_LIST_BEGIN\n1 0 0 0 1\n2 1 0 0 1\n"
                   "$VERT_LIST_END\n$STRANDS_LIST_BEGIN\n1 1 2\n$STRANDS_LIST_END\n",
                   "NUM_VERTS");
    refuse_text("$VERT_LIST_BEGIN\n1 0 0 0 1\n", "too early");
    refuse_text("$VERT_LIST_BEGIN\n$VERT_LIST_END\n", "no vertices");
    refuse_text("$VERT_LIST_BEGIN\n1 0 0 0 1\n$VERT_LIST_END\n", "$STRANDS_LIST_BEGIN");
    refuse_text("$VERT_LIST_BEGIN\n1 0 0 0 1\n$VERT_LIST_END\n$STRANDS_LIST_BEGIN\n1 1 2\n",
                "vertex '2'");
    refuse_text("$VERT_LIST_BEGIN\n1 0 0 0\n$VERT_LIST_END\n", "line 2");
    refuse_text("$VERT_LIST_BEGIN\n1 0 inf 0 1\n$VERT_LIST_END\n", "finite");
}

/* Strands tell no direction: the root is the first vertex of the first one. A vertex on no strand
 * is none, and two at one place are one. */
static void vmv_strands(void **state) {
    (void)state;
    io_tree tree = tree_of_text("$VERT_LIST_BEGIN\n1 0 0 0 1\n2 1 0 0 1\n3 2 0 0 1\n4 9 9 9 1\n"
                                "5 1 0 0 1\n$VERT_LIST_END\n"
                                "$STRANDS_LIST_BEGIN\n1 2 1\n2 3 5\n$STRANDS_LIST_END\n");
    io_vessel vessel = build(&tree);
    assert_int_equal(vessel.tree.info.nodes, 3);
    assert_int_equal(vessel.tree.info.roots, 1);
    assert_int_equal(vessel.tree.roots[0], 1);
    io_vessel_free(&vessel);
    io_tree_free(&tree);
}

/* ---- HDF5 ------------------------------------------------------------------------------------ */

static buffer h5_of(const double *structure, size_t sections, const double (*links)[2],
                    size_t link_count) {
    static const double points[5][4] = {
        {0, 0, 0, 2}, {1, 0, 0, 2}, {1, 0, 0, 2}, {0, 0, 0, 4}, {5, 5, 5, 1}};
    return make_h5(points, 5, structure, sections, 1, links, link_count);
}

/* Two sections between the same ends close a loop; it is kept. A section of one point is none. */
static void h5_loops_are_kept(void **state) {
    static const double structure[3] = {0, 2, 4}, links[1][2] = {{0, 1}};
    const double longer[2] = {0, 2};
    (void)state;
    buffer b = h5_of(structure, 3, links, 1);
    io_tree tree = read_tree(&b, NULL, NULL);
    io_vessel vessel = build(&tree);
    assert_int_equal(tree.node_count, 5);
    assert_int_equal(vessel.tree.info.nodes, 2); /* merged; the lone point is dropped */
    assert_int_equal(vessel.tree.info.segments, 1);
    assert_true(vessel.radius[0] == 1 && vessel.radius[1] == 2);
    io_vessel_free(&vessel);
    io_tree_free(&tree);
    buffer_free(&b);
    b = h5_of(longer, 2, links, 1); /* 0-1, 1-0-(5,5,5); joined at (1,0,0) */
    tree = read_tree(&b, NULL, NULL);
    vessel = build(&tree);
    assert_int_equal(vessel.tree.info.nodes, 3);
    assert_int_equal(vessel.tree.info.loops, 0);
    io_vessel_free(&vessel);
    io_tree_free(&tree);
    buffer_free(&b);
}

static void h5_triangle_is_a_loop(void **state) {
    static const double points[6][4] = {{0, 0, 0, 1}, {1, 0, 0, 1}, {1, 0, 0, 1},
                                        {0, 1, 0, 1}, {0, 1, 0, 1}, {0, 0, 0, 1}};
    static const double structure[3] = {0, 2, 4}, links[3][2] = {{0, 1}, {1, 2}, {2, 0}};
    (void)state;
    buffer b = make_h5(points, 6, structure, 3, 1, links, 3);
    io_tree tree = read_tree(&b, NULL, NULL);
    io_vessel vessel = build(&tree);
    assert_int_equal(vessel.tree.info.nodes, 3);
    assert_int_equal(vessel.tree.info.segments, 3);
    assert_int_equal(vessel.tree.info.loops, 1);
    assert_int_equal(vessel.tree.info.roots, 1);
    io_vessel_free(&vessel);
    io_tree_free(&tree);
    buffer_free(&b);
}

static void h5_defects(void **state) {
    static const double good[2] = {0, 2}, back[2] = {3, 2}, beyond[2] = {0, 9};
    static const double none[1][2] = {{0, 2}}, minus[1][2] = {{-1, 0}};
    (void)state;
    refuse(h5_of(back, 2, NULL, 0), NULL, "section 0");
    refuse(h5_of(beyond, 2, NULL, 0), NULL, "section 0");
    refuse(h5_of(good, 2, none, 1), NULL, "connectivity");
    refuse(h5_of(good, 2, minus, 1), NULL, "connectivity");
    buffer b = {0};
    put(&b, "\x89HDF\r\n\x1A\n", 8);
    put_zeros(&b, 500);
    refuse(b, NULL, "missing or damaged");
}

/* ---- VTK ------------------------------------------------------------------------------------- */

#define VTK "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n"

/* A branch that begins within the trunk, on no point of it, is joined to the nearest point. */
static void disjoint_lines_are_joined(void **state) {
    (void)state;
    io_tree tree = tree_of_text(VTK "POINTS 7 float\n0 0 0 0 0 4 0 0 8 0 0 12\n"
                                    "1 0 9 5 0 9 9 0 9\n"
                                    "LINES 2 9\n4 0 1 2 3\n3 4 5 6\nPOINT_DATA 7\n"
                                    "SCALARS Radius float\nLOOKUP_TABLE default\n"
                                    "3 3 3 3 .5 .5 .5\n");
    io_vessel vessel = build(&tree);
    assert_int_equal(vessel.tree.info.roots, 1);
    assert_int_equal(vessel.tree.info.joined, 1);
    assert_int_equal(vessel.tree.segments[vessel.tree.segment_count - 1].parent, 2);
    assert_int_equal(vessel.tree.segments[vessel.tree.segment_count - 1].child, 4);
    io_vessel_free(&vessel);
    io_tree_free(&tree);
}

/* A VTP root is the first point of line 1, wherever that line lies in the file's points. */
static void the_root_is_the_first_point_of_line_one(void **state) {
    (void)state;
    io_tree tree = tree_of_text(VTK "POINTS 4 float\n0 0 0 0 0 4 0 0 8 9 9 9\n"
                                    "LINES 2 6\n2 2 1\n2 1 0\nPOINT_DATA 4\n"
                                    "SCALARS radius float\nLOOKUP_TABLE default\n1 1 1 1\n");
    io_vessel vessel = build(&tree);
    assert_int_equal(vessel.tree.info.nodes, 3); /* the point on no line is none */
    assert_int_equal(vessel.tree.roots[0], 2);
    assert_true(vessel.bounds[1][0] == 0);
    io_vessel_free(&vessel);
    io_tree_free(&tree);
}

static void points_that_are_not_finite_are_bridged(void **state) {
    (void)state;
    io_tree tree = tree_of_text(VTK "POINTS 3 float\n0 0 0 nan 0 4 0 0 8\nLINES 1 4\n3 0 1 2\n"
                                    "POINT_DATA 3\nSCALARS radius float\nLOOKUP_TABLE default\n"
                                    "1 2 3\n");
    assert_int_equal(tree.node_count, 2);
    assert_int_equal(tree.segment_count, 1);
    assert_true(tree.radii[1] == 3 && warns(&tree, "not finite"));
    io_tree_free(&tree);
}

static void lines_without_radius_are_no_tree(void **state) {
    (void)state;
    refuse_text(VTK "POINTS 2 float\n0 0 0 0 0 4\nLINES 1 3\n2 0 1\n", "radius");
    refuse(make_trk(false, SAMPLE_LINES), NULL, "not a vessel tree");
    refuse(text_file(VTK "POINTS 2 float\n0 0 0 0 0 4\nLINES 1 3\n2 0 7\nPOINT_DATA 2\n"
                         "SCALARS radius float\nLOOKUP_TABLE default\n1 1\n"),
           NULL, "line 1 uses a point");
}

/* One read gives both sides of a file of centrelines. */
static void centrelines_are_lines_and_a_tree(void **state) {
    (void)state;
    buffer b = make_tree_sample("vmtk.vtk");
    io_contents contents;
    io_error error;
    assert_true(io_read_memory(b.data, b.size, NULL, IO_ANYTHING, NULL, &contents, &error));
    assert_int_equal(contents.kinds, IO_LINES | IO_TREE);
    assert_int_equal(contents.lines.line_count, 2);
    assert_int_equal(contents.lines.point_count, 6);
    assert_int_equal(contents.tree.node_count, 6);
    io_contents_free(&contents);
    assert_true(io_read_memory(b.data, b.size, NULL, IO_LINES, NULL, &contents, &error));
    assert_int_equal(contents.kinds, IO_LINES);
    io_contents_free(&contents);
    io_contents_free(&contents); /* harmless */
    buffer_free(&b);
}

static bool cancel(void *user, uint64_t done, uint64_t total) {
    unsigned *calls = user;
    assert_true(done <= total);
    return ++*calls > 2;
}

static void reading_can_be_cancelled(void **state) {
    (void)state;
    buffer b = make_tree_sample("plain.swc");
    unsigned calls = 0;
    io_options options = {0};
    io_error error = {""};
    io_tree tree;
    options.progress = cancel;
    options.user = &calls;
    for (int i = 0; i < 100000; i++)
        put_text(&b, "\n");
    assert_false(io_read_tree_memory(b.data, b.size, NULL, &options, &tree, &error));
    assert_non_null(strstr(error.text, "cancelled"));
    buffer_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_gives_the_tree),
        cmocka_unit_test(names_do_not_matter),
        cmocka_unit_test(numbers_do_not_depend_on_the_locale),
        cmocka_unit_test(units),
        cmocka_unit_test(units_are_guessed_by_size),
        cmocka_unit_test(swc_defects),
        cmocka_unit_test(swc_cycles_are_refused),
        cmocka_unit_test(swc_odd_trees_stand),
        cmocka_unit_test(swc_of_six_columns),
        cmocka_unit_test(swc_parent_zero),
        cmocka_unit_test(swc_of_a_million_lines),
        cmocka_unit_test(gxl_odd_files),
        cmocka_unit_test(gxl_radii),
        cmocka_unit_test(vmv_defects),
        cmocka_unit_test(vmv_strands),
        cmocka_unit_test(forms_of_swc),
        cmocka_unit_test(forms_of_vtk),
        cmocka_unit_test(forms_of_vtp),
        cmocka_unit_test(forms_of_h5),
        cmocka_unit_test(h5_loops_are_kept),
        cmocka_unit_test(h5_triangle_is_a_loop),
        cmocka_unit_test(h5_defects),
        cmocka_unit_test(disjoint_lines_are_joined),
        cmocka_unit_test(the_root_is_the_first_point_of_line_one),
        cmocka_unit_test(points_that_are_not_finite_are_bridged),
        cmocka_unit_test(lines_without_radius_are_no_tree),
        cmocka_unit_test(centrelines_are_lines_and_a_tree),
        cmocka_unit_test(reading_can_be_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
