

# Law (12) with triggers (6) and (8) of Lei, Meng, Wang, Wang and Jin, "Event-triggered intermittent prescribed
# performance control for spacecraft attitude reorientation" (2022). The manoeuvre, with its funnel, starts
# at the first usable sample. Made for a fixed desired attitude.

# Share of the longest on-time by which turning off may come early, so that rounding of the sampling instants
# does not make it late by a whole sample.
TIME_ROUNDING = 1e-9


def law_memory():
    """What the law remembers between samples, before the first."""
    return {
        "start_s": 0.0,
        "on": 0,
        "on_since_s": 0.0,
        "side": 0,
        "times_on": 0,
        "times_off": 0,
    }


@nb.njit
def squared_secant(value):
    """1 / cosh^2."""
    secant = 1.0 / math.cosh(value)
    return secant * secant


@nb.njit
def funnel_width(elapsed_s):
    """rho of each axis, (3)."""
    share = 0.5 * (1.0 - math.tanh((elapsed_s - MIDPOINT_S) / TIME_SCALE_S))
    return (
        WIDTH_TERMINAL[0] + (WIDTH_INITIAL[0] - WIDTH_TERMINAL[0]) * share,
        WIDTH_TERMINAL[1] + (WIDTH_INITIAL[1] - WIDTH_TERMINAL[1]) * share,
        WIDTH_TERMINAL[2] + (WIDTH_INITIAL[2] - WIDTH_TERMINAL[2]) * share,
    )


@nb.njit
def funnel_slope(elapsed_s):
    """Time derivative of rho of each axis, 1/s."""
    slope = -0.5 * squared_secant((elapsed_s - MIDPOINT_S) / TIME_SCALE_S) / TIME_SCALE_S
    return (
        (WIDTH_INITIAL[0] - WIDTH_TERMINAL[0]) * slope,
        (WIDTH_INITIAL[1] - WIDTH_TERMINAL[1]) * slope,
        (WIDTH_INITIAL[2] - WIDTH_TERMINAL[2]) * slope,
    )


@nb.njit
def divided(a, b):
    """a / b, component by component."""
    return (a[0] / b[0], a[1] / b[1], a[2] / b[2])


@nb.njit
def bounded_component(q, width):
    """A component of r: rho tanh(gamma q / rho)."""
    return width * math.tanh(VIRTUAL_SLOPE * q / width)


@nb.njit
def bounded(q, width):
    """r of the virtual law."""
    return (
        bounded_component(q[0], width[0]),
        bounded_component(q[1], width[1]),
        bounded_component(q[2], width[2]),
    )


@nb.njit
def bounded_component_slope(q, dq, width, width_slope):
    """Time derivative of a component of r, 1/s."""
    phase = q / width * VIRTUAL_SLOPE
    growth = q * width_slope / width
    moved = (dq - growth) * VIRTUAL_SLOPE
    return width_slope * math.tanh(phase) + squared_secant(phase) * moved


@nb.njit
def bounded_slope(q, dq, width, width_slope):
    """Time derivative of r, 1/s."""
    return (
        bounded_component_slope(q[0], dq[0], width[0], width_slope[0]),
        bounded_component_slope(q[1], dq[1], width[1], width_slope[1]),
        bounded_component_slope(q[2], dq[2], width[2], width_slope[2]),
    )


@nb.njit
def virtual_rate(error, width):
    """alpha of (10), rad/s."""
    q0, q = error[0], vector_part(error)
    r = bounded(q, width)
    direction = subtract(scale(r, q0 * q0), scale(cross(q, r), q0))
    direction = add(direction, scale(q, dot(q, r)))
    return scale(direction, -(VIRTUAL_GAIN * RATE_SCALE_RAD_S))


@nb.njit
def virtual_acceleration(error, rate, width, width_slope):
    """Time derivative of alpha, rad/s^2."""
    q0, q = error[0], vector_part(error)
    change = quaternion_slope(error, rate)
    dq0, dq = change[0], vector_part(change)
    r = bounded(q, width)
    dr = bounded_slope(q, dq, width, width_slope)
    direction = add(scale(r, 2.0 * q0 * dq0), scale(dr, q0 * q0))
    direction = subtract(direction, scale(cross(q, r), dq0))
    direction = subtract(direction, scale(add(cross(dq, r), cross(q, dr)), q0))
    direction = add(direction, scale(dq, dot(q, r)))
    direction = add(direction, scale(q, dot(dq, r) + dot(q, dr)))
    return scale(direction, -(VIRTUAL_GAIN * RATE_SCALE_RAD_S))


@nb.njit
def barrier_torque(error, width):
    """P_q, N m."""
    q = vector_part(error)
    transformed = divided(q, width)
    argument = dot(transformed, transformed) / BARRIER_WIDTH
    gradient = divided(scale(transformed, BARRIER_GAIN_J * math.tanh(argument)), width)
    return scale(subtract(scale(gradient, error[0]), cross(q, gradient)), 0.5)


