#include "document.h"

#include "flow.h"
#include "io_read.h"
#include "io_volume.h"
#include "legends.h"
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- what files are ---------------------------------------------------------------------- */

enum { KIND_VOLUME = 8 };

/* Formats that hold one kind only, so that they need not be read to be known. */
static const struct {
    const char *ending;
    unsigned kind;
} formats[] = {{".trk", IO_LINES}, {".tck", IO_LINES}, {".trx", IO_LINES},
               {".tt", IO_LINES},  {".swc", IO_TREE},  {".gxl", IO_TREE},
               {".vmv", IO_TREE},  {".stl", IO_MESH},  {".ply", IO_MESH}};

static bool ends_with(const char *path, const char *ending) {
    size_t length = strlen(path), tail = strlen(ending);
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0)
        length -= 3;
    return length >= tail && strncasecmp(path + length - tail, ending, tail) == 0;
}

/* What is drawn of a file: a surface or a tree rather than the lines beside it. */
typedef struct file_kind {
    unsigned kind;    /* IO_LINES, IO_TREE, IO_MESH or KIND_VOLUME */
    const char *told; /* what --as has to tell, or NULL */
} file_kind;

/* False: reported. */
static bool find_kind(const char *path, file_kind *out) {
    cli_source source;
    io_contents contents;
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < sizeof formats / sizeof *formats && !out->kind; i++) {
        if (ends_with(path, formats[i].ending))
            out->kind = formats[i].kind;
    }
    memset(&source, 0, sizeof source);
    source.path = path;
    if (!out->kind && cli_count_volumes(&source, 1, 0))
        out->kind = KIND_VOLUME;
    if (out->kind)
        return true;
    if (!cli_read(&source, IO_ANYTHING, &contents))
        return false;
    unsigned kinds = contents.kinds;
    io_contents_free(&contents);
    out->kind = kinds & IO_MESH ? IO_MESH : kinds & IO_TREE ? IO_TREE : IO_LINES;
    if (out->kind != IO_LINES && kinds & IO_LINES)
        out->told = out->kind == IO_MESH ? "surface" : "tree";
    return true;
}

/* Can lines light a wall? */
static bool has_times(const char *path) {
    cli_source source;
    io_lines lines;
    bool found = false;
    memset(&source, 0, sizeof source);
    source.path = path;
    if (!cli_read_file(&source, &lines))
        return false;
    for (uint32_t i = 0; i < lines.point_attribute_count; i++) {
        const char *name = lines.point_attributes[i].name;
        found = found || strcmp(name, "time") == 0 || strcmp(name, "speed") == 0 ||
                strcmp(name, "velocity") == 0;
    }
    io_lines_free(&lines);
    return found;
}

/* ---- words ------------------------------------------------------------------------------- */

static const struct {
    const char *verb;
    cli_command_bit command;
} verbs[] = {{"render", CLI_RENDER}, {"vessel", CLI_VESSEL}, {"surface", CLI_SURFACE}};

static bool add_word(document *doc, const char *word) {
    char **words = realloc(doc->words, (doc->word_count + 2) * sizeof *words);
    char *copy = cli_new(strlen(word) + 1, 1);
    if (words)
        doc->words = words;
    if (!words || !copy) {
        free(copy);
        return cli_fail("out of memory");
    }
    doc->words[doc->word_count++] = strcpy(copy, word);
    doc->words[doc->word_count] = NULL;
    return true;
}

static void take_verb(document *doc, size_t verb) {
    doc->verb = verbs[verb].verb;
    doc->command = verbs[verb].command;
}

static bool add_file(document *doc, const char *path, const file_kind *kind) {
    return add_word(doc, path) &&
           (!kind->told || (add_word(doc, "--as") && add_word(doc, kind->told)));
}

enum { MOST_FILES = 64 };

/* Files alone: a tree and a wall, which lines with times light, have a command of their own;
 * whatever else there is stands in one picture. */
