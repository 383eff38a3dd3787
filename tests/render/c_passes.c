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

/* LAO_TEXEL: outside, the nearest inside. */
static lao_v4 texel(const render_image *image, float x, float y) {
    int w = (int)image->width - 1, h = (int)image->height - 1;
    int i = x < 0 ? 0 : x > (float)w ? w : (int)x, j = y < 0 ? 0 : y > (float)h ? h : (int)y;
    return fetch(image, i, j);
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
        in->level_depth[level] = render_find(result, "level_depth", level);
        in->level_axial[level] = render_find(result, "level_axial", level);
        in->level_tangent[level] = render_find(result, "level_tangent", level);
    }
}

/* ------------------------------------------------------------------------------------- pyramid */

static c_level level_make(uint32_t level, uint32_t width, uint32_t height) {
    c_level l;
    l.tensor = make("tensor", level, LAO_FORMAT_RGBA32F, width, height);
    l.depth = make("level_depth", level, LAO_FORMAT_RGBA8, width, height);
    l.axial = make("level_axial", level, LAO_FORMAT_RGBA8, width, height);
    l.tangent = make("level_tangent", level, LAO_FORMAT_RGBA8, width, height);
    return l;
}

static void level_store(c_level *l, int x, int y, lao_v4 tensor, lao_v4 depth, lao_v2 direction,
                        lao_v3 tangent) {
    store(&l->tensor, x, y, tensor);
    store(&l->depth, x, y, depth);
    store(&l->axial, x, y, lao_axial_pack(direction.x, direction.y));
    store(&l->tangent, x, y, lao_v4_make(tangent.x, tangent.y, tangent.z, 1));
}

static lao_v2 slope_of(const c_inputs *in, int x, int y) {
    return lao_pixel_slope(in->frame.ray, (float)x + 0.5f, (float)y + 0.5f);
}

static void level_zero_pixel(const c_inputs *in, c_level *l, int x, int y) {
    int align = (int)in->settings.align;
    lao_v2 direction = lao_v2_make(0, 0);
    lao_v4 t;
    float d;
    if (fetch(in->color, x, y).w < 0.5f) {
        level_store(l, x, y, lao_v4_make(0, 0, 0, 1), lao_depth_pack(1, 0), direction,
                    lao_v3_make(0.5f, 0.5f, 0.5f));
        store(&l->tangent, x, y, lao_v4_make(0.5f, 0.5f, 0.5f, 0.5f));
        return;
    }
    t = fetch(in->tangent, x, y);
    d = fetch(in->depth, x, y).x;
    if (align != LAO_ALIGN_NONE)
        direction = lao_screen_axial(lao_v3_make(t.x, t.y, t.z), slope_of(in, x, y),
                                     in->frame.scale, in->frame.depth.w);
    if (align == LAO_ALIGN_PAPER)
        direction = lao_axial_alpha(direction);
    level_store(l, x, y, lao_v4_make(direction.x, direction.y, 1, d), lao_depth_pack(d, 1),
                direction, lao_signed_pack(lao_v3_make(t.x, t.y, t.z)));
}

c_level c_level_zero(const c_inputs *in) {
    c_level l = level_make(0, in->color->width, in->color->height);
    for (int y = 0; y < (int)l.tensor.height; y++) {
        for (int x = 0; x < (int)l.tensor.width; x++)
            level_zero_pixel(in, &l, x, y);
    }
    return l;
}

static void level_up_pixel(const c_inputs *in, c_level *l, const render_image *finer,
                           const render_image *tangents, int x, int y) {
    int box = (int)in->settings.pyramid == LAO_PYRAMID_BOX, align = (int)in->settings.align;
    lao_level_sum sum = lao_level_sum_start(lao_v3_make(0, 0, 0));
    lao_v4 mean;
    lao_v2 direction;
    for (int j = box ? 0 : -1; j <= (box ? 1 : 2); j++) {
        for (int i = box ? 0 : -1; i <= (box ? 1 : 2); i++) {
            int cx = 2 * x + i, cy = 2 * y + j;
            lao_v3 t = lao_v3_make(0, 0, 0);
            if (cx < 0 || cy < 0 || cx >= (int)finer->width || cy >= (int)finer->height)
                continue;
            if ((int)in->settings.light == LAO_LIGHT_AUTHOR)
                t = lao_signed_unpack(fetch(tangents, cx, cy));
            sum = lao_level_sum_add(sum, fetch(finer, cx, cy), t,
                                    box ? 0.25f : lao_gauss_weight(i) * lao_gauss_weight(j));
        }
    }
    mean = lao_level_sum_mean(sum);
    direction = lao_v2_make(mean.x, mean.y);
    if (align == LAO_ALIGN_ROTATION)
        direction = lao_axial_unit(direction);
    if (align == LAO_ALIGN_PAPER)
        direction = lao_alpha_mean(direction);
    level_store(l, x, y, mean, lao_depth_pack(mean.w, mean.z > 0 ? 1.0f : 0.0f), direction,
                lao_signed_pack(lao_v3_unit(sum.tangent, lao_v3_make(0, 0, 0))));
}

