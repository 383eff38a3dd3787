/* ================================================================================================
 * tree: positions, radii and segments of the host, checked, merged, joined, directed. Uses host. */

/* What building needs until the tree exists. All arrays come from one block. */
typedef struct sdv__build {
    const sdv_host *host;
    const sdv_tree_desc *desc;
    lao_allocator allocator;
    uint32_t *target;      /* per desc node: first node at its position, later its final index */
    uint32_t *source;      /* per node: desc node */
    uint32_t *group;       /* union-find; later the component */
    uint32_t *degree;      /* per node */
    sdv_segment *segments; /* room for joins: + node_count */
    uint32_t *segment_source;
    uint32_t *table; /* hash table */
    uint32_t table_mask;
    uint32_t *first, *incident; /* segments of each node; twice the segments */
    uint32_t *later;            /* segments to be followed backwards */
    unsigned char *turned;      /* per segment */
    uint32_t *entered;          /* per node: segments that enter it */
    uint32_t *next;             /* per node: next in its cell of the join grid */
    float *radius;              /* per node */
    uint32_t node_count, segment_count, root_count, joined;
    sdv_warning warnings[SDV_LOG_ITEM_COUNT];
    uint32_t warning_count;
} sdv__build;

static void sdv__warn(sdv__build *b, sdv_log_item item, uint32_t place) {
    uint32_t i = 0;
    while (i < b->warning_count && b->warnings[i].item != item) {
        i++;
    }
    if (i == b->warning_count) {
        b->warnings[i].item = item;
        b->warnings[i].count = 0;
        b->warnings[i].first = place;
        b->warning_count++;
    }
    b->warnings[i].count++;
}

static lao_result sdv__tree_check(const sdv_host *host, const sdv_tree_desc *desc) {
    const uint32_t most = 1u << 30;
    uint32_t i;
    if (desc->node_count == 0) {
        return sdv__fail(host, SDV_LOG_TREE_EMPTY, NULL);
    }
    if (desc->node_count > most || desc->segment_count > most) {
        return sdv__fail(host, SDV_LOG_TREE_COUNT, NULL);
    }
    if (!desc->positions || (desc->segment_count && !desc->segments) ||
        (desc->node_attribute_count && !desc->node_attributes) ||
        (desc->segment_attribute_count && !desc->segment_attributes)) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "arrays of sdv_tree_desc");
    }
    for (i = 0; i < desc->node_count; i++) {
        const float *p = desc->positions + 3 * (size_t)i;
        if (!(fabsf(p[0]) <= 1e9f && fabsf(p[1]) <= 1e9f && fabsf(p[2]) <= 1e9f)) {
            return sdv__fail(host, SDV_LOG_TREE_POSITION, "node %u", i);
        }
    }
    for (i = 0; i < desc->segment_count; i++) {
        const sdv_segment *s = desc->segments + i;
        if (s->parent >= desc->node_count || s->child >= desc->node_count) {
            return sdv__fail(host, SDV_LOG_TREE_SEGMENT, "segment %u from node %u to node %u", i,
                             s->parent, s->child);
        }
    }
    for (i = 0; i < desc->node_attribute_count + desc->segment_attribute_count; i++) {
        uint32_t n = desc->node_attribute_count;
        const sdv_attribute *a =
            i < n ? desc->node_attributes + i : desc->segment_attributes + (i - n);
        if (!a->name || (!a->values && (i < n || desc->segment_count)) || a->components > 1024) {
            return sdv__fail(host, SDV_LOG_TREE_ATTRIBUTE, "attribute %u of the %s",
                             i < n ? i : i - n, i < n ? "nodes" : "segments");
        }
    }
    return LAO_OK;
}

