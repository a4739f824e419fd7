"""Flies an exported controller in Basilisk with four reaction wheels, their friction, and noise of the sensors.

Arguments: the controller's file, the design, a run of this program with the same start and sampling, the class, and a
multiple of the constant disturbance.
Prints the largest x'Ux over its proved bound, the largest |h| (N m s), disturbance (N m) and error of the measurement, the
pointing error in the end, messages and samples.
"""


from Basilisk.architecture import messaging, sysModel
from Basilisk.simulation import reactionWheelStateEffector
from Basilisk.utilities import simIncludeRW

WHEEL_INERTIA = 0.1  # kg m^2 about the spin axis
FRICTION_NM = 5e-4
AXES = np.array([[1, 1, 1], [-1, 1, 1], [1, -1, 1], [1, 1, -1]]).T / np.sqrt(3.0)


def quaternion(sigma):
    """The inverse of it."""
    square = sigma @ sigma
    return np.concatenate(([1.0 - square], 2.0 * sigma)) / (1.0 + square)


def product(p, q):
    """Hamilton's product."""
    vector = p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
    return np.concatenate(([p[0] * q[0] - p[1:] @ q[1:]], vector))


def in_ball(random):
    """A vector of norm up to 1, mostly near 1."""
    direction = random.normal(size=3)
    return direction / np.linalg.norm(direction) * random.uniform() ** 0.1


class Sensors(sysModel.SysModel):
    """Attitude and rate with errors within the bounds of the design."""

    def __init__(self, bounds):
        super().__init__()
        self.random = np.random.default_rng(1)
        self.rate_rad_s = bounds["rate_rad_s"]
        self.angle_rad = np.radians(bounds["attitude_deg"])
        self.scStateInMsg = messaging.SCStatesMsgReader()
        self.navOutMsg = messaging.NavAttMsg()

    def UpdateState(self, now):
        state = self.scStateInMsg()
        axis = in_ball(self.random)
        half = 0.5 * self.angle_rad * axis
        turn = np.concatenate(([np.sqrt(1.0 - half @ half)], half))
        payload = messaging.NavAttMsgPayload()
        payload.sigma_BN = mrp(product(quaternion(np.array(state.sigma_BN)), turn)).tolist()
        payload.omega_BN_B = (np.array(state.omega_BN_B) + self.rate_rad_s * in_ball(self.random)).tolist()
        self.navOutMsg.write(payload, now, self.moduleID)


def fly(module, name, design, start, rate, bias, interval_s):
    """The loop with wheels."""
    step = macros.sec2nano(interval_s) // SUBSTEPS
    simulation = SimulationBaseClass.SimBaseClass()
    simulation.SetProgressBar(False)
    process = simulation.CreateNewProcess("process")
    for task, period, priority in (("dynamics", step, 30), ("control", step * SUBSTEPS, 20), ("effects", step, 10)):
        process.addTask(simulation.CreateNewTask(task, period), priority)
    craft = spacecraft.Spacecraft()
    craft.hub.mHub = 1000.0
    # The design's inertia is that of everything but the wheels' spin.
    inertia = np.array(design["model"]["plant"]["exact"]["inertia_kg_m2"], dtype=float)
    craft.hub.IHubPntBc_B = (inertia + WHEEL_INERTIA * AXES @ AXES.T).tolist()
    craft.hub.sigma_BNInit = [[value] for value in mrp(start)]
    craft.hub.omega_BN_BInit = [[value] for value in rate]
    factory = simIncludeRW.rwFactory()
    for wheel, rpm in enumerate((60.0, -40.0, 30.0, 50.0)):
        factory.create(
            "custom", AXES[:, wheel].tolist(), Omega=rpm, Js=WHEEL_INERTIA, u_max=5.0, maxMomentum=50.0,
            useRWfriction=True, fCoulomb=FRICTION_NM, fStatic=FRICTION_NM, cViscous=0.0, label=f"RW{wheel}",
        )
    wheels = reactionWheelStateEffector.ReactionWheelStateEffector()
    factory.addToSpacecraft("wheels", wheels, craft)
    external = extForceTorque.ExtForceTorque()
    external.ModelTag = "external"
    external.extTorquePntB_B = [[value] for value in bias]
    craft.addDynamicEffector(external)
    sensors = Sensors(design["model"]["imperfections"]["measurement"])
    sensors.ModelTag = "sensors"
    sensors.scStateInMsg.subscribeTo(craft.scStateOutMsg)
    law = getattr(module, name)()
    law.set_wheels(AXES)
    law.attNavInMsg.subscribeTo(sensors.navOutMsg)
    wheels.rwMotorCmdInMsg.subscribeTo(law.rwMotorTorqueOutMsg)
    simulation.AddModelToTask("dynamics", craft)
    simulation.AddModelToTask("control", sensors, 20)
    simulation.AddModelToTask("control", law, 10)
    simulation.AddModelToTask("effects", wheels)
    simulation.AddModelToTask("effects", external)
    simulation.InitializeSimulation()
    return simulation, craft, law, wheels, step


def momentum(wheels, rate):
    """What the wheels hold beyond the body's own turn, body axes (N m s)."""
    speeds = np.array(wheels.rwSpeedOutMsg.read().wheelSpeeds[: AXES.shape[1]])
    return AXES @ (WHEEL_INERTIA * (speeds + AXES.T @ rate))


def main(module, design, run, name, multiple):
    with open(run) as file:
        rows = [row for row in csv.DictReader(file) if row["sample"] == "1"]
    first = rows[0]
    start = [float(first[key]) for key in ("error_q0_scalar", "error_q1", "error_q2", "error_q3")]
    rate = [float(first[f"rate_{axis}_rad_s"]) for axis in (1, 2, 3)]
    bias = multiple * np.array([2e-3, -4e-3, 3e-3])
    interval_s = float(rows[1]["time_s"]) - float(first["time_s"])
    simulation, craft, law, wheels, step = fly(module, name, design, start, rate, bias, interval_s)
    lyapunov = np.array(design["certificate"]["lyapunov"])
    ratio, largest_momentum, angle = 0.0, 0.0, []
    for index, row in enumerate(rows):
        simulation.ConfigureStopTime(index * step * SUBSTEPS)
        simulation.ExecuteSimulation()
        state = craft.scStateOutMsg.read()
        q, omega = quaternion(np.array(state.sigma_BN)), np.array(state.omega_BN_B)
        x = np.concatenate((omega, q[1:]))
        # The start is on its bound.
        ratio = max(ratio, x @ lyapunov @ x / float(row["lyapunov_bound"])) if index > 0 else 0.0
        largest_momentum = max(largest_momentum, np.linalg.norm(momentum(wheels, omega)))
        angle.append(np.degrees(2.0 * np.arcsin(np.linalg.norm(q[1:]))))
    directions = [1 - 2 * np.array(signs) for signs in np.ndindex(2, 2, 2, 2)]
    friction = FRICTION_NM * max(np.linalg.norm(AXES @ signs) for signs in directions)
    return {
        "ratio": ratio, "momentum": largest_momentum, "disturbance": np.linalg.norm(bias) + friction,
        "pointing_deg": max(angle[-len(angle) // 5 :]), "messages": int(law.messages), "samples": len(rows),
    }


controller, design, run, name, multiple = sys.argv[1:]
print(json.dumps(main(load(controller), json.load(open(design)), run, name, float(multiple))))
