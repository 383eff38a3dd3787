/* Proves what ambient occlusion must do whatever its formulas are: it stays when the scene moves
 * along the view, turns with the camera, grows with density and strength, does not depend on the
 * resolution, is 0 where nothing is in front, keeps to [0, 1] and multiplies its factors. */
#include "render_host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static render_device *const gl = &render_devices[RENDER_GL];
static render_lines tangle;

enum { SIZE = 96 };

/* What a test looks at: occlusion, mask and the shaded picture's red. */
typedef struct picture {
    uint32_t size;
    float *ao, *mask, *red;
} picture;

static void picture_free(picture *p) {
    free(p->ao);
    free(p->mask);
    free(p->red);
}

/* One sample per pixel, 20 directions: the loop is compiled faster than the unrolled samples. */
static lao_settings plain(int align) {
    lao_settings s;
    memset(&s, 0, sizeof s);
    s.width = 1.5f;
    s.supersampling = 1;
    s.samples = 20;
    s.align = (float)align;
    s.set = LAO_SET(align) | LAO_SET(supersampling);
    return s;
}

static lao_camera orthographic(double distance) {
    lao_camera camera = render_camera(0, 0, 1, distance);
    render_orthographic(&camera, 48, 1, 1, 2000);
    return camera;
}

static picture shoot_at(const render_lines *lines, const lao_settings *settings, lao_camera camera,
                        uint32_t size) {
    render_shot shot;
    render_result result;
    picture p;
    memset(&shot, 0, sizeof shot);
    shot.width = shot.height = size;
    shot.camera = camera;
    shot.lines[0] = lines;
    shot.settings[0] = settings;
    shot.set_count = 1;
    render_draw(gl, &shot, &result);
    p.size = size;
    p.ao = render_floats(render_find(&result, "ao", 0), 0);
    p.mask = render_floats(render_find(&result, "color", 0), 3);
    p.red = render_floats(render_find(&result, "shaded", 0), 0);
    render_free(&result);
    for (uint32_t i = 0; i < size * size; i++) {
        assert_true(p.ao[i] >= 0 && p.ao[i] <= 1); /* never NaN */
        assert_true(p.mask[i] != 0 || p.ao[i] == 0);
    }
    return p;
}

static picture shoot(const render_lines *lines, const lao_settings *settings) {
    return shoot_at(lines, settings, orthographic(100), SIZE);
}

/* Over the covered pixels. */
static double mean(const picture *p) {
    double sum = 0, count = 0;
    for (uint32_t i = 0; i < p->size * p->size; i++) {
        sum += (double)p->ao[i];
        count += p->mask[i] != 0;
    }
    return sum / fmax(count, 1);
}

static double mean_difference(const picture *a, const picture *b) {
    double sum = 0, count = 0;
    for (uint32_t i = 0; i < a->size * a->size; i++) {
        if (a->mask[i] != 0 && b->mask[i] != 0) {
            sum += fabs((double)a->ao[i] - (double)b->ao[i]);
            count++;
        }
    }
    return sum / fmax(count, 1);
}

static float largest(const picture *p) {
    float m = 0;
    for (uint32_t i = 0; i < p->size * p->size; i++)
        m = fmaxf(m, p->ao[i]);
    return m;
}

/* Mean over blocks of k x k: the noise of single pixels goes. */
static picture coarser(const picture *p, uint32_t k) {
    picture out = {p->size / k, NULL, NULL, NULL};
    out.ao = calloc((size_t)out.size * out.size, sizeof *out.ao);
    out.mask = calloc((size_t)out.size * out.size, sizeof *out.mask);
    assert_true(out.ao != NULL && out.mask != NULL);
    for (uint32_t i = 0; i < out.size * out.size; i++) {
        float sum = 0, count = 0;
        for (uint32_t j = 0; j < k * k; j++) {
            size_t at = (size_t)(i / out.size * k + j / k) * p->size + i % out.size * k + j % k;
            sum += p->ao[at];
            count += p->mask[at];
        }
        out.mask[i] = count > 0.5f * (float)(k * k) ? 1.0f : 0.0f;
        out.ao[i] = count > 0 ? sum / count : 0;
    }
    return out;
}

/* ------------------------------------------------------------------------------------- motions */

