/* The picture of a session as a file. */
#include "commands.h"
#include "image.h"
#include "report.h"

#include <stdlib.h>
#include <string.h>

bool cli_write_picture(const char *path, cli_video *video, cli_session *session,
                       const cli_shot *shot) {
    char error[IMAGE_ERROR_SIZE];
    uint8_t *pixels = cli_session_picture(session);
    if (!pixels)
        return false;
    int channels = shot->background[3] < 1 ? 4 : 3;
    for (size_t i = 0; channels == 3 && i < (size_t)shot->width * shot->height; i++)
        memmove(pixels + 3 * i, pixels + 4 * i, 3);
    bool ok = video ? cli_video_add(video, pixels)
                    : image_write_png(path, shot->width, shot->height, pixels, channels, error) ||
                          cli_fail("%s", error);
    free(pixels);
    return ok;
}
