#ifndef STEADFAST_@NAME@_SIMULINK_H
#define STEADFAST_@NAME@_SIMULINK_H

#include <stdint.h>

#include "@name@.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Doubles of a work vector that the controller fits into; @name@_legacy_code.m says the same number. */
#define @NAME@_WORDS @words@

/* The controller in the work vector of a block, before its first sample. */
void @name@_block_init(double work[@NAME@_WORDS]);

/* One sample of a block. sent: 1 where the trigger fired; status: as in @name@.h. */
void @name@_block_step(
    double work[@NAME@_WORDS],
    double time_s,
    @measurement@,
    double command[@NAME@_INPUTS],
    uint8_t *sent,
    uint8_t *status);

#ifdef __cplusplus
}
#endif

#endif
