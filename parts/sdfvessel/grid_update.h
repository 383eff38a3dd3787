/* ================================================================================================
 * grid_update: the field after some nodes changed, to the same bits as one built anew. Uses host
   and grid. */

/* Cells whose lists change are found, lists are moved up and down in place, what is nearest is
   found anew in the layers whose occupied cells change, and in those columns along z where that
   matters. Blocks of cells that are nearer to others than to all that changes are left out from the
   start. */
#define SDV__BLOCK 8u
typedef struct sdv__change {
    sdv_grid *grid;
    uint32_t *changed;         /* cones, ascending */
    lao_v4 *cones;             /* their new ends, 2 each; once the grid has those, the old ones */
    unsigned char *is_changed; /* per cone */
    uint32_t changed_count;
    unsigned char *stale;       /* per cell: SDV__LISTED, ... */
    unsigned char *close;       /* per block: something in it may change */
    uint32_t blocks[3];         /* along each axis */
    uint32_t *was;              /* occupied cells before */
    uint32_t *rows, row_layers; /* nearest along x in the layers whose occupied cells change */
    uint32_t row_layer[SDV__AXIS];
    unsigned char turned[SDV__AXIS]; /* per layer: is it one of those? */
    /* Cells whose list changes, layer by layer: the cell, the place and length of its old list, the
       length of its new one and how far (entries) what lies before it moves. */
    uint32_t *listed, *places, *olds, *news;
    int32_t *moves;                    /* one more: of what lies behind the last */
    uint32_t listed_in[SDV__AXIS + 1]; /* where a layer's begin */
    uint64_t fresh_in[SDV__AXIS + 1];  /* and their new lists */
    float *fresh;
    float *ids; /* a larger array, where the grid's is too small */
    uint32_t room;
} sdv__change;

static lao_v3 sdv__centre(const sdv_grid *g, size_t cell) {
    size_t row = cell / g->size[0];
    return sdv_cell_centre(sdv__grid_box(g), (uint32_t)(cell - row * g->size[0]),
                           (uint32_t)(row % g->size[1]), (uint32_t)(row / g->size[1]));
}
/* Blocks at y and z, along x. */
static const unsigned char *sdv__close_row(const sdv__change *c, uint32_t y, uint32_t z) {
    return c->close + c->blocks[0] * (y / SDV__BLOCK + (size_t)c->blocks[1] * (z / SDV__BLOCK));
}
/* ---- which lists change */
typedef struct sdv__marking {
    const sdv__change *change;
    const lao_v4 *cone;
} sdv__marking;
static void sdv__mark_cell(void *arg, uint32_t cell, lao_v3 centre) {
    const sdv__marking *m = (const sdv__marking *)arg;
    unsigned char *stale = m->change->stale + cell;
    if (!*stale && sdv__is_listed(m->change->grid, centre, m->cone)) {
        *stale = SDV__LISTED;
    }
}
static size_t sdv__next_listed(const sdv__change *c, size_t cell, size_t end) {
    const void *found = memchr(c->stale + cell, SDV__LISTED, end - cell);
    return found ? (size_t)((const unsigned char *)found - c->stale) : end;
}
/* The new list of a cell: the old one without changed cones, and the changed ones that are near
   enough, in order. Returns its length; `out` NULL: only that. */
