#include "loader.h"

#include <GLFW/glfw3.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages ---------------------------------------------------------------------------- */

struct messages {
    pthread_mutex_t lock;
    uint32_t count;
    bool failures[MESSAGE_COUNT];
    char texts[MESSAGE_COUNT][MESSAGE_SIZE];
};

messages *messages_new(void) {
    messages *m = cli_new(1, sizeof *m);
    if (m) {
        memset(m, 0, sizeof *m);
        pthread_mutex_init(&m->lock, NULL);
    }
    return m;
}

void messages_free(messages *m) {
    if (m)
        pthread_mutex_destroy(&m->lock);
    free(m);
}

void messages_add(messages *m, bool failure, const char *text) {
    pthread_mutex_lock(&m->lock);
    uint32_t at = m->count++ % MESSAGE_COUNT;
    m->failures[at] = failure;
    snprintf(m->texts[at], MESSAGE_SIZE, "%s", text);
    pthread_mutex_unlock(&m->lock);
}

bool messages_get(messages *m, uint32_t i, bool *failure, char text[MESSAGE_SIZE]) {
    pthread_mutex_lock(&m->lock);
    bool there = i < m->count && i < MESSAGE_COUNT;
    if (there) {
        uint32_t at = (m->count - 1 - i) % MESSAGE_COUNT;
        *failure = m->failures[at];
        memcpy(text, m->texts[at], MESSAGE_SIZE);
    }
    pthread_mutex_unlock(&m->lock);
    return there;
}

uint32_t messages_count(messages *m) {
    pthread_mutex_lock(&m->lock);
    uint32_t count = m->count;
    pthread_mutex_unlock(&m->lock);
    return count;
}

void messages_clear(messages *m) {
    pthread_mutex_lock(&m->lock);
    m->count = 0;
    pthread_mutex_unlock(&m->lock);
}

/* ---- loading ----------------------------------------------------------------------------- */

struct loader {
    pthread_mutex_t lock; /* over all that follows, but for `thread`, `started` and `words` */
    messages *messages;
    bool running, cancel;
    char doing[MESSAGE_SIZE];
    float part;
    document *done;     /* owned: opened */
    document *measured; /* not owned: measured, or being measured */
    bool ok;            /* it could be */
    cli_listener listener;
    pthread_t thread;
    bool started;
    char **words; /* owned */
    uint32_t count, added;
};

static bool interrupted(void *user) {
    loader *l = user;
    pthread_mutex_lock(&l->lock);
    bool cancel = l->cancel;
    pthread_mutex_unlock(&l->lock);
    return cancel;
}

static void say(void *user, bool failure, const char *line) {
    loader *l = user;
    if (!failure || !interrupted(l)) /* who cancels knows */
        messages_add(l->messages, failure, line);
    glfwPostEmptyEvent();
}

static void progress(void *user, const char *doing, const char *name, double part) {
    loader *l = user;
    pthread_mutex_lock(&l->lock);
    snprintf(l->doing, sizeof l->doing, "%s %s", doing, name);
    l->part = (float)part;
    pthread_mutex_unlock(&l->lock);
    glfwPostEmptyEvent();
}

static void *work(void *user) {
    loader *l = user;
    document *opened = NULL;
    bool ok = true;
    cli_listen(&l->listener);
    if (l->measured)
        ok = document_measure(l->measured);
    else
        opened = document_open((const char *const *)l->words, l->count, l->added);
    pthread_mutex_lock(&l->lock);
    l->done = opened;
    l->ok = ok;
    l->running = false;
    pthread_mutex_unlock(&l->lock);
    glfwPostEmptyEvent();
    return NULL;
}

loader *loader_new(messages *m) {
    loader *l = cli_new(1, sizeof *l);
    if (!l)
        return NULL;
    memset(l, 0, sizeof *l);
    pthread_mutex_init(&l->lock, NULL);
    l->messages = m;
    l->listener = (cli_listener){say, progress, interrupted, l};
    return l;
}

void loader_cancel(loader *l) {
    pthread_mutex_lock(&l->lock);
    l->cancel = true;
    pthread_mutex_unlock(&l->lock);
}

void loader_stop(loader *l) {
    loader_cancel(l);
    if (l->started)
        pthread_join(l->thread, NULL);
    l->started = false;
    document_close(l->done);
    l->done = l->measured = NULL;
    for (uint32_t i = 0; i < l->count; i++)
        free(l->words[i]);
    free(l->words);
    l->words = NULL;
    l->count = 0;
}

void loader_free(loader *l) {
    if (!l)
        return;
    loader_stop(l);
    pthread_mutex_destroy(&l->lock);
    free(l);
}

bool loader_start(loader *l, const char *const *words, uint32_t count) {
    return loader_add(l, words, count, 0);
}

/* What was under way has been finished. */
static bool begin(loader *l, const char *doing) {
    l->cancel = false;
    l->part = 0;
    l->running = true;
    snprintf(l->doing, sizeof l->doing, "%s", doing);
    l->started = pthread_create(&l->thread, NULL, work, l) == 0;
    if (l->started)
        return true; /* from here on the thread says when it is done */
    l->running = false;
    l->measured = NULL;
    return cli_fail("no more threads to work in");
}

bool loader_add(loader *l, const char *const *words, uint32_t count, uint32_t added) {
    bool ok = true;
    loader_stop(l);
    l->words = cli_new(count, sizeof *l->words);
    for (uint32_t i = 0; l->words && ok && i < count; i++) {
        l->words[i] = cli_new(strlen(words[i]) + 1, 1);
        ok = l->words[i] != NULL;
        if (ok) {
            strcpy(l->words[i], words[i]);
            l->count++;
        }
    }
    l->added = added;
    return l->words && ok && begin(l, "opening");
}

bool loader_measure(loader *l, document *doc) {
    loader_stop(l);
    l->measured = doc;
    return begin(l, "measuring");
}

bool loader_busy(loader *l, char text[MESSAGE_SIZE], float *part) {
    pthread_mutex_lock(&l->lock);
    bool busy = l->running;
    memcpy(text, l->doing, MESSAGE_SIZE);
    *part = l->part;
    pthread_mutex_unlock(&l->lock);
    return busy;
}

document *loader_take(loader *l) {
    pthread_mutex_lock(&l->lock);
    document *doc = l->done;
    l->done = NULL;
    pthread_mutex_unlock(&l->lock);
    return doc;
}

bool loader_measures(loader *l) {
    return l->measured != NULL;
}

document *loader_measured(loader *l, bool *ok) {
    pthread_mutex_lock(&l->lock);
    document *doc = l->running ? NULL : l->measured;
    *ok = l->ok;
    if (doc)
        l->measured = NULL;
    pthread_mutex_unlock(&l->lock);
    return doc;
}
