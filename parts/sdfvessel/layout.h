/* ================================================================================================
 * layout: the reduced tree, its drawing in the plane, and that drawing as SVG or as a tree. Uses
   host. */

static void sdv__reduced_parts(sdv_reduced *r, uint32_t tree_nodes, lao__block *block) {
    r->ids = lao__part_u32(block, r->node_count);
    r->nodes = lao__part_u32(block, r->node_count);
    r->parents = lao__part_u32(block, r->node_count);
    r->children = lao__part_u32(block, 2 * (uint64_t)r->node_count);
    r->order = lao__part_u32(block, r->node_count);
    r->roots = lao__part_u32(block, r->root_count);
    r->owners = lao__part_u32(block, tree_nodes);
}

/* Children along the spanning tree. */
static void sdv__count_children(const sdv_tree *t, uint32_t *counts) {
    uint32_t i;
    memset(counts, 0, t->node_count * sizeof *counts);
    for (i = 0; i < t->node_count; i++) {
        if (t->parents[i] != SDV_NONE) {
            counts[t->parents[i]]++;
        }
    }
}
static int sdv__is_kept(const sdv_tree *t, const uint32_t *counts, uint32_t i) {
    return counts[i] != 1 || t->parents[i] == SDV_NONE;
}
static uint32_t sdv__extra_count(const sdv_tree *t, const uint32_t *counts, uint32_t i) {
    uint32_t root = t->parents[i] == SDV_NONE;
    return counts[i] < 2 ? 0 : counts[i] - 2 + root;
}

/* Owners, upwards: a node between branches belongs to the first kept node below it. */
static void sdv__reduced_owners(const sdv_tree *t, const uint32_t *counts, sdv_reduced *r) {
    uint32_t i, n = 0;
    for (i = 0; i < t->node_count; i++) {
        if (sdv__is_kept(t, counts, i)) {
            r->ids[n] = i;
            r->nodes[n] = i;
            r->owners[i] = n++;
        }
    }
    for (i = t->node_count; i-- > 0;) {
        uint32_t node = t->order[i], parent = t->parents[node];
        if (parent != SDV_NONE && !sdv__is_kept(t, counts, parent)) {
            r->owners[parent] = r->owners[node];
        }
    }
}

/* Hangs `children`, ascending, below the kept node k; extra nodes are taken from *extra on. */
static void sdv__reduced_hang(sdv_reduced *r, uint32_t k, int root, const uint32_t *children,
                              uint32_t count, uint32_t first_id, uint32_t first_extra,
                              uint32_t *extra) {
    uint32_t at = k, i = 0;
    while (count - i > (at == k && root ? 1u : 2u)) {
        uint32_t e = (*extra)++, only = at == k && root;
        r->ids[e] = first_id + (e - first_extra);
        r->nodes[e] = r->nodes[k];
        r->parents[e] = at;
        if (!only) {
            r->parents[children[i]] = at;
        }
        r->children[2 * (size_t)at] = only ? e : children[i++];
        r->children[2 * (size_t)at + 1] = only ? SDV_NONE : e;
        at = e;
    }
    for (k = 0; k < 2; k++) {
        uint32_t child = i + k < count ? children[i + k] : SDV_NONE;
        r->children[2 * (size_t)at + k] = child;
        if (child != SDV_NONE) {
            r->parents[child] = at;
        }
    }
}

static void sdv__reduced_fill(const sdv_tree *t, const uint32_t *counts, uint32_t kept,
                              uint32_t *first, uint32_t *list, sdv_reduced *r) {
    uint32_t k, sum = 0, extra = kept, roots = 0, head = 0, tail = 0;
    sdv__reduced_owners(t, counts, r);
    for (k = 0; k < kept; k++) { /* parents and child lists of the kept nodes, ascending */
        first[k] = sum;
        sum += counts[r->ids[k]];
    }
    for (k = 0; k < kept; k++) {
        uint32_t up = t->parents[r->ids[k]];
        while (up != SDV_NONE && !sdv__is_kept(t, counts, up)) {
            up = t->parents[up];
        }
        r->parents[k] = SDV_NONE;
        if (up != SDV_NONE) {
            list[first[r->owners[up]]++] = k;
        } else {
            r->roots[roots++] = k;
        }
    }
    for (k = 0; k < kept; k++) {
        uint32_t n = counts[r->ids[k]], root = t->parents[r->ids[k]] == SDV_NONE;
        sdv__reduced_hang(r, k, (int)root, list + (first[k] - n), n, t->node_count, kept, &extra);
    }
    for (k = 0; k < roots; k++) {
        r->order[tail++] = r->roots[k];
    }
    for (; head < tail; head++) {
        for (k = 0; k < 2; k++) {
            uint32_t child = r->children[2 * (size_t)r->order[head] + k];
            if (child != SDV_NONE) {
                r->order[tail++] = child;
            }
        }
    }
}

