/* ================================================================================================
 * trace: rays through the field, what the shaders do with the same shared functions; then through
   a tree combined with shapes, its shadow, openness and normals. Uses grid. */

/* One sample: from the list of the cell at p, or of the nearest cell that has one. */
static sdv_near sdv__near_at(const sdv_grid *g, const lao_v4 *cell, lao_v3 p, lao_v3 direction) {
    sdv_near n = sdv_near_start(sdv_near_reach(g->cell));
    const lao_v4 *from = cell->w > 0.0f ? cell : g->cells + (size_t)cell->y;
    uint32_t i;
    if (g->forms) {
        return sdv__near_forms(g, from, p, direction, n);
    }
    for (i = 0; i < (uint32_t)from->w; i++) {
        float id = g->ids[(size_t)from->z + i];
        const lao_v4 *cone = g->cones + 2 * (size_t)id;
        n = sdv_near_add(n, p, direction, cone[0], cone[1], id);
    }
    return n;
}
static sdv_minimum sdv__minimum_add(const sdv_grid *g, const sdv_ray *ray, sdv_minimum found,
                                    float low, float high) {
    const lao_v4 *ends = g->cones + 2 * (size_t)found.cone;
    return g->forms
               ? sdv_minimum_form(found, ray->origin, ray->direction, ends[0], ends[1],
                                  sdv__form_of(g, found.cone), low, high)
               : sdv_minimum_add(found, ray->origin, ray->direction, ends[0], ends[1], low, high);
}
/* Outward normal of a cone (xyz) and its distance (w), of a form as far as that can be told. round:
   that of the round cone. */
static lao_v4 sdv__estimate(const sdv_grid *g, uint32_t cone, lao_v3 p, float round) {
    const lao_v4 *ends = g->cones + 2 * (size_t)cone;
    lao_v3 n;
    if (g->forms) {
        return sdv_form_estimate(p, ends[0], ends[1], sdv__form_of(g, (float)cone));
    }
    n = sdv_round_cone_gradient(p, ends[0], ends[1]);
    return lao_v4_make(n.x, n.y, n.z, round);
}
static const lao_v4 *sdv__cell_at(const sdv_grid *g, lao_v3 p) {
    return g->cells + sdv_cell_at(sdv__grid_box(g), p);
}

/* Refines a local minimum whose sample was nearest to m.cone, with the cones that turn out to be
   nearest where the ray is nearest to those before. */
static sdv_march sdv__minimum(const sdv_grid *g, const sdv_ray *ray, sdv_march m, float cone,
                              float low, float high) {
    sdv_minimum found = sdv_minimum_start(cone);
    int i;
    for (i = 0; i < SDV_MINIMUM_ROUNDS && found.cone >= 0.0f; i++) {
        lao_v3 p;
        found = sdv__minimum_add(g, ray, found, low, high);
        p = lao_v3_along(ray->origin, ray->direction, found.t);
        found = sdv_minimum_next(found, sdv__near_at(g, sdv__cell_at(g, p), p, ray->direction));
    }
    return sdv_march_minimum(m, found);
}

static sdv_march sdv__note(const sdv_grid *g, const sdv_ray *ray, sdv_march m, sdv_near n) {
    if (n.cone >= 0.0f) {
        m = sdv_march_note(m, sdv__minimum_add(g, ray, sdv_minimum_start(n.cone), 0.0f, SDV_FAR));
    }
    return m;
}

/* The least distance of a ray that hits nothing. */
static sdv_march sdv__least(const sdv_grid *g, const sdv_ray *ray, sdv_march m) {
    sdv_box box = sdv__grid_box(g);
    lao_v3 span = sdv_least_span(ray->origin, ray->direction, box, 0.0f);
    float t = span.z;
    int i;
    for (i = 0; i < SDV_LEAST_SAMPLES && (i == 0 || t <= span.y); i++) {
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, t);
        const lao_v4 *cell = sdv__cell_at(g, p);
        sdv_near n = sdv__near_at(g, cell, p, ray->direction);
        m = sdv__note(g, ray, m, n);
        span = sdv_least_span(ray->origin, ray->direction, box, m.low);
        t = i == 0 ? span.x : t + sdv_least_step(n, cell->w > 0.0f, cell->z, m.low, g->cell);
    }
    return m;
}

