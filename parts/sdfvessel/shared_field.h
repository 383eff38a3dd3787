/* ================================================================================================
 * shared_field: round cones, colours, the grid of cells, tracing a ray. From SDV_SHARED_BEGIN to
   SDV_SHARED_END the text is C99, C++11 and GLSL at once, behind lineao.h's, whose rules hold. Uses
   lineao.h's shared text. */
/* SDV_SHARED_BEGIN */
LAO_FN lao_v3 sdv_xyz(lao_v4 v) {
    return lao_v3_make(v.x, v.y, v.z);
}
/* ---- round cones (L19 3.2 with METHODS 4): a, b = centre and radius of the two ends, mm */
/* A point seen from a cone: the balls between a and b reach nearest to it from `place`. */
struct sdv_cone_point {
    float distance; /* signed, mm */
    float place;    /* of the nearest ball, 0 at a, 1 at b */
    lao_v3 away;    /* from that ball's centre to the point */
    float radial;   /* length of away */
    lao_v3 axis;    /* from a to b, not unit */
};
#ifndef LAO_GLSL
typedef struct sdv_cone_point sdv_cone_point;
#endif
/* The three regions of METHODS 4 in one: with x along the axis and y away from it, the centre of
   the nearest ball is at x - y d / l, and stays between the ends. Where one ball holds the other it
   is the nearest. */
LAO_FN sdv_cone_point sdv_cone_point_make(lao_v3 p, lao_v4 a, lao_v4 b) {
    sdv_cone_point c;
    lao_v3 q = lao_v3_sub(p, sdv_xyz(a));
    c.axis = lao_v3_make(b.x - a.x, b.y - a.y, b.z - a.z);
    LAO_EXACT float s = lao_sqrt(lao_v3_dot(c.axis, c.axis));
    LAO_EXACT float d = a.w - b.w;
    LAO_EXACT float least = lao_abs(d) + 1.0e-6f * lao_max(a.w, b.w);
    LAO_EXACT float place = d < 0.0f ? 1.0f : 0.0f;
    if (s > least) {
        LAO_EXACT float inverse = 1.0f / s;
        LAO_EXACT float foot = lao_v3_dot(q, c.axis) * inverse * inverse;
        lao_v3 across = lao_v3_along(q, c.axis, -foot);
        LAO_EXACT float y = lao_sqrt(lao_v3_dot(across, across));
        LAO_EXACT float l = lao_sqrt((s - d) * (s + d));
        LAO_EXACT float back = y * (d * inverse / l);
        place = lao_clamp01(foot - back);
    }
    c.place = place;
    c.away = lao_v3_along(q, c.axis, -place);
    LAO_EXACT float radial = lao_sqrt(lao_v3_dot(c.away, c.away));
    LAO_EXACT float distance = radial - (a.w - place * d);
    c.radial = radial;
    c.distance = distance;
    return c;
}
/* Radius of the ball that is nearest to the point. */
LAO_FN float sdv_cone_ball_radius(sdv_cone_point c, lao_v4 a, lao_v4 b) {
    LAO_EXACT float radius = a.w + c.place * (b.w - a.w);
    return radius;
}
/* Signed distance in mm, exact outside and inside; one ball when it holds the other (Eqs. 1-3,
   corrected). */
LAO_FN float sdv_round_cone(lao_v3 p, lao_v4 a, lao_v4 b) {
    sdv_cone_point c = sdv_cone_point_make(p, a, b);
    return c.distance;
}
/* Any unit vector at a right angle to the unit vector v. */
LAO_FN lao_v3 sdv_perpendicular(lao_v3 v) {
    LAO_EXACT float x = lao_abs(v.x);
    LAO_EXACT float y = lao_abs(v.y);
    LAO_EXACT float z = lao_abs(v.z);
    lao_v3 least = lao_v3_make(0.0f, 0.0f, 1.0f);
    if (x <= y && x <= z) {
        least = lao_v3_make(1.0f, 0.0f, 0.0f);
    } else if (y <= z) {
        least = lao_v3_make(0.0f, 1.0f, 0.0f);
    }
    return lao_v3_unit(lao_v3_cross(v, least), least);
}
/* Gradient of the distance: a unit vector, the outward normal on the surface. At the centre of a
   ball and on the axis any of the possible ones. */
