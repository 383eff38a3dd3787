#include "compare.h"

#include "report.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SETTINGS = 64 }; /* of a module */

/* Copies of all settings of a set. */
typedef struct set_copy {
    lao_settings lines;
    uint64_t modules[CLI_MODULES][MOST_SETTINGS / 2 + 1];
    const void *list[CLI_MODULES]; /* of these, or NULL */
} set_copy;

typedef struct wish {
    cli_shot shot;
    compare_look look;
    char image[COMPARE_NAME];
    uint32_t level, serial;
    set_copy *sets; /* owned */
} wish;

typedef struct side {
    struct compare *compare;
    pthread_t thread;
    bool running;
    wish wish;              /* under the lock */
    compare_result made[2]; /* [0]: being made by the thread; [1]: done, under the lock */
    uint32_t done;          /* serial of made[1] */
    cli_session session;    /* of the thread alone, as all that follows */
    bool open, fresh;       /* fresh: it has drawn nothing, and a first frame builds shaders */
    int backend;
    float time;
    set_copy *sets;
} side;

struct compare {
    pthread_mutex_t lock, data; /* data: of the document */
    pthread_cond_t wake;
    const document *doc;
    const cli_listener *listener;
    side sides[2];
    uint32_t serial, taken;
    bool quit;
    compare_result shown[2];
};

static const char *const backends[2] = {"gl", "vk"};

static void free_result(compare_result *r) {
    free(r->pixels);
    free(r->texels);
    memset(r, 0, sizeof *r);
}

/* ---- in the thread ----------------------------------------------------------------------- */

static void close_session(side *s) {
    if (s->open)
        cli_session_close(&s->session);
    s->open = false;
}

/* The session draws with copies, as the window's settings may change meanwhile. */
static bool open_session(side *s, const wish *w) {
    const document *doc = s->compare->doc;
    bool timed = doc->command == CLI_SURFACE; /* whose distances go up with the object */
    if (s->open && s->backend == w->look.backend && (!timed || s->time == w->shot.time))
        return true;
    close_session(s);
    pthread_mutex_lock(&s->compare->data);
    s->open = true;
    s->backend = w->look.backend;
    s->time = w->shot.time;
    bool ok = cli_session_open(&s->session, backends[s->backend], doc->scene, &w->shot,
                               LAO_VIEW_KEEP_IMAGES);
    pthread_mutex_unlock(&s->compare->data);
    if (!ok)
        close_session(s);
    s->fresh = ok;
    return ok;
}

static void copy_set(const cli_scene *scene, uint32_t set, set_copy *out) {
    out->lines = scene->sets[set].settings;
    for (uint32_t m = 0; m < scene->module_count; m++) {
        const void *from = scene->sets[set].module_settings[m];
        if (from)
            memcpy(out->modules[m], from,
                   sizeof(uint64_t) + scene->modules[m]->setting_count * sizeof(float));
    }
}

static void take_settings(side *s, const wish *w) {
    const cli_scene *scene = s->compare->doc->scene;
    memcpy(s->sets, w->sets, scene->count * sizeof *s->sets);
    for (uint32_t i = 0; i < scene->count; i++) {
        set_copy *copy = &s->sets[i];
        if (w->look.preset > 0) {
            copy->lines.preset = (float)(w->look.preset - 1);
            copy->lines.set |= LAO_SET(preset);
        }
        for (uint32_t m = 0; m < scene->module_count; m++)
            copy->list[m] = scene->sets[i].module_settings[m] ? copy->modules[m] : NULL;
        s->session.sets[i].settings = &copy->lines;
        s->session.sets[i].module_settings = copy->list;
    }
}

