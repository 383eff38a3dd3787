/* All layers of front faces over the scene (METHODS 9.3): what they composed is the greater of both partners. */
LAO_TEX(0, sampler2D, latest)
LAO_TEX(1, sampler2D, partner)
LAO_TEX(2, sampler2D, behind)
LAO_CONSTANT(0, lao_constant_blend)
LAO_CONSTANT(1, lao_constant_layers)
LAO_OUT(0, vec4, out_color)
LAO_OUT(1, vec4, out_composed)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 f = texelFetch(latest, pixel, 0);
    if (lao_constant_layers > 0) {
        f = vsf_greater(f, texelFetch(partner, pixel, 0));
    }
    vec4 b = texelFetch(behind, pixel, 0);
    out_composed = f;
    if (lao_constant_blend == VSF_BLEND_ADD) {
        out_color = vsf_add(f, b);
    } else {
        out_color = vsf_over(f, b);
    }
}
#endif
