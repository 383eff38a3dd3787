/* Videos: frame after frame between two frames of the window, as `lineao ... --frames N -o FILE`
 * makes them, through ffmpeg. */
#include "view.h"

#include "commands.h"
#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool film_possible(const view *v) {
    return v->open && (v->doc->command == CLI_VESSEL || player_timed(v));
}

/* The first frame. */
static cli_shot first_shot(const view *v) {
    cli_shot shot = v->shot;
    double first, length;
    player_range(v, &first, &length);
    shot.width = (uint32_t)v->shot_size[0];
    shot.height = (uint32_t)v->shot_size[1];
    if (player_timed(v))
        shot.time = (float)first;
    return shot;
}

char *film_command(const view *v) {
    cli_shot shot = first_shot(v);
    char *text = document_command(v->doc, &shot, v->film.path);
    size_t room = text ? strlen(text) + 64 : 0;
    char *longer = text ? realloc(text, room) : NULL;
    if (!longer) {
        free(text);
        return NULL;
    }
    size_t used = strlen(longer);
    snprintf(longer + used, room - used, " --frames %d --fps %d", v->film.count, v->film.fps);
    return longer;
}

static bool can_start(const view *v) {
    const film *f = &v->film;
    if (!stage_settled(v, f->path))
        return false;
    if (!cli_is_video(f->path))
        return cli_fail("%s: is no video; its name must end in .mp4, .webm or .gif", f->path);
    if (v->shot.background[3] < 1)
        return cli_fail("%s: a video cannot be transparent; open it with an opaque --background",
                        f->path);
    return cli_writable(f->path);
}

bool film_start(view *v) {
    film *f = &v->film;
    lao_view_desc size = {(uint32_t)v->shot_size[0], (uint32_t)v->shot_size[1], 0};
    if (f->running || !can_start(v))
        return false;
    v->player.playing = false;
    if (v->doc->command == CLI_RENDER)
        document_show_time(v->doc, true);
    f->shot = first_shot(v);
    f->camera = f->shot.camera;
    f->start = (double)f->shot.time;
    f->done = 0;
    f->session = v->session;
    memset(&f->session.view, 0, sizeof f->session.view);
    v->window.backend->wait(&v->window);
    cli_shot_aim(v->doc->scene, &f->shot);
    if (!stage_aim(v, &f->shot) ||
        lao_view_create(f->session.context, &size, &f->session.view) != LAO_OK)
        return false;
    f->running = cli_video_open(&f->video, f->path, size.width, size.height, (uint32_t)f->fps);
    if (!f->running)
        lao_view_destroy(f->session.context, f->session.view);
    trace(v, "video %s", f->running ? "begins" : "failed");
    return f->running;
}

/* Closes the file; without `ok` there will be none. */
static void finish(view *v, bool ok) {
    film *f = &v->film;
    f->running = false;
    ok = cli_video_close(&f->video, ok) && ok;
    v->window.backend->wait(&v->window);
    lao_view_destroy(f->session.context, f->session.view);
    stage_time(v); /* that of the window */
    trace(v, "video %s %s", ok ? "saved" : "unsaved", f->path);
}

void film_cancel(view *v) {
    if (v->film.running)
        finish(v, false);
}

static bool draw_frame(view *v) {
    film *f = &v->film;
    lao_object_desc update;
    double part = (double)f->done / f->count;
    v->window.backend->wait(&v->window);
    if (v->doc->command == CLI_VESSEL && f->done)
        cli_turn(&f->camera, part, &f->shot.camera);
    if (player_timed(v))
        f->shot.time = (float)(f->start + v->doc->scene->period * f->done / f->count);
    cli_shot_aim(v->doc->scene, &f->shot);
    if (v->doc->command == CLI_SURFACE &&
        cli_wall_time(&v->doc->wall, (double)f->shot.time, &update) &&
        lao_object_update(f->session.context, f->session.sets[0].object, &update) != LAO_OK)
        return false;
    return cli_session_render(&f->session, &f->shot, 0) &&
           cli_write_picture(f->path, &f->video, &f->session, true, document_surround, v->doc);
}

void film_go_on(view *v) {
    film *f = &v->film;
    if (!f->running)
        return;
    bool ok = draw_frame(v);
    f->done += ok;
    if (!ok || f->done >= f->count)
        finish(v, ok);
}

void film_panel(view *v) {
    film *f = &v->film;
    bool open = true;
    char text[64];
    if (!f->running)
        return;
    if (ui_dialog("Video", v->picture, true, &open)) {
        snprintf(text, sizeof text, "%d of %d frames", f->done, f->count);
        ui_text(f->path);
        ui_progress((float)f->done / (float)f->count, text);
        open = !ui_button("Cancel##video") && open;
    }
    ui_panel_end();
    if (!open)
        film_cancel(v);
}

void film_widgets(view *v) {
    film *f = &v->film;
    bool tree = v->doc->command == CLI_VESSEL;
    ui_text_dim(tree               ? "Video: one turn around the tree, of the size above"
                : film_possible(v) ? "Video: one run of the time, of the size above"
                                   : "Video: nothing here moves with time");
    if (!film_possible(v))
        return;
    ui_width(-1);
    ui_input("##video file", f->path, sizeof f->path, "video.mp4, .webm or .gif");
    ui_width(-1);
    ui_slider_int("##video frames", &f->count, 2, 1000, "%d frames");
    ui_width(-1);
    ui_slider_int("##video rate", &f->fps, 1, 60, "%d frames per second");
    if (ui_button("Save video"))
        film_start(v);
    ui_help("needs ffmpeg; the file appears when all frames are in it");
    ui_same_line();
    if (ui_button("Copy its command line")) {
        char *command = film_command(v);
        if (command) {
            ui_copy(command);
            trace(v, "command %s", command);
        }
        free(command);
    }
}
