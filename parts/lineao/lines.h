/* ================================================================================================
 * lines: a line set as texels for the vertex stage, in chunks and groups. Uses host and context. */

/* Texels of a line set as the vertex stage wants them: each run of points between two ghosts, so
   that the neighbours of a segment's ends are always one texel away. A ghost repeats the end point
   (no neighbour) or, in a closed line, the point beyond the seam. With points NULL the walk only
   counts. */
typedef struct lao__texels {
    float *points;   /* x, y, z, time */
    uint8_t *colors; /* RGBA */
    uint64_t count;
    uint64_t ends[LAO_PARTS]; /* behind each part */
    int timed;
} lao__texels;

/* A time that is none, or too large to be told from a ghost's, is never reached. */
static float lao__time(float time) {
    return time > -1.0e30f && time < 1.0e30f ? time : 1.0e30f;
}

static void lao__texel(lao__texels *out, const lao_lines_desc *desc, uint32_t position,
                       uint32_t attribute, int ghost) {
    if (out->points) {
        float *p = out->points + 4 * out->count;
        uint8_t *c = out->colors + 4 * out->count;
        memcpy(p, desc->points + 3 * (size_t)position, 3 * sizeof *p);
        p[3] = ghost ? LAO_GHOST_TIME : desc->times ? lao__time(desc->times[attribute]) : 0.0f;
        if (desc->colors) {
            memcpy(c, desc->colors + 4 * (size_t)attribute, 4);
        } else {
            static const float sand[4] = {0.93f, 0.80f, 0.50f, 1.0f};
            const float *color = desc->color;
            int i, none = color[0] == 0 && color[1] == 0 && color[2] == 0 && color[3] == 0;
            for (i = 0; i < 4; i++) {
                c[i] = (uint8_t)(lao_clamp01(none ? sand[i] : color[i]) * 255.0f + 0.5f);
            }
        }
    }
    out->count++;
}

static int lao__same_point(const lao_lines_desc *desc, uint32_t a, uint32_t b) {
    return memcmp(desc->points + 3 * (size_t)a, desc->points + 3 * (size_t)b, 3 * sizeof(float)) ==
           0;
}

/* One run of finite points [first, end). */
static void lao__run(lao__texels *out, const lao_lines_desc *desc, uint32_t first, uint32_t end) {
    uint32_t i, next, distinct = 0, second = first, before_last = first, last = first;
    for (i = first + 1; i < end; i++) {
        if (!lao__same_point(desc, i, last)) {
            if (distinct++ == 0) {
                second = i;
            }
            before_last = last;
            last = i;
        }
    }
    if (distinct == 0) {
        return; /* nothing but one point */
    }
    i = distinct >= 3 && lao__same_point(desc, first, last); /* closed */
    lao__texel(out, desc, i ? before_last : first, first, 1);
    lao__texel(out, desc, first, first, 0);
    for (last = first, next = first + 1; next < end; next++) {
        if (!lao__same_point(desc, next, last)) {
            lao__texel(out, desc, next, next, 0);
            last = next;
        }
    }
    lao__texel(out, desc, i ? second : last, last, 1);
}

static void lao__line(lao__texels *out, const lao_lines_desc *desc, uint32_t begin, uint32_t end) {
    uint32_t i, first;
    for (first = i = begin; i < end; i++) {
        if (!lao__finite(desc->points + 3 * (size_t)i, 3)) {
            lao__run(out, desc, first, i);
            first = i + 1;
        }
    }
    lao__run(out, desc, first, i);
}

/* Of many lines every eighth, every eighth, every fourth, every second: each part is spread over
   the whole set. */
static uint32_t lao__part_of(const lao_lines_desc *desc, uint32_t line) {
    uint32_t part = LAO_PARTS - 1;
    while (part > 0 && line % 2 == 0) {
        line /= 2;
        part--;
    }
    return desc->line_count < LAO__PARTED ? 0 : part;
}

/* Lines part by part. */
static void lao__lines_walk(lao__texels *out, const lao_lines_desc *desc, const uint32_t *offsets) {
    uint32_t line, part;
    for (part = 0; part < LAO_PARTS; part++) {
        for (line = 0; line < desc->line_count; line++) {
            if (lao__part_of(desc, line) == part) {
                lao__line(out, desc, offsets[line], offsets[line + 1]);
            }
        }
        out->ends[part] = out->count;
    }
}

