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

/* Warns once, before any picture is drawn, where pictures of this size have no room for them all.
 * False: reported. */
bool cli_legends_check(const cli_options *options, const cli_scene *scene, const legend *more,
                       uint32_t more_count, const uint32_t size[2]);
/* The warning alone, of a picture's name. */
void cli_legends_warn(const char *name, legend_side side, const legend *list, uint32_t count,
                      const uint32_t size[2]);

#endif
