/* ================================================================================================
 * plan: a graph flattened into steps, images and memory. Uses tables, host and graph. */

typedef struct lao__planner {
    const lao_graph *graph;
    const lao_plan_desc *desc;
    lao_allocator allocator;
    lao_plan *plan;
    uint32_t supersampling;
    uint8_t *phase; /* per image: which ping-pong partner is THIS */
    int failed;     /* out of memory */
} lao__planner;

void lao_plan_free(const lao_allocator *allocator, lao_plan *plan) {
    lao_allocator a = lao__allocator_or_default(allocator);
    lao__delete(&a, plan->steps, plan->step_capacity, sizeof *plan->steps);
    lao__delete(&a, plan->instances, plan->instance_capacity, sizeof *plan->instances);
    lao__delete(&a, plan->slots, plan->slot_capacity, sizeof *plan->slots);
    lao__delete(&a, plan->barriers, plan->barrier_capacity, sizeof *plan->barriers);
    memset(plan, 0, sizeof *plan);
}

static float lao__value(const lao__planner *p, uint32_t module, uint32_t set, const char *name) {
    uint32_t index = lao__value_find(p->graph, module, name);
    return index == LAO_NO_INDEX ? 0.0f : p->desc->values[set][index];
}

/* The frame's import of that image, or LAO_NO_INDEX; the target has a code of its own. */
static uint32_t lao__import_find(const lao_plan_desc *desc, const char *image) {
    uint32_t i;
    if (strcmp(image, "target") == 0) {
        return desc->has_target ? LAO_IMPORT_TARGET : LAO_NO_INDEX;
    }
    for (i = 0; i < desc->import_count; i++) {
        if (strcmp(desc->imports[i].image, image) == 0) {
            return i;
        }
    }
    return LAO_NO_INDEX;
}

/* Buffers of the lines, the first of every context. */
#define LAO__LINE_BUFFERS ((1u << lao__lines_module.buffer_count) - 1)

/* Which buffers a set has, as bits. */
static uint32_t lao__set_buffers(const lao__planner *p, uint32_t set) {
    if (p->desc->buffers) {
        return p->desc->buffers[set];
    }
    return p->graph->modules[0] == &lao__lines_module ? LAO__LINE_BUFFERS : 0;
}

static int lao__holds(const lao__planner *p, uint32_t module, uint32_t set, const lao_when *when) {
    float value;
    if (!when->name) {
        return 1;
    }
    if (when->name[0] == LAO__IMPORT_MARK) {
        uint32_t import = lao__import_find(p->desc, when->name + 1);
        value = import == LAO_NO_INDEX ? 0.0f : 1.0f;
        if (import < p->desc->import_count &&
            (p->desc->imports[import].source.flags & LAO_HOST_WRITABLE)) {
            value = 2.0f;
        }
    } else if (when->name[0] == LAO__BUFFER_MARK) {
        uint32_t present = lao__set_buffers(p, set);
        value = (float)((present >> lao__buffer_find(p->graph, when->name)) & 1u);
    } else {
        value = lao__value(p, module, set, when->name);
    }
    switch (when->compare) {
    case '=':
        return value == when->value;
    case '!':
        return value != when->value;
    case '<':
        return value < when->value;
    default:
        return value > when->value;
    }
}

static void lao__level_size(const lao__planner *p, const lao_image_row *row, uint32_t level,
                            uint32_t *width, uint32_t *height) {
    uint32_t w = row->size == LAO_SIZE_FIXED ? row->width : p->desc->width;
    uint32_t h = row->size == LAO_SIZE_FIXED ? row->height : p->desc->height;
    if (row->size == LAO_SIZE_FULL) {
        w *= p->supersampling;
        h *= p->supersampling;
    }
    if (row->size == LAO_SIZE_ITEMS) {
        uint32_t items = row->width ? p->desc->further_items[row->width - 1] : p->desc->item_count;
        items = items > 0 ? items : 1;
        w = items < LAO_ITEMS_WIDTH ? items : LAO_ITEMS_WIDTH;
        h = items / LAO_ITEMS_WIDTH + (items % LAO_ITEMS_WIDTH != 0);
    }
    for (; level > 0; level--) {
        w = (w + 1) / 2;
        h = (h + 1) / 2;
    }
    *width = w;
    *height = h;
}

