/* Vessels over the scene where they are nearer: light, occlusion from the field, contours and depth shadows of near
   misses (L19 5, Fig. 8; METHODS 5.4), and a silhouette where a ray just missed. */
LAO_TEX(0, sampler2D, position)
LAO_TEX(1, sampler2D, normal)
LAO_TEX(2, sampler2D, ray)
LAO_TEX(3, samplerBuffer, colors) /* two of each cone: at its parent and at its child */
LAO_TEX(4, samplerBuffer, box)
LAO_TEX(5, samplerBuffer, cells)
LAO_TEX(6, samplerBuffer, ids)
LAO_TEX(7, samplerBuffer, cones)
LAO_TEX(8, samplerBuffer, shapes) /* with variant 1 */
LAO_TEX(9, samplerBuffer, fields)
LAO_TEX(10, sampler2D, surface)
LAO_TEX(11, sampler2D, bgnormal)
LAO_TEX(12, sampler2D, ink)
LAO_TEX(13, sampler2D, seen_color) /* with variant 2 */
LAO_TEX(14, sampler2D, grid)
LAO_TEX(15, sampler2D, lists)
LAO_CONSTANT(0, lao_constant_near_miss)
LAO_CONSTANT(1, lao_constant_surface_shininess)
LAO_CONSTANT(2, lao_constant_field_occlusion)
LAO_CONSTANT(3, lao_constant_parameterization)
LAO_CONSTANT(4, lao_constant_style)
LAO_CONSTANT(5, lao_constant_void_style)
LAO_CONSTANT(6, lao_constant_variant) /* 1: with shapes; 2: not a tree */
LAO_CONSTANT(7, lao_constant_supersampling)
LAO_CONSTANT(8, lao_constant_field_shadow)
LAO_CONSTANT(9, lao_constant_has_vessel_cells)
LAO_CONSTANT(10, lao_constant_has_vessel_forms)

LAO_OUT(0, vec4, out_color)

#ifdef LAO_FRAGMENT
LAO_INCLUDE vessel_field.glsl
LAO_INCLUDE vessel_light.glsl
/* White that ink leaves of the pixel. */
float white_at(ivec2 pixel) {
    return lao_constant_parameterization > 1 ? texelFetch(ink, pixel, 0).x : 1.0;
}
/* The void: depth as colour with lines, or ink. */
vec4 void_color(ivec2 pixel, lao_v3 direction) {
    lao_v3 p = texelFetch(surface, pixel, 0).xyz;
    lao_v3 n = texelFetch(bgnormal, pixel, 0).xyz;
    float white = white_at(pixel);
    if (lao_constant_void_style == SDV_VOID_CHROMADEPTH) {
        float facing = -lao_v3_dot(n, direction);
        LAO_EXACT float depth = (sdv_depth_of(lao_frame.view, p) - lao_frame.depth.x) * lao_frame.depth.y;
        LAO_EXACT float light = 0.7 + 0.3 * lao_max(facing, 0.0);
        if (lao_setting_isolines > 0.5) {
            lao_v3 back = sdv_camera_unit(lao_frame.world.z.xyz);
            LAO_EXACT float gap = 1.0 / (lao_setting_isolines * lao_frame.depth.y);
            LAO_EXACT float wide = sdv_footprint_at(back, n, p, direction, gap);
            LAO_EXACT float place = depth * lao_setting_isolines;
            LAO_EXACT float line = sdv_lines_ink(place, lao_min(1.5 * wide, 0.5), wide);
            light = sdv_dimmed(light, line, 0.7);
        }
        return vec4(lao_v3_scale(sdv_chromadepth(depth), light * white), 1.0);
    }
    return vec4(white, white, white, 1.0);
}
bool has_void() {
    return lao_constant_void_style != SDV_VOID_PLAIN &&
           lao_constant_parameterization > (lao_constant_void_style == SDV_VOID_CHROMADEPTH ? 0 : 1);
}

/* The vessel nearest to p, exactly, from the hierarchy behind the shapes; `n`: one that is near. */
float nearest_cone(lao_v3 p, sdv_near near) {
    sdv_near n = near;
    vec4 head = texelFetch(shapes, 0);
    int first = int(head.z);
    int leaves = int(head.w);
    int node = leaves > 0 ? 1 : 0;
    for (int i = 0; i < 1 << 24; i++) {
        if (node == 0) {
            break;
        }
        if (!sdv_ball_reaches(p, texelFetch(shapes, first + node), n.distance)) {
            node = sdv_ball_next(node);
        } else if (node < leaves) {
            node = 2 * node;
        } else {
            vec4 ids = texelFetch(shapes, first + leaves + node);
            for (int k = 0; k < SDV_LEAF_CONES; k++) {
                float id = k == 0 ? ids.x : (k == 1 ? ids.y : (k == 2 ? ids.z : ids.w));
                if (id >= 0.0) {
                    int at = 2 * int(id);
                    n = sdv_nearer(n, sdv_round_cone(p, texelFetch(cones, at), texelFetch(cones, at + 1)), id);
                }
            }
            node = sdv_ball_next(node);
        }
    }
    return n.cone;
}
/* Position of the surface beside an empty pixel, within a pixel of the picture. */
vec4 neighbour(ivec2 pixel) {
    vec4 found = vec4(0.0, 0.0, 0.0, -1.0);
    ivec2 size = ivec2(lao_step.size.xy);
    for (int i = 0; i < 4; i++) {
        int side = (2 * (i & 1) - 1) * lao_constant_supersampling;
        ivec2 q = pixel + (i < 2 ? ivec2(side, 0) : ivec2(0, side));
        if (q.x >= 0 && q.y >= 0 && q.x < size.x && q.y < size.y) {
            vec4 p = texelFetch(position, q, 0);
            if (sdv_is_covered(p.w)) {
                found = p;
            }
        }
    }
    return found;
}

