/* See volume_samples.h. */
#include "volume_samples.h"

#include <stdlib.h>
#include <string.h>

#ifdef LINEAO_HAVE_HDF5
#include <hdf5.h>
#endif

const double sample_spacing[3] = {0.5, 1, 2}, sample_origin[3] = {10, -20, 30}, sample_step = 40;

double sample_velocity(size_t voxel, unsigned component, unsigned frame) {
    return ((double)voxel + VOXELS * (component + 3.0 * frame) - 70) / 64;
}

bool sample_inside(size_t voxel) {
    return voxel % 5 != 3;
}

bool read_sample(const buffer *files, uint32_t count, const io_volume_options *options,
                 io_volume *out, uint32_t *failed, io_error *error) {
    io_source sources[MOST_FILES];
    for (uint32_t i = 0; i < count; i++) {
        sources[i].bytes = files[i].data;
        sources[i].size = files[i].size;
    }
    return io_read_volume_memory(sources, count, options, out, failed, error);
}

void free_files(buffer files[MOST_FILES]) {
    for (int i = 0; i < MOST_FILES; i++)
        buffer_free(&files[i]);
}

void patch_bytes(buffer *b, size_t at, uint64_t bits, unsigned size) {
    for (unsigned i = 0; i < size; i++)
        b->data[at + i] = (uint8_t)(bits >> 8 * (b->big ? size - 1 - i : i));
}

/* ---- NIfTI ----------------------------------------------------------------------------------- */

static void patch_real(buffer *b, size_t at, double value, bool wide) {
    float narrow = (float)value;
    uint64_t bits = 0;
    uint32_t half;
    memcpy(&bits, &value, 8);
    memcpy(&half, &narrow, 4);
    patch_bytes(b, at, wide ? bits : half, wide ? 8 : 4);
}

static void put_header(buffer *b, const nifti *n) {
    bool wide = n->version == 2;
    size_t head = wide ? 540 : 348, word = wide ? 8 : 4;
    const unsigned dims[8] = {5,
                              SIZE_X,
                              SIZE_Y,
                              SIZE_Z,
                              n->layout == FOURTH_AXIS ? 3 : n->frames,
                              n->layout == FIFTH_AXIS ? 3 : 1,
                              1,
                              1};
    const double pixdim[8] = {
        1, sample_spacing[0], sample_spacing[1], sample_spacing[2], sample_step / 1000, 1, 1, 1};
    put_zeros(b, head + 4);
    patch_bytes(b, 0, head, 4);
    for (unsigned i = 0; i < 8; i++) {
        patch_bytes(b, wide ? 16 + 8 * i : 40 + 2 * i, dims[i], wide ? 8 : 2);
        patch_real(b, wide ? 104 + 8 * i : 76 + 4 * i, pixdim[i], wide);
    }
    patch_bytes(b, wide ? 504 : 68, n->layout == ONE_COMPONENT ? 0 : 1007, wide ? 4 : 2);
    patch_bytes(b, wide ? 12 : 70, (unsigned)n->type, 2);
    patch_bytes(b, wide ? 14 : 72, n->type == 64 ? 64 : n->type == 16 ? 32 : 16, 2);
    if (wide)
        patch_bytes(b, 168, head + 4, 8);
    else
        patch_real(b, 108, (double)head + 4, false);
    patch_real(b, wide ? 176 : 112, n->slope, wide);
    patch_bytes(b, wide ? 500 : 123, 2 + 8, wide ? 4 : 1); /* mm, s */
    patch_bytes(b, wide ? (n->qform ? 344 : 348) : (n->qform ? 252 : 254), 1, wide ? 4 : 2);
    for (unsigned i = 0; i < 3; i++) {
        patch_real(b, (wide ? 376 : 268) + word * i, sample_origin[i], wide);
        patch_real(b, (wide ? 400 : 280) + word * (4 * i + i), sample_spacing[i], wide);
        patch_real(b, (wide ? 400 : 280) + word * (4 * i + 3), sample_origin[i], wide);
    }
    memcpy(b->data + (wide ? 4 : 344), wide ? "n+2\0\r\n\032\n" : "n+1", wide ? 8 : 4);
}

