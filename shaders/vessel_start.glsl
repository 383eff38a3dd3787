/* Back down the pyramid of sums: the sum of everything before a texel, from that of its parent and its elder siblings. */
LAO_TEX(0, sampler2D, coarser)
LAO_TEX(1, sampler2D, counts)
LAO_CONSTANT(0, lao_constant_variant) /* 1: the top, before which there is nothing */

LAO_OUT(0, float, out_start)

#ifdef LAO_FRAGMENT
void main() {
    out_start = 0.0;
    if (lao_constant_variant == 0) {
        int wide = int(lao_step.size.x);
        int parent_wide = int(lao_step.source.x);
        int item = LAO_PIXEL.x + wide * LAO_PIXEL.y;
        int parent = item >> 2;
        int row = sdv_quotient(parent, parent_wide);
        float sum = texelFetch(coarser, ivec2(parent - row * parent_wide, row), 0).x;
        ivec2 at = LAO_PIXEL;
        for (int i = 0; i < 3; i++) {
            if (i < (item & 3)) {
                at = at.x > 0 ? ivec2(at.x - 1, at.y) : ivec2(wide - 1, at.y - 1);
                sum += texelFetch(counts, at, 0).x;
            }
        }
        out_start = sum;
    }
}
#endif
