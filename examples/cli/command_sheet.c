/* lineao sheet: pictures with captions on one sheet. */
#include "commands.h"
#include "image.h"
#include "report.h"
#include "sheet.h"

#include <stdlib.h>
#include <string.h>

/* "CAPTION=FILE.png", "FILE.png", or "CAPTION=" for an empty place. */
static bool add(const cli_options *options, const char *text, cli_sheet *sheet) {
    char error[IMAGE_ERROR_SIZE];
    const char *equals = strrchr(text, '='), *path = equals ? equals + 1 : text;
    sheet_cell cell;
    memset(&cell, 0, sizeof cell);
    if (*path &&
        !image_read_png(path, 4, &cell.image.width, &cell.image.height, &cell.image.pixels, error))
        return cli_fail("%s", error);
    bool ok = !*path || !options->widest || sheet_shrink(&cell.image, options->widest, false);
    cell.caption = ok && equals ? cli_new((size_t)(equals - text) + 1, 1) : NULL;
    if (cell.caption) {
        memcpy(cell.caption, text, (size_t)(equals - text));
        cell.caption[equals - text] = '\0';
    }
    if (ok && (cell.caption || !equals))
        return sheet_add(sheet, cell);
    picture_free(&cell.image);
    return false;
}

int cli_sheet_command(const cli_options *options) {
    cli_sheet sheet;
    memset(&sheet, 0, sizeof sheet);
    sheet.columns = options->columns ? options->columns : 3;
    sheet.title = options->title;
    sheet.note = options->note;
    bool ok = cli_writable(options->out);
    for (uint32_t i = 0; i < options->file_count && ok; i++)
        ok = cli_go_on() && add(options, options->files[i].path, &sheet);
    ok = ok && sheet_write(&sheet, options->out);
    sheet_free(&sheet);
    return ok ? CLI_OK : CLI_FAILED;
}