static uint32_t lao__level_count(const lao__planner *p, uint32_t module, uint32_t set,
                                 const lao_image_row *row) {
    uint32_t w, h, n = 1;
    if (!row->levels) {
        return 1;
    }
    if (strcmp(row->levels, "*") != 0) {
        n = (uint32_t)lao__value(p, module, set, row->levels);
        return n < 1 ? 1 : n;
    }
    lao__level_size(p, row, 0, &w, &h);
    for (; w > 1 || h > 1; n++) {
        w = (w + 1) / 2;
        h = (h + 1) / 2;
    }
    return n;
}

static uint32_t lao__instance(lao__planner *p, uint32_t image, uint32_t level, uint32_t phase) {
    lao_plan *plan = p->plan;
    const lao_image_row *row = p->graph->images[image];
    lao_plan_instance *instance;
    uint32_t i;
    for (i = 0; i < plan->instance_count; i++) {
        instance = &plan->instances[i];
        if (instance->image == image && instance->level == level && instance->phase == phase) {
            return i;
        }
    }
    if (lao__grow(&p->allocator, (void **)&plan->instances, plan->instance_count,
                  &plan->instance_capacity, sizeof *plan->instances) != 0) {
        p->failed = 1;
        return LAO_NO_INDEX;
    }
    instance = &plan->instances[plan->instance_count];
    memset(instance, 0, sizeof *instance);
    instance->image = image;
    instance->level = level;
    instance->phase = phase;
    instance->format = row->format;
    lao__level_size(p, row, level, &instance->width, &instance->height);
    instance->import = lao__import_find(p->desc, row->name);
    instance->slot[0] = instance->slot[1] = LAO_NO_INDEX;
    instance->first_step = LAO_NO_INDEX;
    return plan->instance_count++;
}

/* Resolves a reference of a row; LAO_NO_INDEX when its image does not exist under these settings.
 */
static uint32_t lao__resolve(lao__planner *p, const lao_plan_step *step,
                             const lao_reference *reference) {
    uint32_t image, level = 0, last, phase = 0, i;
    const lao_image_row *row;
    if (reference->image[0] == LAO__BUFFER_MARK) {
        return LAO_READ_BUFFER + lao__buffer_find(p->graph, reference->image);
    }
    image = lao__image_find(p->graph, reference->image);
    row = p->graph->images[image];
    if (!lao__holds(p, step->module, step->set, &row->when)) {
        return LAO_NO_INDEX;
    }
    last = lao__level_count(p, step->module, step->set, row) - 1;
    switch (reference->level) {
    case LAO_LEVEL_SAME:
        level = step->level;
        break;
    case LAO_LEVEL_FINER:
        level = step->level - 1;
        break;
    case LAO_LEVEL_COARSER:
        level = step->level + 1;
        break;
    case LAO_LEVEL_INDEX:
        level = reference->level_index;
        break;
    }
    level = level > last ? last : level;
    phase = reference->phase == LAO_PHASE_THIS ? p->phase[image] : (uint32_t)!p->phase[image];
    i = lao__instance(p, image, level, phase);
    if (i != LAO_NO_INDEX) {
        lao_plan_instance *instance = &p->plan->instances[i];
        if (instance->first_step == LAO_NO_INDEX) {
            instance->first_step = p->plan->step_count;
        }
        instance->last_step = p->plan->step_count;
    }
    return i;
}

/* Every written image is the host's to make: nothing is left to do. */
static int lao__imported_away(const lao__planner *p, const lao_pass_row *row) {
    uint32_t w, produced = 0;
    for (w = 0; w < LAO_MAX_WRITES && row->writes[w].image; w++) {
        const lao_image_row *image =
            p->graph->images[lao__image_find(p->graph, row->writes[w].image)];
        if (!(image->flags & LAO_IMAGE_IMPORT) &&
            lao__import_find(p->desc, image->name) != LAO_NO_INDEX) {
            produced++;
        }
    }
    return produced > 0;
}

