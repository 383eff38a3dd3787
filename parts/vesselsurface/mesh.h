/* ================================================================================================
 * mesh: triangles of the host, welded, checked, turned the right way round and put into an order.
   Uses host and triangle. */

/* What building needs until the mesh exists. All arrays come from one block. */
typedef struct vsf__build {
    const vsf_host *host;
    const vsf_mesh_desc *desc;
    uint32_t *target;     /* per desc vertex: first vertex at its place, later its index */
    uint32_t *source;     /* per vertex: desc vertex */
    uint32_t *table;      /* hash table of places */
    uint32_t *corners;    /* 3 per triangle */
    uint32_t *origin;     /* per triangle: desc triangle */
    uint32_t *opposites;  /* 3 per triangle */
    uint32_t *order[2];   /* 3 per triangle: half-edges by their ends */
    uint32_t *starts;     /* per vertex + 1: counting sort */
    uint32_t *part;       /* per triangle: its part */
    uint32_t *queue;      /* per triangle */
    unsigned char *flags; /* per triangle: VSF__TURN, VSF__FLAT */
    unsigned char *borders;
    uint32_t table_mask, vertex_count, triangle_count;
    vsf_mesh_info info;
    vsf_warning warnings[VSF_LOG_ITEM_COUNT];
    uint32_t warning_count;
} vsf__build;
enum { VSF__TURN = 1, VSF__FLAT = 2 };

static void vsf__warn(vsf__build *b, vsf_log_item item, uint32_t place, uint32_t count) {
    uint32_t i = 0;
    if (count == 0) {
        return;
    }
    while (i < b->warning_count && b->warnings[i].item != item) {
        i++;
    }
    if (i == b->warning_count) {
        b->warnings[i].item = item;
        b->warnings[i].count = 0;
        b->warnings[i].first = place;
        b->warning_count++;
    }
    b->warnings[i].count += count;
}

static lao_result vsf__mesh_check(const vsf_host *host, const vsf_mesh_desc *desc) {
    const uint32_t most = 1u << 29;
    uint32_t i;
    if (desc->vertex_count > most || desc->triangle_count > most) {
        return vsf__fail(host, VSF_LOG_MESH_COUNT, "%u vertices, %u triangles", desc->vertex_count,
                         desc->triangle_count);
    }
    if ((desc->vertex_count && !desc->positions) || (desc->triangle_count && !desc->triangles) ||
        (desc->attribute_count && !desc->attributes)) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "arrays of vsf_mesh_desc");
    }
    for (i = 0; i < desc->attribute_count; i++) {
        const vsf_attribute *a = desc->attributes + i;
        if (!a->name || (!a->values && desc->vertex_count) || a->components > 1024) {
            return vsf__fail(host, VSF_LOG_MESH_ATTRIBUTE, "attribute %u", i);
        }
    }
    for (i = 0; i < 3 * desc->triangle_count; i++) {
        if (desc->triangles[i] >= desc->vertex_count) {
            return vsf__fail(host, VSF_LOG_MESH_INDEX, "triangle %u, vertex %u of %u", i / 3,
                             desc->triangles[i], desc->vertex_count);
        }
    }
    return LAO_OK;
}

static void vsf__build_parts(vsf__build *b, lao__block *block) {
    uint64_t n = b->desc->vertex_count, m = b->desc->triangle_count, size = 16;
    while (size < 2 * n) {
        size *= 2;
    }
    b->table_mask = (uint32_t)(size - 1);
    b->target = lao__part_u32(block, n);
    b->source = lao__part_u32(block, n);
    b->table = lao__part_u32(block, b->desc->flags & VSF_MESH_NO_WELD ? 0 : size);
    b->corners = lao__part_u32(block, 3 * m);
    b->origin = lao__part_u32(block, m);
    b->opposites = lao__part_u32(block, 3 * m);
    b->order[0] = lao__part_u32(block, 3 * m);
    b->order[1] = lao__part_u32(block, 3 * m);
    b->starts = lao__part_u32(block, n + 1);
    b->part = lao__part_u32(block, m);
    b->queue = lao__part_u32(block, m);
    b->flags = (unsigned char *)lao__part(block, m, 1);
    b->borders = (unsigned char *)lao__part(block, n, 1);
}

