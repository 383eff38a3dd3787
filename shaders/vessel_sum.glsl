/* One level of a pyramid of sums: a texel is the sum of four in order of rows, whatever the widths of both levels. */
LAO_TEX(0, sampler2D, finer)

LAO_OUT(0, float, out_sum)

#ifdef LAO_FRAGMENT
void main() {
    ivec2 size = ivec2(lao_step.source.xy);
    int first = 4 * (LAO_PIXEL.x + int(lao_step.size.x) * LAO_PIXEL.y);
    ivec2 at = ivec2(0, sdv_quotient(first, size.x));
    at.x = first - at.y * size.x;
    float sum = 0.0;
    for (int i = 0; i < 4; i++) {
        if (at.y < size.y) {
            sum += texelFetch(finer, at, 0).x;
        }
        at.x++;
        if (at.x == size.x) {
            at = ivec2(0, at.y + 1);
        }
    }
    out_sum = sum;
}
#endif
