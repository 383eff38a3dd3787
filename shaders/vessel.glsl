/* Behind the shared text of sdfvessel.h in every shader of its module: the field by texel fetches, where the functions of
   the grid in C read arrays. */
sdv_box sdv_box_fetch(samplerBuffer box) {
    vec4 corner = texelFetch(box, 0);
    sdv_box r;
    r.origin = corner.xyz;
    r.cell = corner.w;
    r.size = texelFetch(box, 1).xyz;
    return r;
}
/* One sample: from the list of the cell at p, or of the nearest cell that has one. */
sdv_near sdv_near_at(samplerBuffer cells, samplerBuffer ids, samplerBuffer cones, sdv_box box, vec4 cell, lao_v3 p,
                     lao_v3 direction) {
    sdv_near n = sdv_near_start(sdv_near_reach(box.cell));
    vec4 from = cell.w > 0.0 ? cell : texelFetch(cells, int(cell.y));
    int first = int(from.z);
    int count = int(from.w);
    for (int i = 0; i < count; i++) {
        float id = texelFetch(ids, first + i).x;
        int at = 2 * int(id);
        n = sdv_near_add(n, p, direction, texelFetch(cones, at), texelFetch(cones, at + 1), id);
    }
    return n;
}