/* target = the first vertex at the same place, VSF_NONE where there is no place */
static void vsf__weld(vsf__build *b) {
    const float *p = b->desc->positions;
    uint32_t i, n = b->desc->vertex_count, weld = !(b->desc->flags & VSF_MESH_NO_WELD);
    if (weld) {
        memset(b->table, 0xff, ((size_t)b->table_mask + 1) * sizeof *b->table);
    }
    for (i = 0; i < n; i++, p += 3) {
        uint32_t slot;
        b->target[i] = i;
        if (!(fabsf(p[0]) <= 1e9f && fabsf(p[1]) <= 1e9f && fabsf(p[2]) <= 1e9f)) {
            b->target[i] = VSF_NONE;
            vsf__warn(b, VSF_LOG_VERTICES_WILD, i, 1);
            b->info.wild++;
            continue;
        }
        if (!weld) {
            continue;
        }
        slot =
            lao_hash(lao_float_bits(p[0] + 0.0f) +
                     lao_hash(lao_float_bits(p[1] + 0.0f) + lao_hash(lao_float_bits(p[2] + 0.0f))));
        for (slot &= b->table_mask; b->table[slot] != VSF_NONE; slot = (slot + 1) & b->table_mask) {
            const float *q = b->desc->positions + 3 * (size_t)b->table[slot];
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) { /* finite: equal but for -0 */
                break;
            }
        }
        if (b->table[slot] == VSF_NONE) {
            b->table[slot] = i;
        } else {
            b->target[i] = b->table[slot];
            b->info.welded++;
        }
    }
}

/* Gives vertices their indices, in the order of the desc. */
static void vsf__pick_vertices(vsf__build *b) {
    uint32_t i;
    for (i = 0; i < b->desc->vertex_count; i++) {
        if (b->target[i] == VSF_NONE) {
            continue;
        }
        if (b->target[i] < i) {
            b->target[i] = b->target[b->target[i]]; /* the first one has its index already */
        } else {
            b->source[b->vertex_count] = i;
            b->target[i] = b->vertex_count++;
        }
    }
}

static void vsf__corner(const vsf__build *b, uint32_t half, double p[3]) {
    vsf__load(b->desc->positions + 3 * (size_t)b->source[b->corners[half]], p);
}

/* Triangles whose corners are apart; those without area are marked and go later, because they may
   connect others. */
static void vsf__pick_triangles(vsf__build *b) {
    uint32_t t, m = 0;
    for (t = 0; t < b->desc->triangle_count; t++) {
        const uint32_t *from = b->desc->triangles + 3 * (size_t)t;
        uint32_t *to = b->corners + 3 * (size_t)m;
        double p[3][3], n[3];
        int k;
        for (k = 0; k < 3; k++) {
            to[k] = b->target[from[k]];
        }
        if (to[0] == VSF_NONE || to[1] == VSF_NONE || to[2] == VSF_NONE) {
            vsf__warn(b, VSF_LOG_TRIANGLES_WILD, t, 1);
            continue;
        }
        if (to[0] == to[1] || to[1] == to[2] || to[2] == to[0]) {
            vsf__warn(b, VSF_LOG_TRIANGLES_DEGENERATE, t, 1);
            b->info.degenerate++;
            continue;
        }
        for (k = 0; k < 3; k++) {
            vsf__corner(b, 3 * m + (uint32_t)k, p[k]);
        }
        b->flags[m] = 0;
        if (!(vsf__face(p[0], p[1], p[2], n) > 0)) {
            b->flags[m] = VSF__FLAT;
            vsf__warn(b, VSF_LOG_TRIANGLES_DEGENERATE, t, 1);
            b->info.degenerate++;
        }
        b->origin[m++] = t;
    }
    b->triangle_count = m;
}

