/* Where the mesh of `lineao surface` comes from: a file of triangles, a vessel tree, the mask of a
 * velocity volume, or code. */
#include "flow.h"
#include "flow4d.h"
#include "report.h"
#include "scene_surface.h"
#include "surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    MADE_STEPS = 20, /* of smoothing what marching cubes made of a distance, and of a mask, whose */
    MASK_STEPS = 80, /* voxels leave stairs */
    CELLS = 256,     /* along the longest axis of a tree */
    BLOCK = 8        /* voxels along each axis of a block */
};

/* ---- building --------------------------------------------------------------------------- */

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

/* ---- triangles of a file ---------------------------------------------------------------- */

static const io_attribute *find_array(const io_mesh *mesh, const char *name) {
    for (uint32_t i = 0; i < mesh->vertex_attribute_count; i++) {
        if (strcmp(mesh->vertex_attributes[i].name, name) == 0)
            return &mesh->vertex_attributes[i];
    }
    return NULL;
}

/* In mm, about scene.origin, which is the lines' if there are any. */
static bool take_triangles(cli_wall *wall) {
    const io_mesh *mesh = &wall->contents.mesh;
    const char *value = wall->options->surface.value;
    const io_attribute *array = value ? find_array(mesh, value) : NULL;
    vsf_attribute attribute;
    vsf_mesh_desc desc;
    if (value && !array)
        return cli_fail("%s: its vertices have no array '%s' for --value; lineao info lists them",
                        wall->name, value);
    float *positions = cli_new(mesh->vertex_count, 3 * sizeof *positions);
    if (!positions)
        return false;
    for (int k = 0; k < 3 && !wall->placed; k++)
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

/* ---- marching cubes --------------------------------------------------------------------- */

static void on_flow_log(void *user, flow4d_log_item item, lao_result result, const char *text) {
    const cli_wall *wall = user;
    (void)result;
    if (item == FLOW4D_LOG_CANCELLED)
        cli_go_on();
    else
        cli_fail("%s: %s", wall->name, text);
}

/* The surface of a distance field, or of a mask. Positions of the volume are about scene.origin. */
static bool march(cli_wall *wall, const flow4d_volume *volume, bool mask) {
    flow4d_host host;
    flow4d_surface_settings settings;
    flow4d_surface surface;
    vsf_mesh_desc desc;
    memset(&host, 0, sizeof host);
    memset(&settings, 0, sizeof settings);
    memset(&desc, 0, sizeof desc);
    host.job = wall->host.job;
    host.log = on_flow_log;
    host.user = wall;
    settings.inside_is_less = !mask;
    settings.smoothing = mask;
    if (flow4d_surface_make(&host, volume, mask ? 0.5 : 0, &settings, &surface) != LAO_OK)
        return false;
    desc.vertex_count = surface.vertex_count;
    desc.positions = surface.vertices;
    desc.triangle_count = surface.triangle_count;
    desc.triangles = surface.triangles;
    wall->made = true;
    bool ok = vsf_mesh_build(&wall->host, &desc, &wall->mesh) == LAO_OK;
    flow4d_surface_free(&surface);
    return ok;
}

/* The border of where the volume's lines were traced. */
static bool make_from_volume(cli_wall *wall) {
    const cli_volume *kept = wall->scene.volumes;
    flow4d_volume volume;
    memset(&volume, 0, sizeof volume);
    memcpy(volume.size, kept->size, sizeof volume.size);
    memcpy(volume.to_world, kept->to_mm, sizeof volume.to_world);
    for (int k = 0; k < 3; k++)
        volume.to_world[4 * k + 3] -= wall->scene.origin[k];
    volume.values = kept->inside;
    return march(wall, &volume, true);
}

/* ---- trees ------------------------------------------------------------------------------ */

/* The field of a tree on a lattice, block by block on all threads. */
typedef struct sampling {
    const sdv_grid *grid;
    flow4d_volume *volume;
    float *values;
} sampling;

static double at_voxel(const sampling *s, double x, double y, double z) {
    const double *m = s->volume->to_world;
    lao_v3 p =
        lao_v3_make((float)(m[0] * x + m[3]), (float)(m[5] * y + m[7]), (float)(m[10] * z + m[11]));
    return (double)sdv_grid_distance(s->grid, p, NULL);
}

/* Far from the vessels a block is as its middle: the field is at most 3.5 cells too great there. */
static void sample_block(const sampling *s, const uint32_t first[3]) {
    const double half = 0.5 * (BLOCK - 1), spacing = s->volume->to_world[0];
    const uint32_t *n = s->volume->size;
    double middle = at_voxel(s, first[0] + half, first[1] + half, first[2] + half);
    bool far = middle > half * sqrt(3.0) * spacing + 4 * (double)s->grid->cell;
    for (uint32_t z = first[2]; z < n[2] && z < first[2] + BLOCK; z++) {
        for (uint32_t y = first[1]; y < n[1] && y < first[1] + BLOCK; y++) {
            for (uint32_t x = first[0]; x < n[0] && x < first[0] + BLOCK; x++)
                s->values[((size_t)z * n[1] + y) * n[0] + x] =
                    (float)(far ? middle : at_voxel(s, x, y, z));
        }
    }
}

static void sample_slab(void *arg, uint32_t index) {
    const sampling *s = arg;
    uint32_t at[3] = {0, 0, index * BLOCK};
    for (at[1] = 0; at[1] < s->volume->size[1]; at[1] += BLOCK) {
        for (at[0] = 0; at[0] < s->volume->size[0]; at[0] += BLOCK)
            sample_block(s, at);
    }
}

/* The lattice around all nodes; branches thinner than its voxels become as wide. */
static void lay_lattice(cli_wall *wall, flow4d_volume *volume) {
    sdv_tree *tree = &wall->vessel.tree;
    uint32_t cells = wall->options->surface.grid ? wall->options->surface.grid : CELLS;
    double low[3] = {1e30, 1e30, 1e30}, high[3] = {-1e30, -1e30, -1e30}, longest = 0;
    for (uint32_t i = 0; i < tree->node_count; i++) {
        const lao_v4 n = tree->nodes[i];
        const double at[3] = {(double)n.x, (double)n.y, (double)n.z};
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], at[k] - (double)n.w);
            high[k] = fmax(high[k], at[k] + (double)n.w);
        }
    }
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, high[k] - low[k]);
    wall->thinnest = longest / cells;
    for (uint32_t i = 0; i < tree->node_count; i++) {
        wall->widened += tree->nodes[i].w < (float)wall->thinnest;
        tree->nodes[i].w = fmaxf(tree->nodes[i].w, (float)wall->thinnest);
    }
    for (int k = 0; k < 3; k++) {
        volume->size[k] = (uint32_t)ceil((high[k] - low[k]) / wall->thinnest) + 6;
        volume->to_world[(size_t)5 * (size_t)k] = wall->thinnest;
        volume->to_world[4 * k + 3] = low[k] - 2.5 * wall->thinnest;
    }
}

