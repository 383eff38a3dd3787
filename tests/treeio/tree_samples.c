/* See tree_samples.h. */
#include "tree_samples.h"

#include <hdf5.h>
#include <stdlib.h>
#include <string.h>

/* ---- The tree -------------------------------------------------------------------------------- */

const double tree_positions[TREE_NODES][3] = {
    {0, 0, 0}, {0, 0, 4}, {1, 0, 8}, {-1, 0.5, 8}, {-1, 2, 12}};
const double tree_radii[TREE_NODES] = {2, 1.5, 1, 0.5, 0.25};
const uint32_t tree_segments[TREE_SEGMENTS][2] = {{0, 1}, {1, 2}, {1, 3}, {3, 4}};

buffer text_file(const char *text) {
    buffer b = {0};
    put_text(&b, text);
    return b;
}

static buffer swc_with(const char *head, const char *gap, const char *end) {
    static const int parents[TREE_NODES] = {-1, 1, 2, 2, 4};
    buffer b = text_file(head);
    for (size_t i = 0; i < TREE_NODES; i++) {
        const double *p = tree_positions[i];
        put_format(&b, "%d%s%d%s%g%s%g%s%g%s%g%s%d%s", (int)i + 1, gap, i ? 3 : 1, gap, p[0], gap,
                   p[1], gap, p[2], gap, tree_radii[i], gap, parents[i], end);
    }
    return b;
}

static buffer swc(void) {
    return swc_with("", " ", "\n");
}
static buffer swc_dos(void) {
    return swc_with("\xEF\xBB\xBF# Units: micron\r\n\r\n", "\t", " \t\r\n");
}
static buffer swc_gz(void) {
    buffer b = swc(), packed = gzip_of(&b);
    buffer_free(&b);
    return packed;
}

/* Ids with gaps, children before parents, floats for whole numbers, more columns, roots of parent
 * 0: the order of nodes is that of the lines all the same. */
static buffer swc_odd(void) {
    return text_file("# unit cm\n"
                     "  70 1.0 0 0 0 2 0 9 9 # the root\n"
                     "+8 3 0.0e0 0 4. 1.5 70.0 1 1\n"
                     "200 3 1 0 8 1 8 1 1\n"
                     "3 3 -1 .5 8 5e-1 8 1 1\n"
                     "1 3 -1 2 12 .25 3 1 1");
}

static void put_gxl_node(buffer *b, size_t i) {
    put_format(b,
               "<node id=\"n%zu\"><attr name=\" nodeType\"><string> bifurication </string></attr>"
               "<attr name=\" position\"><tup><float>%g</float><float> %g </float><float>%g"
               "</float></tup></attr></node>\n",
               i, tree_positions[i][0], tree_positions[i][1], tree_positions[i][2]);
}

static void put_gxl_edge(buffer *b, size_t i) {
    put_format(b,
               "<edge id=\"e%zu\" to=\"n%u\" from=\"n%u\"><attr name=\" flow\"><float>%g</float>"
               "</attr><attr name=\" radius\"><float>%g</float></attr></edge>\n",
               i, tree_segments[i][1], tree_segments[i][0], 10 - (double)i,
               tree_radii[tree_segments[i][1]]);
}

static buffer gxl(void) {
    buffer b =
        text_file("\n<gxl><graph id=\"t\" edgeids=\" true\"><info_graph><attr name=\" pPerf\">"
                  "<float>13300</float></attr></info_graph>\n");
    for (size_t i = 0; i < TREE_NODES; i++)
        put_gxl_node(&b, i);
    for (size_t i = 0; i < TREE_SEGMENTS; i++)
        put_gxl_edge(&b, i);
    put_text(&b, "</graph></gxl>\n");
    return b;
}

/* Edges before the nodes they join. */
static buffer gxl_edges_first(void) {
    buffer b = text_file("<?xml version=\"1.0\"?>\n<gxl><graph>\n");
    for (size_t i = 0; i < TREE_SEGMENTS; i++)
        put_gxl_edge(&b, i);
    for (size_t i = 0; i < TREE_NODES; i++)
        put_gxl_node(&b, i);
    put_text(&b, "</graph></gxl>\n");
    return b;
}

