#include "sheet.h"

#include "image.h"
#include "report.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- cells ------------------------------------------------------------------------------ */

bool sheet_shrink(picture *image, uint32_t widest, bool strongest) {
    uint32_t factor = (image->width + widest - 1) / widest;
    picture out;
    if (factor <= 1)
        return true;
    if (!picture_make((image->width + factor - 1) / factor, (image->height + factor - 1) / factor,
                      &out))
        return cli_fail("out of memory");
    for (size_t i = 0; i < (size_t)out.width * out.height * 4; i++) {
        uint32_t c = (uint32_t)(i % 4), x = (uint32_t)(i / 4 % out.width) * factor,
                 y = (uint32_t)(i / 4 / out.width) * factor, sum = 0, count = 0, most = 0;
        for (uint32_t v = y; v < y + factor && v < image->height; v++) {
            for (uint32_t u = x; u < x + factor && u < image->width; u++, count++) {
                uint32_t value = image->pixels[4 * ((size_t)v * image->width + u) + c];
                sum += value;
                most = value > most ? value : most;
            }
        }
        out.pixels[i] = (uint8_t)(strongest ? most : (sum + count / 2) / (count ? count : 1));
    }
    picture_free(image);
    *image = out;
    return true;
}

bool sheet_add(cli_sheet *sheet, sheet_cell cell) {
    sheet_cell *cells = realloc(sheet->cells, (sheet->count + 1) * sizeof *cells);
    if (!cells) {
        picture_free(&cell.image);
        free(cell.caption);
        return cli_fail("out of memory");
    }
    sheet->cells = cells;
    sheet->cells[sheet->count++] = cell;
    return true;
}

void sheet_free(cli_sheet *sheet) {
    for (uint32_t i = 0; i < sheet->count; i++) {
        picture_free(&sheet->cells[i].image);
        free(sheet->cells[i].caption);
    }
    free(sheet->cells);
    memset(sheet, 0, sizeof *sheet);
}

/* ---- text ------------------------------------------------------------------------------- */

/* Lines of text from y on, at most `width` wide; returns their height. page NULL: only measured. */
static uint32_t draw_lines(picture *page, uint32_t x, uint32_t y, uint32_t width, const char *text,
                           const text_style *style) {
    uint32_t line = (uint32_t)ceil(1.15 * style->size), height = 0;
    if (!text)
        return 0;
    while (*text) {
        char part[512];
        uint32_t bytes = text_fit(text, width, style);
        snprintf(part, sizeof part, "%.*s", (int)bytes, text);
        if (page)
            text_draw(page, x, (int64_t)y + height, TEXT_LEFT, part, style);
        height += line;
        for (text += bytes; *text == ' ';)
            text++;
    }
    return height;
}

/* ---- layout ----------------------------------------------------------------------------- */

typedef struct layout {
    uint32_t columns, rows, gap;
    uint32_t *widths;        /* owned; of the columns */
    text_style small, large; /* captions; the title */
    uint32_t width, height;  /* of the page; height grows while it is drawn */
} layout;

static bool layout_make(const cli_sheet *sheet, layout *out) {
    layout l;
    uint32_t widest = 200;
    memset(&l, 0, sizeof l);
    l.columns = sheet->columns ? sheet->columns : 1;
    l.columns = l.columns < sheet->count || sheet->count == 0 ? l.columns : sheet->count;
    l.rows = (sheet->count + l.columns - 1) / l.columns;
    l.widths = cli_new(l.columns, sizeof *l.widths);
    if (!l.widths)
        return false;
    for (uint32_t c = 0; c < l.columns; c++)
        l.widths[c] = 200;
    for (uint32_t i = 0; i < sheet->count; i++) {
        uint32_t width = sheet->cells[i].image.width, *column = &l.widths[i % l.columns];
        *column = width > *column ? width : *column;
        widest = width > widest ? width : widest;
    }
    l.small.size = fmin(fmax(widest / 24.0, 15), 30);
    for (int k = 0; k < 3; k++)
        l.small.ink[k] = 0.13;
    l.large = l.small;
    l.large.size *= 1.2;
    l.large.bold = true;
    l.gap = (uint32_t)(0.9 * l.small.size);
    l.width = l.gap;
    for (uint32_t c = 0; c < l.columns; c++)
        l.width += l.widths[c] + l.gap;
    *out = l;
    return true;
}

/* A row from y on; returns the y below it. page NULL: only measured. */
static uint32_t draw_row(const cli_sheet *sheet, const layout *l, uint32_t row, uint32_t y,
                         picture *page) {
    uint32_t first = row * l->columns, tallest = 0, captions = 0, x = l->gap;
    y += draw_lines(page, x, y, l->width - 2 * l->gap, sheet->cells[first].heading, &l->small);
    for (uint32_t i = first; i < sheet->count && i < first + l->columns; i++) {
        uint32_t height = sheet->cells[i].image.height;
        tallest = height > tallest ? height : tallest;
    }
    uint32_t below = y + tallest + l->gap / 4;
    for (uint32_t c = 0; c < l->columns && first + c < sheet->count; c++) {
        const sheet_cell *cell = &sheet->cells[first + c];
        if (page && cell->image.pixels)
            picture_over(page, x, y, &cell->image);
        uint32_t height = draw_lines(page, x, below, l->widths[c], cell->caption, &l->small);
        captions = height > captions ? height : captions;
        x += l->widths[c] + l->gap;
    }
    return below + captions + l->gap;
}

/* Everything; returns the height. page NULL: only measured. */
static uint32_t draw_sheet(const cli_sheet *sheet, const layout *l, picture *page) {
    uint32_t x = l->gap, y = x;
    if (sheet->title)
        y += draw_lines(page, x, y, l->width - 2 * l->gap, sheet->title, &l->large) + l->gap / 2;
    if (sheet->titles) {
        uint32_t tallest = 0;
        for (uint32_t c = 0; c < l->columns; x += l->widths[c++] + l->gap) {
            uint32_t height = draw_lines(page, x, y, l->widths[c], sheet->titles[c], &l->small);
            tallest = height > tallest ? height : tallest;
        }
        y += tallest;
    }
    for (uint32_t row = 0; row < l->rows; row++)
        y = draw_row(sheet, l, row, y, page);
    if (sheet->note)
        y += draw_lines(page, l->gap, y, l->width - 2 * l->gap, sheet->note, &l->small) + l->gap;
    return y;
}

/* Rows of RGB, in place. */
static void drop_alpha(picture *p) {
    for (size_t i = 0; i < (size_t)p->width * p->height; i++)
        memmove(p->pixels + 3 * i, p->pixels + 4 * i, 3);
}

bool sheet_write(const cli_sheet *sheet, const char *path) {
    static const double white[3] = {1, 1, 1};
    char error[IMAGE_ERROR_SIZE];
    layout l;
    picture page;
    if (!layout_make(sheet, &l))
        return false;
    bool ok = picture_make(l.width, draw_sheet(sheet, &l, NULL), &page) ||
              cli_fail("%s: out of memory", path);
    if (ok) {
        picture_fill(&page, 0, 0, page.width, page.height, white, 1);
        draw_sheet(sheet, &l, &page);
        drop_alpha(&page);
        ok = image_write_png(path, page.width, page.height, page.pixels, 3, error) ||
             cli_fail("%s", error);
        picture_free(&page);
    }
    free(l.widths);
    return ok;
}
