/* ================================================================================================
 * shared_shape: what a field is combined with (shapes, forms) and what it gives for free (outlines,
   shadows, openness, least distances). Uses shared_field. */
/* SDV_SHARED_BEGIN */
/* ---- shapes and Boolean operations */
/* kind: SDV_SHAPE_...; ball: a = centre, radius; box: a = centre, b = half its size; plane: a =
   unit normal, offset, inside where normal . p < offset; field: a = place of the first sample,
   distance of neighbours; b = samples along each axis, 2 or more, and where the first one is;
   ellipsoid: a = centre, b = half axes. */
struct sdv_shape {
    lao_v4 a, b;
    lao_int kind, operation;
};
#ifndef LAO_GLSL
typedef struct sdv_shape sdv_shape;
#endif
#ifdef LAO_GLSL
#define SDV_UNION 0
#define SDV_INTERSECTION 1
#define SDV_SUBTRACTION 2
#define SDV_SHAPE_BALL 0
#define SDV_SHAPE_BOX 1
#define SDV_SHAPE_PLANE 2
#define SDV_SHAPE_FIELD 3
#define SDV_SHAPE_TREE 4
#define SDV_SHAPE_ELLIPSOID 5
#endif
LAO_FN lao_v3 sdv_box_apart(lao_v3 p, lao_v4 centre, lao_v4 half_size) {
    LAO_EXACT float x = lao_abs(p.x - centre.x) - half_size.x;
    LAO_EXACT float y = lao_abs(p.y - centre.y) - half_size.y;
    LAO_EXACT float z = lao_abs(p.z - centre.z) - half_size.z;
    return lao_v3_make(x, y, z);
}
/* A place among the samples of a field: its lowest neighbour, the place between that and the next
   along each axis, 0 .. 1, and how far outside all samples it is, mm. */
struct sdv_lattice {
    lao_v3 part;
    lao_int at, row, layer; /* first sample; what leads to the next along y and z */
    float apart;
};
#ifndef LAO_GLSL
typedef struct sdv_lattice sdv_lattice;
#endif
LAO_FN lao_v2 sdv_lattice_axis(float p, float low, float cell, float count) {
    LAO_EXACT float at = lao_min(lao_max((p - low) / cell, 0.0f), count - 1.0f);
    LAO_EXACT float whole = lao_min(lao_floor(at), count - 2.0f);
    LAO_EXACT float part = at - whole;
    return lao_v2_make(whole, part);
}
LAO_FN sdv_lattice sdv_lattice_at(lao_v3 p, sdv_shape shape) {
    lao_v2 x = sdv_lattice_axis(p.x, shape.a.x, shape.a.w, shape.b.x);
    lao_v2 y = sdv_lattice_axis(p.y, shape.a.y, shape.a.w, shape.b.y);
    lao_v2 z = sdv_lattice_axis(p.z, shape.a.z, shape.a.w, shape.b.z);
    sdv_lattice r;
    r.part = lao_v3_make(x.y, y.y, z.y);
    r.row = LAO_I(shape.b.x);
    r.layer = r.row * LAO_I(shape.b.y);
    r.at = LAO_I(shape.b.w) + LAO_I(x.x) + r.row * LAO_I(y.x) + r.layer * LAO_I(z.x);
    LAO_EXACT float ex = shape.a.x + (shape.b.x - 1.0f) * shape.a.w;
    LAO_EXACT float ey = shape.a.y + (shape.b.y - 1.0f) * shape.a.w;
    LAO_EXACT float ez = shape.a.z + (shape.b.z - 1.0f) * shape.a.w;
    LAO_EXACT float ox = lao_max(lao_max(shape.a.x - p.x, p.x - ex), 0.0f);
    LAO_EXACT float oy = lao_max(lao_max(shape.a.y - p.y, p.y - ey), 0.0f);
    LAO_EXACT float oz = lao_max(lao_max(shape.a.z - p.z, p.z - ez), 0.0f);
    LAO_EXACT float apart = lao_sqrt(lao_v3_dot(lao_v3_make(ox, oy, oz), lao_v3_make(ox, oy, oz)));
    r.apart = apart;
    return r;
}
/* Trilinear value (w) and its gradient (x, y, z) from the eight samples around: low z, then high;
   of each (0, 0), (1, 0), (0, 1), (1, 1). */
