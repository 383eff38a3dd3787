/* Text that grows in memory on its way to a file. */
#ifndef LINEAO_CLI_WRITING_H
#define LINEAO_CLI_WRITING_H

#include "report.h"

/* All zero: empty. broken: no memory, reported; what is added from then on is lost. */
typedef struct cli_text {
    char *text;
    size_t length, room;
    bool broken;
} cli_text;

/* user: a cli_text. Returns 0, or 1 when it is broken. */
int cli_text_add(void *user, const char *text, size_t length);
/* At most 255 characters at a time. */
void cli_text_print(cli_text *t, const char *format, ...) CLI_PRINTF(2, 3);
/* The shortest decimal that reads back as the same float; null for what is no finite number. */
void cli_text_float(cli_text *t, float value);
/* Writes a whole file, or none, and frees the text. False: reported. */
bool cli_text_write(cli_text *t, const char *path);

#endif
