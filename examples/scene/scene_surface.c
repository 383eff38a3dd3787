/* Surfaces of scene_shapes.h, sampled on a lattice and meshed. */
#include "scene_surface.h"
#include "flow_aneurysm.h"
#include "flow_phantom.h"
#include "scene_shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the surfaces */

static double aneurysm(vec3 p) {
    const double position[3] = {p.x, p.y, p.z};
    return flow_aneurysm_wall(position);
}

/* The vessel of flow_phantom.h, whose pathlines are the scene `flow`, closed at its two ends. */
static double aorta(vec3 p) {
    const double position[3] = {p.x, p.y, p.z};
    double end = (-0.6 * p.x - 0.8 * p.y < 0 ? -92.0 : -112.0) - p.z;
    double wall = flow_phantom_wall(position);
    return wall > end ? wall : end;
}

/* Two lobes with a notch, a dent for the gallbladder and a dome under the diaphragm. */
static double liver(vec3 p) {
    double wall = shape_ellipsoid(p, vec3_make(30, 0, 0), vec3_make(62, 48, 56));
    wall = shape_join(wall, shape_ellipsoid(p, vec3_make(-42, 14, 14), vec3_make(58, 30, 30)), 26);
    wall = shape_join(wall, shape_ellipsoid(p, vec3_make(46, -8, -42), vec3_make(34, 30, 32)), 24);
    wall = shape_cut(wall, -shape_ellipsoid(p, vec3_make(-6, 22, -34), vec3_make(12, 60, 34)),
                     12); /* notch */
    wall =
        shape_cut(wall, -shape_tube(p, vec3_make(16, 30, -60), vec3_make(24, 4, -26), 13, 9), 10);
    wall =
        shape_cut(wall, -shape_tube(p, vec3_make(-20, -30, 10), vec3_make(24, -56, 2), 12, 12), 12);
    return shape_cut(wall, -shape_ball(p, vec3_make(-30, -40, -78), 62),
                     16); /* the stomach's side */
}

/* What of a portal vein lies in it. */
static double portal_vein(vec3 p) {
    static const double pieces[][8] = {
        /* from, to, radii at both ends */
        {4, 6, -8, 8, 2, 8, 6.5, 6},           {8, 2, 8, -20, 8, 15, 5, 4},
        {-20, 8, 15, -62, 14, 15, 3.6, 1.8},   {-20, 8, 15, -34, 12, 31, 2.8, 1.6},
        {-40, 11, 15, -54, 16, -2, 2.4, 1.5},  {8, 2, 8, 36, -4, 8, 5.2, 4.4},
        {36, -4, 8, 64, -8, 26, 3.8, 2},       {36, -4, 8, 56, 0, -26, 3.8, 2.2},
        {50, -6, 17, 40, 8, 40, 2.6, 1.6},     {50, -6, 17, 74, 10, 4, 2.4, 1.5},
        {50, -1, -16, 34, -12, -44, 2.6, 1.6}, {50, -1, -16, 72, -12, -30, 2.4, 1.5},
        {22, -1, 8, 16, -14, 34, 2.8, 1.6},
    };
    double wall = 1e9;
    for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
        const double *a = pieces[i];
        double piece =
            shape_tube(p, vec3_make(a[0], a[1], a[2]), vec3_make(a[3], a[4], a[5]), a[6], a[7]);
        wall = i ? shape_join(wall, piece, 2.5) : piece;
    }
    return wall;
}

/* The upper half of a thigh bone: head, neck, two trochanters, a shaft that bends, and the fovea.
 */
static double bone(vec3 p) {
    double wall = shape_tube(p, vec3_make(0, 0, -70), vec3_make(-1, 4, -20), 10, 10.5);
    wall = shape_join(wall, shape_tube(p, vec3_make(-1, 4, -20), vec3_make(0, 0, 28), 10.5, 14), 6);
    wall = shape_join(wall, shape_tube(p, vec3_make(0, 0, 26), vec3_make(28, 3, 50), 12, 9.5), 12);
    wall = shape_join(wall, shape_ball(p, vec3_make(34, 4, 55), 16.5), 5);
    wall = shape_join(wall, shape_ellipsoid(p, vec3_make(-9, -4, 40), vec3_make(10, 13, 16)), 10);
    wall = shape_join(wall, shape_ball(p, vec3_make(12, -9, 8), 6.5), 7);
    wall = shape_cut(wall, -shape_tube(p, vec3_make(2, -22, 40), vec3_make(-2, -10, 44), 5, 3), 6);
    return shape_cut(wall, -shape_ball(p, vec3_make(49, 4, 64), 3.2), 1.5);
}

