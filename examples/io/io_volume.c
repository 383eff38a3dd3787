/* Velocity volumes: finds the format of each file, the velocity and the mask among their arrays,
 * and puts them together. */
#include "io_grid.h"
#include "io_hdf5.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

typedef struct format {
    const char *name;
    io_match (*sniff)(const io_cursor *bytes);
    bool (*open)(io_reader *reader, io_cursor *bytes, io_grid *grid);
} format;

static const format formats[] = {
    {"nifti", io_sniff_nifti, io_open_nifti},
    {"vti", io_sniff_vti, io_open_vti},
    {"vtk", io_sniff_points, io_open_points},
    {"hdf5", io_sniff_hdf5, io_open_hdf5},
};
enum { FORMAT_COUNT = sizeof formats / sizeof formats[0], NAMES = 4 };

typedef struct gather { /* one read */
    io_reader r;
    const io_volume_options *options;
    io_options reader_options;
    uint32_t count, at; /* files with velocity, and the one being read; count: the mask's */
    io_grid *grids;     /* count + 1: the last is the mask's file */
    const io_field *(*velocity)[3]; /* of each grid: the fields of x y z ... */
    uint32_t (*component)[3];       /* ... and the component of each */
    bool joined;                    /* three files, one component each: velocity[0] has all */
    bool building;                  /* all files are open */
    bool as_frames;                 /* the components are the frames of one array */
    char *names[NAMES];
    uint32_t name_count;
} gather;

/* ---- Grids and fields ------------------------------------------------------------------------ */

io_field *io_add_field(io_reader *r, io_grid *grid, io_text name) {
    io_field *fields =
        io_grow(r, grid->fields, &grid->field_capacity, grid->field_count + 1, sizeof *fields);
    char *label = io_copy_text(r, name);
    if (fields)
        grid->fields = fields;
    if (!fields || !label)
        return NULL;
    io_field *field = &fields[grid->field_count++];
    memset(field, 0, sizeof *field);
    field->name = label;
    field->components = field->frames = 1;
    field->slope = 1;
    return field;
}

bool io_grid_size(io_reader *r, io_grid *grid, const uint64_t size[3]) {
    uint64_t most = r->limit / (3 * sizeof(float)), voxels = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (!size[axis] || size[axis] > UINT32_MAX || size[axis] > most / voxels)
            return io_fail(r,
                           "claims %llu x %llu x %llu voxels, more than a file of this size can "
                           "hold; it is damaged",
                           (unsigned long long)size[0], (unsigned long long)size[1],
                           (unsigned long long)size[2]);
        voxels *= size[axis];
        grid->size[axis] = (uint32_t)size[axis];
    }
    return true;
}

size_t io_grid_voxels(const io_grid *grid) {
    return (size_t)grid->size[0] * grid->size[1] * grid->size[2];
}

void io_field_packed(io_field *field, const io_grid *grid) {
    field->stride[3] = io_type_size(field->type);
    field->stride[0] = field->stride[3] * field->components;
    field->stride[1] = field->stride[0] * grid->size[0];
    field->stride[2] = field->stride[1] * grid->size[1];
    field->stride[4] = field->stride[2] * grid->size[2];
}

static bool load(gather *g, io_grid *grid, const io_field *field) {
    return field->bytes || !grid->load ||
           grid->load(&g->r, grid, &grid->fields[field - grid->fields]);
}

/* ---- Names ----------------------------------------------------------------------------------- */

static bool split_names(gather *g) {
    const char *at = g->options->names;
    while (at && *at) {
        const char *end = strchr(at, ',');
        io_text name = {at, end ? (size_t)(end - at) : strlen(at)};
        if (g->name_count == NAMES || !io_text_trim(name).size)
            return io_fail(&g->r,
                           "cannot be read with the names '%.64s': write velocity, "
                           "velocity,mask or u,v,w or u,v,w,mask",
                           g->options->names);
        if (!(g->names[g->name_count++] = io_copy_text(&g->r, io_text_trim(name))))
            return false;
        at = end ? end + 1 : NULL;
    }
    return true;
}

