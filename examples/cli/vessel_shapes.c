/* Shapes for a tree: those it is cut with, and those that distances are measured to. */
#include "vessel.h"

#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIELD_CELLS = 64 }; /* along the longest axis of a shape from a file */

/* ---- meshes ----------------------------------------------------------------------------- */

/* A mesh in mm around the tree's origin. */
typedef struct solid_mesh {
    float *points;
    uint32_t *triangles;
    uint32_t point_count, triangle_count;
} solid_mesh;

/* A text that is no numbers is a name: of a file, or of nothing, which is more likely a slip. */
static bool is_file(const char *path) {
    FILE *file = fopen(path, "rb");
    return file && fclose(file) == 0;
}

static bool has_mesh(const cli_source *source, io_contents *contents) {
    memset(contents, 0, sizeof *contents);
    return cli_read(source, IO_MESH, contents);
}

/* Moves what is needed out of the contents. */
static bool take_mesh(const cli_tree *tree, const char *path, io_mesh *mesh, solid_mesh *out) {
    if (!mesh->triangle_count)
        return cli_fail("%s: has no triangles", path);
    for (uint32_t i = 0; i < 3 * mesh->vertex_count; i++) {
        uint32_t k = i % 3;
        double p = ((double)mesh->positions[i] + mesh->origin[k]) * mesh->millimetres;
        mesh->positions[i] = (float)(p - tree->vessel.origin[k]);
    }
    out->points = mesh->positions;
    out->triangles = mesh->triangles;
    out->point_count = mesh->vertex_count;
    out->triangle_count = mesh->triangle_count;
    mesh->positions = NULL;
    mesh->triangles = NULL;
    return true;
}

static bool mesh_target(const cli_tree *tree, const solid_mesh *mesh, sdv_target **target) {
    sdv_target_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.points = mesh->points;
    desc.point_count = mesh->point_count;
    desc.triangles = mesh->triangles;
    desc.triangle_count = mesh->triangle_count;
    return sdv_target_create(&tree->host, &desc, target) == LAO_OK;
}

/* ---- targets ---------------------------------------------------------------------------- */

static bool point_target(cli_tree *tree, const double *numbers, uint32_t count, double radius) {
    sdv_target_desc desc;
    float *points = cli_new(count, 3 * sizeof *points);
    if (!points)
        return false;
    for (uint32_t i = 0; i < 3 * count; i++)
        points[i] = (float)(numbers[i] - tree->vessel.origin[i % 3]);
    memset(&desc, 0, sizeof desc);
    desc.points = points;
    desc.point_count = count;
    desc.radius = (float)radius;
    bool ok = sdv_target_create(&tree->host, &desc, &tree->target) == LAO_OK;
    free(points);
    return ok;
}

/* The points of "x,y,z:x,y,z...", for free(). NULL: reported. */
static double *read_path(const char *text, uint32_t *count) {
    *count = 1;
    for (const char *c = text; *c; c++)
        *count += *c == ':';
    double *numbers = cli_new(*count, 3 * sizeof *numbers);
    char *copy = cli_new(strlen(text) + 1, 1);
    bool ok = numbers && copy, right = true;
    if (ok)
        strcpy(copy, text);
    char *at = copy;
    for (uint32_t i = 0; ok && right && i < *count; i++) {
        char *end = at + strcspn(at, ":");
        *end = '\0';
        right = cli_numbers(at, numbers + 3 * (size_t)i, 3);
        at = end + 1;
    }
    if (ok && !right)
        ok = cli_fail("--path: '%s' is not a value of it; write X,Y,Z:X,Y,Z...", text);
    free(copy);
    if (!ok)
        free(numbers);
    return ok ? numbers : NULL;
}

static bool path_target(cli_tree *tree, const char *text) {
    uint32_t count;
    double *numbers = read_path(text, &count);
    bool ok = numbers && point_target(tree, numbers, count, 0);
    free(numbers);
    return ok;
}

static bool file_target(cli_tree *tree, const char *path) {
    cli_source source = *tree->source;
    io_contents contents;
    solid_mesh mesh = {0};
    source.path = path;
    if (!is_file(path))
        return cli_fail("--target: '%s' is neither X,Y,Z,R nor a file that can be opened", path);
    if (!has_mesh(&source, &contents))
        return false;
    bool ok =
        take_mesh(tree, path, &contents.mesh, &mesh) && mesh_target(tree, &mesh, &tree->target);
    io_contents_free(&contents);
    free(mesh.points);
    free(mesh.triangles);
    return ok;
}

