/* The mask of a host's G-buffer as depth: anything nearer than the far plane where it is covered. */
LAO_TEX(0, sampler2D, color)
#ifdef LAO_FRAGMENT
void main() {
    if (texelFetch(color, LAO_PIXEL, 0).w < 0.5) {
        discard;
    }
    gl_FragDepth = 0.5;
}
#endif
