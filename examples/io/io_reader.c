/* One read: its memory, messages, progress, and the bytes of its file. */
#include "io_internal.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* ---- Messages -------------------------------------------------------------------------------- */

bool io_error_set(io_error *error, const char *format, ...) {
    if (!error)
        return false;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    for (char *c = error->text; *c; c++) /* texts may quote the file */
        if ((unsigned char)*c < 0x20 || *c == 0x7F)
            *c = '?';
    return false;
}

bool io_warn(io_reader *reader, const char *format, ...) {
    enum { MOST = 20 };
    char text[512];
    if (reader->warning_count > MOST)
        return true;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (size_t i = 0; i < reader->warning_count; i++) /* lines and mesh may say the same */
        if (!strcmp(reader->warnings[i], text))
            return true;
    const char *told = reader->warning_count == MOST ? "more warnings are left out" : text;
    char **warnings = io_grow(reader, reader->warnings, &reader->warning_capacity,
                              reader->warning_count + 1, sizeof *warnings);
    if (!warnings)
        return false;
    reader->warnings = warnings;
    warnings[reader->warning_count] = io_copy_text(reader, io_text_of(told));
    return warnings[reader->warning_count] && ++reader->warning_count;
}

bool io_tick(io_reader *reader, size_t done, size_t total) {
    const uint64_t parts = 1000, steps = 3;
    const io_options *options = reader->options;
    double share = total ? (double)done / (double)total : 1;
    uint64_t now = reader->step * parts + (uint64_t)(share * (double)parts);
    if (!options->progress || !options->progress(options->user, now, steps * parts))
        return true;
    return io_fail(reader, "reading was cancelled");
}

/* ---- Memory ---------------------------------------------------------------------------------- */

struct io_block {
    io_block *next, *previous;
    size_t size;
    union { /* the strictest alignment that the arrays need */
        double real;
        uint64_t whole;
        void *pointer;
    } data[];
};

enum { BLOCK_HEAD = offsetof(io_block, data) };

static void *block_resize(io_reader *reader, io_block *old, size_t size) {
    size_t before = old ? old->size : 0;
    if (size > reader->limit - (reader->allocated - before)) {
        io_error_set(reader->error,
                     "needs more than the %zu MB of memory that a file of this size may take; it "
                     "is damaged, or was made to fill the memory",
                     reader->limit >> 20);
        return NULL;
    }
    io_block *block = old ? realloc(old, BLOCK_HEAD + size) : calloc(1, BLOCK_HEAD + size);
    if (!block) {
        io_error_set(reader->error, "needs %zu MB of memory, which the system does not give",
                     size >> 20);
        return NULL;
    }
    reader->allocated += size - before;
    block->size = size;
    if (!old)
        block->next = reader->blocks;
    if (block->next)
        block->next->previous = block;
    if (block->previous)
        block->previous->next = block;
    else
        reader->blocks = block;
    return block->data;
}

/* The limit keeps products small enough that the head can be added. */
static bool product(io_reader *reader, size_t count, size_t size, size_t *bytes) {
    if (count > reader->limit / size) {
        io_error_set(reader->error,
                     "asks for %zu items of %zu bytes, more than a file of this size may need; it "
                     "is damaged",
                     count, size);
        return false;
    }
    *bytes = count ? count * size : 1;
    return true;
}

void *io_alloc(io_reader *reader, size_t count, size_t size) {
    size_t bytes;
    return product(reader, count, size, &bytes) ? block_resize(reader, NULL, bytes) : NULL;
}

void *io_grow(io_reader *reader, void *array, size_t *capacity, size_t needed, size_t size) {
    if (array && needed <= *capacity)
        return array;
    size_t wanted = *capacity > SIZE_MAX / 4 ? needed : *capacity * 2;
    wanted = wanted < needed ? needed : wanted;
    wanted = wanted < 16 ? 16 : wanted;
    size_t bytes;
    io_block *block = array ? (io_block *)(void *)((char *)array - BLOCK_HEAD) : NULL;
    void *grown = product(reader, wanted, size, &bytes) ? block_resize(reader, block, bytes) : NULL;
    if (grown)
        *capacity = wanted;
    return grown;
}

void io_reader_free(io_reader *reader) {
    for (io_block *block = reader->blocks, *next; block; block = next) {
        next = block->next;
        free(block);
    }
    reader->blocks = NULL;
}

/* Bytes of the UTF-8 sequence at p, 0 when it is broken. */
static size_t utf8_size(const uint8_t *p, size_t left) {
    size_t size = p[0] < 0x80                   ? 1
                  : p[0] >= 0xC2 && p[0] < 0xE0 ? 2
                  : p[0] >= 0xE0 && p[0] < 0xF0 ? 3
                  : p[0] >= 0xF0 && p[0] < 0xF5 ? 4
                                                : 0;
    if (size > left)
        return 0;
    for (size_t i = 1; i < size; i++)
        if ((p[i] & 0xC0) != 0x80)
            return 0;
    bool overlong = (p[0] == 0xE0 && p[1] < 0xA0) || (p[0] == 0xF0 && p[1] < 0x90);
    bool outside = (p[0] == 0xED && p[1] > 0x9F) || (p[0] == 0xF4 && p[1] > 0x8F);
    return overlong || outside ? 0 : size;
}

