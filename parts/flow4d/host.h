/* ================================================================================================
 * host: failures and work, as the host wants them; sizes and affine maps of lattices. Memory comes
   from lineao.h (its section host). The implementation begins here and ends with the last section;
   all of it uses the interface and lineao.h's host. */
#ifdef FLOW4D_IMPLEMENTATION
#ifndef FLOW4D_IMPLEMENTATION_DONE
#define FLOW4D_IMPLEMENTATION_DONE

#define LAO__HOST
#include "lineao.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The host with an allocator that works. */
static flow4d_host flow4d__host(const flow4d_host *host) {
    flow4d_host h;
    memset(&h, 0, sizeof h);
    if (host) {
        h = *host;
    }
    h.allocator = lao__allocator_or_default(&h.allocator);
    return h;
}

static lao_result flow4d__fail(const flow4d_host *host, flow4d_log_item item, const char *detail) {
    static const struct {
        lao_result result;
        const char *text;
    } items[] = {
#define FLOW4D__ITEM(id, result, text) {result, text},
        FLOW4D_LOG_ITEMS(FLOW4D__ITEM)
#undef FLOW4D__ITEM
    };
    char text[512];
    if (host && host->log) {
        snprintf(text, sizeof text, "%s: %s", items[item].text, detail);
        host->log(host->user, item, items[item].result, text);
    }
    return items[item].result;
}

static lao_result flow4d__setting_fail(const flow4d_host *host, const char *name, double value) {
    char text[64];
    snprintf(text, sizeof text, "%s is %g", name, value);
    return flow4d__fail(host, FLOW4D_LOG_SETTING, text);
}

typedef struct flow4d__part {
    void (*fn)(void *arg, size_t index);
    void *arg;
    size_t first;
} flow4d__part;

static void flow4d__part_run(void *arg, uint32_t index) {
    const flow4d__part *part = (const flow4d__part *)arg;
    part->fn(part->arg, part->first + index);
}

/* All of `count` pieces of work, asking the host now and then. */
static lao_result flow4d__work(const flow4d_host *host, const char *name, size_t count,
                               void (*fn)(void *arg, size_t index), void *arg) {
    flow4d__part part;
    part.fn = fn;
    part.arg = arg;
    for (part.first = 0; part.first < count;) {
        size_t left = count - part.first;
        uint32_t now = left < 64 ? (uint32_t)left : 64u;
        lao__job_run(&host->job, now, flow4d__part_run, &part);
        part.first += now;
        if (lao__job_cancelled(&host->job, part.first, count)) {
            return flow4d__fail(host, FLOW4D_LOG_CANCELLED, name);
        }
    }
    return LAO_OK;
}

static int flow4d__number(double value) {
    return value - value == 0.0;
}

static int flow4d__finite(const double *values, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        if (!flow4d__number(values[i])) {
            return 0;
        }
    }
    return 1;
}

/* ---- lattices: size and affine map */

/* values = product of the sizes, times `more`; 0 when one is 0 or the bytes overflow. */
static size_t flow4d__count(const uint32_t size[3], size_t more, size_t bytes) {
    size_t count = more, most = (size_t)-1 / bytes;
    int a;
    for (a = 0; a < 3; a++) {
        if (size[a] == 0 || count > most / size[a]) {
            return 0;
        }
        count *= size[a];
    }
    return count;
}

static double flow4d__determinant(const double m[12]) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

static double flow4d__edge(const double m[12], int axis) {
    return sqrt(m[axis] * m[axis] + m[axis + 4] * m[axis + 4] + m[axis + 8] * m[axis + 8]);
}

static double flow4d__shortest_edge(const double m[12]) {
    double shortest = flow4d__edge(m, 0);
    int a;
    for (a = 1; a < 3; a++) {
        if (flow4d__edge(m, a) < shortest) {
            shortest = flow4d__edge(m, a);
        }
    }
    return shortest;
}

/* Inverse of an affine map; 0, or -1 when there is none. Axes that are parallel to a trillionth
   count as such. */
static int flow4d__invert(const double m[12], double inverse[12]) {
    double d, scale;
    size_t i, j;
    if (!flow4d__finite(m, 12)) {
        return -1;
    }
    d = flow4d__determinant(m);
    scale = flow4d__edge(m, 0) * flow4d__edge(m, 1) * flow4d__edge(m, 2);
    if (!flow4d__number(scale) || !(fabs(d) > 1e-12 * scale)) {
        return -1;
    }
    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) {
            size_t a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, e = (i + 2) % 3;
            inverse[4 * i + j] = (m[4 * a + c] * m[4 * b + e] - m[4 * a + e] * m[4 * b + c]) / d;
        }
    }
    for (i = 0; i < 3; i++) {
        inverse[4 * i + 3] =
            -(inverse[4 * i] * m[3] + inverse[4 * i + 1] * m[7] + inverse[4 * i + 2] * m[11]);
    }
    return flow4d__finite(inverse, 12) ? 0 : -1;
}

static void flow4d__apply(const double m[12], const double p[3], double q[3]) {
    double x = p[0], y = p[1], z = p[2];
    q[0] = m[0] * x + m[1] * y + m[2] * z + m[3];
    q[1] = m[4] * x + m[5] * y + m[6] * z + m[7];
    q[2] = m[8] * x + m[9] * y + m[10] * z + m[11];
}

/* Checks size (of `more` items of `bytes` per voxel) and map, and inverts the map. */
static lao_result flow4d__lattice_check(const flow4d_host *host, const uint32_t size[3],
                                        size_t more, size_t bytes, const double to_world[12],
                                        double from_world[12]) {
    char text[96];
    if (!flow4d__count(size, more, bytes)) {
        snprintf(text, sizeof text, "%lu x %lu x %lu x %lu", (unsigned long)size[0],
                 (unsigned long)size[1], (unsigned long)size[2], (unsigned long)more);
        return flow4d__fail(host, FLOW4D_LOG_SIZE, text);
    }
    if (flow4d__invert(to_world, from_world) != 0) {
        snprintf(text, sizeof text, "determinant %g", flow4d__determinant(to_world));
        return flow4d__fail(host, FLOW4D_LOG_AFFINE, text);
    }
    return LAO_OK;
}
