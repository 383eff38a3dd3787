/* VTK legacy files, DATASET POLYDATA; io_legacy.c reads the file. */
#include "io_vtk.h"

#include <string.h>

io_match io_sniff_vtk(const io_cursor *bytes) {
    return io_sniff_legacy(bytes, NULL);
}

static bool build(io_legacy *v) {
    io_reader *r = v->r;
    size_t cells = v->vertex_cells + v->lines.count + v->other_cells;
    if (!v->lines.count && v->other_cells &&
        !io_warn(r, "the file holds %zu polygons, but no lines", v->other_cells))
        return false;
    if (!cells && v->points.count &&
        !io_warn(r, "the file holds %zu points, but no lines", v->points.count))
        return false;
    if (!io_add_cells(r, &v->points, &v->lines, v->vertex_cells))
        return false;
    for (size_t i = 0; i < v->array_count; i++) {
        const io_legacy_array *a = &v->arrays[i];
        size_t expected = a->of_points ? v->points.count : cells;
        if (a->values.count != expected &&
            !io_warn(r, "the array '%.*s' has %zu rows for %zu %s",
                     (int)(a->name.size < 64 ? a->name.size : 64), a->name.at, a->values.count,
                     expected, a->of_points ? "points" : "cells"))
            return false;
        if (!(a->of_points ? io_attach_points : io_attach_lines)(r, a->name, &a->values))
            return false;
    }
    return true;
}

bool io_read_vtk(io_reader *r, io_cursor *bytes) {
    io_legacy v;
    return io_legacy_parse(r, bytes, "POLYDATA", "lines are read from", &v) && build(&v);
}
