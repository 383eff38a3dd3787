/* Effects on the shaded scene, by its depth. Variant 0: the depth shadow (METHODS 10.6). 1: attenuation. 2: what is out of
   focus gets the blurred picture, the more the wider its blur, up to one pixel. */
LAO_TEX(0, sampler2D, shaded)
LAO_TEX(1, sampler2D, scene_z)
LAO_TEX(2, sampler2D, nearest)
LAO_TEX(3, sampler2D, blurred) /* 0: depth at a quarter of the view's size; 2: the picture at the view's size */
LAO_CONSTANT(0, lao_constant_variant)
LAO_CONSTANT(1, lao_constant_supersampling)
LAO_OUT(0, vec4, out_color)
#ifdef LAO_FRAGMENT
/* Of what is covered around the pixel; its own depth where nothing is. */
float blurred_depth(ivec2 pixel, float depth) {
    LAO_EXACT float samples = VSF_SHADOW_PIXELS * float(lao_constant_supersampling);
    lao_v2 x = vsf_between(float(pixel.x), samples);
    lao_v2 y = vsf_between(float(pixel.y), samples);
    ivec2 last = textureSize(blurred, 0) - ivec2(1);
    ivec2 low = min(max(ivec2(int(x.y), int(y.y)), ivec2(0)), last);
    ivec2 high = min(max(ivec2(int(x.y) + 1, int(y.y) + 1), ivec2(0)), last);
    vec4 a = texelFetch(blurred, low, 0);
    vec4 b = texelFetch(blurred, ivec2(high.x, low.y), 0);
    vec4 c = texelFetch(blurred, ivec2(low.x, high.y), 0);
    vec4 d = texelFetch(blurred, high, 0);
    return vsf_covered_mean(vsf_bilinear(a.x, b.x, c.x, d.x, x.x, y.x), vsf_bilinear(a.y, b.y, c.y, d.y, x.x, y.x), depth);
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 color = texelFetch(shaded, pixel, 0);
    float d = vsf_nearer(texelFetch(scene_z, pixel, 0).x, texelFetch(nearest, pixel, 0).x, lao_frame.scale.z);
    float z = vsf_view_depth(lao_frame.unproject, d);
    float depth = lao_scene_depth(lao_frame.depth, z);
    if (lao_constant_variant == 0) {
        out_color = vsf_shadowed(color, depth, blurred_depth(pixel, depth), lao_setting_depth_shadow_strength);
    } else if (lao_constant_variant == 1) {
        out_color = vsf_attenuated(color, depth, lao_setting_attenuation_strength);
    } else {
        float sigma = vsf_blur_sigma(vsf_outside(z, lao_setting_focus_near, lao_setting_focus_far),
                                     lao_setting_focus_growth, lao_setting_focus_blur);
        vec4 wide = texelFetch(blurred, pixel / lao_constant_supersampling, 0);
        out_color = vsf_mix(color, wide, lao_min(sigma, 1.0));
    }
}
#endif
