#include "desktop.h"

#include <X11/XKBlib.h>
#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { MOST_LINES = 65536, PATIENCE = 120, WIDGETS = 512 };

struct desktop {
    pid_t server, viewer;
    Display *display;
    Window window, source; /* the viewer's; ours, for dropping */
    int said;              /* the viewer's standard output */
    char *text;            /* all of it */
    size_t length, read;   /* read: up to where viewer_hears has come */
    size_t heard;          /* up to where events have been answered */
    int x, y;              /* where the pointer is */
    char line[65536];
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void user_waits(double seconds) {
    struct timespec t = {(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&t, NULL);
}

/* ---- the screen --------------------------------------------------------------------------- */

desktop *desktop_start(void) {
    int ends[2];
    char number[16] = "", name[24] = ":";
    if (pipe(ends) != 0)
        return NULL;
    pid_t server = fork();
    if (server == 0) {
        char fd[16];
        snprintf(fd, sizeof fd, "%d", ends[1]);
        close(ends[0]);
        int nowhere = open("/dev/null", O_WRONLY);
        dup2(nowhere, 2);
        execlp("Xvfb", "Xvfb", "-displayfd", fd, "-screen", "0", "1600x1000x24", "-noreset",
               "-nolisten", "tcp", (char *)NULL);
        _exit(127);
    }
    close(ends[1]);
    size_t got = 0;
    ssize_t more;
    while (got < sizeof number - 1 && !memchr(number, '\n', got) &&
           (more = read(ends[0], number + got, sizeof number - 1 - got)) > 0)
        got += (size_t)more;
    close(ends[0]);
    if (got == 0) {
        waitpid(server, NULL, 0);
        return NULL;
    }
    number[strcspn(number, "\n")] = '\0';
    strcat(name, number);
    setenv("DISPLAY", name, 1);
    unsetenv("WAYLAND_DISPLAY");
    desktop *d = calloc(1, sizeof *d);
    assert_non_null(d);
    d->server = server;
    d->display = XOpenDisplay(name);
    assert_non_null(d->display);
    d->source = XCreateSimpleWindow(d->display, DefaultRootWindow(d->display), 0, 0, 1, 1, 0, 0, 0);
    return d;
}

void desktop_resolution(desktop *d, int dots) {
    char text[32];
    int length = snprintf(text, sizeof text, "Xft.dpi:\t%d\n", dots);
    XChangeProperty(d->display, DefaultRootWindow(d->display), XA_RESOURCE_MANAGER, XA_STRING, 8,
                    PropModeReplace, (const unsigned char *)text, length);
    XSync(d->display, False);
}

void desktop_stop(desktop *d) {
    if (!d)
        return;
    XCloseDisplay(d->display);
    kill(d->server, SIGTERM);
    waitpid(d->server, NULL, 0);
    free(d->text);
    free(d);
}

/* ---- the viewer --------------------------------------------------------------------------- */

/* Takes what the viewer has said by now; waits for more up to that long. False: it has ended. */
static bool take(desktop *d, double seconds) {
    struct pollfd ready = {d->said, POLLIN, 0};
    if (poll(&ready, 1, (int)(1000 * seconds)) <= 0)
        return true;
    d->text = realloc(d->text, d->length + 65537);
    assert_non_null(d->text);
    ssize_t got = read(d->said, d->text + d->length, 65536);
    d->length += got > 0 ? (size_t)got : 0;
    d->text[d->length] = '\0';
    return got > 0;
}

static const char *find(desktop *d, const char *begin) {
    size_t wanted = strlen(begin);
    for (;;) {
        char *line = d->text ? d->text + d->read : NULL, *end = line ? strchr(line, '\n') : NULL;
        if (!end)
            return NULL;
        d->read = (size_t)(end + 1 - d->text);
        if (strncmp(line, begin, wanted) == 0) {
            snprintf(d->line, sizeof d->line, "%.*s", (int)(end - line - (long)wanted),
                     line + wanted);
            return d->line;
        }
    }
}

/* NULL: it has not said so, *ended: nor will it. */
static const char *hear(desktop *d, const char *begin, bool *ended) {
    double end = now() + PATIENCE;
    const char *rest = find(d, begin);
    *ended = false;
    while (!rest && !*ended && now() < end) {
        *ended = !take(d, 0.5);
        rest = find(d, begin);
    }
    return rest;
}

const char *viewer_hears(desktop *d, const char *begin) {
    bool ended;
    const char *rest = hear(d, begin, &ended);
    if (!rest) /* cmocka shows a thousand bytes: the last ones */
        fail_msg("the viewer never said '%s'; it said:\n%s", begin,
                 d->text + (d->length > 800 ? d->length - 800 : 0));
    return rest;
}

void viewer_rests(desktop *d) {
    static const char rest[] = "\nrest\n";
    double end = now() + PATIENCE;
    size_t length = sizeof rest - 1;
    while (d->length < length || strcmp(d->text + d->length - length, rest) != 0) {
        if (!take(d, 0.5))
            return;
        if (now() > end)
            fail_msg("the viewer never rests; it said:\n%s",
                     d->text + (d->length > 800 ? d->length - 800 : 0));
    }
    d->read = d->length;
}

uint32_t viewer_said(desktop *d, const char *begin) {
    size_t length = strlen(begin);
    uint32_t count = 0;
    for (const char *at = d->text; at && *at; at = strchr(at, '\n') + 1) {
        count += strncmp(at, begin, length) == 0;
        if (!strchr(at, '\n'))
            break;
    }
    return count;
}

double viewer_memory(desktop *d) {
    char path[64];
    long pages = 0;
    snprintf(path, sizeof path, "/proc/%ld/statm", (long)d->viewer);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%*d %ld", &pages), 1);
    fclose(file);
    return (double)pages * (double)sysconf(_SC_PAGESIZE) / 1048576;
}

/* The window without a manager is a child of the root. */
static Window find_window(desktop *d) {
    Window root = DefaultRootWindow(d->display), parent, *children = NULL, found = 0;
    unsigned count = 0;
    XQueryTree(d->display, root, &root, &parent, &children, &count);
    for (unsigned i = 0; i < count; i++) {
        char *name = NULL;
        if (XFetchName(d->display, children[i], &name) && strstr(name, "lineao"))
            found = children[i];
        XFree(name);
    }
    XFree(children);
    return found;
}

static void focus(desktop *d) {
    XWindowAttributes is;
    if (XGetWindowAttributes(d->display, d->window, &is) && is.map_state == IsViewable)
        XSetInputFocus(d->display, d->window, RevertToParent, CurrentTime);
    XSync(d->display, False);
}

void viewer_start(desktop *d, const char *program, const char *const *arguments) {
    const char *words[48] = {program, "--trace"};
    int ends[2], count = 2;
    while (*arguments && count < 47)
        words[count++] = *arguments++;
    assert_int_equal(pipe(ends), 0);
    XTestFakeMotionEvent(d->display, 0, 1599, 999, CurrentTime); /* so that every place is new */
    XSync(d->display, False);
    d->viewer = fork();
    if (d->viewer == 0) {
        close(ends[0]);
        dup2(ends[1], 1);
        close(ends[1]);
        close(ConnectionNumber(d->display));
        execv(program, (char **)(uintptr_t)words);
        _exit(127);
    }
    close(ends[1]);
    d->said = ends[0];
    d->length = d->read = d->heard = 0;
    d->x = d->y = -1;
    if (d->text)
        d->text[0] = '\0';
    viewer_hears(d, "ready");
    d->window = find_window(d);
    assert_true(d->window != 0);
    focus(d);
}

void viewer_kill(desktop *d) {
    if (!d->viewer)
        return;
    kill(d->viewer, SIGKILL);
    waitpid(d->viewer, NULL, 0);
    close(d->said);
    d->viewer = 0;
}

int viewer_end(desktop *d) {
    int status = 0;
    double end = now() + PATIENCE;
    while (take(d, 0.5) && now() < end)
        ;
    if (now() >= end)
        kill(d->viewer, SIGKILL);
    waitpid(d->viewer, &status, 0);
    close(d->said);
    d->viewer = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* ---- the user ----------------------------------------------------------------------------- */

/* The last "at X Y W H LABEL" of a widget. */
static bool find_widget(desktop *d, const char *label, int place[4]) {
    bool found = false;
    for (const char *at = d->text; at && *at; at = strchr(at, '\n') + 1) {
        int p[4], length = 0;
        const char *end = strchr(at, '\n');
        if (!end)
            break;
        if (sscanf(at, "at %d %d %d %d %n", &p[0], &p[1], &p[2], &p[3], &length) == 4 &&
            (size_t)(end - at - length) == strlen(label) &&
            strncmp(at + length, label, strlen(label)) == 0) {
            memcpy(place, p, sizeof p);
            found = true;
        }
    }
    return found;
}

void user_sees(desktop *d, const char *label, int place[4]) {
    double end = now() + PATIENCE;
    while (!find_widget(d, label, place)) {
        if (!take(d, 0.2) || now() > end)
            fail_msg("the viewer has no widget '%s'", label);
    }
}

bool user_finds(desktop *d, const char *begin, uint32_t i, char name[], size_t size) {
    size_t wanted = strlen(begin);
    for (const char *at = d->text; at && *at; at = strchr(at, '\n') + 1) {
        const char *end = strchr(at, '\n'), *earlier = d->text;
        int length = 0;
        if (!end)
            break;
        if (sscanf(at, "at %*d %*d %*d %*d %n", &length) != 0 || length == 0 ||
            strncmp(at + length, begin, wanted) != 0)
            continue;
        snprintf(name, size, "%.*s", (int)(end - at - length), at + length);
        char *said = NULL; /* the same label, before this one */
        for (; !said && earlier < at; earlier = strchr(earlier, '\n') + 1) {
            int skipped = 0;
            if (sscanf(earlier, "at %*d %*d %*d %*d %n", &skipped) == 0 && skipped > 0 &&
                strncmp(earlier + skipped, name, strlen(name)) == 0 &&
                earlier[skipped + (int)strlen(name)] == '\n')
                said = name;
        }
        if (!said && i-- == 0)
            return true;
    }
    return false;
}

/* Two frames of the user interface after an event: the second one has seen it through. What is
 * said meanwhile may still be waited for. */
static void wait_for_it(desktop *d) {
    size_t read = d->read;
    XSync(d->display, False);
    d->read = d->heard;
    viewer_hears(d, "event");
    d->heard = d->read;
    bool ended = false; /* by that event */
    for (int i = 0; i < 2 && !ended; i++) {
        if (!hear(d, "tick", &ended) && !ended)
            fail_msg("the viewer does not answer");
    }
    d->read = read;
}

/* Before an event is sent. */
static void listen_anew(desktop *d) {
    do {
        d->heard = d->length;
        take(d, 0);
    } while (d->length != d->heard);
}

void user_points(desktop *d, int x, int y) {
    int at_x, at_y;
    Window child;
    if (x == d->x && y == d->y) /* no event would come */
        return;
    d->x = x;
    d->y = y;
    XTranslateCoordinates(d->display, d->window, DefaultRootWindow(d->display), x, y, &at_x, &at_y,
                          &child);
    listen_anew(d);
    XTestFakeMotionEvent(d->display, 0, at_x, at_y, CurrentTime);
    wait_for_it(d);
}

void user_presses(desktop *d, unsigned button, bool down) {
    listen_anew(d);
    XTestFakeButtonEvent(d->display, button, down, CurrentTime);
    if (button < 4 || down) /* the wheel says nothing when it is let go */
        wait_for_it(d); /* Dear ImGui of this version takes one event of a button in each frame */
}

void user_clicks(desktop *d, const char *label) {
    int place[4];
    user_sees(d, label, place);
    user_points(d, place[0] + place[2] / 2, place[1] + place[3] / 2);
    user_presses(d, 1, true);
    user_presses(d, 1, false);
}

static void press_key(desktop *d, KeySym symbol) {
    KeyCode code = XKeysymToKeycode(d->display, symbol);
    KeyCode shift = XKeysymToKeycode(d->display, XK_Shift_L);
    bool shifted = XkbKeycodeToKeysym(d->display, code, 0, 0) != symbol;
    if (shifted)
        XTestFakeKeyEvent(d->display, shift, True, CurrentTime);
    listen_anew(d);
    XTestFakeKeyEvent(d->display, code, True, CurrentTime);
    wait_for_it(d);
    XTestFakeKeyEvent(d->display, code, False, CurrentTime);
    if (shifted)
        XTestFakeKeyEvent(d->display, shift, False, CurrentTime);
    XSync(d->display, False);
}

void user_types(desktop *d, const char *key) {
    focus(d);
    press_key(d, XStringToKeysym(key));
}

void user_writes(desktop *d, const char *text) {
    focus(d);
    for (; *text; text++)
        press_key(d, (KeySym)(unsigned char)*text);
}

void user_resizes(desktop *d, int width, int height) {
    XResizeWindow(d->display, d->window, (unsigned)width, (unsigned)height);
    XSync(d->display, False);
}

void user_hides(desktop *d, bool hidden) {
    if (hidden)
        XUnmapWindow(d->display, d->window);
    else
        XMapWindow(d->display, d->window);
    XSync(d->display, False);
    user_waits(0.3);
    focus(d);
}

/* ---- dropping: the source's side of XDND --------------------------------------------------- */

static Atom atom(desktop *d, const char *name) {
    return XInternAtom(d->display, name, False);
}

static void tell(desktop *d, const char *name, long a, long b, long c, long e) {
    XEvent event;
    memset(&event, 0, sizeof event);
    event.xclient.type = ClientMessage;
    event.xclient.window = d->window;
    event.xclient.message_type = atom(d, name);
    event.xclient.format = 32;
    event.xclient.data.l[0] = (long)d->source;
    event.xclient.data.l[1] = a;
    event.xclient.data.l[2] = b;
    event.xclient.data.l[3] = c;
    event.xclient.data.l[4] = e;
    XSendEvent(d->display, d->window, False, NoEventMask, &event);
    XFlush(d->display);
}

/* Waits for an event of the source window; answers who asks for the list of files. */
static void answer(desktop *d, int type, const char *uris) {
    double end = now() + PATIENCE;
    XEvent event;
    while (now() < end) {
        if (!XPending(d->display)) {
            user_waits(0.02);
            continue;
        }
        XNextEvent(d->display, &event);
        if (event.type == SelectionRequest) {
            XSelectionRequestEvent *r = &event.xselectionrequest;
            XEvent reply;
            memset(&reply, 0, sizeof reply);
            XChangeProperty(d->display, r->requestor, r->property, r->target, 8, PropModeReplace,
                            (const unsigned char *)uris, (int)strlen(uris));
            reply.xselection.type = SelectionNotify;
            reply.xselection.requestor = r->requestor;
            reply.xselection.selection = r->selection;
            reply.xselection.target = r->target;
            reply.xselection.property = r->property;
            reply.xselection.time = r->time;
            XSendEvent(d->display, r->requestor, False, NoEventMask, &reply);
            XFlush(d->display);
        }
        if (event.type == type)
            return;
    }
    fail_msg("the viewer does not take what is dropped");
}

void user_drops(desktop *d, const char *path) {
    char uris[4096];
    snprintf(uris, sizeof uris, "file://%s\r\n", path);
    while (XPending(d->display)) { /* what an earlier one has left */
        XEvent event;
        XNextEvent(d->display, &event);
    }
    XSetSelectionOwner(d->display, atom(d, "XdndSelection"), d->source, CurrentTime);
    tell(d, "XdndEnter", 5L << 24, (long)atom(d, "text/uri-list"), 0, 0);
    tell(d, "XdndPosition", 0, 500L << 16 | 200, 0, (long)atom(d, "XdndActionCopy"));
    answer(d, ClientMessage, uris); /* XdndStatus */
    tell(d, "XdndDrop", 0, 0, 0, 0);
    answer(d, SelectionRequest, uris);
}

/* ---- what is seen ------------------------------------------------------------------------- */

uint8_t *screen_picture(desktop *d, int x, int y, int width, int height) {
    XImage *image = XGetImage(d->display, d->window, x, y, (unsigned)width, (unsigned)height,
                              AllPlanes, ZPixmap);
    uint8_t *pixels = malloc((size_t)width * (size_t)height * 3);
    assert_non_null(image);
    assert_non_null(pixels);
    for (int row = 0; row < height; row++) {
        for (int column = 0; column < width; column++) {
            unsigned long value = XGetPixel(image, column, row);
            uint8_t *p = pixels + 3 * ((size_t)row * (size_t)width + (size_t)column);
            p[0] = (uint8_t)(value >> 16);
            p[1] = (uint8_t)(value >> 8);
            p[2] = (uint8_t)value;
        }
    }
    XDestroyImage(image);
    return pixels;
}
