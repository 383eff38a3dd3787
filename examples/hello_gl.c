/* The smallest OpenGL host: makes lines, lets lineao draw them into a texture, writes a picture.
 *
 *     cc -std=c99 -I. examples/hello_gl.c lineao_gl.c -lEGL -lm -o hello_gl && ./hello_gl
 *
 * The host owns its context, its images and its files; lineao owns what it makes between lao_create
 * and lao_destroy. Beside this file only lineao.h, lineao_shaders.h and lineao_gl.c are needed. */
#define LINEAO_IMPLEMENTATION /* in exactly one file of a program */
#include "lineao.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 640, HEIGHT = 480, LINES = 400, POINTS = 160 };

static float points[LINES * POINTS][3]; /* mm */
static uint32_t offsets[LINES + 1];     /* line i has points offsets[i] .. offsets[i + 1] - 1 */
static uint8_t pixels[HEIGHT][WIDTH][4];

/* lineao never prints and never aborts: a failure is a result and one call of the logger. */
static void print_error(void *user, lao_log_item item, lao_result result, const char *text) {
    fprintf((FILE *)user, "lineao: %s (%d): %s\n", lao_result_text(result), (int)item, text);
}

/* lineao links to no GL library: it asks the host's loader, whichever that is, for each function.
 * ISO C has no cast from a function to an object pointer, so the bits are copied. */
static void *get_proc(const char *name, void *user) {
    void (*function)(void) = eglGetProcAddress(name);
    void *address = NULL;
    (void)user;
    memcpy(&address, &function, sizeof address);
    return address;
}

/* A straight bundle, and a coil of the other half of the lines around it. */
static void make_lines(void) {
    for (uint32_t i = 0; i < LINES * POINTS; i++) {
        uint32_t line = i / POINTS, coil = line % 2;
        double r = sqrt((double)line / LINES), a = r * cos(2.4 * line), b = r * sin(2.4 * line);
        double t = 2.0 * (i % POINTS) / (POINTS - 1) - 1; /* along the line */
        points[i][0] = (float)(coil ? 45 * t : 8 * a);
        points[i][1] = (float)(coil ? (20 + 6 * a) * cos(6 * t + 2 * b) : 34 * t);
        points[i][2] = (float)(coil ? (20 + 6 * a) * sin(6 * t + 2 * b) : 8 * b - 20 * t);
        offsets[line + 1] = i + 1;
    }
}

/* An OpenGL 3.3 core context without a window; a real host has its own already. */
static int open_gl(void) {
    EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
    EGLDisplay display =
        eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    if (!eglInitialize(display, NULL, NULL) || !eglBindAPI(EGL_OPENGL_API))
        return 0;
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
    return context && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

static lao_result draw(lao_context *context, GLuint texture) {
    /* Once: the lines, copied to the GPU, so that our arrays could go afterwards; and a view, the
     * scratch images of one viewport: one per window or eye, resized with it. */
    lao_lines_desc desc = {.line_count = LINES, .point_count = LINES * POINTS};
    desc.offsets = offsets;
    desc.points = points[0];
    lao_view_desc size = {.width = WIDTH, .height = HEIGHT};
    lao_lines lines;
    lao_view view;
    lao_result result = lao_lines_create(context, &desc, &lines);
    if (!result)
        result = lao_view_create(context, &size, &view);
    if (result)
        return result;

    /* Every frame: what to draw, from where, and into which image. A field left out is zero, and
     * zero is a good default; the settings of a set without any are the recommended ones. */
    lao_set set = {.lines = lines};
    lao_frame frame = {.view = view, .sets = &set, .set_count = 1};

    /* The host's own matrices, column-major; flags say how they differ from OpenGL's custom, y up
     * and clip depth -w .. w. Here: 128 mm in front of the origin, near 64, far 192. */
    static const float eye[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -128, 1};
    static const float lens[16] = {
        3.0f * HEIGHT / WIDTH, 0, 0, 0, 0, 3, 0, 0, 0, 0, -2, -1, 0, 0, -192, 0};
    memcpy(frame.camera.view, eye, sizeof eye);
    memcpy(frame.camera.projection, lens, sizeof lens);

    frame.background[0] = frame.background[1] = frame.background[2] = 0.95f;
    frame.background[3] = 1; /* 0 would leave what the target holds between the lines */

    /* The texture stays ours: it is attached for this call only. A framebuffer or renderbuffer is
     * named in the same way, with its kind. */
    frame.target = (lao_image){.present = 1, .native = texture, .kind = LAO_HOST_TEXTURE};
    frame.target.width = WIDTH;
    frame.target.height = HEIGHT;
    return lao_render(context, &frame); /* and GL's state is again what it was before */
}

int main(int count, char **arguments) {
    if (!open_gl()) {
        fprintf(stderr, "%s: no OpenGL 3.3 context\n", arguments[0]);
        return 1;
    }
    make_lines();
    PFNGLGENTEXTURESPROC gen_textures = (PFNGLGENTEXTURESPROC)eglGetProcAddress("glGenTextures");
    PFNGLBINDTEXTUREPROC bind_texture = (PFNGLBINDTEXTUREPROC)eglGetProcAddress("glBindTexture");
    PFNGLTEXIMAGE2DPROC tex_image = (PFNGLTEXIMAGE2DPROC)eglGetProcAddress("glTexImage2D");
    PFNGLGETTEXIMAGEPROC get_image = (PFNGLGETTEXIMAGEPROC)eglGetProcAddress("glGetTexImage");
    GLuint texture;
    gen_textures(1, &texture);
    bind_texture(GL_TEXTURE_2D, texture);
    tex_image(GL_TEXTURE_2D, 0, GL_RGBA8, WIDTH, HEIGHT, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);

    /* The GL context must be current from lao_create to lao_destroy, whenever lineao is called. */
    lao_gl_desc gl = {.get_proc = get_proc};
    lao_backend backend;
    lao_desc desc = {.backend = &backend, .logger = {print_error, stderr}};
    lao_context *context = NULL;
    int failed =
        lao_gl_backend(&gl, &backend) || lao_create(&desc, &context) || draw(context, texture);
    lao_destroy(context); /* with its lines and views; our texture is not among them */

    get_image(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels); /* it is still bound, too */
    FILE *file = failed ? NULL : fopen(count > 1 ? arguments[1] : "hello_gl.ppm", "wb");
    failed = !file || fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT) < 0;
    for (int i = 0; !failed && i < WIDTH * HEIGHT; i++) /* row 0 of GL is the bottom */
        failed = fwrite(pixels[HEIGHT - 1 - i / WIDTH][i % WIDTH], 3, 1, file) != 1;
    return (file && fclose(file) != 0) || failed;
}
