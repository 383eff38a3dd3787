/* Vessel surfaces on both backends: the measure of every vertex is vsf_measure's, the look-up of
   every pixel and every full-screen pass is what the shared functions make of the images it reads,
   to the bit; OpenGL and Vulkan agree on every image; layers are exact as far as they go. */
#include "render_host.h"
#include "surface_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 90, HEIGHT = 66 };

/* ---------------------------------------------------------------------------------------------
 * surfaces */

typedef struct subject {
    vsf_mesh mesh;
    vsf_object object;
} subject;

static void subject_make(subject *s, surface_shape shape) {
    s->mesh = surface_build(&shape, 0, 0);
    surface_shape_free(&shape);
    assert_int_equal(vsf_object_make(NULL, &s->mesh, 0, &s->object), LAO_OK);
}

static void subject_free(subject *s) {
    vsf_object_free(&s->object);
    vsf_mesh_free(&s->mesh);
}

/* Distances that rise with x, and values that fall with it. */
static void subject_near(subject *s) {
    for (uint32_t i = 0; i < s->mesh.vertex_count; i++) {
        float x = s->mesh.positions[3 * i];
        s->object.near_pair[2 * i] = x + 8 < 0 ? 0 : x + 8;
        s->object.near_pair[2 * i + 1] = i % 5 == 0 ? VSF_FAR : 2;
        s->object.values[i] = i % 97 == 0 ? NAN : -x;
    }
}

/* Squares that face the viewer (the z axis up), at these heights and shifted by their number; each
   has a normal of its own, and so its own light. */
static void squares_make(subject *s, const float *heights, uint32_t count) {
    float *p = calloc(count, 12 * sizeof *p), *n = calloc(count, 12 * sizeof *n);
    uint32_t *t = calloc(count, 6 * sizeof *t);
    vsf_mesh_desc desc;
    assert_true(p && n && t);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < 4; k++) {
            static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
            float tilt = 1.3f * (float)(i + 1) / (float)count;
            p[12 * i + 3 * k] = (k == 1 || k == 2 ? 5.0f : -5.0f) + 0.5f * (float)i;
            p[12 * i + 3 * k + 1] = k >= 2 ? 5.0f : -5.0f;
            p[12 * i + 3 * k + 2] = heights[i];
            n[12 * i + 3 * k] = sinf(tilt);
            n[12 * i + 3 * k + 2] = cosf(tilt);
            for (uint32_t c = 0; k == 0 && c < 6; c++) {
                t[6 * i + c] = 4 * i + corners[c];
            }
        }
    }
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = 4 * count;
    desc.positions = p;
    desc.normals = n;
    desc.triangle_count = 2 * count;
    desc.triangles = t;
    desc.flags = VSF_MESH_KEEP_WINDING;
    assert_int_equal(vsf_mesh_build(NULL, &desc, &s->mesh), LAO_OK);
    assert_int_equal(vsf_object_make(NULL, &s->mesh, 0, &s->object), LAO_OK);
    free(p);
    free(n);
    free(t);
}

/* ---------------------------------------------------------------------------------------------
 * shots */

typedef struct scene {
    render_shot shot;
    lao_settings lines;
    vsf_settings surface;
    const void *settings[1];
} scene;

static void scene_make(scene *s, const subject *surface) {
    memset(s, 0, sizeof *s);
    s->shot.width = WIDTH;
    s->shot.height = HEIGHT;
    s->shot.set_count = 1;
    s->shot.settings[0] = &s->lines;
    s->shot.objects[0] = &surface->object.desc;
    s->settings[0] = &s->surface;
    s->shot.module_settings[0] = s->settings;
    s->shot.background[3] = 1;
    s->lines.set = LAO_SET(occlusion);
    s->lines.supersampling = 2;
    s->surface.surface_geometry = 1;
    s->shot.camera = render_camera(0.3, 0.9, 0.8, 40);
    render_perspective(&s->shot.camera, 30, (double)WIDTH / HEIGHT, 1, 200);
}

static lao_v4 texel_of(const render_image *image, uint32_t x, uint32_t y) {
    lao_v4 v;
    size_t at = (size_t)y * image->width + x;
    if (image->format == LAO_FORMAT_RGBA32F) {
        memcpy(&v, image->data + 16 * at, sizeof v);
    } else if (image->format == LAO_FORMAT_RGBA8) {
        const uint8_t *b = image->data + 4 * at;
        float part = 1.0f / 255.0f; /* Mesa multiplies by the rounded reciprocal */
        v = lao_v4_make((float)b[0] * part, (float)b[1] * part, (float)b[2] * part,
                        (float)b[3] * part);
    } else {
        memcpy(&v.x, image->data + 4 * at, sizeof v.x);
        v.y = v.z = v.w = 0;
    }
    return v;
}

static const render_image *need(const render_result *result, const char *name, uint32_t level) {
    const render_image *image = render_find(result, name, level);
    if (!image) {
        print_error("there is no image %s\n", name);
    }
    assert_non_null(image);
    return image;
}

static lao_v4 clamped(const render_image *image, int64_t x, int64_t y) {
    int64_t w = image->width, h = image->height;
    x = x < 0 ? 0 : x >= w ? w - 1 : x;
    y = y < 0 ? 0 : y >= h ? h - 1 : y;
    return texel_of(image, (uint32_t)x, (uint32_t)y);
}

/* What an RGBA8 image keeps of a colour. */
static uint32_t byte_of(float v) {
    return (uint32_t)lrintf(lao_clamp01(v) * 255.0f); /* half to even */
}

