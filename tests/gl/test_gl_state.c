/* Proves: the OpenGL executor leaves no trace (RESTORE), GL's initial values (RESET), and draws the
   same picture whatever state the host left; and the state table has no row too few and none too
   many: without any one of them this test fails. */
#define LAO__GL_SKIPPED(row) ((int)(row) == skipped_row)
static int skipped_row = -1;
#include "lineao_gl.c"

#include "gl_frame.h"
#include "gl_wrap.h"

#include <GL/glcorearb.h>
#include <setjmp.h>
#include <stdlib.h>
#include <cmocka.h>

/* The test's own functions, straight from the driver. */
// clang-format off
#define FUNCTIONS(X) \
    X(PFNGLACTIVETEXTUREPROC, ActiveTexture) X(PFNGLATTACHSHADERPROC, AttachShader) \
    X(PFNGLBEGINQUERYPROC, BeginQuery) X(PFNGLBEGINTRANSFORMFEEDBACKPROC, BeginTransformFeedback) \
    X(PFNGLBINDBUFFERPROC, BindBuffer) X(PFNGLBINDBUFFERBASEPROC, BindBufferBase) \
    X(PFNGLBINDBUFFERRANGEPROC, BindBufferRange) X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer) \
    X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer) X(PFNGLBINDSAMPLERPROC, BindSampler) \
    X(PFNGLBINDTEXTUREPROC, BindTexture) X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray) \
    X(PFNGLBLENDCOLORPROC, BlendColor) X(PFNGLBLENDEQUATIONSEPARATEIPROC, BlendEquationSeparatei) \
    X(PFNGLBLENDFUNCSEPARATEIPROC, BlendFuncSeparatei) X(PFNGLBUFFERDATAPROC, BufferData) \
    X(PFNGLCLAMPCOLORPROC, ClampColor) X(PFNGLCLEARBUFFERFVPROC, ClearBufferfv) \
    X(PFNGLCLEARCOLORPROC, ClearColor) X(PFNGLCLEARDEPTHPROC, ClearDepth) X(PFNGLCLIPCONTROLPROC, ClipControl) \
    X(PFNGLCOLORMASKIPROC, ColorMaski) X(PFNGLCOMPILESHADERPROC, CompileShader) \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram) X(PFNGLCREATESHADERPROC, CreateShader) \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram) X(PFNGLDELETEQUERIESPROC, DeleteQueries) \
    X(PFNGLDEPTHFUNCPROC, DepthFunc) X(PFNGLDEPTHMASKPROC, DepthMask) \
    X(PFNGLDEPTHRANGEINDEXEDPROC, DepthRangeIndexed) X(PFNGLDISABLEPROC, Disable) \
    X(PFNGLDRAWBUFFERSPROC, DrawBuffers) X(PFNGLENABLEPROC, Enable) X(PFNGLENDQUERYPROC, EndQuery) \
    X(PFNGLENDTRANSFORMFEEDBACKPROC, EndTransformFeedback) \
    X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer) \
    X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D) X(PFNGLFRONTFACEPROC, FrontFace) X(PFNGLCULLFACEPROC, CullFace) \
    X(PFNGLGENBUFFERSPROC, GenBuffers) X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers) \
    X(PFNGLGENQUERIESPROC, GenQueries) X(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers) \
    X(PFNGLGENSAMPLERSPROC, GenSamplers) X(PFNGLGENTEXTURESPROC, GenTextures) \
    X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays) X(PFNGLGETDOUBLEI_VPROC, GetDoublei_v) \
    X(PFNGLGETDOUBLEVPROC, GetDoublev) X(PFNGLGETERRORPROC, GetError) \
    X(PFNGLGETINTEGER64I_VPROC, GetInteger64i_v) X(PFNGLGETINTEGERI_VPROC, GetIntegeri_v) \
    X(PFNGLISENABLEDPROC, IsEnabled) X(PFNGLISENABLEDIPROC, IsEnabledi) X(PFNGLLINKPROGRAMPROC, LinkProgram) \
    X(PFNGLLOGICOPPROC, LogicOp) X(PFNGLPIXELSTOREIPROC, PixelStorei) X(PFNGLPOLYGONMODEPROC, PolygonMode) \
    X(PFNGLPOLYGONOFFSETPROC, PolygonOffset) X(PFNGLPRIMITIVERESTARTINDEXPROC, PrimitiveRestartIndex) \
    X(PFNGLPROVOKINGVERTEXPROC, ProvokingVertex) X(PFNGLREADBUFFERPROC, ReadBuffer) \
    X(PFNGLREADPIXELSPROC, ReadPixels) X(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage) \
    X(PFNGLSAMPLECOVERAGEPROC, SampleCoverage) X(PFNGLSAMPLEMASKIPROC, SampleMaski) \
    X(PFNGLSCISSORINDEXEDPROC, ScissorIndexed) X(PFNGLSHADERSOURCEPROC, ShaderSource) \
    X(PFNGLSTENCILFUNCPROC, StencilFunc) X(PFNGLSTENCILMASKPROC, StencilMask) X(PFNGLTEXBUFFERPROC, TexBuffer) \
    X(PFNGLTEXIMAGE2DPROC, TexImage2D) X(PFNGLTRANSFORMFEEDBACKVARYINGSPROC, TransformFeedbackVaryings) \
    X(PFNGLUSEPROGRAMPROC, UseProgram) X(PFNGLVIEWPORTINDEXEDFPROC, ViewportIndexedf)
