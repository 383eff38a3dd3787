/* Settings of a document: what the tables list, what was edited, and what an edit needs to show. */
#include "document.h"

#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t size_of(const lao_module *module) {
    return sizeof(uint64_t) + (module->setting_count + 1u) / 2 * sizeof(uint64_t);
}

float *document_values(void *settings) {
    return (float *)(void *)((char *)settings + sizeof(uint64_t));
}

static bool add_settings(document *doc, const lao_module *module, const char *title, void *now,
                         uint32_t set) {
    document_settings *s = &doc->settings[doc->settings_count];
    memset(s, 0, sizeof *s);
    s->module = module;
    s->title = title;
    s->now = now;
    s->set = set;
    s->base = cli_new(1, size_of(module));
    if (!s->base)
        return false;
    memset(s->base, 0, size_of(module));
    memcpy(s->base, now, sizeof(uint64_t) + module->setting_count * sizeof(float));
    doc->settings_count++;
    return true;
}

/* Of one set: a tree's, a wall's, or those of its lines. */
static bool add_set_settings(document *doc, uint32_t i) {
    const cli_set *set = &doc->scene->sets[i];
    const char *name = document_file_name(set->name);
    if (set->tree)
        return add_settings(doc, sdv_module(), name, &set->tree->settings, i);
    if (set->wall)
        return add_settings(doc, vsf_module(), name, &set->wall->settings, i);
    return add_settings(doc, lao_lines_module(), doc->scene->count > 1 ? name : "Lines",
                        &doc->scene->sets[i].settings, i);
}

bool document_list_settings(document *doc) {
    const cli_scene *scene = doc->scene;
    doc->settings = cli_new(scene->count + 2u, sizeof *doc->settings);
    if (!doc->settings)
        return false;
    bool ok = true, lines = false;
    if (doc->command == CLI_RENDER) {
        for (uint32_t i = 0; ok && i < scene->count; i++) {
            ok = add_set_settings(doc, i);
            lines = lines || !scene->sets[i].object;
        }
        return ok &&
               (lines || /* some of these are the picture's */
                add_settings(doc, lao_lines_module(), "Picture", &scene->sets[0].settings, 0));
    }
    bool tree = doc->command == CLI_VESSEL;
    uint32_t last = tree ? scene->count - 1 : doc->wall.lit ? 1 : 0;
    return (tree ? add_settings(doc, sdv_module(), "Vessels", &doc->tree.settings, 0)
                 : add_settings(doc, vsf_module(), "Surface", &doc->wall.settings, 0)) &&
           add_settings(doc, lao_lines_module(), scene->sets[last].object ? "Picture" : "Lines",
                        &scene->sets[last].settings, last);
}

/* What is set holds inside a lens too, as --set does, but for the circle. */
static void set_lens(document *doc, int setting, float value, uint64_t set) {
    sdv_settings *inside = &doc->lens.tree.settings;
    uint64_t bit = (uint64_t)1 << setting;
    uint64_t circle = SDV_SET(lens_side) | SDV_SET(lens_x) | SDV_SET(lens_y) | SDV_SET(lens_radius);
    if (!doc->lens.options.vessel.lens.text || (bit & circle))
        return;
    document_values(inside)[setting] = value;
    inside->set = (inside->set & ~bit) | (set & bit);
}

void document_set(document *doc, uint32_t index, int setting, float value) {
    document_settings *s = &doc->settings[index];
    uint64_t bit = (uint64_t)1 << setting, *set = s->now;
    if (s->module == vsf_module() &&
        (bit & (VSF_SET(focus) | VSF_SET(focus_near) | VSF_SET(focus_far)))) {
        if (doc->options.surface.focus_numbers) /* its depths are numbers from now on */
            s->edited |= VSF_SET(focus) | VSF_SET(focus_near) | VSF_SET(focus_far);
        doc->options.surface.focus = NULL;
        doc->options.surface.focus_numbers = 0;
    }
    document_values(s->now)[setting] = value;
    *set |= bit;
    s->edited |= bit;
    if (s->module == sdv_module())
        set_lens(doc, setting, value, bit);
    if (doc->command == CLI_SURFACE) { /* so that time leaves it alone */
        if (s->module == vsf_module())
            ((cli_source *)(uintptr_t)doc->wall.source)->surface.set |= bit & VSF_SET(near_gamma);
        else if (s->set == 1 && setting != LAO_SETTING_ID_occlusion) {
            lao_settings *surface = &doc->scene->sets[0].settings;
            document_values(surface)[setting] = value;
            surface->set |= bit;
        }
    }
    if (doc->command == CLI_SURFACE)
        doc->scene->sets[0].settings.occlusion = 0; /* it has no lines */
    bool lines = s->module == lao_lines_module();
    if (lines && setting == LAO_SETTING_ID_supersampling) { /* of the picture, thus of every set */
        for (uint32_t i = 0; i < doc->scene->count; i++) {
            doc->scene->sets[i].settings.supersampling = value;
            doc->scene->sets[i].settings.set |= bit;
        }
    }
    cli_set *of = &doc->scene->sets[s->set];
    if (lines && setting == LAO_SETTING_ID_trail && (int)value == LAO_TRAIL_HIGHLIGHT &&
        of->times && !(of->settings.highlight_beta > 0))
        document_set(doc, index, LAO_SETTING_ID_highlight_beta, cli_usual_beta(of));
}

