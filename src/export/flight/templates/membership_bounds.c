/* Whether the state is in the box of the rules. */
static int is_inside(const double state[STATES])
{
    int index;
    for (index = 0; index < STATES; ++index) {
        if (fabs(state[index]) > BOUNDS[index]) {
            return 0;
        }
    }
    return 1;
}
