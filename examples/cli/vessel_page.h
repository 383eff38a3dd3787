/* The page of lineao vessel --link: trees and their layouts in one picture. */
#ifndef LINEAO_CLI_VESSEL_PAGE_H
#define LINEAO_CLI_VESSEL_PAGE_H

#include "vessel.h"

typedef struct cli_page {
    const cli_options *options; /* of the whole picture */
    uint32_t columns;           /* trees; one: it stands beside its layout, not above */
    uint32_t panel[2];          /* px: of a tree's picture and of a layout's */
    uint32_t gap, head, left;   /* px: between panels; above them; at their left */
    const char *side;           /* of the scale; NULL: there is none */
} cli_page;

/* Divides a picture of the options' size; scaled: colours have a scale. False: reported. */
bool cli_page_make(const cli_options *options, bool scaled, cli_page *out);

/* Draws all panels of what the sessions (one for each tree) have drawn and of the layouts into a
 * transparent picture of the options' size, with numbers at the branches at risk, the nearest
 * first, as far as there is room for them. False: reported. */
bool cli_page_draw(const cli_page *page, const cli_tree *trees, const cli_shot *shot,
                   cli_session *sessions, const picture *flats, picture *p);

/* Branches (reduced nodes) that come nearer than the risk; *least: the least distance, mm. */
uint32_t cli_tree_at_risk(const cli_tree *tree, float *least);

#endif
