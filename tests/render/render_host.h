/* What the tests of the picture share: one context on GL and one on Vulkan per program, a frame
 * drawn on either with all of its images read back as raw texels, line sets and cameras. */
#ifndef RENDER_HOST_H
#define RENDER_HOST_H

#include "host_gl.h"
#include "host_vk.h"
#include "lineao.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { RENDER_MOST_IMAGES = 256, RENDER_MOST_SETS = 4, RENDER_MOST_MODULES = 4 };

/* ---- devices ---------------------------------------------------------------------------- */

typedef struct render_device {
    const char *name; /* "GL", "VK" */
    host_gl *gl;      /* one of the two */
    host_vk *vk;
    lao_context *context;
    int software;        /* Mesa's llvmpipe, for which the bounds are exact */
    int refused;         /* there is a device, but no context came of it: a failure */
    char log[1024];      /* of the last failure */
    double milliseconds; /* of the last frame, compilation and all */
} render_device;

/* From now on every window of time is without end: whatever has times is drawn (on != 0). */
void render_endless(int on);
/* A further module of the contexts that are opened from now on. */
void render_module(const lao_module *module);
/* Opens a device with a context on it. `get_proc` NULL: the driver's; api_version 0: 1.3. Returns 0
 * where there is none: the test skips, or fails where a GPU is expected. */
int render_open_gl(render_device *device, void *(*get_proc)(const char *name, void *user));
int render_open_vk(render_device *device, uint32_t api_version);
/* Views are kept until here, so that no shader is compiled twice. Fine on a closed one. */
void render_close(render_device *device);
/* Unless the device is open: skips the test, or fails it where LINEAO_EXPECT_GPU is set. */
void render_need(const render_device *device);

/* The devices of a test program, and what a group of tests begins and ends with. Where a device is
 * missing the group begins all the same: its tests say so with render_need. */
enum { RENDER_GL, RENDER_VK, RENDER_DEVICES };
extern render_device render_devices[RENDER_DEVICES];
int render_open_both(void **state);
int render_open_opengl(void **state);
int render_close_both(void **state);

/* ---- line sets -------------------------------------------------------------------------- */

typedef struct render_lines {
    uint32_t line_count, point_count, line_capacity, point_capacity;
    uint32_t *offsets;
    float *points;
    float *times; /* 4 ms from point to point of a line, unless changed */
    uint8_t *colors;
} render_lines;

void render_point(render_lines *lines, double x, double y, double z);
/* The points since the last call are a line. */
void render_line(render_lines *lines);
/* A scene made by code, scaled and moved. */
void render_scene(render_lines *lines, const char *name, uint32_t count, double scale, double x,
                  double y, double z);
/* count random straight lines of this length with centres in the box of half size `extent`. */
void render_scatter(render_lines *lines, uint32_t count, uint32_t seed, double length,
                    double extent, double depth);
void render_lines_free(render_lines *lines);

/* ---- cameras ---------------------------------------------------------------------------- */

/* Right-handed, clip depth 0 .. 1. The eye looks at the origin from `direction` times `distance`.
 */
lao_camera render_camera(double x, double y, double z, double distance);
/* Gives it a projection: fovy in degrees, or 0 and the full height in mm. */
void render_perspective(lao_camera *camera, double fovy, double aspect, double near, double far);
void render_orthographic(lao_camera *camera, double height, double aspect, double near, double far);
void render_reverse(lao_camera *camera);
/* Moves the picture by parts of its half size. */
void render_shift(lao_camera *camera, double x, double y);

/* ---- frames ----------------------------------------------------------------------------- */

enum render_target { RENDER_NO_TARGET, RENDER_TARGET_RGBA8, RENDER_TARGET_RGBA32F };

typedef struct render_shot {
    uint32_t width, height;
    lao_camera camera;
    const lao_camera *before; /* (Optional) frames drawn before in the same view */
    uint32_t before_count;
    lao_view
        *view; /* (Optional) id 0: receives the frame's view; else the frames go on in that one */
    const render_lines *lines[RENDER_MOST_SETS]; /* NULL: none */
    const lao_settings *settings[RENDER_MOST_SETS];
    const lao_object_desc *objects[RENDER_MOST_SETS]; /* NULL: none */
    const void *const *module_settings[RENDER_MOST_SETS];
    uint32_t frame_flags;
    uint32_t set_count;
    float background[4], sphere[4], time;
    enum render_target target;
    uint32_t target_flags; /* LAO_HOST_... */
    float target_value;    /* grey and alpha that it holds before */
    int host_depth;        /* non-zero: a depth image of the host, written and read */
    uint32_t depth_flags;
    float depth_value;                  /* that it holds before */
    const struct render_image *imports; /* (Optional) images of the graph that the host brings */
    uint32_t import_count;              /* RENDER_MOST_SETS at most */
    const render_lines *depth_lines; /* (Optional) drawn into the host's depth by a frame before */
} render_shot;

/* Raw texels, row 0 at the bottom but for the host's images. */
typedef struct render_image {
    const char *name;
    uint32_t level, width, height;
    lao_format format;
    uint8_t *data;
} render_image;

typedef struct render_result {
    render_image images[RENDER_MOST_IMAGES];
    uint32_t count;
    lao_frame_uniforms frame;                       /* as the shaders saw it */
    render_image target, depth_before, depth_after; /* data NULL: none */
    render_image import_after;                      /* the last of shot->imports */
} render_result;

/* Draws and reads everything; fails the test when something does. */
void render_draw(render_device *device, const render_shot *shot, render_result *result);
/* On each of render_devices; needs them. */
void render_draw_both(const render_shot *shot, render_result results[RENDER_DEVICES]);
void render_free(render_result *result);
const render_image *render_find(const render_result *result, const char *name, uint32_t level);
/* The image's numbers as lao_read would decode one channel. For the caller's free(). */
float *render_floats(const render_image *image, uint32_t channel);

/* ---- comparison ------------------------------------------------------------------------- */

typedef struct render_difference {
    uint32_t texels;      /* that differ in any bit */
    double largest, mean; /* of the components' numbers; NaN counts as 1e30 */
} render_difference;

/* Prints one line when they differ. */
render_difference render_compare(const char *what, const render_image *a, const render_image *b);
/* Fail where a bit differs: of this image of level 0; of any image of `a`, all of which `b` has. */
void render_same_image(const char *name, const render_result *a, const render_result *b);
void render_same_images(const char *what, const render_result *a, const render_result *b);

#endif
