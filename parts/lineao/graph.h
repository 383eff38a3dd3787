/* ================================================================================================
 * graph: modules joined, and proven to fit together. Uses host and settings. */

#define LAO__MOST_SETTINGS 64u /* bits of `set` */
#define LAO__BUFFER_MARK '#'
#define LAO__IMPORT_MARK '@'

static uint32_t lao__image_find(const lao_graph *graph, const char *name) {
    uint32_t i;
    for (i = 0; i < graph->image_count; i++) {
        if (strcmp(graph->images[i]->name, name) == 0) {
            return i;
        }
    }
    return LAO_NO_INDEX;
}

/* Index of a buffer by its reference "#name", or LAO_NO_INDEX. */
static uint32_t lao__buffer_find(const lao_graph *graph, const char *reference) {
    uint32_t i;
    for (i = 0; i < graph->buffer_count; i++) {
        if (strcmp(graph->buffers[i]->name, reference + 1) == 0) {
            return i;
        }
    }
    return LAO_NO_INDEX;
}

/* The module that has a setting of that name, the asking one first; its index within the
 * concatenated values. */
static uint32_t lao__value_find(const lao_graph *graph, uint32_t module, const char *name) {
    uint32_t pass, m, first;
    for (pass = 0; pass < 2; pass++) {
        for (m = 0, first = 0; m < graph->module_count;
             first += graph->modules[m]->setting_count, m++) {
            int i = (pass == 0) == (m == module) ? lao_setting_find(graph->modules[m], name) : -1;
            if (i >= 0) {
                return first + (uint32_t)i;
            }
        }
    }
    return LAO_NO_INDEX;
}

void lao_graph_free(const lao_allocator *allocator, lao_graph *graph) {
    lao_allocator a = lao__allocator_or_default(allocator);
    lao__delete(&a, (void *)graph->modules, graph->module_count, sizeof *graph->modules);
    lao__delete(&a, (void *)graph->images, graph->image_count, sizeof *graph->images);
    lao__delete(&a, (void *)graph->passes, graph->pass_count, sizeof *graph->passes);
    lao__delete(&a, (void *)graph->pass_modules, graph->pass_count, sizeof *graph->pass_modules);
    lao__delete(&a, (void *)graph->shader_names, graph->pass_count, sizeof *graph->shader_names);
    memset(graph, 0, sizeof *graph);
}

static uint32_t lao__shader_name(lao_graph *graph, const char **names, const char *name) {
    uint32_t i;
    for (i = 0; i < graph->shader_count; i++) {
        if (strcmp(names[i], name) == 0) {
            return i;
        }
    }
    names[graph->shader_count] = name;
    return graph->shader_count++;
}

/* Buffers beyond LAO_MAX_BUFFERS are only counted: lao_graph_check refuses them. */
static void lao__graph_buffers(lao_graph *graph) {
    uint32_t m, i;
    for (m = 0; m < graph->module_count; m++) {
        for (i = 0; i < graph->modules[m]->buffer_count; i++) {
            if (graph->buffer_count < LAO_MAX_BUFFERS) {
                graph->buffers[graph->buffer_count] = &graph->modules[m]->buffers[i];
            }
            graph->buffer_count++;
        }
    }
}

