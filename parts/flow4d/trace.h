/* ================================================================================================
 * trace: pathlines and streamlines from seeds. Uses host and field. */

/* ---- integrators */

typedef struct flow4d__tracer {
    flow4d_sampler sampler;
    flow4d_method method;
    flow4d_mask_mode mask;
    double tolerance;
    int frozen; /* streamlines: always at frozen_time */
    double frozen_time;
} flow4d__tracer;

static int flow4d__velocity(const flow4d__tracer *t, const double position[3], double time,
                            double velocity[3]) {
    return flow4d__probe(&t->sampler, t->mask, position, t->frozen ? t->frozen_time : time,
                         velocity);
}

/* Moves x by h, where v is the velocity at (x, time) and becomes that at the new place; 0, or -1
   when a stage or the new place is outside: x and v are then as before. */
static int flow4d__rk4(const flow4d__tracer *t, double time, double h, double x[3], double v[3]) {
    static const double part[3] = {0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    double k[4][3], y[3], end[3];
    int s, i;
    memcpy(k[0], v, sizeof k[0]);
    for (s = 0; s < 3; s++) {
        for (i = 0; i < 3; i++) {
            y[i] = x[i] + h * part[s] * k[s][i];
        }
        if (flow4d__velocity(t, y, time + h * part[s], k[s + 1]) != 0) {
            return -1;
        }
    }
    for (i = 0; i < 3; i++) {
        double sum = 0.0;
        for (s = 0; s < 4; s++) {
            sum += weight[s] * k[s][i];
        }
        y[i] = x[i] + h / 6.0 * sum;
    }
    if (flow4d__velocity(t, y, time + h, end) != 0) {
        return -1;
    }
    memcpy(x, y, sizeof y);
    memcpy(v, end, sizeof end);
    return 0;
}

/* Dormand and Prince 1980: one part of a step. *error is the distance (mm) of the 4th from the 5th
   order result. */
static int flow4d__dopri_part(const flow4d__tracer *t, double time, double h, double x[3],
                              double v[3], double *error) {
    static const double at[7] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
    static const double a[7][6] = {
        {0, 0, 0, 0, 0, 0},
        {1.0 / 5, 0, 0, 0, 0, 0},
        {3.0 / 40, 9.0 / 40, 0, 0, 0, 0},
        {44.0 / 45, -56.0 / 15, 32.0 / 9, 0, 0, 0},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729, 0, 0},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656, 0},
        {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    static const double e[7] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
    double k[7][3], y[3] = {0.0, 0.0, 0.0}, d[3];
    int s, r, i;
    memcpy(k[0], v, sizeof k[0]);
    for (s = 1; s < 7; s++) {
        for (i = 0; i < 3; i++) {
            double sum = 0.0;
            for (r = 0; r < s; r++) {
                sum += a[s][r] * k[r][i];
            }
            y[i] = x[i] + h * sum;
        }
        if (flow4d__velocity(t, y, time + h * at[s], k[s]) != 0) {
            return -1;
        }
    }
    for (i = 0; i < 3; i++) {
        d[i] = 0.0;
        for (s = 0; s < 7; s++) {
            d[i] += h * e[s] * k[s][i];
        }
    }
    *error = flow4d__length(d);
    memcpy(x, y, sizeof y);       /* the last stage is the new place */
    memcpy(v, k[6], sizeof k[6]); /* and its velocity */
    return 0;
}

/* A whole step in parts, none shorter than a 4096th of it: there the result is taken as it is. */
static int flow4d__dopri(const flow4d__tracer *t, double time, double h, double x[3], double v[3]) {
    double done = 0.0, part = 1.0, y[3], w[3], error = 0.0;
    const double least = 1.0 / 4096;
    memcpy(y, x, sizeof y);
    memcpy(w, v, sizeof w);
    while (done < 1.0) {
        double now = part < 1.0 - done ? part : 1.0 - done, p[3], q[3], change;
        memcpy(p, y, sizeof p);
        memcpy(q, w, sizeof q);
        if (flow4d__dopri_part(t, time + h * done, h * now, p, q, &error) != 0) {
            if (now <= least) {
                return -1;
            }
            part =
                now * 0.25 > least ? now * 0.25 : least; /* outside: perhaps only of a long one */
            continue;
        }
        change = error > 0.0 ? 0.9 * pow(t->tolerance / error, 0.2) : 5.0;
        change = change < 0.2 ? 0.2 : change > 5.0 ? 5.0 : change;
        part = now * change > least ? now * change : least;
        if (error <= t->tolerance || now <= least) {
            /* what the last part leaves over by rounding is no further part */
            done = now < 1.0 - done ? done + now : 1.0;
            memcpy(y, p, sizeof y);
            memcpy(w, q, sizeof w);
        }
    }
    memcpy(x, y, sizeof y);
    memcpy(v, w, sizeof w);
    return 0;
}

static int flow4d__advance(const flow4d__tracer *t, double time, double h, double x[3],
                           double v[3]) {
    return t->method == FLOW4D_DOPRI ? flow4d__dopri(t, time, h, x, v)
                                     : flow4d__rk4(t, time, h, x, v);
}

int flow4d_step(const flow4d_sampler *sampler, flow4d_method method, flow4d_mask_mode mask,
                double time, double step, double tolerance, double position[3]) {
    flow4d__tracer t;
    double v[3], end = time + step;
    t.sampler = *sampler;
    t.method = method;
    t.mask = mask;
    t.tolerance = tolerance;
    t.frozen = 0;
    t.frozen_time = 0.0;
    if (!flow4d__number(end) || flow4d__velocity(&t, position, time, v) != 0) {
        return -1;
    }
    return flow4d__advance(&t, time, step, position, v);
}

/* ---- seeds */

/* Where random seeds may lie: how many voxels of the mask lie in all rows before each row. */
typedef struct flow4d__rows {
    uint64_t *before; /* NULL: every voxel */
    size_t count;     /* rows */
    uint64_t voxels;  /* inside */
} flow4d__rows;

static lao_result flow4d__rows_make(const flow4d_host *host, const flow4d_field *field,
                                    flow4d_mask_mode mode, flow4d__rows *rows) {
    size_t r, i;
    rows->before = NULL;
    rows->count = (size_t)field->size[1] * field->size[2];
    rows->voxels = (uint64_t)rows->count * field->size[0];
    if (!field->mask || mode == FLOW4D_MASK_NONE) {
        return LAO_OK;
    }
    rows->before = (uint64_t *)lao__new(&host->allocator, rows->count, sizeof(uint64_t));
    if (!rows->before) {
        return flow4d__fail(host, FLOW4D_LOG_MEMORY, "rows of the mask");
    }
    rows->voxels = 0;
    for (r = 0; r < rows->count; r++) {
        rows->before[r] = rows->voxels;
        for (i = 0; i < field->size[0]; i++) {
            rows->voxels += field->mask[r * field->size[0] + i] != 0;
        }
    }
    return LAO_OK;
}

/* Index of the n-th voxel inside. */
static void flow4d__rows_pick(const flow4d__rows *rows, const flow4d_field *field, uint64_t n,
                              double index[3]) {
    size_t row = (size_t)(n / field->size[0]), x = (size_t)(n % field->size[0]);
    if (rows->before) {
        size_t low = 0, high = rows->count; /* the last row with before[row] <= n */
        while (high - low > 1) {
            size_t middle = low + (high - low) / 2;
            if (rows->before[middle] <= n) {
                low = middle;
            } else {
                high = middle;
            }
        }
        row = low;
        n -= rows->before[row];
        for (x = 0;; x++) {
            if (field->mask[row * field->size[0] + x] && n-- == 0) {
                break;
            }
        }
    }
    index[0] = (double)x;
    index[1] = (double)(row % field->size[1]);
    row /= field->size[1];
    index[2] = (double)row;
}

/* Number `use` of a line, in [0, 1), 53 bits. */
static double flow4d__random(uint32_t seed, uint32_t line, uint32_t use) {
    uint32_t high = lao_hash(lao_hash(lao_hash(seed) + line) + use);
    uint32_t low = lao_hash(high ^ 2654435769u);
    return ((double)(high >> 5) * 67108864.0 + (double)(low >> 6)) / 9007199254740992.0;
}

/* The seed of a line: place and time; 0, or -1 when no place was found (inside_at and the trilinear
   mask can refuse a place in a voxel of the mask). */
static int flow4d__seed(const flow4d__tracer *t, const flow4d__rows *rows,
                        const flow4d_trace_settings *s, uint32_t line, double x[3], double *time) {
    const flow4d_field *field = &t->sampler.field;
    uint32_t attempt, a;
    if (s->seeds) {
        memcpy(x, s->seeds + 4 * (size_t)line, 3 * sizeof(double));
        *time = s->seeds[4 * (size_t)line + 3];
        return flow4d__finite(time, 1) && flow4d_inside(&t->sampler, x, t->mask) ? 0 : -1;
    }
    *time = t->frozen ? 0.0 : flow4d__random(s->seed, line, 0) * field->period;
    for (attempt = 0; attempt < 4096; attempt++) {
        double index[3], u = flow4d__random(s->seed, line, 4 * attempt + 1);
        uint64_t n = (uint64_t)(u * (double)rows->voxels);
        flow4d__rows_pick(rows, field, n < rows->voxels ? n : rows->voxels - 1, index);
        for (a = 0; a < 3; a++) {
            index[a] += flow4d__random(s->seed, line, 4 * attempt + 2 + a) - 0.5;
        }
        flow4d__apply(field->to_world, index, x);
        if (flow4d_inside(&t->sampler, x, t->mask)) {
            return 0;
        }
    }
    return -1;
}

/* ---- lines */

#define FLOW4D__BATCH_POINTS 524288u /* points of the scratch of one batch */
#define FLOW4D__CHUNK 16u            /* lines of one piece of work */

/* Points of one batch of lines, or of its lines packed together. */
typedef struct flow4d__points {
    float *memory; /* all arrays below, one behind the other */
    size_t count;
    float *points, *times, *speeds, *vorticity, *curvature;
} flow4d__points;

typedef struct flow4d__trace {
    flow4d__tracer tracer;
    flow4d_trace_settings settings; /* with defaults filled in */
    flow4d__rows rows;
    uint32_t slot;  /* points of the scratch per line */
    uint32_t lines; /* of a batch */
    uint32_t first; /* line of the batch */
    uint32_t now;   /* lines of this batch */
    flow4d__points scratch;
    uint32_t *begins; /* per line of the batch: its first point in its slot */
    uint32_t *counts; /* per line of the trace */
} flow4d__trace;

static size_t flow4d__floats(uint32_t attributes) {
    return 5u + (attributes & FLOW4D_VORTICITY ? 1u : 0u) +
           (attributes & FLOW4D_CURVATURE ? 1u : 0u);
}

static int flow4d__points_make(const flow4d_host *host, uint32_t attributes, size_t count,
                               flow4d__points *points) {
    size_t floats = flow4d__floats(attributes);
    float *next;
    memset(points, 0, sizeof *points);
    if (count == 0) {
        return 0;
    }
    points->memory = (float *)lao__new(&host->allocator, count, floats * sizeof(float));
    if (!points->memory) {
        return -1;
    }
    points->count = count;
    points->points = points->memory;
    points->times = points->memory + 3 * count;
    points->speeds = points->memory + 4 * count;
    next = points->memory + 5 * count;
    if (attributes & FLOW4D_VORTICITY) {
        points->vorticity = next;
        next += count;
    }
    points->curvature = attributes & FLOW4D_CURVATURE ? next : NULL;
    return 0;
}

static void flow4d__points_free(const flow4d_host *host, uint32_t attributes,
                                flow4d__points *points) {
    lao__delete(&host->allocator, points->memory, points->count,
                flow4d__floats(attributes) * sizeof(float));
    memset(points, 0, sizeof *points);
}

static void flow4d__copy(const flow4d__points *from, size_t at, flow4d__points *to, size_t where,
                         size_t count) {
    memcpy(to->points + 3 * where, from->points + 3 * at, 3 * count * sizeof(float));
    memcpy(to->times + where, from->times + at, count * sizeof(float));
    memcpy(to->speeds + where, from->speeds + at, count * sizeof(float));
    if (from->vorticity) {
        memcpy(to->vorticity + where, from->vorticity + at, count * sizeof(float));
    }
    if (from->curvature) {
        memcpy(to->curvature + where, from->curvature + at, count * sizeof(float));
    }
}

/* Curvature of the circle through three points: four times the area over the product of edges. */
static double flow4d__circle(const double a[3], const double b[3], const double c[3]) {
    double u[3], v[3], w[3], n[3], edges;
    int i;
    for (i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - b[i];
        w[i] = c[i] - a[i];
    }
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    edges = flow4d__length(u) * flow4d__length(v) * flow4d__length(w);
    return edges > 0.0 ? 2.0 * flow4d__length(n) / edges : 0.0;
}

static void flow4d__put(const flow4d__trace *trace, size_t at, const double x[3], double time,
                        const double v[3]) {
    const flow4d__points *s = &trace->scratch;
    s->points[3 * at] = (float)x[0];
    s->points[3 * at + 1] = (float)x[1];
    s->points[3 * at + 2] = (float)x[2];
    s->times[at] = (float)time;
    s->speeds[at] = (float)flow4d__length(v);
    if (s->vorticity) {
        double curl[3], size;
        flow4d_vorticity(&trace->tracer.sampler, x,
                         trace->tracer.frozen ? trace->tracer.frozen_time : time, curl);
        size = flow4d__length(curl);
        s->vorticity[at] = flow4d__number(size) ? (float)size : 0.0f;
    }
}

/* How many steps of a span fit, at most the points of a line. */
static uint32_t flow4d__steps(const flow4d__trace *trace, double span) {
    double n = floor(span / trace->settings.step + 1e-9), most = trace->settings.max_points;
    return !(n > 0.0) ? 0u : n < most ? (uint32_t)n : (uint32_t)most;
}

/* Steps forward ([0]) and backward ([1]) from a seed at this time. */
static void flow4d__reach(const flow4d__trace *trace, double time, uint32_t steps[2]) {
    const flow4d_trace_settings *s = &trace->settings;
    double period = trace->tracer.sampler.field.period, ahead = 1e300, back = 1e300;
    uint32_t room = trace->slot - 1, half = room / 2, i;
    if (!trace->tracer.frozen && period > 0.0 && s->span != FLOW4D_SPAN_FREE) {
        double into = time - floor(time / period) * period;
        back = s->span == FLOW4D_SPAN_LOOP ? 0.5 * period : into;
        ahead = period - back;
    }
    steps[0] = flow4d__steps(trace, s->duration > 0.0 && s->duration < ahead ? s->duration : ahead);
    steps[1] = flow4d__steps(trace, s->duration > 0.0 && s->duration < back ? s->duration : back);
    steps[0] = s->direction == FLOW4D_BACKWARD ? 0 : steps[0];
    steps[1] = s->direction == FLOW4D_FORWARD ? 0 : steps[1];
    i = steps[0] < steps[1]; /* the longer one gives way, forward last */
    if (steps[0] > room || steps[1] > room - steps[0]) {
        uint32_t shorter = steps[1 - i] < half ? steps[1 - i] : half;
        steps[1 - i] = shorter;
        steps[i] = room - shorter < steps[i] ? room - shorter : steps[i];
    }
}

/* Steps from the seed, whose point is at `at`, in one direction; `first` receives the place after
   the first step. Returns the number of points made. */
static uint32_t flow4d__sweep(const flow4d__trace *trace, size_t at, uint32_t steps, int backward,
                              const double seed[3], const double velocity[3], double time,
                              double first[3]) {
    double before[3], x[3], v[3], h = backward ? -trace->settings.step : trace->settings.step;
    float *curvature = trace->scratch.curvature;
    uint32_t k;
    memcpy(before, seed, sizeof before);
    memcpy(x, seed, sizeof x);
    memcpy(v, velocity, sizeof v);
    for (k = 0; k < steps; k++) {
        double here[3], t = time + h * k;
        size_t place = backward ? at - k : at + k;
        memcpy(here, x, sizeof here);
        if (flow4d__length(v) < trace->settings.stop_speed ||
            flow4d__advance(&trace->tracer, t, h, x, v) != 0) {
            break;
        }
        if (curvature && k > 0) {
            curvature[place] = (float)flow4d__circle(before, here, x);
        }
        memcpy(before, here, sizeof before);
        if (k == 0) {
            memcpy(first, x, 3 * sizeof(double));
        }
        flow4d__put(trace, backward ? place - 1 : place + 1, x, time + h * (k + 1), v);
    }
    if (curvature && k > 0) {
        curvature[backward ? at - k : at + k] = 0.0f; /* the end */
    }
    return k;
}

static void flow4d__line(const flow4d__trace *trace, uint32_t local) {
    uint32_t line = trace->first + local, steps[2], ahead, back;
    double x[3], v[3], next[3], last[3], time;
    size_t at;
    trace->counts[line] = 0;
    trace->begins[local] = 0;
    if (flow4d__seed(&trace->tracer, &trace->rows, &trace->settings, line, x, &time) != 0) {
        return;
    }
    if (trace->tracer.frozen) {
        time = 0.0;
    }
    if (flow4d__velocity(&trace->tracer, x, time, v) != 0) {
        return;
    }
    flow4d__reach(trace, time, steps);
    at = (size_t)local * trace->slot + steps[1];
    flow4d__put(trace, at, x, time, v);
    ahead = flow4d__sweep(trace, at, steps[0], 0, x, v, time, next);
    back = flow4d__sweep(trace, at, steps[1], 1, x, v, time, last);
    if (trace->scratch.curvature) {
        trace->scratch.curvature[at] = ahead && back ? (float)flow4d__circle(last, x, next) : 0.0f;
    }
    trace->begins[local] = steps[1] - back;
    trace->counts[line] = back + 1 + ahead;
}

static void flow4d__chunk(void *arg, uint32_t chunk) {
    const flow4d__trace *trace = (const flow4d__trace *)arg;
    uint32_t i = chunk * FLOW4D__CHUNK, end = i + FLOW4D__CHUNK;
    for (; i < end && i < trace->now; i++) {
        flow4d__line(trace, i);
    }
}

/* Fills in what is 0 and refuses what cannot be. */
static lao_result flow4d__settings(const flow4d_host *host, const flow4d_sampler *sampler,
                                   flow4d_trace_settings *s) {
    const struct {
        const char *name;
        double value, least, most;
    } rows[] = {
        {"step", s->step, 0.0, 1e30},
        {"duration", s->duration, 0.0, 1e30},
        {"tolerance", s->tolerance, 0.0, 1e30},
        {"stop_speed", s->stop_speed, -1e30, 1e30},
        {"time", s->time, -1e30, 1e30},
        {"max_points", (double)s->max_points, 0.0, 4194304.0},
        {"method", (double)s->method, 0.0, FLOW4D_DOPRI},
        {"direction", (double)s->direction, 0.0, FLOW4D_BACKWARD},
        {"span", (double)s->span, 0.0, FLOW4D_SPAN_FREE},
        {"mask", (double)s->mask, 0.0, FLOW4D_MASK_NONE},
        {"attributes", (double)s->attributes, 0.0, FLOW4D_VORTICITY + FLOW4D_CURVATURE},
        {"line_count beyond seed_count", s->seeds ? (double)s->line_count : 0.0, 0.0,
         (double)s->seed_count},
        {"line_count", (double)s->line_count, 0.0, 4294967294.0},
        {"seed_count", (double)s->seed_count, 0.0, 4294967294.0},
    };
    size_t i;
    for (i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if (!(rows[i].value >= rows[i].least && rows[i].value <= rows[i].most)) {
            return flow4d__setting_fail(host, rows[i].name, rows[i].value);
        }
    }
    s->line_count = s->line_count ? s->line_count : s->seeds ? s->seed_count : 30000u;
    s->max_points = s->max_points ? s->max_points : 200u;
    s->tolerance = s->tolerance > 0.0 ? s->tolerance : 1e-4;
    s->stop_speed = s->stop_speed == 0.0 ? 1e-6 : s->stop_speed;
    if (!(s->step > 0.0)) {
        s->step = sampler->field.period / 200.0;
        if (s->streamlines || !(s->step > 0.0)) {
            double fastest = flow4d_max_speed(sampler);
            s->step = 0.5 * flow4d__shortest_edge(sampler->field.to_world) /
                      (fastest > 0.0 ? fastest : 1.0);
        }
    }
    if (!(s->step > 0.0 && s->step <= 1e30)) {
        return flow4d__setting_fail(host, "step", s->step);
    }
    return LAO_OK;
}

/* The most points that a line can have. */
static uint32_t flow4d__slot(const flow4d__trace *trace) {
    const flow4d_trace_settings *s = &trace->settings;
    double period = trace->tracer.sampler.field.period, span = 1e300;
    uint32_t steps;
    if (!trace->tracer.frozen && period > 0.0 && s->span != FLOW4D_SPAN_FREE) {
        span = period;
    }
    if (s->duration > 0.0 && 2.0 * s->duration < span) {
        span = 2.0 * s->duration;
    }
    steps = flow4d__steps(trace, span);
    return steps + 1 < s->max_points ? steps + 1 : s->max_points;
}

/* Integrates one batch and packs its lines. */
static lao_result flow4d__batch(const flow4d_host *host, flow4d__trace *trace,
                                flow4d__points *packed) {
    uint32_t i;
    size_t count = 0, where = 0;
    lao__job_run(&host->job, (trace->now + FLOW4D__CHUNK - 1) / FLOW4D__CHUNK, flow4d__chunk,
                 trace);
    for (i = 0; i < trace->now; i++) {
        count += trace->counts[trace->first + i];
    }
    if (flow4d__points_make(host, trace->settings.attributes, count, packed) != 0) {
        return flow4d__fail(host, FLOW4D_LOG_MEMORY, "points of a batch of lines");
    }
    for (i = 0; i < trace->now; i++) {
        uint32_t points = trace->counts[trace->first + i];
        if (points) {
            flow4d__copy(&trace->scratch, (size_t)i * trace->slot + trace->begins[i], packed, where,
                         points);
        }
        where += points;
    }
    return LAO_OK;
}

static lao_result flow4d__batches(const flow4d_host *host, flow4d__trace *trace,
                                  flow4d__points *batches) {
    lao_result result = LAO_OK;
    uint32_t done, b = 0;
    uint32_t lines = trace->settings.line_count;
    for (done = 0; done < lines && result == LAO_OK; done += trace->now, b++) {
        trace->first = done;
        trace->now = lines - done < trace->lines ? lines - done : trace->lines;
        result = flow4d__batch(host, trace, &batches[b]);
        if (result == LAO_OK &&
            lao__job_cancelled(&host->job, (uint64_t)done + trace->now, lines)) {
            result = flow4d__fail(host, FLOW4D_LOG_CANCELLED, "flow4d_trace");
        }
    }
    return result;
}

/* The arrays of the result, and where batches are copied to. */
static lao_result flow4d__lines_make(const flow4d_host *host, uint32_t attributes,
                                     uint32_t line_count, uint32_t point_count, flow4d_lines *lines,
                                     flow4d__points *view) {
    const lao_allocator *a = &host->allocator;
    size_t n = point_count, size = sizeof(float);
    memset(lines, 0, sizeof *lines);
    memset(view, 0, sizeof *view);
    lines->allocator = *a;
    lines->line_count = lines->line_room = line_count;
    lines->point_count = lines->point_room = point_count;
    lines->offsets = (uint32_t *)lao__new(a, (size_t)line_count + 1, sizeof(uint32_t));
    lines->points = view->points = (float *)lao__new(a, n, 3 * size);
    lines->times = view->times = (float *)lao__new(a, n, size);
    lines->speeds = view->speeds = (float *)lao__new(a, n, size);
    if (attributes & FLOW4D_VORTICITY) {
        lines->vorticity = view->vorticity = (float *)lao__new(a, n, size);
    }
    if (attributes & FLOW4D_CURVATURE) {
        lines->curvature = view->curvature = (float *)lao__new(a, n, size);
    }
    if (!lines->offsets || (n && (!lines->points || !lines->times || !lines->speeds)) ||
        (n && (attributes & FLOW4D_VORTICITY) && !lines->vorticity) ||
        (n && (attributes & FLOW4D_CURVATURE) && !lines->curvature)) {
        flow4d_lines_free(lines);
        return flow4d__fail(host, FLOW4D_LOG_MEMORY, "the lines");
    }
    return LAO_OK;
}

static lao_result flow4d__gather(const flow4d_host *host, const flow4d__trace *trace,
                                 const flow4d__points *batches, size_t batch_count,
                                 flow4d_lines *lines) {
    flow4d__points view;
    uint64_t points = 0;
    size_t b, where = 0;
    uint32_t i;
    lao_result result;
    for (b = 0; b < batch_count; b++) {
        points += batches[b].count;
    }
    if (points == 0 && !trace->settings.seeds) {
        return flow4d__fail(host, FLOW4D_LOG_EMPTY, "no random seed was inside with a velocity");
    }
    if (points > 0xfffffffeu) {
        return flow4d__fail(host, FLOW4D_LOG_COUNT, "points of all lines");
    }
    result = flow4d__lines_make(host, trace->settings.attributes, trace->settings.line_count,
                                (uint32_t)points, lines, &view);
    if (result != LAO_OK) {
        return result;
    }
    for (b = 0; b < batch_count; b++) {
        if (batches[b].count) {
            flow4d__copy(&batches[b], 0, &view, where, batches[b].count);
        }
        where += batches[b].count;
    }
    for (i = 0; i < lines->line_count; i++) {
        lines->offsets[i + 1] = lines->offsets[i] + trace->counts[i];
    }
    lines->step = trace->settings.step;
    return LAO_OK;
}

/* With the seeds' rows there: scratch, batches, result. */
static lao_result flow4d__trace_lines(const flow4d_host *host, flow4d__trace *trace,
                                      flow4d_lines *lines) {
    const lao_allocator *a = &host->allocator;
    uint32_t line_count = trace->settings.line_count, attributes = trace->settings.attributes;
    size_t batch_count, b;
    flow4d__points *batches;
    lao_result result;
    trace->slot = flow4d__slot(trace);
    trace->lines = FLOW4D__BATCH_POINTS / trace->slot;
    trace->lines = trace->lines < 1 ? 1 : trace->lines < line_count ? trace->lines : line_count;
    batch_count = (size_t)line_count / trace->lines + (line_count % trace->lines != 0);
    batches = (flow4d__points *)lao__new(a, batch_count, sizeof *batches);
    trace->begins = (uint32_t *)lao__new(a, trace->lines, sizeof(uint32_t));
    trace->counts = (uint32_t *)lao__new(a, line_count, sizeof(uint32_t));
    if (!batches || !trace->begins || !trace->counts ||
        flow4d__points_make(host, attributes, (size_t)trace->lines * trace->slot,
                            &trace->scratch) != 0) {
        result = flow4d__fail(host, FLOW4D_LOG_MEMORY, "scratch of the lines");
    } else {
        result = flow4d__batches(host, trace, batches);
    }
    flow4d__points_free(host, attributes, &trace->scratch);
    if (result == LAO_OK) {
        result = flow4d__gather(host, trace, batches, batch_count, lines);
    }
    for (b = 0; batches && b < batch_count; b++) {
        flow4d__points_free(host, attributes, &batches[b]);
    }
    lao__delete(a, batches, batch_count, sizeof *batches);
    lao__delete(a, trace->begins, trace->lines, sizeof(uint32_t));
    lao__delete(a, trace->counts, line_count, sizeof(uint32_t));
    return result;
}

lao_result flow4d_trace(const flow4d_host *host, const flow4d_field *field,
                        const flow4d_trace_settings *settings, flow4d_lines *lines) {
    flow4d_host h = flow4d__host(host);
    flow4d__trace trace;
    flow4d_lines made;
    lao_result result;
    memset(&trace, 0, sizeof trace);
    if (!lines) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "lines of flow4d_trace");
    }
    if (settings) {
        trace.settings = *settings;
    }
    result = flow4d_sampler_make(&h, field, &trace.tracer.sampler);
    if (result == LAO_OK) {
        result = flow4d__settings(&h, &trace.tracer.sampler, &trace.settings);
    }
    if (result != LAO_OK) {
        return result;
    }
    trace.tracer.method = trace.settings.method;
    trace.tracer.mask = trace.settings.mask;
    trace.tracer.tolerance = trace.settings.tolerance;
    trace.tracer.frozen = trace.settings.streamlines != 0 || !(field->period > 0.0);
    trace.tracer.frozen_time = trace.settings.time;
    if (trace.settings.seeds && trace.settings.line_count == 0) { /* no lines: a result like any */
        flow4d__points unused;
        result = flow4d__lines_make(&h, trace.settings.attributes, 0, 0, &made, &unused);
        made.step = trace.settings.step;
    } else {
        result = flow4d__rows_make(&h, field, trace.settings.mask, &trace.rows);
        if (result == LAO_OK && trace.rows.voxels == 0 && !trace.settings.seeds) {
            result = flow4d__fail(&h, FLOW4D_LOG_EMPTY, "the mask has no voxel inside");
        }
        if (result == LAO_OK) {
            result = flow4d__trace_lines(&h, &trace, &made);
        }
        lao__delete(&h.allocator, trace.rows.before, trace.rows.count, sizeof(uint64_t));
    }
    if (result == LAO_OK) {
        *lines = made;
    }
    return result;
}

void flow4d_lines_free(flow4d_lines *lines) {
    size_t n;
    if (!lines || !lines->allocator.release) {
        return;
    }
    n = lines->point_room;
    lao__delete(&lines->allocator, lines->offsets, (size_t)lines->line_room + 1, sizeof(uint32_t));
    lao__delete(&lines->allocator, lines->points, n, 3 * sizeof(float));
    lao__delete(&lines->allocator, lines->times, n, sizeof(float));
    lao__delete(&lines->allocator, lines->speeds, n, sizeof(float));
    lao__delete(&lines->allocator, lines->vorticity, n, sizeof(float));
    lao__delete(&lines->allocator, lines->curvature, n, sizeof(float));
    memset(lines, 0, sizeof *lines);
}

lao_lines_desc flow4d_lines_describe(const flow4d_lines *lines) {
    lao_lines_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.line_count = lines->line_count;
    desc.point_count = lines->point_count;
    desc.offsets = lines->offsets;
    desc.points = lines->points;
    desc.times = lines->times;
    return desc;
}
