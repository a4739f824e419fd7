

# Law (20) inside of the envelope (10)-(12) of Yang, Yang, Ji, Wang and Ma, "z-Ary compression event-triggered
# control for spacecraft with adhesive-resilient prescribed performance", Mathematics 13 (2025) 386, with
# three corrections: the denominator of (9), the resilient correction acting outwards, and p/q above 1 in (16).
# The envelope's time counts from the first usable sample. The command is computed and sent at every sample.

# Closest the error counts to a bound, as a share of the envelope's width.
EDGE = 1e-6


def performance_coefficients(axis):
    """z1 to z4 of (8), from its four boundary conditions."""
    if not APPOINTED[axis]:
        return [0.0, 0.0, 0.0, 0.0]
    turns = RATE_PER_S[axis] * APPOINTED_TIME_S[axis]
    ratio = turns / (0.5 * math.pi)
    cosecant = 1.0 / math.sinh(turns + OFFSET[axis])
    cotangent = 1.0 / math.tanh(turns + OFFSET[axis])
    start = math.sinh(OFFSET[axis])
    cosine = ratio * cotangent * cosecant
    sine = ratio * ratio * (2.0 * cotangent * cotangent - 1.0) * cosecant
    fall = LEVEL_INITIAL[axis] - LEVEL_FINAL[axis]
    z4 = fall * start / (1.0 - start * (sine + cosine + cosecant))
    z2, z3 = sine * z4, -cosine * z4
    return [LEVEL_INITIAL[axis] - z4 / start - z3, z2, z3, z4]


def pseudo_inverse():
    """D0' (D0 D0')^-1 of the actuator matrix D0 (3 x M)."""
    m = np.array([[sum(a * b for a, b in zip(row, other)) for other in ACTUATOR_MATRIX] for row in ACTUATOR_MATRIX])
    cofactors = np.array(
        [
            [
                m[1, 1] * m[2, 2] - m[2, 1] * m[1, 2],
                m[0, 2] * m[2, 1] - m[2, 2] * m[0, 1],
                m[0, 1] * m[1, 2] - m[1, 1] * m[0, 2],
            ],
            [
                -(m[1, 0] * m[2, 2] - m[2, 0] * m[1, 2]),
                m[0, 0] * m[2, 2] - m[2, 0] * m[0, 2],
                m[0, 2] * m[1, 0] - m[1, 2] * m[0, 0],
            ],
            [
                m[1, 0] * m[2, 1] - m[2, 0] * m[1, 1],
                m[0, 1] * m[2, 0] - m[2, 1] * m[0, 0],
                m[0, 0] * m[1, 1] - m[1, 0] * m[0, 1],
            ],
        ]
    )
    determinant = m[0, 0] * cofactors[0, 0] + m[0, 1] * cofactors[1, 0] + m[0, 2] * cofactors[2, 0]
    inverse = cofactors / determinant
    columns = range(inverse.shape[1])
    return np.array([[sum(a[k] * inverse[k, j] for k in range(3)) for j in columns] for a in ACTUATOR_MATRIX.T])


def torque_authority():
    """Largest torque about each body axis alone, N m, that no actuator saturates at."""
    out = [math.inf] * 3
    for axis in range(3):
        for share, limit in zip(np.abs(ACTUATOR_INVERSE[:, axis]), TORQUE_LIMIT_NM):
            if share > 0.0:
                out[axis] = min(out[axis], limit / share)
    return np.array(out)


COEFFICIENTS = np.array([performance_coefficients(axis) for axis in range(3)])
ACTUATOR_INVERSE = pseudo_inverse()
AUTHORITY_NM = torque_authority()
ACTUATORS = ACTUATOR_MATRIX.shape[1]


def law_memory():
    """What the law remembers between samples, before the first."""
    return {
        "began_s": 0.0,
        "initial_error": np.zeros(3),
        "correction": np.zeros(3),
        "correction_drive": np.zeros(3),
        "command": np.zeros(ACTUATORS),
        "fault": np.zeros(3),
        "last_rate": np.zeros(3),
        "momentum": np.zeros(3),
        "lower": np.zeros(3),
        "upper": np.zeros(3),
        "sliding": np.zeros(3),
    }


