/* ================================================================================================
 * measure: curvatures, what a device reads of a mesh, and how convex it is towards the viewer. Uses
   host, triangle, mesh and smooth. */

/* ---- curvatures */
typedef struct vsf__curver {
    const vsf_mesh *mesh;
    float *curvatures, *directions;
} vsf__curver;

/* Second fundamental form of a face in its frame (u, v): least squares over the three edges of
   II(e) = difference of normals. Returns 0, or -1 without area. */
static int vsf__face_form(const double p[3][3], const double n[3][3], double u[3], double v[3],
                          double normal[3], double form[3]) {
    double uu = 0, uv = 0, vv = 0, r0 = 0, r1 = 0, r2 = 0, m, det;
    int k;
    if (!(vsf__face(p[0], p[1], p[2], normal) > 0)) {
        return -1;
    }
    vsf__sub(p[1], p[0], u);
    vsf__unit(u);
    vsf__cross(normal, u, v);
    for (k = 0; k < 3; k++) {
        double e[3], d[3], eu, ev, du, dv;
        vsf__sub(p[(k + 1) % 3], p[k], e);
        vsf__sub(n[(k + 1) % 3], n[k], d);
        eu = vsf__dot(e, u);
        ev = vsf__dot(e, v);
        du = vsf__dot(d, u);
        dv = vsf__dot(d, v);
        uu += eu * eu;
        uv += eu * ev;
        vv += ev * ev;
        r0 += du * eu;
        r1 += du * ev + dv * eu;
        r2 += dv * ev;
    }
    m = uu + vv; /* [uu uv 0; uv m uv; 0 uv vv] form = r */
    det = uu * (m * vv - uv * uv) - uv * uv * vv;
    if (!(fabs(det) > 0)) {
        return -1;
    }
    form[0] = (r0 * (m * vv - uv * uv) - uv * (r1 * vv - uv * r2)) / det;
    form[1] = (uu * (r1 * vv - uv * r2) - r0 * uv * vv) / det;
    form[2] = (uu * (m * r2 - uv * r1) - uv * (uv * r2) + r0 * uv * uv) / det;
    return 0;
}

/* Eigenvalues and first direction of a symmetric form in the plane across the unit vector n. */
static void vsf__principal(const double n[3], double form[3][3], double k[2], double direction[3]) {
    double t[3] = {0, 0, 0}, s[3], a = 0, b = 0, c = 0, angle, spread;
    int i, j,
        least = fabs(n[0]) <= fabs(n[1]) && fabs(n[0]) <= fabs(n[2]) ? 0
                : fabs(n[1]) <= fabs(n[2])                           ? 1
                                                                     : 2;
    t[least] = 1;
    vsf__cross(n, t, s);
    vsf__unit(s);
    vsf__cross(s, n, t);
    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) {
            a += t[i] * form[i][j] * t[j];
            b += t[i] * form[i][j] * s[j];
            c += s[i] * form[i][j] * s[j];
        }
    }
    spread = sqrt(0.25 * (a - c) * (a - c) + b * b);
    k[0] = 0.5 * (a + c) + spread;
    k[1] = 0.5 * (a + c) - spread;
    angle = 0.5 * atan2(2 * b, a - c);
    for (i = 0; i < 3; i++) {
        direction[i] = cos(angle) * t[i] + sin(angle) * s[i];
    }
}

