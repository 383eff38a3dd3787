#include "pick.h"

#include "document.h"
#include "orbit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rays and places are in mm about the scene's origin. */
typedef boxes_ray pick_ray;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void place(const cli_scene *scene, const double at[3], picked *out) {
    for (int k = 0; k < 3; k++)
        out->at[k] = at[k] + scene->origin[k];
}

/* ---- what there is ----------------------------------------------------------------------- */

enum { RUN = 8 }; /* segments of a line that make one thing; its id is the line */

const vsf_mesh *pick_mesh(const cli_set *set) {
    const vsf_mesh *mesh = set->wall ? &set->wall->mesh : set->tree ? &set->tree->mesh : NULL;
    return mesh && mesh->triangle_count ? mesh : NULL;
}

static bool has_lines(const cli_set *set) {
    return !set->object && !set->overlay;
}

/* The last point of a run. */
static uint32_t end_of(const cli_set *set, boxes_item run) {
    uint32_t last = set->lines.offsets[run.id + 1] - 1;
    return last - run.first < RUN ? last : run.first + RUN;
}

static void include(float box[6], const float *point) {
    if (!isfinite(point[0]) || !isfinite(point[1]) || !isfinite(point[2]))
        return;
    for (int k = 0; k < 3; k++) {
        box[k] = fminf(box[k], point[k]);
        box[3 + k] = fmaxf(box[3 + k], point[k]);
    }
}

static void box_of(const void *user, boxes_item item, float box[6]) {
    const cli_set *set = user;
    const vsf_mesh *mesh = pick_mesh(set);
    for (int k = 0; k < 6; k++)
        box[k] = k < 3 ? INFINITY : -INFINITY;
    for (uint32_t i = 0; mesh && i < 3; i++)
        include(box, mesh->positions + 3 * (size_t)mesh->triangles[3 * (size_t)item.first + i]);
    for (uint32_t p = item.first; !mesh && p <= end_of(set, item); p++)
        include(box, set->lines.points + 3 * (size_t)p);
}

/* Runs of lines, or triangles. NULL: reported. */
static boxes_item *items_of(const cli_set *set, uint32_t *count) {
    const vsf_mesh *mesh = pick_mesh(set);
    const io_lines *lines = &set->lines;
    size_t most = mesh             ? mesh->triangle_count
                  : has_lines(set) ? (size_t)lines->point_count / RUN + lines->line_count
                                   : 0;
    boxes_item *items = cli_new(most, sizeof *items);
    *count = 0;
    if (!items)
        return NULL;
    for (uint32_t i = 0; mesh && i < mesh->triangle_count; i++)
        items[(*count)++] = (boxes_item){i, i};
    for (uint32_t i = 0; !mesh && has_lines(set) && i < lines->line_count; i++) {
        for (uint32_t p = lines->offsets[i]; p + 1 < lines->offsets[i + 1]; p += RUN)
            items[(*count)++] = (boxes_item){i, p};
    }
    return items;
}

bool pick_prepare(const cli_scene *scene, pickable *out) {
    out->scene = scene;
    out->count = 0;
    out->sets = cli_new(scene->count, sizeof *out->sets);
    if (!out->sets)
        return false;
    memset(out->sets, 0, scene->count * sizeof *out->sets);
    for (uint32_t i = 0; i < scene->count; i++) {
        uint32_t count;
        boxes_item *items = items_of(&scene->sets[i], &count);
        if (!items || !boxes_make(items, count, box_of, &scene->sets[i], &out->sets[i]))
            return false;
        out->count++;
        if (!cli_go_on())
            return false;
    }
    return true;
}

void pick_free(pickable *p) {
    for (uint32_t i = 0; i < p->count; i++)
        boxes_free(&p->sets[i]);
    free(p->sets);
    memset(p, 0, sizeof *p);
}

/* ---- lines ------------------------------------------------------------------------------- */

/* Distance of the ray from a segment; *t: how far along the ray, *part: along the segment. */
static double from_segment(const pick_ray *ray, const float *a, const float *b, double *t,
                           double *part) {
    double along[3], start[3], gap[3];
    for (int k = 0; k < 3; k++) {
        along[k] = (double)b[k] - (double)a[k];
        start[k] = (double)a[k] - ray->from[k];
    }
    double aa = dot(along, along), ad = dot(along, ray->to);
    double as = dot(along, start), ds = dot(ray->to, start), across = aa - ad * ad;
    double s = across > 1e-12 * aa ? (ad * ds - as) / across : 0;
    s = fmax(0, fmin(1, s));
    *part = s;
    *t = ds + s * ad;
    for (int k = 0; k < 3; k++)
        gap[k] = start[k] + s * along[k] - *t * ray->to[k];
    return sqrt(dot(gap, gap));
}

