/* Every mesh format gives the same triangles from the same numbers, decides by content, and says
 * what is odd; welding and counting of edges do what they promise. */
#include "tree_samples.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- Help ------------------------------------------------------------------------------------ */

static io_mesh read_mesh(const buffer *b, const char *name) {
    io_mesh mesh = {0};
    io_error error;
    if (!io_read_mesh_memory(b->data, b->size, name, NULL, &mesh, &error))
        fail_msg("%s: %s", name ? name : "memory", error.text);
    return mesh;
}

static io_mesh mesh_of_text(const char *text) {
    buffer b = text_file(text);
    io_mesh mesh = read_mesh(&b, NULL);
    buffer_free(&b);
    return mesh;
}

static void refuse(buffer b, const char *name, const char *word) {
    io_mesh mesh, before;
    io_error error = {""};
    memset(&mesh, 0x5A, sizeof mesh);
    before = mesh;
    assert_false(io_read_mesh_memory(b.data, b.size, name, NULL, &mesh, &error));
    assert_memory_equal(&mesh, &before, sizeof mesh);
    if (!strstr(error.text, word))
        fail_msg("'%s' is missing in: %s", word, error.text);
    buffer_free(&b);
}

static bool warns(const io_mesh *mesh, const char *word) {
    for (uint32_t i = 0; i < mesh->warning_count; i++)
        if (strstr(mesh->warnings[i], word))
            return true;
    return false;
}

static const io_attribute *find(const io_attribute *attributes, uint32_t count, const char *name) {
    for (uint32_t i = 0; i < count; i++)
        if (!strcmp(attributes[i].name, name))
            return &attributes[i];
    return NULL;
}

static void weld(io_mesh *mesh) {
    io_error error;
    assert_true(io_mesh_weld(mesh, &error));
}

static io_mesh_edges edges_of(const io_mesh *mesh) {
    io_mesh_edges edges;
    io_error error;
    assert_true(io_mesh_count_edges(mesh, &edges, &error));
    return edges;
}

/* ---- Samples --------------------------------------------------------------------------------- */

static void assert_pyramid(const io_mesh *mesh) {
    assert_int_equal(mesh->vertex_count, MESH_VERTICES);
    assert_int_equal(mesh->triangle_count, MESH_TRIANGLES);
    for (size_t i = 0; i < MESH_TRIANGLES; i++)
        for (size_t k = 0; k < 3; k++) {
            const float *p = mesh->positions + 3 * (size_t)mesh->triangles[3 * i + k];
            for (size_t axis = 0; axis < 3; axis++)
                assert_true((double)p[axis] + mesh->origin[axis] ==
                            mesh_positions[mesh_triangles[i][k]][axis]);
        }
    io_mesh_edges edges = edges_of(mesh);
    assert_int_equal(edges.edges, 9); /* Euler: 5 - 9 + 6 = 2 */
    assert_int_equal(edges.boundary, 0);
    assert_int_equal(edges.non_manifold, 0);
    assert_int_equal(edges.components, 1);
}

static void assert_data(const io_mesh *mesh, const mesh_sample *of) {
    const io_attribute *wss = find(mesh->vertex_attributes, mesh->vertex_attribute_count, "wss");
    const io_attribute *part =
        find(mesh->triangle_attributes, mesh->triangle_attribute_count, "part");
    assert_int_equal(wss != NULL, of->vertex_data);
    assert_int_equal(part != NULL, of->face_data);
    for (size_t i = 0; wss && i < MESH_VERTICES; i++)
        assert_true((double)wss->data[i] == mesh_stress(i));
    for (size_t i = 0; part && i < MESH_TRIANGLES; i++)
        assert_true((double)part->data[i] == mesh_part(i));
}

