/* Level 1: as level_up, of what samples read of level 0, so that no level 0 of the sums is needed. */
LAO_TEX(0, usampler2D, level)
#define LAO_BELOW(column, row, inverse) lao_level_child(LAO_TEXEL(level, column, row, inverse).x, lao_constant_align)
LAO_INCLUDE level_sums.glsl
