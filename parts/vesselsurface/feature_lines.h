/* ================================================================================================
 * feature_lines: contours and suggestive contours as lines on the mesh. Uses host, triangle, mesh
   and measure. */

/* Per vertex: the function whose zeros are wanted, and two that must be positive on the way: the
   slope towards the viewer above the threshold, and n.v. */
typedef struct vsf__features {
    const vsf_mesh *mesh;
    const float *zero;
    float *slope, *facing;
    unsigned char *seen; /* per triangle */
    float threshold;
    int suggestive;
    float *points, *values; /* of the lines, NULL: count only */
    uint32_t *offsets;
    uint32_t point_count, line_count;
} vsf__features;

static void vsf__slopes(void *arg, uint32_t first, uint32_t end) {
    const vsf__measurer *m = (const vsf__measurer *)arg;
    uint32_t v;
    for (v = first; v < end; v++) {
        const float *p = m->buffers->points + 4 * (size_t)v;
        const float *normal = m->buffers->normals + 4 * (size_t)v;
        double g[3], w[3], n[3], l;
        int k;
        vsf__load(normal, n);
        for (k = 0; k < 3; k++) {
            const float eye[3] = {m->eye.x, m->eye.y, m->eye.z};
            w[k] = (double)eye[k] - (double)m->eye.w * (double)p[k];
        }
        l = vsf__dot(n, w);
        for (k = 0; k < 3; k++) {
            w[k] -= l * n[k];
        }
        vsf__unit(w);
        vsf__gradient(m->buffers, m->values, v, g);
        m->out[v] = (float)vsf__dot(w, g);
    }
}

/* Where a triangle's segment crosses its half-edges: returns 0 without one; `half[0]` is where it
   comes in, with the positive side to the left. Zero counts as positive. */
static int vsf__crossing(const vsf__features *f, uint32_t t, uint32_t half[2]) {
    int found = 0, k;
    for (k = 0; k < 3; k++) {
        uint32_t h = 3 * t + (uint32_t)k;
        int from = f->zero[f->mesh->triangles[h]] >= 0,
            to = f->zero[f->mesh->triangles[vsf__next(h)]] >= 0;
        if (from != to) {
            half[from ? 0 : 1] = h;
            found = 1;
        }
    }
    return found;
}

/* A place on an edge: its point, and the two functions there. */
typedef struct vsf__place {
    double p[3], slope, facing;
} vsf__place;
static vsf__place vsf__place_on(const vsf__features *f, uint32_t half) {
    uint32_t a = f->mesh->triangles[half], b = f->mesh->triangles[vsf__next(half)];
    vsf__place place;
    double u;
    int k;
    if (a > b) { /* the same bits from both sides */
        uint32_t c = a;
        a = b;
        b = c;
    }
    u = (double)f->zero[a] / ((double)f->zero[a] - (double)f->zero[b]);
    for (k = 0; k < 3; k++) {
        double from = (double)f->mesh->positions[3 * (size_t)a + (size_t)k];
        double to = (double)f->mesh->positions[3 * (size_t)b + (size_t)k];
        place.p[k] = from + u * (to - from);
    }
    place.slope =
        f->suggestive ? (double)f->slope[a] + u * ((double)f->slope[b] - (double)f->slope[a]) : 0;
    place.facing = f->suggestive
                       ? (double)f->facing[a] + u * ((double)f->facing[b] - (double)f->facing[a])
                       : 1;
    return place;
}
static void vsf__feature_point(vsf__features *f, const vsf__place *a, const vsf__place *b,
                               double u) {
    int k;
    if (f->points) {
        for (k = 0; k < 3; k++) {
            f->points[3 * (size_t)f->point_count + (size_t)k] =
                (float)(a->p[k] + u * (b->p[k] - a->p[k]));
        }
        f->values[f->point_count] = (float)(a->slope + u * (b->slope - a->slope));
    }
    f->point_count++;
}
static void vsf__feature_end(vsf__features *f, uint32_t *first) {
    if (f->point_count > *first + 1) {
        f->line_count++;
    } else {
        f->point_count = *first; /* a single point is no line */
    }
    if (f->offsets) {
        f->offsets[f->line_count] = f->point_count;
    }
    *first = f->point_count;
}
/* The part of a -> b on which a linear function from g to h is positive, cut from [from, to]. */
static void vsf__keep_positive(double g, double h, double *from, double *to) {
    if (!(g > 0) && !(h > 0)) {
        *to = *from;
    } else if (!(g > 0)) {
        double u = g / (g - h);
        *from = u > *from ? u : *from;
    } else if (!(h > 0)) {
        double u = g / (g - h);
        *to = u < *to ? u : *to;
    }
}
/* Appends the wanted part of a segment to the open line that began at point `first`. */
static void vsf__feature_segment(vsf__features *f, const vsf__place *a, const vsf__place *b,
                                 uint32_t *first) {
    double from = 0, to = 1;
    if (f->suggestive) {
        vsf__keep_positive(a->slope - (double)f->threshold, b->slope - (double)f->threshold, &from,
                           &to);
        vsf__keep_positive(a->facing, b->facing, &from, &to);
    }
    if (!(from < to)) {
        vsf__feature_end(f, first);
        return;
    }
    if (from > 0 || f->point_count == *first) {
        vsf__feature_end(f, first);
        vsf__feature_point(f, a, b, from);
    }
    vsf__feature_point(f, a, b, to);
    if (to < 1) {
        vsf__feature_end(f, first);
    }
}