bool cli_target_make(cli_tree *tree) {
    const cli_target_option *aim = tree->aim;
    double ball[4];
    if (!aim)
        return true;
    if (aim->path)
        return path_target(tree, aim->text);
    if (!cli_numbers(aim->text, ball, 4))
        return file_target(tree, aim->text);
    return ball[3] >= 0 ? point_target(tree, ball, 1, ball[3])
                        : cli_fail("--target: '%s' has a radius below 0", aim->text);
}

/* ---- shapes from files: sampled signed distances ----------------------------------------- */

/* What is sampled: a mesh, or another tree. */
typedef struct sampling {
    cli_carving *carving; /* where the samples go */
    sdv_shape shape;
    float *samples;
    const sdv_target *target;
    const solid_mesh *mesh;
    const sdv_grid *grid;
} sampling;

static void find_box(sampling *s, const float low[3], const float high[3]) {
    float longest = 0, size[3];
    for (int k = 0; k < 3; k++)
        longest = fmaxf(longest, high[k] - low[k]);
    float cell = fmaxf(longest / (FIELD_CELLS - 4), 1e-6f);
    for (int k = 0; k < 3; k++)
        size[k] = ceilf((high[k] - low[k]) / cell) + 5;
    s->shape.a = lao_v4_make(low[0] - 2 * cell, low[1] - 2 * cell, low[2] - 2 * cell, cell);
    s->shape.b = lao_v4_make(size[0], size[1], size[2], s->shape.b.w);
    s->shape.kind = SDV_SHAPE_FIELD;
}

static lao_v3 sample_at(const sampling *s, uint32_t x, uint32_t y, uint32_t z) {
    return lao_v3_make(s->shape.a.x + (float)x * s->shape.a.w,
                       s->shape.a.y + (float)y * s->shape.a.w,
                       s->shape.a.z + (float)z * s->shape.a.w);
}

/* Where the line of samples (y, z) passes through a triangle, as a number of samples. The line is
 * moved a little so that it meets no edge: of two triangles at an edge it then crosses one. */
static bool crossing(const sampling *s, uint32_t triangle, double y, double z, double *x) {
    const uint32_t *t = s->mesh->triangles + 3 * (size_t)triangle;
    double p[3][3], area[3], sum = 0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            p[i][k] = (double)s->mesh->points[3 * (size_t)t[i] + (size_t)k];
    }
    for (int i = 0; i < 3; i++) {
        const double *u = p[(i + 1) % 3], *v = p[(i + 2) % 3];
        area[i] = (u[1] - y) * (v[2] - z) - (u[2] - z) * (v[1] - y);
        sum += area[i];
    }
    bool up = area[0] > 0 && area[1] > 0 && area[2] > 0;
    bool down = area[0] < 0 && area[1] < 0 && area[2] < 0;
    *x = (area[0] * p[0][0] + area[1] * p[1][0] + area[2] * p[2][0]) / sum;
    return up || down;
}

/* Turns the samples inside the mesh negative: behind an odd number of crossings along x. */
static void sign_row(const sampling *s, const uint32_t *triangles, uint32_t count, uint32_t y,
                     uint32_t z) {
    uint32_t width = (uint32_t)s->shape.b.x;
    float *row = s->samples + width * (y + (size_t)(uint32_t)s->shape.b.y * z);
    lao_v3 begin = sample_at(s, 0, y, z);
    double cell = (double)s->shape.a.w;
    for (uint32_t i = 0; i < count; i++) {
        double x;
        if (!crossing(s, triangles[i], (double)begin.y + 1.37e-5 * cell,
                      (double)begin.z + 2.71e-5 * cell, &x))
            continue;
        double first = ceil((x - (double)begin.x) / cell);
        for (uint32_t k = first > 0 ? (uint32_t)first : 0; k < width; k++)
            row[k] = -row[k];
    }
}

/* Distances of a row. Far from the mesh, where a cut only needs a lower bound, a sample takes that
 * of an earlier one less the way from it. */
static void measure_row(const sampling *s, uint32_t y, uint32_t z) {
    uint32_t width = (uint32_t)s->shape.b.x, from = 0;
    float *row = s->samples + width * (y + (size_t)(uint32_t)s->shape.b.y * z);
    for (uint32_t x = 0; x < width; x++) {
        float way = (float)(x - from) * s->shape.a.w;
        bool far = x > 0 && row[from] - way > 3 * s->shape.a.w && way < 0.5f * row[from];
        row[x] = far ? row[from] - way : sdv_target_point(s->target, sample_at(s, x, y, z));
        from = far ? from : x;
    }
}

