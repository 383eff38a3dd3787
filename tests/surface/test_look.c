/* Proves that the look-up, the opacities, the compositing order, the focus blur and the depth
   shadow of the shared text give what METHODS 9 and 10 state, and finite results for every input.
 */
#include "surface_host.h"

#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void near_to(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g within %g", a, b, tolerance);
}
static void is_color(lao_v4 c, double x, double y, double z, double w) {
    near_to((double)c.x, x, 1e-6);
    near_to((double)c.y, y, 1e-6);
    near_to((double)c.z, z, 1e-6);
    near_to((double)c.w, w, 1e-6);
}

/* CIELab (D65) to sRGB display values, clipped: the anchors of L14. */
static void lab(double l, double a, double b, double rgb[3]) {
    const double white[3] = {0.95047, 1, 1.08883};
    const double m[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                            {-0.9692660, 1.8760108, 0.0415560},
                            {0.0556434, -0.2040259, 1.0572252}};
    double f[3], xyz[3];
    f[1] = (l + 16) / 116;
    f[0] = f[1] + a / 500;
    f[2] = f[1] - b / 200;
    for (int k = 0; k < 3; k++)
        xyz[k] =
            white[k] * (f[k] > 6.0 / 29 ? f[k] * f[k] * f[k] : 108.0 / 841 * (f[k] - 4.0 / 29));
    for (int k = 0; k < 3; k++) {
        double v = m[k][0] * xyz[0] + m[k][1] * xyz[1] + m[k][2] * xyz[2];
        v = v < 0 ? 0 : v > 1 ? 1 : v;
        rgb[k] = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
    }
}

static void anchors_of_the_lookup(void **state) {
    double orange[3], cyan[3];
    (void)state;
    lab(65, 51, 74, orange);
    lab(65, -51, -74, cyan);
    is_color(vsf_lookup(0, 1), orange[0], orange[1], orange[2], 1);
    is_color(vsf_lookup(0, -1), cyan[0], cyan[1], cyan[2], 1);
    near_to((double)vsf_lookup(0, 1).y, 0.4469, 5e-5);
    near_to((double)vsf_lookup(0, -1).y, 0.7344, 5e-5);
    is_color(vsf_lookup(1, 1), 1, 0, 0, 1);
    is_color(vsf_lookup(1, -1), 0, 1, 0, 1);
    for (int i = 0; i <= 10; i++) {
        float x = (float)i / 10;
        lao_v4 whole = vsf_lookup(x, 1), half = vsf_lookup(x, 0.5f);
        is_color(vsf_lookup(x, 0), 0, 0, 0, 0);
        is_color(half, 0.5 * (double)whole.x, 0.5 * (double)whole.y, 0.5 * (double)whole.z, 0.5);
        assert_true(whole.x == 1 && whole.z == 0); /* hue falls from orange to red */
        near_to((double)whole.y, orange[1] * (1 - (double)x), 1e-6);
    }
}

static void lookup_is_continuous(void **state) {
    (void)state;
    for (int i = 0; i < 512; i++) {
        for (int j = -256; j < 256; j++) {
            float x = (float)i / 512, y = (float)j / 256;
            lao_v4 a = vsf_lookup(x, y), b = vsf_lookup(x + 1.0f / 512, y),
                   c = vsf_lookup(x, y + 1.0f / 256);
            assert_true(a.x <= a.w && a.y <= a.w && a.z <= a.w && a.w <= 1); /* premultiplied */
            assert_true(fabsf(a.x - b.x) < 0.005f && fabsf(a.y - b.y) < 0.005f &&
                        fabsf(a.z - b.z) < 0.008f);
            assert_true(fabsf(a.x - c.x) < 0.005f && fabsf(a.y - c.y) < 0.005f &&
                        fabsf(a.z - c.z) < 0.005f);
        }
    }
}