/* On to the surface from a point close to it. */
static void sdv__land(const sdv_grid *g, const sdv_ray *ray, const sdv_march *m, sdv_hit *hit) {
    lao_v3 gradient = lao_v3_make(0.0f, 0.0f, 1.0f);
    float t = m->t, off = SDV_FAR;
    int i;
    for (i = 0; i <= SDV_POLISH_ROUNDS; i++) {
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, t);
        sdv_near n = sdv__near_at(g, sdv__cell_at(g, p), p, ray->direction);
        lao_v4 there;
        if (lao_abs(n.distance) > off) {
            break;
        }
        off = lao_abs(n.distance);
        there = sdv__estimate(g, (uint32_t)n.cone, p, n.distance);
        gradient = lao_v3_make(there.x, there.y, there.z);
        hit->position = p;
        hit->cone = (uint32_t)n.cone;
        hit->t = t;
        t = sdv_polish(t, there.w, gradient, ray->direction, g->cell);
    }
    hit->normal = m->inside > 0.5f ? lao_v3_scale(gradient, -1.0f) : gradient;
    hit->inside = m->inside > 0.5f;
}

SDV_API void sdv_trace(const sdv_grid *grid, const sdv_ray *ray, sdv_hit *hit) {
    sdv_box box = sdv__grid_box(grid);
    int nearest = (ray->flags & SDV_TRACE_NEAREST) != 0, i;
    lao_v2 span =
        sdv_ray_box(ray->origin, ray->direction, nearest ? sdv_box_grown(box, ray->reach) : box);
    sdv_march m = sdv_march_start(span);
    for (i = 0; i < SDV_MAX_STEPS && m.state == SDV_MARCH_GOES; i++) {
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, m.t);
        const lao_v4 *cell = sdv__cell_at(grid, p);
        bool occupied = cell->w > 0.0f;
        sdv_near n = sdv_near_start(0.0f);
        if (occupied || (nearest && sdv_is_within(cell->z, ray->reach))) {
            n = sdv__near_at(grid, cell, p, ray->direction);
        }
        if (nearest) {
            m = sdv__note(grid, ray, m, n);
            m = sdv_march_passed(m, n) ? sdv__minimum(grid, ray, m, m.cone, m.older, m.t) : m;
        }
        m = sdv_march_step(m, n, occupied, cell->z, grid->cell);
    }
    if (nearest && m.state != SDV_MARCH_HITS) {
        m = ray->reach > 0.0f ? m : sdv__least(grid, ray, m);
        m.d_min = SDV_FAR;
        m = sdv__minimum(grid, ray, m, m.low_cone, 0.0f, SDV_FAR);
    }
    memset(hit, 0, sizeof *hit);
    hit->cone = SDV_NONE;
    hit->steps = (uint32_t)m.steps;
    hit->d_min = m.d_min;
    hit->t_min = m.t_min;
    if (m.state == SDV_MARCH_HITS) {
        sdv__land(grid, ray, &m, hit);
    }
}

