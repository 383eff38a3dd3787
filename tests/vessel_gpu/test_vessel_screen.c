/* What fills the void, the guiding field and the parameterization are the same numbers in C, on
   OpenGL and on Vulkan, to the bit, over several frames too: what does not change keeps its phases,
   what moves takes them along. */
#include "render_host.h"
#include "screen_passes.h"
#include "vessel_subject.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 49, HEIGHT = 35 }; /* odd, so that no level halves evenly */

static void frame_make(scene *s, const subject *tree) {
    scene_make(s, tree ? &tree->object.desc : NULL, WIDTH, HEIGHT);
    s->vessel.parameterization = 2;
    s->vessel.ssp_period = 1.5f;
    /* light of the ink is the surface's alone */
    s->vessel.set = SDV_SET(field_occlusion) | SDV_SET(joint_smoothness);
}

static const lao_v4 *texels_of(const render_result *result, const char *name, uint32_t level) {
    const render_image *image = render_find(result, name, level);
    assert_non_null(image);
    assert_int_equal(image->format, LAO_FORMAT_RGBA32F);
    return (const lao_v4 *)(const void *)image->data;
}

static void same(const render_result *result, const char *name, uint32_t level, const lao_v4 *c,
                 uint32_t count) {
    const lao_v4 *gpu = texels_of(result, name, level);
    for (uint32_t i = 0; i < count; i++) {
        if (memcmp(&gpu[i], &c[i], sizeof c[i]) != 0) {
            fail_msg("%s level %u texel %u: %.9g %.9g %.9g %.9g, in C %.9g %.9g %.9g %.9g", name,
                     level, i, (double)gpu[i].x, (double)gpu[i].y, (double)gpu[i].z,
                     (double)gpu[i].w, (double)c[i].x, (double)c[i].y, (double)c[i].z,
                     (double)c[i].w);
        }
    }
}

static void same_pyramid(const render_result *result, const screen *s, const char *name,
                         const screen_pyramid c) {
    for (uint32_t l = 0; l < s->levels; l++) {
        uint32_t w, h;
        screen_size(s, l, &w, &h);
        same(result, name, l, c[l], w * h);
    }
}

static void screen_of(const scene *s, const subject *tree, screen *c) {
    sdv_settings v = s->vessel;
    float *values = c->values;
    assert_true(screen_make(c, s->shot.width, s->shot.height));
    assert_int_equal(lao_settings_resolve(sdv_module(), &v, values), -1);
    c->threshold = values[SDV_SETTING_ID_guide_threshold];
    c->period = values[SDV_SETTING_ID_ssp_period];
    c->recycle = values[SDV_SETTING_ID_ssp_recycle];
    c->converge = values[SDV_SETTING_ID_ssp_converge];
    c->sweeps = (int)values[SDV_SETTING_ID_ssp_sweeps];
    c->guide = (int)values[SDV_SETTING_ID_guide];
    c->cones = tree ? tree->grid.cones : NULL;
    c->colors = tree ? tree->colors : NULL;
}

/* Beyond void_reach nothing is inked, and (of a first frame) some of the void is. */
static void far_is_white(const screen *c, const lao_v4 *normal) {
    float reach = 0.01f * c->values[SDV_SETTING_ID_void_reach] * c->frame.depth.z;
    uint32_t near_ink = 0;
    if (c->values[SDV_SETTING_ID_void_style] < 1.5f || !c->cones || c->frame.history.x > 0.5f)
        return;
    for (uint32_t i = 0; i < c->width * c->height; i++) {
        if (c->surface[i].w > 0)
            continue;
        assert_true(normal[i].w < reach || c->ink[i].x == 1);
        near_ink += c->ink[i].x < 1;
    }
    assert_true(near_ink > 0 || c->period < 10); /* else strokes too fine to be drawn */
}

