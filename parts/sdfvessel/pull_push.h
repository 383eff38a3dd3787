/* ================================================================================================
 * pull_push: fills an image from its weighted pixels. Uses host. */

typedef struct sdv__level {
    float *values, *weights;
    uint32_t width, height;
} sdv__level;
typedef struct sdv__pull {
    const sdv_pull_push_desc *desc;
    const sdv__level *fine, *coarse;
    lao_int exponent;
} sdv__pull;

/* Up to four channels of a texel from channel c on. */
static lao_v4 sdv__channels(const sdv__level *l, size_t texel, uint32_t channels, uint32_t c) {
    const float *v = l->values + texel * channels + c;
    uint32_t n = channels - c;
    return lao_v4_make(v[0], n > 1 ? v[1] : 0.0f, n > 2 ? v[2] : 0.0f, n > 3 ? v[3] : 0.0f);
}
static void sdv__channels_set(const sdv__level *l, size_t texel, uint32_t channels, uint32_t c,
                              lao_v4 value) {
    uint32_t k;
    for (k = 0; k < 4 && c + k < channels; k++) {
        l->values[texel * channels + c + k] = sdv__v4_at(value, k);
    }
}
static void sdv__pull_texel(const sdv__pull *p, uint32_t x, uint32_t y) {
    const sdv__level *fine = p->fine, *coarse = p->coarse;
    size_t texel = (size_t)coarse->width * y + x;
    uint32_t c, i, channels = p->desc->channels;
    float h = sdv_pull_share((lao_int)p->desc->pull);
    for (c = 0; c < channels; c += 4) {
        sdv_mix m = sdv_mix_start(lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f));
        for (i = 0; i < 4; i++) {
            uint32_t fx = 2 * x + (i & 1u), fy = 2 * y + (i >> 1);
            size_t child = (size_t)fine->width * fy + fx;
            if (fx < fine->width && fy < fine->height) {
                m = sdv_mix_add(m, sdv__channels(fine, child, channels, c), fine->weights[child],
                                h);
            }
        }
        sdv__channels_set(coarse, texel, channels, c, sdv_mix_value(m));
        coarse->weights[texel] = m.weight;
    }
}
static void sdv__push_texel(const sdv__pull *p, uint32_t x, uint32_t y) {
    const sdv__level *fine = p->fine, *coarse = p->coarse;
    size_t texel = (size_t)fine->width * y + x;
    uint32_t c, channels = p->desc->channels;
    lao_int i, push = (lao_int)p->desc->push;
    float own = sdv_push_own(fine->weights[texel], p->exponent), weight = 0.0f;
    for (c = 0; c < channels; c += 4) {
        sdv_mix m = sdv_mix_start(lao_v4_make(0.0f, 0.0f, 0.0f, 0.0f));
        for (i = 0; i < 4; i++) {
            lao_int px = sdv_push_parent((lao_int)x, i & 1);
            lao_int py = sdv_push_parent((lao_int)y, i >> 1);
            float h = sdv_push_share(push, i & 1) * sdv_push_share(push, i >> 1);
            if (px >= 0 && py >= 0 && px < (lao_int)coarse->width && py < (lao_int)coarse->height) {
                size_t parent = (size_t)coarse->width * (size_t)py + (size_t)px;
                m = sdv_mix_add(m, sdv__channels(coarse, parent, channels, c),
                                coarse->weights[parent], h);
            }
        }
        sdv__channels_set(fine, texel, channels, c,
                          sdv_push_value(m, sdv__channels(fine, texel, channels, c), own));
        weight = sdv_push_weight(m, own);
    }
    fine->weights[texel] = weight;
}
static void sdv__pull_rows(void *arg, uint32_t chunk) {
    const sdv__pull *p = (const sdv__pull *)arg;
    uint32_t x, y, first = chunk * SDV__CHUNK;
    for (y = first; y < first + SDV__CHUNK && y < p->coarse->height; y++) {
        for (x = 0; x < p->coarse->width; x++) {
            sdv__pull_texel(p, x, y);
        }
    }
}
static void sdv__push_rows(void *arg, uint32_t chunk) {
    const sdv__pull *p = (const sdv__pull *)arg;
    uint32_t x, y, first = chunk * SDV__CHUNK;
    for (y = first; y < first + SDV__CHUNK && y < p->fine->height; y++) {
        for (x = 0; x < p->fine->width; x++) {
            sdv__push_texel(p, x, y);
        }
    }
}
/* A pixel without a weight has no value either. */
static void sdv__pull_clean(const sdv__level *l, uint32_t channels) {
    size_t i, n = (size_t)l->width * l->height;
    for (i = 0; i < n; i++) {
        if (!(l->weights[i] > 0.0f)) {
            l->weights[i] = 0.0f;
            memset(l->values + i * channels, 0, channels * sizeof *l->values);
        }
    }
}
enum { SDV__LEVELS = 17 };
static uint32_t sdv__chunks(uint32_t rows) {
    return (rows + SDV__CHUNK - 1) / SDV__CHUNK;
}
static int sdv__pull_run(const sdv_host *host, sdv__level *levels, uint32_t count, sdv__pull *p) {
    sdv__work work;
    const sdv__level *top = levels + count - 1;
    uint32_t i;
    work.host = host;
    work.done = 0;
    work.total = 0;
    for (i = 0; i < count; i++) {
        work.total += (i ? sdv__chunks(levels[i].height) : 0u) +
                      (i + 1 < count ? sdv__chunks(levels[i].height) : 0u);
    }
    for (i = 1; i < count; i++) {
        p->fine = levels + i - 1;
        p->coarse = levels + i;
        if (sdv__run(&work, sdv__chunks(levels[i].height), sdv__pull_rows, p)) {
            return 1;
        }
    }
    top->weights[0] = top->weights[0] > 0.0f ? 1.0f : 0.0f;
    for (i = count - 1; i-- > 0 && top->weights[0] > 0.0f;) {
        p->fine = levels + i;
        p->coarse = levels + i + 1;
        if (sdv__run(&work, sdv__chunks(levels[i].height), sdv__push_rows, p)) {
            return 1;
        }
    }
    return 0;
}