static uint32_t vsf__next(uint32_t half) {
    return half % 3 == 2 ? half - 2 : half + 1;
}
static uint32_t vsf__previous(uint32_t half) {
    return half % 3 == 0 ? half + 2 : half - 1;
}

/* Counting sort of half-edges by their lower (or higher) end; stable. */
static void vsf__sort_halves(vsf__build *b, const uint32_t *from, uint32_t *to, int by_lower) {
    uint32_t i, count = 3 * b->triangle_count, sum = 0;
    memset(b->starts, 0, ((size_t)b->vertex_count + 1) * sizeof *b->starts);
    for (i = 0; i < count; i++) {
        uint32_t v = b->corners[i], w = b->corners[vsf__next(i)];
        b->starts[(v < w) == by_lower ? v : w]++;
    }
    for (i = 0; i <= b->vertex_count; i++) {
        uint32_t n = b->starts[i];
        b->starts[i] = sum;
        sum += n;
    }
    for (i = 0; i < count; i++) {
        uint32_t half = from ? from[i] : i;
        uint32_t v = b->corners[half], w = b->corners[vsf__next(half)];
        to[b->starts[(v < w) == by_lower ? v : w]++] = half;
    }
}
static int vsf__same_edge(const vsf__build *b, uint32_t h, uint32_t g) {
    uint32_t a = b->corners[h], c = b->corners[vsf__next(h)];
    uint32_t d = b->corners[g], e = b->corners[vsf__next(g)];
    return (a == d && c == e) || (a == e && c == d);
}
static void vsf__border(vsf__build *b, uint32_t half) {
    b->borders[b->corners[half]] = 1;
    b->borders[b->corners[vsf__next(half)]] = 1;
}
/* opposites, whatever their direction: where an edge has two triangles */
static void vsf__pair_halves(vsf__build *b) {
    uint32_t i, j, count = 3 * b->triangle_count;
    memset(b->borders, 0, b->vertex_count);
    vsf__sort_halves(b, NULL, b->order[0], 0);
    vsf__sort_halves(b, b->order[0], b->order[1], 1);
    for (i = 0; i < count; i = j) {
        const uint32_t *h = b->order[1] + i;
        uint32_t k;
        for (j = i + 1; j < count && vsf__same_edge(b, h[0], b->order[1][j]); j++) {
        }
        b->info.edges++;
        for (k = i; k < j; k++) {
            b->opposites[b->order[1][k]] = VSF_NONE;
        }
        if (j - i == 2) {
            b->opposites[h[0]] = h[1];
            b->opposites[h[1]] = h[0];
        } else {
            uint32_t triangle = b->origin[h[0] / 3];
            vsf__border(b, h[0]);
            vsf__warn(b, j - i == 1 ? VSF_LOG_EDGES_OPEN : VSF_LOG_EDGES_CROWDED, triangle, 1);
            b->info.open_edges += j - i == 1;
            b->info.crowded_edges += j - i > 2;
        }
    }
}

/* Do two opposite half-edges run the same way, so that one triangle must be turned? */
static int vsf__runs_along(const vsf__build *b, uint32_t half, uint32_t opposite) {
    return b->corners[half] == b->corners[opposite];
}
/* A part is what hangs together through paired edges. Marks the triangles to be turned so that all
   run like its first; returns the part's end in the queue, which begins at `first`. */
static uint32_t vsf__flood(vsf__build *b, uint32_t first, uint32_t part) {
    uint32_t end = first + 1, i, k;
    b->part[b->queue[first]] = part;
    for (i = first; i < end; i++) {
        uint32_t t = b->queue[i];
        for (k = 0; k < 3; k++) {
            uint32_t half = 3 * t + k, other = b->opposites[half], u = other / 3;
            if (other == VSF_NONE || b->part[u] != VSF_NONE) {
                continue;
            }
            b->part[u] = part;
            b->flags[u] =
                (unsigned char)((b->flags[u] & ~VSF__TURN) |
                                ((b->flags[t] ^ vsf__runs_along(b, half, other)) & VSF__TURN));
            b->queue[end++] = u;
        }
    }
    return end;
}

