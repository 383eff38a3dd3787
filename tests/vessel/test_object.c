/* What a tree brings to the module: blocks and regions list every cone that one of their cells
   lists, the images have room for all lists, a device that is too small has the CPU build the same
   grid, moves keep room and box, the vessel nearest to any place is found by a look at few, what
   cannot be is refused and nothing leaks. */
#include "vessel_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 2048, IMAGE_SIZE = 16384 };
/* places in lao_object_desc.further_items */
enum { CELLS, REGION_PARTS, REGION_ENTRIES, BLOCK_PARTS, BLOCK_ENTRIES, ENTRIES, WORDS };
static float positions[3 * MOST], radii[MOST];
static sdv_segment segments[MOST];

/* kind 1: far from the origin; 2: balls that all but hold the next; 3: no segments */
static sdv_tree tree_of(uint32_t seed, uint32_t n, double size, double radius, int kind) {
    sdv_tree t;
    vessel_random_tree(seed, n, size, radius, positions, radii, segments);
    for (uint32_t i = 0; i < n; i++) {
        positions[3 * i] += kind == 1 ? 40000.0f : 0.0f;
        if (kind == 2 && i > 0) {
            uint32_t parent = segments[i - 1].parent;
            memcpy(positions + 3 * (size_t)i, positions + 3 * (size_t)parent, 3 * sizeof(float));
            positions[3 * i + i % 3] += 1.00001f * (float)radius * (i & 4 ? 1.0f : -1.0f);
            radii[i] = radii[parent] + (float)radius < 20 * (float)radius
                           ? radii[parent] + (float)radius
                           : 0.0f;
        }
    }
    sdv_tree_desc desc = {n,    positions, radii, kind == 3 ? 0 : n - 1, segments, 0, NULL,
                          NULL, 0,         0};
    assert_int_equal(sdv_tree_build(NULL, &desc, &t), LAO_OK);
    return t;
}

static const lao_object_buffer *buffer_of(const sdv_object *object, const char *name) {
    for (uint32_t i = 0; i < object->desc.buffer_count; i++) {
        if (strcmp(object->desc.buffers[i].name, name) == 0)
            return &object->desc.buffers[i];
    }
    return NULL;
}

static void same_grid(const sdv_grid *a, const sdv_grid *b) {
    assert_memory_equal(&a->origin, &b->origin, sizeof a->origin);
    assert_memory_equal(a->size, b->size, sizeof a->size);
    assert_true(a->cell == b->cell);
    assert_memory_equal(a->cones, b->cones, 2 * a->cone_count * sizeof *a->cones);
}

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Of the block of `edge` cells along an axis that holds a cell: where a cone must be to be listed.
 */
static lao_v4 ball_of(const sdv_grid *g, uint32_t edge, const uint32_t *cell) {
    const sdv_box box = {
        g->origin, g->cell, {(float)g->size[0], (float)g->size[1], (float)g->size[2]}};
    float low[3], last[3];
    for (int k = 0; k < 3; k++) {
        uint32_t first = cell[k] / edge * edge;
        low[k] = (float)first;
        last[k] = (float)(least(first + edge, g->size[k]) - 1);
    }
    return sdv_block_reach(box, lao_v3_make(low[0], low[1], low[2]),
                           lao_v3_make(last[0], last[1], last[2]));
}
static int ball_lists(const sdv_grid *g, lao_v4 ball, uint32_t cone) {
    return sdv_round_cone(lao_v3_make(ball.x, ball.y, ball.z), g->cones[2 * (size_t)cone],
                          g->cones[2 * (size_t)cone + 1]) <= ball.w;
}

/* Cones that all blocks list, and that no cell lists what its block does not. */
static uint64_t check_blocks(const sdv_grid *g, uint32_t edge) {
    uint32_t cell[3], missing = 0;
    const uint32_t width = g->size[0] ? g->size[0] : 1, height = g->size[1] ? g->size[1] : 1;
    uint64_t listed = 0;
    assert_true(edge > 0 && g->size[0] > 0 && g->size[1] > 0);
    for (uint32_t i = 0; i < g->cell_count; i++) {
        const lao_v4 *c = &g->cells[i];
        cell[0] = i % width;
        cell[1] = i / width % height;
        cell[2] = i / width / height;
        lao_v4 ball = ball_of(g, edge, cell);
        for (uint32_t k = 0; k < (uint32_t)c->w; k++)
            missing += !ball_lists(g, ball, (uint32_t)g->ids[(size_t)c->z + k]);
        for (uint32_t k = 0; k < g->cone_count; k++) {
            if (cell[0] % edge == 0 && cell[1] % edge == 0 && cell[2] % edge == 0)
                listed += (uint64_t)ball_lists(g, ball, k);
        }
    }
    assert_int_equal(missing, 0);
    return listed;
}