static void test_along_the_view(void **state) {
    render_lines moved = {0};
    lao_settings settings = plain(LAO_ALIGN_ROTATION);
    picture a, b;
    double difference;
    (void)state;
    render_need(gl);
    for (uint32_t line = 0; line < tangle.line_count; line++) {
        for (uint32_t i = tangle.offsets[line]; i < tangle.offsets[line + 1]; i++) {
            const float *p = tangle.points + 3 * (size_t)i;
            render_point(&moved, (double)p[0], (double)p[1], (double)p[2] + 37.25);
        }
        render_line(&moved);
    }
    a = shoot(&tangle, &settings);
    b = shoot(&moved, &settings);
    difference = mean_difference(&a, &b);
    print_message("moved along the view: %g of %g\n", difference, mean(&a));
    assert_true(mean(&a) > 0.02);
    assert_true(difference < 1e-4);
    picture_free(&a);
    picture_free(&b);
    render_lines_free(&moved);
}

static void test_backing_off(void **state) {
    lao_settings settings = plain(LAO_ALIGN_ROTATION);
    picture a, b;
    double first = 0;
    (void)state;
    render_need(gl);
    a = shoot(&tangle, &settings);
    b = shoot_at(&tangle, &settings, orthographic(900), SIZE);
    assert_true(mean_difference(&a, &b) < 1e-4);
    picture_free(&a);
    picture_free(&b);
    /* perspective, with the field of view that keeps the picture's size */
    for (int i = 0; i < 4; i++) {
        double distance = 60 * pow(3, i);
        lao_camera camera = render_camera(0, 0, 1, distance);
        render_perspective(&camera, 360 / 3.14159265358979 * atan(24 / distance), 1, distance - 35,
                           distance + 35);
        a = shoot_at(&tangle, &settings, camera, SIZE);
        first = i == 0 ? mean(&a) : first;
        print_message("at %g mm: %g\n", distance, mean(&a));
        assert_true(fabs(mean(&a) - first) < 0.2 * first);
        picture_free(&a);
    }
}

static lao_camera rolled(void) {
    lao_camera camera = orthographic(100);
    memset(camera.view, 0, 8 * sizeof *camera.view);
    camera.view[1] = 1;  /* x to y */
    camera.view[4] = -1; /* y to -x */
    return camera;
}

/* Turns the picture as the rolled camera does. */
static void turn(picture *p) {
    float *images[3];
    images[0] = p->ao;
    images[1] = p->mask;
    images[2] = p->red;
    for (int k = 0; k < 3; k++) {
        float *copy = malloc((size_t)p->size * p->size * sizeof *copy);
        assert_non_null(copy);
        memcpy(copy, images[k], (size_t)p->size * p->size * sizeof *copy);
        for (uint32_t y = 0; y < p->size; y++) {
            for (uint32_t x = 0; x < p->size; x++)
                images[k][x * p->size + p->size - 1 - y] = copy[y * p->size + x];
        }
        free(copy);
    }
}

static void test_roll(void **state) {
    static const int aligns[] = {LAO_ALIGN_ROTATION, LAO_ALIGN_NONE, LAO_ALIGN_PAPER};
    double differences[3];
    (void)state;
    render_need(gl);
    for (int i = 0; i < 3; i++) {
        lao_settings settings = plain(aligns[i]);
        picture a = shoot(&tangle, &settings);
        picture b = shoot_at(&tangle, &settings, rolled(), SIZE), c, d;
        uint32_t same = 0;
        turn(&a);
        for (uint32_t k = 0; k < SIZE * SIZE; k++)
            same += a.mask[k] == b.mask[k];
        assert_true(same > SIZE * SIZE * 99 / 100); /* the same picture, turned */
        c = coarser(&a, 8);
        d = coarser(&b, 8);
        differences[i] = mean_difference(&c, &d);
        print_message("roll, align %d: %g of %g\n", aligns[i], differences[i], mean(&a));
        picture_free(&a);
        picture_free(&b);
        picture_free(&c);
        picture_free(&d);
    }
    assert_true(differences[0] < 0.01);
    assert_true(differences[1] < 0.01);
    assert_true(differences[2] > 2 * differences[0]); /* as printed it depends on the roll */
}

