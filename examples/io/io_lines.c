/* The public functions: finds the format, runs its reader or writer. */
#include "io_graph.h"
#include "io_surface.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct format {
    const char *name; /* also the extension */
    unsigned kinds;   /* what it may hold, as in io_read.h */
    io_match (*sniff)(const io_cursor *bytes);
    bool (*read)(io_reader *reader, io_cursor *bytes);
    bool (*write)(FILE *file, const io_lines *lines, io_error *error); /* NULL = read only */
} format;

// clang-format off
static const format formats[] = {
    {"trk", IO_LINES, io_sniff_trk, io_read_trk, io_write_trk},
    {"tck", IO_LINES, io_sniff_tck, io_read_tck, io_write_tck},
    {"trx", IO_LINES, io_sniff_trx, io_read_trx, NULL},
    {"tt",  IO_LINES, io_sniff_tt,  io_read_tt,  NULL},
    {"vtk", IO_ANYTHING, io_sniff_vtk, io_read_vtk, NULL},
    {"vtp", IO_ANYTHING, io_sniff_vtp, io_read_vtp, io_write_vtp},
    {"gxl", IO_TREE, io_sniff_gxl, io_read_gxl, NULL},
    {"h5",  IO_TREE, io_sniff_h5,  io_read_h5,  NULL},
    {"vmv", IO_TREE, io_sniff_vmv, io_read_vmv, NULL},
    {"ply", IO_MESH, io_sniff_ply, io_read_ply, NULL},
    {"obj", IO_MESH | IO_LINES, io_sniff_obj, io_read_obj, NULL},
    {"stl", IO_MESH, io_sniff_stl, io_read_stl, NULL},
    {"swc", IO_TREE, io_sniff_swc, io_read_swc, NULL},
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

static const char *kind_text(unsigned kinds) {
    const char *tree = kinds & IO_MESH ? "a vessel tree or a surface mesh" : "a vessel tree";
    return kinds & IO_LINES ? "lines" : kinds & IO_TREE ? tree : "a surface mesh";
}

static bool finish(io_reader *r, const char *name, io_contents *out) {
    io_contents contents;
    memset(&contents, 0, sizeof contents);
    contents.kinds = r->found;
    if ((!(r->found & IO_LINES) || io_finish(r, name, &contents.lines)) &&
        (!(r->found & IO_TREE) || io_finish_tree(r, name, &contents.tree)) &&
        (!(r->found & IO_MESH) || io_finish_mesh(r, name, &contents.mesh))) {
        *out = contents;
        return true;
    }
    io_contents_free(&contents);
    return false;
}

static bool read_bytes(io_reader *r, io_cursor bytes, const char *name, io_contents *out) {
    if (!bytes.size)
        return io_fail(r, "is empty (0 bytes)");
    io_set_limit(r, bytes.size);
    if (io_is_gzip(&bytes) && !io_gunzip(r, &bytes))
        return false;
    const format *found = find_format(&bytes, name);
    if (!found)
        return io_fail(r, "is in no format that is read: it begins like none of trk, tck, trx, tt, "
                          "vtk, vtp, swc, gxl, h5, vmv, stl, ply, obj");
    if (!(found->kinds & r->wanted))
        return io_fail(r, "holds %s (%s), not %s", kind_text(found->kinds), found->name,
                       kind_text(r->wanted));
    r->step = 1;
    r->found = found->kinds & r->wanted;
    return io_tick(r, 0, 1) && found->read(r, &bytes) && finish(r, found->name, out);
}

bool io_read_memory(const void *bytes, size_t size, const char *name_hint, unsigned wanted,
                    const io_options *options, io_contents *out, io_error *error) {
    io_reader r;
    io_begin(&r, options, error);
    r.wanted = wanted;
    io_cursor cursor = {bytes, size, 0};
    bool done = read_bytes(&r, cursor, name_hint, out);
    io_reader_free(&r);
    return done;
}

static bool read_folder(io_reader *r, const char *path, io_contents *out) {
    if (!(r->wanted & IO_LINES))
        return io_fail(r, "is a folder; name a file in it");
    r->found = IO_LINES;
    return io_read_trx_folder(r, path) && finish(r, "trx", out);
}

bool io_read(const char *path, unsigned wanted, const io_options *options, io_contents *out,
             io_error *error) {
    io_reader r;
    io_begin(&r, options, error);
    r.wanted = wanted;
    struct stat info;
    io_cursor bytes;
    bool done;
    if (!stat(path, &info) && S_ISDIR(info.st_mode))
        done = read_folder(&r, path, out);
    else
        done = io_read_file(&r, path, &bytes) && read_bytes(&r, bytes, path, out);
    io_reader_free(&r);
    return done;
}

void io_contents_free(io_contents *contents) {
    if (!contents)
        return;
    io_lines_free(&contents->lines);
    io_tree_free(&contents->tree);
    io_mesh_free(&contents->mesh);
    contents->kinds = 0;
}

/* The functions for one kind: the same read, of which one part is kept. */
// clang-format off
#define READ_ONE(function, type, wanted, part)                                                     \
    bool function(const char *path, const io_options *options, type *out, io_error *error) {       \
        io_contents contents;                                                                      \
        bool done = io_read(path, wanted, options, &contents, error);                              \
        if (done)                                                                                  \
            *out = contents.part;                                                                  \
        return done;                                                                               \
    }                                                                                              \
    bool function##_memory(const void *bytes, size_t size, const char *name_hint,                  \
                           const io_options *options, type *out, io_error *error) {                \
        io_contents contents;                                                                      \
        bool done = io_read_memory(bytes, size, name_hint, wanted, options, &contents, error);     \
        if (done)                                                                                  \
            *out = contents.part;                                                                  \
        return done;                                                                               \
    }
// clang-format on
READ_ONE(io_read_lines, io_lines, IO_LINES, lines)
READ_ONE(io_read_tree, io_tree, IO_TREE, tree)
READ_ONE(io_read_mesh, io_mesh, IO_MESH, mesh)

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