SDV_API lao_result sdv_reduce(const sdv_host *host, const sdv_tree *tree, sdv_reduced *reduced) {
    lao_allocator a = sdv__allocator(host);
    lao__block block = {NULL, 0};
    sdv_reduced r;
    uint32_t i, kept = 0, *scratch;
    uint64_t n;
    if (!tree || !reduced || !tree->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_reduce");
    }
    n = tree->node_count;
    scratch = (uint32_t *)lao__take(&a, 3 * n, sizeof *scratch); /* counts, first, list */
    if (!scratch) {
        return sdv__fail(host, SDV_LOG_MEMORY, "reducing a tree of %u nodes", tree->node_count);
    }
    memset(&r, 0, sizeof r);
    r.allocator = a;
    sdv__count_children(tree, scratch);
    for (i = 0; i < tree->node_count; i++) {
        kept += (uint32_t)sdv__is_kept(tree, scratch, i);
        r.node_count += sdv__extra_count(tree, scratch, i);
        r.root_count += tree->parents[i] == SDV_NONE;
    }
    r.node_count += kept;
    sdv__reduced_parts(&r, tree->node_count, &block);
    r.memory = lao__take(&a, block.used, 1);
    if (!r.memory) {
        lao__give(&a, scratch);
        return sdv__fail(host, SDV_LOG_MEMORY, "a reduced tree of %u nodes", r.node_count);
    }
    block.base = (unsigned char *)r.memory;
    block.used = 0;
    sdv__reduced_parts(&r, tree->node_count, &block);
    sdv__reduced_fill(tree, scratch, kept, scratch + n, scratch + 2 * n, &r);
    lao__give(&a, scratch);
    *reduced = r;
    return LAO_OK;
}

SDV_API void sdv_reduced_free(sdv_reduced *reduced) {
    if (reduced && reduced->memory) {
        lao__give(&reduced->allocator, reduced->memory);
        memset(reduced, 0, sizeof *reduced);
    }
}

/* ---- radial layout (METHODS 8) */

typedef struct sdv__layout_work {
    const sdv_reduced *r;
    double *h, *s, *low, *high, *weight;
    double ph;
} sdv__layout_work;

static double sdv__scalar(const float *scalars, uint32_t node) {
    double v = scalars ? (double)scalars[node] : 1.0;
    return v > 0.0 && v <= 3.5e38 ? v : 0.0;
}

/* Weights (METHODS 8): the sum over the sub-tree, in the reduced tree or in the whole one. Extra
   nodes count as nodes and carry no scalar. */
static void sdv__layout_weights(const sdv_tree *t, const sdv_layout_desc *desc,
                                sdv__layout_work *w) {
    const sdv_reduced *r = w->r;
    uint32_t i, n = r->node_count, own = desc->flags & SDV_LAYOUT_OWN;
    double least = 0;
    for (i = 0; i < n; i++) {
        int extra = r->ids[i] >= t->node_count;
        w->weight[i] =
            !extra || own ? sdv__scalar(desc->scalars, r->nodes[i]) : (desc->scalars ? 0.0 : 1.0);
    }
    for (i = 0; !own && (desc->flags & SDV_LAYOUT_ALL_NODES) && i < t->node_count; i++) {
        if (r->ids[r->owners[i]] != i) {
            w->weight[r->owners[i]] += sdv__scalar(desc->scalars, i);
        }
    }
    for (i = n; !own && i-- > 0;) {
        uint32_t node = r->order[i], parent = r->parents[node];
        if (parent != SDV_NONE) {
            w->weight[parent] += w->weight[node];
        }
    }
    for (i = 0; i < n; i++) {
        if (w->weight[i] > 0 && (least == 0 || w->weight[i] < least)) {
            least = w->weight[i];
        }
    }
    for (i = 0; i < n; i++) {
        if (!(w->weight[i] > 0)) {
            w->weight[i] = least > 0 ? least : 1.0;
        }
    }
}

