/* ================================================================================================
 * context: handles, failures, and what a context owns. Uses tables and host. */

#define LAO__KEY_SIZE 9
#define LAO__GROUPS 256u /* of a chunk, at most */
#define LAO__PARTED 64u  /* lines; fewer are one part */
#define LAO__DENSE 4.0   /* pixels of a segment, at most, where parts pay */

typedef struct lao__lines {
    lao_chunk *chunks;
    uint32_t chunk_count;
    float bounds[2][3];
    int has_points;
} lao__lines;

typedef struct lao__object {
    lao_chunk chunk;
    uint32_t item_count, further_items[LAO_FURTHER_ITEMS];
    float bounds[2][3];
} lao__object;

typedef struct lao__view {
    uint32_t width, height, flags;
    void *backend_view;
    lao_plan plan;
    float *values; /* resolved settings of the sets that the plan was made for */
    const float **value_rows;
    uint8_t *uniforms; /* settings blocks of all sets */
    lao_draw *draws;
    uint32_t *buffers; /* per set: which buffers it has */
    uint32_t set_capacity;
    uint32_t key[LAO__KEY_SIZE];               /* structure: size, sets, imports, ... */
    uint32_t item_count;                       /* the most of its objects */
    uint32_t further_items[LAO_FURTHER_ITEMS]; /* likewise */
    uint32_t frame;                            /* counts rendered frames */
    uint32_t history;                          /* of them, since the plan was made */
    lao_camera previous;                       /* canonical camera of the last one */
    int prepared, rendered, timed;
} lao__view;

typedef struct lao__handle {
    void *object;
    uint32_t generation;
} lao__handle;

typedef struct lao__pool {
    lao__handle *handles;
    uint32_t count, capacity;
} lao__pool;

struct lao_context {
    lao_allocator allocator;
    lao_logger logger;
    lao_backend backend;
    lao_host host;
    lao_backend_caps caps;
    void *self; /* the backend's */
    lao_graph graph;
    const lao_shader **shaders; /* by graph.shader_names */
    uint32_t value_count;       /* settings of all modules */
    lao__pool lines, objects, views;
    uint32_t next_serial;
};

static lao_result lao__log(const lao_logger *logger, lao_log_item item, const char *detail) {
    static const struct {
        lao_result result;
        const char *text;
    } items[] = {
#define LAO__ITEM(id, result, text) {result, text},
        LAO_LOG_ITEMS(LAO__ITEM)
#undef LAO__ITEM
    };
    char text[1024];
    if (logger->log) {
        if (detail && *detail) {
            snprintf(text, sizeof text, "%s: %s", items[item].text, detail);
            logger->log(logger->user, item, items[item].result, text);
        } else {
            logger->log(logger->user, item, items[item].result, items[item].text);
        }
    }
    return items[item].result;
}

static lao_result lao__fail(lao_context *context, lao_log_item item, const char *detail) {
    return lao__log(&context->logger, item, detail);
}

static void lao__report(void *context, lao_log_item item, const char *detail) {
    lao__log(&((lao_context *)context)->logger, item, detail);
}

/* ---- handles: index in the low 20 bits, generation above; 0 is none */

#define LAO__INDEX_BITS 20u

static uint32_t lao__handle_add(const lao_allocator *allocator, lao__pool *pool, void *object) {
    uint32_t i;
    for (i = 0; i < pool->count && pool->handles[i].object; i++) {
    }
    if (i == pool->count) {
        if (i >= (1u << LAO__INDEX_BITS) - 1 ||
            lao__grow(allocator, (void **)&pool->handles, pool->count, &pool->capacity,
                      sizeof *pool->handles) != 0) {
            return 0;
        }
        pool->handles[i].generation = 0;
        pool->count++;
    }
    pool->handles[i].object = object;
    pool->handles[i].generation = (pool->handles[i].generation + 1) & 0xfffu;
    return (pool->handles[i].generation << LAO__INDEX_BITS) | (i + 1);
}