/* A frame of a device against C, whose `c` holds the frame before. */
static void check_frame(const scene *s, const render_result *result, screen *c) {
    uint32_t n = c->width * c->height;
    c->frame = result->frame;
    screen_background(c, texels_of(result, "vessel_position", 0),
                      texels_of(result, "vessel_normal", 0));
    same_pyramid(result, c, "vessel_depth", c->depth);
    same_pyramid(result, c, "vessel_filled", c->filled);
    same(result, "vessel_surface", 0, c->surface, n);
    same(result, "vessel_bgnormal", 0, c->bgnormal, n);
    if (s->vessel.parameterization > 1) {
        screen_guide(c);
        same_pyramid(result, c, "vessel_place", c->place);
        same_pyramid(result, c, "vessel_facing", c->facing);
        same_pyramid(result, c, "vessel_tensor", c->tensor);
        same_pyramid(result, c, "vessel_spread", c->spread);
        same_pyramid(result, c, "vessel_along", c->along);
        same_pyramid(result, c, "vessel_across", c->across);
        screen_parameterize(c);
        same_pyramid(result, c, "vessel_recalled", c->recalled);
        if (c->sweeps % 2 == 0) /* else the two images of a level change places */
            same_pyramid(result, c, "vessel_phase", c->phase);
        same(result, "vessel_uv", 0, c->uv, n);
        screen_ink(c, texels_of(result, "vessel_position", 0),
                   texels_of(result, "vessel_normal", 0),
                   c->directions ? NULL : texels_of(result, "vessel_ray", 0));
        same(result, "vessel_ink", 0, c->ink, n);
        far_is_white(c, texels_of(result, "vessel_normal", 0));
    }
    memcpy(c->surface_before, c->surface, n * sizeof(lao_v4));
    memcpy(c->uv_before, c->uv, n * sizeof(lao_v4));
    memcpy(c->ink_before, c->ink, n * sizeof(lao_v4));
}

/* Frames of these cameras on both devices; `last` holds the last one afterwards. */
static void check_in(scene *s, const lao_camera *cameras, uint32_t count, screen *last,
                     lao_view views[2]) {
    for (uint32_t frame = 0; frame < count; frame++) {
        render_result results[2];
        s->shot.camera = cameras[frame];
        for (int i = 0; i < 2; i++) {
            render_need(&render_devices[i]);
            s->shot.view = &views[i];
            render_draw(&render_devices[i], &s->shot, &results[i]);
        }
        render_same_image("shaded", &results[0], &results[1]);
        render_same_image("zbuffer", &results[0], &results[1]);
        render_same_image("vessel_surface", &results[0], &results[1]);
        if (s->vessel.parameterization > 1)
            render_same_image("vessel_uv", &results[0], &results[1]);
        check_frame(s, &results[0], last);
        render_free(&results[0]);
        render_free(&results[1]);
    }
}

static void check(scene *s, const lao_camera *cameras, uint32_t count, screen *last) {
    lao_view views[2] = {{0}, {0}};
    check_in(s, cameras, count, last, views);
}

static void checked(scene *s, const subject *tree, const lao_camera *cameras, uint32_t count) {
    screen c;
    screen_of(s, tree, &c);
    check(s, cameras, count, &c);
    screen_free(&c);
}

/* ---------------------------------------------------------------------------------------- tests */

static void still_frames(void **state) {
    subject tree;
    scene s;
    (void)state;
    subject_make(&tree, 60, 1);
    for (int kind = 0; kind < 5; kind++) {
        frame_make(&s, &tree);
        if (kind == 1) {
            s.vessel.guide = SDV_GUIDE_OWN;
            s.vessel.set |= SDV_SET(guide_threshold); /* 0: every slope is a contour */
            s.vessel.style = SDV_STYLE_STIPPLE;
            s.vessel.void_style = SDV_VOID_HATCH;
        }
        if (kind == 2) {
            render_orthographic(&s.shot.camera, 30, (double)WIDTH / HEIGHT, 1, 200);
            render_reverse(&s.shot.camera);
            s.vessel.ssp_sweeps = 3;
            s.vessel.void_exponent = 2;
            s.vessel.style = SDV_STYLE_LAYERED;
            s.vessel.void_style = SDV_VOID_CHROMADEPTH;
        }
        if (kind == 3) {
            s.vessel.set |= SDV_SET(ssp_sweeps) | SDV_SET(guide_threshold);
            s.vessel.style = SDV_STYLE_CROSSHATCH;
            s.vessel.void_style = SDV_VOID_STIPPLE;
            s.vessel.ssp_period = 16;
        }
        if (kind == 4) {
            s.vessel.parameterization = 1;
            s.vessel.void_style = SDV_VOID_CHROMADEPTH;
        }
        checked(&s, &tree, &s.shot.camera, 1);
    }
    subject_free(&tree);
}

