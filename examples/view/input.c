/* Pointer and keys on the picture. */
#include "view.h"

#include "orbit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pixels that a click may move. */
#define CLICK 4

/* Whose event it is: there will be a few frames, as the user interface wants to answer it. */
static view *of(GLFWwindow *glfw) {
    view *v = glfwGetWindowUserPointer(glfw);
    v->awake = 3;
    trace(v, "event");
    return v;
}

/* ---- keys -------------------------------------------------------------------------------- */

static void look(view *v, const char *name) {
    float direction[3], up[3];
    camera_view(name, direction, up);
    orbit_look(&v->shot.camera, direction, up);
    v->dirty = true;
}

static void axial(view *v) {
    look(v, "axial");
}
static void coronal(view *v) {
    look(v, "coronal");
}
static void sagittal(view *v) {
    look(v, "sagittal");
}
static void iso(view *v) {
    look(v, "iso");
}
static void home(view *v) {
    v->shot.camera = v->fitted.camera;
    v->dirty = true;
}
static void project(view *v) {
    orbit_project(&v->shot.camera, v->shot.camera.fovy > 0);
    v->dirty = true;
}
static void ground(view *v) {
    v->ground = !v->ground;
    v->dirty = true;
}
static void axes(view *v) {
    v->axes = !v->axes;
    v->dirty = true;
}
static void panels(view *v) {
    v->panels = !v->panels;
}
static void save(view *v) {
    stage_save(v, v->shot_path, (uint32_t)v->shot_size[0], (uint32_t)v->shot_size[1]);
}
/* The command line of what the window shows. */
static void copy(view *v) {
    cli_shot shot = v->shot;
    shot.width = (uint32_t)v->picture.width;
    shot.height = (uint32_t)v->picture.height;
    char *command = document_command(v->doc, &shot, v->shot_path);
    if (command) {
        ui_copy(command);
        trace(v, "command %s", command);
    }
    free(command);
}
static void forget(view *v) {
    char text[MESSAGE_SIZE];
    float part;
    if (v->film.running) {
        film_cancel(v);
        return;
    }
    if (loader_busy(v->loader, text, &part)) {
        loader_cancel(v->loader);
        return;
    }
    if (v->hands.pathing) {
        v->hands.pathing = false;
        return;
    }
    memset(&v->picked, 0, sizeof v->picked);
    if (v->open)
        stage_select(v);
}
static void back(view *v) {
    player_step(v, -1);
}
static void forth(view *v) {
    player_step(v, 1);
}
static void slower(view *v) {
    player_pace(v, 1 / 1.5);
}
static void faster(view *v) {
    player_pace(v, 1.5);
}
static void loop(view *v) {
    v->player.loop = !v->player.loop;
    trace(v, "loop %s", v->player.loop ? "on" : "off");
}
static void keys_list(view *v) {
    v->keys = !v->keys;
}
static void quit(view *v) {
    v->quit = true;
}

static const struct key_row {
    int key;
    const char *name, *help;
    void (*run)(view *v);
    bool open;    /* needs an open document */
    bool repeats; /* while it is held down */
} keys[] = {
    {GLFW_KEY_SPACE, "Space", "play, pause", player_toggle, true, false},
    {GLFW_KEY_LEFT, "Left", "a step back in time", back, true, true},
    {GLFW_KEY_RIGHT, "Right", "a step forward", forth, true, true},
    {GLFW_KEY_COMMA, ",", "slower", slower, true, true},
    {GLFW_KEY_PERIOD, ".", "faster", faster, true, true},
    {GLFW_KEY_L, "L", "play again and again, or once", loop, true, false},
    {GLFW_KEY_F, "F", "fit everything into the picture", stage_fit, true, false},
    {GLFW_KEY_HOME, "Home", "the first view", home, true, false},
    {GLFW_KEY_1, "1", "from above (axial)", axial, true, false},
    {GLFW_KEY_2, "2", "from the front (coronal)", coronal, true, false},
    {GLFW_KEY_3, "3", "from the left (sagittal)", sagittal, true, false},
    {GLFW_KEY_4, "4", "from a corner", iso, true, false},
    {GLFW_KEY_O, "O", "perspective or orthographic", project, true, false},
    {GLFW_KEY_G, "G", "ground", ground, true, false},
    {GLFW_KEY_X, "X", "axes", axes, true, false},
    {GLFW_KEY_H, "H", "hide or show the panels", panels, false, false},
    {GLFW_KEY_S, "S", "save the picture", save, true, false},
    {GLFW_KEY_C, "C", "copy the command line of this picture", copy, true, false},
    {GLFW_KEY_F1, "F1", "this list", keys_list, false, false},
    {GLFW_KEY_ESCAPE, "Esc", "cancel a video or what is being opened; select nothing", forget,
     false, false},
    {GLFW_KEY_Q, "Q", "quit", quit, false, false},
};

