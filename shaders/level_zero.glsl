/* Level 0 of the occlusion pyramid from the G-buffer (METHODS 1.10, 2.3): what a sample reads. Background stays as cleared. */
LAO_TEX(0, sampler2D, color)
LAO_TEX(1, sampler2D, tangent)
LAO_TEX(2, sampler2D, depth)
LAO_CONSTANT(0, lao_constant_align)

LAO_OUT(0, uint, out_level)
LAO_OUT(1, vec4, out_tangent)

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    out_level = 0u;
    out_tangent = vec4(0.5);
    if (texelFetch(color, pixel, 0).w < 0.5) {
        return;
    }
    lao_v3 t = texelFetch(tangent, pixel, 0).xyz;
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    lao_v2 direction = lao_v2_make(0.0, 0.0);
    if (lao_constant_align != LAO_ALIGN_NONE) {
        direction = lao_screen_axial(t, slope, lao_frame.scale, lao_frame.depth.w);
    }
    if (lao_constant_align == LAO_ALIGN_PAPER) {
        direction = lao_axial_alpha(direction);
    }
    out_level = lao_level_pack(texelFetch(depth, pixel, 0).x, direction, lao_constant_align);
    out_tangent = vec4(lao_signed_pack(t), 1.0);
}
#endif