static void draw_both(const scene *s, render_result results[2]) {
    render_draw_both(&s->shot, results);
    render_same_images("GL, VK", &results[0], &results[1]);
}

static void free_both(render_result results[2]) {
    render_free(&results[0]);
    render_free(&results[1]);
}

/* ---------------------------------------------------------------------------------------------
 * per vertex, per pixel */

/* x of the look-up, of a vertex. */
static float nearness_of(const scene *s, const vsf_object *object, uint32_t vertex) {
    const float *pair = object->near_pair + 2 * (size_t)vertex;
    vsf_settings v;
    memset(&v, 0, sizeof v);
    lao_settings_resolve(vsf_module(), &s->surface, &v.shading);
    return v.near_source > 0
               ? vsf_value_x(object->values[vertex], v.value_low, v.value_high)
               : vsf_near_x(vsf_near_mix(pair[0], pair[1], v.near_part), v.near_gamma);
}

/* What the passes of the mesh take from each vertex beside its buffers: measure and nearness. */
static void check_vertices(const scene *shown, const subject *s, const render_result *result) {
    const render_image *measures = need(result, "surface_measure", 0);
    const render_image *nearnesses = need(result, "surface_nearness", 0);
    lao_v4 eye = vsf_eye(result->frame.view, result->frame.depth.w);
    const float at[4] = {eye.x, eye.y, eye.z, eye.w};
    float *measure = calloc(s->mesh.vertex_count, sizeof *measure);
    assert_non_null(measure);
    assert_int_equal(vsf_measure(NULL, &s->object.buffers, at, 0, measure), LAO_OK);
    assert_int_equal(measures->format, LAO_FORMAT_R32F);
    assert_true((size_t)measures->width * measures->height >= s->mesh.vertex_count);
    for (uint32_t i = 0; i < s->mesh.vertex_count; i++) {
        float near = nearness_of(shown, &s->object, i);
        assert_memory_equal(measures->data + 4 * (size_t)i, &measure[i], 4);
        assert_memory_equal(nearnesses->data + 4 * (size_t)i, &near, 4);
    }
    free(measure);
}

static lao_v4 mapped(const vsf_object *object, float x, float y, float opacity) {
    lao_v2 place = vsf_map_place(x, VSF_MAP_COLORS);
    lao_v4 colors[2];
    memcpy(colors, object->map + 4 * (size_t)place.y, sizeof colors);
    lao_v4 c = vsf_mix(colors[0], colors[1], place.x);
    return vsf_mapped(lao_v3_make(c.x, c.y, c.z), x, y, opacity);
}

/* The look-up against C, from the measure and nearness that the same pixel kept. Returns how many
   pixels are covered. */
static uint32_t check_lookup(const scene *s, const vsf_object *object,
                             const render_result *result) {
    const render_image *position = need(result, "surface_position", 0);
    const render_image *normal = need(result, "surface_normal", 0);
    const render_image *lut = need(result, "surface_lut", 0);
    vsf_settings filled;
    uint32_t covered = 0;
    memset(&filled, 0, sizeof filled);
    lao_settings_resolve(vsf_module(), &s->surface, &filled.shading);
    for (uint32_t y = 0; y < lut->height; y++) {
        for (uint32_t x = 0; x < lut->width; x++) {
            lao_v4 p = texel_of(position, x, y), n = texel_of(normal, x, y),
                   l = texel_of(lut, x, y), wanted;
            if (p.w < 0.5f) {
                continue;
            }
            covered++;
            float measure = vsf_measure_y(n.w, filled.brightness);
            wanted = filled.near_colors > 0 ? mapped(object, l.w, measure, filled.near_opacity)
                                            : vsf_lookup(l.w, measure);
            assert_memory_equal(&wanted, &l, 3 * sizeof(float));
            assert_true(fabsf(n.x * n.x + n.y * n.y + n.z * n.z - 1) < 1e-5f);
        }
    }
    return covered;
}

static void per_vertex_and_pixel(void **state) {
    subject torus;
    scene s;
    render_result results[2];
    (void)state;
    subject_make(&torus, surface_torus(5, 2, 120, 60)); /* 7200 vertices: four rows of texels */
    subject_near(&torus);
    for (uint32_t i = 0; i < 4 * VSF_MAP_COLORS; i++) {
        torus.object.map[i] = (float)(i * 37 % 101) / 101;
    }
    scene_make(&s, &torus);
    s.surface.near_gamma = 6;
    s.surface.near_part = 0.25f;
    for (int round = 0; round < 7; round++) {
        s.surface.shading = (float)(round % 3);
        s.surface.near_source = round == 3 ? VSF_NEAR_VALUE : VSF_NEAR_DISTANCE;
        s.surface.value_high = 5;
        s.surface.near_colors = round == 6 ? VSF_NEAR_MAP : VSF_NEAR_HUES;
        s.surface.falloff_form = round == 5 ? VSF_FALLOFF_RIM : VSF_FALLOFF_PAPER;
        s.surface.blend = round == 4 ? VSF_BLEND_ADD : VSF_BLEND_OVER;
        if (round == 1 || round == 4) {
            render_orthographic(&s.shot.camera, 18, (double)WIDTH / HEIGHT, 1, 200);
        } else {
            s.shot.camera = render_camera(0.3, 0.9, 0.8, 40);
            render_perspective(&s.shot.camera, 30, (double)WIDTH / HEIGHT, 1, 200);
        }
        if (round >= 3) {
            render_reverse(&s.shot.camera);
        }
        draw_both(&s, results);
        for (int i = 0; i < 2; i++) {
            check_vertices(&s, &torus, &results[i]);
            assert_in_range(check_lookup(&s, &torus.object, &results[i]), 2000, 4 * WIDTH * HEIGHT);
        }
        free_both(results);
    }
    subject_free(&torus);
}

