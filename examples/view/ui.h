/* The user interface: Dear ImGui behind C. One interface at a time, used by the thread of the
 * window. Every widget has a name that is unique in its panel; what follows "##" in a label is not
 * shown. Positions and sizes are in px. */
#ifndef LINEAO_VIEW_UI_H
#define LINEAO_VIEW_UI_H

#include "window.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- life ---- */

typedef struct ui_desc {
    float scale; /* 1: a monitor of 96 dpi */
    /* (Optional) Hears where each widget is when it appears or moves: for tests. */
    void (*placed)(void *user, const char *label, window_rect place);
    void *user;
} ui_desc;

/* False: reported. */
bool ui_open(window *w, const ui_desc *desc);
void ui_close(void);
float ui_scale(void);
/* The colour of the window where nothing is: three numbers. */
const float *ui_background(void);

/* All widgets of a frame are made between these two; drawing is the backends'. */
void ui_begin(void);
void ui_end(void);
void ui_draw_gl(void);
void ui_draw_vk(void *commands);

/* Does the pointer, the keyboard belong to a widget now? */
bool ui_has_pointer(void);
bool ui_has_keyboard(void);
/* Is a widget being dragged or edited? */
bool ui_active(void);

/* ---- panels ---- */

/* A panel of fixed place. */
void ui_panel(const char *name, window_rect place);
void ui_panel_end(void);
/* A window over all else, in the middle of that place or at its lower border; *open becomes false
 * when it is closed; NULL: it cannot be. */
bool ui_dialog(const char *name, window_rect place, bool below, bool *open);
/* A part that scrolls by itself; height 0: the rest. */
void ui_scroll(const char *name, float height);
void ui_scroll_end(void);
bool ui_tabs(const char *name);
void ui_tabs_end(void);
bool ui_tab(const char *name);
void ui_tab_end(void);
bool ui_section(const char *name, bool open);
void ui_unfold(void); /* the next section, whatever the user has done with it */
/* Widgets of equal labels are told apart by this. */
void ui_group(int id);
void ui_group_end(void);

/* ---- widgets ---- */

/* What tests call the widgets that follow, whose own labels say little; NULL: their labels. */
void ui_widget_name(const char *name);
void ui_text(const char *text);
void ui_label(const char *text); /* on the line of the widget beside it */
void ui_text_wrapped(const char *text);
void ui_text_dim(const char *text); /* wrapped */
void ui_text_error(const char *text);
bool ui_button(const char *label);
bool ui_small_button(const char *label);
void ui_no_button(const char *label); /* as wide as that one */
bool ui_toggle(const char *label, bool *value);
/* Is chosen among others. */
bool ui_choice(const char *label, bool chosen);
/* choices: "a|b|c" */
bool ui_combo(const char *label, int *chosen, const char *choices);
bool ui_slider(const char *label, float *value, float low, float high, const char *format);
bool ui_slider_int(const char *label, int *value, int low, int high, const char *format);
/* Dragged without an end; steps of `speed`. */
bool ui_drag(const char *label, float *value, float speed, float low, float high,
             const char *format);
/* Says true when a text has been entered (Enter, or the focus goes). */
bool ui_input(const char *label, char *text, int size, const char *hint);
bool ui_item(const char *label, bool selected); /* of a list */
void ui_progress(float part, const char *text);
void ui_help(const char *text); /* of the widget before, when the pointer rests on it */
void ui_tip(const char *text);  /* beside the pointer */
bool ui_hovered(void);          /* the widget before */
void ui_same_line(void);
void ui_space(void);
void ui_line(void);
void ui_width(float width);       /* of the next widget; negative: up to that far from the border */
void ui_width_left(float *width); /* of the panel */
float ui_height_left(void);
/* Rows of `columns` cells, each as wide as what it holds but for one, which takes the rest. */
bool ui_table(const char *name, int columns, int widest);
void ui_cell(void);
void ui_table_end(void);
void ui_disable(bool disabled);
void ui_disable_end(void);

/* ---- drawing ---- */

/* A place of that size in the panel for drawing; says where it is and whether it is clicked. */
typedef struct ui_area {
    float x, y, width, height, pointer[2];
    float moved[2], wheel; /* since the last frame: dragged by the button, turned over it */
    bool hovered, pressed; /* pressed: the button is down since it was pressed here */
    bool clicked;          /* it has been let go where it was pressed */
} ui_area;
ui_area ui_canvas(const char *label, float width, float height);
/* Colours: 0xAABBGGRR. Over the picture and behind all panels with `over`, else in the panel. */
void ui_draw_line(bool over, float ax, float ay, float bx, float by, uint32_t color, float width);
void ui_draw_box(bool over, float ax, float ay, float bx, float by, uint32_t color);
void ui_draw_disc(bool over, float x, float y, float radius, uint32_t color);
void ui_draw_ring(bool over, float x, float y, float radius, uint32_t color, float width);
void ui_draw_text(bool over, float x, float y, uint32_t color, const char *text);
/* What is drawn until the end is cut off at the borders of a part of the window. */
void ui_clip(bool over, window_rect place);
void ui_clip_end(bool over);
float ui_text_width(const char *text);
float ui_text_height(void);
void ui_copy(const char *text); /* to the clipboard */

/* ---- of the Vulkan window ---- */

struct host_vk;
typedef struct ui_vulkan {
    struct host_vk *host;
    void *pass; /* VkRenderPass */
    uint32_t images;
} ui_vulkan;
void window_vk_interface(const window *w, ui_vulkan *out);

#ifdef __cplusplus
}
#endif

#endif