/* Follows the zero set through triangle t back to where it begins, then from there to its end. */
static void vsf__feature_trace(vsf__features *f, uint32_t t) {
    const uint32_t *opposites = f->mesh->opposites;
    uint32_t half[2] = {0, 0}, start = t, first = f->point_count, from;
    vsf__place a, b;
    for (;;) {
        vsf__crossing(f, start, half);
        from = opposites[half[0]];
        if (from == VSF_NONE || from / 3 == t) {
            break;
        }
        start = from / 3;
    }
    from = half[0];
    a = vsf__place_on(f, from);
    for (t = start; !f->seen[t]; t = opposites[half[1]] / 3) {
        f->seen[t] = 1;
        vsf__crossing(f, t, half);
        b = vsf__place_on(f, half[1]);
        vsf__feature_segment(f, &a, &b, &first);
        a = b;
        if (opposites[half[1]] == VSF_NONE) {
            break;
        }
    }
    vsf__feature_end(f, &first);
}

static void vsf__feature_all(vsf__features *f) {
    uint32_t t, half[2];
    f->point_count = f->line_count = 0;
    memset(f->seen, 0, f->mesh->triangle_count);
    for (t = 0; t < f->mesh->triangle_count; t++) {
        if (!f->seen[t] && vsf__crossing(f, t, half)) {
            vsf__feature_trace(f, t);
        }
    }
}

static lao_result vsf__features_out(const vsf_host *host, vsf__features *f, vsf_polylines *lines) {
    vsf_polylines out;
    lao__block block = {NULL, 0};
    int round;
    memset(&out, 0, sizeof out);
    out.allocator = vsf__allocator(host);
    vsf__feature_all(f);
    out.line_count = f->line_count;
    out.point_count = f->point_count;
    for (round = 0; round < 2; round++) {
        out.offsets = lao__part_u32(&block, (uint64_t)f->line_count + 1);
        /* room for the single points that are taken back */
        out.points = lao__part_float(&block, 3 * ((uint64_t)f->point_count + 2));
        out.values = lao__part_float(&block, (uint64_t)f->point_count + 2);
        if (round == 0) {
            out.memory = lao__take(&out.allocator, block.used, 1);
            if (!out.memory) {
                return vsf__fail(host, VSF_LOG_MEMORY, "%u points of lines", f->point_count);
            }
            block.base = (unsigned char *)out.memory;
            block.used = 0;
        }
    }
    f->offsets = out.offsets;
    f->points = out.points;
    f->values = out.values;
    out.offsets[0] = 0;
    vsf__feature_all(f);
    *lines = out;
    return LAO_OK;
}

VSF_API lao_result vsf_feature_lines(const vsf_host *host, const vsf_mesh *mesh,
                                     const vsf_buffers *buffers, const float eye[4],
                                     vsf_feature feature, float threshold, vsf_polylines *lines) {
    lao_allocator allocator = vsf__allocator(host);
    vsf__features f;
    vsf__progress progress;
    vsf__measurer m;
    float *values;
    size_t n;
    uint32_t v;
    lao_result result;
    if (!mesh || !mesh->memory || !buffers || !buffers->memory || !eye || !lines) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_feature_lines");
    }
    if (vsf__eye_bad(eye) || !(threshold >= 0 && threshold <= 3e38f) ||
        buffers->vertex_count != mesh->vertex_count) {
        return vsf__fail(host, VSF_LOG_SETTING,
                         "the eye, the threshold, or buffers of another mesh");
    }
    memset(&f, 0, sizeof f);
    n = mesh->vertex_count;
    values = (float *)lao__take(&allocator, 3 * (uint64_t)n, sizeof(float));
    f.seen = (unsigned char *)lao__take(&allocator, mesh->triangle_count, 1);
    if (!values || !f.seen) {
        lao__give(&allocator, values);
        lao__give(&allocator, f.seen);
        return vsf__fail(host, VSF_LOG_MEMORY, "feature lines");
    }
    f.mesh = mesh;
    f.slope = values + n;
    f.facing = values + 2 * n;
    f.threshold = threshold;
    f.suggestive = feature == VSF_SUGGESTIVE_CONTOURS;
    m = vsf__measurer_make(buffers, eye, 0, values);
    progress = vsf__progress_make(host, 2 * (uint64_t)n);
    for (v = 0; v < mesh->vertex_count; v++) {
        f.facing[v] = vsf_light(m.eye, vsf__xyz(vsf__texel(buffers->points, v)),
                                vsf__xyz(vsf__texel(buffers->normals, v)), false);
    }
    f.zero = f.suggestive ? values : f.facing;
    result = f.suggestive &&
                     vsf__run(&progress, mesh->vertex_count, VSF__CHUNK, &m, vsf__measure_vertices)
                 ? LAO_ERROR_NOT_READY
                 : LAO_OK;
    m.values = values;
    m.out = f.slope;
    if (result == LAO_OK && f.suggestive &&
        vsf__run(&progress, mesh->vertex_count, VSF__CHUNK, &m, vsf__slopes)) {
        result = LAO_ERROR_NOT_READY;
    }
    result = result == LAO_OK ? vsf__features_out(host, &f, lines)
                              : vsf__fail(host, VSF_LOG_CANCELLED, NULL);
    lao__give(&allocator, values);
    lao__give(&allocator, f.seen);
    return result;
}

VSF_API void vsf_polylines_free(vsf_polylines *lines) {
    if (lines && lines->memory) {
        lao__give(&lines->allocator, lines->memory);
    }
    if (lines) {
        memset(lines, 0, sizeof *lines);
    }
}