static uint32_t sdv__merge_list(const sdv__change *c, size_t index, float *out) {
    const sdv_grid *g = c->grid;
    const lao_v4 *cell = g->cells + index;
    lao_v3 centre = sdv__centre(g, index);
    uint32_t i = 0, k = 0, n = 0, old_count = (uint32_t)cell->w;
    const float *old = old_count ? g->ids + (size_t)cell->z : NULL;
    while (i < old_count || k < c->changed_count) {
        uint32_t a = i < old_count ? (uint32_t)old[i] : SDV_NONE;
        uint32_t b = k < c->changed_count ? c->changed[k] : SDV_NONE;
        if (b > a || sdv__is_listed(g, centre, c->cones + 2 * (size_t)k)) {
            if (out) {
                out[n] = (float)(b > a ? a : b);
            }
            n++;
        }
        i += a <= b;
        k += b <= a;
    }
    return n;
}
static void sdv__mark_layer(void *arg, uint32_t z) {
    sdv__change *c = (sdv__change *)arg;
    const sdv_grid *g = c->grid;
    size_t first = sdv__row(g, 0, z), end = first + sdv__layer_size(g), cell;
    sdv__marking m;
    uint32_t k;
    m.change = c;
    memset(c->stale + first, 0, end - first);
    for (k = 0; k < c->changed_count; k++) {
        m.cone = g->cones + 2 * (size_t)c->changed[k];
        sdv__raster_layer(g, m.cone, z, sdv__mark_cell, &m);
        m.cone = c->cones + 2 * (size_t)k;
        sdv__raster_layer(g, m.cone, z, sdv__mark_cell, &m);
    }
    for (cell = sdv__next_listed(c, first, end); cell < end;
         cell = sdv__next_listed(c, cell + 1, end)) {
        uint32_t n = sdv__merge_list(c, cell, NULL);
        c->turned[z] |= (n > 0) != (g->cells[cell].w > 0.0f);
        c->listed_in[z]++;
        c->fresh_in[z] += n;
    }
}
static void sdv__merge_layer(void *arg, uint32_t z) {
    sdv__change *c = (sdv__change *)arg;
    const sdv_grid *g = c->grid;
    size_t first = sdv__row(g, 0, z), end = first + sdv__layer_size(g), cell;
    uint32_t i = c->listed_in[z];
    uint64_t at = c->fresh_in[z];
    for (cell = sdv__next_listed(c, first, end); cell < end;
         cell = sdv__next_listed(c, cell + 1, end)) {
        c->listed[i] = (uint32_t)cell;
        c->olds[i] = (uint32_t)g->cells[cell].w;
        c->news[i] = sdv__merge_list(c, cell, c->fresh + at);
        at += c->news[i++];
    }
}
/* Could anything in a block be nearest to a cell whose list changes? All cells of the block are
   within `reach` of its middle, whose nearest cell is `apart` away: within apart + reach of each is
   one that stays, unless it lists what changes. What lists it is within 2 cells of it. */
static void sdv__close_blocks(void *arg, uint32_t bz) {
    sdv__change *c = (sdv__change *)arg;
    const sdv_grid *g = c->grid;
    uint32_t b, k, axis, n = c->blocks[0] * c->blocks[1];
    for (b = 0; b < n; b++) {
        uint32_t at[3], middle[3];
        double reach = 0, apart = 0;
        size_t nearest;
        float within;
        lao_v3 p;
        at[0] = b % c->blocks[0];
        at[1] = b / c->blocks[0];
        at[2] = bz;
        for (axis = 0; axis < 3; axis++) {
            uint32_t low = SDV__BLOCK * at[axis], end = g->size[axis] - low;
            end = low + (end < SDV__BLOCK ? end : SDV__BLOCK);
            middle[axis] = (low + end) / 2;
            reach += (double)(middle[axis] - low) * (middle[axis] - low);
        }
        nearest = (size_t)g->cells[sdv__row(g, middle[1], middle[2]) + middle[0]].y;
        for (axis = 0; axis < 3; axis++) {
            double d = (double)(nearest % g->size[axis]) - middle[axis];
            nearest /= g->size[axis];
            apart += d * d;
        }
        p = sdv_cell_centre(sdv__grid_box(g), middle[0], middle[1], middle[2]);
        within = (float)(sqrt(apart) + 2 * sqrt(reach) + 2.1) * g->cell;
        c->close[(size_t)n * bz + b] = 0;
        for (k = 0; k < c->changed_count && !c->close[(size_t)n * bz + b]; k++) {
            const lao_v4 *old = g->cones + 2 * (size_t)c->changed[k],
                         *fresh = c->cones + 2 * (size_t)k;
            c->close[(size_t)n * bz + b] = sdv_round_cone(p, old[0], old[1]) < within ||
                                           sdv_round_cone(p, fresh[0], fresh[1]) < within;
        }
    }
}

