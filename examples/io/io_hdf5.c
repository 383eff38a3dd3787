/* HDF5 as 4DFlowNet lays it out: data sets [x,y,z], [t,x,y,z] or [t,x,y,z,3], and dx, the size of a
 * voxel in mm. What MATLAB wrote (-v7.3) has its axes reversed, which its attributes tell. */
#include "io_hdf5.h"

#include "io_grid.h"

#include <string.h>

io_match io_sniff_hdf5(const io_cursor *bytes) {
    return io_is_hdf5(bytes) && !io_is_section_graph(bytes) ? IO_YES : IO_NO;
}

#ifdef LINEAO_HAVE_HDF5
#include <errno.h>
#include <stdlib.h>
#include <sys/socket.h>

/* The child first sends an `opening` and its entries, and then, for every index it is sent, an
 * `answer` and the floats of that data set. */

enum { NAME_SIZE = 256 };

typedef struct entry { /* one data set that may be a field */
    char name[NAME_SIZE];
    uint32_t frames, components;
    bool reversed; /* as MATLAB writes */
} entry;

typedef struct answer {
    bool done;
    char error[256];
} answer;

typedef struct opening {
    answer answer;
    uint64_t size[3], skipped; /* skipped: data sets of another size */
    uint64_t entries;
    double dx[3]; /* mm */
    bool has_dx;
} opening;

/* ---- Talking --------------------------------------------------------------------------------- */

/* In the child, where nobody can cancel. */
static bool receive_index(int socket, uint64_t *index) {
    ssize_t got;
    do
        got = recv(socket, index, sizeof *index, MSG_WAITALL);
    while (got < 0 && errno == EINTR);
    return got == (ssize_t)sizeof *index;
}

/* ---- Child: data sets ------------------------------------------------------------------------ */

typedef struct search {
    entry *entries; /* as many as fit; for free() */
    uint64_t count, capacity;
    opening *opening;
    bool sized, failed;
} search;

/* What a data set would be as a field. */
typedef struct shape {
    int rank;
    bool reversed;
    hsize_t dims[8]; /* as C sees them */
    hsize_t frames, size[3], components;
} shape;

