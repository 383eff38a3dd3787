/* The builder: from points, lines and views to io_lines. Filters act here, once for all formats. */
#include "io_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Adding ---------------------------------------------------------------------------------- */

static size_t line_begin(const io_reader *r, size_t line) {
    return line ? r->line_ends[line - 1] : 0;
}

bool io_is_position(const double p[3]) {
    const double huge = 1e30; /* squares of it still fit a double, and it fits a float */
    return fabs(p[0]) < huge && fabs(p[1]) < huge && fabs(p[2]) < huge;
}

bool io_add_point(io_reader *r, const double p[3], size_t row) {
    if (!io_is_position(p)) {
        r->dropped_points++;
        return true;
    }
    if (r->point_count == r->point_capacity) {
        size_t capacity = r->point_capacity;
        double *points = io_grow(r, r->points, &capacity, r->point_count + 1, 3 * sizeof *points);
        if (!points)
            return false;
        r->points = points;
        capacity = r->point_capacity;
        uint32_t *rows = io_grow(r, r->point_rows, &capacity, r->point_count + 1, sizeof *rows);
        if (!rows)
            return false;
        r->point_rows = rows;
        r->point_capacity = capacity;
    }
    if (row > UINT32_MAX || r->point_count == UINT32_MAX)
        return io_fail(r, "has more than 4294967295 points, which is the most that is supported");
    memcpy(r->points + 3 * r->point_count, p, 3 * sizeof *p);
    r->point_rows[r->point_count++] = (uint32_t)row;
    return true;
}

bool io_end_line(io_reader *r, size_t row, size_t done, size_t total) {
    row += r->line_row_base;
    if (r->point_count == line_begin(r, r->line_count)) {
        r->empty_lines++;
        return true;
    }
    if (r->line_count == r->line_capacity) {
        size_t capacity = r->line_capacity;
        uint32_t *ends = io_grow(r, r->line_ends, &capacity, r->line_count + 1, sizeof *ends);
        if (!ends)
            return false;
        r->line_ends = ends;
        capacity = r->line_capacity;
        uint32_t *rows = io_grow(r, r->line_rows, &capacity, r->line_count + 1, sizeof *rows);
        if (!rows)
            return false;
        r->line_rows = rows;
        r->line_capacity = capacity;
    }
    if (row > UINT32_MAX)
        return io_fail(r, "has more than 4294967295 lines, which is the most that is supported");
    r->line_ends[r->line_count] = (uint32_t)r->point_count;
    r->line_rows[r->line_count++] = (uint32_t)row;
    return r->line_count % 4096 || io_tick(r, done, total);
}

bool io_next_cell(io_reader *r, const io_cells *cells, size_t number, const char *what, size_t *at,
                  size_t *begin, size_t *end) {
    *begin = *at;
    if (cells->counted) {
        size_t length;
        if (*at >= cells->index.count || !io_view_index(&cells->index, *at, &length) ||
            length > cells->index.count - *at - 1)
            return io_fail(r,
                           "%s %zu of %zu reaches beyond the %zu numbers of its list; the file is "
                           "damaged",
                           what, number + 1, cells->count, cells->index.count);
        ++*begin;
        *end = *begin + length;
    } else if (!io_view_index(&cells->ends, number, end) || *end < *at ||
               *end > cells->index.count) {
        return io_fail(r, "%s %zu of %zu has a broken end: its offset must be in [%zu, %zu]", what,
                       number + 1, cells->count, *at, cells->index.count);
    }
    *at = *end;
    return true;
}

bool io_add_cells(io_reader *r, const io_view *points, const io_cells *cells, size_t first_row) {
    for (size_t i = 0, at = 0, k, end; i < cells->count; i++) {
        if (!io_next_cell(r, cells, i, "line", &at, &k, &end))
            return false;
        for (; k < end; k++) {
            size_t point;
            if (!io_view_index(&cells->index, k, &point) || point >= points->count)
                return io_fail(r, "line %zu uses a point that is not one of the %zu in the file",
                               i + 1, points->count);
            double p[3];
            for (uint32_t axis = 0; axis < 3; axis++)
                p[axis] = io_view_real(points, point, axis);
            if (!io_add_point(r, p, point))
                return false;
        }
        if (!io_end_line(r, first_row + i, i, cells->count))
            return false;
    }
    return true;
}

