/* ================================================================================================
 * triangle: triangles and their angles, areas and gradients, in double precision. Uses no other
   section. */

static void vsf__load(const float *p, double v[3]) {
    v[0] = (double)p[0];
    v[1] = (double)p[1];
    v[2] = (double)p[2];
}
static void vsf__sub(const double a[3], const double b[3], double r[3]) {
    int k;
    for (k = 0; k < 3; k++) {
        r[k] = a[k] - b[k];
    }
}
static double vsf__dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static void vsf__cross(const double a[3], const double b[3], double r[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
    r[0] = x;
    r[1] = y;
}
/* Divides by the length and returns it; a vector without one becomes 0. */
static double vsf__unit(double v[3]) {
    double length = sqrt(vsf__dot(v, v));
    int k;
    for (k = 0; k < 3; k++) {
        v[k] = length > 0 ? v[k] / length : 0;
    }
    return length;
}
/* Unit normal of a triangle; returns twice its area. */
static double vsf__face(const double p0[3], const double p1[3], const double p2[3],
                        double normal[3]) {
    double a[3], b[3];
    vsf__sub(p1, p0, a);
    vsf__sub(p2, p0, b);
    vsf__cross(a, b, normal);
    return vsf__unit(normal);
}
/* The gradient is a (l1 - l0) + b (l2 - l0). Returns twice the area, 0 without one. */
static double vsf__gradient_parts(const double p0[3], const double p1[3], const double p2[3],
                                  double normal[3], double a[3], double b[3]) {
    double e1[3], e2[3], area2 = vsf__face(p0, p1, p2, normal);
    int k;
    vsf__sub(p0, p2, e2);
    vsf__sub(p1, p0, e1);
    vsf__cross(normal, e2, a);
    vsf__cross(normal, e1, b);
    for (k = 0; k < 3; k++) {
        a[k] = area2 > 0 ? a[k] / area2 : 0;
        b[k] = area2 > 0 ? b[k] / area2 : 0;
    }
    return area2;
}
VSF_API void vsf_triangle_gradient(const double p0[3], const double p1[3], const double p2[3],
                                   const double l[3], double gradient[3]) {
    double n[3], a[3], b[3];
    int k;
    vsf__gradient_parts(p0, p1, p2, n, a, b);
    for (k = 0; k < 3; k++) {
        gradient[k] = a[k] * (l[1] - l[0]) + b[k] * (l[2] - l[0]);
    }
}
VSF_API int vsf_turn(const double from[3], const double to[3], const double v[3],
                     double turned[3]) {
    double axis[3], across[3], c = vsf__dot(from, to), along, input[3];
    int k;
    memcpy(input, v, sizeof input);
    vsf__cross(from, to, axis);
    vsf__cross(axis, input, across);
    along = vsf__dot(axis, input);
    for (k = 0; k < 3; k++) { /* Rodrigues; |axis| is the sine */
        turned[k] = c > -1 + 1e-9 ? c * input[k] + across[k] + axis[k] * (along / (1 + c)) : 0;
    }
    return c > -1 + 1e-9 ? 0 : -1;
}
VSF_API void vsf_corner_areas(const double p0[3], const double p1[3], const double p2[3],
                              double areas[3]) {
    const double *p[3];
    double e[3][3], dot[3], n[3], area;
    int k, obtuse = -1;
    p[0] = p0;
    p[1] = p1;
    p[2] = p2;
    area = 0.5 * vsf__face(p0, p1, p2, n);
    for (k = 0; k < 3; k++) {
        vsf__sub(p[(k + 2) % 3], p[(k + 1) % 3], e[k]); /* opposite to corner k */
    }
    for (k = 0; k < 3; k++) {
        dot[k] = -vsf__dot(e[(k + 1) % 3], e[(k + 2) % 3]);
        obtuse = dot[k] < 0 ? k : obtuse;
    }
    for (k = 0; k < 3; k++) {
        int q = (k + 1) % 3, r = (k + 2) % 3;
        if (!(area > 0)) {
            areas[k] = 0;
        } else if (obtuse >= 0) {
            areas[k] = obtuse == k ? area / 2 : area / 4;
        } else { /* cot = dot / (2 area), at the angle opposite to the edge */
            areas[k] =
                (vsf__dot(e[q], e[q]) * dot[q] + vsf__dot(e[r], e[r]) * dot[r]) / (16 * area);
        }
    }
}
