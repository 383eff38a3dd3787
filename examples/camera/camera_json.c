#include "camera.h"

#include "image_file.h"

#include <cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool fail(char *error, const char *name, const char *text) {
    if (error) {
        size_t length = strlen(name), room = 120;
        const char *tail = length > room ? name + length - room : name;
        snprintf(error, CAMERA_ERROR_SIZE, "%s%s: %.120s", tail == name ? "" : "...", tail, text);
    }
    return false;
}

/* ---- reading ---------------------------------------------------------------------------- */

static bool get_vector(const cJSON *object, const char *key, double out[3]) {
    const cJSON *array = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) != 3)
        return false;
    for (int i = 0; i < 3; i++) {
        const cJSON *item = cJSON_GetArrayItem(array, i);
        if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
            return false;
        out[i] = item->valuedouble;
    }
    return true;
}

/* What is wrong with a camera's object and how to mend it, or NULL. */
static const char *get_camera(const cJSON *object, camera_pose *out) {
    if (!cJSON_IsObject(object))
        return "not a camera; write {\"eye\":[x,y,z], ...}";
    if (!get_vector(object, "eye", out->eye))
        return "no \"eye\"; write \"eye\":[x,y,z] in mm";
    if (!get_vector(object, "center", out->center)) {
        return "no \"center\"; write \"center\":[x,y,z] in mm";
    }
    if (!get_vector(object, "up", out->up))
        return "no \"up\"; write \"up\":[0,0,1]";
    const cJSON *fovy = cJSON_GetObjectItemCaseSensitive(object, "fovy");
    const cJSON *height = cJSON_GetObjectItemCaseSensitive(object, "ortho_height");
    if (!fovy == !height)
        return "write either \"fovy\":degrees or \"ortho_height\":mm";
    out->fovy = fovy ? fovy->valuedouble : 0.0;
    out->ortho_height = height ? height->valuedouble : 0.0;
    if (fovy && !(cJSON_IsNumber(fovy) && out->fovy > 0.0 && out->fovy < 180.0)) {
        return "\"fovy\" is not an angle; write degrees between 0 and 180";
    }
    if (height &&
        !(cJSON_IsNumber(height) && out->ortho_height > 0.0 && isfinite(out->ortho_height))) {
        return "\"ortho_height\" is not a size; write mm above 0";
    }

    double d[3], far = 0.0, up = 0.0, along = 0.0;
    for (int i = 0; i < 3; i++) {
        d[i] = out->center[i] - out->eye[i];
        far += d[i] * d[i];
        up += out->up[i] * out->up[i];
        along += d[i] * out->up[i];
    }
    if (!(far > 0.0))
        return "\"eye\" and \"center\" are the same point; move the eye";
    if (!(up > 0.0))
        return "\"up\" is zero; write \"up\":[0,0,1]";
    /* the sine of the angle between them, squared */
    if (1.0 - along * along / (far * up) < 1e-10)
        return "\"up\" points along the view; turn it";
    return NULL;
}

/* Parses, or says in which line the text stops being JSON. */
static cJSON *parse(const char *name, const char *text, char *error) {
    const char *end = NULL;
    cJSON *root = cJSON_ParseWithOpts(text, &end, 1);
    if (root)
        return root;
    int line = 1;
    for (const char *c = text; end && c < end && *c; c++)
        line += *c == '\n';
    char why[80];
    snprintf(why, sizeof why, "line %d is not JSON; mend it or write the camera anew", line);
    fail(error, name, why);
    return NULL;
}

bool camera_parse(const char *name, const char *text, camera_pose *out,
                  char error[CAMERA_ERROR_SIZE]) {
    cJSON *root = parse(name, text, error);
    if (!root)
        return false;
    camera_pose read;
    const char *fault = get_camera(root, &read);
    cJSON_Delete(root);
    if (fault)
        return fail(error, name, fault);
    *out = read;
    return true;
}

