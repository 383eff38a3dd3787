/* ================================================================================================
 * target: distances of a tree to pieces (points, segments, triangles) sorted along a Morton curve,
   under a binary tree of balls. Uses host. */

enum { SDV__PIECES = 4 }; /* of a leaf */
typedef struct sdv__piece {
    lao_v3 u, v, w; /* a segment has w = v, a point u = v = w */
} sdv__piece;
struct sdv_target {
    lao_allocator allocator;
    uint32_t piece_count, leaf_count; /* leaves: a power of two, the last ones may be empty */
    sdv__piece *pieces;
    lao_v4 *balls; /* 2 leaf_count: children of i are 2 i, 2 i + 1, the root is 1; w < 0: empty */
    float radius;
};

static lao_result sdv__target_check(const sdv_host *host, const sdv_target_desc *desc) {
    uint32_t i;
    if (!desc->points || (desc->triangle_count && !desc->triangles)) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "arrays of sdv_target_desc");
    }
    if (desc->point_count < 1 || desc->point_count > 1u << 28 || desc->triangle_count > 1u << 28 ||
        !(desc->radius >= 0.0f && desc->radius < SDV_FAR)) {
        return sdv__fail(host, SDV_LOG_TARGET_SHAPE, "%u points, %u triangles", desc->point_count,
                         desc->triangle_count);
    }
    for (i = 0; i < 3 * desc->point_count; i++) {
        if (!(fabsf(desc->points[i]) <= 1e9f)) {
            return sdv__fail(host, SDV_LOG_TARGET_SHAPE, "point %u", i / 3);
        }
    }
    for (i = 0; i < 3 * desc->triangle_count; i++) {
        if (desc->triangles[i] >= desc->point_count) {
            return sdv__fail(host, SDV_LOG_TARGET_SHAPE, "triangle %u", i / 3);
        }
    }
    return LAO_OK;
}

static lao_v3 sdv__point(const float *points, uint32_t i) {
    const float *p = points + 3 * (size_t)i;
    return lao_v3_make(p[0], p[1], p[2]);
}
static sdv__piece sdv__piece_make(const sdv_target_desc *desc, uint32_t i) {
    sdv__piece s;
    const uint32_t *corners = desc->triangle_count ? desc->triangles + 3 * (size_t)i : NULL;
    uint32_t last = desc->point_count - 1;
    s.u = sdv__point(desc->points, corners ? corners[0] : i);
    s.v = sdv__point(desc->points, corners ? corners[1] : i < last ? i + 1 : i);
    s.w = corners ? sdv__point(desc->points, corners[2]) : s.v;
    return s;
}
static uint32_t sdv__spread(uint32_t v) { /* 10 bits, two free ones between */
    v = (v | v << 16) & 0x030000ffu;
    v = (v | v << 8) & 0x0300f00fu;
    v = (v | v << 4) & 0x030c30c3u;
    return (v | v << 2) & 0x09249249u;
}
static uint32_t sdv__morton(const sdv__piece *s, const double low[3], double size) {
    uint32_t key = 0, k;
    for (k = 0; k < 3; k++) {
        double u = (double)sdv__v3_at(s->u, k), v = (double)sdv__v3_at(s->v, k);
        double c = (u + v + (double)sdv__v3_at(s->w, k)) / 3 - low[k];
        double cell = size > 0 ? c / size * 1023 : 0;
        key |= sdv__spread(cell > 0 ? (cell < 1023 ? (uint32_t)cell : 1023u) : 0u) << k;
    }
    return key;
}
/* Order of ascending keys, 10 bits a round; `order` and `other` have count entries each. */
static void sdv__sort(const uint32_t *keys, uint32_t count, uint32_t *order, uint32_t *other) {
    uint32_t round, i;
    for (i = 0; i < count; i++) {
        order[i] = i;
    }
    for (round = 0; round < 30; round += 10) {
        uint32_t first[1025];
        memset(first, 0, sizeof first);
        for (i = 0; i < count; i++) {
            first[(keys[i] >> round & 1023u) + 1]++;
        }
        for (i = 0; i < 1024; i++) {
            first[i + 1] += first[i];
        }
        for (i = 0; i < count; i++) {
            other[first[keys[order[i]] >> round & 1023u]++] = order[i];
        }
        memcpy(order, other, count * sizeof *order);
    }
}
/* The ball around the box of points; a margin makes up for rounding. */
static lao_v4 sdv__box_ball(const lao_v3 *low, const lao_v3 *high) {
    lao_v3 d = lao_v3_sub(*high, *low);
    lao_v3 c = lao_v3_along(*low, d, 0.5f);
    float margin = 1e-6f * (fabsf(c.x) + fabsf(c.y) + fabsf(c.z));
    return lao_v4_make(c.x, c.y, c.z, 0.50001f * lao_sqrt(lao_v3_dot(d, d)) + margin);
}
static void sdv__box_grow(lao_v3 *low, lao_v3 *high, lao_v3 p) {
    *low = lao_v3_make(lao_min(low->x, p.x), lao_min(low->y, p.y), lao_min(low->z, p.z));
    *high = lao_v3_make(lao_max(high->x, p.x), lao_max(high->y, p.y), lao_max(high->z, p.z));
}
static void sdv__target_balls(sdv_target *t) {
    uint32_t node, k, wide = t->leaf_count * SDV__PIECES; /* pieces below a node */
    for (node = 1; node < 2 * t->leaf_count; node++) {
        uint32_t first, end;
        lao_v3 low, high;
        wide /= node > 1 && (node & (node - 1)) == 0 ? 2u : 1u; /* the first of its level */
        first = node * wide - t->leaf_count * SDV__PIECES;
        end = first + wide < t->piece_count ? first + wide : t->piece_count;
        t->balls[node] = lao_v4_make(0.0f, 0.0f, 0.0f, -1.0f);
        if (first >= end) {
            continue;
        }
        low = high = t->pieces[first].u;
        for (k = first; k < end; k++) {
            sdv__box_grow(&low, &high, t->pieces[k].u);
            sdv__box_grow(&low, &high, t->pieces[k].v);
            sdv__box_grow(&low, &high, t->pieces[k].w);
        }
        t->balls[node] = sdv__box_ball(&low, &high);
    }
}
static void sdv__target_fill(sdv_target *t, const sdv_target_desc *desc, uint32_t *keys) {
    uint32_t *order = keys + t->piece_count, *other = order + t->piece_count, i, k;
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, size = 0;
    for (i = 0; i < desc->point_count; i++) {
        for (k = 0; k < 3; k++) {
            double v = (double)desc->points[3 * (size_t)i + k];
            low[k] = i == 0 || v < low[k] ? v : low[k];
            high[k] = i == 0 || v > high[k] ? v : high[k];
            size = high[k] - low[k] > size ? high[k] - low[k] : size;
        }
    }
    for (i = 0; i < t->piece_count; i++) {
        sdv__piece s = sdv__piece_make(desc, i);
        keys[i] = sdv__morton(&s, low, size);
    }
    sdv__sort(keys, t->piece_count, order, other);
    for (i = 0; i < t->piece_count; i++) {
        t->pieces[i] = sdv__piece_make(desc, order[i]);
    }
    sdv__target_balls(t);
}

