/* Any bytes, read as a volume, end in a volume that holds together or in an error with a text.
 *
 * The first byte picks the options; its top bit gives the file three times, as components or
 * frames.
 */
#include "io_volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool holds) {
    if (!holds)
        abort();
}

static void check_volume(const io_volume *v) {
    size_t voxels = (size_t)v->size[0] * v->size[1] * v->size[2], inside = 0;
    check(v->format && voxels && v->frame_count && v->array_count);
    check((v->frame_count == 1) == (v->time_step == 0) && v->period >= 0);
    for (size_t i = 0; i < 3 * voxels * v->frame_count; i++)
        check(isfinite(v->velocity[i]));
    for (size_t i = 0; i < voxels; i++)
        inside += !v->mask || v->mask[i] == 1;
    check(inside == v->mask_voxels);
    for (int i = 0; i < 12; i++)
        check(isfinite(v->to_mm[i / 4][i % 4]));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    unsigned choice = size ? data[0] : 0;
    if (size) {
        data++;
        size--;
    }
    const io_source sources[3] = {{data, size}, {data, size}, {data, size}};
    io_volume_options options;
    io_volume volume;
    io_error error = {""};
    memset(&options, 0, sizeof options);
    options.names = choice & 1 ? "u,v,w,mask" : choice & 2 ? "velocity" : NULL;
    options.unit = choice & 4 ? "cm/s" : NULL;
    options.mask = choice & 8 ? "mask" : NULL;
    options.time_step = choice & 16 ? 0 : 40;
    options.along_grid = choice & 32;
    options.spacing[0] = options.spacing[1] = options.spacing[2] = choice & 64 ? 1.5 : 0;
    if (io_read_volume_memory(sources, choice & 128 ? 3 : 1, &options, &volume, NULL, &error)) {
        check_volume(&volume);
        io_volume_free(&volume);
    } else {
        check(error.text[0] != 0);
    }
    return 0;
}