/* Roots and their children lie at the same place; several roots share [0, 1]. */
static void sdv__layout_start(sdv__layout_work *w) {
    const sdv_reduced *r = w->r;
    double sum = 0, at = 0;
    uint32_t i;
    for (i = 0; i < r->root_count; i++) {
        sum += w->weight[r->roots[i]];
    }
    for (i = 0; i < r->root_count; i++) {
        uint32_t root = r->roots[i], child = r->children[2 * (size_t)root];
        double low = at / sum;
        at += w->weight[root];
        w->low[root] = low;
        w->high[root] = i + 1 == r->root_count ? 1.0 : at / sum;
        w->h[root] = 0.5 * (low + w->high[root]);
        w->s[root] = 1.0;
        if (child != SDV_NONE) {
            w->low[child] = low;
            w->high[child] = w->high[root];
            w->h[child] = w->h[root];
            w->s[child] = 1.0;
        }
    }
}

/* Algorithm 1, lines 3 to 12, for one node with two children. */
static void sdv__layout_children(sdv__layout_work *w, uint32_t n) {
    uint32_t c1 = w->r->children[2 * (size_t)n], c2 = w->r->children[2 * (size_t)n + 1];
    double w1 = w->weight[c1], w2 = w->weight[c2], r1 = w->low[n], r2 = w->high[n];
    double less = w1 < w2 ? w1 / w2 : w2 / w1, more = w1 < w2 ? w2 / w1 : w1 / w2;
    double share = w1 / (w1 + w2), exponent = w->ph * more;
    double wr = pow(less, exponent < 1e6 ? exponent : 1e6);
    double middle = r1 + (r2 - r1) * share;
    double m1 = (wr - 1) * (0.5 * (r1 + middle) - w->h[n]);
    double m2 = (wr - 1) * (0.5 * (middle + r2) - w->h[n]);
    w->s[c1] = w->s[n] - (w1 < w2 ? sqrt(less) : 1.0);
    w->s[c2] = w->s[n] - (w2 < w1 ? sqrt(less) : 1.0);
    w->low[c1] = r1 + m1;
    w->high[c1] = middle + m1;
    w->low[c2] = middle + m2;
    w->high[c2] = r2 + m2;
    w->h[c1] = 0.5 * (w->low[c1] + w->high[c1]);
    w->h[c2] = 0.5 * (w->low[c2] + w->high[c2]);
}

static void sdv__layout_parts(sdv_layout *l, lao__block *block) {
    l->h = (float *)lao__part(block, l->node_count, sizeof(float));
    l->s = (float *)lao__part(block, l->node_count, sizeof(float));
    l->weights = (float *)lao__part(block, l->node_count, sizeof(float));
}

static void sdv__layout_finish(const sdv__layout_work *w, sdv_layout *l) {
    uint32_t i;
    double least = 1.0;
    for (i = 0; i < l->node_count; i++) {
        least = w->s[i] < least ? w->s[i] : least;
    }
    for (i = 0; i < l->node_count; i++) {
        double s = least < 1.0 ? (w->s[i] - least) / (1.0 - least) : 1.0;
        double h = w->h[i] < 0.0 ? 0.0 : w->h[i] > 1.0 ? 1.0 : w->h[i];
        l->h[i] = (float)h;
        l->s[i] = (float)s;
        l->weights[i] = (float)w->weight[i];
    }
}