LAO_FN lao_v4 sdv_lattice_value(lao_v3 part, lao_v4 low, lao_v4 high) {
    LAO_EXACT float x0 = low.x + (low.y - low.x) * part.x;
    LAO_EXACT float x1 = low.z + (low.w - low.z) * part.x;
    LAO_EXACT float x2 = high.x + (high.y - high.x) * part.x;
    LAO_EXACT float x3 = high.z + (high.w - high.z) * part.x;
    LAO_EXACT float y0 = x0 + (x1 - x0) * part.y;
    LAO_EXACT float y1 = x2 + (x3 - x2) * part.y;
    LAO_EXACT float value = y0 + (y1 - y0) * part.z;
    LAO_EXACT float gz = y1 - y0;
    LAO_EXACT float gy = (x1 - x0) + ((x3 - x2) - (x1 - x0)) * part.z;
    LAO_EXACT float d0 = (low.y - low.x) + ((low.w - low.z) - (low.y - low.x)) * part.y;
    LAO_EXACT float d1 = (high.y - high.x) + ((high.w - high.z) - (high.y - high.x)) * part.y;
    LAO_EXACT float gx = d0 + (d1 - d0) * part.z;
    return lao_v4_make(gx, gy, gz, value);
}
/* ---- forms: what the cone of a tree with such attributes is instead of round and smooth. Its
   surface stays inside the round cone a, b. */
/* a, b: section at that end: unit vector of the shorter axis, and what the ratio's inverse has over
   1; bump: amplitude at a and b, mm; the most that sdv_form_level may rise per mm; bumps per mm. */
struct sdv_form {
    lao_v4 a, b, bump;
};
#ifndef LAO_GLSL
typedef struct sdv_form sdv_form;
#endif
/* Of a corner of the lattice, in [-1, 1). */
LAO_FN float sdv_noise_corner(lao_uint x, lao_uint y, lao_uint z) {
    LAO_EXACT float r = 2.0f * lao_unit_float(lao_hash(x + lao_hash(y + lao_hash(z)))) - 1.0f;
    return r;
}
LAO_FN lao_v4 sdv_noise_four(lao_uint x, lao_uint y, lao_uint z) {
    return lao_v4_make(sdv_noise_corner(x, y, z), sdv_noise_corner(x + 1u, y, z),
                       sdv_noise_corner(x, y + 1u, z), sdv_noise_corner(x + 1u, y + 1u, z));
}
/* Between two corners (x, to the fifth power: no creases) and its slope (y). */
LAO_FN lao_v2 sdv_noise_fade(float f) {
    LAO_EXACT float fade = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
    LAO_EXACT float slope = 30.0f * f * f * (f * (f - 2.0f) + 1.0f);
    return lao_v2_make(fade, slope);
}
/* Gradient (xyz) and value (w, in [-1, 1]) of value noise on the lattice of whole numbers. The
   gradient is no longer than SDV_NOISE_SLOPE: 2 (corners) times 15/8 (fade). */
#define SDV_NOISE_SLOPE 3.76f
LAO_FN lao_v4 sdv_noise(lao_v3 p) {
    lao_v3 low = lao_v3_make(lao_floor(lao_min(lao_max(p.x, -1.0e9f), 1.0e9f)),
                             lao_floor(lao_min(lao_max(p.y, -1.0e9f), 1.0e9f)),
                             lao_floor(lao_min(lao_max(p.z, -1.0e9f), 1.0e9f)));
    lao_uint x = LAO_U(LAO_I(low.x));
    lao_uint y = LAO_U(LAO_I(low.y));
    lao_uint z = LAO_U(LAO_I(low.z));
    lao_v3 part = lao_v3_sub(p, low);
    lao_v2 u = sdv_noise_fade(lao_clamp01(part.x));
    lao_v2 v = sdv_noise_fade(lao_clamp01(part.y));
    lao_v2 w = sdv_noise_fade(lao_clamp01(part.z));
    lao_v4 n = sdv_lattice_value(lao_v3_make(u.x, v.x, w.x), sdv_noise_four(x, y, z),
                                 sdv_noise_four(x, y, z + 1u));
    LAO_EXACT float gx = n.x * u.y;
    LAO_EXACT float gy = n.y * v.y;
    LAO_EXACT float gz = n.z * w.y;
    return lao_v4_make(gx, gy, gz, n.w);
}
/* The lower of the ratios at both ends. */
LAO_FN float sdv_form_ratio(sdv_form form) {
    LAO_EXACT float ratio = 1.0f / (1.0f + lao_max(form.a.w, form.b.w));
    return ratio;
}
/* Where v, from a, is along the axis of a cone: 0 at a, 1 at b, not cut off. */
LAO_FN float sdv_form_foot(lao_v3 v, lao_v3 axis) {
    LAO_EXACT float foot = lao_v3_dot(v, axis) / lao_max(lao_v3_dot(axis, axis), 1.0e-30f);
    return foot;
}
/* By how much u . v grows where space is stretched by a section. */
LAO_FN float sdv_section_stretch(lao_v4 section, lao_v3 u, lao_v3 v) {
    lao_v3 m = sdv_xyz(section);
    LAO_EXACT float by = section.w * lao_v3_dot(m, u) * lao_v3_dot(m, v);
    return by;
}
LAO_FN lao_v3 sdv_section_add(lao_v3 to, lao_v3 v, lao_v4 section, float part) {
    lao_v3 m = sdv_xyz(section);
    LAO_EXACT float by = part * section.w * lao_v3_dot(v, m);
    return lao_v3_along(to, m, by);
}
/* Space stretched along the shorter axes, as it is at `foot`: there the ellipsoid of the section is
   a ball. */
