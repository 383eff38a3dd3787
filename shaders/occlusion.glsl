/* Line ambient occlusion (Koehler 2017, Eqs. 1-12; METHODS 1.5-1.9, 2.4): the mean over levels of the mean over samples. */
LAO_TEX(0, sampler2D, tangent)
LAO_TEX(1, sampler2D, depth0)
LAO_TEX(2, sampler2D, depth1)
LAO_TEX(3, sampler2D, depth2)
LAO_TEX(4, sampler2D, depth3)
LAO_TEX(5, sampler2D, depth4)
LAO_TEX(6, sampler2D, depth5)
LAO_TEX(7, sampler2D, depth6)
LAO_TEX(8, sampler2D, depth7)
LAO_TEX(9, sampler2D, axial0)
LAO_TEX(10, sampler2D, axial1)
LAO_TEX(11, sampler2D, axial2)
LAO_TEX(12, sampler2D, axial3)
LAO_TEX(13, sampler2D, axial4)
LAO_TEX(14, sampler2D, axial5)
LAO_TEX(15, sampler2D, axial6)
LAO_TEX(16, sampler2D, axial7)
LAO_TEX(17, sampler2D, tangent0)
LAO_TEX(18, sampler2D, tangent1)
LAO_TEX(19, sampler2D, tangent2)
LAO_TEX(20, sampler2D, tangent3)
LAO_TEX(21, sampler2D, tangent4)
LAO_TEX(22, sampler2D, tangent5)
LAO_TEX(23, sampler2D, tangent6)
LAO_TEX(24, sampler2D, tangent7)
LAO_CONSTANT(0, lao_constant_align)
LAO_CONSTANT(1, lao_constant_light)
LAO_CONSTANT(2, lao_constant_levels)
LAO_CONSTANT(3, lao_constant_samples)
LAO_CONSTANT(4, lao_constant_light_exponent)
LAO_CONSTANT(5, lao_constant_strict_zero)
LAO_CONSTANT(6, lao_constant_show)

LAO_OUT(0, vec4, out_ao)

#ifdef LAO_FRAGMENT
/* What a pixel brings to every level. */
struct lao_centre {
    lao_v3 n, r, l, noise; /* normal, reflected light, towards the light, mirror */
    lao_v2 pixel;
    float zoom, diffuse; /* px per mm; I k_d n.l */
};
/* What a level brings to every sample. */
struct lao_gather {
    lao_sampler rows;
    vec4 size;    /* of the level: width, height, 1 / width, 1 / height */
    lao_v2 axial; /* the centre's direction on this level */
    float depth;  /* the centre's depth on this level */
    float slope;  /* of the depth weight */
};

lao_gather lao_gather_make(sampler2D depths, sampler2D axials, lao_centre c, uint level) {
    lao_gather g;
    vec2 size = vec2(textureSize(depths, 0));
    LAO_EXACT float texel = 1.0 / float(1u << level);
    float radius = lao_sample_radius(c.zoom, lao_setting_radius, lao_setting_width, lao_setting_radius_step, level);
    g.size = vec4(size, 1.0 / size);
    g.rows = lao_sampler_make(c.noise, c.n, c.r, radius, texel, c.pixel.x, c.pixel.y);
    float x = floor(g.rows.centre.x);
    float y = floor(g.rows.centre.y);
    g.depth = lao_depth_unpack(LAO_TEXEL(depths, x, y, g.size.zw));
    g.axial = lao_v2_make(0.0, 0.0);
    if (lao_constant_align != LAO_ALIGN_NONE) {
        g.axial = lao_axial_unpack(LAO_TEXEL(axials, x, y, g.size.zw));
    }
    g.slope = lao_depth_weight_slope(lao_depth_reach(lao_setting_density, level, uint(lao_constant_levels)),
                                     lao_setting_depth_threshold);
    return g;
}

