/* The suggestive-contour measure, one texel per vertex: vsf_measure by texel fetches (METHODS 10.3). */
LAO_TEX(0, samplerBuffer, points)
LAO_TEX(1, samplerBuffer, normals)
LAO_TEX(2, samplerBuffer, rings)
LAO_OUT(0, vec4, out_measure)
#ifdef LAO_FRAGMENT
void main() {
    int vertex = LAO_PIXEL.y * 2048 + LAO_PIXEL.x;
    out_measure = vec4(0.0);
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
}
#endif