static void vsf__curve(void *arg, uint32_t first, uint32_t end) {
    const vsf__curver *c = (const vsf__curver *)arg;
    const vsf_mesh *mesh = c->mesh;
    uint32_t v, i, k, j;
    for (v = first; v < end; v++) {
        double form[3][3], total = 0, at[3], result[2], direction[3];
        vsf__load(mesh->normals + 3 * (size_t)v, at);
        memset(form, 0, sizeof form);
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t half = mesh->ring_corners[i], corner[3];
            double p[3][3], n[3][3], fu[3], fv[3], fn[3], f[3], areas[3];
            corner[0] = v;
            corner[1] = mesh->triangles[vsf__next(half)];
            corner[2] = mesh->triangles[vsf__previous(half)];
            for (k = 0; k < 3; k++) {
                vsf__load(mesh->positions + 3 * (size_t)corner[k], p[k]);
                vsf__load(mesh->normals + 3 * (size_t)corner[k], n[k]);
            }
            if (vsf__face_form((const double(*)[3])p, (const double(*)[3])n, fu, fv, fn, f) ||
                vsf_turn(fn, at, fu, fu) || vsf_turn(fn, at, fv, fv)) {
                continue;
            }
            vsf_corner_areas(p[0], p[1], p[2], areas);
            total += areas[0];
            for (k = 0; k < 3; k++) {
                for (j = 0; j < 3; j++) {
                    form[k][j] += areas[0] * (f[0] * fu[k] * fu[j] + f[2] * fv[k] * fv[j] +
                                              f[1] * (fu[k] * fv[j] + fv[k] * fu[j]));
                }
            }
        }
        for (k = 0; k < 9; k++) {
            form[k / 3][k % 3] = total > 0 ? form[k / 3][k % 3] / total : 0;
        }
        vsf__principal(at, form, result, direction);
        c->curvatures[2 * (size_t)v] = (float)result[0];
        c->curvatures[2 * (size_t)v + 1] = (float)result[1];
        for (k = 0; c->directions && k < 3; k++) {
            c->directions[3 * (size_t)v + k] = total > 0 ? (float)direction[k] : 0.0f;
        }
    }
}

VSF_API lao_result vsf_curvatures(const vsf_host *host, const vsf_mesh *mesh, float *curvatures,
                                  float *directions) {
    vsf__curver curver;
    vsf__progress progress;
    if (!mesh || !mesh->memory || !curvatures) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_curvatures");
    }
    curver.mesh = mesh;
    curver.curvatures = curvatures;
    curver.directions = directions;
    progress = vsf__progress_make(host, mesh->vertex_count);
    if (vsf__run(&progress, mesh->vertex_count, VSF__CHUNK, &curver, vsf__curve)) {
        return vsf__fail(host, VSF_LOG_CANCELLED, NULL);
    }
    return LAO_OK;
}

/* ---- buffers and the measure */

static const lao_buffer_row vsf__buffer_rows[] = {
#define VSF__ROW(name, format) {#name, format},
    VSF_BUFFERS(VSF__ROW)
#undef VSF__ROW
};
VSF_API const lao_buffer_row *vsf_buffer_rows(uint32_t *count) {
    if (count) {
        *count = (uint32_t)(sizeof vsf__buffer_rows / sizeof vsf__buffer_rows[0]);
    }
    return vsf__buffer_rows;
}

/* The gradient at corner `half` of a triangle, turned to its vertex's normal: `ahead` times
   l(next) - l(here) plus `behind` times l(previous) - l(here). Returns its weight, the corner's
   share of area; 0 where there is none. */
static double vsf__corner_gradient(const vsf_mesh *mesh, uint32_t half, double ahead[3],
                                   double behind[3]) {
    double p[3][3], n[3], face[3], areas[3];
    size_t v = mesh->triangles[half];
    vsf__load(mesh->positions + 3 * v, p[0]);
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__next(half)], p[1]);
    vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__previous(half)], p[2]);
    vsf__load(mesh->normals + 3 * v, n);
    if (!(vsf__dot(n, n) > 0) ||
        !(vsf__gradient_parts(p[0], p[1], p[2], face, ahead, behind) > 0) ||
        vsf_turn(face, n, ahead, ahead) || vsf_turn(face, n, behind, behind)) {
        return 0;
    }
    vsf_corner_areas(p[0], p[1], p[2], areas);
    return areas[0];
}

static void vsf__ring_entry(float *entry, const double a[3], double weight_a, const double b[3],
                            double weight_b, double total, uint32_t neighbour) {
    int k;
    for (k = 0; k < 3; k++) {
        double g = (weight_a > 0 ? weight_a * a[k] : 0) + (weight_b > 0 ? weight_b * b[k] : 0);
        entry[k] = total > 0 ? (float)(g / total) : 0.0f;
    }
    entry[3] = (float)neighbour;
}

typedef struct vsf__ringer {
    const vsf_mesh *mesh;
    const vsf_buffers *buffers;
    const uint32_t *starts;
} vsf__ringer;

