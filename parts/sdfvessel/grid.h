/* ================================================================================================
 * grid: the distance field of a tree on cells that list the cones near them, built layer by layer,
   and read at a point. Uses host. */

enum { SDV__AXIS = SDV_AXIS };
#define SDV__EXACT 16777216u /* floats count to here */

static sdv_box sdv__grid_box(const sdv_grid *g) {
    sdv_box box;
    box.origin = g->origin;
    box.cell = g->cell;
    box.size = lao_v3_make((float)g->size[0], (float)g->size[1], (float)g->size[2]);
    return box;
}
static size_t sdv__row(const sdv_grid *g, uint32_t y, uint32_t z) {
    return (size_t)g->size[0] * (y + (size_t)g->size[1] * z);
}
static size_t sdv__layer_size(const sdv_grid *g) {
    return (size_t)g->size[0] * g->size[1];
}
/* ---- which cells list something: a bit each, words along x */
static uint32_t sdv__parts(uint32_t n, uint32_t size) {
    return (n + size - 1) / size;
}
static uint32_t sdv__words(const sdv_grid *g) {
    return sdv__parts(g->size[0], 32);
}
/* row: y + size[1] z */
static uint32_t *sdv__bits(const sdv_grid *g, size_t row) {
    return g->occupied + sdv__words(g) * row;
}
/* The first bit from x on that is set; `end`: none before it. */
static uint32_t sdv__next_bit(const uint32_t *bits, uint32_t x, uint32_t end) {
    while (x < end) {
        uint32_t word = bits[x / 32] >> (x % 32);
        if (word & 1u) {
            return x;
        }
        x = word ? x + 1 : (x | 31u) + 1;
    }
    return end;
}

/* ---- the box */
static void sdv__ball_bounds(const lao_v4 *balls, uint32_t count, double low[3], double high[3]) {
    uint32_t i, k;
    for (i = 0; i < count; i++) {
        for (k = 0; k < 3; k++) {
            double p = (double)sdv__v4_at(balls[i], k);
            double a = p - (double)balls[i].w, b = p + (double)balls[i].w;
            low[k] = i == 0 || a < low[k] ? a : low[k];
            high[k] = i == 0 || b > high[k] ? b : high[k];
        }
    }
}
/* The array of a node attribute, where it has so many components. */
static const float *sdv__node_values(const sdv_tree *tree, const char *name, uint32_t components) {
    uint32_t i;
    for (i = 0; i < tree->node_attribute_count; i++) {
        const sdv_attribute *a = &tree->node_attributes[i];
        if (strcmp(a->name, name) == 0 && (a->components ? a->components : 1) == components) {
            return a->values;
        }
    }
    return NULL;
}
/* Of the noise at a node, mm. */
static float sdv__amplitude(const sdv_tree *tree, uint32_t node) {
    const float *values = sdv__node_values(tree, SDV_UNCERTAINTY, 1);
    float v = values ? values[node] : 0.0f;
    return v > 0.0f ? lao_min(v, 0.75f * tree->nodes[node].w) : 0.0f;
}
static float sdv__ratio(const float *ratios, uint32_t node) {
    float r = ratios ? ratios[node] : 1.0f;
    return r > 0.0f ? lao_min(lao_max(r, 0.1f), 1.0f) : 1.0f;
}
/* The greatest amplitude of all nodes, mm. */
static float sdv__most_amplitude(const sdv_tree *tree) {
    float most = 0.0f;
    uint32_t i;
    for (i = 0; i < tree->node_count && sdv__node_values(tree, SDV_UNCERTAINTY, 1); i++) {
        most = lao_max(most, sdv__amplitude(tree, i));
    }
    return most;
}
static bool sdv__has_forms(const sdv_tree *tree) {
    const float *ratios = sdv__node_values(tree, SDV_SECTION_RATIO, 1);
    uint32_t i;
    for (i = 0; i < tree->node_count && ratios; i++) {
        if (sdv__ratio(ratios, i) < 1.0f) {
            return true;
        }
    }
    return sdv__most_amplitude(tree) > 0.0f;
}
static void sdv__tree_bounds(const sdv_tree *tree, double low[3], double high[3]) {
    double most = (double)sdv__most_amplitude(tree);
    uint32_t i;
    sdv__ball_bounds(tree->nodes, tree->node_count, low, high);
    for (i = 0; i < 3; i++) {
        low[i] -= most;
        high[i] += most;
    }
}
/* Cubic cells around all balls, and two more at every side. */
static int sdv__grid_fit(const sdv_tree *tree, uint32_t resolution, sdv_grid *g) {
    double low[3], high[3], most = 0;
    float origin[3];
    uint32_t k;
    if (resolution < 16 || resolution > SDV__AXIS) {
        return 0;
    }
    sdv__tree_bounds(tree, low, high);
    for (k = 0; k < 3; k++) {
        most = high[k] - low[k] > most ? high[k] - low[k] : most;
    }
    g->cell = most > 0 ? (float)(most / (double)(resolution - 4) * (1 + 1e-6)) : 1.0f;
    g->cell = g->cell > 0.0f ? g->cell : 1.0f;
    for (k = 0; k < 3; k++) {
        g->size[k] = (uint32_t)ceil((high[k] - low[k]) / (double)g->cell) + 4;
        origin[k] = (float)(0.5 * (low[k] + high[k]) - 0.5 * (double)g->size[k] * (double)g->cell);
    }
    g->origin = lao_v3_make(origin[0], origin[1], origin[2]);
    return 1;
}
static int sdv__grid_frame(const sdv_tree *tree, const sdv_grid_desc *desc, sdv_grid *g) {
    uint32_t k;
    double cells = 1;
    if (desc->origin) {
        g->origin = lao_v3_make(desc->origin[0], desc->origin[1], desc->origin[2]);
        g->cell = desc->cell;
        memcpy(g->size, desc->size, sizeof g->size);
    } else if (!sdv__grid_fit(tree, desc->resolution ? desc->resolution : 128, g)) {
        return 0;
    }
    for (k = 0; k < 3; k++) {
        cells *= (double)g->size[k];
        if (g->size[k] < 1 || g->size[k] > SDV__AXIS) {
            return 0;
        }
    }
    if (!(cells <= SDV__EXACT && g->cell > 0.0f && g->cell < 1e30f)) {
        return 0;
    }
    g->cell_count = (uint32_t)cells;
    return 1;
}
/* Are all balls inside the box? */
static int sdv__grid_holds(const sdv_grid *g, const sdv_tree *tree) {
    double low[3], high[3];
    uint32_t k;
    sdv__tree_bounds(tree, low, high);
    for (k = 0; k < 3; k++) {
        double origin = (double)sdv__v3_at(g->origin, k);
        double end = origin + (double)g->size[k] * (double)g->cell;
        if (!(low[k] >= origin && high[k] <= end)) {
            return 0;
        }
    }
    return 1;
}

