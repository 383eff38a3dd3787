/* Our picture into the host's image: the one place where rows are flipped and colours are decoded. */
LAO_TEX(0, sampler2D, picture)
LAO_OUT(0, vec4, out_color)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    if (lao_frame.target.z > 0.5) {
        pixel.y = int(lao_step.source.y) - 1 - pixel.y;
    }
    vec4 c = texelFetch(picture, pixel, 0);
    if (lao_frame.target.w > 0.5) {
        c = vec4(lao_srgb_decode(c.x), lao_srgb_decode(c.y), lao_srgb_decode(c.z), c.w);
    }
    out_color = c;
}
#endif
