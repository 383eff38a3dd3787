#include "flow.h"

#include "flow4d.h"
#include "report.h"
#include "threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- Reading ---------------------------------------------------------------------------- */

uint32_t cli_count_volumes(const cli_source *sources, uint32_t count, uint32_t first) {
    uint32_t found = 0;
    while (first + found < count && sources[first + found].path &&
           io_is_volume(sources[first + found].path))
        found++;
    return found;
}

static bool on_progress(void *user, uint64_t done, uint64_t total) {
    cli_progress_show(user, done, total);
    return cli_interrupted();
}

/* A file that exists, or has the name of one; else the name of an array. */
static bool is_file_name(const char *text) {
    struct stat status;
    return stat(text, &status) == 0 || strchr(text, '.');
}

bool cli_read_volume(const cli_options *options, const cli_source *sources, uint32_t count,
                     bool guess, io_volume *out) {
    const cli_flow_options *flow = &options->flow;
    const char **paths = cli_new(count, sizeof *paths);
    cli_progress progress = {"reading", sources[0].path, -1};
    io_volume_options o;
    io_error error;
    uint32_t failed = 0;
    if (!paths)
        return false;
    for (uint32_t i = 0; i < count; i++)
        paths[i] = sources[i].path;
    memset(&o, 0, sizeof o);
    o.names = flow->names;
    if (flow->mask && is_file_name(flow->mask))
        o.mask_file = flow->mask;
    else
        o.mask = flow->mask;
    o.unit = flow->unit;
    memcpy(o.spacing, flow->spacing, sizeof o.spacing);
    o.time_step = flow->time_step;
    o.period = flow->period > 0 ? flow->period : (double)sources[count - 1].settings.period;
    o.along_grid = flow->axes && strcmp(flow->axes, "grid") == 0;
    o.guess = guess;
    o.progress = on_progress;
    o.user = &progress;
    bool ok = io_read_volume(paths, count, &o, out, &failed, &error);
    cli_progress_end(&progress);
    if (!ok && cli_interrupted())
        cli_go_on();
    else if (!ok)
        cli_fail("%s: %s", failed < count ? paths[failed] : flow->mask, error.text);
    free(paths);
    return ok;
}

/* ---- Tracing ---------------------------------------------------------------------------- */

static void on_log(void *user, flow4d_log_item item, lao_result result, const char *text) {
    (void)result;
    if (item != FLOW4D_LOG_CANCELLED)
        cli_fail("%s: %s", (const char *)user, text);
}

flow4d_field cli_field_of(const io_volume *volume) {
    flow4d_field field;
    memset(&field, 0, sizeof field);
    memcpy(field.size, volume->size, sizeof field.size);
    field.frame_count = volume->frame_count;
    field.period = volume->period;
    field.velocity = volume->velocity;
    field.mask = volume->mask;
    memcpy(field.to_world, volume->to_mm, sizeof field.to_world);
    return field;
}

/* Inside is also where the blood is fast at some time. */
static bool apply_threshold(const flow4d_host *host, const cli_flow_options *flow, const char *name,
                            io_volume *volume) {
    double threshold = flow->threshold >= 0 ? flow->threshold
                       : volume->mask       ? 0
                                            : 0.1 * volume->speed[1];
    if (!(threshold > 0))
        return true;
    size_t voxels = (size_t)volume->size[0] * volume->size[1] * volume->size[2];
    flow4d_field field = cli_field_of(volume);
    float *fastest = cli_new(voxels, sizeof *fastest);
    bool given = volume->mask != NULL;
    if (!given)
        volume->mask = fastest ? cli_new(voxels, 1) : NULL;
    bool ok = fastest && volume->mask && flow4d_temporal_maximum(host, &field, fastest) == LAO_OK;
    volume->mask_voxels = 0;
    for (size_t i = 0; ok && i < voxels; i++) {
        volume->mask[i] = (!given || volume->mask[i]) && (double)fastest[i] >= threshold;
        volume->mask_voxels += volume->mask[i];
    }
    free(fastest);
    return ok && (volume->mask_voxels ||
                  cli_fail("%s: no voxel inside is as fast as %g m/s; the highest speed is %g; "
                           "lower --threshold",
                           name, threshold, volume->speed[1]));
}

