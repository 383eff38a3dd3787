/* Depth of what was traced, for the surface that fills the void: what nothing covers starts from the last frame's, with
   next to no weight (L19 3.4, 3.7; METHODS 6.1). */
LAO_TEX(0, sampler2D, position)
LAO_TEX(1, sampler2D, surface) /* of the last frame */

LAO_OUT(0, vec4, out_depth) /* mm; covered: 1; nothing; weight */

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 hit = texelFetch(position, pixel, 0);
    out_depth = vec4(0.0);
    if (sdv_is_covered(hit.w)) {
        out_depth = vec4(sdv_depth_of(lao_frame.view, hit.xyz), 1.0, 0.0, 1.0);
    } else {
        vec4 before = texelFetch(surface, pixel, 0);
        float mark = lao_frame.history.x > 0.5 ? sdv_surface_mark(lao_setting_ssp_period, lao_step.source.z) : -1.0;
        if (lao_abs(before.w) == mark) {
            out_depth = vec4(sdv_depth_of(lao_frame.previous_view, before.xyz), 0.0, 0.0, SDV_BACKGROUND_INERTIA);
        }
    }
}
#endif
