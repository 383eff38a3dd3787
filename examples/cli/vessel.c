#include "vessel.h"

#include "camera.h"
#include "report.h"
#include "scene_tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* One line per failure; warnings are in the tree. */
static void on_log(void *user, sdv_log_item item, lao_result result, const char *text) {
    const cli_tree *tree = user;
    if (result != LAO_OK && item == SDV_LOG_CANCELLED)
        cli_go_on();
    else if (result != LAO_OK)
        cli_fail("%s: %s", tree->name, text);
    else if (item == SDV_LOG_GRID_DEVICE)
        cli_warn(tree->name, text);
}

/* ---- the tree --------------------------------------------------------------------------- */

static bool is_surface(const cli_tree *tree) {
    return tree->options->vessel.surface || tree->contents.kinds == IO_MESH;
}

/* Positions about another origin than the tree's own. */
static void move_origin(io_vessel *vessel, const double origin[3]) {
    double shift[3];
    for (int k = 0; k < 3; k++) {
        shift[k] = vessel->origin[k] - origin[k];
        vessel->origin[k] = origin[k];
        for (int i = 0; i < 2; i++)
            vessel->tree.info.bounds[i][k] += (float)shift[k];
    }
    for (uint32_t i = 0; i < vessel->tree.node_count; i++) {
        lao_v4 *node = &vessel->tree.nodes[i];
        node->x = (float)((double)node->x + shift[0]);
        node->y = (float)((double)node->y + shift[1]);
        node->z = (float)((double)node->z + shift[2]);
    }
}

static bool read_tree(cli_tree *out, const cli_place *place) {
    io_error error;
    if (!out->contents.kinds && !cli_read(out->source, IO_TREE | IO_MESH, &out->contents))
        return false;
    if (is_surface(out))
        return true;
    if (!io_vessel_build(&out->host, &out->contents.tree, &out->vessel, &error))
        return cli_interrupted() ? cli_go_on() : cli_fail("%s: %s", out->name, error.text);
    if (place && place->origin)
        move_origin(&out->vessel, place->origin);
    return true;
}

static bool make_tree(cli_tree *out) {
    scene_tree scene;
    sdv_tree_desc desc;
    if (!scene_tree_make(out->options->vessel.nodes, 0, &scene))
        return cli_fail("liver: cannot be grown; ask for fewer --nodes (%d at most)",
                        SCENE_TREE_MOST);
    memset(&desc, 0, sizeof desc);
    sdv_segment *segments = cli_new(scene.segment_count, sizeof *segments);
    for (uint32_t i = 0; segments && i < scene.segment_count; i++) {
        segments[i].parent = scene.segments[2 * (size_t)i];
        segments[i].child = scene.segments[2 * (size_t)i + 1];
    }
    desc.node_count = scene.node_count;
    desc.positions = scene.positions;
    desc.radii = scene.radii;
    desc.segment_count = scene.segment_count;
    desc.segments = segments;
    bool ok = segments && sdv_tree_build(&out->host, &desc, &out->vessel.tree) == LAO_OK;
    free(segments);
    scene_tree_free(&scene);
    return ok;
}

/* ---- the layout ------------------------------------------------------------------------- */

static const sdv_attribute *find_attribute(const sdv_tree *tree, const char *name) {
    for (uint32_t i = 0; i < tree->node_attribute_count; i++) {
        if (strcmp(tree->node_attributes[i].name, name) == 0)
            return &tree->node_attributes[i];
    }
    return NULL;
}

/* ---- forms ------------------------------------------------------------------------------ */

/* Adds an attribute: one value for all nodes, or those of another one. It hides one of its name. */
static bool add_form(cli_tree *tree, int slot, const char *name, double value,
                     const sdv_attribute *from) {
    sdv_tree *t = &tree->vessel.tree;
    uint32_t step = from && from->components ? from->components : 1;
    float *values = cli_new(t->node_count, sizeof *values);
    sdv_attribute *rows = cli_new(t->node_attribute_count + 1u, sizeof *rows);
    if (!values || !rows) {
        free(values);
        free(rows);
        return false;
    }
    for (uint32_t i = 0; i < t->node_count; i++)
        values[i] = from ? from->values[(size_t)i * step] : (float)value;
    rows[0] = (sdv_attribute){name, 1, values};
    for (uint32_t i = 0; i < t->node_attribute_count; i++)
        rows[i + 1] = t->node_attributes[i];
    free(tree->forms);
    tree->forms = t->node_attributes = rows;
    tree->form_values[slot] = values;
    t->node_attribute_count++;
    return true;
}