static lao_result lao__lines_check(lao_context *context, const lao_lines_desc *desc,
                                   const uint32_t *offsets) {
    uint32_t i;
    char text[96];
    if (desc->point_count > 0 && desc->line_count > 0 && !desc->points) {
        return lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_desc.points");
    }
    if (!desc->offsets && desc->line_count > 1) {
        return lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_desc.offsets");
    }
    if (desc->line_count == 0) {
        return LAO_OK;
    }
    for (i = 0; i <= desc->line_count; i++) {
        if ((i == 0 && offsets[0] != 0) || (i > 0 && offsets[i] < offsets[i - 1]) ||
            offsets[i] > desc->point_count) {
            snprintf(text, sizeof text, "offsets[%u] = %u", i, offsets[i]);
            return lao__fail(context, LAO_LOG_LINES_OFFSETS, text);
        }
    }
    if (offsets[desc->line_count] != desc->point_count) {
        snprintf(text, sizeof text, "offsets[%u] = %u, point_count = %u", desc->line_count,
                 offsets[desc->line_count], desc->point_count);
        return lao__fail(context, LAO_LOG_LINES_OFFSETS, text);
    }
    return LAO_OK;
}

static void lao__lines_box(lao__lines *lines, const lao_lines_desc *desc) {
    uint32_t i, k;
    for (i = 0; desc->line_count > 0 && i < desc->point_count; i++) {
        const float *p = desc->points + 3 * (size_t)i;
        if (lao__finite(p, 3)) {
            for (k = 0; k < 3; k++) {
                lines->bounds[0][k] = lines->has_points ? lao_min(lines->bounds[0][k], p[k]) : p[k];
                lines->bounds[1][k] = lines->has_points ? lao_max(lines->bounds[1][k], p[k]) : p[k];
            }
            lines->has_points = 1;
        }
    }
}

/* Rows of the line module's buffers, which stand first in every graph. */
enum { LAO__BUFFER_POINTS, LAO__BUFFER_COLORS, LAO__BUFFER_ORDER };

/* The time at which segment i begins; of none that is never reached, or lies between two lines. */
static int lao__segment_time(const float *points, uint32_t i, float *begin, float *end) {
    const float a = points[4 * ((size_t)i + 1) + 3], b = points[4 * ((size_t)i + 2) + 3];
    *begin = lao_min(a, b);
    *end = lao_max(a, b);
    return *end < 1.0e30f;
}

enum { LAO__BINS = 65536 };

/* Segments by the bin of time in which they begin; `groups` of about as many segments each. */
typedef struct lao__order {
    const float *points;
    uint32_t segment_count, total, group_count;
    double earliest, per_bin;
    uint32_t *bins; /* LAO__BINS: first segments, then groups */
    lao_group *groups;
    float *order; /* numbers of segments: floats tell them apart */
} lao__order;

static uint32_t lao__bin(const lao__order *o, float begin) {
    return (uint32_t)((begin - o->earliest) * o->per_bin);
}

static void lao__order_count(lao__order *o) {
    float begin, end, earliest = 0, latest = 0;
    uint32_t i;
    for (i = 0; i < o->segment_count; i++) {
        if (lao__segment_time(o->points, i, &begin, &end)) {
            earliest = o->total ? lao_min(earliest, begin) : begin;
            latest = o->total ? lao_max(latest, begin) : begin;
            o->total++;
        }
    }
    o->earliest = earliest;
    o->per_bin = latest > earliest ? (LAO__BINS - 1) / ((double)latest - earliest) : 0;
    for (i = 0; i < o->segment_count; i++) {
        if (lao__segment_time(o->points, i, &begin, &end)) {
            o->bins[lao__bin(o, begin)]++;
        }
    }
}

/* Bins, in order, into the last group until it has its share. */
static void lao__order_group(lao__order *o) {
    uint32_t i, filled = 0;
    for (i = 0; i < LAO__BINS; i++) {
        uint32_t n = o->bins[i];
        if (n > 0 && (uint64_t)filled * LAO__GROUPS >= (uint64_t)o->group_count * o->total) {
            o->groups[o->group_count++].first = filled;
        }
        o->bins[i] = n > 0 ? o->group_count - 1 : 0;
        filled += n;
    }
}

