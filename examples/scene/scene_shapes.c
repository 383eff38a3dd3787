#include "scene_shapes.h"

#include <math.h>

double shape_ball(vec3 p, vec3 centre, double radius) {
    vec3 d = vec3_sub(p, centre);
    return sqrt(vec3_dot(d, d)) - radius;
}

double shape_tube(vec3 p, vec3 a, vec3 b, double ra, double rb) {
    vec3 d = vec3_sub(b, a), q = vec3_sub(p, a);
    double u = vec3_dot(q, d) / vec3_dot(d, d);
    u = u < 0 ? 0 : u > 1 ? 1 : u;
    return shape_ball(p, vec3_mad(a, d, u), ra + u * (rb - ra));
}

double shape_ellipsoid(vec3 p, vec3 centre, vec3 radii) {
    vec3 d = vec3_sub(p, centre);
    vec3 one = vec3_make(d.x / radii.x, d.y / radii.y, d.z / radii.z);
    vec3 two = vec3_make(one.x / radii.x, one.y / radii.y, one.z / radii.z);
    double k = sqrt(vec3_dot(one, one)), l = sqrt(vec3_dot(two, two));
    return l > 1e-12 ? k * (k - 1) / l : -radii.x;
}

double shape_join(double a, double b, double k) {
    double h = k - fabs(a - b);
    return (a < b ? a : b) - (h > 0 ? h * h / (4 * k) : 0);
}
double shape_cut(double a, double b, double k) {
    return -shape_join(-a, -b, k);
}
