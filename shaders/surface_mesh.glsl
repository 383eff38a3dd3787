/* Faces of a surface. Variant 0: opaque back faces. 1: the nearest front faces, shaded by shape and flow (L14; METHODS
   9.3, 10.4). 2: the nearest of those behind the layer before, under what is composed so far. */
LAO_TEX(0, samplerBuffer, points)
LAO_TEX(1, samplerBuffer, normals)
LAO_TEX(2, samplerBuffer, triangles)
LAO_TEX(3, sampler2D, measures) /* 1, 2: of each vertex. Behind the buffers, which all variants read: see docs/algorithm.md */
LAO_TEX(4, sampler2D, nearnesses)
LAO_TEX(5, sampler2D, scene_z)
LAO_TEX(6, samplerBuffer, map)
LAO_TEX(7, sampler2D, layer_z)
LAO_TEX(8, sampler2D, left) /* 0: the layer before is empty */
LAO_TEX(9, sampler2D, composed)
LAO_CONSTANT(0, lao_constant_variant)
LAO_CONSTANT(1, lao_constant_shading)
LAO_CONSTANT(2, lao_constant_falloff_form)
LAO_CONSTANT(3, lao_constant_near_colors)
LAO_CONSTANT(4, lao_constant_blend)

LAO_VARYING(0, vec4, at_point)  /* world, mm; measure */
LAO_VARYING(1, vec4, at_normal) /* world; x of the look-up */

#ifdef LAO_VERTEX
void main() {
    int corner = int(LAO_VERTEX_INDEX);
    vec4 triangle = texelFetch(triangles, corner / 3);
    int k = corner % 3;
    int vertex = int(k == 0 ? triangle.x : (k == 1 ? triangle.y : triangle.z));
    at_point = vec4(texelFetch(points, vertex).xyz, 0.0);
    at_normal = vec4(texelFetch(normals, vertex).xyz, 0.0);
    if (lao_constant_variant != 0) {
        ivec2 item = ivec2(vertex % 2048, vertex / 2048);
        at_point.w = texelFetch(measures, item, 0).x;
        at_normal.w = texelFetch(nearnesses, item, 0).x;
    }
    lao_v4 clip = lao_project(lao_frame.projection, lao_transform(lao_frame.view, at_point.xyz));
    if (lao_constant_variant == 2 && texelFetch(left, ivec2(0), 0).x < 0.5) {
        clip = lao_v4_make(2.0, 2.0, 2.0, 1.0); /* outside */
    }
    lao_emit(clip);
}
#endif

LAO_OUT(0, vec4, out_color)
LAO_OUT(1, vec4, out_partner) /* 1: what the second layer begins with */
LAO_OUT(2, vec4, out_position)
LAO_OUT(3, vec4, out_normal)
LAO_OUT(4, vec4, out_lookup)

#ifdef LAO_FRAGMENT
/* x by the object's colour map. */
lao_v4 mapped(float x, float y) {
    lao_v2 place = vsf_map_place(x, float(textureSize(map)));
    int before = int(place.y);
    int behind = min(before + 1, textureSize(map) - 1);
    lao_v4 color = vsf_mix(texelFetch(map, before), texelFetch(map, behind), place.x);
    return vsf_mapped(color.xyz, x, y, lao_setting_near_opacity);
}

void main() {
    lao_v3 n = lao_v3_unit(at_normal.xyz, lao_v3_make(0.0, 0.0, 0.0));
    lao_v4 eye = vsf_eye(lao_frame.view, lao_frame.depth.w);
    lao_v3 v = lao_v3_unit(vsf_to_eye(eye, at_point.xyz, false), lao_v3_make(0.0, 0.0, 1.0));
    float facing = lao_v3_dot(n, v);
    lao_v3 base = lao_v3_make(lao_setting_wall_red, lao_setting_wall_green, lao_setting_wall_blue);
    lao_v3 wall = vsf_wall(base, facing, lao_setting_wall_ambient, lao_setting_wall_diffuse);
    out_position = vec4(at_point.xyz, 1.0);
    out_normal = vec4(n, at_point.w);
    out_lookup = vec4(0.0);
    if (lao_constant_variant == 0) {
        out_color = vec4(wall, 1.0);
        out_partner = vec4(0.0);
        return;
    }
    ivec2 pixel = LAO_PIXEL;
    float z = gl_FragCoord.z;
    if (!vsf_in_front(z, texelFetch(scene_z, pixel, 0).x, lao_frame.scale.z)) {
        discard;
    }
    if (lao_constant_variant == 2) {
        if (!vsf_in_front(texelFetch(layer_z, pixel, 0).x, z, lao_frame.scale.z)) {
            discard;
        }
    }
    float y = vsf_measure_y(at_point.w, lao_setting_brightness);
    lao_v4 lookup;
    if (lao_constant_near_colors == VSF_NEAR_MAP) {
        lookup = mapped(at_normal.w, y);
    } else {
        lookup = vsf_lookup(at_normal.w, y);
    }
    out_lookup = vec4(lookup.xyz, at_normal.w);
    lao_v4 color;
    if (lao_constant_shading == VSF_SHADING_ADAPTIVE) {
        color = lookup;
    } else if (lao_constant_shading == VSF_SHADING_TRANSPARENT) {
        color = vsf_premultiply(wall, lao_setting_opacity);
    } else if (lao_constant_falloff_form == VSF_FALLOFF_PAPER) {
        color = vsf_premultiply(wall, vsf_fresnel(facing, lao_setting_falloff));
    } else {
        color = vsf_premultiply(wall, vsf_fresnel_rim(facing, lao_setting_falloff));
    }
    if (lao_constant_variant == 2) {
        vec4 front = texelFetch(composed, pixel, 0);
        if (lao_constant_blend == VSF_BLEND_ADD) {
            color = vsf_add(front, color);
        } else {
            color = vsf_over(front, color);
        }
    }
    out_color = color;
    out_partner = color;
}
#endif
