/* ================================================================================================
 * object: what the passes read of a tree, of shapes or of a mesh, packed into buffers of texels.
   Uses host, grid, grid_update, trace, the order and balls of target, the limits of module. */

/* Gives the object a buffer, in place of the one of that name. */
static void sdv__object_buffer(sdv_object *object, const char *name, const void *data,
                               uint32_t count) {
    uint32_t i = 0;
    while (i < object->desc.buffer_count && strcmp(object->buffers[i].name, name) != 0) {
        i++;
    }
    object->buffers[i].name = name;
    object->buffers[i].data = data;
    object->buffers[i].texel_count = count;
    object->desc.buffers = object->buffers;
    object->desc.buffer_count += i == object->desc.buffer_count;
}

static void sdv__object_drop(sdv_object *object, const char *name) {
    uint32_t i, kept = 0;
    for (i = 0; i < object->desc.buffer_count; i++) {
        if (strcmp(object->buffers[i].name, name) != 0) {
            object->buffers[kept++] = object->buffers[i];
        }
    }
    object->desc.buffer_count = kept;
}

/* Box, cones, and the lists where there are any. */
static void sdv__object_grid(sdv_object *object, const sdv_grid *grid) {
    size_t i;
    int k;
    object->box[0] = lao_v4_make(grid->origin.x, grid->origin.y, grid->origin.z, grid->cell);
    object->box[1] = lao_v4_make((float)grid->size[0], (float)grid->size[1], (float)grid->size[2],
                                 (float)grid->cone_count);
    sdv__object_buffer(object, "vessel_box", object->box, 2);
    if (grid->cells) {
        sdv__object_buffer(object, "vessel_cells", grid->cells, grid->cell_count);
        sdv__object_buffer(object, "vessel_ids", grid->ids, grid->id_count);
    }
    sdv__object_buffer(object, "vessel_cones", grid->cones,
                       (grid->forms ? 5 : 2) * grid->cone_count);
    if (grid->forms) {
        sdv__object_buffer(object, "vessel_forms", grid->forms, 1);
    }
    object->desc.item_count = grid->cone_count;
    for (i = 0; i < grid->cone_count * (size_t)2; i++) {
        const lao_v4 *ball = &grid->cones[i];
        const float centre[3] = {ball->x, ball->y, ball->z};
        for (k = 0; k < 3; k++) {
            float low = centre[k] - ball->w, high = centre[k] + ball->w;
            object->desc.bounds[0][k] = i ? lao_min(object->desc.bounds[0][k], low) : low;
            object->desc.bounds[1][k] = i ? lao_max(object->desc.bounds[1][k], high) : high;
        }
    }
}

/* The host's colours of cones, or coral for all. 0: no memory. */
static int sdv__object_colors(sdv_object *object, const uint8_t *colors, uint32_t cone_count) {
    static const uint8_t coral[4] = {226, 106, 92, 255};
    size_t i, size = 8 * (size_t)cone_count;
    if (!colors) {
        uint8_t *own = (uint8_t *)lao__take(&object->allocator, size, 1);
        if (!own) {
            return 0;
        }
        for (i = 0; i < size; i++) {
            own[i] = coral[i % 4];
        }
        object->memory = own;
        colors = own;
    }
    sdv__object_buffer(object, "vessel_colors", colors, 2 * cone_count);
    return 1;
}

SDV_API lao_result sdv_object_make(const sdv_host *host, const sdv_grid *grid,
                                   const uint8_t *colors, sdv_object *object) {
    if (!grid || !object || !grid->cells || !grid->cone_count) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_make");
    }
    memset(object, 0, sizeof *object);
    object->allocator = sdv__allocator(host);
    sdv__object_grid(object, grid);
    return sdv__object_colors(object, colors, grid->cone_count)
               ? LAO_OK
               : sdv__fail(host, SDV_LOG_MEMORY, "colours of cones");
}

