/* Colours of a set: by direction, by line, by an attribute through a colour map, or one colour. */
#include "colour.h"
#include "load.h"
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put(uint8_t *out, const double rgb[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = colour_byte(rgb[k]);
    out[3] = 255;
}

/* ---- by direction and by line ----------------------------------------------------------- */

/* Where neighbours coincide, the direction before holds, at a line's begin the first there is. */
static void colour_directions(const io_lines *lines, uint8_t *colors) {
    for (uint32_t line = 0; line < lines->line_count; line++) {
        uint32_t first = lines->offsets[line], last = lines->offsets[line + 1] - 1, done = first;
        double rgb[3];
        colour_missing(rgb);
        for (uint32_t i = first; i < lines->offsets[line + 1]; i++) { /* may have no point */
            const float *a = lines->points + 3 * (size_t)(i > first ? i - 1 : i);
            const float *b = lines->points + 3 * (size_t)(i < last ? i + 1 : i);
            if (a[0] != b[0] || a[1] != b[1] || a[2] != b[2])
                colour_direction((double)b[0] - a[0], (double)b[1] - a[1], (double)b[2] - a[2],
                                 rgb);
            else if (done == first && i < last)
                continue; /* no direction yet */
            for (; done <= i; done++)
                put(colors + 4 * (size_t)done, rgb);
        }
    }
}

static void colour_lines(const io_lines *lines, uint8_t *colors) {
    for (uint32_t line = 0; line < lines->line_count; line++) {
        double rgb[3];
        colour_of_line(line, rgb);
        for (uint32_t i = lines->offsets[line]; i < lines->offsets[line + 1]; i++)
            put(colors + 4 * (size_t)i, rgb);
    }
}

/* ---- attributes ------------------------------------------------------------------------- */

static const io_attribute *attribute_at(const io_lines *lines, uint32_t index) {
    uint32_t points = lines->point_attribute_count;
    if (index >= points + lines->line_attribute_count)
        return NULL;
    return index < points ? &lines->point_attributes[index]
                          : &lines->line_attributes[index - points];
}

static const io_attribute *find_attribute(const io_lines *lines, const char *name) {
    for (uint32_t i = 0; attribute_at(lines, i); i++) {
        if (strcmp(attribute_at(lines, i)->name, name) == 0)
            return attribute_at(lines, i);
    }
    return NULL;
}

static bool is_per_point(const io_lines *lines, const io_attribute *attribute) {
    for (uint32_t i = 0; i < lines->point_attribute_count; i++) {
        if (attribute == &lines->point_attributes[i])
            return true;
    }
    return false;
}

static bool unknown_attribute(const cli_set *set, const char *name) {
    char names[512] = "";
    for (uint32_t i = 0; attribute_at(&set->lines, i); i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, ", %s", attribute_at(&set->lines, i)->name);
    }
    return cli_fail("%s: there is no attribute '%s' to colour by; there are direction, line%s",
                    set->name, name, names);
}

/* Row `i`: the value, or the length of a vector. */
static double magnitude(const io_attribute *attribute, uint32_t i) {
    const float *v = attribute->data + (size_t)i * attribute->components;
    double sum = 0;
    for (uint32_t k = 0; k < attribute->components; k++)
        sum += (double)v[k] * v[k];
    return attribute->components == 1 ? v[0] : sqrt(sum);
}

/* Way over time (mm / ms = m / s) from the point before to the point behind; NaN without time. */
static float speed_at(const cli_set *set, uint32_t before, uint32_t behind) {
    const float *a = set->lines.points + 3 * (size_t)before;
    const float *b = set->lines.points + 3 * (size_t)behind;
    double x = (double)b[0] - a[0], y = (double)b[1] - a[1], z = (double)b[2] - a[2];
    double time = (double)set->times[behind] - set->times[before];
    return time > 0 ? (float)(sqrt(x * x + y * y + z * z) / time) : NAN;
}