LAO_FN lao_v3 sdv_form_stretched(lao_v3 v, sdv_form form, float foot) {
    LAO_EXACT float t = lao_clamp01(foot);
    return sdv_section_add(sdv_section_add(v, v, form.a, 1.0f - t), v, form.b, t);
}
/* The other end of the cone whose space is stretched around a. */
LAO_FN lao_v4 sdv_form_end(lao_v4 a, lao_v3 axis, float radius, sdv_form form, float foot) {
    lao_v3 end = lao_v3_add(sdv_xyz(a), sdv_form_stretched(axis, form, foot));
    return lao_v4_make(end.x, end.y, end.z, radius);
}
/* Below 0 inside the cone's form, 0 on its surface (w), and the gradient (xyz): the distance in
   stretched space and the noise, inwards from the round cone. */
LAO_FN lao_v4 sdv_form_level(lao_v3 p, lao_v4 a, lao_v4 b, sdv_form form) {
    lao_v3 axis = lao_v3_sub(sdv_xyz(b), sdv_xyz(a));
    lao_v3 v = lao_v3_sub(p, sdv_xyz(a));
    float foot = sdv_form_foot(v, axis);
    lao_v4 end = sdv_form_end(a, axis, b.w, form, foot);
    lao_v3 q = lao_v3_add(sdv_xyz(a), sdv_form_stretched(v, form, foot));
    sdv_cone_point c = sdv_cone_point_make(q, a, end);
    lao_v3 g = sdv_round_cone_gradient(q, a, end);
    LAO_EXACT float more = form.bump.y - form.bump.x;
    LAO_EXACT float amplitude = form.bump.x + lao_clamp01(foot) * more;
    lao_v4 noise = lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f);
    if (amplitude > 0.0f) {
        noise = sdv_noise(lao_v3_scale(p, form.bump.w));
    }
    LAO_EXACT float lift = 1.0f + noise.w;
    LAO_EXACT float level = c.distance + amplitude * lift;
    LAO_EXACT float steep = amplitude * form.bump.w;
    lao_v3 slope = lao_v3_along(sdv_form_stretched(g, form, foot), sdv_xyz(noise), steep);
    if (foot > 0.0f && foot < 1.0f) { /* section and amplitude change along the cone */
        lao_v3 u = lao_v3_along(v, axis, -c.place);
        LAO_EXACT float change =
            sdv_section_stretch(form.b, u, g) - sdv_section_stretch(form.a, u, g) + more * lift;
        slope = lao_v3_along(slope, axis, change / lao_v3_dot(axis, axis));
    }
    return lao_v4_make(slope.x, slope.y, slope.z, level);
}
/* Outward normal (xyz), and the distance as far as level and gradient tell it (w). */
LAO_FN lao_v4 sdv_form_estimate(lao_v3 p, lao_v4 a, lao_v4 b, sdv_form form) {
    lao_v4 level = sdv_form_level(p, a, b, form);
    lao_v3 g = sdv_xyz(level);
    LAO_EXACT float steep = lao_sqrt(lao_v3_dot(g, g));
    LAO_EXACT float distance = level.w / lao_max(steep, 0.1f);
    g = lao_v3_unit(g, lao_v3_make(0.0f, 0.0f, 1.0f));
    return lao_v4_make(g.x, g.y, g.z, distance);
}
/* Where the level is less than this it rises by no more than form.bump.z per mm. */
LAO_FN float sdv_form_most(lao_v4 a, lao_v4 b, sdv_form form) {
    LAO_EXACT float most = 0.25f * lao_max(a.w, b.w) * (1.0f + lao_max(form.a.w, form.b.w));
    return most;
}
/* A bound of the distance that is 0 where that is, and 1-Lipschitz; round: sdv_round_cone. */
LAO_FN float sdv_form_bound(float round, lao_v4 level, lao_v4 a, lao_v4 b, sdv_form form) {
    LAO_EXACT float bound = lao_min(level.w, sdv_form_most(a, b, form)) / form.bump.z;
    return lao_max(round, bound);
}
/* Does the form of a cone matter to a sample? along: sdv_cone_along. The ray meets the round cone
   first. */
