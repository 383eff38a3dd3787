/* The OpenGL host. lineao gets a loader and, in each frame, two textures of ours. */
#include "window.h"

#include "../host_depth_shaders.h"
#include "ground_shaders.h"
#include "report.h"
#include "ui.h"

#include <GL/glcorearb.h>
#include <stdlib.h>
#include <string.h>

/* clang-format off */
#define FUNCTIONS(X)                                                                               \
    X(CreateShader, CREATESHADER) X(ShaderSource, SHADERSOURCE) X(CompileShader, COMPILESHADER)    \
    X(CreateProgram, CREATEPROGRAM) X(AttachShader, ATTACHSHADER) X(LinkProgram, LINKPROGRAM)      \
    X(DeleteShader, DELETESHADER) X(DeleteProgram, DELETEPROGRAM)                                  \
    X(GetProgramiv, GETPROGRAMIV) X(UseProgram, USEPROGRAM)                                        \
    X(GetUniformLocation, GETUNIFORMLOCATION) X(UniformMatrix4fv, UNIFORMMATRIX4FV)                \
    X(Uniform4fv, UNIFORM4FV) X(GenVertexArrays, GENVERTEXARRAYS)                                  \
    X(DeleteVertexArrays, DELETEVERTEXARRAYS) X(BindVertexArray, BINDVERTEXARRAY)                  \
    X(GenTextures, GENTEXTURES) X(DeleteTextures, DELETETEXTURES) X(BindTexture, BINDTEXTURE)      \
    X(TexImage2D, TEXIMAGE2D) X(GenFramebuffers, GENFRAMEBUFFERS)                                  \
    X(DeleteFramebuffers, DELETEFRAMEBUFFERS) X(BindFramebuffer, BINDFRAMEBUFFER)                  \
    X(FramebufferTexture2D, FRAMEBUFFERTEXTURE2D) X(BlitFramebuffer, BLITFRAMEBUFFER)              \
    X(Viewport, VIEWPORT) X(ClearColor, CLEARCOLOR) X(ClearDepth, CLEARDEPTH) X(Clear, CLEAR)      \
    X(Enable, ENABLE) X(Disable, DISABLE) X(DepthFunc, DEPTHFUNC) X(DepthMask, DEPTHMASK)          \
    X(BlendFunc, BLENDFUNC) X(DrawArrays, DRAWARRAYS) X(GetError, GETERROR) X(Finish, FINISH)      \
    X(PixelStorei, PIXELSTOREI)
/* clang-format on */

typedef struct gl_slot {
    GLuint color, depth, framebuffer; /* depth 0: not a canvas */
    uint32_t width, height;
} gl_slot;

typedef struct window_gl {
#define MEMBER(name, NAME) PFNGL##NAME##PROC name;
    FUNCTIONS(MEMBER)
#undef MEMBER
    GLuint box, ground, vertices;
    gl_slot slots[SLOT_COUNT];
} window_gl;

static void *get_proc(const char *name, void *user) {
    GLFWglproc function = glfwGetProcAddress(name);
    void *address;
    (void)user;
    memcpy(&address, &function, sizeof address);
    return address;
}

static bool load(window_gl *gl) {
    const char *missing = NULL;
    void *address;
#define LOAD(name, NAME)                                                                           \
    address = get_proc("gl" #name, NULL);                                                          \
    missing = address ? missing : "gl" #name;                                                      \
    memcpy(&gl->name, &address, sizeof address);
    FUNCTIONS(LOAD)
#undef LOAD
    return !missing || cli_fail("gl: the driver has no function %s", missing);
}

/* ---- the host's own shaders -------------------------------------------------------------- */

static GLuint make_program(const window_gl *gl, const char *body) {
    static const char *const heads[2] = {"#version 330 core\n#define VERTEX\n",
                                         "#version 330 core\n"};
    GLuint program = gl->CreateProgram();
    GLint linked = 0;
    for (int i = 0; i < 2; i++) {
        const char *text[2] = {heads[i], body};
        GLuint shader = gl->CreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        gl->ShaderSource(shader, 2, text, NULL);
        gl->CompileShader(shader);
        gl->AttachShader(program, shader);
        gl->DeleteShader(shader); /* goes with the program */
    }
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
    return linked ? program : 0;
}

/* Depth 0 .. w becomes OpenGL's -w .. w, so that the depth buffer holds what it was. */
static void set_clip(const window_gl *gl, GLuint program, const char *name, const float from[16]) {
    float clip[16];
    memcpy(clip, from, sizeof clip);
    for (int column = 0; column < 4; column++)
        clip[4 * column + 2] = 2 * clip[4 * column + 2] - clip[4 * column + 3];
    gl->UniformMatrix4fv(gl->GetUniformLocation(program, name), 1, GL_FALSE, clip);
}

static void set_vector(const window_gl *gl, GLuint program, const char *name, const float *v) {
    gl->Uniform4fv(gl->GetUniformLocation(program, name), 1, v);
}

/* ---- life -------------------------------------------------------------------------------- */

static GLFWwindow *make_window(const window *w, const char *title, int width, int height) {
    static const int versions[2][2] = {{4, 5}, {3, 3}};
    GLFWwindow *made = NULL;
    for (int i = 0; i < 2 && !made; i++) {
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, versions[i][0]);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, versions[i][1]);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
        glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, w->debug);
        glfwWindowHint(GLFW_DEPTH_BITS, 0); /* the canvases have their own */
        glfwWindowHint(GLFW_STENCIL_BITS, 0);
        made = glfwCreateWindow(width, height, title, NULL, NULL);
    }
    return made;
}

