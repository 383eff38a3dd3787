/* A window on OpenGL or Vulkan: what a host of lineao owns. window_gl.c and window_vk.c are all of
 * the viewer that knows a graphics library; both fill the same table of functions.
 *
 * A window holds a few images ("slots"). Two of them are canvases with depth, into which the host
 * draws things of its own and lineao draws its picture; the rest take pictures from memory. A frame
 * shows parts of slots in the window, then the user interface on top. */
#ifndef LINEAO_VIEW_WINDOW_H
#define LINEAO_VIEW_WINDOW_H

#include "lineao.h"

#include <stdbool.h>

#ifndef GLFW_INCLUDE_VULKAN
#define GLFW_INCLUDE_NONE
#endif
#include <GLFW/glfw3.h>

enum {
    SLOT_REST,
    SLOT_MOVING,
    SLOT_CANVASES,
    SLOT_LEFT = SLOT_CANVASES,
    SLOT_RIGHT,
    SLOT_DIFFERENCE,
    SLOT_COUNT
};

/* Pixels; (0, 0) is the top left corner. */
typedef struct window_rect {
    int x, y, width, height;
} window_rect;

/* What the host draws itself, in the layout of its shaders: an opaque box, and a ground grid that
 * lets the picture through. `clip` takes mm about the scene's origin to clip space, depth 0 .. 1.
 */
typedef struct window_box {
    float clip[16], lower[4], upper[4], color[4];
} window_box;
typedef struct window_ground {
    float clip[16];
    float middle[4]; /* w: distance of the lines, mm */
    float right[4];  /* unit vectors in the plane; w: half the size of the grid, mm */
    float up[4];
    float color[4];
} window_ground;

typedef struct window {
    const struct window_backend *backend;
    GLFWwindow *glfw;
    struct window_gl *gl; /* of its backend alone */
    struct window_vk *vk;
    int width, height; /* of the last frame begun, px */
    bool vsync, debug; /* debug: validation layers, a debug context */
    uint32_t messages; /* of these, and failed calls */
} window;

typedef struct window_backend {
    const char *name, *title; /* "gl", "OpenGL"; "vk", "Vulkan" */
    /* Makes window, device and user interface. False: reported; close it in any case. */
    bool (*open)(window *w, const char *title, int width, int height);
    void (*close)(window *w);
    /* What the host lends to lao_create. False: reported. */
    bool (*lend)(window *w, lao_backend *out);
    /* Begins a frame. False: there is nothing to draw into now (minimised, being resized). */
    bool (*begin)(window *w);
    /* Makes a canvas of that size ready, filled with `paper`, and draws the boxes. What it returns
     * is for lao_frame: target, import "host_depth", commands. False: reported. */
    bool (*canvas)(window *w, int slot, uint32_t width, uint32_t height, const float paper[4],
                   const window_box *boxes, int count, lao_image *color, lao_image *depth,
                   void **commands);
    /* Draws over what is on the canvas and hidden by it. */
    void (*ground)(window *w, int slot, const window_ground *ground);
    /* What was recorded since `begin` is dropped: lao_render has failed in the middle. */
    void (*drop)(window *w);
    /* Replaces a slot's image; RGBA, top row first. False: reported. */
    bool (*upload)(window *w, int slot, uint32_t width, uint32_t height, const uint8_t *pixels);
    /* Copies a part of a slot into the window, pixel by pixel where both are of one size. */
    void (*show)(window *w, int slot, window_rect from, window_rect to);
    /* Draws the user interface and shows the frame. */
    void (*end)(window *w);
    /* Waits until all frames are done. */
    void (*wait)(window *w);
} window_backend;

extern const window_backend window_gl_backend, window_vk_backend;

#endif
