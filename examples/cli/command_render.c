/* lineao render: pictures, dumps, timings. */
#include "commands.h"
#include "context.h"
#include "dump.h"
#include "image.h"
#include "legend.h"
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

static const char *unit_of(const char *attribute) {
    static const char *const units[][2] = {{"time", "ms"}, {"speed", "m/s"}, {"velocity", "m/s"}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (strcmp(units[i][0], attribute) == 0)
            return units[i][1];
    }
    return NULL;
}

/* One legend for every scale that the sets are coloured by. */
static bool draw_legends(const cli_options *options, const cli_scene *scene, picture *p) {
    enum { MOST = 4, TITLE = 128 };
    static const char *const sides[] = {"left", "right", "bottom"};
    colour_map *maps = cli_new(MOST, sizeof *maps);
    char titles[MOST][TITLE];
    legend legends[MOST];
    uint32_t count = 0, side = 0;
    while (side < 2 && strcmp(sides[side], options->legend) != 0) /* one of the flag's choices */
        side++;
    for (uint32_t s = 0; maps && s < scene->count && count < MOST; s++) {
        const cli_set *set = &scene->sets[s];
        bool known = !set->value;
        for (uint32_t before = 0; before < s && !known; before++)
            known = cli_same_scale(&scene->sets[before], set);
        if (known)
            continue;
        const char *unit = unit_of(set->value);
        snprintf(titles[count], TITLE, "%s%s%s%s", set->value, unit ? " (" : "", unit ? unit : "",
                 unit ? ")" : "");
        colour_map_make(set->source->colormap, &maps[count]);
        legends[count].map = &maps[count];
        memcpy(legends[count].range, set->range, sizeof set->range);
        legends[count].title =
            options->legend_title && count == 0 ? options->legend_title : titles[count];
        count++;
    }
    bool ok =
        maps && (legend_draw(p, (legend_side)side, legends, count) || cli_fail("out of memory"));
    free(maps);
    return ok;
}

/* What is drawn around the lines of a frame. */
typedef struct surroundings {
    const cli_options *options;
    const cli_scene *scene;
    cli_context context;
    float paper[4];   /* the background that was asked for */
    cli_video *video; /* NULL: a file for each picture */
} surroundings;

static bool surround(const surroundings *around, picture *p) {
    return (!around->context.coverage || cli_context_compose(&around->context, around->paper, p)) &&
           (strcmp(around->options->legend, "off") == 0 ||
            draw_legends(around->options, around->scene, p));
}

static bool write_picture(const char *path, const surroundings *around, cli_session *session,
                          const cli_shot *shot) {
    char error[IMAGE_ERROR_SIZE];
    picture p = {shot->width, shot->height, cli_session_picture(session)};
    bool ok = p.pixels && surround(around, &p);
    int channels = around->paper[3] < 1 ? 4 : 3;
    for (size_t i = 0; ok && channels == 3 && i < (size_t)p.width * p.height; i++)
        memmove(p.pixels + 3 * i, p.pixels + 4 * i, 3);
    if (ok && around->video)
        ok = cli_video_add(around->video, p.pixels);
    else if (ok)
        ok = image_write_png(path, p.width, p.height, p.pixels, channels, error) ||
             cli_fail("%s", error);
    picture_free(&p);
    return ok;
}

/* Writes what one frame gave; frame -1: no sequence. */
static bool write_frame(const surroundings *around, cli_session *session, const cli_shot *shot,
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
                     : write_picture(path, around, session, shot));
        free(numbered);
    }
    return ok;
}

/* ---- all frames ------------------------------------------------------------------------- */

/* Frame i of a sequence shows the first time plus i parts of the period. With timings a first frame
 * goes uncounted: it builds shaders and images. */
static bool render_frames(const surroundings *around, cli_session *session, cli_shot *shot) {
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
    if (options->backdrop) /* the lines alone; paper comes with what is behind them */
        memset(shot.background, 0, sizeof shot.background);
    memset(&session, 0, sizeof session);
    bool ok = cli_context_make(scene, &shot, &around.context) &&
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
