/* ================================================================================================
 * near_search: the lit part of pathlines that is nearest to a vertex: an index of their tracks,
   what is lit at a time, and the search. Uses host and triangle. */

VSF_API double vsf_segment_distance2(const float p[3], const float a[3], const float b[3],
                                     double from, double to) {
    double q[3], d[3], r[3], dd, u;
    int k;
    for (k = 0; k < 3; k++) {
        q[k] = (double)p[k] - (double)a[k];
        d[k] = (double)b[k] - (double)a[k];
    }
    dd = vsf__dot(d, d);
    u = dd > 0 ? vsf__dot(q, d) / dd : 0;
    u = u < to ? u : to;
    u = u > from ? u : from;
    for (k = 0; k < 3; k++) {
        r[k] = q[k] - u * d[k];
    }
    return vsf__dot(r, r);
}

/* A segment (or a point, twice) of a pathline with its times. */
typedef struct vsf__track {
    float a[3], b[3];
    float ta, tb;
} vsf__track;
/* The lit part of a track. */
typedef struct vsf__piece {
    float a[3], b[3];
    double from, to;
} vsf__piece;
typedef struct vsf__box {
    float low[3], high[3];
} vsf__box;

/* All that a table needs to compute distances: tracks and vertices, each along a Morton curve. */
typedef struct vsf__index {
    uint32_t vertex_count, track_count;
    float *positions;   /* 3 per vertex, in order */
    uint32_t *vertices; /* per place in order: the vertex */
    vsf__track *tracks; /* in order */
    double period;      /* ms; 0: none */
    double extent2;     /* mm^2: squared diagonal of everything */
    void *memory;
} vsf__index;

/* What is lit at one time: pieces in order, and above them boxes of 4 pieces, of 4 boxes, ... */
enum { VSF__WIDTH = 4, VSF__LEVELS = 17 };
typedef struct vsf__lit {
    vsf__piece *pieces;
    vsf__box *boxes;
    uint32_t piece_count, level_count;
    uint32_t first[VSF__LEVELS], count[VSF__LEVELS]; /* boxes of a level; 0 is the finest */
    void *memory;
} vsf__lit;

static int vsf__finite3(const float *p) {
    return fabsf(p[0]) <= 1e9f && fabsf(p[1]) <= 1e9f && fabsf(p[2]) <= 1e9f;
}

/* ---- order along a Morton curve */

static uint32_t vsf__spread_bits(uint32_t v) { /* 10 bits, two zeros between them */
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
}
static uint32_t vsf__morton(const float *p, const double low[3], double scale) {
    uint32_t code = 0;
    int k;
    for (k = 0; k < 3; k++) {
        double x = ((double)p[k] - low[k]) * scale;
        uint32_t cell = x > 0 ? x < 1023 ? (uint32_t)x : 1023u : 0u; /* no number: 0 */
        code |= vsf__spread_bits(cell) << k;
    }
    return code;
}
/* Stable sort of items by 30-bit codes; `work` holds as many items again. */
typedef struct vsf__coded {
    uint32_t code, item;
} vsf__coded;
static void vsf__sort_codes(vsf__coded *items, vsf__coded *work, uint32_t count) {
    uint32_t starts[1024], shift, i;
    for (shift = 0; shift < 30; shift += 10) {
        uint32_t sum = 0;
        vsf__coded *swap = items;
        memset(starts, 0, sizeof starts);
        for (i = 0; i < count; i++) {
            starts[(items[i].code >> shift) & 1023u]++;
        }
        for (i = 0; i < 1024; i++) {
            uint32_t n = starts[i];
            starts[i] = sum;
            sum += n;
        }
        for (i = 0; i < count; i++) {
            work[starts[(items[i].code >> shift) & 1023u]++] = items[i];
        }
        items = work;
        work = swap;
    }
    memcpy(work, items, (size_t)count * sizeof *items); /* three rounds end in the other array */
}

/* ---- building the index */

