#include "session.h"

#include "report.h"

#ifdef LINEAO_HAVE_GL
#include "host_gl.h"
#endif
#ifdef LINEAO_HAVE_VK
#include "host_vk.h"
#endif

#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void *user) {
    struct timespec t;
    (void)user;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* lineao logs one item per failure: that is our one line. */
static void on_log(void *user, lao_log_item item, lao_result result, const char *text) {
    const cli_session *session = user;
    if (session->quiet)
        return;
    if (item == LAO_LOG_VIEW_SIZE)
        cli_fail("--size: times --ssaa it is more than this device draws with %s; write less of "
                 "one of them",
                 session->backend);
    else
        cli_fail("%s: %s: %s", session->backend, lao_result_text(result), text);
}

/* ---- backends --------------------------------------------------------------------------- */

#ifdef LINEAO_HAVE_GL
static bool open_gl(cli_session *session, lao_backend *backend) {
    char error[HOST_ERROR_SIZE];
    lao_gl_desc desc;
    if (!host_gl_open(NULL, &session->gl, error))
        return cli_fail("gl: %s", error);
    memset(&desc, 0, sizeof desc);
    desc.get_proc = host_gl_get_proc;
    desc.now = now;
    return lao_gl_backend(&desc, backend) == LAO_OK ||
           cli_fail("gl: the backend refused its context");
}
#endif

#ifdef LINEAO_HAVE_VK
static bool open_vk(cli_session *session, lao_backend *backend) {
    char error[HOST_VK_ERROR_SIZE];
    lao_vk_desc desc;
    if (!host_vk_open(NULL, &session->vk, error))
        return cli_fail("vk: %s", error);
    desc = host_vk_lend(session->vk);
    return lao_vk_backend(&desc, backend) == LAO_OK ||
           cli_fail("vk: the backend refused its device");
}
#endif

static bool open_backend(cli_session *session, lao_backend *backend) {
#ifdef LINEAO_HAVE_GL
    if (strcmp(session->backend, "gl") == 0)
        return open_gl(session, backend);
#endif
#ifdef LINEAO_HAVE_VK
    if (strcmp(session->backend, "vk") == 0)
        return open_vk(session, backend);
#endif
    return cli_fail("--backend: %s was not built into this program", session->backend);
}

const char *cli_session_device(const cli_session *session) {
#ifdef LINEAO_HAVE_GL
    if (session->gl)
        return host_gl_renderer(session->gl);
#endif
#ifdef LINEAO_HAVE_VK
    if (session->vk)
        return host_vk_name(session->vk);
#endif
    return "";
}

/* ---- life ------------------------------------------------------------------------------- */

static lao_lines_desc describe_lines(const cli_set *set) {
    lao_lines_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.line_count = set->lines.line_count;
    desc.point_count = set->lines.point_count;
    desc.offsets = set->lines.offsets;
    desc.points = set->lines.points;
    desc.times = set->times;
    desc.colors = set->colors;
    memcpy(desc.color, set->color, sizeof desc.color);
    return desc;
}

static bool upload(cli_session *session, const cli_scene *scene) {
    session->sets = cli_new(scene->count, sizeof *session->sets);
    for (uint32_t i = 0; session->sets && i < scene->count; i++) {
        const cli_set *set = &scene->sets[i];
        lao_lines_desc desc = describe_lines(set);
        memset(&session->sets[i], 0, sizeof session->sets[i]);
        session->sets[i].settings = &set->settings;
        if (!set->object &&
            lao_lines_create(session->context, &desc, &session->sets[i].lines) != LAO_OK)
            return false;
        session->sets[i].module_settings = set->module_settings;
        if (set->object &&
            lao_object_create(session->context, set->object, &session->sets[i].object) != LAO_OK)
            return false;
    }
    session->set_count = scene->count;
    return session->sets != NULL;
}

bool cli_session_renew(cli_session *session, const cli_scene *scene, uint32_t set) {
    lao_lines_desc desc = describe_lines(&scene->sets[set]);
    return lao_lines_update(session->context, session->sets[set].lines, &desc) == LAO_OK;
}

bool cli_session_open(cli_session *session, const char *backend, const cli_scene *scene,
                      const cli_shot *shot, uint32_t view_flags) {
    lao_backend functions;
    memset(session, 0, sizeof *session);
    session->backend = backend;
    return open_backend(session, &functions) &&
           cli_session_start(session, &functions, scene, shot, view_flags);
}

bool cli_session_start(cli_session *session, const lao_backend *functions, const cli_scene *scene,
                       const cli_shot *shot, uint32_t view_flags) {
    lao_desc desc;
    lao_view_desc size;
    memset(&desc, 0, sizeof desc);
    memset(&size, 0, sizeof size);
    desc.backend = functions;
    desc.logger.log = on_log;
    desc.logger.user = session;
    desc.modules = scene->modules;
    desc.module_count = scene->module_count;
    size.width = shot->width + 2 * shot->margin;
    size.height = shot->height + 2 * shot->margin;
    session->margin = shot->margin;
    size.flags = view_flags;
    return lao_create(&desc, &session->context) == LAO_OK && upload(session, scene) &&
           lao_view_create(session->context, &size, &session->view) == LAO_OK;
}

/* With several sessions another one's context may be current. */
static bool use(cli_session *session) {
#ifdef LINEAO_HAVE_GL
    if (session->gl)
        return host_gl_make_current(session->gl) ||
               cli_fail("gl: the context cannot be made current");
#endif
    (void)session;
    return true;
}