/* The paper's alpha and the axial vector of the rolled picture, where both have one. */
static void test_roll_of_directions(void **state) {
    (void)state;
    render_need(gl);
    for (int align = LAO_ALIGN_ROTATION; align <= LAO_ALIGN_PAPER; align++) {
        lao_settings settings = plain(align);
        render_shot shot;
        render_result a, b;
        uint32_t compared = 0, wrong = 0;
        const render_image *axial_a, *axial_b, *color_a, *color_b;
        memset(&shot, 0, sizeof shot);
        shot.width = shot.height = SIZE;
        shot.camera = orthographic(100);
        shot.lines[0] = &tangle;
        shot.settings[0] = &settings;
        shot.set_count = 1;
        render_draw(gl, &shot, &a);
        shot.camera = rolled();
        render_draw(gl, &shot, &b);
        axial_a = render_find(&a, "level", 0);
        axial_b = render_find(&b, "level", 0);
        color_a = render_find(&a, "color", 0);
        color_b = render_find(&b, "color", 0);
        for (uint32_t y = 0; y < SIZE; y++) {
            for (uint32_t x = 0; x < SIZE; x++) {
                size_t i = (size_t)y * SIZE + x, k = (size_t)x * SIZE + SIZE - 1 - y;
                uint32_t p, q;
                lao_v2 u, v;
                if (color_a->data[4 * i + 3] == 0 ||
                    memcmp(color_a->data + 4 * i, color_b->data + 4 * k, 4) != 0)
                    continue;
                memcpy(&p, axial_a->data + 4 * i, sizeof p);
                memcpy(&q, axial_b->data + 4 * k, sizeof q);
                u = lao_level_direction(p, align);
                v = lao_level_direction(q, align);
                compared++;
                if (align == LAO_ALIGN_PAPER)
                    wrong += fabsf(u.x * u.x + v.x * v.x - 1) > 2e-3f;
                else
                    wrong += fabsf(u.x + v.x) > 5e-3f || fabsf(u.y + v.y) > 5e-3f;
            }
        }
        assert_true(compared > 500);
        assert_true(wrong * 200 <= compared);
        render_free(&a);
        render_free(&b);
    }
}

/* ------------------------------------------------------------------------------------- bounds */

static void test_alignment_only_takes_away(void **state) {
    lao_settings settings = plain(LAO_ALIGN_NONE);
    picture classic;
    (void)state;
    render_need(gl);
    classic = shoot(&tangle, &settings);
    for (int align = LAO_ALIGN_ROTATION; align <= LAO_ALIGN_PAPER; align++) {
        picture p;
        settings = plain(align);
        p = shoot(&tangle, &settings);
        for (uint32_t i = 0; i < SIZE * SIZE; i++)
            assert_true(p.ao[i] <= classic.ao[i]);
        assert_true(mean(&p) < 0.95 * mean(&classic));
        picture_free(&p);
        settings.align_floor = 1; /* the classic form is the anisotropic one with A0 = 1 */
        p = shoot(&tangle, &settings);
        assert_true(mean_difference(&p, &classic) < 1e-7);
        picture_free(&p);
    }
    picture_free(&classic);
}

static void test_monotone(void **state) {
    static const float densities[] = {0.05f, 0.3f, 1, 2}, strengths[] = {0, 0.5f, 1, 3, 5};
    lao_settings settings = plain(LAO_ALIGN_ROTATION);
    picture last, p;
    (void)state;
    render_need(gl);
    for (int i = 0; i < 4; i++) {
        settings.density = densities[i];
        p = shoot(&tangle, &settings);
        for (uint32_t k = 0; i > 0 && k < SIZE * SIZE; k++)
            assert_true(p.ao[k] >= last.ao[k] - 1e-6f);
        if (i > 0) {
            assert_true(mean(&p) > mean(&last));
            picture_free(&last);
        }
        last = p;
    }
    picture_free(&last);
    settings = plain(LAO_ALIGN_ROTATION);
    settings.set |= LAO_SET(strength);
    for (int i = 0; i < 5; i++) {
        double change = 0;
        settings.strength = strengths[i];
        p = shoot(&tangle, &settings);
        for (uint32_t k = 0; i > 0 && k < SIZE * SIZE; k++) {
            assert_true(p.red[k] <= last.red[k]);
            assert_true(p.ao[k] == last.ao[k]);
            change += (double)(last.red[k] - p.red[k]);
        }
        if (i > 0) {
            assert_true(change > 1);
            picture_free(&last);
        }
        last = p;
    }
    picture_free(&last);
}

