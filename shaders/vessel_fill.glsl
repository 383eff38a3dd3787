/* Depth from coarse to fine: what has no weight of its own takes over its parents' (L19 Eqs. 6 - 9; METHODS 6, 6.1). */
LAO_TEX(0, sampler2D, own)
LAO_TEX(1, sampler2D, parents)
LAO_CONSTANT(0, lao_constant_variant) /* 1: the top, which has no parents */
LAO_CONSTANT(1, lao_constant_void_exponent)

LAO_OUT(0, vec4, out_filled) /* depth, mm; nothing; 1: the whole picture is empty; weight */

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 t = texelFetch(own, pixel, 0);
    if (lao_constant_variant == 1) {
        out_filled = vec4(t.xy, 0.0, 1.0);
        if (!(t.w > 0.0)) {
            out_filled = vec4(sdv_empty_depth(lao_frame.depth), 0.0, 1.0, 1.0);
        }
        return;
    }
    ivec2 size = (ivec2(lao_step.size.xy) + 1) / 2;
    sdv_mix m = sdv_mix_start(vec4(0.0));
    for (int i = 0; i < 4; i++) {
        ivec2 parent = ivec2(sdv_push_parent(pixel.x, i & 1), sdv_push_parent(pixel.y, i >> 1));
        if (parent.x >= 0 && parent.y >= 0 && parent.x < size.x && parent.y < size.y) {
            vec4 p = texelFetch(parents, parent, 0);
            m = sdv_mix_add(m, vec4(p.xyz, 0.0), p.w, sdv_push_share(1, i & 1) * sdv_push_share(1, i >> 1));
        }
    }
    float kept = sdv_push_own(t.w, lao_constant_void_exponent);
    out_filled = vec4(sdv_push_value(m, vec4(t.xyz, 0.0), kept).xyz, sdv_push_weight(m, kept));
}
#endif