/* Area of the triangles that run like the first and of the others; six times the signed volume as
   if all ran like the first, about a point of the part; is it closed? */
typedef struct vsf__shape {
    double area[2], volume6;
    int closed;
} vsf__shape;
static void vsf__part_centre(const vsf__build *b, uint32_t first, uint32_t end, double centre[3]) {
    uint32_t i;
    int k, axis;
    centre[0] = centre[1] = centre[2] = 0;
    for (i = first; i < end; i++) {
        for (k = 0; k < 3; k++) {
            double p[3];
            vsf__corner(b, 3 * b->queue[i] + (uint32_t)k, p);
            for (axis = 0; axis < 3; axis++) {
                centre[axis] += p[axis] / (3.0 * (double)(end - first));
            }
        }
    }
}
static vsf__shape vsf__measure_part(const vsf__build *b, uint32_t first, uint32_t end) {
    vsf__shape shape;
    double centre[3];
    uint32_t i, k;
    memset(&shape, 0, sizeof shape);
    shape.closed = 1;
    vsf__part_centre(b, first, end, centre);
    for (i = first; i < end; i++) {
        uint32_t t = b->queue[i];
        double p[3][3], c[3], a[3], d[3];
        int turned = b->flags[t] & VSF__TURN;
        for (k = 0; k < 3; k++) {
            vsf__corner(b, 3 * t + k, p[k]);
            vsf__sub(p[k], centre, p[k]);
            shape.closed &= b->opposites[3 * t + k] != VSF_NONE;
        }
        vsf__cross(p[1], p[2], c);
        shape.volume6 += (turned ? -1 : 1) * vsf__dot(p[0], c);
        vsf__sub(p[1], p[0], a);
        vsf__sub(p[2], p[0], d);
        vsf__cross(a, d, c);
        shape.area[turned ? 1 : 0] += 0.5 * sqrt(vsf__dot(c, c));
    }
    return shape;
}

/* Exchanges corners 1 and 2 of a marked triangle: its half-edges k become 2 - k. */
static uint32_t vsf__turned_half(const vsf__build *b, uint32_t half) {
    if (half == VSF_NONE || !(b->flags[half / 3] & VSF__TURN)) {
        return half;
    }
    return half - half % 3 + (2 - half % 3);
}
static void vsf__turn_triangles(vsf__build *b) {
    uint32_t t, k;
    for (t = 0; t < b->triangle_count; t++) {
        uint32_t *h = b->opposites + 3 * (size_t)t, *c = b->corners + 3 * (size_t)t;
        for (k = 0; k < 3; k++) {
            h[k] = vsf__turned_half(b, h[k]);
        }
        if (b->flags[t] & VSF__TURN) {
            uint32_t x = h[0], v = c[1];
            h[0] = h[2];
            h[2] = x;
            c[1] = c[2];
            c[2] = v;
        }
    }
}

/* Chooses for each part which side is out, and says what was wrong. */
static void vsf__orient_part(vsf__build *b, uint32_t first, uint32_t end) {
    vsf__shape shape = vsf__measure_part(b, first, end);
    int keep = (b->desc->flags & VSF_MESH_KEEP_WINDING) != 0;
    int flip = (b->desc->flags & VSF_MESH_FLIP) != 0, turn_all;
    uint32_t i, mended = 0, place = VSF_NONE;
    b->info.parts++;
    b->info.closed_parts += shape.closed != 0;
    turn_all = shape.area[1] > shape.area[0]; /* the side with more area is as the file meant it */
    if (!keep) {
        double volume6 = turn_all ? -shape.volume6 : shape.volume6;
        uint32_t triangle = b->origin[b->queue[first]];
        for (i = first; i < end; i++) {
            uint32_t t = b->queue[i];
            if (((b->flags[t] & VSF__TURN) != 0) != turn_all) {
                mended++;
                place = b->origin[t] < place ? b->origin[t] : place;
            }
        }
        vsf__warn(b, VSF_LOG_WINDING_MENDED, place, mended);
        if (volume6 < 0 && shape.closed) {
            turn_all = !turn_all;
            vsf__warn(b, VSF_LOG_PARTS_INWARD, triangle, 1);
        } else if (volume6 < 0 && !flip) {
            vsf__warn(b, VSF_LOG_PARTS_SUSPECT, triangle, 1);
        }
    }
    for (i = first; i < end; i++) {
        uint32_t t = b->queue[i];
        unsigned turn = keep ? 0u : (b->flags[t] & VSF__TURN) ^ (unsigned)turn_all;
        turn ^= (unsigned)flip;
        b->info.turned += turn;
        b->flags[t] = (unsigned char)((b->flags[t] & VSF__FLAT) | turn);
    }
}