/* --section, --uncertainty and --bump-size over what the file says. */
static bool add_forms(cli_tree *tree) {
    const cli_vessel_options *v = &tree->options->vessel;
    const char *text = v->uncertainty;
    if (v->bump_size > 0)
        tree->vessel.tree.bump_size = (float)v->bump_size;
    if (text) {
        const sdv_attribute *from = find_attribute(&tree->vessel.tree, text);
        char *end;
        double mm = strtod(text, &end);
        if (!from && (*end || end == text || !(mm >= 0 && mm < 1e6)))
            return cli_fail(
                "%s: its nodes have no attribute '%s' for --uncertainty; write MM or one "
                "that lineao info lists",
                tree->name, text);
        if (!add_form(tree, 0, SDV_UNCERTAINTY, mm, from))
            return false;
    }
    return !(v->section > 0) || add_form(tree, 1, SDV_SECTION_RATIO, v->section, NULL);
}

/* How near a node is, 0 .. 1; half at a tenth of the tree's size (L19 Fig. 12). */
static float nearness(const cli_tree *tree, uint32_t node) {
    const float(*bounds)[3] = tree->vessel.tree.info.bounds;
    float size = 0;
    for (int k = 0; k < 3; k++)
        size = fmaxf(size, bounds[1][k] - bounds[0][k]);
    float part =
        1 + 0.41421356f * fmaxf(cli_node_distance(tree, node), 0) / fmaxf(0.1f * size, 1e-6f);
    return 1 / (part * part);
}

/* One number per node to weigh by; *weights stays NULL without --layout-weight. */
static bool find_weights(const cli_tree *tree, float **weights) {
    const char *name = tree->options->vessel.weight;
    const sdv_tree *t = &tree->vessel.tree;
    if (!name)
        return true;
    const sdv_attribute *attribute = find_attribute(t, name);
    bool radius = !attribute && strcmp(name, "radius") == 0;
    bool near = !attribute && strcmp(name, "near") == 0;
    if (near && !tree->target)
        return cli_fail("--layout-weight: near what? write --path or --target");
    if (!attribute && !radius && !near)
        return cli_fail("%s: its nodes have no attribute '%s' for --layout-weight", tree->name,
                        name);
    *weights = cli_new(t->node_count, sizeof **weights);
    uint32_t step = attribute && attribute->components ? attribute->components : 1;
    for (uint32_t i = 0; *weights && i < t->node_count; i++)
        (*weights)[i] = radius ? t->nodes[i].w
                        : near ? nearness(tree, i)
                               : attribute->values[(size_t)i * step];
    return *weights != NULL;
}

static bool lay_out(cli_tree *tree) {
    const cli_layout_settings *s = &tree->source->layout;
    sdv_layout_desc desc;
    float *weights = NULL;
    memset(&desc, 0, sizeof desc);
    desc.ph = s->layout_ph;
    desc.has_ph = (s->set >> CLI_SETTING_layout_ph & 1) != 0;
    desc.flags = s->layout_all_nodes > 0 || tree->options->vessel.weight ? SDV_LAYOUT_ALL_NODES : 0;
    if (!find_weights(tree, &weights))
        return false;
    desc.scalars = weights;
    bool ok = sdv_reduce(&tree->host, &tree->vessel.tree, &tree->reduced) == LAO_OK &&
              sdv_layout_make(&tree->host, &tree->vessel.tree, &tree->reduced, &desc,
                              &tree->layout) == LAO_OK;
    free(weights);
    return ok;
}