# A level is a pair: its value and its slope (1/s).


@nb.njit
def performance(axis, elapsed_s):
    """rho and its slope."""
    rate = RATE_PER_S[axis]
    if not APPOINTED[axis]:
        share = (LEVEL_INITIAL[axis] - LEVEL_FINAL[axis]) * math.exp(-rate * elapsed_s)
        return share + LEVEL_FINAL[axis], -rate * share
    if elapsed_s >= APPOINTED_TIME_S[axis]:
        return LEVEL_FINAL[axis], 0.0
    z1, z2, z3, z4 = COEFFICIENTS[axis, 0], COEFFICIENTS[axis, 1], COEFFICIENTS[axis, 2], COEFFICIENTS[axis, 3]
    pace = 0.5 * math.pi / APPOINTED_TIME_S[axis]
    sine, cosine = math.sin(pace * elapsed_s), math.cos(pace * elapsed_s)
    argument = rate * elapsed_s + OFFSET[axis]
    cosecant, cotangent = 1.0 / math.sinh(argument), 1.0 / math.tanh(argument)
    value = z1 + z2 * sine + z3 * cosine + z4 * cosecant
    slope = pace * (z2 * cosine - z3 * sine) - z4 * rate * cotangent * cosecant
    return value, slope


@nb.njit
def basic_bounds(axis, value, slope, side):
    """(10) without its corrections: lower and upper level where rho has this value and slope."""
    shape, settled = SHAPE[axis], side * LEVEL_FINAL[axis]
    lower = (-(shape - side) * value - settled, -(shape - side) * slope)
    upper = ((shape + side) * value - settled, (shape + side) * slope)
    return lower, upper


@nb.njit
def adhesive_bounds(axis, elapsed_s, initial_error, side, lower, upper):
    """The bounds with the adhesive terms (12)."""
    if not ADHESION[axis] or elapsed_s >= ADHESION_SPAN_S[axis]:
        return lower, upper
    start_lower, start_upper = basic_bounds(axis, LEVEL_INITIAL[axis], 0.0, side)
    r1, r2 = -start_lower[0], start_upper[0]
    width, exponent, span_s = ADHESION_WIDTH[axis], ADHESION_EXPONENT[axis], ADHESION_SPAN_S[axis]
    below = initial_error - 0.5 * (width * r2 + (width - 2.0) * r1)
    above = initial_error + 0.5 * ((width - 2.0) * r2 + width * r1)
    left = 1.0 - elapsed_s / span_s
    share = math.pow(left, 1.0 / exponent)
    slope = -share / (left * exponent * span_s)
    lower = (lower[0] + below * share, lower[1] + below * slope)
    upper = (upper[0] + above * share, upper[1] + above * slope)
    return lower, upper


@nb.njit
def resilient_bounds(axis, correction, correction_slope, lower, upper):
    """The bounds with the resilient correction (11), which moves them outwards."""
    if not RESILIENCE[axis]:
        return lower, upper
    tangent = math.tanh(correction)
    size = abs(tangent)
    slope = (1.0 - tangent * tangent) * correction_slope * sign(tangent)
    up, down = TOWARD_WIDTH[axis], AWAY_WIDTH[axis]
    if not tangent >= 0.0:
        up, down = down, up
    lower = (lower[0] - down * size, lower[1] - down * slope)
    upper = (upper[0] + up * size, upper[1] + up * slope)
    return lower, upper


@nb.njit
def envelope(axis, elapsed_s, initial_error, correction, correction_slope):
    """Lower and upper level of the error's component."""
    side = sign(initial_error) if ONE_SIDED[axis] else 0.0
    value, slope = performance(axis, elapsed_s)
    lower, upper = basic_bounds(axis, value, slope, side)
    lower, upper = adhesive_bounds(axis, elapsed_s, initial_error, side, lower, upper)
    return resilient_bounds(axis, correction, correction_slope, lower, upper)