/* ---- cones */
static int sdv__is_lone(const sdv_tree *tree, uint32_t node) {
    return tree->parents[node] == SDV_NONE && tree->child_counts[node] == 0;
}
static uint32_t sdv__lone_count(const sdv_tree *tree) {
    uint32_t i, n = 0;
    for (i = 0; i < tree->node_count; i++) {
        n += (uint32_t)sdv__is_lone(tree, i);
    }
    return n;
}
static void sdv__cone_set(const sdv_tree *tree, const uint32_t *nodes, lao_v4 *cone) {
    uint32_t k;
    for (k = 0; k < 2; k++) {
        cone[k] = tree->nodes[nodes[k]];
        cone[k].w += sdv__amplitude(tree, nodes[k]);
    }
}
/* ---- forms */
static lao_v3 sdv__minor(const float *axes, uint32_t node) {
    const lao_v3 z = lao_v3_make(0.0f, 0.0f, 1.0f);
    const float *v;
    if (!axes) {
        return z;
    }
    v = axes + 3 * (size_t)node;
    return lao_v3_unit(lao_v3_make(v[0], v[1], v[2]), z);
}
/* Of every node: its shorter axis, turned to a right angle to the mean of its cones, so that cones
   that meet there have the same ellipsoid. */
static void sdv__sections_fill(const sdv_tree *tree, sdv_grid *g) {
    const float *ratios = sdv__node_values(tree, SDV_SECTION_RATIO, 1);
    const float *axes = sdv__node_values(tree, SDV_SECTION_AXIS, 3);
    uint32_t i;
    memset(g->sections, 0, tree->node_count * sizeof *g->sections);
    for (i = 0; i < 2 * g->cone_count; i++) {
        const lao_v4 *cone = g->cones + 2 * (size_t)(i / 2);
        lao_v4 *node = &g->sections[g->cone_nodes[i]];
        lao_v3 along = lao_v3_unit(
            lao_v3_make(cone[1].x - cone[0].x, cone[1].y - cone[0].y, cone[1].z - cone[0].z),
            lao_v3_make(0.0f, 0.0f, 0.0f));
        *node = lao_v4_make(node->x + along.x, node->y + along.y, node->z + along.z, 0.0f);
    }
    for (i = 0; i < tree->node_count; i++) {
        lao_v3 along = lao_v3_make(g->sections[i].x, g->sections[i].y, g->sections[i].z);
        lao_v3 m = sdv__minor(axes, i);
        float size = lao_v3_dot(along, along);
        if (size > 0.0f) {
            m = lao_v3_along(m, along, -lao_v3_dot(m, along) / size);
        }
        m = lao_v3_unit(m, sdv_perpendicular(along));
        g->sections[i] = lao_v4_make(m.x, m.y, m.z, 1.0f / sdv__ratio(ratios, i) - 1.0f);
    }
}
/* The mean radius, and no less than twice the greatest amplitude: steeper bumps come off. */
static float sdv__bump_size(const sdv_tree *tree) {
    double sum = 0;
    uint32_t i, n = 0;
    if (tree->bump_size > 0.0f && tree->bump_size < SDV_FAR) {
        return tree->bump_size;
    }
    for (i = 0; i < tree->node_count; i++) {
        if (sdv__amplitude(tree, i) > 0.0f) {
            sum += (double)tree->nodes[i].w;
            n++;
        }
    }
    return n ? lao_max((float)(sum / n), 2.0f * sdv__most_amplitude(tree)) : 1.0f;
}
/* How much sdv_form_level rises per mm at most where it is below sdv_form_most: by what space is
   stretched, by the change of section (times how far the place then is from the nearest ball's
   centre) and of amplitude (under noise of up to 2) along the cone, and by the noise. */
