/* A magic lens shows what it should: inside its circle the picture is that of one set alone,
   outside that of the other, to the bit and on both backends, whatever the sets are (a tree, a cut
   one, one in ink with a void, a mesh), and on its rim is the ring; inside a ball the vessels are
   one set's, elsewhere the other's, as rays through the whole tree say. */
#include "render_host.h"
#include "vessel_subject.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 64, HEIGHT = 48 };

typedef struct lens_scene {
    render_shot shot;
    lao_settings lines;
    sdv_settings vessels[2]; /* outside, inside */
    const void *settings[2][1];
} lens_scene;

static void lens_make(lens_scene *s, const sdv_object *outside, const sdv_object *inside) {
    const sdv_object *objects[2] = {outside, inside};
    memset(s, 0, sizeof *s);
    shot_make(&s->shot, &s->lines, WIDTH, HEIGHT);
    s->shot.set_count = 2;
    for (int i = 0; i < 2; i++) {
        s->shot.settings[i] = &s->lines;
        s->shot.objects[i] = &objects[i]->desc;
        s->settings[i][0] = &s->vessels[i];
        s->shot.module_settings[i] = s->settings[i];
    }
    s->shot.sphere[3] = 40; /* the same for one set as for two */
}

/* One of the sets alone. */
static render_shot alone(const lens_scene *s, int set) {
    render_shot shot = s->shot;
    shot.set_count = 1;
    shot.objects[0] = s->shot.objects[set];
    shot.module_settings[0] = s->shot.module_settings[set];
    return shot;
}

static const uint8_t *pixel_of(const render_result *result, uint32_t i) {
    const render_image *image = render_find(result, "shaded", 0);
    assert_true(image && image->format == LAO_FORMAT_RGBA8);
    return image->data + 4 * (size_t)i;
}

/* ---- a circle */

static void set_lens(sdv_settings *v, int side, float rim) {
    v->lens_side = (float)side;
    v->lens_x = 0.45f;
    v->lens_y = 0.6f;
    v->lens_radius = 0.3f;
    v->lens_rim = rim;
    v->set |= SDV_SET(lens_rim); /* 0 is a width too */
}

/* Distance of a pixel's centre from the circle's middle, in radii; from the definition. */
static double radii(uint32_t i) {
    double x = i % WIDTH + 0.5 - 0.45 * WIDTH, y = HEIGHT - (i / WIDTH + 0.5) - 0.6 * HEIGHT;
    return sqrt(x * x + y * y) / (0.3 * HEIGHT);
}

/* `rays`: what is hidden is not traced either. */
static void check_circle(lens_scene *s, float rim, bool rays) {
    render_result plain[2], lens[2];
    uint32_t differ = 0, ring = 0;
    for (int i = 0; i < 2; i++) {
        render_need(&render_devices[i]);
        set_lens(&s->vessels[0], SDV_LENS_NONE, rim);
        set_lens(&s->vessels[1], SDV_LENS_NONE, rim);
        for (int k = 0; k < 2 && i == 0; k++) {
            render_shot shot = alone(s, k);
            render_draw(&render_devices[i], &shot, &plain[k]);
        }
        set_lens(&s->vessels[0], SDV_LENS_OUTSIDE, rim);
        set_lens(&s->vessels[1], SDV_LENS_INSIDE, rim);
        render_draw(&render_devices[i], &s->shot, &lens[i]);
    }
    render_same_image("shaded", &lens[0], &lens[1]);
    render_same_image("zbuffer", &lens[0], &lens[1]);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        bool inside = radii(i) <= 1, rings = inside && radii(i) > 1 - (double)rim / (0.3 * HEIGHT);
        const uint8_t *p = pixel_of(&lens[0], i), *q = pixel_of(&plain[inside], i);
        if (rings) {
            assert_true(p[0] == 51 && p[1] == 51 && p[2] == 51);
            ring++;
            continue;
        }
        if (memcmp(p, q, 4) != 0)
            fail_msg("(%u, %u): %u %u %u, alone %u %u %u", i % WIDTH, i / WIDTH, p[0], p[1], p[2],
                     q[0], q[1], q[2]);
        differ += memcmp(pixel_of(&plain[0], i), pixel_of(&plain[1], i), 4) != 0;
        if (rays && !inside) { /* the images are the last set's */
            lao_v4 hit;
            memcpy(&hit, render_find(&lens[0], "vessel_position", 0)->data + 16 * (size_t)i,
                   sizeof hit);
            assert_true(hit.w == -1);
        }
    }
    assert_in_range(differ, 200, WIDTH * HEIGHT);
    assert_true(rim > 0 ? ring > 20 : ring == 0);
    for (int i = 0; i < 2; i++) {
        render_free(&plain[i]);
        render_free(&lens[i]);
    }
}

