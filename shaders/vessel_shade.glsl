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
LAO_TEX(15, sampler2D, grid)
LAO_TEX(16, sampler2D, lists)
LAO_CONSTANT(0, lao_constant_near_miss)
LAO_CONSTANT(1, lao_constant_surface_shininess)
LAO_CONSTANT(2, lao_constant_field_occlusion)
LAO_CONSTANT(3, lao_constant_parameterization)
LAO_CONSTANT(4, lao_constant_style)
LAO_CONSTANT(5, lao_constant_void_style)
LAO_CONSTANT(6, lao_constant_variant) /* 1: with shapes */
LAO_CONSTANT(7, lao_constant_supersampling)
LAO_CONSTANT(8, lao_constant_has_vessel_cells)

LAO_OUT(0, vec4, out_color)

#ifdef LAO_FRAGMENT
LAO_INCLUDE vessel_field.glsl
/* Signed distance at p, from the list of its cell. */
float field_at(sdv_box b, lao_v3 p) {
    float d = near_at(b, p, lao_v3_make(0.0, 0.0, 1.0)).distance;
    if (lao_constant_variant != 0) {
        d = sdv_solid_add_all(shapes, fields, sdv_solid_start(d), p).distance;
    }
    return d;
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
        if (!has_void()) {
            discard;
        }
        gl_FragDepth = lao_frame.scale.z > 0.5 ? 1.0e-7 : 0.9999999; /* before nothing but the empty depth buffer */
        out_color = void_color(pixel, direction);
        return;
    }
    lao_v3 p = outlined ? lao_v3_along(origin, direction, r.y) : hit.xyz;
    lao_v4 clip = lao_project(lao_frame.projection, lao_transform(lao_frame.view, p));
    gl_FragDepth = clip.z / clip.w;
    if (outlined) {
        out_color = vec4(0.0, 0.0, 0.0, 1.0);
        return;
    }
    lao_v3 color;
    if (lao_constant_variant != 0 && hit.w < 0.0) {
        color = texelFetch(shapes, 4 + 4 * int(r.y)).xyz;
    } else {
        int at = 2 * int(hit.w);
        color = sdv_cone_color(p, texelFetch(cones, at), texelFetch(cones, at + 1), texelFetch(colors, at).xyz,
                               texelFetch(colors, at + 1).xyz);
    }
    LAO_EXACT float light = 1.0;
    if (lao_constant_field_occlusion != 0) {
        light = sdv_dimmed(light, 1.0 - openness(sdv_box_fetch(box), p, n.xyz, r.w > 0.5), lao_setting_occlusion_strength);
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
    lao_v3 towards = lao_v3_scale(direction, -1.0);
    if (inked && lao_constant_style != SDV_STYLE_SHADOW) {
        float tone = sdv_style_tone(lao_v3_dot(n.xyz, towards), lao_setting_surface_ambient, lao_setting_surface_diffuse,
                                    light);
        LAO_EXACT float paper = white * (1.0 - ink(pixel, lao_constant_style, n.xyz, p, direction, 1.0 - tone));
        out_color = vec4(lao_v3_scale(color, paper), 1.0);
        return;
    }
    lao_v3 shade = sdv_shade(color, n.xyz, towards, lao_setting_surface_ambient, lao_setting_surface_diffuse,
                             lao_setting_surface_specular, lao_constant_surface_shininess, light);
    out_color = vec4(lao_v3_scale(shade, white), 1.0);
}
#endif
