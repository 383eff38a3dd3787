/* Cameras of the example programs: JSON files, framing of data, named views, matrices.
 *
 * World space is right-handed, in mm; patient data are RAS (+x right, +y anterior, +z superior).
 * A function that can fail returns false, writes one line "FILE: what is wrong; how to mend it"
 * to `error` (may be NULL) and leaves its out-parameters untouched.
 * Thread: all functions are free of shared state. */
#ifndef LINEAO_CAMERA_H
#define LINEAO_CAMERA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CAMERA_ERROR_SIZE = 256 };

typedef struct camera_pose {
    double eye[3], center[3], up[3]; /* up need not be a unit vector nor square to the view */
    double fovy;                     /* full angle from bottom to top, degrees; 0: orthographic */
    double ortho_height;             /* full height of the view, mm; used when fovy is 0 */
} camera_pose;

/* Reads {"eye":[3],"center":[3],"up":[3],"fovy":degrees | "ortho_height":mm}. */
bool camera_read(const char *path, camera_pose *out, char error[CAMERA_ERROR_SIZE]);

/* Reads one camera or an array of them; *out is for free(). An empty array is an error. */
bool camera_read_all(const char *path, camera_pose **out, uint32_t *count,
                     char error[CAMERA_ERROR_SIZE]);

/* Parses the same text; `name` stands for the file in errors. */
bool camera_parse(const char *name, const char *text, camera_pose *out,
                  char error[CAMERA_ERROR_SIZE]);

/* The JSON text on one line, which reads back to the same bits; for free(). NULL: no memory. */
char *camera_print(const camera_pose *camera);

/* Writes that text and a line end. */
bool camera_write(const char *path, const camera_pose *camera, char error[CAMERA_ERROR_SIZE]);
/* Of several an array, which camera_read_all reads. */
bool camera_write_all(const char *path, const camera_pose *cameras, uint32_t count,
                      char error[CAMERA_ERROR_SIZE]);

/* Direction of view and up vector of "axial", "coronal", "sagittal" or "iso"; else false.
 *   axial     from above (-z), front up: neurological, the patient's right is on the right
 *   coronal   from the front (-y), head up: face to face, the patient's right is on the left
 *   sagittal  from the patient's left (+x), head up: the front is on the left
 *   iso       from the left, the front and above */
bool camera_view(const char *name, float direction[3], float up[3]);

/* Framing in three steps: the points of all data that should be seen go through camera_fit_add.
 * The result is exact: perspective or not, the projected points touch the margin on two sides. */
typedef struct camera_fit {
    double right[3], up[3], forward[3], aspect, fovy, slope[2];
    double low[3], high[3]; /* extent along right, up, forward */
    double reach[4];        /* largest of +-x - slope z and +-y - slope z */
} camera_fit;

/* Looks along `direction` with `up` upwards (any vectors; zero or parallel ones are mended).
 * aspect = width / height; margin = part of the half image left free at each side [0, 0.9];
 * fovy in degrees, 0 = orthographic. */
void camera_fit_begin(camera_fit *fit, const float direction[3], const float up[3], double aspect,
                      double margin, double fovy);

/* Adds count points of three floats; points that are not finite do not count. */
void camera_fit_add(camera_fit *fit, const float *points, size_t count);

/* Without any point: the unit ball around the origin. */
void camera_fit_end(const camera_fit *fit, camera_pose *out);

/* Framing of a whole turn, for a camera that goes round its up vector: one distance at which
 * nothing leaves the picture on the way. Begins where camera_fit_add has seen all points, whose
 * middle the axis goes through; they go through camera_orbit_add once more. The result is exact for
 * balls in that the farthest of them touch the margin somewhere on the way; what is between them
 * (round cones, triangles) stays inside it too. */
typedef struct camera_orbit {
    camera_fit fit;
    double axis[2];  /* along right and forward */
    double radius;   /* around the axis */
    double reach[2]; /* largest of +-height + slope * distance from the axis */
} camera_orbit;

void camera_orbit_begin(camera_orbit *orbit, const camera_fit *fit);

/* Adds count points of `step` floats: 3, or 4 with the radius of a ball. Those that are not finite
 * do not count. */
void camera_orbit_add(camera_orbit *orbit, const float *points, size_t step, size_t count);

/* Without any point: as camera_fit_end. */
void camera_orbit_end(const camera_orbit *orbit, camera_pose *out);

/* All of a single picture with a field of view of 30 degrees: fits the points or, when points is
 * NULL, the corners of the box lo..hi. A margin of 0.05 looks well. */
void camera_frame(const float lo[3], const float hi[3], const float *points, size_t count,
                  const float direction[3], const float up[3], double aspect, double margin,
                  camera_pose *out);

/* View and projection matrices, column-major, for column vectors: the view space is right-handed,
 * looks along -z and has +y up; clip space has +y up and depth 0 (near) .. 1 (far) or, unless
 * zero_to_one, -1 .. 1. Near and far planes enclose the ball around `center`; behind the eye a
 * perspective near plane stops at a thousandth of the far one. Computed in double. */
void camera_matrices(const camera_pose *camera, double aspect, const double center[3],
                     double radius, bool zero_to_one, float view[16], float projection[16]);

#endif
