#include "gl_wrap.h"

#include "host_gl.h"

#include <GL/glcorearb.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

struct gl_wrap gl_wrap;

static host_gl *host;

/* A function of the driver; ISO C has no cast from data to functions, POSIX promises the same bits.
 */
#define DRIVER(type, function, name)                                                               \
    type function;                                                                                 \
    void *function##_data = host_gl_get_proc(name, NULL);                                          \
    memcpy(&function, &function##_data, sizeof function)

void gl_wrap_reset(void) {
    int live = gl_wrap.live;
    memset(&gl_wrap, 0, sizeof gl_wrap);
    gl_wrap.live = live;
}

static int fails(GLenum what) {
    if (++gl_wrap.calls != gl_wrap.fail_call)
        return 0;
    gl_wrap.failed = (int)what;
    return 1;
}

/* -------------------------------------------------------------------------- calls that can fail */

static GLenum APIENTRY get_error(void) {
    DRIVER(PFNGLGETERRORPROC, real, "glGetError");
    GLenum error = gl_wrap.error;
    gl_wrap.error = 0;
    return error ? error : real();
}

static void APIENTRY tex_image_2d(GLenum target, GLint level, GLint internal, GLsizei width,
                                  GLsizei height, GLint border, GLenum format, GLenum type,
                                  const void *data) {
    DRIVER(PFNGLTEXIMAGE2DPROC, real, "glTexImage2D");
    if (fails(GL_OUT_OF_MEMORY))
        gl_wrap.error = GL_OUT_OF_MEMORY;
    else
        real(target, level, internal, width, height, border, format, type, data);
}

static void APIENTRY buffer_data(GLenum target, GLsizeiptr size, const void *data, GLenum usage) {
    DRIVER(PFNGLBUFFERDATAPROC, real, "glBufferData");
    if (fails(GL_OUT_OF_MEMORY))
        gl_wrap.error = GL_OUT_OF_MEMORY;
    else
        real(target, size, data, usage);
}

static void APIENTRY link_program(GLuint program) {
    DRIVER(PFNGLLINKPROGRAMPROC, real, "glLinkProgram");
    gl_wrap.linked++;
    if (fails(GL_OUT_OF_MEMORY))
        gl_wrap.error = GL_OUT_OF_MEMORY;
    real(program);
}

static GLenum APIENTRY check_framebuffer_status(GLenum target) {
    DRIVER(PFNGLCHECKFRAMEBUFFERSTATUSPROC, real, "glCheckFramebufferStatus");
    return fails(GL_FRAMEBUFFER_UNSUPPORTED) ? GL_FRAMEBUFFER_UNSUPPORTED : real(target);
}

static void APIENTRY get_shader_iv(GLuint shader, GLenum what, GLint *value) {
    DRIVER(PFNGLGETSHADERIVPROC, real, "glGetShaderiv");
    if (what == GL_COMPILE_STATUS && fails(what))
        *value = 0;
    else
        real(shader, what, value);
}

static void APIENTRY get_program_iv(GLuint program, GLenum what, GLint *value) {
    DRIVER(PFNGLGETPROGRAMIVPROC, real, "glGetProgramiv");
    if (what == GL_LINK_STATUS && fails(what))
        *value = 0;
    else
        real(program, what, value);
}

static void APIENTRY read_pixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format,
                                 GLenum type, void *data) {
    DRIVER(PFNGLREADPIXELSPROC, real, "glReadPixels");
    if (fails(GL_INVALID_OPERATION))
        gl_wrap.error = GL_INVALID_OPERATION;
    else
        real(x, y, width, height, format, type, data);
}

static GLenum APIENTRY get_graphics_reset_status(void) {
    DRIVER(PFNGLGETGRAPHICSRESETSTATUSPROC, real, "glGetGraphicsResetStatus");
    if (gl_wrap.lost || fails(GL_GUILTY_CONTEXT_RESET))
        return GL_GUILTY_CONTEXT_RESET;
    return real();
}

/* ------------------------------------------------------------------------------- what is alive */

#define COUNTED(function, name, sign)                                                              \
    static void APIENTRY function(GLsizei count, GLuint *names) {                                  \
        GLsizei i;                                                                                 \
        DRIVER(PFNGLGENTEXTURESPROC, real, name);                                                  \
        for (i = 0; sign < 0 && i < count; i++)                                                    \
            gl_wrap.live -= names[i] != 0;                                                         \
        real(count, names);                                                                        \
        gl_wrap.live += sign > 0 ? count : 0;                                                      \
    }
