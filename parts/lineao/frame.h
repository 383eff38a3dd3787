/* ================================================================================================
 * frame: lao_render: settings and imports resolved, the plan renewed where they ask for it,
   uniforms and draws filled. Uses all sections before it. */

static lao_result lao__view_reserve(lao_context *context, lao__view *view, uint32_t sets) {
    if (sets <= view->set_capacity) {
        return LAO_OK;
    }
    lao__view_frames_free(context, view);
    view->prepared = 0;
    view->set_capacity = sets;
    view->values = (float *)lao__new(&context->allocator, (size_t)sets * context->value_count,
                                     sizeof *view->values);
    view->value_rows =
        (const float **)lao__new(&context->allocator, sets, sizeof *view->value_rows);
    view->uniforms = (uint8_t *)lao__new(
        &context->allocator,
        (size_t)sets * context->graph.module_count * context->host.settings_size, 1);
    view->draws = (lao_draw *)lao__new(&context->allocator, sets, sizeof *view->draws);
    view->buffers = (uint32_t *)lao__new(&context->allocator, sets, sizeof *view->buffers);
    if (!view->values || !view->value_rows || !view->uniforms || !view->draws || !view->buffers) {
        lao__view_frames_free(context, view);
        return lao__fail(context, LAO_LOG_FRAME_MEMORY, NULL);
    }
    return LAO_OK;
}

/* Resolves one set's settings; sets *structural when a value that shapes the plan changed. */
/* Is it worth while to draw a set's lines in parts? Not where few lie behind each other. */
static int lao__parted(const lao__view *view, const lao_frame *frame, uint32_t set,
                       const float *values) {
    const int trail = (int)values[LAO_SETTING_ID_trail];
    const lao_draw *draw = &view->draws[set];
    const double factor = values[LAO_SETTING_ID_supersampling];
    const double pixels = factor * factor * view->width * view->height;
    double segments = 0, rest = 0;
    uint32_t i;
    for (i = 0; i < draw->chunk_count; i++) {
        segments += draw->chunks[i].count;
        rest += draw->chunks[i].count - draw->chunks[i].ends[0];
    }
    for (i = 0; i < frame->import_count; i++) { /* a G-buffer of the host's: nothing is drawn */
        const char *image = frame->imports[i].image;
        rest = image && strcmp(image, "host_depth") == 0 ? rest : 0;
    }
    return values[LAO_SETTING_ID_cull_hidden] > 0 && trail != LAO_TRAIL_TAPER &&
           trail != LAO_TRAIL_OPACITY && rest > 0 && segments * LAO__DENSE >= pixels;
}

static lao_result lao__set_resolve(lao_context *context, lao__view *view, const lao_frame *frame,
                                   uint32_t set, const lao_set *source, int *structural) {
    float *values = view->values + (size_t)set * context->value_count;
    uint32_t m, i, first = 0;
    char text[128];
    for (m = 0; m < context->graph.module_count; m++) {
        const lao_module *module = context->graph.modules[m];
        uint8_t *block = view->uniforms + ((size_t)set * context->graph.module_count + m) *
                                              context->host.settings_size;
        const void *settings = NULL;
        float fresh[LAO__MOST_SETTINGS];
        int fault;
        if (source && m == 0) {
            settings = source->settings;
        } else if (source && source->module_settings) {
            settings = source->module_settings[m - 1];
        }
        fault = lao_settings_resolve(module, settings, fresh);
        if (fault >= 0) {
            const lao_setting_row *row = &module->settings[fault];
            snprintf(text, sizeof text, "%s = %g, must be %g to %g", row->name,
                     (double)fresh[fault], (double)row->minimum, (double)row->maximum);
            return lao__fail(context, LAO_LOG_SETTING_RANGE, text);
        }
        memcpy(block, fresh, module->setting_count * sizeof *fresh);
        if (m == 0) { /* the plan follows what is done */
            view->draws[set].parted = lao__parted(view, frame, set, fresh);
            fresh[LAO_SETTING_ID_cull_hidden] = view->draws[set].parted ? LAO_PARTS - 1.0f : 0.0f;
        }
        for (i = 0; i < module->setting_count; i++) {
            *structural |= module->settings[i].structural && fresh[i] != values[first + i];
        }
        memcpy(values + first, fresh, module->setting_count * sizeof *fresh);
        first += module->setting_count;
    }
    view->value_rows[set] = values;
    return LAO_OK;
}

static uint32_t lao__mix(uint32_t h, uint32_t v) {
    return lao_hash(h ^ (v + 0x9e3779b9u + (h << 6)));
}