static bool sample_tree(cli_wall *wall, const sdv_host *host, flow4d_volume *volume) {
    sdv_grid_desc desc;
    sdv_grid grid;
    memset(&desc, 0, sizeof desc);
    size_t count = (size_t)volume->size[0] * volume->size[1] * volume->size[2];
    float *values = cli_new(count, sizeof *values);
    if (!values)
        return false;
    volume->values = values;
    wall->progress = (cli_progress){"measuring the field of", wall->name, -1};
    if (sdv_grid_build(host, &wall->vessel.tree, &desc, &grid) != LAO_OK)
        return false;
    sampling s = {&grid, volume, values};
    wall->host.job.run(wall->host.job.user, (volume->size[2] + BLOCK - 1) / BLOCK, sample_slab, &s);
    sdv_grid_free(&grid);
    return cli_go_on();
}

static void on_tree_log(void *user, sdv_log_item item, lao_result result, const char *text) {
    const cli_wall *wall = user;
    if (result != LAO_OK && item == SDV_LOG_CANCELLED)
        cli_go_on();
    else if (result != LAO_OK)
        cli_fail("%s: %s", wall->name, text);
}

static bool make_from_tree(cli_wall *wall) {
    sdv_host host;
    flow4d_volume volume;
    io_error error;
    if (wall->options->surface.value)
        return cli_fail("--value: names an array of a MESH, and %s is a tree", wall->name);
    memset(&host, 0, sizeof host);
    memset(&volume, 0, sizeof volume);
    host.job = wall->host.job;
    host.log = on_tree_log;
    host.user = wall;
    if (!io_vessel_build(&host, &wall->contents.tree, &wall->vessel, &error))
        return cli_interrupted() ? cli_go_on() : cli_fail("%s: %s", wall->name, error.text);
    for (int k = 0; k < 3 && !wall->placed; k++)
        wall->scene.origin[k] = wall->vessel.origin[k];
    lay_lattice(wall, &volume);
    bool ok = sample_tree(wall, &host, &volume);
    for (int k = 0; k < 3; k++) /* the tree's origin need not be the lines' */
        volume.to_world[4 * k + 3] += wall->vessel.origin[k] - wall->scene.origin[k];
    ok = ok && march(wall, &volume, false);
    free((void *)(uintptr_t)volume.values); /* ours */
    return ok;
}