SDV_API lao_result sdv_pull_push(const sdv_host *host, const sdv_pull_push_desc *desc,
                                 uint32_t *empty) {
    lao_allocator a = sdv__allocator(host);
    sdv__level levels[SDV__LEVELS];
    sdv__pull p;
    uint64_t texels = 0;
    uint32_t i, count = 1;
    float *memory, *at;
    int cancelled;
    if (!desc || !desc->values || !desc->weights) {
        return sdv__fail(host, SDV_LOG_NULL_ARGUMENT, "sdv_pull_push");
    }
    if (desc->width < 1 || desc->height < 1 || desc->width > 32768 || desc->height > 32768 ||
        desc->channels < 1 || desc->channels > 64) {
        return sdv__fail(host, SDV_LOG_IMAGE_SIZE, "%u x %u, %u channels", desc->width,
                         desc->height, desc->channels);
    }
    levels[0].width = desc->width;
    levels[0].height = desc->height;
    levels[0].values = desc->values;
    levels[0].weights = desc->weights;
    for (; levels[count - 1].width > 1 || levels[count - 1].height > 1; count++) {
        levels[count].width = (levels[count - 1].width + 1) / 2;
        levels[count].height = (levels[count - 1].height + 1) / 2;
        texels += (uint64_t)levels[count].width * levels[count].height;
    }
    memory = (float *)lao__take(&a, texels * (desc->channels + 1), sizeof *memory);
    if (!memory) {
        return sdv__fail(host, SDV_LOG_MEMORY, "the pyramid of a %u x %u image", desc->width,
                         desc->height);
    }
    for (i = 1, at = memory; i < count; i++) {
        size_t n = (size_t)levels[i].width * levels[i].height;
        levels[i].values = at;
        levels[i].weights = at + n * desc->channels;
        at += n * (desc->channels + 1);
    }
    p.desc = desc;
    p.exponent = desc->exponent ? (lao_int)desc->exponent : 1;
    p.exponent = p.exponent < 1023 ? p.exponent : 1023;
    sdv__pull_clean(levels, desc->channels);
    cancelled = sdv__pull_run(host, levels, count, &p);
    if (empty && !cancelled) {
        *empty = !(levels[count - 1].weights[0] > 0.0f);
    }
    lao__give(&a, memory);
    return cancelled ? sdv__fail(host, SDV_LOG_CANCELLED, "filling an image") : LAO_OK;
}
