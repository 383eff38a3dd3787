#include "surface.h"

#include "camera.h"
#include "io_volume.h"
#include "legends.h"
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Embedded surfaces that have a flow, with lines few enough to see the wall behind them. */
typedef struct embedded {
    const char *surface, *lines; /* scenes */
    uint32_t line_count;
    float width; /* mm */
} embedded;
static const embedded embedded_flows[] = {{"aorta", "flow", 150, 1},
                                          {"aneurysm", "aneurysm", 160, 0.3f}};

static bool no_lines(const cli_options *options) {
    return options->surface.lines && strcmp(options->surface.lines, "none") == 0;
}

static const embedded *find_flow(const cli_options *options) {
    const char *name = options->scene ? options->scene : "aorta";
    bool any = options->file_count == 0 && !no_lines(options);
    for (size_t i = 0; any && i < sizeof embedded_flows / sizeof *embedded_flows; i++) {
        if (strcmp(name, embedded_flows[i].surface) == 0)
            return &embedded_flows[i];
    }
    return NULL;
}

bool cli_wall_has_lines(const cli_options *options) {
    return find_flow(options) || (options->surface.lines && !no_lines(options));
}

/* One line per failure; warnings are in the mesh. */
static void on_log(void *user, vsf_log_item item, lao_result result, const char *text) {
    const cli_wall *wall = user;
    if (result != LAO_OK && item == VSF_LOG_CANCELLED)
        cli_go_on();
    else if (result != LAO_OK)
        cli_fail("%s: %s", wall->name, text);
}

/* ---- memory ------------------------------------------------------------------------------ */

static void *allocate(void *user, size_t size) {
    (void)user;
    return malloc(size);
}

/* Distances that are still shown while others are measured go when those are shown. */
static void release(void *user, void *memory, size_t size) {
    cli_wall *wall = user;
    const char *values = wall->near.values, *first = memory;
    if (wall->lit && values >= first && values < first + size)
        wall->kept = memory;
    else
        free(memory);
}

/* ---- lines ------------------------------------------------------------------------------ */

/* The speed of a point (m/s) by the array of that name, or by the length of "velocity". */
static double speed_at(const io_attribute *array, uint32_t point) {
    const float *v = array->data + (size_t)point * array->components;
    double sum = 0;
    for (uint32_t k = 0; k < array->components; k++)
        sum += (double)v[k] * (double)v[k];
    return sqrt(sum);
}

/* Times of a line's points: how long the blood takes to them from the first one. Behind a point
 * where it stands still they are no numbers. */
static void time_line(const io_lines *lines, const io_attribute *array, uint32_t line,
                      float *times) {
    double time = 0;
    for (uint32_t i = lines->offsets[line]; i < lines->offsets[line + 1]; i++) {
        const float *p = lines->points + 3 * (size_t)i;
        if (i > lines->offsets[line]) {
            double way = hypot(hypot((double)p[0] - (double)p[-3], (double)p[1] - (double)p[-2]),
                               (double)p[2] - (double)p[-1]);
            double speed = 0.5 * (speed_at(array, i - 1) + speed_at(array, i));
            time = speed > 0 ? time + way / speed : (double)NAN; /* mm / (m/s) = ms */
        }
        times[i] = (float)time;
    }
}

/* The scene's time for lines that begin at 0. */
static void run_from_zero(cli_scene *scene, const cli_set *set) {
    scene->beat[0] = scene->beat[1] = 0;
    for (uint32_t i = 0; i < set->lines.point_count; i++)
        scene->beat[1] = fmax(scene->beat[1], isfinite(set->times[i]) ? (double)set->times[i] : 0);
    scene->period = scene->beat[1];
}

/* Steady lines without times get them from their speed. False: reported. */
static bool make_times(cli_scene *scene, cli_set *set) {
    io_lines *lines = &set->lines;
    const io_attribute *array = NULL;
    for (uint32_t i = 0; i < lines->point_attribute_count; i++) {
        const char *name = lines->point_attributes[i].name;
        if (strcmp(name, "speed") == 0 || strcmp(name, "velocity") == 0)
            array = &lines->point_attributes[i];
    }
    if (set->times || !array)
        return true;
    io_attribute made = {cli_new(sizeof "time", 1), 1, cli_new(lines->point_count, sizeof(float))};
    io_attribute *rows = NULL;
    if (made.name && made.data) {
        strcpy(made.name, "time");
        for (uint32_t line = 0; line < lines->line_count; line++)
            time_line(lines, array, line, made.data);
        rows = realloc(lines->point_attributes, (lines->point_attribute_count + 1) * sizeof *rows);
    }
    if (!rows) {
        free(made.name);
        free(made.data);
        return cli_fail("out of memory");
    }
    lines->point_attributes = rows;
    rows[lines->point_attribute_count++] = made;
    set->times = made.data;
    run_from_zero(scene, set);
    return true;
}

