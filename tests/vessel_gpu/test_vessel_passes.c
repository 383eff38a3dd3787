/* Vessel trees on both backends: every texel of the traced images is what sdv_trace gives for the
   pixel's ray, to the bit, and the shaded picture is the shared functions'. */
#include "render_host.h"
#include "vessel_subject.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 96, HEIGHT = 72 };

static render_device devices[2];
static const lao_module *modules[1];

/* ---------------------------------------------------------------------------------------------
 * a shot of it */

typedef struct scene {
    render_shot shot;
    lao_settings lines;
    sdv_settings vessel;
    const void *settings[1];
} scene;

static void scene_make(scene *s, const subject *tree) {
    memset(s, 0, sizeof *s);
    s->shot.width = WIDTH;
    s->shot.height = HEIGHT;
    s->shot.set_count = 1;
    s->shot.settings[0] = &s->lines;
    s->shot.objects[0] = &tree->object.desc;
    s->settings[0] = &s->vessel;
    s->shot.module_settings[0] = s->settings;
    s->shot.background[3] = 1;
    s->lines.set = LAO_SET(occlusion);
    s->lines.supersampling = 1;
    s->shot.camera = render_camera(0.3, 0.5, 0.8, 45);
    render_perspective(&s->shot.camera, 40, (double)WIDTH / HEIGHT, 1, 200);
}

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
            ray.flags = s->vessel.near_miss == SDV_NEAR_MISS_CLOSE   ? SDV_TRACE_CLOSE
                        : s->vessel.near_miss == SDV_NEAR_MISS_EXACT ? SDV_TRACE_NEAREST
                                                                     : 0;
            ray.reach = sdv_near_miss_reach(0.5f, 0.25f, 2, result->frame.depth.z);
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

static void same_image(const char *name, const render_result *a, const render_result *b) {
    const render_image *x = render_find(a, name, 0), *y = render_find(b, name, 0);
    assert_true(x && y);
    assert_int_equal(render_compare(name, x, y).texels, 0);
}

/* Draws on both, compares with C and with each other. */
static void check(scene *s, const subject *tree, uint32_t least_hits) {
    render_result results[2];
    for (int i = 0; i < 2; i++) {
        render_need(&devices[i]);
        render_draw(&devices[i], &s->shot, &results[i]);
        assert_in_range(check_trace(s, tree, &results[i]), least_hits, WIDTH * HEIGHT);
    }
    same_image("zbuffer", &results[0], &results[1]);
    same_image("shaded", &results[0], &results[1]);
    same_image("out", &results[0], &results[1]);
    render_free(&results[0]);
    render_free(&results[1]);
}

/* ---------------------------------------------------------------------------------------- tests */

static void perspective(void **state) {
    subject tree;
    scene s;
    (void)state;
    subject_make(&tree, 60, 1);
    scene_make(&s, &tree);
    check(&s, &tree, 300);
    s.vessel.near_miss = SDV_NEAR_MISS_EXACT;
    check(&s, &tree, 300);
    s.vessel.near_miss = SDV_NEAR_MISS_NONE;
    check(&s, &tree, 300);
    subject_free(&tree);
}

static void orthographic(void **state) {
    subject tree;
    scene s;
    (void)state;
    subject_make(&tree, 90, 2);
    scene_make(&s, &tree);
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
    scene_make(&s, &tree);
    s.shot.camera = render_camera(1, 0, 0, 6);
    render_perspective(&s.shot.camera, 60, (double)WIDTH / HEIGHT, 0.01, 100);
    check(&s, &tree, 300);
    s.shot.camera = render_camera(1, 0, 0, 0.2); /* node 0 has its centre here */
    render_perspective(&s.shot.camera, 60, (double)WIDTH / HEIGHT, 0.001, 100);
    check(&s, &tree, WIDTH * HEIGHT);
    subject_free(&tree);
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
    scene_make(&s, &tree);
    render_scatter(&lines, 40, 5, 30, 8, 8);
    for (int order = 0; order < 2; order++) {
        s.shot.set_count = 2;
        s.shot.lines[order] = &lines;
        s.shot.lines[1 - order] = NULL;
        s.shot.objects[order] = NULL;
        s.shot.objects[1 - order] = &tree.object.desc;
        s.shot.settings[0] = s.shot.settings[1] = &s.lines;
        s.shot.module_settings[0] = s.shot.module_settings[1] = s.settings;
        for (int i = 0; i < 2; i++) {
            render_need(&devices[i]);
            render_draw(&devices[i], &s.shot, &results[order][i]);
        }
        same_image("out", &results[order][0], &results[order][1]);
    }
    same_image("zbuffer", &results[0][0], &results[1][0]);
    same_image("out", &results[0][0], &results[1][0]);
    for (int i = 0; i < 4; i++) {
        render_free(&results[i / 2][i % 2]);
    }
    render_lines_free(&lines);
    subject_free(&tree);
}

static int open_all(void **state) {
    (void)state;
    modules[0] = sdv_module();
    render_modules(modules, 1);
    render_open_gl(&devices[0], NULL);
    render_open_vk(&devices[1], 0);
    return 0;
}

static int close_all(void **state) {
    (void)state;
    render_close(&devices[0]);
    render_close(&devices[1]);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(perspective),
        cmocka_unit_test(orthographic),
        cmocka_unit_test(from_within),
        cmocka_unit_test(among_lines),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