// clang-format on

static struct {
#define MEMBER(type, name) type name;
    FUNCTIONS(MEMBER)
} gl;

static void load_functions(void) {
    void *found;
#define LOAD(type, name)                                                                           \
    found = gl_wrap_proc("gl" #name, NULL);                                                        \
    memcpy(&gl.name, &found, sizeof found);
    FUNCTIONS(LOAD)
}

enum {
    SIZE = GL_FRAME_SIZE,
    PIXELS = SIZE * SIZE,
    COMPONENTS = 4 * PIXELS,
    UNITS = 32,
    BUFFERS = 8,
    VIEWPORTS = 16
};

/* --------------------------------------------------------------- all state that a host may hold */

typedef struct snapshot {
    int count;
    double values[3000];
    char names[3000][32];
} snapshot;

static void put(snapshot *into, const char *name, unsigned what, unsigned index, int count,
                const double *values) {
    int i;
    for (i = 0; i < count; i++) {
        assert_true(into->count < 3000);
        snprintf(into->names[into->count], sizeof into->names[0], "%s 0x%04x [%u].%d", name, what,
                 index, i);
        into->values[into->count++] = values[i];
    }
}

// clang-format off
static const GLenum toggles[] = {
    GL_BLEND, GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE1, GL_CLIP_DISTANCE2, GL_CLIP_DISTANCE3, GL_CLIP_DISTANCE4,
    GL_CLIP_DISTANCE5, GL_CLIP_DISTANCE6, GL_CLIP_DISTANCE7, GL_COLOR_LOGIC_OP, GL_CULL_FACE, GL_DEPTH_CLAMP,
    GL_DEPTH_TEST, GL_DITHER, GL_FRAMEBUFFER_SRGB, GL_LINE_SMOOTH, GL_MULTISAMPLE, GL_POLYGON_OFFSET_FILL,
    GL_POLYGON_OFFSET_LINE, GL_POLYGON_OFFSET_POINT, GL_POLYGON_SMOOTH, GL_PRIMITIVE_RESTART,
    GL_PRIMITIVE_RESTART_FIXED_INDEX, GL_RASTERIZER_DISCARD, GL_SAMPLE_ALPHA_TO_COVERAGE,
    GL_SAMPLE_ALPHA_TO_ONE, GL_SAMPLE_COVERAGE, GL_SAMPLE_SHADING, GL_SAMPLE_MASK, GL_SCISSOR_TEST,
    GL_STENCIL_TEST, GL_TEXTURE_CUBE_MAP_SEAMLESS, GL_PROGRAM_POINT_SIZE
};
// clang-format on

// clang-format off
static const struct { GLenum what; int count; } values[] = {
    {GL_ACTIVE_TEXTURE, 1}, {GL_ARRAY_BUFFER_BINDING, 1}, {GL_BLEND_COLOR, 4}, {GL_CLAMP_READ_COLOR, 1},
    {GL_CLIP_DEPTH_MODE, 1}, {GL_CLIP_ORIGIN, 1}, {GL_COLOR_CLEAR_VALUE, 4}, {GL_COPY_READ_BUFFER_BINDING, 1},
    {GL_COPY_WRITE_BUFFER_BINDING, 1}, {GL_CULL_FACE_MODE, 1}, {GL_CURRENT_PROGRAM, 1},
    {GL_DEPTH_CLEAR_VALUE, 1}, {GL_DEPTH_FUNC, 1}, {GL_DEPTH_WRITEMASK, 1}, {GL_DRAW_FRAMEBUFFER_BINDING, 1},
    {GL_DRAW_INDIRECT_BUFFER_BINDING, 1}, {GL_FRONT_FACE, 1}, {GL_LINE_WIDTH, 1}, {GL_LOGIC_OP_MODE, 1},
    {GL_PACK_ALIGNMENT, 1}, {GL_PACK_IMAGE_HEIGHT, 1}, {GL_PACK_LSB_FIRST, 1}, {GL_PACK_ROW_LENGTH, 1},
    {GL_PACK_SKIP_IMAGES, 1}, {GL_PACK_SKIP_PIXELS, 1}, {GL_PACK_SKIP_ROWS, 1}, {GL_PACK_SWAP_BYTES, 1},
    {GL_PIXEL_PACK_BUFFER_BINDING, 1}, {GL_PIXEL_UNPACK_BUFFER_BINDING, 1}, {GL_POLYGON_MODE, 2},
    {GL_POLYGON_OFFSET_FACTOR, 1}, {GL_POLYGON_OFFSET_UNITS, 1}, {GL_PRIMITIVE_RESTART_INDEX, 1},
    {GL_PROVOKING_VERTEX, 1}, {GL_READ_BUFFER, 1}, {GL_READ_FRAMEBUFFER_BINDING, 1},
    {GL_RENDERBUFFER_BINDING, 1}, {GL_SAMPLE_COVERAGE_INVERT, 1}, {GL_SAMPLE_COVERAGE_VALUE, 1},
    {GL_STENCIL_FAIL, 1}, {GL_STENCIL_FUNC, 1}, {GL_STENCIL_REF, 1}, {GL_STENCIL_VALUE_MASK, 1},
    {GL_STENCIL_WRITEMASK, 1}, {GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, 1}, {GL_UNIFORM_BUFFER_BINDING, 1},
    {GL_UNPACK_ALIGNMENT, 1}, {GL_UNPACK_IMAGE_HEIGHT, 1}, {GL_UNPACK_LSB_FIRST, 1},
    {GL_UNPACK_ROW_LENGTH, 1}, {GL_UNPACK_SKIP_IMAGES, 1}, {GL_UNPACK_SKIP_PIXELS, 1},
    {GL_UNPACK_SKIP_ROWS, 1}, {GL_UNPACK_SWAP_BYTES, 1}, {GL_VERTEX_ARRAY_BINDING, 1},
    {GL_ELEMENT_ARRAY_BUFFER_BINDING, 1}, {GL_DRAW_BUFFER0, 1}, {GL_DRAW_BUFFER1, 1}, {GL_TEXTURE_BUFFER, 1}
};
// clang-format on

static void take_indexed(snapshot *into) {
    static const GLenum blends[] = {GL_BLEND_SRC_RGB,      GL_BLEND_DST_RGB,
                                    GL_BLEND_SRC_ALPHA,    GL_BLEND_DST_ALPHA,
                                    GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};
    GLuint i, k;
    GLint v[4];
    GLint64 wide;
    double d[4];
    for (i = 0; i < BUFFERS; i++) {
        d[0] = gl.IsEnabledi(GL_BLEND, i);
        put(into, "blend", GL_BLEND, i, 1, d);
        for (k = 0; k < sizeof blends / sizeof *blends; k++) {
            gl.GetIntegeri_v(blends[k], i, v);
            d[0] = v[0];
            put(into, "blend", blends[k], i, 1, d);
        }
        gl.GetIntegeri_v(GL_COLOR_WRITEMASK, i, v);
        for (k = 0; k < 4; k++)
            d[k] = v[k];
        put(into, "mask", GL_COLOR_WRITEMASK, i, 4, d);
        gl.GetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, i, v);
        d[0] = v[0];
        gl.GetInteger64i_v(GL_UNIFORM_BUFFER_START, i, &wide);
        d[1] = (double)wide;
        gl.GetInteger64i_v(GL_UNIFORM_BUFFER_SIZE, i, &wide);
        d[2] = (double)wide;
        put(into, "uniforms", GL_UNIFORM_BUFFER_BINDING, i, 3, d);
    }
    for (i = 0; i < VIEWPORTS; i++) {
        gl.GetDoublei_v(GL_VIEWPORT, i, d);
        put(into, "viewport", GL_VIEWPORT, i, 4, d);
        gl.GetDoublei_v(GL_DEPTH_RANGE, i, d);
        put(into, "depth range", GL_DEPTH_RANGE, i, 2, d);
        gl.GetDoublei_v(GL_SCISSOR_BOX, i, d);
        put(into, "scissor", GL_SCISSOR_BOX, i, 4, d);
        d[0] = gl.IsEnabledi(GL_SCISSOR_TEST, i);
        put(into, "scissor", GL_SCISSOR_TEST, i, 1, d);
    }
}