static void vsf__ring_fill(void *arg, uint32_t first, uint32_t end) {
    const vsf__ringer *r = (const vsf__ringer *)arg;
    const vsf_mesh *mesh = r->mesh;
    uint32_t v, i;
    for (v = first; v < end; v++) {
        uint32_t start = r->starts[v];
        float *point = r->buffers->points + 4 * (size_t)v,
              *normal = r->buffers->normals + 4 * (size_t)v;
        float *entry = r->buffers->rings + 4 * (size_t)start;
        double total = 0, a[3], b[3], a2[3], b2[3];
        memcpy(point, mesh->positions + 3 * (size_t)v, 3 * sizeof(float));
        memcpy(normal, mesh->normals + 3 * (size_t)v, 3 * sizeof(float));
        point[3] = (float)(start >> 8);
        normal[3] = (float)((start & 255u) * 65536u + (r->starts[v + 1] - start));
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            total += vsf__corner_gradient(mesh, mesh->ring_corners[i], a, b);
        }
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t half = mesh->ring_corners[i], behind = vsf__previous(half);
            uint32_t beyond = mesh->opposites[half];
            double w = vsf__corner_gradient(mesh, half, a, b), w2 = 0;
            if (beyond != VSF_NONE) { /* it runs back to v: v is the corner behind its start */
                w2 = vsf__corner_gradient(mesh, vsf__next(beyond), a2, b2);
            }
            vsf__ring_entry(entry, a, w, b2, w2, total, mesh->triangles[vsf__next(half)]);
            entry += 4;
            if (mesh->opposites[behind] == VSF_NONE) {
                vsf__ring_entry(entry, b, w, b, 0, total, mesh->triangles[behind]);
                entry += 4;
            }
        }
    }
}

static void vsf__buffers_parts(vsf_buffers *b, lao__block *block) {
    b->points = lao__part_float(block, 4 * (uint64_t)b->vertex_count);
    b->normals = lao__part_float(block, 4 * (uint64_t)b->vertex_count);
    b->rings = lao__part_float(block, 4 * (uint64_t)b->ring_count);
    b->triangles = lao__part_float(block, 4 * (uint64_t)b->triangle_count);
}

/* What a device cannot take is said before any memory is taken. */
static lao_result vsf__buffers_check(const vsf_host *host, const vsf_mesh *mesh,
                                     uint32_t max_texels, uint32_t *ring_count) {
    const uint32_t most = 1u << 24; /* whole numbers that a float holds */
    uint64_t rings = 0;
    uint32_t v, texels;
    for (v = 0; v < mesh->vertex_count; v++) {
        uint32_t n = vsf__neighbour_count(mesh, v);
        if (n > 65535u) {
            return vsf__fail(host, VSF_LOG_MESH_DEVICE,
                             "vertex %u has %u neighbours, 65535 at most", mesh->vertex_sources[v],
                             n);
        }
        rings += n;
    }
    if (mesh->vertex_count > most || rings > 0xffffffffu) {
        return vsf__fail(host, VSF_LOG_MESH_DEVICE, "%u vertices, %u at most", mesh->vertex_count,
                         most);
    }
    texels = rings > mesh->triangle_count ? (uint32_t)rings : mesh->triangle_count;
    if (max_texels && texels > max_texels) {
        return vsf__fail(host, VSF_LOG_MESH_DEVICE,
                         "%u triangles need a buffer of %u texels, the device has %u; about %u "
                         "triangles would fit",
                         mesh->triangle_count, texels, max_texels,
                         (uint32_t)((uint64_t)mesh->triangle_count * max_texels / texels));
    }
    *ring_count = (uint32_t)rings;
    return LAO_OK;
}

