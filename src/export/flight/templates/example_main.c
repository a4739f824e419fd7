#include "@name@.h"

#include <stdio.h>

/* A loop with made-up measurements: replace them by those of your sensors. */
int main(void)
{
    static @name@_controller controller;
    int sample;
    @name@_init(&controller);
    for (sample = 0; sample < 10; ++sample) {
        const double time_s = @interval_s@ * sample;
@example@
        @name@_command command;
        const @name@_status status = @name@_step(&controller, time_s, @arguments@, &command);
        (void)printf("%4.1f s: status %d, sent %d, @input@ %.6g\n", time_s, (int)status, (int)command.sent, command.@input@[0]);
    }
    return 0;
}
