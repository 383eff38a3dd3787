/* Text in pictures: through Cairo where it was found, else with built-in letters of 5 x 7 dots.
 *
 * Text is one line of UTF-8; sizes are the height of a line in pixels. Built-in letters grow in
 * whole steps and know no accents: what they do not know is a blank.
 * Thread: functions are free of shared state of ours; Cairo and fontconfig lock theirs. */
#ifndef LINEAO_TEXT_H
#define LINEAO_TEXT_H

#include "picture.h"

typedef enum text_anchor { TEXT_LEFT, TEXT_CENTER, TEXT_RIGHT } text_anchor;

/* How text looks. */
typedef struct text_style {
    double size;          /* height of a line, pixels */
    double ink[3];        /* colour of the letters */
    double outline[3];    /* colour around them */
    double outline_width; /* pixels; 0: none */
    bool bold;
} text_style;

/* Width of a line in pixels, rounded up. */
uint32_t text_width(const char *text, const text_style *style);

/* Draws a line of text whose box of height style->size begins at y and which stands left of, around
 * or right of x. What lies outside the picture is cut off. False: out of memory. */
bool text_draw(picture *p, int64_t x, int64_t y, text_anchor anchor, const char *text,
               const text_style *style);

/* Bytes of the part of `text` that fits into `width` pixels, cut between words where there are any;
 * at least one character. Blanks in front of the rest belong to no line. */
uint32_t text_fit(const char *text, uint32_t width, const text_style *style);

/* ---- for text.c: what draws letters ----------------------------------------------------- */

/* Opacities of a line of text: `width` x `height` bytes each, the box begins at (margin, margin).
 */
typedef struct text_mask {
    uint32_t width, height, margin;
    uint8_t *letters, *outline; /* owned */
} text_mask;

/* False: out of memory. */
bool text_mask_make(const char *text, const text_style *style, text_mask *out);

#endif
