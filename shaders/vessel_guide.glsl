/* The guiding field from coarse to fine: contours' directions go where there are none, near ones first; then into the
   tangent plane (L19 3.5; METHODS 7.1, 7.2). */
LAO_TEX(0, sampler2D, tensor)
LAO_TEX(1, sampler2D, place)
LAO_TEX(2, sampler2D, facing)
LAO_TEX(3, sampler2D, spread) /* of the coarser level, as what follows */
LAO_TEX(4, sampler2D, parent_place)
LAO_TEX(5, sampler2D, parent_along)
LAO_CONSTANT(0, lao_constant_variant) /* 1: the top, which has no parents */

LAO_OUT(0, vec4, out_spread) /* xx, xy, yy; weight */
LAO_OUT(1, vec4, out_along)  /* direction of u in the world, unit */
LAO_OUT(2, vec4, out_across) /* of v */

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 t = texelFetch(tensor, pixel, 0);
    lao_v3 n = texelFetch(facing, pixel, 0).xyz;
    lao_v3 otherwise = lao_v3_make(0.0, 0.0, 0.0);
    if (lao_constant_variant == 1) {
        t.w = t.w > 0.0 ? 1.0 : 0.0;
    } else {
        lao_v3 p = texelFetch(place, pixel, 0).xyz;
        float mm = sdv_pixel_size(lao_frame.ray, sdv_depth_of(lao_frame.view, p), lao_frame.depth.w);
        ivec2 size = (ivec2(lao_step.size.xy) + 1) / 2;
        sdv_mix m = sdv_mix_start(vec4(0.0));
        otherwise = texelFetch(parent_along, pixel / 2, 0).xyz;
        for (int i = 0; i < 4; i++) {
            ivec2 parent = ivec2(sdv_push_parent(pixel.x, i & 1), sdv_push_parent(pixel.y, i >> 1));
            if (parent.x >= 0 && parent.y >= 0 && parent.x < size.x && parent.y < size.y) {
                vec4 g = texelFetch(spread, parent, 0);
                LAO_EXACT float h = sdv_push_share(1, i & 1) * sdv_push_share(1, i >> 1) *
                                    sdv_parent_nearness(p, texelFetch(parent_place, parent, 0).xyz, mm, lao_step.size.z);
                m = sdv_mix_add(m, vec4(g.xyz, 0.0), g.w, h);
            }
        }
        float kept = sdv_push_own(t.w, 1);
        t = vec4(sdv_push_value(m, vec4(t.xyz, 0.0), kept).xyz, sdv_push_weight(m, kept));
    }
    lao_v3 z = sdv_lift(lao_frame.world, sdv_tensor_axis(t), n, otherwise);
    out_spread = t;
    out_along = vec4(z, 0.0);
    out_across = vec4(lao_v3_cross(n, z), 0.0);
}
#endif
