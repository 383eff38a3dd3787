/* Surfaces drawn by the passes of vessels: ink by texture coordinates of the screen. */
#include "image.h"
#include "report.h"
#include "vessel.h"

#include "scene_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool build(cli_tree *tree, uint32_t vertex_count, const float *positions,
                  uint32_t triangle_count, const uint32_t *triangles) {
    vsf_host host;
    vsf_mesh_desc desc;
    memset(&host, 0, sizeof host);
    host.job = tree->host.job;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = vertex_count;
    desc.positions = positions;
    desc.triangle_count = triangle_count;
    desc.triangles = triangles;
    if (vsf_mesh_build(&host, &desc, &tree->mesh) != LAO_OK)
        return cli_fail("%s: no surface can be made of its triangles", tree->name);
    for (uint32_t i = 0; i < tree->mesh.warning_count; i++) {
        char text[256];
        vsf_mesh_warning_text(&tree->mesh, i, text, sizeof text);
        cli_warn(tree->name, text);
    }
    return true;
}

static bool embedded(cli_tree *tree) {
    scene_surface surface;
    vsf_smooth_desc smooth;
    memset(&smooth, 0, sizeof smooth);
    smooth.steps = 20; /* marching cubes left stairs */
    smooth.uniform = 1;
    tree->name = tree->options->vessel.surface;
    if (!scene_surface_make(tree->name, 0, &surface))
        return cli_fail("--surface: there is none called '%s'; lineao surface --help lists them",
                        tree->name);
    bool ok = build(tree, surface.vertex_count, surface.positions, surface.triangle_count,
                    surface.triangles) &&
              vsf_mesh_smooth(NULL, &tree->mesh, &smooth) == LAO_OK;
    scene_surface_free(&surface);
    return ok;
}

bool cli_tree_mesh(cli_tree *tree) {
    const cli_vessel_options *v = &tree->options->vessel;
    const io_mesh *mesh = &tree->contents.mesh;
    if (v->layout[0] || v->layout[1] || v->target_count || v->link || v->tree || v->shape_count)
        return cli_fail(
            "%s: is a surface; --layout, --link, --path, --target, --tree and shapes want a "
            "vessel tree",
            tree->source->path ? tree->source->path : v->surface);
    if (!tree->source->path)
        return embedded(tree);
    float *positions = cli_new(mesh->vertex_count, 3 * sizeof *positions);
    if (!positions)
        return false;
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
        positions[i] = (float)((double)mesh->positions[i] * mesh->millimetres);
    for (int k = 0; k < 3; k++)
        tree->vessel.origin[k] = mesh->origin[k] * mesh->millimetres;
    bool ok = build(tree, mesh->vertex_count, positions, mesh->triangle_count, mesh->triangles);
    free(positions);
    return ok;
}

/* Of curvature, the surer the more the two curvatures differ; squared, so that what a mesh's
 * corners make of a ball gives way to what is known around it. */
static bool make_directions(const vsf_mesh *mesh, float *directions) {
    float *curvatures = cli_new(mesh->vertex_count, 2 * sizeof *curvatures);
    bool ok = curvatures && vsf_curvatures(NULL, mesh, curvatures, directions) == LAO_OK;
    for (size_t i = 0; ok && i < mesh->vertex_count; i++) {
        float a = curvatures[2 * i], b = curvatures[2 * i + 1];
        float sure = fabsf(a - b) / fmaxf(fabsf(a) + fabsf(b), 1e-9f);
        for (int k = 0; k < 3; k++)
            directions[3 * i + (size_t)k] *= sure * sure;
    }
    free(curvatures);
    return ok;
}

bool cli_tree_mesh_object(cli_tree *tree) {
    const vsf_mesh *mesh = &tree->mesh;
    sdv_mesh_desc desc;
    float *directions = cli_new(mesh->vertex_count, 3 * sizeof *directions);
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = mesh->vertex_count;
    desc.triangle_count = mesh->triangle_count;
    desc.positions = mesh->positions;
    desc.normals = mesh->normals;
    desc.triangles = mesh->triangles;
    desc.directions = directions;
    bool ok = directions && make_directions(mesh, directions) &&
              sdv_object_mesh(&tree->host, &desc, &tree->object) == LAO_OK;
    free(directions);
    return ok;
}

bool cli_tree_pattern(cli_tree *tree) {
    const char *path = tree->options->vessel.pattern;
    char error[IMAGE_ERROR_SIZE];
    uint32_t width, height;
    uint8_t *pixels = NULL;
    if (!path)
        return tree->settings.style < SDV_STYLE_PATTERN ||
               cli_fail("--set style=pattern wants a --pattern FILE.png");
    if (!image_read_png(path, 3, &width, &height, &pixels, error))
        return cli_fail("%s", error);
    uint32_t square = width < height ? width : height;
    uint32_t size = square < SDV_MOST_PATTERN ? square : SDV_MOST_PATTERN;
    float *values = cli_new((size_t)size * size, sizeof *values);
    for (uint32_t i = 0; values && i < size * size; i++) {
        size_t x = (width - square) / 2 + (size_t)(i % size) * square / size;
        size_t y = (height - square) / 2 + (size_t)(i / size) * square / size;
        const uint8_t *p = pixels + 3 * (y * width + x);
        values[i] = 0.3f * p[0] + 0.6f * p[1] + 0.1f * p[2];
    }
    bool ok = values && sdv_object_pattern(&tree->host, values, size, &tree->object) == LAO_OK;
    free(values);
    free(pixels);
    return ok;
}