LAO_FN lao_v3 sdv_round_cone_gradient(lao_v3 p, lao_v4 a, lao_v4 b) {
    sdv_cone_point c = sdv_cone_point_make(p, a, b);
    lao_v3 otherwise = sdv_perpendicular(c.axis);
    LAO_EXACT float s = lao_sqrt(lao_v3_dot(c.axis, c.axis));
    LAO_EXACT float d = a.w - b.w;
    if (s > lao_abs(d)) {
        LAO_EXACT float outward = lao_sqrt((s - d) * (s + d)) / s;
        LAO_EXACT float along = d / (s * s);
        otherwise = lao_v3_along(lao_v3_scale(otherwise, outward), c.axis, along);
    }
    return lao_v3_unit(c.away, otherwise);
}
/* Slope of the distance along a unit direction: gradient times direction. */
LAO_FN float sdv_cone_slope(sdv_cone_point c, lao_v3 direction) {
    LAO_EXACT float slope = lao_v3_dot(c.away, direction) / lao_max(c.radial, 1.0e-30f);
    return slope;
}

/* ---- colours */
/* Hue in turns, saturation, value to RGB. */
LAO_FN lao_v3 sdv_hsv(float h, float s, float v) {
    LAO_EXACT float t = 6.0f * (h - lao_floor(h));
    LAO_EXACT float r = lao_clamp01(lao_abs(t - 3.0f) - 1.0f);
    LAO_EXACT float g = lao_clamp01(2.0f - lao_abs(t - 2.0f));
    LAO_EXACT float b = lao_clamp01(2.0f - lao_abs(t - 4.0f));
    LAO_EXACT float x = v * (1.0f - s * (1.0f - r));
    LAO_EXACT float y = v * (1.0f - s * (1.0f - g));
    LAO_EXACT float z = v * (1.0f - s * (1.0f - b));
    return lao_v3_make(x, y, z);
}
/* Place of (h, s) in the radial drawing, in the unit disc: the root in the middle (L19 3.1). */
LAO_FN lao_v2 sdv_radial(float h, float s) {
    LAO_EXACT float reach = 1.0f - s;
    LAO_EXACT float x = reach * lao_cos_turns(h);
    LAO_EXACT float y = reach * lao_sin_turns(h);
    return lao_v2_make(x, y);
}
/* ---- grid and tracing (L19 3.2 with METHODS 5) */
#define SDV_FAR 1.0e30f
#define SDV_MAX_STEPS 1024
/* A box of cubic cells: lower corner, edge of a cell in mm, cells along each axis. */
struct sdv_box {
    lao_v3 origin;
    float cell;
    lao_v3 size;
};
#ifndef LAO_GLSL
typedef struct sdv_box sdv_box;
#endif
LAO_FN lao_v3 sdv_cell_centre(sdv_box box, lao_uint x, lao_uint y, lao_uint z) {
    LAO_EXACT float cx = box.origin.x + (LAO_F(x) + 0.5f) * box.cell;
    LAO_EXACT float cy = box.origin.y + (LAO_F(y) + 0.5f) * box.cell;
    LAO_EXACT float cz = box.origin.z + (LAO_F(z) + 0.5f) * box.cell;
    return lao_v3_make(cx, cy, cz);
}
/* Index of the cell that holds p, or of the one nearest to it. */
LAO_FN lao_int sdv_cell_at(sdv_box box, lao_v3 p) {
    LAO_EXACT float x = lao_floor((p.x - box.origin.x) / box.cell);
    LAO_EXACT float y = lao_floor((p.y - box.origin.y) / box.cell);
    LAO_EXACT float z = lao_floor((p.z - box.origin.z) / box.cell);
    lao_int ix = LAO_I(lao_min(lao_max(0.0f, x), box.size.x - 1.0f));
    lao_int iy = LAO_I(lao_min(lao_max(0.0f, y), box.size.y - 1.0f));
    lao_int iz = LAO_I(lao_min(lao_max(0.0f, z), box.size.z - 1.0f));
    return ix + LAO_I(box.size.x) * (iy + LAO_I(box.size.y) * iz);
}
/* What a cell lists: cones up to this distance from its centre, mm. */
LAO_FN float sdv_list_reach(float cell) {
    return 2.0f * cell;
}
/* The device builds the lists of cells from those of blocks, at most SDV_BLOCKS along an axis,
   those from lists of regions, SDV_REGION blocks along an axis, and those from chunks of SDV_CHUNK
   cones. The list of a block is made in SDV_BLOCK_PARTS parts. A grid has at most SDV_AXIS cells
   along an axis. */
