/* Legends of colour maps, drawn into a picture. Text as in text.h.
 * Thread: as text.h. */
#ifndef LINEAO_LEGEND_H
#define LINEAO_LEGEND_H

#include "colour.h"
#include "picture.h"

typedef enum legend_side { LEGEND_LEFT, LEGEND_RIGHT, LEGEND_BOTTOM } legend_side;

typedef struct legend {
    const colour_map *map;
    double range[2];   /* values at both ends of the map */
    const char *title; /* "speed (m/s)"; NULL or "": none */
} legend;

/* Draws a bar of the map with ticks at round numbers and the title above it, centred at a side of
 * the picture: upright at the left and right with low values below, lying at the bottom with low
 * values to the left. Several legends stand side by side (above each other at the bottom). Sizes
 * follow the smaller side of the picture; ink is dark or light as the picture below asks for, with
 * an outline of the other. In a small picture they stand in line along their side, with shorter
 * bars and smaller text; where even so they would take more than 3/5 of it, the last ones are left
 * out. False: out of memory. */
bool legend_draw(picture *p, legend_side side, const legend *legends, uint32_t count);

/* How many of them legend_draw draws in a picture of this size. */
uint32_t legend_room(uint32_t width, uint32_t height, legend_side side, const legend *legends,
                     uint32_t count);

#endif
