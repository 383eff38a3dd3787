/* ================================================================================================
 * shared: the view, the measure, the coordinates of the look-up, what the passes do to a pixel.
   From VSF_SHARED_BEGIN to VSF_SHARED_END the text is C99, C++11 and GLSL at once, behind
   lineao.h's, whose rules hold. Uses lineao.h's shared text; the interface ends here. */
/* VSF_SHARED_BEGIN */
#define VSF_FAR 3.0e38f /* a distance where nothing is lit */

/* ---- view (METHODS 10.3) */
/* The camera for the functions below: its place (mm) and 1, or the unit direction to an
   orthographic one and 0. `view`: world to view space, a rotation, reflection, translation and
   scale. */
LAO_FN lao_v4 vsf_eye(lao_m4 view, float orthographic) {
    lao_v3 right = lao_v3_make(view.x.x, view.y.x, view.z.x);
    lao_v3 up = lao_v3_make(view.x.y, view.y.y, view.z.y);
    lao_v3 back = lao_v3_make(view.x.z, view.y.z, view.z.z);
    LAO_EXACT float scale2 = lao_v3_dot(back, back);
    LAO_EXACT float inverse = 1.0f / lao_sqrt(scale2);
    LAO_EXACT float x = -(right.x * view.w.x + up.x * view.w.y + back.x * view.w.z) / scale2;
    LAO_EXACT float y = -(right.y * view.w.x + up.y * view.w.y + back.y * view.w.z) / scale2;
    LAO_EXACT float z = -(right.z * view.w.x + up.z * view.w.y + back.z * view.w.z) / scale2;
    lao_v3 direction = lao_v3_scale(back, inverse);
    bool flat_view = orthographic > 0.5f; /* choices, no branch: see vsf_near_mix */
    return lao_v4_make(flat_view ? direction.x : x, flat_view ? direction.y : y,
                       flat_view ? direction.z : z, flat_view ? 0.0f : 1.0f);
}
/* From a point to the camera, as long as it is far; unit when `naive` (or orthographic). */
LAO_FN lao_v3 vsf_to_eye(lao_v4 eye, lao_v3 p, bool naive) {
    LAO_EXACT float x = eye.x - eye.w * p.x;
    LAO_EXACT float y = eye.y - eye.w * p.y;
    LAO_EXACT float z = eye.z - eye.w * p.z;
    lao_v3 v = lao_v3_make(x, y, z);
    return naive ? lao_v3_unit(v, lao_v3_make(0.0f, 0.0f, 0.0f)) : v;
}
/* l = n.v */
LAO_FN float vsf_light(lao_v4 eye, lao_v3 p, lao_v3 n, bool naive) {
    LAO_EXACT float l = lao_v3_dot(n, vsf_to_eye(eye, p, naive));
    return l;
}

/* ---- suggestive-contour measure s = w . grad(n.v) / |v|^2, w = v - (n.v) n */
/* Ring start and number of entries, from w of surface_points and of surface_normals. */
LAO_FN lao_uint vsf_ring_count(float normal_w) {
    return LAO_U(normal_w) & 65535u;
}
LAO_FN lao_uint vsf_ring_start(float point_w, float normal_w) {
    return LAO_U(point_w) * 256u + (LAO_U(normal_w) >> 16u);
}
struct vsf_ring_sum {
    lao_v3 w;
    float light, view2, sum;
};
#ifndef LAO_GLSL
typedef struct vsf_ring_sum vsf_ring_sum;
#endif
LAO_FN vsf_ring_sum vsf_ring_begin(lao_v4 eye, lao_v3 p, lao_v3 n, bool naive) {
    vsf_ring_sum r;
    lao_v3 v = vsf_to_eye(eye, p, naive);
    LAO_EXACT float light = lao_v3_dot(n, v);
    LAO_EXACT float view2 = lao_v3_dot(v, v);
    r.w = lao_v3_along(v, n, -light);
    r.light = light;
    r.view2 = view2;
    r.sum = 0.0f;
    return r;
}
/* One texel of surface_rings, and n.v of the neighbour that it names. */
LAO_FN vsf_ring_sum vsf_ring_add(vsf_ring_sum ring, lao_v4 entry, float light) {
    vsf_ring_sum r = ring;
    LAO_EXACT float along = lao_v3_dot(ring.w, lao_v3_make(entry.x, entry.y, entry.z));
    LAO_EXACT float sum = ring.sum + along * (light - ring.light);
    r.sum = sum;
    return r;
}
LAO_FN float vsf_ring_end(vsf_ring_sum ring) {
    LAO_EXACT float s = ring.sum / lao_max(ring.view2, 1.0e-30f);
    return lao_abs(s) < 1.0e30f ? s : 0.0f; /* no number: 0 */
}

