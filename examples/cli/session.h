/* One scene on one backend without a window: device, lineao context, line sets, view. */
#ifndef LINEAO_CLI_SESSION_H
#define LINEAO_CLI_SESSION_H

#include "camera.h"
#include "load.h"
#include "picture.h"

/* What one frame is taken with. Matrices and sphere are relative to the scene's origin. */
typedef struct cli_shot {
    camera_pose camera; /* mm, absolute */
    float view[16], projection[16], sphere[4], background[4], time;
    uint32_t width, height;
    uint32_t margin; /* pixels around these that are drawn, and in dumps, but not in pictures */
    uint32_t frame_flags; /* LAO_FRAME_... of every frame */
} cli_shot;

/* The camera of the options, or one that fits the scene. False: reported. */
bool cli_shot_make(const cli_options *options, const cli_scene *scene, cli_shot *out);

/* Matrices of shot->camera, when the caller has changed it. */
void cli_shot_aim(const cli_scene *scene, cli_shot *shot);

/* The camera turned around its up vector through the point that it looks at, by a part of a turn:
 * frames of a video of a tree. */
void cli_turn(const camera_pose *from, double part, camera_pose *out);

typedef struct cli_session {
    const char *backend; /* "gl" or "vk" */
    struct host_gl *gl;
    struct host_vk *vk;
    lao_context *context;
    lao_view view;
    lao_set *sets; /* owned */
    uint32_t set_count;
    uint32_t margin;
    double milliseconds; /* of the last frame */
    bool quiet;          /* a failure is expected: do not report it */
} cli_session;

/* Opens the backend and uploads the scene, which must outlive the session. view_flags: LAO_VIEW_...
 * The session must not move. False: reported; close it in any case. */
bool cli_session_open(cli_session *session, const char *backend, const cli_scene *scene,
                      const cli_shot *shot, uint32_t view_flags);
void cli_session_close(cli_session *session);

/* The second half of cli_session_open, for a program that has made the backend itself: `session` is
 * all zero but for `backend` and, where cli_session_render is wanted, `vk`. */
bool cli_session_start(cli_session *session, const lao_backend *functions, const cli_scene *scene,
                       const cli_shot *shot, uint32_t view_flags);
/* Uploads the lines of one set of the scene again. False: reported. */
bool cli_session_renew(cli_session *session, const cli_scene *scene, uint32_t set);
/* What cli_session_render hands to lao_render; borrows the session's sets. */
void cli_session_frame(const cli_session *session, const cli_shot *shot, uint32_t frame_flags,
                       lao_frame *out);

/* Draws one frame and waits for it. frame_flags: LAO_FRAME_... besides those of the shot. False:
 * reported. */
bool cli_session_render(cli_session *session, const cli_shot *shot, uint32_t frame_flags);

/* The name of the device that draws. */
const char *cli_session_device(const cli_session *session);

/* The last frame, for picture_free. False: reported, nothing to free. */
bool cli_session_picture(cli_session *session, picture *out);

/* An image of the graph, if this plan has it. Values as lao_read gives them but with the top row
 * first, or raw texels as stored; for free(). NULL and width 0: there is no such image; NULL
 * otherwise: reported. `channels` of raw images: bytes per texel. */
float *cli_session_image(cli_session *session, const char *name, uint32_t level,
                         lao_read_info *info);
uint8_t *cli_session_texels(cli_session *session, const char *name, uint32_t level,
                            lao_read_info *info);

#endif