static float sdv__form_rise(const lao_v4 *cone, double length, const sdv_form *form) {
    double c = (double)lao_v3_dot(lao_v3_make(form->a.x, form->a.y, form->a.z),
                                  lao_v3_make(form->b.x, form->b.y, form->b.z));
    double a = (double)form->a.w, b = (double)form->b.w, half = 0.5 * (a + b);
    double turn = 0.5 * fabs(a - b) + sqrt(fmax(half * half - a * b * c * c, 0));
    double reach = (double)(lao_max(cone[0].w, cone[1].w) + sdv_form_most(cone[0], cone[1], *form));
    double steep = (double)(lao_max(form->bump.x, form->bump.y) * form->bump.w * SDV_NOISE_SLOPE);
    double rise = 1 + fmax(a, b) + steep;
    if (length > 0) {
        rise += (turn * reach + 2 * fabs((double)(form->bump.x - form->bump.y))) / length;
    }
    return (float)(rise * (1 + 1e-5));
}
static sdv_form sdv__form(const sdv_tree *tree, const sdv_grid *g, uint32_t i, float size) {
    const lao_v4 *cone = g->cones + 2 * (size_t)i;
    uint32_t a = g->cone_nodes[2 * (size_t)i], b = g->cone_nodes[2 * (size_t)i + 1];
    double x = (double)cone[1].x - (double)cone[0].x, y = (double)cone[1].y - (double)cone[0].y;
    double z = (double)cone[1].z - (double)cone[0].z, s = sqrt(x * x + y * y + z * z);
    sdv_form form;
    if (s <= fabs((double)(cone[0].w - cone[1].w))) { /* one ball holds the other: that alone */
        a = cone[0].w < cone[1].w ? b : a;
        b = a;
    }
    form.a = g->sections[a];
    form.b = g->sections[b];
    form.bump = lao_v4_make(sdv__amplitude(tree, a), sdv__amplitude(tree, b), 1.0f, 1.0f / size);
    form.bump.z = sdv__form_rise(cone, s, &form);
    return form;
}
static sdv_form sdv__form_of(const sdv_grid *g, float cone) {
    const lao_v4 *f = g->forms + 3 * (size_t)cone;
    sdv_form form;
    form.a = f[0];
    form.b = f[1];
    form.bump = f[2];
    return form;
}
static void sdv__forms_fill(const sdv_tree *tree, sdv_grid *g) {
    uint32_t i;
    float size;
    if (!g->forms) {
        return;
    }
    size = sdv__bump_size(tree);
    sdv__sections_fill(tree, g);
    for (i = 0; i < g->cone_count; i++) {
        sdv_form form = sdv__form(tree, g, i, size);
        lao_v4 *to = g->forms + 3 * (size_t)i;
        to[0] = form.a;
        to[1] = form.b;
        to[2] = form.bump;
    }
}
/* Memory for cones, with forms behind them where the tree has any. */
static void sdv__cones_take(const sdv_tree *tree, sdv_grid *g) {
    uint64_t texels = 2 * (uint64_t)g->cone_count;
    uint64_t forms = sdv__has_forms(tree) ? 3 * (uint64_t)g->cone_count : 0;
    uint64_t sections = forms ? tree->node_count : 0;
    g->cones = (lao_v4 *)lao__take(&g->allocator, texels + forms + sections, sizeof *g->cones);
    g->forms = g->cones && forms ? g->cones + texels : NULL;
    g->sections = g->forms ? g->forms + forms : NULL;
    g->cone_nodes = (uint32_t *)lao__take(&g->allocator, texels, sizeof *g->cone_nodes);
}
static void sdv__cones_fill(const sdv_tree *tree, sdv_grid *g) {
    uint32_t i, n = tree->segment_count;
    for (i = 0; i < n; i++) {
        g->cone_nodes[2 * (size_t)i] = tree->segments[i].parent;
        g->cone_nodes[2 * (size_t)i + 1] = tree->segments[i].child;
    }
    for (i = 0; i < tree->node_count; i++) {
        if (sdv__is_lone(tree, i)) {
            g->cone_nodes[2 * (size_t)n] = i;
            g->cone_nodes[2 * (size_t)n + 1] = i;
            n++;
        }
    }
    for (i = 0; i < n; i++) {
        sdv__cone_set(tree, g->cone_nodes + 2 * (size_t)i, g->cones + 2 * (size_t)i);
    }
    sdv__forms_fill(tree, g);
}

/* ---- which cells a cone may be listed in: plane by plane, row by row. The balls of a cone have
   centre a + t (b - a) and radius ra + t (rb - ra); those that reach a plane across an axis have t
   in an interval. */