static bool measure(cli_tree *tree) {
    const sdv_tree *t = &tree->vessel.tree;
    if (!tree->target)
        return true;
    tree->distances = cli_new(tree->reduced.node_count, sizeof *tree->distances);
    tree->cone_distances =
        cli_new((size_t)t->segment_count + t->node_count, sizeof *tree->cone_distances);
    bool *touched = cli_new(t->node_count, sizeof *touched);
    bool ok = tree->distances && tree->cone_distances && touched &&
              sdv_target_distances(&tree->host, tree->target, t, &tree->reduced,
                                   tree->cone_distances, tree->distances) == LAO_OK;
    tree->cone_count = t->segment_count;
    if (ok)
        memset(touched, 0, t->node_count * sizeof *touched);
    for (uint32_t i = 0; ok && i < t->segment_count; i++)
        touched[t->segments[i].parent] = touched[t->segments[i].child] = true;
    for (uint32_t i = 0; ok && i < t->node_count; i++) { /* balls stand behind, as in the field */
        if (!touched[i])
            tree->cone_distances[tree->cone_count++] = cli_node_distance(tree, i);
    }
    free(touched);
    return ok;
}

bool cli_tree_load(const cli_options *options, const cli_place *place, uint32_t index,
                   cli_tree *out) {
    const cli_vessel_options *vessel = &options->vessel;
    memset(out, 0, sizeof *out);
    if (place) {
        out->contents = *place->contents;
        memset(place->contents, 0, sizeof *place->contents); /* moved */
    }
    out->options = options;
    out->aim = index < vessel->target_count ? &vessel->targets[index] : NULL;
    if (out->aim)
        out->risk = vessel->risk >= 0 ? vessel->risk : vessel->link ? 15 : 0;
    out->source = options->file_count ? &options->files[0] : &options->all;
    out->name = out->source->path ? out->source->path : "liver";
    out->progress = (cli_progress){"measuring", out->name, -1};
    out->threads = cli_threads_start();
    if (!out->threads)
        return false;
    out->host.job = cli_threads_job(out->threads, &out->progress);
    out->host.log = on_log;
    out->host.user = out;
    bool ok = out->source->path         ? read_tree(out, place)
              : options->vessel.surface ? true
                                        : make_tree(out);
    ok = ok &&
         (is_surface(out) ? cli_tree_mesh(out)
                          : add_forms(out) && cli_target_make(out) && lay_out(out) && measure(out));
    cli_progress_end(&out->progress);
    return ok;
}

/* ---- the field -------------------------------------------------------------------------- */

/* Settings of a style, unless they are given. */
typedef struct style_row {
    const char *style, *setting;
    float value;
} style_row;
static const style_row styles[] = {
    {"plain", "near_miss", SDV_NEAR_MISS_NONE},
    {"plain", "field_occlusion", 0},
    {"ink", "surface_ambient", 1},
    {"ink", "surface_diffuse", 0},
    {"ink", "surface_specular", 0},
    {"ink", "field_occlusion", 0},
    {"ink", "silhouette", 3},
    {"ink", "contour", 2},
    {"ink", "shadow_softness", 0},
    {"ink", "shadow_strength", 0.8f},
    {"glow", "near_miss", SDV_NEAR_MISS_NONE},
    {"glow", "surface_ambient", 0.55f},
    {"glow", "surface_diffuse", 0.5f},
    {"glow", "occlusion_reach", 8},
    {"stipple", "style", SDV_STYLE_STIPPLE},
    {"hatch", "style", SDV_STYLE_HATCH},
    {"crosshatch", "style", SDV_STYLE_CROSSHATCH},
    {"layered", "style", SDV_STYLE_LAYERED},
    {"shadow", "style", SDV_STYLE_SHADOW},
    {"void", "void_style", SDV_VOID_CHROMADEPTH},
};

/* A setting's value, unless it is given. */
static void imply(const char *name, float value, sdv_settings *settings) {
    int setting = lao_setting_find(sdv_module(), name);
    uint64_t bit = (uint64_t)1 << setting;
    float *values = (float *)(void *)((char *)settings + sizeof settings->set);
    if (settings->set & bit)
        return;
    values[setting] = value;
    settings->set |= bit;
}

