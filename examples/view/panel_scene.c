/* The tab Scene: what is open, what else could be, the keys. */
#include "view.h"

#include "scene.h"

#include <stdio.h>
#include <string.h>

static void open_words(view *v, const char *const *words, uint32_t count) {
    v->hands.reopening = false;
    loader_start(v->loader, words, count);
}

/* A line as a shell would take it apart: words, and '...' or "..." around those with blanks. */
static void open_line(view *v) {
    static const uint32_t most = 256;
    const char *words[256];
    uint32_t count = 0;
    char copy[sizeof v->words], *text = copy, *to;
    memcpy(copy, v->words, sizeof copy);
    while (*text && count < most) {
        char quote = 0;
        text += strspn(text, " ");
        if (!*text)
            break;
        words[count++] = to = text;
        for (; *text && (quote || *text != ' '); text++) {
            if (quote ? *text == quote : *text == '\'' || *text == '"')
                quote = quote ? 0 : *text;
            else
                *to++ = *text;
        }
        if (*text)
            text++;
        *to = '\0';
    }
    bool named = count && (strcmp(words[0], "lineao") == 0 || strcmp(words[0], "./run") == 0);
    open_words(v, words + named, count - named);
}

static void embedded(view *v) {
    uint32_t count;
    const char *const *names = scene_names(&count);
    static const char *const surfaces[][2] = {{"aorta", "an arch with a bulge, and its flow"},
                                              {"aneurysm", "a sac at a bend, and its flow"},
                                              {"liver", "with a vein inside"},
                                              {"bone", "a shaft with two heads"}};
    const char *words[3] = {"render", "--scene", NULL};
    ui_text_dim("Lines");
    ui_widget_name("lines");
    for (uint32_t i = 0; i < count; i++) {
        words[2] = names[i];
        if (ui_item(names[i], false))
            open_words(v, words, 3);
        ui_help(scene_help(names[i]));
    }
    ui_text_dim("Vessel tree");
    words[0] = "vessel";
    ui_widget_name("tree");
    if (ui_item("liver", false))
        open_words(v, words, 1);
    ui_help("a grown tree of 3000 nodes");
    ui_text_dim("Surfaces");
    ui_group(1);
    words[0] = "surface";
    ui_widget_name("surface");
    for (int i = 0; i < 4; i++) {
        words[2] = surfaces[i][0];
        if (ui_item(surfaces[i][0], false))
            open_words(v, words, 3);
        ui_help(surfaces[i][1]);
    }
    ui_widget_name(NULL);
    ui_group_end();
}

/* One of several files, but no volume that is made of several. */
static bool can_go(const document *doc, const cli_set *set) {
    return doc->command == CLI_RENDER && doc->options.file_count > 1 && set->source->path &&
           set->name == set->source->path;
}

static void describe(view *v) {
    const cli_scene *scene = v->doc->scene;
    char text[512];
    for (uint32_t i = 0; i < scene->count; i++) {
        const cli_set *set = &scene->sets[i];
        const char *name = document_file_name(set->name);
        if (set->tree) {
            const sdv_tree_info *info = &set->tree->vessel.tree.info;
            snprintf(text, sizeof text, "%s: tree of %u nodes, %u segments, %u root%s", name,
                     info->nodes, info->segments, info->roots, info->roots == 1 ? "" : "s");
        } else if (set->wall) {
            snprintf(text, sizeof text, "%s: surface of %u vertices, %u triangles", name,
                     set->wall->mesh.vertex_count, set->wall->mesh.triangle_count);
        } else {
            snprintf(text, sizeof text, "%s: %u lines, %u points%s%s", name, set->lines.line_count,
                     set->lines.point_count, set->value ? ", coloured by " : "",
                     set->value ? set->value : "");
        }
        ui_text_wrapped(text);
        ui_help(set->name);
        ui_group((int)i);
        if (can_go(v->doc, set) && ui_small_button("Take away"))
            stage_remove(v, set->source->path);
        ui_group_end();
    }
}

void panel_keys(void) {
    const char *key, *help;
    ui_text_wrapped("Drag: turn. Shift or middle button: move. Right button or wheel: nearer, "
                    "farther. Rest: what is there? Click: keep it, and do something with it.");
    if (!ui_table("keys", 2, 1))
        return;
    for (uint32_t i = 0; i < input_keys(UINT32_MAX, &key, &help); i++) {
        input_keys(i, &key, &help);
        ui_cell();
        ui_text(key);
        ui_cell();
        ui_text_wrapped(help);
    }
    ui_table_end();
}

void panel_scene(view *v) {
    if (v->open)
        describe(v);
    ui_space();
    ui_text_dim("Files dropped on the window join what is open. Names typed here, with flags of "
                "lineao render, vessel or surface, take its place.");
    ui_width(-1);
    if (ui_input("##words", v->words, sizeof v->words, "FILE... or render FILE --color fa"))
        open_line(v);
    if (ui_section("Scenes made by code", true))
        embedded(v);
    if (ui_section("Pointer and keys (F1)", false))
        panel_keys();
}
