#include "surface.h"

#include "camera.h"
#include "report.h"
#include "scene_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Few enough to see the wall behind them. */
#define EMBEDDED_LINES 150
#define EMBEDDED_WIDTH 1
#define EMBEDDED_STEPS 20 /* of smoothing */

/* One line per failure; warnings are in the mesh. */
static void on_log(void *user, vsf_log_item item, lao_result result, const char *text) {
    const cli_wall *wall = user;
    if (result != LAO_OK && item == VSF_LOG_CANCELLED)
        cli_go_on();
    else if (result != LAO_OK)
        cli_fail("%s: %s", wall->name, text);
}

/* ---- lines ------------------------------------------------------------------------------ */

/* The lines as `render` would load them, drawn where they are lit: as L14's highlight of whole
 * lines but the dark parts do not hide what is lit. */
static bool load_lines(cli_wall *wall) {
    cli_options options = *wall->options;
    cli_source *source = &wall->line_source;
    bool flow = !wall->source->path && strcmp(wall->name, "aorta") == 0;
    if (!wall->options->surface.lines && !flow)
        return true;
    *source = *wall->source;
    source->path = wall->options->surface.lines;
    source->unit = NULL;
    if (!(source->settings.set & LAO_SET(trail)) && !(source->settings.trail > 0)) {
        source->settings.trail = LAO_TRAIL_TAPER;
        source->settings.set |= LAO_SET(trail);
    }
    options.files = source;
    options.file_count = source->path ? 1 : 0;
    options.scene = "flow";
    options.lines = EMBEDDED_LINES;
    if (!source->path && !source->color)
        source->color = "speed";
    if (!source->path && !(source->settings.set & LAO_SET(width))) {
        source->settings.width = EMBEDDED_WIDTH;
        source->settings.set |= LAO_SET(width);
    }
    options.all = *source;
    return cli_scene_load(&options, &wall->scene);
}

/* ---- mesh ------------------------------------------------------------------------------- */

static bool smooth(cli_wall *wall) {
    const cli_surface_options *o = &wall->options->surface;
    vsf_smooth_desc desc;
    vsf_mesh finer;
    memset(&desc, 0, sizeof desc);
    desc.steps = o->smooth;
    if (!wall->source->path && !o->smooth) { /* marching cubes left stairs */
        desc.steps = EMBEDDED_STEPS;
        desc.uniform = 1;
    }
    if (o->subdivide) {
        if (vsf_mesh_subdivide(&wall->host, &wall->mesh, o->subdivide, &finer) != LAO_OK)
            return false;
        finer.warning_count = wall->mesh.warning_count;
        memcpy(finer.warnings, wall->mesh.warnings, sizeof finer.warnings);
        vsf_mesh_free(&wall->mesh);
        wall->mesh = finer;
    }
    return !desc.steps || vsf_mesh_smooth(&wall->host, &wall->mesh, &desc) == LAO_OK;
}

static const io_attribute *find_array(const io_mesh *mesh, const char *name) {
    for (uint32_t i = 0; i < mesh->vertex_attribute_count; i++) {
        if (strcmp(mesh->vertex_attributes[i].name, name) == 0)
            return &mesh->vertex_attributes[i];
    }
    return NULL;
}

/* Do all parts, being open, seem to face inward? */
static bool is_inside_out(const vsf_mesh *mesh) {
    for (uint32_t i = 0; i < mesh->warning_count; i++) {
        if (mesh->warnings[i].item == VSF_LOG_PARTS_SUSPECT)
            return mesh->warnings[i].count == mesh->info.parts;
    }
    return false;
}

/* Builds the mesh, and once more the other way round where that is asked for or seems right. */
static bool build(cli_wall *wall, vsf_mesh_desc *desc) {
    const char *flip = wall->options->surface.flip;
    desc->flags = flip && strcmp(flip, "on") == 0 ? VSF_MESH_FLIP : 0;
    if (vsf_mesh_build(&wall->host, desc, &wall->mesh) != LAO_OK)
        return false;
    if (flip || !is_inside_out(&wall->mesh))
        return true;
    vsf_mesh_free(&wall->mesh);
    wall->turned = true;
    desc->flags = VSF_MESH_FLIP;
    return vsf_mesh_build(&wall->host, desc, &wall->mesh) == LAO_OK;
}

/* In mm, about scene.origin, which is the lines' if there are any. */
static bool read_mesh(cli_wall *wall) {
    const io_mesh *mesh = &wall->contents.mesh;
    const char *value = wall->options->surface.value;
    vsf_attribute attribute;
    vsf_mesh_desc desc;
    if (!cli_read(wall->source, IO_MESH, &wall->contents))
        return false;
    const io_attribute *array = value ? find_array(mesh, value) : NULL;
    if (value && !array)
        return cli_fail("%s: its vertices have no array '%s' for --value; lineao info lists them",
                        wall->name, value);
    float *positions = cli_new(mesh->vertex_count, 3 * sizeof *positions);
    if (!positions)
        return false;
    for (int k = 0; k < 3 && !wall->scene.count; k++)
        wall->scene.origin[k] = mesh->origin[k] * mesh->millimetres;
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
        positions[i] =
            (float)(((double)mesh->positions[i] + mesh->origin[i % 3]) * mesh->millimetres -
                    wall->scene.origin[i % 3]);
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = mesh->vertex_count;
    desc.positions = positions;
    desc.triangle_count = mesh->triangle_count;
    desc.triangles = mesh->triangles;
    desc.normals = wall->options->surface.normals ? mesh->normals : NULL;
    if (array) {
        attribute = (vsf_attribute){array->name, array->components, array->data};
        desc.attributes = &attribute;
        desc.attribute_count = 1;
    }
    bool ok = build(wall, &desc);
    free(positions);
    return ok;
}