LAO_FN bool sdv_near_asks(sdv_near n, lao_v2 along) {
    return along.x < n.distance || along.y < n.advance;
}
/* sdv_near_add for a form that matters. */
LAO_FN sdv_near sdv_near_form(sdv_near n, lao_v2 along, lao_v3 p, lao_v4 a, lao_v4 b, sdv_form form,
                              float cone) {
    sdv_near r = n;
    float d = sdv_form_bound(along.x, sdv_form_level(p, a, b, form), a, b, form);
    if (d < n.distance) {
        r.distance = d;
        r.cone = cone;
    }
    r.advance = lao_min(n.advance, lao_max(along.y, d));
    return r;
}
/* sdv_minimum_add for a form: where the ray is nearest to the cone without bumps, with the section
   of where it is nearest to the round one. */
LAO_FN sdv_minimum sdv_minimum_form(sdv_minimum r, lao_v3 origin, lao_v3 direction, lao_v4 a,
                                    lao_v4 b, sdv_form form, float low, float high) {
    sdv_minimum n = r;
    lao_v3 from = sdv_xyz(a);
    lao_v3 axis = lao_v3_sub(sdv_xyz(b), from);
    lao_v2 round = sdv_line_nearest(origin, direction, a, b);
    float foot = sdv_form_foot(lao_v3_sub(lao_v3_along(origin, direction, round.y), from), axis);
    lao_v3 o = lao_v3_add(from, sdv_form_stretched(lao_v3_sub(origin, from), form, foot));
    lao_v3 d = sdv_form_stretched(direction, form, foot);
    LAO_EXACT float shorter = 1.0f / lao_sqrt(lao_v3_dot(d, d));
    lao_v4 end = sdv_form_end(a, axis, b.w, form, foot);
    LAO_EXACT float place = sdv_line_nearest(o, lao_v3_scale(d, shorter), a, end).y * shorter;
    LAO_EXACT float t = lao_min(lao_max(place, low), high);
    float distance = sdv_form_estimate(lao_v3_along(origin, direction, t), a, b, form).w;
    n.last = r.cone;
    if (distance < r.d) {
        n.d = distance;
        n.t = t;
    }
    return n;
}
/* A lower bound of the distance to where the trilinear value is 0: no slope of it is above sqrt(3);
   outside, the shape is no nearer than the nearest place inside is to it. */
