/* Constrained growth: random places of the organ that are farther than a reach from every vessel
   pull a curved branch out of the nearest node that may have one; when nearly all places are within
   reach, the reach shrinks. Coarse branches thus come first and carry the finer ones. Radii follow
   from Murray's law. */
#include "scene_tree.h"

#include "scene_build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const vec3 liver = {90, 60, 70}, hilum = {-20, -25, -55};
static const vec3 tumour = {32, 8, 12};
static const double tumour_radius = 16, root_radius = 6.5;

typedef struct growth {
    scene_tree tree;
    uint32_t room, seed, sample;
    vec3 *nodes, *directions; /* direction of growth at each node */
    uint8_t *children;
    uint32_t *head, *next; /* nodes of each cell */
    int size[3];
    double reach, cell;
} growth;

static vec3 inside_liver(vec3 p, double most) {
    vec3 u = vec3_make(p.x / liver.x, p.y / liver.y, p.z / liver.z);
    double d = sqrt(vec3_dot(u, u));
    return d > most ? vec3_scale(p, most / d) : p;
}
static vec3 outside_tumour(vec3 p) {
    vec3 d = vec3_sub(p, tumour);
    double apart = sqrt(vec3_dot(d, d)), least = tumour_radius * 1.001;
    return apart < least ? vec3_mad(tumour, vec3_unit(d), least) : p;
}
static double apart(vec3 a, vec3 b) {
    vec3 d = vec3_sub(a, b);
    return sqrt(vec3_dot(d, d));
}

/* ---- cells as wide as the reach, or a 64th of the organ */
static int cell_of(const growth *g, double v, double half, int axis) {
    int i = (int)floor((v + half) / g->cell);
    return i < 0 ? 0 : i >= g->size[axis] ? g->size[axis] - 1 : i;
}
static uint32_t *cell_at(const growth *g, vec3 p, int dx, int dy, int dz) {
    int x = cell_of(g, p.x, liver.x, 0) + dx, y = cell_of(g, p.y, liver.y, 1) + dy,
        z = cell_of(g, p.z, liver.z, 2) + dz;
    if (x < 0 || y < 0 || z < 0 || x >= g->size[0] || y >= g->size[1] || z >= g->size[2])
        return NULL;
    return g->head + ((size_t)z * (size_t)g->size[1] + (size_t)y) * (size_t)g->size[0] + (size_t)x;
}
static void keep(growth *g, uint32_t node) {
    uint32_t *head = cell_at(g, g->nodes[node], 0, 0, 0);
    g->next[node] = *head;
    *head = node;
}
enum { CELLS = 64 };
static void set_reach(growth *g, double reach) {
    const double half[] = {liver.x, liver.y, liver.z};
    g->reach = reach;
    g->cell = fmax(reach, 2 * liver.x / CELLS);
    for (int k = 0; k < 3; k++)
        g->size[k] = (int)fmin(CELLS, ceil(2 * half[k] / g->cell));
    memset(g->head, 0xff, sizeof *g->head * CELLS * CELLS * CELLS);
    for (uint32_t i = 0; i < g->tree.node_count; i++)
        keep(g, i);
}

/* The nearest node with a free place within the cells up to `rings` away; *covered: some node, free
   or not, is within reach. */
static uint32_t nearest_free(const growth *g, vec3 p, int rings, bool *covered) {
    uint32_t best = UINT32_MAX;
    double least = 1e9;
    for (int i = 0, wide = 2 * rings + 1; i < wide * wide * wide; i++) {
        const uint32_t *head =
            cell_at(g, p, i % wide - rings, i / wide % wide - rings, i / wide / wide - rings);
        for (uint32_t n = head ? *head : UINT32_MAX; n != UINT32_MAX; n = g->next[n]) {
            double d = apart(g->nodes[n], p);
            *covered = *covered || d < g->reach;
            if (d < least && g->children[n] < (n == 0 ? 1 : 2)) {
                least = d;
                best = n;
            }
        }
    }
    return least <= rings * g->cell ? best : UINT32_MAX;
}

static uint32_t add_node(growth *g, uint32_t parent, vec3 p) {
    uint32_t i = g->tree.node_count++;
    g->nodes[i] = p;
    g->children[i] = 0;
    g->directions[i] = vec3_make(0, 0, 1);
    if (i > 0) {
        g->tree.segments[2 * i - 2] = parent;
        g->tree.segments[2 * i - 1] = i;
        g->directions[i] = vec3_unit(vec3_sub(p, g->nodes[parent]));
        g->children[parent]++;
    }
    if (g->head)
        keep(g, i);
    return i;
}

