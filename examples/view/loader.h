/* Opens documents beside the window, and measures in them: one at a time, in a thread of its own,
 * with progress and cancel; and keeps what the program's code says meanwhile. */
#ifndef LINEAO_VIEW_LOADER_H
#define LINEAO_VIEW_LOADER_H

#include "document.h"

enum { MESSAGE_COUNT = 32, MESSAGE_SIZE = 512 };

/* The last things that were said, failures and warnings. Of any thread. */
typedef struct messages messages;
messages *messages_new(void);
void messages_free(messages *m);
void messages_add(messages *m, bool failure, const char *text);
/* The i-th last one. False: there is none. */
bool messages_get(messages *m, uint32_t i, bool *failure, char text[MESSAGE_SIZE]);
uint32_t messages_count(messages *m); /* that were ever added */
void messages_clear(messages *m);

typedef struct loader loader;
/* NULL: reported. */
loader *loader_new(messages *m);
void loader_free(loader *l);
/* Cancels, and waits. */
void loader_stop(loader *l);
/* Begins to open; what was under way is cancelled first. False: reported. */
bool loader_start(loader *l, const char *const *words, uint32_t count);
/* The same, where the last `added` words are files that join the others (document_open). */
bool loader_add(loader *l, const char *const *words, uint32_t count, uint32_t added);
/* Measures what document_measure does, which must outlive it. False: reported. */
bool loader_measure(loader *l, document *doc);
void loader_cancel(loader *l);
/* Is work under way? Then what, and which part of it is done. */
bool loader_busy(loader *l, char text[MESSAGE_SIZE], float *part);
/* Is it a measurement? */
bool loader_measures(loader *l);
/* The document, once: NULL while there is none. */
document *loader_take(loader *l);
/* The document that has been measured, or not (*ok), once: NULL while there is none. */
document *loader_measured(loader *l, bool *ok);

#endif