static bool open(window *w, const char *title, int width, int height) {
    w->gl = cli_new(1, sizeof *w->gl);
    w->glfw = w->gl ? make_window(w, title, width, height) : NULL;
    if (!w->glfw)
        return cli_fail("gl: no window with OpenGL 3.3; is there a display?");
    memset(w->gl, 0, sizeof *w->gl);
    glfwMakeContextCurrent(w->glfw);
    glfwSwapInterval(w->vsync);
    if (!load(w->gl))
        return false;
    w->gl->box = make_program(w->gl, host_depth_glsl);
    w->gl->ground = make_program(w->gl, ground_glsl);
    w->gl->GenVertexArrays(1, &w->gl->vertices);
    return (w->gl->box && w->gl->ground) || cli_fail("gl: a shader of the viewer was refused");
}

static void free_slot(const window_gl *gl, gl_slot *slot) {
    gl->DeleteFramebuffers(1, &slot->framebuffer);
    gl->DeleteTextures(1, &slot->color);
    gl->DeleteTextures(1, &slot->depth);
    memset(slot, 0, sizeof *slot);
}

static void close(window *w) {
    if (w->gl && w->gl->vertices) {
        for (int i = 0; i < SLOT_COUNT; i++)
            free_slot(w->gl, &w->gl->slots[i]);
        w->gl->DeleteProgram(w->gl->box);
        w->gl->DeleteProgram(w->gl->ground);
        w->gl->DeleteVertexArrays(1, &w->gl->vertices);
    }
    if (w->glfw)
        glfwDestroyWindow(w->glfw);
    free(w->gl);
    w->gl = NULL;
    w->glfw = NULL;
}

static double now(void *user) {
    (void)user;
    return glfwGetTime();
}

/* quote lend */
static bool lend(window *w, lao_backend *out) {
    lao_gl_desc desc;
    (void)w;
    memset(&desc, 0, sizeof desc);
    desc.get_proc = get_proc;
    desc.now = now;
    return lao_gl_backend(&desc, out) == LAO_OK || cli_fail("gl: the backend refused its context");
}
/* quote end */

/* ---- frames ------------------------------------------------------------------------------ */

static bool begin(window *w) {
    const float *gray = ui_background();
    glfwGetFramebufferSize(w->glfw, &w->width, &w->height);
    if (w->width <= 0 || w->height <= 0)
        return false;
    w->gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
    w->gl->ClearColor(gray[0], gray[1], gray[2], 1);
    w->gl->Clear(GL_COLOR_BUFFER_BIT);
    return true;
}

static GLuint make_texture(const window_gl *gl, GLint internal, GLenum format, GLenum type,
                           uint32_t width, uint32_t height, const void *pixels) {
    GLuint texture;
    gl->GenTextures(1, &texture);
    gl->BindTexture(GL_TEXTURE_2D, texture);
    gl->TexImage2D(GL_TEXTURE_2D, 0, internal, (GLsizei)width, (GLsizei)height, 0, format, type,
                   pixels);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    return texture;
}

static void make_slot(const window_gl *gl, gl_slot *slot, uint32_t width, uint32_t height,
                      bool depth, const void *pixels) {
    free_slot(gl, slot);
    slot->width = width;
    slot->height = height;
    slot->color = make_texture(gl, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, width, height, pixels);
    gl->GenFramebuffers(1, &slot->framebuffer);
    gl->BindFramebuffer(GL_FRAMEBUFFER, slot->framebuffer);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, slot->color, 0);
    if (depth) {
        slot->depth = make_texture(gl, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, width,
                                   height, NULL);
        gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, slot->depth,
                                 0);
    }
}

