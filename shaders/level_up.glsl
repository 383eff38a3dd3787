/* One coarser level: averages of the covered texels below, weighted by how much of level 0 each covers (METHODS 1.10). */
LAO_TEX(0, sampler2D, tensor)
#define LAO_BELOW(column, row, inverse) LAO_TEXEL(tensor, column, row, inverse)
LAO_INCLUDE level_sums.glsl