/* One line per 4 mm^3 inside lies as dense as it can be told apart at the usual width; for the
 * whole aorta that is the 30,000 of Koehler 2017. */
static uint32_t usual_seeds(const io_volume *volume) {
    const double(*m)[4] = volume->to_mm;
    double voxel = fabs(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                        m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                        m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
    return (uint32_t)fmax(1000, fmin(30000, voxel * (double)volume->mask_voxels / 4));
}

static flow4d_trace_settings settings_of(const cli_options *options, const io_volume *volume) {
    const cli_flow_options *flow = &options->flow;
    const char *more = flow->attributes ? flow->attributes : "";
    flow4d_trace_settings s;
    memset(&s, 0, sizeof s);
    s.line_count = flow->seeds ? flow->seeds : usual_seeds(volume);
    s.seed = flow->seed;
    s.max_points = flow->max_points;
    s.step = flow->step;
    s.tolerance = flow->tolerance;
    s.method = flow->method && strcmp(flow->method, "dopri") == 0 ? FLOW4D_DOPRI : FLOW4D_RK4;
    if (!flow->span && (!isnan(options->time) || options->frames))
        s.span = FLOW4D_SPAN_LOOP; /* each line has a seam of its own, where its trail fades */
    if (flow->span)
        s.span = strcmp(flow->span, "loop") == 0   ? FLOW4D_SPAN_LOOP
                 : strcmp(flow->span, "free") == 0 ? FLOW4D_SPAN_FREE
                                                   : FLOW4D_SPAN_CYCLE;
    s.streamlines = flow->streamlines;
    s.time = flow->at;
    s.attributes = (strcmp(more, "curvature") != 0 && *more ? FLOW4D_VORTICITY : 0u) |
                   (strcmp(more, "vorticity") != 0 && *more ? FLOW4D_CURVATURE : 0u);
    return s;
}

/* ---- Handing over ----------------------------------------------------------------------- */

static void keep_points(float *data, uint32_t width, uint32_t from, uint32_t to, uint32_t count) {
    if (data && from != to)
        memmove(data + (size_t)to * width, data + (size_t)from * width,
                (size_t)count * width * sizeof *data);
}

static double length_of(const float *points, uint32_t count) {
    double length = 0;
    for (uint32_t i = 1; i < count; i++) {
        const float *a = points + 3 * (size_t)(i - 1), *b = points + 3 * (size_t)i;
        double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1];
        double z = (double)b[2] - (double)a[2];
        length += sqrt(x * x + y * y + z * z);
    }
    return length;
}

/* Where nothing is asked for, two voxels: stubs along the wall hide what flows behind them. */
static double least_length(const cli_source *source, const io_volume *volume) {
    double shortest = INFINITY;
    if (source->min_length >= 0)
        return source->min_length;
    for (int k = 0; k < 3; k++) {
        double x = volume->to_mm[0][k], y = volume->to_mm[1][k], z = volume->to_mm[2][k];
        shortest = fmin(shortest, sqrt(x * x + y * y + z * z));
    }
    return 2 * shortest;
}

/* As a line file is thinned; lines of a single point show nothing. */
static void thin(flow4d_lines *lines, double least, uint32_t every) {
    uint32_t kept = 0, at = 0, begin = 0, seen = 0;
    for (uint32_t i = 0; i < lines->line_count; i++) {
        uint32_t end = lines->offsets[i + 1], count = end - begin;
        if (count >= 2 && length_of(lines->points + 3 * (size_t)begin, count) >= least &&
            seen++ % (every ? every : 1) == 0) {
            keep_points(lines->points, 3, begin, at, count);
            keep_points(lines->times, 1, begin, at, count);
            keep_points(lines->speeds, 1, begin, at, count);
            keep_points(lines->vorticity, 1, begin, at, count);
            keep_points(lines->curvature, 1, begin, at, count);
            at += count;
            lines->offsets[++kept] = at;
        }
        begin = end;
    }
    lines->line_count = kept;
    lines->point_count = at;
}