static void coordinates_of_the_lookup(void **state) {
    (void)state;
    assert_true(vsf_near_x(0, 2) == 1);
    assert_true(vsf_near_x(2, 2) == 0);
    assert_true(vsf_near_x(0.5f, 2) == 0.75f);
    assert_true(vsf_near_x(7, 2) == 0);
    assert_true(vsf_near_x(VSF_FAR, 2) == 0);
    assert_true(vsf_near_x(0, 0) == 0 && vsf_near_x(1, NAN) == 0);
    assert_true(vsf_measure_y(0.5f, 1.5f) == 0.75f);
    assert_true(vsf_measure_y(-9, 1.5f) == -1 && vsf_measure_y(9, 1.5f) == 1);
    assert_true(vsf_near_mix(2, 4, 0.25f) == 2.5f);
    assert_true(vsf_near_mix(2, VSF_FAR, 0) == 2 && vsf_near_mix(VSF_FAR, 3, 1) == 3);
    assert_true(vsf_near_mix(2, VSF_FAR, 0.5f) == VSF_FAR &&
                vsf_near_mix(VSF_FAR, 2, 0.5f) == VSF_FAR);
}

/* A map is met at its colours and is straight between them; what is near hides what is behind it
   however flat the wall is there, what is far does not. */
static void colours_of_a_map(void **state) {
    lao_v2 place;
    (void)state;
    for (int i = 0; i < 256; i++) {
        place = vsf_map_place((float)i / 255, 256);
        near_to((double)(place.x + place.y), i, 1e-4);
        assert_true(place.y >= 0 && place.y <= 254 && place.y == floorf(place.y));
    }
    place = vsf_map_place(7, 256);
    assert_true(place.x == 1 && place.y == 254);
    place = vsf_map_place(-7, 256);
    assert_true(place.x == 0 && place.y == 0);
    place = vsf_map_place(0.5f, 1);
    assert_true(place.x == 0 && place.y == 0);
    const lao_v3 color = lao_v3_make(1, 0.5f, 0.25f);
    is_color(vsf_mapped(color, 0, 0, 1), 0, 0, 0, 0);
    is_color(vsf_mapped(color, 0, -0.5f, 1), 0.5, 0.25, 0.125, 0.5);
    is_color(vsf_mapped(color, 1, 0.5f, 0.8f), 0.8, 0.4, 0.2, 0.8);
    is_color(vsf_mapped(color, 0.5f, 0.9f, 0.8f), 0.9, 0.45, 0.225, 0.9);
}

static void opacities_of_the_baselines(void **state) {
    (void)state;
    assert_true(vsf_fresnel(1, 1.5f) == 0 && vsf_fresnel(-1, 1.5f) == 0);
    assert_true(vsf_fresnel(0, 1.5f) == 1);
    near_to((double)vsf_fresnel(0.25f, 1.5f), 0.875, 1e-6);
    near_to((double)vsf_fresnel(0.5f, 1), 0.5, 1e-6);
    for (int i = 1; i < 20; i++) { /* a larger fall-off occludes more; the other form less */
        float c = (float)i / 20;
        assert_true(vsf_fresnel(c, 2) > vsf_fresnel(c, 1));
        assert_true(vsf_fresnel_rim(c, 2) < vsf_fresnel_rim(c, 1));
        near_to((double)vsf_fresnel(c, 1.5f), 1 - pow((double)c, 1.5), 2e-6);
        near_to((double)vsf_fresnel_rim(c, 1.5f), pow(1 - (double)c, 1.5), 2e-6);
    }
    assert_true(vsf_fresnel_rim(1, 2) == 0 && vsf_fresnel_rim(0, 2) == 1);
    assert_true(vsf_fresnel(1.5f, 2) == 0); /* not quite unit vectors */
    is_color(vsf_premultiply(lao_v3_make(1, 0.5f, 0), 0.5f), 0.5, 0.25, 0, 0.5);
}

