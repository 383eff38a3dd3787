/* The focus blur along x (variant 0) or y (1): a Gaussian as wide as the pixel is out of focus, of samples that are behind
   it or whose own blur reaches it (METHODS 10.5). */
LAO_TEX(0, sampler2D, color)
LAO_TEX(1, sampler2D, depth)
LAO_CONSTANT(0, lao_constant_variant)
LAO_OUT(0, vec4, out_color)
#ifdef LAO_FRAGMENT
float sigma_at(float z) {
    return vsf_blur_sigma(vsf_outside(z, lao_setting_focus_near, lao_setting_focus_far), lao_setting_focus_growth,
                          lao_setting_focus_blur);
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    ivec2 last = ivec2(lao_step.size.xy) - ivec2(1);
    ivec2 along = ivec2(1 - lao_constant_variant, lao_constant_variant);
    float z = texelFetch(depth, pixel, 0).x;
    float sigma = sigma_at(z);
    int reach = vsf_reach(sigma, 96);
    vec4 sum = texelFetch(color, pixel, 0);
    LAO_EXACT float weights = 1.0;
    for (int i = -reach; i <= reach; i++) {
        ivec2 at = pixel + along * i;
        if (i == 0 || at.x < 0 || at.y < 0 || at.x > last.x || at.y > last.y) {
            continue;
        }
        float other = texelFetch(depth, at, 0).x;
        float weight = vsf_blur_weight(float(i * i), sigma, z, sigma_at(other), other);
        sum = vsf_sum(sum, texelFetch(color, at, 0), weight);
        weights = weights + weight;
    }
    LAO_EXACT float share = 1.0 / weights;
    out_color = vsf_scaled(sum, share);
}
#endif