/* Whether one of the first `end` steps writes it. */
static int lao__is_written(const lao_plan *plan, uint32_t instance, uint32_t end) {
    uint32_t s, i;
    for (s = 0; s < end; s++) {
        for (i = 0; i < plan->steps[s].color_count; i++) {
            if (plan->steps[s].colors[i].instance == instance) {
                return 1;
            }
        }
        if (plan->steps[s].depth.instance == instance) {
            return 1;
        }
    }
    return 0;
}

/* Whether the row draws the lines of all sets into one G-buffer. */
static int lao__draws_together(const lao__planner *p, uint32_t pass) {
    const lao_pass_row *row = p->graph->passes[pass];
    return p->desc->shared_occlusion && p->graph->pass_modules[pass] == 0 &&
           row->stage == LAO_STAGE_DRAW && row->scope == LAO_SCOPE_PER_SET;
}

static void lao__step_write(lao__planner *p, lao_plan_step *step, const lao_reference *reference) {
    uint32_t instance = lao__resolve(p, step, reference);
    uint32_t image = lao__image_find(p->graph, reference->image);
    const lao_image_row *row = p->graph->images[image];
    lao_plan_write write;
    int is_depth = row->format == LAO_FORMAT_D32F ||
                   (row->format == LAO_FORMAT_HOST && step->row->depth != LAO_DEPTH_NONE);
    memset(&write, 0, sizeof write);
    write.instance = instance;
    memcpy(write.value, row->clear, sizeof write.value);
    if (is_depth && p->desc->reverse_depth) {
        write.value[0] = 1.0f - write.value[0];
    }
    write.clear = reference->load == LAO_LOAD_DISCARD ? 2 : reference->load == LAO_LOAD_CLEAR;
    /* sets that share one G-buffer draw into what the first of them cleared */
    if ((reference->load == LAO_LOAD_KEEP ||
         (reference->load == LAO_LOAD_CLEAR && lao__draws_together(p, step->pass))) &&
        !(row->flags & LAO_IMAGE_IMPORT)) {
        write.clear =
            instance != LAO_NO_INDEX && lao__is_written(p->plan, instance, p->plan->step_count) ? 0
                                                                                                : 1;
    }
    if (is_depth) {
        step->depth = write;
    } else {
        step->colors[step->color_count++] = write;
    }
    if (instance != LAO_NO_INDEX) {
        step->width = p->plan->instances[instance].width;
        step->height = p->plan->instances[instance].height;
    }
}

/* "variant", a setting, or "has_" and the name of a buffer: 1 where the set has it. */
static int32_t lao__step_constant(const lao__planner *p, const lao_plan_step *step,
                                  const char *name) {
    uint32_t i;
    if (strcmp(name, "variant") == 0) {
        return (int32_t)step->row->variant;
    }
    for (i = 0; strncmp(name, "has_", 4) == 0 && i < p->graph->buffer_count; i++) {
        if (strcmp(p->graph->buffers[i]->name, name + 4) == 0) {
            return (int32_t)((lao__set_buffers(p, step->set) >> i) & 1u);
        }
    }
    return (int32_t)lao__value(p, step->module, step->set, name);
}
static void lao__step_constants(const lao__planner *p, lao_plan_step *step) {
    const lao_shader *shader = p->desc->shaders ? p->desc->shaders[step->shader] : NULL;
    uint32_t i;
    for (i = 0; shader && i < shader->constant_count && i < LAO_MAX_CONSTANTS; i++) {
        step->constants[i] = lao__step_constant(p, step, shader->constants[i]);
    }
}