static bool is_number(hid_t set) {
    hid_t type = H5Dget_type(set);
    H5T_class_t kind = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    if (type >= 0)
        H5Tclose(type);
    return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

/* Rank and extents; false when it is no simple array of at most 8 axes. */
static bool extents(hid_t set, shape *out) {
    hid_t space = H5Dget_space(set);
    out->rank = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    bool good = out->rank >= 0 && out->rank <= 8 && H5Sis_simple(space) > 0 &&
                H5Sget_simple_extent_dims(space, out->dims, NULL) == out->rank;
    if (space >= 0)
        H5Sclose(space);
    return good;
}

/* Axis i in the order t x y z component; in MATLAB's x y z t component, stored from behind. */
static hsize_t axis(const shape *s, int i) {
    return s->dims[s->reversed ? s->rank - 1 - i : i];
}

static bool find_shape(hid_t set, shape *out) {
    if (!is_number(set) || !extents(set, out) || out->rank < 3 || out->rank > 5)
        return false;
    out->reversed = H5Aexists(set, "MATLAB_class") > 0;
    int first = out->reversed || out->rank == 3 ? 0 : 1;
    for (int i = 0; i < 3; i++)
        out->size[i] = axis(out, first + i);
    out->frames = out->rank < 4 ? 1 : axis(out, out->reversed ? 3 : 0);
    out->components = out->rank < 5 ? 1 : axis(out, 4);
    return out->size[0] && out->size[1] && out->size[2] && out->frames &&
           out->frames <= UINT32_MAX && out->components && out->components <= IO_MAX_COMPONENTS;
}

static void take_size(search *s, const shape *found) {
    for (int i = 0; i < 3; i++)
        s->opening->size[i] = found->size[i];
    s->sized = true;
}

/* False when memory is short. */
static bool add_entry(search *s, const char *name, const shape *found) {
    if (!s->sized)
        take_size(s, found);
    for (int i = 0; i < 3; i++)
        if (s->opening->size[i] != found->size[i]) {
            s->opening->skipped++;
            return true;
        }
    if (strlen(name) >= NAME_SIZE)
        return true;
    if (s->count == s->capacity) {
        s->capacity = s->capacity ? 2 * s->capacity : 16;
        entry *grown = s->capacity > SIZE_MAX / sizeof *grown
                           ? NULL
                           : realloc(s->entries, (size_t)s->capacity * sizeof *grown);
        if (!grown)
            return false;
        s->entries = grown;
    }
    entry *next = &s->entries[s->count++];
    memset(next, 0, sizeof *next);
    memcpy(next->name, name, strlen(name));
    next->frames = (uint32_t)found->frames;
    next->components = (uint32_t)found->components;
    next->reversed = found->reversed;
    return true;
}

/* Every object once, so that links in a circle end. */
static herr_t on_object(hid_t root, const char *name, const H5O_info_t *info, void *user) {
    search *s = user;
    shape found;
    if (info->type != H5O_TYPE_DATASET)
        return 0;
    hid_t set = H5Dopen2(root, name, H5P_DEFAULT);
    bool good = set >= 0 && find_shape(set, &found);
    if (set >= 0)
        H5Dclose(set);
    s->failed = good && !add_entry(s, name, &found);
    return s->failed ? 1 : 0;
}

/* Values in other files are not read. */
static bool is_here(hid_t set) {
    hid_t list = H5Dget_create_plist(set);
    bool good = list >= 0 && H5Pget_external_count(list) <= 0;
    if (list >= 0)
        H5Pclose(list);
    return good;
}

/* "u" decides the size where it is there, else the first data set. */
static void find_size(search *s, hid_t file) {
    shape found;
    hid_t set = H5Lexists(file, "u", H5P_DEFAULT) > 0 ? H5Dopen2(file, "u", H5P_DEFAULT) : -1;
    if (set >= 0 && find_shape(set, &found))
        take_size(s, &found);
    if (set >= 0)
        H5Dclose(set);
}

/* dx in mm: one number for all axes or three; of several rows the first. */
static void find_spacing(hid_t file, opening *out) {
    enum { MOST = 4096 };
    float values[MOST];
    shape s;
    hid_t set = H5Lexists(file, "dx", H5P_DEFAULT) > 0 ? H5Dopen2(file, "dx", H5P_DEFAULT) : -1;
    hsize_t count = 1;
    bool good = set >= 0 && is_number(set) && extents(set, &s) && is_here(set);
    for (int i = 0; good && i < s.rank; i++)
        good = s.dims[i] && s.dims[i] <= MOST && (count *= s.dims[i]) <= MOST;
    if (good && H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0) {
        out->has_dx = count == 1 || count % 3 == 0;
        for (int i = 0; i < 3; i++)
            out->dx[i] = (double)values[count == 1 ? 0 : i];
    }
    if (set >= 0)
        H5Dclose(set);
}

/* ---- Child: serving -------------------------------------------------------------------------- */

static void fail_answer(answer *out, const char *what) {
    out->done = false;
    memcpy(out->error, what, strlen(what) + 1);
}

static bool send_opening(int socket, hid_t file, search *s) {
    opening *o = s->opening;
    o->answer.done = true;
    if (file < 0)
        fail_answer(&o->answer, "is damaged: HDF5 cannot open it; copy the file again");
    if (o->answer.done) {
        find_size(s, file);
        find_spacing(file, o);
        if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, on_object, s, H5O_INFO_BASIC) < 0)
            fail_answer(&o->answer,
                        "is damaged: its list of data sets cannot be read; copy it again");
        if (s->failed)
            fail_answer(&o->answer, "needs more memory than the system gives");
    }
    o->entries = s->count;
    return io_hdf5_send(socket, o, sizeof *o) && o->answer.done &&
           io_hdf5_send(socket, s->entries, (size_t)s->count * sizeof *s->entries);
}

