/* ================================================================================================
 * null_backend: an executor that draws nothing and writes what it would do. Uses host. */

typedef struct lao__null {
    lao_null_desc desc;
    const lao_host *host;
    uint32_t calls;
} lao__null;

static lao_result lao__null_call(lao__null *null, const char *name) {
    null->calls++;
    if (null->desc.fail_at == null->calls) {
        null->host->report(null->host->context, LAO_LOG_BACKEND_CALL, name);
        return LAO_ERROR_BACKEND;
    }
    return LAO_OK;
}

static lao_result lao__null_attach(const lao_backend *backend, const lao_host *host, void **self,
                                   lao_backend_caps *caps) {
    lao__null *null = (lao__null *)lao__new(&host->allocator, 1, sizeof *null);
    lao_result result;
    if (!null) {
        host->report(host->context, LAO_LOG_BACKEND_MEMORY, "null");
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    memcpy(&null->desc, backend->storage, sizeof null->desc);
    null->host = host;
    result = lao__null_call(null, "attach");
    if (result != LAO_OK) {
        lao__delete(&host->allocator, null, 1, sizeof *null);
        return result;
    }
    *self = null;
    caps->max_image_size = 16384;
    caps->max_texture_units = 32;
    caps->max_buffer_texels = 1u << 27;
    caps->shaders = null->desc.shaders;
    caps->shader_count = null->desc.shader_count;
    return LAO_OK;
}

static void lao__null_detach(void *self) {
    lao__null *null = (lao__null *)self;
    lao_allocator allocator = null->host->allocator;
    lao__delete(&allocator, null, 1, sizeof *null);
}

static lao_result lao__null_make(lao__null *null, const char *name, void **object) {
    lao_result result = lao__null_call(null, name);
    void *memory;
    if (result != LAO_OK) {
        return result;
    }
    memory = lao__new(&null->host->allocator, 1, 1);
    if (!memory) {
        null->host->report(null->host->context, LAO_LOG_BACKEND_MEMORY, name);
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    *object = memory;
    return LAO_OK;
}

static lao_result lao__null_buffer_create(void *self, const lao_buffer_desc *desc, void **buffer) {
    (void)desc;
    return lao__null_make((lao__null *)self, "buffer_create", buffer);
}

static lao_result lao__null_view_create(void *self, void **view) {
    return lao__null_make((lao__null *)self, "view_create", view);
}

static void lao__null_object_destroy(void *self, void *object) {
    lao__delete(&((lao__null *)self)->host->allocator, object, 1, 1);
}

static lao_result lao__null_view_prepare(void *self, void *view, const lao_plan *plan,
                                         const lao_shader *const *shaders) {
    (void)view;
    (void)plan;
    (void)shaders;
    return lao__null_call((lao__null *)self, "view_prepare");
}

static lao_result lao__null_execute(void *self, void *view, const lao_execution *execution) {
    lao__null *null = (lao__null *)self;
    lao_result result = lao__null_call(null, "execute");
    (void)view;
    if (result == LAO_OK && null->desc.write) {
        lao_plan_print(null->host->graph, execution->plan, null->desc.write, null->desc.user);
    }
    return result;
}

static lao_result lao__null_read(void *self, void *view, const lao_plan *plan, uint32_t slot,
                                 void *data, size_t size) {
    (void)view;
    (void)plan;
    (void)slot;
    {
        lao_result result = lao__null_call((lao__null *)self, "read");
        if (result == LAO_OK) {
            memset(data, 0, size);
        }
        return result;
    }
}

static lao_result lao__null_timings(void *self, void *view, double *milliseconds,
                                    uint32_t step_count) {
    (void)view;
    (void)milliseconds;
    (void)step_count;
    return lao__null_call((lao__null *)self, "timings");
}

lao_result lao_null_backend(const lao_null_desc *desc, lao_backend *backend) {
    if (!backend) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    memset(backend, 0, sizeof *backend);
    backend->abi = LAO_BACKEND_ABI;
    backend->name = "null";
    if (desc) {
        memcpy(backend->storage, desc, sizeof *desc);
    }
    backend->attach = lao__null_attach;
    backend->detach = lao__null_detach;
    backend->buffer_create = lao__null_buffer_create;
    backend->buffer_destroy = lao__null_object_destroy;
    backend->view_create = lao__null_view_create;
    backend->view_destroy = lao__null_object_destroy;
    backend->view_prepare = lao__null_view_prepare;
    backend->execute = lao__null_execute;
    backend->read = lao__null_read;
    backend->timings = lao__null_timings;
    return LAO_OK;
}

#ifdef __cplusplus
}
#endif

#endif /* LINEAO_IMPLEMENTATION_DONE */
#endif /* LINEAO_IMPLEMENTATION */
