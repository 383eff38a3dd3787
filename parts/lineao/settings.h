/* ================================================================================================
 * settings: what settings are worth, by preset, default and range, and their text; then cameras, of
   whatever convention, made canonical. Uses tables and host. */

/* ---- settings */

int lao_setting_find(const lao_module *module, const char *name) {
    uint32_t i;
    for (i = 0; module && name && i < module->setting_count; i++) {
        if (strcmp(module->settings[i].name, name) == 0) {
            return (int)i;
        }
    }
    return -1;
}

/* Position of `word` (length n) in "a|b|c", or -1. */
static int lao__choice(const char *choices, const char *word, size_t n) {
    int index = 0;
    const char *c = choices;
    while (*c) {
        size_t length = strcspn(c, "|");
        if (length == n && strncmp(c, word, n) == 0) {
            return index;
        }
        c += length;
        if (*c) {
            c++;
        }
        index++;
    }
    return -1;
}

static const float *lao__settings_values(const void *settings) {
    return (const float *)(const void *)((const char *)settings + sizeof(uint64_t));
}

static int lao__setting_given(const void *settings, uint32_t index) {
    uint64_t set;
    if (!settings) {
        return 0;
    }
    memcpy(&set, settings, sizeof set);
    return ((set >> index) & 1) != 0 || lao__settings_values(settings)[index] != 0.0f;
}

static int lao__setting_valid(const lao_setting_row *row, float value) {
    if (!(value >= row->minimum && value <= row->maximum)) {
        return 0;
    }
    return row->type == LAO_SETTING_FLOAT || value == floorf(value);
}

int lao_settings_resolve(const lao_module *module, const void *settings, float *values) {
    uint32_t i;
    int fault = -1;
    int preset = lao_setting_find(module, "preset");
    for (i = 0; i < module->setting_count; i++) {
        values[i] = module->settings[i].standard;
    }
    if (preset >= 0 && lao__setting_given(settings, (uint32_t)preset)) {
        float wanted = lao__settings_values(settings)[preset];
        for (i = 0; i < module->preset_count; i++) {
            const lao_preset_row *row = &module->presets[i];
            if ((float)lao__choice(module->settings[preset].choices, row->preset,
                                   strlen(row->preset)) == wanted) {
                values[lao_setting_find(module, row->setting)] = row->value;
            }
        }
    }
    for (i = 0; i < module->setting_count; i++) {
        if (lao__setting_given(settings, i)) {
            values[i] = lao__settings_values(settings)[i];
        }
        if (fault < 0 && !lao__setting_valid(&module->settings[i], values[i])) {
            fault = (int)i;
        }
    }
    return fault;
}

lao_settings lao_settings_filled(const lao_settings *settings) {
    lao_settings filled;
    float values[LAO_SETTING_COUNT];
    lao_settings_resolve(&lao__lines_module, settings, values);
    filled.set = ((uint64_t)1 << LAO_SETTING_COUNT) - 1;
    memcpy((char *)&filled + sizeof filled.set, values, sizeof values);
    return filled;
}

/* A decimal number without the locale's help: [+-]digits[.digits][e[+-]digits]. Returns the end, or
 * NULL. */
static const char *lao__number(const char *text, double *value) {
    double sign = 1, mantissa = 0, scale = 1;
    int exponent = 0, exponent_sign = 1, digits = 0;
    if (*text == '+' || *text == '-') {
        sign = *text++ == '-' ? -1 : 1;
    }
    for (; *text >= '0' && *text <= '9'; text++, digits++) {
        mantissa = mantissa * 10 + (*text - '0');
    }
    if (*text == '.') {
        for (text++; *text >= '0' && *text <= '9'; text++, digits++) {
            scale /= 10;
            mantissa += scale * (*text - '0');
        }
    }
    if (digits && (*text == 'e' || *text == 'E')) {
        text++;
        if (*text == '+' || *text == '-') {
            exponent_sign = *text++ == '-' ? -1 : 1;
        }
        digits = 0;
        for (; *text >= '0' && *text <= '9' && exponent < 1000; text++, digits++) {
            exponent = exponent * 10 + (*text - '0');
        }
    }
    *value = sign * mantissa * pow(10.0, (double)(exponent_sign * exponent));
    return digits ? text : NULL;
}

