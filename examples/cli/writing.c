#include "writing.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int cli_text_add(void *user, const char *text, size_t length) {
    cli_text *t = user;
    if (!t->broken && t->length + length + 1 > t->room) {
        size_t room = 2 * (t->length + length + 1);
        char *grown = realloc(t->text, room);
        t->broken = !grown && !cli_fail("out of memory");
        if (grown) {
            t->text = grown;
            t->room = room;
        }
    }
    if (t->broken)
        return 1;
    memcpy(t->text + t->length, text, length);
    t->length += length;
    t->text[t->length] = '\0';
    return 0;
}

void cli_text_print(cli_text *t, const char *format, ...) {
    char text[256];
    va_list list;
    va_start(list, format);
    int length = vsnprintf(text, sizeof text, format, list);
    va_end(list);
    cli_text_add(t, text, (size_t)length);
}

void cli_text_float(cli_text *t, float value) {
    char text[32] = "null";
    if (isfinite(value))
        cli_shortest(value, text, sizeof text);
    cli_text_add(t, text, strlen(text));
}

bool cli_text_write(cli_text *t, const char *path) {
    bool ok = !t->broken && cli_go_on() && cli_write_text(path, t->text);
    free(t->text);
    memset(t, 0, sizeof *t);
    return ok;
}
