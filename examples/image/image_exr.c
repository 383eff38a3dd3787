#include "image.h"
#include "image_file.h"

#include <openexr.h>
#include <stdlib.h>
#include <string.h>

/* The name under which the JSON text of a dump travels. */
#define ATTRIBUTE "lineao"

/* Where a failure is told; `failed` once it is, for the first one is the cause. */
typedef struct exr_report {
    const char *path;
    char *error;
    bool failed;
} exr_report;

/* Without a handler the library prints. This one can not even ask for its user data: OpenEXRCore
 * 3.1 holds the context's lock while it reports. So the texts come from the result codes. */
static void exr_on_error(exr_const_context_t context, exr_result_t code, const char *message) {
    (void)context;
    (void)code;
    (void)message;
}

/* Turns a failure code into false and its text. */
static bool exr_check(exr_report *report, exr_result_t code) {
    if (code == EXR_ERR_SUCCESS)
        return true;
    if (!report->failed) {
        report->failed = true;
        image_fail(report->error, report->path, exr_get_default_error_message(code));
    }
    return false;
}

static exr_context_initializer_t exr_setup(void) {
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = exr_on_error;
    return setup;
}

/* ---- writing ---------------------------------------------------------------------------- */

static exr_attr_box2i_t exr_window(const image_part *part) {
    exr_attr_box2i_t box;
    memset(&box, 0, sizeof box);
    box.max.x = (int32_t)part->width - 1;
    box.max.y = (int32_t)part->height - 1;
    return box;
}

static bool exr_declare(exr_context_t file, exr_report *report, const image_part *part,
                        const exr_attr_box2i_t *display, const char *attribute) {
    int index = 0;
    exr_attr_box2i_t window = exr_window(part);
    exr_attr_v2f_t centre;
    memset(&centre, 0, sizeof centre);
    bool ok =
        exr_check(report, exr_add_part(file, part->name, EXR_STORAGE_SCANLINE, &index)) &&
        exr_check(report,
                  exr_initialize_required_attr(file, index, display, &window, 1.0f, &centre, 1.0f,
                                               EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP));
    for (uint32_t c = 0; ok && c < part->channel_count; c++) {
        ok = exr_check(report, exr_add_channel(file, index, part->channels[c].name, EXR_PIXEL_FLOAT,
                                               EXR_PERCEPTUALLY_LINEAR, 1, 1));
    }
    if (ok && attribute) {
        ok = exr_check(report, exr_attr_set_string(file, index, ATTRIBUTE, attribute));
    }
    return ok;
}

/* The file sorts channels by name, so each is looked up. */
static const image_channel *exr_find(const image_part *part, const char *name) {
    for (uint32_t c = 0; c < part->channel_count; c++) {
        if (strcmp(part->channels[c].name, name) == 0)
            return &part->channels[c];
    }
    return NULL;
}

static bool exr_write_pixels(exr_context_t file, exr_report *report, int index,
                             const image_part *part) {
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    int32_t rows = 0;
    bool ok = exr_check(report, exr_get_scanlines_per_chunk(file, index, &rows));
    for (int32_t y = 0; ok && y < (int32_t)part->height; y += rows) {
        exr_chunk_info_t chunk;
        ok = exr_check(report, exr_write_scanline_chunk_info(file, index, y, &chunk)) &&
             exr_check(report, y == 0 ? exr_encoding_initialize(file, index, &chunk, &encoder)
                                      : exr_encoding_update(file, index, &chunk, &encoder));
        for (int16_t c = 0; ok && c < encoder.channel_count; c++) {
            exr_coding_channel_info_t *channel = &encoder.channels[c];
            const float *data = exr_find(part, channel->channel_name)->data;
            channel->encode_from_ptr = (const uint8_t *)(data + (size_t)part->width * (size_t)y);
            channel->user_pixel_stride = (int32_t)sizeof(float);
            channel->user_line_stride = (int32_t)(part->width * sizeof(float));
            channel->user_bytes_per_element = (int16_t)sizeof(float);
            channel->user_data_type = EXR_PIXEL_FLOAT;
        }
        if (ok && y == 0) {
            ok = exr_check(report, exr_encoding_choose_default_routines(file, index, &encoder));
        }
        ok = ok && exr_check(report, exr_encoding_run(file, index, &encoder));
    }
    exr_encoding_destroy(file, &encoder);
    return ok;
}

