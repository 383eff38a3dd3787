/* ================================================================================================
 * smooth: a mesh smoothed and subdivided. Uses host, triangle and mesh. */

/* The neighbours of a vertex, each once: corner by corner the one ahead, and the one behind where
   no triangle lies beyond. Calls back with the half-edge that leads to (or from) the neighbour. */
static uint32_t vsf__neighbour_count(const vsf_mesh *mesh, uint32_t v) {
    uint32_t i, count = 0;
    for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
        uint32_t half = mesh->ring_corners[i];
        count += 1u + (mesh->opposites[vsf__previous(half)] == VSF_NONE);
    }
    return count;
}

typedef struct vsf__smoother {
    const vsf_mesh *mesh;
    uint32_t *starts;     /* vertex_count + 1 */
    uint32_t *neighbours; /* from starts[v] */
    double *weights;      /* sum 1, or all 0 */
    double *from, *to;    /* 3 per vertex */
    double factor;
    int uniform;
} vsf__smoother;

/* Cotangent at the corner `half`, 0 without area. */
static double vsf__cotangent(const vsf_mesh *mesh, uint32_t half) {
    double p[3][3], a[3], b[3], n[3], area2;
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[half], p[0]);
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__next(half)], p[1]);
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__previous(half)], p[2]);
    area2 = vsf__face(p[0], p[1], p[2], n);
    vsf__sub(p[1], p[0], a);
    vsf__sub(p[2], p[0], b);
    return area2 > 0 ? vsf__dot(a, b) / area2 : 0;
}
/* Of the edge of a half-edge: half the cotangents of the angles that look at it. */
static double vsf__edge_weight(const vsf__smoother *s, uint32_t half) {
    uint32_t other = s->mesh->opposites[half];
    double w = 1;
    if (!s->uniform) {
        w = vsf__cotangent(s->mesh, vsf__previous(half));
        w = 0.5 * (w + (other == VSF_NONE ? 0 : vsf__cotangent(s->mesh, vsf__previous(other))));
    }
    return w > 0 ? w : 0;
}
static void vsf__smooth_weights(void *arg, uint32_t first, uint32_t end) {
    vsf__smoother *s = (vsf__smoother *)arg;
    const vsf_mesh *mesh = s->mesh;
    uint32_t v, i;
    for (v = first; v < end; v++) {
        uint32_t slot = s->starts[v];
        double sum = 0;
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t half = mesh->ring_corners[i], behind = vsf__previous(half);
            s->neighbours[slot] = mesh->triangles[vsf__next(half)];
            s->weights[slot++] = vsf__edge_weight(s, half);
            if (mesh->opposites[behind] == VSF_NONE) {
                s->neighbours[slot] = mesh->triangles[behind];
                s->weights[slot++] = vsf__edge_weight(s, behind);
            }
        }
        for (i = s->starts[v]; i < slot; i++) {
            sum += s->weights[i];
        }
        for (i = s->starts[v]; i < slot; i++) {
            s->weights[i] = sum > 0 && !mesh->borders[v] ? s->weights[i] / sum : 0;
        }
    }
}
static void vsf__smooth_step(void *arg, uint32_t first, uint32_t end) {
    vsf__smoother *s = (vsf__smoother *)arg;
    uint32_t v, i;
    int k;
    for (v = first; v < end; v++) {
        const double *p = s->from + 3 * (size_t)v;
        double move[3] = {0, 0, 0};
        for (i = s->starts[v]; i < s->starts[v + 1]; i++) {
            const double *q = s->from + 3 * (size_t)s->neighbours[i];
            for (k = 0; k < 3; k++) {
                move[k] += s->weights[i] * (q[k] - p[k]);
            }
        }
        for (k = 0; k < 3; k++) {
            s->to[3 * (size_t)v + (size_t)k] = p[k] + s->factor * move[k];
        }
    }
}
static int vsf__smooth_run(vsf__progress *progress, vsf__smoother *s, uint32_t steps, double lambda,
                           double mu) {
    uint32_t i, n = s->mesh->vertex_count;
    if (vsf__run(progress, n, VSF__CHUNK, s, vsf__smooth_weights)) {
        return -1;
    }
    for (i = 0; i < 2 * steps; i++) {
        double *swap = s->from;
        s->factor = i % 2 ? mu : lambda;
        if (vsf__run(progress, n, VSF__CHUNK, s, vsf__smooth_step)) {
            return -1;
        }
        s->from = s->to;
        s->to = swap;
    }
    return 0;
}