/* State of the host's own drawing; what lineao and the user interface change they put back. */
static void begin_drawing(const window_gl *gl, const gl_slot *slot, GLuint program) {
    gl->BindFramebuffer(GL_FRAMEBUFFER, slot->framebuffer);
    gl->Viewport(0, 0, (GLsizei)slot->width, (GLsizei)slot->height);
    gl->Enable(GL_DEPTH_TEST);
    gl->Enable(GL_DEPTH_CLAMP); /* the camera's depth range is the scene's, not the ground's */
    gl->DepthFunc(GL_LEQUAL);
    gl->BindVertexArray(gl->vertices);
    gl->UseProgram(program);
}

static void end_drawing(const window_gl *gl) {
    gl->UseProgram(0);
    gl->BindVertexArray(0);
    gl->Disable(GL_DEPTH_CLAMP);
    gl->Disable(GL_DEPTH_TEST);
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
}

/* quote images */
static lao_image lend_texture(GLuint name, const gl_slot *slot) {
    lao_image image;
    memset(&image, 0, sizeof image);
    image.native = name;
    image.width = slot->width;
    image.height = slot->height;
    image.present = 1;
    return image;
}
/* quote end */

static bool canvas(window *w, int index, uint32_t width, uint32_t height, const float paper[4],
                   const window_box *boxes, int count, lao_image *color, lao_image *depth,
                   void **commands) {
    window_gl *gl = w->gl;
    gl_slot *slot = &gl->slots[index];
    if (slot->width != width || slot->height != height)
        make_slot(gl, slot, width, height, true, NULL);
    begin_drawing(gl, slot, gl->box);
    gl->ClearColor(paper[0], paper[1], paper[2], 1);
    gl->ClearDepth(1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    for (int i = 0; i < count; i++) {
        set_clip(gl, gl->box, "box.clip", boxes[i].clip);
        set_vector(gl, gl->box, "box.lower", boxes[i].lower);
        set_vector(gl, gl->box, "box.upper", boxes[i].upper);
        set_vector(gl, gl->box, "box.color", boxes[i].color);
        gl->DrawArrays(GL_TRIANGLES, 0, 36);
    }
    end_drawing(gl);
    *color = lend_texture(slot->color, slot);
    *depth = lend_texture(slot->depth, slot);
    depth->flags = LAO_HOST_WRITABLE;
    *commands = NULL;
    return gl->GetError() == GL_NO_ERROR || cli_fail("gl: no memory for a picture of that size");
}

static void ground(window *w, int index, const window_ground *g) {
    const window_gl *gl = w->gl;
    begin_drawing(gl, &gl->slots[index], gl->ground);
    gl->DepthMask(GL_FALSE);
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    set_clip(gl, gl->ground, "ground.clip", g->clip);
    set_vector(gl, gl->ground, "ground.middle", g->middle);
    set_vector(gl, gl->ground, "ground.right", g->right);
    set_vector(gl, gl->ground, "ground.up", g->up);
    set_vector(gl, gl->ground, "ground.color", g->color);
    gl->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    gl->Disable(GL_BLEND);
    gl->DepthMask(GL_TRUE);
    end_drawing(gl);
}

static void drop(window *w) {
    (void)w; /* commands of OpenGL are drawn as they come */
}

static bool upload(window *w, int index, uint32_t width, uint32_t height, const uint8_t *pixels) {
    window_gl *gl = w->gl;
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    make_slot(gl, &gl->slots[index], width, height, false, pixels);
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
    return gl->GetError() == GL_NO_ERROR || cli_fail("gl: no memory for a picture of that size");
}

/* Row 0 of a canvas is its bottom, that of an uploaded picture its top. */
static void show(window *w, int index, window_rect from, window_rect to) {
    const window_gl *gl = w->gl;
    const gl_slot *slot = &gl->slots[index];
    int height = (int)slot->height;
    bool same = from.width == to.width && from.height == to.height;
    int bottom = slot->depth ? height - from.y - from.height : from.y + from.height;
    int top = slot->depth ? height - from.y : from.y;
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, slot->framebuffer);
    gl->BlitFramebuffer(from.x, bottom, from.x + from.width, top, to.x,
                        w->height - to.y - to.height, to.x + to.width, w->height - to.y,
                        GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
}

static void end(window *w) {
    ui_draw_gl();
    w->messages += w->gl->GetError() != GL_NO_ERROR;
    glfwSwapBuffers(w->glfw);
}

static void wait(window *w) {
    w->gl->Finish();
}

const window_backend window_gl_backend = {"gl",   "OpenGL", open,   close, lend, begin, canvas,
                                          ground, drop,     upload, show,  end,  wait};
