/* Videos: frames go through a pipe into ffmpeg, a program of its own that is found in PATH. */
#ifndef LINEAO_CLI_VIDEO_H
#define LINEAO_CLI_VIDEO_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

typedef struct cli_video {
    const char *path;
    char *temp;    /* what ffmpeg writes; renamed at the end */
    FILE *said;    /* what ffmpeg says, without a name */
    int pipe;      /* its standard input */
    pid_t process; /* ffmpeg */
    size_t frame_size;
    bool broken; /* ffmpeg did not take a frame */
} cli_video;

/* Does the name end like that of a video: .mp4, .webm, .gif? NULL does not. */
bool cli_is_video(const char *path);

/* Starts ffmpeg for frames of width x height RGB pixels, fps a second. False: reported, nothing is
 * left. */
bool cli_video_open(cli_video *video, const char *path, uint32_t width, uint32_t height,
                    uint32_t fps);

/* One more frame, top row first. False: ffmpeg has ended; cli_video_close, with or without `ok`,
 * reports why. */
bool cli_video_add(cli_video *video, const uint8_t *pixels);

/* Ends ffmpeg; the file appears if `ok` and it is content. False: there is no file, and the reason
 * has been reported. */
bool cli_video_close(cli_video *video, bool ok);

#endif
