/* Writes the samples of tests/volume as seeds of fuzz_volume into a folder. */
#include "volume_samples.h"

#include <stdio.h>

static bool write_seed(const char *folder, const volume_sample *s) {
    char path[1024];
    buffer files[MOST_FILES] = {{0}};
    s->make(files);
    snprintf(path, sizeof path, "%s/%s", folder, s->name);
    FILE *file = fopen(path, "wb");
    if (file) {
        putc(s->files == 3 ? 128 : 0, file);
        fwrite(files[0].data, 1, files[0].size, file);
    }
    free_files(files);
    return file && fclose(file) == 0;
}

int main(int count, char **arguments) {
    bool good = true;
    if (count != 2) {
        fprintf(stderr, "usage: seeds_volume FOLDER\n");
        return 2;
    }
    for (size_t i = 0; i < volume_sample_count; i++)
        good = write_seed(arguments[1], &volume_samples[i]) && good;
    return good ? 0 : 1;
}