/* Within a group segments keep the order of the lines, in which their points lie in memory. */
static void lao__order_fill(lao__order *o) {
    float begin, end;
    uint32_t i;
    for (i = 0; i < o->segment_count; i++) {
        if (lao__segment_time(o->points, i, &begin, &end)) {
            lao_group *group = &o->groups[o->bins[lao__bin(o, begin)]];
            group->begin = group->count ? lao_min(group->begin, begin) : begin;
            group->end = group->count ? lao_max(group->end, end) : end;
            o->order[group->first + group->count++] = (float)i;
        }
    }
}

/* Puts the buffer "#order" and its groups into a chunk whose points are given. */
static lao_result lao__chunk_order(lao_context *context, lao_chunk *chunk, const float *points) {
    const lao_allocator *allocator = &context->allocator;
    lao_result result;
    lao_buffer_desc buffer;
    lao__order o;
    memset(&o, 0, sizeof o);
    o.points = points;
    o.segment_count = chunk->count;
    o.bins = (uint32_t *)lao__new(allocator, LAO__BINS, sizeof *o.bins);
    o.order = (float *)lao__new(allocator, chunk->count, sizeof *o.order);
    o.groups = (lao_group *)lao__new(allocator, LAO__GROUPS, sizeof *o.groups);
    chunk->groups = o.groups;
    if (o.bins && o.order && o.groups) {
        lao__order_count(&o);
        lao__order_group(&o);
        lao__order_fill(&o);
        chunk->group_count = o.group_count;
        buffer.format = LAO_FORMAT_R32F;
        buffer.texel_count = o.total ? o.total : 1;
        buffer.data = o.order;
        result = context->backend.buffer_create(context->self, &buffer,
                                                &chunk->buffers[LAO__BUFFER_ORDER]);
    } else {
        result = lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
    }
    lao__delete(allocator, o.bins, LAO__BINS, sizeof *o.bins);
    lao__delete(allocator, o.order, chunk->count, sizeof *o.order);
    return result;
}

static lao_result lao__chunk_make(lao_context *context, lao_chunk *chunk, const lao__texels *texels,
                                  uint64_t first, uint32_t count) {
    lao_buffer_desc buffer;
    lao_result result;
    uint32_t i;
    buffer.texel_count = count;
    buffer.format = LAO_FORMAT_RGBA32F;
    buffer.data = texels->points + 4 * first;
    result =
        context->backend.buffer_create(context->self, &buffer, &chunk->buffers[LAO__BUFFER_POINTS]);
    if (result == LAO_OK) {
        buffer.format = LAO_FORMAT_RGBA8;
        buffer.data = texels->colors + 4 * first;
        result = context->backend.buffer_create(context->self, &buffer,
                                                &chunk->buffers[LAO__BUFFER_COLORS]);
    }
    chunk->count = count - 3;
    for (i = 0; i < LAO_PARTS; i++) {
        const uint64_t end = texels->ends[i] > first ? texels->ends[i] - first : 0;
        chunk->ends[i] = end < chunk->count ? (uint32_t)end : chunk->count;
    }
    if (result == LAO_OK && texels->timed) {
        result = lao__chunk_order(context, chunk, texels->points + 4 * first);
    }
    return result;
}

/* Buffers of at most max_buffer_texels; a chunk begins 3 texels before the last one's end, where
 * its segments end. */
static lao_result lao__lines_upload(lao_context *context, const lao__texels *texels,
                                    lao__lines *lines) {
    uint64_t most = context->caps.max_buffer_texels, first, segments;
    lao_result result = LAO_OK;
    uint32_t i;
    most = most > 0x1000000u ? 0x1000000u : most; /* segments that floats tell apart */
    if (texels->count < 4) {
        return LAO_OK;
    }
    segments = texels->count - 3;
    lines->chunk_count = (uint32_t)((segments + most - 4) / (most - 3));
    lines->chunks =
        (lao_chunk *)lao__new(&context->allocator, lines->chunk_count, sizeof *lines->chunks);
    if (!lines->chunks) {
        lines->chunk_count = 0;
        return lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
    }
    for (i = 0, first = 0; i < lines->chunk_count && result == LAO_OK; i++) {
        uint64_t count = texels->count - first < most ? texels->count - first : most;
        result = lao__chunk_make(context, &lines->chunks[i], texels, first, (uint32_t)count);
        first += count - 3;
    }
    return result;
}