/* "a, b[3], c" */
static void list_arrays(const io_grid *grid, char *text, size_t size) {
    size_t used = 0;
    snprintf(text, size, "none");
    for (size_t i = 0; i < grid->field_count && used < size; i++) {
        const io_field *f = &grid->fields[i];
        int more = snprintf(text + used, size - used, "%s%.64s", i ? ", " : "", f->name);
        used += (size_t)more;
        if (f->components > 1 && used < size)
            used += (size_t)snprintf(text + used, size - used, "[%u]", (unsigned)f->components);
    }
}

static const io_field *field_named(const io_grid *grid, const char *name) {
    for (size_t i = 0; i < grid->field_count; i++)
        if (!strcmp(grid->fields[i].name, name))
            return &grid->fields[i];
    for (size_t i = 0; i < grid->field_count; i++)
        if (io_text_is(io_text_of(grid->fields[i].name), name))
            return &grid->fields[i];
    return NULL;
}

static const io_field *must_find(gather *g, const io_grid *grid, const char *name,
                                 const char *flag) {
    char names[300];
    const io_field *field = field_named(grid, name);
    list_arrays(grid, names, sizeof names);
    if (!field)
        io_error_set(g->r.error, "has no array '%.64s'; its arrays are: %s; %s picks them", name,
                     names, flag);
    return field;
}

/* ---- Velocity -------------------------------------------------------------------------------- */

static bool use_vector(gather *g, uint32_t at, const io_field *field) {
    if (field->components != 3)
        return io_fail(&g->r, "has %u values per voxel in its array '%.64s'; velocity has 3",
                       (unsigned)field->components, field->name);
    for (uint32_t k = 0; k < 3; k++) {
        g->velocity[at][k] = field;
        g->component[at][k] = k;
    }
    return true;
}

static bool use_three(gather *g, uint32_t at, const io_field *const fields[3]) {
    for (uint32_t k = 0; k < 3; k++) {
        if (fields[k]->components != 1 || fields[k]->frames != fields[0]->frames)
            return io_fail(&g->r,
                           "has %u frames and %u values per voxel in its array '%.64s', but %u "
                           "frames in '%.64s'; components need 1 value and as many frames",
                           (unsigned)fields[k]->frames, (unsigned)fields[k]->components,
                           fields[k]->name, (unsigned)fields[0]->frames, fields[0]->name);
        g->velocity[at][k] = fields[k];
    }
    return true;
}

static bool use_names(gather *g, uint32_t at) {
    const io_grid *grid = &g->grids[at];
    const io_field *fields[3] = {NULL, NULL, NULL};
    uint32_t wanted = g->name_count < 3 ? 1 : 3;
    for (uint32_t k = 0; k < wanted; k++)
        if (!(fields[k] = must_find(g, grid, g->names[k], "--names")))
            return false;
    return wanted == 1 ? use_vector(g, at, fields[0]) : use_three(g, at, fields);
}

/* The usual names of three components. */
static bool find_three(const io_grid *grid, const io_field *fields[3]) {
    static const char *const usual[][3] = {
        {"u", "v", "w"},          {"vx", "vy", "vz"},
        {"v_x", "v_y", "v_z"},    {"velocity_x", "velocity_y", "velocity_z"},
        {"velx", "vely", "velz"}, {"vel_x", "vel_y", "vel_z"},
    };
    for (size_t i = 0; i < sizeof usual / sizeof usual[0]; i++) {
        bool all = true;
        for (int k = 0; k < 3; k++)
            all = (fields[k] = field_named(grid, usual[i][k])) && fields[k]->components == 1 && all;
        if (all)
            return true;
    }
    return false;
}

/* The array that the file calls its vectors, the only one of three components, or the only one of
 * them that is called velocity. *many: there were several. */
static const io_field *find_vector(const io_grid *grid, bool *many) {
    const io_field *named = grid->vectors ? field_named(grid, grid->vectors) : NULL;
    const io_field *any = NULL, *velocity = NULL;
    size_t anys = 0, velocities = 0;
    for (size_t i = 0; i < grid->field_count; i++) {
        const io_field *f = &grid->fields[i];
        if (f->components != 3)
            continue;
        any = f;
        anys++;
        if (io_text_starts(io_text_of(f->name), "vel")) {
            velocity = f;
            velocities++;
        }
    }
    *many = anys > 1;
    return named && named->components == 3 ? named
           : anys == 1                     ? any
           : velocities == 1               ? velocity
                                           : NULL;
}