static void sdv__build_parts(sdv__build *b, lao__block *block) {
    uint64_t n = b->desc->node_count, m = b->desc->segment_count, all = n + m, size = 16;
    while (size < 2 * (n > m ? n : m)) {
        size *= 2;
    }
    b->table_mask = (uint32_t)(size - 1);
    b->target = lao__part_u32(block, n);
    b->source = lao__part_u32(block, n);
    b->group = lao__part_u32(block, n);
    b->degree = lao__part_u32(block, n);
    b->segments = (sdv_segment *)lao__part(block, all, sizeof(sdv_segment));
    b->segment_source = lao__part_u32(block, all);
    b->table = lao__part_u32(block, size);
    b->first = lao__part_u32(block, n + 1);
    b->incident = lao__part_u32(block, 2 * all);
    b->later = lao__part_u32(block, 2 * all);
    b->turned = (unsigned char *)lao__part(block, all, 1);
    b->entered = lao__part_u32(block, n);
    b->next = lao__part_u32(block, n);
    b->radius = (float *)lao__part(block, n, sizeof(float));
}

static uint32_t sdv__mix(uint32_t a, uint32_t b, uint32_t c) {
    return lao_hash(a + lao_hash(b + lao_hash(c)));
}

/* The position's bits, -0 as 0. */
static void sdv__position_bits(const float *p, uint32_t bits[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        bits[k] = lao_float_bits(p[k] + 0.0f);
    }
}

/* target = the first node at the same position */
static void sdv__merge(sdv__build *b) {
    const float *p = b->desc->positions;
    uint32_t i, n = b->desc->node_count;
    for (i = 0; i < n; i++) {
        b->target[i] = i;
    }
    if (!(b->desc->flags & SDV_TREE_MERGE)) {
        return;
    }
    memset(b->table, 0xff, ((size_t)b->table_mask + 1) * sizeof *b->table);
    for (i = 0; i < n; i++) {
        uint32_t bits[3], slot;
        sdv__position_bits(p + 3 * (size_t)i, bits);
        slot = sdv__mix(bits[0], bits[1], bits[2]) & b->table_mask;
        for (; b->table[slot] != SDV_NONE; slot = (slot + 1) & b->table_mask) {
            uint32_t other[3];
            sdv__position_bits(p + 3 * (size_t)b->table[slot], other);
            if (memcmp(bits, other, sizeof bits) == 0) {
                break;
            }
        }
        if (b->table[slot] == SDV_NONE) {
            b->table[slot] = i;
        } else {
            b->target[i] = b->table[slot];
            sdv__warn(b, SDV_LOG_NODES_MERGED, i);
        }
    }
}

/* Segments between merged nodes, each pair once. */
static void sdv__pick_segments(sdv__build *b) {
    uint32_t i;
    memset(b->table, 0xff, ((size_t)b->table_mask + 1) * sizeof *b->table);
    for (i = 0; i < b->desc->segment_count; i++) {
        uint32_t from = b->target[b->desc->segments[i].parent];
        uint32_t to = b->target[b->desc->segments[i].child];
        uint32_t low = from < to ? from : to, high = from < to ? to : from, slot;
        if (from == to) {
            sdv__warn(b, SDV_LOG_SEGMENTS_LOOSE, i);
            continue;
        }
        slot = sdv__mix(low, high, 7) & b->table_mask;
        for (; b->table[slot] != SDV_NONE; slot = (slot + 1) & b->table_mask) {
            const sdv_segment *s = b->segments + b->table[slot];
            if ((s->parent == low && s->child == high) || (s->parent == high && s->child == low)) {
                break;
            }
        }
        if (b->table[slot] != SDV_NONE) {
            sdv__warn(b, SDV_LOG_SEGMENTS_REPEATED, i);
            continue;
        }
        b->table[slot] = b->segment_count;
        b->segments[b->segment_count].parent = from;
        b->segments[b->segment_count].child = to;
        b->segment_source[b->segment_count++] = i;
    }
}

static float sdv__radius(sdv__build *b, uint32_t i) {
    float r = b->desc->radii ? b->desc->radii[i] : 0.0f;
    if (!(r >= 0.0f && r <= 1e9f)) {
        sdv__warn(b, SDV_LOG_RADIUS_MISSING, i);
        return 0.0f;
    }
    if (r == 0.0f && b->desc->radii) {
        sdv__warn(b, SDV_LOG_RADIUS_ZERO, i);
    }
    return r + 0.0f;
}

