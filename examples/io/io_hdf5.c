/* HDF5 as 4DFlowNet lays it out: data sets [x,y,z], [t,x,y,z] or [t,x,y,z,3], and dx, the size of a
 * voxel in mm. What MATLAB wrote (-v7.3) has its axes reversed, which its attributes tell. */
#define H5_USE_110_API
#include "io_grid.h"

#include <string.h>

static const char signature[] = "\x89HDF\r\n\x1A\n";

/* At byte 0, 512, 1024, 2048 ...: files may begin with a block of the user's. */
io_match io_sniff_hdf5(const io_cursor *bytes) {
    for (size_t at = 0; at + 8 <= bytes->size; at = at ? 2 * at : 512) {
        if (!memcmp(bytes->bytes + at, signature, 8))
            return IO_YES;
        if (at > SIZE_MAX / 2)
            break;
    }
    return IO_NO;
}

#ifdef LINEAO_HAVE_HDF5
#include <hdf5.h>

typedef struct search {
    io_reader *r;
    io_grid *grid;
    bool failed, sized;
    hsize_t skipped; /* data sets of another size */
} search;

/* What a data set would be as a field. */
typedef struct shape {
    int rank;
    bool reversed;   /* as MATLAB writes */
    hsize_t dims[8]; /* as C sees them */
    hsize_t frames, size[3], components;
} shape;

/* ---- Shapes ---------------------------------------------------------------------------------- */

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

/* Axis i in the order t x y z component. */
static hsize_t axis(const shape *s, int i) {
    return s->dims[s->reversed ? s->rank - 1 - i : i];
}

/* MATLAB puts time behind: x y z t as it sees it, the same order reversed here. */
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

/* ---- Fields ---------------------------------------------------------------------------------- */

static bool add_field(search *s, const char *name, const shape *found) {
    io_grid *grid = s->grid;
    const uint64_t size[3] = {found->size[0], found->size[1], found->size[2]};
    if (!s->sized && !io_grid_size(s->r, grid, size))
        return false;
    s->sized = true;
    for (int i = 0; i < 3; i++)
        if (grid->size[i] != size[i]) {
            s->skipped++;
            return true;
        }
    io_field *field = io_add_field(s->r, grid, io_text_of(name));
    if (!field)
        return false;
    field->frames = (uint32_t)found->frames;
    field->components = (uint32_t)found->components;
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
    if (good && !add_field(s, name, &found))
        s->failed = true;
    return s->failed ? 1 : 0;
}

static bool is_here(hid_t set) {
    hid_t list = H5Dget_create_plist(set);
    bool good = list >= 0 && H5Pget_external_count(list) <= 0;
    if (list >= 0)
        H5Pclose(list);
    return good;
}

