/* HDF5 section graphs (Blue Brain, VessMorphoVis): points[n,4] = x y z DIAMETER, structure[s,..] =
 * first point of each section, connectivity[c,2] = parent and child section; and, if they are
 * there, attributes of the points. */
#include "io_hdf5.h"

#include "io_graph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

io_match io_sniff_h5(const io_cursor *bytes) {
    return io_is_section_graph(bytes) ? IO_YES : io_is_hdf5(bytes) ? IO_MAYBE : IO_NO;
}

#ifdef LINEAO_HAVE_HDF5

/* ---- Tables ---------------------------------------------------------------------------------- */

/* A table of numbers, of which the file has width columns. */
typedef struct table {
    double *values;
    size_t rows, width;
} table;

/* What the child sends of each table, before its values. */
typedef struct answer {
    uint64_t rows, width;
    uint64_t state; /* one of: */
} answer;
enum { GOOD, MISSING, BROKEN };

/* The three tables, and what else points may have, in this order. */
typedef struct table_row {
    const char *name;
    uint64_t columns; /* at least */
    bool optional;
} table_row;
static const table_row tables[] = {{"points", 4, false},       {"structure", 1, false},
                                   {"connectivity", 2, false}, {"section_ratio", 1, true},
                                   {"section_axis", 3, true},  {"uncertainty", 1, true}};
enum { POINTS, STRUCTURE, CONNECTIVITY, ATTRIBUTES, TABLES = ATTRIBUTES + 3 };

/* Rows and columns of a table of numbers whose values are in this file. */
static bool take_extent(hid_t set, uint64_t columns, answer *out) {
    hsize_t extent[2] = {0, 1};
    hid_t space = H5Dget_space(set), type = H5Dget_type(set), list = H5Dget_create_plist(set);
    H5T_class_t kind = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    int rank = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    bool good = (kind == H5T_INTEGER || kind == H5T_FLOAT) && (rank == 1 || rank == 2) &&
                H5Sget_simple_extent_dims(space, extent, NULL) == rank && list >= 0 &&
                H5Pget_external_count(list) <= 0;
    out->rows = extent[0];
    out->width = extent[1];
    return good && extent[1] >= columns && extent[1] <= IO_MAX_COMPONENTS &&
           extent[0] <= UINT32_MAX;
}

/* In the child, which ends afterwards: nothing is closed. */
static void send_table(int socket, hid_t file, const table_row *row) {
    answer a;
    double *values = NULL;
    memset(&a, 0, sizeof a);
    hid_t set = file >= 0 ? H5Dopen2(file, row->name, H5P_DEFAULT) : -1;
    a.state = set < 0 ? MISSING : take_extent(set, row->columns, &a) ? GOOD : BROKEN;
    size_t count = (size_t)a.rows * (size_t)a.width;
    if (a.state == GOOD) {
        values = malloc((count ? count : 1) * sizeof *values);
        if (!values ||
            (count && H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0))
            a.state = BROKEN;
    }
    if (io_hdf5_send(socket, &a, sizeof a) && a.state == GOOD)
        io_hdf5_send(socket, values, count * sizeof *values);
    free(values);
}

static void serve(int socket, hid_t file) {
    for (int i = 0; i < TABLES; i++)
        send_table(socket, file, &tables[i]);
}

static bool take_table(io_reader *r, const io_hdf5_child *child, const table_row *row, table *out) {
    answer a;
    if (!io_hdf5_receive(r, child, &a, sizeof a))
        return false;
    if (a.state == MISSING && row->optional)
        return true;
    if (a.state == MISSING)
        return io_fail(r,
                       "holds no tree: its data set '%s' is missing or damaged; points, structure "
                       "and connectivity are needed",
                       row->name);
    if (a.state != GOOD || a.rows > UINT32_MAX || a.width > IO_MAX_COMPONENTS)
        return io_fail(r,
                       "has a data set '%s' that is damaged or not a table of numbers with %u "
                       "columns",
                       row->name, (unsigned)row->columns);
    out->rows = (size_t)a.rows;
    out->width = (size_t)a.width;
    out->values = io_alloc(r, out->rows, out->width * sizeof *out->values);
    return out->values &&
           io_hdf5_receive(r, child, out->values, out->rows * out->width * sizeof *out->values);
}

