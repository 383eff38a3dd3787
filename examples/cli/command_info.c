/* lineao info: what is in files of lines, vessel trees, meshes and velocity volumes. */
#include "commands.h"
#include "dump.h"
#include "flow.h"
#include "io_vessel.h"
#include "load.h"
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is known about one FILE. */
typedef struct entry {
    const char *path;
    io_volume volume; /* where size[0] is not 0; else: */
    io_contents contents;
    io_vessel vessel; /* when there is a tree */
    uint32_t stored;  /* vertices of the mesh before welding */
    io_mesh_edges edges;
    char warnings[64][512]; /* of all parts, each once */
    uint32_t warning_count;
} entry;

/* ---- gathering -------------------------------------------------------------------------- */

static void add_warning(entry *e, const char *text) {
    for (uint32_t i = 0; i < e->warning_count; i++) {
        if (strcmp(e->warnings[i], text) == 0)
            return;
    }
    if (e->warning_count < sizeof e->warnings / sizeof *e->warnings)
        snprintf(e->warnings[e->warning_count++], sizeof *e->warnings, "%s", text);
}

static void add_warnings(entry *e, char *const *texts, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        add_warning(e, texts[i]);
}

/* Each file for itself, also those that are one frame or component of a volume. A unit with a slash
 * is one of velocities. */
static bool gather_volume(const cli_options *options, const cli_source *source, entry *e) {
    cli_options own = *options;
    e->path = source->path;
    if (source->unit && strchr(source->unit, '/'))
        own.flow.unit = source->unit;
    if (!cli_read_volume(&own, source, 1, true, &e->volume))
        return false;
    add_warnings(e, e->volume.warnings, e->volume.warning_count);
    return true;
}

/* The tree as vessels are drawn, the mesh as surfaces are: built and welded. */
static bool gather(const cli_source *source, entry *e) {
    io_contents *c = &e->contents;
    io_error error;
    e->path = source->path;
    if (!cli_read(source, IO_ANYTHING, c))
        return false;
    e->stored = c->mesh.vertex_count;
    if ((c->kinds & IO_TREE) && !io_vessel_build(NULL, &c->tree, &e->vessel, &error))
        return cli_fail("%s: %s", e->path, error.text);
    if ((c->kinds & IO_MESH) &&
        (!io_mesh_weld(&c->mesh, &error) || !io_mesh_count_edges(&c->mesh, &e->edges, &error)))
        return cli_fail("%s: %s", e->path, error.text);
    add_warnings(e, c->lines.warnings, c->lines.warning_count);
    add_warnings(e, c->tree.warnings, c->tree.warning_count);
    add_warnings(e, c->mesh.warnings, c->mesh.warning_count);
    for (uint32_t i = 0; i < e->vessel.tree.warning_count; i++) {
        char text[512];
        sdv_tree_warning_text(&e->vessel.tree, i, text, sizeof text);
        add_warning(e, text);
    }
    return true;
}

/* Of several kinds in one file the tree's node centres, then the lines, then the mesh. */
static const double (*box_of(const entry *e))[3] {
    const io_contents *c = &e->contents;
    if (c->kinds & IO_TREE)
        return (const double(*)[3])e->vessel.bounds;
    if (c->lines.point_count > 0)
        return (const double(*)[3])c->lines.bounds;
    return c->mesh.vertex_count > 0 ? (const double(*)[3])c->mesh.bounds : NULL;
}

static const char *format_of(const io_contents *c) {
    return c->kinds & IO_LINES  ? c->lines.format
           : c->kinds & IO_TREE ? c->tree.format
                                : c->mesh.format;
}

static const char *unit_of(const io_contents *c) {
    return c->kinds & IO_TREE ? c->tree.unit : c->kinds & IO_LINES ? c->lines.unit : c->mesh.unit;
}

static uint32_t points_of(const entry *e) {
    const io_contents *c = &e->contents;
    return c->kinds & IO_LINES  ? c->lines.point_count
           : c->kinds & IO_TREE ? c->tree.node_count
                                : e->stored;
}

/* The attributes of points (nodes, vertices), or else of lines (segments, triangles). */
static const io_attribute *attributes_of(const io_contents *c, bool of_points, uint32_t *count) {
    const io_attribute *all[3][2] = {{c->lines.line_attributes, c->lines.point_attributes},
                                     {c->tree.segment_attributes, c->tree.node_attributes},
                                     {c->mesh.triangle_attributes, c->mesh.vertex_attributes}};
    const uint32_t counts[3][2] = {
        {c->lines.line_attribute_count, c->lines.point_attribute_count},
        {c->tree.segment_attribute_count, c->tree.node_attribute_count},
        {c->mesh.triangle_attribute_count, c->mesh.vertex_attribute_count}};
    int kind = c->kinds & IO_LINES ? 0 : c->kinds & IO_TREE ? 1 : 2;
    *count = counts[kind][of_points];
    return all[kind][of_points];
}

