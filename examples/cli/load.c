#include "load.h"

#include "camera.h"
#include "context.h"
#include "flow.h"
#include "flow4d.h"
#include "report.h"
#include "scene.h"
#include "surface.h"
#include "vessel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- files ------------------------------------------------------------------------------ */

static bool on_progress(void *user, uint64_t done, uint64_t total) {
    cli_progress_show(user, done, total);
    return cli_interrupted();
}

/* Who reads what `vessel` and `surface` do not. */
static const char *other_command(const cli_source *source, unsigned wanted, const char *fault) {
    if (wanted != (IO_TREE | IO_MESH) || source->as)
        return "";
    if (io_is_volume(source->path))
        return "; it is a volume: lineao surface draws its wall and lineao flow traces its lines";
    return strstr(fault, "), not a ") ? "; lineao render draws it" : "";
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
        return cli_interrupted() ? cli_go_on()
                                 : cli_fail("%s: %s%s", source->path, error.text,
                                            other_command(source, wanted, error.text));
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
        if (set->object)
            continue;
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

/* The diagonal of the box around all points, mm. */
static double diagonal_of(const cli_scene *scene) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < scene->count; i++) {
        const io_lines *lines = &scene->sets[i].lines;
        for (size_t k = 0; k < 3 * (size_t)lines->point_count; k++) {
            double v = (double)lines->points[k];
            low[k % 3] = isfinite(v) ? fmin(low[k % 3], v) : low[k % 3];
            high[k % 3] = isfinite(v) ? fmax(high[k % 3], v) : high[k % 3];
        }
    }
    double sum = 0;
    for (int k = 0; k < 3 && high[k] >= low[k]; k++)
        sum += (high[k] - low[k]) * (high[k] - low[k]);
    return sqrt(sum);
}

enum { LEAST_WIDTHS = 6, MOST_WIDTHS = 2000, FITTING_WIDTHS = 300 };

/* A width in mm suits what is measured in mm. In a FILE of another unit, which few formats tell,
 * lines of that width are nothing but blots, or are not seen at all. */
static void fit_widths(cli_scene *scene) {
    double across = diagonal_of(scene);
    for (uint32_t i = 0; i < scene->count; i++) {
        cli_set *set = &scene->sets[i];
        lao_settings *s = &set->settings;
        double width = (double)lao_settings_filled(s).width, fit = across / FITTING_WIDTHS;
        char text[160];
        if (set->object || !set->source->path || (s->set & LAO_SET(width)) || !(across > 0) ||
            (across >= LEAST_WIDTHS * width && across <= MOST_WIDTHS * width))
            continue;
        snprintf(text, sizeof text,
                 "it is %.3g mm across, for which lines %g mm wide are too %s; they are %.2g mm "
                 "wide instead, unless --width tells",
                 across, width, fit < width ? "wide" : "thin", fit);
        cli_warn(set->name, text);
        if (!(s->set & LAO_SET(radius_step)))
            s->radius_step =
                fmaxf(lao_settings_filled(s).radius_step * (float)(fit / width), 0.01f);
        s->width = (float)fmin(fmax(fit, 1e-4), 1000);
        s->set |= LAO_SET(width) | LAO_SET(radius_step);
    }
}

/* ---- what a FILE is drawn as ------------------------------------------------------------ */

/* A set that is not yet filled. NULL: reported. */
static cli_set *add_set(const cli_source *source, const char *name, cli_scene *out) {
    cli_set *set = cli_scene_add(out);
    if (!set)
        return NULL;
    set->source = source;
    set->name = name;
    set->settings = source->settings;
    return set;
}

/* Puts the last set's lines about the scene's origin and into its time. */
static void place_lines(cli_scene *out) {
    cli_set *set = &out->sets[out->count - 1];
    if (out->count == 1)
        memcpy(out->origin, set->lines.origin, sizeof out->origin);
    move_origin(&set->lines, out->origin);
    find_times(set, out);
}

static bool add_lines(const cli_options *options, const cli_source *source, io_contents *contents,
                      cli_scene *out) {
    (void)options;
    if (source->unit)
        return cli_fail("--unit: is for trees, meshes and volumes, and %s is drawn as lines",
                        source->path);
    cli_set *set = add_set(source, source->path, out);
    if (!set)
        return false;
    set->lines = contents->lines;
    memset(&contents->lines, 0, sizeof contents->lines); /* moved */
    place_lines(out);
    return true;
}

/* An object that is not yet filled. NULL: reported. */
static cli_object *add_object(const cli_options *options, const cli_source *source,
                              cli_scene *out) {
    cli_object **objects = realloc(out->objects, (out->object_count + 1) * sizeof *objects);
    cli_object *object = objects ? calloc(1, sizeof *object) : NULL;
    if (objects)
        out->objects = objects;
    if (!object) {
        cli_fail("out of memory");
        return NULL;
    }
    object->options = *options;
    object->options.files = (cli_source *)(uintptr_t)source; /* is only read */
    object->options.file_count = 1;
    return out->objects[out->object_count++] = object;
}