/* ---- shapes, shadow, openness */
/* A lower bound of the tree's distance, exact close to the surface and inside. */
static float sdv__tree_bound(const sdv_grid *g, lao_v3 p, uint32_t *cone) {
    const lao_v4 *cell = sdv__cell_at(g, p);
    float least = cell->w > 0.0f ? sdv__form_distance(g, cell, p, cone) : SDV_FAR;
    return sdv_tree_bound(least, cell->w > 0.0f, cell->z, sdv_box_distance(p, sdv__grid_box(g)),
                          g->cell);
}
static lao_v4 sdv__four(const float *at, lao_int row) {
    return lao_v4_make(at[0], at[1], at[row], at[row + 1]);
}
static lao_v4 sdv__field_value(const sdv_shapes *shapes, const sdv_lattice *l) {
    const float *at = shapes->fields + l->at;
    return sdv_lattice_value(l->part, sdv__four(at, l->row), sdv__four(at + l->layer, l->row));
}
/* bound: no more than the distance; else as near to it as can be had. */
static float sdv__shape_distance(const sdv_shapes *shapes, uint32_t i, lao_v3 p, bool bound) {
    const sdv_shape shape = shapes->shapes[i];
    sdv_lattice l;
    float value;
    if (shape.kind != SDV_SHAPE_FIELD) {
        return bound ? sdv_shape_distance(p, shape) : sdv_shape_estimate(p, shape);
    }
    l = sdv_lattice_at(p, shape);
    value = sdv__field_value(shapes, &l).w;
    return bound ? sdv_lattice_distance(l, value) : sdv_lattice_estimate(l, value);
}
static lao_v3 sdv__shape_gradient(const sdv_shapes *shapes, lao_int i, lao_v3 p) {
    sdv_lattice l;
    lao_v4 v;
    if (shapes->shapes[i].kind != SDV_SHAPE_FIELD) {
        return sdv_shape_gradient(p, shapes->shapes[i]);
    }
    l = sdv_lattice_at(p, shapes->shapes[i]);
    v = sdv__field_value(shapes, &l);
    return lao_v3_unit(lao_v3_make(v.x, v.y, v.z), lao_v3_make(0.0f, 0.0f, 1.0f));
}
/* `tree`, its distance or a lower bound of that at p, combined with all shapes. */
static sdv_solid sdv__solid_of(const sdv_shapes *shapes, float tree, lao_v3 p, bool bound) {
    sdv_solid s = sdv_solid_start(tree);
    uint32_t i;
    for (i = 0; i < shapes->count; i++) {
        bool again = shapes->shapes[i].kind == SDV_SHAPE_TREE;
        s = sdv_solid_add(s, again ? tree : sdv__shape_distance(shapes, i, p, bound),
                          shapes->shapes[i].operation, again ? -1 : (lao_int)i);
    }
    return s;
}
static sdv_solid sdv__solid_at(const sdv_grid *g, const sdv_shapes *shapes, lao_v3 p,
                               uint32_t *cone) {
    return sdv__solid_of(shapes, sdv__tree_bound(g, p, cone), p, true);
}
static lao_v3 sdv__solid_gradient(const sdv_grid *g, const sdv_shapes *shapes, const sdv_solid *s,
                                  lao_v3 p, uint32_t cone) {
    lao_v4 there;
    if (s->part >= 0) {
        return lao_v3_scale(sdv__shape_gradient(shapes, s->part, p), s->side);
    }
    there = sdv__estimate(g, cone, p, s->distance);
    return lao_v3_make(there.x, there.y, there.z);
}
static void sdv__solid_land(const sdv_grid *g, const sdv_shapes *shapes, const sdv_ray *ray,
                            float t, sdv_hit *hit, uint32_t *shape) {
    float off = SDV_FAR;
    int i;
    for (i = 0; i <= SDV_POLISH_ROUNDS; i++) {
        uint32_t cone = 0;
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, t), gradient;
        sdv_solid s = sdv__solid_at(g, shapes, p, &cone);
        if (lao_abs(s.distance) > off) {
            break;
        }
        off = lao_abs(s.distance);
        gradient = sdv__solid_gradient(g, shapes, &s, p, cone);
        hit->position = p;
        hit->cone = s.part >= 0 ? SDV_CUT_CONE : cone;
        hit->normal = hit->inside ? lao_v3_scale(gradient, -1.0f) : gradient;
        hit->t = t;
        if (shape) {
            *shape = s.part >= 0 ? (uint32_t)s.part : SDV_NONE;
        }
        t = sdv_polish(t, s.distance, gradient, ray->direction, g->cell);
    }
}
static bool sdv__united(const sdv_shapes *shapes) {
    uint32_t i;
    for (i = 0; i < shapes->count; i++) {
        if (shapes->shapes[i].operation == SDV_UNION) {
            return true;
        }
    }
    return false;
}

