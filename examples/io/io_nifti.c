/* NIfTI-1 and -2 in one file (.nii): libnifti reads the header, its byte order and orientation; the
 * values are views of the bytes behind it. */
#include "io_grid.h"

#include <math.h>
#include <string.h>

enum { NIFTI1_HEAD = 348, NIFTI2_HEAD = 540 };

/* Bytes of the header, 0 = not NIfTI; *big: its byte order. */
static uint32_t head_size(const io_cursor *c, bool *big) {
    static const struct { uint32_t size, magic; } kinds[] = {{NIFTI1_HEAD, 344}, {NIFTI2_HEAD, 4}};
    for (size_t i = 0; c->size >= NIFTI1_HEAD && i < 4; i++) {
        uint32_t size = kinds[i / 2].size;
        const uint8_t *magic = c->bytes + kinds[i / 2].magic;
        *big = i % 2;
        if (c->size >= size && io_u32(c->bytes, *big) == size && magic[0] == 'n' &&
            (magic[1] == '+' || magic[1] == 'i') && magic[2] == (i < 2 ? '1' : '2') && !magic[3])
            return size;
    }
    return 0;
}

io_match io_sniff_nifti(const io_cursor *bytes) {
    bool big;
    return head_size(bytes, &big) ? IO_YES : IO_NO;
}

#ifdef LINEAO_HAVE_NIFTI
#include <nifti2_io.h>

/* What is checked before libnifti sees the header: it repairs silently. */
typedef struct head {
    bool big, wide; /* wide: NIfTI-2 */
    int code;       /* of the type of values */
    int64_t dim[8]; /* dim[0]: how many count */
    double pixdim[4], offset;
} head;

static double head_real(const io_cursor *c, const head *h, size_t at, size_t wide_at) {
    io_view view = {c->bytes + (h->wide ? wide_at : at), 1,     0, 1,
                    h->wide ? IO_F64 : IO_F32,           h->big};
    return io_view_real(&view, 0, 0);
}

static io_type type_of(int code) {
    // clang-format off
    static const struct { int code; io_type type; } types[] = {
        {DT_UINT8, IO_U8}, {DT_INT8, IO_I8}, {DT_INT16, IO_I16}, {DT_UINT16, IO_U16},
        {DT_INT32, IO_I32}, {DT_UINT32, IO_U32}, {DT_INT64, IO_I64}, {DT_UINT64, IO_U64},
        {DT_FLOAT32, IO_F32}, {DT_FLOAT64, IO_F64},
    };
    // clang-format on
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (types[i].code == code)
            return types[i].type;
    return IO_NONE;
}

static bool read_head(io_reader *r, const io_cursor *c, head *h) {
    uint32_t size = head_size(c, &h->big);
    h->wide = size == NIFTI2_HEAD;
    for (size_t i = 0; i < 8; i++) {
        io_view view = {c->bytes + (h->wide ? 16 + 8 * i : 40 + 2 * i),
                        1,
                        0,
                        1,
                        h->wide ? IO_I64 : IO_I16,
                        h->big};
        double value = io_view_real(&view, 0, 0);
        if (!(value >= 0 && value <= INT32_MAX))
            return io_fail(r, "has %g voxels along axis %zu; its header is damaged", value, i);
        h->dim[i] = (int64_t)value;
    }
    for (size_t i = 0; i < 4; i++)
        h->pixdim[i] = head_real(c, h, 76 + 4 * i, 104 + 8 * i);
    io_view wide = {c->bytes + 168, 1, 0, 1, IO_I64, h->big};
    h->offset = h->wide ? io_view_real(&wide, 0, 0) : head_real(c, h, 108, 0);
    if (c->bytes[h->wide ? 5 : 345] == 'i')
        return io_fail(r, "is the header of a pair; join it with its .img into one .nii file");
    h->code = io_u16(c->bytes + (h->wide ? 12 : 70), h->big);
    if (type_of(h->code) == IO_NONE)
        return io_fail(r, "has values of type %d (%s); whole and floating numbers are read",
                       h->code, nifti_datatype_string(h->code));
    if (h->dim[0] < 3 || h->dim[0] > 7)
        return io_fail(r, "has %d axes; a volume has 3 (x y z) to 5 (x y z, time, component)",
                       (int)h->dim[0]);
    for (size_t i = 1; i < 8; i++) {
        h->dim[i] = (int64_t)i > h->dim[0] ? 1 : h->dim[i];
        if (!h->dim[i] || (i > 5 && h->dim[i] != 1))
            return io_fail(r, "has %d values along axis %zu; velocity has x y z, time, component",
                           (int)h->dim[i], i);
    }
    if (!(h->offset >= size && h->offset <= (double)c->size) || floor(h->offset) != h->offset)
        return io_fail(r, "has its values at byte %g of %zu; copy the file again", h->offset,
                       c->size);
    return true;
}

/* ---- Orientation ----------------------------------------------------------------------------- */

/* libnifti repairs a pixdim of 0 to 1; here it means that the size of voxels is not told. */
static bool has_spacing(const head *h) {
    for (int i = 1; i < 4; i++)
        if (!(isfinite(h->pixdim[i]) && h->pixdim[i] > 0))
            return false;
    return true;
}

static bool is_affine(const nifti_dmat44 *m) {
    double largest = 0;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++) {
            if (!(fabs(m->m[row][column]) < 1e9))
                return false;
            largest = fmax(largest, column < 3 ? fabs(m->m[row][column]) : 0);
        }
    nifti_dmat33 inner;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            inner.m[row][column] = largest > 0 ? m->m[row][column] / largest : 0;
    return fabs(nifti_dmat33_determ(inner)) > 1e-9;
}

