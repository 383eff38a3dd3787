/* A ray per pixel through the distance field of a vessel tree (L19 3.2; METHODS 5.3, 5.4): sdv_trace by texel fetches. */
LAO_TEX(0, samplerBuffer, box)   /* lower corner and edge of a cell; cells along each axis */
LAO_TEX(1, samplerBuffer, cells) /* of sdv_grid, like what follows */
LAO_TEX(2, samplerBuffer, ids)
LAO_TEX(3, samplerBuffer, cones)
LAO_TEX(4, sampler2D, grid) /* the same, made by the rows before */
LAO_TEX(5, sampler2D, lists)
LAO_CONSTANT(0, lao_constant_near_miss)
LAO_CONSTANT(1, lao_constant_supersampling)
LAO_CONSTANT(2, lao_constant_has_vessel_cells)
LAO_CONSTANT(3, lao_constant_parameterization)
LAO_CONSTANT(4, lao_constant_has_vessel_forms)

LAO_OUT(0, vec4, out_position) /* world, mm; number of the cone, -1: nothing was hit */
LAO_OUT(1, vec4, out_normal)   /* world, towards the viewer; least distance of a near miss, mm */
LAO_OUT(2, vec4, out_ray)      /* mm along the ray: hit, near miss; samples; 1: from inside a vessel */

#ifdef LAO_FRAGMENT
LAO_INCLUDE vessel_field.glsl

sdv_minimum minimum_add(sdv_minimum found, lao_v3 origin, lao_v3 direction, float low, float high) {
    int at = 2 * int(found.cone);
    vec4 a = texelFetch(cones, at);
    vec4 b = texelFetch(cones, at + 1);
    if (lao_constant_has_vessel_forms != 0) {
        return sdv_minimum_form(found, origin, direction, a, b, form_at(found.cone), low, high);
    }
    return sdv_minimum_add(found, origin, direction, a, b, low, high);
}
/* Refines a local minimum whose sample was nearest to `cone`. */
sdv_march minimum(sdv_box b, lao_v3 origin, lao_v3 direction, sdv_march m, float cone, float low, float high) {
    sdv_minimum found = sdv_minimum_start(cone);
    for (int i = 0; i < SDV_MINIMUM_ROUNDS; i++) {
        if (found.cone < 0.0) {
            break;
        }
        found = minimum_add(found, origin, direction, low, high);
        found = sdv_minimum_next(found, near_at(b, lao_v3_along(origin, direction, found.t), direction));
    }
    return sdv_march_minimum(m, found);
}

sdv_march note(lao_v3 origin, lao_v3 direction, sdv_march m, sdv_near n) {
    if (n.cone < 0.0) {
        return m;
    }
    return sdv_march_note(m, minimum_add(sdv_minimum_start(n.cone), origin, direction, 0.0, SDV_FAR));
}

/* The least distance of a ray that hits nothing. */
sdv_march least(sdv_box b, lao_v3 origin, lao_v3 direction, sdv_march start) {
    sdv_march m = start;
    lao_v3 span = sdv_least_span(origin, direction, b, 0.0);
    float t = span.z;
    for (int i = 0; i < SDV_LEAST_SAMPLES; i++) {
        if (i > 0 && !(t <= span.y)) {
            break;
        }
        lao_v3 p = lao_v3_along(origin, direction, t);
        vec4 cell = cell_fetch(sdv_cell_at(b, p));
        sdv_near n = near_in(b, cell, p, direction);
        m = note(origin, direction, m, n);
        span = sdv_least_span(origin, direction, b, m.low);
        t = i == 0 ? span.x : t + sdv_least_step(n, cell.w > 0.0, cell.z, m.low, b.cell);
    }
    return m;
}

/* On to the surface from a point close to it. */
void land(sdv_box b, lao_v3 origin, lao_v3 direction, sdv_march m) {
    float t = m.t;
    float off = SDV_FAR;
    for (int i = 0; i <= SDV_POLISH_ROUNDS; i++) {
        lao_v3 p = lao_v3_along(origin, direction, t);
        sdv_near n = near_at(b, p, direction);
        if (lao_abs(n.distance) > off) {
            break;
        }
        off = lao_abs(n.distance);
        vec4 there = estimate_at(p, n.cone, n.distance);
        lao_v3 gradient = there.xyz;
        out_position = vec4(p, n.cone);
        out_normal.xyz = m.inside > 0.5 ? lao_v3_scale(gradient, -1.0) : gradient;
        out_ray.x = t;
        t = sdv_polish(t, there.w, gradient, direction, b.cell);
    }
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    out_position = vec4(0.0, 0.0, 0.0, -1.0);
    out_normal = vec4(0.0, 0.0, 0.0, SDV_FAR);
    out_ray = vec4(0.0);
    if (lao_constant_parameterization == 0 && sdv_is_hidden(pixel)) { /* else the void is filled from all */
        return;
    }
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    lao_v3 origin = lao_ray_origin(lao_frame.world, slope, lao_frame.depth.w);
    lao_v3 direction = lao_ray_direction(lao_frame.world, slope, lao_frame.depth.w);
    sdv_box b = sdv_box_fetch(box);
    bool nearest = lao_constant_near_miss != SDV_NEAR_MISS_NONE;
    sdv_box around = b;
    float reach = 0.0;
    if (lao_constant_near_miss == SDV_NEAR_MISS_CLOSE) {
        reach = sdv_frame_reach(float(lao_constant_supersampling));
        around = sdv_box_grown(b, reach);
    }
    sdv_march m = sdv_march_start(sdv_ray_box(origin, direction, around));
    for (int i = 0; i < SDV_MAX_STEPS; i++) {
        if (m.state != SDV_MARCH_GOES) {
            break;
        }
        lao_v3 p = lao_v3_along(origin, direction, m.t);
        vec4 cell = cell_fetch(sdv_cell_at(b, p));
        bool occupied = cell.w > 0.0;
        sdv_near n = sdv_near_start(0.0);
        if (occupied || (nearest && sdv_is_within(cell.z, reach))) {
            n = near_in(b, cell, p, direction);
        }
        if (nearest) {
            m = note(origin, direction, m, n);
            if (sdv_march_passed(m, n)) {
                m = minimum(b, origin, direction, m, m.cone, m.older, m.t);
            }
        }
        m = sdv_march_step(m, n, occupied, cell.z, b.cell);
    }
    if (nearest && m.state != SDV_MARCH_HITS) {
        if (!(reach > 0.0)) {
            m = least(b, origin, direction, m);
        }
        m.d_min = SDV_FAR;
        m = minimum(b, origin, direction, m, m.low_cone, 0.0, SDV_FAR);
    }
    out_normal.w = m.d_min;
    out_ray = vec4(0.0, m.t_min, m.steps, m.inside);
    if (m.state == SDV_MARCH_HITS) {
        land(b, origin, direction, m);
    }
}
#endif
