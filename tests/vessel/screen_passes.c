#include "screen_passes.h"

#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------------- memory */

void screen_size(const screen *s, uint32_t level, uint32_t *width, uint32_t *height) {
    *width = s->width;
    *height = s->height;
    for (; level > 0; level--) {
        *width = (*width + 1) / 2;
        *height = (*height + 1) / 2;
    }
}

static lao_v4 **pyramid(screen *s, int i) {
    lao_v4 **all[] = {s->depth, s->filled, s->place,    s->facing, s->tensor, s->spread,
                      s->along, s->across, s->recalled, s->phase,  s->swept};
    return i < (int)(sizeof all / sizeof all[0]) ? all[i] : NULL;
}
static lao_v4 **single(screen *s, int i) {
    lao_v4 **all[] = {&s->surface,        &s->bgnormal,  &s->uv,        &s->ink,
                      &s->surface_before, &s->uv_before, &s->ink_before};
    return i < (int)(sizeof all / sizeof all[0]) ? all[i] : NULL;
}

bool screen_make(screen *s, uint32_t width, uint32_t height) {
    size_t texels = (size_t)width * height;
    bool all = true;
    memset(s, 0, sizeof *s);
    s->width = width;
    s->height = height;
    s->threshold = 0.2f;
    s->period = 4;
    s->sweeps = 4;
    s->recycle = -1;
    lao_settings_resolve(sdv_module(), NULL, s->values);
    for (uint32_t w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2) {
        for (int i = 0; pyramid(s, i); i++)
            all &= (pyramid(s, i)[s->levels] = calloc((size_t)w * h, sizeof(lao_v4))) != NULL;
        s->levels++;
        if (w == 1 && h == 1)
            break;
    }
    for (int i = 0; single(s, i); i++)
        all &= (*single(s, i) = calloc(texels, sizeof(lao_v4))) != NULL;
    return all;
}

void screen_free(screen *s) {
    if (!s)
        return;
    for (int i = 0; pyramid(s, i); i++)
        for (uint32_t l = 0; l < s->levels; l++)
            free(pyramid(s, i)[l]);
    for (int i = 0; single(s, i); i++)
        free(*single(s, i));
    memset(s, 0, sizeof *s);
}

void screen_next(screen *s) {
    size_t size = (size_t)s->width * s->height * sizeof(lao_v4);
    memcpy(s->surface_before, s->surface, size);
    memcpy(s->uv_before, s->uv, size);
    memcpy(s->ink_before, s->ink, size);
    s->frame.previous_view = s->frame.view;
    s->frame.previous_projection = s->frame.projection;
    s->frame.history.x += 1;
}

/* -------------------------------------------------------------------------------------- texels */

typedef struct texel {
    const screen *s;
    uint32_t level, width, height;
    int x, y;
    size_t at;
} texel;

static texel texel_make(const screen *s, uint32_t level, uint32_t i) {
    texel t;
    t.s = s;
    t.level = level;
    screen_size(s, level, &t.width, &t.height);
    t.x = (int)(i % t.width);
    t.y = (int)(i / t.width);
    t.at = i;
    return t;
}
static uint32_t texels(const screen *s, uint32_t level) {
    uint32_t w, h;
    screen_size(s, level, &w, &h);
    return w * h;
}
/* Place of (x, y) in an image of the level; -1 outside. */
static long place_of(const screen *s, uint32_t level, int x, int y) {
    uint32_t w, h;
    screen_size(s, level, &w, &h);
    return x >= 0 && y >= 0 && x < (int)w && y < (int)h ? (long)y * (long)w + x : -1;
}
static long child(const texel *t, int i) {
    return place_of(t->s, t->level - 1, 2 * t->x + (i & 1), 2 * t->y + (i >> 1));
}
static long parent(const texel *t, int i) {
    return place_of(t->s, t->level + 1, sdv_push_parent(t->x, i & 1),
                    sdv_push_parent(t->y, i >> 1));
}
static float share(int i) {
    return sdv_push_share(1, i & 1) * sdv_push_share(1, i >> 1);
}
static lao_v3 xyz(lao_v4 v) {
    return lao_v3_make(v.x, v.y, v.z);
}
static lao_v4 with(lao_v3 v, float w) {
    return lao_v4_make(v.x, v.y, v.z, w);
}
static lao_v4 zero(void) {
    return lao_v4_make(0, 0, 0, 0);
}
static float pixel_mm(const screen *s, lao_v3 p) {
    return sdv_pixel_size(s->frame.ray, sdv_depth_of(s->frame.view, p), s->frame.depth.w);
}