/* ---- the two coordinates of the look-up (METHODS 9.2, 9.3) */
/* A distance between those at two steps; VSF_FAR where either is (0 and 1 take one step alone).
   Choices and no branches: lavapipe compiles a program anew, frame by frame, whose branches ask for
   a uniform. */
LAO_FN float vsf_near_mix(float before, float after, float part) {
    LAO_EXACT float between = before + part * (after - before);
    float d = lao_max(before, after) >= VSF_FAR ? VSF_FAR : between;
    d = part < 1.0f ? d : after;
    return part > 0.0f ? d : before;
}
/* x = 1 - distance / gamma in [0, 1]; 0 where nothing is lit */
LAO_FN float vsf_near_x(float distance, float gamma) {
    LAO_EXACT float x = 1.0f - distance / gamma;
    float near_x = distance < VSF_FAR ? lao_clamp01(x) : 0.0f;
    return gamma > 0.0f ? near_x : 0.0f;
}
/* y = c s in [-1, 1] */
LAO_FN float vsf_measure_y(float measure, float brightness) {
    LAO_EXACT float y = brightness * measure;
    return lao_min(lao_max(y, -1.0f), 1.0f);
}
/* The pure colour of a hue in turns: HLS(hue, 1/2, 1). */
LAO_FN lao_v3 vsf_hue(float hue) {
    LAO_EXACT float t = 6.0f * hue;
    LAO_EXACT float r = lao_clamp01(lao_abs(t - 3.0f) - 1.0f);
    LAO_EXACT float g = lao_clamp01(2.0f - lao_abs(t - 2.0f));
    LAO_EXACT float b = lao_clamp01(2.0f - lao_abs(t - 4.0f));
    return lao_v3_make(r, g, b);
}
/* The look-up (L14 Fig. 4), x in [0, 1] and y in [-1, 1]: a premultiplied colour with opacity |y|.
   Upper half orange to red, lower half cyan to green, black at y = 0. */
LAO_FN lao_v4 vsf_lookup(float x, float y) {
    LAO_EXACT float far_hue = y < 0.0f ? 0.544262973f : 0.0744865201f;
    LAO_EXACT float near_hue = y < 0.0f ? 0.333333333f : 0.0f;
    LAO_EXACT float hue = far_hue * (1.0f - x) + near_hue * x;
    LAO_EXACT float opacity = lao_abs(y);
    lao_v3 color = lao_v3_scale(vsf_hue(hue), opacity);
    return lao_v4_make(color.x, color.y, color.z, opacity);
}

/* Where in a map of `count` colours x is: how far behind a colour, and that colour (whole, so that
   there is one behind it). */
LAO_FN lao_v2 vsf_map_place(float x, float count) {
    LAO_EXACT float at = lao_clamp01(x) * (count - 1.0f);
    LAO_EXACT float before = lao_max(lao_min(lao_floor(at), count - 2.0f), 0.0f);
    return lao_v2_make(at - before, before);
}
/* The other look: a colour that tells x, premultiplied with |y|, or more where x is large. */
LAO_FN lao_v4 vsf_mapped(lao_v3 color, float x, float y, float opacity) {
    LAO_EXACT float least = opacity * x;
    LAO_EXACT float most = lao_max(lao_abs(y), least);
    lao_v3 c = lao_v3_scale(color, most);
    return lao_v4_make(c.x, c.y, c.z, most);
}

