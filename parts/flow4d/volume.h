/* ================================================================================================
 * volume: projections of scalar volumes, and their surfaces. Uses host and field. */

static lao_result flow4d__volume_check(const flow4d_host *host, const flow4d_volume *volume,
                                       double from_world[12]) {
    if (!volume || (!volume->values && !volume->mask)) {
        return flow4d__fail(host, FLOW4D_LOG_NULL_ARGUMENT, "the volume, or its values and mask");
    }
    return flow4d__lattice_check(host, volume->size, 1, sizeof(float), volume->to_world,
                                 from_world);
}

static double flow4d__value(const flow4d_volume *volume, size_t voxel) {
    return volume->values ? (double)volume->values[voxel] : volume->mask[voxel] ? 1.0 : 0.0;
}

/* ---- projection */

/* Inverse of a column-major 4x4 matrix by elimination with pivots; 0, or -1 when there is none. */
static int flow4d__invert4(const double m[16], double inverse[16]) {
    double a[4][8];
    int r, c, k;
    for (r = 0; r < 4; r++) {
        for (c = 0; c < 8; c++) {
            a[r][c] = c < 4 ? m[4 * c + r] : c - 4 == r ? 1.0 : 0.0;
        }
    }
    for (k = 0; k < 4; k++) {
        int best = k;
        for (r = k + 1; r < 4; r++) {
            best = fabs(a[r][k]) > fabs(a[best][k]) ? r : best;
        }
        if (!(fabs(a[best][k]) > 0.0)) {
            return -1;
        }
        for (c = 0; c < 8; c++) {
            double swapped = a[best][c];
            a[best][c] = a[k][c];
            a[k][c] = swapped;
        }
        for (r = 0; r < 4; r++) {
            double factor = a[r][k] / a[k][k];
            for (c = 0; c < 8 && r != k; c++) {
                a[r][c] -= factor * a[k][c];
            }
        }
    }
    for (r = 0; r < 4; r++) {
        for (c = 0; c < 4; c++) {
            inverse[4 * c + r] = a[r][c + 4] / a[r][r];
        }
    }
    return flow4d__finite(inverse, 16) ? 0 : -1;
}

typedef struct flow4d__projection {
    const flow4d_volume *volume;
    double from_world[12];
    double from_clip[16];
    double near_depth, middle_depth; /* NDC */
    double step;                     /* mm */
    double up;                       /* 1, or -1 when the camera turns the picture over */
    uint32_t width, height;
    float *image;
} flow4d__projection;

static int flow4d__unproject(const double m[16], double x, double y, double z, double p[3]) {
    double w = m[3] * x + m[7] * y + m[11] * z + m[15];
    int i;
    for (i = 0; i < 3; i++) {
        p[i] = (m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i]) / w;
    }
    return flow4d__finite(p, 3) ? 0 : -1;
}

/* Part of the ray from + t along (voxel indices), t >= 0, that lies in the box; 0 when none. */
static int flow4d__clip(const uint32_t size[3], const double from[3], const double along[3],
                        double span[2]) {
    int a;
    span[0] = 0.0;
    span[1] = 1e300;
    for (a = 0; a < 3; a++) {
        double low = -0.5 - from[a], high = (double)size[a] - 0.5 - from[a];
        if (along[a] == 0.0) {
            if (low > 0.0 || high < 0.0) {
                return 0;
            }
            continue;
        }
        low /= along[a];
        high /= along[a];
        span[0] = fmax(span[0], fmin(low, high));
        span[1] = fmin(span[1], fmax(low, high));
    }
    return span[1] >= span[0];
}

