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
    lao_v3 n, r, l, noise; /* normal and reflected light (paper: scaled, see lao_light_weight), towards the light, mirror */
    lao_v2 pixel;
    float zoom; /* px per mm */
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

/* What a sample brings to its read: everything that does not depend on it. */
struct lao_sample {
    lao_v3 direction;
    vec2 at;
    float n_omega, light; /* weight of the light, where it depends on the pixel alone */
    uint side;
    bool counts;
};

lao_sample lao_sample_make(lao_centre c, lao_gather g, lao_v3 direction) {
    lao_sample s;
    lao_tap tap = lao_tap_make(g.rows, direction, g.inverse);
    s.direction = direction;
    s.at = tap.at;
    s.n_omega = tap.n_omega;
    s.light = 1.0;
    if (lao_uses_light(lao_constant_show) && lao_constant_light == LAO_LIGHT_PAPER) {
        s.light = lao_light_weight(tap.n_omega, tap.r_omega, lao_constant_light_exponent);
    }
    s.side = tap.side;
    s.counts = tap.counts;
    return s;
}

/* One sample: (its share of the occlusion, 1 when it counts). */
vec2 lao_sample_weight(sampler2D tangents, lao_centre c, lao_gather g, lao_sample s, uint word) {
    LAO_EXACT float beyond = lao_level_nearer(g.centre, word) - g.threshold;
    bool visible = s.counts;
    LAO_EXACT float weight = s.light;
    if (lao_uses_visibility(lao_constant_show)) {
        visible = visible && beyond >= g.least;
    }
    if (lao_uses_depth(lao_constant_show)) {
        if (lao_uses_visibility(lao_constant_show) && lao_constant_strict_zero == 0) {
            weight = weight * lao_depth_weight_beyond(beyond, g.slope);
        } else {
            weight = weight * lao_depth_weight(beyond, g.slope);
        }
    }
    if (lao_uses_light(lao_constant_show) && lao_constant_light == LAO_LIGHT_AUTHOR) {
        vec4 texel = textureLod(tangents, s.at, 0.0);
        lao_v3 occluder = texel.xyz;
        if (!g.finest) {
            occluder = lao_signed_unpack(texel);
        }
        lao_v3 omega = lao_v3_scale(lao_mirror(s.direction, c.noise), lao_turned(1.0, s.side));
        weight = weight * lao_light_weight_author(omega, s.n_omega, occluder, c.l, lao_constant_light_exponent);
    }
    if (lao_constant_align != LAO_ALIGN_NONE && lao_uses_alignment(lao_constant_show)) {
        float x = lao_constant_align == LAO_ALIGN_ROTATION ? lao_axial_difference(g.centre, word)
                                                           : lao_alpha_difference(g.centre, word);
        LAO_EXACT float aligned = lao_align_weight(x, lao_setting_align_intensity, g.align_floor);
        weight = weight * (lao_level_known(word) ? aligned : 1.0);
    }
    return vec2(visible ? weight : 0.0, s.counts ? 1.0 : 0.0);
}

/* Four samples, their reads together: one after the other, each would wait for its own. */
vec2 lao_sample_four(vec2 before, usampler2D words, sampler2D tangents, lao_centre c, lao_gather g, lao_v3 r0, lao_v3 r1, lao_v3 r2, lao_v3 r3) {
    LAO_EXACT vec2 sum = before;
    lao_sample s0 = lao_sample_make(c, g, r0);
    lao_sample s1 = lao_sample_make(c, g, r1);
    lao_sample s2 = lao_sample_make(c, g, r2);
    lao_sample s3 = lao_sample_make(c, g, r3);
    uint w0 = textureLod(words, s0.at, 0.0).x;
    uint w1 = textureLod(words, s1.at, 0.0).x;
    uint w2 = textureLod(words, s2.at, 0.0).x;
    uint w3 = textureLod(words, s3.at, 0.0).x;
    sum = sum + lao_sample_weight(tangents, c, g, s0, w0);
    sum = sum + lao_sample_weight(tangents, c, g, s1, w1);
    sum = sum + lao_sample_weight(tangents, c, g, s2, w2);
    sum = sum + lao_sample_weight(tangents, c, g, s3, w3);
    return sum;
}

vec2 lao_sample_three(vec2 before, usampler2D words, sampler2D tangents, lao_centre c, lao_gather g, lao_v3 r0, lao_v3 r1, lao_v3 r2) {
    LAO_EXACT vec2 sum = before;
    lao_sample s0 = lao_sample_make(c, g, r0);
    lao_sample s1 = lao_sample_make(c, g, r1);
    lao_sample s2 = lao_sample_make(c, g, r2);
    uint w0 = textureLod(words, s0.at, 0.0).x;
    uint w1 = textureLod(words, s1.at, 0.0).x;
    uint w2 = textureLod(words, s2.at, 0.0).x;
    sum = sum + lao_sample_weight(tangents, c, g, s0, w0);
    sum = sum + lao_sample_weight(tangents, c, g, s1, w1);
    sum = sum + lao_sample_weight(tangents, c, g, s2, w2);
    return sum;
}

vec2 lao_sample_one(vec2 before, usampler2D words, sampler2D tangents, lao_centre c, lao_gather g, lao_v3 direction) {
    lao_sample s = lao_sample_make(c, g, direction);
    uint word = textureLod(words, s.at, 0.0).x;
    LAO_EXACT vec2 sum = before + lao_sample_weight(tangents, c, g, s, word);
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
    c.r = lao_v3_along(lao_v3_scale(c.l, -1.0), c.n, 2.0 * nl);
    if (lao_constant_light == LAO_LIGHT_PAPER) {
        c.n = lao_v3_scale(c.n, lao_light_diffuse(lao_setting_light_intensity, lao_setting_light_diffuse, nl));
        c.r = lao_v3_scale(c.r, lao_light_specular(lao_setting_light_intensity, lao_setting_light_specular,
                                                   lao_constant_light_exponent));
    }
    c.noise = lao_pixel_noise(uint(pixel.x), uint(pixel.y));
    c.zoom = line.w > 0.0 ? line.w : lao_pixel_zoom(lao_frame.scale, lao_frame.depth, lao_level_depth(own));
    LAO_EXACT float total = 0.0;
LAO_GENERATED_LEVELS
    LAO_EXACT float ao = total / float(lao_constant_levels);
    out_ao = vec4(ao);
}
#endif