static void layers_compose_front_to_back(void **state) {
    const lao_v4 back = vsf_premultiply(lao_v3_make(0.2f, 0.4f, 0.6f), 1);
    const lao_v4 flow = vsf_premultiply(lao_v3_make(0.9f, 0.8f, 0.1f), 0.5f);
    const lao_v4 none = lao_v4_make(0, 0, 0, 0), white = lao_v4_make(1, 1, 1, 1);
    lao_v4 front = vsf_lookup(0, 0.25f), want, got;
    uint32_t seed = 5;
    (void)state;
    is_color(vsf_over(none, back), 0.2, 0.4, 0.6, 1);
    is_color(vsf_over(back, flow), 0.2, 0.4, 0.6, 1);
    is_color(vsf_over(none, white), 1, 1, 1, 1);
    is_color(vsf_over(flow, vsf_over(back, white)), 0.55, 0.6, 0.35, 1);
    want = vsf_over(front, lao_v4_make(0.55f, 0.6f, 0.35f, 1));
    got = vsf_over(front, vsf_over(flow, vsf_over(back, white)));
    is_color(got, (double)want.x, (double)want.y, (double)want.z, 1);
    is_color(vsf_add(front, back), 0.45, 0.4 + 0.25 * 0.446919, 0.6, 1);
    for (int i = 0; i < 1000;
         i++) { /* any number of layers: against straight colours, back to front */
        double r = 0, a = 0;
        lao_v4 sum = none;
        lao_v4 layers[8];
        for (int k = 0; k < 8; k++) {
            float c = (float)lent_between(&seed, 0, 1), o = (float)lent_between(&seed, 0, 1);
            layers[k] = vsf_premultiply(lao_v3_make(c, c, c), o);
            r = (double)c * (double)o + r * (1 - (double)o);
            a = (double)o + a * (1 - (double)o);
        }
        for (int k = 7; k >= 0; k--) /* peeled: front to back */
            sum = vsf_over(sum, layers[k]);
        near_to((double)sum.x, r, 2e-6);
        near_to((double)sum.w, a, 2e-6);
    }
}

/* ---- blur: a row of pixels gathered as the pass does */

typedef struct pixel {
    float color, z;
} pixel;
static float blurred(const pixel *row, int n, int at, float focus_near, float focus_far) {
    float sigma = vsf_blur_sigma(vsf_outside(row[at].z, focus_near, focus_far), 0.2f, 8), sum = 0,
          weights = 0;
    for (int i = 0; i < n; i++) {
        float d = (float)(i - at);
        float s = vsf_blur_sigma(vsf_outside(row[i].z, focus_near, focus_far), 0.2f, 8);
        float w = vsf_blur_weight(d * d, sigma, row[at].z, s, row[i].z);
        sum += w * row[i].color;
        weights += w;
    }
    return sum / weights;
}
static void focus_blur(void **state) {
    pixel row[101];
    float edge;
    (void)state;
    assert_true(vsf_outside(50, 40, 60) == 0 && vsf_outside(40, 40, 60) == 0);
    assert_true(vsf_outside(30, 40, 60) == 10 && vsf_outside(75, 40, 60) == 15);
    assert_true(vsf_blur_sigma(10, 0.2f, 8) == 2);
    assert_true(vsf_blur_sigma(1000, 0.2f, 8) == 8);
    assert_true(vsf_gauss(0, 0) == 1 && vsf_gauss(1, 0) == 0 && vsf_gauss(1e30f, 1) == 0);
    for (int i = 0; i < 60; i++)
        near_to((double)vsf_gauss((float)i, 2), exp(-i / 8.0), 1e-6);
    for (int i = 0; i < 101; i++) { /* a constant picture stays */
        row[i].color = 0.7f;
        row[i].z = (float)(i % 37) * 4;
    }
    for (int i = 0; i < 101; i++)
        near_to((double)blurred(row, 101, i, 40, 60), 0.7, 1e-6);
    for (int i = 0; i < 101; i++) /* in focus nothing changes */
        row[i].color = (float)(i % 2);
    for (int i = 0; i < 101; i++) {
        row[i].z = 50;
        assert_true(blurred(row, 101, i, 40, 60) == (float)(i % 2));
    }
    /* a white wall in focus before a black one far behind: no white outside, all white inside */
    for (int i = 0; i < 101; i++) {
        row[i].color = i < 50 ? 1.0f : 0.0f;
        row[i].z = i < 50 ? 50.0f : 90.0f;
    }
    for (int i = 0; i < 101; i++)
        assert_true(blurred(row, 101, i, 40, 60) == (i < 50 ? 1.0f : 0.0f));
    /* a white wall out of focus before a black one in focus: its edge is soft on its own side */
    for (int i = 0; i < 101; i++)
        row[i].z = i < 50 ? 10.0f : 50.0f;
    edge = blurred(row, 101, 49, 40, 60);
    assert_true(edge > 0.4f && edge < 0.6f);
    assert_true(blurred(row, 101, 50, 40, 60) == 0);
    /* both out of focus at one depth: the plain Gaussian */
    for (int i = 0; i < 101; i++)
        row[i].z = 75;
    for (int i = 45; i < 56; i++) {
        double want = 0, weights = 0;
        for (int j = -9; j <= 9; j++) {
            double w = exp(-j * j / 18.0);
            want += w * (i + j < 50);
            weights += w;
        }
        near_to((double)blurred(row, 101, i, 40, 60), want / weights, 1e-5);
    }
}