static bool read_set(io_reader *r, hid_t set, io_field *field, const io_grid *grid) {
    shape s;
    if (!find_shape(set, &s) || s.frames != field->frames || s.components != field->components)
        return io_fail(r, "is damaged in its data set '%.64s'", field->name);
    if (!is_here(set))
        return io_fail(r, "keeps its data set '%.64s' in another file; write it into this one",
                       field->name);
    size_t frames = field->frames, components = field->components;
    if (frames > SIZE_MAX / components / sizeof(float))
        return io_fail(r, "has a data set '%.64s' whose size overflows", field->name);
    float *values = io_alloc(r, io_grid_voxels(grid), frames * components * sizeof *values);
    if (!values)
        return false;
    if (H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        return io_fail(r,
                       "is damaged in its data set '%.64s': its values cannot be unpacked; "
                       "copy the file again",
                       field->name);
    size_t size[5] = {grid->size[0], grid->size[1], grid->size[2], components, frames};
    static const int forward[5] = {3, 2, 1, 0, 4}, matlab[5] = {0, 1, 2, 4, 3};
    size_t stride = sizeof *values;
    for (int i = 0; i < 5; i++) { /* from the fastest axis to the slowest */
        int k = s.reversed ? matlab[i] : forward[i];
        field->stride[k] = stride;
        stride *= size[k];
    }
    const uint16_t one = 1;
    uint8_t low;
    memcpy(&low, &one, 1);
    field->type = IO_F32;
    field->big = !low;
    field->bytes = (const uint8_t *)values;
    return true;
}

/* ---- Errors and the file --------------------------------------------------------------------- */

/* libhdf5 prints its errors unless told not to; the host's choice is put back. */
typedef struct quiet {
    H5E_auto2_t function;
    void *user;
} quiet;

static quiet hush(void) {
    quiet before = {NULL, NULL};
    H5Eget_auto2(H5E_DEFAULT, &before.function, &before.user);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    return before;
}

static void unhush(quiet before) {
    H5Eset_auto2(H5E_DEFAULT, before.function, before.user);
}

static bool load(io_reader *r, io_grid *grid, io_field *field) {
    quiet before = hush();
    hid_t set = H5Dopen2((hid_t)grid->handle, field->name, H5P_DEFAULT);
    bool done = set >= 0 ? read_set(r, set, field, grid)
                         : io_fail(r, "is damaged in its data set '%.64s'", field->name);
    if (set >= 0)
        H5Dclose(set);
    unhush(before);
    return done;
}

static void close_file(io_grid *grid) {
    quiet before = hush();
    H5Fclose((hid_t)grid->handle);
    unhush(before);
}

/* dx in mm: one number for all axes or three; of several rows the first. */
static void find_spacing(hid_t file, io_grid *grid) {
    enum { MOST = 4096 };
    float values[MOST];
    shape s;
    hid_t set = H5Lexists(file, "dx", H5P_DEFAULT) > 0 ? H5Dopen2(file, "dx", H5P_DEFAULT) : -1;
    hsize_t count = 1, row;
    bool good = set >= 0 && is_number(set) && extents(set, &s) && is_here(set);
    for (int i = 0; good && i < s.rank; i++)
        good = s.dims[i] && (count *= s.dims[i]) <= MOST && s.dims[i] <= MOST;
    if (good && H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0) {
        row = s.rank ? s.dims[s.rank - 1] : 1;
        row = s.rank && H5Aexists(set, "MATLAB_class") > 0 ? count : row;
        good = row >= 3 || count == 1 || row == 1;
        grid->has_spacing = good;
        for (int i = 0; i < 3; i++) {
            double step = (double)values[row >= 3 ? i : 0];
            grid->has_spacing = grid->has_spacing && step > 0 && step < 1e9;
            grid->to_mm[i][i] = step;
        }
    }
    if (set >= 0)
        H5Dclose(set);
}

static hid_t open_image(const io_cursor *bytes) {
    hid_t list = H5Pcreate(H5P_FILE_ACCESS), file = -1;
    /* libhdf5 copies the bytes; its older interface lacks the const */
    if (list >= 0 && H5Pset_fapl_core(list, 1 << 16, 0) >= 0 &&
        H5Pset_file_image(list, (void *)(uintptr_t)bytes->bytes, bytes->size) >= 0)
        file = H5Fopen("memory", H5F_ACC_RDONLY, list);
    if (list >= 0)
        H5Pclose(list);
    return file;
}

/* "u" decides the size where it is there, else the first data set. */
static bool find_size(search *s, hid_t file) {
    shape found;
    hid_t set = H5Lexists(file, "u", H5P_DEFAULT) > 0 ? H5Dopen2(file, "u", H5P_DEFAULT) : -1;
    s->sized = set >= 0 && find_shape(set, &found);
    if (set >= 0)
        H5Dclose(set);
    if (!s->sized)
        return true;
    const uint64_t size[3] = {found.size[0], found.size[1], found.size[2]};
    return io_grid_size(s->r, s->grid, size);
}

static bool look(io_reader *r, hid_t file, io_grid *grid) {
    search s = {r, grid, false, false, 0};
    if (!find_size(&s, file))
        return false;
    if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, on_object, &s, H5O_INFO_BASIC) < 0)
        return io_fail(r, "is damaged: its list of data sets cannot be read; copy it again");
    if (s.failed)
        return false;
    if (!grid->field_count)
        return io_fail(r, "has no data set of shape [t,x,y,z] or [x,y,z]");
    find_spacing(file, grid);
    return !s.skipped ||
           io_warn(r, "%llu data sets of another size are left out", (unsigned long long)s.skipped);
}

bool io_open_hdf5(io_reader *r, io_cursor *bytes, io_grid *grid) {
    quiet before = hush();
    hid_t file = open_image(bytes);
    bool done = file >= 0 ? look(r, file, grid)
                          : io_fail(r, "is damaged: HDF5 cannot open it; copy the file again");
    if (file >= 0 && !done)
        H5Fclose(file);
    if (done) {
        grid->handle = (int64_t)file;
        grid->load = load;
        grid->close = close_file;
    }
    unhush(before);
    return done;
}
#else
bool io_open_hdf5(io_reader *r, io_cursor *bytes, io_grid *grid) {
    (void)bytes;
    (void)grid;
    return io_fail(r, "is HDF5, which this build does not read; build it with libhdf5-dev");
}
#endif
