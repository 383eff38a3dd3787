/* Fields that the device builds: every cell, every list entry and every traced and shaded pixel is
   what sdv_grid_build and a grid made by it give, to the bit, on both backends; and the CPU builds
   where the device cannot. */
#include "vessel_subject.h"

#include <math.h>

enum { WIDTH = 64, HEIGHT = 48, IMAGE_SIZE = 16384 };

/* ---- trees -------------------------------------------------------------------------------- */

static void tree_of(const float *balls, uint32_t nodes, const sdv_segment *segments, uint32_t count,
                    sdv_tree *tree) {
    float *positions = calloc(nodes, 3 * sizeof(float)), *radii = calloc(nodes, sizeof(float));
    sdv_tree_desc desc;
    memset(&desc, 0, sizeof desc);
    assert_true(positions && radii);
    for (uint32_t i = 0; i < nodes; i++) {
        memcpy(positions + 3 * (size_t)i, balls + 4 * (size_t)i, 3 * sizeof(float));
        radii[i] = balls[4 * i + 3];
    }
    desc.node_count = nodes;
    desc.positions = positions;
    desc.radii = radii;
    desc.segment_count = count;
    desc.segments = segments;
    assert_int_equal(sdv_tree_build(NULL, &desc, tree), LAO_OK);
    free(positions);
    free(radii);
}

/* ---- what is drawn ------------------------------------------------------------------------ */

/* From three times the object's size. */
static void far_make(scene *s, const lao_object_desc *object) {
    double size = 1;
    for (int k = 0; k < 3; k++) {
        size = fmax(size, fabs((double)object->bounds[0][k]));
        size = fmax(size, fabs((double)object->bounds[1][k]));
    }
    scene_make(s, object, WIDTH, HEIGHT);
    s->shot.camera = render_camera(0.3, 0.5, 0.8, 3 * size);
    render_perspective(&s->shot.camera, 40, (double)WIDTH / HEIGHT, 0.1 * size, 9 * size);
}

static float value_of(const render_image *image, uint32_t channels, size_t item, uint32_t channel) {
    float v;
    assert_true(item < (size_t)image->width * image->height);
    memcpy(&v, image->data + 4 * (item * channels + channel), sizeof v);
    return v;
}

/* The image of the cells and that of the lists against the grid; behind the lists there is -1. */
static void check_field(const render_result *result, const sdv_grid *grid) {
    const render_image *cells = render_find(result, "vessel_grid", 0);
    const render_image *lists = render_find(result, "vessel_lists", 0);
    uint32_t wrong = 0;
    assert_true(cells && lists);
    assert_int_equal(cells->format, LAO_FORMAT_RGBA32F);
    assert_true((size_t)cells->width * cells->height > grid->cell_count);
    for (uint32_t i = 0; i < grid->cell_count; i++) {
        if (memcmp(cells->data + 16 * (size_t)i, &grid->cells[i], 16) != 0 && wrong++ == 0) {
            const lao_v4 *c = &grid->cells[i];
            print_error("cell %u: %.9g %g %.9g %g, in C %.9g %g %.9g %g\n", i,
                        (double)value_of(cells, 4, i, 0), (double)value_of(cells, 4, i, 1),
                        (double)value_of(cells, 4, i, 2), (double)value_of(cells, 4, i, 3),
                        (double)c->x, (double)c->y, (double)c->z, (double)c->w);
        }
    }
    assert_int_equal(wrong, 0);
    assert_true((size_t)lists->width * lists->height >= grid->id_count);
    for (uint32_t i = 0; i < lists->width * lists->height; i++) {
        wrong += value_of(lists, 1, i, 0) != (i < grid->id_count ? grid->ids[i] : -1.0f);
    }
    assert_int_equal(wrong, 0);
}

/* Images that both results have, all of them: the same bits. */
static void same_pictures(const render_result *a, const render_result *b) {
    uint32_t both = 0;
    for (uint32_t i = 0; i < a->count; i++) {
        const render_image *other = render_find(b, a->images[i].name, a->images[i].level);
        if (other) {
            both++;
            assert_int_equal(render_compare(a->images[i].name, &a->images[i], other).texels, 0);
        }
    }
    assert_in_range(both, 5, RENDER_MOST_IMAGES);
}

