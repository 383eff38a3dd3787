/* Bytes, text, numbers and typed views: the only code that looks at raw file content. */
#include "io_internal.h"

#include <math.h>
#include <string.h>

/* ---- Text ------------------------------------------------------------------------------------ */

static char lower(char c) {
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

io_text io_text_of(const char *string) {
    io_text text = {string, strlen(string)};
    return text;
}

bool io_text_starts(io_text text, const char *word) {
    size_t size = strlen(word);
    if (text.size < size)
        return false;
    for (size_t i = 0; i < size; i++)
        if (lower(text.at[i]) != lower(word[i]))
            return false;
    return true;
}

bool io_text_is(io_text text, const char *word) {
    return text.size == strlen(word) && io_text_starts(text, word);
}

io_text io_text_trim(io_text text) {
    while (text.size && (is_blank(text.at[0]) || !text.at[0])) {
        text.at++;
        text.size--;
    }
    while (text.size && (is_blank(text.at[text.size - 1]) || !text.at[text.size - 1]))
        text.size--;
    return text;
}

/* ---- Cursor ---------------------------------------------------------------------------------- */

const uint8_t *io_take(io_cursor *cursor, size_t count) {
    if (count > cursor->size - cursor->at)
        return NULL;
    cursor->at += count;
    return cursor->bytes + cursor->at - count;
}

bool io_take_line(io_cursor *cursor, io_text *line) {
    size_t left = cursor->size - cursor->at;
    if (!left)
        return false;
    const uint8_t *begin = cursor->bytes + cursor->at;
    const uint8_t *end = memchr(begin, '\n', left);
    line->at = (const char *)begin;
    line->size = end ? (size_t)(end - begin) : left;
    cursor->at += line->size + (end ? 1 : 0);
    if (line->size && line->at[line->size - 1] == '\r')
        line->size--;
    return true;
}

bool io_take_word(io_cursor *cursor, io_text *word) {
    const char *text = (const char *)cursor->bytes;
    size_t at = cursor->at;
    while (at < cursor->size && is_blank(text[at]))
        at++;
    size_t begin = at;
    while (at < cursor->size && !is_blank(text[at]))
        at++;
    if (at == begin)
        return false;
    word->at = text + begin;
    word->size = at - begin;
    cursor->at = at;
    return true;
}

size_t io_line_number(const io_cursor *cursor, size_t at) {
    size_t line = 1;
    for (size_t i = 0; i < at && i < cursor->size; i++)
        line += cursor->bytes[i] == '\n';
    return line;
}

/* ---- Numbers --------------------------------------------------------------------------------- */

/* mantissa * 10^exponent; exact where double arithmetic is, else within one unit in the last place.
 */
static double scaled(uint64_t mantissa, long exponent) {
    static const double exact[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (mantissa < (UINT64_C(1) << 53) && exponent >= -22 && exponent <= 22)
        return exponent < 0 ? (double)mantissa / exact[-exponent]
                            : (double)mantissa * exact[exponent];
    long double value = (long double)mantissa;
    long double power = 10;
    bool negative = exponent < 0;
    unsigned long steps = (unsigned long)(negative ? -exponent : exponent);
    for (steps = steps < 400 ? steps : 400; steps; steps >>= 1, power *= power)
        if (steps & 1)
            value = negative ? value / power : value * power;
    return (double)value;
}

static bool parse_special(io_text text, double *value) {
    static const char *const nans[] = {"nan(", "1.#qnan", "1.#snan", "1.#ind"};
    bool known = io_text_is(text, "nan");
    for (size_t i = 0; i < sizeof nans / sizeof nans[0]; i++)
        known = known || io_text_starts(text, nans[i]);
    if (known) {
        *value = NAN;
        return true;
    }
    *value = INFINITY;
    return io_text_is(text, "inf") || io_text_is(text, "infinity") ||
           io_text_starts(text, "1.#inf");
}

static bool is_digit(io_text text, size_t i) {
    return i < text.size && text.at[i] >= '0' && text.at[i] <= '9';
}

/* The part behind the mantissa: nothing, or e+12 (Fortran writes d). */
static bool parse_exponent(io_text text, size_t i, long *exponent) {
    *exponent = 0;
    if (i == text.size)
        return true;
    if (lower(text.at[i]) != 'e' && lower(text.at[i]) != 'd')
        return false;
    i++;
    bool negative = i < text.size && text.at[i] == '-';
    if (i < text.size && (text.at[i] == '-' || text.at[i] == '+'))
        i++;
    if (!is_digit(text, i))
        return false;
    for (; is_digit(text, i); i++)
        if (*exponent < 100000)
            *exponent = *exponent * 10 + (text.at[i] - '0');
    if (negative)
        *exponent = -*exponent;
    return i == text.size;
}

bool io_parse_real(io_text text, double *value) {
    bool negative = text.size && text.at[0] == '-';
    if (text.size && (text.at[0] == '-' || text.at[0] == '+')) {
        text.at++;
        text.size--;
    }
    uint64_t mantissa = 0;
    long shift = 0, exponent = 0;
    size_t i = 0, digits = 0;
    for (bool fraction = false; i < text.size; i++) {
        if (text.at[i] == '.' && !fraction) {
            fraction = true;
            continue;
        }
        if (!is_digit(text, i))
            break;
        digits++;
        if (mantissa < UINT64_MAX / 10 - 1)
            mantissa = mantissa * 10 + (uint64_t)(text.at[i] - '0');
        else
            shift += shift < 100000; /* more digits than any double has */
        if (fraction)
            shift -= shift > -100000;
    }
    double magnitude;
    if (digits && parse_exponent(text, i, &exponent))
        magnitude = mantissa ? scaled(mantissa, shift + exponent) : 0;
    else if (!parse_special(text, &magnitude))
        return false;
    *value = negative ? -magnitude : magnitude;
    return true;
}

bool io_parse_size(io_text text, size_t *value) {
    size_t result = 0;
    for (size_t i = 0; i < text.size; i++) {
        size_t digit = (size_t)(text.at[i] - '0');
        if (!is_digit(text, i) || result > (SIZE_MAX - digit) / 10)
            return false;
        result = result * 10 + digit;
    }
    *value = result;
    return text.size > 0;
}

/* ---- Typed views ----------------------------------------------------------------------------- */

io_type io_type_named(io_text name) {
    // clang-format off
    static const struct { const char *name; io_type type; } types[] = {
        {"int8", IO_I8}, {"char", IO_I8}, {"signed_char", IO_I8}, {"vtktypeint8", IO_I8},
        {"uint8", IO_U8}, {"unsigned_char", IO_U8}, {"vtktypeuint8", IO_U8}, {"bool", IO_U8},
        {"int16", IO_I16}, {"short", IO_I16}, {"vtktypeint16", IO_I16},
        {"uint16", IO_U16}, {"unsigned_short", IO_U16}, {"vtktypeuint16", IO_U16},
        {"int32", IO_I32}, {"int", IO_I32}, {"vtkidtype", IO_I32}, {"vtktypeint32", IO_I32},
        {"uint32", IO_U32}, {"unsigned_int", IO_U32}, {"vtktypeuint32", IO_U32},
        {"int64", IO_I64}, {"long", IO_I64}, {"long_long", IO_I64}, {"vtktypeint64", IO_I64},
        {"uint64", IO_U64}, {"unsigned_long", IO_U64}, {"unsigned_long_long", IO_U64},
        {"vtktypeuint64", IO_U64}, {"float16", IO_F16}, {"float32", IO_F32}, {"float", IO_F32},
        {"float64", IO_F64}, {"double", IO_F64},
    };
    // clang-format on
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (io_text_is(name, types[i].name))
            return types[i].type;
    return IO_NONE;
}

size_t io_type_size(io_type type) {
    static const uint8_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
    return sizes[type];
}

uint16_t io_u16(const uint8_t *b, bool big) {
    return (uint16_t)(big ? b[0] << 8 | b[1] : b[1] << 8 | b[0]);
}

uint32_t io_u32(const uint8_t *b, bool big) {
    uint32_t first = io_u16(b, big), second = io_u16(b + 2, big);
    return big ? first << 16 | second : second << 16 | first;
}

uint64_t io_u64(const uint8_t *b, bool big) {
    uint64_t first = io_u32(b, big), second = io_u32(b + 4, big);
    return big ? first << 32 | second : second << 32 | first;
}

float io_f32(const uint8_t *bytes, bool big) {
    uint32_t bits = io_u32(bytes, big);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double f64(const uint8_t *bytes, bool big) {
    uint64_t bits = io_u64(bytes, big);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double f16(uint16_t bits) {
    int exponent = bits >> 10 & 31, mantissa = bits & 1023;
    double value = exponent == 0    ? ldexp(mantissa, -24)
                   : exponent == 31 ? (mantissa ? NAN : INFINITY)
                                    : ldexp(mantissa + 1024, exponent - 25);
    return bits & 0x8000 ? -value : value;
}

/* Two's complement, without relying on how the compiler converts. */
static int64_t sign(uint64_t value, unsigned bits) {
    uint64_t top = UINT64_C(1) << (bits - 1);
    return value & top ? -(int64_t)((top << 1) - 1 - value) - 1 : (int64_t)value;
}

static uint64_t view_integer(const uint8_t *at, io_type type, bool big) {
    switch (io_type_size(type)) {
    case 1:
        return at[0];
    case 2:
        return io_u16(at, big);
    case 4:
        return io_u32(at, big);
    default:
        return io_u64(at, big);
    }
}

static bool is_signed(io_type type) {
    return type == IO_I8 || type == IO_I16 || type == IO_I32 || type == IO_I64;
}

double io_view_real(const io_view *view, size_t row, uint32_t component) {
    size_t size = io_type_size(view->type);
    const uint8_t *at = view->bytes + row * view->stride + component * size;
    if (view->type == IO_F32)
        return (double)io_f32(at, view->big);
    if (view->type == IO_F64)
        return f64(at, view->big);
    if (view->type == IO_F16)
        return f16(io_u16(at, view->big));
    uint64_t value = view_integer(at, view->type, view->big);
    return is_signed(view->type) ? (double)sign(value, 8 * (unsigned)size) : (double)value;
}

bool io_view_index(const io_view *view, size_t row, size_t *value) {
    if (view->type == IO_F16 || view->type == IO_F32 || view->type == IO_F64) {
        double real = io_view_real(view, row, 0);
        if (!(real >= 0 && real < 9007199254740992.0) || floor(real) != real ||
            real > (double)SIZE_MAX)
            return false;
        *value = (size_t)real;
        return true;
    }
    uint64_t whole = view_integer(view->bytes + row * view->stride, view->type, view->big);
    if (is_signed(view->type) && sign(whole, 8 * (unsigned)io_type_size(view->type)) < 0)
        return false;
    *value = (size_t)whole;
    return whole <= SIZE_MAX;
}

io_view io_view_doubles(const double *values, size_t count, uint32_t components) {
    const uint16_t one = 1;
    uint8_t low;
    memcpy(&low, &one, 1);
    io_view view = {
        (const uint8_t *)values, count, components * sizeof *values, components, IO_F64, !low};
    return view;
}
