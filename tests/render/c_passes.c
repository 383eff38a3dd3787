#include "c_passes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -------------------------------------------------------------------------------------- texels */

static lao_v4 fetch(const render_image *image, int x, int y) {
    const uint8_t *at =
        image->data + ((size_t)y * image->width + (size_t)x) * lao_format_bytes(image->format);
    lao_v4 v = {0, 0, 0, 1};
    float *c = &v.x;
    uint16_t half;
    switch (image->format) {
    case LAO_FORMAT_RGBA8:
        /* Mesa multiplies by the rounded reciprocal; half a unit of the last place off n / 255 */
        for (int k = 0; k < 4; k++)
            c[k] = (float)at[k] * (1.0f / 255.0f);
        break;
    case LAO_FORMAT_RGBA16F:
        for (int k = 0; k < 4; k++) {
            memcpy(&half, at + 2 * k, sizeof half);
            if ((half & 0x7c00) == 0)
                c[k] = ldexpf((float)(half & 0x3ff), -24);
            else if ((half & 0x7c00) == 0x7c00)
                c[k] = (half & 0x3ff) != 0 ? NAN : INFINITY;
            else
                c[k] = ldexpf((float)((half & 0x3ff) + 1024), (half >> 10 & 31) - 25);
            c[k] = (half & 0x8000) != 0 ? -c[k] : c[k];
        }
        break;
    case LAO_FORMAT_RGBA32F:
        memcpy(&v, at, sizeof v);
        break;
    default:
        memcpy(&v.x, at, sizeof v.x);
        break;
    }
    return v;
}

static uint32_t fetch_word(const render_image *image, int x, int y) {
    uint32_t word;
    assert_int_equal(image->format, LAO_FORMAT_R32UI);
    memcpy(&word, image->data + ((size_t)y * image->width + (size_t)x) * sizeof word, sizeof word);
    return word;
}

/* LAO_TEXEL: outside, the nearest inside. */
static int nearest(float x, uint32_t size) {
    int last = (int)size - 1;
    return x < 0 ? 0 : x > (float)last ? last : (int)x;
}

static lao_v4 texel(const render_image *image, float x, float y) {
    return fetch(image, nearest(x, image->width), nearest(y, image->height));
}

static uint32_t texel_word(const render_image *image, float x, float y) {
    return fetch_word(image, nearest(x, image->width), nearest(y, image->height));
}

/* Round half to even of v * 255: what the store of a normalised byte does. */
static uint8_t unorm8(float v) {
    v = v > 0.0f ? v : 0.0f;
    v = v < 1.0f ? v : 1.0f;
    return (uint8_t)lrintf(v * 255.0f);
}

static void store(render_image *image, int x, int y, lao_v4 v) {
    uint8_t *at =
        image->data + ((size_t)y * image->width + (size_t)x) * lao_format_bytes(image->format);
    const float *c = &v.x;
    if (image->format == LAO_FORMAT_RGBA8) {
        for (int k = 0; k < 4; k++)
            at[k] = unorm8(c[k]);
    } else {
        memcpy(at, &v, lao_format_bytes(image->format));
    }
}

static render_image make(const char *name, uint32_t level, lao_format format, uint32_t width,
                         uint32_t height) {
    render_image image;
    image.name = name;
    image.level = level;
    image.format = format;
    image.width = width;
    image.height = height;
    image.data = calloc((size_t)width * height, lao_format_bytes(format));
    assert_non_null(image.data);
    return image;
}

void c_free(render_image *image) {
    free(image->data);
    image->data = NULL;
}

void c_inputs_find(c_inputs *in, const render_result *result, const lao_settings *settings) {
    memset(in, 0, sizeof *in);
    in->frame = result->frame;
    in->settings = lao_settings_filled(settings);
    in->color = render_find(result, "color", 0);
    in->tangent = render_find(result, "tangent", 0);
    in->depth = render_find(result, "depth", 0);
    in->zbuffer = render_find(result, "zbuffer", 0);
    in->shaded = render_find(result, "shaded", 0);
    in->out = render_find(result, "out", 0);
    in->ao = render_find(result, "ao", 0);
    for (uint32_t level = 0; level < C_MOST_LEVELS; level++) {
        in->tensor[level] = render_find(result, "tensor", level);
        in->level[level] = render_find(result, "level", level);
        in->level_tangent[level] = render_find(result, "level_tangent", level);
    }
}

