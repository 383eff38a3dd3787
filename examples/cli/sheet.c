#include "sheet.h"

#include "image.h"
#include "report.h"

#include <stdlib.h>
#include <string.h>

enum { WIDEST = 480, GAP = 12, LINE = 22, SCALE = 2 };

/* ---- 5x7 letters ------------------------------------------------------------------------ */

/* Five columns of seven bits, the lowest bit at the top, for ' ' to 'z' as far as labels need it.
 */
static const uint8_t *glyph(char letter) {
    static const char letters[] = " -.,:_x%0123456789abcdefghijklmnopqrstuvwyzGLVK";
    static const uint8_t columns[][5] = {
        {0x00, 0x00, 0x00, 0x00, 0x00}, {0x08, 0x08, 0x08, 0x08, 0x08},
        {0x00, 0x60, 0x60, 0x00, 0x00}, {0x00, 0x50, 0x30, 0x00, 0x00},
        {0x00, 0x36, 0x36, 0x00, 0x00}, {0x40, 0x40, 0x40, 0x40, 0x40},
        {0x44, 0x28, 0x10, 0x28, 0x44}, {0x23, 0x13, 0x08, 0x64, 0x62},
        {0x3E, 0x51, 0x49, 0x45, 0x3E}, {0x00, 0x42, 0x7F, 0x40, 0x00},
        {0x42, 0x61, 0x51, 0x49, 0x46}, {0x21, 0x41, 0x45, 0x4B, 0x31},
        {0x18, 0x14, 0x12, 0x7F, 0x10}, {0x27, 0x45, 0x45, 0x45, 0x39},
        {0x3C, 0x4A, 0x49, 0x49, 0x30}, {0x01, 0x71, 0x09, 0x05, 0x03},
        {0x36, 0x49, 0x49, 0x49, 0x36}, {0x06, 0x49, 0x49, 0x29, 0x1E},
        {0x20, 0x54, 0x54, 0x54, 0x78}, {0x7F, 0x48, 0x44, 0x44, 0x38},
        {0x38, 0x44, 0x44, 0x44, 0x20}, {0x38, 0x44, 0x44, 0x48, 0x7F},
        {0x38, 0x54, 0x54, 0x54, 0x18}, {0x08, 0x7E, 0x09, 0x01, 0x02},
        {0x0C, 0x52, 0x52, 0x52, 0x3E}, {0x7F, 0x08, 0x04, 0x04, 0x78},
        {0x00, 0x44, 0x7D, 0x40, 0x00}, {0x20, 0x40, 0x44, 0x3D, 0x00},
        {0x7F, 0x10, 0x28, 0x44, 0x00}, {0x00, 0x41, 0x7F, 0x40, 0x00},
        {0x7C, 0x04, 0x18, 0x04, 0x78}, {0x7C, 0x08, 0x04, 0x04, 0x78},
        {0x38, 0x44, 0x44, 0x44, 0x38}, {0x7C, 0x14, 0x14, 0x14, 0x08},
        {0x08, 0x14, 0x14, 0x18, 0x7C}, {0x7C, 0x08, 0x04, 0x04, 0x08},
        {0x48, 0x54, 0x54, 0x54, 0x20}, {0x04, 0x3F, 0x44, 0x40, 0x20},
        {0x3C, 0x40, 0x40, 0x20, 0x7C}, {0x1C, 0x20, 0x40, 0x20, 0x1C},
        {0x3C, 0x40, 0x30, 0x40, 0x3C}, {0x0C, 0x50, 0x50, 0x50, 0x3C},
        {0x44, 0x64, 0x54, 0x4C, 0x44}, {0x3E, 0x41, 0x49, 0x49, 0x7A},
        {0x7F, 0x40, 0x40, 0x40, 0x40}, {0x1F, 0x20, 0x40, 0x20, 0x1F},
        {0x7F, 0x08, 0x14, 0x22, 0x41}};
    const char *at = letter ? strchr(letters, letter) : NULL;
    return columns[at ? at - letters : 0];
}

typedef struct canvas {
    uint32_t width, height;
    uint8_t *pixels;
} canvas;

static void draw_text(canvas *c, uint32_t x, uint32_t y, const char *text) {
    for (; *text && x + 6 * SCALE <= c->width; text++, x += 6 * SCALE) {
        const uint8_t *columns = glyph(*text);
        for (uint32_t i = 0; i < 5 * SCALE; i++) {
            for (uint32_t j = 0; j < 7 * SCALE; j++) {
                if (columns[i / SCALE] >> (j / SCALE) & 1)
                    memset(c->pixels + 3 * ((size_t)(y + j) * c->width + x + i), 40, 3);
            }
        }
    }
}