/* ---- Attributes ------------------------------------------------------------------------------ */

enum { MOST_COLUMNS = 256 };

static float to_float(double value) {
    return value > FLT_MAX ? INFINITY : value < -FLT_MAX ? -INFINITY : (float)value;
}

/* A column of this name and width that the batch has not filled yet, or a new one. */
static io_column *column_named(io_reader *r, io_columns *columns, const char *name,
                               uint32_t components, size_t batch) {
    for (size_t i = 0; i < columns->count; i++) {
        io_column *column = &columns->items[i];
        if (column->components == components && column->rows <= batch &&
            !strcmp(column->name, name))
            return column;
    }
    io_column *items =
        io_grow(r, columns->items, &columns->capacity, columns->count + 1, sizeof *items);
    if (!items)
        return NULL;
    columns->items = items;
    io_column *column = &items[columns->count++];
    memset(column, 0, sizeof *column);
    column->components = components;
    return column;
}

/* Rows that no batch filled become NaN. */
static bool pad_column(io_reader *r, io_column *column, size_t rows) {
    float *data =
        io_grow(r, column->data, &column->capacity, rows * column->components, sizeof *data);
    if (!data)
        return false;
    column->data = data;
    for (size_t i = column->rows * column->components; i < rows * column->components; i++)
        data[i] = NAN;
    if (column->rows < rows)
        column->rows = rows;
    return true;
}

bool io_attach_rows(io_reader *r, io_columns *columns, io_text name, const io_view *view,
                    const uint32_t *rows, size_t begin, size_t end, size_t base, const char *what) {
    char *label = io_copy_text(r, io_text_trim(name));
    if (!label)
        return false;
    if (view->components == 0 || view->components > IO_MAX_COMPONENTS)
        return io_warn(r, "the %s array '%.64s' has %u values per row; only 1 to %d are read", what,
                       label, (unsigned)view->components, IO_MAX_COMPONENTS);
    if (columns->count >= MOST_COLUMNS)
        return io_warn(r, "the %s array '%.64s' is left out: only %d are read", what, label,
                       MOST_COLUMNS);
    for (size_t i = begin; i < end; i++)
        if ((rows ? rows[i] : i) - base >= view->count)
            return io_warn(r, "the %s array '%.64s' has only %zu rows and is left out", what, label,
                           view->count);
    io_column *column = column_named(r, columns, label, view->components, begin);
    if (!column || !pad_column(r, column, begin))
        return false;
    column->name = label;
    float *data = io_grow(r, column->data, &column->capacity, end * view->components, sizeof *data);
    if (!data)
        return false;
    column->data = data;
    column->rows = end;
    for (size_t i = begin; i < end; i++)
        for (uint32_t k = 0; k < view->components; k++)
            data[i * view->components + k] =
                to_float(io_view_real(view, (rows ? rows[i] : i) - base, k));
    return true;
}

bool io_attach_points(io_reader *r, io_text name, const io_view *view) {
    return io_attach_rows(r, &r->point_columns, name, view, r->point_rows, r->batch_points,
                          r->point_count, 0, "point");
}

bool io_attach_lines(io_reader *r, io_text name, const io_view *view) {
    return io_attach_rows(r, &r->line_columns, name, view, r->line_rows, r->batch_lines,
                          r->line_count, r->line_row_base, "line");
}

void io_next_batch(io_reader *r) {
    r->batch_points = r->point_count;
    r->batch_lines = r->line_count;
    r->line_row_base = r->line_count ? r->line_rows[r->line_count - 1] + (size_t)1 : 0;
}