int lao_setting_parse(const lao_module *module, int setting, const char *text, void *settings) {
    const lao_setting_row *row;
    double number = 0;
    float value;
    uint64_t set;
    int choice;
    const char *end;
    if (!module || setting < 0 || (uint32_t)setting >= module->setting_count || !text ||
        !settings) {
        return -1;
    }
    row = &module->settings[setting];
    choice = row->type == LAO_SETTING_ENUM ? lao__choice(row->choices, text, strlen(text)) : -1;
    if (row->type == LAO_SETTING_BOOL) {
        choice = lao__choice("false|true", text, strlen(text));
        choice = choice < 0 ? lao__choice("off|on", text, strlen(text)) : choice;
        choice = choice < 0 ? lao__choice("no|yes", text, strlen(text)) : choice;
    }
    if (choice >= 0) {
        value = (float)choice;
    } else {
        end = lao__number(text, &number);
        if (!end || *end) {
            return -1;
        }
        value = (float)number;
    }
    if (!lao__setting_valid(row, value)) {
        return -1;
    }
    memcpy((char *)settings + sizeof set + (size_t)setting * sizeof value, &value, sizeof value);
    memcpy(&set, settings, sizeof set);
    set |= (uint64_t)1 << setting;
    memcpy(settings, &set, sizeof set);
    return 0;
}

/* ---- camera */

static double lao__determinant3(const double m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

int lao_camera_canonical(const lao_camera *camera, lao_camera *canonical) {
    double p[4][4], v[4][4], linear[3][3]; /* [row][column] */
    int r, c;
    if (!lao__finite(camera->view, 16) || !lao__finite(camera->projection, 16)) {
        return -1;
    }
    for (r = 0; r < 4; r++) {
        for (c = 0; c < 4; c++) {
            p[r][c] = camera->projection[c * 4 + r];
            v[r][c] = camera->view[c * 4 + r];
        }
    }
    /* The shaders' view rays know no shear: rows (a 0 b 0), (0 d e 0), (0 0 g h), (0 0 +-1 0), or
       (a 0 0 c), (0 d 0 f), (0 0 g h), (0 0 0 1). */
    if (p[0][1] != 0 || p[1][0] != 0 || p[2][0] != 0 || p[2][1] != 0 || p[3][0] != 0 ||
        p[3][1] != 0 || p[0][p[3][2] == 0 ? 2 : 3] != 0 || p[1][p[3][2] == 0 ? 2 : 3] != 0 ||
        (p[3][2] == 0) == (p[3][3] == 0) || p[0][0] == 0 || p[1][1] == 0 ||
        p[2][2] * p[3][3] == p[2][3] * p[3][2]) {
        return -1;
    }
    for (c = 0; c < 4; c++) {
        if (camera->flags & LAO_CAMERA_FLIP_Y) {
            p[1][c] = -p[1][c];
        }
        if (!(camera->flags & LAO_CAMERA_ZERO_TO_ONE)) {
            p[2][c] = 0.5 * (p[2][c] + p[3][c]);
        }
    }
    /* Left-handed: the eye looks along +z. Turn z round in both matrices. For an orthographic
       projection the sign of the depth row tells: unreversed depth must grow along -z. */
    {
        int reverse = (camera->flags & LAO_CAMERA_REVERSE_DEPTH) != 0;
        int left = p[3][2] != 0 ? p[3][2] > 0 : ((p[2][2] / p[3][3] > 0) != reverse);
        double w = p[3][2] != 0 ? fabs(p[3][2]) : p[3][3];
        for (r = 0; r < 4; r++) {
            if (left) {
                p[r][2] = -p[r][2];
                v[2][r] = -v[2][r];
            }
        }
        for (r = 0; r < 4; r++) {
            for (c = 0; c < 4; c++) {
                p[r][c] /= w;
            }
        }
    }
    for (r = 0; r < 3; r++) {
        for (c = 0; c < 3; c++) {
            linear[r][c] = v[r][c];
        }
    }
    if (!(fabs(lao__determinant3((const double(*)[3])linear)) > 1e-30) || v[3][0] != 0 ||
        v[3][1] != 0 || v[3][2] != 0 || v[3][3] != 1) {
        return -1;
    }
    for (r = 0; r < 4; r++) {
        for (c = 0; c < 4; c++) {
            canonical->projection[c * 4 + r] = (float)p[r][c];
            canonical->view[c * 4 + r] = (float)v[r][c];
        }
    }
    canonical->flags = LAO_CAMERA_ZERO_TO_ONE | (camera->flags & LAO_CAMERA_REVERSE_DEPTH);
    return 0;
}