static void room_for_all_lists(void **state) {
    static const struct {
        uint32_t nodes, resolution;
        double size, radius;
        int kind;
    } cases[] = {{1, 16, 10, 1, 3},     {2, 33, 10, 3, 0},   {300, 64, 50, 2, 0},
                 {200, 40, 20, 0.1, 0}, {100, 70, 30, 2, 1}, {60, 47, 30, 0.5, 2},
                 {90, 96, 30, 4, 3},    {500, 31, 50, 9, 0}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sdv_tree t =
            tree_of((uint32_t)i + 1, cases[i].nodes, cases[i].size, cases[i].radius, cases[i].kind);
        sdv_grid_desc desc = {cases[i].resolution, NULL, 0, {0, 0, 0}};
        sdv_grid g;
        sdv_object o;
        uint32_t most = 1, blocks = 1, regions = 1;
        assert_int_equal(sdv_grid_build(NULL, &t, &desc, &g), LAO_OK);
        assert_int_equal(sdv_object_make_tree(NULL, &t, &desc, IMAGE_SIZE, NULL, &o), LAO_OK);
        const uint32_t *items = o.desc.further_items;
        assert_int_equal(o.on_device, 1);
        same_grid(&o.grid, &g);
        for (int k = 0; k < 3; k++)
            most = g.size[k] > most ? g.size[k] : most;
        uint32_t edge = (most + SDV_BLOCKS - 1) / SDV_BLOCKS;
        for (int k = 0; k < 3; k++) {
            blocks *= (g.size[k] + edge - 1) / edge;
            regions *= (g.size[k] + edge * SDV_REGION - 1) / (edge * SDV_REGION);
        }
        assert_int_equal(items[CELLS], g.cell_count + 1);
        assert_int_equal(items[BLOCK_PARTS], blocks * SDV_BLOCK_PARTS + 1);
        assert_int_equal(items[REGION_PARTS],
                         regions * ((g.cone_count + SDV_CHUNK - 1) / SDV_CHUNK) + 1);
        assert_int_equal(items[WORDS], (g.size[0] + 31) / 32 * g.size[1] * g.size[2]);
        assert_in_range(g.id_count, 1, items[ENTRIES]);
        assert_in_range(check_blocks(&g, edge), 1, items[BLOCK_ENTRIES]);
        assert_in_range(check_blocks(&g, edge * SDV_REGION), 1, items[REGION_ENTRIES]);
        assert_null(buffer_of(&o, "vessel_cells"));
        assert_null(buffer_of(&o, "vessel_ids"));
        assert_non_null(buffer_of(&o, "vessel_colors"));
        assert_int_equal(buffer_of(&o, "vessel_cones")->texel_count, 2 * g.cone_count);
        sdv_object_free(&o);
        sdv_grid_free(&g);
        sdv_tree_free(&t);
    }
}

/* Too small an image each way, too few texels, too many entries for floats to count. */
static void the_cpu_builds_what_the_device_cannot(void **state) {
    const uint32_t sizes[] = {0, 1024, 2048, IMAGE_SIZE};
    (void)state;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        int small = sizes[i] < 2048;
        sdv_tree t = tree_of(3, 80, 50, 2, 0);
        lent_host host;
        sdv_host h = vessel_host_make(&host);
        sdv_grid_desc desc = {40, NULL, 0, {0, 0, 0}};
        sdv_grid g;
        sdv_object o;
        const uint32_t node = 9;
        assert_int_equal(sdv_object_make_tree(&h, &t, &desc, sizes[i], NULL, &o), LAO_OK);
        assert_int_equal(o.on_device, !small);
        assert_int_equal(host.seen[SDV_LOG_GRID_DEVICE], small);
        assert_int_equal(host.failures, 0);
        for (int turn = 0; turn < 2; turn++) {
            t.nodes[node].y = turn ? t.nodes[node].y * 0.5f : t.nodes[node].y;
            assert_int_equal(sdv_object_move(&h, &t, &node, 1, &o), LAO_OK);
            desc.origin = &o.grid.origin.x;
            desc.cell = o.grid.cell;
            memcpy(desc.size, o.grid.size, sizeof desc.size);
            assert_int_equal(sdv_grid_build(NULL, &t, &desc, &g), LAO_OK);
            same_grid(&o.grid, &g);
            if (small) {
                const lao_object_buffer *cells = buffer_of(&o, "vessel_cells");
                const lao_object_buffer *ids = buffer_of(&o, "vessel_ids");
                assert_true(cells && ids);
                assert_int_equal(cells->texel_count, g.cell_count);
                assert_int_equal(ids->texel_count, g.id_count);
                assert_memory_equal(cells->data, g.cells, g.cell_count * sizeof *g.cells);
                assert_memory_equal(ids->data, g.ids, g.id_count * sizeof *g.ids);
            }
            sdv_grid_free(&g);
        }
        sdv_object_free(&o);
        sdv_tree_free(&t);
        assert_int_equal(host.memory.bytes, 0);
    }
}