io_bundle *io_add_bundle(io_reader *r, io_text name) {
    io_bundle *bundles =
        io_grow(r, r->bundles, &r->bundle_capacity, r->bundle_count + 1, sizeof *bundles);
    char *label = io_copy_text(r, name);
    if (bundles)
        r->bundles = bundles;
    if (!bundles || !label)
        return NULL;
    io_bundle *bundle = &bundles[r->bundle_count++];
    memset(bundle, 0, sizeof *bundle);
    bundle->name = label;
    return bundle;
}

bool io_bundle_add(io_reader *r, io_bundle *bundle, uint32_t row) {
    uint32_t *lines =
        io_grow(r, bundle->lines, &bundle->capacity, bundle->count + 1, sizeof *lines);
    if (!lines)
        return false;
    bundle->lines = lines;
    lines[bundle->count++] = row;
    return true;
}

/* ---- Filters --------------------------------------------------------------------------------- */

static bool unknown_bundle(io_reader *r) {
    char names[256] = "";
    size_t used = 0;
    for (size_t i = 0; i < r->bundle_count && used < sizeof names; i++) {
        int more =
            snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", r->bundles[i].name);
        used += (size_t)more;
    }
    if (!r->bundle_count)
        return io_fail(r, "has no bundles; leave the bundle '%.64s' out", r->options->bundle);
    return io_fail(r, "has no bundle '%.64s'; its %zu bundles are: %s%s", r->options->bundle,
                   r->bundle_count, names, used >= sizeof names ? "..." : "");
}

/* Number of the line with this row; the rows of the lines ascend. SIZE_MAX when the line had no
 * points. */
static size_t line_of_row(const io_reader *r, uint32_t row) {
    size_t low = 0, high = r->line_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (r->line_rows[middle] < row)
            low = middle + 1;
        else
            high = middle;
    }
    return low < r->line_count && r->line_rows[low] == row ? low : SIZE_MAX;
}

static bool keep_bundle(io_reader *r, uint8_t *keep) {
    const char *name = r->options->bundle;
    if (!name || !*name)
        return true;
    bool found = false;
    memset(keep, 0, r->line_count);
    for (size_t i = 0; i < r->bundle_count; i++) {
        if (strcmp(r->bundles[i].name, name) != 0)
            continue;
        found = true;
        for (size_t k = 0; k < r->bundles[i].count; k++) {
            size_t line = line_of_row(r, r->bundles[i].lines[k]);
            if (line != SIZE_MAX)
                keep[line] = 1;
        }
    }
    return found || unknown_bundle(r);
}

static double line_length(const io_reader *r, size_t line) {
    double length = 0;
    for (size_t i = line_begin(r, line) + 1; i < r->line_ends[line]; i++) {
        const double *a = r->points + 3 * (i - 1), *b = a + 3;
        double x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
        length += sqrt(x * x + y * y + z * z);
    }
    return length;
}

/* Marks the lines to keep in `place`: their new number, or UINT32_MAX. */
static bool filter(io_reader *r, uint32_t *place, size_t *lines, size_t *points) {
    const io_options *options = r->options;
    uint8_t *keep = io_alloc(r, r->line_count, 1);
    if (!keep)
        return false;
    memset(keep, 1, r->line_count);
    if (!keep_bundle(r, keep))
        return false;
    size_t every = options->every ? options->every : 1, seen = 0;
    for (size_t i = 0; i < r->line_count; i++) {
        place[i] = UINT32_MAX;
        if (!keep[i] ||
            (options->min_length > 0 && line_length(r, i) < (double)options->min_length))
            continue;
        if (seen++ % every)
            continue;
        place[i] = (uint32_t)(*lines)++;
        *points += r->line_ends[i] - line_begin(r, i);
    }
    return true;
}

/* ---- Handing over ---------------------------------------------------------------------------- */

void *io_take_memory(io_reader *r, size_t count, size_t size) {
    void *memory = calloc(count ? count : 1, size);
    if (!memory)
        io_error_set(r->error, "needs %zu MB of memory, which the system does not give",
                     (count >> 20) * size);
    return memory;
}

char *io_take_text(io_reader *r, const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = io_take_memory(r, size, 1);
    return copy ? memcpy(copy, text, size) : NULL;
}

