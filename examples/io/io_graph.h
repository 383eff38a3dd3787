/* A vessel tree while it is read: nodes and segments in the order of the file. Private to
 * examples/io. */
#ifndef LINEAO_IO_GRAPH_H
#define LINEAO_IO_GRAPH_H

#include "io_internal.h"

struct io_graph {
    io_tree_kind kind;
    const char *unit;    /* of io_unit_named; NULL = the file tells none */
    const char *habit;   /* the unit that files of this make have, for the guess; NULL = none */
    bool centimetres;    /* else cm where the radii are as small as those of SimVascular, or mm */
    double *positions;   /* x y z */
    double *radii;       /* NaN = not told */
    uint32_t *node_rows; /* row of each node in the file's arrays */
    size_t node_count, node_capacity;
    uint32_t *segments; /* parent, child */
    uint32_t *segment_rows;
    double *widths; /* radius of each segment, NaN = not told */
    size_t segment_count, segment_capacity;
    io_columns node_columns, segment_columns;
};

/* Zeroed, and the reader's graph from now on; NULL = no memory. */
io_graph *io_graph_new(io_reader *reader, io_tree_kind kind);
/* A radius that is negative or no number counts as not told. */
bool io_graph_add_node(io_reader *reader, const double position[3], double radius, size_t row);
bool io_graph_add_segment(io_reader *reader, size_t parent, size_t child, double radius,
                          size_t row);
/* Gives nodes without a radius that of the widest segment that enters them, and those that none
 * enters that of the widest that leaves. */
bool io_graph_spread_radii(io_reader *reader);

/* A unit by its name or a word for it ("mm", "millimetre", "micron"): its name; NULL = unknown. */
const char *io_unit_named(io_text text);
/* Millimetres in a unit of io_unit_named. */
double io_unit_millimetres(const char *unit);

/* Hands the tree over. */
bool io_finish_tree(io_reader *reader, const char *format, io_tree *out);

#endif