static void take(snapshot *into) {
    static const GLenum unit[] = {GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_BUFFER,
                                  GL_TEXTURE_BINDING_CUBE_MAP, GL_SAMPLER_BINDING};
    GLint active;
    GLuint i, k;
    double d[4];
    into->count = 0;
    for (i = 0; i < sizeof toggles / sizeof *toggles; i++) {
        d[0] = gl.IsEnabled(toggles[i]);
        put(into, "toggle", toggles[i], 0, 1, d);
    }
    for (i = 0; i < sizeof values / sizeof *values; i++) {
        d[1] = 0;
        gl.GetDoublev(values[i].what, d);
        put(into, "value", values[i].what, 0, values[i].count, d);
    }
    take_indexed(into);
    gl.GetDoublev(GL_ACTIVE_TEXTURE, d);
    active = (GLint)d[0];
    for (i = 0; i < UNITS; i++) {
        gl.ActiveTexture(GL_TEXTURE0 + i);
        for (k = 0; k < sizeof unit / sizeof *unit; k++) {
            gl.GetDoublev(unit[k], d);
            put(into, "unit", unit[k], i, 1, d);
        }
    }
    gl.ActiveTexture((GLenum)active);
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
}

/* How many values differ; says which if told so. */
static int differences(const snapshot *a, const snapshot *b, int say) {
    int i, count = 0;
    assert_int_equal(a->count, b->count);
    for (i = 0; i < a->count; i++) {
        if (a->values[i] == b->values[i])
            continue;
        count++;
        if (say)
            print_message("%s: %g is now %g\n", a->names[i], a->values[i], b->values[i]);
    }
    return count;
}

