/* Vessel trees on both backends: every texel of the traced images is what sdv_trace gives for the
   pixel's ray (sdv_trace_shapes where it is combined with shapes), to the bit, and the shaded
   picture is the shared functions', cut or not: light, shadow, openness, outlines and colours, also
   of the vessel that is nearest to a shape. */
#include "render_host.h"
#include "vessel_subject.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 96, HEIGHT = 72 };

/* ---------------------------------------------------------------------------------------------
 * a shot of it */

static lao_v4 texel_of(const render_image *image, uint32_t x, uint32_t y) {
    lao_v4 v;
    assert_int_equal(image->format, LAO_FORMAT_RGBA32F);
    memcpy(&v, image->data + 16 * ((size_t)y * image->width + x), sizeof v);
    return v;
}

static void ray_of(const lao_frame_uniforms *frame, uint32_t x, uint32_t y, sdv_ray *ray) {
    lao_v2 slope = lao_pixel_slope(frame->ray, (float)x + 0.5f, (float)y + 0.5f);
    memset(ray, 0, sizeof *ray);
    ray->origin = lao_ray_origin(frame->world, slope, frame->depth.w);
    ray->direction = lao_ray_direction(frame->world, slope, frame->depth.w);
}

/* What the default outlines and depth shadows need. */
static float reach_of(const lao_frame_uniforms *frame) {
    float zoom = sdv_zoom(frame->scale, frame->depth, frame->depth.x + frame->depth.z, 1);
    return sdv_near_miss_reach(sdv_outline_width(1.25f, 0, zoom), sdv_outline_width(0.8f, 0, zoom),
                               1.5f, 0, 0, frame->depth.z);
}

/* The traced images against C; returns how many pixels hit. */
static uint32_t check_trace(const scene *s, const subject *tree, const render_result *result) {
    const render_image *position = render_find(result, "vessel_position", 0);
    const render_image *normal = render_find(result, "vessel_normal", 0);
    const render_image *ray_image = render_find(result, "vessel_ray", 0);
    uint32_t hits = 0, wrong = 0;
    assert_true(position && normal && ray_image);
    for (uint32_t y = 0; y < HEIGHT; y++) {
        for (uint32_t x = 0; x < WIDTH; x++) {
            lao_v4 p = texel_of(position, x, y), n = texel_of(normal, x, y),
                   r = texel_of(ray_image, x, y), q, m, t;
            sdv_ray ray;
            sdv_hit hit;
            ray_of(&result->frame, x, y, &ray);
            ray.flags = s->vessel.near_miss == SDV_NEAR_MISS_NONE ? 0 : SDV_TRACE_NEAREST;
            ray.reach =
                s->vessel.near_miss == SDV_NEAR_MISS_CLOSE ? reach_of(&result->frame) : 0.0f;
            sdv_trace(&tree->grid, &ray, &hit);
            q = lao_v4_make(hit.position.x, hit.position.y, hit.position.z,
                            hit.cone == SDV_NONE ? -1.0f : (float)hit.cone);
            m = lao_v4_make(hit.normal.x, hit.normal.y, hit.normal.z, hit.d_min);
            t = lao_v4_make(hit.t, hit.t_min, (float)hit.steps, hit.inside ? 1.0f : 0.0f);
            hits += hit.cone != SDV_NONE;
            if (memcmp(&p, &q, sizeof p) != 0 || memcmp(&n, &m, sizeof n) != 0 ||
                memcmp(&r, &t, sizeof r) != 0) {
                if (wrong++ == 0) {
                    print_error("(%u, %u): %g %g %g %g, %g %g %g %g, %g %g %g %g\n"
                                "in C:     %g %g %g %g, %g %g %g %g, %g %g %g %g\n",
                                x, y, (double)p.x, (double)p.y, (double)p.z, (double)p.w,
                                (double)n.x, (double)n.y, (double)n.z, (double)n.w, (double)r.x,
                                (double)r.y, (double)r.z, (double)r.w, (double)q.x, (double)q.y,
                                (double)q.z, (double)q.w, (double)m.x, (double)m.y, (double)m.z,
                                (double)m.w, (double)t.x, (double)t.y, (double)t.z, (double)t.w);
                }
            }
        }
    }
    assert_int_equal(wrong, 0);
    return hits;
}

