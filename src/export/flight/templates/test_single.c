#include "@name@.h"
#include "@name@_vectors.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* How far a command may be off, over its limit, and how many decisions of a hundred may be other ones. */
#define MOST_OFF 1e-3
#define MOST_OTHERS 2

/* Beyond it a square may leave the range of float. */
#define LARGEST_SQUARED 1e15

static double of_bits(uint64_t bits)
{
    double value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

/* A sample's measurement in single precision at a time (s). */
static @name@_status take(@name@_controller *controller, double time_s, int sample, @name@_command *command)
{
    float row[@NAME@_GIVEN];
    int index;
    row[0] = 0.0F;
    for (index = 1; index < @NAME@_GIVEN; ++index) {
        row[index] = (float)of_bits(@name@_given[sample][index]);
    }
    return @name@_step(controller, time_s, @from_row@, command);
}

static int is_large(int sample)
{
    int index;
    for (index = 1; index < @NAME@_GIVEN; ++index) {
        if (fabs(of_bits(@name@_given[sample][index])) > LARGEST_SQUARED) {
            return 1;
        }
    }
    return 0;
}

/* Largest difference of a command over its limit; NaN counts as infinite. */
static double difference(const @name@_command *command, int sample)
{
    double largest = 0.0;
    int input;
    for (input = 0; input < @NAME@_INPUTS; ++input) {
        const double reference = of_bits(@name@_commands[sample][input]);
        const double own = fabs((double)command->@input@[input] - reference) / (double)@name@_limit(input);
        largest = (own <= largest) ? largest : own;
    }
    return largest;
}

/* Every sample against the reference in doubles. Where the trigger decides otherwise the controller begins anew with what the
 * reference has sent last. */
int main(void)
{
    @name@_controller controller;
    @name@_command command;
    double largest = 0.0;
    int last_sent = -1;
    int others = 0;
    int sample;
    @name@_init(&controller);
    for (sample = 0; sample < @NAME@_SAMPLES; ++sample) {
        const double time_s = of_bits(@name@_given[sample][0]);
        const int expected = (int)@name@_flags[sample][1];
        const int status = (int)take(&controller, time_s, sample, &command);
        int other = (command.sent != @name@_flags[sample][0]) || ((status != expected) && (expected <= 2));
        if ((status >= 3) != (expected >= 3)) {
            if (is_large(sample) == 0) {
                (void)printf("status of sample %d is %d, expected %d\nFAILED\n", sample, status, expected);
                return 1;
            }
            other = 1;
        }
        last_sent = (@name@_flags[sample][0] != 0U) ? sample : last_sent;
        if ((other != 0) && (expected <= 2)) {
            others += 1 - is_large(sample);
            @name@_init(&controller);
            if (last_sent >= 0) {
                (void)take(&controller, time_s, last_sent, &command);
            }
        }
        if ((last_sent < 0) || (is_large(last_sent) == 0)) {
            const double own = difference(&command, sample);
            largest = (own <= largest) ? largest : own;
        }
    }
    (void)printf("largest difference of a command %.1e of its limit, %d of %d decisions otherwise\n", largest, others, @NAME@_SAMPLES);
    if (!(largest <= MOST_OFF) || ((others * 100) > (MOST_OTHERS * @NAME@_SAMPLES))) {
        (void)printf("FAILED\n");
        return 1;
    }
    (void)printf("PASSED: %d samples\n", @NAME@_SAMPLES);
    return 0;
}