void cli_session_close(cli_session *session) {
    use(session);
    lao_destroy(session->context);
    free(session->sets);
#ifdef LINEAO_HAVE_GL
    host_gl_close(session->gl);
#endif
#ifdef LINEAO_HAVE_VK
    host_vk_close(session->vk);
#endif
    memset(session, 0, sizeof *session);
}

/* ---- frames ----------------------------------------------------------------------------- */

static bool submit(cli_session *session, lao_frame *frame) {
#ifdef LINEAO_HAVE_VK
    if (session->vk) {
        VkCommandBuffer commands = host_vk_begin(session->vk);
        if (!commands)
            return cli_fail("vk: the device is lost or out of memory");
        frame->commands = commands;
        if (lao_render(session->context, frame) != LAO_OK)
            return false; /* the session is closed with its commands unfinished */
        return host_vk_submit_and_wait(session->vk, commands) ||
               cli_fail("vk: the frame could not be submitted; the device may be lost");
    }
#endif
    return lao_render(session->context, frame) == LAO_OK;
}

void cli_session_frame(const cli_session *session, const cli_shot *shot, uint32_t frame_flags,
                       lao_frame *out) {
    lao_frame frame;
    memset(&frame, 0, sizeof frame);
    frame.view = session->view;
    memcpy(frame.camera.view, shot->view, sizeof shot->view);
    memcpy(frame.camera.projection, shot->projection, sizeof shot->projection);
    frame.camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    frame.sets = session->sets;
    frame.set_count = session->set_count;
    frame.flags = shot->frame_flags | frame_flags;
    memcpy(frame.background, shot->background, sizeof frame.background);
    memcpy(frame.sphere, shot->sphere, sizeof frame.sphere);
    frame.time = shot->time;
    *out = frame;
}

bool cli_session_render(cli_session *session, const cli_shot *shot, uint32_t frame_flags) {
    lao_frame frame;
    cli_session_frame(session, shot, frame_flags, &frame);
    double start = now(NULL);
    bool ok = cli_go_on() && use(session) && submit(session, &frame);
    session->milliseconds = 1e3 * (now(NULL) - start);
    return ok;
}

/* ---- images ----------------------------------------------------------------------------- */

static void flip(void *rows, uint32_t height, size_t stride) {
    uint8_t *top = rows, *bottom = top + (height - 1) * stride;
    for (; top < bottom; top += stride, bottom -= stride) {
        for (size_t i = 0; i < stride; i++) {
            uint8_t byte = top[i];
            top[i] = bottom[i];
            bottom[i] = byte;
        }
    }
}

uint8_t *cli_session_texels(cli_session *session, const char *name, uint32_t level,
                            lao_read_info *info) {
    memset(info, 0, sizeof *info);
    if (!use(session))
        return NULL;
    session->quiet = true;
    lao_result result = lao_read_raw(session->context, session->view, name, level, NULL, 0, info);
    session->quiet = false;
    if (result != LAO_OK || !info->width) {
        info->width = 0;
        return NULL;
    }
    size_t size = (size_t)info->width * info->height * info->channels;
    uint8_t *data = cli_new(size, 1);
    if (data &&
        lao_read_raw(session->context, session->view, name, level, data, size, NULL) == LAO_OK)
        return data;
    free(data);
    return NULL;
}

float *cli_session_image(cli_session *session, const char *name, uint32_t level,
                         lao_read_info *info) {
    memset(info, 0, sizeof *info);
    if (!use(session))
        return NULL;
    session->quiet = true;
    lao_result result = lao_read(session->context, session->view, name, level, NULL, 0, info);
    session->quiet = false;
    if (result != LAO_OK || !info->width) {
        info->width = 0;
        return NULL;
    }
    size_t count = (size_t)info->width * info->height * info->channels;
    float *data = cli_new(count, sizeof *data);
    if (!data ||
        lao_read(session->context, session->view, name, level, data, count, NULL) != LAO_OK) {
        free(data);
        return NULL;
    }
    flip(data, info->height, (size_t)info->width * info->channels * sizeof *data);
    return data;
}

/* Leaves the margin away. */
static void crop(uint8_t *pixels, lao_read_info *info, uint32_t margin) {
    uint32_t width = info->width - 2 * margin, height = info->height - 2 * margin;
    for (size_t y = 0; margin && y < height; y++)
        memmove(pixels + 4 * y * width, pixels + 4 * ((y + margin) * info->width + margin),
                4 * (size_t)width);
    info->width = width;
    info->height = height;
}

bool cli_session_picture(cli_session *session, picture *out) {
    lao_read_info info;
    uint8_t *pixels = cli_session_texels(session, "out", 0, &info);
    if (!pixels)
        return info.width == 0 && cli_fail("%s: the frame graph has no picture", session->backend);
    crop(pixels, &info, session->margin);
    flip(pixels, info.height, (size_t)info.width * 4);
    for (size_t i = 0; i < (size_t)info.width * info.height; i++) {
        uint8_t *p = pixels + 4 * i;
        for (int k = 0; k < 3 && p[3] != 0 && p[3] != 255; k++) {
            unsigned value = (p[k] * 255u + p[3] / 2u) / p[3];
            p[k] = (uint8_t)(value > 255 ? 255 : value);
        }
    }
    *out = (picture){info.width, info.height, pixels};
    return true;
}