/* ---- volumes ---------------------------------------------------------------------------- */

/* Lengths of a voxel's edges (mm). */
static void find_spacing(const io_volume *v, double spacing[3]) {
    for (int k = 0; k < 3; k++)
        spacing[k] = sqrt(v->to_mm[0][k] * v->to_mm[0][k] + v->to_mm[1][k] * v->to_mm[1][k] +
                          v->to_mm[2][k] * v->to_mm[2][k]);
}

/* Of all voxel centres (mm). */
static void find_box(const io_volume *v, double box[2][3]) {
    for (int row = 0; row < 3; row++) {
        box[0][row] = box[1][row] = v->to_mm[row][3];
        for (int k = 0; k < 3; k++) {
            double edge = v->to_mm[row][k] * ((double)v->size[k] - 1);
            box[edge > 0][row] += edge;
        }
    }
}

/* ---- numbers of trees and meshes -------------------------------------------------------- */

typedef struct figure {
    const char *name; /* of JSON; the text has blanks instead of _ */
    uint32_t value;
} figure;

enum { TREE_FIGURES = 9, MESH_FIGURES = 5 };

static void tree_figures(const entry *e, figure out[TREE_FIGURES]) {
    const sdv_tree_info *i = &e->vessel.tree.info;
    const figure figures[TREE_FIGURES] = {{"nodes", i->nodes},
                                          {"segments", i->segments},
                                          {"roots", i->roots},
                                          {"leaves", i->leaves},
                                          {"branches", i->branches},
                                          {"multifurcations", i->multifurcations},
                                          {"max_children", i->max_children},
                                          {"loops", i->loops},
                                          {"joined", i->joined}};
    memcpy(out, figures, sizeof figures);
}

static void mesh_figures(const entry *e, figure out[MESH_FIGURES]) {
    const figure figures[MESH_FIGURES] = {{"vertices", e->contents.mesh.vertex_count},
                                          {"triangles", e->contents.mesh.triangle_count},
                                          {"boundary_edges", e->edges.boundary},
                                          {"non_manifold_edges", e->edges.non_manifold},
                                          {"components", e->edges.components}};
    memcpy(out, figures, sizeof figures);
}

/* ---- JSON ------------------------------------------------------------------------------- */

static void add_names(cJSON *array, const io_contents *contents, bool of_points) {
    uint32_t count;
    const io_attribute *attributes = attributes_of(contents, of_points, &count);
    for (uint32_t i = 0; i < count; i++)
        cJSON_AddItemToArray(array, cJSON_CreateString(attributes[i].name));
}

static void add_texts(cJSON *array, char *const *texts, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        cJSON_AddItemToArray(array, cJSON_CreateString(texts[i]));
}

static void add_figures(cJSON *file, const figure *figures, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        cJSON_AddNumberToObject(file, figures[i].name, figures[i].value);
}

static void add_parts(cJSON *file, const entry *e) {
    figure tree[TREE_FIGURES], mesh[MESH_FIGURES];
    if (e->contents.kinds & IO_TREE) {
        tree_figures(e, tree);
        add_figures(file, tree, TREE_FIGURES);
        cJSON_AddItemToObject(file, "radius",
                              isnan(e->vessel.radius[0])
                                  ? cJSON_CreateNull()
                                  : cJSON_CreateDoubleArray(e->vessel.radius, 2));
    }
    if (e->contents.kinds & IO_MESH) {
        mesh_figures(e, mesh);
        add_figures(file, mesh, MESH_FIGURES);
    }
}

static void add_warning_texts(cJSON *file, const entry *e) {
    cJSON *warnings = cJSON_AddArrayToObject(file, "warnings");
    for (uint32_t i = 0; i < e->warning_count; i++)
        cJSON_AddItemToArray(warnings, cJSON_CreateString(e->warnings[i]));
}

