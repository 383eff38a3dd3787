/* Line ambient occlusion (Koehler 2017, Eqs. 1-12; METHODS 1.5-1.9, 2.4): the mean over levels of the mean over samples. */
LAO_TEX(0, sampler2D, tangent)
LAO_TEX(1, usampler2D, level0)
LAO_TEX(2, usampler2D, level1)
LAO_TEX(3, usampler2D, level2)
LAO_TEX(4, usampler2D, level3)
LAO_TEX(5, usampler2D, level4)
LAO_TEX(6, usampler2D, level5)
LAO_TEX(7, usampler2D, level6)
LAO_TEX(8, usampler2D, level7)
LAO_TEX(9, sampler2D, tangent1)
LAO_TEX(10, sampler2D, tangent2)
LAO_TEX(11, sampler2D, tangent3)
LAO_TEX(12, sampler2D, tangent4)
LAO_TEX(13, sampler2D, tangent5)
LAO_TEX(14, sampler2D, tangent6)
LAO_TEX(15, sampler2D, tangent7)
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
    vec2 inverse;    /* of the level's size */
    uint centre;     /* the pixel on this level */
    float threshold; /* delta 0 and what is visible beyond it, in steps of depth */
    float least;
    float slope;      /* of the depth weight */
    float align_floor; /* 1 where the centre has no direction */
    bool finest;       /* its tangents are the G-buffer's */
};

lao_gather lao_gather_make(usampler2D words, lao_centre c, uint level) {
    lao_gather g;
    LAO_EXACT float texel = 1.0 / float(1u << level);
    float radius = lao_sample_radius(c.zoom, lao_setting_radius, lao_setting_width, lao_setting_radius_step, level);
    LAO_EXACT float step = lao_frame.host_depth.w / LAO_LEVEL_STEPS;
    LAO_EXACT float threshold = lao_setting_depth_threshold / step;
    LAO_EXACT float slope = step * lao_depth_weight_slope(lao_depth_reach(lao_setting_density, level,
                                                                          uint(lao_constant_levels)),
                                                          lao_setting_depth_threshold);
    g.inverse = 1.0 / vec2(textureSize(words, 0));
    g.rows = lao_sampler_make(c.noise, c.n, c.r, radius, texel, c.pixel.x, c.pixel.y);
    g.centre = LAO_TEXEL(words, g.rows.own.x, g.rows.own.y, g.inverse).x;
    g.threshold = threshold;
    g.least = lao_constant_strict_zero != 0 ? -threshold : 0.0;
    g.slope = slope;
    g.align_floor = lao_level_known(g.centre) ? lao_setting_align_floor : 1.0;
    g.finest = level == 0u;
    return g;
}

/* One sample: (its share of the occlusion, 1 when it counts). */
vec2 lao_sample_weight(sampler2D tangents, lao_centre c, lao_gather g, lao_v3 direction, lao_tap tap, uint word) {
    LAO_EXACT float beyond = lao_level_nearer(g.centre, word) - g.threshold;
    bool visible = tap.counts;
    LAO_EXACT float weight = 1.0;
    if (lao_uses_visibility(lao_constant_show)) {
        visible = visible && beyond >= g.least;
    }
    if (lao_uses_depth(lao_constant_show)) {
        weight = lao_depth_weight(beyond, g.slope);
    }
    if (lao_uses_light(lao_constant_show)) {
        if (lao_constant_light == LAO_LIGHT_PAPER) {
            LAO_EXACT float specular = lao_setting_light_intensity * lao_setting_light_specular;
            weight = weight *
                     lao_light_weight(c.diffuse, tap.n_omega, specular, tap.r_omega, lao_constant_light_exponent);
        } else {
            vec4 texel = textureLod(tangents, tap.at, 0.0);
            lao_v3 occluder = texel.xyz;
            if (!g.finest) {
                occluder = lao_signed_unpack(texel);
            }
            lao_v3 omega = lao_v3_scale(lao_mirror(direction, c.noise), lao_turned(1.0, tap.side));
            weight = weight *
                     lao_light_weight_author(omega, tap.n_omega, occluder, c.l, lao_constant_light_exponent);
        }
    }
    if (lao_constant_align != LAO_ALIGN_NONE && lao_uses_alignment(lao_constant_show)) {
        float x = lao_constant_align == LAO_ALIGN_ROTATION ? lao_axial_difference(g.centre, word)
                                                           : lao_alpha_difference(g.centre, word);
        LAO_EXACT float aligned = lao_align_weight(x, lao_setting_align_intensity, g.align_floor);
        weight = weight * (lao_level_known(word) ? aligned : 1.0);
    }
    return vec2(visible ? weight : 0.0, tap.counts ? 1.0 : 0.0);
}

/* Four samples, their reads first: one after the other, each would wait for its own. */
vec2 lao_sample_four(vec2 before, usampler2D words, sampler2D tangents, lao_centre c, lao_gather g, lao_v3 r0,
                     lao_v3 r1, lao_v3 r2, lao_v3 r3) {
    LAO_EXACT vec2 sum = before;
    lao_tap t0 = lao_tap_make(g.rows, r0, g.inverse);
    lao_tap t1 = lao_tap_make(g.rows, r1, g.inverse);
    lao_tap t2 = lao_tap_make(g.rows, r2, g.inverse);
    lao_tap t3 = lao_tap_make(g.rows, r3, g.inverse);
    uint w0 = textureLod(words, t0.at, 0.0).x;
    uint w1 = textureLod(words, t1.at, 0.0).x;
    uint w2 = textureLod(words, t2.at, 0.0).x;
    uint w3 = textureLod(words, t3.at, 0.0).x;
    sum = sum + lao_sample_weight(tangents, c, g, r0, t0, w0);
    sum = sum + lao_sample_weight(tangents, c, g, r1, t1, w1);
    sum = sum + lao_sample_weight(tangents, c, g, r2, t2, w2);
    sum = sum + lao_sample_weight(tangents, c, g, r3, t3, w3);
    return sum;
}

vec2 lao_sample_one(vec2 before, usampler2D words, sampler2D tangents, lao_centre c, lao_gather g, lao_v3 direction) {
    lao_tap tap = lao_tap_make(g.rows, direction, g.inverse);
    uint word = textureLod(words, tap.at, 0.0).x;
    LAO_EXACT vec2 sum = before + lao_sample_weight(tangents, c, g, direction, tap, word);
    return sum;
}

/* Any other number of samples: the directions are computed. */
vec2 lao_sample_loop(usampler2D words, sampler2D tangents, lao_centre c, lao_gather g, uint level) {
    LAO_EXACT vec2 sum = vec2(0.0);
    uint count = lao_sample_count(uint(lao_constant_samples), level);
    for (uint i = 0u; i < count; i++) {
        sum = lao_sample_one(sum, words, tangents, c, g, lao_sample_direction(level, i, count));
    }
    return sum;
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    uint own = texelFetch(level0, pixel, 0).x;
    if (own == 0u) {
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
    c.zoom = line.w > 0.0 ? line.w : lao_pixel_zoom(lao_frame.scale, lao_frame.depth, lao_level_depth(own));
    LAO_EXACT float total = 0.0;
LAO_GENERATED_LEVELS
    LAO_EXACT float ao = total / float(lao_constant_levels);
    out_ao = vec4(ao);
}
#endif
