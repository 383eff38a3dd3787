/* Legends of a picture: one for every scale that something in it is coloured by. */
#ifndef LINEAO_CLI_LEGENDS_H
#define LINEAO_CLI_LEGENDS_H

#include "legend.h"
#include "load.h"

/* The unit of an attribute that is known by its name, or NULL. */
const char *cli_attribute_unit(const char *attribute);

/* Draws the legends of the sets' and objects' colours at the side that --legend names, unless that
 * is "off", and `more` (at most 4) before them. --legend-title is the first one's. False: reported.
 */
bool cli_legends_draw(const cli_options *options, const cli_scene *scene, const legend *more,
                      uint32_t more_count, picture *p);

/* What pictures of this size have no room for, in words; "": they have room for all, or none is
 * asked for. False: reported. */
bool cli_legends_check(const cli_options *options, const cli_scene *scene, const legend *more,
                       uint32_t more_count, const uint32_t size[2], char note[CLI_NOTE]);
/* The same for a list of them. */
void cli_legends_note(legend_side side, const legend *list, uint32_t count, const uint32_t size[2],
                      char note[CLI_NOTE]);
/* Says so of a picture before it is drawn; with --json it is for the report, which comes later. */
void cli_legends_warn(const cli_options *options, const char *name, const char *note);

#endif