/* ---- cells ------------------------------------------------------------------------------ */

/* Shrinks by a whole factor: each pixel is the mean, or the strongest, of those below it. */
static bool shrink(uint8_t **pixels, uint32_t width, uint32_t height, uint32_t factor,
                   bool strongest) {
    uint32_t w = (width + factor - 1) / factor, h = (height + factor - 1) / factor;
    uint8_t *out = cli_new((size_t)w * h, 3);
    for (size_t i = 0; out && i < (size_t)w * h * 3; i++) {
        uint32_t c = (uint32_t)(i % 3), x = (uint32_t)(i / 3 % w) * factor,
                 y = (uint32_t)(i / 3 / w) * factor, sum = 0, count = 0, most = 0;
        for (uint32_t v = y; v < y + factor && v < height; v++) {
            for (uint32_t u = x; u < x + factor && u < width; u++, count++) {
                uint32_t value = (*pixels)[3 * ((size_t)v * width + u) + c];
                sum += value;
                most = value > most ? value : most;
            }
        }
        uint32_t mean = count > 0 ? (sum + count / 2) / count : 0;
        out[i] = (uint8_t)(strongest ? most : mean);
    }
    free(*pixels);
    *pixels = out;
    return out != NULL;
}

bool sheet_add(cli_sheet *sheet, sheet_row row) {
    uint32_t factor = row.width > WIDEST ? (row.width + WIDEST - 1) / WIDEST : 1;
    sheet_row *rows = realloc(sheet->rows, (sheet->count + 1) * sizeof *rows);
    bool ok = rows != NULL;
    if (ok)
        sheet->rows = rows;
    else
        cli_fail("out of memory");
    for (int c = 0; c < SHEET_COLUMNS && ok && factor > 1; c++)
        ok = shrink(&row.pixels[c], row.width, row.height, factor, c == SHEET_COLUMNS - 1);
    for (int c = 0; c < SHEET_COLUMNS && !ok; c++)
        free(row.pixels[c]);
    if (!ok)
        return false;
    row.width = (row.width + factor - 1) / factor;
    row.height = (row.height + factor - 1) / factor;
    sheet->rows[sheet->count++] = row;
    return true;
}

static void draw_cell(canvas *c, uint32_t x, uint32_t y, const sheet_row *row,
                      const uint8_t *pixels) {
    for (uint32_t i = 0; i < row->height; i++) {
        memcpy(c->pixels + 3 * ((size_t)(y + i) * c->width + x),
               pixels + 3 * (size_t)i * row->width, 3 * (size_t)row->width);
    }
}

bool sheet_write(const cli_sheet *sheet, const char *const titles[SHEET_COLUMNS],
                 const char *path) {
    canvas c = {0, GAP + LINE, NULL};
    uint32_t widest = 200, y = GAP;
    for (uint32_t r = 0; r < sheet->count; r++) {
        widest = sheet->rows[r].width > widest ? sheet->rows[r].width : widest;
        c.height += LINE + sheet->rows[r].height + GAP;
    }
    c.width = GAP + SHEET_COLUMNS * (widest + GAP);
    c.pixels = cli_new((size_t)c.width * c.height, 3);
    if (!c.pixels)
        return false;
    memset(c.pixels, 250, 3 * (size_t)c.width * c.height);
    for (uint32_t i = 0; i < SHEET_COLUMNS; i++)
        draw_text(&c, GAP + i * (widest + GAP), y, titles[i]);
    y += LINE;
    for (uint32_t r = 0; r < sheet->count; r++) {
        draw_text(&c, GAP, y, sheet->rows[r].label);
        y += LINE;
        for (uint32_t i = 0; i < SHEET_COLUMNS; i++)
            draw_cell(&c, GAP + i * (widest + GAP), y, &sheet->rows[r], sheet->rows[r].pixels[i]);
        y += sheet->rows[r].height + GAP;
    }
    char error[IMAGE_ERROR_SIZE];
    bool ok = image_write_png(path, c.width, c.height, c.pixels, 3, error) || cli_fail("%s", error);
    free(c.pixels);
    return ok;
}

void sheet_free(cli_sheet *sheet) {
    for (uint32_t r = 0; r < sheet->count; r++) {
        for (int c = 0; c < SHEET_COLUMNS; c++)
            free(sheet->rows[r].pixels[c]);
    }
    free(sheet->rows);
    memset(sheet, 0, sizeof *sheet);
}
