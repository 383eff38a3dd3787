/* The viewer's state, and who changes it: stage.c draws a document into the window, input.c takes
 * pointer and keys, player.c the time, pick.c what was clicked, hands.c what is done with that,
 * marks.c what is marked in the picture, film.c videos, panel*.c the user interface. */
#ifndef LINEAO_VIEW_VIEW_H
#define LINEAO_VIEW_VIEW_H

#include "compare.h"
#include "document.h"
#include "loader.h"
#include "pick.h"
#include "ui.h"
#include "video.h"
#include "window.h"

enum { BOOKMARKS = 8, PATH_SIZE = 1024, HANDS_UNDO = 16, HANDS_TEXT = 160 };

/* How a picture in the window is made while it moves. */
typedef struct steady {
    bool on;
    float wanted;       /* ms between two frames */
    float scale;        /* of width and height, up to 1 */
    double last, frame; /* when it moved last, s; ms of the last frame of that kind */
    bool moving;        /* the canvas in use is the small one */
} steady;

typedef struct player {
    bool playing, loop;
    double speed; /* ms of the data for each second */
    double last;  /* s */
} player;

typedef struct pointer {
    double x, y, pressed_at[2]; /* px */
    int button;                 /* that was pressed on the picture; -1: none */
    bool moved, shift;          /* since it was pressed */
    bool fresh;                 /* what it is on has not been looked for */
} pointer;

/* What is placed where something was picked. */
typedef struct hands {
    char *undo[HANDS_UNDO]; /* owned: the words of a tree, or the value of --focus, before each */
    uint32_t count;
    bool reopening;                  /* what is being opened is this document, changed */
    bool pathing;                    /* the next click says where a path begins that ends there: */
    double end[3];                   /* mm, absolute */
    char focus[HANDS_TEXT];          /* value of --focus */
    float sharp, radius, risk, lens; /* mm */
    bool stale;                      /* a slider has been moved, and not yet let go */
} hands;

/* Which part of the flat tree is shown. */
typedef struct flat_view {
    float zoom;      /* 1, or 0 at first: all of it */
    float left, top; /* in parts of the whole */
} flat_view;

/* A video that is being made. */
typedef struct film {
    char path[PATH_SIZE];
    int count, fps, done; /* frames */
    bool running;
    cli_video video;
    cli_session session; /* the window's, with a view of its own */
    cli_shot shot;
    camera_pose camera; /* of the first frame */
    double start;       /* its time, ms */
} film;

/* How two pictures are shown side by side. */
typedef struct comparison {
    compare_look looks[2];
    char image[COMPARE_NAME];
    uint32_t level;
    bool difference, differed, stale; /* stale: the difference is to be made again */
    float gain;
    double divider; /* in parts of the picture's width */
    bool ready;     /* both are in the window's slots */
    int size[2][2];
    compare_count count;
} comparison;

typedef struct view {
    window window;
    messages *messages;
    loader *loader;
    cli_listener listener;
    bool trace; /* tells a test what happens, on standard output */

    document *doc;     /* NULL: nothing is open yet */
    document *next;    /* is to be shown after the next frame, or NULL */
    bool next_changed; /* it is this document, changed by hand */
    cli_session session;
    bool open; /* the session is */
    lao_view moving_view;
    cli_shot shot, fitted; /* fitted: as the document was opened */
    camera_pose aimed;     /* for which contours were made */
    float bounds[2][3];    /* mm about the scene's origin */

    document_need need;          /* of edits, once the widget is let go */
    window_rect picture;         /* where in the window; px */
    bool dirty;                  /* the canvas is older than what it shows */
    int drawn[SLOT_CANVASES][2]; /* sizes of what the canvases hold; 0: nothing */
    bool keys;                   /* their list is shown */
    bool unfitted;               /* the camera has not been fitted into the window */
    int awake;                   /* frames of the user interface still to be drawn */
    double busy_since;           /* s; 0: the loader is not at work */
    bool ground, axes, turntable, panels, quit;
    double frame_ms; /* of the last frame that built no shaders; 0: none */
    bool warm;       /* they are built */
    uint32_t frames;

    steady steady;
    player player;
    pointer pointer;
    picked picked, hovered;
    bool hovered_flat; /* in the 2D view */
    flat_view flat;
    hands hands;
    film film;
    lao_lines picked_lines; /* the selected line once more, on top */
    compare *compare;       /* NULL: there is one picture */
    comparison comparison;
    bool compare_first; /* begin with it */
    bool dividing;      /* the pointer moves the divider, */
    bool lensing;       /* or the lens */

    camera_pose bookmarks[BOOKMARKS];
    bool bookmarked[BOOKMARKS];
    char words[4 * PATH_SIZE]; /* being edited */
    char filter[64];
    char shot_path[PATH_SIZE], bookmark_path[PATH_SIZE];
    int shot_size[2];
    uint32_t seen, traced; /* messages that were shown, and told to a test */
} view;

/* ---- stage.c ---- */

