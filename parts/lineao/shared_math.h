/* ================================================================================================
 * shared_math: vectors, elementary functions, noise, and the uniforms of a frame. From
   LAO_SHARED_BEGIN to LAO_SHARED_END the text is C99, C++11 and GLSL at once: amalgamate.sh puts
   its bytes in front of every shader, so that what the tests prove is what the GPU runs. Only + - *
   /, sqrt, floor, abs, min, max, comparisons and integers; every expression of several operations
   is assigned to an LAO_EXACT local, so that no compiler may contract or reorder it: C, OpenGL and
   Vulkan agree to the bit (docs/algorithm.md, "Bit-equal"). Uses no other section. */
/* LAO_SHARED_BEGIN */
#ifndef LAO_GLSL
#ifndef __cplusplus
#include <stdbool.h>
#endif
#define LAO_FN static inline
#define LAO_EXACT
#define LAO_F(x) ((float)(x))
#define LAO_U(x) ((uint32_t)(x))
#define LAO_I(x) ((int32_t)(x))
typedef uint32_t lao_uint;
typedef int32_t lao_int;
typedef struct lao_v2 {
    float x, y;
} lao_v2;
typedef struct lao_v3 {
    float x, y, z;
} lao_v3;
typedef struct lao_v4 {
    float x, y, z, w;
} lao_v4;
LAO_FN lao_v2 lao_v2_make(float x, float y) {
    lao_v2 v;
    v.x = x;
    v.y = y;
    return v;
}
LAO_FN lao_v3 lao_v3_make(float x, float y, float z) {
    lao_v3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
LAO_FN lao_v4 lao_v4_make(float x, float y, float z, float w) {
    lao_v4 v;
    v.x = x;
    v.y = y;
    v.z = z;
    v.w = w;
    return v;
}
LAO_FN float lao_sqrt(float x) {
    return sqrtf(x);
}
LAO_FN float lao_floor(float x) {
    return floorf(x);
}
LAO_FN float lao_abs(float x) {
    return fabsf(x);
}
LAO_FN float lao_min(float a, float b) {
    return b < a ? b : a;
}
LAO_FN float lao_max(float a, float b) {
    return a < b ? b : a;
}
LAO_FN float lao_bits_float(lao_uint u) {
    union {
        uint32_t u;
        float f;
    } b;
    b.u = u;
    return b.f;
}
LAO_FN lao_uint lao_float_bits(float f) {
    union {
        uint32_t u;
        float f;
    } b;
    b.f = f;
    return b.u;
}
#else
#define LAO_FN
#ifdef LAO_PRECISE
#define LAO_EXACT precise
#else
#define LAO_EXACT
#endif
#define LAO_F(x) float(x)
#define LAO_U(x) uint(x)
#define LAO_I(x) int(x)
#define lao_uint uint
#define lao_int int
#define lao_v2 vec2
#define lao_v3 vec3
#define lao_v4 vec4
#define lao_v2_make vec2
#define lao_v3_make vec3
#define lao_v4_make vec4
#define lao_sqrt sqrt
#define lao_floor floor
#define lao_abs abs
#define lao_min min
#define lao_max max
#define lao_bits_float uintBitsToFloat
#define lao_float_bits floatBitsToUint
#endif

/* A matrix as its four columns. */
struct lao_m4 {
    lao_v4 x, y, z, w;
};
#ifndef LAO_GLSL
typedef struct lao_m4 lao_m4;
#endif

/* Per frame. Rows of four floats only, so that std140 and C lay them out alike. */
struct lao_frame_uniforms {
    lao_m4 view;       /* world to canonical view space */
    lao_m4 projection; /* canonical view space to clip space */
    lao_m4 world;      /* canonical view space to world */
    lao_v4 ray; /* view slope of a pixel centre: x = ray.x * px + ray.z, y = ray.y * py + ray.w */
    lao_v4 viewport; /* supersampled width, height, 1 / width, 1 / height */
    lao_v4 depth; /* z0, 1 / (z1 - z0) of the scene sphere; z1 - z0; 1 for an orthographic camera */
    lao_v4 scale; /* pixels per unit of NDC slope: W/2 * P00, H/2 * P11; 1 for reverse depth; time
                     in ms */
    lao_v4 unproject;     /* canonical window depth d to view depth z: (x + y d) / (z + w d) */
    lao_v4 background;    /* premultiplied */
    lao_v4 target;        /* target width, height; 1: flip rows; 1: decode sRGB */
    lao_v4 host_depth;    /* size of the host's depth image; 1: flip rows; depth differences times w
                             are in depth_unit */
    lao_m4 previous_view; /* of the view's last frame */
    lao_m4 previous_projection;
    lao_v4 history; /* frames for which LAO_IMAGE_HISTORY images have been written; 0: they hold
                       nothing yet */
};
/* Per step of the plan. */
struct lao_step_uniforms {
    lao_v4 size;   /* width, height of what is written; level; iteration */
    lao_v4 source; /* width, height of the first image read; set; number of levels of the first
                      image written */
};
#ifndef LAO_GLSL
typedef struct lao_frame_uniforms lao_frame_uniforms;
typedef struct lao_step_uniforms lao_step_uniforms;
#endif

#define LAO_TURN 6.28318531f
#define LAO_GHOST_TIME 3.0e38f /* w of a point buffer texel that is no point of a line */

/* ---- vectors: explicit order of evaluation */
LAO_FN lao_v3 lao_v3_add(lao_v3 a, lao_v3 b) {
    return lao_v3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}
LAO_FN lao_v3 lao_v3_sub(lao_v3 a, lao_v3 b) {
    return lao_v3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}
LAO_FN lao_v3 lao_v3_scale(lao_v3 a, float s) {
    return lao_v3_make(a.x * s, a.y * s, a.z * s);
}
LAO_FN float lao_v2_dot(lao_v2 a, lao_v2 b) {
    LAO_EXACT float r = a.x * b.x + a.y * b.y;
    return r;
}
LAO_FN float lao_v3_dot(lao_v3 a, lao_v3 b) {
    LAO_EXACT float r = a.x * b.x + a.y * b.y + a.z * b.z;
    return r;
}
LAO_FN lao_v3 lao_v3_cross(lao_v3 a, lao_v3 b) {
    LAO_EXACT float x = a.y * b.z - a.z * b.y;
    LAO_EXACT float y = a.z * b.x - a.x * b.z;
    LAO_EXACT float z = a.x * b.y - a.y * b.x;
    return lao_v3_make(x, y, z);
}
/* a + b s */
LAO_FN lao_v3 lao_v3_along(lao_v3 a, lao_v3 b, float s) {
    LAO_EXACT float x = a.x + b.x * s;
    LAO_EXACT float y = a.y + b.y * s;
    LAO_EXACT float z = a.z + b.z * s;
    return lao_v3_make(x, y, z);
}
/* Unit vector of v, or `otherwise` when v is shorter than 1e-12. */
LAO_FN lao_v3 lao_v3_unit(lao_v3 v, lao_v3 otherwise) {
    LAO_EXACT float length2 = lao_v3_dot(v, v);
    if (!(length2 > 1.0e-24f)) {
        return otherwise;
    }
    LAO_EXACT float inverse = 1.0f / lao_sqrt(length2);
    return lao_v3_scale(v, inverse);
}
LAO_FN lao_v3 lao_transform(lao_m4 m, lao_v3 p) {
    LAO_EXACT float x = m.x.x * p.x + m.y.x * p.y + m.z.x * p.z + m.w.x;
    LAO_EXACT float y = m.x.y * p.x + m.y.y * p.y + m.z.y * p.z + m.w.y;
    LAO_EXACT float z = m.x.z * p.x + m.y.z * p.y + m.z.z * p.z + m.w.z;
    return lao_v3_make(x, y, z);
}
LAO_FN lao_v4 lao_project(lao_m4 m, lao_v3 p) {
    LAO_EXACT float x = m.x.x * p.x + m.y.x * p.y + m.z.x * p.z + m.w.x;
    LAO_EXACT float y = m.x.y * p.x + m.y.y * p.y + m.z.y * p.z + m.w.y;
    LAO_EXACT float z = m.x.z * p.x + m.y.z * p.y + m.z.z * p.z + m.w.z;
    LAO_EXACT float w = m.x.w * p.x + m.y.w * p.y + m.z.w * p.z + m.w.w;
    return lao_v4_make(x, y, z, w);
}

/* ---- elementary functions: minimax polynomials, each tested against double precision */
LAO_FN float lao_clamp01(float x) {
    return lao_min(lao_max(x, 0.0f), 1.0f);
}
/* h(x) = 3 x^2 - 2 x^3 on [0, 1] (Koehler 2017, Eq. 6) */
LAO_FN float lao_hermite(float x) {
    LAO_EXACT float t = lao_clamp01(x);
    LAO_EXACT float r = t * t * (3.0f - 2.0f * t);
    return r;
}
/* cos(2 pi t), t in turns; absolute error below 3e-7 for |t| < 16 */
LAO_FN float lao_cos_turns(float t) {
    LAO_EXACT float a = 0.25f - lao_abs(t - lao_floor(t + 0.5f));
    LAO_EXACT float s = a * a;
    LAO_EXACT float r =
        a * (6.28318528f +
             s * (-41.3416807f + s * (81.6024851f + s * (-76.5813965f + s * 39.7616174f))));
    return r;
}
LAO_FN float lao_sin_turns(float t) {
    return lao_cos_turns(t - 0.25f);
}
/* 2^x for x in [-126, 127], clamped outside; relative error below 3e-7 */
LAO_FN float lao_exp2(float x) {
    LAO_EXACT float c = lao_min(lao_max(x, -126.0f), 127.0f);
    LAO_EXACT float n = lao_floor(c + 0.5f);
    LAO_EXACT float f = c - n;
    LAO_EXACT float p =
        1.0f + f * (0.693147207f +
                    f * (0.240226515f +
                         f * (0.0555032722f +
                              f * (0.00961799451f + f * (0.00134004317f + f * 0.000154780225f)))));
    LAO_EXACT float r = p * lao_bits_float(LAO_U(LAO_I(n) + 127) << 23u);
    return r;
}
/* log2(x) for normal x > 0; absolute error below 3e-7 + 1e-7 |result|. x <= 0: -127 */
LAO_FN float lao_log2(float x) {
    if (!(x >= 1.17549435e-38f)) {
        return -127.0f;
    }
    lao_uint bits = lao_float_bits(x);
    lao_int exponent = LAO_I((bits >> 23u) & 255u) - 127;
    LAO_EXACT float m = lao_bits_float((bits & 8388607u) | 1065353216u);
    if (m > 1.41421356f) {
        m = m * 0.5f;
        exponent = exponent + 1;
    }
    LAO_EXACT float f = m - 1.0f;
    LAO_EXACT float p =
        f *
        (1.442695f +
         f * (-0.721347199f +
              f * (0.48091028f +
                   f * (-0.360716264f +
                        f * (0.287939095f +
                             f * (-0.23867568f +
                                  f * (0.215212249f + f * (-0.208933813f + f * 0.1292643f))))))));
    LAO_EXACT float r = p + LAO_F(exponent);
    return r;
}
/* atan2(y, x) in (-pi, pi]; atan2(0, 0) = 0; absolute error below 5e-7 */
LAO_FN float lao_atan2(float y, float x) {
    LAO_EXACT float ax = lao_abs(x);
    LAO_EXACT float ay = lao_abs(y);
    LAO_EXACT float large = lao_max(ax, ay);
    if (!(large > 0.0f)) {
        return 0.0f;
    }
    LAO_EXACT float t = lao_min(ax, ay) / large;
    LAO_EXACT float s = t * t;
    LAO_EXACT float r =
        t * (0.999999986f +
             s * (-0.33333094f +
                  s * (0.199930542f +
                       s * (-0.142071342f +
                            s * (0.106546796f +
                                 s * (-0.0753368101f +
                                      s * (0.0430394294f +
                                           s * (-0.0162830477f + s * 0.00290356285f))))))));
    if (ay > ax) {
        r = 1.57079633f - r;
    }
    if (x < 0.0f) {
        r = 3.14159265f - r;
    }
    if (y < 0.0f) {
        r = -r;
    }
    return r;
}
/* acos(x), x clamped to [-1, 1]; absolute error below 1e-6 */
LAO_FN float lao_acos(float x) {
    LAO_EXACT float c = lao_min(lao_max(x, -1.0f), 1.0f);
    LAO_EXACT float s = (1.0f - c) * (1.0f + c);
    return lao_atan2(lao_sqrt(s), c);
}
/* The least x whose power n is at least 2^-100. */
LAO_FN float lao_power_least(lao_int n) {
    return lao_exp2(-100.0f / LAO_F(n > 0 ? n : 1));
}
/* x^n, 0 <= n < 1024, by repeated squaring; x: 0, or lao_power_least to 1 */
LAO_FN float lao_squarings(float x, lao_int n) {
    LAO_EXACT float r = 1.0f;
    LAO_EXACT float b = x;
    lao_int m = n;
    for (lao_int i = 0; i < 10; i = i + 1) {
        if ((m & 1) != 0) {
            r = r * b;
        }
        b = b * b;
        m = m >> 1;
    }
    return r;
}
/* x^n, 0 <= x <= 1, 0 <= n < 1024; results below 2^-100 are 0, because denormal numbers on the way
   to them cost a CPU more than all the rest */
LAO_FN float lao_power(float x, lao_int n) {
    return lao_squarings(x < lao_power_least(n) ? 0.0f : x, n);
}

/* ---- noise: counter-based, so that a pixel's value depends on nothing but its coordinates */
LAO_FN lao_uint lao_hash(lao_uint v) {
    lao_uint state = v * 747796405u + 2891336453u;
    lao_uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}
/* [0, 1), 24 bits */
LAO_FN float lao_unit_float(lao_uint v) {
    LAO_EXACT float r = LAO_F(v >> 8u) * 5.96046448e-8f;
    return r;
}
/* Unit vector from two numbers in [0, 1): uniform on the sphere. */
LAO_FN lao_v3 lao_sphere_point(float u, float v) {
    LAO_EXACT float z = 1.0f - 2.0f * u;
    LAO_EXACT float r = lao_sqrt(lao_max(1.0f - z * z, 0.0f));
    LAO_EXACT float x = r * lao_cos_turns(v);
    LAO_EXACT float y = r * lao_sin_turns(v);
    return lao_v3_make(x, y, z);
}
/* The unit vector N of a pixel at which the sample directions are mirrored (METHODS 1.6). */
LAO_FN lao_v3 lao_pixel_noise(lao_uint x, lao_uint y) {
    lao_uint h = lao_hash(x + lao_hash(y));
    return lao_sphere_point(lao_unit_float(h), lao_unit_float(lao_hash(h ^ 2654435769u)));
}
/* Sample direction i of `count` on level `level`: a spherical Fibonacci set, turned per level, from
   both ends in turn, so that neighbours share the products of their z. */
LAO_FN lao_v3 lao_sample_direction(lao_uint level, lao_uint i, lao_uint count) {
    lao_uint j = (i & 1u) == 0u ? i >> 1u : count - 1u - (i >> 1u);
    LAO_EXACT float u = (LAO_F(j) + 0.5f) / LAO_F(count);
    LAO_EXACT float v = lao_unit_float(j * 2654435769u + level * 1640531527u);
    return lao_sphere_point(u, v);
}
/* Samples of a level: max(1, round(samples / (level + 1))) */
LAO_FN lao_uint lao_sample_count(lao_uint samples, lao_uint level) {
    lao_uint n = (2u * samples + level + 1u) / (2u * (level + 1u));
    return n < 1u ? 1u : n;
}
/* LAO_SHARED_END */
