/* A mesh in place of what a tree's rays hit: position, normal, colour and own direction of its nearest face. */
LAO_TEX(0, samplerBuffer, vertices)  /* three of each: place, normal, direction of u and how sure it is */
LAO_TEX(1, samplerBuffer, triangles) /* numbers of its vertices */
LAO_TEX(2, samplerBuffer, colors)

LAO_VARYING(0, vec4, at_point)
LAO_VARYING(1, vec4, at_normal)
LAO_VARYING(2, vec4, at_color)
LAO_VARYING(3, vec4, at_direction)

#ifdef LAO_VERTEX
int vertex_of(int triangle, int k) {
    vec4 t = texelFetch(triangles, triangle);
    return int(k == 0 ? t.x : (k == 1 ? t.y : t.z));
}
void main() {
    int corner = int(LAO_VERTEX_INDEX);
    int vertex = vertex_of(corner / 3, corner % 3);
    lao_v3 p = texelFetch(vertices, 3 * vertex).xyz;
    vec4 own = texelFetch(vertices, 3 * vertex + 2);
    lao_v3 z = own.xyz;
    /* directions have no sign: all of a triangle that of its first vertex */
    lao_v3 first = texelFetch(vertices, 3 * vertex_of(corner / 3, 0) + 2).xyz;
    if (lao_v3_dot(z, first) < 0.0) {
        z = lao_v3_scale(z, -1.0);
    }
    at_point = vec4(p, 1.0);
    at_normal = vec4(texelFetch(vertices, 3 * vertex + 1).xyz, 0.0);
    at_color = texelFetch(colors, vertex);
    at_direction = vec4(z, own.w);
    lao_emit(lao_project(lao_frame.projection, lao_transform(lao_frame.view, p)));
}
#endif

LAO_OUT(0, vec4, out_position)  /* world, mm; 0: covered */
LAO_OUT(1, vec4, out_normal)    /* world, towards the viewer; no near miss */
LAO_OUT(2, vec4, out_color)
LAO_OUT(3, vec4, out_direction) /* world, unit; how sure */

#ifdef LAO_FRAGMENT
void main() {
    lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(LAO_PIXEL.x) + 0.5, float(LAO_PIXEL.y) + 0.5);
    lao_v3 direction = lao_ray_direction(lao_frame.world, slope, lao_frame.depth.w);
    lao_v3 n = lao_v3_unit(at_normal.xyz, lao_v3_scale(direction, -1.0));
    if (lao_v3_dot(n, direction) > 0.0) {
        n = lao_v3_scale(n, -1.0);
    }
    out_position = vec4(at_point.xyz, 0.0);
    out_normal = vec4(n, SDV_FAR);
    out_color = at_color;
    out_direction = vec4(lao_v3_unit(at_direction.xyz, lao_v3_make(0.0, 0.0, 0.0)), at_direction.w);
}
#endif