/* ------------------------------------------------------------------- a host with strange habits */

static struct {
    GLuint buffers[16], textures[4], samplers[2], framebuffers[2], renderbuffer, program, array;
} host;

static GLuint make_program(void) {
    static const char *const vertex[] = {"#version 330 core\nout vec4 t_out; void main()"
                                         " { t_out = vec4(1.0); gl_Position = vec4(0.0); }\n"};
    static const char *const fragment[] = {"#version 330 core\nvoid main() {}\n"};
    static const char *const varying[] = {"t_out"};
    GLuint program = gl.CreateProgram(), shader = gl.CreateShader(GL_VERTEX_SHADER);
    gl.ShaderSource(shader, 1, vertex, NULL);
    gl.CompileShader(shader);
    gl.AttachShader(program, shader);
    shader = gl.CreateShader(GL_FRAGMENT_SHADER);
    gl.ShaderSource(shader, 1, fragment, NULL);
    gl.CompileShader(shader);
    gl.AttachShader(program, shader);
    gl.TransformFeedbackVaryings(program, 1, varying, GL_INTERLEAVED_ATTRIBS);
    gl.LinkProgram(program);
    return program;
}

static void make_objects(void) {
    static const GLenum swapped[] = {GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT0};
    GLuint i;
    gl.GenBuffers(16, host.buffers);
    for (i = 0; i < 16; i++) {
        gl.BindBuffer(GL_COPY_WRITE_BUFFER, host.buffers[i]);
        gl.BufferData(GL_COPY_WRITE_BUFFER, 4096, NULL, GL_STATIC_DRAW);
    }
    gl.BindBuffer(GL_COPY_WRITE_BUFFER, 0);
    gl.GenTextures(4, host.textures);
    for (i = 0; i < 2; i++) {
        gl.BindTexture(GL_TEXTURE_2D, host.textures[i]);
        gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, SIZE, SIZE, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
    }
    gl.BindTexture(GL_TEXTURE_2D, 0);
    gl.BindTexture(GL_TEXTURE_BUFFER, host.textures[2]);
    gl.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA8, host.buffers[15]);
    gl.BindTexture(GL_TEXTURE_BUFFER, 0);
    gl.GenSamplers(2, host.samplers);
    gl.GenRenderbuffers(1, &host.renderbuffer);
    gl.GenFramebuffers(2, host.framebuffers);
    for (i = 0; i < 2; i++) {
        gl.BindFramebuffer(GL_FRAMEBUFFER, host.framebuffers[i]);
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                                host.textures[0], 0);
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D,
                                host.textures[1], 0);
        gl.DrawBuffers(2, swapped);
        gl.ReadBuffer(GL_COLOR_ATTACHMENT1);
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    host.program = make_program();
    gl.GenVertexArrays(1, &host.array);
}

static void be_strange_with_bindings(void) {
    static const GLenum targets[] = {
        GL_ARRAY_BUFFER,      GL_COPY_READ_BUFFER,    GL_COPY_WRITE_BUFFER, GL_DRAW_INDIRECT_BUFFER,
        GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER, GL_TEXTURE_BUFFER};
    GLuint i;
    gl.BindVertexArray(host.array);
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, host.buffers[14]);
    for (i = 0; i < sizeof targets / sizeof *targets; i++)
        gl.BindBuffer(targets[i], host.buffers[i]);
    for (i = 0; i < 6; i++)
        gl.BindBufferRange(GL_UNIFORM_BUFFER, i, host.buffers[7 + i], 256, 512 + 16 * i);
    gl.BindBufferBase(GL_UNIFORM_BUFFER, 1, host.buffers[8]); /* whole: another call to restore */
    gl.BindBuffer(GL_UNIFORM_BUFFER, host.buffers[6]);
    for (i = 0; i < UNITS; i++) {
        gl.ActiveTexture(GL_TEXTURE0 + i);
        gl.BindTexture(GL_TEXTURE_2D, host.textures[i % 2]);
        gl.BindTexture(GL_TEXTURE_BUFFER, host.textures[2]);
        gl.BindTexture(GL_TEXTURE_CUBE_MAP, host.textures[3]);
        gl.BindSampler(i, host.samplers[i % 2]);
    }
    gl.ActiveTexture(GL_TEXTURE0 + UNITS - 2);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, host.framebuffers[0]);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, host.framebuffers[1]);
    gl.BindRenderbuffer(GL_RENDERBUFFER, host.renderbuffer);
    gl.UseProgram(host.program);
}

