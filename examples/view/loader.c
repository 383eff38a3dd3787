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
    document *done;
    cli_listener listener;
    pthread_t thread;
    bool started;
    char **words; /* owned */
    uint32_t count, added;
};

static void say(void *user, bool failure, const char *line) {
    loader *l = user;
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

static bool interrupted(void *user) {
    loader *l = user;
    pthread_mutex_lock(&l->lock);
    bool cancel = l->cancel;
    pthread_mutex_unlock(&l->lock);
    return cancel;
}

static void *work(void *user) {
    loader *l = user;
    cli_listen(&l->listener);
    document *doc = document_open((const char *const *)l->words, l->count, l->added);
    pthread_mutex_lock(&l->lock);
    l->done = doc;
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

static void finish(loader *l) {
    if (l->started)
        pthread_join(l->thread, NULL);
    l->started = false;
    document_close(l->done);
    l->done = NULL;
    for (uint32_t i = 0; i < l->count; i++)
        free(l->words[i]);
    free(l->words);
    l->words = NULL;
    l->count = 0;
}

void loader_cancel(loader *l) {
    pthread_mutex_lock(&l->lock);
    l->cancel = true;
    pthread_mutex_unlock(&l->lock);
}

void loader_free(loader *l) {
    if (!l)
        return;
    loader_cancel(l);
    finish(l);
    pthread_mutex_destroy(&l->lock);
    free(l);
}

bool loader_start(loader *l, const char *const *words, uint32_t count) {
    return loader_add(l, words, count, 0);
}

bool loader_add(loader *l, const char *const *words, uint32_t count, uint32_t added) {
    bool ok = true;
    loader_cancel(l);
    finish(l);
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
    l->cancel = false;
    l->part = 0;
    l->running = true;
    snprintf(l->doing, sizeof l->doing, "opening");
    ok = ok && l->words && pthread_create(&l->thread, NULL, work, l) == 0;
    l->started = ok;
    l->running = ok;
    return ok || cli_fail("out of memory");
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
