/* What is open: the words of one command of the program (render, vessel or surface), the data that
 * they name, and what has been edited since. A document writes itself as a command line. */
#ifndef LINEAO_VIEW_DOCUMENT_H
#define LINEAO_VIEW_DOCUMENT_H

#include "pick.h"
#include "session.h"
#include "surface.h"
#include "vessel.h"
#include "vessel_lens.h"
#include "writing.h"

/* One struct of settings: those of the lines, of the tree or of the surface. */
typedef struct document_settings {
    const lao_module *module;
    const char *title; /* "Lines", or the name of the set */
    void *now;         /* owned by the scene: uint64_t set; float values[] */
    void *base;        /* owned: as loaded, for reset */
    uint64_t edited;
    uint32_t set;   /* whose: index in the scene */
    bool read_only; /* there only for the picture's common settings */
} document_settings;

typedef struct document {
    cli_command_bit command;
    const char *verb; /* "render", "vessel" or "surface" */
    char **words;     /* owned; without the command's name */
    uint32_t word_count;
    cli_options options;
    cli_scene lines;
    cli_tree tree;
    cli_lens lens;          /* over the tree */
    sdv_settings lens_base; /* of what is inside, as opened */
    cli_wall wall;
    cli_scene *scene;            /* in one of the three */
    cli_shot shot;               /* as the words ask for it */
    document_settings *settings; /* owned */
    uint32_t settings_count;
    pickable pickable; /* the scene, for the pointer */
    double beta;       /* ms^2, by which a wall is lit: as loaded, */
    double new_beta;   /* and being measured */
    uint32_t revision; /* of what is uploaded, besides what time and camera change */
    bool timed;        /* has points with times */
    bool added;        /* files joined what was open before */
} document;

/* Opens what the words name: a command and its flags, or files that tell by themselves which;
 * behind the words of `render` the last `added` may be files of any kind. For any thread; failures
 * go to its listener. NULL: reported. */
document *document_open(const char *const *words, uint32_t count, uint32_t added);
void document_close(document *doc);

/* The name of a file without its folder. */
const char *document_file_name(const char *path);
/* A name for the title: the first file, or the scene. */
const char *document_name(const document *doc);

/* Gives one setting a value; or that which it was loaded with. `index` counts document.settings. */
void document_set(document *doc, uint32_t index, int setting, float value);
void document_reset(document *doc, uint32_t index, int setting);
float document_value(const document *doc, uint32_t index, int setting);
/* Has a setting a meaning here? Trails want times, halos want lines; time says near_part. */
bool document_offers(const document *doc, uint32_t index, int setting);
/* What an edit of a setting needs to show. */
typedef enum document_need { NEEDS_NOTHING, NEEDS_MEASURES, NEEDS_OPENING } document_need;
document_need document_needs(const document *doc, uint32_t index, int setting);
/* The second of these, in three steps: says what is wanted; measures it beside the window, in any
 * thread (false: reported); shows it, or takes the edit back. */
void document_wish_measured(document *doc);
bool document_measure(document *doc);
void document_show_measured(document *doc, bool ok);

/* Moves the lens, which is a circle on the picture: --lens circle:X,Y,R. False: reported. */
bool document_move_lens(document *doc, const double circle[3]);

/* `doc` was opened with the words of `from`, edits among them: they are edits in it too, which can
 * be taken back. */
void document_inherit(document *doc, const document *from);

/* Shows the lines of a time, or all of them. */
void document_show_time(document *doc, bool shown);
bool document_shows_time(const document *doc);

/* A cli_picture_edit of a document: the legends that its words ask for. */
bool document_surround(void *user, picture *p);

/* "lineao render a.trk --set ... --camera '...' --size WxH -o picture.png", for a shell; the words
 * alone for `words` (not quoted, one a line). For free(). NULL: reported. */
char *document_command(const document *doc, const cli_shot *shot, const char *out);
char *document_words(const document *doc, const cli_shot *shot);
/* The words of `render` without a file and the flags that hold for it. */
char *document_without(const document *doc, const cli_shot *shot, const char *file);
/* The same as words of `render`, which further files can follow; settings, units and colours stay,
 * what else was said to lineao vessel or surface does not. */
char *document_joined(const document *doc, const cli_shot *shot);
/* Can further files join it? Scenes made by code stand alone. */
bool document_joins(const document *doc);

/* ---- between the files that make a document ---- */

/* Fills doc->settings. False: reported. */
bool document_list_settings(document *doc);
/* The values behind the `set` of a struct of settings. */
float *document_values(void *settings);

#endif