static void unsharp_shadow(void **state) {
    /* a step from near (0) to far (1), blurred: -erfc(x / (sigma sqrt 2)) / 2 on the far side */
    const double sigma = 10;
    const lao_v3 c = lao_v3_make(0.9f, 0.5f, 0.1f);
    lao_v3 out;
    (void)state;
    out = vsf_unsharp(c, 0.4f, 0.4f, 2);
    assert_true(out.x == c.x && out.y == c.y && out.z == c.z);
    for (int x = -30; x < 30; x++) {
        double depth = x >= 0, blur = 0, weights = 0, want;
        for (int j = -60; j <= 60; j++) {
            double w = (double)vsf_gauss((float)(j * j), (float)sigma);
            blur += w * (x + j >= 0);
            weights += w;
        }
        blur /= weights;
        want = x >= 0 ? -0.5 * erfc((x + 0.5) / (sigma * sqrt(2.0))) : 0;
        out = vsf_unsharp(c, (float)depth, (float)blur, 1);
        near_to((double)out.x, 0.9 + want, 2e-3);
        near_to((double)out.y, fmax(0.5 + want, 0), 2e-3);
        near_to((double)out.z, fmax(0.1 + want, 0), 2e-3);
    }
}

static void all_is_finite(void **state) {
    static const float odd[] = {0, -0.0f, 1e-38f, -1e-38f, 1, -1, 1e30f, -1e30f, 0.5f, VSF_FAR};
    const int n = (int)(sizeof odd / sizeof *odd);
    (void)state;
    for (int i = 0; i < n * n * n; i++) {
        float a = odd[i % n], b = odd[i / n % n], c = odd[i / n / n];
        lao_v4 eye = lao_v4_make(a, b, c, 1);
        lao_v3 p = lao_v3_make(b, c, a);
        assert_true(isfinite(vsf_near_x(fabsf(a), b)));
        assert_true(isfinite(vsf_near_mix(fabsf(a), fabsf(b), c)));
        assert_true(isfinite(vsf_map_place(a, 2 + fabsf(b)).x));
        assert_true(isfinite(vsf_fresnel(a, fabsf(b) + 0.01f)));
        assert_true(isfinite(vsf_fresnel_rim(a, fabsf(b) + 0.01f)));
        assert_true(isfinite(vsf_blur_weight(fabsf(a), fabsf(b), c, fabsf(b), a)));
        assert_true(isfinite(vsf_ring_end(vsf_ring_add(
            vsf_ring_begin(eye, p, lao_v3_make(0, 0, 1), i % 2), lao_v4_make(a, b, c, 0), b))));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(anchors_of_the_lookup),
        cmocka_unit_test(lookup_is_continuous),
        cmocka_unit_test(coordinates_of_the_lookup),
        cmocka_unit_test(colours_of_a_map),
        cmocka_unit_test(opacities_of_the_baselines),
        cmocka_unit_test(layers_compose_front_to_back),
        cmocka_unit_test(focus_blur),
        cmocka_unit_test(unsharp_shadow),
        cmocka_unit_test(all_is_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
