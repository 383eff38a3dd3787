/* The nearest sample of each pixel into the host's depth; the depth test leaves what is nearer. */
LAO_TEX(0, sampler2D, zbuffer)
LAO_CONSTANT(0, lao_constant_supersampling)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    if (lao_frame.host_depth.z > 0.5) {
        pixel.y = int(lao_frame.host_depth.y) - 1 - pixel.y;
    }
    bool reversed = lao_frame.scale.z > 0.5;
    float nearest = reversed ? 0.0 : 1.0;
    for (int j = 0; j < lao_constant_supersampling; j++) {
        for (int i = 0; i < lao_constant_supersampling; i++) {
            float d = texelFetch(zbuffer, pixel * lao_constant_supersampling + ivec2(i, j), 0).x;
            nearest = reversed ? max(nearest, d) : min(nearest, d);
        }
    }
    gl_FragDepth = nearest;
}
#endif