/* ---- lists */
/* Where the old lists are and how far everything moves. */
static void sdv__place_lists(sdv__change *c, uint32_t count) {
    const sdv_grid *g = c->grid;
    uint32_t i, next = g->id_count;
    size_t end = g->cell_count;
    int32_t move = 0;
    for (i = count; i-- > 0;) { /* an empty list lies where the next one begins */
        size_t cell = c->listed[i];
        if (!c->olds[i]) {
            size_t row = cell / g->size[0], from = cell - row * g->size[0];
            for (; row * g->size[0] < end; row++, from = 0) {
                uint32_t x = sdv__next_bit(sdv__bits(g, row), (uint32_t)from, g->size[0]);
                if (x < g->size[0]) {
                    cell = row * g->size[0] + x;
                    next = cell < end ? (uint32_t)g->cells[cell].z : next;
                    break;
                }
            }
        }
        next = c->olds[i] ? (uint32_t)g->cells[cell].z : next;
        end = c->listed[i];
        c->places[i] = next;
    }
    for (i = 0; i < count; i++) {
        c->moves[i] = move;
        move += (int32_t)c->news[i] - (int32_t)c->olds[i];
    }
    c->moves[count] = move;
}
/* What lies between two changed lists, those that move up last to first, then those that move down
   first to last: none is written where another is still to be read. */
static void sdv__move_lists(const sdv__change *c, uint32_t count) {
    float *ids = c->grid->ids;
    const float *fresh = c->fresh;
    uint32_t k, i;
    for (k = 0; k < 2 * (count + 1); k++) {
        uint32_t from, until;
        int32_t move;
        i = k <= count ? count - k : k - count - 1;
        from = i > 0 ? c->places[i - 1] + c->olds[i - 1] : 0;
        until = i < count ? c->places[i] : c->grid->id_count;
        move = c->moves[i];
        if (k <= count ? move > 0 : move < 0) {
            memmove(ids + (int64_t)from + move, ids + from, (until - from) * sizeof *ids);
        }
    }
    for (i = 0; i < count; i++) {
        memcpy(ids + (int64_t)c->places[i] + c->moves[i], fresh, c->news[i] * sizeof *ids);
        fresh += c->news[i];
    }
}
/* Cells from .. until - 1: their lists have moved. */
static void sdv__move_cells(const sdv_grid *g, size_t from, size_t until, int32_t move) {
    size_t row = from / g->size[0];
    uint32_t x = (uint32_t)(from - row * g->size[0]);
    for (; move != 0 && from < until; row++, x = 0) {
        lao_v4 *cells = g->cells + row * g->size[0];
        uint32_t end = until - from < g->size[0] - x ? x + (uint32_t)(until - from) : g->size[0];
        from += end - x;
        for (x = sdv__next_bit(sdv__bits(g, row), x, end); x < end;
             x = sdv__next_bit(sdv__bits(g, row), x + 1, end)) {
            cells[x].z += (float)move;
        }
    }
}
static void sdv__relist_layer(void *arg, uint32_t z) {
    sdv__change *c = (sdv__change *)arg;
    sdv_grid *g = c->grid;
    size_t from = sdv__row(g, 0, z), until = from + sdv__layer_size(g);
    uint32_t i;
    for (i = c->listed_in[z]; i < c->listed_in[z + 1]; i++) {
        lao_v4 *cell = g->cells + c->listed[i];
        size_t row = c->listed[i] / g->size[0];
        uint32_t x = c->listed[i] - (uint32_t)(row * g->size[0]);
        sdv__move_cells(g, from, c->listed[i], c->moves[i]);
        from = (size_t)c->listed[i] + 1;
        cell->w = (float)c->news[i];
        if (c->news[i]) {
            cell->z = (float)((int64_t)c->places[i] + c->moves[i]);
            sdv__bits(g, row)[x / 32] |= 1u << (x % 32);
        } else {
            sdv__bits(g, row)[x / 32] &= ~(1u << (x % 32));
        }
    }
    sdv__move_cells(g, from, until, c->moves[i]);
}

