/* lineao render: pictures, dumps, timings. */
#include "commands.h"
#include "context.h"
#include "dump.h"
#include "legends.h"
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

/* What is drawn around the lines of a frame. */
typedef struct surroundings {
    const cli_options *options;
    const cli_scene *scene;
    cli_context context;
    float paper[4];   /* the background that was asked for */
    cli_video *video; /* NULL: a file for each picture */
} surroundings;

static bool surround(void *user, picture *p) {
    const surroundings *around = user;
    return (!around->context.coverage || cli_context_compose(&around->context, around->paper, p)) &&
           cli_legends_draw(around->options, around->scene, NULL, 0, p);
}

/* Writes what one frame gave; frame -1: no sequence. */
static bool write_frame(surroundings *around, cli_session *session, const cli_shot *shot,
                        int64_t frame) {
    const char *paths[2] = {around->options->dump, around->options->out};
    bool ok = true;
    for (int i = 0; i < 2 && ok; i++) {
        if (!paths[i])
            continue;
        char *numbered = frame < 0 ? NULL : cli_frame_path(paths[i], (uint32_t)frame);
        const char *path = numbered ? numbered : paths[i];
        ok = (frame < 0 || numbered) && cli_go_on() &&
             (i == 0 ? cli_dump(path, session, around->scene, shot, NULL, NULL)
                     : cli_write_picture(path, around->video, session, around->paper[3] >= 1,
                                         surround, around));
        free(numbered);
    }
    return ok;
}

/* ---- all frames ------------------------------------------------------------------------- */

/* Frame i of a sequence shows the first time plus i parts of the period. With timings a first frame
 * goes uncounted: it builds shaders and images. */
static bool render_frames(surroundings *around, cli_session *session, cli_shot *shot) {
    const cli_options *options = around->options;
    const cli_scene *scene = around->scene;
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
             write_frame(around, session, shot, options->frames ? (int64_t)i : -1);
    }
    cli_progress_end(&progress);
    return ok;
}

/* A video appears when all of its frames are in it, else not at all. */
static bool render_all(surroundings *around, cli_session *session, cli_shot *shot) {
    const cli_options *options = around->options;
    cli_video video;
    if (!cli_is_video(options->out))
        return render_frames(around, session, shot);
    if (!cli_video_open(&video, options->out, shot->width, shot->height,
                        options->fps ? options->fps : 25))
        return false;
    around->video = &video;
    bool ok = cli_video_close(&video, render_frames(around, session, shot));
    around->video = NULL;
    return ok;
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
    surroundings around;
    around.options = options;
    around.scene = scene;
    around.video = NULL;
    memcpy(around.paper, shot.background, sizeof around.paper);
    if (options->backdrop && scene->volume_count == 0)
        return cli_fail("--backdrop: shows what is behind the lines of a velocity volume or of "
                        "--scene flow; there is neither");
    if (options->backdrop ||
        options->outline) /* the lines alone; paper comes with what is behind them */
        memset(shot.background, 0, sizeof shot.background);
    memset(&session, 0, sizeof session);
    const uint32_t size[2] = {shot.width, shot.height};
    char note[CLI_NOTE];
    bool ok = cli_legends_check(options, scene, NULL, 0, size, note);
    if (ok)
        cli_legends_warn(options, options->out, note);
    ok = ok && cli_context_make(scene, &shot, &around.context) &&
         cli_session_open(&session, options->backend, scene, &shot,
                          options->dump ? LAO_VIEW_KEEP_IMAGES : 0) &&
         render_all(&around, &session, &shot) && write_json(options, &session, &shot);
    cli_session_close(&session);
    cli_context_free(&around.context);
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
