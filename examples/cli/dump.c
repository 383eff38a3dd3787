#include "dump.h"

#include "image.h"
#include "report.h"
#include "surface.h"
#include "vessel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- JSON ------------------------------------------------------------------------------- */

cJSON *cli_json_float(float value) {
    char text[32];
    if (!isfinite(value))
        return cJSON_CreateNull();
    cli_shortest(value, text, sizeof text);
    return cJSON_CreateRaw(text);
}

void cli_version(char text[32]) {
    snprintf(text, 32, "%d.%d.%d", LAO_VERSION / 1000000, LAO_VERSION / 1000 % 1000,
             LAO_VERSION % 1000);
}

bool cli_write_json(const char *path, cJSON *json) {
    char *text = cJSON_Print(json);
    bool ok = text != NULL || cli_fail("out of memory");
    if (ok && path)
        ok = cli_write_text(path, text);
    else if (ok)
        ok = (puts(text) >= 0 && fflush(stdout) == 0) ||
             cli_fail("standard output cannot be written");
    cJSON_free(text);
    cJSON_Delete(json);
    return ok;
}

static void add_floats(cJSON *object, const char *key, const float *values, int count) {
    cJSON *array = cJSON_AddArrayToObject(object, key);
    for (int i = 0; i < count; i++)
        cJSON_AddItemToArray(array, cli_json_float(values[i]));
}

static void add_settings(cJSON *list, const lao_module *module, const void *settings) {
    float values[64]; /* as many as `set` has bits */
    lao_settings_resolve(module, settings, values);
    for (uint32_t i = 0; i < module->setting_count; i++) {
        const lao_setting_row *row = &module->settings[i];
        char text[64];
        cli_setting_text(row, values[i], text, sizeof text);
        if (row->type == LAO_SETTING_ENUM)
            cJSON_AddStringToObject(list, row->name, text);
        else if (row->type == LAO_SETTING_BOOL)
            cJSON_AddBoolToObject(list, row->name, values[i] > 0);
        else
            cJSON_AddItemToObject(list, row->name, cli_json_float(values[i]));
    }
}

static void add_set_settings(cJSON *object, const cli_scene *scene, const cli_set *set) {
    cJSON *list = cJSON_AddObjectToObject(object, "settings");
    add_settings(list, lao_lines_module(), &set->settings);
    for (uint32_t m = 0; m < scene->module_count; m++) {
        if (set->module_settings[m])
            add_settings(list, scene->modules[m], set->module_settings[m]);
    }
}

/* What the picture shows and how; its first set's settings stand outside too, for short. */
static cJSON *describe(const cli_session *session, const cli_scene *scene, const cli_shot *shot) {
    char version[32], *camera = camera_print(&shot->camera);
    cJSON *json = cJSON_CreateObject();
    cli_version(version);
    cJSON_AddStringToObject(json, "version", version);
    cJSON_AddStringToObject(json, "backend", session->backend);
    cJSON_AddStringToObject(json, "device", cli_session_device(session));
    cJSON_AddItemToObject(
        json, "size", cJSON_CreateIntArray((const int[2]){(int)shot->width, (int)shot->height}, 2));
    cJSON_AddItemToObject(json, "camera", camera ? cJSON_CreateRaw(camera) : NULL);
    cJSON *matrices = cJSON_AddObjectToObject(json, "matrices"); /* column-major */
    add_floats(matrices, "view", shot->view, 16);
    add_floats(matrices, "projection", shot->projection, 16);
    /* matrices and sphere are for points minus this */
    cJSON_AddItemToObject(json, "origin", cJSON_CreateDoubleArray(scene->origin, 3));
    add_floats(json, "sphere", shot->sphere, 4);
    add_floats(json, "background", shot->background, 4);
    cJSON_AddItemToObject(json, "time", cli_json_float(shot->time));
    add_set_settings(json, scene, &scene->sets[0]);
    cJSON *sets = cJSON_AddArrayToObject(json, "sets");
    for (uint32_t i = 0; i < scene->count; i++) {
        const cli_set *set = &scene->sets[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, set->source->path ? "path" : "scene", set->name);
        cJSON_AddNumberToObject(item, set->object ? "segments" : "lines",
                                set->object ? set->object->item_count : set->lines.line_count);
        if (!set->object)
            cJSON_AddNumberToObject(item, "points", set->lines.point_count);
        add_set_settings(item, scene, set);
        cJSON_AddItemToArray(sets, item);
    }
    free(camera);
    return json;
}

