/* Moving a camera by hand. Poses are absolute, in mm. */
#ifndef LINEAO_VIEW_ORBIT_H
#define LINEAO_VIEW_ORBIT_H

#include "camera.h"

#include <stdbool.h>

/* Turns the eye around the centre by angles (radians): to the right and upwards. Turntable: around
 * `axis`, which stays upright; else freely, around the picture's own axes. */
void orbit_turn(camera_pose *pose, double right, double up, bool turntable, const double axis[3]);
/* Moves eye and centre; 1 is the height of the picture at the centre. */
void orbit_pan(camera_pose *pose, double right, double up);
/* Comes nearer by a factor above 1; an orthographic view shows less. */
void orbit_dolly(camera_pose *pose, double factor);
/* The same view, perspective or orthographic. */
void orbit_project(camera_pose *pose, bool orthographic);
/* Looks along a direction at the same centre from the same distance. */
void orbit_look(camera_pose *pose, const float direction[3], const float up[3]);
/* A ray through a place of the picture: x and y are -1 .. 1, y up. Unit direction. */
void orbit_ray(const camera_pose *pose, double aspect, double x, double y, double from[3],
               double direction[3]);
/* Height (mm) of the picture at the centre. */
double orbit_height(const camera_pose *pose);

#endif