@nb.njit
def advanced_correction(axis, correction, drive, interval_s):
    """mu of (11) after an interval (s) under its drive (1/s). The decay is taken at the end of the interval."""
    if not RESILIENCE[axis]:
        return correction
    decay = DECAY_PER_S[axis] / (abs(correction) + DECAY_SIZE[axis])
    return (correction + interval_s * drive) / (1.0 + interval_s * decay)


@nb.njit
def correction_drive(axis, correction, fault, rate):
    """Drive and slope (1/s) of mu, for the estimated fault (N m) and the rate of the error (1/s)."""
    if not RESILIENCE[axis]:
        return 0.0, 0.0
    excess = abs(fault) - AUTHORITY_NM[axis]
    drive = 0.0
    if excess > 0.0:
        drive = FAULT_GAIN[axis] * sign(fault) * excess + RATE_GAIN[axis] * rate
    size = abs(correction) + DECAY_SIZE[axis]
    return drive, drive - DECAY_PER_S[axis] * correction / size


@nb.njit
def transformed_error(error, rate, lower, upper):
    """(14) and (15): the error without bounds, its slope (1/s), and whether it was between the bounds."""
    edge = EDGE * (upper[0] - lower[0])
    above, below = error - lower[0], upper[0] - error
    inside = above > 0.0 and below > 0.0
    above, below = max(above, edge), max(below, edge)
    slope = 0.0
    if inside:
        slope = (rate - lower[1]) / above - (upper[1] - rate) / below
    return math.log(above / below), slope, inside


@nb.njit
def actuator_torque(command):
    """Nominal torque about the body axes of the commands, N m."""
    out = np.zeros(3)
    for actuator in range(ACTUATORS):
        for axis in range(3):
            out[axis] += ACTUATOR_MATRIX[axis, actuator] * command[actuator]
    return (out[0], out[1], out[2])


@nb.njit
def estimated_fault(memory, interval_s, rate):
    """The lumped fault (N m) and the observer's angular momentum (N m s) after a sample of the rate."""
    momentum = times(NOMINAL_INERTIA_KG_M2, rate)
    fault = (memory.fault[0], memory.fault[1], memory.fault[2])
    if memory.samples_used == 0:
        return fault, momentum
    last = (memory.last_rate[0], memory.last_rate[1], memory.last_rate[2])
    nominal = actuator_torque(memory.command)
    if FAULT_TIME_CONSTANT_S > 0.0:
        middle = scale(add(rate, last), 0.5)
        change = subtract(momentum, times(NOMINAL_INERTIA_KG_M2, last))
        change = (change[0] / interval_s, change[1] / interval_s, change[2] / interval_s)
        torque = add(change, cross(middle, times(NOMINAL_INERTIA_KG_M2, middle)))
        torque = subtract(torque, nominal)
        share = -math.expm1(-interval_s / FAULT_TIME_CONSTANT_S)
        return add(fault, scale(subtract(torque, fault), share)), momentum
    if FAULT_BANDWIDTH_RAD_S > 0.0:
        gyroscopic = cross(last, times(NOMINAL_INERTIA_KG_M2, last))
        acting = add(subtract(nominal, gyroscopic), fault)
        before = (memory.momentum[0], memory.momentum[1], memory.momentum[2])
        predicted = add(before, scale(acting, interval_s))
        innovation = subtract(momentum, predicted)
        pole = math.exp(-FAULT_BANDWIDTH_RAD_S * interval_s)
        gain = (1.0 - pole) * (1.0 - pole) / interval_s
        corrected = add(predicted, scale(innovation, 1.0 - pole * pole))
        return add(fault, scale(innovation, gain)), corrected
    return fault, momentum


@nb.njit
def signed_power(value, exponent):
    """sig(value)^exponent."""
    return sign(value) * math.pow(abs(value), exponent)


@nb.njit
def reaching(value, zone):
    """The part of the torque (N m) that drives the sliding variable (rad/s) to its dead zone."""
    if abs(value) < zone:
        return 0.0
    return LINEAR_GAIN * value + POWER_GAIN * signed_power(value, POWER_EXPONENT)


@nb.njit
def along_surface(value, slope):
    """Time derivative of the attitude's part of the sliding variable, rad/s^2."""
    power = math.pow(abs(value), SURFACE_EXPONENT - 1.0) * slope
    return SURFACE_GAIN_RAD_S * SURFACE_EXPONENT * power


