/* A sheet of pictures in rows of cells with labels, for comparing images by eye. */
#ifndef LINEAO_CLI_SHEET_H
#define LINEAO_CLI_SHEET_H

#include <stdbool.h>
#include <stdint.h>

enum { SHEET_COLUMNS = 3, SHEET_LABEL = 80 };

/* One row: three pictures of the same size as RGB, top row first, and what stands above them. */
typedef struct sheet_row {
    uint32_t width, height;
    uint8_t *pixels[SHEET_COLUMNS]; /* owned */
    char label[SHEET_LABEL];
} sheet_row;

typedef struct cli_sheet {
    sheet_row *rows; /* owned */
    uint32_t count;
} cli_sheet;

/* Adds a row and takes over its pictures, also on failure. They shrink to at most 480 pixels in
 * width: as means, but the last column (the difference) keeps the strongest pixel. False: no
 * memory. */
bool sheet_add(cli_sheet *sheet, sheet_row row);

/* Draws the rows with a title for each column. False: reported. */
bool sheet_write(const cli_sheet *sheet, const char *const titles[SHEET_COLUMNS], const char *path);
void sheet_free(cli_sheet *sheet);

#endif