/* -------------------------------------------------------------------------------- background */

static void pull(screen *s, lao_v4 **image, int kind) {
    for (uint32_t l = 1; l < s->levels; l++) {
        for (uint32_t k = 0; k < texels(s, l); k++) {
            texel t = texel_make(s, l, k);
            sdv_mix m = sdv_mix_start(zero());
            for (int i = 0; i < 4; i++) {
                long c = child(&t, i);
                if (c >= 0)
                    m = sdv_mix_add(m, with(xyz(image[l - 1][c]), 0), image[l - 1][c].w,
                                    sdv_pull_share(kind));
            }
            image[l][k] = with(xyz(sdv_mix_value(m)), m.weight);
        }
    }
}

static void depth_zero(screen *s, const lao_v4 *position) {
    for (uint32_t k = 0; k < texels(s, 0); k++) {
        lao_v4 *d = &s->depth[0][k], before = s->surface_before[k];
        *d = zero();
        if (sdv_is_covered(position[k].w))
            *d = lao_v4_make(sdv_depth_of(s->frame.view, xyz(position[k])), 1, 0, 1);
        else if (s->frame.history.x > 0.5f &&
                 lao_abs(before.w) == sdv_surface_mark(s->period, s->set))
            *d = lao_v4_make(sdv_depth_of(s->frame.previous_view, xyz(before)), 0, 0,
                             SDV_BACKGROUND_INERTIA);
    }
}

static void fill(screen *s) {
    uint32_t top = s->levels - 1;
    lao_v4 t = s->depth[top][0];
    s->filled[top][0] = t.w > 0 ? lao_v4_make(t.x, t.y, 0, 1)
                                : lao_v4_make(sdv_empty_depth(s->frame.depth), 0, 1, 1);
    for (uint32_t l = top; l-- > 0;) {
        for (uint32_t k = 0; k < texels(s, l); k++) {
            texel at = texel_make(s, l, k);
            sdv_mix m = sdv_mix_start(zero());
            float kept =
                sdv_push_own(s->depth[l][k].w, (lao_int)s->values[SDV_SETTING_ID_void_exponent]);
            for (int i = 0; i < 4; i++) {
                long p = parent(&at, i);
                if (p >= 0)
                    m = sdv_mix_add(m, with(xyz(s->filled[l + 1][p]), 0), s->filled[l + 1][p].w,
                                    share(i));
            }
            s->filled[l][k] = with(xyz(sdv_push_value(m, with(xyz(s->depth[l][k]), 0), kept)),
                                   sdv_push_weight(m, kept));
        }
    }
}

static lao_v3 place_at(const screen *s, int x, int y, float z) {
    return sdv_depth_place(s->frame.world,
                           lao_pixel_slope(s->frame.ray, (float)x + 0.5f, (float)y + 0.5f), z,
                           s->frame.depth.w);
}
static lao_v3 sheet_step(const texel *t, int dx, int dy, lao_v3 p, float z) {
    const screen *s = t->s;
    long b = place_of(s, 0, t->x - dx, t->y - dy), a = place_of(s, 0, t->x + dx, t->y + dy);
    float zb = b < 0 ? SDV_FAR : s->filled[0][b].x, za = a < 0 ? SDV_FAR : s->filled[0][a].x;
    lao_v3 pb = zb < SDV_FAR ? place_at(s, t->x - dx, t->y - dy, zb) : p;
    lao_v3 pa = za < SDV_FAR ? place_at(s, t->x + dx, t->y + dy, za) : p;
    return sdv_sheet_step(pb, p, pa, zb, z, za);
}
static lao_v3 drawn_step(const texel *t, int dx, int dy, const lao_v4 *position, lao_v3 p) {
    const screen *s = t->s;
    long b = place_of(s, 0, t->x - dx, t->y - dy), a = place_of(s, 0, t->x + dx, t->y + dy);
    bool has_b = b >= 0 && sdv_is_covered(position[b].w);
    bool has_a = a >= 0 && sdv_is_covered(position[a].w);
    lao_v3 pb = has_b ? xyz(position[b]) : p, pa = has_a ? xyz(position[a]) : p;
    return sdv_sheet_step(pb, p, pa, has_b ? sdv_depth_of(s->frame.view, pb) : SDV_FAR,
                          sdv_depth_of(s->frame.view, p),
                          has_a ? sdv_depth_of(s->frame.view, pa) : SDV_FAR);
}