static void circle(void **state) {
    subject a, b;
    lens_scene s;
    (void)state;
    subject_make(&a, 60, 1);
    subject_make(&b, 60, 9);
    lens_make(&s, &a.object, &b.object);
    check_circle(&s, 0, true);
    s.vessels[1].near_miss = SDV_NEAR_MISS_EXACT;
    check_circle(&s, 2, true);
    subject_free(&a);
    subject_free(&b);
}

static void circle_of_cut_trees(void **state) {
    sdv_shape ball;
    const sdv_shapes shapes = {&ball, 1, NULL, 0};
    subject a;
    sdv_object cut;
    lens_scene s;
    (void)state;
    memset(&ball, 0, sizeof ball);
    ball.kind = SDV_SHAPE_BALL;
    ball.operation = SDV_UNION;
    ball.a = lao_v4_make(0, 0, 0, 8);
    subject_make(&a, 60, 1);
    assert_int_equal(sdv_object_make(NULL, &a.grid, a.colors, &cut), LAO_OK);
    assert_int_equal(sdv_object_shapes(NULL, &shapes, NULL, &cut), LAO_OK);
    lens_make(&s, &a.object, &cut);
    check_circle(&s, 0, true);
    lens_make(&s, &cut, &a.object);
    check_circle(&s, 0, true);
    sdv_object_free(&cut);
    subject_free(&a);
}

/* The void is filled from the whole picture, so that its ink is what it is without a lens. */
static void circle_in_ink(void **state) {
    subject a;
    lens_scene s;
    (void)state;
    subject_make(&a, 60, 1);
    lens_make(&s, &a.object, &a.object);
    for (int i = 0; i < 2; i++) {
        s.vessels[i].parameterization = 2;
        s.vessels[i].ssp_period = 1.5f;
        s.vessels[i].style = i ? SDV_STYLE_HATCH : SDV_STYLE_STIPPLE;
        s.vessels[i].void_style = i ? SDV_VOID_CHROMADEPTH : SDV_VOID_STIPPLE;
    }
    check_circle(&s, 0, false);
    subject_free(&a);
}

/* A mesh's outline comes from neighbours, which may be hidden. */
static void circle_of_a_mesh(void **state) {
    static const float corners[4][3] = {{9, 9, 9}, {9, -9, -9}, {-9, 9, -9}, {-9, -9, 9}};
    static const uint32_t triangles[12] = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    sdv_mesh_desc desc;
    sdv_object mesh;
    subject a;
    lens_scene s;
    (void)state;
    memset(&desc, 0, sizeof desc);
    desc.vertex_count = 4;
    desc.triangle_count = 4;
    desc.positions = desc.normals = corners[0];
    desc.triangles = triangles;
    subject_make(&a, 60, 1);
    assert_int_equal(sdv_object_mesh(NULL, &desc, &mesh), LAO_OK);
    lens_make(&s, &a.object, &mesh);
    check_circle(&s, 0, false);
    sdv_object_free(&mesh);
    subject_free(&a);
}