static void test_resolution(void **state) {
    lao_settings settings = plain(LAO_ALIGN_ROTATION);
    picture a, b, c;
    double difference;
    (void)state;
    render_need(gl);
    a = shoot(&tangle, &settings);
    b = shoot_at(&tangle, &settings, orthographic(100), 2 * SIZE);
    c = coarser(&b, 2);
    difference = mean_difference(&a, &c);
    print_message("twice the resolution: %g, means %g and %g\n", difference, mean(&a), mean(&b));
    assert_true(difference < 0.05);
    assert_true(fabs(mean(&a) - mean(&b)) < 0.1 * mean(&a));
    picture_free(&a);
    picture_free(&b);
    picture_free(&c);
}

/* --------------------------------------------------------------------------------- flat scenes */

static void sheet(render_lines *lines, double x0, double x1, double y0, double y1, double z,
                  int along_y) {
    for (double at = along_y ? x0 : y0; at <= (along_y ? x1 : y1); at += 1.3) {
        render_point(lines, along_y ? at : x0, along_y ? y0 : at, z);
        render_point(lines, along_y ? at : x1, along_y ? y1 : at, z);
        render_line(lines);
    }
}

static void test_nothing_in_front(void **state) {
    (void)state;
    render_need(gl);
    for (int align = LAO_ALIGN_ROTATION; align <= LAO_ALIGN_NONE; align++) {
        lao_settings settings = plain(align);
        render_lines lines = {0};
        picture p;
        sheet(&lines, -18, 18, -18, 18, 2, 0); /* a sheet */
        sheet(&lines, -18, 18, -18, 18, 2, 1); /* across, in the same plane */
        p = shoot(&lines, &settings);
        assert_true(largest(&p) == 0);
        picture_free(&p);
        render_lines_free(&lines);
        render_point(&lines, -15, 3, 0); /* one line */
        render_point(&lines, 15, -7, 0);
        render_line(&lines);
        p = shoot(&lines, &settings);
        assert_true(largest(&p) == 0);
        picture_free(&p);
        render_lines_free(&lines);
        p = shoot(&lines, &settings); /* none */
        assert_true(largest(&p) == 0);
        picture_free(&p);
    }
}

/* A coarse texel is the mean of the covered texels of the finest level below it, no matter how few,
 * and far and invalid where there are none. */
static void test_levels_mask(void **state) {
    lao_settings settings = plain(LAO_ALIGN_ROTATION);
    render_shot shot;
    render_result result;
    const render_image *color, *depth;
    uint32_t partly = 0;
    (void)state;
    render_need(gl);
    memset(&shot, 0, sizeof shot);
    shot.width = shot.height = SIZE - 1; /* the last texels hang over */
    shot.camera = orthographic(100);
    shot.lines[0] = &tangle;
    shot.settings[0] = &settings;
    shot.set_count = 1;
    render_draw(gl, &shot, &result);
    color = render_find(&result, "color", 0);
    depth = render_find(&result, "depth", 0);
    for (uint32_t level = 0; level < 3; level++) {
        const render_image *coarse = render_find(&result, "level", level);
        uint32_t side = 1u << level;
        for (uint32_t i = 0; i < coarse->width * coarse->height; i++) {
            uint32_t x0 = i % coarse->width * side, y0 = i / coarse->width * side, count = 0;
            uint32_t word;
            double sum = 0, stored;
            memcpy(&word, coarse->data + 4 * (size_t)i, sizeof word);
            stored = (double)lao_level_depth(word);
            for (uint32_t y = y0; y < y0 + side && y < depth->height; y++) {
                for (uint32_t x = x0; x < x0 + side && x < depth->width; x++) {
                    size_t at = (size_t)y * depth->width + x;
                    float d;
                    memcpy(&d, depth->data + 4 * at, sizeof d);
                    if (color->data[4 * at + 3] != 0) {
                        sum += (double)d;
                        count++;
                    }
                }
            }
            assert_int_equal((word & LAO_LEVEL_NEAREST) != 0, count > 0);
            assert_true(fabs(stored - (count > 0 ? sum / count : 1)) < 1e-6);
            partly += count > 0 && count < side * side;
        }
    }
    assert_true(partly > 100);
    render_free(&result);
}

/* A sheet behind another is dark beside it up to its own edge: the far background that the coarse
 * levels' texels there contain does not count. */