static bool send_values(int socket, hid_t file, const search *s, const entry *wanted) {
    answer a;
    shape now;
    memset(&a, 0, sizeof a);
    size_t count = (size_t)(s->opening->size[0] * s->opening->size[1] * s->opening->size[2]) *
                   wanted->frames * wanted->components;
    float *values = malloc(count * sizeof *values); /* the parent has checked the size */
    hid_t set = H5Dopen2(file, wanted->name, H5P_DEFAULT);
    a.done = true;
    if (!values)
        fail_answer(&a, "its values need more memory than the system gives");
    else if (set < 0 || !find_shape(set, &now))
        fail_answer(&a, "it cannot be opened again");
    else if (!is_here(set))
        fail_answer(&a, "its values are in another file; write them into this one");
    else if (H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        fail_answer(&a, "its values cannot be unpacked; copy the file again");
    bool sent = io_hdf5_send(socket, &a, sizeof a) &&
                (!a.done || io_hdf5_send(socket, values, count * sizeof *values));
    free(values);
    if (set >= 0)
        H5Dclose(set);
    return sent;
}

static void serve(int socket, hid_t file) {
    opening o;
    search s;
    uint64_t index;
    memset(&o, 0, sizeof o);
    memset(&s, 0, sizeof s);
    s.opening = &o;
    if (send_opening(socket, file, &s))
        while (receive_index(socket, &index) && index < s.count)
            if (!send_values(socket, file, &s, &s.entries[index]))
                break;
}

/* ---- Parent ---------------------------------------------------------------------------------- */

static void close_child(io_grid *grid) {
    io_hdf5_stop(grid->file);
}

/* Floats are in this machine's order; MATLAB's arrays have x fastest, others component, z, y, x. */
static bool load(io_reader *r, io_grid *grid, io_field *field) {
    static const int forward[5] = {3, 2, 1, 0, 4}, matlab[5] = {0, 1, 2, 4, 3};
    const io_hdf5_child *h = grid->file;
    const entry *e = (const entry *)(const void *)field->place;
    uint64_t index = (uint64_t)(field - grid->fields);
    size_t size[5] = {grid->size[0], grid->size[1], grid->size[2], field->components,
                      field->frames};
    size_t stride = sizeof(float);
    answer a;
    if (field->frames > SIZE_MAX / field->components / sizeof(float))
        return io_fail(r, "has a data set '%.64s' whose size overflows", field->name);
    float *values = io_alloc(r, io_grid_voxels(grid),
                             (size_t)field->frames * field->components * sizeof *values);
    if (!values || !io_hdf5_send(h->socket, &index, sizeof index))
        return values && io_fail(r, "is damaged: libhdf5 crashes on it; copy the file again");
    if (!io_hdf5_receive(r, h, &a, sizeof a))
        return false;
    a.error[sizeof a.error - 1] = '\0';
    if (!a.done)
        return io_fail(r, "is damaged in its data set '%.64s': %s", field->name, a.error);
    for (int i = 0; i < 5; i++) { /* from the fastest axis to the slowest */
        int k = e->reversed ? matlab[i] : forward[i];
        field->stride[k] = stride;
        stride *= size[k];
    }
    io_view native = io_view_doubles(NULL, 0, 1);
    field->type = IO_F32;
    field->big = native.big;
    field->bytes = (const uint8_t *)values;
    return io_hdf5_receive(r, h, values, stride);
}

static bool take_entries(io_reader *r, io_grid *grid, const opening *o) {
    const io_hdf5_child *h = grid->file;
    entry *entries = io_alloc(r, (size_t)o->entries, sizeof *entries);
    if (!entries || !io_hdf5_receive(r, h, entries, (size_t)o->entries * sizeof *entries))
        return false;
    for (size_t i = 0; i < o->entries; i++) {
        entry *e = &entries[i];
        e->name[NAME_SIZE - 1] = '\0';
        io_field *field = io_add_field(r, grid, io_text_of(e->name));
        if (!field)
            return false;
        if (!e->frames || !e->components)
            return io_fail(r, "is damaged in its data set '%.64s'", field->name);
        field->frames = e->frames;
        field->components = e->components;
        field->place = e;
    }
    return !o->skipped || io_warn(r, "%llu data sets of another size are left out",
                                  (unsigned long long)o->skipped);
}

bool io_open_hdf5(io_reader *r, io_cursor *bytes, io_grid *grid) {
    opening o;
    io_hdf5_child *h = io_alloc(r, 1, sizeof *h);
    if (!h || !io_hdf5_start(r, bytes, serve, h))
        return false;
    grid->file = h;
    grid->close = close_child;
    if (!io_hdf5_receive(r, h, &o, sizeof o))
        return false;
    o.answer.error[sizeof o.answer.error - 1] = '\0';
    if (!o.answer.done)
        return io_fail(r, "%s", o.answer.error);
    if (!o.entries)
        return io_fail(r, "has no data set of shape [t,x,y,z] or [x,y,z]");
    grid->load = load;
    grid->has_spacing = o.has_dx;
    for (int i = 0; i < 3; i++)
        grid->has_spacing = grid->has_spacing && o.dx[i] > 0 && o.dx[i] < 1e9;
    for (int i = 0; i < 3 && grid->has_spacing; i++)
        grid->to_mm[i][i] = o.dx[i];
    return io_grid_size(r, grid, o.size) && take_entries(r, grid, &o);
}
#else
bool io_open_hdf5(io_reader *r, io_cursor *bytes, io_grid *grid) {
    (void)bytes;
    (void)grid;
    return io_fail(r, "is HDF5, which this build does not read; build it with libhdf5-dev");
}
#endif
