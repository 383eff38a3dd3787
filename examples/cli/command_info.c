/* lineao info: what is in line files. */
#include "commands.h"
#include "dump.h"
#include "load.h"
#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- JSON ------------------------------------------------------------------------------- */

static void add_names(cJSON *array, const io_attribute *attributes, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        cJSON_AddItemToArray(array, cJSON_CreateString(attributes[i].name));
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
    cJSON *warnings = cJSON_AddArrayToObject(file, "warnings");
    for (uint32_t i = 0; i < lines->warning_count; i++)
        cJSON_AddItemToArray(warnings, cJSON_CreateString(lines->warnings[i]));
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

/* ---- command ---------------------------------------------------------------------------- */

static bool show(const cli_options *options, const io_lines *files) {
    if (options->json) {
        cJSON *json = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(json, "files");
        for (uint32_t i = 0; i < options->file_count; i++)
            cJSON_AddItemToArray(list, describe(options->files[i].path, &files[i]));
        return cli_write_json(NULL, json);
    }
    for (uint32_t i = 0; i < options->file_count; i++)
        print(options->files[i].path, &files[i]);
    for (uint32_t i = 0; i < options->file_count; i++) {
        for (uint32_t w = 0; w < files[i].warning_count; w++)
            cli_warn(options->files[i].path, files[i].warnings[w]);
    }
    return fflush(stdout) == 0 || cli_fail("standard output cannot be written");
}

/* Nothing is printed unless every file can be read. */
int cli_info(const cli_options *options) {
    io_lines *files = calloc(options->file_count, sizeof *files);
    bool ok = files != NULL;
    if (!ok)
        cli_fail("out of memory");
    for (uint32_t i = 0; ok && i < options->file_count; i++)
        ok = cli_read_file(&options->files[i], &files[i]);
    ok = ok && show(options, files);
    for (uint32_t i = 0; files && i < options->file_count; i++)
        io_lines_free(&files[i]);
    free(files);
    return ok ? CLI_OK : CLI_FAILED;
}