static uint32_t vsf__line_range(const vsf_near_desc *desc, uint32_t line, uint32_t *end) {
    *end = desc->offsets ? desc->offsets[line + 1] : desc->point_count;
    return desc->offsets ? desc->offsets[line] : 0;
}
static int vsf__point_ok(const vsf_near_desc *desc, uint32_t i) {
    return vsf__finite3(desc->points + 3 * (size_t)i) && fabsf(desc->times[i]) <= 1e15f;
}
static void vsf__track_make(vsf__track *track, const vsf_near_desc *desc, uint32_t i, uint32_t j) {
    memcpy(track->a, desc->points + 3 * (size_t)i, sizeof track->a);
    memcpy(track->b, desc->points + 3 * (size_t)j, sizeof track->b);
    track->ta = desc->times[i];
    track->tb = desc->times[j];
}
/* Segments between neighbours on a line; points where they are wanted or stand alone. Returns how
   many; `tracks` may be NULL. */
static uint32_t vsf__tracks(const vsf_near_desc *desc, vsf__track *tracks) {
    uint32_t lines = desc->offsets ? desc->line_count : desc->point_count != 0, line, i, count = 0;
    for (line = 0; line < lines; line++) {
        uint32_t end, begin = vsf__line_range(desc, line, &end);
        for (i = begin; i < end; i++) {
            int here = vsf__point_ok(desc, i), before = i > begin && vsf__point_ok(desc, i - 1);
            int after = i + 1 < end && vsf__point_ok(desc, i + 1);
            int alone = here && ((desc->flags & VSF_NEAR_POINTS) || (!before && !after));
            if (alone || (here && before)) {
                if (tracks) {
                    vsf__track_make(tracks + count, desc, alone ? i : i - 1, i);
                }
                count++;
            }
        }
    }
    return count;
}

static void vsf__grow(double low[3], double high[3], const float *p) {
    int k;
    for (k = 0; k < 3 && vsf__finite3(p); k++) {
        double x = (double)p[k];
        low[k] = x < low[k] ? x : low[k];
        high[k] = x > high[k] ? x : high[k];
    }
}
static double vsf__span(const double low[3], const double high[3]) {
    double span = 0;
    int k;
    for (k = 0; k < 3; k++) {
        span = high[k] - low[k] > span ? high[k] - low[k] : span;
    }
    return span;
}

static void vsf__order_vertices(vsf__index *x, const float *positions, vsf__coded *codes,
                                const double low[3], double scale) {
    uint32_t i;
    for (i = 0; i < x->vertex_count; i++) {
        codes[i].code = vsf__morton(positions + 3 * (size_t)i, low, scale);
        codes[i].item = i;
    }
    vsf__sort_codes(codes, codes + x->vertex_count, x->vertex_count);
    for (i = 0; i < x->vertex_count; i++) {
        x->vertices[i] = codes[i].item;
        memcpy(x->positions + 3 * (size_t)i, positions + 3 * (size_t)codes[i].item,
               3 * sizeof(float));
    }
}
static void vsf__order_tracks(vsf__index *x, const vsf__track *tracks, vsf__coded *codes,
                              const double low[3], double scale) {
    uint32_t i;
    int k;
    for (i = 0; i < x->track_count; i++) {
        float middle[3];
        for (k = 0; k < 3; k++) {
            middle[k] = 0.5f * tracks[i].a[k] + 0.5f * tracks[i].b[k];
        }
        codes[i].code = vsf__morton(middle, low, scale);
        codes[i].item = i;
    }
    vsf__sort_codes(codes, codes + x->track_count, x->track_count);
    for (i = 0; i < x->track_count; i++) {
        x->tracks[i] = tracks[codes[i].item];
    }
}

