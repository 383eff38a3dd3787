/* lineao render: pictures, dumps, timings. */
#include "commands.h"
#include "dump.h"
#include "image.h"
#include "report.h"
#include "session.h"
#include "video.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- names of a sequence ---------------------------------------------------------------- */

/* Where "%d", "%4d" or "%04d" stands in a pattern, and how long it is; else NULL. */
static const char *find_pattern(const char *path, size_t *length, int *digits, bool *zeros) {
    for (const char *at = strchr(path, '%'); at; at = strchr(at + 1, '%')) {
        size_t count = strspn(at + 1, "0123456789");
        if (at[1 + count] != 'd' || count > 2)
            continue;
        *length = count + 2;
        *zeros = at[1] == '0';
        *digits = atoi(at + 1);
        return at;
    }
    return NULL;
}

/* The file of one frame: the pattern filled in, or "_0007" before the extension. For free(). */
char *cli_frame_path(const char *path, uint32_t frame) {
    size_t room = strlen(path) + 112, length = 0;
    int digits = 4;
    bool zeros = true;
    const char *at = find_pattern(path, &length, &digits, &zeros);
    const char *before = "";
    if (!at) {
        const char *name = strrchr(path, '/'), *dot = strrchr(name ? name : path, '.');
        at = dot && dot != (name ? name + 1 : path) ? dot : path + strlen(path);
        before = "_";
    }
    char *text = cli_new(room, 1);
    if (text) {
        snprintf(text, room, zeros ? "%.*s%s%0*u%s" : "%.*s%s%*u%s", (int)(at - path), path, before,
                 digits, frame, at + length);
    }
    return text;
}

/* ---- one frame -------------------------------------------------------------------------- */

/* Into a file of its own, or into `video` unless that is NULL. */
static bool write_picture(const char *path, cli_video *video, cli_session *session,
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

/* Writes what one frame gave; frame -1: no sequence. */
static bool write_frame(const cli_options *options, const cli_scene *scene, cli_session *session,
                        const cli_shot *shot, cli_video *video, int64_t frame) {
    const char *paths[2] = {options->dump, options->out};
    bool ok = true;
    for (int i = 0; i < 2 && ok; i++) {
        if (!paths[i])
            continue;
        char *numbered = frame < 0 ? NULL : cli_frame_path(paths[i], (uint32_t)frame);
        const char *path = numbered ? numbered : paths[i];
        ok = (frame < 0 || numbered) && cli_go_on() &&
             (i == 0 ? cli_dump(path, session, scene, shot, NULL, NULL)
                     : write_picture(path, video, session, shot));
        free(numbered);
    }
    return ok;
}

/* ---- all frames ------------------------------------------------------------------------- */

/* Frame i of a sequence shows the first time plus i parts of the period. With timings a first frame
 * goes uncounted: it builds shaders and images. */
static bool render_frames(const cli_options *options, const cli_scene *scene, cli_session *session,
                          cli_shot *shot, cli_video *video) {
    uint32_t count = options->frames ? options->frames : 1;
    uint32_t flags = options->timings ? LAO_FRAME_TIMINGS : 0;
    double start = (double)shot->time;
    cli_progress progress = {"rendering", options->out ? options->out : "", -1};
    bool ok = !flags || cli_session_render(session, shot, flags);
    for (uint32_t i = 0; ok && i < count; i++) {
        shot->time = (float)(start + scene->period * i / count);
        if (count > 1)
            cli_progress_show(&progress, i, count);
        ok = cli_session_render(session, shot, flags) &&
             write_frame(options, scene, session, shot, video, options->frames ? (int64_t)i : -1);
    }
    cli_progress_end(&progress);
    return ok;
}

/* A video appears when all of its frames are in it, else not at all. */
static bool render_all(const cli_options *options, const cli_scene *scene, cli_session *session,
                       cli_shot *shot) {
    cli_video video;
    if (!cli_is_video(options->out))
        return render_frames(options, scene, session, shot, NULL);
    return cli_video_open(&video, options->out, shot->width, shot->height,
                          options->fps ? options->fps : 25) &&
           cli_video_close(&video, render_frames(options, scene, session, shot, &video));
}

static bool write_json(const cli_options *options, cli_session *session, const cli_shot *shot) {
    if (options->timings) {
        cJSON *json = cli_timings(session, shot);
        if (!json || !cli_write_json(options->timings, json))
            return false;
    }
    if (!options->save_camera)
        return true;
    char *text = camera_print(&shot->camera);
    bool ok = text ? cli_write_text(options->save_camera, text) : cli_fail("out of memory");
    free(text);
    return ok;
}

static bool render(const cli_options *options, const cli_scene *scene) {
    cli_session session;
    cli_shot shot;
    if (!cli_shot_make(options, scene, &shot))
        return false;
    if (!options->out && !options->dump && !options->timings) /* only the camera: no device */
        return write_json(options, NULL, &shot);
    bool ok = cli_session_open(&session, options->backend, scene, &shot,
                               options->dump ? LAO_VIEW_KEEP_IMAGES : 0) &&
              render_all(options, scene, &session, &shot) && write_json(options, &session, &shot);
    cli_session_close(&session);
    return ok;
}

int cli_render(const cli_options *options) {
    const char *outputs[4] = {options->out, options->dump, options->timings, options->save_camera};
    cli_scene scene;
    for (int i = 0; i < 4; i++) {
        if (!cli_writable(outputs[i]))
            return CLI_FAILED;
    }
    if (!cli_scene_load(options, &scene))
        return CLI_FAILED;
    bool ok = render(options, &scene);
    if (ok)
        cli_scene_warn(&scene);
    cli_scene_free(&scene);
    return ok ? CLI_OK : CLI_FAILED;
}
