/* Strokes and dots by (u, v), as the white they leave (L19 5; METHODS 7.5). What a new solution changes fades over. */
LAO_TEX(0, sampler2D, surface)
LAO_TEX(1, sampler2D, bgnormal)
LAO_TEX(2, sampler2D, normal) /* for the near miss */
LAO_TEX(3, sampler2D, ray)
LAO_TEX(4, samplerBuffer, box)
LAO_TEX(5, samplerBuffer, cells)
LAO_TEX(6, samplerBuffer, ids)
LAO_TEX(7, samplerBuffer, cones)
LAO_TEX(8, samplerBuffer, shapes) /* with variant 1 */
LAO_TEX(9, samplerBuffer, fields)
LAO_TEX(10, sampler2D, uv)
LAO_TEX(11, sampler2D, recalled)
LAO_TEX(12, samplerBuffer, pattern) /* its size; thresholds */
LAO_TEX(13, samplerBuffer, colors)  /* for marks */
LAO_TEX(14, sampler2D, grid)
LAO_TEX(15, sampler2D, lists)
LAO_CONSTANT(0, lao_constant_near_miss)
LAO_CONSTANT(1, lao_constant_field_occlusion)
LAO_CONSTANT(2, lao_constant_style)
LAO_CONSTANT(3, lao_constant_void_style)
LAO_CONSTANT(4, lao_constant_variant) /* 1: with shapes; 2: not a tree */
LAO_CONSTANT(5, lao_constant_mark_style)
LAO_CONSTANT(6, lao_constant_field_shadow)
LAO_CONSTANT(7, lao_constant_has_vessel_cells)
LAO_CONSTANT(8, lao_constant_has_vessel_forms)

LAO_OUT(0, vec4, out_ink) /* white that is left; the rest in it of what was shown before (sdv_ink_rest) */

