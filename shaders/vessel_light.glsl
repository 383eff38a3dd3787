/* Light at a place of a vessel, and whether it is marked: for shaders that include vessel_field.glsl, read box, shapes,
   fields and colors and have the constants variant (1: with shapes; 2: not a tree), field_occlusion and field_shadow. */
/* What is known of the tree's distance at p, with shapes. */
float combined(float d, lao_v3 p, bool bound) {
    if (lao_constant_variant == 1) {
        return sdv_solid_add_all(shapes, fields, sdv_solid_start(d), p, bound).distance;
    }
    return d;
}
/* Signed distance at p, from the list of its cell. */
float field_at(sdv_box b, lao_v3 p) {
    sdv_near near = near_at(b, p, lao_v3_make(0.0, 0.0, 1.0));
    float d = near.distance;
    if (lao_constant_has_vessel_forms != 0) {
        d = estimate_at(p, near.cone, d).w;
    }
    return combined(d, p, false);
}

/* How far it is from the wall of a cone at p to the middle. */
float room_at(lao_v3 p, float cone) {
    int at = 2 * int(cone);
    vec4 a = texelFetch(cones, at);
    vec4 b = texelFetch(cones, at + 1);
    float room = sdv_cone_ball_radius(sdv_cone_point_make(p, a, b), a, b);
    if (lao_constant_has_vessel_forms != 0) {
        LAO_EXACT float narrow = room * sdv_form_ratio(form_at(cone));
        return narrow;
    }
    return room;
}
/* Openness of p along its normal: sdv_openness; from within a vessel the room inside counts. */
float openness(sdv_box b, lao_v3 p, lao_v3 n, bool inside) {
    float reach = 0.01 * lao_setting_occlusion_reach * lao_frame.depth.z;
    if (inside) {
        sdv_near near = near_at(b, p, lao_v3_make(0.0, 0.0, 1.0));
        reach = sdv_open_reach(reach, room_at(p, near.cone), near.distance, b.cell);
    }
    float closed = 0.0;
    for (int i = 0; i < SDV_OPEN_SAMPLES; i++) {
        float place = sdv_open_place(reach, i);
        float d = field_at(b, lao_v3_along(p, n, place));
        closed = sdv_open_add(closed, inside ? -d : d, place, i);
    }
    return sdv_open_result(closed);
}

/* Normal for shading: sdv_smooth_normal. */
lao_v3 smooth_normal(sdv_box b, lao_v3 p, float cone, lao_v3 n) {
    int own = 2 * int(cone);
    lao_v2 reach = sdv_joint_reach(p, texelFetch(cones, own), texelFetch(cones, own + 1), lao_setting_joint_smoothness, b.cell);
    vec4 cell = cell_fetch(sdv_cell_at(b, p));
    int count = int(cell.w);
    if (!(reach.x > 0.0)) {
        return n;
    }
    lao_v3 sum = sdv_joint_start(estimate_at(p, cone, 0.0).xyz, texelFetch(cones, own), texelFetch(cones, own + 1), reach);
    for (int i = 0; i < count; i++) {
        float id = id_fetch(int(cell.z) + i);
        int at = 2 * int(id);
        vec4 a = texelFetch(cones, at);
        vec4 b = texelFetch(cones, at + 1);
        float round = lao_constant_has_vessel_forms != 0 ? 0.0 : sdv_round_cone(p, a, b);
        if (round < reach.x) {
            vec4 there = estimate_at(p, id, round);
            if (there.w < reach.x) {
                sum = sdv_joint_add(sum, there.w, there.xyz, a, b, reach);
            }
        }
    }
    return sdv_joint_normal(sum, n);
}
/* Light that reaches p past the vessels: sdv_shadow. */
float lit_at(sdv_box b, lao_v3 p) {
    lao_v3 light = sdv_shadow_light(lao_frame.world, lao_setting_shadow_light_x, lao_setting_shadow_light_y);
    lao_v2 span = sdv_ray_box(p, light, b);
    if (lao_constant_variant == 1) {
        span = sdv_solid_span(span, texelFetch(shapes, 0).y > 0.5);
    }
    float least = sdv_hit_distance(b.cell);
    float lit = 1.0;
    LAO_EXACT float t = lao_max(sdv_shadow_bias(b.cell), span.x);
    LAO_EXACT float hardness = 1.0 / lao_setting_field_shadow_softness;
    for (int i = 0; i < SDV_MAX_STEPS; i++) {
        if (!(t <= span.y) || !(lit > 0.0)) {
            break;
        }
        lao_v3 q = lao_v3_along(p, light, t);
        vec4 cell = cell_fetch(sdv_cell_at(b, q));
        float tree = tree_distance_in(b, cell, q);
        float d = combined(tree, q, false);
        lit = d < least ? 0.0 : sdv_shadow_add(lit, d, t, hardness);
        float bound = combined(sdv_tree_bound(tree, cell.w > 0.0, cell.z, sdv_box_distance(q, b), b.cell), q, true);
        t = t + lao_max(bound, least);
    }
    return lit;
}
/* Is the place p at the cone marked? */
bool is_marked(float cone, lao_v3 p) {
    int at = 2 * int(cone);
    return sdv_is_marked(p, texelFetch(cones, at), texelFetch(cones, at + 1), texelFetch(colors, at).w,
                         texelFetch(colors, at + 1).w);
}
/* From within a shape or a vessel? ray: of the traced pixel (with shapes 2 * shape, + 1 inside). */
bool is_inside(vec4 ray) {
    if (lao_constant_variant == 1) {
        return ray.w - 2.0 * lao_floor(0.5 * ray.w) > 0.5;
    }
    return ray.w > 0.5;
}
/* Light that the field leaves at p, with the normal for shading. */
float field_light(lao_v3 p, lao_v3 n, vec4 ray) {
    LAO_EXACT float light = 1.0;
    if (lao_constant_field_occlusion != 0 && lao_constant_variant != 2) {
        light = sdv_dimmed(light, 1.0 - openness(sdv_box_fetch(box), p, n, is_inside(ray)), lao_setting_occlusion_strength);
    }
    if (lao_constant_field_shadow != 0 && lao_constant_variant != 2) {
        light = sdv_dimmed(light, 1.0 - lit_at(sdv_box_fetch(box), p), lao_setting_field_shadow_strength);
    }
    return light;
}
/* Normal for shading of a traced pixel. */
lao_v3 facing_at(vec4 hit, lao_v3 n) {
    if (hit.w >= 0.0 && lao_constant_variant != 2) {
        return smooth_normal(sdv_box_fetch(box), hit.xyz, hit.w, n);
    }
    return n;
}