/* ---------------------------------------------------------------------------------------------
 * vessel_shade in C, from the traced images */

/* Round half to even of v * 255: what the store of a normalised byte does. */
static uint8_t unorm8(float v) {
    float scaled = v * 255.0f, low = floorf(scaled), part = scaled - low;
    uint32_t whole = (uint32_t)low;
    return (uint8_t)(part > 0.5f || (part == 0.5f && (whole & 1)) ? whole + 1 : whole);
}

static lao_v3 color_of(const uint8_t *bytes) {
    return lao_v3_make((float)bytes[0] / 255.0f, (float)bytes[1] / 255.0f,
                       (float)bytes[2] / 255.0f);
}

/* What the tree is combined with, and what its surfaces are coloured with; NULL: nothing. */
typedef struct solid {
    const sdv_shapes *shapes;
    const float *colors;
} solid;

/* The colour of the vessel there, of the shape, or of the vessel that is nearest to it. */
static lao_v3 color_at(const subject *tree, const solid *of, lao_v4 hit, lao_v4 r) {
    lao_v3 p = lao_v3_make(hit.x, hit.y, hit.z);
    uint32_t cone = (uint32_t)hit.w;
    if (hit.w < 0) {
        const float *own = of->colors + 3 * (size_t)(0.5f * r.w);
        if (own[0] >= 0)
            return lao_v3_make(own[0], own[1], own[2]);
        sdv_cones_distance(tree->grid.cones, tree->grid.cone_count, p, &cone); /* by brute force */
    }
    const lao_v4 *ends = tree->grid.cones + 2 * (size_t)cone;
    const uint8_t *colors = tree->colors + 8 * (size_t)cone;
    return sdv_cone_color(p, ends[0], ends[1], color_of(colors), color_of(colors + 4));
}

/* What the pixel shows; false: nothing is drawn. */
static bool shade_of(const subject *tree, const solid *of, const float *v,
                     const lao_frame_uniforms *frame, const sdv_ray *ray, lao_v4 hit, lao_v4 n,
                     lao_v4 r, lao_v3 *out) {
    lao_v3 normal = lao_v3_make(n.x, n.y, n.z), p = lao_v3_make(hit.x, hit.y, hit.z);
    lao_v3 miss = lao_transform(frame->view, lao_v3_along(ray->origin, ray->direction, r.y));
    float zoom = sdv_zoom(frame->scale, frame->depth, -miss.z, 1);
    float diameter = frame->depth.z, light = 1;
    const sdv_shapes *shapes = of ? of->shapes : NULL;
    bool inside = of ? (uint32_t)r.w % 2 == 1 : r.w > 0.5f;
    bool missed = hit.w == -1.0f, near = v[SDV_SETTING_ID_near_miss] != SDV_NEAR_MISS_NONE;
    float width = v[missed ? SDV_SETTING_ID_silhouette : SDV_SETTING_ID_contour];
    *out = lao_v3_make(0, 0, 0);
    if (near && n.w < sdv_outline_width(width, v[SDV_SETTING_ID_outline_unit], zoom))
        return true;
    if (missed)
        return false;
    if (hit.w >= 0)
        normal = sdv_smooth_normal(&tree->grid, p, (uint32_t)hit.w, normal,
                                   v[SDV_SETTING_ID_joint_smoothness]);
    if (v[SDV_SETTING_ID_field_occlusion] > 0)
        light = sdv_dimmed(light,
                           1.0f - sdv_openness(&tree->grid, shapes, p, normal,
                                               0.01f * v[SDV_SETTING_ID_occlusion_reach] * diameter,
                                               inside),
                           v[SDV_SETTING_ID_occlusion_strength]);
    if (v[SDV_SETTING_ID_field_shadow] > 0) {
        lao_v3 lamp = sdv_shadow_light(frame->world, v[SDV_SETTING_ID_shadow_light_x],
                                       v[SDV_SETTING_ID_shadow_light_y]);
        float lit =
            sdv_shadow(&tree->grid, shapes, p, lamp, 1.0f / v[SDV_SETTING_ID_field_shadow_softness],
                       sdv_shadow_bias(tree->grid.cell));
        light = sdv_dimmed(light, 1.0f - lit, v[SDV_SETTING_ID_field_shadow_strength]);
    }
    if (near)
        light = sdv_dimmed(light,
                           sdv_depth_shadow(n.w, r.y, r.x, v[SDV_SETTING_ID_shadow_ratio],
                                            0.01f * v[SDV_SETTING_ID_shadow_width] * diameter,
                                            v[SDV_SETTING_ID_shadow_softness]),
                           v[SDV_SETTING_ID_shadow_strength]);
    lao_v2 parts = sdv_light_parts(v[SDV_SETTING_ID_surface_ambient],
                                   v[SDV_SETTING_ID_surface_diffuse], inside);
    *out = sdv_shade(color_at(tree, of, hit, r), normal, lao_v3_scale(ray->direction, -1.0f),
                     parts.x, parts.y, v[SDV_SETTING_ID_surface_specular],
                     (lao_int)v[SDV_SETTING_ID_surface_shininess], light);
    return true;
}

