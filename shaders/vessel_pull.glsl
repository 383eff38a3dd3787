/* One coarser level of a pyramid: the weighted mean of three channels (L19 Eqs. 4, 5; METHODS 6). */
LAO_TEX(0, sampler2D, fine)
LAO_CONSTANT(0, lao_constant_variant) /* SDV_PULL_... */

LAO_OUT(0, vec4, out_coarse) /* values; weight */

#ifdef LAO_FRAGMENT
void main() {
    ivec2 size = ivec2(lao_step.source.xy);
    sdv_mix m = sdv_mix_start(vec4(0.0));
    for (int i = 0; i < 4; i++) {
        ivec2 child = LAO_PIXEL * 2 + ivec2(i & 1, i >> 1);
        if (child.x < size.x && child.y < size.y) {
            vec4 t = texelFetch(fine, child, 0);
            m = sdv_mix_add(m, vec4(t.xyz, 0.0), t.w, sdv_pull_share(lao_constant_variant));
        }
    }
    out_coarse = vec4(sdv_mix_value(m).xyz, m.weight);
}
#endif
