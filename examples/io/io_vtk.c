/* VTK legacy files, DATASET POLYDATA; io_legacy.c reads the file. */
#include "io_vtk.h"

#include <string.h>

io_match io_sniff_vtk(const io_cursor *bytes) {
    return io_sniff_legacy(bytes, NULL);
}

bool io_read_vtk(io_reader *r, io_cursor *bytes) {
    io_legacy v;
    if (!io_legacy_parse(r, bytes, "POLYDATA", "lines, trees and meshes are read from", &v))
        return false;
    io_piece piece = {v.points, v.vertices.count, v.lines,      v.polygons,
                      v.strips, v.arrays,         v.array_count};
    size_t cells = v.vertices.count + v.lines.count + v.polygons.count + v.strips.count;
    for (size_t i = 0; i < v.array_count; i++) {
        const io_array *a = &v.arrays[i];
        size_t expected = a->of_points ? v.points.count : cells;
        if (a->values.count != expected &&
            !io_warn(r, "the array '%.*s' has %zu rows for %zu %s",
                     (int)(a->name.size < 64 ? a->name.size : 64), a->name.at, a->values.count,
                     expected, a->of_points ? "points" : "cells"))
            return false;
    }
    if (!io_build_pieces(r, &piece, 1))
        return false;
    if (v.lines.count || r->found != IO_LINES)
        return true;
    if (v.polygons.count + v.strips.count)
        return io_warn(r, "the file holds %zu polygons, but no lines",
                       v.polygons.count + v.strips.count);
    return cells || !v.points.count ||
           io_warn(r, "the file holds %zu points, but no lines", v.points.count);
}
