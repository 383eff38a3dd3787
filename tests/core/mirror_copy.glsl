/* A second pass of the same module: reads what the first wrote, by a constant of the module's own settings. */
LAO_TEX(0, sampler2D, source)
LAO_CONSTANT(0, lao_constant_mirror_offset)
LAO_OUT(0, vec4, out_value)
#ifdef LAO_FRAGMENT
void main() {
    ivec2 pixel = LAO_PIXEL;
    float x = float((pixel.x + lao_constant_mirror_offset) % int(lao_step.source.x));
    out_value = LAO_TEXEL(source, x, float(pixel.y), 1.0 / lao_step.source.xy);
}
#endif
