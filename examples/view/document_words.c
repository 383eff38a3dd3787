/* A document as a command line, or as the words that open it again. */
#include "document.h"

#include "io_volume.h"
#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
        cli_setting_text(row, document_values(s->now)[k], value, sizeof value);
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