static bool take_tables(io_reader *r, const io_cursor *bytes, table out[TABLES]) {
    io_hdf5_child child;
    bool done = io_hdf5_start(r, bytes, serve, &child);
    if (!done)
        return false;
    for (int i = 0; done && i < TABLES; i++)
        done = take_table(r, &child, &tables[i], &out[i]);
    io_hdf5_stop(&child);
    return done;
}

/* ---- Sections -------------------------------------------------------------------------------- */

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

static bool add_attributes(io_reader *r, const table *t) {
    size_t count = t[POINTS].rows;
    for (int i = ATTRIBUTES; i < TABLES; i++) {
        io_view view = io_view_doubles(t[i].values, t[i].rows, (uint32_t)t[i].width);
        if (t[i].values && !io_attach_rows(r, &r->graph->node_columns, io_text_of(tables[i].name),
                                           &view, NULL, 0, count, 0, "point"))
            return false;
    }
    return true;
}

/* The points of a section: begin .. end - 1. */
static bool range_of(io_reader *r, const table *t, size_t section, size_t *begin, size_t *end) {
    double rows = (double)t[POINTS].rows, first = t[STRUCTURE].values[section * t[STRUCTURE].width];
    double next = section + 1 < t[STRUCTURE].rows
                      ? t[STRUCTURE].values[(section + 1) * t[STRUCTURE].width]
                      : rows;
    if (!(first >= 0 && first <= next && next <= rows))
        return io_fail(r, "has a section %zu that does not lie within the %zu points", section,
                       t[POINTS].rows);
    *begin = (size_t)first;
    *end = (size_t)next;
    return true;
}

static bool add_sections(io_reader *r, const table *t) {
    for (size_t i = 0; i < t[STRUCTURE].rows; i++) {
        size_t begin, end;
        if (!range_of(r, t, i, &begin, &end))
            return false;
        for (size_t k = begin + 1; k < end; k++)
            if (!io_graph_add_segment(r, k - 1, k, (double)NAN, i))
                return false;
    }
    return true;
}

/* The last point of a parent usually is the first of its child, else a segment joins them. */
static bool add_links(io_reader *r, const table *t) {
    const double *positions = r->graph->positions;
    for (size_t i = 0; i < t[CONNECTIVITY].rows; i++) {
        const double *link = t[CONNECTIVITY].values + i * t[CONNECTIVITY].width;
        size_t begin[2], end[2];
        for (int k = 0; k < 2; k++) {
            if (!(link[k] >= 0 && link[k] < (double)t[STRUCTURE].rows))
                return io_fail(r,
                               "connects a section that is not one of its %zu: row %zu of "
                               "connectivity",
                               t[STRUCTURE].rows, i);
            if (!range_of(r, t, (size_t)link[k], &begin[k], &end[k]))
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

bool io_read_h5(io_reader *r, io_cursor *bytes) {
    table t[TABLES];
    memset(t, 0, sizeof t);
    if (!take_tables(r, bytes, t) || !io_graph_new(r, IO_TREE_SECTIONS) ||
        !add_nodes(r, &t[POINTS]) || !add_sections(r, t) || !add_links(r, t) ||
        !add_attributes(r, t))
        return false;
    r->graph->unit = "um"; /* the format's */
    return true;
}
#else
bool io_read_h5(io_reader *r, io_cursor *bytes) {
    (void)bytes;
    return io_fail(r, "is HDF5, which this build does not read; build it with libhdf5-dev");
}
#endif
