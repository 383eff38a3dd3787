/* The host's depth into our depth buffer: each of our samples takes the host's pixel that it lies in. */
LAO_TEX(0, sampler2D, host_depth)
#ifdef LAO_FRAGMENT
void main() {
    vec2 at = floor((vec2(LAO_PIXEL) + 0.5) * lao_frame.host_depth.xy / lao_step.size.xy);
    if (lao_frame.host_depth.z > 0.5) {
        at.y = lao_frame.host_depth.y - 1.0 - at.y;
    }
    gl_FragDepth = texelFetch(host_depth, ivec2(at), 0).x;
}
#endif