lao_result lao_graph_make(const lao_module *const *modules, uint32_t module_count,
                          const lao_allocator *allocator, lao_graph *graph) {
    lao_allocator a = lao__allocator_or_default(allocator);
    lao_graph g;
    uint32_t m, i, stage, image = 0, pass = 0;
    const lao_module **own;
    const lao_image_row **images;
    const lao_pass_row **passes;
    uint32_t *pass_modules;
    const char **names;
    memset(&g, 0, sizeof g);
    for (m = 0; m < module_count; m++) {
        g.image_count += modules[m]->image_count;
        g.pass_count += modules[m]->pass_count;
    }
    g.module_count = module_count;
    g.modules = own = (const lao_module **)lao__new(&a, module_count, sizeof *own);
    g.images = images = (const lao_image_row **)lao__new(&a, g.image_count, sizeof *images);
    g.passes = passes = (const lao_pass_row **)lao__new(&a, g.pass_count, sizeof *passes);
    g.pass_modules = pass_modules = (uint32_t *)lao__new(&a, g.pass_count, sizeof *pass_modules);
    g.shader_names = names = (const char **)lao__new(&a, g.pass_count, sizeof *names);
    if (!own || !images || !passes || !pass_modules || !names) {
        lao_graph_free(&a, &g);
        return LAO_ERROR_OUT_OF_MEMORY;
    }
    for (m = 0; m < module_count; m++) {
        own[m] = modules[m];
        for (i = 0; i < modules[m]->image_count; i++) {
            images[image++] = &modules[m]->images[i];
        }
    }
    for (stage = LAO_STAGE_DRAW; stage <= LAO_STAGE_PRESENT; stage++) {
        for (m = 0; m < module_count; m++) {
            for (i = 0; i < modules[m]->pass_count; i++) {
                if ((uint32_t)modules[m]->passes[i].stage == stage) {
                    passes[pass] = &modules[m]->passes[i];
                    pass_modules[pass++] = m;
                    lao__shader_name(&g, names, modules[m]->passes[i].shader);
                }
            }
        }
    }
    g.pass_count = pass; /* fewer only where a stage is none of these */
    lao__graph_buffers(&g);
    *graph = g;
    return LAO_OK;
}

static int lao__fault(char *text, size_t size, const char *format, const char *a, const char *b) {
    if (text && size) {
        snprintf(text, size, format, a, b);
    }
    return -1;
}

static int lao__check_names(const lao_graph *graph, char *text, size_t size) {
    uint32_t i, k, m;
    for (i = 0; i < graph->image_count; i++) {
        for (k = 0; k < i; k++) {
            if (strcmp(graph->images[i]->name, graph->images[k]->name) == 0) {
                return lao__fault(text, size, "two images are named '%s'%s", graph->images[i]->name,
                                  "");
            }
        }
        if (graph->images[i]->levels && strcmp(graph->images[i]->levels, "*") != 0 &&
            lao__value_find(graph, 0, graph->images[i]->levels) == LAO_NO_INDEX) {
            return lao__fault(text, size,
                              "image '%s' counts its levels by the unknown setting '%s'",
                              graph->images[i]->name, graph->images[i]->levels);
        }
        if (graph->images[i]->size == LAO_SIZE_ITEMS &&
            graph->images[i]->width > LAO_FURTHER_ITEMS) {
            return lao__fault(text, size, "image '%s' is of an unknown kind of items%s",
                              graph->images[i]->name, "");
        }
        for (k = 0; k < 4 && graph->images[i]->format == LAO_FORMAT_R32UI; k++) {
            if (graph->images[i]->clear[k] != 0) {
                return lao__fault(text, size, "image '%s' holds words, which are cleared to 0%s",
                                  graph->images[i]->name, "");
            }
        }
    }
    for (i = 0; i < graph->pass_count; i++) {
        for (k = 0; k < i; k++) {
            if (strcmp(graph->passes[i]->name, graph->passes[k]->name) == 0) {
                return lao__fault(text, size, "two passes are named '%s'%s", graph->passes[i]->name,
                                  "");
            }
        }
    }
    if (graph->buffer_count > LAO_MAX_BUFFERS) {
        char most[16];
        snprintf(most, sizeof most, "%d", (int)LAO_MAX_BUFFERS);
        return lao__fault(text, size, "the modules have more than %s buffers%s", most, "");
    }
    for (i = 0; i < graph->buffer_count; i++) {
        for (k = 0; k < i; k++) {
            if (strcmp(graph->buffers[i]->name, graph->buffers[k]->name) == 0) {
                return lao__fault(text, size, "two buffers are named '%s'%s",
                                  graph->buffers[i]->name, "");
            }
        }
    }
    for (m = 0; m < graph->module_count; m++) {
        const lao_module *module = graph->modules[m];
        for (i = 0; i < module->setting_count; i++) {
            if (lao_setting_find(module, module->settings[i].name) != (int)i) {
                return lao__fault(text, size, "two settings of module '%s' are named '%s'",
                                  module->name, module->settings[i].name);
            }
        }
        if (module->setting_count > LAO__MOST_SETTINGS) {
            return lao__fault(text, size, "module '%s' has more than 64 settings%s", module->name,
                              "");
        }
        for (i = 0; i < module->preset_count; i++) {
            int preset = lao_setting_find(module, "preset");
            if (preset < 0 ||
                lao__choice(module->settings[preset].choices, module->presets[i].preset,
                            strlen(module->presets[i].preset)) < 0) {
                return lao__fault(text, size, "module '%s' has no preset '%s'", module->name,
                                  module->presets[i].preset);
            }
            if (lao_setting_find(module, module->presets[i].setting) < 0) {
                return lao__fault(text, size, "preset '%s' names the unknown setting '%s'",
                                  module->presets[i].preset, module->presets[i].setting);
            }
        }
    }
    return 0;
}

