/* Depth of the nearest front faces of a set among those of all sets. */
LAO_TEX(0, sampler2D, layer_z)
#ifdef LAO_FRAGMENT
void main() { gl_FragDepth = texelFetch(layer_z, LAO_PIXEL, 0).x; }
#endif