/* What the options ask for as `render` would load it: the lines of a file, of a velocity volume
 * with its mask, which becomes the mesh, or of the embedded flow. */
static bool load_flow(cli_wall *wall, bool volume, const embedded *flow) {
    cli_options options = *wall->options;
    cli_source *source = &wall->line_source;
    *source = *wall->source;
    if (volume) {
        options.backdrop = true; /* keeps the mask */
        options.flow.unit = source->unit;
        return cli_scene_load(&options, &wall->scene);
    }
    source->path = wall->options->surface.lines;
    source->unit = NULL;
    options.files = source;
    options.file_count = source->path ? 1 : 0;
    options.time = NAN; /* times may be made below */
    options.frames = 0;
    options.scene = flow ? flow->lines : NULL;
    options.lines = flow ? flow->line_count : 0;
    if (!source->path && !source->color)
        source->color = "speed"; /* the embedded flow's */
    if (flow && !source->path && !(source->settings.set & LAO_SET(width))) {
        source->settings.width = flow->width;
        source->settings.set |= LAO_SET(width);
    }
    options.all = *source;
    return cli_scene_load(&options, &wall->scene) && make_times(&wall->scene, &wall->scene.sets[0]);
}

/* Streamlines of a steady flow run from their first point on, as L14's pathlines do. */
static void start_lines(cli_scene *scene, cli_set *set) {
    float *times = (float *)(uintptr_t)set->times; /* ours: an attribute of the set */
    for (uint32_t line = 0; line < set->lines.line_count; line++) {
        uint32_t first = set->lines.offsets[line], end = set->lines.offsets[line + 1];
        float start = first < end ? times[first] : 0;
        for (uint32_t i = first; i < end; i++)
            times[i] -= start;
    }
    run_from_zero(scene, set);
}

/* Lines are drawn where they are lit: as L14's highlight of whole lines but the dark parts do not
 * hide what is lit. */
static bool load_lines(cli_wall *wall) {
    bool volume = wall->source->path && io_is_volume(wall->source->path);
    if (!volume && !cli_wall_has_lines(wall->options))
        return true;
    if (!load_flow(wall, volume, find_flow(wall->options)))
        return false;
    cli_set *set = &wall->scene.sets[0];
    lao_settings *s = &set->settings;
    if (!volume) /* not our copy of the options */
        set->source = &wall->line_source;
    if (volume && !(s->period > 0))
        start_lines(&wall->scene, set);
    if (!(s->set & LAO_SET(trail)) && !(s->trail > 0))
        s->trail = LAO_TRAIL_TAPER;
    return true;
}

/* ---- values and distances --------------------------------------------------------------- */

/* --value: one number per vertex, and the values at both ends of its hues. */
static bool take_values(cli_wall *wall) {
    uint32_t n = wall->mesh.vertex_count;
    if (!wall->mesh.attribute_count)
        return true;
    const vsf_attribute *a = wall->mesh.attributes;
    uint32_t width = a->components ? a->components : 1;
    double *sorted = cli_new(n, sizeof *sorted);
    if (!sorted)
        return false;
    for (uint32_t i = 0; i < n; i++) {
        const float *v = a->values + (size_t)i * width;
        double sum = 0;
        for (uint32_t k = 0; k < width; k++)
            sum += (double)v[k] * (double)v[k];
        sorted[i] = width == 1 ? (double)v[0] : sqrt(sum);
        wall->object.values[i] = (float)sorted[i];
    }
    colour_range(sorted, n, wall->source->range, wall->range);
    free(sorted);
    wall->settings.near_source = VSF_NEAR_VALUE;
    wall->settings.value_low = (float)wall->range[0];
    wall->settings.value_high = (float)wall->range[1];
    wall->settings.set |= VSF_SET(near_source) | VSF_SET(value_low) | VSF_SET(value_high);
    return true;
}

