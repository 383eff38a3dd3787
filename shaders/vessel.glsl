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
/* ---- the tree with shapes: sdv_trace_shapes. The buffer begins with their number, and 1 where one is a union. */
sdv_shape sdv_shape_fetch(samplerBuffer shapes, int i) {
    vec4 kind = texelFetch(shapes, 3 + 4 * i);
    sdv_shape s;
    s.a = texelFetch(shapes, 1 + 4 * i);
    s.b = texelFetch(shapes, 2 + 4 * i);
    s.kind = int(kind.x);
    s.operation = int(kind.y);
    return s;
}
vec4 sdv_four_fetch(samplerBuffer fields, int at, int row) {
    return vec4(texelFetch(fields, at).x, texelFetch(fields, at + 1).x, texelFetch(fields, at + row).x,
                texelFetch(fields, at + row + 1).x);
}
vec4 sdv_field_value(samplerBuffer fields, sdv_lattice l) {
    return sdv_lattice_value(l.part, sdv_four_fetch(fields, l.at, l.row), sdv_four_fetch(fields, l.at + l.layer, l.row));
}
/* bound: no more than the distance; else as near to it as can be had. */
float sdv_shape_distance_at(samplerBuffer fields, sdv_shape s, lao_v3 p, bool bound) {
    if (s.kind != SDV_SHAPE_FIELD) {
        return bound ? sdv_shape_distance(p, s) : sdv_shape_estimate(p, s);
    }
    sdv_lattice l = sdv_lattice_at(p, s);
    float value = sdv_field_value(fields, l).w;
    return bound ? sdv_lattice_distance(l, value) : sdv_lattice_estimate(l, value);
}
lao_v3 sdv_shape_gradient_at(samplerBuffer fields, sdv_shape s, lao_v3 p) {
    if (s.kind != SDV_SHAPE_FIELD) {
        return sdv_shape_gradient(p, s);
    }
    vec4 v = sdv_field_value(fields, sdv_lattice_at(p, s));
    return lao_v3_unit(v.xyz, lao_v3_make(0.0, 0.0, 1.0));
}
sdv_solid sdv_solid_add_all(samplerBuffer shapes, samplerBuffer fields, sdv_solid start, lao_v3 p, bool bound) {
    sdv_solid r = start;
    int count = int(texelFetch(shapes, 0).x);
    for (int i = 0; i < count; i++) {
        sdv_shape s = sdv_shape_fetch(shapes, i);
        bool again = s.kind == SDV_SHAPE_TREE;
        float d = again ? start.distance : sdv_shape_distance_at(fields, s, p, bound);
        r = sdv_solid_add(r, d, s.operation, again ? -1 : i);
    }
    return r;
}
/* How near to a vessel a ray must pass for anything to be drawn of it, mm; pixels are widest at the far end. */
float sdv_frame_reach(float supersampling) {
    float zoom = sdv_zoom(lao_frame.scale, lao_frame.depth, lao_frame.depth.x + lao_frame.depth.z, supersampling);
    return sdv_near_miss_reach(sdv_outline_width(lao_setting_silhouette, lao_setting_outline_unit, zoom),
                               sdv_outline_width(lao_setting_contour, lao_setting_outline_unit, zoom),
                               lao_setting_shadow_width, lao_setting_mark_halo, lao_frame.depth.z);
}
/* Signed distance of the tree at p. */
float sdv_tree_distance_at(samplerBuffer cells, samplerBuffer ids, samplerBuffer cones, sdv_box box, vec4 cell, lao_v3 p) {
    return sdv_near_at(cells, ids, cones, box, cell, p, lao_v3_make(0.0, 0.0, 1.0)).distance;
}
/* The distance, and the number of the nearest cone of the cell's list (-1: it has none). */
struct sdv_solid_sample {
    sdv_solid solid;
    float cone;
};
sdv_solid_sample sdv_solid_at(samplerBuffer cells, samplerBuffer ids, samplerBuffer cones, samplerBuffer shapes,
                              samplerBuffer fields, sdv_box box, lao_v3 p) {
    sdv_solid_sample r;
    vec4 cell = texelFetch(cells, sdv_cell_at(box, p));
    float least = SDV_FAR;
    r.cone = -1.0;
    for (int i = 0; i < int(cell.w); i++) {
        float id = texelFetch(ids, int(cell.z) + i).x;
        float d = sdv_round_cone(p, texelFetch(cones, 2 * int(id)), texelFetch(cones, 2 * int(id) + 1));
        if (d < least) {
            least = d;
            r.cone = id;
        }
    }
    sdv_solid tree = sdv_solid_start(sdv_tree_bound(least, cell.w > 0.0, cell.z, sdv_box_distance(p, box), box.cell));
    r.solid = sdv_solid_add_all(shapes, fields, tree, p, true);
    return r;
}
/* ---- light and ink */
/* How dark the depth shadow at a traced pixel is; normal, ray: its texels. */
float sdv_depth_shadow_at(vec4 normal, vec4 ray) {
    return sdv_depth_shadow(normal.w, ray.y, ray.x, lao_setting_shadow_ratio,
                            0.01 * lao_setting_shadow_width * lao_frame.depth.z, lao_setting_shadow_softness);
}
/* Periods per pixel along z at p, a place of a surface of normal n. */
float sdv_footprint_at(lao_v3 z, lao_v3 n, lao_v3 p, lao_v3 direction, float period) {
    lao_v3 zero = lao_v3_make(0.0, 0.0, 0.0);
    float mm = sdv_pixel_size(lao_frame.ray, sdv_depth_of(lao_frame.view, p), lao_frame.depth.w);
    return sdv_style_footprint(z, n, lao_v3_unit(lao_frame.world.x.xyz, zero), lao_v3_unit(lao_frame.world.y.xyz, zero),
                               direction, mm, period);
}
