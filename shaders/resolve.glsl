/* Mean of a pixel's samples over the background (METHODS 16). Display values, premultiplied by alpha. */
LAO_TEX(0, sampler2D, shaded)
LAO_CONSTANT(0, lao_constant_supersampling)
LAO_OUT(0, vec4, out_color)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 corner = LAO_PIXEL * lao_constant_supersampling;
    LAO_EXACT vec4 sum = vec4(0.0);
    for (int j = 0; j < lao_constant_supersampling; j++) {
        for (int i = 0; i < lao_constant_supersampling; i++) {
            sum = sum + texelFetch(shaded, corner + ivec2(i, j), 0);
        }
    }
    out_color = lao_over(sum, float(lao_constant_supersampling * lao_constant_supersampling), lao_frame.background);
}
#endif
