/* Where along x the nearest cell with a list is, in the row of each cell: the lower of two. */
LAO_TEX(0, samplerBuffer, box)
LAO_TEX(1, usampler2D, words)

LAO_OUT(0, float, out_x) /* -1: the row has none */

#ifdef LAO_FRAGMENT
void main() {
    ivec3 size = ivec3(sdv_box_fetch(box).size);
    int wide = (size.x + 31) >> 5;
    int item = sdv_item_at(LAO_PIXEL);
    int row = sdv_quotient(item, size.x);
    int x = item - row * size.x;
    int below = -1;
    int above = -1;
    if (row < size.y * size.z) {
        uint mask = 0xffffffffu >> uint(31 - (x & 31));
        for (int i = x >> 5; i >= 0 && below < 0; i--) {
            uint word = texelFetch(words, sdv_item(row * wide + i), 0).x & mask;
            if (word != 0u) {
                below = 32 * i + sdv_highest(word);
            }
            mask = 0xffffffffu;
        }
        mask = 0xffffffffu << uint(x & 31);
        for (int i = x >> 5; i < wide && above < 0 && below != x; i++) {
            uint word = texelFetch(words, sdv_item(row * wide + i), 0).x & mask;
            if (word != 0u) {
                above = 32 * i + sdv_highest(word & (~word + 1u));
            }
            mask = 0xffffffffu;
        }
    }
    out_x = float(below < 0 || (above >= 0 && above - x < x - below) ? above : below);
}
#endif