static void vsf__index_parts(vsf__index *x, lao__block *block) {
    x->positions = lao__part_float(block, 3 * (uint64_t)x->vertex_count);
    x->vertices = lao__part_u32(block, x->vertex_count);
    x->tracks = (vsf__track *)lao__part(block, x->track_count, sizeof(vsf__track));
}
static void vsf__index_free(const lao_allocator *allocator, vsf__index *x) {
    if (x) {
        lao__give(allocator, x->memory);
        lao__give(allocator, x);
    }
}
static void vsf__index_fill(vsf__index *x, const vsf_near_desc *desc, vsf__track *tracks,
                            vsf__coded *codes) {
    double low[3] = {1e30, 1e30, 1e30}, high[3] = {-1e30, -1e30, -1e30}, span, scale;
    uint32_t i;
    int k;
    vsf__tracks(desc, tracks);
    for (i = 0; i < x->track_count; i++) {
        vsf__grow(low, high, tracks[i].a);
        vsf__grow(low, high, tracks[i].b);
    }
    for (i = 0; i < x->vertex_count; i++) {
        vsf__grow(low, high, desc->positions + 3 * (size_t)i);
    }
    for (k = 0; k < 3; k++) {
        x->extent2 += high[k] > low[k] ? (high[k] - low[k]) * (high[k] - low[k]) : 0;
    }
    span = vsf__span(low, high);
    scale = span > 0 ? 1023.999 / span : 0;
    vsf__order_vertices(x, desc->positions, codes, low, scale);
    vsf__order_tracks(x, tracks, codes, low, scale);
}
static vsf__index *vsf__index_make(const lao_allocator *allocator, const vsf_near_desc *desc) {
    vsf__index *x = (vsf__index *)lao__take(allocator, 1, sizeof *x);
    lao__block block = {NULL, 0};
    vsf__track *tracks;
    vsf__coded *codes;
    uint64_t most;
    if (!x) {
        return NULL;
    }
    memset(x, 0, sizeof *x);
    x->vertex_count = desc->vertex_count;
    x->track_count = vsf__tracks(desc, NULL);
    x->period = desc->period;
    vsf__index_parts(x, &block);
    x->memory = lao__take(allocator, block.used, 1);
    most = x->vertex_count > x->track_count ? x->vertex_count : x->track_count;
    tracks = (vsf__track *)lao__take(allocator, x->track_count, sizeof *tracks);
    codes = (vsf__coded *)lao__take(allocator, 2 * most, sizeof *codes);
    if (x->memory && tracks && codes) {
        block.base = (unsigned char *)x->memory;
        block.used = 0;
        vsf__index_parts(x, &block);
        vsf__index_fill(x, desc, tracks, codes);
    } else {
        vsf__index_free(allocator, x);
        x = NULL;
    }
    lao__give(allocator, tracks);
    lao__give(allocator, codes);
    return x;
}

/* ---- what is lit at a time */

/* Appends the part of a track with times in (low, high); `pieces` may be NULL. */
static uint32_t vsf__light_window(const vsf__track *t, double low, double high,
                                  vsf__piece *pieces) {
    double ta = (double)t->ta, tb = (double)t->tb, from = 0, to = 1;
    if (ta == tb) {
        if (!(ta > low && ta < high)) {
            return 0;
        }
    } else {
        double u = (low - ta) / (tb - ta), v = (high - ta) / (tb - ta);
        double first = u < v ? u : v, last = u < v ? v : u;
        from = first > 0 ? first : 0;
        to = last < 1 ? last : 1;
        if (!(from < to)) {
            return 0;
        }
    }
    if (pieces) {
        memcpy(pieces->a, t->a, sizeof t->a);
        memcpy(pieces->b, t->b, sizeof t->b);
        pieces->from = from;
        pieces->to = to;
    }
    return 1;
}
static uint32_t vsf__light_track(const vsf__track *t, double time, double reach, double period,
                                 vsf__piece *pieces) {
    double least = (double)(t->ta < t->tb ? t->ta : t->tb),
           most = (double)(t->ta < t->tb ? t->tb : t->ta);
    double turn;
    uint32_t count = 0;
    int turns, i;
    if (!(period > 0)) {
        return most <= time - reach || least >= time + reach
                   ? 0
                   : vsf__light_window(t, time - reach, time + reach, pieces);
    }
    if (2 * reach >= period || most - least > 4 * period) { /* all of it, or all but slivers */
        return vsf__light_window(t, -1e30, 1e30, pieces);
    }
    turn = ceil((least - time - reach) / period);
    turns = (int)(floor((most - time + reach) / period) - turn); /* 5 at most */
    for (i = 0; i <= turns; i++) {
        double now = time + (turn + i) * period;
        count += vsf__light_window(t, now - reach, now + reach, pieces ? pieces + count : NULL);
    }
    return count;
}

