/* lineao compare: the same frame by OpenGL and Vulkan, image by image, bit by bit. */
#include "commands.h"
#include "dump.h"
#include "report.h"
#include "session.h"
#include "sheet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHEET_COLUMNS = 3, WIDEST = 480 };

typedef struct comparison {
    cli_session gl, vk;
    cli_sheet sheet;
    bool draw; /* a sheet is wanted */
    cJSON *images;
    uint64_t differing_bits;
    uint32_t differing_images, count;
} comparison;

/* ---- pictures of images ----------------------------------------------------------------- */

/* Least and greatest finite value of both, of the channels that are shown. */
static void find_range(const float *a, const float *b, const lao_read_info *info, float range[2]) {
    size_t count = (size_t)info->width * info->height * info->channels;
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const float values[2] = {a[i], b[i]};
        for (int k = 0; k < 2 && i % info->channels < 3; k++) {
            range[0] = isfinite(values[k]) ? fminf(range[0], values[k]) : range[0];
            range[1] = isfinite(values[k]) ? fmaxf(range[1], values[k]) : range[1];
        }
    }
    if (!(range[0] < range[1])) {
        range[0] = 0;
        range[1] = 1;
    }
}

/* Up to three channels as RGB (one: grey) over the range. */
static void to_picture(const float *data, const lao_read_info *info, const float range[2],
                       uint8_t *out) {
    size_t count = (size_t)info->width * info->height;
    for (size_t i = 0; i < 4 * count; i++) {
        uint32_t c = (uint32_t)(i % 4);
        float v = info->channels == 1  ? data[i / 4]
                  : c < info->channels ? data[i / 4 * info->channels + c]
                                       : range[0];
        v = (v - range[0]) / (range[1] - range[0]);
        out[i] = c == 3 ? 255 : (uint8_t)roundf(255 * (v > 0 ? fminf(v, 1) : 0));
    }
}

/* Black where all bits agree, else the difference 16 times, never darker than a quarter. */
static void difference(const uint8_t *a, const uint8_t *b, const float *x, const float *y,
                       const lao_read_info *raw, const lao_read_info *info, const float range[2],
                       uint8_t *out) {
    size_t count = (size_t)info->width * info->height;
    for (size_t i = 0; i < count; i++) {
        uint32_t row = (uint32_t)(i / info->width), flipped = info->height - 1 - row;
        size_t texel = ((size_t)flipped * info->width + i % info->width) * raw->channels;
        bool differs = memcmp(a + texel, b + texel, raw->channels) != 0;
        for (uint32_t c = 0; c < 3; c++) {
            size_t at = i * info->channels + (c < info->channels ? c : info->channels - 1);
            float d = 16 * fabsf(x[at] - y[at]) / (range[1] - range[0]);
            out[4 * i + c] = (uint8_t)(!differs ? 0 : 255 * fminf(d > 0.25f ? d : 0.25f, 1));
        }
        out[4 * i + 3] = 255;
    }
}

static bool draw_row(comparison *c, const char *label, const char *name, uint32_t level,
                     const uint8_t *a, const uint8_t *b, const lao_read_info *raw) {
    lao_read_info info;
    float range[2];
    float *x = cli_session_image(&c->gl, name, level, &info);
    float *y = x ? cli_session_image(&c->vk, name, level, &info) : NULL;
    bool ok = x && y;
    if (ok)
        find_range(x, y, &info, range);
    for (uint32_t i = 0; ok && i < SHEET_COLUMNS; i++) {
        sheet_cell cell;
        memset(&cell, 0, sizeof cell);
        snprintf(cell.heading, sizeof cell.heading, "%s", label);
        ok = picture_make(info.width, info.height, &cell.image) || cli_fail("out of memory");
        if (ok && i < 2)
            to_picture(i ? y : x, &info, range, cell.image.pixels);
        else if (ok)
            difference(a, b, x, y, raw, &info, range, cell.image.pixels);
        if (ok && !sheet_shrink(&cell.image, WIDEST, i == 2)) {
            picture_free(&cell.image);
            ok = false;
        }
        ok = ok && sheet_add(&c->sheet, cell);
    }
    free(x);
    free(y);
    return ok;
}

/* ---- counting --------------------------------------------------------------------------- */

static uint64_t count_bits(const uint8_t *a, const uint8_t *b, size_t texels, size_t bytes,
                           uint64_t *differing_texels) {
    uint64_t bits = 0;
    *differing_texels = 0;
    for (size_t i = 0; i < texels; i++) {
        *differing_texels += memcmp(a + i * bytes, b + i * bytes, bytes) != 0;
        for (size_t k = i * bytes; k < (i + 1) * bytes; k++) {
            for (unsigned x = a[k] ^ b[k]; x; x &= x - 1)
                bits++;
        }
    }
    return bits;
}

static void note(comparison *c, const char *name, uint32_t level, const lao_read_info *info,
                 uint64_t bits, uint64_t texels) {
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "name", name);
    cJSON_AddNumberToObject(item, "level", level);
    cJSON_AddNumberToObject(item, "width", info->width);
    cJSON_AddNumberToObject(item, "height", info->height);
    cJSON_AddNumberToObject(item, "differing_bits", (double)bits);
    cJSON_AddNumberToObject(item, "differing_texels", (double)texels);
    cJSON_AddItemToArray(c->images, item);
    c->differing_bits += bits;
    c->differing_images += bits > 0;
    c->count++;
}

