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
/* The form of a cone: in the buffer of the cones, behind all of them. */
sdv_form form_at(float cone) {
    int at = 2 * int(texelFetch(box, 1).w) + 3 * int(cone);
    sdv_form form;
    form.a = texelFetch(cones, at);
    form.b = texelFetch(cones, at + 1);
    form.bump = texelFetch(cones, at + 2);
    return form;
}
/* Outward normal of a cone (xyz) and its distance (w), of a form as far as that can be told. round: that of the round
   cone. */
vec4 estimate_at(lao_v3 p, float cone, float round) {
    int at = 2 * int(cone);
    vec4 a = texelFetch(cones, at);
    vec4 b = texelFetch(cones, at + 1);
    if (lao_constant_has_vessel_forms != 0) {
        return sdv_form_estimate(p, a, b, form_at(cone));
    }
    return vec4(sdv_round_cone_gradient(p, a, b), round);
}
/* One sample: from the list of the cell at p, or of the nearest cell that has one. */
sdv_near near_in(sdv_box b, vec4 cell, lao_v3 p, lao_v3 direction) {
    sdv_near n = sdv_near_start(sdv_near_reach(b.cell));
    vec4 from = cell;
    if (!(cell.w > 0.0)) {
        from = cell_fetch(int(cell.y));
    }
    int first = int(from.z);
    int count = int(from.w);
    for (int i = 0; i < count; i++) {
        float id = id_fetch(first + i);
        int at = 2 * int(id);
        if (lao_constant_has_vessel_forms != 0) {
            vec4 a = texelFetch(cones, at);
            vec4 b = texelFetch(cones, at + 1);
            lao_v2 along = sdv_cone_along(p, direction, a, b);
            if (sdv_near_asks(n, along)) {
                n = sdv_near_form(n, along, p, a, b, form_at(id), id);
            }
        } else {
            n = sdv_near_add(n, p, direction, texelFetch(cones, at), texelFetch(cones, at + 1), id);
        }
    }
    return n;
}
sdv_near near_at(sdv_box b, lao_v3 p, lao_v3 direction) {
    return near_in(b, cell_fetch(sdv_cell_at(b, p)), p, direction);
}
/* Signed distance of the tree at p. */
float tree_distance_in(sdv_box b, vec4 cell, lao_v3 p) {
    return near_in(b, cell, p, lao_v3_make(0.0, 0.0, 1.0)).distance;
}