/* Builds the field of a tree in both ways, draws both on both backends and compares everything. */
static void check_tree(const sdv_tree *tree, uint32_t resolution, const sdv_shapes *shapes,
                       const sdv_settings *settings) {
    render_result of_cpu[2], of_device[2];
    sdv_object device, cpu;
    sdv_grid_desc desc;
    sdv_grid grid;
    scene s;
    memset(&desc, 0, sizeof desc);
    desc.resolution = resolution;
    assert_int_equal(sdv_grid_build(NULL, tree, &desc, &grid), LAO_OK);
    assert_int_equal(sdv_object_make(NULL, &grid, NULL, &cpu), LAO_OK);
    assert_int_equal(sdv_object_make_tree(NULL, tree, &desc, IMAGE_SIZE, NULL, &device), LAO_OK);
    assert_int_equal(device.on_device, 1);
    if (shapes) {
        assert_int_equal(sdv_object_shapes(NULL, shapes, NULL, &cpu), LAO_OK);
        assert_int_equal(sdv_object_shapes(NULL, shapes, NULL, &device), LAO_OK);
    }
    for (int i = 0; i < 2; i++) {
        render_need(&render_devices[i]);
        far_make(&s, &cpu.desc);
        s.vessel = settings ? *settings : s.vessel;
        render_draw(&render_devices[i], &s.shot, &of_cpu[i]);
        s.shot.objects[0] = &device.desc;
        render_draw(&render_devices[i], &s.shot, &of_device[i]);
        assert_null(render_find(&of_cpu[i], "vessel_grid", 0));
        check_field(&of_device[i], &grid);
        same_pictures(&of_cpu[i], &of_device[i]);
    }
    same_pictures(&of_device[0], &of_device[1]);
    for (int i = 0; i < 2; i++) {
        render_free(&of_cpu[i]);
        render_free(&of_device[i]);
    }
    sdv_object_free(&cpu);
    sdv_object_free(&device);
    sdv_grid_free(&grid);
}

/* ------------------------------------------------------------------------------------------ tests
 */

static void trees_built_to_hurt(void **state) {
    (void)state;
    for (uint32_t seed = 1; seed <= 3; seed++) {
        subject s;
        subject_make(&s, 40 * seed, seed);
        check_tree(&s.tree, 13 + 17 * seed, NULL, NULL);
        subject_free(&s);
    }
}

/* One ball; a flat tree, whose grid is one layer of blocks; equal and nested balls; a far place. */
static void degenerate_trees(void **state) {
    static const float ball[] = {1, 2, 3, 5}, point[] = {0, 0, 0, 0};
    static const float flat[] = {0, 0, 0, 0.1f, 40, 0, 0, 0.1f, 40, 30, 0, 0.05f};
    static const float nested[] = {0, 0, 0,    4, 0.5f, 0, 0,  2, 3, 3,
                                   3, 0, 3.1f, 3, 3,    0, -9, 0, 0, 4};
    static const float far_away[] = {9000, -7000, 3000, 2, 9010, -7003, 3004, 1};
    static const sdv_segment chain[] = {{0, 1}, {1, 2}, {2, 3}, {0, 4}};
    sdv_tree tree;
    (void)state;
    tree_of(ball, 1, NULL, 0, &tree);
    check_tree(&tree, 33, NULL, NULL);
    sdv_tree_free(&tree);
    tree_of(point, 1, NULL, 0, &tree);
    check_tree(&tree, 16, NULL, NULL);
    sdv_tree_free(&tree);
    tree_of(flat, 3, chain, 2, &tree);
    check_tree(&tree, 90, NULL, NULL);
    sdv_tree_free(&tree);
    tree_of(nested, 5, chain, 4, &tree);
    check_tree(&tree, 47, NULL, NULL);
    sdv_tree_free(&tree);
    tree_of(far_away, 2, chain, 1, &tree);
    check_tree(&tree, 40, NULL, NULL);
    sdv_tree_free(&tree);
}

