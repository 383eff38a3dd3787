#include "document.h"

#include "flow.h"
#include "io_read.h"
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

/* 0: reported. */
static unsigned kind_of(const char *path) {
    cli_source source;
    io_contents contents;
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        if (ends_with(path, formats[i].ending))
            return formats[i].kind;
    }
    memset(&source, 0, sizeof source);
    source.path = path;
    if (cli_count_volumes(&source, 1, 0))
        return KIND_VOLUME;
    if (!cli_read(&source, IO_ANYTHING, &contents))
        return 0;
    unsigned kinds = contents.kinds;
    io_contents_free(&contents);
    return kinds & IO_MESH ? IO_MESH : kinds & IO_TREE ? IO_TREE : IO_LINES;
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

/* Files alone: a mesh takes lines along; a tree stands for itself; the rest are lines. */
static bool guess_command(document *doc, const char *const *words, uint32_t count) {
    unsigned all = 0;
    bool ok = true;
    uint32_t files = 0;
    unsigned kinds[64] = {0};
    for (; ok && files < count && files < 64 && words[files][0] != '-'; files++) {
        kinds[files] = kind_of(words[files]);
        ok = kinds[files] != 0;
        all |= kinds[files];
    }
    int verb = all & IO_MESH ? 2 : all & IO_TREE ? 1 : 0;
    doc->verb = verbs[verb].verb;
    doc->command = verbs[verb].command;
    for (uint32_t i = 0; ok && i < count; i++) {
        if (i < files && verb == 2 && kinds[i] == KIND_VOLUME)
            ok = cli_fail("%s: is a volume, and a surface takes lines; trace it first: lineao flow",
                          words[i]);
        if (i < files && verb == 2 && kinds[i] == IO_LINES)
            ok = ok && add_word(doc, "--lines");
        ok = ok && add_word(doc, words[i]);
    }
    return ok;
}

