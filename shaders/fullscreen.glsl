/* The triangle that covers the viewport at the far plane, for every pass without a vertex stage of its own. */
#ifdef LAO_VERTEX
void main() {
    float x = LAO_VERTEX_INDEX == 1u ? 3.0 : -1.0;
    float y = LAO_VERTEX_INDEX == 2u ? 3.0 : -1.0;
    lao_emit(vec4(x, y, lao_frame.scale.z > 0.5 ? 0.0 : 1.0, 1.0));
}
#endif
