#include "pick.h"

#include "orbit.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A ray in mm about the scene's origin; what lies within `slope` * t + `near` of it is under the
 * pointer. */
typedef struct pick_ray {
    double from[3], to[3]; /* to: unit direction */
    double near, slope;
} pick_ray;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void say(picked *out, const char *format, ...) CLI_PRINTF(2, 3);
static void say(picked *out, const char *format, ...) {
    size_t used = strlen(out->text);
    va_list list;
    va_start(list, format);
    vsnprintf(out->text + used, sizeof out->text - used, format, list);
    va_end(list);
}

static void place(const document *doc, const double at[3], picked *out) {
    for (int k = 0; k < 3; k++)
        out->at[k] = at[k] + doc->scene->origin[k];
    say(out, "at %.5g, %.5g, %.5g mm", out->at[0], out->at[1], out->at[2]);
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
static void pick_lines(const document *doc, const cli_shot *shot, const pick_ray *ray,
                       double *first, picked *out) {
    double best = INFINITY, t, part, found[3] = {0, 0, 0};
    for (uint32_t s = 0; s < doc->scene->count; s++) {
        const cli_set *set = &doc->scene->sets[s];
        lao_settings settings = lao_settings_filled(&set->settings);
        for (uint32_t i = 0; i < set->lines.line_count && !set->object && !set->overlay; i++) {
            uint32_t end = set->lines.offsets[i + 1];
            for (uint32_t p = set->lines.offsets[i]; p + 1 < end; p++) {
                const float *a = set->lines.points + 3 * (size_t)p;
                double away = from_segment(ray, a, a + 3, &t, &part);
                double half = 0.5 * (double)settings.width, free = ray->near + ray->slope * t;
                double score = away <= half ? t : 1e9 + away;
                if (!(t > 0 && away <= half + free && score < best) ||
                    !is_shown(set, &settings, p, (double)shot->time))
                    continue;
                best = score;
                *first = t;
                out->kind = PICKED_LINE;
                out->set = s;
                out->line = i;
                out->point = part > 0.5 ? p + 1 : p;
                for (int k = 0; k < 3; k++)
                    found[k] = (double)a[k] + part * ((double)a[3 + k] - (double)a[k]);
            }
        }
    }
    if (out->kind == PICKED_LINE)
        place(doc, found, out);
}

static void say_row(picked *out, const io_attribute *a, size_t row) {
    say(out, "\n%s:", a->name);
    for (uint32_t k = 0; k < a->components && k < 4; k++)
        say(out, " %.5g", (double)a->data[row * a->components + k]);
}

static void tell_line(const document *doc, picked *out) {
    const cli_set *set = &doc->scene->sets[out->set];
    const io_lines *lines = &set->lines;
    uint32_t first = lines->offsets[out->line], end = lines->offsets[out->line + 1];
    double length = 0;
    for (uint32_t p = first; p + 1 < end; p++) {
        const float *a = lines->points + 3 * (size_t)p;
        double d[3] = {(double)a[3] - (double)a[0], (double)a[4] - (double)a[1],
                       (double)a[5] - (double)a[2]};
        length += sqrt(dot(d, d));
    }
    say(out, "\nline %u of %s, point %u of %u, %.5g mm long", out->line, set->name,
        out->point - first, end - first, length);
    for (uint32_t i = 0; i < lines->point_attribute_count && i < 6; i++)
        say_row(out, &lines->point_attributes[i], out->point);
    for (uint32_t i = 0; i < lines->line_attribute_count && i < 4; i++)
        say_row(out, &lines->line_attributes[i], out->line);
}

/* ---- trees ------------------------------------------------------------------------------- */

static void tell_node(const cli_tree *of, uint32_t node, picked *out) {
    const sdv_tree *tree = &of->vessel.tree;
    uint32_t owner = of->reduced.owners[node];
    say(out, "\nnode %u, radius %.4g mm", node, (double)tree->nodes[node].w);
    if (of->distances && owner != SDV_NONE)
        say(out, "\n%.4g mm from the target", (double)of->distances[owner]);
    for (uint32_t i = 0; i < tree->node_attribute_count && i < 6; i++) {
        const sdv_attribute *a = &tree->node_attributes[i];
        say(out, "\n%s: %.5g", a->name,
            (double)a->values[(size_t)node * (a->components ? a->components : 1)]);
    }
}

/* Where the ray meets a set's tree before `first`, which is moved there. */
static void pick_tree(const document *doc, uint32_t set, const pick_ray *ray, double *first,
                      picked *out) {
    const cli_tree *tree = doc->scene->sets[set].tree;
    sdv_ray r;
    sdv_hit hit;
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
    place(doc, at, out);
    say(out, "\nsegment %u of %s", hit.cone, tree->name);
    tell_node(tree, out->point, out);
}

void pick_node(const document *doc, const cli_tree *tree, uint32_t node, picked *out) {
    const lao_v4 *n = &tree->vessel.tree.nodes[node];
    const double at[3] = {(double)n->x, (double)n->y, (double)n->z};
    memset(out, 0, sizeof *out);
    out->kind = PICKED_TREE;
    while (out->set + 1 < doc->scene->count && doc->scene->sets[out->set].tree != tree)
        out->set++;
    out->line = tree->vessel.tree.parent_segments[node];
    out->point = node;
    place(doc, at, out);
    tell_node(tree, node, out);
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

/* The same of a set's wall; what is behind its front faces can be clicked through them. */
static void pick_surface(const document *doc, uint32_t set, const pick_ray *ray, double *first,
                         picked *out) {
    const cli_wall *wall = doc->scene->sets[set].wall;
    const vsf_mesh *mesh = &wall->mesh;
    double best = INFINITY, at[3], nearest = INFINITY;
    uint32_t triangle = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *c = mesh->triangles + 3 * (size_t)i;
        double t =
            to_triangle(ray, mesh->positions + 3 * (size_t)c[0], mesh->positions + 3 * (size_t)c[1],
                        mesh->positions + 3 * (size_t)c[2]);
        if (t < best) {
            best = t;
            triangle = i;
        }
    }
    if (!(best < *first))
        return;
    *first = best;
    memset(out, 0, sizeof *out);
    out->kind = PICKED_SURFACE;
    out->set = set;
    out->line = triangle;
    for (int k = 0; k < 3; k++)
        at[k] = ray->from[k] + best * ray->to[k];
    for (int i = 0; i < 3; i++) {
        uint32_t vertex = mesh->triangles[3 * (size_t)triangle + (uint32_t)i];
        const float *p = mesh->positions + 3 * (size_t)vertex;
        double d[3] = {at[0] - (double)p[0], at[1] - (double)p[1], at[2] - (double)p[2]};
        if (dot(d, d) < nearest) {
            nearest = dot(d, d);
            out->point = vertex;
        }
    }
    place(doc, at, out);
    say(out, "\ntriangle %u, vertex %u of %s", out->line, out->point, wall->name);
    if (mesh->attribute_count)
        say(out, "\n%s: %.5g", mesh->attributes[0].name, (double)wall->object.values[out->point]);
}

/* ---- all --------------------------------------------------------------------------------- */

void pick_at(const document *doc, const cli_shot *shot, double x, double y, double near,
             picked *out) {
    pick_ray ray;
    double height = orbit_height(&shot->camera);
    memset(out, 0, sizeof *out);
    orbit_ray(&shot->camera, (double)shot->width / shot->height, x, y, ray.from, ray.to);
    for (int k = 0; k < 3; k++)
        ray.from[k] -= doc->scene->origin[k];
    bool lens = shot->camera.fovy > 0;
    ray.near = lens ? 0 : near * height;
    ray.slope = lens ? near * 2 * tan(shot->camera.fovy * 3.14159265358979 / 360) : 0;
    double first = INFINITY;
    pick_lines(doc, shot, &ray, &first, out);
    for (uint32_t i = 0; i < doc->scene->count; i++) {
        if (doc->scene->sets[i].tree)
            pick_tree(doc, i, &ray, &first, out);
    }
    bool nothing = out->kind == PICKED_NOTHING;
    for (uint32_t i = 0; i < doc->scene->count && nothing; i++) {
        if (doc->scene->sets[i].wall)
            pick_surface(doc, i, &ray, &first, out);
    }
    if (out->kind == PICKED_LINE)
        tell_line(doc, out);
}

const cli_tree *picked_on(const document *doc, const picked *of) {
    bool there = of->kind == PICKED_TREE && of->set < doc->scene->count;
    const cli_tree *tree = there ? doc->scene->sets[of->set].tree : NULL;
    return tree && of->point < tree->vessel.tree.node_count ? tree : NULL;
}

const cli_tree *picked_tree(const document *doc, const picked *of) {
    const cli_tree *found = picked_on(doc, of);
    for (uint32_t i = 0; i < doc->scene->count && !found; i++)
        found = doc->scene->sets[i].tree;
    return found;
}
