/* ================================================================================================
 * decimate: a mesh of fewer triangles. Uses host, triangle and mesh. */

enum { VSF__MOST_CELLS = 1 << 20 }; /* along an axis */

/* What meets in a cell: the sum of the quadrics of its corners' planes about its middle, and means
   weighted by area. */
typedef struct vsf__cell {
    double planes[6], toward[3], mean[3], weight;
    uint32_t first;  /* vertex */
    uint32_t vertex; /* of the coarser mesh; VSF_NONE: no triangle is left there */
} vsf__cell;

typedef struct vsf__lattice {
    const vsf_mesh *mesh;
    double low[3], span, size; /* mm: corner, longest side, side of a cell */
    uint64_t *keys;            /* per cell, in the order of the vertices: its place */
    uint32_t *cells;           /* per vertex */
    uint32_t *table;           /* hashed: cell + 1 */
    uint32_t mask, count;
    vsf__cell *parts; /* per cell */
} vsf__lattice;

static uint64_t vsf__cell_key(const vsf__lattice *l, const float *p) {
    const double most = (double)VSF__MOST_CELLS;
    uint64_t key = 0;
    int k;
    for (k = 0; k < 3; k++) {
        double at = floor(((double)p[k] - l->low[k]) / l->size);
        at = at < most ? at : most;
        key = key << 21 | (uint64_t)(at > 0 ? at : 0);
    }
    return key;
}
/* Triangles whose corners are in three cells. */
static uint32_t vsf__cells_left(const vsf__lattice *l) {
    const uint32_t *t = l->mesh->triangles;
    uint32_t i, left = 0;
    for (i = 0; i < l->mesh->triangle_count; i++, t += 3) {
        uint32_t a = l->cells[t[0]], b = l->cells[t[1]], c = l->cells[t[2]];
        left += a != b && b != c && c != a;
    }
    return left;
}
/* Gives every vertex its cell, with n of them along the longest axis. */
static void vsf__cells_find(vsf__lattice *l, uint32_t n) {
    uint32_t v;
    l->size = l->span / n;
    l->count = 0;
    memset(l->table, 0, ((size_t)l->mask + 1) * sizeof *l->table);
    for (v = 0; v < l->mesh->vertex_count; v++) {
        uint64_t key = vsf__cell_key(l, l->mesh->positions + 3 * (size_t)v);
        uint32_t at = lao_hash((uint32_t)key ^ lao_hash((uint32_t)(key >> 32))) & l->mask;
        while (l->table[at] && l->keys[l->table[at] - 1] != key) {
            at = (at + 1) & l->mask;
        }
        if (!l->table[at]) {
            l->keys[l->count++] = key;
            l->table[at] = l->count;
        }
        l->cells[v] = l->table[at] - 1;
    }
}
/* The finest lattice with at most `most` triangles. Returns 0, or -1 when the host cancels. */
static int vsf__cells_fit(vsf__progress *progress, vsf__lattice *l, uint32_t most) {
    uint32_t few = 1, many = VSF__MOST_CELLS;
    while (many - few > 1) {
        uint32_t middle = few + (many - few) / 2;
        vsf__cells_find(l, middle);
        if (vsf__cells_left(l) <= most) {
            few = middle;
        } else {
            many = middle;
        }
        if (vsf__tick(progress, 1)) {
            return -1;
        }
    }
    vsf__cells_find(l, few);
    return 0;
}

static void vsf__cell_middle(const vsf__lattice *l, uint32_t cell, double middle[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        uint32_t at = (uint32_t)(l->keys[cell] >> (42 - 21 * k)) & 0x1fffffu;
        middle[k] = l->low[k] + (at + 0.5) * l->size;
    }
}
static void vsf__cell_add(const vsf__lattice *l, uint32_t v, const double n[3], double area) {
    vsf__cell *c = &l->parts[l->cells[v]];
    double middle[3], p[3], off;
    int k;
    vsf__cell_middle(l, l->cells[v], middle);
    vsf__load(l->mesh->positions + 3 * (size_t)v, p);
    vsf__sub(p, middle, p);
    off = vsf__dot(n, p);
    for (k = 0; k < 3; k++) {
        c->planes[k] += area * n[k] * n[k];
        c->planes[3 + k] += area * n[k] * n[(k + 1) % 3]; /* xy, yz, zx */
        c->toward[k] += area * off * n[k];
        c->mean[k] += area * p[k];
    }
    c->weight += area;
}
/* Quadrics of all corners, and a number for each cell in which a triangle that stays has one.
   Returns how many there are. */