/* Cut surfaces, exact near misses and shadows read the lists too. */
static void all_that_reads_lists(void **state) {
    static const sdv_shape shapes[] = {
        {{2, 1, 0, 6}, {0, 0, 0, 0}, SDV_SHAPE_BALL, SDV_SUBTRACTION}};
    sdv_shapes cut;
    sdv_settings settings;
    subject s;
    (void)state;
    memset(&cut, 0, sizeof cut);
    cut.shapes = shapes;
    cut.count = 1;
    memset(&settings, 0, sizeof settings);
    subject_make(&s, 60, 4);
    check_tree(&s.tree, 40, &cut, NULL);
    settings.near_miss = SDV_NEAR_MISS_EXACT;
    settings.field_shadow = 1;
    check_tree(&s.tree, 40, NULL, &settings);
    subject_form(&s, 7);
    check_tree(&s.tree, 40, NULL, &settings);
    subject_free(&s);
}

/* A tree that moves, and then leaves its box: what is drawn is a grid built anew. */
static void moving(void **state) {
    subject s;
    sdv_object object;
    sdv_grid_desc desc;
    (void)state;
    memset(&desc, 0, sizeof desc);
    desc.resolution = 40;
    subject_make(&s, 60, 5);
    assert_int_equal(sdv_object_make_tree(NULL, &s.tree, &desc, IMAGE_SIZE, NULL, &object), LAO_OK);
    for (uint32_t turn = 0; turn < 3; turn++) {
        const uint32_t node = 7 + turn;
        render_result result;
        sdv_grid_desc box;
        sdv_grid grid;
        scene s_now;
        s.tree.nodes[node].x += turn < 2 ? 1.0f : 60.0f;
        assert_int_equal(sdv_object_move(NULL, &s.tree, &node, 1, &object), LAO_OK);
        assert_int_equal(object.on_device, 1);
        memset(&box, 0, sizeof box);
        box.origin = &object.grid.origin.x;
        box.cell = object.grid.cell;
        memcpy(box.size, object.grid.size, sizeof box.size);
        assert_int_equal(sdv_grid_build(NULL, &s.tree, &box, &grid), LAO_OK);
        for (int i = 0; i < 2; i++) {
            render_need(&render_devices[i]);
            far_make(&s_now, &object.desc);
            render_draw(&render_devices[i], &s_now.shot, &result);
            check_field(&result, &grid);
            render_free(&result);
        }
        sdv_grid_free(&grid);
    }
    sdv_object_free(&object);
    subject_free(&s);
}

/* Two trees and a set of lines in one frame, one tree by the CPU: each has its own field. */
static void several_sets(void **state) {
    subject a, b;
    sdv_object device;
    sdv_grid_desc desc;
    render_result results[2], plain;
    render_lines lines;
    scene s;
    (void)state;
    memset(&desc, 0, sizeof desc);
    memset(&lines, 0, sizeof lines);
    desc.resolution = 40;
    subject_make(&a, 60, 6);
    subject_make(&b, 80, 7);
    render_scatter(&lines, 20, 5, 30, 8, 8);
    assert_int_equal(sdv_object_make_tree(NULL, &a.tree, &desc, IMAGE_SIZE, a.colors, &device),
                     LAO_OK);
    for (int i = 0; i < 2; i++) {
        render_need(&render_devices[i]);
        far_make(&s, &a.object.desc);
        s.shot.set_count = 3;
        s.shot.objects[1] = &b.object.desc;
        s.shot.lines[2] = &lines;
        for (int k = 1; k < 3; k++) {
            s.shot.settings[k] = &s.lines;
            s.shot.module_settings[k] = s.settings;
        }
        render_draw(&render_devices[i], &s.shot, &plain);
        s.shot.objects[0] = &device.desc;
        render_draw(&render_devices[i], &s.shot, &results[i]);
        assert_int_equal(
            render_compare("out", render_find(&plain, "out", 0), render_find(&results[i], "out", 0))
                .texels,
            0);
        render_free(&plain);
    }
    same_pictures(&results[0], &results[1]);
    render_free(&results[0]);
    render_free(&results[1]);
    render_lines_free(&lines);
    sdv_object_free(&device);
    subject_free(&a);
    subject_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_built_to_hurt),  cmocka_unit_test(degenerate_trees),
        cmocka_unit_test(all_that_reads_lists), cmocka_unit_test(moving),
        cmocka_unit_test(several_sets),
    };
    render_module(sdv_module());
    return cmocka_run_group_tests(tests, render_open_both, render_close_both);
}
