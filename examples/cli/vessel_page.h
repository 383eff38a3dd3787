/* The page of lineao vessel --link: trees and their layouts in one picture. */
#ifndef LINEAO_CLI_VESSEL_PAGE_H
#define LINEAO_CLI_VESSEL_PAGE_H

#include "vessel_marks.h"

typedef struct cli_page {
    const cli_options *options;   /* of the whole picture */
    uint32_t columns;             /* trees; one: it stands beside its layout, not above */
    uint32_t panel[2];            /* px: of a tree's picture and of a layout's */
    uint32_t gap, head, left;     /* px: between panels; above them; at their left */
    const char *side;             /* of the scale; NULL: there is none */
    cli_marks marks[CLI_TARGETS]; /* owned; numbers of the last picture, per column */
} cli_page;

/* Divides a picture of the options' size; scaled: colours have a scale. False: reported, nothing to
 * free. */
bool cli_page_make(const cli_options *options, bool scaled, cli_page *out);
void cli_page_free(cli_page *page);

/* Finds where the numbers of the branches at risk go in what the sessions (one for each tree) have
 * drawn; in every picture of a sequence, shown or not. False: reported. */
bool cli_page_number(cli_page *page, const cli_tree *trees, const cli_shot *shot,
                     cli_session *sessions);

/* Draws all panels of what the sessions have drawn and of the layouts into a transparent picture of
 * the options' size, with those numbers, the nearest first, as far as there is room for them.
 * False: reported. */
bool cli_page_draw(const cli_page *page, const cli_tree *trees, cli_session *sessions,
                   const picture *flats, picture *p);

/* Branches (reduced nodes) that come nearer than the risk; *least: the least distance, mm. */
uint32_t cli_tree_at_risk(const cli_tree *tree, float *least);

#endif
