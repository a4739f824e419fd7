#include "@name@.h"

#include <stddef.h>
#include <string.h>

#include "mex.h"

/*
 * The controller for MATLAB and Octave. The caller holds its state between samples, as an array of uint8 that is of use to
 * this function only; so any number of controllers may run side by side.
 *
 *   state = @name@_mex('init')
 *   state = @name@_mex('reset', state)
 *   [command, sent, status, state] = @name@_mex('step', state, time_s, @arguments@)
 *
 * Build: mex CFLAGS='$CFLAGS -std=c99 -ffp-contract=off' @name@_mex.c @name@.c
 *        CFLAGS='-O2 -std=c99 -ffp-contract=off' mkoctfile --mex @name@_mex.c @name@.c
 */
#define LONGEST_WORD 8

/* Ends the function with an error; does not return. */
static void refuse(const char *message)
{
    mexErrMsgIdAndTxt("steadfast:@name@", "%s", message);
}

/* Numbers that a step takes. */
static const double *numbers(const mxArray *array, size_t count, const char *message)
{
    if (!mxIsDouble(array) || mxIsComplex(array) || mxIsSparse(array) || (mxGetNumberOfElements(array) != count)) {
        refuse(message);
    }
    return mxGetPr(array);
}

/* The controller in an array of bytes. */
static void read_state(const mxArray *array, @name@_controller *controller)
{
    if (!mxIsUint8(array) || (mxGetNumberOfElements(array) != sizeof *controller)) {
        refuse("the state must be one that 'init' or 'step' gave");
    }
    (void)memcpy(controller, mxGetData(array), sizeof *controller);
}

static mxArray *written_state(const @name@_controller *controller)
{
    mxArray *array = mxCreateNumericMatrix(1, (mwSize)sizeof *controller, mxUINT8_CLASS, mxREAL);
    (void)memcpy(mxGetData(array), controller, sizeof *controller);
    return array;
}

/* A controller before its first sample; the bytes between its fields are zero. */
static mxArray *new_state(void)
{
    @name@_controller controller;
    (void)memset(&controller, 0, sizeof controller);
    @name@_init(&controller);
    return written_state(&controller);
}

/* [command, sent, status, state] of a sample. */
static void step(int results, mxArray *result[], const mxArray *argument[])
{
    @name@_controller controller;
    @name@_command command;
    const double *time_s = numbers(argument[2], 1U, "the time must be a double");
@mex_read@
    read_state(argument[1], &controller);
    (void)@name@_step(&controller, *time_s, @arguments@, &command);
    result[0] = mxCreateDoubleMatrix(@NAME@_INPUTS, 1, mxREAL);
    (void)memcpy(mxGetPr(result[0]), command.@input@, sizeof command.@input@);
    if (results > 1) {
        result[1] = mxCreateLogicalScalar(command.sent != 0U);
    }
    if (results > 2) {
        result[2] = mxCreateDoubleScalar((double)command.status);
    }
    if (results > 3) {
        result[3] = written_state(&controller);
    }
}

void mexFunction(int results, mxArray *result[], int arguments, const mxArray *argument[])
{
    char word[LONGEST_WORD] = "";
    if ((arguments > 0) && mxIsChar(argument[0])) {
        (void)mxGetString(argument[0], word, LONGEST_WORD);
    }
    if ((strcmp(word, "init") == 0) && (arguments == 1)) {
        result[0] = new_state();
    } else if ((strcmp(word, "reset") == 0) && (arguments == 2)) {
        @name@_controller controller;
        read_state(argument[1], &controller);
        result[0] = new_state();
    } else if ((strcmp(word, "step") == 0) && (arguments == @mex_count@) && (results <= 4)) {
        step(results, result, argument);
    } else {
        refuse("use 'init', 'reset' with a state, or 'step' with a state, time_s, @arguments@");
    }
}
