/* Numbers that are near enough. A failure says which, where, and both values; NaN is near nothing.
 */
#ifndef NEAR_H
#define NEAR_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define assert_near(a, b, tolerance)                                                               \
    assert_near_((double)(a), (double)(b), (double)(tolerance), #a, __FILE__, __LINE__)

static inline void assert_near_(double a, double b, double tolerance, const char *what,
                                const char *file, int line) {
    if (fabs(a - b) <= tolerance)
        return;
    print_error("%s is %.17g, not %.17g +- %.3g\n", what, a, b, tolerance);
    _fail(file, line);
}

#endif
