/* lineao info: what is in line files and velocity volumes. */
#include "commands.h"
#include "dump.h"
#include "flow.h"
#include "load.h"
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct info { /* of one FILE: a volume where size[0] is not 0 */
    io_lines lines;
    io_volume volume;
} info;

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

/* ---- JSON ------------------------------------------------------------------------------- */

static void add_names(cJSON *array, const io_attribute *attributes, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        cJSON_AddItemToArray(array, cJSON_CreateString(attributes[i].name));
}

static void add_texts(cJSON *array, char *const *texts, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        cJSON_AddItemToArray(array, cJSON_CreateString(texts[i]));
}

static cJSON *describe(const char *path, const io_lines *lines) {
    cJSON *file = cJSON_CreateObject();
    cJSON_AddStringToObject(file, "path", path);
    cJSON_AddStringToObject(file, "format", lines->format);
    cJSON_AddNumberToObject(file, "lines", lines->line_count);
    cJSON_AddNumberToObject(file, "points", lines->point_count);
    cJSON *box = lines->point_count ? cJSON_CreateArray() : cJSON_CreateNull();
    for (int i = 0; i < 2 && lines->point_count; i++)
        cJSON_AddItemToArray(box, cJSON_CreateDoubleArray(lines->bounds[i], 3));
    cJSON_AddItemToObject(file, "bbox", box);
    cJSON *attributes = cJSON_AddArrayToObject(file, "attributes"); /* of points, then of lines */
    add_names(attributes, lines->point_attributes, lines->point_attribute_count);
    add_names(attributes, lines->line_attributes, lines->line_attribute_count);
    add_names(cJSON_AddArrayToObject(file, "line_attributes"), lines->line_attributes,
              lines->line_attribute_count);
    cJSON *groups = cJSON_AddArrayToObject(file, "groups");
    for (uint32_t i = 0; i < lines->group_count; i++)
        cJSON_AddItemToArray(groups, cJSON_CreateString(lines->groups[i].name));
    cJSON_AddStringToObject(file, "unit", lines->unit);
    add_texts(cJSON_AddArrayToObject(file, "warnings"), lines->warnings, lines->warning_count);
    return file;
}

static cJSON *describe_volume(const char *path, const io_volume *v) {
    const double size[3] = {v->size[0], v->size[1], v->size[2]};
    double spacing[3], box[2][3];
    find_spacing(v, spacing);
    find_box(v, box);
    cJSON *file = cJSON_CreateObject();
    cJSON_AddStringToObject(file, "path", path);
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
    add_texts(cJSON_AddArrayToObject(file, "warnings"), v->warnings, v->warning_count);
    return file;
}

/* ---- text ------------------------------------------------------------------------------- */

static void print_attributes(const char *of, const io_attribute *attributes, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        printf("%s%s", i ? ", " : "", attributes[i].name);
        if (attributes[i].components > 1)
            printf("[%u]", attributes[i].components);
    }
    if (count)
        printf(" (per %s)", of);
}

static void print(const char *path, const io_lines *lines) {
    const double *low = lines->bounds[0], *high = lines->bounds[1];
    printf("%s\n  format      %s\n  lines       %u\n  points      %u\n", path, lines->format,
           lines->line_count, lines->point_count);
    if (lines->point_count) {
        printf("  box (%s)    %g %g %g .. %g %g %g\n", lines->unit, low[0], low[1], low[2], high[0],
               high[1], high[2]);
    }
    if (lines->point_attribute_count + lines->line_attribute_count > 0) {
        printf("  attributes  ");
        print_attributes("point", lines->point_attributes, lines->point_attribute_count);
        if (lines->point_attribute_count && lines->line_attribute_count)
            printf(", ");
        print_attributes("line", lines->line_attributes, lines->line_attribute_count);
        printf("\n");
    }
    if (lines->group_count) {
        printf("  groups      ");
        for (uint32_t i = 0; i < lines->group_count; i++)
            printf("%s%s (%u)", i ? ", " : "", lines->groups[i].name, lines->groups[i].line_count);
        printf("\n");
    }
}

static void print_volume(const char *path, const io_volume *v) {
    double spacing[3], box[2][3];
    find_spacing(v, spacing);
    find_box(v, box);
    printf("%s\n  format      %s\n  voxels      %u x %u x %u of %g x %g x %g mm\n", path, v->format,
           v->size[0], v->size[1], v->size[2], spacing[0], spacing[1], spacing[2]);
    printf("  box (mm)    %g %g %g .. %g %g %g\n", box[0][0], box[0][1], box[0][2], box[1][0],
           box[1][1], box[1][2]);
    if (v->frame_count > 1)
        printf("  frames      %u of %g ms (period %g ms)\n", v->frame_count, v->time_step,
               v->period);
    else
        printf("  frames      1 (steady)\n");
    printf("  speed       %g .. %g m/s%s\n", v->speed[0], v->speed[1],
           v->mask ? " inside the mask" : "");
    if (v->mask)
        printf("  mask        %llu voxels\n", (unsigned long long)v->mask_voxels);
    printf("  arrays      ");
    for (uint32_t i = 0; i < v->array_count; i++)
        printf("%s%s", i ? ", " : "", v->arrays[i]);
    printf("\n");
}

static void print_warnings(const char *path, char *const *warnings, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        cli_warn(path, warnings[i]);
}

/* ---- command ---------------------------------------------------------------------------- */

static bool show(const cli_options *options, const info *files) {
    if (options->json) {
        cJSON *json = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(json, "files");
        for (uint32_t i = 0; i < options->file_count; i++)
            cJSON_AddItemToArray(list,
                                 files[i].volume.size[0]
                                     ? describe_volume(options->files[i].path, &files[i].volume)
                                     : describe(options->files[i].path, &files[i].lines));
        return cli_write_json(NULL, json);
    }
    for (uint32_t i = 0; i < options->file_count; i++) {
        if (files[i].volume.size[0])
            print_volume(options->files[i].path, &files[i].volume);
        else
            print(options->files[i].path, &files[i].lines);
    }
    for (uint32_t i = 0; i < options->file_count; i++) {
        const char *path = options->files[i].path;
        print_warnings(path, files[i].lines.warnings, files[i].lines.warning_count);
        print_warnings(path, files[i].volume.warnings, files[i].volume.warning_count);
    }
    return fflush(stdout) == 0 || cli_fail("standard output cannot be written");
}

/* Each file for itself, also those that are one frame or component of a volume. */
static bool read(const cli_options *options, uint32_t i, info *out) {
    const cli_source *source = &options->files[i];
    if (cli_count_volumes(source, 1, 0))
        return cli_read_volume(options, source, 1, true, &out->volume);
    return cli_read_file(source, &out->lines);
}

/* Nothing is printed unless every file can be read. */
int cli_info(const cli_options *options) {
    info *files = calloc(options->file_count, sizeof *files);
    bool ok = files != NULL;
    if (!ok)
        cli_fail("out of memory");
    for (uint32_t i = 0; ok && i < options->file_count; i++)
        ok = read(options, i, &files[i]);
    ok = ok && show(options, files);
    for (uint32_t i = 0; files && i < options->file_count; i++) {
        io_lines_free(&files[i].lines);
        io_volume_free(&files[i].volume);
    }
    free(files);
    return ok ? CLI_OK : CLI_FAILED;
}
