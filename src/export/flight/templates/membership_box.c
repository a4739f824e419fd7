/* The scheduling variables: the three rates (rad/s) and the scalar part q0. */
static void scheduling_variables(const double state[STATES], double variables[4])
{
    const double square = sum_of_products(&state[3], &state[3], 3);
    variables[0] = state[0];
    variables[1] = state[1];
    variables[2] = state[2];
    variables[3] = sqrt(larger(1.0 - square, 0.0));
}

/* Whether the state is in the box on which the fuzzy model equals the spacecraft. */
static int is_inside(const double state[STATES])
{
    double variables[4];
    int index;
    scheduling_variables(state, variables);
    for (index = 0; index < 4; ++index) {
        if ((variables[index] < LOWER[index]) || (variables[index] > UPPER[index])) {
            return 0;
        }
    }
    return (sum_of_products(&state[3], &state[3], 3) <= 1.0) ? 1 : 0;
}
