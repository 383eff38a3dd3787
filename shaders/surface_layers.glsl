/* What is composed so far over what lies behind it: the next layer of front faces, or the scene (METHODS 9.3). */
LAO_TEX(0, sampler2D, front)
LAO_TEX(1, sampler2D, behind)
LAO_CONSTANT(0, lao_constant_blend)
LAO_OUT(0, vec4, out_color)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    vec4 f = texelFetch(front, pixel, 0);
    vec4 b = texelFetch(behind, pixel, 0);
    if (lao_constant_blend == VSF_BLEND_ADD) {
        out_color = vsf_add(f, b);
    } else {
        out_color = vsf_over(f, b);
    }
}
#endif