/* What near misses go by: not only a bound, where it matters. */
static float sdv__watched(const sdv_grid *g, const sdv_shapes *shapes, lao_v3 p, float reach) {
    const lao_v4 *cell = sdv__cell_at(g, p);
    float tree = SDV_FAR;
    if (cell->w > 0.0f || sdv_is_within(cell->z, reach)) {
        tree = sdv_grid_distance(g, p, NULL);
    }
    return sdv__solid_of(shapes, tree, p, false).distance;
}
static sdv_watch sdv__dip(const sdv_grid *g, const sdv_shapes *shapes, const sdv_ray *ray,
                          sdv_watch w, float t) {
    sdv_dip d = sdv_dip_start(w, t);
    int i, k;
    for (i = 0; i < SDV_DIP_ROUNDS; i++) {
        float found[2];
        for (k = 0; k < 2; k++) {
            lao_v3 p = lao_v3_along(ray->origin, ray->direction, sdv_dip_place(d, k));
            found[k] = sdv__watched(g, shapes, p, ray->reach);
        }
        d = sdv_dip_add(d, found[0], found[1]);
    }
    return sdv_watch_keep(w, d);
}
static sdv_watch sdv__watch(const sdv_grid *g, const sdv_shapes *shapes, const sdv_ray *ray,
                            sdv_watch w, float t) {
    lao_v3 p = lao_v3_along(ray->origin, ray->direction, t);
    float d = sdv__watched(g, shapes, p, ray->reach);
    if (sdv_watch_passed(w, d, ray->reach)) {
        w = sdv__dip(g, shapes, ray, w, t);
    }
    return sdv_watch_next(w, t, d);
}

SDV_API void sdv_trace_shapes(const sdv_grid *grid, const sdv_shapes *shapes, const sdv_ray *ray,
                              sdv_hit *hit, uint32_t *shape) {
    static const sdv_shapes none = {NULL, 0, NULL, 0};
    bool nearest = (ray->flags & SDV_TRACE_NEAREST) != 0;
    sdv_box box = sdv__grid_box(grid);
    lao_v2 span;
    sdv_watch watch;
    uint32_t cone = 0, i;
    float t;
    shapes = shapes ? shapes : &none;
    box = nearest ? sdv_box_grown(box, ray->reach) : box;
    span = sdv_solid_span(sdv_ray_box(ray->origin, ray->direction, box), sdv__united(shapes));
    t = span.x;
    watch = sdv_watch_start(t);
    memset(hit, 0, sizeof *hit);
    hit->cone = SDV_NONE;
    if (shape) {
        *shape = SDV_NONE;
    }
    for (i = 0; i < SDV_MAX_STEPS && t <= span.y; i++) {
        lao_v3 p = lao_v3_along(ray->origin, ray->direction, t);
        sdv_solid s = sdv__solid_at(grid, shapes, p, &cone);
        float left;
        hit->inside = i == 0 ? s.distance < 0.0f : hit->inside;
        left = hit->inside ? -s.distance : s.distance;
        hit->steps++;
        if (left < sdv_hit_distance(grid->cell)) {
            sdv__solid_land(grid, shapes, ray, t, hit, shape);
            break;
        }
        watch = nearest && !hit->inside ? sdv__watch(grid, shapes, ray, watch, t) : watch;
        t += left;
    }
    if (nearest && hit->cone == SDV_NONE && sdv_watch_passed(watch, SDV_FAR, ray->reach)) {
        watch = sdv__dip(grid, shapes, ray, watch, watch.before);
    }
    hit->d_min = watch.d_min;
    hit->t_min = watch.t_min;
}