/* ---- what is nearest */
static void sdv__renear_layer(void *arg, uint32_t z) {
    sdv__change *c = (sdv__change *)arg;
    const sdv_grid *g = c->grid;
    uint32_t nx = g->size[0], x, y, before[SDV__AXIS];
    unsigned char wanted[SDV__AXIS];
    uint32_t *rows;
    if (!c->turned[z]) {
        return;
    }
    rows = c->rows + sdv__layer_size(g) * c->row_layer[z];
    memset(wanted, 0, sizeof wanted);
    sdv__layer_rows(g, z, rows);
    for (y = 0; y < g->size[1]; y++) {
        size_t row = y + (size_t)g->size[1] * z;
        const uint32_t *was = c->was + sdv__words(g) * row;
        if (memcmp(was, sdv__bits(g, row), sdv__words(g) * sizeof *was) != 0) {
            sdv__row_nearest(was, nx, before);
            for (x = 0; x < nx; x++) {
                wanted[x] |= before[x] != rows[(size_t)nx * y + x];
            }
        }
    }
    sdv__layer_columns(g, rows, wanted, g->layer + sdv__row(g, 0, z), c->stale + sdv__row(g, 0, z));
}
/* The z of a group of columns that lie in close blocks; 0: none. */
static int sdv__close_layers(const sdv__change *c, uint32_t x0, uint32_t y, unsigned char *layers) {
    uint32_t z, last = x0 + SDV__WIDE - 1, any = 0;
    last = last < c->grid->size[0] ? last : c->grid->size[0] - 1;
    for (z = 0; z < c->grid->size[2]; z++) {
        const unsigned char *row = sdv__close_row(c, y, z);
        layers[z] = row[x0 / SDV__BLOCK] | row[last / SDV__BLOCK];
        any |= layers[z];
    }
    return any != 0;
}
static void sdv__renear_slab(void *arg, uint32_t y) {
    sdv__change *c = (sdv__change *)arg;
    sdv_grid *g = c->grid;
    unsigned char wanted[SDV__WIDE], layers[SDV__AXIS];
    uint32_t x0, i, z;
    for (x0 = 0; x0 < g->size[0]; x0 += SDV__WIDE) {
        uint32_t wide = g->size[0] - x0 < SDV__WIDE ? g->size[0] - x0 : (uint32_t)SDV__WIDE;
        memset(wanted, 0, sizeof wanted);
        if (!sdv__close_layers(c, x0, y, layers)) {
            continue;
        }
        for (z = 0; z < g->size[2]; z++) {
            const unsigned char *stale = c->stale + sdv__row(g, y, z) + x0;
            for (i = 0; c->turned[z] && i < wide; i++) {
                wanted[i] |= stale[i] & SDV__TURNED;
            }
        }
        if (memchr(wanted, SDV__TURNED, wide)) {
            sdv__columns(g, x0, y, wanted, layers, c->stale);
        }
    }
}

/* ---- distances */
/* Of a place whose nearest cell is as before but lists something else. What did not change is no
   nearer than all was before. */
