/* Scene depth for the depth shadow, small and blurred (Luft 2006; METHODS 10.6). Variant 0: of the samples below a texel
   what is covered, as the sum of its depths and its share. 1 and 2: a Gaussian of both along x and y. */
LAO_TEX(0, sampler2D, source) /* 0: the depth buffer; 1, 2: depth */
LAO_TEX(1, sampler2D, nearest)
LAO_CONSTANT(0, lao_constant_variant)
LAO_CONSTANT(1, lao_constant_supersampling)
LAO_OUT(0, vec4, out_depth)
#ifdef LAO_FRAGMENT
lao_v2 covered_depth(ivec2 texel) {
    int samples = int(VSF_SHADOW_PIXELS) * lao_constant_supersampling;
    ivec2 first = texel * samples;
    ivec2 size = ivec2(lao_step.source.xy);
    LAO_EXACT float sum = 0.0;
    LAO_EXACT float count = 0.0;
    for (int j = first.y; j < min(first.y + samples, size.y); j++) {
        for (int i = first.x; i < min(first.x + samples, size.x); i++) {
            float d = vsf_nearer(texelFetch(source, ivec2(i, j), 0).x, texelFetch(nearest, ivec2(i, j), 0).x,
                                 lao_frame.scale.z);
            if (vsf_is_covered(d, lao_frame.scale.z)) {
                sum = sum + lao_scene_depth(lao_frame.depth, vsf_view_depth(lao_frame.unproject, d));
                count = count + 1.0;
            }
        }
    }
    return lao_v2_make(sum, count);
}

lao_v2 blurred(ivec2 texel, ivec2 along) {
    LAO_EXACT float width = 0.01 * lao_setting_depth_shadow_width;
    LAO_EXACT float columns = lao_frame.viewport.x / float(lao_constant_supersampling);
    LAO_EXACT float rows = lao_frame.viewport.y / float(lao_constant_supersampling);
    float sigma = vsf_shadow_sigma(width, columns, rows);
    /* The share of what is covered is never negative: nothing is added. But a loop whose end is known from uniforms alone
       is unrolled by lavapipe in a program of its own, compiled anew in every frame. */
    int reach = vsf_reach(sigma, VSF_SHADOW_REACH) + int(lao_min(texelFetch(source, texel, 0).y, 0.0));
    ivec2 last = ivec2(lao_step.size.xy) - ivec2(1);
    LAO_EXACT float sum = 0.0;
    LAO_EXACT float count = 0.0;
    for (int i = -reach; i <= reach; i++) {
        ivec2 at = min(max(texel + along * i, ivec2(0)), last);
        float weight = vsf_gauss(float(i * i), sigma);
        vec4 part = texelFetch(source, at, 0);
        sum = sum + weight * part.x;
        count = count + weight * part.y;
    }
    return lao_v2_make(sum, count);
}

void main() {
    ivec2 texel = LAO_PIXEL;
    if (lao_constant_variant == 0) {
        out_depth = vec4(covered_depth(texel), 0.0, 0.0);
    } else if (lao_constant_variant == 1) {
        out_depth = vec4(blurred(texel, ivec2(1, 0)), 0.0, 0.0);
    } else {
        out_depth = vec4(blurred(texel, ivec2(0, 1)), 0.0, 0.0);
    }
}
#endif