static void lao__step_add(lao__planner *p, uint32_t pass, uint32_t set, uint32_t level,
                          uint32_t iteration) {
    const lao_pass_row *row = p->graph->passes[pass];
    lao_plan *plan = p->plan;
    lao_plan_step *step;
    uint32_t i;
    if (lao__grow(&p->allocator, (void **)&plan->steps, plan->step_count, &plan->step_capacity,
                  sizeof *plan->steps) != 0) {
        p->failed = 1;
        return;
    }
    step = &plan->steps[plan->step_count];
    memset(step, 0, sizeof *step);
    step->row = row;
    step->pass = pass;
    step->module = p->graph->pass_modules[pass];
    step->set = set;
    step->level = level;
    step->iteration = iteration;
    step->depth.instance = LAO_NO_INDEX;
    for (step->shader = 0; strcmp(p->graph->shader_names[step->shader], row->shader) != 0;
         step->shader++) {
    }
    for (i = 0; i < LAO_MAX_READS && row->reads[i].image; i++) {
        step->reads[i] = lao__resolve(p, step, &row->reads[i]);
        if (step->reads[i] < plan->instance_count && step->uniforms[4] == 0.0f) {
            step->uniforms[4] = (float)plan->instances[step->reads[i]].width;
            step->uniforms[5] = (float)plan->instances[step->reads[i]].height;
        }
    }
    step->read_count = i;
    for (i = 0; i < LAO_MAX_WRITES && row->writes[i].image; i++) {
        lao__step_write(p, step, &row->writes[i]);
    }
    /* partners swap once the step has written OTHER */
    for (i = 0; i < LAO_MAX_WRITES && row->writes[i].image; i++) {
        if (row->writes[i].phase == LAO_PHASE_OTHER) {
            uint32_t image = lao__image_find(p->graph, row->writes[i].image);
            p->phase[image] = !p->phase[image];
        }
    }
    step->uniforms[0] = (float)step->width;
    step->uniforms[1] = (float)step->height;
    step->uniforms[2] = (float)level;
    step->uniforms[3] = (float)iteration;
    step->uniforms[6] = (float)set;
    lao__step_constants(p, step);
    plan->step_count++;
}

static int lao__row_runs(const lao__planner *p, uint32_t pass, uint32_t set) {
    const lao_pass_row *row = p->graph->passes[pass];
    uint32_t i;
    for (i = 0; i < LAO_MAX_CONDITIONS; i++) {
        if (!lao__holds(p, p->graph->pass_modules[pass], set, &row->when[i])) {
            return 0;
        }
    }
    return !lao__imported_away(p, row);
}

/* One turn of a row, with the rows that repeat with it. */
static void lao__plan_turn(lao__planner *p, uint32_t pass, uint32_t set, uint32_t level,
                           uint32_t iteration) {
    const lao_graph *graph = p->graph;
    uint32_t i, k, n;
    lao__step_add(p, pass, set, level, iteration);
    for (i = pass + 1; i < graph->pass_count && graph->passes[i]->repeat == LAO_REPEAT_WITH_LAST;
         i++) {
        const char *setting = graph->passes[i]->repeat_setting;
        n = setting ? (uint32_t)lao__value(p, graph->pass_modules[i], set, setting) : 1;
        for (k = 0; k < n && lao__row_runs(p, i, set); k++) {
            lao__step_add(p, i, set, level, setting ? k : iteration);
        }
    }
}

static void lao__plan_pass(lao__planner *p, uint32_t pass, uint32_t set) {
    const lao_pass_row *row = p->graph->passes[pass];
    uint32_t module = p->graph->pass_modules[pass], i, n;
    const lao_image_row *first = p->graph->images[lao__image_find(p->graph, row->writes[0].image)];
    if (!lao__row_runs(p, pass, set)) {
        return;
    }
    switch (row->repeat) {
    case LAO_REPEAT_NONE:
        lao__plan_turn(p, pass, set, 0, 0);
        break;
    case LAO_REPEAT_LEVELS_UP:
        n = lao__level_count(p, module, set, first);
        for (i = row->writes[0].level_index + 1; i < n; i++) {
            lao__plan_turn(p, pass, set, i, i - 1);
        }
        break;
    case LAO_REPEAT_LEVELS_DOWN:
        n = lao__level_count(p, module, set, first);
        for (i = n - 1; i > 0; i--) {
            lao__plan_turn(p, pass, set, i - 1, n - 1 - i);
        }
        break;
    case LAO_REPEAT_COUNT:
        n = (uint32_t)lao__value(p, module, set, row->repeat_setting);
        for (i = 0; i < n; i++) {
            lao__plan_turn(p, pass, set, 0, i);
        }
        break;
    case LAO_REPEAT_WITH_LAST:
        break; /* in the turns of the row before */
    }
}

