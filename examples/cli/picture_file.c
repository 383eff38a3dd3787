/* The picture of a session as a file. */
#include "commands.h"
#include "image.h"
#include "report.h"

#include <string.h>

/* Pixels as a file of its own, or into a video; alpha is dropped where the paper is opaque. */
bool cli_write_pixels(const char *path, cli_video *video, picture *p, bool opaque) {
    char error[IMAGE_ERROR_SIZE];
    for (size_t i = 0; opaque && i < (size_t)p->width * p->height; i++)
        memmove(p->pixels + 3 * i, p->pixels + 4 * i, 3);
    return video ? cli_video_add(video, p->pixels)
                 : image_write_png(path, p->width, p->height, p->pixels, opaque ? 3 : 4, error) ||
                       cli_fail("%s", error);
}

bool cli_write_picture(const char *path, cli_video *video, cli_session *session, bool opaque,
                       cli_picture_edit edit, void *user) {
    picture p = {0, 0, NULL};
    bool ok = cli_session_picture(session, &p) && (!edit || edit(user, &p)) &&
              cli_write_pixels(path, video, &p, opaque);
    picture_free(&p);
    return ok;
}
