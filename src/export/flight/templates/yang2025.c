/* A value with its time derivative [1/s]. */
typedef struct {
    double value;
    double slope;
} level;

/* The bounds of a component of the error. */
typedef struct {
    level lower;
    level upper;
} bounds;

/* The transformed error (14), (15). */
typedef struct {
    double value;
    double slope;
} transformed_error;

static double sign_of(double value)
{
    return (value > 0.0) ? 1.0 : ((value < 0.0) ? -1.0 : 0.0);
}

static double signed_power(double value, double exponent)
{
    return sign_of(value) * pow(fabs(value), exponent);
}

/* The performance function rho of an axis: (8), or an exponential. */
static level performance(int axis, double time_s)
{
    level out;
    if (APPOINTED != 0) {
        if (time_s >= APPOINTED_S[axis]) {
            out.value = FINAL_LEVEL;
            out.slope = 0.0;
        } else {
            const double *z = COEFFICIENTS[axis];
            const double pace = HALF_PI / APPOINTED_S[axis];
            const double sine = sin(pace * time_s);
            const double cosine = cos(pace * time_s);
            const double argument = (RATE_PER_S * time_s) + OFFSET;
            const double cosecant = 1.0 / sinh(argument);
            const double cotangent = 1.0 / tanh(argument);
            out.value = ((z[0] + (z[1] * sine)) + (z[2] * cosine)) + (z[3] * cosecant);
            out.slope = (pace * ((z[1] * cosine) - (z[2] * sine))) - (((z[3] * RATE_PER_S) * cotangent) * cosecant);
        }
    } else {
        const double share = (INITIAL_LEVEL - FINAL_LEVEL) * exp(-RATE_PER_S * time_s);
        out.value = share + FINAL_LEVEL;
        out.slope = -RATE_PER_S * share;
    }
    return out;
}

/* The bounds (10) without their corrections. */
static bounds basic(level rho, double side)
{
    const double settled = side * FINAL_LEVEL;
    bounds out;
    out.lower.value = (-(SHAPE - side) * rho.value) - settled;
    out.lower.slope = -(SHAPE - side) * rho.slope;
    out.upper.value = ((SHAPE + side) * rho.value) - settled;
    out.upper.slope = (SHAPE + side) * rho.slope;
    return out;
}

/* The adhesive terms (12): the envelope starts around the initial error. */
static void adhere(int axis, double time_s, double initial, bounds start, bounds *out)
{
    const double r1 = -start.lower.value;
    const double r2 = start.upper.value;
    const double lower = initial - (0.5 * ((ADHESION_WIDTH * r2) + ((ADHESION_WIDTH - 2.0) * r1)));
    const double upper = initial + (0.5 * (((ADHESION_WIDTH - 2.0) * r2) + (ADHESION_WIDTH * r1)));
    const double left = 1.0 - (time_s / ADHESION_SPAN_S[axis]);
    double share;
    double slope;
    if ((ADHESIVE == 0) || (time_s >= ADHESION_SPAN_S[axis])) {
        return;
    }
    share = pow(left, 1.0 / ADHESION_EXPONENT);
    slope = -share / (left * ADHESION_EXPONENT * ADHESION_SPAN_S[axis]);
    out->lower.value += lower * share;
    out->lower.slope += lower * slope;
    out->upper.value += upper * share;
    out->upper.slope += upper * slope;
}

/* The resilient correction (11): the envelope widens under faults beyond the torque limit. */
static void widen(const @name@_correction *correction, bounds *out)
{
    const double tangent = tanh(correction->value);
    const double size = fabs(tangent);
    const double slope = ((1.0 - (tangent * tangent)) * correction->slope) * sign_of(tangent);
    const double upper = (tangent >= 0.0) ? TOWARD_WIDTH : AWAY_WIDTH;
    const double lower = (tangent >= 0.0) ? AWAY_WIDTH : TOWARD_WIDTH;
    out->upper.value += upper * size;
    out->upper.slope += upper * slope;
    out->lower.value -= lower * size;
    out->lower.slope -= lower * slope;
}

/* The bounds of an axis. */
static bounds envelope(int axis, double time_s, double initial, const @name@_correction *correction)
{
    const double side = (ONE_SIDED != 0) ? sign_of(initial) : 0.0;
    level first;
    bounds out = basic(performance(axis, time_s), side);
    first.value = INITIAL_LEVEL;
    first.slope = 0.0;
    adhere(axis, time_s, initial, basic(first, side), &out);
    if (RESILIENT != 0) {
        widen(correction, &out);
    }
    return out;
}

