#include "threads.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_THREADS = 256 };

struct cli_threads {
    pthread_mutex_t lock; /* over all that follows, but for progress */
    pthread_cond_t begin, end;
    pthread_t workers[MOST_THREADS];
    uint32_t worker_count; /* besides the calling thread */
    void (*fn)(void *arg, uint32_t index);
    void *arg;
    uint32_t next, count, busy; /* next index to take; workers that are inside fn */
    bool quit;
    cli_progress *progress;
    const cli_listener *listener; /* of the calling thread */
};

/* Takes indices until none is left; the lock is held before and after. */
static void work(cli_threads *t) {
    while (t->next < t->count) {
        uint32_t index = t->next++;
        pthread_mutex_unlock(&t->lock);
        t->fn(t->arg, index);
        pthread_mutex_lock(&t->lock);
    }
}

static void *worker(void *user) {
    cli_threads *t = user;
    cli_listen(t->listener);
    pthread_mutex_lock(&t->lock);
    while (!t->quit) {
        if (t->next < t->count) {
            t->busy++;
            work(t);
            if (--t->busy == 0)
                pthread_cond_signal(&t->end);
        } else {
            pthread_cond_wait(&t->begin, &t->lock);
        }
    }
    pthread_mutex_unlock(&t->lock);
    return NULL;
}

static void run(void *user, uint32_t count, void (*fn)(void *arg, uint32_t index), void *arg) {
    cli_threads *t = user;
    pthread_mutex_lock(&t->lock);
    t->fn = fn;
    t->arg = arg;
    t->next = 0;
    t->count = count;
    pthread_cond_broadcast(&t->begin);
    work(t);
    while (t->busy)
        pthread_cond_wait(&t->end, &t->lock);
    t->count = 0;
    pthread_mutex_unlock(&t->lock);
}

static int on_progress(void *user, uint64_t done, uint64_t total) {
    cli_threads *t = user;
    if (t->progress)
        cli_progress_show(t->progress, done, total);
    return cli_interrupted();
}

/* LINEAO_THREADS where it is a whole number in 1 .. 256, else what the machine runs at once. */
static uint32_t wanted_threads(void) {
    const char *text = getenv("LINEAO_THREADS");
    double number;
    if (text && cli_number(text, &number) && number >= 1)
        return number < MOST_THREADS ? (uint32_t)number : MOST_THREADS;
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online < 1 ? 1 : online < MOST_THREADS ? (uint32_t)online : MOST_THREADS;
}

cli_threads *cli_threads_start(void) {
    cli_threads *t = cli_new(1, sizeof *t);
    if (!t)
        return NULL;
    memset(t, 0, sizeof *t);
    t->listener = cli_listening();
    pthread_mutex_init(&t->lock, NULL);
    pthread_cond_init(&t->begin, NULL);
    pthread_cond_init(&t->end, NULL);
    uint32_t wanted = wanted_threads() - 1;
    while (t->worker_count < wanted &&
           pthread_create(&t->workers[t->worker_count], NULL, worker, t) == 0)
        t->worker_count++;
    return t;
}

void cli_threads_stop(cli_threads *t) {
    if (!t)
        return;
    pthread_mutex_lock(&t->lock);
    t->quit = true;
    pthread_cond_broadcast(&t->begin);
    pthread_mutex_unlock(&t->lock);
    for (uint32_t i = 0; i < t->worker_count; i++)
        pthread_join(t->workers[i], NULL);
    pthread_cond_destroy(&t->begin);
    pthread_cond_destroy(&t->end);
    pthread_mutex_destroy(&t->lock);
    free(t);
}

uint32_t cli_threads_count(const cli_threads *t) {
    return t->worker_count + 1;
}

lao_job cli_threads_job(cli_threads *t, cli_progress *progress) {
    lao_job job = {run, on_progress, t};
    t->progress = progress;
    return job;
}
