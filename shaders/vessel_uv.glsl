/* The frame's phases: what has not changed before a camera that has not moved keeps the last frame's (METHODS 7.4). */
LAO_TEX(0, sampler2D, phase)
LAO_TEX(1, sampler2D, spread)
LAO_TEX(2, sampler2D, along)
LAO_TEX(3, sampler2D, surface)
LAO_TEX(4, sampler2D, surface_before)
LAO_TEX(5, sampler2D, uv_before)

LAO_OUT(0, vec4, out_uv) /* u, v, radians; guide on the screen, unit */

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    LAO_EXACT float busy = sdv_apart(lao_frame.view, lao_frame.previous_view) +
                           sdv_apart(lao_frame.projection, lao_frame.previous_projection) + lao_setting_ssp_converge +
                           lao_max(1.0 - lao_frame.history.x, 0.0);
    bool stays = sdv_phase_stays(texelFetch(surface, pixel, 0), texelFetch(surface_before, pixel, 0));
    LAO_EXACT float changes = busy + (stays ? 0.0 : 1.0);
    if (changes == 0.0) {
        out_uv = texelFetch(uv_before, pixel, 0);
        return;
    }
    out_uv = vec4(texelFetch(phase, pixel, 0).xy,
                  sdv_guide_screen(lao_frame.view, sdv_tensor_axis(texelFetch(spread, pixel, 0)),
                                   texelFetch(along, pixel, 0).xyz));
}
#endif
