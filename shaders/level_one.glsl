/* Level 1: as level_up, of what samples read of level 0, so that no level 0 of the sums is needed. */
#define LAO_LEVEL_ONE
LAO_INCLUDE level_up.glsl
