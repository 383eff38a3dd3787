/* From there the nearest cell with a list in the layer of each cell: outwards along y, as far as one could still be nearer
   (METHODS 5.2); of those as near the lowest y, then the lowest x. */
LAO_TEX(0, samplerBuffer, box)
LAO_TEX(1, sampler2D, nearest_x)

LAO_OUT(0, float, out_xy) /* x + 512 y, -1: the layer has none */

#ifdef LAO_FRAGMENT
sdv_nearest candidate(sdv_nearest best, int item, int x, int y, int d, bool lower) {
    float value = texelFetch(nearest_x, sdv_item(item), 0).x;
    int dx = int(value) - x;
    return sdv_nearest_add(best, value, dx * dx + d * d, y, lower);
}

void main() {
    sdv_box b = sdv_box_fetch(box);
    ivec3 size = ivec3(b.size);
    int item = sdv_item_at(LAO_PIXEL);
    ivec3 place = sdv_place(item, size);
    sdv_nearest best = sdv_nearest_start();
    for (int d = 0; d < SDV_AXIS && d * d <= best.apart && place.z < size.z; d++) {
        int low = place.y - d;
        int high = place.y + d;
        if (low < 0 && high >= size.y) {
            break;
        }
        if (low >= 0) {
            best = candidate(best, item - d * size.x, place.x, low, d, true);
        }
        if (high < size.y) {
            best = candidate(best, item + d * size.x, place.x, high, d, false);
        }
    }
    out_xy = best.value < 0.0 ? -1.0 : best.value + 512.0 * float(best.along);
}
#endif