static double flow4d__ray(const flow4d__projection *p, const double from[3], const double to[3]) {
    double a[3], b[3], along[3], span[2], length, greatest = 0.0, way[3];
    size_t k, samples;
    int i, c;
    for (i = 0; i < 3; i++) {
        way[i] = to[i] - from[i];
    }
    length = flow4d__length(way);
    flow4d__apply(p->from_world, from, a);
    flow4d__apply(p->from_world, to, b);
    for (i = 0; i < 3; i++) {
        along[i] = (b[i] - a[i]) / length;
    }
    if (!flow4d__finite(along, 3) || !flow4d__clip(p->volume->size, a, along, span)) {
        return 0.0;
    }
    samples = (size_t)ceil((span[1] - span[0]) / p->step) + 1;
    for (k = 0; k < samples; k++) {
        double t = span[0] + (span[1] - span[0]) * ((double)k + 0.5) / (double)samples, index[3];
        double sum = 0.0;
        flow4d__cell cell;
        for (i = 0; i < 3; i++) {
            index[i] = a[i] + t * along[i];
        }
        flow4d__cell_make(p->volume->size, index, &cell);
        for (c = 0; c < 8; c++) {
            if (cell.weight[c] > 0.0) {
                sum += cell.weight[c] * flow4d__value(p->volume, cell.voxel[c]);
            }
        }
        greatest = sum > greatest ? sum : greatest; /* NaN is not */
    }
    return greatest;
}

static void flow4d__project_row(void *arg, size_t row) {
    const flow4d__projection *p = (const flow4d__projection *)arg;
    double y = p->up * (2.0 * ((double)row + 0.5) / p->height - 1.0);
    uint32_t i;
    for (i = 0; i < p->width; i++) {
        double x = 2.0 * ((double)i + 0.5) / p->width - 1.0, from[3], to[3], value = 0.0;
        if (flow4d__unproject(p->from_clip, x, y, p->near_depth, from) == 0 &&
            flow4d__unproject(p->from_clip, x, y, p->middle_depth, to) == 0) {
            value = flow4d__ray(p, from, to);
        }
        p->image[row * p->width + i] = (float)value;
    }
}

static int flow4d__camera(const lao_camera *camera, flow4d__projection *p) {
    double clip[16], least = camera->flags & LAO_CAMERA_ZERO_TO_ONE ? 0.0 : -1.0;
    int r, c, k;
    for (c = 0; c < 4; c++) {
        for (r = 0; r < 4; r++) {
            clip[4 * c + r] = 0.0;
            for (k = 0; k < 4; k++) {
                clip[4 * c + r] +=
                    (double)camera->projection[4 * k + r] * (double)camera->view[4 * c + k];
            }
        }
    }
    p->near_depth = camera->flags & LAO_CAMERA_REVERSE_DEPTH ? 1.0 : least;
    p->middle_depth = 0.5 * (1.0 + least);
    p->up = camera->flags & LAO_CAMERA_FLIP_Y ? -1.0 : 1.0;
    return flow4d__finite(clip, 16) ? flow4d__invert4(clip, p->from_clip) : -1;
}

lao_result flow4d_project_maximum(const flow4d_host *host, const flow4d_volume *volume,
                                  const lao_camera *camera, uint32_t width, uint32_t height,
                                  float *image) {
    flow4d_host h = flow4d__host(host);
    flow4d__projection p;
    lao_result result;
    if (!camera || !image) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "camera or image of the projection");
    }
    result = flow4d__volume_check(&h, volume, p.from_world);
    if (result != LAO_OK) {
        return result;
    }
    if (width == 0 || height == 0 || width > (size_t)-1 / sizeof(float) / height) {
        return flow4d__fail(&h, FLOW4D_LOG_IMAGE, "width or height");
    }
    if (flow4d__camera(camera, &p) != 0) {
        return flow4d__fail(&h, FLOW4D_LOG_CAMERA, "projection times view");
    }
    p.volume = volume;
    p.step = 0.5 * flow4d__shortest_edge(volume->to_world);
    p.width = width;
    p.height = height;
    p.image = image;
    return flow4d__work(&h, "flow4d_project_maximum", height, flow4d__project_row, &p);
}

/* ---- marching cubes */

