/* ================================================================================================
 * near: the table of distances to what is lit, per vertex and step of time. Uses host, triangle and
   near_search. */

/* ---- all vertices at one time */

static float vsf__from_half(uint32_t h) { /* 0 or more, or infinity */
    uint32_t exponent = h >> 10, fraction = h & 1023u;
    if (exponent == 31) {
        return VSF_FAR;
    }
    if (exponent == 0) {
        return (float)fraction * 5.96046448e-8f;
    }
    return lao_bits_float(((exponent + 112u) << 23) | (fraction << 13));
}
static uint32_t vsf__to_half(float f) { /* to nearest, ties to even; f is 0 or more */
    uint32_t bits = lao_float_bits(f);
    if (f >= VSF_FAR) {
        return 0x7c00u;
    }
    if (f >= 65504.0f) {
        return 0x7bffu;
    }
    if (f < 6.10351562e-5f) {
        return (uint32_t)(f * 16777216.0f + 0.5f); /* below the normal range: to nearest */
    }
    bits -= 112u << 23;
    return (bits + 0xfffu + ((bits >> 13) & 1u)) >> 13;
}
static float vsf__stored(const void *values, uint32_t bytes, uint64_t i) {
    return bytes == 2 ? vsf__from_half(((const uint16_t *)values)[i]) : ((const float *)values)[i];
}

typedef struct vsf__query {
    const vsf__index *index;
    vsf__lit lit;
    const vsf_near *old; /* distances that bound the new ones; NULL: none */
    uint64_t old_first;  /* of the step, in old->values */
    void *out;           /* vertex_count values of the step */
    uint32_t bytes, brute;
} vsf__query;

static void vsf__store(const vsf__query *q, uint32_t vertex, float distance) {
    if (q->bytes == 2) {
        ((uint16_t *)q->out)[vertex] = (uint16_t)vsf__to_half(distance);
    } else {
        ((float *)q->out)[vertex] = distance;
    }
}
static void vsf__query_vertices(void *arg, uint32_t first, uint32_t end) {
    const vsf__query *q = (const vsf__query *)arg;
    const vsf__index *x = q->index;
    const double slack = 1e-14 * x->extent2, room = 1e-9 * sqrt(x->extent2);
    double last = -1; /* distance of the vertex before, none yet */
    uint32_t i;
    for (i = first; i < end; i++) {
        const float *p = x->positions + 3 * (size_t)i;
        uint32_t vertex = x->vertices[i];
        double bound = 1e18, d2;
        if (!vsf__finite3(p) || q->lit.piece_count == 0) {
            vsf__store(q, vertex, VSF_FAR);
            last = -1;
            continue;
        }
        if (last >= 0) { /* a distance does not change faster than the place */
            double step[3], a[3], b[3];
            vsf__load(p, a);
            vsf__load(p - 3, b);
            vsf__sub(a, b, step);
            bound = (last + sqrt(vsf__dot(step, step))) * (1 + 1e-6) + room;
        }
        if (q->old) {
            double was = (double)vsf__stored(q->old->values, q->old->bytes, q->old_first + vertex);
            was = was * (q->bytes == 2 ? 1.001 : 1.000001) + room + (q->bytes == 2 ? 1e-7 : 0);
            bound = was < bound && was < 65504 ? was : bound;
        }
        d2 = q->brute ? vsf__search_all(&q->lit, p) : vsf__search(&q->lit, p, bound * bound, slack);
        last = sqrt(d2);
        vsf__store(q, vertex, (float)last);
    }
}

/* ---- the table */

