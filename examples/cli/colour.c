/* Colours of a set: by direction, by line, by an attribute through a colour map, or one colour. */
#include "load.h"

#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct rgb {
    double r, g, b;
} rgb;

static void put(uint8_t *out, rgb c) {
    const double v[3] = {c.r, c.g, c.b};
    for (int k = 0; k < 3; k++)
        out[k] = (uint8_t)(255.0 * (v[k] < 0 ? 0 : v[k] > 1 ? 1 : v[k]) + 0.5);
    out[3] = 255;
}

/* ---- by direction ----------------------------------------------------------------------- */

/* The field's convention, red along x, green along y, blue along z, a little paler than pure: full
 * blue is so dark that shading drowns in it. */
static rgb direction_color(double x, double y, double z) {
    double scale = 0.78 / sqrt(x * x + y * y + z * z);
    return (rgb){0.16 + scale * fabs(x), 0.16 + scale * fabs(y), 0.16 + scale * fabs(z)};
}

/* Where neighbours coincide, the direction before holds, at a line's begin the first there is. */
static void colour_direction(const io_lines *lines, uint8_t *colors) {
    for (uint32_t line = 0; line < lines->line_count; line++) {
        uint32_t first = lines->offsets[line], last = lines->offsets[line + 1] - 1, done = first;
        rgb color = {0.7, 0.7, 0.7};
        for (uint32_t i = first; i < lines->offsets[line + 1]; i++) { /* may have no point */
            const float *a = lines->points + 3 * (size_t)(i > first ? i - 1 : i);
            const float *b = lines->points + 3 * (size_t)(i < last ? i + 1 : i);
            if (a[0] != b[0] || a[1] != b[1] || a[2] != b[2])
                color =
                    direction_color((double)b[0] - a[0], (double)b[1] - a[1], (double)b[2] - a[2]);
            else if (done == first && i < last)
                continue; /* no direction yet */
            for (; done <= i; done++)
                put(colors + 4 * (size_t)done, color);
        }
    }
}

/* ---- by line ---------------------------------------------------------------------------- */

/* A hue of even lightness: three cosines around light grey. */
static rgb hue(double turn, double chroma) {
    const double tau = 6.283185307179586;
    return (rgb){0.70 + chroma * cos(tau * turn), 0.66 + chroma * cos(tau * (turn - 1.0 / 3)),
                 0.72 + chroma * cos(tau * (turn - 2.0 / 3))};
}

static void colour_line(const io_lines *lines, uint8_t *colors) {
    for (uint32_t line = 0; line < lines->line_count; line++) {
        uint32_t hash = (line + 1) * 2654435769u; /* golden ratio: neighbours differ most */
        rgb color = hue(hash / 4294967296.0, 0.22 + 0.06 * ((line >> 1) & 1));
        for (uint32_t i = lines->offsets[line]; i < lines->offsets[line + 1]; i++)
            put(colors + 4 * (size_t)i, color);
    }
}

/* ---- by attribute ----------------------------------------------------------------------- */

typedef struct colormap_row {
    const char *name;
    uint32_t stops[10]; /* 0xrrggbb at even distances */
} colormap_row;

static rgb colormap_at(const colormap_row *map, double at) {
    double x = 9 * (at < 0 ? 0 : at > 1 ? 1 : at);
    uint32_t i = x < 8 ? (uint32_t)x : 8, a = map->stops[i], b = map->stops[i + 1];
    double f = x - i, v[3];
    for (int k = 0; k < 3; k++) {
        double low = (a >> (16 - 8 * k)) & 255, high = (b >> (16 - 8 * k)) & 255;
        v[k] = (low + f * (high - low)) / 255;
    }
    return (rgb){v[0], v[1], v[2]};
}