/* The sform where it is given, else the qform (which is pixdim alone when it is not given). */
static bool orient(io_reader *r, const nifti_image *image, const head *h, double unit,
                   io_grid *grid) {
    const nifti_dmat44 *m = &image->qto_xyz;
    bool qform = image->qform_code > 0 && has_spacing(h) && is_affine(m);
    if (image->sform_code > 0 && is_affine(&image->sto_xyz)) {
        double apart = 0;
        for (int i = 0; i < 12; i++)
            apart = fmax(apart, fabs(image->sto_xyz.m[i / 4][i % 4] - m->m[i / 4][i % 4]));
        m = &image->sto_xyz;
        if (qform && apart > 0.01 &&
            !io_warn(r, "its sform and qform differ by up to %g; the sform is used", apart))
            return false;
        grid->has_spacing = true;
    } else {
        if (image->sform_code > 0 && !io_warn(r, "its sform is no orientation; it is left out"))
            return false;
        grid->has_spacing = has_spacing(h) && is_affine(m);
        if (image->sform_code <= 0 && image->qform_code <= 0 &&
            !io_warn(r, "it tells no orientation; its voxels are taken along x y z from 0 0 0"))
            return false;
    }
    for (int i = 0; i < 12 && grid->has_spacing; i++)
        grid->to_mm[i / 4][i % 4] = m->m[i / 4][i % 4] * unit;
    return true;
}

/* ---- Reading --------------------------------------------------------------------------------- */

static bool find_units(io_reader *r, const nifti_image *image, double *mm, double *ms) {
    *mm = image->xyz_units == NIFTI_UNITS_METER    ? 1000
          : image->xyz_units == NIFTI_UNITS_MICRON ? 0.001
                                                   : 1;
    *ms = image->time_units == NIFTI_UNITS_SEC    ? 1000
          : image->time_units == NIFTI_UNITS_MSEC ? 1
          : image->time_units == NIFTI_UNITS_USEC ? 0.001
                                                  : 0; /* not told */
    return image->xyz_units != NIFTI_UNITS_UNKNOWN ||
           io_warn(r, "it tells no unit of length; mm is taken");
}

static bool add_values(io_reader *r, const io_cursor *c, const head *h, const nifti_image *image,
                       io_grid *grid) {
    bool vector =
        image->intent_code == NIFTI_INTENT_VECTOR || image->intent_code == NIFTI_INTENT_DISPVECT;
    bool swapped = h->dim[5] == 1 && h->dim[4] == 3 && vector; /* components where time is */
    uint64_t frames = swapped ? 1 : (uint64_t)h->dim[4];
    uint64_t components = swapped ? 3 : (uint64_t)h->dim[5];
    io_field *field = io_add_field(r, grid, io_text_of(components == 3 ? "velocity" : "values"));
    if (!field)
        return false;
    field->type = type_of(h->code);
    size_t size = io_type_size(field->type), offset = (size_t)h->offset;
    size_t planes = (c->size - offset) / (io_grid_voxels(grid) * size);
    if (components > planes || frames > planes / components)
        return io_fail(r,
                       "ends too early: %u x %u x %u voxels, %llu frames and %llu components "
                       "need more than the %zu bytes behind its header; copy the file again",
                       (unsigned)grid->size[0], (unsigned)grid->size[1], (unsigned)grid->size[2],
                       (unsigned long long)frames, (unsigned long long)components,
                       c->size - offset);
    field->components = (uint32_t)components;
    field->frames = (uint32_t)frames;
    field->bytes = c->bytes + offset;
    field->big = h->big;
    io_field_packed(field, grid);
    field->stride[0] = size;
    field->stride[1] = size * grid->size[0];
    field->stride[2] = size * grid->size[0] * grid->size[1];
    field->stride[4] = size * io_grid_voxels(grid);
    field->stride[3] = field->stride[4] * field->frames;
    if (isfinite(image->scl_slope) && isfinite(image->scl_inter) && image->scl_slope != 0) {
        field->slope = image->scl_slope;
        field->intercept = image->scl_inter;
    }
    return true;
}

static nifti_image *convert(const io_cursor *c, bool wide) {
    nifti_set_debug_level(0); /* it prints otherwise */
    if (wide) {
        nifti_2_header header;
        memcpy(&header, c->bytes, sizeof header);
        return nifti_convert_n2hdr2nim(header, NULL);
    }
    nifti_1_header header;
    memcpy(&header, c->bytes, sizeof header);
    return nifti_convert_n1hdr2nim(header, NULL);
}

static bool fill(io_reader *r, const io_cursor *c, const head *h, const nifti_image *image,
                 io_grid *grid) {
    const uint64_t size[3] = {(uint64_t)h->dim[1], (uint64_t)h->dim[2], (uint64_t)h->dim[3]};
    double mm, ms;
    if (!io_grid_size(r, grid, size) || !find_units(r, image, &mm, &ms) ||
        !orient(r, image, h, mm, grid) || !add_values(r, c, h, image, grid))
        return false;
    if (isfinite(image->dt) && image->dt > 0)
        grid->time_step = image->dt * ms;
    return true;
}

bool io_open_nifti(io_reader *r, io_cursor *c, io_grid *grid) {
    head h;
    if (!read_head(r, c, &h))
        return false;
    nifti_image *image = convert(c, h.wide);
    if (!image)
        return io_fail(r, "has a header that is not NIfTI's; copy the file again");
    bool done = fill(r, c, &h, image, grid);
    nifti_image_free(image);
    return done;
}
#else
bool io_open_nifti(io_reader *r, io_cursor *c, io_grid *grid) {
    (void)c;
    (void)grid;
    return io_fail(r, "is NIfTI, which this build does not read; build it with libnifti-dev");
}
#endif