/* Value of a rank among the finite ones: two rounds of counting by 16 bits each. */
static float vsf__rank(const vsf_near *n, uint64_t values, uint64_t rank, uint64_t *counts) {
    uint32_t high = 0, i;
    uint64_t k;
    memset(counts, 0, 65536 * sizeof *counts);
    for (k = 0; k < values; k++) {
        float f = vsf__stored(n->values, n->bytes, k);
        if (f < VSF_FAR) {
            counts[lao_float_bits(f) >> 16]++;
        }
    }
    while (rank >= counts[high]) {
        rank -= counts[high++];
    }
    memset(counts, 0, 65536 * sizeof *counts);
    for (k = 0; k < values; k++) {
        uint32_t bits = lao_float_bits(vsf__stored(n->values, n->bytes, k));
        if (bits >> 16 == high) {
            counts[bits & 65535u]++;
        }
    }
    for (i = 0; rank >= counts[i]; i++) {
        rank -= counts[i];
    }
    return lao_bits_float((high << 16) | i);
}
/* 1 % quantile, type 7, of all finite values; 0 without any. */
static float vsf__gamma(const vsf_near *n, uint64_t *counts) {
    uint64_t values = (uint64_t)n->vertex_count * n->step_count, finite = 0, k;
    double place, low, high, gamma;
    for (k = 0; k < values; k++) {
        finite += vsf__stored(n->values, n->bytes, k) < VSF_FAR;
    }
    if (finite == 0) {
        return 0;
    }
    place = 0.01 * (double)(finite - 1);
    k = (uint64_t)place;
    low = (double)vsf__rank(n, values, k, counts);
    high = k + 1 < finite ? (double)vsf__rank(n, values, k + 1, counts) : low;
    gamma = low + (place - (double)k) * (high - low);
    return gamma > 1e-6 ? (float)gamma : 1e-6f;
}

static double vsf__step_time(const vsf_near *n, uint32_t step) {
    return n->step_count > 1 ? n->duration * step / (n->step_count - 1) : 0;
}
/* All vertices at a time into `out`. */
static lao_result vsf__near_time(vsf__progress *progress, const vsf_near *n, double time,
                                 vsf__query *query, uint64_t *lit_count) {
    const vsf__index *x = (const vsf__index *)n->index;
    lao_allocator allocator = vsf__allocator(progress->host);
    int cancelled;
    if (vsf__lit_make(&allocator, x, time, n->reach, &query->lit)) {
        return vsf__fail(progress->host, VSF_LOG_MEMORY, "lit parts at %g ms", time);
    }
    query->index = x;
    query->bytes = n->bytes;
    query->brute = (n->flags & VSF_NEAR_BRUTE) != 0;
    cancelled = vsf__run(progress, x->vertex_count, 512, query, vsf__query_vertices);
    *lit_count += query->lit.piece_count;
    lao__give(&allocator, query->lit.memory);
    query->lit.memory = NULL;
    return cancelled ? vsf__fail(progress->host, VSF_LOG_CANCELLED, NULL) : LAO_OK;
}
/* Fills n->values, which are new; `old` bounds them where its reach is less. */
static lao_result vsf__near_fill(const vsf_host *host, vsf_near *n, const vsf_near *old) {
    uint64_t v = n->vertex_count, values = v * n->step_count;
    vsf__progress progress = vsf__progress_make(host, values);
    uint64_t *counts;
    uint32_t step;
    lao_result result = LAO_OK;
    n->values = lao__take(&n->allocator, values, n->bytes);
    counts = (uint64_t *)lao__take(&n->allocator, 65536, sizeof *counts);
    if (!n->values || !counts) {
        lao__give(&n->allocator, n->values);
        lao__give(&n->allocator, counts);
        n->values = NULL;
        return vsf__fail(host, VSF_LOG_MEMORY, "%u vertices at %u times", n->vertex_count,
                         n->step_count);
    }
    n->lit = 0;
    for (step = 0; step < n->step_count && result == LAO_OK; step++) {
        vsf__query query;
        memset(&query, 0, sizeof query);
        query.out = (unsigned char *)n->values + v * step * n->bytes;
        query.old = old && old->reach <= n->reach ? old : NULL;
        query.old_first = v * step;
        result = vsf__near_time(&progress, n, vsf__step_time(n, step), &query, &n->lit);
        progress.done = v * (step + 1);
    }
    if (result == LAO_OK) {
        n->gamma = vsf__gamma(n, counts);
    } else {
        lao__give(&n->allocator, n->values);
        n->values = NULL;
    }
    lao__give(&n->allocator, counts);
    return result;
}

static void vsf__near_beta(vsf_near *n, double beta) {
    n->beta = beta;
    n->sigma = sqrt(0.5 * beta);
    n->reach = sqrt(beta * 1.3862943611198906);
}