/* Consecutive rows of each set. With shared occlusion a row of the lines at a time draws all sets,
   and what comes after drawing runs once, by the first set's settings; further modules follow. */
static void lao__plan_sets(lao__planner *p, uint32_t first, uint32_t end) {
    int shared = p->desc->shared_occlusion && p->graph->passes[first]->stage != LAO_STAGE_COMPOSE;
    uint32_t i, set, count;
    for (i = first; shared && i < end; i++) {
        count = p->graph->pass_modules[i] > 0 ? 0
                : lao__draws_together(p, i)   ? p->desc->set_count
                                              : 1;
        for (set = 0; set < count; set++) {
            lao__plan_pass(p, i, set);
        }
    }
    for (set = 0; set < p->desc->set_count; set++) {
        for (i = first; i < end; i++) {
            if (!shared || p->graph->pass_modules[i] > 0) {
                lao__plan_pass(p, i, set);
            }
        }
    }
}

/* The set whose settings a row of the whole frame follows. */
static uint32_t lao__frame_set_of(const lao__planner *p, uint32_t pass) {
    uint32_t set;
    for (set = 0; set < p->desc->set_count; set++) {
        if (lao__row_runs(p, pass, set)) {
            return set;
        }
    }
    return 0;
}

/* Gives every instance memory; those whose lives do not meet share it. */
static void lao__plan_slots(lao__planner *p) {
    lao_plan *plan = p->plan;
    uint32_t i, k, s;
    int share = !(p->desc->flags & LAO_VIEW_KEEP_IMAGES);
    for (i = 0; i < plan->instance_count; i++) {
        lao_plan_instance *instance = &plan->instances[i];
        int history = (p->graph->images[instance->image]->flags & LAO_IMAGE_HISTORY) != 0;
        if (instance->import != LAO_NO_INDEX) {
            continue;
        }
        for (s = 0; share && !history && s < plan->slot_count; s++) {
            lao_plan_slot *slot = &plan->slots[s];
            int fits = slot->format == instance->format && slot->width == instance->width &&
                       slot->height == instance->height;
            for (k = 0; fits && k < i; k++) {
                const lao_plan_instance *other = &plan->instances[k];
                if (other->slot[0] == s || other->slot[1] == s) {
                    fits = !(p->graph->images[other->image]->flags & LAO_IMAGE_HISTORY) &&
                           (other->last_step < instance->first_step ||
                            instance->last_step < other->first_step);
                }
            }
            if (fits) {
                break;
            }
        }
        if (!share || history || s == plan->slot_count) {
            s = plan->slot_count;
            if (lao__grow(&p->allocator, (void **)&plan->slots, s, &plan->slot_capacity,
                          sizeof *plan->slots) != 0) {
                p->failed = 1;
                return;
            }
            memset(&plan->slots[s], 0, sizeof plan->slots[s]);
            plan->slots[s].format = instance->format;
            plan->slots[s].width = instance->width;
            plan->slots[s].height = instance->height;
            plan->slot_count++;
        }
        instance->slot[0] = instance->slot[1] = s;
    }
    /* the two phases of a history image change places every frame */
    for (i = 0; i < plan->instance_count; i++) {
        for (k = 0; k < i; k++) {
            lao_plan_instance *a = &plan->instances[i], *b = &plan->instances[k];
            if (a->image == b->image && a->level == b->level &&
                (p->graph->images[a->image]->flags & LAO_IMAGE_HISTORY)) {
                a->slot[1] = b->slot[0];
                b->slot[1] = a->slot[0];
            }
        }
    }
}

