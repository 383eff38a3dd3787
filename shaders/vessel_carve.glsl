/* A ray per pixel through a vessel tree that is combined with shapes (L19 Fig. 11): sdv_trace_shapes by texel fetches. */
LAO_TEX(0, samplerBuffer, box)
LAO_TEX(1, samplerBuffer, cells)
LAO_TEX(2, samplerBuffer, ids)
LAO_TEX(3, samplerBuffer, cones)
LAO_TEX(4, samplerBuffer, shapes)
LAO_TEX(5, samplerBuffer, fields)
LAO_TEX(6, sampler2D, grid)
LAO_TEX(7, sampler2D, lists)
LAO_CONSTANT(0, lao_constant_near_miss)
LAO_CONSTANT(1, lao_constant_supersampling)
LAO_CONSTANT(2, lao_constant_has_vessel_cells)
LAO_CONSTANT(3, lao_constant_parameterization)
LAO_CONSTANT(4, lao_constant_has_vessel_forms)

LAO_OUT(0, vec4, out_position) /* world, mm; number of the cone, -1: nothing was hit, -2: a shape */
LAO_OUT(1, vec4, out_normal)   /* world, towards the viewer; least distance of a near miss, mm */
LAO_OUT(2, vec4, out_ray)      /* mm along the ray: hit, near miss; samples; 2 * shape, + 1: from inside the solid */

#ifdef LAO_FRAGMENT
LAO_INCLUDE vessel_field.glsl
/* The distance, and the number of the nearest cone of the cell's list (-1: it has none). */
struct solid_sample {
    sdv_solid solid;
    float cone;
};
solid_sample solid_at(sdv_box b, lao_v3 p) {
    solid_sample r;
    vec4 cell = cell_fetch(sdv_cell_at(b, p));
    float least = SDV_FAR;
    r.cone = -1.0;
    if (cell.w > 0.0) {
        sdv_near n = near_in(b, cell, p, lao_v3_make(0.0, 0.0, 1.0));
        least = n.distance;
        r.cone = n.cone;
    }
    sdv_solid tree = sdv_solid_start(sdv_tree_bound(least, cell.w > 0.0, cell.z, sdv_box_distance(p, b), b.cell));
    r.solid = sdv_solid_add_all(shapes, fields, tree, p, true);
    return r;
}
/* What near misses go by: not only a bound, where it matters. */
float watched(sdv_box b, lao_v3 p, float reach) {
    vec4 cell = cell_fetch(sdv_cell_at(b, p));
    float tree = SDV_FAR;
    if (cell.w > 0.0 || sdv_is_within(cell.z, reach)) {
        tree = tree_distance_in(b, cell, p);
    }
    return sdv_solid_add_all(shapes, fields, sdv_solid_start(tree), p, false).distance;
}
sdv_watch dip(sdv_box b, lao_v3 origin, lao_v3 direction, sdv_watch w, float t, float reach) {
    sdv_dip d = sdv_dip_start(w, t);
    for (int i = 0; i < SDV_DIP_ROUNDS; i++) {
        float below = watched(b, lao_v3_along(origin, direction, sdv_dip_place(d, 0)), reach);
        float above = watched(b, lao_v3_along(origin, direction, sdv_dip_place(d, 1)), reach);
        d = sdv_dip_add(d, below, above);
    }
    return sdv_watch_keep(w, d);
}

void land(sdv_box b, lao_v3 origin, lao_v3 direction, float start, bool inside) {
    float t = start;
    float off = SDV_FAR;
    for (int i = 0; i <= SDV_POLISH_ROUNDS; i++) {
        lao_v3 p = lao_v3_along(origin, direction, t);
        solid_sample s = solid_at(b, p);
        if (lao_abs(s.solid.distance) > off) {
            break;
        }
        off = lao_abs(s.solid.distance);
        lao_v3 gradient;
        if (s.solid.part >= 0) {
            gradient = lao_v3_scale(sdv_shape_gradient_at(fields, sdv_shape_fetch(shapes, s.solid.part), p), s.solid.side);
            out_position = vec4(p, -2.0);
        } else {
            gradient = estimate_at(p, s.cone, s.solid.distance).xyz;
            out_position = vec4(p, s.cone);
        }
        out_normal.xyz = inside ? lao_v3_scale(gradient, -1.0) : gradient;
        out_ray.x = t;
        out_ray.w = (s.solid.part >= 0 ? 2.0 * float(s.solid.part) : 0.0) + (inside ? 1.0 : 0.0);
        t = sdv_polish(t, s.solid.distance, gradient, direction, b.cell);
    }
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    out_position = vec4(0.0, 0.0, 0.0, -1.0);
    out_normal = vec4(0.0, 0.0, 0.0, SDV_FAR);
    out_ray = vec4(0.0);
    if (lao_constant_parameterization == 0 && sdv_is_hidden(pixel)) { /* else the void is filled from all */
        return;
    }
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    lao_v3 origin = lao_ray_origin(lao_frame.world, slope, lao_frame.depth.w);
    lao_v3 direction = lao_ray_direction(lao_frame.world, slope, lao_frame.depth.w);
    sdv_box b = sdv_box_fetch(box);
    bool nearest = lao_constant_near_miss != SDV_NEAR_MISS_NONE;
    sdv_box around = b;
    float reach = 0.0;
    if (lao_constant_near_miss == SDV_NEAR_MISS_CLOSE) {
        reach = sdv_frame_reach(float(lao_constant_supersampling));
        around = sdv_box_grown(b, reach);
    }
    lao_v2 span = sdv_solid_span(sdv_ray_box(origin, direction, around), texelFetch(shapes, 0).y > 0.5);
    LAO_EXACT float t = span.x;
    sdv_watch watch = sdv_watch_start(t);
    float steps = 0.0;
    bool inside = false;
    bool hit = false;
    for (int i = 0; i < SDV_MAX_STEPS; i++) {
        if (!(t <= span.y) || hit) {
            break;
        }
        sdv_solid s = solid_at(b, lao_v3_along(origin, direction, t)).solid;
        if (i == 0) {
            inside = s.distance < 0.0;
        }
        float left = inside ? -s.distance : s.distance;
        steps += 1.0;
        hit = left < sdv_hit_distance(b.cell);
        if (!hit) {
            if (nearest && !inside) {
                float d = watched(b, lao_v3_along(origin, direction, t), reach);
                if (sdv_watch_passed(watch, d, reach)) {
                    watch = dip(b, origin, direction, watch, t, reach);
                }
                watch = sdv_watch_next(watch, t, d);
            }
            t = t + left;
        }
    }
    if (nearest && !hit && sdv_watch_passed(watch, SDV_FAR, reach)) {
        watch = dip(b, origin, direction, watch, watch.before, reach);
    }
    out_normal = vec4(0.0, 0.0, 0.0, watch.d_min);
    out_ray = vec4(0.0, watch.t_min, steps, inside ? 1.0 : 0.0);
    if (hit) {
        land(b, origin, direction, t, inside);
    }
}
#endif