static void vsf__box_grow(vsf__box *box, const vsf__box *other) {
    int k;
    for (k = 0; k < 3; k++) {
        box->low[k] = other->low[k] < box->low[k] ? other->low[k] : box->low[k];
        box->high[k] = other->high[k] > box->high[k] ? other->high[k] : box->high[k];
    }
}
/* The lit part in single precision, rounded outward. */
static vsf__box vsf__piece_box(const vsf__piece *piece) {
    vsf__box box;
    int k;
    for (k = 0; k < 3; k++) {
        double a = (double)piece->a[k], d = (double)piece->b[k] - a;
        double x = a + piece->from * d, y = a + piece->to * d, low = x < y ? x : y,
               high = x < y ? y : x;
        double slack = 1.2e-7 * (fabs(low) + fabs(high)) + 1e-30;
        box.low[k] = (float)(low - slack);
        box.high[k] = (float)(high + slack);
    }
    return box;
}
static void vsf__lit_boxes(vsf__lit *lit) {
    uint32_t level, i, below = lit->piece_count;
    for (level = 0; level < lit->level_count; level++) {
        vsf__box *boxes = lit->boxes + lit->first[level];
        const vsf__box *children = level ? lit->boxes + lit->first[level - 1] : NULL;
        for (i = 0; i < below; i++) {
            vsf__box box = level ? children[i] : vsf__piece_box(lit->pieces + i);
            if (i % VSF__WIDTH == 0) {
                boxes[i / VSF__WIDTH] = box;
            } else {
                vsf__box_grow(boxes + i / VSF__WIDTH, &box);
            }
        }
        below = lit->count[level];
    }
}
/* Pieces lit at a time and the boxes above them. Returns 0, or -1 without memory. */
static int vsf__lit_make(const lao_allocator *allocator, const vsf__index *x, double time,
                         double reach, vsf__lit *lit) {
    lao__block block = {NULL, 0};
    uint64_t pieces = 0, boxes = 0, below;
    uint32_t i;
    memset(lit, 0, sizeof *lit);
    for (i = 0; i < x->track_count; i++) {
        pieces += vsf__light_track(x->tracks + i, time, reach, x->period, NULL);
    }
    if (pieces > 0xfffffff0u) {
        return -1;
    }
    lit->piece_count = (uint32_t)pieces;
    for (below = pieces; pieces && (lit->level_count == 0 || below > 1);
         below = lit->count[lit->level_count++]) {
        lit->first[lit->level_count] = (uint32_t)boxes;
        lit->count[lit->level_count] = (uint32_t)((below + VSF__WIDTH - 1) / VSF__WIDTH);
        boxes += lit->count[lit->level_count];
    }
    for (i = 0; i < 2; i++) {
        lit->pieces = (vsf__piece *)lao__part(&block, pieces, sizeof(vsf__piece));
        lit->boxes = (vsf__box *)lao__part(&block, boxes, sizeof(vsf__box));
        if (i == 0) {
            lit->memory = lao__take(allocator, block.used, 1);
            if (!lit->memory) {
                return -1;
            }
            block.base = (unsigned char *)lit->memory;
            block.used = 0;
        }
    }
    pieces = 0;
    for (i = 0; i < x->track_count; i++) {
        pieces += vsf__light_track(x->tracks + i, time, reach, x->period, lit->pieces + pieces);
    }
    vsf__lit_boxes(lit);
    return 0;
}