static void put_nifti_value(buffer *b, const nifti *n, size_t voxel, unsigned component,
                            unsigned frame) {
    double value = sample_velocity(voxel, component, frame) / (n->slope != 0 ? n->slope : 1);
    if (n->type == 4)
        put_u16(b, (unsigned)(int)value & 0xFFFF);
    else if (n->type == 16)
        put_f32(b, value);
    else
        put_f64(b, value);
}

buffer make_nifti(nifti n) {
    buffer b = {NULL, 0, 0, n.big};
    put_header(&b, &n);
    for (unsigned k = 0; k < 3; k++)
        for (unsigned frame = 0; frame < n.frames; frame++)
            for (size_t i = 0; i < VOXELS; i++)
                if (n.layout != ONE_COMPONENT || k == n.component)
                    put_nifti_value(&b, &n, i, k, frame);
    return b;
}

static void nifti1(buffer *b) {
    b[0] = make_nifti((nifti){1, false, 16, 0, 2, FIFTH_AXIS, 0, false});
}
static void nifti1_big(buffer *b) {
    b[0] = make_nifti((nifti){1, true, 64, 0, 2, FIFTH_AXIS, 0, true});
}
static void nifti1_whole(buffer *b) {
    b[0] = make_nifti((nifti){1, false, 4, 1.0 / 64, 2, FIFTH_AXIS, 0, false});
}
static void nifti1_fourth(buffer *b) {
    b[0] = make_nifti((nifti){1, false, 16, 0, 1, FOURTH_AXIS, 0, false});
}
static void nifti2(buffer *b) {
    b[0] = make_nifti((nifti){2, false, 64, 0, 2, FIFTH_AXIS, 0, true});
}
static void nifti2_big(buffer *b) {
    b[0] = make_nifti((nifti){2, true, 4, 1.0 / 64, 1, FIFTH_AXIS, 0, false});
}
static void nifti_three(buffer *b) {
    for (unsigned k = 0; k < 3; k++)
        b[k] = make_nifti((nifti){1, k == 1, k == 2 ? 64 : 16, 0, 2, ONE_COMPONENT, k, false});
}
static void nifti_gz(buffer *b) {
    buffer plain = make_nifti((nifti){1, false, 16, 0, 2, FIFTH_AXIS, 0, false});
    b[0] = gzip_of(&plain);
    buffer_free(&plain);
}

/* ---- VTK's XML ------------------------------------------------------------------------------- */

static void put_count(buffer *b, size_t value, bool wide) {
    if (wide)
        put_u64(b, value);
    else
        put_u32(b, (uint32_t)value);
}

/* Compressed data is cut into two blocks, the second shorter. */
static buffer encode(const buffer *values, vti_encoding encoding, bool wide) {
    bool zlib = encoding == VTI_INLINE_ZLIB || encoding == VTI_RAW_ZLIB;
    bool base64 = encoding != VTI_RAW && encoding != VTI_RAW_ZLIB;
    buffer head = {NULL, 0, 0, values->big}, body = {NULL, 0, 0, false}, out = {NULL, 0, 0, false};
    size_t full = zlib ? values->size / 3 * 2 : values->size;
    put_count(&head, zlib ? 2 : values->size, wide);
    if (zlib) {
        put_count(&head, full, wide);
        put_count(&head, values->size - full, wide);
    }
    for (size_t at = 0; at < values->size; at += full) {
        buffer part = {values->data + at, 0, 0, false};
        part.size = values->size - at < full ? values->size - at : full;
        if (zlib) {
            buffer packed = zlib_of(&part);
            put_count(&head, packed.size, wide);
            put(&body, packed.data, packed.size);
            buffer_free(&packed);
        } else {
            put(&body, part.data, part.size);
        }
    }
    if (base64 && zlib) { /* apart, each padded */
        put_base64(&out, head.data, head.size);
        put_base64(&out, body.data, body.size);
    } else {
        put(&head, body.data, body.size);
        if (base64)
            put_base64(&out, head.data, head.size);
        else
            put(&out, head.data, head.size);
    }
    buffer_free(&head);
    buffer_free(&body);
    return out;
}

