/* The farthest depth around each tile of 8 x 8 pixels, by which segments that others hide are left out: variant 0 takes that of a
   tile from the depth buffer, variant 1 that of the tile and the next two each way. */
LAO_TEX(0, sampler2D, image)
LAO_CONSTANT(0, lao_constant_variant)

LAO_OUT(0, vec4, out_far)

#ifdef LAO_FRAGMENT
void main() {
    const int step = lao_constant_variant == 0 ? 8 : 1;
    const int size = lao_constant_variant == 0 ? 8 : 3;
    ivec2 last = ivec2(lao_step.source.xy) - 1;
    bool reversed = lao_frame.scale.z > 0.5;
    float far = reversed ? 1.0 : 0.0;
    for (int j = 0; j < size; j++) {
        for (int i = 0; i < size; i++) {
            float d = texelFetch(image, min(LAO_PIXEL * step + ivec2(i, j), last), 0).x;
            far = reversed ? min(far, d) : max(far, d);
        }
    }
    out_far = vec4(far);
}
#endif
