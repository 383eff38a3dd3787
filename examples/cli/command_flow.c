/* lineao flow: pathlines from velocity volumes. */
#include "commands.h"
#include "dump.h"
#include "flow.h"
#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool report(const cli_options *options, const io_volume *volume, const io_lines *lines,
                   double seconds) {
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "out", options->out);
    cJSON_AddNumberToObject(json, "lines", lines->line_count);
    cJSON_AddNumberToObject(json, "points", lines->point_count);
    cJSON *box = lines->point_count ? cJSON_CreateArray() : cJSON_CreateNull();
    for (int i = 0; i < 2 && lines->point_count; i++)
        cJSON_AddItemToArray(box, cJSON_CreateDoubleArray(lines->bounds[i], 3));
    cJSON_AddItemToObject(json, "bbox", box);
    cJSON_AddNumberToObject(json, "seconds", seconds);
    cJSON_AddStringToObject(json, "format", volume->format);
    cJSON_AddNumberToObject(json, "frames", volume->frame_count);
    cJSON_AddNumberToObject(json, "period", volume->period);
    cJSON_AddBoolToObject(json, "streamlines",
                          options->flow.streamlines || volume->frame_count == 1);
    cJSON_AddNumberToObject(json, "mask_voxels", (double)volume->mask_voxels);
    cJSON *attributes = cJSON_AddArrayToObject(json, "attributes");
    for (uint32_t i = 0; i < lines->point_attribute_count; i++)
        cJSON_AddItemToArray(attributes, cJSON_CreateString(lines->point_attributes[i].name));
    cJSON *warnings = cJSON_AddArrayToObject(json, "warnings");
    for (uint32_t i = 0; i < lines->warning_count; i++)
        cJSON_AddItemToArray(warnings, cJSON_CreateString(lines->warnings[i]));
    return cli_write_json(NULL, json);
}

static bool write_lines(const char *path, const io_lines *lines) {
    io_error error;
    return cli_go_on() &&
           (io_write_lines(path, lines, &error) || cli_fail("%s: %s", path, error.text));
}

static bool finish(const cli_options *options, const io_volume *volume, const io_lines *lines,
                   double seconds) {
    const char *name = options->files[0].path;
    if (!write_lines(options->out, lines))
        return false;
    if (options->json)
        return report(options, volume, lines, seconds);
    for (uint32_t i = 0; i < lines->warning_count; i++)
        cli_warn(name, lines->warnings[i]);
    return true;
}

int cli_flow(const cli_options *options) {
    double begin = now();
    io_volume volume;
    io_lines lines;
    if (!cli_writable(options->out) ||
        !cli_read_volume(options, options->files, options->file_count, false, &volume))
        return CLI_FAILED;
    const cli_source *last = &options->files[options->file_count - 1]; /* whose flags come last */
    bool ok = cli_trace(options, last, options->files[0].path, &volume, &lines);
    if (ok) {
        ok = finish(options, &volume, &lines, now() - begin);
        io_lines_free(&lines);
    }
    io_volume_free(&volume);
    return ok ? CLI_OK : CLI_FAILED;
}
