/* ================================================================================================
 * shared_occlusion: line ambient occlusion and shading. Uses shared_math and shared_lines; the
   interface ends here. */
/* LAO_SHARED_BEGIN */
/* ---- occlusion (METHODS 1.5 - 1.9, 2.3 - 2.5) */
#define LAO_LIGHT_PAPER 0
#define LAO_LIGHT_AUTHOR 1
#define LAO_PYRAMID_BOX 0
#define LAO_SHOW_PICTURE 0
#define LAO_SHOW_OCCLUSION 1
#define LAO_SHOW_VISIBILITY 2
#define LAO_SHOW_DEPTH 3
#define LAO_SHOW_LIGHT 4
#define LAO_SHOW_ALIGNMENT 5
#define LAO_SHOW_VISIBILITY_DEPTH 6
#define LAO_SHOW_VISIBILITY_DEPTH_LIGHT 7
#define LAO_SHOW_COLOR 8
#define LAO_COLOR_MULTIPLY 0
#define LAO_COLOR_LUMINANCE_PRESERVING 1
/* Which factors a sample's weight is made of: all of them, or what the setting `show` singles out
 * (Fig. 4). */
LAO_FN bool lao_uses_visibility(lao_int show) {
    return show != LAO_SHOW_DEPTH && show != LAO_SHOW_LIGHT && show != LAO_SHOW_ALIGNMENT;
}
LAO_FN bool lao_uses_depth(lao_int show) {
    return show != LAO_SHOW_VISIBILITY && show != LAO_SHOW_LIGHT && show != LAO_SHOW_ALIGNMENT;
}
LAO_FN bool lao_uses_light(lao_int show) {
    return show <= LAO_SHOW_OCCLUSION || show == LAO_SHOW_LIGHT ||
           show >= LAO_SHOW_VISIBILITY_DEPTH_LIGHT;
}
LAO_FN bool lao_uses_alignment(lao_int show) {
    return show <= LAO_SHOW_OCCLUSION || show == LAO_SHOW_ALIGNMENT || show == LAO_SHOW_COLOR;
}

/* delta(l) = density (1 - l / levels)^2 (Eq. 7, corrected) */
LAO_FN float lao_depth_reach(float density, lao_uint level, lao_uint levels) {
    LAO_EXACT float t = 1.0f - LAO_F(level) / LAO_F(levels);
    LAO_EXACT float r = density * t * t;
    return r;
}
/* Eq. 5: 1 below delta 0, 0 beyond reach; `beyond` delta 0. slope: lao_depth_weight_slope. It is
   1 - h(t) with t stretched by the cube root of 2, which takes h's factors away. */
LAO_FN float lao_depth_weight_beyond(float beyond, float slope) { /* of beyond >= 0 */
    LAO_EXACT float steep = slope * 1.25992095f;
    LAO_EXACT float t = lao_min(beyond * steep, 1.25992095f);
    LAO_EXACT float r = 1.0f + t * t * (t - 1.88988161f);
    return r;
}
LAO_FN float lao_depth_weight(float beyond, float slope) {
    return lao_depth_weight_beyond(lao_max(beyond, 0.0f), slope);
}
/* 1 / (reach - delta 0); steep enough for a step where reach does not exceed delta 0. */
LAO_FN float lao_depth_weight_slope(float reach, float threshold) {
    LAO_EXACT float width = lao_max(reach - threshold, 1.0e-20f);
    LAO_EXACT float slope = 1.0f / width;
    return slope;
}
/* What the normal and the reflected light of a pixel are scaled by, so that their cosines to omega
   carry the light's parts: I k_d n.l (not 0, whose products would have no sign), and the root of
   I k_s that the exponent takes back. */
LAO_FN float lao_light_diffuse(float intensity, float diffuse, float nl) {
    LAO_EXACT float scale = lao_max(intensity * diffuse * nl, 1.0e-20f);
    return scale;
}
LAO_FN float lao_light_specular(float intensity, float specular, lao_int exponent) {
    LAO_EXACT float scale = intensity * specular;
    return scale > 0.0f ? lao_exp2(lao_log2(scale) / LAO_F(exponent)) : 0.0f;
}
/* Eq. 8 and 9 with the receiver's cosine: I k_d (n.l)(n.omega), and the root of the specular part
   (below 0 counts as 0) */
LAO_FN float lao_light_weight(float diffuse, float root, lao_int exponent) {
    float shine = lao_squarings(lao_max(root, lao_power_least(exponent)), exponent);
    LAO_EXACT float g = 1.0f - lao_min(diffuse + shine, 1.0f);
    return g;
}
/* The light form of the author's program: 1.5 - max(omega.n, 0)(spec + diff), the reflection at the
   occluder, whose normal faces omega; l: towards the eye (METHODS 1.8). */