static void check_shade(const scene *s, const subject *tree, const solid *of,
                        const render_result *result) {
    const render_image *position = render_find(result, "vessel_position", 0);
    const render_image *normal = render_find(result, "vessel_normal", 0);
    const render_image *ray_image = render_find(result, "vessel_ray", 0);
    const render_image *shaded = render_find(result, "shaded", 0);
    float values[SDV_SETTING_COUNT];
    uint32_t wrong = 0, all = 0;
    assert_true(shaded && shaded->format == LAO_FORMAT_RGBA8);
    lao_settings_resolve(sdv_module(), &s->vessel, values);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        uint32_t x = i % WIDTH, y = i / WIDTH;
        sdv_ray ray;
        lao_v3 c;
        ray_of(&result->frame, x, y, &ray);
        bool drawn = shade_of(tree, of, values, &result->frame, &ray, texel_of(position, x, y),
                              texel_of(normal, x, y), texel_of(ray_image, x, y), &c);
        const uint8_t bytes[4] = {unorm8(c.x), unorm8(c.y), unorm8(c.z), 255};
        all += drawn;
        wrong += drawn && memcmp(bytes, shaded->data + 4 * (size_t)i, 4) != 0;
    }
    assert_int_equal(wrong, 0);
    assert_in_range(all, 300, WIDTH * HEIGHT);
}

/* Draws on both, compares with C and with each other. */
static void check(scene *s, const subject *tree, uint32_t least_hits) {
    render_result results[2];
    for (int i = 0; i < 2; i++) {
        render_need(&render_devices[i]);
        render_draw(&render_devices[i], &s->shot, &results[i]);
        assert_in_range(check_trace(s, tree, &results[i]), least_hits, WIDTH * HEIGHT);
        check_shade(s, tree, NULL, &results[i]);
    }
    render_same_image("zbuffer", &results[0], &results[1]);
    render_same_image("shaded", &results[0], &results[1]);
    render_same_image("out", &results[0], &results[1]);
    render_free(&results[0]);
    render_free(&results[1]);
}

/* ---------------------------------------------------------------------------------------- tests */

static void perspective(void **state) {
    subject tree;
    scene s;
    (void)state;
    subject_make(&tree, 60, 1);
    scene_make(&s, &tree.object.desc, WIDTH, HEIGHT);
    check(&s, &tree, 300);
    s.vessel.near_miss = SDV_NEAR_MISS_EXACT;
    check(&s, &tree, 300);
    s.vessel.near_miss = SDV_NEAR_MISS_NONE;
    check(&s, &tree, 300);
    s.vessel.field_shadow = 1;
    s.vessel.joint_smoothness = 0;
    s.vessel.set |= SDV_SET(joint_smoothness);
    check(&s, &tree, 300);
    subject_free(&tree);
}