static void be_strange_with_indexed(void) {
    GLuint i;
    for (i = 0; i < BUFFERS; i++) {
        gl.BlendFuncSeparatei(i, GL_DST_COLOR, GL_ZERO + i % 2, GL_SRC_ALPHA, GL_DST_ALPHA);
        gl.BlendEquationSeparatei(i, GL_MAX, i % 2 ? GL_MIN : GL_FUNC_SUBTRACT);
        gl.ColorMaski(i, 0, 1, (GLboolean)(i % 2), 0);
    }
    for (i = 0; i < VIEWPORTS; i++) {
        float f = (float)i;
        gl.ViewportIndexedf(i, 1.5f + f, 2.25f, 7.5f, 5.0f + f);
        gl.DepthRangeIndexed(i, 0.25, 0.5 + 0.01 * i);
        gl.ScissorIndexed(i, (GLint)i, 1, 3, 2);
    }
}

static void be_strange(void) {
    static const GLenum stores[] = {
        GL_PACK_IMAGE_HEIGHT,  GL_PACK_ROW_LENGTH,     GL_PACK_SKIP_IMAGES,  GL_PACK_SKIP_PIXELS,
        GL_PACK_SKIP_ROWS,     GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_IMAGES,
        GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS};
    GLuint i;
    for (i = 0; i < sizeof toggles / sizeof *toggles; i++) {
        if (toggles[i] == GL_MULTISAMPLE)
            gl.Disable(toggles[i]);
        else
            gl.Enable(toggles[i]); /* dithering is on at first, and is what we turn off */
    }
    for (i = 0; i < sizeof stores / sizeof *stores; i++)
        gl.PixelStorei(stores[i], 3 + (GLint)i);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 8);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 2);
    gl.PixelStorei(GL_PACK_SWAP_BYTES, 1);
    gl.PixelStorei(GL_PACK_LSB_FIRST, 1);
    gl.PixelStorei(GL_UNPACK_SWAP_BYTES, 1);
    gl.PixelStorei(GL_UNPACK_LSB_FIRST, 1);
    gl.BlendColor(0.1f, 0.2f, 0.3f, 0.4f);
    gl.ClampColor(GL_CLAMP_READ_COLOR, GL_TRUE);
    gl.ClearColor(0.5f, 0.25f, 0.125f, 0.75f);
    gl.ClearDepth(0.375);
    gl.ClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    gl.DepthFunc(GL_NOTEQUAL);
    gl.DepthMask(GL_FALSE);
    gl.CullFace(GL_FRONT_AND_BACK);
    gl.FrontFace(GL_CW);
    gl.LogicOp(GL_XOR);
    gl.PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    gl.PolygonOffset(3, 5);
    gl.PrimitiveRestartIndex(2);
    gl.ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    gl.SampleCoverage(0.5f, GL_TRUE);
    gl.SampleMaski(0, 0x5);
    gl.StencilFunc(GL_NEVER, 3, 0xf0);
    gl.StencilMask(0x0f);
    be_strange_with_indexed();
    be_strange_with_bindings();
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
}

/* ----------------------------------------------------------------------- a life of the executor */

typedef struct life {
    lao_backend backend;
    gl_frame_core core;
    gl_frame frame;
    void *self, *view;
} life;

static void begin_life(life *it, uint32_t state_mode) {
    lao_backend_caps caps;
    lao_gl_desc desc = {0};
    desc.get_proc = gl_wrap_proc;
    desc.state_mode = state_mode;
    gl_frame_core_init(&it->core);
    gl_frame_init(&it->frame, SIZE);
    assert_int_equal(lao_gl_backend(&desc, &it->backend), LAO_OK);
    assert_int_equal(it->backend.attach(&it->backend, &it->core.host, &it->self, &caps), LAO_OK);
    assert_int_equal(gl_frame_lines_create(&it->frame, &it->backend, it->self), LAO_OK);
    assert_int_equal(it->backend.view_create(it->self, &it->view), LAO_OK);
    assert_int_equal(
        it->backend.view_prepare(it->self, it->view, &it->frame.plan, gl_frame_shaders), LAO_OK);
}

static void end_life(life *it) {
    it->backend.view_destroy(it->self, it->view);
    gl_frame_lines_destroy(&it->frame, &it->backend, it->self);
    it->backend.detach(it->self);
    assert_int_equal(it->core.logs, 0);
    assert_int_equal(it->core.memory.bytes, 0);
}

static void set_target(life *it, GLuint name, uint32_t kind, uint32_t flags) {
    it->frame.execution.target.native = name;
    it->frame.execution.target.kind = kind;
    it->frame.execution.target.flags = flags;
    it->frame.execution.target.present = 1;
}

/* A frame into the host's second framebuffer; the images of all formats are read back. */
static void draw(life *it, float picture[5][PIXELS * 4]) {
    static const uint32_t texel[5] = {8, 4, 4, 16, 16};
    uint32_t i;
    memset(picture, 0, 5 * sizeof picture[0]);
    set_target(it, host.framebuffers[1], LAO_HOST_FRAMEBUFFER, 0);
    assert_int_equal(it->backend.execute(it->self, it->view, &it->frame.execution), LAO_OK);
    for (i = 0; i < 5; i++) {
        if (i == 4) /* not written in even frames: content of no meaning */
            continue;
        assert_int_equal(it->backend.read(it->self, it->view, &it->frame.plan, i, picture[i],
                                          (size_t)texel[i] * PIXELS),
                         LAO_OK);
    }
}

