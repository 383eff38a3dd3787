/* What is known of what was picked: once, for tips, the panel and JSON. */
#include "document.h"

#include "legends.h"

#include <cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A further fact, its values to be filled in; the last one again when there are too many. */
static picked_fact *add(picked *out, const char *name, const char *unit, uint32_t count) {
    picked_fact *fact =
        &out->facts[out->fact_count < PICKED_FACTS ? out->fact_count++ : PICKED_FACTS - 1];
    memset(fact, 0, sizeof *fact);
    snprintf(fact->name, sizeof fact->name, "%s", name);
    fact->unit = unit;
    fact->count = count < 4 ? count : 4;
    return fact;
}

static void add_number(picked *out, const char *name, const char *unit, double value) {
    add(out, name, unit, 1)->values[0] = value;
}

/* ---- lines ------------------------------------------------------------------------------- */

static double length_of(const float *points, uint32_t count) {
    double length = 0;
    for (size_t i = 3; i < 3 * (size_t)count; i += 3)
        length += hypot(hypot((double)points[i] - (double)points[i - 3],
                              (double)points[i + 1] - (double)points[i - 2]),
                        (double)points[i + 2] - (double)points[i - 1]);
    return length;
}

static void add_rows(picked *out, const io_attribute *list, uint32_t count, size_t row) {
    for (uint32_t i = 0; i < count && i < 5; i++) {
        const char *unit = cli_attribute_unit(list[i].name);
        picked_fact *fact = add(out, list[i].name, unit ? unit : "", list[i].components);
        for (uint32_t k = 0; k < fact->count; k++)
            fact->values[k] = (double)list[i].data[row * list[i].components + k];
    }
}

static void tell_line(const cli_set *set, picked *out) {
    const io_lines *lines = &set->lines;
    uint32_t first = lines->offsets[out->line], count = lines->offsets[out->line + 1] - first;
    snprintf(out->title, sizeof out->title, "line %u of %s, point %u of %u", out->line,
             document_file_name(set->name), out->point - first, count);
    add_number(out, "length", "mm", length_of(lines->points + 3 * (size_t)first, count));
    add_rows(out, lines->point_attributes, lines->point_attribute_count, out->point);
    add_rows(out, lines->line_attributes, lines->line_attribute_count, out->line);
}

/* ---- trees ------------------------------------------------------------------------------- */

static void tell_tree(const cli_tree *of, picked *out) {
    const sdv_tree *tree = &of->vessel.tree;
    uint32_t owner = of->reduced.owners[out->point];
    const char *name = document_file_name(of->name);
    if (out->line == SDV_NONE)
        snprintf(out->title, sizeof out->title, "root of %s, node %u", name, out->point);
    else
        snprintf(out->title, sizeof out->title, "segment %u of %s, node %u", out->line, name,
                 out->point);
    add_number(out, "radius", "mm", (double)tree->nodes[out->point].w);
    if (of->distances && owner != SDV_NONE)
        add_number(out, "from the target", "mm", (double)of->distances[owner]);
    for (uint32_t i = 0; i < tree->node_attribute_count && i < 5; i++) {
        const sdv_attribute *a = &tree->node_attributes[i];
        size_t width = a->components ? a->components : 1;
        add_number(out, a->name, "", (double)a->values[out->point * width]);
    }
}

/* ---- surfaces ---------------------------------------------------------------------------- */

/* The distance (mm) of a vertex to what is lit now; VSF_FAR: nothing is. */
static float lit_distance(const cli_wall *wall, uint32_t vertex) {
    const float *pair = wall->object.near_pair + 2 * (size_t)vertex;
    return wall->lit ? vsf_near_mix(pair[0], pair[1], wall->settings.near_part) : VSF_FAR;
}

static void tell_surface(const cli_set *set, picked *out) {
    const cli_wall *wall = set->wall;
    const vsf_mesh *mesh = pick_mesh(set);
    snprintf(out->title, sizeof out->title, "triangle %u of %s, vertex %u", out->line,
             document_file_name(set->name), out->point);
    if (wall && mesh->attribute_count)
        add_number(out, mesh->attributes[0].name, "", (double)wall->object.values[out->point]);
    if (wall && lit_distance(wall, out->point) < 1e30f)
        add_number(out, "from the flow of now", "mm", (double)lit_distance(wall, out->point));
}

/* ---- all --------------------------------------------------------------------------------- */

void pick_tell(const cli_scene *scene, picked *of) {
    const cli_set *set = &scene->sets[of->set];
    of->fact_count = 0;
    of->title[0] = '\0';
    if (of->kind == PICKED_NOTHING)
        return;
    if (of->kind == PICKED_LINE)
        tell_line(set, of);
    else if (of->kind == PICKED_TREE)
        tell_tree(set->tree, of);
    else
        tell_surface(set, of);
    memcpy(add(of, "at", "mm", 3)->values, of->at, sizeof of->at);
}

void pick_print(const picked_fact *fact, char *text, size_t size) {
    int used = snprintf(text, size, "%s:", fact->name);
    for (uint32_t k = 0; k < fact->count && used > 0 && (size_t)used < size; k++)
        used += snprintf(text + used, size - (size_t)used, " %.5g", fact->values[k]);
    if (*fact->unit && used > 0 && (size_t)used < size)
        snprintf(text + used, size - (size_t)used, " %s", fact->unit);
}

char *pick_json(const cli_scene *scene, const picked *of) {
    static const char *const kinds[] = {"nothing", "line", "tree", "surface"};
    static const char *const items[] = {"", "line", "segment", "triangle"};
    static const char *const points[] = {"", "point", "node", "vertex"};
    cJSON *object = cJSON_CreateObject(), *facts = NULL;
    cJSON_AddStringToObject(object, "kind", kinds[of->kind]);
    if (of->kind != PICKED_NOTHING) {
        const cli_set *set = &scene->sets[of->set];
        uint32_t first = of->kind == PICKED_LINE ? set->lines.offsets[of->line] : 0;
        cJSON_AddStringToObject(object, "of", set->name);
        cJSON_AddNumberToObject(object, items[of->kind],
                                of->line == UINT32_MAX ? -1.0 : (double)of->line);
        cJSON_AddNumberToObject(object, points[of->kind], of->point - first);
        facts = cJSON_AddObjectToObject(object, "facts");
    }
    for (uint32_t i = 0; i < of->fact_count; i++) {
        const picked_fact *fact = &of->facts[i];
        cJSON_AddItemToObject(facts, fact->name,
                              fact->count == 1
                                  ? cJSON_CreateNumber(fact->values[0])
                                  : cJSON_CreateDoubleArray(fact->values, (int)fact->count));
    }
    char *text = cJSON_PrintUnformatted(object);
    cJSON_Delete(object);
    if (!text)
        cli_fail("out of memory");
    return text;
}
