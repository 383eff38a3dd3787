/* The farthest depth around each tile of 4 x 4 pixels, by which segments that others hide are left out: variant 0 takes that of a
   tile from the depth buffer, variant 1 that of the tile and the next three each way. */
LAO_TEX(0, sampler2D, image)
LAO_CONSTANT(0, lao_constant_variant)

LAO_OUT(0, vec4, out_far)

#ifdef LAO_FRAGMENT
void main() {
    const int step = lao_constant_variant == 0 ? 4 : 1;
    ivec2 last = ivec2(lao_step.source.xy) - 1;
    bool reversed = lao_frame.scale.z > 0.5;
    float far = reversed ? 1.0 : 0.0;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 4; i++) {
            float d = texelFetch(image, min(LAO_PIXEL * step + ivec2(i, j), last), 0).x;
            far = reversed ? min(far, d) : max(far, d);
        }
    }
    out_far = vec4(far);
}
#endif
