"""What the scripts that fly an exported controller in Basilisk share."""

import csv
import importlib.util
import json
import sys

import numpy as np
from Basilisk.simulation import extForceTorque, spacecraft
from Basilisk.utilities import SimulationBaseClass, macros

SUBSTEPS = 10


def load(path):
    """The controller's module."""
    spec = importlib.util.spec_from_file_location("controller", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["controller"] = module
    spec.loader.exec_module(module)
    return module


def mrp(q):
    """Modified Rodrigues parameters of a quaternion, scalar part first."""
    q = np.array(q) / np.linalg.norm(q) * (1.0 if q[0] >= 0.0 else -1.0)
    return q[1:] / (1.0 + q[0])
