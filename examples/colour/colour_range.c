#include "colour.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- percentiles ------------------------------------------------------------------------ */

static void swap(double *x, double *y) {
    double v = *x;
    *x = *y;
    *y = v;
}

/* Moves finite values to the front; how many there are. None is lost, for the next call. */
static size_t gather(double *values, size_t count) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        if (isfinite(values[i]))
            swap(&values[kept++], &values[i]);
    }
    return kept;
}

/* Hoare's selection: afterwards values[k] is what it would be in order, smaller ones before. */
static void select_value(double *values, size_t count, size_t k) {
    size_t low = 0, high = count - 1;
    while (low < high) {
        double pivot = values[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot)
                i++;
            while (values[j] > pivot)
                j--;
            if (i >= j)
                break;
            swap(&values[i++], &values[j--]);
        }
        if (k <= j) /* those in [low, j] are at most the pivot, the rest at least */
            high = j;
        else
            low = j + 1;
    }
}

double colour_percentile(double *values, size_t count, double percent) {
    count = gather(values, count);
    if (count == 0)
        return NAN;
    double x = (double)(count - 1) * fmin(fmax(percent, 0), 100) / 100;
    size_t k = (size_t)x;
    select_value(values, count, k);
    double low = values[k], next = low;
    if (k + 1 < count) { /* the least of those behind */
        next = values[k + 1];
        for (size_t i = k + 2; i < count; i++)
            next = values[i] < next ? values[i] : next;
    }
    double f = x - (double)k;
    return f > 0 ? low * (1 - f) + next * f : low;
}

void colour_range(double *values, size_t count, const colour_end ends[2], double range[2]) {
    for (int i = 0; i < 2; i++) {
        range[i] =
            ends[i].percent ? colour_percentile(values, count, ends[i].value) : ends[i].value;
    }
    for (int i = 0; i < 2; i++) {
        if (!isfinite(range[i])) /* no number at all */
            range[i] = isfinite(range[1 - i]) ? range[1 - i] : 0;
    }
    if (range[0] == range[1]) {
        double half = fmax(1, fabs(range[0]) * 1e-6);
        range[0] -= half;
        range[1] += half;
    }
}

/* ---- ticks ------------------------------------------------------------------------------ */

colour_ticks colour_ticks_make(double a, double b, uint32_t most) {
    static const double nice[4] = {1, 2, 5, 10};
    double low = fmin(a, b), high = fmax(a, b), span = high - low;
    colour_ticks ticks;
    memset(&ticks, 0, sizeof ticks);
    most = most < COLOUR_TICKS ? most : COLOUR_TICKS;
    if (!isfinite(span) || !(span > 0) || most == 0)
        return ticks;
    int power = (int)floor(log10(span / most)), pick = 0;
    double step = 0, first = 0, slack = 1e-9 * span;
    for (uint32_t fits = most + 1; fits > most; pick++) { /* a step of 10^(power + 1) always fits */
        if (pick == 4) {
            pick = 1;
            power++;
        }
        step = nice[pick] * pow(10, power);
        first = ceil((low - slack) / step);
        fits = (uint32_t)fmin(floor((high + slack) / step) - first + 1, 1000);
    }
    for (double i = first; i * step <= high + slack && ticks.count < most; i++)
        ticks.at[ticks.count++] = i == 0 ? 0 : i * step;
    int digit = pick == 4 ? power + 1 : power;
    ticks.decimals = digit < 0 ? (uint32_t)-digit : 0;
    return ticks;
}

void colour_tick_text(const colour_ticks *ticks, uint32_t index, char *text, size_t size) {
    double value = ticks->at[index], last = ticks->at[ticks->count - 1];
    double largest = fmax(fabs(ticks->at[0]), fabs(last));
    if (ticks->decimals > 5 || largest >= 1e6) {
        double step = ticks->count > 1 ? ticks->at[1] - ticks->at[0] : largest;
        int digits = step > 0 ? (int)(floor(log10(largest)) - floor(log10(step) + 1e-9)) : 0;
        if (value == 0)
            snprintf(text, size, "0");
        else
            snprintf(text, size, "%.*e", digits > 0 ? digits : 0, value);
    } else {
        snprintf(text, size, "%.*f", (int)ticks->decimals, value);
    }
}