LAO_FN float lao_light_weight_author(lao_v3 omega, float n_omega, lao_v3 occluder, lao_v3 l,
                                     lao_int exponent) {
    if (!(lao_v3_dot(occluder, occluder) > 0.25f)) {
        return 1.5f;
    }
    lao_v3 t = lao_v3_unit(occluder, lao_v3_make(1.0f, 0.0f, 0.0f));
    lao_v3 n = lao_line_normal(t, omega);
    lao_v3 h = lao_v3_unit(lao_v3_add(l, omega), n);
    LAO_EXACT float diffuse = lao_max(lao_v3_dot(n, l), 0.0f);
    LAO_EXACT float specular = lao_power(lao_max(lao_v3_dot(h, n), 0.0f), exponent);
    LAO_EXACT float g = lao_max(1.5f - n_omega * (specular + diffuse), 0.0f);
    return g;
}
/* Difference of direction x in [0, 1], 1 - |t.t'|, of two words with directions; absolute error
   below 1e-5 besides that of the steps. */
LAO_FN float lao_axial_difference(lao_uint a, lao_uint b) {
    LAO_EXACT float t = LAO_F(LAO_I((a & LAO_LEVEL_TURN) - (b & LAO_LEVEL_TURN))) * 2.40889417e-10f;
    LAO_EXACT float s = t * t;
    LAO_EXACT float x = s * (4.60955151f + s * (s - 3.52867133f));
    return x;
}
/* Eq. 10 as printed: x = ||t.x| - |t'.x|| */
LAO_FN float lao_alpha_difference(lao_uint a, lao_uint b) {
    LAO_EXACT float x = lao_abs(LAO_F(LAO_I(a >> 21u) - LAO_I(b >> 21u))) / 2047.0f;
    return x;
}
/* Eq. 11 for a difference in [0, 1]: I h(x), at most 1, at least A0 */
LAO_FN float lao_align_weight(float difference, float intensity, float least) {
    LAO_EXACT float triple = 3.0f * intensity;
    LAO_EXACT float twice = 2.0f * intensity;
    LAO_EXACT float g = difference * difference * (triple - twice * difference);
    return lao_max(lao_min(g, 1.0f), least);
}

/* What a pixel needs for all samples of one level: the mirror at N and the radius folded into three
   vectors, so that omega.x r, omega.y r and omega.n are one dot product each with the literal
   direction. */
struct lao_sampler {
    lao_v3 x, y, n, r; /* rows: offset in texels of the level, normal, reflected light */
    lao_v2 centre;     /* pixel centre in texels of the level */
    lao_v2 own;        /* the texel that it lies in */
};
#ifndef LAO_GLSL
typedef struct lao_sampler lao_sampler;
#endif
/* v mirrored at the plane of N: dot(R, mirror(v, N)) = dot(mirror(R, N), v) */
LAO_FN lao_v3 lao_mirror(lao_v3 v, lao_v3 n) {
    LAO_EXACT float t = -2.0f * lao_v3_dot(v, n);
    return lao_v3_along(v, n, t);
}
/* radius in pixels of the finest level; texel = 1 / 2^level */
LAO_FN lao_sampler lao_sampler_make(lao_v3 noise, lao_v3 normal, lao_v3 reflected, float radius,
                                    float texel, float px, float py) {
    lao_sampler s;
    LAO_EXACT float scale = lao_max(radius * texel, 1.5f);
    s.x = lao_v3_scale(lao_mirror(lao_v3_make(1.0f, 0.0f, 0.0f), noise), scale);
    s.y = lao_v3_scale(lao_mirror(lao_v3_make(0.0f, 1.0f, 0.0f), noise), scale);
    s.n = lao_mirror(normal, noise);
    s.r = lao_mirror(reflected, noise);
    s.centre = lao_v2_make(px * texel, py * texel);
    s.own = lao_v2_make(lao_floor(s.centre.x), lao_floor(s.centre.y));
    return s;
}
/* v, its sign turned round where `side` is the sign bit. */
LAO_FN float lao_turned(float v, lao_uint side) {
    return lao_bits_float(lao_float_bits(v) ^ side);
}
/* One sample: texel (x, y) of the level and its centre in [0, 1], cosines to normal and reflection,
   the side that omega was turned to, whether it counts (not outside the image, not the centre's own
   texel). inverse: 1 / width, 1 / height of the level. */
