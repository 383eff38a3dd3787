#include "colour.h"

#include <math.h>
#include <string.h>

/* ---- spaces ----------------------------------------------------------------------------- */

static double decode(double v) { /* sRGB to linear light */
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static double encode(double v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

/* Rows of `m` times (x, y, z). */
static colour_lab multiply(const double m[9], double x, double y, double z) {
    return (colour_lab){m[0] * x + m[1] * y + m[2] * z, m[3] * x + m[4] * y + m[5] * z,
                        m[6] * x + m[7] * y + m[8] * z};
}

colour_lab colour_lab_from_rgb(const double rgb[3]) {
    static const double cones[9] = {0.4122214708, 0.5363325363, 0.0514459929,
                                    0.2119034982, 0.6806995451, 0.1073969566,
                                    0.0883024619, 0.2817188376, 0.6299787005};
    static const double opponents[9] = {0.2104542553, 0.7936177850,  -0.0040720468,
                                        1.9779984951, -2.4285922050, 0.4505937099,
                                        0.0259040371, 0.7827717662,  -0.8086757660};
    colour_lab c = multiply(cones, decode(rgb[0]), decode(rgb[1]), decode(rgb[2]));
    return multiply(opponents, cbrt(c.l), cbrt(c.a), cbrt(c.b));
}

void colour_rgb_from_lab(colour_lab lab, double rgb[3]) {
    static const double cones[9] = {1, 0.3963377774,  0.2158037573, 1, -0.1055613458, -0.0638541728,
                                    1, -0.0894841775, -1.2914855480};
    static const double lights[9] = {4.0767416621,  -3.3077115913, 0.2309699292,
                                     -1.2684380046, 2.6097574011,  -0.3413193965,
                                     -0.0041960863, -0.7034186147, 1.7076147010};
    colour_lab c = multiply(cones, lab.l, lab.a, lab.b);
    colour_lab light = multiply(lights, c.l * c.l * c.l, c.a * c.a * c.a, c.b * c.b * c.b);
    rgb[0] = encode(light.l);
    rgb[1] = encode(light.a);
    rgb[2] = encode(light.b);
}

double colour_difference(colour_lab x, colour_lab y) {
    double l = x.l - y.l, a = x.a - y.a, b = x.b - y.b;
    return sqrt(l * l + a * a + b * b);
}

static double cie_root(double t) {
    return t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
}

colour_lab colour_cielab_from_rgb(const double rgb[3]) {
    static const double tristimulus[9] = {0.4123907993, 0.3575843394, 0.1804807884,
                                          0.2126390059, 0.7151686788, 0.0721923154,
                                          0.0193308187, 0.1191947798, 0.9505321522};
    colour_lab white = multiply(tristimulus, 1, 1, 1);
    colour_lab c = multiply(tristimulus, decode(rgb[0]), decode(rgb[1]), decode(rgb[2]));
    double x = cie_root(c.l / white.l), y = cie_root(c.a / white.a), z = cie_root(c.b / white.b);
    return (colour_lab){116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

uint8_t colour_byte(double value) {
    return (uint8_t)(255.0 * (value > 0 ? value < 1 ? value : 1 : 0) + 0.5);
}

/* ---- maps ------------------------------------------------------------------------------- */

enum { ANCHORS = 6, PIECES = 64 /* of the curve between two anchors */ };

/* Either anchors 0xrrggbb, or an arc of hues in degrees at one lightness and chroma. */
typedef struct map_row {
    const char *name;
    double lightness, chroma, hues[2];
    colour_kind kind;
    uint32_t count, anchors[ANCHORS];
} map_row;

/* viridis and inferno go through colours of the maps of that name by van der Walt and Smith; the
 * arcs are as colourful as a display can show at all their hues. */
// clang-format off
static const map_row map_rows[] = {
    {"viridis",     0,    0,    {0, 0},    COLOUR_SEQUENTIAL,  6, {0x440154, 0x414487, 0x2a788e, 0x22a884, 0x7ad151, 0xfde725}},
    {"inferno",     0,    0,    {0, 0},    COLOUR_SEQUENTIAL,  6, {0x0b0724, 0x4a0c6b, 0xa52c60, 0xed6925, 0xf7d13d, 0xfcffa4}},
    {"heat",        0,    0,    {0, 0},    COLOUR_SEQUENTIAL,  6, {0x5a0a0e, 0xa01c0c, 0xd24e08, 0xf08a1c, 0xf8c552, 0xfff6c8}},
    {"coolwarm",    0,    0,    {0, 0},    COLOUR_DIVERGING,   5, {0x3b4cc0, 0x86a4f0, 0xdddddd, 0xf0977a, 0xb40426}},
    {"phase",       0.72, 0.12, {20, 380}, COLOUR_CYCLIC,      0, {0}},
    {"isoluminant", 0.72, 0.12, {270, 0},  COLOUR_ISOLUMINANT, 0, {0}},
    {"gray",        0,    0,    {0, 0},    COLOUR_SEQUENTIAL,  2, {0x202020, 0xe6e6e6}},
};
// clang-format on

static colour_lab anchor(const map_row *row, int i) {
    uint32_t hex = row->anchors[i];
    const double rgb[3] = {(hex >> 16) / 255.0, (hex >> 8 & 255) / 255.0, (hex & 255) / 255.0};
    return colour_lab_from_rgb(rgb);
}

/* Anchor i; beyond the ends of its piece [low, high] the line goes on straight. */
static colour_lab control(const map_row *row, int i, int low, int high) {
    if (i >= low && i <= high)
        return anchor(row, i);
    colour_lab p = anchor(row, i < low ? low : high);
    colour_lab q = anchor(row, i < low ? low + 1 : high - 1);
    return (colour_lab){2 * p.l - q.l, 2 * p.a - q.a, 2 * p.b - q.b};
}

static double cubic(double p, double q, double r, double s, double t) { /* Catmull and Rom */
    return 0.5 *
           (2 * q + t * (r - p + t * (2 * p - 5 * q + 4 * r - s + t * (3 * (q - r) + s - p))));
}

/* The curve at u in [0, 1], where anchors lie at even distances. */
static colour_lab curve(const map_row *row, double u) {
    if (row->count == 0) {
        double turn = (row->hues[0] + u * (row->hues[1] - row->hues[0])) * 3.141592653589793 / 180;
        return (colour_lab){row->lightness, row->chroma * cos(turn), row->chroma * sin(turn)};
    }
    int last = (int)row->count - 1;
    double x = u * last;
    int i = (int)x < last - 1 ? (int)x : last - 1;
    int middle = row->kind == COLOUR_DIVERGING ? last / 2 : 0; /* a diverging map turns there */
    int low = i < middle ? 0 : middle, high = i < middle ? middle : last;
    colour_lab p = control(row, i - 1, low, high), q = anchor(row, i), r = anchor(row, i + 1),
               s = control(row, i + 2, low, high);
    return (colour_lab){cubic(p.l, q.l, r.l, s.l, x - i), cubic(p.a, q.a, r.a, s.a, x - i),
                        cubic(p.b, q.b, r.b, s.b, x - i)};
}

/* Cuts the curve at even lengths: halves of a diverging map each by itself, so that the neutral
 * colour is in the middle. */
static void cut(const map_row *row, double from, double to, colour_lab *out, uint32_t count) {
    enum { FINE = ANCHORS * PIECES * 4 };
    double length[FINE + 1];
    colour_lab before = curve(row, from);
    length[0] = 0;
    for (int i = 1; i <= FINE; i++) {
        colour_lab here = curve(row, from + (to - from) * i / FINE);
        length[i] = length[i - 1] + colour_difference(before, here);
        before = here;
    }
    for (uint32_t k = 0, i = 0; k < count; k++) {
        double want = length[FINE] * k / (count - 1);
        while (i < FINE - 1 && length[i + 1] < want)
            i++;
        double step = length[i + 1] - length[i];
        double u = (i + (step > 0 ? (want - length[i]) / step : 0)) / FINE;
        out[k] = curve(row, from + (to - from) * u);
    }
}

bool colour_map_make(const char *name, colour_map *out) {
    const map_row *row = NULL;
    for (size_t i = 0; i < sizeof map_rows / sizeof *map_rows && !row; i++)
        row = strcmp(map_rows[i].name, name) == 0 ? &map_rows[i] : NULL;
    if (!row)
        return false;
    out->name = row->name;
    out->kind = row->kind;
    if (row->kind == COLOUR_DIVERGING) {
        enum { HALF = COLOUR_STEPS / 2 };
        cut(row, 0, 0.5, out->lab, HALF + 1);
        cut(row, 0.5, 1, out->lab + HALF, HALF + 1);
    } else {
        cut(row, 0, 1, out->lab, COLOUR_STEPS);
    }
    for (int i = 0; i < COLOUR_STEPS; i++) {
        colour_rgb_from_lab(out->lab[i], out->rgb[i]);
        for (int k = 0; k < 3; k++)
            out->rgb[i][k] = fmin(fmax(out->rgb[i][k], 0), 1);
    }
    return true;
}

void colour_map_at(const colour_map *map, double at, double rgb[3]) {
    if (isnan(at)) {
        colour_missing(rgb);
        return;
    }
    double x = (COLOUR_STEPS - 1) * fmin(fmax(at, 0), 1);
    int i = x < COLOUR_STEPS - 2 ? (int)x : COLOUR_STEPS - 2;
    for (int k = 0; k < 3; k++)
        rgb[k] = map->rgb[i][k] + (x - i) * (map->rgb[i + 1][k] - map->rgb[i][k]);
}

double colour_map_find(const colour_map *map, const double rgb[3], double *distance) {
    colour_lab lab = colour_lab_from_rgb(rgb);
    double nearest = INFINITY;
    int found = 0;
    for (int i = 0; i < COLOUR_STEPS; i++) {
        double d = colour_difference(lab, map->lab[i]);
        if (d < nearest) {
            nearest = d;
            found = i;
        }
    }
    if (distance)
        *distance = nearest;
    return found / (COLOUR_STEPS - 1.0);
}

void colour_missing(double rgb[3]) {
    rgb[0] = rgb[1] = rgb[2] = 0.6;
}

/* ---- directions and lines --------------------------------------------------------------- */

void colour_direction(double x, double y, double z, double rgb[3]) {
    const double v[3] = {x, y, z};
    double length = sqrt(x * x + y * y + z * z);
    colour_missing(rgb);
    for (int k = 0; k < 3 && length > 0 && length <= 1e300; k++)
        rgb[k] = 0.16 + 0.78 * fabs(v[k]) / length;
}

void colour_of_line(uint32_t line, double rgb[3]) {
    uint32_t hash = (line + 1) * 2654435769u; /* golden ratio: neighbours differ most */
    double turn = 6.283185307179586 * hash / 4294967296.0, chroma = line >> 1 & 1 ? 0.12 : 0.08;
    colour_rgb_from_lab((colour_lab){0.74, chroma * cos(turn), chroma * sin(turn)}, rgb);
}
