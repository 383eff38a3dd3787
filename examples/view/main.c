/* The viewer: lineao view [--backend gl|vk] [render|vessel|surface] [FILE...] [FLAG...].
 *
 * One loop: events, time, user interface, picture. The picture is drawn again only when something
 * that it shows has changed; without events the loop sleeps. */
#include "view.h"

#include "report.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: run view [FILE...] [FLAG...]\n"
    "       run view render|vessel|surface [ARGUMENTS of that command of lineao]\n\n"
    "Opens lines, velocity volumes, vessel trees and meshes, any of them at once, in a window;\n"
    "without a FILE an embedded scene. Files dropped on the window join what is open.\n\n"
    "Flags of its own\n"
    "  --backend gl|vk     OpenGL or Vulkan (gl)\n"
    "  --window WxH        size of the window (1280x800 times the scale)\n"
    "  --scale N           of the user interface (the monitor's)\n"
    "  --compare           OpenGL and Vulkan side by side\n"
    "  --no-vsync          do not wait for the monitor\n"
    "  --validate          with the Khronos layer (Vulkan)\n"
    "  --trace             say on standard output what happens, for tests\n"
    "All other flags are those of lineao render, vessel or surface: see lineao COMMAND --help.\n";

typedef struct arguments {
    const char *backend;
    int width, height; /* 0: as suits the scale */
    float scale;       /* 0: the monitor's */
    bool vsync, validate, trace, compare, help;
    const char **words; /* owned: the rest */
    uint32_t count;
} arguments;

void trace(const view *v, const char *format, ...) {
    va_list list;
    if (!v->trace)
        return;
    va_start(list, format);
    vprintf(format, list);
    va_end(list);
    putchar('\n');
    fflush(stdout);
}

/* ---- arguments --------------------------------------------------------------------------- */

static bool size_of(const char *text, int *width, int *height) {
    double w, h;
    char part[16];
    size_t length = strcspn(text, "x");
    if (text[length] != 'x' || length >= sizeof part)
        return false;
    memcpy(part, text, length);
    part[length] = '\0';
    if (!cli_number(part, &w) || !cli_number(text + length + 1, &h) || !(w >= 64 && w <= 16384) ||
        !(h >= 64 && h <= 16384))
        return false;
    *width = (int)w;
    *height = (int)h;
    return true;
}

/* Words taken, 0: not one of ours, -1: reported. */
static int take(arguments *a, const char *word, const char *value) {
    double number;
    if (strcmp(word, "--no-vsync") == 0)
        return a->vsync = false, 1;
    if (strcmp(word, "--validate") == 0)
        return a->validate = true, 1;
    if (strcmp(word, "--trace") == 0)
        return a->trace = true, 1;
    if (strcmp(word, "--compare") == 0)
        return a->compare = true, 1;
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)
        return a->help = true, 1;
    if (strcmp(word, "--backend") == 0 && value &&
        (strcmp(value, "gl") == 0 || strcmp(value, "vk") == 0))
        return a->backend = value, 2;
    if (strcmp(word, "--backend") == 0)
        return cli_fail("--backend: write gl or vk"), -1;
    if (strcmp(word, "--window") == 0)
        return value && size_of(value, &a->width, &a->height)
                   ? 2
                   : (cli_fail("--window: write WxH, 64 to 16384"), -1);
    if (strcmp(word, "--scale") == 0) {
        if (!value || !cli_number(value, &number) || !(number >= 0.5 && number <= 8))
            return cli_fail("--scale: write a number, 0.5 to 8"), -1;
        a->scale = (float)number;
        return 2;
    }
    return 0;
}

static bool parse(int argc, char **argv, arguments *out) {
    memset(out, 0, sizeof *out);
    out->backend = "gl";
    out->vsync = true;
    out->words = cli_new((size_t)argc + 3, sizeof *out->words);
    for (int i = 1; out->words && i < argc;) {
        int taken = take(out, argv[i], i + 1 < argc ? argv[i + 1] : NULL);
        if (taken < 0)
            return false;
        if (taken == 0)
            out->words[out->count++] = argv[i];
        i += taken ? taken : 1;
    }
    if (out->words && out->count == 0)
        out->words[out->count++] = "render";
    return out->words != NULL;
}

/* ---- life -------------------------------------------------------------------------------- */

static void on_say(void *user, bool failure, const char *line) {
    view *v = user;
    messages_add(v->messages, failure, line);
    v->awake = 3;
}

/* What has been said since, by whichever thread. */
static void trace_messages(view *v) {
    char text[MESSAGE_SIZE];
    bool failure;
    uint32_t count = messages_count(v->messages);
    for (; v->traced < count; v->traced++) {
        v->awake = 3;
        if (messages_get(v->messages, count - 1 - v->traced, &failure, text))
            trace(v, "%s %s", failure ? "error" : "warning", text);
    }
}