static void lao__barrier(lao__planner *p, uint8_t *state, uint32_t instance, lao_access after,
                         int discard) {
    lao_plan *plan = p->plan;
    const lao_plan_instance *i = &plan->instances[instance];
    /* imports are tracked behind the slots, one entry per instance */
    uint8_t *before = &state[i->slot[0] != LAO_NO_INDEX ? i->slot[0] : plan->slot_count + instance];
    lao_plan_barrier *barrier;
    if (*before == (uint8_t)after && after == LAO_ACCESS_SAMPLE) {
        return;
    }
    if (lao__grow(&p->allocator, (void **)&plan->barriers, plan->barrier_count,
                  &plan->barrier_capacity, sizeof *plan->barriers) != 0) {
        p->failed = 1;
        return;
    }
    barrier = &plan->barriers[plan->barrier_count++];
    barrier->instance = instance;
    barrier->before = (lao_access)*before;
    barrier->after = after;
    barrier->discard = (uint32_t)discard;
    *before = (uint8_t)after;
}

static void lao__plan_barriers(lao__planner *p) {
    lao_plan *plan = p->plan;
    uint32_t s, i, count = plan->slot_count + plan->instance_count;
    uint8_t *state = (uint8_t *)lao__new(&p->allocator, count ? count : 1, 1);
    if (!state) {
        p->failed = 1;
        return;
    }
    for (s = 0; s < plan->step_count && !p->failed; s++) {
        lao_plan_step *step = &plan->steps[s];
        step->barrier_first = plan->barrier_count;
        for (i = 0; i < step->read_count; i++) {
            if (step->reads[i] < plan->instance_count) {
                lao__barrier(p, state, step->reads[i], LAO_ACCESS_SAMPLE, 0);
            }
        }
        for (i = 0; i < step->color_count; i++) {
            if (step->colors[i].instance != LAO_NO_INDEX) {
                lao__barrier(p, state, step->colors[i].instance, LAO_ACCESS_COLOR,
                             step->colors[i].clear != 0);
            }
        }
        if (step->depth.instance != LAO_NO_INDEX) {
            lao__barrier(p, state, step->depth.instance, LAO_ACCESS_DEPTH, step->depth.clear != 0);
        }
        step->barrier_count = plan->barrier_count - step->barrier_first;
    }
    plan->end_barrier_first = plan->barrier_count;
    for (i = 0; i < plan->instance_count && !p->failed; i++) {
        if (plan->instances[i].import != LAO_NO_INDEX) {
            lao__barrier(p, state, i, LAO_ACCESS_NONE, 0);
        }
    }
    lao__delete(&p->allocator, state, count ? count : 1, 1);
}

static void lao__plan_usage(lao_plan *plan) {
    uint32_t s, i, b;
    for (b = 0; b < plan->barrier_count; b++) {
        for (i = 0; i < 2; i++) {
            s = plan->instances[plan->barriers[b].instance].slot[i];
            if (s != LAO_NO_INDEX) {
                plan->slots[s].sampled |= plan->barriers[b].after == LAO_ACCESS_SAMPLE;
                plan->slots[s].attached |= plan->barriers[b].after == LAO_ACCESS_COLOR ||
                                           plan->barriers[b].after == LAO_ACCESS_DEPTH;
            }
        }
    }
}

