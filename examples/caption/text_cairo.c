/* Letters by Cairo. */
#include "text.h"

#include <cairo.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void choose(cairo_t *cr, const text_style *style) {
    cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           style->bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, 0.8 * style->size); /* ascent and descent fill the line */
}

static cairo_t *begin(uint32_t width, uint32_t height, const text_style *style) {
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_A8, (int)width, (int)height);
    cairo_t *cr = cairo_create(surface);
    cairo_surface_destroy(surface); /* cr holds it */
    choose(cr, style);
    return cr;
}

uint32_t text_width(const char *text, const text_style *style) {
    cairo_t *cr = begin(1, 1, style);
    cairo_text_extents_t extents;
    cairo_text_extents(cr, text, &extents);
    bool ok = cairo_status(cr) == CAIRO_STATUS_SUCCESS;
    cairo_destroy(cr);
    return ok && extents.x_advance > 0 ? (uint32_t)ceil(fmin(extents.x_advance, 30000)) : 0;
}

/* The surface's bytes without its padding, and ends the drawing. NULL: failed. */
static uint8_t *take(cairo_t *cr, uint32_t width, uint32_t height) {
    cairo_surface_t *surface = cairo_get_target(cr);
    uint8_t *out = NULL;
    cairo_surface_flush(surface);
    if (cairo_status(cr) == CAIRO_STATUS_SUCCESS)
        out = malloc((size_t)width * height);
    for (uint32_t y = 0; out && y < height; y++) {
        memcpy(out + (size_t)y * width,
               cairo_image_surface_get_data(surface) +
                   (size_t)y * (size_t)cairo_image_surface_get_stride(surface),
               width);
    }
    cairo_destroy(cr);
    return out;
}

bool text_mask_make(const char *text, const text_style *style, text_mask *out) {
    text_mask mask;
    memset(&mask, 0, sizeof mask);
    mask.margin = (uint32_t)ceil(style->outline_width) + 2;
    mask.width = text_width(text, style) + 2 * mask.margin;
    mask.height = (uint32_t)ceil(style->size) + 2 * mask.margin;
    for (int i = 0; i < 2; i++) {
        cairo_t *cr = begin(mask.width, mask.height, style);
        cairo_move_to(cr, mask.margin, mask.margin + 0.78 * style->size);
        cairo_text_path(cr, text);
        if (i == 0) {
            cairo_fill(cr);
        } else if (style->outline_width > 0) {
            cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
            cairo_set_line_width(cr, 2 * style->outline_width);
            cairo_stroke(cr);
        }
        *(i ? &mask.outline : &mask.letters) = take(cr, mask.width, mask.height);
    }
    if (!mask.letters || !mask.outline) {
        free(mask.letters);
        free(mask.outline);
        return false;
    }
    *out = mask;
    return true;
}