/* One level of one image. *there: does the plan have it? False: reported. */
static bool compare_level(comparison *c, const char *name, uint32_t level, bool *there) {
    lao_read_info info, other;
    uint8_t *a = cli_session_texels(&c->gl, name, level, &info);
    uint8_t *b = cli_session_texels(&c->vk, name, level, &other);
    bool ok = (a || !info.width) && (b || !other.width);
    *there = a || b;
    if (ok && !a != !b)
        ok = cli_fail("compare: only one backend has the image %s %u", name, level);
    if (ok && a && (info.width != other.width || info.height != other.height))
        ok = cli_fail("compare: the backends differ in the size of the image %s %u", name, level);
    if (ok && a) {
        char label[80];
        uint64_t texels,
            bits = count_bits(a, b, (size_t)info.width * info.height, info.channels, &texels);
        note(c, name, level, &info, bits, texels);
        snprintf(label, sizeof label, "%s %u: %ux%u, %llu bits differ", name, level, info.width,
                 info.height, (unsigned long long)bits);
        ok = !c->draw || draw_row(c, label, name, level, a, b, &info);
    }
    free(a);
    free(b);
    return ok;
}

static bool compare_image(comparison *c, const lao_image_row *row) {
    bool there = !(row->flags & LAO_IMAGE_IMPORT), ok = true;
    for (uint32_t level = 0; there && ok; level++)
        ok = cli_go_on() && compare_level(c, row->name, level, &there);
    return ok;
}

/* The picture first, then the images in order of the tables. */
static bool compare_images(comparison *c, const cli_scene *scene) {
    bool ok = true;
    for (uint32_t m = 0; m < 2 + scene->module_count; m++) {
        const lao_module *module = m < 2 ? lao_lines_module() : scene->modules[m - 2];
        for (uint32_t i = 0; ok && i < module->image_count; i++) {
            bool is_out = strcmp(module->images[i].name, "out") == 0;
            if (is_out == (m == 0))
                ok = compare_image(c, &module->images[i]);
        }
    }
    return ok;
}

/* ---- command ---------------------------------------------------------------------------- */

static bool report(const cli_options *options, comparison *c) {
    static const char *const titles[SHEET_COLUMNS] = {"GL", "VK", "difference x 16"};
    c->sheet.columns = SHEET_COLUMNS;
    c->sheet.titles = titles;
    if (c->draw && !sheet_write(&c->sheet, options->out))
        return false;
    if (options->json) {
        cJSON *json = cJSON_CreateObject();
        cJSON_AddItemToObject(json, "images", c->images);
        c->images = NULL;
        cJSON_AddBoolToObject(json, "equal", c->differing_bits == 0);
        return cli_write_json(NULL, json);
    }
    printf("%-16s %5s %6s %6s %14s %16s\n", "image", "level", "width", "height", "differing bits",
           "differing texels");
    for (const cJSON *i = c->images->child; i; i = i->next) {
        printf("%-16s %5d %6d %6d %14.0f %16.0f\n", cJSON_GetObjectItem(i, "name")->valuestring,
               cJSON_GetObjectItem(i, "level")->valueint, cJSON_GetObjectItem(i, "width")->valueint,
               cJSON_GetObjectItem(i, "height")->valueint,
               cJSON_GetObjectItem(i, "differing_bits")->valuedouble,
               cJSON_GetObjectItem(i, "differing_texels")->valuedouble);
    }
    return fflush(stdout) == 0 || cli_fail("standard output cannot be written");
}

static bool compare(const cli_options *options, const cli_scene *scene, comparison *c) {
    cli_shot shot;
    bool ok = cli_shot_make(options, scene, &shot) &&
              cli_session_open(&c->gl, "gl", scene, &shot, LAO_VIEW_KEEP_IMAGES) &&
              cli_session_open(&c->vk, "vk", scene, &shot, LAO_VIEW_KEEP_IMAGES) &&
              cli_session_render(&c->gl, &shot, 0) && cli_session_render(&c->vk, &shot, 0) &&
              compare_images(c, scene) && report(options, c);
    cli_session_close(&c->vk);
    cli_session_close(&c->gl);
    return ok;
}

int cli_compare(const cli_options *options) {
    cli_scene scene;
    comparison c;
    if (!cli_writable(options->out) || !cli_scene_load(options, &scene))
        return CLI_FAILED;
    memset(&c, 0, sizeof c);
    c.draw = options->out != NULL;
    c.images = cJSON_CreateArray();
    bool ok = c.images ? compare(options, &scene, &c) : cli_fail("out of memory");
    if (ok && c.differing_bits > 0) {
        ok = cli_fail("compare: %llu bits differ in %u of %u images; the bound is 0",
                      (unsigned long long)c.differing_bits, c.differing_images, c.count);
    }
    if (ok)
        cli_scene_warn(&scene);
    cJSON_Delete(c.images);
    sheet_free(&c.sheet);
    cli_scene_free(&scene);
    return ok ? CLI_OK : CLI_FAILED;
}