/* An image of nothing: the void is a plane beyond the far end, and nothing is no number. */
static void empty_picture(void **state) {
    subject tree;
    scene s;
    screen c;
    lao_camera away[2];
    (void)state;
    subject_make(&tree, 60, 1);
    frame_make(&s, &tree);
    away[0] = s.shot.camera;
    render_shift(&away[0], 30, 0);
    away[1] = s.shot.camera;
    screen_of(&s, &tree, &c);
    check(&s, away, 1, &c);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        float z = sdv_empty_depth(c.frame.depth);
        assert_true(fabsf(sdv_depth_of(c.frame.view, lao_v3_make(c.surface[i].x, c.surface[i].y,
                                                                 c.surface[i].z)) -
                          z) < 1e-4f * z);
        assert_true(c.uv[i].x == c.uv[i].x && c.uv[i].w == c.uv[i].w);
    }
    screen_free(&c);
    checked(&s, &tree, away, 2); /* and into view */
    subject_free(&tree);
}

/* A camera that moves and rests, and does so with the solution going on. */
static void frames_of(int converge) {
    subject tree;
    scene s;
    screen c;
    lao_camera cameras[4];
    lao_v4 *before = malloc(WIDTH * HEIGHT * sizeof *before);
    uint32_t changed = 0;
    lao_view views[2] = {{0}, {0}};
    assert_non_null(before);
    subject_make(&tree, 60, 1);
    frame_make(&s, &tree);
    for (int i = 0; i < 4; i++) {
        double angle = 0.02 * (i < 2 ? i : 2);
        cameras[i] = render_camera(0.3 + angle, 0.5, 0.8 - angle, 45);
        render_perspective(&cameras[i], 40, (double)WIDTH / HEIGHT, 1, 200);
    }
    s.vessel.ssp_converge = (float)converge;
    s.vessel.ssp_period = 6; /* wider than vessels, whose ink is finer */
    s.vessel.style = SDV_STYLE_LAYERED;
    s.vessel.void_style = SDV_VOID_HATCH;
    screen_of(&s, &tree, &c);
    check_in(&s, cameras, 3, &c, views);
    memcpy(before, c.uv, WIDTH * HEIGHT * sizeof *before);
    check_in(&s, cameras + 3, 1, &c, views);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
        changed += memcmp(&before[i], &c.uv[i], sizeof *before) != 0;
    if (converge)
        assert_true(changed > WIDTH * HEIGHT / 4);
    else
        assert_int_equal(changed, 0);
    screen_free(&c);
    free(before);
    subject_free(&tree);
}
static void frames(void **state) {
    (void)state;
    frames_of(0);
}
static void frames_that_converge(void **state) {
    (void)state;
    frames_of(1);
}

/* ---- what is not a tree */

enum { RINGS = 24, SIDES = 32 };
/* A closed bumpy surface whose own directions run along its rings. */
typedef struct bump {
    float positions[RINGS * SIDES * 3], normals[RINGS * SIDES * 3], directions[RINGS * SIDES * 3];
    uint8_t colors[RINGS * SIDES * 4];
    uint32_t triangles[(RINGS - 1) * SIDES * 6];
    sdv_object object;
} bump;

