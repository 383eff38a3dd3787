/* The line pass whose fragments know how far they are from the outline: uniform halos and fading trails. */
#define LAO_LINES_RIM
LAO_INCLUDE lines.glsl
