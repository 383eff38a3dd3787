/* A place and a normal for every pixel, vessel or void, and the guiding field's contours (L19 3.4, 3.5; METHODS 6.1, 7.1). */
LAO_TEX(0, sampler2D, filled)
LAO_TEX(1, sampler2D, depth)
LAO_TEX(2, sampler2D, position)
LAO_TEX(3, sampler2D, normal)
LAO_TEX(4, samplerBuffer, cones)
LAO_TEX(5, sampler2D, direction) /* with variant 1 */
LAO_CONSTANT(0, lao_constant_guide)
LAO_CONSTANT(1, lao_constant_variant) /* 1: not a tree's surface */

LAO_OUT(0, vec4, out_surface) /* world, mm; sdv_surface_mark, 0 in an empty picture */
LAO_OUT(1, vec4, out_normal)  /* world, towards the viewer; cone, as traced */
LAO_OUT(2, vec4, out_place)   /* as out_surface; covered: 1 */
LAO_OUT(3, vec4, out_facing)  /* the normal */
LAO_OUT(4, vec4, out_tensor)  /* xx, xy, yy; weight */

#ifdef LAO_FRAGMENT
lao_v3 place(ivec2 pixel, float z) {
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    return sdv_depth_place(lao_frame.world, slope, z, lao_frame.depth.w);
}
/* From a pixel to the next along an axis. */
lao_v3 along(ivec2 pixel, ivec2 axis, lao_v3 p, float z) {
    ivec2 size = ivec2(lao_step.size.xy);
    ivec2 before = pixel - axis;
    ivec2 after = pixel + axis;
    float zb = before.x < 0 || before.y < 0 ? SDV_FAR : texelFetch(filled, before, 0).x;
    float za = after.x >= size.x || after.y >= size.y ? SDV_FAR : texelFetch(filled, after, 0).x;
    lao_v3 pb = zb < SDV_FAR ? place(before, zb) : p;
    lao_v3 pa = za < SDV_FAR ? place(after, za) : p;
    return sdv_sheet_step(pb, p, pa, zb, z, za);
}
float depth_at(int x, int y) {
    ivec2 last = ivec2(lao_step.size.xy) - 1;
    vec4 d = texelFetch(depth, ivec2(clamp(x, 0, last.x), clamp(y, 0, last.y)), 0);
    return d.y > 0.5 ? d.x : sdv_empty_depth(lao_frame.depth);
}
lao_v3 depths(int x, int y) {
    return lao_v3_make(depth_at(x - 1, y), depth_at(x, y), depth_at(x + 1, y));
}
vec4 guide(ivec2 pixel, vec4 hit, lao_v3 n) {
    if (!sdv_is_covered(hit.w)) {
        return vec4(0.0);
    }
    if (lao_constant_guide == SDV_GUIDE_OWN && lao_constant_variant == 1) {
        vec4 own = texelFetch(direction, pixel, 0);
        vec4 t = sdv_axis_tensor(sdv_turned(lao_frame.view, own.xyz));
        return vec4(t.xyz, t.w * own.w);
    }
    if (lao_constant_guide == SDV_GUIDE_OWN) {
        if (hit.w < 0.0) {
            return vec4(0.0);
        }
        int at = 2 * int(hit.w);
        lao_v3 axis = lao_v3_sub(texelFetch(cones, at + 1).xyz, texelFetch(cones, at).xyz);
        return sdv_axis_tensor(sdv_turned(lao_frame.view, axis));
    }
    lao_v2 gradient = sdv_sobel(depths(pixel.x, pixel.y - 1), depths(pixel.x, pixel.y), depths(pixel.x, pixel.y + 1),
                                lao_frame.depth.y);
    return sdv_contour_tensor(gradient, sdv_turned(lao_frame.view, n), lao_setting_guide_threshold);
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 hit = texelFetch(position, pixel, 0);
    vec4 z = texelFetch(filled, pixel, 0);
    lao_v3 p = hit.xyz;
    lao_v3 n = texelFetch(normal, pixel, 0).xyz;
    float mark = sdv_surface_mark(lao_setting_ssp_period, lao_step.source.z);
    float covered = 1.0;
    if (!sdv_is_covered(hit.w)) {
        lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
        p = place(pixel, z.x);
        n = sdv_sheet_normal(along(pixel, ivec2(1, 0), p, z.x), along(pixel, ivec2(0, 1), p, z.x),
                             lao_v3_scale(lao_ray_direction(lao_frame.world, slope, lao_frame.depth.w), -1.0));
        mark = z.z > 0.5 ? 0.0 : -mark;
        covered = 0.0;
    }
    out_surface = vec4(p, mark);
    out_normal = vec4(n, hit.w);
    out_place = vec4(p, covered);
    out_facing = vec4(n, 0.0);
    out_tensor = guide(pixel, hit, n);
}
#endif