static lao__handle *lao__handle_get(lao__pool *pool, uint32_t id) {
    uint32_t i = (id & ((1u << LAO__INDEX_BITS) - 1)) - 1;
    if (id == 0 || i >= pool->count || !pool->handles[i].object ||
        pool->handles[i].generation != id >> LAO__INDEX_BITS) {
        return NULL;
    }
    return &pool->handles[i];
}

/* ---- create and destroy */

static lao_result lao__shaders_find(lao_context *context) {
    uint32_t i, k, m;
    context->shaders = (const lao_shader **)lao__new(&context->allocator, context->graph.pass_count,
                                                     sizeof *context->shaders);
    if (!context->shaders) {
        return lao__fail(context, LAO_LOG_CONTEXT_MEMORY, NULL);
    }
    for (i = 0; i < context->graph.shader_count; i++) {
        const char *name = context->graph.shader_names[i];
        for (k = 0; k < context->caps.shader_count; k++) {
            if (strcmp(context->caps.shaders[k].name, name) == 0) {
                context->shaders[i] = &context->caps.shaders[k];
            }
        }
        for (m = 0; m < context->graph.module_count; m++) {
            for (k = 0; k < context->graph.modules[m]->shader_count; k++) {
                if (strcmp(context->graph.modules[m]->shaders[k].name, name) == 0) {
                    context->shaders[i] = &context->graph.modules[m]->shaders[k];
                }
            }
        }
    }
    return LAO_OK;
}

static lao_result lao__graph_open(lao_context *context, const lao_desc *desc) {
    const lao_module *modules[16];
    char text[256];
    uint32_t m;
    if (desc->module_count > 0 && !desc->modules) {
        return lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_desc.modules");
    }
    if (desc->module_count >= 16) {
        return lao__fail(context, LAO_LOG_GRAPH_BROKEN, "more than 15 modules");
    }
    modules[0] = &lao__lines_module;
    for (m = 0; m < desc->module_count; m++) {
        modules[m + 1] = desc->modules[m];
    }
    if (lao_graph_make(modules, desc->module_count + 1, &context->allocator, &context->graph) !=
        LAO_OK) {
        return lao__fail(context, LAO_LOG_CONTEXT_MEMORY, NULL);
    }
    if (lao_graph_check(&context->graph, NULL, 0, text, sizeof text) != 0) {
        return lao__fail(context, LAO_LOG_GRAPH_BROKEN, text);
    }
    for (m = 0; m < context->graph.module_count; m++) {
        uint32_t rows = (context->graph.modules[m]->setting_count + 3) / 4;
        context->value_count += context->graph.modules[m]->setting_count;
        if (rows * 16 > context->host.settings_size) {
            context->host.settings_size = rows * 16;
        }
    }
    return LAO_OK;
}

lao_result lao_create(const lao_desc *desc, lao_context **context) {
    lao_logger silent;
    lao_allocator allocator;
    lao_context *c;
    lao_result result;
    memset(&silent, 0, sizeof silent);
    if (!desc || !context) {
        return lao__log(desc ? &desc->logger : &silent, LAO_LOG_NULL_ARGUMENT, "lao_create");
    }
    if (!desc->backend || !desc->backend->attach) {
        return lao__log(&desc->logger, LAO_LOG_BACKEND_MISSING, NULL);
    }
    if (desc->backend->abi != LAO_BACKEND_ABI) {
        return lao__log(&desc->logger, LAO_LOG_BACKEND_ABI, desc->backend->name);
    }
    allocator = lao__allocator_or_default(&desc->allocator);
    c = (lao_context *)lao__new(&allocator, 1, sizeof *c);
    if (!c) {
        return lao__log(&desc->logger, LAO_LOG_CONTEXT_MEMORY, NULL);
    }
    c->allocator = allocator;
    c->logger = desc->logger;
    c->backend = *desc->backend;
    c->host.allocator = allocator;
    c->host.report = lao__report;
    c->host.context = c;
    c->host.graph = &c->graph;
    result = lao__graph_open(c, desc);
    if (result == LAO_OK) {
        result = c->backend.attach(&c->backend, &c->host, &c->self, &c->caps);
    }
    if (result == LAO_OK) {
        result = lao__shaders_find(c);
    }
    if (result != LAO_OK) {
        lao_destroy(c);
        return result;
    }
    *context = c;
    return LAO_OK;
}