static const colormap_row *find_colormap(const char *name) {
    // clang-format off
    static const colormap_row rows[] = {
        {"viridis",  {0x440154, 0x482878, 0x3e4989, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725}},
        {"inferno",  {0x000004, 0x1b0c41, 0x4a0c6b, 0x781c6d, 0xa52c60, 0xcf4446, 0xed6925, 0xfb9b06, 0xf7d13d, 0xfcffa4}},
        {"coolwarm", {0x3b4cc0, 0x5f7fe8, 0x86a9fc, 0xaac7fd, 0xccd9ed, 0xead4c8, 0xf7b89c, 0xf18d6f, 0xd95847, 0xb40426}},
        {"gray",     {0x202020, 0x363636, 0x4c4c4c, 0x626262, 0x787878, 0x8e8e8e, 0xa4a4a4, 0xbababa, 0xd0d0d0, 0xe6e6e6}},
    };
    // clang-format on
    for (size_t i = 1; i < sizeof rows / sizeof *rows; i++) {
        if (strcmp(rows[i].name, name) == 0)
            return &rows[i];
    }
    return rows;
}

static const char *attribute_name(const void *user, uint32_t index) {
    const io_lines *lines = user;
    uint32_t points = lines->point_attribute_count;
    if (index >= points + lines->line_attribute_count)
        return NULL;
    return (index < points ? &lines->point_attributes[index]
                           : &lines->line_attributes[index - points])
        ->name;
}

/* Index for attribute_name, or -1. */
static int find_attribute(const io_lines *lines, const char *name) {
    for (uint32_t i = 0; attribute_name(lines, i); i++) {
        if (strcmp(attribute_name(lines, i), name) == 0)
            return (int)i;
    }
    return -1;
}

static bool unknown_attribute(const cli_set *set, const char *name) {
    char names[512] = "";
    for (uint32_t i = 0; attribute_name(&set->lines, i); i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, ", %s", attribute_name(&set->lines, i));
    }
    return cli_fail("%s: there is no attribute '%s' to colour by; there are direction, line%s",
                    set->name, name, names);
}

/* Components of row `i`: the value, or the length of a vector. */
static double magnitude(const io_attribute *attribute, uint32_t i) {
    const float *v = attribute->data + (size_t)i * attribute->components;
    double sum = 0;
    for (uint32_t k = 0; k < attribute->components; k++)
        sum += (double)v[k] * v[k];
    return attribute->components == 1 ? v[0] : sqrt(sum);
}

static void find_range(const cli_set *set, const io_attribute *attribute, uint32_t rows,
                       double range[2]) {
    range[0] = set->source->range[0];
    range[1] = set->source->range[1];
    if (range[0] != range[1])
        return;
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (uint32_t i = 0; i < rows; i++) {
        double v = magnitude(attribute, i);
        range[0] = isfinite(v) && v < range[0] ? v : range[0];
        range[1] = isfinite(v) && v > range[1] ? v : range[1];
    }
    if (!(range[0] < range[1])) /* nothing, or one value: the middle of the map */
        range[1] = (range[0] = isfinite(range[0]) ? range[0] - 1 : 0) + 2;
}

static bool colour_attribute(cli_set *set, const char *name) {
    const io_lines *lines = &set->lines;
    const rgb missing = {0.6, 0.6, 0.6}; /* NaN: not in the file */
    int found = find_attribute(lines, name);
    if (found < 0)
        return unknown_attribute(set, name);
    bool per_point = (uint32_t)found < lines->point_attribute_count;
    const io_attribute *attribute =
        per_point ? &lines->point_attributes[found]
                  : &lines->line_attributes[(uint32_t)found - lines->point_attribute_count];
    double range[2];
    find_range(set, attribute, per_point ? lines->point_count : lines->line_count, range);
    const colormap_row *map = find_colormap(set->source->colormap);
    for (uint32_t line = 0; line < lines->line_count; line++) {
        for (uint32_t i = lines->offsets[line]; i < lines->offsets[line + 1]; i++) {
            double at =
                (magnitude(attribute, per_point ? i : line) - range[0]) / (range[1] - range[0]);
            put(set->colors + 4 * (size_t)i, isnan(at) ? missing : colormap_at(map, at));
        }
    }
    return true;
}

/* ---- all -------------------------------------------------------------------------------- */

bool cli_colour(cli_set *set) {
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
    if (!color || strcmp(color, "direction") == 0)
        colour_direction(&set->lines, set->colors);
    else if (strcmp(color, "line") == 0)
        colour_line(&set->lines, set->colors);
    else
        return colour_attribute(set, color);
    return true;
}
