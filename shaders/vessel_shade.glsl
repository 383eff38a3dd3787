/* Vessels over the scene where they are nearer: light, occlusion from the field, contours and depth shadows of near
   misses (L19 5, Fig. 8; METHODS 5.4), and a silhouette where a ray just missed. */
LAO_TEX(0, sampler2D, position)
LAO_TEX(1, sampler2D, normal)
LAO_TEX(2, sampler2D, ray)
LAO_TEX(3, samplerBuffer, colors) /* two of each cone: at its parent and at its child */
LAO_TEX(4, samplerBuffer, box)
LAO_TEX(5, samplerBuffer, cells)
LAO_TEX(6, samplerBuffer, ids)
LAO_TEX(7, samplerBuffer, cones)
LAO_TEX(8, samplerBuffer, shapes) /* with variant 1 */
LAO_TEX(9, samplerBuffer, fields)
LAO_TEX(10, sampler2D, uv)
LAO_TEX(11, sampler2D, surface)
LAO_TEX(12, sampler2D, bgnormal)
LAO_TEX(13, sampler2D, along)
LAO_TEX(14, sampler2D, across)
LAO_CONSTANT(0, lao_constant_near_miss)
LAO_CONSTANT(1, lao_constant_surface_shininess)
LAO_CONSTANT(2, lao_constant_field_occlusion)
LAO_CONSTANT(3, lao_constant_parameterization)
LAO_CONSTANT(4, lao_constant_style)
LAO_CONSTANT(5, lao_constant_void_style)
LAO_CONSTANT(6, lao_constant_variant) /* 1: with shapes */
LAO_CONSTANT(7, lao_constant_supersampling)
LAO_CONSTANT(8, lao_constant_mark_style)
LAO_CONSTANT(9, lao_constant_field_shadow)

LAO_OUT(0, vec4, out_color)

#ifdef LAO_FRAGMENT
/* What is known of the tree's distance at p, with shapes. */
float combined(float d, lao_v3 p, bool bound) {
    if (lao_constant_variant != 0) {
        return sdv_solid_add_all(shapes, fields, sdv_solid_start(d), p, bound).distance;
    }
    return d;
}
/* Signed distance at p, from the list of its cell. */
float field_at(sdv_box b, lao_v3 p) {
    return combined(sdv_tree_distance_at(cells, ids, cones, b, texelFetch(cells, sdv_cell_at(b, p)), p), p, false);
}

/* Openness of p along its normal: sdv_openness; from within a vessel the room inside counts. */
float openness(sdv_box b, lao_v3 p, lao_v3 n, bool inside) {
    float reach = 0.01 * lao_setting_occlusion_reach * lao_frame.depth.z;
    float closed = 0.0;
    for (int i = 0; i < SDV_OPEN_SAMPLES; i++) {
        float place = sdv_open_place(reach, i);
        float d = field_at(b, lao_v3_along(p, n, place));
        closed = sdv_open_add(closed, inside ? -d : d, place, i);
    }
    return sdv_open_result(closed);
}