LAO_FN float sdv_lattice_distance(sdv_lattice at, float value) {
    LAO_EXACT float d = 0.57f * value;
    return lao_max(d, at.apart > 0.0f ? at.apart : d);
}
/* What is nearer to the distance than that bound, and no bound. */
LAO_FN float sdv_lattice_estimate(sdv_lattice at, float value) {
    return lao_max(value, at.apart > 0.0f ? at.apart : value);
}
/* p from the middle of an ellipsoid, as if it were the unit ball. */
LAO_FN lao_v3 sdv_ellipsoid_place(lao_v3 p, sdv_shape shape) {
    LAO_EXACT float x = (p.x - shape.a.x) / shape.b.x;
    LAO_EXACT float y = (p.y - shape.a.y) / shape.b.y;
    LAO_EXACT float z = (p.z - shape.a.z) / shape.b.z;
    return lao_v3_make(x, y, z);
}
/* Across its surface, as long as the place there changes per mm. */
LAO_FN lao_v3 sdv_ellipsoid_slope(lao_v3 place, sdv_shape shape) {
    LAO_EXACT float x = place.x / shape.b.x;
    LAO_EXACT float y = place.y / shape.b.y;
    LAO_EXACT float z = place.z / shape.b.z;
    return lao_v3_make(x, y, z);
}
/* Of an ellipsoid a lower bound: no distance changes faster along the shortest half axis. */
LAO_FN float sdv_shape_distance(lao_v3 p, sdv_shape shape) {
    if (shape.kind == SDV_SHAPE_ELLIPSOID) {
        lao_v3 e = sdv_ellipsoid_place(p, shape);
        LAO_EXACT float d =
            (lao_sqrt(lao_v3_dot(e, e)) - 1.0f) * lao_min(shape.b.x, lao_min(shape.b.y, shape.b.z));
        return d;
    }
    if (shape.kind == SDV_SHAPE_PLANE) {
        LAO_EXACT float d = lao_v3_dot(p, sdv_xyz(shape.a)) - shape.a.w;
        return d;
    }
    if (shape.kind == SDV_SHAPE_BOX) {
        lao_v3 q = sdv_box_apart(p, shape.a, shape.b);
        lao_v3 o = lao_v3_make(lao_max(q.x, 0.0f), lao_max(q.y, 0.0f), lao_max(q.z, 0.0f));
        LAO_EXACT float d =
            lao_sqrt(lao_v3_dot(o, o)) + lao_min(lao_max(q.x, lao_max(q.y, q.z)), 0.0f);
        return d;
    }
    lao_v3 q = lao_v3_sub(p, sdv_xyz(shape.a));
    LAO_EXACT float d = lao_sqrt(lao_v3_dot(q, q)) - shape.a.w;
    return d;
}
/* For outlines, occlusion and shadows: as near to the distance as can be had, but no bound. */
LAO_FN float sdv_shape_estimate(lao_v3 p, sdv_shape shape) {
    if (shape.kind == SDV_SHAPE_ELLIPSOID) {
        lao_v3 e = sdv_ellipsoid_place(p, shape);
        lao_v3 slope = sdv_ellipsoid_slope(e, shape);
        LAO_EXACT float radial = lao_sqrt(lao_v3_dot(e, e));
        LAO_EXACT float steep = lao_max(lao_sqrt(lao_v3_dot(slope, slope)), 1.0e-30f);
        LAO_EXACT float d = radial * (radial - 1.0f) / steep;
        return d;
    }
    return sdv_shape_distance(p, shape);
}
LAO_FN lao_v3 sdv_shape_gradient(lao_v3 p, sdv_shape shape) {
    lao_v3 a = sdv_xyz(shape.a);
    lao_v3 up = lao_v3_make(0.0f, 0.0f, 1.0f);
    if (shape.kind == SDV_SHAPE_PLANE) {
        return a;
    }
    if (shape.kind == SDV_SHAPE_ELLIPSOID) {
        return lao_v3_unit(sdv_ellipsoid_slope(sdv_ellipsoid_place(p, shape), shape), up);
    }
    lao_v3 q = lao_v3_sub(p, a);
    if (shape.kind != SDV_SHAPE_BOX) {
        return lao_v3_unit(q, up);
    }
    lao_v3 d = sdv_box_apart(p, shape.a, shape.b);
    lao_v3 o = lao_v3_make(lao_max(d.x, 0.0f), lao_max(d.y, 0.0f), lao_max(d.z, 0.0f));
    if (!(lao_v3_dot(o, o) > 0.0f)) { /* inside: the nearest face */
        LAO_EXACT float most = lao_max(d.x, lao_max(d.y, d.z));
        o = lao_v3_make(0.0f, 0.0f, 1.0f);
        if (d.x >= most) {
            o = lao_v3_make(1.0f, 0.0f, 0.0f);
        } else if (d.y >= most) {
            o = lao_v3_make(0.0f, 1.0f, 0.0f);
        }
    }
    return lao_v3_unit(
        lao_v3_make(q.x < 0.0f ? -o.x : o.x, q.y < 0.0f ? -o.y : o.y, q.z < 0.0f ? -o.z : o.z), up);
}
/* A distance, and whose it is: part -1: the tree's; i: that of shape i. side -1: turned inside out.
 */
