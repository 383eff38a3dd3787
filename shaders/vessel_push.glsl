/* Pull-push of a host's image, beside vessel_pull: what it brings, its levels from coarse to fine, what it gets (L19 3.3;
   METHODS 6). The step of sdv_pull_push for three channels. */
LAO_TEX(0, sampler2D, own)
LAO_TEX(1, sampler2D, parents)
LAO_CONSTANT(0, lao_constant_variant) /* 0: from the parents; 1: the top, which has none; 2: a copy of what has a weight */
LAO_CONSTANT(1, lao_constant_push)
LAO_CONSTANT(2, lao_constant_exponent)

LAO_OUT(0, vec4, out_pushed) /* values; weight */

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 t = texelFetch(own, pixel, 0);
    if (!(t.w > 0.0)) {
        t = vec4(0.0);
    }
    out_pushed = t;
    if (lao_constant_variant == 1) {
        out_pushed.w = t.w > 0.0 ? 1.0 : 0.0;
    } else if (lao_constant_variant == 0) {
        ivec2 size = (ivec2(lao_step.size.xy) + 1) / 2;
        sdv_mix m = sdv_mix_start(vec4(0.0));
        for (int i = 0; i < 4; i++) {
            ivec2 parent = ivec2(sdv_push_parent(pixel.x, i & 1), sdv_push_parent(pixel.y, i >> 1));
            if (parent.x >= 0 && parent.y >= 0 && parent.x < size.x && parent.y < size.y) {
                vec4 p = texelFetch(parents, parent, 0);
                m = sdv_mix_add(m, vec4(p.xyz, 0.0), p.w,
                                sdv_push_share(lao_constant_push, i & 1) * sdv_push_share(lao_constant_push, i >> 1));
            }
        }
        float kept = sdv_push_own(t.w, lao_constant_exponent);
        out_pushed = vec4(sdv_push_value(m, vec4(t.xyz, 0.0), kept).xyz, sdv_push_weight(m, kept));
    }
}
#endif