static uint32_t vsf__cells_sum(vsf__lattice *l, uint32_t *triangles, uint32_t *sources) {
    const uint32_t *t = l->mesh->triangles;
    uint32_t i, k, vertices = 0, left = 0;
    memset(l->parts, 0, (size_t)l->count * sizeof *l->parts);
    for (i = 0; i < l->count; i++) {
        l->parts[i].first = l->parts[i].vertex = VSF_NONE;
    }
    for (i = 0; i < l->mesh->triangle_count; i++, t += 3) {
        uint32_t cell[3];
        double p[3][3], n[3], area;
        for (k = 0; k < 3; k++) {
            cell[k] = l->cells[t[k]];
            vsf__load(l->mesh->positions + 3 * (size_t)t[k], p[k]);
        }
        area = vsf__face(p[0], p[1], p[2], n);
        for (k = 0; k < 3; k++) {
            vsf__cell_add(l, t[k], n, area);
            l->parts[cell[k]].first =
                t[k] < l->parts[cell[k]].first ? t[k] : l->parts[cell[k]].first;
        }
        if (cell[0] == cell[1] || cell[1] == cell[2] || cell[2] == cell[0]) {
            continue;
        }
        for (k = 0; k < 3; k++) {
            vsf__cell *c = &l->parts[cell[k]];
            c->vertex = c->vertex == VSF_NONE ? vertices++ : c->vertex;
            triangles[3 * (size_t)left + k] = c->vertex;
        }
        sources[left++] = i;
    }
    return vertices;
}
/* The place that the quadric likes best, held to the mean by a hundredth of its weight, and within
   a cell's size of it. */
static void vsf__cell_place(const vsf__lattice *l, uint32_t cell, float out[3]) {
    const vsf__cell *c = &l->parts[cell];
    const double hold = 0.01 * c->weight, weight = c->weight > 0 ? c->weight : 1;
    double a[3][3], b[3], middle[3], cross[3][3], det;
    int k, j;
    for (k = 0; k < 3; k++) {
        a[k][k] = c->planes[k] + hold;
        a[k][(k + 1) % 3] = a[(k + 1) % 3][k] = c->planes[3 + k];
        b[k] = c->toward[k] + hold * c->mean[k] / weight;
    }
    for (k = 0; k < 3; k++) {
        vsf__cross(a[(k + 1) % 3], a[(k + 2) % 3], cross[k]);
    }
    det = vsf__dot(a[0], cross[0]);
    vsf__cell_middle(l, cell, middle);
    for (k = 0; k < 3; k++) {
        double at = 0, mean = c->mean[k] / weight;
        for (j = 0; j < 3; j++) {
            at += cross[j][k] * b[j];
        }
        at = det > 0 ? at / det : mean;
        at = at > mean - l->size ? at < mean + l->size ? at : mean + l->size : mean - l->size;
        out[k] = (float)(middle[k] + at);
    }
}
/* Means of the vertices of each cell, of the numbers alone. */
static void vsf__cells_attribute(const vsf__lattice *l, const vsf_attribute *from, double *sums,
                                 float *to) {
    const uint32_t width = from->components;
    uint32_t v, k, i;
    for (k = 0; k < width; k++) {
        memset(sums, 0, 2 * (size_t)l->count * sizeof *sums);
        for (v = 0; v < l->mesh->vertex_count; v++) {
            double value = (double)from->values[(size_t)v * width + k];
            double *sum = sums + 2 * (size_t)l->cells[v];
            if (fabs(value) < 1e300) {
                sum[0] += value;
                sum[1] += 1;
            }
        }
        for (i = 0; i < l->count; i++) {
            if (l->parts[i].vertex != VSF_NONE) {
                to[(size_t)l->parts[i].vertex * width + k] =
                    (float)(sums[2 * (size_t)i] / sums[2 * (size_t)i + 1]);
            }
        }
    }
}

/* What the coarser mesh is made of. */
typedef struct vsf__coarse {
    float *positions;
    uint32_t *triangles, *sources;
    uint32_t *firsts; /* per vertex: of the finer mesh */
    uint32_t *table;  /* hashed: triangle + 1 */
    uint32_t mask;
    vsf_attribute *attributes;
    double *sums;
} vsf__coarse;

