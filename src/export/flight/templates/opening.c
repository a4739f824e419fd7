#include "@name@.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

#if defined(__FAST_MATH__)
#error "compile without -ffast-math: numbers that are not finite must be recognised, and sums keep their order"
#endif
#if DBL_MANT_DIG != 53
#error "the controller needs doubles of 64 bits (IEEE 754)"
#endif

#define STATES @NAME@_STATES
#define INPUTS @NAME@_INPUTS