typedef struct row {
    const char *name, *help;
    double (*walls[2])(vec3 p); /* the outer one, and one inside it or NULL */
    double low[3], high[3], spacing;
    float view_direction[3], up[3];
} row;
// clang-format off
static const row rows[] = {
    {"aneurysm", "a cerebral artery with an aneurysm and a bleb on it", {aneurysm, NULL},
     {-22, -12, -21}, {17, 12, 24}, 0.3, {0.25f, 0.96f, -0.12f}, {0, 0, 1}},
    {"aorta", "the arch with a bulge in which the scene `flow` flows", {aorta, NULL},
     {-48, -41, -115}, {57, 48, 49}, 1, {0.96f, -0.28f, 0}, {0, 0, 1}},
    {"liver", "a liver-like organ and a portal vein in it", {liver, portal_vein},
     {-106, -64, -84}, {98, 60, 66}, 1.5, {0.12f, -0.96f, 0.25f}, {0, 0, 1}},
    {"bone", "the upper half of a thigh bone", {bone, NULL},
     {-26, -26, -86}, {56, 26, 78}, 0.75, {-0.1f, 0.99f, -0.1f}, {0, 0, 1}},
};
// clang-format on
enum { ROWS = sizeof rows / sizeof rows[0] };

static const row *find(const char *name) {
    for (int i = 0; name && i < ROWS; i++) {
        if (strcmp(rows[i].name, name) == 0)
            return rows + i;
    }
    return NULL;
}

const char *const *scene_surface_names(uint32_t *count) {
    static const char *const names[ROWS] = {"aneurysm", "aorta", "liver", "bone"};
    *count = ROWS;
    return names;
}

const char *scene_surface_help(const char *name) {
    const row *r = find(name);
    return r ? r->help : NULL;
}

double scene_surface_distance(const char *name, const double position[3]) {
    vec3 p = vec3_make(position[0], position[1], position[2]);
    const row *r = find(name);
    double outer = r->walls[0](p), inner = r->walls[1] ? r->walls[1](p) : outer;
    return fabs(inner) < fabs(outer) ? inner : outer;
}

/* ---- meshing */

typedef double wall_function(vec3 p);

static double voxel(wall_function *wall, const flow4d_volume *volume, double x, double y,
                    double z) {
    const double *m = volume->to_world;
    return wall(vec3_make(m[0] * x + m[3], m[5] * y + m[7], m[10] * z + m[11]));
}

/* The voxels of a cube of BLOCK voxels each way. Far from the wall they are as its middle: the
 * margin is three times what a distance needs, because ours are only near to distances. */
enum { BLOCK = 6 };
static void sample_block(wall_function *wall, const flow4d_volume *volume, const uint32_t first[3],
                         float *values) {
    const double half = 0.5 * (BLOCK - 1), reach = 3 * half * sqrt(3.0) * volume->to_world[0];
    const uint32_t *n = volume->size;
    double middle = voxel(wall, volume, first[0] + half, first[1] + half, first[2] + half);
    for (uint32_t z = first[2]; z < n[2] && z < first[2] + BLOCK; z++) {
        for (uint32_t y = first[1]; y < n[1] && y < first[1] + BLOCK; y++) {
            for (uint32_t x = first[0]; x < n[0] && x < first[0] + BLOCK; x++)
                values[((size_t)z * n[1] + y) * n[0] + x] =
                    (float)(fabs(middle) > reach ? middle : voxel(wall, volume, x, y, z));
        }
    }
}

static float *sample(wall_function *wall, const flow4d_volume *volume) {
    const uint32_t *n = volume->size;
    float *values = malloc((size_t)n[0] * n[1] * n[2] * sizeof *values);
    uint32_t at[3];
    for (at[2] = 0; values && at[2] < n[2]; at[2] += BLOCK) {
        for (at[1] = 0; at[1] < n[1]; at[1] += BLOCK) {
            for (at[0] = 0; at[0] < n[0]; at[0] += BLOCK)
                sample_block(wall, volume, at, values);
        }
    }
    return values;
}

/* Moves a vertex of marching cubes onto the wall by a step of Newton's, `reach` mm at most;
 * the normal is the gradient there. */
