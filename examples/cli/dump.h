/* Numbers of a frame as files: OpenEXR of every image, JSON of what was drawn and of timings. */
#ifndef LINEAO_CLI_DUMP_H
#define LINEAO_CLI_DUMP_H

#include "session.h"

#include <cJSON.h>

/* What a command adds to a dump, of the first part: planes of width * height values. */
typedef struct cli_planes cli_planes;
/* From now on channels are those of this part; NULL: of the first. */
void cli_planes_use(cli_planes *planes, const char *part);
/* The values of a channel, or NULL; *count gets how many there are. */
float *cli_planes_find(cli_planes *planes, const char *name, size_t *count);
/* A new channel, not yet filled. NULL: reported. */
float *cli_planes_add(cli_planes *planes, const char *name);
typedef bool (*cli_planes_edit)(void *user, cli_planes *planes);

/* Writes every image of the frame graph that has channel names, as 32-bit floats, top row first.
 * The images of full size are the first part; others are parts named after the image ("axial1").
 * The string attribute "lineao" describes the frame. The session's view must have been made with
 * LAO_VIEW_KEEP_IMAGES. Of a tree or a wall alone (lineao vessel, surface), its images and the
 * picture; of a scene with objects those of the lines, and in parts named after their modules
 * ("vessel", "surface") those of the objects, of several the last one's. edit: (Optional) called
 * with what will be written. False: reported. */
bool cli_dump(const char *path, cli_session *session, const cli_scene *scene, const cli_shot *shot,
              cli_planes_edit edit, void *user);

/* Milliseconds of the last frame, which was rendered with LAO_FRAME_TIMINGS. NULL: reported. */
cJSON *cli_timings(cli_session *session, const cli_shot *shot);

/* Writes JSON to a file, or to standard output when path is NULL; deletes it. False: reported. */
bool cli_write_json(const char *path, cJSON *json);

/* A number with as few digits as read back to the same float. */
cJSON *cli_json_float(float value);

/* "0.1.0" */
void cli_version(char text[32]);

#endif