void screen_drawn(const screen *s, const float *depth, lao_v4 *position, lao_v4 *normal) {
    for (uint32_t k = 0; depth && k < texels(s, 0); k++) {
        texel t = texel_make(s, 0, k);
        float z = sdv_drawn_depth(s->frame.projection, depth[k]);
        position[k] = lao_v4_make(0, 0, 0, -1);
        if (z < SDV_FAR)
            position[k] = with(place_at(s, t.x, t.y, z), 0);
    }
    for (uint32_t k = 0; k < texels(s, 0); k++) {
        texel t = texel_make(s, 0, k);
        lao_v3 p = xyz(position[k]);
        lao_v2 slope = lao_pixel_slope(s->frame.ray, (float)t.x + 0.5f, (float)t.y + 0.5f);
        lao_v3 d = lao_ray_direction(s->frame.world, slope, s->frame.depth.w);
        normal[k] = zero();
        if (sdv_is_covered(position[k].w))
            normal[k] =
                with(sdv_sheet_normal(drawn_step(&t, 1, 0, position, p),
                                      drawn_step(&t, 0, 1, position, p), lao_v3_scale(d, -1)),
                     0);
    }
}

static float clamped_depth(const screen *s, int x, int y) {
    int w = (int)s->width - 1, h = (int)s->height - 1;
    lao_v4 d;
    x = x < 0 ? 0 : x > w ? w : x;
    y = y < 0 ? 0 : y > h ? h : y;
    d = s->depth[0][(size_t)y * s->width + (size_t)x];
    return d.y > 0.5f ? d.x : sdv_empty_depth(s->frame.depth);
}
static lao_v3 depths(const texel *t, int dy) {
    return lao_v3_make(clamped_depth(t->s, t->x - 1, t->y + dy),
                       clamped_depth(t->s, t->x, t->y + dy),
                       clamped_depth(t->s, t->x + 1, t->y + dy));
}
static lao_v4 guide_of(const texel *t, lao_v4 hit, lao_v3 n) {
    const screen *s = t->s;
    if (!sdv_is_covered(hit.w))
        return zero();
    if (s->guide == SDV_GUIDE_OWN && s->directions) {
        lao_v4 own = s->directions[t->at];
        lao_v4 g = sdv_axis_tensor(sdv_turned(s->frame.view, xyz(own)));
        return lao_v4_make(g.x, g.y, g.z, g.w * own.w);
    }
    if (s->guide == SDV_GUIDE_OWN) {
        size_t at = 2 * (size_t)(hit.w < 0 ? 0 : hit.w);
        if (hit.w < 0)
            return zero();
        return sdv_axis_tensor(
            sdv_turned(s->frame.view, lao_v3_sub(xyz(s->cones[at + 1]), xyz(s->cones[at]))));
    }
    return sdv_contour_tensor(
        sdv_sobel(depths(t, -1), depths(t, 0), depths(t, 1), s->frame.depth.y),
        sdv_turned(s->frame.view, n), s->threshold);
}

