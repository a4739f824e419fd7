/* The weights of the corners of the box; outside of it those of its nearest point. */
static void memberships(const double state[STATES], double weights[GAINS])
{
    double variables[4];
    int rule;
    int index;
    scheduling_variables(state, variables);
    for (rule = 0; rule < GAINS; ++rule) {
        weights[rule] = 1.0;
    }
    for (index = 0; index < 4; ++index) {
        const double part = (variables[index] - LOWER[index]) / (UPPER[index] - LOWER[index]);
        const double upper = smaller(larger(part, 0.0), 1.0);
        for (rule = 0; rule < GAINS; ++rule) {
            weights[rule] *= ((((unsigned)rule >> (unsigned)index) & 1U) != 0U) ? upper : (1.0 - upper);
        }
    }
}
