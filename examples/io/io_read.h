/* Everything that one file holds, read in one go: for tools that take a file as it comes. */
#ifndef LINEAO_IO_READ_H
#define LINEAO_IO_READ_H

#include "io_mesh.h"
#include "io_tree.h"

/* Kinds of content, as bits. */
enum { IO_LINES = 1, IO_TREE = 2, IO_MESH = 4, IO_ANYTHING = 7 };

/* A VTP file of centrelines with a radius holds lines and a tree; one with lines and polygons lines
 * and a mesh. All zero = nothing. */
typedef struct io_contents {
    unsigned kinds; /* what was found */
    io_lines lines;
    io_tree tree;
    io_mesh mesh;
} io_contents;

/* Reads of the wanted kinds those that the file holds; fails when it holds none of them. options,
 * out and error as in io_read_lines. */
bool io_read(const char *path, unsigned wanted, const io_options *options, io_contents *out,
             io_error *error);
bool io_read_memory(const void *bytes, size_t size, const char *name_hint, unsigned wanted,
                    const io_options *options, io_contents *out, io_error *error);

void io_contents_free(io_contents *contents);

#endif
