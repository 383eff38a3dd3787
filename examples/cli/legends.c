#include "legends.h"

#include "report.h"
#include "surface.h"
#include "vessel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *cli_attribute_unit(const char *attribute) {
    static const char *const units[][2] = {{"time", "ms"}, {"speed", "m/s"}, {"velocity", "m/s"}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (strcmp(units[i][0], attribute) == 0)
            return units[i][1];
    }
    return NULL;
}

enum { GIVEN = 4, SCALES = 8, TITLE = 160 };

/* Scales under way: what they show is kept here. */
typedef struct scales {
    colour_map maps[SCALES];
    char titles[SCALES][TITLE];
    legend list[GIVEN + SCALES];
    uint32_t count, made; /* made: of them here */
} scales;

/* Do the colours of a set tell what those of an earlier one tell, or nothing? */
static bool is_known(const cli_scene *scene, uint32_t set) {
    bool known = !scene->sets[set].value;
    for (uint32_t before = 0; before < set && !known; before++)
        known = cli_same_scale(&scene->sets[before], &scene->sets[set]);
    return known;
}

static void add_set(scales *s, const cli_set *set) {
    const char *unit = cli_attribute_unit(set->value);
    char *title = s->titles[s->made];
    snprintf(title, TITLE, "%s%s%s%s", set->value, unit ? " (" : "", unit ? unit : "",
             unit ? ")" : "");
    colour_map_make(set->source->colormap, &s->maps[s->made]); /* the flag's choices are names */
    s->list[s->count++] = (legend){&s->maps[s->made++], {set->range[0], set->range[1]}, title};
}

/* Trees by a number, walls by near flow or an array. */
static void add_object(scales *s, const cli_object *object) {
    uint32_t count = 0;
    if (object->tree)
        count =
            cli_tree_scale(object->tree, &s->maps[s->made], s->titles[s->made], &s->list[s->count]);
    else if (s->made + 2 <= SCALES)
        count = cli_wall_scales(object->wall, &s->maps[s->made], &s->titles[s->made],
                                &s->list[s->count]);
    s->made += count;
    s->count += count;
}

/* All that the options ask for; *side is where. NULL with *ok: none. */
static scales *collect(const cli_options *options, const cli_scene *scene, const legend *more,
                       uint32_t more_count, legend_side *at, bool *ok) {
    static const char *const sides[] = {"left", "right", "bottom"};
    uint32_t side = 0;
    *ok = true;
    while (side < 3 && strcmp(sides[side], options->legend) != 0)
        side++;
    if (side == 3)
        return NULL; /* off */
    scales *s = cli_new(1, sizeof *s);
    *ok = s != NULL;
    if (!s)
        return NULL;
    *at = (legend_side)side;
    s->count = s->made = 0;
    while (s->count < more_count) {
        s->list[s->count] = more[s->count];
        s->count++;
    }
    for (uint32_t i = 0; i < scene->count && s->made < SCALES; i++) {
        if (!is_known(scene, i))
            add_set(s, &scene->sets[i]);
    }
    for (uint32_t i = 0; i < scene->object_count && s->made < SCALES; i++)
        add_object(s, scene->objects[i]);
    if (s->count && options->legend_title)
        s->list[0].title = options->legend_title;
    return s;
}

bool cli_legends_draw(const cli_options *options, const cli_scene *scene, const legend *more,
                      uint32_t more_count, picture *p) {
    legend_side side = LEGEND_LEFT;
    bool ok;
    scales *s = collect(options, scene, more, more_count, &side, &ok);
    if (s)
        ok = legend_draw(p, side, s->list, s->count) || cli_fail("out of memory");
    free(s);
    return ok;
}

void cli_legends_note(legend_side side, const legend *list, uint32_t count, const uint32_t size[2],
                      char note[CLI_NOTE]) {
    uint32_t room = legend_room(size[0], size[1], side, list, count);
    *note = 0;
    if (room < count)
        snprintf(note, CLI_NOTE,
                 "no room for %u of %u legends in %ux%u pixels; a larger --size has it",
                 (unsigned)(count - room), (unsigned)count, (unsigned)size[0], (unsigned)size[1]);
}

bool cli_legends_check(const cli_options *options, const cli_scene *scene, const legend *more,
                       uint32_t more_count, const uint32_t size[2], char note[CLI_NOTE]) {
    legend_side side = LEGEND_LEFT;
    bool ok;
    scales *s = collect(options, scene, more, more_count, &side, &ok);
    *note = 0;
    if (s && options->out)
        cli_legends_note(side, s->list, s->count, size, note);
    free(s);
    return ok;
}

void cli_legends_warn(const cli_options *options, const char *name, const char *note) {
    if (*note && !options->json)
        cli_warn(name, note);
}