/* ---- opacity of the baselines (METHODS 10.4) */
/* a^r for a in [0, 1] and r > 0 */
LAO_FN float vsf_power(float a, float r) {
    LAO_EXACT float x = r * lao_log2(a);
    return a > 0.0f ? lao_exp2(x) : 0.0f;
}
/* 1 - |n.v|^r, unit vectors: larger r, more opaque */
LAO_FN float vsf_fresnel(float n_dot_v, float falloff) {
    LAO_EXACT float a = lao_min(lao_abs(n_dot_v), 1.0f);
    LAO_EXACT float o = 1.0f - vsf_power(a, falloff);
    return lao_clamp01(o);
}
/* The other common form, (1 - |n.v|)^r: larger r, less opaque */
LAO_FN float vsf_fresnel_rim(float n_dot_v, float falloff) {
    LAO_EXACT float a = 1.0f - lao_min(lao_abs(n_dot_v), 1.0f);
    return vsf_power(a, falloff);
}
/* A colour that is not premultiplied, with an opacity: premultiplied. */
LAO_FN lao_v4 vsf_premultiply(lao_v3 color, float opacity) {
    lao_v3 c = lao_v3_scale(color, opacity);
    return lao_v4_make(c.x, c.y, c.z, opacity);
}
/* One premultiplied colour over another. */
LAO_FN lao_v4 vsf_over(lao_v4 front, lao_v4 behind) {
    LAO_EXACT float t = 1.0f - front.w;
    LAO_EXACT float x = front.x + t * behind.x;
    LAO_EXACT float y = front.y + t * behind.y;
    LAO_EXACT float z = front.z + t * behind.z;
    LAO_EXACT float w = front.w + t * behind.w;
    return lao_v4_make(x, y, z, w);
}
/* The greater of two, component by component. */
LAO_FN lao_v4 vsf_greater(lao_v4 a, lao_v4 b) {
    return lao_v4_make(lao_max(a.x, b.x), lao_max(a.y, b.y), lao_max(a.z, b.z), lao_max(a.w, b.w));
}
/* The alternative: light is added, at most 1. */
LAO_FN lao_v4 vsf_add(lao_v4 front, lao_v4 behind) {
    LAO_EXACT float x = front.x + behind.x; /* exact: no sum may join a caller's product */
    LAO_EXACT float y = front.y + behind.y;
    LAO_EXACT float z = front.z + behind.z;
    LAO_EXACT float w = front.w + behind.w;
    return lao_v4_make(lao_min(x, 1.0f), lao_min(y, 1.0f), lao_min(z, 1.0f), lao_min(w, 1.0f));
}
/* ---- focus (METHODS 10.5) */
/* How far a depth is outside the focus region, mm */
LAO_FN float vsf_outside(float z, float focus_near, float focus_far) {
    LAO_EXACT float before = focus_near - z;
    LAO_EXACT float behind = z - focus_far;
    return lao_max(lao_max(before, behind), 0.0f);
}
/* Width of the blur in pixels */
LAO_FN float vsf_blur_sigma(float outside, float growth, float sigma_max) {
    LAO_EXACT float sigma = growth * outside;
    return lao_min(sigma, sigma_max);
}
/* exp(-d^2 / (2 sigma^2)); without a width 1 at the centre and 0 elsewhere */
LAO_FN float vsf_gauss(float distance2, float sigma) {
    if (!(sigma > 0.0f)) {
        return distance2 > 0.0f ? 0.0f : 1.0f;
    }
    LAO_EXACT float x = -0.72134752f * (distance2 / sigma / sigma);
    return x < -125.0f ? 0.0f : lao_exp2(x);
}
#define VSF_BLUR_REACH 3.0f /* samples farther than this many sigmas do not count */
#define VSF_BLUR_MOST 96    /* pixels to either side: the widest setting's reach */
/* The focus blur passes by tiles of 16 x 16 pixels to which it brings no colour. */
#define VSF_FOCUS_LEVEL 4u
#define VSF_FOCUS_PIXELS 16
/* Does a sample count in the blur of a centre of depth `z`? Only if it is behind it, or if its own
   blur reaches it, so that what is in focus does not bleed. */
