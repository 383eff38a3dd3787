/* Line illumination times 1 - occlusion, or a single factor as grey (METHODS 1.2, 1.9; Koehler 2017, Fig. 4). */
LAO_TEX(0, sampler2D, color)
LAO_TEX(1, sampler2D, tangent)
LAO_TEX(2, sampler2D, ao)
LAO_CONSTANT(0, lao_constant_shininess)
LAO_CONSTANT(1, lao_constant_occlusion)
LAO_CONSTANT(2, lao_constant_show)
LAO_CONSTANT(3, lao_constant_ao_affects_color)

LAO_OUT(0, vec4, out_color)

#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 base = texelFetch(color, pixel, 0);
    if (base.w < 0.5) {
        discard;
    }
    float occlusion = lao_constant_occlusion != 0 ? texelFetch(ao, pixel, 0).x : 0.0;
    if (lao_constant_show == LAO_SHOW_COLOR) {
        out_color = vec4(base.xyz, 1.0);
        return;
    }
    if (lao_constant_show != LAO_SHOW_PICTURE) {
        out_color = vec4(vec3(1.0 - lao_clamp01(occlusion)), 1.0);
        return;
    }
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    lao_v3 l = lao_towards_eye(slope, lao_frame.depth.w);
    if (lao_constant_ao_affects_color == LAO_COLOR_LUMINANCE_PRESERVING) {
        out_color = vec4(lao_shade_luminance(base.xyz, texelFetch(tangent, pixel, 0).xyz, l, lao_setting_ambient,
                                             lao_setting_diffuse, lao_setting_strength * occlusion),
                         1.0);
        return;
    }
    LAO_EXACT float specular = lao_setting_specular * lao_light_unpack(base.w);
    out_color = vec4(lao_shade(base.xyz, texelFetch(tangent, pixel, 0).xyz, l, lao_setting_ambient, lao_setting_diffuse,
                               specular, lao_constant_shininess, lao_setting_strength * occlusion),
                     1.0);
}
#endif
