/* Runs the lineao program as a user does and keeps what it said. */
#ifndef LINEAO_TEST_PROGRAM_H
#define LINEAO_TEST_PROGRAM_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cjson/cJSON.h>
#include <cmocka.h>

/* What one run left behind; program_free releases it. */
typedef struct program_run {
    int code; /* exit code; 128 + signal when it was killed */
    char *out, *err;
} program_run;

/* Runs `program` with the words of `line` (no quotes; %s and friends are filled in first).
 * interrupted: Ctrl-C is pressed before it starts. */
program_run program_start(const char *program, bool interrupted, const char *line, ...);
void program_free(program_run *run);

/* Lines of a text. */
int program_lines(const char *text);

/* Ends the test unless the run failed with this code, nothing on standard output, and one line that
 * begins "lineao: " and holds `word`. Releases it. */
void expect_fault(program_run run, int code, const char *word);

/* All of a file that is not empty; for the caller's free() and cJSON_Delete(). */
char *read_text(const char *path);
cJSON *read_json(const char *path);

#endif