struct sdv_solid {
    float distance, side;
    lao_int part;
};
#ifndef LAO_GLSL
typedef struct sdv_solid sdv_solid;
#endif
LAO_FN sdv_solid sdv_solid_start(float distance) {
    sdv_solid s;
    s.distance = distance;
    s.side = 1.0f;
    s.part = -1;
    return s;
}
/* min(a, b), max(a, b), max(a, -b): lower bounds of the true distance, never of wrong sign. */
LAO_FN sdv_solid sdv_solid_add(sdv_solid s, float distance, lao_int operation, lao_int part) {
    sdv_solid r = s;
    LAO_EXACT float d = operation == SDV_SUBTRACTION ? -distance : distance;
    if (operation == SDV_UNION ? d < s.distance : d > s.distance) {
        r.distance = d;
        r.side = operation == SDV_SUBTRACTION ? -1.0f : 1.0f;
        r.part = part;
    }
    return r;
}

/* The nearest vessel to a place, however far: a complete binary tree of balls around cones, node i
   over 2 i and 2 i + 1, gone through in that order from the root, 1, to 0. A leaf has up to four.
 */
#define SDV_LEAF_CONES 4
/* Could a ball hold something as near as `least`? The margin is for rounding. */
LAO_FN bool sdv_ball_reaches(lao_v3 p, lao_v4 ball, float least) {
    lao_v3 q = lao_v3_sub(p, sdv_xyz(ball));
    LAO_EXACT float apart = lao_sqrt(lao_v3_dot(q, q));
    LAO_EXACT float nearest = 0.999999f * apart - ball.w;
    return nearest <= least;
}
/* The next node behind all that is below this one; 0: none. */
LAO_FN lao_int sdv_ball_next(lao_int node) {
    lao_int next = node;
    for (lao_int i = 0; i < 24; i++) {
        if (next / 2 * 2 == next) {
            break;
        }
        next = next / 2;
    }
    return next > 0 ? next + 1 : 0;
}
/* Of two cones the nearer, of two as near the lower. */
LAO_FN sdv_near sdv_nearer(sdv_near n, float distance, float cone) {
    sdv_near r = n;
    if (distance < n.distance || (distance == n.distance && cone < n.cone)) {
        r.distance = distance;
        r.cone = cone;
    }
    return r;
}
/* Part of a ray in which a tree with shapes is looked for: only a union adds to the tree's box. */
LAO_FN lao_v2 sdv_solid_span(lao_v2 box, bool united) {
    if (united) {
        return lao_v2_make(0.0f, SDV_FAR);
    }
    return box;
}
/* A lower bound of the tree's distance at p, exact close to the surface and inside, from the
   least of its cell's list and how far the cell is from any. */
LAO_FN float sdv_tree_bound(float least, bool occupied, float far_step, float outside, float cell) {
    float bound = far_step;
    if (occupied) {
        bound = lao_min(least, sdv_near_reach(cell));
    }
    return outside > 0.0f ? lao_max(bound, outside) : bound;
}

/* Near misses of a tree with shapes, whose distances tell nothing of the line but samples: where
   they have stopped falling, the least is looked for by halving what is on both sides. */