#define SDV_BLOCKS 32
#define SDV_REGION 6
#define SDV_CHUNK 32
#define SDV_BLOCK_PARTS 8
#define SDV_AXIS 512
/* The middle of the cells from `low` to `last`, and (w) how far a cone that one of them lists may
   be from there. Distances are 1-Lipschitz; the margin is for rounding. */
LAO_FN lao_v4 sdv_block_reach(sdv_box box, lao_v3 low, lao_v3 last) {
    lao_v3 middle = lao_v3_scale(lao_v3_add(low, last), 0.5f);
    lao_v3 apart = lao_v3_sub(last, middle);
    LAO_EXACT float x = box.origin.x + (middle.x + 0.5f) * box.cell;
    LAO_EXACT float y = box.origin.y + (middle.y + 0.5f) * box.cell;
    LAO_EXACT float z = box.origin.z + (middle.z + 0.5f) * box.cell;
    LAO_EXACT float most = lao_abs(box.origin.x) + lao_abs(box.origin.y) + lao_abs(box.origin.z) +
                           (box.size.x + box.size.y + box.size.z) * box.cell;
    LAO_EXACT float reach = sdv_list_reach(box.cell) +
                            lao_sqrt(lao_v3_dot(apart, apart)) * box.cell + 0.02f * box.cell +
                            1.0e-5f * most;
    return lao_v4_make(x, y, z, reach);
}
/* From anywhere in a cell, what is nearer than this is in its list: 2 - sqrt(3) / 2, less rounding.
 */
LAO_FN float sdv_near_reach(float cell) {
    return 1.125f * cell;
}
/* How far a ray may go from anywhere in an empty cell whose centre is `apart` mm from the nearest
   centre of an occupied cell. The surface is 2 - sqrt(3) / 2 cells or more behind the last empty
   cell on the way to it: apart + 2 - sqrt(3) from the centre, another sqrt(3) / 2 less from p. */
LAO_FN float sdv_far_step(float apart, float cell) {
    LAO_EXACT float step = apart - 0.6f * cell;
    return lao_max(step, sdv_near_reach(cell));
}
/* Part of the ray inside the box: from x to y, x > y where it misses. */
LAO_FN float sdv_ray_slope(float d) {
    LAO_EXACT float r = 1.0f / (lao_abs(d) < 1.0e-12f ? (d < 0.0f ? -1.0e-12f : 1.0e-12f) : d);
    return r;
}
LAO_FN lao_v2 sdv_ray_box(lao_v3 origin, lao_v3 direction, sdv_box box) {
    lao_v3 slope = lao_v3_make(sdv_ray_slope(direction.x), sdv_ray_slope(direction.y),
                               sdv_ray_slope(direction.z));
    LAO_EXACT float x0 = (box.origin.x - origin.x) * slope.x;
    LAO_EXACT float y0 = (box.origin.y - origin.y) * slope.y;
    LAO_EXACT float z0 = (box.origin.z - origin.z) * slope.z;
    LAO_EXACT float x1 = (box.origin.x + box.size.x * box.cell - origin.x) * slope.x;
    LAO_EXACT float y1 = (box.origin.y + box.size.y * box.cell - origin.y) * slope.y;
    LAO_EXACT float z1 = (box.origin.z + box.size.z * box.cell - origin.z) * slope.z;
    LAO_EXACT float from =
        lao_max(lao_max(lao_min(x0, x1), lao_min(y0, y1)), lao_max(lao_min(z0, z1), 0.0f));
    LAO_EXACT float to = lao_min(lao_min(lao_max(x0, x1), lao_max(y0, y1)), lao_max(z0, z1));
    return lao_v2_make(from, to);
}