struct lao_tap {
    lao_v2 at;
    float x, y, n_omega, r_omega;
    lao_uint side;
    bool counts;
};
#ifndef LAO_GLSL
typedef struct lao_tap lao_tap;
#endif
LAO_FN lao_tap lao_tap_make(lao_sampler s, lao_v3 direction, lao_v2 inverse) {
    lao_tap tap;
    LAO_EXACT float c = lao_v3_dot(direction, s.n);
    lao_uint side = lao_float_bits(c) & 2147483648u;
    LAO_EXACT float x = lao_floor(s.centre.x + lao_turned(lao_v3_dot(direction, s.x), side));
    LAO_EXACT float y = lao_floor(s.centre.y + lao_turned(lao_v3_dot(direction, s.y), side));
    LAO_EXACT float u = (x + 0.5f) * inverse.x;
    LAO_EXACT float v = (y + 0.5f) * inverse.y;
    /* both in [0, 1): the bits of less than 1, and no sign */
    bool inside = lao_float_bits(u) < 1065353216u && lao_float_bits(v) < 1065353216u;
    tap.counts = inside && (x != s.own.x || y != s.own.y);
    tap.side = side;
    tap.n_omega = lao_abs(c);
    tap.r_omega = lao_turned(lao_v3_dot(direction, s.r), side);
    tap.at = lao_v2_make(u, v);
    tap.x = x;
    tap.y = y;
    return tap;
}
/* Radius of a level in pixels of the finest (METHODS 1.4): zoom (factor width + level step). */
LAO_FN float lao_sample_radius(float zoom, float factor, float width, float step, lao_uint level) {
    LAO_EXACT float r = zoom * (factor * width + LAO_F(level) * step);
    return r;
}

/* ---- shading (METHODS 1.2, 1.8, 1.9): Phong with a head light, then all of it times 1 - occlusion
 */
LAO_FN lao_v3 lao_shade(lao_v3 color, lao_v3 t, lao_v3 l, float ambient, float diffuse,
                        float specular, lao_int exponent, float occlusion) {
    lao_v3 n = lao_line_normal(t, l);
    LAO_EXACT float nl = lao_max(lao_v3_dot(n, l), 0.0f);
    LAO_EXACT float rl = lao_max(2.0f * nl * nl - 1.0f, 0.0f);
    LAO_EXACT float body = ambient + diffuse * nl;
    LAO_EXACT float shine = specular * lao_power(rl, exponent);
    LAO_EXACT float light = 1.0f - lao_clamp01(occlusion);
    LAO_EXACT float x = (color.x * body + shine) * light;
    LAO_EXACT float y = (color.y * body + shine) * light;
    LAO_EXACT float z = (color.z * body + shine) * light;
    return lao_v3_make(lao_clamp01(x), lao_clamp01(y), lao_clamp01(z));
}
/* Display value to linear light (sRGB), for targets that encode on write. */
LAO_FN float lao_srgb_decode(float v) {
    if (v <= 0.04045f) {
        return v / 12.92f;
    }
    return lao_exp2(2.4f * lao_log2((v + 0.055f) / 1.055f));
}
/* Linear light to display value (sRGB). */
LAO_FN float lao_srgb_encode(float v) {
    if (v <= 0.0031308f) {
        return 12.92f * v;
    }
    LAO_EXACT float r = 1.055f * lao_exp2(lao_log2(v) / 2.4f) - 0.055f;
    return r;
}
/* What shading may take from the chroma of a color: the fifth that stays keeps its hue. */
#define LAO_FADE 0.8f
/* The same light as lao_shade, shown without a change of luminance: the darker it is, the more of
   the color's chroma gives way to the grey of the same luminance. So a color map whose lightness
   or hue tells the value stays readable (Koehler 2017, 5.2). No highlight. */
LAO_FN lao_v3 lao_shade_luminance(lao_v3 color, lao_v3 t, lao_v3 l, float ambient, float diffuse,
                                  float occlusion) {
    lao_v3 n = lao_line_normal(t, l);
    LAO_EXACT float nl = lao_max(lao_v3_dot(n, l), 0.0f);
    LAO_EXACT float body = lao_clamp01(ambient + diffuse * nl);
    LAO_EXACT float light = body * (1.0f - lao_clamp01(occlusion));
    LAO_EXACT float keep = 1.0f - LAO_FADE * (1.0f - light);
    float r = lao_srgb_decode(color.x);
    float g = lao_srgb_decode(color.y);
    float b = lao_srgb_decode(color.z);
    LAO_EXACT float grey = 0.2126f * r + 0.7152f * g + 0.0722f * b;
    LAO_EXACT float x = grey + keep * (r - grey);
    LAO_EXACT float y = grey + keep * (g - grey);
    LAO_EXACT float z = grey + keep * (b - grey);
    LAO_EXACT float red = lao_srgb_encode(x);
    LAO_EXACT float green = lao_srgb_encode(y);
    LAO_EXACT float blue = lao_srgb_encode(z);
    return lao_v3_make(lao_clamp01(red), lao_clamp01(green), lao_clamp01(blue));
}
/* Sum of `count` premultiplied samples over a premultiplied background. */
LAO_FN lao_v4 lao_over(lao_v4 sum, float count, lao_v4 background) {
    LAO_EXACT float w = sum.w / count;
    LAO_EXACT float through = 1.0f - w;
    LAO_EXACT float x = sum.x / count + background.x * through;
    LAO_EXACT float y = sum.y / count + background.y * through;
    LAO_EXACT float z = sum.z / count + background.z * through;
    LAO_EXACT float a = w + background.w * through;
    return lao_v4_make(x, y, z, a);
}
/* LAO_SHARED_END */

#endif /* LINEAO_H */