/* The library's own texts for these say little. */
static const char *exr_fault(const image_part *parts, uint32_t part_count) {
    if (part_count == 0)
        return "an OpenEXR file needs at least one part";
    for (uint32_t p = 0; p < part_count; p++) {
        const image_part *part = &parts[p];
        /* the line stride in bytes must fit the library's int32 */
        if (part->width - 1 >= 1u << 28 || part->height - 1 >= 1u << 28)
            return "bad image size";
        if (part->channel_count == 0)
            return "an image without channels";
        if (part_count > 1 && !part->name)
            return "several parts need names";
        for (uint32_t c = 0; c < part->channel_count; c++) {
            const image_channel *channel = &part->channels[c];
            if (!channel->name || !channel->data)
                return "an empty channel";
            if (exr_find(part, channel->name) != channel)
                return "two channels of one name";
        }
    }
    return NULL;
}

bool image_write_exr(const char *path, const image_part *parts, uint32_t part_count,
                     const char *attribute, char error[IMAGE_ERROR_SIZE]) {
    const char *fault = exr_fault(parts, part_count);
    if (fault)
        return image_fail(error, path, fault);
    char *temp = image_temp_create(path, error);
    if (!temp)
        return false;

    exr_report report = {path, error, false};
    exr_context_initializer_t setup = exr_setup();
    exr_context_t file = NULL;
    exr_attr_box2i_t display = exr_window(&parts[0]);
    bool ok = exr_check(&report, exr_start_write(&file, temp, EXR_WRITE_FILE_DIRECTLY, &setup));
    for (uint32_t p = 0; ok && p < part_count; p++) {
        ok = exr_declare(file, &report, &parts[p], &display, attribute);
    }
    ok = ok && exr_check(&report, exr_write_header(file));
    for (uint32_t p = 0; ok && p < part_count; p++) {
        ok = exr_write_pixels(file, &report, (int)p, &parts[p]);
    }
    if (file) {
        exr_result_t finished = exr_finish(&file);
        ok = ok && exr_check(&report, finished);
    }
    return image_temp_finish(temp, path, ok, error);
}

/* ---- reading ---------------------------------------------------------------------------- */

static char *copy_text(const char *text, size_t length) {
    char *copy = malloc(length + 1);
    if (copy) {
        memcpy(copy, text, length);
        copy[length] = 0;
    }
    return copy;
}

static bool exr_read_layout(exr_context_t file, exr_report *report, int index, image_part *part) {
    exr_storage_t storage;
    exr_attr_box2i_t box;
    const exr_attr_chlist_t *list = NULL;
    const char *name = NULL;
    if (!exr_check(report, exr_get_storage(file, index, &storage)) ||
        !exr_check(report, exr_get_data_window(file, index, &box)) ||
        !exr_check(report, exr_get_channels(file, index, &list))) {
        return false;
    }
    int64_t width = (int64_t)box.max.x - box.min.x + 1, height = (int64_t)box.max.y - box.min.y + 1;
    bool plain = storage == EXR_STORAGE_SCANLINE && width < 1 << 28 && height < 1 << 28;
    for (int c = 0; c < list->num_channels; c++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[c];
        plain = plain && entry->pixel_type == EXR_PIXEL_FLOAT && entry->x_sampling == 1 &&
                entry->y_sampling == 1;
    }
    if (!plain) {
        report->failed = true;
        return image_fail(report->error, report->path, "not scan lines of 32-bit floats");
    }
    if (exr_get_name(file, index, &name) != EXR_ERR_SUCCESS || !name)
        name = "";
    part->name = copy_text(name, strlen(name));
    part->width = (uint32_t)width;
    part->height = (uint32_t)height;
    image_channel *channels = calloc((size_t)list->num_channels + 1, sizeof *channels);
    part->channels = channels;
    if (!part->name || !channels)
        return exr_check(report, EXR_ERR_OUT_OF_MEMORY);
    for (int c = 0; c < list->num_channels; c++) {
        const exr_attr_string_t *text = &list->entries[c].name;
        part->channel_count++;
        channels[c].name = copy_text(text->str, (size_t)text->length);
        channels[c].data = calloc((size_t)width * (size_t)height, sizeof(float));
        if (!channels[c].name || !channels[c].data)
            return exr_check(report, EXR_ERR_OUT_OF_MEMORY);
    }
    return true;
}