struct sdv_watch {
    float before, older;     /* t of the last two samples */
    float distance, falling; /* of the last one; 1: it was no more than the one before */
    float d_min, t_min;      /* the least local minimum so far */
};
struct sdv_dip {
    float low, high;   /* t: the minimum is between */
    float t, distance; /* the least so far */
};
#ifndef LAO_GLSL
typedef struct sdv_watch sdv_watch;
typedef struct sdv_dip sdv_dip;
#endif
#define SDV_DIP_ROUNDS 4
LAO_FN sdv_watch sdv_watch_start(float t) {
    sdv_watch w;
    w.before = t;
    w.older = t;
    w.distance = SDV_FAR;
    w.falling = 1.0f;
    w.d_min = SDV_FAR;
    w.t_min = 0.0f;
    return w;
}
/* The last sample was a local minimum that may matter; `distance`: of this one. */
LAO_FN bool sdv_watch_passed(sdv_watch w, float distance, float reach) {
    return w.falling > 0.5f && distance > w.distance &&
           (reach > 0.0f ? w.distance < 2.0f * reach : w.distance < SDV_FAR);
}
LAO_FN sdv_watch sdv_watch_next(sdv_watch w, float t, float distance) {
    sdv_watch r = w;
    r.older = w.before;
    r.before = t;
    r.distance = distance;
    r.falling = distance > w.distance ? 0.0f : 1.0f;
    return r;
}
LAO_FN sdv_watch sdv_watch_keep(sdv_watch w, sdv_dip d) {
    sdv_watch r = w;
    if (d.distance < w.d_min) {
        r.d_min = d.distance;
        r.t_min = d.t;
    }
    return r;
}
/* Between the sample before the last and t. */
LAO_FN sdv_dip sdv_dip_start(sdv_watch w, float t) {
    sdv_dip d;
    d.low = w.older;
    d.high = t;
    d.t = w.before;
    d.distance = w.distance;
    return d;
}
/* Where to look on the lower side (0) and on the upper one. */
LAO_FN float sdv_dip_place(sdv_dip d, lao_int side) {
    LAO_EXACT float t = 0.5f * (d.t + (side != 0 ? d.high : d.low));
    return t;
}
/* What was found there. */
LAO_FN sdv_dip sdv_dip_add(sdv_dip d, float below, float above) {
    sdv_dip r = d;
    float low = sdv_dip_place(d, 0), high = sdv_dip_place(d, 1);
    if (below < d.distance && below <= above) {
        r.high = d.t;
        r.t = low;
        r.distance = below;
    } else if (above < d.distance) {
        r.low = d.t;
        r.t = high;
        r.distance = above;
    } else {
        r.low = low;
        r.high = high;
    }
    return r;
}

/* ---- outlines and shadows from d_min (L19 5 with METHODS 5.4); lengths in mm */
/* Outside the tree, nearer to it than `width`. */
LAO_FN bool sdv_is_silhouette(bool hit, float d_min, float width) {
    return !hit && d_min < width;
}
/* The same, and in front of parts farther away. */
LAO_FN bool sdv_is_contour(float d_min, float width) {
    return d_min < width;
}
/* The rim of something `depth` mm in front, wider the deeper the gap: d_min < min(ratio depth,
   most). t, t_min: the ray's parameters of the surface and of the near miss. */
LAO_FN bool sdv_is_depth_shadow(float d_min, float t_min, float t, float ratio, float most) {
    LAO_EXACT float depth = lao_abs(t - t_min);
    LAO_EXACT float width = lao_min(ratio * depth, most);
    return d_min < width;
}
/* How dark that shadow is, 0 .. 1: the rim of it, a part `softness` of its width, fades. */
LAO_FN float sdv_depth_shadow(float d_min, float t_min, float t, float ratio, float most,
                              float softness) {
    LAO_EXACT float width = lao_min(ratio * lao_abs(t - t_min), most);
    LAO_EXACT float dark = (1.0f - d_min / lao_max(width, 1.0e-30f)) / lao_max(softness, 1.0e-3f);
    if (!(d_min < width)) {
        return 0.0f;
    }
    return lao_clamp01(dark);
}
/* Start of a shadow's way, off the surface. */
LAO_FN float sdv_shadow_bias(float cell) {
    LAO_EXACT float r = 0.05f * cell;
    return r;
}
/* Soft shadow: `light` so far, 1 at the start, after a sample of the field at t on the way. */
LAO_FN float sdv_shadow_add(float light, float distance, float t, float hardness) {
    LAO_EXACT float passed = hardness * distance / lao_max(t, 1.0e-6f);
    return lao_min(light, lao_max(passed, 0.0f));
}
/* Ambient occlusion: sample i of SDV_OPEN_SAMPLES is that far along the normal, and what it adds.
 */
#define SDV_OPEN_SAMPLES 5
LAO_FN float sdv_open_place(float reach, lao_int i) {
    LAO_EXACT float r = reach * (LAO_F(i) + 1.0f) / LAO_F(SDV_OPEN_SAMPLES);
    return r;
}
LAO_FN float sdv_open_weight(lao_int i) {
    return lao_bits_float(LAO_U(127 - i) << 23u); /* 2^-i */
}
/* From within a vessel it looks no farther than the middle, beyond which the field falls again:
   `room`, radius of the nearest cone at the place, whose distance is `distance`. */