cJSON *cli_timings(cli_session *session, const cli_shot *shot) {
    lao_timing rows[256];
    uint32_t count = sizeof rows / sizeof *rows;
    if (lao_timings(session->context, session->view, rows, &count) != LAO_OK)
        return NULL;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "backend", session->backend);
    cJSON_AddStringToObject(json, "device", cli_session_device(session));
    cJSON_AddItemToObject(
        json, "size", cJSON_CreateIntArray((const int[2]){(int)shot->width, (int)shot->height}, 2));
    cJSON_AddItemToObject(json, "frame_ms", cli_json_float((float)session->milliseconds));
    cJSON *passes = cJSON_AddArrayToObject(json, "passes");
    for (uint32_t i = 0; i < count && i < sizeof rows / sizeof *rows; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "pass", rows[i].pass);
        cJSON_AddNumberToObject(item, "set", rows[i].set);
        cJSON_AddNumberToObject(item, "level", rows[i].level);
        cJSON_AddItemToObject(item, "ms", cli_json_float((float)rows[i].milliseconds));
        cJSON_AddItemToArray(passes, item);
    }
    return json;
}

/* ---- OpenEXR ---------------------------------------------------------------------------- */

enum { PARTS = 32, CHANNELS = 32, NAME = 32 };

/* Channels under way: every one has its name, its values and the part that it belongs to. */
typedef struct plane {
    char name[NAME];
    float *values;
    const image_part *part;
} plane;

struct cli_planes {
    image_part parts[PARTS];
    char part_names[PARTS][NAME];
    image_channel channels[PARTS][CHANNELS];
    plane planes[PARTS * 4 + CHANNELS];
    uint32_t part_count, plane_count, width, height; /* of the first part */
    const char *home;                                /* the part of images of that size */
};

/* The part of that name, which may be new; or NULL: there are too many. */
static image_part *find_part(cli_planes *w, const char *name, size_t length,
                             const lao_read_info *info) {
    uint32_t i = 0;
    while (i < w->part_count &&
           (strlen(w->part_names[i]) != length || strncmp(w->part_names[i], name, length) != 0))
        i++;
    if (i == PARTS)
        return NULL;
    if (i == w->part_count) {
        snprintf(w->part_names[i], NAME, "%.*s", (int)length, name);
        w->part_count = i + 1;
        w->parts[i].width = info->width;
        w->parts[i].height = info->height;
        w->parts[i].name = w->part_names[i];
        w->parts[i].channels = w->channels[i];
    }
    return &w->parts[i];
}

/* Images of another size are parts named after the image. */
static image_part *part_of(cli_planes *w, const char *channel, const lao_read_info *info) {
    if (info->width == w->width && info->height == w->height)
        return find_part(w, w->home, strlen(w->home), info);
    return find_part(w, channel, strcspn(channel, "."), info);
}

/* "axial%d.C" with the level in place. */
static void channel_name(const char *pattern, uint32_t level, char name[NAME]) {
    const char *digit = strstr(pattern, "%d");
    if (digit)
        snprintf(name, NAME, "%.*s%u%s", (int)(digit - pattern), pattern, level, digit + 2);
    else
        snprintf(name, NAME, "%s", pattern);
}

/* Room for a channel's values. NULL: reported. */
static float *add_plane(cli_planes *w, const char *name, const lao_read_info *info) {
    image_part *part = part_of(w, name, info);
    if (!part || part->channel_count == CHANNELS ||
        w->plane_count == sizeof w->planes / sizeof *w->planes) {
        cli_fail("%s: too many channels for one file", name);
        return NULL;
    }
    plane *p = &w->planes[w->plane_count];
    p->values = cli_new((size_t)info->width * info->height, sizeof *p->values);
    if (!p->values)
        return NULL;
    w->plane_count++;
    p->part = part;
    snprintf(p->name, NAME, "%s", name);
    image_channel *out = &w->channels[part - w->parts][part->channel_count++];
    out->name = p->name;
    out->data = p->values;
    return p->values;
}

static bool add_channel(cli_planes *w, const char *name, const float *data, uint32_t channel,
                        const lao_read_info *info) {
    float *values = add_plane(w, name, info);
    for (size_t i = 0; values && i < (size_t)info->width * info->height; i++)
        values[i] = data[i * info->channels + channel];
    return values != NULL;
}