static float expected[5][PIXELS * 4], picture[5][PIXELS * 4];
static snapshot fresh, before, after;

static void the_tables_initial_values_are_those_of_a_fresh_context(void **state) {
    life it;
    uint32_t i, k, n;
    double v[4];
    (void)state;
    begin_life(&it, LAO_GL_RESTORE);
    for (i = 0; i < LAO__GL_STATE_COUNT; i++) {
        const lao__gl_row *row = &lao__gl_state[i];
        for (k = 0; k < row->count && row->begin != LAO__GL_WINDOW; k++) {
            lao__gl_get((lao__gl *)it.self, row, k, v);
            if (row->kind == LAO__GL_IS_ACTIVE_TEXTURE || row->kind == LAO__GL_IS_POLYGON_MODE)
                v[1] = row->initial[1];
            for (n = 0; n < 4; n++)
                if (v[n] != row->initial[n])
                    fail_msg("%s[%u].%u is %g", row->name, (unsigned)k, (unsigned)n, v[n]);
            if (row->kind == LAO__GL_IS_SAMPLER || row->kind == LAO__GL_IS_TEXTURE)
                gl.ActiveTexture(GL_TEXTURE0);
        }
    }
    end_life(&it);
}

static void a_fresh_context_gives_a_picture_with_lines(void **state) {
    life it;
    static const float background[4] = {0, 0.125f, 0.125f, 1.5f}; /* Mesa zeroes new images */
    int covered = 0, i;
    (void)state;
    begin_life(&it, LAO_GL_RESTORE);
    draw(&it, expected);
    end_life(&it);
    for (i = 0; i < PIXELS; i++)
        covered += expected[1][i] > 0;
    assert_memory_equal(expected[3], background, sizeof background);
    assert_in_range(covered, PIXELS / 8, PIXELS / 2);
    take(&after);
    assert_int_equal(differences(&fresh, &after, 1), 0);
}

static void strange_state_changes_no_pixel_and_comes_back(void **state) {
    life it;
    (void)state;
    be_strange();
    take(&before);
    assert_true(differences(&fresh, &before, 0) > 400);
    begin_life(&it, LAO_GL_RESTORE);
    take(&after);
    assert_int_equal(differences(&before, &after, 1), 0);
    draw(&it, picture);
    take(&after);
    assert_int_equal(differences(&before, &after, 1), 0);
    end_life(&it);
    take(&after);
    assert_int_equal(differences(&before, &after, 1), 0);
    assert_memory_equal(picture, expected, sizeof picture);
}

/* Every entry point but attach, which touches nothing that the others do not. One life: programs
 * stay compiled. */
static void each_row_that_is_left_out_is_missed(void **state) {
    life it;
    int i;
    (void)state;
    begin_life(&it, LAO_GL_RESTORE);
    for (i = 0; i < (int)LAO__GL_STATE_COUNT; i++) {
        be_strange();
        take(&before);
        skipped_row = i;
        gl_frame_lines_destroy(&it.frame, &it.backend, it.self);
        assert_int_equal(gl_frame_lines_create(&it.frame, &it.backend, it.self), LAO_OK);
        assert_int_equal(
            it.backend.view_prepare(it.self, it.view, &it.frame.plan, gl_frame_shaders), LAO_OK);
        draw(&it, picture);
        skipped_row = -1;
        take(&after);
        if (!differences(&before, &after, 0))
            fail_msg("nobody missed the row \"%s\"", lao__gl_state[i].name);
    }
    end_life(&it);
}

static void reset_leaves_initial_values(void **state) {
    life it;
    uint32_t i, k, n, count;
    double v[4];
    (void)state;
    be_strange();
    begin_life(&it, LAO_GL_RESET);
    draw(&it, picture);
    assert_memory_equal(picture, expected, sizeof picture);
    for (i = 0; i < LAO__GL_STATE_COUNT; i++) {
        const lao__gl_row *row = &lao__gl_state[i];
        count = row->kind == LAO__GL_IS_TEXTURE || row->kind == LAO__GL_IS_SAMPLER ? 3 : row->count;
        for (k = 0; k < count && row->begin != LAO__GL_WINDOW; k++) {
            lao__gl_get((lao__gl *)it.self, row, k, v);
            for (n = 0; n < (row->kind == LAO__GL_IS_POLYGON_MODE ? 1u : 4u); n++)
                if (v[n] != row->initial[n])
                    fail_msg("%s[%u].%u is %g", row->name, (unsigned)k, (unsigned)n, v[n]);
        }
    }
    end_life(&it);
}

static void dirty_draws_the_same_picture(void **state) {
    life it;
    (void)state;
    be_strange();
    begin_life(&it, LAO_GL_DIRTY);
    be_strange();
    draw(&it, picture);
    end_life(&it);
    assert_memory_equal(picture, expected, sizeof picture);
}