/* Distance of p to the box, 0 inside. */
LAO_FN float sdv_box_distance(lao_v3 p, sdv_box box) {
    LAO_EXACT float x = lao_max(box.origin.x - p.x, p.x - box.origin.x - box.size.x * box.cell);
    LAO_EXACT float y = lao_max(box.origin.y - p.y, p.y - box.origin.y - box.size.y * box.cell);
    LAO_EXACT float z = lao_max(box.origin.z - p.z, p.z - box.origin.z - box.size.z * box.cell);
    lao_v3 apart = lao_v3_make(lao_max(x, 0.0f), lao_max(y, 0.0f), lao_max(z, 0.0f));
    LAO_EXACT float r = lao_sqrt(lao_v3_dot(apart, apart));
    return r;
}

/* The nearest of the cones of a list at a point of a ray, and how far the ray may go before it can
   meet any of them. */
struct sdv_near {
    float distance, advance, cone;
};
#ifndef LAO_GLSL
typedef struct sdv_near sdv_near;
#endif
LAO_FN sdv_near sdv_near_start(float reach) {
    sdv_near n;
    n.distance = SDV_FAR;
    n.advance = reach;
    n.cone = -1.0f;
    return n;
}
/* Distance of p to the cone (x), and where the tangent of the distance along the ray falls to 0
   (y): a cone is convex, so its distance along a ray is too, and the ray cannot meet it sooner. */
LAO_FN lao_v2 sdv_cone_along(lao_v3 p, lao_v3 direction, lao_v4 a, lao_v4 b) {
    sdv_cone_point c = sdv_cone_point_make(p, a, b);
    LAO_EXACT float step = c.distance / lao_max(-sdv_cone_slope(c, direction), 1.0e-6f);
    return lao_v2_make(c.distance, step);
}
LAO_FN sdv_near sdv_near_add(sdv_near n, lao_v3 p, lao_v3 direction, lao_v4 a, lao_v4 b,
                             float cone) {
    sdv_near r = n;
    lao_v2 along = sdv_cone_along(p, direction, a, b);
    if (along.x < n.distance) {
        r.distance = along.x;
        r.cone = cone;
    }
    r.advance = lao_min(n.advance, along.y);
    return r;
}
/* Least distance of the whole line to the cone (x, mm; negative: it passes through it) and where
   (y): seen along the line, the cone is a flat round cone and the line a point. */
LAO_FN lao_v2 sdv_line_nearest(lao_v3 origin, lao_v3 direction, lao_v4 a, lao_v4 b) {
    lao_v3 qa = lao_v3_sub(sdv_xyz(a), origin);
    lao_v3 qb = lao_v3_sub(sdv_xyz(b), origin);
    LAO_EXACT float ta = lao_v3_dot(qa, direction);
    LAO_EXACT float tb = lao_v3_dot(qb, direction);
    lao_v3 fa = lao_v3_along(qa, direction, -ta);
    lao_v3 fb = lao_v3_along(qb, direction, -tb);
    lao_v4 pa = lao_v4_make(fa.x, fa.y, fa.z, a.w);
    lao_v4 pb = lao_v4_make(fb.x, fb.y, fb.z, b.w);
    lao_v3 zero = lao_v3_make(0.0f, 0.0f, 0.0f);
    sdv_cone_point c = sdv_cone_point_make(zero, pa, pb);
    LAO_EXACT float t = ta + (tb - ta) * c.place;
    return lao_v2_make(c.distance, t);
}

