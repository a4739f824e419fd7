#include "@name@_simulink.h"

#include <string.h>

/* The controller lives in a work vector of its block, so a model may hold several, and saved states of the model contain it.
 * It is copied in and out, because a block's memory is one of doubles. */
typedef char the_controller_fits[(sizeof(@name@_controller) <= (@NAME@_WORDS * sizeof(double))) ? 1 : -1];

void @name@_block_init(double work[@NAME@_WORDS])
{
    @name@_controller controller;
    (void)memset(work, 0, @NAME@_WORDS * sizeof(double));
    @name@_init(&controller);
    (void)memcpy(work, &controller, sizeof controller);
}

void @name@_block_step(
    double work[@NAME@_WORDS],
    double time_s,
    @measurement@,
    double command[@NAME@_INPUTS],
    uint8_t *sent,
    uint8_t *status)
{
    @name@_controller controller;
    @name@_command result;
    (void)memcpy(&controller, work, sizeof controller);
    (void)@name@_step(&controller, time_s, @arguments@, &result);
    (void)memcpy(work, &controller, sizeof controller);
    (void)memcpy(command, result.@input@, sizeof result.@input@);
    *sent = result.sent;
    *status = (uint8_t)result.status;
}