/* The unit axes of a view, or of the world. */
static void find_axes(const cli_scene *scene, float axes[6][3]) {
    const float *d = scene->direction, *u = scene->up;
    lao_v3 forward = lao_v3_unit(lao_v3_make(d[0], d[1], d[2]), lao_v3_make(0, 0, 1));
    lao_v3 right = lao_v3_unit(lao_v3_cross(forward, lao_v3_make(u[0], u[1], u[2])), forward);
    const lao_v3 own[3] = {right, lao_v3_cross(right, forward), forward};
    memset(axes, 0, 6 * sizeof *axes);
    for (int k = 0; k < 3; k++) {
        axes[k][k] = 1;
        axes[3 + k][0] = own[k].x;
        axes[3 + k][1] = own[k].y;
        axes[3 + k][2] = own[k].z;
    }
}

/* Points of every node's sphere tell how far the tree reaches along the axes of the world, for its
 * box, and along those of the view, for the picture; of a union the corners of its shape too. */
static bool make_points(cli_tree *tree, io_lines *lines) {
    const sdv_tree *t = &tree->vessel.tree;
    const sdv_shapes *shapes = &tree->carving.shapes;
    if (is_surface(tree)) {
        lines->points = cli_new(tree->mesh.vertex_count, 12);
        if (lines->points)
            memcpy(lines->points, tree->mesh.positions, 12 * (size_t)tree->mesh.vertex_count);
        lines->point_count = tree->mesh.vertex_count;
        return lines->points != NULL;
    }
    float *to = lines->points = cli_new(12 * (size_t)t->node_count + 2 * (size_t)CLI_SHAPES, 12);
    float axes[6][3];
    if (!to)
        return false;
    find_axes(&tree->scene, axes);
    for (size_t i = 0; i < 12 * (size_t)t->node_count; i++, to += 3) {
        const lao_v4 *node = &t->nodes[i / 12];
        const float *axis = axes[i % 6], by = i % 12 < 6 ? node->w : -node->w;
        to[0] = node->x + by * axis[0];
        to[1] = node->y + by * axis[1];
        to[2] = node->z + by * axis[2];
    }
    for (uint32_t i = 0; i < 2 * shapes->count; i++) {
        const sdv_shape *s = &shapes->shapes[i / 2];
        const float a[3] = {s->a.x, s->a.y, s->a.z}, b[3] = {s->b.x, s->b.y, s->b.z};
        if (s->operation != SDV_UNION || s->kind == SDV_SHAPE_PLANE || s->kind == SDV_SHAPE_TREE)
            continue;
        for (int k = 0; k < 3; k++) {
            float half = s->kind == SDV_SHAPE_BALL ? s->a.w : b[k];
            float whole = s->kind == SDV_SHAPE_FIELD ? (b[k] - 1) * s->a.w : 0;
            to[k] = s->kind == SDV_SHAPE_FIELD ? a[k] + (i % 2 ? whole : 0)
                                               : a[k] + (i % 2 ? half : -half);
        }
        to += 3;
    }
    lines->point_count = (uint32_t)((to - lines->points) / 3);
    return true;
}

enum { PERIOD_PIXELS = 9 };

/* The module's settings: those given, those of the style, and what both want: texture coordinates
 * for ink and marks; a dump wants them too, and every ray's nearest miss. */
static void make_settings(const cli_tree *tree, sdv_settings *settings) {
    const cli_options *options = tree->options;
    const char *style = options->vessel.style;
    *settings = tree->source->vessel;
    for (size_t i = 0; style && i < sizeof styles / sizeof *styles; i++) {
        if (strcmp(styles[i].style, style) == 0)
            imply(styles[i].setting, styles[i].value, settings);
    }
    if (options->vessel.link) { /* colours are to be read, in small panels */
        imply("surface_ambient", 0.45f, settings);
        imply("silhouette", 0.9f, settings);
        imply("contour", 0.5f, settings);
    }
    bool inked = settings->style > 0 || settings->void_style > SDV_VOID_CHROMADEPTH;
    if (options->dump)
        imply("near_miss", SDV_NEAR_MISS_EXACT, settings);
    if (inked || tree->risk > 0 || options->dump)
        imply("parameterization", 2, settings);
    if (settings->void_style > 0)
        imply("parameterization", 1, settings);
}