static void bump_make(bump *b) {
    sdv_mesh_desc desc;
    uint32_t *t = b->triangles;
    memset(&desc, 0, sizeof desc);
    for (uint32_t i = 0; i < RINGS * SIDES; i++) {
        double a = 3.14159265 * (i / SIDES) / (RINGS - 1), c = 6.2831853 * (i % SIDES) / SIDES;
        double n[3] = {sin(a) * cos(c), sin(a) * sin(c), cos(a)};
        double r = 9 + 1.5 * sin(4 * a) * cos(3 * c);
        for (uint32_t k = 0; k < 3; k++) {
            b->positions[3 * i + k] = (float)(r * n[k]);
            b->normals[3 * i + k] = (float)n[k];
        }
        b->directions[3 * i] = (float)(-sin(c) * (i % 2 ? 1 : -1)); /* of no sign */
        b->directions[3 * i + 1] = (float)(cos(c) * (i % 2 ? 1 : -1));
        b->directions[3 * i + 2] = 0;
        for (uint32_t k = 0; k < 4; k++)
            b->colors[4 * i + k] = (uint8_t)(255 - 3 * i % 64);
    }
    for (uint32_t i = 0; i < (RINGS - 1) * SIDES; i++) {
        uint32_t next = i % SIDES == SIDES - 1 ? i + 1 - SIDES : i + 1;
        const uint32_t two[6] = {i, next, i + SIDES, next, next + SIDES, i + SIDES};
        memcpy(t, two, sizeof two);
        t += 6;
    }
    desc.vertex_count = RINGS * SIDES;
    desc.triangle_count = (RINGS - 1) * SIDES * 2;
    desc.positions = b->positions;
    desc.normals = b->normals;
    desc.directions = b->directions;
    desc.colors = b->colors;
    desc.triangles = b->triangles;
    assert_int_equal(sdv_object_mesh(NULL, &desc, &b->object), LAO_OK);
    assert_int_equal(sdv_object_pattern(NULL, b->positions, 20, &b->object), LAO_OK);
}

/* A mesh gives the same numbers everywhere, and what it drew, brought by the host as images, the
   same picture again. */
static void surfaces(void **state) {
    static const char *const names[] = {"vessel_position", "vessel_normal", "vessel_color",
                                        "vessel_direction"};
    bump b;
    scene s;
    sdv_object drawn;
    (void)state;
    bump_make(&b);
    frame_make(&s, NULL);
    s.shot.objects[0] = &b.object.desc;
    s.vessel.guide = SDV_GUIDE_OWN;
    s.vessel.style = SDV_STYLE_PATTERN;
    s.vessel.void_style = SDV_VOID_STIPPLE;
    assert_int_equal(sdv_object_drawn(NULL, b.object.desc.bounds[0], &drawn), LAO_OK);
    assert_int_equal(sdv_object_pattern(NULL, b.positions, 20, &drawn), LAO_OK);
    for (int i = 0; i < 2; i++) {
        render_result mesh, again;
        render_image imports[4];
        uint32_t covered = 0;
        screen c;
        render_need(&render_devices[i]);
        s.shot.objects[0] = &b.object.desc;
        s.shot.import_count = 0;
        render_draw(&render_devices[i], &s.shot, &mesh);
        screen_of(&s, NULL, &c);
        c.pattern = b.object.pattern;
        c.directions = texels_of(&mesh, "vessel_direction", 0);
        check_frame(&s, &mesh, &c);
        for (uint32_t k = 0; k < WIDTH * HEIGHT; k++)
            covered += c.surface[k].w > 0;
        assert_true(covered > WIDTH * HEIGHT / 8 && covered < WIDTH * HEIGHT * 7 / 8);
        for (int k = 0; k < 4; k++)
            imports[k] = *render_find(&mesh, names[k], 0);
        s.shot.objects[0] = &drawn.desc;
        s.shot.imports = imports;
        s.shot.import_count = 4;
        render_draw(&render_devices[i], &s.shot, &again);
        render_same_image("vessel_uv", &mesh, &again);
        render_same_image("vessel_ink", &mesh, &again);
        render_same_image("shaded", &mesh, &again);
        screen_free(&c);
        render_free(&mesh);
        render_free(&again);
    }
    sdv_object_free(&drawn);
    sdv_object_free(&b.object);
}

/* A host that has nothing but its depth buffer: places and normals are what the mesh's were, and
   the rest follows from them as ever. */