typedef struct sdv__raster {
    double a[3], b[3], ra, rb; /* radii with the reach of lists and a margin for rounding */
} sdv__raster;

static sdv__raster sdv__raster_make(const sdv_grid *g, const lao_v4 *cone) {
    sdv__raster r;
    double reach = (double)sdv_list_reach(g->cell) + 0.02 * (double)g->cell;
    uint32_t k;
    for (k = 0; k < 3; k++) {
        r.a[k] = (double)sdv__v4_at(cone[0], k);
        r.b[k] = (double)sdv__v4_at(cone[1], k);
        reach += 1e-6 * (fabs(r.a[k]) + fabs(r.b[k]) + fabs((double)sdv__v3_at(g->origin, k)));
    }
    r.ra = (double)cone[0].w * (1 + 1e-6) + reach;
    r.rb = (double)cone[1].w * (1 + 1e-6) + reach;
    return r;
}
/* Narrows t to the balls that reach the plane `at` across an axis; 0: none. */
static int sdv__raster_cut(const sdv__raster *r, int axis, double at, double t[2]) {
    double d = r->b[axis] - r->a[axis], dr = r->rb - r->ra, from = r->a[axis] - at;
    double slope[2], value[2];
    int i;
    slope[0] = d - dr; /* centre - at <= radius */
    value[0] = r->ra - from;
    slope[1] = -d - dr; /* at - centre <= radius */
    value[1] = r->ra + from;
    for (i = 0; i < 2; i++) {
        double limit = value[i] / slope[i];
        if (slope[i] > 0) {
            t[1] = limit < t[1] ? limit : t[1];
        } else if (slope[i] < 0) {
            t[0] = limit > t[0] ? limit : t[0];
        } else if (value[i] < 0) {
            return 0;
        }
    }
    return t[0] <= t[1];
}
/* Cells of an axis that the balls of t may reach: range[0] .. range[1] - 1. */
static void sdv__raster_range(const sdv_grid *g, const sdv__raster *r, int axis, const double t[2],
                              uint32_t range[2]) {
    double low = 0, high = 0, origin = (double)sdv__v3_at(g->origin, (uint32_t)axis),
           n = (double)g->size[axis];
    int i;
    for (i = 0; i < 2; i++) {
        double c = r->a[axis] + t[i] * (r->b[axis] - r->a[axis]);
        double radius = r->ra + t[i] * (r->rb - r->ra);
        low = i == 0 || c - radius < low ? c - radius : low;
        high = i == 0 || c + radius > high ? c + radius : high;
    }
    low = ceil((low - origin) / (double)g->cell - 0.5); /* centres within */
    high = floor((high - origin) / (double)g->cell - 0.5) + 1;
    range[0] = low > 0 ? (low < n ? (uint32_t)low : g->size[axis]) : 0;
    range[1] = high > 0 ? (high < n ? (uint32_t)high : g->size[axis]) : 0;
}
static double sdv__plane(const sdv_grid *g, int axis, uint32_t i) {
    return (double)sdv__v3_at(g->origin, (uint32_t)axis) + ((double)i + 0.5) * (double)g->cell;
}
/* Calls visit(arg, cell, centre) for every cell of layer z that the cone may be listed in. */
typedef void (*sdv__visitor)(void *arg, uint32_t cell, lao_v3 centre);
static void sdv__raster_layer(const sdv_grid *g, const lao_v4 *cone, uint32_t z, sdv__visitor visit,
                              void *arg) {
    sdv__raster r = sdv__raster_make(g, cone);
    sdv_box box = sdv__grid_box(g);
    double t[2] = {0, 1};
    uint32_t rows[2], y, x;
    if (!sdv__raster_cut(&r, 2, sdv__plane(g, 2, z), t)) {
        return;
    }
    sdv__raster_range(g, &r, 1, t, rows);
    for (y = rows[0]; y < rows[1]; y++) {
        double u[2];
        uint32_t columns[2];
        u[0] = t[0];
        u[1] = t[1];
        if (!sdv__raster_cut(&r, 1, sdv__plane(g, 1, y), u)) {
            continue;
        }
        sdv__raster_range(g, &r, 0, u, columns);
        for (x = columns[0]; x < columns[1]; x++) {
            visit(arg, (uint32_t)sdv__row(g, y, z) + x, sdv_cell_centre(box, x, y, z));
        }
    }
}
static void sdv__raster_layers(const sdv_grid *g, const lao_v4 *cone, uint32_t range[2]) {
    sdv__raster r = sdv__raster_make(g, cone);
    const double t[2] = {0, 1};
    sdv__raster_range(g, &r, 2, t, range);
}
static int sdv__is_listed(const sdv_grid *g, lao_v3 centre, const lao_v4 *cone) {
    return sdv_round_cone(centre, cone[0], cone[1]) <= sdv_list_reach(g->cell);
}

/* ---- lists: counted, then filled, layer by layer; cones come in ascending order */
typedef struct sdv__fill {
    sdv_grid *grid;
    const uint32_t *first, *binned; /* cones of each layer, ascending */
    uint64_t *layer_ids;            /* entries of each layer; later where they begin */
    uint32_t cone;
} sdv__fill;

