/* What level_one and level_up share: a coarser texel from those below, of which LAO_BELOW(column, row, inverse) fetches one. */
LAO_TEX(1, sampler2D, level_tangent)
LAO_CONSTANT(0, lao_constant_align)
LAO_CONSTANT(1, lao_constant_pyramid)
LAO_CONSTANT(2, lao_constant_light)

LAO_OUT(0, vec4, out_tensor) /* two numbers of the direction, covered texels of level 0, depth */
LAO_OUT(1, uint, out_level)
LAO_OUT(2, vec4, out_tangent)

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    lao_level_sum sum = lao_level_sum_start(lao_v3_make(0.0, 0.0, 0.0));
    vec2 inverse = 1.0 / lao_step.source.xy;
    int first = lao_constant_pyramid == LAO_PYRAMID_BOX ? 0 : -1;
    int last = lao_constant_pyramid == LAO_PYRAMID_BOX ? 1 : 2;
    for (int j = first; j <= last; j++) {
        for (int i = first; i <= last; i++) {
            ivec2 at = pixel * 2 + ivec2(i, j);
            if (at.x < 0 || at.y < 0 || at.x >= int(lao_step.source.x) || at.y >= int(lao_step.source.y)) {
                continue;
            }
            lao_v4 child = LAO_BELOW(float(at.x), float(at.y), inverse);
            lao_v3 t = lao_v3_make(0.0, 0.0, 0.0);
            if (lao_constant_light == LAO_LIGHT_AUTHOR) {
                t = lao_signed_unpack(texelFetch(level_tangent, at, 0));
            }
            float stencil = lao_constant_pyramid == LAO_PYRAMID_BOX ? 0.25 : lao_gauss_weight(i) * lao_gauss_weight(j);
            sum = lao_level_sum_add(sum, child, t, stencil);
        }
    }
    lao_v4 mean = lao_level_sum_mean(sum);
    out_tensor = mean;
    out_level = lao_level_word(mean, lao_constant_align);
    out_tangent = vec4(lao_signed_pack(lao_v3_unit(sum.tangent, lao_v3_make(0.0, 0.0, 0.0))), 1.0);
}
#endif
