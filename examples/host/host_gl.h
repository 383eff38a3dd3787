/* A real OpenGL host without a window: an EGL surfaceless context, current on this thread. */
#ifndef LINEAO_HOST_GL_H
#define LINEAO_HOST_GL_H

#include <stdbool.h>

enum { HOST_ERROR_SIZE = 256 };

typedef struct host_gl_desc {
    int major, minor; /* core profile version; 0, 0: the best of 4.5 and 3.3 */
    bool debug;       /* ask for a debug context */
} host_gl_desc;

typedef struct host_gl host_gl;

/* Opens a context and makes it current. desc may be NULL. False: one line in error (may be NULL).
 * Thread: the context stays with the calling thread; any number of hosts on any threads. */
bool host_gl_open(const host_gl_desc *desc, host_gl **out, char error[HOST_ERROR_SIZE]);

/* Closes the context; fine on NULL. Thread: the one that opened it. */
void host_gl_close(host_gl *host);

/* Makes the context current again, after another one was. */
bool host_gl_make_current(host_gl *host);

/* eglGetProcAddress, in the shape of lineao's loader hook; user is not used and may be NULL. */
void *host_gl_get_proc(const char *name, void *user);

/* A software rasteriser (llvmpipe, softpipe, swrast)? */
bool host_gl_is_software(const host_gl *host);

/* GL_VERSION and GL_RENDERER; valid until host_gl_close. */
const char *host_gl_version(const host_gl *host);
const char *host_gl_renderer(const host_gl *host);

#endif