lao_result lao_plan_make(const lao_graph *graph, const lao_plan_desc *desc,
                         const lao_allocator *allocator, lao_plan *plan) {
    lao__planner p;
    uint32_t pass, end;
    memset(&p, 0, sizeof p);
    p.graph = graph;
    p.desc = desc;
    p.allocator = lao__allocator_or_default(allocator);
    p.plan = plan;
    p.phase = (uint8_t *)lao__new(&p.allocator, graph->image_count, 1);
    if (!p.phase) {
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    p.supersampling = (uint32_t)lao__value(&p, 0, 0, "supersampling");
    p.supersampling = p.supersampling < 1 ? 1 : p.supersampling;
    plan->step_count = plan->instance_count = plan->slot_count = plan->barrier_count = 0;
    plan->reverse_depth = desc->reverse_depth;
    plan->serial++;
    for (pass = 0; pass < graph->pass_count && !p.failed; pass = end) {
        end = pass + 1;
        if (graph->passes[pass]->scope == LAO_SCOPE_FRAME) {
            lao__plan_pass(&p, pass, lao__frame_set_of(&p, pass));
            continue;
        }
        /* composing begins when all sets are shaded */
        while (end < graph->pass_count && graph->passes[end]->scope == LAO_SCOPE_PER_SET &&
               (graph->passes[end]->stage < LAO_STAGE_COMPOSE ||
                graph->passes[end]->stage == graph->passes[pass]->stage)) {
            end++;
        }
        lao__plan_sets(&p, pass, end);
    }
    if (!p.failed) {
        lao__plan_slots(&p);
    }
    if (!p.failed) {
        lao__plan_barriers(&p);
    }
    lao__delete(&p.allocator, p.phase, graph->image_count, 1);
    if (p.failed) {
        plan->step_count = 0;
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    lao__plan_usage(plan);
    return LAO_OK;
}

static void lao__print_instance(const lao_graph *graph, const lao_plan *plan, uint32_t index,
                                void (*write)(void *, const char *), void *user) {
    char text[96];
    const lao_plan_instance *instance;
    if (LAO_READ_IS_BUFFER(index)) {
        snprintf(text, sizeof text, " #%s", graph->buffers[index - LAO_READ_BUFFER]->name);
        write(user, text);
        return;
    }
    if (index == LAO_NO_INDEX) {
        write(user, " -");
        return;
    }
    instance = &plan->instances[index];
    snprintf(text, sizeof text, " %s.%u%s", graph->images[instance->image]->name, instance->level,
             instance->phase ? "'" : "");
    write(user, text);
}

static void lao__print_barriers(const lao_graph *graph, const lao_plan *plan, uint32_t first,
                                uint32_t end, void (*write)(void *, const char *), void *user) {
    static const char *const name[] = {"none", "sample", "color", "depth"};
    char text[64];
    for (; first < end; first++) {
        const lao_plan_barrier *barrier = &plan->barriers[first];
        write(user, "  barrier");
        lao__print_instance(graph, plan, barrier->instance, write, user);
        snprintf(text, sizeof text, " %s -> %s%s\n", name[barrier->before], name[barrier->after],
                 barrier->discard ? " (discard)" : "");
        write(user, text);
    }
}

void lao_plan_print(const lao_graph *graph, const lao_plan *plan,
                    void (*write)(void *user, const char *text), void *user) {
    static const char *const clear[] = {"", " clear", " discard"};
    char text[160];
    uint32_t s, i;
    for (s = 0; s < plan->step_count; s++) {
        const lao_plan_step *step = &plan->steps[s];
        lao__print_barriers(graph, plan, step->barrier_first,
                            step->barrier_first + step->barrier_count, write, user);
        snprintf(text, sizeof text, "step %u %s set %u level %u turn %u %ux%u reads", s,
                 step->row->name, step->set, step->level, step->iteration, step->width,
                 step->height);
        write(user, text);
        for (i = 0; i < step->read_count; i++) {
            lao__print_instance(graph, plan, step->reads[i], write, user);
        }
        write(user, " writes");
        for (i = 0; i < step->color_count; i++) {
            lao__print_instance(graph, plan, step->colors[i].instance, write, user);
            write(user, clear[step->colors[i].clear]);
        }
        if (step->depth.instance != LAO_NO_INDEX) {
            lao__print_instance(graph, plan, step->depth.instance, write, user);
            write(user, clear[step->depth.clear]);
        }
        write(user, "\n");
    }
    lao__print_barriers(graph, plan, plan->end_barrier_first, plan->barrier_count, write, user);
}