/* Numbers as grays and colours between the least and the greatest. */
static uint8_t *paint(const float *values, const lao_read_info *info) {
    size_t count = (size_t)info->width * info->height;
    uint8_t *pixels = cli_new(count, 4);
    float low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < count * info->channels; i++) {
        if (isfinite(values[i]) && fabsf(values[i]) < 1e29f) {
            low = fminf(low, values[i]);
            high = fmaxf(high, values[i]);
        }
    }
    float scale = high > low ? 255 / (high - low) : 0;
    for (size_t i = 0; pixels && i < count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t from = info->channels < 2 ? 0 : k;
            float v = from < info->channels ? values[i * info->channels + from] : low;
            pixels[4 * i + k] =
                (uint8_t)(isfinite(v) ? fmaxf(0, fminf(255, (v - low) * scale + 0.5f)) : 255);
        }
        pixels[4 * i + 3] = 255;
    }
    return pixels;
}

static bool read_image(side *s, const wish *w, compare_result *out) {
    lao_read_info info, raw;
    if (strcmp(w->image, "out") == 0) {
        picture p = {0, 0, NULL};
        if (!cli_session_picture(&s->session, &p))
            return false;
        out->pixels = p.pixels;
        info.width = p.width;
        info.height = p.height;
        info.channels = 4;
    } else {
        float *values = cli_session_image(&s->session, w->image, w->level, &info);
        out->pixels = values ? paint(values, &info) : NULL;
        free(values);
    }
    if (!out->pixels)
        return false;
    out->width = info.width;
    out->height = info.height;
    out->channels = info.channels;
    out->texels = cli_session_texels(&s->session, w->image, w->level, &raw);
    out->bytes = (size_t)raw.width * raw.height * raw.channels;
    return out->texels != NULL;
}

static void draw(side *s, const wish *w) {
    compare_result *out = &s->made[0];
    free_result(out);
    if (!open_session(s, w))
        return;
    take_settings(s, w);
    out->pass_count = COMPARE_PASSES;
    if (s->fresh)
        cli_session_render(&s->session, &w->shot, 0);
    s->fresh = false;
    if (lao_view_resize(s->session.context, s->session.view, w->shot.width, w->shot.height) !=
            LAO_OK ||
        !cli_session_render(&s->session, &w->shot, LAO_FRAME_TIMINGS) || !read_image(s, w, out) ||
        lao_timings(s->session.context, s->session.view, out->passes, &out->pass_count) != LAO_OK)
        out->pass_count = 0;
    out->milliseconds = s->session.milliseconds;
}

static void *work(void *user) {
    side *s = user;
    compare *c = s->compare;
    uint32_t drawn = 0;
    cli_listen(c->listener);
    pthread_mutex_lock(&c->lock);
    while (!c->quit) {
        if (s->wish.serial == drawn) {
            pthread_cond_wait(&c->wake, &c->lock);
            continue;
        }
        wish w = s->wish;
        s->wish.sets = NULL; /* taken over */
        drawn = w.serial;
        pthread_mutex_unlock(&c->lock);
        draw(s, &w);
        free(w.sets);
        pthread_mutex_lock(&c->lock);
        free_result(&s->made[1]);
        s->made[1] = s->made[0];
        memset(&s->made[0], 0, sizeof s->made[0]);
        s->done = drawn;
        glfwPostEmptyEvent();
    }
    pthread_mutex_unlock(&c->lock);
    close_session(s);
    return NULL;
}

/* ---- for the window ---------------------------------------------------------------------- */

compare *compare_start(const document *doc, const cli_listener *listener) {
    compare *c = cli_new(1, sizeof *c);
    if (!c)
        return NULL;
    memset(c, 0, sizeof *c);
    pthread_mutex_init(&c->lock, NULL);
    pthread_mutex_init(&c->data, NULL);
    pthread_cond_init(&c->wake, NULL);
    c->doc = doc;
    c->listener = listener;
    bool ok = true;
    for (int i = 0; i < 2 && ok; i++) {
        side *s = &c->sides[i];
        s->compare = c;
        s->sets = cli_new(doc->scene->count, sizeof *s->sets);
        ok = s->sets && (pthread_create(&s->thread, NULL, work, s) == 0 ||
                         cli_fail("no more threads for a comparison"));
        s->running = ok;
    }
    if (ok)
        return c;
    compare_stop(c);
    return NULL;
}