static bool guess_command(document *doc, const char *const *words, uint32_t count) {
    file_kind kinds[MOST_FILES];
    uint32_t files = 0, lines = 0;
    for (; files < count && files < MOST_FILES && words[files][0] != '-'; files++) {
        if (!find_kind(words[files], &kinds[files]))
            return false;
        lines = kinds[files].kind == IO_LINES ? files : lines;
    }
    bool lit = files == 2 && kinds[lines].kind == IO_LINES && kinds[1 - lines].kind == IO_MESH &&
               has_times(words[lines]);
    bool tree = files == 1 && kinds[0].kind == IO_TREE;
    bool wall = lit || (files == 1 && kinds[0].kind == IO_MESH);
    take_verb(doc, wall ? 2 : tree ? 1 : 0);
    bool ok = true;
    for (uint32_t i = 0; ok && i < count; i++) {
        ok = !(lit && i == lines) || add_word(doc, "--lines");
        ok = ok && (i < files && !wall && !tree ? add_file(doc, words[i], &kinds[i])
                                                : add_word(doc, words[i]));
    }
    return ok;
}

/* Of the words the last `added` are files that join what the others open. */
static bool take_words(document *doc, const char *const *words, uint32_t count, uint32_t added) {
    bool ok = true;
    for (size_t i = 0; count && i < sizeof verbs / sizeof *verbs; i++) {
        if (strcmp(words[0], verbs[i].verb) == 0)
            take_verb(doc, i);
    }
    if (!doc->verb)
        return guess_command(doc, words, count);
    for (uint32_t i = 1; ok && i < count; i++) {
        file_kind kind = {0, NULL};
        ok = (i < count - added || find_kind(words[i], &kind)) && add_file(doc, words[i], &kind);
    }
    return ok;
}

/* Each command wants to know where its picture goes. */
static bool parse(document *doc) {
    char **words = cli_new(doc->word_count + 3u, sizeof *words);
    if (!words)
        return false;
    if (doc->word_count)
        memcpy(words, doc->words, doc->word_count * sizeof *words);
    words[doc->word_count] = (char[]){"-o"};
    words[doc->word_count + 1] = (char[]){"view.png"};
    words[doc->word_count + 2] = NULL;
    bool ok = cli_parse(doc->command, (int)doc->word_count + 2, words, &doc->options);
    doc->options.out = NULL;        /* it was not ours to keep */
    doc->options.vessel.margin = 0; /* pictures have none */
    free(words);
    return ok && (!doc->options.help || cli_fail("lineao %s --help explains the flags", doc->verb));
}

/* ---- settings ---------------------------------------------------------------------------- */

static size_t size_of(const lao_module *module) {
    return sizeof(uint64_t) + (module->setting_count + 1u) / 2 * sizeof(uint64_t);
}

static float *values_of(void *settings) {
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

const char *document_file_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
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

static bool list_settings(document *doc) {
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
        return ok && (lines || /* some of these are the picture's */
                      add_settings(doc, lao_lines_module(), "Lines", &scene->sets[0].settings, 0));
    }
    bool tree = doc->command == CLI_VESSEL;
    uint32_t last = tree ? scene->count - 1 : doc->wall.lit ? 1 : 0;
    return (tree ? add_settings(doc, sdv_module(), "Vessels", &doc->tree.settings, 0)
                 : add_settings(doc, vsf_module(), "Surface", &doc->wall.settings, 0)) &&
           add_settings(doc, lao_lines_module(), "Lines", &scene->sets[last].settings, last);
}