/* ---- built by the device */
/* Cells along an axis to a block of the lists; as the shader has it. */
static uint32_t sdv__block_edge(const sdv_grid *g) {
    uint32_t k, most = 0;
    for (k = 0; k < 3; k++) {
        most = g->size[k] > most ? g->size[k] : most;
    }
    return (most + SDV_BLOCKS - 1) / SDV_BLOCKS;
}
/* Blocks (or regions) of so many cells along an axis, all of them. */
static double sdv__blocks(const sdv_grid *g, uint32_t edge) {
    double n = 1;
    uint32_t k;
    for (k = 0; k < 3; k++) {
        n *= (double)sdv__parts(g->size[k], edge);
    }
    return n;
}
/* Most cells that list a cone: those in its box with the reach of lists around it, and no more than
   the volume that their own volumes reach into. */
static double sdv__most_cells(const sdv_grid *g, const lao_v4 *cone) {
    sdv__raster r = sdv__raster_make(g, cone);
    const double t[2] = {0, 1};
    double cells = 1, length = 0, radius = (r.ra > r.rb ? r.ra : r.rb) / (double)g->cell + 0.8661;
    uint32_t range[2];
    int k;
    for (k = 0; k < 3; k++) {
        double d = (r.b[k] - r.a[k]) / (double)g->cell;
        sdv__raster_range(g, &r, k, t, range);
        cells *= range[1] > range[0] ? (double)(range[1] - range[0]) : 0.0;
        length += d * d;
    }
    length = 3.1416 * radius * radius * (sqrt(length) + 4.0 / 3.0 * radius) + 1.0;
    return cells < length ? cells : length;
}
/* Most blocks of so many cells that list it: those whose middles are in its box with their reach
   around it. The last along an axis may be smaller, and its middle lower. */
static double sdv__most_blocks(const sdv_grid *g, const lao_v4 *cone, uint32_t edge) {
    lao_v3 last = lao_v3_make(1, 1, 1);
    double blocks = 1, size = (double)edge * (double)g->cell, reach;
    uint32_t k;
    last = lao_v3_scale(last, (float)(edge - 1));
    reach = 1.01 * (double)sdv_block_reach(sdv__grid_box(g), lao_v3_make(0, 0, 0), last).w;
    for (k = 0; k < 3; k++) {
        double n = (double)sdv__parts(g->size[k], edge);
        float a = sdv__v4_at(cone[0], k), b = sdv__v4_at(cone[1], k);
        double origin = (double)sdv__v3_at(g->origin, k);
        double low = (double)lao_min(a - cone[0].w, b - cone[1].w) - reach;
        double high = (double)lao_max(a + cone[0].w, b + cone[1].w) + reach;
        low = ceil((low - origin) / size - 0.5);
        high = floor((high - origin) / size - 0.5);
        low = low > 0 ? low : 0;
        high = high >= n - 2 ? n - 1 : high;
        blocks *= high >= low ? high - low + 1 : 0;
    }
    return blocks;
}
/* Room for a little more, so that not every move makes a new plan: in steps of 1/8. */
static double sdv__roomy(double n) {
    double step = 1;
    while (8 * step < n) {
        step *= 2;
    }
    return step * ceil(n / step);
}
/* Sizes the images of items; 0: the device cannot hold them. Nothing shrinks. */
static int sdv__device_items(const sdv_grid *g, uint32_t image_size, uint32_t *items) {
    double count[LAO_FURTHER_ITEMS + 1] = {0}; /* by kind */
    uint32_t i, edge = sdv__block_edge(g);
    for (i = 0; i < g->cone_count; i++) {
        const lao_v4 *cone = g->cones + 2 * (size_t)i;
        count[SDV__REGION_ENTRIES] += sdv__most_blocks(g, cone, edge * SDV_REGION);
        count[SDV__BLOCK_ENTRIES] += sdv__most_blocks(g, cone, edge);
        count[SDV__ENTRIES] += sdv__most_cells(g, cone);
    }
    count[SDV__REGION_ENTRIES] = sdv__roomy(count[SDV__REGION_ENTRIES]);
    count[SDV__BLOCK_ENTRIES] = sdv__roomy(count[SDV__BLOCK_ENTRIES]);
    count[SDV__ENTRIES] = sdv__roomy(count[SDV__ENTRIES]);
    /* one more of each holds the sum */
    count[SDV__REGION_PARTS] =
        sdv__blocks(g, edge * SDV_REGION) * ceil((double)g->cone_count / SDV_CHUNK) + 1;
    count[SDV__BLOCK_PARTS] = sdv__blocks(g, edge) * SDV_BLOCK_PARTS + 1;
    count[SDV__CELLS] = (double)g->cell_count + 1;
    count[SDV__WORDS] = ceil(g->size[0] / 32.0) * g->size[1] * g->size[2];
    for (i = 0; i < LAO_FURTHER_ITEMS; i++) {
        double n = count[i + 1];
        if (image_size < LAO_ITEMS_WIDTH || n > SDV__EXACT ||
            n > (double)LAO_ITEMS_WIDTH * image_size) {
            return 0;
        }
    }
    for (i = 0; i < LAO_FURTHER_ITEMS; i++) {
        items[i] = count[i + 1] > items[i] ? (uint32_t)count[i + 1] : items[i];
    }
    return 1;
}

