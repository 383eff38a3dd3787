/* TRX: a zip archive, or a folder, of little-endian arrays whose names tell their types, and
 * header.json. */
#include "io_internal.h"

#include <cjson/cJSON.h>
#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <zip.h>

typedef struct entry {
    char *name; /* "dpv/fa.float32" */
    io_cursor bytes;
} entry;

typedef struct archive {
    entry *entries;
    size_t count, capacity;
} archive;

io_match io_sniff_trx(const io_cursor *bytes) {
    bool zip = bytes->size >= 4 &&
               (!memcmp(bytes->bytes, "PK\3\4", 4) || !memcmp(bytes->bytes, "PK\5\6", 4));
    return zip ? IO_YES : IO_NO;
}

/* ---- Entries --------------------------------------------------------------------------------- */

static bool is_wanted(const char *name) {
    static const char *const wanted[] = {"header.json", "positions", "offsets",
                                         "dpv/",        "dps/",      "groups/"};
    size_t size = strlen(name);
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++)
        if (size && name[size - 1] != '/' && io_text_starts(io_text_of(name), wanted[i]))
            return true;
    return false;
}

static bool add_entry(io_reader *r, archive *a, const char *name, io_cursor bytes) {
    entry *entries = io_grow(r, a->entries, &a->capacity, a->count + 1, sizeof *entries);
    char *copy = io_copy_text(r, io_text_of(name));
    if (entries)
        a->entries = entries;
    if (!entries || !copy)
        return false;
    entries[a->count].name = copy;
    entries[a->count++].bytes = bytes;
    return true;
}

static bool load_zip_entry(io_reader *r, archive *a, zip_t *zip, zip_uint64_t index) {
    zip_stat_t info;
    if (zip_stat_index(zip, index, 0, &info) || !(info.valid & ZIP_STAT_NAME) ||
        !(info.valid & ZIP_STAT_SIZE))
        return io_fail(r, "has a broken zip directory: entry %lu has no name or size",
                       (unsigned long)index);
    if (!is_wanted(info.name))
        return true;
    if (info.size > SIZE_MAX)
        return io_fail(r, "has an entry '%.64s' too large for this system", info.name);
    uint8_t *bytes = io_alloc(r, (size_t)info.size, 1), beyond;
    zip_file_t *file = bytes ? zip_fopen_index(zip, index, 0) : NULL;
    bool whole = file && zip_fread(file, bytes, info.size) == (zip_int64_t)info.size &&
                 zip_fread(file, &beyond, 1) == 0; /* only at its end is the checksum compared */
    if (file)
        zip_fclose(file);
    if (bytes && !whole)
        return io_fail(r, "has a damaged zip entry '%.64s' (%s); copy or download the file again",
                       info.name,
                       file ? "it does not unpack to its size and checksum" : zip_strerror(zip));
    io_cursor cursor = {bytes, (size_t)info.size, 0};
    return bytes && add_entry(r, a, info.name, cursor) && io_tick(r, (size_t)index, SIZE_MAX);
}

static bool load_zip(io_reader *r, archive *a, const io_cursor *bytes) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t *source = zip_source_buffer_create(bytes->bytes, bytes->size, 0, &error);
    zip_t *zip = source ? zip_open_from_source(source, ZIP_RDONLY, &error) : NULL;
    if (!zip) {
        io_error_set(r->error, "is not a whole zip archive (%s); copy or download the file again",
                     zip_error_strerror(&error));
        zip_source_free(source);
        zip_error_fini(&error);
        return false;
    }
    zip_int64_t count = zip_get_num_entries(zip, 0);
    bool good = true;
    for (zip_int64_t i = 0; good && i < count; i++)
        good = load_zip_entry(r, a, zip, (zip_uint64_t)i);
    zip_discard(zip); /* frees the source */
    zip_error_fini(&error);
    return good;
}