static void vsf__orient(vsf__build *b) {
    uint32_t t, end = 0;
    memset(b->part, 0xff, (size_t)b->triangle_count * sizeof *b->part);
    for (t = 0; t < b->triangle_count; t++) {
        if (b->part[t] == VSF_NONE) {
            uint32_t first = end;
            b->queue[first] = t;
            end = vsf__flood(b, first, t);
            vsf__orient_part(b, first, end);
        }
    }
    vsf__turn_triangles(b);
    for (t = 0; t < 3 * b->triangle_count; t++) {
        uint32_t other = b->opposites[t];
        if (other != VSF_NONE && vsf__runs_along(b, t, other)) {
            vsf__border(b, t);
            b->opposites[t] = b->opposites[other] = VSF_NONE;
            b->info.twisted_edges++;
            vsf__warn(b, VSF_LOG_WINDING_TWISTED, b->origin[t / 3], 1);
        }
    }
}

/* Triangles without area go now; their neighbours lose them. */
static void vsf__drop_flat(vsf__build *b) {
    uint32_t t, k, m = 0;
    for (t = 0; t < b->triangle_count; t++) {
        b->part[t] = b->flags[t] & VSF__FLAT ? VSF_NONE : m++;
    }
    for (t = 0; t < b->triangle_count; t++) {
        uint32_t to = b->part[t];
        if (to == VSF_NONE) {
            continue;
        }
        for (k = 0; k < 3; k++) {
            uint32_t other = b->opposites[3 * t + k];
            if (other != VSF_NONE) {
                uint32_t u = b->part[other / 3];
                other = u == VSF_NONE ? VSF_NONE : 3 * u + other % 3;
            }
            b->opposites[3 * to + k] = other;
            b->corners[3 * to + k] = b->corners[3 * t + k];
        }
        b->origin[to] = b->origin[t];
    }
    b->triangle_count = m;
}

/* ---- the mesh itself */

static void vsf__mesh_parts(vsf_mesh *mesh, const vsf_attribute *attributes, lao__block *block) {
    uint64_t n = mesh->vertex_count, m = mesh->triangle_count;
    uint32_t i;
    mesh->positions = lao__part_float(block, 3 * n);
    mesh->normals = lao__part_float(block, 3 * n);
    mesh->areas = (double *)lao__part(block, n, sizeof(double));
    mesh->triangles = lao__part_u32(block, 3 * m);
    mesh->opposites = lao__part_u32(block, 3 * m);
    mesh->ring_starts = lao__part_u32(block, n + 1);
    mesh->ring_corners = lao__part_u32(block, 3 * m);
    mesh->borders = (unsigned char *)lao__part(block, n, 1);
    mesh->vertex_sources = lao__part_u32(block, n);
    mesh->triangle_sources = lao__part_u32(block, m);
    mesh->vertex_targets = lao__part_u32(block, mesh->source_count);
    mesh->attributes =
        (vsf_attribute *)lao__part(block, mesh->attribute_count, sizeof(vsf_attribute));
    for (i = 0; i < mesh->attribute_count; i++) {
        uint32_t components = attributes[i].components ? attributes[i].components : 1;
        size_t length = strlen(attributes[i].name) + 1;
        float *values = lao__part_float(block, n * components);
        char *name = (char *)lao__part(block, length, 1);
        if (block->base) {
            memcpy(name, attributes[i].name, length);
            mesh->attributes[i].name = name;
            mesh->attributes[i].components = components;
            mesh->attributes[i].values = values;
        }
    }
}