char *io_copy_text(io_reader *reader, io_text text) {
    char *copy = io_alloc(reader, text.size + 1, 1);
    if (!copy)
        return NULL;
    for (size_t i = 0, step; i < text.size; i += step) {
        const uint8_t *at = (const uint8_t *)text.at + i;
        size_t size = utf8_size(at, text.size - i);
        step = size ? size : 1;
        if (!size || at[0] < 0x20 || at[0] == 0x7F)
            copy[i] = '?';
        else
            memcpy(copy + i, at, size);
    }
    return copy;
}

/* ---- Begin ----------------------------------------------------------------------------------- */

/* Real files need at most a few times their size; compressed ones more. 32-bit systems have less to
 * give. */
void io_set_limit(io_reader *r, size_t size) {
    const uint64_t most = sizeof(size_t) > 4 ? UINT64_C(32) << 30 : UINT64_C(1) << 30;
    uint64_t limit = size > most / 4096 ? most : (UINT64_C(64) << 20) + (uint64_t)size * 4096;
    r->limit = (size_t)(limit < most ? limit : most);
}

void io_begin(io_reader *r, const io_options *options, io_error *error) {
    static const io_options none = {0, 0, NULL, false, NULL, NULL, NULL};
    memset(r, 0, sizeof *r);
    r->options = options ? options : &none;
    r->error = error;
    io_set_limit(r, SIZE_MAX);
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* In pieces, so that pipes work and a wrong size cannot make us take memory. */
bool io_read_file(io_reader *reader, const char *path, io_cursor *out) {
    enum { PIECE = 1 << 20 };
    FILE *file = fopen(path, "rb");
    if (!file)
        return io_fail(reader, "cannot be opened: %s", strerror(errno));
    uint8_t *bytes = NULL;
    size_t size = 0, capacity = 0, got = 1;
    while (got) {
        uint8_t *grown = io_grow(reader, bytes, &capacity, size + PIECE, 1);
        if (!grown)
            break;
        bytes = grown;
        got = fread(bytes + size, 1, capacity - size, file);
        size += got;
    }
    bool failed = got != 0;
    if (!failed && ferror(file)) {
        io_error_set(reader->error, "cannot be read: %s", strerror(errno));
        failed = true;
    }
    fclose(file);
    out->bytes = bytes;
    out->size = size;
    out->at = 0;
    return !failed;
}

bool io_is_gzip(const io_cursor *bytes) {
    return bytes->size > 2 && bytes->bytes[0] == 0x1F && bytes->bytes[1] == 0x8B;
}

/* zlib counts in 32 bits. */
static uInt portion(size_t left) {
    return left < (1u << 30) ? (uInt)left : 1u << 30;
}

/* Inflates members one after the other until the bytes end; zeros or other padding behind the last
 * one are ignored, as gzip itself does. The stream belongs to the caller. */
static bool gunzip_members(io_reader *reader, z_stream *stream, io_cursor *bytes) {
    const uint64_t most = UINT64_C(8) << 30;
    uint8_t *out = NULL;
    size_t capacity = 0, size = 0, at = 0;
    for (int state = Z_OK; state != Z_STREAM_END;) {
        if (size > most)
            return io_fail(reader,
                           "unpacks to more than 8 GB; unpack it with gunzip and look at it");
        size_t wanted = size + (size < (64u << 10) ? 64u << 10 : size / 2);
        uint8_t *grown = io_grow(reader, out, &capacity, wanted, 1);
        if (!grown || !io_tick(reader, at, bytes->size))
            return false;
        out = grown;
        /* zlib does not write to its input; its older interface lacks the const */
        stream->next_in = (Bytef *)(uintptr_t)(bytes->bytes + at);
        stream->avail_in = portion(bytes->size - at);
        stream->next_out = out + size;
        stream->avail_out = portion(capacity - size);
        uInt input = stream->avail_in, output = stream->avail_out;
        state = inflate(stream, Z_NO_FLUSH);
        at += input - stream->avail_in;
        size += output - stream->avail_out;
        if (state == Z_STREAM_END) {
            io_cursor rest = {bytes->bytes + at, bytes->size - at, 0};
            if (io_is_gzip(&rest))
                state = inflateReset(stream);
        } else if (state == Z_BUF_ERROR && at == bytes->size) {
            return io_fail(reader,
                           "the gzip data ends too early, at byte %zu (%zu bytes unpacked); "
                           "copy or download the file again",
                           at, size);
        } else if (state != Z_OK && state != Z_BUF_ERROR) {
            return io_fail(reader,
                           "the gzip data is damaged near byte %zu (%s); copy or download the "
                           "file again",
                           at, stream->msg ? stream->msg : "bad stream");
        }
    }
    bytes->bytes = out;
    bytes->size = size;
    bytes->at = 0;
    return true;
}

bool io_gunzip(io_reader *reader, io_cursor *bytes) {
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    if (inflateInit2(&stream, 15 + 16) != Z_OK)
        return io_fail(reader, "zlib could not start: out of memory");
    bool done = gunzip_members(reader, &stream, bytes);
    inflateEnd(&stream);
    return done;
}

bool io_inflate(const uint8_t *bytes, size_t count, uint8_t *out, size_t size) {
    uLongf got = (uLongf)size;
    return uncompress(out, &got, bytes, (uLong)count) == Z_OK && got == size;
}
