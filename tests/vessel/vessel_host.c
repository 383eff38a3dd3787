#include "vessel_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void keep_log(void *user, sdv_log_item item, lao_result result, const char *text) {
    lent_log((lent_host *)user, (uint32_t)item, result, text);
}

sdv_host vessel_host_make(lent_host *host) {
    sdv_host h;
    memset(host, 0, sizeof *host);
    memset(&h, 0, sizeof h);
    h.allocator = lent_allocator(&host->memory);
    h.job = lent_job(host);
    h.log = keep_log;
    h.user = host;
    return h;
}

lao_v3 vessel_point(uint32_t *seed, double size) {
    float x = (float)lent_between(seed, -size, size), y = (float)lent_between(seed, -size, size);
    return lao_v3_make(x, y, (float)lent_between(seed, -size, size));
}
lao_v3 vessel_direction(uint32_t *seed) {
    float u = (float)lent_between(seed, 0, 1);
    return lao_sphere_point(u, (float)lent_between(seed, 0, 1));
}

void vessel_random_tree(uint32_t seed, uint32_t n, double size, double radius, float *positions,
                        float *radii, sdv_segment *segments) {
    for (uint32_t i = 0; i < n; i++) {
        uint32_t parent = i ? (uint32_t)lent_between(&seed, i > 20 ? i - 20 : 0, i) : 0;
        double step = i ? 0.15 * size : 0.5 * size;
        for (int k = 0; k < 3; k++) {
            double from = i ? (double)positions[3 * parent + (uint32_t)k] : 0;
            double v = from + lent_between(&seed, -step, step);
            positions[3 * i + (uint32_t)k] = (float)(v > size / 2    ? size / 2
                                                     : v < -size / 2 ? -size / 2
                                                                     : v);
        }
        radii[i] = (float)lent_between(&seed, 0.05 * radius, radius);
        if (i) {
            segments[i - 1].parent = parent;
            segments[i - 1].child = i;
        }
    }
}

double vessel_cone_distance(const lao_v4 *cone, const double p[3]) {
    double a[3], b[3], q[3], s2 = 0, qa = 0, qq = 0, qb = 0;
    double ra = (double)cone[0].w, rb = (double)cone[1].w, d = ra - rb;
    const float fa[3] = {cone[0].x, cone[0].y, cone[0].z},
                fb[3] = {cone[1].x, cone[1].y, cone[1].z};
    for (int k = 0; k < 3; k++) {
        a[k] = (double)fa[k];
        b[k] = (double)fb[k] - a[k];
        q[k] = p[k] - a[k];
        s2 += b[k] * b[k];
        qa += q[k] * b[k];
        qq += q[k] * q[k];
        qb += (q[k] - b[k]) * (q[k] - b[k]);
    }
    double s = sqrt(s2);
    if (s <= fabs(d) + 1e-6 * fmax(ra, rb))
        return d < 0 ? sqrt(qb) - rb : sqrt(qq) - ra;
    double x = qa / s, y = sqrt(fmax(qq - x * x, 0)), t = x - y * d / sqrt(s2 - d * d);
    if (t < 0)
        return sqrt(qq) - ra;
    if (t > s)
        return sqrt(qb) - rb;
    return (d * x + sqrt(s2 - d * d) * y) / s - ra;
}
