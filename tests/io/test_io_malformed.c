/* No damaged file crashes a reader, leaks, or fails without a reason: every sample cut at every
 * byte, and with hostile values at every place. */
#include "samples.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Reads size bytes from a block of exactly that size, so that the address sanitizer sees each byte
 * too far. */
static bool survives(const uint8_t *data, size_t size, const char *name) {
    io_lines lines, before;
    io_error error = {""};
    uint8_t *exact = malloc(size ? size : 1);
    assert_non_null(exact);
    if (size)
        memcpy(exact, data, size);
    memset(&lines, 0x5A, sizeof lines);
    before = lines;
    bool done = io_read_lines_memory(exact, size, name, NULL, &lines, &error);
    free(exact);
    if (done) {
        assert_true(lines.offsets[lines.line_count] == lines.point_count);
        for (uint32_t i = 0; i < lines.group_count; i++)
            for (uint32_t k = 0; k < lines.groups[i].line_count; k++)
                assert_true(lines.groups[i].lines[k] < lines.line_count);
        io_lines_free(&lines);
    } else {
        assert_memory_equal(&lines, &before, sizeof lines);
        if (!error.text[0])
            fail_msg("%s of %zu bytes: failed without a text", name, size);
    }
    return done;
}

static void cut_at_every_byte(void **state) {
    (void)state;
    for (size_t i = 0; i < sample_count; i++) {
        buffer b = samples[i].make();
        size_t good = 0;
        for (size_t size = 0; size < b.size; size++)
            good += survives(b.data, size, samples[i].name);
        print_message("%s: %zu cuts, %zu still read\n", samples[i].name, b.size, good);
        buffer_free(&b);
    }
}

/* Cut TRK and TCK files name the place and the lines that are whole. */
static void cut_lines_are_counted(void **state) {
    (void)state;
    buffer trk = make_trk(false, SAMPLE_LINES), tck = make_tck("Float32LE", false, false);
    trk.size -= 10;
    must_fail(&trk, "a.trk", NULL, "2 lines are whole");
    must_fail(&trk, "a.trk", NULL, "byte 1100");
    trk.size = 1100;
    must_fail(&trk, "a.trk", NULL, "after 2 whole lines");
    tck.size -= 12 + 12 + 5;
    must_fail(&tck, "a.tck", NULL, "2 lines are whole");
    buffer_free(&trk);
    buffer_free(&tck);
}

static void hostile_values_at_every_place(void **state) {
    static const uint32_t hostile[] = {0xFFFFFFFF, 0x7FFFFFFF, 0x80000000,
                                       0,          0x10000000, 0x00000100};
    static const uint8_t bytes[] = {0, 0xFF, 0x80, '9', '<', ' '};
    (void)state;
    for (size_t i = 0; i < sample_count; i++) {
        buffer b = samples[i].make();
        for (size_t at = 0; at < b.size; at++) {
            uint8_t kept[4];
            size_t size = b.size - at < 4 ? b.size - at : 4;
            memcpy(kept, b.data + at, size);
            for (size_t k = 0; k < sizeof bytes; k++) {
                b.data[at] = bytes[k];
                (void)survives(b.data, b.size, samples[i].name);
            }
            memcpy(b.data + at, kept, size);
            for (size_t k = 0; size == 4 && k < sizeof hostile / sizeof hostile[0]; k++) {
                patch_u32(&b, at, hostile[k]);
                (void)survives(b.data, b.size, samples[i].name);
            }
            memcpy(b.data + at, kept, size);
        }
        buffer_free(&b);
    }
}

/* Texts whose counts promise far more than they hold must fail before any memory is taken for them.
 */
static void hostile_counts_fail_early(void **state) {
    static const struct {
        const char *name, *text;
    } files[] = {
        {"a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS "
                  "18446744073709551615 float\n1"},
        {"a.vtk", "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS "
                  "6148914691236517206 float\n1"},
        {"a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float 1 2 "
                  "3\nLINES 1 99999999999\n1"},
        {"a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float 1 2 "
                  "3\nLINES 1 2 5 0\n"},
        {"a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float 1 2 "
                  "3\nLINES 1 2 1 1\n"},
        {"a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float 1 2 "
                  "3\nLINES 1 2 1 -1\n"},
        {"a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float 1 2 "
                  "3\nLINES 3 2 OFFSETS int 0 2 1 "
                  "CONNECTIVITY int 0 0"},
        {"a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINT_DATA 9\nFIELD f "
                  "1\na 4294967296 4294967296 float 1"},
        {"a.vtp", "<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='9999999999' "
                  "NumberOfLines='1'><Points>"
                  "<DataArray type='Float32' NumberOfComponents='3' format='ascii'>1 2 "
                  "3</DataArray></Points><Lines>"
                  "<DataArray type='Int32' Name='offsets'>1</DataArray><DataArray type='Int32' "
                  "Name='connectivity'>0"
                  "</DataArray></Lines></Piece></PolyData></VTKFile>"},
        {"a.vtp", "<VTKFile type='PolyData' compressor='vtkLZ4DataCompressor'/>"},
        {"a.vtp", "<VTKFile type='ImageData'/>"},
        {"a.vtp", "<VTKFile type='PolyData'><PolyData></VTKFile>"},
        {"a.vtp", "<!DOCTYPE a [<!ENTITY b 'cccccccccc'><!ENTITY d "
                  "'&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;'>]><a>&d;</a>"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        buffer b = {0};
        put_text(&b, files[i].text);
        must_fail(&b, files[i].name, NULL, NULL);
        buffer_free(&b);
    }
}

/* A gzip of 64 MB of zeros behind a small head must not take more memory than its limit, nor be
 * believed. */
static void zip_bombs_are_stopped(void **state) {
    (void)state;
    buffer zeros = {0};
    put(&zeros, "TRACK", 6);
    zeros.data = realloc(zeros.data, (64u << 20) + 6);
    assert_non_null(zeros.data);
    memset(zeros.data + 6, 0, 64u << 20);
    zeros.size = (64u << 20) + 6;
    buffer packed = gzip_of(&zeros);
    must_fail(&packed, NULL, NULL, NULL);
    packed.size /= 2;
    must_fail(&packed, NULL, NULL, "gzip data ends");
    packed.data[packed.size / 2] ^= 0xFF;
    must_fail(&packed, NULL, NULL, "gzip");
    buffer_free(&packed);
    buffer_free(&zeros);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cut_at_every_byte),
        cmocka_unit_test(cut_lines_are_counted),
        cmocka_unit_test(hostile_values_at_every_place),
        cmocka_unit_test(hostile_counts_fail_early),
        cmocka_unit_test(zip_bombs_are_stopped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