static lao_result vsf__smooth_checked(const vsf_host *host, vsf_mesh *mesh, uint32_t steps,
                                      double lambda, double mu, int uniform) {
    lao_allocator allocator = vsf__allocator(host);
    vsf__progress progress =
        vsf__progress_make(host, (uint64_t)mesh->vertex_count * (2 * (uint64_t)steps + 2));
    vsf__smoother s;
    lao__block block = {NULL, 0};
    uint64_t n = mesh->vertex_count, round;
    void *memory = NULL;
    size_t i;
    int cancelled;
    memset(&s, 0, sizeof s);
    s.mesh = mesh;
    s.uniform = uniform;
    for (round = 0; round < 2; round++) {
        s.starts = lao__part_u32(&block, n + 1);
        s.neighbours = lao__part_u32(&block, 6 * (uint64_t)mesh->triangle_count);
        s.weights = (double *)lao__part(&block, 6 * (uint64_t)mesh->triangle_count, sizeof(double));
        s.from = (double *)lao__part(&block, 3 * n, sizeof(double));
        s.to = (double *)lao__part(&block, 3 * n, sizeof(double));
        if (round == 0) {
            memory = lao__take(&allocator, block.used, 1);
            if (!memory) {
                return vsf__fail(host, VSF_LOG_MEMORY, "smoothing");
            }
            block.base = (unsigned char *)memory;
            block.used = 0;
        }
    }
    s.starts[0] = 0;
    for (i = 0; i < n; i++) {
        s.starts[i + 1] = s.starts[i] + vsf__neighbour_count(mesh, (uint32_t)i);
    }
    for (i = 0; i < 3 * n; i++) {
        s.from[i] = (double)mesh->positions[i];
    }
    cancelled = vsf__smooth_run(&progress, &s, steps, lambda, mu);
    if (!cancelled) {
        vsf__progress quiet = vsf__progress_make(NULL, 0); /* from here on the mesh changes */
        for (i = 0; i < 3 * n; i++) {
            mesh->positions[i] = (float)s.from[i];
        }
        vsf__mesh_shape(&quiet, mesh);
    }
    lao__give(&allocator, memory);
    return cancelled ? vsf__fail(host, VSF_LOG_CANCELLED, NULL) : LAO_OK;
}
VSF_API lao_result vsf_mesh_smooth(const vsf_host *host, vsf_mesh *mesh,
                                   const vsf_smooth_desc *desc) {
    uint32_t steps = desc && desc->steps ? desc->steps : 20;
    double lambda = desc ? desc->lambda : 0, mu = desc ? desc->mu : 0;
    if (!mesh || !mesh->memory) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_mesh_smooth");
    }
    if (lambda == 0 && mu == 0) {
        lambda = 0.5;
        mu = -0.53;
    }
    if (!(lambda > 0 && lambda < -mu && mu >= -10) || steps > 100000) {
        return vsf__fail(host, VSF_LOG_SETTING,
                         "smoothing wants 0 < lambda < -mu <= 10 and at most 100000 steps, not %g, "
                         "%g and %u",
                         lambda, mu, steps);
    }
    return vsf__smooth_checked(host, mesh, steps, lambda, mu, desc && desc->uniform);
}

/* One level of subdivision: arrays of the finer mesh, for vsf_mesh_build. */
typedef struct vsf__loop {
    const vsf_mesh *mesh;
    uint32_t *edge_vertices; /* per half-edge */
    uint32_t *triangles;
    float *positions;
    vsf_attribute *attributes; /* values are cut from the block */
    uint32_t vertex_count;
} vsf__loop;

static void vsf__loop_parts(vsf__loop *l, lao__block *block) {
    uint32_t i;
    l->edge_vertices = lao__part_u32(block, 3 * (uint64_t)l->mesh->triangle_count);
    l->triangles = lao__part_u32(block, 12 * (uint64_t)l->mesh->triangle_count);
    l->positions = lao__part_float(block, 3 * (uint64_t)l->vertex_count);
    l->attributes =
        (vsf_attribute *)lao__part(block, l->mesh->attribute_count, sizeof(vsf_attribute));
    for (i = 0; i < l->mesh->attribute_count; i++) {
        uint32_t n = l->mesh->attributes[i].components;
        float *values = lao__part_float(block, (uint64_t)l->vertex_count * n);
        if (block->base) {
            l->attributes[i] = l->mesh->attributes[i];
            l->attributes[i].values = values;
        }
    }
}