/* ---------------------------------------------------------------------------------------------
 * full-screen passes against C */

/* The picture of an RGBA8 image that a pass made of colours. */
typedef lao_v4 pixel_function(const scene *s, const render_result *result,
                              const render_image *before, uint32_t x, uint32_t y);

static void check_pixels(const scene *s, const render_result *before, const render_result *after,
                         pixel_function *function) {
    const render_image *source = need(before, "shaded", 0), *image = need(after, "shaded", 0);
    uint32_t wrong = 0, changed = 0;
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++) {
            lao_v4 c = function(s, after, source, x, y);
            const uint32_t wanted[4] = {byte_of(c.x), byte_of(c.y), byte_of(c.z), byte_of(c.w)};
            const uint8_t *got = image->data + 4 * ((size_t)y * image->width + x);
            const uint8_t *old = source->data + 4 * ((size_t)y * image->width + x);
            changed += memcmp(got, old, 4) != 0;
            for (int k = 0; k < 4; k++) {
                wrong += got[k] != wanted[k];
            }
        }
    }
    assert_int_equal(wrong, 0);
    assert_in_range(changed, 100, 1000000);
}

static lao_v4 halves(const render_image *image, uint32_t x, uint32_t y) {
    float v[4];
    for (uint32_t k = 0; k < 4; k++) {
        const uint8_t *at = image->data + 8 * ((size_t)y * image->width + x) + 2 * k;
        uint32_t h = at[0] | (uint32_t)at[1] << 8, e = h >> 10 & 31, m = h & 1023;
        assert_true(h < 31744); /* neither negative nor infinite */
        v[k] = e ? ldexpf((float)(1024 + m), (int)e - 25) : ldexpf((float)m, -24);
    }
    return lao_v4_make(v[0], v[1], v[2], v[3]);
}

static lao_v4 over_pixel(const scene *s, const render_result *result, const render_image *before,
                         uint32_t x, uint32_t y) {
    lao_v4 front = halves(need(result, "surface_composed", 0), x, y),
           behind = texel_of(before, x, y);
    return s->surface.blend > 0 ? vsf_add(front, behind) : vsf_over(front, behind);
}

static float buffer_at(const render_result *r, uint32_t x, uint32_t y) {
    return vsf_nearer(texel_of(need(r, "zbuffer", 0), x, y).x,
                      texel_of(need(r, "surface_nearest", 0), x, y).x, r->frame.scale.z);
}

static float depth_at(const render_result *r, uint32_t x, uint32_t y) {
    return vsf_view_depth(r->frame.unproject, buffer_at(r, x, y));
}

static lao_v4 shadow_pixel(const scene *s, const render_result *r, const render_image *before,
                           uint32_t x, uint32_t y) {
    const render_image *small = need(r, "shadow_blurred", VSF_SHADOW_LEVEL);
    float samples = VSF_SHADOW_PIXELS * s->lines.supersampling;
    lao_v2 u = vsf_between((float)x, samples), v = vsf_between((float)y, samples);
    int64_t i = (int64_t)u.y, j = (int64_t)v.y;
    lao_v4 a = clamped(small, i, j), b = clamped(small, i + 1, j), c = clamped(small, i, j + 1),
           d = clamped(small, i + 1, j + 1);
    float depth = lao_scene_depth(r->frame.depth, depth_at(r, x, y));
    float blurred = vsf_covered_mean(vsf_bilinear(a.x, b.x, c.x, d.x, u.x, v.x),
                                     vsf_bilinear(a.y, b.y, c.y, d.y, u.x, v.x), depth);
    return vsf_shadowed(texel_of(before, x, y), depth, blurred, 2.0f);
}

static lao_v4 attenuated_pixel(const scene *s, const render_result *r, const render_image *before,
                               uint32_t x, uint32_t y) {
    float depth = lao_scene_depth(r->frame.depth, depth_at(r, x, y));
    (void)s;
    return vsf_attenuated(texel_of(before, x, y), depth, 0.5f);
}

static float sigma_of(const scene *s, float z) {
    return vsf_blur_sigma(vsf_outside(z, s->surface.focus_near, s->surface.focus_far), 0.2f, 8.0f);
}

static lao_v4 focus_pixel(const scene *s, const render_result *r, const render_image *before,
                          uint32_t x, uint32_t y) {
    uint32_t factor = (uint32_t)s->lines.supersampling;
    lao_v4 wide = texel_of(need(r, "focus_blurred", 0), x / factor, y / factor);
    return vsf_mix(texel_of(before, x, y), wide, lao_min(sigma_of(s, depth_at(r, x, y)), 1.0f));
}

