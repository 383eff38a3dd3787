/* Phases from coarse to fine: what the parents predict; what was recalled stays as it was down to the level from which a
   frame renews (L19 3.6, 3.7; METHODS 7.3, 7.4). */
LAO_TEX(0, sampler2D, recalled)
LAO_TEX(1, sampler2D, place)
LAO_TEX(2, sampler2D, along)
LAO_TEX(3, sampler2D, across)
LAO_TEX(4, sampler2D, parent_place) /* of the coarser level, as what follows */
LAO_TEX(5, sampler2D, parent_along)
LAO_TEX(6, sampler2D, parent_across)
LAO_TEX(7, sampler2D, phase)
LAO_CONSTANT(0, lao_constant_variant) /* 1: the top, which has no parents */

LAO_OUT(0, vec4, out_phase) /* u, v, radians; 1: as recalled, not to be optimised; nothing */

#ifdef LAO_FRAGMENT
float first_level() {
    LAO_EXACT float busy = sdv_apart(lao_frame.view, lao_frame.previous_view) +
                           sdv_apart(lao_frame.projection, lao_frame.previous_projection) +
                           lao_max(1.0 - lao_setting_ssp_converge, 0.0);
    LAO_EXACT float period = lao_setting_ssp_period * lao_pixel_zoom(lao_frame.scale, lao_frame.depth, 0.5);
    return sdv_recycle_level(lao_setting_ssp_recycle, period, busy);
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 r = texelFetch(recalled, pixel, 0);
    out_phase = vec4(0.0);
    if (lao_constant_variant == 1) {
        if (r.w > 0.0) {
            out_phase = vec4(r.xy, 1.0, 0.0);
        }
        return;
    }
    LAO_EXACT float beyond = lao_step.size.z - first_level() + 0.5; /* no branch by it alone: see sdv_apart */
    if (r.w * lao_max(beyond, 0.0) > 0.0) {
        out_phase = vec4(r.xy, beyond > 1.0 ? 1.0 : 0.0, 0.0);
        return;
    }
    lao_v3 p = texelFetch(place, pixel, 0).xyz;
    lao_v3 z = texelFetch(along, pixel, 0).xyz;
    lao_v3 y = texelFetch(across, pixel, 0).xyz;
    float mm = sdv_pixel_size(lao_frame.ray, sdv_depth_of(lao_frame.view, p), lao_frame.depth.w);
    float frequency = LAO_TURN / lao_setting_ssp_period;
    ivec2 size = (ivec2(lao_step.size.xy) + 1) / 2;
    sdv_phases s = sdv_phases_start(vec4(0.0));
    for (int i = 0; i < 4; i++) {
        ivec2 parent = ivec2(sdv_push_parent(pixel.x, i & 1), sdv_push_parent(pixel.y, i >> 1));
        if (parent.x >= 0 && parent.y >= 0 && parent.x < size.x && parent.y < size.y) {
            s = sdv_phases_hear(s, p, z, y, texelFetch(parent_place, parent, 0),
                                texelFetch(parent_along, parent, 0).xyz, texelFetch(parent_across, parent, 0).xyz,
                                texelFetch(phase, parent, 0).xy,
                                sdv_push_share(1, i & 1) * sdv_push_share(1, i >> 1), frequency, mm);
        }
    }
    out_phase = vec4(sdv_phases_mean(s, texelFetch(phase, pixel / 2, 0).xy), 0.0, 0.0);
}
#endif