static uint32_t vsf__edge_count(const vsf_mesh *mesh) {
    uint32_t half, count = 0;
    for (half = 0; half < 3 * mesh->triangle_count; half++) {
        count += mesh->opposites[half] == VSF_NONE || mesh->opposites[half] > half;
    }
    return count;
}

/* Neighbours along borders: how many, and the sum of their places. */
static uint32_t vsf__border_sum(const vsf_mesh *mesh, uint32_t v, double sum[3]) {
    uint32_t i, j, count = 0;
    int k;
    sum[0] = sum[1] = sum[2] = 0;
    for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
        uint32_t half[2];
        half[0] = mesh->ring_corners[i];
        half[1] = vsf__previous(half[0]);
        for (j = 0; j < 2; j++) {
            uint32_t w = mesh->triangles[j ? half[1] : vsf__next(half[0])];
            if (mesh->opposites[half[j]] == VSF_NONE) {
                for (k = 0; k < 3; k++) {
                    sum[k] += (double)mesh->positions[3 * (size_t)w + (size_t)k];
                }
                count++;
            }
        }
    }
    return count;
}
static void vsf__loop_vertex(const vsf__loop *l, uint32_t v) {
    const vsf_mesh *mesh = l->mesh;
    uint32_t i, n = mesh->ring_starts[v + 1] - mesh->ring_starts[v];
    double sum[3] = {0, 0, 0}, keep = 1, each = 0;
    int k;
    if (mesh->borders[v]) {
        uint32_t count = vsf__border_sum(mesh, v, sum);
        keep = count == 2 ? 0.75 : 1;
        each = count == 2 ? 0.125 : 0;
    } else if (n >= 3) {
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t w = mesh->triangles[vsf__next(mesh->ring_corners[i])];
            for (k = 0; k < 3; k++) {
                sum[k] += (double)mesh->positions[3 * (size_t)w + (size_t)k];
            }
        }
        each = n == 3 ? 0.1875 : 0.375 / n;
        keep = 1 - each * n;
    }
    for (k = 0; k < 3; k++) {
        size_t at = 3 * (size_t)v + (size_t)k;
        l->positions[at] = (float)(keep * (double)mesh->positions[at] + each * sum[k]);
    }
}
static void vsf__loop_edge(const vsf__loop *l, uint32_t half) {
    const vsf_mesh *mesh = l->mesh;
    uint32_t other = mesh->opposites[half], made = l->edge_vertices[half], i, k;
    const uint32_t *c = mesh->triangles;
    size_t a = c[half], b = c[vsf__next(half)];
    for (k = 0; k < 3; k++) {
        double p = (double)mesh->positions[3 * a + k] + (double)mesh->positions[3 * b + k];
        if (other == VSF_NONE) {
            p *= 0.5;
        } else {
            size_t d = c[vsf__previous(half)], e = c[vsf__previous(other)];
            p = 0.375 * p +
                0.125 * ((double)mesh->positions[3 * d + k] + (double)mesh->positions[3 * e + k]);
        }
        l->positions[3 * (size_t)made + k] = (float)p;
    }
    for (i = 0; i < mesh->attribute_count; i++) {
        uint32_t n = mesh->attributes[i].components;
        const float *from = mesh->attributes[i].values;
        float *to = (float *)(uintptr_t)l->attributes[i].values;
        for (k = 0; k < n; k++) {
            to[(size_t)made * n + k] = 0.5f * from[a * n + k] + 0.5f * from[b * n + k];
        }
    }
}
static void vsf__loop_fill(vsf__loop *l) {
    const vsf_mesh *mesh = l->mesh;
    uint32_t v, t, i, made = mesh->vertex_count;
    for (v = 0; v < mesh->vertex_count; v++) {
        vsf__loop_vertex(l, v);
    }
    for (i = 0; i < mesh->attribute_count; i++) {
        memcpy((float *)(uintptr_t)l->attributes[i].values, mesh->attributes[i].values,
               (size_t)mesh->vertex_count * mesh->attributes[i].components * sizeof(float));
    }
    for (i = 0; i < 3 * mesh->triangle_count; i++) {
        uint32_t other = mesh->opposites[i];
        if (other != VSF_NONE && other < i) {
            l->edge_vertices[i] = l->edge_vertices[other];
        } else {
            l->edge_vertices[i] = made++;
            vsf__loop_edge(l, i);
        }
    }
    for (t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->triangles + 3 * (size_t)t;
        const uint32_t *e = l->edge_vertices + 3 * (size_t)t;
        uint32_t *to = l->triangles + 12 * (size_t)t;
        for (i = 0; i < 3; i++) { /* a corner with its two edges, and the middle */
            const uint32_t corner[3] = {c[i], e[i], e[(i + 2) % 3]};
            memcpy(to + (size_t)3 * i, corner, sizeof corner);
            to[9 + i] = e[i];
        }
    }
}

