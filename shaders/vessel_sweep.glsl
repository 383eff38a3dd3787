/* One optimisation within a level: what the four neighbours predict (L19 3.6; METHODS 7.3). */
LAO_TEX(0, sampler2D, phase)
LAO_TEX(1, sampler2D, place)
LAO_TEX(2, sampler2D, along)
LAO_TEX(3, sampler2D, across)

LAO_OUT(0, vec4, out_phase)

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 own = texelFetch(phase, pixel, 0);
    out_phase = own;
    if (own.z > 0.5) {
        return;
    }
    lao_v3 p = texelFetch(place, pixel, 0).xyz;
    lao_v3 z = texelFetch(along, pixel, 0).xyz;
    lao_v3 y = texelFetch(across, pixel, 0).xyz;
    float mm = sdv_pixel_size(lao_frame.ray, sdv_depth_of(lao_frame.view, p), lao_frame.depth.w);
    float frequency = LAO_TURN / lao_setting_ssp_period;
    ivec2 size = ivec2(lao_step.size.xy);
    sdv_phases s = sdv_phases_start(vec4(0.0));
    for (int i = 0; i < 4; i++) {
        int side = 2 * (i & 1) - 1;
        ivec2 q = pixel + (i < 2 ? ivec2(side, 0) : ivec2(0, side));
        if (q.x >= 0 && q.y >= 0 && q.x < size.x && q.y < size.y) {
            s = sdv_phases_hear(s, p, z, y, texelFetch(place, q, 0), texelFetch(along, q, 0).xyz,
                                texelFetch(across, q, 0).xyz, texelFetch(phase, q, 0).xy, 1.0, frequency, mm);
        }
    }
    out_phase.xy = sdv_phases_mean(s, own.xy);
}
#endif
