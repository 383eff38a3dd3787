/* VTP: VTK's XML PolyData; io_xml.c reads the file. */
#include "io_vtk.h"

#include <string.h>

io_match io_sniff_vtp(const io_cursor *bytes) {
    return io_sniff_xml(bytes, NULL);
}

/* ---- Pieces ---------------------------------------------------------------------------------- */

static bool is_numeric(const io_xml_array *a, size_t components) {
    return a && a->type != IO_NONE && (!components || a->components == components);
}

static bool take_cells(io_xml *v, const io_xml_piece *p, io_xml_section section, size_t count,
                       const char *what, io_cells *cells) {
    const io_xml_array *ends = io_xml_find(v, p, section, "offsets"),
                       *indices = io_xml_find(v, p, section, "connectivity"),
                       *points = io_xml_find(v, p, IO_XML_POINTS, NULL);
    size_t total;
    if (!count)
        return true;
    if (!is_numeric(ends, 1) || !is_numeric(indices, 1) || (p->points && !is_numeric(points, 3)))
        return io_fail(v->r, "lacks the arrays Points, offsets or connectivity of its %zu %s",
                       count, what);
    if (!io_xml_take(v, ends, count, &cells->ends))
        return false;
    if (!io_view_index(&cells->ends, count - 1, &total))
        return io_fail(v->r, "has a negative or broken last offset of its %s", what);
    cells->count = count;
    return io_xml_take(v, indices, total, &cells->index);
}

/* Cells count in the order vertices, lines, polygons, strips; a file of lines need not be read
 * beyond these. */
static bool cell_rows(io_xml *v, const io_xml_piece *p, size_t *rows) {
    const size_t counts[] = {p->verts, p->lines, p->polys, p->strips};
    bool of_lines = !(v->r->wanted & IO_MESH);
    *rows = 0;
    for (size_t i = 0; i < (of_lines ? 2 : 4); i++) {
        if (counts[i] > SIZE_MAX - *rows)
            return io_fail(v->r, "has broken cell counts in a Piece");
        *rows += counts[i];
    }
    return true;
}

static bool take_arrays(io_xml *v, const io_xml_piece *p, io_piece *out) {
    io_array *arrays = io_alloc(v->r, p->last - p->first, sizeof *arrays);
    size_t rows;
    if (!arrays || !cell_rows(v, p, &rows))
        return false;
    out->arrays = arrays;
    for (size_t i = p->first; i < p->last; i++) {
        const io_xml_array *a = &v->arrays[i];
        bool of_points = a->section == IO_XML_POINT_DATA;
        if ((!of_points && a->section != IO_XML_CELL_DATA) || a->type == IO_NONE)
            continue;
        if (!a->components || a->components > IO_MAX_COMPONENTS) {
            if (!io_warn(v->r, "the array '%.64s' has %zu values per row; only 1 to %d are read",
                         a->name, a->components, IO_MAX_COMPONENTS))
                return false;
            continue;
        }
        io_array *to = &arrays[out->array_count++];
        to->name = io_text_of(a->name);
        to->of_points = of_points;
        if (!io_xml_take(v, a, of_points ? p->points : rows, &to->values))
            return false;
    }
    return true;
}

static bool take_piece(io_xml *v, const io_xml_piece *p, io_piece *out) {
    const io_xml_array *points = io_xml_find(v, p, IO_XML_POINTS, NULL);
    bool mesh = v->r->wanted & IO_MESH;
    out->vertex_cells = p->verts;
    if (!p->lines && !(mesh && (p->polys || p->strips)))
        return true;
    return take_cells(v, p, IO_XML_LINES, p->lines, "lines", &out->lines) &&
           (!mesh || take_cells(v, p, IO_XML_POLYS, p->polys, "polygons", &out->polygons)) &&
           (!mesh || take_cells(v, p, IO_XML_STRIPS, p->strips, "strips", &out->strips)) &&
           (!p->points || io_xml_take(v, points, p->points, &out->points)) &&
           take_arrays(v, p, out);
}

bool io_read_vtp(io_reader *r, io_cursor *bytes) {
    io_xml v;
    size_t lines = 0, others = 0;
    if (!io_xml_parse(r, bytes, "PolyData", "lines, trees and meshes are read from PolyData (.vtp)",
                      &v))
        return false;
    io_piece *pieces = io_alloc(r, v.piece_count, sizeof *pieces);
    for (size_t i = 0; pieces && i < v.piece_count; i++) {
        const io_xml_piece *p = &v.pieces[i];
        lines += p->lines > 0;
        others += p->polys > 0 || p->strips > 0 || p->points > 0;
        if (!take_piece(&v, p, &pieces[i]))
            return false;
    }
    if (!pieces || !io_build_pieces(r, pieces, v.piece_count))
        return false;
    return lines || !others || r->found != IO_LINES ||
           io_warn(r, "the file holds points or polygons, but no lines");
}

