/* Refuses a state that is not finite. */
static @name@_status check_measurement(const double measured[STATES])
{
    return (all_finite(measured, STATES) != 0) ? @NAME@_NOMINAL : @NAME@_HELD_MEASUREMENT_NOT_FINITE;
}

/* The state as it is measured. */
static void read_state(const double measured[STATES], double state[STATES])
{
    int index;
    for (index = 0; index < STATES; ++index) {
        state[index] = measured[index];
    }
}