static void put_array(buffer *b, buffer *appended, const char *tag, const buffer *values,
                      vti_encoding encoding, bool wide) {
    if (encoding == VTI_ASCII) {
        put_format(b, "<DataArray %s format=\"ascii\">\n", tag);
        put(b, values->data, values->size);
        put_text(b, "</DataArray>\n");
        return;
    }
    buffer packed = encode(values, encoding, wide);
    if (encoding >= VTI_RAW) {
        put_format(b, "<DataArray %s format=\"appended\" offset=\"%zu\"/>\n", tag, appended->size);
        put(appended, packed.data, packed.size);
    } else {
        put_format(b, "<DataArray %s format=\"binary\">", tag);
        put(b, packed.data, packed.size);
        put_text(b, "</DataArray>\n");
    }
    buffer_free(&packed);
}

buffer make_vti(vti_encoding encoding, bool big, bool wide, unsigned frame, const char *head) {
    buffer b = {NULL, 0, 0, false}, appended = {NULL, 0, 0, false};
    buffer velocity = {NULL, 0, 0, big}, mask = {NULL, 0, 0, big};
    bool zlib = encoding == VTI_INLINE_ZLIB || encoding == VTI_RAW_ZLIB;
    for (size_t i = 0; i < VOXELS; i++) {
        for (unsigned k = 0; k < 3; k++) {
            if (encoding == VTI_ASCII)
                put_format(&velocity, "%.9g ", sample_velocity(i, k, frame));
            else
                put_f32(&velocity, sample_velocity(i, k, frame));
        }
        if (encoding == VTI_ASCII)
            put_format(&mask, "%d ", sample_inside(i));
        else
            put_u8(&mask, sample_inside(i));
    }
    put_format(&b,
               "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" "
               "byte_order=\"%s\"%s%s>\n<ImageData %s>\n<Piece Extent=\"3 6 0 2 -1 0\">\n"
               "<PointData Vectors=\"flow\">\n",
               big ? "BigEndian" : "LittleEndian", wide ? " header_type=\"UInt64\"" : "",
               zlib ? " compressor=\"vtkZLibDataCompressor\"" : "",
               head ? head
                    : "WholeExtent=\"3 6 0 2 -1 0\" Origin=\"8.5 -20 32\" Spacing=\"0.5 1 2\"");
    put_array(&b, &appended, "type=\"Float32\" Name=\"flow\" NumberOfComponents=\"3\"", &velocity,
              encoding, wide);
    put_array(&b, &appended, "type=\"UInt8\" Name=\"vtkValidPointMask\"", &mask, encoding, wide);
    put_text(&b, "</PointData><CellData></CellData></Piece>\n</ImageData>\n");
    if (encoding >= VTI_RAW) {
        put_format(&b, "<AppendedData encoding=\"%s\">\n_",
                   encoding == VTI_BASE64 ? "base64" : "raw");
        put(&b, appended.data, appended.size);
        put_text(&b, "\n</AppendedData>\n");
    }
    put_text(&b, "</VTKFile>\n");
    buffer_free(&appended);
    buffer_free(&velocity);
    buffer_free(&mask);
    return b;
}

static void vti_ascii(buffer *b) {
    b[0] = make_vti(VTI_ASCII, false, false, 0, NULL);
}
static void vti_inline(buffer *b) {
    b[0] = make_vti(VTI_INLINE, false, false, 0, NULL);
}
static void vti_inline_zlib(buffer *b) {
    b[0] = make_vti(VTI_INLINE_ZLIB, true, false, 0, NULL);
}
static void vti_raw(buffer *b) {
    b[0] = make_vti(VTI_RAW, true, true, 0, NULL);
}
static void vti_raw_zlib(buffer *b) {
    b[0] = make_vti(VTI_RAW_ZLIB, false, true, 0, NULL);
}
static void vti_base64(buffer *b) {
    b[0] = make_vti(VTI_BASE64, false, false, 0, NULL);
}
static void vti_series(buffer *b) {
    b[0] = make_vti(VTI_RAW, false, true, 0, NULL);
    b[1] = make_vti(VTI_RAW_ZLIB, false, true, 1, NULL);
}

/* ---- VTK legacy ------------------------------------------------------------------------------ */