SDV_API lao_result sdv_layout_make(const sdv_host *host, const sdv_tree *tree,
                                   const sdv_reduced *reduced, const sdv_layout_desc *desc,
                                   sdv_layout *layout) {
    const sdv_layout_desc standard = {NULL, 0, 0, 0};
    sdv__layout_work w;
    lao__block block = {NULL, 0};
    sdv_layout l;
    double *scratch;
    uint32_t i;
    if (!tree || !reduced || !layout || !reduced->memory || !tree->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_layout_make");
    }
    desc = desc ? desc : &standard;
    if (desc->has_ph && !(desc->ph >= 0.0f)) {
        return sdv__fail(host, SDV_LOG_LAYOUT_PH, NULL);
    }
    memset(&l, 0, sizeof l);
    l.node_count = reduced->node_count;
    l.allocator = sdv__allocator(host);
    scratch = (double *)lao__take(&l.allocator, 5 * (uint64_t)l.node_count, sizeof *scratch);
    sdv__layout_parts(&l, &block);
    l.memory = scratch ? lao__take(&l.allocator, block.used, 1) : NULL;
    if (!l.memory) {
        lao__give(&l.allocator, scratch);
        return sdv__fail(host, SDV_LOG_MEMORY, "a layout of %u nodes", l.node_count);
    }
    block.base = (unsigned char *)l.memory;
    block.used = 0;
    sdv__layout_parts(&l, &block);
    w.r = reduced;
    w.h = scratch;
    w.s = scratch + l.node_count;
    w.low = scratch + 2 * (size_t)l.node_count;
    w.high = scratch + 3 * (size_t)l.node_count;
    w.weight = scratch + 4 * (size_t)l.node_count;
    w.ph = desc->has_ph ? (double)desc->ph : 4.0 / (double)l.node_count;
    sdv__layout_weights(tree, desc, &w);
    sdv__layout_start(&w);
    for (i = 0; i < l.node_count; i++) {
        if (reduced->children[2 * (size_t)reduced->order[i] + 1] != SDV_NONE) {
            sdv__layout_children(&w, reduced->order[i]);
        }
    }
    sdv__layout_finish(&w, &l);
    lao__give(&l.allocator, scratch);
    *layout = l;
    return LAO_OK;
}

SDV_API void sdv_layout_free(sdv_layout *layout) {
    if (layout && layout->memory) {
        lao__give(&layout->allocator, layout->memory);
        memset(layout, 0, sizeof *layout);
    }
}

/* Formatted text to a writer; a locale's decimal comma becomes a point. Numbers only. */
static int sdv__print(const sdv_writer *writer, const char *format, ...) {
    char text[512];
    va_list list;
    int n;
    va_start(list, format);
    n = vsnprintf(text, sizeof text, format, list);
    va_end(list);
    if (n < 0 || (size_t)n >= sizeof text) {
        n = 0;
    }
    return writer->write(writer->user, text, (size_t)n);
}
/* A number as JSON and SVG want it, in `text`; "null" where it is none. */
enum { SDV__NUMBER = 32 };
static const char *sdv__number(double v, char text[SDV__NUMBER]) {
    char *p;
    if (!(v - v == 0.0)) {
        return "null";
    }
    snprintf(text, SDV__NUMBER, "%.9g", v);
    for (p = text; *p; p++) {
        *p = *p == ',' ? '.' : *p;
    }
    return text;
}

SDV_API int sdv_layout_write_json(const sdv_reduced *reduced, const sdv_layout *layout,
                                  const float *distances, const sdv_writer *writer) {
    uint32_t i;
    int stop = sdv__print(writer, "{\"nodes\":[");
    for (i = 0; !stop && i < reduced->node_count; i++) {
        char h[SDV__NUMBER], s[SDV__NUMBER], w[SDV__NUMBER], d[SDV__NUMBER];
        uint32_t parent = reduced->parents[i];
        stop = sdv__print(
            writer,
            "%s\n{\"id\":%u,\"parent\":%lld,\"h\":%s,\"s\":%s,\"weight\":%s,\"distance\":%s}",
            i ? "," : "", reduced->ids[i],
            parent == SDV_NONE ? -1LL : (long long)reduced->ids[parent],
            sdv__number((double)layout->h[i], h), sdv__number((double)layout->s[i], s),
            sdv__number((double)layout->weights[i], w),
            distances ? sdv__number((double)distances[i], d) : "null");
    }
    return stop ? stop : sdv__print(writer, "\n]}\n");
}

static lao_v2 sdv__layout_place(const sdv_layout *l, const sdv_svg_desc *d, uint32_t i) {
    float margin = 0.03f, free_width = d->width * (1 - 2 * margin),
          free_height = d->height * (1 - 2 * margin);
    if (d->radial) {
        float reach = 0.5f * (free_width < free_height ? free_width : free_height);
        lao_v2 p = sdv_radial(l->h[i], l->s[i]);
        return lao_v2_make(0.5f * d->width + reach * p.x, 0.5f * d->height - reach * p.y);
    }
    return lao_v2_make(d->width * margin + free_width * l->h[i],
                       d->height * margin + free_height * (1 - l->s[i]));
}

