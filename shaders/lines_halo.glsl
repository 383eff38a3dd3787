/* The line pass with depth-dependent halos (METHODS 3): the border lies behind the line. */
#define LAO_LINES_RIM
#define LAO_LINES_DEPTH
LAO_INCLUDE lines.glsl
