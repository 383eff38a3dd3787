/* A vessel surface on its way to a picture: mesh, pathlines, distances, object, scene. */
#ifndef LINEAO_CLI_SURFACE_H
#define LINEAO_CLI_SURFACE_H

#include "dump.h"
#include "threads.h"

typedef struct cli_wall {
    const cli_options *options;
    const cli_source *source;
    const char *name; /* path, or the embedded surface's name */
    cli_threads *threads;
    cli_progress progress;
    vsf_host host;
    io_contents contents; /* of the file; its mesh's warnings are kept */
    bool turned;          /* the mesh is open, seemed inside out and was turned round */
    vsf_mesh mesh;        /* positions in mm, minus scene.origin */
    cli_scene scene;      /* a set that has the object, and one of lines unless there are none */
    cli_source line_source;
    vsf_near near;
    bool lit; /* `near` is there */
    vsf_object object;
    vsf_settings settings;
    double range[2]; /* of --value */
} cli_wall;

/* Reads or makes mesh and lines and all numbers that do not depend on the camera. False: reported;
 * free it in any case. */
bool cli_wall_load(const cli_options *options, cli_wall *out);
void cli_wall_free(cli_wall *wall);

/* Shows a time (ms). Returns whether the object's distances changed; then `update` is for
 * lao_object_update. */
bool cli_wall_time(cli_wall *wall, double time, lao_object_desc *update);
/* The settings that depend on the camera: --focus. */
void cli_wall_aim(cli_wall *wall, const cli_shot *shot);

#endif