/* Triangles that reach into a layer; then its rows. */
static void sample_mesh(void *user, uint32_t z) {
    sampling *s = user;
    uint32_t height = (uint32_t)s->shape.b.y;
    for (uint32_t y = 0; y < height; y++)
        measure_row(s, y, z);
    float place = sample_at(s, 0, 0, z).z;
    uint32_t *near = malloc(((size_t)s->mesh->triangle_count + 1) * sizeof *near), count = 0;
    for (uint32_t i = 0; near && i < s->mesh->triangle_count; i++) {
        const uint32_t *t = s->mesh->triangles + 3 * (size_t)i;
        float low = INFINITY, high = -INFINITY;
        for (int k = 0; k < 3; k++) {
            low = fminf(low, s->mesh->points[3 * (size_t)t[k] + 2]);
            high = fmaxf(high, s->mesh->points[3 * (size_t)t[k] + 2]);
        }
        if (low <= place + s->shape.a.w && high >= place - s->shape.a.w)
            near[count++] = i;
    }
    for (uint32_t y = 0; y < height; y++)
        sign_row(s, near, count, y, z);
    free(near);
}

/* Far from the tree the grid's distance may be up to 3.5 cells too great, which a cut must not be.
 */
static void sample_tree(void *user, uint32_t z) {
    sampling *s = user;
    uint32_t width = (uint32_t)s->shape.b.x, height = (uint32_t)s->shape.b.y;
    float near = 1.125f * s->grid->cell;
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            float d = sdv_grid_distance(s->grid, sample_at(s, x, y, z), NULL);
            s->samples[x + width * (y + (size_t)height * z)] =
                d > near ? fmaxf(near, d - 3.5f * s->grid->cell) : d;
        }
    }
}

/* Appends the samples of a shape to those of all. */
static bool add_field(cli_tree *tree, sampling *s, void (*fn)(void *user, uint32_t z)) {
    sdv_shapes *all = &s->carving->shapes;
    const lao_v4 b = s->shape.b;
    double count = (double)b.x * (double)b.y * (double)b.z;
    size_t room = all->field_count + (size_t)count;
    float *grown = realloc(s->carving->fields, room * sizeof *grown);
    if (!grown)
        return cli_fail("out of memory");
    s->carving->fields = grown;
    s->samples = grown + all->field_count;
    s->shape.b.w = (float)all->field_count;
    tree->host.job.run(tree->host.job.user, (uint32_t)b.z, fn, s);
    all->field_count = (uint32_t)room;
    all->fields = grown;
    return cli_go_on();
}

static bool mesh_field(cli_tree *tree, const char *path, io_mesh *read, sampling *s) {
    solid_mesh mesh = {0};
    sdv_target *target = NULL;
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    bool ok = take_mesh(tree, path, read, &mesh) && mesh_target(tree, &mesh, &target);
    for (uint32_t i = 0; ok && i < 3 * mesh.point_count; i++) {
        low[i % 3] = fminf(low[i % 3], mesh.points[i]);
        high[i % 3] = fmaxf(high[i % 3], mesh.points[i]);
    }
    if (ok) {
        sampling own = *s; /* what it refers to ends here */
        find_box(&own, low, high);
        own.target = target;
        own.mesh = &mesh;
        ok = add_field(tree, &own, sample_mesh);
        s->shape = own.shape;
    }
    sdv_target_free(target);
    free(mesh.points);
    free(mesh.triangles);
    return ok;
}

static bool tree_field(cli_tree *tree, const char *path, const io_tree *read, sampling *s) {
    io_vessel other;
    io_error error;
    sdv_grid grid;
    if (!io_vessel_build(&tree->host, read, &other, &error))
        return cli_fail("%s: %s", path, error.text);
    memset(&grid, 0, sizeof grid);
    for (uint32_t i = 0; i < other.tree.node_count; i++) {
        lao_v4 *p = &other.tree.nodes[i];
        const double *from = other.origin, *to = tree->vessel.origin;
        *p = lao_v4_make((float)((double)p->x + from[0] - to[0]),
                         (float)((double)p->y + from[1] - to[1]),
                         (float)((double)p->z + from[2] - to[2]), p->w);
    }
    bool ok = sdv_grid_build(&tree->host, &other.tree, NULL, &grid) == LAO_OK;
    if (ok) {
        const float low[3] = {grid.origin.x, grid.origin.y, grid.origin.z};
        float high[3];
        for (int k = 0; k < 3; k++)
            high[k] = low[k] + (float)grid.size[k] * grid.cell;
        sampling own = *s;
        find_box(&own, low, high);
        own.grid = &grid;
        ok = add_field(tree, &own, sample_tree);
        s->shape = own.shape;
    }
    sdv_grid_free(&grid);
    io_vessel_free(&other);
    return ok;
}