/* ---- one vertex */

static float vsf__box_distance2(const vsf__box *box, const float p[3]) {
    float sum = 0;
    int k;
    for (k = 0; k < 3; k++) {
        float below = box->low[k] - p[k], above = p[k] - box->high[k];
        float d = below > above ? below : above;
        sum += d > 0 ? d * d : 0;
    }
    return sum;
}
typedef struct vsf__visit {
    uint32_t level, box;
    float distance2;
} vsf__visit;

/* A squared distance and what boxes must stay below to hold anything nearer: the slack covers the
   rounding of both, so that no order of visits changes the result. */
typedef struct vsf__best {
    double distance2;
    float limit;
    double slack;
} vsf__best;
static void vsf__best_limit(vsf__best *best, double distance2) {
    double limit = distance2 * (1 + 4e-6) + best->slack;
    float f = limit < 3e38 ? (float)limit : 3e38f;
    f = f + f * 1.2e-7f;
    best->limit = f < best->limit ? f : best->limit;
}
static void vsf__try_pieces(const vsf__lit *lit, uint32_t first, const float p[3],
                            vsf__best *best) {
    uint32_t end = first + VSF__WIDTH < lit->piece_count ? first + VSF__WIDTH : lit->piece_count, i;
    for (i = first; i < end; i++) {
        const vsf__piece *piece = lit->pieces + i;
        double d2 = vsf_segment_distance2(p, piece->a, piece->b, piece->from, piece->to);
        if (d2 < best->distance2) {
            best->distance2 = d2;
            vsf__best_limit(best, d2);
        }
    }
}
/* Puts the children of a box on the stack, the nearest on top. */
static uint32_t vsf__push_children(const vsf__lit *lit, vsf__visit from, const float p[3],
                                   float limit, vsf__visit *stack, uint32_t top) {
    uint32_t level = from.level - 1, base = top, i, j;
    uint32_t first = from.box * VSF__WIDTH, end = first + VSF__WIDTH;
    end = end < lit->count[level] ? end : lit->count[level];
    for (i = first; i < end; i++) {
        vsf__visit visit;
        visit.level = level;
        visit.box = i;
        visit.distance2 = vsf__box_distance2(lit->boxes + lit->first[level] + i, p);
        if (visit.distance2 > limit) {
            continue;
        }
        for (j = top++; j > base && stack[j - 1].distance2 < visit.distance2; j--) {
            stack[j] = stack[j - 1];
        }
        stack[j] = visit;
    }
    return top;
}
static double vsf__search(const vsf__lit *lit, const float p[3], double bound2, double slack) {
    vsf__visit stack[VSF__LEVELS * VSF__WIDTH];
    vsf__best best;
    uint32_t top = 1;
    best.distance2 = 1e300;
    best.slack = slack;
    best.limit = 3e38f;
    vsf__best_limit(&best, bound2);
    stack[0].level = lit->level_count - 1;
    stack[0].box = 0;
    stack[0].distance2 = 0;
    while (top > 0) {
        vsf__visit visit = stack[--top];
        if (visit.distance2 > best.limit) {
            continue;
        }
        if (visit.level == 0) {
            vsf__try_pieces(lit, visit.box * VSF__WIDTH, p, &best);
        } else {
            top = vsf__push_children(lit, visit, p, best.limit, stack, top);
        }
    }
    return best.distance2;
}
static double vsf__search_all(const vsf__lit *lit, const float p[3]) {
    double best = 1e300;
    uint32_t i;
    for (i = 0; i < lit->piece_count; i++) {
        const vsf__piece *piece = lit->pieces + i;
        double d2 = vsf_segment_distance2(p, piece->a, piece->b, piece->from, piece->to);
        best = d2 < best ? d2 : best;
    }
    return best;
}

/* ---- all vertices at one time */
