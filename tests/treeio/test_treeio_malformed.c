/* No damaged tree or mesh crashes a reader, leaks, or fails without a reason: every sample cut at
 * every byte, and with hostile values at every place; what is read holds together. */
#include "io_vessel.h" /* first: samples.h has a global of the name of a parameter */

#include "tree_samples.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void check_tree(const io_tree *tree) {
    io_vessel vessel;
    io_error error = {""};
    assert_true(tree->node_count > 0);
    for (uint32_t i = 0; i < 2 * tree->segment_count; i++)
        assert_true(tree->segments[i] < tree->node_count);
    for (uint32_t i = 0; i < 3 * tree->node_count; i++)
        assert_true(tree->positions[i] - tree->positions[i] == 0);
    if (io_vessel_build(NULL, tree, &vessel, &error))
        io_vessel_free(&vessel);
    else
        assert_true(error.text[0]);
}

static void check_mesh(io_mesh *mesh) {
    io_mesh_edges edges;
    io_error error;
    for (int turn = 0; turn < 2; turn++) {
        for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++)
            assert_true(mesh->triangles[i] < mesh->vertex_count);
        for (uint32_t i = 0; i < 3 * mesh->vertex_count; i++)
            assert_true(mesh->positions[i] - mesh->positions[i] == 0);
        assert_true(io_mesh_count_edges(mesh, &edges, &error));
        assert_true(io_mesh_weld(mesh, &error));
    }
}

/* Reads from a block of exactly that size, so that the address sanitizer sees each byte too far. */
static bool survives(const uint8_t *data, size_t size, const char *name) {
    io_contents contents, before;
    io_error error = {""};
    uint8_t *exact = malloc(size ? size : 1);
    assert_non_null(exact);
    if (size)
        memcpy(exact, data, size);
    memset(&contents, 0x5A, sizeof contents);
    before = contents;
    bool done = io_read_memory(exact, size, name, IO_ANYTHING, NULL, &contents, &error);
    free(exact);
    if (done) {
        assert_true(contents.kinds && !(contents.kinds & ~7u));
        if (contents.kinds & IO_TREE)
            check_tree(&contents.tree);
        if (contents.kinds & IO_MESH)
            check_mesh(&contents.mesh);
        io_contents_free(&contents);
    } else {
        assert_memory_equal(&contents, &before, sizeof contents);
        if (!error.text[0])
            fail_msg("%s of %zu bytes: failed without a text", name, size);
    }
    return done;
}

/* Trees, then meshes. HDF5 is a process each time, and needs more bytes: a few places must do. */
static buffer sample_at(size_t i, const char **name, size_t *step) {
    bool of_tree = i < tree_sample_count;
    size_t k = of_tree ? i : i - tree_sample_count;
    *name = of_tree ? tree_samples[k].name : mesh_samples[k].name;
    *step = strstr(*name, ".h5") ? 37 : 1;
    return of_tree ? tree_samples[k].make() : mesh_samples[k].make();
}

static void cut_at_every_byte(void **state) {
    (void)state;
    for (size_t i = 0; i < tree_sample_count + mesh_sample_count; i++) {
        const char *name;
        size_t step, good = 0, cuts = 0;
        buffer b = sample_at(i, &name, &step);
        for (size_t size = 0; size < b.size; size += step, cuts++)
            good += survives(b.data, size, name);
        print_message("%s: %zu cuts, %zu still read\n", name, cuts, good);
        buffer_free(&b);
    }
}

static void hostile_values_at_every_place(void **state) {
    static const uint32_t hostile[] = {0xFFFFFFFF, 0x7FFFFFFF, 0x80000000,
                                       0,          0x10000000, 0x7FC00000};
    static const uint8_t bytes[] = {0, 0xFF, '-', '9', '<', ' '};
    (void)state;
    for (size_t i = 0; i < tree_sample_count + mesh_sample_count; i++) {
        const char *name;
        size_t step;
        buffer b = sample_at(i, &name, &step);
        for (size_t at = 0; at + 4 <= b.size; at += step) {
            uint8_t kept[4];
            memcpy(kept, b.data + at, 4);
            for (size_t k = 0; k < sizeof bytes; k++) {
                b.data[at] = bytes[k];
                (void)survives(b.data, b.size, name);
            }
            memcpy(b.data + at, kept, 4);
            for (size_t k = 0; k < sizeof hostile / sizeof hostile[0]; k++) {
                patch_u32(&b, at, hostile[k]);
                (void)survives(b.data, b.size, name);
            }
            memcpy(b.data + at, kept, 4);
        }
        buffer_free(&b);
    }
}

/* Every line of text left out, and every line told twice. */
static void lines_go_missing_and_come_twice(void **state) {
    (void)state;
    for (size_t i = 0; i < tree_sample_count + mesh_sample_count; i++) {
        const char *name;
        size_t step;
        buffer b = sample_at(i, &name, &step);
        for (size_t at = 0, next; step == 1 && at < b.size; at = next) {
            for (next = at; next < b.size && b.data[next] != '\n';)
                next++;
            next += next < b.size;
            buffer less = {0}, more = {0};
            put(&less, b.data, at);
            put(&more, b.data, next);
            put(&less, b.data + next, b.size - next);
            put(&more, b.data + at, b.size - at);
            (void)survives(less.data, less.size, name);
            (void)survives(more.data, more.size, name);
            buffer_free(&less);
            buffer_free(&more);
        }
        buffer_free(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cut_at_every_byte),
        cmocka_unit_test(hostile_values_at_every_place),
        cmocka_unit_test(lines_go_missing_and_come_twice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