static int sdv__svg_edge(const sdv_layout *l, const sdv_svg_desc *d, uint32_t from, uint32_t to,
                         const char *color, float width, const sdv_writer *writer) {
    char text[5][SDV__NUMBER];
    lao_v2 p = sdv__layout_place(l, d, from), q = sdv__layout_place(l, d, to);
    return sdv__print(writer,
                      "<line x1=\"%s\" y1=\"%s\" x2=\"%s\" y2=\"%s\" stroke=\"%s\" "
                      "stroke-width=\"%s\"/>\n",
                      sdv__number((double)p.x, text[0]), sdv__number((double)p.y, text[1]),
                      sdv__number((double)q.x, text[2]), sdv__number((double)q.y, text[3]), color,
                      sdv__number((double)width, text[4]));
}

SDV_API int sdv_layout_write_svg(const sdv_reduced *reduced, const sdv_layout *layout,
                                 const sdv_svg_desc *desc, const sdv_writer *writer) {
    sdv_svg_desc d = {0, 0, 0, 0, NULL, 0};
    char width[SDV__NUMBER], height[SDV__NUMBER];
    uint32_t i, round;
    int stop;
    d = desc ? *desc : d;
    d.width = d.width > 0 ? d.width : d.radial ? 768.0f : 1024.0f;
    d.height = d.height > 0 ? d.height : d.radial ? 768.0f : 512.0f;
    d.line_width = d.line_width > 0 ? d.line_width : 2.0f;
    sdv__number((double)d.width, width);
    sdv__number((double)d.height, height);
    stop = sdv__print(writer,
                      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%s\" height=\"%s\">\n"
                      "<rect width=\"%s\" height=\"%s\" fill=\"#303030\"/>\n"
                      "<g stroke-linecap=\"round\">\n",
                      width, height, width, height);
    for (round = d.distances ? 0 : 1; round < 2; round++) { /* marks, then edges over them */
        for (i = 0; !stop && i < reduced->node_count; i++) {
            char color[16];
            lao_v3 c = sdv_hsv(layout->h[i], layout->s[i], 1.0f);
            int risk = d.distances && d.distances[i] < d.risk;
            if (reduced->parents[i] == SDV_NONE || (round == 0 && !risk)) {
                continue;
            }
            snprintf(color, sizeof color, "#%02x%02x%02x", (unsigned)(c.x * 255.0f + 0.5f),
                     (unsigned)(c.y * 255.0f + 0.5f), (unsigned)(c.z * 255.0f + 0.5f));
            stop = sdv__svg_edge(layout, &d, reduced->parents[i], i, round ? color : "#c03028",
                                 round ? d.line_width : 4 * d.line_width, writer);
        }
    }
    return stop ? stop : sdv__print(writer, "</g>\n</svg>\n");
}

/* ---- as a tree */
typedef struct sdv__drawing {
    const sdv_tree *tree;
    const sdv_reduced *reduced;
    const sdv_layout *layout;
    sdv_svg_desc page;
    float thin, widest; /* half thickness of the thinnest edge; greatest radius of a vessel, mm */
    float *positions, *radii;
    sdv_segment *segments;
    uint32_t node_count, segment_count;
} sdv__drawing;