void document_reset(document *doc, uint32_t index, int setting) {
    document_settings *s = &doc->settings[index];
    uint64_t bit = (uint64_t)1 << setting;
    document_set(doc, index, setting, document_values(s->base)[setting]);
    *(uint64_t *)s->now = (*(uint64_t *)s->now & ~bit) | (*(uint64_t *)s->base & bit);
    s->edited &= ~bit;
    if (s->module == sdv_module())
        set_lens(doc, setting, document_values(&doc->lens_base)[setting], doc->lens_base.set);
    if (doc->command == CLI_SURFACE && s->set == 1)
        doc->scene->sets[0].settings.set &= ~bit | *(uint64_t *)s->base;
}

/* Leaves the last "--set name=..." of the words out. */
static void forget_edit(document *doc, const char *name) {
    size_t length = strlen(name);
    for (uint32_t i = doc->word_count; i-- > 1;) {
        char **at = &doc->words[i - 1];
        if (strcmp(at[0], "--set") != 0 || strncmp(at[1], name, length) != 0 ||
            at[1][length] != '=')
            continue;
        free(at[0]);
        free(at[1]);
        memmove(at, at + 2, (doc->word_count - i) * sizeof *at); /* and the NULL */
        doc->word_count -= 2;
        return;
    }
}

void document_inherit(document *doc, const document *from) {
    for (uint32_t i = 0; i < doc->settings_count && i < from->settings_count; i++) {
        document_settings *to = &doc->settings[i];
        const document_settings *s = &from->settings[i];
        for (uint32_t k = 0; to->module == s->module && k < s->module->setting_count; k++) {
            uint64_t bit = (uint64_t)1 << k, said = *(const uint64_t *)to->now;
            if (!(s->edited & said & bit)) /* said: an edit since is not among the words */
                continue;
            document_values(to->base)[k] = document_values(s->base)[k];
            *(uint64_t *)to->base = (*(uint64_t *)to->base & ~bit) | (*(uint64_t *)s->base & bit);
            to->edited |= bit;
            forget_edit(doc, s->module->settings[k].name);
        }
    }
}

float document_value(const document *doc, uint32_t index, int setting) {
    float values[64];
    const document_settings *s = &doc->settings[index];
    lao_settings_resolve(s->module, s->now, values);
    return values[setting];
}

bool document_offers(const document *doc, uint32_t index, int setting) {
    const uint64_t of_times = LAO_SET(trail) | LAO_SET(trail_length) | LAO_SET(taper_start) |
                              LAO_SET(taper_width) | LAO_SET(period) | LAO_SET(highlight_beta);
    const uint64_t of_light = VSF_SET(near_gamma) | VSF_SET(near_steps);
    const document_settings *s = &doc->settings[index];
    const cli_set *set = &doc->scene->sets[s->set];
    uint64_t none = 0;
    if (s->module == vsf_module())
        none = VSF_SET(near_part) | (set->wall && set->wall->lit ? 0 : of_light);
    else if (s->module == lao_lines_module())
        none = set->object ? ~LAO_SET(supersampling) : set->times ? 0 : of_times;
    return !(none >> setting & 1);
}