void main() {
    ivec2 pixel = LAO_PIXEL;
    if (sdv_is_hidden(pixel)) {
        discard;
    }
    if (sdv_lens_rings(lao_setting_lens_side,
                       sdv_lens_at(pixel, lao_setting_lens_rim * float(lao_constant_supersampling)))) {
        gl_FragDepth = lao_frame.scale.z; /* before all */
        out_color = vec4(vec3(0.2), 1.0);
        return;
    }
    vec4 hit = texelFetch(position, pixel, 0);
    vec4 n = texelFetch(normal, pixel, 0);
    vec4 r = texelFetch(ray, pixel, 0);
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
    lao_v3 origin = lao_ray_origin(lao_frame.world, slope, lao_frame.depth.w);
    lao_v3 direction = lao_ray_direction(lao_frame.world, slope, lao_frame.depth.w);
    bool missed = hit.w == -1.0;
    lao_v3 near_miss = lao_transform(lao_frame.view, lao_v3_along(origin, direction, r.y));
    float zoom = sdv_zoom(lao_frame.scale, lao_frame.depth, -near_miss.z, float(lao_constant_supersampling));
    bool outlined = false;
    if (lao_constant_variant == 2) {
        if (missed && lao_setting_silhouette > 0.0) {
            hit = neighbour(pixel);
            outlined = sdv_is_covered(hit.w);
        }
    } else if (lao_constant_near_miss != SDV_NEAR_MISS_NONE) {
        if (missed) {
            outlined =
                sdv_is_silhouette(false, n.w, sdv_outline_width(lao_setting_silhouette, lao_setting_outline_unit, zoom));
        } else {
            outlined = sdv_is_contour(n.w, sdv_outline_width(lao_setting_contour, lao_setting_outline_unit, zoom));
        }
    }
    if (missed && !outlined) {
        LAO_EXACT float mark = 1.0 - white_at(pixel);
        if (!has_void() && !(mark > 0.0)) {
            discard;
        }
        gl_FragDepth = lao_frame.scale.z > 0.5 ? 1.0e-7 : 0.9999999; /* before nothing but the empty depth buffer */
        out_color = vec4(0.0, 0.0, 0.0, mark);
        if (has_void()) {
            out_color = void_color(pixel, direction);
        }
        return;
    }
    lao_v3 p = outlined && lao_constant_variant != 2 ? lao_v3_along(origin, direction, r.y) : hit.xyz;
    lao_v4 clip = lao_project(lao_frame.projection, lao_transform(lao_frame.view, p));
    gl_FragDepth = clip.z / clip.w;
    if (outlined) {
        out_color = vec4(0.0, 0.0, 0.0, 1.0);
        return;
    }
    float cone = hit.w;
    lao_v3 color;
    if (lao_constant_variant == 1 && hit.w < 0.0) { /* r.w: 2 * shape, + 1 inside */
        vec4 own = texelFetch(shapes, 4 + 4 * int(0.5 * r.w));
        color = own.xyz;
        if (own.w < 0.5) { /* that of the nearest vessel */
            sdv_box b = sdv_box_fetch(box);
            cone = nearest_cone(p, near_at(b, p, direction));
        }
    }
    if (lao_constant_variant == 2) {
        color = texelFetch(seen_color, pixel, 0).xyz;
    } else if (cone >= 0.0) {
        int at = 2 * int(cone);
        color = sdv_cone_color(p, texelFetch(cones, at), texelFetch(cones, at + 1), texelFetch(colors, at).xyz,
                               texelFetch(colors, at + 1).xyz);
    }
    float white = white_at(pixel);
    bool inked = lao_constant_parameterization > 1 && lao_constant_style != SDV_STYLE_PLAIN;
    if (inked && lao_constant_style != SDV_STYLE_SHADOW) {
        out_color = vec4(lao_v3_scale(color, white), 1.0);
        return;
    }
    lao_v3 facing = facing_at(hit, n.xyz);
    float light = field_light(p, facing, r);
    if (lao_constant_near_miss != SDV_NEAR_MISS_NONE && lao_constant_variant != 2 && !inked) {
        light = sdv_dimmed(light, sdv_depth_shadow_at(n, r), lao_setting_shadow_strength);
    }
    lao_v3 towards = lao_v3_scale(direction, -1.0);
    lao_v2 parts = sdv_light_parts(lao_setting_surface_ambient, lao_setting_surface_diffuse,
                                   lao_constant_variant != 2 && is_inside(r));
    lao_v3 shade = sdv_shade(color, facing, towards, parts.x, parts.y, lao_setting_surface_specular,
                             lao_constant_surface_shininess, light);
    out_color = vec4(lao_v3_scale(shade, white), 1.0);
}
#endif