static float sdv__changed_distance(const sdv__change *c, const lao_v4 *cell, lao_v3 p,
                                   float before) {
    const sdv_grid *g = c->grid;
    const float *ids = g->ids + (size_t)cell->z;
    uint32_t i, k, n = (uint32_t)cell->w, cone;
    float least = SDV_FAR;
    for (i = 0; i < n; i++) {
        if (c->is_changed[(size_t)ids[i]]) {
            const lao_v4 *ends = g->cones + 2 * (size_t)ids[i];
            float d = sdv_round_cone(p, ends[0], ends[1]);
            least = d < least ? d : least;
        }
    }
    if (least <= before) {
        return least;
    }
    for (k = 0; k < c->changed_count; k++) {
        const lao_v4 *ends = c->cones + 2 * (size_t)k;
        if (sdv_round_cone(p, ends[0], ends[1]) <= before) {
            return sdv__list_distance(g, cell, p, &cone);
        }
    }
    return before;
}
static void sdv__rerefine_layer(void *arg, uint32_t z) {
    const sdv__change *c = (const sdv__change *)arg;
    const sdv_grid *g = c->grid;
    sdv_box box = sdv__grid_box(g);
    uint32_t x, y, cone;
    for (y = 0; y < g->size[1]; y++) {
        size_t row = sdv__row(g, y, z);
        const unsigned char *close = sdv__close_row(c, y, z);
        for (x = 0; x < g->size[0]; x++) {
            lao_v4 *cell = g->cells + row + x;
            size_t nearest;
            if (!close[x / SDV__BLOCK]) {
                x |= SDV__BLOCK - 1;
                continue;
            }
            nearest = (size_t)cell->y;
            if (c->stale[row + x] & SDV__NEARER) {
                cell->x =
                    sdv__list_distance(g, g->cells + nearest, sdv_cell_centre(box, x, y, z), &cone);
            } else if (c->stale[nearest] & SDV__LISTED) {
                cell->x = sdv__changed_distance(c, g->cells + nearest,
                                                sdv_cell_centre(box, x, y, z), cell->x);
            }
        }
    }
}