/* ---- the embedded ones ------------------------------------------------------------------ */

static bool make_embedded(cli_wall *wall) { /* needs no smoothing: it has the wall's normals */
    scene_surface surface;
    vsf_mesh_desc desc;
    if (!scene_surface_make(wall->name, 0, &surface))
        return cli_fail("%s: out of memory", wall->name);
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = surface.vertex_count;
    desc.positions = surface.positions;
    desc.normals = surface.normals;
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

/* ---- all -------------------------------------------------------------------------------- */

static bool load(cli_wall *wall) {
    if (!wall->source->path)
        return make_embedded(wall);
    if (wall->scene.volume_count)
        return make_from_volume(wall);
    if (!wall->contents.kinds && !cli_read(wall->source, IO_MESH | IO_TREE, &wall->contents))
        return false;
    return wall->contents.kinds & IO_MESH ? take_triangles(wall) : make_from_tree(wall);
}

/* Puts another mesh, made of it, in place of the mesh; its warnings are about what was read. */
static void replace_mesh(cli_wall *wall, vsf_mesh *by) {
    by->warning_count = wall->mesh.warning_count;
    memcpy(by->warnings, wall->mesh.warnings, sizeof by->warnings);
    vsf_mesh_free(&wall->mesh);
    wall->mesh = *by;
}

/* A mesh that is too large for devices, or for the user. */
static bool decimate(cli_wall *wall) {
    uint32_t wanted = wall->options->surface.triangles, had = wall->mesh.triangle_count;
    uint32_t most = wanted ? wanted : CLI_MOST_TRIANGLES;
    vsf_mesh coarser;
    if (had <= most)
        return true;
    wall->progress = (cli_progress){"decimating", wall->name, -1};
    if (vsf_mesh_decimate(&wall->host, &wall->mesh, most, &coarser) != LAO_OK)
        return false;
    replace_mesh(wall, &coarser);
    wall->decimated = had;
    wall->decimated_to = wall->mesh.triangle_count;
    return true;
}

static bool smooth(cli_wall *wall) {
    const cli_surface_options *o = &wall->options->surface;
    vsf_smooth_desc desc;
    vsf_mesh finer;
    memset(&desc, 0, sizeof desc);
    desc.steps = o->smooth                  ? o->smooth
                 : wall->scene.volume_count ? MASK_STEPS
                 : wall->made               ? MADE_STEPS
                                            : 0;
    desc.uniform = wall->made;
    if (o->subdivide) {
        if (vsf_mesh_subdivide(&wall->host, &wall->mesh, o->subdivide, &finer) != LAO_OK)
            return false;
        replace_mesh(wall, &finer);
    }
    return !desc.steps || vsf_mesh_smooth(&wall->host, &wall->mesh, &desc) == LAO_OK;
}

bool cli_wall_mesh(cli_wall *wall) {
    return load(wall) && decimate(wall) && smooth(wall);
}