/* Files of one folder, and of the folders dpv, dps and groups in it. */
static bool load_folder(io_reader *r, archive *a, const char *path, const char *inner) {
    char name[512], full[4096];
    DIR *folder = opendir(path);
    if (!folder)
        return *inner ? true : io_fail(r, "cannot be opened as a folder");
    bool good = true;
    for (struct dirent *item; good && (item = readdir(folder)) != NULL;) {
        struct stat info;
        int size = snprintf(name, sizeof name, "%s%s", inner, item->d_name);
        int length = snprintf(full, sizeof full, "%s/%s", path, item->d_name);
        io_cursor bytes;
        if (item->d_name[0] == '.' || size >= (int)sizeof name || length >= (int)sizeof full ||
            stat(full, &info) || !S_ISREG(info.st_mode) || !is_wanted(name))
            continue;
        good = io_read_file(r, full, &bytes) && add_entry(r, a, name, bytes);
    }
    closedir(folder);
    return good;
}

/* ---- Arrays ---------------------------------------------------------------------------------- */

/* Splits "dpv/fa.2.float32" behind its folder into name, components and type; the components may be
 * absent. */
static bool parse_name(const entry *e, const char *folder, io_text *name, io_view *view) {
    if (!io_text_starts(io_text_of(e->name), folder))
        return false;
    *name = io_text_of(e->name + strlen(folder));
    size_t dot = name->size, components = 1;
    while (dot && name->at[dot - 1] != '.')
        dot--;
    if (!dot)
        return false;
    io_type type = io_type_named((io_text){name->at + dot, name->size - dot});
    name->size = dot - 1;
    for (dot = name->size; dot && name->at[dot - 1] != '.';)
        dot--;
    if (dot && io_parse_size((io_text){name->at + dot, name->size - dot}, &components))
        name->size = dot - 1;
    if (type == IO_NONE || !components || components > IO_MAX_COMPONENTS)
        return false;
    size_t stride = components * io_type_size(type);
    io_view result = {e->bytes.bytes, e->bytes.size / stride, stride, (uint32_t)components, type,
                      false};
    *view = result;
    return true;
}

static const entry *find_entry(const archive *a, const char *name) {
    for (size_t i = 0; i < a->count; i++)
        if (io_text_is(io_text_of(a->entries[i].name), name))
            return &a->entries[i];
    return NULL;
}

/* Finds "positions.3.float16", "offsets.uint64". */
static bool find_array(const archive *a, const char *wanted, io_view *view) {
    io_text name;
    for (size_t i = 0; i < a->count; i++)
        if (parse_name(&a->entries[i], "", &name, view) && io_text_is(name, wanted))
            return true;
    return false;
}

static bool json_count(const cJSON *json, const char *key, size_t *count) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);
    bool good = cJSON_IsNumber(item) && item->valuedouble >= 0 && item->valuedouble <= UINT32_MAX &&
                floor(item->valuedouble) == item->valuedouble;
    if (good)
        *count = (size_t)item->valuedouble;
    return good;
}

static bool read_header(io_reader *r, const archive *a, size_t *lines, size_t *vertices) {
    const entry *e = find_entry(a, "header.json");
    if (!e)
        return io_fail(r, "has no header.json: it is not a TRX file");
    cJSON *json = cJSON_ParseWithLength((const char *)e->bytes.bytes, e->bytes.size);
    bool good =
        json_count(json, "NB_STREAMLINES", lines) && json_count(json, "NB_VERTICES", vertices);
    cJSON_Delete(json);
    return good ||
           io_fail(r,
                   "has a header.json without whole numbers NB_STREAMLINES and NB_VERTICES below "
                   "4294967296; write the file anew");
}

/* New files have one offset per line and the end; older ones leave the end out. */
static bool read_lines(io_reader *r, const io_view *positions, const io_view *offsets,
                       size_t lines) {
    size_t broken = 0, begin = 0, used = 0;
    for (size_t i = 0; i < lines; i++) {
        size_t end = positions->count;
        if (!io_view_index(offsets, i, &begin) || begin > positions->count)
            begin = positions->count;
        if (i + 1 < offsets->count &&
            (!io_view_index(offsets, i + 1, &end) || end > positions->count)) {
            end = positions->count;
            broken++;
        }
        broken += end < begin;
        for (; begin < end; begin++, used++) {
            double p[3];
            for (uint32_t axis = 0; axis < 3; axis++)
                p[axis] = io_view_real(positions, begin, axis);
            if (used >= positions->count)
                return io_fail(
                    r, "has offsets that use points twice, at line %zu; write the file anew",
                    i + 1);
            if (!io_add_point(r, p, begin))
                return false;
        }
        if (!io_end_line(r, i, i, lines))
            return false;
    }
    if (broken && !io_warn(r, "%zu offsets do not ascend, or point behind the last vertex", broken))
        return false;
    return used == positions->count ||
           io_warn(r, "%zu vertices belong to no line and are left out", positions->count - used);
}