static void surface_zero(screen *s, const lao_v4 *position, const lao_v4 *normal) {
    for (uint32_t k = 0; k < texels(s, 0); k++) {
        texel t = texel_make(s, 0, k);
        lao_v4 hit = position[k], z = s->filled[0][k];
        lao_v3 p = xyz(hit), n = xyz(normal[k]);
        float mark = sdv_surface_mark(s->period, s->set), covered = 1;
        if (!sdv_is_covered(hit.w)) {
            lao_v2 slope = lao_pixel_slope(s->frame.ray, (float)t.x + 0.5f, (float)t.y + 0.5f);
            lao_v3 d = lao_ray_direction(s->frame.world, slope, s->frame.depth.w);
            p = place_at(s, t.x, t.y, z.x);
            n = sdv_sheet_normal(sheet_step(&t, 1, 0, p, z.x), sheet_step(&t, 0, 1, p, z.x),
                                 lao_v3_scale(d, -1));
            mark = z.z > 0.5f ? 0.0f : -mark;
            covered = 0;
        }
        s->surface[k] = with(p, mark);
        s->bgnormal[k] = with(n, hit.w);
        s->facing[0][k] = with(n, 0);
        s->place[0][k] = with(p, covered);
        s->tensor[0][k] = guide_of(&t, hit, n);
    }
}

void screen_background(screen *s, const lao_v4 *position, const lao_v4 *normal) {
    depth_zero(s, position);
    pull(s, s->depth, SDV_PULL_MEAN);
    fill(s);
    surface_zero(s, position, normal);
}

/* -------------------------------------------------------------------------------- guiding field */

static void gather(screen *s) {
    for (uint32_t l = 1; l < s->levels; l++) {
        for (uint32_t k = 0; k < texels(s, l); k++) {
            texel t = texel_make(s, l, k);
            sdv_mix p = sdv_mix_start(zero()), n = p;
            float covered = 0, count = 0;
            for (int i = 0; i < 4; i++) {
                long c = child(&t, i);
                if (c >= 0) {
                    float h = lao_max(s->place[l - 1][c].w, SDV_BACKGROUND_PRESENCE);
                    p = sdv_mix_add(p, with(xyz(s->place[l - 1][c]), 0), h, 0.25f);
                    n = sdv_mix_add(n, with(xyz(s->facing[l - 1][c]), 0), h, 0.25f);
                    covered = covered + s->place[l - 1][c].w;
                    count = count + 1;
                }
            }
            s->place[l][k] = with(xyz(sdv_mix_value(p)), covered / count);
            s->facing[l][k] =
                with(lao_v3_unit(xyz(sdv_mix_value(n)), xyz(s->facing[l - 1][child(&t, 0)])), 0);
        }
    }
}

static void direct(screen *s, uint32_t l, uint32_t k, lao_v4 tensor, lao_v3 otherwise) {
    lao_v3 n = xyz(s->facing[l][k]);
    lao_v3 z = sdv_lift(s->frame.world, sdv_tensor_axis(tensor), n, otherwise);
    s->spread[l][k] = tensor;
    s->along[l][k] = with(z, 0);
    s->across[l][k] = with(lao_v3_cross(n, z), 0);
}

static void spread(screen *s, uint32_t l, uint32_t k) {
    texel t = texel_make(s, l, k);
    lao_v4 own = s->tensor[l][k];
    lao_v3 p = xyz(s->place[l][k]);
    sdv_mix m = sdv_mix_start(zero());
    float kept = sdv_push_own(own.w, 1), mm = pixel_mm(s, p);
    for (int i = 0; i < 4; i++) {
        long at = parent(&t, i);
        if (at >= 0) {
            float h = share(i) * sdv_parent_nearness(p, xyz(s->place[l + 1][at]), mm, (float)l);
            m = sdv_mix_add(m, with(xyz(s->spread[l + 1][at]), 0), s->spread[l + 1][at].w, h);
        }
    }
    direct(s, l, k, with(xyz(sdv_push_value(m, with(xyz(own), 0), kept)), sdv_push_weight(m, kept)),
           xyz(s->along[l + 1][parent(&t, 0)]));
}

void screen_guide(screen *s) {
    uint32_t top = s->levels - 1;
    lao_v4 t;
    gather(s);
    pull(s, s->tensor, SDV_PULL_SUM);
    t = s->tensor[top][0];
    t.w = t.w > 0 ? 1.0f : 0.0f;
    direct(s, top, 0, t, lao_v3_make(0, 0, 0));
    for (uint32_t l = top; l-- > 0;)
        for (uint32_t k = 0; k < texels(s, l); k++)
            spread(s, l, k);
}

/* -------------------------------------------------------------------------------------- phases */

