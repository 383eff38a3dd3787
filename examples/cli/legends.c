#include "legends.h"

#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The unit of an attribute that is known by its name, or NULL. */
static const char *unit_of(const char *attribute) {
    static const char *const units[][2] = {{"time", "ms"}, {"speed", "m/s"}, {"velocity", "m/s"}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (strcmp(units[i][0], attribute) == 0)
            return units[i][1];
    }
    return NULL;
}

enum { MOST = 8, OF_SETS = 4, TITLE = 128 };

/* Do the colours of a set tell what those of an earlier one tell, or nothing? */
static bool is_known(const cli_scene *scene, uint32_t set) {
    bool known = !scene->sets[set].value;
    for (uint32_t before = 0; before < set && !known; before++)
        known = cli_same_scale(&scene->sets[before], &scene->sets[set]);
    return known;
}

bool cli_legends_draw(const cli_options *options, const cli_scene *scene, const legend *more,
                      uint32_t more_count, picture *p) {
    static const char *const sides[] = {"left", "right", "bottom"};
    char titles[OF_SETS][TITLE];
    legend legends[MOST];
    uint32_t count = 0, side = 0;
    while (side < 3 && strcmp(sides[side], options->legend) != 0)
        side++;
    if (side == 3)
        return true; /* off */
    colour_map *maps = cli_new(OF_SETS, sizeof *maps);
    for (; maps && count < more_count; count++)
        legends[count] = more[count];
    for (uint32_t s = 0; maps && s < scene->count && count < more_count + OF_SETS; s++) {
        const cli_set *set = &scene->sets[s];
        if (is_known(scene, s))
            continue;
        const char *unit = unit_of(set->value);
        char *title = titles[count - more_count];
        colour_map *map = &maps[count - more_count];
        snprintf(title, TITLE, "%s%s%s%s", set->value, unit ? " (" : "", unit ? unit : "",
                 unit ? ")" : "");
        colour_map_make(set->source->colormap, map); /* the flag's choices are its names */
        legends[count].map = map;
        memcpy(legends[count].range, set->range, sizeof set->range);
        legends[count++].title = title;
    }
    if (count && options->legend_title)
        legends[0].title = options->legend_title;
    bool ok =
        maps && (legend_draw(p, (legend_side)side, legends, count) || cli_fail("out of memory"));
    free(maps);
    return ok;
}
