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
    uint32_t level, serial, revision; /* revision: of the document */
    set_copy *sets;                   /* owned */
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
    uint32_t revision;
    camera_pose camera;
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
    free(r->values);
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
    const double *contours = doc->options.surface.contours;
    bool timed = doc->command == CLI_SURFACE; /* whose distances go up with the object */
    bool aimed = timed && (contours[0] > 0 || contours[1] > 0); /* and whose lines with the scene */
    if (s->open && s->backend == w->look.backend && s->revision == w->revision &&
        (!timed || s->time == w->shot.time) &&
        (!aimed || memcmp(&s->camera, &w->shot.camera, sizeof s->camera) == 0))
        return true;
    close_session(s);
    pthread_mutex_lock(&s->compare->data);
    s->open = true;
    s->backend = w->look.backend;
    s->time = w->shot.time;
    s->revision = w->revision;
    s->camera = w->shot.camera;
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

/* A struct of settings: uint64_t set; float values[]. */
static void give(void *settings, const compare_look *look) {
    uint64_t *set = settings;
    float *values = (float *)(void *)(set + 1);
    values[look->setting] = look->value;
    *set |= (uint64_t)1 << look->setting;
}

/* The one setting that differs, to the set that it belongs to; what is of the whole picture to all
 * of them. A wall and its lines (lineao surface) share theirs. */
static void give_one(side *s, const wish *w, uint32_t set) {
    const document *doc = s->compare->doc;
    const document_settings *row = w->look.index < 0 ? NULL : &doc->settings[w->look.index];
    if (!row)
        return;
    for (uint32_t m = 0; m < doc->scene->module_count; m++) {
        if (doc->scene->sets[set].module_settings[m] == row->now)
            give(s->sets[set].modules[m], &w->look);
    }
    if (row->module != lao_lines_module())
        return;
    bool whole = w->look.setting == LAO_SETTING_ID_supersampling;
    bool walls = doc->command == CLI_SURFACE && w->look.setting != LAO_SETTING_ID_occlusion;
    if (row->set == set || whole || (walls && set == 0))
        give(&s->sets[set].lines, &w->look);
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
        give_one(s, w, i);
        s->session.sets[i].settings = &copy->lines;
        s->session.sets[i].module_settings = copy->list;
    }
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
        out->values = cli_session_image(&s->session, w->image, w->level, &info);
    }
    if (!out->pixels && !out->values)
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
        w->revision = c->doc->revision;
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

/* Numbers as grays and colours between the least and the greatest, which are those of both sides,
 * so that a colour is the same number in both. */
static void find_range(const compare_result *r, float range[2]) {
    size_t count = r->values ? (size_t)r->width * r->height * r->channels : 0;
    for (size_t i = 0; i < count; i++) {
        if (isfinite(r->values[i]) && fabsf(r->values[i]) < 1e29f) {
            range[0] = fminf(range[0], r->values[i]);
            range[1] = fmaxf(range[1], r->values[i]);
        }
    }
}

static void paint(compare_result *r, const float range[2]) {
    size_t count = (size_t)r->width * r->height;
    float low = range[0], scale = range[1] > low ? 255 / (range[1] - low) : 0;
    if (!r->values)
        return;
    r->pixels = cli_new(count, 4);
    memcpy(r->range, range, sizeof r->range);
    for (size_t i = 0; r->pixels && i < count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t from = r->channels < 2 ? 0 : k;
            float v = from < r->channels ? r->values[i * r->channels + from] : low;
            r->pixels[4 * i + k] =
                (uint8_t)(isfinite(v) ? fmaxf(0, fminf(255, (v - low) * scale + 0.5f)) : 255);
        }
        r->pixels[4 * i + 3] = 255;
    }
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
    float range[2] = {INFINITY, -INFINITY};
    for (int i = 0; i < 2 && news; i++)
        find_range(&c->shown[i], range);
    for (int i = 0; i < 2 && news; i++)
        paint(&c->shown[i], range);
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

static unsigned ones(unsigned x) {
    unsigned count = 0;
    for (; x; x &= x - 1)
        count++;
    return count;
}

/* Of one pixel: its number k, or its byte. */
static float value_of(const compare_result *r, size_t pixel, uint32_t k) {
    return r->values ? r->values[pixel * r->channels + k] : (float)r->pixels[4 * pixel + k];
}

compare_count compare_differences(const compare_result *a, const compare_result *b) {
    compare_count c = {-1, 0, 0, 0};
    size_t count = (size_t)a->width * a->height, size = count ? a->bytes / count : 0;
    if (a->bytes != b->bytes || a->width != b->width || !a->texels || !b->texels || !size ||
        !a->pixels || !b->pixels)
        return c;
    c.bits = 0;
    c.all = 8 * (int64_t)a->bytes;
    for (size_t i = 0; i < count; i++) {
        size_t at = i * size;
        if (memcmp(a->texels + at, b->texels + at, size) == 0)
            continue;
        c.pixels++;
        for (size_t k = at; k < at + size; k++)
            c.bits += ones((unsigned)(a->texels[k] ^ b->texels[k]));
    }
    for (size_t i = 0; i < count && c.bits; i++) { /* rows may be the other way round */
        for (uint32_t k = 0; k < a->channels; k++) {
            float d = fabsf(value_of(a, i, k) - value_of(b, i, k));
            c.worst = d > c.worst ? d : c.worst;
        }
    }
    return c;
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