VSF_API lao_result vsf_buffers_make(const vsf_host *host, const vsf_mesh *mesh, uint32_t max_texels,
                                    vsf_buffers *buffers) {
    vsf_buffers b;
    lao__block block = {NULL, 0};
    vsf__progress progress;
    vsf__ringer ringer;
    uint32_t *starts, i;
    lao_result result;
    if (!mesh || !mesh->memory || !buffers) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_buffers_make");
    }
    memset(&b, 0, sizeof b);
    b.allocator = vsf__allocator(host);
    b.vertex_count = mesh->vertex_count;
    b.triangle_count = mesh->triangle_count;
    memcpy(b.bounds, mesh->info.bounds, sizeof b.bounds);
    result = vsf__buffers_check(host, mesh, max_texels, &b.ring_count);
    if (result != LAO_OK) {
        return result;
    }
    vsf__buffers_parts(&b, &block);
    b.memory = lao__take(&b.allocator, block.used, 1);
    starts = (uint32_t *)lao__take(&b.allocator, (uint64_t)mesh->vertex_count + 1, sizeof *starts);
    if (!b.memory || !starts) {
        lao__give(&b.allocator, b.memory);
        lao__give(&b.allocator, starts);
        return vsf__fail(host, VSF_LOG_MEMORY, "buffers of %u triangles", mesh->triangle_count);
    }
    block.base = (unsigned char *)b.memory;
    block.used = 0;
    vsf__buffers_parts(&b, &block);
    starts[0] = 0;
    for (i = 0; i < mesh->vertex_count; i++) {
        starts[i + 1] = starts[i] + vsf__neighbour_count(mesh, i);
    }
    for (i = 0; i < mesh->triangle_count; i++) {
        float *to = b.triangles + 4 * (size_t)i;
        to[0] = (float)mesh->triangles[3 * (size_t)i];
        to[1] = (float)mesh->triangles[3 * (size_t)i + 1];
        to[2] = (float)mesh->triangles[3 * (size_t)i + 2];
        to[3] = 0.0f;
    }
    ringer.mesh = mesh;
    ringer.buffers = &b;
    ringer.starts = starts;
    progress = vsf__progress_make(host, mesh->vertex_count);
    if (vsf__run(&progress, mesh->vertex_count, VSF__CHUNK, &ringer, vsf__ring_fill)) {
        result = vsf__fail(host, VSF_LOG_CANCELLED, NULL);
    }
    lao__give(&b.allocator, starts);
    if (result != LAO_OK) {
        vsf_buffers_free(&b);
        return result;
    }
    *buffers = b;
    return LAO_OK;
}

VSF_API void vsf_buffers_free(vsf_buffers *buffers) {
    if (buffers && buffers->memory) {
        lao__give(&buffers->allocator, buffers->memory);
    }
    if (buffers) {
        memset(buffers, 0, sizeof *buffers);
    }
}

VSF_API void vsf_buffers_describe(const vsf_buffers *buffers, lao_object_buffer list[4],
                                  lao_object_desc *desc) {
    const void *data[4];
    uint32_t counts[4], i;
    data[0] = buffers->points;
    data[1] = buffers->normals;
    data[2] = buffers->rings;
    data[3] = buffers->triangles;
    counts[0] = counts[1] = buffers->vertex_count;
    counts[2] = buffers->ring_count;
    counts[3] = buffers->triangle_count;
    for (i = 0; i < 4; i++) {
        list[i].name = vsf__buffer_rows[i].name;
        list[i].data = data[i];
        list[i].texel_count = counts[i];
    }
    memset(desc, 0, sizeof *desc);
    desc->buffers = list;
    desc->buffer_count = 4;
    desc->triangle_count = buffers->triangle_count;
    desc->item_count = buffers->vertex_count;
    memcpy(desc->bounds, buffers->bounds, sizeof desc->bounds);
}

static lao_v4 vsf__texel(const float *texels, uint32_t i) {
    const float *t = texels + 4 * (size_t)i;
    return lao_v4_make(t[0], t[1], t[2], t[3]);
}
static lao_v3 vsf__xyz(lao_v4 v) {
    return lao_v3_make(v.x, v.y, v.z);
}

typedef struct vsf__measurer {
    const vsf_buffers *buffers;
    lao_v4 eye;
    bool naive;
    const float *values; /* of vsf_gradients; of features: the measure */
    float *out;
} vsf__measurer;