/* One sample: (its share of the occlusion, 1 when it counts). */
vec2 lao_sample_weight(sampler2D depths, sampler2D axials, sampler2D tangents, lao_centre c, lao_gather g,
                       lao_v3 direction) {
    lao_tap tap = lao_tap_make(g.rows, direction, g.size.xy);
    LAO_EXACT float nearer = g.depth - lao_depth_unpack(LAO_TEXEL(depths, tap.x, tap.y, g.size.zw));
    LAO_EXACT float difference = nearer * lao_frame.host_depth.w;
    LAO_EXACT float weight = tap.use;
    if (lao_uses_visibility(lao_constant_show)) {
        float least = lao_constant_strict_zero != 0 ? 0.0 : lao_setting_depth_threshold;
        weight = difference >= least ? weight : 0.0;
    }
    if (lao_uses_depth(lao_constant_show)) {
        weight = weight * lao_depth_weight(difference, lao_setting_depth_threshold, g.slope);
    }
    if (lao_uses_light(lao_constant_show)) {
        if (lao_constant_light == LAO_LIGHT_PAPER) {
            LAO_EXACT float specular = lao_setting_light_intensity * lao_setting_light_specular;
            weight = weight *
                     lao_light_weight(c.diffuse, tap.n_omega, specular, tap.r_omega, lao_constant_light_exponent);
        } else {
            lao_v3 occluder = lao_signed_unpack(LAO_TEXEL(tangents, tap.x, tap.y, g.size.zw));
            lao_v3 omega = lao_v3_scale(lao_mirror(direction, c.noise), tap.flip);
            weight = weight *
                     lao_light_weight_author(omega, tap.n_omega, occluder, c.l, lao_constant_light_exponent);
        }
    }
    if (lao_constant_align != LAO_ALIGN_NONE && lao_uses_alignment(lao_constant_show)) {
        lao_v2 axial = lao_axial_unpack(LAO_TEXEL(axials, tap.x, tap.y, g.size.zw));
        float x = lao_constant_align == LAO_ALIGN_ROTATION ? lao_axial_difference(g.axial, axial)
                                                           : lao_alpha_difference(g.axial, axial);
        weight = weight * lao_align_weight(x, lao_setting_align_intensity, lao_setting_align_floor);
    }
    return vec2(weight, tap.use);
}

/* Any other number of samples: the directions are computed. */
vec2 lao_sample_loop(sampler2D depths, sampler2D axials, sampler2D tangents, lao_centre c, lao_gather g, uint level) {
    LAO_EXACT vec2 sum = vec2(0.0);
    uint count = lao_sample_count(uint(lao_constant_samples), level);
    for (uint i = 0u; i < count; i++) {
        sum = sum + lao_sample_weight(depths, axials, tangents, c, g, lao_sample_direction(level, i, count));
    }
    return sum;
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 own = texelFetch(depth0, pixel, 0);
    if (own.w < 0.5) {
        out_ao = vec4(0.0);
        return;
    }
    lao_centre c;
    c.pixel = lao_v2_make(float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    vec4 line = texelFetch(tangent, pixel, 0);
    c.l = lao_towards_eye(lao_pixel_slope(lao_frame.ray, c.pixel.x, c.pixel.y), lao_frame.depth.w);
    c.n = lao_line_normal(line.xyz, c.l);
    LAO_EXACT float nl = lao_max(lao_v3_dot(c.n, c.l), 0.0);
    LAO_EXACT float diffuse = lao_setting_light_intensity * lao_setting_light_diffuse * nl;
    c.diffuse = diffuse;
    c.r = lao_v3_along(lao_v3_scale(c.l, -1.0), c.n, 2.0 * nl);
    c.noise = lao_pixel_noise(uint(pixel.x), uint(pixel.y));
    c.zoom = line.w > 0.0 ? line.w : lao_pixel_zoom(lao_frame.scale, lao_frame.depth, lao_depth_unpack(own));
    LAO_EXACT float total = 0.0;
LAO_GENERATED_LEVELS
    LAO_EXACT float ao = total / float(lao_constant_levels);
    out_ao = vec4(ao);
}
#endif