static void sdv__count_cell(void *arg, uint32_t cell, lao_v3 centre) {
    sdv__fill *f = (sdv__fill *)arg;
    sdv_grid *g = f->grid;
    if (sdv__is_listed(g, centre, g->cones + 2 * (size_t)f->cone)) {
        g->cells[cell].w += 1.0f;
    }
}
static void sdv__fill_cell(void *arg, uint32_t cell, lao_v3 centre) {
    sdv__fill *f = (sdv__fill *)arg;
    sdv_grid *g = f->grid;
    if (sdv__is_listed(g, centre, g->cones + 2 * (size_t)f->cone)) {
        lao_v4 *c = g->cells + cell;
        g->ids[(size_t)c->z + (size_t)c->x] = (float)f->cone;
        c->x += 1.0f;
    }
}
static void sdv__raster_binned(const sdv__fill *f, uint32_t z, sdv__visitor visit) {
    sdv__fill own = *f;
    uint32_t i;
    for (i = f->first[z]; i < f->first[z + 1]; i++) {
        own.cone = f->binned[i];
        sdv__raster_layer(own.grid, own.grid->cones + 2 * (size_t)own.cone, z, visit, &own);
    }
}
static void sdv__count_layer(void *arg, uint32_t z) {
    sdv__fill *f = (sdv__fill *)arg;
    const sdv_grid *g = f->grid;
    lao_v4 *cells = g->cells + sdv__row(g, 0, z);
    size_t i, n = sdv__layer_size(g), rows = (size_t)g->size[1] * z;
    uint64_t sum = 0;
    memset(cells, 0, n * sizeof *cells);
    sdv__raster_binned(f, z, sdv__count_cell);
    memset(sdv__bits(g, rows), 0, sizeof(uint32_t) * sdv__words(g) * g->size[1]);
    for (i = 0; i < n; i++) {
        if (cells[i].w > 0.0f) {
            uint32_t x = (uint32_t)(i % g->size[0]);
            sdv__bits(g, rows + i / g->size[0])[x / 32] |= 1u << (x % 32);
            sum += (uint32_t)cells[i].w;
        }
    }
    f->layer_ids[z] = sum;
}

/* ---- nearest occupied cells: exact, separable, ties to the lowest index (METHODS 5.2) */
/* Lower envelope of parabolas apart[u] + (x - u)^2 in integers (Meijster 2000): ties to the lower
   u. apart < 0: no parabola. */
typedef struct sdv__envelope {
    int32_t place[SDV__AXIS], until[SDV__AXIS]; /* winners and the last x where they win */
    int32_t count;
} sdv__envelope;
static void sdv__envelope_make(sdv__envelope *e, const int32_t *apart, int32_t n) {
    int32_t u;
    e->count = 0;
    for (u = 0; u < n; u++) {
        int32_t until = -1;
        if (apart[u] < 0) {
            continue;
        }
        while (e->count > 0) { /* up to where does the last winner win against u? */
            int32_t i = e->place[e->count - 1];
            int32_t start = e->count > 1 ? e->until[e->count - 2] + 1 : 0;
            int32_t top = u * u - i * i + apart[u] - apart[i], bottom = 2 * (u - i);
            until = top >= 0 ? top / bottom : -((-top + bottom - 1) / bottom);
            if (until >= start) {
                break;
            }
            e->count--;
        }
        if (e->count > 0 && until >= n - 1) {
            continue;
        }
        if (e->count > 0) {
            e->until[e->count - 1] = until;
        }
        e->place[e->count] = u;
        e->until[e->count++] = n - 1;
    }
}

/* The nearest occupied x of each x of a row, of two as near the lower; SDV_NONE: none. */
static void sdv__row_nearest(const uint32_t *bits, uint32_t nx, uint32_t *row) {
    uint32_t x = 0, last = SDV_NONE, next = sdv__next_bit(bits, 0, nx);
    while (next < nx) {
        uint32_t until = last == SDV_NONE ? 0 : (last + next) / 2 + 1;
        for (; x < until; x++) {
            row[x] = last;
        }
        for (; x <= next; x++) {
            row[x] = next;
        }
        last = next;
        next = sdv__next_bit(bits, next + 1, nx);
    }
    for (; x < nx; x++) {
        row[x] = last;
    }
}
static void sdv__layer_rows(const sdv_grid *g, uint32_t z, uint32_t *rows) {
    uint32_t y;
    for (y = 0; y < g->size[1]; y++) {
        sdv__row_nearest(sdv__bits(g, y + (size_t)g->size[1] * z), g->size[0],
                         rows + (size_t)g->size[0] * y);
    }
}
/* What a cell keeps to be found anew in a change. */
enum { SDV__LISTED = 1, SDV__NEARER = 2, SDV__TURNED = 4 }; /* its list, nearest cell, `layer` */
/* From the rows x + 65536 y of the nearest occupied cell of the layer. `wanted` (Optional): the x
   that need it; `stale` (Optional): gets SDV__TURNED where that is news. */
