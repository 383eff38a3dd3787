/* The two families of VTK files, taken apart: XML (.vtp, .vti) and legacy (.vtk). Both give named
 * arrays and the numbers around them; what these mean (lines, a grid) is the caller's. Private to
 * examples/io. */
#ifndef LINEAO_IO_VTK_H
#define LINEAO_IO_VTK_H

#include "io_internal.h"

/* A regular grid as VTK tells it; point (i, j, k) lies at
 * origin + direction * (spacing * (i, j, k)). */
typedef struct io_image {
    int64_t extent[6]; /* first and last point on each axis; legacy files begin at 0 */
    double origin[3], spacing[3], direction[9]; /* direction: row-major, identity when not told */
    bool has_extent, has_spacing;
} io_image;

/* "0 9 0 9 0 4" into count numbers; false unless they are all there. */
bool io_parse_reals(io_text text, double *values, size_t count);

/* ---- XML ------------------------------------------------------------------------------------- */

typedef enum io_xml_section {
    IO_XML_NOWHERE,
    IO_XML_POINT_DATA,
    IO_XML_CELL_DATA,
    IO_XML_POINTS,
    IO_XML_VERTS,
    IO_XML_LINES,
    IO_XML_STRIPS,
    IO_XML_POLYS
} io_xml_section;

typedef enum io_xml_encoding { IO_XML_ASCII, IO_XML_BINARY, IO_XML_APPENDED } io_xml_encoding;

typedef struct io_xml_array {
    const char *name;
    io_xml_section section;
    io_type type;
    io_xml_encoding encoding;
    size_t components;
    size_t offset; /* into the appended data */
    char *text;    /* of ascii and inline binary ones */
    size_t size, capacity;
} io_xml_array;

typedef struct io_xml_piece {
    size_t points, verts, lines, strips, polys;
    size_t first, last; /* its arrays: first .. last - 1 */
    double extent[6];   /* of an ImageData's piece; has_extent: told */
    bool has_extent;
} io_xml_piece;

typedef struct io_xml {
    io_reader *r;
    const char *kind, *reads; /* of io_xml_parse */
    struct XML_ParserStruct *parser;
    bool big, wide, zlib;      /* big-endian; headers of 64 bits; compressed */
    bool failed, base64;       /* base64: the appended data is */
    size_t depth, array_depth; /* array_depth: of the open DataArray, 0 = none */
    size_t data_set;           /* depth of the data set, 0 = none */
    io_xml_section section;
    io_xml_array *arrays;
    size_t array_count, array_capacity;
    io_xml_piece *pieces;
    size_t piece_count, piece_capacity;
    io_image image;
    const char *vectors; /* name of the point array that the file calls its vectors, or NULL */
    io_cursor appended;  /* bytes behind the _ */
    size_t stopped;      /* byte where AppendedData begins */
} io_xml;

/* Does it begin like a VTKFile of that kind? IO_MAYBE: like XML. */
io_match io_sniff_xml(const io_cursor *bytes, const char *kind);
/* Reads all tags. reads: what the caller reads from which kind, for messages: "lines are read from
 * PolyData (.vtp)". */
bool io_xml_parse(io_reader *reader, const io_cursor *bytes, const char *kind, const char *reads,
                  io_xml *out);
/* The first array of a piece in a section, of that name (NULL = any); NULL when there is none. */
const io_xml_array *io_xml_find(const io_xml *xml, const io_xml_piece *piece,
                                io_xml_section section, const char *name);
/* The first rows of an array, decoded. */
bool io_xml_take(io_xml *xml, const io_xml_array *array, size_t rows, io_view *out);

/* ---- Legacy ---------------------------------------------------------------------------------- */

typedef enum io_legacy_scope { IO_OF_NOTHING, IO_OF_POINTS, IO_OF_CELLS } io_legacy_scope;

typedef struct io_legacy {
    io_reader *r;
    io_cursor c;
    bool binary;
    io_view points;
    io_cells vertices, lines, polygons, strips;
    io_image image;
    io_legacy_scope scope; /* of the arrays that follow */
    size_t scope_rows;
    io_array *arrays;
    size_t array_count, array_capacity;
} io_legacy;

/* Is it a legacy file whose DATASET is of that kind (NULL = any)? */
io_match io_sniff_legacy(const io_cursor *bytes, const char *kind);
/* Reads the whole file. reads: "lines are read from". */
bool io_legacy_parse(io_reader *reader, const io_cursor *bytes, const char *kind, const char *reads,
                     io_legacy *out);

#endif