/* Gives the nodes that stay their final indices, in the order of the desc. */
static void sdv__pick_nodes(sdv__build *b) {
    uint32_t i, n = b->desc->node_count;
    int drop = (b->desc->flags & SDV_TREE_DROP) && b->segment_count > 0;
    memset(b->degree, 0, n * sizeof *b->degree);
    for (i = 0; i < b->segment_count; i++) {
        b->degree[b->segments[i].parent]++;
        b->degree[b->segments[i].child]++;
    }
    for (i = 0; i < n; i++) {
        if (b->target[i] < i) { /* merged: the first one has its index already */
            uint32_t first = b->target[b->target[i]];
            b->target[i] = first;
            if (first != SDV_NONE) {
                float r = sdv__radius(b, i);
                b->radius[first] = r > b->radius[first] ? r : b->radius[first];
            }
        } else if (drop && b->degree[i] == 0) {
            sdv__warn(b, SDV_LOG_NODES_ISOLATED, i);
            b->target[i] = SDV_NONE;
        } else {
            b->degree[b->node_count] = b->degree[i];
            b->radius[b->node_count] = sdv__radius(b, i);
            b->source[b->node_count] = i;
            b->target[i] = b->node_count++;
        }
    }
    for (i = 0; i < b->segment_count; i++) {
        b->segments[i].parent = b->target[b->segments[i].parent];
        b->segments[i].child = b->target[b->segments[i].child];
    }
}

static const float *sdv__build_position(const sdv__build *b, uint32_t node) {
    return b->desc->positions + 3 * (size_t)b->source[node];
}

/* Union-find with path halving; a group is named by its lowest node. */
static uint32_t sdv__group(uint32_t *group, uint32_t i) {
    while (group[i] != i) {
        group[i] = group[group[i]];
        i = group[i];
    }
    return i;
}
static int sdv__unite(uint32_t *group, uint32_t a, uint32_t b) {
    a = sdv__group(group, a);
    b = sdv__group(group, b);
    if (a < b) {
        group[b] = a;
    } else {
        group[a] = b;
    }
    return a != b;
}
static void sdv__group_segments(sdv__build *b) {
    uint32_t i;
    for (i = 0; i < b->node_count; i++) {
        b->group[i] = i;
    }
    for (i = 0; i < b->segment_count; i++) {
        sdv__unite(b->group, b->segments[i].parent, b->segments[i].child);
    }
}

/* ---- joining: spheres lie in hashed cells at least as wide as they are, one grid per power of
   two, so that whatever holds a point is in the 27 cells around it */
static int sdv__sphere_level(float radius) {
    int exponent;
    (void)frexpf(radius, &exponent);
    return exponent; /* radius < 2^exponent = width of the cells */
}
static uint32_t sdv__cell_slot(const sdv__build *b, const float *p, int level, const int step[3]) {
    uint32_t h = (uint32_t)level;
    int k;
    for (k = 0; k < 3; k++) {
        double cell = floor(ldexp((double)p[k], -level)) + step[k];
        uint64_t bits;
        memcpy(&bits, &cell, sizeof bits);
        h = sdv__mix(h, (uint32_t)bits, (uint32_t)(bits >> 32));
    }
    return h & b->table_mask;
}
static double sdv__distance2(const float *p, const float *q) {
    double x = (double)p[0] - (double)q[0], y = (double)p[1] - (double)q[1],
           z = (double)p[2] - (double)q[2];
    return x * x + y * y + z * z;
}
/* The nearest node of another component whose sphere holds the point; SDV_NONE: none. */
static uint32_t sdv__holder(const sdv__build *b, uint32_t end, uint64_t levels) {
    const float *p = sdv__build_position(b, end);
    uint32_t own = sdv__group(b->group, end), best = SDV_NONE;
    double least = 0;
    int level, i;
    for (level = -149; level <= 30; level++) {
        int bit = level < -31 ? 0 : level + 32; /* the smallest share a flag */
        if (!(levels >> bit & 1)) {
            continue;
        }
        for (i = 0; i < 27; i++) {
            int step[3];
            uint32_t node;
            step[0] = i % 3 - 1;
            step[1] = i / 3 % 3 - 1;
            step[2] = i / 9 - 1;
            node = b->table[sdv__cell_slot(b, p, level, step)];
            for (; node != SDV_NONE; node = b->next[node]) {
                double r = (double)b->radius[node];
                double d = sdv__distance2(p, sdv__build_position(b, node));
                if (d <= r * r && sdv__group(b->group, node) != own &&
                    (best == SDV_NONE || d < least || (d == least && node < best))) {
                    best = node;
                    least = d;
                }
            }
        }
    }
    return best;
}
static void sdv__join(sdv__build *b) {
    static const int here[3] = {0, 0, 0};
    uint32_t i, ends = b->node_count;
    uint64_t levels = 0;
    memset(b->table, 0xff, ((size_t)b->table_mask + 1) * sizeof *b->table);
    for (i = 0; i < b->node_count; i++) {
        if (b->radius[i] > 0.0f) {
            int level = sdv__sphere_level(b->radius[i]);
            uint32_t slot = sdv__cell_slot(b, sdv__build_position(b, i), level, here);
            levels |= (uint64_t)1 << (level < -31 ? 0 : level + 32);
            b->next[i] = b->table[slot];
            b->table[slot] = i;
        }
    }
    for (i = 0; i < ends; i++) {
        uint32_t node = b->degree[i] <= 1 ? sdv__holder(b, i, levels) : SDV_NONE;
        if (node != SDV_NONE) {
            sdv__unite(b->group, i, node);
            b->segments[b->segment_count].parent = node;
            b->segments[b->segment_count].child = i;
            b->segment_source[b->segment_count++] = SDV_NONE;
            b->joined++;
            sdv__warn(b, SDV_LOG_LINES_JOINED, b->source[i]);
        }
    }
}