static void settle(wall_function *wall, double reach, float *position, float *normal) {
    const double h = 0.05 * reach;
    vec3 p = vec3_make((double)position[0], (double)position[1], (double)position[2]), g;
    for (int step = 0; step < 2; step++) {
        g = vec3_make(wall(vec3_make(p.x + h, p.y, p.z)) - wall(vec3_make(p.x - h, p.y, p.z)),
                      wall(vec3_make(p.x, p.y + h, p.z)) - wall(vec3_make(p.x, p.y - h, p.z)),
                      wall(vec3_make(p.x, p.y, p.z + h)) - wall(vec3_make(p.x, p.y, p.z - h)));
        double slope = sqrt(vec3_dot(g, g)), way = step < 1 ? -wall(p) * 2 * h / slope : 0;
        way = fabs(way) < reach ? way : 0; /* no number: 0 */
        p = vec3_mad(p, g, slope > 0 ? way / slope : 0);
    }
    double size = sqrt(vec3_dot(g, g));
    const double at[3] = {p.x, p.y, p.z}, n[3] = {g.x, g.y, g.z};
    for (int k = 0; k < 3; k++) {
        position[k] = (float)at[k];
        normal[k] = size > 0 ? (float)(n[k] / size) : 0; /* 0: none */
    }
}

/* Puts a mesh of a wall behind what is there. */
static bool append(const flow4d_surface *mesh, wall_function *wall, double reach,
                   scene_surface *out) {
    uint32_t first = out->vertex_count, done = out->triangle_count;
    size_t vertices = (size_t)first + mesh->vertex_count;
    size_t triangles = (size_t)done + mesh->triangle_count;
    float *positions = realloc(out->positions, sizeof(float) * 3 * (vertices + 1));
    if (positions)
        out->positions = positions;
    float *normals = realloc(out->normals, sizeof(float) * 3 * (vertices + 1));
    if (normals)
        out->normals = normals;
    uint32_t *corners = realloc(out->triangles, sizeof(uint32_t) * 3 * (triangles + 1));
    if (corners)
        out->triangles = corners;
    if (!positions || !normals || !corners)
        return false;
    memcpy(positions + 3 * (size_t)first, mesh->vertices, sizeof(float) * 3 * mesh->vertex_count);
    for (size_t i = first; i < vertices; i++)
        settle(wall, reach, positions + 3 * i, normals + 3 * i);
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        corners[3 * (size_t)done + i] = mesh->triangles[i] + first;
    out->vertex_count = (uint32_t)vertices;
    out->triangle_count = (uint32_t)triangles;
    return true;
}

static bool march(wall_function *wall, flow4d_volume *volume, scene_surface *out) {
    flow4d_surface_settings settings;
    flow4d_surface mesh;
    float *values = sample(wall, volume);
    memset(&settings, 0, sizeof settings);
    settings.inside_is_less = 1;
    volume->values = values;
    bool good = values && flow4d_surface_make(NULL, volume, 0, &settings, &mesh) == LAO_OK;
    free(values);
    if (!good)
        return false;
    good = append(&mesh, wall, 0.3 * volume->to_world[0], out);
    flow4d_surface_free(&mesh);
    return good;
}

bool scene_surface_make(const char *name, double spacing, scene_surface *out) {
    const row *r = find(name);
    flow4d_volume volume;
    scene_surface made;
    spacing = r && spacing == 0 ? r->spacing : spacing;
    if (!r || !(spacing >= 0.04 * r->spacing && spacing <= 100 * r->spacing))
        return false;
    memset(&made, 0, sizeof made);
    for (int i = 0; i < 2 && r->walls[i]; i++) {
        memset(&volume, 0, sizeof volume);
        for (size_t a = 0; a < 3; a++) {
            volume.size[a] = (uint32_t)ceil((r->high[a] - r->low[a]) / spacing) + 1;
            volume.to_world[5 * a] = spacing;
            volume.to_world[4 * a + 3] = r->low[a];
        }
        if (!march(r->walls[i], &volume, &made)) {
            scene_surface_free(&made);
            return false;
        }
        spacing /= 2; /* what is inside is finer */
    }
    memcpy(made.view_direction, r->view_direction, sizeof made.view_direction);
    memcpy(made.up, r->up, sizeof made.up);
    *out = made;
    return true;
}

void scene_surface_free(scene_surface *surface) {
    free(surface->positions);
    free(surface->normals);
    free(surface->triangles);
    memset(surface, 0, sizeof *surface);
}