/* ---- all of it */
/* The cones at the nodes, with their new ends. 0: no memory. */
static int sdv__changed_cones(const sdv_tree *tree, const uint32_t *nodes, uint32_t count,
                              sdv__change *c) {
    const sdv_grid *g = c->grid;
    const lao_allocator *a = &g->allocator;
    unsigned char *moved = (unsigned char *)lao__take(a, tree->node_count, 1);
    uint32_t i, n = 0;
    c->is_changed = (unsigned char *)lao__take(a, g->cone_count, 1);
    if (moved && c->is_changed) {
        memset(moved, 0, tree->node_count);
        for (i = 0; i < count; i++) {
            moved[nodes[i]] = 1;
        }
        for (i = 0; i < g->cone_count; i++) {
            const uint32_t *ends = g->cone_nodes + 2 * (size_t)i;
            c->is_changed[i] = moved[ends[0]] || moved[ends[1]];
            c->changed_count += c->is_changed[i];
        }
        c->changed = (uint32_t *)lao__take(a, c->changed_count, sizeof *c->changed);
        c->cones = (lao_v4 *)lao__take(a, 2 * (uint64_t)c->changed_count, sizeof *c->cones);
    }
    for (i = 0; c->changed && c->cones && i < g->cone_count; i++) {
        if (c->is_changed[i]) {
            c->changed[n] = i;
            sdv__cone_set(tree, g->cone_nodes + 2 * (size_t)i, c->cones + 2 * (size_t)n++);
        }
    }
    lao__give(a, moved);
    return c->changed && c->cones;
}
/* What marking has counted becomes where each layer begins. Returns the number of lists. */
static uint32_t sdv__change_sizes(sdv__change *c) {
    const sdv_grid *g = c->grid;
    uint32_t z, lists = 0;
    uint64_t fresh = 0;
    for (z = 0; z <= g->size[2]; z++) {
        uint32_t n = c->listed_in[z];
        uint64_t m = c->fresh_in[z];
        c->listed_in[z] = lists;
        c->fresh_in[z] = fresh;
        lists += n;
        fresh += m;
        if (z < g->size[2]) {
            c->row_layer[z] = c->row_layers;
            c->row_layers += c->turned[z];
        }
    }
    return lists;
}
static int sdv__change_memory(sdv__change *c, uint32_t lists) {
    const sdv_grid *g = c->grid;
    const lao_allocator *a = &g->allocator;
    uint64_t words = (uint64_t)sdv__words(g) * g->size[1] * g->size[2];
    c->listed = (uint32_t *)lao__take(a, 4 * (uint64_t)lists, sizeof *c->listed);
    c->moves = (int32_t *)lao__take(a, (uint64_t)lists + 1, sizeof *c->moves);
    c->fresh = (float *)lao__take(a, c->fresh_in[g->size[2]], sizeof *c->fresh);
    c->rows =
        (uint32_t *)lao__take(a, c->row_layers * (uint64_t)sdv__layer_size(g), sizeof *c->rows);
    c->was = (uint32_t *)lao__take(a, words, sizeof *c->was);
    if (!c->listed || !c->moves || !c->fresh || !c->rows || !c->was) {
        return 0;
    }
    c->places = c->listed + lists;
    c->olds = c->places + lists;
    c->news = c->olds + lists;
    memcpy(c->was, g->occupied, (size_t)words * sizeof *c->was);
    return 1;
}
/* Everything up to the point where nothing can fail any more. *sum: entries of all lists. */
static lao_result sdv__change_prepare(sdv__work *work, sdv__change *c, uint64_t *sum) {
    sdv_grid *g = c->grid;
    const lao_allocator *a = &g->allocator;
    uint32_t k, lists;
    for (k = 0; k < 3; k++) {
        c->blocks[k] = sdv__parts(g->size[k], SDV__BLOCK);
    }
    c->stale = (unsigned char *)lao__take(a, g->cell_count, 1);
    c->close =
        (unsigned char *)lao__take(a, (uint64_t)c->blocks[0] * c->blocks[1] * c->blocks[2], 1);
    if (!c->stale || !c->close) {
        return sdv__fail(work->host, SDV_LOG_MEMORY, "changing a grid");
    }
    if (sdv__run(work, g->size[2], sdv__mark_layer, c)) {
        return sdv__fail(work->host, SDV_LOG_CANCELLED, "changing a grid");
    }
    lists = sdv__change_sizes(c);
    if (!sdv__change_memory(c, lists)) {
        return sdv__fail(work->host, SDV_LOG_MEMORY, "changing a grid");
    }
    if (sdv__run(work, g->size[2], sdv__merge_layer, c)) {
        return sdv__fail(work->host, SDV_LOG_CANCELLED, "changing a grid");
    }
    sdv__place_lists(c, lists);
    *sum = (uint64_t)((int64_t)g->id_count + c->moves[lists]);
    if (*sum > SDV__EXACT) {
        return sdv__fail(work->host, SDV_LOG_GRID_LISTS, "%llu entries", (unsigned long long)*sum);
    }
    if (*sum > g->id_room) { /* and some more, for the changes to come */
        c->room = (uint32_t)(*sum + *sum / 8);
        c->ids = (float *)lao__take(a, c->room, sizeof *c->ids);
        if (!c->ids) {
            return sdv__fail(work->host, SDV_LOG_MEMORY, "changing a grid");
        }
    }
    return LAO_OK;
}
static void sdv__change_apply(sdv__work *work, sdv__change *c) {
    sdv_grid *g = c->grid;
    uint32_t k;
    (void)sdv__run(work, c->blocks[2], sdv__close_blocks, c);
    if (c->ids) {
        float *old = g->ids;
        memcpy(c->ids, old, g->id_count * sizeof *old);
        g->ids = c->ids;
        g->id_room = c->room;
        c->ids = old;
    }
    sdv__move_lists(c, c->listed_in[g->size[2]]);
    (void)sdv__run(work, g->size[2], sdv__relist_layer, c);
    for (k = 0; k < 2 * c->changed_count; k++) {
        lao_v4 *end = g->cones + 2 * (size_t)c->changed[k / 2] + k % 2, old = *end;
        *end = c->cones[k];
        c->cones[k] = old;
    }
    (void)sdv__run(work, g->size[2], sdv__renear_layer, c);
    (void)sdv__run(work, g->size[1], sdv__renear_slab, c);
    (void)sdv__run(work, g->size[2], sdv__rerefine_layer, c);
}
static lao_result sdv__grid_change(const sdv_host *host, const sdv_tree *tree,
                                   const uint32_t *nodes, uint32_t count, sdv_grid *grid) {
    sdv__change c;
    sdv__work work;
    sdv_host silent;
    uint64_t sum = 0;
    lao_result result = LAO_ERROR_OUT_OF_MEMORY;
    memset(&c, 0, sizeof c);
    c.grid = grid;
    work.host = host;
    work.done = 0;
    work.total =
        5 * (uint64_t)grid->size[2] + grid->size[1] + sdv__parts(grid->size[2], SDV__BLOCK);
    if (sdv__changed_cones(tree, nodes, count, &c)) {
        result = sdv__change_prepare(&work, &c, &sum);
    } else {
        sdv__fail(host, SDV_LOG_MEMORY, "changing a grid");
    }
    if (result == LAO_OK) {
        if (host) { /* no way back from here: the host is no longer asked whether to cancel */
            silent = *host;
            silent.job.progress = NULL;
            work.host = &silent;
        }
        sdv__change_apply(&work, &c);
        sdv__forms_fill(tree, grid);
        grid->id_count = (uint32_t)sum;
        grid->rebuilt = 0;
    }
    lao__give(&grid->allocator, c.changed);
    lao__give(&grid->allocator, c.cones);
    lao__give(&grid->allocator, c.is_changed);
    lao__give(&grid->allocator, c.stale);
    lao__give(&grid->allocator, c.close);
    lao__give(&grid->allocator, c.listed);
    lao__give(&grid->allocator, c.moves);
    lao__give(&grid->allocator, c.fresh);
    lao__give(&grid->allocator, c.rows);
    lao__give(&grid->allocator, c.was);
    lao__give(&grid->allocator, c.ids);
    return result;
}

