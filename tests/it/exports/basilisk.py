"""Flies an exported controller in Basilisk and compares it with a run of this program.

Arguments: the controller's file, the scenario, the run's trajectory, the header of the reference vectors, the class.
Prints the number of events, the largest difference of torque (N m) and of attitude (rad), and of the vectors' commands.
"""

import re
import struct


def vectors(path):
    """Given numbers, commands and flags of the reference vectors."""
    text = open(path).read()

    def table(name):
        body = re.search(rf"_{name}\[[^=]*= \{{(.*?)\n\}};", text, re.S).group(1)
        rows = [re.findall(r"0x([0-9a-f]{16})", row) for row in body.split("\n")]
        double = lambda word: struct.unpack(">d", bytes.fromhex(word))[0]
        return [[double(word) for word in row] for row in rows if row]

    body = re.search(r"_flags\[[^=]*= \{(.*?)\n\};", text, re.S).group(1)
    flags = [[int(flag) for flag in row] for row in re.findall(r"\{(\d)U, (\d)U, (\d)U\}", body)]
    return table("given"), table("commands"), flags


def memory_record(module):
    """A memory outside of the simulator."""
    fresh = module.fresh_memory()
    kinds = [(key, np.asarray(value).dtype, np.asarray(value).shape) for key, value in fresh.items()]
    record = np.zeros(1, np.dtype(kinds))[0]
    for key, value in fresh.items():
        record[key] = value
    return record


def against_vectors(module, path, follows):
    """Largest difference of a command (N m) over the vectors. Of what Basilisk cannot give, quaternions that are no
    attitude and times that go back, nothing is asked; a law that follows the quaternion's sign is given a continuous one."""
    memory = memory_record(module)
    largest, sent, held = 0.0, 0, np.zeros(3)
    last = None
    for given, command, (fires, status, _) in zip(*vectors(path)):
        if status in (3, 4, 6) or (status == 5 and not np.all(np.isfinite(given))):
            continue
        quaternion = np.array(given[1:5])
        if follows and last is not None and quaternion @ last < 0.0:
            return None
        last = quaternion
        before = memory["messages"]
        zero = (0.0, 0.0, 0.0)
        module.take_sample(memory, given[0], tuple(quaternion), tuple(given[5:8]), zero, zero)
        assert (memory["messages"] > before) == (fires == 1), given
        sent += fires
        largest = max(largest, np.abs(np.array(memory["torque"]) - command).max())
    assert sent > 10
    return largest


def trajectory(path):
    """The samples of a run."""
    with open(path) as file:
        rows = [row for row in csv.DictReader(file) if row["sample"] == "1"]
    pick = lambda *names: np.array([[float(row[name]) for name in names] for row in rows])
    return {
        "time": pick("time_s")[:, 0],
        "sent": pick("sent")[:, 0] == 1,
        "error": pick("error_q0_scalar", "error_q1", "error_q2", "error_q3"),
        "torque": pick("torque_1_nm", "torque_2_nm", "torque_3_nm"),
    }


def fly(module, name, scenario, interval_s):
    """The scenario's loop in Basilisk."""
    body = scenario["system"]["rigid_body"]
    step = macros.sec2nano(interval_s) // SUBSTEPS
    simulation = SimulationBaseClass.SimBaseClass()
    simulation.SetProgressBar(False)
    process = simulation.CreateNewProcess("process")
    process.addTask(simulation.CreateNewTask("dynamics", step), 30)
    process.addTask(simulation.CreateNewTask("control", step * SUBSTEPS), 20)
    craft = spacecraft.Spacecraft()
    craft.hub.mHub = 100.0
    craft.hub.IHubPntBc_B = np.array(body["inertia_kg_m2"], dtype=float).tolist()
    start = body["initial_attitude"]["quaternion_scalar_first"]
    craft.hub.sigma_BNInit = [[value] for value in mrp(start)]
    craft.hub.omega_BN_BInit = [[float(value)] for value in body["initial_rate_rad_s"]]
    commanded, constant = extForceTorque.ExtForceTorque(), extForceTorque.ExtForceTorque()
    for effector, tag in ((commanded, "commanded"), (constant, "constant")):
        effector.ModelTag = tag
        craft.addDynamicEffector(effector)
    constant.extTorquePntB_B = [[value] for value in body["disturbance"]["bias_nm"]]
    law = getattr(module, name)()
    law.scStateInMsg.subscribeTo(craft.scStateOutMsg)
    commanded.cmdTorqueInMsg.subscribeTo(law.cmdTorqueOutMsg)
    # The effectors read the command of the same instant.
    process.addTask(simulation.CreateNewTask("effects", step), 10)
    for task, model in (
        ("dynamics", craft),
        ("control", law),
        ("effects", commanded),
        ("effects", constant),
    ):
        simulation.AddModelToTask(task, model)
    simulation.InitializeSimulation()
    return simulation, craft, law, step


def closed_loop(module, name, scenario, reference):
    """Events, and largest differences."""
    interval_s = scenario["sampling"]["instants"]["periodic"]["interval_s"]
    simulation, craft, law, step = fly(module, name, scenario, interval_s)
    events, torque, attitude, before = 0, 0.0, 0.0, 0
    for index in range(len(reference["time"]) - 1):
        simulation.ConfigureStopTime(index * step * SUBSTEPS)
        simulation.ExecuteSimulation()
        sent = law.messages > before
        before = law.messages
        assert sent == reference["sent"][index], f"event of sample {index}"
        events += sent
        found = np.array(law.cmdTorqueOutMsg.read().torqueRequestBody)
        torque = max(torque, np.abs(found - reference["torque"][index]).max())
        sigma = np.array(craft.scStateOutMsg.read().sigma_BN)
        q = np.array(module.quaternion_of_mrp.py_func(tuple(sigma)))
        expected = reference["error"][index]
        attitude = max(attitude, 2.0 * min(np.abs(q - expected).max(), np.abs(q + expected).max()))
    return events, torque, attitude


controller, scenario, run, header, name = sys.argv[1:]
module = load(controller)
scenario = json.load(open(scenario))
found = against_vectors(module, header, name.startswith(("Wu", "Lei")))
events, torque, attitude = closed_loop(module, name, scenario, trajectory(run))
print(json.dumps({"vectors": found, "events": int(events), "torque": torque, "attitude": attitude}))
