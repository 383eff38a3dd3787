/* The last frame's phases where this frame's pixels were then: vessels by the way their surface moved, the void by its
   pixel (L19 3.7; METHODS 7.4). */
LAO_TEX(0, sampler2D, surface)
LAO_TEX(1, sampler2D, normal)
LAO_TEX(2, sampler2D, along)
LAO_TEX(3, sampler2D, across)
LAO_TEX(4, sampler2D, surface_before)
LAO_TEX(5, sampler2D, uv_before)
LAO_TEX(6, sampler2D, ink_before)

LAO_OUT(0, vec4, out_recalled) /* u, v, radians; rest of ink (sdv_ink_rest); weight, 0: nothing was there */

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 now = texelFetch(surface, pixel, 0);
    vec3 at = vec3(vec2(pixel), 1.0);
    out_recalled = vec4(0.0);
    if (now.w > 0.0) {
        at = sdv_pixel_of(lao_frame.previous_view, lao_frame.previous_projection, now.xyz, lao_step.size.x,
                          lao_step.size.y);
    }
    if (lao_min(at.z, lao_frame.history.x) < 0.5) {
        return;
    }
    vec4 before = texelFetch(surface_before, ivec2(at.xy), 0);
    if (before.w != now.w) {
        return;
    }
    lao_v3 apart = lao_v3_make(0.0, 0.0, 0.0);
    if (now.w > 0.0) {
        float mm = sdv_pixel_size(lao_frame.ray, sdv_depth_of(lao_frame.view, now.xyz), lao_frame.depth.w);
        if (!sdv_same_surface(now.xyz, texelFetch(normal, pixel, 0).xyz, before.xyz, mm)) {
            return;
        }
        apart = lao_v3_sub(now.xyz, before.xyz);
    }
    vec4 uv = texelFetch(uv_before, ivec2(at.xy), 0);
    lao_v2 phase = sdv_phase_recall(texelFetch(along, pixel, 0).xyz, texelFetch(across, pixel, 0).xyz,
                                    sdv_guide_world(lao_frame.previous_view, uv.z, uv.w), uv.xy, apart,
                                    LAO_TURN / lao_setting_ssp_period);
    out_recalled = vec4(phase, texelFetch(ink_before, ivec2(at.xy), 0).y, 1.0);
}
#endif