/* The correction after an interval (s). */
static void advance_correction(@name@_correction *correction, double interval_s)
{
    if (RESILIENT != 0) {
        const double decay = CORRECTION_DECAY_PER_S / (fabs(correction->value) + CORRECTION_DECAY_SIZE);
        correction->value = (correction->value + (interval_s * correction->drive)) / (1.0 + (interval_s * decay));
    }
}

/* What moves the correction, from a fault (N m) beyond the authority of the actuators (N m). */
static void drive_correction(@name@_correction *correction, double fault, double authority, double rate)
{
    if (RESILIENT != 0) {
        const double excess = fabs(fault) - authority;
        const double size = fabs(correction->value) + CORRECTION_DECAY_SIZE;
        correction->drive =
            (excess > 0.0) ? (((FAULT_GAIN * sign_of(fault)) * excess) + (FAULT_RATE_GAIN * rate)) : 0.0;
        correction->slope = correction->drive - ((CORRECTION_DECAY_PER_S * correction->value) / size);
    }
}

static transformed_error transform(double error, double rate, bounds within)
{
    const double edge = 1e-6 * (within.upper.value - within.lower.value);
    const double above = error - within.lower.value;
    const double below = within.upper.value - error;
    const double far_above = larger(above, edge);
    const double far_below = larger(below, edge);
    transformed_error out;
    out.value = log(far_above / far_below);
    out.slope = 0.0;
    if ((above > 0.0) && (below > 0.0)) {
        out.slope = ((rate - within.lower.slope) / far_above) - ((within.upper.slope - rate) / far_below);
    }
    return out;
}

/* The estimate of the torque (N m) that the nominal model does not explain, after an interval with a torque (N m). */
static void estimate_fault(@name@_controller *next, const double rate[3], double seconds, const double torque[3])
{
    double momentum[3];
    double before[3];
    double middle[3];
    double spin[3];
    double gyroscopic[3];
    int axis;
    momentum_of(rate, momentum);
    for (axis = 0; axis < 3; ++axis) {
        middle[axis] = (rate[axis] + next->last_rate[axis]) * 0.5;
    }
    if ((ESTIMATION == 1) && (next->has_time != 0U)) {
        const double share = -expm1(-seconds / TIME_CONSTANT_S);
        momentum_of(next->last_rate, before);
        momentum_of(middle, spin);
        cross(middle, spin, gyroscopic);
        for (axis = 0; axis < 3; ++axis) {
            const double change = (momentum[axis] - before[axis]) / seconds;
            next->fault[axis] += (((change + gyroscopic[axis]) - torque[axis]) - next->fault[axis]) * share;
        }
    } else if ((ESTIMATION == 2) && (next->has_time != 0U)) {
        const double pole = exp(-BANDWIDTH_RAD_S * seconds);
        momentum_of(next->last_rate, before);
        cross(next->last_rate, before, gyroscopic);
        for (axis = 0; axis < 3; ++axis) {
            const double acting = (torque[axis] - gyroscopic[axis]) + next->fault[axis];
            const double predicted = next->momentum[axis] + (acting * seconds);
            const double innovation = momentum[axis] - predicted;
            next->momentum[axis] = predicted + (innovation * (1.0 - (pole * pole)));
            next->fault[axis] += innovation * (((1.0 - pole) * (1.0 - pole)) / seconds);
        }
    } else {
        for (axis = 0; axis < 3; ++axis) {
            next->momentum[axis] = momentum[axis];
        }
    }
    for (axis = 0; axis < 3; ++axis) {
        next->last_rate[axis] = rate[axis];
    }
}

/* Law (20): the torque about the body axes (N m). */
static void law(
    const transformed_error errors[3], const double rate[3], const double fault[3], double sliding[3], double torque[3])
{
    double momentum[3];
    double gyroscopic[3];
    double along[3];
    double pushed[3];
    int axis;
    momentum_of(rate, momentum);
    cross(rate, momentum, gyroscopic);
    for (axis = 0; axis < 3; ++axis) {
        const double slope = pow(fabs(errors[axis].value), SURFACE_EXPONENT - 1.0) * errors[axis].slope;
        sliding[axis] = (SURFACE_GAIN * signed_power(errors[axis].value, SURFACE_EXPONENT)) + rate[axis];
        along[axis] = (SURFACE_GAIN * SURFACE_EXPONENT) * slope;
    }
    momentum_of(along, pushed);
    for (axis = 0; axis < 3; ++axis) {
        double reaching = 0.0;
        if (!(fabs(sliding[axis]) < DEAD_ZONE_RAD_S[axis])) {
            reaching = (LINEAR_GAIN * sliding[axis]) + (POWER_GAIN * signed_power(sliding[axis], POWER_EXPONENT));
        }
        torque[axis] = ((gyroscopic[axis] - pushed[axis]) - fault[axis]) - reaching;
    }
}