static int lao__check_when(const lao_graph *graph, uint32_t module, const char *owner,
                           const lao_when *when, char *text, size_t size) {
    if (!when->name) {
        return 0;
    }
    if (!when->compare || !strchr("=!<>", when->compare)) {
        return lao__fault(text, size, "'%s' has a condition on '%s' without a comparison", owner,
                          when->name);
    }
    if (when->name[0] == LAO__IMPORT_MARK) {
        uint32_t image = lao__image_find(graph, when->name + 1);
        return image == LAO_NO_INDEX
                   ? lao__fault(text, size, "'%s' asks for the unknown image '%s'", owner,
                                when->name + 1)
                   : 0;
    }
    if (when->name[0] == LAO__BUFFER_MARK) {
        return lao__buffer_find(graph, when->name) == LAO_NO_INDEX
                   ? lao__fault(text, size, "'%s' asks for the unknown buffer '%s'", owner,
                                when->name)
                   : 0;
    }
    return lao__value_find(graph, module, when->name) == LAO_NO_INDEX
               ? lao__fault(text, size, "'%s' asks for the unknown setting '%s'", owner, when->name)
               : 0;
}

/* Whether two references of a row name one level in every turn. */
static int lao__same_level(const lao_pass_row *row, const lao_reference *a,
                           const lao_reference *b) {
    int levels = row->repeat == LAO_REPEAT_LEVELS_UP || row->repeat == LAO_REPEAT_LEVELS_DOWN;
    uint32_t i = a->level == LAO_LEVEL_INDEX ? a->level_index : 0,
             k = b->level == LAO_LEVEL_INDEX ? b->level_index : 0;
    return a->level == b->level ? i == k : !levels && i == k;
}