static lao_result lao__lines_fill(lao_context *context, const lao_lines_desc *desc,
                                  lao__lines *lines) {
    uint32_t whole[2];
    const uint32_t *offsets = desc->offsets;
    lao__texels texels;
    lao_result result;
    uint64_t capacity;
    memset(lines, 0, sizeof *lines);
    memset(&texels, 0, sizeof texels);
    texels.timed = desc->times != NULL;
    whole[0] = 0;
    whole[1] = desc->point_count;
    offsets = offsets ? offsets : whole;
    result = lao__lines_check(context, desc, offsets);
    if (result != LAO_OK) {
        return result;
    }
    lao__lines_walk(&texels, desc, offsets);
    capacity = texels.count;
    if (capacity > 0xfffffff0u) {
        return lao__fail(context, LAO_LOG_LINES_COUNT, NULL);
    }
    if (capacity > 0) {
        texels.count = 0;
        texels.points = (float *)lao__new(&context->allocator, (size_t)capacity, 4 * sizeof(float));
        texels.colors = (uint8_t *)lao__new(&context->allocator, (size_t)capacity, 4);
        if (texels.points && texels.colors) {
            lao__lines_walk(&texels, desc, offsets);
            result = lao__lines_upload(context, &texels, lines);
        } else {
            result = lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
        }
        lao__delete(&context->allocator, texels.points, (size_t)capacity, 4 * sizeof(float));
        lao__delete(&context->allocator, texels.colors, (size_t)capacity, 4);
    }
    if (result != LAO_OK) {
        lao__lines_clear(context, lines);
        return result;
    }
    lao__lines_box(lines, desc);
    return LAO_OK;
}

lao_result lao_limits_get(const lao_context *context, lao_limits *limits) {
    if (!context || !limits) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    limits->image_size = context->caps.max_image_size;
    limits->buffer_texels = context->caps.max_buffer_texels;
    return LAO_OK;
}

lao_result lao_lines_create(lao_context *context, const lao_lines_desc *desc, lao_lines *lines) {
    lao__lines *object;
    lao_result result;
    uint32_t id;
    if (!context || !desc || !lines) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_create")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    object = (lao__lines *)lao__new(&context->allocator, 1, sizeof *object);
    if (!object) {
        return lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
    }
    result = lao__lines_fill(context, desc, object);
    if (result == LAO_OK) {
        id = lao__handle_add(&context->allocator, &context->lines, object);
        if (id) {
            lines->id = id;
            return LAO_OK;
        }
        lao__lines_clear(context, object);
        result = lao__fail(context, LAO_LOG_LINES_MEMORY, NULL);
    }
    lao__delete(&context->allocator, object, 1, sizeof *object);
    return result;
}

static lao__lines *lao__lines_get(lao_context *context, lao_lines lines) {
    lao__handle *handle = lao__handle_get(&context->lines, lines.id);
    return handle ? (lao__lines *)handle->object : NULL;
}

lao_result lao_lines_update(lao_context *context, lao_lines lines, const lao_lines_desc *desc) {
    lao__lines *object, fresh;
    lao_result result;
    if (!context || !desc) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_update")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    object = lao__lines_get(context, lines);
    if (!object) {
        return lao__fail(context, LAO_LOG_LINES_HANDLE, "lao_lines_update");
    }
    result = lao__lines_fill(context, desc, &fresh);
    if (result == LAO_OK) {
        lao__lines_clear(context, object);
        *object = fresh;
    }
    return result;
}

lao_result lao_lines_destroy(lao_context *context, lao_lines lines) {
    lao__handle *handle;
    if (!context) {
        return LAO_ERROR_INVALID_ARGUMENT;
    }
    handle = lao__handle_get(&context->lines, lines.id);
    if (!handle) {
        return lao__fail(context, LAO_LOG_LINES_HANDLE, "lao_lines_destroy");
    }
    lao__lines_clear(context, (lao__lines *)handle->object);
    lao__delete(&context->allocator, handle->object, 1, sizeof(lao__lines));
    handle->object = NULL;
    return LAO_OK;
}

lao_result lao_lines_bounds(lao_context *context, lao_lines lines, float bounds[2][3]) {
    lao__lines *object;
    if (!context || !bounds) {
        return context ? lao__fail(context, LAO_LOG_NULL_ARGUMENT, "lao_lines_bounds")
                       : LAO_ERROR_INVALID_ARGUMENT;
    }
    object = lao__lines_get(context, lines);
    if (!object) {
        return lao__fail(context, LAO_LOG_LINES_HANDLE, "lao_lines_bounds");
    }
    memcpy(bounds, object->bounds, sizeof object->bounds);
    return LAO_OK;
}