static void vsf__coarse_parts(vsf__coarse *c, const vsf__lattice *l, uint32_t left,
                              lao__block *block) {
    const vsf_mesh *mesh = l->mesh;
    uint32_t i;
    c->positions = lao__part_float(block, 3 * (uint64_t)l->count);
    c->triangles = lao__part_u32(block, 3 * (uint64_t)left);
    c->sources = lao__part_u32(block, left);
    c->firsts = lao__part_u32(block, l->count);
    for (c->mask = 1; c->mask < 2 * (uint64_t)left; c->mask *= 2) {
    }
    c->table = lao__part_u32(block, c->mask--);
    c->sums = (double *)lao__part(block, mesh->attribute_count ? 2 * (uint64_t)l->count : 0,
                                  sizeof(double));
    c->attributes = (vsf_attribute *)lao__part(block, mesh->attribute_count, sizeof(vsf_attribute));
    for (i = 0; i < mesh->attribute_count; i++) {
        float *values = lao__part_float(block, (uint64_t)l->count * mesh->attributes[i].components);
        if (block->base) {
            c->attributes[i] = mesh->attributes[i];
            c->attributes[i].values = values;
        }
    }
}

/* Where a triangle's three vertices are in the table, or would be. */
static uint32_t vsf__fold_find(const vsf__coarse *c, uint32_t triangle) {
    const uint32_t *t = c->triangles + 3 * (size_t)triangle;
    uint32_t sum = t[0] + t[1] + t[2], at, k;
    at = lao_hash(sum ^ lao_hash(t[0] ^ t[1] ^ t[2])) & c->mask;
    for (; c->table[at]; at = (at + 1) & c->mask) {
        const uint32_t *o = c->triangles + 3 * (size_t)(c->table[at] - 1);
        for (k = 0; k < 3 && (t[k] == o[0] || t[k] == o[1] || t[k] == o[2]); k++) {
        }
        if (k == 3) {
            break;
        }
    }
    return at;
}
/* Where a wrinkle was pressed flat two triangles lie on each other, face to face: they go. Returns
   how many triangles are left. */
static uint32_t vsf__drop_folds(vsf__coarse *c, uint32_t count) {
    uint32_t i, k, left = 0;
    memset(c->table, 0, ((size_t)c->mask + 1) * sizeof *c->table);
    for (i = 0; i < count; i++) {
        uint32_t at = vsf__fold_find(c, i);
        const uint32_t *t = c->triangles + 3 * (size_t)i, *o;
        if (!c->table[at]) {
            c->table[at] = i + 1;
            continue;
        }
        o = c->triangles + 3 * (size_t)(c->table[at] - 1);
        k = t[0] == o[0] ? 0 : t[0] == o[1] ? 1 : 2;
        if (c->sources[c->table[at] - 1] != VSF_NONE && t[1] == o[(k + 2) % 3]) {
            c->sources[c->table[at] - 1] = c->sources[i] = VSF_NONE;
        }
    }
    for (i = 0; i < count; i++) {
        if (c->sources[i] != VSF_NONE) {
            memmove(c->triangles + 3 * (size_t)left, c->triangles + 3 * (size_t)i,
                    3 * sizeof *c->triangles);
            c->sources[left++] = c->sources[i];
        }
    }
    return left;
}

/* The mesh of a lattice's cells. */
static lao_result vsf__coarse_build(const vsf_host *host, vsf__lattice *l, vsf__coarse *c,
                                    uint32_t left, vsf_mesh *coarser) {
    const vsf_mesh *mesh = l->mesh;
    vsf_mesh_desc desc;
    lao_result result;
    uint32_t i;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = vsf__cells_sum(l, c->triangles, c->sources);
    desc.positions = c->positions;
    desc.triangle_count = vsf__drop_folds(c, left);
    desc.triangles = c->triangles;
    desc.attributes = c->attributes;
    desc.attribute_count = mesh->attribute_count;
    for (i = 0; i < l->count; i++) {
        if (l->parts[i].vertex != VSF_NONE) {
            vsf__cell_place(l, i, c->positions + 3 * (size_t)l->parts[i].vertex);
            c->firsts[l->parts[i].vertex] = l->parts[i].first;
        }
    }
    for (i = 0; i < mesh->attribute_count; i++) {
        vsf__cells_attribute(l, &mesh->attributes[i], c->sums,
                             (float *)(uintptr_t)c->attributes[i].values); /* ours */
    }
    result = vsf_mesh_build(host, &desc, coarser);
    if (result != LAO_OK) {
        return result;
    }
    for (i = 0; i < coarser->vertex_count; i++) {
        coarser->vertex_sources[i] = mesh->vertex_sources[c->firsts[coarser->vertex_sources[i]]];
    }
    for (i = 0; i < coarser->triangle_count; i++) {
        coarser->triangle_sources[i] =
            mesh->triangle_sources[c->sources[coarser->triangle_sources[i]]];
    }
    coarser->source_count = 0;
    return LAO_OK;
}

