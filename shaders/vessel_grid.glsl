/* The texels of sdv_grid.cells: outwards along z to the nearest cell with a list, of those as near the lowest, then the
   distance to the cones that it lists. */
LAO_TEX(0, samplerBuffer, box)
LAO_TEX(1, samplerBuffer, cones)
LAO_TEX(2, sampler2D, counts)
LAO_TEX(3, sampler2D, starts)
LAO_TEX(4, sampler2D, lists)
LAO_TEX(5, sampler2D, nearest_xy)

LAO_OUT(0, vec4, out_cell)

#ifdef LAO_FRAGMENT
sdv_nearest candidate(sdv_nearest best, int item, ivec3 place, int z, int d, bool lower) {
    float value = texelFetch(nearest_xy, sdv_item(item), 0).x;
    int dx = (int(value) & 511) - place.x;
    int dy = (int(value) >> 9) - place.y;
    return sdv_nearest_add(best, value, dx * dx + dy * dy + d * d, z, lower);
}

void main() {
    sdv_box b = sdv_box_fetch(box);
    ivec3 size = ivec3(b.size);
    int layer = size.x * size.y;
    int item = sdv_item_at(LAO_PIXEL);
    ivec3 place = sdv_place(item, size);
    vec4 cell = vec4(SDV_FAR, float(item), texelFetch(starts, sdv_item(item), 0).x, texelFetch(counts, sdv_item(item), 0).x);
    if (!(cell.w > 0.0)) {
        sdv_nearest best = sdv_nearest_start();
        for (int d = 0; d < SDV_AXIS && d * d <= best.apart && place.z < size.z; d++) {
            int low = place.z - d;
            int high = place.z + d;
            if (low < 0 && high >= size.z) {
                break;
            }
            if (low >= 0) {
                best = candidate(best, item - d * layer, place, low, d, true);
            }
            if (high < size.z) {
                best = candidate(best, item + d * layer, place, high, d, false);
            }
        }
        cell.y = 0.0;
        if (!(best.value < 0.0)) {
            LAO_EXACT float apart = lao_sqrt(float(best.apart)) * b.cell;
            int xy = int(best.value);
            cell.y = float((xy & 511) + size.x * (xy >> 9) + layer * best.along);
            cell.z = sdv_far_step(apart, b.cell);
        }
    }
    int from = int(texelFetch(starts, sdv_item(int(cell.y)), 0).x);
    int count = int(texelFetch(counts, sdv_item(int(cell.y)), 0).x);
    lao_v3 centre = sdv_cell_centre(b, uint(place.x), uint(place.y), uint(place.z));
    for (int i = from; i < from + count; i++) {
        int at = 2 * int(texelFetch(lists, sdv_item(i), 0).x);
        cell.x = lao_min(cell.x, sdv_round_cone(centre, texelFetch(cones, at), texelFetch(cones, at + 1)));
    }
    out_cell = cell;
}
#endif
