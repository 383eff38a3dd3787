/* TRK (TrackVis): a header of 1000 bytes, then for each line its number of points, rows of x y z
 * and scalars, and properties. Coordinates are voxel mm with the corner of the first voxel at 0;
 * the header leads to RAS mm. */
#include "io_internal.h"

#include <math.h>
#include <string.h>

enum { /* byte offsets in the header */
       DIM = 6,
       VOXEL_SIZE = 12,
       SCALAR_COUNT = 36,
       SCALAR_NAMES = 38,
       PROPERTY_COUNT = 238,
       PROPERTY_NAMES = 240,
       VOX_TO_RAS = 440,
       VOXEL_ORDER = 948,
       IMAGE_AXES = 956,
       LINE_COUNT = 988,
       VERSION = 992,
       HEADER_SIZE = 996,
       HEADER = 1000
};
enum { NAMES = 10, NAME = 20 }; /* names of scalars and properties, and their size */

io_match io_sniff_trk(const io_cursor *bytes) {
    return bytes->size >= 5 && !memcmp(bytes->bytes, "TRACK", 5) ? IO_YES : IO_NO;
}

typedef struct affine { /* rows of x y z 1 */
    double m[3][4];
} affine;

static affine affine_identity(void) {
    affine a = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    return a;
}

/* First b, then a. */
static affine affine_product(const affine *a, const affine *b) {
    affine result;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            result.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] +
                             a->m[i][2] * b->m[2][j] + (j == 3 ? a->m[i][3] : 0);
    return result;
}

static double determinant(const affine *a) {
    const double(*m)[4] = a->m;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static double column_norm(const affine *a, int j) {
    return sqrt(a->m[0][j] * a->m[0][j] + a->m[1][j] * a->m[1][j] + a->m[2][j] * a->m[2][j]);
}

typedef struct orientation { /* where each voxel axis points: RAS axis and sign */
    int axis[3], sign[3];
} orientation;

/* The axis codes of an affine: each column takes the RAS axis that it is most along and that is
 * still free. */
static orientation orientation_of_affine(const affine *a) {
    orientation result = {{0, 1, 2}, {1, 1, 1}};
    bool taken[3] = {false, false, false};
    for (int j = 0; j < 3; j++) {
        int best = -1;
        for (int i = 0; i < 3; i++)
            if (!taken[i] && (best < 0 || fabs(a->m[i][j]) > fabs(a->m[best][j])))
                best = i;
        taken[best] = true;
        result.axis[j] = best;
        result.sign[j] = a->m[best][j] < 0 ? -1 : 1;
    }
    return result;
}

/* From text like "LPS"; false when it does not name each axis once. */
static bool orientation_of_text(io_text text, orientation *result) {
    static const char codes[] = "LRPAIS", small[] = "lrpais";
    int seen = 0;
    if (text.size != 3)
        return false;
    for (int i = 0; i < 3; i++) {
        char c = text.at[i];
        const char *code = c ? strchr(codes, c) : NULL;
        const char *lower = c ? strchr(small, c) : NULL;
        if (!code && !lower)
            return false;
        int index = (int)(code ? code - codes : lower - small);
        result->axis[i] = index / 2;
        result->sign[i] = index % 2 ? 1 : -1;
        seen |= 1 << index / 2;
    }
    return seen == 7;
}

/* Takes voxels in the order of the header to the order of the affine, the way nibabel does (it has
 * written most files where the two differ). */
static affine reorder(const orientation *header, const orientation *target, const double dim[3]) {
    affine result;
    memset(&result, 0, sizeof result);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            if (target->axis[j] != header->axis[i])
                continue;
            bool flip = target->sign[j] != header->sign[i];
            result.m[i][j] = flip ? -1 : 1;
            result.m[i][3] = flip ? dim[i] - 1 : 0;
        }
    return result;
}

static bool read_vox_to_ras(io_reader *r, const uint8_t *head, bool big, affine *matrix) {
    bool finite = true;
    *matrix = affine_identity();
    if (io_u32(head + VERSION, big) < 2 || io_f32(head + VOX_TO_RAS + 60, big) == 0)
        return io_warn(r, "the header has no vox_to_ras matrix; the lines stay in voxel space");
    for (size_t i = 0; i < 12; i++) {
        matrix->m[i / 4][i % 4] = (double)io_f32(head + VOX_TO_RAS + 4 * i, big);
        finite = finite && isfinite(matrix->m[i / 4][i % 4]);
    }
    if (finite && fabs(determinant(matrix)) > 0)
        return true;
    *matrix = affine_identity();
    return io_warn(r, "the header's vox_to_ras matrix is singular; the lines stay in voxel space");
}

