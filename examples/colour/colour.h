/* Colours of values: perceptually uniform colour maps, ranges, ticks, colours of directions.
 *
 * Colours are red, green, blue as displayed (sRGB, not linear light), each in [0, 1]. Lightness and
 * differences are those of Oklab (Ottosson 2020), in which a difference of about 0.02 is just seen.
 * Thread: all functions are free of shared state. */
#ifndef LINEAO_COLOUR_H
#define LINEAO_COLOUR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- spaces ----------------------------------------------------------------------------- */

/* Lightness in [0, 1], green to red, blue to yellow. */
typedef struct colour_lab {
    double l, a, b;
} colour_lab;

colour_lab colour_lab_from_rgb(const double rgb[3]);
/* May leave [0, 1] for colours that no display shows. */
void colour_rgb_from_lab(colour_lab lab, double rgb[3]);
/* Distance of two colours. */
double colour_difference(colour_lab x, colour_lab y);
/* The same colours in CIELAB (D65; lightness in [0, 100]) and their CIE76 difference there. */
colour_lab colour_cielab_from_rgb(const double rgb[3]);
/* [0, 1] as a byte; what is outside is clamped. */
uint8_t colour_byte(double value);

/* ---- maps ------------------------------------------------------------------------------- */

typedef enum colour_kind {
    COLOUR_SEQUENTIAL,  /* lightness rises evenly from the first to the last */
    COLOUR_DIVERGING,   /* lightness rises to a neutral middle and falls again, evenly */
    COLOUR_CYCLIC,      /* of even lightness; the last is the first */
    COLOUR_ISOLUMINANT, /* of even lightness: the value is in the hue alone */
} colour_kind;

enum { COLOUR_STEPS = 257 /* odd: there is a middle */ };

/* Colours at even distances, each as far from the next as every other (in Oklab). */
typedef struct colour_map {
    const char *name; /* static */
    colour_kind kind;
    double rgb[COLOUR_STEPS][3];
    colour_lab lab[COLOUR_STEPS];
} colour_map;

/* The names that colour_map_make knows, the default first, with '|' between them. */
#define COLOUR_MAPS "viridis|inferno|heat|coolwarm|phase|isoluminant|gray"

/* Makes the map: a smooth curve through a few anchors in Oklab, cut into even steps. False: unknown
 * name, *out is then untouched. */
bool colour_map_make(const char *name, colour_map *out);

/* The colour at `at` in [0, 1], interpolated; outside: the nearest end; NaN: colour_missing. */
void colour_map_at(const colour_map *map, double at, double rgb[3]);

/* Where in [0, 1] the map comes nearest to a colour; *distance (may be NULL) is how near. */
double colour_map_find(const colour_map *map, const double rgb[3], double *distance);

/* The neutral grey of values that are not known. */
void colour_missing(double rgb[3]);

/* ---- ranges ----------------------------------------------------------------------------- */

/* One end of a range: a value, or a percentile in [0, 100] of the finite values. */
typedef struct colour_end {
    double value;
    bool percent;
} colour_end;

/* Both ends in values. Numbers that are NaN or infinite do not count. When both ends come out equal
 * (or there is no number at all) the range is 2 wide around the value. `low` above `high` is
 * allowed and turns the map around. Reorders `values`. */
void colour_range(double *values, size_t count, const colour_end ends[2], double range[2]);

/* The value below which `percent` of the finite values lie, interpolated between neighbours; NaN
 * when there is none. Reorders `values`. */
double colour_percentile(double *values, size_t count, double percent);

/* Numbers to write beside a map. */
enum { COLOUR_TICKS = 12 };
typedef struct colour_ticks {
    uint32_t count;          /* at most COLOUR_TICKS */
    uint32_t decimals;       /* digits behind the point that tell neighbours apart */
    double at[COLOUR_TICKS]; /* rising multiples of 1, 2 or 5 times a power of ten */
} colour_ticks;

/* At most `most` ticks within [a, b] in any order; none when a = b or an end is not finite. */
colour_ticks colour_ticks_make(double a, double b, uint32_t most);
/* A tick as text: "0.25", "-3", "1.5e+06". */
void colour_tick_text(const colour_ticks *ticks, uint32_t index, char *text, size_t size);

/* ---- directions and lines --------------------------------------------------------------- */

/* Tractography's convention, red along x, green along y, blue along z, a little paler than pure:
 * full blue is so dark that shading drowns in it. No direction: colour_missing. */
void colour_direction(double x, double y, double z, double rgb[3]);

/* One of many hues of even lightness; neighbouring numbers differ most. */
void colour_of_line(uint32_t line, double rgb[3]);

#endif