/* Normal for shading: sdv_smooth_normal. */
lao_v3 smooth_normal(sdv_box b, lao_v3 p, float cone, lao_v3 n) {
    int own = 2 * int(cone);
    lao_v2 reach = sdv_joint_reach(p, texelFetch(cones, own), texelFetch(cones, own + 1), lao_setting_joint_smoothness, b.cell);
    vec4 cell = texelFetch(cells, sdv_cell_at(b, p));
    int count = int(cell.w);
    if (!(reach.x > 0.0)) {
        return n;
    }
    lao_v3 sum = sdv_joint_start(p, texelFetch(cones, own), texelFetch(cones, own + 1), reach);
    for (int i = 0; i < count; i++) {
        int at = 2 * int(texelFetch(ids, int(cell.z) + i).x);
        sum = sdv_joint_add(sum, p, texelFetch(cones, at), texelFetch(cones, at + 1), reach);
    }
    return sdv_joint_normal(sum, n);
}
/* Light that reaches p past the vessels: sdv_shadow. */
float lit_at(sdv_box b, lao_v3 p) {
    lao_v3 light = sdv_shadow_light(lao_frame.world, lao_setting_shadow_light_x, lao_setting_shadow_light_y);
    lao_v2 span = sdv_ray_box(p, light, b);
    if (lao_constant_variant != 0) {
        span = sdv_solid_span(span, texelFetch(shapes, 0).y > 0.5);
    }
    float least = sdv_hit_distance(b.cell);
    float lit = 1.0;
    LAO_EXACT float t = lao_max(sdv_shadow_bias(b.cell), span.x);
    LAO_EXACT float hardness = 1.0 / lao_setting_field_shadow_softness;
    for (int i = 0; i < SDV_MAX_STEPS; i++) {
        if (!(t <= span.y) || !(lit > 0.0)) {
            break;
        }
        lao_v3 q = lao_v3_along(p, light, t);
        vec4 cell = texelFetch(cells, sdv_cell_at(b, q));
        float tree = sdv_tree_distance_at(cells, ids, cones, b, cell, q);
        float d = combined(tree, q, false);
        lit = d < least ? 0.0 : sdv_shadow_add(lit, d, t, hardness);
        float bound = combined(sdv_tree_bound(tree, cell.w > 0.0, cell.z, sdv_box_distance(q, b), b.cell), q, true);
        t = t + lao_max(bound, least);
    }
    return lit;
}
/* Is the place p at the cone marked? */
bool is_marked(float cone, lao_v3 p) {
    int at = 2 * int(cone);
    return sdv_is_marked(p, texelFetch(cones, at), texelFetch(cones, at + 1), texelFetch(colors, at).w,
                         texelFetch(colors, at + 1).w);
}