LAO_FN float sdv_open_reach(float reach, float room, float distance, float cell) {
    float within = lao_min(reach, lao_max(room, sdv_hit_distance(cell)));
    return lao_abs(distance) < cell ? within : reach;
}
/* What the sample's ball lacks of free room, as part of it. */
LAO_FN float sdv_open_add(float closed, float distance, float place, lao_int i) {
    LAO_EXACT float lack = lao_clamp01((place - distance) / place);
    LAO_EXACT float r = closed + sdv_open_weight(i) * lack;
    return r;
}
LAO_FN float sdv_open_result(float closed) {
    LAO_EXACT float r = 1.0f - closed / (2.0f - sdv_open_weight(SDV_OPEN_SAMPLES - 1));
    return lao_clamp01(r);
}

/* ---- least distances to round cones, exact (a cone is convex, and so is its distance on a segment
   or triangle) */
/* Of the points p .. q. */
LAO_FN float sdv_segment_cone(lao_v3 p, lao_v3 q, lao_v4 a, lao_v4 b) {
    lao_v3 pq = lao_v3_sub(q, p);
    LAO_EXACT float length = lao_sqrt(lao_v3_dot(pq, pq));
    if (!(length > 1.0e-12f)) {
        return sdv_round_cone(p, a, b);
    }
    lao_v3 direction = lao_v3_scale(pq, 1.0f / length);
    lao_v2 nearest = sdv_line_nearest(p, direction, a, b);
    LAO_EXACT float t = lao_min(lao_max(0.0f, nearest.y), length);
    return sdv_round_cone(lao_v3_along(p, direction, t), a, b);
}
/* Where the point p of the plane of a triangle is: not outside of any edge. n: its normal, any
 * length. */
LAO_FN bool sdv_in_triangle(lao_v3 p, lao_v3 u, lao_v3 v, lao_v3 w, lao_v3 n) {
    LAO_EXACT float a = lao_v3_dot(lao_v3_cross(lao_v3_sub(v, u), lao_v3_sub(p, u)), n);
    LAO_EXACT float b = lao_v3_dot(lao_v3_cross(lao_v3_sub(w, v), lao_v3_sub(p, v)), n);
    LAO_EXACT float c = lao_v3_dot(lao_v3_cross(lao_v3_sub(u, w), lao_v3_sub(p, w)), n);
    return a >= 0.0f && b >= 0.0f && c >= 0.0f;
}
/* The ball at `s` of the way from a to b: of the points of the plane, its centre's foot is nearest.
 */
LAO_FN float sdv_triangle_ball(float least, lao_v3 u, lao_v3 v, lao_v3 w, lao_v3 n, lao_v4 a,
                               lao_v4 b, float s) {
    lao_v3 ab = lao_v3_make(b.x - a.x, b.y - a.y, b.z - a.z);
    lao_v3 c = lao_v3_along(sdv_xyz(a), ab, s);
    LAO_EXACT float height = lao_v3_dot(lao_v3_sub(c, u), n);
    lao_v3 foot = lao_v3_along(c, n, -height);
    if (!sdv_in_triangle(foot, u, v, w, n)) {
        return least;
    }
    return lao_min(least, sdv_round_cone(foot, a, b));
}
/* Of the points of a triangle: on an edge, or below an end of the axis, or where the axis meets the
 * plane. */
LAO_FN float sdv_triangle_cone(lao_v3 u, lao_v3 v, lao_v3 w, lao_v4 a, lao_v4 b) {
    LAO_EXACT float least =
        lao_min(sdv_segment_cone(u, v, a, b),
                lao_min(sdv_segment_cone(v, w, a, b), sdv_segment_cone(w, u, a, b)));
    lao_v3 zero = lao_v3_make(0.0f, 0.0f, 0.0f);
    lao_v3 n = lao_v3_unit(lao_v3_cross(lao_v3_sub(v, u), lao_v3_sub(w, u)), zero);
    if (!(lao_v3_dot(n, n) > 0.5f)) {
        return least;
    }
    LAO_EXACT float ha = lao_v3_dot(lao_v3_sub(sdv_xyz(a), u), n);
    LAO_EXACT float hb = lao_v3_dot(lao_v3_sub(sdv_xyz(b), u), n);
    least = sdv_triangle_ball(least, u, v, w, n, a, b, 0.0f);
    least = sdv_triangle_ball(least, u, v, w, n, a, b, 1.0f);
    if ((ha < 0.0f) != (hb < 0.0f)) {
        least = sdv_triangle_ball(least, u, v, w, n, a, b, ha / (ha - hb));
    }
    return least;
}
/* SDV_SHARED_END */
