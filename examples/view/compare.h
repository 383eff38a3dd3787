/* Two pictures of one view, each from a session of its own in a thread of its own: OpenGL beside
 * Vulkan, one preset beside another, or one value of a setting beside another. */
#ifndef LINEAO_VIEW_COMPARE_H
#define LINEAO_VIEW_COMPARE_H

#include "document.h"

enum { COMPARE_PASSES = 160, COMPARE_NAME = 64 };

/* What one side draws with. */
typedef struct compare_look {
    int backend; /* 0: gl, 1: vk */
    int preset;  /* 0: as it is; else 1 + the value of the setting `preset` */
    int index;   /* of document.settings; -1: all settings are as they are, but for this one: */
    int setting;
    float value;
} compare_look;

/* What one side has drawn. */
typedef struct compare_result {
    uint32_t width, height, channels; /* 0: there is no such image in this plan */
    uint8_t *pixels;                  /* owned; RGBA, top row first */
    float *values;                    /* owned; of images but "out": numbers, top row first */
    float range[2];                   /* least and greatest of both sides: black and white */
    uint8_t *texels;                  /* owned; as stored, `bytes` of them */
    size_t bytes;
    double milliseconds;
    lao_timing passes[COMPARE_PASSES];
    uint32_t pass_count;
} compare_result;

typedef struct compare compare;

/* Begins to draw the document, which must outlive it. NULL: reported. */
compare *compare_start(const document *doc, const cli_listener *listener);
void compare_stop(compare *c);
/* Asks both sides for an image ("out": the picture) of a shot; an earlier wish is dropped. */
void compare_ask(compare *c, const cli_shot *shot, const compare_look looks[2], const char *image,
                 uint32_t level);
/* Takes a new result, when both sides have one. False: there is none. */
bool compare_take(compare *c);
/* What was taken last. */
void compare_results(const compare *c, const compare_result *results[2]);
bool compare_busy(compare *c);
/* Around changes of the document's data. */
void compare_lock(compare *c);
void compare_unlock(compare *c);

/* How two images differ. */
typedef struct compare_count {
    int64_t bits; /* -1: they are of different sizes */
    int64_t all;  /* bits of an image */
    int64_t pixels;
    float worst; /* greatest difference of two numbers; of "out" in 255ths */
} compare_count;
compare_count compare_differences(const compare_result *a, const compare_result *b);
/* |a - b| * gain, opaque; for free(). NULL: reported, or the sizes differ. */
uint8_t *compare_difference(const compare_result *a, const compare_result *b, float gain);

#endif