static void test_silhouettes(void **state) {
    lao_settings settings = plain(LAO_ALIGN_ROTATION);
    render_lines lines = {0};
    picture p;
    double edge = 0, middle = 0;
    (void)state;
    render_need(gl);
    sheet(&lines, -20, 20, -10, 10, -3, 0);
    sheet(&lines, -8, 0, -23, 23, 3, 1);
    p = shoot(&lines, &settings);
    for (uint32_t y = 0; y < SIZE; y++) { /* 2 px per mm; within 2 mm of the front sheet */
        for (uint32_t x = SIZE / 2 + 2; x < SIZE / 2 + 6; x++) {
            double off = fabs(y + 0.5 - 0.5 * SIZE) / 2;
            double value = (double)p.ao[y * SIZE + x];
            edge += off > 8 && off < 10.5 ? value / (4 * 10.0) : 0;
            middle += off < 2.5 ? value / (4 * 10.0) : 0;
        }
    }
    print_message("silhouette %g, middle %g\n", edge, middle);
    assert_true(middle > 0.05);
    assert_true(edge > 0.6 * middle && edge < 1.4 * middle);
    picture_free(&p);
    render_lines_free(&lines);
}

/* ------------------------------------------------------------------------------------- formulas */

/* Eq. 1 as printed sums the levels; the mean times as many levels is that sum. */
static void test_printed_sum(void **state) {
    lao_settings settings = plain(LAO_ALIGN_PAPER);
    render_shot shot;
    render_result result;
    float *ao, *base, *red;
    (void)state;
    render_need(gl);
    settings.strength = 3; /* levels */
    settings.ambient = 1;
    settings.set |= LAO_SET(diffuse) | LAO_SET(specular);
    memset(&shot, 0, sizeof shot);
    shot.width = shot.height = SIZE;
    shot.camera = orthographic(100);
    shot.lines[0] = &tangle;
    shot.settings[0] = &settings;
    shot.set_count = 1;
    render_draw(gl, &shot, &result);
    ao = render_floats(render_find(&result, "ao", 0), 0);
    base = render_floats(render_find(&result, "color", 0), 0);
    red = render_floats(render_find(&result, "shaded", 0), 0);
    for (int i = 0; i < SIZE * SIZE; i++) {
        double wanted = (double)base[i] * fmax(1 - 3 * (double)ao[i], 0);
        assert_true(fabs((double)red[i] - wanted) < 0.51 / 255);
    }
    free(ao);
    free(base);
    free(red);
    render_free(&result);
}

/* With one sample the occlusion is one product (Eq. 12), whose factors `show` singles out. */
static void test_factors_multiply(void **state) {
    static const int shows[] = {LAO_SHOW_PICTURE, LAO_SHOW_VISIBILITY, LAO_SHOW_DEPTH,
                                LAO_SHOW_LIGHT, LAO_SHOW_ALIGNMENT};
    picture p[5];
    uint32_t occluded = 0, partly = 0;
    (void)state;
    render_need(gl);
    for (int i = 0; i < 5; i++) {
        lao_settings settings = plain(LAO_ALIGN_ROTATION);
        settings.samples = settings.levels = 1;
        settings.show = (float)shows[i];
        p[i] = shoot(&tangle, &settings);
    }
    for (uint32_t k = 0; k < SIZE * SIZE; k++) {
        float product = p[1].ao[k] * p[2].ao[k] * p[3].ao[k] * p[4].ao[k];
        assert_true(fabsf(p[0].ao[k] - product) <= 1e-6f);
        assert_true(p[1].ao[k] == 0 || p[1].ao[k] == 1);
        occluded += p[1].ao[k] == 1;
        partly += p[0].ao[k] > 0 && p[0].ao[k] < 0.9f;
    }
    assert_true(occluded > 100 && partly > 50);
    for (int i = 0; i < 5; i++)
        picture_free(&p[i]);
}

static int setup(void **state) {
    render_scatter(&tangle, 140, 7, 22, 18, 14);
    return render_open_opengl(state);
}

static int teardown(void **state) {
    render_lines_free(&tangle);
    return render_close_both(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_along_the_view),
        cmocka_unit_test(test_backing_off),
        cmocka_unit_test(test_roll),
        cmocka_unit_test(test_roll_of_directions),
        cmocka_unit_test(test_alignment_only_takes_away),
        cmocka_unit_test(test_monotone),
        cmocka_unit_test(test_resolution),
        cmocka_unit_test(test_nothing_in_front),
        cmocka_unit_test(test_levels_mask),
        cmocka_unit_test(test_silhouettes),
        cmocka_unit_test(test_printed_sum),
        cmocka_unit_test(test_factors_multiply),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
