/* What does not change from corner to corner, one texel per vertex: the suggestive-contour measure, which is vsf_measure by
   texel fetches (METHODS 10.3), and x of the look-up. */
LAO_TEX(0, samplerBuffer, points)
LAO_TEX(1, samplerBuffer, normals)
LAO_TEX(2, samplerBuffer, rings)
LAO_TEX(3, samplerBuffer, distances) /* two per vertex: at two steps */
LAO_TEX(4, samplerBuffer, values)
LAO_CONSTANT(0, lao_constant_near_source)
LAO_OUT(0, vec4, out_measure)
LAO_OUT(1, vec4, out_nearness)
#ifdef LAO_FRAGMENT
float nearness(int vertex) {
    if (lao_constant_near_source == VSF_NEAR_VALUE) {
        return vsf_value_x(texelFetch(values, vertex).x, lao_setting_value_low, lao_setting_value_high);
    }
    float distance = vsf_near_mix(texelFetch(distances, 2 * vertex).x, texelFetch(distances, 2 * vertex + 1).x,
                                  lao_setting_near_part);
    return vsf_near_x(distance, lao_setting_near_gamma);
}

void main() {
    int vertex = LAO_PIXEL.y * 2048 + LAO_PIXEL.x;
    out_measure = vec4(0.0);
    out_nearness = vec4(0.0);
    if (vertex >= textureSize(points)) {
        return;
    }
    lao_v4 eye = vsf_eye(lao_frame.view, lao_frame.depth.w);
    vec4 point = texelFetch(points, vertex);
    vec4 normal = texelFetch(normals, vertex);
    int start = int(vsf_ring_start(point.w, normal.w));
    int end = start + int(vsf_ring_count(normal.w));
    vsf_ring_sum ring = vsf_ring_begin(eye, point.xyz, normal.xyz, false);
    for (int i = start; i < end; i++) {
        vec4 entry = texelFetch(rings, i);
        int other = int(entry.w);
        ring = vsf_ring_add(ring, entry, vsf_light(eye, texelFetch(points, other).xyz, texelFetch(normals, other).xyz, false));
    }
    out_measure = vec4(vsf_ring_end(ring));
    out_nearness = vec4(nearness(vertex));
}
#endif
