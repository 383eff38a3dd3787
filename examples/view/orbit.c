#include "orbit.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    memcpy(out, c, sizeof c);
}

/* False: it has no length. */
static bool unit(double v[3]) {
    double length = sqrt(dot(v, v));
    for (int k = 0; k < 3 && length > 0; k++)
        v[k] /= length;
    return length > 0;
}

/* Rodrigues. */
static void rotate(double v[3], const double axis[3], double angle) {
    double c = cos(angle), s = sin(angle), side[3], along = dot(axis, v);
    cross(axis, v, side);
    for (int k = 0; k < 3; k++)
        v[k] = v[k] * c + side[k] * s + axis[k] * along * (1 - c);
}

/* Unit axes of the picture. */
static void axes_of(const camera_pose *pose, double right[3], double up[3], double forward[3]) {
    for (int k = 0; k < 3; k++)
        forward[k] = pose->center[k] - pose->eye[k];
    unit(forward);
    cross(forward, pose->up, right);
    if (!unit(right)) { /* up lies along the view: any other will do */
        const double other[3] = {forward[1] != 0 || forward[2] != 0, forward[0] != 0, 0};
        cross(forward, other, right);
        unit(right);
    }
    cross(right, forward, up);
}

void orbit_turn(camera_pose *pose, double right, double up, bool turntable, const double axis[3]) {
    double r[3], u[3], f[3], arm[3];
    axes_of(pose, r, u, f);
    for (int k = 0; k < 3; k++)
        arm[k] = pose->eye[k] - pose->center[k];
    memcpy(pose->up, u, sizeof u);
    if (turntable) {
        double steep = asin(fmax(-1, fmin(1, -dot(f, axis)))); /* never over the top */
        double most = 1.55;
        up = fmax(-most, fmin(most, steep + up)) - steep;
        double turned[3] = {axis[0], axis[1], axis[2]};
        rotate(arm, r, -up);
        rotate(pose->up, r, -up);
        rotate(arm, turned, -right);
        rotate(pose->up, turned, -right);
    } else {
        rotate(arm, r, -up);
        rotate(pose->up, r, -up);
        rotate(arm, u, -right);
        rotate(pose->up, u, -right);
    }
    for (int k = 0; k < 3; k++)
        pose->eye[k] = pose->center[k] + arm[k];
}

double orbit_height(const camera_pose *pose) {
    double d[3];
    for (int k = 0; k < 3; k++)
        d[k] = pose->center[k] - pose->eye[k];
    return pose->fovy > 0 ? 2 * sqrt(dot(d, d)) * tan(pose->fovy * 3.14159265358979 / 360)
                          : pose->ortho_height;
}

void orbit_pan(camera_pose *pose, double right, double up) {
    double r[3], u[3], f[3], height = orbit_height(pose);
    axes_of(pose, r, u, f);
    for (int k = 0; k < 3; k++) {
        double move = height * (right * r[k] + up * u[k]);
        pose->eye[k] += move;
        pose->center[k] += move;
    }
}

void orbit_dolly(camera_pose *pose, double factor) {
    for (int k = 0; k < 3; k++)
        pose->eye[k] = pose->center[k] + (pose->eye[k] - pose->center[k]) / factor;
    pose->ortho_height /= factor;
}

void orbit_project(camera_pose *pose, bool orthographic) {
    double height = orbit_height(pose), d[3];
    if (orthographic == !(pose->fovy > 0))
        return;
    pose->ortho_height = orthographic ? height : 0;
    pose->fovy = orthographic ? 0 : 30;
    for (int k = 0; k < 3; k++)
        d[k] = pose->eye[k] - pose->center[k];
    unit(d);
    double distance = height / (2 * tan(30 * 3.14159265358979 / 360));
    for (int k = 0; k < 3; k++)
        pose->eye[k] = pose->center[k] + d[k] * distance;
}

void orbit_look(camera_pose *pose, const float direction[3], const float up[3]) {
    double d[3], toward[3] = {direction[0], direction[1], direction[2]};
    for (int k = 0; k < 3; k++)
        d[k] = pose->center[k] - pose->eye[k];
    double distance = sqrt(dot(d, d));
    unit(toward);
    for (int k = 0; k < 3; k++) {
        pose->eye[k] = pose->center[k] - toward[k] * distance;
        pose->up[k] = up[k];
    }
}

void orbit_ray(const camera_pose *pose, double aspect, double x, double y, double from[3],
               double direction[3]) {
    double r[3], u[3], f[3];
    axes_of(pose, r, u, f);
    double half =
        pose->fovy > 0 ? tan(pose->fovy * 3.14159265358979 / 360) : pose->ortho_height / 2;
    bool lens = pose->fovy > 0;
    for (int k = 0; k < 3; k++) {
        double aside = half * (x * aspect * r[k] + y * u[k]);
        from[k] = pose->eye[k] + (lens ? 0 : aside);
        direction[k] = f[k] + (lens ? aside : 0);
    }
    unit(direction);
}