static bool no_velocity(gather *g, const io_grid *grid, bool many) {
    char names[300];
    list_arrays(grid, names, sizeof names);
    if (many)
        return io_fail(&g->r, "has several arrays that may be velocity: %s; pick one with --names",
                       names);
    return io_fail(&g->r,
                   "has no velocity: no array of 3 values per voxel, none called u, v, w; "
                   "its arrays are: %s; name them with --names, or give the files of all "
                   "three components",
                   names);
}

/* Finds the velocity of a grid; *found stays false when there is none. */
static bool find_velocity(gather *g, uint32_t at, bool *found, bool *many) {
    const io_grid *grid = &g->grids[at];
    const io_field *fields[3], *vector;
    *found = true;
    *many = false;
    if (g->name_count)
        return use_names(g, at);
    if (find_three(grid, fields))
        return use_three(g, at, fields);
    if ((vector = find_vector(grid, many)))
        return use_vector(g, at, vector);
    *found = false;
    return true;
}

static bool is_single(const io_grid *grid) {
    return grid->field_count == 1 && grid->fields[0].components == 1;
}

static bool same_size(gather *g, const io_grid *a, const io_grid *b) {
    return !memcmp(a->size, b->size, sizeof a->size) ||
           io_fail(&g->r, "has %u x %u x %u voxels, but the first file has %u x %u x %u",
                   (unsigned)b->size[0], (unsigned)b->size[1], (unsigned)b->size[2],
                   (unsigned)a->size[0], (unsigned)a->size[1], (unsigned)a->size[2]);
}

/* Three files with one component each, or one whose frames are the components. */
static bool join(gather *g, bool many) {
    const io_field *fields[3];
    io_grid *first = &g->grids[0];
    bool single = true;
    g->at = 0;
    for (uint32_t i = 0; i < g->count; i++)
        single = single && is_single(&g->grids[i]);
    if (g->count == 1 && single && first->fields[0].frames == 3) {
        g->as_frames = true;
        for (uint32_t k = 0; k < 3; k++)
            g->velocity[0][k] = &first->fields[0];
        return io_warn(&g->r, "its three frames are taken as the components x y z");
    }
    if (g->count != 3 || !single)
        return no_velocity(g, first, many);
    for (uint32_t i = 0; i < 3; i++)
        fields[i] = &g->grids[i].fields[0];
    g->joined = true;
    return use_three(g, 0, fields);
}

/* Without names or usual arrays in any file they may be components. */
static bool find_velocities(gather *g) {
    bool found = false, many = false;
    for (g->at = 0; g->at < g->count; g->at++) {
        if (g->at && !same_size(g, &g->grids[0], &g->grids[g->at]))
            return false;
        if (!find_velocity(g, g->at, &found, &many))
            return false;
        if (!found && g->at)
            return is_single(&g->grids[0]) ? join(g, many) : no_velocity(g, &g->grids[g->at], many);
        if (!found)
            break;
    }
    if (found)
        return true;
    for (g->at = 1; g->at < g->count; g->at++)
        if (!same_size(g, &g->grids[0], &g->grids[g->at]))
            return false;
    return join(g, many);
}

/* ---- Values ---------------------------------------------------------------------------------- */

static double value(const io_field *f, const uint32_t at[3], uint32_t component, size_t frame) {
    io_view view;
    memset(&view, 0, sizeof view);
    view.bytes = f->bytes + at[0] * f->stride[0] + at[1] * f->stride[1] + at[2] * f->stride[2] +
                 component * f->stride[3] + frame * f->stride[4];
    view.type = f->type;
    view.big = f->big;
    return f->intercept + f->slope * io_view_real(&view, 0, 0);
}