void cli_tree_fit_period(cli_tree *tree, const cli_shot *shot) {
    const camera_pose *c = &shot->camera;
    double apart = 0, height = c->ortho_height;
    if (!tree->options->vessel.style && !(tree->risk > 0))
        return; /* numbers that do not depend on the camera */
    for (int k = 0; k < 3; k++) {
        double to = (double)shot->sphere[k] + tree->scene.origin[k] - c->eye[k];
        apart += to * to;
    }
    if (c->fovy > 0)
        height = 2 * fmax(sqrt(apart), (double)shot->sphere[3]) * tan(c->fovy * 0.00872664626);
    imply("ssp_period", (float)fmin(fmax(PERIOD_PIXELS * height / shot->height, 1e-3), 1000),
          &tree->settings);
}

/* The marker is plain: no void of its own, no ink. */
static void add_marker(cli_tree *tree) {
    cli_scene *scene = &tree->scene;
    scene->sets[1] = scene->sets[0];
    memset(&scene->sets[0].lines, 0, sizeof scene->sets[0].lines);
    tree->marker.settings = tree->settings;
    tree->marker.settings.parameterization = tree->marker.settings.style =
        tree->marker.settings.void_style = 0;
    scene->sets[0].object = &tree->marker.object.desc;
    scene->sets[0].tree = NULL;
    scene->sets[0].module_settings[0] = &tree->marker.settings;
    scene->count = 2;
}

static bool make_scene(cli_tree *tree) {
    cli_scene *scene = &tree->scene;
    cli_set *set = cli_new(2, sizeof *set);
    if (!set)
        return false;
    memset(set, 0, 2 * sizeof *set);
    scene->sets = set;
    scene->count = 1;
    scene->modules[scene->module_count++] = sdv_module();
    camera_view("iso", scene->direction, scene->up);
    if (tree->options->view)
        camera_view(tree->options->view, scene->direction, scene->up);
    memcpy(scene->origin, tree->vessel.origin, sizeof scene->origin);
    scene->turns = tree->options->frames > 1 && !tree->options->vessel.cameras;
    set->source = tree->source;
    set->name = tree->name;
    set->settings = tree->source->settings;
    set->settings.occlusion = 0; /* it has no lines: half of all shaders need not be built */
    set->settings.set |= LAO_SET(occlusion);
    set->object = &tree->object.desc;
    set->tree = tree;
    make_settings(tree, &tree->settings);
    set->module_settings[0] = &tree->settings;
    if (!make_points(tree, &set->lines))
        return false;
    if (tree->aim && tree->options->vessel.link)
        add_marker(tree);
    return true;
}

/* Of the shapes: red below 0 stands for the nearest vessel's. */
static bool add_shapes(cli_tree *tree) {
    const char *color = tree->options->vessel.shape_color;
    float colors[3 * CLI_SHAPES];
    double rgb[4] = {-1, -1, -1, 1};
    if (color)
        cli_parse_color(color, rgb);
    for (int i = 0; i < 3 * CLI_SHAPES; i++)
        colors[i] = (float)rgb[i % 3];
    return sdv_object_shapes(&tree->host, &tree->carving.shapes, color ? colors : NULL,
                             &tree->object) == LAO_OK;
}

static bool make_object(cli_tree *tree, const sdv_grid_desc *desc) {
    tree->progress = (cli_progress){"measuring the field of", tree->name, -1};
    double begin = now();
    bool ok = sdv_grid_build(&tree->host, &tree->vessel.tree, desc, &tree->grid) == LAO_OK;
    cli_progress_end(&tree->progress);
    tree->grid_seconds = now() - begin;
    return ok && cli_go_on() && cli_tree_colour(tree) &&
           sdv_object_make(&tree->host, &tree->grid, tree->colors, &tree->object) == LAO_OK;
}

enum { DEVICE_IMAGE = 4096 }; /* px: of an image, what any device of Vulkan has */

/* The device builds the field; box and cones are made here, a first time to know whom colours are
 * for. Where it cannot, which has been said, the CPU does. */
