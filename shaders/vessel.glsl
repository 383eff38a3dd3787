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
    bool inked = lao_setting_parameterization > 1.5 && lao_setting_void_style > float(SDV_VOID_CHROMADEPTH) + 0.5;
    return sdv_near_miss_reach(sdv_outline_width(lao_setting_silhouette, lao_setting_outline_unit, zoom),
                               sdv_outline_width(lao_setting_contour, lao_setting_outline_unit, zoom),
                               lao_setting_shadow_width, lao_setting_mark_halo,
                               inked ? lao_setting_void_reach : 0.0, lao_frame.depth.z);
}
/* ---- the field made by the device, by the rows vessel_region_counts to vessel_grid: images of items, LAO_ITEMS_WIDTH a row */
ivec2 sdv_item(int i) {
    return ivec2(i & 2047, i >> 11);
}
int sdv_item_at(ivec2 pixel) {
    return pixel.x + 2048 * pixel.y;
}
/* i / n for i < 2^24, without the integer division that vector units lack. */
int sdv_quotient(int i, int n) {
    int q = int(float(i) / float(n));
    int rest = i - q * n;
    return rest < 0 ? q - 1 : (rest >= n ? q + 1 : q);
}
/* Of an index, x fastest. */
ivec3 sdv_place(int index, ivec3 size) {
    int row = sdv_quotient(index, size.x);
    int z = sdv_quotient(row, size.y);
    return ivec3(index - row * size.x, row - z * size.y, z);
}
/* Number of the highest bit of a word that is not 0. */
int sdv_highest(uint word) {
    int n = 0;
    uint rest = word;
    for (int i = 16; i > 0; i >>= 1) {
        if (rest >= (1u << uint(i))) {
            rest >>= uint(i);
            n += i;
        }
    }
    return n;
}
/* The last of `count` items that starts at an entry or before it. */
int sdv_owner(sampler2D starts, int count, float entry) {
    int low = 0;
    int high = count;
    for (int i = 0; i < 24; i++) {
        if (high - low < 2) {
            break;
        }
        int middle = (low + high) >> 1;
        if (texelFetch(starts, sdv_item(middle), 0).x <= entry) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}
/* The nearest so far of an outward search: cells squared, what it is, and where along the axis. Of those as near the
   lowest, hence `lower`: it is below all before. */
struct sdv_nearest {
    int apart;
    float value;
    int along;
};
sdv_nearest sdv_nearest_start() {
    return sdv_nearest(0x3fffffff, -1.0, 0);
}
sdv_nearest sdv_nearest_add(sdv_nearest best, float value, int apart, int along, bool lower) {
    if (value >= 0.0 && (apart < best.apart || (lower && apart == best.apart))) {
        return sdv_nearest(apart, value, along);
    }
    return best;
}
/* ---- the lens */
float sdv_lens_at(ivec2 pixel, float rim) {
    return sdv_lens_part(lao_v3_make(lao_setting_lens_x, lao_setting_lens_y, lao_setting_lens_radius), rim,
                         float(pixel.x) + 0.5, float(pixel.y) + 0.5, lao_frame.viewport);
}
bool sdv_is_hidden(ivec2 pixel) {
    return sdv_lens_hides(lao_setting_lens_side, sdv_lens_at(pixel, 0.0));
}
/* ---- light and ink */
/* How dark the depth shadow at a traced pixel is; normal, ray: its texels. */
float sdv_depth_shadow_at(vec4 normal, vec4 ray) {
    return sdv_depth_shadow(normal.w, ray.y, ray.x, lao_setting_shadow_ratio,
                            0.01 * lao_setting_shadow_width * lao_frame.depth.z, lao_setting_shadow_softness);
}
/* Periods per pixel along z at p, a place of a surface of normal n. */
float sdv_footprint_at(lao_v3 z, lao_v3 n, lao_v3 p, lao_v3 direction, float period) {
    float mm = sdv_pixel_size(lao_frame.ray, sdv_depth_of(lao_frame.view, p), lao_frame.depth.w);
    return sdv_style_footprint(z, n, sdv_camera_unit(lao_frame.world.x.xyz), sdv_camera_unit(lao_frame.world.y.xyz),
                               direction, mm, period);
}
