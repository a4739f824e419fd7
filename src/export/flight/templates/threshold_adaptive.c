/* The threshold after a trigger at which the sent state moved, within its bounds. */
static void move_threshold(@name@_controller *self, const double state[STATES])
{
    double step[STATES];
    double moved;
    int index;
    for (index = 0; index < STATES; ++index) {
        step[index] = state[index] - self->sent[index];
    }
    moved = sqrt(sum_of_products(step, step, STATES));
    moved = self->threshold * (1.0 - (AMPLITUDE * atan(SLOPE * (moved - DEAD_BAND))));
    self->threshold = smaller(larger(moved, LEAST_THRESHOLD), LARGEST_THRESHOLD);
}
