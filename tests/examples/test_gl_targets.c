/* Proves that OpenGL hosts get the same picture in every kind of target: texture, renderbuffer and
 * framebuffer, either row order, and sRGB images with LAO_HOST_ENCODE_SRGB; and that alpha 0 of the
 * background keeps what the target holds. Framebuffer 0 does not exist without a surface. */
#include "host_gl.h"
#include "lineao.h"

#include <GL/glcorearb.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 96, HEIGHT = 64, SIZE = WIDTH * HEIGHT * 4, POINTS = 40, LINES = 24 };

/* clang-format off */
#define GL_FUNCTIONS(X)                                                                            \
    X(GenTextures, GENTEXTURES) X(BindTexture, BINDTEXTURE) X(TexImage2D, TEXIMAGE2D)              \
    X(GenRenderbuffers, GENRENDERBUFFERS) X(BindRenderbuffer, BINDRENDERBUFFER)                    \
    X(RenderbufferStorage, RENDERBUFFERSTORAGE) X(GenFramebuffers, GENFRAMEBUFFERS)                \
    X(BindFramebuffer, BINDFRAMEBUFFER) X(FramebufferTexture2D, FRAMEBUFFERTEXTURE2D)              \
    X(FramebufferRenderbuffer, FRAMEBUFFERRENDERBUFFER) X(ClearBufferfv, CLEARBUFFERFV)            \
    X(ReadPixels, READPIXELS) X(GetError, GETERROR) X(DrawBuffers, DRAWBUFFERS)
/* clang-format on */

static struct gl_functions {
#define GL_MEMBER(name, NAME) PFNGL##NAME##PROC name;
    GL_FUNCTIONS(GL_MEMBER)
#undef GL_MEMBER
} gl;

/* One kind of target: a colour image, and the framebuffer that this test clears and reads with. */
typedef struct target {
    GLuint texture, renderbuffer, framebuffer;
    uint32_t kind, flags;
    GLenum internal;
} target;

typedef struct fixture {
    host_gl *host;
    lao_context *context;
    lao_frame frame;
    lao_set set;
} fixture;

static void on_log(void *user, lao_log_item item, lao_result result, const char *text) {
    (void)user, (void)item, (void)result;
    print_error("lineao: %s\n", text);
}

static void load(void) {
    void *address;
#define GL_LOAD(name, NAME)                                                                        \
    address = host_gl_get_proc("gl" #name, NULL);                                                  \
    assert_non_null(address);                                                                      \
    memcpy(&gl.name, &address, sizeof address);
    GL_FUNCTIONS(GL_LOAD)
#undef GL_LOAD
}

/* Arcs that fill about half of the picture. */
static lao_lines make_lines(lao_context *context) {
    static float points[LINES * POINTS][3];
    static uint32_t offsets[LINES + 1];
    lao_lines_desc desc = {LINES, LINES * POINTS, offsets, points[0], .color = {0}};
    lao_lines lines;
    for (uint32_t i = 0; i < LINES * POINTS; i++) {
        double t = 3.0 * (i % POINTS) / (POINTS - 1), r = 4 + 0.9 * (i / POINTS);
        points[i][0] = (float)(r * cos(t + 0.2 * (i / POINTS)));
        points[i][1] = (float)(r * sin(t) - 6);
        points[i][2] = (float)(3 * sin(2 * t + i / POINTS));
        offsets[i / POINTS + 1] = i + 1;
    }
    assert_int_equal(lao_lines_create(context, &desc, &lines), LAO_OK);
    return lines;
}

static int setup(void **state) {
    static fixture f;
    static const float view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -60, 1};
    static const float lens[16] = {
        3.0f * HEIGHT / WIDTH, 0, 0, 0, 0, 3, 0, 0, 0, 0, -2, -1, 0, 0, -120, 0};
    lao_gl_desc desc = {.get_proc = host_gl_get_proc};
    lao_backend backend;
    lao_desc context = {.backend = &backend, .logger = {on_log, NULL}};
    lao_view_desc size = {WIDTH, HEIGHT, 0};
    memset(&f, 0, sizeof f);
    if (!host_gl_open(NULL, &f.host, NULL) || lao_gl_backend(&desc, &backend) ||
        lao_create(&context, &f.context) || lao_view_create(f.context, &size, &f.frame.view))
        return -1;
    load();
    f.set.lines = make_lines(f.context);
    f.frame.sets = &f.set;
    f.frame.set_count = 1;
    memcpy(f.frame.camera.view, view, sizeof view);
    memcpy(f.frame.camera.projection, lens, sizeof lens);
    *state = &f;
    return 0;
}

static int teardown(void **state) {
    fixture *f = (fixture *)*state;
    lao_destroy(f->context);
    host_gl_close(f->host);
    return 0;
}

static target make_target(uint32_t kind, GLenum internal, uint32_t flags) {
    target t = {.kind = kind, .flags = flags, .internal = internal};
    gl.GenFramebuffers(1, &t.framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, t.framebuffer);
    if (kind == LAO_HOST_RENDERBUFFER) {
        gl.GenRenderbuffers(1, &t.renderbuffer);
        gl.BindRenderbuffer(GL_RENDERBUFFER, t.renderbuffer);
        gl.RenderbufferStorage(GL_RENDERBUFFER, internal, WIDTH, HEIGHT);
        gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                   t.renderbuffer);
    } else {
        gl.GenTextures(1, &t.texture);
        gl.BindTexture(GL_TEXTURE_2D, t.texture);
        gl.TexImage2D(GL_TEXTURE_2D, 0, (GLint)internal, WIDTH, HEIGHT, 0, GL_RGBA,
                      GL_UNSIGNED_BYTE, NULL);
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, t.texture, 0);
    }
    return t;
}