static lao_result vsf__decimate_cells(const vsf_host *host, vsf__lattice *l, uint32_t left,
                                      vsf_mesh *coarser) {
    lao_allocator allocator = vsf__allocator(host);
    lao__block block = {NULL, 0};
    vsf__coarse c;
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    void *memory;
    memset(&c, 0, sizeof c);
    vsf__coarse_parts(&c, l, left, &block);
    memory = lao__take(&allocator, block.used, 1);
    l->parts = (vsf__cell *)lao__take(&allocator, l->count, sizeof *l->parts);
    if (memory && l->parts) {
        block.base = (unsigned char *)memory;
        block.used = 0;
        vsf__coarse_parts(&c, l, left, &block);
        result = vsf__coarse_build(host, l, &c, left, coarser);
    }
    lao__give(&allocator, memory);
    lao__give(&allocator, l->parts);
    return result;
}

static void vsf__lattice_parts(vsf__lattice *l, lao__block *block) {
    l->keys = (uint64_t *)lao__part(block, l->mesh->vertex_count, sizeof *l->keys);
    l->cells = lao__part_u32(block, l->mesh->vertex_count);
    l->table = lao__part_u32(block, (uint64_t)l->mask + 1);
}

/* Without words: the caller says what failed. */
static lao_result vsf__decimate(const vsf_host *host, const vsf_mesh *mesh, uint32_t most,
                                vsf_mesh *coarser) {
    lao_allocator allocator = vsf__allocator(host);
    vsf__progress progress = vsf__progress_make(host, 20);
    lao__block block = {NULL, 0};
    vsf__lattice l;
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    void *memory;
    int k;
    memset(&l, 0, sizeof l);
    l.mesh = mesh;
    for (k = 0; k < 3; k++) {
        double side = (double)mesh->info.bounds[1][k] - (double)mesh->info.bounds[0][k];
        l.low[k] = (double)mesh->info.bounds[0][k];
        l.span = side > l.span ? side : l.span;
    }
    for (l.mask = 1; l.mask < 2 * mesh->vertex_count; l.mask *= 2) {
    }
    l.mask--;
    vsf__lattice_parts(&l, &block);
    memory = lao__take(&allocator, block.used, 1);
    if (memory) {
        block.base = (unsigned char *)memory;
        block.used = 0;
        vsf__lattice_parts(&l, &block);
        result = vsf__cells_fit(&progress, &l, most)
                     ? LAO_ERROR_NOT_READY
                     : vsf__decimate_cells(host, &l, vsf__cells_left(&l), coarser);
        lao__give(&allocator, memory);
    }
    return result;
}

VSF_API lao_result vsf_mesh_decimate(const vsf_host *host, const vsf_mesh *mesh, uint32_t most,
                                     vsf_mesh *coarser) {
    vsf_host quiet; /* warnings of the fine mesh need no repetition */
    lao_result result;
    if (!mesh || !mesh->memory || !coarser) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_mesh_decimate");
    }
    if (most < 4) {
        return vsf__fail(host, VSF_LOG_SETTING, "%u triangles to be left, not 4 or more", most);
    }
    memset(&quiet, 0, sizeof quiet);
    if (host) {
        quiet = *host;
        quiet.log = NULL;
    }
    result = vsf__decimate(&quiet, mesh, most, coarser);
    if (result != LAO_OK) {
        return vsf__fail(host,
                         result == LAO_ERROR_OUT_OF_MEMORY ? VSF_LOG_MEMORY
                         : result == LAO_ERROR_NOT_READY   ? VSF_LOG_CANCELLED
                                                           : VSF_LOG_MESH_EMPTY,
                         "decimation of %u triangles to %u", mesh->triangle_count, most);
    }
    return LAO_OK;
}
