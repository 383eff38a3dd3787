/* A fixed pool of threads behind lao_job: as many as the machine runs at once, or as the
 * environment variable LINEAO_THREADS says. */
#ifndef LINEAO_CLI_THREADS_H
#define LINEAO_CLI_THREADS_H

#include "lineao.h"
#include "report.h"

typedef struct cli_threads cli_threads;

/* Starts the pool; fewer threads, down to the calling one alone, when the system gives no more.
 * NULL: reported. */
cli_threads *cli_threads_start(void);
/* Ends the threads. NULL is fine. */
void cli_threads_stop(cli_threads *threads);
/* Threads that work, the calling one included. */
uint32_t cli_threads_count(const cli_threads *threads);

/* The pool as a job. Its progress draws `progress` (NULL: nothing) and cancels on Ctrl-C. One run
 * at a time, from one thread; fn must not start another. */
lao_job cli_threads_job(cli_threads *threads, cli_progress *progress);

#endif