LAO_FN bool vsf_blur_counts(float distance2, float z, float sample_sigma, float sample_z) {
    LAO_EXACT float reach = VSF_BLUR_REACH * sample_sigma;
    LAO_EXACT float reach2 = reach * reach;
    return !(sample_z < z) || distance2 <= reach2;
}
/* Weight of a sample in the blur of a centre with width `sigma`. The sums of weights and of
   weighted colours make a mean; the centre has weight 1. */
LAO_FN float vsf_blur_weight(float distance2, float sigma, float z, float sample_sigma,
                             float sample_z) {
    LAO_EXACT float reach = VSF_BLUR_REACH * sigma;
    LAO_EXACT float reach2 = reach * reach;
    if (distance2 > reach2 || !vsf_blur_counts(distance2, z, sample_sigma, sample_z)) {
        return 0.0f;
    }
    return vsf_gauss(distance2, sigma);
}

/* ---- shadow from the depth buffer (METHODS 10.6) */
/* The colour, darker where the blurred depth (0..1, larger is farther) is less than the depth. */
LAO_FN lao_v3 vsf_unsharp(lao_v3 color, float depth, float blurred, float strength) {
    LAO_EXACT float rise = blurred - depth;
    LAO_EXACT float shade = strength * lao_min(rise, 0.0f);
    LAO_EXACT float x = color.x + shade;
    LAO_EXACT float y = color.y + shade;
    LAO_EXACT float z = color.z + shade;
    return lao_v3_make(lao_max(x, 0.0f), lao_max(y, 0.0f), lao_max(z, 0.0f));
}

/* ---- what the passes are made of */
#define VSF_LEFT_TILES 64 /* along both sides of the picture */
#define VSF_SHADING_ADAPTIVE 0
#define VSF_SHADING_TRANSPARENT 1
#define VSF_SHADING_FRESNEL 2
#define VSF_FALLOFF_PAPER 0
#define VSF_FALLOFF_RIM 1
#define VSF_BLEND_OVER 0
#define VSF_BLEND_ADD 1
#define VSF_NEAR_DISTANCE 0
#define VSF_NEAR_VALUE 1
#define VSF_NEAR_HUES 0
#define VSF_NEAR_MAP 1
/* x of a value between the two that are 0 and 1; 0 for no number */
LAO_FN float vsf_value_x(float value, float low, float high) {
    LAO_EXACT float x = (value - low) / (high - low);
    return x > 0.0f ? lao_min(x, 1.0f) : 0.0f;
}
/* A wall under a head light, whichever side is seen. */
LAO_FN lao_v3 vsf_wall(lao_v3 color, float n_dot_v, float ambient, float diffuse) {
    LAO_EXACT float light = ambient + diffuse * lao_abs(n_dot_v);
    lao_v3 c = lao_v3_scale(color, light);
    return lao_v3_make(lao_clamp01(c.x), lao_clamp01(c.y), lao_clamp01(c.z));
}
/* View depth (mm) of a depth buffer's value d. */
LAO_FN float vsf_view_depth(lao_v4 unproject, float d) {
    LAO_EXACT float z = (unproject.x + unproject.y * d) / (unproject.z + unproject.w * d);
    return z;
}
/* The nearer of two depth buffer values. */
LAO_FN float vsf_nearer(float a, float b, float reversed) {
    return reversed > 0.5f ? lao_max(a, b) : lao_min(a, b);
}
/* Is depth buffer value a in front of b? */
LAO_FN bool vsf_in_front(float a, float b, float reversed) {
    return reversed > 0.5f ? a > b : a < b;
}
/* Has anything been drawn there? */
LAO_FN bool vsf_is_covered(float d, float reversed) {
    return reversed > 0.5f ? d > 0.0f : d < 1.0f;
}
/* Depths of what is covered: their sum over their weight; `otherwise` where there are none. */
LAO_FN float vsf_covered_mean(float sum, float weight, float otherwise) {
    LAO_EXACT float mean = sum / weight;
    return weight > 1.0e-12f ? mean : otherwise;
}
/* A premultiplied colour times a number. */
LAO_FN lao_v4 vsf_scaled(lao_v4 color, float s) {
    LAO_EXACT float x = color.x * s;
    LAO_EXACT float y = color.y * s;
    LAO_EXACT float z = color.z * s;
    LAO_EXACT float w = color.w * s;
    return lao_v4_make(x, y, z, w);
}
/* sum + color weight */
LAO_FN lao_v4 vsf_sum(lao_v4 sum, lao_v4 color, float weight) {
    LAO_EXACT float x = sum.x + color.x * weight;
    LAO_EXACT float y = sum.y + color.y * weight;
    LAO_EXACT float z = sum.z + color.z * weight;
    LAO_EXACT float w = sum.w + color.w * weight;
    return lao_v4_make(x, y, z, w);
}
LAO_FN lao_v4 vsf_mix(lao_v4 a, lao_v4 b, float t) {
    LAO_EXACT float s = 1.0f - t;
    return vsf_sum(vsf_scaled(a, s), b, t);
}