/* A grid's box and cones, without its cells. */
static lao_result sdv__grid_cones(const sdv_host *host, const sdv_tree *tree,
                                  const sdv_grid_desc *desc, sdv_grid *g) {
    memset(g, 0, sizeof *g);
    g->allocator = sdv__allocator(host);
    g->cone_count = tree->segment_count + sdv__lone_count(tree);
    if (g->cone_count > SDV__EXACT) {
        return sdv__fail(host, SDV_LOG_GRID_LISTS, "%u segments", g->cone_count);
    }
    if (!sdv__grid_frame(tree, desc, g)) {
        return sdv__fail(host, SDV_LOG_GRID_CELLS, "%u x %u x %u", g->size[0], g->size[1],
                         g->size[2]);
    }
    sdv__cones_take(tree, g);
    if (!g->cones || !g->cone_nodes) {
        sdv_grid_free(g);
        return sdv__fail(host, SDV_LOG_MEMORY, "a grid's %u cones", g->cone_count);
    }
    sdv__cones_fill(tree, g);
    return LAO_OK;
}
/* Cells for a grid that has its box and cones. On failure the grid is as before. */
static lao_result sdv__grid_complete(const sdv_host *host, const sdv_tree *tree, sdv_grid *grid) {
    sdv_grid_desc same;
    sdv_grid built;
    lao_result result;
    memset(&same, 0, sizeof same);
    same.origin = &grid->origin.x;
    same.cell = grid->cell;
    memcpy(same.size, grid->size, sizeof same.size);
    result = sdv_grid_build(host, tree, &same, &built);
    if (result == LAO_OK) {
        sdv_grid_free(grid);
        *grid = built;
    }
    return result;
}
/* Who builds the field of the grid: the device if it can, else the CPU, here. */
static lao_result sdv__object_field(const sdv_host *host, const sdv_tree *tree, sdv_grid *grid,
                                    sdv_object *object) {
    uint32_t items[LAO_FURTHER_ITEMS];
    lao_result result = LAO_OK;
    int fits;
    memcpy(items, object->desc.further_items, sizeof items);
    fits = sdv__device_items(grid, object->image_size, items);
    if (!fits) {
        (void)sdv__fail(host, SDV_LOG_GRID_DEVICE, "%u cells, %u segments", grid->cell_count,
                        grid->cone_count);
        result = sdv__grid_complete(host, tree, grid);
    }
    if (result == LAO_OK) {
        object->on_device = (uint32_t)fits;
        memcpy(object->desc.further_items, items, sizeof items);
    }
    return result;
}

SDV_API lao_result sdv_object_make_tree(const sdv_host *host, const sdv_tree *tree,
                                        const sdv_grid_desc *desc, uint32_t image_size,
                                        const uint8_t *colors, sdv_object *object) {
    sdv_grid_desc standard;
    lao_result result;
    memset(&standard, 0, sizeof standard);
    if (!tree || !object || !tree->memory) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_make_tree");
    }
    memset(object, 0, sizeof *object);
    object->allocator = sdv__allocator(host);
    object->image_size = image_size;
    result = sdv__grid_cones(host, tree, desc ? desc : &standard, &object->grid);
    if (result == LAO_OK) {
        result = sdv__object_field(host, tree, &object->grid, object);
    }
    if (result == LAO_OK) {
        sdv__object_grid(object, &object->grid);
        if (!sdv__object_colors(object, colors, object->grid.cone_count)) {
            result = sdv__fail(host, SDV_LOG_MEMORY, "colours of cones");
        }
    }
    if (result != LAO_OK) {
        sdv_object_free(object);
    }
    return result;
}