/* Normals and areas of the vertices, corner by corner in the order of the triangles. */
static void vsf__vertex_shapes(void *arg, uint32_t first, uint32_t end) {
    vsf_mesh *mesh = (vsf_mesh *)arg;
    uint32_t v, i;
    int k;
    for (v = first; v < end; v++) {
        double normal[3] = {0, 0, 0}, area = 0;
        for (i = mesh->ring_starts[v]; i < mesh->ring_starts[v + 1]; i++) {
            uint32_t half = mesh->ring_corners[i];
            double p[3][3], n[3], areas[3], area2;
            vsf__load(mesh->positions + 3 * (size_t)v, p[0]);
            vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__next(half)], p[1]);
            vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[vsf__previous(half)], p[2]);
            area2 = vsf__face(p[0], p[1], p[2], n);
            vsf_corner_areas(p[0], p[1], p[2], areas);
            for (k = 0; k < 3; k++) {
                normal[k] += area2 * n[k];
            }
            area += areas[0];
        }
        vsf__unit(normal);
        for (k = 0; k < 3; k++) {
            mesh->normals[3 * (size_t)v + (size_t)k] = (float)normal[k];
        }
        mesh->areas[v] = area;
    }
}

/* What depends on positions. Returns 0, or -1 when the host cancels. */
static int vsf__mesh_shape(vsf__progress *progress, vsf_mesh *mesh) {
    double edges = 0, area = 0, volume6 = 0, centre[3];
    uint32_t t, v;
    int k, any = 0;
    memset(mesh->info.bounds, 0, sizeof mesh->info.bounds);
    for (v = 0; v < mesh->vertex_count; v++) {
        const float *p = mesh->positions + 3 * (size_t)v;
        if (mesh->ring_starts[v] == mesh->ring_starts[v + 1]) {
            continue;
        }
        for (k = 0; k < 3; k++) {
            float *low = &mesh->info.bounds[0][k], *high = &mesh->info.bounds[1][k];
            *low = !any || p[k] < *low ? p[k] : *low;
            *high = !any || p[k] > *high ? p[k] : *high;
        }
        any = 1;
    }
    for (k = 0; k < 3; k++) {
        centre[k] = 0.5 * ((double)mesh->info.bounds[0][k] + (double)mesh->info.bounds[1][k]);
    }
    for (t = 0; t < mesh->triangle_count; t++) {
        double p[3][3], n[3], e[3], area2;
        for (k = 0; k < 3; k++) {
            vsf__load(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (uint32_t)k], p[k]);
        }
        area2 = vsf__face(p[0], p[1], p[2], n);
        vsf__sub(p[0], centre, e);
        area += 0.5 * area2;
        volume6 += area2 * vsf__dot(n, e);
        for (k = 0; k < 3; k++) {
            vsf__sub(p[k], p[(k + 1) % 3], e);
            edges += sqrt(vsf__dot(e, e));
        }
    }
    mesh->info.area = area;
    mesh->info.volume = volume6 / 6;
    mesh->info.mean_edge = mesh->triangle_count ? edges / (3.0 * mesh->triangle_count) : 0;
    return vsf__run(progress, mesh->vertex_count, VSF__CHUNK, mesh, vsf__vertex_shapes);
}

static void vsf__mesh_rings(vsf_mesh *mesh) {
    uint32_t i, sum = 0, count = 3 * mesh->triangle_count;
    uint32_t *starts = mesh->ring_starts;
    memset(starts, 0, ((size_t)mesh->vertex_count + 1) * sizeof *starts);
    for (i = 0; i < count; i++) {
        starts[mesh->triangles[i]]++;
    }
    for (i = 0; i <= mesh->vertex_count; i++) {
        uint32_t n = starts[i];
        starts[i] = sum;
        sum += n;
    }
    for (i = 0; i < count; i++) {
        mesh->ring_corners[starts[mesh->triangles[i]]++] = i;
    }
    for (i = mesh->vertex_count; i > 0; i--) {
        starts[i] = starts[i - 1];
    }
    starts[0] = 0;
}

