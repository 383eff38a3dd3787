/* A magic lens over a vessel tree: inside a ball, or a circle on the picture, the tree has another
 * style, or another tree shows. It is a second set of the scene. */
#ifndef LINEAO_CLI_VESSEL_LENS_H
#define LINEAO_CLI_VESSEL_LENS_H

#include "vessel.h"

typedef struct cli_lens {
    cli_options options; /* of what is inside; all zero: there is no lens */
    cli_source source;
    cli_tree tree;
} cli_lens;

/* Makes the options of what is inside from those of all, whose tree is cut by a ball. `lens` is all
 * zero before, and does not move. */
void cli_lens_plan(cli_options *options, cli_lens *lens);
/* Reads what is inside, once the other tree is. False: reported; free lens->tree in any case. */
bool cli_lens_load(cli_lens *lens, const cli_tree *outside);
/* Adds it to the scene of the other tree, which is prepared. False: reported. */
bool cli_lens_prepare(cli_lens *lens, cli_tree *outside);
/* For the first shot: the period of its ink, and cli_lens_aim. */
void cli_lens_fit(cli_lens *lens, cli_tree *outside, const cli_shot *shot);
/* Puts the circle, if it is one, where it is in the shot. */
void cli_lens_aim(cli_lens *lens, cli_tree *outside, const cli_shot *shot);

#endif