/* Triangles per case: bit c of the case is 1 when corner c = x + 2 y + 4 z of the cell is inside.
   Three letters per triangle, a..l: edges 0..11, four along x, four along y, four along z, in order
   of the corner that they leave. Made by one rule, so that neighbours agree on every face: a face's
   runs of inside corners are each cut off by one segment, the segments of all six faces close to
   loops, and a loop is cut into triangles without a diagonal inside a face. tests/flow proves it.
 */
// clang-format off
static const char *const flow4d__cases[256] = {
    "", "aei", "ajf", "eiffij", "bke", "abiibk", "ajfbke", "bkffkjjki", "bfl", "aeibfl", "ajbbjl",
    "bellejjei", "efkkfl", "afiifkkfl", "ajeejkkjl", "ijkkjl", "cig", "aecceg", "ajfcig",
    "cjggjeejf", "bkecig", "abccbggbk", "ajfbkecig", "bkffkjjkcckg", "bflcig", "aeccegbfl",
    "ajbbjlcig", "bellejjecceg", "cigefkkfl", "afccfggfkkfl", "ajeejkkjlcig", "cjggjkkjl", "chj",
    "aeichj", "acffch", "chiiheehf", "bkechj", "abiibkchj", "acffchbke", "bkffkhhkccki", "bflchj",
    "aeibflchj", "acbbcllch", "bellehheccei", "chjefkkfl", "afiifkkflchj", "aceeckkcllch",
    "chiihkkhl", "ghiihj", "aejjehheg", "aiffihhig", "egffgh", "bkeghiihj", "abjjbhhbggbk",
    "aiffihhigbke", "bkffkhhkg", "bflghiihj", "aejjehhegbfl", "aibbillihhig", "bellehheg",
    "efkkflghiihj", "agjjghafggfkkfl", "aleelkaillihhig", "ghkkhl", "dgk", "aeidgk", "ajfdgk",
    "dgkeiffij", "bdeedg", "abiibggbd", "ajfbdeedg", "bdffdjjdiidg", "bfldgk", "aeibfldgk",
    "ajbbjldgk", "bellejjeidgk", "dgllgffge", "afiifggfddfl", "ajeejggjddjl", "dgllgjjgi", "ciddik",
    "aecceddek", "ajfciddik", "cjddjkkjeejf", "bdeediidc", "abccbd", "ajfbdeediidc", "bdffdjjdc",
    "bflciddik", "aecceddekbfl", "ajbbjlciddik", "bellejjecceddek", "ciddilliffie", "afccfddfl",
    "ajeediidcejddjl", "cjddjl", "chjdgk", "aeichjdgk", "acffchdgk", "chiiheehfdgk", "bdeedgchj",
    "abiibggbdchj", "acffchbdeedg", "bdffihhicfdiidg", "bflchjdgk", "aeibflchjdgk", "acbbcllchdgk",
    "bellehhecceidgk", "chjdgllgffge", "afiifggfddflchj", "aceelggldecllch", "chiilggldihl",
    "dhkkhiihj", "aejjehheddek", "aiffihhiddik", "dhkkheehf", "bdeediidjjdh", "abjjbhhbd",
    "aiffihhiddibbie", "bdffdh", "bfldhkkhiihj", "aejjehheddekbfl", "aibbillihhiddik",
    "bellehheddek", "dellefdheehiihj", "adjjdhafddfl", "aiedhl", "dhl", "dlh", "aeidlh", "ajfdlh",
    "dlheiffij", "bkedlh", "abiibkdlh", "ajfbkedlh", "bkffkjjkidlh", "bfddfh", "aeibfddfh",
    "ajbbjddjh", "beddehhejjei", "dkhhkffke", "afiifkkfddfh", "ajeejkkjddjh", "dkhhkjjki", "cigdlh",
    "aeccegdlh", "ajfcigdlh", "cjggjeejfdlh", "bkecigdlh", "abccbggbkdlh", "ajfbkecigdlh",
    "bkffkjjkcckgdlh", "bfddfhcig", "aeccegbfddfh", "ajbbjddjhcig", "beddehhejjecceg",
    "cigdkhhkffke", "afccfggfkkfddfh", "ajeejkkjddjhcig", "cjggjkkjddjh", "cdjjdl", "aeicdjjdl",
    "acffcllcd", "cdiideedffdl", "bkecdjjdl", "abiibkcdjjdl", "acffcllcdbke", "bkffcllcdfkccki",
    "bfddfccfj", "aeibfddfccfj", "acbbcd", "beddeccei", "cdjjdffdeedk", "afiifkkfddfccfj",
    "aceeckkcd", "cdiidk", "dlggliilj", "aejjelleddeg", "aiffilliddig", "dlggleelf", "bkedlggliilj",
    "abjjgllgdjbggbk", "aiffilliddigbke", "bkffgllgdfkg", "bfddfggfiifj", "aejjdffdbjeddeg",
    "aibbiddig", "beddeg", "djggjidkjjkffke", "afjdkg", "adeedkaiddig", "dkg", "gkhhkl",
    "aeigkhhkl", "ajfgkhhkl", "eiffijgkhhkl", "bleelgglh", "abiibggbhhbl", "ajfbleelgglh",
    "biffijbliilgglh", "bfkkfggfh", "aeibfkkfggfh", "ajbbjkkjggjh", "bhkkhgbehhejjei", "efggfh",
    "afiifggfh", "ajeejggjh", "gihhij", "cihhillik", "aeccehhellek", "ajfcihhillik",
    "ckhhklcjkkjeejf", "bleeliilcclh", "abccbhhbl", "ajfbleeliilcclh", "bcffcjblcclh",
    "bfkkfiifccfh", "aeccehhkffkbhek", "ajbbjkkhiihckjh", "bekcjh", "cihhiffie", "afccfh",
    "ajeehiihcejh", "cjh", "cgjjgllgk", "aeicgjjgllgk", "acffcllckkcg", "cfiifecgffgllgk",
    "bleelgglcclj", "abiibggbccbjjbl", "acffcllcbbceecg", "blfcgi", "bfkkfggfccfj",
    "aeibfkkfggfccfj", "acbbckkcg", "bckkcgbeccei", "cgjjgffge", "afiifggfccfj", "aceecg", "cgi",
    "ikjjkl", "aejjellek", "aiffillik", "ekffkl", "bleeliilj", "abjjbl", "aiffillibbie", "blf",
    "bfkkfiifj", "aejjkffkbjek", "aibbik", "bek", "efiifj", "afj", "aie", ""
};
// clang-format on