/* ------------------------------------------------------------------------------------- pyramid */

static c_level level_make(uint32_t level, uint32_t width, uint32_t height) {
    c_level l;
    l.tensor = make("tensor", level, LAO_FORMAT_RGBA32F, width, height);
    l.words = make("level", level, LAO_FORMAT_R32UI, width, height);
    l.tangent = make("level_tangent", level, LAO_FORMAT_RGBA8, width, height);
    return l;
}

static void level_store(c_level *l, int x, int y, uint32_t word, lao_v4 tangent) {
    size_t at = ((size_t)y * l->words.width + (size_t)x) * sizeof word;
    memcpy(l->words.data + at, &word, sizeof word);
    store(&l->tangent, x, y, tangent);
}

static lao_v2 slope_of(const c_inputs *in, int x, int y) {
    return lao_pixel_slope(in->frame.ray, (float)x + 0.5f, (float)y + 0.5f);
}

static void level_zero_pixel(const c_inputs *in, c_level *l, int x, int y) {
    int align = (int)in->settings.align;
    lao_v2 direction = lao_v2_make(0, 0);
    lao_v4 t = fetch(in->tangent, x, y);
    lao_v3 v = lao_v3_make(t.x, t.y, t.z);
    if (fetch(in->color, x, y).w < 0.5f) {
        level_store(l, x, y, 0, lao_v4_make(0.5f, 0.5f, 0.5f, 0.5f));
        return;
    }
    if (align != LAO_ALIGN_NONE)
        direction = lao_screen_axial(v, slope_of(in, x, y), in->frame.scale, in->frame.depth.w);
    if (align == LAO_ALIGN_PAPER)
        direction = lao_axial_alpha(direction);
    v = lao_signed_pack(v);
    level_store(l, x, y, lao_level_pack(fetch(in->depth, x, y).x, direction, align),
                lao_v4_make(v.x, v.y, v.z, 1));
}

c_level c_level_zero(const c_inputs *in) {
    c_level l = level_make(0, in->color->width, in->color->height);
    for (int y = 0; y < (int)l.tensor.height; y++) {
        for (int x = 0; x < (int)l.tensor.width; x++)
            level_zero_pixel(in, &l, x, y);
    }
    return l;
}

static void level_up_pixel(const c_inputs *in, c_level *l, uint32_t level, int x, int y) {
    int box = (int)in->settings.pyramid == LAO_PYRAMID_BOX, align = (int)in->settings.align;
    const render_image *words = in->level[level - 1];
    lao_level_sum sum = lao_level_sum_start(lao_v3_make(0, 0, 0));
    lao_v4 mean;
    lao_v3 tangent;
    for (int j = box ? 0 : -1; j <= (box ? 1 : 2); j++) {
        for (int i = box ? 0 : -1; i <= (box ? 1 : 2); i++) {
            int cx = 2 * x + i, cy = 2 * y + j;
            lao_v3 t = lao_v3_make(0, 0, 0);
            if (cx < 0 || cy < 0 || cx >= (int)words->width || cy >= (int)words->height)
                continue;
            if ((int)in->settings.light == LAO_LIGHT_AUTHOR)
                t = lao_signed_unpack(fetch(in->level_tangent[level - 1], cx, cy));
            sum = lao_level_sum_add(sum,
                                    level == 1 ? lao_level_child(fetch_word(words, cx, cy), align)
                                               : fetch(in->tensor[level - 1], cx, cy),
                                    t, box ? 0.25f : lao_gauss_weight(i) * lao_gauss_weight(j));
        }
    }
    mean = lao_level_sum_mean(sum);
    store(&l->tensor, x, y, mean);
    tangent = lao_signed_pack(lao_v3_unit(sum.tangent, lao_v3_make(0, 0, 0)));
    level_store(l, x, y, lao_level_word(mean, align),
                lao_v4_make(tangent.x, tangent.y, tangent.z, 1));
}

