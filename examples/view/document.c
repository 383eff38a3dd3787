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
              document_list_settings(doc) && pick_prepare(doc->scene, &doc->pickable);
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

const char *document_file_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
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
