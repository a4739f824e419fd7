/* The largest of two numbers, and the smallest. */
static double larger(double left, double right)
{
    return (left > right) ? left : right;
}

static double smaller(double left, double right)
{
    return (left < right) ? left : right;
}

/* Whether all of some numbers are finite. */
static int all_finite(const double values[], int count)
{
    int index;
    for (index = 0; index < count; ++index) {
        if (isfinite(values[index]) == 0) {
            return 0;
        }
    }
    return 1;
}

/* The sum of products, in the order of the index. */
static double sum_of_products(const double left[], const double right[], int count)
{
    double sum = left[0] * right[0];
    int index;
    for (index = 1; index < count; ++index) {
        sum += left[index] * right[index];
    }
    return sum;
}

/* Saturation of each input. */
static void saturate(double command[INPUTS])
{
    int input;
    for (input = 0; input < INPUTS; ++input) {
        command[input] = larger(smaller(command[input], LIMITS[input]), -LIMITS[input]);
    }
}

/* Refuses a time that is not finite or not later than that of the last sample used. */
static @name@_status check_time(const @name@_controller *self, double time_s)
{
    if (isfinite(time_s) == 0) {
        return @NAME@_HELD_TIME_NOT_FINITE;
    }
    if ((self->has_time != 0U) && (time_s <= self->time_s)) {
        return @NAME@_HELD_TIME_NOT_INCREASING;
    }
    return @NAME@_NOMINAL;
}