static bool add_tree(const cli_options *options, const cli_source *source, io_contents *contents,
                     cli_scene *out) {
    const cli_place place = {contents, out->count ? out->origin : NULL};
    cli_object *object = add_object(options, source, out);
    if (!object || !(object->tree = cli_new(1, sizeof *object->tree)))
        return false;
    return cli_tree_load(&object->options, &place, 0, object->tree) &&
           cli_tree_prepare(object->tree) && cli_scene_join(out, &object->tree->scene);
}

/* Its --color is an array of its vertices. */
static bool add_wall(const cli_options *options, const cli_source *source, io_contents *contents,
                     cli_scene *out) {
    const cli_place place = {contents, out->count ? out->origin : NULL};
    cli_object *object = add_object(options, source, out);
    if (!object || !(object->wall = cli_new(1, sizeof *object->wall)))
        return false;
    object->options.surface.value = source->color;
    return cli_wall_load(&object->options, &place, object->wall) &&
           cli_scene_join(out, &object->wall->scene);
}

/* What --as names; without it the first that the content of a FILE makes. */
typedef struct kind_row {
    const char *name;
    unsigned content; /* what it can be made of: IO_LINES, ... */
    bool (*add)(const cli_options *options, const cli_source *source, io_contents *contents,
                cli_scene *out);
} kind_row;
static const kind_row kinds[] = {
    {"lines", IO_LINES, add_lines},
    {"tree", IO_TREE, add_tree},
    {"surface", IO_MESH | IO_TREE, add_wall},
};

static const kind_row *kind_of(const cli_source *source, unsigned content) {
    const kind_row *row = kinds;
    while (source->as ? strcmp(source->as, row->name) != 0 : !(row->content & content))
        row++;
    return row;
}

/* What else the file holds is left out, and what was said of it. */
static bool read_kind(const cli_source *source, const kind_row **row, io_contents *contents) {
    unsigned wanted = source->as ? kind_of(source, 0)->content : (unsigned)IO_ANYTHING;
    if (!cli_read(source, wanted, contents))
        return false;
    *row = kind_of(source, contents->kinds);
    if (!(contents->kinds & ~(*row)->content))
        return true;
    io_contents_free(contents);
    return cli_read(source, (*row)->content, contents);
}

static bool load_file(const cli_options *options, const cli_source *source, cli_scene *out) {
    const kind_row *row;
    io_contents contents;
    if (!read_kind(source, &row, &contents))
        return false;
    bool ok = row->add(options, source, &contents, out);
    io_contents_free(&contents);
    return ok && cli_go_on();
}

static bool load_embedded(const cli_options *options, const cli_source *source, cli_scene *out) {
    scene_lines scene;
    uint32_t count;
    const char *name = options->scene ? options->scene : scene_names(&count)[0];
    cli_set *set = add_set(source, name, out);
    if (!set)
        return false;
    if (!scene_make(name, options->lines, 0, &scene))
        return cli_fail("%s: out of memory; ask for fewer --lines", name);
    if (!(set->settings.set & LAO_SET(width))) {
        set->settings.width = scene.width;
        set->settings.set |= LAO_SET(width);
    }
    memcpy(out->direction, scene.view_direction, sizeof out->direction);
    memcpy(out->up, scene.up, sizeof out->up);
    bool ok =
        adopt(&scene, &set->lines) && (!options->backdrop || cli_context_keep_embedded(out, name));
    scene_free(&scene);
    place_lines(out);
    return ok && cli_go_on();
}