static float camera_apart(const screen *s) {
    return sdv_apart(s->frame.view, s->frame.previous_view) +
           sdv_apart(s->frame.projection, s->frame.previous_projection);
}

static lao_v4 recall(const screen *s, uint32_t k) {
    lao_v4 now = s->surface[k], before, uv;
    lao_v3 at = lao_v3_make((float)(k % s->width), (float)(k / s->width), 1);
    lao_v3 apart = lao_v3_make(0, 0, 0);
    lao_v2 phase;
    size_t from;
    if (s->frame.history.x < 0.5f)
        return zero();
    if (now.w > 0)
        at = sdv_pixel_of(s->frame.previous_view, s->frame.previous_projection, xyz(now),
                          (float)s->width, (float)s->height);
    if (at.z < 0.5f)
        return zero();
    from = (size_t)at.y * s->width + (size_t)at.x;
    before = s->surface_before[from];
    if (before.w != now.w)
        return zero();
    if (now.w > 0) {
        if (!sdv_same_surface(xyz(now), xyz(s->bgnormal[k]), xyz(before), pixel_mm(s, xyz(now))))
            return zero();
        apart = lao_v3_sub(xyz(now), xyz(before));
    }
    uv = s->uv_before[from];
    phase.x = uv.x;
    phase.y = uv.y;
    phase = sdv_phase_recall(xyz(s->along[0][k]), xyz(s->across[0][k]),
                             sdv_guide_world(s->frame.previous_view, uv.z, uv.w), phase, apart,
                             LAO_TURN / s->period);
    return lao_v4_make(phase.x, phase.y, s->ink_before[from].y, 1);
}

/* What texel `at` of level `from` says to `t`. */
static sdv_phases hear(const texel *t, sdv_phases sum, const screen_pyramid phase, uint32_t from,
                       long at, float stencil) {
    const screen *s = t->s;
    lao_v3 p = xyz(s->place[t->level][t->at]);
    lao_v2 uv;
    uv.x = phase[from][at].x;
    uv.y = phase[from][at].y;
    return sdv_phases_hear(sum, p, xyz(s->along[t->level][t->at]), xyz(s->across[t->level][t->at]),
                           s->place[from][at], xyz(s->along[from][at]), xyz(s->across[from][at]),
                           uv, stencil, LAO_TURN / s->period, pixel_mm(s, p));
}

static lao_v4 recall_up(const screen *s, uint32_t l, uint32_t k) {
    texel t = texel_make(s, l, k);
    sdv_phases sum = sdv_phases_start(zero());
    float weight = 0;
    lao_v2 none = {0, 0}, uv;
    for (int i = 0; i < 4; i++) {
        long c = child(&t, i);
        if (c >= 0 && s->recalled[l - 1][c].w > 0) {
            sum = hear(&t, sum, s->recalled, l - 1, c, s->recalled[l - 1][c].w);
            weight = weight + 0.25f * s->recalled[l - 1][c].w;
        }
    }
    if (!sdv_phase_agrees(sum.sum.x, sum.sum.y, sum.share.x) ||
        !sdv_phase_agrees(sum.sum.z, sum.sum.w, sum.share.y))
        return zero();
    uv = sdv_phases_mean(sum, none);
    return lao_v4_make(uv.x, uv.y, 0, weight);
}

static lao_v4 push(const screen *s, uint32_t l, uint32_t k, float first) {
    texel t = texel_make(s, l, k);
    lao_v4 r = s->recalled[l][k];
    sdv_phases sum = sdv_phases_start(zero());
    lao_v2 uv;
    lao_v4 above;
    if (l == s->levels - 1)
        return r.w > 0 ? lao_v4_make(r.x, r.y, 1, 0) : zero();
    if (r.w > 0 && (float)l >= first)
        return lao_v4_make(r.x, r.y, (float)l > first ? 1.0f : 0.0f, 0);
    for (int i = 0; i < 4; i++) {
        long at = parent(&t, i);
        if (at >= 0)
            sum = hear(&t, sum, s->phase, l + 1, at, share(i));
    }
    above = s->phase[l + 1][parent(&t, 0)];
    uv.x = above.x;
    uv.y = above.y;
    uv = sdv_phases_mean(sum, uv);
    return lao_v4_make(uv.x, uv.y, 0, 0);
}