/* The segments of each node, ascending. */
static void sdv__build_incidence(sdv__build *b) {
    uint32_t i, sum = 0;
    memset(b->first, 0, ((size_t)b->node_count + 1) * sizeof *b->first);
    for (i = 0; i < b->segment_count; i++) {
        b->first[b->segments[i].parent]++;
        b->first[b->segments[i].child]++;
    }
    for (i = 0; i <= b->node_count; i++) {
        uint32_t count = i < b->node_count ? b->first[i] : 0;
        b->first[i] = sum;
        sum += count;
    }
    for (i = 0; i < b->segment_count; i++) { /* first = the next free place, */
        b->incident[b->first[b->segments[i].parent]++] = i;
        b->incident[b->first[b->segments[i].child]++] = i;
    }
    for (i = b->node_count; i > 0; i--) { /* and back */
        b->first[i] = b->first[i - 1];
    }
    b->first[0] = 0;
}

static void sdv__tree_parts(const sdv__build *b, sdv_tree *t, lao__block *block) {
    const sdv_tree_desc *desc = b->desc;
    uint64_t n = t->node_count, m = t->segment_count;
    uint32_t i;
    t->nodes = (lao_v4 *)lao__part(block, n, sizeof(lao_v4));
    t->segments = (sdv_segment *)lao__part(block, m, sizeof(sdv_segment));
    t->roots = lao__part_u32(block, t->root_count);
    t->parents = lao__part_u32(block, n);
    t->parent_segments = lao__part_u32(block, n);
    t->components = lao__part_u32(block, n);
    t->order = lao__part_u32(block, n);
    t->child_counts = lao__part_u32(block, n);
    t->node_sources = lao__part_u32(block, n);
    t->segment_sources = lao__part_u32(block, m);
    t->node_targets = lao__part_u32(block, t->source_count);
    t->node_attributes =
        (sdv_attribute *)lao__part(block, t->node_attribute_count, sizeof(sdv_attribute));
    t->segment_attributes =
        (sdv_attribute *)lao__part(block, t->segment_attribute_count, sizeof(sdv_attribute));
    for (i = 0; i < t->node_attribute_count + t->segment_attribute_count; i++) {
        int of_node = i < t->node_attribute_count;
        uint32_t k = of_node ? i : i - t->node_attribute_count;
        const sdv_attribute *from =
            (of_node ? desc->node_attributes : desc->segment_attributes) + k;
        uint32_t components = from->components ? from->components : 1;
        char *name = (char *)lao__part(block, strlen(from->name) + 1, 1);
        float *values = (float *)lao__part(block, (of_node ? n : m) * components, sizeof(float));
        if (block->base) {
            sdv_attribute *to = (of_node ? t->node_attributes : t->segment_attributes) + k;
            memcpy(name, from->name, strlen(from->name) + 1);
            to->name = name;
            to->components = components;
            to->values = values;
        }
    }
}

