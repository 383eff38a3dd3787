#include "render_host.h"

#include "scene.h"

#include <GL/glcorearb.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ------------------------------------------------------------------------------------- devices */

/* The seam is data, so a test can stand in it: execute of the real backend, and what passed. */
typedef lao_result (*execute_function)(void *self, void *view, const lao_execution *execution);
static struct {
    execute_function gl, vk;
    lao_frame_uniforms frame;
    struct {
        uint32_t image, level;
    } instances[RENDER_MOST_IMAGES];
    uint32_t count;
    int endless;
} spy;

void render_endless(int on) {
    spy.endless = on;
}

static struct {
    const lao_module *list[RENDER_MOST_MODULES];
    uint32_t count;
} modules;

void render_module(const lao_module *module) {
    assert_true(modules.count < RENDER_MOST_MODULES);
    modules.list[modules.count++] = module;
}

/* The row of an image by its number in the graph. */
static const lao_image_row *image_row(uint32_t image) {
    const lao_module *module = lao_lines_module();
    for (uint32_t m = 0; image >= module->image_count; m++) {
        image -= module->image_count;
        module = modules.list[m];
    }
    return &module->images[image];
}

static void spy_on(const lao_execution *execution) {
    const lao_plan *plan = execution->plan;
    memcpy(&spy.frame, execution->frame_uniforms, sizeof spy.frame);
    spy.count = 0;
    for (uint32_t i = 0; i < plan->instance_count; i++) {
        uint32_t k = 0;
        if (plan->instances[i].import != LAO_NO_INDEX)
            continue;
        while (k < spy.count && (spy.instances[k].image != plan->instances[i].image ||
                                 spy.instances[k].level != plan->instances[i].level))
            k++;
        if (k == spy.count && k < RENDER_MOST_IMAGES) {
            spy.instances[k].image = plan->instances[i].image;
            spy.instances[k].level = plan->instances[i].level;
            spy.count++;
        }
    }
}

static lao_result spy_execute(execute_function execute, void *self, void *view,
                              const lao_execution *execution) {
    lao_execution endless = *execution;
    lao_draw draws[RENDER_MOST_SETS];
    spy_on(execution);
    if (!spy.endless)
        return execute(self, view, execution);
    memcpy(draws, execution->draws, execution->set_count * sizeof *draws);
    for (uint32_t i = 0; i < execution->set_count; i++)
        draws[i].window.length = 1e30f;
    endless.draws = draws;
    return execute(self, view, &endless);
}

static lao_result spy_gl(void *self, void *view, const lao_execution *execution) {
    return spy_execute(spy.gl, self, view, execution);
}

static lao_result spy_vk(void *self, void *view, const lao_execution *execution) {
    return spy_execute(spy.vk, self, view, execution);
}

static void on_log(void *user, lao_log_item item, lao_result result, const char *text) {
    render_device *device = user;
    (void)item;
    snprintf(device->log, sizeof device->log, "%s: %s", lao_result_text(result), text);
}

static int open_context(render_device *device, lao_backend *backend) {
    lao_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.backend = backend;
    desc.logger.log = on_log;
    desc.logger.user = device;
    desc.modules = modules.list;
    desc.module_count = modules.count;
    if (lao_create(&desc, &device->context) == LAO_OK)
        return 1;
    print_message("%s: %s\n", device->name, device->log);
    render_close(device);
    device->refused = 1;
    return 0;
}

int render_open_gl(render_device *device, void *(*get_proc)(const char *name, void *user)) {
    char error[HOST_ERROR_SIZE];
    lao_gl_desc desc;
    lao_backend backend;
    memset(device, 0, sizeof *device);
    device->name = "GL";
    if (!host_gl_open(NULL, &device->gl, error)) {
        print_message("%s\n", error);
        return 0;
    }
    device->software = strstr(host_gl_renderer(device->gl), "llvmpipe") != NULL;
    memset(&desc, 0, sizeof desc);
    desc.get_proc = get_proc ? get_proc : host_gl_get_proc;
    if (lao_gl_backend(&desc, &backend) != LAO_OK)
        return 0;
    spy.gl = backend.execute;
    backend.execute = spy_gl;
    return open_context(device, &backend);
}

