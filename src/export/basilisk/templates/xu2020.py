

# Law (12) and trigger (10) of Xu and Huang, "Robust Fuzzy Attitude Stabilization of Networked Spacecraft
# under Actuator Saturation and Persistent Disturbance" (2020). The state x is the rate error (rad/s), then
# the vector part of the error quaternion with a scalar part that is not negative.


def law_memory():
    """What the law remembers between samples, before the first."""
    return {
        "threshold": THRESHOLD_MINIMUM,
        "sent_state": np.zeros(6),
        "sent_form": 0.0,
        "any_sent": 0,
    }


@nb.njit
def quadratic_form(x):
    """x' W x of the trigger's weight W."""
    value = 0.0
    for row in range(6):
        product = TRIGGER_WEIGHT[row, 0] * x[0]
        for column in range(1, 6):
            product += TRIGGER_WEIGHT[row, column] * x[column]
        value += product * x[row]
    return value


@nb.njit
def scheduling_variables(x):
    """The rates (rad/s) and the scalar part of the state."""
    square = x[3] * x[3] + x[4] * x[4] + x[5] * x[5]
    return (x[0], x[1], x[2], math.sqrt(max(1.0 - square, 0.0)))


@nb.njit
def in_box(x):
    """Whether the state is in the box of the model."""
    if x[3] * x[3] + x[4] * x[4] + x[5] * x[5] > 1.0:
        return False
    variables = scheduling_variables(x)
    for index in range(4):
        value = variables[index]
        if not (BOX_LOWER[index] <= value and value <= BOX_UPPER[index]):
            return False
    return True


@nb.njit
def rule_weight(rule, x):
    """Weight of a rule: bit k of its index is set when variable k is at its upper bound there. A single
    rule has the weight 1."""
    if GAINS.shape[0] == 1:
        return 1.0
    variables = scheduling_variables(x)
    weight = 1.0
    for index in range(4):
        width = BOX_UPPER[index] - BOX_LOWER[index]
        fraction = min(max((variables[index] - BOX_LOWER[index]) / width, 0.0), 1.0)
        weight *= fraction if (rule >> index) & 1 == 1 else 1.0 - fraction
    return weight


@nb.njit
def unsaturated_torque(x):
    """Torque that the law asks for at the sent state, N m."""
    torque = np.zeros(3)
    for rule in range(GAINS.shape[0]):
        weight = rule_weight(rule, x)
        for axis in range(3):
            product = GAINS[rule, axis, 0] * x[0]
            for column in range(1, 6):
                product += GAINS[rule, axis, column] * x[column]
            torque[axis] += product * weight
    return torque


@nb.njit
def next_threshold(threshold, step):
    """Threshold after a trigger at which the sent state moved by `step`."""
    if not ADAPTIVE:
        return threshold
    angle = math.atan(ADAPTATION_SLOPE * (step - ADAPTATION_DEAD_BAND))
    value = threshold * (1.0 - (2.0 * ADAPTATION_AMPLITUDE / math.pi) * angle)
    if not value >= THRESHOLD_MINIMUM:
        return THRESHOLD_MINIMUM
    return min(value, THRESHOLD_MAXIMUM)


@nb.njit
def record_sent(memory, x):
    """Makes x the state sent last and moves the threshold."""
    if memory.any_sent == 1:
        square = 0.0
        for index in range(6):
            step = x[index] - memory.sent_state[index]
            square += step * step
        memory.threshold = next_threshold(memory.threshold, math.sqrt(square))
    for index in range(6):
        memory.sent_state[index] = x[index]
    memory.sent_form = quadratic_form(x)
    memory.any_sent = 1


@nb.njit
def fires(memory, x):
    """Whether the state must be sent, and whether that could be computed."""
    if memory.any_sent == 0:
        return True, math.isfinite(quadratic_form(x))
    error = np.empty(6)
    for index in range(6):
        error[index] = x[index] - memory.sent_state[index]
    form = quadratic_form(error)
    return form >= memory.threshold * memory.sent_form + TRIGGER_FLOOR, math.isfinite(form)


@nb.njit
def law_step(memory, interval_s, time_s, error, rate, desired_rate, desired_acceleration):
    """Takes a sample; returns HELD, SILENT or SENT."""
    q = vector_part(shortest(error))
    x = np.array((rate[0], rate[1], rate[2], q[0], q[1], q[2]))
    sent, computed = fires(memory, x)
    if not computed:
        return HELD
    if sent:
        torque = unsaturated_torque(x)
        if not all_finite(torque):
            return HELD
        for axis in range(3):
            memory.torque[axis] = saturate(torque[axis], TORQUE_LIMIT_NM[axis])
        record_sent(memory, x)
    if HAS_BOX and not in_box(x):
        memory.samples_outside += 1
    return SENT if sent else SILENT