/* ---- the vessel that is nearest, however far */
/* Cones in the order of their middles, SDV_LEAF_CONES a leaf, under balls around what is below
   (see the shared text). */
static void sdv__nearest_order(const lao_v4 *cones, uint32_t count, uint32_t *keys) {
    double low[3], high[3], size = 0;
    uint32_t i, k;
    sdv__ball_bounds(cones, 2 * count, low, high);
    for (k = 0; k < 3; k++) {
        size = high[k] - low[k] > size ? high[k] - low[k] : size;
    }
    for (i = 0; i < count; i++) {
        const lao_v4 *c = cones + 2 * (size_t)i;
        lao_v3 a = lao_v3_make(c[0].x, c[0].y, c[0].z), b = lao_v3_make(c[1].x, c[1].y, c[1].z);
        sdv__piece s;
        s.u = a;
        s.v = b;
        s.w = lao_v3_along(a, lao_v3_sub(b, a), 0.5f);
        keys[i] = sdv__morton(&s, low, size);
    }
    sdv__sort(keys, count, keys + count, keys + 2 * (size_t)count);
}
static lao_v4 sdv__nearest_ball(const lao_v4 *cones, const uint32_t *order, uint32_t first,
                                uint32_t end) {
    lao_v3 low = lao_v3_make(SDV_FAR, SDV_FAR, SDV_FAR), high = lao_v3_scale(low, -1.0f);
    uint32_t i, k;
    for (i = first; i < end; i++) {
        for (k = 0; k < 2; k++) {
            lao_v4 c = cones[2 * (size_t)order[i] + k];
            sdv__box_grow(&low, &high, lao_v3_make(c.x - c.w, c.y - c.w, c.z - c.w));
            sdv__box_grow(&low, &high, lao_v3_make(c.x + c.w, c.y + c.w, c.z + c.w));
        }
    }
    return first < end ? sdv__box_ball(&low, &high) : lao_v4_make(0.0f, 0.0f, 0.0f, -SDV_FAR);
}
static void sdv__nearest_fill(const lao_v4 *cones, uint32_t count, const uint32_t *order,
                              uint32_t leaves, lao_v4 *balls) {
    uint32_t node, i, wide = leaves * SDV_LEAF_CONES; /* cones below a node */
    balls[0] = lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    for (node = 1; node < 2 * leaves; node++) {
        uint32_t first, end;
        wide /= node > 1 && (node & (node - 1)) == 0 ? 2u : 1u; /* the first of its level */
        first = node * wide - leaves * SDV_LEAF_CONES;
        end = first + wide < count ? first + wide : count;
        balls[node] = sdv__nearest_ball(cones, order, first, end);
    }
    for (i = 0; i < leaves; i++) {
        float id[SDV_LEAF_CONES];
        uint32_t k;
        for (k = 0; k < SDV_LEAF_CONES; k++) {
            uint32_t at = i * SDV_LEAF_CONES + k;
            id[k] = at < count ? (float)order[at] : -1.0f;
        }
        balls[2 * (size_t)leaves + i] = lao_v4_make(id[0], id[1], id[2], id[3]);
    }
}
/* The buffer of the shapes, which are in object->shapes: with the hierarchy behind them where one
   takes the colour of the nearest vessel. */