@nb.njit
def disturbance_torque(rate_error):
    """D_m tanh(z2 / p), N m."""
    return (
        math.tanh(rate_error[0] / SMOOTHING_RAD_S) * DISTURBANCE_BOUND_NM,
        math.tanh(rate_error[1] / SMOOTHING_RAD_S) * DISTURBANCE_BOUND_NM,
        math.tanh(rate_error[2] / SMOOTHING_RAD_S) * DISTURBANCE_BOUND_NM,
    )


@nb.njit
def law_torque(elapsed_s, error, rate, rate_error):
    """u of (12), N m, before saturation."""
    width = funnel_width(elapsed_s)
    acceleration = virtual_acceleration(error, rate, width, funnel_slope(elapsed_s))
    torque = subtract(cross(rate, times(INERTIA_KG_M2, rate)), scale(rate_error, RATE_GAIN_NM_S))
    torque = add(torque, times(INERTIA_KG_M2, acceleration))
    torque = subtract(torque, disturbance_torque(rate_error))
    return subtract(torque, barrier_torque(error, width))


@nb.njit
def turns_off(memory, elapsed_s, held_error_squared):
    """Whether the actuators are turned off: (6), or on for long enough."""
    if memory.on == 0:
        return False
    allowed = HELD_ERROR_INITIAL * math.exp(-DECAY_RATE_PER_S * elapsed_s) + HELD_ERROR_TERMINAL
    longest_s = LONGEST_ON_S * (1.0 - TIME_ROUNDING)
    return held_error_squared >= allowed or elapsed_s - memory.on_since_s >= longest_s


@nb.njit
def turns_on(elapsed_s, rate_error_energy):
    """Whether idle actuators are turned on: (8) on V2 (J)."""
    decay = math.exp(-DECAY_RATE_PER_S * elapsed_s)
    envelope = (ENVELOPE_INITIAL_J - ENVELOPE_TERMINAL_J) * decay + ENVELOPE_TERMINAL_J
    return rate_error_energy >= (1.0 - RELATIVE_BUFFER) * envelope - BUFFER_J


@nb.njit
def switching(memory, elapsed_s, wanted, rate_error_energy):
    """Whether the actuators are turned off and whether they are turned on; both replace the torque."""
    if EVERY_SAMPLE:
        return False, True
    held = subtract(wanted, (memory.torque[0], memory.torque[1], memory.torque[2]))
    off = turns_off(memory, elapsed_s, dot(held, held))
    on = (off or memory.on == 0) and turns_on(elapsed_s, rate_error_energy)
    return off, on


@nb.njit
def switch(memory, elapsed_s, wanted, off, on):
    """Turns the actuators off, on, or both."""
    if off:
        memory.torque[:] = 0.0
        memory.on = 0
        memory.times_off += 1
    if on:
        for axis in range(3):
            memory.torque[axis] = wanted[axis]
        memory.on = 1
        memory.on_since_s = elapsed_s
        memory.times_on += 1


@nb.njit
def count_outside(memory, error, width):
    """Counts a sample outside of the funnel."""
    for axis in range(3):
        if not abs(error[axis + 1]) < width[axis]:
            memory.samples_outside += 1
            return


@nb.njit
def law_step(memory, interval_s, time_s, error, rate, desired_rate, desired_acceleration):
    """Takes a sample; returns HELD, SILENT or SENT."""
    continued = continuing(memory, normalised(error))
    side = positive_side(memory.side, continued[0], SIGN_HYSTERESIS)
    unit = continued if side > 0 else negated(continued)
    elapsed_s = time_s - memory.start_s if memory.samples_used > 0 else 0.0
    width = funnel_width(elapsed_s)
    rate_error = subtract(rate, virtual_rate(unit, width))
    energy = 0.5 * dot(rate_error, times(INERTIA_KG_M2, rate_error))
    torque = law_torque(elapsed_s, unit, rate, rate_error)
    if not (all_finite(rate_error) and all_finite(torque) and math.isfinite(energy)):
        return HELD
    if memory.samples_used == 0:
        memory.start_s = time_s
    memory.side = side
    for index in range(4):
        memory.last_error[index] = continued[index]
    wanted = (
        saturate(torque[0], TORQUE_LIMIT_NM[0]),
        saturate(torque[1], TORQUE_LIMIT_NM[1]),
        saturate(torque[2], TORQUE_LIMIT_NM[2]),
    )
    off, on = switching(memory, elapsed_s, wanted, energy)
    switch(memory, elapsed_s, wanted, off, on)
    count_outside(memory, unit, width)
    return SENT if off or on else SILENT