/* The attitude of this sample with the sign that continues the last one; at the first sample the shortest rotation. */
static void read_attitude(@name@_controller *next, double time_s, double seconds, const double measured[4])
{
    double error[4];
    double along;
    int part;
    int axis;
    normalise(measured, error);
    along = (next->has_time == 0U)
                ? error[0]
                : ((next->attitude[0] * error[0]) + sum_of_products(&next->attitude[1], &error[1], 3));
    for (part = 0; part < 4; ++part) {
        next->attitude[part] = (along < 0.0) ? -error[part] : error[part];
    }
    for (axis = 0; axis < 3; ++axis) {
        if (next->has_time == 0U) {
            next->initial[axis] = next->attitude[1 + axis];
        } else {
            advance_correction(&next->correction[axis], seconds);
        }
    }
    if (next->has_time == 0U) {
        next->start_s = time_s;
    }
}

/* The command of the actuators for a torque about the body axes. */
static void allocate(const double torque[3], double command[3])
{
    int actuator;
    for (actuator = 0; actuator < 3; ++actuator) {
        command[actuator] = sum_of_products(ALLOCATION[actuator], torque, 3);
    }
}

static int is_nan_among(const double values[3])
{
    return ((isnan(values[0]) != 0) || (isnan(values[1]) != 0) || (isnan(values[2]) != 0)) ? 1 : 0;
}

static @name@_status advance(
    @name@_controller *self, double time_s, const double measured[4], const double rate_rad_s[3], uint8_t *sent)
{
    @name@_controller next;
    transformed_error errors[3];
    double change[4];
    double acting[3];
    double sliding[3];
    double torque[3];
    const double seconds = (self->has_time != 0U) ? (time_s - self->time_s) : 0.0;
    int axis;
    next = *self;
    read_attitude(&next, time_s, seconds, measured);
    for (axis = 0; axis < 3; ++axis) {
        acting[axis] = sum_of_products(ACTUATORS[axis], self->command, 3);
    }
    estimate_fault(&next, rate_rad_s, seconds, acting);
    derivative(next.attitude, rate_rad_s, change);
    for (axis = 0; axis < 3; ++axis) {
        bounds within;
        drive_correction(&next.correction[axis], next.fault[axis], AUTHORITY[axis], change[1 + axis]);
        within = envelope(axis, time_s - next.start_s, next.initial[axis], &next.correction[axis]);
        errors[axis] = transform(next.attitude[1 + axis], change[1 + axis], within);
    }
    law(errors, rate_rad_s, next.fault, sliding, torque);
    allocate(torque, next.command);
    /* A number that is not finite must not be hidden by the saturation. */
    if ((all_finite(next.fault, 3) == 0) || (all_finite(sliding, 3) == 0) ||
        (is_nan_among(next.command) != 0)) {
        return @NAME@_HELD_OVERFLOW;
    }
    saturate(next.command);
    next.time_s = time_s;
    next.has_time = 1U;
    *self = next;
    *sent = 1U;
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
        self->initial[axis] = 0.0;
        self->attitude[1 + axis] = 0.0;
        self->correction[axis].value = 0.0;
        self->correction[axis].slope = 0.0;
        self->correction[axis].drive = 0.0;
        self->fault[axis] = 0.0;
        self->last_rate[axis] = 0.0;
        self->momentum[axis] = 0.0;
    }
    self->attitude[0] = 1.0;
    self->start_s = 0.0;
    self->time_s = 0.0;
    self->has_time = 0U;
}

void @name@_set_fault(@name@_controller *self, const double fault_nm[3])
{
    int axis;
    if ((self == NULL) || (fault_nm == NULL) || (all_finite(fault_nm, 3) == 0)) {
        return;
    }
    for (axis = 0; axis < 3; ++axis) {
        self->fault[axis] = fault_nm[axis];
    }
}
