/* Which cells have a list: 32 neighbours along x in a word. */
LAO_TEX(0, samplerBuffer, box)
LAO_TEX(1, sampler2D, counts)

LAO_OUT(0, uint, out_word)

#ifdef LAO_FRAGMENT
void main() {
    ivec3 size = ivec3(sdv_box_fetch(box).size);
    int wide = (size.x + 31) >> 5;
    int item = sdv_item_at(LAO_PIXEL);
    int row = sdv_quotient(item, wide);
    int first = 32 * (item - row * wide);
    uint word = 0u;
    if (row < size.y * size.z) {
        for (int i = 0; i < 32; i++) {
            if (first + i < size.x && texelFetch(counts, sdv_item(row * size.x + first + i), 0).x > 0.0) {
                word |= 1u << uint(i);
            }
        }
    }
    out_word = word;
}
#endif
