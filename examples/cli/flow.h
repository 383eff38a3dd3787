/* Velocity volumes for the commands: reading with a progress bar, tracing on all threads. */
#ifndef LINEAO_CLI_FLOW_H
#define LINEAO_CLI_FLOW_H

#include "arguments.h"
#include "io_volume.h"

/* How many of the sources from `first` on are volumes, which then are one: 0 for other files. */
uint32_t cli_count_volumes(const cli_source *sources, uint32_t count, uint32_t first);

/* Reads sources as one volume, as the flags of `options` say. guess: what the file does not tell
 * (spacing, time step) is guessed with a warning. False: reported. */
bool cli_read_volume(const cli_options *options, const cli_source *sources, uint32_t count,
                     bool guess, io_volume *out);

/* Traces lines with the point attributes "time" (ms), "speed" (m/s) and those asked for; the
 * volume's warnings move to them. source: thins the lines by its `every` and `min_length`; those of
 * a single point are left out. volume->mask becomes where it was traced. name: of the volume, for
 * messages. False: reported. */
bool cli_trace(const cli_options *options, const cli_source *source, const char *name,
               io_volume *volume, io_lines *out);

/* The volume's arrays as a field of flow4d.h, borrowed. */
struct flow4d_field cli_field_of(const io_volume *volume);

#endif