static void moves_keep_room(void **state) {
    sdv_tree t = tree_of(4, 60, 50, 2, 0);
    uint32_t items[LAO_FURTHER_ITEMS], node = 5;
    sdv_grid before;
    sdv_object o;
    (void)state;
    assert_int_equal(sdv_object_make_tree(NULL, &t, NULL, IMAGE_SIZE, NULL, &o), LAO_OK);
    memcpy(items, o.desc.further_items, sizeof items);
    before = o.grid;
    t.nodes[node].w *= 0.5f; /* shorter lists: the same room, so the same plan */
    assert_int_equal(sdv_object_move(NULL, &t, &node, 1, &o), LAO_OK);
    assert_memory_equal(items, o.desc.further_items, sizeof items);
    assert_memory_equal(&before.origin, &o.grid.origin, sizeof before.origin);
    assert_true(((const lao_v4 *)buffer_of(&o, "vessel_cones")->data) == o.grid.cones);
    t.nodes[node].x += 500; /* out of its box */
    assert_int_equal(sdv_object_move(NULL, &t, &node, 1, &o), LAO_OK);
    assert_true(o.grid.cell > before.cell);
    assert_true(o.desc.bounds[1][0] > 400);
    assert_true(o.box[0].w == o.grid.cell);
    sdv_object_free(&o);
    sdv_tree_free(&t);
}

/* As vessel_shade goes through it, but with nothing to begin with. */
static uint32_t nearest_of(const sdv_object *object, lao_v3 p, uint32_t *visits) {
    const lao_v4 *texels = (const lao_v4 *)buffer_of(object, "vessel_shapes")->data;
    const lao_v4 *cones = (const lao_v4 *)buffer_of(object, "vessel_cones")->data;
    const lao_v4 *balls = texels + (size_t)texels[0].z;
    lao_int leaves = (lao_int)texels[0].w, node = leaves > 0;
    sdv_near n = {SDV_FAR, 0, -1};
    for (; node != 0; (*visits)++) {
        if (!sdv_ball_reaches(p, balls[node], n.distance)) {
            node = sdv_ball_next(node);
        } else if (node < leaves) {
            node = 2 * node;
        } else {
            const lao_v4 *v = balls + leaves + node;
            const float ids[SDV_LEAF_CONES] = {v->x, v->y, v->z, v->w};
            for (int k = 0; k < SDV_LEAF_CONES && ids[k] >= 0; k++) {
                const lao_v4 *ends = cones + 2 * (size_t)ids[k];
                n = sdv_nearer(n, sdv_round_cone(p, ends[0], ends[1]), ids[k]);
            }
            node = sdv_ball_next(node);
        }
    }
    return (uint32_t)n.cone;
}
static void check_nearest(const sdv_object *object, const sdv_grid *grid, uint32_t most) {
    uint32_t seed = 8, visits = 0;
    for (int i = 0; i < 400; i++) {
        uint32_t cone;
        lao_v3 p = vessel_point(&seed, i % 2 ? 60 : 400);
        sdv_cones_distance(grid->cones, grid->cone_count, p, &cone);
        assert_int_equal(nearest_of(object, p, &visits), cone);
    }
    assert_true(visits < 400 * most);
}
/* By brute force, of one cone and of many, before and after moves; only where a colour asks. */
static void the_nearest_of_all(void **state) {
    const float colors[6] = {0.5f, 0.5f, 0.5f, -1, 0, 0};
    const uint32_t counts[] = {2, 5, 6, 2000};
    const sdv_shape list[2] = {{{0, 0, 0, 5}, {0, 0, 0, 0}, SDV_SHAPE_BALL, SDV_UNION},
                               {{9, 0, 0, 5}, {0, 0, 0, 0}, SDV_SHAPE_BALL, SDV_UNION}};
    const sdv_shapes shapes = {list, 2, NULL, 0};
    (void)state;
    for (uint32_t i = 0; i < 4; i++) {
        sdv_tree t = tree_of(i + 3, counts[i], 100, 3, 0);
        const sdv_grid_desc cells = {32, NULL, 0, {0, 0, 0}};
        lent_host host;
        sdv_host h = vessel_host_make(&host);
        sdv_object object;
        assert_int_equal(sdv_object_make_tree(&h, &t, &cells, IMAGE_SIZE, NULL, &object), LAO_OK);
        assert_int_equal(sdv_object_shapes(&h, &shapes, NULL, &object), LAO_OK);
        assert_int_equal(buffer_of(&object, "vessel_shapes")->texel_count, 9);
        for (uint32_t n = 1; n <= 2; n++) {
            host.memory.fail_allocation = host.memory.allocations + n;
            assert_int_equal(sdv_object_shapes(&h, &shapes, colors, &object),
                             LAO_ERROR_OUT_OF_MEMORY);
        }
        assert_int_equal(sdv_object_shapes(&h, &shapes, colors, &object), LAO_OK);
        check_nearest(&object, &object.grid, i == 3 ? 400 : 20);
        uint32_t node = counts[i] / 2;
        t.nodes[node].x *= -0.5f;
        assert_int_equal(sdv_object_move(&h, &t, &node, 1, &object), LAO_OK);
        check_nearest(&object, &object.grid, i == 3 ? 400 : 20);
        sdv_object_free(&object);
        assert_int_equal(host.memory.bytes, 0);
        sdv_tree_free(&t);
    }
}