/* A file's normals, where they are any. */
static void vsf__given_normals(vsf_mesh *mesh, const float *normals) {
    uint32_t v;
    int k;
    for (v = 0; v < mesh->vertex_count; v++) {
        double n[3];
        vsf__load(normals + 3 * (size_t)mesh->vertex_sources[v], n);
        if (fabs(n[0]) <= 1e30 && fabs(n[1]) <= 1e30 && fabs(n[2]) <= 1e30 &&
            vsf__unit(n) > 1e-20) {
            for (k = 0; k < 3; k++) {
                mesh->normals[3 * (size_t)v + (size_t)k] = (float)n[k];
            }
        }
    }
}

static void vsf__mesh_fill(const vsf__build *b, vsf_mesh *mesh) {
    const vsf_mesh_desc *desc = b->desc;
    uint32_t i, k;
    for (i = 0; i < mesh->vertex_count; i++) {
        memcpy(mesh->positions + 3 * (size_t)i, desc->positions + 3 * (size_t)b->source[i],
               3 * sizeof(float));
    }
    memcpy(mesh->triangles, b->corners, 3 * (size_t)mesh->triangle_count * sizeof(uint32_t));
    memcpy(mesh->opposites, b->opposites, 3 * (size_t)mesh->triangle_count * sizeof(uint32_t));
    memcpy(mesh->triangle_sources, b->origin, mesh->triangle_count * sizeof(uint32_t));
    memcpy(mesh->borders, b->borders, mesh->vertex_count);
    memcpy(mesh->vertex_sources, b->source, mesh->vertex_count * sizeof(uint32_t));
    if (mesh->source_count) {
        memcpy(mesh->vertex_targets, b->target, mesh->source_count * sizeof(uint32_t));
    }
    for (k = 0; k < mesh->attribute_count; k++) {
        uint32_t n = mesh->attributes[k].components;
        float *to = (float *)(uintptr_t)mesh->attributes[k].values;
        for (i = 0; i < mesh->vertex_count; i++) {
            memcpy(to + (size_t)i * n, desc->attributes[k].values + (size_t)b->source[i] * n,
                   n * sizeof(float));
        }
    }
}

static void vsf__log_warnings(const vsf_host *host, const vsf_mesh *mesh) {
    char text[256];
    uint32_t i;
    for (i = 0; host && host->log && i < mesh->warning_count; i++) {
        vsf_mesh_warning_text(mesh, i, text, sizeof text);
        host->log(host->user, mesh->warnings[i].item, LAO_OK, text);
    }
}

/* The second half: a mesh of what was picked. */
static lao_result vsf__mesh_finish(vsf__build *b, vsf__progress *progress, vsf_mesh *mesh) {
    vsf_mesh m;
    lao__block block = {NULL, 0};
    uint32_t v;
    memset(&m, 0, sizeof m);
    m.allocator = vsf__allocator(b->host);
    m.vertex_count = b->vertex_count;
    m.triangle_count = b->triangle_count;
    m.source_count = b->desc->vertex_count;
    m.attribute_count = b->desc->attribute_count;
    vsf__mesh_parts(&m, b->desc->attributes, &block);
    m.memory = lao__take(&m.allocator, block.used, 1);
    if (!m.memory) {
        return vsf__fail(b->host, VSF_LOG_MEMORY, "%u vertices, %u triangles", m.vertex_count,
                         m.triangle_count);
    }
    block.base = (unsigned char *)m.memory;
    block.used = 0;
    vsf__mesh_parts(&m, b->desc->attributes, &block);
    vsf__mesh_fill(b, &m);
    vsf__mesh_rings(&m);
    for (v = 0; v < m.vertex_count; v++) {
        if (m.ring_starts[v] == m.ring_starts[v + 1]) {
            vsf__warn(b, VSF_LOG_VERTICES_LOOSE, m.vertex_sources[v], 1);
            b->info.unreferenced++;
        }
    }
    m.info = b->info;
    memcpy(m.warnings, b->warnings, sizeof m.warnings);
    m.warning_count = b->warning_count;
    if (vsf__mesh_shape(progress, &m)) {
        vsf_mesh_free(&m);
        return vsf__fail(b->host, VSF_LOG_CANCELLED, NULL);
    }
    if (b->desc->normals) {
        vsf__given_normals(&m, b->desc->normals);
    }
    vsf__log_warnings(b->host, &m);
    *mesh = m;
    return LAO_OK;
}