typedef struct flow4d__march {
    const flow4d_volume *volume;
    const float *smooth; /* or NULL: the volume's own values */
    double iso;
    int inside_is_less;
    int mirrored;          /* to_world turns triangles over */
    size_t width, row;     /* of a slice of points: size[0] + 2, (size[0] + 2) * (size[1] + 2) */
    uint8_t *inside[2];    /* slices z and z + 1, with a border of outside points */
    uint32_t *along[2][2]; /* vertices on edges along x, y, per slice */
    uint32_t *across;      /* vertices on edges between the slices */
    uint64_t vertex_count, triangle_count;
    float *vertices; /* NULL: only count */
    uint32_t *triangles;
} flow4d__march;

/* Value at a point of the padded slices: point 0 is voxel -1. NaN outside the volume. */
static double flow4d__march_value(const flow4d__march *m, size_t x, size_t y, size_t z) {
    const uint32_t *size = m->volume->size;
    size_t voxel;
    if (x < 1 || y < 1 || z < 1 || x > size[0] || y > size[1] || z > size[2]) {
        return (double)NAN;
    }
    voxel = x - 1 + size[0] * (y - 1 + size[1] * (z - 1));
    return m->smooth ? (double)m->smooth[voxel] : flow4d__value(m->volume, voxel);
}