SDV_API lao_result sdv_target_create(const sdv_host *host, const sdv_target_desc *desc,
                                     sdv_target **target) {
    lao_allocator a = sdv__allocator(host);
    sdv_target *t;
    uint32_t *keys;
    lao_result result;
    if (!desc || !target) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_target_create");
    }
    result = sdv__target_check(host, desc);
    if (result != LAO_OK) {
        return result;
    }
    t = (sdv_target *)lao__take(&a, 1, sizeof *t);
    if (!t) {
        return sdv__fail(host, SDV_LOG_MEMORY, "a target");
    }
    memset(t, 0, sizeof *t);
    t->allocator = a;
    t->radius = desc->radius;
    t->piece_count = desc->triangle_count ? desc->triangle_count : desc->point_count - 1;
    t->piece_count = t->piece_count ? t->piece_count : 1; /* a point */
    for (t->leaf_count = 1; t->leaf_count * SDV__PIECES < t->piece_count; t->leaf_count *= 2) {
    }
    t->pieces = (sdv__piece *)lao__take(&a, t->piece_count, sizeof *t->pieces);
    t->balls = (lao_v4 *)lao__take(&a, 2 * (uint64_t)t->leaf_count, sizeof *t->balls);
    keys = (uint32_t *)lao__take(&a, 3 * (uint64_t)t->piece_count, sizeof *keys);
    if (t->pieces && t->balls && keys) {
        sdv__target_fill(t, desc, keys);
        *target = t;
    } else {
        result = sdv__fail(host, SDV_LOG_MEMORY, "a target of %u pieces", t->piece_count);
        sdv_target_free(t);
    }
    lao__give(&a, keys);
    return result;
}

SDV_API void sdv_target_free(sdv_target *target) {
    if (target) {
        lao_allocator a = target->allocator;
        lao__give(&a, target->pieces);
        lao__give(&a, target->balls);
        lao__give(&a, target);
    }
}