/* `count` sources from the first on are one volume; its look is that of the last. */
static bool load_volume(const cli_options *options, const cli_source *first, uint32_t count,
                        cli_scene *out) {
    io_volume volume;
    cli_options own = *options;
    const cli_source *source = first + count - 1;
    own.flow.unit = options->flow.unit ? options->flow.unit : source->unit;
    if (source->as && strcmp(source->as, "lines") != 0)
        return cli_fail("--as: %s is a velocity volume, which is drawn as lines; lineao surface "
                        "draws its wall",
                        first->path);
    cli_set *set = add_set(source, first->path, out);
    if (!set || !cli_read_volume(&own, first, count, false, &volume))
        return false;
    lao_settings *s = &set->settings;
    bool ok = cli_trace(options, source, set->name, &volume, &set->lines);
    if (!(s->set & LAO_SET(period)) && !(s->period > 0)) { /* its trails repeat as the blood does */
        s->period = (float)volume.period;
    }
    if (ok && options->backdrop) {
        flow4d_field field = cli_field_of(&volume);
        ok = cli_context_keep(out, &field);
    }
    io_volume_free(&volume);
    if (ok)
        place_lines(out);
    return ok && cli_go_on();
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

/* Sets of lines stand first: what belongs to the whole picture is the first set's. */
static bool sort_sets(cli_scene *scene) {
    cli_set *sorted = cli_new(scene->count, sizeof *sorted);
    uint32_t done = 0;
    for (int pass = 0; sorted && pass < 2; pass++) {
        for (uint32_t i = 0; i < scene->count; i++) {
            if ((scene->sets[i].object != NULL) == (pass == 1))
                sorted[done++] = scene->sets[i];
        }
    }
    if (!sorted)
        return false;
    free(scene->sets);
    scene->sets = sorted;
    return true;
}

/* All FILEs, or the embedded scene. */
static bool load_all(const cli_options *options, cli_scene *scene) {
    uint32_t any = 0;
    if (!options->file_count && !load_embedded(options, &options->all, scene))
        return false;
    for (uint32_t i = 0, volumes; i < options->file_count; i += volumes ? volumes : 1) {
        volumes = cli_count_volumes(options->files, options->file_count, i);
        any += volumes;
        if (!(volumes ? load_volume(options, &options->files[i], volumes, scene)
                      : load_file(options, &options->files[i], scene)))
            return false;
    }
    return any || !options->flow_flag ||
           cli_fail("%s: is for velocity volumes, and no FILE is one", options->flow_flag);
}

bool cli_scene_load(const cli_options *options, cli_scene *out) {
    cli_scene scene;
    memset(&scene, 0, sizeof scene);
    scene.beat[0] = INFINITY;
    scene.beat[1] = -INFINITY;
    camera_view("iso", scene.direction, scene.up);
    bool ok = load_all(options, &scene) && sort_sets(&scene);
    if (scene.beat[0] > scene.beat[1])
        scene.beat[0] = scene.beat[1] = 0;
    if (!ok || !follow_time(options, &scene) || !cli_colour(&scene) ||
        !load_outline(options, &scene)) {
        cli_scene_free(&scene);
        return false;
    }
    fit_widths(&scene);
    if (options->view)
        camera_view(options->view, scene.direction, scene.up);
    *out = scene;
    return true;
}

static void free_object(cli_object *object) {
    if (object->tree)
        cli_tree_free(object->tree);
    if (object->wall)
        cli_wall_free(object->wall);
    free(object->tree);
    free(object->wall);
    free(object);
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
    for (uint32_t i = 0; i < scene->object_count; i++)
        free_object(scene->objects[i]);
    free(scene->objects);
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

/* Where a module stands among those of a scene, which it joins. */
static uint32_t use_module(cli_scene *scene, const lao_module *module) {
    uint32_t i = 0;
    while (i < scene->module_count && scene->modules[i] != module)
        i++;
    if (i == scene->module_count)
        scene->modules[scene->module_count++] = module;
    return i;
}

bool cli_scene_join(cli_scene *scene, cli_scene *part) {
    if (!scene->count)
        memcpy(scene->origin, part->origin, sizeof scene->origin);
    for (uint32_t i = 0; i < part->count; i++) {
        cli_set *from = &part->sets[i], *to = cli_scene_add(scene);
        if (!to)
            return false;
        *to = *from;
        memset(to->module_settings, 0, sizeof to->module_settings);
        for (uint32_t m = 0; m < part->module_count; m++)
            /* the scene that grew is another: NOLINTNEXTLINE(clang-analyzer-unix.Malloc) */
            to->module_settings[use_module(scene, part->modules[m])] = from->module_settings[m];
        memset(from, 0, sizeof *from); /* moved */
    }
    free(part->sets);
    part->sets = NULL;
    part->count = 0;
    return true;
}

void cli_scene_warn(const cli_scene *scene) {
    char text[512];
    for (uint32_t i = 0; i < scene->count; i++) {
        const cli_set *set = &scene->sets[i];
        if (!set->object && !set->overlay && set->lines.point_count == 0)
            cli_warn(set->name, "there are no lines to draw");
        for (uint32_t w = 0; w < scene->sets[i].lines.warning_count; w++)
            cli_warn(scene->sets[i].name, scene->sets[i].lines.warnings[w]);
    }
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const cli_object *o = scene->objects[i];
        for (uint32_t w = 0; o->tree && cli_tree_warning(o->tree, w, text, sizeof text); w++)
            cli_warn(o->tree->name, text);
        for (uint32_t w = 0; o->wall && cli_wall_warning(o->wall, w, text, sizeof text); w++)
            cli_warn(o->wall->name, text);
    }
}
