/* Writes the samples of tests/io as seeds of fuzz_lines into a folder. */
#include "samples.h"

#include <stdio.h>
#include <string.h>

static bool write_seed(const char *folder, const char *name, const buffer *b) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    if (!file)
        return false;
    putc(0, file); /* no filters, no name */
    fwrite(b->data, 1, b->size, file);
    return fclose(file) == 0;
}

static void put_entry(buffer *b, const char *name, const buffer *content) {
    put_format(b, "%s\n", name);
    put_u16(b, (unsigned)content->size);
    put(b, content->data, content->size);
}

static buffer unpacked_trx(void) {
    buffer b = {0}, head = {0}, positions = {0}, offsets = {0}, scalars = {0};
    put_text(&head, "{\"NB_VERTICES\":8,\"NB_STREAMLINES\":3}");
    for (unsigned k = 0; k < SAMPLE_POINTS; k++) {
        for (unsigned axis = 0; axis < 3; axis++)
            put_f32(&positions, sample_position(k, axis));
        put_u16(&scalars, k);
    }
    for (unsigned i = 0; i <= SAMPLE_LINES; i++)
        put_u32(&offsets, sample_offsets[i]);
    put_text(&b, "TRX\n");
    put_entry(&b, "header.json", &head);
    put_entry(&b, "positions.3.float32", &positions);
    put_entry(&b, "offsets.uint32", &offsets);
    put_entry(&b, "dpv/s.float16", &scalars);
    put_entry(&b, "dps/w.2.int8", &scalars);
    put_entry(&b, "groups/7.uint8", &scalars);
    buffer *parts[] = {&head, &positions, &offsets, &scalars};
    for (size_t i = 0; i < 4; i++)
        buffer_free(parts[i]);
    return b;
}

int main(int count, char **arguments) {
    if (count != 2) {
        fprintf(stderr, "usage: seeds_lines FOLDER\n");
        return 2;
    }
    bool good = true;
    for (size_t i = 0; i < sample_count; i++) {
        buffer b = samples[i].make();
        good = write_seed(arguments[1], samples[i].name, &b) && good;
        buffer_free(&b);
    }
    buffer b = unpacked_trx();
    good = write_seed(arguments[1], "unpacked.trx", &b) && good;
    buffer_free(&b);
    return good ? 0 : 1;
}