uint32_t input_keys(uint32_t i, const char **key, const char **help) {
    if (i < sizeof keys / sizeof *keys) {
        *key = keys[i].name;
        *help = keys[i].help;
    }
    return sizeof keys / sizeof *keys;
}

static void on_key(GLFWwindow *glfw, int key, int code, int action, int mods) {
    view *v = of(glfw);
    (void)code;
    if (action == GLFW_RELEASE || ui_has_keyboard() || (mods & ~GLFW_MOD_CONTROL))
        return;
    bool filming = v->film.running; /* then nothing changes but for its end */
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (keys[i].key == key && (v->open || !keys[i].open) &&
            (!filming || keys[i].run == forget) && (action == GLFW_PRESS || keys[i].repeats))
            keys[i].run(v);
    }
}

/* ---- pointer ----------------------------------------------------------------------------- */

/* Pixels of the framebuffer, whatever the window system counts in. */
static void to_pixels(const view *v, double *x, double *y) {
    int width, height;
    glfwGetWindowSize(v->window.glfw, &width, &height);
    *x *= width > 0 ? (double)v->window.width / width : 1;
    *y *= height > 0 ? (double)v->window.height / height : 1;
}

static bool is_inside(const view *v, double x, double y) {
    const window_rect *p = &v->picture;
    return x >= p->x && y >= p->y && x < p->x + p->width && y < p->y + p->height;
}

/* What lies there, and the ray to it. */
static void find(view *v, picked *out, double from[3], double to[3]) {
    const window_rect *p = &v->picture;
    double x = 2 * (v->pointer.x + 0.5 - p->x) / p->width - 1;
    double y = 1 - 2 * (v->pointer.y + 0.5 - p->y) / p->height;
    cli_shot shot = v->shot;
    shot.width = (uint32_t)p->width;
    shot.height = (uint32_t)p->height;
    cli_shot_aim(v->doc->scene, &shot);
    pick_at(&v->doc->pickable, &shot, x, y, 4.0 / p->height, out);
    orbit_ray(&shot.camera, (double)p->width / p->height, x, y, from, to);
}

static void click(view *v) {
    double from[3], to[3];
    find(v, &v->picked, from, to);
    stage_select(v);
    if (v->hands.pathing)
        hands_click(v, from, to);
    trace(v, "picked %d %u %u %u %.3f %.3f %.3f", (int)v->picked.kind, v->picked.set,
          v->picked.line, v->picked.point, v->picked.at[0], v->picked.at[1], v->picked.at[2]);
}

void input_hover(view *v) {
    picked found;
    double from[3], to[3];
    if (!v->pointer.fresh || v->pointer.button >= 0 || !v->open)
        return;
    v->pointer.fresh = false;
    memset(&found, 0, sizeof found);
    if (!ui_has_pointer() && is_inside(v, v->pointer.x, v->pointer.y))
        find(v, &found, from, to);
    if (!v->hovered_flat)
        marks_hover(v, &found);
}