/* An axis is moved to its middle when that is farther away than the data is wide: then the floats
 * get finer, and coordinates that were floats stay exact, for the moved ones are smaller multiples
 * of the same unit. */
void io_find_origin(const double bounds[2][3], double origin[3]) {
    for (int axis = 0; axis < 3; axis++) {
        double low = bounds[0][axis], high = bounds[1][axis];
        double middle = low + (high - low) / 2;
        origin[axis] = fabs(middle) > high - low ? floor(middle + 0.5) : 0;
    }
}

static void find_bounds(const io_reader *r, const uint32_t *place, io_lines *lines) {
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < r->line_count; i++) {
            if (place[i] == UINT32_MAX)
                continue;
            for (size_t k = line_begin(r, i); k < r->line_ends[i]; k++) {
                double value = r->points[3 * k + (size_t)axis];
                low = value < low ? value : low;
                high = value > high ? value : high;
            }
        }
        lines->bounds[0][axis] = low <= high ? low : 0;
        lines->bounds[1][axis] = low <= high ? high : 0;
    }
}

static bool copy_geometry(io_reader *r, const uint32_t *place, size_t line_count,
                          size_t point_count, io_lines *lines) {
    lines->offsets = io_take_memory(r, line_count + 1, sizeof *lines->offsets);
    lines->points = io_take_memory(r, point_count, 3 * sizeof *lines->points);
    if (!lines->offsets || !lines->points)
        return false;
    for (size_t i = 0; i < r->line_count; i++) {
        if (place[i] == UINT32_MAX)
            continue;
        for (size_t k = line_begin(r, i); k < r->line_ends[i]; k++, lines->point_count++)
            for (size_t axis = 0; axis < 3; axis++)
                lines->points[3 * (size_t)lines->point_count + axis] =
                    (float)(r->points[3 * k + axis] - lines->origin[axis]);
        lines->offsets[++lines->line_count] = lines->point_count;
    }
    return true;
}

static bool copy_columns(io_reader *r, const io_columns *columns, const uint32_t *place,
                         bool of_points, const io_lines *lines, uint32_t *count,
                         io_attribute **out) {
    size_t rows = of_points ? r->point_count : r->line_count;
    if (columns->count && !(*out = io_take_memory(r, columns->count, sizeof **out)))
        return false;
    for (size_t i = 0; i < columns->count; i++) {
        io_column *column = &columns->items[i];
        io_attribute *attribute = &(*out)[(*count)++];
        size_t width = attribute->components = column->components;
        size_t kept = of_points ? lines->point_count : lines->line_count;
        attribute->name = io_take_text(r, column->name);
        attribute->data = io_take_memory(r, kept, width * sizeof *attribute->data);
        if (!attribute->name || !attribute->data || !pad_column(r, column, rows))
            return false;
        float *to = attribute->data;
        for (size_t line = 0; line < r->line_count; line++) {
            if (place[line] == UINT32_MAX)
                continue;
            size_t begin = of_points ? line_begin(r, line) : line;
            size_t end = of_points ? r->line_ends[line] : line + 1;
            memcpy(to, column->data + begin * width, (end - begin) * width * sizeof *to);
            to += (end - begin) * width;
        }
    }
    return true;
}

static bool copy_groups(io_reader *r, const uint32_t *place, io_lines *lines) {
    if (r->bundle_count &&
        !(lines->groups = io_take_memory(r, r->bundle_count, sizeof *lines->groups)))
        return false;
    for (size_t i = 0; i < r->bundle_count; i++) {
        const io_bundle *bundle = &r->bundles[i];
        io_group *group = &lines->groups[lines->group_count];
        group->lines = io_take_memory(r, bundle->count, sizeof *group->lines);
        group->name = group->lines ? io_take_text(r, bundle->name) : NULL;
        lines->group_count++; /* now io_lines_free knows it */
        if (!group->name)
            return false;
        for (size_t k = 0; k < bundle->count; k++) {
            size_t line = line_of_row(r, bundle->lines[k]);
            if (line != SIZE_MAX && place[line] != UINT32_MAX)
                group->lines[group->line_count++] = place[line];
        }
        if (!group->line_count) { /* its lines were filtered away */
            lines->group_count--;
            free(group->lines);
            free(group->name);
        }
    }
    return true;
}