/* Is a point drawn at that time? */
static bool is_shown(const cli_set *set, const lao_settings *s, uint32_t point, double time) {
    if (!set->times || !(s->trail > 0) || (int)s->trail == LAO_TRAIL_HIGHLIGHT)
        return true;
    double away = fabs((double)set->times[point] - time), period = (double)s->period;
    if (period > 0) {
        away = fmod(away, period);
        away = fmin(away, period - away);
    }
    return away <= (double)s->trail_length;
}

/* The nearest to the eye of those that the pointer is on; else the nearest to the pointer. */
typedef struct line_search {
    const pick_ray *ray;
    const cli_set *set;
    lao_settings settings;
    uint32_t index; /* of the set */
    double time, best, part;
    picked *out;
    double *first; /* way along the ray */
    uint32_t from; /* the segment's first point */
} line_search;

#define BESIDE 1e9 /* scores of those that the pointer is not quite on */

static double search_run(void *user, boxes_item run) {
    line_search *s = user;
    double half = 0.5 * (double)s->settings.width, t, part;
    for (uint32_t p = run.first, end = end_of(s->set, run); p < end; p++) {
        const float *a = s->set->lines.points + 3 * (size_t)p;
        double away = from_segment(s->ray, a, a + 3, &t, &part);
        double reach = half + s->ray->near + s->ray->slope * t;
        double score = away <= half ? t : BESIDE + away;
        if (!(t > 0 && away <= reach && score < s->best) ||
            !is_shown(s->set, &s->settings, p, s->time))
            continue;
        s->best = score;
        s->part = part;
        s->from = p;
        *s->first = t;
        s->out->kind = PICKED_LINE;
        s->out->set = s->index;
        s->out->line = run.id;
        s->out->point = part > 0.5 ? p + 1 : p;
    }
    return s->best < BESIDE ? s->best : INFINITY;
}

static void pick_lines(const pickable *p, const cli_shot *shot, const pick_ray *ray, double *first,
                       picked *out) {
    line_search s;
    double found[3] = {0, 0, 0};
    memset(&s, 0, sizeof s);
    s.ray = ray;
    s.best = INFINITY;
    s.time = (double)shot->time;
    s.out = out;
    s.first = first;
    for (uint32_t i = 0; i < p->count; i++) {
        double before = s.best;
        s.set = &p->scene->sets[i];
        if (!has_lines(s.set))
            continue;
        s.settings = lao_settings_filled(&s.set->settings);
        s.index = i;
        pick_ray wide = *ray;
        wide.near += 0.5 * (double)s.settings.width;
        boxes_along(&p->sets[i], &wide, search_run, &s);
        const float *a = s.set->lines.points + 3 * (size_t)s.from;
        for (int k = 0; k < 3 && s.best < before; k++)
            found[k] = (double)a[k] + s.part * ((double)a[3 + k] - (double)a[k]);
    }
    if (out->kind == PICKED_LINE)
        place(p->scene, found, out);
}

/* ---- trees ------------------------------------------------------------------------------- */

/* Where the ray meets a set's tree before `first`, which is moved there. */
static void pick_tree(const cli_scene *scene, uint32_t set, const pick_ray *ray, double *first,
                      picked *out) {
    const cli_tree *tree = scene->sets[set].tree;
    sdv_ray r;
    sdv_hit hit;
    if (!tree->grid.cone_count)
        return;
    memset(&r, 0, sizeof r);
    r.origin = lao_v3_make((float)ray->from[0], (float)ray->from[1], (float)ray->from[2]);
    r.direction = lao_v3_make((float)ray->to[0], (float)ray->to[1], (float)ray->to[2]);
    sdv_trace_shapes(&tree->grid, tree->carving.shapes.count ? &tree->carving.shapes : NULL, &r,
                     &hit, NULL);
    if (hit.cone >= tree->grid.cone_count)
        return;
    const double at[3] = {(double)hit.position.x, (double)hit.position.y, (double)hit.position.z};
    double way[3];
    for (int k = 0; k < 3; k++)
        way[k] = at[k] - ray->from[k];
    if (!(dot(way, ray->to) < *first))
        return;
    *first = dot(way, ray->to);
    memset(out, 0, sizeof *out);
    out->kind = PICKED_TREE;
    out->set = set;
    out->line = hit.cone;
    out->point = tree->grid.cone_nodes[2 * (size_t)hit.cone + 1];
    place(scene, at, out);
}

void pick_node(const cli_scene *scene, const cli_tree *tree, uint32_t node, picked *out) {
    const lao_v4 *n = &tree->vessel.tree.nodes[node];
    const double at[3] = {(double)n->x, (double)n->y, (double)n->z};
    memset(out, 0, sizeof *out);
    out->kind = PICKED_TREE;
    while (out->set + 1 < scene->count && scene->sets[out->set].tree != tree)
        out->set++;
    out->line = tree->vessel.tree.parent_segments[node];
    out->point = node;
    place(scene, at, out);
    pick_tell(scene, out);
}

/* ---- surfaces ---------------------------------------------------------------------------- */