static void flow4d__march_slice(const flow4d__march *m, size_t z, uint8_t *inside) {
    size_t x, y;
    for (y = 0; y < m->row / m->width; y++) {
        for (x = 0; x < m->width; x++) {
            double v = flow4d__march_value(m, x, y, z);
            inside[y * m->width + x] = m->inside_is_less ? v < m->iso : v >= m->iso;
        }
    }
}

/* The vertex on the edge from point (x, y, z) along an axis, whose ends differ. Not nearer to an
   end than 1/1024, so that no triangle shrinks to nothing; half-way when an end has no value. */
static uint32_t flow4d__march_vertex(flow4d__march *m, size_t x, size_t y, size_t z, int axis) {
    if (m->vertices) {
        double a = flow4d__march_value(m, x, y, z);
        double b = flow4d__march_value(m, x + (axis == 0), y + (axis == 1), z + (axis == 2));
        double t = (m->iso - a) / (b - a), index[3], p[3];
        float *vertex = m->vertices + 3 * m->vertex_count;
        t = flow4d__number(t) ? fmin(fmax(t, 1.0 / 1024), 1023.0 / 1024) : 0.5;
        index[0] = (double)x - 1.0;
        index[1] = (double)y - 1.0;
        index[2] = (double)z - 1.0;
        index[axis] += t;
        flow4d__apply(m->volume->to_world, index, p);
        vertex[0] = (float)p[0];
        vertex[1] = (float)p[1];
        vertex[2] = (float)p[2];
    }
    return (uint32_t)m->vertex_count++;
}

/* Vertices on the edges of slice z + 1 and between it and slice z. */
static void flow4d__march_edges(flow4d__march *m, size_t z) {
    size_t x, y, i = 0, height = m->row / m->width;
    for (y = 0; y < height; y++) {
        for (x = 0; x < m->width; x++, i++) {
            const uint8_t *next = m->inside[1];
            if (m->inside[0][i] != next[i]) {
                m->across[i] = flow4d__march_vertex(m, x, y, z, 2);
            }
            if (x + 1 < m->width && next[i] != next[i + 1]) {
                m->along[1][0][i] = flow4d__march_vertex(m, x, y, z + 1, 0);
            }
            if (y + 1 < height && next[i] != next[i + m->width]) {
                m->along[1][1][i] = flow4d__march_vertex(m, x, y, z + 1, 1);
            }
        }
    }
}

/* The vertex on edge 0..11 of the cell whose first corner is point i of the slice. */
static uint32_t flow4d__march_edge(const flow4d__march *m, size_t i, int edge) {
    int axis = edge / 4, u = edge & 1, v = (edge >> 1) & 1;
    if (axis == 2) {
        return m->across[i + (size_t)u + (v ? m->width : 0)];
    }
    return m->along[v][axis][i + (u ? (axis == 0 ? m->width : 1) : 0)];
}

static void flow4d__march_cells(flow4d__march *m) {
    size_t x, y, height = m->row / m->width;
    for (y = 0; y + 1 < height; y++) {
        for (x = 0; x + 1 < m->width; x++) {
            size_t i = y * m->width + x;
            const char *letter;
            unsigned which = 0;
            int c;
            for (c = 0; c < 8; c++) {
                const uint8_t *slice = m->inside[c >> 2];
                which |= (unsigned)slice[i + (c & 1) + (c & 2 ? m->width : 0)] << c;
            }
            for (letter = flow4d__cases[which]; *letter; letter += 3) {
                if (m->triangles) {
                    uint32_t *t = m->triangles + 3 * m->triangle_count;
                    t[0] = flow4d__march_edge(m, i, letter[0] - 'a');
                    t[1] = flow4d__march_edge(m, i, letter[m->mirrored ? 2 : 1] - 'a');
                    t[2] = flow4d__march_edge(m, i, letter[m->mirrored ? 1 : 2] - 'a');
                }
                m->triangle_count++;
            }
        }
    }
}