/* A branch that leaves along the vessel and bends to the target. */
static void add_branch(growth *g, uint32_t from, vec3 target) {
    vec3 a = g->nodes[from], to = vec3_sub(target, a);
    double length = sqrt(vec3_dot(to, to)), step = fmax(0.3 * g->reach, 0.4);
    vec3 lead = vec3_unit(vec3_mad(vec3_scale(g->directions[from], 0.5), vec3_unit(to), 0.5));
    vec3 control = vec3_mad(a, lead, 0.45 * length);
    int count = (int)ceil(length / step);
    for (int i = 1; i <= count && g->tree.node_count < g->room; i++) {
        double t = (double)i / count, s = 1 - t;
        vec3 p = vec3_scale(a, s * s);
        p = vec3_mad(p, control, 2 * s * t);
        p = vec3_mad(p, target, t * t);
        from = add_node(g, from, outside_tumour(inside_liver(p, 0.98)));
    }
}

static vec3 random_place(growth *g) {
    vec3 p;
    do {
        uint32_t i = g->sample++;
        p = vec3_make(2 * scene_random(g->seed, i, 0) - 1, 2 * scene_random(g->seed, i, 1) - 1,
                      2 * scene_random(g->seed, i, 2) - 1);
    } while (vec3_dot(p, p) > 0.95);
    return vec3_make(p.x * liver.x, p.y * liver.y, p.z * liver.z);
}

static void grow(growth *g) {
    int idle = 0;
    add_node(g, 0, hilum);
    set_reach(g, 40);
    if (g->room > 1)
        add_branch(g, 0, vec3_make(-5, -5, -20));
    while (g->tree.node_count < g->room) {
        vec3 p = outside_tumour(random_place(g));
        bool covered = false;
        uint32_t node = nearest_free(g, p, 1, &covered);
        for (int rings = 2; node == UINT32_MAX && !covered && rings <= CELLS; rings *= 2)
            node = nearest_free(g, p, rings, &covered);
        if (!covered && node != UINT32_MAX) {
            add_branch(g, node, p);
            idle = 0;
        } else if (++idle == 100) {
            set_reach(g, 0.85 * g->reach);
            idle = 0;
        }
    }
}

/* r^3 of a node is the sum over its children; leaves have equal radii (Murray 1926). */
static void set_radii(growth *g, double *cubes) {
    uint32_t n = g->tree.node_count;
    for (uint32_t i = n; i-- > 0;) {
        cubes[i] = g->children[i] ? cubes[i] : 1;
        if (i > 0)
            cubes[g->tree.segments[2 * i - 2]] += cubes[i];
    }
    for (size_t i = 0; i < n; i++) {
        double r = root_radius * cbrt(cubes[i] / cubes[0]);
        g->tree.radii[i] = (float)r;
        g->tree.positions[3 * i] = (float)g->nodes[i].x;
        g->tree.positions[3 * i + 1] = (float)g->nodes[i].y;
        g->tree.positions[3 * i + 2] = (float)g->nodes[i].z;
    }
}

bool scene_tree_make(uint32_t node_count, uint32_t seed, scene_tree *out) {
    growth g = {0};
    size_t n = g.room = node_count ? node_count : 3000;
    if (n > SCENE_TREE_MOST)
        return false;
    g.seed = seed;
    g.tree.positions = malloc(3 * n * sizeof(float));
    g.tree.radii = malloc(n * sizeof(float));
    g.tree.segments = malloc(2 * n * sizeof(uint32_t));
    g.nodes = malloc(n * sizeof *g.nodes);
    g.directions = malloc(n * sizeof *g.directions);
    g.children = malloc(n);
    g.next = malloc(n * sizeof *g.next);
    g.head = malloc(sizeof *g.head * CELLS * CELLS * CELLS);
    double *cubes = calloc(n, sizeof *cubes);
    bool ok = g.tree.positions && g.tree.radii && g.tree.segments && g.nodes && g.directions &&
              g.children && g.next && g.head && cubes;
    if (ok) {
        const float shape[] = {(float)liver.x, (float)liver.y, (float)liver.z};
        const float ball[] = {(float)tumour.x, (float)tumour.y, (float)tumour.z,
                              (float)tumour_radius};
        memset(g.head, 0xff, sizeof *g.head * CELLS * CELLS * CELLS);
        g.cell = liver.x;
        g.size[0] = g.size[1] = g.size[2] = 1;
        grow(&g);
        set_radii(&g, cubes);
        g.tree.segment_count = g.tree.node_count - 1;
        memcpy(g.tree.liver, shape, sizeof shape);
        memcpy(g.tree.tumour, ball, sizeof ball);
        *out = g.tree;
    } else {
        scene_tree_free(&g.tree);
    }
    free(g.nodes);
    free(g.directions);
    free(g.children);
    free(g.next);
    free(g.head);
    free(cubes);
    return ok;
}

void scene_tree_free(scene_tree *tree) {
    free(tree->positions);
    free(tree->radii);
    free(tree->segments);
    memset(tree, 0, sizeof *tree);
}