static bool add_image(cli_planes *w, cli_session *session, const lao_image_row *row) {
    bool ok = true;
    for (uint32_t level = 0; ok; level++) {
        lao_read_info info;
        float *data = cli_session_image(session, row->name, level, &info);
        if (!data)
            return info.width == 0; /* the plan has no such image or level */
        size_t texels = (size_t)info.width * info.height * info.channels;
        for (uint32_t c = 0; ok && c < 4 && c < info.channels; c++) {
            char name[NAME];
            if (!row->channels[c])
                continue;
            channel_name(row->channels[c], level, name);
            for (size_t i = c; strcmp(name, "mask.V") == 0 && i < texels; i += info.channels)
                data[i] = data[i] >= 0.5f ? 1.0f : 0.0f; /* halos keep their light there too */
            ok = add_channel(w, name, data, c, &info);
        }
        free(data);
    }
    return false;
}

static bool add_module(cli_planes *w, cli_session *session, const lao_module *module,
                       bool picture_alone) {
    for (uint32_t i = 0; i < module->image_count; i++) {
        const lao_image_row *row = &module->images[i];
        if (row->channels[0] && (!picture_alone || strcmp(row->name, "out") == 0) &&
            !add_image(w, session, row))
            return false;
    }
    return true;
}

/* The part of a module whose objects stand among others. */
static bool add_objects(cli_planes *w, cli_session *session, const cli_scene *scene) {
    bool ok = true;
    for (uint32_t m = 0; ok && m < scene->module_count; m++) {
        const cli_object *last = NULL;
        bool trees = scene->modules[m] == sdv_module();
        cli_planes_use(w, scene->modules[m]->name);
        ok = add_module(w, session, scene->modules[m], false);
        for (uint32_t i = 0; i < scene->object_count; i++) {
            if (trees ? scene->objects[i]->tree != NULL : scene->objects[i]->wall != NULL)
                last = scene->objects[i];
        }
        if (ok && last)
            ok = trees ? cli_tree_planes(last->tree, w) : cli_wall_planes(last->wall, w);
    }
    cli_planes_use(w, NULL);
    return ok;
}

static bool add_images(cli_planes *w, cli_session *session, const cli_scene *scene,
                       const cli_shot *shot) {
    uint32_t factor = (uint32_t)lao_settings_filled(&scene->sets[0].settings).supersampling;
    bool alone = scene->module_count > 0 && scene->object_count == 0;
    w->width = (shot->width + 2 * shot->margin) * factor;
    w->height = (shot->height + 2 * shot->margin) * factor;
    cli_planes_use(w, NULL);
    return (!alone || add_module(w, session, scene->modules[0], false)) &&
           add_module(w, session, lao_lines_module(), alone) &&
           (alone || add_objects(w, session, scene));
}

void cli_planes_use(cli_planes *planes, const char *part) {
    planes->home = part ? part : "full";
}

float *cli_planes_find(cli_planes *planes, const char *name, size_t *count) {
    *count = (size_t)planes->width * planes->height;
    for (uint32_t i = 0; i < planes->plane_count; i++) {
        if (strcmp(planes->planes[i].name, name) == 0 &&
            strcmp(planes->planes[i].part->name, planes->home) == 0)
            return planes->planes[i].values;
    }
    return NULL;
}

float *cli_planes_add(cli_planes *planes, const char *name) {
    const lao_read_info info = {.width = planes->width, .height = planes->height};
    return add_plane(planes, name, &info);
}

bool cli_dump(const char *path, cli_session *session, const cli_scene *scene, const cli_shot *shot,
              cli_planes_edit edit, void *user) {
    char error[IMAGE_ERROR_SIZE];
    cli_planes *w = calloc(1, sizeof *w);
    cJSON *json = describe(session, scene, shot);
    char *text = cJSON_PrintUnformatted(json);
    bool ok = w && text;
    if (!ok)
        cli_fail("out of memory");
    ok = ok && add_images(w, session, scene, shot) && (!edit || edit(user, w));
    if (ok && !image_write_exr(path, w->parts, w->part_count, text, error))
        ok = cli_fail("%s", error);
    for (uint32_t i = 0; w && i < w->plane_count; i++)
        free(w->planes[i].values);
    cJSON_free(text);
    cJSON_Delete(json);
    free(w);
    return ok;
}