static lao_result sdv__object_nearest(const sdv_host *host, sdv_object *object) {
    const lao_allocator *a = &object->allocator;
    const lao_v4 *cones = NULL;
    uint32_t i, wanted = 0, leaves = 1, count = 0, *keys;
    uint32_t shapes = (uint32_t)object->shapes[0].x, first = 1 + 4 * shapes;
    lao_v4 *texels;
    for (i = 0; i < shapes; i++) {
        wanted |= object->shapes[4 + 4 * (size_t)i].w < 0.5f;
    }
    for (i = 0; i < object->desc.buffer_count; i++) {
        if (strcmp(object->buffers[i].name, "vessel_cones") == 0) {
            cones = (const lao_v4 *)object->buffers[i].data;
            count = (uint32_t)object->box[1].w;
        }
    }
    if (!wanted || !cones) {
        object->shapes[0].w = 0.0f;
        sdv__object_buffer(object, "vessel_shapes", object->shapes, first);
        return LAO_OK;
    }
    for (; leaves * SDV_LEAF_CONES < count; leaves *= 2) {
    }
    texels = (lao_v4 *)lao__take(a, first + 3 * (uint64_t)leaves, sizeof *texels);
    keys = (uint32_t *)lao__take(a, 3 * (uint64_t)count, sizeof *keys); /* and order, other */
    if (texels && keys) {
        object->shapes[0].z = (float)first;
        object->shapes[0].w = (float)leaves;
        memcpy(texels, object->shapes, first * sizeof *texels);
        sdv__nearest_order(cones, count, keys);
        sdv__nearest_fill(cones, count, keys + count, leaves, texels + first);
        lao__give(a, object->nearest);
        object->nearest = texels;
        sdv__object_buffer(object, "vessel_shapes", texels, first + 3 * leaves);
        lao__give(a, keys);
        return LAO_OK;
    }
    lao__give(a, texels);
    lao__give(a, keys);
    return sdv__fail(host, SDV_LOG_MEMORY, "the nearest of %u vessels", count);
}

/* The cones of the tree as it is now, and a new box where it has left the old one. */
static lao_result sdv__object_renew(const sdv_host *host, const sdv_tree *tree,
                                    sdv_object *object) {
    const sdv_grid *old = &object->grid;
    sdv_grid_desc desc;
    sdv_grid grid;
    lao_result result;
    uint32_t k;
    memset(&desc, 0, sizeof desc);
    if (sdv__grid_holds(old, tree)) {
        desc.origin = &old->origin.x;
        desc.cell = old->cell;
        memcpy(desc.size, old->size, sizeof desc.size);
    }
    desc.resolution = 16;
    for (k = 0; k < 3; k++) {
        desc.resolution = old->size[k] > desc.resolution ? old->size[k] : desc.resolution;
    }
    result = sdv__grid_cones(host, tree, &desc, &grid);
    if (result == LAO_OK) {
        result = sdv__object_field(host, tree, &grid, object);
        sdv_grid_free(result == LAO_OK ? &object->grid : &grid);
    }
    if (result == LAO_OK) {
        object->grid = grid;
    }
    return result;
}

SDV_API lao_result sdv_object_move(const sdv_host *host, const sdv_tree *tree,
                                   const uint32_t *nodes, uint32_t count, sdv_object *object) {
    lao_result result;
    if (!object || !object->grid.cones) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_move");
    }
    result = sdv__grid_fits(host, tree, nodes, count, &object->grid);
    if (result == LAO_OK) {
        result = object->on_device ? sdv__object_renew(host, tree, object)
                                   : sdv_grid_update(host, tree, nodes, count, &object->grid);
    }
    if (result == LAO_OK) {
        sdv__object_grid(object, &object->grid);
        result = object->nearest ? sdv__object_nearest(host, object) : LAO_OK;
    }
    return result;
}

static bool sdv__shape_fits(const sdv_shape *s, uint32_t field_count) {
    double size = (double)s->b.x * (double)s->b.y * (double)s->b.z;
    uint32_t i;
    for (i = 0; i < 4; i++) {
        if (!(fabsf(sdv__v4_at(s->a, i)) <= 1e9f && fabsf(sdv__v4_at(s->b, i)) <= 1e9f)) {
            return false;
        }
    }
    if (s->kind == SDV_SHAPE_TREE) {
        return s->operation != SDV_SUBTRACTION;
    }
    if (s->kind == SDV_SHAPE_ELLIPSOID) {
        return s->b.x > 0.0f && s->b.y > 0.0f && s->b.z > 0.0f;
    }
    return s->kind != SDV_SHAPE_FIELD ||
           (s->a.w > 0.0f && s->b.x >= 2.0f && s->b.y >= 2.0f && s->b.z >= 2.0f && s->b.w >= 0.0f &&
            (double)s->b.w + size <= field_count);
}

