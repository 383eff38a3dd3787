#include "host_gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct host_gl {
    EGLDisplay display;
    EGLContext context;
    char version[128], renderer[128];
};

static bool fail(char *error, const char *what) {
    if (error)
        snprintf(error, HOST_ERROR_SIZE, "OpenGL: %s (EGL 0x%04X)", what, (unsigned)eglGetError());
    return false;
}

/* ISO C has no cast between functions and objects; POSIX promises that the bits are the same. */
void *host_gl_get_proc(const char *name, void *user) {
    (void)user;
    __eglMustCastToProperFunctionPointerType function = eglGetProcAddress(name);
    void *pointer = NULL;
    memcpy(&pointer, &function, sizeof pointer);
    return pointer;
}

static EGLDisplay open_display(void) {
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    if (!get_display)
        return EGL_NO_DISPLAY;
    return get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
}

static EGLContext make_context(EGLDisplay display, int major, int minor, bool debug) {
    const EGLint wanted[] = {
        EGL_CONTEXT_MAJOR_VERSION,
        major,
        EGL_CONTEXT_MINOR_VERSION,
        minor,
        EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        EGL_CONTEXT_OPENGL_DEBUG,
        debug ? EGL_TRUE : EGL_FALSE,
        EGL_NONE,
    };
    return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
}

static bool describe(host_gl *host, char *error) {
    PFNGLGETSTRINGPROC get_string = (PFNGLGETSTRINGPROC)eglGetProcAddress("glGetString");
    const GLubyte *version = get_string ? get_string(GL_VERSION) : NULL;
    const GLubyte *renderer = version ? get_string(GL_RENDERER) : NULL;
    if (!renderer)
        return fail(error, "the context does not tell its version");
    snprintf(host->version, sizeof host->version, "%s", (const char *)version);
    snprintf(host->renderer, sizeof host->renderer, "%s", (const char *)renderer);
    return true;
}

static bool open_context(host_gl *host, const host_gl_desc *desc, char *error) {
    static const int best[][2] = {{4, 5}, {3, 3}};
    bool told = desc && desc->major > 0, debug = desc && desc->debug;
    host->display = open_display();
    if (host->display == EGL_NO_DISPLAY)
        return fail(error, "no surfaceless display");
    if (!eglInitialize(host->display, NULL, NULL))
        return fail(error, "EGL does not start");
    if (!eglBindAPI(EGL_OPENGL_API))
        return fail(error, "EGL is without desktop OpenGL");
    for (int i = 0; i < (told ? 1 : 2) && host->context == EGL_NO_CONTEXT; i++) {
        host->context = make_context(host->display, told ? desc->major : best[i][0],
                                     told ? desc->minor : best[i][1], debug);
    }
    if (host->context == EGL_NO_CONTEXT)
        return fail(error, "no core context of that version");
    if (!host_gl_make_current(host))
        return fail(error, "the context can not be made current");
    return describe(host, error);
}

bool host_gl_open(const host_gl_desc *desc, host_gl **out, char error[HOST_ERROR_SIZE]) {
    host_gl *host = calloc(1, sizeof *host);
    if (!host)
        return fail(error, "out of memory");
    host->display = EGL_NO_DISPLAY;
    host->context = EGL_NO_CONTEXT;
    if (!open_context(host, desc, error)) {
        host_gl_close(host);
        return false;
    }
    *out = host;
    return true;
}

/* The display is one per process and not counted, so eglTerminate would pull it from under other
 * hosts; it stays. What belongs to the thread goes. */
void host_gl_close(host_gl *host) {
    if (!host)
        return;
    if (host->context != EGL_NO_CONTEXT) {
        if (eglGetCurrentContext() == host->context) {
            eglMakeCurrent(host->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        }
        eglDestroyContext(host->display, host->context);
    }
    free(host);
}

bool host_gl_make_current(host_gl *host) {
    return eglMakeCurrent(host->display, EGL_NO_SURFACE, EGL_NO_SURFACE, host->context) == EGL_TRUE;
}

bool host_gl_is_software(const host_gl *host) {
    static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "SwiftShader"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strstr(host->renderer, names[i]))
            return true;
    }
    return false;
}

const char *host_gl_version(const host_gl *host) {
    return host->version;
}

const char *host_gl_renderer(const host_gl *host) {
    return host->renderer;
}