static void on_placed(void *user, const char *label, window_rect at) {
    trace(user, "at %d %d %d %d %s", at.x, at.y, at.width, at.height, label);
}

/* Of the monitor that windows open on. */
static float monitor_scale(void) {
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    float x = 1, y = 1;
    if (monitor)
        glfwGetMonitorContentScale(monitor, &x, &y);
    return x >= 1 ? x : 1;
}

/* A size that suits the user interface, as far as the monitor has room. */
static void usual_size(float scale, int *width, int *height) {
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    int x = 0, y = 0, wide = 0, high = 0;
    if (monitor)
        glfwGetMonitorWorkarea(monitor, &x, &y, &wide, &high);
    *width = (int)(1280 * scale);
    *height = (int)(800 * scale);
    *width = wide > 64 && wide < *width ? wide : *width;
    *height = high > 64 && high < *height ? high : *height;
}

static bool open(view *v, const arguments *a) {
    ui_desc desc = {a->scale > 0 ? a->scale : monitor_scale(), a->trace ? on_placed : NULL, v};
    int width = a->width, height = a->height;
    v->trace = a->trace;
    v->compare_first = a->compare;
    v->window.backend = strcmp(a->backend, "vk") == 0 ? &window_vk_backend : &window_gl_backend;
    v->window.vsync = a->vsync;
    v->window.debug = a->validate;
    v->ground = v->axes = v->turntable = v->panels = v->player.loop = true;
    v->steady.on = true;
    v->steady.wanted = 100;
    v->steady.scale = 1;
    v->comparison.divider = 0.5;
    v->comparison.gain = 16;
    v->comparison.looks[1].backend = 1;
    snprintf(v->comparison.image, sizeof v->comparison.image, "out");
    v->film.count = 100;
    v->film.fps = 25;
    snprintf(v->film.path, sizeof v->film.path, "video.mp4");
    v->shot_size[0] = 1280;
    v->shot_size[1] = 960;
    snprintf(v->shot_path, sizeof v->shot_path, "picture.png");
    snprintf(v->bookmark_path, sizeof v->bookmark_path, "camera.json");
    if (!width)
        usual_size(desc.scale, &width, &height);
    if (!v->window.backend->open(&v->window, "lineao", width, height))
        return false;
    input_attach(v);
    return ui_open(&v->window, &desc);
}

static void shut(view *v) {
    const window_backend *backend = v->window.backend;
    loader_stop(v->loader);
    document_close(v->next);
    hands_forget(v);
    stage_close(v);
    if (v->window.glfw && (v->window.gl || v->window.vk))
        backend->wait(&v->window);
    ui_close();
    backend->close(&v->window);
}

/* ---- the loop ---------------------------------------------------------------------------- */

static void title(view *v) {
    char text[256];
    snprintf(text, sizeof text, "%s - lineao (%s)", document_name(v->doc),
             v->window.backend->title);
    glfwSetWindowTitle(v->window.glfw, text);
}

/* The same document with something placed in it: all else stays. */
static bool open_changed(view *v, document *doc) {
    cli_shot fitted = v->fitted;
    picked before = v->picked;
    double speed = v->player.speed;
    camera_pose camera = v->shot.camera;
    document_inherit(doc, v->doc);
    if (!stage_open(v, doc))
        return false;
    v->fitted.camera = fitted.camera;
    v->shot.camera = camera;
    v->picked = before;
    if (picked_on(doc->scene, &before))
        pick_tell(doc->scene, &v->picked);
    v->player.speed = speed;
    hands_begin(v);
    return true;
}

static void take_measured(view *v) {
    bool ok;
    if (v->open && loader_measured(v->loader, &ok) == v->doc)
        stage_relight(v, ok);
}

/* A document that has been opened still wants its shaders, which takes the window's own time: a
 * frame that says so comes first. */
static document *next_document(view *v, bool *changed) {
    document *doc = v->next;
    char text[MESSAGE_SIZE];
    float part;
    bool busy = loader_busy(v->loader, text, &part);
    *changed = v->next_changed;
    v->next = doc ? NULL : loader_take(v->loader);
    v->next_changed = v->next && v->hands.reopening && v->open;
    v->awake += v->next != NULL;
    if (!busy)
        v->hands.reopening = false;
    return doc;
}

static void take_document(view *v) {
    bool changed, compared = v->compare != NULL;
    document *doc = next_document(v, &changed);
    if (!doc)
        return;
    v->awake = 3;
    v->player.playing = false;
    v->compare_first = v->compare_first || (changed && compared);
    if (changed ? open_changed(v, doc) : stage_open(v, doc)) {
        if (!changed) {
            hands_forget(v);
            hands_begin(v);
            memset(&v->flat, 0, sizeof v->flat);
            if (doc->options.frames)
                v->film.count = (int)doc->options.frames;
        }
        title(v);
        if (v->compare_first)
            v->compare = compare_start(v->doc, &v->listener);
    }
    v->compare_first = false;
}