static void lao__chunk_clear(lao_context *context, lao_chunk *chunk) {
    uint32_t i;
    for (i = 0; i < LAO_MAX_BUFFERS; i++) {
        if (chunk->buffers[i]) {
            context->backend.buffer_destroy(context->self, chunk->buffers[i]);
        }
    }
    lao__delete(&context->allocator, (void *)chunk->groups, LAO__GROUPS, sizeof *chunk->groups);
    memset(chunk, 0, sizeof *chunk);
}

static void lao__lines_clear(lao_context *context, lao__lines *lines) {
    uint32_t i;
    for (i = 0; i < lines->chunk_count; i++) {
        lao__chunk_clear(context, &lines->chunks[i]);
    }
    lao__delete(&context->allocator, lines->chunks, lines->chunk_count, sizeof *lines->chunks);
    memset(lines, 0, sizeof *lines);
}

static void lao__view_frames_free(lao_context *context, lao__view *view) {
    uint32_t n = view->set_capacity, modules = context->graph.module_count;
    lao__delete(&context->allocator, view->values, (size_t)n * context->value_count,
                sizeof *view->values);
    lao__delete(&context->allocator, (void *)view->value_rows, n, sizeof *view->value_rows);
    lao__delete(&context->allocator, view->uniforms,
                (size_t)n * modules * context->host.settings_size, 1);
    lao__delete(&context->allocator, view->draws, n, sizeof *view->draws);
    lao__delete(&context->allocator, view->buffers, n, sizeof *view->buffers);
    view->values = NULL;
    view->value_rows = NULL;
    view->uniforms = NULL;
    view->draws = NULL;
    view->buffers = NULL;
    view->set_capacity = 0;
}

static void lao__view_free(lao_context *context, lao__view *view) {
    if (view->backend_view) {
        context->backend.view_destroy(context->self, view->backend_view);
    }
    lao_plan_free(&context->allocator, &view->plan);
    lao__view_frames_free(context, view);
    lao__delete(&context->allocator, view, 1, sizeof *view);
}

static void lao__object_free(lao_context *context, lao__object *object) {
    lao__chunk_clear(context, &object->chunk);
    lao__delete(&context->allocator, object, 1, sizeof *object);
}

void lao_destroy(lao_context *context) {
    lao_allocator allocator;
    uint32_t i;
    if (!context) {
        return;
    }
    for (i = 0; i < context->views.count; i++) {
        if (context->views.handles[i].object) {
            lao__view_free(context, (lao__view *)context->views.handles[i].object);
        }
    }
    for (i = 0; i < context->lines.count; i++) {
        if (context->lines.handles[i].object) {
            lao__lines_clear(context, (lao__lines *)context->lines.handles[i].object);
            lao__delete(&context->allocator, context->lines.handles[i].object, 1,
                        sizeof(lao__lines));
        }
    }
    for (i = 0; i < context->objects.count; i++) {
        if (context->objects.handles[i].object) {
            lao__object_free(context, (lao__object *)context->objects.handles[i].object);
        }
    }
    if (context->self) {
        context->backend.detach(context->self);
    }
    lao__delete(&context->allocator, context->views.handles, context->views.capacity,
                sizeof *context->views.handles);
    lao__delete(&context->allocator, context->lines.handles, context->lines.capacity,
                sizeof *context->lines.handles);
    lao__delete(&context->allocator, context->objects.handles, context->objects.capacity,
                sizeof *context->objects.handles);
    lao__delete(&context->allocator, (void *)context->shaders, context->graph.pass_count,
                sizeof *context->shaders);
    lao_graph_free(&context->allocator, &context->graph);
    allocator = context->allocator;
    lao__delete(&allocator, context, 1, sizeof *context);
}