static bool read_voxel_size(io_reader *r, const uint8_t *head, bool big, const affine *matrix,
                            double size[3]) {
    bool broken = false;
    for (size_t i = 0; i < 3; i++) {
        size[i] = (double)io_f32(head + VOXEL_SIZE + 4 * i, big);
        if (!(size[i] > 0) || !isfinite(size[i])) {
            size[i] = column_norm(matrix, (int)i);
            broken = true;
        }
    }
    return !broken || io_warn(r, "the header's voxel_size is not positive; vox_to_ras gives it");
}

/* Voxel mm to RAS mm. */
static bool read_affine(io_reader *r, const uint8_t *head, bool big, affine *result) {
    affine matrix, voxel = affine_identity(), order;
    double size[3], dim[3];
    orientation from, to;
    if (!read_vox_to_ras(r, head, big, &matrix) || !read_voxel_size(r, head, big, &matrix, size))
        return false;
    for (size_t i = 0; i < 3; i++) {
        dim[i] = io_u16(head + DIM + 2 * i, big);
        voxel.m[i][i] = 1 / size[i];
        voxel.m[i][3] = r->options->trk_no_half_voxel ? 0 : -0.5;
    }
    io_text text = {(const char *)head + VOXEL_ORDER, 4};
    text = io_text_trim(text);
    to = orientation_of_affine(&matrix);
    if (!text.size)
        text = io_text_of("LPS"); /* TrackVis' default */
    if (!orientation_of_text(text, &from)) {
        from = to;
        if (!io_warn(r, "the header's voxel_order is not three letters of LR, PA, IS; that of "
                        "vox_to_ras is taken"))
            return false;
    }
    order = reorder(&from, &to, dim);
    *result = affine_product(&order, &voxel);
    *result = affine_product(&matrix, result);
    return true;
}

typedef struct layout { /* in 4-byte words */
    size_t scalars, properties;
} layout;

/* Reads each line's head to make sure that all of it is there, then adds the points. The row of a
 * point is the place of its x among the words of the body; that makes the scalars a view with a
 * stride of one word. */
static bool read_body(io_reader *r, io_cursor *c, layout of, const affine *to_ras, bool big) {
    int32_t declared = (int32_t)io_u32(c->bytes + LINE_COUNT, big);
    size_t words = 3 + of.scalars, count = 0;
    for (; c->at < c->size && (declared <= 0 || count < (size_t)declared); count++) {
        size_t begin = c->at;
        const uint8_t *head = io_take(c, 4);
        uint32_t points = head ? io_u32(head, big) : 0;
        if (points > INT32_MAX)
            return io_fail(r,
                           "line %zu at byte %zu claims a negative number of points; %zu lines "
                           "before it are whole, the rest is damaged",
                           count + 1, begin, count);
        uint64_t needed = ((uint64_t)points * words + of.properties) * 4;
        const uint8_t *row = head && needed <= c->size ? io_take(c, (size_t)needed) : NULL;
        if (!row)
            return io_fail(r,
                           "ends inside line %zu, which begins at byte %zu and claims %lu points; "
                           "%zu lines are whole. Copy the file again, or write it anew",
                           count + 1, begin, (unsigned long)points, count);
        size_t at = (begin + 4 - HEADER) / 4;
        for (uint32_t k = 0; k < points; k++, row += 4 * words, at += words) {
            double v[3], p[3];
            for (size_t i = 0; i < 3; i++)
                v[i] = (double)io_f32(row + 4 * i, big);
            for (int i = 0; i < 3; i++)
                p[i] = to_ras->m[i][0] * v[0] + to_ras->m[i][1] * v[1] + to_ras->m[i][2] * v[2] +
                       to_ras->m[i][3];
            if (!io_add_point(r, p, at))
                return false;
        }
        if (!io_end_line(r, count, c->at, c->size))
            return false;
    }
    if (declared > 0 && count < (size_t)declared)
        return io_fail(
            r,
            "ends at byte %zu after %zu whole lines, but its header promises %ld. Copy the "
            "file again, or set n_count to 0 (unknown)",
            c->size, count, (long)declared);
    if (c->at < c->size)
        return io_warn(r, "%zu bytes behind the last line are left out", c->size - c->at);
    return declared >= 0 || io_warn(r, "the header's n_count is negative; all lines are read");
}