buffer make_points(bool binary) {
    buffer b = {NULL, 0, 0, true};
    put_format(&b,
               "# vtk DataFile Version 3.0\nDATASET of flow\n%s\nDATASET STRUCTURED_POINTS\n"
               "DIMENSIONS %d %d %d\n%s 0.5 1 2\nORIGIN 10 -20 30\nPOINT_DATA %d\n"
               "SCALARS mask unsigned_char\nLOOKUP_TABLE default\n",
               binary ? "BINARY" : "ASCII", SIZE_X, SIZE_Y, SIZE_Z,
               binary ? "ASPECT_RATIO" : "SPACING", VOXELS);
    for (size_t i = 0; i < VOXELS; i++) {
        if (binary)
            put_u8(&b, sample_inside(i));
        else
            put_format(&b, "%d\n", sample_inside(i));
    }
    put_text(&b, "\nVECTORS flow float\n");
    for (size_t i = 0; i < VOXELS; i++) {
        for (unsigned k = 0; k < 3; k++) {
            if (binary)
                put_f32(&b, sample_velocity(i, k, 0));
            else
                put_format(&b, "%.9g ", sample_velocity(i, k, 0));
        }
    }
    return b;
}

static void points_ascii(buffer *b) {
    b[0] = make_points(false);
}
static void points_binary(buffer *b) {
    b[0] = make_points(true);
}

/* ---- HDF5 ------------------------------------------------------------------------------------ */

#ifdef LINEAO_HAVE_HDF5
static void must(bool good) {
    if (!good)
        abort();
}

static size_t axis_of(size_t voxel, int axis) {
    return axis == 0   ? voxel % SIZE_X
           : axis == 1 ? voxel / SIZE_X % SIZE_Y
                       : voxel / (SIZE_X * SIZE_Y);
}

