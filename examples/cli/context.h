/* What stands behind and around lines: the greatest speed of a volume's beat, projected, the
 * silhouette of a mesh, and the outline of the vessel (Koehler et al. 2017, 2.2). */
#ifndef LINEAO_CLI_CONTEXT_H
#define LINEAO_CLI_CONTEXT_H

#include "picture.h"
#include "session.h"

struct flow4d_field;

/* Keeps a volume's temporal maximum and mask with the scene. False: reported. */
bool cli_context_keep(cli_scene *scene, const struct flow4d_field *field);
/* The same for the embedded scene of that name, if it has a field. False: reported. */
bool cli_context_keep_embedded(cli_scene *scene, const char *name);

/* Projections of all volumes of a scene: width * height floats each, top row first. */
typedef struct cli_context {
    float *intensity, *coverage; /* owned; NULL: the scene has neither volume nor outline */
    double brightest; /* speed (m/s) that the fastest hundredth of the vessel exceeds, or 1 */
} cli_context;

/* Projects with the camera of the shot. False: reported. Free in any case. */
bool cli_context_make(const cli_scene *scene, const cli_shot *shot, cli_context *out);
void cli_context_free(cli_context *context);

/* Lays a picture with a transparent background over the projection on paper of that colour, and
 * draws the outline. Paper that is not opaque: the outline alone. False: reported. */
bool cli_context_compose(const cli_context *context, const float paper[4], picture *lines);

#endif