int render_open_vk(render_device *device, uint32_t api_version) {
    char error[HOST_VK_ERROR_SIZE];
    host_vk_desc host;
    lao_vk_desc desc;
    lao_backend backend;
    memset(device, 0, sizeof *device);
    device->name = "VK";
    memset(&host, 0, sizeof host);
    host.api_version = api_version;
    if (!host_vk_open(&host, &device->vk, error)) {
        print_message("%s\n", error);
        return 0;
    }
    device->software = strstr(host_vk_name(device->vk), "llvmpipe") != NULL;
    desc = host_vk_lend(device->vk);
    if (lao_vk_backend(&desc, &backend) != LAO_OK)
        return 0;
    spy.vk = backend.execute;
    backend.execute = spy_vk;
    return open_context(device, &backend);
}

void render_close(render_device *device) {
    if (device->gl)
        host_gl_make_current(device->gl);
    lao_destroy(device->context); /* render_draw waited for the last frame */
    host_gl_close(device->gl);
    host_vk_close(device->vk);
    memset(device, 0, sizeof *device);
}

void render_need(const render_device *device) {
    if (device->context)
        return;
    if (device->refused)
        fail_msg("lao_create failed");
    if (getenv("LINEAO_EXPECT_GPU"))
        fail_msg("LINEAO_EXPECT_GPU is set");
    skip();
}

render_device render_devices[RENDER_DEVICES];

int render_open_opengl(void **state) {
    (void)state;
    render_open_gl(&render_devices[RENDER_GL], NULL);
    return 0;
}

int render_open_both(void **state) {
    render_open_vk(&render_devices[RENDER_VK], 0);
    return render_open_opengl(state);
}

int render_close_both(void **state) {
    (void)state;
    render_close(&render_devices[RENDER_GL]);
    render_close(&render_devices[RENDER_VK]);
    return 0;
}

/* ----------------------------------------------------------------------------------- line sets */

static void *grown(void *memory, size_t count, size_t size) {
    memory = realloc(memory, count * size);
    assert_non_null(memory);
    return memory;
}

void render_point(render_lines *lines, double x, double y, double z) {
    float *p;
    uint8_t *c;
    if (lines->point_count == lines->point_capacity) {
        lines->point_capacity = lines->point_capacity ? 2 * lines->point_capacity : 256;
        lines->points = grown(lines->points, lines->point_capacity, 3 * sizeof *lines->points);
        lines->times = grown(lines->times, lines->point_capacity, sizeof *lines->times);
        lines->colors = grown(lines->colors, lines->point_capacity, 4);
    }
    p = lines->points + 3 * (size_t)lines->point_count;
    p[0] = (float)x;
    p[1] = (float)y;
    p[2] = (float)z;
    lines->times[lines->point_count] =
        4 * (float)(lines->point_count - (lines->offsets ? lines->offsets[lines->line_count] : 0));
    c = lines->colors + 4 * (size_t)lines->point_count;
    for (uint32_t k = 0; k < 3; k++)
        c[k] = (uint8_t)(lao_hash(4 * lines->point_count + k) >> 24);
    c[3] = 255;
    lines->point_count++;
}

void render_line(render_lines *lines) {
    if (lines->line_count + 1 >= lines->line_capacity) {
        lines->line_capacity = lines->line_capacity ? 2 * lines->line_capacity : 64;
        lines->offsets = grown(lines->offsets, lines->line_capacity, sizeof *lines->offsets);
        lines->offsets[0] = 0;
    }
    lines->offsets[++lines->line_count] = lines->point_count;
}

void render_scene(render_lines *lines, const char *name, uint32_t count, double scale, double x,
                  double y, double z) {
    scene_lines scene;
    assert_true(scene_make(name, count, 1, &scene));
    for (uint32_t i = 0; i < scene.line_count; i++) {
        for (uint32_t k = scene.offsets[i]; k < scene.offsets[i + 1]; k++) {
            const float *p = scene.points + 3 * (size_t)k;
            render_point(lines, x + scale * (double)p[0], y + scale * (double)p[1],
                         z + scale * (double)p[2]);
        }
        render_line(lines);
    }
    scene_free(&scene);
}

