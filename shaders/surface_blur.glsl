/* The focus blur along x (variant 0) or y (1): a Gaussian as wide as the pixel is out of focus, of samples that are behind
   it or whose own blur reaches it (METHODS 10.5). */
LAO_TEX(0, sampler2D, color)
LAO_TEX(1, sampler2D, depth)
LAO_TEX(2, sampler2D, tiles)
LAO_CONSTANT(0, lao_constant_variant)
LAO_OUT(0, vec4, out_color)
#ifdef LAO_FRAGMENT
float sigma_at(float z) {
    return vsf_blur_sigma(vsf_outside(z, lao_setting_focus_near, lao_setting_focus_far), lao_setting_focus_growth,
                          lao_setting_focus_blur);
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    vec2 tile = texelFetch(tiles, pixel / VSF_FOCUS_PIXELS, 0).xy;
    vec4 sum = texelFetch(color, pixel, 0);
    float z = texelFetch(depth, pixel, 0).x;
    float sigma = sigma_at(z);
    if (!(sigma > 0.0) || (lao_constant_variant == 0 ? tile.x : tile.y) < 0.5) {
        out_color = sum; /* in focus, or nothing near */
        return;
    }
    ivec2 last = ivec2(lao_step.size.xy) - ivec2(1);
    ivec2 along = ivec2(1 - lao_constant_variant, lao_constant_variant);
    int reach = vsf_reach(sigma, VSF_BLUR_MOST);
    LAO_EXACT float weights = 1.0;
    for (int i = 1; i <= reach; i++) {
        float distance2 = float(i * i);
        float gauss = vsf_gauss(distance2, sigma);
        for (int side = -1; side <= 1; side += 2) {
            ivec2 at = pixel + along * (side * i);
            if (at.x < 0 || at.y < 0 || at.x > last.x || at.y > last.y) {
                continue;
            }
            float other = texelFetch(depth, at, 0).x;
            float weight = vsf_blur_counts(distance2, z, sigma_at(other), other) ? gauss : 0.0;
            sum = vsf_sum(sum, texelFetch(color, at, 0), weight);
            weights = weights + weight;
        }
    }
    LAO_EXACT float share = 1.0 / weights;
    out_color = vsf_scaled(sum, share);
}
#endif
