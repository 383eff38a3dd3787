/* Widgets out of the settings tables: a range, a unit and a help live there and nowhere else. */
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A range that spans decades, or has no end worth a slider, is dragged instead. */
static bool edit_number(const lao_setting_row *row, float *value) {
    float span = row->maximum - row->minimum;
    char format[32];
    snprintf(format, sizeof format, row->type == LAO_SETTING_INT ? "%%.0f %s" : "%%.4g %s",
             strcmp(row->unit, "%") == 0 ? "%%" : row->unit);
    if (span <= 100)
        return ui_slider("##value", value, row->minimum, row->maximum, format);
    float speed = row->type == LAO_SETTING_INT ? 0.2f : fmaxf(fabsf(*value), 1e-3f) * 0.01f;
    return ui_drag("##value", value, speed, row->minimum, row->maximum, format);
}

bool panel_edit(const lao_setting_row *row, float *value) {
    bool on = *value > 0;
    int chosen = (int)*value;
    ui_width(-1);
    switch (row->type) {
    case LAO_SETTING_BOOL:
        if (!ui_toggle("##value", &on))
            return false;
        *value = on ? 1.0f : 0.0f;
        return true;
    case LAO_SETTING_ENUM:
        if (!ui_combo("##value", &chosen, row->choices))
            return false;
        *value = (float)chosen;
        return true;
    default:
        return edit_number(row, value);
    }
}

void panel_explain(const lao_setting_row *row) {
    char text[512], low[32], high[32], standard[64];
    cli_shortest(row->minimum, low, sizeof low);
    cli_shortest(row->maximum, high, sizeof high);
    cli_setting_text(row, row->standard, standard, sizeof standard);
    if (row->type == LAO_SETTING_FLOAT || row->type == LAO_SETTING_INT)
        snprintf(text, sizeof text, "%s: %s\n%s .. %s %s, default %s", row->name, row->help, low,
                 high, row->unit, standard);
    else
        snprintf(text, sizeof text, "%s: %s\ndefault %s", row->name, row->help, standard);
    ui_help(text);
}

/* "align_intensity" as "align intensity" */
static void label_of(const lao_setting_row *row, char label[64]) {
    snprintf(label, 64, "%s", row->name);
    for (char *c = label; *c; c++)
        *c = *c == '_' ? ' ' : *c;
}

static void changed(view *v, uint32_t index, int setting) {
    document_need need = document_needs(v->doc, index, setting);
    const char *name = v->doc->settings[index].module->settings[setting].name;
    trace(v, "set %s %g", name, (double)document_value(v->doc, index, setting));
    v->need = need > v->need ? need : v->need;
    stage_changed(v, strcmp(name, "width") == 0);
}

/* Is it one that the document has, and that is looked for? */
static bool is_shown(const view *v, uint32_t index, int setting) {
    const lao_setting_row *row = &v->doc->settings[index].module->settings[setting];
    char label[64];
    label_of(row, label);
    return document_offers(v->doc, index, setting) &&
           (!*v->filter || strstr(label, v->filter) || strstr(row->help, v->filter));
}

static void row_of(view *v, uint32_t index, int setting) {
    document *doc = v->doc;
    const lao_setting_row *row = &doc->settings[index].module->settings[setting];
    char label[64];
    float value = document_value(doc, index, setting);
    label_of(row, label);
    ui_group(setting);
    ui_cell();
    ui_label(label);
    panel_explain(row);
    ui_cell();
    ui_widget_name(row->name);
    if (panel_edit(row, &value)) {
        document_set(doc, index, setting, row->type == LAO_SETTING_INT ? roundf(value) : value);
        changed(v, index, setting);
    }
    panel_explain(row);
    ui_cell();
    bool edited = doc->settings[index].edited >> setting & 1;
    if (!edited) /* so that the others do not move when there is one */
        ui_no_button("x##reset");
    else if (ui_small_button("x##reset")) {
        document_reset(doc, index, setting);
        changed(v, index, setting);
    }
    ui_widget_name(NULL);
    ui_group_end();
}

static void reset_all(view *v) {
    for (uint32_t i = 0; i < v->doc->settings_count; i++) {
        for (uint32_t k = 0; k < v->doc->settings[i].module->setting_count; k++) {
            if (v->doc->settings[i].edited >> k & 1) {
                document_reset(v->doc, i, (int)k);
                changed(v, i, (int)k);
            }
        }
    }
}

/* The settings of one set; none where none is looked for. */
static void section(view *v, uint32_t index) {
    const document_settings *s = &v->doc->settings[index];
    uint32_t count = s->module->setting_count, first = 0;
    while (first < count && !is_shown(v, index, (int)first))
        first++;
    if (first == count)
        return;
    ui_group((int)index);
    if (*v->filter)
        ui_unfold();
    if (ui_section(s->title, index == 0) && ui_table("rows", 3, 1)) {
        for (uint32_t k = first; k < count; k++) {
            if (is_shown(v, index, (int)k))
                row_of(v, index, (int)k);
        }
        ui_table_end();
    }
    ui_group_end();
}

void panel_settings(view *v) {
    ui_width(-1);
    ui_input("##filter", v->filter, sizeof v->filter, "find a setting");
    ui_text_dim("Rest the pointer on a name to read what it does; x takes an edit back.");
    if (ui_small_button("Reset all"))
        reset_all(v);
    ui_scroll("settings", 0);
    for (uint32_t i = 0; i < v->doc->settings_count; i++)
        section(v, i);
    ui_scroll_end();
}