static void a_program_deleted_while_in_use_is_not_restored(void **state) {
    GLuint program = make_program();
    double current = 1;
    life it;
    (void)state;
    gl.UseProgram(program);
    gl.DeleteProgram(program);
    begin_life(&it, LAO_GL_RESTORE);
    draw(&it, picture);
    end_life(&it);
    gl.GetDoublev(GL_CURRENT_PROGRAM, &current);
    assert_true(current == 0);
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
}

static void queries_and_feedback_are_refused_and_go_on(void **state) {
    static const GLenum targets[] = {GL_SAMPLES_PASSED, GL_ANY_SAMPLES_PASSED};
    GLuint query, i;
    life it;
    (void)state;
    begin_life(&it, LAO_GL_RESTORE);
    set_target(&it, host.framebuffers[1], LAO_HOST_FRAMEBUFFER, 0);
    for (i = 0; i < 2; i++) {
        gl.GenQueries(1, &query);
        gl.BeginQuery(targets[i], query);
        assert_int_equal(it.backend.execute(it.self, it.view, &it.frame.execution),
                         LAO_ERROR_INVALID_ARGUMENT);
        assert_int_equal(it.core.item, LAO_LOG_BACKEND_STATE);
        gl.EndQuery(targets[i]);
        gl.DeleteQueries(1, &query);
    }
    gl.Disable(GL_RASTERIZER_DISCARD);
    gl.UseProgram(host.program);
    gl.BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, host.buffers[13]);
    gl.BeginTransformFeedback(GL_POINTS);
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
    assert_int_equal(it.backend.execute(it.self, it.view, &it.frame.execution),
                     LAO_ERROR_INVALID_ARGUMENT);
    gl.EndTransformFeedback();
    assert_int_equal(it.core.logs, 3);
    it.core.logs = 0;
    assert_int_equal(it.backend.execute(it.self, it.view, &it.frame.execution), LAO_OK);
    end_life(&it);
}

static void the_hosts_pending_errors_are_not_ours(void **state) {
    life it;
    (void)state;
    begin_life(&it, LAO_GL_RESTORE);
    gl.Enable(0xffff);
    draw(&it, picture);
    end_life(&it);
}

/* The whole library: two views of one context, so that the shaders are compiled once. */
static lao_context *open_library(lao_lines *lines) {
    static const float points[] = {-3, -2, 0, 0, 1, 1, 3, -1, -1, -3, 2, -2, 0, -1, 0, 2, 2, 2};
    static const uint32_t offsets[] = {0, 3, 6};
    lao_gl_desc gl_desc = {0};
    lao_backend backend;
    lao_desc desc = {0};
    lao_context *context;
    lao_lines_desc lines_desc = {0};
    gl_desc.get_proc = gl_wrap_proc;
    assert_int_equal(lao_gl_backend(&gl_desc, &backend), LAO_OK);
    desc.backend = &backend;
    assert_int_equal(lao_create(&desc, &context), LAO_OK);
    lines_desc.line_count = 2;
    lines_desc.point_count = 6;
    lines_desc.offsets = offsets;
    lines_desc.points = points;
    assert_int_equal(lao_lines_create(context, &lines_desc, lines), LAO_OK);
    return context;
}

static void render(lao_context *context, lao_lines lines, float color[PIXELS * 4]) {
    static const float view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -10, 1};
    static const float projection[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1.5f, -1, 0, 0, -10, 0};
    lao_view_desc view_desc = {SIZE, SIZE, 0};
    lao_set set = {0};
    lao_frame frame = {0};
    lao_read_info info;
    set.lines = lines;
    frame.sets = &set;
    frame.set_count = 1;
    memcpy(frame.camera.view, view, sizeof view);
    memcpy(frame.camera.projection, projection, sizeof projection);
    frame.target.native = host.textures[0];
    frame.target.width = frame.target.height = SIZE;
    frame.target.present = 1;
    assert_int_equal(lao_view_create(context, &view_desc, &frame.view), LAO_OK);
    assert_int_equal(lao_render(context, &frame), LAO_OK);
    assert_int_equal(lao_read(context, frame.view, "out", 0, color, COMPONENTS, &info), LAO_OK);
}

static void a_frame_of_the_library_leaves_no_trace(void **state) {
    static float plain[PIXELS * 4], strange[PIXELS * 4];
    lao_lines lines;
    lao_context *context = open_library(&lines);
    int differing = 0, i;
    (void)state;
    render(context, lines, plain);
    for (i = 4; i < PIXELS * 4; i++)
        differing += plain[i] != plain[i % 4];
    assert_true(differing > 20);
    be_strange();
    take(&before);
    render(context, lines, strange);
    lao_destroy(context);
    take(&after);
    assert_int_equal(differences(&before, &after, 1), 0);
    assert_memory_equal(plain, strange, sizeof plain);
}

/* -------------------------------------------------------------------------------------- targets */