static buffer vmv(void) {
    buffer b = text_file("$PARAM_BEGIN\nNUM_VERTS\t5\nNUM_STRANDS\t3\nNUM_ATTRIB_PER_VERT\t5\n"
                         "$PARAM_END\n\n$VERT_LIST_BEGIN\n");
    for (size_t i = 0; i < TREE_NODES; i++)
        put_format(&b, "%zu\t%f\t%f\t%f\t%f\t110.000000\t\n", i + 1, tree_positions[i][0],
                   tree_positions[i][1], tree_positions[i][2], tree_radii[i]);
    put_text(&b, "$VERT_LIST_END\n\n$STRANDS_LIST_BEGIN\n1\t1\t2\t\n2\t2\t3\n3\t5\t4\t2\n"
                 "$STRANDS_LIST_END\n\n");
    return b;
}

/* ---- HDF5 ------------------------------------------------------------------------------------ */

static void put_table(hid_t file, const char *name, int rank, size_t rows, size_t columns,
                      hid_t type, const double *values) {
    const hsize_t extent[2] = {rows, columns};
    hid_t space = H5Screate_simple(rank, extent, NULL);
    hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (set < 0 || H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        abort();
    H5Dclose(set);
    H5Sclose(space);
}

/* A file in memory; take_image closes it. */
static hid_t new_file(hid_t *access) {
    *access = H5Pcreate(H5P_FILE_ACCESS);
    if (H5Pset_fapl_core(*access, 1024, 0) < 0)
        abort();
    return H5Fcreate("sample", H5F_ACC_TRUNC, H5P_DEFAULT, *access);
}

static buffer take_image(hid_t file, hid_t access) {
    H5Fflush(file, H5F_SCOPE_LOCAL);
    ssize_t size = H5Fget_file_image(file, NULL, 0);
    uint8_t *image = size > 0 ? malloc((size_t)size) : NULL;
    if (!image || H5Fget_file_image(file, image, (size_t)size) != size)
        abort();
    buffer b = {0};
    put(&b, image, (size_t)size);
    free(image);
    H5Fclose(file);
    H5Pclose(access);
    return b;
}

buffer make_h5(const double (*points)[4], size_t point_count, const double *structure,
               size_t section_count, size_t width, const double (*links)[2], size_t link_count) {
    hid_t access, file = new_file(&access);
    put_table(file, "points", 2, point_count, 4, H5T_IEEE_F64LE, points ? points[0] : NULL);
    put_table(file, "structure", width > 1 ? 2 : 1, section_count, width, H5T_STD_U64BE, structure);
    put_table(file, "connectivity", 2, link_count, 2, H5T_STD_I64LE, links ? links[0] : NULL);
    return take_image(file, access);
}

buffer make_h5_section(const double (*points)[4], size_t point_count, const h5_table *more,
                       size_t more_count) {
    const double first = 0;
    hid_t access, file = new_file(&access);
    put_table(file, "points", 2, point_count, 4, H5T_IEEE_F64LE, points[0]);
    put_table(file, "structure", 1, 1, 1, H5T_STD_U64BE, &first);
    put_table(file, "connectivity", 2, 0, 2, H5T_STD_I64LE, NULL);
    for (size_t i = 0; i < more_count; i++)
        put_table(file, more[i].name, more[i].columns > 1 ? 2 : 1, point_count, more[i].columns,
                  H5T_IEEE_F32LE, more[i].values);
    return take_image(file, access);
}

static void point_of(size_t node, double out[4]) {
    memcpy(out, tree_positions[node], sizeof tree_positions[node]);
    out[3] = 2 * tree_radii[node]; /* the diameter */
}

/* Sections 0 1, 1 2, 1 3 4; the last does not repeat the point of its parent. */
static buffer h5_with(size_t width) {
    static const size_t nodes[] = {0, 1, 1, 2, 3, 4};
    double points[6][4];
    const double first[3] = {0, 2, 4}, wide[6] = {0, 2, 2, 2, 4, 2};
    const double links[2][2] = {{0, 1}, {0, 2}};
    for (size_t i = 0; i < 6; i++)
        point_of(nodes[i], points[i]);
    return make_h5((const double(*)[4])points, 6, width > 1 ? wide : first, 3, width, links, 2);
}

static buffer h5(void) {
    return h5_with(1);
}
static buffer h5_types(void) {
    return h5_with(2);
}

/* ---- VTK ------------------------------------------------------------------------------------- */

/* Points 0 1 2 and again 1, 3 4: the trunk is repeated, as VMTK does. */
static const size_t repeated[6] = {0, 1, 2, 1, 3, 4};

static void put_vtk_head(buffer *b, const char *version, const char *encoding) {
    put_format(b, "# vtk DataFile Version %s\nvtk output\n%s\nDATASET POLYDATA\n", version,
               encoding);
}

static void put_points(buffer *b, const size_t *nodes, size_t count) {
    for (size_t i = 0; i < count; i++)
        put_format(b, "%g %g %g\n", tree_positions[nodes[i]][0], tree_positions[nodes[i]][1],
                   tree_positions[nodes[i]][2]);
}

/* VMTK: long lines, repeated points, MaximumInscribedSphereRadius. */
static buffer vtk_vmtk(void) {
    buffer b = {0};
    put_vtk_head(&b, "3.0", "ASCII");
    put_text(&b, "POINTS 6 float\n");
    put_points(&b, repeated, 6);
    put_text(&b, "LINES 2 8\n3 0 1 2\n3 3 4 5\nPOINT_DATA 6\nSCALARS MaximumInscribedSphereRadius "
                 "double 1\nLOOKUP_TABLE default\n");
    for (size_t i = 0; i < 6; i++)
        put_format(&b, "%g ", tree_radii[repeated[i]]);
    return b;
}

/* vascpy: cells of two points that share points, diameters on points. */
static buffer vtk_diameters(void) {
    static const size_t nodes[TREE_NODES] = {0, 1, 2, 3, 4};
    buffer b = {0};
    put_vtk_head(&b, "4.2", "ASCII");
    put_text(&b, "POINTS 5 float\n");
    put_points(&b, nodes, TREE_NODES);
    put_text(&b, "LINES 4 12\n2 0 1\n2 1 2\n2 1 3\n2 3 4\nPOINT_DATA 5\nFIELD FieldData 1\n"
                 "diameter 1 5 float\n");
    for (size_t i = 0; i < TREE_NODES; i++)
        put_format(&b, "%g ", 2 * tree_radii[i]);
    return b;
}

/* The same in VTK 5.1 and big-endian, with radii on cells. */
static buffer vtk_cells(void) {
    buffer b = {0};
    b.big = true;
    put_vtk_head(&b, "5.1", "BINARY");
    put_text(&b, "POINTS 5 double\n");
    for (size_t i = 0; i < TREE_NODES; i++)
        for (size_t axis = 0; axis < 3; axis++)
            put_f64(&b, tree_positions[i][axis]);
    put_text(&b, "\nLINES 5 8\nOFFSETS vtktypeint64\n");
    for (size_t i = 0; i <= TREE_SEGMENTS; i++)
        put_u64(&b, 2 * i);
    put_text(&b, "\nCONNECTIVITY vtktypeint64\n");
    for (size_t i = 0; i < TREE_SEGMENTS; i++) {
        put_u64(&b, tree_segments[i][0]);
        put_u64(&b, tree_segments[i][1]);
    }
    put_text(&b, "\nCELL_DATA 4\nFIELD FieldData 1\nradius 1 4 float\n");
    for (size_t i = 0; i < TREE_SEGMENTS; i++)
        put_f32(&b, tree_radii[tree_segments[i][1]]);
    put_text(&b, "\n");
    return b;
}

static void put_vtp_array(buffer *b, const char *type, const char *name, unsigned components) {
    put_format(b, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%u\" format=\"ascii\">",
               type, name, components);
}

/* Two pieces, one line each, that meet where their points are equal. */
static buffer vtp_pieces(void) {
    buffer b = text_file("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
                         "byte_order=\"LittleEndian\"><PolyData>\n");
    for (size_t piece = 0; piece < 2; piece++) {
        put_text(&b, "<Piece NumberOfPoints=\"3\" NumberOfLines=\"1\"><PointData>");
        put_vtp_array(&b, "Float64", "MaximumInscribedSphereRadius", 1);
        for (size_t i = 0; i < 3; i++)
            put_format(&b, "%g ", tree_radii[repeated[3 * piece + i]]);
        put_text(&b, "</DataArray></PointData><Points>");
        put_vtp_array(&b, "Float32", "Points", 3);
        put_points(&b, repeated + 3 * piece, 3);
        put_text(&b, "</DataArray></Points><Lines>");
        put_vtp_array(&b, "Int64", "connectivity", 1);
        put_text(&b, "0 1 2</DataArray>");
        put_vtp_array(&b, "Int32", "offsets", 1);
        put_text(&b, "3</DataArray></Lines></Piece>\n");
    }
    put_text(&b, "</PolyData></VTKFile>\n");
    return b;
}

// clang-format off
const tree_sample tree_samples[] = {
    {"plain.swc",        swc,             "swc", "mm", false, true},
    {"dos.swc",          swc_dos,         "swc", "um", false, false},
    {"packed.swc.gz",    swc_gz,          "swc", "mm", false, true},
    {"odd.swc",          swc_odd,         "swc", "cm", false, false},
    {"plain.gxl",        gxl,             "gxl", "mm", true,  true},
    {"edges_first.xml",  gxl_edges_first, "gxl", "mm", true,  true},
    {"plain.vmv",        vmv,             "vmv", "um", false, false},
    {"plain.h5",         h5,              "h5",  "um", false, false},
    {"types.h5",         h5_types,        "h5",  "um", false, false},
    {"vmtk.vtk",         vtk_vmtk,        "vtk", "mm", false, true},
    {"diameters.vtk",    vtk_diameters,   "vtk", "um", false, true},
    {"cells.vtk",        vtk_cells,       "vtk", "um", true,  true},
    {"pieces.vtp",       vtp_pieces,      "vtp", "mm", false, true},
};
// clang-format on
const size_t tree_sample_count = sizeof tree_samples / sizeof tree_samples[0];

/* ---- The mesh -------------------------------------------------------------------------------- */

const double mesh_positions[MESH_VERTICES][3] = {
    {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 3}};
const uint32_t mesh_triangles[MESH_TRIANGLES][3] = {{0, 3, 2}, {0, 2, 1}, {0, 1, 4},
                                                    {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
enum { FACES = 5 };
static const size_t face_sizes[FACES] = {4, 3, 3, 3, 3};
static const uint32_t faces[FACES][4] = {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};

double mesh_stress(size_t vertex) {
    return 0.5 * (double)vertex;
}

double mesh_part(size_t triangle) {
    return triangle < 2 ? 0 : (double)triangle - 1;
}

static buffer stl_binary(void) {
    buffer b = {0};
    char head[80] = "solid facet of a program that does not know better";
    put(&b, head, 80);
    put_u32(&b, MESH_TRIANGLES);
    for (size_t i = 0; i < MESH_TRIANGLES; i++) {
        put_zeros(&b, 12);
        for (size_t k = 0; k < 9; k++)
            put_f32(&b, mesh_positions[mesh_triangles[i][k / 3]][k % 3]);
        put_u16(&b, 0);
    }
    return b;
}

static buffer stl_ascii(void) {
    buffer b = text_file(" solid a vertex of facet 7\r\n");
    for (size_t i = 0; i < MESH_TRIANGLES; i++) {
        put_text(&b, "  facet normal 0 0 0\r\n    outer loop\r\n");
        for (size_t k = 0; k < 3; k++) {
            const double *p = mesh_positions[mesh_triangles[i][k]];
            put_format(&b, "      vertex %e %e %e\r\n", p[0], p[1], p[2]);
        }
        put_text(&b, "    endloop\r\n  endfacet\r\n");
    }
    put_text(&b, "endsolid a vertex of facet 7\r\n");
    return b;
}

static void put_ply_head(buffer *b, const char *format, const char *end) {
    static const char *const lines[] = {
        "comment made by code", "element vertex 5",
        "property float x",     "property float32 y",
        "property double z",    "property float wss",
        "element extra 1",      "property list uint8 ushort a",
        "element face 5",       "property list uchar uint vertex_indices",
        "property int part",    "end_header"};
    put_format(b, "ply%sformat %s 1.0%s", end, format, end);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        put_format(b, "%s%s", lines[i], end);
}

static buffer ply_ascii(void) {
    buffer b = {0};
    put_ply_head(&b, "ascii", "\r\n");
    for (size_t i = 0; i < MESH_VERTICES; i++)
        put_format(&b, "%g %g %g %g\r\n", mesh_positions[i][0], mesh_positions[i][1],
                   mesh_positions[i][2], mesh_stress(i));
    put_text(&b, "2 7 8\r\n");
    for (size_t i = 0; i < FACES; i++) {
        put_format(&b, "%zu", face_sizes[i]);
        for (size_t k = 0; k < face_sizes[i]; k++)
            put_format(&b, " %u", faces[i][k]);
        put_format(&b, " %zu\r\n", i);
    }
    return b;
}

static buffer ply_binary(bool big) {
    buffer b = {0};
    b.big = big;
    put_ply_head(&b, big ? "binary_big_endian" : "binary_little_endian", "\n");
    for (size_t i = 0; i < MESH_VERTICES; i++) {
        put_f32(&b, mesh_positions[i][0]);
        put_f32(&b, mesh_positions[i][1]);
        put_f64(&b, mesh_positions[i][2]);
        put_f32(&b, mesh_stress(i));
    }
    put_u8(&b, 2);
    put_u16(&b, 7);
    put_u16(&b, 8);
    for (size_t i = 0; i < FACES; i++) {
        put_u8(&b, (unsigned)face_sizes[i]);
        for (size_t k = 0; k < face_sizes[i]; k++)
            put_u32(&b, faces[i][k]);
        put_u32(&b, (uint32_t)i);
    }
    return b;
}

static buffer ply_little(void) {
    return ply_binary(false);
}
static buffer ply_big(void) {
    return ply_binary(true);
}

/* All forms of corners: alone, with texture, with normal, with both, from the end; a line that goes
 * on. */
static buffer obj(void) {
    buffer b = text_file("# made by code\nmtllib a.mtl\no pyramid\n");
    for (size_t i = 0; i < MESH_VERTICES; i++)
        put_format(&b, "v %g %g %g\n", mesh_positions[i][0], mesh_positions[i][1],
                   mesh_positions[i][2]);
    put_text(&b, "vt 0 0\nvn 0 0 1\nusemtl a\ns off\nf 1 4 \\\n 3 2\nf 1/1 2/1 5/1\n"
                 "f 2//1 3//1 5//1\r\nf 3/1/1 4/1/1 5/1/1 # a face\nf -2 -5 -1\n");
    return b;
}

static void put_mesh_data(buffer *b) {
    put_text(b, "CELL_DATA 5\nSCALARS part int\nLOOKUP_TABLE default\n0 1 2 3 4\nPOINT_DATA 5\n"
                "FIELD FieldData 1\nwss 1 5 float\n");
    for (size_t i = 0; i < MESH_VERTICES; i++)
        put_format(b, "%g ", mesh_stress(i));
    put_text(b, "\n");
}

static buffer vtk_polygons(void) {
    buffer b = {0};
    put_vtk_head(&b, "3.0", "ASCII");
    put_text(&b, "POINTS 5 float\n");
    for (size_t i = 0; i < MESH_VERTICES; i++)
        put_format(&b, "%g %g %g ", mesh_positions[i][0], mesh_positions[i][1],
                   mesh_positions[i][2]);
    put_text(&b, "\nPOLYGONS 5 21\n");
    for (size_t i = 0; i < FACES; i++) {
        put_format(&b, "%zu", face_sizes[i]);
        for (size_t k = 0; k < face_sizes[i]; k++)
            put_format(&b, " %u", faces[i][k]);
        put_text(&b, "\n");
    }
    put_mesh_data(&b);
    return b;
}

/* VTK 5.1, big-endian. */
static buffer vtk_modern(void) {
    buffer b = {0};
    size_t at = 0;
    b.big = true;
    put_vtk_head(&b, "5.1", "BINARY");
    put_text(&b, "POINTS 5 float\n");
    for (size_t i = 0; i < 3 * MESH_VERTICES; i++)
        put_f32(&b, mesh_positions[i / 3][i % 3]);
    put_text(&b, "\nPOLYGONS 6 16\nOFFSETS vtktypeint64\n");
    put_u64(&b, 0);
    for (size_t i = 0; i < FACES; i++)
        put_u64(&b, at += face_sizes[i]);
    put_text(&b, "\nCONNECTIVITY vtktypeint64\n");
    for (size_t i = 0; i < FACES; i++)
        for (size_t k = 0; k < face_sizes[i]; k++)
            put_u64(&b, faces[i][k]);
    put_text(&b, "\n");
    return b;
}

static buffer vtp(void) {
    buffer b = text_file("<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"5\" "
                         "NumberOfPolys=\"5\"><PointData>");
    size_t at = 0;
    put_vtp_array(&b, "Float32", "wss", 1);
    for (size_t i = 0; i < MESH_VERTICES; i++)
        put_format(&b, "%g ", mesh_stress(i));
    put_text(&b, "</DataArray></PointData><CellData>");
    put_vtp_array(&b, "Int32", "part", 1);
    put_text(&b, "0 1 2 3 4</DataArray></CellData><Points>");
    put_vtp_array(&b, "Float32", "Points", 3);
    for (size_t i = 0; i < 3 * MESH_VERTICES; i++)
        put_format(&b, "%g ", mesh_positions[i / 3][i % 3]);
    put_text(&b, "</DataArray></Points><Polys>");
    put_vtp_array(&b, "Int64", "connectivity", 1);
    for (size_t i = 0; i < FACES; i++)
        for (size_t k = 0; k < face_sizes[i]; k++)
            put_format(&b, "%u ", faces[i][k]);
    put_text(&b, "</DataArray>");
    put_vtp_array(&b, "UInt8", "offsets", 1);
    for (size_t i = 0; i < FACES; i++)
        put_format(&b, "%zu ", at += face_sizes[i]);
    put_text(&b, "</DataArray></Polys></Piece></PolyData></VTKFile>\n");
    return b;
}

// clang-format off
const mesh_sample mesh_samples[] = {
    {"solid.stl",    stl_binary,   "stl", false, false, true},
    {"text.stl",     stl_ascii,    "stl", false, false, true},
    {"ascii.ply",    ply_ascii,    "ply", true,  true,  false},
    {"little.ply",   ply_little,   "ply", true,  true,  false},
    {"big.ply",      ply_big,      "ply", true,  true,  false},
    {"forms.obj",    obj,          "obj", false, false, false},
    {"polygons.vtk", vtk_polygons, "vtk", true,  true,  false},
    {"modern.vtk",   vtk_modern,   "vtk", false, false, false},
    {"polygons.vtp", vtp,          "vtp", true,  true,  false},
};
// clang-format on
const size_t mesh_sample_count = sizeof mesh_samples / sizeof mesh_samples[0];

buffer make_tree_sample(const char *name) {
    for (size_t i = 0; i < tree_sample_count; i++)
        if (!strcmp(tree_samples[i].name, name))
            return tree_samples[i].make();
    abort();
}

buffer make_mesh_sample(const char *name) {
    for (size_t i = 0; i < mesh_sample_count; i++)
        if (!strcmp(mesh_samples[i].name, name))
            return mesh_samples[i].make();
    abort();
}
