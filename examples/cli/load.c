#include "load.h"

#include "camera.h"
#include "context.h"
#include "flow.h"
#include "flow4d.h"
#include "report.h"
#include "scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- files ------------------------------------------------------------------------------ */

static bool on_progress(void *user, uint64_t done, uint64_t total) {
    cli_progress_show(user, done, total);
    return cli_interrupted();
}

bool cli_read_file(const cli_source *source, io_lines *out) {
    cli_progress progress = {"reading", source->path, -1};
    io_options options;
    memset(&options, 0, sizeof options);
    options.every = source->every;
    options.min_length = (float)source->min_length;
    options.bundle = source->bundle;
    options.progress = on_progress;
    options.user = &progress;
    io_error error;
    bool ok = io_read_lines(source->path, &options, out, &error);
    cli_progress_end(&progress);
    if (!ok)
        return cli_interrupted() ? cli_go_on() : cli_fail("%s: %s", source->path, error.text);
    if (!cli_go_on()) {
        io_lines_free(out);
        return false;
    }
    return true;
}

/* ---- embedded scenes -------------------------------------------------------------------- */

static bool add_attribute(io_lines *lines, const char *name, float **data) {
    io_attribute *attribute = &lines->point_attributes[lines->point_attribute_count];
    if (!*data)
        return true;
    attribute->name = cli_new(strlen(name) + 1, 1);
    if (!attribute->name)
        return false;
    strcpy(attribute->name, name);
    attribute->components = 1;
    attribute->data = *data;
    *data = NULL; /* moved */
    lines->point_attribute_count++;
    return true;
}

/* Moves the arrays of a scene to where those of a file would be. */
static bool adopt(scene_lines *scene, io_lines *lines) {
    memset(lines, 0, sizeof *lines);
    lines->format = "scene";
    lines->unit = "mm";
    lines->line_count = scene->line_count;
    lines->point_count = scene->point_count;
    lines->offsets = scene->offsets;
    lines->points = scene->points;
    scene->offsets = NULL;
    scene->points = NULL;
    lines->point_attributes = calloc(2, sizeof *lines->point_attributes);
    if (!lines->point_attributes)
        return cli_fail("out of memory");
    return add_attribute(lines, "time", &scene->times) &&
           add_attribute(lines, "speed", &scene->values);
}

static bool load_embedded(const cli_options *options, cli_set *set, cli_scene *out) {
    scene_lines scene;
    uint32_t count;
    set->name = options->scene ? options->scene : scene_names(&count)[0];
    if (!scene_make(set->name, options->lines, 0, &scene))
        return cli_fail("%s: out of memory; ask for fewer --lines", set->name);
    if (!(set->settings.set & LAO_SET(width))) {
        set->settings.width = scene.width;
        set->settings.set |= LAO_SET(width);
    }
    memcpy(out->direction, scene.view_direction, sizeof out->direction);
    memcpy(out->up, scene.up, sizeof out->up);
    bool ok = adopt(&scene, &set->lines) &&
              (!options->backdrop || cli_context_keep_embedded(out, set->name));
    scene_free(&scene);
    return ok && cli_go_on();
}

/* ---- sets ------------------------------------------------------------------------------- */

/* Expresses the points of a set around the common origin. */
static void move_origin(io_lines *lines, const double origin[3]) {
    for (int k = 0; k < 3; k++) {
        double shift = lines->origin[k] - origin[k];
        for (uint32_t i = 0; i < lines->point_count && shift != 0; i++)
            lines->points[3 * i + (uint32_t)k] =
                (float)(lines->points[3 * i + (uint32_t)k] + shift);
        lines->origin[k] = origin[k];
    }
}