#ifdef LAO_FRAGMENT
LAO_INCLUDE vessel_field.glsl
LAO_INCLUDE vessel_light.glsl
/* Is the void marked at the pixel, close to a marked vessel? wide: periods per pixel. */
bool has_halo(float d_min, lao_v3 near_miss, lao_v3 direction, float wide) {
    if (lao_constant_variant == 2 || lao_constant_near_miss == SDV_NEAR_MISS_NONE || !(wide < SDV_HALO_FOOTPRINT) ||
        !(d_min < 0.01 * lao_setting_mark_halo * lao_frame.depth.z)) {
        return false;
    }
    sdv_box b = sdv_box_fetch(box);
    float cone = near_at(b, near_miss, direction).cone;
    if (cone < 0.0) {
        return false;
    }
    return is_marked(cone, near_miss);
}
/* White that is left by ink at these phases; mark: how much of the pixel a mark inks. */
float paper(int style, lao_v2 phase, float dark, float shadow, float mark, float wide_u, float wide_v, float finer) {
    float pattern_ink = 0.0;
    if (style == SDV_STYLE_PATTERN) {
        int n = int(texelFetch(pattern, 0).x);
        float inked = 0.0;
        for (int i = 0; i < SDV_PATTERN_SAMPLES * SDV_PATTERN_SAMPLES; i++) {
            float threshold = texelFetch(pattern, 1 + sdv_pattern_at(phase, wide_u, wide_v, i, n)).x;
            inked += dark > threshold ? 1.0 : 0.0;
        }
        pattern_ink = n > 0 ? sdv_pattern_ink(inked, dark, wide_u, wide_v) : 0.0;
    }
    LAO_EXACT float left = sdv_style_paper(style, phase, dark, shadow, wide_u, wide_v, finer, pattern_ink);
    if (mark > 0.0) {
        left = left * (1.0 - sdv_style_ink(lao_constant_mark_style + SDV_STYLE_STIPPLE, phase.x, phase.y, mark, wide_u, wide_v, finer));
    }
    return left;
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    lao_v3 direction = lao_ray_direction(lao_frame.world, slope, lao_frame.depth.w);
    lao_v3 p = texelFetch(surface, pixel, 0).xyz;
    vec4 facing = texelFetch(bgnormal, pixel, 0);
    lao_v3 n = facing.xyz;
    vec4 hit = vec4(p, facing.w);
    vec4 r = texelFetch(ray, pixel, 0);
    vec4 own = texelFetch(uv, pixel, 0);
    lao_v3 z = sdv_lift(lao_frame.world, lao_v3_make(own.z, own.w, 1.0), n, n);
    float wide_u = sdv_footprint_at(z, n, p, direction, lao_setting_ssp_period);
    float wide_v = sdv_footprint_at(lao_v3_cross(n, z), n, p, direction, lao_setting_ssp_period);
    int style = SDV_STYLE_PLAIN;
    float tone = 1.0;
    bool marked = false;
    LAO_EXACT float shadow = 0.0;
    float finer = 1.0;
    if (!sdv_is_covered(hit.w)) {
        float d_min = texelFetch(normal, pixel, 0).w;
        float reach = lao_constant_near_miss == SDV_NEAR_MISS_NONE ? 0.0 : 0.01 * lao_setting_void_reach * lao_frame.depth.z;
        float sheet = sdv_style_tone(-lao_v3_dot(n, direction), 0.5, 0.5, 1.0); /* half black where it is seen edge-on */
        LAO_EXACT float left = 1.0 - sdv_void_share(d_min, reach, lao_max(wide_u, wide_v)) * (1.0 - sheet);
        tone = left;
        if (lao_constant_void_style == SDV_VOID_STIPPLE) {
            style = SDV_STYLE_STIPPLE;
        } else if (lao_constant_void_style == SDV_VOID_HATCH) {
            style = SDV_STYLE_HATCH;
        }
        lao_v3 origin = lao_ray_origin(lao_frame.world, slope, lao_frame.depth.w);
        marked = has_halo(d_min, lao_v3_along(origin, direction, r.y), direction, lao_max(wide_u, wide_v));
    } else {
        if (lao_constant_variant != 2 && hit.w >= 0.0) {
            int at = 2 * int(hit.w);
            marked = is_marked(hit.w, p);
            finer = sdv_ink_finer(sdv_cone_radius(p, texelFetch(cones, at), texelFetch(cones, at + 1)), lao_setting_ssp_period,
                                  sdv_pixel_size(lao_frame.ray, sdv_depth_of(lao_frame.view, p), lao_frame.depth.w));
        }
        style = lao_constant_style;
        if (style != SDV_STYLE_PLAIN && style != SDV_STYLE_SHADOW) {
            lao_v3 lit = facing_at(hit, n);
            tone = sdv_style_tone(-lao_v3_dot(lit, direction), lao_setting_surface_ambient, lao_setting_surface_diffuse,
                                  field_light(p, lit, r));
        }
        if (style != SDV_STYLE_PLAIN && lao_constant_near_miss != SDV_NEAR_MISS_NONE && lao_constant_variant != 2) {
            shadow = lao_setting_shadow_strength * sdv_depth_shadow_at(texelFetch(normal, pixel, 0), r);
        }
    }
    float mark = marked ? lao_setting_mark_darkness : 0.0;
    vec4 before = texelFetch(recalled, pixel, 0);
    float now = paper(style, own.xy, 1.0 - tone, shadow, mark, wide_u, wide_v, finer);
    float rest = 0.0;
    if (before.w > 0.0) {
        LAO_EXACT float shown = paper(style, before.xy, 1.0 - tone, shadow, mark, wide_u, wide_v, finer) + before.z;
        rest = sdv_ink_rest(shown, now, lao_setting_ink_step);
    }
    LAO_EXACT float white = now + rest;
    out_ink = vec4(white, rest, 0.0, 0.0);
}
#endif