c_level c_level_up(const c_inputs *in, uint32_t level) {
    const render_image *finer = in->level[level - 1];
    c_level l = level_make(level, (finer->width + 1) / 2, (finer->height + 1) / 2);
    for (int y = 0; y < (int)l.tensor.height; y++) {
        for (int x = 0; x < (int)l.tensor.width; x++)
            level_up_pixel(in, &l, level, x, y);
    }
    return l;
}

/* ----------------------------------------------------------------------------------- occlusion */

typedef struct centre {
    lao_v3 n, r, l, noise;
    lao_v2 pixel;
    float zoom;
} centre;

typedef struct gather {
    lao_sampler rows;
    uint32_t centre;
    float threshold, least, slope, align_floor;
} gather;

static gather gather_make(const c_inputs *in, const centre *c, uint32_t level) {
    const lao_settings *s = &in->settings;
    float size = 1.0f / (float)(1u << level), step = in->frame.host_depth.w / LAO_LEVEL_STEPS;
    float radius = lao_sample_radius(c->zoom, s->radius, s->width, s->radius_step, level);
    float reach = lao_depth_reach(s->density, level, (uint32_t)s->levels);
    gather g;
    g.rows = lao_sampler_make(c->noise, c->n, c->r, radius, size, c->pixel.x, c->pixel.y);
    g.centre = texel_word(in->level[level], g.rows.own.x, g.rows.own.y);
    g.threshold = s->depth_threshold / step;
    g.least = s->strict_zero != 0 ? -g.threshold : 0;
    g.slope = step * lao_depth_weight_slope(reach, s->depth_threshold);
    g.align_floor = lao_level_known(g.centre) ? s->align_floor : 1;
    return g;
}

static float light_weight(const c_inputs *in, const centre *c, lao_tap tap, lao_v3 direction,
                          uint32_t level) {
    const lao_settings *s = &in->settings;
    if ((int)s->light == LAO_LIGHT_PAPER)
        return lao_light_weight(tap.n_omega, tap.r_omega, (int)s->light_exponent);
    lao_v4 t = texel(level ? in->level_tangent[level] : in->tangent, tap.x, tap.y);
    lao_v3 occluder = level ? lao_signed_unpack(t) : lao_v3_make(t.x, t.y, t.z);
    lao_v3 omega = lao_v3_scale(lao_mirror(direction, c->noise), lao_turned(1, tap.side));
    return lao_light_weight_author(omega, tap.n_omega, occluder, c->l, (int)s->light_exponent);
}

/* (share of the occlusion, 1 when it counts) */
static lao_v2 sample_weight(const c_inputs *in, const centre *c, const gather *g, lao_v3 direction,
                            uint32_t level) {
    const lao_settings *s = &in->settings;
    const render_image *words = in->level[level];
    int show = (int)s->show, align = (int)s->align;
    lao_tap tap = lao_tap_make(
        g->rows, direction, lao_v2_make(1.0f / (float)words->width, 1.0f / (float)words->height));
    uint32_t word = texel_word(words, tap.x, tap.y);
    float beyond = lao_level_nearer(g->centre, word) - g->threshold;
    float weight = 1;
    bool visible = tap.counts;
    if (lao_uses_visibility(show))
        visible = visible && beyond >= g->least;
    if (lao_uses_depth(show))
        weight = lao_depth_weight(beyond, g->slope);
    if (lao_uses_light(show))
        weight = weight * light_weight(in, c, tap, direction, level);
    if (align != LAO_ALIGN_NONE && lao_uses_alignment(show)) {
        float x = align == LAO_ALIGN_ROTATION ? lao_axial_difference(g->centre, word)
                                              : lao_alpha_difference(g->centre, word);
        float aligned = lao_align_weight(x, s->align_intensity, g->align_floor);
        weight = weight * (lao_level_known(word) ? aligned : 1);
    }
    return lao_v2_make(visible ? weight : 0, tap.counts ? 1.0f : 0.0f);
}