static bool warn_of_content(io_reader *r, const io_lines *lines) {
    double largest = 0;
    for (int axis = 0; axis < 3; axis++)
        largest = fmax(largest, fmax(fabs(lines->bounds[0][axis]), fabs(lines->bounds[1][axis])));
    if (r->dropped_points &&
        !io_warn(r, "%zu points were left out: their coordinates are not finite",
                 r->dropped_points))
        return false;
    if (r->empty_lines &&
        !io_warn(r, "%zu lines were left out: they have no points", r->empty_lines))
        return false;
    if ((largest > 1e6 || (largest > 0 && largest < 1e-6)) &&
        !io_warn(r, "coordinates reach %g mm; the file may declare the wrong byte order", largest))
        return false;
    return true;
}

bool io_take_columns(io_reader *r, const io_columns *columns, size_t rows, uint32_t *count,
                     io_attribute **out) {
    if (columns->count && !(*out = io_take_memory(r, columns->count, sizeof **out)))
        return false;
    for (size_t i = 0; i < columns->count; i++) {
        io_column *column = &columns->items[i];
        io_attribute *attribute = &(*out)[(*count)++];
        size_t width = attribute->components = column->components;
        attribute->name = io_take_text(r, column->name);
        attribute->data = io_take_memory(r, rows, width * sizeof *attribute->data);
        if (!attribute->name || !attribute->data || !pad_column(r, column, rows))
            return false;
        if (rows)
            memcpy(attribute->data, column->data, rows * width * sizeof *attribute->data);
    }
    return true;
}

bool io_take_warnings(io_reader *r, char ***warnings, uint32_t *count) {
    if (r->warning_count && !(*warnings = io_take_memory(r, r->warning_count, sizeof **warnings)))
        return false;
    for (size_t i = 0; i < r->warning_count; i++)
        if (!((*warnings)[(*count)++] = io_take_text(r, r->warnings[i])))
            return false;
    return true;
}

bool io_finish(io_reader *r, const char *format, io_lines *out) {
    io_lines lines;
    memset(&lines, 0, sizeof lines);
    lines.format = format;
    lines.unit = "mm";
    r->step = 2;
    size_t line_count = 0, point_count = 0;
    uint32_t *place = io_alloc(r, r->line_count, sizeof *place);
    if (!place || !io_tick(r, 0, 1) || !filter(r, place, &line_count, &point_count))
        return false;
    find_bounds(r, place, &lines);
    io_find_origin((const double(*)[3])lines.bounds, lines.origin);
    if (copy_geometry(r, place, line_count, point_count, &lines) &&
        copy_columns(r, &r->point_columns, place, true, &lines, &lines.point_attribute_count,
                     &lines.point_attributes) &&
        copy_columns(r, &r->line_columns, place, false, &lines, &lines.line_attribute_count,
                     &lines.line_attributes) &&
        copy_groups(r, place, &lines) && warn_of_content(r, &lines) &&
        io_take_warnings(r, &lines.warnings, &lines.warning_count) && io_tick(r, 1, 1)) {
        *out = lines;
        return true;
    }
    io_lines_free(&lines);
    return false;
}

void io_free_attributes(io_attribute *attributes, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        free(attributes[i].name);
        free(attributes[i].data);
    }
    free(attributes);
}

void io_free_warnings(char **warnings, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        free(warnings[i]);
    free(warnings);
}

void io_lines_free(io_lines *lines) {
    if (!lines)
        return;
    free(lines->offsets);
    free(lines->points);
    io_free_attributes(lines->point_attributes, lines->point_attribute_count);
    io_free_attributes(lines->line_attributes, lines->line_attribute_count);
    for (uint32_t i = 0; i < lines->group_count; i++) {
        free(lines->groups[i].name);
        free(lines->groups[i].lines);
    }
    free(lines->groups);
    io_free_warnings(lines->warnings, lines->warning_count);
    memset(lines, 0, sizeof *lines);
}