/* The whole file as a string for free(); a camera file beyond 64 MiB is none. */
static char *read_text(const char *path, char *error) {
    FILE *file = fopen(path, "rb");
    if (!file) {
        fail(error, path, strerror(errno));
        return NULL;
    }
    char *text = NULL;
    size_t size = 0, room = 4096, got;
    const char *fault = NULL;
    do {
        char *grown = realloc(text, room + 1);
        if (!grown) {
            fault = "out of memory";
            break;
        }
        text = grown;
        errno = 0;
        got = fread(text + size, 1, room - size, file);
        size += got;
        text[size] = 0;
        if (size == room)
            room *= 4;
        if (room > (size_t)1 << 26)
            fault = "too large for a camera";
    } while (got > 0 && !fault);
    if (!fault && ferror(file))
        fault = strerror(errno);
    if (!fault && strlen(text) != size)
        fault = "not a text; a camera is a JSON file";
    fclose(file);
    if (!fault)
        return text;
    fail(error, path, fault);
    free(text);
    return NULL;
}

bool camera_read(const char *path, camera_pose *out, char error[CAMERA_ERROR_SIZE]) {
    char *text = read_text(path, error);
    bool ok = text && camera_parse(path, text, out, error);
    free(text);
    return ok;
}

bool camera_read_all(const char *path, camera_pose **out, uint32_t *count,
                     char error[CAMERA_ERROR_SIZE]) {
    char *text = read_text(path, error);
    cJSON *root = text ? parse(path, text, error) : NULL;
    free(text);
    if (!root)
        return false;
    bool array = cJSON_IsArray(root);
    int total = array ? cJSON_GetArraySize(root) : 1, done = 0;
    camera_pose *cameras = calloc((size_t)total + 1, sizeof *cameras);
    const char *fault = !cameras ? "out of memory"
                        : total  ? NULL
                                 : "no camera in the array; add one";
    const cJSON *item = array ? root->child : root;
    for (; !fault && done < total; item = item->next)
        fault = get_camera(item, &cameras[done++]);
    cJSON_Delete(root);
    if (fault) {
        char why[160];
        snprintf(why, sizeof why, "camera %d: %s", done - 1, fault);
        free(cameras);
        return fail(error, path, array && done ? why : fault);
    }
    *out = cameras;
    *count = (uint32_t)total;
    return true;
}

/* ---- writing ---------------------------------------------------------------------------- */

/* The shortest text that reads back as the same bits. */
static const char *number(double value, char text[32]) {
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    return text;
}

char *camera_print(const camera_pose *camera) {
    enum { SIZE = 512 };
    const double *const vectors[3] = {camera->eye, camera->center, camera->up};
    static const char *const keys[3] = {"eye", "center", "up"};
    char *text = malloc(SIZE), x[32], y[32], z[32];
    if (!text)
        return NULL;
    size_t used = 0;
    for (int i = 0; i < 3; i++) {
        const double *v = vectors[i];
        used += (size_t)snprintf(text + used, SIZE - used, "%s\"%s\":[%s,%s,%s]", i ? "," : "{",
                                 keys[i], number(v[0], x), number(v[1], y), number(v[2], z));
    }
    bool perspective = camera->fovy > 0.0;
    snprintf(text + used, SIZE - used, ",\"%s\":%s}", perspective ? "fovy" : "ortho_height",
             number(perspective ? camera->fovy : camera->ortho_height, x));
    return text;
}

static bool put_cameras(FILE *file, const camera_pose *cameras, uint32_t count) {
    bool ok = count == 1 || fputs("[", file) >= 0;
    for (uint32_t i = 0; ok && i < count; i++) {
        char *text = camera_print(&cameras[i]);
        ok = text && fprintf(file, "%s%s", i ? ",\n" : "", text) > 0;
        free(text);
    }
    return ok && fputs(count == 1 ? "\n" : "]\n", file) >= 0;
}

bool camera_write_all(const char *path, const camera_pose *cameras, uint32_t count,
                      char error[CAMERA_ERROR_SIZE]) {
    char *temp = image_temp_create(path, error);
    if (!temp)
        return false;
    errno = ENOMEM; /* unless the file has another reason */
    FILE *file = fopen(temp, "w");
    bool ok = file && put_cameras(file, cameras, count);
    int code = errno;
    if (file && fclose(file) != 0 && ok) {
        ok = false;
        code = errno;
    }
    if (!ok)
        fail(error, path, strerror(code));
    return image_temp_finish(temp, path, ok, error);
}

bool camera_write(const char *path, const camera_pose *camera, char error[CAMERA_ERROR_SIZE]) {
    return camera_write_all(path, camera, 1, error);
}
