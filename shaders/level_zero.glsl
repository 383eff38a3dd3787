/* Level 0 of the occlusion pyramid from the G-buffer (METHODS 1.10, 2.3): what a sample reads, and the sums above it. */
LAO_TEX(0, sampler2D, color)
LAO_TEX(1, sampler2D, tangent)
LAO_TEX(2, sampler2D, depth)
LAO_CONSTANT(0, lao_constant_align)

LAO_OUT(0, vec4, out_tensor) /* two numbers of the direction, covered texels of level 0, depth */
LAO_OUT(1, vec4, out_depth)
LAO_OUT(2, vec4, out_axial)
LAO_OUT(3, vec4, out_tangent)

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    if (texelFetch(color, pixel, 0).w < 0.5) {
        out_tensor = vec4(0.0, 0.0, 0.0, 1.0);
        out_depth = lao_depth_pack(1.0, 0.0);
        out_axial = lao_axial_pack(0.0, 0.0);
        out_tangent = vec4(0.5);
        return;
    }
    lao_v3 t = texelFetch(tangent, pixel, 0).xyz;
    float d = texelFetch(depth, pixel, 0).x;
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    lao_v2 direction = lao_v2_make(0.0, 0.0);
    if (lao_constant_align != LAO_ALIGN_NONE) {
        direction = lao_screen_axial(t, slope, lao_frame.scale, lao_frame.depth.w);
    }
    if (lao_constant_align == LAO_ALIGN_PAPER) {
        direction = lao_axial_alpha(direction);
    }
    out_tensor = vec4(direction, 1.0, d);
    out_depth = lao_depth_pack(d, 1.0);
    out_axial = lao_axial_pack(direction.x, direction.y);
    out_tangent = vec4(lao_signed_pack(t), 1.0);
}
#endif