document_need document_needs(const document *doc, uint32_t index, int setting) {
    static const struct {
        const char *name;
        document_need need;
    } rows[] = {{"near_steps", NEEDS_OPENING},
                {"period", NEEDS_OPENING},
                {"highlight_beta", NEEDS_MEASURES}};
    const char *name = doc->settings[index].module->settings[setting].name;
    for (size_t i = 0; i < sizeof rows / sizeof *rows && doc->command == CLI_SURFACE; i++) {
        if (strcmp(rows[i].name, name) == 0 && (doc->wall.lit || rows[i].need == NEEDS_OPENING))
            return rows[i].need;
    }
    return NEEDS_NOTHING;
}

/* ---- a wall's light ---------------------------------------------------------------------- */

/* The settings of the lines that light it. */
static document_settings *lighting(const document *doc) {
    return &doc->settings[doc->settings_count - 1];
}

void document_wish_measured(document *doc) {
    bool edited = lighting(doc)->edited & LAO_SET(highlight_beta);
    const lao_settings *now = lighting(doc)->now;
    doc->new_beta = edited ? (double)now->highlight_beta : doc->beta;
}

bool document_measure(document *doc) {
    return cli_wall_measure(&doc->wall, doc->new_beta);
}

void document_show_measured(document *doc, bool ok) {
    document_settings *s = lighting(doc);
    lao_settings *now = s->now, *base = s->base, before = *now;
    if (cli_wall_relight(&doc->wall) && doc->wall.trails)
        base->trail_length = now->trail_length;
    if (s->edited & LAO_SET(trail_length))
        now->trail_length = before.trail_length;
    now->highlight_beta = before.highlight_beta; /* maybe edited since */
    double shown = doc->wall.near.beta;
    if (!ok && fabs(shown - doc->beta) > 0)
        document_set(doc, doc->settings_count - 1, LAO_SETTING_ID_highlight_beta, (float)shown);
    else if (!ok)
        document_reset(doc, doc->settings_count - 1, LAO_SETTING_ID_highlight_beta);
    doc->scene->sets[0].settings.trail_length = now->trail_length; /* they share theirs */
    doc->revision++;
}

/* ---- the lens ---------------------------------------------------------------------------- */

/* Another value in the words for a flag's; returns it as it stands there. NULL: reported. */
static const char *replace_value(document *doc, const char *flag, const char *value) {
    size_t length = strlen(flag);
    for (uint32_t i = doc->word_count; i-- > 0;) {
        const char *word = doc->words[i];
        bool joined = strncmp(word, flag, length) == 0 && word[length] == '=';
        bool apart = i > 0 && strcmp(doc->words[i - 1], flag) == 0;
        if (!joined && !apart)
            continue;
        size_t room = length + strlen(value) + 2;
        char *text = cli_new(room, 1);
        if (!text)
            return NULL;
        snprintf(text, room, "%s%s%s", joined ? flag : "", joined ? "=" : "", value);
        free(doc->words[i]);
        doc->words[i] = text;
        return text + (joined ? length + 1 : 0);
    }
    return NULL;
}

bool document_move_lens(document *doc, const double circle[3]) {
    cli_lens_option *lenses[2] = {&doc->options.vessel.lens, &doc->lens.options.vessel.lens};
    char text[96];
    snprintf(text, sizeof text, "circle:%.4f,%.4f,%.4f", circle[0], circle[1], circle[2]);
    const char *value = replace_value(doc, "--lens", text);
    for (int i = 0; value && i < 2; i++) {
        lenses[i]->text = value;
        cli_numbers(value + strlen("circle:"), lenses[i]->circle, 3);
    }
    cli_lens_aim(&doc->lens, &doc->tree, &doc->shot);
    return value != NULL;
}

/* ---- time -------------------------------------------------------------------------------- */

static bool is_lines_with_times(const document *doc, uint32_t index) {
    const document_settings *s = &doc->settings[index];
    return s->module == lao_lines_module() && doc->scene->sets[s->set].times;
}

bool document_shows_time(const document *doc) {
    for (uint32_t i = 0; i < doc->settings_count; i++) {
        if (is_lines_with_times(doc, i) && document_value(doc, i, LAO_SETTING_ID_trail) > 0)
            return true;
    }
    return false;
}

void document_show_time(document *doc, bool shown) {
    for (uint32_t i = 0; i < doc->settings_count; i++) {
        if (is_lines_with_times(doc, i) &&
            (document_value(doc, i, LAO_SETTING_ID_trail) > 0) != shown)
            document_set(doc, i, LAO_SETTING_ID_trail, shown ? LAO_TRAIL_TAPER : LAO_TRAIL_NONE);
    }
}
