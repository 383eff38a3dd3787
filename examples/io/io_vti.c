/* Grids of VTK: XML ImageData (.vti) and legacy STRUCTURED_POINTS (.vtk); io_xml.c and io_legacy.c
 * read the files. Arrays of cells are taken at the cells' centres when there are none of points. */
#include "io_grid.h"
#include "io_vtk.h"

#include <math.h>
#include <string.h>

io_match io_sniff_vti(const io_cursor *bytes) {
    return io_sniff_xml(bytes, "ImageData") == IO_YES ? IO_YES : IO_NO;
}

io_match io_sniff_points(const io_cursor *bytes) {
    return io_sniff_legacy(bytes, "STRUCTURED_POINTS");
}

/* ---- Grid ------------------------------------------------------------------------------------ */

static double determinant(const double m[9]) {
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
           m[2] * (m[3] * m[7] - m[4] * m[6]);
}

/* first: index of the grid's first point, or cell centre, on each axis. Spacing of 0 is as good as
 * not told. */
static bool set_affine(io_reader *r, const io_image *image, const double first[3], io_grid *grid) {
    grid->has_spacing = image->has_spacing && image->spacing[0] != 0 && image->spacing[1] != 0 &&
                        image->spacing[2] != 0;
    if (!(fabs(determinant(image->direction)) > 1e-9))
        return io_fail(r, "has a Direction that is no orientation");
    for (size_t row = 0; row < 3; row++) {
        grid->to_mm[row][3] = image->origin[row];
        for (size_t column = 0; column < 3; column++) {
            double step = image->direction[3 * row + column] *
                          (grid->has_spacing ? fabs(image->spacing[column]) : 1);
            grid->to_mm[row][column] = step;
            grid->to_mm[row][3] += step * first[column];
            if (!(fabs(step) < 1e9))
                return io_fail(r, "has a broken Spacing or Direction");
        }
        if (!(fabs(grid->to_mm[row][3]) < 1e12))
            return io_fail(r, "has a broken Origin");
    }
    return true;
}

/* cells: the grid of cell centres. */
static bool set_grid(io_reader *r, const io_image *image, bool cells, io_grid *grid) {
    uint64_t size[3];
    double first[3];
    for (size_t axis = 0; axis < 3; axis++) {
        int64_t low = image->extent[2 * axis], high = image->extent[2 * axis + 1];
        if (high < low)
            return io_fail(r, "has an empty extent %lld .. %lld", (long long)low, (long long)high);
        size[axis] = (uint64_t)(high - low) + 1;
        first[axis] = (double)low;
        if (cells && size[axis] > 1) {
            size[axis]--;
            first[axis] += 0.5;
        }
    }
    return set_affine(r, image, first, grid) && io_grid_size(r, grid, size);
}

/* ---- XML ------------------------------------------------------------------------------------- */

static bool is_number_array(const io_xml_array *a, io_xml_section in) {
    return a->section == in && a->type != IO_NONE && a->components &&
           a->components <= IO_MAX_COMPONENTS;
}

/* Its part of the whole extent, in points or cells from the grid's first; false: reported. */
static bool piece_part(io_reader *r, const io_xml *x, const io_xml_piece *piece, bool cells,
                       const io_grid *grid, size_t first[3], size_t size[3]) {
    for (size_t axis = 0; axis < 3; axis++) {
        double low = piece->extent[2 * axis], high = piece->extent[2 * axis + 1];
        double begin = (double)x->image.extent[2 * axis],
               end = (double)x->image.extent[2 * axis + 1];
        if (!piece->has_extent && x->piece_count == 1) {
            low = begin;
            high = end;
        }
        if (!(low >= begin && high <= end && low <= high) || floor(low) != low ||
            floor(high) != high)
            return io_fail(r, "has a Piece whose Extent is not within the WholeExtent");
        first[axis] = (size_t)(low - begin);
        size[axis] = (size_t)(high - low) + 1;
        if (cells && size[axis] > 1)
            size[axis]--;
        if (first[axis] + size[axis] > grid->size[axis])
            return io_fail(r, "has a Piece whose Extent is not within the WholeExtent");
    }
    return true;
}

/* Copies the rows of a piece to their place in the whole. */
static void place_piece(const io_view *view, const size_t first[3], const size_t size[3],
                        const io_grid *grid, uint8_t *out) {
    size_t stride = view->stride;
    for (size_t z = 0; z < size[2]; z++)
        for (size_t y = 0; y < size[1]; y++)
            memcpy(out + stride * (first[0] +
                                   grid->size[0] * (first[1] + y + grid->size[1] * (first[2] + z))),
                   view->bytes + stride * size[0] * (y + size[1] * z), stride * size[0]);
}