static bool take_words(document *doc, const char *const *words, uint32_t count) {
    bool ok = true;
    for (size_t i = 0; count && i < sizeof verbs / sizeof *verbs; i++) {
        if (strcmp(words[0], verbs[i].verb) == 0) {
            doc->verb = verbs[i].verb;
            doc->command = verbs[i].command;
        }
    }
    if (!doc->verb)
        return guess_command(doc, words, count);
    for (uint32_t i = 1; ok && i < count; i++)
        ok = add_word(doc, words[i]);
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

static const char *file_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static bool list_settings(document *doc) {
    const cli_scene *scene = doc->scene;
    doc->settings = cli_new(scene->count + 2u, sizeof *doc->settings);
    bool ok = doc->settings != NULL;
    if (doc->command == CLI_VESSEL)
        ok = ok && add_settings(doc, sdv_module(), "Vessels", &doc->tree.settings, 0);
    if (doc->command == CLI_SURFACE)
        ok = ok && add_settings(doc, vsf_module(), "Surface", &doc->wall.settings, 0);
    bool many = doc->command == CLI_RENDER && scene->count > 1;
    uint32_t last = doc->command == CLI_VESSEL ? scene->count - 1 : doc->wall.lit ? 1 : 0;
    for (uint32_t i = many ? 0 : last; ok && i < (many ? scene->count : last + 1); i++)
        ok = add_settings(doc, lao_lines_module(), many ? file_name(scene->sets[i].name) : "Lines",
                          &scene->sets[i].settings, i);
    return ok;
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
            uint64_t bit = (uint64_t)1 << k;
            if (!(s->edited & bit))
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

bool document_reloads(const document *doc, uint32_t index, int setting) {
    static const char *const names[] = {"near_steps", "period", "highlight_beta"};
    const char *name = doc->settings[index].module->settings[setting].name;
    for (size_t i = 0; i < sizeof names / sizeof *names && doc->command == CLI_SURFACE; i++) {
        if (strcmp(names[i], name) == 0)
            return true;
    }
    return false;
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
        return cli_tree_load(&doc->options, NULL, 0, &doc->tree) && cli_tree_prepare(&doc->tree);
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
    if (doc->command == CLI_VESSEL)
        cli_tree_fit_period(&doc->tree, &doc->shot);
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
    const io_tree *tree = &doc->tree.contents.tree;
    const io_mesh *mesh = &doc->wall.contents.mesh;
    char text[512];
    if (doc->command != CLI_VESSEL)
        cli_scene_warn(doc->scene);
    for (uint32_t i = 0; i < tree->warning_count; i++)
        cli_warn(doc->tree.name, tree->warnings[i]);
    for (uint32_t i = 0; i < doc->tree.vessel.tree.warning_count; i++) {
        sdv_tree_warning_text(&doc->tree.vessel.tree, i, text, sizeof text);
        cli_warn(doc->tree.name, text);
    }
    for (uint32_t i = 0; i < mesh->warning_count; i++)
        cli_warn(doc->wall.name, mesh->warnings[i]);
    for (uint32_t i = 0; i < doc->wall.mesh.warning_count; i++) {
        vsf_mesh_warning_text(&doc->wall.mesh, i, text, sizeof text);
        cli_warn(doc->wall.name, text);
    }
}

document *document_open(const char *const *words, uint32_t count) {
    document *doc = cli_new(1, sizeof *doc);
    if (!doc)
        return NULL;
    memset(doc, 0, sizeof *doc);
    bool ok = take_words(doc, words, count) && parse(doc) && load(doc) &&
              cli_shot_make(&doc->options, doc->scene, &doc->shot) && aim(doc) &&
              list_settings(doc);
    if (!ok) {
        document_close(doc);
        return NULL;
    }
    for (uint32_t i = 0; i < doc->scene->count; i++)
        doc->timed = doc->timed || doc->scene->sets[i].times;
    if (doc->command == CLI_VESSEL) /* as the first camera has it, from now on */
        doc->settings[0].edited |=
            doc->tree.settings.set & SDV_SET(ssp_period) & ~doc->tree.source->vessel.set;
    warn(doc);
    return doc;
}

void document_close(document *doc) {
    if (!doc)
        return;
    cli_scene_free(&doc->lines);
    if (doc->command == CLI_VESSEL)
        cli_tree_free(&doc->tree);
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
    return file_name(doc->scene->sets[0].name);
}

bool document_surround(void *user, picture *p) {
    document *doc = user;
    const char *side = doc->options.legend;
    if (doc->command == CLI_RENDER)
        return cli_legends_draw(&doc->options, doc->scene, NULL, 0, p);
    if (doc->command == CLI_SURFACE)
        return cli_wall_legends(&doc->wall, p);
    return !side || strcmp(side, "off") == 0 || cli_tree_legend(&doc->tree, side, p);
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

static void put_settings(cli_text *t, bool plain, const document *doc, uint32_t set) {
    for (uint32_t i = 0; i < doc->settings_count; i++) {
        const document_settings *s = &doc->settings[i];
        for (uint32_t k = 0; k < s->module->setting_count; k++) {
            const lao_setting_row *row = &s->module->settings[k];
            char value[64], word[160];
            bool mine = s->set == set || doc->command != CLI_RENDER;
            if (!mine || !(s->edited >> k & 1))
                continue;
            cli_setting_text(row, values_of(s->now)[k], value, sizeof value);
            snprintf(word, sizeof word, "%s=%s", row->name, value);
            put(t, plain, "--set");
            put(t, plain, word);
        }
    }
}

/* The words as they are, and behind each file what was edited of its set. */
static void put_words(cli_text *t, bool plain, const document *doc) {
    const cli_scene *scene = doc->scene;
    bool one = doc->command != CLI_RENDER || doc->options.file_count == 0;
    put(t, plain, doc->verb);
    for (uint32_t i = 0; i < doc->word_count; i++) {
        int dropped = words_dropped(doc->words[i]);
        if (dropped) {
            i += (uint32_t)dropped - 1;
            continue;
        }
        put(t, plain, doc->words[i]);
        for (uint32_t s = 0; s < scene->count && !one; s++) {
            if (scene->sets[s].source->path == doc->words[i])
                put_settings(t, plain, doc, s);
        }
    }
    if (one)
        put_settings(t, plain, doc, 0);
}

static char *write_command(const document *doc, const cli_shot *shot, const char *out, bool plain) {
    cli_text t = {NULL, 0, 0, false};
    char text[64], *camera = camera_print(&shot->camera);
    if (!plain)
        put(&t, plain, "lineao");
    put_words(&t, plain, doc);
    if (doc->timed && (document_shows_time(doc) || doc->command == CLI_SURFACE)) {
        char time[32];
        cli_shortest(shot->time, time, sizeof time);
        put(&t, plain, "--time");
        put(&t, plain, time);
    }
    if (doc->options.surface.focus) {
        put(&t, plain, "--focus");
        put(&t, plain, doc->options.surface.focus);
    }
    put(&t, plain, "--camera");
    put(&t, plain, camera ? camera : "");
    free(camera);
    snprintf(text, sizeof text, "%ux%u", shot->width, shot->height);
    put(&t, plain, "--size");
    put(&t, plain, text);
    if (out) {
        put(&t, plain, "-o");
        put(&t, plain, out);
    }
    cli_text_add(&t, "", 1);
    if (!t.broken && camera)
        return t.text;
    free(t.text);
    return NULL;
}

char *document_command(const document *doc, const cli_shot *shot, const char *out) {
    return write_command(doc, shot, out, false);
}

char *document_words(const document *doc, const cli_shot *shot) {
    return write_command(doc, shot, NULL, true);
}
