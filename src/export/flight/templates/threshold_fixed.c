/* The threshold never changes. */
static void move_threshold(@name@_controller *self, const double state[STATES])
{
    (void)self;
    (void)state;
}