/* A Gaussian along x or y of the small depth. */
static void check_shadow_blur(const render_result *r, const char *from, const char *to, int dx) {
    const render_image *a = need(r, from, VSF_SHADOW_LEVEL), *b = need(r, to, VSF_SHADOW_LEVEL);
    float sigma = vsf_shadow_sigma(0.01f * 5.0f, WIDTH, HEIGHT);
    lao_int reach = vsf_reach(sigma, VSF_SHADOW_REACH);
    assert_true(reach > 1);
    for (uint32_t y = 0; y < b->height; y++) {
        for (uint32_t x = 0; x < b->width; x++) {
            lao_v4 got = texel_of(b, x, y), wanted = lao_v4_make(0, 0, 0, 0);
            for (int64_t i = -reach; i <= reach; i++) {
                lao_v4 part = clamped(a, x + (dx ? i : 0), y + (dx ? 0 : i));
                float weight = vsf_gauss((float)(i * i), sigma);
                wanted.x = wanted.x + weight * part.x;
                wanted.y = wanted.y + weight * part.y;
            }
            assert_memory_equal(&wanted, &got, sizeof got);
        }
    }
}

static void check_shadow_depth(const scene *s, const render_result *r) {
    const render_image *image = need(r, "shadow_depth", VSF_SHADOW_LEVEL);
    uint32_t n = (uint32_t)(VSF_SHADOW_PIXELS * s->lines.supersampling);
    assert_int_equal(image->width, (WIDTH + 3) / 4);
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++) {
            lao_v4 got = texel_of(image, x, y), wanted = lao_v4_make(0, 0, 0, 0);
            for (uint32_t j = n * y; j < n * (y + 1) && j < n / 4 * HEIGHT; j++) {
                for (uint32_t i = n * x; i < n * (x + 1) && i < n / 4 * WIDTH; i++) {
                    float d = buffer_at(r, i, j);
                    if (vsf_is_covered(d, r->frame.scale.z)) {
                        wanted.x = wanted.x + lao_scene_depth(r->frame.depth, depth_at(r, i, j));
                        wanted.y = wanted.y + 1.0f;
                    }
                }
            }
            assert_memory_equal(&wanted, &got, sizeof got);
        }
    }
}

/* Samples out of focus of a pixel of the view, and its blur along both axes. */
static void check_focus(const scene *s, const render_result *before, const render_result *r) {
    const render_image *shaded = need(before, "shaded", 0), *color = need(r, "focus_color", 0);
    const render_image *depth = need(r, "focus_depth", 0);
    const char *const names[3] = {"focus_color", "focus_x", "focus_blurred"};
    uint32_t n = (uint32_t)s->lines.supersampling;
    for (uint32_t y = 0; y < HEIGHT; y++) {
        for (uint32_t x = 0; x < WIDTH; x++) {
            lao_v4 sums[2], wanted, got = texel_of(color, x, y);
            float counts[2] = {0, 0}, depths[2] = {VSF_FAR, VSF_FAR}, d = texel_of(depth, x, y).x;
            memset(sums, 0, sizeof sums);
            for (uint32_t k = 0; k < n * n; k++) {
                float z = depth_at(r, n * x + k % n, n * y + k / n);
                int out = vsf_outside(z, s->surface.focus_near, s->surface.focus_far) > 0;
                sums[out] = vsf_sum(sums[out], texel_of(shaded, n * x + k % n, n * y + k / n), 1);
                depths[out] = lao_min(depths[out], z);
                counts[out] += 1;
            }
            int out = counts[1] > 0;
            wanted = vsf_scaled(sums[out], 1.0f / counts[out]);
            assert_memory_equal(&wanted, &got, sizeof got);
            assert_memory_equal(&depths[out], &d, sizeof d);
        }
    }
    for (int pass = 0; pass < 2; pass++) {
        const render_image *a = need(r, names[pass], 0), *b = need(r, names[pass + 1], 0);
        for (uint32_t y = 0; y < HEIGHT; y++) {
            for (uint32_t x = 0; x < WIDTH; x++) {
                float z = texel_of(depth, x, y).x, sigma = sigma_of(s, z), weights = 1;
                lao_v4 sum = texel_of(a, x, y), got = texel_of(b, x, y);
                lao_int reach = vsf_reach(sigma, VSF_BLUR_MOST);
                for (int64_t k = 2; k < 2 * reach + 2; k++) { /* -1, 1, -2, 2, ... */
                    int64_t i = k % 2 ? k / 2 : -k / 2;
                    int64_t u = x + (pass ? 0 : i), v = y + (pass ? i : 0);
                    if (u < 0 || v < 0 || u >= WIDTH || v >= HEIGHT) {
                        continue;
                    }
                    float other = texel_of(depth, (uint32_t)u, (uint32_t)v).x;
                    float weight =
                        vsf_blur_weight((float)(i * i), sigma, z, sigma_of(s, other), other);
                    sum = vsf_sum(sum, texel_of(a, (uint32_t)u, (uint32_t)v), weight);
                    weights = weights + weight;
                }
                sum = vsf_scaled(sum, 1.0f / weights);
                assert_memory_equal(&sum, &got, sizeof got);
            }
        }
    }
}

/* With brightness 0 front faces are clear: what is behind them. */
static void composed(void **state) {
    subject torus;
    scene s;
    render_result clear[2], drawn[2];
    (void)state;
    subject_make(&torus, surface_torus(5, 2, 60, 30));
    subject_near(&torus);
    scene_make(&s, &torus);
    for (int blend = 0; blend < 2; blend++) {
        s.surface.blend = (float)blend;
        s.surface.set = VSF_SET(brightness);
        s.surface.brightness = 0;
        draw_both(&s, clear);
        s.surface.brightness = 4;
        draw_both(&s, drawn);
        check_pixels(&s, &clear[0], &drawn[0], over_pixel);
        free_both(clear);
        free_both(drawn);
    }
    subject_free(&torus);
}