/* All cells: counts, or with arrays there, fills them. `done`: slices before, for the host. */
static lao_result flow4d__march_run(const flow4d_host *host, flow4d__march *m, size_t done) {
    size_t z, slices = (size_t)m->volume->size[2] + 1;
    m->vertex_count = m->triangle_count = 0;
    memset(m->inside[0], 0, m->row);
    for (z = 0; z < slices; z++) {
        uint8_t *inside = m->inside[0];
        uint32_t *along[2];
        flow4d__march_slice(m, z + 1, m->inside[1]);
        flow4d__march_edges(m, z);
        flow4d__march_cells(m);
        memcpy(along, m->along[0], sizeof along);
        memcpy(m->along[0], m->along[1], sizeof along);
        memcpy(m->along[1], along, sizeof along);
        m->inside[0] = m->inside[1];
        m->inside[1] = inside;
        if (lao__job_cancelled(&host->job, done + z + 1, 2 * (uint64_t)slices)) {
            return flow4d__fail(host, FLOW4D_LOG_CANCELLED, "flow4d_surface_make");
        }
    }
    return LAO_OK;
}

/* Counts, allocates, fills. */
static lao_result flow4d__march_make(const flow4d_host *host, flow4d__march *m,
                                     flow4d_surface *surface) {
    size_t size = 3 * sizeof(float);
    lao_result result = flow4d__march_run(host, m, 0);
    if (result != LAO_OK) {
        return result;
    }
    if (m->vertex_count > 0xfffffffeu || m->triangle_count > 0xfffffffeu) {
        return flow4d__fail(host, FLOW4D_LOG_COUNT, "vertices or triangles of the surface");
    }
    memset(surface, 0, sizeof *surface);
    surface->allocator = host->allocator;
    if (m->triangle_count == 0) {
        return LAO_OK;
    }
    surface->vertex_count = (uint32_t)m->vertex_count;
    surface->triangle_count = (uint32_t)m->triangle_count;
    surface->vertices = (float *)lao__new(&host->allocator, surface->vertex_count, size);
    surface->triangles =
        (uint32_t *)lao__new(&host->allocator, surface->triangle_count, 3 * sizeof(uint32_t));
    if (!surface->vertices || !surface->triangles) {
        result = flow4d__fail(host, FLOW4D_LOG_MEMORY, "the surface");
    } else {
        m->vertices = surface->vertices;
        m->triangles = surface->triangles;
        result = flow4d__march_run(host, m, (size_t)m->volume->size[2] + 1);
    }
    if (result != LAO_OK) {
        flow4d_surface_free(surface);
    }
    return result;
}

/* One 1-2-1 pass along a row of `count` values, `stride` apart; the ends are repeated. A voxel
   without a value keeps none and has no weight for its neighbours. */
static void flow4d__smooth_row(float *values, size_t stride, size_t count) {
    float before = values[0];
    size_t i;
    for (i = 0; i < count; i++) {
        float here = values[i * stride];
        float after = i + 1 < count ? values[(i + 1) * stride] : here;
        if (here == here) {
            double a = before == before ? (double)before : (double)here;
            double b = after == after ? (double)after : (double)here;
            values[i * stride] = (float)(0.25 * a + 0.5 * (double)here + 0.25 * b);
        }
        before = here;
    }
}

static void flow4d__smooth(float *values, const uint32_t size[3]) {
    size_t x = size[0], y = size[1], z = size[2], i, j;
    for (i = 0; i < y * z; i++) {
        flow4d__smooth_row(values + i * x, 1, x);
    }
    for (j = 0; j < z; j++) {
        for (i = 0; i < x; i++) {
            flow4d__smooth_row(values + j * x * y + i, x, y);
        }
    }
    for (i = 0; i < x * y; i++) {
        flow4d__smooth_row(values + i, x * y, z);
    }
}

/* A smoothed copy of the volume; NULL when there is no memory. */
static float *flow4d__smoothed(const flow4d_host *host, const flow4d_volume *volume,
                               uint32_t passes) {
    size_t i, count = flow4d__count(volume->size, 1, sizeof(float));
    float *values = (float *)lao__new(&host->allocator, count, sizeof(float));
    for (i = 0; values && i < count; i++) {
        values[i] = (float)flow4d__value(volume, i);
    }
    for (i = 0; values && i < passes; i++) {
        flow4d__smooth(values, volume->size);
    }
    return values;
}