static void sweep(screen *s, uint32_t l) {
    lao_v4 *old;
    for (uint32_t k = 0; k < texels(s, l); k++) {
        texel t = texel_make(s, l, k);
        lao_v4 own = s->phase[l][k];
        sdv_phases sum = sdv_phases_start(zero());
        lao_v2 uv;
        for (int i = 0; i < 4 && own.z < 0.5f; i++) {
            int side = 2 * (i & 1) - 1;
            long at = place_of(s, l, t.x + (i < 2 ? side : 0), t.y + (i < 2 ? 0 : side));
            if (at >= 0)
                sum = hear(&t, sum, s->phase, l, at, 1);
        }
        uv.x = own.x;
        uv.y = own.y;
        uv = sdv_phases_mean(sum, uv);
        s->swept[l][k] = lao_v4_make(uv.x, uv.y, own.z, own.w);
    }
    old = s->phase[l];
    s->phase[l] = s->swept[l];
    s->swept[l] = old;
}

void screen_phases(screen *s) {
    float period = s->period * lao_pixel_zoom(s->frame.scale, s->frame.depth, 0.5f);
    float first = sdv_recycle_level(s->recycle, period, camera_apart(s) + 1 - s->converge);
    for (uint32_t l = s->levels; l-- > 0;) {
        for (uint32_t k = 0; k < texels(s, l); k++)
            s->phase[l][k] = push(s, l, k, first);
        for (int i = 0; i < s->sweeps && l + 1 < s->levels; i++)
            sweep(s, l);
    }
}

void screen_parameterize(screen *s) {
    bool stay = s->frame.history.x > 0.5f && s->converge < 0.5f && camera_apart(s) == 0;
    for (uint32_t k = 0; k < texels(s, 0); k++)
        s->recalled[0][k] = recall(s, k);
    for (uint32_t l = 1; l < s->levels; l++)
        for (uint32_t k = 0; k < texels(s, l); k++)
            s->recalled[l][k] = recall_up(s, l, k);
    screen_phases(s);
    for (uint32_t k = 0; k < texels(s, 0); k++) {
        lao_v2 guide =
            sdv_guide_screen(s->frame.view, sdv_tensor_axis(s->spread[0][k]), xyz(s->along[0][k]));
        s->uv[k] = lao_v4_make(s->phase[0][k].x, s->phase[0][k].y, guide.x, guide.y);
        if (stay && sdv_phase_stays(s->surface[k], s->surface_before[k]))
            s->uv[k] = s->uv_before[k];
    }
}

/* ---------------------------------------------------------------------------------------- ink */

static float footprint(const screen *s, lao_v3 z, lao_v3 n, lao_v3 p, lao_v3 direction) {
    return sdv_style_footprint(z, n, sdv_camera_unit(xyz(s->frame.world.x)),
                               sdv_camera_unit(xyz(s->frame.world.y)), direction, pixel_mm(s, p),
                               s->period);
}

static lao_v2 phase_of(lao_v4 t) {
    return lao_v2_make(t.x, t.y);
}

static float paper(const screen *s, int style, lao_v2 phase, float dark, float shadow, float mark,
                   float wide_u, float wide_v, float finer) {
    float inked = 0, pattern = 0, left;
    int n = s->pattern ? (int)s->pattern[0] : 0;
    for (int i = 0; n > 0 && i < SDV_PATTERN_SAMPLES * SDV_PATTERN_SAMPLES; i++)
        inked += dark > s->pattern[1 + sdv_pattern_at(phase, wide_u, wide_v, i, n)] ? 1.0f : 0.0f;
    if (n > 0)
        pattern = sdv_pattern_ink(inked, dark, wide_u, wide_v);
    left = sdv_style_paper(style, phase, dark, shadow, wide_u, wide_v, finer, pattern);
    if (mark > 0)
        left = left *
               (1.0f - sdv_style_ink(SDV_STYLE_STIPPLE + (int)s->values[SDV_SETTING_ID_mark_style],
                                     phase.x, phase.y, mark, wide_u, wide_v, finer));
    return left;
}