/* Periods per pixel of the pixel's u or v, or of depth. */
float footprint(lao_v3 z, lao_v3 n, lao_v3 p, lao_v3 direction, float period) {
    lao_v3 zero = lao_v3_make(0.0, 0.0, 0.0);
    float mm = sdv_pixel_size(lao_frame.ray, sdv_depth_of(lao_frame.view, p), lao_frame.depth.w);
    return sdv_style_footprint(z, n, lao_v3_unit(lao_frame.world.x.xyz, zero), lao_v3_unit(lao_frame.world.y.xyz, zero),
                               direction, mm, period);
}
/* Ink of a style at the pixel. */
float ink(ivec2 pixel, int style, lao_v3 n, lao_v3 p, lao_v3 direction, float dark) {
    vec4 phase = texelFetch(uv, pixel, 0);
    float wide_u = footprint(texelFetch(along, pixel, 0).xyz, n, p, direction, lao_setting_ssp_period);
    float wide_v = footprint(texelFetch(across, pixel, 0).xyz, n, p, direction, lao_setting_ssp_period);
    return sdv_style_ink(style, phase.x, phase.y, dark, wide_u, wide_v);
}
/* Ink of a mark. */
float mark_ink(ivec2 pixel, lao_v3 n, lao_v3 p, lao_v3 direction) {
    return ink(pixel, lao_constant_mark_style + SDV_STYLE_STIPPLE, n, p, direction, lao_setting_mark_darkness);
}
/* The same in the void close to a marked vessel; near_miss: where the ray is nearest to it. */
float halo_ink(ivec2 pixel, float d_min, lao_v3 near_miss, lao_v3 direction) {
    if (lao_constant_parameterization <= 1 || lao_constant_near_miss == SDV_NEAR_MISS_NONE ||
        !(d_min < 0.01 * lao_setting_mark_halo * lao_frame.depth.z)) {
        return 0.0;
    }
    sdv_box b = sdv_box_fetch(box);
    vec4 cell = texelFetch(cells, sdv_cell_at(b, near_miss));
    float cone = sdv_near_at(cells, ids, cones, b, cell, near_miss, direction).cone;
    if (cone < 0.0 || !is_marked(cone, near_miss)) {
        return 0.0;
    }
    lao_v3 n = texelFetch(bgnormal, pixel, 0).xyz;
    lao_v3 p = texelFetch(surface, pixel, 0).xyz;
    float wide = lao_max(footprint(texelFetch(along, pixel, 0).xyz, n, p, direction, lao_setting_ssp_period),
                         footprint(texelFetch(across, pixel, 0).xyz, n, p, direction, lao_setting_ssp_period));
    if (!(wide < SDV_HALO_FOOTPRINT)) {
        return 0.0;
    }
    return mark_ink(pixel, n, p, direction);
}
/* Ink of a depth shadow: lines the other way. */
float shadow_ink(ivec2 pixel, lao_v3 n, lao_v3 p, lao_v3 direction, float dark) {
    LAO_EXACT float a = texelFetch(uv, pixel, 0).x / LAO_TURN;
    return sdv_lines_ink(a, lao_clamp01(lao_setting_shadow_strength * dark),
                         footprint(texelFetch(along, pixel, 0).xyz, n, p, direction, lao_setting_ssp_period));
}
/* The void: depth as colour with lines, or ink. */
vec4 void_color(ivec2 pixel, lao_v3 direction) {
    lao_v3 p = texelFetch(surface, pixel, 0).xyz;
    lao_v3 n = texelFetch(bgnormal, pixel, 0).xyz;
    float facing = -lao_v3_dot(n, direction);
    if (lao_constant_void_style == SDV_VOID_CHROMADEPTH) {
        LAO_EXACT float depth = (sdv_depth_of(lao_frame.view, p) - lao_frame.depth.x) * lao_frame.depth.y;
        LAO_EXACT float light = 0.7 + 0.3 * lao_max(facing, 0.0);
        if (lao_setting_isolines > 0.5) {
            lao_v3 back = lao_v3_unit(lao_frame.world.z.xyz, lao_v3_make(0.0, 0.0, 1.0));
            LAO_EXACT float gap = 1.0 / (lao_setting_isolines * lao_frame.depth.y);
            LAO_EXACT float wide = footprint(back, n, p, direction, gap);
            LAO_EXACT float place = depth * lao_setting_isolines;
            LAO_EXACT float line = sdv_lines_ink(place, lao_min(1.5 * wide, 0.5), wide);
            light = sdv_dimmed(light, line, 0.7);
        }
        return vec4(lao_v3_scale(sdv_chromadepth(depth), light), 1.0);
    }
    float tone = sdv_style_tone(facing, 0.5, 0.5, 1.0); /* half black where the sheet is seen edge-on */
    int style = lao_constant_void_style == SDV_VOID_STIPPLE ? SDV_STYLE_STIPPLE : SDV_STYLE_HATCH;
    LAO_EXACT float white = 1.0 - ink(pixel, style, n, p, direction, 1.0 - tone);
    return vec4(white, white, white, 1.0);
}
bool has_void() {
    return lao_constant_void_style != SDV_VOID_PLAIN &&
           lao_constant_parameterization > (lao_constant_void_style == SDV_VOID_CHROMADEPTH ? 0 : 1);
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 hit = texelFetch(position, pixel, 0);
    vec4 n = texelFetch(normal, pixel, 0);
    vec4 r = texelFetch(ray, pixel, 0);
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    lao_v3 origin = lao_ray_origin(lao_frame.world, slope, lao_frame.depth.w);
    lao_v3 direction = lao_ray_direction(lao_frame.world, slope, lao_frame.depth.w);
    bool missed = hit.w == -1.0;
    lao_v3 near_miss = lao_transform(lao_frame.view, lao_v3_along(origin, direction, r.y));
    float zoom = sdv_zoom(lao_frame.scale, lao_frame.depth, -near_miss.z, float(lao_constant_supersampling));
    bool outlined = false;
    if (lao_constant_near_miss != SDV_NEAR_MISS_NONE) {
        if (missed) {
            outlined =
                sdv_is_silhouette(false, n.w, sdv_outline_width(lao_setting_silhouette, lao_setting_outline_unit, zoom));
        } else {
            outlined = sdv_is_contour(n.w, sdv_outline_width(lao_setting_contour, lao_setting_outline_unit, zoom));
        }
    }
    if (missed && !outlined) {
        LAO_EXACT float mark = halo_ink(pixel, n.w, lao_v3_along(origin, direction, r.y), direction);
        if (!has_void() && !(mark > 0.0)) {
            discard;
        }
        gl_FragDepth = lao_frame.scale.z > 0.5 ? 1.0e-7 : 0.9999999; /* before nothing but the empty depth buffer */
        LAO_EXACT float paper = 1.0 - mark;
        out_color = vec4(0.0, 0.0, 0.0, mark);
        if (has_void()) {
            out_color = vec4(lao_v3_scale(void_color(pixel, direction).xyz, paper), 1.0);
        }
        return;
    }
    lao_v3 p = outlined ? lao_v3_along(origin, direction, r.y) : hit.xyz;
    lao_v4 clip = lao_project(lao_frame.projection, lao_transform(lao_frame.view, p));
    gl_FragDepth = clip.z / clip.w;
    if (outlined) {
        out_color = vec4(0.0, 0.0, 0.0, 1.0);
        return;
    }
    bool inside = r.w > 0.5;
    float cone = hit.w;
    lao_v3 color;
    if (lao_constant_variant != 0) { /* r.w: 2 * shape, + 1 inside */
        inside = r.w - 2.0 * lao_floor(0.5 * r.w) > 0.5;
    }
    if (lao_constant_variant != 0 && hit.w < 0.0) {
        vec4 own = texelFetch(shapes, 4 + 4 * int(0.5 * r.w));
        color = own.xyz;
        if (own.w < 0.5) { /* that of the nearest vessel */
            sdv_box b = sdv_box_fetch(box);
            cone = sdv_near_at(cells, ids, cones, b, texelFetch(cells, sdv_cell_at(b, p)), p, direction).cone;
        }
    }
    if (cone >= 0.0) {
        int at = 2 * int(cone);
        color = sdv_cone_color(p, texelFetch(cones, at), texelFetch(cones, at + 1), texelFetch(colors, at).xyz,
                               texelFetch(colors, at + 1).xyz);
    }
    lao_v3 facing = n.xyz;
    if (hit.w >= 0.0) {
        facing = smooth_normal(sdv_box_fetch(box), p, hit.w, n.xyz);
    }
    LAO_EXACT float light = 1.0;
    if (lao_constant_field_occlusion != 0) {
        light = sdv_dimmed(light, 1.0 - openness(sdv_box_fetch(box), p, facing, inside), lao_setting_occlusion_strength);
    }
    if (lao_constant_field_shadow != 0) {
        light = sdv_dimmed(light, 1.0 - lit_at(sdv_box_fetch(box), p), lao_setting_field_shadow_strength);
    }
    bool inked = lao_constant_parameterization > 1 && lao_constant_style != SDV_STYLE_PLAIN;
    LAO_EXACT float dark = 0.0;
    if (lao_constant_near_miss != SDV_NEAR_MISS_NONE) {
        dark = sdv_depth_shadow(n.w, r.y, r.x, lao_setting_shadow_ratio,
                                0.01 * lao_setting_shadow_width * lao_frame.depth.z, lao_setting_shadow_softness);
    }
    bool shadowed = dark > 0.0;
    if (!inked) {
        light = sdv_dimmed(light, dark, lao_setting_shadow_strength);
    }
    LAO_EXACT float white = 1.0;
    if (shadowed && inked) {
        white = 1.0 - shadow_ink(pixel, n.xyz, p, direction, dark);
    }
    if (lao_constant_parameterization > 1 && hit.w >= 0.0 && is_marked(hit.w, p)) {
        LAO_EXACT float unmarked = 1.0 - mark_ink(pixel, n.xyz, p, direction);
        white = white * unmarked;
    }
    lao_v3 towards = lao_v3_scale(direction, -1.0);
    if (inked && lao_constant_style != SDV_STYLE_SHADOW) {
        float tone = sdv_style_tone(lao_v3_dot(facing, towards), lao_setting_surface_ambient, lao_setting_surface_diffuse,
                                    light);
        LAO_EXACT float paper = white * (1.0 - ink(pixel, lao_constant_style, n.xyz, p, direction, 1.0 - tone));
        out_color = vec4(lao_v3_scale(color, paper), 1.0);
        return;
    }
    lao_v3 shade = sdv_shade(color, facing, towards, lao_setting_surface_ambient, lao_setting_surface_diffuse,
                             lao_setting_surface_specular, lao_constant_surface_shininess, light);
    out_color = vec4(lao_v3_scale(shade, white), 1.0);
}
#endif
