/* Pixel (n, row): every shared function, evaluated by the GPU. Behind mirror.h. */
LAO_OUT(0, vec4, out_value)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    out_value = mirror(uint(pixel.y), uint(pixel.x));
}
#endif