static bool marked(const screen *s, lao_v4 hit) {
    size_t at = 2 * (size_t)(hit.w < 0 ? 0 : hit.w);
    if (!s->colors || hit.w < 0)
        return false;
    return sdv_is_marked(xyz(hit), s->cones[at], s->cones[at + 1],
                         (float)s->colors[4 * at + 3] / 255.0f,
                         (float)s->colors[4 * at + 7] / 255.0f);
}

static float fineness(const screen *s, lao_v4 hit) {
    size_t at = 2 * (size_t)(hit.w < 0 ? 0 : hit.w);
    if (!s->cones || hit.w < 0)
        return 1;
    return sdv_ink_finer(sdv_cone_radius(xyz(hit), s->cones[at], s->cones[at + 1]), s->period,
                         pixel_mm(s, xyz(hit)));
}

static lao_v4 ink(const screen *s, uint32_t k, lao_v4 hit, lao_v4 normal, const lao_v4 *ray) {
    const float *v = s->values;
    lao_v2 slope =
        lao_pixel_slope(s->frame.ray, (float)(k % s->width) + 0.5f, (float)(k / s->width) + 0.5f);
    lao_v3 direction = lao_ray_direction(s->frame.world, slope, s->frame.depth.w);
    lao_v3 p = xyz(s->surface[k]), n = xyz(s->bgnormal[k]);
    int void_style = (int)v[SDV_SETTING_ID_void_style], style = (int)v[SDV_SETTING_ID_style];
    float facing = -lao_v3_dot(n, direction), shadow = 0, now, shown, rest = 0;
    float tone = sdv_style_tone(facing, v[SDV_SETTING_ID_surface_ambient],
                                v[SDV_SETTING_ID_surface_diffuse], 1);
    lao_v3 z = sdv_lift(s->frame.world, lao_v3_make(s->uv[k].z, s->uv[k].w, 1), n, n);
    float wide_u = footprint(s, z, n, p, direction);
    float wide_v = footprint(s, lao_v3_cross(n, z), n, p, direction);
    float mark = marked(s, hit) ? v[SDV_SETTING_ID_mark_darkness] : 0.0f;
    float finer = fineness(s, hit);
    lao_v4 before = s->recalled[0][k];
    if (!sdv_is_covered(hit.w)) {
        float reach = v[SDV_SETTING_ID_near_miss] > 1.5f
                          ? 0
                          : 0.01f * v[SDV_SETTING_ID_void_reach] * s->frame.depth.z;
        tone = 1 - sdv_void_share(normal.w, reach, lao_max(wide_u, wide_v)) *
                       (1 - sdv_style_tone(facing, 0.5f, 0.5f, 1));
        style = void_style == SDV_VOID_STIPPLE ? SDV_STYLE_STIPPLE
                : void_style == SDV_VOID_HATCH ? SDV_STYLE_HATCH
                                               : SDV_STYLE_PLAIN;
    } else if (style != SDV_STYLE_PLAIN && ray && v[SDV_SETTING_ID_near_miss] < 1.5f) {
        shadow = v[SDV_SETTING_ID_shadow_strength] *
                 sdv_depth_shadow(normal.w, ray[k].y, ray[k].x, v[SDV_SETTING_ID_shadow_ratio],
                                  0.01f * v[SDV_SETTING_ID_shadow_width] * s->frame.depth.z,
                                  v[SDV_SETTING_ID_shadow_softness]);
    }
    now = paper(s, style, phase_of(s->uv[k]), 1 - tone, shadow, mark, wide_u, wide_v, finer);
    if (before.w > 0) {
        shown = paper(s, style, phase_of(before), 1 - tone, shadow, mark, wide_u, wide_v, finer);
        shown = shown + before.z;
        rest = sdv_ink_rest(shown, now, v[SDV_SETTING_ID_ink_step]);
    }
    return lao_v4_make(now + rest, rest, 0, 0);
}

void screen_ink(screen *s, const lao_v4 *position, const lao_v4 *normal, const lao_v4 *ray) {
    for (uint32_t k = 0; k < texels(s, 0); k++)
        s->ink[k] = ink(s, k, position[k], normal[k], ray);
}
