/* A fuzzy set: its kind and four numbers. 0 any, 1 and 2 straight sides (left, left_top, right_top, right), 3 Gaussian
 * (centre, width), 4 never. Its grade at a value is factor * exp(-exponent). */
static double grade(const double set[5], double value, double *exponent)
{
    *exponent = 0.0;
    if (set[0] < 0.5) {
        return 1.0;
    }
    if (set[0] > 3.5) {
        return 0.0;
    }
    if (set[0] > 2.5) {
        const double offset = (value - set[1]) / set[2];
        *exponent = 0.5 * offset * offset;
        return 1.0;
    }
    if ((set[2] <= value) && (value <= set[3])) {
        return 1.0;
    }
    if ((set[1] < value) && (value < set[2])) {
        return (value - set[1]) / (set[2] - set[1]);
    }
    if ((set[3] < value) && (value < set[4])) {
        return (set[4] - value) / (set[4] - set[3]);
    }
    return 0.0;
}

/* The weights of the rules, with sum 1; outside of the box those of its nearest point. */
static void memberships(const double state[STATES], double weights[GAINS])
{
    double exponents[GAINS];
    double nearest = HUGE_VAL;
    double sum = 0.0;
    int rule;
    int index;
    for (rule = 0; rule < GAINS; ++rule) {
        weights[rule] = 1.0;
        exponents[rule] = 0.0;
        for (index = 0; index < STATES; ++index) {
            double exponent;
            const double inside = smaller(larger(state[index], -BOUNDS[index]), BOUNDS[index]);
            weights[rule] *= grade(SETS[rule][index], inside, &exponent);
            exponents[rule] += exponent;
        }
        if (weights[rule] > 0.0) {
            nearest = smaller(nearest, exponents[rule]);
        }
    }
    if (isfinite(nearest) != 0) {
        for (rule = 0; rule < GAINS; ++rule) {
            if (weights[rule] > 0.0) {
                weights[rule] *= EXPONENTIAL(nearest - exponents[rule]);
            }
            sum += weights[rule];
        }
    }
    for (rule = 0; rule < GAINS; ++rule) {
        weights[rule] = ((sum > 0.0) && (isfinite(sum) != 0)) ? (weights[rule] / sum) : EQUAL_WEIGHT;
    }
}