static void effects(void **state) {
    subject torus;
    scene s;
    render_result before[2], after[2];
    (void)state;
    subject_make(&torus, surface_torus(5, 2, 60, 30));
    scene_make(&s, &torus);
    s.surface.brightness = 4;
    s.shot.camera = render_camera(0.1, 1, 0.4, 40); /* one side of the ring before the other */
    render_perspective(&s.shot.camera, 30, (double)WIDTH / HEIGHT, 1, 200);
    for (int reversed = 0; reversed < 2; reversed++) {
        if (reversed) {
            render_orthographic(&s.shot.camera, 18, (double)WIDTH / HEIGHT, 1, 200);
            render_reverse(&s.shot.camera);
            s.lines.supersampling = 1;
        }
        draw_both(&s, before);
        s.surface.depth_shadow = 1;
        s.surface.depth_shadow_width = 5;
        draw_both(&s, after);
        check_shadow_depth(&s, &after[0]);
        check_shadow_blur(&after[0], "shadow_depth", "shadow_x", 1);
        check_shadow_blur(&after[0], "shadow_x", "shadow_blurred", 0);
        check_pixels(&s, &before[0], &after[0], shadow_pixel);
        free_both(after);
        s.surface.depth_shadow = 0;
        s.surface.attenuation = 1;
        draw_both(&s, after);
        check_pixels(&s, &before[0], &after[0], attenuated_pixel);
        free_both(after);
        s.surface.attenuation = 0;
        s.surface.focus = 1;
        s.surface.focus_near = 36;
        s.surface.focus_far = 39;
        draw_both(&s, after);
        check_focus(&s, &before[0], &after[0]);
        check_pixels(&s, &before[0], &after[0], focus_pixel);
        free_both(after);
        /* everything in focus: nothing changes */
        s.surface.focus_near = 0;
        s.surface.focus_far = 1e9f;
        s.surface.set |= VSF_SET(focus_near);
        draw_both(&s, after);
        assert_int_equal(render_compare("all in focus", need(&before[0], "shaded", 0),
                                        need(&after[0], "shaded", 0))
                             .texels,
                         0);
        free_both(after);
        s.surface.focus = 0;
        s.surface.set = 0;
        free_both(before);
    }
    subject_free(&torus);
}

/* A step of depth without an end: beside it the blurred depth less the depth is half of erfc of the
   distance over sigma sqrt 2, of the depth's step (METHODS 10.6). */
static void shadow_of_a_step(void **state) {
    static const float two[2] = {10, -10};
    subject surface;
    scene s;
    render_result results[2];
    (void)state;
    squares_make(&surface, two, 2);
    for (uint32_t i = 0; i < surface.mesh.vertex_count; i++) { /* half of the picture, and all */
        float *p = surface.object.buffers.points + 4 * (size_t)i;
        p[0] = p[0] > 0 && p[2] > 0 ? 0 : p[0] * 10;
        p[1] *= 10;
    }
    scene_make(&s, &surface);
    s.shot.width = 400;
    s.shot.height = 300;
    s.lines.supersampling = 1;
    s.shot.sphere[3] = 30;
    s.shot.camera = render_camera(0, 0, 1, 60);
    render_orthographic(&s.shot.camera, 30, 4.0 / 3, 1, 200);
    s.surface.shading = VSF_SHADING_TRANSPARENT;
    s.surface.depth_shadow = 1;
    draw_both(&s, results);
    const render_image *small = need(&results[0], "shadow_blurred", VSF_SHADOW_LEVEL);
    double near = (double)lao_scene_depth(results[0].frame.depth, depth_at(&results[0], 10, 150));
    double far = (double)lao_scene_depth(results[0].frame.depth, depth_at(&results[0], 390, 150));
    assert_true(far - near > 0.3);
    for (uint32_t i = 20; i < 80; i++) { /* the step is at pixel 200, sigma 10 pixels */
        lao_v4 texel = texel_of(small, i, 37);
        double x = 4 * (i + 0.5) - 200, got = ((double)texel.x / (double)texel.y - near);
        double wanted = 0.5 * erfc(-x / (10 * sqrt(2.0))) * (far - near);
        assert_true(fabs(got - wanted) < 0.02 * (far - near));
    }
    free_both(results);
    subject_free(&surface);
}

/* ---------------------------------------------------------------------------------------------
 * layers */

static const float heights[6] = {3, -4, 1, 6, -2, 5};

/* Nearest first; only the squares over (x, y), mm; -1: too close to an edge to tell. */
static int sorted_squares(float x, float y, uint32_t found[6]) {
    int count = 0;
    for (uint32_t i = 0; i < 6; i++) {
        float u = fabsf(x - 0.5f * (float)i), v = fabsf(y);
        if (fabsf(u - 5) < 0.02f || fabsf(v - 5) < 0.02f) {
            return -1;
        }
        if (u > 5 || v > 5) {
            continue;
        }
        int at = count++;
        for (; at > 0 && heights[found[at - 1]] < heights[i]; at--) {
            found[at] = found[at - 1];
        }
        found[at] = i;
    }
    return count;
}