/* Counts through the voxels, x fastest; false behind the last. */
static bool next_voxel(const uint32_t size[3], uint32_t at[3]) {
    for (int axis = 0; axis < 3; axis++) {
        if (++at[axis] < size[axis])
            return true;
        at[axis] = 0;
    }
    return false;
}

static uint8_t *need_mask(gather *g, io_volume *out, size_t voxels) {
    if (!out->mask && (out->mask = io_take_memory(&g->r, voxels, 1)))
        memset(out->mask, 1, voxels);
    return out->mask;
}

/* One frame of m/s; what is not finite becomes 0 and outside. */
static bool copy_frame(gather *g, const io_field *const fields[3], const uint32_t component[3],
                       size_t frame, double turn[3][3], float *to, io_volume *out, size_t *broken) {
    uint32_t at[3] = {0, 0, 0};
    size_t voxel = 0, voxels = (size_t)out->size[0] * out->size[1] * out->size[2];
    do {
        double v[3];
        float *p = to + 3 * voxel;
        bool finite = true;
        for (int k = 0; k < 3; k++)
            v[k] = value(fields[k], at, component[k], g->as_frames ? (size_t)k : frame);
        for (int k = 0; k < 3; k++) {
            p[k] = (float)(turn[k][0] * v[0] + turn[k][1] * v[1] + turn[k][2] * v[2]);
            finite = finite && fabsf(p[k]) < 1e9f;
        }
        if (!finite) {
            p[0] = p[1] = p[2] = 0;
            if (!need_mask(g, out, voxels))
                return false;
            *broken += out->mask[voxel];
            out->mask[voxel] = 0;
        }
        voxel++;
    } while (next_voxel(out->size, at));
    return true;
}

/* Unit, and from the grid's axes to those of the mm where asked for. */
static bool find_turn(gather *g, const io_volume *out, double turn[3][3]) {
    // clang-format off
    static const struct { const char *name; double scale; } units[] = {{"m/s", 1}, {"cm/s", 0.01}, {"mm/s", 0.001}};
    // clang-format on
    const char *unit = g->options->unit ? g->options->unit : "m/s";
    double scale = 0;
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
        scale = !strcmp(unit, units[i].name) ? units[i].scale : scale;
    if (scale == 0)
        return io_fail(&g->r, "cannot be read in '%.32s': write --unit m/s, cm/s or mm/s", unit);
    for (int column = 0; column < 3; column++) {
        double length = 0;
        for (int row = 0; row < 3; row++)
            length += out->to_mm[row][column] * out->to_mm[row][column];
        for (int row = 0; row < 3; row++)
            turn[row][column] = g->options->along_grid
                                    ? scale * out->to_mm[row][column] / sqrt(length)
                                    : scale * (row == column);
    }
    return true;
}

static uint32_t frames_of(const gather *g, uint32_t at) {
    return g->as_frames ? 1 : g->velocity[at][0]->frames;
}

static bool copy_velocity(gather *g, io_volume *out) {
    uint32_t grids = g->joined ? 1 : g->count;
    size_t voxels = (size_t)out->size[0] * out->size[1] * out->size[2], broken = 0, done = 0;
    double turn[3][3];
    if (!find_turn(g, out, turn))
        return false;
    if (out->frame_count > g->r.limit / (3 * sizeof(float)) / voxels)
        return io_fail(&g->r, "has %u frames, more than files of this size can hold",
                       (unsigned)out->frame_count);
    out->velocity = io_take_memory(&g->r, voxels * out->frame_count, 3 * sizeof(float));
    if (!out->velocity)
        return false;
    for (uint32_t i = 0; i < grids; i++) {
        g->at = i;
        for (uint32_t k = 0; k < 3; k++)
            if (!load(g, &g->grids[g->joined ? k : i], g->velocity[i][k]))
                return false;
        for (uint32_t frame = 0; frame < frames_of(g, i); frame++, done++)
            if (!io_tick(&g->r, done, out->frame_count) ||
                !copy_frame(g, g->velocity[i], g->component[i], frame, turn,
                            out->velocity + 3 * voxels * done, out, &broken))
                return false;
    }
    return !broken || io_warn(&g->r,
                              "%zu voxels have a velocity that is not finite; they count as "
                              "outside",
                              broken);
}

