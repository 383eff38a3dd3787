#include "report.h"

#include "image.h"
#include "image_file.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- listeners -------------------------------------------------------------------------- */

/* A thread's own, so that work beside a window reports to it through functions without a context.
 */
static __thread const cli_listener *hears;

void cli_listen(const cli_listener *listener) {
    hears = listener;
}

const cli_listener *cli_listening(void) {
    return hears;
}

/* ---- messages --------------------------------------------------------------------------- */

/* One write, so that lines of several processes do not mix. */
static void say(bool failure, char *line, size_t room) {
    size_t length = strlen(line);
    for (size_t i = 0; i < length; i++) {
        if ((unsigned char)line[i] < 32 || line[i] == 127)
            line[i] = ' ';
    }
    while (length > 0 && line[length - 1] == ' ')
        length--;
    length = length < room - 2 ? length : room - 2;
    memcpy(line + length, hears ? "" : "\n", hears ? 1 : 2);
    if (!hears)
        fputs(line, stderr);
    else if (hears->say)
        hears->say(hears->user, failure, line + strlen("lineao: "));
}

bool cli_fail(const char *format, ...) {
    char line[2048] = "lineao: ";
    size_t used = strlen(line);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line + used, sizeof line - used, format, arguments);
    va_end(arguments);
    say(true, line, sizeof line);
    return false;
}

void cli_warn(const char *place, const char *text) {
    char line[2048];
    snprintf(line, sizeof line, "lineao: %s: warning: %s", place, text);
    say(false, line, sizeof line);
}

/* ---- Ctrl-C ----------------------------------------------------------------------------- */

void cli_interrupt_hold(void) {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigprocmask(SIG_BLOCK, &set, NULL);
}

bool cli_interrupted(void) {
    sigset_t set;
    if (hears)
        return hears->interrupted && hears->interrupted(hears->user);
    return sigpending(&set) == 0 && sigismember(&set, SIGINT) == 1;
}

bool cli_go_on(void) {
    return !cli_interrupted() || cli_fail("interrupted");
}

/* ---- progress --------------------------------------------------------------------------- */

void cli_progress_show(cli_progress *progress, uint64_t done, uint64_t total) {
    if (hears) {
        if (hears->progress)
            hears->progress(hears->user, progress->doing, progress->name,
                            total > 0 ? (double)done / (double)total : 0);
        return;
    }
    int percent = total > 0 ? (int)(100.0 * (double)done / (double)total) : 0;
    if (percent == progress->shown || !isatty(STDERR_FILENO))
        return;
    progress->shown = percent;
    fprintf(stderr, "\r\033[Klineao: %s %s %3d %%", progress->doing, progress->name, percent);
    fflush(stderr);
}

void cli_progress_end(cli_progress *progress) {
    if (progress->shown >= 0)
        fputs("\r\033[K", stderr);
    progress->shown = -1;
}

/* ---- text ------------------------------------------------------------------------------- */

enum { WORD = 48 };

/* Levenshtein distance of two words, of which the first WORD letters count. */
static size_t distance(const char *a, const char *b) {
    size_t row[WORD + 1], rows = strlen(a), columns = strlen(b);
    rows = rows < WORD ? rows : WORD;
    columns = columns < WORD ? columns : WORD;
    for (size_t j = 0; j <= columns; j++)
        row[j] = j;
    for (size_t i = 0; i < rows; i++) {
        size_t corner = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < columns; j++) {
            size_t replaced = corner + (a[i] != b[j]);
            corner = row[j + 1];
            size_t best = 1 + (row[j] < corner ? row[j] : corner);
            row[j + 1] = replaced < best ? replaced : best;
        }
    }
    return row[columns];
}

const char *cli_nearest(const char *text, const char *(*next)(const void *user, uint32_t index),
                        const void *user) {
    const char *best = NULL, *candidate;
    size_t least = 1 + strlen(text) / 3;
    for (uint32_t i = 0; (candidate = next(user, i)) != NULL; i++) {
        size_t d = distance(text, candidate);
        if (d <= least && (!best || d < least)) {
            best = candidate;
            least = d;
        }
    }
    return best;
}

/* The program never leaves the "C" locale, so strtod reads a decimal point. */
bool cli_number(const char *text, double *value) {
    char *end;
    if (*text == '\0' || strspn(text, "0123456789+-.eE") != strlen(text))
        return false;
    double number = strtod(text, &end);
    if (*end != '\0' || !isfinite(number))
        return false;
    *value = number;
    return true;
}

bool cli_numbers(const char *text, double *values, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        char part[64];
        size_t length = strcspn(text, ",");
        if (length >= sizeof part)
            return false;
        memcpy(part, text, length);
        part[length] = '\0';
        if (!cli_number(part, &values[i]) || (text[length] == ',') != (i + 1 < count))
            return false;
        text += length + 1;
    }
    return true;
}

void cli_shortest(float value, char *text, size_t size) {
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(text, size, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value)
            return;
    }
}

/* ---- files and memory ------------------------------------------------------------------- */

bool cli_writable(const char *path) {
    if (!path)
        return true;
    struct stat status;
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode))
        return cli_fail("%s: is a folder; name a file in it", path);
    char error[IMAGE_ERROR_SIZE];
    char *temp = image_temp_create(path, error);
    if (!temp)
        return cli_fail("%s; choose a folder that exists and can be written to", error);
    remove(temp);
    free(temp);
    return true;
}

bool cli_write_text(const char *path, const char *text) {
    char error[IMAGE_ERROR_SIZE];
    char *temp = image_temp_create(path, error);
    if (!temp)
        return cli_fail("%s", error);
    FILE *file = fopen(temp, "w");
    bool ok = file && fputs(text, file) >= 0 && fputc('\n', file) != EOF;
    ok = file && fclose(file) == 0 && ok;
    if (!ok)
        image_fail(error, path, strerror(errno));
    return image_temp_finish(temp, path, ok, error) || cli_fail("%s", error);
}

void *cli_new(size_t count, size_t size) {
    size_t least = count > 0 ? count : 1;
    void *memory = size == 0 || least > SIZE_MAX / size ? NULL : malloc(least * size);
    if (!memory)
        cli_fail("out of memory");
    return memory;
}