static bool read_groups(io_reader *r, const entry *e, size_t lines) {
    io_text name;
    io_view view;
    size_t beyond = 0;
    if (!parse_name(e, "groups/", &name, &view))
        return true;
    io_bundle *bundle = io_add_bundle(r, name);
    for (size_t i = 0; bundle && i < view.count; i++) {
        size_t line;
        if (!io_view_index(&view, i, &line) || line >= lines)
            beyond++;
        else if (!io_bundle_add(r, bundle, (uint32_t)line))
            return false;
    }
    return bundle &&
           (!beyond || io_warn(r, "the group '%.64s' names %zu lines that are not in the file",
                               bundle->name, beyond));
}

static bool read_attributes(io_reader *r, const archive *a, size_t lines, size_t vertices) {
    for (size_t i = 0; i < a->count; i++) {
        const entry *e = &a->entries[i];
        io_text name;
        io_view view;
        bool of_points = parse_name(e, "dpv/", &name, &view);
        bool of_lines = !of_points && parse_name(e, "dps/", &name, &view);
        size_t expected = of_points ? vertices : lines;
        if ((of_points || of_lines) && view.count != expected &&
            !io_warn(r, "the array '%.64s' has %zu rows for %zu", e->name, view.count, expected))
            return false;
        if (of_points && !io_attach_points(r, name, &view))
            return false;
        if (of_lines && !io_attach_lines(r, name, &view))
            return false;
        if (!of_points && !of_lines && !read_groups(r, e, lines))
            return false;
    }
    return true;
}

/* Archives list their entries in any order; attributes and groups come out sorted by name. */
static int compare_entries(const void *a, const void *b) {
    return strcmp(((const entry *)a)->name, ((const entry *)b)->name);
}

static bool read_archive(io_reader *r, archive *a) {
    size_t lines, vertices;
    io_view positions = {0}, offsets = {0};
    if (!read_header(r, a, &lines, &vertices))
        return false;
    qsort(a->entries, a->count, sizeof *a->entries, compare_entries);
    bool found = find_array(a, "positions", &positions) && positions.components == 3;
    if (!vertices && !lines)
        return true;
    if (!found || !find_array(a, "offsets", &offsets) || offsets.components != 1)
        return io_fail(r, "has no array positions.3.TYPE or offsets.TYPE; write the file anew");
    if (positions.count < vertices)
        return io_fail(r, "has %zu points, but its header promises %zu; copy the file again",
                       positions.count, vertices);
    if (positions.count > vertices &&
        !io_warn(r, "the file has %zu points, its header says %zu", positions.count, vertices))
        return false;
    positions.count = vertices;
    if (offsets.count < lines)
        return io_fail(r, "has %zu offsets for %zu lines; copy the file again", offsets.count,
                       lines);
    if (offsets.count > lines + 1 &&
        !io_warn(r, "the file has %zu offsets for %zu lines", offsets.count, lines))
        return false;
    return read_lines(r, &positions, &offsets, lines) && read_attributes(r, a, lines, vertices);
}

bool io_read_trx(io_reader *r, io_cursor *c) {
    archive a = {NULL, 0, 0};
    if (!io_sniff_trx(c))
        return io_fail(r, "is not a TRX file: it is not a zip archive");
    return load_zip(r, &a, c) && read_archive(r, &a);
}

bool io_read_trx_folder(io_reader *r, const char *path) {
    static const char *const folders[] = {"", "dpv/", "dps/", "groups/"};
    archive a = {NULL, 0, 0};
    char full[4096];
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        if (snprintf(full, sizeof full, "%s/%s", path, folders[i]) >= (int)sizeof full)
            return io_fail(r, "has a path that is too long");
        if (!load_folder(r, &a, full, folders[i]))
            return false;
    }
    if (!find_entry(&a, "header.json"))
        return io_fail(
            r, "is a folder, and no unpacked TRX, which has a header.json; name a file in it");
    return read_archive(r, &a);
}