static void orthographic(void **state) {
    subject tree;
    scene s;
    (void)state;
    subject_make(&tree, 90, 2);
    scene_make(&s, &tree.object.desc, WIDTH, HEIGHT);
    render_orthographic(&s.shot.camera, 30, (double)WIDTH / HEIGHT, 1, 200);
    render_reverse(&s.shot.camera);
    check(&s, &tree, 300);
    subject_free(&tree);
}

/* The eye in the box of the grid, and inside a vessel. */
static void from_within(void **state) {
    subject tree;
    scene s;
    (void)state;
    subject_make(&tree, 60, 3);
    scene_make(&s, &tree.object.desc, WIDTH, HEIGHT);
    s.shot.camera = render_camera(1, 0, 0, 6);
    render_perspective(&s.shot.camera, 60, (double)WIDTH / HEIGHT, 0.01, 100);
    check(&s, &tree, 300);
    s.shot.camera = render_camera(1, 0, 0, 0.2); /* node 0 has its centre here */
    render_perspective(&s.shot.camera, 60, (double)WIDTH / HEIGHT, 0.001, 100);
    check(&s, &tree, WIDTH * HEIGHT);
    subject_free(&tree);
}

/* Elliptic cross sections and noise, from without, from within and in the box. */
static void forms(void **state) {
    subject tree;
    scene s;
    (void)state;
    subject_make(&tree, 60, 1);
    subject_form(&tree, 7);
    scene_make(&s, &tree.object.desc, WIDTH, HEIGHT);
    s.vessel.field_shadow = 1;
    check(&s, &tree, 300);
    s.vessel.near_miss = SDV_NEAR_MISS_EXACT;
    check(&s, &tree, 300);
    s.vessel.near_miss = SDV_NEAR_MISS_NONE;
    s.shot.camera = render_camera(1, 0, 0, 0.2);
    render_perspective(&s.shot.camera, 60, (double)WIDTH / HEIGHT, 0.001, 100);
    check(&s, &tree, WIDTH * HEIGHT);
    subject_free(&tree);
}

/* The tree combined with a shape of every kind, field included, by all operations. */
enum { SAMPLES = 5, SHAPES = 6 };
typedef struct carving {
    sdv_shape list[SHAPES];
    float samples[SAMPLES * SAMPLES * SAMPLES];
    sdv_shapes shapes;
} carving;

static void carving_make(carving *c, uint32_t count) {
    const sdv_shape list[SHAPES] = {
        {{2, 1, 0, 6}, {0, 0, 0, 0}, SDV_SHAPE_BALL, SDV_SUBTRACTION},
        {{0, 0, 0, 0}, {12, 9, 14, 0}, SDV_SHAPE_BOX, SDV_INTERSECTION},
        {{-8, -8, -8, 4}, {SAMPLES, SAMPLES, SAMPLES, 0}, SDV_SHAPE_FIELD, SDV_UNION},
        {{0.6f, 0, 0.8f, 3}, {0, 0, 0, 0}, SDV_SHAPE_PLANE, SDV_INTERSECTION},
        {{0, 0, 0, 0}, {0, 0, 0, 0}, SDV_SHAPE_TREE, SDV_UNION},
        {{4, 2, 1, 0}, {5, 3, 4, 0}, SDV_SHAPE_ELLIPSOID, SDV_UNION},
    };
    memset(c, 0, sizeof *c);
    memcpy(c->list, list, sizeof list);
    for (uint32_t i = 0; i < SAMPLES * SAMPLES * SAMPLES; i++) { /* of a ball of 5 mm */
        float x = 4.0f * (float)(i % SAMPLES) - 8, y = 4.0f * (float)(i / SAMPLES % SAMPLES) - 8,
              z = 4.0f * (float)(i / (SAMPLES * SAMPLES)) - 8;
        c->samples[i] = sqrtf(x * x + y * y + z * z) - 5;
    }
    c->shapes.shapes = c->list;
    c->shapes.count = count;
    c->shapes.fields = c->samples;
    c->shapes.field_count = SAMPLES * SAMPLES * SAMPLES;
}