static bool file_shape(cli_tree *tree, cli_carving *carving, const char *path, unsigned kinds,
                       sdv_shape *shape) {
    cli_source source = *tree->source;
    io_contents contents;
    sampling s;
    source.path = path;
    memset(&s, 0, sizeof s);
    memset(&contents, 0, sizeof contents);
    s.carving = carving;
    if (!cli_read(&source, kinds, &contents))
        return false;
    tree->progress = (cli_progress){"measuring", path, -1};
    bool ok = contents.kinds & IO_TREE ? tree_field(tree, path, &contents.tree, &s)
                                       : mesh_field(tree, path, &contents.mesh, &s);
    cli_progress_end(&tree->progress);
    io_contents_free(&contents);
    *shape = s.shape;
    return ok;
}

/* ---- shapes ----------------------------------------------------------------------------- */

static bool wrong_shape(const char *text) {
    return cli_fail("%s: is no shape, nor a file that can be opened; write sphere:X,Y,Z,R, "
                    "box:X,Y,Z,X,Y,Z (two corners), "
                    "plane:NX,NY,NZ,D, ellipsoid:X,Y,Z,A,B,C (half axes), tree or a FILE",
                    text);
}

static bool parse_shape(cli_tree *tree, const char *text, sdv_shape *shape) {
    const double *o = tree->vessel.origin;
    double v[6];
    memset(shape, 0, sizeof *shape);
    if (strncmp(text, "sphere:", 7) == 0) {
        if (!cli_numbers(text + 7, v, 4) || !(v[3] > 0))
            return wrong_shape(text);
        shape->kind = SDV_SHAPE_BALL;
        shape->a = lao_v4_make((float)(v[0] - o[0]), (float)(v[1] - o[1]), (float)(v[2] - o[2]),
                               (float)v[3]);
    } else if (strncmp(text, "box:", 4) == 0) {
        if (!cli_numbers(text + 4, v, 6))
            return wrong_shape(text);
        shape->kind = SDV_SHAPE_BOX;
        shape->a =
            lao_v4_make((float)(0.5 * (v[0] + v[3]) - o[0]), (float)(0.5 * (v[1] + v[4]) - o[1]),
                        (float)(0.5 * (v[2] + v[5]) - o[2]), 0);
        shape->b = lao_v4_make((float)(0.5 * fabs(v[3] - v[0])), (float)(0.5 * fabs(v[4] - v[1])),
                               (float)(0.5 * fabs(v[5] - v[2])), 0);
    } else if (strncmp(text, "ellipsoid:", 10) == 0) {
        if (!cli_numbers(text + 10, v, 6) || !(v[3] > 0 && v[4] > 0 && v[5] > 0))
            return wrong_shape(text);
        shape->kind = SDV_SHAPE_ELLIPSOID;
        shape->a = lao_v4_make((float)(v[0] - o[0]), (float)(v[1] - o[1]), (float)(v[2] - o[2]), 0);
        shape->b = lao_v4_make((float)v[3], (float)v[4], (float)v[5], 0);
    } else if (strcmp(text, "tree") == 0) {
        shape->kind = SDV_SHAPE_TREE;
    } else if (strncmp(text, "plane:", 6) == 0) {
        if (!cli_numbers(text + 6, v, 4))
            return wrong_shape(text);
        double size = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (!(size > 0))
            return wrong_shape(text);
        double offset = (v[3] - v[0] * o[0] - v[1] * o[1] - v[2] * o[2]) / size;
        shape->kind = SDV_SHAPE_PLANE;
        shape->a = lao_v4_make((float)(v[0] / size), (float)(v[1] / size), (float)(v[2] / size),
                               (float)offset);
    } else if (!is_file(text)) {
        return wrong_shape(text);
    } else {
        return file_shape(tree, &tree->carving, text, IO_MESH | IO_TREE, shape);
    }
    return true;
}

