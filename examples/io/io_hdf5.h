/* libhdf5 keeps state, prints, and crashes on some damaged files. It therefore runs in a process of
 * its own, forked for one file, which talks through a socket. Private to examples/io. */
#ifndef LINEAO_IO_HDF5_H
#define LINEAO_IO_HDF5_H

#include "io_internal.h"

/* Has it the signature? */
bool io_is_hdf5(const io_cursor *bytes);
/* Does its begin name the data sets of a vessel tree? */
bool io_is_section_graph(const io_cursor *bytes);
/* As a volume: HDF5 that is no tree. */
io_match io_sniff_hdf5(const io_cursor *bytes);

#ifdef LINEAO_HAVE_HDF5
#define H5_USE_110_API
#include <hdf5.h>

typedef struct io_hdf5_child {
    int socket;
    long pid;
} io_hdf5_child;

/* Forks a process that opens the file in bytes and runs serve, with a negative file when HDF5
 * cannot open it; the process ends with serve. */
bool io_hdf5_start(io_reader *reader, const io_cursor *bytes, void (*serve)(int socket, hid_t file),
                   io_hdf5_child *out);
/* Ends the process, also one that still works. */
void io_hdf5_stop(io_hdf5_child *child);
/* Both sides: sends all of it; false when the other side is gone. */
bool io_hdf5_send(int socket, const void *data, size_t size);
/* In the parent: waits for exactly that much, letting the user cancel. */
bool io_hdf5_receive(io_reader *reader, const io_hdf5_child *child, void *data, size_t size);
#endif

#endif
