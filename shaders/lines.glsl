/* Lines as view-aligned quads into the G-buffer (METHODS 1.1, 2.8): four vertices a segment, pulled from the points. */
LAO_TEX(0, samplerBuffer, points)
LAO_TEX(1, samplerBuffer, colors)

LAO_VARYING(0, vec4, tangent_zoom)
LAO_VARYING(1, vec4, color_depth) /* red, green, blue; view depth (mm) */

#ifdef LAO_VERTEX
lao_v3 view_direction(lao_v3 p) { return lao_frame.depth.w > 0.5 ? lao_v3_make(0.0, 0.0, -1.0) : p; }

void main() {
    int segment = int(LAO_VERTEX_INDEX >> 2u);
    bool at_end = (LAO_VERTEX_INDEX & 2u) != 0u;
    float side = (LAO_VERTEX_INDEX & 1u) != 0u ? 1.0 : -1.0;
    vec4 start = texelFetch(points, segment + 1);
    vec4 end = texelFetch(points, segment + 2);
    tangent_zoom = vec4(0.0);
    color_depth = vec4(0.0);
    if (start.w >= LAO_GHOST_TIME || end.w >= LAO_GHOST_TIME) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0); /* between two lines: outside, so that the quad is culled here */
        return;
    }
    lao_v3 p1 = lao_transform(lao_frame.view, start.xyz);
    lao_v3 p2 = lao_transform(lao_frame.view, end.xyz);
    lao_v3 beyond = lao_transform(lao_frame.view, texelFetch(points, at_end ? segment + 3 : segment).xyz);
    lao_v3 p = at_end ? p2 : p1;
    lao_v3 other = at_end ? lao_v3_sub(beyond, p2) : lao_v3_sub(p1, beyond);
    float half_width = 0.5 * lao_setting_width;
    lao_line_end join =
        lao_line_join(view_direction(p), lao_v3_sub(p2, p1), other, half_width, at_end ? 1.0 : -1.0);
    lao_v3 corner = lao_v3_add(lao_v3_along(p, join.across, side), join.along);
    tangent_zoom = vec4(join.tangent, lao_zoom(lao_frame.projection, lao_frame.viewport, p, join.normal));
    color_depth = vec4(texelFetch(colors, at_end ? segment + 2 : segment + 1).xyz, -corner.z);
    lao_emit(lao_project(lao_frame.projection, corner));
}
#endif

LAO_OUT(0, vec4, out_color)
LAO_OUT(1, vec4, out_tangent)
LAO_OUT(2, vec4, out_depth)

#ifdef LAO_FRAGMENT
void main() {
    out_color = vec4(color_depth.xyz, 1.0);
    out_tangent = vec4(lao_v3_unit(tangent_zoom.xyz, lao_v3_make(1.0, 0.0, 0.0)), tangent_zoom.w);
    out_depth = vec4(lao_scene_depth(lao_frame.depth, color_depth.w));
}
#endif
