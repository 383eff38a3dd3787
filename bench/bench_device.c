#include "bench_device.h"

#include "bench_scene.h"
#include "bench_host.h"

#ifdef LINEAO_HAVE_GL
#include "host_gl.h"
#endif
#ifdef LINEAO_HAVE_VK
#include "host_vk.h"
#endif

#include <string.h>

static double now(void *user) {
    (void)user;
    return bench_now();
}

static void on_log(void *user, lao_log_item item, lao_result result, const char *text) {
    const bench_device *device = user;
    (void)item;
    bench_fail("%s: %s: %s", device->backend, lao_result_text(result), text);
}

#ifdef LINEAO_HAVE_GL
static bool open_gl(bench_device *device) {
    char error[HOST_ERROR_SIZE];
    lao_gl_desc desc;
    if (!host_gl_open(NULL, &device->gl, error))
        return bench_fail("gl: %s", error);
    void *finish = host_gl_get_proc("glFinish", NULL);
    memcpy(&device->finish, &finish, sizeof finish);
    memset(&desc, 0, sizeof desc);
    desc.get_proc = host_gl_get_proc;
    desc.now = now;
    return (finish && lao_gl_backend(&desc, &device->functions) == LAO_OK) ||
           bench_fail("gl: the backend refused its context");
}
#endif

#ifdef LINEAO_HAVE_VK
static bool open_vk(bench_device *device) {
    char error[HOST_VK_ERROR_SIZE];
    lao_vk_desc desc;
    if (!host_vk_open(NULL, &device->vk, error))
        return bench_fail("vk: %s", error);
    desc = host_vk_lend(device->vk);
    return lao_vk_backend(&desc, &device->functions) == LAO_OK ||
           bench_fail("vk: the backend refused its device");
}
#endif

bool bench_device_open(bench_device *device, const char *backend) {
    memset(device, 0, sizeof *device);
    device->backend = backend;
#ifdef LINEAO_HAVE_GL
    if (strcmp(backend, "gl") == 0)
        return open_gl(device);
#endif
#ifdef LINEAO_HAVE_VK
    if (strcmp(backend, "vk") == 0)
        return open_vk(device);
#endif
    return bench_fail("--backend: %s was not built into this program", backend);
}

void bench_device_close(bench_device *device) {
#ifdef LINEAO_HAVE_GL
    host_gl_close(device->gl);
#endif
#ifdef LINEAO_HAVE_VK
    host_vk_close(device->vk);
#endif
    memset(device, 0, sizeof *device);
}

const char *bench_device_name(const bench_device *device) {
#ifdef LINEAO_HAVE_GL
    if (device->gl)
        return host_gl_renderer(device->gl);
#endif
#ifdef LINEAO_HAVE_VK
    if (device->vk)
        return host_vk_name(device->vk);
#endif
    (void)device;
    return "";
}

bool bench_device_context(bench_device *device, const lao_module *module, lao_context **context) {
    lao_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.backend = &device->functions;
    desc.logger.log = on_log;
    desc.logger.user = device;
    desc.modules = module ? &module : NULL;
    desc.module_count = module ? 1 : 0;
    return lao_create(&desc, context) == LAO_OK;
}

static bool draw(bench_device *device, lao_context *context, const lao_frame *frame) {
#ifdef LINEAO_HAVE_VK
    if (device->vk) {
        lao_frame recorded = *frame;
        VkCommandBuffer commands = host_vk_begin(device->vk);
        if (!commands)
            return bench_fail("vk: the device is lost or out of memory");
        recorded.commands = commands;
        return lao_render(context, &recorded) == LAO_OK &&
               (host_vk_submit_and_wait(device->vk, commands) ||
                bench_fail("vk: the frame could not be submitted; the device may be lost"));
    }
#endif
    if (lao_render(context, frame) != LAO_OK)
        return false;
    if (device->finish)
        device->finish();
    return true;
}

bool bench_device_frame(bench_device *device, lao_context *context, const lao_frame *frame,
                        double *milliseconds) {
    double start = bench_now();
    bool ok = draw(device, context, frame);
    *milliseconds = 1e3 * (bench_now() - start);
    return ok;
}