static float occlusion_pixel(const c_inputs *in, int x, int y) {
    const lao_settings *s = &in->settings;
    uint32_t own = fetch_word(in->level[0], x, y);
    lao_v4 line = fetch(in->tangent, x, y);
    float total = 0, nl;
    centre c;
    if (own == 0)
        return 0;
    c.pixel = lao_v2_make((float)x + 0.5f, (float)y + 0.5f);
    c.l = lao_towards_eye(slope_of(in, x, y), in->frame.depth.w);
    c.n = lao_line_normal(lao_v3_make(line.x, line.y, line.z), c.l);
    nl = lao_max(lao_v3_dot(c.n, c.l), 0);
    c.r = lao_v3_along(lao_v3_scale(c.l, -1), c.n, 2 * nl);
    if ((int)s->light == LAO_LIGHT_PAPER) {
        c.n = lao_v3_scale(c.n, lao_light_diffuse(s->light_intensity, s->light_diffuse, nl));
        c.r = lao_v3_scale(
            c.r, lao_light_specular(s->light_intensity, s->light_specular, (int)s->light_exponent));
    }
    c.noise = in->noise ? in->noise(in->noise_frame, (uint32_t)x, (uint32_t)y)
                        : lao_pixel_noise((uint32_t)x, (uint32_t)y);
    c.zoom = line.w > 0 ? line.w
                        : lao_pixel_zoom(in->frame.scale, in->frame.depth, lao_level_depth(own));
    for (uint32_t level = 0; level < (uint32_t)s->levels; level++) {
        gather g = gather_make(in, &c, level);
        uint32_t count = lao_sample_count((uint32_t)s->samples, level);
        lao_v2 sum = lao_v2_make(0, 0);
        for (uint32_t i = 0; i < count; i++) {
            lao_v2 w = sample_weight(in, &c, &g, lao_sample_direction(level, i, count), level);
            sum = lao_v2_make(sum.x + w.x, sum.y + w.y);
        }
        float mean = sum.x / lao_max(sum.y, 1);
        total = total + mean;
    }
    return total / s->levels;
}

render_image c_occlusion(const c_inputs *in) {
    render_image ao = make("ao", 0, LAO_FORMAT_R32F, in->color->width, in->color->height);
    for (int y = 0; y < (int)ao.height; y++) {
        for (int x = 0; x < (int)ao.width; x++)
            store(&ao, x, y, lao_v4_make(occlusion_pixel(in, x, y), 0, 0, 0));
    }
    return ao;
}

render_image c_smooth(const c_inputs *in, const render_image *ao, int dx, int dy) {
    render_image out = make("ao", 0, LAO_FORMAT_R32F, ao->width, ao->height);
    for (int y = 0; y < (int)ao->height; y++) {
        for (int x = 0; x < (int)ao->width; x++) {
            float sum = 0, weights = 0;
            for (int i = -1; i <= 1; i++) {
                float at_x = (float)(x + i * dx), at_y = (float)(y + i * dy);
                float w = texel(in->color, at_x, at_y).w < 0.5f ? 0.0f : i == 0 ? 0.5f : 0.25f;
                sum = sum + w * texel(ao, at_x, at_y).x;
                weights = weights + w;
            }
            float mean = weights > 0 ? sum / weights : 0;
            mean = fetch(in->color, x, y).w < 0.5f ? 0 : mean;
            store(&out, x, y, lao_v4_make(mean, 0, 0, 0));
        }
    }
    return out;
}

/* ------------------------------------------------------------------------------------- picture */