/* ---- Mask ------------------------------------------------------------------------------------ */

/* The usual names; VTK's is that of its own filters. */
static const io_field *usual_mask(const io_grid *grid) {
    static const char *const names[] = {"mask", "vtkValidPointMask", "segmentation"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const io_field *field = field_named(grid, names[i]);
        if (field && field->components == 1)
            return field;
    }
    return NULL;
}

static bool apply_mask(gather *g, io_grid *grid, const io_field *field, io_volume *out) {
    size_t voxels = io_grid_voxels(grid), voxel = 0;
    uint32_t at[3] = {0, 0, 0};
    if (!load(g, grid, field) || !need_mask(g, out, voxels))
        return false;
    do {
        bool inside = false;
        for (uint32_t frame = 0; frame < field->frames; frame++)
            inside = inside || value(field, at, 0, frame) >= 0.5;
        out->mask[voxel] = out->mask[voxel] && inside;
        voxel++;
    } while (next_voxel(grid->size, at));
    return field->frames == 1 ||
           io_warn(&g->r, "the mask '%.64s' has %u frames; inside is what is inside in any of them",
                   field->name, (unsigned)field->frames);
}

static bool find_mask(gather *g, io_volume *out) {
    const io_volume_options *options = g->options;
    io_grid *grid = &g->grids[options->mask_file ? g->count : 0];
    const char *name = options->mask                             ? options->mask
                       : options->mask_file                      ? NULL
                       : g->name_count % 2 == 0 && g->name_count ? g->names[g->name_count - 1]
                                                                 : NULL;
    const io_field *field;
    g->at = options->mask_file ? g->count : 0;
    if (options->mask_file && !same_size(g, &g->grids[0], grid))
        return false;
    if (name)
        field = must_find(g, grid, name, "--mask");
    else if (!(field = usual_mask(grid)) && options->mask_file && is_single(grid))
        field = &grid->fields[0];
    if (!field && options->mask_file && !name)
        return io_fail(&g->r, "has no array of one value called mask; it cannot be a mask");
    if (!field)
        return !name;
    if (field->components != 1)
        return io_fail(&g->r, "has %u values per voxel in '%.64s'; a mask has 1",
                       (unsigned)field->components, field->name);
    return apply_mask(g, grid, field, out);
}

/* ---- Space and time -------------------------------------------------------------------------- */

static bool set_space(gather *g, io_volume *out) {
    const io_grid *grid = &g->grids[0];
    const double *spacing = g->options->spacing;
    bool given = spacing[0] > 0 && spacing[1] > 0 && spacing[2] > 0;
    memcpy(out->size, grid->size, sizeof out->size);
    memcpy(out->to_mm, grid->to_mm, sizeof out->to_mm);
    if (!given && !grid->has_spacing && g->options->guess)
        return io_warn(&g->r, "it tells no size of its voxels; 1 mm is taken; --spacing gives it");
    if (!given && !grid->has_spacing)
        return io_fail(&g->r, "tells no size of its voxels; give it in mm: --spacing X,Y,Z");
    for (int column = 0; column < 3 && given; column++) {
        double length = 0;
        for (int row = 0; row < 3; row++)
            length += grid->to_mm[row][column] * grid->to_mm[row][column];
        for (int row = 0; row < 3; row++)
            out->to_mm[row][column] = grid->to_mm[row][column] / sqrt(length) * spacing[column];
    }
    return true;
}