static void every_format_gives_the_mesh(void **state) {
    (void)state;
    for (size_t i = 0; i < mesh_sample_count; i++) {
        const mesh_sample *of = &mesh_samples[i];
        buffer b = of->make(), packed = gzip_of(&b);
        print_message("%s\n", of->name);
        for (int turn = 0; turn < 3; turn++) { /* alone, with a wrong name, gzipped */
            io_mesh mesh = read_mesh(turn < 2 ? &b : &packed, turn ? "a.swc" : NULL);
            assert_string_equal(mesh.format, of->format);
            assert_int_equal(mesh.warning_count, 0);
            assert_int_equal(mesh.vertex_count, of->loose ? 3 * MESH_TRIANGLES : MESH_VERTICES);
            weld(&mesh);
            assert_pyramid(&mesh);
            assert_data(&mesh, of);
            io_mesh_free(&mesh);
        }
        buffer_free(&packed);
        buffer_free(&b);
    }
}

/* ---- STL ------------------------------------------------------------------------------------- */

static void stl_counts(void **state) {
    (void)state;
    buffer b = make_mesh_sample("solid.stl");
    patch_u32(&b, 80, 0); /* some writers forget it */
    io_mesh mesh = read_mesh(&b, "a.stl");
    assert_int_equal(mesh.triangle_count, MESH_TRIANGLES);
    assert_true(warns(&mesh, "the head tells 0"));
    io_mesh_free(&mesh);
    patch_u32(&b, 80, 0xFFFFFFFF);
    mesh = read_mesh(&b, "a.stl");
    assert_int_equal(mesh.triangle_count, MESH_TRIANGLES);
    io_mesh_free(&mesh);
    patch_u32(&b, 80, MESH_TRIANGLES);
    put_text(&b, "something else");
    mesh = read_mesh(&b, "a.stl");
    assert_int_equal(mesh.triangle_count, MESH_TRIANGLES);
    assert_true(warns(&mesh, "14 bytes"));
    io_mesh_free(&mesh);
    b.size -= 20;
    refuse(b, "a.stl", "5 are whole");
    refuse(text_file("solid"), "a.stl", "84");
}

static void stl_texts(void **state) {
    (void)state;
    refuse(text_file("solid\nfacet\nvertex 1 2 3\nvertex 1 2\n"), NULL, "line 4");
    refuse(text_file("solid\nfacet\nvertex 1 2 3\nendloop\n"), NULL, "fewer than three");
    refuse(text_file("solid\nfacet\nvertex 1 2 3 vertex 1 2 3 vertex 1 2 3 vertex 1 2 3\n"), NULL,
           "more than three");
    refuse(text_file("solid\nfacet\nvertex 1 2 3 vertex 1 2 3\n"), NULL, "within a facet");
    io_mesh mesh = mesh_of_text("solid a\nfacet vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop\n"
                                "endsolid a\nsolid b\nfacet vertex 0 0 0 vertex 1 0 0 "
                                "vertex 0 0 1 endloop\n");
    assert_int_equal(mesh.triangle_count, 2); /* of two solids */
    assert_true(warns(&mesh, "endsolid"));
    weld(&mesh);
    assert_int_equal(mesh.vertex_count, 4);
    io_mesh_free(&mesh);
}

/* ---- PLY ------------------------------------------------------------------------------------- */

#define PLY(elements) "ply\nformat ascii 1.0\n" elements "end_header\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define FACE "property list uchar int vertex_index\n"

static void ply_odd_files(void **state) {
    (void)state;
    io_mesh mesh = mesh_of_text(
        PLY("element vertex 3\n" XYZ "property float nx\nproperty float ny\n"
            "property float nz\nproperty uchar red\nelement face 2\n" FACE) "0 0 0 0 0 1 9\n1 0 0 "
                                                                            "0 0 1 8\n0 1 0 0 1 0 "
                                                                            "7\n3 0 1 2\n2 0 1\n");
    assert_int_equal(mesh.triangle_count, 1);
    assert_true(warns(&mesh, "fewer than three"));
    assert_true(mesh.normals && mesh.normals[7] == 1 && mesh.normals[8] == 0);
    assert_int_equal(mesh.vertex_attribute_count, 1);
    assert_string_equal(mesh.vertex_attributes[0].name, "red");
    io_mesh_free(&mesh);
    mesh = mesh_of_text(PLY("element vertex 2\n" XYZ) "0 0 0\n1 1 1\n");
    assert_true(warns(&mesh, "no faces"));
    assert_int_equal(mesh.vertex_count, 2);
    io_mesh_free(&mesh);
}

