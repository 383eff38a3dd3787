/* Numbers of the branches that are at risk, the nearest first; the same in both views of the page
 * and in the report. */
#ifndef LINEAO_CLI_VESSEL_MARKS_H
#define LINEAO_CLI_VESSEL_MARKS_H

#include "vessel.h"
#include "vessel_labels.h"

typedef struct cli_branch {
    uint32_t node;  /* reduced */
    float distance; /* mm */
} cli_branch;

/* The branches at risk, the nearest first; for free(). NULL: reported. */
cli_branch *cli_branches_at_risk(const cli_tree *tree, uint32_t *count);

/* A place of the tree's middle line: a node, and what part of the way to its parent. */
typedef struct cli_axis {
    uint32_t node;
    float part;
} cli_axis;

typedef struct cli_marks {
    uint32_t count;
    cli_branch *branches; /* owned; of all pictures */
    cli_axis *axes;       /* owned; per branch: what its number stood at in the last picture */
    uint32_t omitted;     /* there is no room for them in one of the views */
    uint32_t hidden;      /* of those that are shown: nothing of the branch is seen in the tree's */
    bool *seen;           /* owned; per branch */
    cli_label *labels[2]; /* owned; in the tree's picture, in the layout */
    text_style style;
} cli_marks;

/* Of a tree that the session has drawn; both views are as large as the shot. size: of text where
 * there is room for it, px. A branch has a number in both views or in none. `marks`: zero, or those
 * of the same tree in the picture before: what a number stands at, and where it stands, stay as
 * they were as far as they can. False: reported; free it in any case. */
bool cli_marks_make(const cli_tree *tree, const cli_shot *shot, cli_session *session, double size,
                    cli_marks *marks);
/* view 0: the tree's, with a line about those left out and hidden; 1: the layout's. corner: its
 * left upper one; height: px. False: reported. */
bool cli_marks_draw(const cli_marks *numbers, uint32_t view, const int64_t corner[2],
                    uint32_t height, picture *p);
void cli_marks_free(cli_marks *numbers);

#endif
