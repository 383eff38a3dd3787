/* Writes the samples of tests/treeio as seeds of fuzz_contents into a folder. */
#include "tree_samples.h"

#include <stdio.h>

static bool write_seed(const char *folder, const char *name, buffer b) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    if (file) {
        putc(0, file); /* no name, no unit */
        fwrite(b.data, 1, b.size, file);
    }
    buffer_free(&b);
    return file && fclose(file) == 0;
}

int main(int count, char **arguments) {
    if (count != 2) {
        fprintf(stderr, "usage: seeds_contents FOLDER\n");
        return 2;
    }
    bool good = true;
    for (size_t i = 0; i < tree_sample_count; i++)
        good = write_seed(arguments[1], tree_samples[i].name, tree_samples[i].make()) && good;
    for (size_t i = 0; i < mesh_sample_count; i++)
        good = write_seed(arguments[1], mesh_samples[i].name, mesh_samples[i].make()) && good;
    return good ? 0 : 1;
}