SDV_API lao_result sdv_object_shapes(const sdv_host *host, const sdv_shapes *shapes,
                                     const float *colors, sdv_object *object) {
    uint32_t i;
    if (!object || !shapes || (shapes->count && !shapes->shapes)) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_shapes");
    }
    if (shapes->count > SDV_MOST_SHAPES || (shapes->field_count && !shapes->fields) ||
        shapes->field_count > 1u << 24) {
        return sdv__fail(host, SDV_LOG_SHAPES, "%u shapes", shapes->count);
    }
    for (i = 0; i < shapes->count; i++) {
        if (!sdv__shape_fits(&shapes->shapes[i], shapes->field_count)) {
            return sdv__fail(host, SDV_LOG_SHAPES, "shape %u", i);
        }
    }
    object->shapes[0] =
        lao_v4_make((float)shapes->count, sdv__united(shapes) ? 1.0f : 0.0f, 0.0f, 0.0f);
    for (i = 0; i < shapes->count; i++) {
        const sdv_shape *s = &shapes->shapes[i];
        lao_v4 *to = object->shapes + 1 + 4 * (size_t)i;
        to[0] = s->a;
        to[1] = s->b;
        to[2] = lao_v4_make((float)s->kind, (float)s->operation, 0.0f, 0.0f);
        to[3] = lao_v4_make(0.93f, 0.86f, 0.72f, 1.0f);
        if (colors) {
            const float *c = colors + (size_t)3 * i;
            to[3] = lao_v4_make(c[0], c[1], c[2], c[0] < 0.0f ? 0.0f : 1.0f);
        }
    }
    if (shapes->field_count) {
        sdv__object_buffer(object, "vessel_fields", shapes->fields, shapes->field_count);
    } else {
        sdv__object_drop(object, "vessel_fields");
    }
    return sdv__object_nearest(host, object);
}

/* Fills the buffers of a mesh, which stand one behind the other in `memory`: three texels a vertex,
   one a triangle, colours. 0: the mesh is none. */
static int sdv__mesh_fill(const sdv_mesh_desc *d, lao_v4 *vertices, lao_v4 *triangles,
                          uint8_t *colors, float bounds[2][3]) {
    uint32_t i, k;
    for (i = 0; i < d->vertex_count; i++) {
        const float *p = d->positions + 3 * (size_t)i, *n = d->normals + 3 * (size_t)i;
        const float *z = d->directions ? d->directions + 3 * (size_t)i : NULL;
        lao_v4 *to = vertices + 3 * (size_t)i;
        for (k = 0; k < 3; k++) {
            if (!(fabsf(p[k]) <= 1e9f && fabsf(n[k]) <= 1e9f && (!z || fabsf(z[k]) <= 1e9f))) {
                return 0;
            }
            bounds[0][k] = i ? lao_min(bounds[0][k], p[k]) : p[k];
            bounds[1][k] = i ? lao_max(bounds[1][k], p[k]) : p[k];
        }
        to[0] = lao_v4_make(p[0], p[1], p[2], 1.0f);
        to[1] = lao_v4_make(n[0], n[1], n[2], 0.0f);
        to[2] = lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
        if (z) {
            float sure = lao_sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2]);
            to[2] = lao_v4_make(z[0], z[1], z[2], lao_min(sure, 1.0f));
        }
    }
    for (i = 0; i < d->triangle_count; i++) {
        const uint32_t *t = d->triangles + 3 * (size_t)i;
        if (t[0] >= d->vertex_count || t[1] >= d->vertex_count || t[2] >= d->vertex_count) {
            return 0;
        }
        triangles[i] = lao_v4_make((float)t[0], (float)t[1], (float)t[2], 0.0f);
    }
    for (i = 0; i < 4 * d->vertex_count; i++) {
        colors[i] = d->colors ? d->colors[i] : 255;
    }
    return 1;
}

SDV_API lao_result sdv_object_drawn(const sdv_host *host, const float *bounds, sdv_object *object) {
    if (!bounds || !object) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_drawn");
    }
    memset(object, 0, sizeof *object);
    object->allocator = sdv__allocator(host);
    memcpy(object->desc.bounds, bounds, sizeof object->desc.bounds);
    sdv__object_buffer(object, "vessel_box", object->box, 2);
    return LAO_OK;
}

