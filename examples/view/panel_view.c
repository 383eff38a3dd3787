/* The tabs View and Save: cameras, bookmarks, pictures, videos. */
#include "view.h"

#include "orbit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A bookmark is kept by the first click, and returned to by the others. */
static void bookmark(view *v, int i) {
    char label[64];
    snprintf(label, sizeof label, "%d%s##bookmark %d", i + 1, v->bookmarked[i] ? "" : "+", i + 1);
    if (ui_small_button(label)) {
        if (v->bookmarked[i])
            v->shot.camera = v->bookmarks[i];
        else
            v->bookmarks[i] = v->shot.camera;
        v->bookmarked[i] = true;
        v->dirty = true;
    }
    ui_help(v->bookmarked[i] ? "go there" : "keep this view");
}

static void write_views(view *v, const camera_pose *poses, uint32_t count) {
    char error[CAMERA_ERROR_SIZE];
    if (camera_write_all(v->bookmark_path, poses, count, error))
        trace(v, "saved %s", v->bookmark_path);
    else
        messages_add(v->messages, true, error);
}

static void read_views(view *v) {
    char error[CAMERA_ERROR_SIZE];
    camera_pose *poses;
    uint32_t count;
    if (!camera_read_all(v->bookmark_path, &poses, &count, error)) {
        messages_add(v->messages, true, error);
        return;
    }
    for (uint32_t i = 0; i < count && i < BOOKMARKS; i++) {
        v->bookmarks[i] = poses[i];
        v->bookmarked[i] = true;
    }
    v->shot.camera = poses[0];
    v->dirty = true;
    free(poses);
}

static void bookmarks(view *v) {
    camera_pose kept[BOOKMARKS];
    uint32_t count = 0;
    ui_text_dim("Bookmarks");
    for (int i = 0; i < BOOKMARKS; i++) {
        if (i)
            ui_same_line();
        bookmark(v, i);
        if (v->bookmarked[i])
            kept[count++] = v->bookmarks[i];
    }
    ui_width(-1);
    ui_input("##bookmark file", v->bookmark_path, sizeof v->bookmark_path, "camera.json");
    if (ui_button("Save view"))
        write_views(v, &v->shot.camera, 1);
    ui_help("this view as a file for --camera");
    ui_same_line();
    if (ui_button("Load views"))
        read_views(v);
    ui_help("one camera or an array of them, as bookmarks from 1 on");
    if (!count)
        return;
    if (ui_button("Save bookmarks"))
        write_views(v, kept, count);
    ui_help("as a file for --cameras");
    ui_same_line();
    if (ui_button("Forget bookmarks"))
        memset(v->bookmarked, 0, sizeof v->bookmarked);
}

void panel_view(view *v) {
    static const char *const names[] = {"axial", "coronal", "sagittal", "iso"};
    bool orthographic = !(v->shot.camera.fovy > 0);
    ui_text_dim("Look from");
    for (int i = 0; i < 4; i++) {
        float direction[3], up[3];
        if (i)
            ui_same_line();
        if (ui_button(names[i]) && camera_view(names[i], direction, up)) {
            orbit_look(&v->shot.camera, direction, up);
            v->dirty = true;
        }
    }
    if (ui_button("Fit"))
        stage_fit(v);
    ui_same_line();
    if (ui_button("First view")) {
        v->shot.camera = v->fitted.camera;
        v->dirty = true;
    }
    if (ui_toggle("Orthographic", &orthographic)) {
        orbit_project(&v->shot.camera, orthographic);
        v->dirty = true;
    }
    ui_toggle("Turntable", &v->turntable);
    ui_help("what is up stays up; off: turn freely");
    v->dirty = ui_toggle("Ground", &v->ground) || v->dirty;
    ui_same_line();
    v->dirty = ui_toggle("Axes", &v->axes) || v->dirty;
    ui_help("x red, y green, z blue: half the size of the scene");
    ui_space();
    bookmarks(v);
    ui_space();
    ui_text_dim("While the view moves");
    ui_toggle("Keep it steady", &v->steady.on);
    ui_help("fewer pixels and samples while the view moves; all of them when it rests");
    if (v->steady.on) {
        ui_width(-1);
        ui_slider("##frame time", &v->steady.wanted, 10, 500, "%.0f ms per frame");
    }
}

/* ---- picture ----------------------------------------------------------------------------- */

void panel_save(view *v) {
    cli_shot shot = v->shot;
    float width;
    ui_text_dim("The picture alone, without ground and axes");
    ui_width(-1);
    ui_input("##picture file", v->shot_path, sizeof v->shot_path, "picture.png");
    ui_width_left(&width);
    ui_width(0.36f * width);
    ui_slider_int("##wide", &v->shot_size[0], 16, 8192, "%d");
    ui_help("pixels; Ctrl and a click: type the number");
    ui_same_line();
    ui_label("x");
    ui_same_line();
    ui_width(0.36f * width);
    ui_slider_int("##high", &v->shot_size[1], 16, 8192, "%d");
    ui_help("pixels; Ctrl and a click: type the number");
    if (ui_button("As in the window")) {
        v->shot_size[0] = v->picture.width;
        v->shot_size[1] = v->picture.height;
    }
    ui_same_line();
    if (ui_button("Save picture"))
        stage_save(v, v->shot_path, (uint32_t)v->shot_size[0], (uint32_t)v->shot_size[1]);
    ui_help("the same bits as the command line below writes");
    ui_space();
    shot.width = (uint32_t)v->shot_size[0];
    shot.height = (uint32_t)v->shot_size[1];
    char *command = document_command(v->doc, &shot, v->shot_path);
    ui_text_dim("The same without a window");
    ui_text_wrapped(command ? command : "");
    if (ui_button("Copy command line") && command) {
        ui_copy(command);
        trace(v, "command %s", command);
    }
    free(command);
    ui_space();
    film_widgets(v);
}
