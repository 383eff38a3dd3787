/* A screen of our own (Xvfb), the viewer on it, and a user who moves the pointer and presses keys
 * through XTest, as a mouse and a keyboard would. */
#ifndef LINEAO_TEST_DESKTOP_H
#define LINEAO_TEST_DESKTOP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct desktop desktop;

/* Starts the screen, with 1600 x 1000 px. NULL: there is no Xvfb. */
desktop *desktop_start(void);
void desktop_stop(desktop *d);
/* Dots per inch of the monitor, for viewers that are started from now on; 96 at first. */
void desktop_resolution(desktop *d, int dots);

/* Starts a viewer with --trace and these arguments, and waits until it is ready. */
void viewer_start(desktop *d, const char *program, const char *const *arguments);
/* Waits for its end; returns its exit code, 128 + signal when it was killed. */
int viewer_end(desktop *d);
/* After a test that has failed in between. */
void viewer_kill(desktop *d);

/* The rest of the next line that begins with `begin`; fails the test after two minutes. Valid until
 * the next call. */
const char *viewer_hears(desktop *d, const char *begin);
/* Waits until the viewer has nothing left to do. */
void viewer_rests(desktop *d);
/* How many lines beginning so have been said since the start? */
uint32_t viewer_said(desktop *d, const char *begin);

/* What the viewer has in memory now, MB. */
double viewer_memory(desktop *d);

/* Clicks into the middle of a widget, once it is there. */
void user_clicks(desktop *d, const char *label);
/* The place of a widget, once it is there: x, y, width, height. */
void user_sees(desktop *d, const char *label, int place[4]);
/* The i-th label that begins so, of those seen since the start. False: so many there are not. */
bool user_finds(desktop *d, const char *begin, uint32_t i, char name[], size_t size);
void user_waits(double seconds);
void user_points(desktop *d, int x, int y);
void user_presses(desktop *d, unsigned button, bool down);
void user_types(desktop *d, const char *key); /* a keysym's name: "space", "g" */
void user_writes(desktop *d, const char *text);
void user_resizes(desktop *d, int width, int height);
void user_hides(desktop *d, bool hidden); /* unmaps the window, or maps it */
void user_drops(desktop *d, const char *path);

/* A part of the window as the screen has it: RGB, top row first, for free(). */
uint8_t *screen_picture(desktop *d, int x, int y, int width, int height);

#endif
