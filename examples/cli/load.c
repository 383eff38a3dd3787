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

bool cli_read(const cli_source *source, unsigned wanted, io_contents *out) {
    cli_progress progress = {"reading", source->path, -1};
    io_options options;
    memset(&options, 0, sizeof options);
    options.every = source->every;
    options.min_length = (float)fmax(source->min_length, 0);
    options.bundle = source->bundle;
    options.unit = source->unit;
    options.progress = on_progress;
    options.user = &progress;
    io_error error;
    bool ok = io_read(source->path, wanted, &options, out, &error);
    cli_progress_end(&progress);
    if (!ok)
        return cli_interrupted() ? cli_go_on() : cli_fail("%s: %s", source->path, error.text);
    if (!cli_go_on()) {
        io_contents_free(out);
        return false;
    }
    return true;
}

bool cli_read_file(const cli_source *source, io_lines *out) {
    io_contents contents;
    bool ok = cli_read(source, IO_LINES, &contents);
    if (ok)
        *out = contents.lines;
    return ok;
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

static int by_value(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

float cli_usual_beta(const cli_set *set) {
    const io_lines *lines = &set->lines;
    float *last = cli_new(lines->line_count, sizeof *last), beta = 0;
    uint32_t count = 0;
    for (uint32_t i = 0; last && i < lines->line_count; i++) {
        float most = -INFINITY;
        for (uint32_t k = lines->offsets[i]; k < lines->offsets[i + 1]; k++)
            most = isfinite(set->times[k]) && set->times[k] > most ? set->times[k] : most;
        if (isfinite(most))
            last[count++] = most;
    }
    if (count > 0) {
        qsort(last, count, sizeof *last, by_value);
        beta = last[count / 2] + last[(count - 1) / 2];
    }
    free(last);
    return beta;
}

/* What --time and --frames ask of the sets: those that have times show trails, unless told how. */
static bool follow_time(const cli_options *options, cli_scene *scene) {
    bool asked = !isnan(options->time) || options->frames > 0, any = false;
    for (uint32_t i = 0; i < scene->count; i++) {
        cli_set *set = &scene->sets[i];
        lao_settings *s = &set->settings;
        bool told = (s->set & LAO_SET(trail)) || s->trail > 0;
        const lao_setting_row *beta = &lao_lines_module()->settings[LAO_SETTING_ID_highlight_beta];
        any = any || set->times;
        if (told && s->trail > 0 && !set->times)
            return cli_fail("%s: trail needs the point array 'time' (ms), which this set has not",
                            set->name);
        if (asked && !told && set->times)
            s->trail = LAO_TRAIL_TAPER;
        if (s->trail == LAO_TRAIL_HIGHLIGHT && !(s->highlight_beta > 0))
            s->highlight_beta = fminf(fmaxf(cli_usual_beta(set), beta->minimum), beta->maximum);
        if (!(scene->period > 0))
            scene->period = (double)s->period;
    }
    if (!(scene->period > 0))
        scene->period = scene->beat[1] - scene->beat[0];
    return any || !asked ||
           cli_fail("%s: %s needs the point array 'time' (ms), which no set has",
                    scene->sets[0].name, isnan(options->time) ? "--frames" : "--time");
}

static bool load_traced(const cli_options *options, const cli_source *first, uint32_t count,
                        cli_set *set, cli_scene *out) {
    io_volume volume;
    lao_settings *s = &set->settings;
    if (!cli_read_volume(options, first, count, false, &volume))
        return false;
    bool ok = cli_trace(options, set->source, set->name, &volume, &set->lines);
    if (!(s->set & LAO_SET(period)) && !(s->period > 0)) { /* its trails repeat as the blood does */
        s->period = (float)volume.period;
    }
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
    bool ok = volumes        ? load_traced(options, first, volumes, set, out)
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

static bool load_outline(const cli_options *options, cli_scene *scene) {
    cli_outline *out = &scene->outline;
    cli_source source = options->all;
    io_contents contents;
    if (!options->outline)
        return true;
    source.path = options->outline;
    source.unit = NULL;
    if (!cli_read(&source, IO_MESH, &contents))
        return false;
    io_mesh *mesh = &contents.mesh;
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
        mesh->positions[i] =
            (float)((double)mesh->positions[i] + mesh->origin[i % 3] - scene->origin[i % 3]);
    *out =
        (cli_outline){mesh->vertex_count, mesh->triangle_count, mesh->positions, mesh->triangles};
    mesh->positions = NULL; /* moved */
    mesh->triangles = NULL;
    io_contents_free(&contents);
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
    if (scene.beat[0] > scene.beat[1])
        scene.beat[0] = scene.beat[1] = 0;
    if (!ok || !follow_time(options, &scene) || !cli_colour(&scene) ||
        !load_outline(options, &scene)) {
        cli_scene_free(&scene);
        return false;
    }
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
    free(scene->outline.positions);
    free(scene->outline.triangles);
    free(scene->sets);
    memset(scene, 0, sizeof *scene);
}

cli_set *cli_scene_add(cli_scene *scene) {
    cli_set *sets = realloc(scene->sets, (scene->count + 1) * sizeof *sets);
    if (!sets) {
        cli_fail("out of memory");
        return NULL;
    }
    scene->sets = sets;
    memset(&sets[scene->count], 0, sizeof *sets);
    return &sets[scene->count++];
}

void cli_scene_warn(const cli_scene *scene) {
    for (uint32_t i = 0; i < scene->count; i++) {
        for (uint32_t w = 0; w < scene->sets[i].lines.warning_count; w++)
            cli_warn(scene->sets[i].name, scene->sets[i].lines.warnings[w]);
    }
}
