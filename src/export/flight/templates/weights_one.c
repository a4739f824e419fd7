/* The weight of the only gain. */
static void memberships(const double state[STATES], double weights[GAINS])
{
    (void)state;
    weights[0] = 1.0;
}