static void find_times(cli_set *set, cli_scene *out) {
    for (uint32_t a = 0; a < set->lines.point_attribute_count && !set->times; a++) {
        const io_attribute *attribute = &set->lines.point_attributes[a];
        if (strcmp(attribute->name, "time") == 0 && attribute->components == 1)
            set->times = attribute->data;
    }
    for (uint32_t i = 0; set->times && i < set->lines.point_count; i++) {
        double time = set->times[i];
        if (!isfinite(time))
            continue;
        bool any = out->beat[0] <= out->beat[1];
        out->beat[0] = any && out->beat[0] < time ? out->beat[0] : time;
        out->beat[1] = any && out->beat[1] > time ? out->beat[1] : time;
    }
}

static bool load_traced(const cli_options *options, const cli_source *first, uint32_t count,
                        io_lines *lines, cli_scene *out) {
    io_volume volume;
    if (!cli_read_volume(options, first, count, false, &volume))
        return false;
    bool ok = cli_trace(options, first->path, &volume, lines);
    if (ok && options->backdrop) {
        flow4d_field field = cli_field_of(&volume);
        ok = cli_context_keep(out, &field);
    }
    io_volume_free(&volume);
    return ok && cli_go_on();
}

/* volumes: how many sources from `first` on are one volume; its look is that of the last. */
static bool load_set(const cli_options *options, const cli_source *first, uint32_t volumes,
                     cli_scene *out) {
    const cli_source *source = volumes ? first + volumes - 1 : first;
    cli_set *set = &out->sets[out->count];
    memset(set, 0, sizeof *set);
    set->source = source;
    set->name = first->path;
    set->settings = source->settings;
    out->count++; /* freed with the scene from here on */
    bool ok = volumes        ? load_traced(options, first, volumes, &set->lines, out)
              : source->path ? cli_read_file(source, &set->lines)
                             : load_embedded(options, set, out);
    if (!ok)
        return false;
    if (out->count == 1)
        memcpy(out->origin, set->lines.origin, sizeof out->origin);
    move_origin(&set->lines, out->origin);
    find_times(set, out);
    return true;
}

bool cli_scene_load(const cli_options *options, cli_scene *out) {
    uint32_t count = options->file_count ? options->file_count : 1;
    cli_scene scene;
    memset(&scene, 0, sizeof scene);
    scene.beat[0] = INFINITY;
    scene.beat[1] = -INFINITY;
    camera_view("iso", scene.direction, scene.up);
    scene.sets = cli_new(count, sizeof *scene.sets);
    if (!scene.sets)
        return false;
    const cli_source *sources = options->file_count ? options->files : &options->all;
    uint32_t any = 0;
    bool ok = true;
    for (uint32_t i = 0, volumes; ok && i < count; i += volumes ? volumes : 1) {
        volumes = cli_count_volumes(sources, count, i);
        any += volumes;
        ok = load_set(options, &sources[i], volumes, &scene);
    }
    if (ok && !any && options->flow_flag)
        ok = cli_fail("%s: is for velocity volumes, and no FILE is one", options->flow_flag);
    if (!ok || !cli_colour(&scene)) {
        cli_scene_free(&scene);
        return false;
    }
    if (scene.beat[0] > scene.beat[1])
        scene.beat[0] = scene.beat[1] = 0;
    if (options->view)
        camera_view(options->view, scene.direction, scene.up);
    *out = scene;
    return true;
}

void cli_scene_free(cli_scene *scene) {
    for (uint32_t i = 0; i < scene->count; i++) {
        io_lines_free(&scene->sets[i].lines);
        free(scene->sets[i].colors);
    }
    for (uint32_t i = 0; i < scene->volume_count; i++) {
        free(scene->volumes[i].fastest);
        free(scene->volumes[i].inside);
    }
    free(scene->volumes);
    free(scene->sets);
    memset(scene, 0, sizeof *scene);
}

void cli_scene_warn(const cli_scene *scene) {
    for (uint32_t i = 0; i < scene->count; i++) {
        for (uint32_t w = 0; w < scene->sets[i].lines.warning_count; w++)
            cli_warn(scene->sets[i].name, scene->sets[i].lines.warnings[w]);
    }
}