SDV_API lao_result sdv_object_mesh(const sdv_host *host, const sdv_mesh_desc *desc,
                                   sdv_object *object) {
    lao_allocator allocator = sdv__allocator(host);
    const uint32_t most = 1u << 24;
    float bounds[2][3];
    lao_v4 *memory;
    size_t size;
    if (!desc || !object || !desc->positions || !desc->normals || !desc->triangles) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_mesh");
    }
    if (!desc->vertex_count || !desc->triangle_count || desc->vertex_count > most / 3 ||
        desc->triangle_count > most) {
        return sdv__fail(host, SDV_LOG_MESH, "%u vertices, %u triangles", desc->vertex_count,
                         desc->triangle_count);
    }
    size = (3 * (size_t)desc->vertex_count + desc->triangle_count) * sizeof *memory +
           4 * (size_t)desc->vertex_count;
    memory = (lao_v4 *)lao__take(&allocator, size, 1);
    if (!memory) {
        return sdv__fail(host, SDV_LOG_MEMORY, "a mesh of %u vertices", desc->vertex_count);
    }
    if (!sdv__mesh_fill(desc, memory, memory + 3 * (size_t)desc->vertex_count,
                        (uint8_t *)(memory + 3 * (size_t)desc->vertex_count + desc->triangle_count),
                        bounds)) {
        lao__give(&allocator, memory);
        return sdv__fail(host, SDV_LOG_MESH, NULL);
    }
    sdv_object_drawn(host, bounds[0], object);
    object->memory = memory;
    object->desc.triangle_count = desc->triangle_count;
    sdv__object_buffer(object, "vessel_vertices", memory, 3 * desc->vertex_count);
    memory += 3 * (size_t)desc->vertex_count;
    sdv__object_buffer(object, "vessel_triangles", memory, desc->triangle_count);
    sdv__object_buffer(object, "vessel_colors", memory + desc->triangle_count, desc->vertex_count);
    return LAO_OK;
}

typedef struct sdv__grey {
    float value;
    uint32_t place;
} sdv__grey;
static int sdv__by_grey(const void *a, const void *b) {
    const sdv__grey *x = (const sdv__grey *)a, *y = (const sdv__grey *)b;
    if (x->value != y->value) {
        return x->value < y->value ? -1 : 1;
    }
    return x->place < y->place ? -1 : x->place > y->place;
}

SDV_API lao_result sdv_object_pattern(const sdv_host *host, const float *values, uint32_t size,
                                      sdv_object *object) {
    lao_allocator a = sdv__allocator(host);
    uint32_t i, count = size * size;
    sdv__grey *greys;
    float *pattern;
    if (!values || !object || object->pattern || !object->desc.buffers) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_object_pattern");
    }
    if (size < 1 || size > SDV_MOST_PATTERN) {
        return sdv__fail(host, SDV_LOG_IMAGE_SIZE, "a pattern of %u x %u", size, size);
    }
    greys = (sdv__grey *)lao__take(&a, count, sizeof *greys);
    pattern = (float *)lao__take(&a, count + 1, sizeof *pattern);
    if (!greys || !pattern) {
        lao__give(&a, greys);
        lao__give(&a, pattern);
        return sdv__fail(host, SDV_LOG_MEMORY, "a pattern of %u x %u", size, size);
    }
    for (i = 0; i < count; i++) {
        greys[i].value = values[i] == values[i] ? values[i] : 0.0f;
        greys[i].place = i;
    }
    qsort(greys, count, sizeof *greys, sdv__by_grey);
    pattern[0] = (float)size;
    for (i = 0; i < count; i++) {
        pattern[1 + greys[i].place] = ((float)i + 0.5f) / (float)count;
    }
    lao__give(&a, greys);
    object->pattern = pattern;
    sdv__object_buffer(object, "vessel_pattern", pattern, count + 1);
    return LAO_OK;
}

SDV_API void sdv_object_free(sdv_object *object) {
    if (object && object->allocator.release) {
        lao__give(&object->allocator, object->pattern);
        lao__give(&object->allocator, object->nearest);
        lao__give(&object->allocator, object->memory);
        sdv_grid_free(&object->grid);
        memset(object, 0, sizeof *object);
    }
}

#ifdef __cplusplus
}
#endif

#endif /* SDFVESSEL_IMPLEMENTATION_DONE */
#endif /* SDFVESSEL_IMPLEMENTATION */