static void sdv__layer_columns(const sdv_grid *g, const uint32_t *rows, const unsigned char *wanted,
                               uint32_t *out, unsigned char *stale) {
    uint32_t x, y, nx = g->size[0], ny = g->size[1];
    for (x = 0; x < nx; x++) {
        int32_t apart[SDV__AXIS], k = 0;
        uint32_t best[SDV__AXIS];
        sdv__envelope e;
        if (wanted && !wanted[x]) {
            continue;
        }
        for (y = 0; y < ny; y++) {
            int32_t d = (int32_t)rows[(size_t)nx * y + x] - (int32_t)x;
            best[y] = rows[(size_t)nx * y + x];
            apart[y] = best[y] == SDV_NONE ? -1 : d * d;
        }
        sdv__envelope_make(&e, apart, (int32_t)ny);
        for (y = 0; y < ny; y++) {
            uint32_t value = SDV_NONE;
            if (e.count > 0) {
                k += (int32_t)y > e.until[k];
                value = best[e.place[k]] + 65536 * (uint32_t)e.place[k];
            }
            if (stale && out[(size_t)nx * y + x] != value) {
                stale[(size_t)nx * y + x] |= SDV__TURNED;
            }
            out[(size_t)nx * y + x] = value;
        }
    }
}
static void sdv__fill_layer(void *arg, uint32_t z) {
    sdv__fill *f = (sdv__fill *)arg;
    sdv_grid *g = f->grid;
    size_t i, first = sdv__row(g, 0, z), n = sdv__layer_size(g);
    uint64_t at = f->layer_ids[z];
    for (i = first; i < first + n; i++) {
        g->cells[i].z = (float)at;
        at += (uint32_t)g->cells[i].w;
    }
    sdv__raster_binned(f, z, sdv__fill_cell);
    sdv__layer_rows(g, z, g->layer + first);
    sdv__layer_columns(g, g->layer + first, NULL, g->layer + first, NULL);
}

/* The nearest occupied cell of a cell, `apart2` cells squared away. `stale` (Optional): gets
   SDV__NEARER where that is news. */
static void sdv__nearest_write(sdv_grid *g, size_t cell, size_t nearest, int32_t apart2,
                               unsigned char *stale) {
    lao_v4 *c = g->cells + cell;
    if (stale) {
        if (c->y == (float)nearest) {
            return;
        }
        stale[cell] |= SDV__NEARER;
    }
    c->y = (float)nearest;
    if (!(c->w > 0.0f)) {
        c->z = sdv_far_step(lao_sqrt((float)apart2) * g->cell, g->cell);
    }
}
/* Columns along z at one y, 16 at a time: the nearest of all layers' nearest. `wanted`, `layers`
   (Optional): the columns and the z that need it. */
enum { SDV__WIDE = 16 };
static void sdv__column(sdv_grid *g, uint32_t x, uint32_t y, const uint32_t *best,
                        const unsigned char *layers, unsigned char *stale) {
    int32_t apart[SDV__AXIS], k = 0;
    sdv__envelope e;
    uint32_t z, nz = g->size[2];
    for (z = 0; z < nz; z++) {
        uint32_t cell = best[(size_t)z * SDV__WIDE];
        int32_t dx = (int32_t)(cell & 65535u) - (int32_t)x;
        int32_t dy = (int32_t)(cell >> 16) - (int32_t)y;
        apart[z] = cell == SDV_NONE ? -1 : dx * dx + dy * dy;
    }
    sdv__envelope_make(&e, apart, (int32_t)nz);
    for (z = 0; z < nz && e.count > 0; z++) {
        int32_t winner, dz;
        uint32_t cell;
        k += (int32_t)z > e.until[k];
        if (layers && !layers[z]) {
            continue;
        }
        winner = e.place[k];
        dz = winner - (int32_t)z;
        cell = best[(size_t)winner * SDV__WIDE];
        sdv__nearest_write(g, sdv__row(g, y, z) + x,
                           sdv__row(g, cell >> 16, (uint32_t)winner) + (cell & 65535u),
                           apart[winner] + dz * dz, stale);
    }
}
static void sdv__columns(sdv_grid *g, uint32_t x0, uint32_t y, const unsigned char *wanted,
                         const unsigned char *layers, unsigned char *stale) {
    uint32_t best[SDV__AXIS * SDV__WIDE], i, z;
    uint32_t wide = g->size[0] - x0 < SDV__WIDE ? g->size[0] - x0 : (uint32_t)SDV__WIDE;
    for (z = 0; z < g->size[2]; z++) {
        memcpy(best + (size_t)z * SDV__WIDE, g->layer + sdv__row(g, y, z) + x0,
               wide * sizeof *best);
    }
    for (i = 0; i < wide; i++) {
        if (!wanted || wanted[i]) {
            sdv__column(g, x0 + i, y, best + i, layers, stale);
        }
    }
}
static void sdv__column_slab(void *arg, uint32_t y) {
    sdv_grid *g = ((sdv__fill *)arg)->grid;
    uint32_t x0;
    for (x0 = 0; x0 < g->size[0]; x0 += SDV__WIDE) {
        sdv__columns(g, x0, y, NULL, NULL, NULL);
    }
}