static lao_v4 shade_pixel(const c_inputs *in, int x, int y) {
    const lao_settings *s = &in->settings;
    lao_v4 base = fetch(in->color, x, y), t = fetch(in->tangent, x, y);
    float occlusion = s->occlusion != 0 ? fetch(in->ao, x, y).x : 0;
    lao_v3 l, c;
    if (base.w < 0.5f)
        return lao_v4_make(0, 0, 0, 0); /* as cleared */
    if ((int)s->show == LAO_SHOW_COLOR)
        return lao_v4_make(base.x, base.y, base.z, 1);
    if ((int)s->show != LAO_SHOW_PICTURE) {
        float grey = 1.0f - lao_clamp01(occlusion);
        return lao_v4_make(grey, grey, grey, 1);
    }
    l = lao_towards_eye(slope_of(in, x, y), in->frame.depth.w);
    if ((int)s->ao_affects_color == LAO_COLOR_LUMINANCE_PRESERVING) {
        c = lao_shade_luminance(lao_v3_make(base.x, base.y, base.z), lao_v3_make(t.x, t.y, t.z), l,
                                s->ambient, s->diffuse, s->strength * occlusion);
        return lao_v4_make(c.x, c.y, c.z, 1);
    }
    c = lao_shade(lao_v3_make(base.x, base.y, base.z), lao_v3_make(t.x, t.y, t.z), l, s->ambient,
                  s->diffuse, s->specular * lao_light_unpack(base.w), (int)s->shininess,
                  s->strength * occlusion);
    return lao_v4_make(c.x, c.y, c.z, 1);
}

render_image c_shade(const c_inputs *in) {
    render_image out = make("shaded", 0, LAO_FORMAT_RGBA8, in->color->width, in->color->height);
    for (int y = 0; y < (int)out.height; y++) {
        for (int x = 0; x < (int)out.width; x++)
            store(&out, x, y, shade_pixel(in, x, y));
    }
    return out;
}

render_image c_resolve(const c_inputs *in) {
    int n = (int)in->settings.supersampling;
    render_image out = make("out", 0, LAO_FORMAT_RGBA8, in->shaded->width / (uint32_t)n,
                            in->shaded->height / (uint32_t)n);
    for (int y = 0; y < (int)out.height; y++) {
        for (int x = 0; x < (int)out.width; x++) {
            lao_v4 sum = lao_v4_make(0, 0, 0, 0);
            for (int k = 0; k < n * n; k++) {
                lao_v4 v = fetch(in->shaded, x * n + k % n, y * n + k / n);
                sum = lao_v4_make(sum.x + v.x, sum.y + v.y, sum.z + v.z, sum.w + v.w);
            }
            store(&out, x, y, lao_over(sum, (float)(n * n), in->frame.background));
        }
    }
    return out;
}

render_image c_present(const c_inputs *in, lao_format format, float before) {
    render_image out = make("target", 0, format, in->out->width, in->out->height);
    for (int y = 0; y < (int)out.height; y++) {
        int from = in->frame.target.z > 0.5f ? (int)out.height - 1 - y : y;
        for (int x = 0; x < (int)out.width; x++) {
            lao_v4 c = fetch(in->out, x, from);
            if (in->frame.target.w > 0.5f)
                c = lao_v4_make(lao_srgb_decode(c.x), lao_srgb_decode(c.y), lao_srgb_decode(c.z),
                                c.w);
            float through = before * (1.0f - c.w);
            store(&out, x, y,
                  lao_v4_make(c.x + through, c.y + through, c.z + through, c.w + through));
        }
    }
    return out;
}

render_image c_export_depth(const c_inputs *in, const render_image *before) {
    int n = (int)in->settings.supersampling, reversed = in->frame.scale.z > 0.5f;
    render_image out = make("host_depth", 0, LAO_FORMAT_D32F, before->width, before->height);
    for (int y = 0; y < (int)out.height; y++) {
        int from = in->frame.host_depth.z > 0.5f ? (int)out.height - 1 - y : y;
        for (int x = 0; x < (int)out.width; x++) {
            float nearest = fetch(before, x, y).x;
            for (int k = 0; k < n * n; k++) {
                float d = fetch(in->zbuffer, x * n + k % n, from * n + k / n).x;
                nearest = reversed ? lao_max(nearest, d) : lao_min(nearest, d);
            }
            store(&out, x, y, lao_v4_make(nearest, 0, 0, 0));
        }
    }
    return out;
}