static bool exr_read_pixels(exr_context_t file, exr_report *report, int index,
                            const image_part *part) {
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_attr_box2i_t box;
    int32_t rows = 0;
    bool ok = exr_check(report, exr_get_data_window(file, index, &box)) &&
              exr_check(report, exr_get_scanlines_per_chunk(file, index, &rows));
    for (int32_t y = 0; ok && y < (int32_t)part->height; y += rows) {
        exr_chunk_info_t chunk;
        ok = exr_check(report, exr_read_scanline_chunk_info(file, index, box.min.y + y, &chunk)) &&
             exr_check(report, y == 0 ? exr_decoding_initialize(file, index, &chunk, &decoder)
                                      : exr_decoding_update(file, index, &chunk, &decoder));
        for (int16_t c = 0; ok && c < decoder.channel_count; c++) {
            exr_coding_channel_info_t *channel = &decoder.channels[c];
            const float *data = exr_find(part, channel->channel_name)->data;
            /* the array is ours; the type is const for those who only look */
            channel->decode_to_ptr = (uint8_t *)(uintptr_t)(data + (size_t)part->width * (size_t)y);
            channel->user_pixel_stride = (int32_t)sizeof(float);
            channel->user_line_stride = (int32_t)(part->width * sizeof(float));
            channel->user_bytes_per_element = (int16_t)sizeof(float);
            channel->user_data_type = EXR_PIXEL_FLOAT;
        }
        if (ok && y == 0) {
            ok = exr_check(report, exr_decoding_choose_default_routines(file, index, &decoder));
        }
        ok = ok && exr_check(report, exr_decoding_run(file, index, &decoder));
    }
    exr_decoding_destroy(file, &decoder);
    return ok;
}

static bool exr_read_parts(exr_context_t file, exr_report *report, image_exr *image) {
    int count = 0;
    if (!exr_check(report, exr_get_count(file, &count)))
        return false;
    image->parts = calloc((size_t)count + 1, sizeof *image->parts);
    if (!image->parts)
        return exr_check(report, EXR_ERR_OUT_OF_MEMORY);
    for (int p = 0; p < count; p++) {
        image->part_count++;
        if (!exr_read_layout(file, report, p, &image->parts[p]) ||
            !exr_read_pixels(file, report, p, &image->parts[p])) {
            return false;
        }
    }
    const exr_attribute_t *attribute = NULL;
    if (exr_get_attribute_by_name(file, 0, ATTRIBUTE, &attribute) != EXR_ERR_SUCCESS ||
        attribute->type != EXR_ATTR_STRING) {
        return true;
    }
    image->attribute = copy_text(attribute->string->str, (size_t)attribute->string->length);
    return image->attribute || exr_check(report, EXR_ERR_OUT_OF_MEMORY);
}

bool image_read_exr(const char *path, image_exr *out, char error[IMAGE_ERROR_SIZE]) {
    exr_report report = {path, error, false};
    exr_context_initializer_t setup = exr_setup();
    exr_context_t file = NULL;
    image_exr image = {0, NULL, NULL};
    bool ok = exr_check(&report, exr_start_read(&file, path, &setup)) &&
              exr_read_parts(file, &report, &image);
    if (file)
        exr_finish(&file);
    if (ok) {
        *out = image;
    } else {
        image_exr_free(&image);
    }
    return ok;
}

void image_exr_free(image_exr *image) {
    for (uint32_t p = 0; p < image->part_count; p++) {
        const image_part *part = &image->parts[p];
        for (uint32_t c = 0; c < part->channel_count; c++) {
            free((void *)(uintptr_t)part->channels[c].name);
            free((void *)(uintptr_t)part->channels[c].data);
        }
        free((void *)(uintptr_t)part->channels);
        free((void *)(uintptr_t)part->name);
    }
    free(image->parts);
    free(image->attribute);
    memset(image, 0, sizeof *image);
}

const float *image_exr_channel(const image_exr *image, const char *name, const image_part **part) {
    for (uint32_t p = 0; p < image->part_count; p++) {
        const image_channel *channel = exr_find(&image->parts[p], name);
        if (!channel)
            continue;
        if (part)
            *part = &image->parts[p];
        return channel->data;
    }
    return NULL;
}