/* The shadow's blurred depth is made at a quarter of the view's size: a texel for 4 x 4 pixels. */
#define VSF_SHADOW_PIXELS 4.0f
#define VSF_SHADOW_LEVEL 2u
#define VSF_SHADOW_REACH 160 /* most texels to either side */
/* Width of its Gaussian in those texels; `width` in parts of the view's diagonal (px). */
LAO_FN float vsf_shadow_sigma(float width, float view_width, float view_height) {
    LAO_EXACT float diagonal = lao_sqrt(view_width * view_width + view_height * view_height);
    LAO_EXACT float sigma = width * diagonal / VSF_SHADOW_PIXELS;
    return sigma;
}
/* Three sigmas, in whole texels or pixels. */
LAO_FN lao_int vsf_reach(float sigma, lao_int most) {
    LAO_EXACT float reach = lao_floor(VSF_BLUR_REACH * sigma);
    return reach < LAO_F(most) ? LAO_I(reach) : most;
}
/* Where a sample's centre lies between texels that cover `samples` of it: x, and the texel before
   it (whole, may be -1). */
LAO_FN lao_v2 vsf_between(float sample_index, float samples) {
    LAO_EXACT float at = (sample_index + 0.5f) / samples - 0.5f;
    LAO_EXACT float before = lao_floor(at);
    return lao_v2_make(at - before, before);
}
LAO_FN float vsf_bilinear(float a, float b, float c, float d, float x, float y) {
    LAO_EXACT float low = a + (b - a) * x;
    LAO_EXACT float high = c + (d - c) * x;
    LAO_EXACT float r = low + (high - low) * y;
    return r;
}
/* The unsharp shadow of a premultiplied colour. */
LAO_FN lao_v4 vsf_shadowed(lao_v4 color, float depth, float blurred, float strength) {
    LAO_EXACT float s = strength * color.w;
    lao_v3 c = vsf_unsharp(lao_v3_make(color.x, color.y, color.z), depth, blurred, s);
    return lao_v4_make(c.x, c.y, c.z, color.w);
}
/* A premultiplied colour that fades with depth (0..1). */
LAO_FN lao_v4 vsf_attenuated(lao_v4 color, float depth, float strength) {
    LAO_EXACT float keep = 1.0f - strength * depth;
    return vsf_scaled(color, lao_clamp01(keep));
}
/* VSF_SHARED_END */

#endif /* VESSELSURFACE_H */