/* What besides settings shapes a plan. */
static void lao__plan_key(const lao__view *view, const lao_frame *frame, uint32_t sets,
                          uint32_t key[LAO__KEY_SIZE]) {
    uint32_t i;
    memset(key, 0, LAO__KEY_SIZE * sizeof *key);
    key[0] = view->width;
    key[1] = view->height;
    key[2] = sets;
    key[3] = frame->camera.flags & LAO_CAMERA_REVERSE_DEPTH;
    key[4] = frame->target.present != 0;
    key[5] = frame->import_count;
    for (i = 0; i < frame->import_count; i++) {
        const char *c;
        for (c = frame->imports[i].image; *c; c++) {
            key[6] = lao__mix(key[6], (uint32_t)(unsigned char)*c);
        }
        key[6] = lao__mix(key[6], frame->imports[i].source.flags & LAO_HOST_WRITABLE);
    }
    key[8] = lao__mix(view->item_count, frame->flags & LAO_FRAME_SHARED_OCCLUSION);
    for (i = 0; i < LAO_FURTHER_ITEMS; i++) {
        key[8] = lao__mix(key[8], view->further_items[i]);
    }
    for (i = 0; i < sets; i++) {
        key[8] = lao__mix(key[8], view->buffers[i]);
    }
    /* attachments of pipelines carry the host's formats */
    key[7] = lao__mix(frame->target.native_format, frame->target.flags & LAO_HOST_ENCODE_SRGB);
    for (i = 0; i < frame->import_count; i++) {
        key[7] = lao__mix(key[7], frame->imports[i].source.native_format);
    }
}

static lao_result lao__imports_check(lao_context *context, const lao__view *view,
                                     const lao_frame *frame) {
    uint32_t i, factor = (uint32_t)view->values[LAO_SETTING_ID_supersampling];
    if (frame->target.present &&
        (frame->target.width != view->width || frame->target.height != view->height)) {
        return lao__fail(context, LAO_LOG_TARGET, "lao_frame.target");
    }
    for (i = 0; i < frame->import_count; i++) {
        const lao_import *import = &frame->imports[i];
        uint32_t image =
            import->image ? lao__image_find(&context->graph, import->image) : LAO_NO_INDEX;
        uint32_t scale;
        if (image == LAO_NO_INDEX || !import->source.present ||
            strcmp(import->image, "target") == 0) {
            return lao__fail(context, LAO_LOG_IMPORT, import->image ? import->image : "(no name)");
        }
        scale = context->graph.images[image]->size == LAO_SIZE_FULL ? factor : 1;
        if (import->source.width != view->width * scale ||
            import->source.height != view->height * scale) {
            return lao__fail(context, LAO_LOG_IMPORT, import->image);
        }
    }
    return LAO_OK;
}

/* An import drops the passes that make its image; what else they made must then not be missed. */
static const char *lao__missing_image(const lao_graph *graph, const lao_plan *plan, uint32_t s) {
    const lao_plan_step *step = &plan->steps[s];
    uint32_t i;
    for (i = 0; i < step->read_count; i++) {
        if (step->reads[i] < plan->instance_count) {
            const lao_plan_instance *instance = &plan->instances[step->reads[i]];
            const lao_image_row *row = graph->images[instance->image];
            int previous = (row->flags & LAO_IMAGE_HISTORY) && instance->phase == 1;
            if (instance->import == LAO_NO_INDEX && !previous &&
                !lao__is_written(plan, step->reads[i], s)) {
                return row->name;
            }
        }
    }
    return NULL;
}

static lao_result lao__plan_check(lao_context *context, const lao_plan *plan,
                                  const uint32_t *buffers) {
    uint32_t s, i, n;
    char text[160];
    for (s = 0; s < plan->step_count; s++) {
        const lao_plan_step *step = &plan->steps[s];
        const char *missing = lao__missing_image(&context->graph, plan, s);
        if (missing) {
            snprintf(text, sizeof text, "'%s' is not imported, and nothing else makes it", missing);
            return lao__fail(context, LAO_LOG_IMPORT, text);
        }
        for (i = 0, n = 0; i < step->read_count; i++) {
            int absent = step->reads[i] == LAO_NO_INDEX ||
                         (LAO_READ_IS_BUFFER(step->reads[i]) &&
                          !((buffers[step->set] >> (step->reads[i] - LAO_READ_BUFFER)) & 1u));
            n += !absent && (i == 0 || step->reads[i] != step->reads[i - 1]);
        }
        if (n > context->caps.max_texture_units) {
            return lao__fail(context, LAO_LOG_UNITS, step->row->name);
        }
        if (step->width > context->caps.max_image_size ||
            step->height > context->caps.max_image_size) {
            return lao__fail(context, LAO_LOG_VIEW_SIZE, step->row->name);
        }
    }
    return LAO_OK;
}

