/* A surface that the host drew, from what it brings of it: places from a depth buffer, normals from places, and white
   (L19 3.4; METHODS 6.1). */
LAO_TEX(0, sampler2D, drawn) /* depth; with variants 1 and 2 places */
LAO_CONSTANT(0, lao_constant_variant) /* makes 0: places, 1: normals, 2: colours */

LAO_OUT(0, vec4, out_made) /* as vessel_mesh does; 0 beside normals: nothing is known of near misses */

#ifdef LAO_FRAGMENT
/* From a pixel to the next along an axis, of what is covered. */
lao_v3 along(ivec2 pixel, ivec2 axis, lao_v3 p) {
    ivec2 size = ivec2(lao_step.size.xy);
    ivec2 before = pixel - axis;
    ivec2 after = pixel + axis;
    vec4 b = vec4(0.0, 0.0, 0.0, -1.0);
    vec4 a = b;
    if (before.x >= 0 && before.y >= 0) {
        b = texelFetch(drawn, before, 0);
    }
    if (after.x < size.x && after.y < size.y) {
        a = texelFetch(drawn, after, 0);
    }
    float zb = SDV_FAR;
    float za = SDV_FAR;
    lao_v3 pb = p;
    lao_v3 pa = p;
    if (sdv_is_covered(b.w)) {
        pb = b.xyz;
        zb = sdv_depth_of(lao_frame.view, pb);
    }
    if (sdv_is_covered(a.w)) {
        pa = a.xyz;
        za = sdv_depth_of(lao_frame.view, pa);
    }
    return sdv_sheet_step(pb, p, pa, zb, sdv_depth_of(lao_frame.view, p), za);
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    vec4 own = texelFetch(drawn, pixel, 0);
    out_made = vec4(1.0);
    if (lao_constant_variant == 0) {
        float z = sdv_drawn_depth(lao_frame.projection, own.x);
        out_made = vec4(0.0, 0.0, 0.0, -1.0);
        if (z < SDV_FAR) {
            out_made = vec4(sdv_depth_place(lao_frame.world, slope, z, lao_frame.depth.w), 0.0);
        }
    } else if (lao_constant_variant == 1) {
        out_made = vec4(0.0);
        if (sdv_is_covered(own.w)) {
            lao_v3 p = own.xyz;
            lao_v3 towards = lao_v3_scale(lao_ray_direction(lao_frame.world, slope, lao_frame.depth.w), -1.0);
            out_made = vec4(sdv_sheet_normal(along(pixel, ivec2(1, 0), p), along(pixel, ivec2(0, 1), p), towards), 0.0);
        }
    }
}
#endif
