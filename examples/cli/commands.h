/* The commands of the program, one file each. Each takes its options and returns an exit code. */
#ifndef LINEAO_CLI_COMMANDS_H
#define LINEAO_CLI_COMMANDS_H

#include "picture.h"
#include "session.h"
#include "video.h"

int cli_info(const cli_options *options);
int cli_render(const cli_options *options);
int cli_compare(const cli_options *options);
int cli_sheet_command(const cli_options *options);
int cli_flow(const cli_options *options);
int cli_vessel(const cli_options *options);
int cli_surface(const cli_options *options);

/* The file of one frame of a sequence: its number in place of %04d, or "_0007" before the
 * extension. For free(). NULL: reported. */
char *cli_frame_path(const char *path, uint32_t frame);

/* Pixels as a file of their own, or into a video; opaque: without their alpha, in place. False:
 * reported. */
bool cli_write_pixels(const char *path, cli_video *video, picture *p, bool opaque);

/* Draws something over a picture. False: reported. */
typedef bool (*cli_picture_edit)(void *user, picture *p);
/* The session's last frame into a file of its own, or into `video` unless that is NULL. opaque:
 * without its alpha. edit: (Optional) called with the picture before. False: reported. */
bool cli_write_picture(const char *path, cli_video *video, cli_session *session, bool opaque,
                       cli_picture_edit edit, void *user);

/* What --save-camera asks for. False: reported. */
bool cli_write_camera(const cli_options *options, const camera_pose *camera);

#endif