static cJSON *describe(const entry *e) {
    static const char *const kinds[] = {"lines", "tree", "mesh"};
    const io_contents *c = &e->contents;
    cJSON *file = cJSON_CreateObject();
    cJSON_AddStringToObject(file, "path", e->path);
    cJSON_AddStringToObject(file, "format", format_of(c));
    cJSON *held = cJSON_AddArrayToObject(file, "kinds");
    for (int i = 0; i < 3; i++) {
        if (c->kinds >> i & 1)
            cJSON_AddItemToArray(held, cJSON_CreateString(kinds[i]));
    }
    cJSON_AddNumberToObject(file, "lines", c->lines.line_count);
    cJSON_AddNumberToObject(file, "points", points_of(e));
    const double(*bounds)[3] = box_of(e);
    cJSON *box = bounds ? cJSON_CreateArray() : cJSON_CreateNull();
    for (int i = 0; i < 2 && bounds; i++)
        cJSON_AddItemToArray(box, cJSON_CreateDoubleArray(bounds[i], 3));
    cJSON_AddItemToObject(file, "bbox", box);
    add_parts(file, e);
    cJSON *attributes = cJSON_AddArrayToObject(file, "attributes"); /* of points, then of lines */
    add_names(attributes, c, true);
    add_names(attributes, c, false);
    add_names(cJSON_AddArrayToObject(file, "line_attributes"), c, false);
    cJSON *groups = cJSON_AddArrayToObject(file, "groups");
    for (uint32_t i = 0; i < c->lines.group_count; i++)
        cJSON_AddItemToArray(groups, cJSON_CreateString(c->lines.groups[i].name));
    cJSON_AddStringToObject(file, "unit", unit_of(c));
    add_warning_texts(file, e);
    return file;
}

static cJSON *describe_volume(const entry *e) {
    const io_volume *v = &e->volume;
    const double size[3] = {v->size[0], v->size[1], v->size[2]};
    double spacing[3], box[2][3];
    find_spacing(v, spacing);
    find_box(v, box);
    cJSON *file = cJSON_CreateObject();
    cJSON_AddStringToObject(file, "path", e->path);
    cJSON_AddStringToObject(file, "format", v->format);
    cJSON_AddNumberToObject(file, "lines", 0);
    cJSON_AddNumberToObject(file, "points", 0);
    cJSON *corners = cJSON_AddArrayToObject(file, "bbox");
    for (int i = 0; i < 2; i++)
        cJSON_AddItemToArray(corners, cJSON_CreateDoubleArray(box[i], 3));
    add_texts(cJSON_AddArrayToObject(file, "attributes"), v->arrays, v->array_count);
    cJSON_AddStringToObject(file, "unit", "mm");
    cJSON_AddItemToObject(file, "size", cJSON_CreateDoubleArray(size, 3));
    cJSON_AddItemToObject(file, "spacing", cJSON_CreateDoubleArray(spacing, 3));
    cJSON *rows = cJSON_AddArrayToObject(file, "to_mm");
    for (int row = 0; row < 3; row++)
        cJSON_AddItemToArray(rows, cJSON_CreateDoubleArray(v->to_mm[row], 4));
    cJSON_AddNumberToObject(file, "frames", v->frame_count);
    cJSON_AddNumberToObject(file, "time_step", v->time_step);
    cJSON_AddNumberToObject(file, "period", v->period);
    cJSON_AddStringToObject(file, "velocity_unit", "m/s");
    cJSON_AddItemToObject(file, "speed", cJSON_CreateDoubleArray(v->speed, 2));
    cJSON_AddBoolToObject(file, "mask", v->mask != NULL);
    cJSON_AddNumberToObject(file, "mask_voxels", (double)v->mask_voxels);
    add_warning_texts(file, e);
    return file;
}

/* ---- text ------------------------------------------------------------------------------- */

static uint32_t print_attributes(const io_contents *c, bool of_points, const char *before) {
    uint32_t count;
    const io_attribute *attributes = attributes_of(c, of_points, &count);
    const char *of = c->kinds & IO_LINES  ? (of_points ? "point" : "line")
                     : c->kinds & IO_TREE ? (of_points ? "node" : "segment")
                                          : (of_points ? "vertex" : "triangle");
    for (uint32_t i = 0; i < count; i++) {
        printf("%s%s", i ? ", " : before, attributes[i].name);
        if (attributes[i].components > 1)
            printf("[%u]", attributes[i].components);
    }
    if (count)
        printf(" (per %s)", of);
    return count;
}

static void print_figures(const figure *figures, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        char name[32];
        snprintf(name, sizeof name, "%s", figures[i].name);
        for (char *at = name; *at; at++)
            *at = *at == '_' ? ' ' : *at;
        printf("  %-20s%u\n", name, figures[i].value);
    }
}

