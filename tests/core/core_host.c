#include "core_host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

core_window core_seen;

static void host_log(void *user, lao_log_item item, lao_result result, const char *text) {
    core_host *host = (core_host *)user;
    host->logs++;
    host->seen[item]++;
    host->item = item;
    host->result = result;
    snprintf(host->text, sizeof host->text, "%s", text);
}

lao_logger core_logger(core_host *host) {
    lao_logger logger;
    logger.log = host_log;
    logger.user = host;
    return logger;
}

static lao_backend inner; /* the same functions in every context */

static lao_result window_attach(const lao_backend *backend, const lao_host *host, void **self,
                                lao_backend_caps *caps) {
    lao_result result = inner.attach(backend, host, self, caps);
    if (result == LAO_OK) {
        caps->max_buffer_texels =
            core_seen.max_buffer_texels ? core_seen.max_buffer_texels : caps->max_buffer_texels;
        caps->max_texture_units =
            core_seen.max_texture_units ? core_seen.max_texture_units : caps->max_texture_units;
        caps->max_image_size =
            core_seen.max_image_size ? core_seen.max_image_size : caps->max_image_size;
    }
    return result;
}

static lao_result window_buffer_create(void *self, const lao_buffer_desc *desc, void **buffer) {
    lao_result result = inner.buffer_create(self, desc, buffer);
    if (result == LAO_OK) {
        core_seen.buffers_alive++;
    }
    if (result == LAO_OK && core_seen.buffer_count < CORE_BUFFERS &&
        desc->texel_count <= CORE_TEXELS) {
        core_seen.buffers[core_seen.buffer_count].format = desc->format;
        core_seen.buffers[core_seen.buffer_count].texel_count = desc->texel_count;
        memcpy(core_seen.buffers[core_seen.buffer_count].texels, desc->data,
               (size_t)desc->texel_count * lao_format_bytes(desc->format));
        core_seen.buffer_count++;
    }
    return result;
}

static void window_buffer_destroy(void *self, void *buffer) {
    core_seen.buffers_alive--;
    inner.buffer_destroy(self, buffer);
}

static lao_result window_view_prepare(void *self, void *view, const lao_plan *plan,
                                      const lao_shader *const *shaders) {
    core_seen.prepares++;
    return inner.view_prepare(self, view, plan, shaders);
}

static lao_result window_execute(void *self, void *view, const lao_execution *execution) {
    lao_result result = inner.execute(self, view, execution);
    if (result == LAO_OK) {
        memcpy(&core_seen.frame, execution->frame_uniforms, sizeof core_seen.frame);
        memcpy(core_seen.settings, execution->set_uniforms, LAO_SETTING_COUNT * sizeof(float));
        core_seen.executions++;
        core_seen.parity = execution->parity;
        core_seen.set_count = execution->set_count;
        core_seen.plan = execution->plan;
    }
    return result;
}

void core_window_clear(void) {
    memset(&core_seen, 0, sizeof core_seen);
}

lao_backend core_backend(uint32_t fail_at) {
    lao_null_desc desc;
    lao_backend backend;
    memset(&desc, 0, sizeof desc);
    desc.fail_at = fail_at;
    lao_null_backend(&desc, &backend);
    inner = backend;
    backend.attach = window_attach;
    backend.buffer_create = window_buffer_create;
    backend.buffer_destroy = window_buffer_destroy;
    backend.view_prepare = window_view_prepare;
    backend.execute = window_execute;
    return backend;
}

lao_camera core_camera(void) {
    static const float n = 1, f = 100;
    lao_camera camera;
    memset(&camera, 0, sizeof camera);
    camera.view[0] = camera.view[5] = camera.view[10] = camera.view[15] = 1;
    camera.projection[0] = camera.projection[5] = 1;
    camera.projection[10] = -f / (f - n);
    camera.projection[14] = -n * f / (f - n);
    camera.projection[11] = -1;
    camera.flags = LAO_CAMERA_ZERO_TO_ONE;
    return camera;
}

uint32_t core_random(uint32_t *state) {
    uint32_t x;
    *state += 0x9e3779b9u;
    x = *state;
    x = (x ^ (x >> 16)) * 0x21f0aaadu;
    x = (x ^ (x >> 15)) * 0x735a2d97u;
    return x ^ (x >> 15);
}

double core_between(uint32_t *state, double low, double high) {
    return low + (high - low) * core_random(state) / 4294967295.0;
}
