/* What a vertex of the mirror test gives, in the dialect of the shared text: C and GLSL compile
   these very lines. Row 0: the measure and the eye; 1 to 3: looks made of them. */
LAO_FN lao_v4 surface_mirror(lao_uint row, float s, lao_v4 eye, lao_v3 p, lao_v3 n) {
    lao_v3 to_eye = lao_v3_unit(vsf_to_eye(eye, p, false), n);
    LAO_EXACT float facing = lao_v3_dot(n, to_eye);
    LAO_EXACT float z = 40.0f + p.z;
    LAO_EXACT float near_by = lao_abs(p.x) * 0.25f;
    float far_away = p.y > 4.0f ? VSF_FAR : lao_abs(p.y);
    float x = vsf_near_x(vsf_near_mix(near_by, far_away, lao_clamp01(p.z)), 0.75f);
    float y = vsf_measure_y(s, 1.5f);
    if (row == 0u) {
        return lao_v4_make(s, eye.x, eye.y, eye.z);
    }
    if (row == 1u) {
        lao_v4 flow = vsf_mapped(lao_v3_make(0.9f, 0.5f, 0.1f), x, y, 0.7f);
        lao_v4 back = vsf_premultiply(lao_v3_make(0.2f, 0.3f, 0.4f), vsf_fresnel(facing, 1.5f));
        lao_v4 behind = vsf_add(vsf_lookup(y * y, -y), vsf_lookup(x, y));
        return vsf_over(vsf_lookup(x, y), vsf_over(flow, vsf_over(back, behind)));
    }
    if (row == 2u) {
        float sigma = vsf_blur_sigma(vsf_outside(z, 39.0f, 40.5f), 0.2f, 8.0f);
        return lao_v4_make(vsf_fresnel_rim(facing, 2.5f), sigma,
                           vsf_blur_weight(0.25f * near_by, sigma, z, 0.5f * sigma, 40.0f),
                           vsf_map_place(x, 256.0f).x);
    }
    lao_v3 shaded = vsf_unsharp(lao_v3_make(x, lao_abs(y), 0.5f), near_by, lao_abs(p.z), 2.0f);
    return lao_v4_make(shaded.x, shaded.y, shaded.z, vsf_map_place(lao_abs(y), 33.0f).y);
}
