/* One texel per vertex: walks its ring in the texel buffers. Behind the shared text and surface_mirror.h. */
LAO_TEX(0, samplerBuffer, points)
LAO_TEX(1, samplerBuffer, normals)
LAO_TEX(2, samplerBuffer, rings)
LAO_OUT(0, vec4, out_measure)
LAO_OUT(1, vec4, out_look)
LAO_OUT(2, vec4, out_blur)
LAO_OUT(3, vec4, out_shade)
#ifdef LAO_FRAGMENT
void main() {
    int vertex = LAO_PIXEL.y * 2048 + LAO_PIXEL.x;
    out_measure = out_look = out_blur = out_shade = vec4(0.0);
    if (vertex >= textureSize(points)) {
        return;
    }
    lao_v4 eye = vsf_eye(lao_frame.view, lao_frame.depth.w);
    vec4 point = texelFetch(points, vertex);
    vec4 normal = texelFetch(normals, vertex);
    int start = int(vsf_ring_start(point.w, normal.w));
    int end = start + int(vsf_ring_count(normal.w));
    vsf_ring_sum ring = vsf_ring_begin(eye, point.xyz, normal.xyz, false);
    for (int i = start; i < end; i = i + 1) {
        vec4 entry = texelFetch(rings, i);
        int other = int(entry.w);
        float light = vsf_light(eye, texelFetch(points, other).xyz, texelFetch(normals, other).xyz, false);
        ring = vsf_ring_add(ring, entry, light);
    }
    float s = vsf_ring_end(ring);
    out_measure = surface_mirror(0u, s, eye, point.xyz, normal.xyz);
    out_look = surface_mirror(1u, s, eye, point.xyz, normal.xyz);
    out_blur = surface_mirror(2u, s, eye, point.xyz, normal.xyz);
    out_shade = surface_mirror(3u, s, eye, point.xyz, normal.xyz);
}
#endif