static lao_result lao__view_plan(lao_context *context, lao__view *view, const lao_frame *frame,
                                 uint32_t sets) {
    lao_plan_desc desc;
    lao_result result;
    memset(&desc, 0, sizeof desc);
    desc.width = view->width;
    desc.height = view->height;
    desc.flags = view->flags;
    desc.reverse_depth = (frame->camera.flags & LAO_CAMERA_REVERSE_DEPTH) != 0;
    desc.set_count = sets;
    desc.values = view->value_rows;
    desc.imports = frame->imports;
    desc.import_count = frame->import_count;
    desc.has_target = frame->target.present != 0;
    desc.shaders = context->shaders;
    desc.item_count = view->item_count;
    memcpy(desc.further_items, view->further_items, sizeof desc.further_items);
    desc.buffers = view->buffers;
    desc.shared_occlusion = (frame->flags & LAO_FRAME_SHARED_OCCLUSION) != 0;
    view->prepared = 0;
    view->rendered = 0;
    view->history = 0;
    view->plan.serial = context->next_serial++;
    if (lao_plan_make(&context->graph, &desc, &context->allocator, &view->plan) != LAO_OK) {
        return lao__fail(context, LAO_LOG_PLAN_MEMORY, NULL);
    }
    result = lao__plan_check(context, &view->plan, view->buffers);
    if (result == LAO_OK) {
        result = context->backend.view_prepare(context->self, view->backend_view, &view->plan,
                                               context->shaders);
    }
    view->prepared = result == LAO_OK;
    return result;
}

/* Centre and radius of everything that is drawn (METHODS 1.3). */
static void lao__scene_sphere(lao_context *context, const lao_frame *frame, float least,
                              double sphere[4]) {
    double lo[3] = {0, 0, 0}, hi[3] = {0, 0, 0}, squared = 0;
    uint32_t s, k;
    int any = 0;
    if (frame->sphere[3] > 0) {
        for (k = 0; k < 4; k++) {
            sphere[k] = frame->sphere[k];
        }
        return;
    }
    for (s = 0; s < 2 * frame->set_count; s++) {
        const lao_set *set = &frame->sets[s / 2];
        const lao__lines *lines = s & 1 ? NULL : lao__lines_get(context, set->lines);
        const lao__object *object = s & 1 ? lao__object_get(context, set->object) : NULL;
        const float(*box)[3] = lines && lines->has_points ? (const float(*)[3])lines->bounds
                               : object                   ? (const float(*)[3])object->bounds
                                                          : NULL;
        for (k = 0; box && k < 3; k++) {
            lo[k] = any && lo[k] < box[0][k] ? lo[k] : box[0][k];
            hi[k] = any && hi[k] > box[1][k] ? hi[k] : box[1][k];
        }
        any |= box != NULL;
    }
    for (k = 0; k < 3; k++) {
        sphere[k] = 0.5 * (lo[k] + hi[k]);
        squared += 0.25 * (hi[k] - lo[k]) * (hi[k] - lo[k]);
    }
    sphere[3] = sqrt(squared);
    sphere[3] = sphere[3] < 0.5 * least ? 0.5 * least : sphere[3];
}

static lao_v4 lao__column(const float *m) {
    return lao_v4_make(m[0], m[1], m[2], m[3]);
}

static lao_m4 lao__matrix(const float m[16]) {
    lao_m4 r;
    r.x = lao__column(m);
    r.y = lao__column(m + 4);
    r.z = lao__column(m + 8);
    r.w = lao__column(m + 12);
    return r;
}

