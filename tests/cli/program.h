/* Runs the lineao program as a user does and keeps what it said. */
#ifndef LINEAO_TEST_PROGRAM_H
#define LINEAO_TEST_PROGRAM_H

#include <stdbool.h>

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

#endif