/* A front face of a baseline whose normal has this cosine to the viewer. */
static lao_v4 baseline_color(int shading, float facing) {
    lao_v3 wall = vsf_wall(lao_v3_make(0.86f, 0.81f, 0.76f), facing, 0.45f, 0.55f);
    return vsf_premultiply(wall, shading == VSF_SHADING_FRESNEL ? vsf_fresnel(facing, 1.5f) : 0.4f);
}
static lao_v4 square_color(const subject *s, int shading, uint32_t i) {
    return baseline_color(shading, s->mesh.normals[3 * (size_t)s->mesh.triangles[6 * i] + 2]);
}

/* Every pixel against its sorted squares; those beyond the last layer do not count. */
static void layers(void **state) {
    subject surface;
    scene s;
    (void)state;
    squares_make(&surface, heights, 6);
    scene_make(&s, &surface);
    s.shot.camera = render_camera(0, 0, 1, 40);
    render_orthographic(&s.shot.camera, 14, (double)WIDTH / HEIGHT, 1, 200);
    s.surface.set = VSF_SET(layers);
    for (int round = 0; round < 11; round++) { /* 0 to 7 layers; 1, 3 and 5 of the other baseline */
        int shading = round < 8 ? VSF_SHADING_TRANSPARENT : VSF_SHADING_FRESNEL;
        int most = round < 8 ? round : 2 * round - 15;
        render_result results[2];
        uint32_t deepest = 0, checked = 0;
        double worst = 0;
        if (round == 6) {
            render_reverse(&s.shot.camera);
        }
        s.surface.layers = (float)most;
        s.surface.shading = (float)shading;
        draw_both(&s, results);
        const render_image *over = need(&results[0], "surface_composed", 0);
        const render_image *position = need(&results[0], "surface_position", 0);
        for (uint32_t y = 0; y < over->height; y++) {
            for (uint32_t x = 0; x < over->width; x++) {
                lao_v2 slope =
                    lao_pixel_slope(results[0].frame.ray, (float)x + 0.5f, (float)y + 0.5f);
                lao_v3 p = lao_ray_origin(results[0].frame.world, slope, 1);
                lao_v4 got = halves(over, x, y), wanted = lao_v4_make(0, 0, 0, 0);
                uint32_t found[6];
                int count = sorted_squares(p.x, p.y, found);
                if (count < 0) {
                    continue;
                }
                deepest = (uint32_t)count > deepest ? (uint32_t)count : deepest;
                for (int i = 0; i < count && i <= most; i++) {
                    wanted = vsf_over(wanted, square_color(&surface, shading, found[i]));
                }
                checked++;
                worst = fmax(worst, fmax(fabs((double)(got.x - wanted.x)),
                                         fabs((double)(got.w - wanted.w))));
                if (count > 0) {
                    assert_true(fabsf(texel_of(position, x, y).z - heights[found[0]]) < 1e-3f);
                }
            }
        }
        assert_int_equal(deepest, 6);
        if (most > 0) { /* six squares lie on each other: only the seventh layer behind is none */
            assert_true(texel_of(need(&results[0], "surface_left", 0), 0, 0).x ==
                        (most > 6 ? 0.0f : 1.0f));
        }
        assert_in_range(checked, 15000, 4 * WIDTH * HEIGHT);
        assert_true(worst < 0.002); /* half floats, once a layer */
        free_both(results);
    }
    subject_free(&surface);
}

/* ---- closed surfaces within each other */

enum { BALLS = 3 };
static const double balls[BALLS][4] = {{0, 0, 0, 5}, {0.7, -0.4, 0.5, 3.2}, {-0.3, 0.2, 0.4, 1.7}};

/* Unit normal at a direction from the centre: leaning over, or a ball would look alike at both ends
   of a ray through it. */
static void leaning(const double out[3], double n[3]) {
    const double lean[3] = {0.2, 0.3, 0.4};
    double size = 0;
    for (int k = 0; k < 3; k++) {
        n[k] = out[k] + lean[k];
        size += n[k] * n[k];
    }
    for (int k = 0; k < 3; k++) {
        n[k] /= sqrt(size);
    }
}

/* Spheres within each other, as parts of one mesh. */
static void balls_make(subject *s) {
    surface_shape shape = surface_sphere(1, 5);
    uint32_t n = shape.vertex_count, m = shape.triangle_count;
    float *p = calloc(BALLS * n, 3 * sizeof *p), *normals = calloc(BALLS * n, 3 * sizeof *p);
    uint32_t *t = calloc(BALLS * m, 3 * sizeof *t);
    vsf_mesh_desc desc;
    assert_true(p && normals && t);
    for (uint32_t b = 0; b < BALLS; b++) {
        for (uint32_t i = 0; i < n; i++) {
            double out[3], normal[3];
            for (uint32_t k = 0; k < 3; k++) {
                out[k] = (double)shape.positions[3 * i + k];
                p[3 * (b * n + i) + k] = (float)(balls[b][k] + balls[b][3] * out[k]);
            }
            leaning(out, normal);
            for (uint32_t k = 0; k < 3; k++) {
                normals[3 * (b * n + i) + k] = (float)normal[k];
            }
        }
        for (uint32_t i = 0; i < 3 * m; i++) {
            t[3 * b * m + i] = shape.triangles[i] + b * n;
        }
    }
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = BALLS * n;
    desc.positions = p;
    desc.normals = normals;
    desc.triangle_count = BALLS * m;
    desc.triangles = t;
    assert_int_equal(vsf_mesh_build(NULL, &desc, &s->mesh), LAO_OK);
    assert_int_equal(vsf_object_make(NULL, &s->mesh, 0, &s->object), LAO_OK);
    surface_shape_free(&shape);
    free(p);
    free(normals);
    free(t);
}