/* The inverse of an affine matrix; lao_camera_canonical has refused singular ones. */
static lao_m4 lao__affine_inverse(const float m[16]) {
    double a[3][3], inverse[3][3], d;
    float out[16];
    int r, c;
    for (r = 0; r < 3; r++) {
        for (c = 0; c < 3; c++) {
            a[r][c] = m[c * 4 + r];
        }
    }
    d = lao__determinant3((const double(*)[3])a);
    memset(out, 0, sizeof out);
    for (r = 0; r < 3; r++) {
        for (c = 0; c < 3; c++) { /* cofactors, transposed */
            int i = (c + 1) % 3, k = (c + 2) % 3, j = (r + 1) % 3, l = (r + 2) % 3;
            inverse[r][c] = (a[i][j] * a[k][l] - a[i][l] * a[k][j]) / d;
            out[c * 4 + r] = (float)inverse[r][c];
        }
    }
    for (r = 0; r < 3; r++) {
        out[12 + r] =
            (float)-(inverse[r][0] * m[12] + inverse[r][1] * m[13] + inverse[r][2] * m[14]);
    }
    out[15] = 1;
    return lao__matrix(out);
}

static void lao__frame_uniforms_fill(const lao__view *view, const lao_frame *frame,
                                     const lao_camera *camera, const double sphere[4],
                                     lao_frame_uniforms *u) {
    const float *p = camera->projection, *v = camera->view;
    double factor = view->values[LAO_SETTING_ID_supersampling];
    double w = view->width * factor, h = view->height * factor;
    double zc = -(v[2] * sphere[0] + v[6] * sphere[1] + v[10] * sphere[2] + v[14]);
    double range = 2 * sphere[3];
    const lao_image *depth = NULL;
    uint32_t i;
    int orthographic = p[11] == 0, mm = view->values[LAO_SETTING_ID_depth_unit] > 0.5f;
    memset(u, 0, sizeof *u);
    u->view = lao__matrix(v);
    u->projection = lao__matrix(p);
    u->world = lao__affine_inverse(v);
    /* ndc = P00 slope - P02 (perspective), P00 x + P03 (orthographic) */
    u->ray.x = (float)(2 / (w * p[0]));
    u->ray.y = (float)(2 / (h * p[5]));
    u->ray.z = (float)((-1 + (orthographic ? -p[12] : p[8])) / p[0]);
    u->ray.w = (float)((-1 + (orthographic ? -p[13] : p[9])) / p[5]);
    u->viewport = lao_v4_make((float)w, (float)h, (float)(1 / w), (float)(1 / h));
    u->depth = lao_v4_make((float)(zc - sphere[3]), (float)(1 / range), (float)range,
                           orthographic ? 1.0f : 0.0f);
    u->scale = lao_v4_make((float)(0.5 * w * p[0]), (float)(0.5 * h * p[5]),
                           camera->flags & LAO_CAMERA_REVERSE_DEPTH ? 1.0f : 0.0f, frame->time);
    u->unproject = lao_v4_make(p[14], -p[15], p[10], -p[11]);
    {
        const float *b = frame->background;
        float alpha = lao_clamp01(b[3]);
        u->background = lao_v4_make(lao_clamp01(b[0]) * alpha, lao_clamp01(b[1]) * alpha,
                                    lao_clamp01(b[2]) * alpha, alpha);
    }
    u->target = lao_v4_make((float)frame->target.width, (float)frame->target.height,
                            frame->target.flags & LAO_HOST_TOP_DOWN ? 1.0f : 0.0f,
                            frame->target.flags & LAO_HOST_ENCODE_SRGB ? 1.0f : 0.0f);
    for (i = 0; i < frame->import_count; i++) {
        depth =
            strcmp(frame->imports[i].image, "host_depth") == 0 ? &frame->imports[i].source : depth;
    }
    if (depth) {
        u->host_depth = lao_v4_make((float)depth->width, (float)depth->height,
                                    depth->flags & LAO_HOST_TOP_DOWN ? 1.0f : 0.0f, 0.0f);
    }
    u->host_depth.w =
        mm ? (float)range : 1.0f; /* depth differences times this are what the thresholds mean */
    u->previous_view = lao__matrix(view->history ? view->previous.view : v);
    u->previous_projection = lao__matrix(view->history ? view->previous.projection : p);
    u->history.x = (float)(view->history < 0xffffffu ? view->history : 0xffffffu);
}

/* The window of time that a trail leaves of a set's lines. */
static lao_window lao__window(const float *values, float time) {
    const int trail = (int)values[LAO_SETTING_ID_trail];
    lao_window window;
    window.limited = trail == LAO_TRAIL_TAPER || trail == LAO_TRAIL_OPACITY;
    window.length = values[LAO_SETTING_ID_trail_length];
    window.period = values[LAO_SETTING_ID_period];
    window.now = lao_trail_now(time, window.period);
    return window;
}