/* Writes and reads of one row against everything written so far. */
static int lao__check_row(const lao_graph *graph, uint32_t index, const lao_pass_row *row,
                          char *text, size_t size) {
    uint32_t r, w, p, end;
    for (r = 0; r < LAO_MAX_READS && row->reads[r].image; r++) {
        const lao_reference *read = &row->reads[r];
        uint32_t image;
        int written = 0;
        if (read->image[0] == LAO__BUFFER_MARK) {
            if (lao__buffer_find(graph, read->image) == LAO_NO_INDEX) {
                return lao__fault(text, size, "pass '%s' reads the unknown buffer '%s'", row->name,
                                  read->image);
            }
            continue;
        }
        image = lao__image_find(graph, read->image);
        if (image == LAO_NO_INDEX) {
            return lao__fault(text, size, "pass '%s' reads the unknown image '%s'", row->name,
                              read->image);
        }
        for (w = 0; w < LAO_MAX_WRITES && row->writes[w].image; w++) {
            const lao_reference *write = &row->writes[w];
            if (strcmp(write->image, read->image) == 0) {
                if (write->phase == read->phase && lao__same_level(row, write, read)) {
                    return lao__fault(text, size, "pass '%s' reads what it writes: '%s'", row->name,
                                      read->image);
                }
            }
        }
        if (read->phase == LAO_PHASE_PREVIOUS &&
            !(graph->images[image]->flags & LAO_IMAGE_HISTORY)) {
            return lao__fault(text, size,
                              "pass '%s' reads the last frame's '%s', which is not kept", row->name,
                              read->image);
        }
        written = (graph->images[image]->flags & LAO_IMAGE_IMPORT) != 0;
        end = read->phase == LAO_PHASE_PREVIOUS ? graph->pass_count : index + 1;
        for (p = 0; p < end && !written; p++) {
            const lao_pass_row *earlier = graph->passes[p];
            for (w = 0; w < LAO_MAX_WRITES && earlier->writes[w].image; w++) {
                /* a repeated row may read what its earlier turn wrote */
                written |= strcmp(earlier->writes[w].image, read->image) == 0 &&
                           (p != index || row->repeat == LAO_REPEAT_LEVELS_DOWN ||
                            read->phase == LAO_PHASE_PREVIOUS);
            }
        }
        if (!written) {
            return lao__fault(text, size, "pass '%s' reads '%s', which nothing has written",
                              row->name, read->image);
        }
    }
    return 0;
}

/* Whether anything after (or the host) wants what the row writes. */
static int lao__row_is_used(const lao_graph *graph, uint32_t index) {
    const lao_pass_row *row = graph->passes[index];
    uint32_t w, p, r;
    for (w = 0; w < LAO_MAX_WRITES && row->writes[w].image; w++) {
        uint32_t image = lao__image_find(graph, row->writes[w].image);
        if (image != LAO_NO_INDEX &&
            (graph->images[image]->flags & (LAO_IMAGE_IMPORT | LAO_IMAGE_HISTORY))) {
            return 1;
        }
        for (p = index; p < graph->pass_count; p++) {
            for (r = 0; r < LAO_MAX_READS && graph->passes[p]->reads[r].image; r++) {
                if (strcmp(graph->passes[p]->reads[r].image, row->writes[w].image) == 0) {
                    return 1;
                }
            }
        }
    }
    return 0;
}

static const lao_shader *lao__shader_find(const lao_shader *shaders, uint32_t count,
                                          const char *name) {
    uint32_t i;
    for (i = 0; i < count; i++) {
        if (strcmp(shaders[i].name, name) == 0) {
            return &shaders[i];
        }
    }
    return NULL;
}