static lao_result vsf__subdivide_once(const vsf_host *host, const vsf_mesh *mesh, vsf_mesh *finer) {
    lao_allocator allocator = vsf__allocator(host);
    uint64_t vertices = (uint64_t)mesh->vertex_count + vsf__edge_count(mesh);
    vsf__loop l;
    lao__block block = {NULL, 0};
    vsf_mesh_desc desc;
    lao_result result;
    void *memory;
    uint32_t i;
    if (vertices > 1u << 29 || mesh->triangle_count > 1u << 27) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    memset(&l, 0, sizeof l);
    l.mesh = mesh;
    l.vertex_count = (uint32_t)vertices;
    vsf__loop_parts(&l, &block);
    memory = lao__take(&allocator, block.used, 1);
    if (!memory) {
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    block.base = (unsigned char *)memory;
    block.used = 0;
    vsf__loop_parts(&l, &block);
    vsf__loop_fill(&l);
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = l.vertex_count;
    desc.positions = l.positions;
    desc.triangle_count = 4 * mesh->triangle_count;
    desc.triangles = l.triangles;
    desc.attributes = l.attributes;
    desc.attribute_count = mesh->attribute_count;
    desc.flags = VSF_MESH_KEEP_WINDING; /* unpaired edges got a vertex for each triangle */
    if (!mesh->info.crowded_edges && !mesh->info.twisted_edges) {
        desc.flags |= VSF_MESH_NO_WELD;
    }
    result = vsf_mesh_build(host, &desc, finer);
    for (i = 0; result == LAO_OK && i < finer->vertex_count; i++) {
        uint32_t from = finer->vertex_sources[i];
        finer->vertex_sources[i] =
            from < mesh->vertex_count ? mesh->vertex_sources[from] : VSF_NONE;
    }
    for (i = 0; result == LAO_OK && i < finer->triangle_count; i++) {
        finer->triangle_sources[i] = mesh->triangle_sources[finer->triangle_sources[i] / 4];
    }
    if (result == LAO_OK) {
        finer->source_count = 0;
    }
    lao__give(&allocator, memory);
    return result;
}

VSF_API lao_result vsf_mesh_subdivide(const vsf_host *host, const vsf_mesh *mesh, uint32_t levels,
                                      vsf_mesh *finer) {
    vsf_host quiet; /* warnings of the coarse mesh need no repetition */
    vsf_mesh now, next;
    lao_result result = LAO_OK;
    uint32_t i;
    if (!mesh || !mesh->memory || !finer) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_mesh_subdivide");
    }
    if (levels < 1 || levels > 8) {
        return vsf__fail(host, VSF_LOG_SETTING, "%u levels of subdivision, not 1 to 8", levels);
    }
    memset(&quiet, 0, sizeof quiet);
    if (host) {
        quiet = *host;
        quiet.log = NULL;
    }
    memset(&now, 0, sizeof now);
    for (i = 0; i < levels && result == LAO_OK; i++) {
        result = vsf__subdivide_once(&quiet, i ? &now : mesh, &next);
        if (result == LAO_OK) {
            vsf_mesh_free(&now);
            now = next;
        }
    }
    if (result != LAO_OK) {
        vsf_mesh_free(&now);
        return vsf__fail(host,
                         result == LAO_ERROR_OUT_OF_MEMORY ? VSF_LOG_MEMORY
                         : result == LAO_ERROR_NOT_READY   ? VSF_LOG_CANCELLED
                                                           : VSF_LOG_MESH_COUNT,
                         "subdivision level %u", i);
    }
    *finer = now;
    return LAO_OK;
}
