static double squared_hyperbolic_secant(double value)
{
    const double secant = 1.0 / cosh(value);
    return secant * secant;
}

/* The half width rho of the funnel of each axis, (3), and its slope [1/s]. */
static void funnel(double elapsed_s, double width[3], double slope[3])
{
    const double phase = (elapsed_s - MIDPOINT_S) / TIME_SCALE_S;
    const double share = 0.5 * (1.0 - tanh(phase));
    const double fall = (-0.5 * squared_hyperbolic_secant(phase)) / TIME_SCALE_S;
    int axis;
    for (axis = 0; axis < 3; ++axis) {
        const double range = FUNNEL_INITIAL[axis] - FUNNEL_TERMINAL[axis];
        width[axis] = FUNNEL_TERMINAL[axis] + (range * share);
        slope[axis] = range * fall;
    }
}

/* The virtual rate (10), rad/s. */
static void virtual_rate(const double error[4], const double width[3], double out[3])
{
    const double *q = &error[1];
    double bounded[3];
    double turned[3];
    double along;
    int axis;
    for (axis = 0; axis < 3; ++axis) {
        bounded[axis] = width[axis] * tanh((SLOPE * q[axis]) / width[axis]);
    }
    cross(q, bounded, turned);
    along = sum_of_products(q, bounded, 3);
    for (axis = 0; axis < 3; ++axis) {
        const double direction =
            ((bounded[axis] * (error[0] * error[0])) - (turned[axis] * error[0])) + (q[axis] * along);
        out[axis] = direction * -STRENGTH_RAD_S;
    }
}

/* Its time derivative, rad/s^2. */
static void virtual_acceleration(
    const double error[4], const double rate[3], const double width[3], const double slope[3], double out[3])
{
    const double *q = &error[1];
    double change[4];
    double r[3];
    double dr[3];
    double q_r[3];
    double dq_r[3];
    double q_dr[3];
    double along;
    double growth;
    int axis;
    derivative(error, rate, change);
    for (axis = 0; axis < 3; ++axis) {
        const double phase = (q[axis] / width[axis]) * SLOPE;
        const double moved = (change[1 + axis] - ((q[axis] * slope[axis]) / width[axis])) * SLOPE;
        r[axis] = width[axis] * tanh((SLOPE * q[axis]) / width[axis]);
        dr[axis] = (slope[axis] * tanh(phase)) + (squared_hyperbolic_secant(phase) * moved);
    }
    cross(q, r, q_r);
    cross(&change[1], r, dq_r);
    cross(q, dr, q_dr);
    along = sum_of_products(q, r, 3);
    growth = sum_of_products(&change[1], r, 3) + sum_of_products(q, dr, 3);
    for (axis = 0; axis < 3; ++axis) {
        const double turning = ((r[axis] * ((2.0 * error[0]) * change[0])) + (dr[axis] * (error[0] * error[0]))) -
                               (q_r[axis] * change[0]);
        const double direction = ((turning - ((dq_r[axis] + q_dr[axis]) * error[0])) + (change[1 + axis] * along)) +
                                 (q[axis] * growth);
        out[axis] = direction * -STRENGTH_RAD_S;
    }
}

/* What the barrier function (5) of the transformed error asks for, N m, and its value, J. */
static double barrier(const double error[4], const double width[3], double out[3])
{
    double transformed[3];
    double gradient[3];
    double turned[3];
    double argument;
    double log_cosh;
    int axis;
    for (axis = 0; axis < 3; ++axis) {
        transformed[axis] = error[1 + axis] / width[axis];
    }
    argument = sum_of_products(transformed, transformed, 3) / BARRIER_WIDTH;
    for (axis = 0; axis < 3; ++axis) {
        gradient[axis] = (transformed[axis] * (BARRIER_GAIN_J * tanh(argument))) / width[axis];
    }
    cross(&error[1], gradient, turned);
    for (axis = 0; axis < 3; ++axis) {
        out[axis] = ((gradient[axis] * error[0]) - turned[axis]) * 0.5;
    }
    if (argument < 1e-2) {
        const double square = argument * argument;
        log_cosh = square * (0.5 - (square * ((1.0 / 12.0) - (square / 45.0))));
    } else {
        log_cosh = (argument + log1p(exp(-2.0 * argument))) - LN_2;
    }
    return 0.5 * BARRIER_GAIN_J * BARRIER_WIDTH * log_cosh;
}

