/* ================================================================================================
 * read: images of the last frame as numbers. Uses host, graph, context and object. */

static lao_result lao__read_instance(lao_context *context, lao_view handle, const char *image,
                                     uint32_t level, lao__view **view,
                                     const lao_plan_instance **found) {
    uint32_t i, k, row;
    const lao_plan *plan;
    *found = NULL;
    if (!context || !image) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_read")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    *view = lao__view_get(context, handle);
    if (!*view) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_read");
    }
    if (!(*view)->rendered) {
        return lao__fail(context, LAO_LOG_NOTHING_RENDERED, image);
    }
    plan = &(*view)->plan;
    row = lao__image_find(&context->graph, image);
    /* of ping-pong partners the one that was written last */
    for (i = 0; i < plan->instance_count; i++) {
        const lao_plan_instance *instance = &plan->instances[i];
        if (instance->image == row && instance->level == level &&
            instance->import == LAO_NO_INDEX &&
            (!*found || instance->last_step > (*found)->last_step)) {
            *found = instance;
        }
    }
    for (i = 0; *found && i < plan->instance_count; i++) {
        for (k = 0; k < 2; k++) {
            if (plan->instances[i].slot[k] == (*found)->slot[0] &&
                plan->instances[i].first_step > (*found)->last_step) {
                return lao__fail(
                    context, LAO_LOG_IMAGE_UNKNOWN,
                    "its memory was used again; create the view with LAO_VIEW_KEEP_IMAGES");
            }
        }
    }
    return *found ? LAO_OK : lao__fail(context, LAO_LOG_IMAGE_UNKNOWN, image);
}

lao_result lao_read_raw(lao_context *context, lao_view view, const char *image, uint32_t level,
                        void *data, size_t capacity, lao_read_info *info) {
    lao__view *object = NULL;
    const lao_plan_instance *instance;
    lao_result result = lao__read_instance(context, view, image, level, &object, &instance);
    size_t size;
    if (result != LAO_OK) {
        return result;
    }
    size = (size_t)instance->width * instance->height * lao_format_bytes(instance->format);
    if (data && capacity < size) {
        return lao__fail(context, LAO_LOG_READ_SIZE, image);
    }
    if (data) {
        uint32_t parity = (object->frame - 1) & 1;
        result = context->backend.read(context->self, object->backend_view, &object->plan,
                                       instance->slot[parity], data, size);
    }
    if (result == LAO_OK && info) {
        info->width = instance->width;
        info->height = instance->height;
        info->channels = lao_format_bytes(instance->format);
    }
    return result;
}

static float lao__half(uint32_t h) {
    uint32_t sign = (h & 0x8000u) << 16, exponent = (h >> 10) & 31u, mantissa = h & 0x3ffu;
    if (exponent == 0) {
        float small = (float)mantissa * 5.96046448e-8f;
        return sign ? -small : small;
    }
    if (exponent == 31) {
        return lao_bits_float(sign | 0x7f800000u | (mantissa << 13));
    }
    return lao_bits_float(sign | ((exponent + 112u) << 23) | (mantissa << 13));
}

static uint32_t lao__channel_count(const lao_image_row *row) {
    static const uint8_t plain[LAO_FORMAT_COUNT] = {0, 4, 4, 4, 1, 1, 1, 0};
    static const uint8_t coded[] = {0, 3, 3};
    return row->encoding == LAO_ENCODING_PLAIN ? plain[row->format] : coded[row->encoding];
}