COUNTED(gen_buffers, "glGenBuffers", 1)
COUNTED(gen_framebuffers, "glGenFramebuffers", 1)
COUNTED(gen_samplers, "glGenSamplers", 1)
COUNTED(gen_textures, "glGenTextures", 1)
COUNTED(gen_vertex_arrays, "glGenVertexArrays", 1)
COUNTED(delete_buffers, "glDeleteBuffers", -1)
COUNTED(delete_framebuffers, "glDeleteFramebuffers", -1)
COUNTED(delete_samplers, "glDeleteSamplers", -1)
COUNTED(delete_textures, "glDeleteTextures", -1)
COUNTED(delete_vertex_arrays, "glDeleteVertexArrays", -1)

static GLuint APIENTRY create_shader(GLenum type) {
    DRIVER(PFNGLCREATESHADERPROC, real, "glCreateShader");
    gl_wrap.live++;
    return real(type);
}

static GLuint APIENTRY create_program(void) {
    DRIVER(PFNGLCREATEPROGRAMPROC, real, "glCreateProgram");
    gl_wrap.live++;
    return real();
}

static void APIENTRY delete_shader(GLuint shader) {
    DRIVER(PFNGLDELETESHADERPROC, real, "glDeleteShader");
    gl_wrap.live -= shader != 0;
    real(shader);
}

static void APIENTRY delete_program(GLuint program) {
    DRIVER(PFNGLDELETEPROGRAMPROC, real, "glDeleteProgram");
    gl_wrap.live -= program != 0;
    real(program);
}

/* -------------------------------------------------------------------------------- what there is */

static void APIENTRY get_integer_v(GLenum what, GLint *values) {
    DRIVER(PFNGLGETINTEGERVPROC, real, "glGetIntegerv");
    int version = gl_wrap.version ? gl_wrap.version : gl_wrap.floor ? 33 : 0;
    real(what, values);
    if (what == GL_MAJOR_VERSION && version)
        *values = version / 10;
    if (what == GL_MINOR_VERSION && version)
        *values = version % 10;
    if (what == GL_NUM_EXTENSIONS && gl_wrap.floor)
        *values = 0;
}

static const char *const missing_at_the_floor[] = {
    "glBlendEquationSeparatei", "glBlendFuncSeparatei", "glClipControl",
    "glDepthRangeIndexed",      "glGetDoublei_v",       "glViewportIndexedf",
    "glGetGraphicsResetStatus"};

typedef void (*any_function)(void);
static const struct {
    const char *name;
    any_function function;
} wrapped[] = {
    {"glGetError", (any_function)get_error},
    {"glTexImage2D", (any_function)tex_image_2d},
    {"glBufferData", (any_function)buffer_data},
    {"glLinkProgram", (any_function)link_program},
    {"glCheckFramebufferStatus", (any_function)check_framebuffer_status},
    {"glGetShaderiv", (any_function)get_shader_iv},
    {"glGetProgramiv", (any_function)get_program_iv},
    {"glReadPixels", (any_function)read_pixels},
    {"glGetGraphicsResetStatus", (any_function)get_graphics_reset_status},
    {"glGenBuffers", (any_function)gen_buffers},
    {"glGenFramebuffers", (any_function)gen_framebuffers},
    {"glGenSamplers", (any_function)gen_samplers},
    {"glGenTextures", (any_function)gen_textures},
    {"glGenVertexArrays", (any_function)gen_vertex_arrays},
    {"glDeleteBuffers", (any_function)delete_buffers},
    {"glDeleteFramebuffers", (any_function)delete_framebuffers},
    {"glDeleteSamplers", (any_function)delete_samplers},
    {"glDeleteTextures", (any_function)delete_textures},
    {"glDeleteVertexArrays", (any_function)delete_vertex_arrays},
    {"glCreateShader", (any_function)create_shader},
    {"glCreateProgram", (any_function)create_program},
    {"glDeleteShader", (any_function)delete_shader},
    {"glDeleteProgram", (any_function)delete_program},
    {"glGetIntegerv", (any_function)get_integer_v},
};

void *gl_wrap_proc(const char *name, void *user) {
    void *found = host_gl_get_proc(name, user);
    size_t i;
    if (++gl_wrap.procs == gl_wrap.fail_proc)
        return NULL;
    for (i = 0; gl_wrap.floor && i < sizeof missing_at_the_floor / sizeof *missing_at_the_floor;
         i++)
        if (strcmp(name, missing_at_the_floor[i]) == 0)
            return NULL;
    for (i = 0; i < sizeof wrapped / sizeof *wrapped; i++)
        if (found && strcmp(name, wrapped[i].name) == 0)
            memcpy(&found, &wrapped[i].function, sizeof found);
    return found;
}

int gl_wrap_open(void) {
    char error[HOST_ERROR_SIZE];
    const char *expected = getenv("LINEAO_EXPECT_GPU");
    if (host_gl_open(NULL, &host, error))
        return 1;
    print_message("no OpenGL here: %s\n", error);
    assert_false(expected && strcmp(expected, "1") == 0);
    return 0;
}

void gl_wrap_close(void) {
    host_gl_close(host);
    host = NULL;
}
