

# Law (6) and trigger (8) of Wu, Shen and Cao, "Event-triggered attitude control of spacecraft", Advances in
# Space Research 61 (2018) 927-934: u = sat(-k s) with s = omega + beta q, held between triggers.


def law_memory():
    """What the law remembers between samples, before the first."""
    return {"sent_error": np.zeros(3), "any_sent": 0, "side": 0}


@nb.njit
def length(a):
    """Euclidean norm."""
    return math.sqrt(dot(a, a))


@nb.njit
def fires(memory, filtered):
    """Whether the filtered error (rad/s) must be sent."""
    if memory.any_sent == 0 or EVERY_SAMPLE:
        return True
    sent = memory.sent_error
    moved = subtract((sent[0], sent[1], sent[2]), filtered)
    return length(moved) >= TRIGGER_RELATIVE * length(filtered) + TRIGGER_ABSOLUTE_RAD_S


@nb.njit
def law_step(memory, interval_s, time_s, error, rate, desired_rate, desired_acceleration):
    """Takes a sample; returns HELD, SILENT or SENT."""
    error = continuing(memory, error)
    side = 1
    if SHORTEST_ROTATION:
        side = positive_side(memory.side, error[0], SIGN_HYSTERESIS)
    filtered = add(rate, scale(vector_part(error), side * ATTITUDE_WEIGHT_RAD_S))
    if not all_finite(filtered):
        return HELD
    memory.side = side
    for index in range(4):
        memory.last_error[index] = error[index]
    if not fires(memory, filtered):
        return SILENT
    for axis in range(3):
        memory.torque[axis] = saturate(filtered[axis] * -ERROR_GAIN_NM_S, TORQUE_LIMIT_NM[axis])
        memory.sent_error[axis] = filtered[axis]
    memory.any_sent = 1
    return SENT