/* One raw texel to the numbers it stands for. align: of the set that wrote it. */
static void lao__decode(const lao_image_row *row, int32_t align, const uint8_t *texel, float *out) {
    float f[4] = {0, 0, 0, 0};
    lao_v4 v;
    uint16_t half[4];
    uint32_t word = 0;
    int i;
    if (row->format == LAO_FORMAT_RGBA8) {
        for (i = 0; i < 4; i++) {
            f[i] = (float)texel[i] * (1.0f / 255.0f); /* as devices do */
        }
    } else if (row->format == LAO_FORMAT_RGBA16F) {
        memcpy(half, texel, sizeof half);
        for (i = 0; i < 4; i++) {
            f[i] = lao__half(half[i]);
        }
    } else if (row->format == LAO_FORMAT_R32UI) {
        memcpy(&word, texel, sizeof word);
        f[0] = (float)word;
    } else {
        memcpy(f, texel, lao_format_bytes(row->format));
    }
    v = lao_v4_make(f[0], f[1], f[2], f[3]);
    if (row->encoding == LAO_ENCODING_LEVEL) {
        lao_v2 direction = lao_level_direction(word, align);
        v = lao_v4_make(direction.x, direction.y, lao_level_depth(word), 0);
    } else if (row->encoding == LAO_ENCODING_SIGNED8) {
        v = lao_v4_make(2 * v.x - 1, 2 * v.y - 1, 2 * v.z - 1, 0);
    }
    memcpy(out, &v, lao__channel_count(row) * sizeof *out);
}

lao_result lao_read(lao_context *context, lao_view view, const char *image, uint32_t level,
                    float *data, size_t capacity, lao_read_info *info) {
    lao__view *object = NULL;
    const lao_plan_instance *instance;
    const lao_image_row *row;
    lao_result result = lao__read_instance(context, view, image, level, &object, &instance);
    size_t i, texels, bytes;
    uint32_t channels, set;
    int32_t align;
    uint8_t *raw;
    if (result != LAO_OK) {
        return result;
    }
    row = context->graph.images[instance->image];
    set = object->plan.steps[instance->last_step].set;
    align =
        (int32_t)object->values[(size_t)set * context->value_count + (size_t)LAO_SETTING_ID_align];
    texels = (size_t)instance->width * instance->height;
    bytes = lao_format_bytes(row->format);
    channels = lao__channel_count(row);
    if (data) {
        if (capacity < texels * channels) {
            return lao__fail(context, LAO_LOG_READ_SIZE, image);
        }
        raw = (uint8_t *)lao__new(&context->allocator, texels, bytes);
        if (!raw) {
            return lao__fail(context, LAO_LOG_FRAME_MEMORY, NULL);
        }
        result = lao_read_raw(context, view, image, level, raw, texels * bytes, NULL);
        for (i = 0; i < texels && result == LAO_OK; i++) {
            lao__decode(row, align, raw + i * bytes, data + i * channels);
        }
        lao__delete(&context->allocator, raw, texels, bytes);
    }
    if (result == LAO_OK && info) {
        info->width = instance->width;
        info->height = instance->height;
        info->channels = channels;
    }
    return result;
}

lao_result lao_timings(lao_context *context, lao_view view, lao_timing *timings, uint32_t *count) {
    lao__view *object;
    lao_result result;
    double *milliseconds;
    uint32_t i, n;
    if (!context || !count) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_timings")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    object = lao__view_get(context, view);
    if (!object) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_timings");
    }
    if (!object->rendered || !object->timed) {
        return lao__fail(context, LAO_LOG_TIMINGS_OFF, NULL);
    }
    n = object->plan.step_count;
    milliseconds = (double *)lao__new(&context->allocator, n, sizeof *milliseconds);
    if (!milliseconds) {
        return lao__fail(context, LAO_LOG_FRAME_MEMORY, NULL);
    }
    result = context->backend.timings(context->self, object->backend_view, milliseconds, n);
    for (i = 0; result == LAO_OK && timings && i < n && i < *count; i++) {
        timings[i].pass = object->plan.steps[i].row->name;
        timings[i].set = object->plan.steps[i].set;
        timings[i].level = object->plan.steps[i].level;
        timings[i].milliseconds = milliseconds[i];
    }
    if (result == LAO_OK) {
        *count = n;
    }
    lao__delete(&context->allocator, milliseconds, n, sizeof *milliseconds);
    return result;
}
