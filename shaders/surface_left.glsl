/* Did the last layer of front faces have any pixel? If not, none lies behind it, and the next layers draw no triangle.
   Variant 0: of the pixels of each tile. 1: of all tiles. 2: of the pixels of each tile that the layer before had any in. */
LAO_TEX(0, sampler2D, source)
LAO_TEX(1, sampler2D, before)
LAO_CONSTANT(0, lao_constant_variant)
LAO_OUT(0, vec4, out_found)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 size = textureSize(source, 0);
    int tiles = lao_constant_variant == 1 ? 1 : VSF_LEFT_TILES;
    ivec2 each = (size + ivec2(tiles - 1)) / tiles;
    ivec2 first = LAO_PIXEL * each;
    ivec2 end = min(first + each, size);
    if (lao_constant_variant == 2 && texelFetch(before, LAO_PIXEL, 0).x < 0.5) {
        end = first;
    }
    float found = 0.0;
    for (int y = first.y; y < end.y && found < 0.5; y++) {
        for (int x = first.x; x < end.x && found < 0.5; x++) {
            float value = texelFetch(source, ivec2(x, y), 0).x;
            if (lao_constant_variant != 1) {
                value = vsf_is_covered(value, lao_frame.scale.z) ? 1.0 : 0.0;
            }
            found = lao_max(found, value);
        }
    }
    out_found = vec4(found);
}
#endif