static lao_result vsf__near_check(const vsf_host *host, const vsf_near_desc *desc) {
    uint32_t i;
    if ((desc->vertex_count && !desc->positions) ||
        (desc->point_count && (!desc->points || !desc->times))) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "arrays of vsf_near_desc");
    }
    if (desc->vertex_count > 1u << 30 || desc->point_count > 1u << 30 ||
        (uint64_t)desc->vertex_count * (desc->step_count ? desc->step_count : 100) > (uint64_t)1
                                                                                         << 40) {
        return vsf__fail(host, VSF_LOG_NEAR_COUNT, "%u vertices at %u times, %u points",
                         desc->vertex_count, desc->step_count, desc->point_count);
    }
    if (!(desc->beta >= 0 && desc->beta <= 1e15) || !(desc->period >= 0 && desc->period <= 1e15)) {
        return vsf__fail(host, VSF_LOG_SETTING, "beta and period are 0 to 1e15, not %g and %g",
                         desc->beta, desc->period);
    }
    for (i = 0; desc->offsets && i < desc->line_count; i++) {
        if (desc->offsets[0] != 0 || desc->offsets[i] > desc->offsets[i + 1]) {
            return vsf__fail(host, VSF_LOG_LINES_OFFSETS, "line %u", i);
        }
    }
    if (desc->offsets && desc->line_count && desc->offsets[desc->line_count] != desc->point_count) {
        return vsf__fail(host, VSF_LOG_LINES_OFFSETS, "%u of %u points",
                         desc->offsets[desc->line_count], desc->point_count);
    }
    return LAO_OK;
}

/* Bits of a float as a number that sorts like it. */
static uint32_t vsf__sortable(float f) {
    uint32_t bits = lao_float_bits(f);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}
/* k-th of `count` numbers that sort like floats, by halving: 32 rounds. */
static double vsf__kth(const uint32_t *values, uint32_t count, uint32_t k) {
    uint32_t low = 0, high = 0xffffffffu, i;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2, below = 0;
        for (i = 0; i < count; i++) {
            below += values[i] <= middle;
        }
        if (below > k) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return (double)lao_bits_float(low & 0x80000000u ? low & 0x7fffffffu : ~low);
}
/* Median of the lines' last times, and their greatest; 0 and 0 without any. Returns 0, or -1
   without memory. */
static int vsf__median_time(const lao_allocator *allocator, const vsf_near_desc *desc,
                            double *median, double *last) {
    uint32_t lines = desc->offsets ? desc->line_count : desc->point_count != 0, i, line, count = 0;
    uint32_t *times = (uint32_t *)lao__take(allocator, lines, sizeof *times);
    *median = *last = 0;
    if (!times) {
        return -1;
    }
    for (line = 0; line < lines; line++) {
        uint32_t end, most = 0;
        for (i = vsf__line_range(desc, line, &end); i < end; i++) {
            uint32_t t = fabsf(desc->times[i]) <= 1e15f ? vsf__sortable(desc->times[i] + 0.0f) : 0;
            most = t > most ? t : most;
        }
        if (most) {
            times[count++] = most;
        }
    }
    if (count) {
        *median =
            0.5 * (vsf__kth(times, count, (count - 1) / 2) + vsf__kth(times, count, count / 2));
        *last = vsf__kth(times, count, count - 1);
    }
    lao__give(allocator, times);
    return 0;
}

VSF_API lao_result vsf_near_make(const vsf_host *host, const vsf_near_desc *desc, vsf_near *table) {
    vsf_near n;
    double median, last;
    lao_result result;
    if (!desc || !table) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_near_make");
    }
    result = vsf__near_check(host, desc);
    if (result != LAO_OK) {
        return result;
    }
    memset(&n, 0, sizeof n);
    n.allocator = vsf__allocator(host);
    n.vertex_count = desc->vertex_count;
    n.step_count = desc->step_count ? desc->step_count : 100;
    n.flags = desc->flags;
    n.bytes = desc->flags & VSF_NEAR_HALF ? 2 : 4;
    if (vsf__median_time(&n.allocator, desc, &median, &last)) {
        return vsf__fail(host, VSF_LOG_MEMORY, "times of %u lines", desc->line_count);
    }
    n.period = desc->period;
    n.duration = desc->period > 0 ? desc->period : last > 0 ? last : 0;
    vsf__near_beta(&n, desc->beta > 0 ? desc->beta : median > 0 ? 2 * median : 1600);
    n.index = vsf__index_make(&n.allocator, desc);
    if (!n.index) {
        return vsf__fail(host, VSF_LOG_MEMORY, "index of %u points", desc->point_count);
    }
    result = vsf__near_fill(host, &n, NULL);
    if (result != LAO_OK) {
        vsf_near_free(&n);
        return result;
    }
    *table = n;
    return LAO_OK;
}

