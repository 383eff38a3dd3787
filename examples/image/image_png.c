#include "image.h"
#include "image_file.h"

#include <errno.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

static png_image png_describe(uint32_t width, uint32_t height, int channels) {
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
    return image;
}

bool image_write_png(const char *path, uint32_t width, uint32_t height, const uint8_t *pixels,
                     int channels, char error[IMAGE_ERROR_SIZE]) {
    if (channels != 3 && channels != 4)
        return image_fail(error, path, "PNG wants 3 or 4 channels");
    char *temp = image_temp_create(path, error);
    if (!temp)
        return false;

    png_image image = png_describe(width, height, channels);
    FILE *file = fopen(temp, "wb");
    bool ok = file && png_image_write_to_stdio(&image, file, 0, pixels, 0, NULL);
    const char *reason = image.message[0] ? image.message : strerror(errno);
    if (!ok)
        image_fail(error, path, reason);
    /* fclose reports what the buffered writes could not: a full disk */
    if (file && fclose(file) != 0 && ok)
        ok = image_fail(error, path, strerror(errno));
    return image_temp_finish(temp, path, ok, error);
}

bool image_read_png(const char *path, int channels, uint32_t *width, uint32_t *height,
                    uint8_t **pixels, char error[IMAGE_ERROR_SIZE]) {
    if (channels != 3 && channels != 4)
        return image_fail(error, path, "PNG wants 3 or 4 channels");
    png_image image = png_describe(0, 0, channels);
    if (!png_image_begin_read_from_file(&image, path)) {
        return image_fail(error, path, image.message);
    }
    image.format = channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
    uint8_t *data = malloc(PNG_IMAGE_SIZE(image));
    bool ok = data && png_image_finish_read(&image, NULL, data, 0, NULL);
    if (!ok)
        image_fail(error, path, data ? image.message : "out of memory");
    png_image_free(&image);
    if (!ok) {
        free(data);
        return false;
    }
    *width = image.width;
    *height = image.height;
    *pixels = data;
    return true;
}