static void what_cannot_be_is_refused(void **state) {
    sdv_tree t = tree_of(5, 30, 50, 2, 0), other = tree_of(5, 31, 50, 2, 0);
    lent_host host;
    sdv_host h = vessel_host_make(&host);
    sdv_grid_desc desc = {7, NULL, 0, {0, 0, 0}};
    uint32_t node = 30;
    sdv_object o;
    (void)state;
    assert_int_equal(sdv_object_make_tree(&h, NULL, NULL, IMAGE_SIZE, NULL, &o),
                     LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(sdv_object_make_tree(&h, &t, &desc, IMAGE_SIZE, NULL, &o),
                     LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, SDV_LOG_GRID_CELLS);
    assert_int_equal(sdv_object_move(&h, &t, NULL, 0, &o), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(sdv_object_make_tree(&h, &t, NULL, IMAGE_SIZE, NULL, &o), LAO_OK);
    assert_int_equal(sdv_object_move(&h, &t, &node, 1, &o), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.item, SDV_LOG_GRID_TREE);
    assert_int_equal(sdv_object_move(&h, &other, NULL, 0, &o), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(sdv_object_move(&h, &t, NULL, 1, &o), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(sdv_grid_update(&h, &t, NULL, 0, &o.grid), LAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(host.failures, 7);
    sdv_object_free(&o);
    sdv_object_free(&o);
    sdv_tree_free(&t);
    sdv_tree_free(&other);
    assert_int_equal(host.memory.bytes, 0);
}

/* By the device, and by the CPU in its place. */
static void memory_may_end(void **state) {
    sdv_tree t = tree_of(6, 50, 50, 2, 0);
    sdv_grid_desc desc = {24, NULL, 0, {0, 0, 0}};
    const uint32_t node = 7;
    (void)state;
    for (uint32_t image_size = 0; image_size <= IMAGE_SIZE; image_size += IMAGE_SIZE) {
        uint32_t n = 1;
        for (int made = 0; made < 2; n++) {
            lent_host host;
            sdv_host h = vessel_host_make(&host);
            sdv_object o;
            host.memory.fail_allocation = n;
            lao_result result = sdv_object_make_tree(&h, &t, &desc, image_size, NULL, &o);
            if (result == LAO_OK) {
                result = sdv_object_move(&h, &t, &node, 1, &o);
                made = result == LAO_OK ? 2 : made;
                assert_non_null(buffer_of(&o, "vessel_cones"));
                assert_int_equal(o.on_device, image_size > 0);
                sdv_object_free(&o);
            }
            assert_true(result == LAO_OK || result == LAO_ERROR_OUT_OF_MEMORY);
            assert_int_equal(host.failures, result != LAO_OK);
            assert_int_equal(host.memory.bytes, 0);
        }
        assert_in_range(n, 4, 40);
    }
    sdv_tree_free(&t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(room_for_all_lists),
        cmocka_unit_test(the_cpu_builds_what_the_device_cannot),
        cmocka_unit_test(moves_keep_room),
        cmocka_unit_test(the_nearest_of_all),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(memory_may_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