/* Between the long phases. Returns 0, or -1 when the host cancels. */
static int vsf__tick(vsf__progress *progress, uint64_t units) {
    const vsf_host *host = progress->host;
    progress->done += units;
    return host && host->job.progress &&
                   host->job.progress(host->job.user, progress->done, progress->total)
               ? -1
               : 0;
}

static lao_result vsf__mesh_make(vsf__build *b, vsf_mesh *mesh) {
    uint64_t n = b->desc->vertex_count;
    vsf__progress progress = vsf__progress_make(b->host, 4 * n);
    vsf__weld(b);
    vsf__pick_vertices(b);
    if (vsf__tick(&progress, n)) {
        return vsf__fail(b->host, VSF_LOG_CANCELLED, NULL);
    }
    vsf__pick_triangles(b);
    vsf__pair_halves(b);
    if (vsf__tick(&progress, n)) {
        return vsf__fail(b->host, VSF_LOG_CANCELLED, NULL);
    }
    vsf__orient(b);
    vsf__drop_flat(b);
    if (vsf__tick(&progress, n)) {
        return vsf__fail(b->host, VSF_LOG_CANCELLED, NULL);
    }
    if (b->triangle_count == 0) {
        return vsf__fail(b->host, VSF_LOG_MESH_EMPTY, "%u vertices, %u triangles given",
                         b->desc->vertex_count, b->desc->triangle_count);
    }
    return vsf__mesh_finish(b, &progress, mesh);
}

VSF_API lao_result vsf_mesh_build(const vsf_host *host, const vsf_mesh_desc *desc, vsf_mesh *mesh) {
    lao_allocator allocator = vsf__allocator(host);
    vsf__build b;
    lao__block block = {NULL, 0};
    void *memory;
    lao_result result;
    if (!desc || !mesh) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_mesh_build");
    }
    result = vsf__mesh_check(host, desc);
    if (result != LAO_OK) {
        return result;
    }
    memset(&b, 0, sizeof b);
    b.host = host;
    b.desc = desc;
    vsf__build_parts(&b, &block);
    memory = lao__take(&allocator, block.used + 16, 1);
    if (!memory) {
        return vsf__fail(host, VSF_LOG_MEMORY, "%u vertices, %u triangles", desc->vertex_count,
                         desc->triangle_count);
    }
    block.base = (unsigned char *)memory;
    block.used = 0;
    vsf__build_parts(&b, &block);
    result = vsf__mesh_make(&b, mesh);
    lao__give(&allocator, memory);
    return result;
}

VSF_API void vsf_mesh_free(vsf_mesh *mesh) {
    if (mesh && mesh->memory) {
        lao__give(&mesh->allocator, mesh->memory);
    }
    if (mesh) {
        memset(mesh, 0, sizeof *mesh);
    }
}

VSF_API size_t vsf_mesh_warning_text(const vsf_mesh *mesh, uint32_t i, char *text, size_t size) {
    const vsf_warning *w;
    int of_vertex;
    if (!mesh || i >= mesh->warning_count) {
        if (size) {
            text[0] = 0;
        }
        return 0;
    }
    w = mesh->warnings + i;
    of_vertex = w->item == VSF_LOG_VERTICES_LOOSE || w->item == VSF_LOG_VERTICES_WILD;
    return (size_t)snprintf(text, size, "%u %s, first: %s %u", w->count, vsf__items[w->item].text,
                            of_vertex ? "vertex" : "triangle", w->first);
}