c_level c_level_up(const c_inputs *in, uint32_t level) {
    const render_image *finer = in->tensor[level - 1];
    c_level l = level_make(level, (finer->width + 1) / 2, (finer->height + 1) / 2);
    for (int y = 0; y < (int)l.tensor.height; y++) {
        for (int x = 0; x < (int)l.tensor.width; x++)
            level_up_pixel(in, &l, finer, in->level_tangent[level - 1], x, y);
    }
    return l;
}

/* ----------------------------------------------------------------------------------- occlusion */

typedef struct centre {
    lao_v3 n, r, l, noise;
    lao_v2 pixel;
    float zoom, diffuse;
} centre;

typedef struct gather {
    lao_sampler rows;
    lao_v2 axial;
    float depth, slope;
} gather;

static gather gather_make(const c_inputs *in, const centre *c, uint32_t level) {
    const lao_settings *s = &in->settings;
    float size = 1.0f / (float)(1u << level);
    float radius = lao_sample_radius(c->zoom, s->radius, s->width, s->radius_step, level);
    gather g;
    g.rows = lao_sampler_make(c->noise, c->n, c->r, radius, size, c->pixel.x, c->pixel.y);
    float x = floorf(g.rows.centre.x), y = floorf(g.rows.centre.y);
    g.depth = lao_depth_unpack(texel(in->level_depth[level], x, y));
    g.axial = lao_v2_make(0, 0);
    if ((int)s->align != LAO_ALIGN_NONE)
        g.axial = lao_axial_unpack(texel(in->level_axial[level], x, y));
    g.slope = lao_depth_weight_slope(lao_depth_reach(s->density, level, (uint32_t)s->levels),
                                     s->depth_threshold);
    return g;
}

static float light_weight(const c_inputs *in, const centre *c, lao_tap tap, lao_v3 direction,
                          uint32_t level) {
    const lao_settings *s = &in->settings;
    if ((int)s->light == LAO_LIGHT_PAPER)
        return lao_light_weight(c->diffuse, tap.n_omega, s->light_intensity * s->light_specular,
                                tap.r_omega, (int)s->light_exponent);
    lao_v3 occluder = lao_signed_unpack(texel(in->level_tangent[level], tap.x, tap.y));
    lao_v3 omega = lao_v3_scale(lao_mirror(direction, c->noise), tap.flip);
    return lao_light_weight_author(omega, tap.n_omega, occluder, c->l, (int)s->light_exponent);
}

/* (share of the occlusion, 1 when it counts) */
static lao_v2 sample_weight(const c_inputs *in, const centre *c, const gather *g, lao_v3 direction,
                            uint32_t level) {
    const lao_settings *s = &in->settings;
    const render_image *depths = in->level_depth[level];
    int show = (int)s->show, align = (int)s->align;
    lao_tap tap =
        lao_tap_make(g->rows, direction, lao_v2_make((float)depths->width, (float)depths->height));
    float nearer = g->depth - lao_depth_unpack(texel(depths, tap.x, tap.y));
    float difference = nearer * in->frame.host_depth.w;
    float weight = tap.use;
    if (lao_uses_visibility(show))
        weight = difference >= (s->strict_zero != 0 ? 0.0f : s->depth_threshold) ? weight : 0.0f;
    if (lao_uses_depth(show))
        weight = weight * lao_depth_weight(difference, s->depth_threshold, g->slope);
    if (lao_uses_light(show))
        weight = weight * light_weight(in, c, tap, direction, level);
    if (align != LAO_ALIGN_NONE && lao_uses_alignment(show)) {
        lao_v2 axial = lao_axial_unpack(texel(in->level_axial[level], tap.x, tap.y));
        float x = align == LAO_ALIGN_ROTATION ? lao_axial_difference(g->axial, axial)
                                              : lao_alpha_difference(g->axial, axial);
        weight = weight * lao_align_weight(x, s->align_intensity, s->align_floor);
    }
    return lao_v2_make(weight, tap.use);
}

static float occlusion_pixel(const c_inputs *in, int x, int y) {
    const lao_settings *s = &in->settings;
    lao_v4 own = fetch(in->level_depth[0], x, y), line = fetch(in->tangent, x, y);
    float total = 0, nl;
    centre c;
    if (own.w < 0.5f)
        return 0;
    c.pixel = lao_v2_make((float)x + 0.5f, (float)y + 0.5f);
    c.l = lao_towards_eye(slope_of(in, x, y), in->frame.depth.w);
    c.n = lao_line_normal(lao_v3_make(line.x, line.y, line.z), c.l);
    nl = lao_max(lao_v3_dot(c.n, c.l), 0);
    c.diffuse = s->light_intensity * s->light_diffuse * nl;
    c.r = lao_v3_along(lao_v3_scale(c.l, -1), c.n, 2 * nl);
    c.noise = lao_pixel_noise((uint32_t)x, (uint32_t)y);
    c.zoom = line.w > 0 ? line.w
                        : lao_pixel_zoom(in->frame.scale, in->frame.depth, lao_depth_unpack(own));
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
