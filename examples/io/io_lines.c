/* The public functions: finds the format, runs its reader or writer. */
#include "io_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct format {
    const char *name; /* also the extension */
    io_match (*sniff)(const io_cursor *bytes);
    bool (*read)(io_reader *reader, io_cursor *bytes);
    bool (*write)(FILE *file, const io_lines *lines, io_error *error); /* NULL = read only */
} format;

// clang-format off
static const format formats[] = {
    {"trk", io_sniff_trk, io_read_trk, io_write_trk},
    {"tck", io_sniff_tck, io_read_tck, io_write_tck},
    {"trx", io_sniff_trx, io_read_trx, NULL},
    {"tt",  io_sniff_tt,  io_read_tt,  NULL},
    {"vtk", io_sniff_vtk, io_read_vtk, NULL},
    {"vtp", io_sniff_vtp, io_read_vtp, io_write_vtp},
};
// clang-format on
enum { FORMAT_COUNT = sizeof formats / sizeof formats[0] };

static bool has_extension(io_text name, const char *extension) {
    size_t size = strlen(extension);
    if (name.size < size + 1 || name.at[name.size - size - 1] != '.')
        return false;
    io_text end = {name.at + name.size - size, size};
    return io_text_is(end, extension);
}

static const format *format_of_name(const char *name) {
    io_text text = io_text_of(name ? name : "");
    if (has_extension(text, "gz"))
        text.size -= 3;
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (has_extension(text, formats[i].name))
            return &formats[i];
    return NULL;
}

/* What is sure by its content, else what the name says, else what the content may be. */
static const format *find_format(const io_cursor *bytes, const char *name) {
    const format *maybe = NULL;
    for (size_t i = 0; i < FORMAT_COUNT; i++) {
        io_match match = formats[i].sniff(bytes);
        if (match == IO_YES)
            return &formats[i];
        if (match == IO_MAYBE && !maybe)
            maybe = &formats[i];
    }
    const format *named = format_of_name(name);
    return named ? named : maybe;
}

/* ---- Reading --------------------------------------------------------------------------------- */

static bool read_bytes(io_reader *r, io_cursor bytes, const char *name, io_lines *out) {
    if (!bytes.size)
        return io_fail(r, "is empty (0 bytes)");
    io_set_limit(r, bytes.size);
    if (io_is_gzip(&bytes) && !io_gunzip(r, &bytes))
        return false;
    const format *found = find_format(&bytes, name);
    if (!found)
        return io_fail(r, "is not a line file: it begins like none of trk, tck, trx, tt, vtk, vtp");
    r->step = 1;
    return io_tick(r, 0, 1) && found->read(r, &bytes) && io_finish(r, found->name, out);
}

bool io_read_lines_memory(const void *bytes, size_t size, const char *name_hint,
                          const io_options *options, io_lines *out, io_error *error) {
    io_reader r;
    io_begin(&r, options, error);
    io_cursor cursor = {bytes, size, 0};
    bool done = read_bytes(&r, cursor, name_hint, out);
    io_reader_free(&r);
    return done;
}

bool io_read_lines(const char *path, const io_options *options, io_lines *out, io_error *error) {
    io_reader r;
    io_begin(&r, options, error);
    struct stat info;
    io_cursor bytes;
    bool done;
    if (!stat(path, &info) && S_ISDIR(info.st_mode))
        done = io_read_trx_folder(&r, path) && io_finish(&r, "trx", out);
    else
        done = io_read_file(&r, path, &bytes) && read_bytes(&r, bytes, path, out);
    io_reader_free(&r);
    return done;
}

/* ---- Writing --------------------------------------------------------------------------------- */

void io_put_u32(FILE *file, uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8)
        putc((int)(value >> shift & 255), file);
}

void io_put_u64(FILE *file, uint64_t value) {
    io_put_u32(file, (uint32_t)(value & UINT32_MAX));
    io_put_u32(file, (uint32_t)(value >> 32));
}

void io_put_f32(FILE *file, double value) {
    float rounded = (float)value;
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    io_put_u32(file, bits);
}

void io_put_f64(FILE *file, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    io_put_u64(file, bits);
}

double io_position(const io_lines *lines, size_t point, unsigned axis) {
    return (double)lines->points[3 * point + axis] + lines->origin[axis];
}

/* A new file next to path; the caller frees *name, also on failure. */
static FILE *open_temporary(const char *path, char **name, io_error *error) {
    size_t size = strlen(path) + 40;
    int descriptor = -1;
    *name = malloc(size);
    if (!*name) {
        io_error_set(error, "cannot be written: out of memory");
        return NULL;
    }
    for (int i = 0; i < 100 && descriptor < 0; i++) {
        snprintf(*name, size, "%s.%ld-%d.tmp", path, (long)getpid(), i);
        descriptor = open(*name, O_WRONLY | O_CREAT | O_EXCL, 0666);
        if (descriptor < 0 && errno != EEXIST)
            break;
    }
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    if (!file)
        io_error_set(error, "cannot be written: %s", strerror(errno));
    if (!file && descriptor >= 0) {
        close(descriptor);
        unlink(*name);
    }
    return file;
}

/* Closes always; true when every byte has arrived under the final name. */
static bool finish_file(FILE *file, bool written, const char *name, const char *path,
                        io_error *error) {
    int problem = 0;
    if (ferror(file) || (written && fflush(file)))
        problem = errno ? errno : EIO;
    if (fclose(file) && !problem)
        problem = errno;
    if (written && !problem && !rename(name, path))
        return true;
    if (written)
        io_error_set(error, "cannot be written: %s", strerror(problem ? problem : errno));
    unlink(name);
    return false;
}

bool io_write_lines(const char *path, const io_lines *lines, io_error *error) {
    const format *found = format_of_name(path);
    if (!found || !found->write || has_extension(io_text_of(path), "gz"))
        return io_error_set(error, "cannot be written: its name must end in .tck, .trk or .vtp");
    char *name;
    FILE *file = open_temporary(path, &name, error);
    bool done = false;
    if (file) {
        errno = 0;
        bool written = found->write(file, lines, error);
        done = finish_file(file, written, name, path, error);
    }
    free(name);
    return done;
}