/* A new grid in place of the old one, with as many cells along its longest axis. */
static lao_result sdv__grid_renew(const sdv_host *host, const sdv_tree *tree, sdv_grid *grid) {
    sdv_grid_desc desc;
    sdv_grid fresh;
    lao_result result;
    uint32_t k;
    memset(&desc, 0, sizeof desc);
    desc.resolution = 16;
    for (k = 0; k < 3; k++) {
        desc.resolution = grid->size[k] > desc.resolution ? grid->size[k] : desc.resolution;
    }
    result = sdv_grid_build(host, tree, &desc, &fresh);
    if (result == LAO_OK) {
        sdv_grid_free(grid);
        *grid = fresh;
        grid->rebuilt = 1;
    }
    return result;
}

/* Is it the tree of the grid, and are the nodes its own? */
static lao_result sdv__grid_fits(const sdv_host *host, const sdv_tree *tree, const uint32_t *nodes,
                                 uint32_t count, const sdv_grid *grid) {
    uint32_t i;
    if (!tree || !grid || (count && !nodes) || !tree->memory || !grid->cones) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_grid_update");
    }
    for (i = 0; i < count; i++) {
        if (nodes[i] >= tree->node_count) {
            return sdv__fail(host, SDV_LOG_GRID_TREE, "node %u of %u", nodes[i], tree->node_count);
        }
    }
    return grid->cone_count == tree->segment_count + sdv__lone_count(tree)
               ? LAO_OK
               : sdv__fail(host, SDV_LOG_GRID_TREE, NULL);
}
SDV_API lao_result sdv_grid_update(const sdv_host *host, const sdv_tree *tree,
                                   const uint32_t *nodes, uint32_t count, sdv_grid *grid) {
    lao_result result = sdv__grid_fits(host, tree, nodes, count, grid);
    if (result == LAO_OK && !grid->cells) {
        result = sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_grid_update");
    }
    if (result != LAO_OK) {
        return result;
    }
    return sdv__grid_holds(grid, tree) ? sdv__grid_change(host, tree, nodes, count, grid)
                                       : sdv__grid_renew(host, tree, grid);
}