/* Cosine of the normal of ball b where a ray is at t. */
static double facing_at(int b, const double o[3], const double d[3], double t) {
    double out[3], n[3], sum = 0, dd = 0;
    for (int k = 0; k < 3; k++) {
        out[k] = (o[k] + t * d[k] - balls[b][k]) / balls[b][3];
    }
    leaning(out, n);
    for (int k = 0; k < 3; k++) {
        sum += n[k] * d[k];
        dd += d[k] * d[k];
    }
    return fabs(sum) / sqrt(dd);
}

/* Where a ray enters and leaves ball b. 1: it meets it, 0: not, -1: too close to tell. */
static int meet(int b, const double o[3], const double d[3], double t[2]) {
    double half = 0, c = -balls[b][3] * balls[b][3], dd = 0;
    for (int k = 0; k < 3; k++) {
        half += (balls[b][k] - o[k]) * d[k];
        c += (balls[b][k] - o[k]) * (balls[b][k] - o[k]);
        dd += d[k] * d[k];
    }
    double root = half * half - dd * c;
    if (fabs(root) / dd < 0.15 * balls[b][3]) {
        return -1;
    }
    t[0] = (half - sqrt(fmax(root, 0))) / dd;
    t[1] = (half + sqrt(fmax(root, 0))) / dd;
    return root > 0;
}

/* Colour along a ray: the front faces before the nearest back face, nearest first, and that back
   face. Returns how many balls it meets, -1: too close to a silhouette to tell. */
static int ray_color(lao_v3 origin, lao_v3 direction, int shading, lao_v4 *color) {
    const double o[3] = {(double)origin.x, (double)origin.y, (double)origin.z};
    const double d[3] = {(double)direction.x, (double)direction.y, (double)direction.z};
    double front[BALLS], t[2], back = 1e9;
    int fronts[BALLS], behind = 0, count = 0;
    for (int b = 0; b < BALLS; b++) {
        int met = meet(b, o, d, t), at = count;
        if (met < 0) {
            return -1;
        }
        for (; met && at > 0 && front[at - 1] > t[0]; at--) {
            front[at] = front[at - 1];
            fronts[at] = fronts[at - 1];
        }
        if (met) {
            front[at] = t[0];
            fronts[at] = b;
            count++;
        }
        if (met && t[1] < back) {
            back = t[1];
            behind = b;
        }
    }
    *color = lao_v4_make(0, 0, 0, 0);
    for (int i = 0; i < count && front[i] < back; i++) {
        float facing = (float)facing_at(fronts[i], o, d, front[i]);
        *color = vsf_over(*color, baseline_color(shading, facing));
    }
    if (count > 0) {
        float facing = (float)facing_at(behind, o, d, back);
        lao_v3 wall = vsf_wall(lao_v3_make(0.86f, 0.81f, 0.76f), facing, 0.45f, 0.55f);
        *color = vsf_over(*color, vsf_premultiply(wall, 1));
    }
    return count;
}

/* Both baselines of balls within balls, pixel by pixel against the faces along its ray. */
static void nested(void **state) {
    subject surface;
    scene s;
    (void)state;
    balls_make(&surface);
    assert_int_equal(vsf_mesh_layers(&surface.mesh), BALLS - 1);
    scene_make(&s, &surface);
    s.surface.set = VSF_SET(layers);
    s.surface.layers = BALLS - 1;
    for (int round = 0; round < 4; round++) {
        render_result results[2];
        uint32_t counts[BALLS + 1] = {0};
        double worst = 0;
        if (round == 2) {
            render_orthographic(&s.shot.camera, 11, (double)WIDTH / HEIGHT, 1, 200);
        }
        int shading = round % 2 ? VSF_SHADING_FRESNEL : VSF_SHADING_TRANSPARENT;
        s.surface.shading = (float)shading;
        draw_both(&s, results);
        const render_image *image = need(&results[0], "shaded", 0);
        const lao_frame_uniforms *frame = &results[0].frame;
        for (uint32_t y = 0; y < image->height; y++) {
            for (uint32_t x = 0; x < image->width; x++) {
                lao_v2 slope = lao_pixel_slope(frame->ray, (float)x + 0.5f, (float)y + 0.5f);
                lao_v4 wanted, got = texel_of(image, x, y);
                int count = ray_color(lao_ray_origin(frame->world, slope, frame->depth.w),
                                      lao_ray_direction(frame->world, slope, frame->depth.w),
                                      shading, &wanted);
                if (count < 0) {
                    continue;
                }
                counts[count]++;
                worst = fmax(worst, fmax(fabs((double)(got.x - wanted.x)),
                                         fabs((double)(got.w - wanted.w))));
            }
        }
        for (int i = 0; i <= BALLS; i++) {
            assert_in_range(counts[i], 200, 4 * WIDTH * HEIGHT);
        }
        if (worst > 1.5 / 255) {
            print_error("round %d: worst %g\n", round, worst);
        }
        assert_true(worst <= 1.5 / 255); /* bytes, half floats and 20,000 flat triangles a ball */
        free_both(results);
    }
    subject_free(&surface);
}

/* A closed surface needs no layer behind the nearest: its back faces hide them. Nested ones need
   one each, open ones the default. */