/* Settings, lines and object of one set. */
static lao_result lao__frame_set(lao_context *context, lao__view *view, const lao_frame *frame,
                                 const lao_set *set, uint32_t index, int *structural) {
    const lao__lines *lines = set ? lao__lines_get(context, set->lines) : NULL;
    const lao__object *object = set ? lao__object_get(context, set->object) : NULL;
    lao_draw *draw = &view->draws[index];
    lao_result result;
    uint32_t i;
    if (set && set->lines.id != 0 && !lines) {
        return lao__fail(context, LAO_LOG_LINES_HANDLE, "lao_frame.sets");
    }
    if (set && set->object.id != 0 && !object) {
        return lao__fail(context, LAO_LOG_OBJECT_HANDLE, "lao_frame.sets");
    }
    memset(draw, 0, sizeof *draw);
    if (lines && lines->chunk_count > 0) {
        draw->chunks = lines->chunks;
        draw->chunk_count = lines->chunk_count;
    }
    draw->object = object ? &object->chunk : NULL;
    /* the first set, and one that draws nothing, clear what others draw into */
    view->buffers[index] = index == 0 || !object ? LAO__LINE_BUFFERS : 0;
    for (i = 0; i < LAO_MAX_BUFFERS; i++) {
        if ((draw->chunks && draw->chunks[0].buffers[i]) ||
            (draw->object && draw->object->buffers[i])) {
            view->buffers[index] |= 1u << i;
        }
    }
    if (object && object->item_count > view->item_count) {
        view->item_count = object->item_count;
    }
    for (i = 0; object && i < LAO_FURTHER_ITEMS; i++) {
        if (object->further_items[i] > view->further_items[i]) {
            view->further_items[i] = object->further_items[i];
        }
    }
    result = lao__set_resolve(context, view, frame, index, set, structural);
    draw->window = lao__window(view->value_rows[index], frame->time);
    return result;
}

static lao_result lao__frame_sets(lao_context *context, lao__view *view, const lao_frame *frame,
                                  uint32_t sets, int *structural) {
    lao_result result = LAO_OK;
    uint32_t s;
    view->item_count = 0;
    memset(view->further_items, 0, sizeof view->further_items);
    for (s = 0; s < sets && result == LAO_OK; s++) {
        result = lao__frame_set(context, view, frame, s < frame->set_count ? &frame->sets[s] : NULL,
                                s, structural);
    }
    return result;
}

uint32_t lao_step_draws(const lao_execution *execution, const lao_plan_step *step,
                        const lao_chunk **chunks) {
    static const lao_chunk nothing = {{NULL}, 0, {0}, NULL, 0};
    const lao_draw *draw = &execution->draws[step->set];
    switch (step->row->kind) {
    case LAO_PASS_DRAW_LINES:
    case LAO_PASS_DRAW_LINES_FIRST:
    case LAO_PASS_DRAW_LINES_REST:
        *chunks = draw->chunks;
        return draw->chunk_count;
    case LAO_PASS_DRAW_MESH:
        *chunks = draw->object;
        return draw->object && draw->object->count > 0;
    default:
        *chunks = draw->object ? draw->object : &nothing;
        return 1;
    }
}

/* Does some repetition of the window reach the group? Rather too often than that rounding lets the
   vertex stage see what is left out here. */
static int lao__group_seen(const lao_group *group, const lao_window *window) {
    const double now = window->now, reach = window->length, period = window->period;
    const double begin = group->begin, end = group->end;
    const double slack = 1e-5 * (fabs(begin) + fabs(end) + fabs(now) + reach + period);
    const double low = begin - now - reach - slack, high = end - now + reach + slack;
    return !(period > 0 ? period * floor(high / period) < low : low > 0 || high < 0);
}

static void lao__range_part(lao_range *range, const lao_draw *draw, const lao_chunk *chunk,
                            const lao_plan_step *step) {
    const lao_pass_kind kind = step->row->kind;
    const uint32_t part = kind == LAO_PASS_DRAW_LINES_REST ? step->iteration + 1 : 0;
    const int whole = kind == LAO_PASS_DRAW_LINES || !draw->parted;
    range->first = part > 0 ? chunk->ends[part - 1] : 0;
    range->count = (whole ? chunk->count : chunk->ends[part]) - range->first;
}