static bool set_time(gather *g, io_volume *out) {
    const io_volume_options *o = g->options;
    uint64_t frames = 0;
    for (uint32_t i = 0; i < (g->joined ? 1 : g->count); i++)
        frames += frames_of(g, i);
    if (frames > UINT32_MAX)
        return io_fail(&g->r, "has more than 4294967295 frames");
    out->frame_count = (uint32_t)frames;
    if (frames == 1)
        return true;
    double step = g->count == 1 || g->joined ? g->grids[0].time_step : 0;
    double from_period = o->period / (double)frames;
    if (o->time_step > 0 && o->period > 0 && fabs(from_period - o->time_step) > 1e-3 * from_period)
        return io_fail(&g->r,
                       "has %u frames: a period of %g ms makes steps of %g ms, not %g; give "
                       "one of --period and --time-step",
                       (unsigned)frames, o->period, from_period, o->time_step);
    step = o->time_step > 0 ? o->time_step : o->period > 0 ? from_period : step;
    bool guess = !(step > 0) && g->options->guess;
    if (guess && !io_warn(&g->r, "it tells no time between its frames; 1 ms is taken; --time-step "
                                 "gives it"))
        return false;
    step = guess ? 1 : step;
    if (!(step > 0))
        return io_fail(&g->r,
                       "has %u frames and tells no time between them; give it in ms: "
                       "--time-step MS, or --period MS for all",
                       (unsigned)frames);
    out->time_step = step;
    out->period = step * (double)frames;
    return true;
}

/* ---- Handing over ---------------------------------------------------------------------------- */

static bool find_speeds(gather *g, io_volume *out) {
    size_t voxels = (size_t)out->size[0] * out->size[1] * out->size[2];
    double low = INFINITY, high = -INFINITY;
    out->mask_voxels = voxels;
    for (size_t i = 0; out->mask && i < voxels; i++)
        out->mask_voxels -= !out->mask[i];
    for (size_t i = 0; i < voxels * out->frame_count; i++) {
        const float *v = out->velocity + 3 * i;
        if (out->mask && !out->mask[i % voxels])
            continue;
        double squared = (double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2];
        low = squared < low ? squared : low;
        high = squared > high ? squared : high;
    }
    out->speed[0] = low <= high ? sqrt(low) : 0;
    out->speed[1] = low <= high ? sqrt(high) : 0;
    if (!out->mask_voxels && !io_warn(&g->r, "its mask is empty"))
        return false;
    return out->speed[1] <= 10 || g->options->unit ||
           io_warn(&g->r,
                   "speeds reach %.3g m/s; blood is slower: is the file in cm/s or mm/s? "
                   "--unit tells",
                   out->speed[1]);
}

static bool copy_names(gather *g, io_volume *out) {
    const io_grid *grid = &g->grids[0];
    if (!(out->arrays = io_take_memory(&g->r, grid->field_count, sizeof *out->arrays)))
        return false;
    for (size_t i = 0; i < grid->field_count; i++)
        if (!(out->arrays[out->array_count++] = io_take_text(&g->r, grid->fields[i].name)))
            return false;
    return true;
}

