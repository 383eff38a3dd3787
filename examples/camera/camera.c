#include "camera.h"

#include <math.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* False, and untouched, when too short to have a direction. */
static bool normalize(double a[3]) {
    double length = sqrt(dot(a, a));
    if (!(length > 1e-12) || !isfinite(length))
        return false;
    for (int i = 0; i < 3; i++)
        a[i] /= length;
    return true;
}

/* The orthonormal frame of a view; a missing direction is -z, a useless up the axis least along
 * the view. */
static void make_frame(const double direction[3], const double wanted_up[3], double right[3],
                       double up[3], double forward[3]) {
    memcpy(forward, direction, 3 * sizeof *forward);
    if (!normalize(forward)) {
        forward[0] = forward[1] = 0.0;
        forward[2] = -1.0;
    }
    memcpy(up, wanted_up, 3 * sizeof *up);
    normalize(up);
    cross(forward, up, right);
    if (!normalize(right) || dot(up, up) < 0.5) {
        int least = fabs(forward[0]) < fabs(forward[1]) ? 0 : 1;
        if (fabs(forward[2]) < fabs(forward[least]))
            least = 2;
        for (int i = 0; i < 3; i++)
            up[i] = i == least ? 1.0 : 0.0;
        cross(forward, up, right);
        normalize(right);
    }
    cross(right, forward, up);
}

/* ---- views and framing ------------------------------------------------------------------ */

bool camera_view(const char *name, float direction[3], float up[3]) {
    static const struct {
        const char *name;
        float direction[3], up[3];
    } views[] = {
        {"axial", {0, 0, -1}, {0, 1, 0}},
        {"coronal", {0, -1, 0}, {0, 0, 1}},
        {"sagittal", {1, 0, 0}, {0, 0, 1}},
        {"iso", {0.62f, -0.62f, -0.48f}, {0, 0, 1}},
    };
    for (size_t i = 0; name && i < sizeof views / sizeof *views; i++) {
        if (strcmp(name, views[i].name) != 0)
            continue;
        memcpy(direction, views[i].direction, sizeof views[i].direction);
        memcpy(up, views[i].up, sizeof views[i].up);
        return true;
    }
    return false;
}

void camera_fit_begin(camera_fit *fit, const float direction[3], const float up[3], double aspect,
                      double margin, double fovy) {
    const double towards[3] = {direction[0], direction[1], direction[2]};
    const double upwards[3] = {up[0], up[1], up[2]};
    make_frame(towards, upwards, fit->right, fit->up, fit->forward);
    fit->aspect = aspect;
    fit->fovy = fovy;
    double room = 1.0 - fmin(fmax(margin, 0.0), 0.9);
    fit->slope[1] = room * (fovy > 0.0 ? tan(0.5 * fovy * degree) : 1.0);
    fit->slope[0] = fit->slope[1] * aspect;
    for (int i = 0; i < 3; i++) {
        fit->low[i] = INFINITY;
        fit->high[i] = -INFINITY;
    }
    for (int i = 0; i < 4; i++)
        fit->reach[i] = -INFINITY;
}

void camera_fit_add(camera_fit *fit, const float *points, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const double p[3] = {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
            continue;
        const double q[3] = {dot(p, fit->right), dot(p, fit->up), dot(p, fit->forward)};
        for (int k = 0; k < 3; k++) {
            fit->low[k] = fmin(fit->low[k], q[k]);
            fit->high[k] = fmax(fit->high[k], q[k]);
        }
        for (int k = 0; k < 4; k++) {
            double x = k % 2 ? -q[k / 2] : q[k / 2];
            fit->reach[k] = fmax(fit->reach[k], x - fit->slope[k / 2] * q[2]);
        }
    }
}

/* A point (x, y, z) of the frame is seen from the eye (X, Y, Z) when |x - X| <= s (z - Z), the
 * same for y. So X - s Z >= max(x - s z) and -X - s Z >= max(-x - s z): the sum of both bounds Z,
 * their difference gives the X that leaves equal room on both sides. */