int lao_graph_check(const lao_graph *graph, const lao_shader *shaders, uint32_t shader_count,
                    char *text, size_t text_size) {
    const lao_shader *shader;
    uint32_t i, k, m, used;
    if (lao__check_names(graph, text, text_size) != 0) {
        return -1;
    }
    for (i = 0; i < graph->pass_count; i++) {
        const lao_pass_row *row = graph->passes[i];
        m = graph->pass_modules[i];
        if (!row->writes[0].image) {
            return lao__fault(text, text_size, "pass '%s' writes nothing%s", row->name, "");
        }
        for (k = 0; k < LAO_MAX_WRITES && row->writes[k].image; k++) {
            if (lao__image_find(graph, row->writes[k].image) == LAO_NO_INDEX) {
                return lao__fault(text, text_size, "pass '%s' writes the unknown image '%s'",
                                  row->name, row->writes[k].image);
            }
            if (row->blend != LAO_BLEND_NONE &&
                graph->images[lao__image_find(graph, row->writes[k].image)]->format ==
                    LAO_FORMAT_R32UI) {
                return lao__fault(text, text_size, "pass '%s' blends the words of '%s'", row->name,
                                  row->writes[k].image);
            }
        }
        for (k = 0; k < LAO_MAX_CONDITIONS; k++) {
            if (lao__check_when(graph, m, row->name, &row->when[k], text, text_size) != 0) {
                return -1;
            }
        }
        if ((row->repeat == LAO_REPEAT_COUNT && !row->repeat_setting) ||
            (row->repeat_setting &&
             lao__value_find(graph, m, row->repeat_setting) == LAO_NO_INDEX)) {
            return lao__fault(text, text_size, "pass '%s' repeats by an unknown setting%s",
                              row->name, "");
        }
        if (row->repeat == LAO_REPEAT_WITH_LAST && (i == 0 || graph->pass_modules[i - 1] != m ||
                                                    graph->passes[i - 1]->scope != row->scope)) {
            return lao__fault(text, text_size, "pass '%s' has no row before it to repeat with%s",
                              row->name, "");
        }
        if (lao__check_row(graph, i, row, text, text_size) != 0) {
            return -1;
        }
        if (!lao__row_is_used(graph, i)) {
            return lao__fault(text, text_size, "nothing uses what pass '%s' writes%s", row->name,
                              "");
        }
        shader = lao__shader_find(graph->modules[m]->shaders, graph->modules[m]->shader_count,
                                  row->shader);
        if (!shader) {
            shader = lao__shader_find(shaders, shaders ? shader_count : 0, row->shader);
        }
        if (shaders && !shader) {
            return lao__fault(text, text_size, "pass '%s' has no shader '%s'", row->name,
                              row->shader);
        }
        if (shader && shader->texture_count > LAO_MAX_READS) {
            return lao__fault(text, text_size,
                              "shader '%s' of pass '%s' has more textures than a pass can read",
                              row->shader, row->name);
        }
    }
    for (i = 0; i < graph->image_count; i++) {
        for (k = 0, used = 0; k < graph->pass_count; k++) {
            for (m = 0; m < LAO_MAX_READS && graph->passes[k]->reads[m].image; m++) {
                used |= strcmp(graph->passes[k]->reads[m].image, graph->images[i]->name) == 0;
            }
            for (m = 0; m < LAO_MAX_WRITES && graph->passes[k]->writes[m].image; m++) {
                used |= strcmp(graph->passes[k]->writes[m].image, graph->images[i]->name) == 0;
            }
        }
        if (!used) {
            return lao__fault(text, text_size, "no pass uses image '%s'%s", graph->images[i]->name,
                              "");
        }
        if (lao__check_when(graph, 0, graph->images[i]->name, &graph->images[i]->when, text,
                            text_size) != 0) {
            return -1;
        }
    }
    return 0;
}

void lao_graph_print(const lao_module *const *modules, uint32_t module_count,
                     void (*write)(void *user, const char *text), void *user) {
    char line[256];
    uint32_t m, i, k;
    write(user, "digraph lineao {\n    rankdir=LR;\n    node [fontname=\"sans-serif\"];\n");
    for (m = 0; m < module_count; m++) {
        for (i = 0; i < modules[m]->image_count; i++) {
            snprintf(line, sizeof line, "    \"%s\" [shape=ellipse%s];\n",
                     modules[m]->images[i].name,
                     modules[m]->images[i].flags & LAO_IMAGE_IMPORT ? ", style=dashed" : "");
            write(user, line);
        }
        for (i = 0; i < modules[m]->pass_count; i++) {
            const lao_pass_row *row = &modules[m]->passes[i];
            snprintf(line, sizeof line, "    \"pass %s\" [shape=box, label=\"%s\"];\n", row->name,
                     row->name);
            write(user, line);
            for (k = 0; k < LAO_MAX_READS && row->reads[k].image; k++) {
                if (k == 0 || strcmp(row->reads[k].image, row->reads[k - 1].image) != 0) {
                    snprintf(line, sizeof line, "    \"%s\" -> \"pass %s\";\n", row->reads[k].image,
                             row->name);
                    write(user, line);
                }
            }
            for (k = 0; k < LAO_MAX_WRITES && row->writes[k].image; k++) {
                snprintf(line, sizeof line, "    \"pass %s\" -> \"%s\";\n", row->name,
                         row->writes[k].image);
                write(user, line);
            }
        }
    }
    write(user, "}\n");
}
