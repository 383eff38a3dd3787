/* One coarser level: averages of the covered texels below, weighted by how much of level 0 each covers (METHODS 1.10). */
LAO_TEX(0, sampler2D, tensor)
LAO_TEX(1, sampler2D, level_tangent)
LAO_CONSTANT(0, lao_constant_align)
LAO_CONSTANT(1, lao_constant_pyramid)
LAO_CONSTANT(2, lao_constant_light)

LAO_OUT(0, vec4, out_tensor)
LAO_OUT(1, vec4, out_depth)
LAO_OUT(2, vec4, out_axial)
LAO_OUT(3, vec4, out_tangent)

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    lao_level_sum sum = lao_level_sum_start(lao_v3_make(0.0, 0.0, 0.0));
    int first = lao_constant_pyramid == LAO_PYRAMID_BOX ? 0 : -1;
    int last = lao_constant_pyramid == LAO_PYRAMID_BOX ? 1 : 2;
    for (int j = first; j <= last; j++) {
        for (int i = first; i <= last; i++) {
            ivec2 child = pixel * 2 + ivec2(i, j);
            if (child.x < 0 || child.y < 0 || child.x >= int(lao_step.source.x) || child.y >= int(lao_step.source.y)) {
                continue;
            }
            lao_v3 t = lao_v3_make(0.0, 0.0, 0.0);
            if (lao_constant_light == LAO_LIGHT_AUTHOR) {
                t = lao_signed_unpack(texelFetch(level_tangent, child, 0));
            }
            float stencil = lao_constant_pyramid == LAO_PYRAMID_BOX ? 0.25 : lao_gauss_weight(i) * lao_gauss_weight(j);
            sum = lao_level_sum_add(sum, texelFetch(tensor, child, 0), t, stencil);
        }
    }
    lao_v4 mean = lao_level_sum_mean(sum);
    out_tensor = mean;
    out_depth = lao_depth_pack(mean.w, mean.z > 0.0 ? 1.0 : 0.0);
    lao_v2 direction = lao_v2_make(mean.x, mean.y);
    if (lao_constant_align == LAO_ALIGN_ROTATION) {
        direction = lao_axial_unit(direction);
    }
    if (lao_constant_align == LAO_ALIGN_PAPER) {
        direction = lao_alpha_mean(direction);
    }
    out_axial = lao_axial_pack(direction.x, direction.y);
    out_tangent = vec4(lao_signed_pack(lao_v3_unit(sum.tangent, lao_v3_make(0.0, 0.0, 0.0))), 1.0);
}
#endif
