/* Any bytes, read as lines, tree and mesh of each format, end in contents that hold together, and
 * that can be built and welded, or in an error with a text.
 *
 * The first byte picks the name's extension and the unit. HDF5 files are left to libhdf5's own
 * fuzzers: here each would be a process. */
#include "io_vessel.h"

#include "io_read.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool holds) {
    if (!holds)
        abort();
}

static void check_attributes(const io_attribute *attributes, uint32_t count, uint32_t rows) {
    volatile float sum = 0; /* touches every value */
    for (uint32_t i = 0; i < count; i++) {
        check(attributes[i].name && attributes[i].data && attributes[i].components);
        for (size_t k = 0; k < (size_t)rows * attributes[i].components; k++)
            sum = sum + attributes[i].data[k];
    }
    (void)sum;
}

static void check_tree(const io_tree *tree) {
    io_vessel vessel;
    io_error error = {""};
    check(tree->format && tree->unit && tree->millimetres > 0 && tree->node_count);
    for (size_t i = 0; i < 2 * (size_t)tree->segment_count; i++)
        check(tree->segments[i] < tree->node_count);
    for (size_t i = 0; i < tree->node_count; i++)
        check(!(tree->radii[i] < 0));
    check_attributes(tree->node_attributes, tree->node_attribute_count, tree->node_count);
    check_attributes(tree->segment_attributes, tree->segment_attribute_count, tree->segment_count);
    if (io_vessel_build(NULL, tree, &vessel, &error)) {
        const sdv_tree_info *info = &vessel.tree.info;
        check(info->loops + info->nodes == info->segments + info->roots);
        io_vessel_free(&vessel);
    } else {
        check(error.text[0] != 0);
    }
}

static void check_mesh(io_mesh *mesh) {
    io_mesh_edges edges;
    io_error error;
    for (int turn = 0; turn < 2; turn++) {
        for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
            check(mesh->triangles[i] < mesh->vertex_count);
        for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
            check(mesh->positions[i] - mesh->positions[i] == 0);
        check_attributes(mesh->vertex_attributes, mesh->vertex_attribute_count, mesh->vertex_count);
        check_attributes(mesh->triangle_attributes, mesh->triangle_attribute_count,
                         mesh->triangle_count);
        check(io_mesh_count_edges(mesh, &edges, &error) && edges.boundary <= edges.edges);
        check(io_mesh_weld(mesh, &error));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const names[] = {NULL,    "a.swc", "a.gxl", "a.vmv",
                                        "a.stl", "a.ply", "a.obj", "a.vtp"};
    static const char *const units[] = {NULL, "cm", "um", "m"};
    io_options options;
    io_contents contents;
    io_error error = {""};
    if (!size)
        return 0;
    memset(&options, 0, sizeof options);
    options.unit = units[data[0] >> 3 & 3];
    const char *name = names[data[0] & 7];
    data++;
    size--;
    if (size >= 8 && !memcmp(data, "\x89HDF\r\n\x1A\n", 8))
        return 0;
    if (io_read_memory(data, size, name, IO_ANYTHING, &options, &contents, &error)) {
        check(contents.kinds != 0);
        if (contents.kinds & IO_TREE)
            check_tree(&contents.tree);
        if (contents.kinds & IO_MESH)
            check_mesh(&contents.mesh);
        io_contents_free(&contents);
    } else {
        check(error.text[0] != 0);
    }
    return 0;
}