void render_scatter(render_lines *lines, uint32_t count, uint32_t seed, double length,
                    double extent, double depth) {
    for (uint32_t i = 0; i < count; i++) {
        double r[5];
        lao_v3 d;
        for (uint32_t k = 0; k < 5; k++)
            r[k] = (double)lao_unit_float(lao_hash(seed * 7919 + 5 * i + k));
        d = lao_sphere_point((float)r[3], (float)r[4]);
        for (int end = -1; end <= 1; end += 2) {
            double along = 0.5 * length * end;
            render_point(lines, extent * (2 * r[0] - 1) + along * (double)d.x,
                         extent * (2 * r[1] - 1) + along * (double)d.y,
                         depth * (2 * r[2] - 1) + along * (double)d.z);
        }
        render_line(lines);
    }
}

void render_lines_free(render_lines *lines) {
    free(lines->offsets);
    free(lines->points);
    free(lines->times);
    free(lines->colors);
    memset(lines, 0, sizeof *lines);
}

/* ------------------------------------------------------------------------------------- cameras */

static void unit(double v[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++)
        v[k] /= length;
}

lao_camera render_camera(double x, double y, double z, double distance) {
    lao_camera camera;
    double axes[3][3], *right = axes[0], *up = axes[1], *back = axes[2];
    memset(&camera, 0, sizeof camera);
    back[0] = x;
    back[1] = y;
    back[2] = z;
    unit(back);
    right[0] = back[2]; /* the y axis upwards */
    right[1] = 0;
    right[2] = -back[0];
    unit(right);
    up[0] = back[1] * right[2] - back[2] * right[1];
    up[1] = back[2] * right[0] - back[0] * right[2];
    up[2] = back[0] * right[1] - back[1] * right[0];
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            camera.view[4 * c + r] = (float)axes[r][c];
    }
    camera.view[14] = (float)-distance;
    camera.view[15] = 1;
    camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    return camera;
}

void render_perspective(lao_camera *camera, double fovy, double aspect, double near, double far) {
    float *p = camera->projection;
    double scale = 1 / tan(fovy * 3.14159265358979 / 360);
    memset(p, 0, sizeof camera->projection);
    p[0] = (float)(scale / aspect);
    p[5] = (float)scale;
    p[10] = (float)(far / (near - far));
    p[11] = -1;
    p[14] = (float)(near * far / (near - far));
}

void render_orthographic(lao_camera *camera, double height, double aspect, double near,
                         double far) {
    float *p = camera->projection;
    memset(p, 0, sizeof camera->projection);
    p[0] = (float)(2 / (height * aspect));
    p[5] = (float)(2 / height);
    p[10] = (float)(1 / (near - far));
    p[14] = (float)(near / (near - far));
    p[15] = 1;
}

void render_reverse(lao_camera *camera) {
    float *p = camera->projection;
    for (int c = 0; c < 4; c++)
        p[4 * c + 2] = p[4 * c + 3] - p[4 * c + 2];
    camera->flags |= LAO_CAMERA_REVERSE_DEPTH;
}

void render_shift(lao_camera *camera, double x, double y) {
    float *p = camera->projection;
    int column = p[11] == 0 ? 3 : 2;
    p[4 * column + 0] += (float)(column == 3 ? x : -x);
    p[4 * column + 1] += (float)(column == 3 ? y : -y);
}

/* --------------------------------------------------------------------------- images of the host */

/* A colour or depth image of the host on either backend. */
typedef struct surface {
    GLuint texture;
    host_vk_image vk;
    lao_format format;
    uint32_t width, height;
} surface;