/* A view that moves is drawn small enough to take the time that is wanted, and in full once it
 * rests. */
static void keep_steady(view *v, double now) {
    steady *s = &v->steady;
    bool moving = s->on && v->open && (now - s->last < 0.25 || v->player.playing);
    if (moving != s->moving)
        v->dirty = true;
    s->moving = moving;
}

/* The next size after a frame that took so long. Few sizes, as each one makes images anew. */
static void adapt(view *v, double ms) {
    static const float scales[] = {1, 0.75f, 0.5f, 0.35f, 0.25f};
    steady *s = &v->steady;
    int at = 0, last = (int)(sizeof scales / sizeof *scales) - 1;
    double wanted = (double)s->wanted;
    while (at < last && scales[at] > s->scale)
        at++;
    if (ms > 1.2 * wanted && at < last)
        at++;
    else if (at > 0 && ms * pow((double)(scales[at - 1] / scales[at]), 2) < 0.8 * wanted)
        at--;
    s->scale = scales[at];
}

static bool draw(view *v) {
    window *w = &v->window;
    uint32_t before = v->frames;
    double begin = glfwGetTime();
    if (!w->backend->begin(w))
        return false;
    ui_begin();
    panel_draw(v);
    ui_end();
    stage_fit_first(v);
    if (v->compare && v->open) {
        compare_draw(v);
        compare_show(v);
    } else {
        stage_draw(v);
        stage_show(v);
    }
    w->backend->end(w);
    double now = glfwGetTime();
    if (v->frames != before) {   /* the picture was drawn */
        v->pointer.fresh = true; /* and may show something else under the pointer */
        v->awake += v->awake == 0;
        bool follows = v->steady.moving && v->steady.frame > 0;
        if (v->warm)
            v->frame_ms = 1e3 * (now - (follows ? v->steady.frame : begin));
        if (v->warm && follows)
            adapt(v, v->frame_ms);
        v->warm = true;
    }
    v->steady.frame = v->steady.moving && v->frames != before ? now : 0;
    trace(v, "tick");
    return true;
}

/* Waits for something to happen. False: nothing has, and the window shows all there is. */
static bool wait(view *v) {
    char text[MESSAGE_SIZE];
    float part;
    bool busy = loader_busy(v->loader, text, &part);
    bool compared = v->compare && compare_busy(v->compare);
    bool filming = v->film.running;
    film_go_on(v);
    if (player_advance(v, glfwGetTime()) || v->steady.moving || v->dirty || v->awake > 0 || filming)
        glfwPollEvents();
    else
        glfwWaitEventsTimeout(busy || compared ? 0.05 : 0.5);
    take_measured(v);
    take_document(v);
    trace_messages(v);
    keep_steady(v, glfwGetTime());
    bool news = busy || compared || filming || v->player.playing || v->steady.moving || v->dirty ||
                v->awake > 0;
    v->awake -= v->awake > 0;
    return news;
}

static void run(view *v) {
    bool rests = false;
    v->awake = 3;
    while (!v->quit && !glfwWindowShouldClose(v->window.glfw)) {
        bool news = wait(v);
        if (news && !draw(v))
            glfwWaitEventsTimeout(0.05); /* minimised, or between two sizes */
        if (!news && !rests)
            trace(v, "rest");
        rests = !news;
    }
}

int main(int argc, char **argv) {
    arguments a;
    view *v = calloc(1, sizeof *v);
    int code = CLI_USAGE;
    if (!v || !parse(argc, argv, &a))
        return free(v), code;
    if (a.help) {
        fputs(help, stdout);
        free(a.words);
        return free(v), CLI_OK;
    }
    code = CLI_FAILED;
    v->messages = messages_new();
    v->loader = v->messages ? loader_new(v->messages) : NULL;
    v->listener = (cli_listener){on_say, NULL, NULL, v};
    if (v->loader && (glfwInit() || cli_fail("there is no display to open a window on"))) {
        if (open(v, &a)) {
            cli_listen(&v->listener);
            loader_start(v->loader, a.words, a.count);
            trace(v, "ready %s", v->window.backend->name);
            run(v);
            code = CLI_OK;
        }
        shut(v);
        cli_listen(NULL);
        trace(v, "messages %u", v->window.messages);
        code = v->window.messages ? CLI_FAILED : code;
    }
    loader_free(v->loader);
    glfwTerminate();
    messages_free(v->messages);
    free(a.words);
    free(v);
    return code;
}