/* ---- a ball */

static void ball(void **state) {
    const lao_v4 middle = lao_v4_make(1, 2, -1, 8);
    subject a;
    lens_scene s;
    sdv_shape balls[2];
    sdv_object parts[2];
    render_result results[2];
    uint32_t in = 0, out = 0;
    (void)state;
    subject_make(&a, 60, 1);
    uint8_t *colors = malloc(16 * (size_t)a.grid.cone_count); /* red, then blue */
    assert_non_null(colors);
    memset(balls, 0, sizeof balls);
    for (int i = 0; i < 2; i++) {
        const sdv_shapes shapes = {&balls[i], 1, NULL, 0};
        uint8_t *own = colors + 8 * (size_t)(i ? a.grid.cone_count : 0);
        balls[i].kind = SDV_SHAPE_BALL;
        balls[i].operation = i ? SDV_INTERSECTION : SDV_SUBTRACTION;
        balls[i].a = middle;
        for (uint32_t k = 0; k < 8 * a.grid.cone_count; k++)
            own[k] = k % 4 == (i ? 2 : 0) || k % 4 == 3 ? 255 : 0;
        assert_int_equal(sdv_object_make(NULL, &a.grid, own, &parts[i]), LAO_OK);
        assert_int_equal(sdv_object_shapes(NULL, &shapes, NULL, &parts[i]), LAO_OK);
    }
    lens_make(&s, &parts[0], &parts[1]);
    for (int i = 0; i < 2; i++) { /* colours alone */
        s.vessels[i].near_miss = SDV_NEAR_MISS_NONE;
        s.vessels[i].surface_ambient = 1;
        s.vessels[i].set = SDV_SET(near_miss) | SDV_SET(surface_ambient) |
                           SDV_SET(surface_diffuse) | SDV_SET(surface_specular) |
                           SDV_SET(field_occlusion);
    }
    render_draw_both(&s.shot, results);
    render_same_image("shaded", &results[0], &results[1]);
    render_same_image("zbuffer", &results[0], &results[1]);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        const lao_frame_uniforms *frame = &results[0].frame;
        const uint8_t *p = pixel_of(&results[0], i);
        lao_v2 slope =
            lao_pixel_slope(frame->ray, (float)(i % WIDTH) + 0.5f, (float)(i / WIDTH) + 0.5f);
        sdv_ray ray;
        sdv_hit hit;
        memset(&ray, 0, sizeof ray);
        ray.origin = lao_ray_origin(frame->world, slope, frame->depth.w);
        ray.direction = lao_ray_direction(frame->world, slope, frame->depth.w);
        sdv_trace(&a.grid, &ray, &hit);
        if (hit.cone == SDV_NONE) {
            assert_true(p[0] == 0 && p[2] == 0);
            continue;
        }
        float beyond = sdv_shape_distance(hit.position, balls[0]);
        if (fabsf(beyond) < 2 * sdv_hit_distance(a.grid.cell))
            continue;
        assert_int_equal(p[0], beyond > 0 ? 255 : 0);
        assert_int_equal(p[2], beyond > 0 ? 0 : 255);
        in += beyond < 0;
        out += beyond > 0;
    }
    assert_in_range(in, 50, WIDTH * HEIGHT);
    assert_in_range(out, 50, WIDTH * HEIGHT);
    for (int i = 0; i < 2; i++) {
        render_free(&results[i]);
        sdv_object_free(&parts[i]);
    }
    free(colors);
    subject_free(&a);
}

int main(int count, char **arguments) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circle),        cmocka_unit_test(circle_of_cut_trees),
        cmocka_unit_test(circle_in_ink), cmocka_unit_test(circle_of_a_mesh),
        cmocka_unit_test(ball),
    };
    render_module(sdv_module());
    if (count > 1)
        cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, render_open_both, render_close_both);
}