static void depth_alone(void **state) {
    enum { N = WIDTH * HEIGHT };
    static lao_v4 position[N], normal[N];
    bump b;
    scene s;
    sdv_object drawn;
    (void)state;
    bump_make(&b);
    assert_int_equal(sdv_object_drawn(NULL, b.object.desc.bounds[0], &drawn), LAO_OK);
    for (int reverse = 0; reverse < 2; reverse++) {
        render_result results[2];
        frame_make(&s, NULL);
        s.vessel.style = SDV_STYLE_HATCH;
        s.vessel.void_style = SDV_VOID_STIPPLE;
        if (reverse)
            render_reverse(&s.shot.camera);
        for (int i = 0; i < 2; i++) {
            render_result mesh;
            render_image depth;
            uint32_t covered = 0, alike = 0;
            screen c;
            render_need(&render_devices[i]);
            s.shot.objects[0] = &b.object.desc;
            s.shot.import_count = 0;
            render_draw(&render_devices[i], &s.shot, &mesh);
            depth = *render_find(&mesh, "vessel_z", 0);
            assert_int_equal(depth.format, LAO_FORMAT_D32F);
            depth.name = "vessel_drawn_depth";
            s.shot.objects[0] = &drawn.desc;
            s.shot.imports = &depth;
            s.shot.import_count = 1;
            render_draw(&render_devices[i], &s.shot, &results[i]);
            screen_of(&s, NULL, &c);
            c.frame = results[i].frame;
            c.directions = position; /* not a tree */
            screen_drawn(&c, (const float *)(const void *)depth.data, position, normal);
            same(&results[i], "vessel_position", 0, position, N);
            same(&results[i], "vessel_normal", 0, normal, N);
            check_frame(&s, &results[i], &c);
            for (uint32_t k = 0; k < N; k++) {
                lao_v4 p = texels_of(&mesh, "vessel_position", 0)[k];
                lao_v4 n = texels_of(&mesh, "vessel_normal", 0)[k];
                assert_true((p.w < 0) == (position[k].w < 0));
                if (p.w < 0)
                    continue;
                lao_v3 apart =
                    lao_v3_make(p.x - position[k].x, p.y - position[k].y, p.z - position[k].z);
                assert_true(lao_v3_dot(apart, apart) < 1e-6f);
                covered++;
                alike += n.x * normal[k].x + n.y * normal[k].y + n.z * normal[k].z >
                         0.7f; /* its own are a ball's */
            }
            assert_true(covered > N / 8 && alike > covered * 3 / 4);
            screen_free(&c);
            render_free(&mesh);
        }
        render_same_image("shaded", &results[0], &results[1]);
        render_same_image("zbuffer", &results[0], &results[1]);
        render_free(&results[0]);
        render_free(&results[1]);
    }
    sdv_object_free(&drawn);
    sdv_object_free(&b.object);
}

/* Two trees in a view: the images are the last one's, and it recalls nothing of the other's. */
static void two_trees(void **state) {
    subject a, b;
    scene s;
    screen c;
    lao_camera cameras[2];
    (void)state;
    subject_make(&a, 60, 1);
    subject_make(&b, 60, 9);
    frame_make(&s, &a);
    s.shot.set_count = 2;
    s.shot.objects[1] = &b.object.desc;
    s.shot.settings[1] = &s.lines;
    s.shot.module_settings[1] = s.settings;
    s.vessel.void_style = SDV_VOID_HATCH;
    cameras[0] = cameras[1] = s.shot.camera;
    screen_of(&s, &b, &c);
    c.set = 1;
    check(&s, cameras, 2, &c);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        assert_true(fabsf(c.surface[i].w) == 1.5f * 4096);
        assert_true(c.surface[i].w < 0 || c.recalled[0][i].w == 1);
    }
    screen_free(&c);
    subject_free(&a);
    subject_free(&b);
}

/* Compiling a view's shaders is what takes time; without an argument one scene shows the most. The
   second names one test. */
int main(int count, char **arguments) {
    const struct CMUnitTest first[] = {cmocka_unit_test(frames)};
    const struct CMUnitTest others[] = {
        cmocka_unit_test(still_frames),
        cmocka_unit_test(empty_picture),
        cmocka_unit_test(frames_that_converge),
        cmocka_unit_test(two_trees),
        cmocka_unit_test(surfaces),
        cmocka_unit_test(depth_alone),
    };
    render_module(sdv_module());
    if (count > 2)
        cmocka_set_test_filter(arguments[2]);
    return count > 1 ? cmocka_run_group_tests(others, render_open_both, render_close_both)
                     : cmocka_run_group_tests(first, render_open_both, render_close_both);
}