/* nibabel stores vectors as name NUL count inside the 20 bytes; others pad names with blanks. */
static io_text decode_name(const uint8_t *field, size_t *components) {
    io_text name = {(const char *)field, NAME};
    const char *end = memchr(field, 0, NAME);
    *components = 1;
    if (end) {
        name.size = (size_t)(end - name.at);
        io_text digits = {end + 1, NAME - name.size - 1};
        size_t value;
        if (io_parse_size(io_text_trim(digits), &value) && value > 0)
            *components = value;
    }
    return io_text_trim(name);
}

typedef bool (*attach)(io_reader *r, io_text name, const io_view *view);

/* Attributes in the order of their names; values without a name go together, as nibabel does. */
static bool read_attributes(io_reader *r, io_view view, const uint8_t *names, size_t total,
                            const char *rest, attach add) {
    size_t used = 0;
    for (size_t i = 0; i <= NAMES && used < total; i++) {
        size_t components = total - used;
        io_text name = i < NAMES ? decode_name(names + i * NAME, &components) : io_text_of(rest);
        if (!name.size)
            continue;
        components = components < total - used ? components : total - used;
        view.components = (uint32_t)components;
        if (!add(r, name, &view))
            return false;
        used += components;
        view.bytes += 4 * components;
    }
    return true;
}

/* Properties lie behind each line; their row is the number of the line, so they are gathered first.
 */
static bool read_properties(io_reader *r, const io_cursor *c, layout of, bool big) {
    size_t lines = 0, at = HEADER;
    if (!of.properties || !r->line_count)
        return true;
    size_t last = r->line_rows[r->line_count - 1];
    double *values = io_alloc(r, last + 1, of.properties * sizeof *values);
    if (!values)
        return false;
    for (; lines <= last; lines++) {
        at += 4 + (size_t)io_u32(c->bytes + at, big) * (3 + of.scalars) * 4;
        for (size_t i = 0; i < of.properties; i++, at += 4)
            values[lines * of.properties + i] = (double)io_f32(c->bytes + at, big);
    }
    io_view view = io_view_doubles(values, lines, (uint32_t)of.properties);
    size_t used = of.properties;
    return read_attributes(r, view, c->bytes + PROPERTY_NAMES, used, "properties", io_attach_lines);
}

bool io_read_trk(io_reader *r, io_cursor *c) {
    const uint8_t *head = io_take(c, HEADER);
    if (!head)
        return io_fail(
            r, "is cut: the TRK header needs 1000 bytes and the file has %zu; copy it again",
            c->size);
    if (io_sniff_trk(c) == IO_NO)
        return io_fail(r, "is not a TRK file: it does not begin with TRACK");
    bool big = io_u32(head + HEADER_SIZE, false) != HEADER;
    if (big && io_u32(head + HEADER_SIZE, true) != HEADER)
        return io_fail(r, "has a broken TRK header: hdr_size at byte 996 is %lu and must be 1000",
                       (unsigned long)io_u32(head + HEADER_SIZE, false));
    uint16_t scalars = io_u16(head + SCALAR_COUNT, big),
             properties = io_u16(head + PROPERTY_COUNT, big);
    if (scalars > INT16_MAX || properties > INT16_MAX)
        return io_fail(r,
                       "has a broken TRK header: n_scalars (byte 36) or n_properties (byte 238) is "
                       "negative");
    layout of = {scalars, properties};
    affine to_ras;
    if (!read_affine(r, head, big, &to_ras) || !read_body(r, c, of, &to_ras, big))
        return false;
    io_view view = {head + HEADER + 12, (c->size - HEADER) / 4, 4, 1, IO_F32, big};
    return read_attributes(r, view, head + SCALAR_NAMES, of.scalars, "scalars", io_attach_points) &&
           read_properties(r, c, of, big);
}

/* ---- Writing --------------------------------------------------------------------------------- */

/* How many of the attributes fit: ten names, and vectors of up to 9 components beside an 18-byte
 * name. */