/* What is set holds inside a lens too, as --set does, but for the circle. */
static void set_lens(document *doc, int setting, float value, uint64_t set) {
    sdv_settings *inside = &doc->lens.tree.settings;
    uint64_t bit = (uint64_t)1 << setting;
    uint64_t circle = SDV_SET(lens_side) | SDV_SET(lens_x) | SDV_SET(lens_y) | SDV_SET(lens_radius);
    if (!doc->lens.options.vessel.lens.text || (bit & circle))
        return;
    values_of(inside)[setting] = value;
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
    values_of(s->now)[setting] = value;
    *set |= bit;
    s->edited |= bit;
    if (s->module == sdv_module())
        set_lens(doc, setting, value, bit);
    if (doc->command == CLI_SURFACE) { /* so that time leaves it alone */
        if (s->module == vsf_module())
            ((cli_source *)(uintptr_t)doc->wall.source)->surface.set |= bit & VSF_SET(near_gamma);
        else if (s->set == 1 && setting != LAO_SETTING_ID_occlusion) {
            lao_settings *surface = &doc->scene->sets[0].settings;
            values_of(surface)[setting] = value;
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
    document_set(doc, index, setting, values_of(s->base)[setting]);
    *(uint64_t *)s->now = (*(uint64_t *)s->now & ~bit) | (*(uint64_t *)s->base & bit);
    s->edited &= ~bit;
    if (s->module == sdv_module())
        set_lens(doc, setting, values_of(&doc->lens_base)[setting], doc->lens_base.set);
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
            values_of(to->base)[k] = values_of(s->base)[k];
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

/* ---- opening ----------------------------------------------------------------------------- */

/* The time that shows the embedded surface best, as the program has it. */
#define EMBEDDED_TIME 180

static bool load(document *doc) {
    if (doc->command == CLI_RENDER) {
        doc->scene = &doc->lines;
        return cli_scene_load(&doc->options, &doc->lines);
    }
    if (doc->command == CLI_VESSEL) {
        doc->scene = &doc->tree.scene;
        cli_lens_plan(&doc->options, &doc->lens);
        return cli_tree_load(&doc->options, NULL, 0, &doc->tree) &&
               cli_lens_load(&doc->lens, &doc->tree) && cli_tree_prepare(&doc->tree) &&
               cli_lens_prepare(&doc->lens, &doc->tree);
    }
    doc->scene = &doc->wall.scene;
    if (!cli_wall_load(&doc->options, NULL, &doc->wall))
        return false;
    if (doc->wall.lit) { /* both are one source's, but for what the surface has not */
        doc->scene->sets[0].settings = doc->scene->sets[1].settings;
        doc->scene->sets[0].settings.occlusion = 0;
        doc->scene->sets[0].settings.set |= LAO_SET(occlusion);
    }
    return true;
}

/* What depends on camera and time. */
static bool aim(document *doc) {
    cli_wall *wall = &doc->wall;
    lao_object_desc all;
    if (doc->command == CLI_VESSEL) {
        cli_tree_fit_period(&doc->tree, &doc->shot);
        cli_lens_fit(&doc->lens, &doc->tree, &doc->shot);
        doc->lens_base = doc->lens.tree.settings;
    }
    if (doc->command != CLI_SURFACE)
        return true;
    if (wall->lit && isnan(doc->options.time) && !doc->options.surface.lines)
        doc->shot.time = wall->source->path ? (float)wall->near.beta / 4 : EMBEDDED_TIME;
    if (!cli_wall_aim(wall, &doc->shot))
        return false;
    cli_wall_time(wall, (double)doc->shot.time, &all); /* all goes up with the object */
    return true;
}

static void warn(const document *doc) {
    char text[512];
    if (doc->command != CLI_VESSEL)
        cli_scene_warn(doc->scene);
    for (uint32_t i = 0; cli_tree_warning(&doc->tree, i, text, sizeof text); i++)
        cli_warn(doc->tree.name, text);
    for (uint32_t i = 0; cli_wall_warning(&doc->wall, i, text, sizeof text); i++)
        cli_warn(doc->wall.name, text);
}

document *document_open(const char *const *words, uint32_t count, uint32_t added) {
    document *doc = cli_new(1, sizeof *doc);
    if (!doc)
        return NULL;
    memset(doc, 0, sizeof *doc);
    bool ok = take_words(doc, words, count, added) && parse(doc) && load(doc) &&
              cli_shot_make(&doc->options, doc->scene, &doc->shot) && aim(doc) &&
              list_settings(doc) && pick_prepare(doc->scene, &doc->pickable);
    if (!ok) {
        document_close(doc);
        return NULL;
    }
    for (uint32_t i = 0; i < doc->scene->count; i++)
        doc->timed = doc->timed || doc->scene->sets[i].times;
    if (doc->command == CLI_VESSEL) /* as the first camera has it, from now on */
        doc->settings[0].edited |=
            doc->tree.settings.set & SDV_SET(ssp_period) & ~doc->tree.source->vessel.set;
    doc->added = added > 0;
    doc->beta = doc->wall.near.beta;
    warn(doc);
    return doc;
}

void document_close(document *doc) {
    if (!doc)
        return;
    pick_free(&doc->pickable);
    cli_scene_free(&doc->lines);
    if (doc->command == CLI_VESSEL) {
        cli_tree_free(&doc->tree);
        cli_tree_free(&doc->lens.tree);
    }
    if (doc->command == CLI_SURFACE)
        cli_wall_free(&doc->wall);
    cli_options_free(&doc->options);
    for (uint32_t i = 0; i < doc->word_count; i++)
        free(doc->words[i]);
    for (uint32_t i = 0; i < doc->settings_count; i++)
        free(doc->settings[i].base);
    free(doc->settings);
    free(doc->words);
    free(doc);
}

const char *document_name(const document *doc) {
    return document_file_name(doc->options.file_count && doc->command == CLI_RENDER
                                  ? doc->options.files[0].path
                                  : doc->scene->sets[0].name);
}

bool document_surround(void *user, picture *p) {
    document *doc = user;
    const char *side = doc->options.legend;
    if (doc->command == CLI_RENDER)
        return cli_legends_draw(&doc->options, doc->scene, NULL, 0, p);
    if (doc->command == CLI_SURFACE)
        return cli_wall_legends(&doc->wall, p);
    return !side || strcmp(side, "off") == 0 ||
           cli_tree_legend(doc->tree.value ? &doc->tree : &doc->lens.tree, side, p);
}

/* ---- command lines ----------------------------------------------------------------------- */

/* Flags of the words that the viewer says itself: how many words each takes. */
static int words_dropped(const char *word) {
    static const char *const names[] = {
        "--camera",      "--size",    "--time",    "--view",   "--out",
        "--save-camera", "--dump",    "--timings", "--frames", "--fps",
        "--backend",     "--outline", "--margin",  "-o",       "--focus"};
    if (strcmp(word, "--ortho") == 0 || strcmp(word, "--backdrop") == 0)
        return 1;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        size_t length = strlen(names[i]);
        if (strncmp(word, names[i], length) == 0 && (word[length] == '=' || !word[length]))
            return word[length] ? 1 : 2;
    }
    return 0;
}

/* One word: quoted for a shell unless `plain`, then on a line of its own. */
static void put(cli_text *t, bool plain, const char *word) {
    const char *safe = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=./,:%@^";
    if (plain || (*word && strspn(word, safe) == strlen(word))) {
        if (t->length)
            cli_text_add(t, plain ? "\n" : " ", 1);
        cli_text_add(t, word, strlen(word));
        return;
    }
    cli_text_add(t, " '", 2);
    for (; *word; word++)
        cli_text_add(t, *word == '\'' ? "'\\''" : word, *word == '\'' ? 4 : 1);
    cli_text_add(t, "'", 1);
}

static void put_pair(cli_text *t, bool plain, const char *flag, const char *value) {
    if (!value)
        return;
    put(t, plain, flag);
    put(t, plain, value);
}

/* "--set name=value" for those of the bits. */
static void put_bits(cli_text *t, bool plain, const document_settings *s, uint64_t bits) {
    for (uint32_t k = 0; k < s->module->setting_count; k++) {
        const lao_setting_row *row = &s->module->settings[k];
        char value[64], word[160];
        if (!(bits >> k & 1))
            continue;
        cli_setting_text(row, values_of(s->now)[k], value, sizeof value);
        snprintf(word, sizeof word, "%s=%s", row->name, value);
        put_pair(t, plain, "--set", word);
    }
}

/* What was edited of the sets of a file; NULL: of all. */
static void put_settings(cli_text *t, bool plain, const document *doc, const char *file) {
    for (uint32_t i = 0; i < doc->settings_count; i++) {
        const document_settings *s = &doc->settings[i];
        if (!file || doc->scene->sets[s->set].source->path == file)
            put_bits(t, plain, s, s->edited);
    }
}

/* A word that names a file of `render`, behind which its flags stand. */
static bool is_file(const document *doc, const char *word) {
    bool found = false;
    for (uint32_t i = 0; i < doc->options.file_count && doc->command == CLI_RENDER; i++)
        found = found || doc->options.files[i].path == word;
    return found;
}

/* The words as they are, and behind the flags of each file what was edited of its set. `without`:
 * (Optional) a file that is left out, with its flags. */
static void put_words(cli_text *t, bool plain, const document *doc, const char *without) {
    const char *file = NULL; /* whose flags these are */
    bool out = false, of_file;
    put(t, plain, doc->verb);
    for (uint32_t i = 0; i < doc->word_count; i++) {
        const char *word = doc->words[i];
        int dropped = words_dropped(word);
        if (dropped) {
            i += (uint32_t)dropped - 1;
            continue;
        }
        if (is_file(doc, word)) {
            if (file && !out)
                put_settings(t, plain, doc, file);
            file = word;
            out = without && strcmp(word, without) == 0;
        }
        uint32_t flag = cli_flag_words(doc->command, word, &of_file);
        for (uint32_t last = i + (flag ? flag - 1 : 0); i <= last && i < doc->word_count; i++) {
            if (!out || (flag && !of_file))
                put(t, plain, doc->words[i]);
        }
        i--;
    }
    if (!out)
        put_settings(t, plain, doc, file);
}

/* Settings of a tree or a wall, those that were given as well. */
static void put_given(cli_text *t, bool plain, const document *doc, const lao_module *module) {
    const cli_source *source = doc->scene->sets[0].source;
    uint64_t given = module == sdv_module()   ? source->vessel.set
                     : module == vsf_module() ? source->surface.set
                                              : source->settings.set;
    for (uint32_t i = 0; i < doc->settings_count; i++) {
        if (doc->settings[i].module == module)
            put_bits(t, plain, &doc->settings[i], doc->settings[i].edited | given);
    }
}

/* The files of `vessel` or `surface` for `render`, which has not all of their flags. */
static void put_files(cli_text *t, bool plain, const document *doc) {
    const bool tree = doc->command == CLI_VESSEL && !doc->tree.mesh.vertex_count;
    const cli_source *source = &doc->options.files[0];
    put(t, plain, "render");
    put(t, plain, source->path);
    put_pair(t, plain, "--as", tree ? "tree" : "surface");
    put_pair(t, plain, "--unit", source->unit);
    put_pair(t, plain, "--color", tree ? source->color : doc->options.surface.value);
    put_given(t, plain, doc, tree ? sdv_module() : vsf_module());
    if (!doc->options.surface.lines)
        return;
    put(t, plain, doc->options.surface.lines);
    put_pair(t, plain, "--as", "lines");
    put_pair(t, plain, "--color", source->color);
    put_given(t, plain, doc, lao_lines_module());
}

static void put_view(cli_text *t, bool plain, const document *doc, const cli_shot *shot) {
    char text[64], *camera = camera_print(&shot->camera);
    if (doc->timed && (document_shows_time(doc) || doc->command == CLI_SURFACE)) {
        cli_shortest(shot->time, text, sizeof text);
        put_pair(t, plain, "--time", text);
    }
    put_pair(t, plain, "--focus", doc->options.surface.focus);
    t->broken = t->broken || !camera;
    put_pair(t, plain, "--camera", camera);
    free(camera);
    snprintf(text, sizeof text, "%ux%u", shot->width, shot->height);
    put_pair(t, plain, "--size", text);
}

/* The text with its end, for free(). NULL: reported. */
static char *end_text(cli_text *t) {
    cli_text_add(t, "", 1);
    if (!t->broken)
        return t->text;
    free(t->text);
    return NULL;
}

char *document_command(const document *doc, const cli_shot *shot, const char *out) {
    cli_text t = {NULL, 0, 0, false};
    put(&t, false, "lineao");
    put_words(&t, false, doc, NULL);
    put_view(&t, false, doc, shot);
    put_pair(&t, false, "-o", out);
    return end_text(&t);
}

char *document_without(const document *doc, const cli_shot *shot, const char *file) {
    cli_text t = {NULL, 0, 0, false};
    put_words(&t, true, doc, file);
    put_view(&t, true, doc, shot);
    return end_text(&t);
}

char *document_words(const document *doc, const cli_shot *shot) {
    return document_without(doc, shot, NULL);
}

bool document_joins(const document *doc) {
    const cli_options *o = &doc->options;
    return o->file_count > 0 &&
           (doc->command == CLI_RENDER || (o->file_count == 1 && !io_is_volume(o->files[0].path)));
}

char *document_joined(const document *doc, const cli_shot *shot) {
    cli_text t = {NULL, 0, 0, false};
    if (doc->command == CLI_RENDER)
        return document_words(doc, shot);
    put_files(&t, true, doc);
    put_view(&t, true, doc, shot);
    return end_text(&t);
}
