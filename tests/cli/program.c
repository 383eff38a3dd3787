#include "program.h"

#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* NULL where it cannot be read. */
static char *load(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    rewind(file);
    char *text = calloc((size_t)size + 1, 1);
    if (text && fread(text, 1, (size_t)size, file) != (size_t)size)
        text[0] = '\0';
    fclose(file);
    return text;
}

/* What a run said, whose file goes. */
static char *take(const char *path) {
    char *text = load(path);
    remove(path);
    return text ? text : calloc(1, 1);
}

/* In the child. A signal that is blocked and pending stays so in the new program. */
static void become(const char *program, char *line, const char *out, const char *err,
                   bool interrupted) {
    char *words[64] = {0};
    int count = 0;
    words[count++] = strdup(program);
    for (char *word = strtok(line, " "); word && count < 63; word = strtok(NULL, " "))
        words[count++] = word;
    int files[2] = {open(out, O_WRONLY | O_CREAT | O_TRUNC, 0600),
                    open(err, O_WRONLY | O_CREAT | O_TRUNC, 0600)};
    if (files[0] < 0 || files[1] < 0 || dup2(files[0], 1) < 0 || dup2(files[1], 2) < 0)
        _exit(126);
    if (interrupted) {
        sigset_t set;
        sigemptyset(&set);
        sigaddset(&set, SIGINT);
        sigprocmask(SIG_BLOCK, &set, NULL);
        raise(SIGINT);
    }
    /* dozens of programs compile the same shaders: they share a cache of this test's own */
    setenv("MESA_SHADER_CACHE_DISABLE", "false", 1);
    setenv("MESA_SHADER_CACHE_DIR", "shaders.cache", 1);
    execv(program, words);
    _exit(127);
}

program_run program_start(const char *program, bool interrupted, const char *line, ...) {
    program_run run = {-1, NULL, NULL};
    char text[4096], out[64], err[64];
    va_list arguments;
    va_start(arguments, line);
    vsnprintf(text, sizeof text, line, arguments);
    va_end(arguments);
    snprintf(out, sizeof out, "cli_%ld.out", (long)getpid());
    snprintf(err, sizeof err, "cli_%ld.err", (long)getpid());
    pid_t child = fork();
    if (child == 0)
        become(program, text, out, err, interrupted);
    int status;
    if (child > 0 && waitpid(child, &status, 0) == child)
        run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    run.out = take(out);
    run.err = take(err);
    return run;
}

void program_free(program_run *run) {
    free(run->out);
    free(run->err);
}

int program_lines(const char *text) {
    int count = 0;
    for (; *text; text++)
        count += *text == '\n';
    return count;
}

void expect_fault(program_run run, int code, const char *word) {
    if (run.code != code || !strstr(run.err, word))
        print_error("expected %d and '%s', got %d: %s", code, word, run.code, run.err);
    assert_int_equal(run.code, code);
    assert_int_equal(program_lines(run.err), 1);
    assert_int_equal(strncmp(run.err, "lineao: ", 8), 0);
    assert_non_null(strstr(run.err, word));
    assert_string_equal(run.out, "");
    program_free(&run);
}

char *read_text(const char *path) {
    char *text = load(path);
    assert_non_null(text);
    assert_true(text[0] != 0);
    return text;
}

cJSON *read_json(const char *path) {
    char *text = read_text(path);
    cJSON *json = cJSON_Parse(text);
    assert_non_null(json);
    free(text);
    return json;
}
