/* Measures the near-wall distances of vesselsurface.h: growth with vertices, points and steps, and
   how many times as fast as brute force they are. Prints one JSON object. bench_surface_near
   [--vertices N] [--points N] [--steps K] [--sample N] [--least RATIO]
                        [--export FOLDER]
   Vertices lie on the wall of a bent vessel, points on pathlines inside, 100 to a line, over one
   beat of 800 ms. Brute force is measured on every N-th vertex (--sample, 20), because it is linear
   in vertices. With --least the exit is 1 when the ratio is less, or results differ. --export
   writes positions, points, times and the distances of the middle step, for near_peer.py. */
#include "vesselsurface.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct scene {
    uint32_t vertices, points, lines;
    float *positions, *line_points, *times;
    uint32_t *offsets;
} scene;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t); /* one thread; others may use the machine */
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static void *room(size_t size) {
    void *memory = malloc(size ? size : 1);
    if (!memory) {
        fprintf(stderr, "bench_surface_near: no memory\n");
        exit(1);
    }
    return memory;
}
static double unit(uint32_t a, uint32_t b) {
    return (double)lao_unit_float(lao_hash(a + lao_hash(b)));
}

/* A place in the vessel: half a torus with radii 40 and 12 mm, from turn 0 to 1 along it. */
static void place(double along, double angle, double radius, float *p) {
    double a = 3.14159265358979 * along, ring = 40 + radius * cos(angle);
    p[0] = (float)(ring * cos(a));
    p[1] = (float)(ring * sin(a));
    p[2] = (float)(radius * sin(angle));
}
static scene scene_make(uint32_t vertices, uint32_t points) {
    scene s;
    s.vertices = vertices;
    s.lines = points / 100;
    s.points = s.lines * 100;
    s.positions = (float *)room(sizeof(float) * 3 * vertices);
    s.line_points = (float *)room(sizeof(float) * 3 * s.points);
    s.times = (float *)room(sizeof(float) * s.points);
    s.offsets = (uint32_t *)room(sizeof(uint32_t) * (s.lines + 1));
    for (uint32_t i = 0; i < vertices; i++) /* in no order */
        place(unit(i, 1), 6.28318530717959 * unit(i, 2), 12, s.positions + 3 * i);
    for (uint32_t i = 0; i <= s.lines; i++)
        s.offsets[i] = 100 * i;
    for (uint32_t i = 0; i < s.lines; i++) {
        double radius = 11.5 * sqrt(unit(i, 3)), angle = 6.28318530717959 * unit(i, 4);
        double speed = 0.6 * (1 - radius * radius / 150), start = unit(i, 5),
               twist = 3 * unit(i, 6);
        for (uint32_t k = 0; k < 100; k++) {
            double beat = k / 99.0, along = start + speed * (beat - 0.5);
            place(along - floor(along), angle + twist * beat, radius,
                  s.line_points + 3 * (100 * i + k));
            s.times[100 * i + k] = (float)(800 * beat);
        }
    }
    return s;
}
static void scene_free(scene *s) {
    free(s->positions);
    free(s->line_points);
    free(s->times);
    free(s->offsets);
}

/* Seconds of a table; the table itself. */
static double measure(const scene *s, uint32_t vertices, uint32_t steps, uint32_t flags,
                      vsf_near *n) {
    vsf_near_desc desc;
    double start = now();
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = vertices;
    desc.positions = s->positions;
    desc.line_count = s->lines;
    desc.point_count = s->points;
    desc.offsets = s->offsets;
    desc.points = s->line_points;
    desc.times = s->times;
    desc.step_count = steps;
    desc.flags = flags;
    if (vsf_near_make(NULL, &desc, n) != LAO_OK) {
        fprintf(stderr, "bench_surface_near: vsf_near_make failed\n");
        exit(1);
    }
    return now() - start;
}

/* One time in the middle of the beat: seconds for all vertices, with an index that exists. */
static double measure_time(const vsf_near *n, float *distances) {
    double best = 1e30;
    for (int i = 0; i < 3; i++) {
        double start = now(), took;
        if (vsf_near_exact(NULL, n, 400, distances) != LAO_OK)
            exit(1);
        took = now() - start;
        best = took < best ? took : best;
    }
    return best;
}