static void sdv__drawing_put(sdv__drawing *d, uint32_t id, uint32_t node, lao_v2 at) {
    float part = d->widest > 0 ? lao_sqrt(d->tree->nodes[node].w / d->widest) : 0.0f;
    d->positions[3 * (size_t)id] = at.x;
    d->positions[3 * (size_t)id + 1] = d->page.height - at.y;
    d->positions[3 * (size_t)id + 2] = 0.0f;
    d->radii[id] = d->thin * (1.0f + 3.0f * part);
}
static void sdv__drawing_join(sdv__drawing *d, uint32_t parent, uint32_t child) {
    d->segments[d->segment_count].parent = parent;
    d->segments[d->segment_count++].child = child;
}
static float sdv__way(const sdv_tree *t, uint32_t node) {
    const lao_v4 *a = t->nodes + node, *b = t->nodes + t->parents[node];
    lao_v3 way = lao_v3_make(a->x - b->x, a->y - b->y, a->z - b->z);
    return lao_sqrt(lao_v3_dot(way, way));
}
/* The edge above a reduced node, from below, with all nodes of the tree on it. */
static void sdv__drawing_edge(sdv__drawing *d, uint32_t k) {
    const sdv_reduced *r = d->reduced;
    const sdv_tree *t = d->tree;
    uint32_t up = r->parents[k], node = r->nodes[k], end, count = 0, i;
    lao_v2 low = sdv__layout_place(d->layout, &d->page, k), top;
    float way = 0.0f, whole = 0.0f;
    if (up == SDV_NONE || r->ids[k] >= t->node_count) {
        sdv__drawing_put(d, r->ids[k], node, low);
        if (up != SDV_NONE) {
            sdv__drawing_join(d, r->ids[up], r->ids[k]);
        }
        return;
    }
    top = sdv__layout_place(d->layout, &d->page, up);
    end = r->nodes[up];
    for (; node != end; node = t->parents[node]) {
        whole += sdv__way(t, node);
        count++;
    }
    node = r->nodes[k];
    for (i = 0; i < count; i++, node = t->parents[node]) {
        float at = whole > 0.0f ? way / whole : (float)i / (float)count;
        sdv__drawing_put(d, node, node,
                         lao_v2_make(low.x + at * (top.x - low.x), low.y + at * (top.y - low.y)));
        sdv__drawing_join(d, t->parents[node] == end ? r->ids[up] : t->parents[node], node);
        way += sdv__way(t, node);
    }
}
/* The thinnest edge is a 200th of the page, less where edges are many, but never less than 2/5 of
   that. */
static void sdv__drawing_page(sdv__drawing *d, const sdv_drawing_desc *desc) {
    sdv_drawing_desc none = {0, 0, 0, 0};
    float unit, fits;
    uint32_t i;
    desc = desc ? desc : &none;
    d->page.radial = desc->radial;
    d->page.width = desc->width > 0 ? desc->width : desc->radial ? 150.0f : 200.0f;
    d->page.height = desc->height > 0 ? desc->height : desc->radial ? 150.0f : 100.0f;
    unit = lao_min(d->page.width, d->page.height) / 200.0f;
    fits = 0.35f * d->page.width / (float)d->reduced->node_count;
    d->thin = desc->thickness > 0 ? 0.5f * desc->thickness
                                  : lao_min(0.5f * unit, lao_max(fits, 0.2f * unit));
    for (i = 0; i < d->tree->node_count; i++) {
        d->widest = lao_max(d->widest, d->tree->nodes[i].w);
    }
}
SDV_API lao_result sdv_layout_tree(const sdv_host *host, const sdv_tree *tree,
                                   const sdv_reduced *reduced, const sdv_layout *layout,
                                   const sdv_drawing_desc *desc, sdv_tree *drawing) {
    lao_allocator a = sdv__allocator(host);
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    sdv__drawing d;
    sdv_tree_desc out;
    sdv_host silent;
    uint32_t k;
    if (!tree || !reduced || !layout || !drawing || !tree->memory || !reduced->memory ||
        !layout->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_layout_tree");
    }
    memset(&d, 0, sizeof d);
    memset(&out, 0, sizeof out);
    memset(&silent, 0, sizeof silent); /* edges of length 0 are none of the host's business */
    silent.allocator = a;
    d.tree = tree;
    d.reduced = reduced;
    d.layout = layout;
    d.node_count = tree->node_count;
    for (k = 0; k < reduced->node_count; k++) {
        d.node_count += reduced->ids[k] >= tree->node_count;
    }
    d.positions = (float *)lao__take(&a, 3 * (uint64_t)d.node_count, sizeof *d.positions);
    d.radii = (float *)lao__take(&a, d.node_count, sizeof *d.radii);
    d.segments = (sdv_segment *)lao__take(&a, d.node_count, sizeof *d.segments);
    if (d.positions && d.radii && d.segments) {
        sdv__drawing_page(&d, desc);
        for (k = 0; k < reduced->node_count; k++) {
            sdv__drawing_edge(&d, k);
        }
        out.node_count = d.node_count;
        out.positions = d.positions;
        out.radii = d.radii;
        out.segment_count = d.segment_count;
        out.segments = d.segments;
        result = sdv_tree_build(&silent, &out, drawing);
    }
    lao__give(&a, d.positions);
    lao__give(&a, d.radii);
    lao__give(&a, d.segments);
    return result == LAO_OK ? LAO_OK : sdv__fail(host, SDV_LOG_MEMORY, "drawing a layout");
}