#define GL_FUNCTION(type, function, name)                                                          \
    type function;                                                                                 \
    void *function##_data = host_gl_get_proc(name, NULL);                                          \
    memcpy(&function, &function##_data, sizeof function)

static void gl_format(lao_format format, GLint *internal, GLenum *layout, GLenum *type) {
    *internal = format == LAO_FORMAT_RGBA8     ? GL_RGBA8
                : format == LAO_FORMAT_RGBA32F ? GL_RGBA32F
                                               : GL_DEPTH_COMPONENT32F;
    *layout = format == LAO_FORMAT_D32F ? GL_DEPTH_COMPONENT : GL_RGBA;
    *type = format == LAO_FORMAT_RGBA8 ? GL_UNSIGNED_BYTE : GL_FLOAT;
}

static void surface_make_gl(surface *s, float value) {
    GL_FUNCTION(PFNGLGENTEXTURESPROC, gen_textures, "glGenTextures");
    GL_FUNCTION(PFNGLBINDTEXTUREPROC, bind_texture, "glBindTexture");
    GL_FUNCTION(PFNGLTEXIMAGE2DPROC, tex_image, "glTexImage2D");
    GL_FUNCTION(PFNGLTEXPARAMETERIPROC, tex_parameter, "glTexParameteri");
    size_t count = (size_t)s->width * s->height * (s->format == LAO_FORMAT_D32F ? 1 : 4);
    float *data = malloc(count * sizeof *data);
    GLint internal;
    GLenum layout, type;
    assert_non_null(data);
    gl_format(s->format, &internal, &layout, &type);
    for (size_t i = 0; i < count; i++) {
        if (s->format == LAO_FORMAT_RGBA8)
            ((uint8_t *)data)[i] = (uint8_t)lrintf(value * 255.0f);
        else
            data[i] = value;
    }
    gen_textures(1, &s->texture);
    bind_texture(GL_TEXTURE_2D, s->texture);
    tex_image(GL_TEXTURE_2D, 0, internal, (GLsizei)s->width, (GLsizei)s->height, 0, layout, type,
              data);
    tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    bind_texture(GL_TEXTURE_2D, 0);
    free(data);
}

static void surface_make_vk(render_device *device, surface *s, float value) {
    VkFormat format = s->format == LAO_FORMAT_RGBA8     ? VK_FORMAT_R8G8B8A8_UNORM
                      : s->format == LAO_FORMAT_RGBA32F ? VK_FORMAT_R32G32B32A32_SFLOAT
                                                        : VK_FORMAT_D32_SFLOAT;
    VkImageSubresourceRange range = {0, 0, 1, 0, 1};
    VkClearColorValue color;
    VkClearDepthStencilValue depth = {0, 0};
    VkCommandBuffer commands;
    for (int k = 0; k < 4; k++)
        color.float32[k] = value;
    depth.depth = value;
    assert_true(host_vk_image_make(device->vk, format, s->width, s->height, 0, &s->vk));
    commands = host_vk_begin(device->vk);
    assert_non_null(commands);
    range.aspectMask = s->vk.aspect;
    host_vk_image_layout(commands, &s->vk, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    if (s->vk.aspect == VK_IMAGE_ASPECT_COLOR_BIT) {
        vkCmdClearColorImage(commands, s->vk.image, VK_IMAGE_LAYOUT_GENERAL, &color, 1, &range);
    } else {
        vkCmdClearDepthStencilImage(commands, s->vk.image, VK_IMAGE_LAYOUT_GENERAL, &depth, 1,
                                    &range);
    }
    host_vk_image_layout(commands, &s->vk, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL);
    assert_true(host_vk_submit_and_wait(device->vk, commands));
}

static void surface_make(render_device *device, surface *s, lao_format format, uint32_t width,
                         uint32_t height, float value) {
    memset(s, 0, sizeof *s);
    s->format = format;
    s->width = width;
    s->height = height;
    if (device->gl)
        surface_make_gl(s, value);
    else
        surface_make_vk(device, s, value);
}

/* An image with these texels. */
static void surface_bring(render_device *device, surface *s, const render_image *image) {
    surface_make(device, s, image->format, image->width, image->height, 0);
    if (device->gl) {
        GL_FUNCTION(PFNGLBINDTEXTUREPROC, bind_texture, "glBindTexture");
        GL_FUNCTION(PFNGLTEXSUBIMAGE2DPROC, tex_sub_image, "glTexSubImage2D");
        GLint internal;
        GLenum layout, type;
        gl_format(s->format, &internal, &layout, &type);
        bind_texture(GL_TEXTURE_2D, s->texture);
        tex_sub_image(GL_TEXTURE_2D, 0, 0, 0, (GLsizei)s->width, (GLsizei)s->height, layout, type,
                      image->data);
        bind_texture(GL_TEXTURE_2D, 0);
    } else {
        assert_true(host_vk_image_write(device->vk, &s->vk, VK_IMAGE_LAYOUT_GENERAL, image->data));
    }
}

static lao_image surface_image(const surface *s, uint32_t flags) {
    lao_image image;
    memset(&image, 0, sizeof image);
    image.native = s->texture;
    image.flags = flags;
    if (!s->texture) {
        memcpy(&image.native, &s->vk.image, sizeof s->vk.image);
        memcpy(&image.native_view, &s->vk.view, sizeof s->vk.view);
        image.native_format = (uint32_t)s->vk.format;
        image.layout_before = image.layout_after = VK_IMAGE_LAYOUT_GENERAL;
    }
    image.width = s->width;
    image.height = s->height;
    image.present = 1;
    return image;
}

static void surface_read(render_device *device, const surface *s, const char *name,
                         render_image *out) {
    memset(out, 0, sizeof *out);
    out->name = name;
    out->format = s->format;
    out->width = s->width;
    out->height = s->height;
    out->data = malloc((size_t)s->width * s->height * lao_format_bytes(s->format));
    assert_non_null(out->data);
    if (device->gl) {
        GL_FUNCTION(PFNGLBINDTEXTUREPROC, bind_texture, "glBindTexture");
        GL_FUNCTION(PFNGLGETTEXIMAGEPROC, get_tex_image, "glGetTexImage");
        GLint internal;
        GLenum layout, type;
        gl_format(s->format, &internal, &layout, &type);
        bind_texture(GL_TEXTURE_2D, s->texture);
        get_tex_image(GL_TEXTURE_2D, 0, layout, type, out->data);
        bind_texture(GL_TEXTURE_2D, 0);
    } else {
        assert_true(host_vk_image_read(device->vk, &s->vk, VK_IMAGE_LAYOUT_GENERAL, out->data));
    }
}

static void surface_free(render_device *device, surface *s) {
    if (device->gl && s->texture) {
        GL_FUNCTION(PFNGLDELETETEXTURESPROC, delete_textures, "glDeleteTextures");
        delete_textures(1, &s->texture);
    }
    if (device->vk)
        host_vk_image_free(device->vk, &s->vk);
}

/* -------------------------------------------------------------------------------------- frames */

static void succeeds(const render_device *device, lao_result result) {
    if (result != LAO_OK)
        fail_msg("%s: %s", device->name, device->log);
}

static void draw(render_device *device, lao_frame *frame) {
    VkCommandBuffer commands = NULL;
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    if (device->vk) {
        commands = host_vk_begin(device->vk);
        assert_non_null(commands);
        frame->commands = commands;
    }
    succeeds(device, lao_render(device->context, frame));
    if (device->vk)
        assert_true(host_vk_submit_and_wait(device->vk, commands));
    clock_gettime(CLOCK_MONOTONIC, &end);
    device->milliseconds =
        1e3 * (double)(end.tv_sec - begin.tv_sec) + 1e-6 * (double)(end.tv_nsec - begin.tv_nsec);
}

static lao_lines upload(render_device *device, const render_lines *lines) {
    lao_lines_desc desc;
    lao_lines handle = {0};
    memset(&desc, 0, sizeof desc);
    desc.line_count = lines->line_count;
    desc.point_count = lines->point_count;
    desc.offsets = lines->offsets;
    desc.points = lines->points;
    desc.times = lines->times;
    desc.colors = lines->colors;
    succeeds(device, lao_lines_create(device->context, &desc, &handle));
    return handle;
}

static lao_object upload_object(render_device *device, const lao_object_desc *desc) {
    lao_object handle = {0};
    succeeds(device, lao_object_create(device->context, desc, &handle));
    return handle;
}

static void read_all(render_device *device, lao_view view, render_result *result) {
    for (uint32_t i = 0; i < spy.count; i++) {
        const lao_image_row *row = image_row(spy.instances[i].image);
        render_image *image = &result->images[result->count++];
        lao_read_info info;
        size_t size;
        image->name = row->name;
        image->level = spy.instances[i].level;
        image->format = row->format;
        succeeds(device,
                 lao_read_raw(device->context, view, row->name, image->level, NULL, 0, &info));
        image->width = info.width;
        image->height = info.height;
        size = (size_t)info.width * info.height * lao_format_bytes(row->format);
        image->data = malloc(size);
        assert_non_null(image->data);
        succeeds(device, lao_read_raw(device->context, view, row->name, image->level, image->data,
                                      size, &info));
    }
}

/* Draws shot->depth_lines alone, into the host's depth. */
static void draw_before(render_device *device, const render_shot *shot, const lao_frame *frame) {
    lao_settings settings;
    lao_set set;
    lao_frame before = *frame;
    memset(&settings, 0, sizeof settings);
    memset(&set, 0, sizeof set);
    settings.set = LAO_SET(occlusion);
    settings.width = shot->settings[0]->width;
    settings.supersampling = 1;
    set.lines = upload(device, shot->depth_lines);
    set.settings = &settings;
    before.sets = &set;
    before.set_count = 1;
    memset(&before.target, 0, sizeof before.target);
    draw(device, &before);
    succeeds(device, lao_lines_destroy(device->context, set.lines));
}

void render_draw(render_device *device, const render_shot *shot, render_result *result) {
    lao_set sets[RENDER_MOST_SETS];
    lao_view_desc desc;
    lao_frame frame;
    lao_import imports[RENDER_MOST_SETS];
    surface target, depth, brought[RENDER_MOST_SETS];
    memset(result, 0, sizeof *result);
    memset(&frame, 0, sizeof frame);
    memset(sets, 0, sizeof sets);
    memset(&desc, 0, sizeof desc);
    if (device->gl)
        assert_true(host_gl_make_current(device->gl));
    desc.width = shot->width;
    desc.height = shot->height;
    desc.flags = LAO_VIEW_KEEP_IMAGES;
    if (shot->view && shot->view->id)
        frame.view = *shot->view;
    else
        succeeds(device, lao_view_create(device->context, &desc, &frame.view));
    if (shot->view)
        *shot->view = frame.view;
    frame.camera = shot->camera;
    memcpy(frame.background, shot->background, sizeof frame.background);
    memcpy(frame.sphere, shot->sphere, sizeof frame.sphere);
    frame.time = shot->time;
    if (shot->host_depth) {
        surface_make(device, &depth, LAO_FORMAT_D32F, shot->width, shot->height, shot->depth_value);
        imports[0].image = "host_depth";
        imports[0].source = surface_image(&depth, shot->depth_flags | LAO_HOST_WRITABLE);
        frame.imports = imports;
        frame.import_count = 1;
        if (shot->depth_lines)
            draw_before(device, shot, &frame);
        surface_read(device, &depth, "host_depth before", &result->depth_before);
    }
    for (uint32_t i = 0; i < shot->import_count; i++) {
        surface_bring(device, &brought[i], &shot->imports[i]);
        imports[i].image = shot->imports[i].name;
        imports[i].source = surface_image(&brought[i], 0);
        frame.imports = imports;
        frame.import_count = i + 1;
    }
    if (shot->target != RENDER_NO_TARGET) {
        lao_format format =
            shot->target == RENDER_TARGET_RGBA8 ? LAO_FORMAT_RGBA8 : LAO_FORMAT_RGBA32F;
        surface_make(device, &target, format, shot->width, shot->height, shot->target_value);
        frame.target = surface_image(&target, shot->target_flags);
    }
    for (uint32_t i = 0; i < shot->set_count; i++) {
        if (shot->lines[i])
            sets[i].lines = upload(device, shot->lines[i]);
        if (shot->objects[i])
            sets[i].object = upload_object(device, shot->objects[i]);
        sets[i].settings = shot->settings[i];
        sets[i].module_settings = shot->module_settings[i];
    }
    frame.flags = shot->frame_flags;
    frame.sets = sets;
    frame.set_count = shot->set_count;
    for (uint32_t i = 0; i < shot->before_count; i++) {
        frame.camera = shot->before[i];
        draw(device, &frame);
    }
    frame.camera = shot->camera;
    draw(device, &frame);
    result->frame = spy.frame;
    read_all(device, frame.view, result);
    for (uint32_t i = 0; i < shot->set_count; i++) {
        if (shot->lines[i])
            succeeds(device, lao_lines_destroy(device->context, sets[i].lines));
        if (shot->objects[i])
            succeeds(device, lao_object_destroy(device->context, sets[i].object));
    }
    if (shot->import_count)
        surface_read(device, &brought[shot->import_count - 1], "import after",
                     &result->import_after);
    for (uint32_t i = 0; i < shot->import_count; i++)
        surface_free(device, &brought[i]);
    if (shot->target != RENDER_NO_TARGET) {
        surface_read(device, &target, "target", &result->target);
        surface_free(device, &target);
    }
    if (shot->host_depth) {
        surface_read(device, &depth, "host_depth after", &result->depth_after);
        surface_free(device, &depth);
    }
}

void render_draw_both(const render_shot *shot, render_result results[RENDER_DEVICES]) {
    for (int i = 0; i < RENDER_DEVICES; i++) {
        render_need(&render_devices[i]);
        render_draw(&render_devices[i], shot, &results[i]);
    }
}

void render_free(render_result *result) {
    for (uint32_t i = 0; i < result->count; i++)
        free(result->images[i].data);
    free(result->target.data);
    free(result->depth_before.data);
    free(result->depth_after.data);
    free(result->import_after.data);
    memset(result, 0, sizeof *result);
}

const render_image *render_find(const render_result *result, const char *name, uint32_t level) {
    for (uint32_t i = 0; i < result->count; i++) {
        if (result->images[i].level == level && strcmp(result->images[i].name, name) == 0)
            return &result->images[i];
    }
    return NULL;
}

/* One component of one texel; a word as a fraction. Half floats are finite here but for NaN and
 * infinity. */
static double component(const render_image *image, size_t texel, uint32_t channel) {
    const uint8_t *at = image->data + texel * lao_format_bytes(image->format);
    float value;
    uint16_t half;
    uint32_t word;
    switch (image->format) {
    case LAO_FORMAT_RGBA8:
        return at[channel] / 255.0;
    case LAO_FORMAT_RGBA16F:
        memcpy(&half, at + 2 * channel, sizeof half);
        if ((half & 0x7c00) == 0x7c00)
            return (half & 0x3ff) != 0 ? (double)NAN : half & 0x8000 ? -1e30 : 1e30;
        return ldexp((half & 0x3ff) + ((half & 0x7c00) != 0 ? 1024 : 0),
                     ((half & 0x7c00) != 0 ? (half >> 10 & 31) : 1) - 25) *
               ((half & 0x8000) != 0 ? -1 : 1);
    case LAO_FORMAT_R32UI:
        memcpy(&word, at, sizeof word);
        return word / 4294967296.0;
    default:
        memcpy(&value, at + 4 * channel, sizeof value);
        return (double)value;
    }
}

static uint32_t channels(lao_format format) {
    return format == LAO_FORMAT_R32F || format == LAO_FORMAT_R32UI || format == LAO_FORMAT_D32F ? 1
                                                                                                : 4;
}

float *render_floats(const render_image *image, uint32_t channel) {
    size_t count = (size_t)image->width * image->height;
    float *values = malloc(count * sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < count; i++)
        values[i] = (float)component(image, i, channel);
    return values;
}

render_difference render_compare(const char *what, const render_image *a, const render_image *b) {
    render_difference d = {0, 0, 0};
    size_t count = (size_t)a->width * a->height, bytes = lao_format_bytes(a->format), first = 0;
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->format, b->format);
    for (size_t i = 0; i < count; i++) {
        if (memcmp(a->data + i * bytes, b->data + i * bytes, bytes) == 0)
            continue;
        first = d.texels++ == 0 ? i : first;
        for (uint32_t k = 0; k < channels(a->format); k++) {
            double off = fabs(component(a, i, k) - component(b, i, k));
            off = off == off ? off : 1e30;
            d.largest = fmax(d.largest, off);
            d.mean += off / ((double)count * channels(a->format));
        }
    }
    if (d.texels > 0) {
        print_message("%s: %s level %u: %u of %u texels differ, at most by %g, first at (%u, %u):",
                      what, a->name, a->level, d.texels, (unsigned)count, d.largest,
                      (unsigned)(first % a->width), (unsigned)(first / a->width));
        for (uint32_t k = 0; k < channels(a->format); k++)
            print_message(" %.9g | %.9g", component(a, first, k), component(b, first, k));
        print_message("\n");
    }
    return d;
}

void render_same_image(const char *name, const render_result *a, const render_result *b) {
    const render_image *x = render_find(a, name, 0), *y = render_find(b, name, 0);
    assert_true(x && y);
    assert_int_equal(render_compare(name, x, y).texels, 0);
}

void render_same_images(const char *what, const render_result *a, const render_result *b) {
    for (uint32_t i = 0; i < a->count; i++) {
        const render_image *image = &a->images[i];
        const render_image *other = render_find(b, image->name, image->level);
        assert_non_null(other);
        if (render_compare(what, image, other).texels > 0)
            fail_msg("%s: image %s of level %u differs", what, image->name, image->level);
    }
}