static void ply_damage(void **state) {
    (void)state;
    refuse(text_file(PLY("element vertex 3\n" XYZ
                         "element face 1\n" FACE) "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
           NULL, "face 1");
    refuse(text_file(PLY("element vertex 3\n" XYZ
                         "element face 1\n" FACE) "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
           NULL, "face 1");
    refuse(text_file(PLY("element vertex 3\n" XYZ) "0 0 0\n1 0 0\n0 1\n"), NULL, "row 3");
    refuse(text_file(PLY("element vertex 99999999999999999999\n" XYZ)), NULL, "count");
    refuse(text_file(PLY("element vertex 9999999999\n" XYZ) "0"), NULL, "too early");
    refuse(text_file(PLY("element face 1\n" FACE "element vertex 3\n" XYZ) "3 0 1 2\n"), NULL,
           "before its vertices");
    refuse(text_file(PLY("element vertex 3\nproperty float x\n") "0 1 2"), NULL, "lack x, y or z");
    refuse(text_file(PLY("element vertex 3\nproperty quaternion x\n")), NULL, "type");
    refuse(text_file("ply\nformat ascii 1.0\nelement vertex 3\n"), NULL, "end_header");
    refuse(text_file("ply\nformat morse 1.0\nend_header\n"), NULL, "format");
    refuse(text_file("ply\nend_header\n"), NULL, "format");
}

/* Lists may be longer than 255, with a count of any type. */
static void ply_long_lists(void **state) {
    enum { CORNERS = 300 };
    (void)state;
    buffer b =
        text_file("ply\nformat binary_little_endian 1.0\nelement vertex 300\n" XYZ
                  "element face 1\nproperty list ushort ushort vertex_indices\nend_header\n");
    for (unsigned i = 0; i < CORNERS; i++) {
        put_f32(&b, cos(i * 2 * 3.14159265358979 / CORNERS));
        put_f32(&b, sin(i * 2 * 3.14159265358979 / CORNERS));
        put_f32(&b, -1000);
    }
    put_u16(&b, CORNERS);
    for (unsigned i = 0; i < CORNERS; i++)
        put_u16(&b, i);
    io_mesh mesh = read_mesh(&b, NULL);
    assert_int_equal(mesh.triangle_count, CORNERS - 2);
    assert_true(mesh.origin[2] == -1000 && mesh.positions[2] == 0 && mesh.bounds[0][2] == -1000);
    assert_int_equal(edges_of(&mesh).boundary, CORNERS);
    io_mesh_free(&mesh);
    buffer_free(&b);
}

/* ---- OBJ ------------------------------------------------------------------------------------- */

static void obj_lines_are_lines(void **state) {
    const float values[5] = {5, 6, 7, 5, 8};
    (void)state;
    buffer b = text_file("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 2 2\nvt 5\nvt 6\nvt 7\nvt 8\n"
                         "l 1 2 3\nl 3/1 -1\n");
    io_lines lines = {0};
    io_error error;
    assert_true(io_read_lines_memory(b.data, b.size, NULL, NULL, &lines, &error));
    assert_string_equal(lines.format, "obj");
    assert_int_equal(lines.line_count, 2);
    assert_int_equal(lines.point_count, 5);
    assert_true((double)lines.points[3 * 4] + lines.origin[0] == 2);
    assert_string_equal(lines.point_attributes[0].name, "value");
    assert_memory_equal(lines.point_attributes[0].data, values, sizeof values);
    io_lines_free(&lines);
    refuse(b, NULL, "no faces");
    b = text_file("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nl 1 2\n");
    io_contents contents;
    assert_true(io_read_memory(b.data, b.size, NULL, IO_ANYTHING, NULL, &contents, &error));
    assert_int_equal(contents.kinds, IO_LINES | IO_MESH);
    io_contents_free(&contents);
    buffer_free(&b);
}

static void obj_normals_and_colours(void **state) {
    (void)state;
    io_mesh mesh = mesh_of_text("v 0 0 0\nv 1 0 0 1 0.5 0\nv 1 1 0\nvn 0 0 1\nvn 0 1 0\n"
                                "f 1//1 2//2 3//-1\n");
    assert_true(mesh.normals && mesh.normals[2] == 1 && mesh.normals[4] == 1);
    const io_attribute *color = find(mesh.vertex_attributes, mesh.vertex_attribute_count, "color");
    assert_true(color && color->components == 3 && color->data[4] == 0.5f && isnan(color->data[0]));
    io_mesh_free(&mesh);
    mesh = mesh_of_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3\n");
    assert_null(mesh.normals); /* not every corner has one */
    io_mesh_free(&mesh);
}

static void obj_damage(void **state) {
    (void)state;
    refuse(text_file("v 0 0 0\nv 1 0 0\nf 1 2 3\n"), NULL, "line 3");
    refuse(text_file("v 0 0 0\nv 1 0 0\nf 1 2 0\n"), NULL, "line 3");
    refuse(text_file("v 0 0 0\nv 1 0 0\nf 1 2 -3\n"), NULL, "line 3");
    refuse(text_file("v 0 0 0\nf 1/1 1 1\n"), NULL, "line 2");
    refuse(text_file("v 0 0 0\nf 1/2/3/4 1 1\n"), NULL, "line 2");
    refuse(text_file("v 0 0 0\nv 0 zero 0\n"), NULL, "line 2");
    refuse(text_file("v 0 0 0\nvn 1 2\n"), NULL, "line 2");
}

/* ---- VTK ------------------------------------------------------------------------------------- */

#define VTK "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n"

/* Cells count in the order vertices, lines, polygons, strips; so do their arrays. */
static void vtk_cells_in_order(void **state) {
    const uint32_t triangles[12] = {0, 1, 2, 0, 1, 2, 2, 1, 3, 2, 3, 4};
    const float cells[4] = {12, 13, 13, 13}, line = 11;
    (void)state;
    buffer b = text_file(VTK "POINTS 5 float\n0 0 0 1 0 0 0 1 0 1 1 0 0 2 0\nVERTICES 1 2\n1 0\n"
                             "LINES 1 3\n2 0 1\nPOLYGONS 1 4\n3 0 1 2\n"
                             "TRIANGLE_STRIPS 1 6\n5 0 1 2 3 4\nCELL_DATA 4\n"
                             "SCALARS c float\nLOOKUP_TABLE default\n10 11 12 13\n"
                             "POINT_DATA 5\nNORMALS Normals float\n"
                             "0 0 1 0 0 1 0 0 1 0 0 1 0 1 0\n");
    io_contents contents;
    io_error error;
    assert_true(io_read_memory(b.data, b.size, NULL, IO_ANYTHING, NULL, &contents, &error));
    assert_int_equal(contents.kinds, IO_LINES | IO_MESH);
    const io_mesh *mesh = &contents.mesh;
    assert_int_equal(mesh->triangle_count, 4);
    assert_memory_equal(mesh->triangles, triangles, sizeof triangles);
    assert_memory_equal(mesh->triangle_attributes[0].data, cells, sizeof cells);
    assert_memory_equal(contents.lines.line_attributes[0].data, &line, sizeof line);
    assert_true(mesh->normals && mesh->normals[13] == 1);
    io_contents_free(&contents);
    buffer_free(&b);
}

static void vtk_damage(void **state) {
    (void)state;
    refuse(text_file(VTK "POINTS 1 float\n0 0 0\nPOLYGONS 1 4\n3 0 1 2\n"), NULL, "polygon 1");
    refuse(text_file(VTK "POINTS 1 float\n0 0 0\nPOLYGONS 1 4\n9 0 0 0\n"), NULL, "polygon 1");
    refuse(text_file(VTK "POINTS 2 float\n0 0 0 1 1 1\nLINES 1 3\n2 0 1\n"), NULL, "no mesh");
    refuse(make_sample("ascii.vtp"), NULL, "no mesh");
    io_mesh mesh = mesh_of_text(VTK "POINTS 4 float\n0 0 0 1 0 0 0 1 0 inf 0 0\n"
                                    "POLYGONS 2 8\n3 0 1 2\n3 0 1 3\n");
    assert_int_equal(mesh.triangle_count, 1);
    assert_int_equal(mesh.vertex_count, 4);
    assert_true(warns(&mesh, "not finite") && mesh.bounds[1][0] == 1);
    io_mesh_free(&mesh);
}

/* ---- Welding and edges ----------------------------------------------------------------------- */

/* -0 is 0, and the next float is another place. */
static void welding_is_by_bits(void **state) {
    const uint32_t triangles[6] = {0, 1, 2, 0, 3, 2};
    const float n[4] = {0, 1, 2, 4}, k[2] = {7, 9};
    (void)state;
    io_mesh mesh = mesh_of_text(
        PLY("element vertex 6\n" XYZ "property int n\nelement face 3\n" FACE
            "property int k\n") "0 0 0 0\n1 0 0 1\n0 1 0 2\n-0 0 -0.0 3\n1.00000012 0 0 4\n"
                                "0 1 0 5\n3 0 1 2 7\n3 3 0 1 8\n3 3 4 5 9\n");
    weld(&mesh);
    assert_int_equal(mesh.vertex_count, 4);
    assert_int_equal(mesh.triangle_count, 2); /* the second used one vertex twice */
    assert_memory_equal(mesh.triangles, triangles, sizeof triangles);
    assert_memory_equal(mesh.vertex_attributes[0].data, n, sizeof n);
    assert_memory_equal(mesh.triangle_attributes[0].data, k, sizeof k);
    io_mesh_free(&mesh);
    weld(&mesh); /* nothing */
    assert_int_equal(edges_of(&mesh).edges, 0);
}

/* Two separate triangles, and three that share an edge. */
static void edges_are_counted(void **state) {
    (void)state;
    io_mesh mesh = mesh_of_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 0 0\nv 8 0 0\nv 9 1 0\nv 5 5 5\n"
                                "f 1 2 3\nf 4 5 6\n");
    io_mesh_edges edges = edges_of(&mesh);
    assert_int_equal(edges.edges, 6);
    assert_int_equal(edges.boundary, 6);
    assert_int_equal(edges.components, 2);
    io_mesh_free(&mesh);
    mesh = mesh_of_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\n"
                        "f 1 2 3\nf 2 1 4\nf 1 2 5\n");
    edges = edges_of(&mesh);
    assert_int_equal(edges.edges, 7);
    assert_int_equal(edges.boundary, 6);
    assert_int_equal(edges.non_manifold, 1);
    assert_int_equal(edges.components, 1);
    io_mesh_free(&mesh);
}