bool cli_carving_make(cli_tree *tree) {
    const cli_vessel_options *o = &tree->options->vessel;
    sdv_shapes *shapes = &tree->carving.shapes;
    for (uint32_t i = 0; i < o->shape_count; i++) {
        sdv_shape *shape = &tree->carving.list[i];
        if (!parse_shape(tree, o->shapes[i].text, shape))
            return false;
        shape->operation = (lao_int)o->shapes[i].operation;
        if (shape->kind == SDV_SHAPE_TREE && shape->operation == SDV_SUBTRACTION)
            return cli_fail("--subtract: tree is what the shapes are combined with; it is added "
                            "again by --union tree");
    }
    shapes->shapes = tree->carving.list;
    shapes->count = o->shape_count;
    return true;
}

/* ---- paths and targets to be seen ------------------------------------------------------- */

enum { MARKER_CELLS = 48 };

/* A tree along the points, in the tree's own millimetres. */
static bool marker_tree(cli_tree *tree, const double *points, uint32_t count, float radius) {
    sdv_tree_desc desc;
    float *positions = cli_new(count, 3 * sizeof *positions),
          *radii = cli_new(count, sizeof *radii);
    sdv_segment *segments = cli_new(count, sizeof *segments);
    bool ok = positions && radii && segments;
    for (uint32_t i = 0; ok && i < count; i++) {
        for (uint32_t k = 0; k < 3; k++)
            positions[3 * i + k] = (float)(points[3 * i + k] - tree->vessel.origin[k]);
        radii[i] = radius;
        segments[i] = (sdv_segment){i, i + 1};
    }
    memset(&desc, 0, sizeof desc);
    desc.node_count = count;
    desc.positions = positions;
    desc.radii = radii;
    desc.segment_count = count - 1;
    desc.segments = segments;
    ok = ok && sdv_tree_build(&tree->host, &desc, &tree->marker.tree) == LAO_OK;
    free(positions);
    free(radii);
    free(segments);
    return ok;
}

/* A mesh is added to a point that is inside the box of its samples. */
static bool marker_mesh(cli_tree *tree, const char *path) {
    cli_carving *carving = &tree->marker.carving;
    sdv_shape *shape = &carving->list[0];
    if (!file_shape(tree, carving, path, IO_MESH, shape))
        return false;
    shape->operation = SDV_UNION;
    carving->shapes.shapes = carving->list;
    carving->shapes.count = 1;
    const double *o = tree->vessel.origin;
    const double point[3] = {(double)shape->a.x + o[0], (double)shape->a.y + o[1],
                             (double)shape->a.z + o[2]};
    return marker_tree(tree, point, 1, 0);
}

static bool marker_body(cli_tree *tree, float thin) {
    const char *text = tree->aim->text;
    double ball[4];
    uint32_t count;
    if (tree->aim->path) {
        double *points = read_path(text, &count);
        bool ok = points && marker_tree(tree, points, count, thin);
        free(points);
        return ok;
    }
    if (!cli_numbers(text, ball, 4))
        return marker_mesh(tree, text);
    return marker_tree(tree, ball, 1, ball[3] > 0 ? (float)ball[3] : 2 * thin);
}

/* Green like L19's paths; a target is ochre. */
bool cli_marker_make(cli_tree *tree) {
    static const uint8_t tones[2][4] = {{214, 170, 96, 255}, {44, 150, 74, 255}};
    cli_marker *m = &tree->marker;
    const uint8_t *tone = tones[tree->aim->path];
    const float rgb[3] = {(float)tone[0] / 255, (float)tone[1] / 255, (float)tone[2] / 255};
    sdv_grid_desc desc;
    float extent = 0;
    for (int k = 0; k < 3; k++)
        extent = fmaxf(extent, (float)tree->grid.size[k] * tree->grid.cell);
    memset(&desc, 0, sizeof desc);
    desc.resolution = MARKER_CELLS;
    if (!marker_body(tree, 0.006f * extent) ||
        sdv_grid_build(&tree->host, &m->tree, &desc, &m->grid) != LAO_OK)
        return false;
    m->colors = cli_new(m->grid.cone_count, 8);
    for (uint32_t i = 0; m->colors && i < 8 * m->grid.cone_count; i++)
        m->colors[i] = tone[i % 4];
    return m->colors && sdv_object_make(&tree->host, &m->grid, m->colors, &m->object) == LAO_OK &&
           (!m->carving.shapes.count ||
            sdv_object_shapes(&tree->host, &m->carving.shapes, rgb, &m->object) == LAO_OK);
}

void cli_marker_free(cli_marker *marker) {
    sdv_object_free(&marker->object);
    free(marker->colors);
    sdv_grid_free(&marker->grid);
    sdv_tree_free(&marker->tree);
    free(marker->carving.fields);
    memset(marker, 0, sizeof *marker);
}