static bool make_mesh(cli_wall *wall) {
    scene_surface surface;
    vsf_mesh_desc desc;
    if (!scene_surface_make(wall->name, 0, &surface))
        return cli_fail("%s: out of memory", wall->name);
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = surface.vertex_count;
    desc.positions = surface.positions;
    desc.triangle_count = surface.triangle_count;
    desc.triangles = surface.triangles;
    memcpy(wall->scene.direction, surface.view_direction, sizeof wall->scene.direction);
    memcpy(wall->scene.up, surface.up, sizeof wall->scene.up);
    for (uint32_t i = 0; i < 3 * surface.vertex_count; i++)
        surface.positions[i] = (float)((double)surface.positions[i] - wall->scene.origin[i % 3]);
    bool ok = vsf_mesh_build(&wall->host, &desc, &wall->mesh) == LAO_OK;
    scene_surface_free(&surface);
    return ok;
}

/* ---- values and distances --------------------------------------------------------------- */

/* --value: one number per vertex, and the range of its hues. */
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

/* --brightness auto: a silhouette of the median curvature gets three quarters of full opacity. That
 * is 1.5 mm, as L14's users liked best, where vessels have a radius of 2 mm. */
static bool find_brightness(cli_wall *wall) {
    uint32_t n = wall->mesh.vertex_count;
    double wanted = wall->options->surface.brightness;
    bool given = (wall->settings.set & VSF_SET(brightness)) != 0;
    if (wanted < 0 && (given || wall->source->path))
        return true;
    wall->settings.set |= VSF_SET(brightness);
    wall->settings.brightness = (float)wanted;
    if (wanted > 0)
        return true;
    float *curvatures = cli_new(n, 2 * sizeof *curvatures);
    if (!curvatures)
        return false;
    bool ok = vsf_curvatures(&wall->host, &wall->mesh, curvatures, NULL) == LAO_OK;
    for (uint32_t i = 0; i < n; i++)
        curvatures[i] = fmaxf(fabsf(curvatures[2 * (size_t)i]), fabsf(curvatures[2 * i + 1]));
    qsort(curvatures, n, sizeof *curvatures, by_value);
    wall->settings.brightness = 0.75f / fmaxf(curvatures[n / 2], 1e-6f);
    free(curvatures);
    return ok;
}

/* A table larger than this is kept in half floats. */
#define MOST_DISTANCES 250000000.0

static bool measure_distances(cli_wall *wall) {
    if (wall->scene.count < 2)
        return true;
    cli_set *set = &wall->scene.sets[1];
    lao_settings *s = &set->settings;
    float values[VSF_SETTING_COUNT];
    vsf_near_desc desc;
    if (!set->times)
        return cli_fail("%s: has no point array 'time' (ms), by which its lines are lit",
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
    s->highlight_beta = (float)wall->near.beta;
    s->set |= LAO_SET(highlight_beta);
    if (!(s->set & LAO_SET(trail_length))) {
        s->trail_length = (float)wall->near.reach;
        s->set |= LAO_SET(trail_length);
    }
    return wall->lit && cli_go_on();
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

void cli_wall_aim(cli_wall *wall, const cli_shot *shot) {
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

/* ---- scene ------------------------------------------------------------------------------ */

/* A set for the surface before that of the lines: effects are the first set's. */
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
    scene->module = vsf_module();
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
    lines->points = cli_new(wall->mesh.vertex_count, 3 * sizeof *lines->points);
    if (!lines->points)
        return false;
    lines->point_count = wall->mesh.vertex_count;
    memcpy(lines->points, wall->mesh.positions, 12 * (size_t)lines->point_count);
    if (wall->options->view)
        camera_view(wall->options->view, wall->scene.direction, wall->scene.up);
    return true;
}

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

bool cli_wall_load(const cli_options *options, cli_wall *out) {
    memset(out, 0, sizeof *out);
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
    take_settings(out);
    bool ok = load_lines(out) && (out->source->path ? read_mesh(out) : make_mesh(out)) &&
              smooth(out) && find_brightness(out);
    cli_progress_end(&out->progress);
    if (ok)
        choose_layers(out);
    return ok && add_set(out) && measure_distances(out) &&
           vsf_object_make(&out->host, &out->mesh, 0, &out->object) == LAO_OK && take_values(out) &&
           fill_set(out);
}

void cli_wall_free(cli_wall *wall) {
    cli_scene_free(&wall->scene);
    vsf_object_free(&wall->object);
    vsf_near_free(&wall->near);
    vsf_mesh_free(&wall->mesh);
    io_contents_free(&wall->contents);
    cli_threads_stop(wall->threads);
    memset(wall, 0, sizeof *wall);
}
