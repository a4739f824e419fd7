#include "@name@.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "compile without -ffast-math and -ffinite-math-only: numbers that are not finite must be recognised, and sums keep their order"
#endif
#if DBL_MANT_DIG != @mantissa@
#error "the controller needs numbers with @mantissa@ binary digits (IEEE 754)"
#endif

#define STATES @NAME@_STATES
#define INPUTS @NAME@_INPUTS