/* Clears the target to blue, renders into it and reads it; the host's framebuffer stays bound. */
static void render(fixture *f, const target *t, float alpha, uint8_t pixels[SIZE]) {
    static const float blue[4] = {0, 0, 1, 1};
    lao_image *image = &f->frame.target;
    gl.BindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
    gl.ClearBufferfv(GL_COLOR, 0, blue);
    memset(image, 0, sizeof *image);
    image->present = 1;
    image->native = t->kind == LAO_HOST_FRAMEBUFFER    ? t->framebuffer
                    : t->kind == LAO_HOST_RENDERBUFFER ? t->renderbuffer
                                                       : t->texture;
    image->kind = t->kind;
    image->flags = t->flags;
    image->native_format = t->internal;
    image->width = WIDTH;
    image->height = HEIGHT;
    for (int i = 0; i < 3; i++)
        f->frame.background[i] = 0.25f * (float)(i + 1);
    f->frame.background[3] = alpha;
    assert_int_equal(lao_render(f->context, &f->frame), LAO_OK);
    gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
}

static int largest_difference(const uint8_t a[SIZE], const uint8_t b[SIZE]) {
    int largest = 0;
    for (int i = 0; i < SIZE; i++)
        largest = abs(a[i] - b[i]) > largest ? abs(a[i] - b[i]) : largest;
    return largest;
}

static void test_kinds(void **state) {
    static uint8_t first[SIZE], other[SIZE];
    fixture *f = (fixture *)*state;
    static const uint32_t kinds[3] = {LAO_HOST_TEXTURE, LAO_HOST_RENDERBUFFER,
                                      LAO_HOST_FRAMEBUFFER};
    int lines = 0;
    for (int alpha = 0; alpha < 2; alpha++) {
        for (int k = 0; k < 3; k++) {
            target t = make_target(kinds[k], GL_RGBA8, 0);
            render(f, &t, (float)alpha, k ? other : first);
            if (k)
                assert_memory_equal(first, other, SIZE);
        }
        /* the corner is background: ours, or the blue of the target */
        const uint8_t ours[4] = {64, 128, 191, 255}, kept[4] = {0, 0, 255, 255};
        assert_memory_equal(first, alpha ? ours : kept, 4);
    }
    for (int i = 0; i < SIZE; i += 4)
        lines += memcmp(first + i, first, 4) != 0;
    assert_in_range(lines, WIDTH * HEIGHT / 5, WIDTH * HEIGHT);
}

static void test_top_down(void **state) {
    static uint8_t up[SIZE], down[SIZE];
    fixture *f = (fixture *)*state;
    target t = make_target(LAO_HOST_TEXTURE, GL_RGBA8, 0);
    render(f, &t, 1, up);
    t.flags = LAO_HOST_TOP_DOWN;
    render(f, &t, 1, down);
    for (int y = 0; y < HEIGHT; y++)
        assert_memory_equal(up + (size_t)y * WIDTH * 4, down + (size_t)(HEIGHT - 1 - y) * WIDTH * 4,
                            WIDTH * 4);
}

/* An sRGB image encodes what is written; we decode before, so that its bytes are the display values
 * again, up to one step of rounding. */
static void test_srgb(void **state) {
    static uint8_t plain[SIZE], encoded[SIZE];
    fixture *f = (fixture *)*state;
    static const uint32_t kinds[3] = {LAO_HOST_TEXTURE, LAO_HOST_RENDERBUFFER,
                                      LAO_HOST_FRAMEBUFFER};
    target t = make_target(LAO_HOST_TEXTURE, GL_RGBA8, 0);
    render(f, &t, 1, plain);
    for (int k = 0; k < 3; k++) {
        t = make_target(kinds[k], GL_SRGB8_ALPHA8, LAO_HOST_ENCODE_SRGB);
        render(f, &t, 1, encoded);
        assert_in_range(largest_difference(plain, encoded), 0, 1);
        t = make_target(kinds[k], GL_SRGB8_ALPHA8, 0); /* written as it is, without encoding */
        render(f, &t, 1, encoded);
        assert_memory_equal(plain, encoded, SIZE);
    }
}

/* A framebuffer of the host may draw to its second attachment only. */
static void test_draw_buffers(void **state) {
    static uint8_t plain[SIZE], second[SIZE];
    static const GLenum buffers[1] = {GL_COLOR_ATTACHMENT1};
    fixture *f = (fixture *)*state;
    target t = make_target(LAO_HOST_FRAMEBUFFER, GL_RGBA8, 0), moved = t;
    render(f, &t, 1, plain);
    moved.framebuffer = make_target(LAO_HOST_FRAMEBUFFER, GL_RGBA8, 0).framebuffer;
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 0, 0);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, t.texture, 0);
    gl.DrawBuffers(1, buffers);
    PFNGLREADBUFFERPROC read_buffer;
    void *address = host_gl_get_proc("glReadBuffer", NULL);
    memcpy(&read_buffer, &address, sizeof address);
    read_buffer(GL_COLOR_ATTACHMENT1);
    render(f, &moved, 1, second);
    assert_memory_equal(plain, second, SIZE);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kinds),
                                       cmocka_unit_test(test_top_down), cmocka_unit_test(test_srgb),
                                       cmocka_unit_test(test_draw_buffers)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