static uint32_t check_carved(const scene *s, const subject *tree, const carving *c,
                             const render_result *result, uint32_t *cut) {
    const render_image *position = render_find(result, "vessel_position", 0);
    const render_image *normal = render_find(result, "vessel_normal", 0);
    const render_image *ray_image = render_find(result, "vessel_ray", 0);
    uint32_t hits = 0, wrong = 0;
    assert_true(position && normal && ray_image);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        uint32_t x = i % WIDTH, y = i / WIDTH, shape = 0;
        lao_v4 p = texel_of(position, x, y), n = texel_of(normal, x, y),
               r = texel_of(ray_image, x, y), q, m, t;
        sdv_ray ray;
        sdv_hit hit;
        ray_of(&result->frame, x, y, &ray);
        ray.flags = s->vessel.near_miss == SDV_NEAR_MISS_NONE ? 0 : SDV_TRACE_NEAREST;
        ray.reach = s->vessel.near_miss == SDV_NEAR_MISS_CLOSE ? reach_of(&result->frame) : 0.0f;
        sdv_trace_shapes(&tree->grid, &c->shapes, &ray, &hit, &shape);
        bool is_cut = hit.cone == SDV_CUT_CONE;
        q = lao_v4_make(hit.position.x, hit.position.y, hit.position.z,
                        hit.cone == SDV_NONE ? -1.0f
                        : is_cut             ? -2.0f
                                             : (float)hit.cone);
        m = lao_v4_make(hit.normal.x, hit.normal.y, hit.normal.z, hit.d_min);
        t = lao_v4_make(hit.t, hit.t_min, (float)hit.steps,
                        (is_cut ? 2.0f * (float)shape : 0.0f) + (hit.inside ? 1.0f : 0.0f));
        hits += hit.cone != SDV_NONE;
        *cut += is_cut;
        wrong += memcmp(&p, &q, sizeof p) != 0 || memcmp(&n, &m, sizeof n) != 0 ||
                 memcmp(&r, &t, sizeof r) != 0;
    }
    assert_int_equal(wrong, 0);
    return hits;
}

static void with_shapes(void **state) {
    subject tree;
    scene s;
    carving c;
    (void)state;
    subject_make(&tree, 60, 1);
    for (uint32_t count = 1; count <= SHAPES; count++) {
        render_result results[2];
        if (count == SHAPES) /* the last time with forms */
            subject_form(&tree, 7);
        scene_make(&s, &tree.object.desc, WIDTH, HEIGHT);
        carving_make(&c, count);
        s.vessel.near_miss = (float)(count % 3);
        const float colors[3 * SHAPES] = {-1, 0, 0, 0.9f, 0.5f, 0.1f, -1, 0, 0,
                                          0,  1, 0, 0,    0,    0,    -1, 0, 0};
        assert_int_equal(sdv_object_shapes(NULL, &c.shapes, colors, &tree.object), LAO_OK);
        const solid seen = {&c.shapes, colors};
        s.vessel.field_shadow = count > 2 ? 1.0f : 0.0f;
        for (int i = 0; i < 2; i++) {
            uint32_t cut = 0;
            render_need(&render_devices[i]);
            render_draw(&render_devices[i], &s.shot, &results[i]);
            assert_in_range(check_carved(&s, &tree, &c, &results[i], &cut), 200, WIDTH * HEIGHT);
            assert_in_range(cut, 10, WIDTH * HEIGHT);
            check_shade(&s, &tree, &seen, &results[i]);
        }
        render_same_image("zbuffer", &results[0], &results[1]);
        render_same_image("out", &results[0], &results[1]);
        render_free(&results[0]);
        render_free(&results[1]);
    }
    c.list[2].b.w = 1; /* one sample too many */
    assert_int_equal(sdv_object_shapes(NULL, &c.shapes, NULL, &tree.object),
                     LAO_ERROR_INVALID_ARGUMENT);
    subject_free(&tree);
}