/* What the pass surface_measure does for each texel. */
static void vsf__measure_vertices(void *arg, uint32_t first, uint32_t end) {
    const vsf__measurer *m = (const vsf__measurer *)arg;
    const vsf_buffers *b = m->buffers;
    uint32_t v, i;
    for (v = first; v < end; v++) {
        lao_v4 point = vsf__texel(b->points, v), normal = vsf__texel(b->normals, v);
        lao_uint start = vsf_ring_start(point.w, normal.w), count = vsf_ring_count(normal.w);
        vsf_ring_sum ring = vsf_ring_begin(m->eye, vsf__xyz(point), vsf__xyz(normal), m->naive);
        for (i = 0; i < count; i++) {
            lao_v4 entry = vsf__texel(b->rings, start + i);
            lao_uint other = LAO_U(entry.w);
            float light = vsf_light(m->eye, vsf__xyz(vsf__texel(b->points, other)),
                                    vsf__xyz(vsf__texel(b->normals, other)), m->naive);
            ring = vsf_ring_add(ring, entry, light);
        }
        m->out[v] = vsf_ring_end(ring);
    }
}

static int vsf__eye_bad(const float eye[4]) {
    return !(fabsf(eye[0]) <= 1e15f && fabsf(eye[1]) <= 1e15f && fabsf(eye[2]) <= 1e15f &&
             (eye[3] == 0.0f || eye[3] == 1.0f));
}
static vsf__measurer vsf__measurer_make(const vsf_buffers *buffers, const float eye[4],
                                        uint32_t flags, float *out) {
    vsf__measurer m;
    m.buffers = buffers;
    m.eye = lao_v4_make(eye[0], eye[1], eye[2], eye[3]);
    m.naive = (flags & VSF_VIEW_NORMALIZED) != 0;
    m.values = NULL;
    m.out = out;
    return m;
}

VSF_API lao_result vsf_measure(const vsf_host *host, const vsf_buffers *buffers, const float eye[4],
                               uint32_t flags, float *measure) {
    vsf__measurer m;
    vsf__progress progress;
    if (!buffers || !buffers->memory || !eye || !measure) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_measure");
    }
    if (vsf__eye_bad(eye)) {
        return vsf__fail(host, VSF_LOG_SETTING, "the eye: finite, its fourth number 0 or 1");
    }
    m = vsf__measurer_make(buffers, eye, flags, measure);
    progress = vsf__progress_make(host, buffers->vertex_count);
    return vsf__run(&progress, buffers->vertex_count, VSF__CHUNK, &m, vsf__measure_vertices)
               ? vsf__fail(host, VSF_LOG_CANCELLED, NULL)
               : LAO_OK;
}

static void vsf__gradient(const vsf_buffers *b, const float *values, uint32_t v, double g[3]) {
    float pw = b->points[4 * (size_t)v + 3], nw = b->normals[4 * (size_t)v + 3];
    uint32_t start = vsf_ring_start(pw, nw), end = start + vsf_ring_count(nw), i;
    int k;
    g[0] = g[1] = g[2] = 0;
    for (i = start; i < end; i++) {
        const float *entry = b->rings + 4 * (size_t)i;
        double rise = (double)values[(uint32_t)entry[3]] - (double)values[v];
        for (k = 0; k < 3; k++) {
            g[k] += (double)entry[k] * rise;
        }
    }
}
static void vsf__gradient_vertices(void *arg, uint32_t first, uint32_t end) {
    const vsf__measurer *m = (const vsf__measurer *)arg;
    uint32_t v;
    int k;
    for (v = first; v < end; v++) {
        double g[3];
        vsf__gradient(m->buffers, m->values, v, g);
        for (k = 0; k < 3; k++) {
            m->out[3 * (size_t)v + (size_t)k] = (float)g[k];
        }
    }
}
VSF_API lao_result vsf_gradients(const vsf_host *host, const vsf_buffers *buffers,
                                 const float *values, float *gradients) {
    const float nowhere[4] = {0, 0, 0, 0};
    vsf__measurer m;
    vsf__progress progress;
    if (!buffers || !buffers->memory || !values || !gradients) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_gradients");
    }
    m = vsf__measurer_make(buffers, nowhere, 0, gradients);
    m.values = values;
    progress = vsf__progress_make(host, buffers->vertex_count);
    return vsf__run(&progress, buffers->vertex_count, VSF__CHUNK, &m, vsf__gradient_vertices)
               ? vsf__fail(host, VSF_LOG_CANCELLED, NULL)
               : LAO_OK;
}
