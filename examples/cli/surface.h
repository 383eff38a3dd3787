/* A vessel surface on its way to a picture: mesh, pathlines, distances, object, scene. */
#ifndef LINEAO_CLI_SURFACE_H
#define LINEAO_CLI_SURFACE_H

#include "dump.h"
#include "io_vessel.h"
#include "legend.h"
#include "threads.h"

typedef struct cli_wall {
    const cli_options *options;
    const cli_source *source;
    const char *name; /* path, or the embedded surface's name */
    cli_threads *threads;
    cli_progress progress;
    vsf_host host;
    io_contents contents; /* of the file; its mesh's or tree's warnings are kept */
    io_vessel vessel;     /* of a file that holds a tree */
    uint32_t widened;     /* nodes of it that were thinner than this, and were made so wide: */
    double thinnest;      /* mm */
    uint32_t decimated;   /* triangles that the mesh had before it was decimated; 0: it was not */
    uint32_t decimated_to;
    bool made;       /* the mesh is from marching cubes, with their stairs */
    bool turned;     /* it is open, seemed inside out and was turned round */
    bool placed;     /* the origin is that of lines or others in the scene, not its own */
    vsf_mesh mesh;   /* positions in mm, minus scene.origin */
    cli_scene scene; /* a set that has the object, and one of lines unless there are none */
    cli_source line_source;
    vsf_near near;
    bool lit;      /* `near` is there */
    vsf_near next; /* its successor, if it has a step_count; see cli_wall_measure */
    void *kept;    /* owned; the memory of near.values, which `next` has no need of */
    bool trails;   /* the length of the lines' trails is how far they are lit */
    vsf_object object;
    vsf_settings settings;
    double range[2];      /* of --value */
    double curvature;     /* median, 1/mm; 0: not yet known */
    uint32_t contours[2]; /* sets of the scene that show vsf_feature 0 and 1; 0: not yet there */
    colour_map map;       /* of --wall-colormap */
    char note[CLI_NOTE];  /* what pictures have no room for, or "" */
} cli_wall;

/* Do the options give lines: of a file, or of an embedded surface that has a flow? Volumes have
 * their own. */
bool cli_wall_has_lines(const cli_options *options);

/* Reads or makes mesh and lines and all numbers that do not depend on the camera. place: (Optional)
 * among others in a scene. False: reported; free it in any case. */
bool cli_wall_load(const cli_options *options, const cli_place *place, cli_wall *out);
void cli_wall_free(cli_wall *wall);

/* Reads or makes the mesh. Its origin is scene.origin, which it chooses unless there are lines.
 * False: reported. */
bool cli_wall_mesh(cli_wall *wall);

/* Shows a time (ms). Returns whether the object's distances changed; then `update` is for
 * lao_object_update. */
bool cli_wall_time(cli_wall *wall, double time, lao_object_desc *update);
/* Measures the distances for another highlight_beta (ms^2) beside all that shows the wall, which
 * goes on with those that it has: in a thread of its own, one at a time. False: reported. */
bool cli_wall_measure(cli_wall *wall, double beta);
/* Shows what was measured, if there is something; what depends on it is to be shown anew. */
bool cli_wall_relight(cli_wall *wall);
/* What depends on the camera: --focus, and contours as further sets of lines, made anew by each
 * call. False: reported.
 */
bool cli_wall_aim(cli_wall *wall, const cli_shot *shot);
/* Of that --focus alone, which takes no time. */
void cli_wall_focus(cli_wall *wall, const cli_shot *shot);
/* The camera as the passes see it. */
void cli_wall_eye(const cli_shot *shot, float eye[4]);
/* The scales of its colours, at most two; maps and titles are kept in the others. How many? */
uint32_t cli_wall_scales(cli_wall *wall, colour_map maps[2], char titles[2][160], legend out[2]);
/* A cli_picture_edit of a cli_wall: draws the legends that --legend asks for. */
bool cli_wall_legends(void *user, picture *p);
/* Sets wall->note. False: reported. */
bool cli_wall_legends_check(cli_wall *wall, const cli_shot *shot);
/* The warning i of all about the mesh; false: there are fewer. */
bool cli_wall_warning(const cli_wall *wall, uint32_t i, char *text, size_t size);
/* A cli_planes_edit of a cli_wall: positions become absolute. */
bool cli_wall_planes(void *user, cli_planes *planes);

#endif