SDV_API float sdv_shadow(const sdv_grid *grid, const sdv_shapes *shapes, lao_v3 p, lao_v3 light,
                         float hardness, float bias) {
    lao_v2 span = sdv_ray_box(p, light, sdv__grid_box(grid));
    float lit = 1.0f, t;
    int i;
    span = shapes ? sdv_solid_span(span, sdv__united(shapes)) : span;
    t = lao_max(bias, span.x);
    for (i = 0; i < SDV_MAX_STEPS && t <= span.y && lit > 0.0f; i++) {
        lao_v3 q = lao_v3_along(p, light, t);
        uint32_t cone;
        float d = sdv_grid_distance(grid, q, NULL), step = sdv__tree_bound(grid, q, &cone);
        d = shapes ? sdv__solid_of(shapes, d, q, false).distance : d;
        step = shapes ? sdv__solid_of(shapes, step, q, true).distance : step;
        lit = sdv_shadow_add(lit, d, t, hardness);
        lit = d < sdv_hit_distance(grid->cell) ? 0.0f : lit;
        t += lao_max(step, sdv_hit_distance(grid->cell));
    }
    return lit;
}
SDV_API lao_v3 sdv_smooth_normal(const sdv_grid *grid, lao_v3 p, uint32_t cone, lao_v3 normal,
                                 float smoothness) {
    const lao_v4 *cell = sdv__cell_at(grid, p), *own = grid->cones + 2 * (size_t)cone;
    lao_v2 reach = sdv_joint_reach(p, own[0], own[1], smoothness, grid->cell);
    lao_v4 at = sdv__estimate(grid, cone, p, 0.0f);
    lao_v3 sum = sdv_joint_start(lao_v3_make(at.x, at.y, at.z), own[0], own[1], reach);
    uint32_t i;
    if (!(reach.x > 0.0f)) {
        return normal;
    }
    for (i = 0; i < (uint32_t)cell->w; i++) {
        uint32_t other = (uint32_t)grid->ids[(size_t)cell->z + i];
        const lao_v4 *ends = grid->cones + 2 * (size_t)other;
        float round = grid->forms ? 0.0f : sdv_round_cone(p, ends[0], ends[1]);
        if (!(round < reach.x)) {
            continue;
        }
        at = sdv__estimate(grid, other, p, round);
        if (at.w < reach.x) {
            sum = sdv_joint_add(sum, at.w, lao_v3_make(at.x, at.y, at.z), ends[0], ends[1], reach);
        }
    }
    return sdv_joint_normal(sum, normal);
}
/* How far it is from the wall of a cone at p to the middle. */
static float sdv__room(const sdv_grid *g, uint32_t cone, lao_v3 p) {
    const lao_v4 *ends = g->cones + 2 * (size_t)cone;
    sdv_cone_point c = sdv_cone_point_make(p, ends[0], ends[1]);
    float room = sdv_cone_ball_radius(c, ends[0], ends[1]);
    return g->forms ? room * sdv_form_ratio(sdv__form_of(g, (float)cone)) : room;
}
SDV_API float sdv_openness(const sdv_grid *grid, const sdv_shapes *shapes, lao_v3 p, lao_v3 normal,
                           float reach, uint32_t inside) {
    float closed = 0.0f;
    lao_int i;
    if (inside && reach > 0.0f) {
        uint32_t cone = 0;
        float d = sdv_grid_distance(grid, p, &cone);
        reach = sdv_open_reach(reach, sdv__room(grid, cone, p), d, grid->cell);
    }
    for (i = 0; i < SDV_OPEN_SAMPLES && reach > 0.0f; i++) {
        float place = sdv_open_place(reach, i);
        lao_v3 q = lao_v3_along(p, normal, place);
        uint32_t cone = 0;
        float d = sdv_grid_distance(grid, q, &cone);
        d = grid->forms ? sdv__estimate(grid, cone, q, d).w : d;
        d = shapes ? sdv__solid_of(shapes, d, q, false).distance : d;
        closed = sdv_open_add(closed, inside ? -d : d, place, i);
    }
    return sdv_open_result(closed);
}
