/* ================================================================================================
 * object: buffers of texels that a host gives for its passes; views. Uses host and context. */

static lao_result lao__object_check(lao_context *context, const lao_object_desc *desc) {
    uint32_t i, k;
    if (desc->buffer_count > 0 && !desc->buffers) {
        return lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_object_desc.buffers");
    }
    for (i = 0; i < desc->buffer_count; i++) {
        const lao_object_buffer *buffer = &desc->buffers[i];
        uint32_t known = 0;
        for (k = 0; buffer->name && k < context->graph.buffer_count; k++) {
            known += strcmp(context->graph.buffers[k]->name, buffer->name) == 0;
        }
        for (k = 0; known && k < i; k++) {
            known = strcmp(desc->buffers[k].name, buffer->name) != 0 && known;
        }
        if (!known || !buffer->data || buffer->texel_count == 0 ||
            buffer->texel_count > context->caps.max_buffer_texels) {
            return lao__fail(context, LAO_LOG_OBJECT_BUFFER,
                             buffer->name ? buffer->name : "(no name)");
        }
    }
    if (desc->triangle_count > 0x2aaaaaaau) {
        return lao__fail(context, LAO_LOG_OBJECT_BUFFER, "triangle_count is beyond 32-bit indices");
    }
    return LAO_OK;
}

/* Uploads all buffers of desc, then puts them into `object` in place of those that are there. */
static lao_result lao__object_fill(lao_context *context, const lao_object_desc *desc,
                                   lao__object *object) {
    lao_chunk fresh;
    lao_result result = lao__object_check(context, desc);
    uint32_t i, k;
    memset(&fresh, 0, sizeof fresh);
    for (i = 0; i < desc->buffer_count && result == LAO_OK; i++) {
        lao_buffer_desc buffer;
        for (k = 0; strcmp(context->graph.buffers[k]->name, desc->buffers[i].name) != 0; k++) {
        }
        buffer.format = context->graph.buffers[k]->format;
        buffer.texel_count = desc->buffers[i].texel_count;
        buffer.data = desc->buffers[i].data;
        result = context->backend.buffer_create(context->self, &buffer, &fresh.buffers[k]);
    }
    if (result != LAO_OK) {
        lao__chunk_clear(context, &fresh);
        return result;
    }
    for (i = 0; i < LAO_MAX_BUFFERS; i++) {
        if (fresh.buffers[i]) {
            if (object->chunk.buffers[i]) {
                context->backend.buffer_destroy(context->self, object->chunk.buffers[i]);
            }
            object->chunk.buffers[i] = fresh.buffers[i];
        }
    }
    object->chunk.count = desc->triangle_count;
    object->item_count = desc->item_count;
    memcpy(object->further_items, desc->further_items, sizeof object->further_items);
    memcpy(object->bounds, desc->bounds, sizeof object->bounds);
    return LAO_OK;
}

lao_result lao_object_create(lao_context *context, const lao_object_desc *desc,
                             lao_object *object) {
    lao__object *made;
    lao_result result;
    uint32_t id;
    if (!context || !desc || !object) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_object_create")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    made = (lao__object *)lao__new(&context->allocator, 1, sizeof *made);
    if (!made) {
        return lao__fail(context, LAO_LOG_OBJECT_MEMORY, NULL);
    }
    result = lao__object_fill(context, desc, made);
    if (result == LAO_OK) {
        id = lao__handle_add(&context->allocator, &context->objects, made);
        if (id) {
            object->id = id;
            return LAO_OK;
        }
        result = lao__fail(context, LAO_LOG_OBJECT_MEMORY, NULL);
    }
    lao__object_free(context, made);
    return result;
}

static lao__object *lao__object_get(lao_context *context, lao_object object) {
    lao__handle *handle = lao__handle_get(&context->objects, object.id);
    return handle ? (lao__object *)handle->object : NULL;
}

lao_result lao_object_update(lao_context *context, lao_object object, const lao_object_desc *desc) {
    lao__object *found;
    if (!context || !desc) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_object_update")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    found = lao__object_get(context, object);
    return found ? lao__object_fill(context, desc, found)
                 : lao__fail(context, LAO_LOG_OBJECT_HANDLE, "lao_object_update");
}

lao_result lao_object_destroy(lao_context *context, lao_object object) {
    lao__handle *handle;
    if (!context) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    handle = lao__handle_get(&context->objects, object.id);
    if (!handle) {
        return lao__fail(context, LAO_LOG_OBJECT_HANDLE, "lao_object_destroy");
    }
    lao__object_free(context, (lao__object *)handle->object);
    handle->object = NULL;
    return LAO_OK;
}

/* ---- views */

static lao__view *lao__view_get(lao_context *context, lao_view view) {
    lao__handle *handle = lao__handle_get(&context->views, view.id);
    return handle ? (lao__view *)handle->object : NULL;
}

static int lao__view_size_ok(const lao_context *context, uint32_t width, uint32_t height) {
    return width > 0 && height > 0 && width <= context->caps.max_image_size &&
           height <= context->caps.max_image_size;
}

lao_result lao_view_create(lao_context *context, const lao_view_desc *desc, lao_view *view) {
    lao__view *object;
    lao_result result;
    uint32_t id = 0;
    if (!context || !desc || !view) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_view_create")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    if (!lao__view_size_ok(context, desc->width, desc->height)) {
        return lao__fail(context, LAO_LOG_VIEW_SIZE, "lao_view_create");
    }
    object = (lao__view *)lao__new(&context->allocator, 1, sizeof *object);
    if (!object) {
        return lao__fail(context, LAO_LOG_VIEW_MEMORY, NULL);
    }
    object->width = desc->width;
    object->height = desc->height;
    object->flags = desc->flags;
    result = context->backend.view_create(context->self, &object->backend_view);
    if (result == LAO_OK) {
        id = lao__handle_add(&context->allocator, &context->views, object);
        result = id ? LAO_OK : lao__fail(context, LAO_LOG_VIEW_MEMORY, NULL);
    }
    if (result != LAO_OK) {
        lao__view_free(context, object);
        return result;
    }
    view->id = id;
    return LAO_OK;
}

lao_result lao_view_resize(lao_context *context, lao_view view, uint32_t width, uint32_t height) {
    lao__view *object;
    if (!context) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    object = lao__view_get(context, view);
    if (!object) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_view_resize");
    }
    if (!lao__view_size_ok(context, width, height)) {
        return lao__fail(context, LAO_LOG_VIEW_SIZE, "lao_view_resize");
    }
    object->width = width;
    object->height = height;
    return LAO_OK;
}

lao_result lao_view_destroy(lao_context *context, lao_view view) {
    lao__handle *handle;
    if (!context) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    handle = lao__handle_get(&context->views, view.id);
    if (!handle) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_view_destroy");
    }
    lao__view_free(context, (lao__view *)handle->object);
    handle->object = NULL;
    return LAO_OK;
}
