/* A sheet of pictures in rows of cells with text, for looking at them side by side. */
#ifndef LINEAO_CLI_SHEET_H
#define LINEAO_CLI_SHEET_H

#include "picture.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct sheet_cell {
    picture image;    /* owned; all zero: an empty place */
    char heading[80]; /* above the row that this cell begins, or "" */
    char *caption;    /* owned; below the picture, broken into lines; or NULL */
} sheet_cell;

/* Titles and note are not owned and must outlive the sheet. All zero: an empty sheet of one column.
 */
typedef struct cli_sheet {
    uint32_t columns;
    const char *const *titles; /* one for each column, or NULL */
    const char *title, *note;  /* above and below all, or NULL; the note is broken into lines */
    sheet_cell *cells;         /* owned; row by row */
    uint32_t count;
} cli_sheet;

/* Adds a cell and takes over what it owns, also on failure. False: no memory, reported. */
bool sheet_add(cli_sheet *sheet, sheet_cell cell);

/* Shrinks a picture by the least whole factor that makes it at most `widest` wide: each pixel is
 * the mean, or the strongest, of those below it. False: no memory, reported. */
bool sheet_shrink(picture *image, uint32_t widest, bool strongest);

/* Draws the sheet on white. False: reported. */
bool sheet_write(const cli_sheet *sheet, const char *path);
void sheet_free(cli_sheet *sheet);

#endif