static bool build(gather *g, io_volume *out) {
    g->at = 0;
    g->building = true;
    out->format = g->grids[0].format;
    if (!split_names(g) || !find_velocities(g))
        return false;
    g->at = 0;
    return set_space(g, out) && set_time(g, out) && copy_velocity(g, out) && find_mask(g, out) &&
           (g->at = 0, find_speeds(g, out)) && copy_names(g, out) &&
           io_take_warnings(&g->r, &out->warnings, &out->warning_count);
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* Progress of one file as a part of all. */
static bool on_progress(void *user, uint64_t done, uint64_t total) {
    const gather *g = user;
    uint64_t files = (uint64_t)g->count + 1, at = g->building ? files + g->at : g->at;
    return g->options->progress(g->options->user, at * total + done, 2 * files * total);
}

static const format *find_format(const io_cursor *bytes) {
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (formats[i].sniff(bytes) == IO_YES)
            return &formats[i];
    return NULL;
}

static bool open_grid(gather *g, io_cursor bytes, io_grid *grid) {
    io_reader *r = &g->r;
    if (!bytes.size)
        return io_fail(r, "is empty (0 bytes)");
    r->step = 0;
    if (io_is_gzip(&bytes) && !io_gunzip(r, &bytes))
        return false;
    const format *found = find_format(&bytes);
    if (!found)
        return io_fail(r, "is not a volume: it begins like none of NIfTI (.nii), ImageData (.vti), "
                          "STRUCTURED_POINTS (.vtk), HDF5 (.h5)");
    for (int k = 0; k < 3; k++)
        grid->to_mm[k][k] = 1;
    grid->format = found->name;
    r->step = 1;
    return io_tick(r, 0, 1) && found->open(r, &bytes, grid);
}

/* Reads files or memory: where paths is NULL, sources. */
static bool open_all(gather *g, const char *const *paths, const io_source *sources) {
    const char *mask = g->options->mask_file;
    uint64_t total = 0;
    io_cursor *bytes = io_alloc(&g->r, (size_t)g->count + 1, sizeof *bytes);
    for (g->at = 0; bytes && g->at < g->count + (mask != NULL); g->at++) {
        const char *path = g->at == g->count ? mask : paths ? paths[g->at] : NULL;
        io_cursor *c = &bytes[g->at];
        if (path && !io_read_file(&g->r, path, c))
            return false;
        if (!path) {
            c->bytes = sources[g->at].bytes;
            c->size = sources[g->at].size;
        }
        total += c->size;
    }
    if (!bytes)
        return false;
    io_set_limit(&g->r, total < SIZE_MAX ? (size_t)total : SIZE_MAX);
    for (g->at = 0; g->at < g->count + (mask != NULL); g->at++)
        if (!open_grid(g, bytes[g->at], &g->grids[g->at]))
            return false;
    return true;
}

static bool read_all(gather *g, const char *const *paths, const io_source *sources,
                     io_volume *out) {
    io_reader *r = &g->r;
    size_t count = g->count;
    if (!count)
        return io_fail(r, "no file is given");
    if (!(g->grids = io_alloc(r, count + 1, sizeof *g->grids)) ||
        !(g->velocity = io_alloc(r, count, sizeof *g->velocity)) ||
        !(g->component = io_alloc(r, count, sizeof *g->component)))
        return false;
    io_volume volume;
    memset(&volume, 0, sizeof volume);
    bool done = open_all(g, paths, sources) && build(g, &volume);
    for (size_t i = 0; i <= count; i++)
        if (g->grids[i].close)
            g->grids[i].close(&g->grids[i]);
    if (done)
        *out = volume;
    else
        io_volume_free(&volume);
    return done;
}

static bool read_volume(const char *const *paths, const io_source *sources, uint32_t count,
                        const io_volume_options *options, io_volume *out, uint32_t *failed,
                        io_error *error) {
    io_volume_options none;
    gather g;
    memset(&none, 0, sizeof none);
    memset(&g, 0, sizeof g);
    g.options = options ? options : &none;
    g.count = count;
    if (g.options->progress) {
        g.reader_options.progress = on_progress;
        g.reader_options.user = &g;
    }
    io_begin(&g.r, &g.reader_options, error);
    bool done = read_all(&g, paths, sources, out);
    if (!done && failed)
        *failed = g.at;
    io_reader_free(&g.r);
    return done;
}

bool io_read_volume(const char *const *paths, uint32_t count, const io_volume_options *options,
                    io_volume *out, uint32_t *failed, io_error *error) {
    return read_volume(paths, NULL, count, options, out, failed, error);
}

bool io_read_volume_memory(const io_source *sources, uint32_t count,
                           const io_volume_options *options, io_volume *out, uint32_t *failed,
                           io_error *error) {
    return read_volume(NULL, sources, count, options, out, failed, error);
}

bool io_is_volume(const char *path) {
    uint8_t head[65536];
    struct stat info;
    if (stat(path, &info) || !S_ISREG(info.st_mode))
        return false;                 /* of a pipe nothing may be taken away */
    gzFile file = gzopen(path, "rb"); /* reads what is not compressed as it is */
    int size = file ? gzread(file, head, sizeof head) : 0;
    if (file)
        gzclose(file);
    io_cursor bytes = {head, size > 0 ? (size_t)size : 0, 0};
    return bytes.size && find_format(&bytes) != NULL;
}

void io_volume_free(io_volume *volume) {
    if (!volume)
        return;
    free(volume->velocity);
    free(volume->mask);
    for (uint32_t i = 0; i < volume->array_count; i++)
        free(volume->arrays[i]);
    free(volume->arrays);
    for (uint32_t i = 0; i < volume->warning_count; i++)
        free(volume->warnings[i]);
    free(volume->warnings);
    memset(volume, 0, sizeof *volume);
}
