/* Any text, read as a setting's value or as a camera, ends in a value inside its range or in an
 * error with a text. */
#include "camera.h"
#include "lineao.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void read_settings(const char *text) {
    const lao_module *module = lao_lines_module();
    for (uint32_t i = 0; i < module->setting_count; i++) {
        float values[64];
        lao_settings settings;
        memset(&settings, 0, sizeof settings);
        if (lao_setting_parse(module, (int)i, text, &settings) == 0) {
            if (lao_settings_resolve(module, &settings, values) >= 0 ||
                !((settings.set >> i) & 1)) {
                abort(); /* accepted, but not a legal value */
            }
        } else if (settings.set != 0) {
            abort(); /* refused, but written */
        }
    }
}

static void read_camera(const char *text) {
    char error[CAMERA_ERROR_SIZE] = "";
    camera_pose pose;
    if (camera_parse("camera", text, &pose, error)) {
        char *printed = camera_print(&pose);
        camera_pose again;
        if (printed && !camera_parse("camera", printed, &again, error)) {
            abort(); /* its own text does not read back */
        }
        free(printed);
    } else if (!*error) {
        abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *text = malloc(size + 1);
    if (!text) {
        return 0;
    }
    memcpy(text, data, size);
    text[size] = 0;
    read_settings(text);
    read_camera(text);
    free(text);
    return 0;
}