/* Copies the values of an attribute; a source SDV_NONE has none. */
static void sdv__attribute_copy(const sdv_attribute *from, const sdv_attribute *to,
                                const uint32_t *sources, uint32_t count) {
    float *values = (float *)(uintptr_t)to->values;
    uint32_t i, k, n = to->components;
    for (i = 0; i < count; i++) {
        for (k = 0; k < n; k++) {
            values[(size_t)i * n + k] = sources[i] == SDV_NONE
                                            ? lao_bits_float(0x7fc00000u)
                                            : from->values[(size_t)sources[i] * n + k];
        }
    }
}

/* Per component its root: the lowest node that no segment enters, else the first node of its first
   segment, else the node itself. */
static void sdv__tree_roots(sdv__build *b, sdv_tree *t) {
    uint32_t i, directed = !(b->desc->flags & SDV_TREE_UNDIRECTED);
    uint32_t *root = t->roots;
    for (i = 0; i < t->root_count; i++) {
        root[i] = SDV_NONE;
    }
    for (i = 0; directed && i < t->node_count; i++) {
        if (b->entered[i] == 0 && root[t->components[i]] == SDV_NONE) {
            root[t->components[i]] = i;
        }
    }
    for (i = 0; i < t->segment_count; i++) {
        uint32_t c = t->components[b->segments[i].parent];
        root[c] = root[c] == SDV_NONE ? b->segments[i].parent : root[c];
    }
    for (i = 0; i < t->node_count; i++) {
        uint32_t c = t->components[i];
        root[c] = root[c] == SDV_NONE ? i : root[c];
    }
}

static void sdv__visit(sdv_tree *t, uint32_t node, uint32_t parent, uint32_t segment,
                       uint32_t *tail) {
    t->parents[node] = parent;
    t->parent_segments[node] = segment;
    t->order[(*tail)++] = node;
}

/* Breadth first along the segments; against them only when nothing else is left. */
static void sdv__tree_grow(sdv__build *b, sdv_tree *t) {
    uint32_t undirected = b->desc->flags & SDV_TREE_UNDIRECTED;
    uint32_t i, k, head = 0, tail = 0, later_head = 0, later_tail = 0;
    const uint32_t unseen = SDV_NONE - 1;
    for (i = 0; i < t->node_count; i++) {
        t->parents[i] = unseen;
    }
    for (i = 0; i < t->root_count; i++) {
        sdv__visit(t, t->roots[i], SDV_NONE, SDV_NONE, &tail);
        while (head < tail || later_head < later_tail) {
            if (head == tail) {
                uint32_t e = b->later[later_head++];
                if (t->parents[b->segments[e].parent] == unseen) {
                    b->turned[e] = 1;
                    sdv__visit(t, b->segments[e].parent, b->segments[e].child, e, &tail);
                }
                continue;
            }
            for (k = b->first[t->order[head]]; k < b->first[t->order[head] + 1]; k++) {
                uint32_t node = t->order[head], e = b->incident[k];
                int along = b->segments[e].parent == node;
                uint32_t other = along ? b->segments[e].child : b->segments[e].parent;
                if (t->parents[other] != unseen) {
                    continue;
                }
                if (along || undirected || b->segment_source[e] == SDV_NONE) {
                    b->turned[e] = (unsigned char)!along;
                    sdv__visit(t, other, node, e, &tail);
                } else {
                    b->later[later_tail++] = e;
                }
            }
            head++;
        }
    }
}

