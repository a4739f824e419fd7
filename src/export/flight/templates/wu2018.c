/* The sign with which the vector part enters; it changes only when the scalar part has passed zero by the hysteresis. */
static int side_is_positive(const @name@_controller *self, double scalar)
{
    if (SHORTEST == 0) {
        return 1;
    }
    if (self->has_side == 0U) {
        return (scalar >= 0.0) ? 1 : 0;
    }
    return (self->is_positive != 0U) ? (scalar >= -HYSTERESIS) : (scalar > HYSTERESIS);
}

/* Whether the filtered error must be sent: |s(t_k) - s| >= alpha |s| + gamma, or nothing was sent before. */
static int fires(const @name@_controller *self, const double error[3])
{
    double difference[3];
    int axis;
    if ((self->has_sent == 0U) || (EVERY_SAMPLE != 0)) {
        return 1;
    }
    for (axis = 0; axis < 3; ++axis) {
        difference[axis] = self->sent[axis] - error[axis];
    }
    return sqrt(sum_of_products(difference, difference, 3)) >=
           ((RELATIVE * sqrt(sum_of_products(error, error, 3))) + ABSOLUTE_RAD_S);
}

static @name@_status advance(
    @name@_controller *self, double time_s, const double attitude[4], const double rate_rad_s[3], uint8_t *sent)
{
    const int positive = side_is_positive(self, attitude[0]);
    const double weight = ((positive != 0) ? 1.0 : -1.0) * ATTITUDE_WEIGHT;
    double error[3];
    int axis;
    for (axis = 0; axis < 3; ++axis) {
        error[axis] = rate_rad_s[axis] + (attitude[1 + axis] * weight);
    }
    if (all_finite(error, 3) == 0) {
        return @NAME@_HELD_OVERFLOW;
    }
    self->is_positive = (positive != 0) ? 1U : 0U;
    self->has_side = 1U;
    self->time_s = time_s;
    self->has_time = 1U;
    if (fires(self, error) != 0) {
        for (axis = 0; axis < 3; ++axis) {
            self->sent[axis] = error[axis];
            self->command[axis] = error[axis] * -ERROR_GAIN;
        }
        saturate(self->command);
        self->has_sent = 1U;
        *sent = 1U;
    }
    return @NAME@_NOMINAL;
}

void @name@_init(@name@_controller *self)
{
    int axis;
    if (self == NULL) {
        return;
    }
    for (axis = 0; axis < 3; ++axis) {
        self->command[axis] = 0.0;
        self->sent[axis] = 0.0;
    }
    self->time_s = 0.0;
    self->has_time = 0U;
    self->has_sent = 0U;
    self->has_side = 0U;
    self->is_positive = 1U;
}