/* A ray under way. */
struct sdv_march {
    float t, end;         /* mm */
    float before, older;  /* t of the last two samples */
    float distance, cone; /* of the last sample */
    float falling;        /* 1: the distance fell up to the last sample */
    float d_min, t_min;   /* the least local minimum that was passed */
    float low, low_cone; /* over all samples: the ray's least distance to the nearest cone, and that
                            cone */
    float inside;        /* 1: it started inside a vessel */
    float steps;         /* samples so far */
    float state;         /* SDV_MARCH_... */
};
#ifndef LAO_GLSL
typedef struct sdv_march sdv_march;
#endif
#define SDV_MARCH_GOES 0.0f
#define SDV_MARCH_HITS 1.0f
#define SDV_MARCH_LEAVES 2.0f
LAO_FN sdv_march sdv_march_start(lao_v2 span) {
    sdv_march m;
    m.t = span.x;
    m.end = span.y;
    m.before = 0.0f;
    m.older = 0.0f;
    m.distance = SDV_FAR;
    m.cone = -1.0f;
    m.falling = 1.0f;
    m.d_min = SDV_FAR;
    m.t_min = 0.0f;
    m.low = SDV_FAR;
    m.low_cone = -1.0f;
    m.inside = 0.0f;
    m.steps = 0.0f;
    m.state = span.x <= span.y ? SDV_MARCH_GOES : SDV_MARCH_LEAVES;
    return m;
}
/* Distance below which a point is on the surface. */
LAO_FN float sdv_hit_distance(float cell) {
    return 1.0e-3f * cell;
}
/* A local minimum between two points of the ray, by going to where the ray is nearest to the cone
   that was nearest so far, a few times. */
struct sdv_minimum {
    float d, t;       /* the least distance so far and where */
    float cone, last; /* to be looked at, -1: none; the one before */
};
#ifndef LAO_GLSL
typedef struct sdv_minimum sdv_minimum;
#endif
#define SDV_MINIMUM_ROUNDS 3
LAO_FN sdv_minimum sdv_minimum_start(float cone) {
    sdv_minimum r;
    r.d = SDV_FAR;
    r.t = 0.0f;
    r.cone = cone;
    r.last = -1.0f;
    return r;
}
/* a, b: the ends of r.cone; the minimum is in [low, high]. */
LAO_FN sdv_minimum sdv_minimum_add(sdv_minimum r, lao_v3 origin, lao_v3 direction, lao_v4 a,
                                   lao_v4 b, float low, float high) {
    sdv_minimum n = r;
    lao_v2 nearest = sdv_line_nearest(origin, direction, a, b);
    LAO_EXACT float t = lao_min(lao_max(nearest.y, low), high);
    LAO_EXACT float d = sdv_round_cone(lao_v3_along(origin, direction, t), a, b);
    n.last = r.cone;
    if (d < r.d) {
        n.d = d;
        n.t = t;
    }
    return n;
}
/* The sample at r.t decides whether there is a better cone. */
LAO_FN sdv_minimum sdv_minimum_next(sdv_minimum r, sdv_near n) {
    sdv_minimum next = r;
    next.cone = n.distance < r.d && n.cone != r.last ? n.cone : -1.0f;
    return next;
}
LAO_FN sdv_march sdv_march_minimum(sdv_march m, sdv_minimum found) {
    sdv_march r = m;
    if (found.d < m.d_min) {
        r.d_min = found.d;
        r.t_min = found.t;
    }
    return r;
}
/* Keeps the cone that the whole ray, t >= 0, comes nearest to; `found`: one round from a sample's.
 */
LAO_FN sdv_march sdv_march_note(sdv_march m, sdv_minimum found) {
    sdv_march r = m;
    if (found.d < m.low) {
        r.low = found.d;
        r.low_cone = found.last;
    }
    return r;
}
/* The least distance of a ray that hits nothing is looked for between x and y: elsewhere it is more
   than `low` away from the ball around the box. Where it is nearest to the ball's middle: z. */
