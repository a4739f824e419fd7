

def fresh_memory():
    """The memory before the first sample."""
    memory = {
        "samples": 0,
        "samples_used": 0,
        "samples_held": 0,
        "samples_late": 0,
        "samples_outside": 0,
        "messages": 0,
        "last_time_s": 0.0,
        "last_error": np.zeros(4),
        "torque": np.zeros(3),
    }
    memory.update(law_memory())
    return memory


@nb.njit
def take_sample(memory, time_s, error, rate, desired_rate, desired_acceleration):
    """Takes the sample at `time_s` (s): the error quaternion, the rate error (rad/s), the desired rate
    (rad/s) and its derivative (rad/s^2), all in body axes. What cannot be used leaves the torque as it is."""
    memory.samples += 1
    late = False
    interval_s = 0.0
    if memory.samples_used > 0:
        interval_s = time_s - memory.last_time_s
        # Both ends carry two roundings each.
        late = interval_s - LONGEST_INTERVAL_S > 4.0 * 2.220446049250313e-16 * abs(time_s)
    outside_before = memory.samples_outside
    outcome = HELD
    usable = all_finite(error) and all_finite(rate)
    usable = usable and all_finite(desired_rate) and all_finite(desired_acceleration)
    if usable and (memory.samples_used == 0 or interval_s > 0.0):
        outcome = law_step(memory, interval_s, time_s, error, rate, desired_rate, desired_acceleration)
    if outcome == HELD:
        memory.samples_held += 1
        return
    memory.samples_used += 1
    memory.last_time_s = time_s
    if late and memory.samples_outside == outside_before:
        memory.samples_late += 1
    if outcome == SENT:
        memory.messages += 1


@nb.njit
def triple(values):
    """The first three numbers of an array."""
    return (values[0], values[1], values[2])


class @name@(NumbaModel):
    """The controller as a module of Basilisk.

    Subscribe exactly one of these inputs:
      scStateInMsg   SCStatesMsg: sigma_BN, omega_BN_B; the desired attitude is fixed
      attNavInMsg    NavAttMsg: the same
      guidInMsg      AttGuidMsg: sigma_BR, omega_BR_B (and omega_RN_B, domega_RN_B where the law uses them)

    Outputs, written at every update:
      cmdTorqueOutMsg       CmdTorqueBodyMsg: torque about the body axes, N m
      rwMotorTorqueOutMsg   ArrayMotorTorqueMsg: motor torques, N m, after `set_wheels`; zero otherwise

    Every update is a sample. Counters after a run: `messages`, `samples`, `held_samples` (not used),
    `late_samples` (longer after the last than the design allows), `outside_samples` (of the design's box or
    the law's envelope; these are not counted as late too).
    """

    def __init__(self):
        super().__init__()
        self.ModelTag = "@name@"
        self.scStateInMsg = messaging.SCStatesMsgReader()
        self.attNavInMsg = messaging.NavAttMsgReader()
        self.guidInMsg = messaging.AttGuidMsgReader()
        self.cmdTorqueOutMsg = messaging.CmdTorqueBodyMsg()
        self.rwMotorTorqueOutMsg = messaging.ArrayMotorTorqueMsg()
        setattr(self.memory, SOURCE_FIELD, 0)
        self.memory.desired = np.array([1.0, 0.0, 0.0, 0.0])
        self.memory.wheel_count = 0
        self.memory.wheel_matrix = np.zeros((messaging.MAX_EFF_CNT, 3))
        self._start_anew()

    def set_desired_attitude(self, sigma_RN):
        """Fixed desired attitude, as modified Rodrigues parameters with respect to the inertial frame. For
        scStateInMsg and attNavInMsg."""
        sigma = tuple(float(value) for value in sigma_RN)
        self.memory.desired = np.array(quaternion_of_mrp.py_func(sigma))

    def set_wheels(self, spin_axes_B):
        """Wheels whose spin axes in body axes are the columns (3 x n). Their motors then get the torques of
        least norm that turn the body as commanded."""
        axes = np.asarray(spin_axes_B, dtype=float)
        matrix = np.zeros((messaging.MAX_EFF_CNT, 3))
        matrix[: axes.shape[1]] = -np.linalg.pinv(axes)
        self.memory.wheel_matrix = matrix
        self.memory.wheel_count = axes.shape[1]

    def Reset(self, CurrentSimNanos=0):
        """Back to before the first sample, with zero torque."""
        inputs = (self.scStateInMsg, self.attNavInMsg, self.guidInMsg)
        if sum(bool(reader.isLinked()) for reader in inputs) != 1:
            raise RuntimeError("@name@: subscribe exactly one of scStateInMsg, attNavInMsg, guidInMsg")
        self._start_anew()
        super().Reset(CurrentSimNanos)

    def _start_anew(self):
        for field, value in fresh_memory().items():
            setattr(self.memory, field, value)

    @property
    def messages(self):
        """Messages sent."""
        return int(self.memory.messages)

    @property
    def samples(self):
        """Samples taken, the held ones included."""
        return int(self.memory.samples)

    @property
    def held_samples(self):
        """Samples that could not be used: the last torque was held."""
        return int(self.memory.samples_held)

    @property
    def late_samples(self):
        """Used samples that came later after the one before than the design allows, but were not outside."""
        return int(self.memory.samples_late)

    @property
    def outside_samples(self):
        """Used samples outside of the box of the design, or of the envelope of the law."""
        return int(self.memory.samples_outside)

    @staticmethod
    def UpdateStateImpl(
        CurrentSimNanos,
        scStateInMsgPayload,
        scStateInMsgIsLinked,
        attNavInMsgPayload,
        attNavInMsgIsLinked,
        guidInMsgPayload,
        guidInMsgIsLinked,
        cmdTorqueOutMsgPayload,
        rwMotorTorqueOutMsgPayload,
        memory,
    ):
        """One sample; compiled by numba."""
        time_s = CurrentSimNanos / 1e9
        desired_rate = (0.0, 0.0, 0.0)
        desired_acceleration = (0.0, 0.0, 0.0)
        if guidInMsgIsLinked:
            error = quaternion_of_mrp(guidInMsgPayload.sigma_BR)
            rate = triple(guidInMsgPayload.omega_BR_B)
            desired_rate = triple(guidInMsgPayload.omega_RN_B)
            desired_acceleration = triple(guidInMsgPayload.domega_RN_B)
        elif attNavInMsgIsLinked:
            error = error_quaternion(memory.desired, quaternion_of_mrp(attNavInMsgPayload.sigma_BN))
            rate = triple(attNavInMsgPayload.omega_BN_B)
        else:
            error = error_quaternion(memory.desired, quaternion_of_mrp(scStateInMsgPayload.sigma_BN))
            rate = triple(scStateInMsgPayload.omega_BN_B)
        take_sample(memory, time_s, error, rate, desired_rate, desired_acceleration)
        for axis in range(3):
            cmdTorqueOutMsgPayload.torqueRequestBody[axis] = memory.torque[axis]
        for wheel in range(memory.wheel_count):
            motor = memory.wheel_matrix[wheel]
            torque = motor[0] * memory.torque[0] + motor[1] * memory.torque[1] + motor[2] * memory.torque[2]
            rwMotorTorqueOutMsgPayload.motorTorque[wheel] = torque
