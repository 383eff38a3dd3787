/* Any bytes, read as a line file of each format, end in lines that hold together or in an error
 * with a text.
 *
 * The first byte picks the name's extension and the filters. Bytes that begin with "TRX\n" are
 * packed into a zip first (entries: a line with the name, two bytes of length, the content), for no
 * fuzzer guesses a checksum. */
#include "samples.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static buffer pack_trx(const uint8_t *data, size_t size) {
    enum { MOST = 16 };
    zip_item items[MOST];
    char names[MOST][64];
    size_t count = 0;
    memset(items, 0, sizeof items);
    while (count < MOST && size) {
        const uint8_t *end = memchr(data, '\n', size);
        size_t name = end ? (size_t)(end - data) : size;
        if (!name || size < name + 3)
            break;
        size_t length = data[name + 1] + 256u * data[name + 2], left = size - name - 3;
        length = length < left ? length : left;
        size_t kept = name < 63 ? name : 63;
        memcpy(names[count], data, kept);
        names[count][kept] = 0;
        items[count].name = names[count];
        put(&items[count++].content, data + name + 3, length);
        data += name + 3 + length;
        size -= name + 3 + length;
    }
    return make_zip(items, count, false);
}

static void check(bool holds) {
    if (!holds)
        abort();
}

static void check_lines(const io_lines *lines) {
    check(lines->format && lines->unit && lines->offsets[0] == 0);
    check(lines->offsets[lines->line_count] == lines->point_count);
    for (uint32_t i = 0; i < lines->line_count; i++)
        check(lines->offsets[i] < lines->offsets[i + 1]);
    float sum = 0; /* touches every value */
    for (size_t i = 0; i < 3 * (size_t)lines->point_count; i++)
        sum += lines->points[i];
    check(sum == sum);
    for (uint32_t i = 0; i < lines->point_attribute_count; i++)
        check(lines->point_attributes[i].name && lines->point_attributes[i].data);
    for (uint32_t i = 0; i < lines->group_count; i++)
        for (uint32_t k = 0; k < lines->groups[i].line_count; k++)
            check(lines->groups[i].lines[k] < lines->line_count);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const names[] = {NULL,      "a.trk", "a.tck", "a.trx",
                                        "a.tt.gz", "a.vtk", "a.vtp", "a"};
    io_options options;
    io_lines lines;
    io_error error = {""};
    buffer packed = {0};
    memset(&options, 0, sizeof options);
    unsigned choice = size ? data[0] : 0;
    if (size) {
        data++;
        size--;
    }
    options.every = choice >> 3 & 1 ? 2 : 0;
    options.min_length = choice >> 4 & 1 ? 0.5f : 0;
    options.bundle = choice >> 5 & 1 ? "7" : NULL;
    options.trk_no_half_voxel = choice >> 6 & 1;
    if (size >= 4 && !memcmp(data, "TRX\n", 4)) {
        packed = pack_trx(data + 4, size - 4);
        data = packed.data;
        size = packed.size;
    }
    if (io_read_lines_memory(data, size, names[choice & 7], &options, &lines, &error)) {
        check_lines(&lines);
        io_lines_free(&lines);
    } else {
        check(error.text[0] != 0);
    }
    buffer_free(&packed);
    return 0;
}
