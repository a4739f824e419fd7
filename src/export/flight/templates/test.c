#include "@name@.h"
#include "@name@_vectors.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static double of_bits(uint64_t bits)
{
    double value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

static uint64_t to_bits(double value)
{
    uint64_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Whether the compiler turns a product and a sum into one operation with one rounding. */
static int is_contracted(void)
{
    volatile double more = 1.0 + (1.0 / 1073741824.0);
    volatile double less = 1.0 - (1.0 / 1073741824.0);
    volatile double minus_one = -1.0;
    const double a = more;
    const double b = less;
    const double c = minus_one;
    const double sum = (a * b) + c;
    return (sum < 0.0) ? 1 : 0;
}

/* Says what is likely to be the cause of a difference. */
static void explain(void)
{
    if (is_contracted() != 0) {
        (void)printf("  cause: this compiler contracts a * b + c into one operation (fused multiply-add), which rounds once\n"
                     "  in the place of twice. Compile with -ffp-contract=off.\n");
    }
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
    (void)printf("  cause: FLT_EVAL_METHOD is %d: doubles are computed with more digits. On x86 compile with -msse2 -mfpmath=sse.\n",
                 (int)FLT_EVAL_METHOD);
#endif
}

/* Compares a command with the reference; prints the first difference. */
static int differs(const char *what, int sample, const double found[@NAME@_INPUTS], const uint64_t expected[@NAME@_INPUTS])
{
    int input;
    for (input = 0; input < @NAME@_INPUTS; ++input) {
        const double reference = of_bits(expected[input]);
        const int same = (to_bits(found[input]) == expected[input]) ||
                         (fabs(found[input] - reference) < (@NAME@_TOLERANCE * @name@_limit(input)));
        if (same == 0) {
            (void)printf("%s %d of sample %d is %.17g, expected %.17g\n", what, input + 1, sample, found[input], reference);
            explain();
            return 1;
        }
    }
    return 0;
}

static int check_flag(const char *what, int sample, unsigned found, unsigned expected)
{
    if (found != expected) {
        (void)printf("%s of sample %d is %u, expected %u\n", what, sample, found, expected);
        explain();
        return 1;
    }
    return 0;
}

/* One pass over all samples from the start; 0 where everything is as expected. */
static int run(@name@_controller *controller)
{
    @name@_sender sender;
    @name@_receiver receiver;
    int sample;
    @name@_sender_init(&sender, 0U);
    @name@_receiver_init(&receiver);
    for (sample = 0; sample < @NAME@_SAMPLES; ++sample) {
        double row[@NAME@_GIVEN];
        double received[@NAME@_INPUTS];
        @name@_command command;
        @name@_message message;
        int index;
        for (index = 0; index < @NAME@_GIVEN; ++index) {
            row[index] = of_bits(@name@_given[sample][index]);
        }
        (void)@name@_step(controller, row[0], @from_row@, &command);
        if ((check_flag("status", sample, (unsigned)command.status, @name@_flags[sample][1]) != 0) ||
            (check_flag("sent", sample, command.sent, @name@_flags[sample][0]) != 0) ||
            (differs("command", sample, command.@input@, @name@_commands[sample]) != 0)) {
            return 1;
        }
        if ((@name@_sender_sample(&sender, &command, &message) != 0) && (@name@_flags[sample][2] != 0U)) {
            (void)@name@_receiver_take(&receiver, &message);
        }
        @name@_receiver_command(&receiver, received);
        if (differs("received command", sample, received, @name@_received[sample]) != 0) {
            return 1;
        }
    }
    return 0;
}

int main(void)
{
    @name@_controller controller;
    int again;
    @name@_init(&controller);
    for (again = 0; again < 2; ++again) {
        if (run(&controller) != 0) {
            (void)printf("FAILED\n");
            return 1;
        }
        @name@_reset(&controller);
    }
    (void)printf("PASSED: %d samples, twice\n", @NAME@_SAMPLES);
    return 0;
}
