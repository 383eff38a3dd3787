/* Private to lineao_scene: signed distances (mm, negative inside) of simple shapes, and how they
 * flow into each other (a polynomial smooth minimum). */
#ifndef LINEAO_SCENE_SHAPES_H
#define LINEAO_SCENE_SHAPES_H

#include "scene_build.h"

double shape_ball(vec3 p, vec3 centre, double radius);

/* A tube from a to b, its radius from ra to rb: near enough to a distance for gentle tapers. */
double shape_tube(vec3 p, vec3 a, vec3 b, double ra, double rb);

/* Near enough to a distance on the surface of an ellipsoid. */
double shape_ellipsoid(vec3 p, vec3 centre, vec3 radii);

/* The lesser of two distances, blended where they differ by less than k; and the greater. */
double shape_join(double a, double b, double k);
double shape_cut(double a, double b, double k);

#endif
