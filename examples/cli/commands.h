/* The commands of the program, one file each. Each takes its options and returns an exit code. */
#ifndef LINEAO_CLI_COMMANDS_H
#define LINEAO_CLI_COMMANDS_H

#include "arguments.h"

int cli_info(const cli_options *options);
int cli_render(const cli_options *options);
int cli_compare(const cli_options *options);
int cli_sheet_command(const cli_options *options);
int cli_flow(const cli_options *options);
int cli_vessel(const cli_options *options);

/* The file of one frame of a sequence: its number in place of %04d, or "_0007" before the
 * extension. For free(). NULL: reported. */
char *cli_frame_path(const char *path, uint32_t frame);

#endif