static bool make_device_object(cli_tree *tree, const sdv_grid_desc *desc) {
    const sdv_tree *t = &tree->vessel.tree;
    for (int i = 0; i < 2; i++) {
        sdv_object_free(&tree->object);
        if (sdv_object_make_tree(&tree->host, t, desc, DEVICE_IMAGE, tree->colors, &tree->object) !=
            LAO_OK)
            return false;
        tree->by_device = tree->object.on_device != 0;
        if (!tree->by_device) {
            sdv_object_free(&tree->object);
            return make_object(tree, desc);
        }
        tree->grid = tree->object.grid; /* the object's own */
        if (i == 0 && !cli_tree_colour(tree))
            return false;
    }
    return true;
}

bool cli_tree_prepare(cli_tree *tree) {
    const char *field = tree->options->vessel.field;
    sdv_grid_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.resolution = tree->options->vessel.grid;
    if (is_surface(tree))
        return cli_go_on() && cli_tree_mesh_object(tree) && make_scene(tree) &&
               cli_tree_pattern(tree);
    bool by_device = field && strcmp(field, "device") == 0;
    bool ok = cli_carving_make(tree) &&
              (by_device ? make_device_object(tree, &desc) : make_object(tree, &desc));
    ok = ok && (!tree->carving.shapes.count || add_shapes(tree)) &&
         (!tree->aim || !tree->options->vessel.link || cli_marker_make(tree));
    return ok && make_scene(tree) && cli_tree_pattern(tree);
}

/* ---- dumps and warnings ----------------------------------------------------------------- */

bool cli_tree_planes(void *user, cli_planes *planes) {
    static const char *const names[3] = {"position.X", "position.Y", "position.Z"};
    static const char *const behind[3] = {"bgposition.X", "bgposition.Y", "bgposition.Z"};
    const cli_tree *tree = user;
    size_t count;
    const float *segment = cli_planes_find(planes, "segment.V", &count);
    float *p[3], *b[3], *mask = cli_planes_add(planes, "mask.V");
    float *distance = tree->target ? cli_planes_add(planes, "distance.V") : NULL;
    if (!segment || !mask || (tree->target && !distance))
        return segment != NULL || cli_fail("the dump has no segments");
    for (int k = 0; k < 3; k++) {
        p[k] = cli_planes_find(planes, names[k], &count);
        b[k] = cli_planes_find(planes, behind[k], &count);
    }
    for (size_t i = 0; i < count; i++) {
        bool covered = segment[i] != -1;
        mask[i] = covered ? 1.0f : 0.0f;
        if (distance)
            distance[i] =
                covered ? sdv_target_point(tree->target, lao_v3_make(p[0][i], p[1][i], p[2][i]))
                        : SDV_FAR;
        for (int k = 0; k < 3; k++) {
            double o = tree->vessel.origin[k];
            p[k][i] = covered ? (float)((double)p[k][i] + o) : 0.0f;
            if (b[k])
                b[k][i] = (float)((double)b[k][i] + o);
        }
    }
    return true;
}

bool cli_tree_warning(const cli_tree *tree, uint32_t i, char *text, size_t size) {
    const io_tree *read = &tree->contents.tree;
    const sdv_tree *t = &tree->vessel.tree;
    if (i < read->warning_count)
        snprintf(text, size, "%s", read->warnings[i]);
    else if (i - read->warning_count < t->warning_count)
        sdv_tree_warning_text(t, i - read->warning_count, text, size);
    else
        return false;
    return true;
}

void cli_tree_free(cli_tree *tree) {
    cli_scene_free(&tree->scene);
    sdv_object_free(&tree->object);
    vsf_mesh_free(&tree->mesh);
    free(tree->colors);
    if (!tree->by_device)
        sdv_grid_free(&tree->grid);
    free(tree->carving.fields);
    cli_marker_free(&tree->marker);
    free(tree->distances);
    free(tree->cone_distances);
    sdv_target_free(tree->target);
    sdv_layout_free(&tree->layout);
    sdv_reduced_free(&tree->reduced);
    io_vessel_free(&tree->vessel);
    free(tree->forms);
    free(tree->form_values[0]);
    free(tree->form_values[1]);
    io_contents_free(&tree->contents);
    cli_threads_stop(tree->threads);
    memset(tree, 0, sizeof *tree);
}