static int sdv__same_point(lao_v3 a, lao_v3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}
static float sdv__piece_cone(const sdv__piece *s, lao_v4 a, lao_v4 b) {
    if (sdv__same_point(s->v, s->w)) {
        return sdv_segment_cone(s->u, s->v, a, b);
    }
    return sdv_triangle_cone(s->u, s->v, s->w, a, b);
}
/* No point of the ball is nearer to the cone than this. */
static float sdv__ball_cone(lao_v4 ball, lao_v4 a, lao_v4 b) {
    float d = sdv_round_cone(lao_v3_make(ball.x, ball.y, ball.z), a, b);
    return ball.w < 0.0f ? SDV_FAR : d - ball.w - 1e-5f * fabsf(d);
}
SDV_API float sdv_target_cone(const sdv_target *target, lao_v4 a, lao_v4 b) {
    uint32_t stack[64], n = 0, i;
    float least = SDV_FAR;
    stack[n++] = 1;
    while (n > 0) {
        uint32_t node = stack[--n];
        if (sdv__ball_cone(target->balls[node], a, b) >= least) {
            continue;
        }
        if (node < target->leaf_count) { /* the nearer child next */
            uint32_t child = 2 * node;
            uint32_t second = sdv__ball_cone(target->balls[child], a, b) <
                              sdv__ball_cone(target->balls[child + 1], a, b);
            stack[n++] = child + second;
            stack[n++] = child + !second;
            continue;
        }
        i = (node - target->leaf_count) * SDV__PIECES;
        for (node = i; node < i + SDV__PIECES && node < target->piece_count; node++) {
            const sdv__piece *s = target->pieces + node;
            lao_v3 low = s->u, high = s->u;
            sdv__box_grow(&low, &high, s->v);
            sdv__box_grow(&low, &high, s->w);
            if (sdv__ball_cone(sdv__box_ball(&low, &high), a, b) < least) {
                least = lao_min(least, sdv__piece_cone(s, a, b));
            }
        }
    }
    return least - target->radius;
}
SDV_API float sdv_target_point(const sdv_target *target, lao_v3 p) {
    lao_v4 ball = lao_v4_make(p.x, p.y, p.z, 0.0f);
    return sdv_target_cone(target, ball, ball);
}

typedef struct sdv__measure {
    const sdv_target *target;
    const sdv_tree *tree;
    float *segments;
} sdv__measure;
static void sdv__measure_chunk(void *arg, uint32_t chunk) {
    const sdv__measure *m = (const sdv__measure *)arg;
    uint32_t i, first = chunk * SDV__CHUNK;
    for (i = first; i < first + SDV__CHUNK && i < m->tree->segment_count; i++) {
        const sdv_segment *s = m->tree->segments + i;
        m->segments[i] =
            sdv_target_cone(m->target, m->tree->nodes[s->parent], m->tree->nodes[s->child]);
    }
}
SDV_API lao_result sdv_target_distances(const sdv_host *host, const sdv_target *target,
                                        const sdv_tree *tree, const sdv_reduced *reduced,
                                        float *segments, float *nodes) {
    lao_allocator a = sdv__allocator(host);
    sdv__measure m;
    sdv__work work;
    uint32_t i;
    int cancelled;
    if (!target || !tree || !tree->memory || (nodes && (!reduced || !reduced->memory))) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_target_distances");
    }
    m.target = target;
    m.tree = tree;
    m.segments =
        segments ? segments : (float *)lao__take(&a, tree->segment_count, sizeof *m.segments);
    if (!m.segments) {
        return sdv__fail(host, SDV_LOG_MEMORY, "%u distances", tree->segment_count);
    }
    work.host = host;
    work.done = 0;
    work.total = (tree->segment_count + SDV__CHUNK - 1) / SDV__CHUNK;
    cancelled = sdv__run(&work, (uint32_t)work.total, sdv__measure_chunk, &m);
    for (i = 0; nodes && !cancelled && i < reduced->node_count; i++) {
        nodes[i] = lao_bits_float(0x7fc00000u);
    }
    for (i = 0; nodes && !cancelled && i < tree->node_count; i++) {
        uint32_t segment = tree->parent_segments[i];
        float *least = nodes + reduced->owners[i];
        if (segment != SDV_NONE && !(*least <= m.segments[segment])) {
            *least = m.segments[segment];
        }
    }
    if (!segments) {
        lao__give(&a, m.segments);
    }
    return cancelled ? sdv__fail(host, SDV_LOG_CANCELLED, "measuring distances") : LAO_OK;
}
