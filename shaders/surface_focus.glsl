/* What a pixel of the view gives to the focus blur: of its samples those that are out of focus, if there are any, so that
   nothing in focus bleeds; and the nearest depth of them (METHODS 10.5). */
LAO_TEX(0, sampler2D, shaded)
LAO_TEX(1, sampler2D, scene_z)
LAO_TEX(2, sampler2D, nearest)
LAO_CONSTANT(0, lao_constant_supersampling)
LAO_OUT(0, vec4, out_color)
LAO_OUT(1, vec4, out_depth)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 first = LAO_PIXEL * lao_constant_supersampling;
    vec4 inside = vec4(0.0);
    vec4 outside = vec4(0.0);
    vec2 counts = vec2(0.0);
    vec2 depths = vec2(VSF_FAR);
    for (int j = 0; j < lao_constant_supersampling; j++) {
        for (int i = 0; i < lao_constant_supersampling; i++) {
            ivec2 at = first + ivec2(i, j);
            float d = vsf_nearer(texelFetch(scene_z, at, 0).x, texelFetch(nearest, at, 0).x, lao_frame.scale.z);
            float z = vsf_view_depth(lao_frame.unproject, d);
            vec4 color = texelFetch(shaded, at, 0);
            if (vsf_outside(z, lao_setting_focus_near, lao_setting_focus_far) > 0.0) {
                outside = vsf_sum(outside, color, 1.0);
                depths.y = lao_min(depths.y, z);
                counts.y = counts.y + 1.0;
            } else {
                inside = vsf_sum(inside, color, 1.0);
                depths.x = lao_min(depths.x, z);
                counts.x = counts.x + 1.0;
            }
        }
    }
    if (counts.y > 0.0) {
        LAO_EXACT float share = 1.0 / counts.y;
        out_color = vsf_scaled(outside, share);
        out_depth = vec4(depths.y);
    } else {
        LAO_EXACT float share = 1.0 / counts.x;
        out_color = vsf_scaled(inside, share);
        out_depth = vec4(depths.x);
    }
}
#endif