/* Pathlines without a point attribute "speed" get one. */
static bool add_speed(cli_set *set) {
    io_lines *lines = &set->lines;
    io_attribute *rows =
        realloc(lines->point_attributes, (lines->point_attribute_count + 1) * sizeof *rows);
    if (!rows)
        return cli_fail("out of memory");
    lines->point_attributes = rows;
    io_attribute speed = {cli_new(sizeof "speed", 1), 1,
                          cli_new(lines->point_count, sizeof *speed.data)};
    if (!speed.name || !speed.data) {
        free(speed.name);
        free(speed.data);
        return false;
    }
    strcpy(speed.name, "speed");
    for (uint32_t line = 0; line < lines->line_count; line++) {
        uint32_t first = lines->offsets[line], end = lines->offsets[line + 1];
        for (uint32_t i = first; i < end; i++)
            speed.data[i] = speed_at(set, i > first ? i - 1 : i, i + 1 < end ? i + 1 : i);
    }
    rows[lines->point_attribute_count++] = speed;
    return true;
}

/* ---- ranges and colours ----------------------------------------------------------------- */

bool cli_same_scale(const cli_set *a, const cli_set *b) {
    bool same = a->value && b->value && strcmp(a->value, b->value) == 0 &&
                strcmp(a->source->colormap, b->source->colormap) == 0;
    for (int i = 0; i < 2 && same; i++)
        same = a->source->range[i].percent == b->source->range[i].percent &&
               a->source->range[i].value == b->source->range[i].value;
    return same;
}

static uint32_t row_count(const io_lines *lines, const io_attribute *attribute) {
    return is_per_point(lines, attribute) ? lines->point_count : lines->line_count;
}

/* The range of all sets that share the scale of this one. */
static bool find_range(cli_scene *scene, cli_set *set) {
    size_t count = 0, done = 0;
    for (uint32_t s = 0; s < scene->count; s++) {
        const cli_set *other = &scene->sets[s];
        if (cli_same_scale(set, other))
            count += row_count(&other->lines, find_attribute(&other->lines, other->value));
    }
    double *values = cli_new(count, sizeof *values);
    if (!values)
        return false;
    for (uint32_t s = 0; s < scene->count; s++) {
        const cli_set *other = &scene->sets[s];
        if (!cli_same_scale(set, other))
            continue;
        const io_attribute *attribute = find_attribute(&other->lines, other->value);
        for (uint32_t i = 0; i < row_count(&other->lines, attribute); i++)
            values[done++] = magnitude(attribute, i);
    }
    colour_range(values, count, set->source->range, set->range);
    free(values);
    return true;
}

static void colour_values(cli_set *set) {
    const io_lines *lines = &set->lines;
    const io_attribute *attribute = find_attribute(lines, set->value);
    bool per_point = is_per_point(lines, attribute);
    double low = set->range[0], width = set->range[1] - set->range[0], rgb[3];
    colour_map map;
    colour_map_make(set->source->colormap, &map); /* the flag's choices are its names */
    for (uint32_t line = 0; line < lines->line_count; line++) {
        for (uint32_t i = lines->offsets[line]; i < lines->offsets[line + 1]; i++) {
            colour_map_at(&map, (magnitude(attribute, per_point ? i : line) - low) / width, rgb);
            put(set->colors + 4 * (size_t)i, rgb);
        }
    }
}

/* ---- all -------------------------------------------------------------------------------- */

/* Everything but attributes, whose range the other sets take part in. */
static bool colour_set(cli_set *set) {
    const char *color = set->source->color;
    double one[4];
    if (!color && set->times)
        return true; /* pathlines: the surface reads best in one light colour */
    if (color && cli_parse_color(color, one)) {
        for (int k = 0; k < 3; k++)
            set->color[k] = (float)one[k];
        set->color[3] = 1;
        return true;
    }
    set->colors = cli_new(set->lines.point_count, 4);
    if (!set->colors)
        return false;
    if (!color || strcmp(color, "direction") == 0) {
        colour_directions(&set->lines, set->colors);
    } else if (strcmp(color, "line") == 0) {
        colour_lines(&set->lines, set->colors);
    } else {
        bool has = find_attribute(&set->lines, color) != NULL;
        if (!has && !(strcmp(color, "speed") == 0 && set->times))
            return unknown_attribute(set, color);
        set->value = color;
        return has || add_speed(set);
    }
    return true;
}

bool cli_colour(cli_scene *scene) {
    bool ok = true;
    for (uint32_t s = 0; s < scene->count && ok; s++)
        ok = scene->sets[s].object || colour_set(&scene->sets[s]);
    for (uint32_t s = 0; s < scene->count && ok; s++) {
        cli_set *set = &scene->sets[s];
        ok = !set->value || find_range(scene, set);
        if (ok && set->value)
            colour_values(set);
    }
    return ok;
}