/* Final directions: along the tree; loops of undirected segments from the node reached first. */
static void sdv__tree_segments(sdv__build *b, sdv_tree *t) {
    uint32_t i, *place = b->first; /* free by now */
    for (i = 0; i < t->node_count; i++) {
        place[t->order[i]] = i;
    }
    for (i = 0; i < t->segment_count; i++) {
        sdv_segment s = b->segments[i];
        int tree = t->parent_segments[s.parent] == i || t->parent_segments[s.child] == i;
        int undirected = (b->desc->flags & SDV_TREE_UNDIRECTED) || b->segment_source[i] == SDV_NONE;
        if (tree ? b->turned[i] : (undirected && place[s.parent] > place[s.child])) {
            uint32_t swap = s.parent;
            s.parent = s.child;
            s.child = swap;
            if (!undirected) {
                sdv__warn(b, SDV_LOG_SEGMENTS_TURNED, b->segment_source[i]);
            }
        }
        t->segments[i] = s;
        t->segment_sources[i] = b->segment_source[i];
        t->child_counts[s.parent]++;
        if (!tree) {
            sdv__warn(b, SDV_LOG_TREE_LOOPS, b->segment_source[i]);
        }
        if (memcmp(&t->nodes[s.parent], &t->nodes[s.child], 3 * sizeof(float)) == 0) {
            sdv__warn(b, SDV_LOG_SEGMENTS_ZERO, b->segment_source[i]);
        }
    }
}

static void sdv__tree_nodes(const sdv__build *b, sdv_tree *t) {
    uint32_t i, k;
    for (i = 0; i < t->node_count; i++) {
        const float *p = sdv__build_position(b, i);
        t->nodes[i].x = p[0] + 0.0f;
        t->nodes[i].y = p[1] + 0.0f;
        t->nodes[i].z = p[2] + 0.0f;
        t->nodes[i].w = b->radius[i];
        t->node_sources[i] = b->source[i];
        t->child_counts[i] = 0;
    }
    memcpy(t->node_targets, b->target, t->source_count * sizeof *b->target);
    for (k = 0; k < t->node_attribute_count; k++) {
        sdv__attribute_copy(b->desc->node_attributes + k, t->node_attributes + k, t->node_sources,
                            t->node_count);
    }
    for (k = 0; k < t->segment_attribute_count; k++) {
        sdv__attribute_copy(b->desc->segment_attributes + k, t->segment_attributes + k,
                            b->segment_source, t->segment_count);
    }
}

static void sdv__tree_components(sdv__build *b, sdv_tree *t) {
    uint32_t i, n = 0;
    for (i = 0; i < t->node_count;
         i++) { /* a group is named by its lowest node, which comes first */
        uint32_t g = sdv__group(b->group, i);
        t->components[i] = g == i ? n++ : t->components[g];
    }
    memset(b->entered, 0, t->node_count * sizeof *b->entered);
    for (i = 0; i < t->segment_count; i++) {
        b->entered[b->segments[i].child] += b->segment_source[i] != SDV_NONE;
    }
}

static void sdv__tree_info(const sdv__build *b, sdv_tree *t) {
    sdv_tree_info *info = &t->info;
    uint32_t i, k, seen = 0;
    memset(info, 0, sizeof *info);
    info->nodes = t->node_count;
    info->segments = t->segment_count;
    info->roots = t->root_count;
    info->loops = t->segment_count + t->root_count - t->node_count;
    info->joined = b->joined;
    for (i = 0; i < t->node_count; i++) {
        uint32_t children = t->child_counts[i];
        info->leaves += children == 0 && t->parents[i] != SDV_NONE;
        info->branches += children >= 2;
        info->multifurcations += children >= 3;
        info->max_children = children > info->max_children ? children : info->max_children;
        for (k = 0; k < 3; k++) {
            float v = sdv__v4_at(t->nodes[i], k);
            info->bounds[0][k] = i == 0 || v < info->bounds[0][k] ? v : info->bounds[0][k];
            info->bounds[1][k] = i == 0 || v > info->bounds[1][k] ? v : info->bounds[1][k];
        }
    }
    for (i = 0; b->desc->radii && i < b->desc->node_count; i++) {
        float r = b->desc->radii[i];
        if (b->target[i] != SDV_NONE && r - r == 0.0f) {
            info->radius[0] = !seen || r < info->radius[0] ? r : info->radius[0];
            info->radius[1] = !seen || r > info->radius[1] ? r : info->radius[1];
            seen = 1;
        }
    }
}