/* component 3: the mask; 4: all three as one array. */
static void put_set(hid_t file, const char *name, const hdf5_spec *what, unsigned component) {
    double values[2 * 3 * VOXELS];
    unsigned frames = component == 3 ? 1 : what->frames, width = component == 4 ? 3 : 1;
    for (unsigned f = 0; f < frames; f++)
        for (size_t i = 0; i < VOXELS; i++)
            for (unsigned k = 0; k < width; k++) {
                size_t x = axis_of(i, 0), y = axis_of(i, 1), z = axis_of(i, 2);
                size_t at = what->matlab
                                ? x + SIZE_X * (y + SIZE_Y * (z + SIZE_Z * (f + frames * k)))
                                : k + width * (z + SIZE_Z * (y + SIZE_Y * (x + SIZE_X * f)));
                values[at] = component == 3   ? sample_inside(i)
                             : component == 4 ? sample_velocity(i, k, f)
                                              : sample_velocity(i, component, f);
            }
    hsize_t forward[5] = {frames, SIZE_X, SIZE_Y, SIZE_Z, width};
    hsize_t matlab[5] = {width, frames, SIZE_Z, SIZE_Y, SIZE_X};
    int rank = width > 1 ? 5 : 4;
    const hsize_t *dims = what->matlab ? matlab + (width > 1 ? 0 : 1) : forward;
    hid_t space = H5Screate_simple(rank, dims, NULL), list = H5Pcreate(H5P_DATASET_CREATE);
    if (what->chunked)
        must(H5Pset_chunk(list, rank, dims) >= 0 && H5Pset_deflate(list, 6) >= 0);
    hid_t set = H5Dcreate2(file, name, what->doubles ? H5T_IEEE_F64BE : H5T_IEEE_F32LE, space,
                           H5P_DEFAULT, list, H5P_DEFAULT);
    must(set >= 0 && H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    if (what->matlab) {
        hid_t scalar = H5Screate(H5S_SCALAR);
        hid_t attribute =
            H5Acreate2(set, "MATLAB_class", H5T_NATIVE_INT, scalar, H5P_DEFAULT, H5P_DEFAULT);
        must(attribute >= 0);
        H5Aclose(attribute);
        H5Sclose(scalar);
    }
    H5Dclose(set);
    H5Pclose(list);
    H5Sclose(space);
}

static void put_dx(hid_t file) {
    hsize_t dims[2] = {1, 3};
    hid_t space = H5Screate_simple(2, dims, NULL);
    hid_t set =
        H5Dcreate2(file, "dx", H5T_IEEE_F32LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    must(set >= 0 &&
         H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, sample_spacing) >= 0);
    H5Dclose(set);
    H5Sclose(space);
}

buffer make_hdf5(hdf5_spec what) {
    static const char *const names[3] = {"u", "v", "w"};
    hid_t list = H5Pcreate(H5P_FILE_ACCESS);
    must(H5Pset_fapl_core(list, 4096, 0) >= 0);
    hid_t file = H5Fcreate("sample.h5", H5F_ACC_TRUNC, H5P_DEFAULT, list);
    must(file >= 0);
    if (what.vector)
        put_set(file, "velocity", &what, 4);
    for (unsigned k = 0; k < 3 && !what.vector; k++)
        put_set(file, names[k], &what, k);
    if (what.mask)
        put_set(file, "mask", &what, 3);
    if (what.dx)
        put_dx(file);
    if (what.cycle) {
        hid_t group = H5Gcreate2(file, "ring", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        must(group >= 0 && H5Lcreate_hard(file, "/", group, "back", H5P_DEFAULT, H5P_DEFAULT) >= 0);
        must(H5Lcreate_soft("/ring/self", group, "self", H5P_DEFAULT, H5P_DEFAULT) >= 0);
        must(H5Lcreate_external("/etc/hosts", "/", group, "away", H5P_DEFAULT, H5P_DEFAULT) >= 0);
        H5Gclose(group);
    }
    must(H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0);
    ssize_t size = H5Fget_file_image(file, NULL, 0);
    buffer b = {NULL, 0, 0, false};
    must(size > 0);
    b.data = malloc((size_t)size);
    must(b.data && H5Fget_file_image(file, b.data, (size_t)size) == size);
    b.size = b.capacity = (size_t)size;
    H5Fclose(file);
    H5Pclose(list);
    return b;
}

static void hdf5_plain(buffer *b) {
    b[0] = make_hdf5((hdf5_spec){false, false, false, false, true, true, false, 1});
}
static void hdf5_chunked(buffer *b) {
    b[0] = make_hdf5((hdf5_spec){true, false, false, false, true, true, false, 2});
}
static void hdf5_doubles(buffer *b) {
    b[0] = make_hdf5((hdf5_spec){false, true, false, true, true, true, true, 2});
}
static void hdf5_matlab(buffer *b) {
    b[0] = make_hdf5((hdf5_spec){false, true, true, true, true, true, false, 2});
}
#else
buffer make_hdf5(hdf5_spec what) {
    buffer none = {NULL, 0, 0, false};
    (void)what;
    return none;
}
#endif

/* ---- All ------------------------------------------------------------------------------------- */

const volume_sample volume_samples[] = {
#ifdef LINEAO_HAVE_NIFTI
    {"nifti1", nifti1, 1, 2, false, true, false},
    {"nifti1_big", nifti1_big, 1, 2, false, true, false},
    {"nifti1_whole", nifti1_whole, 1, 2, false, true, false},
    {"nifti1_fourth", nifti1_fourth, 1, 1, false, true, false},
    {"nifti2", nifti2, 1, 2, false, true, false},
    {"nifti2_big", nifti2_big, 1, 1, false, true, false},
    {"nifti_three", nifti_three, 3, 2, false, true, false},
    {"nifti_gz", nifti_gz, 1, 2, false, true, false},
#endif
    {"vti_ascii", vti_ascii, 1, 1, true, false, false},
    {"vti_inline", vti_inline, 1, 1, true, false, false},
    {"vti_inline_zlib", vti_inline_zlib, 1, 1, true, false, false},
    {"vti_raw", vti_raw, 1, 1, true, false, false},
    {"vti_raw_zlib", vti_raw_zlib, 1, 1, true, false, false},
    {"vti_base64", vti_base64, 1, 1, true, false, false},
    {"vti_series", vti_series, 2, 2, true, false, false},
    {"points_ascii", points_ascii, 1, 1, true, false, false},
    {"points_binary", points_binary, 1, 1, true, false, false},
#ifdef LINEAO_HAVE_HDF5
    {"hdf5_plain", hdf5_plain, 1, 1, true, false, true},
    {"hdf5_chunked", hdf5_chunked, 1, 2, true, false, true},
    {"hdf5_doubles", hdf5_doubles, 1, 2, true, false, true},
    {"hdf5_matlab", hdf5_matlab, 1, 2, true, false, true},
#endif
};
const size_t volume_sample_count = sizeof volume_samples / sizeof volume_samples[0];
