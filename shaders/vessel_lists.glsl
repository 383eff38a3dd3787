/* Lists of cones in three steps: of regions from all cones, of blocks from their region's, of cells from their block's. Each
   list is made in parts, one an element; a step is two rows: the number of cones of each element, then, behind the sums of
   all before it, the cones. Those of the cells are what sdv_grid.ids holds. */
LAO_TEX(0, samplerBuffer, box)
LAO_TEX(1, samplerBuffer, cones)
LAO_TEX(2, sampler2D, parent_starts) /* of the step before */
LAO_TEX(3, sampler2D, parent_cones)
LAO_TEX(4, sampler2D, starts)
LAO_TEX(5, usampler2D, masks)
LAO_CONSTANT(0, lao_constant_variant) /* 2 step: numbers; 2 step + 1: cones */

LAO_OUT(0, float, out_value)
LAO_OUT(1, uint, out_mask) /* of numbers: which of the first 32 that were looked at are listed */

#ifdef LAO_FRAGMENT
const int REGIONS = 0;
const int BLOCKS = 1;

/* Cells along an axis. */
int edge_of(sdv_box b, int step) {
    int block = (int(lao_max(b.size.x, lao_max(b.size.y, b.size.z))) + SDV_BLOCKS - 1) / SDV_BLOCKS;
    return step == REGIONS ? SDV_REGION * block : (step == BLOCKS ? block : 1);
}
ivec3 size_of(sdv_box b, int step) {
    int edge = edge_of(b, step);
    ivec3 most = ivec3(b.size) + edge - 1;
    return ivec3(sdv_quotient(most.x, edge), sdv_quotient(most.y, edge), sdv_quotient(most.z, edge));
}
int parts_of(int cone_count, int step) {
    return step == REGIONS ? (cone_count + SDV_CHUNK - 1) / SDV_CHUNK : (step == BLOCKS ? SDV_BLOCK_PARTS : 1);
}
/* A middle, and how far from there a cone may be that a cell lists. */
lao_v4 ball_of(sdv_box b, int step, ivec3 place) {
    if (step > BLOCKS) {
        return lao_v4_make(sdv_cell_centre(b, uint(place.x), uint(place.y), uint(place.z)), sdv_list_reach(b.cell));
    }
    ivec3 low = edge_of(b, step) * place;
    return sdv_block_reach(b, vec3(low), vec3(min(low + edge_of(b, step), ivec3(b.size)) - 1));
}

/* What an element looks at: the step before lists it. */
struct part {
    ivec3 place;
    int from, to;
};
part part_of(sdv_box b, int step, int element) {
    int cone_count = int(texelFetch(box, 1).w);
    int parts = parts_of(cone_count, step);
    int index = sdv_quotient(element, parts);
    part p;
    p.place = sdv_place(index, size_of(b, step));
    p.from = 0;
    p.to = cone_count;
    if (step != REGIONS) {
        int ratio = step == BLOCKS ? SDV_REGION : edge_of(b, BLOCKS);
        ivec3 size = size_of(b, step - 1);
        int parent = sdv_quotient(p.place.x, ratio) +
                     size.x * (sdv_quotient(p.place.y, ratio) + size.y * sdv_quotient(p.place.z, ratio));
        int first = parent * parts_of(cone_count, step - 1);
        p.from = int(texelFetch(parent_starts, sdv_item(first), 0).x);
        p.to = int(texelFetch(parent_starts, sdv_item(first + parts_of(cone_count, step - 1)), 0).x);
    }
    int size = sdv_quotient(p.to - p.from + parts - 1, parts);
    p.from += (element - index * parts) * size;
    p.to = min(p.from + size, p.to);
    return p;
}
float cone_at(int step, int i) {
    return step == REGIONS ? float(i) : texelFetch(parent_cones, sdv_item(i), 0).x;
}
bool is_listed(lao_v4 ball, float cone) {
    int at = 2 * int(cone);
    return sdv_round_cone(ball.xyz, texelFetch(cones, at), texelFetch(cones, at + 1)) <= ball.w;
}

void count(sdv_box b, int step, int element) {
    out_value = 0.0;
    out_mask = 0u;
    part p = part_of(b, step, element);
    if (p.place.z < size_of(b, step).z) {
        lao_v4 ball = ball_of(b, step, p.place);
        for (int i = p.from; i < p.to; i++) {
            if (is_listed(ball, cone_at(step, i))) {
                out_value += 1.0;
                out_mask |= i - p.from < 32 ? 1u << uint(i - p.from) : 0u;
            }
        }
    }
}

/* The cone that so many of the element are in front of. */
float list(sdv_box b, int step, int element, int in_front) {
    part p = part_of(b, step, element);
    uint mask = texelFetch(masks, sdv_item(element), 0).x;
    int left = in_front;
    for (int i = 0; i < 32 && mask != 0u; i++) {
        if (left == 0) {
            return cone_at(step, p.from + sdv_highest(mask & (~mask + 1u)));
        }
        mask &= mask - 1u;
        left--;
    }
    lao_v4 ball = ball_of(b, step, p.place);
    for (int i = p.from + 32; i < p.to; i++) {
        float cone = cone_at(step, i);
        if (is_listed(ball, cone)) {
            if (left == 0) {
                return cone;
            }
            left--;
        }
    }
    return -1.0;
}

void main() {
    int step = lao_constant_variant >> 1;
    int item = sdv_item_at(LAO_PIXEL);
    sdv_box b = sdv_box_fetch(box);
    if ((lao_constant_variant & 1) == 0) {
        count(b, step, item);
        return;
    }
    ivec3 size = size_of(b, step);
    int elements = size.x * size.y * size.z * parts_of(int(texelFetch(box, 1).w), step);
    out_value = -1.0;
    if (float(item) < texelFetch(starts, sdv_item(elements), 0).x) {
        int element = sdv_owner(starts, elements, float(item));
        out_value = list(b, step, element, item - int(texelFetch(starts, sdv_item(element), 0).x));
    }
}
#endif
