"""Runs an exported functional mock-up unit over the reference vectors of its controller, bit by bit.

Arguments: the unit, the header of the vectors, the name. Prints the number of samples that agree.
"""

import re
import struct
import sys
import tempfile

import numpy as np
from fmpy import extract, read_model_description
from fmpy.build import build_platform_binary
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu


def table(text, name):
    """The rows of a table of doubles."""
    body = re.search(rf"_{name}\[[^=]*= \{{(.*?)\n\}};", text, re.S).group(1)
    rows = [re.findall(r"0x([0-9a-f]{16})", row) for row in body.split("\n")]
    return [[struct.unpack(">d", bytes.fromhex(word))[0] for word in row] for row in rows if row]


def flags_of(text):
    body = re.search(r"_flags\[[^=]*= \{(.*?)\n\};", text, re.S).group(1)
    return [[int(flag) for flag in row] for row in re.findall(r"\{(\d)U, (\d)U, (\d)U\}", body)]


unit, header, name = sys.argv[1:]
problems = validate_fmu(unit)
assert problems == [], problems
folder = extract(unit, tempfile.mkdtemp())
description = read_model_description(folder)
build_platform_binary(folder, all_warnings=True)
slave = FMU2Slave(
    guid=description.guid,
    unzipDirectory=folder,
    modelIdentifier=description.coSimulation.modelIdentifier,
    instanceName="one",
)
slave.instantiate()
slave.setupExperiment(startTime=-1000.0)
slave.enterInitializationMode()
slave.exitInitializationMode()
text = open(header).read()
given, commands, flags = table(text, "given"), table(text, "commands"), flags_of(text)
outputs = [v.valueReference for v in description.modelVariables if v.name.startswith(name)]
messages, agreed = 0, 0
for row, command, (sent, status, _) in zip(given, commands, flags):
    # Times that cannot be passed.
    if status in (3, 4):
        continue
    slave.setReal(list(range(len(row) - 1)), row[1:])
    slave.doStep(currentCommunicationPoint=row[0], communicationStepSize=1e-3)
    messages += sent
    found = slave.getReal(outputs)
    assert np.array(found).tobytes() == np.array(command).tobytes(), (row, found, command)
    assert slave.getBoolean([0])[0] == (sent == 1)
    assert list(slave.getInteger([0, 1])) == [status, messages]
    agreed += 1
slave.terminate()
slave.freeInstance()
print(agreed)