void camera_fit_end(const camera_fit *fit, camera_pose *out) {
    double low[3], high[3], reach[4], radius = 0.0;
    for (int i = 0; i < 3; i++) {
        bool empty = fit->low[i] > fit->high[i];
        low[i] = empty ? -1.0 : fit->low[i];
        high[i] = empty ? 1.0 : fit->high[i];
        radius += 0.25 * (high[i] - low[i]) * (high[i] - low[i]);
    }
    for (int k = 0; k < 4; k++) {
        bool empty = fit->reach[k] == -INFINITY;
        reach[k] = empty ? 1.0 + fit->slope[k / 2] : fit->reach[k];
    }
    radius = radius > 0.0 ? sqrt(radius) : 1.0; /* a single point */

    double eye[3] = {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2] - radius};
    double height = fmax(high[1] - low[1], (high[0] - low[0]) / fit->aspect) / fit->slope[1];
    if (fit->fovy > 0.0) {
        eye[2] = low[2] - 0.25 * radius; /* lines seen end-on must not touch the eye */
        for (size_t i = 0; i < 2; i++) {
            eye[i] = 0.5 * (reach[2 * i] - reach[2 * i + 1]);
            eye[2] = fmin(eye[2], -0.5 * (reach[2 * i] + reach[2 * i + 1]) / fit->slope[i]);
        }
    }
    double middle = 0.5 * (low[2] + high[2]);
    for (int i = 0; i < 3; i++) {
        double across = eye[0] * fit->right[i] + eye[1] * fit->up[i];
        out->eye[i] = across + eye[2] * fit->forward[i];
        out->center[i] = across + middle * fit->forward[i];
        out->up[i] = fit->up[i];
    }
    out->fovy = fit->fovy > 0.0 ? fit->fovy : 0.0;
    out->ortho_height = fit->fovy > 0.0 ? 0.0 : height > 0.0 ? height : 2.0 * radius;
}

void camera_orbit_begin(camera_orbit *orbit, const camera_fit *fit) {
    orbit->fit = *fit;
    orbit->axis[0] = 0.5 * (fit->low[0] + fit->high[0]);
    orbit->axis[1] = 0.5 * (fit->low[2] + fit->high[2]);
    orbit->radius = 0.0;
    orbit->reach[0] = orbit->reach[1] = -INFINITY;
}

void camera_orbit_add(camera_orbit *orbit, const float *points, size_t step, size_t count) {
    const camera_fit *fit = &orbit->fit;
    double slope = fit->fovy > 0.0 ? fit->slope[1] : 0.0, rim = sqrt(1.0 + slope * slope);
    for (size_t i = 0; i < count; i++) {
        const float *at = points + step * i;
        const double p[3] = {at[0], at[1], at[2]}, ball = step > 3 ? fmax(at[3], 0.0) : 0.0;
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]) || !isfinite(ball))
            continue;
        double apart =
            hypot(dot(p, fit->right) - orbit->axis[0], dot(p, fit->forward) - orbit->axis[1]);
        double high = dot(p, fit->up), near = slope * apart + rim * ball;
        orbit->radius = fmax(orbit->radius, apart + ball);
        orbit->reach[0] = fmax(orbit->reach[0], high + near);
        orbit->reach[1] = fmax(orbit->reach[1], -high + near);
    }
}

/* The eye is at a distance D from the axis, at a height H. A circle of radius R around the axis is
 * seen from there at an angle whose sine is R / D: R <= D s / sqrt(1 + s^2). Of a point at height h
 * and r from the axis the nearest place counts: |h - H| <= s (D - r), so H + s D >= max(h + s r)
 * and -H + s D >= max(-h + s r). */