void compare_stop(compare *c) {
    if (!c)
        return;
    pthread_mutex_lock(&c->lock);
    c->quit = true;
    pthread_cond_broadcast(&c->wake);
    pthread_mutex_unlock(&c->lock);
    for (int i = 0; i < 2; i++) {
        side *s = &c->sides[i];
        if (s->running)
            pthread_join(s->thread, NULL);
        free_result(&s->made[0]);
        free_result(&s->made[1]);
        free_result(&c->shown[i]);
        free(s->wish.sets);
        free(s->sets);
    }
    pthread_cond_destroy(&c->wake);
    pthread_mutex_destroy(&c->lock);
    pthread_mutex_destroy(&c->data);
    free(c);
}

void compare_ask(compare *c, const cli_shot *shot, const compare_look looks[2], const char *image,
                 uint32_t level) {
    const cli_scene *scene = c->doc->scene;
    pthread_mutex_lock(&c->lock);
    c->serial++;
    for (int i = 0; i < 2; i++) {
        wish *w = &c->sides[i].wish;
        if (!w->sets)
            w->sets = cli_new(scene->count, sizeof *w->sets);
        if (!w->sets)
            break;
        w->shot = *shot;
        w->look = looks[i];
        w->level = level;
        w->serial = c->serial;
        strncpy(w->image, image, sizeof w->image - 1);
        for (uint32_t s = 0; s < scene->count; s++)
            copy_set(scene, s, &w->sets[s]);
    }
    pthread_cond_broadcast(&c->wake);
    pthread_mutex_unlock(&c->lock);
}

void compare_results(const compare *c, const compare_result *results[2]) {
    results[0] = &c->shown[0];
    results[1] = &c->shown[1];
}

bool compare_take(compare *c) {
    pthread_mutex_lock(&c->lock);
    uint32_t done = c->sides[0].done;
    bool news = done == c->sides[1].done && done != c->taken;
    for (int i = 0; i < 2 && news; i++) {
        free_result(&c->shown[i]);
        c->shown[i] = c->sides[i].made[1];
        memset(&c->sides[i].made[1], 0, sizeof c->sides[i].made[1]);
    }
    if (news)
        c->taken = done;
    pthread_mutex_unlock(&c->lock);
    return news;
}

bool compare_busy(compare *c) {
    pthread_mutex_lock(&c->lock);
    bool busy = c->taken != c->serial; /* what is drawn but not taken is still to be shown */
    pthread_mutex_unlock(&c->lock);
    return busy;
}

void compare_lock(compare *c) {
    if (c)
        pthread_mutex_lock(&c->data);
}

void compare_unlock(compare *c) {
    if (c)
        pthread_mutex_unlock(&c->data);
}

int64_t compare_bits(const compare_result *a, const compare_result *b) {
    int64_t count = 0;
    if (a->bytes != b->bytes || !a->texels || !b->texels)
        return -1;
    for (size_t i = 0; i < a->bytes; i++) {
        for (unsigned x = (unsigned)(a->texels[i] ^ b->texels[i]); x; x &= x - 1)
            count++;
    }
    return count;
}

uint8_t *compare_difference(const compare_result *a, const compare_result *b, float gain) {
    if (a->width != b->width || a->height != b->height || !a->pixels || !b->pixels)
        return NULL;
    size_t count = (size_t)a->width * a->height;
    uint8_t *pixels = cli_new(count, 4);
    for (size_t i = 0; pixels && i < 4 * count; i++) {
        float d = fabsf((float)a->pixels[i] - (float)b->pixels[i]) * gain;
        pixels[i] = i % 4 == 3 ? 255 : (uint8_t)fminf(255, d);
    }
    return pixels;
}