static void layers_needed(void **state) {
    subject surface;
    surface_shape shapes[2] = {surface_torus(5, 2, 60, 30), surface_saddle(0.1, 5, 8)};
    render_result few[2], many[2];
    scene s;
    (void)state;
    for (int i = 0; i < 2; i++) {
        subject_make(&surface, shapes[i]);
        assert_int_equal(vsf_mesh_layers(&surface.mesh), i == 0 ? 0 : 7);
        if (i == 0) {
            scene_make(&s, &surface);
            s.surface.brightness = 4;
            draw_both(&s, many);
            s.surface.set |= VSF_SET(layers);
            draw_both(&s, few);
            /* but where sheets touch, at silhouettes, and rounding orders them */
            assert_in_range(
                render_compare("layers", need(&few[0], "shaded", 0), need(&many[0], "shaded", 0))
                    .texels,
                0, 3);
            free_both(few);
            free_both(many);
        }
        subject_free(&surface);
    }
}

/* What is in focus gives nothing to what is behind it, however it is coloured. */
static void no_bleeding(void **state) {
    static const float two[2] = {10, -20};
    subject surface;
    scene s;
    render_result dark[2], light[2];
    uint32_t behind = 0, blurred = 0;
    (void)state;
    squares_make(&surface, two, 2);
    scene_make(&s, &surface);
    s.shot.camera = render_camera(0, 0, 1, 40);
    render_orthographic(&s.shot.camera, 14, (double)WIDTH / HEIGHT, 1, 200);
    s.surface.shading = VSF_SHADING_TRANSPARENT;
    s.surface.opacity = 1;
    s.surface.focus = 1;
    s.surface.focus_near = 29;
    s.surface.focus_far = 31; /* the upper square */
    draw_both(&s, dark);
    for (uint32_t i = 0; i < 4; i++) { /* another light on it alone */
        surface.object.buffers.normals[4 * i] = 0;
        surface.object.buffers.normals[4 * i + 2] = 1;
    }
    draw_both(&s, light);
    const render_image *a = need(&dark[0], "shaded", 0), *b = need(&light[0], "shaded", 0);
    for (uint32_t y = 0; y < a->height; y++) {
        for (uint32_t x = 0; x < a->width; x++) {
            size_t at = 4 * ((size_t)y * a->width + x);
            if (depth_at(&dark[0], x, y) > 31) {
                behind++;
                blurred += a->data[at + 3] != 0 && a->data[at + 3] != 255;
                assert_memory_equal(a->data + at, b->data + at, 4);
            }
        }
    }
    assert_in_range(behind, 1000, 1000000);
    assert_in_range(blurred, 100, 1000000);
    free_both(dark);
    free_both(light);
    subject_free(&surface);
}

/* ---------------------------------------------------------------------------------------------
 * among lines */

/* Lines in and around a torus: the order of the sets does not matter, and lines in front of the
   wall are not covered by it. */
static void among_lines(void **state) {
    subject torus;
    scene s;
    render_lines lines;
    render_result results[2][2];
    (void)state;
    memset(&lines, 0, sizeof lines);
    subject_make(&torus, surface_torus(5, 2, 60, 30));
    scene_make(&s, &torus);
    s.surface.brightness = 3;
    render_scatter(&lines, 40, 5, 30, 8, 8);
    for (int order = 0; order < 2; order++) {
        s.shot.set_count = 2;
        s.shot.lines[order] = &lines;
        s.shot.lines[1 - order] = NULL;
        s.shot.objects[order] = NULL;
        s.shot.objects[1 - order] = &torus.object.desc;
        s.shot.settings[0] = s.shot.settings[1] = &s.lines;
        s.shot.module_settings[0] = s.shot.module_settings[1] = s.settings;
        draw_both(&s, results[order]);
    }
    const render_image *z[2] = {need(&results[0][0], "zbuffer", 0),
                                need(&results[1][0], "zbuffer", 0)};
    const render_image *out[2] = {need(&results[0][0], "out", 0), need(&results[1][0], "out", 0)};
    assert_int_equal(render_compare("zbuffer", z[0], z[1]).texels, 0);
    assert_int_equal(render_compare("out", out[0], out[1]).texels, 0);
    free_both(results[0]);
    free_both(results[1]);
    /* one set of both */
    s.shot.set_count = 1;
    s.shot.lines[0] = &lines;
    s.shot.objects[0] = &torus.object.desc;
    draw_both(&s, results[0]);
    free_both(results[0]);
    /* effects beside lines, and two surfaces */
    s.surface.depth_shadow = s.surface.focus = s.surface.attenuation = 1;
    s.surface.focus_near = 38;
    s.surface.focus_far = 41;
    s.shot.set_count = 2;
    s.shot.lines[0] = NULL;
    s.shot.lines[1] = &lines;
    s.shot.objects[1] = &torus.object.desc;
    draw_both(&s, results[0]);
    free_both(results[0]);
    /* a G-buffer of all sets: the surface in front */
    s.shot.frame_flags = LAO_FRAME_SHARED_OCCLUSION;
    draw_both(&s, results[0]);
    free_both(results[0]);
    render_lines_free(&lines);
    subject_free(&torus);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(per_vertex_and_pixel),
        cmocka_unit_test(composed),
        cmocka_unit_test(effects),
        cmocka_unit_test(layers),
        cmocka_unit_test(nested),
        cmocka_unit_test(no_bleeding),
        cmocka_unit_test(shadow_of_a_step),
        cmocka_unit_test(layers_needed),
        cmocka_unit_test(among_lines),
    };
    render_module(vsf_module());
    return cmocka_run_group_tests(tests, render_open_both, render_close_both);
}