/* Takes over a document, in place of the one before. False: reported, nothing is open. */
bool stage_open(view *v, document *doc);
void stage_close(view *v);
/* Draws the document into its canvas if that is out of date. */
void stage_draw(view *v);
/* Makes anew what belongs to a camera: the depths in focus, contours. False: reported. */
bool stage_aim(view *v, const cli_shot *shot);
/* Lays the canvas into the window. */
void stage_show(view *v);
/* The time has changed: what depends on it goes up. */
void stage_time(view *v);
/* Settings have changed; `reach`: one of those that say how far the scene reaches. */
void stage_changed(view *v, bool reach);
void stage_fit(view *v);
/* The same for the first picture, where the words ask for no camera. */
void stage_fit_first(view *v);
/* Writes the picture as `lineao render` would. False: reported. */
bool stage_save(view *v, const char *path, uint32_t width, uint32_t height);
/* Is the picture that of the settings? False: reported, it will be. */
bool stage_settled(const view *v, const char *path);
/* Shows the picked line on top. */
void stage_select(view *v);
/* Begins what edits need: opens the same document again, or measures in it. */
void stage_answer(view *v);
/* Shows what was measured. */
void stage_relight(view *v, bool ok);
/* Opens files beside what is open, where that can be; takes one of several away again. */
void stage_add(view *v, const char *const *files, uint32_t count);
void stage_remove(view *v, const char *file);
/* Where a place (mm, absolute) is in the window. False: behind the eye. */
bool stage_place(const view *v, const double at[3], float place[2]);
/* The axis of the document that is up. */
void stage_up(const view *v, double axis[3]);
/* Where the axes that are drawn end (mm, absolute), and their colour, three parts of 0..1. */
const float *stage_axis(const view *v, int k, double end[3]);

/* ---- input.c ---- */

void input_attach(view *v);
/* Finds what the pointer is on, in a frame of the user interface. */
void input_hover(view *v);
/* Draws of the keys table, for the panel. */
uint32_t input_keys(uint32_t i, const char **key, const char **help);

/* ---- marks.c ---- */

/* What the pointer is on now, in the picture or in the flat tree. */
void marks_hover(view *v, const picked *at);
void marks_draw(const view *v);
/* A straight way between two places (mm, absolute). */
void marks_way(const view *v, const double a[3], const double b[3], uint32_t color, float width);

/* ---- hands.c ---- */

/* A document was opened: sizes that suit it. */
void hands_begin(view *v);
/* What could be taken back cannot any more. */
void hands_forget(view *v);
/* A click while a path is being placed; the pointer's ray, mm, absolute. */
void hands_click(view *v, const double from[3], const double to[3]);
/* A lens on the picture: is its ring at that place of the window? Then it can be taken, moved (px)
 * and left there. */
bool hands_grabs(const view *v, double x, double y);
void hands_grab(view *v);
void hands_drag(view *v, double x, double y);
void hands_let_go(view *v);
/* Of the picked place; of a focus that is on; of the tab of the tree. */
void hands_buttons(view *v);
void hands_focus(view *v);
void hands_tree(view *v);
void hands_marks(const view *v);

/* ---- film.c ---- */

/* Does anything move? */
bool film_possible(const view *v);
/* Begins to write v->film.path. False: reported. */
bool film_start(view *v);
/* Draws the next frame, between two frames of the window. */
void film_go_on(view *v);
void film_cancel(view *v);
/* The command line that makes the same video; for free(). */
char *film_command(const view *v);
/* The progress, over the picture; the part of the tab Save. */
void film_panel(view *v);
void film_widgets(view *v);

/* ---- player.c ---- */

bool player_timed(const view *v);
void player_range(const view *v, double *first, double *length);
/* Lets the time pass. Is it playing? */
bool player_advance(view *v, double now);
void player_toggle(view *v);
void player_stop(view *v);
void player_step(view *v, int steps);
void player_go(view *v, double time);
void player_pace(view *v, double factor); /* faster above 1 */
void player_panel(view *v, window_rect place);

/* ---- panel.c ---- */

/* The user interface of a frame; says where the picture goes. */
void panel_draw(view *v);
/* At its lower end, once something is picked. */
int panel_picked_height(void);
/* Its tabs; the list of keys. */
void panel_scene(view *v);
void panel_view(view *v);
void panel_save(view *v);
void panel_keys(void);
void panel_settings(view *v);
/* The widget of a setting, and its help. */
bool panel_edit(const lao_setting_row *row, float *value);
void panel_explain(const lao_setting_row *row);
void panel_tree(view *v);

/* ---- panel_compare.c ---- */

void panel_compare(view *v);
void compare_end(view *v);
void compare_draw(view *v);
void compare_show(view *v);
void compare_marks(view *v);
/* Is the divider at that place of the window? */
bool compare_grabs(const view *v, double x);
void compare_divide(view *v, double x);

/* One line on standard output for a test, unless nobody listens. */
void trace(const view *v, const char *format, ...) CLI_PRINTF(2, 3);

#endif