static void print_parts(const entry *e) {
    figure tree[TREE_FIGURES], mesh[MESH_FIGURES];
    if (e->contents.kinds & IO_TREE) {
        tree_figures(e, tree);
        print_figures(tree, TREE_FIGURES);
        if (!isnan(e->vessel.radius[0]))
            printf("  radius (%s)         %g .. %g\n", unit_of(&e->contents), e->vessel.radius[0],
                   e->vessel.radius[1]);
    }
    if (e->contents.kinds & IO_MESH) {
        mesh_figures(e, mesh);
        print_figures(mesh, MESH_FIGURES);
    }
}

static void print(const entry *e) {
    const io_contents *c = &e->contents;
    const double(*box)[3] = box_of(e);
    printf("%s\n  %-20s%s\n", e->path, "format", format_of(c));
    if (c->kinds & IO_LINES)
        printf("  %-20s%u\n  %-20s%u\n", "lines", c->lines.line_count, "points",
               c->lines.point_count);
    if (box)
        printf("  box (%s)            %g %g %g .. %g %g %g\n", unit_of(c), box[0][0], box[0][1],
               box[0][2], box[1][0], box[1][1], box[1][2]);
    print_parts(e);
    uint32_t attributes = print_attributes(c, true, "  attributes          ");
    attributes += print_attributes(c, false, attributes ? ", " : "  attributes          ");
    if (attributes)
        printf("\n");
    if (c->lines.group_count) {
        printf("  groups              ");
        for (uint32_t i = 0; i < c->lines.group_count; i++)
            printf("%s%s (%u)", i ? ", " : "", c->lines.groups[i].name,
                   c->lines.groups[i].line_count);
        printf("\n");
    }
}

static void print_volume(const entry *e) {
    const io_volume *v = &e->volume;
    double spacing[3], box[2][3];
    find_spacing(v, spacing);
    find_box(v, box);
    printf("%s\n  format              %s\n  voxels              %u x %u x %u of %g x %g x %g mm\n",
           e->path, v->format, v->size[0], v->size[1], v->size[2], spacing[0], spacing[1],
           spacing[2]);
    printf("  box (mm)            %g %g %g .. %g %g %g\n", box[0][0], box[0][1], box[0][2],
           box[1][0], box[1][1], box[1][2]);
    if (v->frame_count > 1)
        printf("  frames              %u of %g ms (period %g ms)\n", v->frame_count, v->time_step,
               v->period);
    else
        printf("  frames              1 (steady)\n");
    printf("  speed               %g .. %g m/s%s\n", v->speed[0], v->speed[1],
           v->mask ? " inside the mask" : "");
    if (v->mask)
        printf("  mask                %llu voxels\n", (unsigned long long)v->mask_voxels);
    printf("  arrays              ");
    for (uint32_t i = 0; i < v->array_count; i++)
        printf("%s%s", i ? ", " : "", v->arrays[i]);
    printf("\n");
}

/* ---- command ---------------------------------------------------------------------------- */

static bool show(const cli_options *options, const entry *entries) {
    if (options->json) {
        cJSON *json = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(json, "files");
        for (uint32_t i = 0; i < options->file_count; i++)
            cJSON_AddItemToArray(list, entries[i].volume.size[0] ? describe_volume(&entries[i])
                                                                 : describe(&entries[i]));
        return cli_write_json(NULL, json);
    }
    for (uint32_t i = 0; i < options->file_count; i++)
        (entries[i].volume.size[0] ? print_volume : print)(&entries[i]);
    for (uint32_t i = 0; i < options->file_count; i++) {
        for (uint32_t w = 0; w < entries[i].warning_count; w++)
            cli_warn(entries[i].path, entries[i].warnings[w]);
    }
    return fflush(stdout) == 0 || cli_fail("standard output cannot be written");
}

/* Nothing is printed unless every file can be read. */
int cli_info(const cli_options *options) {
    entry *entries = calloc(options->file_count, sizeof *entries);
    bool ok = entries != NULL;
    if (!ok)
        cli_fail("out of memory");
    for (uint32_t i = 0; ok && i < options->file_count; i++)
        ok = cli_count_volumes(&options->files[i], 1, 0)
                 ? gather_volume(options, &options->files[i], &entries[i])
                 : gather(&options->files[i], &entries[i]);
    ok = ok && show(options, entries);
    for (uint32_t i = 0; entries && i < options->file_count; i++) {
        io_volume_free(&entries[i].volume);
        io_contents_free(&entries[i].contents);
        io_vessel_free(&entries[i].vessel);
    }
    free(entries);
    return ok ? CLI_OK : CLI_FAILED;
}