static void find_bounds(io_lines *lines) {
    for (uint32_t i = 0; i < lines->point_count; i++)
        for (int k = 0; k < 3; k++) {
            double x = (double)lines->points[3 * (size_t)i + (size_t)k];
            if (i == 0 || x < lines->bounds[0][k])
                lines->bounds[0][k] = x;
            if (i == 0 || x > lines->bounds[1][k])
                lines->bounds[1][k] = x;
        }
}

/* Copies: the memory of flow4d is its own. */
static void *copy(const void *data, size_t count, size_t size) {
    void *made = cli_new(count, size);
    return made && count ? memcpy(made, data, count * size) : made;
}

static bool add_attribute(io_lines *lines, const char *name, const float *data) {
    io_attribute *a = &lines->point_attributes[lines->point_attribute_count];
    if (!data)
        return true;
    lines->point_attribute_count++; /* io_lines_free knows it from here on */
    a->components = 1;
    a->name = copy(name, strlen(name) + 1, 1);
    a->data = copy(data, lines->point_count, sizeof *data);
    return a->name && a->data;
}

static bool convert(const flow4d_lines *traced, io_volume *volume, io_lines *lines) {
    memset(lines, 0, sizeof *lines);
    lines->format = volume->format;
    lines->unit = "mm";
    lines->line_count = traced->line_count;
    lines->point_count = traced->point_count;
    lines->offsets = copy(traced->offsets, (size_t)traced->line_count + 1, sizeof(uint32_t));
    lines->points = copy(traced->points, traced->point_count, 3 * sizeof(float));
    lines->point_attributes = calloc(4, sizeof *lines->point_attributes);
    if (!lines->offsets || !lines->points)
        return false;
    if (!lines->point_attributes)
        return cli_fail("out of memory");
    if (!add_attribute(lines, "time", traced->times) ||
        !add_attribute(lines, "speed", traced->speeds) ||
        !add_attribute(lines, "vorticity", traced->vorticity) ||
        !add_attribute(lines, "curvature", traced->curvature))
        return false;
    find_bounds(lines);
    lines->warnings = volume->warnings; /* moved */
    lines->warning_count = volume->warning_count;
    volume->warnings = NULL;
    volume->warning_count = 0;
    return true;
}

static bool trace(const cli_options *options, const cli_source *source, const flow4d_host *host,
                  const char *name, io_volume *volume, io_lines *out) {
    flow4d_lines traced;
    if (source->bundle)
        return cli_fail("%s: has no bundles; leave --bundle out", name);
    if (!apply_threshold(host, &options->flow, name, volume))
        return false;
    if (!volume->mask_voxels)
        return cli_fail("%s: its mask is empty: there is no place for seeds; --mask names another",
                        name);
    flow4d_field field = cli_field_of(volume);
    flow4d_trace_settings settings = settings_of(options, volume);
    if (flow4d_trace(host, &field, &settings, &traced) != LAO_OK)
        return false;
    thin(&traced, least_length(source, volume), source->every);
    bool ok = convert(&traced, volume, out);
    if (!ok)
        io_lines_free(out);
    flow4d_lines_free(&traced);
    return ok;
}

bool cli_trace(const cli_options *options, const cli_source *source, const char *name,
               io_volume *volume, io_lines *out) {
    cli_progress progress = {"tracing", name, -1};
    cli_threads *threads = cli_threads_start();
    flow4d_host host;
    if (!threads)
        return false;
    memset(&host, 0, sizeof host);
    host.job = cli_threads_job(threads, &progress);
    host.log = on_log;
    host.user = (void *)(uintptr_t)name; /* only read */
    bool ok = trace(options, source, &host, name, volume, out);
    cli_progress_end(&progress);
    cli_threads_stop(threads);
    if (!ok && cli_interrupted())
        cli_go_on();
    return ok;
}