LAO_FN lao_v3 sdv_least_span(lao_v3 origin, lao_v3 direction, sdv_box box, float low) {
    lao_v3 middle = lao_v3_along(box.origin, box.size, 0.5f * box.cell);
    LAO_EXACT float reach = 0.5f * box.cell * lao_sqrt(lao_v3_dot(box.size, box.size)) + low;
    LAO_EXACT float t = lao_v3_dot(lao_v3_sub(middle, origin), direction);
    return lao_v3_make(lao_max(0.0f, t - reach), t + reach, lao_max(0.0f, t));
}
/* From one sample to the next: nothing in between is much nearer than `low`. */
#define SDV_LEAST_SAMPLES 128
LAO_FN float sdv_least_step(sdv_near n, bool occupied, float far_step, float low, float cell) {
    LAO_EXACT float clear = occupied ? lao_min(n.distance, sdv_near_reach(cell)) : far_step;
    LAO_EXACT float step = clear - 0.9f * low;
    return lao_max(lao_max(step, 0.2f * low), 0.25f * cell);
}
/* The sample before this one was a local minimum of the distance. */
LAO_FN bool sdv_march_passed(sdv_march m, sdv_near n) {
    return m.falling > 0.5f && m.inside < 0.5f && n.distance > m.distance;
}
/* Goes on from a sample at m.t: `n` comes from the list of the cell there when it is `occupied`,
   else of the nearest cell that has one (for its distance; or SDV_FAR when nobody wants d_min), and
   `far_step` is the cell's. */
LAO_FN sdv_march sdv_march_step(sdv_march m, sdv_near n, bool occupied, float far_step,
                                float cell) {
    sdv_march r = m;
    r.falling = n.distance > m.distance ? 0.0f : 1.0f;
    r.distance = n.distance;
    r.cone = n.cone;
    r.steps = m.steps + 1.0f;
    LAO_EXACT float step = occupied ? n.advance : far_step;
    if (occupied) {
        if (m.steps < 0.5f && n.distance < 0.0f) {
            r.inside = 1.0f;
        }
        LAO_EXACT float left = r.inside > 0.5f ? -n.distance : n.distance;
        if (left < sdv_hit_distance(cell)) {
            r.state = SDV_MARCH_HITS;
            return r;
        }
        step = r.inside > 0.5f ? left : step; /* the ball inside the nearest cone */
    }
    r.older = m.before;
    r.before = m.t;
    r.t = m.t + step;
    if (!(r.t <= m.end)) {
        r.state = SDV_MARCH_LEAVES;
    }
    return r;
}
/* May something as near as `reach` be seen from an empty cell? 0: everything matters. */
LAO_FN bool sdv_is_within(float far_step, float reach) {
    return !(reach > 0.0f) || far_step < reach;
}
/* Where rays look for near misses: the box, which has 2 cells around the tree, with a rim where
   that is less than `reach`. What lies in the box is no farther from a place outside than from that
   place's nearest one inside, so cells serve out there as well. */
LAO_FN sdv_box sdv_box_grown(sdv_box box, float reach) {
    sdv_box r = box;
    LAO_EXACT float by = lao_max(reach - 2.0f * box.cell, 0.0f);
    LAO_EXACT float cells = 2.0f * by / box.cell;
    r.origin = lao_v3_make(box.origin.x - by, box.origin.y - by, box.origin.z - by);
    r.size = lao_v3_make(box.size.x + cells, box.size.y + cells, box.size.z + cells);
    return r;
}
#define SDV_POLISH_ROUNDS 2
/* Newton's step from a point close to the surface onto it: where the field's tangent is 0. Of a ray
   that grazes it may lead away; then the place before is kept. */
LAO_FN float sdv_polish(float t, float distance, lao_v3 gradient, lao_v3 direction, float cell) {
    LAO_EXACT float slope = lao_v3_dot(gradient, direction);
    LAO_EXACT float steep = lao_max(lao_abs(slope), 0.02f);
    LAO_EXACT float step = distance / (slope < 0.0f ? steep : -steep);
    LAO_EXACT float most = 0.1f * cell;
    LAO_EXACT float r = t + lao_min(lao_max(step, -most), most);
    return r;
}
/* SDV_SHARED_END */
