/* What the program says besides its results: one line per failure on standard error, progress on a
 * terminal, Ctrl-C; and small helpers for text. Who finds a fault reports it; callers pass it on.
 */
#ifndef LINEAO_CLI_REPORT_H
#define LINEAO_CLI_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define CLI_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define CLI_PRINTF(text, first)
#endif

enum { CLI_OK = 0, CLI_FAILED = 1, CLI_USAGE = 2 }; /* exit codes */

/* Prints "lineao: ..." as one line on standard error; control characters become spaces. Returns
 * false, for `return cli_fail(...)`. */
bool cli_fail(const char *format, ...) CLI_PRINTF(1, 2);

/* "lineao: place: warning: text" */
void cli_warn(const char *place, const char *text);

/* Who hears all that instead of the terminal, and cancels instead of Ctrl-C: for programs with a
 * window. Any function may be NULL. */
typedef struct cli_listener {
    /* "FILE: what is wrong", or a warning */
    void (*say)(void *user, bool failure, const char *line);
    void (*progress)(void *user, const char *doing, const char *name, double part); /* 0 .. 1 */
    bool (*interrupted)(void *user);
    void *user;
} cli_listener;

/* From now on, for what the calling thread does; it must outlive that. NULL: the terminal. */
void cli_listen(const cli_listener *listener);
const cli_listener *cli_listening(void);

/* Holds Ctrl-C back, so that the work can stop where nothing is half done. */
void cli_interrupt_hold(void);
/* Was Ctrl-C pressed? Never cleared. */
bool cli_interrupted(void);
/* False, with its failure, once Ctrl-C was pressed. */
bool cli_go_on(void);

/* A line "lineao: doing NAME 42 %" that is drawn over itself; nothing unless on a terminal. */
typedef struct cli_progress {
    const char *doing, *name;
    int shown; /* last percentage, -1: none */
} cli_progress;
void cli_progress_show(cli_progress *progress, uint64_t done, uint64_t total);
void cli_progress_end(cli_progress *progress);

/* The candidate that `text` is most likely a misspelling of, or NULL. next(user, i) ends with NULL.
 */
const char *cli_nearest(const char *text, const char *(*next)(const void *user, uint32_t index),
                        const void *user);

/* A whole text that is a finite decimal number, whatever the locale. */
bool cli_number(const char *text, double *value);
/* `count` numbers with commas between them. */
bool cli_numbers(const char *text, double *values, uint32_t count);

/* The shortest decimal text that reads back as the same float. */
void cli_shortest(float value, char *text, size_t size);

/* Can a file of that name be made? Reports the failure. NULL is fine. */
bool cli_writable(const char *path);
/* Writes a whole text file, or none. Reports the failure. */
bool cli_write_text(const char *path, const char *text);

/* malloc(count * size) that does not overflow and reports the failure; never NULL for 0. */
void *cli_new(size_t count, size_t size);

#endif
