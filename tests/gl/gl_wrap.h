/* A layer between the executor and the driver: hides features, injects faults, counts what is
   alive. GL functions carry no user pointer, so the layer is one global, for tests alone. */
#ifndef GL_WRAP_H
#define GL_WRAP_H

struct gl_wrap {
    int floor;        /* pretend to be OpenGL 3.3 without extensions */
    int version;      /* major * 10 + minor to report; 0: the driver's, or 33 with `floor` */
    int fail_proc;    /* the n-th name asked for is not found; 0: none */
    int fail_call;    /* the n-th call that can fail does; 0: none */
    int procs, calls; /* counted since gl_wrap_reset */
    int failed;       /* what fail_call hit, a GL enum; 0: nothing */
    int linked;       /* programs */
    int live;         /* names generated and not deleted */
    int lost;         /* glGetGraphicsResetStatus reports a reset */
    unsigned error;   /* pending */
};
extern struct gl_wrap gl_wrap;

/* All zero but `live`. */
void gl_wrap_reset(void);
/* lao_gl_desc.get_proc. */
void *gl_wrap_proc(const char *name, void *user);

/* A fresh context, current. Returns 0 where there is none; then the test skips, or fails where a
 * GPU is expected. */
int gl_wrap_open(void);
void gl_wrap_close(void);

#endif