/* ---- distances */
/* Of p to the cones of a cell's list. */
static float sdv__list_distance(const sdv_grid *g, const lao_v4 *cell, lao_v3 p, uint32_t *cone) {
    const float *ids = g->ids + (size_t)cell->z;
    uint32_t i, n = (uint32_t)cell->w;
    float least = SDV_FAR;
    for (i = 0; i < n; i++) {
        const lao_v4 *c = g->cones + 2 * (size_t)ids[i];
        float d = sdv_round_cone(p, c[0], c[1]);
        if (d < least) {
            least = d;
            *cone = (uint32_t)ids[i];
        }
    }
    return least;
}
/* Of the cells' centres to the list of their nearest occupied cell. */
static void sdv__refine_layer(void *arg, uint32_t z) {
    const sdv_grid *g = ((const sdv__fill *)arg)->grid;
    sdv_box box = sdv__grid_box(g);
    uint32_t x, y, cone;
    for (y = 0; y < g->size[1]; y++) {
        lao_v4 *row = g->cells + sdv__row(g, y, z);
        for (x = 0; x < g->size[0]; x++) {
            row[x].x = sdv__list_distance(g, g->cells + (size_t)row[x].y,
                                          sdv_cell_centre(box, x, y, z), &cone);
        }
    }
}

/* ---- building */
/* Cones of each layer, ascending. NULL: no memory. `first` has size[2] + 1 entries. */
static uint32_t *sdv__bin_cones(const sdv_grid *g, uint32_t *first) {
    uint32_t i, z, range[2], *binned;
    uint64_t sum = 0;
    memset(first, 0, (g->size[2] + 1) * sizeof *first);
    for (i = 0; i < g->cone_count; i++) {
        sdv__raster_layers(g, g->cones + 2 * (size_t)i, range);
        for (z = range[0]; z < range[1]; z++) {
            first[z]++;
        }
    }
    for (z = 0; z <= g->size[2]; z++) {
        uint32_t n = first[z];
        first[z] = (uint32_t)sum;
        sum += n;
    }
    binned = sum < SDV_NONE ? (uint32_t *)lao__take(&g->allocator, sum, sizeof *binned) : NULL;
    for (i = 0; binned && i < g->cone_count; i++) {
        sdv__raster_layers(g, g->cones + 2 * (size_t)i, range);
        for (z = range[0]; z < range[1]; z++) { /* first = the next free place, */
            binned[first[z]++] = i;
        }
    }
    for (z = g->size[2]; binned && z > 0; z--) { /* and back */
        first[z] = first[z - 1];
    }
    first[0] = 0;
    return binned;
}

/* Entries of the layers to where they begin; returns the sum. */
static uint64_t sdv__layer_starts(const sdv_grid *g, uint64_t *layer_ids) {
    uint64_t sum = 0;
    uint32_t z;
    for (z = 0; z < g->size[2]; z++) {
        uint64_t n = layer_ids[z];
        layer_ids[z] = sum;
        sum += n;
    }
    return sum;
}

/* Fills the cells of a grid whose box, cones and memory are there. */
static lao_result sdv__grid_fill(sdv__work *work, sdv_grid *g, uint32_t *first,
                                 uint64_t *layer_ids) {
    const sdv_host *host = work->host;
    uint32_t *binned = sdv__bin_cones(g, first);
    uint64_t sum = 0;
    int cancelled;
    sdv__fill f;
    if (!binned) {
        return sdv__fail(host, SDV_LOG_MEMORY, "the cones of a grid's layers");
    }
    f.grid = g;
    f.first = first;
    f.binned = binned;
    f.layer_ids = layer_ids;
    f.cone = 0;
    cancelled = sdv__run(work, g->size[2], sdv__count_layer, &f);
    if (!cancelled) {
        sum = sdv__layer_starts(g, layer_ids);
        g->id_count = g->id_room = (uint32_t)sum;
        g->ids = sum <= SDV__EXACT ? (float *)lao__take(&g->allocator, sum, sizeof *g->ids) : NULL;
    }
    if (g->ids) {
        cancelled = sdv__run(work, g->size[2], sdv__fill_layer, &f) ||
                    sdv__run(work, g->size[1], sdv__column_slab, &f) ||
                    sdv__run(work, g->size[2], sdv__refine_layer, &f);
    }
    lao__give(&g->allocator, binned);
    if (cancelled) {
        return sdv__fail(host, SDV_LOG_CANCELLED, "building a grid");
    }
    if (sum > SDV__EXACT) {
        return sdv__fail(host, SDV_LOG_GRID_LISTS, "%llu entries", (unsigned long long)sum);
    }
    return g->ids ? LAO_OK
                  : sdv__fail(host, SDV_LOG_MEMORY, "a grid's %u list entries", g->id_count);
}