/* Memory for slices of points: `bytes` of flags behind `words` of vertices. */
static lao_result flow4d__march_memory(const flow4d_host *host, flow4d__march *m,
                                       flow4d_surface *surface) {
    const lao_allocator *a = &host->allocator;
    uint32_t *words = (uint32_t *)lao__new(a, m->row, 5 * sizeof(uint32_t));
    uint8_t *flags = (uint8_t *)lao__new(a, m->row, 2);
    lao_result result;
    if (!words || !flags) {
        result = flow4d__fail(host, FLOW4D_LOG_MEMORY, "slices of the surface");
    } else {
        m->inside[0] = flags;
        m->inside[1] = flags + m->row;
        m->along[0][0] = words;
        m->along[0][1] = words + m->row;
        m->along[1][0] = words + 2 * m->row;
        m->along[1][1] = words + 3 * m->row;
        m->across = words + 4 * m->row;
        result = flow4d__march_make(host, m, surface);
    }
    lao__delete(a, words, m->row, 5 * sizeof(uint32_t));
    lao__delete(a, flags, m->row, 2);
    return result;
}

lao_result flow4d_surface_make(const flow4d_host *host, const flow4d_volume *volume, double iso,
                               const flow4d_surface_settings *settings, flow4d_surface *surface) {
    flow4d_host h = flow4d__host(host);
    flow4d__march m;
    flow4d_surface made;
    uint32_t padded[3], smoothing = settings ? settings->smoothing : 0;
    double unused[12];
    float *smooth = NULL;
    lao_result result;
    if (!surface) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "surface of flow4d_surface_make");
    }
    result = flow4d__volume_check(&h, volume, unused);
    if (result != LAO_OK) {
        return result;
    }
    if (!flow4d__number(iso)) {
        return flow4d__fail(&h, FLOW4D_LOG_ISO, "flow4d_surface_make");
    }
    if (smoothing > 100) {
        return flow4d__setting_fail(&h, "smoothing", (double)smoothing);
    }
    memset(&m, 0, sizeof m);
    padded[0] = volume->size[0] + 2;
    padded[1] = volume->size[1] + 2;
    padded[2] = 1;
    m.row = padded[0] < 2 || padded[1] < 2 ? 0 : flow4d__count(padded, 1, 5 * sizeof(uint32_t));
    if (m.row == 0) {
        return flow4d__fail(&h, FLOW4D_LOG_SIZE, "a slice with a border");
    }
    if (smoothing) {
        smooth = flow4d__smoothed(&h, volume, smoothing);
        if (!smooth) {
            return flow4d__fail(&h, FLOW4D_LOG_MEMORY, "the smoothed volume");
        }
    }
    m.volume = volume;
    m.smooth = smooth;
    m.iso = iso;
    m.inside_is_less = settings && settings->inside_is_less;
    m.mirrored = flow4d__determinant(volume->to_world) < 0.0;
    m.width = padded[0];
    result = flow4d__march_memory(&h, &m, &made);
    lao__delete(&h.allocator, smooth, flow4d__count(volume->size, 1, sizeof(float)), sizeof(float));
    if (result == LAO_OK) {
        *surface = made;
    }
    return result;
}

void flow4d_surface_free(flow4d_surface *surface) {
    if (!surface || !surface->allocator.release) {
        return;
    }
    lao__delete(&surface->allocator, surface->vertices, surface->vertex_count, 3 * sizeof(float));
    lao__delete(&surface->allocator, surface->triangles, surface->triangle_count,
                3 * sizeof(uint32_t));
    memset(surface, 0, sizeof *surface);
}

#ifdef __cplusplus
}
#endif

#endif /* FLOW4D_IMPLEMENTATION_DONE */
#endif /* FLOW4D_IMPLEMENTATION */