static void growth(const char *name, uint32_t vertices, uint32_t points, uint32_t steps) {
    printf(",\n \"growth_with_%s\": [", name);
    for (int i = 0; i < 4; i++) {
        uint32_t v = *name == 'v' ? vertices >> (3 - i) : vertices;
        uint32_t p = *name == 'p' ? points >> (3 - i) : points;
        uint32_t k = *name == 's' ? steps << i : steps;
        scene s = scene_make(v, p);
        vsf_near n;
        double took = measure(&s, v, k, 0, &n);
        printf("%s{\"vertices\": %u, \"points\": %u, \"steps\": %u, \"seconds\": %.4f}",
               i ? ", " : "", v, s.points, k, took);
        vsf_near_free(&n);
        scene_free(&s);
    }
    printf("]");
}

static void export_array(const char *folder, const char *name, const void *data, size_t bytes) {
    char path[1024];
    FILE *file;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    file = fopen(path, "wb");
    if (!file || fwrite(data, 1, bytes, file) != bytes || fclose(file)) {
        fprintf(stderr, "bench_surface_near: cannot write %s\n", path);
        exit(1);
    }
}

int main(int argc, char **argv) {
    uint32_t vertices = 50000, points = 1000000, steps = 4, sample = 20;
    const char *folder = NULL;
    double least = 0, fast, slow, points_only, table, ratio;
    uint32_t different = 0;
    vsf_near n, brute, dots;
    float *a, *b, *picked;
    scene s;
    for (int i = 1; i + 1 < argc; i += 2) {
        uint32_t value = (uint32_t)strtoul(argv[i + 1], NULL, 10);
        if (!strcmp(argv[i], "--vertices"))
            vertices = value;
        else if (!strcmp(argv[i], "--points"))
            points = value;
        else if (!strcmp(argv[i], "--steps"))
            steps = value;
        else if (!strcmp(argv[i], "--sample"))
            sample = value;
        else if (!strcmp(argv[i], "--least"))
            least = strtod(argv[i + 1], NULL);
        else if (!strcmp(argv[i], "--export"))
            folder = argv[i + 1];
        else
            return 2;
    }
    s = scene_make(vertices, points);
    a = (float *)room(sizeof(float) * vertices);
    b = (float *)room(sizeof(float) * vertices);
    table = measure(&s, vertices, steps, 0, &n);
    fast = measure_time(&n, a);
    measure(&s, vertices, 1, VSF_NEAR_POINTS, &dots);
    points_only = measure_time(&dots, b);
    vsf_near_free(&dots);
    if (folder) {
        export_array(folder, "vertices.f32", s.positions, sizeof(float) * 3 * vertices);
        export_array(folder, "points.f32", s.line_points, sizeof(float) * 3 * s.points);
        export_array(folder, "times.f32", s.times, sizeof(float) * s.points);
        export_array(folder, "distances.f32", b, sizeof(float) * vertices);
    }
    picked = (float *)room(sizeof(float) * 3 * (vertices / sample + 1));
    for (uint32_t i = 0; i * sample < vertices; i++)
        memcpy(picked + 3 * i, s.positions + 3 * i * sample, 3 * sizeof(float));
    {
        scene few = s;
        few.positions = picked;
        few.vertices = (vertices + sample - 1) / sample;
        measure(&few, few.vertices, 1, VSF_NEAR_BRUTE, &brute);
        slow = now();
        if (vsf_near_exact(NULL, &brute, 400, b) != LAO_OK)
            return 1;
        slow = (now() - slow) * sample;
        for (uint32_t i = 0; i < few.vertices; i++)
            different += b[i] != a[i * sample];
        vsf_near_free(&brute);
    }
    ratio = slow / fast;
    printf("{\"vertices\": %u, \"points\": %u, \"lit_pieces\": %.0f, \"reach_ms\": %.9g, "
           "\"gamma_mm\": %.4f,\n"
           " \"step_ms\": %.2f, \"step_points_ms\": %.2f, \"brute_ms\": %.0f, \"ratio\": %.1f, "
           "\"different\": %u,\n \"table_steps\": %u, \"table_seconds\": %.3f, "
           "\"bytes_per_vertex_and_step\": %u",
           vertices, s.points, (double)n.lit / steps, n.reach, (double)n.gamma, 1000 * fast,
           1000 * points_only, 1000 * slow, ratio, different, steps, table, n.bytes);
    vsf_near_free(&n);
    scene_free(&s);
    free(a);
    free(b);
    free(picked);
    growth("vertices", vertices, points, steps);
    growth("points", vertices, points, steps);
    growth("steps", vertices, points, 2);
    printf("}\n");
    if (least > 0 && (ratio < least || different)) {
        fprintf(stderr,
                "bench_surface_near: %.1f times as fast as brute force, not %g; %u differ\n", ratio,
                least, different);
        return 1;
    }
    return 0;
}
