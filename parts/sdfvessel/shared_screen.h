/* ================================================================================================
 * shared_screen: the picture: pull-push, shading, the surface of the screen, its directions and
   parameterization, ink. Uses shared_field; the interface ends here. */
/* SDV_SHARED_BEGIN */
/* ---- pull-push (L19 Eqs. 4 - 9 with METHODS 6): four channels at a time */
struct sdv_mix {
    lao_v4 value;
    float weight, share; /* sums of h min(w, 1) and of h */
};
#ifndef LAO_GLSL
typedef struct sdv_mix sdv_mix;
#endif
LAO_FN sdv_mix sdv_mix_start(lao_v4 zero) {
    sdv_mix m;
    m.value = zero;
    m.weight = 0.0f;
    m.share = 0.0f;
    return m;
}
/* One child or parent that exists. */
LAO_FN sdv_mix sdv_mix_add(sdv_mix m, lao_v4 value, float weight, float h) {
    sdv_mix r = m;
    LAO_EXACT float w = h * lao_min(weight, 1.0f);
    if (!(w > 0.0f)) {
        r.share = m.share + h;
        return r;
    }
    LAO_EXACT float x = m.value.x + w * value.x;
    LAO_EXACT float y = m.value.y + w * value.y;
    LAO_EXACT float z = m.value.z + w * value.z;
    LAO_EXACT float v = m.value.w + w * value.w;
    r.value = lao_v4_make(x, y, z, v);
    r.weight = m.weight + w;
    r.share = m.share + h;
    return r;
}
/* 0 where nothing had a weight. */
LAO_FN lao_v4 sdv_mix_value(sdv_mix m) {
    if (!(m.weight > 0.0f)) {
        return lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float x = m.value.x / m.weight;
    LAO_EXACT float y = m.value.y / m.weight;
    LAO_EXACT float z = m.value.z / m.weight;
    LAO_EXACT float v = m.value.w / m.weight;
    return lao_v4_make(x, y, z, v);
}
/* Weight of a child in the pull. */
LAO_FN float sdv_pull_share(lao_int pull) {
    return pull == 1 ? 1.0f : 0.25f;
}
/* The two nearest parents of texel x along an axis, k = 0, 1, and their shares. */
LAO_FN lao_int sdv_push_parent(lao_int x, lao_int k) {
    lao_int beside = (x & 1) != 0 ? 1 : -1;
    return (x >> 1) + (k != 0 ? beside : 0);
}
LAO_FN float sdv_push_share(lao_int push, lao_int k) {
    if (push == 1) {
        return k != 0 ? 0.25f : 0.75f;
    }
    return 0.5f;
}
/* How much of its own a texel keeps: 1 - (1 - w)^k. */
LAO_FN float sdv_push_own(float weight, lao_int exponent) {
    LAO_EXACT float a = 1.0f - lao_power(1.0f - lao_clamp01(weight), exponent);
    return a;
}
/* A texel of value and own share after the push from its parents' mix. */
LAO_FN lao_v4 sdv_push_value(sdv_mix parents, lao_v4 value, float own) {
    if (!(own > 0.0f)) {
        return sdv_mix_value(parents);
    }
    if (!(parents.weight > 0.0f) || own >= 1.0f) {
        return value;
    }
    lao_v4 g = sdv_mix_value(parents);
    LAO_EXACT float through = 1.0f - own;
    LAO_EXACT float x = through * g.x + own * value.x;
    LAO_EXACT float y = through * g.y + own * value.y;
    LAO_EXACT float z = through * g.z + own * value.z;
    LAO_EXACT float v = through * g.w + own * value.w;
    return lao_v4_make(x, y, z, v);
}
LAO_FN float sdv_push_weight(sdv_mix parents, float own) {
    if (!(parents.weight > 0.0f)) {
        return own;
    }
    LAO_EXACT float w = (1.0f - own) * (parents.weight / parents.share) + own;
    return w;
}

/* ---- shading */
#define SDV_NEAR_MISS_CLOSE 0
#define SDV_NEAR_MISS_EXACT 1
#define SDV_NEAR_MISS_NONE 2
#define SDV_OUTLINE_PX 0
#define SDV_HALO_FOOTPRINT 0.3f /* periods per pixel: where the void is steeper, marks end */
/* A magic lens (Bier et al. 1993): a circle on the picture inside or outside which a set is drawn.
 */
#define SDV_LENS_NONE 0
#define SDV_LENS_INSIDE 1
#define SDV_LENS_OUTSIDE 2
/* On which side of the circle a pixel's centre is; on it: inside. lens: middle, from the left and
   the top, in widths and heights of the picture; radius in heights, less `rim` samples. x, y: in
   samples, row 0 at the bottom; viewport: of lao_frame_uniforms. */
LAO_FN float sdv_lens_part(lao_v3 lens, float rim, float x, float y, lao_v4 viewport) {
    LAO_EXACT float right = x - lens.x * viewport.x;
    LAO_EXACT float up = y - (1.0f - lens.y) * viewport.y;
    LAO_EXACT float radius = lens.z * viewport.y - rim;
    LAO_EXACT float beyond =
        right * right + up * up - lao_max(radius, 0.0f) * lao_max(radius, 0.0f);
    return beyond > 0.0f ? 2.0f : 1.0f;
}
/* Is a pixel on this part not drawn by a set of that lens_side? By arithmetic: drivers compile
   anew for every value of a uniform that is branched on. */
LAO_FN bool sdv_lens_hides(float side, float part) {
    return side * lao_abs(side - part) > 0.5f;
}
/* Is a pixel that is drawn on the ring? part: of the circle inside the ring. */
LAO_FN bool sdv_lens_rings(float side, float part) {
    return side * part == 2.0f;
}
/* Pixels of the picture per mm at view depth z; scale, depth: of lao_frame_uniforms. */
LAO_FN float sdv_zoom(lao_v4 scale, lao_v4 depth, float z, float supersampling) {
    float apart = lao_max(z, 1.0e-6f);
    LAO_EXACT float across = (depth.w > 0.5f ? 1.0f : apart) * supersampling;
    LAO_EXACT float r = lao_abs(scale.y) / across;
    return r;
}
/* An outline's width in mm. */
LAO_FN float sdv_outline_width(float width, float unit, float zoom) {
    LAO_EXACT float mm = width / zoom;
    return unit > 0.5f ? width : mm;
}
/* How near to a vessel a ray must pass for anything to be drawn of it, mm. `shadow`, `halo`, `ink`:
   % of the diameter. */
LAO_FN float sdv_near_miss_reach(float silhouette, float contour, float shadow, float halo,
                                 float ink, float diameter) {
    LAO_EXACT float widest = 0.01f * lao_max(lao_max(shadow, halo), ink) * diameter;
    return lao_max(lao_max(silhouette, contour), widest);
}
/* Place of p along a cone's axis, 0 at a, 1 at b. */
LAO_FN float sdv_cone_place(lao_v3 p, lao_v4 a, lao_v4 b) {
    lao_v3 axis = lao_v3_make(b.x - a.x, b.y - a.y, b.z - a.z);
    lao_v3 q = lao_v3_make(p.x - a.x, p.y - a.y, p.z - a.z);
    LAO_EXACT float along = lao_v3_dot(q, axis) / lao_max(lao_v3_dot(axis, axis), 1.0e-30f);
    return lao_clamp01(along);
}
/* Between the colours of a cone's ends, by the place along its axis. */
LAO_FN lao_v3 sdv_cone_color(lao_v3 p, lao_v4 a, lao_v4 b, lao_v3 color_a, lao_v3 color_b) {
    float t = sdv_cone_place(p, a, b);
    LAO_EXACT float x = color_a.x + t * (color_b.x - color_a.x);
    LAO_EXACT float y = color_a.y + t * (color_b.y - color_a.y);
    LAO_EXACT float z = color_a.z + t * (color_b.z - color_a.z);
    return lao_v3_make(x, y, z);
}
/* Radius of the cone at the place, mm. */
LAO_FN float sdv_cone_radius(lao_v3 p, lao_v4 a, lao_v4 b) {
    LAO_EXACT float r = a.w + sdv_cone_place(p, a, b) * (b.w - a.w);
    return r;
}
/* Is the place marked? alpha_a, alpha_b: of the colours of the cone's ends. */
LAO_FN bool sdv_is_marked(lao_v3 p, lao_v4 a, lao_v4 b, float alpha_a, float alpha_b) {
    LAO_EXACT float alpha = alpha_a + sdv_cone_place(p, a, b) * (alpha_b - alpha_a);
    return alpha < 0.5f;
}
/* How near to a place of the surface another cone takes part in its shading normal (x, mm: within
   what the cell's list is sure to hold), and the radius there (y). a, b: of the cone at p. */
LAO_FN lao_v2 sdv_joint_reach(lao_v3 p, lao_v4 a, lao_v4 b, float smoothness, float cell) {
    float radius = sdv_cone_radius(p, a, b);
    LAO_EXACT float reach = smoothness * radius;
    return lao_v2_make(lao_min(reach, sdv_near_reach(cell)), radius);
}
/* Cones as long as the radius add nothing: they are smooth where they bend outwards, and the balls
   at their ends would tilt the normal before the joint. */
LAO_FN float sdv_joint_part(lao_v4 a, lao_v4 b, float radius) {
    lao_v3 axis = lao_v3_make(b.x - a.x, b.y - a.y, b.z - a.z);
    LAO_EXACT float size = lao_sqrt(lao_v3_dot(axis, axis));
    LAO_EXACT float part = 2.0f - 2.0f * size / radius;
    return lao_clamp01(part);
}
/* What the cone at p, of this gradient, has more than its part. */
LAO_FN lao_v3 sdv_joint_start(lao_v3 gradient, lao_v4 a, lao_v4 b, lao_v2 reach) {
    LAO_EXACT float rest = 1.0f - sdv_joint_part(a, b, reach.y);
    return lao_v3_scale(gradient, rest);
}
/* Adds the gradient of a cone that is nearer than reach.x to those before, the less the farther its
   surface is. */
LAO_FN lao_v3 sdv_joint_add(lao_v3 sum, float distance, lao_v3 gradient, lao_v4 a, lao_v4 b,
                            lao_v2 reach) {
    LAO_EXACT float part = 1.0f - lao_max(distance, 0.0f) / reach.x;
    LAO_EXACT float weight = part * part * sdv_joint_part(a, b, reach.y);
    return lao_v3_along(sum, gradient, weight);
}
/* The mean of the gradients on the side of the surface's own normal, unit. */
LAO_FN lao_v3 sdv_joint_normal(lao_v3 sum, lao_v3 normal) {
    lao_v3 n = lao_v3_unit(sum, normal);
    if (lao_v3_dot(n, normal) < 0.0f) {
        return lao_v3_scale(n, -1.0f);
    }
    return n;
}
/* Light after something dark, 0 .. 1, of that strength. */
LAO_FN float sdv_dimmed(float light, float dark, float strength) {
    LAO_EXACT float r = light * lao_clamp01(1.0f - strength * dark);
    return r;
}
/* Ambient and diffuse part. From within a vessel one sees walls at grazing angles, which light that
   walls throw at each other fills: half of the diffuse part comes from everywhere. */
LAO_FN lao_v2 sdv_light_parts(float ambient, float diffuse, bool inside) {
    LAO_EXACT float moved = inside ? 0.5f * diffuse : 0.0f;
    return lao_v2_make(ambient + moved, diffuse - moved);
}
/* Phong with a head light; n and l (towards the light) are unit. `light`: what reaches the place of
   all of it. */
LAO_FN lao_v3 sdv_shade(lao_v3 color, lao_v3 n, lao_v3 l, float ambient, float diffuse,
                        float specular, lao_int exponent, float light) {
    LAO_EXACT float nl = lao_max(lao_v3_dot(n, l), 0.0f);
    LAO_EXACT float rl = lao_max(2.0f * nl * nl - 1.0f, 0.0f);
    LAO_EXACT float body = (ambient + diffuse * nl) * light;
    LAO_EXACT float shine = specular * lao_power(rl, exponent) * light;
    LAO_EXACT float x = color.x * body + shine;
    LAO_EXACT float y = color.y * body + shine;
    LAO_EXACT float z = color.z * body + shine;
    return lao_v3_make(lao_clamp01(x), lao_clamp01(y), lao_clamp01(z));
}

/* ---- the surface of the screen: vessels and what fills the void behind them (L19 3.4 with METHODS
   6.1) */
#define SDV_BACKGROUND_INERTIA 0.01f   /* w_B: weight of the last frame's depth */
#define SDV_BACKGROUND_PRESENCE 0.001f /* weight of the void beside vessels in coarser levels */
/* Whether a traced pixel shows a surface: a cone's or a cut's. */
LAO_FN bool sdv_is_covered(float cone) {
    return cone > -0.5f || cone < -1.5f;
}
/* Depth where a picture has nothing at all: beyond the far end by the scene's diameter. */
LAO_FN float sdv_empty_depth(lao_v4 depth) {
    LAO_EXACT float z = depth.x + 2.0f * depth.z;
    return z;
}
/* Depth of a place of the world before the camera, mm. */
LAO_FN float sdv_depth_of(lao_m4 view, lao_v3 p) {
    lao_v3 q = lao_transform(view, p);
    return -q.z;
}
/* Depth before the camera, mm, of a depth buffer's value: the inverse of the projection to 0 .. 1;
   SDV_FAR where the buffer holds either end, so nothing. */
LAO_FN float sdv_drawn_depth(lao_m4 projection, float value) {
    LAO_EXACT float over = projection.w.z - value * projection.w.w;
    LAO_EXACT float under = projection.z.z - value * projection.z.w;
    LAO_EXACT float z = over / under;
    return value > 0.0f && value < 1.0f && lao_abs(z) < SDV_FAR ? z : SDV_FAR;
}
/* The place of the world at that depth of a pixel. */
LAO_FN lao_v3 sdv_depth_place(lao_m4 world, lao_v2 slope, float depth, float orthographic) {
    float s = orthographic > 0.5f ? 1.0f : depth;
    LAO_EXACT float x = slope.x * s;
    LAO_EXACT float y = slope.y * s;
    return lao_transform(world, lao_v3_make(x, y, -depth));
}
/* The linear part of a transformation. */
LAO_FN lao_v3 sdv_turned(lao_m4 m, lao_v3 v) {
    LAO_EXACT float x = m.x.x * v.x + m.y.x * v.y + m.z.x * v.z;
    LAO_EXACT float y = m.x.y * v.x + m.y.y * v.y + m.z.y * v.z;
    LAO_EXACT float z = m.x.z * v.x + m.y.z * v.y + m.z.z * v.z;
    return lao_v3_make(x, y, z);
}
/* A direction that only depends on the camera, unit: no branch, see sdv_apart. */
LAO_FN lao_v3 sdv_camera_unit(lao_v3 v) {
    LAO_EXACT float inverse = 1.0f / lao_sqrt(lao_max(lao_v3_dot(v, v), 1.0e-24f));
    return lao_v3_scale(v, inverse);
}
/* Unit vector to the light of field shadows: x to the right and y up per length towards the viewer.
   world: of lao_frame_uniforms. */
LAO_FN lao_v3 sdv_shadow_light(lao_m4 world, float x, float y) {
    return sdv_camera_unit(sdv_turned(world, lao_v3_make(x, y, 1.0f)));
}
/* mm across a pixel at that depth. */
LAO_FN float sdv_pixel_size(lao_v4 ray, float depth, float orthographic) {
    float apart = lao_abs(depth);
    LAO_EXACT float r = lao_abs(ray.y) * (orthographic > 0.5f ? 1.0f : apart);
    return r;
}
/* From pixel to pixel along an axis, on the side where depth changes less. */
LAO_FN lao_v3 sdv_sheet_step(lao_v3 before, lao_v3 p, lao_v3 after, float depth_before, float depth,
                             float depth_after) {
    LAO_EXACT float a = lao_abs(depth - depth_before);
    LAO_EXACT float b = lao_abs(depth_after - depth);
    if (b <= a) {
        return lao_v3_sub(after, p);
    }
    return lao_v3_sub(p, before);
}
/* Normal from two such steps, on the side of `towards` (unit). */
LAO_FN lao_v3 sdv_sheet_normal(lao_v3 dx, lao_v3 dy, lao_v3 towards) {
    lao_v3 zero = lao_v3_make(0.0f, 0.0f, 0.0f);
    lao_v3 n = lao_v3_unit(lao_v3_cross(lao_v3_unit(dx, zero), lao_v3_unit(dy, zero)), towards);
    if (lao_v3_dot(n, towards) < 0.0f) {
        return lao_v3_scale(n, -1.0f);
    }
    return n;
}

/* ---- guiding field: directions without a sign (L19 3.5 with METHODS 7.1) */
#define SDV_GUIDE_CONTOUR 0
#define SDV_GUIDE_OWN 1
#define SDV_CONTOUR_WEIGHT 0.2f /* w_f */
/* Gradient of depth over three rows of three pixels, bottom up: a step reads as its height, as part
   of the scene's diameter. */
LAO_FN lao_v2 sdv_sobel(lao_v3 below, lao_v3 at, lao_v3 above, float inverse_diameter) {
    LAO_EXACT float x = 0.25f * inverse_diameter *
                        ((below.z - below.x) + 2.0f * (at.z - at.x) + (above.z - above.x));
    LAO_EXACT float y = 0.25f * inverse_diameter *
                        ((above.x - below.x) + 2.0f * (above.y - below.y) + (above.z - below.z));
    return lao_v2_make(x, y);
}
/* z z^T of a direction of the screen (xx, xy, yy) and its weight. */
LAO_FN lao_v4 sdv_tensor(float x, float y, float weight) {
    LAO_EXACT float xx = x * x;
    LAO_EXACT float xy = x * y;
    LAO_EXACT float yy = y * y;
    return lao_v4_make(xx, xy, yy, weight);
}
/* Of a covered pixel with that depth gradient and normal (view space): the projected normal where
   the step is higher than the threshold, else nothing. */
LAO_FN lao_v4 sdv_contour_tensor(lao_v2 gradient, lao_v3 normal, float threshold) {
    LAO_EXACT float rise = lao_sqrt(lao_v2_dot(gradient, gradient));
    if (!(rise > threshold)) {
        return lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float across = lao_sqrt(normal.x * normal.x + normal.y * normal.y);
    if (across > 1.0e-6f) {
        return sdv_tensor(normal.x / across, normal.y / across, SDV_CONTOUR_WEIGHT);
    }
    return sdv_tensor(-gradient.x / rise, -gradient.y / rise, SDV_CONTOUR_WEIGHT);
}
/* Of a surface's own direction (view space): certain where it is seen from the side, nothing
 * end-on.
 */
LAO_FN lao_v4 sdv_axis_tensor(lao_v3 axis) {
    lao_v3 a = lao_v3_unit(axis, lao_v3_make(0.0f, 0.0f, 0.0f));
    LAO_EXACT float across2 = a.x * a.x + a.y * a.y;
    if (!(across2 > 1.0e-6f)) {
        return lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float across = lao_sqrt(across2);
    return sdv_tensor(a.x / across, a.y / across, across2);
}
/* First eigenvector (x >= 0), and 1; (0, 0) and 0 where no direction stands out. */
LAO_FN lao_v3 sdv_tensor_axis(lao_v4 g) {
    LAO_EXACT float difference = g.x - g.z;
    LAO_EXACT float twice = 2.0f * g.y;
    LAO_EXACT float spread = lao_sqrt(difference * difference + twice * twice);
    LAO_EXACT float trace = g.x + g.z;
    if (!(spread > 1.0e-6f * trace)) {
        return lao_v3_make(0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float c = difference / spread; /* of the double angle */
    LAO_EXACT float s = twice / spread;
    if (c >= 0.0f) {
        LAO_EXACT float x = lao_sqrt(0.5f + 0.5f * c);
        LAO_EXACT float y = 0.5f * s / x;
        return lao_v3_make(x, y, 1.0f);
    }
    LAO_EXACT float v = lao_sqrt(0.5f - 0.5f * c);
    LAO_EXACT float u = 0.5f * lao_abs(s) / v;
    return lao_v3_make(u, s < 0.0f ? -v : v, 1.0f);
}
/* What is left of v in the plane of normal n, unit; (0, 0, 0) where that is nothing. */
LAO_FN lao_v3 sdv_tangent(lao_v3 v, lao_v3 n) {
    lao_v3 rest = lao_v3_along(v, n, -lao_v3_dot(v, n));
    if (!(lao_v3_dot(rest, rest) > 1.0e-12f)) {
        return lao_v3_make(0.0f, 0.0f, 0.0f);
    }
    return lao_v3_unit(rest, lao_v3_make(0.0f, 0.0f, 0.0f));
}
/* A direction of the screen (of sdv_tensor_axis) in the tangent plane of normal n (METHODS 7.2);
   else `otherwise` there, else any. */
LAO_FN lao_v3 sdv_lift(lao_m4 world, lao_v3 axis, lao_v3 n, lao_v3 otherwise) {
    lao_v3 right = sdv_xyz(world.x);
    lao_v3 up = sdv_xyz(world.y);
    lao_v3 z = sdv_tangent(lao_v3_along(lao_v3_scale(right, axis.x), up, axis.y), n);
    if (!(lao_v3_dot(z, z) > 0.5f)) {
        z = sdv_tangent(otherwise, n);
    }
    if (!(lao_v3_dot(z, z) > 0.5f)) {
        z = sdv_tangent(right, n);
    }
    if (!(lao_v3_dot(z, z) > 0.5f)) {
        z = sdv_tangent(up, n);
    }
    return z;
}
/* 1 / |p - q|^2, at most that of `least` mm. */
LAO_FN float sdv_nearness(lao_v3 p, lao_v3 q, float least) {
    lao_v3 apart = lao_v3_sub(p, q);
    LAO_EXACT float least2 = lao_max(least * least, 1.0e-30f);
    LAO_EXACT float r = 1.0f / lao_max(lao_v3_dot(apart, apart), least2);
    return r;
}
/* The same between a pixel of a level and its parents: whatever lies no further than parents lie
   apart on the screen counts alike, so that the stencil alone rules on a smooth surface (its
   weights times 1 / |p - q|^2 of L19 would be blocks) and only what lies behind or in front counts
   less. pixel: mm across one of the finest level. */
LAO_FN float sdv_parent_nearness(lao_v3 p, lao_v3 q, float pixel, float level) {
    LAO_EXACT float least = 2.2f * pixel * lao_exp2(level);
    return sdv_nearness(p, q, least);
}

/* ---- parameterization: two phases of every pixel, radians (L19 3.6 with METHODS 7.3) */
/* Phase of a pixel as a neighbour predicts it (x) and how much that counts (y): z, z_other: their
   directions, of either sign; apart: from the neighbour to the pixel, mm; frequency: radians per
   mm. */
LAO_FN lao_v2 sdv_phase_from(lao_v3 z, lao_v3 z_other, float phase, lao_v3 apart, float frequency) {
    LAO_EXACT float alike = lao_v3_dot(z, z_other);
    float s = alike < 0.0f ? -1.0f : 1.0f;
    lao_v3 both = lao_v3_along(z, z_other, s);
    LAO_EXACT float predicted = s * phase + 0.5f * frequency * lao_v3_dot(both, apart);
    return lao_v2_make(predicted, lao_abs(alike));
}
/* The same phase in [-pi, pi]; untouched where it is there already. */
LAO_FN float sdv_phase_wrap(float phase) {
    if (lao_abs(phase) <= 3.14159265f) {
        return phase;
    }
    LAO_EXACT float turns = phase / LAO_TURN;
    LAO_EXACT float r = (turns - lao_floor(turns + 0.5f)) * LAO_TURN;
    return lao_min(lao_max(r, -3.14159265f), 3.14159265f);
}
/* What neighbours predict together: sums of (cos, sin) and of weights for u and for v. */
struct sdv_phases {
    lao_v4 sum;   /* cos, sin of u, of v */
    lao_v2 share; /* of u, of v */
};
#ifndef LAO_GLSL
typedef struct sdv_phases sdv_phases;
#endif
LAO_FN sdv_phases sdv_phases_start(lao_v4 zero) {
    sdv_phases s;
    s.sum = zero;
    s.share = lao_v2_make(0.0f, 0.0f);
    return s;
}
/* u, v: from sdv_phase_from; h: weight of the neighbour but for its direction. */
LAO_FN sdv_phases sdv_phases_add(sdv_phases s, lao_v2 u, lao_v2 v, float h) {
    sdv_phases r = s;
    LAO_EXACT float hu = h * u.y;
    LAO_EXACT float hv = h * v.y;
    LAO_EXACT float tu = u.x / LAO_TURN;
    LAO_EXACT float tv = v.x / LAO_TURN;
    LAO_EXACT float x = s.sum.x + hu * lao_cos_turns(tu);
    LAO_EXACT float y = s.sum.y + hu * lao_sin_turns(tu);
    LAO_EXACT float z = s.sum.z + hv * lao_cos_turns(tv);
    LAO_EXACT float w = s.sum.w + hv * lao_sin_turns(tv);
    r.sum = lao_v4_make(x, y, z, w);
    r.share = lao_v2_make(s.share.x + hu, s.share.y + hv);
    return r;
}
/* Whether the predictions leave anything when added up. */
LAO_FN bool sdv_phase_agrees(float c, float s, float share) {
    LAO_EXACT float size2 = c * c + s * s;
    LAO_EXACT float least = 1.0e-4f * share;
    return share > 0.0f && size2 > least * least;
}
/* (u, v) that the neighbours agree on; where they do not, what it was. */
LAO_FN lao_v2 sdv_phases_mean(sdv_phases s, lao_v2 otherwise) {
    lao_v2 r = otherwise;
    if (sdv_phase_agrees(s.sum.x, s.sum.y, s.share.x)) {
        r.x = lao_atan2(s.sum.y, s.sum.x);
    }
    if (sdv_phase_agrees(s.sum.z, s.sum.w, s.share.y)) {
        r.y = lao_atan2(s.sum.w, s.sum.z);
    }
    return r;
}
/* Weight of a neighbour: near ones and vessels count (L19 Eq. 10), void alone counts alike. */
LAO_FN float sdv_phase_weight(lao_v3 p, lao_v3 q, float covered, float stencil, float pixel) {
    LAO_EXACT float h = stencil * lao_max(covered, 1.0e-6f) * sdv_nearness(p, q, 0.001f * pixel);
    return h;
}
/* One neighbour's part: place and share of vessels (w), both directions, phases. */
LAO_FN sdv_phases sdv_phases_hear(sdv_phases s, lao_v3 p, lao_v3 along, lao_v3 across, lao_v4 q,
                                  lao_v3 along_other, lao_v3 across_other, lao_v2 phase,
                                  float stencil, float frequency, float pixel) {
    lao_v3 place = sdv_xyz(q);
    lao_v3 apart = lao_v3_sub(p, place);
    return sdv_phases_add(s, sdv_phase_from(along, along_other, phase.x, apart, frequency),
                          sdv_phase_from(across, across_other, phase.y, apart, frequency),
                          sdv_phase_weight(p, place, q.w, stencil, pixel));
}

/* ---- frame coherence (L19 3.7 with METHODS 7.4) */
/* Coarsest level that a frame renews: the setting, or (negative) the largest with 2^level <= 1/16
   period, at least 1. period: pixels. busy 0: a solution at rest only goes on, by level 0. */
LAO_FN float sdv_recycle_level(float setting, float period, float busy) {
    LAO_EXACT float rule = 1.0f;
    LAO_EXACT float next = 63.995f;
    for (lao_int i = 0; i < 14; i++) {
        rule = rule + (period >= next ? 1.0f : 0.0f);
        next = next * 2.0f;
    }
    float level = setting > -0.5f ? setting : rule;
    return busy > 0.0f ? level : 0.0f;
}
/* 0 where two cameras are the same. A sum, and no comparisons one by one: lavapipe makes a program
   for each value of a uniform that a branch asks for, which would be several a frame. */
LAO_FN float sdv_apart_column(lao_v4 a, lao_v4 b) {
    LAO_EXACT float r =
        lao_abs(a.x - b.x) + lao_abs(a.y - b.y) + lao_abs(a.z - b.z) + lao_abs(a.w - b.w);
    return r;
}
LAO_FN float sdv_apart(lao_m4 a, lao_m4 b) {
    LAO_EXACT float r = sdv_apart_column(a.x, b.x) + sdv_apart_column(a.y, b.y) +
                        sdv_apart_column(a.z, b.z) + sdv_apart_column(a.w, b.w);
    return r;
}
/* The pixel of an image that shows p, and 1; 0: none does. */
LAO_FN lao_v3 sdv_pixel_of(lao_m4 view, lao_m4 projection, lao_v3 p, float width, float height) {
    lao_v4 clip = lao_project(projection, lao_transform(view, p));
    if (!(clip.w > 1.0e-12f)) {
        return lao_v3_make(0.0f, 0.0f, 0.0f);
    }
    LAO_EXACT float x = lao_floor((clip.x / clip.w * 0.5f + 0.5f) * width);
    LAO_EXACT float y = lao_floor((clip.y / clip.w * 0.5f + 0.5f) * height);
    if (!(x >= 0.0f && y >= 0.0f && x < width && y < height)) {
        return lao_v3_make(0.0f, 0.0f, 0.0f);
    }
    return lao_v3_make(x, y, 1.0f);
}
/* Whether q, seen there in the last frame, is the surface at p with normal n: else it came into
   view. pixel: mm. */
LAO_FN bool sdv_same_surface(lao_v3 p, lao_v3 n, lao_v3 q, float pixel) {
    lao_v3 apart = lao_v3_sub(q, p);
    LAO_EXACT float off = lao_abs(lao_v3_dot(apart, n));
    LAO_EXACT float most = 64.0f * pixel * pixel;
    return off <= 2.0f * pixel && lao_v3_dot(apart, apart) <= most;
}
/* What the surface image says of a covered pixel (negative: of the void): the period, which a set
   of the frame tells from other sets by a power of two. */
LAO_FN float sdv_surface_mark(float period, float set) {
    LAO_EXACT float r = period * lao_exp2(12.0f * set);
    return r;
}
/* A guide of the screen as the last frame's camera saw it, in the world; for its sign only. */
LAO_FN lao_v3 sdv_guide_world(lao_m4 view, float x, float y) {
    lao_v3 right = lao_v3_make(view.x.x, view.y.x, view.z.x);
    lao_v3 up = lao_v3_make(view.x.y, view.y.y, view.z.y);
    return lao_v3_along(lao_v3_scale(right, x), up, y);
}
/* The guide on the screen, unit: the axis of sdv_tensor_axis, else the lifted direction as it is
 * seen. */
LAO_FN lao_v2 sdv_guide_screen(lao_m4 view, lao_v3 axis, lao_v3 along) {
    if (axis.z > 0.5f) {
        return lao_v2_make(axis.x, axis.y);
    }
    lao_v3 seen = sdv_turned(view, along);
    lao_v3 unit = lao_v3_unit(lao_v3_make(seen.x, seen.y, 0.0f), lao_v3_make(1.0f, 0.0f, 0.0f));
    return lao_v2_make(unit.x, unit.y);
}
/* The last frame's (u, v) at q as (u, v) at p: `before` is its guide in the world. Turned by its
   sign, and moved along by what lies between. */
LAO_FN lao_v2 sdv_phase_recall(lao_v3 along, lao_v3 across, lao_v3 before, lao_v2 phase,
                               lao_v3 apart, float frequency) {
    float s = lao_v3_dot(along, before) < 0.0f ? -1.0f : 1.0f;
    LAO_EXACT float u = s * phase.x + frequency * lao_v3_dot(along, apart);
    LAO_EXACT float v = s * phase.y + frequency * lao_v3_dot(across, apart);
    return lao_v2_make(sdv_phase_wrap(u), sdv_phase_wrap(v));
}
/* now, before: of the surface image. A pixel that has not changed, seen by a camera that has not
   moved, keeps its phases. */
LAO_FN bool sdv_phase_stays(lao_v4 now, lao_v4 before) {
    return now.w == before.w &&
           (now.w < 0.0f || (now.x == before.x && now.y == before.y && now.z == before.z));
}

/* ---- illustration by (u, v): ink of a pixel, 0 .. 1, whose mean is the darkness (METHODS 7.5) */
#define SDV_STYLE_PLAIN 0
#define SDV_STYLE_STIPPLE 1
#define SDV_STYLE_HATCH 2
#define SDV_STYLE_CROSSHATCH 3
#define SDV_STYLE_LAYERED 4
#define SDV_STYLE_SHADOW 5 /* shaded, depth shadows hatched */
#define SDV_STYLE_PATTERN 6
#define SDV_VOID_PLAIN 0
#define SDV_VOID_CHROMADEPTH 1
#define SDV_VOID_STIPPLE 2
#define SDV_VOID_HATCH 3
/* Periods per pixel along the tangent z of a surface of normal n; right, up, direction: axes of the
   screen and the view ray, unit. */
LAO_FN float sdv_style_footprint(lao_v3 z, lao_v3 n, lao_v3 right, lao_v3 up, lao_v3 direction,
                                 float pixel, float period) {
    LAO_EXACT float facing = lao_min(lao_v3_dot(direction, n), -0.05f);
    LAO_EXACT float slope = lao_v3_dot(z, direction) / facing;
    LAO_EXACT float x = lao_v3_dot(z, right) - slope * lao_v3_dot(n, right);
    LAO_EXACT float y = lao_v3_dot(z, up) - slope * lao_v3_dot(n, up);
    LAO_EXACT float r = pixel * lao_sqrt(x * x + y * y) / period;
    return r;
}
/* Ink from 0 to x of lines at the whole numbers, as wide as `dark`. */
LAO_FN float sdv_lines_until(float x, float dark) {
    LAO_EXACT float n = lao_floor(x + 0.5f);
    LAO_EXACT float r = dark * n + lao_min(lao_max(x - n, -0.5f * dark), 0.5f * dark);
    return r;
}
/* The mean of the lines over a pixel `wide` periods wide: exact, so that thin lines keep their
 * tone. */
LAO_FN float sdv_lines_ink(float x, float dark, float wide) {
    LAO_EXACT float w = lao_max(wide, 1.0e-3f);
    LAO_EXACT float r =
        (sdv_lines_until(x + 0.5f * w, dark) - sdv_lines_until(x - 0.5f * w, dark)) / w;
    return lao_clamp01(r);
}
/* On thin vessels strokes and dots are finer: as many times as a period is longer than the vessel
   is wide, or than so many pixels. 1: as they are. radius, period, pixel: mm. */
#define SDV_INK_LEAST_PIXELS 5.0f
LAO_FN float sdv_ink_finer(float radius, float period, float pixel) {
    LAO_EXACT float room = lao_max(1.5f * radius, SDV_INK_LEAST_PIXELS * pixel);
    LAO_EXACT float r = lao_min(lao_max(period / room, 1.0f), 32.0f);
    return r;
}
/* How many cells of the finest lattice that is whole lie along a period (x: 1, 2, 4, ...), and how
   far strokes and dots between its own have grown (y, 0 .. 1). */
LAO_FN lao_v2 sdv_ink_lattice(float finer) {
    float cells = 1.0f;
    for (lao_int i = 0; i < 5; i++) {
        cells = finer >= 2.0f * cells ? 2.0f * cells : cells;
    }
    LAO_EXACT float grown = finer / cells - 1.0f;
    return lao_v2_make(cells, lao_max(grown, 0.0f));
}
/* How far from the middle of its cell a place is, 0 .. 1/2, where cells are `times` as fine. */
LAO_FN float sdv_finer_cell(float a, float times) {
    LAO_EXACT float x = lao_abs(a) * times;
    LAO_EXACT float r = lao_abs(x - lao_floor(x + 0.5f));
    return r;
}
/* Lines and, between them, those that grow while they thin: the mean stays `dark`. x: 0 .. 1/2. */
LAO_FN float sdv_growing_lines(float x, float dark, float wide, float grown) {
    LAO_EXACT float between = 0.5f * grown * dark;
    float ink = sdv_lines_ink(x, dark - between, wide);
    if (grown > 0.0f) {
        LAO_EXACT float both = ink + sdv_lines_ink(0.5f - x, between, wide);
        ink = lao_clamp01(both);
    }
    return ink;
}
/* A disc in the middle of a cell; its soft edge and what is smaller than a pixel keep their area.
   dark <= pi / 4. */
LAO_FN float sdv_dot_ink(float a, float b, float dark, float wide_a, float wide_b) {
    LAO_EXACT float r = lao_sqrt(a * a + b * b);
    LAO_EXACT float wa = a * wide_a;
    LAO_EXACT float wb = b * wide_b;
    LAO_EXACT float mean = 0.5f * (wide_a + wide_b);
    LAO_EXACT float w = lao_max(r > 1.0e-3f ? lao_sqrt(wa * wa + wb * wb) / r : mean, 1.0e-3f);
    LAO_EXACT float squared = 0.318309886f * dark - 0.0833333333f * w * w;
    LAO_EXACT float least = 0.25f * w * w;
    LAO_EXACT float radius = lao_sqrt(lao_max(squared, least));
    LAO_EXACT float share = lao_min(dark / (1.04719755f * w * w), 1.0f);
    LAO_EXACT float ink = lao_clamp01(0.5f + (radius - r) / w) * (squared < least ? share : 1.0f);
    return ink;
}
/* Dots and, between them, three times as many that grow to their size while they shrink; dark <=
   1/2, so that none touch. Cells that are too small to be seen turn grey. */
LAO_FN float sdv_growing_dots(float a, float b, float dark, float wide_a, float wide_b,
                              float grown) {
    LAO_EXACT float own = dark - 0.75f * grown * dark;
    float ink = sdv_dot_ink(a, b, own, wide_a, wide_b);
    if (grown > 0.0f && (a > 0.25f || b > 0.25f)) {
        LAO_EXACT float both = ink + sdv_dot_ink(sdv_finer_cell(a, 2.0f), sdv_finer_cell(b, 2.0f),
                                                 grown * dark, 2.0f * wide_a, 2.0f * wide_b);
        ink = lao_clamp01(both);
    }
    LAO_EXACT float blur = lao_clamp01(2.5f * (wide_a + wide_b) * (1.0f + grown) - 0.75f);
    LAO_EXACT float r = ink + blur * (dark - ink);
    return r;
}
/* Dots; above a half white ones, around the corners of cells. a, b: 0 .. 1/2. */
LAO_FN float sdv_stipple_ink(float a, float b, float dark, float wide_a, float wide_b,
                             float grown) {
    if (dark <= 0.5f) {
        return sdv_growing_dots(a, b, dark, wide_a, wide_b, grown);
    }
    LAO_EXACT float r =
        1.0f - sdv_growing_dots(0.5f - a, 0.5f - b, 1.0f - dark, wide_a, wide_b, grown);
    return r;
}
LAO_FN float sdv_crosshatch_ink(float a, float b, float dark, float wide_a, float wide_b,
                                float grown) {
    LAO_EXACT float each = 1.0f - lao_sqrt(lao_max(1.0f - dark, 0.0f));
    LAO_EXACT float r = 1.0f - (1.0f - sdv_growing_lines(a, each, wide_a, grown)) *
                                   (1.0f - sdv_growing_lines(b, each, wide_b, grown));
    return r;
}
/* u, v: radians; even in both, as (-u, -v) is the same place seen along the other direction.
   wide_u, wide_v: periods per pixel; finer: see sdv_ink_finer. */
LAO_FN float sdv_style_ink(lao_int style, float u, float v, float darkness, float wide_u,
                           float wide_v, float finer) {
    lao_v2 lattice = sdv_ink_lattice(finer);
    float a = sdv_finer_cell(u / LAO_TURN, lattice.x);
    float b = sdv_finer_cell(v / LAO_TURN, lattice.x);
    LAO_EXACT float wide_a = wide_u * lattice.x;
    LAO_EXACT float wide_b = wide_v * lattice.x;
    float dark = lao_clamp01(darkness);
    if (style == SDV_STYLE_STIPPLE || (style == SDV_STYLE_LAYERED && dark < 0.35f)) {
        return sdv_stipple_ink(a, b, dark, wide_a, wide_b, lattice.y);
    }
    if (style == SDV_STYLE_CROSSHATCH || (style == SDV_STYLE_LAYERED && dark > 0.7f)) {
        return sdv_crosshatch_ink(a, b, dark, wide_a, wide_b, lattice.y);
    }
    return sdv_growing_lines(b, dark, wide_b, lattice.y);
}
/* Sample i of SDV_PATTERN_SAMPLES^2 over a pixel at (a, b), periods: which of n x n thresholds
   holds there. The pattern lies in half a period and is mirrored, as (u, v) and (-u, -v) are one
   place. */
#define SDV_PATTERN_SAMPLES 4
LAO_FN lao_int sdv_pattern_axis(float a, float wide, lao_int i, lao_int n) {
    LAO_EXACT float x = a + wide * ((LAO_F(i) + 0.5f) / LAO_F(SDV_PATTERN_SAMPLES) - 0.5f);
    LAO_EXACT float off = lao_abs(x - lao_floor(x + 0.5f)) * 2.0f * LAO_F(n);
    return LAO_I(lao_min(off, LAO_F(n) - 0.5f));
}
LAO_FN lao_int sdv_pattern_at(lao_v2 phase, float wide_u, float wide_v, lao_int i, lao_int n) {
    LAO_EXACT float a = phase.x / LAO_TURN;
    LAO_EXACT float b = phase.y / LAO_TURN;
    return sdv_pattern_axis(b, wide_v, i / SDV_PATTERN_SAMPLES, n) * n +
           sdv_pattern_axis(a, wide_u, i % SDV_PATTERN_SAMPLES, n);
}
/* inked: of the samples; what is too small for a pixel keeps its tone. */
LAO_FN float sdv_pattern_ink(float inked, float dark, float wide_u, float wide_v) {
    LAO_EXACT float share = inked / LAO_F(SDV_PATTERN_SAMPLES * SDV_PATTERN_SAMPLES);
    LAO_EXACT float blur = lao_clamp01(2.5f * (wide_u + wide_v) - 0.75f);
    LAO_EXACT float r = share + blur * (dark - share);
    return r;
}
/* White that a style's ink and a depth shadow's lines, which go the other way, leave of a pixel.
   pattern: ink of SDV_STYLE_PATTERN. */
LAO_FN float sdv_style_paper(lao_int style, lao_v2 phase, float darkness, float shadow,
                             float wide_u, float wide_v, float finer, float pattern) {
    LAO_EXACT float lines = sdv_lines_ink(phase.x / LAO_TURN, lao_clamp01(shadow), wide_u);
    LAO_EXACT float left = 1.0f - lines;
    if (style == SDV_STYLE_PLAIN || style == SDV_STYLE_SHADOW) {
        return left;
    }
    float ink = pattern;
    if (style != SDV_STYLE_PATTERN) {
        ink = sdv_style_ink(style, phase.x, phase.y, darkness, wide_u, wide_v, finer);
    }
    LAO_EXACT float r = left * (1.0f - ink);
    return r;
}
/* Births and deaths of strokes and dots (which L19 5 leaves open). A place shows what its phases
   say, and a rest of what it showed before these changed; each frame lessens the rest by `step` of
   it. before: white by the recalled phases and the last frame's rest; now: by the new phases. As
   both move with the surface, only what a solution changed fades. */
LAO_FN float sdv_ink_rest(float before, float now, float step) {
    LAO_EXACT float r = (lao_clamp01(before) - now) * (1.0f - step);
    return lao_abs(r) < 0.004f ? 0.0f : r; /* below what a display shows */
}
/* What a head light leaves of white, without a highlight. */
LAO_FN float sdv_style_tone(float facing, float ambient, float diffuse, float light) {
    LAO_EXACT float r = (ambient + diffuse * lao_max(facing, 0.0f)) * light;
    return lao_clamp01(r);
}
/* What the void keeps of its ink where the ray passes a vessel at d_min mm: all beside it, nothing
   from `reach` mm on (0: no end, without a branch: see sdv_apart), and nothing where it is so steep
   that strokes would be grey. wide: periods per pixel. */
LAO_FN float sdv_void_share(float d_min, float reach, float wide) {
    LAO_EXACT float endless = lao_clamp01(1.0f - 1.0e6f * reach);
    LAO_EXACT float off = lao_max(d_min, 0.0f) / lao_max(reach, 1.0e-6f);
    LAO_EXACT float part = lao_clamp01(lao_max(1.0f - off, endless));
    LAO_EXACT float seen = lao_clamp01(2.0f - 2.0f * wide / SDV_HALO_FOOTPRINT);
    LAO_EXACT float r = seen * part * part * (3.0f - 2.0f * part);
    return r;
}
/* Red near, blue far (METHODS 6.1, RSH06). */
LAO_FN lao_v3 sdv_chromadepth(float depth) {
    float d = lao_clamp01(depth);
    return lao_v3_make(1.0f - d, 0.0f, d);
}
/* SDV_SHARED_END */

#endif /* SDFVESSEL_H */
