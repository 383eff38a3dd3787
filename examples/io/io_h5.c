/* HDF5 section graphs (Blue Brain, VessMorphoVis): points[n,4] = x y z DIAMETER, structure[s,..] =
 * first point of each section, connectivity[c,2] = parent and child section. */
#include "io_graph.h"

#include <hdf5.h>
#include <math.h>
#include <string.h>

static const uint8_t signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n'};

/* A user block of 512, 1024, ... bytes may stand in front. */
io_match io_sniff_h5(const io_cursor *bytes) {
    for (size_t at = 0; at + 8 <= bytes->size && at < 1u << 20; at = at ? 2 * at : 512)
        if (!memcmp(bytes->bytes + at, signature, 8))
            return IO_YES;
    return IO_NO;
}

/* An array of doubles with `columns` values a row, of which the file has `width`. */
typedef struct table {
    double *values;
    size_t rows, width;
} table;

static bool take_extent(io_reader *r, hid_t set, const char *name, size_t least, table *out) {
    hsize_t extent[2] = {0, 1};
    hid_t space = H5Dget_space(set), type = H5Dget_type(set);
    H5T_class_t class = H5Tget_class(type);
    int rank = H5Sget_simple_extent_ndims(space);
    bool good = (class == H5T_INTEGER || class == H5T_FLOAT) && (rank == 1 || rank == 2) &&
                H5Sget_simple_extent_dims(space, extent, NULL) == rank;
    H5Sclose(space);
    H5Tclose(type);
    if (!good || extent[1] < least || extent[1] > IO_MAX_COMPONENTS)
        return io_fail(r, "has a data set '%s' that is not a table of numbers with %zu columns",
                       name, least);
    if (extent[0] > UINT32_MAX)
        return io_fail(r, "has more than 4294967295 rows in its data set '%s'", name);
    out->rows = (size_t)extent[0];
    out->width = (size_t)extent[1];
    return true;
}

static bool take_table(io_reader *r, hid_t file, const char *name, size_t least, table *out) {
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    if (set < 0)
        return io_fail(r,
                       "holds no tree: its data set '%s' is missing or damaged; points, "
                       "structure and connectivity are needed",
                       name);
    bool good = take_extent(r, set, name, least, out);
    if (good) {
        out->values = io_alloc(r, out->rows, out->width * sizeof *out->values);
        good = out->values != NULL;
    }
    if (good && out->rows &&
        H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out->values) < 0)
        good = io_fail(r, "has a damaged data set '%s'; copy the file again", name);
    H5Dclose(set);
    return good;
}

/* ---- Sections -------------------------------------------------------------------------------- */

typedef struct sections {
    table points, first, links;
} sections;

static bool add_nodes(io_reader *r, const table *points) {
    for (size_t i = 0; i < points->rows; i++) {
        const double *p = points->values + i * points->width;
        if (!io_is_position(p))
            return io_fail(r, "has a coordinate that is not finite at point %zu", i);
        if (!io_graph_add_node(r, p, p[3] / 2, i))
            return false;
    }
    return true;
}

/* The points of a section: begin .. end - 1. */
static bool range_of(io_reader *r, const sections *s, size_t section, size_t *begin, size_t *end) {
    double rows = (double)s->points.rows, first = s->first.values[section * s->first.width];
    double next =
        section + 1 < s->first.rows ? s->first.values[(section + 1) * s->first.width] : rows;
    if (!(first >= 0 && first <= next && next <= rows))
        return io_fail(r, "has a section %zu that does not lie within the %zu points", section,
                       s->points.rows);
    *begin = (size_t)first;
    *end = (size_t)next;
    return true;
}

static bool add_sections(io_reader *r, const sections *s) {
    for (size_t i = 0; i < s->first.rows; i++) {
        size_t begin, end;
        if (!range_of(r, s, i, &begin, &end))
            return false;
        for (size_t k = begin + 1; k < end; k++)
            if (!io_graph_add_segment(r, k - 1, k, (double)NAN, i))
                return false;
    }
    return true;
}

/* The last point of a parent usually is the first of its child, else a segment joins them. */
static bool add_links(io_reader *r, const sections *s) {
    const double *positions = r->graph->positions;
    for (size_t i = 0; i < s->links.rows; i++) {
        const double *link = s->links.values + i * s->links.width;
        size_t begin[2], end[2];
        for (int k = 0; k < 2; k++) {
            if (!(link[k] >= 0 && link[k] < (double)s->first.rows))
                return io_fail(r,
                               "connects a section that is not one of its %zu: row %zu of "
                               "connectivity",
                               s->first.rows, i);
            if (!range_of(r, s, (size_t)link[k], &begin[k], &end[k]))
                return false;
        }
        if (begin[0] == end[0] || begin[1] == end[1])
            continue;
        size_t from = end[0] - 1, to = begin[1];
        if (memcmp(positions + 3 * from, positions + 3 * to, 3 * sizeof *positions) != 0 &&
            !io_graph_add_segment(r, from, to, (double)NAN, (size_t)link[1]))
            return false;
    }
    return true;
}

static bool read_sections(io_reader *r, hid_t file) {
    sections s;
    memset(&s, 0, sizeof s);
    if (!take_table(r, file, "points", 4, &s.points) ||
        !take_table(r, file, "structure", 1, &s.first) ||
        !take_table(r, file, "connectivity", 2, &s.links))
        return false;
    return io_graph_new(r, IO_TREE_SECTIONS) && add_nodes(r, &s.points) && add_sections(r, &s) &&
           add_links(r, &s);
}

/* The library reads from the bytes in memory, and keeps silent meanwhile. */
bool io_read_h5(io_reader *r, io_cursor *bytes) {
    H5E_auto2_t handler;
    void *user;
    H5Eget_auto2(H5E_DEFAULT, &handler, &user);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    /* the library copies the image, and does not change it; its interface lacks the const */
    bool ready = H5Pset_fapl_core(access, 1 << 16, 0) >= 0 &&
                 H5Pset_file_image(access, (void *)(uintptr_t)bytes->bytes, bytes->size) >= 0;
    hid_t file = ready ? H5Fopen("lineao", H5F_ACC_RDONLY, access) : -1;
    bool done = file >= 0 ? read_sections(r, file)
                          : io_fail(r, "is damaged, or not an HDF5 file; copy it again");
    if (file >= 0)
        H5Fclose(file);
    H5Pclose(access);
    H5Eset_auto2(H5E_DEFAULT, handler, user);
    if (done)
        r->graph->unit = "um"; /* the format's */
    return done;
}