static size_t sdv__warning_text(const sdv_warning *w, char *text, size_t size) {
    int n;
    if (w->first == SDV_NONE) {
        n = snprintf(text, size, "%s (%u)", sdv__items[w->item].text, w->count);
    } else {
        n = snprintf(text, size, "%s (%u, first: %u)", sdv__items[w->item].text, w->count,
                     w->first);
    }
    return (size_t)n;
}
SDV_API size_t sdv_tree_warning_text(const sdv_tree *tree, uint32_t i, char *text, size_t size) {
    if (!tree || i >= tree->warning_count) {
        if (size) {
            text[0] = 0;
        }
        return 0;
    }
    return sdv__warning_text(tree->warnings + i, text, size);
}
static void sdv__tree_warnings(sdv__build *b, sdv_tree *t) {
    uint32_t i;
    for (i = 1; i < t->root_count; i++) {
        sdv__warn(b, SDV_LOG_TREE_ROOTS, t->roots[0]);
    }
    for (i = 0; i < b->warning_count; i++) {
        char text[256];
        if (b->warnings[i].item == SDV_LOG_TREE_ROOTS) {
            b->warnings[i].count = t->root_count;
        }
        sdv__warning_text(b->warnings + i, text, sizeof text);
        if (b->host && b->host->log) {
            b->host->log(b->host->user, b->warnings[i].item, LAO_OK, text);
        }
    }
    memcpy(t->warnings, b->warnings, sizeof t->warnings);
    t->warning_count = b->warning_count;
}

/* The tree from what was picked. */
static lao_result sdv__tree_finish(sdv__build *b, sdv_tree *out) {
    sdv_tree t;
    lao__block block = {NULL, 0};
    uint32_t i;
    memset(&t, 0, sizeof t);
    t.node_count = b->node_count;
    t.segment_count = b->segment_count;
    t.source_count = b->desc->node_count;
    t.node_attribute_count = b->desc->node_attribute_count;
    t.segment_attribute_count = b->desc->segment_attribute_count;
    for (i = 0; i < b->node_count; i++) {
        t.root_count += b->group[i] == i;
    }
    sdv__tree_parts(b, &t, &block);
    t.memory = lao__take(&b->allocator, block.used, 1);
    if (!t.memory) {
        return sdv__fail(b->host, SDV_LOG_MEMORY, "the tree");
    }
    block.base = (unsigned char *)t.memory;
    block.used = 0;
    sdv__tree_parts(b, &t, &block);
    t.allocator = b->allocator;
    sdv__build_incidence(b);
    sdv__tree_nodes(b, &t);
    sdv__tree_components(b, &t);
    sdv__tree_roots(b, &t);
    sdv__tree_grow(b, &t);
    sdv__tree_segments(b, &t);
    sdv__tree_info(b, &t);
    sdv__tree_warnings(b, &t);
    *out = t;
    return LAO_OK;
}

SDV_API lao_result sdv_tree_build(const sdv_host *host, const sdv_tree_desc *desc, sdv_tree *tree) {
    sdv__build b;
    lao__block block = {NULL, 0};
    lao_result result;
    if (!desc || !tree) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_tree_build");
    }
    result = sdv__tree_check(host, desc);
    if (result != LAO_OK) {
        return result;
    }
    memset(&b, 0, sizeof b);
    b.host = host;
    b.desc = desc;
    b.allocator = sdv__allocator(host);
    sdv__build_parts(&b, &block);
    block.base = (unsigned char *)lao__take(&b.allocator, block.used, 1);
    if (!block.base) {
        return sdv__fail(host, SDV_LOG_MEMORY, "building a tree of %u nodes", desc->node_count);
    }
    block.used = 0;
    sdv__build_parts(&b, &block);
    memset(b.turned, 0, (size_t)desc->node_count + desc->segment_count);
    sdv__merge(&b);
    sdv__pick_segments(&b);
    sdv__pick_nodes(&b);
    sdv__group_segments(&b);
    if (desc->flags & SDV_TREE_JOIN) {
        sdv__join(&b);
    }
    result = sdv__tree_finish(&b, tree);
    lao__give(&b.allocator, block.base);
    return result;
}

SDV_API void sdv_tree_free(sdv_tree *tree) {
    if (tree && tree->memory) {
        lao__give(&tree->allocator, tree->memory);
        memset(tree, 0, sizeof *tree);
    }
}