static void on_button(GLFWwindow *glfw, int button, int action, int mods) {
    view *v = of(glfw);
    pointer *p = &v->pointer;
    if (action == GLFW_PRESS && p->button < 0 && v->open && !ui_has_pointer() &&
        is_inside(v, p->x, p->y)) {
        v->dividing = button == GLFW_MOUSE_BUTTON_LEFT && compare_grabs(v, p->x);
        v->lensing = button == GLFW_MOUSE_BUTTON_LEFT && hands_grabs(v, p->x, p->y);
        p->button = button;
        p->shift = (mods & GLFW_MOD_SHIFT) != 0;
        p->moved = false;
        p->pressed_at[0] = p->x;
        p->pressed_at[1] = p->y;
    } else if (action == GLFW_RELEASE && button == p->button) {
        if (!p->moved && button == GLFW_MOUSE_BUTTON_LEFT && v->open && !v->dividing)
            click(v);
        else if (v->lensing && v->open)
            hands_let_go(v);
        v->dividing = v->lensing = false;
        p->button = -1;
    }
}

static void drag(view *v, double x, double y) {
    double height = fmax(1, v->picture.height), axis[3];
    camera_pose *pose = &v->shot.camera;
    bool left = v->pointer.button == GLFW_MOUSE_BUTTON_LEFT;
    stage_up(v, axis);
    if (v->pointer.button == GLFW_MOUSE_BUTTON_RIGHT)
        orbit_dolly(pose, exp(-2 * y / height));
    else if (left && !v->pointer.shift)
        orbit_turn(pose, 4 * x / height, 4 * y / height, v->turntable, axis);
    else
        orbit_pan(pose, -x / height, y / height);
    v->steady.last = glfwGetTime();
    v->dirty = true;
}

static void on_move(GLFWwindow *glfw, double x, double y) {
    view *v = of(glfw);
    pointer *p = &v->pointer;
    double before[2] = {p->x, p->y};
    to_pixels(v, &x, &y);
    p->x = x;
    p->y = y;
    p->fresh = true;
    if (p->button < 0 || !v->open)
        return;
    if (!p->moved && hypot(x - p->pressed_at[0], y - p->pressed_at[1]) < CLICK * ui_scale())
        return;
    if (!p->moved) {
        before[0] = p->pressed_at[0];
        before[1] = p->pressed_at[1];
        if (v->lensing)
            hands_grab(v);
    }
    p->moved = true;
    if (v->dividing)
        compare_divide(v, x);
    else if (v->lensing)
        hands_drag(v, x - before[0], y - before[1]);
    else
        drag(v, x - before[0], y - before[1]);
}

static void on_scroll(GLFWwindow *glfw, double x, double y) {
    view *v = of(glfw);
    (void)x;
    if (!v->open || ui_has_pointer() || !is_inside(v, v->pointer.x, v->pointer.y))
        return;
    orbit_dolly(&v->shot.camera, pow(1.15, y));
    v->steady.last = glfwGetTime();
    v->dirty = true;
}

/* ---- files and window -------------------------------------------------------------------- */

static void on_drop(GLFWwindow *glfw, int count, const char **paths) {
    stage_add(of(glfw), paths, (uint32_t)count);
}

static void on_resize(GLFWwindow *glfw, int width, int height) {
    (void)width;
    (void)height;
    of(glfw)->dirty = true;
}

static void on_refresh(GLFWwindow *glfw) {
    (void)of(glfw);
}

void input_attach(view *v) {
    GLFWwindow *glfw = v->window.glfw;
    v->pointer.button = -1;
    glfwSetWindowUserPointer(glfw, v);
    glfwSetKeyCallback(glfw, on_key);
    glfwSetMouseButtonCallback(glfw, on_button);
    glfwSetCursorPosCallback(glfw, on_move);
    glfwSetScrollCallback(glfw, on_scroll);
    glfwSetDropCallback(glfw, on_drop);
    glfwSetFramebufferSizeCallback(glfw, on_resize);
    glfwSetWindowRefreshCallback(glfw, on_refresh);
}