static int by_value(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The median over the vertices of the greater of both curvatures, 1/mm. */
static bool find_curvature(cli_wall *wall) {
    uint32_t n = wall->mesh.vertex_count;
    float *curvatures = cli_new(n, 2 * sizeof *curvatures);
    bool ok = curvatures && vsf_curvatures(&wall->host, &wall->mesh, curvatures, NULL) == LAO_OK;
    for (uint32_t i = 0; ok && i < n; i++)
        curvatures[i] =
            fmaxf(fabsf(curvatures[2 * (size_t)i]), fabsf(curvatures[2 * (size_t)i + 1]));
    if (ok)
        qsort(curvatures, n, sizeof *curvatures, by_value);
    wall->curvature = ok ? fmax((double)curvatures[n / 2], 1e-6) : 0;
    free(curvatures);
    return ok;
}

/* Is the MESH nowhere near the size of a vessel, as one in another unit is? */
static bool is_odd_size(const cli_wall *wall) {
    const vsf_mesh_info *info = &wall->mesh.info;
    double across = sqrt(fmax(info->area, 0));
    return across < 1 || across > 3000;
}

/* --brightness auto: a silhouette of the median curvature gets three quarters of full opacity. That
 * is 1.5 mm, as L14's users liked best, where vessels have a radius of 2 mm. It is what trees and
 * masks get, and a MESH of which that length shows all or nothing. */
static bool find_brightness(cli_wall *wall) {
    double wanted = wall->options->surface.brightness;
    bool given = (wall->settings.set & VSF_SET(brightness)) != 0;
    if (wanted < 0 && (given || (wall->contents.kinds & IO_MESH && !is_odd_size(wall))))
        return true;
    if (!(wanted > 0) && !find_curvature(wall))
        return false;
    wall->settings.brightness = (float)(wanted > 0 ? wanted : 0.75 / wall->curvature);
    wall->settings.set |= VSF_SET(brightness);
    return true;
}

/* A table larger than this is kept in half floats. */
#define MOST_DISTANCES 250000000.0

/* The lines' settings that go by the distances. */
static void take_beta(cli_wall *wall) {
    lao_settings *s = &wall->scene.sets[1].settings;
    s->highlight_beta = (float)wall->near.beta;
    s->set |= LAO_SET(highlight_beta);
    if (wall->trails) {
        s->trail_length = (float)wall->near.reach;
        s->set |= LAO_SET(trail_length);
    }
}

static bool measure_distances(cli_wall *wall) {
    if (wall->scene.count < 2)
        return true;
    cli_set *set = &wall->scene.sets[1];
    lao_settings *s = &set->settings;
    float values[VSF_SETTING_COUNT];
    vsf_near_desc desc;
    if (!set->times)
        return cli_fail("%s: has no point array 'time' (ms), by which its lines are lit; of steady "
                        "lines 'speed' or 'velocity' (m/s) would do",
                        set->name);
    lao_settings_resolve(vsf_module(), &wall->settings, values);
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = wall->mesh.vertex_count;
    desc.positions = wall->mesh.positions;
    desc.line_count = set->lines.line_count;
    desc.point_count = set->lines.point_count;
    desc.offsets = set->lines.offsets;
    desc.points = set->lines.points;
    desc.times = set->times;
    desc.step_count = (uint32_t)values[VSF_SETTING_ID_near_steps];
    desc.period = (double)s->period;
    if (wall->line_source.settings.set & LAO_SET(highlight_beta))
        desc.beta = (double)wall->line_source.settings.highlight_beta;
    if ((double)desc.vertex_count * desc.step_count > MOST_DISTANCES)
        desc.flags = VSF_NEAR_HALF;
    wall->progress = (cli_progress){"measuring distances to", set->name, -1};
    wall->lit = vsf_near_make(&wall->host, &desc, &wall->near) == LAO_OK;
    cli_progress_end(&wall->progress);
    wall->trails = !(s->set & LAO_SET(trail_length));
    take_beta(wall);
    return wall->lit && cli_go_on();
}

bool cli_wall_measure(cli_wall *wall, double beta) {
    cli_threads *threads = cli_threads_start();
    cli_progress progress = {"measuring distances to", wall->scene.sets[1].name, -1};
    vsf_host host = wall->host;
    vsf_near next = wall->near;
    if (!threads)
        return false;
    host.job = cli_threads_job(threads, &progress);
    bool ok = vsf_near_update(&host, &next, beta) == LAO_OK;
    if (ok)
        wall->next = next;
    cli_progress_end(&progress);
    cli_threads_stop(threads);
    return ok;
}

bool cli_wall_relight(cli_wall *wall) {
    if (!wall->next.step_count)
        return false;
    wall->near = wall->next;
    memset(&wall->next, 0, sizeof wall->next);
    free(wall->kept);
    wall->kept = NULL;
    wall->object.step = VSF_NONE; /* what is uploaded is of the old ones */
    take_beta(wall);
    return true;
}

bool cli_wall_time(cli_wall *wall, double time, lao_object_desc *update) {
    float gamma = wall->settings.near_gamma;
    bool given = (wall->source->surface.set & VSF_SET(near_gamma)) != 0;
    if (!wall->lit)
        return false;
    bool changed = vsf_object_time(&wall->object, &wall->near, time, &wall->settings, update);
    if (given)
        wall->settings.near_gamma = gamma;
    return changed;
}

/* --wall-colormap: what is near is told by this map. */
static void take_map(cli_wall *wall) {
    const char *name = wall->options->surface.colormap;
    if (!name)
        return;
    colour_map_make(name, &wall->map); /* the flag's choices are its names */
    for (int i = 0; i < VSF_MAP_COLORS; i++) {
        double rgb[3];
        colour_map_at(&wall->map, i / (VSF_MAP_COLORS - 1.0), rgb);
        for (int k = 0; k < 3; k++)
            wall->object.map[4 * i + k] = (float)rgb[k];
    }
    wall->settings.near_colors = VSF_NEAR_MAP;
    wall->settings.set |= VSF_SET(near_colors);
}

/* ---- scene ------------------------------------------------------------------------------ */

/* A set for the surface before that of the lines. */
static bool add_set(cli_wall *wall) {
    cli_scene *scene = &wall->scene;
    cli_set *sets = cli_new(scene->count + 1u, sizeof *sets);
    if (!sets)
        return false;
    memset(sets, 0, sizeof *sets);
    if (scene->count)
        memcpy(sets + 1, scene->sets, scene->count * sizeof *sets);
    free(scene->sets);
    scene->sets = sets;
    scene->count++;
    scene->modules[scene->module_count++] = vsf_module();
    sets->source = wall->source;
    sets->name = wall->name;
    sets->settings = wall->source->settings;
    sets->settings.occlusion = 0; /* it has no lines */
    sets->settings.set |= LAO_SET(occlusion);
    for (uint32_t i = 0; i < scene->count; i++)
        sets[i].module_settings[0] = &wall->settings;
    return true;
}

static bool fill_set(cli_wall *wall) {
    cli_set *set = wall->scene.sets;
    io_lines *lines = &set->lines; /* points alone, which tell how far the surface reaches */
    set->object = &wall->object.desc;
    set->wall = wall;
    lines->points = cli_new(wall->mesh.vertex_count, 3 * sizeof *lines->points);
    if (!lines->points)
        return false;
    lines->point_count = wall->mesh.vertex_count;
    memcpy(lines->points, wall->mesh.positions, 12 * (size_t)lines->point_count);
    if (wall->options->view)
        camera_view(wall->options->view, wall->scene.direction, wall->scene.up);
    return true;
}

/* ---- what depends on the camera --------------------------------------------------------- */

void cli_wall_focus(cli_wall *wall, const cli_shot *shot) {
    const cli_surface_options *o = &wall->options->surface;
    const double *at = o->focus_at;
    double depth = -(double)shot->view[14];
    if (!o->focus_numbers)
        return;
    for (int k = 0; k < 3; k++)
        depth -= (double)shot->view[4 * k + 2] * (at[k] - wall->scene.origin[k]);
    wall->settings.focus = 1;
    wall->settings.focus_near = (float)(o->focus_numbers == 2 ? at[0] : depth - at[3]);
    wall->settings.focus_far = (float)(o->focus_numbers == 2 ? at[1] : depth + at[3]);
    wall->settings.set |= VSF_SET(focus) | VSF_SET(focus_near) | VSF_SET(focus_far);
}

void cli_wall_eye(const cli_shot *shot, float eye[4]) {
    lao_camera camera, canonical;
    lao_m4 view;
    memset(&camera, 0, sizeof camera);
    memcpy(camera.view, shot->view, sizeof shot->view);
    memcpy(camera.projection, shot->projection, sizeof shot->projection);
    camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    lao_camera_canonical(&camera, &canonical);
    memcpy(&view, canonical.view, sizeof view);
    lao_v4 e = vsf_eye(view, canonical.projection[15] > 0.5f ? 1.0f : 0.0f);
    memcpy(eye, &e, sizeof e);
}

/* A point, nearer to the eye by `way`. */
static void step_forward(const float *p, const float eye[4], double way, float *out) {
    double to[3], size = 0;
    for (int k = 0; k < 3; k++) {
        to[k] = (double)eye[k] - (eye[3] > 0 ? (double)p[k] : 0);
        size += to[k] * to[k];
    }
    for (int k = 0; k < 3; k++)
        out[k] = (float)((double)p[k] + way * to[k] / sqrt(size));
}

static double length_of(const float *points, uint32_t count) {
    double length = 0;
    for (uint32_t i = 3; i < 3 * count; i += 3) {
        double x = (double)points[i] - (double)points[i - 3];
        double y = (double)points[i + 1] - (double)points[i - 2];
        double z = (double)points[i + 2] - (double)points[i - 1];
        length += sqrt(x * x + y * y + z * z);
    }
    return length;
}

/* Evens a line's points between its ends out: zero sets zigzag from triangle to triangle. */
static void even_out(float *points, uint32_t count) {
    for (int pass = 0; pass < 6; pass++) {
        float before[3];
        memcpy(before, points, sizeof before);
        for (uint32_t i = 3; i + 3 < 3 * count; i++) {
            float here = points[i];
            points[i] = 0.25f * before[i % 3] + 0.5f * here + 0.25f * points[i + 3];
            before[i % 3] = here;
        }
    }
}

/* Of contours: flat ink. NULL: reported. */
static cli_set *add_ink(cli_wall *wall, double width) {
    static const float ink[4] = {0.1f, 0.1f, 0.12f, 1};
    cli_set *set = cli_scene_add(&wall->scene);
    if (!set)
        return NULL;
    lao_settings *s = &set->settings;
    set->source = wall->source;
    set->name = wall->name;
    set->module_settings[0] = &wall->settings;
    set->overlay = true;
    memcpy(set->color, ink, sizeof ink);
    s->width = (float)width;
    s->ambient = 1;
    s->set = LAO_SET(width) | LAO_SET(ambient) | LAO_SET(diffuse) | LAO_SET(specular) |
             LAO_SET(occlusion) | LAO_SET(halo);
    return set;
}

/* In place of what the set had, a line's width before the wall that it lies on. Shorter lines than
 * `least` (mm) are left out, and longer ones evened out if there is such a bound. */
static bool fill_contours(cli_set *set, const vsf_polylines *lines, const float eye[4],
                          double width, double least) {
    io_lines *out = &set->lines;
    io_lines_free(out);
    memset(out, 0, sizeof *out);
    out->offsets = cli_new(lines->line_count + 1u, sizeof *out->offsets);
    out->points = cli_new(lines->point_count, 3 * sizeof *out->points);
    if (!out->offsets || !out->points)
        return false;
    out->offsets[0] = 0;
    for (uint32_t line = 0; line < lines->line_count; line++) {
        uint32_t first = lines->offsets[line], count = lines->offsets[line + 1] - first;
        const float *points = lines->points + 3 * (size_t)first;
        if (length_of(points, count) < least)
            continue;
        for (uint32_t i = 0; i < count; i++)
            step_forward(points + 3 * (size_t)i, eye, width,
                         out->points + 3 * (size_t)out->point_count++);
        out->offsets[++out->line_count] = out->point_count;
        if (least > 0)
            even_out(out->points + 3 * (size_t)(out->point_count - count), count);
    }
    return true;
}

/* --contours, --suggestive-contours: a further set of lines. The latter, which ask for third
 * derivatives, are kept where they are steep and long enough to tell of a shape. */
static bool add_contours(cli_wall *wall, const float eye[4], vsf_feature feature) {
    const cli_surface_options *o = &wall->options->surface;
    bool suggestive = feature == VSF_SUGGESTIVE_CONTOURS;
    double width = o->contours[feature], threshold = 0, least = 0;
    vsf_polylines lines;
    if (!(width > 0))
        return true;
    if (suggestive) {
        if (!(wall->curvature > 0) && !find_curvature(wall))
            return false;
        least = o->threshold < 0 ? 1 / wall->curvature : 0;
        threshold = o->threshold < 0 ? 0.3 * wall->curvature * wall->curvature : o->threshold;
    }
    if (vsf_feature_lines(&wall->host, &wall->mesh, &wall->object.buffers, eye, feature,
                          (float)threshold, &lines) != LAO_OK)
        return false;
    uint32_t *at = &wall->contours[feature];
    cli_set *set = *at ? &wall->scene.sets[*at] : add_ink(wall, width);
    if (set)
        *at = (uint32_t)(set - wall->scene.sets);
    bool ok = set && fill_contours(set, &lines, eye, width, least);
    vsf_polylines_free(&lines);
    return ok;
}

bool cli_wall_aim(cli_wall *wall, const cli_shot *shot) {
    float eye[4];
    cli_wall_focus(wall, shot);
    cli_wall_eye(shot, eye);
    return add_contours(wall, eye, VSF_CONTOURS) &&
           add_contours(wall, eye, VSF_SUGGESTIVE_CONTOURS);
}

/* ---- legends ---------------------------------------------------------------------------- */

/* The hues of the look-up on the side of y. */
static void fill_hues(float y, colour_map *map) {
    for (int i = 0; i < COLOUR_STEPS; i++) {
        lao_v4 c = vsf_lookup((float)i / (COLOUR_STEPS - 1), y);
        map->rgb[i][0] = (double)c.x;
        map->rgb[i][1] = (double)c.y;
        map->rgb[i][2] = (double)c.z;
    }
}

uint32_t cli_wall_scales(cli_wall *wall, colour_map maps[2], char titles[2][160], legend out[2]) {
    bool value = wall->mesh.attribute_count > 0, map = wall->options->surface.colormap != NULL;
    bool any = (value || wall->lit) && !wall->options->surface.baseline;
    uint32_t count = !any ? 0 : map ? 1 : 2;
    const char *name = value ? wall->options->surface.value : "mm to flow";
    for (uint32_t i = 0; i < count; i++) {
        snprintf(titles[i], sizeof titles[i], "%s", i ? "concave" : name);
        if (!map)
            fill_hues(i ? -1.0f : 1.0f, &maps[i]);
        out[i] = (legend){map ? &wall->map : &maps[i], {wall->range[0], wall->range[1]}, titles[i]};
        if (!value) { /* what is near is at the end of the map */
            out[i].range[0] = (double)wall->settings.near_gamma;
            out[i].range[1] = 0;
        }
    }
    return count;
}

/* The wall's scales, then those of the scene: drawn into p, or only checked against a size. */
static bool with_legends(cli_wall *wall, picture *p, const uint32_t *size) {
    char titles[2][160];
    legend list[2];
    colour_map *maps = cli_new(2, sizeof *maps);
    uint32_t count = maps ? cli_wall_scales(wall, maps, titles, list) : 0;
    bool ok =
        maps && (p ? cli_legends_draw(wall->options, &wall->scene, list, count, p)
                   : cli_legends_check(wall->options, &wall->scene, list, count, size, wall->note));
    free(maps);
    return ok;
}

bool cli_wall_legends(void *user, picture *p) {
    return with_legends(user, p, NULL);
}

bool cli_wall_legends_check(cli_wall *wall, const cli_shot *shot) {
    const uint32_t size[2] = {shot->width, shot->height};
    return with_legends(wall, NULL, size);
}

/* ---- dumps and warnings ----------------------------------------------------------------- */

bool cli_wall_planes(void *user, cli_planes *planes) {
    static const char *const names[3] = {"position.X", "position.Y", "position.Z"};
    const cli_wall *wall = user;
    size_t count;
    const float *mask = cli_planes_find(planes, "mask.V", &count);
    for (int k = 0; k < 3; k++) {
        float *p = cli_planes_find(planes, names[k], &count);
        for (size_t i = 0; mask && p && i < count; i++)
            p[i] = mask[i] > 0 ? (float)((double)p[i] + wall->scene.origin[k]) : 0.0f;
    }
    return mask != NULL || cli_fail("the dump has no surface");
}

/* What this program did to the mesh. */
static bool own_warning(const cli_wall *wall, uint32_t i, char *text, size_t size) {
    if (wall->turned && i-- == 0)
        snprintf(text, size,
                 "it is open and seemed inside out, and was turned round; --flip off leaves it");
    else if (wall->widened && i-- == 0)
        snprintf(text, size,
                 "%u nodes have a radius below %.3g mm and were given that; --grid makes it less",
                 (unsigned)wall->widened, wall->thinnest);
    else if (wall->decimated && i == 0)
        snprintf(text, size,
                 "vertices were merged: %u of %u triangles are left; --triangles says how many",
                 (unsigned)wall->decimated_to, (unsigned)wall->decimated);
    else
        return false;
    return true;
}

bool cli_wall_warning(const cli_wall *wall, uint32_t i, char *text, size_t size) {
    const bool mesh = (wall->contents.kinds & IO_MESH) != 0;
    const io_mesh *triangles = &wall->contents.mesh;
    const io_tree *tree = &wall->contents.tree;
    const sdv_tree *built = &wall->vessel.tree;
    uint32_t read = mesh ? triangles->warning_count : tree->warning_count;
    if (i < read)
        snprintf(text, size, "%s", mesh ? triangles->warnings[i] : tree->warnings[i]);
    else if ((i -= read) < built->warning_count)
        sdv_tree_warning_text(built, i, text, size);
    else if ((i -= built->warning_count) < wall->mesh.warning_count)
        vsf_mesh_warning_text(&wall->mesh, i, text, size);
    else
        return own_warning(wall, i - wall->mesh.warning_count, text, size);
    return true;
}

/* ---- all -------------------------------------------------------------------------------- */

/* Unless told, as many layers as the mesh has need of. */
static void choose_layers(cli_wall *wall) {
    if (wall->settings.set & VSF_SET(layers))
        return;
    wall->settings.layers = (float)vsf_mesh_layers(&wall->mesh);
    wall->settings.set |= VSF_SET(layers);
}

static void take_settings(cli_wall *wall) {
    const char *baseline = wall->options->surface.baseline;
    wall->settings = wall->source->surface;
    if (baseline) {
        wall->settings.shading =
            strcmp(baseline, "fresnel") == 0 ? VSF_SHADING_FRESNEL : VSF_SHADING_TRANSPARENT;
        wall->settings.set |= VSF_SET(shading);
    }
    if (wall->options->dump) {
        wall->settings.surface_geometry = 1;
        wall->settings.set |= VSF_SET(surface_geometry);
    }
}

bool cli_wall_load(const cli_options *options, const cli_place *place, cli_wall *out) {
    memset(out, 0, sizeof *out);
    if (place) {
        out->contents = *place->contents;
        memset(place->contents, 0, sizeof *place->contents); /* moved */
    }
    out->options = options;
    out->source = options->file_count ? &options->files[0] : &options->all;
    out->name = out->source->path ? out->source->path : options->scene ? options->scene : "aorta";
    camera_view("iso", out->scene.direction, out->scene.up);
    out->threads = cli_threads_start();
    if (!out->threads)
        return false;
    out->progress = (cli_progress){"building", out->name, -1};
    out->host.job = cli_threads_job(out->threads, &out->progress);
    out->host.log = on_log;
    out->host.user = out;
    out->host.allocator = (lao_allocator){allocate, release, out};
    take_settings(out);
    bool ok = load_lines(out);
    out->placed = out->scene.count > 0 || (place && place->origin);
    if (place && place->origin)
        memcpy(out->scene.origin, place->origin, sizeof out->scene.origin);
    ok = ok && cli_wall_mesh(out) && find_brightness(out);
    cli_progress_end(&out->progress);
    if (ok)
        choose_layers(out);
    return ok && add_set(out) && measure_distances(out) &&
           vsf_object_make(&out->host, &out->mesh, 0, &out->object) == LAO_OK && take_values(out) &&
           fill_set(out) && (take_map(out), true);
}

void cli_wall_free(cli_wall *wall) {
    cli_wall_relight(wall);
    wall->lit = false; /* nothing is kept any more */
    cli_scene_free(&wall->scene);
    vsf_object_free(&wall->object);
    vsf_near_free(&wall->near);
    vsf_mesh_free(&wall->mesh);
    io_vessel_free(&wall->vessel);
    io_contents_free(&wall->contents);
    cli_threads_stop(wall->threads);
    memset(wall, 0, sizeof *wall);
}
