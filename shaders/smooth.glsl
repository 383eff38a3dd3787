/* One binomial blur of the occlusion along x (variant 0) or y (variant 1) over covered pixels: for debugging (METHODS 1.11). */
LAO_TEX(0, sampler2D, ao)
LAO_TEX(1, sampler2D, color)
LAO_CONSTANT(0, lao_constant_variant)
LAO_OUT(0, vec4, out_ao)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    ivec2 step_ = ivec2(1 - lao_constant_variant, lao_constant_variant);
    ivec2 last = textureSize(ao, 0) - 1;
    LAO_EXACT float sum = 0.0;
    LAO_EXACT float weights = 0.0;
    for (int i = -1; i <= 1; i++) {
        ivec2 at = clamp(pixel + i * step_, ivec2(0), last);
        LAO_EXACT float w = texelFetch(color, at, 0).w < 0.5 ? 0.0 : (i == 0 ? 0.5 : 0.25);
        sum = sum + w * texelFetch(ao, at, 0).x;
        weights = weights + w;
    }
    LAO_EXACT float mean = weights > 0.0 ? sum / weights : 0.0;
    out_ao = vec4(texelFetch(color, pixel, 0).w < 0.5 ? 0.0 : mean);
}
#endif