/* ---- Writing --------------------------------------------------------------------------------- */

static void put_name(FILE *file, const char *name) {
    for (; *name; name++) {
        if (*name == '&' || *name == '<' || *name == '>' || *name == '"')
            fprintf(file, "&#%d;", *name);
        else
            putc((unsigned char)*name < 0x20 ? '?' : *name, file);
    }
}

/* One tag for each array; the offsets are those at which put_data writes. */
static void put_tag(FILE *file, const char *type, const char *name, uint32_t components,
                    uint64_t bytes, uint64_t *offset) {
    fprintf(file, "<DataArray type=\"%s\" Name=\"", type);
    put_name(file, name);
    fprintf(file, "\" NumberOfComponents=\"%lu\" format=\"appended\" offset=\"%llu\"/>\n",
            (unsigned long)components, (unsigned long long)*offset);
    *offset += 8 + bytes;
}

static void put_attribute_tags(FILE *file, const char *tag, const io_attribute *attributes,
                               uint32_t count, uint64_t rows, uint64_t *offset) {
    fprintf(file, "<%s>\n", tag);
    for (uint32_t i = 0; i < count; i++)
        put_tag(file, "Float32", attributes[i].name, attributes[i].components,
                4 * rows * attributes[i].components, offset);
    fprintf(file, "</%s>\n", tag);
}

static void put_attributes(FILE *file, const io_attribute *attributes, uint32_t count,
                           uint64_t rows) {
    for (uint32_t i = 0; i < count; i++) {
        uint64_t values = rows * attributes[i].components;
        io_put_u64(file, 4 * values);
        for (uint64_t k = 0; k < values; k++)
            io_put_f32(file, (double)attributes[i].data[k]);
    }
}

static void put_data(FILE *file, const io_lines *lines, bool wide) {
    put_attributes(file, lines->point_attributes, lines->point_attribute_count, lines->point_count);
    put_attributes(file, lines->line_attributes, lines->line_attribute_count, lines->line_count);
    io_put_u64(file, (uint64_t)lines->point_count * (wide ? 24 : 12));
    for (size_t i = 0; i < lines->point_count && !ferror(file); i++)
        for (unsigned axis = 0; axis < 3; axis++)
            (wide ? io_put_f64 : io_put_f32)(file, io_position(lines, i, axis));
    io_put_u64(file, (uint64_t)lines->point_count * 8);
    for (uint64_t i = 0; i < lines->point_count; i++)
        io_put_u64(file, i);
    io_put_u64(file, (uint64_t)lines->line_count * 8);
    for (size_t i = 0; i < lines->line_count; i++)
        io_put_u64(file, lines->offsets[i + 1]);
}

/* Appended raw arrays; positions are doubles where an origin had been taken off, for that is where
 * floats are too coarse. */
bool io_write_vtp(FILE *file, const io_lines *lines, io_error *error) {
    (void)error;
    bool wide = lines->origin[0] != 0 || lines->origin[1] != 0 || lines->origin[2] != 0;
    uint64_t offset = 0, points = lines->point_count, count = lines->line_count;
    fprintf(
        file,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
        "byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"%llu\" NumberOfVerts=\"0\" "
        "NumberOfLines=\"%llu\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
        (unsigned long long)points, (unsigned long long)count);
    put_attribute_tags(file, "PointData", lines->point_attributes, lines->point_attribute_count,
                       points, &offset);
    put_attribute_tags(file, "CellData", lines->line_attributes, lines->line_attribute_count, count,
                       &offset);
    fputs("<Points>\n", file);
    put_tag(file, wide ? "Float64" : "Float32", "Points", 3, points * (wide ? 24 : 12), &offset);
    fputs("</Points>\n<Lines>\n", file);
    put_tag(file, "Int64", "connectivity", 1, points * 8, &offset);
    put_tag(file, "Int64", "offsets", 1, count * 8, &offset);
    fputs("</Lines>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_", file);
    put_data(file, lines, wide);
    fputs("\n</AppendedData>\n</VTKFile>\n", file);
    return true;
}
