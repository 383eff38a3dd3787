/* Numbers beside what they name in a picture, none over another. */
#ifndef LINEAO_CLI_VESSEL_LABELS_H
#define LINEAO_CLI_VESSEL_LABELS_H

#include "text.h"

typedef struct cli_label {
    double anchor[2]; /* px: the place that it names */
    double half[2];   /* px: of its box */
    double wide;      /* px: what it names is; a higher box stands beside it, not on it */
    double at[2];     /* px: middle of the box, once it is placed */
    bool placed;
    bool kept;      /* it had a place in the picture before: */
    double from[2]; /* px: from the anchor to the middle of the box */
} cli_label;

/* Places one of the labels where its box and the line from there to the anchor meet no box, line or
 * end of a line of those that are placed: on the anchor or around it, the nearer the better, rather
 * not over other anchors, nor its line, nor where others were kept. Where it was in the picture
 * before, as seen from its anchor, it stays unless another place is better by a few lines of text.
 * False: there is no such place in a picture of that size. */
bool cli_label_place(cli_label *labels, uint32_t count, uint32_t index, const uint32_t size[2]);

/* Draws a placed label, the left upper corner of its picture at `corner`. False: out of memory. */
bool cli_label_draw(const cli_label *label, const char *text, const text_style *style,
                    const int64_t corner[2], picture *p);

#endif