SDV_API lao_result sdv_grid_build(const sdv_host *host, const sdv_tree *tree,
                                  const sdv_grid_desc *desc, sdv_grid *grid) {
    sdv_grid_desc standard;
    sdv_grid g;
    sdv__work work;
    uint32_t *first;
    uint64_t *layer_ids;
    lao_result result;
    memset(&standard, 0, sizeof standard);
    memset(&g, 0, sizeof g);
    if (!tree || !grid || !tree->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_grid_build");
    }
    g.cone_count = tree->segment_count + sdv__lone_count(tree);
    if (g.cone_count > SDV__EXACT) {
        return sdv__fail(host, SDV_LOG_GRID_LISTS, "%u segments", g.cone_count);
    }
    if (!sdv__grid_frame(tree, desc ? desc : &standard, &g)) {
        return sdv__fail(host, SDV_LOG_GRID_CELLS, "%u x %u x %u", g.size[0], g.size[1], g.size[2]);
    }
    g.allocator = sdv__allocator(host);
    g.cells = (lao_v4 *)lao__take(&g.allocator, g.cell_count, sizeof *g.cells);
    g.layer = (uint32_t *)lao__take(&g.allocator, g.cell_count, sizeof *g.layer);
    g.occupied = (uint32_t *)lao__take(
        &g.allocator, (uint64_t)sdv__words(&g) * g.size[1] * g.size[2], sizeof *g.occupied);
    sdv__cones_take(tree, &g);
    first = (uint32_t *)lao__take(&g.allocator, SDV__AXIS + 1, sizeof *first);
    layer_ids = (uint64_t *)lao__take(&g.allocator, SDV__AXIS, sizeof *layer_ids);
    if (g.cells && g.layer && g.occupied && g.cones && g.cone_nodes && first && layer_ids) {
        work.host = host;
        work.done = 0;
        work.total = 3 * (uint64_t)g.size[2] + g.size[1];
        sdv__cones_fill(tree, &g);
        result = sdv__grid_fill(&work, &g, first, layer_ids);
    } else {
        result = sdv__fail(host, SDV_LOG_MEMORY, "a grid of %u cells and %u cones", g.cell_count,
                           g.cone_count);
    }
    lao__give(&g.allocator, first);
    lao__give(&g.allocator, layer_ids);
    if (result != LAO_OK) {
        sdv_grid_free(&g);
        return result;
    }
    *grid = g;
    return LAO_OK;
}

SDV_API void sdv_grid_free(sdv_grid *grid) {
    if (grid && grid->allocator.release) {
        lao__give(&grid->allocator, grid->cells);
        lao__give(&grid->allocator, grid->layer);
        lao__give(&grid->allocator, grid->occupied);
        lao__give(&grid->allocator, grid->ids);
        lao__give(&grid->allocator, grid->cones);
        lao__give(&grid->allocator, grid->cone_nodes);
        memset(grid, 0, sizeof *grid);
    }
}

/* ---- reading */
/* Adds the forms of a cell's list to a sample. */
static sdv_near sdv__near_forms(const sdv_grid *g, const lao_v4 *cell, lao_v3 p, lao_v3 direction,
                                sdv_near n) {
    uint32_t i;
    for (i = 0; i < (uint32_t)cell->w; i++) {
        float id = g->ids[(size_t)cell->z + i];
        const lao_v4 *c = g->cones + 2 * (size_t)id;
        lao_v2 along = sdv_cone_along(p, direction, c[0], c[1]);
        if (sdv_near_asks(n, along)) {
            n = sdv_near_form(n, along, p, c[0], c[1], sdv__form_of(g, id), id);
        }
    }
    return n;
}
/* Of p to what a cell lists; of forms a bound. */
static float sdv__form_distance(const sdv_grid *g, const lao_v4 *cell, lao_v3 p, uint32_t *cone) {
    sdv_near n;
    if (!g->forms) {
        return sdv__list_distance(g, cell, p, cone);
    }
    n = sdv__near_forms(g, cell, p, lao_v3_make(0.0f, 0.0f, 1.0f), sdv_near_start(0.0f));
    if (n.cone >= 0.0f) {
        *cone = (uint32_t)n.cone;
    }
    return n.distance;
}
SDV_API float sdv_grid_distance(const sdv_grid *grid, lao_v3 p, uint32_t *cone) {
    const lao_v4 *cell = grid->cells + sdv_cell_at(sdv__grid_box(grid), p);
    uint32_t nearest = SDV_NONE;
    float d;
    cell = cell->w > 0.0f ? cell : grid->cells + (size_t)cell->y;
    d = sdv__form_distance(grid, cell, p, &nearest);
    if (cone) {
        *cone = nearest;
    }
    return d;
}
SDV_API float sdv_cones_distance(const lao_v4 *cones, uint32_t count, lao_v3 p, uint32_t *cone) {
    uint32_t i, nearest = SDV_NONE;
    float least = SDV_FAR;
    for (i = 0; i < count; i++) {
        float d = sdv_round_cone(p, cones[2 * (size_t)i], cones[2 * (size_t)i + 1]);
        if (d < least) {
            least = d;
            nearest = i;
        }
    }
    if (cone) {
        *cone = nearest;
    }
    return least;
}
