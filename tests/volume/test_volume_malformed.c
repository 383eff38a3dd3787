/* No damaged volume crashes a reader, leaks, or fails without a reason: every sample cut at every
 * byte, and with hostile values at every place. */
#include "volume_checks.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static bool holds_together(const io_volume *v) {
    size_t voxels = (size_t)v->size[0] * v->size[1] * v->size[2], inside = 0;
    if (!voxels || !v->frame_count || !v->format)
        return false;
    for (size_t i = 0; i < 3 * voxels * v->frame_count; i++)
        if (!isfinite(v->velocity[i]))
            return false;
    for (size_t i = 0; i < voxels; i++)
        inside += !v->mask || v->mask[i] == 1;
    for (int i = 0; i < 12; i++)
        if (!isfinite(v->to_mm[i / 4][i % 4]))
            return false;
    return inside == v->mask_voxels && (v->frame_count == 1) == (v->time_step == 0);
}

/* The first file of a sample is damaged; blocks have exactly their size, so that the address
 * sanitizer sees each byte too far. */
static bool survives(const volume_sample *s, const buffer *files, const uint8_t *data,
                     size_t size) {
    io_source sources[MOST_FILES];
    io_volume_options options;
    io_volume volume, before;
    io_error error = {""};
    uint8_t *exact = malloc(size ? size : 1);
    assert_non_null(exact);
    if (size)
        memcpy(exact, data, size);
    memset(&options, 0, sizeof options);
    options.time_step = sample_step;
    for (uint32_t i = 0; i < s->files; i++) {
        sources[i].bytes = i ? files[i].data : exact;
        sources[i].size = i ? files[i].size : size;
    }
    memset(&volume, 0x5A, sizeof volume);
    before = volume;
    bool done = io_read_volume_memory(sources, s->files, &options, &volume, NULL, &error);
    free(exact);
    if (done) {
        assert_true(holds_together(&volume));
        io_volume_free(&volume);
    } else {
        assert_memory_equal(&volume, &before, sizeof volume);
        if (!error.text[0])
            fail_msg("%s of %zu bytes: failed without a text", s->name, size);
    }
    return done;
}

static void cut_at_every_byte(void **state) {
    (void)state;
    for (size_t i = 0; i < volume_sample_count; i++) {
        const volume_sample *s = &volume_samples[i];
        buffer files[MOST_FILES] = {{0}};
        size_t good = 0;
        s->make(files);
        for (size_t size = 0; size < files[0].size; size += s->hdf5 ? 397 : 1)
            good += survives(s, files, files[0].data, size);
        print_message("%s of %zu bytes: %zu cuts still read\n", s->name, files[0].size, good);
        free_files(files);
    }
}

static void hostile_values(void **state) {
    static const uint32_t hostile[] = {0xFFFFFFFF, 0x7FFFFFFF, 0x80000000, 0x10000000, 0x00000100};
    static const uint8_t bytes[] = {0, 0xFF, 0x80, '9', '<', ' '};
    (void)state;
    for (size_t i = 0; i < volume_sample_count; i++) {
        const volume_sample *s = &volume_samples[i];
        buffer files[MOST_FILES] = {{0}};
        if (s->hdf5)
            continue;
        s->make(files);
        buffer *b = &files[0];
        for (size_t at = 0; at < b->size; at++) {
            uint8_t kept[4];
            size_t size = b->size - at < 4 ? b->size - at : 4;
            memcpy(kept, b->data + at, size);
            for (size_t k = 0; k < sizeof bytes; k++) {
                b->data[at] = bytes[k];
                (void)survives(s, files, b->data, b->size);
            }
            memcpy(b->data + at, kept, size);
            for (size_t k = 0; size == 4 && k < sizeof hostile / sizeof hostile[0]; k++) {
                patch_u32(b, at, hostile[k]);
                (void)survives(s, files, b->data, b->size);
            }
            memcpy(b->data + at, kept, size);
        }
        free_files(files);
    }
}

/* Some crash libhdf5, which is then no crash of ours. */
static void hostile_hdf5(void **state) {
    static const uint8_t bytes[] = {0, 0xFF};
    (void)state;
    for (size_t i = 0; i < volume_sample_count; i++) {
        const volume_sample *s = &volume_samples[i];
        buffer files[MOST_FILES] = {{0}};
        if (!s->hdf5)
            continue;
        s->make(files);
        size_t good = 0, tried = 0;
        for (size_t at = 0; at < files[0].size; at += 61) {
            uint8_t kept = files[0].data[at];
            for (size_t k = 0; k < sizeof bytes; k++) {
                files[0].data[at] = bytes[k];
                good += survives(s, files, files[0].data, files[0].size);
                tried++;
            }
            files[0].data[at] = kept;
        }
        print_message("%s: %zu bytes, %zu of %zu damaged ones still read\n", s->name, files[0].size,
                      good, tried);
        free_files(files);
    }
}

/* Counts that promise far more than there is fail before memory is taken for them. */
static void hostile_counts(void **state) {
    static const char *const texts[] = {
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 99999 99999 "
        "99999\nSPACING 1 1 1\nPOINT_DATA 1\nVECTORS v float 1 2 3",
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 9999999999 1 "
        "1\n",
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 0 1 1\n",
        "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 1\n"
        "SPACING 1 1 1\nPOINT_DATA 18446744073709551615\nVECTORS v double\n1",
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nSPACING 1 1 1\n",
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 1 1 "
        "1\nSPACING "
        "1 1\n",
        "<VTKFile type='ImageData'><ImageData WholeExtent='0 2147483647 0 2147483647 0 2147483647' "
        "Spacing='1 1 1'><Piece><PointData><DataArray Name='a' type='Float32' "
        "NumberOfComponents='3'>1</DataArray></PointData></Piece></ImageData></VTKFile>",
        "<VTKFile type='ImageData'><ImageData WholeExtent='0 1 0 0 0 0' Spacing='1 1 "
        "1'><Piece><PointData><DataArray Name='a' type='Float32' "
        "NumberOfComponents='18446744073709551615'>1</DataArray></PointData></Piece></ImageData>"
        "</VTKFile>",
        "<VTKFile type='ImageData'><ImageData WholeExtent='0 0 0 0 0 0' Spacing='1 1 "
        "1'/></VTKFile>",
        "<VTKFile type='ImageData'><ImageData WholeExtent='0 0 0 0 0 0' Spacing='1 1 1'><Piece "
        "Extent='0 0 0 0 0 nan'><PointData><DataArray Name='a' type='Float32' "
        "NumberOfComponents='3'>1 2 3</DataArray></PointData></Piece></ImageData></VTKFile>",
        "\x89HDF\r\n\x1A\n\0\0\0\0",
    };
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        buffer b = {0};
        put_text(&b, texts[i]);
        must_fail_volume(&b, 1, NULL, 0, "");
        buffer_free(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cut_at_every_byte),
        cmocka_unit_test(hostile_values),
        cmocka_unit_test(hostile_hdf5),
        cmocka_unit_test(hostile_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
