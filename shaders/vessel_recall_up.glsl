/* One coarser level of recalled phases: what the finer ones that have any predict (L19 3.7). */
LAO_TEX(0, sampler2D, recalled)
LAO_TEX(1, sampler2D, place) /* of the finer level, as what follows */
LAO_TEX(2, sampler2D, along)
LAO_TEX(3, sampler2D, across)
LAO_TEX(4, sampler2D, own_place)
LAO_TEX(5, sampler2D, own_along)
LAO_TEX(6, sampler2D, own_across)

LAO_OUT(0, vec4, out_recalled)

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    ivec2 size = ivec2(lao_step.source.xy);
    lao_v3 p = texelFetch(own_place, pixel, 0).xyz;
    lao_v3 z = texelFetch(own_along, pixel, 0).xyz;
    lao_v3 y = texelFetch(own_across, pixel, 0).xyz;
    float mm = sdv_pixel_size(lao_frame.ray, sdv_depth_of(lao_frame.view, p), lao_frame.depth.w);
    float frequency = LAO_TURN / lao_setting_ssp_period;
    sdv_phases s = sdv_phases_start(vec4(0.0));
    LAO_EXACT float weight = 0.0;
    for (int i = 0; i < 4; i++) {
        ivec2 child = pixel * 2 + ivec2(i & 1, i >> 1);
        if (child.x < size.x && child.y < size.y) {
            vec4 r = texelFetch(recalled, child, 0);
            if (r.w > 0.0) {
                s = sdv_phases_hear(s, p, z, y, texelFetch(place, child, 0), texelFetch(along, child, 0).xyz,
                                    texelFetch(across, child, 0).xyz, r.xy, r.w, frequency, mm);
                weight = weight + 0.25 * r.w;
            }
        }
    }
    bool agrees = sdv_phase_agrees(s.sum.x, s.sum.y, s.share.x) && sdv_phase_agrees(s.sum.z, s.sum.w, s.share.y);
    out_recalled = vec4(0.0);
    if (agrees) {
        out_recalled = vec4(sdv_phases_mean(s, lao_v2_make(0.0, 0.0)), 0.0, weight);
    }
}
#endif