static void units(void **state) {
    (void)state;
    buffer b = make_mesh_sample("forms.obj");
    io_options options = {0};
    io_error error = {""};
    io_mesh mesh;
    options.unit = "cm";
    assert_true(io_read_mesh_memory(b.data, b.size, NULL, &options, &mesh, &error));
    assert_string_equal(mesh.unit, "cm");
    assert_true(mesh.millimetres == 10 && mesh.bounds[1][0] == 2);
    io_mesh_free(&mesh);
    options.unit = "ell";
    assert_false(io_read_mesh_memory(b.data, b.size, NULL, &options, &mesh, &error));
    assert_non_null(strstr(error.text, "ell"));
    buffer_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_gives_the_mesh),
        cmocka_unit_test(stl_counts),
        cmocka_unit_test(stl_texts),
        cmocka_unit_test(ply_odd_files),
        cmocka_unit_test(ply_damage),
        cmocka_unit_test(ply_long_lists),
        cmocka_unit_test(obj_lines_are_lines),
        cmocka_unit_test(obj_normals_and_colours),
        cmocka_unit_test(obj_damage),
        cmocka_unit_test(vtk_cells_in_order),
        cmocka_unit_test(vtk_damage),
        cmocka_unit_test(welding_is_by_bits),
        cmocka_unit_test(edges_are_counted),
        cmocka_unit_test(units),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