/* The 2D layout of a tree is a tree in a plane: drawn into a view of its own, by both backends
 * alike and as C says; what is under a node of the layout is an edge at it. */
static void layouts(void **state) {
    subject tree, flat;
    sdv_reduced reduced;
    sdv_layout layout;
    scene s;
    (void)state;
    for (uint32_t radial = 0; radial < 2; radial++) {
        const sdv_drawing_desc desc = {48, 36, radial, 0.8f};
        const sdv_grid_desc cells = {96, NULL, 0, {0, 0, 0}};
        subject_make(&tree, 90, 4);
        memset(&flat, 0, sizeof flat);
        assert_int_equal(sdv_reduce(NULL, &tree.tree, &reduced), LAO_OK);
        assert_int_equal(sdv_layout_make(NULL, &tree.tree, &reduced, NULL, &layout), LAO_OK);
        assert_int_equal(sdv_layout_tree(NULL, &tree.tree, &reduced, &layout, &desc, &flat.tree),
                         LAO_OK);
        assert_int_equal(sdv_grid_build(NULL, &flat.tree, &cells, &flat.grid), LAO_OK);
        flat.colors = calloc(flat.grid.cone_count, 8);
        assert_non_null(flat.colors);
        for (uint32_t i = 0; i < 2 * flat.grid.cone_count;
             i++) { /* a node's colour is its number */
            flat.colors[4 * i] = (uint8_t)(flat.grid.cone_nodes[i] + 60);
            flat.colors[4 * i + 3] = 255;
        }
        assert_int_equal(sdv_object_make(NULL, &flat.grid, flat.colors, &flat.object), LAO_OK);
        scene_make(&s, &flat.object.desc, WIDTH, HEIGHT);
        memset(&s.shot.camera, 0, sizeof s.shot.camera);
        for (int k = 0; k < 16; k += 5)
            s.shot.camera.view[k] = 1;
        s.shot.camera.view[12] = -24; /* above the middle of the page */
        s.shot.camera.view[13] = -18;
        s.shot.camera.view[14] = -20;
        render_orthographic(&s.shot.camera, 36, (double)WIDTH / HEIGHT, 1, 40);
        check(&s, &flat, 200);
        subject_free(&flat);
        sdv_layout_free(&layout);
        sdv_reduced_free(&reduced);
        subject_free(&tree);
    }
}

/* Lines and a tree hide each other by depth, in either order of the sets. */
static void among_lines(void **state) {
    subject tree;
    scene s;
    render_lines lines;
    render_result results[2][2];
    (void)state;
    memset(&lines, 0, sizeof lines);
    subject_make(&tree, 60, 1);
    scene_make(&s, &tree.object.desc, WIDTH, HEIGHT);
    render_scatter(&lines, 40, 5, 30, 8, 8);
    for (int order = 0; order < 2; order++) {
        s.shot.set_count = 2;
        s.shot.lines[order] = &lines;
        s.shot.lines[1 - order] = NULL;
        s.shot.objects[order] = NULL;
        s.shot.objects[1 - order] = &tree.object.desc;
        s.shot.settings[0] = s.shot.settings[1] = &s.lines;
        s.shot.module_settings[0] = s.shot.module_settings[1] = s.settings;
        render_draw_both(&s.shot, results[order]);
        render_same_image("out", &results[order][0], &results[order][1]);
    }
    render_same_image("zbuffer", &results[0][0], &results[1][0]);
    render_same_image("out", &results[0][0], &results[1][0]);
    for (int i = 0; i < 4; i++) {
        render_free(&results[i / 2][i % 2]);
    }
    render_lines_free(&lines);
    subject_free(&tree);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(perspective), cmocka_unit_test(orthographic),
        cmocka_unit_test(from_within), cmocka_unit_test(with_shapes),
        cmocka_unit_test(layouts),     cmocka_unit_test(among_lines),
        cmocka_unit_test(forms),
    };
    render_module(sdv_module());
    return cmocka_run_group_tests(tests, render_open_both, render_close_both);
}
