/* TT (DSI Studio TinyTrack): a gzip'd MATLAB v4 file. Its array `track` holds, for each line, 3 x
 * points, the first point as int32 in 1/32 voxels, and int8 steps from point to point; trans_to_mni
 * leads to mm. */
#include "io_internal.h"

#include <math.h>
#include <string.h>

typedef struct matrix {
    io_text name;
    io_view values; /* rows * columns single values */
} matrix;

/* One MATLAB v4 array; false at the end and on anything that is not one. */
static bool take_matrix(io_cursor *c, matrix *out) {
    static const io_type types[] = {IO_F64, IO_F32, IO_I32, IO_I16, IO_U16, IO_U8};
    const uint8_t *head = io_take(c, 20);
    if (!head)
        return false;
    bool big = io_u32(head, false) > 9999;
    uint32_t type = io_u32(head, big), rows = io_u32(head + 4, big),
             columns = io_u32(head + 8, big);
    uint32_t imaginary = io_u32(head + 12, big), length = io_u32(head + 16, big);
    const uint8_t *name = length >= 1 && length <= 256 ? io_take(c, length) : NULL;
    if (!name || type > 1052 || type / 10 % 10 > 5 || imaginary > 1 || rows > INT32_MAX ||
        columns > INT32_MAX)
        return false;
    io_type kind = types[type / 10 % 10];
    uint64_t count = (uint64_t)rows * columns, size = io_type_size(kind);
    uint64_t left = c->size - c->at;
    const uint8_t *bytes = count <= left / size / (1 + imaginary)
                               ? io_take(c, (size_t)(count * size * (1 + imaginary)))
                               : NULL;
    out->name = io_text_trim((io_text){(const char *)name, length});
    io_view values = {bytes, (size_t)count, (size_t)size, 1, kind, big};
    out->values = values;
    return bytes != NULL;
}

/* MATLAB v4 has no magic number; an array `track` behind arrays that fit is as good as one. */
io_match io_sniff_tt(const io_cursor *bytes) {
    io_cursor c = *bytes;
    matrix array;
    io_match match = IO_NO;
    while (take_matrix(&c, &array)) {
        if (io_text_starts(array.name, "track"))
            return IO_YES;
        match = IO_MAYBE;
    }
    return match;
}

typedef struct transform { /* rows of x y z 1, for coordinates in 1/32 voxel */
    double m[3][4];
} transform;

static bool read_transform(io_reader *r, const io_view *values, const io_view *voxel,
                           transform *out) {
    memset(out, 0, sizeof *out);
    bool usable = values->count >= 12;
    for (size_t i = 0; i < 12 && values->count >= 12; i++) {
        out->m[i / 4][i % 4] = io_view_real(values, i, 0) / (i % 4 < 3 ? 32 : 1);
        usable = usable && isfinite(out->m[i / 4][i % 4]);
    }
    if (usable)
        return true;
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < 3; i++) {
        double size = voxel->count >= 3 ? io_view_real(voxel, i, 0) : 1;
        out->m[i][i] = (size > 0 && isfinite(size) ? size : 1) / 32;
    }
    return io_warn(r,
                   "there is no usable trans_to_mni; the lines stay in voxel space, scaled to mm");
}

static bool add_point(io_reader *r, const transform *t, const double v[3], size_t row) {
    double p[3];
    for (int i = 0; i < 3; i++)
        p[i] = t->m[i][0] * v[0] + t->m[i][1] * v[1] + t->m[i][2] * v[2] + t->m[i][3];
    return io_add_point(r, p, row);
}

static bool read_track(io_reader *r, const io_view *track, const transform *t, size_t *lines) {
    io_cursor c = {track->bytes, track->count, 0};
    while (c.at < c.size) {
        size_t begin = c.at;
        const uint8_t *head = io_take(&c, 16);
        uint32_t length = head ? io_u32(head, track->big) : 0;
        const uint8_t *step =
            head && length >= 3 && length % 3 == 0 ? io_take(&c, length - 3) : NULL;
        if (!step)
            return io_fail(
                r,
                "is damaged in its array 'track': line %zu at byte %zu of it is cut or has a "
                "length that is no multiple of 3; %zu lines are whole",
                *lines + 1, begin, *lines);
        double v[3];
        for (size_t i = 0; i < 3; i++)
            v[i] = (double)(int32_t)io_u32(head + 4 + 4 * i, track->big);
        size_t row = r->point_count;
        if (!add_point(r, t, v, row))
            return false;
        for (const uint8_t *end = step + length - 3; step < end; step += 3) {
            for (int i = 0; i < 3; i++)
                v[i] += step[i] < 128 ? step[i] : step[i] - 256;
            if (!add_point(r, t, v, row))
                return false;
        }
        if (!io_end_line(r, (*lines)++, c.at, c.size))
            return false;
    }
    return true;
}

/* `cluster` has the number of a bundle for each line. */
static bool read_clusters(io_reader *r, const io_view *cluster, size_t lines) {
    enum { MOST = 65536 };
    if (cluster->count < lines)
        return io_warn(r, "the array 'cluster' has %zu values for %zu lines and is left out",
                       cluster->count, lines);
    size_t *place = io_alloc(r, MOST, sizeof *place); /* 1 + index of the bundle */
    if (!place)
        return false;
    for (size_t i = 0; i < lines; i++) {
        size_t number;
        if (io_view_index(cluster, i, &number) && number < MOST)
            place[number] = 1;
    }
    for (size_t number = 0; number < MOST; number++) {
        char name[24];
        if (!place[number])
            continue;
        snprintf(name, sizeof name, "%zu", number);
        if (!io_add_bundle(r, io_text_of(name)))
            return false;
        place[number] = r->bundle_count;
    }
    for (size_t i = 0; i < lines; i++) {
        size_t number;
        if (io_view_index(cluster, i, &number) && number < MOST &&
            !io_bundle_add(r, &r->bundles[place[number] - 1], (uint32_t)i))
            return false;
    }
    return io_attach_lines(r, io_text_of("cluster"), cluster);
}

bool io_read_tt(io_reader *r, io_cursor *c) {
    io_view none = {NULL, 0, 1, 1, IO_U8, false}, affine = none, voxel = none, cluster = none;
    io_cursor first = *c;
    matrix array;
    bool found = false, known = false;
    size_t lines = 0;
    transform to_mm;
    while (take_matrix(c, &array)) {
        found = found || io_text_starts(array.name, "track");
        if (io_text_is(array.name, "trans_to_mni"))
            affine = array.values;
        else if (io_text_is(array.name, "voxel_size"))
            voxel = array.values;
        else if (io_text_is(array.name, "cluster"))
            cluster = array.values;
    }
    if (c->at < c->size)
        return io_fail(
            r,
            "is cut or damaged: the MATLAB v4 array before byte %zu does not fit into the %zu "
            "bytes; copy the file again",
            c->at, c->size);
    if (!found)
        return io_fail(r, "has no array 'track': it is a MATLAB v4 file, but not a TinyTrack one");
    known = read_transform(r, &affine, &voxel, &to_mm);
    while (known && take_matrix(&first, &array)) { /* big files go on in track1, track2, ... */
        if (!io_text_starts(array.name, "track"))
            continue;
        if (array.values.type != IO_U8)
            return io_fail(r, "has an array 'track' that is not of bytes: not a TinyTrack file");
        known = read_track(r, &array.values, &to_mm, &lines);
    }
    return known && (!cluster.count || read_clusters(r, &cluster, lines));
}