/* Law (12): the torque (N m), and the energy of the error of the rate (J); 0 where something overflows. */
static int evaluate(
    double elapsed_s, const double error[4], const double rate[3], double torque[3], double *energy_j)
{
    double width[3];
    double slope[3];
    double wanted[3];
    double acceleration[3];
    double compensation[3];
    double rate_error[3];
    double momentum[3];
    double gyroscopic[3];
    double pushed[3];
    double of_error[3];
    double value_j;
    int axis;
    funnel(elapsed_s, width, slope);
    virtual_rate(error, width, wanted);
    virtual_acceleration(error, rate, width, slope, acceleration);
    value_j = barrier(error, width, compensation);
    for (axis = 0; axis < 3; ++axis) {
        rate_error[axis] = rate[axis] - wanted[axis];
    }
    momentum_of(rate, momentum);
    cross(rate, momentum, gyroscopic);
    momentum_of(acceleration, pushed);
    momentum_of(rate_error, of_error);
    for (axis = 0; axis < 3; ++axis) {
        const double rejection = tanh(rate_error[axis] / SMOOTHING_RAD_S) * DISTURBANCE_NM;
        torque[axis] =
            (((gyroscopic[axis] - (rate_error[axis] * RATE_GAIN)) + pushed[axis]) - rejection) - compensation[axis];
    }
    *energy_j = 0.5 * sum_of_products(rate_error, of_error, 3);
    return (all_finite(wanted, 3) != 0) && (all_finite(rate_error, 3) != 0) && (all_finite(torque, 3) != 0) &&
           (isfinite(value_j) != 0) && (isfinite(*energy_j) != 0);
}

/* The quaternion with norm 1 whose scalar part is not negative; the sign changes only when the scalar part has passed zero by
 * the hysteresis. Returns that sign. */
static int read_error(const @name@_controller *self, const double measured[4], double error[4])
{
    int positive = 1;
    normalise(measured, error);
    if (self->has_side == 0U) {
        if (error[0] < 0.0) {
            positive = 0;
        }
    } else if (self->is_positive != 0U) {
        if (error[0] < -HYSTERESIS) {
            positive = 0;
        }
    } else if (error[0] <= HYSTERESIS) {
        positive = 0;
    } else {
        positive = 1;
    }
    if (positive == 0) {
        int part;
        for (part = 0; part < 4; ++part) {
            error[part] = -error[part];
        }
    }
    return positive;
}

/* Triggers (6) and (8): whether the actuators are turned off, and on. */
static void decide(
    const @name@_controller *self, double elapsed_s, const double wanted[3], double energy_j, int *off, int *on)
{
    const double decay = exp(-DECAY_PER_S * elapsed_s);
    const double envelope = ((ENVELOPE_INITIAL_J - ENVELOPE_TERMINAL_J) * decay) + ENVELOPE_TERMINAL_J;
    double held[3];
    int axis;
    if (EVERY_SAMPLE != 0) {
        *off = 0;
        *on = 1;
        return;
    }
    for (axis = 0; axis < 3; ++axis) {
        held[axis] = wanted[axis] - self->command[axis];
    }
    *off = (self->is_on != 0U) &&
           ((sum_of_products(held, held, 3) >= ((HELD_ERROR_INITIAL * decay) + HELD_ERROR_TERMINAL)) ||
            ((elapsed_s - self->on_since_s) >= LONGEST_ON_S));
    *on = ((*off != 0) || (self->is_on == 0U)) && (energy_j >= (((1.0 - RELATIVE_BUFFER) * envelope) - BUFFER_J));
}

static @name@_status advance(
    @name@_controller *self, double time_s, const double attitude[4], const double rate_rad_s[3], uint8_t *sent)
{
    const double elapsed_s = (self->has_time != 0U) ? (time_s - self->start_s) : 0.0;
    double error[4];
    double wanted[3];
    double energy_j = 0.0;
    int off = 0;
    int on = 0;
    int axis;
    const int positive = read_error(self, attitude, error);
    if (evaluate(elapsed_s, error, rate_rad_s, wanted, &energy_j) == 0) {
        return @NAME@_HELD_OVERFLOW;
    }
    self->is_positive = (positive != 0) ? 1U : 0U;
    self->has_side = 1U;
    if (self->has_time == 0U) {
        self->start_s = time_s;
    }
    self->time_s = time_s;
    self->has_time = 1U;
    saturate(wanted);
    decide(self, elapsed_s, wanted, energy_j, &off, &on);
    for (axis = 0; axis < 3; ++axis) {
        if (off != 0) {
            self->command[axis] = 0.0;
        }
        if (on != 0) {
            self->command[axis] = wanted[axis];
        }
    }
    if (off != 0) {
        self->is_on = 0U;
    }
    if (on != 0) {
        self->is_on = 1U;
        self->on_since_s = elapsed_s;
    }
    *sent = ((off != 0) || (on != 0)) ? 1U : 0U;
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
    }
    self->time_s = 0.0;
    self->start_s = 0.0;
    self->on_since_s = 0.0;
    self->has_time = 0U;
    self->has_side = 0U;
    self->is_positive = 1U;
    self->is_on = 0U;
}