VSF_API void vsf_near_free(vsf_near *table) {
    if (table && table->index) {
        vsf__index_free(&table->allocator, (vsf__index *)table->index);
        lao__give(&table->allocator, table->values);
    }
    if (table) {
        memset(table, 0, sizeof *table);
    }
}

VSF_API lao_result vsf_near_update(const vsf_host *host, vsf_near *table, double beta) {
    vsf_near n;
    lao_result result;
    if (!table || !table->index) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_near_update");
    }
    if (!(beta > 0 && beta <= 1e15)) {
        return vsf__fail(host, VSF_LOG_SETTING, "beta is more than 0 and at most 1e15, not %g",
                         beta);
    }
    n = *table;
    vsf__near_beta(&n, beta);
    result = vsf__near_fill(host, &n, table);
    if (result == LAO_OK) {
        lao__give(&table->allocator, table->values);
        *table = n;
    }
    return result;
}

VSF_API void vsf_near_step(const vsf_near *table, uint32_t step, float *distances) {
    uint64_t first =
        (uint64_t)table->vertex_count * (step < table->step_count ? step : table->step_count - 1);
    uint32_t i;
    for (i = 0; i < table->vertex_count; i++) {
        distances[i] = vsf__stored(table->values, table->bytes, first + i);
    }
}

VSF_API uint32_t vsf_near_find(const vsf_near *table, double time, float *part) {
    uint32_t step;
    double place;
    *part = 0;
    if (table->step_count < 2 || !(table->duration > 0) || !(fabs(time) <= 1e15)) {
        return 0;
    }
    if (table->period > 0) {
        time -= table->period * floor(time / table->period);
    }
    place = time / table->duration * (table->step_count - 1);
    if (!(place > 0)) {
        return 0;
    }
    if (place >= table->step_count - 1) {
        *part = 1;
        return table->step_count - 2;
    }
    step = (uint32_t)place;
    *part = (float)(place - step);
    return step;
}

VSF_API void vsf_near_sample(const vsf_near *table, double time, float *distances) {
    float part;
    uint64_t v = table->vertex_count;
    uint32_t step = vsf_near_find(table, time, &part), i;
    uint64_t first = v * step, next = step + 1 < table->step_count ? first + v : first;
    for (i = 0; i < table->vertex_count; i++) {
        distances[i] = vsf_near_mix(vsf__stored(table->values, table->bytes, first + i),
                                    vsf__stored(table->values, table->bytes, next + i), part);
    }
}

VSF_API void vsf_near_pair(const vsf_near *table, uint32_t step, float *texels) {
    uint32_t last = table->step_count - 1, i;
    uint64_t v = table->vertex_count, first = v * (step < last ? step : last);
    uint64_t next = v * (step < last ? step + 1 : last);
    for (i = 0; i < table->vertex_count; i++) {
        texels[2 * (size_t)i] = vsf__stored(table->values, table->bytes, first + i);
        texels[2 * (size_t)i + 1] = vsf__stored(table->values, table->bytes, next + i);
    }
}

VSF_API lao_result vsf_near_exact(const vsf_host *host, const vsf_near *table, double time,
                                  float *distances) {
    vsf__progress progress;
    vsf__query query;
    vsf_near n;
    uint64_t lit = 0;
    if (!table || !table->index || !distances) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_near_exact");
    }
    if (!(fabs(time) <= 1e15)) {
        return vsf__fail(host, VSF_LOG_SETTING, "the time is no number");
    }
    n = *table;
    n.bytes = 4; /* the caller's floats */
    memset(&query, 0, sizeof query);
    query.out = distances;
    progress = vsf__progress_make(host, n.vertex_count);
    return vsf__near_time(&progress, &n, time, &query, &lit);
}