static size_t fitting(const io_attribute *attributes, uint32_t count,
                      const io_attribute *fit[NAMES]) {
    size_t used = 0;
    for (uint32_t i = 0; i < count && used < NAMES; i++)
        if (attributes[i].components <= 9)
            fit[used++] = &attributes[i];
    return used;
}

static uint16_t put_names(uint8_t *field, const io_attribute *const *fit, size_t count) {
    uint16_t total = 0;
    for (size_t i = 0; i < count; i++) {
        size_t size = strlen(fit[i]->name);
        memcpy(field + i * NAME, fit[i]->name, size < NAME - 2 ? size : NAME - 2);
        if (fit[i]->components > 1)
            field[i * NAME + (size < NAME - 2 ? size : NAME - 2) + 1] =
                (uint8_t)('0' + fit[i]->components);
        total = (uint16_t)(total + fit[i]->components);
    }
    return total;
}

static void store_u16(uint8_t *at, unsigned value) {
    at[0] = (uint8_t)(value & 255);
    at[1] = (uint8_t)(value >> 8 & 255);
}

static void store_u32(uint8_t *at, uint32_t value) {
    store_u16(at, value & 0xFFFF);
    store_u16(at + 2, value >> 16);
}

static void store_f32(uint8_t *at, double value) {
    float rounded = (float)value;
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    store_u32(at, bits);
}

/* Voxels of 1 mm, along RAS, around the data: TrackVis wants all coordinates inside the volume.
 * shift is RAS minus voxel mm. */
static void put_header(uint8_t head[HEADER], const io_lines *lines, double shift[3]) {
    memcpy(head, "TRACK", 6);
    for (size_t i = 0; i < 3; i++) {
        double corner = floor(lines->bounds[0][i]);
        double cells = ceil(lines->bounds[1][i]) - corner + 1;
        store_u16(head + DIM + 2 * i, cells < 1           ? 1
                                      : cells > INT16_MAX ? INT16_MAX
                                                          : (unsigned)cells);
        store_f32(head + VOXEL_SIZE + 4 * i, 1);
        store_f32(head + VOX_TO_RAS + 20 * i, 1);
        store_f32(head + VOX_TO_RAS + 16 * i + 12, corner);
        shift[i] = (double)(float)corner - 0.5;
    }
    store_f32(head + VOX_TO_RAS + 60, 1);
    memcpy(head + VOXEL_ORDER, "RAS", 4);
    store_f32(head + IMAGE_AXES, 1);
    store_f32(head + IMAGE_AXES + 16, 1);
    store_u32(head + LINE_COUNT, lines->line_count);
    store_u32(head + VERSION, 2);
    store_u32(head + HEADER_SIZE, HEADER);
}

static void put_values(FILE *file, const io_attribute *const *fit, size_t count, size_t row) {
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < fit[i]->components; k++)
            io_put_f32(file, (double)fit[i]->data[row * fit[i]->components + k]);
}

bool io_write_trk(FILE *file, const io_lines *lines, io_error *error) {
    uint8_t head[HEADER] = {0};
    double shift[3];
    const io_attribute *scalars[NAMES], *properties[NAMES];
    if (lines->line_count > INT32_MAX)
        return io_error_set(error,
                            "cannot be written: TRK holds up to 2147483647 lines; write .tck");
    size_t scalar_count = fitting(lines->point_attributes, lines->point_attribute_count, scalars);
    size_t property_count =
        fitting(lines->line_attributes, lines->line_attribute_count, properties);
    put_header(head, lines, shift);
    store_u16(head + SCALAR_COUNT, put_names(head + SCALAR_NAMES, scalars, scalar_count));
    store_u16(head + PROPERTY_COUNT, put_names(head + PROPERTY_NAMES, properties, property_count));
    fwrite(head, 1, HEADER, file);
    for (size_t i = 0; i < lines->line_count && !ferror(file); i++) {
        io_put_u32(file, lines->offsets[i + 1] - lines->offsets[i]);
        for (size_t k = lines->offsets[i]; k < lines->offsets[i + 1]; k++) {
            for (unsigned axis = 0; axis < 3; axis++)
                io_put_f32(file, io_position(lines, k, axis) - shift[axis]);
            put_values(file, scalars, scalar_count, k);
        }
        put_values(file, properties, property_count, i);
    }
    return true;
}