/* Draws into a target and returns what framebuffer 0 of the host then holds in both attachments. */
static void present(GLuint name, uint32_t kind, uint32_t flags, uint8_t read[2][PIXELS][4]) {
    static const float gray[4] = {0.25f, 0.25f, 0.25f, 0.25f};
    GLuint i;
    life it;
    be_strange();
    gl.BindFramebuffer(GL_FRAMEBUFFER, host.framebuffers[0]);
    gl.Disable(GL_SCISSOR_TEST);
    gl.Disable(GL_RASTERIZER_DISCARD);
    gl.Disable(GL_FRAMEBUFFER_SRGB);
    for (i = 0; i < 2; i++) {
        gl.ColorMaski(i, 1, 1, 1, 1);
        gl.ClearBufferfv(GL_COLOR, (GLint)i, gray);
    }
    begin_life(&it, LAO_GL_RESTORE);
    set_target(&it, name, kind, flags);
    assert_int_equal(it.backend.execute(it.self, it.view, &it.frame.execution), LAO_OK);
    end_life(&it);
    gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    gl.PixelStorei(GL_PACK_ROW_LENGTH, 0);
    gl.PixelStorei(GL_PACK_SKIP_PIXELS, 0);
    gl.PixelStorei(GL_PACK_SKIP_ROWS, 0);
    gl.PixelStorei(GL_PACK_SWAP_BYTES, 0);
    for (i = 0; i < 2; i++) {
        gl.ReadBuffer(GL_COLOR_ATTACHMENT0 + i);
        gl.ReadPixels(0, 0, SIZE, SIZE, GL_RGBA, GL_UNSIGNED_BYTE, read[i]);
    }
    gl.ReadBuffer(GL_COLOR_ATTACHMENT1);
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
}

static void all_kinds_of_targets_get_the_same_and_nothing_else_is_drawn(void **state) {
    static uint8_t a[2][PIXELS][4], b[2][PIXELS][4], none[2][PIXELS][4];
    static const GLenum first[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    static const GLenum swapped[] = {GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT0};
    (void)state;
    gl.BindFramebuffer(GL_FRAMEBUFFER, host.framebuffers[0]);
    gl.DrawBuffers(2, first);
    present(host.textures[0], LAO_HOST_TEXTURE, 0, a);
    present(host.framebuffers[0], LAO_HOST_FRAMEBUFFER, 0, b);
    assert_memory_equal(a, b, sizeof a);
    present(host.textures[1], LAO_HOST_TEXTURE, 0, b);
    assert_memory_equal(a[0], b[1], sizeof a[0]);
    gl.BindRenderbuffer(GL_RENDERBUFFER, host.renderbuffer);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, SIZE, SIZE);
    present(host.renderbuffer, LAO_HOST_RENDERBUFFER, 0, none);
    memset(b, 64, sizeof b);
    assert_memory_equal(a[1], b[1], sizeof a[1]);
    assert_memory_not_equal(a[0], b[0], sizeof a[0]);
    assert_memory_equal(none, b, sizeof none);
    gl.BindFramebuffer(GL_FRAMEBUFFER, host.framebuffers[0]);
    gl.DrawBuffers(2, swapped);
}

static void srgb_targets_are_encoded_only_when_told(void **state) {
    static uint8_t plain[2][PIXELS][4], raw[2][PIXELS][4], encoded[2][PIXELS][4];
    int i, brighter = 0;
    (void)state;
    gl.BindTexture(GL_TEXTURE_2D, 0);
    present(host.textures[1], LAO_HOST_TEXTURE, 0, plain);
    gl.BindTexture(GL_TEXTURE_2D, host.textures[1]);
    gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, SIZE, SIZE, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                  NULL);
    present(host.textures[1], LAO_HOST_TEXTURE, 0, raw);
    present(host.textures[1], LAO_HOST_TEXTURE, LAO_HOST_ENCODE_SRGB, encoded);
    assert_memory_equal(plain, raw, sizeof raw);
    for (i = 0; i < PIXELS; i++)
        brighter += encoded[1][i][1] > raw[1][i][1];
    assert_true(brighter > PIXELS / 2);
}

static int setup(void **state) {
    (void)state;
    load_functions();
    make_objects();
    take(&fresh);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tables_initial_values_are_those_of_a_fresh_context),
        cmocka_unit_test(a_fresh_context_gives_a_picture_with_lines),
        cmocka_unit_test(strange_state_changes_no_pixel_and_comes_back),
        cmocka_unit_test(each_row_that_is_left_out_is_missed),
        cmocka_unit_test(reset_leaves_initial_values),
        cmocka_unit_test(dirty_draws_the_same_picture),
        cmocka_unit_test(a_program_deleted_while_in_use_is_not_restored),
        cmocka_unit_test(queries_and_feedback_are_refused_and_go_on),
        cmocka_unit_test(the_hosts_pending_errors_are_not_ours),
        cmocka_unit_test(a_frame_of_the_library_leaves_no_trace),
        cmocka_unit_test(all_kinds_of_targets_get_the_same_and_nothing_else_is_drawn),
        cmocka_unit_test(srgb_targets_are_encoded_only_when_told),
    };
    int result;
    if (!gl_wrap_open())
        return 0;
    result = cmocka_run_group_tests(tests, setup, NULL);
    gl_wrap_close();
    return result;
}
