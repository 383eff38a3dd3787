/* Included by the shaders that read a field: its lists are what the host made (texel buffers) or what the rows up to
   vessel_grid made (images). */
vec4 cell_fetch(int i) {
    if (lao_constant_has_vessel_cells != 0) {
        return texelFetch(cells, i);
    }
    return texelFetch(grid, sdv_item(i), 0);
}
float id_fetch(int i) {
    if (lao_constant_has_vessel_cells != 0) {
        return texelFetch(ids, i).x;
    }
    return texelFetch(lists, sdv_item(i), 0).x;
}
/* One sample: from the list of the cell at p, or of the nearest cell that has one. */
sdv_near near_in(sdv_box box, vec4 cell, lao_v3 p, lao_v3 direction) {
    sdv_near n = sdv_near_start(sdv_near_reach(box.cell));
    vec4 from = cell;
    if (!(cell.w > 0.0)) {
        from = cell_fetch(int(cell.y));
    }
    int first = int(from.z);
    int count = int(from.w);
    for (int i = 0; i < count; i++) {
        float id = id_fetch(first + i);
        int at = 2 * int(id);
        n = sdv_near_add(n, p, direction, texelFetch(cones, at), texelFetch(cones, at + 1), id);
    }
    return n;
}
sdv_near near_at(sdv_box box, lao_v3 p, lao_v3 direction) {
    return near_in(box, cell_fetch(sdv_cell_at(box, p)), p, direction);
}
/* Signed distance of the tree at p. */
float tree_distance_in(sdv_box box, vec4 cell, lao_v3 p) {
    return near_in(box, cell, p, lao_v3_make(0.0, 0.0, 1.0)).distance;
}