static bool load_xml(io_reader *r, io_grid *grid, io_field *field) {
    io_xml *x = grid->file;
    const io_xml_array *like = field->place;
    bool cells = like->section == IO_XML_CELL_DATA;
    size_t voxels = io_grid_voxels(grid), covered = 0;
    uint8_t *whole = NULL;
    for (size_t i = 0; i < x->piece_count; i++) {
        const io_xml_piece *piece = &x->pieces[i];
        const io_xml_array *a = io_xml_find(x, piece, like->section, like->name);
        size_t first[3], size[3];
        io_view view;
        if (!piece_part(r, x, piece, cells, grid, first, size))
            return false;
        if (!a || a->components != like->components ||
            io_type_size(a->type) != io_type_size(like->type))
            return io_fail(r, "lacks the array '%.64s' in a Piece", like->name);
        if (!io_xml_take(x, a, size[0] * size[1] * size[2], &view))
            return false;
        field->type = view.type; /* text becomes doubles */
        field->big = view.big;
        field->bytes = view.bytes;
        covered += view.count;
        if (view.count == voxels)
            break;
        if (!whole && !(whole = io_alloc(r, voxels, view.stride)))
            return false;
        place_piece(&view, first, size, grid, whole);
        field->bytes = whole;
    }
    io_field_packed(field, grid);
    return covered >= voxels ||
           io_fail(r, "has %zu voxels in its Pieces, but %zu in its WholeExtent", covered, voxels);
}

static size_t count_arrays(const io_xml *x, io_xml_section in) {
    size_t count = 0;
    for (size_t i = x->pieces[0].first; i < x->pieces[0].last; i++)
        count += is_number_array(&x->arrays[i], in);
    return count;
}

bool io_open_vti(io_reader *r, io_cursor *bytes, io_grid *grid) {
    io_xml *x = io_alloc(r, 1, sizeof *x);
    if (!x || !io_xml_parse(r, bytes, "ImageData", "volumes are read from ImageData (.vti)", x))
        return false;
    if (!x->image.has_extent || !x->piece_count)
        return io_fail(r, "has no WholeExtent or no Piece");
    bool cells = !count_arrays(x, IO_XML_POINT_DATA) && count_arrays(x, IO_XML_CELL_DATA);
    io_xml_section section = cells ? IO_XML_CELL_DATA : IO_XML_POINT_DATA;
    if (!set_grid(r, &x->image, cells, grid))
        return false;
    grid->file = x;
    grid->load = load_xml;
    grid->vectors = x->vectors;
    for (size_t i = x->pieces[0].first; i < x->pieces[0].last; i++) {
        if (!is_number_array(&x->arrays[i], section))
            continue;
        io_field *field = io_add_field(r, grid, io_text_of(x->arrays[i].name));
        if (!field)
            return false;
        field->components = (uint32_t)x->arrays[i].components;
        field->place = &x->arrays[i];
    }
    return true;
}

/* ---- Legacy ---------------------------------------------------------------------------------- */

bool io_open_points(io_reader *r, io_cursor *bytes, io_grid *grid) {
    io_legacy v;
    size_t of_points = 0;
    if (!io_legacy_parse(r, bytes, "STRUCTURED_POINTS", "volumes are read from", &v))
        return false;
    if (!v.image.has_extent)
        return io_fail(r, "has no DIMENSIONS");
    for (size_t i = 0; i < v.array_count; i++)
        of_points += v.arrays[i].of_points;
    if (!set_grid(r, &v.image, !of_points && v.array_count, grid))
        return false;
    for (size_t i = 0; i < v.array_count; i++) {
        const io_array *a = &v.arrays[i];
        if (a->of_points != (of_points > 0))
            continue;
        if (a->values.count != io_grid_voxels(grid) || a->values.components > IO_MAX_COMPONENTS) {
            if (!io_warn(r, "the array '%.*s' has %zu rows for %zu voxels and is left out",
                         (int)(a->name.size < 64 ? a->name.size : 64), a->name.at, a->values.count,
                         io_grid_voxels(grid)))
                return false;
            continue;
        }
        io_field *field = io_add_field(r, grid, a->name);
        if (!field)
            return false;
        field->components = a->values.components;
        field->type = a->values.type;
        field->big = a->values.big;
        field->bytes = a->values.bytes;
        io_field_packed(field, grid);
    }
    return true;
}