/* Moeller and Trumbore 1997; INFINITY: missed. */
static double to_triangle(const pick_ray *ray, const float *a, const float *b, const float *c) {
    double e[3], f[3], s[3];
    for (int k = 0; k < 3; k++) {
        e[k] = (double)b[k] - (double)a[k];
        f[k] = (double)c[k] - (double)a[k];
        s[k] = ray->from[k] - (double)a[k];
    }
    const double *d = ray->to;
    double p[3] = {d[1] * f[2] - d[2] * f[1], d[2] * f[0] - d[0] * f[2], d[0] * f[1] - d[1] * f[0]};
    double q[3] = {s[1] * e[2] - s[2] * e[1], s[2] * e[0] - s[0] * e[2], s[0] * e[1] - s[1] * e[0]};
    double det = dot(e, p), u = dot(s, p) / det, v = dot(d, q) / det, t = dot(f, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : INFINITY;
}

typedef struct triangle_search {
    const pick_ray *ray;
    const vsf_mesh *mesh;
    double best;
    uint32_t triangle;
} triangle_search;

static double search_triangle(void *user, boxes_item item) {
    triangle_search *s = user;
    const uint32_t *c = s->mesh->triangles + 3 * (size_t)item.first;
    const float *p = s->mesh->positions;
    double t =
        to_triangle(s->ray, p + 3 * (size_t)c[0], p + 3 * (size_t)c[1], p + 3 * (size_t)c[2]);
    if (t < s->best) {
        s->best = t;
        s->triangle = item.first;
    }
    return s->best;
}

/* The corner of a triangle that is nearest to a place on it. */
static uint32_t nearest_corner(const vsf_mesh *mesh, uint32_t triangle, const double at[3]) {
    double nearest = INFINITY;
    uint32_t best = 0;
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t vertex = mesh->triangles[3 * (size_t)triangle + i];
        const float *p = mesh->positions + 3 * (size_t)vertex;
        double d[3] = {at[0] - (double)p[0], at[1] - (double)p[1], at[2] - (double)p[2]};
        if (dot(d, d) < nearest) {
            nearest = dot(d, d);
            best = vertex;
        }
    }
    return best;
}

/* The same of a set's triangles; what is behind the front faces of a wall is picked through them.
 */
static void pick_surface(const pickable *p, uint32_t set, const pick_ray *ray, double *first,
                         picked *out) {
    pick_ray thin = *ray;
    thin.near = thin.slope = 0;
    triangle_search s = {ray, pick_mesh(&p->scene->sets[set]), *first, 0};
    double at[3];
    boxes_along(&p->sets[set], &thin, search_triangle, &s);
    if (!(s.best < *first))
        return;
    *first = s.best;
    memset(out, 0, sizeof *out);
    out->kind = PICKED_SURFACE;
    out->set = set;
    out->line = s.triangle;
    for (int k = 0; k < 3; k++)
        at[k] = ray->from[k] + s.best * ray->to[k];
    out->point = nearest_corner(s.mesh, s.triangle, at);
    place(p->scene, at, out);
}

/* ---- all --------------------------------------------------------------------------------- */

void pick_at(const pickable *p, const cli_shot *shot, double x, double y, double near,
             picked *out) {
    const cli_scene *scene = p->scene;
    pick_ray ray;
    double height = orbit_height(&shot->camera), first = INFINITY;
    memset(out, 0, sizeof *out);
    orbit_ray(&shot->camera, (double)shot->width / shot->height, x, y, ray.from, ray.to);
    for (int k = 0; k < 3; k++)
        ray.from[k] -= scene->origin[k];
    bool lens = shot->camera.fovy > 0;
    ray.near = lens ? 0 : near * height;
    ray.slope = lens ? near * 2 * tan(shot->camera.fovy * 3.14159265358979 / 360) : 0;
    pick_lines(p, shot, &ray, &first, out);
    for (uint32_t i = 0; i < p->count; i++) {
        if (scene->sets[i].tree)
            pick_tree(scene, i, &ray, &first, out);
    }
    bool nothing = out->kind == PICKED_NOTHING;
    for (uint32_t i = 0; i < p->count && nothing; i++) {
        if (pick_mesh(&scene->sets[i]))
            pick_surface(p, i, &ray, &first, out);
    }
    pick_tell(scene, out);
}

const cli_tree *picked_on(const cli_scene *scene, const picked *of) {
    bool there = of->kind == PICKED_TREE && of->set < scene->count;
    const cli_tree *tree = there ? scene->sets[of->set].tree : NULL;
    return tree && of->point < tree->vessel.tree.node_count ? tree : NULL;
}

const cli_tree *picked_tree(const cli_scene *scene, const picked *of) {
    const cli_tree *found = picked_on(scene, of);
    for (uint32_t i = 0; i < scene->count && !found; i++)
        found = scene->sets[i].tree;
    return found;
}