int lao_step_range(const lao_execution *execution, const lao_plan_step *step,
                   const lao_chunk *chunk, lao_range *range) {
    const lao_window *window = &execution->draws[step->set].window;
    const lao_group *groups = chunk->groups;
    uint32_t i, g = range->next;
    int ordered = 0;
    for (i = 0; i < step->read_count; i++) {
        ordered |= step->reads[i] == LAO_READ_BUFFER + LAO__BUFFER_ORDER;
    }
    if (!ordered || !window->limited || !groups) {
        lao__range_part(range, &execution->draws[step->set], chunk, step);
        return range->next++ == 0 && range->count > 0;
    }
    while (g < chunk->group_count && !lao__group_seen(&groups[g], window)) {
        g++;
    }
    for (i = g; g < chunk->group_count && lao__group_seen(&groups[g], window); g++) {
        range->first = groups[i].first;
        range->count = groups[g].first + groups[g].count - range->first;
    }
    range->next = g;
    return g > i;
}

static lao_result lao__frame_execute(lao_context *context, lao__view *view, const lao_frame *frame,
                                     const lao_camera *camera, uint32_t sets) {
    lao_execution execution;
    lao_frame_uniforms uniforms;
    double sphere[4];
    float widest = 0;
    lao_result result;
    uint32_t s;
    for (s = 0; s < sets; s++) {
        widest = lao_max(widest, view->value_rows[s][LAO_SETTING_ID_width]);
    }
    lao__scene_sphere(context, frame, widest, sphere);
    lao__frame_uniforms_fill(view, frame, camera, sphere, &uniforms);
    memset(&execution, 0, sizeof execution);
    execution.plan = &view->plan;
    execution.parity = view->frame & 1;
    execution.frame_uniforms = &uniforms;
    execution.frame_size = (uint32_t)sizeof uniforms;
    execution.set_uniforms = view->uniforms;
    execution.draws = view->draws;
    execution.set_count = sets;
    execution.imports = frame->imports;
    execution.import_count = frame->import_count;
    execution.target = frame->target;
    execution.flags = frame->flags;
    execution.commands = frame->commands;
    result = context->backend.execute(context->self, view->backend_view, &execution);
    if (result == LAO_OK) {
        view->frame++;
        view->history++;
        view->previous = *camera;
        view->rendered = 1;
        view->timed = (frame->flags & LAO_FRAME_TIMINGS) != 0;
    }
    return result;
}

lao_result lao_render(lao_context *context, const lao_frame *frame) {
    lao__view *view;
    lao_camera camera;
    lao_result result;
    uint32_t sets, key[LAO__KEY_SIZE];
    int structural = 0;
    if (!context || !frame || (frame->set_count > 0 && !frame->sets) ||
        (frame->import_count > 0 && !frame->imports)) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_render")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    view = lao__view_get(context, frame->view);
    if (!view) {
        return lao__fail(context, LAO_LOG_VIEW_HANDLE, "lao_render");
    }
    if (lao_camera_canonical(&frame->camera, &camera) != 0) {
        return lao__fail(context, LAO_LOG_CAMERA, NULL);
    }
    sets = frame->set_count > 0 ? frame->set_count : 1;
    result = lao__view_reserve(context, view, sets);
    if (result == LAO_OK) {
        result = lao__frame_sets(context, view, frame, sets, &structural);
    }
    if (result == LAO_OK) {
        result = lao__imports_check(context, view, frame);
    }
    if (result != LAO_OK) {
        view->prepared = 0; /* resolved values no longer tell what the plan was made for */
        return result;
    }
    lao__plan_key(view, frame, sets, key);
    if (!view->prepared || structural || memcmp(key, view->key, sizeof key) != 0) {
        result = lao__view_plan(context, view, frame, sets);
        if (result != LAO_OK) {
            return result;
        }
        memcpy(view->key, key, sizeof key);
    }
    return lao__frame_execute(context, view, frame, &camera, sets);
}

lao_result lao_occlude(lao_context *context, const lao_frame *frame, const lao_settings *settings) {
    static const char *const needed[3] = {"color", "tangent", "depth"};
    lao_set set;
    lao_frame own;
    uint32_t i, k, found = 0;
    if (!context || !frame || (frame->import_count > 0 && !frame->imports)) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_occlude")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    for (k = 0; k < 3; k++) {
        for (i = 0; i < frame->import_count; i++) {
            found += frame->imports[i].image && strcmp(frame->imports[i].image, needed[k]) == 0;
        }
    }
    if (found != 3 || !(frame->sphere[3] > 0)) {
        return lao__fail(context, LAO_LOG_IMPORT,
                         "lao_occlude needs color, tangent, depth and a sphere");
    }
    memset(&set, 0, sizeof set);
    set.settings = settings;
    own = *frame;
    own.sets = &set;
    own.set_count = 1;
    return lao_render(context, &own);
}