@nb.njit
def law_torque(values, slopes, sliding, rate_error, rate, desired_rate, desired_acceleration, fault):
    """(20): torque about the body axes, N m, not limited."""
    surface = (
        along_surface(values[0], slopes[0]),
        along_surface(values[1], slopes[1]),
        along_surface(values[2], slopes[2]),
    )
    transport = subtract(cross(rate_error, desired_rate), desired_acceleration)
    gyroscopic = cross(rate, times(NOMINAL_INERTIA_KG_M2, rate))
    torque = subtract(gyroscopic, times(NOMINAL_INERTIA_KG_M2, add(transport, surface)))
    torque = subtract(torque, fault)
    reach = (
        reaching(sliding[0], DEAD_ZONE_RAD_S[0]),
        reaching(sliding[1], DEAD_ZONE_RAD_S[1]),
        reaching(sliding[2], DEAD_ZONE_RAD_S[2]),
    )
    return subtract(torque, reach)


@nb.njit
def actuator_commands(torque):
    """The commands of least norm that give the torque, within their limits, N m."""
    out = np.empty(ACTUATORS)
    for actuator in range(ACTUATORS):
        row = ACTUATOR_INVERSE[actuator]
        value = row[0] * torque[0] + row[1] * torque[1] + row[2] * torque[2]
        out[actuator] = saturate(value, TORQUE_LIMIT_NM[actuator])
    return out


@nb.njit
def law_step(memory, interval_s, time_s, error, rate_error, desired_rate, desired_acceleration):
    """Takes a sample; returns HELD or SENT."""
    first = memory.samples_used == 0
    unit = normalised(error)
    unit = shortest(unit) if first else continuing(memory, unit)
    rate = add(rate_error, desired_rate)
    fault, momentum = estimated_fault(memory, interval_s, rate)
    rates = vector_part(quaternion_slope(unit, rate_error))
    began_s = time_s if first else memory.began_s
    values, slopes, lower, upper = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    corrections, drives = np.empty(3), np.empty(3)
    outside = False
    for axis in range(3):
        q, correction = unit[axis + 1], memory.correction[axis]
        if not first:
            correction = advanced_correction(axis, correction, memory.correction_drive[axis], interval_s)
        drive, correction_slope = correction_drive(axis, correction, fault[axis], rates[axis])
        initial = q if first else memory.initial_error[axis]
        low, high = envelope(axis, time_s - began_s, initial, correction, correction_slope)
        values[axis], slopes[axis], inside = transformed_error(q, rates[axis], low, high)
        outside = outside or not inside
        corrections[axis], drives[axis], lower[axis], upper[axis] = correction, drive, low[0], high[0]
    sliding = (
        SURFACE_GAIN_RAD_S * signed_power(values[0], SURFACE_EXPONENT) + rate_error[0],
        SURFACE_GAIN_RAD_S * signed_power(values[1], SURFACE_EXPONENT) + rate_error[1],
        SURFACE_GAIN_RAD_S * signed_power(values[2], SURFACE_EXPONENT) + rate_error[2],
    )
    torque = law_torque(values, slopes, sliding, rate_error, rate, desired_rate, desired_acceleration, fault)
    command = actuator_commands(torque)
    if not (all_finite(command) and all_finite(fault) and all_finite(sliding)):
        return HELD
    given = actuator_torque(command)
    for actuator in range(ACTUATORS):
        memory.command[actuator] = command[actuator]
    for axis in range(3):
        if first:
            memory.initial_error[axis] = unit[axis + 1]
        memory.correction[axis], memory.correction_drive[axis] = corrections[axis], drives[axis]
        memory.fault[axis], memory.momentum[axis] = fault[axis], momentum[axis]
        memory.last_rate[axis], memory.torque[axis] = rate[axis], given[axis]
        memory.lower[axis], memory.upper[axis], memory.sliding[axis] = lower[axis], upper[axis], sliding[axis]
    for index in range(4):
        memory.last_error[index] = unit[index]
    memory.began_s = began_s
    if outside:
        memory.samples_outside += 1
    return SENT