void camera_orbit_end(const camera_orbit *orbit, camera_pose *out) {
    const camera_fit *fit = &orbit->fit;
    const double *reach = orbit->reach;
    camera_fit_end(fit, out);
    if (reach[0] == -INFINITY)
        return;
    double both = reach[0] + reach[1], wide = orbit->radius / fit->slope[0];
    double high = 0.5 * (reach[0] - reach[1]);
    double away = 1.25 * orbit->radius; /* nothing touches the eye */
    if (fit->fovy > 0.0)
        away = fmax(fmax(away, 0.5 * both / fit->slope[1]), hypot(wide, orbit->radius));
    away = away > 0.0 ? away : 1.0; /* a single point */
    for (int i = 0; i < 3; i++) {
        out->center[i] =
            orbit->axis[0] * fit->right[i] + high * fit->up[i] + orbit->axis[1] * fit->forward[i];
        out->eye[i] = out->center[i] - away * fit->forward[i];
    }
    double height = fmax(both / fit->slope[1], 2.0 * orbit->radius / fit->slope[0]);
    if (!(fit->fovy > 0.0) && height > 0.0)
        out->ortho_height = height;
}

void camera_frame(const float lo[3], const float hi[3], const float *points, size_t count,
                  const float direction[3], const float up[3], double aspect, double margin,
                  camera_pose *out) {
    camera_fit fit;
    camera_fit_begin(&fit, direction, up, aspect, margin, 30.0);
    if (points) {
        camera_fit_add(&fit, points, count);
    } else {
        for (int i = 0; i < 8; i++) {
            const float corner[3] = {i & 1 ? hi[0] : lo[0], i & 2 ? hi[1] : lo[1],
                                     i & 4 ? hi[2] : lo[2]};
            camera_fit_add(&fit, corner, 1);
        }
    }
    camera_fit_end(&fit, out);
}

/* ---- matrices --------------------------------------------------------------------------- */

void camera_matrices(const camera_pose *camera, double aspect, const double center[3],
                     double radius, bool zero_to_one, float view[16], float projection[16]) {
    double direction[3], right[3], up[3], forward[3], to_center[3];
    for (int i = 0; i < 3; i++) {
        direction[i] = camera->center[i] - camera->eye[i];
        to_center[i] = center[i] - camera->eye[i];
    }
    make_frame(direction, camera->up, right, up, forward);
    for (int i = 0; i < 3; i++) {
        view[4 * i + 0] = (float)right[i];
        view[4 * i + 1] = (float)up[i];
        view[4 * i + 2] = (float)-forward[i];
        view[4 * i + 3] = 0.0f;
    }
    view[12] = (float)-dot(right, camera->eye);
    view[13] = (float)-dot(up, camera->eye);
    view[14] = (float)dot(forward, camera->eye);
    view[15] = 1.0f;

    double away = dot(to_center, forward), room = fmax(1.001 * radius, 1e-3);
    double near = away - room, far = away + room;
    double p[16] = {0.0};
    if (camera->fovy > 0.0) {
        if (far <= 0.0)
            far = room; /* all data are behind the eye: any valid range will do */
        near = fmax(near, 1e-3 * far);
        double scale = 1.0 / tan(0.5 * camera->fovy * degree);
        p[0] = scale / aspect;
        p[5] = scale;
        p[10] = zero_to_one ? far / (near - far) : (far + near) / (near - far);
        p[11] = -1.0;
        p[14] = (zero_to_one ? 1.0 : 2.0) * far * near / (near - far);
    } else {
        p[0] = 2.0 / (camera->ortho_height * aspect);
        p[5] = 2.0 / camera->ortho_height;
        p[10] = (zero_to_one ? 1.0 : 2.0) / (near - far);
        p[14] = zero_to_one ? near / (near - far) : (far + near) / (near - far);
        p[15] = 1.0;
    }
    for (int i = 0; i < 16; i++)
        projection[i] = (float)p[i];
}
